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
    return kit_plan(lap, &o);
}

/* A grid graph with heat leaking out everywhere, and masses over three decades: nothing is conserved, B is diagonal. */
static hd_laplacian *eng_leaking(int32_t nx, int32_t ny) {
    const int32_t n = nx * ny;
    int32_t *i = KIT_NEW(int32_t, 6 * n), *j = KIT_NEW(int32_t, 6 * n), k;
    double *v = KIT_NEW(double, 6 * n), *mass = KIT_NEW(double, n);
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
    return kit_own_laplacian(lap);
}

/* A set of poles by number, see trial_packs. */
static hd_rational eng_own_set(int which) {
    hd_rational set;
    memset(&set, 0, sizeof set);
    trial_packs(&set, which);
    return set;
}

/* ---- values ---- */

/* Times over six decades; several components, jumbles of non-manifold faces, vertices without mass, heat that leaks. */
static const case_row eng_values[] = {
    {"shape=bumpy/1/3 op=fem|vor|cot query=column|apply kernel=operator|symmetric k=1|3 method=direct|krylov th=1e-3|1e-2|0.1|1|10|100|1e3", 1e-2, 0, 0},
    {"shape=bumpy/1/3 op=fem|vor|cot query=entries kernel=operator|symmetric k=16 method=direct|krylov th=1|10|100|1e3", 1e-2, 0, 0},
    {"shape=torus/9/7|flat/9/7/0.35|two/1/0/4|inert/7/1|jumble/60/130/5 op=fem|vor|cot query=column|apply k=1|3 method=direct|krylov th=1e-3|0.1|1|100|1e3", 1e-2, 0, 0},
    {"shape=leak/40/0.01|penalty/40/0 op=I|diag query=column|apply kernel=operator|symmetric k=1|3 method=direct|krylov th=1e-3|0.1|1|10|100", 1e-2, 0, 0},
    /* packs that are full, and those with one, two, three poles or a lone real one left over */
    {"shape=bumpy/1/9 op=fem query=column|apply k=1|3 method=direct poles=uniform|kernel degree=3|4|5|6|7|8|9|10|11|12|13|14 th=3|300", 0.2, 0, 17},
    {"shape=two/1/0/4 op=fem|vor query=column|apply k=1|3 own=packs method=direct th=1|30|900 x=0|1|2|3|4|5|6|7|8|9|10|11", 1e-2, 0, 0},
    {"shape=leak/40/0.01 op=I query=column|apply k=1|3 own=packs method=direct th=1|30 x=0|1|2|3|4|5|6|7|8|9|10|11", 1e-2, 0, 0},
    /* any number of columns */
    {"shape=inert/5/1|flat/8/5/0.3 op=fem query=column|apply method=direct|krylov th=6 k=1|2|3|4|5|6|7|8|9|10|11|12|13|14|15|16|17|24|25|30", 1e-4, 0, 0},
    /* many times, in order and not, of a field (classical) and of a column (weighted) */
    {"shape=inert/5/1 op=fem|vor query=times kind=classical|weighted seed=1|2 method=auto|iterative|direct|krylov th=0.01 times=1|4|7|10|13|19 span=1|100|1e4|1e6", 1e-2, 0, 0},
    {"shape=leak/40/0.01 op=diag query=times kind=classical|weighted seed=1|2 method=auto|iterative|direct|krylov th=0.01 times=7|19 span=100|1e6", 1e-2, 0, 0},
};

static void eng_against_truth(void) {
    CASES(eng_values);
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
        CHECK_MSG((rep->residual > 0) <= (rep->error_rounding > 0) && rep->evidence_solver == (pairs ? HD_EVIDENCE_ESTIMATED : HD_EVIDENCE_NONE),
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

/* Meshes that are too large for the oracle: the methods agree, iterations among them, within what they say. */
static void eng_large(void) {
    enum { K = 9 };
    shape ball = kit_own_shape(shape_bumpy(4, 2)), grid = kit_own_shape(shape_grid(60, 45, 0.3));
    int q, k, z;
    for (q = 0; q < 2; q++) {
        const shape *s = q ? &grid : &ball;
        hd_laplacian *lap = kit_triangles(s, op_kinds[q]);
        const int32_t n = s->n;
        const double t = 15 * lap->h * lap->h, times[3] = {t, 30 * t, 5 * t};
        double *F = KIT_NEW(double, K * n), *want = KIT_NEW(double, K * n), *u = KIT_NEW(double, K * n), *all = KIT_NEW(double, 3 * n);
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
        }
    }
}

/* Fronts of hundreds of rows, and batches next to each other: few, then many columns, against single ones and the other method. */
static void eng_batches(void) {
    enum { K = 26 };
    shape s = kit_own_shape(trial_jumble(900, 2700, 6));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_VORONOI_COT);
    hd_heat *direct = eng_plan(lap, HD_METHOD_DIRECT, HD_POLES_DEFAULT, 0), *krylov = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
    const double t = 3 * lap->h * lap->h;
    const int32_t n = s.n;
    double *u = KIT_NEW(double, K * n), *v = KIT_NEW(double, K * n), *first = KIT_NEW(double, K * n);
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
}

