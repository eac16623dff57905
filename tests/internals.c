/* internals.c - tests of what heatdiff.h does not show: the hdi_ functions, reached by including the implementation

       cc -std=c99 tests/internals.c -I. -lm -o internals && ./internals

   internals --traps    the first invalid operation, division by zero or overflow ends the run with SIGFPE (glibc, x86)

   Prints what failed, with file and line, and at the end `N passed, N failed`. Exit status 1 when any check failed. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "guard.h"
#include "traps.h"
#ifdef __linux__                                 /* what the library tells the system of its memory */
#include <sys/mman.h>
static char *int_advised_at;
static size_t int_advised;
static int int_advise(void *at, size_t size, int advice) {
    int_advised_at = (char *)at;
    int_advised = size;
    return advice - advice;
}
#define madvise int_advise
#endif
#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "dense.h"
#include "../tools/shapes.h"
#include "at.h"

static int64_t int_passed, int_failed;

/* Private functions take an error that is clear. */
static hd_error int_no_error(void) {
    hd_error e;
    hdi_error_clear(&e);
    return e;
}

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

#include "../tools/trials.h"
#include "kit.h"

/* ---- [01] scalar ---- */

/* (3 + 4i) b / b for b in four directions, of all sizes. */
static void int_division(void) {
    static const double big[5] = {1, 1e300, 1e-300, 1e150, 1e-150}, turn[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -0.5}};
    int i, j, k;
    TRAPS_OFF;                                   /* by nothing, and beyond the largest number */
    for (i = 0; i < 5; i++)
        for (j = 0; j < 5; j++)
            for (k = 0; k < 4; k++) {
                const double s = big[i], x = turn[k][0], y = turn[k][1], want = s / big[j];
                const hd_c64 q = hdi_cdiv(hdi_c(s * (3 * x - 4 * y), s * (3 * y + 4 * x)), hdi_c(big[j] * x, big[j] * y));
                if (!hdi_finite(5 * want) || want < 1e-290) continue;
                CHECK_MSG(fabs(q.re / want - 3) < 1e-14 && fabs(q.im / want - 4) < 1e-14, "%g / %g, direction %d: %.17g %+.17g i", s,
                          big[j], k, q.re, q.im);
            }
    CHECK(!hdi_cfinite(hdi_cdiv(hdi_c(1, 1), hdi_c(0, 0))));
    TRAPS_ON;
}

static void int_not_finite(void) {
    const double x[6] = {0, DBL_MAX, -DBL_MAX, (double)INFINITY, -(double)INFINITY, (double)NAN};
    int k;
    for (k = 0; k < 6; k++) CHECK(hdi_finite(x[k]) == (k < 3) && hdi_nan(x[k]) == (k == 5) && hdi_nan(-x[k]) == (k == 5));
}

static void int_complex(void) {
    const hd_c64 a = hdi_c(2, -3), p = hdi_cmul(a, hdi_c(-5, 7));
    CHECK(p.re == 11 && p.im == 29);
    CHECK(fabs(hdi_cabs(hdi_c(3e200, 4e200)) / 5e200 - 1) < 1e-15 && hdi_cabs2(a) == 13 && hdi_cconj(a).im == 3);
}

/* a b + c within a limit, or nothing. */
static void int_sizes(void) {
    const uint64_t all = UINT64_MAX, small = UINT32_MAX;   /* small: what an address of 32 bits reaches */
    const struct { uint64_t a, b, c, limit; int fits; uint64_t size; } row[13] = {
        {3, 4, 5, all, 1, 17}, {0, all, 5, all, 1, 5}, {all, 0, 5, all, 1, 5}, {all, 1, 0, all, 1, all},
        {all / 2, 2, 1, all, 1, all}, {small / 8, 8, 7, small, 1, small}, {all, 1, 1, all, 0, 0}, {all / 2 + 1, 2, 0, all, 0, 0},
        {2, all / 2 + 1, 0, all, 0, 0}, {all / 16, 16, 80, all, 0, 0},
        {small + 1, 8, 0, small, 0, 0}, {small / 8, 8, 80, small, 0, 0}, {0, 8, 80, 79, 0, 0}};
    int k;
    for (k = 0; k < 13; k++) {
        uint64_t out = 77;
        const int fits = hdi_size(row[k].a, row[k].b, row[k].c, row[k].limit, &out);
        CHECK_MSG(fits == row[k].fits && out == (fits ? row[k].size : 77), "row %d", k);
    }
}

/* ---- [02] error ---- */

/* Megabytes to one decimal, rounded up; what is too long for the text is left out. */
static void int_texts(void) {
    static const double bytes[8] = {0, 1, 1e5, 100001, 999999, 123456789, 5e9, 9.9e5}, want[8] = {0, 1, 1, 2, 10, 1235, 50000, 10};
    static const double tenths[12] = {0, 1, 9, 10, 11, 99, 100, 101, 109, 110, 1005, 10000};
    char text[400];
    hd_error e;
    size_t k, wrong = 0;
    for (k = 0; k < 20; k++) {
        hdi_error_clear(&e);
        hdi_text_bytes(&e, k < 8 ? bytes[k] : 1e5 * (tenths[k - 8] - (k % 2 ? 0.5 : 0)));
        sprintf(text, "%.1f MB", (k < 8 ? want[k] : tenths[k - 8]) / 10);
        CHECK_MSG(strcmp(e.text, text) == 0, "%s, not %s", e.text, text);
    }
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = 0;
    CHECK(hdi_fail(&e, HD_ERR_ARGUMENT, text) == HD_ERR_ARGUMENT && strlen(e.text) == sizeof e.text - 1 && e.text[0] == 'x');
    hdi_error_clear(&e);
    for (k = 0; k < 200; k++) hdi_text_add(&e, "abcdefg");
    for (k = 0; k + 1 < sizeof e.text; k++) wrong += e.text[k] != (char)('a' + k % 7);
    CHECK(wrong == 0 && strlen(e.text) == sizeof e.text - 1);
}

