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

static double eng_loosest;           /* bounds over errors, for whoever tunes them */

/* Is u within the bounds that the report gives, is the heat of every component what it was, and are the bounds worth something? rhs is B f on rows.
 * own: the answer is that of a filter, not of the exponential. alone: the report is about this answer and no other. */
static void eng_judge(const heat_case *c, double t, const hd_rational *own, const double *rhs, const double *u, const hd_report *rep, int alone, const char *what) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    double *g = DENSE_NEW(double, n), *want = DENSE_NEW(double, n), *diff = DENSE_NEW(double, n), *f = DENSE_NEW(double, n), *heat = DENSE_NEW(double, 3 * n);
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
    if (rep->error_bound_b == HUGE_VAL) CHECK_MSG(off_b <= (alone ? 1e-8 : 1e-7) * f_b, "%s, %s, %s, t %g: no bound, and an error of %g", c->what, eng_name(rep->method), what, t, off_b / f_b);
    else CHECK_MSG(off_b <= rep->error_bound_b * size_b + slack, "%s, %s, %s, t %g: error %g, bound %g (B norm)", c->what, eng_name(rep->method), what, t,
              off_b / size_b, rep->error_bound_b);
    CHECK_MSG(rep->error_bound == HUGE_VAL || off <= rep->error_bound * size + slack * 2 * sqrt(n / lap->area) + 1e-13 * size, "%s, %s, %s, t %g: error %g, bound %g (maximum)", c->what,
              eng_name(rep->method), what, t, off / size, rep->error_bound);
    CHECK(rep->error_bound_b >= rep->error_rational && rep->error_bound_b >= rep->error_solver);
    if (rep->error_bound_b < HUGE_VAL) {
        const double loose = rep->error_bound_b * size_b / (off_b + 1e-15 * f_b);
        if (alone) eng_loosest = fmax(eng_loosest, loose);
        CHECK_MSG(!alone || loose <= 1e6, "%s, %s, %s, t %g: error %g, bound %g", c->what, eng_name(rep->method), what, t, off_b / size_b, rep->error_bound_b);
    } else {
        CHECK_MSG(!alone || size_b <= 1e-5 * f_b, "%s, %s, %s, t %g: no bound for an answer of size %g", c->what, eng_name(rep->method), what, t, size_b / f_b);
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
            CHECK_MSG(fabs(heat[i] - out[i]) <= 1e-12 * sum[i], "%s, %s, %s, t %g: component %d had heat %g and has %g", c->what, eng_name(rep->method), what, t,
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
    CHECK_MSG(factors == (rep->ordering != HD_ORDERING_AUTO) && factors == (rep->factor_nnz > 0) && factors == (rep->factor_flops > 0), "%s, %s: ordering %d, %lld, %g",
              what, eng_name(method), (int)rep->ordering, (long long)rep->factor_nnz, rep->factor_flops);
    CHECK_MSG(rep->growth >= 0 && rep->growth < 5 && (factors || rep->growth == 0), "%s, %s: growth %g", what, eng_name(method), rep->growth);
    if (method == HD_METHOD_DIRECT) CHECK(rep->solver == HD_SOLVER_AUTO && rep->precond == HD_PRECOND_NONE && rep->iterations == 0 && rep->poles != HD_POLES_DEFAULT);
    if (method == HD_METHOD_KRYLOV) {
        CHECK(rep->solver == HD_SOLVER_LANCZOS && rep->precond == HD_PRECOND_NONE && rep->poles == HD_POLES_DEFAULT && rep->degree == 0 && rep->n_poles == 0);
        CHECK(rep->error_rational == 0);
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
            if (!eng_ok(hd_heat_columns(heat, t, kernel, z, sources, u, 0, &rep), &rep, what)) continue;
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
        if (!eng_ok(hd_heat_apply(heat, t, z, f, 0, u, 0, &rep), &rep, what)) continue;
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
        if (!eng_ok(hd_heat_columns(heat, t, kernel, K, ascending, u, 0, &rep), &rep, what)) continue;
        for (i = 0; i < 4 * K; i++) {
            cols[i] = ascending[(i * 2 + 1) % K];
            rows[i] = lap->vertex[(i * 37) % m];
        }
        if (!eng_ok(hd_heat_entries(heat, t, kernel, 4 * K, rows, cols, values, &rep), &rep, what)) continue;
        eng_check_report(&rep, method, what);
        for (i = 0; i < 4 * K; i++) CHECK(values[i] == u[(i * 2 + 1) % K * n + rows[i]]);
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
    shape ball = shape_bumpy(2, 3), torus = shape_torus(14, 9, 2, 0.8), grid = shape_grid(11, 9, 0.35), small = shape_icosphere(1), tiny = shape_grid(3, 2, 0.1);
    shape two = shape_disjoint(&small, &grid, offset), three = shape_disjoint(&two, &tiny, offset), soup = eng_soup(90, 200, 5), inert = eng_with_inert(&small);
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

/* ---- sets of poles ---- */

/* All degrees of both kinds: packs that are full, and such with one, two, three poles or a lone real one left over. */
static void eng_degrees(void) {
    shape s = shape_bumpy(1, 9);
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
                CHECK(hd_heat_column(heat, 3 * c.lap->h * c.lap->h, 5, u, &rep) >= 0);
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
    shape_free(&s);
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
        set.theta[i] = test_c(is_real ? 0.5 + 3.5 * fabs(dense_signed(&seed)) + 0.3 * i : 6 * dense_signed(&seed), is_real ? 0 : 1 + 8 * fabs(dense_signed(&seed)));
        set.a[i] = test_c(3 * dense_signed(&seed), is_real ? 0 : 3 * dense_signed(&seed));
        set.degree += is_real ? 1 : 2;
    }
    return set;
}

static hd_rational eng_own_set(int which, const char **what) {
    static const char *const names[ENG_SETS] = {"one real", "three real", "five real", "a real one and four", "a real one and eight", "four and a real one", "a real one and three",
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
    shape a = shape_grid(6, 6, 0.3), b = shape_icosphere(1), s = shape_disjoint(&a, &b, offset);
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
                if (!eng_ok(hd_heat_column(heat, t, 3, u, &rep), &rep, what)) continue;
                CHECK(rep.poles == HD_POLES_OWN && rep.n_poles == kept.n_poles && rep.degree == kept.degree && rep.error_rational == 0);
                CHECK_MSG(rep.mass_drift == 0 && rep.method == HD_METHOD_DIRECT, "%s: drift %g", what, rep.mass_drift);
                if (kept.n_poles) eng_against_dense(&c, heat, HD_METHOD_DIRECT, t, &kept, what);
            }
            free(u);
            hd_heat_free(heat);
        }
        heat_case_free(&c);
    }
    shape_free(&a);
    shape_free(&b);
    shape_free(&s);
}
