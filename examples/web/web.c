/* web.c - what the page calls: one mesh, its Laplacian and its plans, behind functions of numbers and pointers

   build.py makes a WASM module of it, and tests/test_web.py a native library, to compare the two. There is one
   session. Functions return hd_status; after a failure page_text() says what is wrong and where. Answers are
   doubles at page_out(), and the facts about them are at page_facts(). */

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__wasm__)
#define PAGE_IMPORT(name) __attribute__((import_module("page"), import_name(name)))
#define PAGE_EXPORT(name) __attribute__((export_name(#name))) name
PAGE_IMPORT("progress") void page_progress(const char *stage, double done);
PAGE_IMPORT("number") double page_number(const char *text);                   /* what strtod does */
PAGE_IMPORT("digits") int32_t page_digits(double x, char *to, int32_t room);  /* as %g; returns the length */

/* The C library's printf and strtod take 20 KB of the module: they know all formats, and numbers of 128 bits.
 * The messages of meshio.h need strings, characters, integers and now and then a double. */
static void page_put(char **p, const char *end, const char *from, size_t n) {
    for (; n > 0 && *p < end; n--) *(*p)++ = *from++;
}

static void page_put_integer(char **p, const char *end, int64_t x, int is_signed) {
    char digit[24], *d = digit + sizeof digit;
    uint64_t u = is_signed && x < 0 ? 0 - (uint64_t)x : (uint64_t)x;
    do *--d = (char)('0' + u % 10);
    while (u /= 10);
    if (is_signed && x < 0) *--d = '-';
    page_put(p, end, d, (size_t)(digit + sizeof digit - d));
}

/* A precision after the point, or SIZE_MAX. */
static size_t page_precision(const char **format, va_list *args) {
    const char *f = *format;
    size_t n = 0;
    if (*f != '.') return SIZE_MAX;
    if (*++f == '*') {
        n = (size_t)va_arg(*args, int);
        f++;
    }
    for (; *f >= '0' && *f <= '9'; f++) n = 10 * n + (size_t)(*f - '0');
    *format = f;
    return n;
}

static int page_vprint(char *to, size_t room, const char *format, va_list args) {
    char *p = to, number[40];
    const char *const end = to + room - 1;
    va_list list;
    va_copy(list, args);
    for (; *format; format++) {
        size_t most;
        int longs = 0;
        if (*format != '%') {
            page_put(&p, end, format, 1);
            continue;
        }
        format++;
        most = page_precision(&format, &list);
        for (; *format == 'l'; format++) longs++;
        if (*format == 's') {
            const char *s = va_arg(list, const char *);
            size_t n = 0;
            while (n < most && s[n]) n++;
            page_put(&p, end, s, n);
        } else if (*format == 'c') {
            number[0] = (char)va_arg(list, int);
            page_put(&p, end, number, 1);
        } else if (*format == 'd' || *format == 'u') {
            const int is_signed = *format == 'd';
            const int64_t x = longs > 1 ? va_arg(list, long long)
                            : is_signed ? va_arg(list, long) : (int64_t)va_arg(list, unsigned long);
            page_put_integer(&p, end, x, is_signed);
        } else if (*format == 'g' || *format == 'f') {
            page_put(&p, end, number, (size_t)page_digits(va_arg(list, double), number, sizeof number));
        } else if (*format) page_put(&p, end, format, 1);
    }
    va_end(list);
    *p = 0;
    return (int)(p - to);
}

static int page_print(char *to, size_t room, const char *format, ...) {
    va_list args;
    int n;
    va_start(args, format);
    n = page_vprint(to, room, format, args);
    va_end(args);
    return n;
}

#define vsnprintf page_vprint
#define snprintf page_print
#define strtod(text, end) page_number(text)
#else
#define PAGE_EXPORT(name) name
static void page_progress(const char *stage, double done) { (void)stage; (void)done; }
#endif

