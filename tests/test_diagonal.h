/* test_diagonal.h - selected inversion, and what is made of it: diagonals, edges, distances, pairs, samples; against dense inverses, dense
 * eigensolutions, closed forms and brute force */

#ifndef TEST_DIAGONAL_H
#define TEST_DIAGONAL_H

/* ---- entries of the inverse ---- */

/* A^-1 [n n] by Gauss, Jordan with partial pivoting. */
static dense_c64 *diag_dense_inverse(const hd_csr *a, const hd_c64 *val) {
    const int32_t n = a->n_rows;
    const size_t ld = 2 * (size_t)n;
    dense_c64 *m = KIT_NEW(dense_c64, (int64_t)n * (int64_t)ld), *z = DENSE_NEW(dense_c64, (int64_t)n * n), keep;
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
            if (hypot(m[(size_t)i * ld + (size_t)k].re, m[(size_t)i * ld + (size_t)k].im) > hypot(m[(size_t)best * ld + (size_t)k].re,
                m[(size_t)best * ld + (size_t)k].im)) best = i;
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

/* A Z = 1, and Z against the dense inverse if asked. */
static void diag_check(const hd_csr *a, const hd_c64 *val, const hd_c64 *values, const hd_c64 *diag, int dense, const char *what) {
    const double off = diag_off_identity(a, val, values, diag), far = dense ? diag_off_dense(a, val, values, diag) : 0;
    CHECK_MSG(off <= 1e-13 && far <= 1e-10, "%s, n %d: A Z is off by %g, Z by %g", what, (int)a->n_rows, off, far);
}

/* k complex matrices, then a real one: values and diagonal together and each alone. Patterns with all diagonal entries. */
static void diag_inverse_of(const hd_csr *a, hd_ldl *f, int32_t k, int steep, int dense, uint64_t seed, const char *what) {
    const int32_t n = a->n_rows, mark = kit_mark();
    const int64_t nnz = a->nnz;
    double *L = KIT_NEW(double, nnz), *B = KIT_NEW(double, nnz), *v = KIT_NEW(double, nnz), *d = KIT_NEW(double, n);
    hd_c64 *val = KIT_NEW(hd_c64, k * nnz), *values = KIT_NEW(hd_c64, k * nnz), *diag = KIT_NEW(hd_c64, (int64_t)k * n);
    hd_c64 *alone = KIT_NEW(hd_c64, k * nnz), *diag_alone = KIT_NEW(hd_c64, (int64_t)k * n);
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
    for (q = 0; q < k; q++) diag_check(a, val + q * nnz, values + q * nnz, diag + q * n, dense, what);
    for (p = 0; p < nnz; p++) L[p] = 7 * L[p] + B[p];
    CHECK_MSG(hd_ldl_factor(f, L, NULL, &e) == HD_OK && hd_ldl_inverse(f, v, d, &e) == HD_OK && e.status == HD_OK, "%s: %s", what,
              e.text);
    diag_complex_of(L, val, nnz);
    diag_complex_of(v, values, nnz);
    diag_complex_of(d, diag, n);
    diag_check(a, val, values, diag, dense, what);
    CHECK(hd_ldl_inverse(f, B, NULL, NULL) == HD_OK && hd_ldl_inverse(f, NULL, d, NULL) == HD_OK &&
          hd_ldl_inverse(f, NULL, NULL, NULL) == HD_OK);
    CHECK_MSG(nnz == 0 || memcmp(B, v, (size_t)nnz * sizeof *v) == 0, "%s: real values alone are others", what);
    for (q = 0; q < n; q++) CHECK_MSG(d[q] == diag[q].re, "%s: real, the diagonal alone is another", what);
    kit_release(mark);
}

/* All shapes, all orderings, one to nine matrices; every object twice. */
static void diag_inverse_shapes(void) {
    static const int32_t sizes[6] = {0, 1, 2, 5, 23, 60};
    int kind, z;
    for (kind = 0; kind < LDL_SHAPES; kind++) {
        for (z = 0; z < 6; z++) {
            hd_csr a = kit_own_csr(ldl_shape(kind, sizes[z], 1, (uint64_t)(kind + 1)));
            const hd_ldl_opts o = ldl_opts_of(HD_ORDERING_MINIMUM_DEGREE, NULL, NULL, NULL);
            hd_ldl *f = ldl_make(&a, kind % 2 ? &o : NULL, ldl_shape_name(kind));
            diag_inverse_of(&a, f, 1 + (kind + z) % 9, z % 2, 1, (uint64_t)(7 * kind + z), ldl_shape_name(kind));
            if (z == 4) diag_inverse_of(&a, f, 1 + (kind + z + 3) % 9, 1, 1, (uint64_t)(11 * kind + z), ldl_shape_name(kind));
            hd_ldl_free(f);
        }
    }
}

/* At every level of instructions: random patterns, mesh-like ones, and fronts of all numbers of pivots and rows. */
static void diag_inverse_levels(void) {
    static const int kinds[6] = {LDL_RANDOM, LDL_GRID, LDL_DENSE, LDL_BAND, LDL_BIPARTITE, LDL_DENSE};
    static const int32_t sizes[6] = {90, 400, 75, 120, 90, 141};
    const int32_t mark = kit_mark();
    int level, q, way;
    int32_t i;
    for (level = 0; level < 4; level++) {
        hd_context ctx;
        memset(&ctx, 0, sizeof ctx);
        ctx.simd = ldl_simds[level];
        for (q = 0; q < 6 + LDL_JOINTS; q++) {
            const hd_csr *a = kit_csr(q < 6 ? ldl_shape(kinds[q], sizes[q], 1, (uint64_t)(q + 50)) : ldl_joined(q - 6));
            int32_t *natural = KIT_NEW(int32_t, a->n_rows);
            for (i = 0; i < a->n_rows; i++) natural[i] = i;
            for (way = 0; way < 2; way++) {
                const hd_ldl_opts o = ldl_opts_of(way ? HD_ORDERING_OWN : HD_ORDERING_AUTO, natural, NULL, &ctx);
                hd_ldl *f = ldl_make(a, &o, "levels");
                diag_inverse_of(a, f, 3 + way, q % 2, a->n_rows < 100 || (way == 0 && a->n_rows < 150), (uint64_t)q, "levels");
                hd_ldl_free(f);
            }
            kit_release(mark);
        }
        CHECK(ctx.bytes_in_use == 0);
    }
}

/* Where the pattern has no diagonal, diag has it all the same: zeros there but for one end of a path, which is eliminated first. */
static void diag_inverse_no_diagonal(void) {
    enum { N = 24 };
    int32_t ci[8 * N], cj[8 * N], perm[N], i, k, q;
    const hd_ldl_opts o = ldl_opts_of(HD_ORDERING_OWN, perm, NULL, NULL);
    hd_csr a;
    hd_ldl *f = NULL;
    double *v, *dv, d[N];
    hd_c64 *val, *values, diag[2 * N];
    hd_error e;
    int64_t p, count = 1;
    ci[0] = cj[0] = 0;
    for (i = 0; i < N; i++) {
        perm[i] = i;
        for (k = 1; k <= 5; k += 4) {            /* the next, and of each fifth the fifth */
            if (i + k >= N || (k == 5 && i % 5)) continue;
            ci[count] = cj[count + 1] = i;
            cj[count] = ci[count + 1] = i + k;
            count += 2;
        }
    }
    CHECK(hd_csr_from_triplets(&a, N, N, count, ci, cj, NULL, NULL, NULL) == HD_OK);
    v = KIT_NEW(double, a.nnz);
    dv = KIT_NEW(double, a.nnz);
    val = KIT_NEW(hd_c64, 2 * a.nnz);
    values = KIT_NEW(hd_c64, 2 * a.nnz);
    for (i = 0; i < N; i++)
        for (p = a.row_ptr[i]; p < a.row_ptr[i + 1]; p++) {
            v[p] = a.col[p] == i ? 2 : 0.7 + ldl_chance(i, a.col[p], 3);
            val[p] = test_c(0.3 * v[p], 0.9 * v[p]);
            val[a.nnz + p] = test_c(v[p], -2 * v[p]);
        }
    CHECK_MSG(hd_ldl_analyse(&f, &a, &o, NULL, &e) == HD_OK, "%s", e.text);
    for (k = 0; k < 2; k++) {                    /* values and diagonal; the diagonal alone */
        CHECK_MSG(hd_ldl_factor_complex(f, 2, val, NULL, &e) == HD_OK && hd_ldl_inverse_complex(f, k ? NULL : values, diag,
            &e) == HD_OK, "%s", e.text);
        for (q = 0; q < 2; q++) CHECK_MSG(diag_off_dense(&a, val + q * a.nnz, values + q * a.nnz, diag + q * N) <= 1e-11, "matrix %d",
                                          (int)q);
    }
    CHECK_MSG(hd_ldl_factor(f, v, NULL, &e) == HD_OK, "%s", e.text);
    for (k = 0; k < 2; k++) {
        CHECK_MSG(hd_ldl_inverse(f, k ? NULL : dv, d, &e) == HD_OK, "%s", e.text);
        diag_complex_of(v, val, a.nnz);
        diag_complex_of(dv, values, a.nnz);
        diag_complex_of(d, diag, N);
        CHECK_MSG(diag_off_dense(&a, val, values, diag) <= 1e-11, "real, %d", (int)k);
    }
    hd_ldl_free(f);
    hd_csr_free(&a, NULL);
}

/* All ways of threading give the same bits; with large fronts too, that all threads share. */
static void diag_inverse_threads_of(const hd_csr *a, const double *xyz, int32_t k, const char *what) {
    const int32_t n = a->n_rows;
    const size_t size = (size_t)k * (size_t)a->nnz;
    double *L = KIT_NEW(double, a->nnz), *B = KIT_NEW(double, a->nnz), *v = KIT_NEW(double, a->nnz), *first_v = KIT_NEW(double, a->nnz);
    hd_c64 *val = KIT_NEW(hd_c64, size), *z = KIT_NEW(hd_c64, size), *first = KIT_NEW(hd_c64, size),
        *diag = KIT_NEW(hd_c64, k * (int64_t)n);
    int64_t p, calls = 0;
    int32_t q;
    int way, level;
    ldl_pair(a, 3, L, B);
    ldl_shifted(a, L, B, k, 4, val);
    for (p = 0; p < a->nnz; p++) L[p] = 10 * L[p] + B[p];
    for (level = 0; level < 2; level++) {
        for (way = 0; way < LDL_WAYS; way += level ? 6 : 1) {
            ldl_way w;
            hd_ldl_opts o;
            hd_ldl *f;
            int64_t before;
            ldl_way_begin(&w, way, ldl_simds[level]);
            o = ldl_opts_of(HD_ORDERING_AUTO, NULL, xyz, &w.ctx);
            f = ldl_make(a, &o, what);
            CHECK(hd_ldl_factor_complex(f, k, val, NULL, NULL) == HD_OK);
            before = w.calls;
            CHECK(hd_ldl_inverse_complex(f, way ? z : first, diag, NULL) == HD_OK);
            calls += w.calls - before;
            CHECK(hd_ldl_factor(f, L, NULL, NULL) == HD_OK && hd_ldl_inverse(f, way ? v : first_v, NULL, NULL) == HD_OK);
            hd_ldl_free(f);
            ldl_way_end(&w, way);
            if (way) CHECK_MSG(memcmp(z, first, size * sizeof *z) == 0 && memcmp(v, first_v, (size_t)a->nnz * sizeof *v) == 0,
                               "%s: way %d of threading gives other bits, level %d", what, way, level);
            for (q = 0; q < k && !way; q++) diag_check(a, val + q * a->nnz, first + q * a->nnz, diag + q * n, 0, what);
        }
    }
    CHECK_MSG(calls > 0, "%s: never in parallel", what);
}

static void diag_inverse_threads(void) {
    const shape *ball = kit_shape("bumpy/4/3");
    const hd_csr *a = kit_csr(ldl_mesh_pattern(ball));
    ldl_edges g = ldl_edges_of(900);
    int32_t i;
    diag_inverse_threads_of(a, ball->xyz, 5, "mesh");
    diag_inverse_threads_of(kit_csr(ldl_shape(LDL_DENSE, 420, 1, 1)), NULL, 2, "dense");
    ldl_clique(&g, 0, 220);                      /* many small fronts below one that is shared */
    for (i = 220; i < 900; i++) {
        ldl_join(&g, i, (i * 7) % 220);
        ldl_join(&g, i, (i * 13 + 5) % 220);
        if (i % 3) ldl_join(&g, i, i - 1);
    }
    diag_inverse_threads_of(kit_csr(ldl_pattern(&g, 1)), NULL, 4, "clique with tails");
}

/* Without a factorisation of its kind, and after one that failed, there is no inverse. (What memory and cancelling do: failures.) */
static void diag_inverse_of_nothing(void) {
    enum { N = 60 };
    const hd_csr *a = kit_csr(ldl_shape(LDL_GRID, N, 1, 1));
    hd_ldl *f = ldl_make(a, NULL, "nothing");
    double *L = KIT_NEW(double, a->nnz), *B = KIT_NEW(double, a->nnz);
    hd_error e;
    int64_t k;
    ldl_pair(a, 1, L, B);
    for (k = 0; k < a->nnz; k++) L[k] += B[k];
    CHECK(hd_ldl_inverse(f, B, NULL, &e) == HD_ERR_ARGUMENT && hd_ldl_inverse_complex(f, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_ldl_inverse(NULL, B, NULL, &e) == HD_ERR_ARGUMENT && hd_ldl_inverse_complex(NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_ldl_factor(f, L, NULL, NULL) == HD_OK && hd_ldl_inverse(f, B, NULL, &e) == HD_OK);
    CHECK(hd_ldl_inverse_complex(f, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT);
    L[a->row_ptr[N - 1]] = L[a->nnz - 1] = NAN;
    CHECK(hd_ldl_factor(f, L, NULL, NULL) < 0 && hd_ldl_inverse(f, B, NULL, &e) == HD_ERR_ARGUMENT);
    hd_ldl_free(f);
}

/* ---- dense kernels and distances: for other groups ---- */

/* ---- against the truth ---- */

#define DIAG_PAIRS "shape=bumpy/1/5|tangle op=fem|vor|cot query="
static const case_row diag_rows[] = {
    /* diagonals of both kernels and edges: on a bumpy sphere; a hole, pieces, three sheets at an edge and vertices in no face; slivers */
    {"shape=bumpy/1/5|tangle|sliver/2/3/3 op=fem|vor|cot query=diagonal kernel=operator|symmetric th=0.5|3|30|300|3000|1e4", 1e-6, 0, 0},
    {"shape=bumpy/1/5|tangle|sliver/2/3/3 op=fem|vor|cot query=diagonal kernel=symmetric|operator poles=kernel degree=14 "
     "th=0.5|3|30|300|3000|1e4", 3e-7, 0, 0},
    {"shape=bumpy/1/5|tangle|sliver/2/3/3 op=fem|vor query=diagonal kernel=operator|symmetric poles=kernel|uniform degree=10 th=0.5|30|3000",
     1e-2, 0, 0},
    {"shape=bumpy/1/5|tangle op=fem|vor query=diagonal kernel=operator|symmetric poles=kernel|uniform degree=4 th=0.5|30|3000", 0, 0, 21},
    {"shape=soup/12/3 op=fem query=diagonal kernel=operator|symmetric th=0.5|3|30|300", 1e-6, 0, 0},
    {"shape=leak/30/0.01|drain/30/0.5|tree/30/3 op=I|diag|tri query=diagonal kernel=operator|symmetric th=0.5|3|10", 1e-5, 0, 0},
    {DIAG_PAIRS "diagonal kernel=operator|symmetric times=5 span=1000 th=1 seed=0|1", 1e-6, 0, 0},
    /* filters of the caller's own, with a bit of the identity, too: on the diagonal of the symmetric kernel that needs a diagonal B */
    {"shape=flat/8/5/0.3 op=fem|vor|cot query=diagonal kernel=operator own=resolvent|a0|random seed=2 th=2|10", 1e-9, 0, 0},
    {"shape=flat/8/5/0.3 op=vor|cot query=diagonal kernel=symmetric own=resolvent|a0|random seed=2 th=2|10", 1e-9, 0, 0},
    {"shape=flat/8/5/0.3 op=fem query=diagonal kernel=symmetric own=resolvent|a0 th=2", 1e-9, 0, 2},
    /* distances (without a bound of each where the source has no mass), and pairs, of which a few may be near each other */
    {DIAG_PAIRS "distance kind=classical|weighted|commute|biharmonic k=4 th=0.7|5|40", 1e-6, 0, 4},
    {DIAG_PAIRS "distance kind=classical|weighted k=4 times=3 span=50 th=0.7 seed=0|1", 1e-6, 0, 4},
    {DIAG_PAIRS "distance kind=classical|weighted k=4 poles=kernel degree=14 th=0.7|2", 1e-5, 0, 0},
    {DIAG_PAIRS "distance kind=classical|weighted k=4 poles=uniform|kernel degree=8 th=0.7|2|40", 0, 0, 19},
    {DIAG_PAIRS "pairs kind=classical|weighted|commute|biharmonic k=40 method=auto|direct th=0.7|4|40 seed=1|2",
     3e-6, 0, 8},
    {DIAG_PAIRS "pairs kind=classical|weighted k=40 method=iterative|krylov th=0.7|4 seed=1|2", 2e-6, 0, 0},
    {"shape=leak/30/0.01|drain/30/0.5 op=I|tri query=distance|pairs kind=classical|weighted|commute|biharmonic k=4 th=0.7|2", 2e-5, 0, 0},
};

/* What sums over entries of inverses, at every level of instructions: with a full B too, several times and columns together. */
static const case_row diag_level_rows[] = {
    {"shape=bumpy/1/5|grid/9/2 op=fem|vor query=diagonal kernel=operator|symmetric method=direct th=0.7|10", 1e-6, 0, 0},
    {"shape=bumpy/1/5|grid/9/2 op=fem|vor query=distance kind=classical|weighted method=direct k=9 times=1|3 span=50 th=0.7|10", 1e-6, 0, 0},
    {"shape=bumpy/1/5|grid/9/2 op=fem|vor query=distance kind=classical|weighted k=9 poles=kernel degree=14 th=0.7|2", 1e-5, 0, 0},
    {"shape=bumpy/1/5|grid/9/2 op=fem|vor query=apply|column|entries method=direct k=9 th=0.7|10", 2e-6, 0, 0},
};

static void diag_cases(void) {
    int level;
    CASES(diag_rows);
    for (level = 1; level < 4; level++) {
        trial_serial.simd = ldl_simds[level];
        CASES(diag_level_rows);
    }
    trial_serial.simd = HD_SIMD_AUTO;
}

/* The set that was asked for, the smallest value, parts of the bounds; and the same numbers in edges as in the diagonal. */
static void diag_reports(void) {
    static const char *const pairs[3] = {"bumpy/2/5 fem", "tangle vor", "leak/30/0.01 diag"};
    static const struct { const char *words; int32_t degree; } plans[4] = {
        {"", 0}, {"poles=kernel degree=14", 14}, {"poles=kernel degree=9", 9}, {"poles=uniform degree=10", 10}};
    int q, k;
    for (q = 0; q < 12; q++) {
        const hd_laplacian *lap = kit_pair(pairs[q / 4]);
        hd_heat *heat = kit_heat(lap, plans[q % 4].words);
        double *D = KIT_NEW(double, lap->n);
        const int32_t degree = plans[q % 4].degree;
        for (k = 0; k < 3; k++) {
            const double t = pow(10, k) * trial_unit(lap);
            double least = HUGE_VAL;
            hd_report rep;
            int32_t i;
            CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) >= 0);
            for (i = 0; i < lap->n_active; i++) least = fmin(least, fabs(D[lap->vertex[i]]));
            CHECK_MSG(rep.smallest == least && rep.error_bound >= rep.error_rational && rep.method == HD_METHOD_DIRECT, "%s: report",
                      pairs[q / 4]);
            CHECK_MSG(degree == 0 || rep.degree == degree, "%s: degree %d", plans[q % 4].words, (int)rep.degree);
        }
    }
}

/* Several times in one call, by shared poles, agree with each by itself within both bounds; columns apart; t rising, k_t(x,x) falling. */
static void diag_times(void) {
    static const int order[5] = {1, 2, 0, 3, 4};
    const hd_laplacian *lap = kit_pair("bumpy/2/8 vor");
    hd_heat *heat = kit_heat(lap, "");
    const int32_t n = lap->n, ldd = n + 3;
    const double hh = lap->h * lap->h, t[5] = {20 * hh, hh, 3 * hh, 200 * hh, 1000 * hh};
    double *D = KIT_NEW(double, 5 * ldd), *one = KIT_NEW(double, n);
    hd_report rep, single;
    int32_t i;
    int q;
    for (i = 0; i < 5 * ldd; i++) D[i] = -7;
    CHECK(heat_diagonal(heat, 5, t, HD_KERNEL_SYMMETRIC, D, (size_t)ldd, &rep) == HD_OK);
    for (q = 0; q < 5; q++) {
        const double *d = D + q * ldd;
        CHECK(heat_diagonal(heat, 1, t + q, HD_KERNEL_SYMMETRIC, one, 0, &single) == HD_OK);
        for (i = 0; i < n; i++)
            CHECK_MSG(fabs(one[i] - d[i]) <= fmin(single.error_relative + rep.error_relative, 2e-7) * one[i],
                      "t %g, vertex %d: %.12g, alone %.12g", t[q],
                      (int)i, d[i], one[i]);
        for (i = 0; i < n && q; i++)
            CHECK_MSG(D[order[q] * ldd + i] <= D[order[q - 1] * ldd + i] * (1 + 1e-8), "t %g, vertex %d: it grows", t[order[q]],
                      (int)i);
        for (i = n; i < ldd; i++) CHECK(d[i] == -7);
    }
}

/* ---- distances in closed form, and their laws ---- */

/* Effective resistances: |i - j| on a path, k (n - k)/n on a cycle, 2/n in a complete graph. */
static void diag_resistances(void) {
    enum { N = 30, EDGES = N * (N - 1) / 2 };
    const int32_t sources[2] = {4, 29};
    int32_t a[EDGES], b[EDGES], i, j, m = 0, v;
    const hd_laplacian *graphs[3];
    double D[2 * N];
    int q, s;
    for (i = 0; i < N; i++)
        for (j = 0; j < i; j++) {
            a[m] = i;
            b[m++] = j;
        }
    graphs[0] = kit_lattice(N, 1, 0, 1, 1);
    graphs[1] = kit_lattice(N, 1, 1, 1, 1);
    graphs[2] = kit_graph(N, m, a, b, NULL, NULL);
    for (q = 0; q < 3; q++) {
        CHECK(heat_distance(kit_heat(graphs[q], ""), HD_DISTANCE_COMMUTE, 1, NULL, 2, sources, D, 0, NULL) == HD_OK);
        for (s = 0; s < 2; s++)
            for (v = 0; v < N; v++) {
                const int32_t k = v > sources[s] ? v - sources[s] : sources[s] - v;
                const double want = k == 0 ? 0 : q == 0 ? k : q == 1 ? k * (double)(N - k) / N : 2.0 / N, d = D[s * N + v];
                CHECK_MSG(fabs(d * d - want) <= 1e-9 * want, "graph %d: resistance %.15g, not %.15g", q, d * d, want);
            }
    }
}

/* Columns of several sources and times, and where they stand; 0 at the source, infinite between components. */
static void diag_places(void) {
    const hd_laplacian *lap = kit_pair("tangle fem");
    hd_heat *heat = kit_heat(lap, "");
    const int32_t n = lap->n, ldd = n + 2, sources[4] = {0, 50, n - 1, 7};
    const double hh = lap->h * lap->h, times[3] = {40 * hh, 0.7 * hh, 5 * hh};
    double *D = KIT_NEW(double, 12 * ldd), *one = KIT_NEW(double, n);
    int kind, m, s;
    int32_t v, i;
    for (kind = 0; kind < 4; kind++) {
        const int n_times = kind < 2 ? 3 : 1;
        for (i = 0; i < 12 * ldd; i++) D[i] = -3;
        CHECK(heat_distance(heat, (hd_distance_kind)kind, n_times, kind < 2 ? times : NULL, 4, sources, D, (size_t)ldd, NULL) >= 0);
        for (m = 0; m < n_times * 4; m++) {
            const double *col = D + m * ldd;
            s = m / n_times;
            CHECK(heat_distance(heat, (hd_distance_kind)kind, 1, times + m % n_times, 1, sources + s, one, 0, NULL) >= 0);
            for (v = 0; v < n; v++) {
                const int32_t a = lap->row[v], b = lap->row[sources[s]];
                const int apart = v != sources[s] && kind > 1 && (a < 0 || b < 0 || lap->component[a] != lap->component[b]);
                CHECK(apart ? col[v] == HUGE_VAL : fabs(col[v] - one[v]) <= 1e-6 * dense_max_abs(one, n) &&
                      (col[v] == 0) <= (v == sources[s] || (a < 0 && b < 0)));
            }
            CHECK(col[sources[s]] == 0 && col[n] == -3 && col[n + 1] == -3);
        }
    }
}

/* At times when all has become equal: no NaN, losses counted; pairs still know. */
static void diag_lost(void) {
    static const char *const pairs[2] = {"bumpy/2/5 fem", "bumpy/2/5 vor"};
    const int32_t source = 3;
    int q;
    for (q = 0; q < 4; q++) {
        const hd_laplacian *lap = kit_pair(pairs[q / 2]);
        const double t = 1e6 * lap->h * lap->h;
        const int kind = q % 2;
        double *D = KIT_NEW(double, lap->n);
        hd_report rep;
        int32_t v;
        CHECK(heat_distance(kit_heat(lap, ""), (hd_distance_kind)kind, 1, &t, 1, &source, D, 0, &rep) >= 0);
        for (v = 0; v < lap->n; v++) CHECK_MSG(D[v] >= 0 && D[v] < 1e3, "%g", D[v]);
        CHECK_MSG((rep.n_lost > 0) == (kind == 0), "kind %d: %lld lost", kind, (long long)rep.n_lost);
        CHECK_MSG(rep.error_bound == rep.error_bound && rep.error_relative == rep.error_relative, "kind %d: NaN in the report", kind);
    }
}

/* Symmetry and the triangle inequality, at a time when little is left of distances. */
static void diag_metric_laws(void) {
    enum { TRIPLES = 60 };
    const hd_laplacian *lap = kit_pair("bumpy/2/2 fem");
    hd_heat *heat = kit_heat(lap, "");
    int32_t i[6 * TRIPLES], j[6 * TRIPLES], v[3];
    double d[6 * TRIPLES];
    uint64_t seed = 77;
    int kind, q, k;
    for (q = 0; q < TRIPLES; q++) {
        for (k = 0; k < 3; k++) v[k] = trial_below(&seed, lap->n);
        for (k = 0; k < 3; k++) {
            i[6 * q + k] = j[6 * q + 3 + k] = v[k];
            j[6 * q + k] = i[6 * q + 3 + k] = v[(k + 1) % 3];
        }
    }
    for (kind = 0; kind < 4; kind++) {
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, 500 * lap->h * lap->h, 6 * TRIPLES, i, j, d, NULL) >= 0);
        for (q = 0; q < TRIPLES; q++)
            for (k = 0; k < 3; k++) {
                const double *e = d + 6 * q;
                CHECK_MSG(fabs(e[k] - e[k + 3]) <= 1e-7 * e[k] && (e[k] > 0) == (i[6 * q + k] != j[6 * q + k]),
                          "kind %d: %.15g one way, %.15g the other", kind,
                          e[k], e[k + 3]);
                CHECK_MSG(e[k] <= (e[(k + 1) % 3] + e[(k + 2) % 3]) * (1 + 1e-7), "kind %d: %.15g > %.15g + %.15g", kind, e[k],
                          e[(k + 1) % 3], e[(k + 2) % 3]);
            }
    }
}

