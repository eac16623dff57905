/* fuzz.c - any bytes as files, meshes, matrices, options and queries

   Each target turns bytes into calls, and aborts when an answer is wrong: a value that is not finite with HD_OK, heat
   that is lost, a bound that does not hold what it says, something left allocated. Sanitizers see the rest.

       bash tests/fuzz/run.sh 60             with clang: libFuzzer, a minute for each target
       cc tests/fuzz/fuzz.c -I. -lm -o fuzz && ./fuzz tests/fuzz/corpus       any compiler: the kept inputs, once each

   --target=NAME            libFuzzer: which target (the first option)
   --unpack DIR             without libFuzzer: writes the inputs of the corpus to DIR/NAME/, one file each
   --random TARGET S SEED   without libFuzzer: random inputs for S seconds; a failure says the input's seed
   --seed TARGET SEED       one of these again; prints it as a line of the corpus

   The corpus: CORPUS/NAME.txt, one input a line, in hexadecimal digits; for files also CORPUS/NAME/, as they are. */

#ifndef _DEFAULT_SOURCE
#define _DEFAULT_SOURCE
#endif
#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#ifndef HEATDIFF_LIBFUZZER               /* which is compiled apart then */
#define HEATDIFF_IMPLEMENTATION
#endif
#include "../../heatdiff.h"
#include "../../tools/levels.h"
#include "../../tools/meshio.h"
#include "../../tools/shapes.h"

/* ---- bytes as numbers ---- */

typedef struct fz_in { const uint8_t *p, *end; } fz_in;

static const char *fz_what = "";                 /* what is being done, for the message */

static void fz_fail(const char *text, int line) {
    fprintf(stderr, "fuzz.c:%d: %s: %s\n", line, fz_what, text);
    abort();
}

#define FZ(cond) do { if (!(cond)) fz_fail(#cond, __LINE__); } while (0)

/* Rows in order, columns that ascend within them, numbers; if asked also symmetric, up to rounding. */
static void fz_csr_check(const hd_csr *a, int symmetric) {
    int64_t p, q;
    int32_t i;
    FZ(a->n_rows >= 0 && a->n_cols >= 0 && a->row_ptr && a->row_ptr[0] == 0 && a->row_ptr[a->n_rows] == a->nnz);
    for (i = 0; i < a->n_rows; i++) {
        FZ(a->row_ptr[i + 1] >= a->row_ptr[i] && a->row_ptr[i + 1] <= a->nnz);
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            FZ(a->col[p] >= 0 && a->col[p] < a->n_cols && (p == a->row_ptr[i] || a->col[p] > a->col[p - 1]));
            FZ(!a->val || isfinite(a->val[p]));
        }
    }
    FZ(!symmetric || a->n_rows == a->n_cols);
    for (i = 0; symmetric && i < a->n_rows; i++) {
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const int32_t j = a->col[p];
            double y = 0;
            for (q = a->row_ptr[j]; q < a->row_ptr[j + 1] && a->col[q] < i; q++) continue;
            if (q < a->row_ptr[j + 1] && a->col[q] == i) y = a->val[q];
            FZ(fabs(a->val[p] - y) <= 1e-12 * fmax(fabs(a->val[p]), fabs(y)));
        }
    }
}

static uint8_t fz_byte(fz_in *in) { return in->p < in->end ? *in->p++ : 0; }

static int32_t fz_below(fz_in *in, int32_t n) { return n > 0 ? fz_byte(in) % n : 0; }

static uint64_t fz_raw(fz_in *in, int bytes) {
    uint64_t u = 0;
    while (bytes-- > 0) u = u << 8 | fz_byte(in);
    return u;
}

/* Small integers, and now and then any. */
static int32_t fz_int(fz_in *in, int32_t n) {
    const uint8_t b = fz_byte(in);
    if (b < 240) return n > 0 ? b % n : (int32_t)b - 120;
    return b < 244 ? n : b < 248 ? -1 : (int32_t)(uint32_t)fz_raw(in, 4);
}

/* Steps of 1/16 around zero, numbers of all sizes, and those at the ends. */
static double fz_number(fz_in *in) {
    static const double ends[16] = {0, -0.0, 1, -1, DBL_MIN, DBL_MAX, -DBL_MAX, 4.9e-324, 1e154, 1e-154, 1e200, 1e-200, DBL_EPSILON,
                                    (double)NAN, (double)INFINITY, -(double)INFINITY};
    const uint8_t b = fz_byte(in);
    uint64_t u;
    double x;
    if (b < 160) return (b - 64) / 16.0;
    if (b < 176) return ends[b - 160];
    if (b < 224) return (int16_t)(uint16_t)fz_raw(in, 2) / 4096.0;
    if (b < 248) {
        x = (int16_t)(uint16_t)fz_raw(in, 2);
        return ldexp(x, 8 * (int8_t)fz_byte(in));
    }
    u = fz_raw(in, 8);
    memcpy(&x, &u, sizeof x);
    return x;
}

static int fz_finite(const double *x, int64_t n) {
    int64_t i;
    for (i = 0; i < n; i++) if (!mio_is_finite(x[i])) return 0;
    return 1;
}

static int fz_no_nan(const double *x, int64_t n) {
    int64_t i;
    for (i = 0; i < n; i++) if (x[i] != x[i]) return 0;
    return 1;
}

/* ---- a context that counts, limits and stops ---- */

typedef struct fz_context {
    hd_context ctx;
    int64_t live, calls, fail_at, progress, stop_at;
} fz_context;

static void *fz_alloc(void *user, size_t size) {
    fz_context *c = (fz_context *)user;
    void *p;
    if (++c->calls == c->fail_at) return NULL;
    p = malloc(size ? size : 1);
    if (!p) return NULL;
    memset(p, 0xa5, size);                       /* whoever reads before writing gets nonsense */
    c->live++;
    return p;
}

static void fz_free(void *user, void *p, size_t size) {
    fz_context *c = (fz_context *)user;
    (void)size;
    c->live--;
    free(p);
}

static hd_progress fz_progress(void *user, const char *stage, double done) {
    fz_context *c = (fz_context *)user;
    FZ(stage && done >= 0 && done <= 1);
    return ++c->progress == c->stop_at ? HD_PROGRESS_CANCEL : HD_PROGRESS_CONTINUE;
}

enum { FZ_BYTES = 64 << 20 };

static void fz_context_make(fz_context *c, fz_in *in) {
    const uint8_t way = fz_byte(in);
    memset(c, 0, sizeof *c);
    c->ctx.allocator.alloc = fz_alloc;
    c->ctx.allocator.free = fz_free;
    c->ctx.allocator.user = c;
    c->ctx.progress = fz_progress;
    c->ctx.progress_user = c;
    c->ctx.byte_limit = FZ_BYTES;
    c->ctx.n_threads = 1 + (way & 1);
    if (way & 2) c->ctx.simd = (hd_simd)fz_below(in, 5);
    if (way > 250) c->ctx.byte_limit = 1 + fz_raw(in, 3);
    if (way == 250) c->fail_at = 1 + (int64_t)fz_raw(in, 2);
    if (way == 249) c->stop_at = 1 + (int64_t)fz_raw(in, 2);
}

static void fz_context_done(const fz_context *c) {
    FZ(c->live == 0);
    FZ(c->ctx.bytes_in_use == 0);
    FZ(c->ctx.bytes_peak <= c->ctx.byte_limit);
    FZ(c->ctx.n_holders == 0 && !c->ctx.threads);
}

/* One of the list, told alike in the error, with a line of text; memory and cancelling only if they were meant. */
static hd_status fz_status(hd_status st, const hd_error *e, const fz_context *c) {
    FZ(st >= HD_ERR_NOT_BUILT && st <= HD_WARN_ACCURACY);
    if (e) FZ((e->status == st || (st > 0 && e->status == HD_OK)) && (st >= 0 || e->text[0]) && !strchr(e->text, '\n'));
    FZ(st != HD_ERR_MEMORY || c->calls >= c->fail_at);
    FZ(st != HD_ERR_MEMORY || c->fail_at);
    FZ(st != HD_ERR_CANCELLED || c->stop_at);
    return st;
}

/* ---- files ---- */

/* The bytes as an opened file. */
static int fz_file(mio_in *in, const char *name, const uint8_t *data, size_t size, mio_error *e) {
    mio_begin(in, name, NULL, e);
    in->data = (char *)malloc(size + 1);
    if (!in->data) return 0;
    if (size) memcpy(in->data, data, size);
    in->data[size] = 0;
    in->size = size;
    mio_rewind(in);
    e->text[0] = 0;
    return 1;
}

/* A failure is one line that begins with the file's name. */
static void fz_file_status(int status, const char *name, const mio_error *e) {
    const char *p;
    FZ(status == MIO_OK || status == MIO_FAILED);
    if (status == MIO_OK) return;
    FZ(strncmp(e->text, name, strlen(name)) == 0 && e->text[strlen(name)] == ':');
    for (p = e->text; *p; p++) FZ((unsigned char)*p >= ' ' && *p != 127);
}

static void fz_same_mesh(const mio_mesh *a, const mio_mesh *b) {
    FZ(a->n == b->n && a->n_faces == b->n_faces);
    FZ(memcmp(a->xyz, b->xyz, 24 * (size_t)a->n) == 0);
    FZ(memcmp(a->face_ptr, b->face_ptr, ((size_t)a->n_faces + 1) * sizeof *a->face_ptr) == 0);
    if (a->n_faces) FZ(memcmp(a->face_idx, b->face_idx, (size_t)a->face_ptr[a->n_faces] * sizeof *a->face_idx) == 0);
}

/* What is written is read back the same. */
static void fz_round_trip(const mio_mesh *m) {
    static const char *const ends[2] = {"ply", "obj"};
    char path[64];
    int k;
    for (k = 0; k < 2; k++) {
        mio_output o;
        mio_mesh again;
        mio_error e;
        memset(&o, 0, sizeof o);
        e.text[0] = 0;
        snprintf(path, sizeof path, "/tmp/heatdiff-fuzz-%ld.%s", (long)getpid(), ends[k]);
        fz_what = path;
        FZ(mio_write(path, mio_format_of(path), m, &o, &e) == MIO_OK);
        if (mio_load(&again, path, NULL, &e) != MIO_OK) fz_fail(e.text, __LINE__);
        fz_same_mesh(m, &again);
        mio_free(&again);
        remove(path);
    }
}

