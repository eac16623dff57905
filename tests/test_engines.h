/* test_engines.h - the heat engines that factorise: poles in packs (direct), shift-and-invert Lanczos (krylov), many times, and the choice among
 * methods; against dense eigensolutions and against each other */

#ifndef TEST_ENGINES_H
#define TEST_ENGINES_H

static const hd_method eng_methods[2] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV};

static const char *eng_name(hd_method m) {
    static const char *const names[4] = {"auto", "iterative", "direct", "krylov"};
    return names[m];
}

/* ---- plans and shapes ---- */

static hd_heat_opts eng_opts(hd_method method) {
    hd_heat_opts o;
    memset(&o, 0, sizeof o);
    o.method = method;
    return o;
}

static hd_heat *eng_create(const hd_laplacian *lap, const hd_heat_opts *o) {
    hd_heat *heat = NULL;
    hd_error e;
    CHECK_MSG(hd_heat_create(&heat, lap, o, &e) == HD_OK, "%s", e.text);
    return heat;
}

static hd_heat *eng_plan(const hd_laplacian *lap, hd_method method, hd_pole_kind poles, int32_t degree) {
    hd_heat_opts o = eng_opts(method);
    o.poles = poles;
    o.degree = degree;
    return eng_create(lap, &o);
}

/* Triangles between any three of n points in a cube: edges with many faces, slivers, vertices in no face. */
static shape eng_soup(int32_t n, int32_t n_tri, uint64_t seed) {
    shape s = shape_make(n, n_tri);
    int32_t i, v[3];
    for (i = 0; i < n; i++) {
        const double x = dense_signed(&seed), y = dense_signed(&seed);
        shape_put_vertex(&s, i, x, y, dense_signed(&seed));
    }
    for (i = 0; i < n_tri; i++) {
        do {
            int k;
            for (k = 0; k < 3; k++) v[k] = (int32_t)(dense_random(&seed) % (uint64_t)n);
        } while (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]);
        shape_put_triangle(&s, i, v[0], v[1], v[2]);
    }
    return s;
}

/* The shape with vertices that are in no face: the first, the last, and every fifth. */
static shape eng_with_inert(const shape *b) {
    const int32_t n = b->n + b->n / 4 + 2;
    shape s = shape_make(n, b->n_tri);
    int32_t *to = DENSE_NEW(int32_t, b->n), i, k = 0;
    for (i = 0; i < n; i++) {
        if (i % 5 == 0 || k == b->n) {
            shape_put_vertex(&s, i, 9 + i, 8, 7);
            continue;
        }
        memcpy(s.xyz + 3 * i, b->xyz + 3 * k, 3 * sizeof(double));
        to[k++] = i;
    }
    CHECK(k == b->n && to[k - 1] < n - 1);
    for (i = 0; i < 3 * b->n_tri; i++) s.tri[i] = to[b->tri[i]];
    free(to);
    return s;
}

/* A grid graph with heat leaking out everywhere, and masses over three decades: nothing is conserved, B is diagonal. */
static hd_laplacian *eng_leaking(int32_t nx, int32_t ny) {
    const int32_t n = nx * ny;
    int32_t *i = DENSE_NEW(int32_t, 6 * n), *j = DENSE_NEW(int32_t, 6 * n), k;
    double *v = DENSE_NEW(double, 6 * n), *mass = DENSE_NEW(double, n);
    hd_laplacian *lap = NULL;
    hd_csr L, B;
    hd_error e;
    int64_t c = 0;
    for (k = 0; k < n; k++) {
        mass[k] = pow(10, -3.0 * (k % 7) / 6);
        i[c] = j[c] = k; v[c++] = 4.01;
        if (k % nx + 1 < nx) { i[c] = k; j[c] = k + 1; v[c++] = -1; }
        if (k + nx < n) { i[c] = k; j[c] = k + nx; v[c++] = -1; }
    }
    L = test_symmetric_csr(n, c, i, j, v);
    B = test_diagonal_csr(n, mass);
    CHECK_MSG(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK, "%s", e.text);
    CHECK(lap && !lap->conserves);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    free(i);
    free(j);
    free(v);
    free(mass);
    return lap;
}

/* ---- the judge ---- */

/* Is u within the bounds that the report gives, is the heat of every component what it was, and are the bounds worth something? rhs is B f on rows.
 * own: the answer is that of a filter, not of the exponential. alone: the report is about this answer and no other. */
static void eng_judge(const heat_case *c, double t, const hd_rational *own, const double *rhs, const double *u, const hd_report *rep, int alone,
    const char *what) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    double *g = DENSE_NEW(double, n), *want = DENSE_NEW(double, n), *diff = DENSE_NEW(double, n), *f = DENSE_NEW(double, n),
        *heat = DENSE_NEW(double, 3 * n);
    double off_b, size_b, f_b, off, size = 0, slack, gain = 1;
    int32_t i;
    for (i = 0; i < n; i++) {
        g[i] = own ? hd_rational_eval(own, -t * c->pair.lambda[i]) : exp(-t * c->pair.lambda[i]);
        gain = fmax(gain, fabs(g[i]));
    }
    dense_pair_filter(&c->pair, g, rhs, want);
    dense_pair_heat(&c->pair, 0, rhs, f);
    for (i = 0; i < n; i++) {
        diff[i] = u[lap->vertex[i]] - want[i];
        size = fmax(size, fabs(u[lap->vertex[i]]));
    }
    off_b = dense_pair_norm(&c->pair, diff);
    size_b = dense_pair_norm(&c->pair, want);
    f_b = gain * dense_pair_norm(&c->pair, f);
    off = dense_max_abs(diff, n);
    slack = 3e-13 * f_b + 1e-15 * fmin(t * c->top, 1e4) * f_b;    /* of rounding, and of the oracle's eigenvalues */
    if (rep->error_bound_b == HUGE_VAL) CHECK_MSG(off_b <= (alone ? 1e-8 : 1e-7) * f_b, "%s, %s, %s, t %g: no bound, and an error of %g", c->what,
        eng_name(rep->method), what, t, off_b / f_b);
    else CHECK_MSG(off_b <= rep->error_bound_b * size_b + slack, "%s, %s, %s, t %g: error %g, bound %g (B norm)", c->what, eng_name(rep->method),
        what, t,
              off_b / size_b, rep->error_bound_b);
    CHECK_MSG(rep->error_bound == HUGE_VAL || off <= rep->error_bound * size + slack * 2 * sqrt(n / lap->area) + 1e-13 * size,
        "%s, %s, %s, t %g: error %g, bound %g (maximum)", c->what,
              eng_name(rep->method), what, t, off / size, rep->error_bound);
    CHECK(rep->error_bound >= rep->error_rational && rep->error_bound >= rep->error_solver && rep->error_bound >= rep->error_rounding);
    CHECK(rep->evidence_b != HD_EVIDENCE_NONE && rep->evidence_rounding != HD_EVIDENCE_NONE && rep->error_relative == HUGE_VAL);
    if (rep->error_bound_b < HUGE_VAL) {
        const double loose = rep->error_bound_b * size_b / (off_b + 1e-15 * f_b);
        CHECK_MSG(!alone || loose <= 1e6, "%s, %s, %s, t %g: error %g, bound %g", c->what, eng_name(rep->method), what, t, off_b / size_b,
            rep->error_bound_b);
    } else {
        CHECK_MSG(!alone || size_b <= 1e-5 * f_b, "%s, %s, %s, t %g: no bound for an answer of size %g", c->what, eng_name(rep->method), what, t,
            size_b / f_b);
    }
    if (lap->conserves) {
        const double c0 = own ? hd_rational_eval(own, 0) : 1;
        double *out = heat + n, *sum = heat + 2 * n;
        for (i = 0; i < n; i++) {
            heat[lap->component[i]] += c0 * rhs[i];
            out[lap->component[i]] += lap->mass[i] * u[lap->vertex[i]];
            sum[lap->component[i]] += fabs(c0 * rhs[i]) + lap->mass[i] * fabs(u[lap->vertex[i]]);
        }
        for (i = 0; i < lap->n_components; i++)
            CHECK_MSG(fabs(heat[i] - out[i]) <= 1e-12 * sum[i], "%s, %s, %s, t %g: component %d had heat %g and has %g", c->what,
                eng_name(rep->method), what, t,
                      (int)i, heat[i], out[i]);
        CHECK_MSG(rep->mass_drift <= 1e-12, "%s: mass drift %g", c->what, rep->mass_drift);
    }
    free(g);
    free(want);
    free(diff);
    free(f);
    free(heat);
}

/* What every report of a method says. */
static void eng_check_report(const hd_report *rep, hd_method method, const char *what) {
    const int factors = method == HD_METHOD_DIRECT || method == HD_METHOD_KRYLOV;
    CHECK_MSG(rep->method == method && rep->reason && rep->reason[0], "%s: method %s", what, eng_name(rep->method));
    CHECK_MSG(factors == (rep->ordering != HD_ORDERING_AUTO) && factors == (rep->factor_nnz > 0) && factors == (rep->factor_flops > 0),
        "%s, %s: ordering %d, %lld, %g",
              what, eng_name(method), (int)rep->ordering, (long long)rep->factor_nnz, rep->factor_flops);
    CHECK_MSG(rep->growth >= 0 && rep->growth < 5 && (factors || rep->growth == 0), "%s, %s: growth %g", what, eng_name(method), rep->growth);
    if (method == HD_METHOD_DIRECT) {            /* where heat fades, late times come from eigenpairs */
        const int pairs = strstr(rep->reason, "eigenpairs") != NULL;
        CHECK_MSG(rep->solver == HD_SOLVER_AUTO && rep->precond == HD_PRECOND_NONE && rep->iterations == 0 && (rep->poles == HD_POLES_DEFAULT) == pairs,
                  "%s: solver %d, precond %d, %d iterations, poles %d, %s", what, (int)rep->solver, (int)rep->precond, (int)rep->iterations, (int)rep->poles, rep->reason);
        CHECK_MSG((rep->residual > 0) <= (rep->error_rounding > 0) && rep->evidence_solver == (pairs ? HD_EVIDENCE_PROVEN : HD_EVIDENCE_NONE),
                  "%s: residual %g, bound %g", what, rep->residual, rep->error_rounding);
    }
    if (method == HD_METHOD_KRYLOV) {
        CHECK(rep->solver == HD_SOLVER_LANCZOS && rep->precond == HD_PRECOND_NONE && rep->poles == HD_POLES_DEFAULT && rep->degree == 0 &&
            rep->n_poles == 0);
        CHECK(rep->error_rational == 0 && rep->evidence_rational == HD_EVIDENCE_NONE);
    }
}

static int eng_ok(hd_status st, const hd_report *rep, const char *what) {
    CHECK(rep->status == st);
    return CHECK_MSG(st >= 0 && rep->error.status == HD_OK, "%s: %s: %s", what, hd_status_name(st), rep->error.text);
}

