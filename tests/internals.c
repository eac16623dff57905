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
#include "at.h"
#include "../tools/shapes.h"

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

/* ---- [01] scalar ---- */

static void int_division(void) {
    static const double big[5] = {1, 1e300, 1e-300, 1e150, 1e-150};
    int i, j, k;
    TRAPS_OFF;                                   /* by nothing, and beyond the largest number */
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
    TRAPS_ON;
    CHECK(hdi_nan((double)NAN) && hdi_nan(-(double)NAN) && !hdi_nan((double)INFINITY) && !hdi_nan(-(double)INFINITY) && !hdi_nan(-DBL_MAX) && !hdi_nan(0));
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
    const uint64_t all = UINT64_MAX, small = UINT32_MAX;   /* small: what an address of 32 bits reaches */
    uint64_t out = 77;
    CHECK(hdi_size(3, 4, 5, all, &out) && out == 17);
    CHECK(hdi_size(0, all, 5, all, &out) && out == 5);
    CHECK(hdi_size(all, 0, 5, all, &out) && out == 5);
    CHECK(hdi_size(all, 1, 0, all, &out) && out == all);
    out = 77;
    CHECK(!hdi_size(all, 1, 1, all, &out) && out == 77);
    CHECK(!hdi_size(all / 2 + 1, 2, 0, all, &out) && !hdi_size(2, all / 2 + 1, 0, all, &out));
    CHECK(hdi_size(all / 2, 2, 1, all, &out) && out == all);
    CHECK(!hdi_size(all / 16, 16, 80, all, &out));
    CHECK(!hdi_size(small + 1, 8, 0, small, &out) && !hdi_size(small / 8, 8, 80, small, &out) && !hdi_size(0, 8, 80, 79, &out));
    CHECK(hdi_size(small / 8, 8, 7, small, &out) && out == small);
}

/* ---- [02] error ---- */

static void int_texts(void) {
    static const double bytes[8] = {0, 1, 1e5, 100001, 999999, 123456789, 5e9, 9.9e5};
    static const char *const want[8] = {"0.0 MB", "0.1 MB", "0.1 MB", "0.2 MB", "1.0 MB", "123.5 MB", "5000.0 MB", "1.0 MB"};
    hd_error e = int_no_error();
    size_t k;
    for (k = 0; k < 8; k++) {
        hdi_error_clear(&e);
        hdi_text_bytes(&e, bytes[k]);
        CHECK_MSG(strcmp(e.text, want[k]) == 0, "%g bytes: %s", bytes[k], e.text);
    }
    {
        char longer[400];
        memset(longer, 'x', sizeof longer);
        longer[sizeof longer - 1] = 0;
        CHECK(hdi_fail(&e, HD_ERR_ARGUMENT, longer) == HD_ERR_ARGUMENT && strlen(e.text) == sizeof e.text - 1 && e.text[0] == 'x');
    }
    hdi_error_clear(&e);
    for (k = 0; k < 200; k++) hdi_text_add(&e, "abcdefg");   /* until there is no room: the last letters are left out */
    CHECK(strlen(e.text) == sizeof e.text - 1);
    for (k = 0; k + 1 < sizeof e.text; k++) CHECK(e.text[k] == (char)('a' + k % 7));
}

/* Sums keep what rounding takes away, whichever of two numbers is the larger. */
static void int_sums(void) {
    static const double x[2][5] = {{1, 1e16, 3, -1e16, 1e-3}, {1e16, 1, -1e16, 3, 1e-3}};
    int k, i;
    for (k = 0; k < 2; k++) {
        hdi_sum s;
        memset(&s, 0, sizeof s);
        for (i = 0; i < 5; i++) hdi_sum_add(&s, x[k][i]);
        CHECK_MSG(fabs(s.high + s.low - 4.001) < 1e-15 * 8, "%.17g", s.high + s.low);
    }
}

/* Megabytes to one decimal, rounded up. */
static void int_megabytes(void) {
    static const double tenths[12] = {0, 1, 9, 10, 11, 99, 100, 101, 109, 110, 1005, 10000};
    char want[40];
    hd_error e = int_no_error();
    int k;
    for (k = 0; k < 12; k++) {
        hdi_error_clear(&e);
        hdi_text_bytes(&e, 1e5 * (tenths[k] - (k % 2 ? 0.5 : 0)));
        sprintf(want, "%.1f MB", tenths[k] / 10);
        CHECK_MSG(strcmp(e.text, want) == 0, "%s, not %s", e.text, want);
    }
}

/* Takes that are only added up: as many bytes as blocks of their own would count, and 2^60 where a number has no meaning. */
static void int_tally(void) {
    hd_context ctx;
    hd_error e = int_no_error();
    uint64_t bytes;
    hdi_scope s = hdi_scope_tally(&bytes, &e), real;
    memset(&ctx, 0, sizeof ctx);
    real = hdi_scope_begin(&ctx, &e);
    CHECK(!HDI_TAKE(&s, double, 7) && HDI_TAKE(&real, double, 7));
    CHECK(!HDI_TAKE(&s, char, 0) && HDI_TAKE(&real, char, 0));
    CHECK(!HDI_TAKE(&s, hd_c64, 1000) && HDI_TAKE(&real, hd_c64, 1000));
    CHECK(bytes == ctx.bytes_in_use && e.status == HD_OK);
    CHECK(hdi_scope_end(&real) == HD_OK && ctx.bytes_in_use == 0);
    hdi_scope_count(&bytes, UINT64_MAX / 8, 8);
    CHECK(bytes == UINT64_C(1) << 60);
    hdi_scope_count(&bytes, 5, 8);
    CHECK(bytes == UINT64_C(1) << 60);
    ctx.byte_limit = 1000;
    ctx.bytes_in_use = 900;
    CHECK(hdi_need(&ctx, 100, "one more", &e) == HD_OK);
    CHECK(hdi_need(&ctx, 101, "one more", &e) == HD_ERR_MEMORY_LIMIT && e.value == 1001);
    CHECK(strcmp(e.text, "one more would bring the memory in use to 0.1 MB, and the byte limit is 0.1 MB") == 0);
}

/* ---- [05] arrays ---- */

