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

/* More components than eigenpairs are taken up for, at times when only the mean of each is left: 1/mass inside a component. */
static void large_equal(void) {
    enum { PARTS = 24 };
    const double offset[3] = {5, 0, 0};
    shape ball = shape_icosphere(0), all = shape_icosphere(0);
    hd_laplacian *lap;
    large_case c;
    hd_heat *heat;
    hd_report r;
    double *d, t[3];
    int32_t *i, *j, q, row;
    int64_t p;
    int kind;
    for (q = 1; q < PARTS; q++) {                /* no two alike */
        shape one;
        for (row = 0; row < 3 * ball.n; row++) ball.xyz[row] *= row % 3 ? 1.01 : 1.012;
        one = shape_disjoint(&ball, &all, offset);
        shape_free(&all);
        all = one;
    }
    lap = test_laplacian(&all, HD_LAPLACIAN_FEM);
    CHECK(lap->n_components == PARTS);
    c = large_make("many components", lap);
    d = DENSE_NEW(double, 3 * lap->L.nnz);
    i = DENSE_NEW(int32_t, 2 * (int64_t)lap->n);
    j = DENSE_NEW(int32_t, 2 * (int64_t)lap->n);
    t[0] = c.unit;
    t[1] = 10 * c.unit;
    t[2] = 1e10 * c.unit;
    for (kind = 0; kind < 2; kind++) {
        const int32_t source = lap->vertex[7];
        heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
        large_at(&c, heat, (hd_distance_kind)kind, t[2], d, i, j);
        CHECK(heat_distance(heat, (hd_distance_kind)kind, 3, t, 1, &source, d, 0, &r) >= 0);
        for (q = 0; q < 3; q++) {                /* without eigenpairs the bound is that of the poles: above the usual 1e-6 */
            double most = 0, worst = 0;
            for (row = 0; row < lap->n; row++) {
                const double want = large_truth(&c, (hd_distance_kind)kind, t[q], source, row);
                most = fmax(most, want);
                worst = fmax(worst, fabs(d[q * lap->n + row] - want));
            }
            CHECK_MSG(worst <= r.error_bound * most && r.error_bound <= 1e-5, "kind %d, t = %g: error %g, bound %g", kind, t[q] / c.unit, worst / most,
                      r.error_bound);
        }
        hd_heat_free(heat);
    }
    heat = eng_plan(lap, HD_METHOD_DIRECT, HD_POLES_DEFAULT, 0);
    CHECK(heat_edges(heat, t[2], d, &r) == HD_OK && r.error_bound <= 1e-12);
    for (row = 0; row < lap->n_active; row++)
        for (p = lap->L.row_ptr[row]; p < lap->L.row_ptr[row + 1]; p++)
            CHECK(fabs(d[p] * lap->component_mass[lap->component[row]] - 1) <= 1e-12);
    CHECK(heat_diagonal(heat, 3, t, HD_KERNEL_OPERATOR, d, 0, &r) == HD_OK);
    for (row = 0; row < lap->n_active; row++)
        CHECK(fabs(d[2 * lap->n + lap->vertex[row]] * lap->component_mass[lap->component[row]] / lap->mass[row] - 1) <= 1e-12);
    hd_heat_free(heat);
    free(d);
    free(i);
    free(j);
    large_free(&c);
    shape_free(&ball);
    shape_free(&all);
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

/* ---- heat that fades ---- */

static const double large_fading_x[7] = {1, 4, 8, 16, 30, 100, 600};    /* t lambda_1 */

/* The kernel's entries of rows i and j at time t without exp(-t low); mass: bit 0: B at i, bit 1: B at j. */
static double large_kernel(const large_case *c, double t, int32_t i, int32_t j, int mass) {
    const int32_t n = c->lap->n_active;
    double sum = 0;
    int32_t k;
    for (k = 0; k < n; k++) {
        const size_t at = (size_t)k * (size_t)n;
        sum += exp(-t * (c->p.lambda[k] - c->low)) * (mass & 1 ? c->bx : c->p.x)[at + (size_t)i] * (mass & 2 ? c->bx : c->p.x)[at + (size_t)j];
    }
    return sum;
}

/* u at the vertices against want [n_active], both times exp(t low). */
static void large_check(large_case *c, double x, const double *u, const double *want, const hd_report *r, const char *what) {
    const hd_laplacian *lap = c->lap;
    const double grow = exp(x);
    double most = 0, worst = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        most = fmax(most, fabs(want[i]));
        worst = fmax(worst, fabs(u[lap->vertex[i]] * grow - want[i]));
    }
    for (i = 0; i < lap->n; i++)
        if (lap->row[i] == HD_ROW_HELD) CHECK(u[i] == 0);
    CHECK_MSG(worst <= r->error_bound * most + 4e-13 * most * (1 + x), "%s, %s, t lambda = %g: error %g, bound %g", c->name, what, x, worst / most, r->error_bound);
    CHECK_MSG(worst <= 1e-7 * most && r->error_bound <= 1e-6 && r->status == HD_OK, "%s, %s, t lambda = %g: error %g, bound %g: %s", c->name, what, x, worst / most, r->error_bound, r->reason);
    c->seen = fmax(c->seen, worst / most);
    c->bound = fmax(c->bound, r->error_bound);
}