/* ---- sets of poles ---- */

/* Every number of poles and every mixture of real ones: reports, and a set that is copied. */
static void eng_sets(void) {
    hd_laplacian *lap = kit_pair("bumpy/1/9 fem");
    double *u = KIT_NEW(double, lap->n);
    hd_report rep;
    int kind, k;
    for (kind = HD_POLES_UNIFORM; kind <= HD_POLES_KERNEL; kind++)
        for (k = kind == HD_POLES_UNIFORM ? 1 : 2; k <= 14; k++) {
            hd_heat *heat = eng_plan(lap, HD_METHOD_DIRECT, (hd_pole_kind)kind, k);
            CHECK(heat_column(heat, 3 * lap->h * lap->h, 5, u, &rep) >= 0);
            CHECK_MSG(rep.degree == k && rep.n_poles == (k + 1) / 2 && rep.poles == (hd_pole_kind)kind, "degree %d of %d", (int)rep.degree, k);
            CHECK_MSG(rep.residual < 1e-12, "degree %d: residual %g", k, rep.residual);
        }
    for (k = 0; k < TRIAL_PACKS; k++) {
        hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
        hd_rational set = eng_own_set(k);
        const hd_rational kept = set;
        hd_heat *heat;
        o.rational = &set;
        heat = kit_plan(lap, &o);
        memset(&set, 0x55, sizeof set);          /* it was copied */
        CHECK(eng_ok(heat_column(heat, lap->h * lap->h, 3, u, &rep), &rep, "own set"));
        CHECK(rep.poles == HD_POLES_OWN && rep.n_poles == kept.n_poles && rep.degree == kept.degree && rep.error_rational == 0);
        CHECK_MSG(rep.mass_drift == 0 && rep.method == HD_METHOD_DIRECT, "set %d: drift %g", k, rep.mass_drift);
    }
}

/* What the report of a method says, of columns, fields and entries, early and late. */
static void eng_reports(void) {
    hd_laplacian *lap = kit_pair("bumpy/1/3 fem"), *held = kit_pair("bump/6/1 fem+held");
    double *u = KIT_NEW(double, lap->n), *f = kit_random(lap->n, 12);
    int k, q;
    for (k = 0; k < 2; k++)
        for (q = 0; q < 12; q++) {
            hd_laplacian *on = q % 2 ? held : lap;
            hd_heat *heat = eng_plan(on, eng_methods[k], HD_POLES_DEFAULT, 0);
            const double t = (q < 6 ? 1 : 20) * on->h * on->h;
            const int32_t source = on->vertex[on->n_active / 3], i[2] = {on->vertex[0], on->vertex[3]}, j[2] = {source, on->vertex[1]};
            hd_report rep;
            if (q % 6 < 2) CHECK(eng_ok(heat_column(heat, t, source, u, &rep), &rep, "report"));
            else if (q % 6 < 4) CHECK(eng_ok(heat_apply(heat, t, 1, f, 0, u, 0, &rep), &rep, "report"));
            else CHECK(eng_ok(heat_entries(heat, t, HD_KERNEL_OPERATOR, 2, i, j, u, &rep), &rep, "report"));
            eng_check_report(&rep, eng_methods[k], "report");
            CHECK(rep.error_bound >= rep.error_rational && rep.error_bound >= rep.error_solver && rep.error_bound >= rep.error_rounding);
            if (q % 6 < 4) CHECK(rep.evidence_b != HD_EVIDENCE_NONE && rep.evidence_rounding != HD_EVIDENCE_NONE);
        }
}

/* ---- many right-hand sides ---- */