static void int_arrays(void) {
    static const int32_t rel[9] = {-4, -1, 0, 0, 3, 3, 3, 8, 900};
    int32_t a[6] = {9, 9, 9, 9, 9, 9}, parent[9] = {0, 0, 1, 3, 4, 4, 4, 7, 7};
    int64_t count[6] = {2, 0, 5, 1, -7, 77}, ptr[5] = {4, 4, 9, 13, 77};
    int64_t n, x, at;
    hdi_fill_i32(a + 1, 4, -3);
    CHECK(a[0] == 9 && a[1] == -3 && a[2] == -3 && a[3] == -3 && a[4] == -3 && a[5] == 9);
    hdi_fill_own(a + 1, 4);
    CHECK(a[0] == 9 && a[1] == 0 && a[2] == 1 && a[3] == 2 && a[4] == 3 && a[5] == 9);
    CHECK(hdi_prefix_sum(count, 4) == 8);
    CHECK(count[0] == 0 && count[1] == 2 && count[2] == 2 && count[3] == 7 && count[4] == 8 && count[5] == 77);
    CHECK(hdi_fullest(count, 4) == 5 && hdi_fullest(count, 2) == 2 && hdi_fullest(count + 1, 1) == 1 && hdi_fullest(count, 0) == 1);
    hdi_rewind(ptr, 3);
    CHECK(ptr[0] == 0 && ptr[1] == 4 && ptr[2] == 4 && ptr[3] == 9 && ptr[4] == 77);
    CHECK(hdi_count_sets(parent, 9) == 3);       /* {0 1 2}, {3}, {4 5 6}, {7 8} */
    for (n = 0; n <= 9; n++) {
        for (x = -6; x < 910; x++) {
            for (at = 0; at < n && rel[at] < x; at++) {}
            if (hdi_lower_bound(rel, n, x) != at) CHECK_MSG(0, "%d of %d", (int)x, (int)n);
        }
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

/* A scope that is full gives no more, and frees what it has. */
static void int_scope_room(void) {
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_scope s;
    int i;
    memset(&ctx, 0, sizeof ctx);
    s = hdi_scope_begin(&ctx, &e);
    for (i = 0; i < HDI_SCOPE_MOST; i++) CHECK(HDI_TAKE(&s, int32_t, i) != NULL);
    CHECK(e.status == HD_OK && HDI_TAKE(&s, int32_t, 1) == NULL && e.status == HD_ERR_TOO_LARGE && ctx.bytes_in_use > 0);
    CHECK(hdi_scope_end(&s) == HD_ERR_TOO_LARGE && ctx.bytes_in_use == 0);
}

/* Advice on large blocks begins where pages do, be they of 4, 16 or 64 KB, and stays within the block. */
static void int_large_pages(void) {
#if HDI_LARGE_PAGES
    hd_context ctx;
    hd_error e;
    size_t k;
    memset(&ctx, 0, sizeof ctx);
    hdi_error_clear(&e);
    for (k = 0; k < 6; k++) {
        const size_t size = ((size_t)5 << 20) + 5000 * k;
        char *p = (char *)hdi_alloc(&ctx, size, 1, &e);
        CHECK(p != NULL);
        if (!p) return;
        CHECK_MSG((size_t)int_advised_at % 65536 == 0 && int_advised > size - 2 * 65536, "%zu of %zu bytes, %zu past a page", int_advised, size,
                  (size_t)int_advised_at % 65536);
        CHECK(int_advised_at >= p - HDI_ALIGN - HDI_HEADER && int_advised_at + int_advised <= p + size);
        hdi_free(&ctx, p);
    }
#endif
}

static void int_memory(void) {
    hd_context ctx;
    hd_error e = int_no_error();
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
    ctx.byte_limit = 1;                          /* the largest array that an address can tell meets the limit, one byte more does not */
    hdi_error_clear(&e);
    CHECK(hdi_alloc(&ctx, PTRDIFF_MAX - HDI_ALIGN - HDI_HEADER, 1, &e) == NULL && e.status == HD_ERR_MEMORY_LIMIT);
    hdi_error_clear(&e);
    CHECK(hdi_alloc(&ctx, PTRDIFF_MAX - HDI_ALIGN - HDI_HEADER + 1, 1, &e) == NULL && e.status == HD_ERR_TOO_LARGE);
    ctx.byte_limit = 0;
    hdi_error_clear(&e);
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
    int32_t beside = 5;
    uint64_t seed = 1, room = 77;
    int k, form;
    int64_t i;
    for (k = 0; k < 14; k++) {
        for (form = 0; form < 7; form++) {
            const int64_t n = sizes[k];
            hdi_pair *a = DENSE_NEW(hdi_pair, n), *b = DENSE_NEW(hdi_pair, n);
            uint64_t *work = DENSE_NEW(uint64_t, 2 * n);
            int32_t *x = DENSE_NEW(int32_t, n);
            for (i = 0; i < n; i++) {
                a[i].key = b[i].key = int_key(form, i, n, &seed);
                a[i].id = b[i].id = n - i;
                x[i] = (int32_t)(a[i].key % 100003);
                work[i] = 0;
            }
            hdi_sort_pairs(a, n);
            qsort(b, (size_t)n, sizeof *b, int_compare);
            CHECK_MSG(memcmp(a, b, (size_t)n * sizeof *a) == 0, "%d pairs of form %d are not sorted", (int)n, form);
            for (i = 0; i < n; i++) {
                b[i].key = (uint64_t)x[i];
                b[i].id = 0;
            }
            qsort(b, (size_t)n, sizeof *b, int_compare);
            hdi_sort_indices(x, n, work);
            for (i = 0; i < n && (uint64_t)x[i] == b[i].key; i++) {}
            CHECK_MSG(i == n, "%d indices of form %d are not sorted", (int)n, form);
            free(a);
            free(b);
            free(work);
            free(x);
        }
    }
    hdi_sort_indices(&beside, 0, &room);         /* an empty list has no room */
    CHECK(beside == 5 && room == 77);
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
        double *d = DENSE_NEW(double, m + 1), *e = DENSE_NEW(double, m + 1), *z0 = DENSE_NEW(double, m), *z1 = DENSE_NEW(double, m), worst = 0;
        int32_t i, j;
        d[m] = e[m] = NAN;                       /* not theirs */
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
    g[0] = g[1] = off[0] = (double)NAN;           /* nothing ever gets small */
    CHECK(!hdi_tridiag_eigen(g, off, y0, y1, 2));
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

/* Rows longer than 10 sqrt(n) are eliminated last: here hubs of leaves, which would be bare after them, before the cycle is half done. In the same
 * order whether a caller counts by long or by short numbers. */
static void int_amd_dense(void) {
    enum { LEAVES = 900, HUBS = 2, CYCLE = 500, N = HUBS * (LEAVES + 1) + CYCLE, NNZ = 2 * (HUBS * LEAVES + CYCLE) };
    static int32_t from[NNZ], to[NNZ], perm[N], short_perm[N], ptr[N + 1], place[N];
    static double one[NNZ];
    hd_csr a;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_amd_graph g;
    int32_t i, k = 0, *work;
    memset(&ctx, 0, sizeof ctx);
    for (i = 0; i < HUBS * LEAVES; i++) {        /* hubs 0 and 1, the leaves of both, the cycle */
        from[k] = to[k + 1] = i % HUBS;
        to[k] = from[k + 1] = HUBS + i;
        k += 2;
    }
    for (i = 0; i < CYCLE; i++) {
        from[k] = to[k + 1] = HUBS * (LEAVES + 1) + i;
        to[k] = from[k + 1] = HUBS * (LEAVES + 1) + (i + 1) % CYCLE;
        k += 2;
    }
    for (i = 0; i < NNZ; i++) one[i] = 1;
    CHECK(hd_csr_from_triplets(&a, N, N, NNZ, from, to, one, NULL, &e) == HD_OK);
    CHECK(hdi_amd_order(&a, perm, &ctx, &e) == HD_OK);
    CHECK(perm[N - 1] + perm[N - 2] == 1);
    for (i = 0; i < N; i++) place[i] = -1;
    for (i = 0; i < N; i++) place[perm[i]] = i;
    for (i = 0; i < N; i++) CHECK(place[i] >= 0);
    g.n = g.inner = N;
    g.wide = NULL;
    g.ptr = ptr;
    g.col = a.col;
    for (i = 0; i <= N; i++) ptr[i] = (int32_t)a.row_ptr[i];
    work = DENSE_NEW(int32_t, hdi_amd_part_words(N, 0, NNZ));
    hdi_amd_part(&g, short_perm, work);
    CHECK(memcmp(perm, short_perm, sizeof perm) == 0);
    free(work);
    hd_csr_free(&a, NULL);
}

/* ---- [13] degree: every step by definition ---- */

/* A graph that vertices are eliminated from: joined[i n + j]. done[i]: it is gone. */
typedef struct int_elimination { int32_t n; char *joined, *done; } int_elimination;

static void int_eliminate(int_elimination *x, int32_t k) {
    int32_t i, j;
    x->done[k] = 1;
    for (i = 0; i < x->n; i++)
        for (j = 0; !x->done[i] && x->joined[k * x->n + i] && j < x->n; j++)
            if (!x->done[j] && j != i && x->joined[k * x->n + j]) x->joined[i * x->n + j] = 1;
}

static int int_amd_lives(const hdi_amd *g, int32_t i) { return g->v[i].weight > 0 && g->v[i].elen != HDI_AMD_PIVOT; }

/* The vertex that i was merged or eliminated with, or i. */
static int32_t int_amd_root(const hdi_amd *g, int32_t i) {
    while (g->v[i].weight == 0 && g->v[i].elen != HDI_AMD_PIVOT) i = g->v[i].at;
    return i;
}

/* near[j] = 1 for the variables j that the lists of i join to it: its own, and those of its elements. Returns their weight. */
static int32_t int_amd_near(const hdi_amd *g, int32_t i, char *near) {
    const hdi_amd_node *v = g->v;
    int32_t p, q, weight = 0;
    memset(near, 0, (size_t)g->n);
    for (p = 0; p < v[i].len; p++) {
        const int32_t e = g->list[v[i].at + p];
        for (q = 0; p < v[i].elen && q < v[e].len; q++) near[g->list[v[e].at + q]] = 1;
        if (p >= v[i].elen) near[e] = 1;
        else CHECK(v[e].elen == HDI_AMD_PIVOT && v[e].mark > 0);
    }
    near[i] = 0;
    for (p = 0; p < g->n; p++) {
        near[p] = near[p] && int_amd_lives(g, p);
        weight += near[p] ? v[p].weight : 0;
    }
    return weight;
}

/* Weight of what i is joined to outside of l: the sum of its elements and variables, each counted by itself (Amestoy, Davis, Duff 1996, (4)). */
static int32_t int_amd_outside(const hdi_amd *g, int32_t i, int32_t me, const char *l) {
    const hdi_amd_node *v = g->v;
    int32_t p, q, sum = 0;
    for (p = 0; p < v[i].len; p++) {
        const int32_t e = g->list[v[i].at + p];
        if (p >= v[i].elen) {
            CHECK(!l[e] && int_amd_lives(g, e));
            sum += v[e].weight;
        } else if (e != me) {
            int32_t more = 0;
            for (q = 0; q < v[e].len; q++) {
                const int32_t j = g->list[v[e].at + q];
                more += int_amd_lives(g, j) && !l[j] ? v[j].weight : 0;
            }
            CHECK(more > 0);                     /* an element within the new one is absorbed */
            sum += more;
        }
    }
    return sum;
}

/* Whether two variables have the same lists but for the order. */
static int int_amd_alike(const hdi_amd *g, int32_t i, int32_t j) {
    const hdi_amd_node *a = g->v + i, *b = g->v + j;
    int32_t p, q;
    if (a->len != b->len || a->elen != b->elen || (i < g->inner) != (j < g->inner)) return 0;
    for (p = 0; p < a->len; p++) {
        for (q = 0; q < b->len && g->list[b->at + q] != g->list[a->at + p]; q++) {}
        if (q == b->len) return 0;
    }
    return 1;
}

/* All variables of the graph as it is: the lists and weights stand for x, the degrees are bounds. */
static void int_amd_state(const hdi_amd *g, const int_elimination *x, char *near) {
    const int32_t n = g->n;
    int32_t *weight = DENSE_NEW(int32_t, n), i, j, wrong = 0, exact, left = 0;
    for (i = 0; i < n; i++) {
        weight[int_amd_root(g, i)]++;
        left += !x->done[i];
    }
    CHECK(g->left == left && g->flag > 0);
    for (i = 0; i < n; i++) {
        const hdi_amd_node *v = g->v + i;
        if (!v->weight) continue;                /* merged, or without neighbours from the beginning */
        CHECK_MSG(v->weight == weight[i], "vertex %d stands for %d, not %d", (int)i, (int)weight[i], (int)v->weight);
        CHECK(v->mark >= 0 && v->mark <= g->flag);
        if (!int_amd_lives(g, i)) continue;
        CHECK(!x->done[i] && (i >= g->inner || v->len > 1 || (v->elen == 0 && v->len == 1)));   /* not one that should have gone with the pivot */
        exact = int_amd_near(g, i, near);
        if (i < g->inner) CHECK_MSG(v->degree >= exact, "degree %d, at least %d", (int)v->degree, (int)exact);
        for (j = 0; j < n; j++) {
            const int32_t r = int_amd_root(g, j);
            if (!x->done[j] && r != i) wrong += near[r] != x->joined[i * n + j];
            if (!x->done[j] && r == i && j != i) wrong += memcmp(x->joined + i * n, x->joined + j * n, (size_t)n) != 0 && !x->joined[i * n + j];
        }
    }
    CHECK_MSG(wrong == 0, "%d edges wrong with %d vertices left", (int)wrong, (int)left);
    free(weight);
}

/* After the pivot me: what is in its list has the degree that the paper gives, from the degrees before; twins are merged. */
static void int_amd_degrees(const hdi_amd *g, int32_t me, const int32_t *before, char *l) {
    const hdi_amd_node *v = g->v;
    int32_t p, q, i, all = 0;
    memset(l, 0, (size_t)g->n);
    for (p = 0; p < v[me].len; p++) {
        i = g->list[v[me].at + p];
        CHECK(int_amd_lives(g, i) && !l[i]);
        l[i] = 1;
        all += v[i].weight;
    }
    CHECK_MSG(v[me].degree == all, "the pivot's list weighs %d, not %d", (int)all, (int)v[me].degree);
    for (p = 0; p < v[me].len; p++) {
        int32_t want;
        i = g->list[v[me].at + p];
        for (q = 0; q < p; q++) CHECK(!int_amd_alike(g, i, g->list[v[me].at + q]));
        CHECK(v[i].elen > 0 && g->list[v[i].at] == me);
        if (i >= g->inner) continue;
        want = int_amd_outside(g, i, me, l);
        want = (want < before[i] ? want : before[i]) + all - v[i].weight;
        if (want > g->left - v[i].weight) want = g->left - v[i].weight;
        CHECK_MSG(v[i].degree == want, "degree %d, not %d", (int)v[i].degree, (int)want);
    }
    for (i = 0; i < g->inner; i++) CHECK(!int_amd_lives(g, i) || l[i] || v[i].degree == before[i]);
}

/* Moves the lists together: they stay what they are, and nothing else is kept. */
static void int_amd_compacted(hdi_amd *g, const int_elimination *x, char *near) {
    int32_t i, p, size = 0;
    memset(near, 0, (size_t)g->n);               /* elements that a variable has */
    for (i = 0; i < g->n; i++)
        for (p = 0; int_amd_lives(g, i) && p < g->v[i].elen; p++) near[g->list[g->v[i].at + p]] = 1;
    for (i = 0; i < g->n; i++) size += int_amd_lives(g, i) || near[i] ? g->v[i].len : 0;
    hdi_amd_compact(g);
    CHECK_MSG(g->free == size, "lists of %d words, not %d", (int)g->free, (int)size);
    int_amd_state(g, x, near);
}

/* Orders a graph step by step. Every pivot is of the least degree, and stands for vertices that are alike. wrap: the marks run out again and again. */
static void int_amd_steps_of(const hdi_amd_graph *a, int wrap) {
    const int32_t n = a->n;
    const int64_t nnz = a->ptr[a->inner];
    const int64_t words = hdi_amd_part_words(a->inner, n - a->inner, nnz) - (n > a->inner ? 2 * nnz : nnz) / 5;
    int32_t *work = DENSE_NEW(int32_t, words), *before = DENSE_NEW(int32_t, n), *perm = DENSE_NEW(int32_t, n), *when = DENSE_NEW(int32_t, n);
    char *l = DENSE_NEW(char, n);
    int_elimination x;
    hdi_amd g;
    int32_t i, p, me, done, least, count;
    x.n = n;
    x.joined = DENSE_NEW(char, n * n);
    x.done = DENSE_NEW(char, n);
    for (i = 0; i < a->inner; i++)
        for (p = a->ptr[i]; p < a->ptr[i + 1]; p++)
            if (a->col[p] != i) x.joined[i * n + a->col[p]] = x.joined[a->col[p] * n + i] = 1;
    memset(work, 0x80, (size_t)words * sizeof *work);    /* not places of lists */
    hdi_amd_begin(&g, n, a->inner, work, words);
    hdi_amd_load(&g, a);
    count = hdi_amd_start(&g);
    CHECK(count == a->inner);
    for (i = 0; i < a->inner; i++) {             /* those without neighbours are in the order already */
        x.done[i] = g.v[i].elen == HDI_AMD_PIVOT;
        if (x.done[i]) when[g.v[i].prev] = i;
    }
    int_amd_state(&g, &x, l);
    while (g.done < count && int_failed < 50) {
        done = g.done;
        for (i = 0, least = n; i < n; i++) {
            before[i] = g.v[i].degree;
            if (i < a->inner && int_amd_lives(&g, i) && before[i] < least) least = before[i];
        }
        if (wrap && g.flag < INT32_MAX / 2) g.flag = INT32_MAX - 4 * n - wrap;
        hdi_amd_run(&g, done + 1);
        for (me = 0; me < a->inner && (g.v[me].elen != HDI_AMD_PIVOT || g.v[me].prev != done); me++) {}
        CHECK_MSG(me < a->inner && before[me] == least, "pivot %d of degree %d, not %d", (int)me, (int)before[me], (int)least);
        if (me == a->inner) break;
        for (i = 0, p = 0; i < n; i++) {
            if (int_amd_root(&g, i) != me) continue;
            int_eliminate(&x, i);
            when[done + p++] = me;
        }
        CHECK(done + p == g.done && p == g.v[me].weight);
        int_amd_state(&g, &x, l);
        int_amd_degrees(&g, me, before, l);
        if (done % 5 == 0) int_amd_compacted(&g, &x, l);
    }
    for (p = 0; p < n; p++) x.done[p] = 0;
    for (p = 0; p < count; p++) before[p] = when[p];
    for (i = 0; i < a->inner; i++) when[i] = int_amd_root(&g, i);
    if (int_failed < 50) hdi_amd_number(&g, perm);
    for (p = 0; p < count && int_failed < 50; p++) {     /* in the order of the pivots, with what each stands for */
        CHECK(!x.done[perm[p]] && when[perm[p]] == before[p]);
        x.done[perm[p]] = 1;
    }
    free(work);
    free(before);
    free(perm);
    free(when);
    free(l);
    free(x.joined);
    free(x.done);
}

static void int_amd_steps(void) {
    enum { N = 110, MOST = 16 };
    static int32_t ptr[N + 1], col[N * N];
    static char joined[N][N];
    uint64_t seed = 3;
    hdi_amd_graph a;
    int32_t i, j, way;
    for (way = 0; way < 24; way++) {             /* random, of cliques, grids; alone or with a halo */
        const int32_t n = 30 + 5 * (way % 12) + way, inner = way % 2 ? n - n / 4 : n, kind = way / 2 % 3, w = 7;
        memset(joined, 0, sizeof joined);
        for (i = 0; i < n; i++) {
            if (kind == 2 && i % w) joined[i][i - 1] = 1;
            if (kind == 2 && i >= w) joined[i][i - w] = joined[i][i - w + (i % w ? -1 : 0)] = 1;
        }
        for (i = 0; kind == 0 && i < (way < 12 ? 2 : 5) * n; i++) joined[dense_random(&seed) % (uint64_t)n][dense_random(&seed) % (uint64_t)n] = 1;
        for (i = 0; kind == 1 && i < n / 2; i++) {
            int32_t some[MOST];
            const int32_t m = 2 + (int32_t)(dense_random(&seed) % (way < 12 ? 4 : 7));
            for (j = 0; j < m; j++) some[j] = (int32_t)(dense_random(&seed) % (uint64_t)n);
            for (j = 0; j < m * m; j++) joined[some[j / m]][some[j % m]] = 1;
        }
        a.n = n;
        a.inner = inner;
        a.wide = NULL;
        a.ptr = ptr;
        a.col = col;
        for (i = 0, ptr[0] = 0; i < inner; i++) {
            ptr[i + 1] = ptr[i];
            for (j = 0; j < n; j++)
                if (joined[i][j] || joined[j][i]) col[ptr[i + 1]++] = j;
        }
        int_amd_steps_of(&a, way % 4 / 2 * (way % 5));
    }
}

/* ---- [14] dissection: its steps by definition ---- */

/* A graph with weights (heavy), or of the finest copy with some entries that leave the part. wide > 0: a grid of so many columns; else a path and
 * random edges. Freed as one block by its ptr. */
static hdi_nd_graph int_nd_graph(int32_t n, int32_t wide, int heavy, uint64_t *seed) {
    const int32_t most = 12 * n;
    int32_t *room = DENSE_NEW(int32_t, 5 * n + 2 + 2 * most), i, j, k, z = 0, *weight;
    char *joined = DENSE_NEW(char, n * n);
    hdi_nd_graph g;
    memset(&g, 0, sizeof g);
    g.n = n;
    g.ptr = room;
    g.w = heavy ? g.ptr + n + 1 : NULL;
    g.id = room + 2 * n + 1;
    g.map = g.id + n;
    g.side = (int8_t *)(g.map + n);
    g.adj = room + 5 * n + 2;
    g.ew = heavy ? g.adj + most : NULL;
    weight = DENSE_NEW(int32_t, n * n);
    for (i = 1; i < n; i++) {
        if (wide == 0 || i % wide) joined[i * n + i - 1] = 1;
        if (wide > 0 && i >= wide) joined[i * n + i - wide] = 1;
    }
    for (i = 0; wide == 0 && i < 2 * n; i++) {
        j = (int32_t)(dense_random(seed) % (uint64_t)n);
        k = (int32_t)(dense_random(seed) % (uint64_t)n);
        if (j != k) joined[(j > k ? j : k) * n + (j > k ? k : j)] = 1;
    }
    for (i = 0; i < n; i++)
        for (j = 0; j < i; j++) weight[i * n + j] = weight[j * n + i] = 1 + (int32_t)(dense_random(seed) % (wide == 0 ? 60 : 3));
    for (i = 0; i < n; i++) {
        g.ptr[i] = z;
        g.id[i] = i;
        if (heavy) g.w[i] = 1 + (int32_t)(dense_random(seed) % 4);
        for (j = 0; j < n && z < most; j++) {
            if (!(i > j ? joined[i * n + j] : joined[j * n + i])) continue;
            if (heavy) g.ew[z] = weight[i * n + j];
            g.adj[z++] = j;
        }
        if (!heavy && i % 7 == 3) g.adj[z++] = ~(n + i);
    }
    g.ptr[n] = z;
    free(joined);
    free(weight);
    return g;
}

static hdi_nd_space int_nd_space(int32_t words) {
    hdi_nd_space s;
    s.at = DENSE_NEW(int32_t, words);
    s.end = s.at + words;
    memset(s.at, 0x7f, (size_t)words * sizeof *s.at);    /* as memory comes, not zero */
    return s;
}

static int32_t int_nd_weight(const hdi_nd_graph *g, int32_t v) { return g->w ? g->w[v] : 1; }

/* Weight of the edges of v to its own side and to the other. */
static void int_nd_edges(const hdi_nd_graph *g, int32_t v, int32_t sum[2]) {
    int32_t p;
    sum[0] = sum[1] = 0;
    for (p = g->ptr[v]; p < g->ptr[v + 1]; p++)
        if (g->adj[p] >= 0) sum[g->side[g->adj[p]] != g->side[v]] += g->ew ? g->ew[p] : 1;
}

static hdi_nd_cut int_nd_cut(const hdi_nd_graph *g) {
    hdi_nd_cut c;
    int32_t v, sum[2];
    memset(&c, 0, sizeof c);
    for (v = 0; v < g->n; v++) {
        int_nd_edges(g, v, sum);
        c.cut += 0.5 * sum[1];
        c.weight[g->side[v]] += int_nd_weight(g, v);
    }
    return c;
}

/* Gains, weights and queues of a mover by definition. */
static void int_nd_mover_state(const hdi_nd_mover *m, const hdi_nd_cut *cut) {
    const hdi_nd_graph *g = m->g;
    const hdi_nd_cut c = int_nd_cut(g);
    int32_t v, b, i, sum[2], queued = 0, wrong = 0;
    CHECK(c.cut == cut->cut && c.weight[0] == cut->weight[0] && c.weight[1] == cut->weight[1]);
    for (b = 0; b < 2 * HDI_ND_BUCKETS; b++) {
        const int32_t side = b / HDI_ND_BUCKETS;
        for (i = m->q.head[b], v = -1 - b; i >= 0 && queued <= g->n; v = i, i = m->q.next[i]) {
            int32_t k = HDI_ND_BUCKETS / 2 + m->gain[i] / (1 << m->shift);
            k = k < 0 ? 0 : k < HDI_ND_BUCKETS ? k : HDI_ND_BUCKETS - 1;
            wrong += m->q.prev[i] != v || g->side[i] != side || m->locked[i] || b % HDI_ND_BUCKETS != k || b % HDI_ND_BUCKETS > m->q.top[side];
            queued++;
        }
    }
    for (v = 0; v < g->n; v++) {
        int_nd_edges(g, v, sum);
        queued -= m->q.prev[v] != HDI_ND_NONE;
        wrong += m->gain[v] != sum[1] - sum[0] || (sum[1] > 0 && !m->locked[v] && m->q.prev[v] == HDI_ND_NONE);
    }
    CHECK_MSG(wrong == 0 && queued == 0, "%d gains or places wrong", (int)wrong);
}

static int int_nd_may_move(const hdi_nd_mover *m, const hdi_nd_cut *cut, int32_t v) {
    const double after = cut->weight[1 - m->g->side[v]] + int_nd_weight(m->g, v);
    return after <= cut->most || after < cut->weight[m->g->side[v]];
}

/* The vertex to be moved: each side offers one of its highest list. */
static void int_nd_mover_offer(hdi_nd_mover *m, const hdi_nd_cut *cut, int32_t v) {
    int32_t s, best[2];
    for (s = 0; s < 2; s++) {
        int32_t b = HDI_ND_BUCKETS - 1;
        while (b >= 0 && m->q.head[s * HDI_ND_BUCKETS + b] < 0) b--;
        best[s] = b < 0 ? -1 : m->q.head[s * HDI_ND_BUCKETS + b];
        if (best[s] >= 0 && !int_nd_may_move(m, cut, best[s])) best[s] = -1;
    }
    if (best[0] < 0 || best[1] < 0) CHECK(v == (best[0] < 0 ? best[1] : best[0]));
    else if (m->gain[best[0]] != m->gain[best[1]]) CHECK(v == best[m->gain[best[1]] > m->gain[best[0]]]);
    else CHECK(v == best[cut->weight[1] > cut->weight[0]]);
}

/* Random moves, then those that the mover offers: its numbers are right after each. */
static void int_nd_moves(void) {
    uint64_t seed = 5;
    int32_t way, v, n;
    for (way = 0; way < 12; way++) {
        hdi_nd_graph g = int_nd_graph(30 + 9 * way, way % 3 ? 0 : 6, way % 2, &seed);
        hdi_nd_space s = int_nd_space(6 * g.n + 10), rest = s;
        hdi_nd_mover m = hdi_nd_mover_make(&g, &rest);
        hdi_nd_cut cut, c;
        int32_t largest = 1, sum[2];
        for (v = 0; v < g.n; v++) g.side[v] = (int8_t)(way < 6 ? v > g.n / 2 : (int)(dense_random(&seed) % 2));
        c = int_nd_cut(&g);
        cut.most = (way % 4 ? 0.55 : 0.7) * (c.weight[0] + c.weight[1]);
        m.shift = 9;
        hdi_nd_mover_start(&m, &cut);
        int_nd_mover_state(&m, &cut);
        for (v = 0; v < g.n; v++) {
            int_nd_edges(&g, v, sum);
            CHECK((m.q.prev[v] == HDI_ND_NONE) == (sum[1] == 0));        /* those on the cut */
            if (sum[1] > 0) largest = hdi_high32(largest, hdi_high32(sum[0], sum[1]));
        }
        CHECK((largest >> m.shift) < HDI_ND_BUCKETS / 2 && (m.shift == 0 || (largest >> (m.shift - 1)) >= HDI_ND_BUCKETS / 2));
        for (n = 0; n < g.n && (v = hdi_nd_mover_next(&m, &cut)) >= 0; n++) {
            int_nd_mover_offer(&m, &cut, v);
            hdi_nd_queue_remove(&m.q, v);
            m.locked[v] = 1;
            hdi_nd_mover_move(&m, v, &cut);
            int_nd_mover_state(&m, &cut);
        }
        CHECK(n > 2);
        if (n < g.n) int_nd_mover_offer(&m, &cut, -1);
        for (v = 0; v < g.n; v++) g.side[v] = (int8_t)(way < 6 ? v > g.n / 2 : (int)(dense_random(&seed) % 2));
        cut = c = int_nd_cut(&g);
        cut.most = (way % 4 ? 0.55 : 0.7) * (c.weight[0] + c.weight[1]);
        hdi_nd_refine_edges(&m, &cut, 0);
        CHECK(cut.cut == c.cut && int_nd_cut(&g).cut == c.cut);
        memset(m.moved, 0xff, (size_t)g.n * sizeof *m.moved);
        memset(g.map, 0, (size_t)g.n * sizeof *g.map);
        hdi_nd_refine_edges(&m, &cut, 1);
        for (n = 0; n < g.n && m.moved[n] >= 0; n++) CHECK(g.map[m.moved[n]]++ == 0);       /* none twice */
        hdi_nd_refine_edges(&m, &cut, HDI_ND_PASSES);
        CHECK(cut.cut == int_nd_cut(&g).cut && cut.weight[0] == int_nd_cut(&g).weight[0]);
        CHECK(hdi_nd_cost(cut.cut, cut.weight[0], cut.weight[1]) <= hdi_nd_cost(c.cut, c.weight[0], c.weight[1]) ||
              hdi_max(c.weight[0], c.weight[1]) > cut.most);
        CHECK(hdi_max(cut.weight[0], cut.weight[1]) <= cut.most);
        free(s.at);
        free(g.ptr);
    }
}

/* What a cut costs, and the lists of gains: 64 need two of each, larger ones are in the last. */
static void int_nd_buckets(void) {
    int32_t ptr[3] = {0, 1, 2}, adj[2] = {1, 0}, ew[2], e;
    int8_t side[2] = {0, 1};
    hdi_nd_graph g;
    memset(&g, 0, sizeof g);
    g.n = 2;
    g.ptr = ptr;
    g.adj = adj;
    g.ew = ew;
    g.side = side;
    for (e = 62; e < 67; e++) {
        hdi_nd_space s = int_nd_space(20), rest = s;
        hdi_nd_mover m = hdi_nd_mover_make(&g, &rest);
        hdi_nd_cut cut;
        ew[0] = ew[1] = e;
        hdi_nd_mover_start(&m, &cut);
        CHECK(m.shift == (e >= 64) && cut.cut == e);
        CHECK(hdi_nd_bucket(&m, 100000) == HDI_ND_BUCKETS - 1 && hdi_nd_bucket(&m, -100000) == 0 && hdi_nd_bucket(&m, 0) == HDI_ND_BUCKETS / 2);
        free(s.at);
    }
    CHECK(hdi_nd_cost(0, 5, 5) < hdi_nd_cost(0, 6, 4) && hdi_nd_cost(0, 9, 1) < hdi_nd_cost(1, 5, 5) && hdi_nd_cost(7, 5, 5) < hdi_nd_cost(7, 4, 6));
    CHECK(fabs(hdi_nd_cost(9, 3, 0) / hdi_nd_cost(9, 2, 2) - 1 - HDI_ND_UNEVEN) < 1e-14);
}

/* Of a grid the shortest cut is a straight line; of two grids joined by an edge it is that edge, unless one of them is too heavy. */
static void int_nd_refined(void) {
    enum { W = 8, H = 20 };
    uint64_t seed = 6;
    int32_t v, way, p;
    for (way = 0; way < 8; way++) {
        hdi_nd_graph g = int_nd_graph(W * H, W, 0, &seed);
        hdi_nd_space s = int_nd_space(6 * g.n + 10), rest = s;
        hdi_nd_mover m = hdi_nd_mover_make(&g, &rest);
        const int32_t edge = way == 4 ? 10 : way == 5 ? 14 : way == 6 ? 12 : 0;
        hdi_nd_cut cut;
        cut.most = HDI_ND_HEAVIER * g.n;
        if (edge > 0) {
            for (v = 0; v < g.n; v++)
                for (p = g.ptr[v]; p < g.ptr[v + 1]; p++)
                    if (g.adj[p] >= 0 && (g.adj[p] / W < edge) != (v / W < edge) && v % W) g.adj[p] = ~g.n;
        }
        for (v = 0; v < g.n; v++)
            g.side[v] = (int8_t)(way >= 6 ? v / W >= 11 : way >= 4 ? v / W >= edge : v / W >= 9 + (int)(dense_random(&seed) % 3));
        if (way == 7) g.side[0] = 1;             /* on the wrong side all alone */
        hdi_nd_refine_edges(&m, &cut, HDI_ND_PASSES);
        CHECK(hdi_max(cut.weight[0], cut.weight[1]) <= cut.most);
        if (edge == 0) CHECK_MSG(cut.cut == W, "a cut of %g edges", cut.cut);
        if (edge == 10 || edge == 12) CHECK_MSG(cut.cut == 1 && cut.weight[0] == edge * W, "a cut of %g edges", cut.cut);
        free(s.at);
        free(g.ptr);
    }
}

/* A swept cut is the cheapest of those at most a fifth off the middle, by trying all. */
static void int_nd_sweeps(void) {
    enum { MOST = 90 };
    static hdi_pair key[MOST];
    uint64_t seed = 8;
    int32_t way, v, n, k;
    for (way = 0; way < 20; way++) {
        hdi_nd_graph g = int_nd_graph(20 + 3 * way, way % 3 ? 0 : 6, way % 2, &seed);
        int32_t order[MOST], right = 1;
        double total = 0, least = DBL_MAX, found;
        hdi_nd_cut c;
        for (v = 0; v < g.n; v++) order[v] = v;
        if (way % 4 == 2) dense_shuffle(order, g.n, &seed);
        if (way == 0) for (v = 0; v < g.n; v++) g.adj[v] = 0, g.ptr[v + 1] = 0;
        if (way == 0)                            /* a path of 20: all edges count 2 but the last that is allowed */
            for (v = k = 0, g.n = 20; v < 20; v++) {
                for (n = -1; n < 2; n++) {
                    if (n == 0 || v + n < 0 || v + n == 20) continue;
                    g.adj[k++] = v + n;
                    if (v + (n > 0) != 12) g.adj[k++] = v + n;
                }
                g.ptr[v + 1] = k;
            }
        for (v = 0; v < g.n; v++) {
            key[v].id = order[v];
            if (way % 6 == 5 && v == g.n / 3) g.w[v] = 50 * g.n;        /* no cut is near the middle */
            total += int_nd_weight(&g, v);
        }
        for (n = 1; n < g.n; n++) {
            for (v = 0; v < g.n; v++) g.side[order[v]] = v >= n;
            c = int_nd_cut(&g);
            if (way % 6 == 5) least = fmin(least, fabs(c.weight[0] - c.weight[1]));
            if (fabs(c.weight[0] - c.weight[1]) > HDI_ND_SWEPT * total) continue;
            least = fmin(least, (c.cut + 1) * (1 + HDI_ND_UNEVEN * pow((c.weight[0] - c.weight[1]) / total, 2)));
        }
        hdi_nd_sweep(&g, key, total);
        c = int_nd_cut(&g);
        found = way % 6 == 5 ? fabs(c.weight[0] - c.weight[1]) : (c.cut + 1) * (1 + HDI_ND_UNEVEN * pow((c.weight[0] - c.weight[1]) / total, 2));
        for (v = 1; v < g.n; v++) right &= g.side[order[v]] >= g.side[order[v - 1]];
        CHECK_MSG(right && g.side[order[0]] == 0 && fabs(found - least) < 1e-12 * least, "a cost of %g, not %g", found, least);
        if (way == 0) CHECK(c.weight[0] == 12);
        free(g.ptr);
    }
}

static int32_t int_nd_farthest(const float *xyz, int32_t n, int32_t from) {
    int32_t v, i, best = 0;
    double most = -1;
    for (v = 0; v < n; v++) {
        double d = 0;
        for (i = 0; i < 3; i++) d += pow((double)xyz[3 * v + i] - (double)xyz[3 * from + i], 2);
        if (d > most) best = v;
        most = fmax(most, d);
    }
    return best;
}

/* Whether keys ascend in direction d. */
static int int_nd_in_order(const float *xyz, int32_t n, const hdi_pair *key, const double *d) {
    int32_t u, v, i, wrong = 0;
    for (u = 0; u < n; u++)
        for (v = 0; v < n; v++) {
            double x = 0;
            for (i = 0; i < 3; i++) x += d[i] * ((double)xyz[3 * v + i] - (double)xyz[3 * u + i]);
            wrong += x > 1e-9 && key[v].key <= key[u].key;
        }
    return wrong == 0;
}

/* The values of a sweep: a straight line, distances in the graph, axes. All equal, or not. */
static void int_nd_sweep_values(void) {
    enum { N = 40 };
    static float xyz[3 * N];
    static hdi_pair key[N + 1];
    static int32_t work[3 * N];
    static const double values[9] = {-DBL_MAX, -3, -2.5, -1e-300, 0, 1e-300, 2, 2.5, DBL_MAX};
    uint64_t seed = 4;
    hdi_nd_graph g = int_nd_graph(N, N, 0, &seed);       /* a path */
    int32_t kind, v, i, a, b;
    char seen[27];
    double d[3];
    hdi_nd nd;
    memset(&nd, 0, sizeof nd);
    nd.xyz = xyz;
    memset(seen, 0, sizeof seen);
    for (i = 1; i < 9; i++) CHECK(hdi_nd_key(values[i - 1]) < hdi_nd_key(values[i]));
    for (kind = 0; kind < 11; kind++) {
        for (v = 0; v < N; v++) xyz[3 * v] = xyz[3 * v + 1] = xyz[3 * v + 2] = 1;
        memset(key, 0xff, sizeof key);
        CHECK(hdi_nd_sweep_keys(&nd, &g, kind, key, work) == (kind == 1));
        for (i = 0; i < N && kind != 1; i++) {           /* one that differs */
            xyz[3 * i] = xyz[3 * i + 1] = xyz[3 * i + 2] = 2;
            if (kind >= 2) xyz[3 * i + 1] = 5;
            if (kind >= 2) xyz[3 * i + 2] = 13;
            memset(key, 0xff, sizeof key);
            CHECK(hdi_nd_sweep_keys(&nd, &g, kind, key, work) == 1);
            for (v = 0; v < N; v++) CHECK(key[v].id == v && (v == i) == (key[v].key != key[i ? 0 : 1].key));
            xyz[3 * i] = xyz[3 * i + 1] = xyz[3 * i + 2] = 1;
        }
        for (v = 0; v < N; v++)                          /* a path of points on a curve */
            for (i = 0; i < 3; i++) xyz[3 * v + i] = i == 0 ? (float)v : (float)dense_signed(&seed) * 20;
        hdi_nd_sweep_keys(&nd, &g, kind, key, work);
        if (kind == 0) {
            a = int_nd_farthest(xyz, N, 0);
            b = int_nd_farthest(xyz, N, a);
            for (i = 0; i < 3; i++) d[i] = (double)xyz[3 * b + i] - (double)xyz[3 * a + i];
            CHECK(int_nd_in_order(xyz, N, key, d));
        } else if (kind == 1) {
            i = key[1].key > key[0].key ? 1 : -1;
            for (v = 0; v < N; v++) CHECK(key[v].key == hdi_nd_key((double)i * (2 * v - (N - 1))));
        } else {
            int32_t found = 0;
            for (i = 0; i < 27; i++) {
                for (v = 0; v < 3; v++) d[v] = (v == 0 ? i : v == 1 ? i / 3 : i / 9) % 3 - 1;
                if (fabs(d[0]) + fabs(d[1]) + fabs(d[2]) > 2.5 || i == 13 || !int_nd_in_order(xyz, N, key, d)) continue;
                CHECK(!seen[i] && !seen[26 - i]);
                seen[i] = 1;
                found++;
            }
            CHECK(found == 1);                           /* each of the nine once */
        }
    }
    free(g.ptr);
}

/* The first cut of a grid, with places and without: its shorter side. Of a random graph, the best of what each way of sweeping leads to. */
static void int_nd_first_cuts(void) {
    enum { W = 40, H = 9 };
    static float xyz[3 * W * H];
    uint64_t seed = 4;
    int32_t v, way, total, t;
    hdi_nd nd;
    memset(&nd, 0, sizeof nd);
    nd.xyz = xyz;
    for (way = 0; way < 10; way++) {
        hdi_nd_graph g = int_nd_graph(way < 4 ? W * H : 60 + 20 * way, way < 4 ? W : 0, way >= 4, &seed);
        hdi_nd_space s = int_nd_space(16 * g.n + 40), rest = s;
        int32_t *work = DENSE_NEW(int32_t, 3 * g.n);
        hdi_pair *key = DENSE_NEW(hdi_pair, g.n);
        double least = DBL_MAX;
        hdi_nd_mover m;
        hdi_nd_cut c;
        for (v = 0; v < 3 * W * H; v++) xyz[v] = way < 4 ? 0 : (float)dense_signed(&seed);
        for (v = total = 0; v < g.n; v++) {
            if (way < 3) xyz[3 * v + (way + 1) % 3] = (float)(v % W);
            if (way < 3) xyz[3 * v + way] = (float)(v / W);
            if (way >= 4) g.w[v] *= way < 6 ? 1 : way < 8 ? 20 : 200;
            total += int_nd_weight(&g, v);
        }
        m = hdi_nd_mover_make(&g, &rest);
        c.most = HDI_ND_HEAVIER * total;
        for (t = 0; t < (total > HDI_ND_LARGE ? 11 : total > HDI_ND_MIDDLING ? 5 : 2); t++) {
            if (!hdi_nd_sweep_keys(&nd, &g, t, key, work)) continue;
            hdi_sort_pairs(key, g.n);
            hdi_nd_sweep(&g, key, total);
            hdi_nd_refine_edges(&m, &c, HDI_ND_PASSES);
            c.cut = int_nd_cut(&g).cut;
            least = fmin(least, hdi_nd_cost(c.cut, c.weight[0], c.weight[1]));
        }
        hdi_nd_first_cut(&nd, &g, total, s);
        c = int_nd_cut(&g);
        if (way < 4) CHECK_MSG(c.cut == H, "%g edges", c.cut);
        CHECK_MSG(fabs(c.weight[0] - c.weight[1]) <= (2 * HDI_ND_HEAVIER - 1) * total, "parts of %g and %g", c.weight[0], c.weight[1]);
        CHECK(hdi_nd_cost(c.cut, c.weight[0], c.weight[1]) == least);
        free(s.at);
        free(work);
        free(key);
        free(g.ptr);
    }
}

/* Clusters: none too heavy, each in one piece or of single vertices; and their graph, in whatever room. */
static void int_nd_clusters(void) {
    enum { GUARD = 8 };
    uint64_t seed = 9;
    int32_t way, v, p, i, j, space;
    for (way = 0; way < 12; way++) {
        hdi_nd_graph g = int_nd_graph(24 + 4 * way, way % 3 ? 0 : 5, way % 2, &seed), c;
        const int32_t n = g.n, limit = 4 + way;
        int32_t *weight = DENSE_NEW(int32_t, n), *sum = DENSE_NEW(int32_t, n * n), *work = DENSE_NEW(int32_t, 5 * n + 5), entries = 0, fitted = 0, longest = 0;
        int32_t *adj = DENSE_NEW(int32_t, g.ptr[n] + GUARD), *ew = DENSE_NEW(int32_t, g.ptr[n] + GUARD), *of = DENSE_NEW(int32_t, n), alone = 0;
        memset(&c, 0, sizeof c);
        c.n = hdi_nd_cluster(&g, limit, weight);
        CHECK(c.n > 0 && c.n < n);
        for (v = 0; v < n; v++) {
            CHECK(g.map[v] >= 0 && g.map[v] < c.n);
            of[g.map[v]] += int_nd_weight(&g, v);
            for (p = g.ptr[v], i = 0; p < g.ptr[v + 1]; p++) i += g.adj[p] >= 0 && g.map[g.adj[p]] == g.map[v];
            alone += i == 0;
        }
        for (i = 0; i < c.n; i++) CHECK(of[i] == weight[i] && of[i] > 0 && (of[i] <= limit + limit / 4 || of[i] <= 4));
        CHECK_MSG(alone <= n / 4, "%d of %d without a neighbour in their cluster", (int)alone, (int)n);
        for (v = 0; v < n; v++) {                /* who is alone found no room */
            for (p = g.ptr[v], i = j = 0; p < g.ptr[v + 1]; p++) {
                if (g.adj[p] < 0) continue;
                i += g.map[g.adj[p]] == g.map[v];
                j += of[g.map[g.adj[p]]] + int_nd_weight(&g, v) <= limit + limit / 4;
            }
            CHECK(i > 0 || j == 0);
            CHECK(g.side[v] == 0);               /* not written past the end of map */
        }
        for (v = 0; v < n; v++) {
            longest = hdi_high32(longest, g.ptr[v + 1] - g.ptr[v]);
            for (p = g.ptr[v]; p < g.ptr[v + 1]; p++)
                if (g.adj[p] >= 0 && g.map[v] != g.map[g.adj[p]]) sum[g.map[v] * n + g.map[g.adj[p]]] += g.ew ? g.ew[p] : 1;
        }
        for (i = 0; i < n * n; i++) entries += sum[i] > 0;
        c.ptr = work;
        c.id = work + n + 1;
        c.adj = adj;
        c.ew = ew;
        for (space = 1; space <= g.ptr[n]; space++) {
            int32_t wrong = 0, right = 0;
            memset(adj, 0x55, (size_t)(g.ptr[n] + GUARD) * sizeof *adj);
            memset(ew, 0x55, (size_t)(g.ptr[n] + GUARD) * sizeof *ew);
            if (hdi_nd_contract(&g, &c, space, work + 2 * n + 1, work + 3 * n + 1, work + 4 * n + 3)) {
                fitted++;
                for (i = 0; i < c.n; i++) {
                    CHECK(g.map[c.id[i]] == i);
                    for (p = c.ptr[i]; p < c.ptr[i + 1]; p++) {
                        j = c.adj[p];
                        wrong += j < 0 || j >= c.n || sum[i * n + j] != c.ew[p];
                        right++;
                    }
                }
                CHECK_MSG(wrong == 0 && right == entries && c.ptr[c.n] == entries, "%d entries, %d wrong", (int)right, (int)wrong);
            } else CHECK_MSG(space <= entries + longest, "no room in %d for %d entries", (int)space, (int)entries);
            for (i = space; i < g.ptr[n] + GUARD; i++) CHECK(adj[i] == 0x55555555 && ew[i] == 0x55555555);
        }
        CHECK(fitted > 0 && fitted < g.ptr[n]);
        free(weight);
        free(sum);
        free(work);
        free(adj);
        free(ew);
        free(of);
        free(g.ptr);
    }
}

/* reached [2 n]: the states of a band, its vertices' ins (2 v) and outs (2 v + 1), that a search from `begin` comes to beside the paths in flow [2 n 2 n];
 * up [2 n] the state before each. Returns the out at which one more path leaves the band, or -1. */
static int32_t int_nd_residual(const hdi_nd_graph *g, const char *band, const char *begin, const char *end, const char *flow, char *reached, int32_t *up) {
    const int32_t n = g->n;
    int32_t *stack = DENSE_NEW(int32_t, 2 * n), top = 0, v, p, found = -1;
    memset(reached, 0, 2 * (size_t)n);
    for (v = 0; v < n; v++) {
        if (!begin[v]) continue;
        reached[2 * v] = 1;
        up[2 * v] = -1;
        stack[top++] = 2 * v;
    }
    while (top > 0 && found < 0) {
        const int32_t x = stack[--top], out = x % 2;
        v = x / 2;
        if (out && end[v]) found = x;
        for (p = g->ptr[v] - 1; p < g->ptr[v + 1]; p++) {                /* first within v, then to its neighbours */
            const int32_t u = p < g->ptr[v] ? v : g->adj[p], y = u == v ? x + 1 - 2 * out : 2 * u + 1 - out;
            if (u < 0 || !band[u] || reached[y]) continue;
            if (u == v && flow[2 * v * 2 * n + 2 * v + 1] != out) continue;
            if (u != v && !out && !flow[y * 2 * n + x]) continue;
            reached[y] = 1;
            up[y] = x;
            stack[top++] = y;
        }
    }
    free(stack);
    return found;
}

/* Vertices without edges fill clusters one after the other. */
static void int_nd_alone(void) {
    enum { N = 23, LIMIT = 5 };
    int32_t ptr[N + 1], adj[1] = {0}, map[N], weight[N], key[N + 1], list[N + 2], start[6], v, i, first;
    hdi_nd_graph g;
    memset(ptr, 0, sizeof ptr);
    memset(&g, 0, sizeof g);
    g.n = N;
    g.ptr = ptr;
    g.adj = adj;
    g.map = map;
    CHECK(hdi_nd_cluster(&g, LIMIT, weight) == 5);
    for (v = 0; v < N; v++) CHECK(map[v] == v / LIMIT && weight[v / LIMIT] == (v < 20 ? 5 : 3));
    for (v = 0; v < N; v++) key[v] = v % 7 - 2;  /* groups, some in none */
    key[N] = 3;
    list[N + 1] = -7;
    memset(start, 0xff, sizeof start);
    hdi_group(key, N, 5, start, list);
    for (i = first = 0; i < 5; i++) {
        CHECK(start[i] == first);
        for (v = 0; v < N; v++)
            if (key[v] == i) CHECK(list[first++] == v);
    }
    CHECK(start[5] == first);
    for (v = 0; v < 5; v++) weight[v] = v + 1;
    CHECK(hdi_nd_sums(weight, 4) == 10 && weight[4] == 5);
    for (v = 0; v < 4; v++) CHECK(weight[v] == v * (v + 1) / 2);
}

/* Halves of at most four fifths and a separator of at most half; sides by number. */
static void int_nd_by_number(void) {
    uint64_t seed = 21;
    int32_t way, v, p, q, sizes[3];
    int8_t side[21];
    hdi_nd_graph all;
    memset(&all, 0, sizeof all);
    all.n = 20;
    all.side = side;
    for (p = 0; p <= 20; p++)
        for (q = 0; p + q <= 20; q++) {
            for (v = 0; v < 20; v++) side[v] = (int8_t)(v < p ? 0 : v < p + q ? 1 : 2);
            CHECK(hdi_nd_measure(&all, sizes) == (p <= 16 && q <= 16 && 20 - p - q <= 10));
            CHECK(sizes[0] == p && sizes[1] == q && sizes[2] == 20 - p - q);
        }
    for (way = 0; way < 6; way++) {
        hdi_nd_graph g = int_nd_graph(20 + 7 * way, way % 2 ? 0 : 5, 0, &seed);
        int32_t cut = 0, size[3];
        memset(g.side, 7, (size_t)g.n);
        hdi_nd_halve(&g);
        for (v = 0; v < g.n; v++) {
            int touches = 0;
            for (p = g.ptr[v]; p < g.ptr[v + 1]; p++) touches |= g.adj[p] >= g.n / 2;
            CHECK(g.side[v] == (v >= g.n / 2 ? 1 : touches ? 2 : 0));
            cut += v < g.n / 2 && touches;
        }
        CHECK(hdi_nd_measure(&g, size) == (g.n / 2 - cut <= g.n - g.n / 5 && cut <= g.n / 2));
        CHECK(size[0] == g.n / 2 - cut && size[1] == g.n - g.n / 2 && size[2] == cut);
        free(g.ptr);
    }
}

/* Copies and copies of copies: each has at most two thirds of the vertices, light ones, and the edges between their clusters. */
static void int_nd_copies(void) {
    uint64_t seed = 19;
    int32_t way, l, v, p, q;
    for (way = 0; way < 6; way++) {
        hdi_nd_graph level[12];
        const int32_t n = 500;
        int32_t *sum = DENSE_NEW(int32_t, n * n), *in = DENSE_NEW(int32_t, n), most = 0;
        hdi_nd_space s = int_nd_space(20 * n + 400), rest = s;
        hdi_nd_room room;
        memset(level, 0, sizeof level);
        level[0] = int_nd_graph(n, way % 2 ? 0 : 20, 0, &seed);
        room.n = level->ptr[n];
        room.adj = DENSE_NEW(int32_t, room.n);
        room.ew = DENSE_NEW(int32_t, room.n);
        q = room.n;
        for (l = 0; l < 10 && hdi_nd_coarser(level + l, n, &room, &rest); l++) q -= level[l + 1].ptr[level[l + 1].n];
        CHECK(l >= 2 && q == room.n);
        for (v = 0; v < n; v++) in[v] = v;
        for (v = 0; v < level[l].n; v++) level[l].side[v] = (int8_t)(v % 2);    /* a bad cut, which each copy improves */
        hdi_nd_descend(level, l, n, rest);
        for (v = 1; v < l; v++) {
            const hdi_nd_graph *g = level + v;
            const hdi_nd_cut kept = int_nd_cut(g);
            double above = 0;
            for (p = 0; p < g->n; p++) g->side[p] = g[1].side[g->map[p]];
            above = int_nd_cut(g).cut;
            CHECK(kept.cut < above || v + 1 < l);
            CHECK_MSG(kept.cut <= above && hdi_max(kept.weight[0], kept.weight[1]) <= HDI_ND_HEAVIER * n, "a cut of %g, %g on the copy", kept.cut, above);
        }
        for (v = 0; v < l; v++) {
            const hdi_nd_graph *g = level + v, *c = g + 1;
            int32_t i, total = 0, entries = 0, wrong = 0;
            const int32_t mean = n / g->n, limit = 8 * mean < n / HDI_ND_CLUSTERS ? 8 * mean : n / HDI_ND_CLUSTERS;
            most = 0;
            for (i = 0; i < n; i++) in[i] = g->map[in[i]];
            memset(sum, 0, (size_t)n * (size_t)n * sizeof *sum);
            CHECK(c->n <= g->n - g->n / 3);
            for (i = 0; i < g->n; i++) {
                sum[g->map[i] * n + g->map[i]] += int_nd_weight(g, i);
                for (p = g->ptr[i]; p < g->ptr[i + 1]; p++)
                    if (g->adj[p] >= 0 && g->map[g->adj[p]] != g->map[i]) sum[g->map[i] * n + g->map[g->adj[p]]] += g->ew ? g->ew[p] : 1;
            }
            for (i = 0; i < n * n; i++) entries += sum[i] > 0;
            for (i = 0; i < c->n; i++) {
                total += c->w[i];
                most = hdi_high32(most, c->w[i]);
                wrong += c->w[i] != sum[i * n + i] || in[c->id[i]] != i;
                for (p = c->ptr[i]; p < c->ptr[i + 1]; p++) wrong += c->adj[p] == i || c->ew[p] != sum[i * n + c->adj[p]];
            }
            CHECK_MSG(total == n && wrong == 0 && entries == c->n + c->ptr[c->n] && most <= limit + limit / 4, "copy %d: %d wrong, the heaviest %d", (int)v,
                      (int)wrong, (int)most);
        }
        free(sum);
        free(in);
        free(room.adj - (level->ptr[n] - room.n));
        free(room.ew - (level->ptr[n] - room.n));
        free(s.at);
        free(level->ptr);
    }
}

/* The sides of a band that the smallest separator leaves, the one nearest to side from: by paths found one by one, and what they leave open. */
static int32_t int_nd_smallest(const hdi_nd_graph *g, const char *band, int8_t from, int8_t *side) {
    const int32_t n = g->n;
    char *begin = DENSE_NEW(char, n), *end = DENSE_NEW(char, n), *flow = DENSE_NEW(char, 4 * n * n), *reached = DENSE_NEW(char, 2 * n);
    int32_t *up = DENSE_NEW(int32_t, 2 * n), v, p, paths = 0;
    for (v = 0; v < n; v++)
        for (p = g->ptr[v]; band[v] && p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p];
            if (u >= 0 && !band[u] && g->side[u] == from) begin[v] = 1;
            if (u >= 0 && !band[u] && g->side[u] != from) end[v] = 1;
        }
    while ((v = int_nd_residual(g, band, begin, end, flow, reached, up)) >= 0) {
        for (; up[v] >= 0; v = up[v]) {
            char *back = flow + v * 2 * n + up[v];
            if (*back) *back = 0;
            else flow[up[v] * 2 * n + v] = 1;
        }
        paths++;
    }
    for (v = 0; v < n; v++)
        if (band[v]) side[v] = (int8_t)(reached[2 * v + 1] ? from : reached[2 * v] ? 2 : 1 - from);
    free(begin);
    free(end);
    free(flow);
    free(reached);
    free(up);
    return paths;
}

static void int_nd_flow_of(const hdi_nd_graph *g, int32_t most, int32_t layers) {
    const int32_t n = g->n;
    hdi_nd_space s = int_nd_space(13 * n + 20), rest = s;
    int32_t *far_off = DENSE_NEW(int32_t, n), v, p, i, n_list = 0, size[3], wrong = 0, inside[3] = {0, 0, 0}, cut = 0;
    int8_t *before = (int8_t *)DENSE_NEW(char, n), *want = (int8_t *)DENSE_NEW(char, n);
    char *band = DENSE_NEW(char, n);
    hdi_nd_flow f;
    memcpy(before, g->side, (size_t)n);
    memset(&f, 0, sizeof f);
    f.g = g;
    f.band = hdi_nd_take(&rest, 2 * n);
    f.prev = hdi_nd_take(&rest, n);
    f.seen = hdi_nd_take(&rest, 2 * n);
    f.up = hdi_nd_take(&rest, 2 * n);
    f.link = hdi_nd_take(&rest, 2 * n);
    f.log = hdi_nd_take(&rest, 2 * n);
    f.inside = hdi_nd_take_bytes(&rest, n);
    hdi_nd_measure(g, size);
    f.from = size[1] > size[0];
    for (v = 0; v < n; v++) {
        far_off[v] = hdi_nd_touches(g, v) && g->side[v] == 0 ? 0 : n;
        if (far_off[v] == 0) f.band[n_list++] = v;
    }
    for (i = 0; i < layers; i++)
        for (v = 0; v < n; v++)
            for (p = g->ptr[v]; far_off[v] == i && p < g->ptr[v + 1]; p++)
                if (g->adj[p] >= 0 && far_off[g->adj[p]] > i) far_off[g->adj[p]] = i + 1;
    hdi_nd_flow_run(&f, n_list, most, layers);
    for (v = 0; v < n; v++) {
        band[v] = f.inside[v] != 0;
        want[v] = before[v];
        inside[far_off[v] == 0 ? 2 : before[v]] += band[v];
        if (most >= n) wrong += band[v] != (far_off[v] <= layers);
        else wrong += band[v] && far_off[v] > layers;
    }
    CHECK_MSG(wrong == 0 && inside[0] <= most && inside[1] <= most && inside[2] == n_list, "%d vertices in or out of the band", (int)wrong);
    {
        hdi_nd_graph old = *g;
        old.side = before;
        i = int_nd_smallest(&old, band, f.from, want);
    }
    for (v = 0; v < n; v++) {
        cut += g->side[v] == 2;
        wrong += g->side[v] != want[v];
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) wrong += g->adj[p] >= 0 && g->side[v] + g->side[g->adj[p]] == 1;
    }
    CHECK_MSG(wrong == 0 && cut == i && cut <= n_list, "a separator of %d vertices, not %d; %d on a wrong side", (int)cut, (int)i, (int)wrong);
    free(s.at);
    free(far_off);
    free(before);
    free(want);
    free(band);
}

/* The separator in a band is the smallest there is, and of these the nearest to the lighter side, by another search for paths. */
static void int_nd_flows(void) {
    uint64_t seed = 12;
    int32_t way, v;
    for (way = 0; way < 160; way++) {
        const int32_t wide = way % 2 ? 4 + way % 9 : 0;
        hdi_nd_graph g = int_nd_graph(40 + way / 2, wide, 0, &seed);
        for (v = 0; v < g.n; v++) {
            const int32_t x = wide ? v / wide : v / 5, m = wide ? g.n / wide : g.n / 5;
            g.side[v] = (int8_t)(2 * x + (int32_t)(dense_random(&seed) % 5) > m + way % 3);
        }
        int_nd_flow_of(&g, way % 3 ? g.n : 2 + way / 4, 1 + way % HDI_ND_LAYERS);
        free(g.ptr);
    }
}

/* Keys along the Morton curve bit by bit, and the rows in their order. */
static void int_nd_curve(void) {
    enum { N = 500 };
    static double xyz[3 * N];
    static uint32_t key[N];
    static float unit[3 * N];
    static int32_t order[N + 1], spare[N + 1], count[1025];
    uint64_t seed = 2;
    int32_t i, d, b, wrong = 0;
    double lo[3] = {1e9, 1e9, 1e9}, width = 0;
    for (i = 0; i < 3 * N; i++) xyz[i] = (i % 3 + 1) * dense_signed(&seed) + 10;
    for (i = 0; i < 30; i++) memcpy(xyz + 3 * (N - 30 + i), xyz + 3 * (7 * i), 3 * sizeof *xyz);      /* equal keys */
    for (i = 0; i < 3 * N; i++) lo[i % 3] = fmin(lo[i % 3], xyz[i]);
    for (i = 0; i < 3 * N; i++) width = fmax(width, xyz[i] - lo[i % 3]);
    memset(key, 0xff, sizeof key);
    hdi_nd_keys(xyz, N, key, unit);
    for (i = 0; i < N; i++) {
        uint32_t want = 0;
        for (d = 0; d < 3; d++) {
            const double u = (0.5 * xyz[3 * i + d] - 0.5 * lo[d]) / (0.5 * width);
            wrong += fabs((double)unit[3 * i + d] - u) > 1e-6;
            for (b = 0; b < 10; b++) want |= ((uint32_t)(u * 1023) >> b & 1u) << (3 * b + d);
        }
        wrong += key[i] != want;
    }
    CHECK_MSG(wrong == 0, "%d keys or places", (int)wrong);
    order[N] = spare[N] = count[1024] = -7;
    hdi_nd_sort(key, N, order, spare, count);
    CHECK(order[N] == -7 && spare[N] == -7 && count[1024] == -7);
    for (i = 1; i < N; i++) CHECK(key[order[i - 1]] < key[order[i]] || (key[order[i - 1]] == key[order[i]] && order[i - 1] < order[i]));
    for (i = 0; i < 6; i++) xyz[i] = 2.5;        /* all at one point */
    hdi_nd_keys(xyz, 2, key, unit);
    CHECK(key[0] == 0 && key[1] == 0);
    for (i = 0; i < 6; i++) CHECK(unit[i] == 0.0f);
}

/* Clusters with vertices on one side, as they were, in whatever room. */
static void int_nd_halves_of_clusters(void) {
    enum { GUARD = 4 };
    uint64_t seed = 15;
    int32_t way, v, p, i, side, space;
    for (way = 0; way < 6; way++) {
        hdi_nd_graph g[2], half[2];
        const int32_t n = 40 + 10 * way, most = 12 * n;
        hdi_nd_space s = int_nd_space(2 * n + 9);
        int32_t *work = DENSE_NEW(int32_t, 9 * n + 9), *room = DENSE_NEW(int32_t, 2 * most), *adj = DENSE_NEW(int32_t, most + GUARD);
        int32_t *ew = DENSE_NEW(int32_t, most + GUARD), *number = DENSE_NEW(int32_t, n), *want = DENSE_NEW(int32_t, n), fitted = 0;
        g[0] = int_nd_graph(n, way % 2 ? 0 : 8, way % 3 == 0, &seed);
        memset(g + 1, 0, sizeof *g);
        memset(half, 0, sizeof half);
        g[1].n = hdi_nd_cluster(g, 6, work);
        g[1].ptr = work + n;
        g[1].id = work + 2 * n + 1;
        g[1].adj = room;
        g[1].ew = room + most;
        CHECK(hdi_nd_contract(g, g + 1, most, work + 3 * n + 1, work + 4 * n + 1, work + 5 * n + 2));
        for (v = 0; v < n; v++) g->side[v] = (int8_t)(v < n / 2 - 2 ? 0 : v > n / 2 + 2 ? 1 : 2);
        half[0].map = work + 6 * n + 2;
        half[1].ptr = work + 7 * n + 2;
        half[1].id = work + 8 * n + 3;
        half[1].adj = adj;
        half[1].ew = ew;
        for (side = 0; side < 2; side++) {
            int32_t count = 0, entries = 0, longest = 0;
            memset(number, 0, (size_t)n * sizeof *number);
            for (v = 0; v < n; v++)
                if (g->side[v] == side) number[g->map[v]] = 1;
            for (i = 0; i < g[1].n; i++) {
                count += number[i];
                if (number[i]) longest = hdi_high32(longest, g[1].ptr[i + 1] - g[1].ptr[i]);
                for (p = g[1].ptr[i]; p < g[1].ptr[i + 1]; p++) entries += number[i] && number[g[1].adj[p]];
            }
            for (space = 1; space < most; space += space < g[1].ptr[g[1].n] + 2 ? 1 : 50) {
                int32_t found, wrong = 0;
                memset(adj, 0x55, (size_t)(most + GUARD) * sizeof *adj);
                memset(ew, 0x55, (size_t)(most + GUARD) * sizeof *ew);
                found = hdi_nd_extract_clusters(g, (int8_t)side, half, space, s);
                for (i = space; i < most + GUARD; i++) wrong += adj[i] != 0x55555555 || ew[i] != 0x55555555;
                CHECK(wrong == 0 && (found == count || (found == 0 && space <= entries + longest)));
                if (found == 0) continue;
                fitted++;
                for (v = i = 0; v < n; v++) {
                    if (g->side[v] != side) continue;
                    want[g->map[v]] = half[0].map[i++];
                    CHECK(want[g->map[v]] >= 0 && want[g->map[v]] < count);
                    wrong += half[1].id[want[g->map[v]]] != g[1].id[g->map[v]];
                }
                for (v = i = 0; v < n; v++) wrong += g->side[v] == side && half[0].map[i++] != want[g->map[v]];
                for (i = 0; i < g[1].n; i++) {
                    if (!number[i]) continue;
                    for (p = g[1].ptr[i], v = half[1].ptr[want[i]]; p < g[1].ptr[i + 1]; p++) {
                        if (!number[g[1].adj[p]]) continue;
                        wrong += half[1].adj[v] != want[g[1].adj[p]] || half[1].ew[v] != g[1].ew[p];
                        v++;
                    }
                    wrong += v != half[1].ptr[want[i] + 1];
                }
                CHECK_MSG(wrong == 0 && half[1].ptr[count] == entries, "%d entries or names", (int)wrong);
            }
        }
        CHECK(fitted > 0);
        free(g->ptr);
        free(s.at);
        free(work);
        free(room);
        free(adj);
        free(ew);
        free(number);
        free(want);
    }
}

/* A dissection step by step: what hdi_nd_order sets up, and where each row is: its part, or -1 - the part that it separates. */
typedef struct int_nd_steps { hdi_nd nd; const hd_csr *a; int32_t *order, *inv, *where, *perm; hdi_scope s; hd_context ctx; hd_error e; } int_nd_steps;

static void int_nd_begin(int_nd_steps *x, const hd_csr *a, const double *xyz) {
    const uint64_t n = (uint64_t)a->n_rows;
    hdi_nd_load_job job;
    uint32_t *key;
    int32_t *count;
    float *unit;
    memset(x, 0, sizeof *x);
    x->s = hdi_scope_begin(&x->ctx, &x->e);
    x->a = a;
    x->order = HDI_TAKE(&x->s, int32_t, n + 1);
    x->inv = HDI_TAKE(&x->s, int32_t, n + 1);
    x->where = HDI_TAKE(&x->s, int32_t, n + 1);
    x->perm = HDI_TAKE(&x->s, int32_t, n + 1);
    count = HDI_TAKE(&x->s, int32_t, 1024 + 2 * n / HDI_ND_BLOCK);
    key = HDI_TAKE(&x->s, uint32_t, n + 1);
    unit = HDI_TAKE(&x->s, float, 3 * n + 1);
    x->nd.perm = x->perm;
    x->nd.xyz = HDI_TAKE(&x->s, float, 3 * n + 1);
    x->nd.work = HDI_TAKE(&x->s, int32_t, hdi_nd_words(a->n_rows, (int32_t)a->nnz, HDI_ND_TASKS));
    x->nd.part = HDI_TAKE(&x->s, hdi_nd_part, HDI_ND_NODES);
    hdi_nd_buffer_make(x->nd.buffer, a, &x->s);
    hdi_nd_buffer_make(x->nd.buffer + 1, a, &x->s);
    CHECK(x->e.status == HD_OK);
    memset(x->where, 0, n * sizeof *x->where);
    hdi_nd_keys(xyz, a->n_rows, key, unit);
    job.nd = &x->nd;
    job.a = a;
    job.order = x->order;
    job.inv = x->inv;
    job.unit = unit;
    job.n = hdi_nd_number(a, key, x->order, x->inv, count);
    CHECK(job.n == a->n_rows);
    x->nd.part[0] = hdi_nd_load(&job, count, &x->ctx);
}

/* The graph of a part is that of the matrix, and its clusters have a graph with weights. */
static void int_nd_part_right(const int_nd_steps *x, int32_t i) {
    const hdi_nd_part *part = x->nd.part + i;
    const hd_csr *a = x->a;
    hdi_nd_graph g[2];
    int32_t v, p, q, wrong = 0, *mark = DENSE_NEW(int32_t, a->n_rows + 1), z = 0;
    hdi_nd_graphs_of(&x->nd, part, g);
    for (v = 0; v < part->n; v++) wrong += x->where[g->id[v]] != i;
    for (v = 0; v < part->n; v++) {
        const int32_t r = x->order[g->id[v]];
        int64_t k;
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p], row = u < 0 ? ~u : g->id[u];
            mark[row] = v + 1;
            wrong += u >= part->n || (u < 0 && x->where[row] >= 0);
        }
        for (k = a->row_ptr[r]; k < a->row_ptr[r + 1]; k++) wrong += a->col[k] != r && mark[x->inv[a->col[k]]] != v + 1;
        z += g->ptr[v + 1] - g->ptr[v];
        wrong += g->ptr[v + 1] - g->ptr[v] != a->row_ptr[r + 1] - a->row_ptr[r] - 1;
    }
    CHECK_MSG(wrong == 0 && z == part->n_edges, "%d rows or entries of part %d", (int)wrong, (int)i);
    for (v = 0; v < part->n && part->clusters > 0; v++) wrong += g->map[v] < 0 || g->map[v] >= part->clusters;
    for (v = 0; v < part->clusters; v++)
        for (p = g[1].ptr[v]; p < g[1].ptr[v + 1]; p++) {
            const int32_t u = g[1].adj[p];
            int32_t back = 0;
            for (q = g[1].ptr[u]; q < g[1].ptr[u + 1]; q++) back += g[1].adj[q] == v ? g[1].ew[q] : 0;
            wrong += u < 0 || u == v || g[1].ew[p] <= 0 || back != g[1].ew[p];
        }
    CHECK_MSG(wrong == 0, "%d clusters or their edges of part %d", (int)wrong, (int)i);
    free(mark);
}

