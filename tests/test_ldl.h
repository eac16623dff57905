/* test_ldl.h - L D L' without pivoting: orderings, real and complex-symmetric factors, solves, against dense matrices and residuals computed
 * here */

#ifndef TEST_LDL_H
#define TEST_LDL_H

/* Real threads where the C library has them. */
#ifndef _WIN32
#if defined(_REENTRANT) || defined(__APPLE__) || (defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 34))
#define LDL_THREADS 1
#include <pthread.h>
#endif
#endif

static hd_ldl *const ldl_mark = (hd_ldl *)&test_passed;    /* not a factor: only compared */
static const hd_ordering ldl_orderings[4] = {HD_ORDERING_AUTO, HD_ORDERING_MINIMUM_DEGREE, HD_ORDERING_NESTED_DISSECTION, HD_ORDERING_OWN};
static const hd_simd ldl_simds[4] = {HD_SIMD_AUTO, HD_SIMD_NONE, HD_SIMD_AVX2, HD_SIMD_AVX512};

/* ---- patterns ---- */

typedef struct ldl_edges { int32_t n, *i, *j; int64_t count, room; } ldl_edges;

static ldl_edges ldl_edges_of(int32_t n) {
    ldl_edges g;
    memset(&g, 0, sizeof g);
    g.n = n;
    return g;
}

static void ldl_join(ldl_edges *g, int32_t a, int32_t b) {
    if (a == b) return;
    if (g->count + 2 > g->room) {
        g->room = 2 * g->room + 64;
        g->i = (int32_t *)realloc(g->i, (size_t)g->room * sizeof *g->i);
        g->j = (int32_t *)realloc(g->j, (size_t)g->room * sizeof *g->j);
        if (!g->i || !g->j) truth_stop("out of memory");
    }
    g->i[g->count] = g->j[g->count + 1] = a;
    g->j[g->count] = g->i[g->count + 1] = b;
    g->count += 2;
}

/* The pattern without values; with every diagonal entry, or with none. Takes the edges. */
static hd_csr ldl_pattern(ldl_edges *g, int diagonal) {
    const int64_t all = g->count + (diagonal ? g->n : 0);
    const int32_t mark = kit_mark();
    int32_t *i = KIT_NEW(int32_t, all), *j = KIT_NEW(int32_t, all), k;
    hd_csr a;
    hd_error e;
    if (g->count) memcpy(i, g->i, (size_t)g->count * sizeof *i);
    if (g->count) memcpy(j, g->j, (size_t)g->count * sizeof *j);
    for (k = 0; diagonal && k < g->n; k++) i[g->count + k] = j[g->count + k] = k;
    memset(&a, 0, sizeof a);
    CHECK(hd_csr_from_triplets(&a, g->n, g->n, all, i, j, NULL, NULL, &e) == HD_OK);
    free(g->i);
    free(g->j);
    memset(g, 0, sizeof *g);
    kit_release(mark);
    return a;
}

enum {
    LDL_EMPTY, LDL_PATH, LDL_STAR_FIRST, LDL_STAR_LAST, LDL_STAR_MIDDLE, LDL_TREE, LDL_TREES = LDL_TREE,    /* up to here: forests */
    LDL_CYCLE, LDL_ARROW, LDL_WHEEL, LDL_DENSE, LDL_GRID, LDL_PIECES, LDL_BAND, LDL_CLIQUES, LDL_BIPARTITE, LDL_RANDOM, LDL_SHAPES
};

static const char *ldl_shape_name(int kind) {
    static const char *const names[LDL_SHAPES] = {"diagonal", "path", "star, hub first", "star, hub last", "star", "tree", "cycle", "arrow", "wheel",
                                                  "dense", "grid", "pieces", "band", "cliques", "bipartite", "random"};
    return names[kind];
}

static int32_t ldl_below(uint64_t *seed, int32_t n) { return (int32_t)(dense_random(seed) % (uint64_t)n); }

static void ldl_clique(ldl_edges *g, int32_t begin, int32_t end) {
    int32_t i, j;
    for (i = begin; i < end && i < g->n; i++)
        for (j = begin; j < i; j++) ldl_join(g, i, j);
}

static hd_csr ldl_shape(int kind, int32_t n, int diagonal, uint64_t seed) {
    ldl_edges g = ldl_edges_of(n);
    const int32_t hub = kind == LDL_STAR_FIRST || kind == LDL_ARROW || kind == LDL_WHEEL ? 0 : kind == LDL_STAR_LAST ? n - 1 : n / 2;
    const int32_t wide = n < 4 ? n : (int32_t)sqrt((double)n);
    int32_t i, k;
    for (i = 0; i < n; i++) {
        if ((kind == LDL_PATH || kind == LDL_CYCLE || kind == LDL_ARROW || kind == LDL_WHEEL) && i > 0) ldl_join(&g, i, i - 1);
        if ((kind >= LDL_STAR_FIRST && kind <= LDL_STAR_MIDDLE) || kind == LDL_ARROW || kind == LDL_WHEEL) ldl_join(&g, i, hub);
        if (kind == LDL_TREE && i > 0) ldl_join(&g, i, ldl_below(&seed, i));
        if (kind == LDL_GRID && i % wide) ldl_join(&g, i, i - 1);
        if (kind == LDL_GRID && i >= wide) ldl_join(&g, i, i - wide);
        if (kind == LDL_GRID && i >= wide && i % wide) ldl_join(&g, i, i - wide - 1);
        if (kind == LDL_PIECES && i % 7 && i % 5 && i >= 3) ldl_join(&g, i, i - 1 - i % 3);    /* and rows that touch none */
        if (kind == LDL_BAND)
            for (k = 1; k <= 4 && k <= i; k++) ldl_join(&g, i, i - k);
        if (kind == LDL_CLIQUES && i % 9 == 0) ldl_clique(&g, i, i + 11);                       /* each shares two rows with the next */
        if (kind == LDL_BIPARTITE && i < n / 3)
            for (k = n / 3; k < n; k++) ldl_join(&g, i, k);
    }
    if (kind == LDL_CYCLE && n > 2) ldl_join(&g, 0, n - 1);
    if (kind == LDL_WHEEL && n > 3) ldl_join(&g, 1, n - 1);
    if (kind == LDL_DENSE) ldl_clique(&g, 0, n);
    if (kind == LDL_RANDOM)
        for (k = 0; k < 2 * n; k++) ldl_join(&g, ldl_below(&seed, n), ldl_below(&seed, n));
    return ldl_pattern(&g, diagonal);
}

/* Full matrices of so many rows, joined by the last rows of all: fronts of any number of pivots and rows, the last larger than a panel. */
static const struct { int32_t n, of, joint; } ldl_joints[] = {{41, 4, 33}, {31, 7, 3}, {48, 9, 12}, {96, 23, 50}, {75, 33, 9}, {137, 137, 0}};
enum { LDL_JOINTS = sizeof ldl_joints / sizeof *ldl_joints };

static hd_csr ldl_joined(int kind) {
    ldl_edges g = ldl_edges_of(ldl_joints[kind].n);
    int32_t i, j;
    for (i = 0; i < g.n; i++)
        for (j = 0; j < i; j++)
            if (i / ldl_joints[kind].of == j / ldl_joints[kind].of || i >= g.n - ldl_joints[kind].joint) ldl_join(&g, i, j);
    return ldl_pattern(&g, 1);
}

/* Edges, twice as likely among neighbours in number as elsewhere. */
static hd_csr ldl_random_pattern(int32_t n, double degree, uint64_t seed) {
    ldl_edges g = ldl_edges_of(n);
    const int64_t count = (int64_t)(degree * n / 2);
    int64_t k;
    for (k = 0; k < count; k++) {
        const int32_t i = ldl_below(&seed, n), far = ldl_below(&seed, n), near = (i + 1 + ldl_below(&seed, 6)) % n;
        ldl_join(&g, i, dense_random(&seed) % 3 ? near : far);
    }
    return ldl_pattern(&g, 1);
}

/* The pattern of a mesh, without values. */
static hd_csr ldl_mesh_pattern(const shape *s) {
    ldl_edges g = ldl_edges_of(s->n);
    int32_t f, q;
    for (f = 0; f < s->n_tri; f++)
        for (q = 0; q < 3; q++) ldl_join(&g, s->tri[3 * f + q], s->tri[3 * f + (q + 1) % 3]);
    return ldl_pattern(&g, 1);
}

/* ---- values ---- */

/* In [0, 1), the same for (i, j) and (j, i). */
static double ldl_chance(int32_t i, int32_t j, uint64_t seed) {
    uint64_t state = seed * 0x9e3779b97f4a7c15u + ((uint64_t)(i < j ? i : j) + 1) * 0x100000001b3u +
        ((uint64_t)(i < j ? j : i) + 1) * 0xc2b2ae3d27d4eb4fu;
    dense_random(&state);
    return 0.5 + 0.5 * dense_signed(&state);
}

/* L [nnz]: a graph's Laplacian, positive semi-definite; B [nnz]: positive definite, its entries of either sign. */
static void ldl_pair(const hd_csr *a, uint64_t seed, double *L, double *B) {
    int64_t p, at;
    int32_t i;
    for (i = 0; i < a->n_rows; i++) {
        double l = 0, b = 0;
        for (at = -1, p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            if (a->col[p] == i) at = p;
            else {
                L[p] = -0.05 - ldl_chance(i, a->col[p], seed);
                B[p] = 0.3 * (ldl_chance(i, a->col[p], seed + 1) - 0.3);
                l -= L[p];
                b += fabs(B[p]);
            }
        }
        if (at < 0) continue;
        L[at] = l;
        B[at] = b + 0.2 + ldl_chance(i, i, seed + 2);
    }
}

/* Poles of all tables, each with its own sign of the imaginary part: both half planes, near the axes and far from them. */
static hd_c64 ldl_theta(uint64_t *seed) {
    hd_rational set;
    const hd_pole_kind kind = dense_random(seed) % 2 ? HD_POLES_UNIFORM : HD_POLES_KERNEL;
    const int32_t degree = 2 + ldl_below(seed, 13);
    hd_c64 z;
    CHECK(hd_rational_exp(&set, kind, degree, NULL) == HD_OK);
    z = set.theta[ldl_below(seed, set.n_poles)];
    if (dense_random(seed) % 2) z.im = -z.im;
    return z;
}

/* 1 / cos^2(arg theta / 2): how far pivots of t L + theta B may exceed the diagonal. */
static double ldl_growth_bound(hd_c64 theta) { return 2 / (1 + theta.re / hypot(theta.re, theta.im)); }

static void ldl_growth_of_tables(void) {
    static const double most[2] = {3.79, 4.21};    /* reached at degree 14 */
    hd_rational set;
    int32_t degree, i, k;
    for (k = 0; k < 2; k++)
        for (degree = 2; degree <= 14; degree++) {
            CHECK(hd_rational_exp(&set, k ? HD_POLES_KERNEL : HD_POLES_UNIFORM, degree, NULL) == HD_OK);
            for (i = 0; i < set.n_poles; i++)
                CHECK_MSG(ldl_growth_bound(set.theta[i]) < most[k], "kind %d, degree %d, pole %d: %g", (int)k, (int)degree, (int)i,
                          ldl_growth_bound(set.theta[i]));
        }
}

