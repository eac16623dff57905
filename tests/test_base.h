/* test_base.h - statuses, versions, contexts, memory; and helpers that other groups use too */

#ifndef TEST_BASE_H
#define TEST_BASE_H

/* ---- an allocator that counts, checks the sizes it gets back, and fails on demand ---- */

typedef struct test_memory {
    int64_t live, calls;
    uint64_t bytes;
    int64_t fail_at;        /* this call gets nothing; 0: none fails */
    int64_t wrong;          /* blocks that came back with another size */
    int64_t fail_one_in;    /* one call of so many gets nothing, at random; 0: none */
    int64_t failed;         /* calls that got nothing */
    uint32_t random;
} test_memory;

static int test_memory_fails(test_memory *m) {
    int fails = m->calls == m->fail_at;
    if (m->fail_one_in) {
        m->random = m->random * 1664525u + 1013904223u;
        fails |= (m->random >> 8) % (uint32_t)m->fail_one_in == 0;
    }
    m->failed += fails;
    return fails;
}

/* Blocks are aligned to 8 bytes and no more, which is all that a library may ask for. */
static void *test_memory_alloc(void *user, size_t size) {
    test_memory *m = (test_memory *)user;
    uint64_t head = size;
    char *p;
    m->calls++;
    if (test_memory_fails(m)) return NULL;
    p = (char *)malloc(size + sizeof head);
    if (!p) return NULL;
    memcpy(p, &head, sizeof head);
    memset(p + sizeof head, 0xa5, size);         /* whoever reads before writing gets nonsense */
    m->live++;
    m->bytes += size;
    return p + sizeof head;
}

static void test_memory_free(void *user, void *block, size_t size) {
    test_memory *m = (test_memory *)user;
    uint64_t head;
    char *p = (char *)block - sizeof head;
    memcpy(&head, p, sizeof head);
    m->wrong += head != size;
    m->live--;
    m->bytes -= head;
    free(p);
}

static hd_context test_memory_context(test_memory *m) {
    hd_context ctx;
    memset(&ctx, 0, sizeof ctx);
    memset(m, 0, sizeof *m);
    ctx.allocator.alloc = test_memory_alloc;
    ctx.allocator.free = test_memory_free;
    ctx.allocator.user = m;
    return ctx;
}

/* Nothing left, on both books. */
static void test_memory_done(const test_memory *m, const hd_context *ctx, const char *what) {
    CHECK_MSG(m->live == 0 && m->bytes == 0, "%s: %lld blocks left", what, (long long)m->live);
    CHECK_MSG(m->wrong == 0, "%s: %lld blocks freed with a wrong size", what, (long long)m->wrong);
    CHECK_MSG(ctx->bytes_in_use == 0, "%s: %llu bytes left in the context", what, (unsigned long long)ctx->bytes_in_use);
}

/* What passed since then counts as one: how often some loops go round depends on the clock. */
static void test_count_once(int64_t passed) {
    if (test_passed > passed) test_passed = passed + 1;
}

/* ---- short forms ---- */

static hd_c64 test_c(double re, double im) {
    hd_c64 z;
    z.re = re;
    z.im = im;
    return z;
}

/* A shape's Laplacian with these coordinates; ctx may be NULL. */
static hd_laplacian *test_laplacian_at(const shape *s, const double *xyz, hd_laplacian_kind kind, int updatable, hd_context *ctx) {
    hd_laplacian_opts opts;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&opts, 0, sizeof opts);
    opts.kind = kind;
    opts.updatable = updatable;
    opts.context = ctx;
    CHECK(xyz != NULL);
    if (!CHECK(hd_laplacian_triangles(&lap, xyz, s->n, s->tri, s->n_tri, &opts, &e) == HD_OK)) printf("    %s\n", e.text);
    return lap;
}

static hd_laplacian *test_laplacian(const shape *s, hd_laplacian_kind kind) { return test_laplacian_at(s, s->xyz, kind, 0, NULL); }

/* The values of a sparse matrix, or val instead of its own, in a dense one. */
static double *test_dense(const hd_csr *a, const double *val) {
    double *d = DENSE_NEW(double, (int64_t)a->n_rows * a->n_cols);
    int64_t p;
    int32_t i;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) d[(size_t)i * (size_t)a->n_cols + (size_t)a->col[p]] += val ? val[p] : a->val[p];
    return d;
}

