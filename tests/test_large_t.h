/* Diffusion distances at every time up to where they underflow, held against sums over all eigenpairs of a dense eigensolution.
   Constants drop out of the truth exactly, as L's rows sum to zero by definition where they do so but for rounding. */

typedef struct large_case {
    const char *name;
    hd_laplacian *lap;
    dense_pair p;                                /* rows */
    double *bx;                                  /* [n n] B x by rows */
    double unit, low;                            /* h^2 or what is like it; the smallest eigenvalue that is not of constants */
    double seen, bound;                          /* the largest ones over all that was asked */
} large_case;

static large_case large_make(const char *name, hd_laplacian *lap) {
    large_case c;
    double *L = test_dense(&lap->L, NULL), *B = test_dense_mass(lap), sum = 0;
    const int32_t n = lap->n_active;
    int32_t i, j, k;
    memset(&c, 0, sizeof c);
    c.name = name;
    c.lap = lap;
    for (i = 0; i < n; i++) {
        double rest = 0;
        for (j = 0; j < n && lap->conserves; j++) rest -= j == i ? 0 : L[(size_t)i * (size_t)n + (size_t)j];
        if (lap->conserves) L[(size_t)i * (size_t)n + (size_t)i] = rest;
        sum += L[(size_t)i * (size_t)n + (size_t)i] / B[(size_t)i * (size_t)n + (size_t)i];
    }
    CHECK(dense_pair_solve(&c.p, L, B, n));
    c.bx = DENSE_NEW(double, (int64_t)n * n);
    for (k = 0; k < n; k++) dense_apply(c.p.B, c.p.x + (size_t)k * (size_t)n, c.bx + (size_t)k * (size_t)n, n);
    c.unit = lap->h > 0 && lap->kind != HD_LAPLACIAN_COT ? lap->h * lap->h : n / sum;
    c.low = HUGE_VAL;
    for (k = 0, j = 0; k < n; k++) {
        if (c.p.lambda[k] == 0) j++;
        else c.low = fmin(c.low, c.p.lambda[k]);
    }
    CHECK_MSG(j == (lap->conserves ? lap->n_components : 0), "%s: %d constants", name, (int)j);
    return c;
}

static void large_free(large_case *c) {
    CHECK_MSG(c->seen <= 1e-7 && c->bound <= 1e-6, "%s: error %g, bound %g", c->name, c->seen, c->bound);
    dense_pair_free(&c->p);
    free(c->bx);
    hd_laplacian_free(c->lap);
}

static double large_truth(const large_case *c, hd_distance_kind kind, double t, int32_t i, int32_t j) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active, ri = lap->row[i], rj = lap->row[j];
    const int weighted = kind == HD_DISTANCE_WEIGHTED;
    const int32_t ci = ri < 0 ? -1 : lap->component[ri], cj = rj < 0 ? -1 : lap->component[rj];
    double sum = 0, one_i = 0, one_j = 0, constant = 0;
    int32_t k;
    TRAPS_OFF;                                   /* exp may overflow */
    for (k = 0; k < n; k++) {
        const double *z = (weighted ? c->bx : c->p.x) + (size_t)k * (size_t)n;
        const double y = exp(-t * (c->p.lambda[k] - c->low)) * ((ri < 0 ? 0 : z[ri]) - (rj < 0 ? 0 : z[rj]));
        if (c->p.lambda[k] != 0) sum += y * y;
        one_i += ri < 0 ? 0 : weighted ? c->p.B[(size_t)ri * (size_t)n + (size_t)k] : 1.0 / n;
        one_j += rj < 0 ? 0 : weighted ? c->p.B[(size_t)rj * (size_t)n + (size_t)k] : 1.0 / n;
    }
    if (lap->conserves) {
        if (ci >= 0) one_i /= sqrt(lap->component_mass[ci]);
        if (cj >= 0) one_j /= sqrt(lap->component_mass[cj]);
        constant = ci != cj ? hypot(one_i, one_j) : weighted ? fabs(one_i - one_j) : 0;
    }
    sum = hypot(constant, sqrt(sum) * exp(-t * c->low));
    TRAPS_ON;
    return sum;
}