/* In place, with padded columns, repeats, and sources without mass: nothing else is written, and entries have the bits of columns. */
static void eng_counts_of(const hd_laplacian *lap, hd_method method) {
    enum { MOST = 30, PAD = 3 };
    const int32_t n = lap->n, ld = n + PAD;
    const double t = 6 * lap->h * lap->h, near = method == HD_METHOD_DIRECT ? 1e-12 : 1e-8;
    double *U = KIT_NEW(double, MOST * ld), *F = kit_random(MOST * ld, 5), *u = KIT_NEW(double, n), values[MOST];
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_heat_opts o = eng_opts(method);
    hd_heat *heat;
    hd_report rep;
    int32_t sources[MOST], rows[MOST], k, q, i;
    o.context = &ctx;
    heat = eng_create(lap, &o);
    for (q = 0; q < MOST; q++) {
        sources[q] = q % 4 == 3 ? sources[q - 2] : q * 7 % n;
        rows[q] = lap->vertex[q * 37 % lap->n_active];
    }
    for (k = 1; k <= MOST; k += 1 + k / 4) {
        const hd_kernel kernel = k % 2 ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        for (i = 0; i < MOST * ld; i++) U[i] = 1234;
        if (!eng_ok(heat_columns(heat, t, kernel, k, sources, U, (size_t)ld, &rep), &rep, "counts")) continue;
        for (q = 0; q < k; q++) {
            const int inert = lap->row[sources[q]] < 0;
            for (i = 0; i < n; i++) CHECK((!inert && lap->row[i] >= 0) || U[q * ld + i] == (inert && kernel == HD_KERNEL_OPERATOR && i == sources[q]));
            for (i = n; i < ld; i++) CHECK(U[q * ld + i] == 1234);
        }
        for (i = k * ld; i < MOST * ld; i++) CHECK(U[i] == 1234);
        CHECK(heat_columns(heat, t, kernel, 1, sources + k - 1, u, 0, NULL) >= 0);
        CHECK_MSG(dense_max_diff(u, U + (k - 1) * ld, n) <= near * dense_max_abs(u, n), "%s: the last of %d columns differs from a call of its own",
                  eng_name(method), (int)k);
        CHECK(heat_entries(heat, t, kernel, k, rows, sources, values, NULL) >= 0);
        for (q = 0; q < k; q++) CHECK(fabs(values[q] - U[q * ld + rows[q]]) <= 1e-8 * dense_max_abs(U + q * ld, n));
        memcpy(U, F, (size_t)(MOST * ld) * sizeof *U);
        CHECK(heat_apply(heat, t, k, U, (size_t)ld, U, (size_t)ld, &rep) >= 0);
        for (q = 0; q < k; q++) {
            for (i = 0; i < n; i++) CHECK(lap->row[i] >= 0 || U[q * ld + i] == F[q * ld + i]);
            CHECK(memcmp(U + q * ld + n, F + q * ld + n, PAD * sizeof *U) == 0);
            CHECK(heat_apply(heat, t, 1, F + q * ld, 0, u, 0, NULL) >= 0);
            CHECK(dense_max_diff(u, U + q * ld, n) <= near * dense_max_abs(u, n));
        }
    }
    memset(&rep, 0x77, sizeof rep);
    CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, 0, NULL, NULL, 0, &rep) == HD_OK && rep.status == HD_OK && rep.error.status == HD_OK &&
          rep.iterations == 0);
    CHECK(heat_apply(heat, t, 0, NULL, 0, NULL, 0, &rep) == HD_OK && rep.status == HD_OK);
    CHECK(heat_entries(heat, t, HD_KERNEL_SYMMETRIC, 0, NULL, NULL, NULL, &rep) == HD_OK && rep.status == HD_OK);
    hd_heat_free(heat);
    test_memory_done(&m, &ctx, "counts");
}

/* Sources that are all without mass, and fields of nothing but zeros or constants. */
static void eng_nothing_to_do(const hd_laplacian *lap, hd_method method) {
    const int32_t n = lap->n, inert[3] = {0, 5, 0};
    hd_heat *heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
    const double t = lap->h * lap->h;
    double *u = KIT_NEW(double, 9 * n), *f = KIT_NEW(double, 9 * n);
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
}

static void eng_counts(void) {
    shape inert = kit_own_shape(trial_spare(shape_icosphere(1)));
    hd_laplacian *lap = kit_triangles(&inert, HD_LAPLACIAN_FEM), *grid = kit_pair("flat/8/5/0.3 vor");
    int k;
    for (k = 0; k < 2; k++) {
        eng_counts_of(lap, eng_methods[k]);
        eng_nothing_to_do(lap, eng_methods[k]);
        eng_counts_of(grid, eng_methods[k]);
    }
}

/* ---- plans used again ---- */

typedef struct eng_call { double t; int32_t k; int task; } eng_call;    /* task 0, 1: columns of the kernels, 2: fields, 3: entries, 4: times */

