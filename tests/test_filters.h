/* test_filters.h - filters of the spectrum: their pole sets against the functions themselves, and every query against the truth */

#ifndef TEST_FILTERS_H
#define TEST_FILTERS_H

enum { FILT_LIST = 10, FILT_POINTS = 20000 };

/* What hd_filter_kind says, once more. */
static double filt_want(const hd_filter *f, double l) {
    const double a = f->a, b = f->b;
    if (l <= 0) return f->kind == HD_FILTER_WAVE || f->kind == HD_FILTER_MEXICAN_HAT ||
            f->kind == HD_FILTER_BAND ? 0 : f->kind == HD_FILTER_BIHARMONIC ? 1 / (a * a) : 1;
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
        const double s = (k % (FILT_POINTS / 2) + 0.37) / (FILT_POINTS / 2);
        const double l = k < FILT_POINTS / 2 ? from * pow(top / from, s) : from + s * (top - from);
        most = fmax(most, fabs(filt_want(f, l) - hd_rational_eval(set, -set->t * l)));
    }
    return most;
}

static void filt_check_set(const hd_filter *f, const hd_rational *set, double top, const char *what) {
    const double off = filt_error(f, set, top);
    double largest = filt_want(f, 0);
    int32_t i, degree = 0;
    int k;
    for (k = 0; k <= 2000; k++) largest = fmax(largest, filt_want(f, top * pow(10, -k / 200.0)));
    CHECK_MSG(off <= 1e-8 * largest && set->degree <= 24, "%s: error %g with degree %d", what, off / largest, (int)set->degree);
    CHECK_MSG(off <= set->max_error && set->max_error <= set->max_weighted_error, "%s: error %g, reported %g, weighted %g",
        what, off, set->max_error, set->max_weighted_error);
    CHECK_MSG(fabs(set->largest / largest - 1) < 1e-2 && set->lambda_max == top && set->t > 0, "%s: largest value %g, not %g",
        what, set->largest, largest);
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
            CHECK_MSG(hd_rational_fit(&set, 1, f + q, top[k], NULL, &e) == HD_OK, "%s: %s", what, e.text);
            filt_check_set(f + q, &set, top[k], what);
            CHECK(fabs(hd_filter_eval(f + q, 3 * low[k]) - filt_want(f + q, 3 * low[k])) <= 1e-12 * set.largest &&
                fabs(hd_filter_eval(f + q, 0) - filt_want(f + q, 0)) <= 1e-12 * set.largest);
        }
    }
}

/* Rational filters are found with the poles that they have, and more than these are not taken. */
static void filt_known(void) {
    hd_filter f = filt_make(HD_FILTER_RESOLVENT, 0.25, 0);
    hd_rational set;
    CHECK(hd_rational_fit(&set, 1, &f, 1e4, NULL, NULL) == HD_OK && set.degree == 1 && set.n_poles == 1);
    CHECK(fabs(set.theta[0].re / set.t - 4) < 1e-7 && set.theta[0].im == 0);
    f = filt_make(HD_FILTER_BIHARMONIC, 3, 0);
    CHECK(hd_rational_fit(&set, 1, &f, 1e4, NULL, NULL) == HD_OK && set.degree == 2 && set.n_poles == 1);
    CHECK(hypot(set.theta[0].re, set.theta[0].im - 3 * set.t) < 1e-6 * set.t);
    f = filt_make(HD_FILTER_BAND, 2, 8);
    CHECK(hd_rational_fit(&set, 1, &f, 1e4, NULL, NULL) == HD_OK && set.degree == 8 && set.n_poles == 4);
}