/* Columns of both kernels, a rough and a smooth field, one by one and together, and entries. */
static void eng_against_dense(const heat_case *c, hd_heat *heat, hd_method method, double t, const hd_rational *own, const char *what) {
    enum { K = 3 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, m = lap->n_active;
    const int32_t sources[K] = {lap->vertex[m / 3], lap->vertex[0], lap->vertex[m - 1]};
    double *u = DENSE_NEW(double, K * n), *f = DENSE_NEW(double, K * n), *rhs = DENSE_NEW(double, m);
    hd_report rep;
    uint64_t seed = 12;
    int32_t i, q;
    int k, z;
    for (z = 1; z <= K; z += K - 1) {            /* alone, and in a batch */
        for (k = 0; k < 2; k++) {
            const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
            if (!eng_ok(heat_columns(heat, t, kernel, z, sources, u, 0, &rep), &rep, what)) continue;
            eng_check_report(&rep, method, what);
            for (q = 0; q < z; q++) {
                heat_source_rhs(c, sources[q], kernel, rhs);
                eng_judge(c, t, own, rhs, u + q * n, &rep, z == 1, what);
            }
        }
        for (i = 0; i < n; i++) {
            f[i] = dense_signed(&seed);
            f[n + i] = 2 + sin(0.3 * i);
            f[2 * n + i] = i == 7 ? 1 : 0;
        }
        if (!eng_ok(heat_apply(heat, t, z, f, 0, u, 0, &rep), &rep, what)) continue;
        eng_check_report(&rep, method, what);
        for (q = 0; q < z; q++) {
            if (q == 2 && lap->row[7] < 0) continue;
            heat_field_rhs(c, f + q * n, rhs);
            eng_judge(c, t, own, rhs, u + q * n, &rep, z == 1, what);
        }
    }
    for (k = 0; k < 2; k++) {                    /* entries of the same columns, ascending as entries are worked on: the same bits */
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        const int32_t ascending[K] = {sources[1], sources[0], sources[2]};
        int32_t rows[4 * K], cols[4 * K];
        double values[4 * K];
        if (!eng_ok(heat_columns(heat, t, kernel, K, ascending, u, 0, &rep), &rep, what)) continue;
        for (i = 0; i < 4 * K; i++) {
            cols[i] = ascending[(i * 2 + 1) % K];
            rows[i] = lap->vertex[(i * 37) % m];
        }
        if (!eng_ok(heat_entries(heat, t, kernel, 4 * K, rows, cols, values, &rep), &rep, what)) continue;
        eng_check_report(&rep, method, what);
        if (lap->conserves)
            for (i = 0; i < 4 * K; i++) CHECK(values[i] == u[(i * 2 + 1) % K * n + rows[i]]);
        else {                                   /* each call takes poles or eigenpairs, by its own bound */
            double most = 0;
            for (i = 0; i < K * n; i++) most = fmax(most, fabs(u[i]));
            for (i = 0; i < 4 * K; i++) CHECK(fabs(values[i] - u[(i * 2 + 1) % K * n + rows[i]]) <= 2e-7 * most);
        }
    }
    free(u);
    free(f);
    free(rhs);
}

/* Times over six decades, with one plan for all, whose memory is poisoned. */
static void eng_decades(hd_laplacian *lap, const char *what) {
    heat_case c = heat_case_of(lap, what);
    const double unit = lap->kind == HD_LAPLACIAN_COT || lap->h == 0 ? 1 : lap->h * lap->h;
    int k, q;
    for (k = 0; k < 2; k++) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        hd_heat_opts o = eng_opts(eng_methods[k]);
        hd_heat *heat;
        o.context = &ctx;
        heat = eng_create(lap, &o);
        for (q = 0; q < 7; q++) eng_against_dense(&c, heat, eng_methods[k], unit * pow(10, (q * 3) % 7 - 3), NULL, "decades");
        hd_heat_free(heat);
        test_memory_done(&m, &ctx, what);
    }
    heat_case_free(&c);
}

static void eng_dense_cases(void) {
    const double offset[3] = {4, 0, 0};
    shape ball = shape_bumpy(2, 3), torus = shape_torus(14, 9, 2, 0.8), grid = shape_grid(11, 9, 0.35), small = shape_icosphere(1),
        tiny = shape_grid(3, 2, 0.1);
    shape two = shape_disjoint(&small, &grid, offset), three = shape_disjoint(&two, &tiny, offset), soup = eng_soup(90, 200, 5),
        inert = eng_with_inert(&small);
    const shape *const shapes[6] = {&ball, &torus, &grid, &three, &soup, &inert};
    static const char *const names[6] = {"ball", "torus", "grid", "disjoint", "soup", "inert"};
    int q, k;
    for (q = 0; q < 6; q++)
        for (k = 0; k < 3; k++) eng_decades(test_laplacian(shapes[q], op_kinds[k]), names[q]);
    eng_decades(kry_dirichlet(60), "dirichlet");
    eng_decades(eng_leaking(12, 9), "leaking");
    shape_free(&ball);
    shape_free(&torus);
    shape_free(&grid);
    shape_free(&small);
    shape_free(&tiny);
    shape_free(&two);
    shape_free(&three);
    shape_free(&soup);
    shape_free(&inert);
}

/* Meshes that are too large for the oracle: the methods agree, iterations among them, within what they say. */
static void eng_large(void) {
    enum { K = 9 };
    shape ball = kit_own_shape(shape_bumpy(4, 2)), grid = kit_own_shape(shape_grid(60, 45, 0.3));
    int q, k, z;
    for (q = 0; q < 2; q++) {
        const shape *s = q ? &grid : &ball;
        hd_laplacian *lap = test_laplacian(s, op_kinds[q]);
        const int32_t n = s->n;
        const double t = 15 * lap->h * lap->h, times[3] = {t, 30 * t, 5 * t};
        double *F = DENSE_NEW(double, K * n), *want = DENSE_NEW(double, K * n), *u = DENSE_NEW(double, K * n), *all = DENSE_NEW(double, 3 * n);
        hd_heat *oracle = eng_plan(lap, HD_METHOD_ITERATIVE, HD_POLES_DEFAULT, 0);
        hd_report rep, rep2;
        int32_t i;
        for (i = 0; i < K * n; i++) F[i] = sin(0.01 * i) + (i % n == 1100);
        CHECK(heat_apply(oracle, t, K, F, 0, want, 0, &rep2) >= 0);
        for (k = 0; k < 2; k++) {
            hd_heat *heat = eng_plan(lap, eng_methods[k], HD_POLES_DEFAULT, 0);
            for (z = 1; z <= K; z += K - 1) {
                double off;
                if (!eng_ok(heat_apply(heat, t, z, F, 0, u, 0, &rep), &rep, "large")) continue;
                off = dense_max_diff(u, want, z * n) / dense_max_abs(want, n);
                CHECK_MSG(off <= 1e-7 && off <= 2 * (rep.error_bound + rep2.error_bound), "%s, %d fields: off by %g", eng_name(eng_methods[k]), z,
                    off);
            }
            CHECK(eng_ok(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 0, F, all, 0, &rep), &rep, "large"));
            CHECK_MSG(dense_max_diff(all, want, n) <= 1e-7 * dense_max_abs(want, n), "%s, times: off by %g", eng_name(eng_methods[k]),
                dense_max_diff(all, want, n));
            hd_heat_free(heat);
        }
        hd_heat_free(oracle);
        hd_laplacian_free(lap);
        free(F);
        free(want);
        free(u);
        free(all);
    }
}

/* Fronts of hundreds of rows, and batches next to each other: few, then many columns, against single ones and the other method. */
static void eng_batches(void) {
    enum { K = 26 };
    shape s = kit_own_shape(eng_soup(900, 2700, 6));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    hd_heat *direct = eng_plan(lap, HD_METHOD_DIRECT, HD_POLES_DEFAULT, 0), *krylov = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
    const double t = 3 * lap->h * lap->h;
    const int32_t n = s.n;
    double *u = DENSE_NEW(double, K * n), *v = DENSE_NEW(double, K * n), *first = DENSE_NEW(double, K * n);
    int32_t sources[K], q, k;
    hd_report rep, rep2;
    for (q = 0; q < K; q++) sources[q] = lap->vertex[q * 31 % lap->n_active];
    for (k = 8; k <= K; k += 9) {
        CHECK(eng_ok(heat_columns(direct, t, HD_KERNEL_OPERATOR, k, sources, u, 0, &rep), &rep, "batches"));
        CHECK(eng_ok(heat_columns(krylov, t, HD_KERNEL_OPERATOR, k, sources, v, 0, &rep2), &rep2, "batches"));
        if (k == 8) memcpy(first, u, (size_t)(k * n) * sizeof *u);
        CHECK_MSG(memcmp(first, u, (size_t)(8 * n) * sizeof *u) == 0, "%d columns: the first batch is not what it was", (int)k);
        for (q = 0; q < k; q++) {
            const double top = dense_max_abs(v + q * n, n), off = dense_max_diff(u + q * n, v + q * n, n);
            CHECK_MSG(off <= (rep.error_bound + rep2.error_bound) * top, "%d columns: direct and krylov differ by %g in the %d.", (int)k,
                off / top, (int)q);
            if (k != K || q % 5) continue;
            CHECK(heat_column(direct, t, sources[q], v, NULL) >= 0);
            CHECK_MSG(dense_max_diff(u + q * n, v, n) <= 1e-12 * top, "the %d. column differs by %g from one alone", (int)q,
                dense_max_diff(u + q * n, v, n) / top);
        }
    }
    hd_heat_free(direct);
    hd_heat_free(krylov);
    hd_laplacian_free(lap);
    free(u);
    free(v);
    free(first);
}

/* ---- sets of poles ---- */

/* All degrees of both kinds: packs that are full, and such with one, two, three poles or a lone real one left over. */
static void eng_degrees(void) {
    shape s = kit_own_shape(shape_bumpy(1, 9));
    int q, k;
    int32_t r;
    for (q = 0; q < 2; q++) {
        heat_case c = heat_case_of(test_laplacian(&s, op_kinds[q]), "degrees");
        for (k = 0; k < 2; k++) {
            for (r = 1 + k; r <= 14; r++) {
                hd_heat *heat = eng_plan(c.lap, HD_METHOD_DIRECT, k ? HD_POLES_KERNEL : HD_POLES_UNIFORM, r);
                double *u = DENSE_NEW(double, s.n);
                char what[40];
                hd_report rep;
                snprintf(what, sizeof what, "%s %d", k ? "kernel" : "uniform", (int)r);
                CHECK(heat_column(heat, 3 * c.lap->h * c.lap->h, 5, u, &rep) >= 0);
                CHECK_MSG(rep.degree == r && rep.n_poles == (r + 1) / 2 && rep.poles == (k ? HD_POLES_KERNEL : HD_POLES_UNIFORM), "%s", what);
                CHECK_MSG(rep.residual < 1e-12, "%s: residual %g", what, rep.residual);
                eng_against_dense(&c, heat, HD_METHOD_DIRECT, 3 * c.lap->h * c.lap->h, NULL, what);
                eng_against_dense(&c, heat, HD_METHOD_DIRECT, 300 * c.lap->h * c.lap->h, NULL, what);
                free(u);
                hd_heat_free(heat);
            }
        }
        heat_case_free(&c);
    }
}

enum { ENG_SETS = 12 };

/* A set of n poles; those whose bit in real is set are real. No two are the same, and none is near the negative axis. */
static hd_rational eng_set(int32_t n, uint32_t real, double a0, uint64_t seed) {
    hd_rational set;
    int32_t i;
    memset(&set, 0, sizeof set);
    set.n_poles = n;
    set.a0 = a0;
    for (i = 0; i < n; i++) {
        const int is_real = (int)(real >> i & 1);
        set.theta[i] = test_c(is_real ? 0.5 + 3.5 * fabs(dense_signed(&seed)) + 0.3 * i : 6 * dense_signed(&seed),
            is_real ? 0 : 1 + 8 * fabs(dense_signed(&seed)));
        set.a[i] = test_c(3 * dense_signed(&seed), is_real ? 0 : 3 * dense_signed(&seed));
        set.degree += is_real ? 1 : 2;
    }
    return set;
}

static hd_rational eng_own_set(int which, const char **what) {
    static const char *const names[ENG_SETS] = {"one real", "three real", "five real", "a real one and four", "a real one and eight",
        "four and a real one", "a real one and three",
                                                "nine pairs", "two real and three", "no poles", "all 32", "a real one and twenty-eight"};
    *what = names[which];
    switch (which) {
        case 0: return eng_set(1, 1, 0, 3);
        case 1: return eng_set(3, 7, 0.5, 4);
        case 2: return eng_set(5, 31, -0.2, 5);
        case 3: return eng_set(5, 1, 0.25, 6);
        case 4: return eng_set(9, 1, 0, 7);
        case 5: return eng_set(5, 1u << 4, 0.1, 8);
        case 6: return eng_set(4, 1, 0, 9);
        case 7: return eng_set(9, 0, 1, 10);
        case 8: return eng_set(5, 3, 0, 11);
        case 9: return eng_set(0, 0, 0.75, 12);
        case 10: return eng_set(32, 0x00010101u, 0.3, 13);
        default: return eng_set(29, 1, 0, 14);
    }
}

