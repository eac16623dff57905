/* test_adjoints.h - derivatives of K_t in time and its transpose: against the truth, differences and each other */

#ifndef TEST_ADJOINTS_H
#define TEST_ADJOINTS_H

/* ---- against the truth ---- */

/* Every method, direct with sets for training too. */
#define ADJ_EVERY(pairs, query, bound, sets) \
    {pairs query " method=auto|direct|krylov|iterative", bound, 0, 0}, {pairs query " method=direct poles=kernel degree=10|12", sets, 0, 0}, \
    {pairs query " method=krylov tol=1e-10", bound, 0, 0}, {pairs query " method=iterative solver=lanczos tol=1e-10", bound, 0, 0}

/* Fields of all kinds, at several times in one call, and without any. Constants with a ripple have next to no derivative: down to the
 * last digit and below. */
#define ADJ_PAIR(pairs, bound, sets, faint) \
    ADJ_EVERY(pairs, " query=derivative field=random|smooth|delta th=0.02|0.2|1", bound, sets), \
    ADJ_EVERY(pairs, " query=derivative field=smooth th=0.02 times=3 span=30", bound, sets), \
    ADJ_EVERY(pairs, " query=adjoint field=random|smooth|delta th=0.1|1 k=3 times=2 span=5", bound, sets), \
    ADJ_EVERY(pairs, " query=derivative|adjoint t=0|1e-25 field=random|smooth", 1e-11, 1e-11), \
    {pairs " query=derivative field=level th=0.1|1 method=auto|direct|iterative seed=10|20|30|40", 0, 0, faint}, \
    {pairs " query=derivative field=level th=0.1|1 method=iterative solver=cocg|minres|lanczos seed=10|20|30|40", 0, 0, faint}

#define ADJ_DRAIN "shape=drain/12/1e-3 op=heavy12|heavy16|heavy20 query=adjoint field=delta t=60 seed=1|2|3|4"

static const case_row adj_rows[] = {
    ADJ_PAIR("shape=bumpy/1/3 op=fem", 1e-7, 1e-5, 12),
    ADJ_PAIR("shape=ico/1 op=cot", 1e-7, 1e-5, 12),
    ADJ_PAIR("shape=two/1/0/5 op=vor", 1e-7, 1e-5, 10),
    ADJ_PAIR("shape=spare/3/1 op=fem", 1e-7, 1e-5, 15),
    ADJ_PAIR("shape=disk/4/1 op=fem+held", 1e-7, 1e-5, 0),
    ADJ_PAIR("shape=split/6/2 op=fem+pin", 1e-7, 1e-5, 0),
    ADJ_PAIR("shape=leak/30/1e-2 op=mass3", 1e-6, 2e-3, 0),
    /* nearly all mass at one vertex, which heat reaches from one other */
    {ADJ_DRAIN " method=auto|direct|krylov|iterative", 0, 0, 6},
    {ADJ_DRAIN " method=direct poles=kernel degree=10|12", 0, 0, 18},
    {ADJ_DRAIN " method=krylov tol=1e-10|1e-3", 0, 0, 6},
    {ADJ_DRAIN " method=iterative solver=lanczos tol=1e-10", 0, 0, 0},
    {ADJ_DRAIN " method=auto|iterative tol=1e-3", 0, 0, 12},
    {ADJ_DRAIN " method=iterative solver=lanczos tol=1e-3", 0, 0, 9},
    /* where iterations fail that auto has chosen, factors take over: the field has decayed by exp(-5) */
    {"shape=leak/40/1e-9 op=I query=derivative field=level seed=28|29|30|31|32 t=5.444e9 tol=1e-13", 0, 0, 5},
};

static void adj_cases(void) { CASES(adj_rows); }

/* ---- plans and fields ---- */

