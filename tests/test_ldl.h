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
        const int64_t room = 2 * g->room + 64;
        int32_t *i = DENSE_NEW(int32_t, room), *j = DENSE_NEW(int32_t, room);
        if (g->count) memcpy(i, g->i, (size_t)g->count * sizeof *i);
        if (g->count) memcpy(j, g->j, (size_t)g->count * sizeof *j);
        free(g->i);
        free(g->j);
        g->i = i;
        g->j = j;
        g->room = room;
    }
    g->i[g->count] = a;
    g->j[g->count++] = b;
    g->i[g->count] = b;
    g->j[g->count++] = a;
}

/* The pattern without values; with every diagonal entry, or with none. Takes the edges. */
static hd_csr ldl_pattern(ldl_edges *g, int diagonal) {
    const int64_t all = g->count + (diagonal ? g->n : 0);
    int32_t *i = DENSE_NEW(int32_t, all), *j = DENSE_NEW(int32_t, all), k;
    hd_csr a;
    hd_error e;
    if (g->count) memcpy(i, g->i, (size_t)g->count * sizeof *i);
    if (g->count) memcpy(j, g->j, (size_t)g->count * sizeof *j);
    for (k = 0; diagonal && k < g->n; k++) i[g->count + k] = j[g->count + k] = k;
    memset(&a, 0, sizeof a);
    CHECK(hd_csr_from_triplets(&a, g->n, g->n, all, i, j, NULL, NULL, &e) == HD_OK);
    free(i);
    free(j);
    free(g->i);
    free(g->j);
    memset(g, 0, sizeof *g);
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
    CHECK(hd_rational_get(&set, kind, degree, NULL) == HD_OK);
    z = set.theta[ldl_below(seed, set.n_poles)];
    if (dense_random(seed) % 2) z.im = -z.im;
    return z;
}

/* 1 / cos^2(arg theta / 2): how far pivots of t L + theta B may exceed the diagonal. */
static double ldl_growth_bound(hd_c64 theta) { return 2 / (1 + theta.re / hypot(theta.re, theta.im)); }

static void ldl_growth_of_tables(void) {
    static const hd_pole_kind kinds[2] = {HD_POLES_UNIFORM, HD_POLES_KERNEL};
    static const double most[2] = {3.79, 4.21};    /* reached at degree 14 */
    int32_t degree, i;
    int k;
    for (k = 0; k < 2; k++) {
        for (degree = 2; degree <= 14; degree++) {
            hd_rational set;
            CHECK(hd_rational_get(&set, kinds[k], degree, NULL) == HD_OK);
            for (i = 0; i < set.n_poles; i++) {
                const double bound = ldl_growth_bound(set.theta[i]);
                CHECK_MSG(bound < most[k], "kind %d, degree %d, pole %d: %g", k, (int)degree, (int)i, bound);
            }
        }
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

static double ldl_backward_real(const hd_csr *a, const double *val, const double *b, const double *x) {
    hd_c64 *v = DENSE_NEW(hd_c64, a->nnz), *c = DENSE_NEW(hd_c64, a->n_rows), *y = DENSE_NEW(hd_c64, a->n_rows);
    double back;
    int64_t p;
    int32_t i;
    for (p = 0; p < a->nnz; p++) v[p].re = val[p];
    for (i = 0; i < a->n_rows; i++) {
        c[i].re = b[i];
        y[i].re = x[i];
    }
    back = ldl_backward(a, v, c, y);
    free(v);
    free(c);
    free(y);
    return back;
}

/* Largest |x - y| / largest |y|, y by dense LU with pivoting. */
static double ldl_off_dense(const hd_csr *a, const hd_c64 *val, const hd_c64 *b, const hd_c64 *x) {
    const int32_t n = a->n_rows;
    dense_c64 *d = DENSE_NEW(dense_c64, (int64_t)n * n), *y = DENSE_NEW(dense_c64, n);
    double off = 0, size = 0;
    int64_t p;
    int32_t i;
    for (i = 0; i < n; i++) {
        y[i] = dense_c(b[i].re, b[i].im);
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) d[(size_t)i * (size_t)n + (size_t)a->col[p]] = dense_c(val[p].re, val[p].im);
    }
    CHECK(dense_complex_solve(d, y, n));
    for (i = 0; i < n; i++) {
        const double diff = hypot(x[i].re - y[i].re, x[i].im - y[i].im);
        if (!(diff <= off)) off = diff;
        size = fmax(size, hypot(y[i].re, y[i].im));
    }
    free(d);
    free(y);
    return n ? off / size : 0;
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

/* Pivots d [n] of P A P' by elimination on a dense matrix, in the order of perm. */
static void ldl_dense_pivots(const hd_csr *a, const hd_c64 *val, const int32_t *perm, dense_c64 *d) {
    const int32_t n = a->n_rows;
    dense_c64 *m = DENSE_NEW(dense_c64, (int64_t)n * n);
    int32_t *inv = DENSE_NEW(int32_t, n), i, j, k;
    int64_t p;
    for (i = 0; i < n; i++) inv[perm[i]] = i;
    for (i = 0; i < n; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) m[(size_t)inv[i] * (size_t)n + (size_t)inv[a->col[p]]] = dense_c(val[p].re, val[p].im);
    for (k = 0; k < n; k++) {
        const dense_c64 *row = m + (size_t)k * (size_t)n;
        d[k] = row[k];
        for (i = k + 1; i < n; i++) {
            dense_c64 *to = m + (size_t)i * (size_t)n;
            const dense_c64 l = dense_cquotient(to[k], row[k]);
            if (l.re == 0 && l.im == 0) continue;
            for (j = k + 1; j < n; j++) to[j] = dense_cfma(to[j], l, row[j]);
        }
    }
    free(m);
    free(inv);
}

/* Non-zeros of L, diagonal included, and the sum of the squared column counts, by playing the elimination on a dense pattern. */
static int64_t ldl_dense_fill(const hd_csr *a, const int32_t *perm, double *flops) {
    const int32_t n = a->n_rows;
    unsigned char *m = DENSE_NEW(unsigned char, (int64_t)n * n);
    int32_t *inv = DENSE_NEW(int32_t, n), i, j, k;
    int64_t p, nnz = 0;
    *flops = 0;
    for (i = 0; i < n; i++) inv[perm[i]] = i;
    for (i = 0; i < n; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) m[(size_t)inv[i] * (size_t)n + (size_t)inv[a->col[p]]] = 1;
    for (k = 0; k < n; k++) {
        int64_t count = 1;
        for (i = k + 1; i < n; i++) {
            if (!m[(size_t)i * (size_t)n + (size_t)k]) continue;
            count++;
            for (j = k + 1; j < n; j++) m[(size_t)i * (size_t)n + (size_t)j] |= m[(size_t)k * (size_t)n + (size_t)j];
        }
        nnz += count;
        *flops += (double)count * (double)count;
    }
    free(m);
    free(inv);
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

/* k complex-symmetric matrices in one sweep on f, each with a right-hand side of its own: residuals, growth, and with dense also dense LU. */
static void ldl_try_complex(hd_ldl *f, const hd_csr *a, hd_ordering asked, int32_t k, int dense, uint64_t seed, const char *what) {
    const int32_t n = a->n_rows;
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz), bound;
    hd_c64 *val = DENSE_NEW(hd_c64, k * a->nnz), *b = DENSE_NEW(hd_c64, (int64_t)k * n), *x = DENSE_NEW(hd_c64, (int64_t)k * n);
    hd_ldl_report rep;
    hd_error e;
    int32_t q;
    ldl_pair(a, seed, L, B);
    bound = ldl_shifted(a, L, B, k, seed + 3, val);
    ldl_fill(b, (int64_t)k * n, seed + 4);
    if (CHECK_MSG(hd_ldl_factor_complex(f, k, val, &rep, &e) == HD_OK && e.status == HD_OK, "%s, n %d, k %d: %s, row %d, pole %d", what, (int)n,
                  (int)k, e.text, (int)e.row, (int)e.pole)) {
        ldl_check_report(&rep, a, asked, k, what);
        CHECK_MSG(rep.growth <= bound * (1 + 1e-9) && rep.n_negative == 0, "%s, n %d: growth %g, at most %g", what, (int)n, rep.growth, bound);
        CHECK_MSG(hd_ldl_solve_complex(f, b, (size_t)n, x, 0, &e) == HD_OK && e.status == HD_OK, "%s: %s", what, e.text);
        for (q = 0; q < k; q++) {
            const double back = ldl_backward(a, val + q * a->nnz, b + (size_t)q * (size_t)n, x + (size_t)q * (size_t)n);
            CHECK_MSG(back <= 1e-14, "%s, n %d, matrix %d of %d: backward error %g", what, (int)n, (int)q, (int)k, back);
            if (dense) {
                const double off = ldl_off_dense(a, val + q * a->nnz, b + (size_t)q * (size_t)n, x + (size_t)q * (size_t)n);
                CHECK_MSG(off <= 1e-9, "%s, n %d, matrix %d of %d: off by %g", what, (int)n, (int)q, (int)k, off);
            }
        }
    }
    free(L);
    free(B);
    free(val);
    free(b);
    free(x);
}

/* t L + B, positive definite, with k right-hand sides in place. */
static void ldl_try_real(hd_ldl *f, const hd_csr *a, hd_ordering asked, int32_t k, uint64_t seed, const char *what) {
    const int32_t n = a->n_rows;
    const double t = pow(10, 1 + 2 * ldl_chance(k, n, seed));
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz), back;
    double *b = DENSE_NEW(double, (int64_t)k * n), *x = DENSE_NEW(double, (int64_t)k * n);
    hd_ldl_report rep;
    hd_error e;
    int64_t p;
    int32_t q;
    ldl_pair(a, seed, L, B);
    for (p = 0; p < a->nnz; p++) L[p] = t * L[p] + B[p];
    for (p = 0; p < (int64_t)k * n; p++) b[p] = x[p] = dense_signed(&seed);
    if (CHECK_MSG(hd_ldl_factor(f, L, &rep, &e) == HD_OK && e.status == HD_OK, "%s, n %d: %s", what, (int)n, e.text)) {
        ldl_check_report(&rep, a, asked, 1, what);
        CHECK_MSG(rep.n_negative == 0 && rep.growth <= 1 + 1e-12, "%s: %d negative, growth %g", what, (int)rep.n_negative, rep.growth);
        CHECK_MSG(hd_ldl_solve(f, k, x, 0, x, 0, &e) == HD_OK && e.status == HD_OK, "%s: %s", what, e.text);
        for (q = 0; q < k; q++) {
            back = ldl_backward_real(a, L, b + (size_t)q * (size_t)n, x + (size_t)q * (size_t)n);
            CHECK_MSG(back <= 1e-14, "%s, n %d, right-hand side %d of %d: backward error %g", what, (int)n, (int)q, (int)k, back);
        }
    }
    free(L);
    free(B);
    free(b);
    free(x);
}

/* ---- small ones, by hand ---- */

static void ldl_one(void) {
    const double d = -2.5, b[3] = {5, 1, -10};
    const hd_c64 z[2] = {{1, 2}, {0, -3}}, c[2] = {{3, -4}, {6, 3}};
    hd_csr a = kit_own_csr(test_diagonal_csr(1, &d));
    hd_ldl *f = ldl_make(&a, NULL, "1 x 1");
    hd_ldl_report rep;
    double x[3];
    hd_c64 y[2];
    if (!f) return;
    CHECK(hd_ldl_factor(f, &d, &rep, NULL) == HD_OK);
    CHECK(rep.n_negative == 1 && rep.growth == 1 && rep.smallest_pivot == 1 && rep.factor_nnz == 1 && rep.factor_flops == 1 && rep.n_supernodes == 1);
    CHECK(hd_ldl_solve(f, 3, b, 0, x, 0, NULL) == HD_OK);
    CHECK_MSG(fabs(x[0] + 2) < 1e-15 && fabs(x[1] + 0.4) < 1e-15 && fabs(x[2] - 4) < 1e-15, "%g %g %g", x[0], x[1], x[2]);
    CHECK(hd_ldl_factor_complex(f, 2, z, &rep, NULL) == HD_OK && rep.n_matrices == 2);
    CHECK(hd_ldl_solve_complex(f, c, 1, y, 0, NULL) == HD_OK);           /* (3 - 4i)/(1 + 2i) = -1 - 2i, (6 + 3i)/(-3i) = -1 + 2i */
    CHECK_MSG(hypot(y[0].re + 1, y[0].im + 2) < 1e-15 && hypot(y[1].re + 1, y[1].im - 2) < 1e-15, "%g%+gi, %g%+gi", y[0].re, y[0].im, y[1].re,
              y[1].im);
    hd_ldl_free(f);
}

/* [1 + i, 2 - i; 2 - i, 3i] x = b with x = (1, i); 2 - i squared is 3 - 4i, its size squared would be 5. */
static void ldl_two(void) {
    const hd_c64 val[4] = {{1, 1}, {2, -1}, {2, -1}, {0, 3}}, b[2] = {{2, 3}, {-1, -1}};
    const double real[4] = {2, 6, 6, 3}, c[2] = {14, 12};
    const int32_t natural[2] = {0, 1};
    hd_csr a = kit_own_csr(ldl_shape(LDL_PATH, 2, 1, 1));
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, natural, NULL, NULL);
    hd_ldl *f = ldl_make(&a, &o, "2 x 2");
    hd_ldl_report rep;
    hd_c64 x[2];
    double y[2];
    if (!f) return;
    CHECK(hd_ldl_factor_complex(f, 1, val, &rep, NULL) == HD_OK);
    CHECK_MSG(rep.factor_nnz == 3 && rep.factor_flops == 5, "%lld non-zeros, %g flops", (long long)rep.factor_nnz, rep.factor_flops);
    CHECK(hd_ldl_solve_complex(f, b, 0, x, 0, NULL) == HD_OK);
    CHECK_MSG(hypot(x[0].re - 1, x[0].im) < 1e-14 && hypot(x[1].re, x[1].im - 1) < 1e-14, "%g%+gi, %g%+gi", x[0].re, x[0].im, x[1].re, x[1].im);
    CHECK(hd_ldl_factor(f, real, &rep, NULL) == HD_OK);                    /* pivots 2, 3 - 18 = -15 */
    CHECK_MSG(rep.n_negative == 1 && fabs(rep.growth - 5) < 1e-14 && fabs(rep.smallest_pivot - 2.0 / 3) < 1e-14, "%d negative, %g, %g",
              (int)rep.n_negative, rep.growth, rep.smallest_pivot);
    CHECK(hd_ldl_solve(f, 1, c, 0, y, 0, NULL) == HD_OK);
    CHECK_MSG(fabs(y[0] - 1) < 1e-14 && fabs(y[1] - 2) < 1e-14, "%g, %g", y[0], y[1]);
    hd_ldl_free(f);
}