/* A part that was not halved: minimum degree of its rows, with the separators around as neighbours. copy: the part before. */
static void int_nd_leaf_right(const int_nd_steps *x, int32_t i, const hdi_nd_graph *copy) {
    const hdi_nd_part *part = x->nd.part + i;
    int32_t *mark = DENSE_NEW(int32_t, x->a->n_rows + 1), *perm = DENSE_NEW(int32_t, part->n), *work, p, v, wrong = 0;
    hdi_amd_graph rows;
    rows.n = rows.inner = part->n;
    rows.wide = NULL;
    rows.ptr = copy->ptr;
    rows.col = copy->adj;
    for (p = 0; p < part->n_edges; p++) {
        const int32_t row = ~copy->adj[p];
        if (row < 0) continue;
        if (!mark[row]) mark[row] = ++rows.n;    /* number and 1 */
        copy->adj[p] = mark[row] - 1;
    }
    work = DENSE_NEW(int32_t, hdi_amd_part_words(part->n, rows.n - part->n, part->n_edges));
    hdi_amd_part(&rows, perm, work);
    for (v = 0; v < part->n; v++) wrong += x->perm[part->first + v] != copy->id[perm[v]];
    CHECK_MSG(wrong == 0, "%d of %d rows of part %d are in another order", (int)wrong, (int)part->n, (int)i);
    free(mark);
    free(perm);
    free(work);
}

