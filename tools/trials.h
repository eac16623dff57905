/* trials.h - cases: what a small shape is asked, and whether the answer is as near to the truth as its report says

   A case is a line of words, "shape=grid/9/6 op=fem query=column method=krylov th=10"; what is left out is the default:

   shape     a maker and up to four numbers, see trial_body_make
   op        fem, vor, cot, poly, with +id, +tuft, +held, +pin; vexp, exp, tuft for points; I, diag, massN, heavyN, tri, near for graphs
   scale     coordinates are multiplied by this
   query     apply, column, times, derivative, adjoint, from, filter, entries, pairs, diagonal, distance, distance_from
   kernel    operator, symmetric
   kind      classical, weighted, commute, biharmonic; for times: weighted asks for a column instead of a field
   method, solver, precond, poles, degree, tol    options of the plan
   own, x    sets of poles of the caller's own; fitted: a filter, which seed says, of eigenvalues about 1/t
   t, th     the time, or the time in units of the shape's own (h^2)
   times, span    so many times from t to span t
   k, corners     columns, pairs or sources; corners of a source between vertices
   curve, apart   1: a source is a curve; its points may lie in several components
   field, seed    of a field; what else is drawn

   truth.h makes the truth. A comparison is one column of an answer, or one list of entries or pairs. */

#ifndef TRIALS_H
#define TRIALS_H

#include "truth.h"
#include "shapes.h"

/* ==== [4] shapes ==== */

/* A shape by name, "grid/9/6": what it is and up to four numbers. */
typedef struct trial_body {
    shape s;
    shape_poly p;
    hd_csr L;
    int points, matrix;
    uint64_t seed;               /* of the masses of a graph */
} trial_body;

static double trial_power10(uint64_t *seed, double lo, double hi) {
    return pow(10, lo + (hi - lo) * shape_uniform(seed));
}

static int trial_below(uint64_t *seed, int n) { return (int)(shape_uniform(seed) * n); }
static int trial_chance(uint64_t *seed, double p) { return shape_uniform(seed) < p; }

/* m x m vertices, places given by the caller; triangles, and quadrilaterals too. */
static void trial_lattice(trial_body *b, int m) {
    int32_t i, j, t = 0;
    b->s = shape_make(m * m, 2 * (m - 1) * (m - 1));
    b->p = shape_poly_make(m * m, (m - 1) * (m - 1), 4 * (m - 1) * (m - 1));
    if (!b->s.xyz || !b->p.xyz) truth_stop("out of memory");
    for (i = 0; i + 1 < m; i++)
        for (j = 0; j + 1 < m; j++) {
            const int32_t a = i * m + j;
            shape_put_triangle(&b->s, t++, a, a + m, a + 1);
            shape_put_triangle(&b->s, t++, a + 1, a + m, a + m + 1);
            shape_put_quad(&b->p, a, a + m, a + m + 1, a + 1);
        }
}

/* The icosahedron's faces cut into f^2: a sphere of 10 f^2 + 2 vertices. */
static shape trial_sphere(int f) {
    shape ico = shape_icosphere(0), s = shape_make(10 * f * f + 2, 20 * f * f);
    int32_t *at = TRUTH_NEW(int32_t, (f + 1) * (f + 1)), t, i, j, k, n = 0, m = 0;
    int c;
    if (!ico.xyz || !s.xyz) truth_stop("out of memory");
    for (t = 0; t < 20; t++) {
        const int32_t *v = ico.tri + 3 * t;
        for (i = 0; i <= f; i++)
            for (j = 0; i + j <= f; j++) {
                double p[3], len;
                for (c = 0; c < 3; c++)
                    p[c] = (f - i - j) * ico.xyz[3 * v[0] + c] + i * ico.xyz[3 * v[1] + c] +
                           j * ico.xyz[3 * v[2] + c];
                len = sqrt(shape_dot(p, p));
                for (c = 0; c < 3; c++) p[c] /= len;
                for (k = 0; k < n && shape_distance(p, s.xyz + 3 * k) > 1e-9; k++) {}
                if (k == n) shape_put_vertex(&s, n++, p[0], p[1], p[2]);
                at[i * (f + 1) + j] = k;
            }
        for (i = 0; i < f; i++)
            for (j = 0; i + j < f; j++) {
                shape_put_triangle(&s, m++, at[i * (f + 1) + j], at[(i + 1) * (f + 1) + j],
                                   at[i * (f + 1) + j + 1]);
                if (i + j < f - 1)
                    shape_put_triangle(&s, m++, at[(i + 1) * (f + 1) + j], at[(i + 1) * (f + 1) + j + 1],
                                       at[i * (f + 1) + j + 1]);
            }
    }
    free(at);
    shape_free(&ico);
    return s;
}

/* Room for more vertices and triangles. */
static shape trial_enlarge(shape *s, int32_t vertices, int32_t triangles) {
    shape r = shape_make(s->n + vertices, s->n_tri + triangles);
    if (!r.xyz) truth_stop("out of memory");
    memcpy(r.xyz, s->xyz, 3 * (size_t)s->n * sizeof *s->xyz);
    memcpy(r.tri, s->tri, 3 * (size_t)s->n_tri * sizeof *s->tri);
    r.n = s->n;
    r.n_tri = s->n_tri;
    shape_free(s);
    return r;
}

/* The middle of an edge of triangle f moved h towards the third corner: two slivers and a thin triangle take
 * its place. */
static void trial_sliver(shape *s, int32_t f, double h) {
    const int32_t a = s->tri[3 * f], b = s->tri[3 * f + 1], c = s->tri[3 * f + 2], k = s->n;
    int d;
    *s = trial_enlarge(s, 1, 2);
    for (d = 0; d < 3; d++) {
        const double m = (s->xyz[3 * a + d] + s->xyz[3 * b + d]) / 2;
        s->xyz[3 * k + d] = m + (s->xyz[3 * c + d] - m) * h;
    }
    s->n++;
    shape_put_triangle(s, f, a, k, c);
    shape_put_triangle(s, s->n_tri++, k, b, c);
    shape_put_triangle(s, s->n_tri++, a, b, k);
}

/* Rings 0..m about a vertex, of 6 k vertices each: in the plane, or over the upper half of the unit sphere. */
static shape trial_disk(int32_t m, int round) {
    const double pi = 3.14159265358979323846;
    shape s = shape_make(1 + 3 * (int64_t)m * (m + 1), 6 * (int64_t)m * m);
    int32_t k, q, t = 0;
    if (!s.xyz) truth_stop("out of memory");
    shape_put_vertex(&s, 0, 0, 0, round);
    for (k = 1; k <= m; k++) {
        const int32_t first = 1 + 3 * k * (k - 1), inner = k > 1 ? 1 + 3 * (k - 1) * (k - 2) : 0, n = 6 * k, n_in = k > 1 ? 6 * (k - 1) : 1;
        const double r = (double)k / m, x = round ? sin(r * pi / 2) : r, z = round ? cos(r * pi / 2) : 0;
        for (q = 0; q < n; q++) {
            const int32_t a = first + q, b = first + (q + 1) % n, side = q / k, at = q % k, c = inner + (side * (k - 1) + at) % n_in;
            shape_put_vertex(&s, a, x * cos(2 * pi * q / n), x * sin(2 * pi * q / n), z);
            shape_put_triangle(&s, t++, a, b, c);
            if (at > 0) shape_put_triangle(&s, t++, a, c, inner + (side * (k - 1) + at - 1) % n_in);
        }
    }
    return s;
}

/* The shape with vertices that are in no face: the first, the last, and every fifth. */
static shape trial_spare(shape b) {
    const int32_t n = b.n + b.n / 4 + 2;
    shape s = shape_make(n, b.n_tri);
    int32_t *to = TRUTH_NEW(int32_t, b.n), i, k = 0;
    if (!s.xyz) truth_stop("out of memory");
    for (i = 0; i < n; i++) {
        if (i % 5 == 0 || k == b.n) {
            shape_put_vertex(&s, i, 9 + i, 8, 7);
            continue;
        }
        memcpy(s.xyz + 3 * i, b.xyz + 3 * k, 3 * sizeof(double));
        to[k++] = i;
    }
    for (i = 0; i < 3 * b.n_tri; i++) s.tri[i] = to[b.tri[i]];
    free(to);
    shape_free(&b);
    return s;
}

/* A sphere, and a sheet that has borders, edges of three faces, and a vertex in no face. */
static shape trial_tangle(void) {
    static const double offset[3] = {9, 1, 0};
    shape a = shape_icosphere(1), b = shape_grid(8, 6, 0.3), s = shape_disjoint(&a, &b, offset);
    int32_t f;
    if (!s.xyz) truth_stop("out of memory");
    for (f = a.n_tri; f < s.n_tri; f++) {
        if (s.tri[3 * f] == a.n + 20) s.tri[3 * f] = a.n + 4;
        if (f % 11 == 0) s.tri[3 * f + 1] = a.n + 30;
    }
    s.n--;                                       /* faces of the last corner go to its neighbour, and the vertex before is in no face then */
    for (f = 0; f < 3 * s.n_tri; f++)
        if (s.tri[f] >= s.n - 1) s.tri[f] = s.n - 2;
    shape_free(&a);
    shape_free(&b);
    return s;
}

static shape trial_needles(int levels) {
    shape s = shape_bumpy(levels, 5);
    int32_t i;
    for (i = 0; i < s.n; i++) s.xyz[3 * i] *= 6;
    return s;
}

/* Points of a sphere, of which two are in one place. */
static shape trial_cloud(int32_t n, int blue) {
    shape s = shape_points(n, shape_on_sphere, 12.566370614359172, blue, 3);
    if (s.xyz) memcpy(s.xyz + 3 * (n - 1), s.xyz + 3 * 7, 3 * sizeof(double));
    return s;
}

/* Symmetric weights as a dense matrix, diagonals the sums of their rows and what is added. */
typedef struct trial_weights { int n; double *w, *extra; double sign; } trial_weights;

static void trial_join(trial_weights *g, int i, int j, double w) { g->w[i * g->n + j] = g->w[j * g->n + i] = w; }

static void trial_csr(hd_csr *out, const double *a, int n) {
    int32_t *I = TRUTH_NEW(int32_t, n * n), *J = TRUTH_NEW(int32_t, n * n);
    double *V = TRUTH_NEW(double, n * n);
    int i, j, k = 0;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++)
            if (a[i * n + j] != 0) {
                I[k] = i;
                J[k] = j;
                V[k++] = a[i * n + j];
            }
    if (hd_csr_from_triplets(out, n, n, k, I, J, V, NULL, NULL) < 0) truth_stop("triplets");
    free(I);
    free(J);
    free(V);
}

static void trial_graph_matrix(trial_body *b, trial_weights *g) {
    int i, j;
    for (i = 0; i < g->n; i++) {
        double sum = 0;
        for (j = 0; j < g->n; j++) {
            if (i != j) sum += g->w[i * g->n + j];
            g->w[i * g->n + j] = -g->sign * g->w[i * g->n + j];
        }
        g->w[i * g->n + i] = g->sign * sum + g->extra[i];
    }
    trial_csr(&b->L, g->w, g->n);
    b->matrix = 1;
    free(g->w);
    free(g->extra);
}