/* Sums keep what rounding takes away, whichever of two numbers is the larger. */
static void int_sums(void) {
    static const double x[2][5] = {{1, 1e16, 3, -1e16, 1e-3}, {1e16, 1, -1e16, 3, 1e-3}};
    int k, i;
    for (k = 0; k < 2; k++) {
        hdi_sum s = {0, 0};
        for (i = 0; i < 5; i++) hdi_sum_add(&s, x[k][i]);
        CHECK_MSG(fabs(s.high + s.low - 4.001) < 1e-15 * 8, "%.17g", s.high + s.low);
    }
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

/* Blocks are aligned whatever the allocator gives; all that is taken is given back, with its size. */
static void int_memory(void) {
    hd_context ctx;
    hd_error e = int_no_error();
    size_t freed = 0, k;
    void *block[40];
    memset(&ctx, 0, sizeof ctx);
    ctx.allocator.alloc = int_odd_alloc;
    ctx.allocator.free = int_odd_free;
    ctx.allocator.user = &freed;
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
    ctx.byte_limit = 1;                          /* which the largest array that an address can tell meets, one byte more does not */
    for (k = 0; k < 2; k++) {
        hdi_error_clear(&e);
        CHECK(hdi_alloc(&ctx, PTRDIFF_MAX - HDI_ALIGN - HDI_HEADER + k, 1, &e) == NULL);
        CHECK(e.status == (k ? HD_ERR_TOO_LARGE : HD_ERR_MEMORY_LIMIT));
    }
}

/* Advice on large blocks begins where their first pages do, and ends where they end. */
static void int_large_pages(void) {
#ifdef MADV_HUGEPAGE
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    hd_context ctx;
    hd_error e = int_no_error();
    size_t k;
    memset(&ctx, 0, sizeof ctx);
    for (k = 0; k < 6; k++) {
        const size_t size = ((size_t)5 << 20) + 5000 * k;
        char *p = (char *)hdi_alloc(&ctx, size, 1, &e), *first = p - HDI_ALIGN - HDI_HEADER;
        CHECK_MSG((size_t)int_advised_at % page == 0 && int_advised >= size, "%zu of %zu bytes, %zu past a page",
                  int_advised, size, (size_t)int_advised_at % page);
        CHECK(p && int_advised_at > first - page && int_advised_at + int_advised >= p + size &&
              int_advised_at + int_advised <= p + size + HDI_ALIGN);
        hdi_free(&ctx, p);
    }
#endif
}

/* ---- [05] arrays ---- */

static void int_arrays(void) {
    static const int32_t rel[9] = {-4, -1, 0, 0, 3, 3, 3, 8, 900}, filled[6] = {9, -3, -3, -3, -3, 9}, own[6] = {9, 0, 1, 2, 3, 9};
    static const int64_t sums[6] = {0, 2, 2, 7, 8, 77};
    int32_t a[6] = {9, 9, 9, 9, 9, 9};
    int64_t count[6] = {2, 0, 5, 1, -7, 77};
    int64_t n, x, at, wrong = 0;
    hdi_fill_i32(a + 1, 4, -3);
    CHECK(memcmp(a, filled, sizeof a) == 0);
    hdi_fill_own(a + 1, 4);
    CHECK(memcmp(a, own, sizeof a) == 0);
    CHECK(hdi_prefix_sum(count, 4) == 8 && memcmp(count, sums, sizeof count) == 0);
    CHECK(hdi_fullest(count, 4) == 5 && hdi_fullest(count, 2) == 2 && hdi_fullest(count + 1, 1) == 1 && hdi_fullest(count, 0) == 1);
    for (n = 0; n <= 9; n++)
        for (x = -6; x < 910; x++) {
            for (at = 0; at < n && rel[at] < x; at++) {}
            wrong += hdi_lower_bound(rel, n, x) != at;
        }
    CHECK(wrong == 0);
}

static int int_compare(const void *a, const void *b) {
    const hdi_pair *x = (const hdi_pair *)a, *y = (const hdi_pair *)b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

/* Orders that are known to hurt: sorted, backwards, equal, saw, organ pipe, random, few values. */
static uint64_t int_key(int form, int64_t i, int64_t n, uint64_t *seed) {
    switch (form) {
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
    for (k = 0; k < 14; k++)
        for (form = 0; form < 7; form++) {
            const int64_t n = sizes[k];
            hdi_pair *a = KIT_NEW(hdi_pair, n), *b = KIT_NEW(hdi_pair, n);
            uint64_t *x = KIT_NEW(uint64_t, n + 1);
            for (i = 0; i < n; i++) {
                a[i].key = b[i].key = int_key(form, i, n, &seed);
                a[i].id = b[i].id = n - i;
                x[i] = a[i].key % 100003;
            }
            x[n] = 5;                            /* not theirs */
            hdi_sort_pairs(a, n);
            qsort(b, (size_t)n, sizeof *b, int_compare);
            CHECK_MSG(memcmp(a, b, (size_t)n * sizeof *a) == 0, "%d pairs of form %d are not sorted", (int)n, form);
            for (i = 0; i < n; i++) {
                b[i].key = x[i];
                b[i].id = 0;
            }
            qsort(b, (size_t)n, sizeof *b, int_compare);
            hdi_sort_keys(x, n);
            for (i = 0; i < n && x[i] == b[i].key; i++) {}
            CHECK_MSG(i == n && x[n] == 5, "%d keys of form %d are not sorted", (int)n, form);
        }
}

static void int_union_find(void) {
    enum { N = 200 };
    int32_t parent[N], label[N], i, k, wrong = 0;
    uint64_t seed = 6;
    for (i = 0; i < N; i++) parent[i] = label[i] = i;
    for (k = 0; k < 150; k++) {
        const int32_t a = (int32_t)(dense_random(&seed) % N), b = (int32_t)(dense_random(&seed) % N);
        const int32_t la = label[a], lb = label[b];
        wrong += hdi_unite(parent, a, b) != (la != lb);
        for (i = 0; i < N; i++)
            if (label[i] == la || label[i] == lb) label[i] = la < lb ? la : lb;
    }
    for (i = 0; i < N; i++) wrong += hdi_find(parent, i) != label[i];    /* roots are smallest members */
    CHECK_MSG(wrong == 0, "%d wrong roots", (int)wrong);
}

/* ---- [06] vectors ---- */

/* Eigenvalues of the second difference, 2 - 2 cos(pi k/(m + 1)), and rows 0 and m - 1 of its eigenvectors. */
static void int_tridiagonal(void) {
    static const int32_t sizes[6] = {1, 2, 3, 10, 77, 300};
    const double pi = 3.141592653589793238;
    int k;
    for (k = 0; k < 6; k++) {
        const int32_t m = sizes[k];
        double *d = KIT_NEW(double, 4 * m + 2), *e = d + m + 1, *z = e + m + 1, worst = 0;
        int32_t i, j, at;
        d[m] = e[m] = NAN;                       /* not theirs */
        for (i = 0; i < m; i++) {
            d[i] = 2;
            e[i] = i + 1 < m ? -1 : 1e300;       /* the last is not to be used */
            z[2 * i] = i == 0;
            z[2 * i + 1] = i == m - 1;
        }
        CHECK(hdi_tridiag_eigen(d, e, z, m, 2));
        for (j = 1; j <= m; j++) {
            const double want = 2 - 2 * cos(pi * j / (m + 1)), edge = 2.0 / (m + 1) * pow(sin(pi * j / (m + 1)), 2);
            for (i = 1, at = 0; i < m; i++)
                if (fabs(d[i] - want) < fabs(d[at] - want)) at = i;
            worst = fmax(worst, fabs(d[at] - want));
            worst = fmax(worst, fabs(z[2 * at] * z[2 * at] - edge));
            worst = fmax(worst, fabs(z[2 * at] * z[2 * at + 1] - (j % 2 ? edge : -edge)));    /* the last component has that sign */
        }
        CHECK_MSG(worst < 1e-12, "m = %d: off by %g", (int)m, worst);
    }
}

/* Blocks that fall apart with zero diagonals, and graded entries: moments of the spectrum, and (T)_00. Then nothing, and no numbers. */
static void int_tridiagonal_odd(void) {
    double d[30] = {0}, e[30] = {1, 0, 2}, z[60] = {1}, sum = 0, square = 0, first = 0, trace = 0;
    int i;
    CHECK(hdi_tridiag_eigen(d, e, z, 6, 2));   /* +-1, +-2, 0, 0 */
    for (i = 0; i < 6; i++) {
        sum += d[i];
        square += d[i] * d[i];
    }
    CHECK(fabs(sum) < 1e-15 && fabs(square - 10) < 1e-14);
    for (i = 0, sum = 0; i < 30; i++) {
        d[i] = pow(10, -i);
        e[i] = 0.3 * pow(10, -i);
        z[2 * i] = i == 0;
        z[2 * i + 1] = i == 29;
        trace += d[i];
    }
    CHECK(hdi_tridiag_eigen(d, e, z, 30, 2));
    for (i = 0; i < 30; i++) {
        sum += d[i];
        first += z[2 * i] * z[2 * i] * d[i];
    }
    CHECK(fabs(sum - trace) < 1e-14 && fabs(first - 1) < 1e-14);
    CHECK(hdi_tridiag_eigen(d, e, z, 0, 2));
    d[0] = d[1] = e[0] = (double)NAN;            /* nothing ever gets small */
    CHECK(!hdi_tridiag_eigen(d, e, z, 2, 2));
}

/* ---- [10] geometry ---- */

/* Points on a line have a cross product of exactly zero, also where products are rounded. Norms neither overflow nor vanish. */
static void int_collinear(void) {
    const double tiny[3] = {3e-200, 4e-200, 0}, huge[3] = {0, 3e200, -4e200}, zero[3] = {0, 0, 0};
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
    CHECK(fabs(hdi_norm3(tiny) / 5e-200 - 1) < 1e-15 && fabs(hdi_norm3(huge) / 5e200 - 1) < 1e-15 && hdi_norm3(zero) == 0);
}

/* ---- [19] precond ---- */

static dense_c64 *int_dense_of(const hdi_upper *up, const hd_c64 *u, const hd_c64 *d) {
    const int32_t n = up->n;
    dense_c64 *a = KIT_NEW(dense_c64, n * n);
    int32_t i;
    int64_t p;
    for (i = 0; i < n; i++) {
        a[i * n + i] = dense_c(d[i].re, d[i].im);
        for (p = up->ptr[i]; p < up->ptr[i + 1]; p++) a[i * n + up->col[p]] = a[up->col[p] * n + i] = dense_c(u[p].re, u[p].im);
    }
    return a;
}

/* The incomplete factors M = (I + U') D (I + U) of random values A on a pattern, multiplied out. How far M is from A: off the diagonal
 * where A has entries, on the diagonal, elsewhere, and in the sums of rows; and what M leaves of b when it has solved for it. */
enum { INT_ENTRIES, INT_DIAGONAL, INT_FILL, INT_SUMS, INT_SOLVED, INT_OFF };

static void int_ildl_of(const hdi_upper *up, double keep, double off[INT_OFF]) {
    const int32_t n = up->n;
    hd_c64 *u = KIT_NEW(hd_c64, up->ptr[n] + 4 * n), *d = u + up->ptr[n], *diag = d + n, *b = diag + n, *x = b + n;
    int64_t p;
    dense_c64 *a, *f, *m = KIT_NEW(dense_c64, n * n);
    hdi_precond of;
    hdi_precond_row row = hdi_preconds[HD_PRECOND_MILDL];
    uint64_t seed = 5;
    int32_t i, j, k;
    for (i = 0; i < n; i++) {                    /* the diagonal strong, and turned well off the real axis */
        d[i] = hdi_cadd(d[i], hdi_c(0.3, 0.8));
        b[i] = hdi_c(dense_signed(&seed), dense_signed(&seed));
        for (p = up->ptr[i]; p < up->ptr[i + 1]; p++) {
            u[p] = hdi_c(dense_signed(&seed), dense_signed(&seed));
            d[i] = hdi_cadd(d[i], hdi_c(0.5, 1.5));
            d[up->col[p]] = hdi_cadd(d[up->col[p]], hdi_c(0.5, 1.5));
        }
    }
    a = int_dense_of(up, u, d);
    row.keep = keep;
    of.row = &row;
    of.up = up;
    of.u = u;
    of.d = d;
    hdi_ildl(&of, diag);
    f = int_dense_of(up, u, d);
    for (k = 0; k < n; k++) {
        const dense_c64 dk = f[k * n + k];
        f[k * n + k] = dense_c(1, 0);
        for (i = k; i < n; i++) {
            const dense_c64 l = f[k * n + i], w = dense_cfma(dense_c(0, 0), l, dk);      /* - l dk */
            for (j = k; j < n && (l.re != 0 || l.im != 0); j++) m[i * n + j] = dense_cfma(m[i * n + j], w, f[k * n + j]);
        }
    }
    for (i = 0; i < n; i++) d[i] = hdi_cdiv(hdi_c(1, 0), d[i]);
    row.apply(&of, b, x, NULL);
    for (k = 0; k < INT_OFF; k++) off[k] = 0;
    for (i = 0; i < n; i++) {
        dense_c64 sum = dense_c(0, 0), left = dense_c(b[i].re, b[i].im);
        for (j = 0; j < n; j++) {
            const dense_c64 c = a[i * n + j], r = dense_c(m[i * n + j].re - c.re, m[i * n + j].im - c.im);
            const int where = i == j ? INT_DIAGONAL : c.re != 0 || c.im != 0 ? INT_ENTRIES : INT_FILL;
            off[where] = fmax(off[where], hypot(r.re, r.im));
            sum = dense_c(sum.re + r.re, sum.im + r.im);
            left = dense_cfma(left, m[i * n + j], dense_c(x[j].re, x[j].im));
        }
        off[INT_SUMS] = fmax(off[INT_SUMS], hypot(sum.re, sum.im));
        off[INT_SOLVED] = fmax(off[INT_SOLVED], hypot(left.re, left.im));
    }
}

/* Where elimination makes no fill the incomplete factors are the complete ones. Else they have the entries of A, and with keep 0 its
 * diagonal, with keep 1 its sums of rows. Rows of very different lengths, so that both ways of searching are taken. */
static void int_ildl(void) {
    enum { N = 160, PATH = 0, TREE, STAR, FULL, RANDOM };
    static int64_t ptr[N + 1];
    static int32_t col[N * N];
    hdi_upper up;
    uint64_t seed = 14;
    int32_t i, j;
    int kind, keep, k;
    up.ptr = ptr;
    up.col = col;
    for (kind = PATH; kind <= RANDOM; kind++)
        for (keep = 0; keep < 2; keep++) {
            const int32_t n = up.n = kind == RANDOM ? N : 60;
            double off[INT_OFF];
            for (i = 0; i < n; i++) {
                const int32_t below = i + 1 < n ? i + 1 + (int32_t)(dense_random(&seed) % (uint64_t)(n - 1 - i)) : n;
                const uint32_t chance = i == 12 || i == 40 ? 90 : 3;
                ptr[i + 1] = ptr[i];
                for (j = i + 1; kind >= FULL && j < n; j++)
                    if (kind == FULL || dense_random(&seed) % 100 < chance || (i < 12 && (j == 12 || j == 40))) col[ptr[i + 1]++] = j;
                if (kind < FULL && i + 1 < n) col[ptr[i + 1]++] = kind == PATH ? i + 1 : kind == STAR ? n - 1 : below;
            }
            int_ildl_of(&up, kind == RANDOM ? keep : 0.97 * keep, off);
            for (k = 0; k < INT_OFF; k++) {
                const int exact = kind != RANDOM || k == INT_ENTRIES || k == INT_SOLVED || k == (keep ? INT_SUMS : INT_DIAGONAL);
                CHECK_MSG(exact == (off[k] < 1e-10), "pattern %d, keep %d: off by %g in part %d", kind, keep, off[k], k);
            }
        }
}

/* The share of the way from the first residual to the target, by powers of ten. */
static void int_krylov_done(void) {
    CHECK(fabs(hdi_iteration_done(1e3, 1e1, 1e-5) - 0.25) < 1e-15 && fabs(hdi_iteration_done(1e-2, 1e-8, 1e-10) - 0.75) < 1e-15);
    CHECK(hdi_iteration_done(5, 5, 1e-3) == 0 && hdi_iteration_done(5, 1, 0) == 0);
    CHECK(hdi_iteration_done(5, 1e-3, 1e-3) == 1 && hdi_iteration_done(1e-3, 1e-3, 1e-2) == 1);
}

/* ---- helpers ---- */

static void int_free_pair(void *p) {
    dense_pair_free((dense_pair *)p);
    free(p);
}

/* Eigenpairs of two dense matrices, which stay as they are. */
static const dense_pair *int_solved(const double *L, const double *B, int32_t n) {
    dense_pair *pair = KIT_NEW(dense_pair, 1);
    double *own[2] = {DENSE_NEW(double, n * n), DENSE_NEW(double, n * n)};
    memcpy(own[0], L, (size_t)(n * n) * sizeof *L);
    memcpy(own[1], B, (size_t)(n * n) * sizeof *B);
    CHECK(dense_pair_solve(pair, own[0], own[1], n));
    kit_list[kit_count - 1].destroy = int_free_pair;
    return pair;
}

static double int_off(const double *a, const double *b, int64_t n) {
    return dense_max_diff(a, b, n) / (1 + dense_max_abs(b, n));
}

static void int_noise(double *x, int64_t n, uint64_t *seed) {
    int64_t i;
    for (i = 0; i < n; i++) x[i] = dense_signed(seed);
}

/* ---- [07] kernels ---- */

/* C -= A B in eight rows, as right-hand sides stand, is what it is in those of sixteen; other rows stay as they are. */
static void int_product_rows(const hdi_kernels *o, int slices) {
    enum { DEPTH = 21, COLS = 13, ROWS = 16 };
    const int64_t w = o->width, size = w * ROWS * COLS;
    double *a = KIT_NEW(double, w * ROWS * DEPTH), *b = KIT_NEW(double, w * (COLS + 16) * DEPTH), *c = KIT_NEW(double, 3 * size);
    uint64_t seed = 5;
    int64_t i;
    int k, wrong = 0;
    hdi_product g;
    int_noise(a, w * ROWS * DEPTH, &seed);
    int_noise(b, w * (COLS + 16) * DEPTH, &seed);
    int_noise(c, size, &seed);
    memset(&g, 0, sizeof g);
    g.a = a;
    g.b = b;
    g.c_col = g.a_col = ROWS;
    g.b_row = slices ? o->nr : 1;
    g.b_col = slices ? 1 : DEPTH;
    g.b_next = (int64_t)o->nr * DEPTH;
    g.cols = COLS;
    g.depth = DEPTH;
    for (k = 1; k < 3; k++) {
        memcpy(c + k * size, c, (size_t)size * sizeof *c);
        g.c = c + k * size;
        g.n = 8 * k;
        o->multiply(&g);
    }
    for (i = 0; i < size; i++) {
        const double want = i / w % ROWS < 8 ? c[2 * size + i] : c[i];
        wrong += !(fabs(c[size + i] - want) <= 1e-13) || c[2 * size + i] == c[i];
    }
    CHECK_MSG(wrong == 0, "entries of %d, slices %d: %d are wrong", (int)w, slices, wrong);
}

static void int_products(void) {
    int level, k;
    for (level = 0; level <= hdi_simd_best(); level++)
        for (k = 0; k < 4; k++) int_product_rows(hdi_kernels_get(level, k / 2), k % 2);
}

/* ---- [22] poles: what checks and bounds rest on ---- */

static hd_laplacian *int_mesh(int voronoi) { return kit_pair(voronoi ? "flat/14/9/0.3 vor" : "flat/14/9/0.3 fem"); }

/* l L + b B, dense, or the absolute values. */
static double *int_dense(const hd_laplacian *lap, double l, double b, int absolute) {
    double *d = KIT_NEW(double, lap->n_active * lap->n_active);
    int64_t p;
    int32_t i;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double mass = lap->B ? lap->B[p] : lap->L.col[p] == i ? lap->mass[i] : 0, L = lap->L.val[p];
            d[i * lap->n_active + lap->L.col[p]] = absolute ? l * fabs(L) + b * fabs(mass) : l * L + b * mass;
        }
    return d;
}

/* Number q of block r: its residual, sizes and share of the answer by their definition. Real numbers are complex ones
 * whose imaginary parts count nothing. */
static void int_residual_right(const hdi_residual *g, const double *L, const double *B, int32_t r, int q, double *want_u) {
    const int32_t n = g->end, parts = g->real ? 1 : 2;
    double *part = KIT_NEW(double, 6 * n), *l = part + 2 * n, *b = l + 2 * n, want[3] = {0}, got[3] = {0};
    int32_t i, k;
    for (k = 0; k < parts; k++) {
        for (i = 0; i < n; i++) part[k * n + i] = g->x[g->stride * i + 8 * r + q + 4 * k];
        dense_apply(L, part + k * n, l + k * n, n);
        dense_apply(B, part + k * n, b + k * n, n);
        for (i = 0; i < n; i++) {
            want[1] += g->noise[i] * part[k * n + i] * part[k * n + i];
            want[2] += part[k * n + i] * b[k * n + i];
            want_u[i] += g->coef[q + 4 * k] * part[k * n + i];
        }
        for (i = 0; i < 3; i++) got[i] += g->sum[r][i][q + 4 * k];
    }
    for (i = 0; i < n; i++) {
        const double re = g->f[g->real ? q : r][i] - g->t * l[i] - g->re[q] * b[i] + g->im[q] * b[n + i];
        const double im = g->real ? 0 : -g->t * l[n + i] - g->re[q] * b[n + i] - g->im[q] * b[i];
        want[0] += g->weight[i] * (re * re + im * im);
        if (!g->r) continue;
        CHECK(fabs(g->r[8 * i + q] - re) < 1e-12 * (1 + fabs(re)) && fabs(g->bx[8 * i + q] - b[i]) < 1e-12);
    }
    for (i = 0; i < 3; i++)
        CHECK_MSG(fabs(want[i] / got[i] - 1) < 1e-12, "sum %d of number %d, block %d: %g, told %g", (int)i, q, (int)r,
                  want[i], got[i]);
}

/* k blocks together, by the kernels of one level. */
static void int_residual_of(const hd_laplacian *lap, int level, int real, int32_t k) {
    const int32_t n = lap->n_active, count = real ? 8 : k, each = real ? 1 : 4;
    double *x = KIT_NEW(double, HDI_PACK * 6 * n), *f = KIT_NEW(double, 8 * n), *weight = KIT_NEW(double, 2 * n),
        *u = KIT_NEW(double, 8 * n), *want = KIT_NEW(double, n), sum[6][3][HDI_PACK],
        *L = int_dense(lap, 1, 0, 0), *B = int_dense(lap, 0, 1, 0);
    hdi_residual g = hdi_residual_open(lap, 0.7, x, k, sum);
    uint64_t seed = 9;
    int32_t i;
    int q;
    int_noise(x, HDI_PACK * k * n, &seed);
    int_noise(f, 8 * n, &seed);
    int_noise(g.coef, HDI_PACK, &seed);
    for (i = 0; i < 2 * n; i++) weight[i] = 1 + 0.1 * (i % 7);
    for (q = 0; q < HDI_PACK; q++) {
        g.re[q] = 0.4 * (real ? q : q % 4) - 1.3;
        g.im[q] = real ? 0 : 0.3 + 0.2 * (q % 4);
    }
    g.real = real;
    g.weight = weight;
    g.noise = weight + n;
    for (i = 0; i < count; i++) {
        g.f[i] = f + i * n;
        g.u[i] = u + i * n;
    }
    if (real) {
        g.r = KIT_NEW(double, 8 * n);
        g.bx = KIT_NEW(double, 8 * n);
    }
    hdi_kernels_get(level, 0)->residual(&g);
    for (i = 0; i < count; i++) {
        memset(want, 0, (size_t)n * sizeof *want);
        for (q = 0; q < each; q++) int_residual_right(&g, L, B, real ? 0 : i, real ? i : q, want);
        CHECK_MSG(int_off(u + i * n, want, n) < 1e-13, "%d blocks together: %g off", (int)k, int_off(u + i * n, want, n));
    }
}

static void int_residuals(void) {
    int form, level;
    int32_t k;
    for (form = 0; form < 2; form++)
        for (level = 0; level <= hdi_simd_best(); level++) {
            for (k = 1; k <= 6; k++) int_residual_of(int_mesh(form), level, 0, k);
            int_residual_of(int_mesh(form), level, 1, 1);
        }
}

/* Weights of rounding: noise_j = sum_i M_ij c_i^2/D_i sum_k M_ik with M = t |L| + theta |B|, c_i half a unit for each term
 * and eight more. And no eigenvalue lies above its bound, which is not much larger than the largest. */
static void int_noise_weights(void) {
    int form;
    for (form = 0; form < 2; form++) {
        const hd_laplacian *lap = int_mesh(form);
        const int32_t n = lap->n_active;
        double *M = int_dense(lap, 0.3, 1.7, 1), *noise = KIT_NEW(double, 2 * n), *want = KIT_NEW(double, n), top,
            bound = hdi_lambda_bound(lap);
        const dense_pair *pair;
        int32_t i, j;
        hdi_noise_weights(lap, 0.3, 1.7, noise, noise + n);
        for (i = 0; i < n; i++) {
            const double c = ((double)(lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) + 8) * DBL_EPSILON / 2;
            double sum = 0;
            for (j = 0; j < n; j++) sum += M[i * n + j];
            for (j = 0; j < n; j++) want[j] += M[i * n + j] * c * c / lap->b_diag[i] * sum;
        }
        for (j = 0; j < n; j++) want[j] = noise[j] / want[j] - 1;
        CHECK_MSG(dense_max_abs(want, n) < 1e-12, "form %d: off by %g", form, dense_max_abs(want, n));
        pair = int_solved(int_dense(lap, 1, 0, 0), int_dense(lap, 0, 1, 0), n);
        top = dense_max_abs(pair->lambda, n);
        CHECK_MSG(bound >= top && bound <= 20 * top, "bound %g, eigenvalue %g", bound, top);
    }
}

/* The least of |x + theta|, and the most of 1 + x over it, for x >= 0, by search. */
static void int_pole_bounds(void) {
    uint64_t seed = 4;
    int k, i;
    for (k = 0; k < 200; k++) {
        const double size = pow(10, 2 * dense_signed(&seed));
        const hd_c64 theta = hdi_c(size * 3 * dense_signed(&seed), size * (0.01 + fabs(dense_signed(&seed))));
        double nearest = hdi_pole_distance(theta), gain = hdi_pole_gain(theta), least = HUGE_VAL, most = 0;
        for (i = 0; i <= 20000; i++) {           /* x from 0 over 1e-4 to 1e6, and closely around the pole */
            const double x = i == 0 ? 0 : i % 2 ? pow(10, -4 + i * 5e-4) : fmax(0, -theta.re + (i - 10000) * 1e-3 * size);
            least = fmin(least, hypot(x + theta.re, theta.im));
            most = fmax(most, (1 + x) / hypot(x + theta.re, theta.im));
        }
        CHECK_MSG(nearest <= least * (1 + 1e-12) && nearest > least * (1 - 1e-4) && gain >= most * (1 - 1e-12) &&
                  gain <= most * 1.001,
                  "theta %g %+g i: %g, %g, by search %g, %g", theta.re, theta.im, nearest, gain, least, most);
    }
}

/* factor sum Re w/(x + theta) >= 1/(1 + x), which bounds of diagonals rest on; an imaginary pole bounds nothing. */
static void int_resolvent_weights(void) {
    static const hd_pole_kind kinds[2] = {HD_POLES_UNIFORM, HD_POLES_KERNEL};
    hd_c64 weight[HD_MAX_POLES];
    hd_rational set;
    int32_t r, k, p;
    for (r = 2 * 2; r < 2 * 15; r++) {
        hd_error e = int_no_error();
        double factor;
        CHECK(hdi_rational_get(&set, kinds[r % 2], r / 2, &e) == HD_OK);
        factor = hdi_resolvent_weights(&set, weight);
        CHECK_MSG(factor < 10, "set %d: factor %g", (int)r, factor);
        for (k = -1; k < 600; k++) {
            const double x = k < 0 ? 0 : pow(10, -4 + 0.02 * k);
            double sum = 0;
            for (p = 0; p < set.n_poles; p++)
                sum += hdi_cdiv(weight[p], hdi_c(x + set.theta[p].re, set.theta[p].im)).re;
            CHECK_MSG(factor * sum * (1 + x) >= 1 - 1e-12, "set %d, x %g", (int)r, x);
        }
    }
    set.n_poles = 1;
    set.theta[0] = hdi_c(0, 1);
    CHECK(hdi_resolvent_weights(&set, weight) == HUGE_VAL);
}

/* What is known of an error by numbers that are none, or infinite: nothing. A bound is never a share of an infinite value,
 * which is an error. */
static void int_no_numbers(void) {
    const double none = (double)NAN, endless = (double)INFINITY;
    int k;
    CHECK(hdi_probe_seen(none, 0, 1, 1) >= HUGE_VAL && hdi_probe_seen(1, none, 1, 1) >= HUGE_VAL);
    TRAPS_OFF;                                   /* infinity less infinity */
    CHECK(hdi_probe_seen(endless, 0, endless, 1) >= HUGE_VAL);
    TRAPS_ON;
    CHECK(hdi_probe_seen(1, 0, 1, 1) == 0 && hdi_probe_seen(1, 1e-9, 1, 2) == 5e-10);
    for (k = 0; k < 2; k++) {
        hdi_ledger l = hdi_ledger_begin(HD_EVIDENCE_PROVEN, HD_EVIDENCE_PROVEN, HD_EVIDENCE_PROVEN, 1);
        hdi_parts off = {0, 0, 0};
        hd_report rep;
        memset(&rep, 0, sizeof rep);
        hdi_error_clear(&rep.error);
        off.solver = k ? 1 : HUGE_VAL;
        hdi_ledger_note(&l, k ? HUGE_VAL : 2, off);
        hdi_ledger_close(&l, &rep);
        CHECK(k ? rep.error.status == HD_ERR_BREAKDOWN : rep.error.status == HD_OK && rep.error_relative == HUGE_VAL);
    }
}

/* ---- [23] Lanczos ---- */

/* exp(-t A) rhs. */
static void int_lanczos_truth(const dense_pair *p, double t, const double *rhs, double *u) {
    double *g = KIT_NEW(double, p->n);
    int32_t i;
    for (i = 0; i < p->n; i++) g[i] = exp(-t * p->lambda[i]);
    dense_pair_filter(p, g, rhs, u);
}

/* Lanczos from e_1 on a tridiagonal T gives T back: m steps leave exp(-t T_m) e_1, and the bound must hold against exp(-t
 * T) e_1. */
static void int_lanczos_bound(void) {
    enum { N = 60 };
    static const double times[4] = {0.1, 1, 10, 100};
    double *T = KIT_NEW(double, N * N), *one = KIT_NEW(double, N * N), *room = KIT_NEW(double, 9 * N + 2),
        *got = room + 7 * N + 2, *want = got + N;
    double start[N] = {1}, loosest = 0;
    hd_c64 work[2 * N];
    hd_rational set;
    const dense_pair *whole, *part;
    hdi_lanczos z;
    hd_error e = int_no_error();
    uint64_t seed = 12;
    int32_t i, j, m, k;
    memset(&z, 0, sizeof z);
    z.d = room;
    z.e = z.d + N;
    z.ends = z.e + N;
    z.y = z.ends + 2 * N;
    z.alpha = z.y + N;
    z.beta = z.alpha + N;
    z.work = work;
    for (i = 0; i < N; i++) {                    /* positive: diagonally dominant */
        T[i * N + i] = z.alpha[i] = 2.2 + dense_signed(&seed);
        z.beta[i + 1] = 0.5 + 0.1 * dense_signed(&seed);
        if (i + 1 < N) T[i * N + i + 1] = T[(i + 1) * N + i] = z.beta[i + 1];
        one[i * N + i] = 1;
    }
    CHECK(hdi_rational_get(&set, HD_POLES_UNIFORM, 14, &e) == HD_OK);
    whole = int_solved(T, one, N);
    for (m = 1; m < N; m += 3) {
        double *Tm = KIT_NEW(double, m * m), *Im = KIT_NEW(double, m * m);
        for (i = 0; i < m; i++) {
            for (j = 0; j < m; j++) Tm[i * m + j] = T[i * N + j];
            Im[i * m + i] = 1;
        }
        part = int_solved(Tm, Im, m);
        z.m = m;
        for (k = 0; k < 4; k++) {
            const double t = times[k];
            double bound = -1, error = 0;
            CHECK(hdi_lanczos_bound(&z, t, &bound, &e) == HD_OK);
            int_lanczos_truth(whole, t, start, want);
            memset(got, 0, N * sizeof *got);
            int_lanczos_truth(part, t, start, got);
            for (i = 0; i < N; i++) error = hypot(error, want[i] - got[i]);
            CHECK_MSG(error <= bound * (1 + 1e-9) + 1e-14, "m %d, t %g: error %g, bound %g", (int)m, t, error, bound);
            if (error > 1e-10 && t <= 1) loosest = fmax(loosest, bound / error);
            hdi_lanczos_coefficients(&z, t, &set);
            CHECK_MSG(dense_max_diff(z.y, got, m) < 2e-13, "m %d, t %g: coefficients off by %g", (int)m, t, dense_max_diff(z.y, got, m));
        }
    }
    CHECK_MSG(loosest < 20, "bounds up to %g times the error", loosest);
}

/* (F(a) - F(b))/(a - b) of F(x) = exp(-tau (1/x - 1)) against long double, for a and b that are far from and very near each
 * other. */
static void int_krylov_slopes(void) {
    static const double taus[7] = {0.01, 0.1, 1, 10, 30, 1000, 1e5};
    uint64_t seed = 19;
    int k;
    for (k = 0; k < 20000; k++) {
        const double a = pow(10, -6 * fabs(dense_signed(&seed))), near = pow(10, -17 * fabs(dense_signed(&seed))),
            tau = taus[k % 7];
        const double other = k % 3 == 0 ? pow(10, -6 * fabs(dense_signed(&seed))) : fmin(1, a * (1 + (k % 2 ? near : -near)));
        const double b = k % 97 == 0 ? a : other;
        const double fa = hdi_krylov_value(a, tau, 0), fb = hdi_krylov_value(b, tau, 0);
        const double got = hdi_krylov_difference(a, fa, b, fb, tau, 0);
        const double lost = fabs(a - b) > 0.05 * a ? 1e-14 * (fa + fb) / fabs(a - b) : 0;
        const long double high = a > b ? a : b, low = a > b ? b : a, d = high - low;
        long double want = expl(-tau * (1 / high - 1));
        if (d > 0) want *= -expm1l(-tau * d / (high * low)) / d;
        else want *= (long double)tau / (high * high);
        const double ga = hdi_krylov_value(a, tau, 1), gb = hdi_krylov_value(b, tau, 1);
        const double rate = hdi_krylov_difference(a, ga, b, gb, tau, 1), x = tau * (1 / a - 1);
        const double rate_lost = 1e-14 * (fabs(ga) + fabs(gb)) / fmax(fabs(a - b), 0.05 * a) + 1e-7 * (1 + x) * (double)want;
        const double rate_want = (double)(tau / (a * b) * expl(-tau * (1 / (long double)b - 1)) - x * want);
        CHECK_MSG(fabs(rate - rate_want) <= rate_lost + 1e-290 || tau / (a * b) * fb > 1e200, "a %.17g, b %.17g, tau %g: %g, not %g", a, b, tau, rate, rate_want);
        CHECK_MSG(fabs(got - (double)want) <= lost + 1e-290 + 1e-8 * (double)want, "a %.17g, b %.17g, tau %g: %g, not %g", a,
                  b, tau, got, (double)want);
    }
    CHECK(hdi_krylov_value(1, 30, 0) == 1 && hdi_krylov_value(1.0000001, 30, 0) == 1 && hdi_krylov_value(0, 3, 0) == 0 &&
          hdi_krylov_value(-1e-17, 3, 0) == 0);
    CHECK(hdi_krylov_value(1e-20, 0, 0) == 1 && fabs(hdi_krylov_value(0.5, 2, 0) - exp(-2)) < 1e-16 &&
          hdi_krylov_difference(1e-18, 0, 1e-18, 0, 3, 0) == 0);
}

/* Eigenvalues 1/(1 + g lambda) above one show that L is not semidefinite, but not where the solves themselves are off by as
 * much. */
static void int_ritz_above(void) {
    hdi_krylov *z = KIT_NEW(hdi_krylov, 1);
    double room[3];
    hd_error e = int_no_error();
    hdi_ritz s;
    z->alpha[0][0] = 1.05;
    z->steps = 1;
    z->f_norm[0] = 1;
    z->seen = 9;
    z->noise[0][0] = 1e-3;
    CHECK(hdi_krylov_ritz(z, 0, 2, room, &s, &e) == HD_OK && s.mu[0] == 1.05);
    z->noise[0][0] = 1e-5;
    CHECK(hdi_krylov_ritz(z, 0, 2, room, &s, &e) < 0);
}

static hd_status int_elim(hdi_elim *m, const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    memset(m, 0, sizeof *m);
    memset(ctx, 0, sizeof *ctx);
    *e = int_no_error();
    return hdi_elim_make(m, lap, HD_ORDERING_AUTO, NULL, hdi_pair_scale(lap), ctx, e);
}

static void int_lane(hdi_lane *lane, const hd_laplacian *lap, int32_t r, hd_context *ctx, hd_error *e) {
    uint64_t seed = 21;
    int32_t i;
    memset(lane, 0, sizeof *lane);
    CHECK(hdi_lane_make(lane, lap, hdi_lane_size(lap, NULL, 0, 0), ctx, e) == HD_OK);
    for (i = 0; i < lap->n_active; i++) lane->f[i] = r == 0 ? i == 11 : r == 1 ? 1 + sin(0.2 * i) : dense_signed(&seed);
    hdi_pair_apply(lap, 0, 1, lane->f, lane->rhs);
    hdi_heat_measure(lap, lane);
}

/* The error of right-hand side r at time t after z's steps, relative to |f|; the answer is taken as a plan takes it. */
static double int_krylov_error(hdi_krylov *z, hdi_lane *lane, int32_t r, double t, const dense_pair *pair, double *want) {
    hd_error e = int_no_error();
    int32_t i;
    z->n_sums = r + 1;                           /* of several abreast, only this one is wanted */
    for (i = 0; i < r; i++) z->u[i] = NULL;
    z->u[r] = lane[r].u;
    z->means[r] = lane[r].sums;
    CHECK(hdi_krylov_end(z, r, &e) == HD_OK);
    hdi_krylov_coefficients(z, r, t, z->rate, z->y[r]);
    hdi_krylov_sum_task(z, 0, z->m->lap->n_active);
    hdi_krylov_judge(z, r, t, z->y[r], 0, lane + r, &e);
    CHECK(e.status == HD_OK);
    dense_pair_heat(pair, t, lane[r].rhs, want);
    for (i = 0; i < pair->n; i++) want[i] -= lane[r].u[i];
    return dense_pair_norm(pair, want) / z->f_norm[r];
}

/* After each number of steps the bound against the error of the answer, for times from a third to three times the one that
 * the shift is made for, and far from it. wide: right-hand sides side by side. */
static void int_krylov_bound_of(int kind, int32_t wide, double t) {
    static const double factors[5] = {0.03, 0.3, 1, 3, 30};
    const hd_laplacian *lap = kit_pair(kind ? "flat/14/9/0.3 vor" : "bumpy/2/5 fem");
    const int32_t n = lap->n_active, k = wide == 1 ? 1 : 3;
    double *want = KIT_NEW(double, n), room[3 * HDI_KRYLOV_MAX], most[2], loosest = 0;
    hdi_krylov *z = KIT_NEW(hdi_krylov, 1);
    hdi_ritz ritz;
    hd_context ctx;
    hd_error e;
    hdi_elim m;
    hdi_lane lane[3];
    const dense_pair *pair;
    int32_t r, step, looked = 0;
    int q;
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
    t *= lap->h * lap->h * m.scale;
    pair = int_solved(int_dense(m.lap, 1, 0, 0), int_dense(m.lap, 0, 1, 0), n);
    for (r = 0; r < k; r++) int_lane(lane + r, m.lap, r, &ctx, &e);
    CHECK(hdi_elim_shift(&m, hdi_krylov_shift(0, t, t, 0), &e) == HD_OK && m.shift / t > 0.05 && m.shift / t <= 0.2);
    z->wide = wide;
    z->m = &m;
    z->k = k;
    z->g = m.shift;
    CHECK(hdi_krylov_start(z, lane, &ctx, &e) == HD_OK);
    for (r = 0; r < k; r++)                      /* the start takes the constants out */
        for (q = 0; q < n; q++) lane[r].rhs[q] += m.lap->mass[q] * lane[r].sums[m.lap->component[q]];
    for (step = 1; step <= 45; step++) {
        CHECK(hdi_krylov_step(z, &ctx, &e) == HD_OK && z->steps == step);
        for (q = 0; q < 5 * k && (step <= 12 || step % 4 == 0); q++) {
            const double at = t * factors[q % 5], eps = 1e-15 * fmin(at * dense_max_abs(pair->lambda, n), 1e3) + 3e-14;
            double bound, error;
            r = q / 5;
            if (step > 1 && !(z->beta[step - 1][r] > 1e-13)) continue;
            CHECK(hdi_krylov_ritz(z, r, 2, room, &ritz, &e) == HD_OK);
            hdi_ritz_gain(&ritz, at / z->g, most);
            bound = ritz.beta * most[1];
            error = int_krylov_error(z, lane, r, at, pair, want);
            looked++;
            CHECK_MSG(error <= bound + eps, "mesh %d, wide %d, right-hand side %d, step %d, t %g: error %g, bound %g", kind,
                      (int)wide, (int)r,
                      (int)step, at, error, bound);
            CHECK(lane[r].off.solver == bound * z->f_norm[r] && lane[r].off.rounding > 0);
            if (error <= 1e-12 + 10 * eps) continue;
            if (hdi_ritz_size(&ritz, at / z->g) < 1e-3) continue;    /* the bound allows for slow modes, which are not there */
            loosest = fmax(loosest, bound / error);
        }
    }
    CHECK_MSG(looked > 40 && loosest > 1 && loosest <= 100,
              "mesh %d, wide %d: looked %d times, bounds up to %g times the error", kind, (int)wide,
              (int)looked, loosest);
    hdi_krylov_free(z, &ctx);
    for (r = 0; r < k; r++) hdi_lane_free(lane + r, &ctx);
    hdi_elim_free(&m);
    CHECK(ctx.bytes_in_use == 0);
}

static void int_krylov_bounds(void) {
    int q;
    for (q = 0; q < 12; q++) int_krylov_bound_of(q / 2 % 2, q % 2 ? 8 : 1, pow(20, q / 4 - 0.5));
}

/* ---- [24] to [28]: damaged factors ---- */

typedef enum int_query {
    INT_APPLY, INT_COLUMN, INT_OF_DIAGONAL, INT_OF_ENTRIES, INT_TRACE, INT_CLASSICAL, INT_WEIGHTED, INT_COMMUTE, INT_BIHARMONIC
} int_query;
typedef struct int_damaged { int_query query; int32_t n_times; } int_damaged;
static const int_damaged int_damages[] = {
    {INT_APPLY, 1}, {INT_APPLY, 12}, {INT_COLUMN, 1}, {INT_COLUMN, 12}, {INT_OF_DIAGONAL, 1}, {INT_OF_DIAGONAL, 12},
    {INT_OF_ENTRIES, 1}, {INT_TRACE, 1}, {INT_TRACE, 12}, {INT_CLASSICAL, 1}, {INT_CLASSICAL, 12}, {INT_WEIGHTED, 1},
    {INT_WEIGHTED, 12}, {INT_COMMUTE, 1}, {INT_BIHARMONIC, 1},
};

/* What is asked of a plan: so many numbers for each time go to out. */
static int32_t int_ask(hd_heat *heat, const int_damaged *x, const double *t, double *out, hd_report *rep) {
    static const int32_t i[3] = {5, 80, 40}, j[3] = {5, 81, 9};
    const int32_t n = heat->source->n;
    double *f = out + x->n_times * n;
    hd_status st;
    int32_t k;
    for (k = 0; k < n; k++) f[k] = sin(k);
    switch (x->query) {
        case INT_APPLY: st = hd_heat_apply(heat, x->n_times, t, 1, f, 0, out, 0, rep, NULL); break;
        case INT_COLUMN: st = hd_heat_columns(heat, HD_KERNEL_OPERATOR, x->n_times, t, VERTICES(1, i), out, 0, rep, NULL); break;
        case INT_OF_DIAGONAL: st = hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, x->n_times, t, out, 0, NULL, NULL, rep, NULL); break;
        case INT_OF_ENTRIES: st = hd_heat_entries(heat, HD_KERNEL_SYMMETRIC, x->n_times, t, 3, i, j, out, rep, NULL); break;
        case INT_TRACE: st = hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, x->n_times, t, NULL, 0, out, NULL, rep, NULL); break;
        default: st = heat_distance(heat, (hd_distance_kind)(x->query - INT_CLASSICAL), x->n_times, t, 1, i + 1, out, 0, rep);
    }
    CHECK_MSG(st >= 0, "query %d: %s", (int)x->query, rep->error.text);
    return x->query == INT_TRACE ? 1 : x->query == INT_OF_ENTRIES ? 3 : n;
}

