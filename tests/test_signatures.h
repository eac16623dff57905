/* test_signatures.h - heat traces, normalised and scale-invariant signatures, and times that suit a surface */

#ifndef TEST_SIGNATURES_H
#define TEST_SIGNATURES_H

#define SIGN_PI 3.14159265358979323846

enum { SIGN_TIMES = 12 };

/* Times over three decades, in no order. */
static void sign_times(const heat_case *c, double *t) {
    int k;
    for (k = 0; k < SIGN_TIMES; k++) t[k] = 3 / c->top * pow(10, 0.27 * ((5 * k) % SIGN_TIMES));
}

static double sign_trace(const heat_case *c, double t) {
    double sum = 0;
    int32_t i;
    for (i = 0; i < c->pair.n; i++) sum += exp(-t * c->pair.lambda[i]);
    return sum;
}

/* Within the bounds, and to 1e-7, by shared poles, one time, the operator's diagonal, and poles of one's own. */
static void sign_traces(const heat_case *c) {
    const hd_laplacian *lap = c->lap;
    double t[SIGN_TIMES], Z[SIGN_TIMES], bound[SIGN_TIMES], one, *diag = DENSE_NEW(double, lap->n);
    hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    hd_report rep;
    hd_error e;
    int k, set;
    int32_t v;
    sign_times(c, t);
    CHECK_MSG(hd_heat_trace(heat, SIGN_TIMES, t, Z, bound, &rep, &e) == HD_OK, "%s: %s", c->what, e.text);
    CHECK(rep.method == HD_METHOD_DIRECT && rep.evidence_rational == HD_EVIDENCE_PROVEN && rep.evidence_rounding == HD_EVIDENCE_MEASURED);
    for (k = 0; k < SIGN_TIMES; k++) {
        const double want = sign_trace(c, t[k]), off = fabs(Z[k] - want);
        double sum = 0, relative;
        CHECK_MSG(off <= 1e-7 * want && off <= bound[k] + 1e-12 * want && bound[k] <= 1e-6 * want, "%s, t %g: trace off by %g, bound %g", c->what, t[k],
            off / want, bound[k] / want);
        CHECK_MSG(bound[k] <= 1.0001 * rep.error_relative * Z[k] && rep.error_relative < 1e-6 && rep.error_bound <= 1.0001 * rep.error_relative, "%s: %g, %g",
            c->what, rep.error_relative, rep.error_bound);
        CHECK(hd_heat_trace(heat, 1, t + k, &one, &relative, NULL, NULL) == HD_OK && fabs(one - want) <= relative + 1e-12 * want);
        CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, t + k, diag, 0, NULL, NULL) >= 0);
        for (v = 0; v < lap->n; v++) sum += lap->row[v] >= 0 ? diag[v] : 0;
        CHECK_MSG(fabs(one - sum) <= 1e-7 * want, "%s, t %g: the diagonal's sum differs by %g", c->what, t[k], (one - sum) / want);
    }
    hd_heat_free(heat);
    for (set = 0; set < 3; set++) {
        static const hd_pole_kind kinds[3] = {HD_POLES_UNIFORM, HD_POLES_KERNEL, HD_POLES_DIAGONAL};
        heat = eng_plan(lap, HD_METHOD_DIRECT, kinds[set], 14);
        CHECK(hd_heat_trace(heat, 3, t, Z, bound, &rep, NULL) >= 0 && rep.poles == kinds[set]);
        for (k = 0; k < 3; k++) {
            const double want = sign_trace(c, t[k]);
            CHECK_MSG(fabs(Z[k] - want) <= bound[k] + 1e-12 * want && fabs(Z[k] - want) <= 1e-9 * want, "%s, kind %d: trace off by %g, bound %g", c->what,
                (int)kinds[set], fabs(Z[k] - want) / want, bound[k] / want);
        }
        hd_heat_free(heat);
    }
    free(diag);
}