/* B of a Laplacian on its rows, dense. */
static double *test_dense_mass(const hd_laplacian *lap) {
    double *d = lap->B ? test_dense(&lap->L, lap->B) : DENSE_NEW(double, (int64_t)lap->n_active * lap->n_active);
    int32_t i;
    for (i = 0; !lap->B && i < lap->n_active; i++) d[(size_t)i * (size_t)lap->n_active + (size_t)i] = lap->mass[i];
    return d;
}

/* Triplets of a symmetric matrix are listed once, with i <= j; both are put in. Takes 2 n entries of room in i, j, v. */
static hd_csr test_symmetric_csr(int32_t n, int64_t count, int32_t *i, int32_t *j, double *v) {
    hd_csr a;
    hd_error e;
    int64_t k, all = count;
    for (k = 0; k < count; k++) {
        if (i[k] == j[k]) continue;
        i[all] = j[k];
        j[all] = i[k];
        v[all++] = v[k];
    }
    memset(&a, 0, sizeof a);
    CHECK(hd_csr_from_triplets(&a, n, n, all, i, j, v, NULL, &e) == HD_OK);
    return a;
}

static hd_csr test_diagonal_csr(int32_t n, const double *d) {
    int32_t *i = DENSE_NEW(int32_t, n), k;
    double *v = DENSE_NEW(double, n);
    hd_csr a;
    memset(&a, 0, sizeof a);
    for (k = 0; k < n; k++) {
        i[k] = k;
        v[k] = d ? d[k] : 1;
    }
    CHECK(hd_csr_from_triplets(&a, n, n, n, i, i, v, NULL, NULL) == HD_OK);
    free(i);
    free(v);
    return a;
}

/* Laplacian of a path, or of a cycle; with edge weights 1. */
static hd_csr test_path_csr(int32_t n, int closed) {
    const int32_t n_edges = closed ? n : n - 1;
    int32_t *i = DENSE_NEW(int32_t, 4 * n + 4), *j = DENSE_NEW(int32_t, 4 * n + 4), k;
    double *v = DENSE_NEW(double, 4 * n + 4);
    int64_t c = 0;
    hd_csr a;
    for (k = 0; k < n_edges; k++) {
        const int32_t b = (k + 1) % n;
        i[c] = k < b ? k : b; j[c] = k < b ? b : k; v[c++] = -1;
        i[c] = j[c] = k; v[c++] = 1;
        i[c] = j[c] = b; v[c++] = 1;
    }
    a = test_symmetric_csr(n, c, i, j, v);
    free(i);
    free(j);
    free(v);
    return a;
}

/* ---- the group ---- */

static void base_statuses(void) {
#define BASE_STATUS(name, value, text)                                                                                 \
    CHECK(name == (value));                                                                                            \
    CHECK(strcmp(hd_status_name(name), #name) == 0);                                                                   \
    CHECK(strcmp(hd_status_text(name), text) == 0);
    HD_STATUS_LIST(BASE_STATUS)
#undef BASE_STATUS
    CHECK(HD_OK == 0 && HD_WARN_ACCURACY > 0 && HD_ERR_ARGUMENT < 0);
    CHECK(strcmp(hd_status_name((hd_status)12345), "HD_UNKNOWN_STATUS") == 0);
    CHECK(strcmp(hd_status_text((hd_status)12345), "unknown status") == 0);
    CHECK(strcmp(hd_status_name(HD_STATUS_FORCE_INT), "HD_UNKNOWN_STATUS") == 0);
}

static void base_version(void) {
    CHECK(HD_VERSION == HD_MAKE_VERSION(HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH));
    CHECK(HD_MAKE_VERSION(1, 0, 0) > HD_MAKE_VERSION(0, 999, 999));
    CHECK(HD_MAKE_VERSION(0, 2, 0) > HD_MAKE_VERSION(0, 1, 999));
    CHECK(sizeof(hd_c64) == 2 * sizeof(double));
}

static void base_accounting(void) {
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    shape s = shape_grid(12, 9, 0.3);
    hd_laplacian_opts lo;
    hd_heat_opts ho;
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    double *u = DENSE_NEW(double, s.n);
    uint64_t before;
    memset(&lo, 0, sizeof lo);
    memset(&ho, 0, sizeof ho);
    lo.context = &ctx;
    ho.method = HD_METHOD_ITERATIVE;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) == HD_OK);
    CHECK(lap && lap->context == &ctx);
    CHECK(ctx.bytes_in_use == m.bytes && ctx.bytes_in_use > 0 && ctx.bytes_peak >= ctx.bytes_in_use);
    CHECK(ctx.allocations == (uint64_t)m.calls);
    CHECK(hd_heat_create(&heat, lap, &ho, NULL) == HD_OK);
    before = ctx.bytes_in_use;
    CHECK(heat_column(heat, lap->h * lap->h, 5, u, NULL) >= 0);
    CHECK(ctx.bytes_in_use == m.bytes && ctx.bytes_peak > before);
    before = ctx.bytes_in_use;                   /* a plan may keep preconditioners, but calls do not pile up */
    CHECK(heat_column(heat, 2 * lap->h * lap->h, 7, u, NULL) >= 0);
    CHECK(ctx.bytes_in_use == before);
    hd_heat_free(heat);
    CHECK(ctx.bytes_in_use == m.bytes);
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, "accounting");
    free(u);
    shape_free(&s);
}