/* A field, or its adjoint, in place and not, two at a time. */
static void large_fading_fields(large_case *c, hd_heat *heat, double x) {
    const double t = x / c->low;
    const int32_t n = c->lap->n, m = c->lap->n_active;
    double *f = DENSE_NEW(double, 6 * (int64_t)n), *u = f + 2 * n, *want = u + 2 * n;
    hd_report r;
    int32_t i, j, q;
    for (i = 0; i < 2 * n; i++) f[i] = 1 + 0.5 * sin(3.0 * i);
    for (q = 0; q < 4; q++) {
        const int adjoint = q > 1, inside = q % 2;
        double *to = inside ? u : f;
        memcpy(u, f, 2 * (size_t)n * sizeof *u);
        to = u;
        CHECK((adjoint ? hd_heat_adjoint(heat, 1, &t, 2, inside ? u : f, 0, to, 0, &r, NULL)
                       : heat_apply(heat, t, 2, inside ? u : f, 0, to, 0, &r)) == HD_OK);
        for (j = 0; j < 2; j++) {
            for (i = 0; i < m; i++) {
                int32_t k;
                want[i] = 0;
                for (k = 0; k < m; k++) want[i] += large_kernel(c, t, i, k, adjoint ? 1 : 2) * f[j * n + c->lap->vertex[k]];
            }
            large_check(c, x, u + j * n, want, &r, adjoint ? "adjoint" : "field");
        }
    }
    free(f);
}

static void large_fading_edges(large_case *c, hd_heat *heat, double x) {
    const hd_csr *L = &c->lap->L;
    const double t = x / c->low;
    double *values = DENSE_NEW(double, L->nnz), most = 0, worst = 0;
    hd_report r;
    int32_t i;
    int64_t p;
    CHECK(heat_edges(heat, t, values, &r) == HD_OK && r.error_bound <= 1e-6);
    for (i = 0; i < L->n_rows; i++)
        for (p = L->row_ptr[i]; p < L->row_ptr[i + 1]; p++) {
            const double want = large_kernel(c, t, i, L->col[p], 0);
            most = fmax(most, fabs(want));
            worst = fmax(worst, fabs(values[p] * exp(x) - want));
        }
    CHECK_MSG(worst <= 1e-7 * most && worst <= (r.error_bound + 4e-13 * (1 + x)) * most, "%s, edges, t lambda = %g: error %g, bound %g", c->name, x,
              worst / most, r.error_bound);
    free(values);
}

/* Columns of a source, entries, diagonals, edges and the trace. */
static void large_fading_at(large_case *c, hd_heat *heat, double x, int32_t row) {
    const hd_laplacian *lap = c->lap;
    const double t = x / c->low;
    const int32_t n = lap->n, m = lap->n_active, source = lap->vertex[row];
    double *u = DENSE_NEW(double, 2 * (int64_t)n), *want = u + n, Z, bound, sum = 0;
    int32_t *to = DENSE_NEW(int32_t, 2 * (int64_t)n), kernel, i;
    hd_report r;
    for (kernel = 0; kernel < 2; kernel++) {
        const hd_kernel which = kernel ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        for (i = 0; i < m; i++) want[i] = large_kernel(c, t, i, row, kernel ? 2 : 0);
        CHECK(heat_columns(heat, t, which, 1, &source, u, 0, &r) == HD_OK);
        large_check(c, x, u, want, &r, kernel ? "column of K" : "column of k");
        for (i = 0; i < n; i++) {
            to[i] = i;
            to[n + i] = source;
        }
        CHECK(heat_entries(heat, t, which, n, to, to + n, u, &r) == HD_OK);
        large_check(c, x, u, want, &r, "entries");
        for (i = 0; i < m; i++) want[i] = large_kernel(c, t, i, i, kernel ? 2 : 0);
        CHECK(heat_diagonal(heat, 1, &t, which, u, 0, &r) == HD_OK);
        large_check(c, x, u, want, &r, kernel ? "diagonal of K" : "diagonal of k");
    }
    large_fading_edges(c, heat, x);
    for (i = 0; i < m; i++) sum += exp(-t * (c->p.lambda[i] - c->low));
    CHECK(hd_heat_trace(heat, 1, &t, &Z, &bound, &r, NULL) == HD_OK && r.error_bound <= 1e-6);
    CHECK(r.error.status == HD_OK && r.error.face == -1 && r.error.column == -1);
    CHECK_MSG(fabs(Z * exp(x) - sum) <= 1e-7 * sum && fabs(Z * exp(x) - sum) <= bound * exp(x) + 4e-13 * (1 + x) * sum, "%s: trace %g, not %g at %g", c->name, Z * exp(x), sum, x);
    free(u);
    free(to);
}