/* "tree/n/s": the s-th random tree, where a little heat leaves at one vertex. */
static void trial_tree(trial_body *b, trial_weights *g, const double *p) {
    uint64_t seed = 7 + (uint64_t)p[1];
    const int loose = trial_chance(&seed, 0.5) ? 3 : g->n;     /* bushy, or hardly more than a path */
    int i;
    for (i = 1; i < g->n; i++)
        trial_join(g, i, i - 1 - (int)((i < loose ? i : loose) * shape_uniform(&seed)), 1 + floor(7 * shape_uniform(&seed)));
    g->extra[(int)(g->n * shape_uniform(&seed))] = trial_power10(&seed, -8, 0);
    b->seed = seed;
}

/* "graph/n/k": a random tree and n more edges, weights 1..7, one edge of 10^k; "lattice/m/k": a grid graph of
 * the same kind. */
static void trial_random_graph(trial_weights *g, const double *p, int grid) {
    uint64_t seed = 5 + (uint64_t)(97 * p[0] + p[1]);
    const int m = (int)p[0];
    int i;
    for (i = 1; i < g->n; i++) {
        const double w = 1 + floor(7 * shape_uniform(&seed));
        if (!grid) trial_join(g, i, (int)(i * shape_uniform(&seed)), w);
        else if (i % m) trial_join(g, i, i - 1, w);
        if (grid && i >= m) trial_join(g, i, i - m, 1 + floor(7 * shape_uniform(&seed)));
    }
    for (i = 0; i < g->n && !grid; i++) {
        const int a = (int)(g->n * shape_uniform(&seed)), c = (int)(g->n * shape_uniform(&seed));
        if (a != c) trial_join(g, a, c, 1 + floor(7 * shape_uniform(&seed)));
    }
    if (p[1] > 0) trial_join(g, g->n / 2, g->n / 2 - 1, pow(10, p[1]));
}

static int trial_graph(trial_body *b, const char *name, const double *p) {
    trial_weights g;
    int i;
    g.n = strcmp(name, "lattice") == 0 ? (int)(p[0] * p[0]) : (int)p[0];
    if (g.n < 1 || g.n > 400) return 0;
    g.w = TRUTH_NEW(double, g.n * g.n);
    g.extra = TRUTH_NEW(double, g.n);
    g.sign = 1;
    if (strcmp(name, "graph") == 0 || strcmp(name, "lattice") == 0) {
        trial_random_graph(&g, p, name[0] == 'l');
    } else if (strcmp(name, "tree") == 0) {
        trial_tree(b, &g, p);
    } else if (strcmp(name, "path") == 0 || strcmp(name, "drain") == 0) {
        if (name[0] == 'd') g.extra[0] = p[1];   /* a path that heat leaves at its first vertex */
        for (i = 0; i + 1 < g.n; i++) trial_join(&g, i, i + 1, 1);
    } else if (strcmp(name, "star") == 0) {
        for (i = 1; i < g.n; i++) trial_join(&g, 0, i, 1);
    } else if (strcmp(name, "weak") == 0) {
        /* two cycles, or as many as p[2], in a chain of edges 2^-k */
        const int parts = p[2] > 1 ? (int)p[2] : 2, m = g.n / parts;
        if (m < 3) return 0;
        for (i = 0; i < parts * m; i++) trial_join(&g, i, i % m == m - 1 ? i - m + 1 : i + 1, 1);
        for (i = 1; i < parts; i++) trial_join(&g, (i - 1) * m, i * m, ldexp(1, -(int)p[1]));
        for (i = parts * m; i < g.n; i++) trial_join(&g, i - 1, i, 1);
    } else if (strcmp(name, "none") != 0) {
        /* cycles: plain, turned, turned but with a diagonal that hides it, with something on one diagonal entry or on all */
        for (i = 0; i < g.n && g.n > 2; i++) trial_join(&g, i, (i + 1) % g.n, 1);
        if (strcmp(name, "turned") == 0 || strcmp(name, "hidden") == 0) g.sign = -1;
        else if (strcmp(name, "penalty") == 0) g.extra[0] = pow(10, p[1]);
        else if (strcmp(name, "leak") != 0 && strcmp(name, "cycle") != 0) return 0;
        for (i = 0; i < g.n; i++) g.extra[i] += strcmp(name, "leak") == 0 ? p[1] : strcmp(name, "hidden") == 0 ? 3 : 0;
    }
    trial_graph_matrix(b, &g);
    return 1;
}

static int trial_mesh(trial_body *b, const char *name, const double *p) {
    uint64_t seed = 3 + (uint64_t)(1000 * fabs(p[1]) + p[0]);
    const int m = (int)p[0];
    int i, j;
    if (strcmp(name, "grid") == 0 || strcmp(name, "strip") == 0) {
        /* side, power: graded either way, or one way */
        if (m < 2) return 0;
        trial_lattice(b, m);
        for (i = 0; i < m; i++)
            for (j = 0; j < m; j++)
                shape_put_vertex(&b->s, i * m + j, pow((i + 0.5) / m, p[1]),
                                 name[0] == 'g' ? pow((j + 0.5) / m, p[1]) : (j + 0.5) / m, 0);
    } else if (strcmp(name, "bump") == 0 || strcmp(name, "split") == 0 || strcmp(name, "inert") == 0) {
        /* side, seed */
        if (m < 2) return 0;
        trial_lattice(b, m);
        for (i = 0; i < m; i++)
            for (j = 0; j < m; j++) {
                const double dx = 0.35 * shape_signed(&seed), dy = 0.35 * shape_signed(&seed);
                shape_put_vertex(&b->s, i * m + j, (i + dx) / m, (j + dy) / m, 0.6 / m * shape_signed(&seed));
            }
        if (name[0] == 's') {
            /* cut along a line of vertices, which become two each */
            b->s = trial_enlarge(&b->s, m, 0);
            for (j = 0; j < m; j++, b->s.n++)
                memcpy(b->s.xyz + 3 * b->s.n, b->s.xyz + 3 * (m / 2 * m + j), 3 * sizeof(double));
            for (i = 2 * (m / 2) * (m - 1); i < b->s.n_tri; i++)
                for (j = 0; j < 3; j++)
                    if (b->s.tri[3 * i + j] / m == m / 2 && b->s.tri[3 * i + j] < m * m)
                        b->s.tri[3 * i + j] += m * m - m / 2 * m;
        } else if (name[0] == 'i') {             /* two vertices in no face */
            b->s = trial_enlarge(&b->s, 2, 0);
            for (j = 0; j < 2; j++) shape_put_vertex(&b->s, b->s.n++, j, 1, 2);
        }
        if (name[0] != 'b') shape_poly_free(&b->p);
    } else if (strcmp(name, "soup") == 0) {      /* m triangles, each for itself */
        b->s = shape_make(3 * m, m);
        for (i = 0; i < 9 * m; i++) b->s.xyz[i] = shape_signed(&seed);
        for (i = 0; i < m; i++) shape_put_triangle(&b->s, i, 3 * i, 3 * i + 1, 3 * i + 2);
    } else if (strcmp(name, "sphere") == 0 || strcmp(name, "sliver") == 0) {
        if (m < 1 || m > 4) return 0;
        b->s = trial_sphere(m);
        if (name[1] == 'l') trial_sliver(&b->s, 7, pow(10, -p[1]));
        for (i = 1; name[1] == 'l' && i < (int)p[2]; i++)
            trial_sliver(&b->s, 7 + 3 * i, trial_power10(&seed, -p[1], -2));
    } else if (strcmp(name, "two") == 0) {       /* two spheres, one 10^-k as large, so far off */
        shape large, small;
        double offset[3];
        if (m < 1 || m > 3) return 0;
        large = trial_sphere(m);
        small = trial_sphere(m);
        offset[0] = offset[1] = offset[2] = p[2];
        for (i = 0; i < 3 * small.n; i++) small.xyz[i] *= pow(10, -p[1]);
        b->s = shape_disjoint(&large, &small, offset);
        shape_free(&large);
        shape_free(&small);
    } else if (strcmp(name, "cone") == 0) {
        /* rings, corners of a ring: masses fall by 10^13 towards the tip */
        const int k = (int)p[1];
        int t = 0;
        if (m < 2 || k < 3) return 0;
        b->s = shape_make(m * k + 1, k + 2 * k * (m - 1));
        shape_put_vertex(&b->s, m * k, 0, 0, 0);
        for (i = 0; i < m; i++)
            for (j = 0; j < k; j++) {
                const double r = pow(10, -6.5 * i / (m - 1)), a = 6.283185307179586 * (j + 0.5 * (i % 2)) / k;
                shape_put_vertex(&b->s, i * k + j, r * cos(a), r * sin(a), r);
                if (i > 0) {
                    shape_put_triangle(&b->s, t++, (i - 1) * k + j, (i - 1) * k + (j + 1) % k, i * k + j);
                    shape_put_triangle(&b->s, t++, i * k + j, (i - 1) * k + (j + 1) % k, i * k + (j + 1) % k);
                }
                if (i == m - 1) shape_put_triangle(&b->s, t++, i * k + j, i * k + (j + 1) % k, m * k);
            }
        b->s.n_tri = t;
    } else if (strcmp(name, "fan") == 0) {
        /* triangles about a vertex, spokes of all lengths */
        if (m < 3) return 0;
        b->s = shape_make(m + 1, m - 1);
        shape_put_vertex(&b->s, m, 0, 0, 0.1);
        for (i = 0; i < m; i++) {
            const double r = trial_power10(&seed, -p[1], 0), a = 6.0 * i / m;
            shape_put_vertex(&b->s, i, r * cos(a), r * sin(a), 0);
            if (i > 0) shape_put_triangle(&b->s, i - 1, m, i - 1, i);
        }
    } else if (strcmp(name, "five") == 0) {      /* three triangles */
        static const double xyz[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, .2, 2, 0, .1};
        static const int32_t tri[] = {0, 1, 2, 1, 3, 2, 1, 4, 3};
        b->s = shape_make(5, 3);
        memcpy(b->s.xyz, xyz, sizeof xyz);
        memcpy(b->s.tri, tri, sizeof tri);
    } else if (strcmp(name, "points") == 0) {
        /* number, 0 sphere, 1 torus, 2 square, blue or not */
        b->s = shape_points(m, p[1] == 0 ? shape_on_sphere : p[1] == 1 ? shape_on_torus : shape_on_square,
                            p[1] == 0 ? 12.566370614359172 : p[1] == 1 ? 78.95683520871486 : 1, p[2] > 0, 17);
        b->points = 1;
    } else {
        return 0;
    }
    if (!b->s.xyz) truth_stop("out of memory");
    return 1;
}

/* Triangles between any three of n points in a cube: edges with many faces, slivers, vertices in no face. */
static shape trial_jumble(int32_t n, int32_t n_tri, uint64_t seed) {
    shape s = shape_make(n, n_tri);
    int32_t i, v[3];
    for (i = 0; i < 3 * n; i++) s.xyz[i] = shape_signed(&seed);
    for (i = 0; i < n_tri; i++) {
        do {
            int k;
            for (k = 0; k < 3; k++) v[k] = (int32_t)(shape_random(&seed) % (uint64_t)n);
        } while (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]);
        shape_put_triangle(&s, i, v[0], v[1], v[2]);
    }
    return s;
}

