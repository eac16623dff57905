/* test_filters.h - filters of the spectrum: their pole sets against the functions themselves, and every query against dense filters */

#ifndef TEST_FILTERS_H
#define TEST_FILTERS_H

enum { FILT_LIST = 10, FILT_POINTS = 100000 };

/* What hd_filter_kind says, once more. */
static double filt_want(const hd_filter *f, double l) {
    const double a = f->a, b = f->b;
    if (l <= 0) return f->kind == HD_FILTER_WAVE || f->kind == HD_FILTER_MEXICAN_HAT || f->kind == HD_FILTER_BAND ? 0 : f->kind == HD_FILTER_BIHARMONIC ? 1 / (a * a) : 1;
    if (f->kind == HD_FILTER_HEAT) return exp(-a * l);
    if (f->kind == HD_FILTER_WAVE) return exp(-pow(a - log(l), 2) / (2 * b * b));
    if (f->kind == HD_FILTER_MEXICAN_HAT) return l * exp(-a * l);
    if (f->kind == HD_FILTER_RESOLVENT) return 1 / (1 + a * l);
    if (f->kind == HD_FILTER_FRACTIONAL) return exp(-a * pow(l, b));
    if (f->kind == HD_FILTER_BAND) return 1 / (1 + pow((l * l - a * b) / (l * (b - a)), 4));
    return 1 / (l * l + a * a);
}

static hd_filter filt_make(hd_filter_kind kind, double a, double b) {
    hd_filter f;
    memset(&f, 0, sizeof f);
    f.kind = kind;
    f.a = a;
    f.b = b;
    return f;
}

/* Ten filters for eigenvalues between low and top. */
static void filt_list(hd_filter *f, double low, double top) {
    const double mid = sqrt(low * top);
    int q;
    f[0] = filt_make(HD_FILTER_HEAT, 1 / mid, 0);
    for (q = 0; q < 4; q++) f[1 + q] = filt_make(HD_FILTER_WAVE, log(low) + (q + 0.5) * log(top / low) / 4, q % 2 ? 0.5 : 0.3);
    f[5] = filt_make(HD_FILTER_MEXICAN_HAT, 1 / mid, 0);
    f[6] = filt_make(HD_FILTER_RESOLVENT, 1 / mid, 0);
    f[7] = filt_make(HD_FILTER_FRACTIONAL, 1 / sqrt(mid), 0.5);
    f[7].lambda_min = low;
    f[8] = filt_make(HD_FILTER_BAND, 0.5 * mid, 2 * mid);
    f[9] = filt_make(HD_FILTER_BIHARMONIC, 3 * low, 0);
}

/* ---- pole sets ---- */

/* The largest error of a set at many points, half of them even in log lambda, and at 0. */
static double filt_error(const hd_filter *f, const hd_rational *set, double top) {
    const double from = f->lambda_min > 0 ? f->lambda_min : 1e-14 * top;
    double most = fabs(filt_want(f, 0) - hd_rational_eval(set, 0));
    int k;
    for (k = 0; k < FILT_POINTS; k++) {
        const double s = (k % (FILT_POINTS / 2) + 0.37) / (FILT_POINTS / 2), l = k < FILT_POINTS / 2 ? from * pow(top / from, s) : from + s * (top - from);
        most = fmax(most, fabs(filt_want(f, l) - hd_rational_eval(set, -set->t * l)));
    }
    return most;
}

static void filt_check_set(const hd_filter *f, const hd_rational *set, double top, const char *what) {
    const double off = filt_error(f, set, top);
    double largest = filt_want(f, 0);
    int32_t i, degree = 0;
    int k;
    for (k = 0; k <= 4000; k++) largest = fmax(largest, filt_want(f, top * pow(10, -k / 400.0)));
    CHECK_MSG(off <= 1e-8 * largest && set->degree <= 24, "%s: error %g with degree %d", what, off / largest, (int)set->degree);
    CHECK_MSG(off <= set->max_error && set->max_error <= set->max_weighted_error, "%s: error %g, reported %g, weighted %g", what, off, set->max_error, set->max_weighted_error);
    CHECK_MSG(fabs(set->largest / largest - 1) < 1e-2 && set->lambda_max == top && set->t > 0, "%s: largest value %g, not %g", what, set->largest, largest);
    CHECK(set->kind == HD_POLES_OWN && set->a0 == 0);
    for (i = 0; i < set->n_poles; i++) {
        degree += set->theta[i].im == 0 ? 1 : 2;
        CHECK(set->theta[i].im > 0 || (set->theta[i].im == 0 && set->theta[i].re > 0 && set->a[i].im == 0));
        CHECK(set->theta[i].re > 0 || set->theta[i].im > 1e-5 * fabs(set->theta[i].re));
    }
    CHECK(degree == set->degree);
}

static void filt_sets(void) {
    static const double low[3] = {1, 1e-3, 30}, top[3] = {1e3, 1e4, 3e7};
    hd_filter f[FILT_LIST];
    hd_rational set;
    hd_error e;
    int k, q;
    for (k = 0; k < 3; k++) {
        filt_list(f, low[k], top[k]);
        for (q = 0; q < FILT_LIST; q++) {
            char what[60];
            snprintf(what, sizeof what, "filter %d, eigenvalues to %g", q, top[k]);
            CHECK_MSG(hd_rational_fit(&set, f + q, top[k], NULL, &e) == HD_OK, "%s: %s", what, e.text);
            filt_check_set(f + q, &set, top[k], what);
            CHECK(fabs(hd_filter_eval(f + q, 3 * low[k]) - filt_want(f + q, 3 * low[k])) <= 1e-12 * set.largest && fabs(hd_filter_eval(f + q, 0) - filt_want(f + q, 0)) <= 1e-12 * set.largest);
        }
    }
}