static void fz_mesh(const uint8_t *data, size_t size) {
    static const char *const names[6] = {"x", "x.obj", "x.off", "x.ply", "x.stl", "x.xyz"};
    int k, status;
    for (k = 0; k < 6; k++) {
        mio_in in;
        mio_mesh m;
        mio_error e;
        int32_t *tri, *face, n_tri, f;
        int64_t c;
        memset(&m, 0, sizeof m);
        fz_what = names[k];
        if (!fz_file(&in, names[k], data, size, &e)) return;
        status = mio_parse(&in, &m);
        fz_file_status(status, names[k], &e);
        FZ(!in.data);
        if (status < 0) {
            FZ(!m.xyz && !m.face_ptr && !m.face_idx && !m.n && !m.n_faces);
            continue;
        }
        FZ(m.n > 0 && m.n_faces >= 0 && fz_finite(m.xyz, 3 * (int64_t)m.n) && m.face_ptr && m.face_ptr[0] == 0 && m.format);
        for (f = 0; f < m.n_faces; f++) FZ(m.face_ptr[f + 1] >= m.face_ptr[f] + 3);
        for (c = 0; c < m.face_ptr[m.n_faces]; c++) FZ(m.face_idx[c] >= 0 && m.face_idx[c] < m.n);
        FZ(mio_triangulate(&m, &tri, &n_tri, &face, &e) == MIO_OK && n_tri == m.face_ptr[m.n_faces] - 2 * (int64_t)m.n_faces);
        for (f = 0; f < n_tri; f++) FZ(face[f] >= 0 && face[f] < m.n_faces && (f == 0 || face[f] >= face[f - 1]));
        free(tri);
        free(face);
        if (k == 0 && size % 8 == 0 && m.n < 100000) fz_round_trip(&m);
        mio_free(&m);
    }
}

static void fz_table(const uint8_t *data, size_t size) {
    static const char *const names[3] = {"x.txt", "x.csv", "x.npy"};
    int k, status;
    for (k = 0; k < 3; k++) {
        mio_in in;
        mio_error e;
        double *values = NULL;
        int64_t rows = 0, *lines = NULL, r;
        int32_t cols = 0;
        fz_what = names[k];
        if (!fz_file(&in, names[k], data, size, &e)) return;
        status = mio_parse_table(&in, &values, &rows, &cols, &lines);
        fz_file_status(status, names[k], &e);
        FZ(!in.data);
        if (status < 0) FZ(!values && !lines);
        else FZ(rows > 0 && cols > 0 && fz_finite(values, rows * cols));
        for (r = 0; status == MIO_OK && lines && r < rows; r++) FZ(lines[r] > (r ? lines[r - 1] : 0));
        free(values);
        free(lines);
    }
}

/* Level sets of any values on any faces: within the box of the mesh, each line of two points at least. */
static void fz_levels(const uint8_t *data, size_t size) {
    fz_in in;
    lev_set set;
    lev_mesh mesh;
    double xyz[3 * 24], f[24], low = HUGE_VAL, high = -HUGE_VAL;
    int64_t ptr[25], at = 0, k;
    int32_t idx[200], n, j;
    uint8_t way;
    in.p = data;
    in.end = data + size;
    way = fz_byte(&in);
    n = 1 + fz_below(&in, 24);
    memset(&set, 0, sizeof set);
    memset(&mesh, 0, sizeof mesh);
    for (k = 0; k < 3 * n; k++) {
        do xyz[k] = fz_number(&in); while (!mio_is_finite(xyz[k]));
        low = xyz[k] < low ? xyz[k] : low;
        high = xyz[k] > high ? xyz[k] : high;
    }
    for (k = 0; k < n; k++) f[k] = fz_number(&in);
    mesh.n_faces = fz_below(&in, 24);
    for (k = 0, ptr[0] = 0; k < mesh.n_faces; k++) {
        const int32_t corners = way & 1 ? 3 : 3 + fz_below(&in, 5);
        for (j = 0; j < corners; j++) idx[at++] = fz_below(&in, n);
        ptr[k + 1] = at;
    }
    mesh.xyz = xyz;
    mesh.face_ptr = ptr;
    mesh.face_idx = idx;
    fz_what = "level sets";
    for (k = 0; k < 2; k++) {
        double level;
        do level = fz_number(&in); while (!mio_is_finite(level));
        FZ(lev_trace(&set, &mesh, f, way & 2 ? f[0] : level));
    }
    for (k = at = 0; k < set.n_lines; k++) {
        FZ(set.line[k].first == at && set.line[k].count >= 2 + (set.line[k].closed != 0) && set.line[k].length >= 0);
        at += set.line[k].count;
    }
    FZ(at == set.n_points);
    for (k = 0; k < 3 * set.n_points; k++) FZ(set.xyz[k] >= low && set.xyz[k] <= high);
    lev_free(&set);
}

/* ---- Laplacians ---- */

enum { FZ_VERTICES = 48, FZ_FACES = 96, FZ_TIMES = 3, FZ_FIELDS = 3, FZ_PAIRS = 8 };

/* L and B are what the header says of them. */
static void fz_check_laplacian(const hd_laplacian *lap) {
    double mass = 0;
    int32_t r, v, active = 0, held = 0;
    int64_t p;
    FZ(lap->n_active > 0 || lap->n_held > 0);
    FZ(lap->L.n_rows == lap->n_active && lap->L.n_cols == lap->n_active);
    fz_csr_check(&lap->L, 1);
    FZ(!lap->B || fz_finite(lap->B, lap->L.nnz));
    FZ(mio_is_finite(lap->h) && lap->h >= 0 && lap->area == lap->area);
    FZ(lap->kind == HD_LAPLACIAN_MATRICES || mio_is_finite(lap->area));   /* sums of one's own masses may overflow */
    for (v = 0; v < lap->n; v++) {
        FZ(lap->row[v] >= HD_ROW_HELD && lap->row[v] < lap->n_active);
        if (lap->row[v] >= 0) FZ(lap->vertex[lap->row[v]] == v);
        active += lap->row[v] >= 0;
        held += lap->row[v] == HD_ROW_HELD;
    }
    FZ(active == lap->n_active && held == lap->n_held);
    for (r = 0; r < lap->n_active; r++) {
        double sum = 0, size = 0;
        const double *diagonal = NULL;
        FZ(lap->component[r] >= 0 && lap->component[r] < lap->n_components);
        FZ(lap->b_diag[r] > 0 && mio_is_finite(lap->b_diag[r]) && mio_is_finite(lap->mass[r]));
        for (p = lap->L.row_ptr[r]; p < lap->L.row_ptr[r + 1]; p++) {
            sum += lap->L.val[p];
            size += fabs(lap->L.val[p]);
            if (lap->L.col[p] == r) diagonal = &lap->L.val[p];
        }
        /* rounding of what cancels, and of what went with the vertices held */
        FZ(diagonal && (!mio_is_finite(size) || lap->n_held > 0 || *diagonal >= -1.01e-12 * size));
        if (lap->conserves == 1 && mio_is_finite(size)) FZ(fabs(sum) <= 16 * DBL_EPSILON * size);
        mass += lap->mass[r];
    }
    if (lap->conserves == 1 && (lap->kind == HD_LAPLACIAN_FEM || lap->kind == HD_LAPLACIAN_VORONOI_COT) && !lap->mesh.n_sheets)
        FZ(fabs(mass - lap->area) <= 1e-9 * lap->area);
}

static hd_laplacian_opts fz_laplacian_opts(fz_in *in, hd_context *ctx, int32_t *held, int32_t n) {
    const uint8_t way = fz_byte(in);
    hd_laplacian_opts o;
    int32_t k;
    memset(&o, 0, sizeof o);
    o.context = ctx;
    o.kind = (hd_laplacian_kind)fz_int(in, 8);
    o.triangulation = (hd_triangulation)(way & 3);
    if (way & 4) o.updatable = 1;
    if (way & 8) o.border = HD_BORDER_DIRICHLET;
    if (way & 16) o.mollify = fz_number(in);
    if (way & 32) o.stiffening = fz_number(in);
    if (way & 64) {
        o.bandwidth2 = fz_number(in);
        o.weight_cut = fz_number(in);
        o.neighbours = fz_int(in, 130);
    }
    if (way & 128) {
        o.n_held = fz_below(in, 4);
        for (k = 0; k < o.n_held; k++) held[k] = fz_int(in, n);
        o.held = held;
    }
    return o;
}

/* A grid, a ball, or nothing that is known; then some of its numbers change. */
static shape fz_soup(fz_in *in) {
    const uint8_t way = fz_byte(in);
    shape s;
    int32_t k, changes;
    switch (way % 5) {
    case 0: s = shape_grid(2 + fz_below(in, 4), 2 + fz_below(in, 4), 0.3); break;
    case 1: s = shape_icosphere(way > 240); break;
    case 2: s = shape_torus(3 + fz_below(in, 4), 3 + fz_below(in, 4), 1, 0.4); break;
    default:
        s = shape_make(1 + fz_below(in, 20), 1 + fz_below(in, 40));
        for (k = 0; k < 3 * s.n; k++) s.xyz[k] = fz_number(in);
        for (k = 0; k < 3 * s.n_tri; k++) s.tri[k] = fz_int(in, s.n);
        return s;
    }
    changes = fz_below(in, 8);
    for (k = 0; k < changes; k++) {
        const int32_t at = (int32_t)fz_raw(in, 2);
        if (at & 1) s.tri[at / 2 % (3 * s.n_tri)] = fz_int(in, s.n);
        else s.xyz[at / 2 % (3 * s.n)] = fz_number(in);
    }
    if (way & 128) {                              /* another unit */
        const double scale = ldexp(1, 8 * (int8_t)fz_byte(in));
        for (k = 0; k < 3 * s.n; k++) s.xyz[k] *= scale;
    }
    return s;
}

static hd_status fz_polygons(fz_in *in, hd_laplacian **lap, const shape *s, const hd_laplacian_opts *o, hd_error *e) {
    int64_t ptr[FZ_FACES + 1];
    int32_t f = 0;
    ptr[0] = 0;
    while (f < FZ_FACES && ptr[f] < 3 * (int64_t)s->n_tri) {
        const int64_t next = ptr[f] + fz_below(in, 9);
        ptr[f + 1] = next <= 3 * (int64_t)s->n_tri ? next : 3 * (int64_t)s->n_tri;
        f++;
        if (in->p == in->end && next == ptr[f - 1]) break;
    }
    if (f && fz_byte(in) == 255) ptr[f / 2] = -1;
    return hd_laplacian_create(lap, MESH_POLYGONS(s->xyz, s->n, ptr, s->tri, f), o, e);
}

