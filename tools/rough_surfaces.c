/* rough_surfaces.c - how much heat changes on a noisy, incomplete or unevenly sampled surface

   Build and run from the project's folder:

       cc -O2 tools/rough_surfaces.c -o rough_surfaces -lm && ./rough_surfaces
       ./rough_surfaces FOLDER           also writes pictures and meshes to FOLDER, which must exist
       ./rough_surfaces FOLDER MESH      the same for a mesh of your own

   Variants of one surface are made in memory: noise along the normals, holes, an end cut off, and triangles
   that are a hundred times finer in some places than in others. On each variant the heat kernel k_t(x,
   source) and the diffusion distance to the source are computed at three times, by operators on meshes and on
   points. They are compared with the answer of the same operator on the original, at the vertices that both
   have.

   The tables, in Markdown, show the changes in percent of the original's largest value: root mean square and
   largest. The last table is about the maximum principle: how far heat falls below zero on bad triangles. The
   pictures show the original beside its variants in the same colours; the meshes carry both fields. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "meshio.h"
#include "picture.h"
#include "shapes.h"

enum { TIMES = 3, MIDDLE = 1, FIELDS = 2 * TIMES, SPOTS = 8, SOURCES = 8 };

/* A variant. of[v] is the vertex of the original that vertex v is; -1: none. */
typedef struct surface { shape s; int32_t *of; char name[64]; } surface;

/* Heat kernel and distance on a surface: value[q n + i], first TIMES kernels, then TIMES distances. */
typedef struct answer { int32_t n; double *value; } answer;

typedef struct method { const char *name; hd_laplacian_kind kind; int points, delaunay, tufted; } method;

static const method FEM = {"fem", HD_LAPLACIAN_FEM, 0, 0, 0},
                    PLAIN = {"voronoi-cot", HD_LAPLACIAN_VORONOI_COT, 0, 0, 0},
                    DELAUNAY = {"voronoi-cot, Delaunay", HD_LAPLACIAN_VORONOI_COT, 0, 1, 0},
                    TUFTED = {"voronoi-cot, tufted", HD_LAPLACIAN_VORONOI_COT, 0, 0, 1},
                    POINTS = {"points, voronoi-exp", HD_LAPLACIAN_VORONOI_EXP, 1, 0, 0},
                    STARS = {"points, tufted", HD_LAPLACIAN_VORONOI_COT, 1, 0, 1};

enum { ORIGINAL, NOISE_1, NOISE_2, NOISE_3, HOLES_1, HOLES_2, CUT, UNEVEN, VARIANTS };
static surface variant[VARIANTS];
static double times[TIMES];
static int32_t source;                  /* on the original */

static void stop(const char *what, const hd_error *e) {
    fprintf(stderr, "rough_surfaces: %s: %s\n", what, e ? e->text : "out of memory, or no such folder");
    exit(1);
}

static void *room(int64_t count, size_t size) {
    void *p = shape_alloc(count, size);
    if (!p) stop("memory", NULL);
    return p;
}

/* ---- variants ---- */

static surface begin(const shape *s, const char *name) {
    surface f;
    int32_t i;
    f.s = shape_make(s->n, s->n_tri);
    if (!f.s.xyz) stop(name, NULL);
    memcpy(f.s.xyz, s->xyz, 3 * (size_t)s->n * sizeof *s->xyz);
    memcpy(f.s.tri, s->tri, 3 * (size_t)s->n_tri * sizeof *s->tri);
    f.of = (int32_t *)room(s->n, sizeof *f.of);
    for (i = 0; i < s->n; i++) f.of[i] = i;
    snprintf(f.name, sizeof f.name, "%s", name);
    return f;
}

static double size_of(const shape *s, double lo[3], double hi[3]) {
    int32_t i;
    int c;
    for (c = 0; c < 3; c++) lo[c] = hi[c] = s->xyz[c];
    for (i = 0; i < s->n; i++)
        for (c = 0; c < 3; c++) {
            lo[c] = fmin(lo[c], s->xyz[3 * i + c]);
            hi[c] = fmax(hi[c], s->xyz[3 * i + c]);
        }
    return shape_distance(lo, hi);
}