static hd_status eng_do(hd_heat *heat, const hd_laplacian *lap, const eng_call *call, double *u, hd_report *rep) {
    const int32_t n = lap->n;
    double *f = KIT_NEW(double, call->k * n), times[3];
    int32_t *sources = KIT_NEW(int32_t, call->k), i;
    hd_status st;
    for (i = 0; i < call->k; i++) sources[i] = lap->vertex[i * 5 % lap->n_active];
    for (i = 0; i < call->k * n; i++) f[i] = sin(i);
    for (i = 0; i < 3; i++) times[i] = call->t * (1 + i);
    if (call->task == 2) st = heat_apply(heat, call->t, call->k, f, 0, u, 0, rep);
    else if (call->task == 3) st = heat_entries(heat, call->t, HD_KERNEL_OPERATOR, call->k, sources, sources, u, rep);
    else if (call->task == 4) st = heat_times(heat, 3, times, HD_KERNEL_SYMMETRIC, sources[0], NULL, u, 0, rep);
    else st = heat_columns(heat, call->t, call->task ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, call->k, sources, u, 0, rep);
    return st;
}

/* One plan for calls of all sorts: what it remembers does not show. */
static void eng_reuse_of(const hd_laplacian *lap, hd_heat_opts *o, const char *what) {
    static const eng_call calls[16] = {{3, 1, 0}, {3, 1, 0}, {3, 7, 0}, {3, 1, 2}, {3, 1, 1}, {50, 1, 2}, {50, 13, 2}, {3, 5, 3}, {0, 2, 2},
        {2, 1, 0}, {3, 2, 1}, {0, 2, 1},
                                       {1e3, 1, 0}, {3, 1, 4}, {3, 1, 0}, {70, 25, 0}};
    const size_t size = (size_t)(25 * lap->n) * sizeof(double);
    double *u = KIT_NEW(double, 25 * lap->n), *want = KIT_NEW(double, 25 * lap->n);
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
}

static void eng_reuse(void) {
    shape s = kit_own_shape(shape_bumpy(2, 8));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
    hd_rational set = eng_own_set(3);
    eng_reuse_of(lap, &o, "direct");
    o.degree = 11;
    eng_reuse_of(lap, &o, "direct 11");
    o.degree = 0;
    o.rational = &set;
    eng_reuse_of(lap, &o, "own set");
    o = eng_opts(HD_METHOD_KRYLOV);
    eng_reuse_of(lap, &o, "krylov");
    o = eng_opts(HD_METHOD_AUTO);
    eng_reuse_of(lap, &o, "auto");
}

/* A plan that goes from poles to shift-and-invert Lanczos and back: the same answers every time. */
static void eng_switch(void) {
    enum { K = 40, TIMES = 40 };
    shape s = kit_own_shape(shape_bumpy(3, 7));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    const hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_heat *heat = kit_plan(lap, &o);
    double *first = KIT_NEW(double, (K + TIMES) * s.n), *u = KIT_NEW(double, (K + TIMES) * s.n), times[TIMES];
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
}

/* ---- many times ---- */