static void eng_own_sets(void) {
    const double offset[3] = {4, 0, 0};
    shape a = kit_own_shape(shape_grid(6, 6, 0.3)), b = kit_own_shape(shape_icosphere(1)), s = kit_own_shape(shape_disjoint(&a, &b, offset));
    int q, k, z;
    for (q = 0; q < 3; q++) {
        heat_case c = q < 2 ? heat_case_of(test_laplacian(&s, op_kinds[q]), "own, mesh") : heat_case_of(kry_dirichlet(40), "own, dirichlet");
        const double unit = q < 2 ? c.lap->h * c.lap->h : 1;
        for (k = 0; k < ENG_SETS; k++) {
            const char *what;
            hd_rational set = eng_own_set(k, &what), kept = set;
            hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
            double *u = DENSE_NEW(double, c.lap->n);
            hd_report rep;
            hd_heat *heat;
            o.rational = &set;
            heat = eng_create(c.lap, &o);
            memset(&set, 0x55, sizeof set);      /* it was copied */
            for (z = 0; z < 3; z++) {
                const double t = unit * pow(30, z);
                if (!eng_ok(heat_column(heat, t, 3, u, &rep), &rep, what)) continue;
                CHECK(rep.poles == HD_POLES_OWN && rep.n_poles == kept.n_poles && rep.degree == kept.degree && rep.error_rational == 0);
                CHECK_MSG(rep.mass_drift == 0 && rep.method == HD_METHOD_DIRECT, "%s: drift %g", what, rep.mass_drift);
                if (kept.n_poles) eng_against_dense(&c, heat, HD_METHOD_DIRECT, t, &kept, what);
            }
            free(u);
            hd_heat_free(heat);
        }
        heat_case_free(&c);
    }
}

/* ---- many right-hand sides ---- */

/* Any number of columns and fields, with repeats and sources without mass, padded columns; in place; in one call or one by one. */
static void eng_counts_of(const heat_case *c, hd_method method) {
    enum { MOST = 30, PAD = 3 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, ld = n + PAD, source_step = 7;
    const double t = 6 * lap->h * lap->h;
    double *U = DENSE_NEW(double, MOST * ld), *F = DENSE_NEW(double, MOST * ld), *u = DENSE_NEW(double, n), *rhs = DENSE_NEW(double, n);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_heat_opts o = eng_opts(method);
    hd_heat *heat;
    hd_report rep;
    uint64_t seed = 5;
    int32_t sources[MOST], k, q, i;
    o.context = &ctx;
    heat = eng_create(lap, &o);
    for (q = 0; q < MOST; q++) sources[q] = q % 4 == 3 ? sources[q - 2] : q * source_step % n;
    for (i = 0; i < MOST * ld; i++) F[i] = dense_signed(&seed);
    for (k = 1; k <= MOST; k++) {
        const hd_kernel kernel = k % 2 ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        double size = 0;
        for (i = 0; i < MOST * ld; i++) U[i] = 1234;
        if (!eng_ok(heat_columns(heat, t, kernel, k, sources, U, (size_t)ld, &rep), &rep, "counts")) continue;
        for (q = 0; q < k; q++) {
            const double *column = U + q * ld;
            if (lap->row[sources[q]] < 0) {
                for (i = 0; i < n; i++) CHECK(column[i] == (kernel == HD_KERNEL_OPERATOR && i == sources[q]));
            } else {
                heat_source_rhs(c, sources[q], kernel, rhs);
                eng_judge(c, t, NULL, rhs, column, &rep, k == 1, "counts");
                for (i = 0; i < n; i++) CHECK(lap->row[i] >= 0 || column[i] == 0);
            }
            for (i = n; i < ld; i++) CHECK(column[i] == 1234);
        }
        for (i = k * ld; i < MOST * ld; i++) CHECK(U[i] == 1234);
        q = k - 1;
        CHECK(heat_columns(heat, t, kernel, 1, sources + q, u, 0, NULL) >= 0);
        size = dense_max_abs(u, n);
        CHECK_MSG(dense_max_diff(u, U + q * ld, n) <= (method == HD_METHOD_DIRECT ? 1e-12 : 1e-8) * size,
            "%s: the last of %d columns differs by %g from a call of its own",
                  eng_name(method), (int)k, dense_max_diff(u, U + q * ld, n) / size);
        if (k % 5 > 1) continue;
        memcpy(U, F, (size_t)(MOST * ld) * sizeof *U);
        CHECK(heat_apply(heat, t, k, U, (size_t)ld, U, (size_t)ld, &rep) >= 0);
        for (q = 0; q < k; q++) {
            for (i = 0; i < n; i++) CHECK(lap->row[i] >= 0 || U[q * ld + i] == F[q * ld + i]);
            CHECK(memcmp(U + q * ld + n, F + q * ld + n, PAD * sizeof *U) == 0);
            heat_field_rhs(c, F + q * ld, rhs);
            eng_judge(c, t, NULL, rhs, U + q * ld, &rep, k == 1, "in place");
        }
    }
    memset(&rep, 0x77, sizeof rep);
    CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, 0, NULL, NULL, 0, &rep) == HD_OK && rep.status == HD_OK && rep.error.status == HD_OK &&
        rep.iterations == 0);
    CHECK(heat_apply(heat, t, 0, NULL, 0, NULL, 0, &rep) == HD_OK && rep.status == HD_OK);
    CHECK(heat_entries(heat, t, HD_KERNEL_SYMMETRIC, 0, NULL, NULL, NULL, &rep) == HD_OK && rep.status == HD_OK);
    hd_heat_free(heat);
    test_memory_done(&m, &ctx, "counts");
    free(U);
    free(F);
    free(u);
    free(rhs);
}

/* Sources that are all without mass, and fields of nothing but zeros or constants. */
static void eng_nothing_to_do(const hd_laplacian *lap, hd_method method) {
    const int32_t n = lap->n, inert[3] = {0, 5, 0};
    hd_heat *heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
    const double t = lap->h * lap->h;
    double *u = DENSE_NEW(double, 9 * n), *f = DENSE_NEW(double, 9 * n);
    hd_report rep;
    int32_t i, k;
    CHECK(n > 25 && lap->row[0] < 0 && lap->row[5] < 0);
    for (k = 1; k <= 3; k++) {
        CHECK(eng_ok(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, inert, u, 0, &rep), &rep, "inert"));
        for (i = 0; i < k * n; i++) CHECK(u[i] == (i % n == inert[i / n]));
        CHECK(rep.error_bound == 0 && rep.error_bound_b == 0 && rep.residual == 0 && rep.iterations == 0);
        for (i = 0; i < 9 * n; i++) f[i] = i / n == 1 ? -3.25 : 0;
        for (i = 0; i < 9 * n; i++) u[i] = 77;
        CHECK(eng_ok(heat_apply(heat, t, k * k, f, 0, u, 0, &rep), &rep, "nothing"));
        CHECK_MSG(dense_max_diff(u, f, k * k * n) <= 1e-13 * 4, "%s: nothing moves by %g", eng_name(method), dense_max_diff(u, f, k * k * n));
        for (i = 0; i < k * k * n; i++) CHECK(i / n == 1 || u[i] == 0);
    }
    free(u);
    free(f);
    hd_heat_free(heat);
}

static void eng_counts(void) {
    shape ball = kit_own_shape(shape_icosphere(1)), inert = kit_own_shape(eng_with_inert(&ball)), grid = kit_own_shape(shape_grid(8, 5, 0.3));
    int k;
    for (k = 0; k < 2; k++) {
        heat_case c = heat_case_of(test_laplacian(&inert, HD_LAPLACIAN_FEM), "counts, inert");
        eng_counts_of(&c, eng_methods[k]);
        eng_nothing_to_do(c.lap, eng_methods[k]);
        heat_case_free(&c);
        c = heat_case_of(test_laplacian(&grid, HD_LAPLACIAN_VORONOI_COT), "counts, grid");
        eng_counts_of(&c, eng_methods[k]);
        heat_case_free(&c);
    }
}

/* ---- plans used again ---- */

typedef struct eng_call { double t; int32_t k; int task; } eng_call;    /* task 0, 1: columns of the kernels, 2: fields, 3: entries, 4: times */

static hd_status eng_do(hd_heat *heat, const hd_laplacian *lap, const eng_call *call, double *u, hd_report *rep) {
    const int32_t n = lap->n;
    double *f = DENSE_NEW(double, call->k * n), times[3];
    int32_t *sources = DENSE_NEW(int32_t, call->k), i;
    hd_status st;
    for (i = 0; i < call->k; i++) sources[i] = lap->vertex[i * 5 % lap->n_active];
    for (i = 0; i < call->k * n; i++) f[i] = sin(i);
    for (i = 0; i < 3; i++) times[i] = call->t * (1 + i);
    if (call->task == 2) st = heat_apply(heat, call->t, call->k, f, 0, u, 0, rep);
    else if (call->task == 3) st = heat_entries(heat, call->t, HD_KERNEL_OPERATOR, call->k, sources, sources, u, rep);
    else if (call->task == 4) st = heat_times(heat, 3, times, HD_KERNEL_SYMMETRIC, sources[0], NULL, u, 0, rep);
    else st = heat_columns(heat, call->t, call->task ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, call->k, sources, u, 0, rep);
    free(f);
    free(sources);
    return st;
}

/* One plan for calls of all sorts: what it remembers does not show. */
static void eng_reuse_of(const hd_laplacian *lap, hd_heat_opts *o, const char *what) {
    static const eng_call calls[16] = {{3, 1, 0}, {3, 1, 0}, {3, 7, 0}, {3, 1, 2}, {3, 1, 1}, {50, 1, 2}, {50, 13, 2}, {3, 5, 3}, {0, 2, 2},
        {2, 1, 0}, {3, 2, 1}, {0, 2, 1},
                                       {1e3, 1, 0}, {3, 1, 4}, {3, 1, 0}, {70, 25, 0}};
    const size_t size = (size_t)(25 * lap->n) * sizeof(double);
    double *u = DENSE_NEW(double, 25 * lap->n), *want = DENSE_NEW(double, 25 * lap->n);
    test_memory m, m2;
    hd_context ctx = test_memory_context(&m), ctx2 = test_memory_context(&m2);
    hd_heat *heat;
    hd_report rep, rep2;
    int k, way;
    for (way = 0; way < 2; way++) {
        o->context = &ctx;
        heat = eng_create(lap, o);
        for (k = 0; k < 16; k++) {
            eng_call call = calls[way ? 15 - k : k];
            hd_heat *fresh;
            call.t *= lap->h * lap->h;
            memset(u, 0, size);
            memset(want, 0, size);
            o->context = &ctx2;
            fresh = eng_create(lap, o);
            if (eng_ok(eng_do(heat, lap, &call, u, &rep), &rep, what) && eng_ok(eng_do(fresh, lap, &call, want, &rep2), &rep2, what)) {
                const double top = dense_max_abs(want, 25 * lap->n), off = dense_max_diff(u, want, 25 * lap->n);
                if (rep.method == rep2.method) CHECK_MSG(off == 0,
                    "%s: call %d: the plan answers otherwise, by %g", what, k, off / top);
                else CHECK_MSG(off <= (rep.error_bound + rep2.error_bound + 1e-13) * top, "%s: call %d: the plan answers otherwise, by %g", what,
                    k, off / top);
                CHECK_MSG(o->method != HD_METHOD_DIRECT || (rep.error_bound == rep2.error_bound && rep.residual == rep2.residual &&
                    rep.growth == rep2.growth &&
                          rep.factor_flops == rep2.factor_flops), "%s: call %d: another report", what, k);
            }
            hd_heat_free(fresh);
        }
        hd_heat_free(heat);
    }
    test_memory_done(&m, &ctx, what);
    test_memory_done(&m2, &ctx2, what);
    free(u);
    free(want);
}

static void eng_reuse(void) {
    shape s = kit_own_shape(shape_bumpy(2, 8));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
    const char *what;
    hd_rational set = eng_own_set(3, &what);
    eng_reuse_of(lap, &o, "direct");
    o.degree = 11;
    eng_reuse_of(lap, &o, "direct 11");
    o.degree = 0;
    o.rational = &set;
    eng_reuse_of(lap, &o, what);
    o = eng_opts(HD_METHOD_KRYLOV);
    eng_reuse_of(lap, &o, "krylov");
    o = eng_opts(HD_METHOD_AUTO);
    eng_reuse_of(lap, &o, "auto");
    hd_laplacian_free(lap);
}

