/* test_signatures.h - heat traces, normalised and scale-invariant signatures, and times that suit a surface */

#ifndef TEST_SIGNATURES_H
#define TEST_SIGNATURES_H

enum { SIGN_TIMES = 12 };

static const hd_laplacian *sign_pair(const trial_work *w) { return w->s->lap; }

/* The trace of the truth. */
static double sign_trace(const trial_work *w, double t) {
    double sum = 0;
    int32_t l;
    for (l = 0; l < w->T->n; l++) sum += exp(-t * (double)w->T->lambda[l]);
    return sum;
}

/* The smallest eigenvalue of the truth that is not zero. */
static double sign_first(const trial_work *w) {
    double first = HUGE_VAL;
    int32_t l;
    for (l = 0; l < w->T->n; l++)
        if (w->T->lambda[l] > 0) first = fmin(first, (double)w->T->lambda[l]);
    return first;
}

/* Times over three decades, in no order. */
static void sign_times(const trial_work *w, double *t) {
    int k;
    for (k = 0; k < SIGN_TIMES; k++) t[k] = 3 / w->T->top * pow(10, 0.27 * ((5 * k) % SIGN_TIMES));
}

/* Within the bounds, which are no larger than most of it: by shared poles, at one time, by the operator's diagonal. */
static void sign_traces(const trial_work *w, double most) {
    const hd_laplacian *lap = sign_pair(w);
    double t[SIGN_TIMES], Z[SIGN_TIMES], bound[SIGN_TIMES], one, relative, *diag = KIT_NEW(double, lap->n);
    hd_heat *heat = kit_heat(lap, "");
    hd_report rep;
    hd_error e;
    int k;
    int32_t v;
    sign_times(w, t);
    CHECK_MSG(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, SIGN_TIMES, t, NULL, 0, Z, bound, &rep, &e) == HD_OK, "%s: %s", w->text, e.text);
    for (k = 0; k < SIGN_TIMES; k++) {
        const double want = sign_trace(w, t[k]), off = fabs(Z[k] - want);
        double sum = 0;
        CHECK_MSG(off <= 1e-7 * want && off <= bound[k] + 1e-15 * want && bound[k] <= most * want,
                  "%s, t %g: trace off by %g, bound %g", w->text,
                  t[k], off / want, bound[k] / want);
        CHECK_MSG(bound[k] <= 1.0001 * rep.error_relative * Z[k] && rep.error_relative < most &&
                  rep.error_bound <= 1.0001 * rep.error_relative,
                  "%s: %g, %g", w->text, rep.error_relative, rep.error_bound);
        CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, t + k, NULL, 0, &one, &relative, NULL, NULL) == HD_OK && fabs(one - want) <= relative + 1e-15 * want);
        CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, t + k, diag, 0, NULL, NULL, NULL, NULL) >= 0);
        for (v = 0; v < lap->n; v++) sum += lap->row[v] >= 0 ? diag[v] : 0;
        CHECK_MSG(fabs(one - sum) <= 1e-7 * want, "%s, t %g: the diagonal's sum differs by %g", w->text, t[k], (one - sum) / want);
    }
}

/* By each kind of poles. */
static void sign_sets(const trial_work *w) {
    static const char *const plans[3] = {"method=direct poles=uniform degree=14", "method=direct poles=kernel degree=14",
        "method=direct poles=diagonal degree=14"};
    static const hd_pole_kind kinds[3] = {HD_POLES_UNIFORM, HD_POLES_KERNEL, HD_POLES_DIAGONAL};
    double t[SIGN_TIMES], Z[3], bound[3];
    hd_report rep;
    int set, k;
    sign_times(w, t);
    for (set = 0; set < 3; set++) {
        CHECK(hd_heat_diagonal(kit_heat(sign_pair(w), plans[set]), HD_KERNEL_OPERATOR, 3, t, NULL, 0, Z, bound, &rep, NULL) >= 0 && rep.poles == kinds[set]);
        for (k = 0; k < 3; k++) {
            const double want = sign_trace(w, t[k]);
            CHECK_MSG(fabs(Z[k] - want) <= bound[k] + 1e-15 * want && fabs(Z[k] - want) <= 1e-9 * want,
                      "%s, %s: trace off by %g, bound %g", w->text,
                      plans[set], fabs(Z[k] - want) / want, bound[k] / want);
        }
    }
}

