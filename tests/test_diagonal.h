/* test_diagonal.h - selected inversion, and what is made of it: diagonals, edges, distances, pairs, samples; against dense inverses, dense
 * eigensolutions, closed forms and brute force */

#ifndef TEST_DIAGONAL_H
#define TEST_DIAGONAL_H

/* ---- entries of the inverse ---- */

/* A^-1 [n n] by Gauss, Jordan with partial pivoting. */
static dense_c64 *diag_dense_inverse(const hd_csr *a, const hd_c64 *val) {
    const int32_t n = a->n_rows;
    const size_t ld = 2 * (size_t)n;
    dense_c64 *m = DENSE_NEW(dense_c64, (int64_t)n * (int64_t)ld), *z = DENSE_NEW(dense_c64, (int64_t)n * n), keep;
    int64_t p;
    int32_t i, j, k;
    for (i = 0; i < n; i++) {
        m[(size_t)i * ld + (size_t)(n + i)] = dense_c(1, 0);
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) m[(size_t)i * ld + (size_t)a->col[p]] = dense_c(val[p].re, val[p].im);
    }
    for (k = 0; k < n; k++) {
        dense_c64 *row = m + (size_t)k * ld;
        int32_t best = k;
        for (i = k + 1; i < n; i++)
            if (hypot(m[(size_t)i * ld + (size_t)k].re, m[(size_t)i * ld + (size_t)k].im) > hypot(m[(size_t)best * ld + (size_t)k].re, m[(size_t)best * ld + (size_t)k].im)) best = i;
        for (j = 0; best != k && j < 2 * n; j++) {
            keep = row[j];
            row[j] = m[(size_t)best * ld + (size_t)j];
            m[(size_t)best * ld + (size_t)j] = keep;
        }
        keep = row[k];
        for (j = k; j < 2 * n; j++)
            if (row[j].re != 0 || row[j].im != 0) row[j] = dense_cquotient(row[j], keep);
        for (i = 0; i < n; i++) {
            dense_c64 *to = m + (size_t)i * ld;
            const dense_c64 f = to[k];
            if (i == k || (f.re == 0 && f.im == 0)) continue;
            for (j = k; j < 2 * n; j++)
                if (row[j].re != 0 || row[j].im != 0) to[j] = dense_cfma(to[j], f, row[j]);
        }
    }
    for (i = 0; i < n; i++) memcpy(z + (size_t)i * (size_t)n, m + (size_t)i * ld + n, (size_t)n * sizeof *z);
    free(m);
    return z;
}

/* Largest difference of values and diag from the dense inverse, relative to its largest entry. */
static double diag_off_dense(const hd_csr *a, const hd_c64 *val, const hd_c64 *values, const hd_c64 *diag) {
    const int32_t n = a->n_rows;
    dense_c64 *z = diag_dense_inverse(a, val);
    double off = 0, size = 0;
    int64_t p;
    int32_t i;
    for (i = 0; i < n; i++) {
        const dense_c64 d = z[(size_t)i * (size_t)n + (size_t)i];
        if (!(hypot(diag[i].re - d.re, diag[i].im - d.im) <= off)) off = hypot(diag[i].re - d.re, diag[i].im - d.im);
        size = fmax(size, hypot(d.re, d.im));
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const dense_c64 e = z[(size_t)i * (size_t)n + (size_t)a->col[p]];
            if (!(hypot(values[p].re - e.re, values[p].im - e.im) <= off)) off = hypot(values[p].re - e.re, values[p].im - e.im);
            size = fmax(size, hypot(e.re, e.im));
        }
    }
    free(z);
    return off > 0 || off != off ? off / size : 0;
}

/* What needs no dense matrix: (A Z)_ii = 1 is a sum over the pattern, Z is symmetric, and diag is its diagonal. The largest deviation, relative to the
 * size of the terms. */
static double diag_off_identity(const hd_csr *a, const hd_c64 *val, const hd_c64 *values, const hd_c64 *diag) {
    double off = 0;
    int64_t p, q;
    int32_t i;
    for (i = 0; i < a->n_rows; i++) {
        double re = -1, im = 0, size = 1;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const int32_t j = a->col[p];
            re += val[p].re * values[p].re - val[p].im * values[p].im;
            im += val[p].re * values[p].im + val[p].im * values[p].re;
            size += hypot(val[p].re, val[p].im) * hypot(values[p].re, values[p].im);
            for (q = a->row_ptr[j]; q < a->row_ptr[j + 1] && a->col[q] < i; q++) continue;
            if (values[q].re != values[p].re || values[q].im != values[p].im) off = HUGE_VAL;
            if (j == i && (diag[i].re != values[p].re || diag[i].im != values[p].im)) off = HUGE_VAL;
        }
        if (!(hypot(re, im) / size <= off)) off = hypot(re, im) / size;
    }
    return off;
}

/* val [k][nnz] = t L + theta B with theta close to the imaginary axis, of either sign. */
static void diag_steep(const hd_csr *a, const double *L, const double *B, int32_t k, uint64_t seed, hd_c64 *val) {
    int64_t p;
    int32_t q;
    for (q = 0; q < k; q++) {
        const double re = 0.2 * dense_signed(&seed), im = (q % 2 ? -1 : 1) * (3 + 10 * fabs(dense_signed(&seed)));
        for (p = 0; p < a->nnz; p++) val[q * a->nnz + p] = test_c(L[p] + re * B[p], im * B[p]);
    }
}

static void diag_complex_of(const double *x, hd_c64 *z, int64_t n) {
    int64_t i;
    for (i = 0; i < n; i++) z[i] = test_c(x[i], 0);
}

/* Single entries of the last factorisation's inverses, k complex ones or (k = 0) a real one: those of whole columns, to the last digits. */
static void diag_entries_of(hd_ldl *f, int32_t n, int32_t k, uint64_t seed, const char *what) {
    enum { SOME = 14 };
    const int32_t many = k > 0 ? k : 1;
    double *rhs = DENSE_NEW(double, n), *x = DENSE_NEW(double, n), real[SOME] = {0};
    hd_c64 *zrhs = DENSE_NEW(hd_c64, n), *z = DENSE_NEW(hd_c64, (int64_t)many * n), *got = DENSE_NEW(hd_c64, many * SOME);
    int32_t i[SOME], j[SOME], p, q, r;
    for (p = 0; p < SOME; p++) {
        i[p] = ldl_below(&seed, n);
        j[p] = p % 3 ? j[p - 1] : ldl_below(&seed, n);
    }
    i[1] = j[1];
    if (k > 0) CHECK(hd_ldl_inverse_entries_complex(f, SOME, i, j, got, NULL) == HD_OK && hd_ldl_inverse_entries(f, SOME, i, j, real, NULL) == HD_ERR_ARGUMENT);
    else CHECK(hd_ldl_inverse_entries(f, SOME, i, j, real, NULL) == HD_OK && hd_ldl_inverse_entries_complex(f, SOME, i, j, got, NULL) == HD_ERR_ARGUMENT);
    for (p = 0; p < SOME; p++) {
        for (q = 0; q < n; q++) {
            rhs[q] = q == j[p];
            zrhs[q] = test_c(rhs[q], 0);
        }
        if (k > 0) CHECK(hd_ldl_solve_complex(f, zrhs, 0, z, 0, NULL) == HD_OK);
        else {
            CHECK(hd_ldl_solve(f, 1, rhs, 0, x, 0, NULL) == HD_OK);
            diag_complex_of(x, z, n);
            got[p] = test_c(real[p], 0);
        }
        for (q = 0; q < many; q++) {
            const hd_c64 *column = z + (size_t)q * (size_t)n, *a = column + i[p], *b = got + q * SOME + p;
            double size = 0;
            for (r = 0; r < n; r++) size = fmax(size, hypot(column[r].re, column[r].im));
            CHECK_MSG(hypot(a->re - b->re, a->im - b->im) <= 1e-14 * size, "%s, n %d, matrix %d: entry (%d,%d) is %g %+gi, not %g %+gi", what, (int)n, (int)q, (int)i[p], (int)j[p],
                      b->re, b->im, a->re, a->im);
        }
    }
    i[SOME - 1] = n;
    CHECK(k > 0 || hd_ldl_inverse_entries(f, SOME, i, j, real, NULL) == HD_ERR_INDEX);
    CHECK(k > 0 || hd_ldl_inverse_entries(f, 0, NULL, NULL, NULL, NULL) == HD_OK);
    free(rhs);
    free(x);
    free(zrhs);
    free(z);
    free(got);
}

/* k complex matrices, then a real one: values and diagonal together and each alone. Patterns with all diagonal entries. */
static void diag_inverse_of(const hd_csr *a, hd_ldl *f, int32_t k, int steep, int dense, uint64_t seed, const char *what) {
    const int32_t n = a->n_rows;
    const int64_t nnz = a->nnz;
    double *L = DENSE_NEW(double, nnz), *B = DENSE_NEW(double, nnz), *v = DENSE_NEW(double, nnz), *d = DENSE_NEW(double, n), off, far;
    hd_c64 *val = DENSE_NEW(hd_c64, k * nnz), *values = DENSE_NEW(hd_c64, k * nnz), *diag = DENSE_NEW(hd_c64, (int64_t)k * n);
    hd_c64 *alone = DENSE_NEW(hd_c64, k * nnz), *diag_alone = DENSE_NEW(hd_c64, (int64_t)k * n);
    hd_error e;
    int64_t p;
    int32_t q;
    ldl_pair(a, seed, L, B);
    if (steep) diag_steep(a, L, B, k, seed + 5, val);
    else ldl_shifted(a, L, B, k, seed + 5, val);
    CHECK_MSG(hd_ldl_factor_complex(f, k, val, NULL, &e) == HD_OK, "%s: %s", what, e.text);
    CHECK_MSG(hd_ldl_inverse_complex(f, values, diag, &e) == HD_OK && e.status == HD_OK, "%s: %s", what, e.text);
    CHECK(hd_ldl_inverse_complex(f, alone, NULL, &e) == HD_OK && hd_ldl_inverse_complex(f, NULL, diag_alone, &e) == HD_OK);
    CHECK_MSG(nnz == 0 || memcmp(alone, values, (size_t)(k * nnz) * sizeof *alone) == 0, "%s: values alone are others", what);
    CHECK_MSG(n == 0 || memcmp(diag_alone, diag, (size_t)k * (size_t)n * sizeof *diag) == 0, "%s: the diagonal alone is another", what);
    for (q = 0; q < k; q++) {
        off = diag_off_identity(a, val + q * nnz, values + q * nnz, diag + (size_t)q * (size_t)n);
        CHECK_MSG(off <= 1e-13, "%s, n %d, matrix %d of %d: A Z is off by %g", what, (int)n, (int)q, (int)k, off);
        far = dense ? diag_off_dense(a, val + q * nnz, values + q * nnz, diag + (size_t)q * (size_t)n) : 0;
        CHECK_MSG(far <= 1e-10, "%s, n %d, matrix %d of %d: off by %g", what, (int)n, (int)q, (int)k, far);
    }
    if (n > 0) diag_entries_of(f, n, k, seed + 9, what);
    for (p = 0; p < nnz; p++) L[p] = 7 * L[p] + B[p];
    CHECK_MSG(hd_ldl_factor(f, L, NULL, &e) == HD_OK && hd_ldl_inverse(f, v, d, &e) == HD_OK && e.status == HD_OK, "%s: %s", what, e.text);
    if (n > 0) diag_entries_of(f, n, 0, seed + 9, what);
    diag_complex_of(L, val, nnz);
    diag_complex_of(v, values, nnz);
    diag_complex_of(d, diag, n);
    off = diag_off_identity(a, val, values, diag);
    far = dense ? diag_off_dense(a, val, values, diag) : 0;
    CHECK_MSG(off <= 1e-13 && far <= 1e-11, "%s, n %d, real: off by %g, %g", what, (int)n, off, far);
    memcpy(B, v, (size_t)nnz * sizeof *v);
    CHECK(hd_ldl_inverse(f, v, NULL, NULL) == HD_OK && hd_ldl_inverse(f, NULL, d, NULL) == HD_OK && hd_ldl_inverse(f, NULL, NULL, NULL) == HD_OK);
    CHECK_MSG(memcmp(B, v, (size_t)nnz * sizeof *v) == 0, "%s: real values alone are others", what);
    for (q = 0; q < n; q++) CHECK_MSG(d[q] == diag[q].re, "%s: real, the diagonal alone is another", what);
    free(L);
    free(B);
    free(v);
    free(d);
    free(val);
    free(values);
    free(diag);
    free(alone);
    free(diag_alone);
}

