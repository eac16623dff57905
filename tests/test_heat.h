/* test_heat.h - K_t f, columns and entries: against dense eigensolutions, closed forms, and the identities of heat */

#ifndef TEST_HEAT_H
#define TEST_HEAT_H

/* ---- the oracle: a Laplacian with its dense eigensolution ---- */

typedef struct heat_case {
    hd_laplacian *lap;
    dense_pair pair;
    double top;                  /* largest eigenvalue */
    const char *what;
} heat_case;

static heat_case heat_case_of(hd_laplacian *lap, const char *what) {
    heat_case c;
    c.lap = lap;
    c.what = what;
    CHECK(dense_pair_solve(&c.pair, test_dense(&lap->L, NULL), test_dense_mass(lap), lap->n_active));
    c.top = dense_max_abs(c.pair.lambda, lap->n_active);
    return c;
}

static void heat_case_free(heat_case *c) {
    dense_pair_free(&c->pair);
    hd_laplacian_free(c->lap);
}

/* How a case is to be computed. */
static hd_heat *heat_plan(const hd_laplacian *lap, hd_solver solver, hd_pole_kind poles, int32_t degree, double tol) {
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.solver = solver;
    o.poles = poles;
    o.degree = degree;
    o.tol = tol;
    CHECK_MSG(hd_heat_create(&heat, lap, &o, &e) == HD_OK, "%s", e.text);
    return heat;
}

static const char *heat_solver_name(hd_solver s) {
    static const char *const names[5] = {"auto", "cocg", "cocr", "minres", "lanczos"};
    return names[s];
}

/* Is u what the report says it is? rhs is B f on rows; u on vertices. */
static void heat_judge(const heat_case *c, double t, const double *rhs, const double *u, const hd_report *rep) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    double *want = DENSE_NEW(double, n), *diff = DENSE_NEW(double, n), *f = DENSE_NEW(double, n), off_b, size_b, f_b, off, size = 0, slack;
    int32_t i;
    dense_pair_heat(&c->pair, t, rhs, want);
    dense_pair_heat(&c->pair, 0, rhs, f);
    for (i = 0; i < n; i++) {
        diff[i] = u[lap->vertex[i]] - want[i];
        size = fmax(size, fabs(u[lap->vertex[i]]));
    }
    off_b = dense_pair_norm(&c->pair, diff);
    size_b = dense_pair_norm(&c->pair, want);
    f_b = dense_pair_norm(&c->pair, f);
    off = dense_max_abs(diff, n);
    /* rounding: of the library relative to f, of the oracle by eigenvalues that are off by an epsilon of the largest */
    slack = 3e-13 * f_b + 1e-15 * fmin(t * c->top, 1e4) * f_b;
    CHECK_MSG(off_b <= rep->error_bound_b * size_b + slack, "%s, %s, poles %d degree %d, t/h2 %g: error %g, bound %g (B norm)", c->what,
              heat_solver_name(rep->solver), (int)rep->poles, (int)rep->degree, t, off_b / size_b, rep->error_bound_b);
    slack *= 2 * sqrt(n / lap->area);
    CHECK_MSG(off <= rep->error_bound * size + slack, "%s, %s, poles %d degree %d, t %g: error %g, bound %g (maximum)", c->what,
              heat_solver_name(rep->solver), (int)rep->poles, (int)rep->degree, t, off / size, rep->error_bound);
    CHECK_MSG(rep->mass_drift <= 1e-12, "%s: mass drift %g", c->what, rep->mass_drift);
    CHECK(rep->error_bound >= rep->error_rational && rep->error_bound >= rep->error_solver && rep->error_bound >= rep->error_rounding);
    CHECK(rep->evidence_b != HD_EVIDENCE_NONE && rep->error_relative == HUGE_VAL);
    free(want);
    free(diff);
    free(f);
}

/* B e_source on rows for the operator, e_source for the symmetric kernel. */
static void heat_source_rhs(const heat_case *c, int32_t vertex, hd_kernel kernel, double *rhs) {
    const int32_t n = c->lap->n_active, row = c->lap->row[vertex];
    int32_t i;
    for (i = 0; i < n; i++) rhs[i] = kernel == HD_KERNEL_SYMMETRIC ? i == row : c->pair.B[(size_t)i * (size_t)n + (size_t)row];
}

static void heat_field_rhs(const heat_case *c, const double *f, double *rhs) {
    double *rows = DENSE_NEW(double, c->lap->n_active);
    int32_t i;
    for (i = 0; i < c->lap->n_active; i++) rows[i] = f[c->lap->vertex[i]];
    dense_apply(c->pair.B, rows, rhs, c->lap->n_active);
    free(rows);
}

/* A column of each kernel and a rough and a smooth field, through one plan. */
static void heat_against_dense(const heat_case *c, hd_heat *heat, double t) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, source = lap->vertex[lap->n_active / 3];
    double *u = DENSE_NEW(double, 2 * n), *f = DENSE_NEW(double, 2 * n), *rhs = DENSE_NEW(double, lap->n_active);
    hd_report rep;
    uint64_t seed = 12;
    int32_t i;
    int k;
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        const hd_status st = heat_columns(heat, t, kernel, 1, &source, u, 0, &rep);
        if (!CHECK_MSG(st >= 0, "%s: %s", c->what, rep.error.text)) continue;
        heat_source_rhs(c, source, kernel, rhs);
        heat_judge(c, t, rhs, u, &rep);
    }
    for (i = 0; i < n; i++) {
        f[i] = dense_signed(&seed);
        f[n + i] = 2 + sin(0.3 * i);
    }
    for (k = 0; k < 2; k++) {
        if (!CHECK_MSG(heat_apply(heat, t, 1, f + k * n, 0, u, 0, &rep) >= 0, "%s: %s", c->what, rep.error.text)) continue;
        heat_field_rhs(c, f + k * n, rhs);
        heat_judge(c, t, rhs, u, &rep);
    }
    free(u);
    free(f);
    free(rhs);
}

