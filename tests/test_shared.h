/* test_shared.h - pole sets that serve many times: the table, the fit at run time, its bounds, and heat by one factorisation.
   Part of internals.c, as most of this is private. */

#ifndef TEST_SHARED_H
#define TEST_SHARED_H

/* exp(-tau y) - c(-y), in long double where the compiler has it. */
static double shared_error(const hd_rational *set, double tau, double y) {
    long double sum = expl(-(long double)tau * (long double)y);
    int32_t i;
    for (i = 0; i < set->n_poles; i++) {
        const long double re = (long double)y + (long double)set->theta[i].re, im = (long double)set->theta[i].im;
        sum += 2 * ((long double)set->a[i].re * re + (long double)set->a[i].im * im) / (re * re + im * im);
    }
    return (double)sum;
}

static double shared_unit(uint64_t *seed) { return (dense_signed(seed) + 1) / 2; }

static double *shared_room(int32_t n) {
    const int64_t size = (int64_t)hdi_shared_room(n);
    double *room = DENSE_NEW(double, size + 1);
    int64_t k;
    for (k = 0; k < size; k++) room[k] = 1e300;  /* nothing is expected in it */
    room[size] = 4711;
    return room;
}

static void shared_room_free(double *room, int32_t n) {
    CHECK(room[hdi_shared_room(n)] == 4711);
    free(room);
}

/* sum 2 |a_i|/distance: what rounding is multiplied by. */
static double shared_amplification(const hd_rational *set) {
    double sum = 0;
    int32_t i;
    for (i = 0; i < set->n_poles; i++) sum += 2 * hdi_cabs(set->a[i]) / hdi_pole_distance(set->theta[i]);
    return sum;
}

/* What the bound allows for rounding, from the same sum in a few places. */
static double shared_noise(const hd_rational *set, double tau) {
    double most = 0, size;
    int32_t k;
    for (k = 0; k < 200; k++) {
        (void)hdi_shared_error(set, tau, 1e-2 * hdi_cabs(set->theta[0]) * pow(10, k * 0.04), 1, &size);
        most = fmax(most, size);
    }
    return 4 * DBL_EPSILON * most;
}

/* The largest errors on dense y from far below to far above the poles, and at random ones; every one of them against the bounds. */
static double shared_against_exp(const hd_rational *set, double tau, int32_t count, uint64_t *seed, double *plain) {
    const double low = 1e-4 * hdi_cabs(set->theta[0]), high = 1e5 * hdi_cabs(set->theta[set->n_poles - 1]);
    double worst = 0, above = 0;
    int32_t k;
    *plain = 0;
    for (k = 0; k < 2 * count; k++) {
        const double part = k < count ? (double)k / count : shared_unit(seed), y = k == 0 ? 0 : low * pow(high / low, part), e = fabs(shared_error(set, tau, y));
        worst = fmax(worst, (1 + tau * y) * e);
        *plain = fmax(*plain, e);
        above = fmax(above, (1 + tau * y) * e - set->max_weighted_error);
    }
    CHECK_MSG(above <= 0, "%d pairs, tau %g: error %g above the bound %g", (int)set->n_poles, tau, worst, set->max_weighted_error);
    CHECK_MSG(*plain <= set->max_error, "%d pairs, tau %g: plain error %g above the bound %g", (int)set->n_poles, tau, *plain, set->max_error);
    return worst;
}