/* Zeros among the times, the same time twice, rows of vertices without mass; nothing is written beside the columns. */
static void eng_times(void) {
    static const double all[5][7] = {{5, 0.5, 80, 5, 20, 0.5, 11}, {3, 0, 40, -0.0, 1}, {7}, {0, 0}, {4, 4, 4}};
    static const int32_t counts[5] = {7, 5, 1, 2, 3};
    enum { PAD = 2 };
    shape s = kit_own_shape(trial_spare(shape_icosphere(1)));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_VORONOI_COT);
    const int32_t n = lap->n, ld = n + PAD, source = lap->vertex[lap->n_active / 2];
    double *U = KIT_NEW(double, 8 * ld), *u = KIT_NEW(double, n), *f = kit_random(n, 3), times[7];
    hd_report rep, one;
    int method, q, z, k, i, e;
    for (method = HD_METHOD_AUTO; method <= HD_METHOD_KRYLOV; method++) {
        hd_heat *heat = eng_plan(lap, (hd_method)method, HD_POLES_DEFAULT, 0);
        for (z = 0; z < 5; z++)
            for (k = 0; k < 3; k++) {            /* the column of either kernel, and a field */
                const hd_kernel kernel = k == 1 ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
                for (i = 0; i < counts[z]; i++) times[i] = all[z][i] * lap->h * lap->h;
                for (i = 0; i < 8 * ld; i++) U[i] = 4321;
                if (!eng_ok(heat_times(heat, counts[z], times, kernel, source, k == 2 ? f : NULL, U, (size_t)ld, &rep), &rep, "times")) continue;
                CHECK((method == HD_METHOD_AUTO || rep.method == (hd_method)method) && rep.reason && rep.reason[0]);
                for (q = 0; q < counts[z]; q++) {
                    const double *column = U + q * ld;
                    CHECK(eng_ok(heat_times(heat, 1, times + q, kernel, source, k == 2 ? f : NULL, u, 0, &one), &one, "times"));
                    CHECK_MSG(dense_max_diff(u, column, n) <= (rep.error_bound + one.error_bound + 1e-13) * dense_max_abs(u, n),
                              "%s, time %g: not as by a call of its own", eng_name((hd_method)method), times[q]);
                    if (times[q] == 0) CHECK(memcmp(u, column, (size_t)n * sizeof *u) == 0);
                    for (i = 0; i < n; i++) CHECK(lap->row[i] >= 0 || column[i] == (k == 2 ? f[i] : 0));
                    for (i = n; i < ld; i++) CHECK(column[i] == 4321);
                    for (e = 0; e < q; e++) CHECK(times[e] != times[q] || memcmp(U + e * ld, column, (size_t)n * sizeof *U) == 0);
                }
                for (i = counts[z] * ld; i < 8 * ld; i++) CHECK(U[i] == 4321);
            }
        CHECK(heat_times(heat, 0, NULL, HD_KERNEL_OPERATOR, source, NULL, u, 0, &rep) == HD_ERR_ARGUMENT);
    }
}

/* Columns of two batches at times over five decades, one source without mass among them, against calls for one column
 * and one time, which begin with the field. */
static void eng_times_columns_of(const hd_laplacian *lap, double unit, const char *what) {
    enum { COLUMNS = 10, TIMES = 16 };
    hd_heat *heat = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
    const int32_t n = lap->n;
    double times[TIMES], *U = KIT_NEW(double, COLUMNS * TIMES * n), *u = KIT_NEW(double, n);
    int32_t sources[COLUMNS], c, q;
    hd_report rep, one;
    for (c = 0; c < COLUMNS; c++) sources[c] = (3 + 7 * c) % n;
    for (q = 0; q < TIMES; q++) times[q] = unit * 0.1 * pow(1e5, q / (TIMES - 1.0));
    if (eng_ok(hd_heat_columns(heat, HD_KERNEL_OPERATOR, TIMES, times, VERTICES(COLUMNS, sources), U, 0, &rep, NULL), &rep, what)) {
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
}

static void eng_times_columns(void) {
    shape s = kit_own_shape(trial_spare(shape_icosphere(2)));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    eng_times_columns_of(lap, lap->h * lap->h, "columns and times");
    lap = eng_leaking(12, 9);
    eng_times_columns_of(lap, 0.02, "columns and times, leaking");
}

/* A source without mass at many times. */
static void eng_times_inert(void) {
    shape s = kit_own_shape(trial_spare(shape_icosphere(0)));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    const double times[3] = {0.3, 0.1, 0.2};
    double *u = KIT_NEW(double, 3 * s.n);
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
        }
    }
}

/* ---- threads and instructions ---- */

/* What a plan answers in one way of threading: a column, columns of several batches, fields, times; all into out. */
static int64_t eng_thread_run(const shape *s, hd_laplacian_kind kind, hd_heat_opts o, hd_simd simd, int way, double *out, hd_report *rep) {
    static const int32_t counts[3] = {1, 6, 15};
    ldl_way *w = KIT_NEW(ldl_way, 1);
    const int32_t n = s->n;
    double *f = KIT_NEW(double, 15 * n), times[3];
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
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, n, s->tri, s->n_tri), &lo, NULL) == HD_OK);
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
    return calls;
}

static int eng_same_report(const hd_report *a, const hd_report *b) {
    return a->method == b->method && a->solver == b->solver && a->iterations == b->iterations && a->degree == b->degree && a->n_poles == b->n_poles &&
           a->residual == b->residual && a->error_bound == b->error_bound && a->error_bound_b == b->error_bound_b && a->growth == b->growth &&
           a->factor_nnz == b->factor_nnz && a->factor_flops == b->factor_flops && a->mass_drift == b->mass_drift && a->ordering == b->ordering;
}

static void eng_threads_of(const shape *s, hd_laplacian_kind kind, hd_heat_opts o, const char *what) {
    const int64_t size = 75 * (int64_t)s->n;
    double *top = KIT_NEW(double, size), *first = KIT_NEW(double, size), *other = KIT_NEW(double, size);
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
}