/* ---- pairs and samples ---- */

/* Entries without distances and distances without entries are the same; there are no entries of what has no time. */
static void diag_pairs_parts(void) {
    enum { PAIRS = 40 };
    const hd_laplacian *lap = kit_pair("tangle vor");
    hd_heat *heat = kit_heat(lap, "");
    const double t = 4 * lap->h * lap->h;
    int32_t i[PAIRS], j[PAIRS];
    double k[PAIRS], d[PAIRS], again[PAIRS];
    uint64_t seed = 5;
    hd_report r;
    int kind, q;
    for (q = 0; q < PAIRS; q++) {
        i[q] = trial_below(&seed, lap->n);
        j[q] = q % 10 == 3 ? i[q] : trial_below(&seed, lap->n);
    }
    for (kind = 0; kind < 4; kind++) {
        for (q = 0; q < PAIRS; q++) k[q] = d[q] = -5;
        CHECK(heat_entries(heat, t, HD_KERNEL_OPERATOR, PAIRS, i, j, k, NULL) >= 0);
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, t, PAIRS, i, j, d, NULL) >= 0);
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, t, PAIRS, i, j, again, &r) >= 0 && memcmp(again, d, sizeof d) == 0);
        CHECK_MSG(r.error_bound < 1e-5 && r.error_relative < 0.1, "kind %d: bounds %g, %g", kind, r.error_bound, r.error_relative);
        CHECK(heat_entries(heat, t, HD_KERNEL_OPERATOR, PAIRS, i, j, again, &r) >= 0 && r.error_relative == HUGE_VAL &&
              memcmp(again, k, sizeof k) == 0);
        for (q = 0; q < PAIRS; q++) {
            const int32_t a = lap->row[i[q]], b = lap->row[j[q]];
            const int apart = i[q] != j[q] && (a < 0 || b < 0 || lap->component[a] != lap->component[b]);
            CHECK((d[q] == HUGE_VAL) == (kind > 1 && apart) && (i[q] != j[q] || d[q] == 0));
            CHECK(!apart || k[q] == 0);
        }
    }
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, 0, NULL, NULL, NULL, NULL) == HD_OK);
}

