/* test_forms.h - quadratic forms x_j' Z x_j of the columns of a matrix with the inverse of another one, Z, which weighted distances rest on: against dense inverses,
 * against whole solves, and in all ways of threading */

#ifndef TEST_FORMS_H
#define TEST_FORMS_H

/* What one factor gives: all numbers of an entry (one, or four real and four imaginary parts) of all forms, by rows of A. */
typedef struct forms_case {
    const hd_csr *a;
    const double *x;             /* X by A's entries */
    const double *real;          /* A: real, or four complex ones */
    const hd_c64 *z;             /* [4][nnz] */
    int32_t cols, slots;         /* of blocks; 0: as it comes */
} forms_case;

/* All fronts to the top, where blocks of columns are tasks; those of small matrices are all in subtrees otherwise. */
static void forms_all_top(hdi_symbolic *s) {
    int32_t v;
    s->n_tasks = 0;
    s->task_pivots = s->task_update = 0;
    s->n_top = s->n_super;
    for (v = 0; v < s->n_super; v++) {
        s->top[v] = v;
        s->task_of[v] = -1;
    }
}

/* out [width][n], added to. */
static void forms_run(const forms_case *c, const hdi_symbolic *s, hd_context *ctx, double *out, const char *what) {
    const int32_t width = c->real ? 1 : HDI_PACK, n = s->n;
    double coef[HDI_PACK * HDI_PACK], *by_pivot = DENSE_NEW(double, (int64_t)width * n);
    hdi_factor f;
    hdi_forms forms;
    hdi_inverse z;
    hdi_values v;
    hdi_scope keep;
    hd_error e;
    int32_t q, i;
    memset(&v, 0, sizeof v);
    v.real = c->real;
    for (q = 0; q < 4 && c->z; q++) v.z[q] = c->z + q * c->a->nnz;
    hdi_error_clear(&e);
    keep = hdi_scope_begin(ctx, &e);
    CHECK_MSG(hdi_factor_make(&f, s, width, ctx, &e) == HD_OK && hdi_factor_run(&f, &v, &e) == HD_OK, "%s: %s", what, e.text);
    hdi_inverse_take(&z, s, width, &keep);
    CHECK_MSG(e.status == HD_OK && hdi_forms_make(&forms, s, width, c->a, c->x, ctx, &e) == HD_OK, "%s: %s", what, e.text);
    if (c->cols && c->cols < forms.cols) forms.cols = c->cols;
    if (c->slots && c->slots < forms.n_slots) forms.n_slots = c->slots;
    memset(coef, 0, sizeof coef);
    for (q = 0; q < width; q++) coef[q * width + q] = 1;
    for (i = 0; i < n; i++)
        for (q = 0; q < width; q++) by_pivot[q * n + i] = 3;    /* sums are added to what is there */
    z.coef = coef;
    z.n_sets = width;
    z.wanted = HDI_WANT_FORMS;
    z.forms = &forms;
    z.values = by_pivot;
    z.stride = n;
    CHECK_MSG(hdi_inverse_run(&z, &f, &e) == HD_OK, "%s: %s", what, e.text);
    for (i = 0; i < n; i++)
        for (q = 0; q < width; q++) out[q * n + s->perm[i]] += by_pivot[q * n + i] - 3;
    hdi_forms_free(&forms, ctx);
    hdi_scope_end(&keep);
    hdi_factor_free(&f);
    free(by_pivot);
}

