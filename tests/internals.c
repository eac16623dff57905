/* internals.c - tests of what heatdiff.h does not show: the hdi_ functions, reached by including the implementation

       cc -std=c99 tests/internals.c -I. -lm -o internals && ./internals

   Prints what failed, with file and line, and at the end `N passed, N failed`. Exit status 1 when any check failed. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "dense.h"
#include "../tools/shapes.h"

static int64_t int_passed, int_failed;

#if defined(__GNUC__) || defined(__clang__)
__attribute__((format(printf, 5, 6)))
#endif
static void int_check(int ok, const char *file, int line, const char *what, const char *fmt, ...) {
    va_list args;
    if (ok) {
        int_passed++;
        return;
    }
    int_failed++;
    if (int_failed > 100) return;
    printf("%s:%d: %s\n    ", file, line, what);
    va_start(args, fmt);
    vprintf(fmt, args);
    va_end(args);
    printf("\n");
}

#define CHECK(cond) int_check((cond) != 0, __FILE__, __LINE__, #cond, "%s", "does not hold")
#define CHECK_MSG(cond, ...) int_check((cond) != 0, __FILE__, __LINE__, #cond, __VA_ARGS__)

/* ---- [01] scalar ---- */

static void int_division(void) {
    static const double big[5] = {1, 1e300, 1e-300, 1e150, 1e-150};
    int i, j, k;
    for (i = 0; i < 5; i++) {
        for (j = 0; j < 5; j++) {
            for (k = 0; k < 4; k++) {            /* (3 + 4i) z / z for z in four directions */
                const hd_c64 b = hdi_c(k == 0 ? big[j] : k == 1 ? 0 : big[j], k == 0 ? 0 : k == 3 ? -big[j] / 2 : big[j]);
                const double s = big[i];
                const hd_c64 a = hdi_c(s * (3 * (b.re / big[j]) - 4 * (b.im / big[j])), s * (3 * (b.im / big[j]) + 4 * (b.re / big[j])));
                const hd_c64 q = hdi_cdiv(a, b);
                const double want = s / big[j];
                if (!hdi_finite(5 * want) || want < 1e-290) continue;
                CHECK_MSG(fabs(q.re / want - 3) < 1e-14 && fabs(q.im / want - 4) < 1e-14, "%g / %g, direction %d: %.17g %+.17g i", s, big[j], k, q.re, q.im);
            }
        }
    }
    CHECK(!hdi_cfinite(hdi_cdiv(hdi_c(1, 1), hdi_c(0, 0))));
    CHECK(!hdi_finite((double)NAN) && !hdi_finite((double)INFINITY) && !hdi_finite(-(double)INFINITY) && hdi_finite(DBL_MAX) && hdi_finite(0));
}

static void int_complex(void) {
    const hd_c64 a = hdi_c(2, -3), b = hdi_c(-5, 7), p = hdi_cmul(a, b);
    hd_c64 x[5], y[5], dot;
    int i;
    CHECK(p.re == 11 && p.im == 29);
    CHECK(fabs(hdi_cabs(hdi_c(3e200, 4e200)) / 5e200 - 1) < 1e-15 && hdi_cabs2(a) == 13 && hdi_cconj(a).im == 3);
    for (i = 0; i < 5; i++) {
        x[i] = hdi_c(i, 1);
        y[i] = hdi_c(1, i);
    }
    dot = hdi_cdotu(x, y, 5);                    /* sum (i + I)(1 + i I) = sum (i - i) + I (i^2 + 1) */
    CHECK(dot.re == 0 && dot.im == 35);
}

static void int_sizes(void) {
    size_t out = 77;
    CHECK(hdi_size(3, 4, 5, &out) && out == 17);
    CHECK(hdi_size(0, SIZE_MAX, 5, &out) && out == 5);
    CHECK(hdi_size(SIZE_MAX, 0, 5, &out) && out == 5);
    CHECK(hdi_size(SIZE_MAX, 1, 0, &out) && out == SIZE_MAX);
    out = 77;
    CHECK(!hdi_size(SIZE_MAX, 1, 1, &out) && out == 77);
    CHECK(!hdi_size(SIZE_MAX / 2 + 1, 2, 0, &out) && !hdi_size(2, SIZE_MAX / 2 + 1, 0, &out));
    CHECK(hdi_size(SIZE_MAX / 2, 2, 1, &out) && out == SIZE_MAX);
    CHECK(!hdi_size(SIZE_MAX / 16, 16, 80, &out));
}

/* ---- [03] memory ---- */

static void *int_odd_alloc(void *user, size_t size) {
    char *p = (char *)malloc(size + 8);
    (void)user;
    return p ? p + 8 : NULL;                     /* aligned to 8 and no more */
}