/* Every solver with every kind of poles at every time; the degree turns with the time so that all are seen. */
static void heat_grid(const heat_case *c, double unit) {
    static const double times[6] = {0.3, 2, 30, 400, 3000, 1e4};
    static const hd_solver solvers[5] = {HD_SOLVER_AUTO, HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    static const hd_pole_kind kinds[3] = {HD_POLES_DEFAULT, HD_POLES_UNIFORM, HD_POLES_KERNEL};
    int s, k, q, turn = 0;
    for (s = 0; s < 5; s++) {
        for (k = 0; k < (s == 4 ? 1 : 3); k++) {
            for (q = 0; q < 6; q++) {
                const int32_t degree = k == 0 ? 0 : 2 + (turn++ * 5) % 13;
                hd_heat *heat = heat_plan(c->lap, solvers[s], kinds[k], degree, 0);
                heat_against_dense(c, heat, times[q] * unit);
                hd_heat_free(heat);
            }
        }
    }
}

static void heat_dense_cases(void) {
    const double offset[3] = {4, 0, 0};
    shape ball = shape_bumpy(1, 3), grid = shape_grid(8, 6, 0.35), two = shape_disjoint(&ball, &grid, offset);
    int q;
    for (q = 0; q < 3; q++) {
        heat_case c = heat_case_of(test_laplacian(&ball, op_kinds[q]), q == 0 ? "ball fem" : q == 1 ? "ball voronoi" : "ball cot");
        heat_grid(&c, q == 2 ? 1 : c.lap->h * c.lap->h);
        heat_case_free(&c);
        c = heat_case_of(test_laplacian(&two, op_kinds[q]), q == 0 ? "two fem" : q == 1 ? "two voronoi" : "two cot");
        heat_grid(&c, q == 2 ? 1 : c.lap->h * c.lap->h);
        heat_case_free(&c);
    }
    shape_free(&ball);
    shape_free(&grid);
    shape_free(&two);
}

/* All degrees of both kinds, where the rational error is what counts. */
static void heat_degrees(void) {
    shape s = shape_icosphere(1);
    heat_case c = heat_case_of(test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT), "degrees");
    int32_t r;
    int k;
    for (k = 0; k < 2; k++) {
        for (r = 1 + k; r <= 14; r++) {
            hd_heat *heat = heat_plan(c.lap, HD_SOLVER_COCG, k ? HD_POLES_KERNEL : HD_POLES_UNIFORM, r, 1e-13);
            double u[42];
            hd_report rep;
            CHECK(heat_column(heat, 3 * c.lap->h * c.lap->h, 5, u, &rep) >= 0 && rep.degree == r && rep.n_poles == (r + 1) / 2);
            CHECK(rep.poles == (k ? HD_POLES_KERNEL : HD_POLES_UNIFORM) && rep.method == HD_METHOD_ITERATIVE && rep.precond == HD_PRECOND_MILDL);
            heat_against_dense(&c, heat, 3 * c.lap->h * c.lap->h);
            hd_heat_free(heat);
        }
    }
    heat_case_free(&c);
    shape_free(&s);
}