/* All shapes, all orderings, one to nine matrices; every object twice. */
static void diag_inverse_shapes(void) {
    static const int32_t sizes[6] = {0, 1, 2, 5, 23, 60};
    int kind, z;
    for (kind = 0; kind < LDL_SHAPES; kind++) {
        for (z = 0; z < 6; z++) {
            hd_csr a = ldl_shape(kind, sizes[z], 1, (uint64_t)(kind + 1));
            const hd_ldl_opts o = ldl_opts_of(HD_ORDERING_MINIMUM_DEGREE, NULL, NULL, NULL);
            hd_ldl *f = ldl_make(&a, kind % 2 ? &o : NULL, ldl_shape_name(kind));
            diag_inverse_of(&a, f, 1 + (kind + z) % 9, z % 2, 1, (uint64_t)(7 * kind + z), ldl_shape_name(kind));
            if (z == 4) diag_inverse_of(&a, f, 1 + (kind + z + 3) % 9, 1, 1, (uint64_t)(11 * kind + z), ldl_shape_name(kind));
            hd_ldl_free(f);
            hd_csr_free(&a, NULL);
        }
    }
}

/* At every level of instructions: random patterns, mesh-like ones, and fronts of more pivots than a panel or a tile holds. */
static void diag_inverse_levels(void) {
    int level, q;
    for (level = 0; level < 4; level++) {
        hd_context ctx;
        memset(&ctx, 0, sizeof ctx);
        ctx.simd = ldl_simds[level];
        for (q = 0; q < 6; q++) {
            static const int kinds[6] = {LDL_RANDOM, LDL_GRID, LDL_DENSE, LDL_BAND, LDL_BIPARTITE, LDL_DENSE};
            static const int32_t sizes[6] = {90, 400, 75, 120, 90, 141};
            hd_csr a = ldl_shape(kinds[q], sizes[q], 1, (uint64_t)(q + 50));
            const hd_ldl_opts o = ldl_opts_of(HD_ORDERING_AUTO, NULL, NULL, &ctx);
            hd_ldl *f = ldl_make(&a, &o, ldl_shape_name(kinds[q]));
            diag_inverse_of(&a, f, 3, q % 2, sizes[q] <= 150 && level < 2, (uint64_t)q, ldl_shape_name(kinds[q]));
            hd_ldl_free(f);
            hd_csr_free(&a, NULL);
        }
        CHECK(ctx.bytes_in_use == 0);
    }
}

/* Where the pattern has no diagonal, diag has it all the same: zeros there but for one end of a path. */
static void diag_inverse_no_diagonal(void) {
    enum { N = 24 };
    ldl_edges g = ldl_edges_of(N);
    hd_csr a, full;
    hd_ldl *f = NULL;
    double *v, d[N];
    hd_c64 *val, *values, diag[2 * N];
    int64_t p, q;
    int32_t i, perm[N] = {0};
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, NULL);
    hd_error e;
    int k;
    for (i = 0; i + 1 < N; i++) ldl_join(&g, i, i + 1);
    for (i = 0; i + 5 < N; i += 5) ldl_join(&g, i, i + 5);
    a = ldl_pattern(&g, 0);
    {                                            /* the pattern with a single diagonal entry, that of the row eliminated first */
        int32_t *ci = DENSE_NEW(int32_t, a.nnz + 1), *cj = DENSE_NEW(int32_t, a.nnz + 1);
        for (i = 0; i < N; i++)
            for (p = a.row_ptr[i]; p < a.row_ptr[i + 1]; p++) {
                ci[p] = i;
                cj[p] = a.col[p];
            }
        ci[a.nnz] = cj[a.nnz] = 0;
        CHECK(hd_csr_from_triplets(&full, N, N, a.nnz + 1, ci, cj, NULL, NULL, NULL) == HD_OK);
        free(ci);
        free(cj);
    }
    for (i = 0; i < N; i++) perm[i] = i;
    v = DENSE_NEW(double, full.nnz);
    val = DENSE_NEW(hd_c64, 2 * full.nnz);
    values = DENSE_NEW(hd_c64, 2 * full.nnz);
    for (i = 0; i < N; i++)
        for (p = full.row_ptr[i]; p < full.row_ptr[i + 1]; p++) {
            const double x = full.col[p] == i ? 2 : 0.7 + ldl_chance(i, full.col[p], 3);
            v[p] = x;
            val[p] = test_c(0.3 * x, 0.9 * x);
            val[full.nnz + p] = test_c(x, -2 * x);
        }
    CHECK_MSG(hd_ldl_analyse(&f, &full, &o, NULL, &e) == HD_OK, "%s", e.text);
    for (k = 0; k < 2; k++) {                    /* values and diagonal; the diagonal alone */
        double *dv = DENSE_NEW(double, full.nnz);
        hd_c64 *z = DENSE_NEW(hd_c64, full.nnz);
        CHECK_MSG(hd_ldl_factor_complex(f, 2, val, NULL, &e) == HD_OK && hd_ldl_inverse_complex(f, k ? NULL : values, diag, &e) == HD_OK, "%s", e.text);
        for (q = 0; q < 2; q++) CHECK_MSG(diag_off_dense(&full, val + q * full.nnz, values + q * full.nnz, diag + q * N) <= 1e-11, "matrix %d: off by %g", (int)q,
                                          diag_off_dense(&full, val + q * full.nnz, values + q * full.nnz, diag + q * N));
        CHECK_MSG(hd_ldl_factor(f, v, NULL, &e) == HD_OK && hd_ldl_inverse(f, dv, k ? NULL : d, &e) == HD_OK, "%s", e.text);
        if (k) CHECK(hd_ldl_inverse(f, NULL, d, &e) == HD_OK);
        diag_complex_of(v, z, full.nnz);
        {
            hd_c64 *zv = DENSE_NEW(hd_c64, full.nnz), zd[N];
            diag_complex_of(dv, zv, full.nnz);
            diag_complex_of(d, zd, N);
            CHECK_MSG(diag_off_dense(&full, z, zv, zd) <= 1e-11, "real: off by %g", diag_off_dense(&full, z, zv, zd));
            free(zv);
        }
        free(dv);
        free(z);
    }
    hd_ldl_free(f);
    hd_csr_free(&a, NULL);
    hd_csr_free(&full, NULL);
    free(v);
    free(val);
    free(values);
}

/* All ways of threading give the same bits; with large fronts too, that all threads share. */
static void diag_inverse_threads_of(const hd_csr *a, const double *xyz, int32_t k, const char *what) {
    const int32_t n = a->n_rows;
    const size_t size = (size_t)k * (size_t)a->nnz;
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz), *v = DENSE_NEW(double, a->nnz), *first_v = DENSE_NEW(double, a->nnz);
    hd_c64 *val = DENSE_NEW(hd_c64, size), *z = DENSE_NEW(hd_c64, size), *first = DENSE_NEW(hd_c64, size), *diag = DENSE_NEW(hd_c64, k * (int64_t)n);
    int64_t p, calls = 0;
    int32_t q;
    int way, level;
    ldl_pair(a, 3, L, B);
    ldl_shifted(a, L, B, k, 4, val);
    for (p = 0; p < a->nnz; p++) L[p] = 10 * L[p] + B[p];
    for (level = 0; level < 2; level++) {
        for (way = 0; way < LDL_WAYS; way++) {
            ldl_way *w = DENSE_NEW(ldl_way, 1);
            hd_ldl_opts o;
            hd_ldl *f;
            int64_t before;
            if (level == 1 && way != 0 && way != 6) {
                free(w);
                continue;
            }
            ldl_way_begin(w, way, ldl_simds[level]);
            o = ldl_opts_of(HD_ORDERING_AUTO, NULL, xyz, &w->ctx);
            f = ldl_make(a, &o, what);
            CHECK(hd_ldl_factor_complex(f, k, val, NULL, NULL) == HD_OK);
            before = w->calls;
            CHECK(hd_ldl_inverse_complex(f, way ? z : first, diag, NULL) == HD_OK);
            calls += w->calls - before;
            CHECK(hd_ldl_factor(f, L, NULL, NULL) == HD_OK);
            CHECK(hd_ldl_inverse(f, way ? v : first_v, NULL, NULL) == HD_OK);
            hd_ldl_free(f);
            ldl_way_end(w, way);
            free(w);
            if (way) CHECK_MSG(memcmp(z, first, size * sizeof *z) == 0 && memcmp(v, first_v, (size_t)a->nnz * sizeof *v) == 0,
                               "%s: way %d of threading gives other bits, level %d", what, way, level);
            for (q = 0; q < k && !way; q++) {
                const double off = diag_off_identity(a, val + q * a->nnz, first + q * a->nnz, diag + (size_t)q * (size_t)n);
                CHECK_MSG(off <= 1e-13, "%s: A Z is off by %g", what, off);
            }
        }
    }
    CHECK_MSG(calls > 0, "%s: never in parallel", what);
    free(L);
    free(B);
    free(v);
    free(first_v);
    free(val);
    free(z);
    free(first);
    free(diag);
}

static void diag_inverse_threads(void) {
    shape ball = shape_bumpy(4, 3);
    hd_csr a = ldl_mesh_pattern(&ball);
    ldl_edges g = ldl_edges_of(900);
    int32_t i;
    diag_inverse_threads_of(&a, ball.xyz, 5, "mesh");
    hd_csr_free(&a, NULL);
    shape_free(&ball);
    a = ldl_shape(LDL_DENSE, 420, 1, 1);
    diag_inverse_threads_of(&a, NULL, 2, "dense");
    hd_csr_free(&a, NULL);
    ldl_clique(&g, 0, 220);                      /* many small fronts below one that is shared */
    for (i = 220; i < 900; i++) {
        ldl_join(&g, i, (i * 7) % 220);
        ldl_join(&g, i, (i * 13 + 5) % 220);
        if (i % 3) ldl_join(&g, i, i - 1);
    }
    a = ldl_pattern(&g, 1);
    diag_inverse_threads_of(&a, NULL, 4, "clique with tails");
    hd_csr_free(&a, NULL);
}