static void ldl_none(void) {
    const double d = 3, xyz[3] = {0, 0, 0};
    const hd_c64 z = {3, 1};
    const int32_t perm = 0;
    hd_csr a = kit_own_csr(ldl_shape(LDL_EMPTY, 0, 1, 1));
    int k;
    for (k = 0; k < 4; k++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[k], &perm, xyz, NULL);
        hd_ldl *f = ldl_make(&a, &o, "n = 0");
        hd_ldl_report rep;
        double x = 7;
        hd_c64 y = {7, 8};
        if (!f) continue;
        CHECK(hd_ldl_factor(f, &d, &rep, NULL) == HD_OK && rep.n_matrices == 1 && rep.factor_nnz == 0 && rep.factor_flops == 0);
        CHECK(rep.growth == rep.growth && rep.smallest_pivot == rep.smallest_pivot && rep.n_negative == 0);
        CHECK(hd_ldl_solve(f, 1, &d, 0, &x, 0, NULL) == HD_OK && x == 7);
        CHECK(hd_ldl_factor_complex(f, 5, &z, &rep, NULL) == HD_OK && rep.n_matrices == 5);
        CHECK(hd_ldl_solve_complex(f, &z, 0, &y, 0, NULL) == HD_OK && y.re == 7 && y.im == 8);
        hd_ldl_free(f);
    }
}

/* Diagonal matrices: every pivot is an entry, in whatever order. */
static void ldl_diagonal(void) {
    enum { N = 37 };
    double d[N], b[N], x[N];
    hd_csr a;
    int32_t i;
    int k;
    for (i = 0; i < N; i++) {
        d[i] = i % 3 ? 1 + i : -1 - i;
        b[i] = 4 * d[i];
    }
    a = test_diagonal_csr(N, d);
    for (k = 0; k < 2; k++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[k], NULL, NULL, NULL);
        hd_ldl *f = ldl_make(&a, &o, "diagonal");
        hd_ldl_report rep;
        if (!f) continue;
        CHECK(hd_ldl_factor(f, d, &rep, NULL) == HD_OK);
        CHECK_MSG(rep.n_negative == 13 && rep.growth == 1 && fabs(rep.smallest_pivot - 1.0 / N) < 1e-16, "%d, %g, %g", (int)rep.n_negative,
                  rep.growth, rep.smallest_pivot);
        CHECK(rep.factor_nnz == N && rep.factor_flops == N);
        CHECK(hd_ldl_solve(f, 1, b, 0, x, 0, NULL) == HD_OK);
        for (i = 0; i < N; i++) CHECK_MSG(fabs(x[i] - 4) < 1e-14, "x[%d] = %g", (int)i, x[i]);
        hd_ldl_free(f);
    }
    hd_csr_free(&a, NULL);
}

/* ---- many patterns ---- */

static void ldl_random_points(double *xyz, int32_t n, uint64_t seed) {
    int64_t i;
    for (i = 0; i < 3 * (int64_t)n; i++) xyz[i] = dense_signed(&seed);
}

/* One pattern by every ordering, with from one to nine matrices, at every level of instructions in turn. */
static void ldl_all_orderings(const hd_csr *a, int32_t k, int dense, uint64_t seed, const char *what) {
    const int32_t n = a->n_rows;
    int32_t *perm = DENSE_NEW(int32_t, n), i;
    double *xyz = DENSE_NEW(double, 3 * n);
    int way;
    ldl_random_points(xyz, n, seed);
    for (way = 0; way < 6; way++) {              /* automatic, minimum degree, nested dissection; own: natural, reversed, random */
        hd_context ctx;
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way < 3 ? way : 3], perm, way == 0 && k % 2 ? NULL : xyz, &ctx);
        hd_ldl *f;
        memset(&ctx, 0, sizeof ctx);
        ctx.simd = ldl_simds[(way + k) % 4];
        if (way == 5) dense_shuffle(perm, n, &seed);
        for (i = 0; way < 5 && i < n; i++) perm[i] = way == 4 ? n - 1 - i : i;
        f = ldl_make(a, &o, what);
        if (!f) continue;
        ldl_try_complex(f, a, o.ordering, k, dense && (way + k) % 3 == 0, seed + 10, what);
        ldl_try_real(f, a, o.ordering, 1, seed + 20, what);
        ldl_try_real(f, a, o.ordering, 2 + (way + k) % 9, seed + 21, what);
        hd_ldl_free(f);
        CHECK(ctx.bytes_in_use == 0);
    }
    free(perm);
    free(xyz);
}

static void ldl_all_shapes(void) {
    static const int32_t sizes[6] = {1, 2, 3, 10, 33, 70};
    int kind, s;
    for (kind = 0; kind < LDL_SHAPES; kind++) {
        for (s = 0; s < 6; s++) {
            hd_csr a = kit_own_csr(ldl_shape(kind, sizes[s], 1, (uint64_t)(kind + 1)));
            ldl_all_orderings(&a, 1 + (kind + 2 * s) % 9, 1, (uint64_t)(100 * kind + s + 1), ldl_shape_name(kind));
        }
    }
}

static void ldl_all_random(void) {
    static const double degrees[5] = {0.7, 2, 4, 9, 30};
    static const int32_t sizes[4] = {500, 800, 1200, 2000};
    int32_t n, k = 0;
    for (n = 1; n <= 120; n += n < 20 ? 1 : 4) {
        hd_csr a = ldl_random_pattern(n, degrees[k % 5], (uint64_t)(n + 1000));
        ldl_all_orderings(&a, 1 + k % 9, 1, (uint64_t)(n + 5000), "random");
        hd_csr_free(&a, NULL);
        k++;
    }
    for (k = 0; k < 4; k++) {                    /* fronts larger than a block, and a tree of some depth */
        hd_csr a = ldl_random_pattern(sizes[k], k == 0 ? 12 : 3.5 - 0.4 * k, (uint64_t)(k + 1));
        ldl_all_orderings(&a, 2 + k, 0, (uint64_t)(k + 50), "random, large");
        hd_csr_free(&a, NULL);
    }
}

/* Dense matrices across the sizes at which blocked kernels change: every remainder, and more than one block. */
static void ldl_all_dense(void) {
    static const int32_t sizes[10] = {4, 5, 7, 8, 9, 15, 31, 64, 97, 257};
    int s;
    for (s = 0; s < 10; s++) {
        hd_csr a = ldl_shape(LDL_DENSE, sizes[s], 1, 3);
        int q;
        for (q = 0; q < 4; q++) {
            hd_context ctx;
            hd_ldl_opts o = ldl_opts_of(HD_ORDERING_AUTO, NULL, NULL, &ctx);
            hd_ldl *f;
            memset(&ctx, 0, sizeof ctx);
            ctx.simd = ldl_simds[q];
            f = ldl_make(&a, &o, "dense");
            if (!f) continue;
            ldl_try_complex(f, &a, o.ordering, 1 + (s + q) % 5, sizes[s] < 65, (uint64_t)s + 1, "dense");
            ldl_try_real(f, &a, o.ordering, 1, (uint64_t)s + 2, "dense");
            ldl_try_real(f, &a, o.ordering, 5, (uint64_t)s + 2, "dense");
            hd_ldl_free(f);
        }
        hd_csr_free(&a, NULL);
    }
}

/* ---- fill ---- */