/* A larger mesh (n = 294) with what most callers use: nothing but defaults, and bounds that are worth something. */
static void heat_defaults(void) {
    shape s = shape_torus(21, 14, 2, 0.8);
    int q, k;
    for (q = 0; q < 2; q++) {
        heat_case c = heat_case_of(test_laplacian(&s, op_kinds[q]), "torus");
        hd_heat *heat = heat_plan(c.lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        double *u = DENSE_NEW(double, s.n);
        for (k = 0; k < 3; k++) {
            const double t = pow(10, k) * c.lap->h * c.lap->h;
            int64_t sum = 0;
            hd_report rep;
            int32_t p;
            heat_against_dense(&c, heat, t);
            CHECK(heat_column(heat, t, 100, u, &rep) == HD_OK && rep.status == HD_OK && rep.error.status == HD_OK);
            CHECK_MSG(rep.error_bound_b < 1e-7 && rep.error_bound < 1e-5, "t %g: bounds %g, %g say little", t, rep.error_bound_b, rep.error_bound);
            CHECK(rep.reason != NULL && (rep.iterations > 0) == (rep.method != HD_METHOD_DIRECT));
            CHECK((rep.solver == HD_SOLVER_LANCZOS) == (rep.n_poles == 0));
            if (rep.method != HD_METHOD_ITERATIVE) continue;
            for (p = 0; p < rep.n_poles; p++) sum += rep.pole_iterations[p];
            CHECK(rep.n_poles == 0 || sum == rep.iterations);
        }
        CHECK(q == 0 ? 1 : c.lap->B == NULL);
        free(u);
        hd_heat_free(heat);
        heat_case_free(&c);
    }
    shape_free(&s);
}

/* ---- identities ---- */

/* The whole of a kernel, column by column. */
static double *heat_matrix(hd_heat *heat, int32_t n, double t, hd_kernel kernel) {
    double *k = DENSE_NEW(double, (int64_t)n * n);
    int32_t *sources = DENSE_NEW(int32_t, n), i;
    hd_report rep;
    for (i = 0; i < n; i++) sources[i] = i;
    CHECK(heat_columns(heat, t, kernel, n, sources, k, 0, &rep) >= 0);
    CHECK(rep.mass_drift < 1e-12);
    free(sources);
    return k;
}

static void heat_identities_of(const shape *s, hd_laplacian_kind kind) {
    hd_laplacian *lap = test_laplacian(s, kind);
    hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_KERNEL, 14, 1e-12);
    const int32_t n = lap->n;
    const double unit = kind == HD_LAPLACIAN_COT ? 1 : lap->h * lap->h, t = 3 * unit, t2 = 5 * unit;
    double *K = heat_matrix(heat, n, t, HD_KERNEL_OPERATOR), *S = heat_matrix(heat, n, t, HD_KERNEL_SYMMETRIC), *B = test_dense_mass(lap);
    double *K2 = heat_matrix(heat, n, t2, HD_KERNEL_OPERATOR), *K3 = heat_matrix(heat, n, t + t2, HD_KERNEL_OPERATOR);
    double asym = 0, semigroup = 0, adjoint = 0, mass = 0, relation = 0, top = dense_max_abs(S, (int64_t)n * n), btop = dense_max_abs(B, (int64_t)n * n);
    double *bk = DENSE_NEW(double, (int64_t)n * n), *f = DENSE_NEW(double, n), *u = DENSE_NEW(double, n);
    int32_t i, j;
    CHECK(lap->n_active == n);
    for (j = 0; j < n; j++) {
        double heat_in = lap->mass[j], heat_out = 0;
        dense_apply(B, K + (size_t)j * (size_t)n, bk + (size_t)j * (size_t)n, n);
        for (i = 0; i < n; i++) heat_out += bk[(size_t)j * (size_t)n + (size_t)i];
        mass = fmax(mass, fabs(heat_out - heat_in) / heat_in);
        CHECK(heat_apply(heat, t2, 1, K + (size_t)j * (size_t)n, 0, u, 0, NULL) >= 0);
        semigroup = fmax(semigroup, dense_max_diff(u, K3 + (size_t)j * (size_t)n, n));
        for (i = 0; i < n; i++) {                /* K = S B */
            double sum = 0;
            int32_t k;
            for (k = 0; k < n; k++) sum += S[(size_t)k * (size_t)n + (size_t)i] * B[(size_t)j * (size_t)n + (size_t)k];
            relation = fmax(relation, fabs(sum - K[(size_t)j * (size_t)n + (size_t)i]));
        }
    }
    for (i = 0; i < n; i++)
        for (j = 0; j < i; j++) {
            asym = fmax(asym, fabs(S[(size_t)i * (size_t)n + (size_t)j] - S[(size_t)j * (size_t)n + (size_t)i]));
            adjoint = fmax(adjoint, fabs(bk[(size_t)i * (size_t)n + (size_t)j] - bk[(size_t)j * (size_t)n + (size_t)i]));
        }
    CHECK_MSG(asym < 1e-9 * top, "kind %d: k_t not symmetric by %g", (int)kind, asym / top);
    CHECK_MSG(adjoint < 1e-9 * btop, "kind %d: B K_t not symmetric by %g", (int)kind, adjoint / btop);
    CHECK_MSG(semigroup < 1e-9, "kind %d: K_s K_t is not K_(s+t) by %g", (int)kind, semigroup);
    CHECK_MSG(mass < 1e-12, "kind %d: heat lost or made: %g", (int)kind, mass);
    CHECK_MSG(relation < 1e-9, "kind %d: K_t is not k_t B by %g", (int)kind, relation);
    for (i = 0; i < n; i++) f[i] = -3.25;
    CHECK(heat_apply(heat, 1000 * unit, 1, f, 0, u, 0, NULL) >= 0);
    CHECK_MSG(dense_max_diff(u, f, n) < 1e-13, "constants move by %g", dense_max_diff(u, f, n));
    free(K);
    free(S);
    free(B);
    free(K2);
    free(K3);
    free(bk);
    free(f);
    free(u);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

static void heat_identities(void) {
    shape s = shape_grid(8, 7, 0.3), b = shape_bumpy(1, 21);
    int q;
    for (q = 0; q < 3; q++) {
        heat_identities_of(&s, op_kinds[q]);
        heat_identities_of(&b, op_kinds[q]);
    }
    shape_free(&s);
    shape_free(&b);
}

/* Components exchange nothing, to the last bit; and each keeps its own heat. Their vertices are mixed in the numbering. */
static void heat_components_by(hd_laplacian *lap, hd_solver solver, double t, const int32_t *to, int32_t n_ball, const char *what) {
    hd_heat *heat = heat_plan(lap, solver, HD_POLES_DEFAULT, 0, 0);
    double *u = DENSE_NEW(double, lap->n), *f = DENSE_NEW(double, lap->n), in[2] = {0, 0}, out[2] = {0, 0};
    int32_t i, k, source, leaks;
    for (k = 0; k < 2; k++) {                    /* a source in each */
        for (source = 0; (to[source] >= n_ball) != k; source++) {}
        CHECK(heat_column(heat, t, source, u, NULL) >= 0);
        for (i = 0, leaks = 0; i < lap->n; i++) leaks += (to[i] >= n_ball) != k && u[i] != 0;
        CHECK_MSG(leaks == 0, "%s, %s: heat at %d vertices of another component", what, heat_solver_name(solver), (int)leaks);
        CHECK(u[source] > 0);
    }
    for (i = 0; i < lap->n; i++) f[i] = to[i] < n_ball ? 1 + 0.5 * sin(i) : -2 + cos(i);
    CHECK(heat_apply(heat, t, 1, f, 0, u, 0, NULL) >= 0);
    for (i = 0; i < lap->n; i++) {
        in[to[i] >= n_ball] += lap->mass[i] * f[i];
        out[to[i] >= n_ball] += lap->mass[i] * u[i];
    }
    CHECK_MSG(fabs(in[0] - out[0]) < 1e-12 * fabs(in[0]) && fabs(in[1] - out[1]) < 1e-12 * fabs(in[1]), "%s: a component's heat changed: %g, %g", what,
              out[0] / in[0] - 1, out[1] / in[1] - 1);
    free(u);
    free(f);
    hd_heat_free(heat);
}

static void heat_components(void) {
    const double offset[3] = {3, 0, 0};
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    shape a = shape_icosphere(1), b = shape_grid(6, 6, 0.2), s = shape_disjoint(&a, &b, offset), mixed;
    int32_t *to = DENSE_NEW(int32_t, s.n);
    int q, k, z;
    mixed = op_renumbered(&s, 41, to);
    for (q = 0; q < 3; q++) {
        hd_laplacian *lap = test_laplacian(&mixed, op_kinds[q]);
        const double unit = q == 2 ? 1 : lap->h * lap->h;
        heat_case c = heat_case_of(test_laplacian(&mixed, op_kinds[q]), "mixed components");
        hd_heat *heat = heat_plan(c.lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        heat_against_dense(&c, heat, 20 * unit);
        hd_heat_free(heat);
        heat_case_free(&c);
        for (k = 0; k < 4; k++)
            for (z = 0; z < 3; z++) heat_components_by(lap, solvers[k], pow(30, z) * unit, to, a.n, q == 0 ? "fem" : q == 1 ? "voronoi" : "cot");
        hd_laplacian_free(lap);
    }
    free(to);
    shape_free(&a);
    shape_free(&b);
    shape_free(&s);
    shape_free(&mixed);
}

/* Vertices without mass are left alone. */
static void heat_inert(void) {
    shape b = shape_icosphere(1), s = shape_make(b.n + 2, b.n_tri);
    static const hd_solver solvers[3] = {HD_SOLVER_AUTO, HD_SOLVER_COCG, HD_SOLVER_LANCZOS};
    int32_t i, f, n = s.n;
    const int32_t sources[3] = {0, 1, 25}, rows[5] = {0, 5, 5, 0, 7}, cols[5] = {0, 0, 5, 6, 0};
    int k;
    for (i = 0; i < b.n; i++) memcpy(s.xyz + 3 * (i + (i > 20) + 1), b.xyz + 3 * i, 3 * sizeof(double));    /* 0 and 22 are new */
    shape_put_vertex(&s, 0, 1, 2, 3);
    shape_put_vertex(&s, 22, 3, 2, 1);
    for (f = 0; f < 3 * b.n_tri; f++) s.tri[f] = b.tri[f] + (b.tri[f] > 20) + 1;
    for (k = 0; k < 3; k++) {
        hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT), *plain = test_laplacian(&b, HD_LAPLACIAN_VORONOI_COT);
        hd_heat *heat = heat_plan(lap, solvers[k], HD_POLES_DEFAULT, 0, 0), *other = heat_plan(plain, solvers[k], HD_POLES_DEFAULT, 0, 0);
        const double t = 4 * lap->h * lap->h;
        double *u = DENSE_NEW(double, 3 * n), *w = DENSE_NEW(double, n), v[5];
        hd_report rep;
        CHECK(lap->mesh.n_inert == 2 && lap->row[0] == -1 && lap->row[22] == -1);
        CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, 3, sources, u, 0, &rep) >= 0);
        CHECK(heat_column(other, t, 0, w, NULL) >= 0);
        for (i = 0; i < n; i++) CHECK(u[i] == (i == 0));                     /* its unit vector */
        CHECK(u[n] == 0 && u[n + 22] == 0);
        for (i = 0; i < b.n; i++) CHECK(fabs(u[n + i + (i > 20) + 1] - w[i]) <= (k ? 0 : 1e-7) * w[0]);   /* the others do not notice */
        CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 3, sources, u, 0, &rep) >= 0);
        for (i = 0; i < n; i++) CHECK(u[i] == 0);
        CHECK(u[n + 1] > 0 && u[n] == 0);
        for (i = 0; i < n; i++) w[i] = i + 1;
        CHECK(heat_apply(heat, t, 1, w, 0, u, 0, NULL) >= 0);
        CHECK(u[0] == 1 && u[22] == 23 && u[5] != 6);                        /* a field keeps its value there */
        CHECK(heat_entries(heat, t, HD_KERNEL_OPERATOR, 5, rows, cols, v, NULL) >= 0);
        CHECK(v[0] == 1 && v[1] == 0 && v[2] > 0 && v[3] == 0 && v[4] == 0);
        CHECK(heat_entries(heat, t, HD_KERNEL_SYMMETRIC, 5, rows, cols, v, NULL) >= 0);
        CHECK(v[0] == 0 && v[1] == 0 && v[2] > 0 && v[3] == 0);
        free(u);
        free(w);
        hd_heat_free(heat);
        hd_heat_free(other);
        hd_laplacian_free(lap);
        hd_laplacian_free(plain);
    }
    shape_free(&b);
    shape_free(&s);
}