/* A plan that goes from poles to shift-and-invert Lanczos and back: the same answers every time. */
static void eng_switch(void) {
    enum { K = 40, TIMES = 40 };
    shape s = kit_own_shape(shape_bumpy(3, 7));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_heat *heat = eng_create(lap, &o);
    double *first = DENSE_NEW(double, (K + TIMES) * s.n), *u = DENSE_NEW(double, (K + TIMES) * s.n), times[TIMES];
    int32_t sources[K], i;
    int round;
    for (i = 0; i < K; i++) sources[i] = i * 11;
    for (i = 0; i < TIMES; i++) times[i] = (1 + i) * lap->h * lap->h;
    for (round = 0; round < 3; round++) {
        double *out = round ? u : first;
        hd_report rep, rep2;
        CHECK(eng_ok(heat_columns(heat, times[TIMES - 1], HD_KERNEL_OPERATOR, K, sources, out, 0, &rep), &rep, "switch"));
        CHECK(eng_ok(heat_times(heat, TIMES, times, HD_KERNEL_OPERATOR, sources[5], NULL, out + K * s.n, 0, &rep2), &rep2, "switch"));
        CHECK_MSG(rep.method == HD_METHOD_DIRECT && rep.n_poles % 4 == 1 && rep2.method == HD_METHOD_KRYLOV, "%s with %d poles, %s",
            eng_name(rep.method), (int)rep.n_poles,
                  eng_name(rep2.method));
        CHECK(dense_max_diff(out + 5 * s.n, out + (K + TIMES - 1) * s.n, s.n) <=
            (rep.error_bound + rep2.error_bound) * dense_max_abs(out + 5 * s.n, s.n));
        if (round) CHECK_MSG(memcmp(first, u, (size_t)(K + TIMES) * (size_t)s.n * sizeof *u) == 0, "round %d: other answers", round);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(first);
    free(u);
}

/* ---- many times ---- */

static void eng_times_of(const heat_case *c, hd_heat_opts *o, const double *times, int32_t n_times, const char *what) {
    enum { PAD = 2 };
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, ld = n + PAD, source = lap->vertex[lap->n_active / 2];
    double *U = DENSE_NEW(double, (n_times + 1) * ld), *u = DENSE_NEW(double, n), *f = DENSE_NEW(double, n), *rhs = DENSE_NEW(double, lap->n_active);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_heat *heat;
    uint64_t seed = 3;
    int32_t i, q;
    int k;
    o->context = &ctx;
    heat = eng_create(lap, o);
    for (i = 0; i < n; i++) f[i] = 0.4 + dense_signed(&seed);
    for (k = 0; k < 3; k++) {
        const hd_kernel kernel = k == 1 ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        hd_report rep, one;
        for (i = 0; i < (n_times + 1) * ld; i++) U[i] = 4321;
        memset(&rep, 0x77, sizeof rep);
        if (!eng_ok(heat_times(heat, n_times, times, kernel, source, k == 2 ? f : NULL, U, (size_t)ld, &rep), &rep, what)) continue;
        CHECK_MSG(n_times == 0 || o->method == HD_METHOD_AUTO || rep.method == o->method, "%s: %s", what, eng_name(rep.method));
        CHECK(n_times == 0 || (rep.reason && rep.reason[0]));
        for (q = 0; q < n_times; q++) {
            const double *column = U + q * ld;
            if (k == 2) heat_field_rhs(c, f, rhs);
            else heat_source_rhs(c, source, kernel, rhs);
            if (times[q] > 0) eng_judge(c, times[q], NULL, rhs, column, &rep, n_times == 1, what);
            if (k == 2) CHECK(eng_ok(heat_apply(heat, times[q], 1, f, 0, u, 0, &one), &one, what));
            else CHECK(eng_ok(heat_columns(heat, times[q], kernel, 1, &source, u, 0, &one), &one, what));
            CHECK_MSG(dense_max_diff(u, column, n) <= (rep.error_bound + one.error_bound + 1e-13) * dense_max_abs(u, n),
                "%s: time %g: off by %g from a call of its own", what, times[q],
                      dense_max_diff(u, column, n) / dense_max_abs(u, n));
            if (times[q] == 0) CHECK(memcmp(u, column, (size_t)n * sizeof *u) == 0);
            for (i = 0; i < n; i++) CHECK(lap->row[i] >= 0 || column[i] == (k == 2 ? f[i] : 0));
            for (i = n; i < ld; i++) CHECK(column[i] == 4321);
            /* the same time twice */
            for (i = 0; i < q; i++) CHECK(times[i] != times[q] || memcmp(U + i * ld, column, (size_t)n * sizeof *U) == 0);
        }
        for (i = n_times * ld; i < (n_times + 1) * ld; i++) CHECK(U[i] == 4321);
    }
    hd_heat_free(heat);
    test_memory_done(&m, &ctx, what);
    free(U);
    free(u);
    free(f);
    free(rhs);
}

static void eng_no_times(const hd_laplacian *lap, const hd_heat_opts *o) {
    hd_heat_opts own = *o;
    hd_heat *heat;
    hd_report rep;
    double u = 7;
    own.context = NULL;                          /* that of the last call is gone */
    heat = eng_create(lap, &own);
    CHECK(heat_times(heat, 0, NULL, HD_KERNEL_OPERATOR, lap->vertex[0], NULL, &u, 0, &rep) == HD_ERR_ARGUMENT && u == 7);
    hd_heat_free(heat);
}

static void eng_times(void) {
    static const double unsorted[7] = {5, 0.5, 80, 5, 20, 0.5, 11}, with_zero[5] = {3, 0, 40, -0.0, 1}, single[1] = {7}, zeros[2] = {0, 0},
        equal[3] = {4, 4, 4};
    static const hd_method methods[4] = {HD_METHOD_AUTO, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT, HD_METHOD_KRYLOV};
    shape ball = kit_own_shape(shape_icosphere(1)), s = kit_own_shape(eng_with_inert(&ball));
    int q, k, z, i;
    for (q = 0; q < 3; q++) {
        heat_case c = q < 2 ? heat_case_of(test_laplacian(&s, op_kinds[q]), q ? "times voronoi" : "times fem") : heat_case_of(eng_leaking(8, 7),
            "times leaking");
        const double unit = q < 2 ? c.lap->h * c.lap->h : 0.02;
        double times[40];
        for (k = 0; k < 4; k++) {
            hd_heat_opts o = eng_opts(methods[k]);
            if (methods[k] == HD_METHOD_ITERATIVE && q == 0) continue;
            for (i = 0; i < 7; i++) times[i] = unit * unsorted[i];
            eng_times_of(&c, &o, times, 7, "unsorted");
            for (i = 0; i < 5; i++) times[i] = unit * with_zero[i];
            eng_times_of(&c, &o, times, 5, "with zeros");
            eng_times_of(&c, &o, zeros, 2, "zeros");
            eng_times_of(&c, &o, single, 1, "one");
            eng_times_of(&c, &o, equal, 3, "equal");
            eng_no_times(c.lap, &o);
            for (z = 0; z <= 6; z++) {           /* spans of 1 to 1e6, in an order that is neither */
                const int n_times = 1 + 3 * z;
                for (i = 0; i < n_times; i++) times[i] = unit * 1e-2 * pow(10, z * ((i * 5) % n_times) / fmax(n_times - 1, 1));
                eng_times_of(&c, &o, times, n_times, z < 3 ? "span" : "long span");
            }
        }
        heat_case_free(&c);
    }
}

/* Columns of two batches at times over five decades, one source without mass among them, against calls for one column
 * and one time, which begin with the field. */
static void eng_times_columns_of(const hd_laplacian *lap, double unit, const char *what) {
    enum { COLUMNS = 10, TIMES = 16 };
    hd_heat *heat = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
    const int32_t n = lap->n;
    double times[TIMES], *U = DENSE_NEW(double, COLUMNS * TIMES * n), *u = DENSE_NEW(double, n);
    int32_t sources[COLUMNS], c, q;
    hd_report rep, one;
    for (c = 0; c < COLUMNS; c++) sources[c] = (3 + 7 * c) % n;
    for (q = 0; q < TIMES; q++) times[q] = unit * 0.1 * pow(1e5, q / (TIMES - 1.0));
    if (eng_ok(hd_heat_columns(heat, HD_KERNEL_OPERATOR, TIMES, times, COLUMNS, sources, U, 0, &rep, NULL), &rep, what)) {
        for (c = 0; c < COLUMNS; c++) {
            for (q = 0; q < TIMES; q += 3) {
                const double *column = U + (c * TIMES + q) * n;
                CHECK(eng_ok(heat_columns(heat, times[q], HD_KERNEL_OPERATOR, 1, sources + c, u, 0, &one), &one, what));
                CHECK_MSG(dense_max_diff(u, column, n) <= (rep.error_bound + one.error_bound + 1e-13) * dense_max_abs(u, n),
                    "%s: column %d, time %g: off by %g from a call of its own", what, (int)c, times[q],
                          dense_max_diff(u, column, n) / dense_max_abs(u, n));
            }
        }
    }
    hd_heat_free(heat);
    free(U);
    free(u);
}

static void eng_times_columns(void) {
    shape ball = kit_own_shape(shape_icosphere(2)), s = kit_own_shape(eng_with_inert(&ball));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    eng_times_columns_of(lap, lap->h * lap->h, "columns and times");
    hd_laplacian_free(lap);
    lap = eng_leaking(12, 9);
    eng_times_columns_of(lap, 0.02, "columns and times, leaking");
    hd_laplacian_free(lap);
}

/* A source without mass at many times. */
static void eng_times_inert(void) {
    shape ball = kit_own_shape(shape_icosphere(0)), s = kit_own_shape(eng_with_inert(&ball));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double times[3] = {0.3, 0.1, 0.2};
    double *u = DENSE_NEW(double, 3 * s.n);
    int k, z;
    int32_t i;
    CHECK(lap->row[5] < 0);
    for (z = 0; z < 2; z++) {
        for (k = 0; k < 2; k++) {
            hd_heat *heat = eng_plan(lap, eng_methods[z], HD_POLES_DEFAULT, 0);
            hd_report rep;
            CHECK(eng_ok(heat_times(heat, 3, times, k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, 5, NULL, u, 0, &rep), &rep, "inert"));
            for (i = 0; i < 3 * s.n; i++) CHECK(u[i] == (k == 0 && i % s.n == 5));
            CHECK(rep.error_bound == 0 && rep.iterations == 0);
            hd_heat_free(heat);
        }
    }
    free(u);
    hd_laplacian_free(lap);
}

/* ---- threads and instructions ---- */

/* What a plan answers in one way of threading: a column, columns of several batches, fields, times; all into out. */
static int64_t eng_thread_run(const shape *s, hd_laplacian_kind kind, hd_heat_opts o, hd_simd simd, int way, double *out, hd_report *rep) {
    static const int32_t counts[3] = {1, 6, 15};
    ldl_way *w = DENSE_NEW(ldl_way, 1);
    const int32_t n = s->n;
    double *f = DENSE_NEW(double, 15 * n), times[3];
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    hd_heat *heat;
    int32_t sources[15], i;
    int64_t calls;
    int k;
    ldl_way_begin(w, way, simd);
    memset(&lo, 0, sizeof lo);
    lo.kind = kind;
    lo.context = &w->ctx;
    CHECK(hd_laplacian_triangles(&lap, s->xyz, n, s->tri, s->n_tri, &lo, NULL) == HD_OK);
    heat = eng_create(lap, &o);
    for (i = 0; i < 15; i++) sources[i] = lap->vertex[i * 31 % lap->n_active];
    for (i = 0; i < 15 * n; i++) f[i] = sin(i % n) + i / n;
    for (i = 0; i < 3; i++) times[i] = (3 + 9 * i) * lap->h * lap->h;
    for (k = 0; k < 3; k++, out += 15 * n) CHECK(heat_columns(heat, times[0], HD_KERNEL_SYMMETRIC, counts[k], sources, out, 0, rep + k) >= 0);
    CHECK(heat_apply(heat, times[0], 15, f, 0, out, 0, rep + 3) >= 0);
    CHECK(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, sources[0], NULL, out + 15 * n, 0, rep + 4) >= 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    ldl_way_end(w, way);
    calls = w->calls;
#ifdef LDL_THREADS
    calls += w->pool.loops;
#endif
    free(w);
    free(f);
    return calls;
}

static int eng_same_report(const hd_report *a, const hd_report *b) {
    return a->method == b->method && a->solver == b->solver && a->iterations == b->iterations && a->degree == b->degree && a->n_poles == b->n_poles &&
           a->residual == b->residual && a->error_bound == b->error_bound && a->error_bound_b == b->error_bound_b && a->growth == b->growth &&
           a->factor_nnz == b->factor_nnz && a->factor_flops == b->factor_flops && a->mass_drift == b->mass_drift && a->ordering == b->ordering;
}

static void eng_threads_of(const shape *s, hd_laplacian_kind kind, hd_heat_opts o, const char *what) {
    const int64_t size = 75 * (int64_t)s->n;
    double *top = DENSE_NEW(double, size), *first = DENSE_NEW(double, size), *other = DENSE_NEW(double, size);
    const double limit = o.method == HD_METHOD_KRYLOV ? 1e-10 : 1e-12;   /* krylov may stop a step later: its tolerance is 1e-9 */
    hd_report rep[5], rep2[5];
    int64_t calls = 0, part;
    int level, way, k;
    for (level = 0; level < 4; level++) {
        eng_thread_run(s, kind, o, ldl_simds[level], 0, first, rep);
        if (level == 0) memcpy(top, first, (size_t)size * sizeof *top);
        for (part = 0; part < size; part += s->n) {
            const double most = dense_max_abs(top + part, s->n), off = dense_max_diff(first + part, top + part, s->n);
            CHECK_MSG(off <= limit * most, "%s: level %d is off by %g in column %lld", what, level, off / most, (long long)(part / s->n));
        }
        for (way = 1; way < LDL_WAYS; way++) {
            if (way < 4 && level > 0) continue;
            calls += eng_thread_run(s, kind, o, ldl_simds[level], way, other, rep2);
            CHECK_MSG(memcmp(first, other, (size_t)size * sizeof *first) == 0, "%s: way %d of threading gives other bits, level %d", what, way,
                level);
            for (k = 0; k < 5; k++) CHECK_MSG(eng_same_report(rep + k, rep2 + k), "%s: way %d of threading: another report, level %d", what, way,
                level);
        }
    }
    CHECK_MSG(calls > 0, "%s: never in parallel", what);
    free(top);
    free(first);
    free(other);
}

static void eng_threads(void) {
    shape ball = kit_own_shape(shape_bumpy(3, 6)), soup = kit_own_shape(eng_soup(600, 1200, 4));
    eng_threads_of(&ball, HD_LAPLACIAN_FEM, eng_opts(HD_METHOD_DIRECT), "direct");
    eng_threads_of(&ball, HD_LAPLACIAN_VORONOI_COT, eng_opts(HD_METHOD_KRYLOV), "krylov");
    eng_threads_of(&soup, HD_LAPLACIAN_VORONOI_COT, eng_opts(HD_METHOD_DIRECT), "direct, soup");
    eng_threads_of(&soup, HD_LAPLACIAN_FEM, eng_opts(HD_METHOD_KRYLOV), "krylov, soup");
}

/* ---- far from the times that matter ---- */

/* Before anything has moved, and long after everything has: the field itself, and the means of the components. */
static void eng_extreme_times(void) {
    const double offset[3] = {4, 0, 0};
    shape a = kit_own_shape(shape_icosphere(1)), b = kit_own_shape(shape_grid(5, 4, 0.2)), s = kit_own_shape(shape_disjoint(&a, &b, offset));
    int q, k, z;
    for (q = 0; q < 2; q++) {
        hd_laplacian *lap = test_laplacian(&s, op_kinds[q]);
        double *f = DENSE_NEW(double, s.n), *u = DENSE_NEW(double, s.n), mean[2];
        int32_t i, c;
        for (i = 0; i < s.n; i++) f[i] = 1.5 + sin(i);
        for (c = 0; c < 2; c++) {
            double sum = 0;
            for (i = 0; i < s.n; i++) sum += lap->component[i] == c ? lap->mass[i] * f[i] : 0;
            mean[c] = sum / lap->component_mass[c];
        }
        for (k = 0; k < 2; k++) {
            hd_heat *heat = eng_plan(lap, eng_methods[k], HD_POLES_DEFAULT, 0);
            for (z = 0; z < 12; z++) {
                static const double times[12] = {1e-300, 1e-100, 1e-30, 1e-18, 1e-320, 1e-25, 1e3, 1e4, 1e5, 1e6, 1e9, 1e12};
                double off = 0;
                hd_report rep;
                if (!eng_ok(heat_apply(heat, times[z], 1, f, 0, u, 0, &rep), &rep, "extreme")) continue;
                for (i = 0; i < s.n; i++) off = fmax(off, fabs(u[i] - (times[z] < 1 ? f[i] : mean[lap->component[i]])));
                CHECK_MSG(off <= (z < 6 ? 3e-9 : 1e-8), "%s, t %g: off by %g", eng_name(eng_methods[k]), times[z], off);
                CHECK(rep.mass_drift < 1e-12);
            }
            hd_heat_free(heat);
        }
        free(f);
        free(u);
        hd_laplacian_free(lap);
    }
}

/* ---- what reports and progress tell ---- */

/* A tolerance that rounding does not allow is told, by one call and by many times whichever comes first. */
static void eng_warnings(void) {
    static const double when[2][2] = {{1e-3, 1e4}, {1e4, 1e-3}};
    shape s = kit_own_shape(shape_icosphere(1));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    double *u = DENSE_NEW(double, 2 * s.n), times[2], rest;
    int k, q, z, tol, seen[2] = {0, 0};
    for (k = 0; k < 2; k++) {
        for (tol = 9; tol <= 17; tol++) {
            for (z = 0; z < 2; z++) {
                hd_heat_opts o = eng_opts(eng_methods[k]);
                hd_status st, worst = HD_OK;
                hd_heat *heat;
                hd_report rep;
                o.tol = pow(10, -tol);
                heat = eng_create(lap, &o);
                for (q = 0; q < 2; q++) {
                    times[q] = when[z][q] * lap->h * lap->h;
                    st = heat_column(heat, times[q], 7, u, &rep);
                    CHECK(st == rep.status && (st == HD_OK || st == HD_WARN_ACCURACY));
                    rest = rep.error_bound > 0 ? rep.error_bound_b * (1 - rep.error_rational / rep.error_bound) : 0;
                    CHECK_MSG(st == HD_OK ? rest <= 2.5 * o.tol : rest > 0.1 * o.tol, "%s, tolerance %g: bound %g, but %s", eng_name(eng_methods[k]),
                        o.tol,
                        rest, hd_status_name(st));
                    if (st > worst) worst = st;
                    seen[st == HD_OK] |= 1 << k;
                }
                if (k == 0) CHECK(heat_times(heat, 2, times, HD_KERNEL_OPERATOR, 7, NULL, u, 0, &rep) == worst && rep.status == worst);
                hd_heat_free(heat);
            }
        }
    }
    CHECK_MSG((seen[0] & 1) && seen[1] == 3, "no warnings %d, nothing but warnings %d", seen[0], seen[1]);
    free(u);
    hd_laplacian_free(lap);
}

/* The degree that one of the fields needs serves all; the time that failed is told. */
static void eng_told(void) {
    shape s = kit_own_shape(shape_icosphere(1));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    const double t = lap->h * lap->h, times[3] = {1e-9 * t, 500 * t, 1e-8 * t};
    const int32_t n = s.n;
    double *F = DENSE_NEW(double, 2 * n), *u = DENSE_NEW(double, 3 * n), mean = 0;
    hd_heat_opts o = eng_opts(HD_METHOD_ITERATIVE);
    hd_heat *heat;
    hd_report rep, one[2];
    int32_t i;
    int q, k;
    for (i = 0; i < n; i++) mean += lap->mass[i] * sin(i);
    for (i = 0; i < n; i++) {
        F[i] = 100;
        F[n + i] = sin(i) - mean / lap->area;
    }
    o.solver = HD_SOLVER_COCG;
    heat = eng_create(lap, &o);
    for (q = 0; q < 2; q++) CHECK(heat_apply(heat, t, 1, F + q * n, 0, u, 0, one + q) >= 0);
    CHECK_MSG(one[0].degree < one[1].degree, "degrees %d, %d", (int)one[0].degree, (int)one[1].degree);
    CHECK(heat_apply(heat, t, 2, F, 0, u, 0, &rep) >= 0 && rep.degree == one[1].degree);
    hd_heat_free(heat);
    o.precond = HD_PRECOND_JACOBI;
    o.max_iterations = 4;
    heat = eng_create(lap, &o);
    CHECK(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 3, NULL, u, 0, &rep) == HD_ERR_NOT_CONVERGED && rep.status == rep.error.status);
    CHECK_MSG(rep.error.column == 1, "time %lld failed", (long long)rep.error.column);
    hd_heat_free(heat);
    for (k = 0; k < 2; k++) {                    /* progress is called while solving, and every stage has a name */
        hd_context ctx;
        rob_progress p;
        memset(&ctx, 0, sizeof ctx);
        memset(&p, 0, sizeof p);
        ctx.progress = rob_on_progress;
        ctx.progress_user = &p;
        o = eng_opts(eng_methods[k]);
        o.context = &ctx;
        heat = eng_create(lap, &o);
        CHECK(heat_column(heat, t, 3, u, NULL) >= 0);
        CHECK_MSG(p.solving > 0 && p.calls > p.solving + 2, "%s: progress is called %lld times, %lld while solving", eng_name(eng_methods[k]),
            (long long)p.calls,
            (long long)p.solving);
        hd_heat_free(heat);
    }
    free(F);
    free(u);
    hd_laplacian_free(lap);
}

