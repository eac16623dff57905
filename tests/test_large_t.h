/* Every time up to where answers underflow: distances, and heat that flows out, against the truth of small shapes and in closed form. */

#ifndef TEST_LARGE_T_H
#define TEST_LARGE_T_H

/* ---- against the truth ---- */

#define LARGE_KEPT "shape=bumpy/1/5|torus/8/6|flat/8/5/0.2|two/2/0/4|inert/5/1 op=fem|vor|cot query="
#define LARGE_HELD "shape=flat/8/6/0.2|disk/3/0|disk/3/1 op=fem+held|vor+held query="
static const case_row large_rows[] = {
    /* distances, until they are below the smallest doubles (no bound then, nor one of each value where some are equal); columns, which are
     * never below a constant where heat stays */
    {LARGE_KEPT "distance|pairs kind=classical|weighted k=2 th=0.3|1|3|8|20|60|150|400", 1e-6, 0, 8},
    {LARGE_KEPT "distance kind=classical|weighted times=9 span=400 th=0.3 seed=0|1", 1e-6, 0, 1},
    {LARGE_KEPT "distance|pairs kind=classical|weighted k=2 th=3000|2e4|2e5|2e6", 1e-6, 0, 140},
    {LARGE_KEPT "column kernel=operator|symmetric method=auto|direct|krylov th=10|40|160|640|1e4|1e5|1e7", 1e-6, 0, 0},
    {"shape=drain/30/0.5|leak/30/0.01 op=I query=distance|pairs kind=classical|weighted k=2 th=0.3|3|30|300", 1e-6, 0, 0},
    {"shape=drain/30/0.5|leak/30/0.01 op=tri query=distance|pairs kind=classical|weighted k=2 th=0.3|3|30|300", 2e-5, 0, 0},
    /* more components than eigenpairs are taken up for: without them the bound is that of the poles, above the usual 1e-6 */
    {"shape=soup/24/1 op=fem query=distance kind=classical|weighted th=1|10|1e10", 4e-5, 0, 4},
    {"shape=soup/24/1 op=fem query=distance kind=classical|weighted times=3 span=1e10 th=1", 1e-5, 0, 2},
    {"shape=soup/24/1 op=fem query=diagonal kernel=operator|symmetric method=auto|direct th=1e10", 1e-12, 0, 0},
    /* heat that fades: all of it leaves at held vertices */
    {LARGE_HELD "column|entries|diagonal kernel=operator|symmetric k=9 method=auto|direct th=1|4|8|16|30|100|400", 1e-6, 0, 0},
    {LARGE_HELD "apply|adjoint field=random|smooth method=auto|direct th=1|8|30|400", 1e-6, 0, 0},
    {LARGE_HELD "times|diagonal kind=weighted kernel=operator|symmetric times=7 span=1e4 method=auto|direct th=0.04 seed=0|1", 1e-6, 0, 0},
};

static void large_cases(void) { CASES(large_rows); }

/* ---- closed forms ---- */

/* Only the mean of each component is left: 1/mass. */
static void large_equal(void) {
    const hd_laplacian *lap = kit_pair("soup/24/1 fem");
    hd_heat *heat = kit_heat(lap, "method=direct");
    const double t = 1e10 * lap->area;
    double *d = KIT_NEW(double, lap->n);
    int32_t row;
    CHECK(lap->n_components == 24 && heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, d, 0, NULL) == HD_OK);
    for (row = 0; row < lap->n_active; row++)
        CHECK(fabs(d[lap->vertex[row]] * lap->component_mass[lap->component[row]] - 1) <= 1e-12);
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_OPERATOR, d, 0, NULL) == HD_OK);
    for (row = 0; row < lap->n_active; row++)
        CHECK(fabs(d[lap->vertex[row]] * lap->component_mass[lap->component[row]] / lap->mass[row] - 1) <= 1e-12);
}

/* A square of m x m cells, its border held, with diagonal masses: kernels are products of two sums over sines, of eigenvalues
 * 4 sin^2(i pi/(2 m)) m^2. Both sums are multiplied by exp(t low/2). */
static double large_sines(int32_t m, double t, double low, int32_t a, int32_t b) {
    double sum = 0;
    int32_t i;
    for (i = 1; i < m; i++) {
        const double half = sin(i * heat_pi / (2 * m));
        sum += 2 * exp(-t * (4 * half * half * m * m - low / 2)) * sin(i * heat_pi * a / m) * sin(i * heat_pi * b / m);
    }
    return sum;
}