static double mean_edge(const shape *s) {
    double sum = 0;
    int32_t i;
    for (i = 0; i < 3 * s->n_tri; i++)
        sum += shape_distance(s->xyz + 3 * s->tri[i], s->xyz + 3 * s->tri[i % 3 == 2 ? i - 2 : i + 1]);
    return sum / (3 * s->n_tri);
}

/* Every vertex moves along its normal by sigma times a Gaussian number (Box, Muller 1958). */
static surface noisy(const shape *s, double sigma, const char *name) {
    surface f = begin(s, name);
    double *normal = (double *)room(3 * (int64_t)s->n, sizeof *normal), n[3];
    uint64_t seed = 3;
    int32_t i;
    int k, c;
    memset(normal, 0, 3 * (size_t)s->n * sizeof *normal);
    for (i = 0; i < s->n_tri; i++) {
        const int32_t *t = s->tri + 3 * i;
        shape_normal(s->xyz + 3 * t[0], s->xyz + 3 * t[1], s->xyz + 3 * t[2], n);
        for (k = 0; k < 3; k++)
            for (c = 0; c < 3; c++) normal[3 * t[k] + c] += n[c];
    }
    for (i = 0; i < s->n; i++) {
        const double gauss = sqrt(-2 * log(1 - shape_uniform(&seed)))
                           * cos(6.283185307179586 * shape_uniform(&seed));
        const double length = sqrt(shape_dot(normal + 3 * i, normal + 3 * i));
        for (c = 0; c < 3 && length > 0; c++)
            f.s.xyz[3 * i + c] += sigma * gauss * normal[3 * i + c] / length;
    }
    free(normal);
    return f;
}

/* Removes the marked faces, and the vertices left without faces. */
static void take_out(surface *f, const uint8_t *out) {
    int32_t *map = (int32_t *)room(f->s.n, sizeof *map), i, t = 0, n = 0;
    for (i = 0; i < f->s.n; i++) map[i] = -1;
    for (i = 0; i < f->s.n_tri; i++) {
        const int32_t *c = f->s.tri + 3 * i;
        if (out && out[i]) continue;
        map[c[0]] = map[c[1]] = map[c[2]] = 0;
        shape_put_triangle(&f->s, t++, c[0], c[1], c[2]);
    }
    for (i = 0; i < f->s.n; i++) {
        if (map[i] < 0) continue;
        memmove(f->s.xyz + 3 * n, f->s.xyz + 3 * i, 3 * sizeof(double));
        f->of[n] = f->of[i];
        map[i] = n++;
    }
    f->s.n = n;
    f->s.n_tri = t;
    for (i = 0; i < 3 * t; i++) f->s.tri[i] = map[f->s.tri[i]];
    free(map);
}

static void centroid(const shape *s, int32_t face, double p[3]) {
    const int32_t *t = s->tri + 3 * face;
    int c;
    for (c = 0; c < 3; c++) p[c] = (s->xyz[3 * t[0] + c] + s->xyz[3 * t[1] + c] + s->xyz[3 * t[2] + c]) / 3;
}

/* Cuts out balls around random vertices, away from the source, until this part of the faces is gone. */
static surface holes(const shape *s, double part, const char *name) {
    surface f = begin(s, name);
    uint8_t *out = (uint8_t *)room(s->n_tri, 1);
    double lo[3], hi[3], p[3];
    const double radius = 0.02 * size_of(s, lo, hi);
    uint64_t seed = 11;
    int32_t i, gone = 0, tries;
    memset(out, 0, (size_t)s->n_tri);
    for (tries = 0; gone < part * s->n_tri && tries < 10000; tries++) {
        const double *middle = s->xyz + 3 * (int32_t)(shape_uniform(&seed) * s->n);
        if (shape_distance(middle, s->xyz + 3 * source) < 2 * radius) continue;
        for (i = 0; i < s->n_tri; i++) {
            centroid(s, i, p);
            if (out[i] || shape_distance(p, middle) > radius) continue;
            out[i] = 1;
            gone++;
        }
    }
    take_out(&f, out);
    free(out);
    return f;
}