/* Two halves and a separator, which are all rows of the part; no edge joins the halves, and both have a fifth. Returns the rows of the separator. */
static int32_t int_nd_split_right(int_nd_steps *x, int32_t i) {
    const hdi_nd_part *part = x->nd.part + i, *child = part + i + 1;
    const int32_t cut = part->n - child[0].n - child[1].n;
    int32_t v, k, wrong = 0;
    int64_t p;
    CHECK(child[0].first == part->first && child[1].first == part->first + child[0].n);
    CHECK_MSG(cut <= part->n / 2 && child[0].n <= part->n - part->n / 5 && child[1].n <= part->n - part->n / 5, "%d, %d of %d", (int)child[0].n,
              (int)child[1].n, (int)part->n);
    for (k = 0; k < 2; k++)
        for (v = 0; v < child[k].n; v++) {
            int32_t *where = x->where + x->nd.buffer[child[k].buffer].id[child[k].first + v];
            wrong += *where != i;
            *where = 2 * i + 1 + k;
        }
    for (v = part->first + part->n - cut; v < part->first + part->n; v++) {
        wrong += x->where[x->perm[v]] != i;
        x->where[x->perm[v]] = -1 - i;
    }
    for (v = 0; v < x->a->n_rows; v++)
        for (p = x->a->row_ptr[v]; x->where[x->inv[v]] == 2 * i + 1 && p < x->a->row_ptr[v + 1]; p++)
            wrong += x->where[x->inv[x->a->col[p]]] == 2 * i + 2;
    CHECK_MSG(wrong == 0, "%d rows or edges in part %d", (int)wrong, (int)i);
    return cut;
}