/* What cannot be had is told: root singularities at 0 without a gap, few poles. A larger error is never hidden. */
static void filt_honest(void) {
    hd_filter f = filt_make(HD_FILTER_FRACTIONAL, 1, 0.5);
    hd_rational set;
    double off;
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, NULL) == HD_WARN_ACCURACY);
    off = filt_error(&f, &set, 1e5);
    CHECK_MSG(off > 1e-8 && off <= set.max_error && set.max_error < 1e-3, "error %g, reported %g", off, set.max_error);
    f = filt_make(HD_FILTER_WAVE, 3, 0.4);
    f.max_degree = 8;
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, NULL) == HD_WARN_ACCURACY && set.degree <= 8);
    off = filt_error(&f, &set, 1e5);
    CHECK_MSG(off > 1e-6 && off <= set.max_error && set.max_error < 1e-2, "error %g, reported %g", off, set.max_error);
    f.max_degree = 0;
    f.tol = 1e-4;
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, NULL) == HD_OK && set.degree < 16 && set.max_error < 1.06e-4);
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
    CHECK(hd_rational_fit(&set, 1, &f, 28.9, NULL, &e) == HD_ERR_BREAKDOWN && strstr(e.text, "range of doubles"));
    CHECK(memcmp(&set, &before, sizeof set) == 0);
    CHECK(hd_rational_fit(&set, 1, &f, 28.9, NULL, &e) == HD_ERR_BREAKDOWN && e.column == 0);
}

/* A weight makes the error small where it is large, and says so. */
static void filt_weight(void) {
    hd_filter f = filt_make(HD_FILTER_WAVE, 3, 0.4);
    hd_rational plain, set;
    double off = 0;
    int k;
    f.tol = 1e-7;
    CHECK(hd_rational_fit(&plain, 1, &f, 1e5, NULL, NULL) == HD_OK);
    f.weight = exp(-3);
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, NULL) == HD_OK && set.degree <= 17);
    for (k = 0; k <= 20000; k++) {
        const double l = 1e5 * pow(10, -k / 2e3), e = fabs(filt_want(&f, l) - hd_rational_eval(&set, -set.t * l));
        off = fmax(off, (1 + f.weight * l) * e);
        CHECK(e <= set.max_error && (1 + set.t * l) * e <= set.max_weighted_error);
    }
    CHECK_MSG(off <= 1.1e-7 && set.max_weighted_error < 0.02 * plain.max_weighted_error, "error %g, reported %g, plain %g",
        off, set.max_weighted_error, plain.max_weighted_error);
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
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, NULL) == HD_OK && fabs(set.a0 - 1) < 1e-8 && set.degree <= 12);
    for (k = 0; k <= 1000; k++) off = fmax(off, fabs(filt_high_pass(100.0 * k, &t) - hd_rational_eval(&set, -set.t * 100.0 * k)));
    CHECK_MSG(off <= set.max_error && off < 1e-9, "error %g, reported %g", off, set.max_error);
    f.f = filt_bad;
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, &e) == HD_ERR_NOT_FINITE && e.value > 0.5 && e.value <= 1e5);
    f.constant = 0;
    f.f = filt_spike;                            /* its pole is too near to be taken, and that is told */
    f.user = &top;
    CHECK(hd_rational_fit(&set, 1, &f, top, NULL, &e) == HD_WARN_ACCURACY && set.max_error > 0.1);
    for (k = 0; k < set.n_poles; k++) CHECK(set.theta[k].re > 0 || set.theta[k].im > 1e-5 * fabs(set.theta[k].re));
    f.f = filt_zero;
    f.user = &zero;
    CHECK(hd_rational_fit(&set, 1, &f, 1e5, NULL, &e) == HD_ERR_ARGUMENT);
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
        st = hd_rational_fit(&set, 1, &f, 1000, NULL, &e);
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
        st = hd_rational_fit(sets, 3, several, 1000, NULL, &e);
        CHECK_MSG(hole.hits == 1 && st == HD_ERR_NOT_FINITE && e.column == k % 3, "of three, hole %d: %d hits, %s, column %d",
            k, hole.hits, hd_status_name(st), (int)e.column);
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
    CHECK(hd_rational_fit(NULL, 1, &good, 10, NULL, &e) == HD_ERR_ARGUMENT && hd_rational_fit(&set, 1, NULL, 10, NULL, NULL) == HD_ERR_ARGUMENT);