static hd_status fz_tufted(fz_in *in, hd_laplacian **lap, const shape *s, const hd_laplacian_opts *o, hd_error *e) {
    int64_t ptr[2048];
    int32_t nbr[2048], v, most = 0;
    if (fz_byte(in) & 1) return hd_laplacian_create(lap, MESH_POINTS(s->xyz, s->n), o, e);
    ptr[0] = 0;
    for (v = 0; v < s->n; v++) {
        int32_t k, count = fz_below(in, 14);
        for (k = 0; k < count; k++) nbr[most++] = fz_int(in, s->n);
        ptr[v + 1] = most;
    }
    return hd_laplacian_create(lap, MESH_STARS(s->xyz, s->n, ptr, nbr), o, e);
}

static hd_status fz_laplacian_of(fz_in *in, hd_laplacian **lap, const shape *s, const hd_laplacian_opts *o, hd_error *e) {
    uint16_t corner[3 * FZ_FACES];
    hd_mesh view;
    float xyz[3 * FZ_VERTICES];
    int32_t k;
    switch (fz_byte(in) % 6) {
    case 0: fz_what = "polygons"; return fz_polygons(in, lap, s, o, e);
    case 1: fz_what = "points"; return hd_laplacian_create(lap, MESH_POINTS(s->xyz, s->n), o, e);
    case 2: fz_what = "tufted points"; return fz_tufted(in, lap, s, o, e);
    case 3:
        fz_what = "view";
        memset(&view, 0, sizeof view);
        for (k = 0; k < 3 * s->n; k++) xyz[k] = fabs(s->xyz[k]) <= (double)FLT_MAX ? (float)s->xyz[k] : 0;
        view.xyz_float = xyz;
        view.n = s->n;
        view.n_faces = s->n_tri < FZ_FACES ? s->n_tri : FZ_FACES;
        for (k = 0; k < 3 * view.n_faces; k++) corner[k] = (uint16_t)s->tri[k];
        view.corner_u16 = corner;
        return hd_laplacian_create(lap, &view, o, e);
    default: fz_what = "triangles"; return hd_laplacian_create(lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), o, e);
    }
}

/* ---- queries ---- */

static double fz_time(fz_in *in, const hd_laplacian *lap) {
    const double h2 = lap->h > 0 ? lap->h * lap->h : 1;
    const uint8_t b = fz_byte(in);
    return b < 100 ? h2 * pow(2, (b - 30) / 3.0) : b < 128 ? 0 : fz_number(in);
}

/* A bound that is told, whatever the answer; and with HD_OK one that says something. */
static void fz_check_report(hd_status st, const hd_report *rep) {
    FZ(rep->status == st);
    if (st < 0) {
        FZ(rep->error.status == st && rep->error.text[0]);
        return;
    }
    if (!(rep->error_bound >= 0))
        fprintf(stderr, "bound %g: %g, %g, %g\n", rep->error_bound, rep->error_rational, rep->error_solver, rep->error_rounding);
    FZ(rep->error_bound >= 0 && rep->error_rational >= 0 && rep->error_solver >= 0 && rep->error_rounding >= 0);
    if (st == HD_OK) FZ(rep->error_bound <= 1e-2);
    FZ(rep->reason && rep->reason[0]);
    FZ(rep->mass_drift == rep->mass_drift);
}

/* 1'B u = 1'B f for a field and its answer, up to what the bound on the error allows. */
static void fz_check_mass(const hd_laplacian *lap, const double *f, const double *u, const hd_report *rep) {
    const double unit = 1.0 / (1 << 30);          /* sums of numbers near the largest double stay finite */
    double before = 0, after = 0, size = 0, most = 0, total = 0;
    int32_t r;
    if (lap->conserves != 1) return;
    for (r = 0; r < lap->n_active; r++) {
        const int32_t v = lap->vertex[r];
        before += lap->mass[r] * (unit * f[v]);
        after += lap->mass[r] * (unit * u[v]);
        size += fabs(lap->mass[r] * (unit * f[v]));      /* a row of B may sum to less than zero */
        total += fabs(lap->mass[r]);
        if (unit * fabs(u[v]) > most) most = unit * fabs(u[v]);
    }
    if (!mio_is_finite(size) || !mio_is_finite(total * most)) return;
    FZ(fabs(after - before) <= rep->error_bound * most * total + 1e-12 * size + DBL_MIN);
}

typedef struct fz_query {
    int32_t n_times, k, n_pairs;
    double t[FZ_TIMES];
    int32_t id[FZ_FIELDS], i[FZ_PAIRS], j[FZ_PAIRS];
    hd_kernel kernel;
    hd_distance_kind kind;
    double *f, *u, *v;                            /* [n FIELDS], [n FIELDS TIMES] and entries, distances of pairs */
    int64_t room;
} fz_query;

static void fz_query_make(fz_query *q, fz_in *in, const hd_laplacian *lap) {
    int32_t k;
    q->n_times = 1 + fz_below(in, FZ_TIMES);
    q->k = 1 + fz_below(in, FZ_FIELDS);
    q->n_pairs = 1 + fz_below(in, FZ_PAIRS);
    for (k = 0; k < q->n_times; k++) q->t[k] = fz_time(in, lap);
    for (k = 0; k < q->k; k++) q->id[k] = fz_int(in, lap->n);
    for (k = 0; k < q->n_pairs; k++) {
        q->i[k] = fz_int(in, lap->n);
        q->j[k] = fz_int(in, lap->n);
    }
    q->kernel = (hd_kernel)fz_int(in, 2);
    q->kind = (hd_distance_kind)fz_int(in, 4);
    q->room = (int64_t)lap->n * FZ_FIELDS * FZ_TIMES + lap->L.nnz * FZ_TIMES + FZ_PAIRS * FZ_TIMES;
    q->f = (double *)calloc((size_t)lap->n * FZ_FIELDS, sizeof *q->f);
    q->u = (double *)calloc((size_t)q->room, sizeof *q->u);
    q->v = (double *)calloc((size_t)q->room, sizeof *q->v);
    if (!q->f || !q->u || !q->v) abort();
    for (k = 0; k < q->room; k++) q->u[k] = q->v[k] = (double)NAN;
}

static void fz_query_free(fz_query *q) {
    free(q->f);
    free(q->u);
    free(q->v);
}

static void fz_field(hd_heat *heat, const hd_laplacian *lap, fz_query *q, fz_in *in, const fz_context *c) {
    const int64_t size = (int64_t)lap->n * q->k * q->n_times;
    hd_report rep;
    hd_error e;
    hd_status st;
    int32_t k, m;
    for (k = 0; k < lap->n * q->k; k++) q->f[k] = fz_number(in);
    st = fz_status(hd_heat_apply(heat, q->n_times, q->t, q->k, q->f, 0, q->u, 0, &rep, &e), &e, c);
    fz_check_report(st, &rep);
    if (st != HD_OK) return;
    FZ(fz_finite(q->u, size));
    for (k = 0; k < q->k; k++)
        for (m = 0; m < q->n_times; m++)
            if (rep.poles != HD_POLES_OWN) fz_check_mass(lap, q->f + (size_t)k * (size_t)lap->n, q->u + (size_t)(k * q->n_times + m) * (size_t)lap->n, &rep);
}

static void fz_columns(hd_heat *heat, const hd_laplacian *lap, fz_query *q, const fz_context *c) {
    hd_report rep;
    hd_error e;
    const hd_status st = fz_status(hd_heat_columns(heat, q->kernel, q->n_times, q->t, VERTICES(q->k, q->id), q->u, 0, &rep, &e), &e, c);
    int32_t k, m;
    fz_check_report(st, &rep);
    if (st != HD_OK) return;
    FZ(fz_finite(q->u, (int64_t)lap->n * q->k * q->n_times));
    for (k = 0; k < q->k && q->kernel == HD_KERNEL_OPERATOR && rep.poles != HD_POLES_OWN; k++) {
        memset(q->f, 0, (size_t)lap->n * sizeof *q->f);
        q->f[q->id[k]] = 1;
        for (m = 0; m < q->n_times; m++) fz_check_mass(lap, q->f, q->u + (size_t)(k * q->n_times + m) * (size_t)lap->n, &rep);
    }
}

/* Signatures, times, derivatives and adjoints. */
static void fz_one_more(hd_heat *heat, const hd_laplacian *lap, fz_query *q, fz_in *in, const fz_context *c) {
    static const char *const names[] = {"derivative", "adjoint", "trace", "diagonal and trace", "diagonal", "times"};
    const int64_t n = lap->n;
    const int which = fz_byte(in) % 6;
    hd_report rep;
    hd_error e;
    hd_status st;
    double t[3];
    int64_t values = n * q->k * q->n_times;
    int32_t k;
    fz_what = names[which];
    for (k = 0; k < lap->n * q->k && which < 2; k++) q->f[k] = fz_number(in);
    switch (which) {
    case 0: st = hd_heat_derivative(heat, q->n_times, q->t, q->k, q->f, 0, q->u, 0, &rep, &e); break;
    case 1: st = hd_heat_adjoint(heat, q->n_times, q->t, q->k, q->f, 0, q->u, 0, &rep, &e); break;
    case 2: st = hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, q->n_times, q->t, NULL, 0, q->u, q->v, &rep, &e), values = q->n_times; break;
    case 3: st = hd_heat_diagonal(heat, q->kernel, q->n_times, q->t, q->u, 0, t, q->v, &rep, &e), values = n * q->n_times; break;
    case 4: st = hd_heat_diagonal(heat, q->kernel, q->n_times, q->t, q->u, 0, t, NULL, &rep, &e), values = n * q->n_times; break;
    default:
        if (fz_status(hd_times_auto(lap, q->n_times, t, &e), &e, c) >= 0) FZ(fz_no_nan(t, q->n_times));
        return;
    }
    fz_status(st, &e, c);
    fz_check_report(st, &rep);
    if (st < 0) return;
    FZ(fz_no_nan(q->u, values));
    if (st == HD_OK) FZ(fz_finite(q->u, values));
    if (which == 2 || which == 3) for (k = 0; k < q->n_times; k++) FZ(q->v[k] >= 0);
    if (which == 3 || which == 4) FZ(fz_no_nan(t, q->n_times));
}

static int fz_timeless(hd_distance_kind kind) { return kind == HD_DISTANCE_COMMUTE || kind == HD_DISTANCE_BIHARMONIC; }