/* t = 0: nothing has moved yet. */
static void heat_time_zero(void) {
    shape s = shape_grid(5, 5, 0.2);
    heat_case c = heat_case_of(test_laplacian(&s, HD_LAPLACIAN_FEM), "t = 0");
    hd_heat *heat = heat_plan(c.lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
    double f[25], u[25], rhs[25], want[25];
    const int32_t source = 7;
    hd_report rep;
    int32_t i;
    for (i = 0; i < 25; i++) f[i] = cos(3 * i) / 7;
    CHECK(heat_apply(heat, 0, 1, f, 0, u, 0, &rep) == HD_OK && memcmp(f, u, sizeof f) == 0);
    CHECK(rep.iterations == 0 && rep.error_bound == 0);
    CHECK(heat_column(heat, 0, source, u, NULL) == HD_OK);
    for (i = 0; i < 25; i++) CHECK(u[i] == (i == source));
    CHECK(heat_columns(heat, 0, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, NULL) == HD_OK);    /* B^-1 e */
    heat_source_rhs(&c, source, HD_KERNEL_SYMMETRIC, rhs);
    dense_pair_heat(&c.pair, 0, rhs, want);
    CHECK(dense_max_diff(u, want, 25) < 1e-11 * dense_max_abs(want, 25));
    CHECK(heat_apply(heat, 1, 0, NULL, 0, NULL, 0, &rep) == HD_OK && rep.iterations == 0);    /* no fields are fine */
    CHECK(heat_columns(heat, 1, HD_KERNEL_OPERATOR, 0, NULL, NULL, 0, &rep) == HD_OK);
    CHECK(heat_entries(heat, 1, HD_KERNEL_OPERATOR, 0, NULL, NULL, NULL, &rep) == HD_OK);
    hd_heat_free(heat);
    heat_case_free(&c);
    shape_free(&s);
}

/* ---- invariance ---- */

static void heat_invariance(void) {
    shape s = shape_bumpy(2, 13), r, p;
    int32_t *to = DENSE_NEW(int32_t, s.n), i, source = 0;
    const double scale = 37;
    double *u = DENSE_NEW(double, s.n), *v = DENSE_NEW(double, s.n), worst;
    int q;
    r = shape_bumpy(2, 13);
    for (i = 0; i < r.n; i++) op_rotate(r.xyz + 3 * i, scale);
    p = op_renumbered(&s, 5, to);
    for (i = 0; i < s.n; i++)
        if (to[i] == 40) source = i;
    for (q = 0; q < 3; q++) {
        hd_laplacian *a = test_laplacian(&s, op_kinds[q]), *b = test_laplacian(&r, op_kinds[q]), *c = test_laplacian(&p, op_kinds[q]);
        hd_heat *ha = heat_plan(a, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 1e-11), *hb = heat_plan(b, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 1e-11);
        hd_heat *hc = heat_plan(c, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 1e-11);
        const double t = q == 2 ? 20 : 20 * a->h * a->h;
        CHECK(heat_column(ha, t, 40, u, NULL) >= 0);
        CHECK(heat_column(hb, q == 2 ? t : t * scale * scale, 40, v, NULL) >= 0);
        worst = dense_max_diff(u, v, s.n) / dense_max_abs(u, s.n);
        CHECK_MSG(worst < 1e-8, "kind %d: moved and scaled, off by %g", q, worst);
        CHECK(heat_column(hc, t, source, v, NULL) >= 0);
        for (i = 0, worst = 0; i < s.n; i++) worst = fmax(worst, fabs(v[i] - u[to[i]]));
        CHECK_MSG(worst < 1e-8 * dense_max_abs(u, s.n), "kind %d: renumbered, off by %g", q, worst);
        hd_heat_free(ha);
        hd_heat_free(hb);
        hd_heat_free(hc);
        hd_laplacian_free(a);
        hd_laplacian_free(b);
        hd_laplacian_free(c);
    }
    free(to);
    free(u);
    free(v);
    shape_free(&s);
    shape_free(&r);
    shape_free(&p);
}

/* ---- closed forms ---- */

static const double heat_pi = 3.141592653589793238;

/* Unit sphere: k_t(x, y) = sum (2 l + 1)/(4 pi) exp(-l (l + 1) t) P_l(cos angle). */
static double heat_sphere(double t, double cosine) {
    double p0 = 1, p1 = cosine, sum = 1 / (4 * heat_pi);
    int l;
    for (l = 1; l < 200; l++) {
        const double p2 = ((2 * l + 1) * cosine * p1 - l * p0) / (l + 1);
        sum += (2 * l + 1) / (4 * heat_pi) * exp(-l * (l + 1.0) * t) * p1;
        p0 = p1;
        p1 = p2;
    }
    return sum;
}

/* The error falls fourfold or nearly so with every halving of the edges. */
static void heat_sphere_converges(void) {
    const double t = 0.15;
    const int32_t source = 40;                   /* not one of the twelve odd vertices, where maxima converge more slowly */
    int q, level;
    for (q = 0; q < 2; q++) {
        double before = 0;
        for (level = 1; level <= 4; level++) {
            shape s = shape_icosphere(level);
            hd_laplacian *lap = test_laplacian(&s, op_kinds[q]);
            hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            double *u = DENSE_NEW(double, s.n), worst = 0;
            int32_t i;
            CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, NULL) >= 0);
            for (i = 0; i < s.n; i++) worst = fmax(worst, fabs(u[i] - heat_sphere(t, shape_dot(s.xyz + 3 * i, s.xyz + 3 * source))));
            worst /= heat_sphere(t, 1);
            if (level > 1) CHECK_MSG(worst < before / 3, "kind %d level %d: error %g after %g", q, level, worst, before);
            before = worst;
            free(u);
            hd_heat_free(heat);
            hd_laplacian_free(lap);
            shape_free(&s);
        }
        CHECK_MSG(before < 6e-3, "kind %d: error %g on the finest sphere", q, before);
    }
}