/* Without a time the report of a pair is for that pair; that of all vertices is worse by the nearest of these. */
static void diag_pairs_errors(void) {
    const hd_laplacian *lap = kit_pair("torus/40/16 fem");
    hd_heat *heat = kit_heat(lap, "");
    double *d = KIT_NEW(double, lap->n), one;
    const int32_t from = 0;
    int32_t to = 0, v, kind;
    hd_report all, rep;
    for (kind = HD_DISTANCE_COMMUTE; kind <= HD_DISTANCE_BIHARMONIC; kind++) {
        CHECK(heat_distance(heat, (hd_distance_kind)kind, 0, NULL, 1, &from, d, 0, &all) >= 0);
        for (v = 0; v < lap->n; v++) to = d[v] > d[to] ? v : to;
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, 0, 1, &from, &to, &one, &rep) >= 0 && one == d[to]);
        CHECK_MSG(rep.error_relative > 0 && rep.error_relative < 0.8 * all.error_relative && rep.error_bound <= all.error_bound,
                  "kind %d: %g of a pair, %g of all", (int)kind, rep.error_relative, all.error_relative);
    }
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
    const hd_laplacian *lap = kit_pair("flat/91/91/0.3 vor");
    int32_t *i = KIT_NEW(int32_t, PAIRS), *j = KIT_NEW(int32_t, PAIRS);
    double *d = KIT_NEW(double, PAIRS);
    int m, q;
    for (q = 0; q < PAIRS; q++) j[q] = q + 1;
    for (m = HD_METHOD_ITERATIVE; m <= HD_METHOD_KRYLOV; m++) {
        diag_stages seen = {0, 0};
        hd_context ctx;
        hd_heat_opts o;
        hd_heat *heat = NULL;
        memset(&ctx, 0, sizeof ctx);
        memset(&o, 0, sizeof o);
        ctx.progress = diag_on_stage;
        ctx.progress_user = &seen;
        o.context = &ctx;
        o.method = (hd_method)m;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, 3 * lap->h * lap->h, PAIRS, i, j, d, NULL) == HD_ERR_CANCELLED);
        CHECK_MSG((seen.inverts > 0) == (m == HD_METHOD_DIRECT) && (seen.solves == 10) == (m != HD_METHOD_DIRECT),
                  "method %d: %d inversions, %d solves", m,
                  seen.inverts, seen.solves);
        hd_heat_free(heat);
    }
}