static void fz_one(hd_heat *heat, const hd_laplacian *lap, fz_query *q, fz_in *in, const fz_context *c) {
    static const char *const names[] = {"fields", "columns", "diagonal", "trace", "distance", "pairs", "sample", "entries", "estimate"};
    const int64_t n = lap->n;
    const uint8_t way = fz_byte(in), which = way % 9;
    hd_report rep;
    hd_error e;
    hd_status st = HD_OK;
    hd_estimate estimate;
    int64_t values = 0;
    const hd_sources given = hd_vertices(1, q->id);
    int32_t points[8], k;
    if (way >= 216) { fz_one_more(heat, lap, q, in, c); return; }
    fz_what = names[which];
    if (which == 0) { fz_field(heat, lap, q, in, c); return; }
    if (which == 1) { fz_columns(heat, lap, q, c); return; }
    if (which == 8) {
        (void)fz_status(hd_heat_estimate(heat, (hd_query)fz_int(in, 10), q->n_times, q->t, q->k, &estimate, &e), &e, c);
        return;
    }
    if (which == 2) st = hd_heat_diagonal(heat, q->kernel, q->n_times, q->t, q->u, 0, NULL, NULL, &rep, &e), values = n * q->n_times;
    if (which == 3) st = hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, q->n_times, q->t, NULL, 0, q->u, NULL, &rep, &e), values = q->n_times;
    if (which == 4) {
        if (fz_timeless(q->kind)) q->n_times = 1;
        st = hd_heat_distance(heat, q->kind, q->n_times, q->t, VERTICES(q->k, q->id), q->u, 0, &rep, &e), values = n * q->n_times * q->k;
    }
    if (which == 5) {
        if (fz_timeless(q->kind)) q->n_times = 1;
        st = hd_heat_distance_pairs(heat, q->kind, q->n_times, q->t, q->n_pairs, q->i, q->j, q->u, &rep, &e), values = q->n_pairs * q->n_times;
    }
    if (which == 6) {
        const int32_t count = 1 + fz_below(in, 8);
        st = hd_heat_sample(heat, q->kind, q->t[0], fz_below(in, 2) ? &given : NULL, count, points, q->u, &rep, &e), values = count;
        for (k = 0; k < count && st >= 0; k++) FZ(points[k] >= 0 && points[k] < lap->n);
    }
    if (which == 7) st = hd_heat_entries(heat, q->kernel, q->n_times, q->t, q->n_pairs, q->i, q->j, q->u, &rep, &e), values = q->n_pairs * q->n_times;
    fz_status(st, &e, c);
    fz_check_report(st, &rep);
    if (st < 0) return;
    FZ(fz_no_nan(q->u, values));
    if (st == HD_OK && (which < 4 || which == 7 || !fz_timeless(q->kind))) FZ(fz_finite(q->u, values));
    if (which >= 4 && which < 6) for (; values > 0; values--) FZ(q->u[values - 1] >= 0);
}

static hd_heat_opts fz_heat_opts(fz_in *in, int32_t *perm, const hd_laplacian *lap) {
    uint8_t way = fz_byte(in);
    hd_heat_opts o;
    int32_t k, turn;
    memset(&o, 0, sizeof o);
    o.method = (hd_method)(way % 4);
    if ((way & 60) == 60) {                       /* hardly any plan takes all four */
        o.method = HD_METHOD_LOCAL;
        way &= 195;
    }
    o.max_iterations = 400;
    if (way & 4) o.solver = (hd_solver)fz_int(in, 5);
    if (way & 8) o.precond = (hd_precond)fz_int(in, 6);
    if (way & 16) o.poles = (hd_pole_kind)fz_int(in, 5);
    if (way & 32) o.degree = fz_int(in, 16);
    if (way & 64) o.tol = fabs(fz_number(in));
    if (way & 128) {
        o.ordering = (hd_ordering)fz_int(in, 4);
        turn = fz_below(in, lap->n);
        for (k = 0; k < lap->n; k++) perm[k] = (k + turn) % lap->n;
        if (fz_byte(in) > 250) perm[0] = fz_int(in, lap->n);
        o.perm = perm;
    }
    return o;
}

static void fz_plan(fz_in *in, const hd_laplacian *lap, const fz_context *c) {
    int32_t *perm = (int32_t *)calloc((size_t)lap->n, sizeof *perm);
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    int k;
    if (!perm) abort();
    o = fz_heat_opts(in, perm, lap);
    fz_what = "plan";
    if (fz_status(hd_heat_create(&heat, lap, &o, &e), &e, c) >= 0) {
        for (k = 0; k < 3 && (k == 0 || in->p < in->end); k++) {
            fz_query q;
            fz_query_make(&q, in, lap);
            fz_one(heat, lap, &q, in, c);
            fz_query_free(&q);
        }
    } else {
        FZ(!heat);
    }
    hd_heat_free(heat);
    free(perm);
}

static void fz_spectrum(fz_in *in, const hd_laplacian *lap, const fz_context *c) {
    hd_spectrum_opts o;
    hd_spectrum *s = NULL;
    hd_error e;
    hd_status st;
    int32_t k;
    fz_what = "spectrum";
    memset(&o, 0, sizeof o);
    o.count = fz_int(in, lap->n_active + 2);
    if (fz_byte(in) & 1) o.below = fz_number(in);
    st = fz_status(hd_spectrum_create(&s, lap, &o, &e), &e, c);
    if (st >= 0) {
        fz_query q;
        FZ(s->count >= 0 && s->count <= lap->n_active && fz_finite(s->value, s->count) && fz_finite(s->vector, (int64_t)s->n * s->count));
        for (k = 1; k < s->count; k++) FZ(s->value[k] >= s->value[k - 1]);
        if (st == HD_OK) FZ(s->proven && s->n_poor == 0);
        fz_query_make(&q, in, lap);
        if (fz_status(hd_spectrum_columns(s, q.kernel, q.n_times, q.t, VERTICES(q.k, q.id), q.u, q.v, 0, &e), &e, c) >= 0)
            FZ(fz_no_nan(q.u, (int64_t)lap->n * q.k * q.n_times) && fz_no_nan(q.v, (int64_t)lap->n * q.k * q.n_times));
        if (fz_status(hd_spectrum_diagonal(s, q.kernel, q.n_times, q.t, q.u, q.v, 0, &e), &e, c) >= 0)
            FZ(fz_no_nan(q.u, (int64_t)lap->n * q.n_times) && fz_no_nan(q.v, (int64_t)lap->n * q.n_times));
        if (fz_timeless(q.kind)) q.n_times = 1;
        if (fz_status(hd_spectrum_distance(s, q.kind, q.n_times, q.t, VERTICES(q.k, q.id), q.u, q.v, 0, &e), &e, c) >= 0)
            FZ(fz_no_nan(q.u, (int64_t)lap->n * q.k * q.n_times) && fz_no_nan(q.v, (int64_t)lap->n * q.k * q.n_times));
        fz_query_free(&q);
    } else {
        FZ(!s);
    }
    hd_spectrum_free(s);
}

static void fz_shifted(fz_in *in, const hd_laplacian *lap, const fz_context *c) {
    hd_c64 *x = (hd_c64 *)calloc((size_t)lap->n, sizeof *x), theta;
    hd_solve_opts o;
    hd_solve_report rep;
    hd_error e;
    hd_status st;
    double t;
    int32_t k;
    if (!x) abort();
    fz_what = "shifted";
    memset(&o, 0, sizeof o);
    o.solver = (hd_solver)fz_int(in, 4);
    o.precond = (hd_precond)fz_int(in, 6);
    o.max_iterations = 300;
    t = fz_time(in, lap);
    theta.re = fz_number(in);
    theta.im = fz_number(in);
    for (k = 0; k < lap->n; k++) {
        x[k].re = fz_number(in);
        x[k].im = fz_number(in);
    }
    st = fz_status(hd_shifted_solve(lap, t, theta, x, x, &o, &rep, &e), &e, c);
    if (st == HD_OK) FZ(fz_finite(&x->re, 2 * (int64_t)lap->n) && rep.residual >= 0);
    free(x);
}

static void fz_geodesic(fz_in *in, const shape *s, fz_context *c) {
    hd_geodesic_opts o;
    hd_geodesic *g = NULL;
    hd_geodesic_report rep;
    hd_error e;
    hd_status st;
    int32_t id[3], k, count;
    double *d = (double *)calloc((size_t)(3 * s->n), sizeof *d);
    if (!d) abort();
    fz_what = "geodesic";
    memset(&o, 0, sizeof o);
    o.context = &c->ctx;
    o.mass = (hd_geodesic_mass)fz_int(in, 2);
    o.updatable = fz_byte(in) & 1;
    if (fz_byte(in) & 1) o.t = fz_number(in);
    if (fz_status(hd_geodesic_create(&g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e), &e, c) >= 0) {
        count = 1 + fz_below(in, 3);
        for (k = 0; k < 3; k++) id[k] = fz_int(in, s->n);
        st = fz_status(hd_geodesic_distance(g, TOGETHER(count, id), d, 0, &rep, &e), &e, c);
        FZ(rep.status == st);
        if (st >= 0) for (k = 0; k < s->n; k++) FZ(d[k] >= 0);
        if (o.updatable && fz_byte(in) & 1) {
            s->xyz[fz_below(in, 3 * s->n)] = fz_number(in);
            (void)fz_status(hd_geodesic_update(g, MESH_POINTS(s->xyz, s->n), &e), &e, c);
        }
        st = fz_status(hd_geodesic_distance(g, VERTICES(count, id), d, 0, &rep, &e), &e, c);
        if (st >= 0) for (k = 0; k < s->n * count; k++) FZ(d[k] >= 0);
    } else {
        FZ(!g);
    }
    hd_geodesic_free(g);
    free(d);
}

/* What came through is asked. */
static void fz_ask(fz_in *in, const hd_laplacian *lap, const fz_context *c) {
    switch (fz_byte(in) % 8) {
    case 0: fz_spectrum(in, lap, c); break;
    case 1: fz_shifted(in, lap, c); break;
    default: fz_plan(in, lap, c); break;
    }
}