#define FILT_BAD(change)                                                                                                              \
    f = good;                                                                                                                         \
    change;                                                                                                                           \
    CHECK_MSG(hd_rational_fit(&set, 1, &f, 10, NULL, &e) == HD_ERR_ARGUMENT && strncmp(e.text, "filter: ", 8) == 0, "%s: %s", #change, e.text)
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
    CHECK(hd_rational_fit(&set, 1, &good, 0, NULL, &e) == HD_ERR_ARGUMENT && hd_rational_fit(&set, 1, &good, HUGE_VAL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(memcmp(&set, &kept, sizeof set) == 0);
    for (limit = 1;; limit++) {                  /* the limit-th allocation fails */
        hd_status st;
        memset(&ctx, 0, sizeof ctx);
        ctx.allocation_limit = limit;
        st = hd_rational_fit(&set, 1, &good, 10, &ctx, &e);
        CHECK(ctx.bytes_in_use == 0);
        if (st == HD_OK || !CHECK(st == HD_ERR_MEMORY_LIMIT && limit < 30)) break;
    }
    f = good;
    f.max_degree = HD_MAX_POLES;
    f.tol = 1e-15;
    CHECK(hd_rational_fit(&set, 1, &f, 10, NULL, &e) >= 0 && set.n_poles <= HD_MAX_POLES);
}

/* ---- queries ---- */

#define FILT_FITTED " own=fitted th=0.7 seed=0|1|2|3|4|5|6|7"
#define FILT_PAIR(pairs) \
    {pairs FILT_FITTED " query=column kernel=operator|symmetric method=direct|iterative", 1e-6, 0, 0}, \
    {pairs FILT_FITTED " query=apply method=direct|iterative", 1e-6, 0, 0}, \
    {pairs FILT_FITTED " query=diagonal kernel=operator|symmetric method=direct", 1e-6, 0, 0}, \
    {pairs FILT_FITTED " query=distance|pairs kind=classical|weighted method=direct k=3", 1e-5, 0, 0}, \
    {pairs FILT_FITTED " query=entries kernel=operator|symmetric method=direct|iterative k=20", 1e-6, 0, 0}

static const case_row filt_rows[] = {
    FILT_PAIR("shape=torus/9/6 op=fem"),
    FILT_PAIR("shape=flat/8/6/0.3 op=vor"),
    FILT_PAIR("shape=ico/1 op=cot"),
};

static void filt_cases(void) { CASES(filt_rows); }

static hd_rational filt_fit(const hd_filter *f, const hd_laplacian *lap) {
    hd_rational set;
    hd_error e;
    memset(&set, 0, sizeof set);
    CHECK_MSG(hd_rational_fit(&set, 1, f, lap->lambda_max, NULL, &e) == HD_OK, "%s", e.text);
    return set;
}

static hd_heat *filt_plan(const hd_laplacian *lap, const hd_rational *set, const char *options) {
    hd_heat *heat = kit_heat(lap, options);
    hd_error e;
    CHECK_MSG(hd_heat_set_rational(heat, 1, set, &e) == HD_OK, "%s", e.text);
    return heat;
}

/* A filter is what it is at any time, however small: r(0) need not be 1. */
static void filt_early(void) {
    static const double t[3] = {1e-12, 1e-250, 5e-324};
    hd_laplacian *lap = NULL;                    /* eigenvalues near 1e-80: products with times underflow */
    hd_rational set;
    hd_heat *heat;
    hd_error e;
    double u[42];
    int k;
    CHECK(trial_pair(&lap, "ico/1", "fem", 1e40, &e) == HD_OK && lap->n == 42);
    kit_keep(lap, kit_free_laplacian);
    memset(&set, 0, sizeof set);
    set.degree = set.n_poles = 1;
    set.theta[0].re = 2;
    set.a[0].re = -1;                            /* 1/(2 - x) */
    heat = filt_plan(lap, &set, "");
    for (k = 0; k < 3; k++) {
        CHECK(heat_column(heat, t[k], 5, u, NULL) >= 0);
        CHECK_MSG(fabs(u[5] - 0.5) < 1e-9 && fabs(u[6]) < 1e-9, "t %g: %g, %g", t[k], u[5], u[6]);
    }
}

/* Without times, with that of the set: the same answers to the bit. Distances are those of entries. What reports say of a filter. */
static void filt_pairs(void) {
    enum { N = 20 };
    const hd_laplacian *lap = kit_pair("ico/2 fem");
    const double top = lap->lambda_max, *g = kit_random(lap->n, 7);
    const int32_t n = lap->n;
    double *u = KIT_NEW(double, 2 * n), *v = KIT_NEW(double, 2 * n);
    hd_filter f[FILT_LIST];
    double k[5 * N], again[N], d[N], both[N];
    int32_t from[5 * N], to[5 * N], i;
    hd_estimate estimate;
    int q, kind;
    filt_list(f, 1e-3 * top, top);
    for (i = 0; i < N; i++) {
        from[i] = from[N + i] = to[N + i] = from[2 * N + i] = i % 2 ? 50 : 80;
        to[i] = to[2 * N + i] = from[3 * N + i] = to[3 * N + i] = 8 * i;
    }
    for (q = 0; q < FILT_LIST; q += 3) {
        const hd_rational set = filt_fit(f + q, lap);
        const double *t = &set.t;
        hd_heat *heat = filt_plan(lap, &set, "method=direct");
        hd_report rep;
        CHECK(heat_entries(heat, set.t, HD_KERNEL_OPERATOR, N, from, to, k, &rep) >= 0);
        CHECK(rep.evidence_rational == HD_EVIDENCE_MEASURED && rep.error_rational > 0 && rep.poles == HD_POLES_OWN && rep.n_poles == set.n_poles);
        CHECK(hd_heat_entries(heat, HD_KERNEL_OPERATOR, 0, NULL, N, from, to, again, NULL, NULL) >= 0 && memcmp(again, k, sizeof again) == 0);
        CHECK(heat_entries(heat, set.t, HD_KERNEL_SYMMETRIC, 4 * N, from, to, k, NULL) >= 0);
        for (kind = 0; kind < 2; kind++) {
            CHECK(heat_pairs(heat, (hd_distance_kind)kind, set.t, N, from, to, d, &rep) >= 0);
            CHECK(hd_heat_distance_pairs(heat, (hd_distance_kind)kind, 0, NULL, N, from, to, both, NULL, NULL) >= 0 && memcmp(both, d, sizeof d) == 0);
            for (i = 0; i < N && kind == 0; i++)
                CHECK(fabs(d[i] * d[i] - (k[N + i] + k[3 * N + i] - 2 * k[i])) <= 1e-7 * dense_max_abs(k, 4 * N));
            CHECK(hd_heat_distance(heat, (hd_distance_kind)kind, 1, t, VERTICES(1, from), u, 0, NULL, NULL) >= 0 &&
                  hd_heat_distance(heat, (hd_distance_kind)kind, 0, NULL, VERTICES(1, from), v, 0, NULL, NULL) >= 0 && dense_max_diff(u, v, n) == 0);
            CHECK(hd_heat_columns(heat, (hd_kernel)kind, 1, t, VERTICES(2, from), u, 0, NULL, NULL) >= 0 &&
                  hd_heat_columns(heat, (hd_kernel)kind, 0, NULL, VERTICES(2, from), v, 0, NULL, NULL) >= 0 && dense_max_diff(u, v, 2 * n) == 0);
            CHECK(hd_heat_diagonal(heat, (hd_kernel)kind, 1, t, u, 0, u + n, u + n + 1, NULL, NULL) >= 0 &&
                  hd_heat_diagonal(heat, (hd_kernel)kind, 0, NULL, v, 0, v + n, v + n + 1, NULL, NULL) >= 0 && dense_max_diff(u, v, n + 2) == 0);
        }
        CHECK(hd_heat_apply(heat, 1, t, 1, g, 0, u, 0, NULL, NULL) >= 0 && hd_heat_apply(heat, 0, NULL, 1, g, 0, v, 0, NULL, NULL) >= 0 &&
              dense_max_diff(u, v, n) == 0);
        CHECK(hd_heat_adjoint(heat, 1, t, 1, g, 0, u, 0, NULL, NULL) >= 0 && hd_heat_adjoint(heat, 0, NULL, 1, g, 0, v, 0, NULL, NULL) >= 0 &&
              dense_max_diff(u, v, n) == 0);
        CHECK(hd_heat_estimate(heat, HD_QUERY_DIAGONAL, 0, NULL, 0, &estimate, NULL) == HD_OK && estimate.cost[0].possible);
        CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, -1, t, u, 0, NULL, NULL, NULL, NULL) == HD_ERR_ARGUMENT &&
              hd_heat_set_rational(heat, 0, NULL, NULL) == HD_OK &&
              hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, u, 0, NULL, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
    }
}

/* One plan, many filters, and heat in between: the answers of plans of their own. */
static void filt_one_plan(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    const double top = lap->lambda_max, t = 4 * lap->h * lap->h;
    const int32_t n = lap->n;
    hd_heat *one = kit_heat(lap, ""), *krylov = kit_heat(lap, "method=krylov");
    double *room = KIT_NEW(double, 4 * n), *D = room, *want = room + n, *u = room + 2 * n, *heat = room + 3 * n;
    hd_filter f[FILT_LIST];
    hd_rational set;
    hd_report rep;
    hd_error e;
    int q;
    CHECK(heat_diagonal(one, 1, &t, HD_KERNEL_SYMMETRIC, heat, 0, NULL) == HD_OK);
    filt_list(f, 1e-3 * top, top);
    for (q = 0; q < FILT_LIST; q++) {
        hd_heat *own;
        set = filt_fit(f + q, lap);
        CHECK(hd_heat_set_rational(one, 1, &set, &e) == HD_OK);
        own = filt_plan(lap, &set, "");
        CHECK(heat_diagonal(own, 1, &set.t, HD_KERNEL_SYMMETRIC, want, 0, NULL) >= 0 &&
            heat_diagonal(one, 1, &set.t, HD_KERNEL_SYMMETRIC, D, 0, &rep) >= 0);
        CHECK(dense_max_diff(D, want, n) == 0 && rep.n_poles == set.n_poles);
        CHECK(heat_column(own, set.t, 5, want, NULL) >= 0 && heat_column(one, set.t, 5, u, NULL) >= 0);
        CHECK(dense_max_diff(u, want, n) <= 1e-8 * dense_max_abs(want, n));
        CHECK(heat_column(one, t, 5, u, NULL) == HD_ERR_ARGUMENT);
        if (q % 3) continue;
        CHECK(hd_heat_set_rational(one, 0, NULL, &e) == HD_OK && heat_diagonal(one, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &rep) == HD_OK);
        CHECK(dense_max_diff(D, heat, n) == 0 && rep.poles != HD_POLES_OWN);
    }
    CHECK(hd_heat_set_rational(NULL, 1, &set, &e) == HD_ERR_ARGUMENT);
    set.theta[0].im = -1;
    CHECK(hd_heat_set_rational(one, 1, &set, &e) == HD_ERR_ARGUMENT && e.pole == 0);
    set.theta[0].im = 1;
    CHECK(hd_heat_set_rational(krylov, 1, &set, &e) == HD_ERR_ARGUMENT && strstr(e.text, "krylov") && hd_heat_set_rational(krylov, 0, NULL, &e) == HD_OK);
}

/* ---- filters that share their poles ---- */

enum { FILT_SHARED = 16 };

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
    hd_rational *set = KIT_NEW(hd_rational, FILT_SHARED), one;
    const double top = 1e5;
    hd_error e;
    int k, q;
    for (k = 0; k < 3; k++) {
        filt_many(f, counts[k], 3, 1e3);
        CHECK_MSG(hd_rational_fit(set, counts[k], f, top, NULL, &e) == HD_OK, "%d filters: %s", counts[k], e.text);
        for (q = 0; q < counts[k]; q++) {
            const double off = filt_error(f + q, set + q, top);
            CHECK_MSG(off <= set[q].max_error && off <= 1.1 * f[q].tol * set[q].largest,
                "filter %d of %d: error %g, reported %g, largest %g", q, counts[k], off, set[q].max_error,
                      set[q].largest);
            CHECK(set[q].n_poles == set[0].n_poles && set[q].t == set[0].t &&
                memcmp(set[q].theta, set[0].theta, sizeof set[0].theta) == 0 && set[q].kind == HD_POLES_OWN &&
                  set[q].lambda_max == top && set[q].a0 == 0);
        }
    }
    CHECK_MSG(set[0].n_poles <= 24, "%d filters take %d pairs", FILT_SHARED, (int)set[0].n_poles);   /* one takes 9 */
    CHECK(hd_rational_fit(&one, 1, f + FILT_SHARED / 2 + 1, top, NULL, NULL) == HD_OK && one.n_poles >= 8);
    f[0] = filt_make(HD_FILTER_WAVE, 3, 0.4);
    f[1] = filt_make(HD_FILTER_WAVE, 4, 0.05);   /* too narrow for so small a tolerance: told, and not hidden */
    f[0].tol = f[1].tol = 1e-7;
    CHECK(hd_rational_fit(set, 2, f, top, NULL, NULL) == HD_WARN_ACCURACY && set[1].max_error > 1e-7);
    for (q = 0; q < 2; q++) CHECK(filt_error(f + q, set + q, top) <= set[q].max_error);
    f[1].b = 0;
    CHECK(hd_rational_fit(set, 2, f, top, NULL, &e) == HD_ERR_ARGUMENT && e.column == 1);
    CHECK(hd_rational_fit(set, 0, f, top, NULL, NULL) == HD_ERR_ARGUMENT &&
        hd_rational_fit(NULL, 1, f, top, NULL, NULL) == HD_ERR_ARGUMENT);
}