#define HEATDIFF_IMPLEMENTATION
#define HEATDIFF_STATIC
#include "../../heatdiff.h"
#include "../../tools/meshio.h"
#include "../../tools/shapes.h"

/* What page_facts() holds after a query, and after page_begin. page.js reads them by these numbers. */
enum {
    FACT_ERROR_BOUND, FACT_EVIDENCE, FACT_METHOD, FACT_DEGREE, FACT_ITERATIONS, FACT_FACTOR_NNZ, FACT_RESIDUAL,
    FACT_H = 0, FACT_AREA, FACT_ACTIVE, FACT_COMPONENTS, FACT_BOUNDARY_EDGES, FACT_NONMANIFOLD_EDGES,
    FACT_LEFT_OUT, FACT_NEGATIVE_WEIGHTS, FACT_KIND, FACT_START, N_FACTS
};

static struct {
    mio_mesh mesh;
    int32_t n_tri, *tri;            /* the faces in triangles, for drawing and for geodesic distances */
    hd_context ctx;
    hd_laplacian *lap;
    hd_heat *plan[4];               /* by hd_method */
    hd_geodesic *geodesic;
    double *out;
    size_t room;                    /* doubles at out */
    double facts[N_FACTS];
    char text[800];
} page;

/* ---- memory and messages ---- */

static hd_status page_fail(hd_status status, const char *text) {
    snprintf(page.text, sizeof page.text, "%s", text);
    return status;
}

static hd_status page_fail_at(const hd_error *e) {
    char at[64] = "";
    if (e->vertex >= 0) snprintf(at, sizeof at, " (vertex %ld)", (long)e->vertex);
    else if (e->face >= 0) snprintf(at, sizeof at, " (face %ld)", (long)e->face);
    snprintf(page.text, sizeof page.text, "%s%s", e->text, at);
    return e->status;
}

static hd_progress page_tick(void *user, const char *stage, double done) {
    (void)user;
    page_progress(stage, done);
    return HD_PROGRESS_CONTINUE;
}

/* Room for count doubles at page.out; what was there is lost. */
static hd_status page_make_room(size_t count) {
    if (count <= page.room) return HD_OK;
    free(page.out);
    page.room = 0;
    page.out = (double *)malloc(count * sizeof *page.out);
    if (!page.out) return page_fail(HD_ERR_MEMORY, "not enough memory for the answer");
    page.room = count;
    return HD_OK;
}

static void page_forget_plans(void) {
    int i;
    for (i = 0; i < 4; i++) {
        hd_heat_free(page.plan[i]);
        page.plan[i] = NULL;
    }
    hd_geodesic_free(page.geodesic);
    hd_laplacian_free(page.lap);
    page.geodesic = NULL;
    page.lap = NULL;
}

static void page_forget(void) {
    page_forget_plans();
    mio_free(&page.mesh);
    free(page.tri);
    free(page.out);
    page.tri = NULL;
    page.out = NULL;
    page.n_tri = 0;
    page.room = 0;
}

void *PAGE_EXPORT(page_alloc)(size_t size) { return malloc(size); }
void PAGE_EXPORT(page_free)(void *block) { free(block); }
const char *PAGE_EXPORT(page_text)(void) { return page.text; }
const double *PAGE_EXPORT(page_out)(void) { return page.out; }
const double *PAGE_EXPORT(page_facts)(void) { return page.facts; }

/* ---- the mesh ---- */

int32_t PAGE_EXPORT(page_n)(void) { return page.mesh.n; }
int32_t PAGE_EXPORT(page_n_faces)(void) { return page.mesh.n_faces; }
int32_t PAGE_EXPORT(page_n_tri)(void) { return page.n_tri; }
const double *PAGE_EXPORT(page_xyz)(void) { return page.mesh.xyz; }
const int32_t *PAGE_EXPORT(page_tri)(void) { return page.tri; }
const char *PAGE_EXPORT(page_format)(void) { return page.mesh.format; }

