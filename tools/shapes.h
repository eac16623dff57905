/* shapes.h - surfaces made in memory, for the demo and the tests; only the C library, all functions static

       shape s = shape_demo(0);
       if (!s.xyz) return out_of_memory();
       ... s.n, s.xyz, s.n_tri, s.tri ...
       shape_free(&s);

   Closed shapes are manifold, in one piece (but shape_disjoint) and oriented outwards. Everything is deterministic. When
   memory is short or an argument makes no sense, the shape comes back empty: n = 0, xyz = NULL.

   Contents: [1] memory and chance  [2] simple shapes  [3] the demo's animal as an implicit function  [4] its surface by
             marching tetrahedra  [5] remeshing  [6] the demo  [7] shapes of polygons */

#ifndef SHAPES_H
#define SHAPES_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_args.h"

typedef struct shape {
    int32_t n;
    double *xyz;        /* [3n] */
    int32_t n_tri;
    int32_t *tri;       /* [3n_tri], 0-based */
} shape;

/* ==== [1] memory and chance ==== */

static void shape_free(shape *s)
{
    free(s->xyz);
    free(s->tri);
    memset(s, 0, sizeof *s);
}

static void *shape_alloc(int64_t count, size_t size)
{
    if (count < 0 || (uint64_t)count > SIZE_MAX / 2 / size) return NULL;
    return malloc(count > 0 ? (size_t)count * size : 1);
}

static shape shape_make(int64_t n, int64_t n_tri)
{
    shape s;
    memset(&s, 0, sizeof s);
    if (n < 0 || n_tri < 0 || n > INT32_MAX / 4 || n_tri > INT32_MAX / 4) return s;
    s.xyz = (double *)shape_alloc(n, 3 * sizeof(double));
    s.tri = (int32_t *)shape_alloc(n_tri, 3 * sizeof(int32_t));
    if (!s.xyz || !s.tri) { shape_free(&s); return s; }
    s.n = (int32_t)n;
    s.n_tri = (int32_t)n_tri;
    return s;
}

static void shape_put_vertex(shape *s, int32_t i, double x, double y, double z)
{
    double *p = s->xyz + 3 * (size_t)i;
    p[0] = x; p[1] = y; p[2] = z;
}

static void shape_put_triangle(shape *s, int32_t t, int32_t a, int32_t b, int32_t c)
{
    int32_t *p = s->tri + 3 * (size_t)t;
    p[0] = a; p[1] = b; p[2] = c;
}

/* The next of a sequence of random 64-bit numbers (splitmix64, Sebastiano Vigna); state: any seed. */
static uint64_t shape_random(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [0,1), and in [-1,1). */
static double shape_uniform(uint64_t *state) { return (double)(shape_random(state) >> 11) * (1.0 / 9007199254740992.0); }
static double shape_signed(uint64_t *state) { return 2 * shape_uniform(state) - 1; }

static double shape_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static double shape_distance(const double *a, const double *b)
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(shape_dot(d, d));
}

/* Cross product of the edges ab and ac: the normal, twice the area long. */
static void shape_normal(const double *a, const double *b, const double *c, double n[3])
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
}

/* ==== [2] simple shapes ==== */

/* Splits every triangle in four at its edges' middles. A closed or open manifold mesh of n vertices; new vertices come after
 * the old ones. Middles are found again through a hash table of edges. */
static shape shape_subdivide(const shape *s)
{
    const int64_t slots = (int64_t)s->n_tri * 4 + 8;        /* at most 3 n_tri edges: always room */
    int64_t *key = (int64_t *)shape_alloc(slots, sizeof *key), k;
    int32_t *mid = (int32_t *)shape_alloc(slots, sizeof *mid), n = s->n, t;
    shape r = shape_make((int64_t)s->n + 3 * (int64_t)s->n_tri, 4 * (int64_t)s->n_tri);
    if (!key || !mid || !r.xyz) { free(key); free(mid); shape_free(&r); return r; }
    memcpy(r.xyz, s->xyz, (size_t)s->n * 3 * sizeof(double));
    for (k = 0; k < slots; k++) key[k] = -1;
    for (t = 0; t < s->n_tri; t++) {
        const int32_t *v = s->tri + 3 * (size_t)t;
        int32_t m[3];
        int e, c;
        for (e = 0; e < 3; e++) {
            const int64_t a = v[e] < v[(e + 1) % 3] ? v[e] : v[(e + 1) % 3], b = v[e] + (int64_t)v[(e + 1) % 3] - a;
            const int64_t want = a * INT32_MAX + b;
            for (k = (int64_t)((uint64_t)want * 0x9e3779b97f4a7c15u % (uint64_t)slots); key[k] >= 0 && key[k] != want; )
                k = k + 1 < slots ? k + 1 : 0;
            if (key[k] < 0) {
                key[k] = want;
                mid[k] = n++;
                for (c = 0; c < 3; c++) r.xyz[3 * (size_t)mid[k] + (size_t)c] = (s->xyz[3 * a + c] + s->xyz[3 * b + c]) / 2;
            }
            m[e] = mid[k];
        }
        shape_put_triangle(&r, 4 * t, v[0], m[0], m[2]);
        shape_put_triangle(&r, 4 * t + 1, m[0], v[1], m[1]);
        shape_put_triangle(&r, 4 * t + 2, m[2], m[1], v[2]);
        shape_put_triangle(&r, 4 * t + 3, m[0], m[1], m[2]);
    }
    r.n = n;
    free(key);
    free(mid);
    return r;
}