/* Samples are those of brute force with the distances [n n] of the truth; ties aside, which an uneven shape has none of. A point is as far
 * from those before it as the report of its distance says, and no vertex is farther. */
static void diag_samples_by(const hd_laplacian *lap, hd_heat *heat, hd_distance_kind kind, double t, int32_t given, const double *far,
                            const char *what) {
    enum { COUNT = 9 };
    const int32_t n = lap->n;
    int32_t vertex[COUNT] = {-1, -1, -1, -1, -1, -1, -1, -1, -1}, v, k, q;
    const hd_sources from = hd_vertices(given, vertex);
    double distance[COUNT], most = 0, tol;
    hd_report rep;
    for (v = 0; v < n * n; v++) most = far[v] < HUGE_VAL ? fmax(most, far[v]) : most;
    tol = 1e-6 * most;
    for (q = 0; q < given; q++) vertex[q] = lap->vertex[(q * 31 + 11) % lap->n_active];
    if (!CHECK_MSG(hd_heat_sample(heat, kind, t, given ? &from : NULL, COUNT - given, vertex + given, distance + given, &rep, NULL) >= 0,
                   "%s", rep.error.text)) return;
    CHECK(given || (distance[0] == 0 && vertex[0] == lap->vertex[0]));
    for (q = given ? given : 1; q < COUNT; q++) {
        double best = -1, own = HUGE_VAL;
        for (v = 0; v < n; v++) {
            double near_ = HUGE_VAL;
            for (k = 0; k < q && lap->row[v] >= 0; k++) near_ = fmin(near_, far[vertex[k] * n + v]);
            if (lap->row[v] >= 0) best = fmax(best, near_);
            if (v == vertex[q]) own = near_;
        }
        CHECK_MSG(own == best || own >= best - tol, "%s, kind %d, point %d: vertex %d at %g, not %g", what, (int)kind,
                  (int)q,
                  (int)vertex[q], own, best);
        CHECK_MSG(own == distance[q] || fabs(own - distance[q]) <= tol, "%s, kind %d, point %d: distance %g, not %g", what, (int)kind,
                  (int)q,
                  distance[q], own);
        CHECK(lap->row[vertex[q]] >= 0);
    }
}

