/* variants.h - a surface with noise, with holes, without an end, unevenly sampled, and its Laplacians; for tools only

   Include heatdiff.h, meshio.h and shapes.h before, and define VARIANTS_PROGRAM as the name that messages begin
   with. What fails ends the program. */

#ifndef VARIANTS_H
#define VARIANTS_H

/* A variant. of[v] is the vertex of the original that vertex v is; -1: none. */
typedef struct surface { shape s; int32_t *of; char name[64]; } surface;

/* A discrete Laplacian; points: the triangles of the surface are not looked at. */
typedef struct method { const char *name; hd_laplacian_kind kind; int points, delaunay, tufted; } method;

static const method FEM = {"fem", HD_LAPLACIAN_FEM, 0, 0, 0},
                    PLAIN = {"voronoi-cot", HD_LAPLACIAN_VORONOI_COT, 0, 0, 0},
                    DELAUNAY = {"voronoi-cot, Delaunay", HD_LAPLACIAN_VORONOI_COT, 0, 1, 0},
                    TUFTED = {"voronoi-cot, tufted", HD_LAPLACIAN_VORONOI_COT, 0, 0, 1},
                    POINTS = {"points, voronoi-exp", HD_LAPLACIAN_VORONOI_EXP, 1, 0, 0},
                    STARS = {"points, tufted", HD_LAPLACIAN_VORONOI_COT, 1, 0, 1};

enum { SPOTS = 8 };                     /* places with fine triangles */

static void stop(const char *what, const hd_error *e) {
    fprintf(stderr, VARIANTS_PROGRAM ": %s: %s\n", what, e ? e->text : "out of memory, or no such folder");
    exit(1);
}

static void *room(int64_t count, size_t size) {
    void *p = shape_alloc(count, size);
    if (!p) stop("memory", NULL);
    return p;
}

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
static surface holes(const shape *s, double part, int32_t source, const char *name) {
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

static shape load(const char *path) {
    mio_mesh m;
    mio_error e;
    shape s;
    memset(&s, 0, sizeof s);
    if (mio_load(&m, path, NULL, &e) < 0 || mio_triangulate(&m, &s.tri, &s.n_tri, NULL, &e) < 0) {
        fprintf(stderr, VARIANTS_PROGRAM ": %s\n", e.text);
        exit(1);
    }
    s.n = m.n;
    s.xyz = m.xyz;
    m.xyz = NULL;
    mio_free(&m);
    return s;
}

static hd_laplacian *laplacian(const method *m, const shape *s, hd_context *ctx) {
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_error e;
    hd_status status;
    memset(&o, 0, sizeof o);
    o.kind = m->kind;
    o.context = ctx;
    o.triangulation = m->delaunay ? HD_TRIANGULATION_DELAUNAY : m->tufted ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
    if (m->kind == HD_LAPLACIAN_VORONOI_EXP) o.weight_cut = 1e-4;    /* half the non-zeros for a thousandth of change */
    if (m->points) status = hd_laplacian_create(&lap, MESH_POINTS(s->xyz, s->n), &o, &e);
    else status = hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e);
    if (status < 0) stop(m->name, &e);
    return lap;
}

#endif