/* Inverse of a [n n], which is destroyed, by Gauss and Jordan with pivots from the column. */
static dense_c64 *forms_inverse(dense_c64 *a, int32_t n) {
    dense_c64 *z = DENSE_NEW(dense_c64, (int64_t)n * n), keep;
    int32_t i, j, k;
    for (i = 0; i < n; i++) z[(size_t)i * (size_t)n + (size_t)i] = dense_c(1, 0);
    for (k = 0; k < n; k++) {
        dense_c64 *ak = a + (size_t)k * (size_t)n, *zk = z + (size_t)k * (size_t)n, d;
        int32_t best = k;
        for (i = k + 1; i < n; i++)
            if (hypot(a[(size_t)i * (size_t)n + (size_t)k].re, a[(size_t)i * (size_t)n + (size_t)k].im) >
                hypot(a[(size_t)best * (size_t)n + (size_t)k].re, a[(size_t)best * (size_t)n + (size_t)k].im)) best = i;
        for (j = 0; best != k && j < n; j++) {
            dense_c64 *ab = a + (size_t)best * (size_t)n, *zb = z + (size_t)best * (size_t)n;
            keep = ab[j], ab[j] = ak[j], ak[j] = keep;
            keep = zb[j], zb[j] = zk[j], zk[j] = keep;
        }
        d = ak[k];
        for (j = 0; j < n; j++) {
            ak[j] = dense_cquotient(ak[j], d);
            zk[j] = dense_cquotient(zk[j], d);
        }
        for (i = 0; i < n; i++) {
            const dense_c64 l = a[(size_t)i * (size_t)n + (size_t)k];
            if (i == k || (l.re == 0 && l.im == 0)) continue;
            for (j = 0; j < n; j++) {
                a[(size_t)i * (size_t)n + (size_t)j] = dense_cfma(a[(size_t)i * (size_t)n + (size_t)j], l, ak[j]);
                z[(size_t)i * (size_t)n + (size_t)j] = dense_cfma(z[(size_t)i * (size_t)n + (size_t)j], l, zk[j]);
            }
        }
    }
    return z;
}

/* want [2][n]: real and imaginary parts of diag(X Z X). val: complex, or NULL and real. */
static void forms_dense(const hd_csr *a, const double *real, const hd_c64 *val, const double *x, double *want) {
    const int32_t n = a->n_rows;
    dense_c64 *full = DENSE_NEW(dense_c64, (int64_t)n * n), *z;
    int64_t p, q;
    int32_t i;
    for (i = 0; i < n; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) full[(size_t)i * (size_t)n + (size_t)a->col[p]] = real ? dense_c(real[p], 0) : dense_c(val[p].re, val[p].im);
    z = forms_inverse(full, n);
    for (i = 0; i < n; i++) {
        want[i] = want[n + i] = 0;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            for (q = a->row_ptr[i]; q < a->row_ptr[i + 1]; q++) {
                const dense_c64 *at = z + (size_t)a->col[p] * (size_t)n + (size_t)a->col[q];
                want[i] += x[p] * x[q] * at->re;
                want[n + i] += x[p] * x[q] * at->im;
            }
    }
    free(full);
    free(z);
}

/* Of either sign, and zero here and there (`holes` of 10), so that X has fewer entries than A. */
static double *forms_values(const hd_csr *a, uint64_t seed, int holes) {
    double *x = DENSE_NEW(double, a->nnz);
    int64_t p;
    int32_t i;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            x[p] = 10 * ldl_chance(i, a->col[p], seed + 1) < holes ? 0 : ldl_chance(i, a->col[p], seed) - 0.4;
    return x;
}

/* Columns that begin below the fronts of their pivots, and the longest way from there. */
static int32_t forms_deep(const hd_csr *a, const hdi_symbolic *s, int32_t *longest) {
    int32_t *inv = DENSE_NEW(int32_t, s->n), i, v, deep = 0, wrong = 0;
    int64_t p;
    *longest = 0;
    for (i = 0; i < s->n; i++) inv[s->perm[i]] = i;
    for (i = 0; i < s->n; i++) {
        int32_t most = 0;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            int32_t steps = 0;
            if (inv[a->col[p]] > inv[i]) continue;
            for (v = s->super_of[inv[a->col[p]]]; v != s->super_of[inv[i]] && v >= 0; v = s->parent[v]) steps++;
            wrong += v < 0;
            if (steps > most) most = steps;
        }
        deep += most > 0;
        if (most > *longest) *longest = most;
    }
    CHECK(wrong == 0);
    free(inv);
    return deep;
}