/* What shapes.h makes: ico/levels, bumpy/levels/seed, torus/nu/nv, cylinder/nu/nv, flat/nx/ny/jitter, demo/n; of polygons,
 * qtorus/nu/nv, qsphere/m, hex/levels, tromino/a/b/jitter. And what is made here: disk/rings/round, spare/rings/round (a disk with
 * vertices in no face), tangle, jumble/points/triangles/seed, needles/levels, cloud/n/blue. */
static int trial_shape(trial_body *b, const char *name, const double *p) {
    const int32_t m = (int32_t)p[0], k = (int32_t)p[1];
    if (strcmp(name, "ico") == 0) b->s = shape_icosphere(m);
    else if (strcmp(name, "bumpy") == 0) b->s = shape_bumpy(m, (uint64_t)k);
    else if (strcmp(name, "torus") == 0) b->s = shape_torus(m, k, 2, 1);
    else if (strcmp(name, "cylinder") == 0) b->s = shape_cylinder(m, k, 1, 2);
    else if (strcmp(name, "flat") == 0) b->s = shape_grid(m, k, p[2]);
    else if (strcmp(name, "demo") == 0) b->s = shape_demo(m);
    else if (strcmp(name, "jumble") == 0) b->s = trial_jumble(m, k, (uint64_t)p[2]);
    else if (strcmp(name, "qtorus") == 0) b->p = shape_quad_torus(m, k, 2, 1);
    else if (strcmp(name, "qsphere") == 0) b->p = shape_quad_sphere(m);
    else if (strcmp(name, "hex") == 0) b->p = shape_hex_sphere(m);
    else if (strcmp(name, "tromino") == 0) b->p = shape_trominoes(m, k, p[2]);
    else if (strcmp(name, "disk") == 0) b->s = trial_disk(m, k);
    else if (strcmp(name, "spare") == 0) b->s = trial_spare(trial_disk(m, k));
    else if (strcmp(name, "tangle") == 0) b->s = trial_tangle();
    else if (strcmp(name, "needles") == 0) b->s = trial_needles(m);
    else if (strcmp(name, "cloud") == 0) b->s = trial_cloud(m, k);
    else return 0;
    b->points = strcmp(name, "cloud") == 0;
    if (b->p.xyz) {
        b->s = shape_make(b->p.n, 0);
        if (b->s.xyz) memcpy(b->s.xyz, b->p.xyz, 3 * (size_t)b->p.n * sizeof *b->p.xyz);
    }
    if (!b->s.xyz) truth_stop("out of memory");
    return 1;
}

static int trial_body_make(trial_body *b, const char *spec) {
    char name[16];
    double p[4] = {0, 0, 0, 0};
    memset(b, 0, sizeof *b);
    b->seed = 41;
    if (sscanf(spec, "%15[a-z]/%lf/%lf/%lf/%lf", name, p, p + 1, p + 2, p + 3) < 1) return 0;
    return trial_mesh(b, name, p) || trial_shape(b, name, p) || trial_graph(b, name, p);   /* the last makes room first */
}

static void trial_body_free(trial_body *b) {
    shape_free(&b->s);
    shape_poly_free(&b->p);
    hd_csr_free(&b->L, NULL);
}

/* one thread: the answers do not depend on it, and small problems are quicker */
static hd_context trial_serial;

/* B for a graph: "I", "diag" over twelve decades, "massN" over N, "heavyN" 10^N at the last but one and 1 elsewhere, "tri" uneven,
 * "near" the smallest eigenvalue of which is 1e-9. */
static hd_status trial_graph_pair(hd_laplacian **out, const trial_body *b, const char *op, double scale, hd_error *e) {
    const int n = b->L.n_rows;
    double *a = TRUTH_NEW(double, n * n);
    const double decades = strncmp(op, "mass", 4) == 0 ? atof(op + 4)
                           : strcmp(op, "diag") == 0   ? 12
                           : strcmp(op, "tri") == 0    ? 4
                                                       : 0;
    uint64_t seed = b->seed;
    hd_csr B;
    hd_laplacian_opts o;
    hd_status st;
    int i;
    memset(&o, 0, sizeof o);
    o.context = &trial_serial;
    for (i = 0; i < n; i++) {
        a[i * n + i] = decades > 0 ? trial_power10(&seed, -decades / 2, decades / 2) : 1;
        if (strcmp(op, "near") == 0) a[i * n + i] = 1 + 1e-9;
        if (strncmp(op, "heavy", 5) == 0 && i == n - 2) a[i * n + i] = pow(10, atof(op + 5));
    }
    for (i = 0; i + 1 < n; i++) {
        double w = 0;
        if (strcmp(op, "near") == 0) w = 0.5;
        if (strcmp(op, "tri") == 0)
            w = 0.49 * shape_signed(&seed) * fmin(a[i * n + i], a[(i + 1) * n + i + 1]);
        a[i * n + i + 1] = a[(i + 1) * n + i] = w;
    }
    for (i = 0; i < n * n; i++) a[i] *= scale * scale;
    trial_csr(&B, a, n);
    st = hd_laplacian_matrices(out, &b->L, &B, 0, &o, e);
    hd_csr_free(&B, NULL);
    free(a);
    return st;
}

/* The pair of a shape by an operator: fem, vor, cot, poly with +id or +tuft, poly+half; vexp, exp, tuft, tuft+vor for points; all
 * these also with +held or +pin; I, diag, massN, heavyN, tri, near for graphs. Shapes of polygons are always taken as such. */
static hd_status trial_pair(hd_laplacian **out, const char *spec, const char *op, double scale, hd_error *e) {
    hd_laplacian_opts o;
    hd_status st;
    trial_body b;
    int32_t held;
    int i;
    if (!trial_body_make(&b, spec)) {
        fprintf(stderr, "no such shape: %s\n", spec);
        exit(2);
    }
    if (b.matrix) {
        st = trial_graph_pair(out, &b, op, scale, e);
        trial_body_free(&b);
        return st;
    }
    memset(&o, 0, sizeof o);
    o.context = &trial_serial;
    o.kind = strncmp(op, "fem", 3) == 0   ? HD_LAPLACIAN_FEM
             : strncmp(op, "vor", 3) == 0 || strstr(op, "+vor") ? HD_LAPLACIAN_VORONOI_COT
             : strncmp(op, "cot", 3) == 0 ? HD_LAPLACIAN_COT
             : strncmp(op, "vexp", 4) == 0 ? HD_LAPLACIAN_VORONOI_EXP
             : strncmp(op, "exp", 3) == 0 ? HD_LAPLACIAN_EXP
                                          : HD_LAPLACIAN_DEFAULT;
    o.triangulation = strstr(op, "+id") ? HD_TRIANGULATION_DELAUNAY
                      : strstr(op, "+tuft") || (b.points && strncmp(op, "tuft", 4) == 0) ? HD_TRIANGULATION_TUFTED
                                                                                        : HD_TRIANGULATION_GIVEN;
    o.stiffening = strstr(op, "+half") ? 0.5 : 0;
    if (strstr(op, "+held") || strstr(op, "+pin")) {         /* a vertex; held: and the border of a mesh */
        o.n_held = 1;
        o.held = &held;
        o.border = b.points || strstr(op, "+pin") ? HD_BORDER_NATURAL : HD_BORDER_DIRICHLET;
        held = b.s.n / 3;
    }
    for (i = 0; i < 3 * b.s.n; i++) b.s.xyz[i] *= scale;
    if (b.points) {
        st = hd_laplacian_create(out, MESH_POINTS(b.s.xyz, b.s.n), &o, e);
    } else if (strncmp(op, "poly", 4) == 0 || (b.p.xyz && b.s.n_tri == 0)) {
        shape_poly q = b.p.xyz ? b.p : shape_poly_of(&b.s);
        st = hd_laplacian_create(out, MESH_POLYGONS(b.s.xyz, q.n, q.face_ptr, q.face_idx, q.n_faces), &o, e);
        if (!b.p.xyz) shape_poly_free(&q);
    } else {
        st = hd_laplacian_create(out, MESH_TRIANGLES(b.s.xyz, b.s.n, b.s.tri, b.s.n_tri), &o, e);
    }
    trial_body_free(&b);
    return st;
}

/* A time that is neither small nor large: h^2, or for the operators that have no unit one over the mean of
 * diag(L)/diag(B). */
static double trial_unit(const hd_laplacian *lap) {
    double sum = 0;
    int32_t i;
    int64_t p;
    if (lap->h > 0 && lap->kind != HD_LAPLACIAN_COT && lap->kind != HD_LAPLACIAN_EXP) return lap->h * lap->h;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.col[p] == i) sum += fabs(lap->L.val[p]) / lap->b_diag[i];
    return sum > 0 ? lap->n_active / sum : 1;
}

/* ==== [5] cases ==== */

enum { QUERY_APPLY, QUERY_COLUMN, QUERY_TIMES, QUERY_DERIVATIVE, QUERY_ADJOINT, QUERY_FROM, QUERY_FILTER,
       QUERY_ENTRIES, QUERY_PAIRS, QUERY_DIAGONAL, QUERY_DISTANCE, QUERY_DISTANCE_FROM, QUERY_COUNT };
enum { OWN_NONE, OWN_COPY, OWN_COPY0, OWN_LOOSE, OWN_NEAR, OWN_RANDOM, OWN_RESOLVENT, OWN_A0, OWN_PACKS, OWN_FITTED };   /* the last two are not drawn */
enum { FIELD_RANDOM, FIELD_SMOOTH, FIELD_NEARLY, FIELD_HUGE, FIELD_TINY, FIELD_DELTA, FIELD_ALTERNATE,
       FIELD_MODE, FIELD_CONSTANT, FIELD_STEP, FIELD_LINEAR, FIELD_ZERO, FIELD_LEVEL, FIELD_COUNT };

static const char *const trial_queries[] = {"apply",    "column", "times",    "derivative",    "adjoint",
                                          "from",     "filter", "entries",  "pairs",         "diagonal",
                                          "distance", "distance_from", NULL};
static const char *const trial_kernels[] = {"operator", "symmetric", NULL};
static const char *const trial_kinds[] = {"classical", "weighted", "commute", "biharmonic", NULL};

/* Have distances of this kind no time? */
static int trial_timeless(int kind) { return kind == HD_DISTANCE_COMMUTE || kind == HD_DISTANCE_BIHARMONIC; }
static const char *const trial_methods[] = {"auto", "iterative", "direct", "krylov", "local", NULL};
static const char *const trial_solvers[] = {"auto", "cocg", "no number", "minres", "lanczos", NULL};
static const char *const trial_preconds[] = {"auto", "none", "jacobi", "ssor", "ildl", "mildl", NULL};
static const char *const trial_poles[] = {"default", "uniform", "kernel", "own", NULL};
static const char *const trial_owns[] = {"none",   "copy",      "copy0", "loose", "near",
                                        "random", "resolvent", "a0", "packs", "fitted", NULL};
