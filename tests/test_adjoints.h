/* test_adjoints.h - derivatives of K_t in time and its transpose, against dense eigensolutions, differences and each other */

#ifndef TEST_ADJOINTS_H
#define TEST_ADJOINTS_H

enum { ADJ_FIELDS = 3 };

/* Plans by every method; direct by default and with sets for training. */
enum { ADJ_DIRECT, ADJ_TRAIN, ADJ_DIAGONAL, ADJ_KRYLOV, ADJ_ITERATIVE, ADJ_LANCZOS, ADJ_AUTO, ADJ_PLANS };
static const char *const adj_names[ADJ_PLANS] = {"direct", "direct kernel 10", "direct diagonal 12", "krylov", "iterative", "lanczos", "auto"};

static hd_heat_opts adj_opts(int which) {
    static const hd_method methods[ADJ_PLANS] = {HD_METHOD_DIRECT, HD_METHOD_DIRECT, HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE,
        HD_METHOD_ITERATIVE, HD_METHOD_AUTO};
    hd_heat_opts o = eng_opts(methods[which]);
    if (which == ADJ_TRAIN) o.poles = HD_POLES_KERNEL;
    if (which == ADJ_TRAIN) o.degree = 10;
    if (which == ADJ_DIAGONAL) o.poles = HD_POLES_DIAGONAL;
    if (which == ADJ_DIAGONAL) o.degree = 12;
    if (which == ADJ_LANCZOS) o.solver = HD_SOLVER_LANCZOS;
    o.tol = which == ADJ_KRYLOV || which == ADJ_LANCZOS ? 1e-10 : 0;
    return o;
}

static hd_heat *adj_plan(const hd_laplacian *lap, int which) {
    const hd_heat_opts o = adj_opts(which);
    return eng_create(lap, &o);
}

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

/* want, by rows: dK_t/dt f or K_t' f. Returns the norm in which the error of either counts: that of B, or of B^-1. */
static void adj_truth(const heat_case *c, int adjoint, double t, const double *f, double *want) {
    const int32_t n = c->lap->n_active;
    double *g = DENSE_NEW(double, n), *rows = DENSE_NEW(double, n), *rhs = DENSE_NEW(double, n);
    int32_t i;
    for (i = 0; i < n; i++) {
        const double lambda = c->pair.lambda[i];
        g[i] = adjoint ? exp(-t * lambda) : -lambda * exp(-t * lambda);
        rows[i] = f[c->lap->vertex[i]];
    }
    if (adjoint) {
        dense_pair_filter(&c->pair, g, rows, rhs);
        dense_apply(c->pair.B, rhs, want, n);
    } else {
        dense_apply(c->pair.B, rows, rhs, n);
        dense_pair_filter(&c->pair, g, rhs, want);
    }
    free(g);
    free(rows);
    free(rhs);
}

/* |x|_B, or |x| in the norm of B^-1, by the eigenvectors: X X' = B^-1. */
static double adj_norm(const heat_case *c, int adjoint, const double *x) {
    double sum = 0;
    int32_t k;
    if (!adjoint) return dense_pair_norm(&c->pair, x);
    for (k = 0; k < c->pair.n; k++) {
        const double d = dense_dot(c->pair.x + (size_t)k * (size_t)c->pair.n, x, c->pair.n);
        sum += d * d;
    }
    return sqrt(sum);
}