/* Takes the arrays over. face_ptr NULL: triangles. */
static hd_status page_take(int32_t n, double *xyz, int32_t n_faces, int64_t *face_ptr, int32_t *face_idx) {
    int32_t f;
    page.mesh.n = n;
    page.mesh.xyz = xyz;
    page.mesh.n_faces = n_faces;
    page.mesh.face_idx = face_idx;
    page.mesh.face_ptr = face_ptr ? face_ptr : (int64_t *)malloc(((size_t)n_faces + 1) * sizeof *face_ptr);
    page.mesh.format = "made here";
    if (!xyz || !page.mesh.face_ptr) return page_fail(HD_ERR_MEMORY, "not enough memory for this shape");
    for (f = 0; f <= n_faces && !face_ptr; f++) page.mesh.face_ptr[f] = 3 * (int64_t)f;
    return HD_OK;
}

static hd_status page_split(void) {
    mio_error e;
    if (!page.mesh.n_faces) return HD_OK;
    if (mio_triangulate(&page.mesh, &page.tri, &page.n_tri, NULL, &e) == MIO_OK) return HD_OK;
    return page_fail(HD_ERR_MEMORY, e.text);
}

enum { SHAPE_ELEPHANT, SHAPE_BALL, SHAPE_TORUS, SHAPE_QUADS, SHAPE_POINTS };

/* Waves on the tube of a torus, so that it has thick and thin places. */
static void page_bend_torus(shape *s) {
    int32_t i;
    for (i = 0; i < s->n; i++) {
        double *p = s->xyz + 3 * (size_t)i;
        const double u = atan2(p[2], p[0]), ring = sqrt(p[0] * p[0] + p[2] * p[2]), r = 1 + 0.3 * sin(3 * u);
        const double out = 1 + (ring - 1) * r;
        p[0] *= out / ring;
        p[1] = p[1] * r + 0.2 * sin(2 * u);
        p[2] *= out / ring;
    }
}

/* A cushion: the sphere made flatter, with dents. */
static void page_dent(double *xyz, int32_t n) {
    int32_t i;
    for (i = 0; i < n; i++) {
        double *x = xyz + 3 * (size_t)i;
        const double r = 1 + 0.16 * sin(5 * x[0]) * sin(5 * x[1]) * sin(5 * x[2] + 1);
        x[0] *= 1.2 * r;
        x[1] *= 0.75 * r;
        x[2] *= r;
    }
}

/* A built-in shape of about n vertices, of a size near 1. */
hd_status PAGE_EXPORT(page_shape)(int32_t which, int32_t n) {
    const double side = sqrt((double)n);
    int levels = 3;
    hd_status status;
    page_forget();
    while (levels < 8 && 10 * pow(4, levels + 0.5) < n) levels++;
    if (which == SHAPE_QUADS) {
        shape_poly p = shape_quad_sphere((int32_t)(side / sqrt(6.0) + 0.5));
        status = page_take(p.n, p.xyz, p.n_faces, p.face_ptr, p.face_idx);
        if (status == HD_OK) page_dent(p.xyz, p.n);
    } else {
        shape s = which == SHAPE_BALL ? shape_bumpy(levels, 5)
                : which == SHAPE_TORUS ? shape_torus((int32_t)(side * 1.6), (int32_t)(side / 1.6), 1.0, 0.36)
                : shape_demo(n);
        if (which == SHAPE_TORUS) page_bend_torus(&s);
        if (which == SHAPE_POINTS) s.n_tri = 0;
        status = page_take(s.n, s.xyz, s.n_tri, NULL, s.tri);
    }
    return status < 0 ? status : page_split();
}