static const char *const trial_fields[] = {"random", "smooth",    "nearly", "huge",     "tiny",
                                          "delta",  "alternate", "mode",   "constant", "step",
                                          "linear", "zero",      "level",  NULL};

typedef struct trial {
    char shape[32], op[16];
    double scale, t, th, span, tol, own_x;       /* th > 0: t in units of the shape's own */
    int query, kernel, kind, method, solver, precond, poles, degree, own, n_times, k, field, corners, curve, apart;
    int64_t seed;
} trial;

typedef enum trial_key_type { KEY_TEXT, KEY_REAL, KEY_INT, KEY_NAME, KEY_SEED } trial_key_type;
typedef struct trial_key { const char *name; trial_key_type type; size_t at; const char *const *names; } trial_key;

static const trial_key trial_keys[] = {{"shape", KEY_TEXT, offsetof(trial, shape), NULL},
                           {"op", KEY_TEXT, offsetof(trial, op), NULL},
                           {"scale", KEY_REAL, offsetof(trial, scale), NULL},
                           {"query", KEY_NAME, offsetof(trial, query), trial_queries},
                           {"kernel", KEY_NAME, offsetof(trial, kernel), trial_kernels},
                           {"kind", KEY_NAME, offsetof(trial, kind), trial_kinds},
                           {"method", KEY_NAME, offsetof(trial, method), trial_methods},
                           {"solver", KEY_NAME, offsetof(trial, solver), trial_solvers},
                           {"precond", KEY_NAME, offsetof(trial, precond), trial_preconds},
                           {"poles", KEY_NAME, offsetof(trial, poles), trial_poles},
                           {"degree", KEY_INT, offsetof(trial, degree), NULL},
                           {"own", KEY_NAME, offsetof(trial, own), trial_owns},
                           {"x", KEY_REAL, offsetof(trial, own_x), NULL},
                           {"tol", KEY_REAL, offsetof(trial, tol), NULL},
                           {"t", KEY_REAL, offsetof(trial, t), NULL},
                           {"th", KEY_REAL, offsetof(trial, th), NULL},
                           {"span", KEY_REAL, offsetof(trial, span), NULL},
                           {"times", KEY_INT, offsetof(trial, n_times), NULL},
                           {"k", KEY_INT, offsetof(trial, k), NULL},
                           {"corners", KEY_INT, offsetof(trial, corners), NULL},
                           {"curve", KEY_INT, offsetof(trial, curve), NULL},
                           {"apart", KEY_INT, offsetof(trial, apart), NULL},
                           {"field", KEY_NAME, offsetof(trial, field), trial_fields},
                           {"seed", KEY_SEED, offsetof(trial, seed), NULL}};

enum { TRIAL_KEYS = sizeof trial_keys / sizeof *trial_keys };

static trial trial_default(void) {
    trial c;
    memset(&c, 0, sizeof c);
    strcpy(c.op, "fem");
    c.scale = c.span = 1;
    c.n_times = c.k = c.corners = 1;
    return c;
}

/* What differs from the default. */
static void trial_print(const trial *c, char *out, size_t size) {
    const trial plain = trial_default();
    size_t at = 0;
    int q;
    out[0] = 0;
    for (q = 0; q < TRIAL_KEYS && at < size; q++) {
        const void *v = (const char *)c + trial_keys[q].at, *d = (const char *)&plain + trial_keys[q].at;
        const size_t bytes = trial_keys[q].type == KEY_TEXT ? strlen((const char *)v) + 1
                             : trial_keys[q].type == KEY_REAL || trial_keys[q].type == KEY_SEED ? 8
                                                                                    : sizeof(int);
        double x = 0;
        int i = 0, digits;
        int64_t s = 0;
        if (q != 1 && q != 3 && memcmp(v, d, bytes) == 0) continue;
        if (trial_keys[q].type == KEY_REAL) memcpy(&x, v, 8);
        else if (trial_keys[q].type == KEY_SEED) memcpy(&s, v, 8);
        else if (trial_keys[q].type != KEY_TEXT) memcpy(&i, v, sizeof i);
        at += (size_t)snprintf(out + at, size - at, "%s%s=", at ? " " : "", trial_keys[q].name);
        if (at >= size) break;
        switch (trial_keys[q].type) {
        case KEY_TEXT: at += (size_t)snprintf(out + at, size - at, "%s", (const char *)v); break;
        case KEY_NAME: at += (size_t)snprintf(out + at, size - at, "%s", trial_keys[q].names[i]); break;
        case KEY_INT: at += (size_t)snprintf(out + at, size - at, "%d", i); break;
        case KEY_SEED: at += (size_t)snprintf(out + at, size - at, "%lld", (long long)s); break;
        default:
            for (digits = 1; digits < 17; digits++) {   /* the shortest that reads back the same */
                char text[40];
                snprintf(text, sizeof text, "%.*g", digits, x);
                if (strtod(text, NULL) == x) break;
            }
            at += (size_t)snprintf(out + at, size - at, "%.*g", digits, x);
        }
    }
}

static trial trial_parse(const char *text) {
    trial c = trial_default();
    char word[160];
    int used = 0, q, i;
    while (sscanf(text, " %159s%n", word, &used) == 1) {
        char *value = strchr(word, '=');
        text += used;
        if (value) *value++ = 0;
        for (q = 0; q < TRIAL_KEYS && strcmp(word, trial_keys[q].name) != 0; q++) {}
        if (!value || q == TRIAL_KEYS) {
            fprintf(stderr, "--case: not understood: %s\n", word);
            exit(2);
        }
        if (trial_keys[q].type == KEY_TEXT) {
            snprintf((char *)&c + trial_keys[q].at,
                     trial_keys[q].at == offsetof(trial, shape) ? sizeof c.shape : sizeof c.op, "%s", value);
        } else if (trial_keys[q].type == KEY_REAL) {
            const double x = strtod(value, NULL);
            memcpy((char *)&c + trial_keys[q].at, &x, sizeof x);
        } else if (trial_keys[q].type == KEY_SEED) {
            const int64_t s = strtoll(value, NULL, 10);
            memcpy((char *)&c + trial_keys[q].at, &s, sizeof s);
        } else {
            if (trial_keys[q].type == KEY_INT) i = atoi(value);
            else {
                for (i = 0; trial_keys[q].names[i] && strcmp(value, trial_keys[q].names[i]) != 0; i++) {}
                if (!trial_keys[q].names[i]) {
                    fprintf(stderr, "--case: %s: unknown: %s\n", word, value);
                    exit(2);
                }
            }
            memcpy((char *)&c + trial_keys[q].at, &i, sizeof i);
        }
    }
    return c;
}

/* ==== [6] comparing ==== */

typedef struct trial_tally {
    char name[48];
    int64_t compared, errors, warned, below, below_b, below_relative, useless, bad, stored, stored_below,
        n_ratio, n_ratio_b, most, most_b;
    float *ratio, *ratio_b;
    double worst;
    char worst_case[400];
} trial_tally;

enum { TRIAL_ROWS = 256 };
static trial_tally trial_rows[TRIAL_ROWS];
static int trial_n_rows;
/* By query: cases put, those without an answer (no pair, no plan, an error), comparisons, those without a finite bound. */
typedef struct trial_count { int64_t asked, refused, compared, unbounded; } trial_count;
static trial_count trial_counts[QUERY_COUNT];
static double trial_largest;         /* bound reported since this was set to zero */
static double trial_shrink = 1;
/* comparisons in which the truth's own error is above a hundredth of the bound */
static int64_t trial_unsure;
static FILE *trial_csv;
/* what else is done with each comparison, or NULL */
static void (*trial_seen)(const trial *c, double unit, double ratio);
static int trial_verbose;

static trial_tally *trial_row(const char *name) {
    int i;
    for (i = 0; i < trial_n_rows; i++)
        if (strcmp(trial_rows[i].name, name) == 0) return trial_rows + i;
    if (trial_n_rows == TRIAL_ROWS) truth_stop("the table is full");
    snprintf(trial_rows[trial_n_rows].name, sizeof trial_rows->name, "%s", name);
    return trial_rows + trial_n_rows++;
}

static void trial_keep_ratio(float **list, int64_t *n, int64_t *most, double value) {
    if (*n == *most) {
        *most = *most ? 2 * *most : 256;
        *list = (float *)realloc(*list, (size_t)*most * sizeof **list);
        if (!*list) truth_stop("out of memory");
    }
    (*list)[(*n)++] = (float)value;
}

/* A shape with its truths, and room for answers. */
typedef struct trial_subject {
    hd_laplacian *lap;
    truth_pairs exact, stored;         /* by the library's definition; by what is stored, when that differs */
    int has_stored;
    double unit;
    truth_filter f;
} trial_subject;

/* One case under way. */
typedef struct trial_work {
    trial_subject *s;
    const trial *c;
    const truth_pairs *T;
    int stored;                  /* told only */
    int refused;
    hd_report rep;
    hd_rational set;
    const hd_rational *own;      /* what the truth is a filter of; NULL: exp */
    const char *text;
    trial_tally *row;
    quad *want, *gw;
    double *off, *gw_off;
    int32_t columns;
} trial_work;

/* e'Be of a difference on vertices */
static quad trial_norm_b(const hd_laplacian *lap, const quad *e) {
    quad sum = 0;
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        quad b = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double m = truth_mass(lap, i, p);
            if (m != 0) b += (quad)m * e[lap->vertex[lap->L.col[p]]];
        }
        sum += b * e[lap->vertex[i]];
    }
    return sum > 0 ? q_sqrt(sum) : 0;
}

/* The norm of B^-1 of x, by the eigenvectors: X X' = B^-1. sizes: all entries of both taken positive. */
static quad trial_norm_dual(const truth_pairs *T, const hd_laplacian *lap, const quad *x, int sizes) {
    quad sum = 0;
    int32_t i, l;
    for (l = 0; l < T->n; l++) {
        quad d = 0;
        for (i = 0; i < T->n; i++) d += sizes ? (quad)T->xd[i * T->n + l] * q_fabs(x[lap->vertex[i]]) : T->x[i * T->n + l] * x[lap->vertex[i]];
        sum += d * d;
    }
    return sum > 0 ? q_sqrt(sum) : 0;
}

static quad trial_ratio(quad error, quad bound) { return error == 0 ? 0 : bound > 0 ? error / bound : (quad)1e30; }

/* n values against the truth and its own error. has_b, relative: which bounds there are beside error_bound.
 * has_b 2: the norm is that of B^-1. skip: a place to leave out (-1: none). */