/* Late times: the number of components that keep their heat. */
static void sign_late(const trial_work *w, int components) {
    const double t[3] = {1 / w->T->top, 1e25 / w->T->top, 100 / w->T->top};
    double Z[3], bound[3];
    int k;
    CHECK(hd_heat_diagonal(kit_heat(sign_pair(w), ""), HD_KERNEL_OPERATOR, 3, t, NULL, 0, Z, bound, NULL, NULL) == (components ? HD_OK : HD_WARN_ACCURACY));
    CHECK_MSG(Z[1] == components, "%s: %g", w->text, Z[1]);
    for (k = 0; k < 3; k++) CHECK(fabs(Z[k] - sign_trace(w, t[k])) <= bound[k] + 1e-15 * Z[k]);
}

static void sign_normalised(trial_work *w, double most) {
    const hd_laplacian *lap = sign_pair(w);
    const int32_t n = lap->n;
    double t[SIGN_TIMES], *D = KIT_NEW(double, SIGN_TIMES * (n + 2));
    hd_report rep;
    hd_error e;
    int32_t v;
    int q;
    sign_times(w, t);
    CHECK_MSG(hd_heat_normalised(kit_heat(lap, ""), SIGN_TIMES, t, D, (size_t)n + 2, &rep, &e) == HD_OK, "%s: %s", w->text, e.text);
    CHECK(rep.error_relative <= 2 * most && rep.error_bound <= rep.error_relative && rep.error_bound_b == HUGE_VAL);
    for (q = 0; q < SIGN_TIMES; q++) {
        const double *d = D + q * (n + 2), Z = sign_trace(w, t[q]);
        double worst = 0, off;
        trial_filter_for(w, t[q], 0);
        for (v = 0; v < n; v++) {
            const double want = (double)trial_want_entry(w, v, v, 0, 0, 0, &off) / Z;
            if (lap->row[v] < 0) CHECK(d[v] == 0);
            else worst = fmax(worst, fabs(d[v] / want - 1));
        }
        CHECK_MSG(worst <= most / 5 && worst <= rep.error_relative + 1e-13, "%s, t %g: off by %g, bound %g", w->text, t[q], worst,
                  rep.error_relative);
    }
}

/* Against the definition, by signatures of the truth; within the bound; and nearly the same after scaling. */
static void sign_invariant(const char *text) {
    enum { N = 65, FREQ = 6 };
    trial_work *w = case_truth_of(text);
    const hd_laplacian *lap = sign_pair(w);
    const int32_t n = lap->n;
    const double t0 = 1e-6 * lap->area, t1 = 1e4 * lap->area;
    double *D = KIT_NEW(double, FREQ * n), *E = KIT_NEW(double, FREQ * n), *logs = KIT_NEW(double, N * n), largest = 0, off = 0,
        moved, one;
    hd_laplacian *big = NULL;
    hd_report rep;
    int32_t v, k, j;
    CHECK(hd_heat_scale_invariant(kit_heat(lap, ""), t0, t1, N, FREQ, D, 0, &rep, NULL) == HD_OK);
    for (j = 0; j < N; j++) {
        trial_filter_for(w, t0 * pow(t1 / t0, j / (N - 1.0)), 0);
        for (v = 0; v < n; v++) logs[v * N + j] = log((double)trial_want_entry(w, v, v, 0, 0, 0, &one));
    }
    for (v = 0; v < n; v++)
        for (k = 0; k < FREQ; k++) {
            double re = 0, im = 0;
            for (j = 0; j + 1 < N; j++) {
                re += (logs[v * N + j + 1] - logs[v * N + j]) * cos(2 * heat_pi * j * k / (N - 1));
                im += (logs[v * N + j + 1] - logs[v * N + j]) * sin(2 * heat_pi * j * k / (N - 1));
            }
            largest = fmax(largest, hypot(re, im));
            off = fmax(off, fabs(hypot(re, im) - D[k * n + v]));
        }
    CHECK_MSG(off <= (rep.error_bound + 1e-12) * largest && off <= 1e-6 * largest && rep.error_bound < 1e-5, "off by %g, bound %g",
              off / largest, rep.error_bound);
    CHECK(rep.error_bound >= rep.error_rational && rep.error_relative == HUGE_VAL);
    CHECK(trial_pair(&big, w->c->shape, w->c->op, 1.7, NULL) == HD_OK);
    kit_keep(big, kit_free_laplacian);
    CHECK(hd_heat_scale_invariant(kit_heat(big, ""), t0, t1, N, FREQ, E, 0, NULL, NULL) == HD_OK);
    moved = dense_max_diff(E, D, FREQ * n);
    CHECK_MSG(moved <= 0.01 * largest && moved > 0, "scaling moves it by %g", moved / largest);
}