enum { ADJ_DIRECT, ADJ_TRAIN, ADJ_KRYLOV, ADJ_ITERATIVE, ADJ_LANCZOS, ADJ_AUTO, ADJ_PLANS, ADJ_FIELDS = 3 };
static const char *const adj_plans[ADJ_PLANS] = {"method=direct", "method=direct poles=kernel degree=10",
    "method=krylov tol=1e-10",
    "method=iterative", "method=iterative solver=lanczos tol=1e-10", "method=auto"};

/* A smooth field, a rough one, and a single vertex; vertices without a row have values too. */
static double *adj_fields(const hd_laplacian *lap, size_t ld) {
    double *f = DENSE_NEW(double, (int64_t)ld * ADJ_FIELDS);
    uint64_t seed = 5;
    int32_t v;
    for (v = 0; v < lap->n; v++) {
        const int32_t r = lap->row[v];
        f[v] = r >= 0 && lap->xyz ? lap->xyz[3 * r] + 2 * lap->xyz[3 * r + 1] + 3 : cos(0.3 * v) + 2;
        f[ld + (size_t)v] = dense_signed(&seed);
    }
    f[2 * ld + (size_t)lap->vertex[lap->n_active / 2]] = 1;
    return f;
}

/* ---- identities ---- */

/* <g, K f> = <K' g, f>, and with one set of poles to rounding. */
static void adj_duality(const hd_laplacian *lap, double t, const char *what) {
    const size_t n = (size_t)lap->n;
    double *f = (double *)kit_keep(adj_fields(lap, n), free), *u = KIT_NEW(double, n), *w = KIT_NEW(double, n);
    int which, pair;
    for (which = 0; which < ADJ_PLANS; which++) {
        const double want = which == ADJ_TRAIN ? 1e-13 : 1e-7;
        hd_heat *heat = kit_heat(lap, adj_plans[which]);
        for (pair = 0; pair < ADJ_FIELDS * ADJ_FIELDS; pair++) {
            const double *g = f + (size_t)(pair / ADJ_FIELDS) * n, *h = f + (size_t)(pair % ADJ_FIELDS) * n;
            double left = 0, right = 0, size = 0;
            size_t v;
            CHECK(hd_heat_apply(heat, 1, &t, 1, h, 0, u, 0, NULL, NULL) >= 0 && hd_heat_adjoint(heat, 1, &t, 1, g, 0, w, 0, NULL, NULL) >= 0);
            for (v = 0; v < n; v++) {
                left += g[v] * u[v];
                right += w[v] * h[v];
                size += fabs(g[v] * u[v]) + fabs(w[v] * h[v]);
            }
            CHECK_MSG(fabs(left - right) <= want * size, "%s, %s: %.17g and %.17g differ by %g", what, adj_plans[which], left,
                right, fabs(left - right) / size);
        }
    }
}

/* Central differences of K_t f at the highest degree. */
static void adj_differences(const hd_laplacian *lap, double t, const char *what) {
    const size_t n = (size_t)lap->n;
    const double step = 1e-4 * t, at[2] = {t - step, t + step};
    double *f = (double *)kit_keep(adj_fields(lap, n), free), *u = KIT_NEW(double, 2 * n), *w = KIT_NEW(double, n);
    hd_heat *heat = kit_heat(lap, "method=direct poles=kernel degree=14");
    int q;
    for (q = 0; q < ADJ_FIELDS; q++) {
        double most = 0, off = 0;
        size_t v;
        CHECK(hd_heat_apply(heat, 2, at, 1, f + (size_t)q * n, 0, u, 0, NULL, NULL) >= 0);
        CHECK(hd_heat_derivative(heat, 1, &t, 1, f + (size_t)q * n, 0, w, 0, NULL, NULL) >= 0);
        for (v = 0; v < n; v++) {
            off = fmax(off, fabs((u[n + v] - u[v]) / (2 * step) - w[v]));
            most = fmax(most, fabs(w[v]));
        }
        CHECK_MSG(off <= 1e-7 * most, "%s, field %d: differences are off by %g", what, q, off / most);
    }
}