/* Diagonals and traces of all filters at once against the truth, by both kernels: together, and each alone. */
static void filt_shared_diagonals(const char *pairs) {
    enum { COUNT = 5 };
    trial_work *w = case_truth_of(pairs);
    const truth_pairs *T = &w->s->exact;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n;
    double *D = KIT_NEW(double, COUNT * (n + 1)), *alone = KIT_NEW(double, COUNT * n), Z[COUNT], bound[COUNT], one[COUNT], loose[COUNT];
    hd_filter f[COUNT];
    hd_rational set[COUNT];
    hd_heat *heat;
    hd_report rep;
    int q, operator_;
    int32_t v, l;
    filt_many(f, COUNT, 0.9 * T->edge, T->top);
    CHECK(hd_rational_fit(set, COUNT, f, lap->lambda_max, NULL, NULL) == HD_OK);
    CHECK(lap->lambda_max >= T->top && lap->lambda_max < 6 * T->top);
    heat = filt_plan(lap, set + 3, "");
    CHECK(hd_heat_set_rational(heat, COUNT, set, NULL) == HD_OK);
    for (operator_ = 1; operator_ >= 0; operator_--) {
        const hd_kernel kernel = operator_ ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        for (v = 0; v < COUNT * (n + 1); v++) D[v] = 77;
        CHECK_MSG(hd_heat_diagonal(heat, kernel, 0, NULL, D, (size_t)n + 1, Z, bound, &rep, NULL) == HD_OK, "%s: %s", pairs, rep.error.text);
        CHECK_MSG(rep.error_bound < 2e-5 && rep.method == HD_METHOD_DIRECT && rep.degree == set[0].degree, "%s: bound %g", pairs, rep.error_bound);
        for (q = 0; q < COUNT; q++) {
            const double *d = D + (size_t)q * ((size_t)n + 1);
            double sum = 0, most = 0, off = 0, mass = 0;
            w->s->f.of = f[q];
            truth_filter_fill(&w->s->f, T, FORM_FILTER, 0, NULL, 0);
            for (v = 0; v < n; v++) {
                const double want = (double)trial_want_entry(w, v, v, operator_, 0, 0, w->off);
                most = fmax(most, lap->row[v] >= 0 ? fabs(want) : 0);
                off = fmax(off, lap->row[v] >= 0 ? fabs(want - d[v]) : 0);
                mass += lap->row[v] >= 0 ? d[v] : 0;
                CHECK(lap->row[v] >= 0 || d[v] == (operator_ && lap->row[v] == HD_ROW_INERT));
            }
            for (l = 0; l < T->n; l++) sum += filt_want(f + q, fmax(0, (double)T->lambda[l]));
            CHECK(d[n] == 77);
            CHECK_MSG(off <= rep.error_bound * most && off <= 2e-7 * most, "%s, kernel %d, filter %d: diagonal off by %g of %g, bound %g",
                pairs, (int)kernel, q, off, most, rep.error_bound);
            CHECK_MSG(fabs(Z[q] - sum) <= bound[q] && fabs(Z[q] - sum) <= 1e-6 * sum && bound[q] < 1e-3 * sum,
                    "%s, kernel %d, filter %d: trace %.12g, not %.12g, bound %g", pairs, (int)kernel, q, Z[q], sum, bound[q]);
            if (operator_) CHECK_MSG(fabs(mass - sum) <= 1e-6 * sum, "%s, filter %d: the diagonal sums to %.12g, not %.12g", pairs, q, mass, sum);
        }
        CHECK(hd_heat_diagonal(heat, kernel, 0, NULL, alone, 0, NULL, NULL, NULL, NULL) == HD_OK);
        for (q = 0; q < COUNT; q++) CHECK(dense_max_diff(alone + (size_t)q * (size_t)n, D + (size_t)q * ((size_t)n + 1), n) <= rep.error_bound * dense_max_abs(alone + (size_t)q * (size_t)n, n));
        CHECK(hd_heat_diagonal(heat, kernel, 0, NULL, NULL, 0, one, loose, NULL, NULL) == HD_OK);
        for (q = 0; q < COUNT; q++) CHECK(fabs(one[q] - Z[q]) <= bound[q] && loose[q] > 0 && loose[q] <= 1.1 * bound[q] && bound[q] <= 1.1 * loose[q]);
        CHECK(hd_heat_diagonal(heat, kernel, 1, &set->t, alone, 0, NULL, NULL, NULL, NULL) == HD_OK && dense_max_diff(alone, D, n) <= rep.error_bound * dense_max_abs(D, n));
    }
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, D, (size_t)n - 1, Z, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
    /* other queries take the first set; columns of another filter by the same plan */
    v = lap->vertex[2];
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, set->t, v, alone, &rep, NULL) == HD_OK && rep.method == HD_METHOD_DIRECT);
    CHECK_MSG(fabs(alone[v] - D[v]) <= 1e-7 * dense_max_abs(alone, n), "%s: column and diagonal", pairs);
    CHECK(hd_heat_set_rational(heat, 1, set + 4, NULL) == HD_OK);
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, set[4].t, v, alone, &rep, NULL) == HD_OK && rep.method == HD_METHOD_DIRECT);
    CHECK_MSG(fabs(alone[v] - D[(size_t)4 * ((size_t)n + 1) + (size_t)v]) <= 1e-7 * dense_max_abs(alone, n), "%s: column and diagonal", pairs);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, alone, 0, one, loose, NULL, NULL) == HD_OK && fabs(one[0] - Z[4]) <= bound[4] &&
          dense_max_diff(alone, D + (size_t)4 * ((size_t)n + 1), n) <= 4e-7 * dense_max_abs(alone, n));
}