static void large_square(void) {
    enum { M = 64, N = M + 1 };
    static const double when[7] = {1, 4, 8, 16, 30, 100, 600};    /* t lambda_1 */
    static const int32_t from[2] = {N * N / 2, 2 * N + 2};        /* the middle, and beside a corner */
    const shape *s = kit_own(shape_grid(N, N, 0));
    const double low = 8 * sin(heat_pi / (2 * M)) * sin(heat_pi / (2 * M)) * M * M;
    double *u = KIT_NEW(double, N * N), x[N], y[N], t;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_heat *heat;
    hd_report r;
    int32_t q, w, v;
    memset(&o, 0, sizeof o);
    o.kind = HD_LAPLACIAN_VORONOI_COT;
    o.border = HD_BORDER_DIRICHLET;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, NULL) == HD_OK);
    kit_keep(lap, kit_free_laplacian);
    heat = kit_heat(lap, "");
    for (q = 0; q < 14; q++) {
        double most = 0, worst = 0;
        w = from[q % 2];
        t = when[q / 2] / low;
        CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, &w, u, 0, &r) == HD_OK && r.error_bound <= 1e-6);
        for (v = 0; v < N; v++) {
            x[v] = large_sines(M, t, low, w % N, v);
            y[v] = large_sines(M, t, low, w / N, v);
        }
        for (v = 0; v < N * N; v++) {
            most = fmax(most, x[v % N] * y[v / N]);
            worst = fmax(worst, fabs(u[v] * exp(t * low) - x[v % N] * y[v / N]));
        }
        CHECK_MSG(worst <= 1e-7 * most && worst <= (r.error_bound + 1e-12 * (1 + t * low)) * most, "from %d, %g: error %g, bound %g",
                  (int)w,
                  t * low, worst / most, r.error_bound);
    }
    CHECK(heat_columns(heat, 2000 / low, HD_KERNEL_SYMMETRIC, 1, from, u, 0, &r) == HD_WARN_ACCURACY);
    for (v = 0; v < N * N; v++) CHECK(u[v] == 0);
}

/* ---- eigenpairs ---- */

/* Samples at every time: each point is as far from the nearest one before it as pairs say. */
static void large_samples(void) {
    enum { COUNT = 6, PAIRS = COUNT * (COUNT - 1) / 2 };
    static const char *const pairs[3] = {"bumpy/2/5 fem", "torus/18/10 vor", "flat/15/11/0.2 cot"};
    int32_t vertex[COUNT], i[PAIRS], j[PAIRS], q, r, m, v;
    double far[COUNT], d[PAIRS], most;
    hd_report rep;
    for (q = 0; q < 3 * 2 * 14; q++) {
        const hd_laplacian *lap = kit_pair(pairs[q / 28]);
        const hd_distance_kind kind = q % 2 ? HD_DISTANCE_WEIGHTED : HD_DISTANCE_CLASSICAL;
        const double t = 0.3 * pow(10, q / 2 % 14 * 0.5) * trial_unit(lap);
        hd_heat *heat = kit_heat(lap, "");
        CHECK(heat_sample(heat, kind, t, COUNT, vertex, far, &rep) >= 0);
        for (v = 1, m = 0; v < COUNT; v++)
            for (r = 0; r < v; r++, m++) {
                i[m] = vertex[r];
                j[m] = vertex[v];
            }
        CHECK(heat_pairs(heat, kind, t, PAIRS, i, j, d, NULL) >= 0);
        most = dense_max_abs(d, PAIRS);
        for (v = 1, m = 0; v < COUNT && most > 1e-290; v++) {
            double nearest = HUGE_VAL;
            for (r = 0; r < v; r++) nearest = fmin(nearest, d[m++]);
            CHECK_MSG(fabs(far[v] - nearest) <= 2e-7 * most && rep.error_bound <= 1e-6, "%s, kind %d, t = %g: point %d at %g, not %g of %g, bound %g",
                      pairs[q / 28], (int)kind, t, (int)v, far[v], nearest, most, rep.error_bound);
        }
    }
}