/* All times in one call, the last one first. */
static void large_fading_times(large_case *c, hd_heat *heat, int32_t row) {
    enum { TIMES = 7 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, m = lap->n_active, source = lap->vertex[row];
    double *u = DENSE_NEW(double, (2 * TIMES + 1) * (int64_t)n), *want = u + TIMES * n, *diag = want + n, t[TIMES], Z[TIMES];
    hd_report r, rd, rz;
    int32_t q, i;
    for (q = 0; q < TIMES; q++) t[q] = large_fading_x[TIMES - 1 - q] / c->low;
    t[1] = 0.05 / c->low;                        /* that is for poles */
    CHECK(heat_times(heat, TIMES, t, HD_KERNEL_SYMMETRIC, source, NULL, u, 0, &r) == HD_OK);
    CHECK(heat_diagonal(heat, TIMES, t, HD_KERNEL_SYMMETRIC, diag, 0, &rd) == HD_OK);
    CHECK(hd_heat_trace(heat, TIMES, t, Z, NULL, &rz, NULL) == HD_OK && rz.error_bound <= 1e-6);
    for (q = 0; q < TIMES; q++) {
        double sum = 0;
        for (i = 0; i < m; i++) want[i] = large_kernel(c, t[q], i, row, 0);
        large_check(c, t[q] * c->low, u + q * n, want, &r, "column at many times");
        for (i = 0; i < m; i++) want[i] = large_kernel(c, t[q], i, i, 0);
        large_check(c, t[q] * c->low, diag + q * n, want, &rd, "diagonal at many times");
        for (i = 0; i < m; i++) sum += exp(-t[q] * (c->p.lambda[i] - c->low));
        CHECK(fabs(Z[q] * exp(t[q] * c->low) - sum) <= 1e-7 * sum);
    }
    free(u);
}

/* Where all heat flows out, against a dense eigensolution. */
static void large_fading(const char *name, hd_laplacian *lap) {
    static const hd_method methods[2] = {HD_METHOD_AUTO, HD_METHOD_DIRECT};
    large_case c = large_make(name, lap);
    int32_t m, q;
    for (m = 0; m < 2; m++) {
        for (q = 0; q < 7; q++) {
            hd_heat *heat = eng_plan(lap, methods[m], HD_POLES_DEFAULT, 0);
            large_fading_at(&c, heat, large_fading_x[q], lap->n_active / 3);
            large_fading_at(&c, heat, large_fading_x[q], lap->n_active - 1);
            if (q % 2 == 0) large_fading_fields(&c, heat, large_fading_x[q]);
            hd_heat_free(heat);
        }
        {
            hd_heat *heat = eng_plan(lap, methods[m], HD_POLES_DEFAULT, 0);
            large_fading_times(&c, heat, lap->n_active / 3);
            hd_heat_free(heat);
        }
    }
    large_free(&c);
}

/* A square of m x m cells, its border held, with diagonal masses: products of sines are eigenvectors, with the sums of
   4 sin^2(i pi/(2 m)) m^2. */
static void large_square(int32_t m) {
    shape s = shape_grid(m + 1, m + 1, 0);
    const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_VORONOI_COT, HD_BORDER_DIRICHLET, 0, NULL);
    hd_laplacian *lap = bord_triangles(&s, &o);
    const int32_t from[2] = {s.n / 2, 2 * (m + 1) + 2};     /* the middle, and beside a corner */
    const double unit = 8 * sin(BORD_PI / (2 * m)) * sin(BORD_PI / (2 * m)) * m * m;
    double *u = DENSE_NEW(double, s.n);
    hd_heat *heat = eng_plan(lap, HD_METHOD_AUTO, HD_POLES_DEFAULT, 0);
    hd_report r;
    int32_t q, w, i, v;
    for (q = 0; q < 7; q++)
        for (w = 0; w < 2; w++) {
            const double t = large_fading_x[q] / unit, *a = s.xyz + 3 * from[w];
            double most = 0, worst = 0;
            CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, from + w, u, 0, &r) == HD_OK && r.error_bound <= 1e-6);
            for (v = 0; v < s.n; v++) {
                const double *b = s.xyz + 3 * v;
                double x = 0, y = 0;
                for (i = 1; i < m; i++) {
                    const double half = sin(i * BORD_PI / (2 * m)), e = 2 * exp(-t * (4 * half * half * m * m - unit / 2));
                    x += e * sin(i * BORD_PI * a[0]) * sin(i * BORD_PI * b[0]);
                    y += e * sin(i * BORD_PI * a[1]) * sin(i * BORD_PI * b[1]);
                }
                most = fmax(most, x * y);
                worst = fmax(worst, fabs(u[v] * exp(t * unit) - x * y));
            }
            CHECK_MSG(worst <= 1e-7 * most && worst <= (r.error_bound + 1e-12 * (1 + t * unit)) * most, "square, %d, %g: error %g, bound %g", (int)w,
                      t * unit, worst / most, r.error_bound);
        }
    CHECK(heat_columns(heat, 2000 / unit, HD_KERNEL_SYMMETRIC, 1, from, u, 0, &r) == HD_WARN_ACCURACY);
    for (v = 0; v < s.n; v++) CHECK(u[v] == 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(u);
}