static void eng_threads(void) {
    shape ball = kit_own_shape(shape_bumpy(3, 6)), soup = kit_own_shape(trial_jumble(600, 1200, 4));
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
        hd_laplacian *lap = kit_triangles(&s, op_kinds[q]);
        double *f = KIT_NEW(double, s.n), *u = KIT_NEW(double, s.n), mean[2];
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
        }
    }
}

/* ---- what reports and progress tell ---- */

/* A tolerance that rounding does not allow is told, by one call and by many times whichever comes first. */
static void eng_warnings(void) {
    static const double when[2][2] = {{1e-3, 1e4}, {1e4, 1e-3}};
    shape s = kit_own_shape(shape_icosphere(1));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    double *u = KIT_NEW(double, 2 * s.n), times[2], rest;
    int k, q, z, tol, seen[2] = {0, 0};
    for (k = 0; k < 2; k++) {
        for (tol = 9; tol <= 17; tol++) {
            for (z = 0; z < 2; z++) {
                hd_heat_opts o = eng_opts(eng_methods[k]);
                hd_status st, worst = HD_OK;
                hd_heat *heat;
                hd_report rep;
                o.tol = pow(10, -tol);
                heat = kit_plan(lap, &o);
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
            }
        }
    }
    CHECK_MSG((seen[0] & 1) && seen[1] == 3, "no warnings %d, nothing but warnings %d", seen[0], seen[1]);
}

/* The degree that one of the fields needs serves all; the time that failed is told. */
static void eng_told(void) {
    shape s = kit_own_shape(shape_icosphere(1));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_VORONOI_COT);
    const double t = lap->h * lap->h, times[3] = {1e-9 * t, 500 * t, 1e-8 * t};
    const int32_t n = s.n;
    double *F = KIT_NEW(double, 2 * n), *u = KIT_NEW(double, 3 * n), mean = 0;
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
        rob_watch(&p, &ctx, 0);
        o = eng_opts(eng_methods[k]);
        o.context = &ctx;
        heat = eng_create(lap, &o);
        CHECK(heat_column(heat, t, 3, u, NULL) >= 0);
        CHECK_MSG(p.solving > 0 && p.calls > p.solving + 2, "%s: progress is called %lld times, %lld while solving", eng_name(eng_methods[k]),
            (long long)p.calls,
            (long long)p.solving);
        hd_heat_free(heat);
    }
}

/* ---- orders of elimination ---- */

static void eng_orderings(void) {
    static const hd_ordering kinds[5] = {HD_ORDERING_AUTO, HD_ORDERING_MINIMUM_DEGREE, HD_ORDERING_NESTED_DISSECTION, HD_ORDERING_OWN,
        HD_ORDERING_OWN};
    shape s = kit_own_shape(trial_spare(shape_bumpy(2, 8)));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    const int32_t n = s.n, sources[4] = {1, 0, 77, 1};
    const double t = 10 * lap->h * lap->h;
    int32_t *perm = KIT_NEW(int32_t, n), *rows = KIT_NEW(int32_t, n), i, m;
    double *first = KIT_NEW(double, 4 * n), *u = KIT_NEW(double, 4 * n);
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
            heat = kit_plan(lap, &o);
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
        }
    }
}

/* What is not a permutation is told with its place. */
static void eng_bad_perms(void) {
    shape s = kit_own_shape(trial_spare(shape_icosphere(0)));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    const int32_t n = s.n;
    int32_t *perm = KIT_NEW(int32_t, n), i, twice = 3;
    double *u = KIT_NEW(double, n);
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
}

/* ---- the choice ---- */

static hd_method eng_chosen(const hd_laplacian *lap, const hd_heat_opts *o, double t, int32_t k, int times, const char *reason) {
    hd_heat *heat = kit_plan(lap, o);
    double *u = KIT_NEW(double, (times ? times : k) * lap->n), *at = KIT_NEW(double, times + 1);
    int32_t *sources = KIT_NEW(int32_t, k), i;
    hd_report rep;
    for (i = 0; i < k; i++) sources[i] = i * 3 % lap->n;
    for (i = 0; i < times; i++) at[i] = t * (1 + i);
    if (times) CHECK(heat_times(heat, times, at, HD_KERNEL_OPERATOR, 3, NULL, u, 0, &rep) >= 0);
    else CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, k, sources, u, 0, &rep) >= 0);
    CHECK(rep.method != HD_METHOD_AUTO);
    CHECK_MSG(rep.reason && (!reason || strstr(rep.reason, reason)), "%s: %s", eng_name(rep.method), rep.reason ? rep.reason : "no reason");
    return rep.method;
}