/* Rational filters are found with the poles that they have, and more than these are not taken. */
static void filt_known(void) {
    hd_filter f = filt_make(HD_FILTER_RESOLVENT, 0.25, 0);
    hd_rational set;
    CHECK(hd_rational_fit(&set, &f, 1e4, NULL, NULL) == HD_OK && set.degree == 1 && set.n_poles == 1);
    CHECK(fabs(set.theta[0].re / set.t - 4) < 1e-7 && set.theta[0].im == 0);
    f = filt_make(HD_FILTER_BIHARMONIC, 3, 0);
    CHECK(hd_rational_fit(&set, &f, 1e4, NULL, NULL) == HD_OK && set.degree == 2 && set.n_poles == 1);
    CHECK(hypot(set.theta[0].re, set.theta[0].im - 3 * set.t) < 1e-6 * set.t);
    f = filt_make(HD_FILTER_BAND, 2, 8);
    CHECK(hd_rational_fit(&set, &f, 1e4, NULL, NULL) == HD_OK && set.degree == 8 && set.n_poles == 4);
}

/* What cannot be had is told: root singularities at 0 without a gap, few poles. A larger error is never hidden. */
static void filt_honest(void) {
    hd_filter f = filt_make(HD_FILTER_FRACTIONAL, 1, 0.5);
    hd_rational set;
    double off;
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, NULL) == HD_WARN_ACCURACY);
    off = filt_error(&f, &set, 1e5);
    CHECK_MSG(off > 1e-8 && off <= set.max_error && set.max_error < 1e-3, "error %g, reported %g", off, set.max_error);
    f = filt_make(HD_FILTER_WAVE, 3, 0.4);
    f.max_degree = 8;
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, NULL) == HD_WARN_ACCURACY && set.degree <= 8);
    off = filt_error(&f, &set, 1e5);
    CHECK_MSG(off > 1e-6 && off <= set.max_error && set.max_error < 1e-2, "error %g, reported %g", off, set.max_error);
    f.max_degree = 0;
    f.tol = 1e-4;
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, NULL) == HD_OK && set.degree < 16 && set.max_error < 1.06e-4);
}

static double filt_near_largest(double lambda, void *user) {
    const double x = 1 / (1 + lambda);
    (void)user;
    return -DBL_MAX * x * x;
}

/* Two poles meet at -1, so that their weights are far larger than f, and overflow: told, and the set is left as it was. */
static void filt_overflow(void) {
    hd_filter f = filt_make(HD_FILTER_OWN, 0, 0);
    hd_rational set, before;
    hd_error e;
    f.f = filt_near_largest;
    f.max_degree = 8;
    memset(&set, 0x6b, sizeof set);
    before = set;
    CHECK(hd_rational_fit(&set, &f, 28.9, NULL, &e) == HD_ERR_BREAKDOWN && strstr(e.text, "range of doubles"));
    CHECK(memcmp(&set, &before, sizeof set) == 0);
    CHECK(hd_rational_fit_shared(&set, 1, &f, 28.9, NULL, &e) == HD_ERR_BREAKDOWN && e.column == 0);
}

/* A weight makes the error small where it is large, and says so. */
static void filt_weight(void) {
    hd_filter f = filt_make(HD_FILTER_WAVE, 3, 0.4);
    hd_rational plain, set;
    double off = 0;
    int k;
    f.tol = 1e-7;
    CHECK(hd_rational_fit(&plain, &f, 1e5, NULL, NULL) == HD_OK);
    f.weight = exp(-3);
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, NULL) == HD_OK && set.degree <= 17);
    for (k = 0; k <= 100000; k++) {
        const double l = 1e5 * pow(10, -k / 1e4), e = fabs(filt_want(&f, l) - hd_rational_eval(&set, -set.t * l));
        off = fmax(off, (1 + f.weight * l) * e);
        CHECK(e <= set.max_error && (1 + set.t * l) * e <= set.max_weighted_error);
    }
    CHECK_MSG(off <= 1.1e-7 && set.max_weighted_error < 0.02 * plain.max_weighted_error, "error %g, reported %g, plain %g", off, set.max_weighted_error, plain.max_weighted_error);
}

static double filt_high_pass(double lambda, void *user) { return 1 - exp(-lambda * *(double *)user); }
static double filt_bad(double lambda, void *user) { return lambda > *(double *)user ? HUGE_VAL : 1; }
static double filt_spike(double lambda, void *user) { return 1 / (1 + pow((lambda / *(double *)user - 1) / 1e-6, 2)); }
static double filt_zero(double lambda, void *user) { return 0 * lambda + *(double *)user; }

static void filt_own(void) {
    double t = 0.5, zero = 0, off = 0, top = 1e5;
    hd_filter f = filt_make(HD_FILTER_OWN, 0, 0);
    hd_rational set;
    hd_error e;
    int k;
    f.f = filt_high_pass;
    f.user = &t;
    f.constant = 1;
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, NULL) == HD_OK && fabs(set.a0 - 1) < 1e-8 && set.degree <= 12);
    for (k = 0; k <= 1000; k++) off = fmax(off, fabs(filt_high_pass(100.0 * k, &t) - hd_rational_eval(&set, -set.t * 100.0 * k)));
    CHECK_MSG(off <= set.max_error && off < 1e-9, "error %g, reported %g", off, set.max_error);
    f.f = filt_bad;
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, &e) == HD_ERR_NOT_FINITE && e.value > 0.5 && e.value <= 1e5);
    f.constant = 0;
    f.f = filt_spike;                            /* its pole is too near to be taken, and that is told */
    f.user = &top;
    CHECK(hd_rational_fit(&set, &f, top, NULL, &e) == HD_WARN_ACCURACY && set.max_error > 0.1);
    for (k = 0; k < set.n_poles; k++) CHECK(set.theta[k].re > 0 || set.theta[k].im > 1e-5 * fabs(set.theta[k].re));
    f.f = filt_zero;
    f.user = &zero;
    CHECK(hd_rational_fit(&set, &f, 1e5, NULL, &e) == HD_ERR_ARGUMENT);
}