/* With an order given, fill, flops and pivots are facts. */
static void ldl_own_order(const hd_csr *a, const int32_t *perm, uint64_t seed, const char *what) {
    const int32_t n = a->n_rows, k = 3;
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz), flops, lo = HUGE_VAL, lo_each = HUGE_VAL, hi = 0, top = 0;
    double hi_least = HUGE_VAL, hi_most = 0;
    hd_c64 *val = DENSE_NEW(hd_c64, k * a->nnz);
    dense_c64 *d = DENSE_NEW(dense_c64, n);
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, NULL);
    hd_ldl *f = ldl_make(a, &o, what);
    const int64_t nnz = ldl_dense_fill(a, perm, &flops);
    hd_ldl_report rep;
    int32_t i, q;
    ldl_pair(a, seed, L, B);
    ldl_shifted(a, L, B, k, seed, val);
    for (q = 0; f && q < k; q++) {
        double most = 0, least = HUGE_VAL, diag = 0;
        ldl_dense_pivots(a, val + q * a->nnz, perm, d);
        for (i = 0; i < n; i++) {
            const hd_c64 z = val[q * a->nnz + op_find(a, i, i)];
            diag = fmax(diag, hypot(z.re, z.im));
            most = fmax(most, hypot(d[i].re, d[i].im));
            least = fmin(least, hypot(d[i].re, d[i].im));
        }
        CHECK(hd_ldl_factor_complex(f, 1, val + q * a->nnz, &rep, NULL) == HD_OK);
        CHECK_MSG(fabs(rep.growth - most / diag) <= 1e-10 * rep.growth, "%s, n %d: growth %.12g, not %.12g", what, (int)n, rep.growth, most / diag);
        CHECK_MSG(fabs(rep.smallest_pivot - least / diag) <= 1e-9 * rep.smallest_pivot, "%s, n %d: smallest pivot %.12g, not %.12g", what, (int)n,
                  rep.smallest_pivot, least / diag);
        CHECK_MSG(rep.factor_nnz == nnz && rep.factor_flops == flops, "%s, n %d: %lld non-zeros, not %lld; %g flops, not %g", what, (int)n,
                  (long long)rep.factor_nnz, (long long)nnz, rep.factor_flops, flops);
        lo = fmin(lo, least);
        lo_each = fmin(lo_each, least / diag);
        hi = fmax(hi, most);
        top = fmax(top, diag);
        hi_least = fmin(hi_least, most / diag);
        hi_most = fmax(hi_most, most / diag);
    }
    if (f && CHECK(hd_ldl_factor_complex(f, k, val, &rep, NULL) == HD_OK)) {    /* all at once: nothing of lanes without a matrix may show */
        CHECK_MSG(rep.growth >= hi_least * (1 - 1e-9) && rep.growth <= hi_most * (1 + 1e-9), "%s: growth %g, %g in all", what, rep.growth, hi / top);
        CHECK_MSG(rep.smallest_pivot >= lo / top * (1 - 1e-9) && rep.smallest_pivot <= lo_each * (1 + 1e-9), "%s: smallest %g", what,
                  rep.smallest_pivot);
    }
    hd_ldl_free(f);
    free(L);
    free(B);
    free(val);
    free(d);
}

static void ldl_own_orders(void) {
    static const int32_t sizes[5] = {1, 2, 9, 40, 85};
    int32_t perm[120], i;
    uint64_t seed = 77;
    int kind, s, way;
    for (kind = 0; kind < LDL_SHAPES; kind++) {
        for (s = 0; s < 5; s++) {
            const int32_t n = sizes[s];
            hd_csr a = ldl_shape(kind, n, 1, (uint64_t)s + 9);
            for (way = 0; way < 3; way++) {
                for (i = 0; i < n; i++) perm[i] = way ? n - 1 - i : i;
                if (way == 2) dense_shuffle(perm, n, &seed);
                ldl_own_order(&a, perm, (uint64_t)(kind + 10 * way + 1), ldl_shape_name(kind));
            }
            hd_csr_free(&a, NULL);
        }
    }
    for (s = 0; s < 20; s++) {
        const int32_t n = 5 + 6 * s;
        hd_csr a = ldl_random_pattern(n, 1 + s % 5, (uint64_t)s + 1);
        dense_shuffle(perm, n, &seed);
        ldl_own_order(&a, perm, (uint64_t)s + 1, "random");
        hd_csr_free(&a, NULL);
    }
}

/* A minimum degree order of a forest takes leaves first: no fill at all. And on a grid both orders beat the natural one. */
static void ldl_fill_is_low(void) {
    hd_csr a;
    hd_ldl_report rep, natural;
    hd_ldl *f;
    int32_t *perm = DENSE_NEW(int32_t, 2500), i;
    double *xyz = DENSE_NEW(double, 3 * 2500);
    int kind, k;
    for (kind = 0; kind <= LDL_TREES; kind++) {
        for (k = 0; k < 3; k++) {
            const int32_t n = k == 0 ? 5 : k == 1 ? 60 : 700;
            hd_ldl_opts o = ldl_opts_of(HD_ORDERING_MINIMUM_DEGREE, NULL, NULL, NULL);
            a = ldl_shape(kind, n, 1, (uint64_t)k + 1);
            if (CHECK(hd_ldl_analyse(&f, &a, &o, &rep, NULL) == HD_OK)) {
                CHECK_MSG(rep.factor_nnz == n + (a.nnz - n) / 2, "%s of %d: %lld non-zeros", ldl_shape_name(kind), (int)n, (long long)rep.factor_nnz);
                hd_ldl_free(f);
            }
            hd_csr_free(&a, NULL);
        }
    }
    a = ldl_shape(LDL_GRID, 2500, 1, 1);
    for (i = 0; i < 2500; i++) {
        perm[i] = i;
        xyz[3 * i] = i % 50;
        xyz[3 * i + 1] = i / 50;
    }
    for (k = 3; k >= 0; k--) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[k], perm, xyz, NULL);
        if (!CHECK(hd_ldl_analyse(&f, &a, &o, k == 3 ? &natural : &rep, NULL) == HD_OK)) continue;
        if (k < 3) CHECK_MSG(rep.factor_nnz < 2500 * 26 && rep.factor_flops < natural.factor_flops / 2, "ordering %d: %lld non-zeros, natural %lld",
                             k,
                             (long long)rep.factor_nnz, (long long)natural.factor_nnz);
        hd_ldl_free(f);
    }
    hd_csr_free(&a, NULL);
    free(perm);
    free(xyz);
}

/* ---- indefinite ---- */

/* [H, A'; A, -G] with H and G positive definite: every order has pivots, and as many are negative as G has rows. */
static void ldl_quasidefinite_of(int32_t n, uint64_t seed) {
    hd_csr a = kit_own_csr(ldl_random_pattern(n, 5, seed));
    double *val = DENSE_NEW(double, a.nnz), *b = DENSE_NEW(double, 3 * n), *x = DENSE_NEW(double, 3 * n), *q = DENSE_NEW(double, (int64_t)n * n);
    double *lambda = DENSE_NEW(double, n), *dense;
    int32_t *perm = DENSE_NEW(int32_t, n), i, negative = 0;
    int64_t p;
    int way;
    for (i = 0; i < n; i++) {
        const int si = ldl_chance(i, i, seed) < 0.4;
        double sum = 0;
        for (p = a.row_ptr[i]; p < a.row_ptr[i + 1]; p++) {
            const int32_t j = a.col[p];
            val[p] = j == i ? 0 : 2 * ldl_chance(i, j, seed + 1) - 1;
            if (j != i && si == (ldl_chance(j, j, seed) < 0.4)) sum += fabs(val[p]);
        }
        val[op_find(&a, i, i)] = (si ? -1 : 1) * (sum + 0.5 + ldl_chance(i, i, seed + 2));
    }
    dense = test_dense(&a, val);
    CHECK(dense_symmetric_eigen(dense, q, lambda, n));
    for (i = 0; i < n; i++) negative += lambda[i] < 0;
    for (i = 0; i < 3 * n; i++) b[i] = dense_signed(&seed);
    for (way = 0; way < 4; way++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], perm, NULL, NULL);
        hd_ldl *f;
        hd_ldl_report rep;
        double *xyz = DENSE_NEW(double, 3 * n);
        int32_t k;
        o.xyz = xyz;
        ldl_random_points(xyz, n, seed);
        dense_shuffle(perm, n, &seed);
        f = ldl_make(&a, &o, "quasi-definite");
        memset(xyz, 0xff, 3 * (size_t)n * sizeof *xyz);
        free(xyz);                               /* not looked at again */
        if (!f) continue;
        CHECK(hd_ldl_factor(f, val, &rep, NULL) == HD_OK);
        CHECK_MSG(rep.n_negative == negative, "n %d: %d negative pivots, %d negative eigenvalues", (int)n, (int)rep.n_negative, (int)negative);
        CHECK(hd_ldl_solve(f, 3, b, 0, x, 0, NULL) == HD_OK);
        for (k = 0; k < 3; k++) {
            const double back = ldl_backward_real(&a, val, b + k * n, x + k * n);
            CHECK_MSG(back <= 1e-14 * fmax(1, rep.growth), "n %d: backward error %g, growth %g", (int)n, back, rep.growth);
        }
        hd_ldl_free(f);
    }
    free(val);
    free(b);
    free(x);
    free(q);
    free(lambda);
    free(dense);
    free(perm);
}

static void ldl_quasidefinite(void) {
    int32_t n;
    for (n = 1; n <= 90; n += n < 12 ? 1 : 13) ldl_quasidefinite_of(n, (uint64_t)n);
}

