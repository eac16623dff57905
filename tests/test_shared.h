/* test_shared.h - pole sets that serve many times: hd_rational_shared against exp in long double */

#ifndef TEST_SHARED_H
#define TEST_SHARED_H

/* exp(-y) - c(-y), in long double where the compiler has it. */
static double shared_error(const hd_rational *set, double y) {
    long double sum = expl(-(long double)y);
    int32_t i;
    for (i = 0; i < set->n_poles; i++) {
        const long double re = (long double)y + (long double)set->theta[i].re, im = (long double)set->theta[i].im;
        sum += 2 * ((long double)set->a[i].re * re + (long double)set->a[i].im * im) / (re * re + im * im);
    }
    return (double)sum;
}

/* One set of a call: its errors within what it says, which is not much more; rounding is multiplied by sum 2 |a_i| over the
 * distance of theta_i from the half line, and the constants stay. Returns that sum. */
static double shared_set(const hd_rational *set, double tol) {
    double worst = 0, plain = 0, rounding = 0, noise = 0;
    int32_t k, i;
    for (i = 0; i < set->n_poles; i++) {
        const hd_c64 theta = set->theta[i];
        rounding += 2 * hypot(set->a[i].re, set->a[i].im) / (theta.re < 0 ? fabs(theta.im) : hypot(theta.re, theta.im));
    }
    for (k = 0; k < 1200; k++) {                 /* from far below to far above the poles */
        const double y = k == 0 ? 0 : pow(10, -7 + 0.01 * k), e = fabs(shared_error(set, y));
        double size = exp(-y);
        for (i = 0; i < set->n_poles; i++) size += 2 * hypot(set->a[i].re, set->a[i].im) / hypot(y + set->theta[i].re,
            set->theta[i].im);
        noise = fmax(noise, 4 * DBL_EPSILON * (1 + y) * size);
        worst = fmax(worst, (1 + y) * e);
        plain = fmax(plain, e);
    }
    CHECK_MSG(worst <= set->max_weighted_error && plain <= set->max_error && set->max_weighted_error <= tol,
              "%d pairs: errors %g and %g, bounds %g and %g, asked for %g", (int)set->n_poles, worst, plain,
                  set->max_weighted_error, set->max_error, tol);
    CHECK_MSG(set->max_weighted_error <= 1.25 * (worst + noise) && set->max_error <= 4 * (plain + noise),
              "%d pairs: errors %g and %g, bounds %g and %g",
              (int)set->n_poles, worst, plain, set->max_weighted_error, set->max_error);
    CHECK_MSG(fabs(shared_error(set, 0)) <= 4 * DBL_EPSILON * rounding, "c(0) - 1 = %g", shared_error(set, 0));
    CHECK(set->kind == HD_POLES_KERNEL && set->degree == 2 * set->n_poles && set->a0 == 0 && set->n_poles % 4 == 0);
    return rounding;
}

/* Ratios of times and errors on a grid: poles go with the time, more time or less error never takes fewer of them. */
static void shared_grid(void) {
    hd_rational out[3];
    int32_t i, j, k, q, before[20];
    double most = 0;
    memset(before, 0, sizeof before);
    for (i = 0; i <= 20; i++) {
        int32_t left = 0;
        for (j = 0; j < 20; j++) {
            const double t[3] = {0.3, 0.3 * pow(10, (i + 1) / 5.0), 0.3 * pow(10, (i + 1) * (j % 7) / 35.0)},
                tol = pow(10, -4.2 - j / 3.0);
            const int found = hd_rational_shared(out, 3, t, tol, NULL, NULL) == HD_OK;
            const int32_t n = found ? out[0].n_poles : 100;
            CHECK_MSG(n >= left && n >= before[j], "%g times the time, error %g: %d pairs", t[1] / t[0], tol, (int)n);
            left = before[j] = n;
            for (q = 0; q < 3 && found; q++) {
                most = fmax(most, shared_set(out + q, tol));
                for (k = 0; k < n; k++)
                    CHECK(hypot(t[0] / t[q] * out[q].theta[k].re - out[0].theta[k].re,
                          t[0] / t[q] * out[q].theta[k].im - out[0].theta[k].im) <
                          1e-14 * hypot(out[0].theta[k].re, out[0].theta[k].im));
            }
        }
    }
    CHECK_MSG(most < 5000, "rounding times %g", most);
}

/* What the mathematics promises: pairs enough for an error, in the kernel measure, by the ratio of times; rounded up to
 * packs of four. */
static void shared_known(void) {
    static const double known[9][3] = {{10, 1e-6, 8}, {10, 1e-8, 12}, {10, 1e-10, 16}, {100, 1e-6, 12}, {100, 1e-8, 16},
        {100, 1e-10, 20}, {1000, 1e-6, 16},
                                       {1000, 1e-8, 20}, {10000, 1e-6, 20}};
    hd_rational set[2];
    int32_t k;
    for (k = 0; k < 9; k++) {
        const double t[2] = {1, known[k][0]};
        CHECK(hd_rational_shared(set, 2, t, known[k][1], NULL, NULL) == HD_OK && set[0].n_poles <= (int32_t)known[k][2]);
    }
}

/* One time takes a kernel set, times come in any order, and what is refused. */
static void shared_calls(void) {
    static const double t[5] = {0.3, 7, 0.02, 1.9, 0.3}, bad[3] = {1, 0, 2}, wide[2] = {1e-9, 1e9}, same[2] = {0.4, 0.4};
    hd_rational out[5], kept;
    hd_context ctx;
    hd_error e;
    CHECK(hd_rational_shared(out, 5, t, 2e-7, NULL, &e) == HD_OK && memcmp(out, out + 4, sizeof *out) == 0 &&
          out[2].n_poles == 16);
    CHECK(fabs(hd_rational_eval(out + 1, -2.5) - exp(-2.5)) <= out[1].max_weighted_error / 3.5);
    CHECK(hd_rational_shared(out, 2, same, 1e-6, NULL, &e) == HD_OK && out[1].degree == 8 &&
          out[1].max_weighted_error <= 1e-6 && out[1].a[0].re != 0);
    CHECK(hd_rational_shared(out, 2, same, 1e-8, NULL, &e) == HD_OK && out[0].degree == 10);
    memset(&kept, 0x22, sizeof kept);
    out[0] = kept;
    CHECK(hd_rational_shared(out, 3, bad, 1e-6, NULL, &e) == HD_ERR_ARGUMENT && e.row == 1 && e.value == 0);
    CHECK(hd_rational_shared(out, 2, wide, 1e-6, NULL, &e) == HD_ERR_ARGUMENT && e.value > 1e17 && e.row == -1);
    CHECK(hd_rational_shared(out, 5, t, 1e-15, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_rational_shared(out, 0, t, 1e-6, NULL, &e) == HD_ERR_ARGUMENT &&
          hd_rational_shared(out, 5, t, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_rational_shared(out, 5, t, (double)NAN, NULL, &e) == HD_ERR_ARGUMENT);
    memset(&ctx, 0, sizeof ctx);
    ctx.byte_limit = 1000;
    CHECK(hd_rational_shared(out, 5, t, 1e-7, &ctx, &e) == HD_ERR_MEMORY_LIMIT && ctx.bytes_in_use == 0);
    CHECK(memcmp(out, &kept, sizeof kept) == 0);
}

static void test_shared(void) {
    shared_grid();
    shared_known();
    shared_calls();
}

#endif