/* The hook: pivots of every factor that a plan holds become a little wrong, by the same share or each by another. */
static void int_damage(hd_heat *heat, double by, int random) {
    hdi_factor *list[2 + HD_MAX_POLES] = {&heat->elim.real, &heat->ground.factor};
    uint64_t seed = 77;
    int64_t q;
    int32_t i, n = 2;
    list[n++] = &heat->elim.shifted;
    for (i = 0; i < heat->elim.n_used; i++) list[n++] = heat->elim.pack + i;
    while (n-- > 0)
        for (q = 0; list[n]->dinv && q < (int64_t)list[n]->width * list[n]->sym->n; q++)
            list[n]->dinv[q] *= 1 + (random ? dense_signed(&seed) : 1) * by;
}

/* Asked again, a plan takes the factors that it has, and its report covers what the damage did: at every time. */
static void int_damages_seen(size_t k) {
    int way;
    for (; k < sizeof int_damages / sizeof *int_damages; k += 5)
        for (way = 0; way < 4; way++) {
            const int_damaged *x = int_damages + k;
            const hd_laplacian *lap = int_mesh(way / 2);
            const int64_t room = (x->n_times + 1) * (int64_t)lap->n;
            double t[12], *before = KIT_NEW(double, 2 * room), *after = before + room, most = 0;
            hd_heat *heat = kit_heat(lap, x->query <= INT_COLUMN && x->n_times > 1 ? "method=krylov" : "method=direct");
            hd_report rep[2];
            int32_t n, q;
            for (q = 0; q < 12; q++) t[q] = lap->h * lap->h * pow(1.4, q);
            heat->modes.barred = 1;              /* poles, not eigenpairs */
            n = int_ask(heat, x, t, before, rep);
            int_damage(heat, 1e-5, way % 2);
            (void)int_ask(heat, x, t, after, rep + 1);
            for (q = 0; q < x->n_times; q++)
                most = fmax(most, dense_max_diff(before + q * n, after + q * n, n) / dense_max_abs(before + q * n, n));
            CHECK_MSG(rep[0].error_bound < 1e-5 && most > 1e-11 && most <= rep[1].error_bound &&
                      rep[1].error_rounding > 3 * rep[0].error_rounding,
                      "query %d, %d times, way %d: off by %g, bounds %g and %g", (int)x->query, (int)x->n_times, way, most,
                          rep[0].error_bound,
                      rep[1].error_bound);
        }
}

