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

/* ---- [15] krylov: directions without constants ---- */

static void int_deflation(void) {
    enum { N = 30 };
    hd_laplacian *lap = int_path(N);
    hdi_krylov k;
    hdi_precond none;
    hdi_upper up;
    hd_context ctx;
    hd_error e = int_no_error();
    hd_c64 r[N], z[N], p[N], sums[1], mean = hdi_c(0, 0), dot, want = hdi_c(0, 0);
    uint64_t seed = 2;
    int32_t i;
    memset(&ctx, 0, sizeof ctx);
    memset(&k, 0, sizeof k);
    CHECK(hdi_upper_make(&up, &lap->L, &ctx, &e) == HD_OK);
    k.a.lap = lap;
    k.sums = sums;
    memset(&none, 0, sizeof none);
    none.up = &up;
    none.kind = HD_PRECOND_NONE;
    k.m = &none;
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
    CHECK(heat_column(heat, 100 * lap->h * lap->h, 3, u, &rep) >= 0 && rep.n_poles == 5);
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

/* ---- [07] kernels: real fronts ---- */

static double int_off(const double *a, const double *b, int64_t n) {
    return dense_max_diff(a, b, n) / (1 + dense_max_abs(b, n));
}

static void int_noise(double *x, int64_t n, uint64_t *seed) {
    int64_t i;
    for (i = 0; i < n; i++) x[i] = dense_signed(seed);
}

/* Memory of zeros whose end is that of a page, where the system is asked for pages: nothing can be read behind it. */
#if HDI_LARGE_PAGES && defined(MAP_ANONYMOUS)
enum { INT_PAGE = 65536 };
static size_t int_edge_whole(size_t bytes) { return (bytes + INT_PAGE - 1) / INT_PAGE * INT_PAGE; }
static void *int_edge(int64_t count, size_t size) {
    const size_t bytes = (size_t)count * size, whole = int_edge_whole(bytes);
    char *p = (char *)mmap(NULL, whole + INT_PAGE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED || mprotect(p + whole, INT_PAGE, PROT_NONE) != 0) {
        fprintf(stderr, "internals: out of memory\n");
        exit(2);
    }
    return p + whole - bytes;
}
static void int_edge_free(void *p, int64_t count, size_t size) {
    const size_t bytes = (size_t)count * size, whole = int_edge_whole(bytes);
    CHECK(munmap((char *)p + bytes - whole, whole + INT_PAGE) == 0);
}
#else
static void *int_edge(int64_t count, size_t size) { return dense_alloc(count, size); }
static void int_edge_free(void *p, int64_t count, size_t size) {
    (void)count;
    (void)size;
    free(p);
}
#endif
#define INT_EDGE(type, count) ((type *)int_edge(count, sizeof(type)))
#define INT_EDGE_FREE(p, count) int_edge_free(p, count, sizeof *(p))

/* A front by its definition: a random one of p pivots and u rows below, and L, D and what is left of the update. */
typedef struct int_real { int32_t p, u, m; double *P, *U, *L, *left; } int_real;

static int64_t int_packed(int64_t u, int64_t i, int64_t j) { return j * u - j * (j - 1) / 2 - j + i; }

static int_real int_real_make(int32_t p, int32_t u, uint64_t seed) {
    const double beside = p % 2 ? (double)NAN : 7;
    int_real f;
    int64_t m = p + u, i, j, k;
    f.p = p;
    f.u = u;
    f.m = p + u;
    f.P = INT_EDGE(double, m * p);
    f.U = INT_EDGE(double, (int64_t)u * (u + 1) / 2);
    f.L = DENSE_NEW(double, m * p);
    f.left = DENSE_NEW(double, (int64_t)u * (u + 1) / 2);
    for (j = 0; j < p; j++) {
        for (i = 0; i < m; i++) f.L[i + j * m] = i < j ? beside : i > j ? dense_signed(&seed) : (double)(j % 3 ? m : -m);
    }
    for (i = 0; i < (int64_t)u * (u + 1) / 2; i++) f.U[i] = f.left[i] = dense_signed(&seed);
    memcpy(f.P, f.L, (size_t)(m * p) * sizeof *f.P);     /* above the diagonal nothing is read, nor written */
    for (k = 0; k < p; k++) {
        const double d = f.L[k + k * m];
        for (j = k + 1; j < m; j++) {
            const double s = f.L[j + k * m] / d;
            for (i = j; i < m; i++) *(j < p ? f.L + i + j * m : f.left + int_packed(u, i - p, j - p)) -= f.L[i + k * m] * s;
        }
        for (i = k + 1; i < m; i++) f.L[i + k * m] /= d;
    }
    return f;
}

/* The factorisation, its rows and those of the update in pieces that do not begin with tiles. */
static void int_real_factor(const hdi_real_ops *o, const int_real *f, double *dinv, const char *what) {
    double *S = DENSE_NEW(double, hdi_real_s_size(f->p)), *work = DENSE_NEW(double, hdi_real_work(f->u, f->p)), off = 0;
    const int64_t m = f->m, u = f->u;
    hdi_pivots pivots;
    int64_t i, j, at;
    int32_t k, negative = 0;
    hdi_pivots_clear(&pivots);
    for (k = 0; k < f->p; k += HDI_REAL_NB) {
        const int32_t nb = f->p - k < HDI_REAL_NB ? f->p - k : HDI_REAL_NB, kb = k + nb;
        const int64_t end = kb + (kb <= HDI_REAL_KC ? (m - kb) / 2 : 0), middle = end + (m - end) / 3;
        CHECK(hdi_real_block(o, f->P, m, k, nb, end, S, dinv, &pivots, work) == -1);
        hdi_real_rows(o, f->P, m, k, nb, S, kb, dinv, middle, m, work);
        hdi_real_rows(o, f->P, m, k, nb, S, kb, dinv, end, middle, work);
    }
    for (at = 0; at < u; at = i) {
        i = hdi_least(u, at + 1 + (at * 7 + 5) % 97);
        hdi_real_update(o, f->U, u, f->P, m, f->p, work, at, i);
    }
    for (j = 0; j < f->p; j++) {
        off += memcmp(f->P + j * m, f->L + j * m, (size_t)j * sizeof *f->L) != 0;
        for (i = j; i < m; i++) off = fmax(off, fabs(f->P[i + j * m] - f->L[i + j * m]) / (i == j ? (double)m : 1));
        off = fmax(off, fabs(dinv[j] * f->L[j + j * m] - 1));
        negative += f->L[j + j * m] < 0;
    }
    CHECK_MSG(off < 1e-13, "%s: L is off by %g", what, off);
    CHECK(pivots.negative == negative);
    if (u > 0) off = dense_max_diff(f->U, f->left, u * (u + 1) / 2);
    CHECK_MSG(off < 1e-13, "%s: the update is off by %g", what, off);
    free(S);
    free(work);
}

/* Solves with L for one right-hand side and for eight, against its definition. */
static void int_real_solves(const hdi_real_ops *o, const int_real *f, const double *dinv, const char *what) {
    const int64_t m = f->m, p = f->p, u = f->u;
    double *y = DENSE_NEW(double, 8 * p), *t = DENSE_NEW(double, 8 * u), *want = DENSE_NEW(double, 8 * m), *x = DENSE_NEW(double, 16 * (u + 1)),
        *top = INT_EDGE(double, 8 * p), *below = INT_EDGE(double, 8 * u), *work = INT_EDGE(double, u);
    int32_t *idx = INT_EDGE(int32_t, u), w, first, k;
    uint64_t seed = 3;
    int64_t i, j, r;
    int_noise(y, 8 * p, &seed);
    int_noise(t, 8 * u, &seed);
    int_noise(x, 16 * (u + 1), &seed);
    for (i = 0; i < u; i++) idx[i] = (int32_t)(2 * (i * 2 % (u | 1)) + i % 2);   /* the rows of x below */
    for (w = 1; w <= 8; w += 7) {
        double *a = top + (8 - w) * p, *b = below + (8 - w) * u, off;
        for (first = 0; first < (w == 1 ? 2 : 1); first++) {     /* first: b is not read */
            memcpy(a, y, (size_t)(w * p) * sizeof *y);
            for (i = 0; i < w * u; i++) b[i] = first ? (double)NAN : t[i];
            for (i = 0; i < w * m; i++) want[i] = i < w * p ? y[i] : first ? 0 : t[i - w * p];
            for (j = 0; j < p; j++)
                for (i = j + 1; i < m; i++)
                    for (r = 0; r < w; r++) want[w * i + r] -= f->L[i + j * m] * want[w * j + r];
            for (k = 0; k < p; k += 8) {
                const int32_t nc = p - k < 8 ? (int32_t)p - k : 8;
                if (w == 1) o->forward(a + k, f->P + k + k * m, m, nc, p - k - nc, b, u, first && k == 0);
                else if (k) o->gemv8(a + 8 * k, NULL, f->P + k, m, nc, a, k);
                if (w == 8) o->lower8(a + 8 * k, f->P + k + k * m, m, nc);
            }
            if (w == 8 && u > 0) o->gemv8(b, NULL, f->P + p, m, u, a, (int32_t)p);
            off = fmax(dense_max_diff(a, want, w * p), u > 0 ? dense_max_diff(b, want + w * p, w * u) : 0);
            CHECK_MSG(off < 1e-13, "%s: %d forward off by %g", what, (int)w, off);
        }
        memcpy(a, y, (size_t)(w * p) * sizeof *y);
        for (j = p - 1; j >= 0; j--)
            for (r = 0; r < w; r++) {
                double sum = y[w * j + r] / f->L[j + j * m];
                for (i = j + 1; i < m; i++) sum -= f->L[i + j * m] * (i < p ? want[w * i + r] : x[w * idx[i - p] + r]);
                want[w * j + r] = sum;
            }
        if (w == 1) hdi_real_backward(o, f->P, m, (int32_t)p, dinv, a, x, idx, work);
        else hdi_real_backward8(o, f->P, m, (int32_t)p, dinv, a, x, idx);
        off = dense_max_diff(a, want, w * p);
        CHECK_MSG(off < 1e-13, "%s: %d backward off by %g", what, (int)w, off);
    }
    free(y);
    free(t);
    free(want);
    free(x);
    INT_EDGE_FREE(top, 8 * p);
    INT_EDGE_FREE(below, 8 * u);
    INT_EDGE_FREE(work, u);
    INT_EDGE_FREE(idx, u);
}

/* The update of a child of u rows into a front that has more. every: rows between those of the child. */
static void int_real_child(const hdi_real_ops *o, const int_real *f, int32_t every, const char *what) {
    const int64_t m = f->m, u = f->u;
    const int64_t uc = m / every;
    double *child = DENSE_NEW(double, uc * (uc + 1) / 2), *P = DENSE_NEW(double, m * f->p), *U = DENSE_NEW(double, u * (u + 1) / 2),
        *want_p = DENSE_NEW(double, m * f->p), *want_u = DENSE_NEW(double, u * (u + 1) / 2);
    int32_t *rel = DENSE_NEW(int32_t, uc);
    uint64_t seed = 4;
    int64_t i, j;
    int_noise(child, uc * (uc + 1) / 2, &seed);
    for (i = 0; i < uc; i++) rel[i] = (int32_t)(i * every + (every > 1 ? i % 2 : 0));
    for (j = 0; j < uc; j++)
        for (i = j; i < uc; i++)
            *(rel[j] < f->p ? want_p + rel[i] + rel[j] * m : want_u + int_packed(u, rel[i] - f->p, rel[j] - f->p)) += child[int_packed(uc, i, j)];
    hdi_real_extend(o, P, m, f->p, U, child, uc, rel, uc / 3, uc);
    hdi_real_extend(o, P, m, f->p, U, child, uc, rel, 0, uc / 3);
    CHECK_MSG(memcmp(P, want_p, (size_t)(m * f->p) * sizeof *P) == 0 && memcmp(U, want_u, (size_t)(u * (u + 1) / 2) * sizeof *U) == 0,
              "%s: a child of every %d. row", what, (int)every);
    free(child);
    free(P);
    free(U);
    free(want_p);
    free(want_u);
    free(rel);
}

static void int_real_kernels(void) {
    static const int32_t sizes[][2] = {{1, 0}, {1, 3}, {2, 5}, {3, 1}, {4, 70}, {5, 9}, {7, 12}, {8, 24}, {9, 25}, {13, 30}, {24, 50}, {63, 11},
                                       {64, 64}, {65, 100}, {129, 0}, {150, 41}, {200, 120}, {20, 530}};
    static const hd_simd simds[4] = {HD_SIMD_AUTO, HD_SIMD_NONE, HD_SIMD_AVX2, HD_SIMD_AVX512};
    const int best = hdi_simd_best();
    hd_context ctx;
    char what[60];
    int level, k;
    for (level = 0; level <= best; level++) {
        const hdi_real_ops *o = hdi_real_ops_get(level);
        for (k = 0; k < (int)(sizeof sizes / sizeof *sizes); k++) {
            int_real f = int_real_make(sizes[k][0], sizes[k][1], 5);
            double *dinv = DENSE_NEW(double, f.p);
            sprintf(what, "level %d, %d pivots, %d rows", level, (int)f.p, (int)f.u);
            int_real_factor(o, &f, dinv, what);
            int_real_solves(o, &f, dinv, what);
            int_real_child(o, &f, 1, what);
            int_real_child(o, &f, 3, what);
            free(dinv);
            INT_EDGE_FREE(f.P, (int64_t)f.m * f.p);
            INT_EDGE_FREE(f.U, (int64_t)f.u * (f.u + 1) / 2);
            free(f.L);
            free(f.left);
        }
    }
    memset(&ctx, 0, sizeof ctx);
    for (k = 0; k < 4; k++) {                    /* the set that is asked for, or the best one below it */
        ctx.simd = simds[k];
        CHECK(hdi_simd_level(&ctx) == (k == 0 || k - 1 > best ? best : k - 1));
    }
}

/* ---- [07] kernels: packs ---- */

/* Products of all shapes about the tiles' sizes, whole, lower triangles, packed, stored or subtracted, columns from somewhere in the middle. */
static void int_pack_multiply(const hdi_pack_ops *ops, int level) {
    const hdi_pack_ops *plain = hdi_pack_ops_get(0);
    enum { ROWS = 53, COLS = 11, DEPTH = 9, SIZE = HDI_PACK * ROWS * (ROWS + 1) };
    double *a = DENSE_NEW(double, SIZE), *b = DENSE_NEW(double, SIZE), *c = DENSE_NEW(double, SIZE), *d = DENSE_NEW(double, SIZE),
        *start = DENSE_NEW(double, SIZE);
    uint64_t seed = 3;
    int k;
    int_noise(a, SIZE, &seed);
    int_noise(b, SIZE, &seed);
    int_noise(start, SIZE, &seed);
    for (k = 0; k < 3000; k++) {
        hdi_pack_job g;
        int64_t i0, i1, j0, j1;
        memset(&g, 0, sizeof g);
        g.lower = (int)(dense_random(&seed) % 2);
        g.packed = g.lower && dense_random(&seed) % 2;
        g.store = (int)(dense_random(&seed) % 2);
        g.depth = (int64_t)(dense_random(&seed) % DEPTH);
        i1 = 1 + (int64_t)(dense_random(&seed) % (k % 10 ? 12 : ROWS));
        i0 = (int64_t)(dense_random(&seed) % (uint64_t)i1);
        j1 = 1 + (int64_t)(dense_random(&seed) % (g.lower ? (uint64_t)i1 : COLS));
        j0 = (int64_t)(dense_random(&seed) % (uint64_t)j1);
        g.b_first = j0 > 0 ? (int64_t)(dense_random(&seed) % (uint64_t)(j0 + 1)) : 0;
        if (dense_random(&seed) % 2) { g.a_row = HDI_PACK * DEPTH; g.a_col = HDI_PACK; }
        else { g.a_row = HDI_PACK; g.a_col = HDI_PACK * ROWS; }
        if (dense_random(&seed) % 2) { g.b_row = HDI_PACK * DEPTH; g.b_col = HDI_PACK; }
        else { g.b_row = HDI_PACK; g.b_col = HDI_PACK * ROWS; }
        g.c_row = HDI_PACK * ROWS;
        g.a = a;
        g.b = b;
        memcpy(c, start, SIZE * sizeof *c);
        memcpy(d, start, SIZE * sizeof *d);
        g.c = c;
        ops->multiply(&g, i0, i1, j0, j1);
        g.c = d;
        plain->multiply(&g, i0, i1, j0, j1);
        if (dense_max_diff(c, d, SIZE) > 1e-13) {
            CHECK_MSG(0, "level %d: rows %d..%d, columns %d..%d, depth %d, lower %d, packed %d: off by %g", level, (int)i0, (int)i1, (int)j0,
                (int)j1, (int)g.depth,
                      g.lower, g.packed, dense_max_diff(c, d, SIZE));
            break;
        }
    }
    CHECK(k == 3000);
    free(a);
    free(b);
    free(c);
    free(d);
    free(start);
}

static void int_pack_others(const hdi_pack_ops *ops, int level) {
    const hdi_pack_ops *plain = hdi_pack_ops_get(0);
    enum { ROWS = 23, COLS = 17, SIZE = HDI_PACK * ROWS * COLS };
    static double a[SIZE], x[SIZE], y[SIZE], s[SIZE], d[SIZE], e[SIZE];
    int32_t row[ROWS];
    uint64_t seed = 7;
    int32_t n, p, i;
    int_noise(a, SIZE, &seed);
    int_noise(s, SIZE, &seed);
    int_noise(d, SIZE, &seed);
    int_noise(e, SIZE, &seed);
    for (i = 0; i < ROWS; i++) row[i] = i * 2 % ROWS;
    for (n = 0; n <= 13; n++) {
        for (p = 0; p <= COLS; p++) {
            hdi_pack_rows g;
            const int64_t most = SIZE;
            memset(&g, 0, sizeof g);
            g.row = HDI_PACK * COLS;
            g.first = 3;
            g.s = s;
            g.s_row = HDI_PACK * COLS;
            g.dinv = d;
            g.nb = p < 16 ? p : 16;
            memcpy(x, a, sizeof x);
            memcpy(y, a, sizeof y);
            g.panel = x;
            ops->solve_rows(&g, 5, 5 + n);
            g.panel = y;
            plain->solve_rows(&g, 5, 5 + n);
            CHECK_MSG(int_off(x, y, most) < 1e-13, "level %d: solve_rows %d x %d off by %g", level, (int)n, (int)p, int_off(x, y, most));
            ops->scale(a, HDI_PACK * COLS, 2, 2 + n, p / 3, p, d, x);
            plain->scale(a, HDI_PACK * COLS, 2, 2 + n, p / 3, p, d, y);
            CHECK_MSG(int_off(x, y, most) < 1e-13, "level %d: scale %d x %d off by %g", level, (int)n, (int)p, int_off(x, y, most));
            ops->add(x, a, row, p / 4, n, -1);
            plain->add(y, a, row, p / 4, n, -1);
            CHECK_MSG(int_off(x, y, most) < 1e-13, "level %d: add %d..%d off by %g", level, (int)(p / 4), (int)n, int_off(x, y, most));
            ops->forward(a, n, p, e, x);
            plain->forward(a, n, p, e, y);
            CHECK_MSG(int_off(x, y, most) < 1e-13, "level %d: forward %d x %d off by %g", level, (int)n, (int)p, int_off(x, y, most));
            ops->backward(a, NULL, n, p, x, e);
            plain->backward(a, NULL, n, p, y, e);
            ops->backward(a, row, n, p, x, e);
            plain->backward(a, row, n, p, y, e);
            CHECK_MSG(int_off(x, y, most) < 1e-13, "level %d: backward %d x %d off by %g", level, (int)n, (int)p, int_off(x, y, most));
        }
    }
}

static void int_pack_kernels(void) {
    int level;
    for (level = 0; level <= hdi_simd_best(); level++) {
        int_pack_multiply(hdi_pack_ops_get(level), level);
        int_pack_others(hdi_pack_ops_get(level), level);
    }
}

/* ---- [11] symbolic: trees, counts, supernodes, places ---- */

/* Symmetric patterns, diagonal included: a mesh, a random graph that falls apart, a path, a star, a full matrix, no edge at all. */
static hd_csr int_pattern(int kind, uint64_t seed) {
    const int32_t n = kind == 0 ? 0 : 40 + 7 * kind;
    int32_t *i, *j, a, b, m = n;
    int64_t c = 0;
    hd_csr out;
    hd_error e = int_no_error();
    shape s;
    memset(&s, 0, sizeof s);
    if (kind == 0) {
        s = shape_grid(13, 11, 0.3);
        m = s.n;
    }
    i = DENSE_NEW(int32_t, kind ? n * n + n : 7 * s.n_tri + m);
    j = DENSE_NEW(int32_t, kind ? n * n + n : 7 * s.n_tri + m);
    for (a = 0; a < m; a++) {
        i[c] = j[c] = a;
        c++;
    }
    for (a = 0; a < 3 * s.n_tri; a++) {
        i[c] = s.tri[a];
        j[c++] = s.tri[a % 3 == 2 ? a - 2 : a + 1];
        i[c] = s.tri[a % 3 == 2 ? a - 2 : a + 1];
        j[c++] = s.tri[a];
    }
    for (a = 0; a < n; a++) {
        for (b = 0; b < a; b++) {
            const int join = kind == 1 ? dense_random(&seed) % (uint64_t)n < 2 : kind == 2 ? b == a - 1 : kind == 3 ? b == 0 : kind == 4;
            if (!join) continue;
            i[c] = a; j[c++] = b;
            i[c] = b; j[c++] = a;
        }
    }
    memset(&out, 0, sizeof out);
    CHECK(hd_csr_from_triplets(&out, m, m, c, i, j, NULL, NULL, &e) == HD_OK);
    free(i);
    free(j);
    shape_free(&s);
    return out;
}

/* l [n n]: where L of P A P' has entries, diagonal included, by elimination. */
static char *int_fill(const hd_csr *a, const int32_t *perm) {
    const int32_t n = a->n_rows;
    char *l = DENSE_NEW(char, (int64_t)n * n + 1);
    int32_t *inv = DENSE_NEW(int32_t, n), i, j, k;
    int64_t p;
    for (i = 0; i < n; i++) inv[perm[i]] = i;
    for (i = 0; i < n; i++) {
        l[i * n + i] = 1;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            if (inv[a->col[p]] < inv[i]) l[inv[i] * n + inv[a->col[p]]] = 1;
    }
    for (k = 0; k < n; k++)
        for (i = k + 1; i < n; i++)
            for (j = k + 1; l[i * n + k] && j <= i; j++)
                if (l[j * n + k]) l[i * n + j] = 1;
    free(inv);
    return l;
}

/* Memory by entries: who has which; -1 nobody. */
typedef struct int_space { int32_t *owner; int64_t size; } int_space;

static void int_space_take(int_space *m, int64_t at, int64_t size, int32_t who, const char *what) {
    int64_t p, clash = 0;
    CHECK_MSG(at >= 0 && at + size <= m->size, "%s: [%lld,%lld) of %lld", what, (long long)at, (long long)(at + size), (long long)m->size);
    for (p = at; p < at + size && p < m->size; p++) {
        clash += m->owner[p] >= 0;
        m->owner[p] = who;
    }
    CHECK_MSG(clash == 0, "%s: %lld entries of %d are another's", what, (long long)clash, (int)who);
}

static void int_space_free(int_space *m, int64_t at, int64_t size, int32_t who, const char *what) {
    int64_t p, lost = 0;
    for (p = at; p < at + size && p < m->size; p++) {
        lost += m->owner[p] != who;
        m->owner[p] = -1;
    }
    CHECK_MSG(lost == 0, "%s: %lld entries of %d were overwritten", what, (long long)lost, (int)who);
}

/* One step of the plan: v takes its place while its children hold theirs, then they let go. */
static void int_place_front(const hdi_symbolic *s, int_space *m, int32_t v, int triangle, const int64_t *at, const char *what) {
    const int64_t u = s->row_ptr[v + 1] - s->row_ptr[v];
    int32_t k;
    int_space_take(m, at[v], triangle ? hdi_triangle(u) : u, v, what);
    for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
        const int64_t below = s->row_ptr[s->kid[k] + 1] - s->row_ptr[s->kid[k]];
        int_space_free(m, at[s->kid[k]], triangle ? hdi_triangle(below) : below, s->kid[k], what);
    }
}