/* Kernel of the path with n vertices, B = I: eigenvalues 2 - 2 cos(pi k/n). */
static double heat_path(int32_t n, double t, int32_t i, int32_t j) {
    double sum = 1.0 / n;
    int32_t k;
    for (k = 1; k < n; k++)
        sum += 2.0 / n * exp(-t * (2 - 2 * cos(heat_pi * k / n))) * cos(heat_pi * k * (i + 0.5) / n) * cos(heat_pi * k * (j + 0.5) / n);
    return sum;
}

/* Kernel of the cycle. */
static double heat_cycle(int32_t n, double t, int32_t i, int32_t j) {
    double sum = 0;
    int32_t k;
    for (k = 0; k < n; k++) sum += exp(-t * (2 - 2 * cos(2 * heat_pi * k / n))) * cos(2 * heat_pi * k * (i - j) / n) / n;
    return sum;
}

/* Graph Laplacian of the flat torus nx x ny with edge weights wx, wy. */
static hd_csr heat_torus_csr(int32_t nx, int32_t ny, double wx, double wy) {
    int32_t *i = DENSE_NEW(int32_t, 10 * nx * ny), *j = DENSE_NEW(int32_t, 10 * nx * ny), x, y;
    double *v = DENSE_NEW(double, 10 * nx * ny);
    int64_t c = 0;
    hd_csr a;
    for (y = 0; y < ny; y++) {
        for (x = 0; x < nx; x++) {
            const int32_t at = y * nx + x, right = y * nx + (x + 1) % nx, up = (y + 1) % ny * nx + x;
            i[c] = at; j[c] = right; v[c++] = -wx;
            i[c] = at; j[c] = up; v[c++] = -wy;
            i[c] = at; j[c] = at; v[c++] = 2 * wx + 2 * wy;
        }
    }
    a = test_symmetric_csr(nx * ny, c, i, j, v);
    free(i);
    free(j);
    free(v);
    return a;
}

static void heat_closed_one(const hd_csr *L, double mass, double t, int32_t source, const double *want, const char *what) {
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    double *u = DENSE_NEW(double, L->n_rows), *d = DENSE_NEW(double, L->n_rows);
    hd_csr B;
    hd_laplacian *lap = NULL;
    hd_error e;
    int32_t i;
    int k;
    for (i = 0; i < L->n_rows; i++) d[i] = mass;
    B = test_diagonal_csr(L->n_rows, d);
    CHECK_MSG(hd_laplacian_matrices(&lap, L, &B, 0, NULL, &e) == HD_OK, "%s", e.text);
    for (k = 0; k < 4; k++) {
        hd_heat *heat = heat_plan(lap, solvers[k], k < 3 ? HD_POLES_KERNEL : HD_POLES_DEFAULT, k < 3 ? 14 : 0, 1e-12);
        CHECK(heat_column(heat, t * mass, source, u, NULL) >= 0);
        CHECK_MSG(dense_max_diff(u, want, L->n_rows) < 1e-10 * dense_max_abs(want, L->n_rows), "%s, %s, t %g: off by %g", what, heat_solver_name(solvers[k]), t,
                  dense_max_diff(u, want, L->n_rows));
        hd_heat_free(heat);
    }
    hd_csr_free(&B, NULL);
    hd_laplacian_free(lap);
    free(u);
    free(d);
}

static void heat_graphs(void) {
    static const double times[3] = {0.4, 6, 150};
    double want[400];
    hd_csr L;
    int32_t i;
    int k;
    for (k = 0; k < 3; k++) {
        L = test_path_csr(50, 0);
        for (i = 0; i < 50; i++) want[i] = heat_path(50, times[k], i, 3);
        heat_closed_one(&L, 1, times[k], 3, want, "path");
        hd_csr_free(&L, NULL);
        L = test_path_csr(31, 1);
        for (i = 0; i < 31; i++) want[i] = heat_cycle(31, times[k], i, 8);
        heat_closed_one(&L, 0.125, times[k], 8, want, "cycle");
        hd_csr_free(&L, NULL);
        L = heat_torus_csr(20, 9, 1, 0.5);
        for (i = 0; i < 180; i++) want[i] = heat_cycle(20, times[k], i % 20, 17) * heat_cycle(9, 0.5 * times[k], i / 20, 2);
        heat_closed_one(&L, 3, times[k], 2 * 20 + 17, want, "torus");
        hd_csr_free(&L, NULL);
    }
}