static void int_odd_free(void *user, void *block, size_t size) {
    *(size_t *)user += size;
    free((char *)block - 8);
}

static void int_memory(void) {
    hd_context ctx;
    hd_error e;
    size_t freed = 0, k;
    void *block[40];
    hdi_scope s;
    memset(&ctx, 0, sizeof ctx);
    ctx.allocator.alloc = int_odd_alloc;
    ctx.allocator.free = int_odd_free;
    ctx.allocator.user = &freed;
    hdi_error_clear(&e);
    for (k = 0; k < 40; k++) {
        block[k] = hdi_alloc(&ctx, k * 13, 1, &e);
        CHECK(block[k] && (size_t)block[k] % 64 == 0);
        if (block[k]) memset(block[k], 0x77, k * 13);    /* a sanitizer sees where blocks end */
    }
    CHECK(ctx.allocations == 40 && ctx.bytes_in_use == ctx.bytes_peak);
    for (k = 0; k < 40; k++) hdi_free(&ctx, block[(k * 7) % 40]);
    hdi_free(&ctx, NULL);
    CHECK(ctx.bytes_in_use == 0 && freed == ctx.bytes_peak);
    CHECK(hdi_alloc(&ctx, SIZE_MAX / 2, 8, &e) == NULL && e.status == HD_ERR_TOO_LARGE && ctx.bytes_in_use == 0);
    s = hdi_scope_begin(&ctx, &e);
    CHECK(e.status == HD_OK && e.face == -1 && e.pole == -1);
    block[0] = hdi_take_zero(&s, 10, sizeof(double));
    block[1] = hdi_take(&s, 3, sizeof(int32_t));
    CHECK(hdi_keep(&s, block[0]) == block[0]);
    ctx.allocation_limit = ctx.allocations;
    CHECK(hdi_take(&s, 1, 1) == NULL && e.status == HD_ERR_MEMORY_LIMIT);
    ctx.allocation_limit = 0;
    CHECK(hdi_take(&s, 1, 1) == NULL);           /* after one failure all fail */
    CHECK(hdi_scope_end(&s) == HD_ERR_MEMORY_LIMIT && ctx.bytes_in_use > 0);
    for (k = 0; k < 10; k++) CHECK(((double *)block[0])[k] == 0);
    hdi_free(&ctx, block[0]);
    CHECK(ctx.bytes_in_use == 0);
}

/* ---- [05] arrays ---- */