/* Several fields and times in one call, with columns further apart than they need be, and one in place: the same as one by one, up to
 * the bounds of each; times may be 0; and what reports say. */
static void adj_calls(const hd_laplacian *lap, double unit, const char *what) {
    enum { TIMES = 3 };
    const size_t n = (size_t)lap->n, ldf = n + 3, ldu = n + 1;
    const double t[TIMES] = {3 * unit, 0, unit};
    double *f = (double *)kit_keep(adj_fields(lap, ldf), free), *u = KIT_NEW(double, ldu * ADJ_FIELDS * TIMES), *one = KIT_NEW(double, n);
    int which, adjoint, q;
    for (which = 0; which < 2 * ADJ_PLANS; which++) {
        hd_heat *heat = kit_heat(lap, adj_plans[which / 2]);
        hd_report rep;
        hd_status st;
        adjoint = which % 2;
        st = (adjoint ? hd_heat_adjoint : hd_heat_derivative)(heat, TIMES, t, ADJ_FIELDS, f, ldf, u, ldu, &rep, NULL);
        CHECK(st >= 0 && st == rep.status);
        for (q = 0; q < ADJ_FIELDS * TIMES; q++) {
            const double *have = u + (size_t)q * ldu;
            double size;
            size_t v;
            memcpy(one, f + (size_t)(q / TIMES) * ldf, n * sizeof *one);
            st = (adjoint ? hd_heat_adjoint : hd_heat_derivative)(heat, 1, t + q % TIMES, 1, one, 0, one, 0, &rep, NULL);
            CHECK_MSG(st >= 0, "%s: %s", what, rep.error.text);
            size = dense_max_abs(one, (int64_t)n);
            CHECK_MSG(rep.error_bound <= 1e-4 && dense_max_diff(have, one, (int64_t)n) <= 2e-7 * size,
                "%s, %s, adjoint %d, column %d: off by %g, bound %g", what, adj_plans[which / 2],
                adjoint, q, dense_max_diff(have, one, (int64_t)n) / size, rep.error_bound);
            for (v = 0; v < n; v++)
                if (lap->row[v] < 0)
                    CHECK(have[v] == (adjoint && lap->row[v] == HD_ROW_INERT ? f[(size_t)(q / TIMES) * ldf + v] : 0) && one[v] == have[v]);
            CHECK(rep.evidence_b != HD_EVIDENCE_NONE && rep.evidence_rounding != HD_EVIDENCE_NONE && rep.error_relative == HUGE_VAL);
            if (t[q % TIMES] == 0) continue;
            if (which == 2 * ADJ_DIRECT) CHECK(rep.method == HD_METHOD_DIRECT && rep.poles == HD_POLES_KERNEL && rep.degree == 14);
            if (which / 2 == ADJ_KRYLOV) CHECK(rep.method == HD_METHOD_KRYLOV);
            if (which == 2 * ADJ_ITERATIVE) CHECK(rep.solver == HD_SOLVER_COCG);
            if (which / 2 == ADJ_LANCZOS) CHECK(rep.solver == (adjoint ? HD_SOLVER_LANCZOS : HD_SOLVER_COCG));
        }
    }
}

/* So late that only means are left: 0, and nothing is promised relative to that. */
static void adj_late(const hd_laplacian *lap, double late, const char *what) {
    static const int plans[5] = {ADJ_DIRECT, ADJ_TRAIN, ADJ_KRYLOV, ADJ_AUTO};
    double *f = (double *)kit_keep(adj_fields(lap, (size_t)lap->n), free), *u = KIT_NEW(double, lap->n);
    int q;
    for (q = 0; q < 5; q++) {
        hd_report rep;
        const hd_status st = hd_heat_derivative(kit_heat(lap, adj_plans[plans[q]]), 1, &late, 1, f, 0, u, 0, &rep, NULL);
        CHECK_MSG(st >= 0 && dense_max_abs(u, lap->n) <= 2e-12 / late * dense_max_abs(f, lap->n), "%s, %s: %g late, %s", what,
            adj_plans[plans[q]], late * dense_max_abs(u, lap->n), rep.error.text);
        CHECK(st == HD_WARN_ACCURACY || dense_max_abs(u, lap->n) == 0);
    }
}