/* Compares n distances: i, j, value. Returns the largest true one. */
static double large_compare(large_case *c, hd_distance_kind kind, double t, int64_t n, const int32_t *i, const int32_t *j, const double *d,
                            const hd_report *r, const char *what) {
    double most = 0, worst = 0;
    int64_t q;
    for (q = 0; q < n; q++) {
        const double want = large_truth(c, kind, t, i[q], j[q]);
        most = fmax(most, want);
        worst = fmax(worst, fabs(d[q] - want));
    }
    if (most < 1e-290) return most;              /* the bound may say no more */
    CHECK_MSG(worst <= r->error_bound * most + 4e-13 * most, "%s, %s, kind %d, t = %g: error %g, bound %g", c->name, what, (int)kind, t / c->unit,
              worst / most, r->error_bound);
    CHECK_MSG(worst <= 1e-7 * most && r->error_bound <= 1e-6, "%s, %s, kind %d, t = %g: error %g, bound %g: %s", c->name, what, (int)kind,
              t / c->unit, worst / most, r->error_bound, r->reason);
    c->seen = fmax(c->seen, worst / most);
    c->bound = fmax(c->bound, r->error_bound);
    return most;
}

/* From two sources to all, all vertices' pairs with one, and samples. */
static double large_at(large_case *c, hd_heat *heat, hd_distance_kind kind, double t, double *d, int32_t *i, int32_t *j) {
    enum { SAMPLES = 6 };
    const int32_t n = c->lap->n, source[2] = {c->lap->vertex[0], c->lap->vertex[c->lap->n_active / 2]};
    int32_t vertex[SAMPLES], q, r;
    double far[SAMPLES], most;
    hd_report rep;
    CHECK_MSG(heat_distance(heat, kind, 1, &t, 2, source, d, 0, &rep) >= 0, "%s: %s", c->name, rep.error.text);
    for (r = 0; r < 2; r++)
        for (q = 0; q < n; q++) {
            i[r * n + q] = source[r];
            j[r * n + q] = q;
        }
    most = large_compare(c, kind, t, n, i, j, d, &rep, "distance");
    large_compare(c, kind, t, n, i + n, j + n, d + n, &rep, "distance");
    CHECK_MSG(rep.n_lost <= 12 || most < 1e-290 || t * c->low > 650, "%s, kind %d, t = %g: %d lost", c->name, (int)kind, t / c->unit, (int)rep.n_lost);
    CHECK(heat_pairs(heat, kind, t, n, i, j, NULL, d, &rep) >= 0);
    large_compare(c, kind, t, n, i, j, d, &rep, "pairs");
    CHECK(heat_sample(heat, kind, t, SAMPLES, 0, vertex, far, &rep) >= 0);
    for (q = 1; q < SAMPLES; q++) {
        double nearest = HUGE_VAL, farthest = 0;
        int32_t v;
        for (r = 0; r < q; r++) nearest = fmin(nearest, large_truth(c, kind, t, vertex[r], vertex[q]));
        for (v = 0; v < n; v++) {
            double at = HUGE_VAL;
            for (r = 0; r < q && c->lap->row[v] >= 0; r++) at = fmin(at, large_truth(c, kind, t, vertex[r], v));
            if (c->lap->row[v] >= 0) farthest = fmax(farthest, at);
        }
        if (most > 1e-290)
            CHECK_MSG(fabs(far[q] - nearest) <= 1e-7 * most && nearest >= farthest - 2e-7 * most, "%s, kind %d, t = %g: sample %d at %g of %g of %g", c->name, (int)kind, t / c->unit, (int)q, far[q], nearest, farthest);
    }
    return most;
}