/* A file's content, [size + 1], which this function frees. name: for its ending and for messages. */
hd_status PAGE_EXPORT(page_file)(char *data, size_t size, const char *name) {
    mio_in in;
    mio_error e;
    page_forget();
    mio_begin(&in, name, NULL, &e);
    in.data = data;
    in.size = size;
    data[size] = 0;
    mio_rewind(&in);
    if (mio_parse(&in, &page.mesh) != MIO_OK) return page_fail(HD_ERR_ARGUMENT, e.text);
    return page_split();
}

static int page_triangles_only(void) {
    return page.mesh.face_ptr[page.mesh.n_faces] == 3 * (int64_t)page.mesh.n_faces;
}

/* Where heat begins: the vertex with the largest x of the piece with the most mass. */
static int32_t page_start(void) {
    const hd_laplacian *lap = page.lap;
    int32_t r, c, best = -1, largest = 0;
    for (c = 1; c < lap->n_components; c++) if (lap->component_mass[c] > lap->component_mass[largest]) largest = c;
    for (r = 0; r < lap->n_active; r++)
        if (lap->component[r] == largest && (best < 0 || lap->xyz[3 * (size_t)r] > lap->xyz[3 * (size_t)best])) best = r;
    return lap->vertex[best];
}

/* The Laplacian: linear elements for triangles, that of polygons, tufted for points. mend = 1: intrinsic Delaunay
 * triangulation of the faces, split into triangles. byte_limit 0: none. */
hd_status PAGE_EXPORT(page_begin)(int32_t mend, double byte_limit) {
    const mio_mesh *m = &page.mesh;
    hd_mesh mesh = hd_triangles(m->xyz, m->n, page.tri, page.n_tri);
    hd_laplacian_opts o;
    hd_error e;
    hd_status status;
    const hd_mesh_report *r;
    page_forget_plans();
    memset(&page.ctx, 0, sizeof page.ctx);
    memset(&o, 0, sizeof o);
    page.ctx.progress = page_tick;
    page.ctx.byte_limit = (uint64_t)byte_limit;
    o.context = &page.ctx;
    o.triangulation = mend && m->n_faces ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
    if (m->n_faces == 0) {
        mesh.shape = HD_POINTS;
        mesh.corner = NULL;
        o.triangulation = HD_TRIANGULATION_TUFTED;
    } else if (!mend && !page_triangles_only()) {
        mesh.shape = HD_POLYGONS;
        mesh.face_ptr = m->face_ptr;
        mesh.corner = m->face_idx;
        mesh.n_faces = m->n_faces;
    }
    status = hd_laplacian_create(&page.lap, &mesh, &o, &e);
    if (status < 0) return page_fail_at(&e);
    r = &page.lap->mesh;
    page.facts[FACT_H] = page.lap->h;
    page.facts[FACT_AREA] = page.lap->area;
    page.facts[FACT_ACTIVE] = page.lap->n_active;
    page.facts[FACT_COMPONENTS] = page.lap->n_components;
    page.facts[FACT_BOUNDARY_EDGES] = (double)r->n_boundary_edges;
    page.facts[FACT_NONMANIFOLD_EDGES] = (double)r->n_nonmanifold_edges;
    page.facts[FACT_LEFT_OUT] = (double)r->n_repeated_corner + r->n_zero_area + r->n_repeated_face;
    page.facts[FACT_NEGATIVE_WEIGHTS] = (double)r->n_negative_weights;
    page.facts[FACT_KIND] = page.lap->kind;
    page.facts[FACT_START] = page_start();
    return status;
}

/* ---- queries ---- */

/* The plan of a method, made at its first use. */
static hd_heat *page_plan(hd_method method) {
    hd_heat_opts o;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.method = method;
    if (!page.plan[method] && hd_heat_create(&page.plan[method], page.lap, &o, &e) < 0) page_fail_at(&e);
    return page.plan[method];
}

