/* test_deep.h - sizes at which recursion and 32 bits would end: paths and stars of a million vertices on a stack of
 * 256 KB, and a factor of more than 2^31 entries, of which only the analysis is made */

#ifndef TEST_DEEP_H
#define TEST_DEEP_H

enum { DEEP_N = 1000000, DEEP_STACK = 256 * 1024, DEEP_WIDE = 70000 };

/* Diagonal 1 + degree, -1 along the edges: a path, or a star around vertex 0. */
static hd_csr deep_matrix(int32_t n, int star, double shift) {
    const int64_t count = 3 * (int64_t)n - 2;
    int32_t *i = KIT_NEW(int32_t, count), *j = KIT_NEW(int32_t, count), v;
    double *x = KIT_NEW(double, count);
    hd_csr a;
    int64_t q = 0;
    memset(&a, 0, sizeof a);
    for (v = 0; v < n; v++) {
        const int32_t to = star ? 0 : v - 1;
        i[q] = j[q] = v;
        x[q++] = shift + (star ? v ? 1 : n - 1 : (v > 0) + (v + 1 < n));
        if (v == 0) continue;
        i[q] = j[q + 1] = v;
        j[q] = i[q + 1] = to;
        x[q] = x[q + 1] = -1;
        q += 2;
    }
    CHECK(hd_csr_from_triplets(&a, n, n, q, i, j, x, NULL, NULL) == HD_OK);
    return a;
}

/* Analysis, factor and solve: L + I has the solution 1 for the right-hand side 1. */
static void deep_factor(const hd_csr *a, const int32_t *perm, const char *what) {
    double *x = KIT_NEW(double, a->n_rows), worst = 0;
    hd_ldl *f = NULL;
    hd_ldl_opts o;
    hd_ldl_report r;
    int32_t v;
    memset(&o, 0, sizeof o);
    o.ordering = perm ? HD_ORDERING_OWN : HD_ORDERING_AUTO;
    o.perm = perm;
    for (v = 0; v < a->n_rows; v++) x[v] = 1;
    if (CHECK(hd_ldl_analyse(&f, a, &o, &r, NULL) == HD_OK) && CHECK(hd_ldl_factor(f, a->val, &r, NULL) == HD_OK)) {
        CHECK_MSG(r.factor_nnz == 2 * (int64_t)a->n_rows - 1, "%s: %lld entries", what, (long long)r.factor_nnz);
        CHECK(hd_ldl_solve(f, 1, x, 0, x, 0, NULL) == HD_OK);
    }
    for (v = 0; v < a->n_rows; v++) worst = fmax(worst, fabs(x[v] - 1));
    CHECK_MSG(worst < 1e-9, "%s: off by %g", what, worst);
    hd_ldl_free(f);
}

/* One column on a long path, by a factor and by Lanczos. */
static void deep_column(int32_t n) {
    hd_csr L = kit_own_csr(deep_matrix(n, 0, 0)), B = kit_own_csr(deep_matrix(n, 0, 0));
    hd_laplacian *lap = NULL;
    double *u = KIT_NEW(double, n), *w = KIT_NEW(double, n), worst = 0;
    hd_report r[2];
    int32_t v;
    int64_t p;
    int q;
    for (v = 0; v < n; v++)
        for (p = B.row_ptr[v]; p < B.row_ptr[v + 1]; p++) B.val[p] = B.col[p] == v;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, NULL) == HD_OK);
    for (q = 0; q < 2 && lap; q++) {
        hd_heat_opts o;
        hd_heat *heat = NULL;
        memset(&o, 0, sizeof o);
        o.method = q ? HD_METHOD_ITERATIVE : HD_METHOD_KRYLOV;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, 10, n / 2, q ? w : u, r + q, NULL) == HD_OK);
        hd_heat_free(heat);
    }
    for (v = 0; v < n; v++) worst = fmax(worst, fabs(u[v] - w[v]));
    CHECK_MSG(worst <= u[n / 2] * (r[0].error_bound + r[1].error_bound), "a path: two methods are %g apart", worst);
    hd_laplacian_free(lap);
}

static void *deep_all(void *arg) {
    hd_csr path = kit_own_csr(deep_matrix(DEEP_N, 0, 1)), star = kit_own_csr(deep_matrix(DEEP_N, 1, 1));
    int32_t *perm = KIT_NEW(int32_t, DEEP_N), v;
    for (v = 0; v < DEEP_N; v++) perm[v] = v;
    deep_factor(&path, perm, "path from end to end");    /* a tree as deep as the path is long */
    deep_factor(&path, NULL, "path");
    deep_factor(&star, NULL, "star");
    deep_column(DEEP_N);
    return arg;
}

/* A star whose middle goes first fills up: n (n + 1)/2 entries, more than 32 bits count. */
static void deep_wide(void) {
    hd_csr star = kit_own_csr(deep_matrix(DEEP_WIDE, 1, 1));
    const int64_t entries = (int64_t)DEEP_WIDE * (DEEP_WIDE + 1) / 2;
    int32_t *perm = KIT_NEW(int32_t, DEEP_WIDE), v;
    hd_context ctx;
    hd_ldl *f = NULL;
    hd_ldl_opts o;
    hd_ldl_report r;
    hd_error e;
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    ctx.byte_limit = (uint64_t)1 << 30;
    for (v = 0; v < DEEP_WIDE; v++) perm[v] = v;
    o.ordering = HD_ORDERING_OWN;
    o.perm = perm;
    o.context = &ctx;
    if (CHECK(hd_ldl_analyse(&f, &star, &o, &r, &e) == HD_OK)) {
        CHECK_MSG(r.factor_nnz == entries && entries > INT32_MAX, "%lld entries", (long long)r.factor_nnz);
        CHECK(r.stored >= entries && r.factor_flops > 1e14);
        CHECK(hd_ldl_factor(f, star.val, &r, &e) == (sizeof(size_t) > 4 ? HD_ERR_MEMORY_LIMIT : HD_ERR_TOO_LARGE));
        if (sizeof(size_t) > 4) CHECK_MSG(e.value >= 8.0 * (double)entries, "a need of %g bytes", e.value);
    }
    hd_ldl_free(f);
    CHECK(ctx.bytes_in_use == 0);
}

static void test_deep(void) {
#ifdef LDL_THREADS
    pthread_attr_t small;
    pthread_t thread;
    if (CHECK(pthread_attr_init(&small) == 0) && CHECK(pthread_attr_setstacksize(&small, DEEP_STACK) == 0) &&
        CHECK(pthread_create(&thread, &small, deep_all, NULL) == 0)) pthread_join(thread, NULL);
    pthread_attr_destroy(&small);
#else
    deep_all(NULL);
#endif
    deep_wide();
}

#endif