/* val [k][nnz] = t L + theta_q B, and the largest growth that theory admits. */
static double ldl_shifted(const hd_csr *a, const double *L, const double *B, int32_t k, uint64_t seed, hd_c64 *val) {
    double bound = 0;
    int64_t p;
    int32_t q;
    for (q = 0; q < k; q++) {
        const hd_c64 theta = ldl_theta(&seed);
        const double t = pow(10, 1.5 + 2.5 * dense_signed(&seed));
        for (p = 0; p < a->nnz; p++) val[q * a->nnz + p] = test_c(t * L[p] + theta.re * B[p], theta.im * B[p]);
        bound = fmax(bound, ldl_growth_bound(theta));
    }
    return bound;
}

static void ldl_fill(hd_c64 *b, int64_t count, uint64_t seed) {
    int64_t i;
    for (i = 0; i < count; i++) {
        b[i].re = dense_signed(&seed);
        b[i].im = 2 * dense_signed(&seed);
    }
}

/* ---- what to hold answers against ---- */

/* |b - A x| / (|A| |x| + |b|) in the norm of the maximum; no conjugate anywhere. */
static double ldl_backward(const hd_csr *a, const hd_c64 *val, const hd_c64 *b, const hd_c64 *x) {
    double most = 0, norm_a = 0, norm_x = 0, norm_b = 0;
    int64_t p;
    int32_t i;
    for (i = 0; i < a->n_rows; i++) {
        hd_c64 r = b[i];
        double row = 0;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const hd_c64 v = val[p], y = x[a->col[p]];
            r.re -= v.re * y.re - v.im * y.im;
            r.im -= v.re * y.im + v.im * y.re;
            row += hypot(v.re, v.im);
        }
        norm_a = fmax(norm_a, row);
        norm_x = fmax(norm_x, hypot(x[i].re, x[i].im));
        norm_b = fmax(norm_b, hypot(b[i].re, b[i].im));
        if (!(hypot(r.re, r.im) <= most)) most = hypot(r.re, r.im);    /* a NaN stays */
    }
    return most > 0 || most != most ? most / (norm_a * norm_x + norm_b) : 0;
}

/* Largest |x - y| / largest |y|. */
static double ldl_differ(const hd_c64 *x, const hd_c64 *y, int64_t n) {
    double off = 0, size = 0;
    int64_t i;
    for (i = 0; i < n; i++) {
        const double diff = hypot(x[i].re - y[i].re, x[i].im - y[i].im);
        if (!(diff <= off)) off = diff;
        size = fmax(size, hypot(y[i].re, y[i].im));
    }
    return off > 0 || off != off ? off / size : 0;
}

/* The same against dense LU with pivoting. */
static double ldl_off_dense(const hd_csr *a, const hd_c64 *val, const hd_c64 *b, const hd_c64 *x) {
    const int32_t n = a->n_rows, mark = kit_mark();
    dense_c64 *d = KIT_NEW(dense_c64, (int64_t)n * n), *u = KIT_NEW(dense_c64, n);
    hd_c64 *y = KIT_NEW(hd_c64, n);
    double off;
    int64_t p;
    int32_t i;
    for (i = 0; i < n; i++) {
        u[i] = dense_c(b[i].re, b[i].im);
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) d[(size_t)i * (size_t)n + (size_t)a->col[p]] = dense_c(val[p].re, val[p].im);
    }
    CHECK(dense_complex_solve(d, u, n));
    for (i = 0; i < n; i++) y[i] = test_c(u[i].re, u[i].im);
    off = ldl_differ(x, y, n);
    kit_release(mark);
    return off;
}

/* n real numbers as complex ones. */
static hd_c64 *ldl_complex(const double *x, int64_t n) {
    hd_c64 *z = KIT_NEW(hd_c64, n);
    int64_t i;
    for (i = 0; i < n; i++) z[i].re = x[i];
    return z;
}

static double ldl_backward_real(const hd_csr *a, const double *val, const double *b, const double *x) {
    const int32_t n = a->n_rows, mark = kit_mark();
    const double back = ldl_backward(a, ldl_complex(val, a->nnz), ldl_complex(b, n), ldl_complex(x, n));
    kit_release(mark);
    return back;
}

/* Elimination on a dense matrix in the order of perm: pivots d [n], non-zeros of L with its diagonal, sum of squared column counts. */
static int64_t ldl_eliminate(const hd_csr *a, const hd_c64 *val, const int32_t *perm, dense_c64 *d, double *flops) {
    const int32_t n = a->n_rows, mark = kit_mark();
    dense_c64 *m = KIT_NEW(dense_c64, (int64_t)n * n);
    unsigned char *fill = KIT_NEW(unsigned char, (int64_t)n * n);
    int32_t *inv = KIT_NEW(int32_t, n), i, j, k;
    int64_t p, nnz = 0;
    *flops = 0;
    for (i = 0; i < n; i++) inv[perm[i]] = i;
    for (i = 0; i < n; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const size_t at = (size_t)inv[i] * (size_t)n + (size_t)inv[a->col[p]];
            m[at] = dense_c(val[p].re, val[p].im);
            fill[at] = 1;
        }
    for (k = 0; k < n; k++) {
        const size_t row = (size_t)k * (size_t)n;
        int64_t count = 1;
        d[k] = m[row + (size_t)k];
        for (i = k + 1; i < n; i++) {
            const size_t to = (size_t)i * (size_t)n;
            const dense_c64 l = dense_cquotient(m[to + (size_t)k], m[row + (size_t)k]);
            if (!fill[to + (size_t)k]) continue;
            count++;
            for (j = k + 1; j < n; j++) {
                m[to + (size_t)j] = dense_cfma(m[to + (size_t)j], l, m[row + (size_t)j]);
                fill[to + (size_t)j] |= fill[row + (size_t)j];
            }
        }
        nnz += count;
        *flops += (double)count * (double)count;
    }
    kit_release(mark);
    return nnz;
}

/* ---- short forms ---- */

static hd_ldl_opts ldl_opts_of(hd_ordering ordering, const int32_t *perm, const double *xyz, hd_context *ctx) {
    hd_ldl_opts o;
    memset(&o, 0, sizeof o);
    o.ordering = ordering;
    o.perm = perm;
    o.xyz = xyz;
    o.context = ctx;
    return o;
}

/* Reports say what was asked for and nothing absurd. */
static void ldl_check_report(const hd_ldl_report *r, const hd_csr *a, hd_ordering asked, int32_t k, const char *what) {
    const int32_t n = a->n_rows;
    CHECK_MSG(asked == HD_ORDERING_AUTO ? r->ordering != HD_ORDERING_AUTO : r->ordering == asked, "%s: ordering %d", what, (int)r->ordering);
    CHECK_MSG(r->n_matrices == k, "%s: %d matrices, not %d", what, (int)r->n_matrices, (int)k);
    CHECK_MSG(r->n_supernodes <= n && (r->n_supernodes > 0) == (n > 0), "%s: %d supernodes", what, (int)r->n_supernodes);
    CHECK_MSG(r->factor_nnz >= n + (a->nnz - n) / 2 && r->factor_nnz <= (int64_t)n * (n + 1) / 2, "%s: %lld non-zeros", what,
              (long long)r->factor_nnz);
    CHECK_MSG(r->stored >= r->factor_nnz - n, "%s: %lld stored", what, (long long)r->stored);
    CHECK_MSG(r->factor_flops >= (double)r->factor_nnz && r->factor_flops <= (double)r->factor_nnz * n, "%s: %g flops", what, r->factor_flops);
    if (k == 0 || n == 0) CHECK_MSG(r->growth == r->growth && r->smallest_pivot == r->smallest_pivot && r->n_negative == 0, "%s: NaN", what);
    else CHECK_MSG(r->growth > 0 && r->smallest_pivot > 0 && r->smallest_pivot <= r->growth, "%s: pivots %g to %g", what, r->smallest_pivot,
                   r->growth);
}

static hd_ldl *ldl_make(const hd_csr *a, const hd_ldl_opts *o, const char *what) {
    hd_ldl *f = ldl_mark;
    hd_ldl_report rep;
    hd_error e;
    if (!CHECK_MSG(hd_ldl_analyse(&f, a, o, &rep, &e) == HD_OK && e.status == HD_OK, "%s: %s", what, e.text)) return NULL;
    CHECK(f && f != ldl_mark);
    ldl_check_report(&rep, a, o ? o->ordering : HD_ORDERING_AUTO, 0, what);
    return f;
}

/* ---- problems ---- */

enum { LDL_SIDES = 13 };

/* A pattern with k complex-symmetric matrices, t L + theta B each with its own t and pole, and a real one, t L + B, positive
 * definite. All lives as long as the kit. */
typedef struct ldl_problem {
    hd_csr a;
    int32_t n, k, *perm;             /* perm: a random order */
    hd_c64 *val, *b, *x;             /* k matrices, right-hand sides and answers */
    double *real, *c, *y, *xyz;      /* a matrix, LDL_SIDES right-hand sides and answers; random points */
    double growth;                   /* at most this for val, by theory */
} ldl_problem;

/* Takes the pattern. */
static ldl_problem ldl_problem_of(hd_csr a, int32_t k, uint64_t seed) {
    ldl_problem p;
    double *L = KIT_NEW(double, a.nnz);
    const double t = pow(10, 1 + 2 * ldl_chance(k, a.n_rows, seed));
    int64_t q;
    p.a = kit_own_csr(a);
    p.n = a.n_rows;
    p.k = k;
    p.perm = KIT_NEW(int32_t, p.n);
    dense_shuffle(p.perm, p.n, &seed);
    p.val = KIT_NEW(hd_c64, k * a.nnz);
    p.b = KIT_NEW(hd_c64, (int64_t)k * p.n);
    p.x = KIT_NEW(hd_c64, (int64_t)k * p.n);
    p.real = KIT_NEW(double, a.nnz);
    p.c = kit_random((int64_t)LDL_SIDES * p.n, seed + 1);
    p.y = KIT_NEW(double, (int64_t)LDL_SIDES * p.n);
    p.xyz = kit_random(3 * (int64_t)p.n, seed + 2);
    ldl_pair(&a, seed, L, p.real);
    p.growth = ldl_shifted(&a, L, p.real, k, seed + 3, p.val);
    ldl_fill(p.b, (int64_t)k * p.n, seed + 4);
    for (q = 0; q < a.nnz; q++) p.real[q] += t * L[q];
    return p;
}

static ldl_problem ldl_random_problem(int32_t n, double degree, int32_t k, uint64_t seed) {
    return ldl_problem_of(ldl_random_pattern(n, degree, seed), k, seed + 1);
}

/* Both kinds factored and solved; the complex right-hand sides ldb apart, 0: the first for all. */
static void ldl_answer(hd_ldl *f, const ldl_problem *p, size_t ldb, int32_t sides, hd_ldl_report rep[2]) {
    hd_error e;
    CHECK_MSG(hd_ldl_factor_complex(f, p->k, p->val, rep, &e) == HD_OK && e.status == HD_OK, "%s", e.text);
    CHECK_MSG(hd_ldl_solve_complex(f, p->b, ldb, p->x, 0, &e) == HD_OK && e.status == HD_OK, "%s", e.text);
    CHECK_MSG(hd_ldl_factor(f, p->real, rep + 1, &e) == HD_OK && e.status == HD_OK, "%s", e.text);
    CHECK_MSG(hd_ldl_solve(f, sides, p->c, 0, p->y, 0, &e) == HD_OK && e.status == HD_OK, "%s", e.text);
}