/* A copy of a part's rows. */
static hdi_nd_graph int_nd_copy(const int_nd_steps *x, int32_t i) {
    const hdi_nd_part *part = x->nd.part + i;
    hdi_nd_graph g, c;
    hdi_nd_graph level[2];
    hdi_nd_graphs_of(&x->nd, part, level);
    g = level[0];
    c = g;
    c.ptr = DENSE_NEW(int32_t, 2 * part->n + 1 + part->n_edges);
    c.id = c.ptr + part->n + 1;
    c.adj = c.id + part->n;
    memcpy(c.ptr, g.ptr, ((size_t)part->n + 1) * sizeof *c.ptr);
    memcpy(c.id, g.id, (size_t)part->n * sizeof *c.ptr);
    memcpy(c.adj, g.adj, (size_t)part->n_edges * sizeof *c.ptr);
    return c;
}

/* Of the sides that the whole is cut into, the vertices of one that touch the other: all, and of the side where they are fewer. */
static void int_nd_list_right(const int_nd_steps *x) {
    const hdi_nd_part *part = x->nd.part;
    hdi_nd_space s = hdi_nd_space_of(&x->nd, 0);
    hdi_nd_graph level[HDI_ND_LEVELS];
    int32_t *list = DENSE_NEW(int32_t, 2 * part->n), n, v, touch[2] = {0, 0}, wrong = 0, size[3];
    hdi_nd_graphs_of(&x->nd, part, level);
    level->side = hdi_nd_take_bytes(&s, part->n);
    n = hdi_nd_cut_clusters(&x->nd, part, level, list, s);
    for (v = 0; v < part->n; v++) touch[level->side[v]] += hdi_nd_touches(level, v);
    CHECK_MSG(n == hdi_low32(touch[0], touch[1]), "%d of %d and %d", (int)n, (int)touch[0], (int)touch[1]);
    for (v = 0; v < n; v++) wrong += !hdi_nd_touches(level, list[v]) || level->side[list[v]] != level->side[list[0]] || (v > 0 && list[v] <= list[v - 1]);
    CHECK(wrong == 0);
    CHECK(hdi_nd_measure(level, size) && size[0] <= HDI_ND_HEAVIER * part->n + 1 && size[1] <= HDI_ND_HEAVIER * part->n + 1);
    free(list);
}

/* A grid of w by h, wide = 1: with diagonals of its cells, 2: with edges from some vertices to far ones. */
static hd_csr int_nd_grid(int32_t w, int32_t h, int wide, double *xyz) {
    const int32_t n = w * h;
    int32_t *i = DENSE_NEW(int32_t, 11 * n), *j = DENSE_NEW(int32_t, 11 * n), v, k;
    double *one = DENSE_NEW(double, 11 * n);
    int64_t z = 0;
    hd_csr a;
    hd_error e = int_no_error();
    for (v = 0; v < n; v++) {
        xyz[3 * v] = v % w;
        xyz[3 * v + 1] = v / w;
        xyz[3 * v + 2] = 0;
        for (k = 0; k < 9; k++) {
            const int32_t x = v % w + k % 3 - 1, y = v / w + k / 3 - 1;
            if (x < 0 || x >= w || y < 0 || y >= h || (wide != 1 && k % 2 == 0 && k != 4)) continue;
            i[z] = v;
            j[z] = y * w + x;
            one[z++] = 1;
        }
        for (k = 0; k < 2 && wide == 2 && v % 11 == 0; k++) {
            i[z] = k ? v : v * 7 % n;
            j[z] = k ? v * 7 % n : v;
            one[z++] = 1;
        }
    }
    CHECK(hd_csr_from_triplets(&a, n, n, z, i, j, one, NULL, &e) == HD_OK);
    free(i);
    free(j);
    free(one);
    return a;
}

/* Fresh clusters: about a dozen vertices each, and their graph. */
static void int_nd_fresh_right(const int_nd_steps *x) {
    const hdi_nd_part *part = x->nd.part;
    hdi_nd_graph level[2];
    int32_t v, p, q, wrong = 0, entries = 0, *sum;
    hdi_nd_graphs_of(&x->nd, part, level);
    hdi_nd_fresh(&x->nd, part, level, hdi_nd_space_of(&x->nd, 0));
    CHECK_MSG(6 * level[1].n < part->n && 24 * level[1].n > part->n, "%d clusters of %d", (int)level[1].n, (int)part->n);
    sum = DENSE_NEW(int32_t, level[1].n * level[1].n);
    for (v = 0; v < part->n; v++) {
        wrong += level->map[v] < 0 || level->map[v] >= level[1].n;
        for (p = level->ptr[v]; p < level->ptr[v + 1] && wrong == 0; p++) {
            int32_t *at = sum + level->map[v] * level[1].n + level->map[level->adj[p]];
            if (level->map[v] == level->map[level->adj[p]]) continue;
            entries += *at == 0;
            ++*at;
        }
    }
    for (v = 0; v < level[1].n && wrong == 0; v++) {
        for (p = level[1].ptr[v]; p < level[1].ptr[v + 1]; p++) wrong += level[1].ew[p] != sum[v * level[1].n + level[1].adj[p]];
        for (q = 0; q < part->n && (level->id[q] != level[1].id[v] || level->map[q] != v); q++) {}
        wrong += q == part->n;                   /* a row of its own stands for it */
    }
    CHECK_MSG(wrong == 0 && level[1].ptr[level[1].n] == entries, "%d entries or rows", (int)wrong);
    free(sum);
}

/* Grids halved step by step. No separator of a rectangle needs more rows than its shorter side has. */
static void int_nd_halvings(void) {
    static const int32_t size[5][3] = {{80, 80, 0}, {72, 72, 1}, {40, 150, 0}, {20, 260, 1}, {45, 60, 2}};
    int32_t way, i;
    for (way = 0; way < 5; way++) {
        const int32_t w = size[way][0], h = size[way][1];
        double *xyz = DENSE_NEW(double, 3 * w * h);
        hd_csr a = int_nd_grid(w, h, size[way][2], xyz);
        int32_t cut = 0, halved = 0;
        int_nd_steps x;
        int_nd_begin(&x, &a, xyz);
        int_nd_list_right(&x);
        int_nd_fresh_right(&x);
        for (i = 0; i < HDI_ND_TASKS - 1; i++) {
            const hdi_nd_part *part = x.nd.part + i;
            hdi_nd_graph copy;
            int_nd_part_right(&x, i);
            copy = int_nd_copy(&x, i);
            hdi_nd_split(&x.nd, part, x.nd.part + 2 * i + 1, hdi_nd_space_of(&x.nd, i));
            CHECK((part->n > HDI_ND_LEAF) == (part[i + 1].n > 0));
            if (part[i + 1].n > 0) {
                const int32_t k = int_nd_split_right(&x, i);
                if (i == 0) cut = k;
                halved++;
            } else if (part->n > 0) int_nd_leaf_right(&x, i, &copy);
            free(copy.ptr);
        }
        CHECK_MSG(way == 4 || (cut <= w && halved >= 3), "a separator of %d rows", (int)cut);
        hdi_scope_end(&x.s);
        hd_csr_free(&a, NULL);
        free(xyz);
    }
}

/* Fill and work of k by k grids with diagonals. Dissection by their middle lines: 31/4 k^2 log2 k non-zeros and 829/84 k^3 operations, a multiplication
 * and an addition each, to leading order (A. George, J. Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 8). The
 * next terms are negative for the first. Minimum degree does about as well; without diagonals both have less. */
static void int_nd_fill(void) {
    int32_t k, wide, way;
    for (k = 45; k <= 90; k += 45) {
        for (wide = 0; wide < 2; wide++) {
            double *xyz = DENSE_NEW(double, 3 * k * k), flops[2] = {0, 0};
            hd_csr a = int_nd_grid(k, k, wide, xyz);
            int32_t *perm = DENSE_NEW(int32_t, k * k);
            for (way = 0; way < 2; way++) {
                hdi_symbolic s;
                hd_context ctx;
                hd_error e = int_no_error();
                memset(&ctx, 0, sizeof ctx);
                CHECK((way ? hdi_nd_order(&a, xyz, perm, &ctx, &e) : hdi_amd_order(&a, perm, &ctx, &e)) == HD_OK);
                CHECK(hdi_symbolic_make(&s, &a, perm, &ctx, &e) == HD_OK);
                flops[way] = s.flops / pow(k, 3);
                CHECK_MSG((double)s.nnz < 0.7 * 31 / 4 * k * k * log2(k) && flops[way] < 1.1 * 2 * 829 / 84, "%d by %d: %g non-zeros a row, %g k^3 flops", (int)k,
                          (int)k, (double)s.nnz / k / k, flops[way]);
                hdi_symbolic_free(&ctx, &s);
            }
            CHECK_MSG(flops[0] < 1.2 * flops[1] && flops[1] < 1.2 * flops[0], "%g and %g k^3 flops", flops[0], flops[1]);
            hd_csr_free(&a, NULL);
            free(xyz);
            free(perm);
        }
    }
}

/* The share of the way from the first residual to the target, by powers of ten. */
static void int_krylov_done(void) {
    CHECK(fabs(hdi_krylov_done(1e3, 1e1, 1e-5) - 0.25) < 1e-15 && fabs(hdi_krylov_done(1e-2, 1e-8, 1e-10) - 0.75) < 1e-15);
    CHECK(hdi_krylov_done(5, 5, 1e-3) == 0 && hdi_krylov_done(5, 1e-3, 1e-3) == 1 && hdi_krylov_done(1e-3, 1e-3, 1e-2) == 1 && hdi_krylov_done(5, 1, 0) == 0);
}

/* The order by its definition: each vertex follows its first neighbour in the order, and those that follow the same one stand by degree.
 * Returns how often that does not hold. a is connected, or its components come one after the other. */
static int32_t int_not_cuthill_mckee(const hd_csr *a, const int32_t *perm) {
    int32_t *at = DENSE_NEW(int32_t, a->n_rows), *parent = DENSE_NEW(int32_t, a->n_rows), i, wrong = 0;
    int64_t p;
    for (i = 0; i < a->n_rows; i++) at[perm[i]] = i;
    for (i = 0; i < a->n_rows; i++) {
        parent[i] = i;
        for (p = a->row_ptr[perm[i]]; p < a->row_ptr[perm[i] + 1]; p++)
            if (at[a->col[p]] < parent[i]) parent[i] = at[a->col[p]];
        if (i == 0 || parent[i] == i) continue;
        wrong += parent[i] < parent[i - 1];
        wrong += parent[i] == parent[i - 1] && a->row_ptr[perm[i] + 1] - a->row_ptr[perm[i]] < a->row_ptr[perm[i - 1] + 1] - a->row_ptr[perm[i - 1]];
    }
    free(at);
    free(parent);
    return wrong;
}