/* One pattern, three orderings, in subtrees and at the top, at all levels of instructions: every number of every form.
 * deep[level] counts the columns that begin below the fronts of their pivots, level by level: plain C is all that some processors have. */
static void forms_small(const hd_csr *a, uint64_t seed, const char *what, int32_t deep[HD_SIMD_AVX512], int32_t *longest) {
    static const int32_t widths[4] = {0, 1, 2, 5};
    const int32_t n = a->n_rows;
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz), *x = forms_values(a, seed, (int)(seed % 4)), *got = DENSE_NEW(double, (int64_t)HDI_PACK * n);
    double *want = DENSE_NEW(double, (int64_t)2 * HDI_PACK * n), *want_real = DENSE_NEW(double, 2 * n);
    hd_c64 *z = DENSE_NEW(hd_c64, 4 * a->nnz);
    int32_t *perm = DENSE_NEW(int32_t, n), q, i;
    int order, top, level;
    int64_t p;
    ldl_pair(a, seed, L, B);
    if (seed % 2) diag_steep(a, L, B, 4, seed + 3, z);
    else ldl_shifted(a, L, B, 4, seed + 3, z);
    for (q = 0; q < 4; q++) {                    /* as they stand in a pack: real parts, then imaginary ones */
        double *two = DENSE_NEW(double, 2 * n);
        forms_dense(a, NULL, z + q * a->nnz, x, two);
        memcpy(want + (size_t)q * (size_t)n, two, (size_t)n * sizeof *two);
        memcpy(want + (size_t)(q + 4) * (size_t)n, two + n, (size_t)n * sizeof *two);
        free(two);
    }
    for (p = 0; p < a->nnz; p++) L[p] += 0.5 * B[p];
    forms_dense(a, L, NULL, x, want_real);
    for (order = 0; order < 3; order++) {
        for (level = 0; level <= hdi_simd_best(); level++) {
            for (top = 0; top < 2; top++) {
                hd_context ctx;
                hd_error e;
                hdi_symbolic s;
                forms_case c;
                int32_t far;
                uint64_t state = seed + 4;
                int width;
                memset(&ctx, 0, sizeof ctx);
                memset(&c, 0, sizeof c);
                hdi_error_clear(&e);
                ctx.simd = level == 0 ? HD_SIMD_NONE : level == 1 ? HD_SIMD_AVX2 : HD_SIMD_AVX512;
                for (i = 0; i < n; i++) perm[i] = i;
                if (order == 1) dense_shuffle(perm, n, &state);
                if (order == 2) CHECK(hdi_amd_order(a, perm, &ctx, &e) == HD_OK);
                CHECK(hdi_symbolic_make(&s, a, perm, &ctx, &e) == HD_OK);
                if (top) forms_all_top(&s);
                deep[level] += forms_deep(a, &s, &far);
                *longest = far > *longest ? far : *longest;
                c.a = a;
                c.x = x;
                c.cols = widths[(order + level + top) % 4];
                c.slots = 1 + order;
                for (width = 0; width < 2; width++) {
                    const double *to = width ? want : want_real, size = dense_max_abs(to, (width ? HDI_PACK : 1) * (int64_t)n);
                    double off = 0;
                    c.real = width ? NULL : L;
                    c.z = width ? z : NULL;
                    memset(got, 0, (size_t)HDI_PACK * (size_t)n * sizeof *got);
                    forms_run(&c, &s, &ctx, got, what);
                    off = dense_max_diff(got, to, (width ? HDI_PACK : 1) * (int64_t)n);
                    CHECK_MSG(off <= 1e-11 * size, "%s, n %d, order %d, level %d, top %d, %s: off by %g", what, (int)n, order, level, top, width ? "packs" : "real", off / size);
                }
                hdi_symbolic_free(&ctx, &s);
                CHECK(ctx.bytes_in_use == 0);
            }
        }
    }
    free(L);
    free(B);
    free(x);
    free(got);
    free(want);
    free(want_real);
    free(z);
    free(perm);
}