/* Cuts off this first part of the extent along x. */
static surface cut(const shape *s, double part, const char *name) {
    surface f = begin(s, name);
    uint8_t *out = (uint8_t *)room(s->n_tri, 1);
    double lo[3], hi[3], p[3];
    int32_t i;
    size_of(s, lo, hi);
    for (i = 0; i < s->n_tri; i++) {
        centroid(s, i, p);
        out[i] = p[0] < lo[0] + part * (hi[0] - lo[0]);
    }
    take_out(&f, out);
    free(out);
    return f;
}

static int ascending(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* The largest edge length at p: h far from the spots, h/fine in them. */
static double wanted(const double *p, const shape *s, const int32_t *spot, double h, double fine,
                     double reach) {
    double near_by = 1e300;
    int k;
    for (k = 0; k < SPOTS; k++) near_by = fmin(near_by, shape_distance(p, s->xyz + 3 * spot[k]));
    return h * fmin(1, fmax(1 / fine, near_by / reach));
}

/* The new vertex in the middle of the edge ab, or -1. key: the edges that are split, sorted. */
static int32_t middle_of(const int64_t *key, int64_t n_key, int32_t n, int32_t a, int32_t b) {
    const int64_t edge = (int64_t)(a < b ? a : b) * n + (a < b ? b : a);
    const int64_t *found = (const int64_t *)bsearch(&edge, key, (size_t)n_key, sizeof *key, ascending);
    return found ? n + (int32_t)(found - key) : -1;
}

/* Splits a face into one to four by the new vertices m of its edges. Returns the number of faces. */
static int32_t split(shape *out, int32_t t, const int32_t *v, const int32_t *m) {
    const int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
    const int k = count == 1 ? (m[1] >= 0) + 2 * (m[2] >= 0) : count == 2 ? (m[0] < 0) + 2 * (m[1] < 0) : 0;
    const int32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3],
        ca = m[(k + 2) % 3];
    if (count == 0) shape_put_triangle(out, t, a, b, c);
    if (count == 1) { shape_put_triangle(out, t, a, ab, c); shape_put_triangle(out, t + 1, ab, b, c); }
    if (count > 1) { shape_put_triangle(out, t, ab, b, bc);
                     shape_put_triangle(out, t + 1, a, ab, count == 2 ? bc : ca); }
    if (count == 2) shape_put_triangle(out, t + 2, a, bc, c);
    if (count == 3) { shape_put_triangle(out, t + 2, ab, bc, ca); shape_put_triangle(out, t + 3, ca, bc, c); }
    return count + 1;
}

/* Splits all edges that are too long at their midpoints, once. On the animal, midpoints are projected onto
 * its surface. */
static shape refine(const shape *s, const shape *whole, const int32_t *spot, double h, double fine,
                    double reach, int animal) {
    int64_t *key = (int64_t *)room(3 * (int64_t)s->n_tri, sizeof *key), n_key = 0, unique = 0, q;
    shape out;
    int32_t i, m[3], t = 0;
    int k, c;
    for (i = 0; i < 3 * s->n_tri; i++) {
        const int32_t a = s->tri[i], b = s->tri[i % 3 == 2 ? i - 2 : i + 1];
        double p[3];
        for (c = 0; c < 3; c++) p[c] = (s->xyz[3 * a + c] + s->xyz[3 * b + c]) / 2;
        if (shape_distance(s->xyz + 3 * a, s->xyz + 3 * b) > 1.4 * wanted(p, whole, spot, h, fine, reach))
            key[n_key++] = (int64_t)(a < b ? a : b) * s->n + (a < b ? b : a);
    }
    qsort(key, (size_t)n_key, sizeof *key, ascending);
    for (q = 0; q < n_key; q++)
        if (q == 0 || key[q] != key[unique - 1]) key[unique++] = key[q];
    out = shape_make(s->n + unique, s->n_tri + n_key);
    if (!out.xyz) stop("refine", NULL);
    memcpy(out.xyz, s->xyz, 3 * (size_t)s->n * sizeof *s->xyz);
    for (q = 0; q < unique; q++) {
        double *p = out.xyz + 3 * (s->n + q);
        for (c = 0; c < 3; c++)
            p[c] = (s->xyz[3 * (key[q] / s->n) + c] + s->xyz[3 * (key[q] % s->n) + c]) / 2;
        if (animal) shape_animal_project(p, 2);
    }
    for (i = 0; i < s->n_tri; i++) {
        const int32_t *v = s->tri + 3 * i;
        for (k = 0; k < 3; k++) m[k] = middle_of(key, unique, s->n, v[k], v[(k + 1) % 3]);
        t += split(&out, t, v, m);
    }
    free(key);
    return out;
}