/* The tasks in turn, step by step, as if all ran at the same time; then the top. Nobody touches what another still needs. */
static void int_places(const hdi_symbolic *s, int triangle, const int64_t *at, int64_t size, const char *what) {
    int_space m;
    int32_t *next = DENSE_NEW(int32_t, s->n_tasks), k, left = s->n_tasks;
    int64_t p, held = 0;
    m.size = size;
    m.owner = DENSE_NEW(int32_t, size);
    for (p = 0; p < size; p++) m.owner[p] = -1;
    for (k = 0; k < s->n_tasks; k++) next[k] = s->task_begin[k];
    while (left > 0) {
        for (k = left = 0; k < s->n_tasks; k++) {
            if (next[k] >= s->task_end[k]) continue;
            int_place_front(s, &m, next[k]++, triangle, at, what);
            left++;
        }
    }
    for (k = 0; k < s->n_top && triangle; k++) int_place_front(s, &m, s->top[k], triangle, at, what);
    for (k = 0; k < s->n_top && !triangle; k++) int_space_take(&m, at[s->top[k]], s->row_ptr[s->top[k] + 1] - s->row_ptr[s->top[k]], s->top[k], what);
    for (p = 0; p < size && !triangle; p++) m.owner[p] = -1;             /* in any order, so that all stay */
    for (p = 0; p < size; p++) held += m.owner[p] >= 0;
    CHECK_MSG(held == 0, "%s: %lld entries are never let go", what, (long long)held);
    free(next);
    free(m.owner);
}

static void int_symbolic_one(const hd_csr *a, int32_t *perm, int dense, const char *what) {
    const int32_t n = a->n_rows;
    int32_t *seen = DENSE_NEW(int32_t, n + 1), v, k, i, j;
    hdi_symbolic s;
    hd_context ctx;
    hd_error e = int_no_error();
    int64_t p, nnz = 0, wrong = 0, entries = 0;
    double flops = 0;
    char *l;
    memset(&ctx, 0, sizeof ctx);
    hdi_error_clear(&e);
    CHECK_MSG(hdi_symbolic_make(&s, a, perm, &ctx, &e) == HD_OK, "%s", e.text);
    for (i = 0; i < n; i++) seen[s.perm[i]]++;
    for (i = 0; i < n; i++) wrong += seen[i] != 1;
    CHECK_MSG(wrong == 0, "%s: not a permutation", what);
    CHECK(s.super[0] == 0 && s.super[s.n_super] == n);
    memset(seen, 0, ((size_t)n + 1) * sizeof *seen);
    for (v = 0; v < s.n_super; v++) {
        CHECK_MSG(s.super[v] < s.super[v + 1], "%s: supernode %d is empty", what, (int)v);
        for (i = s.super[v]; i < s.super[v + 1]; i++) CHECK(s.super_of[i] == v);
        CHECK(s.parent[v] == -1 || (s.parent[v] > v && s.parent[v] < s.n_super));
        CHECK_MSG((s.parent[v] == -1) == (s.row_ptr[v] == s.row_ptr[v + 1]), "%s: %d", what, (int)v);
        for (p = s.row_ptr[v]; p < s.row_ptr[v + 1]; p++) {
            const int32_t up = s.parent[v], width = s.super[up + 1] - s.super[up], at = s.rel[p];
            CHECK(s.row[p] >= (p > s.row_ptr[v] ? s.row[p - 1] + 1 : s.super[v + 1]) && s.row[p] < n);
            CHECK(at >= 0 && (at < width ? s.super[up] + at : s.row[s.row_ptr[up] + at - width]) == s.row[p]);    /* its row there is the same row */
        }
        for (k = s.kid_ptr[v]; k < s.kid_ptr[v + 1]; k++) {
            CHECK(s.parent[s.kid[k]] == v);
            seen[s.kid[k]]++;
        }
        for (p = s.a_ptr[v]; p < s.a_ptr[v + 1]; p++) {
            const int32_t width = s.super[v + 1] - s.super[v], r = s.a_row[p], row = r < width ? s.super[v] + r : s.row[s.row_ptr[v] + r - width];
            for (i = 0; a->row_ptr[i + 1] <= s.a_from[p]; i++) {}
            CHECK(s.perm[s.super[v] + s.a_col[p]] == i && s.perm[row] == a->col[s.a_from[p]] && row >= s.super[v] + s.a_col[p]);
            entries++;
        }
    }
    CHECK_MSG(entries == (a->nnz + n) / 2, "%s: %lld entries of the lower triangle", what, (long long)entries);
    for (v = 0; v < s.n_super; v++) CHECK(seen[v] == (s.parent[v] >= 0));
    memset(seen, 0, ((size_t)n + 1) * sizeof *seen);     /* tasks and top share out the supernodes, parents outside of a task are in the top */
    for (k = 0; k < s.n_tasks; k++) {
        for (v = s.task_begin[k]; v < s.task_end[k]; v++) {
            seen[v]++;
            CHECK(s.task_of[v] == k && (s.parent[v] < 0 || s.task_of[s.parent[v]] == k || s.task_of[s.parent[v]] < 0));
        }
    }
    for (k = 0; k < s.n_top; k++) {
        seen[s.top[k]]++;
        CHECK(s.task_of[s.top[k]] == -1 - k && (k == 0 || s.top[k] > s.top[k - 1]));
    }
    for (v = 0; v < s.n_super; v++) CHECK_MSG(seen[v] == 1, "%s: supernode %d is worked on %d times", what, (int)v, (int)seen[v]);
    int_places(&s, 1, s.update, s.work, what);
    int_places(&s, 0, s.vector, s.vector_size, what);
    if (dense) {
        l = int_fill(a, s.perm);
        for (j = 0; j < n; j++) {
            int64_t count = 0;
            for (i = j; i < n; i++) {
                int32_t inside = s.super_of[i] == s.super_of[j];
                if (!l[i * n + j]) continue;
                count++;
                for (p = s.row_ptr[s.super_of[j]]; p < s.row_ptr[s.super_of[j] + 1]; p++) inside |= s.row[p] == i;
                CHECK_MSG(inside, "%s: entry (%d,%d) of L has no place", what, (int)i, (int)j);
            }
            nnz += count;
            flops += (double)count * (double)count;
        }
        CHECK_MSG(nnz == s.nnz && flops == s.flops && s.flops_done >= s.flops, "%s: %lld non-zeros and %g flops, not %lld and %g", what,
            (long long)s.nnz, s.flops,
                  (long long)nnz, flops);
        free(l);
    }
    hdi_symbolic_free(&ctx, &s);
    CHECK(ctx.bytes_in_use == 0);
    free(seen);
}

/* The tree and the counts of columns by their definitions. */
static void int_tree_one(const hd_csr *a, const int32_t *order, const char *what) {
    const int32_t n = a->n_rows, n1 = n + 1;
    int32_t *perm = DENSE_NEW(int32_t, n1), *plain = DENSE_NEW(int32_t, n1), i, j, k;
    char *l = int_fill(a, order);
    hdi_sym_job job;
    hdi_sym_work w;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_scope s;
    memset(&ctx, 0, sizeof ctx);
    s = hdi_scope_begin(&ctx, &e);
    hdi_sym_work_take(&w, a, &s);
    CHECK(e.status == HD_OK);
    memcpy(perm, order, (size_t)n * sizeof *perm);
    memset(&job, 0, sizeof job);
    job.a = a;
    job.perm = perm;
    job.w = &w;
    hdi_sym_triangle(&job, &ctx);
    hdi_sym_etree(n, &w, plain, w.head);
    for (j = 0; j < n; j++) {
        for (i = j + 1; i < n && !l[i * n + j]; i++) {}
        CHECK_MSG(plain[j] == (i < n ? i : -1), "%s: parent of %d is %d", what, (int)j, (int)plain[j]);
    }
    free(l);
    hdi_sym_tree(a, perm, &w, &ctx);
    l = int_fill(a, perm);
    for (j = 0; j < n; j++) {
        int32_t first = -1;
        for (i = j, k = 0; i < n; i++) {
            k += l[i * n + j];
            if (i > j && l[i * n + j] && first < 0) first = i;
        }
        CHECK_MSG(w.count[j] == k, "%s: column %d has %d entries, not %d", what, (int)j, (int)k, (int)w.count[j]);
        CHECK_MSG(w.parent[j] == first, "%s: postordered, the parent of %d is %d, not %d", what, (int)j, (int)first, (int)w.parent[j]);
        CHECK(j == 0 || w.parent[j - 1] == -1 || w.parent[j - 1] >= j);
    }
    for (j = 0; j < n; j++) plain[j] = w.count[j];
    k = hdi_sym_supernodes(n, &w);
    hdi_sym_relax(k, &w);
    while (k-- > 0) {                            /* merging lets in zeros: what a front holds beyond its columns */
        int64_t held = 0;
        if (w.node[k].merged) continue;
        for (j = w.node[k].first; j >= 0; j = w.next_col[j]) held += plain[j];
        CHECK_MSG(w.node[k].zeros == hdi_node_size(w.node + k) - held, "%s: %lld zeros", what, (long long)w.node[k].zeros);
    }
    hdi_scope_end(&s);
    free(perm);
    free(plain);
    free(l);
}

static void int_symbolic(void) {
    static const char *const names[6] = {"grid", "random", "path", "star", "full", "diagonal"};
    hd_context ctx;
    hd_error e = int_no_error();
    uint64_t seed = 8;
    int kind, q;
    memset(&ctx, 0, sizeof ctx);
    hdi_error_clear(&e);
    for (kind = 0; kind < 6; kind++) {
        hd_csr a = int_pattern(kind, 5);
        int32_t *perm = DENSE_NEW(int32_t, a.n_rows);
        for (q = 0; q < 3; q++) {
            if (q == 0) CHECK(hdi_amd_order(&a, perm, &ctx, &e) == HD_OK);
            else dense_shuffle(perm, a.n_rows, &seed);
            int_tree_one(&a, perm, names[kind]);
            int_symbolic_one(&a, perm, 1, names[kind]);
        }
        hd_csr_free(&a, NULL);
        free(perm);
    }
}

/* Meshes with many tasks and a top. */
static void int_symbolic_large(void) {
    shape s = shape_bumpy(4, 3), g = shape_grid(70, 60, 0.3), both;
    const double offset[3] = {3, 0, 0};
    const shape *shapes[3];
    hd_context ctx;
    hd_error e = int_no_error();
    int q, k;
    both = shape_disjoint(&s, &g, offset);
    shapes[0] = &s;
    shapes[1] = &g;
    shapes[2] = &both;
    memset(&ctx, 0, sizeof ctx);
    for (q = 0; q < 3; q++) {
        hd_laplacian *lap = NULL;
        int32_t *perm = DENSE_NEW(int32_t, shapes[q]->n);
        CHECK(hd_laplacian_triangles(&lap, shapes[q]->xyz, shapes[q]->n, shapes[q]->tri, shapes[q]->n_tri, NULL, &e) == HD_OK);
        for (k = 0; k < 2; k++) {
            if (k) CHECK(hdi_nd_order(&lap->L, lap->xyz, perm, &ctx, &e) == HD_OK);
            else CHECK(hdi_amd_order(&lap->L, perm, &ctx, &e) == HD_OK);
            int_symbolic_one(&lap->L, perm, 0, q == 0 ? "ball" : q == 1 ? "grid" : "both");
        }
        free(perm);
        hd_laplacian_free(lap);
    }
    shape_free(&s);
    shape_free(&g);
    shape_free(&both);
}

/* Random takes and frees, with a list that is long enough, and one that has to forget: places never overlap, and coalesce when all is free. */
static void int_gaps(void) {
    enum { MOST = 60, SIZE = 100000 };
    int way, step, k;
    for (way = 0; way < 2; way++) {
        int64_t places[MOST], sizes[MOST];
        hdi_gap gap[64];
        uint64_t seed = 11;
        int_space m;
        hdi_gaps g;
        memset(&g, 0, sizeof g);
        g.gap = gap;
        g.room = way ? 3 : 64;
        m.size = SIZE;
        m.owner = DENSE_NEW(int32_t, SIZE);
        memset(m.owner, 0xff, SIZE * sizeof *m.owner);
        for (k = 0; k < MOST; k++) places[k] = -1;
        for (step = 0; step < (way ? 1500 : 4000); step++) {
            k = (int)(dense_random(&seed) % MOST);
            if (places[k] < 0) {
                sizes[k] = (int64_t)(dense_random(&seed) % (step % 3 ? 10 : 60));
                places[k] = hdi_gaps_take(&g, sizes[k]);
                int_space_take(&m, places[k], sizes[k], k, "gaps");
            } else {
                int_space_free(&m, places[k], sizes[k], k, "gaps");
                hdi_gaps_free(&g, places[k], sizes[k]);
                places[k] = -1;
            }
            for (k = 0; k < g.n; k++) {
                CHECK(gap[k].size > 0 && gap[k].at + gap[k].size < (k + 1 < g.n ? gap[k + 1].at : g.end));    /* ascending, coalesced */
                CHECK(m.owner[gap[k].at] == -1 && m.owner[gap[k].at + gap[k].size - 1] == -1);
            }
            CHECK(g.n <= g.room && g.end <= SIZE);
            if (int_failed > 20) break;
        }
        for (k = 0; k < MOST; k++)
            if (places[k] >= 0) hdi_gaps_free(&g, places[k], sizes[k]);
        if (!way) CHECK_MSG(g.n == 0 && g.end == 0, "%d gaps, end %lld", (int)g.n, (long long)g.end);
        free(m.owner);
    }
}

/* ---- [12] direct: sweeps ---- */

static hd_laplacian *int_mesh(int kind, hd_laplacian_kind form) {
    shape s = kind == 0 ? shape_bumpy(2, 5) : kind == 1 ? shape_grid(14, 9, 0.3) : shape_bumpy(4, 5);
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_error e = int_no_error();
    memset(&o, 0, sizeof o);
    o.kind = form;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &e) == HD_OK);
    shape_free(&s);
    return lap;
}

static hd_status int_elim(hdi_elim *m, const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    memset(m, 0, sizeof *m);
    hdi_error_clear(e);
    return hdi_elim_make(m, lap, HD_ORDERING_AUTO, NULL, hdi_heat_scale(lap), ctx, e);
}

