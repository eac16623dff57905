/* test_signatures.h - heat traces, alone and with diagonals, and times that suit a surface */

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
    static const char *const plans[2] = {"method=direct poles=uniform degree=14", "method=direct poles=kernel degree=14"};
    static const hd_pole_kind kinds[2] = {HD_POLES_UNIFORM, HD_POLES_KERNEL};
    double t[SIGN_TIMES], Z[3], bound[3];
    hd_report rep;
    int set, k;
    sign_times(w, t);
    for (set = 0; set < 2; set++) {
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
    const int32_t n = sign_pair(w)->n;
    const hd_status want = components ? HD_OK : HD_WARN_ACCURACY;
    double Z[3], bound[3], both[3], loose[3], *D = KIT_NEW(double, 6 * n), *alone = D + 3 * n;
    hd_heat *heat = kit_heat(sign_pair(w), "");
    hd_report rep, own;
    int k, q;
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 3, t, NULL, 0, Z, bound, NULL, NULL) == want);
    CHECK_MSG(Z[1] == components, "%s: %g", w->text, Z[1]);
    for (k = 0; k < 3; k++) CHECK(fabs(Z[k] - sign_trace(w, t[k])) <= bound[k] + 1e-15 * Z[k]);
    for (q = 0; q < 2; q++) {
        CHECK(hd_heat_diagonal(heat, (hd_kernel)q, 3, t, D, 0, both, loose, &rep, NULL) == want);
        CHECK(hd_heat_diagonal(heat, (hd_kernel)q, 3, t, alone, 0, NULL, NULL, &own, NULL) == want);
        for (k = 0; k < 3; k++) {
            CHECK(fabs(both[k] - sign_trace(w, t[k])) <= loose[k] + 1e-15 * Z[k]);
            CHECK_MSG(dense_max_diff(D + k * n, alone + k * n, n) <= fmin(2e-6, rep.error_bound + own.error_bound + 1e-15) * dense_max_abs(alone + k * n, n),
                      "%s, kernel %d, t %g: %g from those alone, bounds %g, %g", w->text, q, t[k], dense_max_diff(D + k * n, alone + k * n, n), rep.error_bound,
                      own.error_bound);
        }
    }
}

/* Diagonals and traces of one call are those of two, within the bounds of both; divided by each other, they are those of the truth. */
static void sign_together(trial_work *w, double most) {
    const hd_laplacian *lap = sign_pair(w);
    const int32_t n = lap->n;
    double t[SIGN_TIMES], Z[SIGN_TIMES], bound[SIGN_TIMES], one[SIGN_TIMES], loose[SIGN_TIMES], *D = KIT_NEW(double, SIGN_TIMES * (n + 2)),
        *alone = KIT_NEW(double, SIGN_TIMES * n), off;
    hd_report rep, own;
    hd_error e;
    int32_t v;
    int q, kernel;
    sign_times(w, t);
    for (kernel = 0; kernel < 2; kernel++) {
        hd_heat *heat = kit_heat(lap, "");
        for (v = 0; v < SIGN_TIMES * (n + 2); v++) D[v] = 77;
        CHECK_MSG(hd_heat_diagonal(heat, (hd_kernel)kernel, SIGN_TIMES, t, D, (size_t)n + 2, Z, bound, &rep, &e) == HD_OK, "%s: %s", w->text, e.text);
        CHECK(hd_heat_diagonal(heat, (hd_kernel)kernel, SIGN_TIMES, t, alone, 0, NULL, NULL, &own, NULL) == HD_OK);
        CHECK(hd_heat_diagonal(heat, (hd_kernel)kernel, SIGN_TIMES, t, NULL, 0, one, loose, NULL, NULL) == HD_OK);
        CHECK_MSG(rep.error_bound <= most && own.error_bound <= most, "%s: bounds %g, %g", w->text, rep.error_bound, own.error_bound);
        for (q = 0; q < SIGN_TIMES; q++) {
            const double *d = D + q * (n + 2), want_Z = sign_trace(w, t[q]);
            double worst = 0, apart = 0, largest = dense_max_abs(alone + q * n, n);
            CHECK(d[n] == 77 && d[n + 1] == 77);
            CHECK_MSG(fabs(Z[q] - want_Z) <= bound[q] + 1e-15 * want_Z && bound[q] <= most * want_Z, "%s, kernel %d, t %g: trace off by %g, bound %g",
                      w->text, kernel, t[q], fabs(Z[q] / want_Z - 1), bound[q] / want_Z);
            CHECK(fabs(Z[q] - one[q]) <= bound[q] + loose[q] + 1e-15 * want_Z && loose[q] <= most * want_Z);
            trial_filter_for(w, t[q], 0);
            for (v = 0; v < n; v++) {
                const double want = (double)trial_want_entry(w, v, v, 0, kernel == HD_KERNEL_OPERATOR, kernel == HD_KERNEL_OPERATOR, &off);
                apart = fmax(apart, fabs(d[v] - alone[q * n + v]));
                if (lap->row[v] < 0) CHECK(d[v] == want);
                else worst = fmax(worst, fabs(d[v] / Z[q] / (want / want_Z) - 1));
            }
            CHECK_MSG(apart <= (rep.error_bound + own.error_bound + 1e-15) * largest, "%s, kernel %d, t %g: %g from those alone, of %g", w->text, kernel, t[q],
                      apart, largest);
            CHECK_MSG(worst <= rep.error_relative + bound[q] / Z[q] + 1e-13 && (worst <= most / 5 || kernel == HD_KERNEL_OPERATOR), "%s, kernel %d, t %g: off by %g, bounds %g, %g",
                      w->text, kernel, t[q], worst, rep.error_relative, bound[q] / Z[q]);
        }
        for (q = 0; q < SIGN_TIMES; q += 5) {    /* one time, by poles of its own */
            CHECK(hd_heat_diagonal(heat, (hd_kernel)kernel, 1, t + q, alone, 0, one, loose, &own, NULL) == HD_OK);
            CHECK(dense_max_diff(alone, D + q * (n + 2), n) <= (rep.error_bound + own.error_bound + 1e-15) * dense_max_abs(alone, n));
            CHECK(fabs(one[0] - Z[q]) <= loose[0] + bound[q] + 1e-15 * Z[q]);
        }
    }
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
        sign_together(w, pairs[k].most);
        kit_release(mark);
    }
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
 * belongs to no constant. */