/* Refines the coarse surface towards some spots, where edges are shorter by the factor fine. The vertices of
 * coarse come first in the result. */
static surface uneven(const shape *coarse, double fine, int animal, const char *name) {
    surface f = begin(coarse, name);
    const double h = mean_edge(coarse);
    double lo[3], hi[3];
    const double reach = 0.1 * size_of(coarse, lo, hi);
    int32_t spot[SPOTS], i;
    uint64_t seed = 21;
    int k;
    for (k = 0; k < SPOTS; k++) spot[k] = (int32_t)(shape_uniform(&seed) * coarse->n);
    for (k = 0; k < 8; k++) {
        const shape finer = refine(&f.s, coarse, spot, h, fine, reach, animal);
        shape_free(&f.s);
        f.s = finer;
    }
    f.of = (int32_t *)realloc(f.of, (size_t)f.s.n * sizeof *f.of);
    if (!f.of) stop(name, NULL);
    for (i = coarse->n; i < f.s.n; i++) f.of[i] = -1;
    return f;
}

/* ---- heat ---- */

static hd_laplacian *laplacian(const method *m, const shape *s) {
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_error e;
    hd_status status;
    memset(&o, 0, sizeof o);
    o.kind = m->kind;
    o.intrinsic_delaunay = m->delaunay;
    o.tufted = m->tufted;
    o.weight_cut = 1e-4;                /* voronoi-exp: half the non-zeros for a thousandth of change */
    if (m->points && m->tufted) status = hd_laplacian_tufted_points(&lap, s->xyz, s->n, NULL, NULL, &o, &e);
    else if (m->points) status = hd_laplacian_points(&lap, s->xyz, s->n, &o, &e);
    else status = hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, &o, &e);
    if (status < 0) stop(m->name, &e);
    return lap;
}

/* With unit > 0, times and values are scaled as if the surface had this area. 0: no scaling. */
static answer solve(const method *m, const surface *f, double unit) {
    answer a;
    hd_laplacian *lap = laplacian(m, &f->s);
    hd_heat *heat = NULL;
    hd_report report;
    hd_error e;
    const double scale = unit > 0 ? lap->area / unit : 1;
    double t[TIMES];
    int32_t here = 0, i;
    while (here < f->s.n && f->of[here] != source) here++;
    if (here == f->s.n) stop("the source is gone", NULL);
    for (i = 0; i < TIMES; i++) t[i] = scale * times[i];
    a.n = f->s.n;
    a.value = (double *)room(FIELDS * (int64_t)a.n, sizeof *a.value);
    if (hd_heat_create(&heat, lap, NULL, &e) < 0) stop(m->name, &e);
    if (hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, TIMES, t, 1, &here, a.value, 0, &report, NULL) < 0)
        stop(m->name, &report.error);
    if (hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, TIMES, t, 1, &here, a.value + TIMES * (size_t)a.n, 0, &report, NULL) < 0)
        stop(m->name, &report.error);
    for (i = 0; i < TIMES * a.n; i++) a.value[i] *= scale;              /* k_t is 1/area, d_t is 1/length */
    for (; i < FIELDS * a.n; i++) a.value[i] *= sqrt(scale);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return a;
}

/* ---- pictures and meshes ---- */