static void fz_operators(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    int32_t held[4];
    shape s;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    s = fz_soup(&in);
    if (!s.xyz) return;
    if (fz_byte(&in) > 230) {
        fz_geodesic(&in, &s, &c);
    } else {
        o = fz_laplacian_opts(&in, &c.ctx, held, s.n);
        if (fz_status(fz_laplacian_of(&in, &lap, &s, &o, &e), &e, &c) >= 0) {
            fz_check_laplacian(lap);
            fz_ask(&in, lap, &c);
            if (lap->moving && fz_byte(&in) & 1) {
                s.xyz[fz_below(&in, 3 * s.n)] = fz_number(&in);
                fz_what = "update";
                (void)fz_status(hd_laplacian_update(lap, MESH_POINTS(s.xyz, lap->n), &e), &e, &c);
                fz_check_laplacian(lap);
                fz_ask(&in, lap, &c);
            }
        } else {
            FZ(!lap);
        }
        hd_laplacian_free(lap);
    }
    fz_context_done(&c);
    shape_free(&s);
}

/* A ball and a grid that do not touch. */
static shape fz_ball_and_grid(int finer, int32_t columns) {
    static const double offset[3] = {4, 0, 0};
    shape a = shape_icosphere(finer), b = shape_grid(columns, 3, 0.3), s = shape_disjoint(&a, &b, offset);
    shape_free(&a);
    shape_free(&b);
    return s;
}

/* The Laplacian of a shape, with options of four bits; NULL after an error. */
static hd_laplacian *fz_open(const shape *s, int bits, int tufted, fz_context *c) {
    static const int32_t held = 2;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.context = &c->ctx;
    o.kind = (hd_laplacian_kind)(bits & 3);
    if (bits & 4) o.border = HD_BORDER_DIRICHLET;
    if (bits & 8) { o.n_held = 1; o.held = &held; }
    o.triangulation = tufted ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
    if (fz_status(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e), &e, c) < 0) FZ(!lap);
    return lap;
}

/* Well-formed meshes, and every query of them. */
static void fz_queries(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    hd_laplacian *lap;
    uint8_t way;
    shape s;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    way = fz_byte(&in);
    s = fz_ball_and_grid(way & 1, 3 + (way >> 1 & 3));
    lap = fz_open(&s, way >> 3, 0, &c);
    if (lap) fz_ask(&in, lap, &c);
    if (lap) fz_ask(&in, lap, &c);
    hd_laplacian_free(lap);
    fz_context_done(&c);
    shape_free(&s);
}

/* ---- lengths ---- */

/* Sides as long as in space, some of them changed; or any. */
static void fz_sides(fz_in *in, const shape *s, double *lengths) {
    const uint8_t way = fz_byte(in);
    int32_t f, q, changes = fz_below(in, 6);
    for (f = 0; f < s->n_tri; f++) {
        for (q = 0; q < 3; q++) {
            const int32_t i = s->tri[3 * f + q], j = s->tri[3 * f + (q + 1) % 3];
            const int in_range = i >= 0 && j >= 0 && i < s->n && j < s->n;
            lengths[3 * f + q] = way > 200 || !in_range ? fz_number(in) : shape_distance(s->xyz + 3 * i, s->xyz + 3 * j);
            if (way & 1 && in_range) lengths[3 * f + q] = 1 + ((i + 1) * (j + 1) % 7) / 16.0;
        }
    }
    for (; changes > 0 && s->n_tri > 0; changes--) lengths[fz_byte(in) % (3 * s->n_tri)] = fz_number(in);
}

static void fz_lengths(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    double *lengths;
    int32_t held[4];
    shape s;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    s = fz_soup(&in);
    if (!s.xyz) return;
    lengths = (double *)malloc((3 * (size_t)s.n_tri + 1) * sizeof *lengths);
    if (!lengths) abort();
    fz_sides(&in, &s, lengths);
    o = fz_laplacian_opts(&in, &c.ctx, held, s.n);
    fz_what = "lengths";
    if (fz_status(hd_laplacian_create(&lap, MESH_LENGTHS(lengths, s.n, s.tri, s.n_tri), &o, &e), &e, &c) >= 0) {
        FZ(!lap->xyz);
        fz_check_laplacian(lap);
        FZ(lap->lambda_max >= 0);
        fz_ask(&in, lap, &c);
    } else {
        FZ(!lap);
    }
    hd_laplacian_free(lap);
    fz_context_done(&c);
    free(lengths);
    shape_free(&s);
}

/* ---- sources ---- */

enum { FZ_SOURCE_POINTS = 8, FZ_SOURCE_CORNERS = 5 };

typedef struct fz_source {
    hd_sources all;
    int64_t first[FZ_FIELDS + 1];
    int32_t vertex[FZ_SOURCE_POINTS * FZ_SOURCE_CORNERS];
    double bary[FZ_SOURCE_POINTS * FZ_SOURCE_CORNERS], weight[FZ_SOURCE_POINTS], length[FZ_SOURCE_POINTS];
} fz_source;

/* Points between the corners of faces, or between any; with coordinates that sum to one, or any; as several sources. */
static void fz_source_make(fz_source *p, fz_in *in, const shape *s, int32_t count) {
    const uint8_t way = fz_byte(in);
    hd_sources *const o = &p->all;
    int32_t k, q, corners, points;
    memset(p, 0, sizeof *p);
    points = way > 250 ? fz_int(in, 4) : 1 + fz_below(in, FZ_SOURCE_POINTS);
    if (points > FZ_SOURCE_POINTS) points = FZ_SOURCE_POINTS;
    o->corners = way > 246 ? fz_int(in, 5) : fz_below(in, 4);
    if (o->corners > FZ_SOURCE_CORNERS) o->corners = FZ_SOURCE_CORNERS;
    corners = o->corners > 0 ? o->corners : 1;
    for (k = 0; k < FZ_SOURCE_POINTS; k++) {
        const int32_t f = way & 1 && s->n_tri > 0 ? fz_below(in, s->n_tri) : -1;
        double sum = 0;
        for (q = 0; q < corners; q++) {
            p->vertex[k * corners + q] = f >= 0 ? s->tri[3 * f + (q + way) % 3] : fz_int(in, s->n);
            p->bary[k * corners + q] = way & 2 ? fz_byte(in) / 255.0 : fz_number(in);
            sum += p->bary[k * corners + q];
        }
        for (q = 0; q < corners && way & 2 && sum > 0; q++) p->bary[k * corners + q] /= sum;
        p->weight[k] = fz_number(in);
        p->length[k] = fz_number(in);
    }
    for (k = 0; k + 1 < count; k++) p->first[k + 1] = p->first[k] + 1 + fz_below(in, 3);
    p->first[count] = way > 250 || points > p->first[count - 1] ? points : p->first[count - 1] + 1;
    o->count = count;
    o->first = (way & 192) == 192 ? NULL : p->first;
    o->vertex = way == 4 ? NULL : p->vertex;
    o->bary = way & 4 ? p->bary : NULL;
    o->weight = way & 8 && !(way & 16) ? p->weight : NULL;
    o->curve = way & 16 ? (way == 16 ? fz_int(in, 3) : 1) : 0;
    o->length = way & 32 ? p->length : NULL;
    if (way == 255) o->end_zero = 1;
}

/* Columns of k_t hold as much heat as their sources weigh. */
static void fz_source_heat(const hd_laplacian *lap, const hd_sources *o, int32_t q, const double *u, const hd_report *rep) {
    const int64_t end = o->first ? o->first[q + 1] : q + 1;
    double heat = 0, weight = 0, size = 0, total = 0, most = 0;
    int64_t k;
    int32_t r;
    if (lap->conserves != 1 || lap->n_active < lap->n || o->curve) return;
    for (k = o->first ? o->first[q] : q; k < end; k++) {
        weight += o->weight ? o->weight[k] : 1;
        size += o->weight ? fabs(o->weight[k]) : 1;
    }
    for (r = 0; r < lap->n_active; r++) {
        heat += lap->mass[r] * u[lap->vertex[r]];
        total += lap->mass[r];
        if (fabs(u[lap->vertex[r]]) > most) most = fabs(u[lap->vertex[r]]);
    }
    if (mio_is_finite(total * most)) FZ(fabs(heat - weight) <= rep->error_bound * most * total + 2e-6 * size);
}

static void fz_sources_ask(fz_in *in, const shape *s, const hd_laplacian *lap, hd_geodesic *g, const fz_context *c) {
    fz_source from;
    hd_heat *heat = NULL;
    hd_heat_opts o;
    hd_report rep;
    hd_error e;
    hd_status st;
    fz_query q;
    int32_t k, m;
    memset(&o, 0, sizeof o);
    o.method = (hd_method)fz_below(in, 5);
    o.max_iterations = 400;
    if (fz_status(hd_heat_create(&heat, lap, &o, &e), &e, c) < 0) return;
    fz_query_make(&q, in, lap);
    fz_source_make(&from, in, s, q.k);
    fz_what = "columns from sources";
    st = fz_status(hd_heat_columns(heat, q.kernel, q.n_times, q.t, &from.all, q.u, 0, &rep, &e), &e, c);
    fz_check_report(st, &rep);
    if (st == HD_OK) FZ(fz_finite(q.u, (int64_t)lap->n * q.k * q.n_times));
    for (k = 0; k < q.k && st == HD_OK && q.kernel == HD_KERNEL_SYMMETRIC; k++)
        for (m = 0; m < q.n_times; m++) fz_source_heat(lap, &from.all, k, q.u + (size_t)(k * q.n_times + m) * (size_t)lap->n, &rep);
    fz_what = "distance from sources";
    if (fz_timeless(q.kind)) q.n_times = 1;
    st = fz_status(hd_heat_distance(heat, q.kind, q.n_times, q.t, &from.all, q.u, 0, &rep, &e), &e, c);
    fz_check_report(st, &rep);
    if (st >= 0) for (k = 0; k < lap->n * q.k * q.n_times; k++) FZ(q.u[k] >= 0);
    fz_what = "geodesic distance from sources";
    if (g && fz_status(hd_geodesic_distance(g, &from.all, q.u, 0, NULL, &e), &e, c) >= 0)
        for (m = 0; m < s->n * q.k; m++) FZ(q.u[m] >= 0);
    fz_query_free(&q);
    hd_heat_free(heat);
}

static void fz_sources(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    hd_geodesic_opts o;
    hd_laplacian *lap;
    hd_geodesic *g = NULL;
    hd_error e;
    uint8_t way;
    shape s;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    way = fz_byte(&in);
    s = way < 200 ? fz_ball_and_grid(0, 3 + (way & 1)) : fz_soup(&in);
    memset(&o, 0, sizeof o);
    o.context = &c.ctx;
    o.triangulation = way & 32 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
    o.border = (hd_geodesic_border)fz_below(&in, 3);
    fz_what = "sources";
    lap = fz_open(&s, way >> 1, way & 32, &c);
    if (lap) {
        if (way & 64) (void)fz_status(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e), &e, &c);
        fz_sources_ask(&in, &s, lap, g, &c);
    }
    hd_geodesic_free(g);
    hd_laplacian_free(lap);
    fz_context_done(&c);
    shape_free(&s);
}