static void int_cuthill_mckee(void) {
    shape s = shape_grid(40, 8, 0.2), two = shape_grid(5, 5, 0), both;
    const double offset[3] = {2, 0, 0};
    hd_laplacian *lap = NULL;
    hd_csr shuffled;
    hd_context ctx;
    hd_error e = int_no_error();
    uint64_t seed = 3;
    int32_t *perm, *seen, i, missing = 0;
    both = shape_disjoint(&s, &two, offset);
    memset(&ctx, 0, sizeof ctx);
    CHECK(hd_laplacian_triangles(&lap, both.xyz, both.n, both.tri, both.n_tri, NULL, &e) == HD_OK);
    perm = DENSE_NEW(int32_t, both.n);
    seen = DENSE_NEW(int32_t, both.n);
    dense_shuffle(perm, both.n, &seed);
    CHECK(hd_csr_permute(&shuffled, &lap->L, perm, NULL, &e) == HD_OK);
    CHECK(hdi_precond_cuthill_mckee(&shuffled, perm, &ctx, &e) == HD_OK);
    for (i = 0; i < both.n; i++)
        if (perm[i] >= 0 && perm[i] < both.n) seen[perm[i]]++;
    for (i = 0; i < both.n; i++) missing += seen[i] != 1;
    CHECK_MSG(missing == 0, "not a permutation: %d", (int)missing);
    CHECK_MSG(int_not_cuthill_mckee(&shuffled, perm) == 0, "%d vertices out of order", (int)int_not_cuthill_mckee(&shuffled, perm));
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
    hd_error e = int_no_error();
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
    hd_error e = int_no_error();
    hdi_upper up;
    hdi_system a;
    hdi_precond m;
    hd_c64 u[N], d[N], work[N], x[N], ax[N], back[N];
    int64_t mark[N + 1];
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
        mark[N] = 4711;
        hdi_precond_make(&m, &a, work, mark);
        CHECK(mark[N] == 4711);
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

/* ---- [14] dissection ---- */

/* A path of ten vertices, each end with one neighbour outside of the part; no weights. */
enum { INT_ND = 10, INT_ND_ROOM = 600 };

typedef struct int_nd {
    hdi_nd_graph g;
    int32_t ptr[INT_ND + 1], adj[2 * INT_ND], id[INT_ND], map[INT_ND], room[INT_ND_ROOM];
    int8_t side[INT_ND];
    hdi_nd_space space;
} int_nd;

static void int_nd_make(int_nd *t) {
    int32_t v, z = 0;
    memset(t, 0, sizeof *t);
    for (v = 0; v < INT_ND; v++) {
        t->ptr[v] = z;
        t->adj[z++] = v > 0 ? v - 1 : ~100;
        t->adj[z++] = v + 1 < INT_ND ? v + 1 : ~101;
        t->id[v] = 50 + v;
    }
    t->ptr[INT_ND] = z;
    t->g.n = INT_ND;
    t->g.ptr = t->ptr;
    t->g.adj = t->adj;
    t->g.id = t->id;
    t->g.map = t->map;
    t->g.side = t->side;
    t->space.at = t->room;
    t->space.end = t->room + INT_ND_ROOM;
}

static int32_t int_nd_path_cut(const int_nd *t) {
    int32_t v, cut = 0;
    for (v = 0; v + 1 < INT_ND; v++) cut += t->side[v] != t->side[v + 1];
    return cut;
}

/* Gains, weights and moves on a path by hand; passes that begin badly end within their limit. */
static void int_nd_path_moves(void) {
    int_nd t;
    hdi_nd_mover m;
    hdi_nd_cut cut;
    hdi_nd_space s;
    int32_t v, k, best;
    int_nd_make(&t);
    for (v = 5; v < INT_ND; v++) t.side[v] = 1;
    s = t.space;
    m = hdi_nd_mover_make(&t.g, &s);
    hdi_nd_mover_start(&m, &cut);
    CHECK(cut.cut == 1 && cut.weight[0] == 5 && cut.weight[1] == 5);
    for (v = 0; v < INT_ND; v++) CHECK(m.gain[v] == (v == 4 || v == 5 ? 0 : v == 0 || v == 9 ? -1 : -2));
    cut.most = 5;
    CHECK(hdi_nd_mover_next(&m, &cut) == -1);
    cut.most = 6;
    best = hdi_nd_mover_next(&m, &cut);
    CHECK(best == 4 || best == 5);
    hdi_nd_queue_remove(&m.q, 4);
    m.locked[4] = 1;
    hdi_nd_mover_move(&m, 4, &cut);
    CHECK(t.side[4] == 1 && cut.cut == 1 && cut.weight[0] == 4 && cut.weight[1] == 6 && m.gain[3] == 0 && m.gain[4] == 0 && m.gain[5] == -2);
    for (k = 0; k < 2; k++) {                    /* every other vertex; nearly all on one side */
        for (v = 0; v < INT_ND; v++) t.side[v] = (int8_t)(k ? v == 0 : v % 2);
        s = t.space;
        m = hdi_nd_mover_make(&t.g, &s);
        cut.most = 6;
        hdi_nd_refine_edges(&m, &cut, 4);
        CHECK_MSG(cut.cut == int_nd_path_cut(&t) && cut.cut < 4 && cut.weight[0] + cut.weight[1] == INT_ND && hdi_max(cut.weight[0], cut.weight[1]) <= 6,
                  "%d: cut %g, weights %g and %g", (int)k, cut.cut, cut.weight[0], cut.weight[1]);
    }
}

/* Clusters of a path, their graph, and what does not fit. */
static void int_nd_path_clusters(void) {
    int_nd t;
    hdi_nd_graph c;
    int32_t weight[INT_ND], member[INT_ND], start[INT_ND + 1], mark[INT_ND], ptr[INT_ND + 1], adj[2 * INT_ND], ew[2 * INT_ND], id[INT_ND];
    int32_t v, p, sum = 0, between = 0;
    int_nd_make(&t);
    memset(&c, 0, sizeof c);
    c.ptr = ptr;
    c.adj = adj;
    c.ew = ew;
    c.id = id;
    c.n = hdi_nd_cluster(&t.g, 3, weight);
    CHECK(c.n >= 4 && c.n <= 6);
    for (v = 0; v < c.n; v++) {
        CHECK(weight[v] > 0 && weight[v] <= 3);
        sum += weight[v];
    }
    CHECK(sum == INT_ND);
    CHECK(!hdi_nd_contract(&t.g, &c, 2, member, start, mark));
    CHECK(hdi_nd_contract(&t.g, &c, 2 * INT_ND, member, start, mark) && ptr[c.n] == 2 * (c.n - 1));
    for (v = 0; v < c.n; v++) {
        CHECK(t.map[id[v] - 50] == v);
        for (p = ptr[v]; p < ptr[v + 1]; p++) {
            CHECK(adj[p] == v - 1 || adj[p] == v + 1);
            between += ew[p];
        }
    }
    CHECK(between == 2 * (c.n - 1));             /* each of a path's edges between clusters, from both ends */
}

/* Steps along a path, the place where a sweep cuts it, and sides by number. */
static void int_nd_sides(void) {
    int_nd t;
    hdi_pair key[INT_ND];
    int32_t dist[INT_ND], queue[INT_ND], size[3], v;
    int_nd_make(&t);
    CHECK(hdi_nd_steps(&t.g, 0, dist, queue) == INT_ND - 1);
    for (v = 0; v < INT_ND; v++) {
        CHECK(dist[v] == v);
        key[v].key = (uint64_t)v;
        key[v].id = (uint32_t)v;
    }
    hdi_nd_sweep(&t.g, key, INT_ND);
    for (v = 0; v < INT_ND; v++) CHECK(t.side[v] == (v >= 5));
    CHECK(hdi_nd_touches(&t.g, 4) && hdi_nd_touches(&t.g, 5) && !hdi_nd_touches(&t.g, 0) && !hdi_nd_touches(&t.g, 9));
    hdi_nd_halve(&t.g);
    CHECK(hdi_nd_measure(&t.g, size) && size[0] == 4 && size[1] == 5 && size[2] == 1 && t.side[4] == 2);
    memset(t.side, 0, sizeof t.side);
    CHECK(!hdi_nd_measure(&t.g, size) && size[0] == INT_ND);
    memset(t.side, 1, sizeof t.side);
    CHECK(!hdi_nd_measure(&t.g, size) && size[1] == INT_ND);
    for (v = 0; v < INT_ND; v++) t.side[v] = (int8_t)(v < 6 ? 2 : v % 2);
    CHECK(!hdi_nd_measure(&t.g, size) && size[2] == 6);
}

/* The halo gets numbers behind the part's, or is left out; without any room a leaf keeps its order. */
static void int_nd_leaves(void) {
    const hdi_nd_part part = {3, INT_ND, 0, 2 * INT_ND, 0, 0};
    int32_t perm[3 + INT_ND], v, p;
    hdi_nd_space none;
    hdi_nd nd;
    int_nd t;
    memset(&nd, 0, sizeof nd);
    nd.perm = perm;
    int_nd_make(&t);
    none.at = none.end = t.room;
    CHECK(hdi_nd_halo(&part, t.adj, none) == part.n_edges && t.adj[0] == ~100);
    CHECK(hdi_nd_halo(&part, t.adj, t.space) == 2 && t.adj[0] == INT_ND && t.adj[2 * INT_ND - 1] == INT_ND + 1);
    hdi_nd_bare(&t.g);
    CHECK(t.ptr[INT_ND] == 2 * (INT_ND - 1));
    for (v = 0; v < INT_ND; v++)
        for (p = t.ptr[v]; p < t.ptr[v + 1]; p++) CHECK(t.adj[p] == v - 1 || t.adj[p] == v + 1);
    int_nd_make(&t);
    hdi_nd_leaf(&nd, &part, &t.g, none);
    for (v = 0; v < INT_ND; v++) CHECK(perm[3 + v] == 50 + v);
}

/* ---- [15] analysis and [16] schedule, against dense elimination; [17] factors and sweeps, [18] inverses ---- */

static double int_off(const double *a, const double *b, int64_t n) {
    return dense_max_diff(a, b, n) / (1 + dense_max_abs(b, n));
}

static void int_noise(double *x, int64_t n, uint64_t *seed) {
    int64_t i;
    for (i = 0; i < n; i++) x[i] = dense_signed(seed);
}

/* Patterns: a grid, a random graph that falls apart, a path, a star, no edge at all, and full matrices joined by some of
 * their rows, so that fronts have about as many pivots and rows as one likes. */
typedef struct int_kind { const char *name; int32_t n, of, joint; } int_kind;
static const int_kind int_kinds[] = {
    {"grid", 144, 0, 0}, {"random", 90, 0, 0}, {"path", 54, 0, 0}, {"star", 61, 0, 0}, {"diagonal", 30, 0, 0},
    {"full", HDI_PANEL + 9, HDI_PANEL + 9, 0}, {"4, 33", 41, 4, 33}, {"7, 3", 31, 7, 3}, {"9, 12", 48, 9, 12},
    {"23, 50", 96, 23, 50}, {"33, 9", 75, 33, 9},
};
enum { INT_KINDS = sizeof int_kinds / sizeof *int_kinds };

static int int_joined(int kind, int32_t a, int32_t b, uint64_t *seed) {
    const int32_t of = int_kinds[kind].of;
    switch (kind) {
        case 0: return a - b == 12 || (a % 12 && (a - b == 1 || a - b == 13));
        case 1: return dense_random(seed) % 70 < 2;
        case 2: return b == a - 1;
        case 3: return b == 0;
        case 4: return 0;
        default: return a / of == b / of || a >= int_kinds[kind].n - int_kinds[kind].joint;
    }
}

static hd_csr int_pattern(int kind) {
    const int32_t n = int_kinds[kind].n;
    int32_t *i = DENSE_NEW(int32_t, 2 * n * n), *j = i + n * n, a, b, c = 0;
    uint64_t seed = 5;
    hd_csr out;
    for (a = 0; a < n; a++) {
        i[c] = a;
        j[c++] = a;
        for (b = 0; b < a; b++) {
            if (!int_joined(kind, a, b, &seed)) continue;
            i[c] = j[c + 1] = a;
            j[c] = i[c + 1] = b;
            c += 2;
        }
    }
    CHECK(hd_csr_from_triplets(&out, n, n, c, i, j, NULL, NULL, NULL) == HD_OK);
    free(i);
    return out;
}

/* l [n n]: where L of P A P' has entries, diagonal included, by elimination. */
static char *int_fill(const hd_csr *a, const int32_t *perm) {
    const int32_t n = a->n_rows;
    char *l = DENSE_NEW(char, n * n);
    int32_t *inv = DENSE_NEW(int32_t, n), i, j, k;
    int64_t p;
    for (i = 0; i < n; i++) inv[perm[i]] = i;
    for (i = 0; i < n; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) l[inv[i] * n + inv[a->col[p]]] = 1;
    for (k = 0; k < n; k++)
        for (i = k + 1; i < n; i++)
            for (j = k + 1; l[i * n + k] && j < n; j++) l[i * n + j] |= l[j * n + k];
    free(inv);
    return l;
}

/* Every entry of L has a place in its front, and the counts are those of the entries. */
static void int_fill_right(const hdi_symbolic *s, const hd_csr *a, const char *what) {
    char *l = int_fill(a, s->perm);
    int64_t nnz = 0, p;
    int32_t i, j, lost = 0;
    double flops = 0;
    for (j = 0; j < s->n; j++) {
        const int32_t v = s->super_of[j];
        int32_t count = 0;
        for (i = j; i < s->n; i++) {
            int inside = s->super_of[i] == v;
            if (!l[i * s->n + j]) continue;
            count++;
            for (p = s->row_ptr[v]; p < s->row_ptr[v + 1]; p++) inside |= s->row[p] == i;
            lost += !inside;
        }
        nnz += count;
        flops += (double)count * count;
    }
    CHECK_MSG(lost == 0, "%s: %d entries of L have no place", what, (int)lost);
    CHECK_MSG(nnz == s->nnz && flops == s->flops && s->flops_done >= s->flops,
              "%s: %lld non-zeros and %g flops, not %lld and %g", what,
              (long long)s->nnz, s->flops, (long long)nnz, flops);
    free(l);
}

/* Fronts share out the pivots, rows ascend and stand in the parent's front where rel says, and so do the entries of A. */
static void int_fronts_right(const hdi_symbolic *s, const hd_csr *a, const char *what) {
    int32_t *seen = DENSE_NEW(int32_t, s->n + 1), v, k, i, row, col, wrong = s->super[0] != 0 || s->super[s->n_super] != s->n;
    int64_t p, entries = 0;
    for (i = 0; i < s->n; i++) wrong += seen[s->perm[i]]++ != 0;
    for (v = 0; v < s->n_super; v++) {
        const int32_t up = s->parent[v], width = up < 0 ? 0 : s->super[up + 1] - s->super[up];
        wrong += s->super[v] >= s->super[v + 1] || (up != -1 && up <= v) || (up == -1) != (s->row_ptr[v] == s->row_ptr[v + 1]);
        for (i = s->super[v]; i < s->super[v + 1]; i++) wrong += s->super_of[i] != v;
        for (p = s->row_ptr[v]; p < s->row_ptr[v + 1]; p++) {
            const int32_t at = s->rel[p];
            wrong += s->row[p] < (p > s->row_ptr[v] ? s->row[p - 1] + 1 : s->super[v + 1]) || s->row[p] >= s->n;
            wrong += at < 0 || (at < width ? s->super[up] + at : s->row[s->row_ptr[up] + at - width]) != s->row[p];
        }
        for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) wrong += s->parent[s->kid[k]] != v;
        for (p = s->a_ptr[v]; p < s->a_ptr[v + 1]; p++, entries++) {
            hdi_entry_place(s, v, p, &row, &col);
            for (i = s->perm[col]; a->row_ptr[i + 1] <= s->a_from[p]; i++) {}
            wrong += i != s->perm[col] || s->a_from[p] < a->row_ptr[i] || s->perm[row] != a->col[s->a_from[p]] || row < col;
        }
    }
    memset(seen, 0, (size_t)s->n * sizeof *seen);
    for (k = 0; k < s->n_tasks; k++)             /* and so do subtrees and the top */
        for (v = s->task_begin[k]; v < s->task_end[k]; v++) {
            seen[v]++;
            wrong += s->task_of[v] != k || (s->parent[v] >= 0 && s->task_of[s->parent[v]] >= 0 && s->task_of[s->parent[v]] != k);
        }
    for (k = 0; k < s->n_top; k++) {
        seen[s->top[k]]++;
        wrong += s->task_of[s->top[k]] != -1 - k || (k > 0 && s->top[k] <= s->top[k - 1]);
    }
    for (v = 0; v < s->n_super; v++) wrong += seen[v] != 1;
    CHECK_MSG(wrong == 0 && entries == (a->nnz + s->n) / 2, "%s: %d numbers are wrong; %lld entries", what, (int)wrong,
              (long long)entries);
    free(seen);
}

/* Places in memory: what v leaves is held until its parent is through. Subtrees go on at the same time, then the top in
 * turn; vectors of the top all stay. No two overlap that are held at the same time. */
static void int_places(const hdi_symbolic *s, int triangle, const char *what) {
    const int64_t *at = triangle ? s->update : s->vector, size = triangle ? s->work : s->vector_size;
    int32_t v, w, clash = 0;
    for (v = 0; v < s->n_super; v++) {
        const int32_t up = s->parent[v], task = s->task_of[v];
        const int64_t u = hdi_front_below(s, v), end = at[v] + (triangle ? u * (u + 1) / 2 : u);
        clash += u > 0 && (at[v] < 0 || end > size);
        for (w = 0; w < s->n_super && u > 0; w++) {
            const int64_t below = hdi_front_below(s, w), last = at[w] + (triangle ? below * (below + 1) / 2 : below);
            int both;
            if (s->task_of[w] >= 0) both = task == s->task_of[w] ? v < w && w <= up : task >= 0;
            else both = (task < 0 ? v < w : s->task_of[up] < 0) && (w <= up || !triangle);
            clash += both && below > 0 && at[v] < last && at[w] < end;
        }
    }
    CHECK_MSG(clash == 0, "%s: %d %s are another's or nowhere", what, (int)clash, triangle ? "updates" : "vectors");
}

/* Symmetric matrices on one pattern, diagonally dominant: four complex ones, and as the last a real one, whose pivots have
 * both signs; the inverses; X, with zeros here and there, and forms x_i' Z x_i of its rows. */
enum { INT_REAL = 4, INT_MATRICES };
typedef struct int_system {
    hd_csr a;
    double *real, *x;
    hd_c64 *z[INT_MATRICES];
    dense_c64 *inverse[INT_MATRICES], *form[INT_MATRICES];
} int_system;

/* In [-1, 1), the same for (i,j) and (j,i). */
static double int_entry(int32_t i, int32_t j, int salt) {
    uint64_t seed = ((uint64_t)(i > j ? i : j) * 1009 + (uint64_t)(i > j ? j : i)) * 64 + (uint64_t)salt + 1;
    (void)dense_random(&seed);
    return dense_signed(&seed);
}

/* In place, by Gauss and Jordan; without pivots from elsewhere, as the diagonal dominates. */
static void int_dense_invert(dense_c64 *a, int32_t n) {
    int32_t i, j, k;
    for (k = 0; k < n; k++) {
        dense_c64 *row = a + k * n;
        const dense_c64 pivot = row[k];
        row[k] = dense_c(1, 0);
        for (j = 0; j < n; j++) row[j] = dense_cquotient(row[j], pivot);
        for (i = 0; i < n; i++) {
            const dense_c64 f = a[i * n + k];
            if (i == k || (f.re == 0 && f.im == 0)) continue;
            a[i * n + k] = dense_c(0, 0);
            for (j = 0; j < n; j++) a[i * n + j] = dense_cfma(a[i * n + j], f, row[j]);
        }
    }
}

static dense_c64 int_form(const int_system *y, const dense_c64 *inverse, int32_t i) {
    dense_c64 sum = dense_c(0, 0);
    int64_t p, q;
    for (p = y->a.row_ptr[i]; p < y->a.row_ptr[i + 1]; p++)
        for (q = y->a.row_ptr[i]; q < y->a.row_ptr[i + 1] && y->x[p] != 0; q++)
            sum = dense_cfma(sum, dense_c(-y->x[p] * y->x[q], 0), inverse[y->a.col[p] * y->a.n_rows + y->a.col[q]]);
    return sum;
}

static int_system int_system_make(int kind) {
    int_system y;
    int32_t n, i, j, q;
    int64_t p;
    y.a = int_pattern(kind);
    n = y.a.n_rows;
    y.real = DENSE_NEW(double, y.a.nnz);
    y.x = DENSE_NEW(double, y.a.nnz);
    for (q = 0; q < INT_MATRICES; q++) {
        y.z[q] = DENSE_NEW(hd_c64, y.a.nnz);
        y.inverse[q] = DENSE_NEW(dense_c64, n * n);
        y.form[q] = DENSE_NEW(dense_c64, n);
        for (i = 0; i < n; i++)
            for (p = y.a.row_ptr[i]; p < y.a.row_ptr[i + 1]; p++) {
                const double most = 1.5 * (double)(y.a.row_ptr[i + 1] - y.a.row_ptr[i]);
                const double turn = q < INT_REAL ? 1 + q : i % 3 ? 0 : acos(-1.0);
                j = y.a.col[p];
                y.z[q][p] = hdi_c(int_entry(i, j, 2 * q), int_entry(i, j, 2 * q + 1));
                if (i == j) y.z[q][p] = hdi_c(most * cos(turn), most * sin(turn));
                if (q == INT_REAL) y.real[p] = y.z[q][p].re;
                if (q == INT_REAL) y.z[q][p].im = 0;
                y.x[p] = int_entry(i, j, 20) < -0.6 ? 0 : int_entry(i, j, 21);
                y.inverse[q][i * n + j] = dense_c(y.z[q][p].re, y.z[q][p].im);
            }
        int_dense_invert(y.inverse[q], n);
        for (i = 0; i < n; i++) y.form[q][i] = int_form(&y, y.inverse[q], i);
    }
    return y;
}

static void int_system_free(int_system *y) {
    int q;
    for (q = 0; q < INT_MATRICES; q++) {
        free(y->z[q]);
        free(y->inverse[q]);
        free(y->form[q]);
    }
    free(y->real);
    free(y->x);
    hd_csr_free(&y->a, NULL);
}

/* A x = b for k right-hand sides side by side, of which x has rows of k entries in elimination order. sparse: few
 * non-zeros, and fronts that see none of them are told to be out of it. */
static void int_sweeps_right(const int_system *y, const hdi_factor *f, int32_t k, int sparse, const char *what) {
    const hdi_symbolic *s = f->sym;
    const int32_t n = s->n, w = f->width, row = w * k;
    double *x = DENSE_NEW(double, n * row), *b = DENSE_NEW(double, n * row), worst;
    double *work = DENSE_NEW(double, hdi_sweep_size(s, w, k));
    int32_t *inv = DENSE_NEW(int32_t, n), i, r, q;
    char *active = DENSE_NEW(char, s->n_super);
    uint64_t seed = 17;
    hdi_sweep z;
    int64_t p;
    for (i = 0; i < n; i++) {
        inv[s->perm[i]] = i;
        if (sparse && i % 61 != 7) continue;
        int_noise(b + i * row, row, &seed);
        hdi_sweep_touch(s, i, active);
    }
    memcpy(x, b, (size_t)(n * row) * sizeof *x);
    for (i = 0; (uint64_t)i < hdi_sweep_size(s, w, k); i++) work[i] = 1e300;
    z = hdi_sweep_open(f, k, x, work);
    if (sparse) z.active = active;
    hdi_sweep_run(&z, k % 2 ? f->ctx : NULL);
    for (i = 0; i < n; i++)
        for (p = y->a.row_ptr[i]; p < y->a.row_ptr[i + 1]; p++)
            for (r = 0; r < k; r++)
                for (q = 0; q < (w == 1 ? 1 : 4); q++) {
                    const hd_c64 a = y->z[w == 1 ? INT_REAL : q][p];
                    const double *v = x + inv[y->a.col[p]] * row + w * r + q;
                    double *to = b + inv[i] * row + w * r + q;
                    to[0] -= a.re * v[0] - (w == 1 ? 0 : a.im * v[4]);
                    if (w > 1) to[4] -= a.re * v[4] + a.im * v[0];
                }
    worst = dense_max_abs(b, n * row);
    CHECK_MSG(worst < 1e-13, "%s, width %d, %d side by side: residual %g", what, (int)w, (int)k, worst);
    free(x);
    free(b);
    free(work);
    free(inv);
    free(active);
}

/* What an inversion should add: numbers of the diagonal or of forms by pivots, or of entries. */
static double *int_inverse_wanted(const int_system *y, const hdi_symbolic *s, int32_t w, hdi_wanted wanted, int64_t count) {
    double *want = DENSE_NEW(double, w * count);
    int32_t q, v, i, j;
    int64_t p;
    for (q = 0; q < (w == 1 ? 1 : 4); q++)
        for (v = 0; v < s->n_super; v++)
            for (p = s->a_ptr[v]; p < s->a_ptr[v + 1]; p++) {
                const int m = w == 1 ? INT_REAL : q;
                dense_c64 c;
                int64_t at;
                hdi_entry_place(s, v, p, &i, &j);
                if (wanted != HDI_WANT_ENTRIES && i != j) continue;
                at = q * count + (wanted == HDI_WANT_ENTRIES ? p : i);
                c = wanted == HDI_WANT_FORMS ? y->form[m][s->perm[i]] : y->inverse[m][s->perm[i] * s->n + s->perm[j]];
                want[at] = c.re;
                if (w > 1) want[at + 4 * count] = c.im;
            }
    return want;
}