static void forms_shapes(void) {
    int32_t deep[HD_SIMD_AVX512] = {0}, longest = 0;
    int kind, q;
    for (kind = 0; kind < LDL_SHAPES; kind++) {
        for (q = 0; q < 3; q++) {
            hd_csr a = ldl_shape(kind, q == 0 ? 1 + kind % 3 : q == 1 ? 24 + kind : 75 + kind, 1, (uint64_t)(kind + q));
            forms_small(&a, (uint64_t)(10 * kind + q), ldl_shape_name(kind), deep, &longest);
            hd_csr_free(&a, NULL);
        }
    }
    for (q = 0; q < 6; q++) {
        hd_csr a = ldl_random_pattern(50 + 20 * q, 2 + 0.5 * q, (uint64_t)q);
        forms_small(&a, (uint64_t)(100 + q), "random", deep, &longest);
        hd_csr_free(&a, NULL);
    }
    for (q = 0; q <= hdi_simd_best(); q++)
        CHECK_MSG(deep[q] > 2500 && longest > 8, "level %d: only %d columns with fronts below, and %d of them at most", q, (int)deep[q], (int)longest);
}

/* Meshes with fronts of more than a panel, subtrees and a top: some columns against whole solves, and the same bits however it is shared out. */
static void forms_mesh(const hd_csr *a, const double *xyz, int32_t picked, const char *what) {
    const int32_t n = a->n_rows;
    double *L = DENSE_NEW(double, a->nnz), *B = DENSE_NEW(double, a->nnz), *x = forms_values(a, 5, 0), *first = DENSE_NEW(double, (int64_t)HDI_PACK * n);
    double *got = DENSE_NEW(double, (int64_t)HDI_PACK * n);
    hd_c64 *z = DENSE_NEW(hd_c64, 4 * a->nnz), *b = DENSE_NEW(hd_c64, n), *u = DENSE_NEW(hd_c64, (int64_t)4 * n);
    int32_t *perm = DENSE_NEW(int32_t, n), i, k, q;
    int64_t p;
    int way, width;
    ldl_pair(a, 3, L, B);
    ldl_shifted(a, L, B, 4, 8, z);
    for (p = 0; p < a->nnz; p++) L[p] += 0.5 * B[p];
    for (width = 0; width < 2; width++) {
        forms_case c;
        memset(&c, 0, sizeof c);
        c.a = a;
        c.x = x;
        c.real = width ? NULL : L;
        c.z = width ? z : NULL;
        for (way = 0; way < LDL_WAYS; way++) {
            ldl_way *w = DENSE_NEW(ldl_way, 1);
            hdi_symbolic s;
            hd_error e;
            hdi_error_clear(&e);
            ldl_way_begin(w, way, HD_SIMD_AUTO);
            if (xyz) CHECK(hdi_nd_order(a, xyz, perm, &w->ctx, &e) == HD_OK);
            else CHECK(hdi_amd_order(a, perm, &w->ctx, &e) == HD_OK);
            CHECK(hdi_symbolic_make(&s, a, perm, &w->ctx, &e) == HD_OK && s.n_tasks > 1 && s.n_top > 0);
            memset(got, 0, (size_t)HDI_PACK * (size_t)n * sizeof *got);
            forms_run(&c, &s, &w->ctx, got, what);
            if (way == 0) memcpy(first, got, (size_t)HDI_PACK * (size_t)n * sizeof *got);
            CHECK_MSG(memcmp(first, got, (size_t)HDI_PACK * (size_t)n * sizeof *got) == 0, "%s, %s: way %d of threading gives other bits", what, width ? "packs" : "real", way);
            hdi_symbolic_free(&w->ctx, &s);
            ldl_way_end(w, way);
            free(w);
        }
        {
            hd_ldl_opts o = ldl_opts_of(xyz ? HD_ORDERING_NESTED_DISSECTION : HD_ORDERING_MINIMUM_DEGREE, NULL, xyz, NULL);
            hd_ldl *f = ldl_make(a, &o, what);
            double off = 0, size = dense_max_abs(first, (width ? HDI_PACK : 1) * (int64_t)n);
            CHECK((width ? hd_ldl_factor_complex(f, 4, z, NULL, NULL) : hd_ldl_factor(f, L, NULL, NULL)) == HD_OK);
            for (k = 0; k < picked; k++) {
                const int32_t j = (int32_t)((int64_t)k * n / picked);
                memset(b, 0, (size_t)n * sizeof *b);
                memset(u, 0, 4 * (size_t)n * sizeof *u);
                for (p = a->row_ptr[j]; p < a->row_ptr[j + 1]; p++) {
                    if (width) b[a->col[p]].re = x[p];
                    else ((double *)b)[a->col[p]] = x[p];
                }
                CHECK((width ? hd_ldl_solve_complex(f, b, 0, u, 0, NULL) : hd_ldl_solve(f, 1, (double *)b, 0, (double *)u, 0, NULL)) == HD_OK);
                for (q = 0; q < (width ? 4 : 1); q++) {
                    double re = 0, im = 0;
                    for (p = a->row_ptr[j]; p < a->row_ptr[j + 1]; p++) {
                        i = a->col[p];
                        re += x[p] * (width ? u[(int64_t)q * n + i].re : ((double *)u)[i]);
                        im += width ? x[p] * u[(int64_t)q * n + i].im : 0;
                    }
                    off = fmax(off, fabs(first[(int64_t)q * n + j] - re));
                    if (width) off = fmax(off, fabs(first[(int64_t)(q + 4) * n + j] - im));
                }
            }
            CHECK_MSG(off <= 1e-11 * size, "%s, %s: off by %g", what, width ? "packs" : "real", off / size);
            hd_ldl_free(f);
        }
    }
    free(L);
    free(B);
    free(x);
    free(first);
    free(got);
    free(z);
    free(b);
    free(u);
    free(perm);
}