/* What ldl_answer found against residuals, and against dense LU where dense. */
static void ldl_judge(const ldl_problem *p, size_t ldb, int32_t sides, int dense, const char *what) {
    const int64_t n = p->n, nnz = p->a.nnz;
    int32_t q;
    for (q = 0; q < p->k; q++) {
        const hd_c64 *val = p->val + q * nnz, *b = p->b + (size_t)q * ldb, *x = p->x + q * n;
        const double back = ldl_backward(&p->a, val, b, x), off = dense ? ldl_off_dense(&p->a, val, b, x) : 0;
        CHECK_MSG(back <= 1e-14 && off <= 1e-9, "%s, n %d, matrix %d of %d: backward error %g, off by %g", what, (int)n, (int)q, (int)p->k, back, off);
    }
    for (q = 0; q < sides; q++) {
        const double back = ldl_backward_real(&p->a, p->real, p->c + q * n, p->y + q * n);
        CHECK_MSG(back <= 1e-14, "%s, n %d, right-hand side %d of %d: backward error %g", what, (int)n, (int)q, (int)sides, back);
    }
}

/* The problem on an analysis of its pattern: answers, and what reports say. */
static void ldl_ask(hd_ldl *f, const ldl_problem *p, hd_ordering asked, int32_t sides, int dense, const char *what) {
    hd_ldl_report rep[2];
    if (!f) return;
    ldl_answer(f, p, (size_t)p->n, sides, rep);
    ldl_judge(p, (size_t)p->n, sides, dense, what);
    ldl_check_report(rep, &p->a, asked, p->k, what);
    ldl_check_report(rep + 1, &p->a, asked, 1, what);
    CHECK_MSG(rep[0].growth <= p->growth * (1 + 1e-9) && rep[0].n_negative == 0, "%s, n %d: growth %g, at most %g", what, (int)p->n, rep[0].growth,
              p->growth);
    CHECK_MSG(rep[1].growth <= 1 + 1e-12 && rep[1].n_negative == 0, "%s: %d negative, growth %g", what, (int)rep[1].n_negative, rep[1].growth);
}

/* ---- small ones, by hand ---- */

/* Real matrices, with places of the pattern by hand, in the natural order: what the report says, and where there is no pivot. */
typedef struct ldl_hand {
    int32_t n, nnz, i[9], j[9];
    double val[9];
    int32_t row;                     /* the pivot that is zero, or -1 */
    int32_t negative;
    double growth, smallest, flops;
    int64_t factor_nnz;
} ldl_hand;

static void ldl_by_hand(void) {
    static const ldl_hand rows[] = {
        {1, 1, {0}, {0}, {-2.5}, -1, 1, 1, 1, 1, 1},
        {2, 4, {0, 0, 1, 1}, {0, 1, 0, 1}, {2, 6, 6, 3}, -1, 1, 5, 2.0 / 3, 5, 3},                             /* pivots 2, 3 - 18 */
        {3, 6, {0, 0, 1, 1, 2, 2}, {0, 1, 0, 2, 1, 2}, {4, 1, 1, 2, 2, 1}, -1, 1, 17.0 / 4, 1.0 / 16, 9, 5},   /* 4, -1/4, 17; no (1, 1) */
        {3, 5, {0, 0, 0, 1, 2}, {0, 1, 2, 0, 0}, {2, 1, 3, 1, 3}, 2, 0, 0, 0, 0, 0},    /* the Schur complement of the first: -[1 3; 3 9]/2 */
        {3, 4, {0, 1, 2, 2}, {2, 2, 0, 1}, {2, 1, 2, 1}, 0, 0, 0, 0, 0, 0},             /* no diagonal at all */
        {2, 2, {0, 1}, {1, 0}, {1, 1}, 0, 0, 0, 0, 0, 0},
        {2, 4, {0, 0, 1, 1}, {0, 1, 0, 1}, {1, 2, 2, 4}, 1, 0, 0, 0, 0, 0},
    };
    static const int32_t natural[3] = {0, 1, 2};
    static const double b[3] = {7, 1, 3};
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, natural, NULL, NULL);
    size_t k;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        const ldl_hand *r = rows + k;
        hd_ldl_report rep;
        hd_error e;
        hd_csr a;
        hd_ldl *f;
        double x[3];
        CHECK(hd_csr_from_triplets(&a, r->n, r->n, r->nnz, r->i, r->j, NULL, NULL, NULL) == HD_OK && a.nnz == r->nnz);
        f = ldl_make(kit_csr(a), &o, "by hand");
        if (r->row >= 0) CHECK(hd_ldl_factor(f, r->val, &rep, &e) == HD_ERR_BREAKDOWN && e.row == r->row && e.value == 0);
        else {
            CHECK(hd_ldl_factor(f, r->val, &rep, &e) == HD_OK && rep.n_negative == r->negative && rep.n_supernodes > 0);
            CHECK_MSG(fabs(rep.growth - r->growth) < 1e-13 && fabs(rep.smallest_pivot - r->smallest) < 1e-14, "row %d: %g, %g", (int)k, rep.growth,
                      rep.smallest_pivot);
            CHECK_MSG(rep.factor_nnz == r->factor_nnz && rep.factor_flops == r->flops, "row %d: %lld non-zeros, %g flops", (int)k,
                      (long long)rep.factor_nnz, rep.factor_flops);
            CHECK(hd_ldl_solve(f, 1, b, 0, x, 0, NULL) == HD_OK && ldl_backward_real(&a, r->val, b, x) < 1e-15);
        }
        hd_ldl_free(f);
    }
}

/* [1 + i, 2 - i; 2 - i, 3i] x = b with x = (1, i): 2 - i squared is 3 - 4i, its size squared would be 5. And (1 + i) [1 2; 2 4],
 * [2i 1; 1 -i/2], whose second pivot is zero; and pivots that overflow. */
static void ldl_two(void) {
    static const hd_c64 val[4] = {{1, 1}, {2, -1}, {2, -1}, {0, 3}}, b[2] = {{2, 3}, {-1, -1}};
    static const hd_c64 nil[8] = {{1, 1}, {2, 2}, {2, 2}, {4, 4}, {0, 2}, {1, 0}, {1, 0}, {0, -0.5}};
    static const double huge[4] = {1e-200, 1e200, 1e200, 1};
    static const int32_t natural[2] = {0, 1};
    hd_csr a = kit_own_csr(ldl_shape(LDL_PATH, 2, 1, 1));
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, natural, NULL, NULL);
    hd_ldl *f = ldl_make(&a, &o, "2 x 2");
    hd_ldl_report rep;
    hd_error e;
    hd_c64 x[2];
    CHECK(hd_ldl_factor_complex(f, 1, val, &rep, NULL) == HD_OK && rep.factor_nnz == 3 && rep.factor_flops == 5);
    CHECK(hd_ldl_solve_complex(f, b, 0, x, 0, NULL) == HD_OK);
    CHECK_MSG(hypot(x[0].re - 1, x[0].im) < 1e-14 && hypot(x[1].re, x[1].im - 1) < 1e-14, "%g%+gi, %g%+gi", x[0].re, x[0].im, x[1].re, x[1].im);
    CHECK(hd_ldl_factor_complex(f, 1, nil, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 1 && e.pole == 0 && e.value == 0);
    CHECK(hd_ldl_factor_complex(f, 1, nil + 4, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 1 && e.pole == 0);
    TRAPS_OFF;                                   /* pivots are looked at, not what leads to them */
    CHECK(hd_ldl_factor(f, huge, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 1 && !(fabs(e.value) <= DBL_MAX));
    TRAPS_ON;
    hd_ldl_free(f);
}

static void ldl_none(void) {
    static const double d = 3, xyz[3] = {0, 0, 0};
    static const hd_c64 z = {3, 1};
    static const int32_t perm = 0;
    hd_csr a = kit_own_csr(ldl_shape(LDL_EMPTY, 0, 1, 1));
    int k;
    for (k = 0; k < 4; k++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[k], &perm, xyz, NULL);
        hd_ldl *f = ldl_make(&a, &o, "n = 0");
        hd_ldl_report rep;
        double x = 7;
        hd_c64 y = {7, 8};
        CHECK(hd_ldl_factor(f, &d, &rep, NULL) == HD_OK && rep.n_matrices == 1 && rep.factor_nnz == 0 && rep.factor_flops == 0);
        CHECK(rep.growth == rep.growth && rep.smallest_pivot == rep.smallest_pivot && rep.n_negative == 0);
        CHECK(hd_ldl_solve(f, 1, &d, 0, &x, 0, NULL) == HD_OK && x == 7);
        CHECK(hd_ldl_factor_complex(f, 5, &z, &rep, NULL) == HD_OK && rep.n_matrices == 5);
        CHECK(hd_ldl_solve_complex(f, &z, 0, &y, 0, NULL) == HD_OK && y.re == 7 && y.im == 8);
        hd_ldl_free(f);
    }
}

/* Diagonal matrices, every pivot an entry in whatever order; and the Laplacian of a path: pivots 1, ..., 1, 0 from either end. */
static void ldl_diagonal(void) {
    enum { N = 37 };
    double d[N], b[N], x[N];
    int32_t perm[N], i;
    hd_csr a, path = kit_own_csr(test_path_csr(N, 0));
    hd_error e;
    int k;
    for (i = 0; i < N; i++) {
        d[i] = i % 3 ? 1 + i : -1 - i;
        b[i] = 4 * d[i];
    }
    a = kit_own_csr(test_diagonal_csr(N, d));
    for (k = 0; k < 2; k++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[k], NULL, NULL, NULL), own = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, NULL);
        hd_ldl *f = ldl_make(&a, &o, "diagonal");
        hd_ldl_report rep;
        CHECK(hd_ldl_factor(f, d, &rep, NULL) == HD_OK && rep.factor_nnz == N && rep.factor_flops == N);
        CHECK_MSG(rep.n_negative == 13 && rep.growth == 1 && fabs(rep.smallest_pivot - 1.0 / N) < 1e-16, "%d, %g, %g", (int)rep.n_negative,
                  rep.growth, rep.smallest_pivot);
        CHECK(hd_ldl_solve(f, 1, b, 0, x, 0, NULL) == HD_OK);
        for (i = 0; i < N; i++) CHECK_MSG(fabs(x[i] - 4) < 1e-14, "x[%d] = %g", (int)i, x[i]);
        hd_ldl_free(f);
        for (i = 0; i < N; i++) perm[i] = k ? N - 1 - i : i;
        f = ldl_make(&path, &own, "singular");
        CHECK_MSG(hd_ldl_factor(f, path.val, &rep, &e) == HD_ERR_BREAKDOWN && e.row == perm[N - 1] && e.value == 0, "row %d, %g", (int)e.row, e.value);
        hd_ldl_free(f);
    }
}

/* ---- many patterns ---- */