/* Is u, on vertices, within the report's bounds of the truth, and to 4e-9 of f's norm (over t) in any case? */
/* alone: the report is about this answer and no other, and its bounds are worth something. */
static void adj_judge(const heat_case *c, int adjoint, double t, const double *f, const double *u, const hd_report *rep, int alone,
    const char *what) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    const double unit = adjoint ? 1 : 1 / fmax(t, 1 / c->top);
    double *want = DENSE_NEW(double, n), *diff = DENSE_NEW(double, n), *rows = DENSE_NEW(double, n), f_norm, off, size, most = 0, slack;
    int32_t i, v;
    adj_truth(c, adjoint, t, f, want);
    for (i = 0; i < n; i++) {
        diff[i] = u[lap->vertex[i]] - want[i];
        most = fmax(most, fabs(u[lap->vertex[i]]));
        rows[i] = f[lap->vertex[i]];
    }
    f_norm = adj_norm(c, adjoint, rows) * unit;
    off = adj_norm(c, adjoint, diff);
    size = adj_norm(c, adjoint, want);
    slack = (1e-12 + 1e-15 * fmin(t * c->top, 1e4)) * f_norm;        /* of the eigensolution, and of rounding in f */
    CHECK_MSG(off <= 4e-9 * f_norm, "%s, %s, t %g: off by %g of the field", c->what, what, t, off / f_norm);
    if (size > 0.05 * f_norm) CHECK_MSG(off <= 1e-7 * size, "%s, %s, t %g: off by %g", c->what, what, t, off / size);
    CHECK_MSG(rep->error_bound_b == HUGE_VAL || off <= rep->error_bound_b * size + slack, "%s, %s, t %g: off by %g, bound %g", c->what, what, t,
        off / size, rep->error_bound_b);
    CHECK_MSG(rep->error_bound == HUGE_VAL || dense_max_abs(diff, n) <= rep->error_bound * most + slack * (adjoint ? 1 : 100 / sqrt(lap->area)),
        "%s, %s, t %g: off by %g of the largest, bound %g", c->what, what, t, dense_max_abs(diff, n) / most, rep->error_bound);
    if (alone && size > 1e-2 * f_norm) CHECK_MSG(rep->error_bound_b <= 1e-5 && rep->error_bound <= 1e-4, "%s, %s, t %g: bounds %g, %g", c->what, what, t,
        rep->error_bound_b, rep->error_bound);
    CHECK(rep->evidence_b != HD_EVIDENCE_NONE && rep->evidence_rounding != HD_EVIDENCE_NONE && rep->error_relative == HUGE_VAL);
    for (v = 0; v < lap->n; v++)
        if (lap->row[v] < 0) CHECK(u[v] == (adjoint && lap->row[v] == HD_ROW_INERT ? f[v] : 0));
    free(want);
    free(diff);
    free(rows);
}

/* All fields at all times in one call, with columns further apart than they need be; and one field in place. */
static void adj_case_plan(const heat_case *c, int which) {
    enum { TIMES = 3 };
    const hd_laplacian *lap = c->lap;
    const size_t n = (size_t)lap->n, ldf = n + 3, ldu = n + 1;
    const double unit = 10 / c->top, t[TIMES] = {30 * unit, unit, 300 * unit};
    double *f = adj_fields(lap, ldf), *u = DENSE_NEW(double, (int64_t)ldu * ADJ_FIELDS * TIMES), *one = DENSE_NEW(double, n);
    hd_heat *heat = adj_plan(lap, which);
    hd_report rep;
    int adjoint, q, m;
    for (adjoint = 0; adjoint < 2; adjoint++) {
        char what[80];
        hd_status st = (adjoint ? hd_heat_adjoint : hd_heat_derivative)(heat, TIMES, t, ADJ_FIELDS, f, ldf, u, ldu, &rep, NULL);
        snprintf(what, sizeof what, "%s, %s", adj_names[which], adjoint ? "adjoint" : "derivative");
        CHECK_MSG(st >= 0 && st == rep.status, "%s, %s: %s", c->what, what, rep.error.text);
        for (q = 0; q < ADJ_FIELDS; q++)
            for (m = 0; m < TIMES; m++) adj_judge(c, adjoint, t[m], f + (size_t)q * ldf, u + (size_t)(q * TIMES + m) * ldu, &rep, 0, what);
        for (m = 0; m < TIMES; m++) {
            memcpy(one, f + ldf, n * sizeof *one);
            st = (adjoint ? hd_heat_adjoint : hd_heat_derivative)(heat, 1, t + m, 1, one, 0, one, 0, &rep, NULL);
            CHECK_MSG(st >= 0, "%s, %s: %s", c->what, what, rep.error.text);
            adj_judge(c, adjoint, t[m], f + ldf, one, &rep, 1, what);
            if (which == ADJ_DIRECT && !adjoint) CHECK(rep.method == HD_METHOD_DIRECT && rep.poles == HD_POLES_KERNEL && rep.degree == 14);
            if (which == ADJ_KRYLOV) CHECK(rep.method == HD_METHOD_KRYLOV);
            if (which == ADJ_ITERATIVE && !adjoint) CHECK(rep.solver == HD_SOLVER_COCG);
            if (which == ADJ_LANCZOS) CHECK(rep.solver == HD_SOLVER_LANCZOS);
        }
    }
    hd_heat_free(heat);
    free(f);
    free(u);
    free(one);
}