static int int_compare(const void *a, const void *b) {
    const hdi_pair *x = (const hdi_pair *)a, *y = (const hdi_pair *)b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

/* Orders that are known to hurt: sorted, backwards, equal, saw, organ pipe, random, few values. */
static uint64_t int_key(int shape_of, int64_t i, int64_t n, uint64_t *seed) {
    switch (shape_of) {
        case 0: return (uint64_t)i;
        case 1: return (uint64_t)(n - i);
        case 2: return 5;
        case 3: return (uint64_t)(i % 7);
        case 4: return (uint64_t)(i < n / 2 ? i : n - i);
        case 5: return dense_random(seed);
        default: return dense_random(seed) % 3 << 40;
    }
}

static void int_sorting(void) {
    static const int64_t sizes[14] = {0, 1, 2, 3, 7, 23, 24, 25, 26, 63, 64, 65, 1000, 4097};
    uint64_t seed = 1;
    int k, form;
    int64_t i;
    for (k = 0; k < 14; k++) {
        for (form = 0; form < 7; form++) {
            const int64_t n = sizes[k];
            hdi_pair *a = DENSE_NEW(hdi_pair, n), *b = DENSE_NEW(hdi_pair, n), *work = DENSE_NEW(hdi_pair, n);
            int32_t *x = DENSE_NEW(int32_t, n);
            for (i = 0; i < n; i++) {
                a[i].key = b[i].key = int_key(form, i, n, &seed);
                a[i].id = b[i].id = n - i;
                x[i] = (int32_t)(a[i].key % 100003);
                work[i].key = 0;
            }
            hdi_sort_pairs(a, n);
            qsort(b, (size_t)n, sizeof *b, int_compare);
            CHECK_MSG(memcmp(a, b, (size_t)n * sizeof *a) == 0, "%d pairs of form %d are not sorted", (int)n, form);
            for (i = 0; i < n; i++) {
                b[i].key = (uint64_t)x[i];
                b[i].id = 0;
            }
            qsort(b, (size_t)n, sizeof *b, int_compare);
            hdi_sort_indices(x, n, n > 24 ? work : NULL);
            for (i = 0; i < n && (uint64_t)x[i] == b[i].key; i++) {}
            CHECK_MSG(i == n, "%d indices of form %d are not sorted", (int)n, form);
            free(a);
            free(b);
            free(work);
            free(x);
        }
    }
}

static void int_union_find(void) {
    enum { N = 200 };
    int32_t parent[N], label[N], i, j, k;
    uint64_t seed = 6;
    int64_t count[5] = {3, 0, 2, 7, 0};
    for (i = 0; i < N; i++) parent[i] = label[i] = i;
    for (k = 0; k < 150; k++) {
        const int32_t a = (int32_t)(dense_random(&seed) % N), b = (int32_t)(dense_random(&seed) % N);
        const int32_t la = label[a], lb = label[b];
        hdi_unite(parent, a, b);
        for (i = 0; i < N; i++)
            if (label[i] == la || label[i] == lb) label[i] = la < lb ? la : lb;
    }
    for (i = 0, j = 0; i < N; i++) j += hdi_find(parent, i) != label[i];    /* roots are smallest members */
    CHECK_MSG(j == 0, "%d wrong roots", (int)j);
    CHECK(hdi_prefix_sum(count, 4) == 12 && count[0] == 0 && count[1] == 3 && count[2] == 3 && count[3] == 5 && count[4] == 12);
}

/* ---- [06] dense ---- */

/* Eigenvalues of the second difference, 2 - 2 cos(pi k/(m + 1)), and rows 0 and m - 1 of its eigenvectors. */
static void int_tridiagonal(void) {
    static const int32_t sizes[6] = {1, 2, 3, 10, 77, 300};
    const double pi = 3.141592653589793238;
    int k;
    for (k = 0; k < 6; k++) {
        const int32_t m = sizes[k];
        double *d = DENSE_NEW(double, m), *e = DENSE_NEW(double, m), *z0 = DENSE_NEW(double, m), *z1 = DENSE_NEW(double, m), worst = 0;
        int32_t i, j;
        for (i = 0; i < m; i++) {
            d[i] = 2;
            e[i] = i + 1 < m ? -1 : 1e300;       /* the last is not to be used */
            z0[i] = i == 0;
            z1[i] = i == m - 1;
        }
        CHECK(hdi_tridiag_eigen(d, e, z0, z1, m));
        for (j = 1; j <= m; j++) {
            const double want = 2 - 2 * cos(pi * j / (m + 1)), edge = 2.0 / (m + 1) * pow(sin(pi * j / (m + 1)), 2);
            double best = 10;
            int32_t at = 0;
            for (i = 0; i < m; i++)
                if (fabs(d[i] - want) < best) {
                    best = fabs(d[i] - want);
                    at = i;
                }
            worst = fmax(worst, best);
            worst = fmax(worst, fabs(z0[at] * z0[at] - edge));
            worst = fmax(worst, fabs(z0[at] * z1[at] - (j % 2 ? edge : -edge)));    /* the last component has that sign */
        }
        CHECK_MSG(worst < 1e-12, "m = %d: off by %g", (int)m, worst);
        free(d);
        free(e);
        free(z0);
        free(z1);
    }
}

/* Blocks that fall apart, zero diagonals, and graded entries, by trace and moments. */
static void int_tridiagonal_odd(void) {
    double d[6] = {0, 0, 0, 0, 0, 0}, e[6] = {1, 0, 2, 0, 0, 0}, z0[6] = {1, 0, 0, 0, 0, 0}, z1[6] = {0, 0, 0, 0, 0, 1}, sum = 0, square = 0;
    double g[30], off[30], y0[30], y1[30], trace = 0, got = 0, first = 0;
    int i;
    CHECK(hdi_tridiag_eigen(d, e, z0, z1, 6));   /* +-1, +-2, 0, 0 */
    for (i = 0; i < 6; i++) {
        sum += d[i];
        square += d[i] * d[i];
    }
    CHECK(fabs(sum) < 1e-15 && fabs(square - 10) < 1e-14);
    for (i = 0; i < 30; i++) {
        g[i] = pow(10, -i);
        off[i] = 0.3 * pow(10, -i);
        y0[i] = i == 0;
        y1[i] = i == 29;
        trace += g[i];
    }
    CHECK(hdi_tridiag_eigen(g, off, y0, y1, 30));
    for (i = 0; i < 30; i++) {
        got += g[i];
        first += y0[i] * y0[i] * g[i];           /* (T)_00 */
    }
    CHECK(fabs(got - trace) < 1e-14 && fabs(first - 1) < 1e-14);
    CHECK(hdi_tridiag_eigen(g, off, y0, y1, 0));
}

/* ---- [09] geometry ---- */

/* Points on a line have a cross product of exactly zero, also where products of coordinates are rounded. */
static void int_collinear(void) {
    uint64_t seed = 21;
    int k, q, odd = 0;
    for (k = 0; k < 20000; k++) {
        double a[3], b[3], c[3];
        const double factor = ldexp(k & 1 ? -1 : 1, (int)(dense_random(&seed) % 9) - 4);
        for (q = 0; q < 3; q++) {
            a[q] = dense_signed(&seed) / 3;
            b[q] = factor * a[q];
        }
        hdi_cross3(a, b, c);
        odd += c[0] != 0 || c[1] != 0 || c[2] != 0;
    }
    CHECK_MSG(odd == 0, "%d cross products are not zero", odd);
    CHECK(hdi_det2(3, 5, 2, 7) == 1 && hdi_det2(0.1, 0.3, 0.3, 0.1) == 0 && hdi_det2(0, 1, 1, 0) == 0);
    CHECK(hdi_det2(1 + DBL_EPSILON, 1 - DBL_EPSILON, 1, 1) <= 0);
}

static void int_norm(void) {
    const double tiny[3] = {3e-200, 4e-200, 0}, huge[3] = {0, 3e200, -4e200}, zero[3] = {0, 0, 0};
    CHECK(fabs(hdi_norm3(tiny) / 5e-200 - 1) < 1e-15 && fabs(hdi_norm3(huge) / 5e200 - 1) < 1e-15 && hdi_norm3(zero) == 0);
}

/* ---- [11] symbolic ---- */

static int32_t int_bandwidth(const hd_csr *a, const int32_t *perm) {
    int32_t *place = DENSE_NEW(int32_t, a->n_rows), i, width = 0;
    int64_t p;
    for (i = 0; i < a->n_rows; i++) place[perm[i]] = i;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            if (place[i] - place[a->col[p]] > width) width = place[i] - place[a->col[p]];
    free(place);
    return width;
}

static void int_cuthill_mckee(void) {
    shape s = shape_grid(40, 8, 0.2), two = shape_grid(5, 5, 0), both;
    const double offset[3] = {2, 0, 0};
    hd_laplacian *lap = NULL;
    hd_csr shuffled;
    hd_context ctx;
    hd_error e;
    uint64_t seed = 3;
    int32_t *perm, *seen, i, missing = 0;
    both = shape_disjoint(&s, &two, offset);
    memset(&ctx, 0, sizeof ctx);
    CHECK(hd_laplacian_triangles(&lap, both.xyz, both.n, both.tri, both.n_tri, NULL, &e) == HD_OK);
    perm = DENSE_NEW(int32_t, both.n);
    seen = DENSE_NEW(int32_t, both.n);
    dense_shuffle(perm, both.n, &seed);
    CHECK(hd_csr_permute(&shuffled, &lap->L, perm, NULL, &e) == HD_OK);
    CHECK(hdi_sym_cuthill_mckee(&shuffled, perm, &ctx, &e) == HD_OK);
    for (i = 0; i < both.n; i++)
        if (perm[i] >= 0 && perm[i] < both.n) seen[perm[i]]++;
    for (i = 0; i < both.n; i++) missing += seen[i] != 1;
    CHECK_MSG(missing == 0, "not a permutation: %d", (int)missing);
    CHECK_MSG(int_bandwidth(&shuffled, perm) <= 20, "bandwidth %d of a strip 8 wide", (int)int_bandwidth(&shuffled, perm));
    hd_csr_free(&shuffled, NULL);
    hd_laplacian_free(lap);
    free(perm);
    free(seen);
    shape_free(&s);
    shape_free(&two);
    shape_free(&both);
}

/* ---- [14] precond ---- */

/* A dense complex-symmetric matrix on an upper pattern. */
static dense_c64 *int_dense_of(const hdi_upper *up, const hd_c64 *u, const hd_c64 *d) {
    const size_t n = (size_t)up->n;
    dense_c64 *a = DENSE_NEW(dense_c64, up->n * up->n);
    int32_t i;
    int64_t p;
    for (i = 0; i < up->n; i++) {
        a[(size_t)i * n + (size_t)i] = dense_c(d[i].re, d[i].im);
        for (p = up->ptr[i]; p < up->ptr[i + 1]; p++) {
            const size_t j = (size_t)up->col[p];
            a[(size_t)i * n + j] = a[j * n + (size_t)i] = dense_c(u[p].re, u[p].im);
        }
    }
    return a;
}

/* Random values on a pattern, the diagonal strong and turned well off the real axis. */
static void int_random_values(const hdi_upper *up, hd_c64 *u, hd_c64 *d, uint64_t seed) {
    int32_t i;
    int64_t p;
    for (i = 0; i < up->n; i++) d[i] = hdi_c(0.3, 0.8);
    for (i = 0; i < up->n; i++) {
        for (p = up->ptr[i]; p < up->ptr[i + 1]; p++) {
            u[p] = hdi_c(dense_signed(&seed), dense_signed(&seed));
            d[i] = hdi_cadd(d[i], hdi_c(0.5, 1.5));
            d[up->col[p]] = hdi_cadd(d[up->col[p]], hdi_c(0.5, 1.5));
        }
    }
}

/* Where elimination makes no fill the incomplete factor is the complete one: M x = b is A x = b. */
static void int_ildl_exact(const hdi_upper *up, double keep, const char *what) {
    const int32_t n = up->n;
    hd_c64 *u = DENSE_NEW(hd_c64, up->ptr[n]), *d = DENSE_NEW(hd_c64, n), *diag = DENSE_NEW(hd_c64, n), *x = DENSE_NEW(hd_c64, n), *b = DENSE_NEW(hd_c64, n);
    dense_c64 *a, *y = DENSE_NEW(dense_c64, n);
    int64_t *mark = DENSE_NEW(int64_t, n);
    hdi_precond m;
    uint64_t seed = 8;
    double worst = 0, size = 0;
    int32_t i;
    int_random_values(up, u, d, 5);
    a = int_dense_of(up, u, d);
    for (i = 0; i < n; i++) {
        mark[i] = -1;
        b[i] = hdi_c(dense_signed(&seed), dense_signed(&seed));
        y[i] = dense_c(b[i].re, b[i].im);
    }
    memcpy(diag, d, (size_t)n * sizeof *d);
    hdi_ildl(up, u, d, diag, keep, mark);
    for (i = 0; i < n; i++) d[i] = hdi_cdiv(hdi_c(1, 0), d[i]);
    memset(&m, 0, sizeof m);
    m.kind = HD_PRECOND_MILDL;
    m.up = up;
    m.u = u;
    m.d_inv = d;
    hdi_precond_apply(&m, b, x);
    CHECK(dense_complex_solve(a, y, n));
    for (i = 0; i < n; i++) {
        worst = fmax(worst, hypot(x[i].re - y[i].re, x[i].im - y[i].im));
        size = fmax(size, hypot(y[i].re, y[i].im));
    }
    CHECK_MSG(worst < 1e-12 * size, "%s, keep %g: off by %g", what, keep, worst / size);
    free(u);
    free(d);
    free(diag);
    free(x);
    free(b);
    free(a);
    free(y);
    free(mark);
}

static hdi_upper int_upper_new(int32_t n, int64_t nnz) {
    hdi_upper up;
    up.n = n;
    up.ptr = DENSE_NEW(int64_t, n + 1);
    up.col = DENSE_NEW(int32_t, nnz);
    return up;
}

static void int_ildl_trees(void) {
    enum { N = 60 };
    hdi_upper up = int_upper_new(N, N * N);
    uint64_t seed = 14;
    int32_t i, j;
    int k;
    for (k = 0; k < 4; k++) {                    /* path, random tree, star with its hub last, full matrix */
        int64_t nnz = 0;
        for (i = 0; i < N; i++) {
            up.ptr[i] = nnz;
            if (k == 3) for (j = i + 1; j < N; j++) up.col[nnz++] = j;
            else if (i + 1 < N) up.col[nnz++] = k == 0 ? i + 1 : k == 1 ? i + 1 + (int32_t)(dense_random(&seed) % (uint64_t)(N - 1 - i)) : N - 1;
        }
        up.ptr[N] = nnz;
        int_ildl_exact(&up, 0, k == 0 ? "path" : k == 1 ? "tree" : k == 2 ? "star" : "full");
        int_ildl_exact(&up, 0.97, k == 0 ? "path" : k == 1 ? "tree" : k == 2 ? "star" : "full");
    }
    free(up.ptr);
    free(up.col);
}

/* All of the dropped fill goes to the diagonal when keep = 1: M 1 = A 1. Rows of very different lengths, so that both ways of
 * searching are taken. And with keep = 0, M equals A on the pattern. */
static void int_ildl_row_sums(void) {
    enum { N = 160 };
    hdi_upper up = int_upper_new(N, N * N);
    uint64_t seed = 31;
    int64_t nnz = 0, p;
    int32_t i, j, k;
    int keep;
    for (i = 0; i < N; i++) {
        up.ptr[i] = nnz;
        for (j = i + 1; j < N; j++)
            if (dense_random(&seed) % 100 < (i == 12 || i == 40 ? 90u : 3u) || (i < 12 && (j == 12 || j == 40))) up.col[nnz++] = j;
    }
    up.ptr[N] = nnz;
    for (keep = 0; keep < 2; keep++) {
        hd_c64 *u = DENSE_NEW(hd_c64, nnz), *d = DENSE_NEW(hd_c64, N), *diag = DENSE_NEW(hd_c64, N);
        int64_t *mark = DENSE_NEW(int64_t, N);
        dense_c64 *a, *m = DENSE_NEW(dense_c64, N * N), *f;
        double worst = 0;
        int_random_values(&up, u, d, 2);
        a = int_dense_of(&up, u, d);
        memcpy(diag, d, N * sizeof *d);
        for (i = 0; i < N; i++) mark[i] = -1;
        hdi_ildl(&up, u, d, diag, keep, mark);
        f = int_dense_of(&up, u, d);             /* M = (I + U') D (I + U) */
        for (k = 0; k < N; k++) {
            const dense_c64 dk = f[k * N + k];
            for (i = k; i < N; i++) {
                const dense_c64 l = i == k ? dense_c(1, 0) : f[k * N + i];
                const dense_c64 w = dense_cfma(dense_c(0, 0), dense_c(-l.re, -l.im), dk);
                if (l.re == 0 && l.im == 0) continue;
                for (j = k; j < N; j++) m[i * N + j] = dense_cfma(m[i * N + j], dense_c(-w.re, -w.im), j == k ? dense_c(1, 0) : f[k * N + j]);
            }
        }
        for (i = 0; i < N; i++) {
            double re = 0, im = 0;
            for (j = 0; keep && j < N; j++) {
                re += m[i * N + j].re - a[i * N + j].re;
                im += m[i * N + j].im - a[i * N + j].im;
            }
            worst = fmax(worst, hypot(re, im));
            for (p = up.ptr[i]; p < up.ptr[i + 1]; p++) {
                j = up.col[p];
                worst = fmax(worst, hypot(m[i * N + j].re - a[i * N + j].re, m[i * N + j].im - a[i * N + j].im));
            }
            if (!keep) worst = fmax(worst, hypot(m[i * N + i].re - a[i * N + i].re, m[i * N + i].im - a[i * N + i].im));
        }
        CHECK_MSG(worst < 1e-10, "keep %d: M and A differ by %g", keep, worst);
        free(u);
        free(d);
        free(diag);
        free(mark);
        free(a);
        free(m);
        free(f);
    }
    free(up.ptr);
    free(up.col);
}

/* The path with n vertices and B = tridiag(1, 4, 1), as a Laplacian. */
static hd_laplacian *int_path(int32_t n) {
    int32_t *i = DENSE_NEW(int32_t, 3 * n), *j = DENSE_NEW(int32_t, 3 * n), k;
    double *l = DENSE_NEW(double, 3 * n), *b = DENSE_NEW(double, 3 * n);
    hd_laplacian *lap = NULL;
    hd_csr L, B;
    hd_error e;
    int64_t c = 0;
    for (k = 0; k < n; k++) {
        const int ends = (k == 0) + (k == n - 1);
        i[c] = j[c] = k; l[c] = 2 - ends; b[c++] = 4;
        if (k + 1 < n) { i[c] = k; j[c] = k + 1; l[c] = -1; b[c++] = 1; }
        if (k > 0) { i[c] = k; j[c] = k - 1; l[c] = -1; b[c++] = 1; }
    }
    CHECK(hd_csr_from_triplets(&L, n, n, c, i, j, l, NULL, &e) == HD_OK && hd_csr_from_triplets(&B, n, n, c, i, j, b, NULL, &e) == HD_OK);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    free(i);
    free(j);
    free(l);
    free(b);
    return lap;
}

/* On a path no elimination fills in, so both incomplete factors are exact; Jacobi and SSOR by their definitions. */
static void int_precond_make(void) {
    enum { N = 23 };
    hd_laplacian *lap = int_path(N);
    hd_context ctx;
    hd_error e;
    hdi_upper up;
    hdi_system a;
    hdi_precond m;
    hd_c64 u[N], d[N], work[N], x[N], ax[N], back[N];
    int64_t mark[N];
    uint64_t seed = 7;
    int32_t i;
    int kind;
    memset(&ctx, 0, sizeof ctx);
    memset(&m, 0, sizeof m);
    CHECK(hdi_upper_make(&up, &lap->L, &ctx, &e) == HD_OK && up.ptr[N] == N - 1);
    a.lap = lap;
    a.t = 1.5;
    a.theta = hdi_c(-0.2, 5);
    m.up = &up;
    for (i = 0; i < N; i++) x[i] = hdi_c(dense_signed(&seed), dense_signed(&seed));
    hdi_system_apply(&a, x, ax);
    for (kind = HD_PRECOND_JACOBI; kind <= HD_PRECOND_MILDL; kind++) {
        double worst = 0;
        m.kind = (hd_precond)kind;
        m.u = kind == HD_PRECOND_JACOBI ? NULL : u;
        m.d_inv = d;
        hdi_precond_make(&m, &a, work, mark);
        if (kind >= HD_PRECOND_ILDL) {
            hdi_precond_apply(&m, ax, back);
            for (i = 0; i < N; i++) worst = hdi_max(worst, hdi_cabs(hdi_csub(back[i], x[i])));
        } else {
            for (i = 0; i < N; i++) {
                const int ends = (i == 0) + (i == N - 1);
                const hd_c64 diag = hdi_c(1.5 * (2 - ends) - 0.2 * 4, 20), off = hdi_c(-1.5 - 0.2, 5);
                worst = hdi_max(worst, hdi_cabs(hdi_csub(hdi_cmul(diag, d[i]), hdi_c(1, 0))));
                if (m.u && i + 1 < N) worst = hdi_max(worst, hdi_cabs(hdi_csub(hdi_cmul(u[i], diag), off)));
            }
        }
        CHECK_MSG(worst < 1e-13, "preconditioner %d: off by %g", kind, worst);
    }
    hdi_upper_free(&ctx, &up);
    hd_laplacian_free(lap);
}

/* ---- [15] krylov: directions without constants ---- */

static void int_deflation(void) {
    enum { N = 30 };
    hd_laplacian *lap = int_path(N);
    hdi_krylov k;
    hdi_upper up;
    hd_context ctx;
    hd_error e;
    hd_c64 r[N], z[N], p[N], sums[1], mean = hdi_c(0, 0), dot, want = hdi_c(0, 0);
    uint64_t seed = 2;
    int32_t i;
    memset(&ctx, 0, sizeof ctx);
    memset(&k, 0, sizeof k);
    CHECK(hdi_upper_make(&up, &lap->L, &ctx, &e) == HD_OK);
    k.a.lap = lap;
    k.sums = sums;
    k.m.up = &up;
    k.m.kind = HD_PRECOND_NONE;
    for (i = 0; i < N; i++) {
        r[i] = hdi_c(1 + dense_signed(&seed), 2 + dense_signed(&seed));
        p[i] = hdi_c(0, 0);
        want = hdi_cadd(want, hdi_cmul(r[i], r[i]));
    }
    dot = hdi_krylov_precond_dot(&k, r, z);
    CHECK(hdi_cabs(hdi_csub(dot, want)) < 1e-13 * hdi_cabs(want));
    hdi_krylov_deflated_direction(&k, hdi_c(0, 0), z, p);
    for (i = 0; i < N; i++) mean = hdi_cadd(mean, hdi_cscale(lap->mass[i], p[i]));
    CHECK_MSG(hdi_cabs(mean) < 1e-12, "the direction's mean is %g", hdi_cabs(mean));
    mean = hdi_c(0, 0);
    hdi_deflate(lap, r, sums);
    for (i = 0; i < N; i++) mean = hdi_cadd(mean, hdi_cscale(lap->mass[i], r[i]));
    CHECK_MSG(hdi_cabs(mean) < 1e-12, "the mean left is %g", hdi_cabs(mean));
    hdi_upper_free(&ctx, &up);
    hd_laplacian_free(lap);
}

/* ---- [17] shifted: starts from other poles ---- */

/* The last pole is solved first and the first one last, from a combination of all others, which saves it a third of its steps. */
static void int_warm_start(void) {
    shape s = shape_bumpy(3, 4);
    hd_laplacian *lap = NULL;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_report rep;
    double *u = DENSE_NEW(double, s.n);
    memset(&o, 0, sizeof o);
    o.solver = HD_SOLVER_COCG;
    o.poles = HD_POLES_KERNEL;
    o.degree = 10;
    o.tol = 1e-10;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, NULL, NULL) == HD_OK);
    CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    CHECK(hd_heat_column(heat, 100 * lap->h * lap->h, 3, u, &rep) >= 0 && rep.n_poles == 5);
    CHECK_MSG(rep.pole_iterations[0] * 5 <= rep.pole_iterations[4] * 4, "%d steps for the last pole, %d for the first", (int)rep.pole_iterations[4],
              (int)rep.pole_iterations[0]);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(u);
}