/* variant 0: real, 1: complex, 2: without values; 3, 4: entries of a real one, of complex ones. */
static hd_status diag_inverse_job(hd_context *ctx, int variant) {
    enum { N = 48, K = 5 };
    hd_csr a = ldl_random_pattern(N, 4, 9);
    double *real = DENSE_NEW(double, a.nnz), *v = DENSE_NEW(double, a.nnz), d[N];
    hd_c64 *val = DENSE_NEW(hd_c64, K * a.nnz), *z = DENSE_NEW(hd_c64, K * a.nnz), zd[K * N];
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_AUTO, NULL, NULL, ctx);
    hd_ldl *f = ldl_mark;
    const int32_t i[4] = {0, N - 1, 7, 20}, j[4] = {3, 3, 11, 0};
    hd_error e;
    hd_status st;
    ldl_robust_values(&a, K, real, val);
    st = hd_ldl_analyse(&f, &a, &o, NULL, &e);
    if (st >= 0) {
        if (variant % 3 == 0) CHECK((st = hd_ldl_factor(f, real, NULL, &e)) == e.status);
        if (variant % 3 > 0) CHECK((st = hd_ldl_factor_complex(f, K, val, NULL, &e)) == e.status);
        if (variant == 0 && st >= 0) CHECK((st = hd_ldl_inverse(f, v, d, &e)) == e.status);
        if ((variant == 1 || variant == 2) && st >= 0) CHECK((st = hd_ldl_inverse_complex(f, variant == 1 ? z : NULL, zd, &e)) == e.status);
        if (variant == 3 && st >= 0) CHECK((st = hd_ldl_inverse_entries(f, 4, i, j, v, &e)) == e.status);
        if (variant == 4 && st >= 0) CHECK((st = hd_ldl_inverse_entries_complex(f, 4, i, j, z, &e)) == e.status);
        hd_ldl_free(f);
    }
    hd_csr_free(&a, NULL);
    free(real);
    free(v);
    free(val);
    free(z);
    return st;
}

/* After an inversion that was cancelled or found no memory the factor is as good as before. */
static void diag_inverse_survives(void) {
    enum { N = 60 };
    hd_csr a = ldl_shape(LDL_GRID, N, 1, 1);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_ldl_opts o = ldl_opts_of(HD_ORDERING_AUTO, NULL, NULL, &ctx);
    hd_ldl *f = ldl_make(&a, &o, "survives");
    double *L = DENSE_NEW(double, a.nnz), *B = DENSE_NEW(double, a.nnz), *b = DENSE_NEW(double, N), x[N], y[N];
    rob_progress p;
    hd_error e;
    int64_t k;
    for (k = 0; k < N; k++) b[k] = (double)(k % 7);
    ldl_pair(&a, 1, L, B);
    for (k = 0; k < a.nnz; k++) L[k] += B[k];
    CHECK(hd_ldl_inverse(f, B, NULL, &e) == HD_ERR_ARGUMENT && hd_ldl_inverse_complex(f, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_ldl_inverse(NULL, B, NULL, &e) == HD_ERR_ARGUMENT && hd_ldl_inverse_complex(NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_ldl_factor(f, L, NULL, NULL) == HD_OK && hd_ldl_solve(f, 1, b, 0, x, 0, NULL) == HD_OK);
    CHECK(hd_ldl_inverse_complex(f, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT);
    m.fail_at = m.calls + 1;
    CHECK(hd_ldl_inverse(f, B, NULL, &e) == HD_ERR_MEMORY);
    m.fail_at = 0;
    memset(&p, 0, sizeof p);
    p.stop_at = 1;
    p.answer = HD_PROGRESS_CANCEL;
    ctx.progress = rob_on_progress;
    ctx.progress_user = &p;
    CHECK(hd_ldl_inverse(f, B, NULL, &e) == HD_ERR_CANCELLED && e.status == HD_ERR_CANCELLED);
    ctx.progress = NULL;
    CHECK(hd_ldl_inverse(f, B, NULL, &e) == HD_OK && hd_ldl_solve(f, 1, b, 0, y, 0, NULL) == HD_OK);
    CHECK(memcmp(x, y, sizeof x) == 0);
    L[a.row_ptr[N - 1]] = NAN;                   /* a factorisation that failed has no inverse */
    L[a.nnz - 1] = NAN;
    CHECK(hd_ldl_factor(f, L, NULL, NULL) < 0 && hd_ldl_inverse(f, B, NULL, &e) == HD_ERR_ARGUMENT);
    hd_ldl_free(f);
    test_memory_done(&m, &ctx, "survives");
    hd_csr_free(&a, NULL);
    free(L);
    free(B);
    free(b);
}

static void diag_robust_jobs(const rob_job *job) {
    rob_fail_each_allocation(job);
    rob_byte_limits(job);
    rob_stop_each_progress(job, HD_PROGRESS_CANCEL, HD_ERR_CANCELLED);
    rob_stop_each_progress(job, (hd_progress)1, HD_ERR_ARGUMENT);
}

static void diag_inverse_robust(void) {
    int variant;
    for (variant = 0; variant < 5; variant++) {
        rob_job job;
        job.what = variant < 3 ? "inverse" : "inverse's entries";
        job.run = diag_inverse_job;
        job.variant = variant;
        diag_robust_jobs(&job);
    }
}

/* ---- diagonals and edges ---- */

/* X g(Lambda) X' [n n] on rows. */
static double *diag_matrix(const heat_case *c, const double *g) {
    const int32_t n = c->lap->n_active;
    double *K = DENSE_NEW(double, (int64_t)n * n);
    int32_t i, j, k;
    for (k = 0; k < n; k++) {
        const double *x = c->pair.x + (size_t)k * (size_t)n;
        for (i = 0; i < n && g[k] != 0; i++) {
            const double f = g[k] * x[i];
            double *row = K + (size_t)i * (size_t)n;
            for (j = 0; j < n; j++) row[j] += f * x[j];
        }
    }
    return K;
}

static double *diag_kernel(const heat_case *c, double t) {
    double *g = DENSE_NEW(double, c->lap->n_active), *K;
    int32_t k;
    for (k = 0; k < c->lap->n_active; k++) g[k] = exp(-t * c->pair.lambda[k]);
    K = diag_matrix(c, g);
    free(g);
    return K;
}

/* A B [n n], both symmetric. */
static double *diag_product(const double *a, const double *b, int32_t n) {
    double *c = DENSE_NEW(double, (int64_t)n * n);
    int32_t i, j, k;
    for (i = 0; i < n; i++)
        for (k = 0; k < n; k++) {
            const double f = a[(size_t)i * (size_t)n + (size_t)k];
            for (j = 0; j < n && f != 0; j++) c[(size_t)i * (size_t)n + (size_t)j] += f * b[(size_t)k * (size_t)n + (size_t)j];
        }
    return c;
}

/* What rounding and the oracle may add, relative: eigenvalues are off by an epsilon of the largest. */
static double diag_slack(const heat_case *c, double t) { return 1e-12 + 2e-15 * fmin(t * c->top, 1e8); }

static hd_heat *diag_plan(const hd_laplacian *lap, hd_pole_kind poles, int32_t degree) { return eng_plan(lap, HD_METHOD_AUTO, poles, degree); }

/* D [n] on vertices against want [n_active] on rows: within the bounds, and within most relative to each value (0: not asked). */
static void diag_judge(const heat_case *c, double t, const double *want, const double *D, const hd_report *rep, double most, const char *what) {
    const hd_laplacian *lap = c->lap;
    const double slack = diag_slack(c, t);
    double off = 0, size = 0, relative = 0, least = HUGE_VAL;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        const double x = D[lap->vertex[i]], diff = fabs(x - want[i]);
        if (!(diff <= off)) off = diff;
        if (!(diff / fabs(x) <= relative)) relative = diff / fabs(x);
        size = fmax(size, fabs(x));
        least = fmin(least, fabs(x));
    }
    CHECK_MSG(off <= (rep->error_bound + slack) * size, "%s, %s, degree %d, t %g: error %g, bound %g (maximum)", c->what, what, (int)rep->degree, t, off / size, rep->error_bound);
    CHECK_MSG(relative <= rep->error_relative + slack * size / least, "%s, %s, degree %d, t %g: error %g, bound %g (relative)", c->what, what, (int)rep->degree, t, relative,
              rep->error_relative);
    CHECK_MSG(most == 0 || relative <= most + slack, "%s, %s, degree %d, t %g: error %g (relative)", c->what, what, (int)rep->degree, t, relative);
    CHECK_MSG(rep->smallest == least && rep->error_bound >= rep->error_rational && rep->method == HD_METHOD_DIRECT && rep->status >= 0, "%s, %s: report", c->what, what);
}

/* Both kernels at one time with one plan, and edges. most: of the relative error. */
static void diag_against_dense(const heat_case *c, hd_heat *heat, double t, int32_t degree, double most, const char *what) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    double *K = diag_kernel(c, t), *KB = diag_product(K, c->pair.B, n), *want = DENSE_NEW(double, n), *D = DENSE_NEW(double, lap->n), *E = DENSE_NEW(double, lap->L.nnz);
    double off = 0, size = 0;
    hd_report rep;
    int64_t p;
    int32_t i;
    int q;
    for (q = 0; q < 2; q++) {
        for (i = 0; i < n; i++) want[i] = (q ? K : KB)[(size_t)i * (size_t)n + (size_t)i];
        heat_diagonal(heat, 1, &t, q ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, D, 0, &rep);
        CHECK_MSG(rep.status == (rep.error_bound <= 1e-2 ? HD_OK : HD_WARN_ACCURACY), "%s, %s: %s", c->what, what, rep.error.text);
        diag_judge(c, t, want, D, &rep, most, what);
        CHECK_MSG(degree == 0 || rep.degree == degree, "%s, %s: degree %d, not %d", c->what, what, (int)rep.degree, (int)degree);
        for (i = 0; i < lap->n; i++) CHECK(lap->row[i] >= 0 || D[i] == (q ? 0 : 1));
    }
    heat_edges(heat, t, E, &rep);
    CHECK_MSG(rep.status == (rep.error_bound <= 1e-2 ? HD_OK : HD_WARN_ACCURACY), "%s, %s: %s", c->what, what, rep.error.text);
    for (i = 0; i < n; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double w = K[(size_t)i * (size_t)n + (size_t)lap->L.col[p]];
            if (!(fabs(E[p] - w) <= off)) off = fabs(E[p] - w);
            size = fmax(size, fabs(w));
        }
    CHECK_MSG(most == 0 || off <= (most + diag_slack(c, t)) * size, "%s, %s, t %g: edges are off by %g", c->what, what, t, off / size);
    CHECK_MSG(off <= (rep.error_bound + diag_slack(c, t)) * size, "%s, %s, t %g: edges are off by %g, bound %g", c->what, what, t, off / size, rep.error_bound);
    CHECK_MSG(rep.error_rounding > 0 && rep.error_rounding < 1e-6 && (rep.residual > 0 || strstr(rep.reason, "eigenpairs")), "%s, %s: rounding of edges %g, residual %g", c->what, what, rep.error_rounding, rep.residual);
    for (i = 0; i < n && degree; i++)            /* the same set: the same numbers but for rounding */
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.col[p] == i) CHECK_MSG(fabs(E[p] - D[lap->vertex[i]]) <= 1e-10 * size, "%s, %s: edges and diagonal", c->what, what);
    free(K);
    free(KB);
    free(want);
    free(D);
    free(E);
}