static void trial_compare(trial_work *w, const double *value, int64_t n, int has_b, int relative, int64_t skip) {
    const quad vertex = (quad)(w->rep.error_bound * trial_shrink), b = (quad)(w->rep.error_bound_b * trial_shrink),
               rel = (quad)(w->rep.error_relative * trial_shrink);
    const int finite = w->rep.error_bound <= DBL_MAX, finite_b = w->rep.error_bound_b <= DBL_MAX,
              finite_rel = w->rep.error_relative <= DBL_MAX;
    quad largest = 0, worst = 0, worst_plain = 0, worst_rel = 0, own = 0, ratio, ratio_b = 0,
         ratio_rel = 0;
    int bad = isnan(w->rep.error_bound) || isnan(w->rep.error_bound_b) || isnan(w->rep.error_relative), below,
        below_b = 0, below_rel = 0, useless;
    trial_tally *r = w->row;
    int64_t i;
    for (i = 0; i < n; i++) {
        if (i == skip) continue;
        if (q_fabs(w->want[i]) > (quad)1e307) return;  /* beyond doubles: nothing to compare */
        if (!(fabs(value[i]) <= DBL_MAX)) bad = 1;
        else if (fabs(value[i]) > (double)largest) largest = (quad)fabs(value[i]);
    }
    for (i = 0; i < n && !bad; i++) {
        const quad e = i == skip ? 0 : q_fabs(value[i] - w->want[i]), sure = e - (quad)w->off[i] - (quad)1e-322;
        if (e > worst_plain) worst_plain = e;
        if (sure > worst) worst = sure;
        if ((quad)w->off[i] > own) own = w->off[i];
        if (relative && i != skip && finite_rel) {
            if (sure > rel * (quad)fabs(value[i]) * (1 + (quad)1e-12)) below_rel = 1;
            if (sure > 0 && trial_ratio(sure, rel * (quad)fabs(value[i])) > worst_rel)
                worst_rel = trial_ratio(sure, rel * (quad)fabs(value[i]));
        }
    }
    below = !bad && finite && worst > vertex * largest * (1 + (quad)1e-12);
    ratio = !finite || worst <= 0 ? 0 : trial_ratio(worst, vertex * largest);
    ratio_rel = finite_rel ? worst_rel : 0;
    if (has_b && !bad) {
        const hd_laplacian *lap = w->s->lap;
        quad *e = TRUTH_NEW(quad, 2 * lap->n), *u = e + lap->n, error, off, size;
        for (i = 0; i < n; i++) u[i] = value[i];
        size = has_b == 2 ? trial_norm_dual(w->T, lap, u, 0) : trial_norm_b(lap, u);
        for (i = 0; i < n; i++) e[i] = value[i] - w->want[i];
        error = has_b == 2 ? trial_norm_dual(w->T, lap, e, 0) : trial_norm_b(lap, e);
        for (i = 0; i < n; i++) e[i] = (quad)w->off[i] + (quad)1e-322;
        /* entries of B are not all positive, but dominated by the diagonal */
        /* (a value of the transpose is divided by B and multiplied by it, which error_bound_b does not count) */
        off = has_b == 2 ? trial_norm_dual(w->T, lap, e, 1) + (quad)(2 * DBL_EPSILON) * size : 2 * trial_norm_b(lap, e);
        off += (quad)1e-32 * size;               /* the truth has 113 bits: bounds of 1e-289 say less about it */
        below_b = finite_b && error - off > b * size * (1 + (quad)1e-12);
        ratio_b = finite_b && error > off ? trial_ratio(error - off, b * size) : 0;
        free(e);
    }
    useless = w->rep.status == HD_OK &&
              (!(w->rep.error_bound <= 0.01) || (has_b && !(w->rep.error_bound_b <= 0.01)));
    if (w->stored) {
        r->stored++;
        r->stored_below += bad || below;
        if (trial_verbose)
            printf("  against L as stored: true %.3e\n", largest > 0 ? (double)(worst_plain / largest) : 0);
        return;
    }
    trial_unsure += !bad && finite && own > (quad)0.01 * vertex * largest;
    r->compared++;
    trial_counts[w->c->query].compared++;
    if (!(w->rep.error_bound <= trial_largest)) trial_largest = w->rep.error_bound;
    trial_counts[w->c->query].unbounded += !finite || (has_b && !finite_b);
    r->warned += w->rep.status > 0;
    r->below += below;
    r->below_b += below_b;
    r->below_relative += below_rel;
    r->useless += useless;
    r->bad += bad;
    trial_keep_ratio(&r->ratio, &r->n_ratio, &r->most, (double)ratio);
    if (has_b) trial_keep_ratio(&r->ratio_b, &r->n_ratio_b, &r->most_b, (double)ratio_b);
    if (ratio < ratio_b) ratio = ratio_b;
    if (ratio < ratio_rel) ratio = ratio_rel;
    if (bad) ratio = (quad)2e30;
    if (trial_seen) trial_seen(w->c, w->s->unit, (double)ratio);
    if ((double)ratio > r->worst) {
        r->worst = (double)ratio;
        snprintf(r->worst_case, sizeof r->worst_case, "%s", w->text);
    }
    if (trial_csv)
        fprintf(trial_csv, "\"%s\",\"%s\",%d,%s,%.4g,%.4g,%.4g,%.4g,%.4g,%d,%d,%d,%d,%d\n", r->name, w->text,
                (int)w->columns, hd_status_name(w->rep.status),
                largest > 0 ? (double)(worst_plain / largest) : 0, w->rep.error_bound,
                (double)ratio_b * w->rep.error_bound_b, w->rep.error_bound_b, w->rep.error_relative, below,
                below_b, below_rel, useless, bad);
    if (trial_verbose)
        printf("  %s column %d: %s true %.3e bound %.3e%s; B norm %.3e bound %.3e%s; relative bound %.3e "
               "(ratio %.3g)%s%s%s\n",
               r->name, (int)w->columns, hd_status_name(w->rep.status),
               largest > 0 ? (double)(worst_plain / largest) : 0, w->rep.error_bound, below ? " BELOW" : "",
               (double)ratio_b * w->rep.error_bound_b, w->rep.error_bound_b, below_b ? " BELOW" : "",
               w->rep.error_relative, (double)ratio_rel, below_rel ? " BELOW" : "", useless ? " USELESS" : "",
               bad ? " NOT FINITE" : "");
    w->columns++;
}

/* ---- answers, by the truth ---- */

/* Every row from the weights w->gw = g times what stands right of it, into want and off; `identity`: the
 * value of inert vertex v is value[v]. */
static void trial_want_rows(trial_work *w, int left_y, double beyond, const double *inert) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = w->T;
    int32_t v;
    for (v = 0; v < lap->n; v++) {
        const int32_t r = lap->row[v];
        w->want[v] = inert && r != HD_ROW_HELD ? inert[v] : 0;
        w->off[v] = 0;
        if (r < 0) continue;
        w->want[v] = truth_sum(T, &w->s->f, T->comp[r], (left_y ? T->y : T->x) + r * T->n,
                               (left_y ? T->yd : T->xd) + r * T->n, w->gw, w->gw_off,
                               beyond * (left_y ? T->y_most : T->x_most), w->off + v);
    }
}

/* gw = g z for a vector z over the modes. */
static void trial_weigh(trial_work *w, const quad *z, const double *z_off) {
    const truth_pairs *T = w->T;
    const truth_filter *f = &w->s->f;
    int32_t c, l;
    for (l = 0; l < T->n; l++) w->gw[l] = w->gw_off[l] = 0;
    for (c = 0; c < T->n_comp; c++)
        for (l = T->first[c]; l < f->last[c]; l++) {
            w->gw[l] = f->g[l] * z[l];
            w->gw_off[l] = f->off[l] * (double)q_fabs(z[l]) + (z_off ? (double)q_fabs(f->g[l]) * z_off[l] : 0);
        }
}

/* Only the modes of one row's component are not zero in its row of x or y. */
static void trial_want_column(trial_work *w, int32_t source, int symmetric, double *inert) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = w->T;
    const int32_t r = lap->row[source];
    int32_t v;
    for (v = 0; v < lap->n; v++) inert[v] = !symmetric && v == source && r == HD_ROW_INERT;
    if (r >= 0) {
        trial_weigh(w, (symmetric ? T->x : T->y) + r * T->n, NULL);
    } else {
        memset(w->gw, 0, (size_t)T->n * sizeof *w->gw);
        memset(w->gw_off, 0, (size_t)T->n * sizeof *w->gw_off);
    }
    trial_want_rows(w, 0, r < 0 ? 0 : T->n * (symmetric ? T->x_most : T->y_most), inert);
    for (v = 0; v < lap->n && r >= 0; v++)       /* between components nothing at all */
        if (lap->row[v] >= 0 && T->comp[lap->row[v]] != T->comp[r]) w->want[v] = w->off[v] = 0;
}

/* dual: of the transpose, Y g X' f instead of X g Y' f. */
static void trial_want_field(trial_work *w, const double *f, const double *inert, int dual) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = w->T;
    quad *z = TRUTH_NEW(quad, T->n);
    double *off = TRUTH_NEW(double, T->n), beyond = 0;
    int32_t r, l;
    for (r = 0; r < T->n; r++) {
        const quad *y = (dual ? T->x : T->y) + r * T->n;
        const double *yd = (dual ? T->xd : T->yd) + r * T->n, x = f[lap->vertex[r]];
        if (x == 0) continue;
        for (l = T->first[T->comp[r]]; l < T->first[T->comp[r] + 1]; l++) {
            z[l] += y[l] * x;
            off[l] += (TRUTH_EPS / 4) * yd[l] * fabs(x);
        }
        beyond += (dual ? T->x_most : T->y_most) * fabs(x);
    }
    trial_weigh(w, z, off);
    trial_want_rows(w, dual, T->n * beyond, inert);
    free(z);
    free(off);
}

/* One entry of left g right', 1 on the diagonal of inert vertices if asked. */
static quad trial_want_entry(trial_work *w, int32_t i, int32_t j, int left_y, int right_y, int inert_one, double *off) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = w->T;
    const truth_filter *f = &w->s->f;
    const int32_t a = lap->row[i], b = lap->row[j];
    quad sum = 0;
    int32_t l;
    *off = 0;
    if (a < 0 || b < 0) return inert_one && i == j && a == HD_ROW_INERT;
    if (T->comp[a] != T->comp[b]) return 0;
    *off = f->cut * T->n * (left_y ? T->y_most : T->x_most) * (right_y ? T->y_most : T->x_most);
    for (l = T->first[T->comp[a]]; l < f->last[T->comp[a]]; l++) {
        const quad z = (left_y ? T->y : T->x)[a * T->n + l] * (right_y ? T->y : T->x)[b * T->n + l];
        sum += f->g[l] * z;
        *off += f->off[l] * (double)q_fabs(z);
    }
    return sum;
}

