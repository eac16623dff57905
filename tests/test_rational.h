/* test_rational.h - the shipped pole sets against exp, known constants, and sets of the caller's own */

#ifndef TEST_RATIONAL_H
#define TEST_RATIONAL_H

/* The errors known from theory, best possible, by degree; 0: not listed. The weighted ones belong to the kernel sets. */
static const double rat_uniform[15] = {0, 6.6831e-2, 0, 0, 0, 9.3457e-6, 0, 1.08750e-7, 1.1723e-8, 0, 1.3611e-10, 0, 0, 0, 1.83217e-14};
static const double rat_kernel[15] = {0, 0, 0, 0, 0, 0, 1.79e-5, 2.17e-6, 2.59e-7, 0, 3.59e-9, 0, 4.83e-11, 0, 6.36e-13};

/* One set on a dense grid: 0, and |x| from 1e-6 to 1e8. Errors as promised, and promised not much too large. */
static void rat_against_exp(const hd_rational *set) {
    double plain = fabs(1 - hd_rational_eval(set, 0)), weighted = plain, noise = 0;
    int32_t k, count = 0;
    for (k = 0; k <= 14000; k++) {
        const double x = -pow(10, -6 + k * 1e-3), error = fabs(exp(x) - hd_rational_eval(set, x));
        plain = fmax(plain, error);
        if (x > -1e4) weighted = fmax(weighted, (1 - x) * error);    /* beyond, |x| times rounding is all there is */
    }
    for (k = 0; k < set->n_poles; k++) {         /* terms of size 1e3 cancel: what double arithmetic leaves */
        noise += 2 * hypot(set->a[k].re, set->a[k].im) / (set->theta[k].re > 0 ? hypot(set->theta[k].re, set->theta[k].im) : set->theta[k].im) * DBL_EPSILON;
        count += set->theta[k].im == 0 ? 1 : 2;
        CHECK(set->theta[k].im > 0 || (set->theta[k].im == 0 && set->theta[k].re > 0 && set->a[k].im == 0));
    }
    CHECK_MSG(count == set->degree, "degree %d: %d poles", set->degree, count);
    CHECK_MSG(plain <= set->max_error + noise, "degree %d: error %g above max_error %g", set->degree, plain, set->max_error);
    CHECK_MSG(plain >= 0.85 * set->max_error - 2e-15, "degree %d: error %g, max_error %g is too pessimistic", set->degree, plain, set->max_error);
    if (set->max_weighted_error == 0) return;
    CHECK_MSG(weighted <= set->max_weighted_error + 10 * noise, "degree %d: weighted error %g above %g", set->degree, weighted, set->max_weighted_error);
    CHECK_MSG(weighted >= 0.85 * set->max_weighted_error - 2e-15, "degree %d: weighted error %g, promised %g", set->degree, weighted, set->max_weighted_error);
}

static void rat_shipped(void) {
    hd_rational set;
    hd_error e;
    int32_t r;
    for (r = 1; r <= 14; r++) {
        CHECK(hd_rational_exp(&set, HD_POLES_UNIFORM, r, &e) == HD_OK && set.kind == HD_POLES_UNIFORM && set.degree == r);
        CHECK(set.n_poles == (r + 1) / 2 && set.max_weighted_error == 0);
        rat_against_exp(&set);
        if (rat_uniform[r] > 0) {
            CHECK_MSG(fabs(fabs(set.a0) / rat_uniform[r] - 1) < 1e-4, "uniform %d: a0 %.9g is not the known error", r, set.a0);
            CHECK(set.max_error >= rat_uniform[r] && set.max_error <= 1.11 * rat_uniform[r] + 1.01e-14);
        }
    }
    for (r = 2; r <= 14; r++) {
        CHECK(hd_rational_exp(&set, HD_POLES_KERNEL, r, &e) == HD_OK && set.kind == HD_POLES_KERNEL && set.degree == r);
        CHECK(set.a0 == 0 && set.n_poles == (r + 1) / 2 && set.max_weighted_error > 0);
        CHECK_MSG(fabs(hd_rational_eval(&set, 0) - 1) < 2e-15 * pow(1.5, r), "kernel %d: c(0) - 1 = %g", r, hd_rational_eval(&set, 0) - 1);
        rat_against_exp(&set);
        if (rat_kernel[r] > 0)
            CHECK_MSG(set.max_weighted_error >= 0.999 * rat_kernel[r] && set.max_weighted_error <= 1.12 * rat_kernel[r] + 1.01e-14, "kernel %d: %g", r, set.max_weighted_error);
    }
}

static void rat_known_poles(void) {
    static const struct { hd_pole_kind kind; int32_t degree; double re, im; } rows[] = {
        {HD_POLES_UNIFORM, 7, 2.94109692, 0}, {HD_POLES_UNIFORM, 7, 2.42319635, 2.39302931}, {HD_POLES_UNIFORM, 7, 0.757608634, 4.84361851},
        {HD_POLES_UNIFORM, 7, -2.57572609, 7.48097743}, {HD_POLES_KERNEL, 8, 2.5778411129, 1.0959438169},
        {HD_POLES_KERNEL, 8, 1.6292171157, 3.3086435835}, {HD_POLES_KERNEL, 8, -0.4298346048, 5.5940888506},
        {HD_POLES_KERNEL, 8, -4.1592354425, 8.0717415744},
    };
    hd_rational set;
    size_t k;
    int32_t i;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        double best = HUGE_VAL;
        CHECK(hd_rational_exp(&set, rows[k].kind, rows[k].degree, NULL) == HD_OK);
        for (i = 0; i < set.n_poles; i++) best = fmin(best, hypot(set.theta[i].re - rows[k].re, set.theta[i].im - rows[k].im));
        CHECK_MSG(best < 2e-8, "no pole at %.9g + %.9g i", rows[k].re, rows[k].im);
        if (k == 0) CHECK_MSG(fabs(set.a0 + 1.0874975e-7) < 1e-13, "a0 = %.12g", set.a0);
    }
    CHECK(hd_rational_exp(&set, HD_POLES_UNIFORM, 14, NULL) == HD_OK);
    CHECK_MSG(fabs(set.a0 - 1.8321744e-14) < 1e-20, "a0 = %.12g", set.a0);    /* often printed wrong as 1.8e-12 */
}