/* One set of the table at times within its range. */
static void shared_set(const double *row, uint64_t *seed) {
    const double lambda = row[0], promised = 1.25 * row[2];
    const int32_t n = (int32_t)row[1];
    double *room = shared_room(n), most = 0, amplified = 0;
    hd_rational set;
    int32_t k;
    CHECK(hdi_shared_pick(&set, lambda, promised) && set.n_poles <= n);    /* fewer pairs may do */
    memset(&set, 0, sizeof set);
    set.n_poles = n;
    for (k = 0; k < n; k++) set.theta[k] = hdi_c(row[4 + 2 * k], row[5 + 2 * k]);
    for (k = 0; k < 24; k++) {
        const double part = k < 2 ? k : shared_unit(seed), tau = k % 3 == 2 ? pow(lambda, 1 - 0.03 * part) : pow(lambda, part);
        double worst, plain, noise;
        hdi_shared_fit(&set, tau, room);
        noise = shared_noise(&set, tau);
        worst = shared_against_exp(&set, tau, 700, seed, &plain);
        most = fmax(most, worst);
        amplified = fmax(amplified, shared_amplification(&set));
        CHECK_MSG(set.max_weighted_error <= promised, "%g, %d pairs, tau %g: bound %g, promised %g", lambda, (int)n, tau, set.max_weighted_error, promised);
        CHECK_MSG(set.max_weighted_error <= 1.2 * (worst + noise), "tau %g: bound %g, error %g, rounding %g", tau, set.max_weighted_error, worst, noise);
        CHECK_MSG(set.max_error <= 4 * (plain + noise), "tau %g: bound %g of the plain error, %g seen", tau, set.max_error, plain);
        CHECK_MSG(fabs(shared_error(&set, tau, 0)) <= 4 * DBL_EPSILON * shared_amplification(&set), "tau %g: c(0) - 1 = %g", tau, shared_error(&set, tau, 0));
        CHECK(set.a0 == 0);
    }
    CHECK_MSG(most >= 0.2 * row[2], "%g, %d pairs: error %g, recorded %g", lambda, (int)n, most, row[2]);
    CHECK_MSG(amplified <= 1.1 * row[3] && amplified >= 0.5 * row[3], "%g, %d pairs: amplification %g, recorded %g", lambda, (int)n, amplified, row[3]);
    shared_room_free(room, n);
}

/* Every set of the table, and the table's own order. */
static void shared_table(void) {
    const int32_t size = (int32_t)(sizeof hdi_shared_table / sizeof *hdi_shared_table);
    const double *last = NULL, *row;
    uint64_t seed = 5;
    int32_t k, i, n;
    for (k = 0; k < size; k += 4 + 2 * n) {
        row = hdi_shared_table + k;
        n = (int32_t)row[1];
        CHECK(n > 0 && n % 4 == 0 && n <= HD_MAX_POLES && k + 4 + 2 * n <= size);
        if (n <= 0 || k + 4 + 2 * n > size) return;
        CHECK(row[0] > 1 && row[2] > 1e-13 && row[2] < 2e-5 && row[3] > 1 && row[3] < 5000);
        CHECK(!last || last[1] < row[1] || (last[1] == row[1] && last[0] < row[0] && last[2] < row[2]));
        for (i = 0; i < n; i++) {
            CHECK(row[5 + 2 * i] > 0 && atan2(row[5 + 2 * i], row[4 + 2 * i]) < 2.56);
            CHECK(i == 0 || hypot(row[2 + 2 * i], row[3 + 2 * i]) <= hypot(row[4 + 2 * i], row[5 + 2 * i]));
        }
        shared_set(row, &seed);
        last = row;
    }
    CHECK(k == size);
}

/* What the mathematics promises: pairs enough for an error, in the kernel measure, by the ratio of times; rounded up to packs of four. */
static void shared_known(void) {
    static const double known[9][3] = {{10, 1e-6, 8}, {10, 1e-8, 12}, {10, 1e-10, 16}, {100, 1e-6, 12}, {100, 1e-8, 16}, {100, 1e-10, 20}, {1000, 1e-6, 16},
                                       {1000, 1e-8, 20}, {10000, 1e-6, 20}};
    hd_rational set;
    int32_t k;
    for (k = 0; k < 9; k++) {
        CHECK(hdi_shared_pick(&set, known[k][0], known[k][1]));
        CHECK_MSG(set.n_poles <= (int32_t)known[k][2], "%g to %g: %d pairs", known[k][0], known[k][1], (int)set.n_poles);
    }
}