/* The distance of two vertices: the root of the sum of g (z_i - z_j)^2. */
static quad trial_want_distance(trial_work *w, int32_t i, int32_t j, int weighted, double *off) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = w->T;
    const truth_filter *f = &w->s->f;
    const int32_t row[2] = {lap->row[i], lap->row[j]};
    const quad *z = weighted ? T->y : T->x;
    const int same = row[0] >= 0 && row[1] >= 0 && T->comp[row[0]] == T->comp[row[1]];
    quad sum = 0, root;
    double err = f->cut * T->n * (weighted ? T->y_most : T->x_most) * (weighted ? T->y_most : T->x_most);
    int32_t l, k;
    *off = 0;
    if (i == j) return 0;
    for (k = 0; k < 2; k++) {
        if (row[k] < 0 || (same && k > 0)) continue;
        for (l = T->first[T->comp[row[k]]]; l < f->last[T->comp[row[k]]]; l++) {
            const quad d = z[row[k] * T->n + l] - (same ? z[row[1] * T->n + l] : 0);
            sum += f->g[l] * d * d;
            err += f->off[l] * (double)(d * d) +
                   (double)q_fabs(f->g[l] * d) * (TRUTH_EPS / 16) *
                       (double)(q_fabs(z[row[0] >= 0 ? row[0] * T->n + l : row[1] * T->n + l]) + q_fabs(d));
        }
    }
    if (sum < 0) sum = 0;
    root = q_sqrt(sum);
    *off = root > 0 ? (double)q_fmin(err / root, q_sqrt(err)) : sqrt(err);
    return root;
}

/* ---- calls ---- */

static void trial_row_name(trial_work *w, const char *query) {
    char name[48];
    const trial *c = w->c;
    const char *method = c->method == HD_METHOD_ITERATIVE
                             ? (c->solver ? trial_solvers[c->solver] : "iterative")
                             : trial_methods[c->method];
    snprintf(name, sizeof name, "%-18s %s", query, method);
    w->row = trial_row(name);
}

static int trial_failed(trial_work *w) {
    if (w->rep.status >= 0) return 0;
    if (!w->stored) {
        w->row->errors++;
        w->refused = 1;
    }
    if (trial_verbose) printf("  %s: %s: %s\n", w->row->name, hd_status_name(w->rep.status), w->rep.error.text);
    return 1;
}

static void trial_filter_for(trial_work *w, double t, int squared) {
    if (w->c->own == OWN_FITTED) truth_filter_fill(&w->s->f, w->T, FORM_FILTER, 0, NULL, 0);
    else truth_filter_fill(&w->s->f, w->T, FORM_HEAT, t, w->own, squared);
}

/* What distances of this kind are made of; t: of the kernel. */
static void trial_distance_for(trial_work *w, int kind, double t, int squared) {
    if (!trial_timeless(kind)) trial_filter_for(w, t, squared);
    else truth_filter_fill(&w->s->f, w->T, kind == HD_DISTANCE_COMMUTE ? FORM_COMMUTE : FORM_BIHARMONIC, 0, NULL, 0);
}

/* A field on the vertices. */
static void trial_make_field(const trial_work *w, int what, uint64_t *seed, double *f) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = &w->s->exact;
    const double small = what == FIELD_TINY    ? (trial_chance(seed, 0.5) ? 1e-170 : 1e-300)
                         : what == FIELD_LEVEL ? (trial_chance(seed, 0.8) ? 1 : 1e300)
                         : trial_chance(seed, 0.5)   ? 1e160
                                               : 1e200;
    double coefficient[6];
    int32_t v, r, l, c;
    const int32_t one = trial_below(seed, lap->n),
                  mode = what == FIELD_MODE && w->c->seed < T->n ? (int32_t)w->c->seed : trial_below(seed, T->n);
    const double ripple = ldexp(1, -10 - (int)(w->c->seed % 43));   /* of a level field: down to an ulp */
    for (l = 0; l < 6; l++) coefficient[l] = shape_signed(seed);
    for (v = 0; v < lap->n; v++) {
        const double u = shape_signed(seed);
        r = lap->row[v];
        f[v] = u;
        if (what == FIELD_HUGE || what == FIELD_TINY) f[v] = small * u;
        else if (what == FIELD_NEARLY) f[v] = 1 + 1e-6 * u;
        else if (what == FIELD_DELTA) f[v] = v == one;
        else if (what == FIELD_ALTERNATE) f[v] = 1 + (v % 2 ? -1e5 : 1e5);
        else if (what == FIELD_CONSTANT) f[v] = 3;
        else if (what == FIELD_STEP) f[v] = v < lap->n / 2 ? 1 : -1;
        else if (what == FIELD_LINEAR) f[v] = v + 1;
        else if (what == FIELD_ZERO) f[v] = 0;
        else if (what == FIELD_LEVEL) f[v] = small * (1 + ripple * u);
        else if (what == FIELD_MODE) f[v] = r < 0 ? 0 : (double)T->x[r * T->n + mode];
        else if (what == FIELD_SMOOTH) {
            f[v] = 0;
            for (l = 0; r >= 0 && l < 6; l++) {
                c = T->comp[r];
                if (T->first[c] + l < T->first[c + 1])
                    f[v] += coefficient[l] * (double)T->x[r * T->n + T->first[c] + l];
            }
        }
        if (what == FIELD_MODE || what == FIELD_SMOOTH) f[v] = isfinite(f[v]) ? f[v] : 0;
    }
}

static void trial_run_columns(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n, k = c->k < 1 ? 1 : c->k > 64 ? 64 : c->k;
    const int symmetric = c->query == QUERY_COLUMN && c->kernel == HD_KERNEL_SYMMETRIC;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *F = TRUTH_NEW(double, n * k), *U = TRUTH_NEW(double, n * k), *inert = TRUTH_NEW(double, n);
    int32_t source[64], q;
    if (c->query == QUERY_APPLY) {
        for (q = 0; q < k; q++) trial_make_field(w, q == 0 ? c->field : trial_below(&seed, FIELD_HUGE), &seed, F + q * n);
        trial_row_name(w, "apply");
        hd_heat_apply(heat, 1, &c->t, k, F, 0, U, 0, &w->rep, NULL);
    } else {
        for (q = 0; q < k; q++) source[q] = trial_below(&seed, n);
        trial_row_name(w, symmetric ? "columns of k_t" : "columns of K_t");
        hd_heat_columns(heat, (hd_kernel)c->kernel, 1, &c->t, VERTICES(k, source), U, 0, &w->rep, NULL);
    }
    if (!trial_failed(w)) {
        trial_filter_for(w, c->t, 0);
        for (q = 0; q < k; q++) {
            if (c->query == QUERY_APPLY) trial_want_field(w, F + q * n, F + q * n, 0);
            else trial_want_column(w, source[q], symmetric, inert);
            trial_compare(w, U + q * n, n, 1, 0, -1);
        }
    }
    free(F);
    free(U);
    free(inert);
}

static double *trial_times(const trial *c) {
    const int m = c->n_times;
    double *t = TRUTH_NEW(double, m);
    int q;
    for (q = 0; q < m; q++)
        t[q] = m == 1       ? c->t
               : q == 0     ? c->t
               : q == m - 1 ? c->t * c->span
                            : c->t * pow(c->span, (double)q / (m - 1));
    return t;
}

/* The derivative in t and the transpose, of fields. */
static void trial_run_training(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n, k = c->k < 1 ? 1 : c->k > 64 ? 64 : c->k, m = c->n_times;
    const int dual = c->query == QUERY_ADJOINT;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *f = TRUTH_NEW(double, n * k), *u = TRUTH_NEW(double, n * k * m), *t = trial_times(c);
    int32_t q;
    for (q = 0; q < k; q++) trial_make_field(w, q == 0 ? c->field : trial_below(&seed, FIELD_HUGE), &seed, f + q * n);
    trial_row_name(w, dual ? "adjoint" : "derivative");
    if (dual) hd_heat_adjoint(heat, m, t, k, f, 0, u, 0, &w->rep, NULL);
    else hd_heat_derivative(heat, m, t, k, f, 0, u, 0, &w->rep, NULL);
    for (q = 0; q < k * m && !trial_failed(w); q++) {
        truth_filter_fill(&w->s->f, w->T, dual ? FORM_HEAT : FORM_DERIVATIVE, t[q % m], w->own, 0);
        trial_want_field(w, f + q / m * n, dual ? f + q / m * n : NULL, dual);
        trial_compare(w, u + q * n, n, dual ? 2 : 1, 0, -1);
    }
    free(f);
    free(u);
    free(t);
}

/* Up to eight sources. */
typedef struct trial_points { int64_t first[9]; int32_t vertex[96]; double bary[96], weight[32]; } trial_points;

/* One to four points between `corners` vertices, with weights, or a curve through them with the lengths of its pieces: c as a field.
 * All in one component, or anywhere. Between vertices all numbers are sixteenths, so that c is exact. Returns how many. */
static int32_t trial_source(const trial_work *w, uint64_t *seed, int32_t *vertex, double *bary, double *weight, double *c) {
    const hd_laplacian *lap = w->s->lap;
    const int32_t first = trial_below(seed, lap->n_active), corners = w->c->corners;
    const int curve = w->c->curve;
    int32_t i, count = 1 + trial_below(seed, 4);
    if (curve && count < 2) count = 2;
    for (i = 0; i < corners * count; i++) {
        const int32_t point = i / corners, corner = i % corners;
        int32_t row = trial_below(seed, lap->n_active);
        if (!w->c->apart && lap->component[row] != lap->component[first]) row = first;
        vertex[i] = lap->vertex[row];
        if (corners == 1) weight[point] = 0.1 + shape_uniform(seed);
        else if (corner == 0) weight[point] = (1 + trial_below(seed, 16)) / 16.0;
        bary[i] = corners == 1 ? 1 : corner == 2 ? 1 - bary[i - 1] - bary[i - 2] : trial_below(seed, 9) / 16.0;
        if (corners == 2 && corner == 1) bary[i] = 1 - bary[i - 1];
    }
    for (i = 0; i < corners * count; i++) {
        const int32_t point = i / corners;
        const double before = point > 0 ? weight[point - 1] : 0, after = point + 1 < count ? weight[point] : 0;
        c[vertex[i]] += bary[i] * (curve ? (before + after) / 2 : weight[point]);
    }
    return count;
}

/* k sources, and as fields [k][n]. */
static hd_sources trial_sources(const trial_work *w, uint64_t *seed, int32_t k, trial_points *p, double *field) {
    const int32_t corners = w->c->corners;
    hd_sources s = hd_vertices(k, p->vertex);
    int32_t q;
    for (p->first[0] = 0, q = 0; q < k; q++) {
        const int64_t at = p->first[q];
        p->first[q + 1] = at + trial_source(w, seed, p->vertex + corners * at, p->bary + corners * at, p->weight + at,
                                            field + (size_t)q * (size_t)w->s->lap->n);
    }
    s.first = p->first;
    s.corners = corners;
    s.bary = corners > 1 ? p->bary : NULL;
    s.curve = w->c->curve;
    if (s.curve) s.length = p->weight;
    else s.weight = p->weight;
    return s;
}

/* x g x' c: as the transpose, and x on the left. */
static void trial_want_symmetric(trial_work *w, const double *field) {
    const truth_pairs *T = w->T;
    quad *z = TRUTH_NEW(quad, T->n);
    double *off = TRUTH_NEW(double, T->n), beyond = 0;
    int32_t r, l;
    for (r = 0; r < T->n; r++) {
        const double f = field[w->s->lap->vertex[r]];
        for (l = T->first[T->comp[r]]; f != 0 && l < T->first[T->comp[r] + 1]; l++) {
            z[l] += T->x[r * T->n + l] * f;
            off[l] += (TRUTH_EPS / 4) * T->xd[r * T->n + l] * fabs(f);
        }
        beyond += T->x_most * fabs(f);
    }
    trial_weigh(w, z, off);
    trial_want_rows(w, 0, T->n * beyond, NULL);
    free(z);
    free(off);
}