/* Every number, added to what is there. cols: the most columns that forms take together; 0: as it comes. */
static void int_inverse_right(const int_system *y, hdi_factor *f, hdi_wanted wanted, int32_t cols, const char *what) {
    const hdi_symbolic *s = f->sym;
    const int32_t w = f->width;
    const int64_t count = wanted == HDI_WANT_ENTRIES ? s->a_ptr[s->n_super] : s->n;
    double coef[HDI_PACK * HDI_PACK] = {0}, *got = DENSE_NEW(double, w * count),
        *want = int_inverse_wanted(y, s, w, wanted, count);
    hd_error e = int_no_error();
    hdi_scope keep = hdi_scope_begin(f->ctx, &e);
    hdi_forms forms;
    hdi_inverse z;
    int64_t p;
    hdi_inverse_take(&z, s, w, &keep);
    if (wanted == HDI_WANT_FORMS) CHECK(hdi_forms_make(&forms, s, w, &y->a, y->x, f->ctx, &e) == HD_OK);
    if (cols && cols < forms.cols) forms.cols = cols;
    if (cols && forms.n_slots > 2) forms.n_slots = 2;
    for (p = 0; p < w; p++) coef[p * w + p] = 1;
    for (p = 0; p < w * count; p++) got[p] = 3;
    z.coef = coef;
    z.n_sets = w;
    z.wanted = wanted;
    z.forms = &forms;
    z.values = got;
    z.stride = count;
    CHECK_MSG(hdi_inverse_run(&z, f, &e) == HD_OK, "%s: %s", what, e.text);
    for (p = 0; p < w * count; p++) got[p] -= 3;
    CHECK_MSG(dense_max_diff(got, want, w * count) < 1e-13, "%s, width %d, wanted %d, blocks of %d: off by %g", what, (int)w,
              (int)wanted,
              (int)cols, dense_max_diff(got, want, w * count));
    if (wanted == HDI_WANT_FORMS) hdi_forms_free(&forms, f->ctx);
    hdi_scope_end(&keep);
    free(got);
    free(want);
}

/* All fronts to the top, where blocks of columns are tasks; those of small matrices are all in subtrees otherwise. */
static void int_all_top(hdi_symbolic *s) {
    int32_t v;
    s->n_tasks = s->task_pivots = s->task_update = 0;
    s->n_top = s->n_super;
    for (v = 0; v < s->n_super; v++) {
        s->top[v] = v;
        s->task_of[v] = -1;
    }
}

static void int_factor_right(const int_system *y, const hdi_symbolic *s, int32_t width, hd_context *ctx, const char *what) {
    hd_error e = int_no_error();
    hdi_values v;
    hdi_factor f;
    int32_t q;
    memset(&v, 0, sizeof v);
    v.real = width == 1 ? y->real : NULL;
    for (q = 0; q < 4 && width > 1; q++) v.z[q] = y->z[q];
    CHECK_MSG(hdi_factor_make(&f, s, width, ctx, &e) == HD_OK && hdi_factor_run(&f, &v, &e) == HD_OK, "%s: %s", what, e.text);
    for (q = 0; q < 4; q++) int_sweeps_right(y, &f, q / 2 ? width == 1 ? 8 : 13 : 1, q % 2, what);
    int_inverse_right(y, &f, HDI_WANT_DIAGONAL, 0, what);
    int_inverse_right(y, &f, HDI_WANT_ENTRIES, 0, what);
    for (q = 0; q < (y->a.nnz < 10000 ? 3 : 1); q++) int_inverse_right(y, &f, HDI_WANT_FORMS, 2 * q, what);
    hdi_factor_free(&f);
}

static void int_analysis_right(const hdi_symbolic *s, const hd_csr *a, int dense, const char *what) {
    int_fronts_right(s, a, what);
    if (dense) int_fill_right(s, a, what);
    int_places(s, 0, what);
    int_places(s, 1, what);
}

/* A pattern by minimum degree and by another order, in subtrees and at the top, at all levels of instructions. */
static void int_factors_of(const int_system *y, int kind, int way) {
    static const hd_simd simds[3] = {HD_SIMD_NONE, HD_SIMD_AVX2, HD_SIMD_AVX512};
    int32_t *perm = DENSE_NEW(int32_t, y->a.n_rows), i;
    uint64_t seed = 8;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_symbolic s;
    char what[80];
    memset(&ctx, 0, sizeof ctx);
    ctx.simd = simds[way / 4];
    sprintf(what, "%s, way %d", int_kinds[kind].name, way);
    for (i = 0; i < y->a.n_rows; i++) perm[i] = i;
    if (way % 2) CHECK(hdi_amd_order(&y->a, perm, &ctx, &e) == HD_OK);
    else if (kind < 5) dense_shuffle(perm, y->a.n_rows, &seed);
    CHECK_MSG(hdi_symbolic_make(&s, &y->a, perm, &ctx, &e) == HD_OK, "%s: %s", what, e.text);
    if (way < 2) int_analysis_right(&s, &y->a, 1, what);
    if (way & 2) int_all_top(&s);
    int_factor_right(y, &s, 1, &ctx, what);
    int_factor_right(y, &s, HDI_PACK, &ctx, what);
    hdi_symbolic_free(&ctx, &s);
    CHECK(ctx.bytes_in_use == 0);
    free(perm);
}

static void int_factors(void) {
    int kind, way;
    for (kind = 0; kind < INT_KINDS; kind++) {
        int_system y = int_system_make(kind);
        for (way = 0; way < 4 * (hdi_simd_best() + 1); way += kind < 5 ? 1 : 2) int_factors_of(&y, kind, way);
        int_system_free(&y);
    }
}

/* Meshes with many subtrees and a top. */
static void int_schedules(void) {
    shape s[3];
    const double offset[3] = {3, 0, 0};
    int q, k;
    s[0] = shape_bumpy(4, 3);
    s[1] = shape_grid(70, 60, 0.3);
    s[2] = shape_disjoint(s, s + 1, offset);
    for (q = 0; q < 3; q++) {
        hd_laplacian *lap = NULL;
        int32_t *perm = DENSE_NEW(int32_t, s[q].n);
        CHECK(hd_laplacian_triangles(&lap, s[q].xyz, s[q].n, s[q].tri, s[q].n_tri, NULL, NULL) == HD_OK);
        for (k = 0; k < 2; k++) {
            hd_context ctx;
            hd_error e = int_no_error();
            hdi_symbolic y;
            memset(&ctx, 0, sizeof ctx);
            if (k) CHECK(hdi_nd_order(&lap->L, lap->xyz, perm, &ctx, &e) == HD_OK);
            else CHECK(hdi_amd_order(&lap->L, perm, &ctx, &e) == HD_OK);
            CHECK(hdi_symbolic_make(&y, &lap->L, perm, &ctx, &e) == HD_OK && y.n_tasks > 1 && y.n_top > 0);
            int_analysis_right(&y, &lap->L, 0, "mesh");
            hdi_symbolic_free(&ctx, &y);
            CHECK(ctx.bytes_in_use == 0);
        }
        free(perm);
        hd_laplacian_free(lap);
        shape_free(s + q);
    }
}


/* ---- [22] poles: what checks and bounds rest on ---- */

static hd_laplacian *int_mesh(int kind, hd_laplacian_kind form) {
    shape s = kind == 0 ? shape_bumpy(2, 5) : kind == 1 ? shape_grid(14, 9, 0.3) : shape_icosphere(3);
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    memset(&o, 0, sizeof o);
    o.kind = form;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, NULL) == HD_OK);
    shape_free(&s);
    return lap;
}

/* l L + b B, dense, or the absolute values. */
static double *int_dense(const hd_laplacian *lap, double l, double b, int absolute) {
    double *d = DENSE_NEW(double, lap->n_active * lap->n_active);
    int64_t p;
    int32_t i;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double mass = lap->B ? lap->B[p] : lap->L.col[p] == i ? lap->mass[i] : 0, L = lap->L.val[p];
            d[i * lap->n_active + lap->L.col[p]] = absolute ? l * fabs(L) + b * fabs(mass) : l * L + b * mass;
        }
    return d;
}

/* Pole q's part of a right-hand side: residual and size of its solution, their share of the answer and of B times it. */
static void int_check_right(const hdi_check *c, const double *L, const double *B, int q, double *want_u, double *want_bu) {
    const int32_t n = c->lap->n_active;
    double *part = DENSE_NEW(double, 6 * n), *l = part + 2 * n, *b = l + 2 * n, norm2 = 0, size2 = 0, first2 = 0;
    int32_t i, k;
    for (k = 0; k < 2; k++) {                    /* real parts, then imaginary ones */
        for (i = 0; i < n; i++) part[k * n + i] = c->x[c->stride * i + q + 4 * k];
        dense_apply(L, part + k * n, l + k * n, n);
        dense_apply(B, part + k * n, b + k * n, n);
        for (i = 0; i < n; i++) {
            size2 += c->noise[i] * part[k * n + i] * part[k * n + i];
            first2 += part[k * n + i] * b[k * n + i];
            want_u[i] += c->coef[q + 4 * k] * part[k * n + i];
            want_bu[i] += c->coef[q + 4 * k] * b[k * n + i];
        }
    }
    for (i = 0; i < n; i++) {
        const double re = c->rhs[i] - c->t * l[i] - c->theta[q] * b[i] + c->theta[q + 4] * b[n + i];
        const double im = -c->t * l[n + i] - c->theta[q] * b[n + i] - c->theta[q + 4] * b[i];
        norm2 += c->weight[i] * (re * re + im * im);
    }
    CHECK_MSG(fabs(norm2 / c->norm2[q] - 1) < 1e-12 && fabs(size2 / c->size2[q] - 1) < 1e-12 &&
              (q > 0 || fabs(first2 / c->first2 - 1) < 1e-12),
              "pole %d: residual %g, told %g; size %g, told %g; norm %g, told %g", q, norm2, c->norm2[q], size2, c->size2[q],
                  first2, c->first2);
    free(part);
}

/* Checks of packs for one to so many right-hand sides together, by their definition. */
static void int_checks_of(const hd_laplacian *lap, void (*check)(hdi_check *const *c, int32_t k), int32_t k) {
    const int32_t n = lap->n_active;
    double *x = DENSE_NEW(double, HDI_PACK * 6 * n), *rhs = DENSE_NEW(double, 6 * n), *weight = DENSE_NEW(double, 2 * n),
        *u = DENSE_NEW(double, 14 * n);
    double *L = int_dense(lap, 1, 0, 0), *B = int_dense(lap, 0, 1, 0), *want = u + 12 * n;
    hdi_check c[6], *list[6];
    uint64_t seed = 9;
    int32_t i, r, q;
    int_noise(x, HDI_PACK * 6 * n, &seed);
    int_noise(rhs, 6 * n, &seed);
    for (i = 0; i < 2 * n; i++) weight[i] = 1 + 0.1 * (i % 7);
    memset(c, 0, sizeof c);
    for (r = 0; r < k; r++) {
        list[r] = c + r;
        c[r].lap = lap;
        c[r].t = 0.7;
        int_noise(c[r].coef, HDI_PACK, &seed);
        for (q = 0; q < HDI_PACK; q++) c[r].theta[q] = 0.4 * q - 1.3;
        c[r].weight = weight;
        c[r].noise = weight + n;
        c[r].rhs = rhs + r * n;
        c[r].x = x + HDI_PACK * r;
        c[r].stride = HDI_PACK * 6;
        c[r].u = u + r * n;
        c[r].bu = u + (6 + r) * n;
    }
    check(list, k);
    for (r = 0; r < k; r++) {
        memset(want, 0, 2 * (size_t)n * sizeof *want);
        for (q = 0; q < 4; q++) int_check_right(c + r, L, B, q, want, want + n);
        CHECK_MSG(int_off(c[r].u, want, n) < 1e-13 && int_off(c[r].bu, want + n, n) < 1e-13,
                  "%d checked together: %g, %g off", (int)k,
                  int_off(c[r].u, want, n), int_off(c[r].bu, want + n, n));
    }
    free(x);
    free(rhs);
    free(weight);
    free(u);
    free(L);
    free(B);
}