static void forms_meshes(void) {
    shape ball = shape_bumpy(4, 3), grid = shape_grid(90, 80, 0.2);
    hd_csr a = ldl_mesh_pattern(&ball);
    forms_mesh(&a, ball.xyz, 60, "ball, nested dissection");
    forms_mesh(&a, NULL, 60, "ball, minimum degree");
    hd_csr_free(&a, NULL);
    a = ldl_mesh_pattern(&grid);
    forms_mesh(&a, grid.xyz, 40, "grid");
    hd_csr_free(&a, NULL);
    a = ldl_random_pattern(1200, 4, 2);          /* fills up: fronts of several panels */
    forms_mesh(&a, NULL, 40, "random");
    hd_csr_free(&a, NULL);
    shape_free(&ball);
    shape_free(&grid);
}

/* Weighted distances with a full B: the same bits in all ways of threading. */
static void forms_ask(hd_heat *heat, double hh, int32_t n, double *D) {
    const int32_t sources[2] = {7, 2000};
    const double t[2] = {30 * hh, 3 * hh};
    (void)n;
    CHECK(heat_distance(heat, HD_DISTANCE_WEIGHTED, 2, t, 2, sources, D, 0, NULL) >= 0);
}

static void forms_distances(void) { diag_each_way(HD_LAPLACIAN_FEM, 4, forms_ask); }