/* Apart: tools/mutate.py leaves out what takes long. */
static void int_damages_1(void) { int_damages_seen(0); }
static void int_damages_2(void) { int_damages_seen(1); }
static void int_damages_3(void) { int_damages_seen(2); }
static void int_damages_4(void) { int_damages_seen(3); }
static void int_damages_5(void) { int_damages_seen(4); }

/* Rows at which rounding is measured: largest diagonal entries of B^-1 L, and of L times a diagonal, and one that is named. */
static void int_probe_rows(void) {
    const hd_laplacian *lap = int_mesh(0);
    const int32_t n = lap->n_active;
    double *k = KIT_NEW(double, n);
    uint64_t seed = 8;
    int32_t i, round, p;
    hd_error e = int_no_error();
    hdi_heat_call h;
    memset(&h, 0, sizeof h);
    h.heat = kit_heat(lap, "method=direct");
    CHECK(hdi_heat_analysed(h.heat, &e) >= 0);
    lap = h.heat->elim.lap;
    for (round = 0; round < 20; round++) {
        int32_t first = 0, second = 0, found = 0;
        hdi_probe probe;
        for (i = 0; i < n; i++) {
            k[i] = 1.5 + dense_signed(&seed);
            if (hdi_row_diagonal(lap, i) / lap->b_diag[i] > hdi_row_diagonal(lap, first) / lap->b_diag[first]) first = i;
            if (hdi_row_diagonal(lap, i) * k[i] > hdi_row_diagonal(lap, second) * k[second]) second = i;
        }
        probe = hdi_probe_rows(&h, k, round);
        for (p = 0; p < probe.k; p++) found |= (probe.row[p] == first) + 2 * (probe.row[p] == second) + 4 * (probe.row[p] == round);
        CHECK_MSG(found == 7 && probe.k <= 3, "rows %d, %d: %d", (int)first, (int)second, (int)found);
    }
}