/* Late times: the number of components that keep their heat. */
static void sign_late(const heat_case *c, int components) {
    const double t[3] = {1 / c->top, 1e25 / c->top, 100 / c->top};
    double Z[3], bound[3];
    hd_heat *heat = eng_plan(c->lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    hd_report rep;
    int k;
    CHECK(hd_heat_trace(heat, 3, t, Z, bound, &rep, NULL) == HD_OK);
    CHECK_MSG(Z[1] == components, "%s: %g", c->what, Z[1]);
    for (k = 0; k < 3; k++) CHECK(fabs(Z[k] - sign_trace(c, t[k])) <= bound[k] + 1e-12 * Z[k]);
    hd_heat_free(heat);
}

static void sign_normalised(const heat_case *c) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active, all = lap->n;
    double t[SIGN_TIMES], *D = DENSE_NEW(double, (int64_t)SIGN_TIMES * (all + 2));
    hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    hd_report rep;
    hd_error e;
    int32_t k, i, v;
    int q;
    sign_times(c, t);
    CHECK_MSG(hd_heat_normalised(heat, SIGN_TIMES, t, D, (size_t)all + 2, &rep, &e) == HD_OK, "%s: %s", c->what, e.text);
    CHECK(rep.error_relative <= 2e-6 && rep.error_bound <= rep.error_relative && rep.error_bound_b == HUGE_VAL);
    for (q = 0; q < SIGN_TIMES; q++) {
        const double *d = D + (size_t)q * ((size_t)all + 2), Z = sign_trace(c, t[q]);
        double worst = 0;
        for (i = 0; i < n; i++) {
            double want = 0;
            for (k = 0; k < n; k++) want += exp(-t[q] * c->pair.lambda[k]) / Z * pow(c->pair.x[(size_t)k * (size_t)n + (size_t)i], 2);
            worst = fmax(worst, fabs(d[lap->vertex[i]] - want) / want);
        }
        CHECK_MSG(worst <= 2e-7 && worst <= rep.error_relative + 1e-12, "%s, t %g: off by %g, bound %g", c->what, t[q], worst, rep.error_relative);
        for (v = 0; v < all; v++) CHECK(lap->row[v] >= 0 || d[v] == 0);
    }
    hd_heat_free(heat);
    free(D);
}