/* All times from half to ten thousand h^2. longest: in h^2, where the oracle ends, or all heat has leaked away. odd: no surface, which is what the default
 * degree is made for. */
static void diag_case(hd_laplacian *lap, const char *what, double longest, int odd) {
    static const double times[6] = {0.5, 3, 30, 300, 3000, 10000};
    heat_case c = heat_case_of(lap, what);
    const double unit = lap->kind == HD_LAPLACIAN_COT || lap->h == 0 ? 1 : lap->h * lap->h;
    hd_heat *def = diag_plan(lap, HD_POLES_DEFAULT, 0), *top = diag_plan(lap, HD_POLES_DIAGONAL, 14), *kernel = diag_plan(lap, HD_POLES_KERNEL, 14);
    hd_heat *low = diag_plan(lap, HD_POLES_DIAGONAL, 5), *uniform = diag_plan(lap, HD_POLES_UNIFORM, 10), *rough = diag_plan(lap, HD_POLES_UNIFORM, 4);
    int q;
    for (q = 0; q < 6 && times[q] <= longest; q++) {
        const double t = times[q] * unit;
        diag_against_dense(&c, def, t, 0, odd ? 3e-7 : 1e-7, "default");
        diag_against_dense(&c, top, t, 14, 1e-9, "diagonal 14");
        if (q % 2) continue;
        diag_against_dense(&c, kernel, t, 14, 1e-9, "kernel 14");
        diag_against_dense(&c, low, t, 5, 0.1, "diagonal 5");
        diag_against_dense(&c, uniform, t, 10, 0.1, "uniform 10");
        diag_against_dense(&c, rough, t, 4, 0, "uniform 4");
    }
    hd_heat_free(def);
    hd_heat_free(top);
    hd_heat_free(kernel);
    hd_heat_free(low);
    hd_heat_free(uniform);
    hd_heat_free(rough);
    heat_case_free(&c);
}

/* A flat grid with a hole, a handful of slivers, unreferenced vertices, and a second piece. */
static shape diag_odd_shape(void) {
    const double offset[3] = {4, 0, 0};
    shape g = shape_grid(9, 8, 0.3), b = shape_icosphere(0), s, out;
    int32_t i, kept = 0;
    for (i = 0; i < g.n_tri; i++)                /* the hole */
        if (i < 50 || i > 56) {
            memmove(g.tri + 3 * kept, g.tri + 3 * i, 3 * sizeof *g.tri);
            kept++;
        }
    g.n_tri = kept;
    for (i = 20; i < 24; i++) g.xyz[3 * i + 1] += 0.096 * (i % 2 ? 1 : -1) * 0.5;
    s = shape_disjoint(&g, &b, offset);
    out = eng_with_inert(&s);
    shape_free(&g);
    shape_free(&b);
    shape_free(&s);
    return out;
}

static void diag_dense_cases(void) {
    shape ball = shape_bumpy(2, 5), odd = diag_odd_shape(), grid = shape_grid(9, 7, 0.3), soup = eng_soup(40, 60, 3);
    int32_t i;
    int q;
    for (i = 0; i < 3 * grid.n; i += 3)          /* slivers: a column of cells pressed to a hundredth of its width */
        if (i / 3 % 9 == 4) grid.xyz[i] = grid.xyz[i - 3] + 0.00125;
    for (q = 0; q < 3; q++) {
        diag_case(test_laplacian(&ball, op_kinds[q]), "ball", 1e4, 0);
        diag_case(test_laplacian(&odd, op_kinds[q]), "hole, pieces, inert", 1e4, 0);
        diag_case(test_laplacian(&grid, op_kinds[q]), "slivers", 1e4, 0);
    }
    diag_case(test_laplacian(&soup, HD_LAPLACIAN_FEM), "soup", 300, 1);
    diag_case(eng_leaking(8, 7), "leaking", 3, 1);
    shape_free(&ball);
    shape_free(&odd);
    shape_free(&grid);
    shape_free(&soup);
}

/* Several times in one call agree with each by itself, columns apart; t rising, k_t(x,x) falling; sum of b k_t(v,v) is the trace for diagonal B. */
static void diag_times(void) {
    shape s = shape_bumpy(2, 8);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    heat_case c = heat_case_of(lap, "times");
    hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
    const double hh = lap->h * lap->h, t[5] = {20 * hh, hh, 3 * hh, 200 * hh, 1000 * hh};
    static const int order[5] = {1, 2, 0, 3, 4};
    const size_t ldd = (size_t)s.n + 3;
    double *D = DENSE_NEW(double, 5 * ldd), *one = DENSE_NEW(double, s.n);
    hd_report rep, single;
    int32_t i, k;
    int q;
    for (i = 0; i < 5 * (int32_t)ldd; i++) D[i] = -7;
    CHECK(heat_diagonal(heat, 5, t, HD_KERNEL_SYMMETRIC, D, ldd, &rep) == HD_OK);
    for (q = 0; q < 5; q++) {
        double sum = 0, trace = 0;
        CHECK(heat_diagonal(heat, 1, t + q, HD_KERNEL_SYMMETRIC, one, 0, &single) == HD_OK);
        for (i = 0; i < s.n; i++)                /* by shared poles, not those of the single time */
            CHECK_MSG(fabs(one[i] - D[(size_t)q * ldd + (size_t)i]) <= (single.error_relative + rep.error_relative) * one[i] && fabs(one[i] - D[(size_t)q * ldd + (size_t)i]) <= 2e-7 * one[i],
                      "t %g, vertex %d: %.12g, alone %.12g", t[q], (int)i, D[(size_t)q * ldd + (size_t)i], one[i]);
        for (i = 0; i < s.n; i++) sum += lap->mass[i] * one[lap->vertex[i]];
        for (k = 0; k < s.n; k++) trace += exp(-t[q] * c.pair.lambda[k]);
        CHECK_MSG(fabs(sum - trace) <= 1e-7 * trace, "t %g: sum %.12g, trace %.12g", t[q], sum, trace);
        for (i = 0; i < s.n && q; i++)
            CHECK_MSG(D[(size_t)order[q] * ldd + (size_t)i] <= D[(size_t)order[q - 1] * ldd + (size_t)i] * (1 + 1e-8), "t %g, vertex %d: it grows", t[order[q]], (int)i);
        for (i = s.n; i < (int32_t)ldd; i++) CHECK(D[(size_t)q * ldd + (size_t)i] == -7);
    }
    CHECK(heat_diagonal(heat, 0, NULL, HD_KERNEL_SYMMETRIC, NULL, 0, &rep) == HD_ERR_ARGUMENT);
    hd_heat_free(heat);
    heat_case_free(&c);
    free(D);
    free(one);
    shape_free(&s);
}

/* The unit sphere: the mean and the worst of the error of k_t(x,x) fall under refinement. */
static void diag_sphere(void) {
    const double t = 0.15, want = heat_sphere(0.15, 1);
    int q, level;
    for (q = 0; q < 2; q++) {
        double before = 0, worst = 0;
        for (level = 1; level <= 4; level++) {
            shape s = shape_icosphere(level);
            hd_laplacian *lap = test_laplacian(&s, op_kinds[q]);
            hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
            double *D = DENSE_NEW(double, s.n);
            int32_t i;
            worst = 0;
            CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, NULL) == HD_OK);
            for (i = 0; i < s.n; i++) worst += fabs(D[i] - want) / want / s.n;    /* in the mean: near the twelve odd vertices it converges more slowly */
            if (level > 1) CHECK_MSG(worst < before / 3, "kind %d level %d: error %g after %g", q, level, worst, before);
            before = worst;
            free(D);
            hd_heat_free(heat);
            hd_laplacian_free(lap);
            shape_free(&s);
        }
        CHECK_MSG(worst < 2e-2, "kind %d: error %g on the finest sphere", q, worst);
    }
}

/* ---- distances ---- */

/* H with d^2 = H_ii - 2 H_ij + H_jj. */
static double *diag_gram(const heat_case *c, hd_distance_kind kind, double t) {
    const int32_t n = c->lap->n_active;
    double *g = DENSE_NEW(double, n), *H, *HB, *K;
    int32_t k;
    for (k = 0; k < n; k++) {
        const double l = c->pair.lambda[k];
        g[k] = kind <= HD_DISTANCE_WEIGHTED ? exp(-2 * t * l) : l > 0 ? (kind == HD_DISTANCE_COMMUTE ? 1 / l : 1 / (l * l)) : 0;
    }
    H = diag_matrix(c, g);
    free(g);
    if (kind != HD_DISTANCE_WEIGHTED) return H;
    K = H;
    HB = diag_product(K, c->pair.B, n);
    H = diag_product(c->pair.B, HB, n);
    free(K);
    free(HB);
    return H;
}

static const char *diag_kind_name(hd_distance_kind k) {
    static const char *const names[4] = {"classical", "weighted", "commute", "biharmonic"};
    return names[k];
}

/* D [n] from one source, against H on rows. lost: whether any may be lost. most: of the error relative to the largest distance (0: not asked). */
static void diag_judge_distance(const heat_case *c, hd_distance_kind kind, double t, const double *H, int32_t source, const double *D, const hd_report *rep, double most,
                                const char *what) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active, s = lap->row[source];
    double size = 0, off = 0, relative = 0, scale = 0, slack = kind <= HD_DISTANCE_WEIGHTED ? diag_slack(c, t) : 1e-11;
    int32_t v;
    TRAPS_OFF;                                   /* distances of 0, or infinite */
    for (v = 0; v < n; v++) scale = fmax(scale, H[(size_t)v * (size_t)n + (size_t)v]);
    for (v = 0; v < lap->n; v++) {
        const int32_t r = lap->row[v];
        const double fs = s < 0 ? 0 : H[(size_t)s * (size_t)n + (size_t)s], f = r < 0 ? 0 : H[(size_t)r * (size_t)n + (size_t)r];
        const double cross = s < 0 || r < 0 ? 0 : H[(size_t)s * (size_t)n + (size_t)r], d2 = fmax(0, fs - 2 * cross + f), d = sqrt(d2);
        if (v == source) {
            CHECK(D[v] == 0);
            continue;
        }
        if (kind >= HD_DISTANCE_COMMUTE && (s < 0 || r < 0 || lap->component[s] != lap->component[r])) {
            CHECK_MSG(D[v] == HUGE_VAL, "%s, %s: %g between components", c->what, diag_kind_name(kind), D[v]);
            continue;
        }
        if (!CHECK_MSG(D[v] >= 0 && D[v] < HUGE_VAL, "%s, %s, %s: distance %g", c->what, diag_kind_name(kind), what, D[v])) continue;
        size = fmax(size, d);
        off = fmax(off, fabs(D[v] - d) - fmin(sqrt(slack * scale), d > 0 ? slack * scale / d : HUGE_VAL));
        if (d2 > 1e4 * slack * scale) relative = fmax(relative, fabs(D[v] - d) / D[v] - slack * scale / d2);
    }
    CHECK_MSG(off <= rep->error_bound * size, "%s, %s, %s, t %g: error %g, bound %g", c->what, diag_kind_name(kind), what, t, off / size, rep->error_bound);
    CHECK_MSG(relative <= rep->error_relative, "%s, %s, %s, t %g: error %g, bound %g (relative)", c->what, diag_kind_name(kind), what, t, relative, rep->error_relative);
    CHECK_MSG(most == 0 || off <= most * size, "%s, %s, %s, t %g: error %g", c->what, diag_kind_name(kind), what, t, off / size);
    TRAPS_ON;
}