/* What is computed of each, and how many of its components keep their heat. */
static void sign_against_truth(void) {
    static const struct { const char *text; int components; double most; } pairs[] = {
        {"shape=bumpy/1/3 op=fem", 1, 1e-6}, {"shape=ico/1 op=cot", 1, 1e-6}, {"shape=two/2/0.3/4 op=vor", 2, 1e-6}, {"shape=spare/3/1 op=fem", 1, 1e-6},
        {"shape=two/2/0.3/4 op=vor+pin", 1, 1e-5}, {"shape=disk/4/1 op=fem+held", 0, 1e-6}, {"shape=leak/30/0.01 op=I", 0, 1e-6},
        {"shape=drain/20/0.5 op=tri", 0, 1e-6},
    };
    int k;
    for (k = 0; k < 8; k++) {
        const int32_t mark = kit_mark();
        trial_work *w = case_truth_of(pairs[k].text);
        sign_traces(w, pairs[k].most);
        if (pairs[k].components) sign_sets(w);
        sign_late(w, pairs[k].components);
        sign_normalised(w, pairs[k].most);
        kit_release(mark);
    }
    sign_invariant("shape=bumpy/1/3 op=fem");
    sign_invariant("shape=ico/1 op=vor");
}

/* ---- closed forms ---- */