/* Pairs whose bound by the usual degree is too large take the highest one, as distances do, where eigenpairs are barred. */
static void int_pairs_degree(void) {
    const hd_laplacian *lap = kit_pair("ico/3 fem");
    const int32_t i[3] = {5, 80, 300}, j[3] = {300, 81, 600};
    hd_heat *heat = kit_heat(lap, "method=direct");
    hd_report rep;
    double d[3];
    heat->modes.barred = 1;
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, 150 * lap->h * lap->h, 3, i, j, d, &rep) == HD_OK);
    CHECK_MSG(rep.error_bound <= 1e-6 && rep.degree == 14, "degree %d, bound %g: %s", (int)rep.degree, rep.error_bound, rep.reason);
}

/* ---- [12] operators ---- */

/* Rows of a mesh with vertices held are those of the mesh without them, symmetric to the last bit, again after an
 * update, and every link is listed once. */
static void int_links(void) {
    enum { N = 6, FACES = 2 * (N - 1) * (N - 1) };
    double xyz[3 * N * N], *L;
    const int32_t held[4] = {0, 9, 14, N * N - 1};
    int32_t tri[3 * FACES], k, i, m = 0;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL, *all = NULL;
    hd_mesh mesh;
    hd_error e;
    int64_t p;
    memset(&o, 0, sizeof o);
    o.updatable = 1;
    for (k = 0; k < N * N; k++) {
        const int32_t r = k / N, c = k % N, corner[6] = {k, k + N, k + N + 1, k, k + N + 1, k + 1};
        const double at[3] = {r + 0.1 * c, (double)c, 0.3 * sin(r + 2.0 * c)};
        memcpy(xyz + 3 * k, at, sizeof at);
        if (r + 1 == N || c + 1 == N) continue;
        memcpy(tri + 3 * m, corner, sizeof corner);
        m += 2;
    }
    mesh = hd_triangles(xyz, N * N, tri, m);
    CHECK(hd_laplacian_create(&all, &mesh, &o, &e) >= 0);
    o.held = held;
    o.n_held = 4;
    CHECK(hd_laplacian_create(&lap, &mesh, &o, &e) >= 0);
    CHECK(lap->moving->first[N * N] == 3 * m && lap->n_active == N * N - 4);
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int64_t q = hdi_csr_find(&lap->L, lap->L.col[p], i);
            const int64_t a = hdi_csr_find(&all->L, lap->vertex[i], lap->vertex[lap->L.col[p]]);
            CHECK(q >= 0 && a >= 0 && lap->L.val[p] == lap->L.val[q] && lap->B[p] == lap->B[q]);
            CHECK(fabs(lap->L.val[p] - all->L.val[a]) <= (lap->L.col[p] == i ? 1e-14 * lap->L.val[p] : 0));
        }
    L = KIT_NEW(double, lap->L.nnz);
    memcpy(L, lap->L.val, (size_t)lap->L.nnz * sizeof *L);
    CHECK(hd_laplacian_update(lap, &mesh, &e) >= 0 && memcmp(L, lap->L.val, (size_t)lap->L.nnz * sizeof *L) == 0);
    hd_laplacian_free(lap);
    hd_laplacian_free(all);
}