static void sign_zeros(void) {
    int64_t row_ptr[3] = {0, 2, 4}, diagonal[3] = {0, 1, 2};
    int32_t col[4] = {0, 1, 0, 1}, one[2] = {0, 1}, full;
    double zero[4] = {0, 0, 0, 0}, mass[2] = {1, 1}, joined[4] = {1, 0.1, 0.1, 1};
    for (full = 0; full < 2; full++) {
        hd_csr L = sparse_view(2, 2, 4, row_ptr, col, zero), B = full ? sparse_view(2, 2, 4, row_ptr, col, joined) : sparse_view(2, 2,
            2, diagonal, one, mass);
        hd_laplacian *lap = NULL;
        hd_spectrum *s = NULL;
        hd_spectrum_opts o;
        hd_error e;
        memset(&o, 0, sizeof o);
        o.count = 2;
        CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, &e) == HD_OK && lap->n_components == 2 - full);
        if (CHECK_MSG(hd_spectrum_create(&s, lap, &o, &e) >= 0, "%s", e.text))
            CHECK_MSG(s->count == 2 && s->n_constant == 2 - full && fabs(s->value[0]) < 1e-12 && fabs(s->value[1]) < 1e-12, "%d: %d, %g, %g",
                      (int)full, (int)s->n_constant, s->value[0], s->value[1]);
        hd_spectrum_free(s);
        hd_laplacian_free(lap);
    }
}

static void sign_suitable_times(void) {
    static const char *const texts[2] = {"shape=bumpy/1/3 op=fem", "shape=two/2/0.3/4 op=vor"};
    const hd_laplacian *lap = kit_pair("ico/2 fem");
    double t[5], top = 0;
    int32_t q;
    hd_error e;
    CHECK(hd_times_auto(lap, 5, t, &e) == HD_OK && fabs(t[0] / (0.0024 * lap->area) - 1) < 1e-12 &&
          fabs(t[4] / (0.37 * lap->area) - 1) < 1e-12);
    for (q = 1; q < 4; q++) CHECK(fabs(t[q] * t[q] / (t[q - 1] * t[q + 1]) - 1) < 1e-12);
    CHECK(hd_times_auto(lap, 1, &top, NULL) == HD_OK && fabs(top / t[2] - 1) < 1e-12);
    for (q = 0; q < 2; q++) {
        const trial_work *w = case_truth_of(texts[q]);
        hd_spectrum *s = NULL;
        hd_spectrum_opts o;
        memset(&o, 0, sizeof o);
        o.count = 3;
        if (CHECK(hd_spectrum_create(&s, sign_pair(w), &o, &e) == HD_OK && s->n_constant == q + 1))
            CHECK_MSG(fabs(s->value[s->n_constant] / sign_first(w) - 1) < 1e-9, "%g", s->value[s->n_constant] / sign_first(w));
        hd_spectrum_free(s);
    }
    CHECK(hd_times_auto(lap, 0, t, &e) == HD_ERR_ARGUMENT && hd_times_auto(NULL, 1, t, &e) == HD_ERR_ARGUMENT &&
          hd_times_auto(lap, 1, NULL, &e) == HD_ERR_ARGUMENT);
}

/* ---- what is told, and refused ---- */

/* The report of traces says how they were found. Refusals that the group doors does not have: the second time, and short columns. */
static void sign_report(void) {
    const hd_laplacian *lap = kit_pair("bumpy/2/5 fem");
    const double t = 3 * lap->h * lap->h, ending[2] = {t, 0};
    hd_heat *heat = kit_heat(lap, ""), *krylov = kit_heat(lap, "method=krylov");
    double Z[2], bound[2], *D = KIT_NEW(double, 3 * lap->n);
    hd_report rep;
    hd_error e;
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &t, NULL, 0, Z, NULL, &rep, NULL) == HD_OK);
    CHECK(rep.evidence_rational == HD_EVIDENCE_PROVEN && rep.evidence_rounding == HD_EVIDENCE_MEASURED);
    CHECK_MSG(rep.method == HD_METHOD_DIRECT && rep.factor_nnz >= lap->n && strstr(rep.reason, "selected inversion") != NULL, "%s",
              rep.reason);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 2, ending, NULL, 0, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.column == 1);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 2, ending, D, 0, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.column == 1 &&
          hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, D, 1, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT &&
          hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, NULL, 0, NULL, bound, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_diagonal(krylov, HD_KERNEL_OPERATOR, 1, &t, NULL, 0, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT &&
          hd_heat_diagonal(krylov, HD_KERNEL_SYMMETRIC, 1, &t, D, 0, Z, NULL, NULL, &e) == HD_ERR_ARGUMENT);
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
           : which < 6  ? hd_heat_diagonal(heat, which == 4 ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, 3, t, out, 0, out + 3 * s->n, out + 4 * s->n, NULL, NULL)
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
    sign_zeros();
    sign_threads();
}

#endif
