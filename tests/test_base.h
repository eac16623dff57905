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

/* Whoever reads before writing gets nonsense. Of a large block both ends have it: the middle, which few calls reach, takes long. */
enum { TEST_FILLED = 16384 };

static void test_memory_fill(char *p, size_t size) {
    memset(p, 0xa5, size < TEST_FILLED ? size : TEST_FILLED);
    if (size > TEST_FILLED) memset(p + (size - TEST_FILLED), 0xa5, TEST_FILLED);
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
    test_memory_fill(p + sizeof head, size);
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
    if (!CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, s->n, s->tri, s->n_tri), &opts, &e) == HD_OK)) printf("    %s\n", e.text);
    return lap;
}

/* The values of a sparse matrix, or val instead of its own, in a dense one. */
static double *test_dense(const hd_csr *a, const double *val) {
    double *d = DENSE_NEW(double, (int64_t)a->n_rows * a->n_cols);
    int64_t p;
    int32_t i;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) d[(size_t)i * (size_t)a->n_cols + (size_t)a->col[p]] += val ? val[p] : a->val[p];
    return d;
}

/* What is wrong with a matrix: rows in order, columns within them, ascending, numbers; if asked also symmetric, up to rounding. NULL: nothing. */
static const char *test_csr_fault(const hd_csr *a, int symmetric) {
    int64_t p, q;
    int32_t i;
    if (a->n_rows < 0 || a->n_cols < 0 || !a->row_ptr || a->row_ptr[0] != 0 || a->row_ptr[a->n_rows] != a->nnz) return "rows";
    for (i = 0; i < a->n_rows; i++) {
        if (a->row_ptr[i + 1] < a->row_ptr[i] || a->row_ptr[i + 1] > a->nnz) return "a row's end";
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            if (a->col[p] < 0 || a->col[p] >= a->n_cols) return "a column";
            if (p > a->row_ptr[i] && a->col[p] <= a->col[p - 1]) return "columns do not ascend";
            if (a->val && !(fabs(a->val[p]) <= DBL_MAX)) return "a value";
        }
    }
    if (symmetric && a->n_rows != a->n_cols) return "not square";
    for (i = 0; symmetric && i < a->n_rows; i++) {
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const int32_t j = a->col[p];
            const double x = a->val ? a->val[p] : 1;
            double y = 0;
            for (q = a->row_ptr[j]; q < a->row_ptr[j + 1] && a->col[q] < i; q++) continue;
            if (q < a->row_ptr[j + 1] && a->col[q] == i) y = a->val ? a->val[q] : 1;
            if (fabs(x - y) > 1e-12 * fmax(fabs(x), fabs(y))) return "not symmetric";
        }
    }
    return NULL;
}

/* A copy of a square matrix; with perm [n_rows] its row i and column i are those number perm[i] of a. */
static hd_csr test_csr_ordered(const hd_csr *a, const int32_t *perm) {
    int32_t *row = DENSE_NEW(int32_t, a->nnz), *col = DENSE_NEW(int32_t, a->nnz), *inverse = DENSE_NEW(int32_t, a->n_rows), i;
    hd_csr out;
    int64_t p;
    memset(&out, 0, sizeof out);
    for (i = 0; i < a->n_rows; i++) inverse[perm ? perm[i] : i] = i;
    for (i = 0; i < a->n_rows; i++) {
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            row[p] = inverse[i];
            col[p] = inverse[a->col[p]];
        }
    }
    CHECK(hd_csr_from_triplets(&out, a->n_rows, a->n_cols, a->nnz, row, col, a->val, NULL, NULL) == HD_OK);
    free(row);
    free(col);
    free(inverse);
    return out;
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
    int32_t *i = KIT_NEW(int32_t, n), k;
    double *v = KIT_NEW(double, n);
    hd_csr a;
    memset(&a, 0, sizeof a);
    for (k = 0; k < n; k++) {
        i[k] = k;
        v[k] = d ? d[k] : 1;
    }
    CHECK(hd_csr_from_triplets(&a, n, n, n, i, i, v, NULL, NULL) == HD_OK);
    return a;
}

/* Laplacian of a path, or of a cycle; with edge weights 1. */
static hd_csr test_path_csr(int32_t n, int closed) {
    const int32_t n_edges = closed ? n : n - 1;
    int32_t *i = KIT_NEW(int32_t, 4 * n + 4), *j = KIT_NEW(int32_t, 4 * n + 4), k;
    double *v = KIT_NEW(double, 4 * n + 4);
    int64_t c = 0;
    hd_csr a;
    for (k = 0; k < n_edges; k++) {
        const int32_t b = (k + 1) % n;
        i[c] = k < b ? k : b; j[c] = k < b ? b : k; v[c++] = -1;
        i[c] = j[c] = k; v[c++] = 1;
        i[c] = j[c] = b; v[c++] = 1;
    }
    a = test_symmetric_csr(n, c, i, j, v);
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
    CHECK(strcmp(hd_status_text(HD_STATUS_FORCE_INT), "unknown status") == 0);
}

static void base_version(void) {
    CHECK(HD_VERSION == HD_MAKE_VERSION(HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH));
    CHECK(HD_MAKE_VERSION(1, 0, 0) > HD_MAKE_VERSION(0, 999, 999));
    CHECK(HD_MAKE_VERSION(0, 2, 0) > HD_MAKE_VERSION(0, 1, 999));
    CHECK(sizeof(hd_c64) == 2 * sizeof(double));
}

/* No object is freed, too. */
static void base_null(void) {
    hd_csr a;
    memset(&a, 0, sizeof a);
    hd_laplacian_free(NULL);
    hd_heat_free(NULL);
    hd_spectrum_free(NULL);
    hd_geodesic_free(NULL);
    hd_ldl_free(NULL);
    hd_csr_free(NULL, NULL);
    hd_csr_free(&a, NULL);
}

/* The oracle itself: A X = X Lambda, X' B X = I, and a complex system. */
static void base_dense(void) {
    enum { N = 40 };
    double *L = DENSE_NEW(double, N * N), *B = DENSE_NEW(double, N * N), x[N], y[N], worst = 0;
    dense_c64 *a = KIT_NEW(dense_c64, N * N), *copy = KIT_NEW(dense_c64, N * N), b[N], rhs[N];
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
}

static void test_base(void) {
    base_statuses();
    base_version();
    base_null();
    base_dense();
}

#endif