/* The trace of the unit sphere, sum (2l + 1) exp(-l (l + 1) t), is met as the mesh gets finer. */
static void sign_sphere(void) {
    static const double t[3] = {0.1, 0.3, 1};
    static const char *const pairs[3] = {"ico/3 fem", "ico/4 fem", "ico/5 fem"};
    double Z[3], before[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    int level, k, l;
    for (level = 0; level < 3 - CASES_FEW; level++) {
        CHECK(hd_heat_diagonal(kit_heat(kit_pair(pairs[level]), ""), HD_KERNEL_OPERATOR, 3, t, NULL, 0, Z, NULL, NULL, NULL) == HD_OK);
        for (k = 0; k < 3; k++) {
            double want = 0, off;
            for (l = 0; l < 60; l++) want += (2 * l + 1) * exp(-l * (l + 1) * t[k]);
            off = fabs(Z[k] / want - 1);
            CHECK_MSG(off <= 0.3 * before[k] && (level < 2 || off < 2e-3), "%s, t %g: off by %g, before %g", pairs[level], t[k], off,
                      before[k]);
            before[k] = off;
        }
    }
}

/* A grid torus of springs: eigenvalues 4 - 2 cos - 2 cos, to rounding of the poles. */
static void sign_torus(void) {
    enum { A = 17, C = 12 };
    static const double t[4] = {0.1, 1, 10, 60};
    double Z[4], bound[4];
    int k, p, q;
    CHECK(hd_heat_diagonal(kit_heat(kit_lattice(A, C, 1, 1, 1), ""), HD_KERNEL_OPERATOR, 4, t, NULL, 0, Z, bound, NULL, NULL) == HD_OK);
    for (k = 0; k < 4; k++) {
        double want = 0;
        for (p = 0; p < A; p++)
            for (q = 0; q < C; q++) want += exp(-t[k] * (4 - 2 * cos(2 * heat_pi * p / A) - 2 * cos(2 * heat_pi * q / C)));
        CHECK_MSG(fabs(Z[k] - want) <= bound[k] && fabs(Z[k] - want) <= 1e-7 * want, "t %g: off by %g, bound %g", t[k],
                  Z[k] / want - 1, bound[k] / want);
    }
}

/* ---- times ---- */

/* Without weights on the edge of two vertices, both eigenvalues are 0: of two constants if B is diagonal; if it joins the vertices, one of them
 * belongs to no constant. No time belongs to either. */
static void sign_times_of_nothing(void) {
    static const hd_status want[2] = {HD_ERR_ARGUMENT, HD_ERR_BREAKDOWN};
    static const char *const say[2] = {"those of constants", "lost in rounding"};
    int64_t row_ptr[3] = {0, 2, 4}, diagonal[3] = {0, 1, 2};
    int32_t col[4] = {0, 1, 0, 1}, one[2] = {0, 1}, full;
    double zero[4] = {0, 0, 0, 0}, mass[2] = {1, 1}, joined[4] = {1, 0.1, 0.1, 1}, c = 1, t = -7;
    for (full = 0; full < 2; full++) {
        hd_csr L = sparse_view(2, 2, 4, row_ptr, col, zero), B = full ? sparse_view(2, 2, 4, row_ptr, col, joined) : sparse_view(2, 2,
            2, diagonal, one, mass);
        hd_laplacian *lap = NULL;
        hd_error e;
        CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, &e) == HD_OK && lap->n_components == 2 - full);
        CHECK(hd_times_spectral(lap, 1, &c, &t, &e) == want[full] && strstr(e.text, say[full]) && t == -7);
        hd_laplacian_free(lap);
    }
}