/* Distances at many times in one call, by shared poles, against the dense: both kinds that have times, with full and with diagonal B. */
static void forms_many_times(void) {
    enum { TIMES = 16 };
    shape ball = shape_bumpy(2, 5), odd = diag_odd_shape();
    double bound[4] = {0};
    int q, kind, m, r;
    for (q = 0; q < 4; q++) {
        heat_case c = heat_case_of(test_laplacian(q % 2 ? &odd : &ball, op_kinds[q / 2]), "many times");
        const hd_laplacian *lap = c.lap;
        const int32_t sources[3] = {lap->vertex[0], lap->vertex[lap->n_active / 2], 0};
        double t[TIMES], *D = DENSE_NEW(double, TIMES * 3 * (int64_t)lap->n);
        hd_heat *heat = diag_plan(lap, HD_POLES_DEFAULT, 0);
        hd_report rep;
        for (m = 0; m < TIMES; m++) t[m] = lap->h * lap->h * pow(10, (m * 7 % TIMES) * 0.12);
        for (kind = 0; kind < 2; kind++) {
            memset(&rep, 0, sizeof rep);
            CHECK_MSG(heat_distance(heat, (hd_distance_kind)kind, TIMES, t, 3, sources, D, 0, &rep) >= 0, "%s", rep.error.text);
            CHECK_MSG(rep.residual > 0 && rep.residual < 1e-8, "residual %g", rep.residual);
            CHECK_MSG(rep.n_poles > 7, "%d poles: not shared", (int)rep.n_poles);
            bound[q] = rep.error_bound;
            for (m = 0; m < TIMES; m++) {
                double *H = diag_gram(&c, (hd_distance_kind)kind, t[m]);
                for (r = 0; r < 3; r++) diag_judge_distance(&c, (hd_distance_kind)kind, t[m], H, sources[r], D + (size_t)(r * TIMES + m) * (size_t)lap->n, &rep, 1e-6, "many times");
                free(H);
            }
        }
        hd_heat_free(heat);
        heat_case_free(&c);
        free(D);
    }
    for (q = 0; q < 2; q++)                      /* of weighted ones: much the same for either mass, poles or eigenpairs */
        CHECK_MSG(bound[q] > 0.03 * bound[q + 2] && bound[q] < 6 * bound[q + 2] && bound[q] < 1e-6, "bounds %g and %g", bound[q], bound[q + 2]);
    shape_free(&ball);
    shape_free(&odd);
}

/* A filter of the caller's with a bit of the identity, whose part of B c(-2t B^-1 L) is a0 B. */
static void forms_own_set(void) {
    shape odd = diag_odd_shape();
    heat_case c = heat_case_of(test_laplacian(&odd, HD_LAPLACIAN_FEM), "own set");
    const int32_t n = c.lap->n_active, source = c.lap->vertex[n / 3];
    hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
    hd_rational set;
    hd_heat *heat;
    hd_report rep;
    const double t = 3 * c.lap->h * c.lap->h;
    double *g = DENSE_NEW(double, n), *D = DENSE_NEW(double, c.lap->n), *K, *KB, *H;
    int32_t i;
    memset(&set, 0, sizeof set);
    set.n_poles = set.degree = 1;
    set.theta[0].re = 1;
    set.a[0].re = -1;
    set.a0 = 0.25;
    o.rational = &set;
    heat = eng_create(c.lap, &o);
    for (i = 0; i < n; i++) g[i] = set.a0 + 1 / (1 + 2 * t * c.pair.lambda[i]);
    K = diag_matrix(&c, g);
    KB = diag_product(K, c.pair.B, n);
    H = diag_product(c.pair.B, KB, n);
    CHECK_MSG(heat_distance(heat, HD_DISTANCE_WEIGHTED, 1, &t, 1, &source, D, 0, &rep) >= 0, "%s", rep.error.text);
    diag_judge_distance(&c, HD_DISTANCE_WEIGHTED, t, H, source, D, &rep, 1e-9, "a0");
    hd_heat_free(heat);
    heat_case_free(&c);
    free(g);
    free(D);
    free(K);
    free(KB);
    free(H);
    shape_free(&odd);
}

static void test_forms(void) {
    forms_shapes();
    forms_meshes();
    forms_distances();
    forms_many_times();
    forms_own_set();
}

#endif