/* Against the definition, by dense signatures; within the bound; and nearly the same after scaling. */
static void sign_invariant(const shape *s, hd_laplacian_kind kind) {
    enum { N = 65, FREQ = 6 };
    heat_case c = heat_case_of(test_laplacian(s, kind), "invariant");
    const int32_t n = c.lap->n;
    const double t0 = 1e-6 * c.lap->area, t1 = 1e4 * c.lap->area, scale = 1.7;
    double *D = DENSE_NEW(double, FREQ * n), *E = DENSE_NEW(double, FREQ * n), *logs = DENSE_NEW(double, N), largest = 0, off = 0, moved = 0;
    shape big = shape_make(s->n, s->n_tri);
    hd_laplacian *lap;
    hd_heat *heat = eng_plan(c.lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    hd_report rep;
    int32_t v, k, j, l;
    CHECK(hd_heat_scale_invariant(heat, t0, t1, N, FREQ, D, 0, &rep, NULL) == HD_OK);
    for (v = 0; v < n; v++) {
        for (j = 0; j < N; j++) {
            const double t = t0 * pow(t1 / t0, j / (N - 1.0));
            double sum = 0;
            for (l = 0; l < n; l++) sum += exp(-t * c.pair.lambda[l]) * pow(c.pair.x[(size_t)l * (size_t)n + (size_t)v], 2);
            logs[j] = log(sum);
        }
        for (k = 0; k < FREQ; k++) {
            double re = 0, im = 0;
            for (j = 0; j + 1 < N; j++) {
                re += (logs[j + 1] - logs[j]) * cos(2 * SIGN_PI * j * k / (N - 1));
                im += (logs[j + 1] - logs[j]) * sin(2 * SIGN_PI * j * k / (N - 1));
            }
            largest = fmax(largest, hypot(re, im));
            off = fmax(off, fabs(hypot(re, im) - D[k * n + v]));
        }
    }
    CHECK_MSG(off <= rep.error_bound * largest + 1e-12 * largest && off <= 1e-6 * largest && rep.error_bound < 1e-5, "off by %g, bound %g", off / largest, rep.error_bound);
    CHECK(rep.error_bound >= rep.error_rational && rep.error_relative == HUGE_VAL);
    memcpy(big.tri, s->tri, 3 * (size_t)s->n_tri * sizeof *s->tri);
    for (v = 0; v < 3 * n; v++) big.xyz[v] = scale * s->xyz[v];
    lap = test_laplacian(&big, kind);
    hd_heat_free(heat);
    heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    CHECK(hd_heat_scale_invariant(heat, t0, t1, N, FREQ, E, 0, NULL, NULL) == HD_OK);
    for (v = 0; v < FREQ * n; v++) moved = fmax(moved, fabs(E[v] - D[v]));
    CHECK_MSG(moved <= 0.01 * largest && moved > 0, "scaling moves it by %g", moved / largest);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    heat_case_free(&c);
    shape_free(&big);
    free(D);
    free(E);
    free(logs);
}

/* The trace of the unit sphere, sum (2l + 1) exp(-l (l + 1) t), is met as the mesh gets finer. */
static void sign_sphere(void) {
    const double t[3] = {0.1, 0.3, 1};
    double Z[3], before[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    int level, k, l;
    for (level = 3; level <= 5; level++) {
        shape s = shape_icosphere(level);
        hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
        hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        CHECK(hd_heat_trace(heat, 3, t, Z, NULL, NULL, NULL) == HD_OK);
        for (k = 0; k < 3; k++) {
            double want = 0, off;
            for (l = 0; l < 60; l++) want += (2 * l + 1) * exp(-l * (l + 1) * t[k]);
            off = fabs(Z[k] / want - 1);
            CHECK_MSG(off <= 0.3 * before[k] && (level < 5 || off < 2e-3), "level %d, t %g: off by %g, before %g", level, t[k], off, before[k]);
            before[k] = off;
        }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        shape_free(&s);
    }
}

/* A grid torus of springs: eigenvalues 4 - 2 cos - 2 cos, to rounding of the poles. */
static void sign_torus(void) {
    enum { A = 17, C = 12, N = A * C };
    int32_t i[6 * N], j[6 * N], k, p, q;
    double v[6 * N], mass[N], t[4] = {0.1, 1, 10, 60}, Z[4], bound[4];
    hd_laplacian *lap = NULL;
    hd_heat *heat;
    hd_csr L, B;
    for (k = 0; k < N; k++) {
        mass[k] = 1;
        i[3 * k] = j[3 * k] = i[3 * k + 1] = i[3 * k + 2] = k;
        j[3 * k + 1] = k / A * A + (k + 1) % A;
        j[3 * k + 2] = (k + A) % N;
        v[3 * k] = 4;
        v[3 * k + 1] = v[3 * k + 2] = -1;
    }
    L = test_symmetric_csr(N, 3 * N, i, j, v);
    B = test_diagonal_csr(N, mass);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, NULL) == HD_OK);
    heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    CHECK(hd_heat_trace(heat, 4, t, Z, bound, NULL, NULL) == HD_OK);
    for (k = 0; k < 4; k++) {
        double want = 0;
        for (p = 0; p < A; p++)
            for (q = 0; q < C; q++) want += exp(-t[k] * (4 - 2 * cos(2 * SIGN_PI * p / A) - 2 * cos(2 * SIGN_PI * q / C)));
        CHECK_MSG(fabs(Z[k] - want) <= bound[k] && fabs(Z[k] - want) <= 1e-7 * want, "t %g: off by %g, bound %g", t[k], Z[k] / want - 1, bound[k] / want);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
}

/* Without weights on the edge of two vertices, both eigenvalues are 0: of two constants if B is diagonal; if it joins the vertices, one of them
 * belongs to no constant. No time belongs to either. */
static void sign_times_of_nothing(void) {
    int64_t row_ptr[3] = {0, 2, 4}, diagonal[3] = {0, 1, 2};
    int32_t col[4] = {0, 1, 0, 1}, one[2] = {0, 1};
    double zero[4] = {0, 0, 0, 0}, mass[2] = {1, 1}, full[4] = {1, 0.1, 0.1, 1}, c = 1, t = -7;
    hd_csr L, B;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&L, 0, sizeof L);
    L.n_rows = L.n_cols = 2;
    B = L;
    L.nnz = 4;
    L.row_ptr = row_ptr;
    L.col = col;
    L.val = zero;
    B.nnz = 2;
    B.row_ptr = diagonal;
    B.col = one;
    B.val = mass;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, &e) == HD_OK && lap->n_components == 2);
    CHECK(hd_times_spectral(lap, 1, &c, &t, &e) == HD_ERR_ARGUMENT && strstr(e.text, "those of constants") && t == -7);
    hd_laplacian_free(lap);
    B = L;
    B.val = full;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, &e) == HD_OK && lap->n_components == 1);
    CHECK(hd_times_spectral(lap, 1, &c, &t, &e) == HD_ERR_BREAKDOWN && strstr(e.text, "lost in rounding") && t == -7);
    hd_laplacian_free(lap);
}