static void diag_samples(void) {
    static const char *const texts[5] = {"shape=bumpy/1/5 op=fem", "shape=bumpy/1/5 op=cot", "shape=tangle op=vor",
        "shape=tangle op=cot", "shape=leak/30/0.01 op=diag"};
    static const double when[3] = {3, 20, 60};
    int q, kind, k;
    int32_t i, j;
    for (q = 0; q < 5 * 3 * 4; q++) {
        const int32_t mark = kit_mark();
        trial_work *w = case_truth_of(texts[q / 12]);
        const hd_laplacian *lap = w->s->lap;
        const double t = when[q / 4 % 3] * w->s->unit;
        hd_heat *heat = kit_heat(lap, q / 4 % 3 ? "" : "poles=kernel degree=14");
        double *far = KIT_NEW(double, lap->n * lap->n), off;
        int32_t one = -9;
        kind = q % 4;
        trial_distance_for(w, kind, 2 * t, 0);
        for (i = 0; i < lap->n; i++)
            for (j = 0; j < lap->n; j++) {
                const int32_t a = lap->row[i], b = lap->row[j];
                const int apart = kind > 1 && i != j && (a < 0 || b < 0 || lap->component[a] != lap->component[b]);
                far[i * lap->n + j] = apart ? HUGE_VAL : (double)trial_want_distance(w, i, j, kind == HD_DISTANCE_WEIGHTED, &off);
            }
        for (k = 0; k < 2; k++) diag_samples_by(lap, heat, (hd_distance_kind)kind, t, 3 * k, far, texts[q / 12]);
        CHECK(heat_sample(heat, (hd_distance_kind)kind, t, 1, &one, NULL, NULL) >= 0 && one == lap->vertex[0]);
        kit_release(mark);
    }
}