/* Diagonal entries that the pattern lacks are zeros: a saddle point whose pivots come by fill, and one that has none. */
static void ldl_no_diagonal(void) {
    const double saddle[9] = {2, 1, 3, 1, 3, 0, 0, 0, 0}, b[3] = {7, 1, 3}, cycle[2] = {1, 1};
    const int32_t natural[3] = {0, 1, 2}, i[5] = {0, 0, 0, 1, 2}, j[5] = {0, 1, 2, 0, 0};
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, natural, NULL, NULL);
    hd_csr a, c = kit_own_csr(ldl_shape(LDL_PATH, 2, 0, 1));
    hd_ldl *f;
    hd_ldl_report rep;
    hd_error e;
    double x[3];
    CHECK(hd_csr_from_triplets(&a, 3, 3, 5, i, j, NULL, NULL, NULL) == HD_OK && a.nnz == 5);
    f = ldl_make(&a, &o, "saddle");
    /* pivots 2, -1/2; then L = [1; 1/2 1; 3/2 3 1]: the Schur complement of the first is -[1 3; 3 9]/2, singular */
    CHECK(hd_ldl_factor(f, saddle, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 2 && e.value == 0);
    hd_ldl_free(f);
    hd_csr_free(&a, NULL);
    a = ldl_shape(LDL_STAR_LAST, 3, 0, 1);       /* rows 0 and 1 without a diagonal: no pivot at once */
    f = ldl_make(&a, &o, "star");
    CHECK(hd_ldl_factor(f, saddle, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 0 && e.value == 0);
    hd_ldl_free(f);
    hd_csr_free(&a, NULL);
    f = ldl_make(&c, &o, "cycle");
    CHECK(hd_ldl_factor(f, cycle, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 0);
    hd_ldl_free(f);
    {                                            /* [4 1 .; 1 . 2; . 2 1]: pivots 4, -1/4, 17 */
        const int32_t ri[6] = {0, 0, 1, 1, 2, 2}, rj[6] = {0, 1, 0, 2, 1, 2};
        const double val[6] = {4, 1, 1, 2, 2, 1};
        CHECK(hd_csr_from_triplets(&a, 3, 3, 6, ri, rj, NULL, NULL, NULL) == HD_OK && a.nnz == 6);
        f = ldl_make(&a, &o, "no diagonal");
        CHECK(hd_ldl_factor(f, val, &rep, &e) == HD_OK && rep.n_negative == 1 && fabs(rep.growth - 17.0 / 4) < 1e-13 &&
              fabs(rep.smallest_pivot - 1.0 / 16) < 1e-14);
        CHECK_MSG(rep.factor_nnz == 5 && rep.factor_flops == 9, "%lld non-zeros, %g flops", (long long)rep.factor_nnz, rep.factor_flops);
        CHECK(hd_ldl_solve(f, 1, b, 0, x, 0, NULL) == HD_OK && ldl_backward_real(&a, val, b, x) < 1e-15);
        hd_ldl_free(f);
        hd_csr_free(&a, NULL);
    }
}

/* ---- how solves may be called ---- */

/* One, several or a common right-hand side, columns apart, in place: for k = 1..9 all give the same bits. */
static void ldl_forms_complex(void) {
    enum { N = 61, PAD = 70, MOST = 9 };
    hd_csr a = kit_own_csr(ldl_random_pattern(N, 4, 3));
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, MOST * a.nnz), b[PAD * MOST], x[PAD * MOST], y[PAD * MOST];
    const hd_c64 mark = {-77, 99};
    hd_ldl *f = ldl_make(&a, NULL, "forms");
    int32_t k, q, i;
    ldl_pair(&a, 5, L, B);
    ldl_shifted(&a, L, B, MOST, 6, val);
    for (k = 1; f && k <= MOST; k++) {
        ldl_fill(b, PAD * MOST, (uint64_t)k);
        for (i = 0; i < PAD * MOST; i++) x[i] = y[i] = mark;
        CHECK(hd_ldl_factor_complex(f, k, val, NULL, NULL) == HD_OK);
        CHECK(hd_ldl_solve_complex(f, b, PAD, x, PAD, NULL) == HD_OK);
        for (q = 0; q < k; q++) {
            CHECK(ldl_backward(&a, val + q * a.nnz, b + PAD * q, x + PAD * q) <= 1e-14);
            CHECK(ldl_off_dense(&a, val + q * a.nnz, b + PAD * q, x + PAD * q) <= 1e-10);
            for (i = N; i < PAD; i++) CHECK_MSG(x[PAD * q + i].re == mark.re && x[PAD * q + i].im == mark.im, "written between columns: %d of %d",
                                                (int)q, (int)k);
        }
        for (i = PAD * k; i < PAD * MOST; i++) CHECK(x[i].re == mark.re && x[i].im == mark.im);    /* nor after the last */
        CHECK(hd_ldl_solve_complex(f, b, PAD, y, 0, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(memcmp(y + N * q, x + PAD * q, N * sizeof *x) == 0, "columns close together: %d of %d", (int)q, (int)k);
        for (i = N * k; i < PAD * MOST; i++) CHECK(y[i].re == mark.re && y[i].im == mark.im);
        memcpy(y, b, sizeof y);
        CHECK(hd_ldl_solve_complex(f, y, PAD, y, PAD, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(memcmp(y + PAD * q, x + PAD * q, N * sizeof *x) == 0, "in place: %d of %d", (int)q, (int)k);
        CHECK(hd_ldl_solve_complex(f, b, 0, x, PAD, NULL) == HD_OK);
        for (q = 0; q < k; q++) {
            CHECK_MSG(ldl_backward(&a, val + q * a.nnz, b, x + PAD * q) <= 1e-14, "a common right-hand side: %d of %d", (int)q, (int)k);
            memcpy(y + PAD * q, b, N * sizeof *b);
        }
        CHECK(hd_ldl_solve_complex(f, y, PAD, y, PAD, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(memcmp(y + PAD * q, x + PAD * q, N * sizeof *x) == 0, "common or copied: %d of %d", (int)q, (int)k);
        memcpy(y, b, sizeof y);
        CHECK(hd_ldl_solve_complex(f, y, 0, y, PAD, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(memcmp(y + PAD * q, x + PAD * q, N * sizeof *x) == 0, "common, in place: %d of %d", (int)q, (int)k);
    }
    hd_ldl_free(f);
    free(L);
    free(B);
    free(val);
}

/* A matrix has the same answer wherever in the sweep it stands, and whatever its companions. */
static void ldl_companions(void) {
    enum { N = 45, MOST = 9 };
    hd_csr a = kit_own_csr(ldl_random_pattern(N, 5, 8));
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, MOST * a.nnz), *own = DENSE_NEW(hd_c64, MOST * a.nnz), b[N], x[N * MOST], alone[N * MOST];
    hd_ldl *f = ldl_make(&a, NULL, "companions");
    int32_t k, q;
    ldl_pair(&a, 5, L, B);
    ldl_shifted(&a, L, B, MOST, 16, val);
    ldl_fill(b, N, 3);
    for (q = 0; f && q < MOST; q++) {
        CHECK(hd_ldl_factor_complex(f, 1, val + q * a.nnz, NULL, NULL) == HD_OK);
        CHECK(hd_ldl_solve_complex(f, b, 0, alone + N * q, 0, NULL) == HD_OK);
    }
    for (k = 2; f && k <= MOST; k++) {           /* the last k, backwards */
        for (q = 0; q < k; q++) memcpy(own + q * a.nnz, val + (MOST - 1 - q) * a.nnz, (size_t)a.nnz * sizeof *own);
        CHECK(hd_ldl_factor_complex(f, k, own, NULL, NULL) == HD_OK);
        CHECK(hd_ldl_solve_complex(f, b, 0, x, 0, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(ldl_differ(x + N * q, alone + N * (MOST - 1 - q), N) <= 1e-10, "matrix %d of %d", (int)q, (int)k);
    }
    hd_ldl_free(f);
    free(L);
    free(B);
    free(val);
    free(own);
}

static void ldl_forms_real(void) {
    enum { N = 53, PAD = 60, MOST = 13 };
    hd_csr a = kit_own_csr(ldl_random_pattern(N, 4, 13));
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz), b[PAD * MOST], x[PAD * MOST], y[PAD * MOST], alone[N * MOST];
    hd_ldl *f = ldl_make(&a, NULL, "forms");
    uint64_t seed = 4;
    int64_t p;
    int32_t k, q, i;
    ldl_pair(&a, 5, L, B);
    for (p = 0; p < a.nnz; p++) L[p] = 3 * L[p] + B[p];
    for (i = 0; i < PAD * MOST; i++) b[i] = dense_signed(&seed);
    if (f) CHECK(hd_ldl_factor(f, L, NULL, NULL) == HD_OK);
    for (q = 0; f && q < MOST; q++) {
        CHECK(hd_ldl_solve(f, 1, b + PAD * q, 0, alone + N * q, 0, NULL) == HD_OK);
        CHECK(ldl_backward_real(&a, L, b + PAD * q, alone + N * q) <= 1e-14);
    }
    for (k = 1; f && k <= MOST; k++) {
        for (i = 0; i < PAD * MOST; i++) x[i] = y[i] = -77;
        CHECK(hd_ldl_solve(f, k, b, PAD, x, PAD, NULL) == HD_OK);
        CHECK(hd_ldl_solve(f, k, b, PAD, y, 0, NULL) == HD_OK);
        for (q = 0; q < k; q++) {
            CHECK_MSG(dense_max_diff(x + PAD * q, alone + N * q, N) <= 1e-12 * dense_max_abs(alone + N * q, N), "right-hand side %d of %d", (int)q,
                      (int)k);
            CHECK_MSG(ldl_backward_real(&a, L, b + PAD * q, x + PAD * q) <= 1e-14, "right-hand side %d of %d", (int)q, (int)k);
            CHECK_MSG(memcmp(y + N * q, x + PAD * q, N * sizeof *x) == 0, "columns close together: %d of %d", (int)q, (int)k);
            for (i = N; i < PAD; i++) CHECK(x[PAD * q + i] == -77);
        }
        for (i = PAD * k; i < PAD * MOST; i++) CHECK(x[i] == -77);
        for (i = N * k; i < PAD * MOST; i++) CHECK(y[i] == -77);
        memcpy(y, b, sizeof y);
        CHECK(hd_ldl_solve(f, k, y, PAD, y, PAD, NULL) == HD_OK);
        for (q = 0; q < k; q++) CHECK_MSG(memcmp(y + PAD * q, x + PAD * q, N * sizeof *x) == 0, "in place: %d of %d", (int)q, (int)k);
    }
    for (i = 0; f && i < 2; i++) {               /* in place, columns wider apart before or afterwards */
        const size_t ldb = i ? PAD : N, ldx = i ? N : PAD;
        for (q = 0; q < MOST; q++) memcpy(y + ldb * (size_t)q, b + PAD * q, N * sizeof *y);
        CHECK(hd_ldl_solve(f, MOST, y, ldb, y, ldx, NULL) == HD_OK);
        for (q = 0; q < MOST; q++) CHECK_MSG(ldl_backward_real(&a, L, b + PAD * q, y + ldx * (size_t)q) <= 1e-14, "%d apart: %d", (int)ldx, (int)q);
    }
    hd_ldl_free(f);
    free(L);
    free(B);
}

/* Of (i, j) and (j, i) one is read, whichever: where they differ, the answer is that of a symmetric matrix with either value. */
static void ldl_one_of_a_pair(void) {
    enum { N = 30 };
    hd_csr a = kit_own_csr(ldl_random_pattern(N, 5, 21));
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, a.nnz), *other = DENSE_NEW(hd_c64, a.nnz), *keep = DENSE_NEW(hd_c64, a.nnz), b[N], x[N];
    int32_t perm[N], i;
    int64_t p;
    int way;
    uint64_t seed = 2;
    ldl_pair(&a, 5, L, B);
    ldl_shifted(&a, L, B, 1, 6, keep);
    ldl_fill(b, N, 1);
    for (way = 0; way < 4; way += 3) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], perm, NULL, NULL);
        hd_ldl *f;
        dense_shuffle(perm, N, &seed);
        f = ldl_make(&a, &o, "one of a pair");
        for (i = 1; f && i < N; i++) {
            for (p = a.row_ptr[i]; p < a.row_ptr[i + 1] && a.col[p] < i; p++) {
                double back;
                memcpy(val, keep, (size_t)a.nnz * sizeof *val);
                memcpy(other, keep, (size_t)a.nnz * sizeof *other);
                val[p].re += 0.01 * fabs(keep[p].re);
                other[p] = other[op_find(&a, a.col[p], i)] = val[p];
                CHECK(hd_ldl_factor_complex(f, 1, val, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, b, 0, x, 0, NULL) == HD_OK);
                back = fmin(ldl_backward(&a, keep, b, x), ldl_backward(&a, other, b, x));
                CHECK_MSG(back <= 1e-14, "(%d, %d): backward error %g", (int)i, (int)a.col[p], back);
            }
        }
        hd_ldl_free(f);
    }
    free(L);
    free(B);
    free(val);
    free(other);
    free(keep);
}

/* ---- again and again ---- */

/* New values on the same analysis, real and complex in turn: the same bits as from a fresh object, and memory only where there was none. The
 * pattern's arrays are gone by then. */
static void ldl_refactor(void) {
    enum { N = 140, K = 6, ROUNDS = 4 };
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_csr a = ldl_random_pattern(N, 4, 31), copy = ldl_random_pattern(N, 4, 31);
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz), *val = DENSE_NEW(double, a.nnz), b[N], x[2][2 * N], c[2 * N];
    hd_c64 *z = DENSE_NEW(hd_c64, K * a.nnz), rhs[N], y[2][K * N];
    int32_t *perm = DENSE_NEW(int32_t, N);
    uint64_t seed = 8, calls = 0, bytes = 0;
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, &ctx);
    hd_ldl *f, *fresh;
    int64_t p;
    int round;
    dense_shuffle(perm, N, &seed);
    f = ldl_make(&copy, &o, "refactor");
    if (copy.nnz) memset(copy.col, 0x77, (size_t)copy.nnz * sizeof *copy.col);
    memset(copy.row_ptr, 0x77, (N + 1) * sizeof *copy.row_ptr);
    copy.nnz = 0;
    hd_csr_free(&copy, NULL);
    for (round = 0; f && round < ROUNDS; round++) {
        int32_t *own = DENSE_NEW(int32_t, N);
        memcpy(own, perm, N * sizeof *own);
        ldl_pair(&a, (uint64_t)round + 1, L, B);
        ldl_shifted(&a, L, B, K, (uint64_t)round + 11, z);
        ldl_fill(rhs, N, (uint64_t)round + 1);
        for (p = 0; p < a.nnz; p++) val[p] = (1 + round) * L[p] + B[p];
        for (p = 0; p < N; p++) b[p] = c[p] = rhs[p].re;
        for (p = 0; p < N; p++) c[N + p] = rhs[p].im;
        CHECK(hd_ldl_factor(f, val, NULL, NULL) == HD_OK && hd_ldl_solve(f, 2, c, 0, x[0], 0, NULL) == HD_OK);
        CHECK_MSG(ldl_backward_real(&a, val, b, x[0]) <= 1e-14, "real, round %d", round);
        CHECK(hd_ldl_factor_complex(f, K, z, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, rhs, 0, y[0], 0, NULL) == HD_OK);
        CHECK_MSG(ldl_backward(&a, z + 5 * a.nnz, rhs, y[0] + 5 * N) <= 1e-14, "complex, round %d", round);
        if (round == 2) {                        /* of round 1 to 2, with nothing else between: the same kind, the same number */
            hd_ldl_report rep;
            calls = ctx.allocations;
            bytes = ctx.bytes_in_use;
            CHECK(hd_ldl_factor_complex(f, K, z, &rep, NULL) == HD_OK && hd_ldl_solve_complex(f, rhs, 0, y[1], 0, NULL) == HD_OK);
            CHECK(hd_ldl_factor_complex(f, K, z, &rep, NULL) == HD_OK && hd_ldl_solve_complex(f, rhs, 0, y[1], 0, NULL) == HD_OK);
            CHECK(hd_ldl_solve_complex(f, rhs, 0, y[1], 0, NULL) == HD_OK && memcmp(y[0], y[1], sizeof y[0]) == 0);
            CHECK_MSG(ctx.allocations == calls && ctx.bytes_in_use == bytes && m.calls == (int64_t)calls, "complex: %llu allocations more",
                      (unsigned long long)(ctx.allocations - calls));
            CHECK(hd_ldl_factor(f, val, &rep, NULL) == HD_OK && hd_ldl_solve(f, 2, c, 0, x[1], 0, NULL) == HD_OK);
            calls = ctx.allocations;
            CHECK(hd_ldl_factor(f, val, &rep, NULL) == HD_OK && hd_ldl_solve(f, 2, c, 0, x[1], 0, NULL) == HD_OK);
            CHECK(hd_ldl_solve(f, 1, c, 0, x[1], 0, NULL) == HD_OK);
            CHECK_MSG(ctx.allocations == calls && m.calls == (int64_t)calls, "real: %llu allocations more",
                      (unsigned long long)(ctx.allocations - calls));
        }
        o.perm = own;
        fresh = ldl_make(&a, &o, "fresh");
        memset(own, 0x77, N * sizeof *own);
        free(own);                               /* not looked at again */
        CHECK(hd_ldl_factor_complex(fresh, K, z, NULL, NULL) == HD_OK && hd_ldl_solve_complex(fresh, rhs, 0, y[1], 0, NULL) == HD_OK);
        CHECK_MSG(memcmp(y[0], y[1], sizeof y[0]) == 0, "complex, round %d: not as from a fresh object", round);
        CHECK(hd_ldl_factor(fresh, val, NULL, NULL) == HD_OK && hd_ldl_solve(fresh, 2, c, 0, x[1], 0, NULL) == HD_OK);
        CHECK_MSG(memcmp(x[0], x[1], sizeof x[0]) == 0, "real, round %d: not as from a fresh object", round);
        hd_ldl_free(fresh);
    }
    hd_ldl_free(f);
    test_memory_done(&m, &ctx, "refactor");
    hd_csr_free(&a, NULL);
    free(L);
    free(B);
    free(val);
    free(z);
    free(perm);
}

/* More matrices, then fewer, then more. */
static void ldl_other_counts(void) {
    static const int32_t counts[7] = {3, 9, 1, 4, 5, 8, 2};
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_csr a = ldl_random_pattern(50, 4, 41);
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_AUTO, NULL, NULL, &ctx);
    hd_ldl *f = ldl_make(&a, &o, "counts");
    int k;
    for (k = 0; f && k < 7; k++) {
        ldl_try_complex(f, &a, HD_ORDERING_AUTO, counts[k], 1, (uint64_t)k + 1, "counts");
        if (k % 2) ldl_try_real(f, &a, HD_ORDERING_AUTO, 3, (uint64_t)k + 1, "counts");
    }
    hd_ldl_free(f);
    test_memory_done(&m, &ctx, "counts");
    hd_csr_free(&a, NULL);
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

typedef struct ldl_answers { hd_c64 *z; double *x; hd_ldl_report complex, real; } ldl_answers;

/* Whatever the library answers, in one way of threading. */
static int64_t ldl_thread_run(const hd_csr *a, const double *xyz, hd_ordering ordering, hd_simd simd, int way, int32_t k, const hd_c64 *val,
                              const double *real,
                              const hd_c64 *b, ldl_answers *out) {
    ldl_way *w = DENSE_NEW(ldl_way, 1);
    hd_ldl_opts o;
    hd_ldl *f;
    int64_t calls;
    memset(&out->complex, 0, sizeof out->complex);
    memset(&out->real, 0, sizeof out->real);
    ldl_way_begin(w, way, simd);
    o = ldl_opts_of(ordering, NULL, xyz, &w->ctx);
    f = ldl_make(a, &o, "threads");
    CHECK(hd_ldl_factor_complex(f, k, val, &out->complex, NULL) == HD_OK);
    CHECK(hd_ldl_solve_complex(f, b, 0, out->z, 0, NULL) == HD_OK);
    CHECK(hd_ldl_factor(f, real, &out->real, NULL) == HD_OK);
    CHECK(hd_ldl_solve(f, k, (const double *)b, 0, out->x, 0, NULL) == HD_OK);
    hd_ldl_free(f);
    ldl_way_end(w, way);
    calls = w->calls;
#ifdef LDL_THREADS
    calls += w->pool.loops;
#endif
    free(w);
    return calls;
}

static int ldl_same_report(const hd_ldl_report *a, const hd_ldl_report *b) {
    return a->ordering == b->ordering && a->n_supernodes == b->n_supernodes && a->n_matrices == b->n_matrices && a->factor_nnz == b->factor_nnz &&
           a->stored == b->stored && a->factor_flops == b->factor_flops && a->growth == b->growth && a->smallest_pivot == b->smallest_pivot &&
           a->n_negative == b->n_negative;
}

/* All ways of threading give the same bits, at every level of instructions; levels differ by rounding only. */
static void ldl_threads_of(const hd_csr *a, const double *xyz, hd_ordering ordering, int32_t k, const char *what) {
    const size_t n = (size_t)a->n_rows, size = (size_t)k * n;
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, k * a->nnz), *b = DENSE_NEW(hd_c64, size), *top = DENSE_NEW(hd_c64, size);
    ldl_answers first, other;
    int64_t p, calls = 0;
    int32_t q;
    int way, level;
    first.z = DENSE_NEW(hd_c64, size);
    other.z = DENSE_NEW(hd_c64, size);
    first.x = DENSE_NEW(double, size);
    other.x = DENSE_NEW(double, size);
    ldl_pair(a, 3, L, B);
    ldl_shifted(a, L, B, k, 4, val);
    for (p = 0; p < a->nnz; p++) L[p] = 10 * L[p] + B[p];
    ldl_fill(b, (int64_t)size, 5);
    for (level = 0; level < 4; level++) {
        ldl_thread_run(a, xyz, ordering, ldl_simds[level], 0, k, val, L, b, &first);
        for (q = 0; q < k; q++) {
            const double back = ldl_backward(a, val + q * a->nnz, b, first.z + (size_t)q * n);
            const double back_real = ldl_backward_real(a, L, (const double *)b + (size_t)q * n, first.x + (size_t)q * n);
            CHECK_MSG(back <= 1e-14 && back_real <= 1e-14, "%s: level %d: backward errors %g, %g", what, level, back, back_real);
        }
        if (level == 0) memcpy(top, first.z, size * sizeof *top);
        CHECK_MSG(ldl_differ(first.z, top, (int64_t)size) <= 1e-9, "%s: level %d is off by %g", what, level, ldl_differ(first.z, top, (int64_t)size));
        for (way = 1; way < LDL_WAYS; way++) {
            if (level > 1 && way < 4) continue;
            calls += ldl_thread_run(a, xyz, ordering, ldl_simds[level], way, k, val, L, b, &other);
            CHECK_MSG(memcmp(first.z, other.z, size * sizeof *first.z) == 0, "%s: complex: way %d of threading gives other bits, level %d", what,
                      way, level);
            CHECK_MSG(memcmp(first.x, other.x, size * sizeof *first.x) == 0, "%s: real: way %d of threading gives other bits, level %d", what, way,
                      level);
            CHECK_MSG(ldl_same_report(&first.complex, &other.complex) && ldl_same_report(&first.real, &other.real), "%s: way %d: another report",
                      what, way);
        }
    }
    CHECK_MSG(calls > 0 || a->n_rows < 1000, "%s: never in parallel", what);
    free(L);
    free(B);
    free(val);
    free(b);
    free(top);
    free(first.z);
    free(other.z);
    free(first.x);
    free(other.x);
}

/* The pattern of a mesh, without values. */
static hd_csr ldl_mesh_pattern(const shape *s) {
    ldl_edges g = ldl_edges_of(s->n);
    int32_t f, q;
    for (f = 0; f < s->n_tri; f++)
        for (q = 0; q < 3; q++) ldl_join(&g, s->tri[3 * f + q], s->tri[3 * f + (q + 1) % 3]);
    return ldl_pattern(&g, 1);
}

static void ldl_threads(void) {
    shape ball = kit_own_shape(shape_bumpy(4, 3));
    hd_csr a = ldl_mesh_pattern(&ball);
    ldl_threads_of(&a, ball.xyz, HD_ORDERING_NESTED_DISSECTION, 5, "mesh, nested dissection");
    ldl_threads_of(&a, NULL, HD_ORDERING_MINIMUM_DEGREE, 2, "mesh, minimum degree");
    hd_csr_free(&a, NULL);
    a = ldl_shape(LDL_PIECES, 3000, 1, 1);
    ldl_threads_of(&a, NULL, HD_ORDERING_AUTO, 4, "pieces");
    hd_csr_free(&a, NULL);
    a = ldl_shape(LDL_DENSE, 310, 1, 1);         /* one front, larger than what one task takes */
    ldl_threads_of(&a, NULL, HD_ORDERING_AUTO, 3, "dense");
    hd_csr_free(&a, NULL);
}

/* ---- pivots that fail ---- */

static void ldl_pivot_errors_of(hd_ordering ordering, int32_t n, uint64_t seed) {
    const int32_t zero = ldl_below(&seed, n), k = 7;
    int32_t *perm = DENSE_NEW(int32_t, n), i, bad;
    double *L, *B, *xyz = DENSE_NEW(double, 3 * n);
    hd_c64 *val, *b = DENSE_NEW(hd_c64, n), *x = DENSE_NEW(hd_c64, (int64_t)n * k);
    hd_ldl_opts o = ldl_opts_of(ordering, perm, xyz, NULL);
    ldl_edges g = ldl_edges_of(n);
    hd_ldl_report rep;
    hd_csr a;
    hd_ldl *f;
    hd_error e;
    int64_t p, diag;
    for (i = 0; i < 3 * n; i++) {                /* row `zero` stands alone: its pivot is its entry */
        const int32_t u = ldl_below(&seed, n), v = ldl_below(&seed, n);
        if (u != zero && v != zero) ldl_join(&g, u, v);
    }
    a = ldl_pattern(&g, 1);
    diag = op_find(&a, zero, zero);
    L = DENSE_NEW(double, a.nnz);
    B = DENSE_NEW(double, a.nnz);
    val = DENSE_NEW(hd_c64, k * a.nnz);
    dense_shuffle(perm, n, &seed);
    ldl_random_points(xyz, n, seed);
    ldl_pair(&a, seed, L, B);
    ldl_shifted(&a, L, B, k, seed, val);
    for (p = 0; p < a.nnz; p++) L[p] += B[p];
    ldl_fill(b, n, seed);
    f = ldl_make(&a, &o, "pivots");
    L[diag] = 0;
    CHECK(hd_ldl_factor(f, L, &rep, &e) == HD_ERR_BREAKDOWN && e.status == HD_ERR_BREAKDOWN);
    CHECK_MSG(e.row == zero && e.value == 0 && e.pole == -1, "row %d instead of %d, pivot %g, pole %d", (int)e.row, (int)zero, e.value, (int)e.pole);
    CHECK(hd_ldl_solve(f, 1, B, 0, (double *)x, 0, &e) == HD_ERR_ARGUMENT);
    L[diag] = 2;
    CHECK(hd_ldl_factor(f, L, &rep, &e) == HD_OK && hd_ldl_solve(f, 1, (const double *)b, 0, (double *)x, 0, &e) == HD_OK);
    CHECK(ldl_backward_real(&a, L, (const double *)b, (const double *)x) <= 1e-14);
    for (bad = 0; bad < k; bad++) {              /* in either sweep of four, and last of all */
        val[bad * a.nnz + diag] = test_c(0, 0);
        CHECK(hd_ldl_factor_complex(f, k, val, &rep, &e) == HD_ERR_BREAKDOWN && e.status == HD_ERR_BREAKDOWN);
        CHECK_MSG(e.row == zero && e.pole == bad && e.value == 0, "row %d, pole %d instead of %d, %d", (int)e.row, (int)e.pole, (int)zero, (int)bad);
        CHECK(hd_ldl_solve_complex(f, b, 0, x, 0, &e) == HD_ERR_ARGUMENT);
        val[bad * a.nnz + diag] = test_c(0, -1e-3);
    }
    CHECK(hd_ldl_factor_complex(f, k, val, &rep, &e) == HD_OK && hd_ldl_solve_complex(f, b, 0, x, 0, &e) == HD_OK);
    for (i = 0; i < k; i++) CHECK(ldl_backward(&a, val + i * a.nnz, b, x + (int64_t)i * n) <= 1e-14);
    hd_ldl_free(f);
    hd_csr_free(&a, NULL);
    free(perm);
    free(xyz);
    free(L);
    free(B);
    free(val);
    free(b);
    free(x);
}

/* Values that are no numbers, told by their place: on the diagonal, off it, in each matrix. */
static void ldl_not_finite(void) {
    enum { N = 23, K = 6 };
    const double wrong[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    hd_csr a = kit_own_csr(ldl_random_pattern(N, 4, 5));
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, K * a.nnz);
    hd_ldl *f = ldl_make(&a, NULL, "not finite");
    hd_error e;
    int32_t i, q;
    int64_t p;
    ldl_pair(&a, 1, L, B);
    ldl_shifted(&a, L, B, K, 1, val);
    for (p = 0; p < a.nnz; p++) L[p] += B[p];
    for (i = 0; f && i < N; i++) {
        for (p = a.row_ptr[i]; p < a.row_ptr[i + 1]; p++) {
            const int32_t j = a.col[p];
            const int64_t mirror = op_find(&a, j, i);
            const double good = L[p];
            if (j > i) continue;
            L[p] = L[mirror] = wrong[(i + j) % 3];
            CHECK(hd_ldl_factor(f, L, NULL, &e) == HD_ERR_NOT_FINITE && e.status == HD_ERR_NOT_FINITE);
            CHECK_MSG((e.row == i && e.column == j) || (e.row == j && e.column == i), "(%d, %d), not (%d, %d)", (int)e.row, (int)e.column, (int)i,
                      (int)j);
            L[mirror] = good;                    /* in the lower triangle alone */
            L[p] = wrong[(i + j) % 3];
            CHECK_MSG(hd_ldl_factor(f, L, NULL, &e) == HD_ERR_NOT_FINITE && e.row == i && e.column == j, "(%d, %d), not (%d, %d)", (int)e.row,
                      (int)e.column, (int)i, (int)j);
            L[p] = good;
            for (q = 0; q < K; q += 1 + (i + j) % 3) {
                hd_c64 *at = val + q * a.nnz + p;
                const hd_c64 keep = *at;
                if ((i + q) % 2) at->re = wrong[q % 3];
                else at->im = wrong[q % 3];
                CHECK(hd_ldl_factor_complex(f, K, val, NULL, &e) == HD_ERR_NOT_FINITE && e.status == HD_ERR_NOT_FINITE && e.pole == q);
                CHECK_MSG(e.row == i && e.column == j, "(%d, %d), not (%d, %d)", (int)e.row, (int)e.column, (int)i, (int)j);
                *at = keep;
            }
        }
    }
    if (f) {
        ldl_try_complex(f, &a, HD_ORDERING_AUTO, K, 1, 5, "after values that were not finite");
        ldl_try_real(f, &a, HD_ORDERING_AUTO, K, 5, "after values that were not finite");
    }
    hd_ldl_free(f);
    free(L);
    free(B);
    free(val);
}

/* A pivot is divided by if its inverse is a number, else named, wherever it stands. */
static void ldl_subnormal(void) {
    enum { N = 30 };
    static const double pivots[5] = {1e-307, -1e-308, 1e-309, -1e-310, 5e-324};
    hd_csr a = kit_own_csr(ldl_shape(LDL_BAND, N, 1, 1));
    double *val = DENSE_NEW(double, a.nnz), b[N], x[N];
    hd_c64 *z = DENSE_NEW(hd_c64, a.nnz);
    hd_ldl *f = ldl_make(&a, NULL, "subnormal");
    hd_error e;
    int32_t i, q;
    TRAPS_OFF;                                   /* inverses overflow */
    for (i = 0; f && i < N; i++) {
        const int64_t at = op_find(&a, i, i);
        memset(val, 0, (size_t)a.nnz * sizeof *val);
        for (q = 0; q < N; q++) {
            val[op_find(&a, q, q)] = b[q] = 1;
            if (q == i) b[q] = 1e-5;
        }
        for (q = 0; q < 5; q++) {
            const hd_status want = q < 2 ? HD_OK : HD_ERR_BREAKDOWN;
            int64_t p;
            val[at] = pivots[q];
            for (p = 0; p < a.nnz; p++) z[p].re = z[p].im = val[p];
            z[at].im = 0;
            CHECK_MSG(hd_ldl_factor(f, val, NULL, &e) == want && (q < 2 || (e.row == i && e.value == pivots[q])), "%g in row %d: %s, row %d",
                      pivots[q], (int)i, hd_status_name(e.status), (int)e.row);
            if (q < 2) CHECK(hd_ldl_solve(f, 1, b, 0, x, 0, &e) == HD_OK && fabs(x[i] * pivots[q] / b[i] - 1) < 1e-15);
            CHECK(hd_ldl_factor_complex(f, 1, z, NULL, &e) == want && (q < 2 || e.row == i));
        }
    }
    TRAPS_ON;
    hd_ldl_free(f);
    free(val);
    free(z);
}

/* Exact zeros that come by elimination, and pivots that overflow. */
static void ldl_breakdown(void) {
    enum { N = 12 };
    const double huge[4] = {1e-200, 1e200, 1e200, 1};
    const hd_c64 nil[8] = {{1, 1}, {2, 2}, {2, 2}, {4, 4}, {0, 2}, {1, 0}, {1, 0}, {0, -0.5}};
    const int32_t natural[2] = {0, 1};
    int32_t perm[N], i;
    hd_csr path = kit_own_csr(test_path_csr(N, 0)), two = kit_own_csr(ldl_shape(LDL_PATH, 2, 1, 1));
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, NULL);
    hd_ldl_report rep;
    hd_error e;
    hd_ldl *f;
    int way;
    for (way = 0; way < 2; way++) {              /* the Laplacian of a path: pivots 1, ..., 1, 0 */
        for (i = 0; i < N; i++) perm[i] = way ? N - 1 - i : i;
        f = ldl_make(&path, &o, "singular");
        CHECK(hd_ldl_factor(f, path.val, &rep, &e) == HD_ERR_BREAKDOWN);
        CHECK_MSG(e.row == perm[N - 1] && e.value == 0, "row %d, pivot %g", (int)e.row, e.value);
        hd_ldl_free(f);
    }
    o.perm = natural;
    f = ldl_make(&two, &o, "overflow");
    TRAPS_OFF;                                   /* pivots are looked at, not what leads to them */
    CHECK(hd_ldl_factor(f, huge, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 1 && !(fabs(e.value) <= DBL_MAX));
    TRAPS_ON;
    CHECK(hd_ldl_factor_complex(f, 1, nil, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 1 && e.pole == 0 && e.value == 0);    /* (1 + i) [1 2; 2 4] */
    CHECK(hd_ldl_factor_complex(f, 1, nil + 4, &rep, &e) == HD_ERR_BREAKDOWN && e.row == 1 && e.pole == 0);                /* [2i 1; 1 -i/2] */
    hd_ldl_free(f);
}

/* Two zeros far from each other: the one that is eliminated first is told, whatever threads do. */
static void ldl_first_of_two(void) {
    enum { N = 40000 };                          /* many subtrees */
    hd_csr a = kit_own_csr(ldl_shape(LDL_PIECES, N, 1, 1));
    int32_t *perm = DENSE_NEW(int32_t, N), i;
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz);
    int64_t p;
    int way;
    ldl_pair(&a, 1, L, B);
    for (p = 0; p < a.nnz; p++) L[p] += B[p];
    L[op_find(&a, 35000, 35000)] = L[op_find(&a, 700, 700)] = 0;    /* multiples of five: alone, or the first of their piece */
    for (i = 0; i < N; i++) perm[i] = i;
    for (way = 0; way < LDL_WAYS; way++) {
        ldl_way *w = DENSE_NEW(ldl_way, 1);
        hd_ldl_opts o;
        hd_ldl *f;
        hd_error e;
        ldl_way_begin(w, way, HD_SIMD_AUTO);
        o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, &w->ctx);
        f = ldl_make(&a, &o, "two zeros");
        CHECK_MSG(hd_ldl_factor(f, L, NULL, &e) == HD_ERR_BREAKDOWN && e.row == 700, "way %d of threading says row %d", way, (int)e.row);
        hd_ldl_free(f);
        ldl_way_end(w, way);
        free(w);
    }
    free(perm);
    free(L);
    free(B);
}

/* ---- memory and cancelling ---- */

static void ldl_robust_values(const hd_csr *a, int32_t k, double *real, hd_c64 *val) {
    double *L = DENSE_NEW(double, a->nnz);
    int64_t p;
    ldl_pair(a, 3, L, real);
    ldl_shifted(a, L, real, k, 4, val);
    for (p = 0; p < a->nnz; p++) real[p] += L[p];
    free(L);
}

/* variant % 4: ordering; / 4: real, complex, or both in turn. */
static hd_status ldl_rob_job(hd_context *ctx, int variant) {
    enum { N = 48, K = 5 };
    const int kind = variant / 4;
    hd_csr a = kit_own_csr(ldl_random_pattern(N, 4, 9));
    double *real = DENSE_NEW(double, a.nnz), *xyz = DENSE_NEW(double, 3 * N), *x = DENSE_NEW(double, 6 * N);
    hd_c64 *val = DENSE_NEW(hd_c64, K * a.nnz), *z = DENSE_NEW(hd_c64, K * N);
    int32_t perm[N];
    uint64_t seed = 6;
    hd_ldl_opts o = ldl_opts_of(ldl_orderings[variant % 4], perm, xyz, ctx);
    hd_ldl *f = ldl_mark;
    hd_error e;
    hd_status st;
    dense_shuffle(perm, N, &seed);
    ldl_random_points(xyz, N, 7);
    ldl_robust_values(&a, K, real, val);
    st = hd_ldl_analyse(&f, &a, &o, NULL, &e);
    CHECK(e.status == st && (st >= 0) == (f != ldl_mark));
    if (st >= 0) {
        if (kind != 1) CHECK((st = hd_ldl_factor(f, real, NULL, &e)) == e.status);
        if (kind != 1 && st >= 0) CHECK((st = hd_ldl_solve(f, 6, x, 0, x, 0, &e)) == e.status);
        if (kind != 0 && st >= 0) CHECK((st = hd_ldl_factor_complex(f, K, val, NULL, &e)) == e.status);
        if (kind != 0 && st >= 0) CHECK((st = hd_ldl_solve_complex(f, z, 0, z, 0, &e)) == e.status);
        hd_ldl_free(f);
    }
    free(real);
    free(xyz);
    free(x);
    free(val);
    free(z);
    return st;
}

static void ldl_robust(void) {
    static const char *const names[3] = {"ldl real", "ldl complex", "ldl both"};
    int variant;
    for (variant = 0; variant < 12; variant++) {
        rob_job job;
        job.what = names[variant / 4];
        job.run = ldl_rob_job;
        job.variant = variant;
        rob_fail_each_allocation(&job);
        rob_byte_limits(&job);
        rob_stop_each_progress(&job, HD_PROGRESS_CANCEL, HD_ERR_CANCELLED);
        rob_stop_each_progress(&job, (hd_progress)1, HD_ERR_ARGUMENT);
        rob_stop_each_progress(&job, (hd_progress)0, HD_ERR_ARGUMENT);
    }
}

/* An object whose factorisation ran out of memory (q = 0), or was cancelled (q = 1), in its first one or a later: not to be solved with, but to be
 * factored again. */
static void ldl_survives_one(const hd_csr *a, const double *xyz, int q, int before, int reverse) {
    enum { K = 5 };
    const int32_t n = a->n_rows;
    double *real = DENSE_NEW(double, a->nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, K * a->nnz), *b = DENSE_NEW(hd_c64, n), *x = DENSE_NEW(hd_c64, K * n), *want = DENSE_NEW(hd_c64, K * n);
    int64_t k, calls = 0;
    ldl_robust_values(a, K, real, val);
    ldl_fill(b, n, 5);
    for (k = 0; k < ROB_MOST; k++) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        hd_ldl_opts o = ldl_opts_of(HD_ORDERING_NESTED_DISSECTION, NULL, xyz, &ctx);
        rob_progress p;
        hd_ldl *f;
        hd_error e;
        hd_status st = HD_OK;
        ctx.parallel_user = &calls;
        if (reverse) ctx.parallel_for = sparse_reverse_for;
        f = ldl_make(a, &o, "survives");
        memset(&p, 0, sizeof p);
        p.stop_at = k;
        p.answer = HD_PROGRESS_CANCEL;
        if (before == 1) CHECK(hd_ldl_factor_complex(f, K, val, NULL, NULL) == HD_OK);
        if (before == 2) CHECK(hd_ldl_factor(f, real, NULL, NULL) == HD_OK);
        ctx.progress_user = &p;
        if (q) ctx.progress = rob_on_progress;
        else if (k) m.fail_at = m.calls + k;
        if (k) {
            st = hd_ldl_factor_complex(f, K, val, NULL, &e);
            CHECK_MSG(st == HD_OK || st == (q ? HD_ERR_CANCELLED : HD_ERR_MEMORY), "%s", hd_status_name(st));
            CHECK(e.status == st);
        }
        ctx.progress = NULL;
        m.fail_at = 0;
        if (st < 0) CHECK(hd_ldl_solve_complex(f, b, 0, x, 0, NULL) == HD_ERR_ARGUMENT);
        CHECK(hd_ldl_factor_complex(f, K, val, NULL, NULL) == HD_OK && hd_ldl_solve_complex(f, b, 0, k ? x : want, 0, NULL) == HD_OK);
        if (k) CHECK_MSG(memcmp(x, want, (size_t)(K * n) * sizeof *x) == 0, "after failure %lld: other bits", (long long)k);
        hd_ldl_free(f);
        test_memory_done(&m, &ctx, "survives");
        if (k && st >= 0) break;
    }
    CHECK_MSG(k < ROB_MOST && (k > 1 || (q == 0 && before == 1)), "stopped at %lld", (long long)k);
    free(real);
    free(val);
    free(b);
    free(x);
    free(want);
}