/* ---- geodesic distance of everything ---- */

static hd_geodesic_opts fz_geodesic_opts(fz_in *in, fz_context *c, int32_t n, int32_t *perm) {
    const uint8_t way = fz_byte(in);
    hd_geodesic_opts o;
    int32_t k;
    memset(&o, 0, sizeof o);
    o.context = &c->ctx;
    o.border = (hd_geodesic_border)fz_int(in, 3);
    if (way & 1) o.t = fz_number(in);
    if (way & 2) o.t_in_h2 = fz_number(in);
    if (way & 4) o.mass = (hd_geodesic_mass)fz_int(in, 2);
    if (way & 8) o.updatable = 1;
    o.triangulation = (hd_triangulation)(way / 16 & 3);
    if (way & 64) {
        o.mollify = fz_number(in);
        o.stiffening = fz_number(in);
        o.neighbours = fz_int(in, 130);
    }
    if (way & 128) {
        o.ordering = (hd_ordering)fz_int(in, 4);
        for (k = 0; k < n; k++) perm[k] = n - 1 - k;
        if (fz_byte(in) > 250) perm[0] = fz_int(in, n);
        o.perm = perm;
    }
    return o;
}

static hd_status fz_geodesic_of(fz_in *in, hd_geodesic **g, const shape *s, const hd_geodesic_opts *o, hd_error *e) {
    double lengths[3 * FZ_FACES];
    int64_t ptr[FZ_FACES + 1];
    hd_mesh view;
    int32_t f = 0;
    switch (fz_byte(in) % 5) {
    case 0: return hd_geodesic_create(g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), o, e);
    case 1:
        if (s->n_tri > FZ_FACES) return hd_geodesic_create(g, MESH_LENGTHS(NULL, s->n, s->tri, s->n_tri), o, e);
        fz_sides(in, s, lengths);
        return hd_geodesic_create(g, MESH_LENGTHS(lengths, s->n, s->tri, s->n_tri), o, e);
    case 2:
        view = hd_triangles(s->xyz, s->n, s->tri, s->n_tri);
        view.stride = 24;
        return hd_geodesic_create(g, &view, o, e);
    case 3:
        for (ptr[0] = 0; f < FZ_FACES && ptr[f] < 3 * (int64_t)s->n_tri; f++) {
            const int64_t next = ptr[f] + fz_below(in, 9) + (in->p == in->end ? 3 : 0);
            ptr[f + 1] = next < 3 * (int64_t)s->n_tri ? next : 3 * (int64_t)s->n_tri;
        }
        return hd_geodesic_create(g, MESH_POLYGONS(s->xyz, s->n, ptr, s->tri, f), o, e);
    default: return hd_geodesic_create(g, MESH_POINTS(s->xyz, s->n), o, e);
    }
}

static void fz_geodesics(const uint8_t *data, size_t size) {
    static const char *const names[] = {"geodesic", "geodesic of lengths", "geodesic of a view", "geodesic of polygons", "geodesic of points"};
    fz_in in;
    fz_context c;
    hd_geodesic_opts o;
    hd_geodesic *g = NULL;
    hd_error e;
    fz_source from;
    double *d;
    int32_t perm[FZ_VERTICES + 2], id[3], k, turn;
    shape s;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    s = fz_soup(&in);
    if (!s.xyz) return;
    d = (double *)calloc(3 * (size_t)s.n, sizeof *d);
    if (!d) abort();
    o = fz_geodesic_opts(&in, &c, s.n, perm);
    fz_what = names[in.p < in.end ? *in.p % 5 : 0];
    if (fz_status(fz_geodesic_of(&in, &g, &s, &o, &e), &e, &c) >= 0) {
        for (turn = 0; turn < 2; turn++) {
            for (k = 0; k < 3; k++) id[k] = fz_int(&in, s.n);
            if (fz_status(hd_geodesic_distance(g, TOGETHER(1 + fz_below(&in, 3), id), d, 0, NULL, &e), &e, &c) >= 0)
                for (k = 0; k < s.n; k++) FZ(d[k] >= 0);
            if (fz_status(hd_geodesic_distance(g, VERTICES(3, id), d, 0, NULL, &e), &e, &c) >= 0)
                for (k = 0; k < 3 * s.n; k++) FZ(d[k] >= 0);
            fz_source_make(&from, &in, &s, 1 + turn);
            if (fz_status(hd_geodesic_distance(g, &from.all, d, 0, NULL, &e), &e, &c) >= 0)
                for (k = 0; k < (1 + turn) * s.n; k++) FZ(d[k] >= 0);
            s.xyz[fz_below(&in, 3 * s.n)] = fz_number(&in);
            if (turn == 0) (void)fz_status(hd_geodesic_update(g, MESH_POINTS(s.xyz, s.n), &e), &e, &c);
        }
    } else {
        FZ(!g);
    }
    hd_geodesic_free(g);
    fz_context_done(&c);
    free(d);
    shape_free(&s);
}

/* ---- matrices ---- */

typedef struct fz_matrix {
    hd_csr a;
    int64_t ptr[20];
    int32_t col[256];
    double val[256];
} fz_matrix;

/* Anything, within arrays as long as it says. */
static void fz_matrix_any(fz_matrix *m, fz_in *in) {
    int64_t p, at = 0;
    int32_t i;
    m->a.n_rows = fz_below(in, 14);
    m->a.n_cols = fz_byte(in) < 200 ? m->a.n_rows : fz_int(in, 14);
    for (i = 0; i <= m->a.n_rows; i++) {
        m->ptr[i] = at;
        at += fz_below(in, 6);
    }
    m->a.nnz = m->ptr[m->a.n_rows];
    for (p = 0; p < m->a.nnz; p++) {
        m->col[p] = fz_int(in, m->a.n_cols);
        m->val[p] = fz_number(in);
    }
    if (fz_byte(in) > 230) m->ptr[fz_below(in, m->a.n_rows + 1)] = (int64_t)fz_raw(in, 8);
    if (fz_byte(in) > 240) m->a.n_rows = -m->a.n_rows;
    if (fz_byte(in) > 240) m->a.nnz = fz_byte(in) & 1 ? -1 : m->a.nnz / 2;
}

/* Symmetric: a random pattern, off-diagonal values of one sign or any, a diagonal that is right, or not quite. */
static void fz_matrix_symmetric(fz_matrix *m, fz_in *in, int32_t n, double diagonal) {
    double x[14][14];
    char there[14][14];
    const uint8_t way = fz_byte(in);
    int32_t i, j;
    memset(x, 0, sizeof x);
    memset(there, 0, sizeof there);
    for (i = 0; i < n; i++) {
        for (j = 0; j < i; j++) {
            const uint8_t b = fz_byte(in);
            if (b < 128) continue;
            there[i][j] = there[j][i] = 1;
            x[i][j] = x[j][i] = way & 1 ? fz_number(in) : -(b - 127) / 64.0;
        }
    }
    for (i = 0; i < n; i++) {
        double sum = 0;
        for (j = 0; j < n; j++) sum += fabs(x[i][j]);
        there[i][i] = 1;
        x[i][i] = way & 2 ? fz_number(in) : sum + diagonal;
    }
    m->a.n_rows = m->a.n_cols = n;
    m->a.nnz = 0;
    for (i = 0; i < n; i++) {
        m->ptr[i] = m->a.nnz;
        for (j = 0; j < n; j++) {
            if (!there[i][j]) continue;
            m->col[m->a.nnz] = j;
            m->val[m->a.nnz++] = x[i][j];
        }
    }
    m->ptr[n] = m->a.nnz;
}

static void fz_csr_out(hd_status st, hd_csr *out, const hd_error *e, fz_context *c) {
    if (fz_status(st, e, c) < 0) return;
    fz_csr_check(out, 0);
    hd_csr_free(out, &c->ctx);
}

static void fz_csr(fz_in *in, fz_context *c) {
    hd_csr out;
    hd_error e;
    int32_t i[24], j[24], k, n = fz_below(in, 24);
    double v[24];
    fz_what = "csr";
    (void)fz_byte(in);                           /* kept inputs have it */
    for (k = 0; k < n; k++) {
        i[k] = fz_int(in, 9);
        j[k] = fz_int(in, 7);
        v[k] = fz_number(in);
    }
    fz_csr_out(hd_csr_from_triplets(&out, fz_int(in, 10), fz_int(in, 8), n, i, j, fz_byte(in) > 200 ? NULL : v, &c->ctx, &e), &out, &e, c);
}

static void fz_ldl(fz_in *in, const fz_matrix *m, fz_context *c) {
    const int32_t n = m->a.n_rows;
    hd_ldl_opts o;
    hd_ldl_report rep;
    hd_ldl *f = NULL;
    hd_error e;
    double b[28], x[28], inverse[256], diag[14];
    hd_c64 z[512], zx[28], zi[512], zd[28];
    int32_t k;
    fz_what = "ldl";
    memset(&o, 0, sizeof o);
    o.context = &c->ctx;
    o.ordering = (hd_ordering)fz_int(in, 3);
    if (fz_status(hd_ldl_analyse(&f, &m->a, &o, &rep, &e), &e, c) < 0) {
        FZ(!f);
        return;
    }
    FZ(n <= 14 && m->a.nnz <= 256);
    for (k = 0; k < 10; k++) (void)fz_int(in, n);        /* kept inputs have them */
    for (k = 0; k < 2 * n; k++) b[k] = fz_number(in);
    for (k = 0; k < 2 * m->a.nnz; k++) {
        z[k].re = m->val[k % m->a.nnz];
        z[k].im = k & 1 ? 0.5 : -1;
    }
    if (fz_status(hd_ldl_factor(f, m->val, &rep, &e), &e, c) >= 0) {
        FZ(rep.growth >= 0 && rep.smallest_pivot >= 0 && rep.n_negative >= 0 && rep.n_negative <= n);
        (void)fz_status(hd_ldl_solve(f, 2, b, 0, x, 0, &e), &e, c);
        (void)fz_status(hd_ldl_inverse(f, inverse, diag, &e), &e, c);
    }
    if (fz_status(hd_ldl_factor_complex(f, 2, z, &rep, &e), &e, c) >= 0) {
        (void)fz_status(hd_ldl_solve_complex(f, z, 0, zx, 0, &e), &e, c);
        (void)fz_status(hd_ldl_inverse_complex(f, zi, zd, &e), &e, c);
    }
    hd_ldl_free(f);
}