/* <g, K f> = <K' g, f>, and with one set of poles to rounding; the derivative's matrix is self-adjoint as K is. */
static void adj_duality(const heat_case *c) {
    const hd_laplacian *lap = c->lap;
    const size_t n = (size_t)lap->n;
    const double t = 200 / c->top;
    double *f = adj_fields(lap, n), *u = DENSE_NEW(double, n), *w = DENSE_NEW(double, n);
    int which;
    for (which = 0; which < ADJ_PLANS; which++) {
        const double want = which == ADJ_TRAIN || which == ADJ_DIAGONAL ? 1e-13 : 1e-7;
        hd_heat *heat = adj_plan(lap, which);
        int p, q;
        for (p = 0; p < ADJ_FIELDS; p++)
            for (q = 0; q < ADJ_FIELDS; q++) {
                const double *g = f + (size_t)p * n, *h = f + (size_t)q * n;
                double left = 0, right = 0, size = 0;
                size_t v;
                CHECK(hd_heat_apply(heat, 1, &t, 1, h, 0, u, 0, NULL, NULL) >= 0 && hd_heat_adjoint(heat, 1, &t, 1, g, 0, w, 0, NULL, NULL) >= 0);
                for (v = 0; v < n; v++) {
                    left += g[v] * u[v];
                    right += w[v] * h[v];
                    size += fabs(g[v] * u[v]) + fabs(w[v] * h[v]);
                }
                CHECK_MSG(fabs(left - right) <= want * size, "%s, %s: %.17g and %.17g differ by %g", c->what, adj_names[which], left, right,
                    fabs(left - right) / size);
            }
        hd_heat_free(heat);
    }
    free(f);
    free(u);
    free(w);
}

/* Central differences of K_t f at the highest degree, and of sum g (K_t f). */
static void adj_differences(const heat_case *c) {
    const hd_laplacian *lap = c->lap;
    const size_t n = (size_t)lap->n;
    const double t = 100 / c->top, step = 1e-4 * t, at[2] = {t - step, t + step};
    double *f = adj_fields(lap, n), *u = DENSE_NEW(double, 2 * n), *w = DENSE_NEW(double, n);
    hd_heat *heat = eng_plan(lap, HD_METHOD_DIRECT, HD_POLES_KERNEL, 14);
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
        CHECK_MSG(off <= 1e-7 * most, "%s, field %d: differences are off by %g", c->what, q, off / most);
    }
    hd_heat_free(heat);
    free(f);
    free(u);
    free(w);
}

/* t = 0: -A f and f; t so large that only means are left: 0, and nothing is promised relative to that. */
static void adj_extremes(const heat_case *c) {
    const hd_laplacian *lap = c->lap;
    const size_t n = (size_t)lap->n;
    const double zero = 0, tiny = 1e-25 / c->top, late = 1e20 / c->top, mixed[3] = {20 / c->top, 0, 1 / c->top};
    double *f = adj_fields(lap, n), *u = DENSE_NEW(double, 3 * n);
    int which, m;
    for (which = 0; which < ADJ_PLANS; which++) {
        hd_heat *heat = adj_plan(lap, which);
        hd_report rep;
        CHECK(hd_heat_derivative(heat, 1, &zero, 1, f + n, 0, u, 0, &rep, NULL) == HD_OK);
        adj_judge(c, 0, 0, f + n, u, &rep, 1, "t = 0");
        CHECK(hd_heat_derivative(heat, 1, &tiny, 1, f + n, 0, u, 0, &rep, NULL) == HD_OK);
        adj_judge(c, 0, 0, f + n, u, &rep, 1, "t near 0");
        CHECK(hd_heat_derivative(heat, 3, mixed, 1, f, 0, u, 0, &rep, NULL) >= 0);
        for (m = 0; m < 3; m++) adj_judge(c, 0, mixed[m], f, u + (size_t)m * n, &rep, 0, "with t = 0");
        CHECK(hd_heat_adjoint(heat, 1, &zero, 1, f + n, 0, u, 0, &rep, NULL) == HD_OK);
        adj_judge(c, 1, 0, f + n, u, &rep, 1, "t = 0, adjoint");
        if (lap->conserves && which != ADJ_LANCZOS && which != ADJ_ITERATIVE) {
            const hd_status st = hd_heat_derivative(heat, 1, &late, 1, f, 0, u, 0, &rep, NULL);
            CHECK_MSG(st >= 0 && dense_max_abs(u, lap->n) <= 1e-11 / late, "%s, %s: %g late, %s", c->what, adj_names[which],
                late * dense_max_abs(u, lap->n), rep.error.text);
            CHECK(st == HD_WARN_ACCURACY || dense_max_abs(u, lap->n) == 0);
        }
        hd_heat_free(heat);
    }
    free(f);
    free(u);
}