static void int_checks(void) {
    int form;
    int32_t k;
    for (form = 0; form < 2; form++) {
        hd_laplacian *lap = int_mesh(1, form ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        for (k = 1; k <= HDI_CHECK_MOST; k++) {
            int_checks_of(lap, hdi_check_c, k);
#if HDI_X86
            if (hdi_simd_best() == 2) int_checks_of(lap, hdi_check_512, k);
#endif
        }
        hd_laplacian_free(lap);
    }
}

/* Weights of rounding: noise_j = sum_i M_ij c_i^2/D_i sum_k M_ik with M = t |L| + theta |B|, c_i half a unit for each term
 * and eight more. And no eigenvalue lies above its bound, which is not much larger than the largest. */
static void int_noise_weights(void) {
    int form;
    for (form = 0; form < 2; form++) {
        hd_laplacian *lap = int_mesh(1, form ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        const int32_t n = lap->n_active;
        double *M = int_dense(lap, 0.3, 1.7, 1), *noise = DENSE_NEW(double, 2 * n), *want = DENSE_NEW(double, n), top,
            bound = hdi_lambda_bound(lap);
        dense_pair pair;
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
        CHECK(dense_pair_solve(&pair, int_dense(lap, 1, 0, 0), int_dense(lap, 0, 1, 0), n));
        top = dense_max_abs(pair.lambda, n);
        CHECK_MSG(bound >= top && bound <= 20 * top, "bound %g, eigenvalue %g", bound, top);
        dense_pair_free(&pair);
        hd_laplacian_free(lap);
        free(M);
        free(noise);
        free(want);
    }
}

/* The nearest and the most of |x + theta|, the latter over 1 + x, for x >= 0, by search. */
static void int_pole_bounds(void) {
    uint64_t seed = 4;
    int k, i;
    for (k = 0; k < 200; k++) {
        const double size = pow(10, 2 * dense_signed(&seed));
        const hd_c64 theta = hdi_c(size * 3 * dense_signed(&seed), size * (0.01 + fabs(dense_signed(&seed))));
        double nearest = hdi_pole_distance(theta), ratio = hdi_resolvent_ratio(theta), least = HUGE_VAL, most = 0;
        for (i = 0; i <= 20000; i++) {           /* x from 0 over 1e-4 to 1e6, and closely around the pole */
            const double x = i == 0 ? 0 : i % 2 ? pow(10, -4 + i * 5e-4) : fmax(0, -theta.re + (i - 10000) * 1e-3 * size);
            least = fmin(least, hypot(x + theta.re, theta.im));
            most = fmax(most, hypot(x + theta.re, theta.im) / (1 + x));
        }
        CHECK_MSG(nearest <= least * (1 + 1e-12) && nearest > least * (1 - 1e-4) && ratio >= most * (1 - 1e-12) &&
                  ratio <= most * 1.001,
                  "theta %g %+g i: %g, %g, by search %g, %g", theta.re, theta.im, nearest, ratio, least, most);
    }
    CHECK(hdi_resolvent_ratio(hdi_c(1, 0)) == 1 && hdi_resolvent_ratio(hdi_c(5, 0)) == 5 &&
          hdi_resolvent_ratio(hdi_c(0.2, 0)) == 1);
}

/* factor Re 1/(x + theta) >= 1/(1 + x), which bounds of diagonals rest on, for the pole that all sets choose; an imaginary
 * one bounds nothing. */
static void int_resolvent_pole(void) {
    static const hd_pole_kind kinds[3] = {HD_POLES_UNIFORM, HD_POLES_KERNEL, HD_POLES_DIAGONAL};
    hd_rational set;
    double factor = 1;
    int32_t r, k, best;
    for (r = 3 * 2; r < 3 * 15; r++) {
        hd_error e = int_no_error();
        factor = 1;
        CHECK(hdi_rational_get(&set, kinds[r % 3], r / 3, &e) == HD_OK);
        best = hdi_resolvent_pole(&set, &factor);
        CHECK_MSG(best >= 0 && best < set.n_poles && factor < 10, "set %d: pole %d, factor %g", (int)r, (int)best, factor);
        for (k = -1; k < 600 && best >= 0; k++) {
            const double x = k < 0 ? 0 : pow(10, -4 + 0.02 * k), re = x + set.theta[best].re, im = set.theta[best].im;
            CHECK_MSG(factor * re / (re * re + im * im) * (1 + x) >= 1 - 1e-12, "set %d, x %g", (int)r, x);
        }
    }
    set.n_poles = 1;
    set.theta[0] = hdi_c(0, 1);
    CHECK(hdi_resolvent_pole(&set, &factor) == -1);
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

/* Lanczos from e_1 on a tridiagonal T gives T back: m steps leave exp(-t T_m) e_1, and the bound must hold against exp(-t
 * T) e_1. */
static void int_lanczos_bound(void) {
    enum { N = 60 };
    static const double times[4] = {0.1, 1, 10, 100};
    double *T = DENSE_NEW(double, N * N), *one = DENSE_NEW(double, N * N), *room = DENSE_NEW(double, 9 * N + 2),
        *got = room + 7 * N + 2, *want = got + N;
    double start[N] = {1}, loosest = 0;
    hd_c64 work[2 * N];
    hd_rational set;
    dense_pair whole, part;
    hdi_lanczos z;
    hd_error e = int_no_error();
    uint64_t seed = 12;
    int32_t i, j, m, k;
    memset(&z, 0, sizeof z);
    z.d = room;
    z.e = z.d + N;
    z.z0 = z.e + N;
    z.z1 = z.z0 + N;
    z.y = z.z1 + N;
    z.alpha = z.y + N;
    z.beta = z.alpha + N;
    z.work = work;
    for (i = 0; i < N; i++) {                    /* positive: diagonally dominant */
        T[i * N + i] = z.alpha[i] = 2.2 + dense_signed(&seed);
        z.beta[i + 1] = 0.5 + 0.1 * dense_signed(&seed);
        if (i + 1 < N) T[i * N + i + 1] = T[(i + 1) * N + i] = z.beta[i + 1];
        one[i * N + i] = 1;
    }
    CHECK(hdi_rational_get(&set, HD_POLES_UNIFORM, 14, &e) == HD_OK && dense_pair_solve(&whole, T, one, N));
    for (m = 1; m < N; m += 3) {
        double *Tm = DENSE_NEW(double, m * m), *Im = DENSE_NEW(double, m * m);
        for (i = 0; i < m; i++) {
            for (j = 0; j < m; j++) Tm[i * m + j] = T[i * N + j];
            Im[i * m + i] = 1;
        }
        CHECK(dense_pair_solve(&part, Tm, Im, m));
        z.m = m;
        for (k = 0; k < 4; k++) {
            double bound = -1, error = 0;
            CHECK(hdi_lanczos_bound(&z, times[k], &bound, &e) == HD_OK);
            dense_pair_heat(&whole, times[k], start, want);
            memset(got, 0, N * sizeof *got);
            dense_pair_heat(&part, times[k], start, got);
            for (i = 0; i < N; i++) error = hypot(error, want[i] - got[i]);
            CHECK_MSG(error <= bound * (1 + 1e-9) + 1e-14, "m %d, t %g: error %g, bound %g", (int)m, times[k], error, bound);
            if (error > 1e-10 && times[k] <= 1) loosest = fmax(loosest, bound / error);
            hdi_lanczos_coefficients(&z, times[k], &set);
            CHECK_MSG(dense_max_diff(z.y, got, m) < 2e-13, "m %d, t %g: coefficients off by %g", (int)m, times[k],
                      dense_max_diff(z.y, got, m));
        }
        dense_pair_free(&part);
    }
    CHECK_MSG(loosest < 20, "bounds up to %g times the error", loosest);
    dense_pair_free(&whole);
    free(room);
}

/* (F(a) - F(b))/(a - b) of F(x) = exp(-tau (1/x - 1)) against long double, for a and b that are far from and very near each
 * other. */
static void int_silan_slopes(void) {
    static const double taus[7] = {0.01, 0.1, 1, 10, 30, 1000, 1e5};
    uint64_t seed = 19;
    int k;
    for (k = 0; k < 20000; k++) {
        const double a = pow(10, -6 * fabs(dense_signed(&seed))), near = pow(10, -17 * fabs(dense_signed(&seed))),
            tau = taus[k % 7];
        const double other = k % 3 == 0 ? pow(10, -6 * fabs(dense_signed(&seed))) : fmin(1, a * (1 + (k % 2 ? near : -near)));
        const double b = k % 97 == 0 ? a : other;
        const double fa = hdi_silan_decay(a, tau), fb = hdi_silan_decay(b, tau), got = hdi_silan_slope(a, fa, b, fb, tau);
        const double lost = fabs(a - b) > 0.05 * a ? 1e-14 * (fa + fb) / fabs(a - b) : 0;
        const long double high = a > b ? a : b, low = a > b ? b : a, d = high - low;
        long double want = expl(-tau * (1 / high - 1));
        if (d > 0) want *= -expm1l(-tau * d / (high * low)) / d;
        else want *= (long double)tau / (high * high);
        CHECK_MSG(fabs(got - (double)want) <= lost + 1e-290 + 1e-8 * (double)want, "a %.17g, b %.17g, tau %g: %g, not %g", a,
                  b, tau, got, (double)want);
    }
    CHECK(hdi_silan_decay(1, 30) == 1 && hdi_silan_decay(1.0000001, 30) == 1 && hdi_silan_decay(0, 3) == 0 &&
          hdi_silan_decay(-1e-17, 3) == 0);
    CHECK(hdi_silan_decay(1e-20, 0) == 1 && fabs(hdi_silan_decay(0.5, 2) - exp(-2)) < 1e-16 &&
          hdi_silan_slope(1e-18, 0, 1e-18, 0, 3) == 0);
}

/* Eigenvalues 1/(1 + g lambda) above one show that L is not semidefinite, but not where the solves themselves are off by as
 * much. */
static void int_ritz_above(void) {
    hdi_silan *z = DENSE_NEW(hdi_silan, 1);
    double known[2] = {1.05, 1};                 /* an eigenvalue, and its vector */
    hd_error e = int_no_error();
    hdi_ritz s;
    z->eigen[0] = known;
    z->eigen_m[0] = 1;
    z->f_norm[0] = z->whole[0] = 1;
    z->solved = 9;
    z->noise[0][0] = 1e-3;
    CHECK(hdi_silan_ritz(z, 0, 1, &s, &e) == HD_OK);
    z->noise[0][0] = 1e-5;
    CHECK(hdi_silan_ritz(z, 0, 1, &s, &e) < 0);
    free(z);
}

static hd_status int_elim(hdi_elim *m, const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    memset(m, 0, sizeof *m);
    memset(ctx, 0, sizeof *ctx);
    *e = int_no_error();
    return hdi_elim_make(m, lap, HD_ORDERING_AUTO, NULL, hdi_heat_scale(lap), ctx, e);
}

static void int_lane(hdi_lane *lane, const hd_laplacian *lap, int32_t r, hd_context *ctx, hd_error *e) {
    uint64_t seed = 21;
    int32_t i;
    memset(lane, 0, sizeof *lane);
    CHECK(hdi_lane_make(lane, lap, ctx, e) == HD_OK);
    for (i = 0; i < lap->n_active; i++) lane->f[i] = r == 0 ? i == 11 : r == 1 ? 1 + sin(0.2 * i) : dense_signed(&seed);
    hdi_pair_apply(lap, 0, 1, lane->f, lane->rhs);
    hdi_heat_measure(lap, lane);
}

/* The error of right-hand side r at time t after z's steps, relative to |f|; the answer is taken as a plan takes it. */
static double int_silan_error(hdi_silan *z, hdi_lane *lane, int32_t r, double t, const dense_pair *pair, double *y,
                              double *want) {
    hdi_silan_sum sum;
    hd_error e = int_no_error();
    int32_t i;
    memset(&sum, 0, sizeof sum);
    sum.count = r + 1;                           /* of several abreast, only this one is wanted */
    sum.u[r] = lane[r].u;
    sum.means[r] = lane[r].sums;
    for (i = 0; i <= r; i++) sum.y[i] = y + 45 * i;
    z->done[r] = z->steps;
    CHECK(hdi_silan_coefficients(z, r, t, y + 45 * r, &e) == HD_OK);
    hdi_silan_sum_run(z, &sum, z->m->ctx);
    CHECK(hdi_silan_answer(z, r, t, sum.y[r], 0, lane + r, &e) == HD_OK);
    z->done[r] = 0;
    dense_pair_heat(pair, t, lane[r].rhs, want);
    for (i = 0; i < pair->n; i++) want[i] -= lane[r].u[i];
    return dense_pair_norm(pair, want) / z->f_norm[r];
}

/* After each number of steps the bound against the error of the answer, for times from a third to three times the one that
 * the shift is made for, and far from it. wide: right-hand sides side by side. */
static void int_silan_bound_of(int kind, int32_t wide, double t) {
    static const double factors[5] = {0.03, 0.3, 1, 3, 30};
    hd_laplacian *lap = int_mesh(kind, kind ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active, k = wide == 1 ? 1 : 3;
    double *want = DENSE_NEW(double, n), *y = DENSE_NEW(double, 45 * 8), loosest = 0;
    hdi_silan *z = DENSE_NEW(hdi_silan, 1);
    hdi_ritz ritz;
    hd_context ctx;
    hd_error e;
    hdi_elim m;
    hdi_lane lane[3];
    dense_pair pair;
    int32_t r, step, looked = 0;
    int q;
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
    t *= lap->h * lap->h * m.scale;
    CHECK(dense_pair_solve(&pair, int_dense(m.lap, 1, 0, 0), int_dense(m.lap, 0, 1, 0), n));
    for (r = 0; r < k; r++) int_lane(lane + r, m.lap, r, &ctx, &e);
    CHECK(hdi_elim_shift(&m, hdi_krylov_shift(0, t, t, 0), &e) == HD_OK && m.shift / t > 0.05 && m.shift / t <= 0.2);
    z->wide = wide;
    z->m = &m;
    z->k = k;
    z->g = m.shift;
    CHECK(hdi_silan_start(z, lane, &ctx, &e) == HD_OK);
    for (step = 1; step <= 45; step++) {
        CHECK(hdi_silan_step(z, &ctx, &e) == HD_OK && z->steps == step);
        for (q = 0; q < 5 * k && (step <= 12 || step % 4 == 0); q++) {
            const double at = t * factors[q % 5], eps = 1e-15 * fmin(at * dense_max_abs(pair.lambda, n), 1e3) + 3e-14;
            double bound, error;
            r = q / 5;
            if (step > 1 && !(z->beta[step - 1][r] > 1e-13)) continue;
            CHECK(hdi_silan_ritz(z, r, step, &ritz, &e) == HD_OK);
            bound = hdi_ritz_bound(&ritz, at / z->g);
            error = int_silan_error(z, lane, r, at, &pair, y, want);
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
    hdi_silan_free(z, &ctx);
    for (r = 0; r < k; r++) hdi_lane_free(lane + r, &ctx);
    hdi_elim_free(&m);
    CHECK(ctx.bytes_in_use == 0);
    dense_pair_free(&pair);
    hd_laplacian_free(lap);
    free(z);
    free(y);
    free(want);
}

static void int_silan_bounds(void) {
    int q;
    for (q = 0; q < 12; q++) int_silan_bound_of(q / 2 % 2, q % 2 ? 8 : 1, pow(20, q / 4 - 0.5));
}

/* ---- [24] to [28]: damaged factors ---- */

typedef enum int_query {
    INT_APPLY, INT_COLUMN, INT_DIAGONAL, INT_ENTRIES, INT_TRACE, INT_CLASSICAL, INT_WEIGHTED, INT_COMMUTE, INT_BIHARMONIC
} int_query;
typedef struct int_damaged { int_query query; int32_t n_times; } int_damaged;
static const int_damaged int_damages[] = {
    {INT_APPLY, 1}, {INT_APPLY, 12}, {INT_COLUMN, 1}, {INT_COLUMN, 12}, {INT_DIAGONAL, 1}, {INT_DIAGONAL, 12},
    {INT_ENTRIES, 1}, {INT_TRACE, 1}, {INT_TRACE, 12}, {INT_CLASSICAL, 1}, {INT_CLASSICAL, 12}, {INT_WEIGHTED, 1},
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
        case INT_COLUMN: st = hd_heat_columns(heat, HD_KERNEL_OPERATOR, x->n_times, t, 1, i, out, 0, rep, NULL); break;
        case INT_DIAGONAL: st = hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, x->n_times, t, out, 0, rep, NULL); break;
        case INT_ENTRIES: st = hd_heat_entries(heat, HD_KERNEL_SYMMETRIC, x->n_times, t, 3, i, j, out, rep, NULL); break;
        case INT_TRACE: st = hd_heat_trace(heat, x->n_times, t, out, NULL, rep, NULL); break;
        default: st = heat_distance(heat, (hd_distance_kind)(x->query - INT_CLASSICAL), x->n_times, t, 1, i + 1, out, 0, rep);
    }
    CHECK_MSG(st >= 0, "query %d: %s", (int)x->query, rep->error.text);
    return x->query == INT_TRACE ? 1 : x->query == INT_ENTRIES ? 3 : n;
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
static void int_damages_seen(void) {
    size_t k;
    int way;
    for (k = 0; k < sizeof int_damages / sizeof *int_damages; k++)
        for (way = 0; way < 4; way++) {
            const int_damaged *x = int_damages + k;
            hd_laplacian *lap = int_mesh(1, way / 2 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
            const int64_t room = (x->n_times + 1) * (int64_t)lap->n;
            double t[12], *before = DENSE_NEW(double, 2 * room), *after = before + room, most = 0;
            hd_heat *heat = NULL;
            hd_heat_opts o;
            hd_report rep[2];
            int32_t n, q;
            memset(&o, 0, sizeof o);
            o.method = x->query <= INT_COLUMN && x->n_times > 1 ? HD_METHOD_KRYLOV : HD_METHOD_DIRECT;
            for (q = 0; q < 12; q++) t[q] = lap->h * lap->h * pow(1.4, q);
            CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
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
            hd_heat_free(heat);
            hd_laplacian_free(lap);
            free(before);
        }
}

/* Rows at which rounding is measured: largest diagonal entries of B^-1 L, and of L times a diagonal, and one that is named. */
static void int_probe_rows(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active;
    double *k = DENSE_NEW(double, n);
    uint64_t seed = 8;
    int32_t i, round, p;
    for (round = 0; round < 20; round++) {
        int32_t first = 0, second = 0, found = 0;
        hdi_probe probe;
        for (i = 0; i < n; i++) {
            k[i] = 1.5 + dense_signed(&seed);
            if (hdi_row_diagonal(lap, i) / lap->b_diag[i] > hdi_row_diagonal(lap, first) / lap->b_diag[first]) first = i;
            if (hdi_row_diagonal(lap, i) * k[i] > hdi_row_diagonal(lap, second) * k[second]) second = i;
        }
        probe = hdi_probe_rows(lap, k, round);
        for (p = 0; p < probe.k; p++) found |= (probe.row[p] == first) + 2 * (probe.row[p] == second) + 4 * (probe.row[p] == round);
        CHECK_MSG(found == 7 && probe.k <= 3, "rows %d, %d: %d", (int)first, (int)second, (int)found);
    }
    hd_laplacian_free(lap);
    free(k);
}

/* Pairs whose bound by the usual degree is too large take the highest one, as distances do, where eigenpairs are barred. */
static void int_pairs_degree(void) {
    hd_laplacian *lap = int_mesh(2, HD_LAPLACIAN_FEM);
    const int32_t i[3] = {5, 80, 300}, j[3] = {300, 81, 600};
    hd_heat *heat = NULL;
    hd_heat_opts o;
    hd_report rep;
    double d[3];
    memset(&o, 0, sizeof o);
    o.method = HD_METHOD_DIRECT;
    CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    heat->modes.barred = 1;
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, 150 * lap->h * lap->h, 3, i, j, NULL, d, &rep) == HD_OK);
    CHECK_MSG(rep.error_bound <= 1e-6 && rep.degree == 14, "degree %d, bound %g: %s", (int)rep.degree, rep.error_bound, rep.reason);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

/* Lists of pairs fall into parts of at most so many vertices, each as long as can be. */
static void int_pairs_few(void) {
    static const int32_t i[9] = {0, 0, 1, 5, 5, 2, 3, 3, 4}, j[9] = {1, 2, 1, 5, 5, 0, 4, 3, 4};
    static const int64_t want[6] = {1, 1, 1, 3, 6, 6};   /* pairs of at most so many vertices from the first on */
    int64_t most;
    for (most = 0; most < 6; most++) {
        int64_t mark[6] = {0};
        CHECK(hdi_pairs_few(i, j, 9, most, 1, mark) == want[most]);
        CHECK(hdi_pairs_few(i + 6, j + 6, 3, most, 2, mark) == (most < 2 ? 1 : 3));
    }
}

/* ---- [25] spectrum ---- */

/* The proof sees a pair that is taken away, and a shift too near; and the same pair twice is seen, wherever the two stand. */
static void int_spectrum_proof(void) {
    hd_laplacian *lap = int_mesh(2, HD_LAPLACIAN_FEM);
    hd_spectrum_opts o;
    hd_spectrum *twice = NULL;
    hd_context ctx;
    hd_error e;
    hdi_elim m;
    hdi_spec z;
    hdi_spec_goal goal;
    int32_t count = 0, i;
    goal.count = 40;
    goal.below = HUGE_VAL;
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
    CHECK(hdi_spec_make(&z, &m, goal.count, 1e-10, &e) >= 0 && hdi_spec_solve(&z, &goal, &count, &e) >= 0);
    CHECK(z.proven && count == 40 && z.below == hdi_spec_rank(&z, z.sigma) && hdi_spec_sure(&z));
    for (i = 20; i + 1 < z.found; i++) z.value[i] = z.value[i + 1];
    z.found--;
    CHECK(z.below == hdi_spec_rank(&z, z.sigma) + 1);
    z.value[7] = z.sigma * (1 + 1e-15);
    CHECK(!hdi_spec_sure(&z));
    hdi_spec_free(&z);
    hdi_elim_free(&m);
    memset(&o, 0, sizeof o);
    o.count = 30;
    for (i = 3; i < 29; i += 5) {
        CHECK(hd_spectrum_create(&twice, lap, &o, NULL) == HD_OK && hdi_spec_distinct(lap, twice));
        memcpy(twice->vector + 29 * (int64_t)twice->n, twice->vector + i * (int64_t)twice->n, (size_t)twice->n * sizeof(double));
        CHECK(!hdi_spec_distinct(lap, twice));
        hd_spectrum_free(twice);
    }
    hd_laplacian_free(lap);
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
    hdi_point point[100];
    double a[100];
    uint64_t key[200], sum, seed = 6;
    int32_t n, k, i, bad = 0;
    for (n = 1; n < 100; n += 7) {
        for (k = 0; k < n; k++) {
            for (i = 0, sum = 0; i < n; i++) {
                memset(point + i, 0, sizeof *point);
                a[i] = point[i].x[k % 3] = k % 2 ? (double)(dense_random(&seed) % 5) : dense_signed(&seed);
                point[i].id = i;
                key[i] = k % 2 ? dense_random(&seed) % 9 : dense_random(&seed);
                sum += key[i] * key[i];
            }
            (void)hdi_kth(a, n, k);
            hdi_select_point(point, n, k, k % 3);
            hdi_sort_keys(key, n, key + 100);
            for (i = 0; i < n; i++) {
                const double x = point[i].x[k % 3];
                bad += i < k ? a[i] > a[k] || x > point[k].x[k % 3] : a[i] < a[k] || x < point[k].x[k % 3];
                bad += i > 0 && key[i] < key[i - 1];
                sum -= key[i] * key[i];
            }
            bad += sum != 0 || a[k] != point[k].x[k % 3];    /* two ways, the same numbers */
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
    static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    double x[6][2] = {{0, 0}, {0.5, 0}, {0, 0.5}, {0.1, 0.1}, {0.25, 0.25}, {0, 0}}, line[3][2] = {{0, 0}, {1, 1}, {0.5, 0.5}};
    hdi_polygon g;
    int32_t k;
    g.n = 4;
    memcpy(g.x, square, sizeof square);
    CHECK(!hdi_polygon_clip(&g, 1, 1, 2) && g.n == 4 && hdi_polygon_area(&g) == 4);
    CHECK(hdi_polygon_clip(&g, 1, 1, 1) && g.n == 5 && fabs(hdi_polygon_area(&g) - 3.5) < 1e-15);
    CHECK(hdi_polygon_clip(&g, -1, 0, 0) && fabs(hdi_polygon_area(&g) - 1.5) < 1e-15);
    CHECK(hdi_polygon_clip_hull(&g, x, 6) && fabs(hdi_polygon_area(&g) - 0.125) < 1e-15);
    CHECK(hdi_polygon_clip_hull(&g, line, 3) && fabs(hdi_polygon_area(&g)) < 1e-15);
    CHECK(!hdi_polygon_clip(&g, 1, 0, 5));
    for (g.n = 0; g.n < HDI_CELL_SIDES; g.n++) {
        g.x[g.n][0] = 2 * cos(2 * acos(-1.0) * g.n / HDI_CELL_SIDES);
        g.x[g.n][1] = 2 * sin(2 * acos(-1.0) * g.n / HDI_CELL_SIDES);
    }
    for (k = 0; k < 2 * HDI_MOST_NEIGHBOURS; k++) CHECK(hdi_polygon_clip(&g, cos(acos(-1.0) * (k * 101 % 256) / 128),
        sin(acos(-1.0) * (k * 101 % 256) / 128), 1));
    CHECK(g.n == 2 * HDI_MOST_NEIGHBOURS && g.n <= HDI_POLYGON_MOST);
}

static void int_all(void) {
    int_division();
    int_complex();
    int_sizes();
    int_texts();
    int_tally();
    int_sums();
    int_megabytes();
    int_arrays();
    int_memory();
    int_large_pages();
    int_scope_room();
    int_sorting();
    int_union_find();
    int_tridiagonal();
    int_tridiagonal_odd();
    int_collinear();
    int_norm();
    int_cuthill_mckee();
    int_amd_dense();
    int_nd_path_moves();
    int_nd_path_clusters();
    int_nd_sides();
    int_nd_leaves();
    int_amd_steps();
    int_nd_moves();
    int_nd_buckets();
    int_nd_alone();
    int_nd_copies();
    int_nd_by_number();
    int_nd_refined();
    int_nd_sweeps();
    int_nd_sweep_values();
    int_nd_first_cuts();
    int_nd_clusters();
    int_nd_flows();
    int_nd_curve();
    int_nd_halves_of_clusters();
    int_nd_halvings();
    int_nd_fill();
    int_krylov_done();
    int_ildl_trees();
    int_ildl_row_sums();
    int_precond_make();
    int_factors();
    int_schedules();
    int_checks();
    int_noise_weights();
    int_pole_bounds();
    int_resolvent_pole();
    int_no_numbers();
    int_lanczos_bound();
    int_silan_slopes();
    int_ritz_above();
    int_silan_bounds();
    int_damages_seen();
    int_probe_rows();
    int_pairs_degree();
    int_pairs_few();
    int_spectrum_proof();
    int_least_squares();
    int_exp_rest();
    int_shared_bounds();
    int_length_area();
    int_around();
    int_selection();
    int_eigen3();
    int_polygon();
}

int main(int argc, char **argv) {
#if HDI_THREADS
    GUARD_THREADS(sizeof(hd_threads));
#endif
    if (argc > 1 && (strcmp(argv[1], "--traps") != 0 || !test_traps_start())) {
        fprintf(stderr, "usage: internals [--traps]; traps are those of glibc on x86\n");
        return 2;
    }
    int_all();
    printf("%lld passed, %lld failed\n", (long long)int_passed, (long long)int_failed);
    return int_failed > 0;
}