static void fz_matrices(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    fz_matrix L, B;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    int32_t held[4];
    uint8_t way;
    int32_t n;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    memset(&L, 0, sizeof L);
    memset(&B, 0, sizeof B);
    L.a.row_ptr = L.ptr;
    L.a.col = L.col;
    L.a.val = L.val;
    B.a.row_ptr = B.ptr;
    B.a.col = B.col;
    B.a.val = B.val;
    way = fz_byte(&in);
    n = 1 + fz_below(&in, 13);
    if (way & 1) fz_matrix_any(&L, &in);
    else fz_matrix_symmetric(&L, &in, n, way & 2 ? 0.25 : 0);
    if (way & 4) fz_csr(&in, &c);
    if (way & 8) fz_ldl(&in, &L, &c);
    if (way & 16) fz_matrix_any(&B, &in);
    else fz_matrix_symmetric(&B, &in, n, 1);
    o = fz_laplacian_opts(&in, &c.ctx, held, n);
    fz_what = "own matrices";
    if (fz_status(hd_laplacian_matrices(&lap, &L.a, &B.a, way & 32 ? fz_number(&in) : 0, &o, &e), &e, &c) >= 0) {
        fz_check_laplacian(lap);
        fz_ask(&in, lap, &c);
        if (lap->moving && L.a.nnz > 0) {
            L.val[fz_below(&in, (int32_t)L.a.nnz)] = fz_number(&in);
            fz_what = "update of matrices";
            (void)fz_status(hd_laplacian_update_matrices(lap, &L.a, &B.a, 1, &e), &e, &c);
            fz_check_laplacian(lap);
            fz_ask(&in, lap, &c);
        }
    } else {
        FZ(!lap);
    }
    hd_laplacian_free(lap);
    fz_context_done(&c);
}

/* ---- options ---- */

/* Random bytes over a cleared struct. */
static void fz_scribble(fz_in *in, void *to, size_t size) {
    uint8_t *const p = (uint8_t *)to;
    int k, count = fz_below(in, 12);
    for (k = 0; k < count; k++) {
        const size_t at = (size_t)fz_raw(in, 1) % size;
        p[at] = fz_byte(in);
    }
}

static void fz_rational(fz_in *in, hd_rational *set) {
    int32_t k;
    if (fz_byte(in) & 1) {
        (void)hd_rational_exp(set, (hd_pole_kind)fz_int(in, 5), fz_int(in, 16), NULL);
        fz_scribble(in, set, sizeof *set);
        return;
    }
    set->kind = HD_POLES_OWN;
    set->n_poles = fz_int(in, 6);
    set->a0 = fz_number(in);
    for (k = 0; k < 6; k++) {
        set->theta[k].re = fz_number(in);
        set->theta[k].im = fabs(fz_number(in));
        set->a[k].re = fz_number(in);
        set->a[k].im = fz_number(in);
        set->degree += set->theta[k].im == 0 ? 1 : 2;
    }
    if (fz_byte(in) & 1) set->degree = fz_int(in, 20);
}

static void fz_option_queries(fz_in *in, const hd_laplacian *lap, const fz_context *c) {
    int32_t perm[16], id[4], k, n = lap->n;
    double t[4], u[4 * 4 * 24], d[24 * 16];
    hd_rational set, sets[4];
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    int32_t n_times, sources;
    size_t ld;
    memset(&o, 0, sizeof o);
    memset(&set, 0, sizeof set);
    fz_scribble(in, &o, sizeof o);
    o.context = NULL;
    for (k = 0; k < 16; k++) perm[k] = (k * 5 + 3) % n;
    o.perm = fz_byte(in) & 1 ? perm : NULL;
    fz_rational(in, &set);
    o.rational = fz_byte(in) & 1 ? &set : NULL;
    o.max_iterations = o.max_iterations > 500 ? 500 : o.max_iterations;
    if (fz_byte(in) & 7) o.begin_zero = o.end_zero = 0;
    n_times = fz_int(in, 5);
    sources = fz_int(in, 5);
    ld = fz_byte(in) & 1 ? 0 : (size_t)fz_int(in, 24);
    for (k = 0; k < 4; k++) {
        t[k] = fz_number(in);
        id[k] = fz_int(in, n);
    }
    fz_what = "options of plans";
    if (n_times > 4) n_times = 4;
    if (sources > 4) sources = 4;
    if ((int64_t)ld < 0 || ld > 24) ld = 24;
    if (fz_status(hd_heat_create(&heat, lap, &o, &e), &e, c) < 0) {
        FZ(!heat);
        return;
    }
    for (k = 0; k < 24 * 16; k++) u[k] = d[k] = 0.5;
    fz_status(hd_heat_columns(heat, (hd_kernel)fz_int(in, 2), n_times, t, VERTICES(sources, id), u, ld, NULL, &e), &e, c);
    fz_status(hd_heat_apply(heat, n_times, t, sources, d, ld, u, ld, NULL, &e), &e, c);
    fz_status(hd_heat_diagonal(heat, (hd_kernel)fz_int(in, 2), n_times, t, u, ld, NULL, NULL, NULL, &e), &e, c);
    fz_status(hd_heat_distance(heat, (hd_distance_kind)fz_int(in, 4), n_times, t, VERTICES(sources, id), d, ld, NULL, &e), &e, c);
    fz_status(hd_heat_distance_pairs(heat, (hd_distance_kind)fz_int(in, 4), n_times, t, sources, id, id, d, NULL, &e), &e, c);
    fz_status(hd_heat_entries(heat, (hd_kernel)fz_int(in, 2), n_times, t, sources, id, id, u, NULL, &e), &e, c);
    fz_status(hd_rational_shared(sets, n_times, t, fz_number(in), NULL, &e), &e, c);
    if (e.status >= 0) for (k = 0; k < n_times; k++) FZ(mio_is_finite(hd_rational_eval(sets + k, -fabs(t[k]))));
    hd_heat_free(heat);
}

static void fz_options_rest(fz_in *in, const shape *s, const hd_laplacian *lap, fz_context *c) {
    int32_t index[64], n = fz_int(in, 8), m = fz_int(in, 8);
    double d[64];
    hd_geodesic_opts go;
    hd_geodesic *g = NULL;
    hd_spectrum_opts so;
    hd_spectrum *p = NULL;
    hd_error e;
    fz_what = "options of eigenpairs";
    memset(&so, 0, sizeof so);
    fz_scribble(in, &so, sizeof so);
    so.context = &c->ctx;
    so.perm = NULL;
    if (fz_byte(in) & 7) so.begin_zero = so.end_zero = 0;
    if (fz_status(hd_spectrum_create(&p, lap, &so, &e), &e, c) >= 0) hd_spectrum_free(p);
    fz_what = "options of geodesics";
    memset(&go, 0, sizeof go);
    fz_scribble(in, &go, sizeof go);
    go.context = &c->ctx;
    go.perm = NULL;
    if (fz_byte(in) & 7) go.begin_zero = go.end_zero = 0;
    if (fz_status(hd_geodesic_create(&g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &go, &e), &e, c) >= 0) {
        fz_status(hd_geodesic_distance(g, VERTICES(1, &(int32_t){1}), d, 0, NULL, &e), &e, c);
        hd_geodesic_free(g);
    }
    fz_what = "neighbours";
    if (n > 8) n = 8;
    if (m > 8) m = 8;
    fz_status(hd_neighbours_nearest(s->xyz, n, fz_byte(in) & 1 ? s->xyz : NULL, m, fz_below(in, 9), index, d, &c->ctx, &e), &e, c);
    (void)fz_number(in);
}

static void fz_options(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_mesh view;
    hd_error e;
    int32_t held[4] = {0, 3, 7, 11};
    shape s = shape_icosphere(0);
    hd_status st;
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    memset(&o, 0, sizeof o);
    fz_scribble(&in, &o, sizeof o);
    o.context = &c.ctx;
    o.held = fz_byte(&in) & 1 ? held : NULL;
    if (o.n_held > 4) o.n_held = 4;
    if (fz_byte(&in) & 7) o.begin_zero = o.end_zero = 0;
    fz_what = "options of Laplacians";
    if (fz_byte(&in) & 1) {
        memset(&view, 0, sizeof view);
        fz_scribble(&in, &view, sizeof view);
        view.xyz_float = NULL;
        view.xyz = fz_byte(&in) & 3 ? s.xyz : NULL;
        view.lengths = NULL;
        view.corner = fz_byte(&in) & 3 ? s.tri : NULL;
        view.corner_u16 = fz_byte(&in) & 3 ? NULL : (const uint16_t *)(const void *)s.tri;
        view.face_ptr = NULL;
        view.nbr_ptr = NULL;
        view.nbr = NULL;
        if (view.n > 12 || view.n == 0) view.n = 12;
        if (view.n_faces > 20 || view.n_faces == 0) view.n_faces = 20;
        if (view.stride > 24) view.stride = 0;
        st = hd_laplacian_create(&lap, &view, &o, &e);
    } else {
        st = hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e);
    }
    if (fz_status(st, &e, &c) >= 0) {
        fz_check_laplacian(lap);
        if (lap->n <= 16 && lap->n > 1) fz_option_queries(&in, lap, &c);
        fz_options_rest(&in, &s, lap, &c);
    } else {
        FZ(!lap);
    }
    hd_laplacian_free(lap);
    fz_context_done(&c);
    shape_free(&s);
}

/* ---- filters ---- */

/* A filter of the caller's: a polynomial in 1/(1 + lambda), or what is in the table, which may be no number. */
static double fz_filter_own(double lambda, void *user) {
    const double *const p = (const double *)user, x = 1 / (1 + fabs(lambda));
    if (p[4] > 2) return p[(int)(4 * x) & 3];
    return p[0] + x * (p[1] + x * (p[2] + x * p[3]));
}