static hd_laplacian *large_held(const shape *s, hd_laplacian_kind kind) {
    const hd_laplacian_opts o = bord_opts(kind, HD_BORDER_DIRICHLET, 0, NULL);
    return bord_triangles(s, &o);
}

/* Lengths 2^j times as large are another unit: answers from eigenpairs and their bounds do not change, up to powers of two. */
static void large_units(void) {
    static const int units[] = {0, -480, -280, 250, 280, 480};
    static double want[3][40], seen[3];
    shape s = shape_grid(8, 5, 0.2);
    double *given = DENSE_NEW(double, 3 * s.n), f[40], u[40];
    const int32_t source = 17;
    int32_t q, i, a;
    memcpy(given, s.xyz, 3 * (size_t)s.n * sizeof *given);
    for (i = 0; i < s.n; i++) f[i] = 1e60 * (cos(1.7 * i) + 0.3);
    TRAPS_OFF;                                   /* of a solve that auto compares with */
    for (q = 0; q < 6; q++) {
        const int j = units[q];
        for (i = 0; i < 3 * s.n; i++) s.xyz[i] = ldexp(given[i], j);
        for (a = 0; a < 3; a++) {
            const hd_distance_kind kind = a == 1 ? HD_DISTANCE_CLASSICAL : HD_DISTANCE_WEIGHTED;
            hd_laplacian *lap = a == 0 ? large_held(&s, HD_LAPLACIAN_FEM) : test_laplacian(&s, HD_LAPLACIAN_FEM);
            const double c = 8;
            double t, worst = 0, most = 0;
            hd_heat *heat = NULL;
            hd_report r;
            CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK && hd_times_spectral(lap, 1, &c, &t, NULL) == HD_OK);
            if (a == 0) CHECK(heat_apply(heat, t, 1, f, 0, u, 0, &r) == HD_OK);
            else CHECK(heat_distance(heat, kind, 1, &t, 1, &source, u, 0, &r) == HD_OK);
            for (i = 0; i < s.n; i++) {
                const double v = ldexp(u[i], a == 0 ? 0 : a == 1 ? j : -j);
                if (q == 0) want[a][i] = v;
                worst = fmax(worst, fabs(v - want[a][i]));
                most = fmax(most, want[a][i]);
            }
            if (q == 0) seen[a] = r.error_bound;
            CHECK_MSG(most > 0 && worst <= r.error_bound * most && fabs(r.error_bound - seen[a]) <= 1e-3 * seen[a],
                      "unit 2^%d, answer %d: %g off, bound %g, %g in the given unit", j, a, worst / most, r.error_bound, seen[a]);
            hd_heat_free(heat);
            hd_laplacian_free(lap);
        }
    }
    TRAPS_ON;
    free(given);
    shape_free(&s);
}