/* Sources and times in one call; the columns' order; ldd; every one against the dense. */
static void diag_distances_of(const heat_case *c, hd_pole_kind poles, int32_t degree, double longest, double most, const char *what) {
    const hd_laplacian *lap = c->lap;
    const double unit = lap->kind == HD_LAPLACIAN_COT || lap->h == 0 ? 1 : lap->h * lap->h;
    const double times[3] = {fmin(longest, 40) * unit, 0.7 * unit, 5 * unit};
    const int32_t sources[4] = {lap->vertex[0], lap->vertex[lap->n_active / 2], lap->vertex[lap->n_active - 1], lap->row[0] < 0 ? 0 : lap->vertex[1]};
    const size_t ldd = (size_t)lap->n + 2;
    double *D = DENSE_NEW(double, 12 * ldd);
    hd_heat *heat = diag_plan(lap, poles, degree);
    hd_report rep;
    int kind, m, s;
    for (kind = 0; kind < 4; kind++) {
        const int n_times = kind < 2 ? 3 : 1;
        size_t i;
        for (i = 0; i < 12 * ldd; i++) D[i] = -3;
        CHECK_MSG(heat_distance(heat, (hd_distance_kind)kind, n_times, kind < 2 ? times : NULL, 4, sources, D, ldd, &rep) >= 0, "%s, %s: %s", c->what,
                  diag_kind_name((hd_distance_kind)kind), rep.error.text);
        CHECK(rep.method == HD_METHOD_DIRECT && rep.status >= 0);
        if (kind < 2 && degree) CHECK(rep.degree == degree);
        for (m = 0; m < n_times; m++) {
            double *H = diag_gram(c, (hd_distance_kind)kind, times[m]);
            for (s = 0; s < 4; s++) {
                const double *col = D + (size_t)(s * n_times + m) * ldd;
                diag_judge_distance(c, (hd_distance_kind)kind, times[m], H, sources[s], col, &rep, kind < 2 ? most : 1e-8, what);
                CHECK(col[lap->n] == -3 && col[lap->n + 1] == -3);
            }
            free(H);
        }
    }
    hd_heat_free(heat);
    free(D);
}

static void diag_distances(void) {
    shape ball = shape_bumpy(2, 5), odd = diag_odd_shape();
    int q;
    for (q = 0; q < 3; q++) {
        heat_case c = heat_case_of(test_laplacian(&ball, op_kinds[q]), "ball"), d = heat_case_of(test_laplacian(&odd, op_kinds[q]), "hole, pieces, inert");
        diag_distances_of(&c, HD_POLES_DEFAULT, 0, 1e9, 1e-6, "default");
        diag_distances_of(&c, HD_POLES_DIAGONAL, 14, 1e9, 1e-8, "diagonal 14");
        diag_distances_of(&c, HD_POLES_UNIFORM, 8, 1e9, 0, "uniform 8");
        diag_distances_of(&d, HD_POLES_DEFAULT, 0, 1e9, 1e-6, "default");
        diag_distances_of(&d, HD_POLES_KERNEL, 6, 1e9, 0, "kernel 6");
        heat_case_free(&c);
        heat_case_free(&d);
    }
    {
        heat_case c = heat_case_of(eng_leaking(8, 7), "leaking");
        diag_distances_of(&c, HD_POLES_DEFAULT, 0, 2, 2.5e-6, "default");   /* what is promised: the bound is kept below that */
        heat_case_free(&c);
    }
    shape_free(&ball);
    shape_free(&odd);
}

/* Effective resistances: |i - j| on a path, k (n - k)/n on a cycle, 2/n in a complete graph. */
static void diag_resistances(void) {
    enum { N = 30 };
    int q;
    for (q = 0; q < 3; q++) {
        hd_csr L, B = test_diagonal_csr(N, NULL);
        hd_laplacian *lap = NULL;
        hd_heat *heat;
        double D[2 * N];
        const int32_t sources[2] = {4, 29};
        hd_report rep;
        int32_t v;
        int s;
        if (q < 2) L = test_path_csr(N, q);
        else {
            int32_t *i = DENSE_NEW(int32_t, 2 * N * N), *j = DENSE_NEW(int32_t, 2 * N * N), a, b;
            double *w = DENSE_NEW(double, 2 * N * N);
            int64_t count = 0;
            for (a = 0; a < N; a++)
                for (b = a; b < N; b++) {
                    i[count] = a;
                    j[count] = b;
                    w[count++] = a == b ? N - 1 : -1;
                }
            L = test_symmetric_csr(N, count, i, j, w);
            free(i);
            free(j);
            free(w);
        }
        CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK);
        heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
        CHECK_MSG(heat_distance(heat, HD_DISTANCE_COMMUTE, 1, NULL, 2, sources, D, 0, &rep) == HD_OK, "%s", rep.error.text);
        for (s = 0; s < 2; s++)
            for (v = 0; v < N; v++) {
                const int32_t k = v > sources[s] ? v - sources[s] : sources[s] - v;
                const double want = k == 0 ? 0 : q == 0 ? k : q == 1 ? k * (double)(N - k) / N : 2.0 / N, d = D[s * N + v];
                CHECK_MSG(fabs(d * d - want) <= 1e-9 * want, "graph %d: resistance %.15g, not %.15g", q, d * d, want);
            }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        hd_csr_free(&L, NULL);
        hd_csr_free(&B, NULL);
    }
}

/* At times when all has become equal: no NaN, losses counted; pairs still know. */
static void diag_lost(void) {
    shape s = shape_bumpy(2, 5);
    int q, kind;
    for (q = 0; q < 2; q++) {
        hd_laplacian *lap = test_laplacian(&s, op_kinds[q]);
        hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
        const double t = 1e6 * lap->h * lap->h;
        const int32_t source = 3;
        double *D = DENSE_NEW(double, s.n);
        hd_report rep;
        int32_t v;
        for (kind = 0; kind < 2; kind++) {
            CHECK(heat_distance(heat, (hd_distance_kind)kind, 1, &t, 1, &source, D, 0, &rep) >= 0);
            for (v = 0; v < s.n; v++) CHECK_MSG(D[v] >= 0 && D[v] < 1e3, "%g", D[v]);
            CHECK_MSG((rep.n_lost > 0) == (kind == 0), "kind %d: %lld lost", kind, (long long)rep.n_lost);
            CHECK_MSG(rep.error_bound == rep.error_bound && rep.error_relative == rep.error_relative, "kind %d: NaN in the report", kind);
        }
        free(D);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    shape_free(&s);
}

/* ---- pairs and samples ---- */

/* Listed pairs against the dense kernel and distances. */
static void diag_pairs_of(const heat_case *c) {
    enum { PAIRS = 40 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    const double t = 4 * (lap->kind == HD_LAPLACIAN_COT || lap->h == 0 ? 1 : lap->h * lap->h);
    double *K = diag_kernel(c, t), *KB = diag_product(K, c->pair.B, n), k[PAIRS], d[PAIRS], again[PAIRS];
    hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
    int32_t i[PAIRS], j[PAIRS];
    uint64_t seed = 5;
    hd_report rep, first;
    double most;
    int kind, q;
    for (q = 0; q < PAIRS; q++) {
        i[q] = ldl_below(&seed, lap->n);
        j[q] = q % 10 == 3 ? i[q] : ldl_below(&seed, lap->n);
    }
    i[0] = j[0] = 0;                             /* without mass in some cases */
    for (kind = 0; kind < 4; kind++) {
        double *H = diag_gram(c, (hd_distance_kind)kind, t), size = 0, size_k = dense_max_abs(KB, (int64_t)n * n);
        for (q = 0; q < PAIRS; q++) k[q] = d[q] = -5;
        CHECK_MSG(heat_pairs(heat, (hd_distance_kind)kind, t, PAIRS, i, j, k, d, &first) >= 0, "%s, %s: %s", c->what, diag_kind_name((hd_distance_kind)kind), first.error.text);
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, t, PAIRS, i, j, NULL, again, &rep) >= 0 && memcmp(again, d, sizeof d) == 0);
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, t, PAIRS, i, j, again, NULL, &rep) >= 0 && (kind > 1 || memcmp(again, k, sizeof k) == 0));
        for (q = 0; q < n; q++) size = fmax(size, sqrt(fabs(H[(size_t)q * (size_t)n + (size_t)q])));
        for (q = 0, most = 0; q < PAIRS; q++)
            if (d[q] < HUGE_VAL) most = fmax(most, d[q]);
        for (q = 0; q < PAIRS; q++) {
            const int32_t a = lap->row[i[q]], b = lap->row[j[q]];
            const double fa = a < 0 ? 0 : H[(size_t)a * (size_t)n + (size_t)a], fb = b < 0 ? 0 : H[(size_t)b * (size_t)n + (size_t)b];
            const double cross = a < 0 || b < 0 ? 0 : H[(size_t)a * (size_t)n + (size_t)b];
            double want = i[q] == j[q] ? 0 : sqrt(fmax(0, fa - 2 * cross + fb));
            const double entry = a < 0 || b < 0 ? i[q] == j[q] : KB[(size_t)a * (size_t)n + (size_t)b];
            if (kind > 1 && i[q] != j[q] && (a < 0 || b < 0 || lap->component[a] != lap->component[b])) want = HUGE_VAL;
            CHECK_MSG(want == HUGE_VAL ? d[q] == want : fabs(d[q] - want) <= 1e-6 * size, "%s, %s, pair %d (%d, %d): %.12g, not %.12g", c->what, diag_kind_name((hd_distance_kind)kind), q,
                      (int)i[q], (int)j[q], d[q], want);
            if (want < HUGE_VAL && lap->b_ratio > 0)
                CHECK_MSG(fabs(d[q] - want) <= fmin(first.error_bound * most, first.error_relative * d[q]) + 1e-11 * size, "%s, %s, pair %d: %.12g, not %.12g, bounds %g, %g", c->what,
                          diag_kind_name((hd_distance_kind)kind), q, d[q], want, first.error_bound, first.error_relative);
            if (kind > 1) CHECK(k[q] == -5);
            else CHECK_MSG(fabs(k[q] - entry) <= 1e-7 * size_k, "%s, %s, pair %d: entry %.12g, not %.12g", c->what, diag_kind_name((hd_distance_kind)kind), q, k[q], entry);
        }
        free(H);
    }
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, 0, NULL, NULL, NULL, NULL, &rep) == HD_OK);
    hd_heat_free(heat);
    free(K);
    free(KB);
}