static void picture(const char *folder, const char *name, int n, const int *which, const answer *a,
                    int field) {
    pic_panel panel[4];
    pic_opts o;
    pic_image image;
    char path[500];
    int k;
    memset(panel, 0, sizeof panel);
    memset(&o, 0, sizeof o);
    for (k = 0; k < n; k++) {
        const int v = which[k];
        panel[k].n = a[v].n;
        /* as points, so that they are seen */
        panel[k].n_tri = v == UNEVEN && n > 2 ? 0 : variant[v].s.n_tri;
        panel[k].xyz = variant[v].s.xyz;
        panel[k].tri = variant[v].s.tri;
        panel[k].field = a[v].value + (size_t)field * (size_t)a[v].n;
        panel[k].caption = variant[v].name;
    }
    o.width = n > 2 ? 920 : 1200;
    o.height = n > 2 ? 236 : 560;
    o.point_radius = 0.3 * mean_edge(&variant[ORIGINAL].s);
    o.columns = n;
    o.view_given = 1;
    o.azimuth = 28;
    o.elevation = 14;
    o.no_legend = n > 2;
    snprintf(path, sizeof path, "%.400s/%s.png", folder, name);
    if (pic_render_grid(&image, panel, n, &o) != PIC_OK ||
        pic_png_write(path, image.rgb, image.width, image.height) != PIC_OK)
        stop(path, NULL);
    pic_image_free(&image);
}

static void mesh(const char *folder, const char *name, const surface *f, const answer *a) {
    static const char *const names[FIELDS] = {"kernel_0", "kernel_1", "kernel_2", "distance_0", "distance_1",
                                              "distance_2"};
    mio_mesh m;
    mio_output o;
    mio_error e;
    char path[500];
    int32_t i;
    memset(&m, 0, sizeof m);
    memset(&o, 0, sizeof o);
    m.n = f->s.n;
    m.xyz = f->s.xyz;
    m.n_faces = f->s.n_tri;
    m.face_idx = f->s.tri;
    m.face_ptr = (int64_t *)room(f->s.n_tri + 1, sizeof *m.face_ptr);
    for (i = 0; i <= f->s.n_tri; i++) m.face_ptr[i] = 3 * (int64_t)i;
    o.rows = o.ld = m.n;
    o.cols = FIELDS;
    o.values = a->value;
    o.names = names;
    snprintf(path, sizeof path, "%.400s/%s.ply", folder, name);
    if (mio_write(path, MIO_PLY, &m, &o, &e) < 0) stop(path, NULL);
    free(m.face_ptr);
}

static void show(const char *folder, const answer *a) {
    static const int pairs[3][2] = {{ORIGINAL, NOISE_3}, {ORIGINAL, HOLES_2}, {ORIGINAL, UNEVEN}},
        all[4] = {ORIGINAL, NOISE_3, HOLES_2, UNEVEN};
    static const char *const names[VARIANTS] = {"original", "", "", "noise", "", "holes", "cut", "uneven"};
    int k;
    for (k = 0; k < 3; k++) picture(folder, names[pairs[k][1]], 2, pairs[k], a, TIMES + MIDDLE);
    picture(folder, "rough", 4, all, a, TIMES + MIDDLE);
    for (k = 0; k < VARIANTS; k++)
        if (names[k][0]) mesh(folder, names[k], variant + k, a + k);
}

/* ---- tables ---- */

/* The change of every field from the original, at common vertices, in percent of the largest value. */
static void print_change(const surface *f, const answer *a, const answer *original) {
    int32_t i, n;
    int q;
    for (q = 0; q < FIELDS; q++) {
        const double *u = a->value + (size_t)q * (size_t)a->n,
            *u0 = original->value + (size_t)q * (size_t)original->n;
        double top = 0, sum = 0, worst = 0;
        for (i = 0; i < original->n; i++) top = fmax(top, fabs(u0[i]));
        for (i = n = 0; i < a->n; i++) {
            const double off = f->of[i] < 0 ? 0 : 100 * fabs(u[i] - u0[f->of[i]]) / top;
            n += f->of[i] >= 0;
            worst = fmax(worst, off);
            sum += off * off;
        }
        printf(" %.1f (%.3g) |", sqrt(sum / n), worst < 99.5 ? floor(10 * worst + 0.5) / 10 : worst);
    }
    printf("\n");
    fflush(stdout);
}