static void adj_identities(void) {
    static const char *const pairs[] = {"bumpy/2/3 fem", "ico/2 cot", "two/2/0/5 vor", "spare/5/1 fem", "disk/5/1 fem+held",
        "split/8/2 fem+pin", "leak/60/1e-2 mass3"};
    int k;
    for (k = 0; k < (int)(sizeof pairs / sizeof *pairs); k++) {
        const int32_t mark = kit_mark();
        const hd_laplacian *lap = kit_pair(pairs[k]);
        const double top = lap->lambda_max;
        adj_duality(lap, 200 / top, pairs[k]);
        adj_differences(lap, 100 / top, pairs[k]);
        adj_calls(lap, 5 / top, pairs[k]);
        if (lap->conserves == 1) adj_late(lap, 1e20 / top, pairs[k]);
        kit_release(mark);
    }
}

/* The factors of one time serve all three calls, forth and back: answers are the same bits whatever came before. */
static void adj_factors_shared(void) {
    shape s = kit_own_shape(shape_icosphere(3));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = kit_heat(lap, adj_plans[ADJ_TRAIN]), *other = kit_heat(lap, adj_plans[ADJ_TRAIN]);
    const size_t n = (size_t)lap->n;
    const double t = 0.1, t2 = 0.2;
    double *f = adj_fields(lap, n), *u = KIT_NEW(double, 4 * n);
    CHECK(hd_heat_apply(heat, 1, &t, 1, f, 0, u, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_derivative(heat, 1, &t, 1, f, 0, u + n, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_adjoint(heat, 1, &t, 1, f, 0, u + 2 * n, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_apply(heat, 1, &t, 1, f, 0, u + 3 * n, 0, NULL, NULL) == HD_OK && memcmp(u, u + 3 * n, n * sizeof *u) == 0);
    CHECK(hd_heat_derivative(other, 1, &t2, 1, f, 0, u, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_adjoint(other, 1, &t, 1, f, 0, u, 0, NULL, NULL) == HD_OK && memcmp(u, u + 2 * n, n * sizeof *u) == 0);
    CHECK(hd_heat_derivative(other, 1, &t, 1, f, 0, u, 0, NULL, NULL) == HD_OK && memcmp(u, u + n, n * sizeof *u) == 0);
    free(f);
}

/* -A f of fields near the largest double is beyond it, and that is an error, not infinity. */
static void adj_overflow(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    const double zero = 0;
    double *f = KIT_NEW(double, lap->n);
    hd_heat *heat = kit_heat(lap, "");
    hd_report rep;
    hd_error e;
    f[7] = DBL_MAX;
    CHECK(hd_heat_derivative(heat, 1, &zero, 1, f, 0, f, 0, &rep, &e) == HD_ERR_BREAKDOWN && e.vertex >= 0 && e.vertex < lap->n);
    CHECK(rep.status == HD_ERR_BREAKDOWN && strstr(e.text, "range of doubles"));
    memset(f, 0, (size_t)lap->n * sizeof *f);
    f[7] = DBL_MAX / 1024;                       /* the largest eigenvalue is below that */
    CHECK(hd_heat_derivative(heat, 1, &zero, 1, f, 0, f, 0, &rep, &e) == HD_OK && f[7] < 0 && f[7] > -HUGE_VAL);
}

static void adj_errors(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    const double t = 0.1, negative = -1;
    double *f = KIT_NEW(double, lap->n);
    hd_heat *heat = kit_heat(lap, ""), *own = kit_heat(lap, "");
    hd_rational set;
    hd_error e;
    CHECK(hd_heat_derivative(heat, 1, &negative, 1, f, 0, f, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_adjoint(heat, 1, &t, 1, f, 2, f, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_derivative(heat, 1, &t, -1, f, 0, f, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_adjoint(heat, 1, &t, 1, NULL, 0, f, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_derivative(NULL, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_derivative(heat, 1, &t, 0, NULL, 0, NULL, 0, NULL, &e) == HD_OK);
    CHECK(hd_heat_derivative(heat, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_OK && dense_max_abs(f, lap->n) == 0);
    f[5] = HUGE_VAL;
    CHECK(hd_heat_derivative(heat, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 5 && e.column == 0);
    CHECK(hd_heat_adjoint(heat, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_ERR_NOT_FINITE);
    f[5] = 1;
    CHECK(hd_rational_exp(&set, HD_POLES_KERNEL, 8, NULL) == HD_OK && hd_heat_set_rational(own, 1, &set, NULL) == HD_OK);
    CHECK(hd_heat_derivative(own, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_ERR_ARGUMENT && strstr(e.text, "your own"));
    CHECK(hd_heat_adjoint(own, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_OK);
}

/* Fields and meshes of extreme size give the same digits; a derivative is in their unit over an area. */
static void adj_scales(void) {
    static const double factors[3] = {1e-45, 1e45, 1e-30};
    const hd_laplacian *lap = kit_pair("ico/2 fem");
    double *f = (double *)kit_keep(adj_fields(lap, (size_t)lap->n), free), *u = KIT_NEW(double, lap->n), *w = KIT_NEW(double, lap->n), t = 0.05;
    int which, k;
    for (k = 0; k < 3; k++) {
        const double c = factors[k], field = k == 2 ? 1e200 : 1, t_here = t * c * c;
        hd_laplacian *large = NULL;
        double *g = KIT_NEW(double, lap->n);
        int32_t v;
        CHECK(trial_pair(&large, "ico/2", "fem", c, NULL) == HD_OK);
        kit_keep(large, kit_free_laplacian);
        for (v = 0; v < lap->n; v++) g[v] = f[v] * field;
        for (which = 0; which < ADJ_PLANS; which++) {
            double off = 0;
            CHECK(hd_heat_derivative(kit_heat(lap, adj_plans[which]), 1, &t, 1, f, 0, u, 0, NULL, NULL) >= 0);
            CHECK(hd_heat_derivative(kit_heat(large, adj_plans[which]), 1, &t_here, 1, g, 0, w, 0, NULL, NULL) >= 0);
            for (v = 0; v < lap->n; v++) off = fmax(off, fabs(w[v] / field * c * c - u[v]));
            CHECK_MSG(off <= 1e-9 * dense_max_abs(u, lap->n), "%s, scale %g: off by %g", adj_plans[which], c, off / dense_max_abs(u, lap->n));
        }
    }
}

/* A method that is chosen works as the same one asked for. */
static void adj_chosen(void) {
    enum { MANY = 36 };
    const hd_laplacian *lap = kit_pair("bumpy/2/5 fem");
    double *u = kit_random(MANY * lap->n, 3), *out = KIT_NEW(double, MANY * lap->n), t = 10 * lap->h * lap->h;
    hd_report rep[2];
    int i;
    for (i = 0; i < 2; i++) CHECK(hd_heat_derivative(kit_heat(lap, i ? "method=direct" : ""), 1, &t, MANY, u, 0, out, 0, rep + i, NULL) >= 0);
    CHECK(rep[0].method == HD_METHOD_DIRECT && rep[1].method == HD_METHOD_DIRECT);
    CHECK_MSG(rep[0].poles == rep[1].poles && rep[0].degree == rep[1].degree, "poles %d, %d", (int)rep[0].poles, (int)rep[1].poles);
}

static void test_adjoints(void) {
    adj_cases();
    adj_identities();
    adj_chosen();
    adj_factors_shared();
    adj_scales();
    adj_overflow();
    adj_errors();
}

#endif