static hd_status page_end(const hd_report *r) {
    if (r->status < 0) return page_fail_at(&r->error);
    page.facts[FACT_ERROR_BOUND] = r->error_bound;
    page.facts[FACT_EVIDENCE] = fmax(r->evidence_rational, fmax(r->evidence_solver, r->evidence_rounding));
    page.facts[FACT_METHOD] = r->method;
    page.facts[FACT_DEGREE] = r->degree;
    page.facts[FACT_ITERATIONS] = (double)r->iterations;
    page.facts[FACT_FACTOR_NNZ] = (double)r->factor_nnz;
    page.facts[FACT_RESIDUAL] = r->residual;
    return r->status;
}

/* The column of k_t at a source: out [n n_times]. method: direct for many sources at one time, krylov for many
 * times. */
hd_status PAGE_EXPORT(page_columns)(int32_t method, int32_t n_times, const double *t, int32_t source) {
    const hd_sources from = hd_vertices(1, &source);
    hd_report r;
    hd_heat *plan = page_plan((hd_method)method);
    if (!plan || page_make_room((size_t)page.mesh.n * (size_t)n_times) < 0) return HD_ERR_MEMORY;
    hd_heat_columns(plan, HD_KERNEL_SYMMETRIC, n_times, t, &from, page.out, 0, &r, NULL);
    return page_end(&r);
}

/* The heat kernel signature k_t(x,x): out [n n_times]. */
hd_status PAGE_EXPORT(page_signature)(int32_t n_times, const double *t) {
    hd_report r;
    hd_heat *plan = page_plan(HD_METHOD_DIRECT);
    if (!plan || page_make_room((size_t)page.mesh.n * (size_t)n_times) < 0) return HD_ERR_MEMORY;
    hd_heat_diagonal(plan, HD_KERNEL_SYMMETRIC, n_times, t, page.out, 0, NULL, NULL, &r, NULL);
    return page_end(&r);
}

/* The coordinates, diffused: out [n] for x at all times, then y at all times, then z. */
hd_status PAGE_EXPORT(page_smooth)(int32_t n_times, const double *t) {
    const size_t n = (size_t)page.mesh.n;
    hd_report r;
    hd_heat *plan = page_plan(HD_METHOD_KRYLOV);
    double *field = (double *)malloc(3 * n * sizeof *field);
    size_t i;
    if (!plan || !field || page_make_room(3 * n * (size_t)n_times) < 0) {
        free(field);
        return page_fail(HD_ERR_MEMORY, "not enough memory to smooth the surface");
    }
    for (i = 0; i < 3 * n; i++) field[i % 3 * n + i / 3] = page.mesh.xyz[i];
    hd_heat_apply(plan, n_times, t, 3, field, 0, page.out, 0, &r, NULL);
    free(field);
    return page_end(&r);
}

/* Distances along the surface to a source: out [n]. HUGE_VAL where no path leads. */
hd_status PAGE_EXPORT(page_geodesic)(int32_t source) {
    const hd_mesh mesh = hd_triangles(page.mesh.xyz, page.mesh.n, page.tri, page.n_tri);
    const hd_sources from = hd_vertices(1, &source);
    hd_geodesic_opts o;
    hd_geodesic_report r;
    hd_error e;
    hd_status status = HD_OK;
    memset(&o, 0, sizeof o);
    o.context = &page.ctx;
    if (!page.n_tri) return page_fail(HD_ERR_ARGUMENT, "geodesic distances need faces; these are points");
    if (!page.geodesic)
        status = hd_geodesic_create(&page.geodesic, &mesh, &o, &e);
    if (status < 0) return page_fail_at(&e);
    if (page_make_room((size_t)page.mesh.n) < 0) return HD_ERR_MEMORY;
    status = hd_geodesic_distance(page.geodesic, &from, page.out, 0, &r, &e);
    if (status < 0) return page_fail_at(&e);
    memset(page.facts, 0, sizeof page.facts);
    page.facts[FACT_RESIDUAL] = r.residual_heat > r.residual_distance ? r.residual_heat : r.residual_distance;
    page.facts[FACT_FACTOR_NNZ] = (double)r.factor_nnz;
    return status;
}