/* ---- [25] spectrum ---- */

/* The proof sees a pair that is taken away, and a shift too near. Above the last shift no count tells that one is
 * missing, and what is handed out as the next eigenvalue is below it all the same. */
static void int_spectrum_proof(void) {
    const hd_laplacian *lap = kit_pair("ico/3 fem");
    hd_context ctx;
    hd_error e;
    hdi_elim m;
    hdi_spec z;
    hd_spectrum out;
    double next;
    int32_t i;
    memset(&out, 0, sizeof out);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
    CHECK(hdi_spec_make(&z, &m, 40, HUGE_VAL, 1e-10, &out, &e) >= 0 && hdi_spec_solve(&z, &e) >= 0);
    CHECK(out.proven && out.count == 40 && z.negative == hdi_spec_rank(&z, z.sigma) && hdi_spec_sure(&z));
    next = z.pair[36].value;
    for (i = 20; i + 1 < z.found; i++) z.pair[i] = z.pair[i + 1];
    z.found--;
    CHECK(z.negative == hdi_spec_rank(&z, z.sigma) + 1);
    z.pair[35].value *= 1.1;                     /* the first of a level; the others of it are missing */
    z.found = 36;
    z.sigma = (z.pair[34].value + next) / 2;
    CHECK(next > 1.1 * z.pair[34].value && hdi_spec_rest(&z, 35) <= next && hdi_spec_rest(&z, 35) > z.pair[34].value);
    z.pair[7].value = z.sigma * (1 + 1e-15);
    CHECK(!hdi_spec_sure(&z));
    hdi_spec_free(&z);
    hdi_elim_free(&m);
}

/* ---- [21] rational: pieces of shared sets, of which test_shared.h sees the whole ---- */

/* Residuals are orthogonal to the columns, also of nearly dependent ones; without full rank the answer is finite. */
static void int_least_squares(void) {
    enum { ROWS = 23, COLS = 6 };
    double a[ROWS * COLS], keep[ROWS * COLS], b[ROWS], rest[ROWS];
    uint64_t seed = 9;
    int32_t i, j, k;
    for (k = 0; k < 4; k++) {
        int_noise(a, ROWS * COLS, &seed);
        int_noise(b, ROWS, &seed);
        memcpy(rest, b, sizeof b);
        for (i = 0; i < ROWS; i++) {
            if (k == 1) a[4 * ROWS + i] = a[1 * ROWS + i] + 1e-6 * a[4 * ROWS + i];
            if (k == 2) a[2 * ROWS + i] = 0;
            if (k == 3) a[i] = i == 0;
        }
        memcpy(keep, a, sizeof a);
        hdi_least_squares(a, ROWS, COLS, b);
        CHECK(hdi_finite(dense_dot(b, b, COLS)));
        for (i = 0; i < ROWS * COLS; i++) rest[i % ROWS] -= keep[i] * b[i / ROWS];
        for (j = 0; k != 2 && j < COLS; j++)
            CHECK_MSG(fabs(dense_dot(rest, keep + j * ROWS, ROWS)) < (k == 1 ? 1e-8 : 1e-13), "case %d, column %d", (int)k,
                      (int)j);
    }
}

/* The rest of (1 + s) exp(-s) beyond Chebyshev degree m, from its coefficients by a discrete cosine transform. */
static void int_exp_rest(void) {
    enum { NODES = 300 };
    const double pi = acos(-1.0);
    int32_t k, i, j;
    for (k = 0; k < 40; k++) {
        const int32_t m = 8 + 4 * (k % 10);
        const double w = pow(10, 0.1 * (k * 7 % 30) - 2), c = (k % 3 == 0 ? 1 : 3) * w, tau = (k % 2 ? 1 : 0.2 * (k + 1)) / w;
        const double rest = hdi_shared_exp_rest(tau, c, w, m);
        double sum = 0;
        for (j = m + 1; j < NODES / 2; j++) {
            double b = 0;
            for (i = 0; i < NODES; i++) {
                const double angle = pi * (i + 0.5) / NODES, s = tau * (c + w * cos(angle));
                b += 2.0 / NODES * (1 + s) * exp(-s) * cos(j * angle);
            }
            sum += fabs(b);
        }
        CHECK_MSG(sum <= rest + 1e-12 && rest <= 300 * sum + 1e-11, "tau %g, %g +- %g, degree %d: rest %g, bound %g", tau, c,
                  w, (int)m, sum, rest);
    }
}

/* Patches whose margins are too narrow leave out what can be seen, and no more than they say. */
static void int_patches(void) {
    static const double reaches[4] = {0.15, 0.3, 0.5, 0.7};
    static const char *const specs[3] = {"flat/40/40/0.3 fem", "bumpy/4/1 vor", "flat/40/40/0.3 fem+id"};
    int32_t k, r, p, q, v, cut[5] = {0};
    for (k = 0; k < 3; k++) {
        const hd_laplacian *lap = kit_pair(specs[k]);
        const double t[2] = {5 * trial_unit(lap), 2 * trial_unit(lap)};
        double *W = KIT_NEW(double, 2 * lap->n), *D = KIT_NEW(double, 2 * lap->n), Z[2], tightest = HUGE_VAL;
        hd_report rep, all;
        CHECK(hd_heat_diagonal(kit_heat(lap, "method=direct poles=kernel degree=14"), HD_KERNEL_SYMMETRIC, 2, t, W, 0, Z, NULL, &all, NULL) >= 0);
        for (r = 0; r < 4; r++) {
            hd_heat *heat = kit_heat(lap, "method=local tol=1e-10");
            double sum[2] = {0, 0}, traces[2], sure[2], early = 0, off;
            hdi_diagonals to;
            hdi_heat_call h, in;
            hdi_patches x;
            CHECK(hdi_kernel_begin(&h, heat, HD_KERNEL_SYMMETRIC, NULL, NULL) >= 0 && hdi_times_check(&h, 2, t, 1) >= 0);
            memset(&to, 0, sizeof to);
            to.task.h = &h;
            to.D = D;
            to.ldd = (size_t)lap->n;
            to.Z = traces;
            to.bound = sure;
            CHECK(hdi_patches_open(&x, &to, 1) >= 0);
            cut[4] = x.n;
            cut[2] = hdi_patch_halve(&x, 0, x.n, 4);
            cut[1] = hdi_patch_halve(&x, 0, cut[2], 2);
            cut[3] = hdi_patch_halve(&x, cut[2], x.n, 2);
            x.reach = reaches[r];
            for (p = 0; p < 4; p++) {
                int32_t core = cut[p + 1] - cut[p], i;
                x.done = p;
                CHECK(core >= lap->n / 4 && hdi_patch_find(&x, cut[p], cut[p + 1], INT32_MAX) >= 0);
                CHECK(hdi_patch_once(&x, core, HUGE_VAL, &rep) >= 0);
                CHECK(x.local->n < lap->n && rep.error_local > 0);
                CHECK_MSG(rep.error_bound > 0.01 || rep.error_relative < 8 * rep.error_bound, "%s: the margin counts: %g", specs[k], rep.error_relative / rep.error_bound);
                CHECK(p == 0 || !hdi_finite(sure[0]) || sure[0] > early);
                early = sure[0];
                for (q = 0; q < 2; q++) {
                    for (i = 0; i < core; i++) {
                        const double off = fabs(D[q * lap->n + lap->vertex[x.local->row[i]]] - W[q * lap->n + lap->vertex[x.local->row[i]]]);
                        const double size = fabs(W[q * lap->n + lap->vertex[x.local->row[i]]]), less = off - 1e-6 * size;
                        CHECK_MSG(off <= (1 + 1e-9) * (rep.error_relative + all.error_relative) * size, "%s, patch %d at %g: %g of %g", specs[k], p,
                                  reaches[r], off / size, rep.error_relative);
                        if (less > 0) tightest = hdi_min(tightest, rep.error_local * size / less);
                    }
                }
            }
            for (v = 0; v < lap->n; v++)
                for (q = 0; q < 2; q++) sum[q] += lap->mass[v] * D[q * lap->n + lap->vertex[v]];
            if (!lap->B)
                for (q = 0; q < 2; q++) CHECK_MSG(fabs(traces[q] - sum[q]) < 1e-9 * sum[q], "%s: %g", specs[k], traces[q] - sum[q]);
            for (q = 0; q < 2; q++) CHECK(fabs(traces[q] - Z[q]) <= sure[q] + 1e-5 * Z[q]);
            CHECK(hdi_patch_find(&x, 0, cut[1], INT32_MAX) >= 0);
            CHECK(hdi_patch_run(&x, 0, cut[1]) >= 0 && x.reach > reaches[r] && h.rep->error_local <= 100 * 1e-10);
            x.t = 1000 * t[0];                   /* all heat has left long before */
            x.reach = 1e-3;
            CHECK(hdi_patch_find(&x, cut[1], cut[2], INT32_MAX) >= 0 && hdi_local_plan(heat, x.local, h.e) >= 0);
            CHECK(hdi_kernel_begin(&in, &x.local->heat, HD_KERNEL_SYMMETRIC, NULL, NULL) >= 0);
            in.method = HD_METHOD_DIRECT;
            CHECK(hdi_times_check(&in, 2, t, 1) >= 0 && hdi_patch_off(&x, &in, cut[2] - cut[1], sure) >= 0);
            off = sure[0] * x.local->heat.scale;
            CHECK_MSG(off > 1 / lap->component_mass[0], "%s: %g of %g", specs[k], off * lap->component_mass[0], reaches[r]);
            CHECK(hdi_heat_end(&in) >= 0);
            hdi_local_free(heat);
            (void)hdi_heat_end(&h);
        }
        CHECK_MSG(tightest < 2e4, "%s: bounds are %g times as large as errors", specs[k], tightest);
    }
}

/* The bound on the error of any weights and times, and of poles that nearly touch the half line. */
static void int_shared_bounds(void) {
    uint64_t seed = 77;
    int32_t k, i, j;
    for (k = 0; k < 200; k++) {
        const double tau = pow(10, 3 * dense_signed(&seed) + 1);
        hd_rational set;
        double size, worst = 0, plain = 0, y;
        CHECK(hdi_shared_pick(&set, pow(10, 1 + dense_signed(&seed)) * 1.01, 1e-5));
        for (i = 0; i < set.n_poles; i++) set.a[i] = hdi_c(dense_signed(&seed), dense_signed(&seed));
        i = k % set.n_poles;
        size = hdi_cabs(set.theta[i]);
        if (k % 2) set.theta[i] = hdi_c(-size * cos(0.04 + 0.001 * k), size * sin(0.04 + 0.001 * k));
        hdi_shared_bound(&set, tau, 1e-8);
        for (j = 0; j < 1000; j++) {             /* from far below to far above the poles */
            long double sum;
            y = size * pow(10, -5 + 0.01 * j);
            sum = expl(-(long double)tau * y);
            for (i = 0; i < set.n_poles; i++) {
                const long double re = (long double)y + set.theta[i].re, im = set.theta[i].im;
                sum += 2 * (set.a[i].re * re + set.a[i].im * im) / (re * re + im * im);
            }
            worst = fmax(worst, (1 + tau * y) * fabs((double)sum));
            plain = fmax(plain, fabs((double)sum));
        }
        CHECK_MSG(plain <= set.max_error && worst <= set.max_weighted_error && (k % 2 || set.max_weighted_error <= 1.2 * worst),
                  "tau %g: bound %g, error %g", tau,
                  set.max_weighted_error, worst);
    }
}