/* A problem by every ordering, one level of instructions after the other. */
static void ldl_all_orderings(const ldl_problem *p, int dense, const char *what) {
    int way, i;
    for (way = 0; way < 6; way++) {              /* automatic, minimum degree, nested dissection; own: random, natural, reversed */
        hd_context ctx;
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way < 3 ? way : 3], p->perm, way == 0 && p->k % 2 ? NULL : p->xyz, &ctx);
        hd_ldl *f;
        memset(&ctx, 0, sizeof ctx);
        ctx.simd = ldl_simds[(way + p->k) % 4];
        for (i = 0; way > 3 && i < p->n; i++) p->perm[i] = way == 5 ? p->n - 1 - i : i;
        f = ldl_make(&p->a, &o, what);
        ldl_ask(f, p, o.ordering, 2 + (way + p->k) % 9, dense && (way + p->k) % 3 == 0, what);
        if (f) CHECK(hd_ldl_solve(f, 1, p->c, 0, p->y, 0, NULL) == HD_OK && ldl_backward_real(&p->a, p->real, p->c, p->y) <= 1e-14);
        hd_ldl_free(f);
        CHECK(ctx.bytes_in_use == 0);
    }
}

static void ldl_all_shapes(void) {
    static const int32_t sizes[6] = {1, 2, 3, 10, 33, 70};
    const int32_t mark = kit_mark();
    int kind, s;
    for (kind = 0; kind < LDL_SHAPES; kind++)
        for (s = 0; s < 6; s++) {
            const ldl_problem p = ldl_problem_of(ldl_shape(kind, sizes[s], 1, (uint64_t)(kind + 1)), 1 + (kind + 2 * s) % 9, (uint64_t)(100 * kind + s + 1));
            ldl_all_orderings(&p, 1, ldl_shape_name(kind));
            kit_release(mark);
        }
}

/* The last four: fronts larger than a block, and a tree of some depth. */
static void ldl_all_random(void) {
    static const double degrees[5] = {0.7, 2, 4, 9, 30}, large[4] = {12, 3.1, 2.7, 2.3};
    static const int32_t sizes[4] = {500, 800, 1200, 2000};
    const int32_t mark = kit_mark();
    int32_t n, k = 0;
    for (n = 1; n <= 120; n += n < 20 ? 1 : 4, k++) {
        const ldl_problem p = ldl_random_problem(n, degrees[k % 5], 1 + k % 9, (uint64_t)(n + 1000));
        ldl_all_orderings(&p, 1, "random");
        kit_release(mark);
    }
    for (k = 0; k < 4; k++) {
        const ldl_problem p = ldl_random_problem(sizes[k], large[k], 2 + k, (uint64_t)(k + 1));
        ldl_all_orderings(&p, 0, "random, large");
        kit_release(mark);
    }
}

/* Dense matrices across the sizes at which blocked kernels change, and fronts of some pivots and rows, at every level of instructions. */
static void ldl_all_dense(void) {
    static const int32_t sizes[10] = {4, 5, 7, 8, 9, 15, 31, 64, 97, 257};
    const int32_t mark = kit_mark();
    int s, q, way, i;
    for (s = 0; s < 10 + LDL_JOINTS; s++)
        for (q = 0; q < 4; q++) {
            const ldl_problem p = ldl_problem_of(s < 10 ? ldl_shape(LDL_DENSE, sizes[s], 1, 3) : ldl_joined(s - 10), 1 + (s + q) % 5, (uint64_t)s + 1);
            for (way = 0; way < 3 && (s >= 10 || way == 0); way++) {      /* automatic; own: random, natural */
                hd_context ctx;
                hd_ldl_opts o = ldl_opts_of(ldl_orderings[way ? 3 : 0], p.perm, NULL, &ctx);
                hd_ldl *f;
                memset(&ctx, 0, sizeof ctx);
                ctx.simd = ldl_simds[q];
                for (i = 0; way == 2 && i < p.n; i++) p.perm[i] = i;
                f = ldl_make(&p.a, &o, "dense");
                ldl_ask(f, &p, o.ordering, 1, p.n < 65, "dense");
                ldl_ask(f, &p, o.ordering, LDL_SIDES, 0, "dense");
                hd_ldl_free(f);
            }
            kit_release(mark);
        }
}

/* ---- fill ---- */

/* With an order given, fill, flops and pivots are facts. */
static void ldl_own_order(const ldl_problem *p, const char *what) {
    const hd_csr *a = &p->a;
    const int32_t n = p->n;
    double lo = HUGE_VAL, lo_each = HUGE_VAL, top = 0, hi_least = HUGE_VAL, hi_most = 0, flops;
    dense_c64 *d = KIT_NEW(dense_c64, n);
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, p->perm, NULL, NULL);
    hd_ldl *f = ldl_make(a, &o, what);
    hd_ldl_report rep;
    int32_t i, q;
    for (q = 0; f && q < p->k; q++) {
        const hd_c64 *val = p->val + q * a->nnz;
        const int64_t nnz = ldl_eliminate(a, val, p->perm, d, &flops);
        double most = 0, least = HUGE_VAL, diag = 0;
        for (i = 0; i < n; i++) {
            const hd_c64 z = val[op_find(a, i, i)];
            diag = fmax(diag, hypot(z.re, z.im));
            most = fmax(most, hypot(d[i].re, d[i].im));
            least = fmin(least, hypot(d[i].re, d[i].im));
        }
        CHECK(hd_ldl_factor_complex(f, 1, val, &rep, NULL) == HD_OK);
        CHECK_MSG(fabs(rep.growth - most / diag) <= 1e-10 * rep.growth, "%s, n %d: growth %.12g, not %.12g", what, (int)n, rep.growth, most / diag);
        CHECK_MSG(fabs(rep.smallest_pivot - least / diag) <= 1e-9 * rep.smallest_pivot, "%s, n %d: smallest pivot %.12g, not %.12g", what, (int)n,
                  rep.smallest_pivot, least / diag);
        CHECK_MSG(rep.factor_nnz == nnz && rep.factor_flops == flops, "%s, n %d: %lld non-zeros, not %lld; %g flops, not %g", what, (int)n,
                  (long long)rep.factor_nnz, (long long)nnz, rep.factor_flops, flops);
        lo = fmin(lo, least);
        lo_each = fmin(lo_each, least / diag);
        top = fmax(top, diag);
        hi_least = fmin(hi_least, most / diag);
        hi_most = fmax(hi_most, most / diag);
    }
    if (f && CHECK(hd_ldl_factor_complex(f, p->k, p->val, &rep, NULL) == HD_OK)) {    /* all at once: nothing of lanes without a matrix may show */
        CHECK_MSG(rep.growth >= hi_least * (1 - 1e-9) && rep.growth <= hi_most * (1 + 1e-9), "%s: growth %g", what, rep.growth);
        CHECK_MSG(rep.smallest_pivot >= lo / top * (1 - 1e-9) && rep.smallest_pivot <= lo_each * (1 + 1e-9), "%s: smallest %g", what,
                  rep.smallest_pivot);
    }
    hd_ldl_free(f);
}

static void ldl_own_orders(void) {
    static const int32_t sizes[5] = {1, 2, 9, 40, 85};
    const int32_t mark = kit_mark();
    int kind, s, way, i;
    for (kind = 0; kind < LDL_SHAPES; kind++)
        for (s = 0; s < 5; s++) {
            const ldl_problem p = ldl_problem_of(ldl_shape(kind, sizes[s], 1, (uint64_t)s + 9), 3, (uint64_t)(kind + 10 * s + 1));
            for (way = 0; way < 3; way++) {      /* random, natural, reversed */
                for (i = 0; way > 0 && i < p.n; i++) p.perm[i] = way == 2 ? p.n - 1 - i : i;
                ldl_own_order(&p, ldl_shape_name(kind));
            }
            kit_release(mark);
        }
    for (s = 0; s < 20; s++) {
        const ldl_problem p = ldl_random_problem(5 + 6 * s, 1 + s % 5, 3, (uint64_t)s + 1);
        ldl_own_order(&p, "random");
        kit_release(mark);
    }
}

/* A minimum degree order of a forest takes leaves first: no fill at all. And on a grid both orders beat the natural one. */
static void ldl_fill_is_low(void) {
    enum { N = 2500 };
    static const int32_t sizes[3] = {5, 60, 700};
    hd_csr grid = kit_own_csr(ldl_shape(LDL_GRID, N, 1, 1));
    hd_ldl_report rep, natural;
    hd_ldl *f;
    int32_t *perm = KIT_NEW(int32_t, N), i;
    double *xyz = KIT_NEW(double, 3 * N);
    int kind, k;
    for (kind = 0; kind <= LDL_TREES; kind++)
        for (k = 0; k < 3; k++) {
            const int32_t n = sizes[k];
            hd_ldl_opts o = ldl_opts_of(HD_ORDERING_MINIMUM_DEGREE, NULL, NULL, NULL);
            hd_csr a = kit_own_csr(ldl_shape(kind, n, 1, (uint64_t)k + 1));
            if (!CHECK(hd_ldl_analyse(&f, &a, &o, &rep, NULL) == HD_OK)) continue;
            CHECK_MSG(rep.factor_nnz == n + (a.nnz - n) / 2, "%s of %d: %lld non-zeros", ldl_shape_name(kind), (int)n, (long long)rep.factor_nnz);
            hd_ldl_free(f);
        }
    for (i = 0; i < N; i++) {
        perm[i] = i;
        xyz[3 * i] = i % 50;
        xyz[3 * i + 1] = i / 50;
    }
    for (k = 3; k >= 0; k--) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[k], perm, xyz, NULL);
        if (!CHECK(hd_ldl_analyse(&f, &grid, &o, k == 3 ? &natural : &rep, NULL) == HD_OK)) continue;
        if (k < 3) CHECK_MSG(rep.factor_nnz < N * 26 && rep.factor_flops < natural.factor_flops / 2, "ordering %d: %lld non-zeros, natural %lld", k,
                             (long long)rep.factor_nnz, (long long)natural.factor_nnz);
        hd_ldl_free(f);
    }
}

/* ---- indefinite ---- */