/* Columns of several vertices at once, k sources at some times, and columns of filters. */
static void trial_run_from(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n, k = c->k < 1 ? 1 : c->k > 8 ? 8 : c->k;
    const int symmetric = c->kernel == HD_KERNEL_SYMMETRIC, by_filter = c->query == QUERY_FILTER;
    const int32_t m = by_filter ? 1 : c->n_times;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *u = TRUTH_NEW(double, n * k * m), *field = TRUTH_NEW(double, n * k), *t = trial_times(c);
    trial_points at;
    hd_sources s;
    int32_t q;
    if (by_filter) t[0] = w->set.t;
    s = trial_sources(w, &seed, k, &at, field);
    trial_row_name(w, by_filter ? symmetric ? "filter, k_t" : "filter, K_t" : symmetric ? "k_t from" : "K_t from");
    hd_heat_columns(heat, (hd_kernel)c->kernel, m, t, &s, u, 0, &w->rep, NULL);
    for (q = 0; q < k * m && !trial_failed(w); q++) {
        if (by_filter) truth_filter_fill(&w->s->f, w->T, FORM_FILTER, c->t, NULL, 0);
        else trial_filter_for(w, t[q % m], 0);
        if (symmetric) trial_want_symmetric(w, field + q / m * n);
        else trial_want_field(w, field + q / m * n, field + q / m * n, 0);
        trial_compare(w, u + q * n, n, 1, 0, -1);
    }
    free(u);
    free(field);
    free(t);
}

static void trial_run_times(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n, m = c->n_times;
    const int by_column = c->kind > 0, symmetric = by_column && c->kernel == HD_KERNEL_SYMMETRIC;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *f = TRUTH_NEW(double, n), *U = TRUTH_NEW(double, n * m), *inert = TRUTH_NEW(double, n), *t = trial_times(c);
    const int32_t source = trial_below(&seed, n);
    int32_t q;
    trial_make_field(w, c->field, &seed, f);
    for (q = 0; q < m && c->seed % 2; q++) {     /* in another order */
        const int32_t other = trial_below(&seed, m);
        const double keep = t[q];
        t[q] = t[other];
        t[other] = keep;
    }
    trial_row_name(w, by_column ? "times, column" : "times, field");
    if (by_column) hd_heat_columns(heat, (hd_kernel)c->kernel, m, t, VERTICES(1, &source), U, 0, &w->rep, NULL);
    else hd_heat_apply(heat, m, t, 1, f, 0, U, 0, &w->rep, NULL);
    for (q = 0; q < m && !trial_failed(w); q++) {
        trial_filter_for(w, t[q], 0);
        if (by_column) trial_want_column(w, source, symmetric, inert);
        else trial_want_field(w, f, f, 0);
        trial_compare(w, U + q * n, n, 1, 0, -1);
    }
    free(f);
    free(U);
    free(inert);
    free(t);
}

static void trial_run_entries(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n, k = c->k < 1 ? 1 : c->k > 64 ? 64 : c->k;
    const int symmetric = c->query == QUERY_ENTRIES && c->kernel == HD_KERNEL_SYMMETRIC,
              weighted = c->kind == HD_DISTANCE_WEIGHTED;
    uint64_t seed = (uint64_t)c->seed + 1;
    double K[64], d[64];
    int32_t i[64], j[64], q, m = 0;
    const int few = trial_chance(&seed, 0.5);
    for (q = 0; q < k; q++) {
        i[q] = trial_below(&seed, n);
        j[q] = few && q > 0 ? j[0] : trial_below(&seed, n);
    }
    memset(K, 0, sizeof K);
    memset(d, 0, sizeof d);
    if (c->query == QUERY_ENTRIES) {
        trial_row_name(w, symmetric ? "entries of k_t" : "entries of K_t");
        hd_heat_entries(heat, (hd_kernel)c->kernel, 1, &c->t, k, i, j, K, &w->rep, NULL);
    } else {
        trial_row_name(w, trial_timeless(c->kind) ? "pairs, no time" : "pairs, d");
        hd_heat_distance_pairs(heat, (hd_distance_kind)c->kind, 1, &c->t, k, i, j, d, &w->rep, NULL);
    }
    if (trial_failed(w)) return;
    if (c->query == QUERY_PAIRS) {
        /* distances first; with a filter they are those of columns at t */
        trial_distance_for(w, c->kind, c->t, 1);
        for (q = 0; q < k; q++) {
            const int32_t a = w->s->lap->row[i[q]], b = w->s->lap->row[j[q]];
            if (i[q] == j[q] ||
                (trial_timeless(c->kind) && (a < 0 || b < 0 || w->T->comp[a] != w->T->comp[b])))
                continue;
            w->want[m] = trial_want_distance(w, i[q], j[q], weighted, w->off + m);
            d[m++] = d[q];
        }
        if (m > 0) trial_compare(w, d, m, 0, 1, -1);
        return;
    }
    trial_filter_for(w, c->t, 0);
    for (q = 0; q < k; q++) w->want[q] = trial_want_entry(w, i[q], j[q], 0, !symmetric, !symmetric, w->off + q);
    trial_compare(w, K, k, 0, 0, -1);
}

static void trial_run_diagonal(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int symmetric = c->kernel == HD_KERNEL_SYMMETRIC;
    double *D = TRUTH_NEW(double, lap->n * c->n_times), *t = trial_times(c);
    int32_t q, v;
    trial_row_name(w, symmetric        ? c->n_times > 1 ? "diagonal k_t, many" : "diagonal of k_t"
                : c->n_times > 1 ? "diagonal K_t, many"
                                 : "diagonal of K_t");
    hd_heat_diagonal(heat, (hd_kernel)c->kernel, c->n_times, t, D, 0, NULL, NULL, &w->rep, NULL);
    for (q = 0; q < c->n_times && !trial_failed(w); q++) {
        trial_filter_for(w, t[q], 0);
        for (v = 0; v < lap->n; v++) w->want[v] = trial_want_entry(w, v, v, 0, !symmetric, !symmetric, w->off + v);
        trial_compare(w, D + q * lap->n, lap->n, 0, 1, -1);
    }
    free(D);
    free(t);
}

static void trial_run_distance(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n,
                  k = c->k < 1   ? 1
                      : c->k > 8 ? 8
                                 : c->k,
                  m = trial_timeless(c->kind) ? 1 : c->n_times;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *D = TRUTH_NEW(double, n * k * m), *t = trial_times(c);
    char name[32];
    int32_t source[8], q, r, v;
    for (r = 0; r < k; r++) source[r] = trial_below(&seed, n);
    snprintf(name, sizeof name, "distance, %s%s",
             c->kind < 2    ? trial_kinds[c->kind]
             : c->kind == 2 ? "comm."
                            : "biharm.",
             m > 1 ? ", many" : "");
    name[18] = 0;
    trial_row_name(w, name);
    hd_heat_distance(heat, (hd_distance_kind)c->kind, m, t, VERTICES(k, source), D, 0, &w->rep, NULL);
    for (r = 0; r < k && !trial_failed(w); r++)
        for (q = 0; q < m; q++) {
            double *d = D + (r * m + q) * n;
            int32_t count = 0, skip = -1;
            trial_distance_for(w, c->kind, 2 * t[q], 0);
            for (v = 0; v < n; v++) {
                const int32_t a = lap->row[v], b = lap->row[source[r]];
                if (trial_timeless(c->kind) && (a < 0 || b < 0 || w->T->comp[a] != w->T->comp[b]))
                    continue;
                if (v == source[r]) skip = count;
                w->want[count] =
                    trial_want_distance(w, source[r], v, c->kind == HD_DISTANCE_WEIGHTED, w->off + count);
                d[count++] = d[v];
            }
            if (count > 1 || skip < 0) trial_compare(w, d, count, 0, 1, skip);
        }
    free(D);
    free(t);
}

/* The distance of a source of several vertices, c of sum 1, to v: the root of sum g (z_v - sum c_q z_q)^2. */
static quad trial_want_distance_from(trial_work *w, const quad *c, int32_t v, int weighted, double *off) {
    const hd_laplacian *lap = w->s->lap;
    const truth_pairs *T = w->T;
    const truth_filter *f = &w->s->f;
    const quad *z = weighted ? T->y : T->x;
    const double most = weighted ? T->y_most : T->x_most;
    quad sum = 0, root;
    double err = 4 * f->cut * T->n * most * most;
    int32_t part, l, r;
    for (part = 0; part < T->n_comp; part++)
        for (l = T->first[part]; l < f->last[part]; l++) {
            quad d = 0, size = 0;
            for (r = 0; r < T->n; r++) {
                const int there = lap->vertex[r] == v;
                const quad x = T->comp[r] == part ? z[r * T->n + l] * (there - c[lap->vertex[r]]) : 0;
                d += x;
                size += q_fabs(x);
            }
            sum += f->g[l] * d * d;
            err += f->off[l] * (double)(d * d) + (double)q_fabs(f->g[l] * d) * TRUTH_EPS * (double)size;
        }
    root = sum > 0 ? q_sqrt(sum) : 0;
    *off = root > 0 ? (double)q_fmin(err / root, q_sqrt(err)) : sqrt(err);
    return root;
}

static void trial_run_distance_from(trial_work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int timeless = trial_timeless(c->kind);
    const int32_t n = lap->n, k = c->k < 1 ? 1 : c->k > 8 ? 8 : c->k, m = timeless ? 1 : c->n_times;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *D = TRUTH_NEW(double, n * k * m), *field = TRUTH_NEW(double, n * k), *t = trial_times(c);
    quad *share = TRUTH_NEW(quad, n);
    int32_t v, q;
    trial_points at;
    hd_sources s;
    char name[32];
    s = trial_sources(w, &seed, k, &at, field);
    snprintf(name, sizeof name, "from, %s", trial_kinds[c->kind]);
    trial_row_name(w, name);
    hd_heat_distance(heat, (hd_distance_kind)c->kind, m, t, &s, D, 0, &w->rep, NULL);
    for (q = 0; q < k * m && !trial_failed(w); q++) {
        const double *f = field + q / m * n;
        double *d = D + q * n;
        quad sum = 0;
        int32_t count = 0;
        trial_distance_for(w, c->kind, 2 * t[q % m], 0);
        for (v = 0; v < n; v++) sum += f[v];
        for (v = 0; v < n; v++) share[v] = f[v] / sum;
        for (v = 0; v < n; v++) {
            const int32_t r = lap->row[v];
            if (share[v] == 1) continue;         /* the source is this vertex */
            if (timeless && (r < 0 || w->T->comp[r] != w->T->comp[lap->row[at.vertex[c->corners * at.first[q / m]]]])) continue;
            w->want[count] = trial_want_distance_from(w, share, v, c->kind == HD_DISTANCE_WEIGHTED, w->off + count);
            d[count++] = d[v];
        }
        if (count > 0) trial_compare(w, d, count, 0, 1, -1);
    }
    free(share);
    free(field);
    free(D);
    free(t);
}