/* ---- orders of elimination ---- */

static void eng_orderings(void) {
    static const hd_ordering kinds[5] = {HD_ORDERING_AUTO, HD_ORDERING_MINIMUM_DEGREE, HD_ORDERING_NESTED_DISSECTION, HD_ORDERING_OWN,
        HD_ORDERING_OWN};
    shape ball = kit_own_shape(shape_bumpy(2, 8)), s = kit_own_shape(eng_with_inert(&ball));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const int32_t n = s.n, sources[4] = {1, 0, 77, 1};
    const double t = 10 * lap->h * lap->h;
    int32_t *perm = DENSE_NEW(int32_t, n), *rows = DENSE_NEW(int32_t, n), i, m;
    double *first = DENSE_NEW(double, 4 * n), *u = DENSE_NEW(double, 4 * n);
    uint64_t seed = 16;
    int k, q;
    for (k = 0; k < 2; k++) {
        for (q = 0; q < 5; q++) {
            hd_heat_opts o = eng_opts(eng_methods[k]);
            hd_ldl_opts lo = ldl_opts_of(kinds[q], rows, lap->xyz, NULL);
            hd_ldl_report want;
            hd_ldl *f = NULL;
            hd_report rep;
            hd_heat *heat;
            double flops;
            dense_shuffle(perm, n, &seed);
            for (i = 0; q == 4 && i < n; i++) perm[i] = n - 1 - i;
            for (i = m = 0; i < n; i++)
                if (lap->row[perm[i]] >= 0) rows[m++] = lap->row[perm[i]];
            o.ordering = kinds[q];
            o.perm = kinds[q] == HD_ORDERING_OWN ? perm : NULL;
            heat = eng_create(lap, &o);
            for (i = 0; i < n; i++) perm[i] = -1;    /* it was copied */
            if (!eng_ok(heat_columns(heat, t, HD_KERNEL_OPERATOR, 4, sources, q ? u : first, 0, &rep), &rep, "ordering")) continue;
            CHECK_MSG(q == 0 || dense_max_diff(u, first, 4 * n) <= (k ? 1e-8 : 1e-12), "%s: ordering %d differs by %g", eng_name(eng_methods[k]),
                q, dense_max_diff(u, first, 4 * n));
            CHECK(rep.ordering == (q == 0 ? HD_ORDERING_MINIMUM_DEGREE : kinds[q]));
            CHECK(hd_ldl_analyse(&f, &lap->L, &lo, &want, NULL) == HD_OK);
            CHECK_MSG(rep.factor_nnz == want.factor_nnz, "ordering %d: %lld non-zeros, not %lld", q, (long long)rep.factor_nnz,
                (long long)want.factor_nnz);
            flops = (k ? 1 : 16 * ((rep.n_poles + 2) / 4) + rep.n_poles % 4 % 2) * want.factor_flops;
            CHECK_MSG(fabs(rep.factor_flops - flops) < 1e-6 * flops, "ordering %d, %d poles: %g flops, not %g", q, (int)rep.n_poles,
                rep.factor_flops, flops);
            CHECK_MSG(rep.growth > 0.1 && rep.growth < (k ? 1.0000001 : 4.2), "growth %g", rep.growth);
            hd_ldl_free(f);
            hd_heat_free(heat);
        }
    }
    free(perm);
    free(rows);
    free(first);
    free(u);
    hd_laplacian_free(lap);
}