/* Unit sphere: the icosahedron, subdivided `levels` times (10 4^levels + 2 vertices), levels 0..10. */
static shape shape_icosphere(int levels)
{
    static const int8_t corner[12][3] = {{-1, 2, 0}, {1, 2, 0}, {-1, -2, 0}, {1, -2, 0}, {0, -1, 2}, {0, 1, 2},
                                         {0, -1, -2}, {0, 1, -2}, {2, 0, -1}, {2, 0, 1}, {-2, 0, -1}, {-2, 0, 1}};
    static const int8_t face[20][3] = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                       {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8},
                                       {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
    const double golden = 1.6180339887498949;       /* a 2 in the table stands for it */
    shape s = shape_make(levels >= 0 && levels <= 10 ? 12 : -1, 20), finer;
    int32_t i;
    int c, level;
    for (i = 0; i < s.n; i++) for (c = 0; c < 3; c++)
        s.xyz[3 * i + c] = abs(corner[i][c]) == 2 ? golden * corner[i][c] / 2 : corner[i][c];
    for (i = 0; i < s.n_tri; i++) shape_put_triangle(&s, i, face[i][0], face[i][1], face[i][2]);
    for (level = 0; s.xyz && level <= levels; level++) {
        for (i = 0; i < s.n; i++) {
            double *p = s.xyz + 3 * (size_t)i, len = sqrt(shape_dot(p, p));
            for (c = 0; c < 3; c++) p[c] /= len;
        }
        if (level == levels) break;
        finer = shape_subdivide(&s);
        shape_free(&s);
        s = finer;
    }
    return s;
}

/* Wraps a grid of nu x nv vertices into triangles, oriented (u, v) -> outwards where du x dv points inwards; closing it in
 * u always and in v if asked. */
static void shape_wrap(shape *s, int32_t nu, int32_t nv, int close_v)
{
    int32_t i, j, t = 0;
    for (i = 0; i < nu; i++) for (j = 0; j < (close_v ? nv : nv - 1); j++) {
        const int32_t i1 = (i + 1) % nu, j1 = (j + 1) % nv;
        const int32_t a = i * nv + j, b = i1 * nv + j, c = i1 * nv + j1, d = i * nv + j1;
        shape_put_triangle(s, t++, a, d, c);
        shape_put_triangle(s, t++, a, c, b);
    }
}

/* Torus around the y axis: nu vertices round it, nv round the tube; R from the axis to the tube's middle, r the tube's. */
static shape shape_torus(int32_t nu, int32_t nv, double R, double r)
{
    const double turn = 6.283185307179586;
    const int ok = nu >= 3 && nv >= 3 && R > 0 && r > 0 && r < R;
    shape s = shape_make(ok ? (int64_t)nu * nv : -1, ok ? 2 * (int64_t)nu * nv : 0);
    int32_t i, j;
    if (!s.xyz) return s;
    for (i = 0; i < nu; i++) for (j = 0; j < nv; j++) {
        const double u = turn * i / nu, v = turn * j / nv, q = R + r * cos(v);
        shape_put_vertex(&s, i * nv + j, q * cos(u), r * sin(v), q * sin(u));
    }
    shape_wrap(&s, nu, nv, 1);
    return s;
}

/* Side of a cylinder around the y axis, open at both ends: nu vertices round it, nv rows, y in [-height/2, height/2]. */
static shape shape_cylinder(int32_t nu, int32_t nv, double radius, double height)
{
    const double turn = 6.283185307179586;
    const int ok = nu >= 3 && nv >= 2 && radius > 0 && height > 0;
    shape s = shape_make(ok ? (int64_t)nu * nv : -1, ok ? 2 * (int64_t)nu * (nv - 1) : 0);
    int32_t i, j;
    if (!s.xyz) return s;
    for (i = 0; i < nu; i++) for (j = 0; j < nv; j++) {
        const double u = turn * i / nu;
        shape_put_vertex(&s, i * nv + j, radius * cos(u), height * ((double)j / (nv - 1) - 0.5), radius * sin(u));
    }
    shape_wrap(&s, nu, nv, 0);
    return s;
}

/* Planar rectangle with a border: nx x ny vertices, width 1 along x, square cells; normals along +z. Inner vertices are moved
 * by up to jitter (0..0.45) of a cell, and with jitter the diagonals run either way. */
static shape shape_grid(int32_t nx, int32_t ny, double jitter)
{
    const int ok = nx >= 2 && ny >= 2 && jitter >= 0 && jitter <= 0.45;
    shape s = shape_make(ok ? (int64_t)nx * ny : -1, ok ? 2 * (int64_t)(nx - 1) * (ny - 1) : 0);
    uint64_t seed = 7;
    const double cell = nx > 1 ? 1.0 / (nx - 1) : 1;
    int32_t i, j, t = 0;
    if (!s.xyz) return s;
    for (j = 0; j < ny; j++) for (i = 0; i < nx; i++) {
        const double inner = i > 0 && j > 0 && i < nx - 1 && j < ny - 1 ? jitter : 0;
        const double dx = inner * shape_signed(&seed), dy = inner * shape_signed(&seed);
        shape_put_vertex(&s, j * nx + i, (i + dx) * cell, (j + dy) * cell, 0);
    }
    for (j = 0; j + 1 < ny; j++) for (i = 0; i + 1 < nx; i++) {
        const int32_t a = j * nx + i, b = a + 1, c = b + nx, d = a + nx;
        const int other = jitter > 0 && (shape_random(&seed) & 1u);
        shape_put_triangle(&s, t++, a, b, other ? d : c);
        shape_put_triangle(&s, t++, other ? b : a, c, d);
    }
    return s;
}

/* An irregular, bumpy ball of about unit radius: an icosphere whose vertices are shaken and moved in and out by waves and
 * some noise. levels 0..10; the same seed gives the same ball. */
static shape shape_bumpy(int levels, uint64_t seed)
{
    shape s = shape_icosphere(levels);
    const double h = 1.1 / pow(2, levels);      /* edges of an icosphere are about so long */
    double wave[8][4];
    int32_t i;
    int k, c;
    for (k = 0; k < 8; k++) {
        for (c = 0; c < 3; c++) wave[k][c] = 5 * shape_signed(&seed);
        wave[k][3] = 6.283185307179586 * shape_uniform(&seed);
    }
    for (i = 0; i < s.n; i++) {
        double *p = s.xyz + 3 * (size_t)i, len, r = 1;
        for (c = 0; c < 3; c++) p[c] += 0.22 * h * shape_signed(&seed);
        for (k = 0; k < 8; k++) r += 0.045 * sin(shape_dot(wave[k], p) + wave[k][3]);
        r += 0.03 * h * shape_signed(&seed);
        len = sqrt(shape_dot(p, p));
        for (c = 0; c < 3; c++) p[c] *= r / len;
    }
    return s;
}

/* Both shapes in one, b moved by offset; first a's vertices and triangles, then b's. */
static shape shape_disjoint(const shape *a, const shape *b, const double offset[3])
{
    shape s = shape_make((int64_t)a->n + b->n, (int64_t)a->n_tri + b->n_tri);
    int32_t i;
    int c;
    if (!s.xyz) return s;
    memcpy(s.xyz, a->xyz, (size_t)a->n * 3 * sizeof(double));
    memcpy(s.tri, a->tri, (size_t)a->n_tri * 3 * sizeof(int32_t));
    for (i = 0; i < b->n; i++) for (c = 0; c < 3; c++)
        s.xyz[3 * ((size_t)a->n + (size_t)i) + (size_t)c] = b->xyz[3 * (size_t)i + (size_t)c] + offset[c];
    for (i = 0; i < b->n_tri; i++) for (c = 0; c < 3; c++)
        s.tri[3 * ((size_t)a->n_tri + (size_t)i) + (size_t)c] = b->tri[3 * (size_t)i + (size_t)c] + a->n;
    return s;
}

/* ---- points on surfaces, without triangles ---- */

/* One random point of a surface, spread evenly. */
typedef void (*shape_sampler)(uint64_t *seed, double p[3]);

/* Unit sphere, area 4 pi (Archimedes: height and longitude are uniform). */
static void shape_on_sphere(uint64_t *seed, double p[3])
{
    const double z = shape_signed(seed), a = 6.283185307179586 * shape_uniform(seed), r = sqrt(1 - z * z);
    p[0] = r * cos(a); p[1] = r * sin(a); p[2] = z;
}

/* Torus around the z axis with radii 2 and 1, area 8 pi^2: the outside is met more often. */
static void shape_on_torus(uint64_t *seed, double p[3])
{
    const double a = 6.283185307179586 * shape_uniform(seed);
    double b, q;
    do {
        b = 6.283185307179586 * shape_uniform(seed);
        q = 2 + cos(b);
    } while (3 * shape_uniform(seed) > q);
    p[0] = q * cos(a); p[1] = q * sin(a); p[2] = sin(b);
}

/* Unit square in the plane z = 0, a surface with a border. */
static void shape_on_square(uint64_t *seed, double p[3])
{
    p[0] = shape_uniform(seed); p[1] = shape_uniform(seed); p[2] = 0;
}

static size_t shape_dart_slot(const int64_t c[3], size_t slots)
{
    return (size_t)(((uint64_t)c[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)c[1] * 0xbf58476d1ce4e5b9u ^ (uint64_t)c[2] * 0x94d049bb133111ebu) % slots);
}

/* Is no point of s within r of p? Points lie in a hash table of cells of size r: head of the chain, next in the chain. */
static int shape_dart_free(const shape *s, const double p[3], double r, const int32_t *head, const int32_t *next, size_t slots)
{
    int64_t c[3];
    int k, q;
    for (k = 0; k < 27; k++) {
        int32_t i;
        for (q = 0; q < 3; q++) c[q] = (int64_t)floor(p[q] / r) + (q == 0 ? k % 3 : q == 1 ? k / 3 % 3 : k / 9) - 1;
        for (i = head[shape_dart_slot(c, slots)]; i >= 0; i = next[i])
            if (shape_distance(s->xyz + 3 * (size_t)i, p) < r) return 0;
    }
    return 1;
}

/* n points of a surface of this area; n_tri = 0. blue = 0: independent of each other. blue = 1: blue noise, none closer to another than 0.75 of
 * the typical distance sqrt(area / n) (dart throwing, Cook 1986; a surface is full at 0.84). */
static shape shape_points(int32_t n, shape_sampler sampler, double area, int blue, uint64_t seed)
{
    shape s = shape_make(n, 0);
    const size_t slots = 2 * (size_t)(n > 0 ? n : 0) + 1;
    const double r = 0.75 * sqrt(area / (n > 0 ? n : 1));
    int32_t *head = (int32_t *)shape_alloc((int64_t)slots, sizeof *head), *next = (int32_t *)shape_alloc(n, sizeof *next), i;
    size_t k;
    if (!s.xyz || !head || !next) shape_free(&s);
    for (k = 0; k < slots && s.xyz; k++) head[k] = -1;
    for (i = 0; i < s.n; i++) {
        double *p = s.xyz + 3 * (size_t)i;
        int64_t c[3];
        do sampler(&seed, p);
        while (blue && !shape_dart_free(&s, p, r, head, next, slots));
        if (!blue) continue;
        for (k = 0; k < 3; k++) c[k] = (int64_t)floor(p[k] / r);
        k = shape_dart_slot(c, slots);
        next[i] = head[k];
        head[k] = i;
    }
    free(head);
    free(next);
    return s;
}

/* ==== [3] the demo's animal ==== */
/* A small elephant that walks: cones with round ends and two flat ears, melted together. The trunk is curled back to the
 * forehead and the tail to the back, so that the surface has two handles (genus 2). It looks along +x, up is +y. */

typedef struct shape_limb { double a[3], b[3], ra, rb; } shape_limb;            /* cone with round ends */
typedef struct shape_loop { double centre[3], radius, from, to, ra, rb; } shape_loop;   /* arc in an x-y plane, radians */
typedef struct shape_ear { double centre[3], axis[3][3], radius[3]; } shape_ear;        /* ellipsoid */

enum { SHAPE_LIMBS = 14, SHAPE_LOOPS = 2, SHAPE_EARS = 2, SHAPE_PARTS = SHAPE_LIMBS + SHAPE_LOOPS + SHAPE_EARS };

static const shape_limb shape_limbs[SHAPE_LIMBS] = {
    {{-0.48, 0.16, 0.00}, {0.34, 0.17, 0.00}, 0.49, 0.46},          /* body */
    {{0.36, 0.30, 0.00}, {0.86, 0.52, 0.02}, 0.36, 0.29},           /* neck */
    {{0.92, 0.56, 0.02}, {1.06, 0.44, 0.03}, 0.320, 0.24},          /* head */
    {{0.40, 0.00, 0.25}, {0.58, -0.46, 0.29}, 0.22, 0.165},         /* legs: front left, stepping */
    {{0.58, -0.46, 0.29}, {0.66, -0.88, 0.29}, 0.165, 0.165},
    {{0.38, 0.00, -0.25}, {0.34, -0.46, -0.29}, 0.22, 0.165},       /* front right */
    {{0.34, -0.46, -0.29}, {0.30, -0.88, -0.29}, 0.165, 0.165},
    {{-0.56, 0.00, 0.25}, {-0.62, -0.45, 0.29}, 0.26, 0.170},       /* hind left */
    {{-0.62, -0.45, 0.29}, {-0.74, -0.88, 0.29}, 0.170, 0.165},
    {{-0.54, 0.00, -0.25}, {-0.44, -0.46, -0.29}, 0.26, 0.170},     /* hind right, stepping */
    {{-0.44, -0.46, -0.29}, {-0.40, -0.88, -0.29}, 0.170, 0.165},
    {{1.06, 0.34, 0.20}, {1.40, 0.06, 0.30}, 0.085, 0.055},         /* tusks */
    {{1.06, 0.34, -0.14}, {1.40, 0.06, -0.24}, 0.085, 0.055},
    {{0.86, 0.74, 0.02}, {0.96, 0.76, 0.02}, 0.16, 0.13}};          /* forehead */

static const shape_loop shape_loops[SHAPE_LOOPS] = {
    {{1.42, 0.76, 0.03}, 0.400, -2.45, 3.05, 0.165, 0.085},         /* trunk, up and back to the forehead */
    {{-1.08, 0.18, 0.01}, 0.275, 0.85, 5.45, 0.085, 0.070}};        /* tail, back to the hip */

static const shape_ear shape_ears[SHAPE_EARS] = {
    {{0.66, 0.55, 0.50}, {{0.80, 0.0, 0.60}, {0.0, 1.0, 0.0}, {-0.60, 0.0, 0.80}}, {0.085, 0.35, 0.33}},
    {{0.66, 0.55, -0.46}, {{0.80, 0.0, -0.60}, {0.0, 1.0, 0.0}, {0.60, 0.0, 0.80}}, {0.085, 0.35, 0.33}}};

/* Signed distance (about) to one part, its gradient, and the part's thickness. */
static double shape_limb_at(const shape_limb *l, const double p[3], double g[3], double *thick)
{
    double u[3], v[3], uu, t, len, c_t = 0;
    int c;
    for (c = 0; c < 3; c++) { u[c] = l->b[c] - l->a[c]; v[c] = p[c] - l->a[c]; }
    uu = shape_dot(u, u);
    t = shape_dot(u, v) / uu;
    if (t < 0) t = 0; else if (t > 1) t = 1; else c_t = 1;
    for (c = 0; c < 3; c++) v[c] -= t * u[c];
    len = sqrt(shape_dot(v, v)) + 1e-12;
    for (c = 0; c < 3; c++) g[c] = v[c] / len - c_t * (l->rb - l->ra) * u[c] / uu;
    *thick = l->ra + t * (l->rb - l->ra);
    return len - *thick;
}

/* The nearest place of an arc has the same angle around its centre, or is one of the ends. */
static double shape_loop_at(const shape_loop *l, const double p[3], double g[3], double *thick)
{
    const double turn = 6.283185307179586, middle = 0.5 * (l->from + l->to), half = 0.5 * (l->to - l->from);
    double at = atan2(p[1] - l->centre[1], p[0] - l->centre[0]) - middle, len;
    int c;
    at -= turn * floor(at / turn + 0.5);
    if (at > half) at = half;
    if (at < -half) at = -half;
    g[0] = p[0] - l->centre[0] - l->radius * cos(middle + at);
    g[1] = p[1] - l->centre[1] - l->radius * sin(middle + at);
    g[2] = p[2] - l->centre[2];
    len = sqrt(shape_dot(g, g)) + 1e-12;
    for (c = 0; c < 3; c++) g[c] /= len;
    *thick = l->ra + (l->rb - l->ra) * 0.5 * (1 + at / half);
    return len - *thick;
}

static double shape_ear_at(const shape_ear *e, const double p[3], double g[3], double *thick)
{
    const double v[3] = {p[0] - e->centre[0], p[1] - e->centre[1], p[2] - e->centre[2]};
    double q[3], len;
    int k, c;
    for (k = 0; k < 3; k++) q[k] = shape_dot(e->axis[k], v) / e->radius[k];
    len = sqrt(shape_dot(q, q)) + 1e-12;
    for (c = 0; c < 3; c++) {
        g[c] = 0;
        for (k = 0; k < 3; k++) g[c] += e->radius[0] * q[k] / (len * e->radius[k]) * e->axis[k][c];
    }
    *thick = 0;     /* rims want short edges */
    return e->radius[0] * (len - 1);
}

/* The animal: negative inside. Parts melt by f = -log(sum exp(-k d_i)) / k; the feet are cut flat, with a soft rim, by the
 * ground in the same way. g: gradient. thick: thickness hereabouts. */
static double shape_animal(const double p[3], double g[3], double *thick)
{
    const double k = 22, kg = 34, ground = -0.96;
    double d[SHAPE_PARTS], gi[SHAPE_PARTS][3], ti[SHAPE_PARTS], least = HUGE_VAL, sum = 0, f, cut, w;
    int i, c;
    for (i = 0; i < SHAPE_LIMBS; i++) d[i] = shape_limb_at(shape_limbs + i, p, gi[i], ti + i);
    for (c = 0; c < SHAPE_LOOPS; c++, i++) d[i] = shape_loop_at(shape_loops + c, p, gi[i], ti + i);
    for (c = 0; c < SHAPE_EARS; c++, i++) d[i] = shape_ear_at(shape_ears + c, p, gi[i], ti + i);
    for (i = 0; i < SHAPE_PARTS; i++) if (d[i] < least) least = d[i];
    g[0] = g[1] = g[2] = *thick = 0;
    for (i = 0; i < SHAPE_PARTS; i++) {
        if (k * (d[i] - least) > 30) continue;
        w = exp(-k * (d[i] - least));
        sum += w;
        *thick += w * ti[i];
        for (c = 0; c < 3; c++) g[c] += w * gi[i][c];
    }
    f = least - log(sum) / k;
    *thick /= sum;
    cut = kg * (f - (ground - p[1]));                   /* how much nearer the ground is than the body */
    if (cut > 30) w = 0; else if (cut < -30) w = 1; else w = 1 / (1 + exp(cut));
    for (c = 0; c < 3; c++) g[c] *= (1 - w) / sum;
    g[1] -= w;
    if (cut > 30) return f;
    return cut < -30 ? ground - p[1] : f + log(1 + exp(-cut)) / kg;
}

/* Moves p onto the animal's surface by a few Newton steps along the gradient. */
static void shape_animal_project(double p[3], int steps)
{
    double g[3], thick;
    int i, c;
    for (i = 0; i < steps; i++) {
        const double f = shape_animal(p, g, &thick), gg = shape_dot(g, g);
        for (c = 0; gg > 1e-6 && c < 3; c++) p[c] -= f * g[c] / gg;
    }
}

/* ==== [4] its surface ==== */
/* Marching tetrahedra: each cell of a grid whose nodes are shaken a little is cut into six tetrahedra around a diagonal. All
 * edges run from a node to one whose offsets are 0 or 1, so node * 8 + offset bits names an edge, and with it a vertex. */

typedef struct shape_march {
    int32_t n[3];               /* nodes per direction */
    double low[3], cell;
    double *node;               /* [4 * nodes]: x, y, z, f */
    int32_t *vertex;            /* [8 * nodes]: the edges' vertices, -1 without one */
    shape out;
    int32_t room, room_tri;
    int failed;
} shape_march;

static int32_t shape_march_vertex(shape_march *m, int32_t a, int32_t b, int bits)
{
    int32_t *v = m->vertex + 8 * (size_t)a + bits;
    const double *p = m->node + 4 * (size_t)a, *q = m->node + 4 * (size_t)b, t = p[3] / (p[3] - q[3]);
    if (*v >= 0) return *v;
    if (m->out.n == m->room) {
        double *xyz = (double *)realloc(m->out.xyz, (size_t)m->room * 2 * 3 * sizeof(double));
        if (!xyz) { m->failed = 1; return 0; }
        m->out.xyz = xyz;
        m->room *= 2;
    }
    *v = m->out.n++;
    shape_put_vertex(&m->out, *v, p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]), p[2] + t * (q[2] - p[2]));
    return *v;
}