static void sign_suitable_times(void) {
    shape s = shape_icosphere(2);
    const double apart[3] = {3, 0, 0}, c[2] = {1, 0.1};
    shape two = shape_disjoint(&s, &s, apart);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM), *both = test_laplacian(&two, HD_LAPLACIAN_VORONOI_COT);
    heat_case k = heat_case_of(test_laplacian(&s, HD_LAPLACIAN_FEM), "times"), pair = heat_case_of(both, "times of two");
    double t[5], first = HUGE_VAL, top = 0;
    int32_t q;
    hd_error e;
    CHECK(hd_times_auto(lap, 5, t, &e) == HD_OK && fabs(t[0] / (0.0024 * lap->area) - 1) < 1e-12 && fabs(t[4] / (0.37 * lap->area) - 1) < 1e-12);
    for (q = 1; q < 4; q++) CHECK(fabs(t[q] * t[q] / (t[q - 1] * t[q + 1]) - 1) < 1e-12);
    CHECK(hd_times_auto(lap, 1, &top, NULL) == HD_OK && fabs(top / t[2] - 1) < 1e-12);
    CHECK(hd_times_auto(lap, 0, t, &e) == HD_ERR_ARGUMENT && hd_times_auto(NULL, 1, t, &e) == HD_ERR_ARGUMENT && hd_times_auto(lap, 1, NULL, &e) == HD_ERR_ARGUMENT);
    for (q = 0; q < k.pair.n; q++) first = k.pair.lambda[q] > 0 ? fmin(first, k.pair.lambda[q]) : first;
    CHECK(hd_times_spectral(lap, 2, c, t, &e) == HD_OK);
    CHECK_MSG(fabs(t[0] * first - 1) < 1e-9 && fabs(t[1] * first - 0.1) < 1e-9, "%g, %g", t[0] * first, t[1] * first);
    for (first = HUGE_VAL, q = 0; q < pair.pair.n; q++) first = pair.pair.lambda[q] > 0 ? fmin(first, pair.pair.lambda[q]) : first;
    CHECK(hd_times_spectral(both, 1, c, t, &e) == HD_OK && fabs(t[0] * first - 1) < 1e-9);
    CHECK(hd_times_spectral(both, 0, c, t, &e) == HD_ERR_ARGUMENT && hd_times_spectral(both, 1, NULL, t, &e) == HD_ERR_ARGUMENT);
    for (q = 0; q < 4; q++) {
        const double wrong[4] = {0, -1, (double)NAN, (double)INFINITY};
        const double two[2] = {1, wrong[q]};
        CHECK(hd_times_spectral(both, 2, two, t, &e) == HD_ERR_ARGUMENT && e.column == 1);
    }
    heat_case_free(&k);
    heat_case_free(&pair);
    hd_laplacian_free(lap);
    shape_free(&s);
    shape_free(&two);
}