static void ldl_survives(void) {
    shape ball = kit_own_shape(shape_bumpy(2, 4));
    hd_csr a = kit_own_csr(ldl_mesh_pattern(&ball));
    int q, before;
    for (before = 0; before < 3; before++)
        for (q = 0; q < 2; q++) ldl_survives_one(&a, ball.xyz, q, before, (q + before) % 2);
}

/* ---- arguments ---- */

static void ldl_bad_patterns(void) {
    int64_t ptr[4] = {0, 2, 4, 6};
    int32_t col[6] = {0, 1, 0, 1, 1, 2};         /* (2, 1) has no partner */
    double val[6] = {1, 2, 2, 1, 0, 1};
    hd_csr a = sparse_view(3, 3, 6, ptr, col, val), b;
    hd_ldl *f = ldl_mark;
    hd_error e;
    CHECK(hd_ldl_analyse(&f, &a, NULL, NULL, &e) == HD_ERR_NOT_SYMMETRIC && e.status == HD_ERR_NOT_SYMMETRIC);    /* though its value is zero */
    CHECK_MSG(e.row + e.column == 3 && e.row * e.column == 2, "(%d, %d)", (int)e.row, (int)e.column);
    a.val = NULL;
    CHECK(hd_ldl_analyse(&f, &a, NULL, NULL, &e) == HD_ERR_NOT_SYMMETRIC);
    b = a;
    b.n_cols = 4;
    CHECK(hd_ldl_analyse(&f, &b, NULL, NULL, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 3 && e.column == 4);
    b = a;
    b.row_ptr = NULL;
    CHECK(hd_ldl_analyse(&f, &b, NULL, NULL, &e) == HD_ERR_STRUCTURE);
    b = a;
    b.col = NULL;
    CHECK(hd_ldl_analyse(&f, &b, NULL, NULL, &e) == HD_ERR_STRUCTURE);
    b = a;
    b.n_rows = b.n_cols = -1;
    CHECK(hd_ldl_analyse(&f, &b, NULL, NULL, &e) == HD_ERR_STRUCTURE);
    col[4] = 2;
    CHECK(hd_ldl_analyse(&f, &a, NULL, NULL, &e) == HD_ERR_STRUCTURE && e.row == 2 && e.column == 2);    /* twice */
    col[4] = 3;
    CHECK(hd_ldl_analyse(&f, &a, NULL, NULL, &e) == HD_ERR_INDEX && e.row == 2 && e.column == 3);
    ptr[1] = 5;
    CHECK(hd_ldl_analyse(&f, &a, NULL, NULL, &e) == HD_ERR_STRUCTURE && e.row == 1);
    CHECK(f == ldl_mark);
    CHECK(hd_ldl_analyse(NULL, &a, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT);
    CHECK(hd_ldl_analyse(&f, NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT && f == ldl_mark);
}

static void ldl_bad_options(void) {
    enum { N = 10 };
    hd_csr a = test_path_csr(N, 1);
    int32_t perm[N], i;
    double xyz[3 * N];
    hd_context ctx;
    hd_ldl_opts good, o;
    hd_ldl *f = ldl_mark;
    hd_error e;
    memset(&good, 0, sizeof good);
    memset(&ctx, 0, sizeof ctx);
    ldl_random_points(xyz, N, 1);
    for (i = 0; i < N; i++) {
        perm[i] = (3 * i + 4) % N;
        a.val[i] = (double)NAN;                  /* values are not looked at */
    }
#define LDL_BAD(change, st)                                                                                            \
    o = good;                                                                                                          \
    change;                                                                                                            \
    CHECK_MSG(hd_ldl_analyse(&f, &a, &o, NULL, &e) == st && e.status == st && e.text[0] && f == ldl_mark, "%s: %s", #change, hd_status_name(e.status))
    LDL_BAD(o.begin_zero = 1, HD_ERR_ARGUMENT);
    LDL_BAD(o.end_zero = -1, HD_ERR_ARGUMENT);
    LDL_BAD(o.ordering = (hd_ordering)4, HD_ERR_ARGUMENT);
    LDL_BAD(o.ordering = (hd_ordering)99, HD_ERR_ARGUMENT);
    LDL_BAD(o.ordering = HD_ORDERING_OWN, HD_ERR_ARGUMENT);
    LDL_BAD(o.ordering = HD_ORDERING_NESTED_DISSECTION, HD_ERR_ARGUMENT);
    ctx.n_threads = -1;
    LDL_BAD(o.context = &ctx, HD_ERR_ARGUMENT);
    ctx.n_threads = 0;
    ctx.allocator.alloc = test_memory_alloc;
    LDL_BAD(o.context = &ctx, HD_ERR_ARGUMENT);
    good.ordering = HD_ORDERING_OWN;
    good.perm = perm;
    i = perm[7];
    perm[7] = perm[3];
    LDL_BAD((void)0, HD_ERR_INDEX);
    CHECK_MSG(e.row == 7 && e.value == perm[3], "row %d, value %g", (int)e.row, e.value);
    perm[7] = N;
    LDL_BAD((void)0, HD_ERR_INDEX);
    CHECK_MSG(e.row == 7 && e.value == N, "row %d, value %g", (int)e.row, e.value);
    perm[7] = -1;
    LDL_BAD((void)0, HD_ERR_INDEX);
    CHECK_MSG(e.row == 7 && e.value == -1, "row %d, value %g", (int)e.row, e.value);
#undef LDL_BAD
    perm[7] = i;
    if (CHECK(hd_ldl_analyse(&f, &a, &good, NULL, &e) == HD_OK && f != ldl_mark)) hd_ldl_free(f);
    good.ordering = HD_ORDERING_NESTED_DISSECTION;
    good.xyz = xyz;
    if (CHECK(hd_ldl_analyse(&f, &a, &good, NULL, NULL) == HD_OK)) hd_ldl_free(f);
    for (i = 0; i < 6; i++) {                    /* coordinates: refused, or of any size */
        const double wrong[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
        hd_ldl *none = ldl_mark;
        xyz[5 * i + 2] = wrong[i % 3];
        good.ordering = i < 3 ? HD_ORDERING_NESTED_DISSECTION : HD_ORDERING_AUTO;
        CHECK(hd_ldl_analyse(&none, &a, &good, NULL, &e) == HD_ERR_NOT_FINITE && none == ldl_mark);
        CHECK_MSG(e.row == (5 * i + 2) / 3 && e.column == (5 * i + 2) % 3, "row %d, column %d", (int)e.row, (int)e.column);
        xyz[5 * i + 2] = i % 2 ? DBL_MAX : -DBL_MAX;
    }
    good.ordering = HD_ORDERING_NESTED_DISSECTION;
    if (CHECK(hd_ldl_analyse(&f, &a, &good, NULL, NULL) == HD_OK)) hd_ldl_free(f);
    hd_ldl_free(NULL);
    hd_csr_free(&a, NULL);
}

static void ldl_bad_calls(void) {
    enum { N = 6 };
    hd_csr a = kit_own_csr(test_path_csr(N, 1));
    double b[3 * N], x[3 * N];
    hd_c64 val[2 * 3 * N], c[2 * N], z[2 * N];
    hd_ldl *f = ldl_make(&a, NULL, "calls");
    hd_error e;
    int i;
    for (i = 0; i < 2 * 3 * N; i++) val[i] = test_c(a.val[i % (3 * N)] + (a.val[i % (3 * N)] > 0), 0.5);
    for (i = 0; i < 3 * N; i++) {
        a.val[i] += a.val[i] > 0;
        b[i] = x[i] = i;
    }
    for (i = 0; i < 2 * N; i++) c[i] = test_c(i, -i);
#define LDL_BAD(call) CHECK((call) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT && e.text[0])
    LDL_BAD(hd_ldl_solve(f, 1, b, 0, x, 0, &e));             /* nothing factored yet */
    LDL_BAD(hd_ldl_solve_complex(f, c, 0, z, 0, &e));
    LDL_BAD(hd_ldl_factor(NULL, a.val, NULL, &e));
    LDL_BAD(hd_ldl_factor(f, NULL, NULL, &e));
    LDL_BAD(hd_ldl_factor_complex(NULL, 1, val, NULL, &e));
    LDL_BAD(hd_ldl_factor_complex(f, 1, NULL, NULL, &e));
    LDL_BAD(hd_ldl_factor_complex(f, 0, val, NULL, &e));
    LDL_BAD(hd_ldl_factor_complex(f, -3, val, NULL, &e));
    CHECK(hd_ldl_factor(f, a.val, NULL, &e) == HD_OK);
    LDL_BAD(hd_ldl_solve_complex(f, c, 0, z, 0, &e));        /* of the other kind */
    LDL_BAD(hd_ldl_solve(NULL, 1, b, 0, x, 0, &e));
    LDL_BAD(hd_ldl_solve(f, 1, NULL, 0, x, 0, &e));
    LDL_BAD(hd_ldl_solve(f, 1, b, 0, NULL, 0, &e));
    LDL_BAD(hd_ldl_solve(f, -1, b, 0, x, 0, &e));
    LDL_BAD(hd_ldl_solve(f, 2, b, N - 1, x, 0, &e));
    LDL_BAD(hd_ldl_solve(f, 2, b, 0, x, N - 1, &e));
    CHECK(hd_ldl_solve(f, 3, b, 0, x, N, &e) == HD_OK && e.status == HD_OK);
    CHECK(ldl_backward_real(&a, a.val, b + 2 * N, x + 2 * N) <= 1e-15);
    CHECK(hd_ldl_factor_complex(f, 2, val, NULL, &e) == HD_OK);
    LDL_BAD(hd_ldl_solve(f, 1, b, 0, x, 0, &e));
    LDL_BAD(hd_ldl_solve_complex(NULL, c, 0, z, 0, &e));
    LDL_BAD(hd_ldl_solve_complex(f, NULL, 0, z, 0, &e));
    LDL_BAD(hd_ldl_solve_complex(f, c, 0, NULL, 0, &e));
    LDL_BAD(hd_ldl_solve_complex(f, c, N - 1, z, 0, &e));
    LDL_BAD(hd_ldl_solve_complex(f, c, 0, z, N - 1, &e));
    CHECK(hd_ldl_solve_complex(f, c, N, z, N, NULL) == HD_OK);
    CHECK(ldl_backward(&a, val + 3 * N, c + N, z + N) <= 1e-15);
    CHECK(hd_ldl_factor(f, a.val, NULL, &e) == HD_OK);
    LDL_BAD(hd_ldl_solve_complex(f, c, 0, z, 0, &e));        /* the last factorisation counts */
    a.val[0] = (double)NAN;
    CHECK(hd_ldl_factor(f, a.val, NULL, &e) == HD_ERR_NOT_FINITE);
    LDL_BAD(hd_ldl_solve(f, 1, b, 0, x, 0, &e));             /* also when it failed */
    CHECK(hd_ldl_factor_complex(f, 2, val, NULL, &e) == HD_OK);
    val[3 * N].im = (double)INFINITY;
    CHECK(hd_ldl_factor_complex(f, 2, val, NULL, &e) == HD_ERR_NOT_FINITE && e.pole == 1);
    LDL_BAD(hd_ldl_solve_complex(f, c, 0, z, 0, &e));
#undef LDL_BAD
    CHECK(hd_ldl_solve_complex(NULL, c, 0, z, 0, NULL) == HD_ERR_ARGUMENT);    /* no place for the error is fine */
    hd_ldl_free(f);
}

/* ---- meshes ---- */

/* t L + theta B of a mesh for four poles at once, and the real t L + B, by all orderings; coordinates of two kinds. */
static void ldl_mesh_of(const shape *s, hd_laplacian_kind kind, int flat, const char *what) {
    enum { K = 4, K_REAL = 2 };
    hd_laplacian *lap = test_laplacian(s, kind);
    const int32_t n = lap->n_active;
    const hd_csr *a = &lap->L;
    double *real = DENSE_NEW(double, a->nnz), *xyz = DENSE_NEW(double, 3 * n), most = 0;
    double *x = DENSE_NEW(double, K_REAL * n), *y = DENSE_NEW(double, K_REAL * n);
    hd_c64 *val = DENSE_NEW(hd_c64, K * a->nnz), *b = DENSE_NEW(hd_c64, n), *z = DENSE_NEW(hd_c64, K * n);
    const double t = 100 * lap->h * lap->h;
    hd_rational set;
    int32_t i, k;
    int64_t p;
    int way;
    CHECK(hd_rational_get(&set, HD_POLES_KERNEL, 2 * K, NULL) == HD_OK && set.n_poles == K);
    for (i = 0; i < n; i++) {
        if (!flat) memcpy(xyz + 3 * i, s->xyz + 3 * lap->vertex[i], 3 * sizeof *xyz);
        b[i] = test_c(lap->mass[i] * cos(0.3 * i), lap->mass[i] * (i % 9));
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const double m = lap->B ? lap->B[p] : a->col[p] == i ? lap->mass[i] : 0;
            for (k = 0; k < K; k++) val[k * a->nnz + p] = test_c(t * a->val[p] + set.theta[k].re * m, set.theta[k].im * m);
            real[p] = t * a->val[p] + m;
        }
    }
    for (k = 0; k < K; k++) most = fmax(most, ldl_growth_bound(set.theta[k]));
    for (i = 0; i < K_REAL * n; i++) x[i] = y[i] = b[i % n].im + (i == n + 5);
    for (way = 0; way < 3; way++) {
        hd_ldl_opts o = ldl_opts_of(ldl_orderings[way], NULL, xyz, NULL);
        hd_ldl *f = ldl_make(a, &o, what);
        hd_ldl_report rep;
        hd_error e;
        CHECK_MSG(hd_ldl_factor_complex(f, K, val, &rep, &e) == HD_OK, "%s", e.text);
        ldl_check_report(&rep, a, o.ordering, K, what);
        CHECK_MSG(rep.growth <= most, "%s: growth %g", what, rep.growth);
        if (!flat) CHECK_MSG(rep.factor_nnz < 75 * (int64_t)n, "%s, ordering %d: %g non-zeros a row", what, way, (double)rep.factor_nnz / n);
        CHECK(hd_ldl_solve_complex(f, b, 0, z, 0, &e) == HD_OK);
        for (k = 0; k < K; k++) CHECK_MSG(ldl_backward(a, val + k * a->nnz, b, z + (int64_t)k * n) <= 1e-14, "%s: pole %d", what, (int)k);
        CHECK(hd_ldl_factor(f, real, &rep, &e) == HD_OK && rep.n_negative == 0);
        CHECK(hd_ldl_solve(f, K_REAL, y, 0, x, 0, &e) == HD_OK);
        for (k = 0; k < K_REAL; k++) CHECK_MSG(ldl_backward_real(a, real, y + (int64_t)k * n, x + (int64_t)k * n) <= 1e-14, "%s: real %d", what,
                                               (int)k);
        hd_ldl_free(f);
    }
    hd_laplacian_free(lap);
    free(real);
    free(xyz);
    free(x);
    free(y);
    free(val);
    free(b);
    free(z);
}

/* Nested dissection of graphs with and without a use of it: every small size, and meshes whose leaves have many neighbours. */
static void ldl_dissections(void) {
    int32_t n, k;
    for (n = 1; n < 420; n += n < 40 ? 1 : 29) {
        for (k = 0; k < 3; k++) {
            shape grid = kit_own_shape(shape_grid(2 + n / 9, 8, 0.3));
            double *xyz = DENSE_NEW(double, 3 * n);
            hd_csr a = k == 2 ? ldl_mesh_pattern(&grid) : k ? ldl_random_pattern(n, 9, (uint64_t)n) : ldl_shape(LDL_PIECES, n, 1, 1);
            hd_ldl_opts o = ldl_opts_of(HD_ORDERING_NESTED_DISSECTION, NULL, k == 2 ? grid.xyz : xyz, NULL);
            hd_ldl *f;
            ldl_random_points(xyz, n, (uint64_t)n);
            f = ldl_make(&a, &o, "dissection");
            if (f) ldl_try_complex(f, &a, o.ordering, 1, 0, (uint64_t)(n + k), "dissection");
            hd_ldl_free(f);
            hd_csr_free(&a, NULL);
            free(xyz);
        }
    }
}

static void ldl_meshes(void) {
    const double offset[3] = {4, 0, 0};
    shape grid = kit_own_shape(shape_grid(141, 141, 0.3)), ball = kit_own_shape(shape_bumpy(3, 1)), plate = kit_own_shape(shape_grid(20, 30, 0.2)), two = kit_own_shape(shape_disjoint(&ball, &plate, offset));
    ldl_mesh_of(&grid, HD_LAPLACIAN_FEM, 0, "grid of 20 thousand");
    ldl_mesh_of(&two, HD_LAPLACIAN_VORONOI_COT, 0, "two pieces");
    ldl_mesh_of(&plate, HD_LAPLACIAN_COT, 1, "all rows at one point");    /* nothing to dissect by, and still right */
}

static void test_ldl(void) {
    ldl_one();
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
    ldl_no_diagonal();
    ldl_forms_complex();
    ldl_forms_real();
    ldl_companions();
    ldl_one_of_a_pair();
    ldl_refactor();
    ldl_other_counts();
    ldl_threads();
    ldl_pivot_errors_of(HD_ORDERING_AUTO, 40, 3);
    ldl_pivot_errors_of(HD_ORDERING_MINIMUM_DEGREE, 25, 4);
    ldl_pivot_errors_of(HD_ORDERING_NESTED_DISSECTION, 77, 5);
    ldl_pivot_errors_of(HD_ORDERING_OWN, 33, 6);
    ldl_not_finite();
    ldl_subnormal();
    ldl_breakdown();
    ldl_first_of_two();
    ldl_robust();
    ldl_survives();
    ldl_bad_patterns();
    ldl_bad_options();
    ldl_bad_calls();
    ldl_dissections();
    ldl_meshes();
}

#endif