static void table(const method *m, const char *folder) {
    answer a[VARIANTS], scaled;
    hd_laplacian *lap = laplacian(m, &variant[ORIGINAL].s);
    int v;
    printf("\n| %s | k_t, t = %.4g | t = %.4g | t = %.4g | d_t, t = %.4g | t = %.4g | t = %.4g |\n"
           "|---|---|---|---|---|---|---|\n", m->name, times[0], times[1],
           times[2], times[0], times[1], times[2]);
    for (v = 0; v < VARIANTS; v++) {
        a[v] = solve(m, variant + v, 0);
        if (v == ORIGINAL) continue;
        printf("| %s |", variant[v].name);
        print_change(variant + v, a + v, a);
        if (v != NOISE_3) continue;
        scaled = solve(m, variant + v, lap->area);
        printf("| the same, scaled to the original's area |");
        print_change(variant + v, &scaled, a);
        free(scaled.value);
    }
    if (folder) show(folder, a);
    for (v = 0; v < VARIANTS; v++) free(a[v].value);
    hd_laplacian_free(lap);
}

/* The sources most likely to make heat negative: d/dt K_t(i,j) = -L_ij/b_i at t = 0 is smallest there. The
 * rest is random. */
static void suspects(const hd_laplacian *lap, int32_t *vertex) {
    double cold[SOURCES] = {0};
    uint64_t seed = 5;
    int32_t i;
    int64_t p;
    int k;
    for (k = 0; k < SOURCES; k++) vertex[k] = lap->vertex[(int32_t)(shape_uniform(&seed) * lap->n_active)];
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int32_t j = lap->L.col[p];
            const double rate = j == i ? 0 : lap->L.val[p] / lap->mass[i];
            for (k = 0; k < SOURCES / 2 && rate > 0; k++)
                if (vertex[k] == lap->vertex[j] || rate > cold[k]) break;
            if (rate <= 0 || k == SOURCES / 2 || rate <= cold[k]) continue;
            cold[k] = rate;
            vertex[k] = lap->vertex[j];
        }
}

/* How far K_t e_i falls below zero, relative to its largest value, for several sources and times; and the
 * largest bound on the error. */
static void print_lowest(const method *m, const shape *s) {
    static const double in_h2[] = {0.01, 0.1, 1, 10};
    hd_laplacian *lap = laplacian(m, s);
    hd_heat *heat = NULL;
    hd_report report;
    hd_error e;
    double *u = (double *)room(s->n, sizeof *u), low = 0, bound = 0;
    int32_t vertex[SOURCES], i;
    int k, q;
    suspects(lap, vertex);
    if (hd_heat_create(&heat, lap, NULL, &e) < 0) stop(m->name, &e);
    for (q = 0; q < 4; q++)
        for (k = 0; k < SOURCES; k++) {
            double least = 0, top = 0;
            if (hd_heat_column(heat, HD_KERNEL_OPERATOR, in_h2[q] * lap->h * lap->h, vertex[k], u, &report, NULL) < 0)
                stop(m->name, &report.error);
            for (i = 0; i < s->n; i++) {
                least = fmin(least, u[i]);
                top = fmax(top, u[i]);
            }
            low = fmin(low, least / top);
            bound = fmax(bound, report.error_bound);
        }
    printf(" %lld | %.0e (%.0e) |", (long long)lap->mesh.n_negative_weights, low, bound);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(u);
}

static void maximum_principle(void) {
    static const int rows[] = {ORIGINAL, NOISE_3, HOLES_2, UNEVEN, ORIGINAL, HOLES_2};
    const method *const methods[3] = {&PLAIN, &DELAUNAY, &TUFTED};
    int k, m;
    int32_t i;
    printf("\n| least value of K_t e_i, t = 0.01 to 10 h^2 (bound of its error) | voronoi-cot: weights < 0 "
           "| least | Delaunay: weights < 0 | least | tufted: "
           "weights < 0 | least |\n|---|---|---|---|---|---|---|\n");
    for (k = 0; k < 6; k++) {
        surface f = begin(&variant[rows[k]].s, "needles");
        for (i = 0; i < f.s.n && k >= 4; i++) f.s.xyz[3 * i] *= 10;
        printf("| %s%s |", variant[rows[k]].name, k >= 4 ? ", ten times as long" : "");
        for (m = 0; m < 3; m++) print_lowest(methods[m], &f.s);
        printf("\n");
        fflush(stdout);
        shape_free(&f.s);
        free(f.of);
    }
}

/* ---- the surfaces ---- */