/* Columns at all these times. They are relative to their largest value, which is never below a constant where heat stays: no
   method loses digits there, however few modes are left. (Where it flows out, values fall below the error of any poles.) */
static void large_columns(const large_case *c) {
    static const hd_method methods[3] = {HD_METHOD_AUTO, HD_METHOD_DIRECT, HD_METHOD_KRYLOV};
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active, source = lap->vertex[n / 3], row = lap->row[source];
    double *u = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, n), x;
    int32_t m, i, k;
    for (m = 0; m < 6 && lap->conserves; m++) {
        hd_heat *heat = eng_plan(lap, methods[m / 2], HD_POLES_DEFAULT, 0);
        const hd_kernel kernel = m % 2 ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        for (x = 10; x < 1e7; x *= 4) {
            const double t = x * c->unit;
            double most = 0, worst = 0;
            hd_report r;
            memset(want, 0, (size_t)n * sizeof *want);
            for (k = 0; k < n; k++) {
                const double *z = c->p.x + (size_t)k * (size_t)n, from = (m % 2 ? c->bx + (size_t)k * (size_t)n : z)[row];
                for (i = 0; i < n; i++) want[i] += exp(-t * c->p.lambda[k]) * z[i] * from;
            }
            CHECK(heat_columns(heat, t, kernel, 1, &source, u, 0, &r) == HD_OK);
            for (i = 0; i < n; i++) {
                most = fmax(most, fabs(want[i]));
                worst = fmax(worst, fabs(u[lap->vertex[i]] - want[i]));
            }
            CHECK_MSG(worst <= 1e-7 * most && r.error_bound <= 1e-6 && worst <= (r.error_bound + 4e-13) * most,
                      "%s, columns, case %d, %g h^2: error %g, bound %g", c->name, (int)m, x, worst / most, r.error_bound);
        }
        hd_heat_free(heat);
    }
    free(u);
    free(want);
}

static void large_run(const char *name, hd_laplacian *lap) {
    enum { MOST = 16 };
    large_case c = large_make(name, lap);
    double t[MOST], *d = DENSE_NEW(double, MOST * (int64_t)lap->n);
    int32_t *i = DENSE_NEW(int32_t, 2 * (int64_t)lap->n), *j = DENSE_NEW(int32_t, 2 * (int64_t)lap->n), n_times, q;
    const int32_t source = lap->vertex[lap->n_active / 3];
    int kind;
    for (kind = 0; kind < 2; kind++) {
        hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        hd_report r;
        for (n_times = 0; n_times < MOST; n_times++) {
            t[n_times] = 0.3 * c.unit * pow(10, n_times * 6.6 / (MOST - 1));
            if (large_at(&c, heat, (hd_distance_kind)kind, t[n_times], d, i, j) < 1e-290) break;
        }
        hd_heat_free(heat);
        heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        CHECK(heat_distance(heat, (hd_distance_kind)kind, n_times, t, 1, &source, d, 0, &r) >= 0);
        for (q = 0; q < lap->n; q++) {
            i[q] = source;
            j[q] = q;
        }
        for (q = 0; q < n_times; q++) large_compare(&c, (hd_distance_kind)kind, t[q], lap->n, i, j, d + q * lap->n, &r, "many times");
        hd_heat_free(heat);
    }
    free(d);
    free(i);
    free(j);
    large_columns(&c);
    large_free(&c);
}