static void eng_choice(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    hd_laplacian *fem = kit_triangles(&s, HD_LAPLACIAN_FEM), *voronoi = kit_triangles(&s, HD_LAPLACIAN_VORONOI_COT);
    const double hh = fem->h * fem->h;
    const hd_heat_opts none = eng_opts(HD_METHOD_AUTO);
    hd_rational set = eng_own_set(3);
    hd_heat_opts o;
    hd_heat *heat;
    hd_report rep;
    double *u = KIT_NEW(double, s.n);
    int k;
    CHECK(eng_chosen(voronoi, &none, 0.01 * hh, 1, 0, "iterations") == HD_METHOD_ITERATIVE);    /* far from where they cost the same */
    CHECK(eng_chosen(fem, &none, 300 * hh, 64, 0, "the poles cost least") == HD_METHOD_DIRECT);
    CHECK(eng_chosen(fem, &none, 5 * hh, 1, 40, "one real factor") == HD_METHOD_KRYLOV);
    for (k = 0; k < 4; k++) {                    /* poles that are asked for are not passed over */
        o = none;
        if (k == 0) o.poles = HD_POLES_KERNEL;
        if (k == 1) o.degree = 6;
        if (k == 2) o.rational = &set;
        if (k == 3) o.poles = HD_POLES_UNIFORM;
        CHECK(eng_chosen(fem, &o, 5 * hh, 1, 20, NULL) != HD_METHOD_KRYLOV);
        CHECK(eng_chosen(fem, &o, 300 * hh, 64, 0, NULL) == HD_METHOD_DIRECT);
    }
    for (k = 0; k < 5; k++) {                    /* nor solvers and preconditioners */
        o = none;
        if (k < 3) o.solver = k == 0 ? HD_SOLVER_COCG : k == 1 ? HD_SOLVER_MINRES : HD_SOLVER_LANCZOS;
        else o.precond = k == 3 ? HD_PRECOND_JACOBI : HD_PRECOND_MILDL;
        CHECK(eng_chosen(fem, &o, 3 * hh, 8, 0, "asked") == HD_METHOD_ITERATIVE);
        CHECK(eng_chosen(fem, &o, hh, 1, 4, "asked") == HD_METHOD_ITERATIVE);
    }
    for (k = 1; k < 4; k++) {
        o = eng_opts((hd_method)k);
        CHECK(eng_chosen(fem, &o, 2 * hh, 2, 0, "asked") == (hd_method)k);
        CHECK(eng_chosen(voronoi, &o, 20 * hh, 1, 3, "asked") == (hd_method)k);
    }
    heat = kit_plan(fem, &none);
    CHECK(heat_column(heat, 0, 3, u, &rep) == HD_OK && rep.method != HD_METHOD_AUTO && rep.reason && rep.factor_nnz == 0);
}

/* Whatever the limit is: when iterations fit into it, there is an answer; twice the same call is twice the same method. */
static void eng_choice_limits_of(const hd_laplacian *lap, double t, int32_t k) {
    double *u = KIT_NEW(double, k * lap->n), *want = KIT_NEW(double, k * lap->n);
    int32_t *sources = KIT_NEW(int32_t, k), i;
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
}

static void eng_choice_limits(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    int q;
    for (q = 0; q < 2; q++) {
        hd_laplacian *lap = kit_triangles(&s, op_kinds[q]);
        eng_choice_limits_of(lap, 40 * lap->h * lap->h, 1);
        eng_choice_limits_of(lap, 4 * lap->h * lap->h, 9);
    }
}

/* A plan that once had to do without factors takes them again when there is room: the same bits as a new one. */
static void eng_limit_lifted(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
    const double t = 40 * lap->h * lap->h;
    double *u = KIT_NEW(double, lap->n), *want = KIT_NEW(double, lap->n);
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
    CHECK(eng_ok(heat_column(heat, t, 7, u, &rep), &rep, "limit") && rep.method == HD_METHOD_ITERATIVE && strcmp(rep.reason, "asked for") != 0);
    ctx.byte_limit = 0;
    CHECK(eng_ok(heat_column(heat, t, 7, u, &rep), &rep, "limit lifted") && rep.method != HD_METHOD_ITERATIVE);
    CHECK(memcmp(u, want, (size_t)lap->n * sizeof *u) == 0);
    hd_heat_free(heat);
}

/* ---- errors ---- */