/* What is not a permutation is told with its place. */
static void eng_bad_perms(void) {
    shape ball = kit_own_shape(shape_icosphere(0)), s = kit_own_shape(eng_with_inert(&ball));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const int32_t n = s.n;
    int32_t *perm = DENSE_NEW(int32_t, n), i, twice = 3;
    double *u = DENSE_NEW(double, n);
    int k, q, again;
    CHECK(n == 17 && lap->row[0] < 0 && lap->row[5] < 0 && lap->row[3] >= 0 && lap->row[8] >= 0);
    for (k = 0; k < 2; k++) {
        for (q = 0; q < 5; q++) {
            hd_heat_opts o = eng_opts(eng_methods[k]);
            hd_heat *heat = NULL;
            hd_report rep;
            hd_error e;
            hd_status st;
            for (i = 0; i < n; i++) perm[i] = i;
            if (q == 0) perm[7] = n;
            if (q == 1) perm[11] = -1;
            if (q == 2) perm[8] = twice;         /* both have mass */
            if (q == 3) perm[5] = 0;             /* none has */
            if (q == 4) perm[5] = twice;
            o.ordering = HD_ORDERING_OWN;
            o.perm = perm;
            st = hd_heat_create(&heat, lap, &o, &e);
            for (again = 0; again < 2; again++) {
                if (st >= 0) {
                    const hd_status got = heat_column(heat, 0.1, 4, u, &rep);
                    e = rep.error;
                    CHECK(e.status == got);
                }
                CHECK_MSG(e.status == HD_ERR_INDEX, "permutation %d: %s", q, hd_status_name(e.status));
                CHECK_MSG(e.row == (q == 0 ? 7 : q == 1 ? 11 : q == 2 ? 8 : 5), "permutation %d: told of place %lld", q, (long long)e.row);
                CHECK_MSG(e.value == (q == 0 ? n : q == 1 ? -1 : q == 3 ? 0 : twice), "permutation %d: told of vertex %g", q, e.value);
            }
            if (st >= 0) hd_heat_free(heat);
        }
    }
    free(perm);
    free(u);
    hd_laplacian_free(lap);
}

/* ---- the choice ---- */

static hd_method eng_chosen(const hd_laplacian *lap, const hd_heat_opts *o, double t, int32_t k, int times, const char *reason) {
    hd_heat *heat = eng_create(lap, o);
    double *u = DENSE_NEW(double, (times ? times : k) * lap->n), *at = DENSE_NEW(double, times + 1);
    int32_t *sources = DENSE_NEW(int32_t, k), i;
    hd_report rep;
    for (i = 0; i < k; i++) sources[i] = i * 3 % lap->n;
    for (i = 0; i < times; i++) at[i] = t * (1 + i);
    if (times) CHECK(heat_times(heat, times, at, HD_KERNEL_OPERATOR, 3, NULL, u, 0, &rep) >= 0);
    else CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, sources, u, 0, &rep) >= 0);
    CHECK(rep.method != HD_METHOD_AUTO);
    CHECK_MSG(rep.reason && (!reason || strstr(rep.reason, reason)), "%s: %s", eng_name(rep.method), rep.reason ? rep.reason : "no reason");
    hd_heat_free(heat);
    free(u);
    free(at);
    free(sources);
    return rep.method;
}

static void eng_choice(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    hd_laplacian *fem = test_laplacian(&s, HD_LAPLACIAN_FEM), *voronoi = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    const double hh = fem->h * fem->h;
    const hd_heat_opts none = eng_opts(HD_METHOD_AUTO);
    const char *what;
    hd_rational set = eng_own_set(3, &what);
    hd_heat_opts o;
    hd_heat *heat;
    hd_report rep;
    double *u = DENSE_NEW(double, s.n);
    int k;
    CHECK(eng_chosen(voronoi, &none, 0.01 * hh, 1, 0, "iterations") == HD_METHOD_ITERATIVE);    /* far from where they cost the same */
    CHECK(eng_chosen(fem, &none, 300 * hh, 64, 0, "columns") == HD_METHOD_DIRECT);
    CHECK(eng_chosen(fem, &none, 5 * hh, 1, 40, "times") == HD_METHOD_KRYLOV);
    for (k = 0; k < 4; k++) {                    /* poles that are asked for are not passed over */
        o = none;
        if (k == 0) o.poles = HD_POLES_KERNEL;
        if (k == 1) o.degree = 6;
        if (k == 2) o.rational = &set;
        if (k == 3) o.poles = HD_POLES_UNIFORM;
        CHECK(eng_chosen(fem, &o, 5 * hh, 1, 20, NULL) != HD_METHOD_KRYLOV);
        CHECK(eng_chosen(fem, &o, 300 * hh, 64, 0, NULL) == HD_METHOD_DIRECT);
    }
    for (k = 0; k < 6; k++) {                    /* nor solvers and preconditioners */
        o = none;
        if (k < 4) o.solver = k == 0 ? HD_SOLVER_COCG : k == 1 ? HD_SOLVER_COCR : k == 2 ? HD_SOLVER_MINRES : HD_SOLVER_LANCZOS;
        else o.precond = k == 4 ? HD_PRECOND_JACOBI : HD_PRECOND_MILDL;
        CHECK(eng_chosen(fem, &o, 3 * hh, 8, 0, "asked") == HD_METHOD_ITERATIVE);
        CHECK(eng_chosen(fem, &o, hh, 1, 4, "asked") == HD_METHOD_ITERATIVE);
    }
    for (k = 1; k < 4; k++) {
        o = eng_opts((hd_method)k);
        CHECK(eng_chosen(fem, &o, 2 * hh, 2, 0, "asked") == (hd_method)k);
        CHECK(eng_chosen(voronoi, &o, 20 * hh, 1, 3, "asked") == (hd_method)k);
    }
    heat = eng_create(fem, &none);
    CHECK(heat_column(heat, 0, 3, u, &rep) == HD_OK && rep.method != HD_METHOD_AUTO && rep.reason && rep.factor_nnz == 0);
    hd_heat_free(heat);
    hd_laplacian_free(fem);
    hd_laplacian_free(voronoi);
    free(u);
}

/* Auto, asked for columns one by one at one t, goes over to the factors of the poles after some calls, and stays with them. */
static void eng_habit(const shape *s, hd_laplacian_kind kind, double c, const char *what) {
    hd_laplacian *lap = test_laplacian_at(s, s->xyz, kind, 1, NULL);
    const double t = c * lap->h * lap->h;
    const hd_heat_opts none = eng_opts(HD_METHOD_AUTO), krylov = eng_opts(HD_METHOD_KRYLOV), direct = eng_opts(HD_METHOD_DIRECT);
    hd_heat *heat = eng_create(lap, &none), *asked = eng_create(lap, &krylov), *other = eng_create(lap, &direct), *moving = eng_create(lap, &none);
    double *u = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, lap->n);
    hd_report rep, rep2;
    int k, expected = 0, round;
    for (round = 0; round < 3; round++) {        /* new; at another t; after an update of the Laplacian */
        const double now = round == 1 ? 1.5 * t : t;
        int switched = 0;
        if (round == 2) CHECK(hd_laplacian_update(lap, s->xyz, NULL) == HD_OK);
        for (k = 1; k < 40 && k <= (switched ? switched + 3 : 39); k++) {
            const int32_t source = lap->vertex[k * 37 % lap->n_active];
            CHECK(eng_ok(heat_column(heat, now, source, u, &rep), &rep, what));
            CHECK_MSG(rep.method == (switched || rep.method == HD_METHOD_DIRECT ? HD_METHOD_DIRECT : HD_METHOD_KRYLOV),
                      "%s, round %d, call %d: %s", what, round, k, eng_name(rep.method));
            if (rep.method == HD_METHOD_DIRECT) {
                CHECK_MSG(strstr(rep.reason, switched ? "calls before" : "at this t") != NULL, "%s", rep.reason);
                if (!switched) switched = k;
            }
            CHECK(eng_ok(heat_column(rep.method == HD_METHOD_DIRECT ? asked : other, now, source, want, &rep2), &rep2, what));
            CHECK_MSG(dense_max_diff(u, want, lap->n) <= (rep.error_bound + rep2.error_bound) * dense_max_abs(want, lap->n) && rep.error_bound < 1e-5,
                      "%s, call %d: off by %g, bounds %g and %g", what, k, dense_max_diff(u, want, lap->n), rep.error_bound, rep2.error_bound);
        }
        CHECK_MSG(switched >= 2, "%s, round %d: call %d", what, round, switched);
        if (switched > expected) expected = switched;
    }
    for (k = 0; k < 2 * expected + 4; k++) {     /* times that change, or change back, and a method that is asked for */
        CHECK(eng_ok(heat_column(moving, t * (1 + 0.5 * (k % 2)), 3, u, &rep), &rep, what) && rep.method == HD_METHOD_KRYLOV);
        CHECK(eng_ok(heat_column(asked, t, 3, u, &rep), &rep, what) && rep.method == HD_METHOD_KRYLOV && strcmp(rep.reason, "asked for") == 0);
    }
    hd_heat_free(heat);
    hd_heat_free(asked);
    hd_heat_free(other);
    hd_heat_free(moving);
    hd_laplacian_free(lap);
    free(u);
    free(want);
}

/* The same within byte limits: never an error and never too many bytes where the first call has an answer, and direct only where
 * its factors fit beside what is there. */
static void eng_habit_limits(const shape *s) {
    hd_laplacian *lap = test_laplacian(s, HD_LAPLACIAN_FEM);
    const double t = 30 * lap->h * lap->h;
    double *u = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, lap->n);
    hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
    hd_context ctx;
    hd_heat *heat = NULL;
    hd_report rep;
    uint64_t limit, enough;
    int k, seen = 0;
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    heat = eng_create(lap, &o);
    CHECK(heat_column(heat, t, 5, want, NULL) >= 0);
    enough = 2 * ctx.bytes_peak;
    hd_heat_free(heat);
    o.method = HD_METHOD_AUTO;
    for (limit = enough; limit > enough / 16; limit -= limit / 16) {
        memset(&ctx, 0, sizeof ctx);
        ctx.byte_limit = limit;
        heat = eng_create(lap, &o);
        for (k = 0; k < 12; k++) {
            if (heat_column(heat, t, 5, u, &rep) < 0) {
                CHECK_MSG(k == 0, "limit %llu: call %d fails: %s", (unsigned long long)limit, k, rep.error.text);
                break;
            }
            CHECK(ctx.bytes_peak <= limit && dense_max_diff(u, want, lap->n) <= 1e-6 * dense_max_abs(want, lap->n));
        }
        if (k == 12) seen |= 1 << rep.method;
        hd_heat_free(heat);
        CHECK(ctx.bytes_in_use == 0);
    }
    CHECK_MSG(seen == (1 << HD_METHOD_DIRECT | 1 << HD_METHOD_KRYLOV | 1 << HD_METHOD_ITERATIVE), "seen: %d", seen);
    hd_laplacian_free(lap);
    free(u);
    free(want);
}

/* Fields have factors of another set. Where they alternate with columns, no call factorises what the one before has made. */
static void eng_habit_mixed(const shape *s) {
    hd_laplacian *lap = test_laplacian(s, HD_LAPLACIAN_FEM);
    const hd_heat_opts none = eng_opts(HD_METHOD_AUTO);
    hd_heat *heat = eng_create(lap, &none);
    const double t = 30 * lap->h * lap->h;
    double *u = DENSE_NEW(double, lap->n), *f = DENSE_NEW(double, lap->n);
    hd_report rep;
    int k, switches = 0;
    hd_method last[2] = {HD_METHOD_AUTO, HD_METHOD_AUTO};
    int32_t i;
    for (i = 0; i < lap->n; i++) f[i] = 2 + sin(3 * s->xyz[3 * i]);
    for (k = 0; k < 60; k++) {
        CHECK((k % 2 ? heat_apply(heat, t, 1, f, 0, u, 0, &rep) : heat_column(heat, t, 5, u, &rep)) >= 0);
        switches += last[k % 2] != HD_METHOD_AUTO && last[k % 2] != rep.method;
        last[k % 2] = rep.method;
    }
    CHECK_MSG(switches <= 1, "%d switches", switches);
    CHECK((last[0] == HD_METHOD_DIRECT) != (last[1] == HD_METHOD_DIRECT));
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(u);
    free(f);
}

