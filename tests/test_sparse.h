/* test_sparse.h - compressed rows: built, against dense matrices, and refused */

#ifndef TEST_SPARSE_H
#define TEST_SPARSE_H

/* A matrix over arrays of the test's own. */
static hd_csr sparse_view(int32_t rows, int32_t cols, int64_t nnz, int64_t *ptr, int32_t *col, double *val) {
    hd_csr a;
    a.n_rows = rows;
    a.n_cols = cols;
    a.nnz = nnz;
    a.row_ptr = ptr;
    a.col = col;
    a.val = val;
    return a;
}

/* About `count` random triplets, a fifth of them at a place that has one already; d [rows cols] is what they sum to. */
static hd_csr sparse_random(int32_t rows, int32_t cols, int32_t count, uint64_t seed, double *d) {
    int32_t *i = KIT_NEW(int32_t, count), *j = KIT_NEW(int32_t, count), k;
    double *v = KIT_NEW(double, count);
    hd_csr a;
    hd_error e;
    const char *fault;
    memset(&a, 0, sizeof a);
    memset(d, 0, (size_t)rows * (size_t)cols * sizeof *d);
    for (k = 0; k < count; k++) {
        const int again = k > 0 && dense_random(&seed) % 5 == 0;
        const int32_t at = again ? (int32_t)(dense_random(&seed) % (uint64_t)k) : 0;
        i[k] = again ? i[at] : (int32_t)(dense_random(&seed) % (uint64_t)rows);
        j[k] = again ? j[at] : (int32_t)(dense_random(&seed) % (uint64_t)cols);
        v[k] = dense_signed(&seed);
        d[(size_t)i[k] * (size_t)cols + (size_t)j[k]] += v[k];
    }
    CHECK(hd_csr_from_triplets(&a, rows, cols, count, i, j, v, NULL, &e) == HD_OK);
    fault = test_csr_fault(&a, 0);
    CHECK_MSG(!fault, "%s", fault);
    return a;
}

static void sparse_equals(const hd_csr *a, const double *d, double tol, const char *what) {
    double *own = test_dense(a, NULL);
    const char *fault = test_csr_fault(a, 0);
    const double diff = dense_max_diff(own, d, (int64_t)a->n_rows * a->n_cols);
    CHECK_MSG(!fault, "%s: %s", what, fault);
    CHECK_MSG(diff <= tol, "%s: off by %g", what, diff);
    free(own);
}

static void sparse_triplets(void) {
    const int32_t i[6] = {2, 0, 2, 2, 0, 2}, j[6] = {1, 3, 1, 0, 0, 1};
    const double v[6] = {1e16, 4, 1, 5, 6, -1e16};
    double d[20 * 13];
    hd_csr a;
    hd_error e;
    CHECK(hd_csr_from_triplets(&a, 3, 4, 6, i, j, v, NULL, &e) == HD_OK);
    CHECK(a.n_rows == 3 && a.n_cols == 4 && a.nnz == 4);
    CHECK(a.row_ptr[0] == 0 && a.row_ptr[1] == 2 && a.row_ptr[2] == 2 && a.row_ptr[3] == 4);    /* row 1 is empty */
    CHECK(a.col[0] == 0 && a.col[1] == 3 && a.col[2] == 0 && a.col[3] == 1);
    CHECK(a.val[0] == 6 && a.val[1] == 4 && a.val[2] == 5);
    CHECK_MSG(!TEST_EXACT || a.val[3] == (1e16 + 1) - 1e16, "duplicates are summed in the order given: %g", a.val[3]);
    hd_csr_free(&a, NULL);
    CHECK(!a.row_ptr && !a.col && !a.val && a.nnz == 0 && a.n_rows == 0);
    CHECK(hd_csr_from_triplets(&a, 3, 4, 6, i, j, NULL, NULL, &e) == HD_OK);
    CHECK(a.nnz == 4 && a.val == NULL && a.col[1] == 3);
    hd_csr_free(&a, NULL);
    CHECK(hd_csr_from_triplets(&a, 0, 0, 0, NULL, NULL, NULL, NULL, &e) == HD_OK);
    CHECK(a.row_ptr && a.row_ptr[0] == 0 && a.nnz == 0);
    CHECK(!test_csr_fault(&a, 1));
    hd_csr_free(&a, NULL);
    CHECK(hd_csr_from_triplets(&a, 5, 2, 0, NULL, NULL, NULL, NULL, &e) == HD_OK);
    CHECK(a.row_ptr[5] == 0);
    hd_csr_free(&a, NULL);
    CHECK(hd_csr_from_triplets(&a, 1, 1, 1, i + 1, i + 1, v, NULL, &e) == HD_OK);
    CHECK(a.nnz == 1 && a.val[0] == 1e16);
    hd_csr_free(&a, NULL);
    a = sparse_random(20, 13, 150, 5, d);
    sparse_equals(&a, d, 1e-15, "random triplets");
    hd_csr_free(&a, NULL);
}