/* More time or less error never takes fewer poles; what is picked covers the range and holds the error. */
static void shared_pick(void) {
    hd_rational set, kept;
    int32_t i, j, n, before[40];
    memset(before, 0, sizeof before);
    for (i = -3; i <= 40; i++) {
        const double lambda = pow(10, i / 8.0);
        int32_t left = 0;
        for (j = 0; j < 40; j++) {
            const double target = pow(10, -3 - j / 4.0);
            memset(&set, 0, sizeof set);
            n = hdi_shared_pick(&set, lambda, target) ? set.n_poles : 100;
            CHECK_MSG(n >= left && n >= before[j], "lambda %g, target %g: %d poles", lambda, target, (int)n);
            CHECK(n == 100 || (set.max_weighted_error <= target && set.kind == HD_POLES_KERNEL && set.degree == 2 * n && set.a0 == 0));
            if (n < 100 && lambda > 1 && (i + j) % 4 == 0) {    /* and keeps what it says */
                double *room = shared_room(n);
                hdi_shared_fit(&set, lambda * 0.97, room);
                CHECK_MSG(set.max_weighted_error <= target, "lambda %g, target %g: %g", lambda, target, set.max_weighted_error);
                hdi_shared_fit(&set, 1, room);
                CHECK_MSG(set.max_weighted_error <= target, "lambda %g, target %g: %g", lambda, target, set.max_weighted_error);
                shared_room_free(room, n);
            }
            left = before[j] = n;
        }
    }
    memset(&kept, 0x33, sizeof kept);
    set = kept;
    CHECK(!hdi_shared_pick(&set, 1e6, 1e-3) && memcmp(&set, &kept, sizeof set) == 0);
    CHECK(!hdi_shared_pick(&set, 5, 1e-15) && memcmp(&set, &kept, sizeof set) == 0);
    TRAPS_OFF;                                   /* compares with no number */
    CHECK(!hdi_shared_pick(&set, (double)NAN, 1e-3) && !hdi_shared_pick(&set, 5, (double)NAN) && memcmp(&set, &kept, sizeof set) == 0);
    TRAPS_ON;
    CHECK(hdi_shared_pick(&set, 1, 1e-6) && set.degree == 8 && set.a[0].re != 0);      /* one time: a kernel set */
    CHECK(hdi_shared_pick(&set, 1, 1e-8) && set.degree == 10);
}

/* A single time: the fit finds nearly the best weights of a kernel set, which are known. */
static void shared_single(void) {
    int32_t r, i;
    for (r = 8; r <= 12; r += 2) {
        hd_rational best, set;
        double *room = shared_room(r / 2);
        CHECK(hd_rational_get(&best, HD_POLES_KERNEL, r, NULL) == HD_OK);
        set = best;
        hdi_shared_fit(&set, 1, room);
        CHECK_MSG(set.max_weighted_error <= 1.8 * best.max_weighted_error && set.max_weighted_error >= best.max_weighted_error / 1.1, "degree %d: %g, best %g",
                  (int)r, set.max_weighted_error, best.max_weighted_error);
        for (i = 0; i < r / 2; i++)
            CHECK_MSG(hdi_cabs(hdi_csub(set.a[i], best.a[i])) < 1e-4 * hdi_cabs(best.a[i]) + best.max_error, "degree %d, weight %d: %g %g", (int)r, (int)i, set.a[i].re, best.a[i].re);
        shared_room_free(room, r / 2);
    }
}

/* Two columns that are the same share a weight: damping decides, as nothing else does. */
static void shared_damped(void) {
    hdi_shared_work k;
    double A[20] = {0}, b[5] = {1, 1, 0, 0, 0}, M[24], x[8], w[5] = {1, 1, 1, 1, 1}, e[5];
    memset(&k, 0, sizeof k);
    k.n = 2;
    k.rows = 5;
    k.A = A;
    k.b = b;
    k.M = M;
    k.x = x;
    k.w = w;
    k.e = e;
    A[5] = A[11] = A[16] = 1;                    /* columns 1, 2, 3 of four; the first unknown is zero */
    CHECK(hdi_shared_step(&k) < 1e-14);
    CHECK_MSG(fabs(x[0] - 1) < 1e-14 && fabs(x[1] - 0.5) < 1e-3 && fabs(x[2] - 0.5) < 1e-3, "weights %g, %g, %g", x[0], x[1], x[2]);
}

/* What stands behind the last pole of a set is nothing to its error. */
static void shared_no_more_poles(void) {
    hd_rational set;
    double before, after, size, more;
    CHECK(hd_rational_get(&set, HD_POLES_KERNEL, 8, NULL) == HD_OK);
    before = hdi_shared_error(&set, 1, 0.7, 1, &size);
    set.theta[set.n_poles] = hdi_c(1, 2);
    set.a[set.n_poles] = hdi_c(1, 1);
    after = hdi_shared_error(&set, 1, 0.7, 1, &more);
    CHECK(before == after && size == more);
}