/* exp(-lambda), but something else on a narrow band. */
typedef struct filt_hole { double from, to, value; int hits; } filt_hole;

static double filt_holed(double lambda, void *user) {
    filt_hole *x = (filt_hole *)user;
    if (lambda < x->from || lambda > x->to) return exp(-lambda);
    x->hits++;
    return x->value;
}

/* No value is overlooked that is not finite, whatever point of whichever grid it is at. */
static void filt_holes(void) {
    const double values[3] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    hd_filter f = filt_make(HD_FILTER_OWN, 0, 0), several[3];
    hd_rational set, sets[3];
    filt_hole hole;
    hd_error e;
    hd_status st;
    int k, q, seen = 0;
    f.f = filt_holed;
    f.user = &hole;
    for (k = 0; k < 30; k++) {
        hole.value = values[k % 3];
        hole.hits = 0;
        hole.from = pow(10, -4 + 7 * k / 29.0);
        hole.to = k == 28 ? hole.from : hole.from * (1 + pow(10, -4 + 3 * (k * 7 % 30) / 30.0));
        st = hd_rational_fit(&set, &f, 1000, NULL, &e);
        seen += hole.hits > 0;
        CHECK_MSG(hole.hits == 0 ? st == HD_OK : st == HD_ERR_NOT_FINITE && hole.hits == 1 && e.value >= hole.from && e.value <= hole.to,
                  "%g at %g: %s, value %g", hole.value, hole.from, hd_status_name(st), e.value);
    }
    CHECK_MSG(seen >= 15, "%d holes were seen", seen);
    for (k = 0; k < 6; k++) {                    /* of several: a wide hole, or one that few points meet */
        hole.value = values[k % 3];
        hole.hits = 0;
        hole.from = k < 3 ? 1e-3 : 2.4926e-4;
        hole.to = k < 3 ? 1 : 2.49362e-4;
        for (q = 0; q < 3; q++) several[q] = filt_make(HD_FILTER_HEAT, 1 + q, 0);
        several[k % 3] = f;
        st = hd_rational_fit_shared(sets, 3, several, 1000, NULL, &e);
        CHECK_MSG(hole.hits == 1 && st == HD_ERR_NOT_FINITE && e.column == k % 3, "of three, hole %d: %d hits, %s, column %d", k, hole.hits, hd_status_name(st), (int)e.column);
    }
}