static hd_filter fz_filter(fz_in *in, double *own) {
    const uint8_t way = fz_byte(in);
    hd_filter f;
    int k;
    memset(&f, 0, sizeof f);
    f.kind = (hd_filter_kind)fz_int(in, 8);
    f.a = fz_number(in);
    f.b = fz_number(in);
    if (way & 1) f.a = fabs(f.a), f.b = f.kind == HD_FILTER_BAND ? 2 * f.a : fabs(f.b);
    if (way & 2) f.tol = fz_byte(in) & 1 ? fz_number(in) : pow(10, -fz_below(in, 12));
    if (way & 4) f.weight = fz_number(in);
    f.max_degree = way & 8 ? fz_int(in, HD_MAX_POLES + 1) : 8;            /* large degrees take long */
    if (way & 16) f.lambda_min = fz_number(in);
    if (way & 32) f.constant = 1;
    for (k = 0; k < 5; k++) own[k] = way & 64 ? fz_byte(in) / 64.0 : fz_number(in);
    f.f = way == 255 ? NULL : fz_filter_own;
    f.user = own;
    if (way == 128) f.end_zero = 1;
    return f;
}

/* What the set says of its error is so: between the points that it was measured at, up to a few times as much. */
static void fz_filter_check(const hd_filter *f, const hd_rational *set, double lambda_max) {
    int k;
    FZ(set->kind == HD_POLES_OWN && set->n_poles >= 0 && set->n_poles <= HD_MAX_POLES && set->degree <= HD_MAX_POLES);
    FZ(set->max_error >= 0 && set->max_weighted_error >= set->max_error && set->largest >= 0 && set->t > 0);
    FZ(fz_finite(&set->theta->re, 2 * set->n_poles) && fz_finite(&set->a->re, 2 * set->n_poles) && mio_is_finite(set->a0));
    for (k = 0; k < set->n_poles; k++) FZ(set->theta[k].im > 0 || (set->theta[k].im == 0 && set->theta[k].re > 0));
    if (f->kind == HD_FILTER_OWN) return;
    for (k = 0; k <= 40; k++) {
        const double x = lambda_max * (k < 20 ? pow(2, -2.5 * k) : (40 - k) / 20.0);
        const double off = fabs(hd_filter_eval(f, x) - hd_rational_eval(set, -x * set->t));
        if (x >= f->lambda_min) FZ(off <= 4 * set->max_error + 1e-13 * set->largest);
    }
}

static void fz_filters(const uint8_t *data, size_t size) {
    fz_in in;
    fz_context c;
    hd_filter f;
    hd_rational set, before;
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    hd_rational sets[2];
    double own[5], top;
    int32_t n_sets;
    uint8_t way;
    int k;
    shape s = shape_icosphere(0);
    in.p = data;
    in.end = data + size;
    fz_context_make(&c, &in);
    memset(&lo, 0, sizeof lo);
    memset(&o, 0, sizeof o);
    memset(&set, 0x6b, sizeof set);
    before = set;
    lo.context = &c.ctx;
    lo.kind = (hd_laplacian_kind)fz_below(&in, 4);
    fz_what = "filters";
    if (fz_status(hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &lo, &e), &e, &c) >= 0) {
        o.method = (hd_method)fz_below(&in, 3);
        o.max_iterations = 400;
        (void)fz_status(hd_heat_create(&heat, lap, &o, &e), &e, &c);
        for (k = 0; k < 2 && heat; k++) {
            f = fz_filter(&in, own);
            top = fz_byte(&in) < 224 ? lap->lambda_max : fz_number(&in);
            if (fz_status(hd_rational_fit(&set, 1, &f, top, &c.ctx, &e), &e, &c) >= 0) fz_filter_check(&f, &set, top);
            else FZ(k || memcmp(&set, &before, sizeof set) == 0);
            if (e.status < 0) continue;
            if (fz_byte(&in) > 240) set.theta[fz_below(&in, HD_MAX_POLES)].re = fz_number(&in);
            way = fz_byte(&in);
            n_sets = way > 250 ? 0 : way & 1 ? 1 : 2;
            sets[0] = sets[1] = set;
            if (way & 2) sets[1].a[0].re *= 0.5;
            if (way > 220) sets[1].t *= 2;
            if (fz_status(hd_heat_set_rational(heat, n_sets, n_sets ? sets : NULL, &e), &e, &c) >= 0) {
                fz_query q;
                fz_query_make(&q, &in, lap);
                if (fz_byte(&in) < 240) q.t[0] = set.t, q.n_times = 1;
                fz_one(heat, lap, &q, &in, &c);
                fz_query_free(&q);
            }
        }
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    fz_context_done(&c);
    shape_free(&s);
}

/* ---- targets ---- */

typedef struct fz_target { const char *name; void (*run)(const uint8_t *data, size_t size); } fz_target;

static const fz_target fz_targets[] = {
    {"mesh", fz_mesh}, {"table", fz_table}, {"operators", fz_operators}, {"queries", fz_queries}, {"matrices", fz_matrices},
    {"options", fz_options}, {"filters", fz_filters}, {"sources", fz_sources}, {"lengths", fz_lengths}, {"geodesics", fz_geodesics},
    {"levels", fz_levels},
};

enum { FZ_TARGETS = sizeof fz_targets / sizeof *fz_targets };

#ifdef HEATDIFF_LIBFUZZER

static const fz_target *fz_chosen = fz_targets;

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    int i, k;
    for (i = 1; i < *argc; i++)
        for (k = 0; k < FZ_TARGETS; k++)
            if (strncmp((*argv)[i], "--target=", 9) == 0 && strcmp((*argv)[i] + 9, fz_targets[k].name) == 0) fz_chosen = fz_targets + k;
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fz_chosen->run(data, size);
    return 0;
}

#else

static int fz_ran;
static const char *fz_unpack;                    /* folder, or NULL: run */

static void fz_input(const fz_target *target, const char *name, const uint8_t *data, size_t size) {
    char path[1024];
    FILE *f;
    uint8_t *copy;
    fz_ran++;
    if (!fz_unpack) {
        fz_what = name;
        copy = (uint8_t *)malloc(size ? size : 1);       /* of its own size, for sanitizers */
        if (!copy) abort();
        if (size) memcpy(copy, data, size);
        target->run(copy, size);
        free(copy);
        return;
    }
    snprintf(path, sizeof path, "%s/%s", fz_unpack, target->name);
    (void)mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/%s/kept-%d", fz_unpack, target->name, fz_ran);
    f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) != 0) {
        perror(path);
        exit(2);
    }
}

static void fz_lines(const fz_target *target, const char *corpus) {
    char path[1024], line[8200];
    uint8_t bytes[4100];
    unsigned u;
    FILE *f;
    snprintf(path, sizeof path, "%s/%s.txt", corpus, target->name);
    f = fopen(path, "rb");
    while (f && fgets(line, sizeof line, f)) {
        size_t n = 0;
        if (line[0] == '#') continue;
        while (n < sizeof bytes && sscanf(line + 2 * n, "%2x", &u) == 1) bytes[n++] = (uint8_t)u;
        fz_input(target, path, bytes, n);
    }
    if (f) fclose(f);
}

static void fz_folder(const fz_target *target, const char *corpus) {
    static uint8_t bytes[1 << 20];
    char path[512], file[1024];
    struct dirent *entry;
    DIR *dir;
    snprintf(path, sizeof path, "%s/%s", corpus, target->name);
    dir = opendir(path);
    while (dir && (entry = readdir(dir)) != NULL) {
        FILE *f;
        if (entry->d_name[0] == '.') continue;
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        f = fopen(file, "rb");
        if (!f) continue;
        fz_input(target, file, bytes, fread(bytes, 1, sizeof bytes, f));
        fclose(f);
    }
    if (dir) closedir(dir);
}

/* ---- random inputs ---- */

static unsigned long long fz_seed;

static void fz_on_signal(int sig) {
    char text[96];
    const int n = snprintf(text, sizeof text, "\nfuzz: signal %d at seed %llu\n", sig, fz_seed);
    (void)!write(2, text, (size_t)n);
    _exit(3);
}

/* The input of a seed: bytes of all kinds, or small ones with some of all kinds among them. */
static size_t fz_bytes_of(uint64_t seed, uint8_t *bytes, size_t most) {
    uint64_t x = seed * 0x9e3779b97f4a7c15u + 1;
    size_t n, k;
    int kind;
    x ^= x >> 29;
    kind = (int)(x % 4);
    n = (size_t)(x >> 8) % (kind ? most / 3 : most);
    for (k = 0; k < n; k++) {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        bytes[k] = (uint8_t)(x >> 32);
        if (kind == 1 && x >> 60) bytes[k] %= 160;
        if (kind == 2) bytes[k] %= 128;
    }
    return n;
}

static int fz_random(int argc, char **argv) {
    static uint8_t bytes[1024];
    const int one = strcmp(argv[1], "--seed") == 0;
    const double seconds = one ? 0 : atof(argv[3]);
    const time_t start = time(NULL);
    unsigned long long ran = 0;
    size_t n, i;
    int k;
    fz_seed = strtoull(argv[argc - 1], NULL, 10);
    signal(SIGABRT, fz_on_signal);
    signal(SIGALRM, fz_on_signal);
    for (k = 0; k < FZ_TARGETS && strcmp(fz_targets[k].name, argv[2]) != 0; k++) {}
    if (k == FZ_TARGETS) return 2;
    do {
        n = fz_bytes_of(fz_seed, bytes, sizeof bytes);
        if (one) {
            for (i = 0; i < n; i++) printf("%02x", bytes[i]);
            printf("\n");
            fflush(stdout);
        }
        if (!one) alarm(5);
        fz_targets[k].run(bytes, n);
        ran++;
        fz_seed++;
    } while ((double)(time(NULL) - start) < seconds);
    printf("%-10s %llu random inputs, next seed %llu\n", argv[2], ran, fz_seed);
    return 0;
}

int main(int argc, char **argv) {
    int k;
    if ((argc == 5 && strcmp(argv[1], "--random") == 0) || (argc == 4 && strcmp(argv[1], "--seed") == 0)) return fz_random(argc, argv);
    if (argc == 4 && strcmp(argv[2], "--unpack") == 0) fz_unpack = argv[3];
    if (argc != 2 && !fz_unpack) {
        fprintf(stderr, "usage: fuzz CORPUS [--unpack DIR]\n");
        return 2;
    }
    for (k = 0; k < FZ_TARGETS; k++) {
        fz_ran = 0;
        fz_lines(fz_targets + k, argv[1]);
        fz_folder(fz_targets + k, argv[1]);
        printf("%-10s %4d inputs\n", fz_targets[k].name, fz_ran);
        if (!fz_ran) {
            fprintf(stderr, "fuzz: no inputs of target %s in %s\n", fz_targets[k].name, argv[1]);
            return 1;
        }
    }
    return 0;
}

#endif