/* Made again after an update, and they fit where the poles do not. */
static void large_kept(void) {
    shape ball = shape_bumpy(3, 5);
    const int32_t n = ball.n, source = 5;
    hd_laplacian *lap = (hd_laplacian *)kit_keep(test_laplacian_at(&ball, ball.xyz, HD_LAPLACIAN_FEM, 1, NULL), kit_free_laplacian);
    const double t = 1000 * lap->h * lap->h;
    double *d = KIT_NEW(double, n), *again = KIT_NEW(double, n), *moved = KIT_NEW(double, n);
    hd_context ctx;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_estimate e;
    hd_report r;
    int32_t i, k;
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    o.context = &ctx;
    CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    CHECK(hd_heat_estimate(heat, HD_QUERY_DISTANCE, 1, &t, 1, &e, NULL) == HD_OK && strstr(e.reason, "eigenpairs") != NULL);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, d, 0, &r) == HD_OK && strstr(r.reason, "eigenpairs") != NULL &&
          r.n_lost == 0);
    CHECK(r.evidence_rational == HD_EVIDENCE_PROVEN && r.evidence_solver == HD_EVIDENCE_ESTIMATED && r.error_solver > 0);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, again, 0, &r) == HD_OK &&
          memcmp(d, again, (size_t)n * sizeof *d) == 0);
    CHECK(hd_heat_estimate(heat, HD_QUERY_DISTANCE, 1, &t, 1, &e, NULL) == HD_OK && e.cost[0].seconds < 1e-6 * n);
    for (i = 0; i < 3 * n; i++) ball.xyz[i] *= i % 3 ? 1 : 1.5;
    CHECK(hd_laplacian_update(lap, MESH_POINTS(ball.xyz, lap->n), NULL) >= 0);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, again, 0, &r) == HD_OK);
    CHECK(heat_distance(kit_heat(kit_triangles(kit_own(ball), HD_LAPLACIAN_FEM), ""), HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, moved,
                        0, &r) == HD_OK);
    CHECK(dense_max_diff(again, moved, n) <= 1e-8 * dense_max_abs(moved, n) && dense_max_diff(again, d,
        n) > 0.01 * dense_max_abs(again, n));
    hd_heat_free(heat);
    for (k = 0; k < 2; k++) {                    /* of the 9 MB that poles need; 1.5 MB are too little for either */
        CHECK(ctx.bytes_in_use == 0);
        ctx.byte_limit = k ? 1500000 : 4000000;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        i = heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, again, 0, &r);
        if (k) CHECK_MSG(i == HD_ERR_MEMORY_LIMIT && r.error.value > 4e6, "%d, %s: %s", (int)i, r.reason, r.error.text);
        else CHECK(i == HD_OK && strstr(r.reason, "eigenpairs") != NULL && memcmp(moved, again, (size_t)n * sizeof *again) == 0);
        hd_heat_free(heat);
    }
    CHECK(ctx.bytes_in_use == 0);
}

/* ---- units, and the smallest doubles ---- */