/* Where all distances are lost the farthest points are still different ones; given ones may be without mass. */
static void diag_samples_lost(void) {
    const hd_laplacian *lap = kit_pair("spare/3/1 vor");
    hd_heat *heat = kit_heat(lap, "");
    int32_t v[37] = {0}, q, k;
    const double t = 0.1;
    double d[37], *u = KIT_NEW(double, lap->n);
    CHECK(lap->n_active == 37 && heat_sample(heat, HD_DISTANCE_CLASSICAL, 1e6, 37, v, d, NULL) >= 0);
    for (q = 0; q < 37; q++) {
        CHECK(lap->row[v[q]] >= 0 && d[q] >= 0);
        for (k = 0; k < q; k++) CHECK_MSG(v[k] != v[q], "points %d and %d are both %d", (int)k, (int)q, (int)v[q]);
    }
    v[0] = 0;
    v[1] = 5;                                    /* both without mass, f = 0: at no distance of each other */
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, v, u, 0, NULL) >= 0 && u[5] == 0);
    CHECK(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, VERTICES(2, v), 2, v + 2, d, NULL, NULL) >= 0);
    CHECK(lap->row[0] < 0 && lap->row[5] < 0 && d[0] > 0 && d[1] > 0 && lap->row[v[2]] >= 0 && lap->row[v[3]] >= 0);
}

/* ---- sets, orderings, threads ---- */