/* [H, A'; A, -G] with H and G positive definite: every order has pivots, and as many are negative as there are negative eigenvalues. */
static void ldl_quasidefinite_of(int32_t n, uint64_t seed) {
    const ldl_problem p = ldl_random_problem(n, 5, 1, seed);
    const hd_csr *a = &p.a;
    double *val = p.real, *q = KIT_NEW(double, (int64_t)n * n), *lambda = KIT_NEW(double, n), *dense;
    int32_t i, k, negative = 0;
    int64_t at;
    int way;
    for (i = 0; i < n; i++) {
        const int si = ldl_chance(i, i, seed) < 0.4;
        double sum = 0;
        for (at = a->row_ptr[i]; at < a->row_ptr[i + 1]; at++) {
            const int32_t j = a->col[at];
            val[at] = 2 * ldl_chance(i, j, seed + 1) - 1;
            if (j != i && si == (ldl_chance(j, j, seed) < 0.4)) sum += fabs(val[at]);
        }
        val[op_find(a, i, i)] = (si ? -1 : 1) * (sum + 0.5 + ldl_chance(i, i, seed + 2));
    }
    dense = (double *)kit_keep(test_dense(a, val), free);
    CHECK(dense_symmetric_eigen(dense, q, lambda, n));
    for (i = 0; i < n; i++) negative += lambda[i] < 0;
    for (way = 0; way < 4; way++) {
        double *xyz = DENSE_NEW(double, 3 * n);
        hd_context ctx;
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], p.perm, xyz, &ctx);
        hd_ldl_report rep;
        hd_ldl *f;
        memset(&ctx, 0, sizeof ctx);
        ctx.simd = ldl_simds[((uint64_t)way + seed) % 4];
        memcpy(xyz, p.xyz, 3 * (size_t)n * sizeof *xyz);
        f = ldl_make(a, &o, "quasi-definite");
        memset(xyz, 0xff, 3 * (size_t)n * sizeof *xyz);
        free(xyz);                               /* not looked at again */
        CHECK(hd_ldl_factor(f, val, &rep, NULL) == HD_OK);
        CHECK_MSG(rep.n_negative == negative, "n %d: %d negative pivots, %d negative eigenvalues", (int)n, (int)rep.n_negative, (int)negative);
        CHECK(hd_ldl_solve(f, 3, p.c, 0, p.y, 0, NULL) == HD_OK);
        for (k = 0; k < 3; k++) {
            const double back = ldl_backward_real(a, val, p.c + k * n, p.y + k * n);
            CHECK_MSG(back <= 1e-14 * fmax(1, rep.growth), "n %d: backward error %g, growth %g", (int)n, back, rep.growth);
        }
        hd_ldl_free(f);
    }
}

static void ldl_quasidefinite(void) {
    int32_t n;
    for (n = 1; n <= 90; n += n < 12 ? 1 : 13) ldl_quasidefinite_of(n, (uint64_t)n);
}

/* ---- how solves may be called ---- */

/* Columns of b and of x so far apart (0: the first for all, or close together), in place or not. */
enum { LDL_FORM_N = 61, LDL_FORM_PAD = 70 };
typedef struct ldl_form { int w, ldb, ldx, in_place; } ldl_form;

/* Real numbers (w = 1) or complex ones (w = 2) of the first k columns. */
static hd_status ldl_solve_as(hd_ldl *f, int w, int32_t k, const double *b, int ldb, double *x, int ldx) {
    if (w == 1) return hd_ldl_solve(f, k, b, (size_t)ldb, x, (size_t)ldx, NULL);
    return hd_ldl_solve_complex(f, (const hd_c64 *)b, (size_t)ldb, (hd_c64 *)x, (size_t)ldx, NULL);
}

/* One form against the bits of want, which has its columns PAD apart; what does not belong to a column stays as it was. */
static void ldl_form_one(hd_ldl *f, const ldl_form *form, int32_t k, const double *b, const double *want, double *y) {
    const int w = form->w, ldx = form->ldx ? form->ldx : LDL_FORM_N;
    const size_t size = (size_t)w * LDL_FORM_N * sizeof *y;
    int32_t q, i;
    for (i = 0; i < w * LDL_FORM_PAD * LDL_SIDES; i++) y[i] = -77;
    for (q = 0; form->in_place && q < (form->ldb ? k : 1); q++) memcpy(y + w * form->ldb * q, b + w * LDL_FORM_PAD * q, size);
    CHECK(ldl_solve_as(f, w, k, form->in_place ? y : b, form->ldb, y, form->ldx) == HD_OK);
    for (q = 0; q < k; q++)
        CHECK_MSG(memcmp(y + w * ldx * q, want + w * LDL_FORM_PAD * q, size) == 0, "column %d of %d: %d and %d apart, in place %d, other bits", (int)q, (int)k,
                  form->ldb, form->ldx, form->in_place);
    if (form->in_place) return;
    for (i = 0; i < w * LDL_FORM_PAD * LDL_SIDES; i++)
        if (i / w % ldx >= LDL_FORM_N || i / w / ldx >= k) CHECK_MSG(y[i] == -77, "written at %d", (int)i);
}

static void ldl_forms(void) {
    enum { N = LDL_FORM_N, PAD = LDL_FORM_PAD, MOST = 9 };
    static const ldl_form forms[] = {
        {1, PAD, PAD, 0}, {1, PAD, 0, 0}, {1, PAD, PAD, 1}, {1, N, PAD, 1}, {1, PAD, N, 1},
        {2, PAD, PAD, 0}, {2, PAD, 0, 0}, {2, PAD, PAD, 1}, {2, 0, PAD, 0}, {2, 0, PAD, 1},
    };
    ldl_problem p = ldl_random_problem(N, 4, MOST, 3);
    double *b = kit_random(2 * PAD * LDL_SIDES, 5), *copies = KIT_NEW(double, 2 * PAD * LDL_SIDES), *y = KIT_NEW(double, 2 * PAD * LDL_SIDES);
    double *each = KIT_NEW(double, 2 * PAD * LDL_SIDES), *same = KIT_NEW(double, 2 * PAD * LDL_SIDES);
    hd_ldl *f = ldl_make(&p.a, NULL, "forms");
    int32_t k, q;
    int w;
    size_t i;
    for (w = 1; f && w <= 2; w++) {
        for (q = 0; q < LDL_SIDES; q++) memcpy(copies + w * PAD * q, b, (size_t)(w * N) * sizeof *b);
        for (k = 1; k <= (w == 1 ? (int)LDL_SIDES : (int)MOST); k++) {
            CHECK((w == 1 ? hd_ldl_factor(f, p.real, NULL, NULL) : hd_ldl_factor_complex(f, k, p.val, NULL, NULL)) == HD_OK);
            CHECK(ldl_solve_as(f, w, k, b, PAD, each, PAD) == HD_OK && ldl_solve_as(f, w, k, copies, PAD, same, PAD) == HD_OK);
            for (q = 0; q < k; q++) {
                const hd_c64 *val = w == 1 ? ldl_complex(p.real, p.a.nnz) : p.val + q * p.a.nnz;
                const hd_c64 *rhs = w == 1 ? ldl_complex(b + PAD * q, N) : (const hd_c64 *)b + PAD * q;
                const hd_c64 *x = w == 1 ? ldl_complex(each + PAD * q, N) : (const hd_c64 *)each + PAD * q;
                CHECK_MSG(ldl_backward(&p.a, val, rhs, x) <= 1e-14 && ldl_off_dense(&p.a, val, rhs, x) <= 1e-10, "column %d of %d", (int)q, (int)k);
                if (w == 2) CHECK(ldl_backward(&p.a, val, (const hd_c64 *)b, (const hd_c64 *)same + PAD * q) <= 1e-14);
            }
            for (i = 0; i < sizeof forms / sizeof *forms; i++)
                if (forms[i].w == w) ldl_form_one(f, forms + i, k, b, forms[i].ldb ? each : same, y);
        }
    }
    hd_ldl_free(f);
}

/* A matrix has the same answer wherever in the sweep it stands, and whatever its companions. */
static void ldl_companions(void) {
    enum { N = 45, MOST = 9 };
    const ldl_problem p = ldl_random_problem(N, 5, MOST, 8);
    const int64_t nnz = p.a.nnz;
    hd_c64 *own = KIT_NEW(hd_c64, MOST * nnz), alone[N * MOST];
    hd_ldl *f = ldl_make(&p.a, NULL, "companions");
    int32_t k, q;
    for (q = 0; f && q < MOST; q++)
        CHECK(hd_ldl_factor_complex(f, 1, p.val + q * nnz, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, p.b, 0, alone + N * q, 0, NULL) == HD_OK);
    for (k = 2; f && k <= MOST; k++) {           /* the last k, backwards */
        for (q = 0; q < k; q++) memcpy(own + q * nnz, p.val + (MOST - 1 - q) * nnz, (size_t)nnz * sizeof *own);
        CHECK(hd_ldl_factor_complex(f, k, own, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, p.b, 0, p.x, 0, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(ldl_differ(p.x + N * q, alone + N * (MOST - 1 - q), N) <= 1e-10, "matrix %d of %d", (int)q, (int)k);
    }
    hd_ldl_free(f);
}

/* Of (i, j) and (j, i) one is read, whichever: where they differ, the answer is that of a symmetric matrix with either value. */
static void ldl_one_of_a_pair(void) {
    const ldl_problem p = ldl_random_problem(30, 5, 1, 21);
    const hd_csr *a = &p.a;
    const size_t size = (size_t)a->nnz * sizeof *p.val;
    hd_c64 *val = KIT_NEW(hd_c64, a->nnz), *other = KIT_NEW(hd_c64, a->nnz);
    int64_t q;
    int32_t i;
    int way;
    for (way = 0; way < 4; way += 3) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], p.perm, NULL, NULL);
        hd_ldl *f = ldl_make(a, &o, "one of a pair");
        for (i = 1; f && i < p.n; i++)
            for (q = a->row_ptr[i]; q < a->row_ptr[i + 1] && a->col[q] < i; q++) {
                double back;
                memcpy(val, p.val, size);
                memcpy(other, p.val, size);
                val[q].re += 0.01 * fabs(p.val[q].re);
                other[q] = other[op_find(a, a->col[q], i)] = val[q];
                CHECK(hd_ldl_factor_complex(f, 1, val, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, p.b, 0, p.x, 0, NULL) == HD_OK);
                back = fmin(ldl_backward(a, p.val, p.b, p.x), ldl_backward(a, other, p.b, p.x));
                CHECK_MSG(back <= 1e-14, "(%d, %d): backward error %g", (int)i, (int)a->col[q], back);
            }
        hd_ldl_free(f);
    }
}

/* ---- again and again ---- */

/* An analysis whose pattern and order are overwritten afterwards: they are not looked at again. Takes the pattern. */
static hd_ldl *ldl_make_alone(hd_csr a, const int32_t *order, hd_context *ctx) {
    const size_t size = (size_t)a.n_rows * sizeof *order;
    int32_t *perm = KIT_NEW(int32_t, a.n_rows);
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, ctx);
    hd_ldl *f;
    memcpy(perm, order, size);
    f = ldl_make(&a, &o, "alone");
    memset(perm, 0x77, size);
    memset(a.col, 0x77, (size_t)a.nnz * sizeof *a.col);
    memset(a.row_ptr, 0x77, ((size_t)a.n_rows + 1) * sizeof *a.row_ptr);
    a.nnz = 0;
    hd_csr_free(&a, NULL);
    return f;
}