static void shape_march_triangle(shape_march *m, int32_t a, int32_t b, int32_t c, int turn)
{
    if (m->out.n_tri == m->room_tri) {
        int32_t *tri = (int32_t *)realloc(m->out.tri, (size_t)m->room_tri * 2 * 3 * sizeof(int32_t));
        if (!tri) { m->failed = 1; return; }
        m->out.tri = tri;
        m->room_tri *= 2;
    }
    shape_put_triangle(&m->out, m->out.n_tri++, a, turn ? c : b, turn ? b : c);
}

/* The surface in one tetrahedron. corner: offset bits of its nodes, in increasing order; odd: it is left-handed. */
static void shape_march_tetrahedron(shape_march *m, int32_t base, const int corner[4], int odd)
{
    const int32_t step[3] = {1, m->n[0], m->n[0] * m->n[1]};
    int32_t id[4], v[4];
    int order[4], n_in = 0, n = 0, i, j, turn = odd;
    for (i = 0; i < 4; i++)
        id[i] = base + (corner[i] & 1) * step[0] + (corner[i] >> 1 & 1) * step[1] + (corner[i] >> 2 & 1) * step[2];
    for (i = 0; i < 4; i++) if (m->node[4 * (size_t)id[i] + 3] < 0) order[n++] = i;
    n_in = n;
    for (i = 0; i < 4; i++) if (!(m->node[4 * (size_t)id[i] + 3] < 0)) order[n++] = i;
    if (n_in == 0 || n_in == 4) return;
    for (i = 0; i < 4; i++) for (j = i + 1; j < 4; j++) turn ^= order[i] > order[j];    /* parity of the reordering */
    for (n = 0, i = 0; i < n_in; i++) for (j = n_in; j < 4; j++) {
        const int a = order[i] < order[j] ? order[i] : order[j], b = order[i] + order[j] - a;
        v[n++] = shape_march_vertex(m, id[a], id[b], corner[b] ^ corner[a]);
    }
    /* With nodes (a,b,c,d) right-handed, the cut around a alone inside is (ab, ac, ad), seen from outside; around d alone
     * outside it is (ad, bd, cd); with a and b inside it is the quadrangle (ac, ad, bd, bc). */
    if (n == 3) shape_march_triangle(m, v[0], v[1], v[2], turn);
    else {
        shape_march_triangle(m, v[0], v[1], v[3], turn);
        shape_march_triangle(m, v[0], v[3], v[2], turn);
    }
}