/* Eigenpairs are kept, made again after an update, and fit where the poles do not. */
static void large_kept(void) {
    shape ball = shape_bumpy(3, 5);
    hd_context ctx;
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_laplacian *lap = test_laplacian_at(&ball, ball.xyz, HD_LAPLACIAN_FEM, 1, NULL), *fresh;
    double *d = DENSE_NEW(double, 3 * (int64_t)ball.n), *again = d + ball.n, *moved = again + ball.n, t = 1000 * lap->h * lap->h;
    const int32_t source = 5;
    hd_heat *heat, *other;
    hd_estimate e;
    hd_report r;
    int32_t i;
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    heat = eng_create(lap, &o);
    CHECK(hd_heat_estimate(heat, HD_QUERY_DISTANCE, 1, &t, 1, &e, NULL) == HD_OK && strstr(e.reason, "eigenpairs") != NULL);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, d, 0, &r) == HD_OK && strstr(r.reason, "eigenpairs") != NULL && r.n_lost == 0);
    CHECK(r.evidence_rational == HD_EVIDENCE_PROVEN && r.evidence_solver == HD_EVIDENCE_PROVEN && r.error_solver > 0);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, again, 0, &r) == HD_OK && memcmp(d, again, (size_t)ball.n * sizeof *d) == 0);
    CHECK(hd_heat_estimate(heat, HD_QUERY_DISTANCE, 1, &t, 1, &e, NULL) == HD_OK && e.cost[0].seconds == 0);
    for (i = 0; i < 3 * ball.n; i++) ball.xyz[i] *= i % 3 ? 1 : 1.5;
    CHECK(hd_laplacian_update(lap, ball.xyz, NULL) >= 0);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, again, 0, &r) == HD_OK);
    fresh = test_laplacian_at(&ball, ball.xyz, HD_LAPLACIAN_FEM, 1, NULL);
    other = eng_plan(fresh, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    CHECK(heat_distance(other, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, moved, 0, &r) == HD_OK);
    for (i = 0; i < ball.n; i++) CHECK(fabs(again[i] - moved[i]) <= 1e-8 * dense_max_abs(moved, ball.n));
    CHECK(dense_max_diff(again, d, ball.n) > 0.01 * dense_max_abs(again, ball.n));
    hd_heat_free(heat);
    CHECK(ctx.bytes_in_use == 0);
    ctx.byte_limit = 4000000;                    /* of the 9.1 MB that poles need; 2.6 MB are too little for either */
    heat = eng_create(lap, &o);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, again, 0, &r) == HD_OK && strstr(r.reason, "eigenpairs") != NULL);
    CHECK(memcmp(moved, again, (size_t)ball.n * sizeof *again) == 0);
    hd_heat_free(heat);
    ctx.byte_limit = 2600000;
    heat = eng_create(lap, &o);
    i = heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, d, 0, &r);
    CHECK_MSG(i == HD_ERR_MEMORY_LIMIT && r.error.value > 4e6, "%d, %s: %s", (int)i, r.reason, r.error.text);
    hd_heat_free(heat);
    CHECK(ctx.bytes_in_use == 0);
    hd_heat_free(other);
    hd_laplacian_free(fresh);
    hd_laplacian_free(lap);
    shape_free(&ball);
    free(d);
}

static void test_large_t(void) {
    const double offset[3] = {4, 0, 0};
    shape ball = shape_bumpy(2, 5), torus = shape_torus(18, 10, 1, 0.4), grid = shape_grid(15, 11, 0.2);
    shape small = shape_icosphere(1), two = shape_disjoint(&small, &small, offset), inert = eng_with_inert(&small);
    large_run("ball, fem", test_laplacian(&ball, HD_LAPLACIAN_FEM));
    large_run("torus, voronoi-cot", test_laplacian(&torus, HD_LAPLACIAN_VORONOI_COT));
    large_run("grid, cot", test_laplacian(&grid, HD_LAPLACIAN_COT));
    large_run("grid, fem", test_laplacian(&grid, HD_LAPLACIAN_FEM));
    large_run("two equal", test_laplacian(&two, HD_LAPLACIAN_FEM));
    large_run("inert", test_laplacian(&inert, HD_LAPLACIAN_FEM));
    large_run("dirichlet", kry_dirichlet(60));
    large_run("leaking", eng_leaking(12, 9));
    large_kept();
    shape_free(&ball);
    shape_free(&torus);
    shape_free(&grid);
    shape_free(&small);
    shape_free(&two);
    shape_free(&inert);
}