/* Where one eigenpair is left distances fall like exp(-t lambda), also where that alone is among the smallest doubles or below. */
static void large_below(void) {
    static const double c[] = {600, 735, 800};
    shape s = shape_grid(8, 5, 0.2);
    double t[3], d[120];
    const int32_t source = 17;
    int32_t q, i, m;
    for (i = 0; i < 3 * s.n; i++) s.xyz[i] = ldexp(s.xyz[i], 350);
    for (q = 0; q < 2; q++) {                    /* small lengths: classical distances are large; large ones: weighted ones */
        hd_laplacian *lap;
        hd_heat *heat = NULL;
        hd_report r;
        for (i = 0; i < 3 * s.n && q; i++) s.xyz[i] = ldexp(s.xyz[i], -700);
        lap = large_held(&s, HD_LAPLACIAN_FEM);
        CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK && hd_times_spectral(lap, 3, c, t, NULL) == HD_OK);
        CHECK(heat_distance(heat, q ? HD_DISTANCE_CLASSICAL : HD_DISTANCE_WEIGHTED, 3, t, 1, &source, d, 0, &r) == HD_OK);
        CHECK(r.error_bound <= 1e-9);
        for (m = 1; m < 3; m++) {
            double worst = 0, most = 0;
            for (i = 0; i < s.n; i++) {
                const double want = d[i] * exp(c[0] - c[m]);
                worst = fmax(worst, fabs(d[m * s.n + i] - want));
                most = fmax(most, want);
            }
            CHECK_MSG(most > 0 && worst <= 1e-11 * most, "kind %d, exp(-%g): %g off", (int)q, c[m], worst / most);
        }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    shape_free(&s);
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
    shape s = shape_grid(8, 5, 0.2);
    hd_laplacian *lap = large_held(&s, HD_LAPLACIAN_FEM);
    double f[40], up[40], u[40], want[40];
    int32_t q, i, m, a, what;
    TRAPS_OFF;
    for (m = 0; m < 4; m++) {
        hd_heat_opts o;
        memset(&o, 0, sizeof o);
        o.method = (hd_method)m;
        for (a = 0; a < 8; a++) {
            for (q = 0; q < 9; q++) {
                hd_heat *heat = NULL;
                hd_report r;
                double worst = 0, most = 0;
                what = q / 3;
                CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
                for (i = 0; i < s.n; i++) up[i] = ldexp(f[i] = sizes[a] * (1 + i % 3), 1000);
                CHECK(large_ask(heat, what, times[q % 3], up, want, NULL) >= HD_OK);
                CHECK(large_ask(heat, what, times[q % 3], f, u, &r) >= HD_OK);
                for (i = 0; i < s.n; i++) {
                    worst = fmax(worst, fabs(ldexp(u[i], 1000) - want[i]));
                    most = fmax(most, fabs(ldexp(u[i], 1000)));
                }
                CHECK_MSG(a == 0   ? r.status == HD_OK && most == 0 && r.error_bound == 0
                          : most > 0 ? worst <= (2 * r.error_bound + 1e-15) * most : r.status == HD_WARN_ACCURACY && r.error_bound >= 1,
                          "method %d, question %d, t = %g, size %g: %g off, bound %g", (int)m, (int)what, times[q % 3], sizes[a], worst / most,
                          r.error_bound);
                hd_heat_free(heat);
            }
        }
    }
    TRAPS_ON;
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* t = 0 copies fields, whatever lies between their values. */
static void large_copies(void) {
    shape s = shape_grid(8, 5, 0.2);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = NULL;
    double f[40], u[40];
    int32_t i;
    for (i = 0; i < s.n; i++) f[i] = i % 2 ? 1e300 * (i + 1) / 100 : 1e-300 / (i + 3);
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    TRAPS_OFF;
    CHECK(heat_apply(heat, 0, 1, f, 0, u, 0, NULL) == HD_OK);
    TRAPS_ON;
    CHECK(memcmp(f, u, sizeof f) == 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void test_large_t(void) {
    const double offset[3] = {4, 0, 0};
    shape ball = shape_bumpy(2, 5), torus = shape_torus(18, 10, 1, 0.4), grid = shape_grid(15, 11, 0.2);
    shape disk = bord_disk(6, 0), half = bord_disk(6, 1);
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
    large_equal();
    large_fading("square", large_held(&grid, HD_LAPLACIAN_FEM));
    large_fading("disk", large_held(&disk, HD_LAPLACIAN_FEM));
    large_fading("hemisphere", large_held(&half, HD_LAPLACIAN_VORONOI_COT));
    large_square(64);
    large_units();
    large_below();
    large_smallest();
    large_copies();
    shape_free(&disk);
    shape_free(&half);
    shape_free(&ball);
    shape_free(&torus);
    shape_free(&grid);
    shape_free(&small);
    shape_free(&two);
    shape_free(&inert);
}