static void shape_march_cells(shape_march *m)
{
    static const int path[6][4] = {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 4, 6, 7}};
    int32_t i, j, k;
    int c, inside;
    for (k = 0; k + 1 < m->n[2]; k++) for (j = 0; j + 1 < m->n[1]; j++) for (i = 0; i + 1 < m->n[0]; i++) {
        const int32_t base = i + m->n[0] * (j + m->n[1] * k);
        for (inside = 0, c = 0; c < 8; c++) {
            const int32_t id = base + (c & 1) + m->n[0] * ((c >> 1 & 1) + m->n[1] * (c >> 2 & 1));
            inside += m->node[4 * (size_t)id + 3] < 0;
        }
        if (inside == 0 || inside == 8) continue;
        for (c = 0; c < 6; c++) shape_march_tetrahedron(m, base, path[c], c >= 3);
    }
}

/* Node positions and values. Far from the surface, told from one node in four in each direction, values are only signs. */
static void shape_march_nodes(shape_march *m)
{
    const double remote = 4 * m->cell * 2.2;
    uint64_t seed = 20130;
    double g[3], thick, coarse = 0;
    int32_t i, j, k;
    for (k = 0; k < m->n[2]; k++) for (j = 0; j < m->n[1]; j++) for (i = 0; i < m->n[0]; i++) {
        double *p = m->node + 4 * (size_t)(i + m->n[0] * (j + m->n[1] * k));
        const double middle[3] = {m->low[0] + (i + 1.5) * m->cell, m->low[1] + j * m->cell, m->low[2] + k * m->cell};
        p[0] = m->low[0] + (i + 0.18 * shape_signed(&seed)) * m->cell;
        p[1] = m->low[1] + (j + 0.18 * shape_signed(&seed)) * m->cell;
        p[2] = m->low[2] + (k + 0.18 * shape_signed(&seed)) * m->cell;
        if (i % 4 == 0) coarse = shape_animal(middle, g, &thick);
        p[3] = fabs(coarse) > remote ? coarse : shape_animal(p, g, &thick);
        if (fabs(p[3]) < 1e-9) p[3] = 1e-9;
    }
}