/* The bound holds for any weights, poles and times: times outside the range, poles that nearly touch the half line, weights that are no fit at all. */
static void shared_bounds(void) {
    uint64_t seed = 77;
    int32_t k, i;
    for (k = 0; k < 300; k++) {
        const double lambda = pow(10, 2 * shared_unit(&seed)), tau = pow(10, 6 * shared_unit(&seed) - 2);
        hd_rational set;
        double *room, plain, worst;
        CHECK(hdi_shared_pick(&set, 1.01 * lambda, 1e-5));
        room = shared_room(set.n_poles);
        hdi_shared_fit(&set, tau, room);
        if (k % 2)
            for (i = 0; i < set.n_poles; i++) set.a[i] = hdi_c(dense_signed(&seed), dense_signed(&seed));
        if (k % 4 == 3) {                        /* a peak as narrow as 2 degrees */
            const double size = hdi_cabs(set.theta[k % set.n_poles]), angle = 3.14159 - 0.035 - 0.2 * shared_unit(&seed);
            set.theta[k % set.n_poles] = hdi_c(size * cos(angle), size * sin(angle));
        }
        if (k % 2) hdi_shared_bound(&set, tau, 1e-8);
        CHECK(hdi_finite(set.max_weighted_error) && hdi_finite(set.max_error));
        worst = shared_against_exp(&set, tau, 600, &seed, &plain);
        if (k % 4 != 3) CHECK_MSG(set.max_weighted_error <= 1.2 * (worst + shared_noise(&set, tau)), "tau %g: bound %g, error %g", tau, set.max_weighted_error, worst);
        shared_room_free(room, set.n_poles);
    }
}

/* The rest of (1 + s) exp(-s) beyond Chebyshev degree m, from its coefficients by a discrete cosine transform. */
static void shared_exp_rest(void) {
    enum { NODES = 300 };
    const double pi = acos(-1.0);
    uint64_t seed = 3;
    int32_t k, i, j;
    for (k = 0; k < 60; k++) {
        const int32_t m = 8 + 4 * (k % 10);
        const double w = pow(10, 3 * shared_unit(&seed) - 2), c = (k % 3 == 0 ? 1 : 3) * w, tau = k % 2 ? 1 / w : 8 * shared_unit(&seed) / w;
        const double rest = hdi_shared_exp_rest(tau, c, w, m);
        double sum = 0;
        for (j = m + 1; j < NODES / 2; j++) {
            double b = 0;
            for (i = 0; i < NODES; i++) {
                const double angle = pi * (i + 0.5) / NODES, s = tau * (c + w * cos(angle));
                b += 2.0 / NODES * (1 + s) * exp(-s) * cos(j * angle);
            }
            sum += fabs(b);
        }
        CHECK_MSG(sum <= rest + 1e-12, "tau %g, %g +- %g, degree %d: rest %g, bound %g", tau, c, w, (int)m, sum, rest);
        CHECK_MSG(rest <= 300 * sum + 1e-11, "tau %g, %g +- %g, degree %d: rest %g, bound %g", tau, c, w, (int)m, sum, rest);
    }
}