/* Right-hand sides side by side are solved as each by itself; fronts that are told to be out of it make no difference; and A x = b. */
static void int_sweep_one(const hdi_elim *m, const hdi_factor *f, int32_t k, hd_context *ctx, const char *what) {
    const hdi_symbolic *s = f == NULL ? NULL : f->sym;
    const int64_t n = s->n, w = f->width;
    double *x = DENSE_NEW(double, n * w * k), *one = DENSE_NEW(double, n * w), *again = DENSE_NEW(double, n * w * k), *b = DENSE_NEW(double,
        n * w * k);
    double *work = DENSE_NEW(double, hdi_sweep_size(s, f->width, k));
    char *active = DENSE_NEW(char, s->n_super);
    uint64_t seed = 17;
    hdi_sweep z;
    int64_t i;
    int32_t r, q, sparse;
    for (sparse = 0; sparse < 2; sparse++) {
        memset(active, 0, (size_t)s->n_super);
        for (i = 0; i < n * w * k; i++) b[i] = sparse && (i / (w * k)) % 61 != 7 ? 0 : dense_signed(&seed);
        for (i = 0; i < n; i++)
            if (!sparse || i % 61 == 7) hdi_sweep_touch(s, (int32_t)i, active);
        memcpy(x, b, (size_t)(n * w * k) * sizeof *x);
        for (i = 0; (size_t)i < hdi_sweep_size(s, f->width, k); i++) work[i] = 1e300;
        z = hdi_sweep_open(f, k, x, work);
        hdi_sweep_run(&z, ctx);
        for (r = 0; r < k; r++) {
            double worst = 0;
            for (i = 0; i < n; i++)
                for (q = 0; q < w; q++) one[w * i + q] = b[w * (k * i + r) + q];
            z = hdi_sweep_open(f, 1, one, work);
            hdi_sweep_run(&z, NULL);
            for (i = 0; i < n; i++)
                for (q = 0; q < w; q++) worst = fmax(worst, fabs(one[w * i + q] - x[w * (k * i + r) + q]));
            CHECK_MSG(worst <= 1e-12 * dense_max_abs(one, n * w), "%s: %d side by side, the %d. is off by %g", what, (int)k, (int)r,
                worst / dense_max_abs(one, n * w));
        }
        for (q = 0; q < 2; q++) {
            memcpy(again, b, (size_t)(n * w * k) * sizeof *x);
            for (i = 0; (size_t)i < hdi_sweep_size(s, f->width, k); i++) work[i] = 1e300;
            z = hdi_sweep_open(f, k, again, work);
            z.active = active;
            hdi_sweep_run(&z, q ? ctx : NULL);
            CHECK_MSG(dense_max_diff(again, x, n * w * k) == 0, "%s: %d side by side, by active fronts: off by %g", what, (int)k,
                dense_max_diff(again, x, n * w * k));
        }
        if (w == 1) continue;
        for (r = 0; r < k; r++) {                /* A x = b for each of the four */
            for (q = 0; q < 4; q++) {
                double worst = 0, size = 0;
                for (i = 0; i < n; i++) {
                    const hd_laplacian *lap = m->lap;
                    const int32_t pole = hdi_elim_pole(m, (int32_t)(f - m->pack), q);
                    hd_c64 sum = hdi_c(-b[w * (k * i + r) + q], 0);
                    int64_t p;
                    for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
                        const double *v = x + w * (k * (int64_t)lap->L.col[p] + r) + q,
                            mass = lap->B ? lap->B[p] : lap->L.col[p] == i ? lap->mass[i] : 0;
                        const hd_c64 a = hdi_cadd(hdi_c(m->t * lap->L.val[p], 0), hdi_cscale(mass, m->set.theta[pole]));
                        sum = hdi_cadd(sum, hdi_cmul(a, hdi_c(v[0], v[4])));
                        size = fmax(size, hdi_cabs(a) * hypot(v[0], v[4]));
                    }
                    sum.im -= b[w * (k * i + r) + q + 4];
                    worst = fmax(worst, hdi_cabs(sum));
                }
                CHECK_MSG(worst <= 1e-13 * size, "%s: %d side by side, pole %d: residual %g", what, (int)k, (int)q, worst / size);
            }
        }
    }
    free(x);
    free(one);
    free(again);
    free(b);
    free(work);
    free(active);
}

static void int_sweeps(void) {
    static const hd_simd simds[3] = {HD_SIMD_NONE, HD_SIMD_AVX2, HD_SIMD_AVX512};
    int kind, level;
    for (kind = 0; kind < 3; kind++) {
        for (level = 0; level <= hdi_simd_best(); level++) {
            hd_laplacian *lap = int_mesh(kind, kind == 1 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
            hd_context ctx;
            hd_error e = int_no_error();
            hdi_elim m;
            hd_rational set;
            int32_t k;
            memset(&ctx, 0, sizeof ctx);
            ctx.simd = simds[level];
            CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
            CHECK(hdi_rational_get(&set, HD_POLES_UNIFORM, 9, &e) == HD_OK);
            CHECK(hdi_elim_poles(&m, &set, 5 * lap->h * lap->h * m.scale, &e) == HD_OK);
            CHECK(m.lone == 0 && m.n_packs == 1);
            for (k = 1; k <= (kind == 2 ? 2 : 6); k++) int_sweep_one(&m, m.pack, k, &ctx, "packs");
            int_sweep_one(&m, &m.real, 1, &ctx, "real");
            int_sweep_one(&m, &m.real, 8, &ctx, "real");
            hdi_elim_free(&m);
            CHECK(ctx.bytes_in_use == 0);
            hd_laplacian_free(lap);
        }
    }
}

/* A full matrix is one front, of two blocks of columns, which its pivots cross in the middle. */
static void int_sweep_panels(void) {
    enum { N = HDI_PANEL + 70 };
    double *l = DENSE_NEW(double, N * N), *b = DENSE_NEW(double, N * N);
    hd_laplacian *lap = NULL;
    hd_context ctx;
    hd_csr L, B;
    hd_error e = int_no_error();
    hdi_elim m;
    hd_rational set;
    int32_t *row = DENSE_NEW(int32_t, N * N), *col = DENSE_NEW(int32_t, N * N), i;
    for (i = 0; i < N * N; i++) {
        row[i] = i / N;
        col[i] = i % N;
        l[i] = row[i] == col[i] ? N - 1 : -1;
        b[i] = row[i] == col[i] ? 1 + row[i] % 5 : 0;
    }
    memset(&ctx, 0, sizeof ctx);
    CHECK(hd_csr_from_triplets(&L, N, N, N * N, row, col, l, NULL, &e) == HD_OK);
    CHECK(hd_csr_from_triplets(&B, N, N, N * N, row, col, b, NULL, &e) == HD_OK);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK && hdi_rational_get(&set, HD_POLES_UNIFORM, 9, &e) == HD_OK);
    CHECK(m.sym.n_super == 1 && hdi_elim_poles(&m, &set, 0.01 * m.scale, &e) == HD_OK);
    int_sweep_one(&m, m.pack, 1, &ctx, "a full matrix");
    hdi_elim_free(&m);
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    free(row);
    free(col);
    free(l);
    free(b);
}

/* ---- [17] shifted: checks of packs ---- */