static shape shape_march_run(double cell)
{
    static const double low[3] = {-1.58, -1.12, -0.92}, high[3] = {2.08, 1.42, 0.96};
    shape_march m;
    int64_t nodes = 1, i;
    int c;
    memset(&m, 0, sizeof m);
    for (c = 0; c < 3; c++) {
        m.low[c] = low[c];
        m.n[c] = (int32_t)ceil((high[c] - low[c]) / cell) + 1;
        nodes *= m.n[c];
    }
    m.cell = cell;
    m.room = m.room_tri = 1 << 14;
    m.out = shape_make(m.room, m.room_tri);
    m.node = (double *)shape_alloc(nodes, 4 * sizeof(double));
    m.vertex = (int32_t *)shape_alloc(nodes, 8 * sizeof(int32_t));
    m.failed = !m.out.xyz || !m.node || !m.vertex;
    m.out.n = m.out.n_tri = 0;
    for (i = 0; !m.failed && i < 8 * nodes; i++) m.vertex[i] = -1;
    if (!m.failed) { shape_march_nodes(&m); shape_march_cells(&m); }
    free(m.node);
    free(m.vertex);
    if (m.failed) shape_free(&m.out);
    return m.out;
}

/* ==== [5] remeshing ==== */
/* Short edges are collapsed, edges flipped where that makes the two triangles fatter, vertices moved along the surface to
 * the middle of their surroundings. Within a pass the lists of faces are not made anew: a vertex whose list is no longer
 * complete is locked, and left alone until the next pass. */

typedef struct shape_mesh {
    shape s;
    int32_t *start, *face;      /* [n+1], [3 n_tri]: faces around each vertex */
    double *size;               /* [n] wanted length of edges */
    uint8_t *locked;            /* [n] */
    double *moved;              /* [3n] */
} shape_mesh;

static void shape_mesh_free(shape_mesh *m)
{
    free(m->start); free(m->face); free(m->size); free(m->locked); free(m->moved);
    m->start = m->face = NULL;
    m->size = m->moved = NULL;
    m->locked = NULL;
}

static int shape_mesh_make(shape_mesh *m, const shape *s)
{
    m->s = *s;
    m->start = (int32_t *)shape_alloc((int64_t)s->n + 2, sizeof(int32_t));
    m->face = (int32_t *)shape_alloc(3 * (int64_t)s->n_tri, sizeof(int32_t));
    m->size = (double *)shape_alloc(s->n, sizeof(double));
    m->locked = (uint8_t *)shape_alloc(s->n, 1);
    m->moved = (double *)shape_alloc(s->n, 3 * sizeof(double));
    if (m->start && m->face && m->size && m->locked && m->moved) return 1;
    shape_mesh_free(m);
    return 0;
}

/* Lists the faces around each vertex anew and unlocks everything. */
static void shape_mesh_lists(shape_mesh *m)
{
    const int32_t n = m->s.n, corners = 3 * m->s.n_tri;
    int32_t i;
    memset(m->start, 0, ((size_t)n + 2) * sizeof(int32_t));
    memset(m->locked, 0, (size_t)n);
    for (i = 0; i < corners; i++) m->start[m->s.tri[i] + 2]++;
    for (i = 2; i < n + 2; i++) m->start[i] += m->start[i - 1];
    for (i = 0; i < corners; i++) m->face[m->start[m->s.tri[i] + 1]++] = i / 3;
}

/* Wanted length of edges: finer where the animal is thin. */
static void shape_mesh_sizes(shape_mesh *m, double length)
{
    double g[3], thick;
    int32_t i;
    for (i = 0; i < m->s.n; i++) {
        shape_animal(m->s.xyz + 3 * (size_t)i, g, &thick);
        m->size[i] = length * (0.62 + (thick < 0.5 ? thick : 0.5));
    }
}

/* Faces around v; those that have vanished (corners -1) stay listed but do not count. */
static int32_t shape_valence(const shape_mesh *m, int32_t v)
{
    int32_t i, n = 0;
    for (i = m->start[v]; i < m->start[v + 1]; i++) n += m->s.tri[3 * (size_t)m->face[i]] >= 0;
    return n;
}

/* Where in face f vertex v stands: 0..2, or -1. */
static int shape_corner(const shape_mesh *m, int32_t f, int32_t v)
{
    const int32_t *t = m->s.tri + 3 * (size_t)f;
    return t[0] == v ? 0 : t[1] == v ? 1 : t[2] == v ? 2 : -1;
}

static int shape_adjacent(const shape_mesh *m, int32_t a, int32_t b)
{
    int32_t i;
    for (i = m->start[a]; i < m->start[a + 1]; i++) if (shape_corner(m, m->face[i], b) >= 0) return 1;
    return 0;
}

/* Whether v, moved to p, leaves its faces (those with `but` aside, which vanish) upright and without long edges. */
static int shape_move_ok(const shape_mesh *m, int32_t v, int32_t but, const double p[3], double longest)
{
    int32_t i;
    for (i = m->start[v]; i < m->start[v + 1]; i++) {
        const int32_t *t = m->s.tri + 3 * (size_t)m->face[i];
        const int k = shape_corner(m, m->face[i], v);
        const double *a = m->s.xyz + 3 * (size_t)v, *b, *c;
        double was[3], is[3];
        if (k < 0 || shape_corner(m, m->face[i], but) >= 0) continue;
        b = m->s.xyz + 3 * (size_t)t[(k + 1) % 3];
        c = m->s.xyz + 3 * (size_t)t[(k + 2) % 3];
        shape_normal(a, b, c, was);
        shape_normal(p, b, c, is);
        if (shape_dot(was, is) <= 0.3 * sqrt(shape_dot(was, was) * shape_dot(is, is))) return 0;
        if (shape_distance(p, b) > longest || shape_distance(p, c) > longest) return 0;
    }
    return 1;
}