/* Sets that differ are refused, by the number of the first that does; then the plan keeps those that it has. */
static void filt_shared_refused(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    hd_heat *heat = kit_heat(lap, "");
    hd_filter f[3];
    hd_rational set[3];
    double before[3], Z[3];
    hd_error e;
    filt_many(f, 3, 1e-2 * lap->lambda_max, lap->lambda_max);
    CHECK(hd_rational_fit(set, 3, f, lap->lambda_max, NULL, NULL) == HD_OK && hd_heat_set_rational(heat, 3, set, NULL) == HD_OK);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, NULL, 0, before, NULL, NULL, NULL) >= 0);
    set[2].theta[1].re *= 1.0001;
    CHECK(hd_heat_set_rational(heat, 3, set, &e) == HD_ERR_ARGUMENT && e.column == 2);
    CHECK(hd_heat_set_rational(heat, -1, set, NULL) == HD_ERR_ARGUMENT && hd_heat_set_rational(heat, 1, NULL, NULL) == HD_ERR_ARGUMENT);
    set[1].a[0].re = (double)NAN;
    CHECK(hd_heat_set_rational(heat, 3, set, &e) == HD_ERR_NOT_FINITE && e.column == 1);
    memset(set, 0x6b, sizeof set);               /* they are copied */
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, NULL, 0, Z, NULL, NULL, NULL) >= 0 && memcmp(Z, before, sizeof Z) == 0);
    CHECK(hd_heat_set_rational(heat, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, NULL, 0, Z, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
}

static void filt_shared(void) {
    filt_shared_sets();
    filt_shared_refused();
    filt_shared_diagonals("shape=torus/9/6 op=fem");
    filt_shared_diagonals("shape=flat/8/6/0.3 op=vor");
    filt_shared_diagonals("shape=ico/1 op=cot");
    filt_shared_diagonals("shape=flat/9/8/0.2 op=fem+held");
}

/* A filter of heat is heat, at its own time and at no other; d^2 is the sum of the filter itself. */
static void filt_refused(void) {
    const hd_laplacian *lap = kit_pair("flat/9/7/0.3 fem");
    const double time = 3 * lap->h * lap->h, top = lap->lambda_max;
    hd_filter f = filt_make(HD_FILTER_HEAT, time, 0);
    hd_rational set = filt_fit(&f, lap), bad;
    hd_heat *heat = filt_plan(lap, &set, ""), *plain = kit_heat(lap, ""), *none = NULL;
    hd_laplacian *small = NULL;
    hd_heat_opts o;
    hd_report rep;
    hd_error e;
    double *u = KIT_NEW(double, 2 * lap->n), *w = KIT_NEW(double, lap->n), t[2];
    const int32_t source = 10, other = 20;
    int32_t vertex[4];
    CHECK(heat_column(heat, set.t, source, u, NULL) >= 0 && heat_column(plain, time, source, w, NULL) >= 0);
    CHECK(dense_max_diff(u, w, lap->n) < 1e-7 * dense_max_abs(w, lap->n));
    f.a = 2 * time;
    set = filt_fit(&f, lap);
    heat = filt_plan(lap, &set, "");
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &set.t, 1, &source, u, 0, NULL) >= 0 &&
        heat_distance(plain, HD_DISTANCE_CLASSICAL, 1, &time, 1, &source, w, 0, NULL) >= 0);
    CHECK(dense_max_diff(u, w, lap->n) < 1e-6 * dense_max_abs(w, lap->n));
    t[0] = set.t;
    t[1] = 2 * set.t;
    CHECK(heat_times(heat, 2, t, HD_KERNEL_OPERATOR, source, NULL, u, 0, &rep) == HD_ERR_ARGUMENT && rep.error.column == 1 &&
        rep.error.value == t[1]);
    CHECK(heat_diagonal(heat, 1, t + 1, HD_KERNEL_SYMMETRIC, u, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, t + 1, 1, &source, u, 0, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, set.t, 4, vertex, w, &rep) >= 0 &&
        heat_sample(heat, HD_DISTANCE_CLASSICAL, 1.5 * set.t, 4, vertex, w, &rep) == HD_ERR_ARGUMENT);
    t[1] = set.t;                                /* twice the same is fine */
    CHECK(heat_times(heat, 2, t, HD_KERNEL_OPERATOR, source, NULL, u, 0, &rep) >= 0 && dense_max_diff(u, u + lap->n, lap->n) == 0);
    CHECK(heat_distance(heat, HD_DISTANCE_COMMUTE, 0, NULL, 1, &source, u, 0, &rep) >= 0);
    heat = filt_plan(lap, &set, "method=iterative");         /* entries by iterations, distances not */
    CHECK(heat_entries(heat, set.t, HD_KERNEL_OPERATOR, 1, &source, &other, u, &rep) >= 0);
    CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, set.t, 1, &source, &other, w, &rep) == HD_ERR_ARGUMENT);
    CHECK(heat_diagonal(heat, 1, &set.t, HD_KERNEL_SYMMETRIC, u, 0, &rep) == HD_ERR_ARGUMENT);
    memset(&o, 0, sizeof o);
    o.rational = &set;
    o.method = HD_METHOD_KRYLOV;
    CHECK(hd_heat_create(&none, lap, &o, &e) == HD_ERR_ARGUMENT && strstr(e.text, "poles") != NULL);
    bad = set;
    bad.lambda_max = 0.9 * top;
    CHECK(heat_column(filt_plan(lap, &bad, ""), bad.t, source, u, &rep) == HD_ERR_ARGUMENT && fabs(rep.error.value / top - 1) < 1e-12);
    bad.t = (double)NAN;
    o.rational = &bad;
    o.method = HD_METHOD_AUTO;
    CHECK(hd_heat_create(&none, lap, &o, &e) == HD_ERR_ARGUMENT && !none);
    CHECK(trial_pair(&small, "flat/9/7/0.3", "fem", 0.5, &e) == HD_OK);      /* eigenvalues four times as large */
    kit_keep(small, kit_free_laplacian);
    CHECK(heat_column(filt_plan(small, &set, ""), set.t, source, u, &rep) == HD_ERR_ARGUMENT);
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
    filt_cases();
    filt_pairs();
    filt_early();
    filt_one_plan();
    filt_shared();
    filt_refused();
}

#endif