static void base_limits(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = NULL, *const untouched = lap;
    hd_laplacian_opts lo;
    hd_context ctx;
    hd_error e;
    memset(&lo, 0, sizeof lo);
    memset(&ctx, 0, sizeof ctx);
    lo.context = &ctx;
    ctx.byte_limit = 100;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_MEMORY_LIMIT);
    CHECK(e.status == HD_ERR_MEMORY_LIMIT && e.value > 100 && strstr(e.text, "byte limit") != NULL);
    CHECK(lap == untouched && ctx.bytes_in_use == 0);
    ctx.byte_limit = 0;
    ctx.allocation_limit = 3;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_MEMORY_LIMIT);
    CHECK(e.status == HD_ERR_MEMORY_LIMIT && strstr(e.text, "allocation limit") != NULL);
    CHECK(lap == untouched && ctx.bytes_in_use == 0 && ctx.allocations == 3);
    ctx.allocation_limit = 0;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_OK);
    CHECK(e.status == HD_OK && e.face == -1 && e.vertex == -1 && e.row == -1 && e.column == -1 && e.pole == -1);
    hd_laplacian_free(lap);
    CHECK(ctx.bytes_in_use == 0);
    shape_free(&s);
}

static void base_context_misuse(void) {
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    shape s = shape_icosphere(0);
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    hd_error e;
    hd_csr a;
    const int32_t zero = 0;
    memset(&lo, 0, sizeof lo);
    memset(&a, 0, sizeof a);
    lo.context = &ctx;
    ctx.allocator.free = NULL;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT);
    CHECK(hd_csr_from_triplets(&a, 1, 1, 1, &zero, &zero, NULL, &ctx, &e) == HD_ERR_ARGUMENT);
    ctx = test_memory_context(&m);
    ctx.n_threads = -1;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_ARGUMENT);
    ctx.n_threads = 0;
    lo.begin_zero = 1;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_ARGUMENT);
    lo.begin_zero = 0;
    lo.end_zero = 7;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_ARGUMENT);
    lo.end_zero = 0;
    lo.kind = (hd_laplacian_kind)99;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_ARGUMENT);
    lo.kind = HD_LAPLACIAN_MATRICES;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, &e) == HD_ERR_ARGUMENT);
    CHECK(lap == NULL);
    test_memory_done(&m, &ctx, "misuse");
    shape_free(&s);
}