/* What hd_laplacian_matrices says of L, which it checks before B; HD_OK: L is well formed, and symmetric up to rounding. */
static hd_status sparse_matrix(const hd_csr *a, hd_error *e) {
    const int32_t mark = kit_mark();
    hd_csr B = kit_own_csr(test_diagonal_csr(3, NULL));
    hd_laplacian *lap = NULL;
    const hd_status st = hd_laplacian_matrices(&lap, a, &B, 1, NULL, e);
    hd_laplacian_free(lap);
    kit_release(mark);
    return st == HD_ERR_STRUCTURE || st == HD_ERR_INDEX || st == HD_ERR_NOT_FINITE || st == HD_ERR_NOT_SYMMETRIC ? st : HD_OK;
}

/* The same of the pattern alone, by hd_ldl_analyse. */
static hd_status sparse_pattern(const hd_csr *a, hd_error *e) {
    hd_ldl *f = NULL;
    const hd_status st = hd_ldl_analyse(&f, a, NULL, NULL, e);
    CHECK((st >= 0) == (f != NULL));
    hd_ldl_free(f);
    return st;
}

/* Every way in which a matrix can be refused, with its place. */
static void sparse_check(void) {
    /* ptr[at] or col[at] or val[at] becomes `to`; row, column and value of the error, 77: none told */
    static const struct { char what; int at, to, col3; hd_status want; int32_t row, column; double value; } rows[] = {
        {'p', 0, 1, 0, HD_ERR_STRUCTURE, 0, 77, 77}, {'p', 2, 1, 0, HD_ERR_STRUCTURE, 1, 77, 1}, {'p', 2, 99, 0, HD_ERR_STRUCTURE, 1, 77, 99},
        {'p', 3, 4, 0, HD_ERR_STRUCTURE, 3, 77, 4}, {'c', 4, 3, 0, HD_ERR_INDEX, 2, 3, 77}, {'c', 4, -1, 0, HD_ERR_INDEX, 2, -1, -1},
        {'c', 4, 0, 0, HD_ERR_STRUCTURE, 2, 0, 77},        /* twice */
        {'c', 4, 1, 2, HD_ERR_STRUCTURE, 2, 1, 77},        /* descending */
        {'v', 2, 0, 0, HD_ERR_NOT_FINITE, 1, 1, 77}, {'v', 2, 1, 0, HD_ERR_NOT_FINITE, 1, 1, 77},
        {' ', 0, 0, 0, HD_ERR_NOT_SYMMETRIC, 0, 1, 2},     /* (0, 1) has no partner */
    };
    int64_t none[2] = {0, 0};
    double one = 1;
    hd_csr wide = sparse_view(1, 2, 0, none, NULL, NULL);
    hd_error e;
    size_t k;
    for (k = 0; k < 2 * sizeof rows / sizeof *rows; k++) {
        const int r = (int)k / 2, alone = (int)k % 2, at = rows[r].at, to = rows[r].to;
        const hd_status want = alone && rows[r].what == 'v' ? HD_ERR_NOT_SYMMETRIC : rows[r].want;    /* values are not read */
        const int told = want == rows[r].want;
        int64_t ptr[4] = {0, 2, 3, 5};
        int32_t col[5] = {0, 1, 1, 0, 2};
        double val[5] = {1, 2, 3, 4, 5};
        hd_csr a = sparse_view(3, 3, 5, ptr, col, val);
        hd_status st;
        col[3] = rows[r].col3;
        if (rows[r].what == 'p') ptr[at] = to;
        if (rows[r].what == 'c') col[at] = to;
        if (rows[r].what == 'v') val[at] = to ? -(double)INFINITY : (double)NAN;
        st = alone ? sparse_pattern(&a, &e) : sparse_matrix(&a, &e);
        CHECK_MSG(st == want && (!told || rows[r].row == 77 || e.row == rows[r].row) &&
                  (!told || rows[r].column == 77 || e.column == rows[r].column) &&
                  (!told || rows[r].value == 77 || e.value == (alone && rows[r].what == ' ' ? 1 : rows[r].value)),
                  "row %d, pattern %d: %s, (%d, %d), %g", r, alone, hd_status_name(e.status), (int)e.row, (int)e.column, e.value);
    }
    wide.val = &one;
    CHECK(sparse_matrix(&wide, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 1 && e.column == 2);    /* not square */
    CHECK(sparse_pattern(&wide, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 1 && e.column == 2);
}

static void sparse_check_symmetric(void) {
    int64_t ptr[4] = {0, 3, 5, 7}, lone[4] = {0, 2, 2, 3};
    int32_t col[7] = {0, 1, 2, 0, 1, 0, 2}, lone_col[3] = {0, 2, 2};
    double val[7] = {1, 2, 3, 2, 5, 3, 7}, lone_val[3] = {1, 0, 3};
    hd_csr a = sparse_view(3, 3, 7, ptr, col, val), b = sparse_view(3, 3, 3, lone, lone_col, lone_val);
    hd_error e;
    CHECK(sparse_matrix(&a, &e) == HD_OK);
    val[5] = 3 * (1 + 1e-13);
    CHECK(sparse_matrix(&a, &e) == HD_OK);
    val[5] = 3 * (1 + 1e-10);
    CHECK(sparse_matrix(&a, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 0 && e.column == 2);
    val[5] = -3;
    CHECK(sparse_matrix(&a, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 0 && e.column == 2 && fabs(e.value) == 6);
    CHECK(sparse_matrix(&b, &e) == HD_OK);                       /* an explicit zero needs no partner */
    lone_val[1] = 1e-300;
    CHECK(sparse_matrix(&b, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 0 && e.column == 2);
    CHECK(sparse_pattern(&b, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 0 && e.column == 2 && fabs(e.value) == 1);
    lone[1] = 1;                                                 /* below the diagonal only: (1, 0) */
    lone_col[1] = 0;
    lone_val[1] = 4;
    CHECK(sparse_matrix(&b, &e) == HD_ERR_NOT_SYMMETRIC && e.row + e.column == 1 && fabs(e.value) == 4);
    CHECK(sparse_pattern(&b, &e) == HD_ERR_NOT_SYMMETRIC && e.row + e.column == 1);
    CHECK(sparse_pattern(&a, &e) == HD_OK);
    a.val = b.val = NULL;                                        /* patterns */
    CHECK(sparse_pattern(&a, &e) == HD_OK && sparse_pattern(&b, &e) == HD_ERR_NOT_SYMMETRIC);
}

/* Finite numbers whose sum is not. */
static void sparse_overflow(void) {
    const int32_t i[5] = {0, 2, 1, 2, 0}, j[5] = {0, 3, 1, 3, 2};
    const double v[5] = {1, 1.5e308, 2, 1.5e308, 3};
    hd_csr a, mark;
    hd_error e;
    memset(&a, 0x5a, sizeof a);
    mark = a;
    TRAPS_OFF;                                   /* sums are checked when they are complete */
    CHECK(hd_csr_from_triplets(&a, 3, 4, 5, i, j, v, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 2 && e.column == 3 && e.value == HUGE_VAL);
    CHECK(memcmp(&a, &mark, sizeof a) == 0);
    TRAPS_ON;
}

/* Backwards and with other workers, as a user's threads might. */
static void sparse_reverse_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    int64_t i;
    for (i = n_tasks; i-- > 0;) task(arg, i, (int32_t)(i % 3));
    ++*(int64_t *)user;
}

static void test_sparse(void) {
    sparse_triplets();
    sparse_check();
    sparse_check_symmetric();
    sparse_overflow();
}

#endif