/* The elimination order makes no difference, whoever gives it. (Threads make none at all.) */
static void diag_orders(void) {
    static const hd_ordering orders[4] = {HD_ORDERING_AUTO, HD_ORDERING_MINIMUM_DEGREE, HD_ORDERING_NESTED_DISSECTION, HD_ORDERING_OWN};
    const hd_laplacian *lap = kit_pair("spare/8/1 fem");
    const int32_t n = lap->n, source = 6;
    const double t = 3 * lap->h * lap->h;
    int32_t *perm = KIT_NEW(int32_t, n), i;
    double *first = KIT_NEW(double, 5 * n), *D = KIT_NEW(double, 5 * n);
    uint64_t seed = 3;
    int q, kind;
    dense_shuffle(perm, n, &seed);
    for (q = 0; q < 4; q++) {
        hd_heat_opts o;
        hd_heat *heat;
        memset(&o, 0, sizeof o);
        o.method = HD_METHOD_DIRECT;
        o.ordering = orders[q];
        o.perm = perm;
        heat = kit_plan(lap, &o);
        if (q == 3) memset(perm, 0, (size_t)n * sizeof *perm);    /* it was copied */
        for (kind = 0; kind < 4; kind++) CHECK(heat_distance(heat, (hd_distance_kind)kind, 1, &t, 1, &source, D + kind * n, 0,
                                                             NULL) >= 0);
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, D + 4 * n, 0, NULL) >= 0);
        if (q == 0) memcpy(first, D, 5 * (size_t)n * sizeof *D);
        for (i = 0; i < 5 * n; i++) CHECK_MSG(D[i] == first[i] || fabs(D[i] - first[i]) <= 1e-8 * fabs(first[i]),
                                              "ordering %d: %.12g, not %.12g", q, D[i], first[i]);
    }
}

typedef void diag_asks(hd_heat *heat, double hh, int32_t n, double *D);

/* The same bits in all ways of threading: of what is asked of a plan for a bumpy sphere, `count` fields. */
static void diag_each_way(hd_laplacian_kind kind, int64_t count, diag_asks *ask) {
    const shape *s = kit_shape("bumpy/4/1");
    const size_t size = (size_t)(count * s->n);
    double *first = KIT_NEW(double, size), *D = KIT_NEW(double, size);
    int way;
    for (way = 0; way < LDL_WAYS; way++) {
        ldl_way w;
        hd_laplacian_opts lo;
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        ldl_way_begin(&w, way, HD_SIMD_AUTO);
        memset(&lo, 0, sizeof lo);
        lo.context = &w.ctx;
        lo.kind = kind;
        CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &lo, NULL) == HD_OK &&
              hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
        ask(heat, lap->h * lap->h, s->n, D);
        if (way == 0) memcpy(first, D, size * sizeof *D);
        CHECK_MSG(memcmp(first, D, size * sizeof *D) == 0, "way %d of threading gives other bits", way);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        ldl_way_end(&w, way);
    }
}

static void diag_ask_all(hd_heat *heat, double hh, int32_t n, double *D) {
    const int32_t sources[3] = {7, 2000, 300};
    const double t = 30 * hh;
    int32_t sample[5];
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, NULL) >= 0);
    CHECK(heat_distance(heat, HD_DISTANCE_WEIGHTED, 1, &t, 3, sources, D + n, 0, NULL) >= 0);
    CHECK(heat_distance(heat, HD_DISTANCE_BIHARMONIC, 1, NULL, 3, sources, D + 4 * n, 0, NULL) >= 0);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 5, sample, D + 7 * n, NULL) >= 0);
}

static void diag_threads(void) { diag_each_way(HD_LAPLACIAN_VORONOI_COT, 8, diag_ask_all); }

/* ---- what is refused, and what goes wrong on the way ---- */

/* What the group doors does not ask: times that are not positive, in each query; methods that have no diagonal. */
static void diag_refused(void) {
    static const char *const methods[2] = {"method=iterative", "method=krylov"};
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    hd_heat *heat = kit_heat(lap, "");
    const double t = 0.1, bad[5] = {0, -1, HUGE_VAL, NAN, -HUGE_VAL};
    const int32_t v = 3;
    double D[42];
    int32_t sample[42] = {0};
    hd_report rep;
    int q, kind;
    for (q = 0; q < 2; q++) {
        hd_heat *other = kit_heat(lap, methods[q]);
        CHECK(heat_diagonal(other, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT && rep.status == HD_ERR_ARGUMENT &&
              rep.error.status == HD_ERR_ARGUMENT);
        for (kind = 0; kind < 4; kind++) {
            CHECK(heat_distance(other, (hd_distance_kind)kind, 1, &t, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT &&
                  rep.error.status == HD_ERR_ARGUMENT);
            CHECK(heat_sample(other, (hd_distance_kind)kind, t, 3, sample, NULL, &rep) == HD_ERR_ARGUMENT &&
                  rep.error.status == HD_ERR_ARGUMENT);
            CHECK(heat_pairs(other, (hd_distance_kind)kind, t, 1, &v, &v, D, &rep) == (kind < 2 ? HD_OK : HD_ERR_ARGUMENT));
        }
    }
    for (q = 0; q < 5; q++) {
        CHECK(heat_diagonal(heat, 1, bad + q, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT);
        CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, bad + q, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
        CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, bad[q], 2, sample, NULL, &rep) == HD_ERR_ARGUMENT);
        CHECK(q == 0 || heat_pairs(heat, HD_DISTANCE_CLASSICAL, bad[q], 1, &v, &v, D, &rep) == HD_ERR_ARGUMENT);
    }
    CHECK(heat_diagonal(heat, -1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_ERR_ARGUMENT &&
          heat_diagonal(heat, 0, NULL, HD_KERNEL_SYMMETRIC, NULL, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 41, &rep) == HD_ERR_ARGUMENT &&
          heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, D, 41, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 0, NULL, 1, &v, D, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_BIHARMONIC, 0, NULL, 1, &v, D, 0, &rep) == HD_OK && D[1] > 0);    /* it has no time */
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 42, sample, NULL, &rep) >= 0);   /* all of them, each once */
    for (q = 0; q < 42; q++)
        for (kind = 0; kind < q; kind++) CHECK(sample[q] != sample[kind]);
}

/* A grid with a column of cells pressed to a hundredth of its width. */
static const shape *diag_slivers(void) {
    shape s = shape_grid(9, 7, 0.3);
    int32_t i;
    for (i = 4; i < s.n; i += 9) s.xyz[3 * i] = s.xyz[3 * i - 3] + 0.00125;
    return kit_own(s);
}