/* ---- [09] spatial, [10] geometry, [11] intrinsic, [12] operators: numerics and selection ---- */

/* The area of a needle with sides 1, 1 and x, and of triangles of integer sides. */
static void int_length_area(void) {
    int k;
    for (k = 0; k < 300; k += 7) {
        const double x = pow(10, -k / 10.0), want = x / 4 * sqrt(4 - x * x);
        CHECK_MSG(fabs(hdi_length_area(1, 1, x) / want - 1) < 1e-15 && fabs(hdi_length_area(x, 1, 1) / want - 1) < 1e-15,
                  "%g", x);
    }
    CHECK(hdi_length_area(3, 4, 5) == 6 && hdi_length_area(13, 5, 12) == 30 && hdi_length_area(15, 13, 14) == 84);
    CHECK(hdi_length_area(1, 2, 3) == 0 && hdi_length_area(1, 2, 4) == 0 && hdi_length_area(0, 1, 1) == 0 &&
          hdi_length_area(9, 1, 1) == 0);
}

/* Faces around an edge come by their angle, from the first one's, against the turn of the hand if the smaller vertex is below. */
static void int_around(void) {
    static const double angles[6] = {0.4, 3.0, 1.1, 5.9, 0.39, 4.0};
    static const int32_t want[6] = {0, 2, 1, 5, 3, 4};
    double xyz[3 * 8] = {7, -2, 0, 7, -2, 5};    /* the axis goes up from 0 to 1 */
    int32_t tri[18], k;
    hdi_pair list[6];
    hdi_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    for (k = 0; k < 6; k++) {
        xyz[3 * k + 6] = 7 + (k + 1) * cos(angles[k]);
        xyz[3 * k + 7] = -2 + (k + 1) * sin(angles[k]);
        xyz[3 * k + 8] = k - 3;
        tri[3 * k] = k + 2;
        tri[3 * k + 1] = k % 2;
        tri[3 * k + 2] = 1 - k % 2;
        list[k].key = 1;
        list[k].id = (uint32_t)(3 * k + 1);
    }
    mesh.xyz = xyz;
    mesh.tri = tri;
    hdi_sort_around(&mesh, 0, 1, list, 6);
    for (k = 0; k < 6; k++) CHECK_MSG(list[k].id == (uint32_t)(3 * want[k] + 1), "place %d: face %d", k, (int)(list[k].id / 3));
}

/* The k-th of numbers and of points along an axis, among which many may be equal; and lists of keys in order. */
static void int_selection(void) {
    uint64_t point[400], a[100], key[100], sum, seed = 6;
    int32_t n, k, i, bad = 0;
    for (n = 1; n < 100; n += 7) {
        for (k = 0; k < n; k++) {
            for (i = 0, sum = 0; i < n; i++) {
                const double x = k % 2 ? (double)(dense_random(&seed) % 5) : dense_signed(&seed);
                point[4 * i] = point[4 * i + 1] = point[4 * i + 2] = 0;
                a[i] = point[4 * i + k % 3] = hdi_rank(x);
                bad += hdi_unrank(a[i]) != x;
                point[4 * i + 3] = (uint64_t)i;
                key[i] = k % 2 ? dense_random(&seed) % 9 : dense_random(&seed);
                sum += key[i] * key[i];
            }
            (void)hdi_kth(a, n, k);
            hdi_select(point, n, k, 4, k % 3);
            hdi_sort_keys(key, n);
            for (i = 0; i < n; i++) {
                const uint64_t x = point[4 * i + k % 3];
                bad += i < k ? a[i] > a[k] || x > point[4 * k + k % 3] : a[i] < a[k] || x < point[4 * k + k % 3];
                bad += i > 0 && key[i] < key[i - 1];
                sum -= key[i] * key[i];
            }
            bad += sum != 0 || a[k] != point[4 * k + k % 3];    /* two ways, the same numbers */
        }
    }
    CHECK_MSG(bad == 0, "%d times another one than the k-th", (int)bad);
}

/* A = V'WV with orthonormal rows V, also with equal and with zero eigenvalues. */
static void int_eigen3(void) {
    uint64_t seed = 7;
    int round, i, j, c;
    for (round = 0; round < 200; round++) {
        double a[3][3], keep[3][3], w[3], v[3][3], worst = 0, top = 1e-300;
        for (i = 0; i < 9; i++)                  /* rank one, multiples of I */
            a[i / 3][i % 3] = round % 4 == 1 ? (i / 3 + 1.0) * (i % 3 + 1.0) : i % 4 == 0 ? 2 : 0;
        for (i = 0; i < 3 && (round % 4 == 0 || round % 4 == 3); i++)
            for (j = 0; j <= i; j++) a[i][j] = a[j][i] = round % 5 == 0 &&
                i != j ? 0 : pow(10, round % 7 - 3) * dense_signed(&seed);
        memcpy(keep, a, sizeof a);
        hdi_eigen3(a, w, v);
        CHECK(w[0] <= w[1] && w[1] <= w[2]);
        for (i = 0; i < 9; i++) {
            double sum = 0, dot = 0;
            for (c = 0; c < 3; c++) {
                sum += w[c] * v[c][i / 3] * v[c][i % 3];
                dot += v[i / 3][c] * v[i % 3][c];
            }
            worst = fmax(worst, fabs(sum - keep[i / 3][i % 3]));
            top = fmax(top, fabs(keep[i / 3][i % 3]));
            CHECK_MSG(fabs(dot - (i % 4 == 0)) < 1e-14, "round %d: vectors %d and %d: %g", round, i / 3, i % 3, dot);
        }
        CHECK_MSG(worst < 4e-15 * top, "round %d: off by %g", round, worst / top);
    }
}

/* A square cut by half-planes and by a hull; and a circle by as many cuts as there can be. */
static void int_polygon(void) {
    double x[6][2] = {{0, 0}, {0.5, 0}, {0, 0.5}, {0.1, 0.1}, {0.25, 0.25}, {0, 0}}, line[3][2] = {{0, 0}, {1, 1}, {0.5, 0.5}};
    hdi_polygon g;
    int32_t k;
    hdi_polygon_begin(&g, 4, 9);
    for (k = 0; k < 4; k++) CHECK(hdi_polygon_clip(&g, (k == 0) - (k == 2), (k == 1) - (k == 3), 1, k));
    CHECK(!hdi_polygon_clip(&g, 1, 1, 2, 0) && g.n == 4 && hdi_polygon_area(&g) == 4);
    CHECK(hdi_polygon_clip(&g, 1, 1, 1, 0) && g.n == 5 && fabs(hdi_polygon_area(&g) - 3.5) < 1e-15);
    CHECK(hdi_polygon_clip(&g, -1, 0, 0, 0) && fabs(hdi_polygon_area(&g) - 1.5) < 1e-15);
    CHECK(hdi_polygon_clip_hull(&g, x, 6) && fabs(hdi_polygon_area(&g) - 0.125) < 1e-15);
    CHECK(hdi_polygon_clip_hull(&g, line, 3) && fabs(hdi_polygon_area(&g)) < 1e-15);
    CHECK(!hdi_polygon_clip(&g, 1, 0, 5, 0));
    hdi_polygon_begin(&g, HDI_CELL_SIDES, 1.9);
    for (k = 0; k < 2 * HDI_MOST_NEIGHBOURS; k++) CHECK(hdi_polygon_clip(&g, cos(acos(-1.0) * (k * 101 % 256) / 128),
        sin(acos(-1.0) * (k * 101 % 256) / 128), 1, k));
    CHECK(g.n == 2 * HDI_MOST_NEIGHBOURS && g.n <= HDI_POLYGON_MOST);
}

/* ---- [04] context: tasks of threads ---- */

#if HDI_THREADS
/* The caller's tasks wait until another thread has one, and that one until the caller sleeps. */
typedef struct int_nap { hd_threads *threads; int32_t begun, slept; } int_nap;

static int int_caller_sleeps(hd_threads *t) {
    int yes;
    hdi_lock(&t->lock);
    yes = t->caller_asleep;
    hdi_unlock(&t->lock);
    return yes;
}

static void int_nap_task(void *arg, int64_t index, int32_t worker) {
    int_nap *w = (int_nap *)arg;
    const time_t start = time(NULL);
    (void)index;
    if (worker > 0 && HDI_ATOMIC_ADD(&w->begun, 1) == 1) {
        while (!int_caller_sleeps(w->threads) && time(NULL) < start + 30) {}
        HDI_STORE(&w->slept, int_caller_sleeps(w->threads));
    }
    while (worker == 0 && HDI_LOAD(&w->begun) == 0 && time(NULL) < start + 60) {}
}
#endif

/* No more threads start than there are tasks besides the caller's; and a caller that has nothing to do sleeps. */
static void int_few_tasks(void) {
#if HDI_THREADS
    enum { TASKS = HDI_TASKS_START };
    hd_context ctx;
    int_nap w;
    memset(&ctx, 0, sizeof ctx);
    memset(&w, 0, sizeof w);
    ctx.n_threads = 4 * TASKS;
    hdi_hold(&ctx);
    w.threads = hdi_threads_own(&ctx, TASKS - 1);
    CHECK(!w.threads);                           /* too few to start any */
    w.threads = hdi_threads_own(&ctx, TASKS);
    if (w.threads) {
        CHECK_MSG(w.threads->n == TASKS - 1, "%d threads", (int)w.threads->n);
        hdi_parallel(&ctx, TASKS, int_nap_task, &w);
        CHECK(w.begun > 0 && w.slept && ctx.waits > 0 && ctx.helped == (uint64_t)w.begun && ctx.regions == 1);
        CHECK(hdi_threads_own(&ctx, TASKS - 1) == w.threads);    /* those that run take part in loops of few tasks, too */
    }
    CHECK(w.threads || !HDI_THREADS);
    hdi_let_go(&ctx);
    CHECK(!ctx.threads);
#endif
}

/* A margin is as wide all around a piece: a row that is near enough to any row of it is there, whatever way led to it first. */
static void int_margins(void) {
    const hd_laplacian *lap = kit_pair("torus/96/64 vor");
    const double reach = 20 * hdi_local_edge(lap, lap->n_active / 2);
    double middle = 0;
    int32_t core, missing = 0, i, j;
    hdi_local *l;
    hd_error e;
    hdi_error_clear(&e);
    l = hdi_local_open(kit_heat(lap, "method=local"), &e);
    for (i = 0; i < lap->n_active; i++) middle += lap->xyz[3 * i] / lap->n_active;
    for (i = 0; i < lap->n_active; i++)
        if (lap->xyz[3 * i] < middle - reach / 2) CHECK(hdi_local_add(l, i, &e) >= 0);
    core = l->n;
    CHECK(core > 0 && hdi_local_grow(l, reach, 0, INT32_MAX, &e) >= 0 && l->n > core && l->n < lap->n_active);
    for (i = 0; i < lap->n_active; i++)
        for (j = 0; j < core && l->place[i] <= 0; j++)
            if (hdi_local_unit(lap, l->at[j].row) * hdi_local_apart(lap, i, l->at[j].row) < 0.95 * reach) j = core, missing++;
    CHECK_MSG(missing == 0, "%d of %d rows are missing", (int)missing, (int)l->n);
    hdi_local_clear(l);
}