static void int_checks(void) {
#if HDI_X86
    int kind, r, q;
    int32_t k;
    for (kind = 0; kind < 4 && hdi_simd_best() == 2; kind++) {
        hd_laplacian *lap = int_mesh(kind / 2, kind % 2 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        const int32_t n = lap->n_active;
        uint64_t seed = 9;
        for (k = 1; k <= HDI_CHECK_MOST; k++) {
            double *x = DENSE_NEW(double, HDI_PACK * 6 * n), *weight = DENSE_NEW(double, n), *rhs = DENSE_NEW(double, 6 * n),
                *u = DENSE_NEW(double, 24 * n);
            hdi_check a[6], b[6], *la[6], *lb[6];
            int32_t i;
            int_noise(x, HDI_PACK * 6 * n, &seed);
            int_noise(rhs, 6 * n, &seed);
            int_noise(u, 12 * n, &seed);
            memcpy(u + 12 * n, u, (size_t)(12 * n) * sizeof *u);
            for (i = 0; i < n; i++) weight[i] = 1 / lap->b_diag[i];
            memset(a, 0, sizeof a);
            for (r = 0; r < k; r++) {
                a[r].lap = lap;
                a[r].t = 0.7;
                if (r == 0) int_noise(a[r].theta, HDI_PACK, &seed);
                else memcpy(a[r].theta, a[0].theta, sizeof a[r].theta);
                int_noise(a[r].coef, HDI_PACK, &seed);
                a[r].weight = a[r].noise = weight;
                a[r].rhs = rhs + r * n;
                a[r].x = x + HDI_PACK * r;
                a[r].stride = HDI_PACK * 6;
                b[r] = a[r];
                a[r].u = u + r * n;
                a[r].bu = u + (6 + r) * n;
                b[r].u = u + (12 + r) * n;
                b[r].bu = u + (18 + r) * n;
                la[r] = a + r;
                lb[r] = b + r;
            }
            hdi_check_c(la, k);
            hdi_check_512(lb, k);
            CHECK_MSG(int_off(u + 12 * n, u, 12 * n) < 1e-13, "%d checked together: answers off by %g", (int)k, int_off(u + 12 * n, u, 12 * n));
            for (r = 0; r < k; r++) {
                for (q = 0; q < 4; q++) CHECK_MSG(fabs(a[r].norm2[q] - b[r].norm2[q]) <= 1e-12 * a[r].norm2[q] && a[r].norm2[q] > 0,
                    "%d checked together: residual %g, %g", (int)k,
                                                  a[r].norm2[q], b[r].norm2[q]);
                for (q = 0; q < 4; q++) CHECK(fabs(a[r].size2[q] - b[r].size2[q]) <= 1e-12 * a[r].size2[q] && a[r].size2[q] > 0);
                CHECK_MSG(fabs(a[r].first2 - b[r].first2) <= 1e-12 * fabs(a[r].first2), "%d checked together: norm %g, %g", (int)k, a[r].first2,
                    b[r].first2);
            }
            free(x);
            free(weight);
            free(rhs);
            free(u);
        }
        hd_laplacian_free(lap);
    }
#endif
}

/* What a check tells, by its definition, for one right-hand side. */
static void int_check_plain(void) {
    int kind, q;
    for (kind = 0; kind < 2; kind++) {
        hd_laplacian *lap = int_mesh(1, kind ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        const int32_t n = lap->n_active;
        double *x = DENSE_NEW(double, HDI_PACK * n), *weight = DENSE_NEW(double, n), *rhs = DENSE_NEW(double, n), *u = DENSE_NEW(double, 2 * n);
        double *part = DENSE_NEW(double, 2 * n), *l = DENSE_NEW(double, 2 * n), *b = DENSE_NEW(double, 2 * n), *want = DENSE_NEW(double, 2 * n),
            first = 0;
        hdi_check c, *list = &c;
        uint64_t seed = 4;
        int32_t i;
        int_noise(x, HDI_PACK * n, &seed);
        int_noise(rhs, n, &seed);
        memset(&c, 0, sizeof c);
        for (i = 0; i < n; i++) weight[i] = 1 + 0.1 * (i % 7);
        c.lap = lap;
        c.t = 0.3;
        int_noise(c.theta, HDI_PACK, &seed);
        int_noise(c.coef, HDI_PACK, &seed);
        c.weight = weight;
        c.noise = lap->mass;
        c.rhs = rhs;
        c.x = x;
        c.stride = HDI_PACK;
        c.u = u;
        c.bu = u + n;
        hdi_check_c(&list, 1);
        for (q = 0; q < 4; q++) {
            double norm2 = 0, size2 = 0;
            for (i = 0; i < n; i++) {
                size2 += lap->mass[i] * (x[HDI_PACK * i + q] * x[HDI_PACK * i + q] + x[HDI_PACK * i + q + 4] * x[HDI_PACK * i + q + 4]);
                part[i] = x[HDI_PACK * i + q];
                part[n + i] = x[HDI_PACK * i + q + 4];
            }
            for (i = 0; i < 2; i++) {
                hdi_pair_apply(lap, 1, 0, part + i * n, l + i * n);
                hdi_pair_apply(lap, 0, 1, part + i * n, b + i * n);
            }
            for (i = 0; i < n; i++) {
                const double re = rhs[i] - 0.3 * l[i] - c.theta[q] * b[i] + c.theta[q + 4] * b[n + i],
                    im = -0.3 * l[n + i] - c.theta[q] * b[n + i] - c.theta[q + 4] * b[i];
                norm2 += weight[i] * (re * re + im * im);
                want[i] += c.coef[q] * part[i] + c.coef[q + 4] * part[n + i];
                want[n + i] += c.coef[q] * b[i] + c.coef[q + 4] * b[n + i];
                if (q == 0) first += part[i] * b[i] + part[n + i] * b[n + i];
            }
            CHECK_MSG(fabs(norm2 / c.norm2[q] - 1) < 1e-12, "residual %g, told %g", norm2, c.norm2[q]);
            CHECK_MSG(fabs(size2 / c.size2[q] - 1) < 1e-12, "size %g, told %g", size2, c.size2[q]);
        }
        CHECK_MSG(fabs(first / c.first2 - 1) < 1e-12, "norm %g, told %g", first, c.first2);
        CHECK_MSG(int_off(u, want, 2 * n) < 1e-13, "off by %g", int_off(u, want, 2 * n));
        free(x);
        free(weight);
        free(rhs);
        free(u);
        free(part);
        free(l);
        free(b);
        free(want);
        hd_laplacian_free(lap);
    }
}

/* ---- [18] shift-and-invert Lanczos ---- */

/* (F(a) - F(b))/(a - b) of F(x) = exp(-tau (1/x - 1)) from the larger of the two, in long double. */
static long double int_slope(double a, double b, double tau) {
    const long double la = a, lb = b, d = la - lb, x = -(long double)tau * d / (la * lb);
    if (d == 0) return expl(-tau * (1 / la - 1)) * tau / (la * la);
    return x > 0 ? expl(-tau * (1 / lb - 1)) * expm1l(-x) / d : -expl(-tau * (1 / la - 1)) * expm1l(x) / d;
}

static void int_silan_slopes(void) {
    static const double taus[7] = {0.01, 0.1, 1, 10, 30, 1000, 1e5};
    uint64_t seed = 19;
    double worst = 0, wa = 0, wb = 0, wt = 0;
    int k, q;
    for (k = 0; k < 20000; k++) {
        const double a = pow(10, -6 * fabs(dense_signed(&seed))), near = pow(10, -17 * fabs(dense_signed(&seed)));
        double b = k % 3 == 0 ? pow(10, -6 * fabs(dense_signed(&seed))) : a * (1 + (k % 2 ? near : -near));
        if (k % 97 == 0) b = a;
        if (!(b > 0) || b > 1) continue;
        for (q = 0; q < 7; q++) {
            const double fa = hdi_silan_decay(a, taus[q]), fb = hdi_silan_decay(b, taus[q]), got = hdi_silan_slope(a, fa, b, fb, taus[q]);
            const double want = (double)int_slope(a, b, taus[q]), lost = fabs(a - b) > 0.05 * a ? 1e-14 * (fa + fb) / fabs(a - b) : 0;
            const double off = fabs(got - want) <= lost + 1e-290 ? 0 : fabs(got - want) / fabs(want);
            if (off <= worst) continue;
            worst = off;
            wa = a;
            wb = b;
            wt = taus[q];
            if (!(off < HUGE_VAL)) break;
        }
        CHECK_MSG(hdi_finite(hdi_silan_slope(a, hdi_silan_decay(a, 50), b, hdi_silan_decay(b, 50), 50)), "a %.17g, b %.17g", a, b);
    }
    CHECK_MSG(worst < 1e-8, "a %.17g, b %.17g, tau %g: off by %g", wa, wb, wt, worst);
    CHECK(hdi_silan_decay(1, 30) == 1 && hdi_silan_decay(1.0000001, 30) == 1 && hdi_silan_decay(0, 3) == 0 && hdi_silan_decay(-1e-17, 3) == 0);
    CHECK(hdi_silan_decay(1e-20, 0) == 1 && fabs(hdi_silan_decay(0.5, 2) - exp(-2)) < 1e-16);
    CHECK(hdi_silan_slope(1e-18, 0, 1e-18, 0, 3) == 0);
}

static hdi_lane *int_lanes(const hd_laplacian *lap, int32_t k, hd_context *ctx) {
    hdi_lane *lane = DENSE_NEW(hdi_lane, k);
    uint64_t seed = 21;
    hd_error e = int_no_error();
    int32_t r, i;
    hdi_error_clear(&e);
    for (r = 0; r < k; r++) {
        CHECK(hdi_lane_make(lane + r, lap, ctx, &e) == HD_OK);
        for (i = 0; i < lap->n_active; i++) lane[r].f[i] = r == 0 ? i == 11 : r == 1 ? 1 + sin(0.2 * i) : dense_signed(&seed);
        hdi_pair_apply(lap, 0, 1, lane[r].f, lane[r].rhs);
        hdi_heat_measure(lap, lane + r);
    }
    return lane;
}

/* After every number of steps the bound against the error of the answer, times from a third to three times the middle one, and far from it. */
/* What is missed at several times is the largest of the bounds, relative to |f| and to what is asked for. */
static void int_silan_miss(const hdi_silan *z, int32_t r, double t, const hdi_ritz *ritz) {
    const double times[2] = {0.7 * t, 1.6 * t};
    double miss[2], bound = 0, share = 0;
    hd_error e = int_no_error();
    int q;
    hdi_error_clear(&e);
    for (q = 0; q < 2; q++) {
        const double one = hdi_ritz_bound(ritz, times[q] / z->g);
        bound = fmax(bound, one);
        share = fmax(share, one / (1e-5 * hdi_ritz_size(ritz, times[q] / z->g)));
    }
    CHECK(hdi_silan_miss(z, r, times, 2, 1e-5, 0, miss, &e) == HD_OK && bound > 0);
    CHECK_MSG(fabs(miss[1] / bound - 1) < 1e-12 && fabs(miss[0] / share - 1) < 1e-12, "%g, %g missed, not %g, %g", miss[0], miss[1], share, bound);
}

/* The next look at a bound that falls by half in each step comes after half of the steps that are left. */
static void int_lanczos_pace(void) {
    CHECK(hdi_lanczos_pace(194, 190, ldexp(1, -14), ldexp(1, -10), ldexp(1, -23)) == 4);
    CHECK(hdi_lanczos_pace(194, 190, ldexp(1, -14), ldexp(1, -10), ldexp(1, -15)) == 1);
    CHECK(hdi_lanczos_pace(194, 190, ldexp(1, -14), ldexp(1, -10), ldexp(1, -90)) == 6 && hdi_lanczos_pace(194, 190, 1, 1, 1e-9) == 6);
}

/* Eigenvalues 1/(1 + g lambda) above one show that L is not semidefinite, but not where the solves themselves are off by as much. */
static void int_ritz_above(void) {
    hdi_silan *z = DENSE_NEW(hdi_silan, 1);
    hdi_ritz s;
    hd_error e = int_no_error();
    double known[2] = {1.05, 1};                 /* an eigenvalue, and its vector */
    hdi_error_clear(&e);
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

static void int_silan_bound_of(hd_laplacian *lap, int32_t wide, double t, const char *what) {
    static const double factors[5] = {0.03, 0.3, 1, 3, 30};
    const int32_t n = lap->n_active, k = wide == 1 ? 1 : 3;
    double *u = DENSE_NEW(double, n), *want = DENSE_NEW(double, n), *L = DENSE_NEW(double, n * n), *B = DENSE_NEW(double, n * n), loosest = 0;
    double *y = DENSE_NEW(double, 45 * 8);
    hdi_silan *z = DENSE_NEW(hdi_silan, 1);
    hdi_ritz ritz;
    hdi_silan_sum sum;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_elim m;
    hdi_lane *lane;
    dense_pair pair;
    int32_t i, r, step, looked = 0;
    int64_t p;
    int q, decayed;
    memset(&ctx, 0, sizeof ctx);
    memset(&sum, 0, sizeof sum);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
    t *= m.scale;
    for (i = 0; i < n; i++) {
        for (p = m.lap->L.row_ptr[i]; p < m.lap->L.row_ptr[i + 1]; p++) {
            L[i * n + m.lap->L.col[p]] = m.lap->L.val[p];
            if (m.lap->B) B[i * n + m.lap->L.col[p]] = m.lap->B[p];
        }
        if (!m.lap->B) B[i * n + i] = m.lap->mass[i];
    }
    CHECK(dense_pair_solve(&pair, L, B, n));
    lane = int_lanes(m.lap, k, &ctx);
    CHECK(hdi_elim_shift(&m, hdi_krylov_shift(0, t, t, 0), &e) == HD_OK && m.shift / t > 0.05 && m.shift / t <= 0.2);
    z->wide = wide;
    z->m = &m;
    z->k = k;
    z->g = m.shift;
    CHECK(hdi_silan_start(z, lane, &ctx, &e) == HD_OK);
    for (step = 1; step <= 45 && step < n - 3; step++) {
        CHECK(hdi_silan_step(z, &ctx, &e) == HD_OK && z->steps == step);
        if (step > 12 && step % 4) continue;
        for (r = 0; r < k; r++) {
            for (q = 0; q < 5; q++) {
                const double at = t * factors[q], eps = 1e-15 * fmin(at * dense_max_abs(pair.lambda, n), 1e3) + 3e-14;
                double bound, size, error;
                if (step > 1 && !(z->beta[step - 1][r] > 1e-13)) continue;
                CHECK(hdi_silan_ritz(z, r, step, &ritz, &e) == HD_OK);
                bound = hdi_ritz_bound(&ritz, at / z->g);
                size = hdi_ritz_size(&ritz, at / z->g);
                if (step == 3 && q == 0) int_silan_miss(z, r, t, &ritz);
                z->done[r] = step;
                sum.count = r + 1;               /* of several abreast, only this one is wanted */
                memset(sum.u, 0, sizeof sum.u);
                sum.u[r] = lane[r].u;
                sum.means[r] = lane[r].sums;
                for (i = 0; i <= r; i++) sum.y[i] = y + 45 * i;
                CHECK(hdi_silan_coefficients(z, r, at, y + 45 * r, &e) == HD_OK);
                hdi_silan_sum_run(z, &sum, &ctx);
                CHECK(hdi_silan_answer(z, r, at, sum.y[r], 0, lane + r, &e) == HD_OK);
                z->done[r] = 0;
                dense_pair_heat(&pair, at, lane[r].rhs, want);
                for (i = 0; i < n; i++) u[i] = lane[r].u[i] - want[i];
                error = dense_pair_norm(&pair, u) / z->f_norm[r];
                looked++;
                CHECK_MSG(error <= bound + eps, "%s, wide %d, right-hand side %d, step %d, t %g: error %g, bound %g", what, (int)wide, (int)r,
                    (int)step, factors[q], error, bound);
                decayed = error <= 1e-12 + 10 * eps || size < 1e-3;    /* the bound allows for modes as slow as there can be,
                    which there may not be */
                if (!decayed) loosest = fmax(loosest, bound / error);
                CHECK_MSG(decayed || bound <= 100 * error, "%s, wide %d, right-hand side %d, step %d, t %g: error %g, bound %g", what, (int)wide,
                    (int)r,
                          (int)step, factors[q], error, bound);
                for (i = 0; i < n; i++) u[i] = want[i] - (m.lap->conserves ? lane[r].target[m.lap->component[i]] / m.lap->component_mass[m.lap->component[i]] : 0);
                CHECK_MSG(fabs(size * z->f_norm[r] - dense_pair_norm(&pair, u)) <= 1.01 * (bound + eps) * z->f_norm[r], "%s: size %g, not %g",
                    what, size,
                          dense_pair_norm(&pair, u) / z->f_norm[r]);
                CHECK(lane[r].off.solver == bound * z->f_norm[r] && lane[r].off.rounding > 0 && error * z->f_norm[r] <= lane[r].off.solver + lane[r].off.rounding + eps * z->f_norm[r]);
            }
        }
    }
    CHECK_MSG(looked > 40, "%s: looked %d times only", what, (int)looked);
    CHECK_MSG(loosest > 1, "%s: no bound above 1e-12", what);
    hdi_silan_free(z, &ctx);
    for (r = 0; r < k; r++) hdi_lane_free(lane + r, &ctx);
    hdi_elim_free(&m);
    CHECK(ctx.bytes_in_use == 0);
    dense_pair_free(&pair);
    hd_laplacian_free(lap);
    free(lane);
    free(z);
    free(u);
    free(y);
    free(want);
}

/* A batch against dense solutions: the answer and B times it, and the norm of the solution that measures the resolvent, with its pole. Skipped ones
 * among the others. */
static void int_batches(void) {
    static const int32_t degrees[7] = {1, 2, 3, 8, 9, 11, 14};
    static const char skips[5][9] = {"0", "00", "0100", "101001", "00000000"};
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active;
    dense_c64 *a = DENSE_NEW(dense_c64, n * n), *x = DENSE_NEW(dense_c64, n);
    double *part = DENSE_NEW(double, 2 * n), *mass = DENSE_NEW(double, 2 * n), *want = DENSE_NEW(double, n);
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_elim m;
    int q, z;
    memset(&ctx, 0, sizeof ctx);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
    for (q = 0; q < n; q++) CHECK(fabs(m.weight[q] * m.lap->b_diag[q] - 1) < 1e-15);
    for (q = 0; q < 7; q++) {
        for (z = 0; z < 5; z++) {
            const int32_t k = (int32_t)strlen(skips[z]);
            const double t = 5 * lap->h * lap->h * m.scale;
            hdi_lane *lane = int_lanes(m.lap, k, &ctx);
            hd_rational set;
            hdi_batch b;
            size_t nx, nxr, size;
            int32_t r, p, i;
            int64_t at;
            CHECK(hdi_rational_get(&set, HD_POLES_UNIFORM, degrees[q], &e) == HD_OK && hdi_elim_poles(&m, &set, t, &e) == HD_OK);
            size = hdi_batch_size(&m, k, &nx, &nxr);
            b.x = DENSE_NEW(double, size);
            b.xr = b.x + nx;
            b.work = b.xr + nxr;
            b.active = DENSE_NEW(char, m.sym.n_super);
            for (r = 0; r < k; r++) lane[r].skip = skips[z][r] == '1';
            hdi_batch_run(&m, &b, lane, k, &ctx);
            for (r = 0; r < k; r++) {
                if (lane[r].skip) continue;
                for (i = 0; i < n; i++) want[i] = set.a0 * lane[r].f[i];
                for (p = 0; p < set.n_poles; p++) {
                    double norm2 = 0;
                    memset(a, 0, (size_t)(n * n) * sizeof *a);
                    for (i = 0; i < n; i++) {
                        x[i] = dense_c(lane[r].rhs[i], 0);
                        for (at = m.lap->L.row_ptr[i]; at < m.lap->L.row_ptr[i + 1]; at++)
                            a[i * n + m.lap->L.col[at]] = dense_c(t * m.lap->L.val[at] + set.theta[p].re * m.lap->B[at],
                                set.theta[p].im * m.lap->B[at]);
                    }
                    CHECK(dense_complex_solve(a, x, n));
                    for (i = 0; i < n; i++) {
                        want[i] -= hdi_rat_count(&set, p) * (set.a[p].re * x[i].re - set.a[p].im * x[i].im);
                        part[i] = x[i].re;
                        part[n + i] = x[i].im;
                    }
                    for (i = 0; i < 2; i++) hdi_pair_apply(m.lap, 0, 1, part + i * n, mass + i * n);
                    for (i = 0; i < 2 * n; i++) norm2 += part[i] * mass[i];
                    if (p == lane[r].first_pole) CHECK_MSG(fabs(lane[r].first_norm / sqrt(norm2) - 1) < 1e-9,
                        "degree %d, %d together: |x_%d| is %g, not %g", (int)degrees[q],
                                                           (int)k, (int)p, lane[r].first_norm, sqrt(norm2));
                }
                CHECK(lane[r].first_pole >= 0 && lane[r].first_pole < set.n_poles);
                CHECK_MSG(int_off(lane[r].u, want, n) < 1e-12, "degree %d, %d together: off by %g", (int)degrees[q], (int)k, int_off(lane[r].u,
                    want, n));
                hdi_pair_apply(m.lap, 0, 1, want, mass);
                CHECK_MSG(int_off(lane[r].tmp, mass, n) < 1e-12, "degree %d, %d together: B u is off by %g", (int)degrees[q], (int)k,
                    int_off(lane[r].tmp, mass, n));
                CHECK(lane[r].residual > 0 && lane[r].residual < 1e-12 && lane[r].off.rounding > 0 && lane[r].off.rounding < 1e-8 * lane[r].f_norm);
            }
            for (r = 0; r < k; r++) hdi_lane_free(lane + r, &ctx);
            free(lane);
            free(b.x);
            free(b.active);
        }
    }
    hdi_elim_free(&m);
    CHECK(ctx.bytes_in_use == 0);
    hd_laplacian_free(lap);
    free(a);
    free(x);
    free(part);
    free(mass);
    free(want);
}

static void int_silan_bounds(void) {
    int kind, q, w;
    for (w = 1; w <= 8; w += 7) {
        for (kind = 0; kind < 2; kind++) {
            for (q = 0; q < 3; q++) {
                hd_laplacian *lap = int_mesh(kind, kind ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
                int_silan_bound_of(lap, w, pow(20, q - 0.5) * lap->h * lap->h, kind ? "grid" : "ball");
            }
        }
        int_silan_bound_of(int_path(60), w, 10, "path");
        int_silan_bound_of(int_path(60), w, 1000, "path");
    }
}

#include "test_shared.h"
/* Large numbers where the next call's variables will be. */
static double int_soil(int seed) {
    double a[600];
    int i;
    for (i = 0; i < 600; i++) a[i] = 1e300;
    return a[(seed * 7) % 600];
}

/* Without poles the best weighted fit of any function is its weighted mean, and with one real pole that of a + b/(x - p) is exact. */
static void int_fit_constant(void) {
    enum { N = 40 };
    double x[N], f[HDI_FIT_ROOM] = {0}, u[HDI_FIT_ROOM] = {0}, A[(N + 2) * 2], b[N + 2], sum = 0, all = 0;
    hdi_fit k;
    hdi_fitted s;
    int i, poles;
    memset(&k, 0, sizeof k);
    k.count = k.constant = 1;
    k.n = N;
    k.x = x;
    k.f = f;
    k.u = u;
    k.A = A;
    k.b = b;
    for (poles = 0; poles < 2; poles++) {
        memset(&s, 0, sizeof s);
        s.n = poles;
        s.p[0].re = -0.5;
        for (i = 0, sum = all = 0; i < N; i++) {
            x[i] = i / (double)N;
            u[i] = 1 + i % 3;
            f[i] = poles ? 3 - 2 / (x[i] + 0.5) : sin(9 * x[i]);
            sum += u[i] * u[i] * f[i];
            all += u[i] * u[i];
        }
        CHECK(int_soil(poles) > 1e299);
        hdi_fit_residues(&k, 0, &s);
        CHECK_MSG(fabs(s.a0 - (poles ? 3 : sum / all)) < 1e-12 && fabs(s.a[0].re + 2 * poles) < 1e-12, "%d poles: %g and %g", poles, s.a0,
                  s.a[0].re);
        CHECK(poles == 0 || s.error < 1e-12);
    }
}

/* ---- [13] selinv, and what [18] and [21] make of it ---- */

/* Sums of entries of the inverses of all poles, a lone real one and one pack or two packs, with weights of three sets: against dense solutions. */
static void int_invert_of(int kind, hd_laplacian_kind form, int level, int32_t degree) {
    static const hd_simd simds[3] = {HD_SIMD_NONE, HD_SIMD_AVX2, HD_SIMD_AVX512};
    enum { SETS = 3, PICKED = 5 };
    hd_laplacian *lap = int_mesh(kind, form);
    const int32_t n = lap->n_active;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_elim m;
    hd_rational set;
    hd_c64 weight[SETS * HD_MAX_POLES];
    hdi_elim_sums sums;
    uint64_t seed = 31;
    double *diag, *entries, *want, size = 0, off = 0;
    int64_t count, q;
    int32_t p, k, c, i, v;
    memset(&ctx, 0, sizeof ctx);
    ctx.simd = simds[level];
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK && hdi_rational_get(&set, HD_POLES_DIAGONAL, degree, &e) == HD_OK);
    CHECK(hdi_elim_poles(&m, &set, 5 * lap->h * lap->h * m.scale, &e) == HD_OK);
    CHECK(degree == 9 ? m.lone == 0 && m.n_packs == 1 : m.lone < 0 && m.n_packs == 2);
    for (k = 0; k < SETS * set.n_poles; k++) {
        weight[k].re = dense_signed(&seed);
        weight[k].im = dense_signed(&seed);
    }
    count = m.sym.a_ptr[m.sym.n_super];
    diag = DENSE_NEW(double, SETS * n);
    entries = DENSE_NEW(double, SETS * count);
    want = DENSE_NEW(double, SETS * PICKED * n);
    diag[0] = 100;                               /* sums are added to what is there */
    sums.n_sets = SETS;
    sums.weight = weight;
    sums.wanted = HDI_WANT_DIAGONAL;
    sums.values = diag;
    sums.stride = n;
    CHECK(hdi_elim_invert(&m, &sums, &e) == HD_OK);
    sums.wanted = HDI_WANT_ENTRIES;
    sums.values = entries;
    sums.stride = count;
    CHECK(hdi_elim_invert(&m, &sums, &e) == HD_OK);
    diag[0] -= 100;
    for (p = 0; p < set.n_poles; p++) {
        for (c = 0; c < PICKED; c++) {
            dense_c64 *a = DENSE_NEW(dense_c64, (int64_t)n * n), *b = DENSE_NEW(dense_c64, n);
            const int32_t column = c * 29 % n;
            for (i = 0; i < n; i++)
                for (q = m.lap->L.row_ptr[i]; q < m.lap->L.row_ptr[i + 1]; q++) {
                    const double mass = m.lap->B ? m.lap->B[q] : m.lap->L.col[q] == i ? m.lap->mass[i] : 0;
                    a[(size_t)i * (size_t)n + (size_t)m.lap->L.col[q]] = dense_c(m.t * m.lap->L.val[q] + set.theta[p].re * mass, set.theta[p].im * mass);
                }
            b[column] = dense_c(1, 0);
            CHECK(dense_complex_solve(a, b, n));
            for (k = 0; k < SETS; k++)
                for (i = 0; i < n; i++) {
                    const hd_c64 w = weight[k * set.n_poles + p];
                    want[(k * PICKED + c) * n + i] += w.re * b[i].re - (set.theta[p].im == 0 ? 0 : w.im * b[i].im);
                }
            free(a);
            free(b);
        }
    }
    size = dense_max_abs(want, SETS * PICKED * n);
    for (k = 0; k < SETS; k++) {
        for (c = 0; c < PICKED; c++) {
            const int32_t column = c * 29 % n;
            off = fmax(off, fabs(diag[k * n + column] - want[(k * PICKED + c) * n + column]));
        }
        for (v = 0; v < m.sym.n_super; v++)
            for (q = m.sym.a_ptr[v]; q < m.sym.a_ptr[v + 1]; q++) {
                int32_t row, column;
                hdi_entry_place(&m.sym, v, q, &row, &column);
                CHECK(column <= row);
                for (c = 0; c < PICKED; c++)
                    if (c * 29 % n == column) off = fmax(off, fabs(entries[k * count + q] - want[(k * PICKED + c) * n + row]));
                if (row == column) off = fmax(off, fabs(entries[k * count + q] - diag[k * n + row]));
            }
    }
    CHECK_MSG(off <= 1e-12 * size, "mesh %d, level %d: sums of entries are off by %g", kind, level, off / size);
    hdi_elim_free(&m);
    CHECK(ctx.bytes_in_use == 0);
    hd_laplacian_free(lap);
    free(diag);
    free(entries);
    free(want);
}

static void int_invert(void) {
    int level;
    for (level = 0; level <= hdi_simd_best(); level++) {
        int_invert_of(1, HD_LAPLACIAN_FEM, level, 9);
        int_invert_of(1, HD_LAPLACIAN_VORONOI_COT, level, 13);
    }
}

/* factor Re 1/(x + theta) >= 1/(1 + x), which bounds of diagonals rest on, for the pole that all sets choose. */
static void int_resolvent_pole(void) {
    static const hd_pole_kind kinds[3] = {HD_POLES_UNIFORM, HD_POLES_KERNEL, HD_POLES_DIAGONAL};
    int q;
    int32_t r, k;
    for (q = 0; q < 3; q++) {
        for (r = 2; r <= 14; r++) {
            hd_rational set;
            hd_error e = int_no_error();
            double factor = 1;
            int32_t best;
            CHECK(hdi_rational_get(&set, kinds[q], r, &e) == HD_OK);
            best = hdi_resolvent_pole(&set, &factor);
            CHECK_MSG(best >= 0 && best < set.n_poles && factor < 10, "set %d, degree %d: pole %d, factor %g", q, (int)r, (int)best, factor);
            for (k = -1; k < 600 && best >= 0; k++) {
                const double x = k < 0 ? 0 : pow(10, -4 + 0.02 * k);
                const hd_c64 z = hdi_cdiv(hdi_c(1, 0), hdi_c(x + set.theta[best].re, set.theta[best].im));
                CHECK_MSG(factor * z.re * (1 + x) >= 1 - 1e-12, "set %d, degree %d, x %g: %g", q, (int)r, x, factor * z.re * (1 + x));
            }
        }
    }
}

/* An imaginary pole bounds nothing: Re 1/(x + i y) vanishes at x = 0. */
static void int_resolvent_imaginary(void) {
    hd_rational set;
    double factor = 1;
    memset(&set, 0, sizeof set);
    set.n_poles = 1;
    set.theta[0] = hdi_c(0, 1);
    CHECK(hdi_resolvent_pole(&set, &factor) == -1);
}

static hd_progress int_stop_at(void *user, const char *stage, double done) {
    (void)stage;
    (void)done;
    return --*(int64_t *)user == 0 ? HD_PROGRESS_CANCEL : HD_PROGRESS_CONTINUE;
}

/* The way of hd_heat_pairs for more vertices than columns fit: the same numbers as by columns, and as the dense. */
static void int_pairs_by_entries(void) {
    enum { PAIRS = 60 };
    int kind, form, q, way;
    for (form = 0; form < 2; form++) {
        hd_laplacian *lap = int_mesh(0, form ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        hd_heat *heat = NULL;
        int32_t i[PAIRS], j[PAIRS];
        double K[PAIRS], d[PAIRS], one_K[PAIRS], one_d[PAIRS];
        const double t = 3 * lap->h * lap->h;
        uint64_t seed = 4;
        CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
        for (kind = 0; kind < 4; kind++) {
            double size = 0, size_K = 0;
            hd_report rep;
            hdi_pairs pairs;
            memset(&rep, 0, sizeof rep);
            memset(&pairs, 0, sizeof pairs);
            for (q = 0; q < PAIRS; q++) {
                i[q] = q % 3 ? i[q - 1] : (int32_t)(dense_random(&seed) % (uint64_t)lap->n);
                j[q] = q % 11 == 5 ? i[q] : (int32_t)(dense_random(&seed) % (uint64_t)lap->n);
            }
            CHECK(heat_pairs(heat, (hd_distance_kind)kind, t, PAIRS, i, j, K, d, NULL) >= 0);
            pairs.kind = (hd_distance_kind)kind;
            pairs.n = PAIRS;
            pairs.i = i;
            pairs.j = j;
            pairs.K = one_K;
            pairs.d = one_d;
            CHECK(hdi_pairs_by_entries(heat, &pairs, t, &rep) >= 0 && rep.error.status == HD_OK && rep.status >= 0);
            for (q = 0; q < PAIRS; q++) {
                size = fmax(size, d[q]);
                size_K = fmax(size_K, kind < 2 ? fabs(K[q]) : 0);
            }
            for (q = 0; q < PAIRS; q++) {
                CHECK_MSG(fabs(d[q] - one_d[q]) <= 1e-6 * size && (i[q] != j[q] || one_d[q] == 0), "kind %d: %.12g by columns, %.12g by entries", kind, d[q], one_d[q]);
                if (kind < 2) CHECK_MSG(fabs(K[q] - one_K[q]) <= 1e-7 * size_K, "kind %d: entry %.12g by columns, %.12g by entries", kind, K[q], one_K[q]);
            }
            CHECK_MSG(kind > 1 || (rep.error_bound > 0 && rep.error_bound < 1e-3), "kind %d: bound %g", kind, rep.error_bound);
            pairs.K = NULL;
            for (way = 0; way < 3; way++) {      /* stopped early, in the middle, and not at all */
                int64_t left = way == 0 ? 1 : way == 1 ? 9 : 100000;
                const int64_t all = left;
                hd_context *ctx = lap->context;
                ctx->progress = int_stop_at;
                ctx->progress_user = &left;
                memset(&rep, 0, sizeof rep);
                CHECK((hdi_pairs_by_entries(heat, &pairs, t, &rep) == HD_ERR_CANCELLED) == (left <= 0));
                CHECK(left < all && rep.status == rep.error.status);
                ctx->progress = NULL;
            }
        }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
}

/* Lists of pairs fall into parts of at most so many vertices, each as long as can be. */
static void int_pairs_few(void) {
    enum { N = 12, PAIRS = 80 };
    int32_t i[PAIRS], j[PAIRS], most, v;
    uint64_t seed = 3;
    int64_t p, q, n;
    for (q = 0; q < PAIRS; q++) {
        i[q] = q < 30 ? 0 : (int32_t)(dense_random(&seed) % N);
        j[q] = q % 9 == 4 ? i[q] : (int32_t)(dense_random(&seed) % N);
    }
    for (most = 0; most <= N; most++) {
        int64_t mark[N] = {0};
        for (p = 0; p < PAIRS; p += n) {
            int32_t count = 0, next = 0;
            char seen[N] = {0};
            n = hdi_pairs_few(i + p, j + p, PAIRS - p, most, p + 1, mark);
            for (q = p; q < p + n; q++) seen[i[q]] = seen[j[q]] = 1;
            for (v = 0; v < N; v++) count += seen[v];
            if (p + n < PAIRS) seen[i[p + n]] = seen[j[p + n]] = 1;
            for (v = 0; v < N; v++) next += seen[v];
            CHECK_MSG(n >= 1 && (count <= most || n == 1) && (next > most || p + n == PAIRS), "most %d, pair %d: %d pairs of %d vertices", (int)most, (int)p, (int)n, (int)count);
            if (n < 1) return;
        }
    }
}

/* Pairs in parts: the same numbers and bounds as all at once, though all entries of some parts are tiny. */
static void int_pairs_in_parts(void) {
    hd_laplacian *lap = int_mesh(0, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n;
    const double t = 0.3 * lap->h * lap->h;
    double *K = DENSE_NEW(double, n), *d = DENSE_NEW(double, n), *all_K = DENSE_NEW(double, n), *all_d = DENSE_NEW(double, n);
    int32_t *i = DENSE_NEW(int32_t, n), *j = DENSE_NEW(int32_t, n), v;
    hdi_ledger before[2];
    hd_report all, sum, one;
    hd_heat *heat = NULL;
    hd_heat_opts o;
    hdi_pairs x;
    int64_t p;
    memset(&o, 0, sizeof o);
    o.method = HD_METHOD_KRYLOV;
    CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    for (v = 0; v < n; v++) j[v] = v;
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, n, i, j, all_K, all_d, &all) == HD_OK);
    memset(&x, 0, sizeof x);
    x.kind = HD_DISTANCE_CLASSICAL;
    x.before = before;
    before[0] = before[1] = hdi_ledger_begin(HD_EVIDENCE_NONE, HD_EVIDENCE_NONE, HD_EVIDENCE_NONE, 0);
    for (p = 0; p < n; p += x.n) {
        x.n = n - p < 10 ? n - p : 10;
        x.i = i + p;
        x.j = j + p;
        x.K = K + p;
        x.d = d + p;
        x.more = p + x.n < n;
        CHECK(hdi_pairs_once(heat, &x, t, &one) == HD_OK);
        if (p == 0) sum = one;
        else hdi_report_merge(&sum, &one);
    }
    for (v = 0; v < n; v++) CHECK(fabs(K[v] - all_K[v]) <= 1e-8 * all_K[0] && fabs(d[v] - all_d[v]) <= 1e-8 * dense_max_abs(all_d, n));
    CHECK_MSG(sum.error_bound > 0 && sum.error_bound <= 2 * all.error_bound && sum.error_relative <= 2 * all.error_relative && sum.n_lost == all.n_lost && sum.smallest > 0.5 * all.smallest,
              "bounds %g and %g, %g and %g at once; smallest %g and %g", sum.error_bound, sum.error_relative, all.error_bound, all.error_relative, sum.smallest, all.smallest);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(K);
    free(d);
    free(all_K);
    free(all_d);
    free(i);
    free(j);
}

/* f(s, s), f(v, v) and f(s, v) of row s and all rows, f = x g(lambda) x', or B f B; d2[v] = f(s, s) - 2 f(s, v) + f(v, v). */
static void int_dense_distances(const dense_pair *p, const double *g, int by_b, int32_t source, double *d2) {
    const int32_t n = p->n;
    double *x = DENSE_NEW(double, n);
    int32_t k, v;
    for (v = 0; v < n; v++) d2[v] = 0;
    for (k = 0; k < n; k++) {                    /* the sum over k of g_k (y_sk - y_vk)^2, y = x or B x: without cancellation */
        memcpy(x, p->x + (size_t)k * (size_t)n, (size_t)n * sizeof *x);
        if (by_b) dense_apply(p->B, p->x + (size_t)k * (size_t)n, x, n);
        for (v = 0; v < n; v++) d2[v] += g[k] * (x[source] - x[v]) * (x[source] - x[v]);
    }
    free(x);
}

/* What is foretold of memory is what is taken: for the factor of L and its inverse, and for the forms after that. */
static void int_ground_need(void) {
    int kind, form;
    for (kind = 0; kind < 2; kind++) {
        for (form = 0; form < 2; form++) {
            hd_laplacian *lap = int_mesh(kind, form ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
            hd_context ctx;
            hd_error e = int_no_error();
            hdi_elim m;
            hdi_ground g;
            uint64_t need, before;
            memset(&ctx, 0, sizeof ctx);
            memset(&g, 0, sizeof g);
            CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK);
            need = hdi_ground_need(&m, &g, 0);
            before = ctx.bytes_peak = ctx.bytes_in_use;
            CHECK(hdi_ground_make(&m, &g, &e) == HD_OK);
            CHECK_MSG(ctx.bytes_peak - before == need, "mesh %d, form %d: %llu bytes, %llu foretold", kind, form, (unsigned long long)(ctx.bytes_peak - before),
                      (unsigned long long)need);
            need = hdi_ground_need(&m, &g, 1);
            before = ctx.bytes_peak = ctx.bytes_in_use;
            CHECK(hdi_ground_forms(&m, &g, &e) == HD_OK);
            CHECK_MSG(ctx.bytes_peak - before == need, "mesh %d, form %d: forms %llu bytes, %llu foretold", kind, form, (unsigned long long)(ctx.bytes_peak - before),
                      (unsigned long long)need);
            CHECK(hdi_ground_need(&m, &g, 1) == 0);
            hdi_ground_free(&g, &ctx);
            hdi_elim_free(&m);
            CHECK(ctx.bytes_in_use == 0);
            hd_laplacian_free(lap);
        }
    }
}

/* With pivots that are a little wrong one step of refinement leaves the square of that. */
static void int_ground_refined(void) {
    hd_laplacian *lap = int_mesh(0, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_elim m;
    hdi_ground g;
    double *b, *x, *r, *sweep, off = 0, once, twice;
    uint64_t seed = 9;
    int32_t i;
    memset(&ctx, 0, sizeof ctx);
    memset(&g, 0, sizeof g);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK && hdi_ground_make(&m, &g, &e) == HD_OK);
    b = DENSE_NEW(double, 3 * (int64_t)n);
    x = b + n;
    r = x + n;
    sweep = DENSE_NEW(double, (int64_t)hdi_sweep_size(&m.sym, 1, 1));
    for (i = 0; i < n; i++) b[i] = g.held[i] ? 0 : dense_signed(&seed);
    for (i = 0; i < n; i++) g.factor.dinv[i] *= 1 + 1e-5 * dense_signed(&seed);
    memcpy(x, b, (size_t)n * sizeof *x);
    hdi_ground_solve(&m, &g, x, sweep);
    hdi_ground_residual(&m, &g, b, x, NULL, r, NULL);
    once = dense_max_abs(r, n);
    hdi_ground_refined(&m, &g, b, NULL, x, &off, r, sweep);
    hdi_ground_residual(&m, &g, b, x, NULL, r, NULL);
    twice = dense_max_abs(r, n);
    CHECK_MSG(once > 1e-7 && twice < 1e-3 * once && off > 0, "residual %g, then %g", once, twice);
    hdi_ground_free(&g, &ctx);
    hdi_elim_free(&m);
    hd_laplacian_free(lap);
    free(b);
    free(sweep);
}

static void int_parts(void) {
    const hdi_parts a = {1, 5, 3}, b = {2, 4, 6}, least = hdi_parts_least(a, b), other = hdi_parts_least(b, a), twice = hdi_parts_scale(2, a), none = {HUGE_VAL, 0, 1};
    CHECK(least.rational == 1 && least.solver == 4 && least.rounding == 3);
    CHECK(other.rational == 1 && other.solver == 4 && other.rounding == 3);
    CHECK(twice.rational == 2 && twice.solver == 10 && twice.rounding == 6);
    CHECK(hdi_parts_scale(0, none).rational == 0 && hdi_parts_scale(3, none).rational == HUGE_VAL && hdi_parts_scale(HUGE_VAL, none).solver == 0);
}

/* Factors with pivots that are a little wrong: the error of a column is within the bound that its residuals give, which is not much larger. */
static void int_distance_windows_damaged(hdi_distance_shared *z, const hdi_terms *source, const char *what) {
    const int32_t n = (int32_t)z->w.n, n_times = z->w.n_times;
    double *exact = DENSE_NEW(double, (int64_t)n_times * n);
    uint64_t seed = 77;
    int32_t i, q;
    hdi_distance_shared_column(z, source);
    for (q = 0; q < n_times; q++) memcpy(exact + (size_t)q * z->w.n, hdi_distance_shared_at(z, q), z->w.n * sizeof *exact);
    for (i = 0; i < z->m->n_used; i++) {
        hdi_factor *f = z->m->pack + i;
        for (q = 0; q < f->width * n; q++) f->dinv[q] *= 1 + 1e-5 * dense_signed(&seed);
    }
    hdi_distance_shared_column(z, source);
    for (q = 0; q < n_times; q++) {
        const double off = hdi_distance_shared_off(z, q), *g = hdi_window_at(&z->w, z->w.values, q) + n, *c = hdi_distance_shared_at(z, q);
        double most = 0;
        for (i = 0; i < n; i++) most = fmax(most, fabs(c[i] - exact[(size_t)q * z->w.n + (size_t)i]) / (off * sqrt(g[i])));
        CHECK_MSG(most <= 1 && most > 1e-4, "%s, time %d: errors are up to %g of the bound", what, (int)q, most);
    }
    free(exact);
}

/* Traces at times that share their poles, and at one, within their bounds of the sums over eigenvalues. */
static void int_traces(const hd_laplacian *lap, const dense_pair *pair, int32_t n_times, const double *t) {
    double Z[16], bound[16], one, one_bound;
    hd_heat *heat = NULL;
    int32_t q, i;
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    CHECK(hd_heat_trace(heat, n_times, t, Z, bound, NULL, NULL) >= 0);
    for (q = 0; q < n_times; q++) {
        double want = 0;
        for (i = 0; i < pair->n; i++) want += exp(-t[q] * pair->lambda[i]);
        CHECK(hd_heat_trace(heat, 1, t + q, &one, &one_bound, NULL, NULL) >= 0);
        CHECK_MSG(fabs(Z[q] - want) <= bound[q] + 1e-12 * want && bound[q] < 1e-5 * want, "trace %.12g, not %.12g, bound %g", Z[q], want, bound[q]);
        CHECK_MSG(fabs(one - want) <= one_bound + 1e-12 * want && one_bound < 1e-5 * want, "one trace %.12g, not %.12g, bound %g", one, want, one_bound);
    }
    hd_heat_free(heat);
}

/* Windows of distances: f is exp(-2tA), and g bounds the resolvent 1/(1 + 2tA) from above without being much larger; so do diagonals and columns
 * together, for every pair of vertices and each of the times. */
static void int_distance_windows(void) {
    enum { TIMES = 9 };
    int form, kind;
    for (form = 0; form < 2; form++) {
        hd_laplacian *lap = int_mesh(0, form ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        const int32_t n = lap->n_active;
        double t[TIMES], *g = DENSE_NEW(double, n), *u = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, 2 * (int64_t)n), *B;
        dense_pair pair;
        int32_t i, q, r;
        B = shared_dense(&lap->L, lap->B ? lap->B : lap->L.val);
        for (i = 0; i < n * n && !lap->B; i++) B[i] = i % (n + 1) == 0 ? lap->mass[i / (n + 1)] : 0;
        CHECK(dense_pair_solve(&pair, shared_dense(&lap->L, lap->L.val), B, n));
        for (q = 0; q < TIMES; q++) t[q] = lap->h * lap->h * pow(10, 0.2 * q);
        int_traces(lap, &pair, TIMES, t);
        for (kind = 0; kind < 2; kind++) {
            double off = 0, low = HUGE_VAL, high = 0;
            hd_heat *heat = NULL;
            hdi_heat_call h;
            hdi_scope s;
            hdi_distance_shared z;
            CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
            CHECK(hdi_distance_begin(&h, heat, (hd_distance_kind)kind, TIMES, t, 1, NULL, NULL) >= 0);
            CHECK(hdi_heat_sort_times(&h, 2, NULL) >= 0 && hdi_heat_analysed(heat, h.e) >= 0);
            s = hdi_scope_begin(heat->ctx, h.e);
            CHECK(hdi_distance_shared_take(&z, &h, (hd_distance_kind)kind, 0, TIMES, &s) >= 0);
            CHECK(hdi_window_run(&h, &z.w, HDI_SHARED_DISTANCE_TOL, z.full ? HDI_WANT_FORMS : HDI_WANT_DIAGONAL) >= 0);
            hdi_distance_shared_probe(&z);
            for (r = 0; r < 3; r++) {
                const int32_t at = r * (n - 1) / 2, source = z.m->lap->vertex[at];
                const hdi_terms one = hdi_terms_vertex(source);
                hdi_distance_shared_column(&z, &one);
                for (q = 0; q < TIMES; q++) {
                    const double *f = hdi_window_at(&z.w, z.w.values, q), *c = hdi_distance_shared_at(&z, q);
                    const int mass = z.weighted && !z.full;
                    double size = 0;
                    for (i = 0; i < n; i++) g[i] = exp(-2 * t[q] * pair.lambda[i]);
                    int_dense_distances(&pair, g, kind, lap->row[source], want);
                    for (i = 0; i < n; i++) g[i] = 1 / (1 + 2 * t[q] * pair.lambda[i]);
                    int_dense_distances(&pair, g, kind, lap->row[source], want + n);
                    for (i = 0; i < n; i++) size = fmax(size, want[i]);
                    for (i = 0; i < n; i++) {
                        const int32_t v = lap->row[z.m->lap->vertex[i]];
                        const double b = mass ? z.m->lap->mass[i] : 1, bs = mass ? z.m->lap->mass[at] : 1;
                        const double df = z.unit * (b * b * f[i] + bs * bs * f[at] - 2 * b * bs * c[i]);
                        const double dg = z.unit * (b * b * f[n + i] + bs * bs * f[n + at] - 2 * b * bs * c[n + i]);
                        if (i == at) continue;
                        off = fmax(off, fabs(df - want[v]) / size);
                        low = fmin(low, dg / want[n + v]);
                        high = fmax(high, dg / want[n + v]);
                    }
                    hdi_distance_shared_judge(&z, q, &one, u);   /* the bounds are made of the same columns, by vertices */
                    for (i = 0; i < n; i++) {
                        const int32_t v = lap->vertex[i];
                        const double dg = z.metric.g[i] + z.metric.g[lap->row[source]] - 2 * z.g[v];
                        if (v == source) continue;
                        off = fmax(off, fabs(u[v] * u[v] - want[i]) / size);
                        low = fmin(low, dg / want[n + i]);
                        high = fmax(high, dg / want[n + i]);
                    }
                }
            }
            CHECK_MSG(off < 1e-6, "kind %d, form %d: squared distances off by %g", kind, form, off);
            CHECK_MSG(low > 1 - 1e-9 && high < 7, "kind %d, form %d: g is %g to %g times the resolvent", kind, form, low, high);
            for (r = 0; r < 3; r++) {
                const hdi_terms one = hdi_terms_vertex(z.m->lap->vertex[r * (n - 1) / 2]);
                int_distance_windows_damaged(&z, &one, form ? "diagonal" : "full");
            }
            hdi_scope_end(&s);
            hdi_heat_end(&h);
            hd_heat_free(heat);
        }
        dense_pair_free(&pair);
        hd_laplacian_free(lap);
        free(g);
        free(u);
        free(want);
    }
}

/* ---- [22] to [28]: bounds, sizes and what is kept, each by itself ---- */

/* A plan, and a call of it that is ready for queries with shared poles or without. */
static hd_heat *int_plan(const hd_laplacian *lap) {
    hd_heat *heat = NULL;
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    return heat;
}

/* The definition, dense: noise_j = sum_i M_ij c_i^2/D_i sum_k M_ik with M = t |L| + theta |B|, and c_i half a unit for each term and eight more. */
static void int_noise_weights(void) {
    int form;
    for (form = 0; form < 2; form++) {
        hd_laplacian *lap = int_mesh(1, form ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        const int32_t n = lap->n_active;
        const double t = 0.3, theta = 1.7;
        double *M = shared_dense(&lap->L, lap->L.val), *B = shared_dense(&lap->L, lap->B ? lap->B : lap->L.val), *noise = DENSE_NEW(double, 2 * (int64_t)n), worst = 0;
        int32_t i, j, k;
        for (i = 0; i < n; i++)
            for (j = 0; j < n; j++) M[i * n + j] = t * fabs(M[i * n + j]) + theta * (lap->B ? fabs(B[i * n + j]) : i == j ? lap->mass[i] : 0);
        hdi_noise_weights(lap, t, theta, noise, noise + n);
        for (j = 0; j < n; j++) {
            double want = 0;
            for (i = 0; i < n; i++) {
                const double c = ((double)(lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) + 8) * DBL_EPSILON / 2;
                double sum = 0;
                for (k = 0; k < n && M[i * n + j] > 0; k++) sum += M[i * n + k];
                want += M[i * n + j] * c * c / (lap->B ? B[i * n + i] : lap->mass[i]) * sum;
            }
            worst = fmax(worst, fabs(noise[j] / want - 1));
        }
        CHECK_MSG(worst < 1e-12, "form %d: off by %g", form, worst);
        hd_laplacian_free(lap);
        free(M);
        free(B);
        free(noise);
    }
}

/* No eigenvalue lies above the bound, which is not much larger than the largest. */
static void int_lambda_bound(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active;
    dense_pair pair;
    double top, bound = hdi_lambda_bound(lap);
    CHECK(dense_pair_solve(&pair, shared_dense(&lap->L, lap->L.val), shared_dense(&lap->L, lap->B), n));
    top = dense_max_abs(pair.lambda, n);
    CHECK_MSG(bound >= top && bound <= 20 * top, "bound %g, eigenvalue %g", bound, top);
    dense_pair_free(&pair);
    hd_laplacian_free(lap);
}

/* The heat of a field becomes the target, and the means that are kept stay as they are. */
static void int_conserve_sums(void) {
    hd_laplacian *lap = int_path(12);
    hdi_lane lane;
    double u[12], target = 3, sums = 77, spare = 0, heat = 0;
    int32_t i;
    memset(&lane, 0, sizeof lane);
    lane.u = u;
    lane.target = &target;
    lane.sums = &sums;
    lane.spare_sums = &spare;
    for (i = 0; i < 12; i++) u[i] = 1 + 0.1 * i;
    hdi_conserve_sums(lap, &lane);
    for (i = 0; i < 12; i++) heat += lap->mass[i] * u[i];
    CHECK_MSG(fabs(heat - 3) < 1e-14 && fabs(u[11] - u[0] - 1.1) < 1e-14 && sums == 77 && lane.sums == &sums, "heat %.17g", heat);
    hd_laplacian_free(lap);
}

/* Both elimination orders of a plan are freed. */
static void int_turned(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    hd_heat_opts o;
    hd_context ctx;
    hd_heat *heat = NULL;
    hd_error e = int_no_error();
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    hdi_error_clear(&e);
    o.context = &ctx;
    CHECK(hd_heat_create(&heat, lap, &o, &e) == HD_OK && hdi_heat_analysed_as(heat, 0, &e) == HD_OK && hdi_heat_analysed_as(heat, 1, &e) == HD_OK);
    CHECK(heat->other && heat->light == 1);
    hd_heat_free(heat);
    CHECK_MSG(ctx.bytes_in_use == 0, "%lld bytes are left", (long long)ctx.bytes_in_use);
    hd_laplacian_free(lap);
}

/* Each pole in four parts is the same set, with as many packs as there may be. */
static void int_many_packs(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    const double t = 5 * lap->h * lap->h;
    double *u = DENSE_NEW(double, 2 * (int64_t)lap->n);
    hd_rational set, parts;
    hd_heat_opts o;
    hd_report rep;
    hd_heat *heat;
    int32_t i, way;
    CHECK(hd_rational_get(&set, HD_POLES_KERNEL, 14, NULL) == HD_OK && set.n_poles == 7);
    set.kind = HD_POLES_OWN;
    parts = set;
    parts.n_poles = 28;
    parts.degree = 56;
    for (i = 0; i < 28; i++) {
        parts.theta[i] = set.theta[i / 4];
        parts.a[i] = hdi_cscale(0.25, set.a[i / 4]);
    }
    memset(&o, 0, sizeof o);
    o.method = HD_METHOD_DIRECT;
    for (way = 0; way < 2; way++) {
        o.rational = way ? &parts : &set;
        heat = NULL;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK && heat_column(heat, t, 11, u + way * lap->n, &rep) >= 0 && rep.n_poles == o.rational->n_poles);
        hd_heat_free(heat);
    }
    CHECK(dense_max_diff(u, u + lap->n, lap->n) < 1e-9 * dense_max_abs(u, lap->n));
    hd_laplacian_free(lap);
    free(u);
}

/* Diagonals that are off are seen by the probes, and those below what the constants alone make; at every time of a window. */
static void int_window_probes(void) {
    enum { TIMES = 4 };
    int kind;
    for (kind = 0; kind < 2; kind++) {
        hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
        hd_heat *heat = int_plan(lap);
        hdi_heat_call h;
        hdi_scope s;
        hdi_distance_shared z;
        double t[TIMES], *at, *keep;
        int32_t q, i;
        for (q = 0; q < TIMES; q++) t[q] = lap->h * lap->h * pow(3, q);
        CHECK(hdi_distance_begin(&h, heat, (hd_distance_kind)kind, TIMES, t, 1, NULL, NULL) >= 0);
        CHECK(hdi_heat_sort_times(&h, 2, NULL) >= 0 && hdi_heat_analysed(heat, h.e) >= 0);
        s = hdi_scope_begin(heat->ctx, h.e);
        CHECK(hdi_distance_shared_take(&z, &h, (hd_distance_kind)kind, 0, TIMES, &s) >= 0);
        CHECK(hdi_window_run(&h, &z.w, HDI_SHARED_DISTANCE_TOL, z.full ? HDI_WANT_FORMS : HDI_WANT_DIAGONAL) >= 0);
        hdi_distance_shared_probe(&z);
        for (q = 0; q < TIMES; q++) CHECK_MSG(z.rounding[q] > 0 && z.rounding[q] < 1e-6, "kind %d, time %d: %g", kind, (int)q, z.rounding[q]);
        keep = DENSE_NEW(double, (int64_t)z.w.n);
        for (q = 0; q < TIMES; q++) {            /* all by a thousandth, at one time */
            at = hdi_window_at(&z.w, z.w.values, q);
            for (i = 0; i < (int32_t)z.w.n; i++) {
                keep[i] = at[i];
                at[i] *= 1.001;
            }
            memset(z.rounding, 0, TIMES * sizeof *z.rounding);
            hdi_distance_shared_probe(&z);
            CHECK_MSG(z.rounding[q] >= 0.00099, "kind %d, time %d: %g", kind, (int)q, z.rounding[q]);
            memcpy(at, keep, z.w.n * sizeof *keep);
        }
        for (i = 0; i < z.m->sym.n; i++) {       /* one at which no probe looks, below the constants */
            const hdi_probe probe = hdi_probe_rows(z.m->lap, hdi_window_at(&z.w, z.w.values, TIMES - 1), -1);
            int32_t p, probed = 0;
            for (p = 0; p < probe.k; p++) probed |= probe.row[p] == i;
            if (!probed) break;
        }
        at = hdi_window_at(&z.w, z.w.values, 1);
        at[i] = 0.1 / z.m->lap->component_mass[0] * (kind ? z.m->lap->mass[i] * z.m->lap->mass[i] : 1);
        memset(z.rounding, 0, TIMES * sizeof *z.rounding);
        hdi_distance_shared_probe(&z);
        CHECK_MSG(z.rounding[1] >= 8.99, "kind %d: %g", kind, z.rounding[1]);
        free(keep);
        hdi_scope_end(&s);
        hdi_heat_end(&h);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
}

/* The same for the diagonal of the kernel. */
static void int_window_diagonal(void) {
    enum { TIMES = 4 };
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    hd_heat *heat = int_plan(lap);
    hdi_heat_call h;
    hdi_scope s;
    hdi_window w;
    hdi_probe probe;
    double t[TIMES], *at;
    int32_t q, i, p;
    for (q = 0; q < TIMES; q++) t[q] = lap->h * lap->h * pow(3, q);
    CHECK(hdi_distance_begin(&h, heat, HD_DISTANCE_CLASSICAL, TIMES, t, 1, NULL, NULL) >= 0);
    CHECK(hdi_heat_sort_times(&h, 1, NULL) >= 0 && hdi_heat_analysed(heat, h.e) >= 0);
    s = hdi_scope_begin(heat->ctx, h.e);
    hdi_window_take(&w, &h, 0, TIMES, &s);
    CHECK(hdi_window_run(&h, &w, HDI_SHARED_TOL, HDI_WANT_DIAGONAL) >= 0);
    probe = hdi_probe_rows(heat->elim.lap, hdi_window_at(&w, w.values, TIMES - 1), -1);     /* one row or two */
    CHECK(hdi_probe_run(&h, &probe, HD_KERNEL_SYMMETRIC, w.set) >= 0);
    for (i = 0; i == probe.row[0] || i == probe.row[probe.k - 1]; i++) {}
    for (q = 0; q < TIMES; q++) {
        const double off = hdi_window_rounding(heat, &w, &probe, q);
        CHECK_MSG(off > 0 && off < 1e-6, "time %d: %g", (int)q, off);
        at = hdi_window_at(&w, w.values, q);
        for (p = 0; p < lap->n_active; p++) at[p] *= 1.001;
        CHECK_MSG(hdi_window_rounding(heat, &w, &probe, q) >= 0.00099, "time %d: %g", (int)q, hdi_window_rounding(heat, &w, &probe, q));
        for (p = 0; p < lap->n_active; p++) at[p] /= 1.001;
        at[i] = 0.1 / heat->elim.lap->component_mass[0];    /* a row without a probe, below the constants */
        CHECK_MSG(hdi_window_rounding(heat, &w, &probe, q) >= 8.99, "time %d: %g", (int)q, hdi_window_rounding(heat, &w, &probe, q));
    }
    hdi_scope_end(&s);
    hdi_heat_end(&h);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

/* Resistances: what the residual of a column admits is part of rounding even where the column agrees with the diagonal, and a diagonal that is not
 * positive is of no use. */
static void int_ground_probes(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    hd_heat *heat = int_plan(lap);
    const hdi_elim *m = &heat->elim;
    hdi_ground *g = &heat->ground;
    hdi_heat_call h;
    hdi_metric x;
    hdi_scope s;
    double *room = DENSE_NEW(double, 4 * (int64_t)lap->n), *work, off = 0;
    int32_t i, far = 0;
    CHECK(hdi_heat_begin(&h, heat, HDI_QUERY_SYMMETRIC, NULL, NULL) >= 0 && hdi_heat_analysed(heat, h.e) >= 0);
    s = hdi_scope_begin(heat->ctx, h.e);
    memset(&x, 0, sizeof x);
    x.kind = HD_DISTANCE_COMMUTE;
    x.diag = room;
    x.g = room + lap->n;
    x.spread = x.g + lap->n;
    CHECK(hdi_metric_ground(&h, &x, &s) == HD_OK && x.rounding > 0 && x.rounding < 1e-8);
    work = DENSE_NEW(double, hdi_ground_room(m));
    for (i = 0; i < m->sym.n; i++) {             /* the diagonal by columns */
        const hdi_terms at = hdi_terms_vertex(m->lap->vertex[i]);
        const double bound = hdi_ground_column(m, g, &at, 0, x.spread + lap->n, work);
        CHECK(fabs(g->diag[i] - x.spread[lap->n + i]) <= 1e-9 * g->diag[i]);
        g->diag[i] = x.spread[lap->n + i];
        if (g->diag[i] < g->diag[far]) continue;
        far = i;
        off = bound * sqrt(g->diag[i]);
    }
    x.rounding = 0;
    CHECK(hdi_metric_ground(&h, &x, &s) == HD_OK);
    CHECK_MSG(off > 0 && x.rounding >= 0.999 * off / g->diag[far], "%g, the residual gives %g", x.rounding, off / g->diag[far]);
    for (i = 0; g->held[i] || i == far; i++) {}
    g->diag[i] = 0;
    x.rounding = 0;
    CHECK(hdi_metric_ground(&h, &x, &s) == HD_OK && x.rounding >= HUGE_VAL);
    hdi_scope_end(&s);
    hdi_heat_end(&h);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(room);
    free(work);
}

/* Biharmonic columns by arrays that are apart: G B G c, the means taken out, and the bounds of both solves. */
static void int_ground_apart(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active;
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_elim m;
    hdi_ground g;
    double *room, *x = DENSE_NEW(double, 6 * (int64_t)n), *b = x + n, *u = b + n, *y = u + n, *extra = y + n, *r = extra + n, *sweep;
    int32_t i, k;
    int64_t p;
    memset(&ctx, 0, sizeof ctx);
    memset(&g, 0, sizeof g);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK && hdi_ground_make(&m, &g, &e) == HD_OK && hdi_ground_forms(&m, &g, &e) == HD_OK);
    room = DENSE_NEW(double, (int64_t)hdi_ground_room(&m));
    sweep = DENSE_NEW(double, (int64_t)hdi_sweep_size(&m.sym, 1, 1));
    for (k = 0; k < n; k += 13) {
        const hdi_terms at = hdi_terms_vertex(m.lap->vertex[k]);
        const double bound = hdi_ground_column(&m, &g, &at, 1, x, room);
        double first, second, want, ws = g.mean[k], worst = 0, root = sqrt(fmax(0, g.diag[k]));
        memset(b, 0, (size_t)n * sizeof *b);
        if (!g.held[k]) b[k] = 1;
        hdi_ground_refined(&m, &g, b, NULL, u, &first, r, sweep);
        for (i = 0; i < n; i++) {
            b[i] = extra[i] = 0;
            for (p = m.lap->L.row_ptr[i]; p < m.lap->L.row_ptr[i + 1]; p++) {
                b[i] += m.lap->B[p] * u[m.lap->L.col[p]];
                extra[i] += fabs(m.lap->B[p] * u[m.lap->L.col[p]]);
            }
            extra[i] *= ((double)(m.lap->L.row_ptr[i + 1] - m.lap->L.row_ptr[i]) + 2) * DBL_EPSILON / 8;
            if (g.held[i]) b[i] = 0;
        }
        hdi_ground_refined(&m, &g, b, extra, y, &second, r, sweep);
        want = g.trace[0] * first + second + g.mean_off[0] * (fabs(ws) / m.lap->component_mass[0] + sqrt(g.trace[0] / m.lap->component_mass[0]) * root);
        for (i = 0; i < n; i++) worst = fmax(worst, fabs(x[i] - y[i] + ws * g.mean[i] / m.lap->component_mass[0]));
        CHECK_MSG(worst <= 1e-12 * dense_max_abs(y, n) && bound <= 1.01 * want && want <= 1.01 * bound, "column %d: off by %g, bound %g, not %g", (int)k, worst, bound, want);
    }
    hdi_ground_free(&g, &ctx);
    hdi_elim_free(&m);
    CHECK(ctx.bytes_in_use == 0);
    hd_laplacian_free(lap);
    free(room);
    free(x);
    free(sweep);
}

/* Parts of the bounds where heat fades: with X the pairs found and g = e_v/b_v, |X' B g| = |x(v)|, and |Q g|^2 = 1/b_v - |x(v)|^2. */
static void int_fading_reach(void) {
    shape s = shape_grid(12, 9, 0.2);
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_heat *heat;
    hd_error e = int_no_error();
    hdi_decay x;
    hdi_fading_far most;
    double *work, left = 0, found = 0, inner = 0, t;
    int32_t v, q;
    memset(&o, 0, sizeof o);
    o.kind = HD_LAPLACIAN_VORONOI_COT;
    o.border = HD_BORDER_DIRICHLET;
    hdi_error_clear(&e);
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &e) == HD_OK);
    heat = int_plan(lap);
    t = 20 * lap->h * lap->h;
    CHECK(hdi_modes_enough(heat, t, 5, HDI_MODES_MOST, &e) && e.status == HD_OK && heat->modes.s.count > 2 && heat->modes.s.count < lap->n_active / 2);
    work = DENSE_NEW(double, 2 * (int64_t)heat->modes.s.count + 3 * (int64_t)lap->n);
    x = hdi_decay_at(&heat->modes, t, work);
    most = hdi_fading_reach(&heat->modes, &x, work + 2 * heat->modes.s.count);
    for (v = 0; v < lap->n; v++) {
        double sum = 0, off = 0;
        if (lap->row[v] < 0) continue;
        for (q = 0; q < heat->modes.s.count; q++) {
            const double at = heat->modes.s.vector[(size_t)q * (size_t)lap->n + (size_t)v];
            sum += at * at;
            off += x.off[q] * fabs(at);
        }
        left = fmax(left, sqrt(fmax(0, 1 / lap->mass[lap->row[v]] - sum)));
        found = fmax(found, sqrt(sum));
        inner = fmax(inner, off);
    }
    CHECK_MSG(most.left >= left * (1 - 1e-9) && most.left <= 1.001 * left, "left %g, not %g", most.left, left);
    CHECK_MSG(fabs(most.found / found - 1) < 1e-9 && most.inner >= inner * (1 - 1e-9), "found %g, not %g; inner %g, not %g", most.found, found, most.inner, inner);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(work);
}

/* A diagonal where heat fades: the bound written out above the pairs' sums, with numbers of which each part is large. */
static void int_fading_note(void) {
    hd_laplacian *lap = int_path(3);
    hdi_modes of;
    hdi_fading_diagonal a;
    hdi_fading_size c[3];
    hdi_ledger ledger = hdi_modes_ledger();
    double left[3] = {0.09, 0.09, 0.09}, value[3] = {5, 5, 5}, out[3];
    const double s_c = 0.2 + 0.3 * 2, last = 0.7 + 0.3 * 2;   /* s(c) and the last sum, with m t |R| |c| = 0.3 times 2 */
    memset(&of, 0, sizeof of);
    memset(&a, 0, sizeof a);
    memset(c, 0, sizeof c);
    of.s.left = left;
    of.off_norm = 0.5;
    a.of = &of;
    a.lap = lap;
    a.value = value;
    a.c = a.g = c;
    a.decay.scale = a.decay.rest = 1;
    a.decay.mixed = 0.3;
    a.decay.t = 2;
    c[1].found = 4;
    c[1].inner = 0.7;
    c[1].side = 0.2;
    hdi_fading_diagonal_note(&a, 1, out, &ledger);
    CHECK_MSG(fabs(ledger.off.solver - (0.3 * 0.3 * 0.09 + 2 * s_c * 0.3 + 2 * last)) < 1e-12 && ledger.off.rational == 0, "bound %g", ledger.off.solver);
    hd_laplacian_free(lap);
}

/* An inversion keeps nothing beside the factors, and the bound of columns a number for each row. */
static void int_factor_need(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    hd_context ctx;
    hd_error e = int_no_error();
    hdi_elim m;
    hd_rational set;
    uint64_t solves;
    memset(&ctx, 0, sizeof ctx);
    CHECK(int_elim(&m, lap, &ctx, &e) == HD_OK && hdi_rational_get(&set, HD_POLES_KERNEL, 8, &e) == HD_OK);
    solves = hdi_elim_factor_need(&m, &set, HDI_AFTER_SOLVES);
    CHECK(solves > 0 && hdi_elim_factor_need(&m, &set, HDI_AFTER_INVERSE) == solves && hdi_elim_factor_need(&m, &set, HDI_AFTER_FORMS) == solves);
    CHECK(hdi_elim_factor_need(&m, &set, HDI_AFTER_BOUND) >= solves + 8 * (uint64_t)lap->n_active);
    hdi_elim_free(&m);
    hd_laplacian_free(lap);
}

/* The rows at which rounding is measured, by search. */
static void int_probe_rows(void) {
    hd_laplacian *lap = int_mesh(1, HD_LAPLACIAN_FEM);
    const int32_t n = lap->n_active;
    double *k = DENSE_NEW(double, 2 * (int64_t)n), *g = k + n;
    uint64_t seed = 8;
    int32_t i, round, p;
    for (round = 0; round < 20; round++) {
        int32_t first = 0, second = 0, least = 0, found = 0;
        hdi_probe probe;
        for (i = 0; i < n; i++) {
            k[i] = 1.5 + dense_signed(&seed);
            g[i] = 1.5 + dense_signed(&seed);
            if (hdi_row_diagonal(lap, i) / lap->b_diag[i] > hdi_row_diagonal(lap, first) / lap->b_diag[first]) first = i;
            if (hdi_row_diagonal(lap, i) * k[i] > hdi_row_diagonal(lap, second) * k[second]) second = i;
            if (k[i] / g[i] < k[least] / g[least]) least = i;
        }
        CHECK(hdi_window_worst(k, g, n) == least);
        probe = hdi_probe_rows(lap, k, least);
        for (p = 0; p < probe.k; p++) found |= (probe.row[p] == first) + 2 * (probe.row[p] == second) + 4 * (probe.row[p] == least);
        CHECK_MSG(found == 7 && probe.k <= 3, "rows %d, %d, %d: %d", (int)first, (int)second, (int)least, (int)found);
    }
    hd_laplacian_free(lap);
    free(k);
}

/* ---- [11] intrinsic ---- */

/* The area of a needle with sides 1, 1 and x, and of triangles of integer sides. */
static void int_length_area(void) {
    int k;
    for (k = 0; k < 300; k += 7) {
        const double x = pow(10, -k / 10.0), want = x / 4 * sqrt(4 - x * x);
        CHECK_MSG(fabs(hdi_length_area(1, 1, x) / want - 1) < 1e-15 && fabs(hdi_length_area(x, 1, 1) / want - 1) < 1e-15, "%g: %.17g", x, hdi_length_area(1, x, 1));
    }
    CHECK(hdi_length_area(3, 4, 5) == 6 && hdi_length_area(13, 5, 12) == 30 && hdi_length_area(15, 13, 14) == 84);
    CHECK(hdi_length_area(1, 2, 3) == 0 && hdi_length_area(1, 2, 4) == 0 && hdi_length_area(0, 1, 1) == 0 && hdi_length_area(9, 1, 1) == 0);
}

/* Sides glued to each other have the same length and run opposite ways; the sum of the angles around each vertex is left in angle [n]. */
static void int_cover_state(const hdi_cover *t, double *angle, int32_t n, double *area) {
    int32_t s, wrong = 0;
    for (s = 0; s < n; s++) angle[s] = 0;
    *area = 0;
    for (s = 0; s < 3 * t->n; s++) {
        const int32_t b = t->twin[s], next = hdi_side_next(s);
        CHECK(hdi_side_prev(next) == s && next / 3 == s / 3);
        angle[t->vert[s]] += atan2(1, hdi_side_cot(t, next));
        if (s % 3 == 0) *area += t->area[s / 3];
        if (b < 0) continue;
        wrong += t->twin[b] != s || b == s || t->len[b] != t->len[s] || t->vert[b] != t->vert[next] || t->vert[s] != t->vert[hdi_side_next(b)];
    }
    CHECK_MSG(wrong == 0, "%d sides are glued wrongly", wrong);
}

/* Flips leave every cone angle as it was, and the area; whether the surface is its own cover or not, and its boundary closed or not. */
static void int_flips(void) {
    hd_context ctx;
    hd_error e = int_no_error();
    int k, close, loops = 0;
    memset(&ctx, 0, sizeof ctx);
    for (k = 0; k < 4; k++) {
        for (close = 0; close < 2; close++) {
            shape s = k == 0 ? shape_bumpy(3, 4) : k == 1 ? shape_grid(20, 17, 0.42) : k == 2 ? shape_torus(14, 9, 2, 0.7) : shape_grid(9, 9, 0.4);
            hdi_scope scope = hdi_scope_begin(&ctx, &e);
            hd_mesh_report rep;
            hdi_mesh mesh, flat, over;
            hdi_mesh_wants want;
            hdi_edges edges;
            hdi_soup soup;
            hdi_cover t;
            int open = 0;
            double *before = DENSE_NEW(double, s.n), *after = DENSE_NEW(double, s.n), area_before, area_after, worst = 0;
            int32_t i;
            memset(&rep, 0, sizeof rep);
            for (i = 0; i < s.n; i++) s.xyz[3 * i] *= 6;
            for (i = 0; k == 3 && i < s.n_tri; i++)
                if (s.tri[3 * i] % 3 == 0) s.tri[3 * i] = 4;     /* any triangles */
            hdi_mesh_clear(&mesh, s.xyz, s.n, s.tri, s.n_tri);
            memset(&want, 0, sizeof want);
            CHECK(hdi_mesh_faces(&mesh, &edges, &want, &rep, &scope) == HD_OK);
            CHECK(hdi_soup_of_mesh(&soup, &mesh, 1e-5, &rep, &scope) == HD_OK);
            CHECK(hdi_cover_begin(&t, &soup, 0, &scope) == HD_OK && hdi_cover_whole(&t, close, &rep, &scope) == HD_OK);
            CHECK(t.n_sheets == (k == 0 || k == 2 || (k == 1 && !close) ? 1 : 2) && (k < 3 || rep.n_nonmanifold_edges > 5));
            int_cover_state(&t, before, s.n, &area_before);
            CHECK(hdi_cover_flip_all(&t, &rep) == HD_OK);
            hdi_cover_count(&t, &rep);
            CHECK_MSG(rep.n_flips > 20 && rep.n_not_delaunay == 0, "shape %d: %d flips, %d edges left", k, (int)rep.n_flips,
                      (int)rep.n_not_delaunay);
            int_cover_state(&t, after, s.n, &area_after);
            for (i = 0; i < s.n; i++) worst = fmax(worst, fabs(before[i] - after[i]));
            CHECK_MSG(worst < 1e-9, "shape %d: an angle around a vertex changed by %g", k, worst);
            CHECK_MSG(fabs(area_after / area_before - 1) < 1e-12, "shape %d: area %g not %g", k, area_after, area_before);
            for (i = 0; i < 3 * t.n; i++) open += t.twin[i] < 0;
            CHECK_MSG(open == (close ? 0 : t.n_sheets * (int)rep.n_boundary_edges), "shape %d: %d open sides", k, open);
            CHECK(hdi_cover_flat(&flat, &t, &rep, &scope) == HD_OK);
            soup.mesh.m = t.in_parts = 1 << 29;  /* with as many copies: corners beyond 32 bits, in sides as well as in keys */
            i = t.n;
            t.n = 1 << 28;
            CHECK(hdi_cover_flat(&over, &t, &rep, &scope) == HD_ERR_TOO_LARGE);
            hdi_error_clear(&e);
            t.n = i;
            for (i = 0; i < 3 * t.n; i += 3) CHECK(flat.tri[i] != flat.tri[i + 2] || flat.tri[i] == flat.tri[i + 1]);
            hdi_cover_free(&t);
            loops += (int)rep.n_self_edges;
            hdi_scope_end(&scope);
            free(before);
            free(after);
            shape_free(&s);
        }
    }
    CHECK(ctx.bytes_in_use == 0 && loops > 10);
}

/* Faces around an edge come by their angle, from the first one's, against the turn of the hand if the smaller vertex is below. */
static void int_around(void) {
    static const double angles[6] = {0.4, 3.0, 1.1, 5.9, 0.39, 4.0};
    static const int32_t want[6] = {0, 2, 1, 5, 3, 4};
    double xyz[3 * 8];
    int32_t tri[18], k;
    hdi_pair list[6];
    hdi_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    for (k = 0; k < 2; k++) {                    /* the axis goes up from 0 to 1 */
        xyz[3 * k] = 7;
        xyz[3 * k + 1] = -2;
        xyz[3 * k + 2] = 5 * k;
    }
    for (k = 0; k < 6; k++) {
        xyz[3 * k + 6] = 7 + (k + 1) * cos(angles[k]);
        xyz[3 * k + 7] = -2 + (k + 1) * sin(angles[k]);
        xyz[3 * k + 8] = k - 3;
        tri[3 * k] = k + 2;
        tri[3 * k + 1] = k % 2;
        tri[3 * k + 2] = 1 - k % 2;
        list[k].key = 1;
        list[k].id = 3 * k + 1;
    }
    mesh.xyz = xyz;
    mesh.tri = tri;
    hdi_sort_around(&mesh, 0, 1, list, 6);
    for (k = 0; k < 6; k++) CHECK_MSG(list[k].id == 3 * want[k] + 1, "place %d: face %d", k, (int)(list[k].id / 3));
}

/* Triangles among N points near the unit square, each from a point to two of those near it, up to three times and in any order of the corners. */
static int32_t int_soup_triangles(double *xyz, int32_t n, int32_t *tri, int copies, uint64_t seed) {
    int32_t i, k, q, m = 0;
    for (i = 0; i < n; i++) {
        xyz[3 * i] = i % 20 + 0.45 * shape_signed(&seed);
        xyz[3 * i + 1] = i / 20 + 0.45 * shape_signed(&seed);
        xyz[3 * i + 2] = 0.3 * shape_signed(&seed);
    }
    for (i = 0; i + 21 < n; i++) {
        for (k = 0; k < 4; k++) {
            const int32_t a = i, b = k & 1 ? i + 20 : i + 21, c = k < 2 ? i + 1 : k == 2 ? i + 21 : i + 20;
            if (b == c || shape_signed(&seed) > 0.6) continue;
            for (q = 0; q < copies && (q == 0 || shape_signed(&seed) > -0.3); q++) {
                const int turn = shape_signed(&seed) > 0;
                tri[m++] = turn ? b : a;
                tri[m++] = turn ? a : b;
                tri[m++] = c;
            }
        }
    }
    return m / 3;
}

/* (L, B) of a soup; everything: all of its cover is unfolded, glued and looked at, instead of what may have to be flipped. */
static hd_laplacian *int_soup_pair(const double *xyz, int32_t n, const int32_t *tri, int32_t m, int everything, hd_context *ctx, hd_mesh_report *rep) {
    hd_error e = int_no_error();
    hdi_scope s = hdi_scope_begin(ctx, &e);
    hd_laplacian *lap = (hd_laplacian *)hdi_alloc(ctx, 1, sizeof *lap, &e);
    hdi_soup soup;
    hdi_mesh flat;
    memset(lap, 0, sizeof *lap);
    memset(rep, 0, sizeof *rep);
    lap->n = n;
    lap->context = ctx;
    lap->kind = HD_LAPLACIAN_FEM;
    CHECK(hdi_soup_make(&soup, xyz, n, tri, m, 1e-5, rep, &s) == HD_OK);
    if (!everything) {
        CHECK(hdi_soup_delaunay(&flat, &soup, 0, rep, &s) == HD_OK);
    } else {
        hdi_cover c;
        int32_t v, p, q;
        CHECK(hdi_cover_begin(&c, &soup, 1, &s) == HD_OK);
        for (v = 0; v < n; v++) {
            for (p = soup.sides.ptr[v]; p < soup.sides.ptr[v + 1]; p = q) {
                for (q = p + 1; q < soup.sides.ptr[v + 1] && soup.sides.key[q] >> 32 == soup.sides.key[p] >> 32;) q++;
                CHECK(hdi_cover_glue(&c, v, p, q) == HD_OK);
            }
        }
        CHECK(c.n == 2 * m);
        for (p = 0; p < 3 * c.n; p++) {          /* closed: each side has another one, which runs the other way */
            const int32_t t = c.twin[p];
            CHECK(t >= 0 && t != p && c.twin[t] == p && c.vert[p] == c.vert[hdi_side_next(t)] && c.len[p] == c.len[t]);
        }
        for (c.depth = 0, p = 0; p < 3 * c.n; p++) c.waits[p] = 0;
        c.most_flips = INT64_MAX;
        CHECK(hdi_cover_flip_all(&c, rep) == HD_OK);
        hdi_cover_count(&c, rep);
        CHECK(hdi_cover_flat(&flat, &c, rep, &s) == HD_OK);
        CHECK(hdi_lap_flat(lap, &flat, &s) == HD_OK);
        hdi_cover_free(&c);
    }
    if (!everything) CHECK(hdi_lap_flat(lap, &flat, &s) == HD_OK);
    hdi_scope_end(&s);
    return lap;
}

/* Largest difference of two pairs on one pattern, relative to the largest entry; 1 when the patterns differ. scale: of the first. */
static double int_pair_difference(const hd_laplacian *a, const hd_laplacian *b, double scale) {
    double worst[2] = {0, 0}, most[2] = {0, 0};
    int64_t p;
    if (a->L.nnz != b->L.nnz || memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col)) return 1;
    for (p = 0; p < a->L.nnz; p++) {
        worst[0] = fmax(worst[0], fabs(scale * a->L.val[p] - b->L.val[p]));
        worst[1] = fmax(worst[1], fabs(scale * a->B[p] - b->B[p]));
        most[0] = fmax(most[0], fabs(b->L.val[p]));
        most[1] = fmax(most[1], fabs(b->B[p]));
    }
    return fmax(worst[0] / most[0], worst[1] / most[1]);
}

/* Two flat triangles, which a flip makes Delaunay, come 400 times: each copy is flipped on both sheets, and the sum is 400 times that of one. */
static void int_many_copies(void) {
    enum { COPIES = 400 };
    static const double xyz[12] = {0, 0, 0, 1, 0, 0, 0.5, 0.1, 0, 0.5, -0.1, 0};
    static const int32_t faces[6] = {0, 1, 2, 1, 0, 3};
    int32_t *tri = DENSE_NEW(int32_t, 6 * COPIES);
    hd_context ctx;
    hd_mesh_report rep;
    hd_laplacian *one, *all;
    int k;
    memset(&ctx, 0, sizeof ctx);
    for (k = 0; k < 6 * COPIES; k++) tri[k] = faces[k % 6];
    one = int_soup_pair(xyz, 4, tri, 2, 0, &ctx, &rep);
    CHECK(rep.n_flips == 2 && rep.n_not_delaunay == 0);
    all = int_soup_pair(xyz, 4, tri, 2 * COPIES, 0, &ctx, &rep);
    CHECK_MSG(rep.n_flips == 2 * COPIES && rep.n_not_delaunay == 0, "%d flips, %d edges left", (int)rep.n_flips, (int)rep.n_not_delaunay);
    CHECK(int_pair_difference(one, all, COPIES) < 1e-12);
    hdi_laplacian_free(one, &ctx);
    hdi_laplacian_free(all, &ctx);
    free(tri);
    CHECK(ctx.bytes_in_use == 0);
}

/* The cover of a soup unfolded where it has to be, against all of it; and for faces that come once, against that of the mesh, which is glued elsewhere. */
static void int_soup(void) {
    enum { N = 400 };
    double *xyz = DENSE_NEW(double, 3 * N);
    int32_t *tri = DENSE_NEW(int32_t, 3 * 12 * N);
    hd_context ctx;
    int round, flips = 0;
    memset(&ctx, 0, sizeof ctx);
    for (round = 0; round < 8; round++) {
        const int32_t m = int_soup_triangles(xyz, N, tri, round % 2 ? 3 : 1, 77u + (uint64_t)round);
        hd_mesh_report some, all;
        hd_laplacian *a = int_soup_pair(xyz, N, tri, m, 0, &ctx, &some), *b = int_soup_pair(xyz, N, tri, m, 1, &ctx, &all), *mesh = NULL;
        double d = int_pair_difference(a, b, 1);
        CHECK_MSG(d < 1e-9, "round %d: %g between some and all of the cover", round, d);
        CHECK_MSG(some.n_flips > 50 && some.n_not_delaunay == 0 && some.n_self_edges == all.n_self_edges, "round %d: %d flips, %d", round, (int)some.n_flips,
                  (int)all.n_flips);
        CHECK(fabs(some.smallest_intrinsic_angle - all.smallest_intrinsic_angle) < 1e-9 && some.n_edges == all.n_edges && some.n_faces == m);
        flips += (int)some.n_flips;
        if (round % 2 == 0) {
            hd_laplacian_opts o;
            memset(&o, 0, sizeof o);
            o.tufted = 1;
            CHECK(hd_laplacian_triangles(&mesh, xyz, N, tri, m, &o, NULL) == HD_OK);
            d = int_pair_difference(a, mesh, 3);
            CHECK_MSG(d < 1e-9, "round %d: %g between soup and mesh", round, d);
            CHECK(mesh->mesh.n_edges == some.n_edges && mesh->mesh.n_boundary_edges == some.n_boundary_edges && mesh->mesh.n_boundary_loops == some.n_boundary_loops);
            CHECK(mesh->mesh.n_nonmanifold_edges == some.n_nonmanifold_edges && mesh->mesh.n_misoriented_edges == some.n_misoriented_edges);
            CHECK(mesh->mesh.n_mollified == some.n_mollified && fabs(mesh->mesh.smallest_angle - some.smallest_angle) < 1e-12 && mesh->mesh.n_sheets == 2);
            hd_laplacian_free(mesh);
        }
        hdi_laplacian_free(a, &ctx);
        hdi_laplacian_free(b, &ctx);
    }
    CHECK(ctx.bytes_in_use == 0 && flips > 1000);
    free(xyz);
    free(tri);
}

/* Wheels whose hub has as many faces as a list sorted by insertion, one less and one more, two of them the same. */
static void int_wheels(void) {
    int32_t n, i;
    for (n = HDI_SHORT_LIST - 2; n < HDI_SHORT_LIST + 3; n++) {
        double xyz[3 * 30];
        int32_t tri[3 * 30];
        hd_laplacian *lap = NULL;
        memset(xyz, 0, sizeof xyz);
        for (i = 0; i < n; i++) {                /* n - 1 about the hub 0, the last of them again */
            const int32_t f = i < n - 1 ? i : n - 2;
            xyz[3 * i + 3] = cos(6.283185307179586 * i / (n - 1));
            xyz[3 * i + 4] = sin(6.283185307179586 * i / (n - 1));
            tri[3 * i] = 0;
            tri[3 * i + 1] = 1 + f;
            tri[3 * i + 2] = 1 + (f + 1) % (n - 1);
        }
        if (hd_laplacian_triangles(&lap, xyz, n, tri, n, NULL, NULL) >= 0)
            CHECK_MSG(lap->mesh.n_repeated_face == 1, "%d faces: %lld repeated", (int)n, (long long)lap->mesh.n_repeated_face);
        else CHECK(0);
        hd_laplacian_free(lap);
    }
}

/* A star by its definition: q is a neighbour of the origin in the Delaunay triangulation if some circle through both is empty. */
static void int_star(void) {
    enum { N = 40 };
    uint64_t seed = 5;
    int round;
    for (round = 0; round < 60; round++) {
        const int half = round % 3 == 0;         /* all on one side: an open star */
        hdi_star_point p[N], q[N];
        int32_t i, j, m, wrong = 0, found = 0;
        int closed;
        memset(p, 0, sizeof p);
        for (i = 0; i < N; i++) {
            const double x = shape_signed(&seed), y = half ? 0.01 + fabs(shape_signed(&seed)) : shape_signed(&seed), r2 = x * x + y * y;
            p[i].x = 2 * x / r2;
            p[i].y = 2 * y / r2;
            p[i].id = i;
        }
        memcpy(q, p, sizeof p);
        m = hdi_star_hull(q, N, &closed);
        CHECK(m >= 2 && closed == !half);
        for (i = 0; i < N; i++) {                /* centres on the bisector: a/|p|^2-like points c with c.p_i = 1, c.p_j <= 1 for all j: an interval */
            const double n2 = p[i].x * p[i].x + p[i].y * p[i].y, cx = p[i].x / n2, cy = p[i].y / n2;
            double low = -HUGE_VAL, high = HUGE_VAL;
            int in = 0;
            for (j = 0; j < N; j++) {
                const double slope = -p[i].y * p[j].x + p[i].x * p[j].y, rest = 1 - (cx * p[j].x + cy * p[j].y);
                if (j == i) continue;
                if (slope > 0) high = fmin(high, rest / slope);
                else low = fmax(low, rest / slope);
            }
            for (j = 0; j < m; j++) in |= q[j].id == i;
            wrong += in != (low < high);
            found += in;
        }
        CHECK_MSG(wrong == 0 && found == m, "round %d: %d neighbours wrong", round, wrong);
        for (j = 1; j < m; j++) {                /* by angle, from wherever the star begins */
            const double turn = remainder(q[j].angle - q[j - 1].angle, 4);
            CHECK(turn > 0 || turn < -1.9);
        }
    }
}

/* ---- [08] spatial, [10] points ---- */

static void int_sort_keys(void) {
    uint64_t a[300], b[300], work[300], seed = 5;
    int32_t n, i, j, bad = 0;
    for (n = 0; n < 300; n++) {
        for (i = 0; i < n; i++) a[i] = b[i] = n % 3 == 0 ? dense_random(&seed) : n % 3 == 1 ? dense_random(&seed) % 9 : (uint64_t)(n - i);
        hdi_sort_keys(a, n, work);
        for (i = 1; i < n; i++) {                /* the same by insertion */
            const uint64_t x = b[i];
            for (j = i; j > 0 && x < b[j - 1]; j--) b[j] = b[j - 1];
            b[j] = x;
        }
        bad += memcmp(a, b, (size_t)n * sizeof *a) != 0;
    }
    CHECK_MSG(bad == 0, "%d lists out of order", (int)bad);
}

/* The k-th point along an axis, among points of which many are equal, and the longest axis of a box. */
static void int_select_points(void) {
    hdi_point a[81];
    hdi_cell cell;
    uint64_t seed = 14;
    int32_t n, k, i, c, bad = 0;
    for (n = 1; n <= 80; n += 1 + n / 4) {
        for (k = 0; k < n; k++) {
            const int axis = k % 3;
            int64_t sum = 0;
            for (i = 0; i < n; i++) {
                for (c = 0; c < 3; c++) a[i].x[c] = k % 2 ? (double)(dense_random(&seed) % 6) : dense_signed(&seed);
                a[i].id = i;
            }
            for (c = 0; c < 3; c++) a[n].x[c] = -9;      /* not one of them */
            a[n].id = 1000;
            hdi_select_point(a, n, k, axis);
            for (i = 0; i < n; i++) {
                sum += a[i].id;
                bad += i < k ? a[i].x[axis] > a[k].x[axis] : a[i].x[axis] < a[k].x[axis];
            }
            bad += sum != n * (n - 1) / 2 || a[n].id != 1000;
        }
    }
    CHECK_MSG(bad == 0, "%d on the wrong side of the k-th", (int)bad);
    for (k = 0; k < 3; k++) {
        for (i = 0; i < 80; i++)
            for (c = 0; c < 3; c++) a[i].x[c] = (c == k ? 3 : c == (k + 1) % 3 ? 2 : 1) * (dense_signed(&seed) + 4);
        a[7].x[k] = 0;
        CHECK(hdi_cell_box(&cell, a, 80) == k && cell.lo[k] == 0);
    }
}

/* The plane through points of a plane, whatever comes behind them in memory. */
static void int_tangent_planes(void) {
    double rel[3 * 13], normal[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3};
    uint64_t seed = 16;
    hdi_plane plane[2];
    int32_t way, k, c;
    for (k = 0; k < 12; k++) {
        const double x = dense_signed(&seed), y = dense_signed(&seed);
        rel[3 * k] = x;                          /* 2 x - y + 2 z = 0 */
        rel[3 * k + 1] = y;
        rel[3 * k + 2] = (y - 2 * x) / 2;
    }
    memset(plane, 0, sizeof plane);
    for (way = 0; way < 2; way++) {
        double along = 0;
        for (c = 0; c < 3; c++) rel[36 + c] = way ? 50 : 0;
        plane[way] = hdi_tangent_plane(rel, 12);
        for (c = 0; c < 3; c++) along += plane[way].axis[2][c] * normal[c];
        CHECK_MSG(fabs(fabs(along) - 1) < 1e-12 && fabs(plane[way].height) < 1e-12, "%.17g from the normal", along);
    }
    rel[0] += 0.3;
    rel[36] = 0;
    plane[0] = hdi_tangent_plane(rel, 12);
    rel[36] = 50;
    plane[1] = hdi_tangent_plane(rel, 12);
    CHECK(memcmp(plane[0].axis, plane[1].axis, sizeof plane[0].axis) == 0 && plane[0].height == plane[1].height);
}

static void int_kth(void) {
    double a[100], b[100];
    uint64_t seed = 6;
    int32_t n, k, i, bad = 0;
    for (n = 1; n < 100; n += 7) {
        for (k = 0; k < n; k++) {
            int32_t below = 0, equal = 0;
            for (i = 0; i < n; i++) a[i] = b[i] = k % 2 ? (double)(dense_random(&seed) % 5) : dense_signed(&seed);
            (void)hdi_kth(a, n, k);
            for (i = 0; i < n; i++) {
                below += b[i] < a[k];
                equal += b[i] == a[k];
            }
            bad += !(below <= k && k < below + equal);
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
        for (i = 0; i < 3; i++)
            for (j = 0; j <= i; j++) a[i][j] = a[j][i] = round % 5 == 0 && i != j ? 0 : pow(10, round % 7 - 3) * dense_signed(&seed);
        for (i = 0; i < 3 && round % 4 == 1; i++)   /* rank one */
            for (j = 0; j < 3; j++) a[i][j] = (i + 1.0) * (j + 1.0);
        for (i = 0; i < 3 && round % 4 == 2; i++)   /* a multiple of the identity */
            for (j = 0; j < 3; j++) a[i][j] = i == j ? 2 : 0;
        memcpy(keep, a, sizeof a);
        hdi_eigen3(a, w, v);
        CHECK(w[0] <= w[1] && w[1] <= w[2]);
        for (i = 0; i < 3; i++) {
            for (j = 0; j < 3; j++) {
                double sum = 0, dot = 0;
                for (c = 0; c < 3; c++) {
                    sum += w[c] * v[c][i] * v[c][j];
                    dot += v[i][c] * v[j][c];
                }
                worst = fmax(worst, fabs(sum - keep[i][j]));
                top = fmax(top, fabs(keep[i][j]));
                CHECK_MSG(fabs(dot - (i == j)) < 1e-14, "round %d: vectors %d and %d: %g", round, i, j, dot);
            }
        }
        CHECK_MSG(worst < 4e-15 * top, "round %d: off by %g", round, worst / top);
    }
}

/* A star: every cut through it would add as many corners as it has points. */
static void int_polygon_room(void) {
    struct { hdi_polygon g; double guard[512]; } at;
    hdi_polygon before;
    int32_t i, k;
    memset(&at, 0, sizeof at);
    for (i = 0; i < 512; i++) at.guard[i] = 77;
    at.g.n = 240;
    for (i = 0; i < at.g.n; i++) {
        const double r = i % 2 ? 1 : 3, phi = 6.283185307179586 * i / at.g.n;
        at.g.x[i][0] = r * cos(phi);
        at.g.x[i][1] = r * sin(phi);
    }
    for (k = 0; k < 40; k++) {
        before = at.g;
        if (!hdi_polygon_clip(&at.g, cos(0.1 * k), sin(0.1 * k), 2)) CHECK(memcmp(&before, &at.g, sizeof before) == 0);
        CHECK(at.g.n >= 0 && at.g.n <= HDI_POLYGON_MOST);
    }
    for (i = 0; i < 512; i++) CHECK(at.guard[i] == 77);
    at.g.n = HDI_CELL_SIDES;                     /* a circle by as many cuts as there can be */
    for (i = 0; i < at.g.n; i++) {
        at.g.x[i][0] = 2 * cos(6.283185307179586 * i / at.g.n);
        at.g.x[i][1] = 2 * sin(6.283185307179586 * i / at.g.n);
    }
    for (k = 0; k < 2 * HDI_MOST_NEIGHBOURS; k++) {
        const double phi = 6.283185307179586 * (k * 101 % 256) / 256;
        CHECK(hdi_polygon_clip(&at.g, cos(phi), sin(phi), 1));
    }
    CHECK(at.g.n == 2 * HDI_MOST_NEIGHBOURS);
}

/* A square cut by half-planes, and by a hull. */
static void int_polygon(void) {
    static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    double x[6][2] = {{0, 0}, {0.5, 0}, {0, 0.5}, {0.1, 0.1}, {0.25, 0.25}, {0, 0}}, line[3][2] = {{0, 0}, {1, 1}, {0.5, 0.5}};
    hdi_polygon g;
    g.n = 4;
    memcpy(g.x, square, sizeof square);
    CHECK(!hdi_polygon_clip(&g, 1, 1, 2) && g.n == 4 && hdi_polygon_area(&g) == 4);
    CHECK(hdi_polygon_clip(&g, 1, 1, 1) && g.n == 5 && fabs(hdi_polygon_area(&g) - 3.5) < 1e-15);
    CHECK(hdi_polygon_clip(&g, -1, 0, 0) && fabs(hdi_polygon_area(&g) - 1.5) < 1e-15);
    CHECK(hdi_polygon_clip_hull(&g, x, 6) && fabs(hdi_polygon_area(&g) - 0.125) < 1e-15);
    CHECK(hdi_polygon_clip_hull(&g, line, 3) && fabs(hdi_polygon_area(&g)) < 1e-15);
    CHECK(!hdi_polygon_clip(&g, 1, 0, 5));
}

/* ---- [29] geodesic ---- */

/* The gradient on polygons is exact for linear functions, and L is its divergence: div of the unit field down a linear u is -L u / |grad u|, at the border too. */
static void int_linear_precision(void) {
    shape_poly s = shape_trominoes(4, 5, 0.3);
    hd_geodesic *g = NULL;
    double *u = (double *)calloc(3 * (size_t)s.n, sizeof *u), *b = u + s.n, *want = b + s.n, worst = 0;
    int32_t v;
    int way;
    CHECK(hd_geodesic_create_polygons(&g, s.xyz, s.n, s.face_ptr, s.face_idx, s.n_faces, NULL, NULL) == HD_OK);
    for (way = 0; way < 5 && g; way++) {
        const double x = cos(1.1 * way), y = sin(1.1 * way);     /* down along (x, y) by 0.01 a unit */
        for (v = 0; v < s.n; v++) {
            u[g->row[v]] = 1 - 0.01 * (x * s.xyz[3 * v] + y * s.xyz[3 * v + 1]);
            want[g->row[v]] = 0;
        }
        hdi_geo_divergence(g, u, 1e-9, b);
        for (v = 0; v < s.n; v++) u[v] /= 0.01 * g->h;
        hdi_geo_subtract(g, u, want);
        for (v = 0; v < s.n; v++) worst = hdi_max(worst, fabs(b[v] - want[v]));
    }
    CHECK_MSG(worst < 1e-11, "off by %g", worst);
    hd_geodesic_free(g);
    free(u);
    shape_poly_free(&s);
}

/* A curve's piece in a face of sides 2, about corners that the face does not begin with: its length, and how far the corners are from it. */
static void int_item_near(void) {
    double near_by[6], want[6];
    hdi_geo_face face;
    hdi_geo_item item;
    hdi_geo_spot spot;
    int i;
    memset(&face, 0, sizeof face);
    memset(&item, 0, sizeof item);
    memset(&spot, 0, sizeof spot);
    face.l = 1;                                  /* half of the sides */
    face.p = 0.5;
    face.q = sqrt(0.75);
    face.v[0] = 4;
    face.v[1] = 2;
    face.v[2] = 5;
    face.copies = 1;
    item.n = 2;                                  /* from the middle of a side to the corner at (2, 0) */
    item.row[0] = 4;
    item.row[1] = 2;
    item.a[0] = item.a[1] = 0.5;
    item.b[1] = 1;
    spot.near_by = near_by;
    for (i = 0; i < 6; i++) near_by[i] = want[i] = HUGE_VAL;
    want[4] = 1;
    want[2] = 0;
    want[5] = sqrt(3.0);
    CHECK(hdi_geo_item_in(&spot, &item, &face) && fabs(item.length - 1) < 1e-15);
    for (i = 0; i < 6; i++) CHECK_MSG(near_by[i] == want[i] || fabs(near_by[i] - want[i]) < 1e-15, "corner %d: %g", i, near_by[i]);
    item.row[1] = 3;                             /* no corner of this face */
    CHECK(!hdi_geo_item_in(&spot, &item, &face));
}

/* The residual of the heat equation stays within its arrays. */
static void int_geo_heat_off(void) {
    shape s = shape_grid(6, 5, 0.2);
    hd_geodesic *g = NULL;
    double *u = DENSE_NEW(double, s.n + 1), *r = DENSE_NEW(double, s.n + 1);
    int32_t i;
    CHECK(hd_geodesic_create(&g, s.xyz, s.n, s.tri, s.n_tri, NULL, NULL) == HD_OK && g->n_active == s.n);
    for (i = 0; i < s.n; i++) {                  /* what a constant makes: no more than the masses */
        u[i] = 2;
        r[i] = 2 * g->mass[i];
    }
    u[s.n] = r[s.n] = 1e9;
    CHECK(hdi_geo_heat_off(g, u, r) < 1e-12 && r[s.n] == 1e9);
    hd_geodesic_free(g);
    shape_free(&s);
    free(u);
    free(r);
}

/* A matrix that has no factors: the error names a vertex, as rows are none of the caller's. */
static void int_geo_no_factor(void) {
    shape s = shape_grid(6, 5, 0.2);
    hd_laplacian *lap = NULL;
    hd_geodesic *g = NULL;
    hdi_factor f;
    hd_error e = int_no_error();
    double *val;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, NULL, NULL) == HD_OK && hd_geodesic_create(&g, s.xyz, s.n, s.tri, s.n_tri, NULL, NULL) == HD_OK);
    val = DENSE_NEW(double, lap->L.nnz);
    memset(&f, 0, sizeof f);
    hdi_error_clear(&e);
    CHECK(hdi_geo_factor(g, &f, lap, val, &e) == HD_ERR_BREAKDOWN);
    CHECK_MSG(e.row == -1 && e.vertex >= 0 && e.vertex < s.n, "row %lld, vertex %lld", (long long)e.row, (long long)e.vertex);
    hdi_factor_free(&f);
    hd_geodesic_free(g);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(val);
}

/* What is known of an error by numbers that are none, or infinite: nothing, and of progress that it has begun. */
static void int_no_numbers(void) {
    const double none = (double)NAN, endless = (double)INFINITY;
    CHECK(hdi_probe_seen(none, 0, 1, 1) >= HUGE_VAL && hdi_probe_seen(1, none, 1, 1) >= HUGE_VAL);
    TRAPS_OFF;                                   /* infinity less infinity */
    CHECK(hdi_probe_seen(endless, 0, endless, 1) >= HUGE_VAL);
    TRAPS_ON;
    CHECK(hdi_probe_seen(1, 0, 1, 1) == 0 && hdi_probe_seen(1, 1e-9, 1, 2) == 5e-10);
    CHECK(hdi_krylov_done(endless, endless, 1) == 0 && hdi_krylov_done(endless, 2, 1) == 0 && hdi_krylov_done(endless, endless, endless) == 1);
    CHECK(hdi_krylov_done(1, 1e-3, 1e-6) == 0.5 && hdi_krylov_done(1, 2, 1e-6) == 0 && hdi_krylov_done(1, 1, 0) == 0);
    CHECK(hdi_krylov_done(1, endless, 1e-6) == 0 && fabs(hdi_krylov_done(1e300, 1, 1e-300) - 0.5) < 1e-15);
}

/* A bound is never a share of an infinite value: an infinite part stays infinite, and an infinite value is an error. */
static void int_ledger_infinite(void) {
    static const double value[3] = {2, 2, HUGE_VAL}, part[3] = {1, HUGE_VAL, 1};
    int k;
    for (k = 0; k < 3; k++) {
        hdi_ledger l = hdi_ledger_begin(HD_EVIDENCE_PROVEN, HD_EVIDENCE_PROVEN, HD_EVIDENCE_PROVEN, 1);
        hdi_parts off = {0, 0, 0};
        hd_report rep;
        memset(&rep, 0, sizeof rep);
        hdi_error_clear(&rep.error);
        off.solver = part[k];
        hdi_ledger_note(&l, 1, off);
        hdi_ledger_note(&l, value[k], off);
        hdi_ledger_close(&l, &rep);
        if (k == 0) CHECK(rep.error_bound == 0.5 && rep.error.status == HD_OK);
        if (k == 1) CHECK(rep.error_bound == HUGE_VAL && rep.error_relative == HUGE_VAL);
        if (k == 2) CHECK(rep.error.status == HD_ERR_BREAKDOWN);
    }
}

/* ---- [04] context: tasks of threads ---- */

/* Tasks of a loop that release others: each is done once, after what it waits for, by any number of threads. A
 * binary tree, from the leaves up. */
typedef struct int_tree { hd_context *ctx; int32_t *order, *pending; int64_t *sum; int32_t leaves; int64_t wrong; } int_tree;

static void int_tree_task(void *arg, int64_t index, int32_t worker) {
    int_tree *w = (int_tree *)arg;
    const int32_t i = (int32_t)index, up = i / 2;
    (void)worker;
    if (i < w->leaves) w->sum[i] = w->sum[2 * i] + w->sum[2 * i + 1];
    else w->sum[i] = i;
    if (up > 0 && HDI_ATOMIC_ADD(w->pending + up, -1) == 0) hdi_release(w->ctx->threads, up, w->order);
}

static void int_release(void) {
    enum { LEAVES = 512 };
    int32_t order[2 * LEAVES], pending[2 * LEAVES], i, threads, round;
    int64_t sum[2 * LEAVES];
    for (threads = 2; threads < 9; threads++) {
        hd_context ctx;
        int_tree w;
        memset(&ctx, 0, sizeof ctx);
        memset(&w, 0, sizeof w);
        ctx.n_threads = threads;
        w.ctx = &ctx;
        w.order = order;
        w.pending = pending;
        w.sum = sum;
        w.leaves = LEAVES;
        hdi_hold(&ctx);
        for (round = 0; round < 50 && hdi_threads_own(&ctx, 2 * LEAVES); round++) {
            for (i = 0; i < 2 * LEAVES; i++) pending[i] = 2;
            for (i = 0; i < LEAVES; i++) order[i] = LEAVES + i;
            memset(sum, 0, sizeof sum);
            hdi_parallel_ordered(&ctx, 2 * LEAVES - 1, LEAVES, order, int_tree_task, &w);
            CHECK(sum[1] == (int64_t)LEAVES * (3 * LEAVES - 1) / 2);
        }
        hdi_let_go(&ctx);
        CHECK(!ctx.threads && ctx.regions == (uint64_t)round);
    }
}

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
        HDI_ATOMIC_SET(&w->slept, int_caller_sleeps(w->threads));
    }
    while (worker == 0 && HDI_ATOMIC_GET(&w->begun) == 0 && time(NULL) < start + 60) {}
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
    CHECK(w.threads || !hdi_threads_linked());
    hdi_let_go(&ctx);
    CHECK(!ctx.threads);