/* By default a second, better pass may be wanted; when it does not fit, the first answer stands, and all is freed. */
static void diag_limits_by_default(void) {
    const shape *s = diag_slivers();
    const int32_t source = 4;
    double *D = KIT_NEW(double, s->n);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    uint64_t limit, need, base;
    int32_t i;
    int kind;
    memset(&lo, 0, sizeof lo);
    lo.context = &ctx;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &lo, NULL) == HD_OK);
    base = ctx.bytes_in_use;
    for (kind = -1; kind < 4; kind++) {
        const double t = 3 * lap->h * lap->h;
        int fine = 0, refused = 0;
        for (limit = 0, need = 0; limit <= need + need / 20; limit += need / (kind == 0 || kind == 1 ? 400 : 50)) {
            hd_heat *heat = NULL;
            hd_report rep;
            hd_status st;
            memset(&rep, 0, sizeof rep);
            ctx.byte_limit = limit ? base + limit : 0;
            ctx.bytes_peak = ctx.bytes_in_use;
            st = hd_heat_create(&heat, lap, NULL, &rep.error);
            if (st >= 0) st = kind < 0 ? heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) : heat_distance(heat,
                (hd_distance_kind)kind, 1, &t, 1, &source, D, 0, &rep);
            CHECK_MSG(st >= 0 ? rep.error.status == HD_OK : st == HD_ERR_MEMORY_LIMIT && rep.error.status == st,
                      "kind %d: status %d, %d", kind, (int)st, (int)rep.error.status);
            fine += st >= 0;
            refused += st < 0;
            if (limit == 0) need = ctx.bytes_peak - base;
            hd_heat_free(heat);
            CHECK(ctx.bytes_in_use == base);
            for (i = 0; st >= 0 && i < s->n; i++) CHECK(D[i] >= 0 && D[i] < 1e9);
        }
        CHECK_MSG(fine > 1 && refused > 10, "kind %d: %d fine, %d refused, %g bytes", kind, fine, refused, (double)need);
    }
    ctx.byte_limit = 0;
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, "limits by default");
}

/* ---- what rounding does ---- */

/* Cells of very unlike size: diagonals take the highest degree, and rounding shows. */
static void diag_graded(void) {
    shape graded = shape_grid(14, 11, 0.2);
    const shape *s;
    int32_t i;
    int kind;
    for (i = 0; i < 3 * graded.n; i++) graded.xyz[i] = pow(graded.xyz[i], 4) + 0.001;
    s = kit_own(graded);
    for (kind = 0; kind < 2; kind++) {
        const hd_laplacian *lap = kit_triangles(s, op_kinds[kind]);
        const double t = 0.3 * lap->h * lap->h;
        double *D = KIT_NEW(double, lap->n);
        hd_heat *heat = kit_heat(lap, "");
        hd_report one;
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &one) == HD_OK && one.degree == 14 && one.error_rational < 1e-9);
        heat = kit_heat(lap, "method=direct poles=uniform degree=9");
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &one) >= 0 && one.error_rounding > 0);
    }
}

/* With a full B the diagonal of K_t may be smaller than what the constants are of it. That is no sign of rounding. Two uneven cells that are
 * not flat. */
static void diag_below_constants(void) {
    static const int32_t tri[12] = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4};
    shape s = shape_make(6, 4);
    hd_laplacian *lap;
    hd_heat *heat;
    double D[6], least = 1;
    int32_t q, i;
    for (i = 0; i < 6; i++) shape_put_vertex(&s, i, i % 2 + 0.2 * sin(7.1 * i), 1.3 * (i / 2) + 0.2 * cos(3.3 * i),
                                             0.3 * sin(0.5 * (i % 2)));
    memcpy(s.tri, tri, sizeof tri);
    lap = kit_triangles(kit_own(s), HD_LAPLACIAN_FEM);
    heat = kit_heat(lap, "");
    for (q = 0; q < 30; q++) {
        const double t = 0.05 * lap->h * lap->h * pow(1.2, q);
        hd_report r;
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, D, 0, &r) == HD_OK);
        CHECK_MSG(r.error_bound < 1e-6, "t = %g: bound %g", t, r.error_bound);
        for (i = 0; i < lap->n_active; i++) least = fmin(least, D[lap->vertex[i]] * lap->component_mass[0] / lap->mass[i]);
    }
    CHECK_MSG(least < 0.998, "at least %g times the constants", least);
}

/* A path with L and B in other units: distances without a time, and their bounds, change by powers of two only. */
static void diag_units(void) {
    static const int units[][2] = {{0, 0}, {320, -300}, {320, -320}, {60, -320}, {40, -300}, {-320, 320}, {-100, 320}};
    const int32_t source = 1;
    double want[2][6], bound[2] = {0, 0};
    int32_t q, i, a;
    for (q = 0; q < 7; q++) {
        hd_heat *heat = kit_heat(kit_path(6, units[q][0], units[q][1]), "");
        for (a = 0; a < 2; a++) {
            const int power = a ? units[q][0] - units[q][1] / 2 : units[q][0] / 2;
            double d[6];
            hd_report r;
            CHECK(heat_distance(heat, a ? HD_DISTANCE_BIHARMONIC : HD_DISTANCE_COMMUTE, 0, NULL, 1, &source, d, 0, &r) == HD_OK);
            for (i = 0; i < 6; i++) {
                if (q == 0) want[a][i] = d[i];
                CHECK_MSG(ldexp(d[i], power) == want[a][i], "units 2^%d, 2^%d: %g, want %g", units[q][0], units[q][1], d[i],
                          want[a][i]);
            }
            if (q == 0) bound[a] = r.error_bound;
            CHECK(r.error_bound > 0 && r.error_bound < 1e-10 && fabs(r.error_bound - bound[a]) <= 1e-6 * bound[a]);
        }
    }
}

static void test_diagonal(void) {
    diag_graded();
    diag_inverse_shapes();
    diag_inverse_levels();
    diag_inverse_no_diagonal();
    diag_inverse_threads();
    diag_inverse_of_nothing();
    diag_cases();
    diag_reports();
    diag_times();
    diag_resistances();
    diag_places();
    diag_lost();
    diag_metric_laws();
    diag_pairs_parts();
    diag_pairs_errors();
    diag_pairs_method();
    diag_samples();
    diag_samples_lost();
    diag_orders();
    diag_threads();
    diag_refused();
    diag_limits_by_default();
    diag_below_constants();
    diag_units();
}

#endif