/* The factors of one time serve all three calls, forth and back: answers are the same bits whatever came before. */
static void adj_factors_shared(void) {
    shape s = shape_icosphere(3);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = adj_plan(lap, ADJ_TRAIN), *other = adj_plan(lap, ADJ_TRAIN);
    const size_t n = (size_t)lap->n;
    const double t = 0.1, t2 = 0.2;
    double *f = adj_fields(lap, n), *u = DENSE_NEW(double, 4 * n);
    CHECK(hd_heat_apply(heat, 1, &t, 1, f, 0, u, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_derivative(heat, 1, &t, 1, f, 0, u + n, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_adjoint(heat, 1, &t, 1, f, 0, u + 2 * n, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_apply(heat, 1, &t, 1, f, 0, u + 3 * n, 0, NULL, NULL) == HD_OK && memcmp(u, u + 3 * n, n * sizeof *u) == 0);
    CHECK(hd_heat_derivative(other, 1, &t2, 1, f, 0, u, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_adjoint(other, 1, &t, 1, f, 0, u, 0, NULL, NULL) == HD_OK && memcmp(u, u + 2 * n, n * sizeof *u) == 0);
    CHECK(hd_heat_derivative(other, 1, &t, 1, f, 0, u, 0, NULL, NULL) == HD_OK && memcmp(u, u + n, n * sizeof *u) == 0);
    hd_heat_free(heat);
    hd_heat_free(other);
    hd_laplacian_free(lap);
    free(f);
    free(u);
    shape_free(&s);
}

/* -A f of fields near the largest double is beyond it, and that is an error, not infinity. */
static void adj_overflow(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double zero = 0;
    double *f = DENSE_NEW(double, lap->n);
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_heat *heat = eng_create(lap, &o);
    hd_report rep;
    hd_error e;
    f[7] = DBL_MAX;
    CHECK(hd_heat_derivative(heat, 1, &zero, 1, f, 0, f, 0, &rep, &e) == HD_ERR_BREAKDOWN && e.vertex >= 0 && e.vertex < lap->n);
    CHECK(rep.status == HD_ERR_BREAKDOWN && strstr(e.text, "range of doubles"));
    memset(f, 0, (size_t)lap->n * sizeof *f);
    f[7] = DBL_MAX / 1024;                       /* the largest eigenvalue is below that */
    CHECK(hd_heat_derivative(heat, 1, &zero, 1, f, 0, f, 0, &rep, &e) == HD_OK && f[7] < 0 && f[7] > -HUGE_VAL);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(f);
    shape_free(&s);
}

static void adj_errors(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double t = 0.1, negative = -1;
    double *f = DENSE_NEW(double, lap->n);
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_heat *heat = eng_create(lap, &o), *own;
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
    CHECK(hd_rational_get(&set, HD_POLES_KERNEL, 8, NULL) == HD_OK);
    o.rational = &set;
    own = eng_create(lap, &o);
    CHECK(hd_heat_derivative(own, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_ERR_ARGUMENT && strstr(e.text, "your own"));
    CHECK(hd_heat_adjoint(own, 1, &t, 1, f, 0, f, 0, NULL, &e) == HD_OK);
    hd_heat_free(heat);
    hd_heat_free(own);
    hd_laplacian_free(lap);
    free(f);
    shape_free(&s);
}

/* Fields and meshes of extreme size give the same digits; a derivative is in their unit over an area. */
static void adj_scales(void) {
    static const double factors[3] = {1e-60, 1e70, 1e-40};
    shape s = shape_icosphere(2);
    const double t = 0.05;
    double *f, *u = DENSE_NEW(double, s.n), *w = DENSE_NEW(double, s.n);
    int which, k;
    int32_t v;
    for (which = 0; which < ADJ_PLANS; which++) {
        hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
        hd_heat *heat = adj_plan(lap, which);
        f = adj_fields(lap, (size_t)s.n);
        CHECK(hd_heat_derivative(heat, 1, &t, 1, f, 0, u, 0, NULL, NULL) >= 0);
        for (k = 0; k < 3; k++) {
            const double c = factors[k], field = k == 2 ? 1e200 : 1, t_here = t * c * c;
            shape big = shape_make(s.n, s.n_tri);
            hd_laplacian *large;
            hd_heat *plan;
            double off = 0;
            memcpy(big.tri, s.tri, 3 * (size_t)s.n_tri * sizeof *s.tri);
            for (v = 0; v < 3 * s.n; v++) big.xyz[v] = c * s.xyz[v];
            large = test_laplacian(&big, HD_LAPLACIAN_FEM);
            plan = adj_plan(large, which);
            for (v = 0; v < s.n; v++) f[v] *= field;
            CHECK(hd_heat_derivative(plan, 1, &t_here, 1, f, 0, w, 0, NULL, NULL) >= 0);
            for (v = 0; v < s.n; v++) off = fmax(off, fabs(w[v] / field * c * c - u[v]));
            CHECK_MSG(off <= 1e-9 * dense_max_abs(u, s.n), "%s, scale %g: off by %g", adj_names[which], c, off / dense_max_abs(u, s.n));
            hd_heat_free(plan);
            hd_laplacian_free(large);
            shape_free(&big);
        }
        free(f);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    free(u);
    free(w);
    shape_free(&s);
}

/* A method that is chosen works as the same one asked for. */
static void adj_chosen(void) {
    enum { FIELDS = 36 };
    shape s = shape_bumpy(2, 5);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    double *u = DENSE_NEW(double, 2 * FIELDS * (int64_t)s.n), *out = u + FIELDS * s.n;
    const double t = 10 * lap->h * lap->h;
    hd_report rep[2];
    int32_t i;
    for (i = 0; i < FIELDS * s.n; i++) u[i] = sin(i);
    for (i = 0; i < 2; i++) {
        hd_heat *heat = eng_plan(lap, i ? HD_METHOD_DIRECT : HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        CHECK(hd_heat_derivative(heat, 1, &t, FIELDS, u, 0, out, 0, rep + i, NULL) >= 0);
        hd_heat_free(heat);
    }
    CHECK(rep[0].method == HD_METHOD_DIRECT && rep[1].method == HD_METHOD_DIRECT);
    CHECK_MSG(rep[0].poles == rep[1].poles && rep[0].degree == rep[1].degree, "poles %d, %d", (int)rep[0].poles, (int)rep[1].poles);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(u);
}

/* A path from 0 to HEAVY and one vertex beyond, where HEAVY has nearly all the mass and a little heat leaves at 0. What has arrived there
 * from one unit at 0 is what the other path would have lost to a held vertex: int_0^t u(HEAVY - 1) ds, by the dense oracle. */
static void adj_heavy_end(void) {
    enum { HEAVY = 10, N = HEAVY + 2 };
    const double leak = 1e-3, t = 60;
    double *L = DENSE_NEW(double, HEAVY * HEAVY), *B = DENSE_NEW(double, HEAVY * HEAVY), g[HEAVY], one[HEAVY] = {1}, w[HEAVY];
    dense_pair pair;
    int i, decade;
    for (i = 0; i < HEAVY; i++) {
        L[i * HEAVY + i] = i == 0 ? 1 + leak : 2;
        if (i > 0) L[i * HEAVY + i - 1] = L[(i - 1) * HEAVY + i] = -1;
        B[i * HEAVY + i] = 1;
    }
    CHECK(dense_pair_solve(&pair, L, B, HEAVY));
    for (i = 0; i < HEAVY; i++) g[i] = -expm1(-t * pair.lambda[i]) / pair.lambda[i];
    dense_pair_filter(&pair, g, one, w);         /* w[HEAVY - 1]: the heat that has arrived */
    for (decade = 12; decade <= 20; decade += 4) {
        int32_t ri[3 * N], rj[3 * N];
        double v[3 * N], mass[N], field[N], u[N];
        hd_laplacian *lap = NULL;
        hd_csr csr_L, csr_B;
        hd_error e;
        int c = 0, which;
        for (i = 0; i < N; i++) {
            mass[i] = i == HEAVY ? pow(10, decade) : 1;
            field[i] = i == 0;
            ri[c] = rj[c] = i;
            v[c++] = (i > 0) + (i + 1 < N) + (i == 0 ? leak : 0);
            if (i == 0) continue;
            ri[c] = i - 1;
            rj[c] = i;
            v[c++] = -1;
        }
        csr_L = test_symmetric_csr(N, c, ri, rj, v);
        csr_B = test_diagonal_csr(N, mass);
        CHECK_MSG(hd_laplacian_matrices(&lap, &csr_L, &csr_B, 0, NULL, &e) == HD_OK, "%s", e.text);
        for (which = 0; which < 2 * ADJ_PLANS; which++) {
            hd_heat_opts o = adj_opts(which % ADJ_PLANS);
            hd_heat *heat;
            hd_report rep;
            double off;
            o.tol = which < ADJ_PLANS ? 0 : 1e-3;
            heat = eng_create(lap, &o);
            CHECK(hd_heat_adjoint(heat, 1, &t, 1, field, 0, u, 0, &rep, NULL) >= 0);
            off = fabs(u[HEAVY] - w[HEAVY - 1]) / dense_max_abs(u, N);
            CHECK_MSG(off <= rep.error_bound, "%s, mass 1e%d: %g for %g, off by %g, bound %g", adj_names[which % ADJ_PLANS], decade, u[HEAVY],
                w[HEAVY - 1], off, rep.error_bound);
            hd_heat_free(heat);
        }
        hd_laplacian_free(lap);
        hd_csr_free(&csr_L, NULL);
        hd_csr_free(&csr_B, NULL);
    }
    dense_pair_free(&pair);
}

enum { ADJ_ENGINES = 6 };

/* The derivative of f by one engine. Constants have none, so the truth is that of f - 1, which is exact. */
static void adj_level_one(const heat_case *c, int engine, int depth, double t, const double *f, double *u) {
    static const hd_solver solvers[ADJ_ENGINES] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    const hd_laplacian *lap = c->lap;
    double *ripple = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, lap->n), off = 0, most = 0;
    hd_heat_opts o = eng_opts(engine < 4 ? HD_METHOD_ITERATIVE : engine == 4 ? HD_METHOD_AUTO : HD_METHOD_DIRECT);
    hd_report rep;
    hd_heat *heat;
    hd_status st;
    int32_t v;
    o.solver = solvers[engine];
    heat = eng_create(lap, &o);
    for (v = 0; v < lap->n; v++) ripple[v] = f[v] - 1;
    adj_truth(c, 0, t, ripple, want);
    st = hd_heat_derivative(heat, 1, &t, 1, f, 0, u, 0, &rep, NULL);
    CHECK_MSG(st >= 0, "%s, ripple 2^-%d, engine %d, t %g: %s, %g", c->what, depth, engine, t, rep.error.text, rep.error.value);
    for (v = 0; v < lap->n_active; v++) {
        off = fmax(off, fabs(u[lap->vertex[v]] - want[v]));
        most = fmax(most, fabs(u[lap->vertex[v]]));
    }
    CHECK_MSG(rep.error_bound == HUGE_VAL || off <= (rep.error_bound + 1e-12) * most, "%s, ripple 2^-%d, engine %d, t %g: off by %g, bound %g", c->what, depth, engine, t, off / most,
        rep.error_bound);
    CHECK(st == HD_WARN_ACCURACY || rep.error_bound <= 1e-2);
    if (depth == 20) CHECK_MSG(rep.error_bound <= 1e-5, "%s, engine %d, t %g: bound %g", c->what, engine, t, rep.error_bound);
    hd_heat_free(heat);
    free(ripple);
    free(want);
}

/* Fields that are constant but for a ripple, down to the last digit and below. */
static void adj_level(const heat_case *c) {
    const int32_t n = c->lap->n;
    double *f = DENSE_NEW(double, n), *u = DENSE_NEW(double, n);
    int depth, engine, decade;
    int32_t v;
    for (depth = 20; depth <= 60; depth += 10) {
        uint64_t seed = (uint64_t)depth;
        for (v = 0; v < n; v++) f[v] = 1 + ldexp(dense_signed(&seed), -depth);
        for (engine = 0; engine < ADJ_ENGINES; engine++)
            for (decade = -1; decade <= 1; decade++) adj_level_one(c, engine, depth, pow(10, decade) / c->top, f, u);
    }
    free(f);
    free(u);
}

/* Where iterations fail that auto has chosen, factors take over. A cycle from which next to no heat leaves has decayed by exp(-5). */
static void adj_goes_on(void) {
    enum { N = 40 };
    int32_t ri[3 * N], rj[3 * N], v;
    double value[3 * N], f[N], u[N], want[N], off = 0, most = 0;
    const double leak = 1e-9, t = 5.444e9;
    hd_csr L, B;
    hd_laplacian *lap = NULL;
    uint64_t seed = 3;
    int pass;
    for (v = 0; v < N; v++) {
        ri[2 * v] = rj[2 * v] = ri[2 * v + 1] = v;
        rj[2 * v + 1] = (v + 1) % N;
        value[2 * v] = 2 + leak;
        value[2 * v + 1] = -1;
        f[v] = 1 + ldexp(dense_signed(&seed), -40);
        want[v] = -leak * exp(-t * leak);        /* of what the waves leave, which is f's mean: 1 up to 1e-12 */
    }
    L = test_symmetric_csr(N, 2 * N, ri, rj, value);
    B = test_diagonal_csr(N, NULL);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK && !lap->conserves);
    for (pass = 0; pass < 2; pass++) {
        hd_heat_opts o = eng_opts(pass ? HD_METHOD_AUTO : HD_METHOD_ITERATIVE);
        hd_heat *heat;
        hd_report rep;
        hd_status st;
        o.tol = 1e-13;
        heat = eng_create(lap, &o);
        st = hd_heat_derivative(heat, 1, &t, 1, f, 0, u, 0, &rep, NULL);
        CHECK(pass || st == HD_ERR_BREAKDOWN || st == HD_ERR_NOT_CONVERGED || st >= 0);
        if (pass) CHECK_MSG(st >= 0, "auto: %s", rep.error.text);
        for (v = 0; v < N && st >= 0; v++) {
            off = fmax(off, fabs(u[v] - want[v]));
            most = fmax(most, fabs(u[v]));
        }
        CHECK_MSG(st < 0 || off <= (rep.error_bound + 1e-10) * most, "off by %g, bound %g", off / most, rep.error_bound);
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
}

static void test_adjoints(void) {
    adj_factors_shared();
    adj_chosen();
    shape ball = shape_icosphere(2), bumpy = shape_bumpy(2, 3), disk = bord_disk(5, 1), inert = eng_with_inert(&ball), soup = eng_soup(60, 90, 9);
    const double apart[3] = {4, 1, 0};
    shape two = shape_disjoint(&disk, &ball, apart);
    const int32_t held[3] = {7, 30, 31};
    const hd_laplacian_opts border = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 0, NULL);
    const hd_laplacian_opts some = bord_opts(HD_LAPLACIAN_VORONOI_COT, HD_BORDER_NATURAL, 3, held);
    const hd_laplacian_opts full = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 3, held);
    heat_case c[9];
    int k, which, n = 0;
    c[n++] = heat_case_of(test_laplacian(&bumpy, HD_LAPLACIAN_FEM), "bumpy, fem");
    c[n++] = heat_case_of(test_laplacian(&ball, HD_LAPLACIAN_COT), "ball, cot");
    c[n++] = heat_case_of(test_laplacian(&two, HD_LAPLACIAN_VORONOI_COT), "two components");
    c[n++] = heat_case_of(test_laplacian(&inert, HD_LAPLACIAN_FEM), "with inert vertices");
    c[n++] = heat_case_of(test_laplacian(&soup, HD_LAPLACIAN_FEM), "soup");
    c[n++] = heat_case_of(bord_triangles(&disk, &border), "Dirichlet border");
    c[n++] = heat_case_of(bord_triangles(&ball, &some), "held vertices");
    c[n++] = heat_case_of(bord_triangles(&two, &full), "one of two held");
    c[n++] = heat_case_of(eng_leaking(9, 8), "leaking");
    for (k = 0; k < n; k++) {
        for (which = 0; which < ADJ_PLANS; which++) adj_case_plan(c + k, which);
        adj_duality(c + k);
        adj_differences(c + k);
        if (k < 6) adj_extremes(c + k);
        if (k < 4) adj_level(c + k);
        heat_case_free(c + k);
    }
    adj_heavy_end();
    adj_goes_on();
    adj_scales();
    adj_overflow();
    adj_errors();
    shape_free(&ball);
    shape_free(&bumpy);
    shape_free(&disk);
    shape_free(&inert);
    shape_free(&soup);
    shape_free(&two);
}

#endif