static void sign_errors(const hd_laplacian *lap) {
    const double t[2] = {0.1, 0}, good = 0.1;
    double *D = DENSE_NEW(double, 3 * lap->n), Z[2];
    hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0), *krylov = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
    hd_error e;
    CHECK(hd_heat_trace(heat, 2, t, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.column == 1);
    CHECK(hd_heat_trace(heat, 1, t, NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_trace(NULL, 1, t, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_trace(krylov, 1, t, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_normalised(krylov, 1, t, D, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_normalised(heat, 2, t, D, 0, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_normalised(heat, 1, &good, D, 1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_normalised(heat, 1, &good, NULL, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_scale_invariant(heat, 0, 1, 9, 3, D, 0, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_scale_invariant(heat, 1, 1, 9, 3, D, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_scale_invariant(heat, 1, 2, 2, 1, D, 0, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_scale_invariant(heat, 1, 2, 4, 3, D, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_scale_invariant(heat, 1, 2, 5, 3, NULL, 0, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_scale_invariant(heat, 0.1, 2, 5, 3, D, 0, NULL, &e) == HD_OK);
    hd_heat_free(heat);
    hd_heat_free(krylov);
    free(D);
}

/* ---- limits, cancelling, threads ---- */

enum { SIGN_QUERIES = 7, SIGN_OUT = 8 };

/* One of the new queries with a context, on a mesh of n vertices; out [SIGN_OUT n]. */
static hd_status sign_query(hd_context *ctx, const shape *s, int which, double *out) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    hd_heat_opts o = eng_opts(which < 6 && which > 2 ? HD_METHOD_DIRECT : methods[which % 3]);
    hd_laplacian_opts l = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 0, NULL);
    const double t[3] = {0.05, 0.2, 1};
    double *f = DENSE_NEW(double, s->n);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_status st;
    int32_t v;
    for (v = 0; v < s->n; v++) f[v] = cos(0.7 * v);
    memset(out, 0, SIGN_OUT * (size_t)s->n * sizeof *out);
    l.context = ctx;
    st = hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, &l, NULL);
    if (st >= 0) st = hd_heat_create(&heat, lap, &o, NULL);
    if (st >= 0 && which < 3) st = hd_heat_derivative(heat, 3, t, 1, f, 0, out, 0, NULL, NULL);
    else if (st >= 0 && which == 3) st = hd_heat_trace(heat, 3, t, out, out + 3, NULL, NULL);
    else if (st >= 0 && which == 4) st = hd_heat_normalised(heat, 3, t, out, 0, NULL, NULL);
    else if (st >= 0 && which == 5) st = hd_heat_scale_invariant(heat, 0.01, 10, 9, 3, out, 0, NULL, NULL);
    else if (st >= 0) st = hd_heat_adjoint(heat, 3, t, 1, f, 0, out, 0, NULL, NULL);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(f);
    return st;
}

typedef struct sign_stop { int left; } sign_stop;

static hd_progress sign_progress(void *user, const char *stage, double done) {
    sign_stop *s = (sign_stop *)user;
    (void)stage;
    (void)done;
    return s->left-- > 0 ? HD_PROGRESS_CONTINUE : HD_PROGRESS_CANCEL;
}

/* Every allocation fails in turn, and every look at progress cancels: nothing stays. Bits do not depend on threads. */
static void sign_limits(void) {
    shape s = shape_icosphere(1), large = shape_icosphere(4);
    double *one = DENSE_NEW(double, SIGN_OUT * large.n), *three = DENSE_NEW(double, SIGN_OUT * large.n);
    int which, k;
    for (which = 0; which < SIGN_QUERIES; which++) {
        hd_context ctx;
        hd_status st = HD_ERR_MEMORY_LIMIT;
        sign_stop stop;
        for (k = 1; st < 0 && k < 2000; k++) {
            memset(&ctx, 0, sizeof ctx);
            ctx.n_threads = 1;
            ctx.allocation_limit = (uint64_t)k;
            st = sign_query(&ctx, &s, which, one);
            CHECK_MSG((st >= 0 || st == HD_ERR_MEMORY_LIMIT) && ctx.bytes_in_use == 0, "query %d, %d allocations: %s, %llu bytes stay", which, k,
                hd_status_name(st), (unsigned long long)ctx.bytes_in_use);
        }
        CHECK(st >= 0 && k > 10);
        for (st = HD_ERR_CANCELLED, k = 0; st < 0 && k < 2000; k++) {
            memset(&ctx, 0, sizeof ctx);
            ctx.progress = sign_progress;
            ctx.progress_user = &stop;
            stop.left = k;
            st = sign_query(&ctx, &s, which, one);
            CHECK_MSG((st >= 0 || st == HD_ERR_CANCELLED) && ctx.bytes_in_use == 0, "query %d, look %d: %s", which, k, hd_status_name(st));
        }
        CHECK(st >= 0 && k > 3);
        memset(&ctx, 0, sizeof ctx);
        ctx.n_threads = 1;
        CHECK(sign_query(&ctx, &large, which, one) >= 0);
        memset(&ctx, 0, sizeof ctx);
        ctx.n_threads = 3;
        CHECK(sign_query(&ctx, &large, which, three) >= 0 && memcmp(one, three, SIGN_OUT * (size_t)large.n * sizeof *one) == 0);
    }
    free(one);
    free(three);
    shape_free(&s);
    shape_free(&large);
}

/* The report of traces says how they were found. */
static void sign_report(void) {
    shape s = shape_bumpy(2, 5);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double t = 3 * lap->h * lap->h;
    double Z;
    hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    hd_report rep;
    CHECK(hd_heat_trace(heat, 1, &t, &Z, NULL, &rep, NULL) == HD_OK);
    CHECK_MSG(rep.method == HD_METHOD_DIRECT && rep.factor_nnz >= lap->n && strstr(rep.reason, "selected inversion") != NULL, "%s", rep.reason);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void test_signatures(void) {
    sign_report();
    shape ball = shape_icosphere(2), bumpy = shape_bumpy(2, 3), disk = bord_disk(5, 1), inert = eng_with_inert(&ball);
    const double apart[3] = {4, 1, 0};
    shape two = shape_disjoint(&disk, &ball, apart);
    const int32_t held[1] = {7};
    const hd_laplacian_opts border = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 0, NULL);
    const hd_laplacian_opts some = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 1, held);
    heat_case c[7];
    int k, n = 0;
    c[n++] = heat_case_of(test_laplacian(&bumpy, HD_LAPLACIAN_FEM), "bumpy, fem");
    c[n++] = heat_case_of(test_laplacian(&ball, HD_LAPLACIAN_COT), "ball, cot");
    c[n++] = heat_case_of(test_laplacian(&two, HD_LAPLACIAN_VORONOI_COT), "two components");
    c[n++] = heat_case_of(test_laplacian(&inert, HD_LAPLACIAN_FEM), "with inert vertices");
    c[n++] = heat_case_of(bord_triangles(&two, &some), "one of two held");
    c[n++] = heat_case_of(bord_triangles(&disk, &border), "Dirichlet border");
    c[n++] = heat_case_of(eng_leaking(9, 8), "leaking");
    for (k = 0; k < n; k++) {
        static const int components[5] = {1, 1, 2, 1, 1};
        if (k < 5) sign_traces(c + k);
        if (k < 5) sign_late(c + k, components[k]);
        if (k < 5) sign_normalised(c + k);
        if (k == 0) sign_errors(c[k].lap);
        heat_case_free(c + k);
    }
    sign_invariant(&bumpy, HD_LAPLACIAN_FEM);
    sign_invariant(&ball, HD_LAPLACIAN_VORONOI_COT);
    sign_sphere();
    sign_torus();
    sign_suitable_times();
    sign_times_of_nothing();
    sign_limits();
    shape_free(&ball);
    shape_free(&bumpy);
    shape_free(&disk);
    shape_free(&inert);
    shape_free(&two);
}

#endif