/* A grid with natural border: on square cells the cotangent pair with mixed areas is the product of two lumped finite-element
 * intervals, whose modes are cos(pi k i/(n - 1)) with 2 - 2 cos(pi k/(n - 1)). */
static double heat_interval(int32_t n, double t, int32_t i, int32_t j) {
    const int32_t m = n - 1;
    double sum = 0;
    int32_t k;
    for (k = 0; k <= m; k++) {
        const double norm = k == 0 || k == m ? 1.0 / m : 2.0 / m;
        sum += norm * exp(-t * (2 - 2 * cos(heat_pi * k / m))) * cos(heat_pi * k * i / m) * cos(heat_pi * k * j / m);
    }
    return sum;                                  /* the symmetric kernel */
}

static void heat_neumann_grid(void) {
    const int32_t nx = 13, ny = 8, source = 2 * 13 + 1;
    shape s = shape_grid(nx, ny, 0);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_VORONOI_COT);
    const double h = 1.0 / (nx - 1);
    double *u = DENSE_NEW(double, s.n), *want = DENSE_NEW(double, s.n);
    int k;
    int32_t i;
    for (k = 0; k < 3; k++) {
        const double t = pow(10, k) * 0.5;
        hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 1e-11);
        for (i = 0; i < s.n; i++) want[i] = heat_interval(nx, t, i % nx, 1) * heat_interval(ny, t, i / nx, 2) / (h * h);
        CHECK(heat_columns(heat, t * h * h, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, NULL) >= 0);
        CHECK_MSG(dense_max_diff(u, want, s.n) < 1e-8 * dense_max_abs(want, s.n), "t %g: off by %g", t, dense_max_diff(u, want, s.n) / dense_max_abs(want, s.n));
        hd_heat_free(heat);
    }
    free(u);
    free(want);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* ---- filters of the caller's own ---- */

static void heat_own_one(const heat_case *c, const hd_rational *set, double t, hd_solver solver) {
    const int32_t n = c->lap->n_active;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_report rep;
    double *f = DENSE_NEW(double, n), *u = DENSE_NEW(double, n), *g = DENSE_NEW(double, n), *rhs = DENSE_NEW(double, n), *want = DENSE_NEW(double, n);
    uint64_t seed = 4;
    int32_t i;
    memset(&o, 0, sizeof o);
    o.rational = set;
    o.solver = solver;
    o.tol = 1e-12;
    for (i = 0; i < n; i++) {
        f[i] = dense_signed(&seed);
        g[i] = hd_rational_eval(set, -t * c->pair.lambda[i]);
    }
    heat_field_rhs(c, f, rhs);
    dense_pair_filter(&c->pair, g, rhs, want);
    CHECK(hd_heat_create(&heat, c->lap, &o, NULL) == HD_OK);
    CHECK(heat_apply(heat, t, 1, f, 0, u, 0, &rep) >= 0);
    CHECK_MSG(dense_max_diff(u, want, n) < 1e-10 * dense_max_abs(want, n), "%s: own filter, solver %s, off by %g", c->what, heat_solver_name(solver),
              dense_max_diff(u, want, n));
    CHECK(rep.poles == HD_POLES_OWN && rep.mass_drift == 0 && rep.n_poles == set->n_poles);
    for (i = 0; i < n; i++) want[i] -= u[i];
    CHECK(dense_pair_norm(&c->pair, want) <= rep.error_bound_b * dense_pair_norm(&c->pair, u) * 1.01 + 1e-12 * dense_max_abs(u, n));
    hd_heat_free(heat);
    free(f);
    free(u);
    free(g);
    free(rhs);
    free(want);
}

static void heat_own_sets(void) {
    const double offset[3] = {4, 0, 0};
    static const hd_solver solvers[3] = {HD_SOLVER_AUTO, HD_SOLVER_COCR, HD_SOLVER_MINRES};
    shape a = shape_grid(6, 6, 0.3), b = shape_icosphere(1), s = shape_disjoint(&a, &b, offset);
    hd_rational euler, odd;
    int k, q;
    memset(&euler, 0, sizeof euler);
    memset(&odd, 0, sizeof odd);
    euler.n_poles = euler.degree = 1;            /* backward Euler: 1/(1 - x), that is (B + t L)^-1 B f */
    euler.theta[0] = test_c(1, 0);
    euler.a[0] = test_c(-1, 0);
    odd.n_poles = 3;                             /* any filter: c(0) is not 1, poles in no order */
    odd.degree = 5;
    odd.a0 = 0.7;
    odd.theta[0] = test_c(-2, 9);
    odd.a[0] = test_c(3, -5);
    odd.theta[1] = test_c(2, 0);
    odd.a[1] = test_c(-1.5, 0);
    odd.theta[2] = test_c(0.3, 4);
    odd.a[2] = test_c(0.2, 2);
    for (q = 0; q < 3; q++) {
        heat_case c = q < 2 ? heat_case_of(test_laplacian(&s, op_kinds[q]), "own, mesh") : heat_case_of(kry_dirichlet(40), "own, dirichlet");
        const double unit = q < 2 ? c.lap->h * c.lap->h : 1;
        for (k = 0; k < 3; k++) {
            heat_own_one(&c, &euler, 2 * unit, solvers[k]);
            heat_own_one(&c, &euler, 300 * unit, solvers[k]);
            heat_own_one(&c, &odd, 10 * unit, solvers[k]);
        }
        heat_case_free(&c);
    }
    shape_free(&a);
    shape_free(&b);
    shape_free(&s);
}

/* Pairs that do not conserve heat, and a full B that no element made. */
static void heat_not_conserving(void) {
    heat_case c = heat_case_of(kry_dirichlet(40), "dirichlet");
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    int k, q;
    for (k = 0; k < 4; k++) {
        for (q = 0; q < 3; q++) {
            hd_heat *heat = heat_plan(c.lap, solvers[k], HD_POLES_DEFAULT, 0, 0);
            heat_against_dense(&c, heat, pow(20, q));
            hd_heat_free(heat);
        }
    }
    heat_case_free(&c);
}

/* ---- calling conventions ---- */