/* Which stages of work were told of; stops at the tenth of them, or of solves. */
typedef struct diag_stages { int inverts, solves; } diag_stages;

static hd_progress diag_on_stage(void *user, const char *stage, double done) {
    diag_stages *x = (diag_stages *)user;
    (void)done;
    x->inverts += strcmp(stage, "invert") == 0;
    x->solves += strcmp(stage, "solve") == 0;
    return x->inverts == 10 || x->solves == 10 ? HD_PROGRESS_CANCEL : HD_PROGRESS_CONTINUE;
}

/* Pairs of more vertices than columns fit into half a GiB keep the method that was asked for: only the direct one inverts factors. */
static void diag_pairs_method(void) {
    enum { PAIRS = 8280 };
    shape s = shape_grid(91, 91, 0.3);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    const double t = 3 * lap->h * lap->h;
    int32_t *i = DENSE_NEW(int32_t, PAIRS), *j = DENSE_NEW(int32_t, PAIRS);
    double *d = DENSE_NEW(double, PAIRS);
    int m, q;
    for (q = 0; q < PAIRS; q++) j[q] = q + 1;
    for (m = HD_METHOD_ITERATIVE; m <= HD_METHOD_KRYLOV; m++) {
        diag_stages seen = {0, 0};
        hd_context ctx;
        hd_heat_opts o = eng_opts((hd_method)m);
        hd_heat *heat;
        hd_report rep;
        memset(&ctx, 0, sizeof ctx);
        ctx.progress = diag_on_stage;
        ctx.progress_user = &seen;
        o.context = &ctx;
        heat = eng_create(lap, &o);
        CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, PAIRS, i, j, NULL, d, &rep) == HD_ERR_CANCELLED);
        CHECK_MSG((seen.inverts > 0) == (m == HD_METHOD_DIRECT) && (seen.solves == 10) == (m != HD_METHOD_DIRECT), "%s: %d inversions, %d solves", eng_name((hd_method)m),
                  seen.inverts, seen.solves);
        hd_heat_free(heat);
    }
    free(i);
    free(j);
    free(d);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* Symmetry and the triangle inequality, at a time when little is left of distances. */
static void diag_metric_laws(void) {
    enum { TRIPLES = 60 };
    shape s = shape_bumpy(2, 2);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
    int32_t i[6 * TRIPLES], j[6 * TRIPLES], v[3];
    double d[6 * TRIPLES];
    uint64_t seed = 77;
    int kind, q, k;
    for (q = 0; q < TRIPLES; q++) {
        for (k = 0; k < 3; k++) v[k] = ldl_below(&seed, s.n);
        for (k = 0; k < 3; k++) {
            i[6 * q + k] = j[6 * q + 3 + k] = v[k];
            j[6 * q + k] = i[6 * q + 3 + k] = v[(k + 1) % 3];
        }
    }
    for (kind = 0; kind < 4; kind++) {
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, 500 * lap->h * lap->h, 6 * TRIPLES, i, j, NULL, d, NULL) >= 0);
        for (q = 0; q < TRIPLES; q++) {
            const double *e = d + 6 * q;
            for (k = 0; k < 3; k++) {
                CHECK_MSG(fabs(e[k] - e[k + 3]) <= 1e-7 * e[k] && (e[k] > 0) == (i[6 * q + k] != j[6 * q + k]), "kind %d: %.15g one way, %.15g the other", kind, e[k], e[k + 3]);
                CHECK_MSG(e[k] <= (e[(k + 1) % 3] + e[(k + 2) % 3]) * (1 + 1e-7), "kind %d: %.15g > %.15g + %.15g", kind, e[k], e[(k + 1) % 3], e[(k + 2) % 3]);
            }
        }
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* Samples are those of brute force with the distances of the dense; ties aside, which an uneven shape has none of. */
static void diag_samples_of(const heat_case *c) {
    enum { COUNT = 9 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    const double t = 10 * (lap->kind == HD_LAPLACIAN_COT ? 1 : lap->h * lap->h);
    hd_heat *heat = diag_plan(lap, HD_POLES_DIAGONAL, 14);
    int kind, given, q;
    for (kind = 0; kind < 4; kind++) {
        double *H = diag_gram(c, (hd_distance_kind)kind, t);
        for (given = 0; given < 4; given += 3) {
            int32_t vertex[COUNT] = {-1, -1, -1, -1, -1, -1, -1, -1, -1}, chosen[COUNT], v, k;
            double distance[COUNT];
            hd_report rep;
            for (q = 0; q < given; q++) vertex[q] = lap->vertex[(q * 31 + 11) % n];
            CHECK_MSG(heat_sample(heat, (hd_distance_kind)kind, t, COUNT, given, vertex, distance, &rep) >= 0, "%s", rep.error.text);
            for (q = 0; q < COUNT; q++) {        /* what brute force makes of the same beginning */
                double best = -1, own = HUGE_VAL;
                chosen[q] = vertex[q];
                for (v = 0; v < n && q > 0; v++) {
                    double near = HUGE_VAL;
                    for (k = 0; k < q; k++) {
                        const int32_t r = lap->row[vertex[k]];
                        double d = sqrt(fmax(0, H[(size_t)r * (size_t)n + (size_t)r] - 2 * H[(size_t)r * (size_t)n + (size_t)v] + H[(size_t)v * (size_t)n + (size_t)v]));
                        if (kind > 1 && lap->component[r] != lap->component[v]) d = HUGE_VAL;
                        near = fmin(near, d);
                    }
                    if (near > best) {
                        best = near;
                        chosen[q] = lap->vertex[v];
                    }
                    if (lap->vertex[v] == vertex[q]) own = near;
                }
                if (q >= given && q > 0) CHECK_MSG(own == best || own >= best * (1 - 1e-6), "%s, %s, point %d: vertex %d, not %d", c->what, diag_kind_name((hd_distance_kind)kind), q,
                                                   (int)vertex[q], (int)chosen[q]);
                CHECK_MSG(q == 0 ? distance[0] == 0 : own == distance[q] || fabs(own - distance[q]) <= 1e-6 * own, "%s, %s, point %d: distance %g, not %g", c->what,
                          diag_kind_name((hd_distance_kind)kind), q, distance[q], own);
                CHECK(lap->row[vertex[q]] >= 0);
            }
            CHECK(given || vertex[0] == lap->vertex[0]);
        }
        {
            int32_t one = -9;
            CHECK(heat_sample(heat, (hd_distance_kind)kind, t, 1, 0, &one, NULL, NULL) >= 0 && one == lap->vertex[0]);
        }
        free(H);
    }
    hd_heat_free(heat);
}

static void diag_pairs(void) {
    shape ball = shape_bumpy(2, 5), odd = diag_odd_shape();
    int q;
    for (q = 0; q < 3; q++) {
        heat_case c = heat_case_of(test_laplacian(&ball, op_kinds[q]), "ball"), d = heat_case_of(test_laplacian(&odd, op_kinds[q]), "hole, pieces, inert");
        diag_pairs_of(&c);
        diag_pairs_of(&d);
        if (q != 1) diag_samples_of(&c);
        if (q != 0) diag_samples_of(&d);
        heat_case_free(&c);
        heat_case_free(&d);
    }
    shape_free(&ball);
    shape_free(&odd);
}

/* ---- sets, pairs of matrices, orderings, threads ---- */

/* Sets made for diagonals: c(0) = 1, and the error under their weight as promised. */
static void diag_sets(void) {
    hd_rational set;
    hd_error e;
    int32_t r, k;
    for (r = 2; r <= 14; r++) {
        double weighted = 0, plain = 0;
        CHECK(hd_rational_get(&set, HD_POLES_DIAGONAL, r, &e) == HD_OK && set.kind == HD_POLES_DIAGONAL && set.degree == r && set.n_poles == (r + 1) / 2 && set.a0 == 0);
        CHECK_MSG(fabs(hd_rational_eval(&set, 0) - 1) < 2e-15 * pow(1.5, r), "degree %d: c(0) - 1 = %g", (int)r, hd_rational_eval(&set, 0) - 1);
        for (k = 0; k <= 10000; k++) {
            const double x = pow(10, -6 + k * 1e-3), error = fabs(exp(-x) - hd_rational_eval(&set, -x));
            plain = fmax(plain, error);
            if (x < 1e4) weighted = fmax(weighted, (1 + x) * (1 + 4 * x / (x + 1000)) * error);
        }
        CHECK_MSG(plain <= set.max_error + 1e-14 * pow(1.43, r) && plain >= 0.85 * set.max_error - 2e-15, "degree %d: error %g, promised %g", (int)r, plain, set.max_error);
        CHECK_MSG(weighted <= set.max_weighted_error + 1e-13 * pow(1.43, r) && weighted >= 0.85 * set.max_weighted_error - 2e-15, "degree %d: weighted error %g, promised %g", (int)r,
                  weighted, set.max_weighted_error);
    }
    CHECK(hd_rational_get(&set, HD_POLES_DIAGONAL, 1, &e) == HD_ERR_ARGUMENT && hd_rational_get(&set, HD_POLES_DIAGONAL, 15, &e) == HD_ERR_ARGUMENT);
}

/* A filter of the caller's: its own diagonal, without an error of approximation; a0 too where B is diagonal. */
static void diag_own_sets(void) {
    shape s = shape_grid(9, 7, 0.3);
    int q, which;
    for (q = 0; q < 3; q++) {
        for (which = 0; which < 2; which++) {
            heat_case c = heat_case_of(test_laplacian(&s, op_kinds[q]), "own");
            const int32_t n = c.lap->n_active;
            hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
            hd_rational set;
            hd_heat *heat;
            hd_report rep;
            const double t = q == 2 ? 2 : 2 * c.lap->h * c.lap->h;
            double *g = DENSE_NEW(double, n), *D = DENSE_NEW(double, n), *K, *KB;
            double off = 0, size = 0;
            int32_t i;
            memset(&set, 0, sizeof set);
            set.n_poles = set.degree = 1;        /* backward Euler, with a bit of the identity */
            set.theta[0].re = 1;
            set.a[0].re = -1;
            set.a0 = which && q ? 0.25 : 0;
            o.rational = &set;
            heat = eng_create(c.lap, &o);
            for (i = 0; i < n; i++) g[i] = set.a0 + 1 / (1 + t * c.pair.lambda[i]);
            K = diag_matrix(&c, g);
            CHECK_MSG(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_OK && rep.n_poles == 1, "%s", rep.error.text);
            for (i = 0; i < n; i++) {
                off = fmax(off, fabs(D[c.lap->vertex[i]] - K[(size_t)i * (size_t)n + (size_t)i]));
                size = fmax(size, D[i]);
            }
            CHECK_MSG(off <= 1e-12 * size && rep.error_bound <= 1e-10, "own set, kind %d: off by %g, bound %g", q, off / size, rep.error_bound);
            hd_heat_free(heat);
            set.a0 = 0.25;                       /* on the diagonal of the operator for any B */
            heat = eng_create(c.lap, &o);
            for (i = 0; i < n; i++) g[i] = 0.25 + 1 / (1 + t * c.pair.lambda[i]);
            free(K);
            K = diag_matrix(&c, g);
            KB = diag_product(K, c.pair.B, n);
            CHECK_MSG(heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, D, 0, &rep) == HD_OK, "%s", rep.error.text);
            for (i = 0; i < n; i++) CHECK_MSG(fabs(D[c.lap->vertex[i]] - KB[(size_t)i * (size_t)n + (size_t)i]) <= 1e-12, "own set, kind %d: operator %.15g, not %.15g", q,
                                              D[c.lap->vertex[i]], KB[(size_t)i * (size_t)n + (size_t)i]);
            free(KB);
            hd_heat_free(heat);
            heat_case_free(&c);
            free(g);
            free(D);
            free(K);
        }
    }
    shape_free(&s);
}