static void rat_errors(void) {
    static const struct { hd_pole_kind kind; int32_t degree; } rows[6] = {{HD_POLES_UNIFORM, 0}, {HD_POLES_UNIFORM, 15}, {HD_POLES_KERNEL, 1},
                                                                          {HD_POLES_KERNEL, 15}, {HD_POLES_DEFAULT, 7}, {HD_POLES_OWN, 7}};
    hd_rational set;
    hd_error e;
    int k;
    memset(&set, 0x11, sizeof set);
    for (k = 0; k < 6; k++)
        CHECK(hd_rational_exp(&set, rows[k].kind, rows[k].degree, &e) == HD_ERR_ARGUMENT && (k > 3 || e.value == rows[k].degree) && set.degree == 0x11111111);
}

/* c(x) = 3 - 2/(x - 4) + 2 Re (1 + 2i)/(x - (1 + 5i)) by hand at x = -1: 3 + 2/5 + 2 Re (1 + 2i)/(-2 - 5i) = 3.4 - 24/29. */
static void rat_eval(void) {
    hd_rational set;
    memset(&set, 0, sizeof set);
    set.n_poles = 2;
    set.a0 = 3;
    set.theta[0] = test_c(4, 0);
    set.a[0] = test_c(-2, 0);
    set.theta[1] = test_c(1, 5);
    set.a[1] = test_c(1, 2);
    CHECK_MSG(fabs(hd_rational_eval(&set, -1) - (3.4 - 24.0 / 29)) < 1e-15, "%.17g", hd_rational_eval(&set, -1));
}

static void rat_own_checks(void) {
    const hd_laplacian *lap = kit_pair("ico/0 fem");
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_rational good, set;
    hd_error e;
    double u[12];
    int32_t i;
    memset(&o, 0, sizeof o);
    o.rational = &set;
    CHECK(hd_rational_exp(&good, HD_POLES_UNIFORM, 5, &e) == HD_OK);
#define RAT_BAD(change, st, at)                                                                                        \
    set = good;                                                                                                        \
    change;                                                                                                            \
    CHECK_MSG(hd_heat_create(&heat, lap, &o, &e) == st && e.status == st && e.pole == (at) && !heat, "%s, pole %d", hd_status_name(e.status), (int)e.pole)
    RAT_BAD(set.n_poles = -1, HD_ERR_ARGUMENT, -1);
    RAT_BAD(set.n_poles = HD_MAX_POLES + 1, HD_ERR_ARGUMENT, -1);
    RAT_BAD(set.a0 = (double)NAN, HD_ERR_NOT_FINITE, -1);
    RAT_BAD(set.max_error = -1, HD_ERR_NOT_FINITE, -1);
    RAT_BAD(set.max_weighted_error = (double)NAN, HD_ERR_NOT_FINITE, -1);
    RAT_BAD(set.max_error = (double)NAN, HD_ERR_NOT_FINITE, -1);
    RAT_BAD(set.max_weighted_error = -1, HD_ERR_NOT_FINITE, -1);
    RAT_BAD(set.t = (double)INFINITY, HD_ERR_ARGUMENT, -1);
    RAT_BAD(set.t = -1, HD_ERR_ARGUMENT, -1);
    RAT_BAD(set.largest = (double)NAN, HD_ERR_ARGUMENT, -1);
    RAT_BAD(set.largest = -1, HD_ERR_ARGUMENT, -1);
    RAT_BAD((set.t = 1, set.lambda_max = 0), HD_ERR_ARGUMENT, -1);
    RAT_BAD(set.theta[1].re = (double)INFINITY, HD_ERR_NOT_FINITE, 1);
    RAT_BAD(set.a[2].im = (double)NAN, HD_ERR_NOT_FINITE, 2);
    RAT_BAD(set.theta[1].im = -1, HD_ERR_ARGUMENT, 1);
    RAT_BAD(set.theta[2] = test_c(-3, 0), HD_ERR_ARGUMENT, 2);
    RAT_BAD(set.theta[0] = test_c(0, 0), HD_ERR_ARGUMENT, 0);
#undef RAT_BAD
    memset(&set, 0, sizeof set);                 /* no poles at all: c = a0 */
    set.a0 = 2.5;
    CHECK(hd_heat_create(&heat, lap, &o, &e) == HD_OK);
    set.a0 = 77;                                 /* it was copied */
    CHECK(heat_column(heat, 0.3, 4, u, NULL) >= 0);
    for (i = 0; i < 12; i++) CHECK(fabs(u[i] - (i == 4 ? 2.5 : 0)) < 1e-15);
    hd_heat_free(heat);
}

static void test_rational(void) {
    rat_shipped();
    rat_known_poles();
    rat_errors();
    rat_eval();
    rat_own_checks();
}

#endif