/* A filter of the spectrum near 1/t, fitted; 0: there is none. The last sets are kept: cases in a row often have the same. */
static int trial_make_filter(trial_work *w) {
    enum { KEPT = 16 };
    static struct { hd_filter f; hd_rational set; } kept[KEPT];
    static int oldest;
    const trial *c = w->c;
    const double lambda_max = w->s->lap->lambda_max;
    hd_filter *f = &w->s->f.of;
    int q;
    memset(f, 0, sizeof *f);
    if (!(c->t > 1e-100 && c->t < 1e100 && lambda_max > 0 && lambda_max < 1e100)) return 0;
    f->a = c->t;
    f->b = 0.5;
    switch (c->own == OWN_FITTED ? c->seed % 8 : c->seed % 5) {
    case 0: f->kind = HD_FILTER_WAVE; f->a = -log(c->t); f->b = 0.7; break;
    case 1: f->kind = HD_FILTER_MEXICAN_HAT; break;
    case 2: f->kind = HD_FILTER_RESOLVENT; break;
    case 3:
        f->kind = HD_FILTER_FRACTIONAL;
        if (c->own == OWN_FITTED) f->lambda_min = 0.9 * w->s->exact.edge;
        break;
    case 5: f->kind = HD_FILTER_BIHARMONIC; f->a = 1 / c->t; break;
    case 6: f->kind = HD_FILTER_HEAT; break;
    case 7: f->kind = HD_FILTER_WAVE; f->a = -log(c->t); f->b = 0.3; break;
    default: f->kind = HD_FILTER_BAND; f->a = 1 / c->t; f->b = 4 / c->t;
    }
    for (q = 0; q < KEPT && (memcmp(&kept[q].f, f, sizeof *f) != 0 || kept[q].set.lambda_max < lambda_max || kept[q].set.lambda_max > lambda_max); q++) {}
    if (q == KEPT) {
        q = oldest;
        oldest = (oldest + 1) % KEPT;
        memset(&kept[q].f, 0, sizeof *f);
        if (hd_rational_fit(&kept[q].set, 1, f, lambda_max, &trial_serial, NULL) < 0) return 0;
        kept[q].f = *f;
    }
    w->set = kept[q].set;
    return 1;
}

/* Sets by number, real poles and pairs in all the ways in which four of them fill a pack or leave one over: how many, which of them are real, and
 * the constant. No two poles are the same, and none is near the negative axis. */
enum { TRIAL_PACKS = 12 };

static void trial_packs(hd_rational *s, int which) {
    static const struct { int32_t n; uint32_t real; double a0; } sets[TRIAL_PACKS] = {
        {1, 1, 0}, {3, 7, 0.5}, {5, 31, -0.2}, {5, 1, 0.25}, {9, 1, 0}, {5, 1u << 4, 0.1}, {4, 1, 0}, {9, 0, 1}, {5, 3, 0}, {0, 0, 0.75},
        {32, 0x00010101u, 0.3}, {29, 1, 0}};
    uint64_t seed = (uint64_t)which + 3;
    int32_t p;
    s->n_poles = sets[which].n;
    s->a0 = sets[which].a0;
    for (p = 0; p < s->n_poles; p++) {
        const int real = (int)(sets[which].real >> p & 1);
        s->theta[p].re = real ? 0.5 + 3.5 * shape_uniform(&seed) + 0.3 * p : 6 * shape_signed(&seed);
        s->theta[p].im = real ? 0 : 1 + 8 * shape_uniform(&seed);
        s->a[p].re = 3 * shape_signed(&seed);
        s->a[p].im = real ? 0 : 3 * shape_signed(&seed);
        s->degree += real ? 1 : 2;
    }
}

/* A set of the caller's own; 0: this one cannot be had. */
static int trial_make_own(trial_work *w) {
    const trial *c = w->c;
    hd_rational *s = &w->set;
    uint64_t seed = (uint64_t)c->seed + 9;
    const int degree = c->degree < 2 ? 8 : c->degree;
    int32_t p;
    memset(s, 0, sizeof *s);
    w->own = NULL;
    if (c->query == QUERY_FILTER || c->own == OWN_FITTED) return trial_make_filter(w);
    if (c->own == OWN_NONE) return 1;
    if (c->own == OWN_COPY || c->own == OWN_COPY0 || c->own == OWN_LOOSE || c->own == OWN_A0) {
        if (hd_rational_exp(s, HD_POLES_KERNEL, degree, NULL) < 0) return 0;
        s->kind = HD_POLES_OWN;
        if (c->own == OWN_LOOSE) s->max_weighted_error = 1;
        if (c->own == OWN_COPY0 || c->own == OWN_A0) {
            s->max_error = s->max_weighted_error = 0;
            w->own = s;
        }
        if (c->own == OWN_A0) s->a0 = 0.5;
        return 1;
    }
    s->kind = HD_POLES_OWN;
    w->own = s;
    if (c->own == OWN_NEAR) {                    /* 10^-x above an eigenvalue */
        const truth_pairs *T = &w->s->exact;
        const double t = c->query == QUERY_DISTANCE ? 2 * c->t : c->t;
        s->degree = 2;
        s->n_poles = 1;
        s->theta[0].re = -t * (double)T->lambda[c->seed % T->n];
        s->theta[0].im = pow(10, -c->own_x);
        s->a[0].im = 1;
    } else if (c->own == OWN_PACKS) {
        trial_packs(s, (int)c->own_x);
    } else if (c->own == OWN_RESOLVENT) {        /* 1/(1 - x) */
        s->degree = s->n_poles = 1;
        s->theta[0].re = 1;
        s->a[0].re = -1;
    } else {
        s->n_poles = 1 + trial_below(&seed, 6);
        s->a0 = trial_chance(&seed, 0.3) ? shape_signed(&seed) : 0;
        for (p = 0; p < s->n_poles; p++) {
            s->theta[p].re = 6 * shape_signed(&seed);
            s->theta[p].im = trial_power10(&seed, -1, 1);
            s->a[p].re = shape_signed(&seed);
            s->a[p].im = shape_signed(&seed);
            s->degree += 2;
        }
    }
    return isfinite(s->theta[0].re);
}

static hd_heat_opts trial_options(const trial *c) {
    hd_heat_opts o;
    memset(&o, 0, sizeof o);
    o.method = (hd_method)c->method;
    o.solver = (hd_solver)c->solver;
    o.precond = (hd_precond)c->precond;
    o.poles = (hd_pole_kind)c->poles;
    o.degree = c->own ? 0 : c->degree;
    o.tol = c->tol;
    o.max_iterations = 5000;
    o.context = &trial_serial;
    return o;
}

/* 0: there is no answer. */
static int trial_run_one(trial_subject *s, const trial *c, const char *text, int stored) {
    trial fitted = *c;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    trial_work w;
    const int64_t most = (s->lap->L.nnz > s->lap->n ? s->lap->L.nnz : s->lap->n) + 64;
    memset(&w, 0, sizeof w);
    w.s = s;
    w.c = c;
    w.stored = stored;
    w.T = stored ? &s->stored : &s->exact;
    w.text = text;
    if (!trial_make_own(&w)) return 0;
    if (c->own == OWN_FITTED) {                  /* the set has a time of its own */
        fitted.t = w.set.t;
        w.c = &fitted;
    }
    o = trial_options(c);
    o.rational = c->own || c->query == QUERY_FILTER ? &w.set : NULL;
    if (hd_heat_create(&heat, s->lap, &o, &e) < 0) {
        if (trial_verbose) printf("  no plan: %s\n", e.text);
        return 0;
    }
    w.want = TRUTH_NEW(quad, most);
    w.off = TRUTH_NEW(double, most);
    w.gw = TRUTH_NEW(quad, s->lap->n_active);
    w.gw_off = TRUTH_NEW(double, s->lap->n_active);
    switch (c->query) {
    case QUERY_APPLY: case QUERY_COLUMN: trial_run_columns(&w, heat); break;
    case QUERY_TIMES: trial_run_times(&w, heat); break;
    case QUERY_DERIVATIVE: case QUERY_ADJOINT: trial_run_training(&w, heat); break;
    case QUERY_FROM: case QUERY_FILTER: trial_run_from(&w, heat); break;
    case QUERY_DISTANCE_FROM: trial_run_distance_from(&w, heat); break;
    case QUERY_ENTRIES: case QUERY_PAIRS: trial_run_entries(&w, heat); break;
    case QUERY_DIAGONAL: trial_run_diagonal(&w, heat); break;
    default: trial_run_distance(&w, heat);
    }
    free(w.want);
    free(w.off);
    free(w.gw);
    free(w.gw_off);
    hd_heat_free(heat);
    return !w.refused;
}

static void trial_subject_free(trial_subject *s) {
    if (s->lap) {
        truth_filter_free(&s->f);
        truth_free(&s->exact);
        if (s->has_stored) truth_free(&s->stored);
        hd_laplacian_free(s->lap);
    }
    memset(s, 0, sizeof *s);
}

/* The pair and its truth; 0: there is none. */
static int trial_subject_make(trial_subject *s, const trial *c, int want_stored) {
    hd_error e;
    int exact;
    memset(s, 0, sizeof *s);
    if (trial_pair(&s->lap, c->shape, c->op, c->scale, &e) < 0) {
        if (trial_verbose) printf("  %s %s: %s\n", c->shape, c->op, e.text);
        return 0;
    }
    exact = s->lap->conserves && (s->lap->kind != HD_LAPLACIAN_MATRICES || truth_rounding(s->lap));
    if (s->lap->n_active > 400 || !truth_make(&s->exact, s->lap, exact)) {
        if (trial_verbose) printf("  %s %s: B is not positive definite\n", c->shape, c->op);
        hd_laplacian_free(s->lap);
        memset(s, 0, sizeof *s);
        return 0;
    }
    s->has_stored = want_stored && exact && truth_make(&s->stored, s->lap, 0);
    s->unit = trial_unit(s->lap);
    s->f = truth_filter_make(&s->exact);
    return 1;
}

/* One case on its subject. 0: there is no answer. */
static int trial_run(trial_subject *s, trial *c, int stored) {
    char text[400];
    int ok;
    if (c->th > 0) c->t = c->th * s->unit;
    c->th = 0;
    if (c->n_times < 1) c->n_times = 1;
    if (c->n_times > 64) c->n_times = 64;
    trial_print(c, text, sizeof text);
    if (trial_verbose)
        printf("%s\n  n %d, components %d, eigenvalues %g .. %g, conserves %d (truth: %d), unit of time %g\n",
               text, (int)s->lap->n_active, (int)s->exact.n_comp, s->exact.edge, s->exact.top,
               (int)s->lap->conserves, s->exact.conserves, s->unit);
    trial_counts[c->query].asked++;
    ok = trial_run_one(s, c, text, 0);
    trial_counts[c->query].refused += !ok;
    if (stored && s->has_stored && !(c->query >= QUERY_PAIRS && trial_timeless(c->kind)))
        trial_run_one(s, c, text, 1);
    return ok;
}

#endif