static int less(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The vertex area in the coarsest places over that in the finest, without the outermost hundredth of the
 * vertices at either end. */
static double unevenness(const shape *s) {
    hd_laplacian *lap = laplacian(&PLAIN, s);
    const int32_t n = lap->n_active;
    double *area = (double *)room(n, sizeof *area), ratio;
    memcpy(area, lap->mass, (size_t)n * sizeof *area);
    qsort(area, (size_t)n, sizeof *area, less);
    ratio = area[n - 1 - n / 100] / area[n / 100];
    free(area);
    hd_laplacian_free(lap);
    return ratio;
}

static shape load(const char *path) {
    mio_mesh m;
    mio_error e;
    shape s;
    memset(&s, 0, sizeof s);
    if (mio_load(&m, path, NULL, &e) < 0 || mio_triangulate(&m, &s.tri, &s.n_tri, NULL, &e) < 0) {
        fprintf(stderr, "rough_surfaces: %s\n", e.text);
        exit(1);
    }
    s.n = m.n;
    s.xyz = m.xyz;
    m.xyz = NULL;
    mio_free(&m);
    return s;
}

/* The original and its variants, of the animal, or of a mesh from a file. */
static void make_variants(const char *file) {
    shape coarse = file ? load(file) : shape_demo(1500), whole;
    double h, size, lo[3], hi[3];
    int32_t i;
    int k;
    surface used = begin(&coarse, "");
    take_out(&used, NULL);
    shape_free(&coarse);
    coarse = used.s;
    whole = file ? begin(&coarse, "").s : shape_subdivide(&coarse);
    if (!coarse.xyz || !whole.xyz) stop("shape", NULL);
    for (i = 0; !file && i < whole.n; i++) shape_animal_project(whole.xyz + 3 * i, 2);
    /* where x is largest: the middle of the trunk */
    for (i = source = 0; i < coarse.n; i++)
        if (coarse.xyz[3 * i] > coarse.xyz[3 * source]) source = i;
    h = mean_edge(&whole);
    size = size_of(&whole, lo, hi);
    variant[ORIGINAL] = begin(&whole, "original");
    for (k = 0; k < 3; k++) {
        static const double part[] = {0.05, 0.2, 0.5};
        char name[64];
        snprintf(name, sizeof name, "noise of %.2g h (%.2g %% of the size)", part[k],
                 100 * part[k] * h / size);
        variant[NOISE_1 + k] = noisy(&whole, part[k] * h, name);
    }
    variant[HOLES_1] = holes(&whole, 0.05, "5 % cut out in holes");
    variant[HOLES_2] = holes(&whole, 0.15, "15 % cut out in holes");
    variant[CUT] = cut(&whole, 0.25, "an end cut off");
    variant[UNEVEN] = uneven(&coarse, 10, !file, "");
    snprintf(variant[UNEVEN].name, sizeof variant[UNEVEN].name, "areas of vertices 1 : %.0f",
             unevenness(&variant[UNEVEN].s));
    shape_free(&coarse);
    shape_free(&whole);
    free(used.of);
}

int main(int argc, char **argv) {
    const char *folder = argc > 1 && argv[1][0] ? argv[1] : NULL, *file = argc > 2 ? argv[2] : NULL;
    hd_laplacian *lap;
    int k;
    make_variants(file);
    lap = laplacian(&FEM, &variant[ORIGINAL].s);
    for (k = 0; k < TIMES; k++) times[k] = lap->area * 0.002 * pow(10, k);
    printf("%d vertices, area %.4g, h = %.3g. Change of the heat kernel k_t(x, %d) and of the diffusion "
           "distance at t = 0.002, 0.02 and 0.2 of the area,\n"
           "in per cent of the original's largest value: root of the mean square (largest).\n",
               (int)variant[ORIGINAL].s.n, lap->area, lap->h, (int)source);
    hd_laplacian_free(lap);
    table(&FEM, folder);
    table(&PLAIN, NULL);
    table(&DELAUNAY, NULL);
    if (variant[ORIGINAL].s.n <= 20000) {
        table(&POINTS, NULL);
        table(&STARS, NULL);
    }
    maximum_principle();
    for (k = 0; k < VARIANTS; k++) {
        shape_free(&variant[k].s);
        free(variant[k].of);
    }
    return 0;
}