/* Many fields in one call are those of single calls, bit for bit; leading dimensions and places in between are respected. */
static void heat_many(void) {
    enum { K = 7 };
    shape s = shape_grid(9, 7, 0.3);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    const int32_t n = s.n, ldf = n + 3, ldu = n + 5, sources[K] = {0, 5, 62, 5, 17, 40, 33};
    const double t = 12 * lap->h * lap->h;
    double *F = DENSE_NEW(double, ldf * K), *U = DENSE_NEW(double, ldu * K), *u = DENSE_NEW(double, n);
    uint64_t seed = 99;
    int32_t i, q;
    int k, z;
    for (i = 0; i < ldf * K; i++) F[i] = dense_signed(&seed);
    for (k = 0; k < 4; k++) {
        hd_heat *heat = heat_plan(lap, solvers[k], HD_POLES_DEFAULT, k < 3 ? 8 : 0, 0);
        hd_report rep, one;
        int64_t steps = 0;
        for (i = 0; i < ldu * K; i++) U[i] = 1234;
        CHECK(heat_apply(heat, t, K, F, (size_t)ldf, U, (size_t)ldu, &rep) >= 0);
        for (q = 0; q < K; q++) {
            CHECK(heat_apply(heat, t, 1, F + q * ldf, 0, u, 0, &one) >= 0);
            CHECK_MSG(memcmp(u, U + q * ldu, (size_t)n * sizeof *u) == 0, "%s: field %d differs from a call of its own", heat_solver_name(solvers[k]), (int)q);
            CHECK_MSG(rep.error_bound >= one.error_bound && rep.error_bound_b >= one.error_bound_b && rep.residual >= one.residual,
                "%s, field %d: %g and %g, %g and %g, %g and %g", heat_solver_name(solvers[k]), (int)q, rep.error_bound, one.error_bound,
                rep.error_bound_b, one.error_bound_b, rep.residual, one.residual);
            steps += one.iterations;
            for (i = n; i < ldu; i++) CHECK(U[q * ldu + i] == 1234);
        }
        CHECK_MSG(steps == rep.iterations, "%lld steps, not %lld", (long long)rep.iterations, (long long)steps);
        for (z = 0; z < 2; z++) {
            const hd_kernel kernel = z ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
            int32_t rows[3 * K], cols[3 * K];
            double values[3 * K];
            CHECK(heat_columns(heat, t, kernel, K, sources, U, (size_t)ldu, NULL) >= 0);
            for (q = 0; q < K; q++) {
                CHECK(heat_columns(heat, t, kernel, 1, sources + q, u, 0, NULL) >= 0);
                CHECK(memcmp(u, U + q * ldu, (size_t)n * sizeof *u) == 0);
            }
            for (q = 0; q < 3 * K; q++) {        /* entries of the same columns, in disorder and with repeats */
                cols[q] = sources[(q * 5) % K];
                rows[q] = (q * 11) % n;
            }
            CHECK(heat_entries(heat, t, kernel, 3 * K, rows, cols, values, &rep) >= 0);
            for (q = 0; q < 3 * K; q++) CHECK(values[q] == U[(q * 5) % K * ldu + rows[q]]);
        }
        hd_heat_free(heat);
    }
    free(F);
    free(U);
    free(u);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void heat_in_place(void) {
    enum { K = 6 };
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
    const double t = 5 * lap->h * lap->h;
    double F[42 * K], U[42 * K];
    uint64_t seed = 2;
    int32_t i;
    for (i = 0; i < 42 * K; i++) F[i] = dense_signed(&seed) + 0.3;
    CHECK(heat_apply(heat, t, K, F, 0, U, 0, NULL) >= 0);
    CHECK(heat_apply(heat, t, K, F, 0, F, 0, NULL) >= 0);
    CHECK(memcmp(F, U, sizeof F) == 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* The plan remembers preconditioners: going back and forth between times, kernels and sets changes nothing. */
static void heat_reuse(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
    const double unit = lap->h * lap->h;
    double f[42], u[4][42], v[42];
    const int32_t source = 9;
    int32_t i;
    int k;
    for (i = 0; i < 42; i++) f[i] = sin(i);
    for (k = 0; k < 9; k++) {
        const int q = k % 3;
        double *to = k < 3 ? u[q] : v;
        hd_heat *fresh = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0), *plan = k < 3 ? fresh : heat;
        if (q == 0) CHECK(heat_apply(plan, 3 * unit, 1, f, 0, to, 0, NULL) >= 0);
        if (q == 1) CHECK(heat_columns(plan, 3 * unit, HD_KERNEL_SYMMETRIC, 1, &source, to, 0, NULL) >= 0);
        if (q == 2) CHECK(heat_column(plan, 70 * unit, source, to, NULL) >= 0);
        if (k >= 3) CHECK(memcmp(u[q], v, sizeof v) == 0);
        hd_heat_free(fresh);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void heat_errors(void) {
    shape s = shape_icosphere(0);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0), *lanczos = heat_plan(lap, HD_SOLVER_LANCZOS, HD_POLES_DEFAULT, 0, 0);
    double F[36], U[36];
    int32_t sources[3] = {0, 12, 2}, rows[2] = {3, 4}, cols[2] = {1, -1};
    hd_report rep;
    int32_t i;
    for (i = 0; i < 36; i++) F[i] = i;
#define HEAT_BAD(call, st) CHECK_MSG((call) == (st) && rep.status == (st) && rep.error.status == (st) && rep.error.text[0], "%s", hd_status_name(rep.status))
    HEAT_BAD(heat_apply(heat, -1, 1, F, 0, U, 0, &rep), HD_ERR_ARGUMENT);
    CHECK(rep.error.value == -1);
    HEAT_BAD(heat_apply(heat, (double)NAN, 1, F, 0, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_apply(heat, (double)INFINITY, 1, F, 0, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_apply(heat, 1, -1, F, 0, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_apply(heat, 1, 1, NULL, 0, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_apply(heat, 1, 1, F, 0, NULL, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_apply(heat, 1, 1, F, 11, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_apply(heat, 1, 1, F, 0, U, 11, &rep), HD_ERR_ARGUMENT);
    for (i = 0; i < 2; i++) {
        hd_heat *plan = i ? lanczos : heat;
        F[12 + 7] = i ? -(double)INFINITY : (double)NAN;
        U[0] = 77;                               /* the bad value is in a later field: nothing may be written before it is seen */
        HEAT_BAD(heat_apply(plan, 1, 3, F, 0, U, 0, &rep), HD_ERR_NOT_FINITE);
        CHECK(U[0] == 77);
        CHECK(rep.error.row == 7 && rep.error.column == 1);
        HEAT_BAD(heat_apply(plan, 0, 3, F, 0, U, 0, &rep), HD_ERR_NOT_FINITE);
        CHECK(rep.error.row == 7 && rep.error.column == 1);
        F[12 + 7] = 0;
    }
    HEAT_BAD(heat_columns(heat, 1, HD_KERNEL_OPERATOR, 3, sources, U, 0, &rep), HD_ERR_INDEX);
    CHECK(rep.error.vertex == 12 && rep.error.value == 12 && rep.error.column == 1);
    sources[1] = -5;
    HEAT_BAD(heat_columns(heat, 1, HD_KERNEL_SYMMETRIC, 3, sources, U, 0, &rep), HD_ERR_INDEX);
    CHECK(rep.error.vertex == -5 && rep.error.value == -5 && rep.error.column == 1);
    HEAT_BAD(heat_column(heat, 1, 12, U, &rep), HD_ERR_INDEX);
    HEAT_BAD(heat_columns(heat, 1, (hd_kernel)5, 1, rows, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_columns(heat, 1, HD_KERNEL_OPERATOR, 1, NULL, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_columns(heat, 1, HD_KERNEL_OPERATOR, -2, rows, U, 0, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_entries(heat, 1, HD_KERNEL_OPERATOR, 2, rows, cols, U, &rep), HD_ERR_INDEX);
    CHECK(rep.error.vertex == -1 && rep.error.row == 1);
    HEAT_BAD(heat_entries(heat, 1, HD_KERNEL_OPERATOR, -1, rows, cols, U, &rep), HD_ERR_ARGUMENT);
    HEAT_BAD(heat_entries(heat, 1, HD_KERNEL_OPERATOR, 2, rows, NULL, U, &rep), HD_ERR_ARGUMENT);
#undef HEAT_BAD
    hd_heat_free(heat);
    hd_heat_free(lanczos);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void heat_not_converged(void) {
    shape s = shape_bumpy(2, 2);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    double *u = DENSE_NEW(double, s.n);
    int k;
    for (k = 0; k < 4; k++) {
        hd_heat_opts o;
        hd_heat *heat = NULL;
        hd_report rep;
        memset(&o, 0, sizeof o);
        o.solver = solvers[k];
        o.max_iterations = 2;
        o.precond = HD_PRECOND_JACOBI;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        CHECK(heat_column(heat, 500 * lap->h * lap->h, 3, u, &rep) == HD_ERR_NOT_CONVERGED);
        CHECK(rep.status == HD_ERR_NOT_CONVERGED && rep.error.status == HD_ERR_NOT_CONVERGED && rep.error.value > 1e-9 && rep.error.column == 0);
        CHECK((rep.error.pole >= 0) == (k < 3));
        CHECK_MSG(rep.residual == rep.error.value, "achieved %g, reported %g", rep.error.value, rep.residual);
        hd_heat_free(heat);
    }
    free(u);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* ---- threads ---- */

/* Tasks in the order of a shuffled deck, each by some worker; the last one by the calling thread. */
static void heat_shuffled_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    int32_t *order = DENSE_NEW(int32_t, n_tasks), i;
    uint64_t seed = 17;
    dense_shuffle(order, (int32_t)n_tasks, &seed);
    for (i = 0; i < n_tasks; i++) task(arg, order[i], (int32_t)((i + 1) % n_tasks ? 1 + i % 2 : 0));
    ++*(int64_t *)user;
    free(order);
}

static hd_progress heat_progress(void *user, const char *stage, double done) {
    int64_t *count = (int64_t *)user;
    ++*count;
    return stage && done >= 0 && done <= 1 ? HD_PROGRESS_CONTINUE : HD_PROGRESS_CANCEL;
}

static void heat_threads(void) {
    enum { K = 6, WAYS = 6 };
    shape s = shape_bumpy(2, 6);
    const int32_t n = s.n, sources[K] = {3, 70, 11, 150, 0, 42};
    double *first = DENSE_NEW(double, n * K), *u = DENSE_NEW(double, n * K);
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    int64_t calls = 0, progress = 0;
    int k, way;
    for (k = 0; k < 4; k++) {
        hd_report rep0;
        memset(&rep0, 0, sizeof rep0);
        for (way = 0; way < WAYS; way++) {
            hd_context ctx;
            hd_laplacian_opts lo;
            hd_heat_opts ho;
            hd_laplacian *lap = NULL;
            hd_heat *heat = NULL;
            hd_report rep;
            memset(&ctx, 0, sizeof ctx);
            memset(&lo, 0, sizeof lo);
            memset(&ho, 0, sizeof ho);
            ctx.n_threads = way == 1 ? 0 : way == 2 ? 2 : way == 3 ? 3 : 1;
            ctx.parallel_user = &calls;
            if (way == 4) ctx.parallel_for = sparse_reverse_for;
            if (way == 5) ctx.parallel_for = heat_shuffled_for;
            if (way == 5) ctx.progress = heat_progress;
            ctx.progress_user = &progress;
            lo.context = &ctx;
            ho.solver = solvers[k];
            CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) == HD_OK);
            CHECK(hd_heat_create(&heat, lap, &ho, NULL) == HD_OK);
            CHECK(heat_columns(heat, 8 * lap->h * lap->h, HD_KERNEL_OPERATOR, K, sources, way ? u : first, 0, &rep) >= 0);
            if (way == 0) rep0 = rep;
            CHECK_MSG(way == 0 || memcmp(u, first, (size_t)(n * K) * sizeof *u) == 0, "%s: way %d of threading gives other bits", heat_solver_name(solvers[k]), way);
            CHECK(rep.iterations == rep0.iterations && rep.error_bound == rep0.error_bound && rep.residual == rep0.residual);
            hd_heat_free(heat);
            hd_laplacian_free(lap);
            CHECK(ctx.bytes_in_use == 0);
        }
    }
    CHECK(calls > 0 && progress > 0);
    free(first);
    free(u);
    shape_free(&s);
}

static void test_heat(void) {
    heat_dense_cases();
    heat_degrees();
    heat_defaults();
    heat_identities();
    heat_components();
    heat_inert();
    heat_time_zero();
    heat_invariance();
    heat_sphere_converges();
    heat_graphs();
    heat_neumann_grid();
    heat_own_sets();
    heat_not_conserving();
    heat_many();
    heat_in_place();
    heat_reuse();
    heat_errors();
    heat_not_converged();
    heat_threads();
}

#endif