/* Where only means are left a component counts once in traces, in however many patches it lies. */
static void int_patches_means(void) {
    static const char *const specs[2] = {"flat/24/24/0.3 fem", "bumpy/3/1 vor"};
    int32_t k, v;
    for (k = 0; k < 2; k++) {
        const hd_laplacian *lap = kit_pair(specs[k]);
        const double t = 1e12 * trial_unit(lap);
        double *D = KIT_NEW(double, lap->n), Z, bound;
        hdi_diagonals to;
        hdi_heat_call h;
        hdi_patches x;
        CHECK(hdi_kernel_begin(&h, kit_heat(lap, "method=local"), HD_KERNEL_OPERATOR, NULL, NULL) >= 0 && hdi_times_check(&h, 1, &t, 1) >= 0);
        memset(&to, 0, sizeof to);
        to.task.h = &h;
        to.mass = 1;
        to.D = D;
        to.ldd = (size_t)lap->n;
        to.Z = &Z;
        to.bound = &bound;
        CHECK(hdi_patches_open(&x, &to, 1) >= 0);
        x.pieces = 3;
        CHECK(hdi_patches_run(&x) >= 0 && h.rep->n_patches > 2 && h.rep->n_touched == lap->n);
        CHECK_MSG(fabs(Z - 1) <= bound && bound < 1e-9, "%s: 1 and %g, bound %g", specs[k], Z - 1, bound);
        for (v = 0; v < lap->n; v++) CHECK(fabs(D[v] - lap->mass[lap->row[v]] / lap->component_mass[0]) < 1e-9 * D[v]);
        (void)hdi_heat_end(&h);
    }
}

/* The bound of (B + tL)^-1 at a source of several points, from a column that least squares makes of the poles' ones, is above the truth:
 * by a factor, without which some are below. */
static void int_source_bound(void) {
    const hd_laplacian *lap = kit_pair("flat/12/12/0.3 fem");
    const double unit = trial_unit(lap);
    double *x = KIT_NEW(double, 3 * lap->n), least = HUGE_VAL, before = HUGE_VAL;
    uint64_t seed = 5;
    int32_t degree, k, q;
    for (degree = 2; degree < 10; degree++) {
        for (k = 0; k < 8; k++) {
            const hdi_distance_row *kind = hdi_distance_of(HD_DISTANCE_CLASSICAL);
            const double t = unit * pow(10, k % 4 - 1);
            const int32_t vertex[3] = {3 * k, 40 + 5 * k, 90 + 2 * k};
            const double weight[3] = {dense_signed(&seed), dense_signed(&seed), dense_signed(&seed)};
            const hdi_terms from = {3, 0, vertex, weight};
            hd_heat *heat = kit_heat(lap, "method=direct");
            hdi_metric_end end;
            hdi_heat_call h;
            hdi_metric m;
            hdi_factor f;
            hdi_sweep z;
            hdi_scope s;
            double form = 0;
            memset(&f, 0, sizeof f);
            heat->opts.degree = degree;
            CHECK(hdi_kernel_begin(&h, heat, HD_KERNEL_SYMMETRIC, NULL, NULL) >= 0 && hdi_times_check(&h, 1, &t, 1) >= 0);
            s = hdi_scope_begin(heat->ctx, h.e);
            CHECK(hdi_metric_make(&h, kind, 1, 0, 0, &m, &s) >= 0 && hdi_metric_solve(&m, &from, 1) >= 0);
            if (m.bounded) {
                end = hdi_metric_source(&m, &from, m.off, hdi_metric_sum(&m, 0, 0, 0), hdi_metric_sum(&m, 0, 0, 1));
                CHECK(hdi_elim_real(&heat->elim, &f, h.t, 1, h.e) >= 0);
                memset(x, 0, (size_t)lap->n * sizeof *x);
                for (q = 0; q < 3; q++) x[heat->elim.lap->row[vertex[q]]] += weight[q];
                z = hdi_sweep_open(&f, 1, x, HDI_TAKE(&s, double, hdi_sweep_size(&heat->elim.sym, 1, 1)));
                hdi_sweep_run(&z, heat->ctx);
                for (q = 0; q < 3; q++) form += weight[q] * x[heat->elim.lap->row[vertex[q]]];
                least = hdi_min(least, end.g / form);
                before = hdi_min(before, end.g / form / m.f.slack);
                hdi_factor_free(&f);
            }
            (void)hdi_scope_end(&s);
            (void)hdi_heat_end(&h);
        }
    }
    CHECK_MSG(least >= 1 && before < 1, "%.9g, without the factor %.9g", least, before);
}

/* Where only some rows count the fronts without these are left out, and the values of the others stay: of k_t, of K_t by entries of
 * the inverse, and of B k_t B by forms. */
static void int_core(void) {
    const hd_laplacian *lap = kit_pair("flat/60/60/0.3 fem");
    const double t = 3 * lap->h * lap->h;
    const int32_t core = lap->n / 12;
    double *D[2] = {KIT_NEW(double, lap->n), KIT_NEW(double, lap->n)};
    int32_t mass, part, v, left_out;
    for (mass = 0; mass < 3; mass++) {
        for (part = 0; part < 2; part++) {
            hdi_diagonals to;
            hdi_heat_call h;
            hdi_scope s;
            CHECK(hdi_kernel_begin(&h, kit_heat(lap, "method=direct"), HD_KERNEL_SYMMETRIC, NULL, NULL) >= 0 &&
                  hdi_times_check(&h, 1, &t, 1) >= 0);
            h.core = part ? core : 0;
            memset(&to, 0, sizeof to);
            to.task.h = &h;
            to.mass = mass;
            to.D = D[part];
            to.ldd = (size_t)lap->n;
            if (part && hdi_heat_analysed(h.heat, h.e) >= 0)
                h.active = hdi_inverses_fronts(&h, hdi_diagonals_wanted(&to), &h.s);
            CHECK(hdi_diagonals_run(&h, &to) >= 0 && h.rep->error_bound < 1e-5);
            s = hdi_scope_begin(h.heat->ctx, h.e);
            if (part) {
                const char *active = hdi_inverses_fronts(&h, lap->B && to.mass > 0 ? HDI_WANT_ENTRIES : HDI_WANT_DIAGONAL, &s);
                for (v = 0, left_out = 0; v < h.heat->elim.sym.n_super; v++) left_out += !active[v];
                CHECK_MSG(left_out > h.heat->elim.sym.n_super / 2, "%d of %d", (int)left_out, (int)h.heat->elim.sym.n_super);
            }
            (void)hdi_scope_end(&s);
            (void)hdi_heat_end(&h);
        }
        for (v = 0; v < core; v++) CHECK(fabs(D[1][v] - D[0][v]) <= 1e-12 * D[0][v]);
        for (; v < lap->n; v++) CHECK(D[1][v] == 0);
    }
}

/* The variables that are left have all the weight and are in the lists of degrees, elements weigh
 * what they say, and each degree lies between the weight of the neighbours and the weight of all lists. */
static int int_amd_sound(hdi_amd *g) {
    hdi_amd_node *v = g->v;
    int32_t i, k, q, left = g->left, listed = 0, wrong = 0;
    for (i = 0; i < g->n; i++) {
        int32_t exact = 0, sum = 0;
        if (v[i].weight == 0 || v[i].elen == HDI_AMD_PIVOT) continue;
        left -= v[i].weight;
        listed += i < g->inner;
        hdi_amd_next_flag(g, 1);
        v[i].mark = g->flag;
        for (k = 0; k < v[i].len; k++) {
            const int32_t *e = g->list + v[i].at + k, is_element = k < v[i].elen;
            const int32_t *l = is_element ? g->list + v[*e].at : e, len = is_element ? v[*e].len : 1;
            int32_t all = 0;
            wrong += (v[*e].elen == HDI_AMD_PIVOT) != is_element || (is_element && v[*e].mark == 0);
            for (q = 0; q < len; q++) {
                all += v[l[q]].weight;
                exact += v[l[q]].mark == g->flag ? 0 : v[l[q]].weight;
                v[l[q]].mark = g->flag;
            }
            sum += is_element ? all - v[i].weight : all;
            wrong += is_element && all != v[*e].degree;
        }
        wrong += i < g->inner && (v[i].degree < exact || v[i].degree > sum);
    }
    for (k = 0; k <= g->n; k++)
        for (i = g->head[k]; i >= 0; i = v[i].next, listed--)
            wrong += v[i].degree != k || k < g->least || v[i].weight == 0 || v[i].elen == HDI_AMD_PIVOT;
    return wrong == 0 && left == 0 && listed == 0;
}

/* Minimum degree with a halo, step by step: what it keeps is sound after each. */
static void int_amd_steps(void) {
    enum { SIDE = 24, N = SIDE * SIDE, INNER = N - 2 * SIDE };
    static int32_t ptr[INNER + 1], col[8 * INNER], perm[INNER], seen[INNER];
    hdi_amd_graph rows = {N, INNER, ptr, col};
    static hdi_amd g;
    int32_t i, dx, dy, count, z = 0, *work;
    for (i = 0; i < INNER; i++) {
        ptr[i] = z;
        for (dy = -1; dy <= 1; dy++)
            for (dx = -1; dx <= 1; dx++) {
                const int32_t x = i % SIDE + dx, y = i / SIDE + dy;
                if (x < 0 || y < 0 || x >= SIDE || y >= SIDE || (dx == 0 && dy == 0) || dx == -dy) continue;
                col[z++] = x + SIDE * y;
            }
    }
    ptr[INNER] = z;
    work = (int32_t *)malloc((size_t)hdi_amd_words(INNER, N - INNER, z) * sizeof *work);
    count = hdi_amd_start(&g, &rows, work);
    CHECK(int_amd_sound(&g));
    while (g.done < count) {
        hdi_amd_run(&g, g.done + 1);
        CHECK(int_amd_sound(&g));
    }
    hdi_amd_number(&g, perm);
    for (i = 0; i < INNER; i++) seen[perm[i]]++;
    for (i = 0; i < INNER; i++) CHECK(seen[i] == 1);
    free(work);
}

/* The tests, in groups that free what they made. */
static void (*const int_tests[])(void) = {
    int_few_tasks, int_division, int_not_finite, int_complex, int_sizes, int_texts, int_sums, int_arrays, int_memory,
    int_large_pages, int_sorting, int_union_find, int_tridiagonal, int_tridiagonal_odd, int_collinear, int_krylov_done,
    int_ildl, int_products, int_residuals, int_noise_weights, int_pole_bounds, int_resolvent_weights, int_no_numbers, int_lanczos_bound,
    int_krylov_slopes, int_ritz_above, int_probe_rows, int_pairs_degree, int_spectrum_proof,
    int_least_squares, int_exp_rest, int_patches, int_margins, int_patches_means, int_core, int_source_bound, int_links, int_shared_bounds, int_length_area, int_around, int_selection,
    int_eigen3, int_polygon, int_krylov_bounds, int_damages_1, int_damages_2, int_damages_3,
    int_damages_4, int_damages_5, int_amd_steps,
};

int main(int argc, char **argv) {
    size_t k;
#if HDI_THREADS
    GUARD_THREADS(sizeof(hd_threads));
#endif
    if (argc > 1 && (strcmp(argv[1], "--traps") != 0 || !test_traps_start())) {
        fprintf(stderr, "usage: internals [--traps]; traps are those of glibc on x86\n");
        return 2;
    }
    for (k = 0; k < sizeof int_tests / sizeof *int_tests; k++) {
        int_tests[k]();
        kit_release(0);
    }
    printf("%lld passed, %lld failed\n", (long long)int_passed, (long long)int_failed);
    return int_failed > 0;
}