static void eng_habits(void) {
    shape s = kit_own_shape(shape_bumpy(4, 2)), ring = kit_own_shape(shape_torus(144, 60, 2, 1));
    eng_habit(&s, HD_LAPLACIAN_FEM, 30, "bumpy, fem");
    eng_habit(&ring, HD_LAPLACIAN_VORONOI_COT, 200, "torus, voronoi");
    eng_habit_limits(&s);
    eng_habit_mixed(&s);
}

/* Whatever the limit is: when iterations fit into it, there is an answer; twice the same call is twice the same method. */
static void eng_choice_limits_of(const hd_laplacian *lap, double t, int32_t k) {
    double *u = DENSE_NEW(double, k * lap->n), *want = DENSE_NEW(double, k * lap->n);
    int32_t *sources = DENSE_NEW(int32_t, k), i;
    hd_context ctx;
    hd_heat_opts o = eng_opts(HD_METHOD_ITERATIVE);
    hd_heat *heat;
    hd_report rep, rep2;
    uint64_t limit, need, enough;
    int seen = 0;
    for (i = 0; i < k; i++) sources[i] = i * 7 % lap->n;
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    heat = eng_create(lap, &o);
    CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, sources, want, 0, NULL) >= 0);
    need = ctx.bytes_peak;
    hd_heat_free(heat);
    memset(&ctx, 0, sizeof ctx);
    o.method = HD_METHOD_DIRECT;
    heat = eng_create(lap, &o);
    CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, sources, u, 0, NULL) >= 0);
    enough = 3 * ctx.bytes_peak;
    hd_heat_free(heat);
    o.method = HD_METHOD_AUTO;
    for (limit = need; limit < enough; limit += limit / 4) {
        memset(&ctx, 0, sizeof ctx);
        ctx.byte_limit = limit;
        heat = eng_create(lap, &o);
        if (eng_ok(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, sources, u, 0, &rep), &rep, "limits")) {
            const double off = dense_max_diff(u, want, k * lap->n);
            CHECK_MSG(off <= 1e-6 * dense_max_abs(want, k * lap->n), "limit %llu, %s: off by %g", (unsigned long long)limit, eng_name(rep.method),
                off);
            CHECK(rep.reason && ctx.bytes_peak <= limit);
            seen |= 1 << rep.method;
            CHECK(eng_ok(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, sources, u, 0, &rep2), &rep2, "limits"));
            CHECK_MSG(rep.method == rep2.method, "limit %llu: %s, then %s", (unsigned long long)limit, eng_name(rep.method), eng_name(rep2.method));
        }
        hd_heat_free(heat);
        CHECK(ctx.bytes_in_use == 0);
    }
    CHECK_MSG(seen >> HD_METHOD_ITERATIVE & 1, "never iterated: %d", seen);
    CHECK_MSG(seen & (1 << HD_METHOD_DIRECT | 1 << HD_METHOD_KRYLOV), "never factorised: %d", seen);
    free(u);
    free(want);
    free(sources);
}

static void eng_choice_limits(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    int q;
    for (q = 0; q < 2; q++) {
        hd_laplacian *lap = test_laplacian(&s, op_kinds[q]);
        eng_choice_limits_of(lap, 40 * lap->h * lap->h, 1);
        eng_choice_limits_of(lap, 4 * lap->h * lap->h, 9);
        hd_laplacian_free(lap);
    }
}

/* A plan that once had to do without factors takes them again when there is room: the same bits as a new one. */
static void eng_limit_lifted(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double t = 40 * lap->h * lap->h;
    double *u = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, lap->n);
    hd_heat_opts o = eng_opts(HD_METHOD_ITERATIVE);
    hd_context ctx, free_ctx;
    hd_heat *heat;
    hd_report rep;
    uint64_t need;
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    heat = eng_create(lap, &o);
    CHECK(heat_column(heat, t, 7, u, NULL) >= 0);
    need = ctx.bytes_peak;
    hd_heat_free(heat);
    memset(&ctx, 0, sizeof ctx);
    memset(&free_ctx, 0, sizeof free_ctx);
    o.method = HD_METHOD_AUTO;
    o.context = &free_ctx;
    heat = eng_create(lap, &o);
    CHECK(eng_ok(heat_column(heat, t, 7, want, &rep), &rep, "no limit") && rep.method != HD_METHOD_ITERATIVE);
    hd_heat_free(heat);
    ctx.byte_limit = need + need / 8;
    o.context = &ctx;
    heat = eng_create(lap, &o);
    /* another t: iterations at the same one may have cost as much as the factors of the poles */
    CHECK(eng_ok(heat_column(heat, 1.01 * t, 7, u, &rep), &rep, "limit") && rep.method == HD_METHOD_ITERATIVE && strcmp(rep.reason, "asked for") != 0);
    ctx.byte_limit = 0;
    CHECK(eng_ok(heat_column(heat, t, 7, u, &rep), &rep, "limit lifted") && rep.method != HD_METHOD_ITERATIVE);
    CHECK(memcmp(u, want, (size_t)lap->n * sizeof *u) == 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(u);
    free(want);
}

/* ---- errors ---- */

static void eng_bad_options(void) {
    shape s = kit_own_shape(shape_icosphere(0));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM), *own = eng_leaking(4, 3);
    int32_t perm[12];
    double u[12];
    hd_heat *heat = NULL;
    hd_heat_opts o;
    hd_rational set;
    hd_report rep;
    hd_error e;
    int k, q;
    for (k = 0; k < 12; k++) {
        perm[k] = k;
        u[k] = 1;
    }
    CHECK(hd_rational_get(&set, HD_POLES_UNIFORM, 4, &e) == HD_OK);