#endif
}

static void int_all(void) {
    int_ledger_infinite();
    int_no_numbers();
    int_linear_precision();
    int_geo_heat_off();
    int_geo_no_factor();
    int_length_area();
    int_flips();
    int_around();
    int_soup();
    int_star();
    int_wheels();
    int_sort_keys();
    int_fit_constant();
    int_sweep_panels();
    int_many_copies();
    int_item_near();
    int_kth();
    int_select_points();
    int_tangent_planes();
    int_eigen3();
    int_polygon();
    int_polygon_room();
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
    int_deflation();
    int_warm_start();
    int_pole_bounds();
    int_lanczos_bound();
    int_real_kernels();
    int_pack_kernels();
    int_symbolic();
    int_symbolic_large();
    int_gaps();
    int_sweeps();
    int_checks();
    int_check_plain();
    int_silan_slopes();
    int_silan_bounds();
    int_lanczos_pace();
    int_ritz_above();
    int_batches();
    test_shared();
    int_invert();
    int_resolvent_pole();
    int_resolvent_imaginary();
    int_pairs_by_entries();
    int_pairs_few();
    int_pairs_in_parts();
    int_distance_windows();
    int_noise_weights();
    int_lambda_bound();
    int_conserve_sums();
    int_turned();
    int_many_packs();
    int_window_probes();
    int_window_diagonal();
    int_ground_probes();
    int_ground_apart();
    int_fading_reach();
    int_fading_note();
    int_probe_rows();
    int_factor_need();
    int_ground_need();
    int_ground_refined();
    int_parts();
    int_release();
    int_few_tasks();
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