/* ---- [16], [17]: bounds over the poles ---- */

static void int_pole_bounds(void) {
    uint64_t seed = 4;
    int k, i;
    for (k = 0; k < 400; k++) {
        const double size = pow(10, 2 * dense_signed(&seed));
        const hd_c64 theta = hdi_c(size * 3 * dense_signed(&seed), size * (0.01 + fabs(dense_signed(&seed))));
        double nearest = HUGE_VAL, most = 0, far_most;
        for (i = 0; i <= 20000; i++) {           /* x from 0 over 1e-4 to 1e6, and closely around the pole */
            const double x = i == 0 ? 0 : i % 2 ? pow(10, -4 + i * 5e-4) : fmax(0, -theta.re + (i - 10000) * 1e-3 * size);
            nearest = fmin(nearest, hypot(x + theta.re, theta.im));
            most = fmax(most, hypot(x + theta.re, theta.im) / (1 + x));
        }
        far_most = hdi_resolvent_ratio(theta);
        CHECK_MSG(fabs(hdi_pole_distance(theta) / nearest - 1) < 1e-4 && hdi_pole_distance(theta) <= nearest * (1 + 1e-12), "theta %g %+g i: distance %g, seen %g",
                  theta.re, theta.im, hdi_pole_distance(theta), nearest);
        CHECK_MSG(far_most >= most * (1 - 1e-12) && far_most <= most * 1.001, "theta %g %+g i: ratio %g, seen %g", theta.re, theta.im, far_most, most);
    }
    CHECK(hdi_resolvent_ratio(hdi_c(1, 0)) == 1 && hdi_resolvent_ratio(hdi_c(5, 0)) == 5 && hdi_resolvent_ratio(hdi_c(0.2, 0)) == 1);
    CHECK(hdi_pole_distance(hdi_c(2, 0)) == 2);
}