/* Collapses b into a, if the surface stays what it is: exactly two common neighbours, none of them of valence three. */
static int shape_collapse(shape_mesh *m, int32_t a, int32_t b)
{
    double p[3];
    int32_t i, common = 0;
    int c;
    if (m->locked[a] || m->locked[b]) return 0;
    for (i = m->start[a]; i < m->start[a + 1]; i++) {
        const int k = shape_corner(m, m->face[i], a);
        const int32_t w = k < 0 ? b : m->s.tri[3 * (size_t)m->face[i] + (size_t)((k + 1) % 3)];     /* each neighbour once */
        if (w == b || !shape_adjacent(m, b, w)) continue;
        common++;
        if (shape_valence(m, w) <= 3) return 0;
    }
    if (common != 2 || shape_valence(m, a) + shape_valence(m, b) > 13) return 0;
    for (c = 0; c < 3; c++) p[c] = 0.5 * (m->s.xyz[3 * (size_t)a + (size_t)c] + m->s.xyz[3 * (size_t)b + (size_t)c]);
    shape_animal_project(p, 2);
    if (!shape_move_ok(m, a, b, p, 1.5 * m->size[a]) || !shape_move_ok(m, b, a, p, 1.5 * m->size[a])) return 0;
    m->locked[a] = m->locked[b] = 1;
    memcpy(m->s.xyz + 3 * (size_t)a, p, sizeof p);
    for (i = m->start[b]; i < m->start[b + 1]; i++) {
        int32_t *t = m->s.tri + 3 * (size_t)m->face[i];
        const int k = shape_corner(m, m->face[i], b);
        if (shape_corner(m, m->face[i], a) >= 0) t[0] = t[1] = t[2] = -1;
        else if (k >= 0) t[k] = a;
    }
    return 1;
}

/* Takes out the faces and vertices that collapses left over. start serves as the map of vertices. */
static void shape_mesh_compact(shape_mesh *m)
{
    int32_t *map = m->start, i, t = 0, n = 0;
    int c;
    for (i = 0; i < m->s.n; i++) map[i] = -1;
    for (i = 0; i < m->s.n_tri; i++) {
        const int32_t *f = m->s.tri + 3 * (size_t)i;
        if (f[0] < 0) continue;
        for (c = 0; c < 3; c++) map[f[c]] = 0;
        shape_put_triangle(&m->s, t++, f[0], f[1], f[2]);
    }
    m->s.n_tri = t;
    for (i = 0; i < m->s.n; i++) {
        if (map[i] < 0) continue;
        memmove(m->s.xyz + 3 * (size_t)n, m->s.xyz + 3 * (size_t)i, 3 * sizeof(double));
        m->size[n] = m->size[i];
        map[i] = n++;
    }
    m->s.n = n;
    for (i = 0; i < 3 * t; i++) m->s.tri[i] = map[m->s.tri[i]];
}

typedef struct shape_edge { double length; int32_t a, b; } shape_edge;

static int shape_compare_edges(const void *pa, const void *pb)
{
    const shape_edge *a = (const shape_edge *)pa, *b = (const shape_edge *)pb;
    if (a->length != b->length) return a->length < b->length ? -1 : 1;
    if (a->a != b->a) return a->a < b->a ? -1 : 1;
    return a->b < b->b ? -1 : a->b > b->b;
}

/* One pass over the edges below `below` of the wanted length, shortest first. Returns how many went, -1 without memory. */
static int32_t shape_collapse_pass(shape_mesh *m, double below)
{
    shape_edge *edge = (shape_edge *)shape_alloc((int64_t)m->s.n_tri * 3 / 2 + 1, sizeof *edge);
    int32_t i, n = 0, gone = 0;
    if (!edge) return -1;
    shape_mesh_lists(m);
    for (i = 0; i < 3 * m->s.n_tri; i++) {
        const int32_t a = m->s.tri[i], b = m->s.tri[i % 3 == 2 ? i - 2 : i + 1];
        if (a > b) continue;        /* the other face's turn */
        edge[n].a = a;
        edge[n].b = b;
        edge[n].length = shape_distance(m->s.xyz + 3 * (size_t)a, m->s.xyz + 3 * (size_t)b) / (0.5 * (m->size[a] + m->size[b]));
        if (edge[n].length < below) n++;
    }
    qsort(edge, (size_t)n, sizeof *edge, shape_compare_edges);
    for (i = 0; i < n; i++) gone += shape_collapse(m, edge[i].a, edge[i].b);
    free(edge);
    shape_mesh_compact(m);
    return gone;
}

/* Cosine of the angle at a. */
static double shape_cosine(const double *a, const double *b, const double *c)
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    return shape_dot(u, v) / sqrt(shape_dot(u, u) * shape_dot(v, v) + 1e-300);
}

/* Flips the edge from corner k of face f to the next one, if the two opposite angles sum to more than a half turn (the
 * Delaunay rule), and the new edge is new and lies well on the surface. */
static int shape_flip(shape_mesh *m, int32_t f, int k)
{
    int32_t *t = m->s.tri + 3 * (size_t)f, a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], g = -1, d, i;
    const double *x = m->s.xyz, *pa, *pb, *pc, *pd;
    double n1[3], n2[3], n3[3], n4[3];
    for (i = m->start[a]; i < m->start[a + 1]; i++)
        if (m->face[i] != f && shape_corner(m, m->face[i], b) >= 0) g = m->face[i];
    if (g < 0) return 0;
    i = shape_corner(m, g, a);
    d = m->s.tri[3 * (size_t)g + (size_t)((i + 1) % 3)];
    if (d == c || m->locked[a] || m->locked[b] || m->locked[c] || m->locked[d]) return 0;
    pa = x + 3 * (size_t)a; pb = x + 3 * (size_t)b; pc = x + 3 * (size_t)c; pd = x + 3 * (size_t)d;
    if (shape_cosine(pc, pa, pb) + shape_cosine(pd, pa, pb) > -1e-6) return 0;      /* angles sum to less than pi */
    if (shape_valence(m, a) <= 4 || shape_valence(m, b) <= 4 || shape_adjacent(m, c, d)) return 0;
    shape_normal(pa, pb, pc, n1); shape_normal(pb, pa, pd, n2);
    shape_normal(pa, pd, pc, n3); shape_normal(pd, pb, pc, n4);
    for (i = 0; i < 3; i++) n1[i] += n2[i];
    if (shape_dot(n1, n3) <= 0.5 * sqrt(shape_dot(n1, n1) * shape_dot(n3, n3)) ||
        shape_dot(n1, n4) <= 0.5 * sqrt(shape_dot(n1, n1) * shape_dot(n4, n4))) return 0;
    shape_put_triangle(&m->s, f, a, d, c);
    shape_put_triangle(&m->s, g, d, b, c);
    m->locked[a] = m->locked[b] = m->locked[c] = m->locked[d] = 1;
    return 1;
}

static int32_t shape_flip_pass(shape_mesh *m)
{
    int32_t f, flipped = 0;
    int k;
    shape_mesh_lists(m);
    for (f = 0; f < m->s.n_tri; f++) for (k = 0; k < 3; k++)
        if (m->s.tri[3 * f + k] < m->s.tri[3 * f + (k + 1) % 3]) flipped += shape_flip(m, f, k);
    return flipped;
}

/* Moves every vertex towards the area-weighted middle of its faces, along the surface only, and back onto the surface. */
static void shape_relax(shape_mesh *m, double pace)
{
    int32_t i, j;
    int c;
    shape_mesh_lists(m);
    for (i = 0; i < m->s.n; i++) {
        const double *p = m->s.xyz + 3 * (size_t)i;
        double *q = m->moved + 3 * (size_t)i, normal[3] = {0, 0, 0}, middle[3] = {0, 0, 0}, sum = 0, nn, along;
        for (j = m->start[i]; j < m->start[i + 1]; j++) {
            const int32_t *t = m->s.tri + 3 * (size_t)m->face[j];
            const double *a = m->s.xyz + 3 * (size_t)t[0], *b = m->s.xyz + 3 * (size_t)t[1], *d = m->s.xyz + 3 * (size_t)t[2];
            const double s = (m->size[t[0]] + m->size[t[1]] + m->size[t[2]]) / 3;
            double n[3], w;
            shape_normal(a, b, d, n);
            w = sqrt(shape_dot(n, n)) / (s * s);
            sum += w;
            for (c = 0; c < 3; c++) { normal[c] += n[c]; middle[c] += w * (a[c] + b[c] + d[c]) / 3; }
        }
        nn = shape_dot(normal, normal) + 1e-300;
        for (c = 0; c < 3; c++) q[c] = middle[c] / (sum + 1e-300) - p[c];
        along = shape_dot(q, normal) / nn;
        for (c = 0; c < 3; c++) q[c] = p[c] + pace * (q[c] - along * normal[c]);
        shape_animal_project(q, 1);
    }
    memcpy(m->s.xyz, m->moved, (size_t)m->s.n * 3 * sizeof(double));
}