/* A full B of the caller's, of which nothing is known, and an L that leaks. */
static void diag_own_matrices(void) {
    shape s = shape_grid(8, 7, 0.2);
    hd_laplacian *mesh = test_laplacian(&s, HD_LAPLACIAN_FEM), *lap = NULL;
    hd_csr B = mesh->L, L = mesh->L;
    heat_case c;
    int64_t p;
    int32_t i;
    B.val = mesh->B;
    for (i = 0; i < L.n_rows; i += 9)
        for (p = L.row_ptr[i]; p < L.row_ptr[i + 1]; p++)
            if (L.col[p] == i) L.val[p] += 0.05;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, mesh->h, NULL, NULL) == HD_OK && lap->B && !lap->conserves);
    diag_case(lap, "own matrices", 300, 1);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, mesh->h, NULL, NULL) == HD_OK);
    c = heat_case_of(lap, "own matrices");
    diag_distances_of(&c, HD_POLES_DEFAULT, 0, 20, 1e-6, "default");
    heat_case_free(&c);
    hd_laplacian_free(mesh);
    shape_free(&s);
}

/* The elimination order makes no difference, whoever gives it. Threads make none at all. */
static void diag_orders(void) {
    shape b = shape_bumpy(2, 9), s = eng_with_inert(&b);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    int32_t *perm = DENSE_NEW(int32_t, s.n), source = 6, i;
    const double t = 3 * lap->h * lap->h;
    double *first = DENSE_NEW(double, 5 * s.n), *D = DENSE_NEW(double, 5 * s.n);
    uint64_t seed = 3;
    int q, kind;
    dense_shuffle(perm, s.n, &seed);
    for (q = 0; q < 4; q++) {
        hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
        hd_heat *heat;
        hd_report rep;
        o.ordering = ldl_orderings[q];
        o.perm = perm;
        heat = eng_create(lap, &o);
        if (q == 3) memset(perm, 0, (size_t)s.n * sizeof *perm);    /* it was copied */
        for (kind = 0; kind < 4; kind++) CHECK_MSG(heat_distance(heat, (hd_distance_kind)kind, 1, &t, 1, &source, D + kind * s.n, 0, &rep) >= 0, "%s", rep.error.text);
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, D + 4 * s.n, 0, &rep) >= 0);
        if (q == 0) memcpy(first, D, 5 * (size_t)s.n * sizeof *D);
        for (i = 0; i < 5 * s.n; i++) CHECK_MSG(D[i] == first[i] || fabs(D[i] - first[i]) <= 1e-8 * fabs(first[i]), "ordering %d: %.12g, not %.12g", q, D[i], first[i]);
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    free(perm);
    free(first);
    free(D);
    shape_free(&b);
    shape_free(&s);
}

typedef void diag_asks(hd_heat *heat, double hh, int32_t n, double *D);

/* The same bits in all ways of threading: of what is asked of a plan for a bumpy sphere, `count` fields. */
static void diag_each_way(hd_laplacian_kind kind, int64_t count, diag_asks *ask) {
    shape s = shape_bumpy(4, 1);
    const size_t size = (size_t)(count * s.n);
    double *first = DENSE_NEW(double, (int64_t)size), *D = DENSE_NEW(double, (int64_t)size);
    int way;
    for (way = 0; way < LDL_WAYS; way++) {
        ldl_way *w = DENSE_NEW(ldl_way, 1);
        hd_laplacian_opts lo;
        hd_laplacian *lap = NULL;
        hd_heat *heat;
        ldl_way_begin(w, way, HD_SIMD_AUTO);
        memset(&lo, 0, sizeof lo);
        lo.context = &w->ctx;
        lo.kind = kind;
        CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) == HD_OK);
        heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        ask(heat, lap->h * lap->h, s.n, D);
        if (way == 0) memcpy(first, D, size * sizeof *D);
        CHECK_MSG(memcmp(first, D, size * sizeof *D) == 0, "way %d of threading gives other bits", way);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        ldl_way_end(w, way);
        free(w);
    }
    free(first);
    free(D);
    shape_free(&s);
}

static void diag_ask_all(hd_heat *heat, double hh, int32_t n, double *D) {
    const int32_t sources[3] = {7, 2000, 300};
    const double t = 30 * hh;
    int32_t sample[5];
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, NULL) >= 0);
    CHECK(heat_distance(heat, HD_DISTANCE_WEIGHTED, 1, &t, 3, sources, D + n, 0, NULL) >= 0);
    CHECK(heat_distance(heat, HD_DISTANCE_BIHARMONIC, 1, NULL, 3, sources, D + 4 * n, 0, NULL) >= 0);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 5, 0, sample, D + 7 * n, NULL) >= 0);
}

static void diag_threads(void) { diag_each_way(HD_LAPLACIAN_VORONOI_COT, 8, diag_ask_all); }

/* Where all distances are lost the farthest points are still different ones; given ones may be without mass. */
static void diag_samples_lost(void) {
    shape b = shape_icosphere(1), s = eng_with_inert(&b);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
    int32_t v[42] = {0}, q, k;
    double d[42];
    CHECK(lap->row[0] < 0);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, 1e6, 42, 0, v, d, NULL) >= 0);
    for (q = 0; q < 42; q++) {
        CHECK(lap->row[v[q]] >= 0 && d[q] >= 0);
        for (k = 0; k < q; k++) CHECK_MSG(v[k] != v[q], "points %d and %d are both %d", (int)k, (int)q, (int)v[q]);
    }
    v[0] = 0;
    v[1] = 5;                                    /* both without mass, f = 0: at no distance of each other */
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, 0.1, 4, 2, v, d, NULL) >= 0);
    CHECK(lap->row[5] < 0 && d[1] == 0 && d[2] > 0 && d[3] > 0 && lap->row[v[2]] >= 0 && lap->row[v[3]] >= 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&b);
    shape_free(&s);
}

/* ---- what is refused, and what goes wrong on the way ---- */