/* New values on the same analysis, real and complex in turn: the same bits as from a fresh object, and memory only where there was none. */
static void ldl_refactor(void) {
    enum { N = 140, K = 6 };
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    int32_t *order = KIT_NEW(int32_t, N);
    uint64_t seed = 8, calls, bytes;
    hd_ldl_report rep[2];
    hd_ldl *f, *fresh;
    int round;
    dense_shuffle(order, N, &seed);
    f = ldl_make_alone(ldl_random_pattern(N, 4, 31), order, &ctx);
    for (round = 0; f && round < 4; round++) {
        const ldl_problem p = ldl_problem_of(ldl_random_pattern(N, 4, 31), K, (uint64_t)round + 1);
        ldl_problem again = p;
        again.x = KIT_NEW(hd_c64, K * N);
        again.y = KIT_NEW(double, LDL_SIDES * N);
        ldl_answer(f, &p, N, 2, rep);
        ldl_judge(&p, N, 2, 0, "refactor");
        if (round == 2) {                        /* the same again: no memory */
            calls = ctx.allocations;
            CHECK(hd_ldl_factor(f, p.real, rep, NULL) == HD_OK && hd_ldl_solve(f, 2, p.c, 0, again.y, 0, NULL) == HD_OK);
            CHECK(hd_ldl_solve(f, 1, p.c, 0, again.y, 0, NULL) == HD_OK);
            CHECK_MSG(ctx.allocations == calls, "real: %d allocations more", (int)(ctx.allocations - calls));
            CHECK(hd_ldl_factor_complex(f, K, p.val, rep, NULL) == HD_OK && hd_ldl_solve_complex(f, p.b, 0, again.x, 0, NULL) == HD_OK);
            calls = ctx.allocations;
            bytes = ctx.bytes_in_use;
            CHECK(hd_ldl_factor_complex(f, K, p.val, rep, NULL) == HD_OK && hd_ldl_solve_complex(f, p.b, 0, again.x, 0, NULL) == HD_OK);
            CHECK(hd_ldl_solve_complex(f, p.b, N, again.x, 0, NULL) == HD_OK);
            CHECK_MSG(ctx.allocations == calls && m.calls == (int64_t)calls && ctx.bytes_in_use == bytes, "complex: %d allocations more",
                      (int)(ctx.allocations - calls));
        }
        fresh = ldl_make_alone(ldl_random_pattern(N, 4, 31), order, &ctx);
        ldl_answer(fresh, &again, N, 2, rep);
        CHECK_MSG(memcmp(p.x, again.x, K * N * sizeof *p.x) == 0 && memcmp(p.y, again.y, 2 * N * sizeof *p.y) == 0, "round %d: other bits", round);
        hd_ldl_free(fresh);
    }
    hd_ldl_free(f);
    test_memory_done(&m, &ctx, "refactor");
}

/* More matrices, then fewer, then more. */
static void ldl_other_counts(void) {
    static const int32_t counts[7] = {3, 9, 1, 4, 5, 8, 2};
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_csr a = kit_own_csr(ldl_random_pattern(50, 4, 41));
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_AUTO, NULL, NULL, &ctx);
    hd_ldl *f = ldl_make(&a, &o, "counts");
    int k;
    for (k = 0; k < 7; k++) {
        const ldl_problem p = ldl_random_problem(50, 4, counts[k], 41);
        ldl_ask(f, &p, HD_ORDERING_AUTO, 3, 1, "counts");
    }
    hd_ldl_free(f);
    test_memory_done(&m, &ctx, "counts");
}

/* ---- threads and instructions ---- */

#ifdef LDL_THREADS
enum { LDL_POOL = 3 };

/* A loop shared by the caller and three more threads that come and go with it. */
typedef struct ldl_pool {
    pthread_mutex_t lock;
    pthread_t caller;
    int64_t n_tasks, next, loops, elsewhere;    /* elsewhere: progress calls by other threads than the caller */
    hd_task task;
    void *arg;
} ldl_pool;

typedef struct ldl_seat { ldl_pool *pool; int32_t worker; } ldl_seat;

static void *ldl_pool_work(void *arg) {
    const ldl_seat *seat = (const ldl_seat *)arg;
    ldl_pool *p = seat->pool;
    for (;;) {
        int64_t i;
        pthread_mutex_lock(&p->lock);
        i = p->next++;
        pthread_mutex_unlock(&p->lock);
        if (i >= p->n_tasks) return NULL;
        p->task(p->arg, i, seat->worker);
    }
}

static void ldl_threaded_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    ldl_pool *p = (ldl_pool *)user;
    ldl_seat seat[LDL_POOL + 1];
    pthread_t thread[LDL_POOL];
    int k, made = 0;
    p->n_tasks = n_tasks;
    p->next = 0;
    p->loops++;
    p->task = task;
    p->arg = arg;
    for (k = 0; k <= LDL_POOL; k++) {
        seat[k].pool = p;
        seat[k].worker = k;
    }
    while (made < LDL_POOL && pthread_create(thread + made, NULL, ldl_pool_work, seat + made + 1) == 0) made++;
    ldl_pool_work(seat);
    for (k = 0; k < made; k++) pthread_join(thread[k], NULL);
}

static hd_progress ldl_thread_progress(void *user, const char *stage, double done) {
    ldl_pool *p = (ldl_pool *)user;
    if (!pthread_equal(pthread_self(), p->caller) || !stage || !(done >= 0 && done <= 1)) p->elsewhere++;
    return HD_PROGRESS_CONTINUE;
}
#endif

enum { LDL_WAYS = 8 };

typedef struct ldl_way {
    hd_context ctx;
    int64_t calls;
#ifdef LDL_THREADS
    ldl_pool pool;
#endif
} ldl_way;

/* The library's threads: one, all, two, three; a user's: backwards, shuffled, real threads; nine of the library's. w must stay where it is. */
static void ldl_way_begin(ldl_way *w, int way, hd_simd simd) {
    memset(w, 0, sizeof *w);
    w->ctx.simd = simd;
    w->ctx.n_threads = way == 1 ? 0 : way == 2 ? 2 : way == 3 ? 3 : way == 7 ? 9 : 1;
    w->ctx.parallel_user = &w->calls;
    if (way == 4) w->ctx.parallel_for = sparse_reverse_for;
    if (way == 5) w->ctx.parallel_for = heat_shuffled_for;
#ifdef LDL_THREADS
    if (way != 6) return;
    CHECK(pthread_mutex_init(&w->pool.lock, NULL) == 0);
    w->pool.caller = pthread_self();
    w->ctx.parallel_for = ldl_threaded_for;
    w->ctx.parallel_user = w->ctx.progress_user = &w->pool;
    w->ctx.progress = ldl_thread_progress;
#endif
}

static void ldl_way_end(ldl_way *w, int way) {
    CHECK(w->ctx.bytes_in_use == 0 && !w->ctx.threads && w->ctx.n_holders == 0);
#ifdef LDL_THREADS
    if (way != 6) return;
    CHECK_MSG(w->pool.elsewhere == 0, "%lld wrong calls of progress", (long long)w->pool.elsewhere);
    pthread_mutex_destroy(&w->pool.lock);
#else
    (void)way;
#endif
}

/* Whatever the library answers, in one way of threading; how often it asked for a loop. */
static int64_t ldl_thread_run(const ldl_problem *p, int points, hd_ordering ordering, hd_simd simd, int way, hd_ldl_report rep[2]) {
    ldl_way *w = KIT_NEW(ldl_way, 1);
    hd_ldl_opts o;
    hd_ldl *f;
    ldl_way_begin(w, way, simd);
    o = ldl_opts_of(ordering, NULL, points ? p->xyz : NULL, &w->ctx);
    f = ldl_make(&p->a, &o, "threads");
    ldl_answer(f, p, 0, p->k, rep);
    hd_ldl_free(f);
    ldl_way_end(w, way);
#ifdef LDL_THREADS
    return w->calls + w->pool.loops;
#else
    return w->calls;
#endif
}

static int ldl_same_report(const hd_ldl_report *a, const hd_ldl_report *b) {
    return a->ordering == b->ordering && a->n_supernodes == b->n_supernodes && a->n_matrices == b->n_matrices && a->factor_nnz == b->factor_nnz &&
           a->stored == b->stored && a->factor_flops == b->factor_flops && a->growth == b->growth && a->smallest_pivot == b->smallest_pivot &&
           a->n_negative == b->n_negative;
}

/* All ways of threading give the same bits, at every level of instructions; levels differ by rounding only. xyz NULL: no points. */
static void ldl_threads_of(hd_csr a, const double *xyz, hd_ordering ordering, int32_t k, const char *what) {
    ldl_problem first = ldl_problem_of(a, k, 3), other = first;
    const size_t size = (size_t)k * (size_t)a.n_rows;
    hd_c64 *top = KIT_NEW(hd_c64, size);
    hd_ldl_report rep[2], again[2];
    int64_t calls = 0;
    int way, level;
    other.x = KIT_NEW(hd_c64, size);
    other.y = KIT_NEW(double, LDL_SIDES * (int64_t)a.n_rows);
    if (xyz) memcpy(first.xyz, xyz, 3 * (size_t)a.n_rows * sizeof *xyz);
    for (level = 0; level < 4; level++) {
        ldl_thread_run(&first, xyz != NULL, ordering, ldl_simds[level], 0, rep);
        ldl_judge(&first, 0, k, 0, what);
        if (level == 0) memcpy(top, first.x, size * sizeof *top);
        CHECK_MSG(ldl_differ(first.x, top, (int64_t)size) <= 1e-9, "%s: level %d is off by %g", what, level, ldl_differ(first.x, top, (int64_t)size));
        for (way = level > 1 ? 4 : 1; way < LDL_WAYS; way++) {
            calls += ldl_thread_run(&other, xyz != NULL, ordering, ldl_simds[level], way, again);
            CHECK_MSG(memcmp(first.x, other.x, size * sizeof *top) == 0 && memcmp(first.y, other.y, size * sizeof *first.y) == 0,
                      "%s: way %d of threading gives other bits, level %d", what, way, level);
            CHECK_MSG(ldl_same_report(rep, again) && ldl_same_report(rep + 1, again + 1), "%s: way %d: another report", what, way);
        }
    }
    CHECK_MSG(calls > 0 || a.n_rows < 1000, "%s: never in parallel", what);
}

static void ldl_threads(void) {
    const shape *ball = kit_shape("bumpy/4/3");
    ldl_threads_of(ldl_mesh_pattern(ball), ball->xyz, HD_ORDERING_NESTED_DISSECTION, 5, "mesh, nested dissection");
    ldl_threads_of(ldl_mesh_pattern(ball), NULL, HD_ORDERING_MINIMUM_DEGREE, 2, "mesh, minimum degree");
    ldl_threads_of(ldl_shape(LDL_PIECES, 3000, 1, 1), NULL, HD_ORDERING_AUTO, 4, "pieces");
    ldl_threads_of(ldl_shape(LDL_DENSE, 310, 1, 1), NULL, HD_ORDERING_AUTO, 3, "dense");    /* one front, larger than what one task takes */
}

/* ---- pivots that fail ---- */