/* ==== [6] the demo ==== */

/* Edge length with which the surface has about n vertices: an edge of length l stands for an area of 0.866 l^2 per vertex. */
static double shape_demo_length(shape_mesh *m, double n)
{
    double sum = 0, normal[3];
    int32_t t;
    shape_mesh_sizes(m, 1);
    for (t = 0; t < m->s.n_tri; t++) {
        const int32_t *v = m->s.tri + 3 * (size_t)t;
        const double s = (m->size[v[0]] + m->size[v[1]] + m->size[v[2]]) / 3;
        shape_normal(m->s.xyz + 3 * (size_t)v[0], m->s.xyz + 3 * (size_t)v[1], m->s.xyz + 3 * (size_t)v[2], normal);
        sum += 0.5 * sqrt(shape_dot(normal, normal)) / (s * s);
    }
    return 0.965 * sqrt(sum / (0.866 * n));    /* 0.965: measured; collapsing leaves edges of many lengths */
}

static shape shape_demo_base(double n)
{
    /* fine enough that the tail's ring and the ears come out whole; area about 13.5, see shape_demo_length */
    const double cell = fmin(0.045, 1.0 * sqrt(13.5 / (0.866 * n)));
    shape s = shape_march_run(cell);
    shape_mesh m;
    int round;
    int32_t gone = 0;
    if (!s.xyz) return s;
    if (!shape_mesh_make(&m, &s)) { shape_free(&s); return s; }
    shape_mesh_sizes(&m, shape_demo_length(&m, n));
    for (round = 0; gone >= 0 && round < 30; round++) {
        gone = shape_collapse_pass(&m, round < 4 ? 0.45 + 0.1 * round : 0.78);
        if (gone >= 0) shape_flip_pass(&m);
        if (gone >= 0 && round % 2) shape_relax(&m, 0.6);
        if (round > 4 && gone < m.s.n / 300) break;
    }
    for (round = 0; gone >= 0 && round < 8; round++) { shape_flip_pass(&m); shape_flip_pass(&m); shape_relax(&m, 0.7); }
    s = m.s;
    shape_mesh_free(&m);
    if (gone < 0) shape_free(&s);
    return s;
}

/* The demo: a walking elephant, closed, genus 2, irregular, of about approx_n vertices (0: 12000; at least 1500). */
static shape shape_demo(int32_t approx_n)
{
    double n = approx_n > 0 ? (approx_n > 1500 ? approx_n : 1500) : 12000;
    int halvings = 0;
    shape s, finer;
    int32_t i;
    for (; n > 30000; n /= 4) halvings++;       /* large ones by subdivision: the grid would need too much room */
    s = shape_demo_base(n);
    for (; s.xyz && halvings > 0; halvings--) {
        finer = shape_subdivide(&s);
        shape_free(&s);
        s = finer;
        for (i = 0; i < s.n; i++) shape_animal_project(s.xyz + 3 * (size_t)i, 2);
    }
    return s;
}

/* Bends n places around an axis that stands beside them, parallel to y. */
static void shape_bend(double *xyz, int32_t n)
{
    int32_t i;
    for (i = 0; i < n; i++) {
        double *p = xyz + 3 * (size_t)i;
        const double r = 2 + p[2], angle = p[0] / 2;
        p[0] = r * sin(angle);
        p[2] = r * cos(angle) - 2;
    }
}

/* Moves each coordinate at random, by at most so much (Park, Miller 1988, with a small addition). */
static void shape_shake(double *xyz, int32_t n, double most)
{
    uint64_t seed = 1;
    size_t i;
    for (i = 0; i < 3 * (size_t)n; i++) {
        seed = (16807 * seed + 7) % 2147483647u;
        xyz[i] += most * ((double)seed / 1073741823.5 - 1);
    }
}

/* ==== [7] shapes of polygons ==== */

typedef struct shape_poly {
    int32_t n;
    double *xyz;         /* [3n] */
    int32_t n_faces;
    int64_t *face_ptr;   /* [n_faces + 1] */
    int32_t *face_idx;   /* the corners of face f: face_idx[face_ptr[f]] .. face_idx[face_ptr[f + 1] - 1] */
} shape_poly;

static void shape_poly_free(shape_poly *s)
{
    free(s->xyz);
    free(s->face_ptr);
    free(s->face_idx);
    memset(s, 0, sizeof *s);
}

/* Room for faces with so many corners in all; shape_put_face fills them one after the other. */
static shape_poly shape_poly_make(int64_t n, int64_t n_faces, int64_t n_corners)
{
    shape_poly s;
    memset(&s, 0, sizeof s);
    if (n < 0 || n_faces < 0 || n > INT32_MAX / 4 || n_faces > INT32_MAX / 4) return s;
    s.xyz = (double *)shape_alloc(n, 3 * sizeof(double));
    s.face_ptr = (int64_t *)shape_alloc(n_faces + 1, sizeof(int64_t));
    s.face_idx = (int32_t *)shape_alloc(n_corners, sizeof(int32_t));
    if (!s.xyz || !s.face_ptr || !s.face_idx) { shape_poly_free(&s); return s; }
    s.n = (int32_t)n;
    s.face_ptr[0] = 0;
    return s;
}

static void shape_put_face(shape_poly *s, int32_t k, const int32_t *corner)
{
    memcpy(s->face_idx + s->face_ptr[s->n_faces], corner, (size_t)k * sizeof *corner);
    s->face_ptr[s->n_faces + 1] = s->face_ptr[s->n_faces] + k;
    s->n_faces++;
}

static void shape_put_quad(shape_poly *s, int32_t a, int32_t b, int32_t c, int32_t d)
{
    const int32_t corner[4] = {a, b, c, d};
    shape_put_face(s, 4, corner);
}

/* The triangles of a shape as faces. */
static shape_poly shape_poly_of(const shape *s)
{
    shape_poly p = shape_poly_make(s->xyz ? s->n : -1, s->n_tri, 3 * (int64_t)s->n_tri);
    int32_t t;
    if (!p.xyz) return p;
    memcpy(p.xyz, s->xyz, (size_t)s->n * 3 * sizeof(double));
    for (t = 0; t < s->n_tri; t++) shape_put_face(&p, 3, s->tri + 3 * (size_t)t);
    return p;
}

/* Torus as shape_torus, of quadrilaterals, which are not planar. */
static shape_poly shape_quad_torus(int32_t nu, int32_t nv, double R, double r)
{
    shape s = shape_torus(nu, nv, R, r);
    shape_poly p = shape_poly_make(s.xyz ? s.n : -1, s.n, 4 * (int64_t)s.n);
    int32_t i, j;
    if (p.xyz) {
        memcpy(p.xyz, s.xyz, (size_t)s.n * 3 * sizeof(double));
        for (i = 0; i < nu; i++) for (j = 0; j < nv; j++) {
            const int32_t i1 = (i + 1) % nu, j1 = (j + 1) % nv;
            shape_put_quad(&p, i * nv + j, i * nv + j1, i1 * nv + j1, i1 * nv + j);
        }
    }
    shape_free(&s);
    return p;
}