static void diag_refused(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
    static const hd_method methods[2] = {HD_METHOD_ITERATIVE, HD_METHOD_KRYLOV};
    double D[200], E[400];
    const double t = 0.1, bad[5] = {0, -1, HUGE_VAL, NAN, -HUGE_VAL};
    const int32_t v = 3, out_of_range[2] = {-1, 42}, big = 42;
    int32_t sample[50] = {0};
    hd_report rep;
    int q, kind;
    for (q = 0; q < 2; q++) {
        hd_heat *other = eng_plan(lap, methods[q], HD_POLES_DEFAULT, 0);
        CHECK(heat_diagonal(other, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT && rep.status == HD_ERR_ARGUMENT && rep.error.status == HD_ERR_ARGUMENT);
        CHECK(heat_edges(other, t, E, &rep) == HD_ERR_ARGUMENT && rep.error.status == HD_ERR_ARGUMENT);
        for (kind = 0; kind < 4; kind++) {
            CHECK(heat_distance(other, (hd_distance_kind)kind, 1, &t, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT && rep.error.status == HD_ERR_ARGUMENT);
            CHECK(heat_sample(other, (hd_distance_kind)kind, t, 3, 0, sample, NULL, &rep) == HD_ERR_ARGUMENT && rep.error.status == HD_ERR_ARGUMENT);
            CHECK(heat_pairs(other, (hd_distance_kind)kind, t, 1, &v, &v, NULL, D, &rep) == (kind < 2 ? HD_OK : HD_ERR_ARGUMENT));
        }
        hd_heat_free(other);
    }
    for (q = 0; q < 5; q++) {
        CHECK(heat_diagonal(heat, 1, bad + q, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT);
        CHECK(heat_edges(heat, bad[q], E, &rep) == HD_ERR_ARGUMENT);
        CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, bad + q, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
        CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, bad[q], 2, 0, sample, NULL, &rep) == HD_ERR_ARGUMENT);
        if (q) CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, bad[q], 1, &v, &v, NULL, D, &rep) == HD_ERR_ARGUMENT);
    }
    for (q = 0; q < 2; q++) {
        CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, out_of_range + q, D, 0, &rep) == HD_ERR_INDEX && rep.error.column == 0 && rep.error.value == out_of_range[q]);
        CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, 1, out_of_range + q, &v, NULL, D, &rep) == HD_ERR_INDEX && rep.error.row == 0);
        CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, 1, &v, out_of_range + q, NULL, D, &rep) == HD_ERR_INDEX && rep.error.value == out_of_range[q]);
        sample[0] = out_of_range[q];
        CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 2, 1, sample, NULL, &rep) == HD_ERR_INDEX && rep.error.column == 0);
    }
    sample[0] = 0;
    CHECK(heat_diagonal(heat, -1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, NULL, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, NULL, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 41, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, &t, (hd_kernel)7, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(NULL, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_edges(heat, t, NULL, &rep) == HD_ERR_ARGUMENT && heat_edges(NULL, t, E, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(NULL, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, (hd_distance_kind)4, 1, &t, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, (hd_distance_kind)-1, 1, &t, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, -1, &t, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, NULL, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, -1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, NULL, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, NULL, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, D, 41, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_COMMUTE, 2, NULL, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT && rep.error.value == 2);
    CHECK(heat_distance(heat, HD_DISTANCE_BIHARMONIC, 3, NULL, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_BIHARMONIC, 0, NULL, 1, &v, NULL, 0, &rep) == HD_ERR_ARGUMENT);
    D[1] = -5;
    CHECK(heat_distance(heat, HD_DISTANCE_BIHARMONIC, 0, NULL, 1, &v, D, 0, &rep) == HD_OK && D[1] > 0);    /* it has no time */
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 0, NULL, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 0, NULL, NULL, 0, &rep) == HD_OK);
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, -1, &v, &v, NULL, D, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, 1, NULL, &v, NULL, D, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_pairs(heat, (hd_distance_kind)9, t, 1, &v, &v, NULL, D, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_pairs(NULL, HD_DISTANCE_CLASSICAL, t, 1, &v, &v, NULL, D, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 0, 0, sample, NULL, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, big + 1, 0, sample, NULL, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 2, 3, sample, NULL, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 2, -1, sample, NULL, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 2, 0, NULL, NULL, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(NULL, HD_DISTANCE_CLASSICAL, t, 2, 0, sample, NULL, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, big, 0, sample, NULL, &rep) >= 0);   /* all of them, each once */
    for (q = 0; q < big; q++)
        for (kind = 0; kind < q; kind++) CHECK(sample[q] != sample[kind]);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* variant % 8: what; / 8: of the two masses. */
static hd_status diag_job(hd_context *ctx, int variant) {
    hd_laplacian *lap;
    hd_heat *heat = rob_mark_heat;
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_report rep;
    const int32_t i[3] = {0, 5, 13}, j[3] = {7, 5, 20};
    int32_t v[3];
    double D[21 * 6], E[300];
    hd_error e;
    hd_status st = rob_laplacian_of(ctx, variant / 8 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, &lap);
    if (st < 0) return st;
    o.poles = HD_POLES_DIAGONAL;
    o.degree = 9;
    st = hd_heat_create(&heat, lap, &o, &e);
    if (st >= 0) {
        const double t[2] = {lap->h * lap->h, 4 * lap->h * lap->h};
        const hd_distance_kind kind = (hd_distance_kind)(variant % 8 - 2);
        memset(&rep, 0, sizeof rep);
        if (variant % 8 == 0) st = heat_diagonal(heat, 2, t, HD_KERNEL_SYMMETRIC, D, 0, &rep);
        if (variant % 8 == 1) st = heat_edges(heat, t[0], E, &rep);
        if (variant % 8 >= 2 && variant % 8 < 6) st = heat_distance(heat, kind, kind < 2 ? 2 : 1, t, 3, i, D, 0, &rep);
        if (variant % 8 == 6) st = heat_pairs(heat, HD_DISTANCE_BIHARMONIC, t[0], 3, i, j, E, D, &rep);
        if (variant % 8 == 7) st = heat_sample(heat, HD_DISTANCE_CLASSICAL, t[0], 3, 0, v, NULL, &rep);
        CHECK_MSG(rep.status == st && (st >= 0 || rep.error.status == st), "variant %d: status %d, report %d, error %d", variant, (int)st, (int)rep.status, (int)rep.error.status);
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    return st;
}

static hd_status diag_job_more(hd_context *ctx, int variant) {
    hd_laplacian *lap;
    hd_heat *heat = rob_mark_heat;
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_report rep;
    const int32_t i[3] = {0, 5, 13}, j[3] = {7, 5, 20};
    double D[21 * 6], K[3];
    hd_error e;
    hd_status st = rob_laplacian_of(ctx, HD_LAPLACIAN_FEM, &lap);
    if (st < 0) return st;
    o.poles = HD_POLES_KERNEL;
    o.degree = 8;
    o.method = variant < 2 ? HD_METHOD_DIRECT : HD_METHOD_AUTO;
    st = hd_heat_create(&heat, lap, &o, &e);
    if (st >= 0) {
        const double t = lap->h * lap->h;
        memset(&rep, 0, sizeof rep);
        if (variant < 2) st = heat_pairs(heat, (hd_distance_kind)variant, t, 3, i, j, K, D, &rep);
        if (variant == 2) st = heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, D, 0, &rep);
        CHECK(rep.status == st && (st >= 0 || rep.error.status == st));
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    return st;
}

static void diag_robust(void) {
    int variant;
    for (variant = 0; variant < 19; variant++) {
        rob_job job;
        job.what = variant < 16 ? "diagonal and distances" : "pairs, operator";
        job.run = variant < 16 ? diag_job : diag_job_more;
        job.variant = variant < 16 ? variant : variant - 16;
        diag_robust_jobs(&job);
    }
}

/* By default a second, better pass may be wanted; when it does not fit, the first answer stands, and all is freed. */
static void diag_limits_by_default(void) {
    shape s = shape_grid(9, 7, 0.3);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    double *D = DENSE_NEW(double, s.n);
    uint64_t limit, need, base;
    const int32_t source = 4;
    int32_t i;
    int kind;
    for (i = 0; i < 3 * s.n; i += 3)
        if (i / 3 % 9 == 4) s.xyz[i] = s.xyz[i - 3] + 0.00125;
    memset(&lo, 0, sizeof lo);
    lo.context = &ctx;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) == HD_OK);
    base = ctx.bytes_in_use;
    for (kind = -1; kind < 4; kind++) {
        int fine = 0, refused = 0;
        for (limit = 0, need = 0; limit <= need + need / 20; limit += need / (kind == 0 || kind == 1 ? 400 : 50)) {
            hd_heat *heat = NULL;
            hd_report rep;
            hd_status st;
            const double t = 3 * lap->h * lap->h;
            memset(&rep, 0, sizeof rep);
            ctx.byte_limit = limit ? base + limit : 0;
            ctx.bytes_peak = ctx.bytes_in_use;
            st = hd_heat_create(&heat, lap, NULL, &rep.error);
            if (st >= 0 && kind < 0) st = heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep);
            else if (st >= 0) st = heat_distance(heat, (hd_distance_kind)kind, 1, &t, 1, &source, D, 0, &rep);
            CHECK_MSG(st >= 0 ? rep.error.status == HD_OK : st == HD_ERR_MEMORY_LIMIT && rep.error.status == st, "kind %d: status %d, %d", kind, (int)st, (int)rep.error.status);
            fine += st >= 0;
            refused += st < 0;
            if (limit == 0) need = ctx.bytes_peak - base;
            hd_heat_free(heat);
            CHECK(ctx.bytes_in_use == base);
            for (i = 0; st >= 0 && i < s.n; i++) CHECK(D[i] >= 0 && D[i] < 1e9);
        }
        CHECK_MSG(fine > 1 && refused > 10, "kind %d: %d fine, %d refused, %g bytes", kind, fine, refused, (double)need);
    }
    ctx.byte_limit = 0;
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, "limits by default");
    free(D);
    shape_free(&s);
}

/* Cells of very unlike size: diagonals and edges take the highest degree, and at the same degree rounding shows in edges as it does in diagonals. */
static void diag_graded(void) {
    shape s = shape_grid(14, 11, 0.2);
    int32_t i;
    int kind;
    for (i = 0; i < 3 * s.n; i++) s.xyz[i] *= s.xyz[i] * s.xyz[i] * s.xyz[i] + 0.001;
    for (kind = 0; kind < 2; kind++) {
        hd_laplacian *lap = test_laplacian(&s, kind ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        double *D = DENSE_NEW(double, lap->L.nnz);
        const double t = 0.3 * lap->h * lap->h;
        hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        hd_report one, all;
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &one) == HD_OK && one.degree == 14 && one.error_rational < 1e-9);
        CHECK(heat_edges(heat, t, D, &all) == HD_OK && all.degree == 14 && all.error_rational < 1e-9);
        hd_heat_free(heat);
        heat = eng_plan(lap, HD_METHOD_DIRECT, HD_POLES_UNIFORM, 9);
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &one) >= 0 && heat_edges(heat, t, D, &all) >= 0);
        CHECK_MSG(all.error_rounding <= 5 * one.error_rounding && one.error_rounding > 0, "kind %d: rounding %g of edges, %g of the diagonal", kind, all.error_rounding, one.error_rounding);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        free(D);
    }
    shape_free(&s);
}

/* With a full B the diagonal of K_t may be smaller than what the constants are of it. That is no sign of rounding. */
static void diag_below_constants(void) {
    shape s = shape_grid(2, 3, 0);
    hd_laplacian *lap;
    hd_heat *heat;
    double D[6], least = 1;
    int32_t q, i;
    for (i = 0; i < s.n; i++) {                  /* uneven cells, and not flat */
        s.xyz[3 * i] = i % 2 + 0.2 * sin(7.1 * i);
        s.xyz[3 * i + 1] = 1.3 * (i / 2) + 0.2 * cos(3.3 * i);
        s.xyz[3 * i + 2] = 0.3 * sin(0.5 * (i % 2));
    }
    for (i = 0; i < s.n_tri; i += 2) {           /* diagonals that run the other way */
        const int32_t v = i;
        s.tri[3 * i] = v, s.tri[3 * i + 1] = v + 1, s.tri[3 * i + 2] = v + 2;
        s.tri[3 * i + 3] = v + 1, s.tri[3 * i + 4] = v + 3, s.tri[3 * i + 5] = v + 2;
    }
    lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    for (q = 0; q < 30; q++) {
        const double t = 0.05 * lap->h * lap->h * pow(1.2, q);
        hd_report r;
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, D, 0, &r) == HD_OK);
        CHECK_MSG(r.error_bound < 1e-6, "t = %g: bound %g", t, r.error_bound);
        for (i = 0; i < lap->n_active; i++) least = fmin(least, D[lap->vertex[i]] * lap->component_mass[0] / lap->mass[i]);
    }
    CHECK_MSG(least < 0.998, "at least %g times the constants", least);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* A path with L and B in other units: distances without a time, and their bounds, change by powers of two only. */
static void diag_units(void) {
    static const int units[][2] = {{0, 0}, {500, -300}, {500, -600}, {60, -950}, {40, -950}, {-500, 600}, {-100, 940}};
    double want[2][6], bound[2] = {0, 0};
    const int32_t n = 6;
    int32_t q, i, a;
    int64_t p;
    double b[6];
    for (q = 0; q < 7; q++) {
        const int32_t source = 1;
        hd_csr L = test_path_csr(n, 0), B;
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        for (p = 0; p < L.nnz; p++) L.val[p] = ldexp(L.val[p], units[q][0]);
        for (i = 0; i < n; i++) b[i] = ldexp(1 + i % 3, units[q][1]);
        B = test_diagonal_csr(n, b);
        CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK && hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
        for (a = 0; a < 2; a++) {
            const int power = a ? units[q][0] - units[q][1] / 2 : units[q][0] / 2;
            double d[6];
            hd_report r;
            CHECK(heat_distance(heat, a ? HD_DISTANCE_BIHARMONIC : HD_DISTANCE_COMMUTE, 0, NULL, 1, &source, d, 0, &r) == HD_OK);
            for (i = 0; i < n; i++) {
                if (q == 0) want[a][i] = d[i];
                CHECK_MSG(ldexp(d[i], power) == want[a][i], "units 2^%d, 2^%d: %g, want %g", units[q][0], units[q][1], d[i], want[a][i]);
            }
            if (q == 0) bound[a] = r.error_bound;
            CHECK(r.error_bound > 0 && r.error_bound < 1e-10 && fabs(r.error_bound - bound[a]) <= 1e-6 * bound[a]);
        }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        hd_csr_free(&L, NULL);
        hd_csr_free(&B, NULL);
    }
}

static void test_diagonal(void) {
    diag_graded();
    diag_inverse_shapes();
    diag_inverse_levels();
    diag_inverse_no_diagonal();
    diag_inverse_threads();
    diag_inverse_robust();
    diag_inverse_survives();
    diag_dense_cases();
    diag_times();
    diag_sphere();
    diag_distances();
    diag_resistances();
    diag_lost();
    diag_pairs();
    diag_metric_laws();
    diag_pairs_method();
    diag_refused();
    diag_robust();
    diag_limits_by_default();
    diag_sets();
    diag_own_sets();
    diag_own_matrices();
    diag_orders();
    diag_threads();
    diag_samples_lost();
    diag_below_constants();
    diag_units();
}

#endif