static void base_heat_options(void) {
    shape s = shape_icosphere(0);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = NULL;
    hd_heat_opts good, o;
    hd_rational set;
    hd_error e;
    memset(&good, 0, sizeof good);
    CHECK(hd_rational_get(&set, HD_POLES_UNIFORM, 4, &e) == HD_OK);
#define BASE_BAD_OPTION(field, bad)                                                                                    \
    o = good;                                                                                                          \
    o.field = bad;                                                                                                     \
    CHECK(hd_heat_create(&heat, lap, &o, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT && e.text[0] && !heat)
    BASE_BAD_OPTION(begin_zero, 1);
    BASE_BAD_OPTION(end_zero, 1);
    BASE_BAD_OPTION(method, (hd_method)9);
    BASE_BAD_OPTION(solver, (hd_solver)9);
    BASE_BAD_OPTION(precond, (hd_precond)9);
    BASE_BAD_OPTION(poles, HD_POLES_OWN);
    BASE_BAD_OPTION(degree, -1);
    BASE_BAD_OPTION(degree, 15);
    BASE_BAD_OPTION(tol, -1e-3);
    BASE_BAD_OPTION(tol, 1);
    BASE_BAD_OPTION(tol, (double)NAN);
    BASE_BAD_OPTION(max_iterations, -1);
#undef BASE_BAD_OPTION
    o = good;
    o.poles = HD_POLES_KERNEL;
    o.degree = 1;
    CHECK(hd_heat_create(&heat, lap, &o, &e) == HD_ERR_ARGUMENT && e.value == 1);
    o = good;
    o.rational = &set;
    o.solver = HD_SOLVER_LANCZOS;
    CHECK(hd_heat_create(&heat, lap, &o, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_create(NULL, lap, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_create(&heat, NULL, NULL, &e) == HD_ERR_ARGUMENT && !heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void base_null(void) {
    double xyz[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, u[3];
    int32_t tri[3] = {0, 1, 2};
    hd_laplacian *lap = NULL;
    hd_error e;
    hd_report rep;
    hd_csr a;
    memset(&a, 0, sizeof a);
    hd_laplacian_free(NULL);
    hd_heat_free(NULL);
    hd_csr_free(NULL, NULL);
    hd_csr_free(&a, NULL);
    CHECK(hd_laplacian_triangles(NULL, xyz, 3, tri, 1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_triangles(&lap, NULL, 3, tri, 1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_triangles(&lap, xyz, 3, NULL, 1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_matrices(&lap, NULL, NULL, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_apply(NULL, 1, 1, u, u, &e) == HD_ERR_ARGUMENT);
    CHECK(heat_column(NULL, 1, 0, u, &rep) == HD_ERR_ARGUMENT && rep.status == HD_ERR_ARGUMENT);
    CHECK(heat_apply(NULL, 1, 1, u, 0, u, 0, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_csr_from_triplets(NULL, 1, 1, 0, NULL, NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_csr_check(NULL, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_csr_transpose(&a, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_csr_product(&a, NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_csr_permute(&a, NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_rational_get(NULL, HD_POLES_UNIFORM, 7, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_triangles(&lap, NULL, 3, tri, 1, NULL, NULL) == HD_ERR_ARGUMENT);    /* no place for the error is fine */
    CHECK(lap == NULL);
}

/* The oracle itself: A X = X Lambda, X' B X = I, and a complex system. */
static void base_dense(void) {
    enum { N = 40 };
    double *L = DENSE_NEW(double, N * N), *B = DENSE_NEW(double, N * N), x[N], y[N], worst = 0;
    dense_c64 *a = DENSE_NEW(dense_c64, N * N), *copy = DENSE_NEW(dense_c64, N * N), b[N], rhs[N];
    dense_pair p;
    uint64_t seed = 3;
    int32_t i, j, k;
    for (i = 0; i < N; i++)
        for (j = 0; j <= i; j++) {
            L[i * N + j] = L[j * N + i] = dense_signed(&seed);
            B[i * N + j] = B[j * N + i] = (i == j ? 20 : 0) + 0.3 * dense_signed(&seed);
        }
    CHECK(dense_pair_solve(&p, L, B, N));
    for (k = 0; k < N; k++) {
        dense_apply(p.L, p.x + k * N, x, N);
        dense_apply(p.B, p.x + k * N, y, N);
        for (j = 0; j < N; j++) {
            worst = fmax(worst, fabs(x[j] - p.lambda[k] * y[j]));
            worst = fmax(worst, fabs(dense_dot(p.x + j * N, y, N) - (j == k)));
        }
    }
    CHECK_MSG(worst < 1e-12, "eigensolution off by %g", worst);
    dense_pair_free(&p);
    for (i = 0; i < N * N; i++) copy[i] = a[i] = dense_c(dense_signed(&seed), dense_signed(&seed));
    for (i = 0; i < N; i++) rhs[i] = b[i] = dense_c(dense_signed(&seed), dense_signed(&seed));
    CHECK(dense_complex_solve(a, b, N));
    for (i = 0, worst = 0; i < N; i++) {
        for (j = 0; j < N; j++) rhs[i] = dense_cfma(rhs[i], copy[i * N + j], b[j]);
        worst = fmax(worst, hypot(rhs[i].re, rhs[i].im));
    }
    CHECK_MSG(worst < 1e-11, "complex residual %g", worst);
    free(a);
    free(copy);
}

static void test_base(void) {
    base_statuses();
    base_version();
    base_accounting();
    base_limits();
    base_context_misuse();
    base_heat_options();
    base_null();
    base_dense();
}

#endif