static void sign_suitable_times(void) {
    static const char *const texts[2] = {"shape=bumpy/1/3 op=fem", "shape=two/2/0.3/4 op=vor"};
    const hd_laplacian *lap = kit_pair("ico/2 fem");
    const double c[2] = {1, 0.1}, wrong[4] = {0, -1, (double)NAN, (double)INFINITY};
    double t[5], top = 0;
    int32_t q;
    hd_error e;
    CHECK(hd_times_auto(lap, 5, t, &e) == HD_OK && fabs(t[0] / (0.0024 * lap->area) - 1) < 1e-12 &&
          fabs(t[4] / (0.37 * lap->area) - 1) < 1e-12);
    for (q = 1; q < 4; q++) CHECK(fabs(t[q] * t[q] / (t[q - 1] * t[q + 1]) - 1) < 1e-12);
    CHECK(hd_times_auto(lap, 1, &top, NULL) == HD_OK && fabs(top / t[2] - 1) < 1e-12);
    for (q = 0; q < 2; q++) {
        const trial_work *w = case_truth_of(texts[q]);
        CHECK(hd_times_spectral(sign_pair(w), 2, c, t, &e) == HD_OK);
        CHECK_MSG(fabs(t[0] * sign_first(w) - 1) < 1e-9 && fabs(t[1] * sign_first(w) - 0.1) < 1e-9, "%g, %g", t[0] * sign_first(w),
                  t[1] * sign_first(w));
    }
    CHECK(hd_times_auto(lap, 0, t, &e) == HD_ERR_ARGUMENT && hd_times_auto(NULL, 1, t, &e) == HD_ERR_ARGUMENT &&
          hd_times_auto(lap, 1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_times_spectral(lap, 0, c, t, &e) == HD_ERR_ARGUMENT && hd_times_spectral(lap, 1, NULL, t, &e) == HD_ERR_ARGUMENT);
    for (q = 0; q < 4; q++) {
        const double two[2] = {1, wrong[q]};
        CHECK(hd_times_spectral(lap, 2, two, t, &e) == HD_ERR_ARGUMENT && e.column == 1);
    }
}

/* ---- what is told, and refused ---- */

/* The report of traces says how they were found. Refusals that the group doors does not have: the second time, and short columns. */
static void sign_report(void) {
    const hd_laplacian *lap = kit_pair("bumpy/2/5 fem");
    const double t = 3 * lap->h * lap->h, ending[2] = {t, 0};
    hd_heat *heat = kit_heat(lap, ""), *krylov = kit_heat(lap, "method=krylov");
    double Z[2], *D = KIT_NEW(double, 3 * lap->n);
    hd_report rep;
    hd_error e;
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &t, NULL, 0, Z, NULL, &rep, NULL) == HD_OK);
    CHECK(rep.evidence_rational == HD_EVIDENCE_PROVEN && rep.evidence_rounding == HD_EVIDENCE_MEASURED);
    CHECK_MSG(rep.method == HD_METHOD_DIRECT && rep.factor_nnz >= lap->n && strstr(rep.reason, "selected inversion") != NULL, "%s",
              rep.reason);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 2, ending, NULL, 0, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.column == 1);
    CHECK(hd_heat_normalised(heat, 2, ending, D, 0, NULL, &e) == HD_ERR_ARGUMENT &&
          hd_heat_normalised(heat, 1, &t, D, 1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_diagonal(krylov, HD_KERNEL_OPERATOR, 1, &t, NULL, 0, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT && hd_heat_normalised(krylov, 1, &t, D, 0, NULL,
        &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_scale_invariant(heat, 1, 1, 9, 3, D, 0, NULL, &e) == HD_ERR_ARGUMENT &&
          hd_heat_scale_invariant(heat, 1, 2, 4, 3, D, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_scale_invariant(heat, 0.1, 2, 5, 3, D, 0, NULL, &e) == HD_OK);
}

/* One of the queries that share poles, or of their derivatives and adjoints by each method; out [8 n]. */
static void sign_query(hd_context *ctx, const shape *s, int which, double *out) {
    static const hd_method methods[7] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT, HD_METHOD_DIRECT,
        HD_METHOD_DIRECT,
                                         HD_METHOD_DIRECT};
    const double t[3] = {0.05, 0.2, 1}, *f = kit_random(s->n, 5);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_laplacian_opts l;
    hd_heat_opts o;
    memset(&l, 0, sizeof l);
    memset(&o, 0, sizeof o);
    l.context = ctx;
    o.method = methods[which];
    memset(out, 0, 8 * (size_t)s->n * sizeof *out);
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &l, NULL) == HD_OK &&
          hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    CHECK((which < 3    ? hd_heat_derivative(heat, 3, t, 1, f, 0, out, 0, NULL, NULL)
           : which == 3 ? hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 3, t, NULL, 0, out, out + 3, NULL, NULL)
           : which == 4 ? hd_heat_normalised(heat, 3, t, out, 0, NULL, NULL)
           : which == 5 ? hd_heat_scale_invariant(heat, 0.01, 10, 9, 3, out, 0, NULL, NULL)
                        : hd_heat_adjoint(heat, 3, t, 1, f, 0, out, 0, NULL, NULL)) >= 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

/* Bits do not depend on threads. */
static void sign_threads(void) {
    const shape *s = kit_shape("ico/4");
    double *out[2];
    int which, k;
    out[0] = KIT_NEW(double, 8 * s->n);
    out[1] = KIT_NEW(double, 8 * s->n);
    for (which = 0; which < 7; which++) {
        for (k = 0; k < 2; k++) {
            hd_context ctx;
            memset(&ctx, 0, sizeof ctx);
            ctx.n_threads = k ? 3 : 1;
            sign_query(&ctx, s, which, out[k]);
        }
        CHECK_MSG(memcmp(out[0], out[1], 8 * (size_t)s->n * sizeof(double)) == 0, "query %d", which);
    }
}

static void test_signatures(void) {
    sign_report();
    sign_against_truth();
    sign_sphere();
    sign_torus();
    sign_suitable_times();
    sign_times_of_nothing();
    sign_threads();
}

#endif