/* The number of lattice point (i, j, k) on the surface of a cube of m^3 cells, met in this order: layers of k, in them rows of j. */
static int32_t shape_cube_vertex(int32_t m, int32_t i, int32_t j, int32_t k)
{
    const int32_t side = m + 1, ring = 4 * m;
    int32_t before = k == 0 ? 0 : side * side + (k - 1) * ring;     /* in the layers below */
    if (k == 0 || k == m) return before + j * side + i;
    if (j == 0) return before + i;
    before += side + 2 * (j - 1);
    return j == m ? before + i : before + (i > 0);
}

/* Unit sphere of 6 m^2 quadrilaterals: a cube with equal angles between its lines, pushed out; 6 m^2 + 2 vertices. m in 1..1000. */
static shape_poly shape_quad_sphere(int32_t m)
{
    const double quarter = 0.78539816339744831;
    const int ok = m >= 1 && m <= 1000;
    shape_poly s = shape_poly_make(ok ? 6 * (int64_t)m * m + 2 : -1, 6 * (int64_t)m * m, 24 * (int64_t)m * m);
    int32_t i, j, k, a, b;
    int c;
    if (!s.xyz) return s;
    for (k = 0; k <= m; k++) for (j = 0; j <= m; j++) for (i = 0; i <= m; i++) {
        double *p = s.xyz + 3 * (size_t)shape_cube_vertex(m, i, j, k), len;
        if (i > 0 && i < m && j > 0 && j < m && k > 0 && k < m) continue;
        p[0] = tan(quarter * (2.0 * i / m - 1));
        p[1] = tan(quarter * (2.0 * j / m - 1));
        p[2] = tan(quarter * (2.0 * k / m - 1));
        len = sqrt(shape_dot(p, p));
        for (c = 0; c < 3; c++) p[c] /= len;
    }
    for (a = 0; a < m; a++) for (b = 0; b < m; b++) for (c = 0; c < 6; c++) {
        int32_t v[4];
        for (i = 0; i < 4; i++) {
            const int32_t p = a + (i == 1 || i == 2), q = b + (i > 1), far_side = c < 3 ? 0 : m, x = c < 3 ? q : p, y = c < 3 ? p : q;
            v[i] = c % 3 == 0 ? shape_cube_vertex(m, far_side, x, y) : c % 3 == 1 ? shape_cube_vertex(m, y, far_side, x)
                                                                                  : shape_cube_vertex(m, x, y, far_side);
        }
        shape_put_face(&s, 4, v);
    }
    return s;
}

/* The triangle at vertex v whose corner after v is w; -1: none. list: the corners at v. */
static int32_t shape_turn(const shape *s, const int32_t *list, int32_t count, int32_t w)
{
    int32_t i;
    for (i = 0; i < count; i++)
        if (s->tri[list[i] - list[i] % 3 + (list[i] + 1) % 3] == w) return list[i];
    return -1;
}

/* The dual of a closed shape: a vertex in the middle of every triangle, a face around every vertex, with as many corners as it has triangles. */
static shape_poly shape_dual(const shape *s)
{
    const int64_t n_corners = 3 * (int64_t)s->n_tri;
    shape_poly d = shape_poly_make(s->xyz ? s->n_tri : -1, s->n, n_corners);
    int32_t *ptr = (int32_t *)shape_alloc(s->n + 2, sizeof *ptr), *list = (int32_t *)shape_alloc(n_corners, sizeof *list);
    int32_t *ring = (int32_t *)shape_alloc(n_corners, sizeof *ring), v, k, c;
    int ok = d.xyz && ptr && list && ring, q;
    if (ok) {
        for (k = 0; k < s->n_tri; k++) for (q = 0; q < 3; q++)
            d.xyz[3 * (size_t)k + (size_t)q] = (s->xyz[3 * (size_t)s->tri[3 * k] + (size_t)q] + s->xyz[3 * (size_t)s->tri[3 * k + 1] + (size_t)q] +
                                               s->xyz[3 * (size_t)s->tri[3 * k + 2] + (size_t)q]) / 3;
        memset(ptr, 0, ((size_t)s->n + 2) * sizeof *ptr);
        for (c = 0; c < n_corners; c++) ptr[s->tri[c] + 2]++;
        for (v = 0; v < s->n; v++) ptr[v + 2] += ptr[v + 1];
        for (c = 0; c < n_corners; c++) list[ptr[s->tri[c] + 1]++] = c;
    }
    for (v = 0; v < s->n && ok; v++) {
        const int32_t count = ptr[v + 1] - ptr[v];
        c = count ? list[ptr[v]] : -1;
        for (k = 0; k < count && c >= 0; k++) {              /* the next triangle begins where this one ends */
            ring[k] = c / 3;
            c = shape_turn(s, list + ptr[v], count, s->tri[c - c % 3 + (c + 2) % 3]);
        }
        ok = count > 2 && k == count && c == list[ptr[v]];
        if (ok) shape_put_face(&d, count, ring);
    }
    free(ptr);
    free(list);
    free(ring);
    if (!ok) shape_poly_free(&d);
    return d;
}

/* Unit sphere of 12 pentagons and 10 4^levels - 10 hexagons, none of the latter quite planar: the dual of an icosphere, pushed out. */
static shape_poly shape_hex_sphere(int levels)
{
    shape s = shape_icosphere(levels);
    shape_poly d = shape_dual(&s);
    int32_t i;
    int c;
    for (i = 0; i < d.n; i++) {
        double *p = d.xyz + 3 * (size_t)i, len = sqrt(shape_dot(p, p));
        for (c = 0; c < 3; c++) p[c] /= len;
    }
    shape_free(&s);
    return d;
}

/* Planar, 3 a wide and 2 b high in cells of 1: faces of eight corners in the shape of an L, two to every three by two cells. Inner vertices are
 * moved by up to jitter (0..0.3). */
static shape_poly shape_trominoes(int32_t a, int32_t b, double jitter)
{
    static const int8_t corner[2][8][2] = {{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}},
                                           {{2, 0}, {3, 0}, {3, 1}, {3, 2}, {2, 2}, {1, 2}, {1, 1}, {2, 1}}};
    const int ok = a >= 1 && b >= 1 && a < 10000 && b < 10000 && jitter >= 0 && jitter <= 0.3;
    const int32_t nx = 3 * a + 1, ny = 2 * b + 1;
    shape_poly s = shape_poly_make(ok ? (int64_t)nx * ny : -1, ok ? 2 * (int64_t)a * b : 0, ok ? 16 * (int64_t)a * b : 0);
    uint64_t seed = 11;
    int32_t i, j, v[8];
    int f, k;
    if (!s.xyz) return s;
    for (j = 0; j < ny; j++) for (i = 0; i < nx; i++) {
        const double inner = i > 0 && j > 0 && i < nx - 1 && j < ny - 1 ? jitter : 0;
        double *p = s.xyz + 3 * ((size_t)j * (size_t)nx + (size_t)i);
        p[0] = i + inner * shape_signed(&seed);
        p[1] = j + inner * shape_signed(&seed);
        p[2] = 0;
    }
    for (j = 0; j < b; j++) for (i = 0; i < a; i++) for (f = 0; f < 2; f++) {
        for (k = 0; k < 8; k++) v[k] = (2 * j + corner[f][k][1]) * nx + 3 * i + corner[f][k][0];
        shape_put_face(&s, 8, v);
    }
    return s;
}

#endif