/* A row that stands alone: its pivot is its entry. */
static void ldl_pivot_errors_of(hd_ordering ordering, int32_t n, uint64_t seed) {
    enum { K = 7 };
    const int32_t zero = ldl_below(&seed, n);
    ldl_edges g = ldl_edges_of(n);
    ldl_problem p;
    hd_ldl_opts o;
    hd_ldl_report rep[2];
    hd_ldl *f;
    hd_error e;
    int64_t diag;
    int32_t i, bad;
    for (i = 0; i < 3 * n; i++) {
        const int32_t u = ldl_below(&seed, n), v = ldl_below(&seed, n);
        if (u != zero && v != zero) ldl_join(&g, u, v);
    }
    p = ldl_problem_of(ldl_pattern(&g, 1), K, seed);
    o = ldl_opts_of(ordering, p.perm, p.xyz, NULL);
    f = ldl_make(&p.a, &o, "pivots");
    diag = op_find(&p.a, zero, zero);
    p.real[diag] = 0;
    CHECK(hd_ldl_factor(f, p.real, rep, &e) == HD_ERR_BREAKDOWN && e.status == HD_ERR_BREAKDOWN);
    CHECK_MSG(e.row == zero && e.value == 0 && e.pole == -1, "row %d instead of %d, pivot %g, pole %d", (int)e.row, (int)zero, e.value, (int)e.pole);
    CHECK(hd_ldl_solve(f, 1, p.c, 0, p.y, 0, &e) == HD_ERR_ARGUMENT);
    p.real[diag] = 2;
    for (bad = 0; bad < K; bad++) {              /* in either sweep of four, and last of all */
        p.val[bad * p.a.nnz + diag] = test_c(0, 0);
        CHECK(hd_ldl_factor_complex(f, K, p.val, rep, &e) == HD_ERR_BREAKDOWN && e.status == HD_ERR_BREAKDOWN);
        CHECK_MSG(e.row == zero && e.pole == bad && e.value == 0, "row %d, pole %d instead of %d, %d", (int)e.row, (int)e.pole, (int)zero, (int)bad);
        CHECK(hd_ldl_solve_complex(f, p.b, 0, p.x, 0, &e) == HD_ERR_ARGUMENT);
        p.val[bad * p.a.nnz + diag] = test_c(0, -1e-3);
    }
    ldl_answer(f, &p, 0, 1, rep);
    ldl_judge(&p, 0, 1, 0, "after pivots of zero");
    hd_ldl_free(f);
}

static void ldl_pivot_errors(void) {
    static const int32_t sizes[4] = {40, 25, 77, 33};
    int k;
    for (k = 0; k < 4; k++) ldl_pivot_errors_of(ldl_orderings[k], sizes[k], (uint64_t)(k + 3));
}

/* Values that are no numbers, told by their place: on the diagonal, off it, in each matrix. */
static void ldl_not_finite(void) {
    enum { N = 23, K = 6 };
    const double wrong[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    const ldl_problem p = ldl_random_problem(N, 4, K, 5);
    const hd_csr *a = &p.a;
    hd_ldl *f = ldl_make(a, NULL, "not finite");
    hd_error e;
    int32_t i, q;
    int64_t at;
    for (i = 0; f && i < N; i++)
        for (at = a->row_ptr[i]; at < a->row_ptr[i + 1] && a->col[at] <= i; at++) {
            const int32_t j = a->col[at];
            const int64_t mirror = op_find(a, j, i);
            const double good = p.real[at];
            p.real[at] = p.real[mirror] = wrong[(i + j) % 3];
            CHECK(hd_ldl_factor(f, p.real, NULL, &e) == HD_ERR_NOT_FINITE && e.status == HD_ERR_NOT_FINITE);
            CHECK_MSG((e.row == i && e.column == j) || (e.row == j && e.column == i), "(%d, %d), not (%d, %d)", (int)e.row, (int)e.column, (int)i, (int)j);
            p.real[mirror] = good;               /* in the lower triangle alone */
            p.real[at] = wrong[(i + j) % 3];
            CHECK_MSG(hd_ldl_factor(f, p.real, NULL, &e) == HD_ERR_NOT_FINITE && e.row == i && e.column == j, "(%d, %d), not (%d, %d)", (int)e.row,
                      (int)e.column, (int)i, (int)j);
            p.real[at] = good;
            for (q = 0; q < K; q += 1 + (i + j) % 3) {
                hd_c64 *z = p.val + q * a->nnz + at;
                const hd_c64 keep = *z;
                *((i + q) % 2 ? &z->re : &z->im) = wrong[q % 3];
                CHECK_MSG(hd_ldl_factor_complex(f, K, p.val, NULL, &e) == HD_ERR_NOT_FINITE && e.status == HD_ERR_NOT_FINITE && e.pole == q && e.row == i &&
                          e.column == j, "(%d, %d), not (%d, %d); pole %d, not %d", (int)e.row, (int)e.column, (int)i, (int)j, (int)e.pole, (int)q);
                *z = keep;
            }
        }
    ldl_ask(f, &p, HD_ORDERING_AUTO, K, 1, "after values that were not finite");
    hd_ldl_free(f);
}

/* A pivot is divided by if its inverse is a number, else named, wherever it stands. */
static void ldl_subnormal(void) {
    enum { N = 30 };
    static const double pivots[5] = {1e-307, -1e-308, 1e-309, -1e-310, 5e-324};
    hd_csr a = kit_own_csr(ldl_shape(LDL_BAND, N, 1, 1));
    double *val = KIT_NEW(double, a.nnz), b[N], x[N];
    hd_c64 *z = KIT_NEW(hd_c64, a.nnz);
    hd_ldl *f = ldl_make(&a, NULL, "subnormal");
    hd_error e;
    int32_t i, q;
    int64_t p;
    TRAPS_OFF;                                   /* inverses overflow */
    for (i = 0; i < N; i++) val[op_find(&a, i, i)] = b[i] = 1;
    for (i = 0; f && i < N; i++) {
        const int64_t at = op_find(&a, i, i);
        b[i] = 1e-5;
        for (q = 0; q < 5; q++) {
            const hd_status want = q < 2 ? HD_OK : HD_ERR_BREAKDOWN;
            val[at] = pivots[q];
            for (p = 0; p < a.nnz; p++) z[p].re = z[p].im = val[p];
            z[at].im = 0;
            CHECK_MSG(hd_ldl_factor(f, val, NULL, &e) == want && (q < 2 || (e.row == i && e.value == pivots[q])), "%g in row %d: %s, row %d",
                      pivots[q], (int)i, hd_status_name(e.status), (int)e.row);
            if (q < 2) CHECK(hd_ldl_solve(f, 1, b, 0, x, 0, &e) == HD_OK && fabs(x[i] * pivots[q] / b[i] - 1) < 1e-15);
            CHECK(hd_ldl_factor_complex(f, 1, z, NULL, &e) == want && (q < 2 || e.row == i));
        }
        val[at] = b[i] = 1;
    }
    TRAPS_ON;
    hd_ldl_free(f);
}

/* Two zeros far from each other: the one that is eliminated first is told, whatever threads do. */
static void ldl_first_of_two(void) {
    enum { N = 40000 };                          /* many subtrees */
    const ldl_problem p = ldl_problem_of(ldl_shape(LDL_PIECES, N, 1, 1), 1, 1);
    int32_t i;
    int way;
    p.real[op_find(&p.a, 35000, 35000)] = p.real[op_find(&p.a, 700, 700)] = 0;    /* multiples of five: alone, or the first of their piece */
    for (i = 0; i < N; i++) p.perm[i] = i;
    for (way = 0; way < LDL_WAYS; way++) {
        ldl_way *w = KIT_NEW(ldl_way, 1);
        hd_ldl_opts o;
        hd_ldl *f;
        hd_error e;
        ldl_way_begin(w, way, HD_SIMD_AUTO);
        o = ldl_opts_of(HD_ORDERING_OWN, p.perm, NULL, &w->ctx);
        f = ldl_make(&p.a, &o, "two zeros");
        CHECK_MSG(hd_ldl_factor(f, p.real, NULL, &e) == HD_ERR_BREAKDOWN && e.row == 700, "way %d of threading says row %d", way, (int)e.row);
        hd_ldl_free(f);
        ldl_way_end(w, way);
    }
}

/* ---- memory and cancelling ---- */

/* Attempt k of a factorisation that runs out of memory, or is cancelled, in the first one of the object or a later: not to be solved with,
 * but to be factored again, with the bits of want. k = 0: what these are. Whether it was stopped. */
static int ldl_survives_at(const ldl_problem *p, hd_c64 *want, int cancel, int before, int reverse, int64_t k) {
    const size_t size = (size_t)p->k * (size_t)p->n * sizeof *want;
    int64_t calls = 0;
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_NESTED_DISSECTION, NULL, p->xyz, &ctx);
    rob_progress progress;
    hd_ldl *f;
    hd_error e;
    hd_status st = HD_OK;
    ctx.parallel_user = &calls;
    if (reverse) ctx.parallel_for = sparse_reverse_for;
    f = ldl_make(&p->a, &o, "survives");
    if (before == 1) CHECK(hd_ldl_factor_complex(f, p->k, p->val, NULL, NULL) == HD_OK);
    if (before == 2) CHECK(hd_ldl_factor(f, p->real, NULL, NULL) == HD_OK);
    if (cancel) rob_watch(&progress, &ctx, k);
    else if (k) m.fail_at = m.calls + k;
    if (k) {
        st = hd_ldl_factor_complex(f, p->k, p->val, NULL, &e);
        CHECK_MSG((st == HD_OK || st == (cancel ? HD_ERR_CANCELLED : HD_ERR_MEMORY)) && e.status == st, "%s", hd_status_name(st));
    }
    ctx.progress = NULL;
    m.fail_at = 0;
    if (st < 0) CHECK(hd_ldl_solve_complex(f, p->b, 0, p->x, 0, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_ldl_factor_complex(f, p->k, p->val, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, p->b, 0, p->x, 0, NULL) == HD_OK);
    if (k) CHECK_MSG(memcmp(p->x, want, size) == 0, "after failure %lld: other bits", (long long)k);
    else memcpy(want, p->x, size);
    hd_ldl_free(f);
    test_memory_done(&m, &ctx, "survives");
    return st < 0;
}

static void ldl_survives(void) {
    const shape *ball = kit_shape("bumpy/2/4");
    ldl_problem p = ldl_problem_of(ldl_mesh_pattern(ball), 5, 3);
    hd_c64 *want = KIT_NEW(hd_c64, p.k * p.n);
    int way;
    memcpy(p.xyz, ball->xyz, 3 * (size_t)p.n * sizeof *p.xyz);
    for (way = 0; way < 6; way++) {
        const int cancel = way % 2, before = way / 2;
        const int64_t passed = test_passed;
        int64_t k = 1;
        ldl_survives_at(&p, want, cancel, before, (cancel + before) % 2, 0);
        while (k < ROB_MOST && ldl_survives_at(&p, want, cancel, before, (cancel + before) % 2, k)) k++;
        CHECK_MSG(k < ROB_MOST && (k > 1 || (!cancel && before == 1)), "stopped at %lld", (long long)k);
        test_count_once(passed);
    }
}

/* An analysis that is cancelled at each call of progress in turn, by each ordering. */
static void ldl_cancelled(void) {
    const shape *ball = kit_shape("bumpy/2/4");
    const hd_csr a = kit_own_csr(ldl_mesh_pattern(ball));
    int way;
    for (way = 0; way < 3; way++) {
        const int64_t passed = test_passed;
        hd_status st = HD_ERR_CANCELLED;
        int64_t k;
        for (k = 1; k < ROB_MOST && st == HD_ERR_CANCELLED; k++) {
            test_memory m;
            hd_context ctx = test_memory_context(&m);
            hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], NULL, ball->xyz, &ctx);
            hd_ldl *f = ldl_mark;
            rob_progress progress;
            hd_error e;
            rob_watch(&progress, &ctx, k);
            st = hd_ldl_analyse(&f, &a, &o, NULL, &e);
            CHECK((st == HD_OK || st == HD_ERR_CANCELLED) && e.status == st && (st == HD_OK) == (f != ldl_mark));
            if (st == HD_OK) hd_ldl_free(f);
            test_memory_done(&m, &ctx, "cancelled");
        }
        CHECK_MSG(st == HD_OK && k > 3, "ordering %d: %s after %d", way, hd_status_name(st), (int)k);
        test_count_once(passed);
    }
}