#define ENG_BAD_OPTION(the_method, field, bad)                                                                         \
    o = eng_opts(the_method);                                                                                          \
    o.field = bad;                                                                                                     \
    CHECK(hd_heat_create(&heat, lap, &o, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT && e.text[0] && !heat)
    ENG_BAD_OPTION(HD_METHOD_AUTO, method, (hd_method)4);
    ENG_BAD_OPTION(HD_METHOD_AUTO, method, (hd_method)-1);
    ENG_BAD_OPTION(HD_METHOD_AUTO, ordering, (hd_ordering)4);
    ENG_BAD_OPTION(HD_METHOD_AUTO, ordering, (hd_ordering)-1);
    ENG_BAD_OPTION(HD_METHOD_AUTO, ordering, HD_ORDERING_OWN);
    ENG_BAD_OPTION(HD_METHOD_DIRECT, ordering, HD_ORDERING_OWN);
    ENG_BAD_OPTION(HD_METHOD_KRYLOV, poles, HD_POLES_UNIFORM);
    ENG_BAD_OPTION(HD_METHOD_KRYLOV, poles, HD_POLES_KERNEL);
    ENG_BAD_OPTION(HD_METHOD_KRYLOV, degree, 8);
    ENG_BAD_OPTION(HD_METHOD_KRYLOV, rational, &set);
    for (k = 0; k < 2; k++) {
        ENG_BAD_OPTION(eng_methods[k], solver, HD_SOLVER_COCG);
        ENG_BAD_OPTION(eng_methods[k], solver, HD_SOLVER_LANCZOS);
        ENG_BAD_OPTION(eng_methods[k], precond, HD_PRECOND_MILDL);
        ENG_BAD_OPTION(eng_methods[k], precond, HD_PRECOND_NONE);
        ENG_BAD_OPTION(eng_methods[k], poles, HD_POLES_OWN);
        ENG_BAD_OPTION(eng_methods[k], degree, 15);
    }
#undef ENG_BAD_OPTION
    for (k = 0; k < 2; k++) {                    /* no coordinates to dissect by: told at once, or when it is needed */
        o = eng_opts(eng_methods[k]);
        o.ordering = HD_ORDERING_NESTED_DISSECTION;
        for (q = 0; q < 2; q++) {
            hd_status st = hd_heat_create(&heat, own, &o, &e);
            if (st >= 0) {
                st = q ? heat_apply(heat, 1, 1, u, 0, u, 0, &rep) : heat_column(heat, 1, 2, u, &rep);
                e = rep.error;
                hd_heat_free(heat);
            }
            CHECK_MSG(st == HD_ERR_ARGUMENT && e.status == st && strstr(e.text, "coordinates"), "%s", e.text);
        }
        o.ordering = HD_ORDERING_OWN;            /* without any, an order of the caller's will do */
        o.perm = perm;
        heat = eng_create(own, &o);
        CHECK(eng_ok(heat_column(heat, 1, 2, u, &rep), &rep, "own"));
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    hd_laplacian_free(own);
}

static void eng_bad_calls(void) {
    static const hd_method methods[4] = {HD_METHOD_AUTO, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT, HD_METHOD_KRYLOV};
    shape s = kit_own_shape(shape_icosphere(0));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    int32_t sources[3] = {0, 12, 2}, i;
    double F[36], U[36], times[3] = {0.3, 0.1, 0.2};
    hd_report rep;
    int k;
    for (k = 0; k < 4; k++) {
        hd_heat *heat = eng_plan(lap, methods[k], HD_POLES_DEFAULT, 0);
        for (i = 0; i < 36; i++) F[i] = i;
#define ENG_BAD(call, st)                                                                                              \
    CHECK_MSG((call) == (st) && rep.status == (st) && rep.error.status == (st) && rep.error.text[0], "%s: %s", eng_name(methods[k]),   \
              hd_status_name(rep.status))
        ENG_BAD(heat_apply(heat, -1, 1, F, 0, U, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_apply(heat, (double)NAN, 1, F, 0, U, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_column(heat, (double)INFINITY, 1, U, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_apply(heat, 1, 1, F, 11, U, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_columns(heat, 1, HD_KERNEL_OPERATOR, 3, sources, U, 0, &rep), HD_ERR_INDEX);
        CHECK(rep.error.vertex == 12 && rep.error.column == 1);
        U[0] = 77;                               /* nothing is written before it is seen */
        F[12 + 7] = (double)NAN;
        ENG_BAD(heat_apply(heat, 1, 3, F, 0, U, 0, &rep), HD_ERR_NOT_FINITE);
        CHECK(rep.error.row == 7 && rep.error.column == 1);
        F[12 + 7] = 0;
        F[5] = -(double)INFINITY;
        ENG_BAD(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 0, F, U, 0, &rep), HD_ERR_NOT_FINITE);
        CHECK(rep.error.row == 5 && rep.error.column == 0);
        F[5] = 5;
        for (i = 0; i < 3; i++) {
            const double good = times[i], bad[3] = {-0.1, (double)NAN, (double)INFINITY};
            times[i] = bad[i];
            ENG_BAD(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 0, i == 1 ? F : NULL, U, 0, &rep), HD_ERR_ARGUMENT);
            CHECK(rep.error.column == i && (rep.error.value == bad[i] || i == 1));
            times[i] = good;
        }
        ENG_BAD(heat_times(heat, -1, times, HD_KERNEL_OPERATOR, 0, NULL, U, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_times(heat, 3, NULL, HD_KERNEL_OPERATOR, 0, NULL, U, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 0, NULL, NULL, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 0, NULL, U, 11, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_times(heat, 3, times, (hd_kernel)2, 0, NULL, U, 0, &rep), HD_ERR_ARGUMENT);
        ENG_BAD(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, 12, NULL, U, 0, &rep), HD_ERR_INDEX);
        CHECK(rep.error.vertex == 12);
        ENG_BAD(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, -1, NULL, U, 0, &rep), HD_ERR_INDEX);
        ENG_BAD(heat_times(NULL, 3, times, HD_KERNEL_OPERATOR, 1, NULL, U, 0, &rep), HD_ERR_ARGUMENT);
        CHECK(U[0] == 77);
        CHECK(heat_times(heat, 3, times, HD_KERNEL_OPERATOR, -99, F, U, 0, NULL) >= 0);    /* with a field the source is not looked at */
        CHECK(heat_times(heat, -3, times, HD_KERNEL_OPERATOR, 0, F, U, 0, NULL) == HD_ERR_ARGUMENT);
        ENG_BAD(heat_column(heat, 0.1, -1, U, &rep), HD_ERR_INDEX);
        CHECK(heat_column(heat, 0.1, 1, U, &rep) >= 0);    /* the plan is as good as before */
#undef ENG_BAD
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
}

/* ---- memory and cancelling ---- */

/* variant % 8: method and poles; / 8: columns, fields, entries, times, one column. */
static hd_status eng_rob_job(hd_context *ctx, int variant) {
    const int way = variant % 8, task = variant / 8;
    const int32_t sources[7] = {0, 5, 13, 14, 2, 20, 5};
    hd_laplacian *lap;
    hd_heat *heat = rob_mark_heat;
    hd_heat_opts o = eng_opts(way == 7 ? HD_METHOD_AUTO : way < 4 ? HD_METHOD_DIRECT : HD_METHOD_KRYLOV);
    const char *what;
    hd_rational set = eng_own_set(3, &what);
    int32_t perm[21], i;
    double F[21 * 7], U[21 * 7], times[7];
    hd_report rep;
    hd_error e;
    hd_status st = rob_laplacian_of(ctx, way & 1 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, &lap);
    if (st < 0) return st;
    memset(&rep, 0, sizeof rep);
    CHECK(lap->n == 21);
    for (i = 0; i < 21; i++) perm[i] = 20 - i;
    for (i = 0; i < 21 * 7; i++) F[i] = i % 5;
    for (i = 0; i < 7; i++) times[i] = 0.1 * pow(10, i % 4);
    if (way == 1) o.rational = &set;
    if (way == 2) o.degree = 3;
    if (way == 3 || way == 5) o.ordering = HD_ORDERING_NESTED_DISSECTION;
    if (way == 4) {
        o.ordering = HD_ORDERING_OWN;
        o.perm = perm;
    }
    st = hd_heat_create(&heat, lap, &o, &e);
    CHECK(e.status == st && (st >= 0) == (heat != rob_mark_heat));
    if (st >= 0) {
        const double t = lap->h * lap->h;
        if (task == 0) st = heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 7, sources, U, 0, &rep);
        if (task == 1) st = heat_apply(heat, t, 7, F, 0, U, 0, &rep);
        if (task == 2) st = heat_entries(heat, t, HD_KERNEL_OPERATOR, 7, sources, sources, U, &rep);
        if (task == 3) st = heat_times(heat, 7, times, HD_KERNEL_SYMMETRIC, 3, NULL, U, 0, &rep);
        if (task == 4) st = heat_column(heat, t, 7, U, &rep);
        CHECK(rep.status == st && (st >= 0 || rep.error.status == st));
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    return st > 0 ? HD_OK : st;
}

/* By itself the choice makes do with iterations when factors cannot be had: an answer, or the right error. */
static void eng_fail_each_auto(const rob_job *job) {
    int64_t k;
    int done = 0;
    for (k = 1; k < ROB_MOST && !done; k++) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        hd_status st;
        m.fail_at = k;
        st = job->run(&ctx, job->variant);
        CHECK_MSG(st >= 0 || st == HD_ERR_MEMORY, "%s: allocation %lld failed, but %s", job->what, (long long)k, hd_status_name(st));
        test_memory_done(&m, &ctx, job->what);
        done = m.calls < k;
    }
    CHECK_MSG(done && k > 2, "%s: stopped at %lld", job->what, (long long)k);
}

static void eng_robust(void) {
    int way, task;
    for (way = 0; way < 8; way++) {
        for (task = 0; task < 5; task++) {
            char what[40];
            rob_job job;
            snprintf(what, sizeof what, "engines %d, task %d", way, task);
            job.what = what;
            job.run = eng_rob_job;
            job.variant = way + 8 * task;
            if (way == 7) eng_fail_each_auto(&job);
            else rob_fail_each_allocation(&job);
            if (way < 7) rob_byte_limits(&job);  /* by itself the choice depends on the limit */
            rob_stop_each_progress(&job, HD_PROGRESS_CANCEL, HD_ERR_CANCELLED);
            rob_stop_each_progress(&job, (hd_progress)1, HD_ERR_ARGUMENT);
            rob_stop_each_progress(&job, (hd_progress)0, HD_ERR_ARGUMENT);
        }
    }
}

/* A plan that ran out of memory (q = 0) or was cancelled (q = 1) in any of its calls answers the next ones as if nothing had been. */
static void eng_survives_one(const hd_laplacian *lap, hd_heat_opts o, int q, const char *what) {
    static const eng_call calls[6] = {{3, 1, 0}, {80, 7, 2}, {3, 8, 1}, {900, 1, 4}, {80, 1, 2}, {3, 2, 0}};
    enum { CALLS = 6 };
    const size_t size = (size_t)(8 * lap->n);
    double *want = DENSE_NEW(double, CALLS * size), *u = DENSE_NEW(double, size);
    int at, z;
    for (z = 0; z < CALLS; z++) {
        hd_heat *heat = eng_create(lap, &o);
        eng_call call = calls[z];
        call.t *= lap->h * lap->h;
        CHECK(eng_do(heat, lap, &call, want + (size_t)z * size, NULL) >= 0);
        hd_heat_free(heat);
    }
    for (at = 0; at < CALLS; at++) {             /* the call that fails */
        int64_t k;
        int reached = 1;
        for (k = 1; k < ROB_MOST && reached; k++) {
            test_memory m;
            hd_context ctx = test_memory_context(&m);
            hd_heat *heat;
            hd_status st;
            rob_progress p;
            memset(&p, 0, sizeof p);
            p.stop_at = k;
            p.answer = HD_PROGRESS_CANCEL;
            ctx.progress_user = &p;
            o.context = &ctx;
            heat = eng_create(lap, &o);
            for (z = 0; z < CALLS; z++) {
                eng_call call = calls[z];
                call.t *= lap->h * lap->h;
                if (z == at) {
                    if (q) ctx.progress = rob_on_progress;
                    else m.fail_at = m.calls + k;
                    st = eng_do(heat, lap, &call, u, NULL);
                    reached = q ? p.calls >= k : m.calls >= m.fail_at;
                    ctx.progress = NULL;
                    m.fail_at = 0;
                    CHECK_MSG(st >= 0 ? !reached || !q : st == (q ? HD_ERR_CANCELLED : HD_ERR_MEMORY), "%s: %s", what, hd_status_name(st));
                    if (st < 0) CHECK(eng_do(heat, lap, &call, u, NULL) >= 0);
                } else {
                    CHECK(eng_do(heat, lap, &call, u, NULL) >= 0);
                }
                CHECK_MSG(dense_max_diff(u, want + (size_t)z * size, (int64_t)(call.task == 4 ? 3 : call.k) * lap->n) <=
                    (o.method == HD_METHOD_DIRECT ? 0 : 1e-7),
                          "%s: call %d after failure %lld in call %d: other answers", what, z, (long long)k, at);
            }
            hd_heat_free(heat);
            test_memory_done(&m, &ctx, what);
        }
        CHECK_MSG(k < ROB_MOST, "%s: never went well", what);
    }
    free(want);
    free(u);
}

static void eng_survives(void) {
    shape s = kit_own_shape(shape_icosphere(0));
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const char *what;
    hd_rational set = eng_own_set(3, &what);
    int q;
    for (q = 0; q < 2; q++) {
        hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
        eng_survives_one(lap, o, q, "direct survives");
        o.rational = &set;
        eng_survives_one(lap, o, q, "lone pole survives");
        eng_survives_one(lap, eng_opts(HD_METHOD_KRYLOV), q, "krylov survives");
        eng_survives_one(lap, eng_opts(HD_METHOD_AUTO), q, "auto survives");
    }
    hd_laplacian_free(lap);
}

/* The same field again takes the same number of iterations, and finds the same bits: nothing is left of the first, in calls nor within one. */
static void eng_again(void) {
    enum { FIELDS = 40 };
    static const hd_method methods[3] = {HD_METHOD_ITERATIVE, HD_METHOD_ITERATIVE, HD_METHOD_KRYLOV};
    shape ball = kit_own_shape(shape_icosphere(2));
    hd_laplacian *lap = test_laplacian(&ball, HD_LAPLACIAN_FEM);
    double *F = DENSE_NEW(double, FIELDS * (int64_t)ball.n), *u = DENSE_NEW(double, FIELDS * (int64_t)ball.n);
    uint64_t seed = 5;
    int32_t k, v;
    for (v = 0; v < ball.n; v++) F[v] = dense_signed(&seed);
    for (v = 1; v < FIELDS; v++) memcpy(F + v * ball.n, F, (size_t)ball.n * sizeof *F);
    for (k = 0; k < 3; k++) {
        hd_heat_opts o = eng_opts(methods[k]);
        hd_report rep[2];
        hd_heat *heat;
        if (k == 1) o.solver = HD_SOLVER_COCG;   /* pole by pole; else Lanczos */
        heat = eng_create(lap, &o);
        for (v = 0; v < 2; v++) CHECK(heat_apply(heat, 3 * lap->h * lap->h, 1, F, 0, u + v * ball.n, 0, rep + v) >= 0);
        CHECK_MSG(rep[0].iterations > 0 && rep[1].iterations == rep[0].iterations, "%lld iterations, then %lld", (long long)rep[0].iterations,
                  (long long)rep[1].iterations);
        CHECK(memcmp(u, u + ball.n, (size_t)ball.n * sizeof *u) == 0);
        CHECK(heat_apply(heat, 3 * lap->h * lap->h, FIELDS, F, 0, u, 0, rep + 1) >= 0);
        CHECK_MSG(rep[1].iterations == FIELDS * rep[0].iterations, "%lld iterations for %d fields, %lld for one", (long long)rep[1].iterations, (int)FIELDS, (long long)rep[0].iterations);
        for (v = 1; v < FIELDS; v++) CHECK(memcmp(u, u + v * ball.n, (size_t)ball.n * sizeof *u) == 0);
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    free(F);
    free(u);
}

/* Rounding of krylov's solves is measured at every field: constants, which it does not enter, may stand anywhere. */
static void eng_constant_first(void) {
    enum { K = 6 };
    shape s = kit_own_shape(shape_grid(12, 10, 0.3));
    const double t = 0.1;
    hd_laplacian *lap;
    double *f = DENSE_NEW(double, K * (int64_t)s.n), *u = DENSE_NEW(double, K * (int64_t)s.n), rounding[2];
    uint64_t seed = 3;
    int32_t v, last;
    for (v = 0; v < s.n; v++) s.xyz[3 * v + 1] *= 1e-3;      /* slivers, where solves round much */
    lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    for (v = 0; v < K * s.n; v++) f[v] = dense_signed(&seed);
    for (last = 0; last < 2; last++) {
        hd_heat *heat = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
        hd_report rep;
        double *one = last ? f + (K - 1) * s.n : f;
        if (last) memcpy(f, one, (size_t)s.n * sizeof *f);   /* the same fields */
        for (v = 0; v < s.n; v++) one[v] = 1;
        CHECK(hd_heat_apply(heat, 1, &t, K, f, 0, u, 0, &rep, NULL) >= 0 && rep.evidence_rounding == HD_EVIDENCE_MEASURED);
        rounding[last] = rep.error_rounding;
        hd_heat_free(heat);
    }
    CHECK_MSG(fabs(rounding[0] - rounding[1]) <= 1e-6 * rounding[0], "rounding %g with the constant first, %g with it last", rounding[0], rounding[1]);
    hd_laplacian_free(lap);
    free(f);
    free(u);
}

static void test_engines(void) {
    eng_dense_cases();
    eng_large();
    eng_batches();
    eng_degrees();
    eng_own_sets();
    eng_counts();
    eng_reuse();
    eng_again();
    eng_constant_first();
    eng_switch();
    eng_times();
    eng_times_columns();
    eng_times_inert();
    eng_threads();
    eng_extreme_times();
    eng_warnings();
    eng_told();
    eng_orderings();
    eng_bad_perms();
    eng_choice();
    eng_choice_limits();
    eng_habits();
    eng_limit_lifted();
    eng_bad_options();
    eng_bad_calls();
    eng_robust();
    eng_survives();
}

#endif