static void eng_no_coordinates(void) {
    hd_laplacian *own = eng_leaking(4, 3);
    int32_t perm[12];
    double u[12];
    hd_heat *heat = NULL;
    hd_heat_opts o;
    hd_report rep;
    hd_error e;
    int k, q;
    for (k = 0; k < 12; k++) {
        perm[k] = k;
        u[k] = 1;
    }
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
}

/* ---- memory and cancelling ---- */

/* The same field again takes the same number of iterations, and finds the same bits: nothing is left of the first, in calls nor within one. */
static void eng_again(void) {
    enum { FIELDS = 40 };
    static const hd_method methods[3] = {HD_METHOD_ITERATIVE, HD_METHOD_ITERATIVE, HD_METHOD_KRYLOV};
    shape ball = kit_own_shape(shape_icosphere(2));
    hd_laplacian *lap = kit_triangles(&ball, HD_LAPLACIAN_FEM);
    double *F = KIT_NEW(double, FIELDS * (int64_t)ball.n), *u = KIT_NEW(double, FIELDS * (int64_t)ball.n);
    uint64_t seed = 5;
    int32_t k, v;
    for (v = 0; v < ball.n; v++) F[v] = dense_signed(&seed);
    for (v = 1; v < FIELDS; v++) memcpy(F + v * ball.n, F, (size_t)ball.n * sizeof *F);
    for (k = 0; k < 3; k++) {
        hd_heat_opts o = eng_opts(methods[k]);
        hd_report rep[2];
        hd_heat *heat;
        if (k == 1) o.solver = HD_SOLVER_COCG;   /* pole by pole; else Lanczos */
        heat = kit_plan(lap, &o);
        for (v = 0; v < 2; v++) CHECK(heat_apply(heat, 3 * lap->h * lap->h, 1, F, 0, u + v * ball.n, 0, rep + v) >= 0);
        CHECK_MSG(rep[0].iterations > 0 && rep[1].iterations == rep[0].iterations, "%lld iterations, then %lld", (long long)rep[0].iterations,
                  (long long)rep[1].iterations);
        CHECK(memcmp(u, u + ball.n, (size_t)ball.n * sizeof *u) == 0);
        CHECK(heat_apply(heat, 3 * lap->h * lap->h, FIELDS, F, 0, u, 0, rep + 1) >= 0);
        CHECK_MSG(rep[1].iterations == FIELDS * rep[0].iterations, "%lld iterations for %d fields, %lld for one", (long long)rep[1].iterations, (int)FIELDS, (long long)rep[0].iterations);
        for (v = 1; v < FIELDS; v++) CHECK(memcmp(u, u + v * ball.n, (size_t)ball.n * sizeof *u) == 0);
    }
}

/* Rounding of krylov's solves is measured at every field: constants, which it does not enter, may stand anywhere. */
static void eng_constant_first(void) {
    enum { K = 6 };
    shape s = kit_own_shape(shape_grid(12, 10, 0.3));
    const double t = 0.1;
    hd_laplacian *lap;
    double *f = KIT_NEW(double, K * (int64_t)s.n), *u = KIT_NEW(double, K * (int64_t)s.n), rounding[2];
    uint64_t seed = 3;
    int32_t v, last;
    for (v = 0; v < s.n; v++) s.xyz[3 * v + 1] *= 1e-3;      /* slivers, where solves round much */
    lap = kit_triangles(&s, HD_LAPLACIAN_VORONOI_COT);
    for (v = 0; v < K * s.n; v++) f[v] = dense_signed(&seed);
    for (last = 0; last < 2; last++) {
        hd_heat *heat = eng_plan(lap, HD_METHOD_KRYLOV, HD_POLES_DEFAULT, 0);
        hd_report rep;
        double *one = last ? f + (K - 1) * s.n : f;
        if (last) memcpy(f, one, (size_t)s.n * sizeof *f);   /* the same fields */
        for (v = 0; v < s.n; v++) one[v] = 1;
        CHECK(hd_heat_apply(heat, 1, &t, K, f, 0, u, 0, &rep, NULL) >= 0 && rep.evidence_rounding == HD_EVIDENCE_ESTIMATED);
        rounding[last] = rep.error_rounding;
    }
    CHECK_MSG(fabs(rounding[0] - rounding[1]) <= 1e-6 * rounding[0], "rounding %g with the constant first, %g with it last", rounding[0], rounding[1]);
}

static void test_engines(void) {
    eng_against_truth();
    eng_reports();
    eng_large();
    eng_batches();
    eng_sets();
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
    eng_limit_lifted();
    eng_no_coordinates();
}

#endif