/* ---- [18] Lanczos ---- */

/* Lanczos from e_1 on a tridiagonal T gives T back: m steps leave exp(-t T_m) e_1, and the bound must hold against exp(-t T) e_1. */
static void int_lanczos_bound(void) {
    enum { N = 60 };
    double *T = DENSE_NEW(double, N * N), *one = DENSE_NEW(double, N * N), start[N] = {1}, want[N], got[N], alpha[N + 1], beta[N + 1], d[N], e[N], z0[N], z1[N], y[N];
    static const double times[4] = {0.1, 1, 10, 100};
    hd_c64 work[2 * N];
    hd_rational set;
    dense_pair whole, part;
    hdi_lanczos z;
    hd_error err;
    uint64_t seed = 12;
    int32_t i, m;
    int k;
    double loosest = 0;
    memset(&z, 0, sizeof z);
    z.alpha = alpha;
    z.beta = beta;
    z.d = d;
    z.e = e;
    z.z0 = z0;
    z.z1 = z1;
    z.y = y;
    z.work = work;
    beta[0] = 0;
    for (i = 0; i < N; i++) {                    /* positive: diagonally dominant */
        alpha[i] = 2.2 + dense_signed(&seed);
        beta[i + 1] = 0.5 + 0.1 * dense_signed(&seed);
        T[i * N + i] = alpha[i];
        if (i + 1 < N) T[i * N + i + 1] = T[(i + 1) * N + i] = beta[i + 1];
        one[i * N + i] = 1;
    }
    CHECK(hdi_rational_get(&set, HD_POLES_UNIFORM, 14, &err) == HD_OK);
    CHECK(dense_pair_solve(&whole, T, one, N));
    for (m = 1; m < N; m += 3) {
        double *Tm = DENSE_NEW(double, m * m), *Im = DENSE_NEW(double, m * m);
        for (i = 0; i < m; i++) {
            Tm[i * m + i] = alpha[i];
            if (i + 1 < m) Tm[i * m + i + 1] = Tm[(i + 1) * m + i] = beta[i + 1];
            Im[i * m + i] = 1;
        }
        CHECK(dense_pair_solve(&part, Tm, Im, m));
        for (k = 0; k < 4; k++) {
            double bound = -1, error = 0;
            z.m = m;
            CHECK(hdi_lanczos_bound(&z, times[k], &bound, &err) == HD_OK);
            dense_pair_heat(&whole, times[k], start, want);
            memset(got, 0, sizeof got);
            dense_pair_heat(&part, times[k], start, got);
            for (i = 0; i < N; i++) error += (want[i] - got[i]) * (want[i] - got[i]);
            error = sqrt(error);
            CHECK_MSG(error <= bound * (1 + 1e-9) + 1e-14, "m %d, t %g: error %g, bound %g", (int)m, times[k], error, bound);
            if (error > 1e-10 && times[k] <= 1) loosest = fmax(loosest, bound / error);
            hdi_lanczos_coefficients(&z, times[k], &set);
            CHECK_MSG(dense_max_diff(y, got, m) < 2e-13, "m %d, t %g: coefficients off by %g", (int)m, times[k], dense_max_diff(y, got, m));
        }
        dense_pair_free(&part);
    }
    CHECK_MSG(loosest < 20, "bounds up to %g times the error", loosest);
    dense_pair_free(&whole);
}

int main(void) {
    int_division();
    int_complex();
    int_sizes();
    int_memory();
    int_sorting();
    int_union_find();
    int_tridiagonal();
    int_tridiagonal_odd();
    int_collinear();
    int_norm();
    int_cuthill_mckee();
    int_ildl_trees();
    int_ildl_row_sums();
    int_precond_make();
    int_deflation();
    int_warm_start();
    int_pole_bounds();
    int_lanczos_bound();
    printf("%lld passed, %lld failed\n", (long long)int_passed, (long long)int_failed);
    return int_failed > 0;
}