/* The public function: poles that go with the time, weights for each, errors as asked for; and what it refuses. */
static void shared_public(void) {
    static const double t[5] = {0.3, 7, 0.02, 1.9, 0.3}, bad[3] = {1, 0, 2}, wide[2] = {1e-9, 1e9}, same[2] = {0.4, 0.4};
    hd_rational out[5], kept;
    hd_context ctx;
    hd_error e;
    uint64_t seed = 12;
    int32_t q, i;
    CHECK(hd_rational_shared(out, 5, t, 2e-7, NULL, &e) == HD_OK);
    for (q = 0; q < 5; q++) {
        double plain;
        CHECK(out[q].n_poles == 16 && out[q].kind == HD_POLES_KERNEL && out[q].degree == 32 && out[q].max_weighted_error <= 2e-7);
        CHECK(shared_against_exp(out + q, 1, 500, &seed, &plain) > 0);
        for (i = 0; i < 16; i++) CHECK(hdi_cabs(hdi_csub(hdi_cscale(t[2] / t[q], out[q].theta[i]), out[2].theta[i])) < 1e-14 * hdi_cabs(out[2].theta[i]));
        CHECK(fabs(hd_rational_eval(out + q, -2.5) - exp(-2.5)) <= out[q].max_weighted_error / 3.5);
    }
    CHECK(memcmp(out, out + 4, sizeof *out) == 0);
    CHECK(hd_rational_shared(out, 2, same, 1e-6, NULL, &e) == HD_OK && out[1].degree == 8 && out[1].max_weighted_error <= 1e-6 && out[1].a[0].re != 0);
    memset(&kept, 0x22, sizeof kept);
    out[0] = kept;
    CHECK(hd_rational_shared(out, 3, bad, 1e-6, NULL, &e) == HD_ERR_ARGUMENT && e.row == 1 && e.value == 0);
    CHECK(hd_rational_shared(out, 2, wide, 1e-6, NULL, &e) == HD_ERR_ARGUMENT && e.value > 1e17 && e.row == -1);
    CHECK(hd_rational_shared(out, 0, t, 1e-6, NULL, &e) == HD_ERR_ARGUMENT && hd_rational_shared(out, 5, t, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_rational_shared(out, 5, t, (double)NAN, NULL, &e) == HD_ERR_ARGUMENT && hd_rational_shared(out, 5, NULL, 1e-6, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_rational_shared(NULL, 5, t, 1e-6, NULL, NULL) == HD_ERR_ARGUMENT);
    memset(&ctx, 0, sizeof ctx);
    ctx.byte_limit = 1000;
    CHECK(hd_rational_shared(out, 5, t, 1e-7, &ctx, &e) == HD_ERR_MEMORY_LIMIT && ctx.bytes_in_use == 0);
    CHECK(memcmp(out, &kept, sizeof kept) == 0);
}

static void shared_same_bits(void) {
    hd_rational one, two;
    double *room;
    int64_t k;
    CHECK(hdi_shared_pick(&one, 100, 1e-6));
    two = one;
    room = shared_room(one.n_poles);
    hdi_shared_fit(&one, 7, room);
    hdi_shared_fit(&two, 31, room);
    for (k = 0; k < (int64_t)hdi_shared_room(one.n_poles); k++) room[k] = -1e-300 * (double)k;
    hdi_shared_fit(&two, 7, room);
    CHECK(memcmp(&one, &two, sizeof one) == 0);
    shared_room_free(room, one.n_poles);
}

/* Residuals are orthogonal to the columns, also of nearly dependent ones; without full rank the answer is finite. */
static void shared_least_squares(void) {
    enum { ROWS = 23, COLS = 6 };
    double a[ROWS * COLS], keep[ROWS * COLS], b[ROWS], rest[ROWS];
    uint64_t seed = 9;
    int32_t i, j, k;
    for (k = 0; k < 4; k++) {
        for (i = 0; i < ROWS * COLS; i++) a[i] = dense_signed(&seed);
        for (i = 0; i < ROWS; i++) rest[i] = b[i] = dense_signed(&seed);
        for (i = 0; i < ROWS; i++) {
            if (k == 1) a[4 * ROWS + i] = a[1 * ROWS + i] + 1e-6 * a[4 * ROWS + i];
            if (k == 2) a[2 * ROWS + i] = 0;
            if (k == 3) a[i] = i == 0;
        }
        memcpy(keep, a, sizeof a);
        hdi_least_squares(a, ROWS, COLS, b);
        for (j = 0; j < COLS; j++) {
            CHECK(hdi_finite(b[j]));
            for (i = 0; i < ROWS; i++) rest[i] -= keep[j * ROWS + i] * b[j];
        }
        for (j = 0; k != 2 && j < COLS; j++) CHECK_MSG(fabs(dense_dot(rest, keep + j * ROWS, ROWS)) < (k == 1 ? 1e-8 : 1e-13), "case %d, column %d", (int)k, (int)j);
    }
}

static double *shared_dense(const hd_csr *a, const double *val) {
    double *d = DENSE_NEW(double, (int64_t)a->n_rows * a->n_rows);
    int64_t p;
    int32_t i;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) d[(size_t)i * (size_t)a->n_rows + (size_t)a->col[p]] = val[p];
    return d;
}

/* K_t e_source for times within a factor of ten, by one factorisation of t0 L + theta_i B, against the dense eigensolution; and as a set for hd_heat. */
static void shared_heat(void) {
    enum { TIMES = 4, MOST = 8 };
    static const double tau[TIMES] = {1, 2.7, 6.1, 10};
    shape s = shape_icosphere(2);
    hd_laplacian *lap = NULL;
    const int32_t n = s.n, source = 5;
    const double t0 = 0.02;
    hd_c64 *val, *rhs = DENSE_NEW(hd_c64, n), *g = DENSE_NEW(hd_c64, MOST * n);
    double *b = DENSE_NEW(double, n), *e = DENSE_NEW(double, n), *u = DENSE_NEW(double, n), *v = DENSE_NEW(double, n), *want = DENSE_NEW(double, n), *room;
    dense_pair pair;
    hd_rational set;
    hd_ldl *f = NULL;
    int32_t i, j, k;
    int64_t p, nnz;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, NULL, NULL) == HD_OK && lap->n_active == n);
    nnz = lap->L.nnz;
    val = DENSE_NEW(hd_c64, MOST * nnz);
    CHECK(dense_pair_solve(&pair, shared_dense(&lap->L, lap->L.val), shared_dense(&lap->L, lap->B), n));
    CHECK(hdi_shared_pick(&set, tau[TIMES - 1], 1e-6) && set.n_poles == MOST);
    for (i = 0; i < MOST; i++)
        for (p = 0; p < nnz; p++) val[i * nnz + p] = hdi_c(t0 * lap->L.val[p] + set.theta[i].re * lap->B[p], set.theta[i].im * lap->B[p]);
    e[source] = 1;
    CHECK(hd_laplacian_apply(lap, 0, 1, e, b, NULL) == HD_OK);
    for (j = 0; j < n; j++) rhs[j] = hdi_c(b[j], 0);
    CHECK(hd_ldl_analyse(&f, &lap->L, NULL, NULL, NULL) == HD_OK && hd_ldl_factor_complex(f, MOST, val, NULL, NULL) == HD_OK);
    CHECK(hd_ldl_solve_complex(f, rhs, 0, g, 0, NULL) == HD_OK);
    room = shared_room(MOST);
    for (k = 0; k < TIMES; k++) {
        const double t = tau[k] * t0;
        hd_heat_opts o;
        hd_heat *heat = NULL;
        hd_rational own;
        double mass = 0, error;
        hdi_shared_fit(&set, tau[k], room);
        memset(u, 0, (size_t)n * sizeof *u);
        for (i = 0; i < MOST; i++)
            for (j = 0; j < n; j++) u[j] -= 2 * hdi_cmul(set.a[i], g[i * n + j]).re;
        dense_pair_heat(&pair, t, b, want);
        error = dense_max_diff(u, want, n) / dense_max_abs(want, n);
        CHECK_MSG(error < 4 * set.max_weighted_error, "tau %g: relative error %g, weighted error of the set %g", tau[k], error, set.max_weighted_error);
        for (j = 0; j < n; j++) mass += lap->mass[j] * u[j];
        CHECK_MSG(fabs(mass / lap->mass[source] - 1) < 1e-11, "heat drifts by %g", mass / lap->mass[source] - 1);
        own = set;                               /* in terms of t itself */
        for (i = 0; i < MOST; i++) {
            own.theta[i] = hdi_cscale(tau[k], set.theta[i]);
            own.a[i] = hdi_cscale(tau[k], set.a[i]);
        }
        memset(&o, 0, sizeof o);
        o.rational = &own;
        o.method = HD_METHOD_DIRECT;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK && heat_column(heat, t, source, v, NULL) >= 0);
        CHECK_MSG(dense_max_diff(u, v, n) < 1e-10 * dense_max_abs(want, n), "by hd_heat: %g apart", dense_max_diff(u, v, n));
        hd_heat_free(heat);
    }
    shared_room_free(room, MOST);
    hd_ldl_free(f);
    dense_pair_free(&pair);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(val);
    free(rhs);
    free(g);
    free(b);
    free(e);
    free(u);
    free(v);
    free(want);
}

static void test_shared(void) {
    shared_table();
    shared_known();
    shared_pick();
    shared_single();
    shared_damped();
    shared_no_more_poles();
    shared_bounds();
    shared_exp_rest();
    shared_public();
    shared_same_bits();
    shared_least_squares();
    shared_heat();
}

#endif