static void filt_arguments(void) {
    const hd_filter good = filt_make(HD_FILTER_BAND, 1, 2);
    hd_filter f;
    hd_rational set, kept;
    hd_context ctx;
    hd_error e;
    uint64_t limit;
    memset(&set, 0x11, sizeof set);
    kept = set;
    CHECK(hd_rational_fit(NULL, &good, 10, NULL, &e) == HD_ERR_ARGUMENT && hd_rational_fit(&set, NULL, 10, NULL, NULL) == HD_ERR_ARGUMENT);
#define FILT_BAD(change)                                                                                                              \
    f = good;                                                                                                                         \
    change;                                                                                                                           \
    CHECK_MSG(hd_rational_fit(&set, &f, 10, NULL, &e) == HD_ERR_ARGUMENT && strncmp(e.text, "filter: ", 8) == 0, "%s: %s", #change, e.text)
    FILT_BAD(f.begin_zero = 1);
    FILT_BAD(f.end_zero = 1);
    FILT_BAD(f.kind = HD_FILTER_OWN);
    FILT_BAD(f.kind = (hd_filter_kind)99);
    FILT_BAD(f.a = 0);
    FILT_BAD(f.a = (double)NAN);
    FILT_BAD(f.b = 0.5);
    FILT_BAD(f.b = (double)INFINITY);
    FILT_BAD(f.tol = -1);
    FILT_BAD(f.tol = 1);
    FILT_BAD(f.weight = -1);
    FILT_BAD(f.max_degree = -1);
    FILT_BAD(f.max_degree = HD_MAX_POLES + 1);
    FILT_BAD(f.lambda_min = -1);
    FILT_BAD(f.lambda_min = 10);
    FILT_BAD(f.kind = (hd_filter_kind)-1);
    FILT_BAD(f.tol = (double)NAN);
    FILT_BAD(f.weight = (double)INFINITY);
    FILT_BAD(f.lambda_min = (double)NAN);
    FILT_BAD((f.kind = HD_FILTER_WAVE, f.b = 0));
    FILT_BAD((f.kind = HD_FILTER_FRACTIONAL, f.b = -1));
#undef FILT_BAD
    CHECK(hd_rational_fit(&set, &good, 0, NULL, &e) == HD_ERR_ARGUMENT && hd_rational_fit(&set, &good, HUGE_VAL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(memcmp(&set, &kept, sizeof set) == 0);
    for (limit = 1;; limit++) {                  /* the limit-th allocation fails */
        hd_status st;
        memset(&ctx, 0, sizeof ctx);
        ctx.allocation_limit = limit;
        st = hd_rational_fit(&set, &good, 10, &ctx, &e);
        CHECK(ctx.bytes_in_use == 0);
        if (st == HD_OK || !CHECK(st == HD_ERR_MEMORY_LIMIT && limit < 30)) break;
    }
    f = good;
    f.max_degree = HD_MAX_POLES;
    f.tol = 1e-15;
    CHECK(hd_rational_fit(&set, &f, 10, NULL, &e) >= 0 && set.n_poles <= HD_MAX_POLES);
}

/* ---- queries ---- */

/* A filter on a mesh: the set, a plan, and f at all eigenvalues. */
typedef struct filt_case {
    const heat_case *c;
    hd_rational set;
    hd_heat *heat;
    double *g;                   /* [n] */
    double *K;                   /* [n n] f(B^-1 L) B^-1 */
    const char *what;
} filt_case;

/* Rounding of the oracle, relative to the largest value that a term can have. */
static double filt_slack(const filt_case *x) { return 1e-11 * dense_max_abs(x->K, (int64_t)x->c->pair.n * x->c->pair.n); }

/* Does the largest error stay below the bound, and is the bound of use? */
static void filt_judge(const filt_case *x, const char *query, double off, double size, const hd_report *rep, double slack, double useful) {
    CHECK_MSG(off <= rep->error_bound * size + slack, "%s, %s, %s: error %g, bound %g", x->c->what, x->what, query, off / size, rep->error_bound);
    CHECK_MSG(rep->error_bound <= useful, "%s, %s, %s: bound %g (rational %g, solver %g, rounding %g), error %g", x->c->what, x->what, query, rep->error_bound,
              rep->error_rational, rep->error_solver, rep->error_rounding, off / size);
    CHECK(rep->evidence_rational == HD_EVIDENCE_MEASURED && rep->error_rational > 0 && rep->poles == HD_POLES_OWN && rep->n_poles == x->set.n_poles);
}

static void filt_columns(const filt_case *x) {
    const heat_case *c = x->c;
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active, source = lap->vertex[n / 3];
    double *u = DENSE_NEW(double, lap->n), *f = DENSE_NEW(double, lap->n), *rhs = DENSE_NEW(double, n), *want = DENSE_NEW(double, n);
    uint64_t seed = 3;
    hd_report rep;
    int q;
    int32_t i;
    for (i = 0; i < lap->n; i++) f[i] = dense_signed(&seed);
    for (q = 0; q < 3; q++) {
        const hd_kernel kernel = q == 1 ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        double off = 0, size = 0;
        hd_status st;
        if (q < 2) heat_source_rhs(c, source, kernel, rhs);
        else heat_field_rhs(c, f, rhs);
        dense_pair_filter(&c->pair, x->g, rhs, want);
        st = q < 2 ? heat_columns(x->heat, x->set.t, kernel, 1, &source, u, 0, &rep) : heat_apply(x->heat, x->set.t, 1, f, 0, u, 0, &rep);
        if (!CHECK_MSG(st >= 0, "%s, %s: %s", c->what, x->what, rep.error.text)) continue;
        for (i = 0; i < n; i++) {
            off = fmax(off, fabs(u[lap->vertex[i]] - want[i]));
            size = fmax(size, fabs(u[lap->vertex[i]]));
        }
        filt_judge(x, q == 0 ? "column of K" : q == 1 ? "column of k" : "field", off, size, &rep, 1e-12 * x->set.largest * dense_max_abs(want, n) / x->set.largest + 1e-13 * size, 1e-4);
        if (size > 1e-3 * x->set.largest) CHECK_MSG(off <= 1e-6 * size, "%s, %s: query %d off by %g", c->what, x->what, q, off / size);
    }
    free(u);
    free(f);
    free(rhs);
    free(want);
}

static void filt_diagonals(const filt_case *x) {
    const hd_laplacian *lap = x->c->lap;
    const int32_t n = lap->n_active;
    double *D = DENSE_NEW(double, lap->n), *KB = diag_product(x->K, x->c->pair.B, n), *E = DENSE_NEW(double, lap->L.nnz);
    hd_report rep;
    int q;
    int32_t i;
    int64_t p;
    double off = 0, size = 0, trace = 0, sum = 0;
    for (q = 0; q < 2; q++) {
        const hd_kernel kernel = q ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        double worst = 0;
        off = size = 0;
        if (!CHECK_MSG(heat_diagonal(x->heat, 1, &x->set.t, kernel, D, 0, &rep) >= 0, "%s, %s: %s", x->c->what, x->what, rep.error.text)) continue;
        for (i = 0; i < n; i++) {
            const double want = (q ? KB : x->K)[(size_t)i * (size_t)n + (size_t)i], have = D[lap->vertex[i]];
            off = fmax(off, fabs(have - want));
            size = fmax(size, fabs(have));
            worst = fmax(worst, fabs(have - want) - rep.error_relative * fabs(have));
            if (q) trace += have;
        }
        filt_judge(x, q ? "diagonal of K" : "diagonal of k", off, size, &rep, q ? 1e-11 : filt_slack(x), 1e-3);
        CHECK_MSG(worst <= (q ? 1e-11 : filt_slack(x)), "%s, %s: relative bound %g", x->c->what, x->what, rep.error_relative);
        CHECK_MSG(off <= 1e-6 * size, "%s, %s: diagonal %d off by %g", x->c->what, x->what, q, off / size);
    }
    for (i = 0; i < n; i++) sum += x->g[i];
    CHECK_MSG(fabs(trace - sum) <= 1e-6 * sum, "%s, %s: the trace is %g, not %g", x->c->what, x->what, trace, sum);
    if (CHECK_MSG(heat_edges(x->heat, x->set.t, E, &rep) >= 0, "%s", rep.error.text)) {
        for (off = size = 0, i = 0; i < n; i++) {
            for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
                off = fmax(off, fabs(E[p] - x->K[(size_t)i * (size_t)n + (size_t)lap->L.col[p]]));
                size = fmax(size, fabs(E[p]));
            }
        }
        filt_judge(x, "edges", off, size, &rep, filt_slack(x), 1e-3);
    }
    free(D);
    free(KB);
    free(E);
}

/* d^2 of a kind between rows i and j: from K, or with BKB for weighted. */
static double filt_distance(const double *F, int32_t n, int32_t i, int32_t j) {
    const size_t a = (size_t)i, b = (size_t)j, ld = (size_t)n;
    return sqrt(fmax(0, F[a * ld + a] - 2 * F[a * ld + b] + F[b * ld + b]));
}

static void filt_distances(const filt_case *x) {
    const hd_laplacian *lap = x->c->lap;
    const int32_t n = lap->n_active, row = n / 3, source = lap->vertex[row];
    double *d = DENSE_NEW(double, lap->n), *KB = diag_product(x->K, x->c->pair.B, n), *BKB = diag_product(x->c->pair.B, KB, n);
    double *K = DENSE_NEW(double, lap->n), *both = DENSE_NEW(double, lap->n);
    int32_t *from = DENSE_NEW(int32_t, lap->n), *to = DENSE_NEW(int32_t, lap->n), i;
    hd_report rep;
    int q;
    for (i = 0; i < n; i++) {
        from[i] = lap->vertex[i % 2 ? row : n / 2];
        to[i] = lap->vertex[i];
    }
    for (q = 0; q < 4; q++) {                    /* two kinds, one to all and pairs */
        const hd_distance_kind kind = q % 2 ? HD_DISTANCE_WEIGHTED : HD_DISTANCE_CLASSICAL;
        const double *F = q % 2 ? BKB : x->K;
        const double slack = sqrt(1e-13 * dense_max_abs(F, (int64_t)n * n));
        double off = 0, size = 0;
        const hd_status st = q < 2 ? heat_distance(x->heat, kind, 1, &x->set.t, 1, &source, d, 0, &rep)
                                   : heat_pairs(x->heat, kind, x->set.t, n, from, to, NULL, d, &rep);
        if (!CHECK_MSG(st >= 0, "%s, %s: %s", x->c->what, x->what, rep.error.text)) continue;
        for (i = 0; i < n; i++) {
            const double want = filt_distance(F, n, q < 2 ? row : lap->row[from[i]], i), have = q < 2 ? d[lap->vertex[i]] : d[i];
            off = fmax(off, fabs(have - want));
            size = fmax(size, have);
        }
        filt_judge(x, q < 2 ? "distance" : "pairs", off, size, &rep, slack, 0.1);
        CHECK_MSG(off <= 1e-5 * size + slack, "%s, %s: distance %d off by %g", x->c->what, x->what, q, off / size);
    }
    if (CHECK(heat_pairs(x->heat, HD_DISTANCE_CLASSICAL, x->set.t, n, from, to, d, NULL, &rep) >= 0))
        for (i = 0; i < n; i++) CHECK(fabs(d[i] - KB[(size_t)lap->row[from[i]] * (size_t)n + (size_t)i]) <= 1e-7 * dense_max_abs(KB, (int64_t)n * n));
    for (q = 0; q < 2; q++) {                    /* entries and distances at once: the distances as they come alone */
        const hd_distance_kind kind = q ? HD_DISTANCE_WEIGHTED : HD_DISTANCE_CLASSICAL;
        const double most = dense_max_abs(KB, (int64_t)n * n);
        CHECK(heat_pairs(x->heat, kind, x->set.t, n, from, to, NULL, d, &rep) >= 0);
        if (!CHECK(heat_pairs(x->heat, kind, x->set.t, n, from, to, K, both, &rep) >= 0)) continue;
        CHECK(dense_max_diff(both, d, n) == 0);
        for (i = 0; i < n; i++) CHECK(fabs(K[i] - KB[(size_t)lap->row[from[i]] * (size_t)n + (size_t)i]) <= 1e-7 * most);
    }
    free(K);
    free(both);
    CHECK(heat_entries(x->heat, x->set.t, HD_KERNEL_SYMMETRIC, n, from, to, d, &rep) >= 0);
    for (i = 0; i < n; i++) CHECK(fabs(d[i] - x->K[(size_t)lap->row[from[i]] * (size_t)n + (size_t)i]) <= 1e-7 * dense_max_abs(x->K, (int64_t)n * n));
    free(d);
    free(KB);
    free(BKB);
    free(from);
    free(to);
}

/* One plan, many filters, and heat in between: the answers of plans of their own. */
static void filt_one_plan(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double top = hd_laplacian_lambda_max(lap), t = 4 * lap->h * lap->h;
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_heat *one = eng_create(lap, &o), *krylov;
    double *D = DENSE_NEW(double, s.n), *want = DENSE_NEW(double, s.n), *u = DENSE_NEW(double, s.n), *heat = DENSE_NEW(double, s.n);
    hd_filter f[FILT_LIST];
    hd_rational set;
    hd_report rep;
    hd_error e;
    int q;
    CHECK(heat_diagonal(one, 1, &t, HD_KERNEL_SYMMETRIC, heat, 0, NULL) == HD_OK);
    filt_list(f, 1e-3 * top, top);
    for (q = 0; q < FILT_LIST; q++) {
        hd_heat *own;
        if (!CHECK(hd_rational_fit(&set, f + q, top, NULL, &e) == HD_OK)) continue;
        CHECK(hd_heat_set_rational(one, &set, &e) == HD_OK);
        o.rational = &set;
        own = eng_create(lap, &o);
        CHECK(heat_diagonal(own, 1, &set.t, HD_KERNEL_SYMMETRIC, want, 0, NULL) >= 0 && heat_diagonal(one, 1, &set.t, HD_KERNEL_SYMMETRIC, D, 0, &rep) >= 0);
        CHECK(dense_max_diff(D, want, s.n) == 0 && rep.n_poles == set.n_poles);
        CHECK(heat_column(own, set.t, 5, want, NULL) >= 0 && heat_column(one, set.t, 5, u, NULL) >= 0);
        CHECK(dense_max_diff(u, want, s.n) <= 1e-8 * dense_max_abs(want, s.n));
        CHECK(heat_column(one, t, 5, u, NULL) == HD_ERR_ARGUMENT);
        hd_heat_free(own);
        if (q % 3) continue;
        CHECK(hd_heat_set_rational(one, NULL, &e) == HD_OK && heat_diagonal(one, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_OK);
        CHECK(dense_max_diff(D, heat, s.n) == 0 && rep.poles != HD_POLES_OWN);
    }
    CHECK(hd_heat_set_rational(NULL, &set, &e) == HD_ERR_ARGUMENT);
    set.theta[0].im = -1;
    CHECK(hd_heat_set_rational(one, &set, &e) == HD_ERR_ARGUMENT && e.pole == 0);
    set.theta[0].im = 1;
    o.rational = NULL;
    o.method = HD_METHOD_KRYLOV;
    krylov = eng_create(lap, &o);
    CHECK(hd_heat_set_rational(krylov, &set, &e) == HD_ERR_ARGUMENT && strstr(e.text, "krylov") && hd_heat_set_rational(krylov, NULL, &e) == HD_OK);
    hd_heat_free(krylov);
    hd_heat_free(one);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(D);
    free(want);
    free(u);
    free(heat);
}

static void filt_on(const heat_case *c, const hd_filter *f, const char *what) {
    static const hd_method methods[2] = {HD_METHOD_DIRECT, HD_METHOD_ITERATIVE};
    const int32_t n = c->lap->n_active;
    filt_case x;
    hd_error e;
    int q;
    int32_t i;
    x.c = c;
    x.what = what;
    x.g = DENSE_NEW(double, n);
    if (!CHECK_MSG(hd_rational_fit(&x.set, f, hd_laplacian_lambda_max(c->lap), NULL, &e) == HD_OK, "%s, %s: %s", c->what, what, e.text)) return;
    for (i = 0; i < n; i++) x.g[i] = filt_want(f, c->pair.lambda[i] > 1e-9 * c->top ? c->pair.lambda[i] : 0);
    x.K = diag_matrix(c, x.g);
    for (q = 0; q < 2; q++) {
        hd_heat_opts o = eng_opts(methods[q]);
        o.rational = &x.set;
        x.heat = eng_create(c->lap, &o);
        filt_columns(&x);
        if (q == 0) filt_diagonals(&x);
        if (q == 0) filt_distances(&x);
        hd_heat_free(x.heat);
    }
    free(x.g);
    free(x.K);
}

static void filt_queries(void) {
    static const char *const names[FILT_LIST] = {"heat", "wave 0", "wave 1", "wave 2", "wave 3", "Mexican hat", "resolvent", "root", "band", "biharmonic"};
    shape s[3];
    hd_filter f[FILT_LIST];
    int k, q;
    s[0] = shape_torus(16, 8, 2, 0.7);
    s[1] = shape_grid(11, 9, 0.3);
    s[2] = shape_icosphere(2);
    for (k = 0; k < 3; k++) {
        heat_case c = heat_case_of(test_laplacian(s + k, op_kinds[k]), k == 0 ? "torus fem" : k == 1 ? "grid voronoi" : "ball cot");
        double low = HUGE_VAL;
        int32_t i;
        for (i = 0; i < c.lap->n_active; i++)
            if (c.pair.lambda[i] > 1e-9 * c.top) low = fmin(low, c.pair.lambda[i]);
        CHECK_MSG(hd_laplacian_lambda_max(c.lap) >= c.top && hd_laplacian_lambda_max(c.lap) < 6 * c.top, "largest eigenvalue %g, bound %g", c.top, hd_laplacian_lambda_max(c.lap));
        filt_list(f, 0.9 * low, c.top);
        for (q = 0; q < FILT_LIST; q++) filt_on(&c, f + q, names[q]);
        heat_case_free(&c);
        shape_free(s + k);
    }
}

/* A filter of heat is heat, at its own time and at no other. */
/* ---- filters that share their poles ---- */

enum { FILT_SHARED = 60 };

/* Waves evenly from low to top, and the last two a heat kernel and a Mexican hat. */
static void filt_many(hd_filter *f, int count, double low, double top) {
    int q;
    for (q = 0; q < count; q++) {
        f[q] = filt_make(HD_FILTER_WAVE, log(low) + (q + 0.5) * log(top / low) / count, 0.07 * log(top / low));
        if (count > 2 && q >= count - 2) f[q] = filt_make(q % 2 ? HD_FILTER_HEAT : HD_FILTER_MEXICAN_HAT, 3 / sqrt(low * top), 0);
        f[q].tol = q % 3 ? 1e-7 : 1e-8;
    }
}

static void filt_shared_sets(void) {
    static const int counts[3] = {1, 7, FILT_SHARED};
    hd_filter f[FILT_SHARED];
    hd_rational *set = (hd_rational *)calloc(FILT_SHARED, sizeof *set), one;
    const double top = 1e5;
    hd_error e;
    int k, q;
    for (k = 0; k < 3; k++) {
        filt_many(f, counts[k], 3, 1e3);
        CHECK_MSG(hd_rational_fit_shared(set, counts[k], f, top, NULL, &e) == HD_OK, "%d filters: %s", counts[k], e.text);
        for (q = 0; q < counts[k]; q++) {
            const double off = filt_error(f + q, set + q, top);
            CHECK_MSG(off <= set[q].max_error && off <= 1.1 * f[q].tol * set[q].largest, "filter %d of %d: error %g, reported %g, largest %g", q, counts[k], off, set[q].max_error,
                      set[q].largest);
            CHECK(set[q].n_poles == set[0].n_poles && set[q].t == set[0].t && memcmp(set[q].theta, set[0].theta, sizeof set[0].theta) == 0 && set[q].kind == HD_POLES_OWN &&
                  set[q].lambda_max == top && set[q].a0 == 0);
        }
    }
    CHECK_MSG(set[0].n_poles <= 28, "%d filters take %d pairs", FILT_SHARED, (int)set[0].n_poles);   /* one takes 9 */
    CHECK(hd_rational_fit(&one, f + FILT_SHARED / 2, top, NULL, NULL) == HD_OK && one.n_poles >= 8);
    f[1].b /= 4;                                 /* too narrow for so small a tolerance: told, and not hidden */
    f[1].tol = 1e-14;
    CHECK(hd_rational_fit_shared(set, 3, f, top, NULL, NULL) == HD_WARN_ACCURACY);
    for (q = 0; q < 3; q++) CHECK(filt_error(f + q, set + q, top) <= set[q].max_error);
    f[1].b = 0;
    CHECK(hd_rational_fit_shared(set, 3, f, top, NULL, &e) == HD_ERR_ARGUMENT && e.column == 1);
    CHECK(hd_rational_fit_shared(set, 0, f, top, NULL, NULL) == HD_ERR_ARGUMENT && hd_rational_fit_shared(NULL, 1, f, top, NULL, NULL) == HD_ERR_ARGUMENT);
    free(set);
}

/* Diagonals and traces of all filters at once against dense ones. */
static void filt_shared_diagonals(const heat_case *c, double low) {
    enum { COUNT = 9 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, m = lap->n_active;
    double *D = DENSE_NEW(double, COUNT * (n + 1)), Z[COUNT], bound[COUNT];
    hd_filter f[COUNT];
    hd_rational set[COUNT];
    hd_heat_opts o;
    hd_heat *heat;
    hd_report rep;
    hd_context ctx;
    int64_t calls = 0;
    int q, round;
    int32_t i, v;
    memset(&o, 0, sizeof o);
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    ctx.progress = est_on_progress;
    ctx.progress_user = &calls;
    filt_many(f, COUNT, low, c->top);
    CHECK(hd_rational_fit_shared(set, COUNT, f, hd_laplacian_lambda_max(lap), NULL, NULL) == HD_OK);
    o.rational = set + 3;
    heat = eng_create(lap, &o);
    for (round = 0; round < 2; round++) {
        for (v = 0; v < COUNT * (n + 1); v++) D[v] = 77;
        CHECK_MSG(hd_heat_filter_diagonals(heat, COUNT, set, D, (size_t)n + 1, round ? NULL : Z, round ? NULL : bound, &rep, NULL) == HD_OK, "%s: %s", c->what, rep.error.text);
        CHECK_MSG(rep.error_bound < 2e-5 && rep.method == HD_METHOD_DIRECT && rep.degree == set[0].degree, "%s: bound %g", c->what, rep.error_bound);
        for (q = 0; q < COUNT; q++) {
            const double *d = D + (size_t)q * ((size_t)n + 1);
            double sum = 0, most = 0, off = 0;
            for (i = 0; i < m; i++) {
                double want = 0;
                int32_t k;
                for (k = 0; k < m; k++) {
                    const double x = c->pair.x[(size_t)k * (size_t)m + (size_t)i];
                    want += filt_want(f + q, fmax(0, c->pair.lambda[k])) * x * x;
                }
                sum += filt_want(f + q, fmax(0, c->pair.lambda[i]));
                most = fmax(most, fabs(want));
                off = fmax(off, fabs(want - d[lap->vertex[i]]));
            }
            for (v = 0; v < n; v++) CHECK(lap->row[v] >= 0 || d[v] == 0);
            CHECK(d[n] == 77);
            CHECK_MSG(off <= rep.error_bound * most && off <= 2e-7 * most, "%s, filter %d: diagonal off by %g of %g, bound %g", c->what, q, off, most, rep.error_bound);
            if (round == 0) CHECK_MSG(fabs(Z[q] - sum) <= bound[q] && fabs(Z[q] - sum) <= 1e-6 * sum && bound[q] < 1e-3 * sum, "%s, filter %d: trace %.12g, not %.12g, bound %g", c->what, q,
                                      Z[q], sum, bound[q]);
        }
    }
    calls = 0;                                   /* the factors serve columns of another filter as well */
    CHECK(hd_heat_set_rational(heat, set + 5, NULL) == HD_OK);
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, set[5].t, lap->vertex[2], D, &rep, NULL) == HD_OK && rep.method == HD_METHOD_DIRECT);
    CHECK_MSG(fabs(D[lap->vertex[2]] - D[(size_t)5 * ((size_t)n + 1) + (size_t)lap->vertex[2]]) <= 1e-7 * dense_max_abs(D, n), "%s: column and diagonal", c->what);
    set[2].theta[1].re *= 1.0001;
    CHECK(hd_heat_filter_diagonals(heat, COUNT, set, D, 0, NULL, NULL, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.column == 2);
    CHECK(hd_heat_filter_diagonals(heat, 0, set, D, 0, NULL, NULL, NULL, NULL) == HD_ERR_ARGUMENT && hd_heat_filter_diagonals(heat, 1, NULL, D, 0, NULL, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_set_rational(heat, NULL, NULL) == HD_OK && hd_heat_filter_diagonals(heat, 1, set, D, 0, NULL, NULL, &rep, NULL) == HD_ERR_ARGUMENT);
    hd_heat_free(heat);
    free(D);
}

static void filt_shared(void) {
    int k;
    filt_shared_sets();
    for (k = 0; k < 4; k++) {
        shape s = k == 0 ? shape_torus(16, 8, 2, 0.7) : k == 1 ? shape_grid(11, 9, 0.3) : k == 2 ? shape_icosphere(2) : shape_grid(9, 8, 0.2);
        const int32_t held[2] = {3, 40};
        const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 2, held);
        heat_case c = heat_case_of(k < 3 ? test_laplacian(&s, op_kinds[k]) : bord_triangles(&s, &o), k == 0 ? "torus fem" : k == 1 ? "grid voronoi" : k == 2 ? "ball cot" : "held");
        double low = HUGE_VAL;
        int32_t i;
        for (i = 0; i < c.lap->n_active; i++)
            if (c.pair.lambda[i] > 1e-9 * c.top) low = fmin(low, c.pair.lambda[i]);
        filt_shared_diagonals(&c, 0.9 * low);
        heat_case_free(&c);
        shape_free(&s);
    }
}

static void filt_refused(void) {
    shape s = shape_grid(9, 7, 0.3);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM), *small;
    hd_filter f = filt_make(HD_FILTER_HEAT, 3 * lap->h * lap->h, 0);
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_rational set, bad;
    hd_heat *heat, *plain = eng_create(lap, &o), *none = NULL;
    hd_report rep;
    hd_error e;
    double *u = DENSE_NEW(double, 2 * s.n), *w = DENSE_NEW(double, s.n), t[2];
    const int32_t source = 10, other = 20;
    int32_t i;
    CHECK(hd_rational_fit(&set, &f, hd_laplacian_lambda_max(lap), NULL, &e) == HD_OK);
    o.rational = &set;
    heat = eng_create(lap, &o);
    CHECK(heat_column(heat, set.t, source, u, NULL) >= 0 && heat_column(plain, f.a, source, w, NULL) >= 0);
    CHECK(dense_max_diff(u, w, s.n) < 1e-7 * dense_max_abs(w, s.n));
    f.a *= 2;                                    /* d^2 is the sum of the filter itself */
    hd_heat_free(heat);
    CHECK(hd_rational_fit(&set, &f, hd_laplacian_lambda_max(lap), NULL, &e) == HD_OK);
    heat = eng_create(lap, &o);
    f.a /= 2;
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &set.t, 1, &source, u, 0, NULL) >= 0 && heat_distance(plain, HD_DISTANCE_CLASSICAL, 1, &f.a, 1, &source, w, 0, NULL) >= 0);
    for (i = 0; i < s.n; i++) CHECK(fabs(u[i] - w[i]) < 1e-6 * dense_max_abs(w, s.n));
    t[0] = set.t;
    t[1] = 2 * set.t;
    CHECK(heat_times(heat, 2, t, HD_KERNEL_OPERATOR, source, NULL, u, 0, &rep) == HD_ERR_ARGUMENT && rep.error.column == 1 && rep.error.value == t[1]);
    CHECK(heat_diagonal(heat, 1, t + 1, HD_KERNEL_SYMMETRIC, u, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, t + 1, 1, &source, u, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, set.t, 4, 0, (int32_t *)(void *)u, w, &rep) >= 0 && heat_sample(heat, HD_DISTANCE_CLASSICAL, 1.5 * set.t, 4, 0, (int32_t *)(void *)u, w, &rep) == HD_ERR_ARGUMENT);
    t[1] = set.t;                                /* twice the same is fine */
    CHECK(heat_times(heat, 2, t, HD_KERNEL_OPERATOR, source, NULL, u, 0, &rep) >= 0 && dense_max_diff(u, u + s.n, s.n) == 0);
    CHECK(heat_distance(heat, HD_DISTANCE_COMMUTE, 0, NULL, 1, &source, u, 0, &rep) >= 0);
    hd_heat_free(heat);
    o.method = HD_METHOD_ITERATIVE;              /* entries of pairs by iterations, distances not */
    heat = eng_create(lap, &o);
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, set.t, 1, &source, &other, u, NULL, &rep) >= 0);
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, set.t, 1, &source, &other, u, w, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, &set.t, HD_KERNEL_SYMMETRIC, u, 0, &rep) == HD_ERR_ARGUMENT);
    hd_heat_free(heat);
    o.method = HD_METHOD_KRYLOV;
    CHECK(hd_heat_create(&none, lap, &o, &e) == HD_ERR_ARGUMENT && strstr(e.text, "poles") != NULL);
    o.method = HD_METHOD_AUTO;
    bad = set;
    o.rational = &bad;
    bad.lambda_max = 0.9 * hd_laplacian_lambda_max(lap);
    heat = eng_create(lap, &o);
    CHECK(heat_column(heat, bad.t, source, u, &rep) == HD_ERR_ARGUMENT && fabs(rep.error.value / hd_laplacian_lambda_max(lap) - 1) < 1e-12);
    hd_heat_free(heat);
    bad.t = (double)NAN;
    CHECK(hd_heat_create(&none, lap, &o, &e) == HD_ERR_ARGUMENT && !none);
    for (i = 0; i < 3 * s.n; i++) s.xyz[i] *= 0.5;   /* eigenvalues four times as large */
    small = test_laplacian(&s, HD_LAPLACIAN_FEM);
    o.rational = &set;
    heat = eng_create(small, &o);
    CHECK(heat_column(heat, set.t, source, u, &rep) == HD_ERR_ARGUMENT);
    hd_heat_free(heat);
    hd_heat_free(plain);
    hd_laplacian_free(small);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(u);
    free(w);
}

static void test_filters(void) {
    filt_sets();
    filt_known();
    filt_honest();
    filt_overflow();
    filt_weight();
    filt_own();
    filt_holes();
    filt_arguments();
    filt_queries();
    filt_one_plan();
    filt_shared();
    filt_refused();
}

#endif