/* ---- arguments ---- */

/* Patterns that are none: what is wrong, and where. */
static void ldl_bad_patterns(void) {
    static const struct { int at, to; hd_status want; int32_t row, column; } rows[] = {    /* col[at] = to; 6: the columns, 7: ptr[1] */
        {0, 0, HD_ERR_NOT_SYMMETRIC, 1, 2}, {6, 4, HD_ERR_NOT_SYMMETRIC, 3, 4}, {4, 2, HD_ERR_STRUCTURE, 2, 2},    /* 2 twice */
        {4, 3, HD_ERR_INDEX, 2, 3}, {7, 5, HD_ERR_STRUCTURE, 1, -1},
    };
    hd_ldl *f = ldl_mark;
    hd_error e;
    size_t k;
    for (k = 0; k < 2 * sizeof rows / sizeof *rows; k++) {
        const int at = rows[k / 2].at, to = rows[k / 2].to;
        int64_t ptr[4] = {0, 2, 4, 6};
        int32_t col[6] = {0, 1, 0, 1, 1, 2};     /* (2, 1) has no partner, though its value is zero */
        double val[6] = {1, 2, 2, 1, 0, 1};
        hd_csr a = sparse_view(3, 3, 6, ptr, col, k % 2 ? NULL : val);
        if (at < 6) col[at] = to;
        if (at == 6) a.n_cols = to;
        if (at == 7) ptr[1] = to;
        CHECK(hd_ldl_analyse(&f, &a, NULL, NULL, &e) == rows[k / 2].want && e.status == rows[k / 2].want && f == ldl_mark);
        CHECK_MSG((e.row == rows[k / 2].row && e.column == rows[k / 2].column) || (k < 2 && e.row == 2 && e.column == 1), "pattern %d: (%d, %d)", (int)k,
                  (int)e.row, (int)e.column);
    }
}

static void ldl_bad_options(void) {
    enum { N = 10 };
    const double wrong[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    const ldl_problem p = ldl_problem_of(test_path_csr(N, 1), 1, 1);
    hd_ldl_opts o;
    hd_ldl *f = ldl_mark;
    hd_error e;
    int32_t i;
#define LDL_BAD(ordering, perm, xyz, st)                                                                               \
    o = ldl_opts_of((hd_ordering)(ordering), perm, xyz, NULL);                                                         \
    CHECK_MSG(hd_ldl_analyse(&f, &p.a, &o, NULL, &e) == st && e.status == st && e.text[0] && f == ldl_mark, "%s", hd_status_name(e.status))
    LDL_BAD(4, NULL, NULL, HD_ERR_ARGUMENT);
    LDL_BAD(99, NULL, NULL, HD_ERR_ARGUMENT);
    LDL_BAD(HD_ORDERING_OWN, NULL, p.xyz, HD_ERR_ARGUMENT);
    LDL_BAD(HD_ORDERING_NESTED_DISSECTION, p.perm, NULL, HD_ERR_ARGUMENT);
    for (i = 0; i < 3; i++) {                    /* there already, beyond the rows, negative */
        const int32_t keep = p.perm[7];
        p.perm[7] = i == 0 ? p.perm[3] : i == 1 ? N : -1;
        LDL_BAD(HD_ORDERING_OWN, p.perm, NULL, HD_ERR_INDEX);
        CHECK_MSG(e.row == 7 && e.value == p.perm[7], "row %d, value %g", (int)e.row, e.value);
        p.perm[7] = keep;
    }
    for (i = 0; i < 6; i++) {                    /* coordinates: refused, or of any size */
        p.xyz[5 * i + 2] = wrong[i % 3];
        LDL_BAD(i < 3 ? HD_ORDERING_NESTED_DISSECTION : HD_ORDERING_AUTO, NULL, p.xyz, HD_ERR_NOT_FINITE);
        CHECK_MSG(e.row == (5 * i + 2) / 3 && e.column == (5 * i + 2) % 3, "row %d, column %d", (int)e.row, (int)e.column);
        p.xyz[5 * i + 2] = i % 2 ? DBL_MAX : -DBL_MAX;
    }
#undef LDL_BAD
    for (i = 0; i < N; i++) p.a.val[i] = (double)NAN;    /* values are not looked at */
    for (i = 2; i < 4; i++) {
        o = ldl_opts_of(ldl_orderings[i], p.perm, p.xyz, NULL);
        hd_ldl_free(ldl_make(&p.a, &o, "good options"));
    }
}

/* Solves need a factorisation, of their kind, the last one, and one that went well. */
static void ldl_bad_solves(void) {
    enum { N = 6 };
    const ldl_problem p = ldl_problem_of(test_path_csr(N, 1), 2, 1);
    hd_ldl *f = ldl_make(&p.a, NULL, "calls");
    hd_error e;
    int step;
    for (step = 0; step < 6; step++) {           /* nothing, real, complex, real, real that fails, complex that fails */
        const int real = step == 1 || step == 3 || step == 4, fails = step > 3;
        hd_status want = HD_OK;
        if (step == 4) p.real[0] = (double)NAN;
        if (step == 5) p.val[3 * N].im = (double)INFINITY;
        if (fails) want = HD_ERR_NOT_FINITE;
        if (real) CHECK(hd_ldl_factor(f, p.real, NULL, &e) == want);
        else if (step) CHECK(hd_ldl_factor_complex(f, 2, p.val, NULL, &e) == want && (!fails || e.pole == 1));
        want = hd_ldl_solve(f, 3, p.c, 0, p.y, N, &e);
        CHECK(want == (real && !fails ? HD_OK : HD_ERR_ARGUMENT) && e.status == want && (want == HD_OK || e.text[0]));
        want = hd_ldl_solve_complex(f, p.b, N, p.x, N, &e);
        CHECK(want == (step == 2 ? HD_OK : HD_ERR_ARGUMENT) && e.status == want && (want == HD_OK || e.text[0]));
        if (step == 3) ldl_judge(&p, N, 3, 1, "calls");
    }
    hd_ldl_free(f);
}

/* ---- meshes ---- */

/* t L + theta B of a mesh for four poles at once, and the real t L + B, by all orderings; coordinates, or all rows at one point. */
static void ldl_mesh_of(const shape *s, const hd_laplacian *lap, int flat, const char *what) {
    enum { K = 4 };
    const int32_t n = lap->n_active;
    const double t = 100 * lap->h * lap->h;
    hd_csr copy;
    ldl_problem p;
    hd_rational set;
    int32_t i, k;
    int64_t q;
    int way;
    copy = test_csr_ordered(&lap->L, NULL);
    p = ldl_problem_of(copy, K, 1);
    CHECK(hd_rational_exp(&set, HD_POLES_KERNEL, 2 * K, NULL) == HD_OK && set.n_poles == K);
    for (k = 0, p.growth = 0; k < K; k++) p.growth = fmax(p.growth, ldl_growth_bound(set.theta[k]));
    memset(p.xyz, 0, 3 * (size_t)n * sizeof *p.xyz);
    for (i = 0; i < n; i++) {
        if (!flat) memcpy(p.xyz + 3 * i, s->xyz + 3 * lap->vertex[i], 3 * sizeof *p.xyz);
        for (q = lap->L.row_ptr[i]; q < lap->L.row_ptr[i + 1]; q++) {
            const double l = t * lap->L.val[q], m = lap->B ? lap->B[q] : lap->L.col[q] == i ? lap->mass[i] : 0;
            for (k = 0; k < K; k++) p.val[k * lap->L.nnz + q] = test_c(l + set.theta[k].re * m, set.theta[k].im * m);
            p.real[q] = l + m;
        }
    }
    for (way = 0; way < 3; way++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], NULL, p.xyz, NULL);
        hd_ldl *f = ldl_make(&p.a, &o, what);
        hd_ldl_report rep;
        ldl_ask(f, &p, o.ordering, 2, 0, what);
        CHECK(hd_ldl_factor(f, p.real, &rep, NULL) == HD_OK);
        if (!flat) CHECK_MSG(rep.factor_nnz < 75 * (int64_t)n, "%s, ordering %d: %g non-zeros a row", what, way, (double)rep.factor_nnz / n);
        hd_ldl_free(f);
    }
}

/* Nested dissection of graphs with and without a use of it: every small size, and meshes whose leaves have many neighbours. */
static void ldl_dissections(void) {
    const int32_t mark = kit_mark();
    int32_t n, k;
    for (n = 1; n < 420; n += n < 40 ? 1 : 29)
        for (k = 0; k < 3; k++) {
            const shape grid = kit_own_shape(shape_grid(2 + n / 9, 8, 0.3));
            const ldl_problem p = ldl_problem_of(k == 2 ? ldl_mesh_pattern(&grid) : k ? ldl_random_pattern(n, 9, (uint64_t)n) :
                                                 ldl_shape(LDL_PIECES, n, 1, 1), 1, (uint64_t)(n + k));
            hd_ldl_opts o = ldl_opts_of(HD_ORDERING_NESTED_DISSECTION, NULL, k == 2 ? grid.xyz : p.xyz, NULL);
            hd_ldl *f = ldl_make(&p.a, &o, "dissection");
            ldl_ask(f, &p, o.ordering, 1, 0, "dissection");
            hd_ldl_free(f);
            kit_release(mark);
        }
}

static void ldl_meshes(void) {
    const double offset[3] = {4, 0, 0};
    const shape *grid = kit_shape("flat/141/141/0.3"), *plate = kit_shape("flat/20/30/0.2");
    const shape two = kit_own_shape(shape_disjoint(kit_shape("bumpy/3/1"), plate, offset));
    ldl_mesh_of(grid, kit_pair("flat/141/141/0.3 fem"), 0, "grid of 20 thousand");
    ldl_mesh_of(&two, kit_triangles(&two, HD_LAPLACIAN_VORONOI_COT), 0, "two pieces");
    ldl_mesh_of(plate, kit_pair("flat/20/30/0.2 cot"), 1, "all rows at one point");    /* nothing to dissect by, and still right */
}

static void test_ldl(void) {
    ldl_by_hand();
    ldl_two();
    ldl_none();
    ldl_diagonal();
    ldl_growth_of_tables();
    ldl_all_shapes();
    ldl_all_random();
    ldl_all_dense();
    ldl_own_orders();
    ldl_fill_is_low();
    ldl_quasidefinite();
    ldl_forms();
    ldl_companions();
    ldl_one_of_a_pair();
    ldl_refactor();
    ldl_other_counts();
    ldl_threads();
    ldl_pivot_errors();
    ldl_not_finite();
    ldl_subnormal();
    ldl_first_of_two();
    ldl_survives();
    ldl_cancelled();
    ldl_bad_patterns();
    ldl_bad_options();
    ldl_bad_solves();
    ldl_dissections();
    ldl_meshes();
}

#endif