/* The pair of one grid, in lengths that are 2^unit times as large. */
static hd_laplacian *large_grid(const char *op, int unit) {
    hd_laplacian *lap = NULL;
    hd_error e;
    if (trial_pair(&lap, "flat/8/5/0.2", op, ldexp(1, unit), &e) < 0) truth_stop(e.text);
    return (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
}

/* The first eigenvalue that is not of a constant. */
static double large_first(const hd_laplacian *lap) {
    hd_spectrum *s = NULL;
    hd_spectrum_opts o;
    double first = 0;
    memset(&o, 0, sizeof o);
    o.count = 2;
    if (CHECK(hd_spectrum_create(&s, lap, &o, NULL) == HD_OK && s->n_constant < 2)) first = s->value[s->n_constant];
    hd_spectrum_free(s);
    return first;
}

/* Answers from eigenpairs and their bounds do not change with the unit, up to powers of two. */
static void large_units(void) {
    static const int units[] = {0, -150, -90, 80, 90, 150};
    static double want[3][40], seen[3];
    const double c = 8;
    const int32_t source = 17;
    double f[40], u[40];
    int32_t q, i, a;
    for (i = 0; i < 40; i++) f[i] = 1e60 * (cos(1.7 * i) + 0.3);
    TRAPS_OFF;                                   /* of a solve that auto compares with */
    for (q = 0; q < 18; q++) {
        const int unit = units[q / 3];
        const hd_laplacian *lap = large_grid(q % 3 ? "fem" : "fem+held", unit);
        hd_heat *heat = kit_heat(lap, "");
        double t, worst = 0, most = 0;
        hd_report r;
        a = q % 3;
        t = c / large_first(lap);
        if (a == 0) CHECK(heat_apply(heat, t, 1, f, 0, u, 0, &r) == HD_OK);
        else CHECK(heat_distance(heat, a == 1 ? HD_DISTANCE_CLASSICAL : HD_DISTANCE_WEIGHTED, 1, &t, 1, &source, u, 0, &r) == HD_OK);
        for (i = 0; i < 40; i++) {
            const double v = ldexp(u[i], a == 0 ? 0 : a == 1 ? unit : -unit);
            if (q < 3) want[a][i] = v;
            worst = fmax(worst, fabs(v - want[a][i]));
            most = fmax(most, want[a][i]);
        }
        if (q < 3) seen[a] = r.error_bound;
        CHECK_MSG(most > 0 && worst <= r.error_bound * most && fabs(r.error_bound - seen[a]) <= 1e-3 * seen[a],
                  "unit 2^%d, answer %d: %g off, bound %g, %g in the given unit", unit, (int)a, worst / most, r.error_bound, seen[a]);
    }
    TRAPS_ON;
}

/* Where one eigenpair is left distances fall like exp(-t lambda), also where that alone is among the smallest doubles or below. In small
 * lengths classical distances are large, in large ones weighted ones. */
static void large_below(void) {
    static const double c[] = {600, 735, 800};
    const int32_t source = 17;
    double t[3], d[120];
    int32_t q, i, m;
    for (q = 0; q < 2; q++) {
        const hd_laplacian *lap = large_grid("fem+held", q ? -150 : 150);
        hd_report r;
        for (m = 0; m < 3; m++) t[m] = c[m] / large_first(lap);
        CHECK(heat_distance(kit_heat(lap, ""), q ? HD_DISTANCE_CLASSICAL : HD_DISTANCE_WEIGHTED, 3, t, 1, &source, d, 0, &r) == HD_OK);
        CHECK(r.error_bound <= 1e-9);
        for (m = 1; m < 3; m++) {
            double worst = 0, most = 0;
            for (i = 0; i < 40; i++) {
                const double want = d[i] * exp(c[0] - c[m]);
                worst = fmax(worst, fabs(d[m * 40 + i] - want));
                most = fmax(most, want);
            }
            CHECK_MSG(most > 0 && worst <= 1e-11 * most, "kind %d, exp(-%g): %g off", (int)q, c[m], worst / most);
        }
    }
}

/* K_t f, K_t' f and dK_t/dt f. */
static hd_status large_ask(hd_heat *heat, int what, double t, const double *f, double *u, hd_report *r) {
    return what == 0 ? hd_heat_apply(heat, 1, &t, 1, f, 0, u, 0, r, NULL)
         : what == 1 ? hd_heat_adjoint(heat, 1, &t, 1, f, 0, u, 0, r, NULL)
                     : hd_heat_derivative(heat, 1, &t, 1, f, 0, u, 0, r, NULL);
}

/* Answers among the smallest doubles have few digits, which bounds tell. Those that underflow are warned of; zeros of zeros are not. */
static void large_smallest(void) {
    static const double sizes[] = {0, 1e-300, 1e-308, 1e-312, 1e-316, 1e-320, 5e-323, 5e-324}, times[] = {0.3, 3, 200};
    static const char *const methods[4] = {"method=auto", "method=iterative", "method=direct", "method=krylov"};
    const hd_laplacian *lap = large_grid("fem+held", 0);
    double f[40], up[40], u[40], want[40];
    int32_t q, i, a;
    TRAPS_OFF;
    for (q = 0; q < 4 * 8 * 9; q++) {
        const double t = times[q % 3];
        const int what = q / 3 % 3;
        const int32_t mark = kit_mark();
        hd_heat *heat = kit_heat(lap, methods[q / 72]);
        double worst = 0, most = 0;
        hd_report r;
        a = q / 9 % 8;
        for (i = 0; i < 40; i++) up[i] = ldexp(f[i] = sizes[a] * (1 + i % 3), 1000);
        CHECK(large_ask(heat, what, t, up, want, NULL) >= HD_OK && large_ask(heat, what, t, f, u, &r) >= HD_OK);
        for (i = 0; i < 40; i++) {
            worst = fmax(worst, fabs(ldexp(u[i], 1000) - want[i]));
            most = fmax(most, fabs(ldexp(u[i], 1000)));
        }
        CHECK_MSG(a == 0   ? r.status == HD_OK && most == 0 && r.error_bound == 0
                  : most > 0 ? worst <= (2 * r.error_bound + 1e-15) * most : r.status == HD_WARN_ACCURACY && r.error_bound >= 1,
                  "%s, question %d, t = %g, size %g: %g off, bound %g", methods[q / 72], what, t, sizes[a], worst / most, r.error_bound);
        kit_release(mark);
    }
    TRAPS_ON;
}

/* t = 0 copies fields, whatever lies between their values. Where heat fades two fields in place are those beside, and held ones 0. */
static void large_copies(void) {
    const hd_laplacian *lap = large_grid("fem+held", 0);
    double f[80], u[80];
    int32_t i;
    int what;
    for (i = 0; i < 40; i++) f[i] = i % 2 ? 1e300 * (i + 1) / 100 : 1e-300 / (i + 3);
    TRAPS_OFF;
    CHECK(heat_apply(kit_heat(large_grid("fem", 0), ""), 0, 1, f, 0, u, 0, NULL) == HD_OK && memcmp(f, u, 40 * sizeof *f) == 0);
    TRAPS_ON;
    for (what = 0; what < 2; what++) {
        const double t = 100 * lap->h * lap->h;
        hd_heat *heat = kit_heat(lap, "");
        for (i = 0; i < 80; i++) f[i] = 1 + 0.5 * sin(3.0 * i);
        CHECK((what ? hd_heat_adjoint(heat, 1, &t, 2, f, 0, u, 0, NULL, NULL) : hd_heat_apply(heat, 1, &t, 2, f, 0, u, 0, NULL,
            NULL)) == HD_OK);
        CHECK((what ? hd_heat_adjoint(heat, 1, &t, 2, f, 0, f, 0, NULL, NULL) : hd_heat_apply(heat, 1, &t, 2, f, 0, f, 0, NULL,
            NULL)) == HD_OK);
        CHECK(memcmp(f, u, sizeof f) == 0);
        for (i = 0; i < 80; i++) CHECK((u[i] == 0) == (lap->row[i % 40] == HD_ROW_HELD));
    }
}

/* Rows of L that sum to a few units in the last place count as sums of zero. What that changes in the constants is in the bounds: on a
 * torus of nodes of mass one each row sums to s, and for the L that is given the mean of the answer is exp(-t s) times that of the field. */
static void large_drift(void) {
    enum { SIDE = 16, N = SIDE * SIDE };
    static const char *const methods[] = {"method=auto", "method=iterative", "method=iterative solver=cocg", "method=direct", "method=krylov"};
    const hd_laplacian *plain = kit_lattice(SIDE, SIDE, 1, 1, 1);
    const double s = 24 * DBL_EPSILON, t = 6e-9 / s;     /* 1e6: all but the mean is gone */
    hd_csr L = plain->L, B = kit_own_csr(test_diagonal_csr(N, NULL));
    double *u = KIT_NEW(double, N), *f = KIT_NEW(double, N);
    hd_laplacian *lap = NULL;
    hd_error e;
    int64_t p;
    int32_t i;
    int q, a;
    L.val = KIT_NEW(double, L.nnz);
    for (p = 0; p < L.nnz; p++) L.val[p] = plain->L.val[p] + (plain->L.val[p] > 0 ? s : 0);
    if (hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) < 0) truth_stop(e.text);
    (void)kit_own_laplacian(lap);
    CHECK(lap->conserves == 1);
    for (q = 0; q < 10; q++) {
        const int32_t source = 5;
        double want = exp(-t * s) / N, worst = 0;
        hd_heat *heat = kit_heat(lap, methods[q / 2]);
        hd_report r;
        a = q % 2;
        for (i = 0; i < N; i++) f[i] = i % 7 == 0;
        if (a) want *= (N + 6) / 7;
        CHECK_MSG((a ? heat_apply(heat, t, 1, f, 0, u, 0, &r) : heat_column(heat, t, source, u, &r)) >= 0, "%s: %s", methods[q / 2], r.error.text);
        for (i = 0; i < N; i++) worst = fmax(worst, fabs(u[i] - want) / want);
        CHECK_MSG(worst <= r.error_bound && r.error_rounding >= 5e-9, "%s: %g off, bound %g, rounding %g", methods[q / 2], worst, r.error_bound, r.error_rounding);
    }
}

static void test_large_t(void) {
    large_cases();
    large_equal();
    large_square();
    large_samples();
    large_kept();
    large_units();
    large_below();
    large_smallest();
    large_copies();
    large_drift();
}

#endif
