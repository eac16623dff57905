/* test_heat.h - K_t f, columns and entries: against the truth of small shapes, closed forms, and the identities of heat */

#ifndef TEST_HEAT_H
#define TEST_HEAT_H

/* ---- a Laplacian with its dense eigensolution: for other groups ---- */

typedef struct heat_case {
    hd_laplacian *lap;
    dense_pair pair;
    double top;                  /* largest eigenvalue */
    const char *what;
} heat_case;

/* Tasks in the order of a shuffled deck, each by some worker; the last one by the calling thread. */
static void heat_shuffled_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    int32_t *order = KIT_NEW(int32_t, n_tasks), i;
    uint64_t seed = 17;
    dense_shuffle(order, (int32_t)n_tasks, &seed);
    for (i = 0; i < n_tasks; i++) task(arg, order[i], (int32_t)((i + 1) % n_tasks ? 1 + i % 2 : 0));
    ++*(int64_t *)user;
}

/* ---- against the truth ---- */

#define HEAT_PAIRS "shape=bumpy/1/3|split/6/1 op=fem|vor|cot query="
static const case_row heat_rows[] = {
    /* every solver with every kind of poles */
    {HEAT_PAIRS "column kernel=operator|symmetric solver=auto|cocg|minres|lanczos th=0.3|2|30|400|3000|1e4", 1e-6, 0, 0},
    {HEAT_PAIRS "apply field=random|smooth solver=auto|cocg|minres|lanczos th=0.3|2|30|400|3000|1e4", 1e-6, 0, 0},
    {HEAT_PAIRS "column|apply solver=auto|cocg|minres poles=uniform|kernel degree=5|9|13 th=0.3|2|30|1e4", 3e-3, 0, 0},
    /* all degrees, where the rational error is what counts; of degree 14 a tolerance of 1e-13 is below rounding */
    {"shape=ico/1 op=vor query=column|apply solver=cocg tol=1e-13 poles=uniform|kernel degree=4|5|6|7|8|9|10|11|12|13|14 th=3", 1e-2, 0, 2},
    {"shape=ico/1 op=vor query=column|apply solver=cocg tol=1e-13 poles=uniform|kernel degree=2|3 th=3", 0, 0, 8},
    {"shape=ico/1 op=vor query=column|apply solver=cocg tol=1e-13 poles=uniform degree=1 th=3", 0, 0, 2},
    /* all defaults */
    {"shape=torus/9/8 op=fem|vor query=column|apply|entries kernel=operator|symmetric k=6 th=1|10|100", 1e-6, 0, 0},
    /* vertices in no face, held ones, no time, several at once */
    {"shape=inert/5/1|spare/2/1|bumpy/1/3 op=vor|fem|fem+pin query=column|apply|entries kernel=operator|symmetric k=9 "
     "solver=auto|cocg|lanczos th=0|4", 1e-6, 0, 0},
    /* heat that is not kept; a full B that no element made */
    {"shape=drain/30/0.5|leak/30/0.01 op=I|tri query=column|apply solver=cocg|minres|lanczos th=1|20", 1e-6, 0, 0},
    /* sets of the caller's own: backward Euler, and any poles with a0, where c(0) is not 1 */
    {"shape=bumpy/1/3|split/6/1 op=fem|vor query=column|apply own=resolvent|random seed=1|2 solver=auto|cocg|minres tol=1e-12 th=2|10|300",
     1e-9, 0, 0},
    {"shape=drain/30/0.5 op=I|tri query=column|apply own=resolvent|random seed=1|2 solver=auto|cocg|minres tol=1e-12 th=2|10|300", 1e-9, 0, 0},
};

static void heat_cases(void) { CASES(heat_rows); }

/* ---- what reports say ---- */

static const char *const heat_solvers[3] = {"solver=cocg", "solver=minres", "solver=lanczos"};

/* Each part of a bound is within it, heat is kept, and there is no bound of single values. */
static void heat_report(const hd_report *r) {
    CHECK(r->error_bound >= r->error_rational && r->error_bound >= r->error_solver && r->error_bound >= r->error_rounding);
    CHECK(r->error_bound_b < HUGE_VAL && r->evidence_b != HD_EVIDENCE_NONE && r->error_relative == HUGE_VAL && r->mass_drift <= 1e-12);
}

static void heat_degrees(void) {
    const hd_laplacian *lap = kit_pair("ico/1 vor");
    double u[42];
    hd_report rep;
    char words[80];
    int k, r;
    for (k = 0; k < 2; k++)
        for (r = 1 + k; r <= 14; r++) {
            snprintf(words, sizeof words, "solver=cocg tol=1e-13 poles=%s degree=%d", k ? "kernel" : "uniform", r);
            CHECK(heat_column(kit_heat(lap, words), 3 * lap->h * lap->h, 5, u, &rep) >= 0 && rep.degree == r &&
                  rep.n_poles == (r + 1) / 2);
            CHECK(rep.poles == (k ? HD_POLES_KERNEL : HD_POLES_UNIFORM) && rep.method == HD_METHOD_ITERATIVE &&
                  rep.precond == HD_PRECOND_MILDL);
            heat_report(&rep);
        }
}

/* A larger mesh with what most callers use: nothing but defaults, and then each solver. */
static void heat_defaults(void) {
    static const char *const pairs[2] = {"torus/21/14 fem", "torus/21/14 vor"};
    int q, k;
    for (q = 0; q < 12 * 2; q++) {
        const hd_laplacian *lap = kit_pair(pairs[q % 2]);
        double *u = KIT_NEW(double, lap->n);
        hd_heat *heat = kit_heat(lap, q / 6 ? heat_solvers[q / 6 - 1] : "");
        hd_report rep;
        int64_t sum = 0;
        int32_t p;
        CHECK(heat_column(heat, pow(10, q / 2 % 3) * lap->h * lap->h, 100, u, &rep) == HD_OK && rep.status == HD_OK &&
              rep.error.status == HD_OK);
        heat_report(&rep);
        CHECK_MSG(rep.error_bound_b < 1e-7 && rep.error_bound < 1e-5, "case %d: bounds %g, %g say little", q, rep.error_bound_b,
                  rep.error_bound);
        CHECK(rep.reason != NULL && (rep.iterations > 0) == (rep.method != HD_METHOD_DIRECT));
        CHECK((rep.solver == HD_SOLVER_LANCZOS) == (rep.n_poles == 0) && (lap->B == NULL) == q % 2);
        for (p = 0; p < rep.n_poles; p++) sum += rep.pole_iterations[p];
        CHECK(rep.method != HD_METHOD_ITERATIVE || rep.n_poles == 0 || sum == rep.iterations);
    }
    for (k = 0; k < 4; k++) {                    /* of a set of the caller's own: heat is not asked for */
        const trial c = trial_parse("own=resolvent tol=1e-12");
        hd_rational euler;
        hd_heat_opts o = trial_options(&c);
        hd_heat *heat = NULL;
        double u[42];
        hd_report rep;
        memset(&euler, 0, sizeof euler);
        euler.n_poles = euler.degree = 1;
        euler.theta[0].re = 1;
        euler.a[0].re = -1;
        o.rational = &euler;
        o.method = (hd_method)k;
        CHECK(hd_heat_create(&heat, kit_pair("ico/1 fem"), &o, NULL) == (k == HD_METHOD_KRYLOV ? HD_ERR_ARGUMENT : HD_OK));
        if (!heat) continue;
        CHECK(heat_column(heat, 0.1, 3, u, &rep) == HD_OK && rep.poles == HD_POLES_OWN && rep.mass_drift == 0 && rep.n_poles == 1);
        hd_heat_free(heat);
    }
}

/* ---- identities ---- */

/* The whole of a kernel, column by column. */
static double *heat_matrix(hd_heat *heat, int32_t n, double t, hd_kernel kernel) {
    double *k = KIT_NEW(double, n * n);
    int32_t *sources = KIT_NEW(int32_t, n), i;
    hd_report rep;
    for (i = 0; i < n; i++) sources[i] = i;
    CHECK(heat_columns(heat, t, kernel, n, sources, k, 0, &rep) >= 0 && rep.mass_drift < 1e-12);
    return k;
}

/* The largest difference of a matrix [n n] from its transpose, relative to its largest entry. */
static double heat_asymmetry(const double *a, int32_t n) {
    double worst = 0;
    int32_t i, j;
    for (i = 0; i < n; i++)
        for (j = 0; j < i; j++) worst = fmax(worst, fabs(a[i * n + j] - a[j * n + i]));
    return worst / dense_max_abs(a, n * n);
}

/* k_t and B K_t are symmetric, K_s K_t = K_(s+t), K_t = k_t B, heat is kept, constants stay. */
static void heat_identities_of(const char *spec) {
    const hd_laplacian *lap = kit_pair(spec);
    hd_heat *heat = kit_heat(lap, "poles=kernel degree=14 tol=1e-12");
    const int32_t n = lap->n;
    const double unit = lap->kind == HD_LAPLACIAN_COT ? 1 : lap->h * lap->h, t = 3 * unit, t2 = 5 * unit;
    const double *K = heat_matrix(heat, n, t, HD_KERNEL_OPERATOR), *S = heat_matrix(heat, n, t, HD_KERNEL_SYMMETRIC);
    const double *later = heat_matrix(heat, n, t + t2, HD_KERNEL_OPERATOR);
    double *B = (double *)kit_keep(test_dense_mass(lap), free), *bk = KIT_NEW(double, n * n), *u = KIT_NEW(double, n),
        *f = KIT_NEW(double, n);
    double semigroup = 0, mass = 0, relation = 0;
    int32_t i, j, k;
    CHECK(lap->n_active == n);
    for (j = 0; j < n; j++) {
        double out = 0;
        dense_apply(B, K + j * n, bk + j * n, n);
        for (i = 0; i < n; i++) out += bk[j * n + i];
        mass = fmax(mass, fabs(out / lap->mass[j] - 1));
        CHECK(heat_apply(heat, t2, 1, K + j * n, 0, u, 0, NULL) >= 0);
        semigroup = fmax(semigroup, dense_max_diff(u, later + j * n, n));
        for (i = 0; i < n; i++) {
            double sum = 0;
            for (k = 0; k < n; k++) sum += S[k * n + i] * B[j * n + k];
            relation = fmax(relation, fabs(sum - K[j * n + i]));
        }
        f[j] = -3.25;
    }
    CHECK_MSG(heat_asymmetry(S, n) < 1e-9, "%s: k_t not symmetric by %g", spec, heat_asymmetry(S, n));
    CHECK_MSG(heat_asymmetry(bk, n) < 1e-9, "%s: B K_t not symmetric by %g", spec, heat_asymmetry(bk, n));
    CHECK_MSG(semigroup < 1e-9, "%s: K_s K_t is not K_(s+t) by %g", spec, semigroup);
    CHECK_MSG(mass < 1e-12, "%s: heat lost or made: %g", spec, mass);
    CHECK_MSG(relation < 1e-9, "%s: K_t is not k_t B by %g", spec, relation);
    CHECK(heat_apply(heat, 1000 * unit, 1, f, 0, u, 0, NULL) >= 0);
    CHECK_MSG(dense_max_diff(u, f, n) < 1e-13, "%s: constants move by %g", spec, dense_max_diff(u, f, n));
}

static void heat_identities(void) {
    static const char *const pairs[6] = {"flat/8/7/0.3 fem", "flat/8/7/0.3 vor", "flat/8/7/0.3 cot", "bumpy/1/21 fem",
        "bumpy/1/21 vor", "bumpy/1/21 cot"};
    int q;
    for (q = 0; q < 6; q++) heat_identities_of(pairs[q]);
}

/* Components exchange nothing, to the last bit, and each keeps its own heat. Their vertices are mixed in the numbering: to says
 * which vertex each was, those of the ball first. */
static void heat_components_by(const hd_laplacian *lap, const char *solver, double t, const int32_t *to, int32_t n_ball) {
    hd_heat *heat = kit_heat(lap, solver);
    double *u = KIT_NEW(double, lap->n), *f = KIT_NEW(double, lap->n), in[2] = {0, 0}, out[2] = {0, 0};
    int32_t i, k, source, leaks;
    for (k = 0; k < 2; k++) {                    /* a source in each */
        for (source = 0; (to[source] >= n_ball) != k; source++) {}
        CHECK(heat_column(heat, t, source, u, NULL) >= 0);
        for (i = 0, leaks = 0; i < lap->n; i++) leaks += (to[i] >= n_ball) != k && u[i] != 0;
        CHECK_MSG(leaks == 0 && u[source] > 0, "%s: heat at %d vertices of another component", solver, (int)leaks);
    }
    for (i = 0; i < lap->n; i++) f[i] = to[i] < n_ball ? 1 + 0.5 * sin(i) : -2 + cos(i);
    CHECK(heat_apply(heat, t, 1, f, 0, u, 0, NULL) >= 0);
    for (i = 0; i < lap->n; i++) {
        in[to[i] >= n_ball] += lap->mass[i] * f[i];
        out[to[i] >= n_ball] += lap->mass[i] * u[i];
    }
    for (k = 0; k < 2; k++) CHECK_MSG(fabs(in[k] - out[k]) < 1e-12 * fabs(in[k]), "%s: a component's heat changed by %g", solver,
                                      out[k] / in[k] - 1);
}

static void heat_components(void) {
    const double offset[3] = {3, 0, 0};
    const shape *a = kit_shape("ico/1"), *b = kit_shape("flat/6/6/0.2"), *s = kit_own(shape_disjoint(a, b, offset)), *mixed;
    int32_t *to = KIT_NEW(int32_t, s->n);
    int q, k, z;
    mixed = kit_own(op_renumbered(s, 41, to));
    for (q = 0; q < 3; q++) {
        const hd_laplacian *lap = kit_triangles(mixed, op_kinds[q]);
        for (k = 0; k < 3; k++)
            for (z = 0; z < 3; z++) heat_components_by(lap, heat_solvers[k], pow(30, z) * trial_unit(lap), to, a->n);
    }
}

/* Vertices without mass are left alone, and the others do not notice them. */
static void heat_inert(void) {
    static const char *const solvers[3] = {"", "solver=cocg", "solver=lanczos"};
    const hd_laplacian *lap = kit_pair("spare/3/1 vor"), *plain = kit_pair("disk/3/1 vor");
    const int32_t n = lap->n, sources[3] = {0, 1, 28}, rows[5] = {0, 6, 6, 0, 7}, cols[5] = {0, 0, 6, 10, 0};
    const double t = 4 * lap->h * lap->h;
    double *u = KIT_NEW(double, 3 * n), *w = KIT_NEW(double, n), v[5];
    int32_t i;
    int k;
    CHECK(lap->mesh.n_inert == n - plain->n && lap->row[0] == HD_ROW_INERT && lap->row[10] == HD_ROW_INERT && lap->vertex[0] == 1);
    for (k = 0; k < 3; k++) {
        hd_heat *heat = kit_heat(lap, solvers[k]);
        CHECK(heat_columns(heat, t, HD_KERNEL_OPERATOR, 3, sources, u, 0, NULL) >= 0);
        CHECK(heat_column(kit_heat(plain, solvers[k]), t, 0, w, NULL) >= 0);
        for (i = 0; i < n; i++) CHECK(u[i] == (i == 0) && (lap->row[i] >= 0 || u[n + i] == 0));    /* a unit vector */
        for (i = 0; i < plain->n; i++) CHECK(fabs(u[n + lap->vertex[i]] - w[i]) <= (k ? 0 : 1e-7) * w[0]);
        CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 3, sources, u, 0, NULL) >= 0);
        for (i = 0; i < n; i++) CHECK(u[i] == 0);
        CHECK(u[n + 1] > 0 && u[n] == 0);
        for (i = 0; i < n; i++) w[i] = i + 1;
        CHECK(heat_apply(heat, t, 1, w, 0, u, 0, NULL) >= 0);
        CHECK(u[0] == 1 && u[10] == 11 && u[6] != 7);                        /* a field keeps its value there */
        CHECK(heat_entries(heat, t, HD_KERNEL_OPERATOR, 5, rows, cols, v, NULL) >= 0);
        CHECK(v[0] == 1 && v[1] == 0 && v[2] > 0 && v[3] == 0 && v[4] == 0);
        CHECK(heat_entries(heat, t, HD_KERNEL_SYMMETRIC, 5, rows, cols, v, NULL) >= 0);
        CHECK(v[0] == 0 && v[1] == 0 && v[2] > 0 && v[3] == 0);
    }
}

/* t = 0: nothing has moved yet, to the bit, and nothing is computed. No fields are fine. */
static void heat_time_zero(void) {
    hd_heat *heat = kit_heat(kit_pair("flat/5/5/0.2 fem"), "");
    const double *f = kit_random(25, 3);
    double u[25];
    hd_report rep;
    int32_t i;
    CHECK(heat_apply(heat, 0, 1, f, 0, u, 0, &rep) == HD_OK && memcmp(f, u, sizeof u) == 0 && rep.iterations == 0 &&
          rep.error_bound == 0);
    CHECK(heat_column(heat, 0, 7, u, NULL) == HD_OK);
    for (i = 0; i < 25; i++) CHECK(u[i] == (i == 7));
    CHECK(heat_apply(heat, 1, 0, NULL, 0, NULL, 0, &rep) == HD_OK && rep.iterations == 0);
    CHECK(heat_columns(heat, 1, HD_KERNEL_OPERATOR, 0, NULL, NULL, 0, &rep) == HD_OK);
    CHECK(heat_entries(heat, 1, HD_KERNEL_OPERATOR, 0, NULL, NULL, NULL, &rep) == HD_OK);
}

/* A shape that is turned and scaled, and one whose vertices have other numbers, have the same heat. */
static void heat_invariance(void) {
    const double scale = 37;
    const shape *s = kit_shape("bumpy/2/13");
    shape turned = shape_bumpy(2, 13);
    const int32_t n = s->n;
    int32_t *to = KIT_NEW(int32_t, n), i, source = 0;
    const shape *other[2];
    double *u = KIT_NEW(double, n), *v = KIT_NEW(double, n);
    int q, k;
    for (i = 0; i < n; i++) op_rotate(turned.xyz + 3 * i, scale);
    other[0] = kit_own(turned);
    other[1] = kit_own(op_renumbered(s, 5, to));
    while (to[source] != 40) source++;
    for (q = 0; q < 3; q++) {
        const hd_laplacian *lap = kit_triangles(s, op_kinds[q]);
        const double t = q == 2 ? 20 : 20 * lap->h * lap->h;
        CHECK(heat_column(kit_heat(lap, "tol=1e-11"), t, 40, u, NULL) >= 0);
        for (k = 0; k < 2; k++) {
            double worst = 0;
            hd_heat *heat = kit_heat(kit_triangles(other[k], op_kinds[q]), "tol=1e-11");
            CHECK(heat_column(heat, k || q == 2 ? t : t * scale * scale, k ? source : 40, v, NULL) >= 0);
            for (i = 0; i < n; i++) worst = fmax(worst, fabs(v[i] - u[k ? to[i] : i]));
            CHECK_MSG(worst < 1e-8 * dense_max_abs(u, n), "kind %d, %s: off by %g", q, k ? "renumbered" : "moved and scaled", worst);
        }
    }
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

/* The error of columns and of diagonals falls fourfold or nearly so with every halving of the edges: of columns at the worst vertex, where
 * the source is not one of the twelve odd ones, near which it converges more slowly; of diagonals in the mean. */
static void heat_sphere_converges(void) {
    const double t = 0.15, top = heat_sphere(t, 1);
    const int32_t source = 40;
    int q, level;
    for (q = 0; q < 2; q++) {
        double before[2] = {HUGE_VAL, HUGE_VAL};
        for (level = 1; level <= 4; level++) {
            const int32_t mark = kit_mark();
            const shape *s = kit_own(shape_icosphere(level));
            hd_heat *heat = kit_heat(kit_triangles(s, op_kinds[q]), "");
            double *u = KIT_NEW(double, s->n), *d = KIT_NEW(double, s->n), off[2] = {0, 0};
            int32_t i;
            CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, NULL) >= 0);
            CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, d, 0, NULL) == HD_OK);
            for (i = 0; i < s->n; i++) {
                off[0] = fmax(off[0], fabs(u[i] - heat_sphere(t, shape_dot(s->xyz + 3 * i, s->xyz + 3 * source))) / top);
                off[1] += fabs(d[i] - top) / top / s->n;
            }
            for (i = 0; i < 2; i++) {
                CHECK_MSG(off[i] < before[i] / 3, "kind %d level %d: error %g after %g", q, level, off[i], before[i]);
                before[i] = off[i];
            }
            kit_release(mark);
        }
        CHECK_MSG(before[0] < 6e-3 && before[1] < 2e-2, "kind %d: errors %g, %g on the finest sphere", q, before[0], before[1]);
    }
}

/* Kernel of an interval with natural ends: of a path of n vertices, B = I, or of n - 1 lumped finite elements, where the two vertices
 * at the ends have half a mass. Modes are cosines, of eigenvalues 2 - 2 cos(pi k/m). */
static double heat_interval(int32_t n, int path, double t, int32_t i, int32_t j) {
    const int32_t m = path ? n : n - 1;
    const double at = path ? 0.5 : 0;
    double sum = 0;
    int32_t k;
    for (k = 0; k < n; k++) {
        const double norm = k == 0 || k == m ? 1.0 / m : 2.0 / m;
        sum += norm * exp(-t * (2 - 2 * cos(heat_pi * k / m))) * cos(heat_pi * k * (i + at) / m) * cos(heat_pi * k * (j + at) / m);
    }
    return sum;
}

/* Kernel of the cycle. */
static double heat_cycle(int32_t n, double t, int32_t i, int32_t j) {
    double sum = 0;
    int32_t k;
    for (k = 0; k < n; k++) sum += exp(-t * (2 - 2 * cos(2 * heat_pi * k / n))) * cos(2 * heat_pi * k * (i - j) / n) / n;
    return sum;
}

/* A path, a cycle, and a torus of two cycles, by every solver. */
static void heat_graphs(void) {
    static const struct { int32_t nx, ny, x, y; double wy, mass; } graphs[3] = {{50, 1, 3, 0, 1, 1}, {31, 1, 8, 0, 1, 0.125}, {20, 9,
        17, 2, 0.5, 3}};
    static const double times[3] = {0.4, 6, 150};
    double want[180], u[180];
    int32_t i;
    int g, k, q;
    for (g = 0; g < 3; g++) {
        const int32_t nx = graphs[g].nx, ny = graphs[g].ny, n = nx * ny, source = graphs[g].x * ny + graphs[g].y;
        const hd_laplacian *lap = kit_lattice(nx, ny, g > 0, graphs[g].wy, graphs[g].mass);
        for (q = 0; q < 3; q++) {
            for (i = 0; i < n; i++)
                want[i] = (g ? heat_cycle(nx, times[q], i / ny, graphs[g].x) : heat_interval(nx, 1, times[q], i, graphs[g].x)) *
                          heat_cycle(ny, graphs[g].wy * times[q], i % ny, graphs[g].y);
            for (k = 0; k < 3; k++) {
                char words[80];
                snprintf(words, sizeof words, "%s tol=1e-12 %s", heat_solvers[k], k < 2 ? "poles=kernel degree=14" : "");
                CHECK(heat_column(kit_heat(lap, words), times[q] * graphs[g].mass, source, u, NULL) >= 0);
                CHECK_MSG(dense_max_diff(u, want, n) < 1e-10 * dense_max_abs(want, n), "graph %d, %s, t %g: off by %g", g, words,
                          times[q],
                          dense_max_diff(u, want, n));
            }
        }
    }
}

/* On square cells the cotangent pair with mixed areas is the product of two intervals. */
static void heat_neumann_grid(void) {
    const int32_t nx = 13, ny = 8, n = nx * ny, source = 2 * nx + 1;
    const double h = 1.0 / (nx - 1);
    hd_heat *heat = kit_heat(kit_pair("flat/13/8/0 vor"), "tol=1e-11");
    double u[104], want[104], t;
    int32_t i;
    for (t = 0.5; t < 100; t *= 10) {
        for (i = 0; i < n; i++) want[i] = heat_interval(nx, 0, t, i % nx, 1) * heat_interval(ny, 0, t, i / nx, 2) / (h * h);
        CHECK(heat_columns(heat, t * h * h, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, NULL) >= 0);
        CHECK_MSG(dense_max_diff(u, want, n) < 1e-8 * dense_max_abs(want, n), "t %g: off by %g", t, dense_max_diff(u, want, n));
    }
}

/* ---- calling conventions ---- */

/* Many columns in one call are those of single calls, bit for bit, and entries are theirs, in disorder and with repeats. */
static void heat_many_columns(hd_heat *heat, int32_t n, double t, hd_kernel kernel) {
    enum { K = 7 };
    const int32_t ldu = n + 5, sources[K] = {0, 5, 62, 5, 17, 40, 33};
    double *U = KIT_NEW(double, ldu * K), *u = KIT_NEW(double, n), values[3 * K];
    int32_t rows[3 * K], cols[3 * K], q;
    CHECK(heat_columns(heat, t, kernel, K, sources, U, (size_t)ldu, NULL) >= 0);
    for (q = 0; q < K; q++)
        CHECK(heat_columns(heat, t, kernel, 1, sources + q, u, 0, NULL) >= 0 && memcmp(u, U + q * ldu, (size_t)n * sizeof *u) == 0);
    for (q = 0; q < 3 * K; q++) {
        cols[q] = sources[(q * 5) % K];
        rows[q] = (q * 11) % n;
    }
    CHECK(heat_entries(heat, t, kernel, 3 * K, rows, cols, values, NULL) >= 0);
    for (q = 0; q < 3 * K; q++) CHECK(values[q] == U[(q * 5) % K * ldu + rows[q]]);
}

/* And many fields; leading dimensions and places in between are respected, and the report is of the worst. */
static void heat_many(void) {
    enum { K = 7 };
    const hd_laplacian *lap = kit_pair("flat/9/7/0.3 fem");
    const int32_t n = lap->n, ldf = n + 3, ldu = n + 5;
    const double t = 12 * lap->h * lap->h, *F = kit_random(ldf * K, 99);
    double *U = KIT_NEW(double, ldu * K), *u = KIT_NEW(double, n);
    int32_t i, q;
    int k;
    for (k = 0; k < 3; k++) {
        char words[40];
        hd_heat *heat;
        hd_report rep, one;
        int64_t steps = 0;
        snprintf(words, sizeof words, "%s degree=%d", heat_solvers[k], k < 2 ? 8 : 0);
        heat = kit_heat(lap, words);
        for (i = 0; i < ldu * K; i++) U[i] = 1234;
        CHECK(heat_apply(heat, t, K, F, (size_t)ldf, U, (size_t)ldu, &rep) >= 0);
        for (q = 0; q < K; q++) {
            CHECK(heat_apply(heat, t, 1, F + q * ldf, 0, u, 0, &one) >= 0);
            CHECK_MSG(memcmp(u, U + q * ldu, (size_t)n * sizeof *u) == 0, "%s: field %d differs from a call of its own", words, (int)q);
            CHECK(rep.error_bound >= one.error_bound && rep.error_bound_b >= one.error_bound_b && rep.residual >= one.residual);
            steps += one.iterations;
            for (i = n; i < ldu; i++) CHECK(U[q * ldu + i] == 1234);
        }
        CHECK_MSG(steps == rep.iterations, "%lld steps, not %lld", (long long)rep.iterations, (long long)steps);
        heat_many_columns(heat, n, t, HD_KERNEL_OPERATOR);
        heat_many_columns(heat, n, t, HD_KERNEL_SYMMETRIC);
    }
}

static void heat_in_place(void) {
    enum { K = 6 };
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    hd_heat *heat = kit_heat(lap, "");
    double *F = kit_random(42 * K, 2), *U = KIT_NEW(double, 42 * K);
    CHECK(heat_apply(heat, 5 * lap->h * lap->h, K, F, 0, U, 0, NULL) >= 0);
    CHECK(heat_apply(heat, 5 * lap->h * lap->h, K, F, 0, F, 0, NULL) >= 0);
    CHECK(memcmp(F, U, 42 * K * sizeof *F) == 0);
}

/* The plan remembers preconditioners: going back and forth between times, kernels and sets changes nothing. */
static void heat_reuse(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    hd_heat *heat = kit_heat(lap, "");
    const double unit = lap->h * lap->h, *f = kit_random(42, 8);
    double u[3][42], v[42];
    const int32_t source = 9;
    int k;
    for (k = 0; k < 9; k++) {
        const int q = k % 3;
        hd_heat *plan = k < 3 ? kit_heat(lap, "") : heat;
        double *to = k < 3 ? u[q] : v;
        if (q == 0) CHECK(heat_apply(plan, 3 * unit, 1, f, 0, to, 0, NULL) >= 0);
        if (q == 1) CHECK(heat_columns(plan, 3 * unit, HD_KERNEL_SYMMETRIC, 1, &source, to, 0, NULL) >= 0);
        if (q == 2) CHECK(heat_column(plan, 70 * unit, source, to, NULL) >= 0);
        if (k >= 3) CHECK(memcmp(u[q], v, sizeof v) == 0);
    }
}

/* A value that is not finite, in a later field: nothing is written before it is seen. Vertices that there are not. */
static void heat_errors(void) {
    const hd_laplacian *lap = kit_pair("ico/0 fem");
    double *F = kit_random(36, 1), U[36];
    hd_report rep;
    int i, k;
    for (i = 0; i < 4; i++) {
        const int32_t wrong[3] = {0, i % 2 ? -5 : 12, 2}, good[3] = {1, 3, 4};
        hd_heat *heat = kit_heat(lap, i < 2 ? "" : "solver=lanczos");
        F[12 + 7] = i % 2 ? -(double)INFINITY : (double)NAN;
        U[0] = 77;
        for (k = 0; k < 2; k++) {
            CHECK(heat_apply(heat, k, 3, F, 0, U, 0, &rep) == HD_ERR_NOT_FINITE && rep.status == HD_ERR_NOT_FINITE && U[0] == 77);
            CHECK(rep.error.status == HD_ERR_NOT_FINITE && rep.error.text[0] && rep.error.row == 7 && rep.error.column == 1);
            CHECK(heat_columns(heat, 1, (hd_kernel)k, 3, wrong, U, 0, &rep) == HD_ERR_INDEX && rep.error.column == 1);
            CHECK(rep.error.status == HD_ERR_INDEX && rep.error.vertex == wrong[1] && rep.error.value == wrong[1]);
            CHECK(heat_entries(heat, 1, HD_KERNEL_OPERATOR, 3, k ? wrong : good, k ? good : wrong, U, &rep) == HD_ERR_INDEX);
            CHECK(rep.error.vertex == wrong[1] && rep.error.row == 1);
        }
        CHECK(heat_column(heat, 1, wrong[1], U, &rep) == HD_ERR_INDEX && rep.error.vertex == wrong[1]);
    }
}

static void heat_not_converged(void) {
    const hd_laplacian *lap = kit_pair("bumpy/2/2 fem");
    double *u = KIT_NEW(double, lap->n);
    int k;
    for (k = 0; k < 3; k++) {
        const trial c = trial_parse(heat_solvers[k]);
        hd_heat_opts o = trial_options(&c);
        hd_heat *heat;
        hd_report rep;
        o.max_iterations = 2;
        o.precond = HD_PRECOND_JACOBI;
        heat = kit_plan(lap, &o);
        CHECK(heat_column(heat, 500 * lap->h * lap->h, 3, u, &rep) == HD_ERR_NOT_CONVERGED);
        CHECK(rep.status == HD_ERR_NOT_CONVERGED && rep.error.status == HD_ERR_NOT_CONVERGED && rep.error.value > 1e-9 &&
              rep.error.column == 0);
        CHECK_MSG((rep.error.pole >= 0) == (k < 2) && rep.residual == rep.error.value, "achieved %g, reported %g", rep.error.value,
                  rep.residual);
    }
}

/* Lanczos stops soon after its bound has come to the tolerance, however many steps apart it looks. */
static void heat_lanczos_pace(void) {
    const hd_laplacian *lap = kit_pair("bumpy/3/4 fem");
    double *u = KIT_NEW(double, lap->n), below = 0;
    int k;
    for (k = 8; k <= 16; k++) {
        char options[60];
        hd_report rep;
        snprintf(options, sizeof options, "method=iterative solver=lanczos tol=%g", pow(10, -0.5 * k));
        CHECK(heat_column(kit_heat(lap, options), 3000 * lap->h * lap->h, 3, u, &rep) >= 0 && rep.iterations > 120);
        below += -0.5 * k - log10(rep.error_bound_b);
    }
    CHECK_MSG(below < 0.8, "%g decades more than asked for, at nine tolerances", below);
}

/* ---- threads ---- */

static hd_progress heat_progress(void *user, const char *stage, double done) {
    ++*(int64_t *)user;
    return stage && done >= 0 && done <= 1 ? HD_PROGRESS_CONTINUE : HD_PROGRESS_CANCEL;
}

/* The same bits and the same report, whoever does the work. */
static void heat_threads(void) {
    enum { K = 6, WAYS = 6 };
    static const int32_t threads[WAYS] = {1, 0, 2, 3, 1, 1};
    const shape *s = kit_shape("bumpy/2/6");
    const int32_t n = s->n, sources[K] = {3, 70, 11, 150, 0, 42};
    double *first = KIT_NEW(double, n * K), *u = KIT_NEW(double, n * K);
    int64_t calls = 0, progress = 0;
    int k, way;
    for (k = 0; k < 3 * WAYS; k++) {
        const trial c = trial_parse(heat_solvers[k / WAYS]);
        hd_context ctx;
        hd_laplacian_opts lo;
        hd_heat_opts ho = trial_options(&c);
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        hd_report rep;
        static hd_report rep0;
        way = k % WAYS;
        memset(&ctx, 0, sizeof ctx);
        memset(&lo, 0, sizeof lo);
        ctx.n_threads = threads[way];
        ctx.parallel_user = &calls;
        ctx.progress_user = &progress;
        if (way == 4) ctx.parallel_for = sparse_reverse_for;
        if (way == 5) ctx.parallel_for = heat_shuffled_for;
        if (way == 5) ctx.progress = heat_progress;
        lo.context = ho.context = &ctx;
        CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, n, s->tri, s->n_tri), &lo, NULL) == HD_OK &&
              hd_heat_create(&heat, lap, &ho, NULL) == HD_OK);
        CHECK(heat_columns(heat, 8 * lap->h * lap->h, HD_KERNEL_OPERATOR, K, sources, way ? u : first, 0, &rep) >= 0);
        if (way == 0) rep0 = rep;
        CHECK_MSG(way == 0 || memcmp(u, first, (size_t)(n * K) * sizeof *u) == 0, "%s: way %d of threading gives other bits",
                  heat_solvers[k / WAYS], way);
        CHECK(rep.iterations == rep0.iterations && rep.error_bound == rep0.error_bound && rep.residual == rep0.residual);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        CHECK(ctx.bytes_in_use == 0);
    }
    CHECK(calls > 0 && progress > 0);
}

static void test_heat(void) {
    heat_cases();
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
    heat_many();
    heat_in_place();
    heat_reuse();
    heat_errors();
    heat_not_converged();
    heat_lanczos_pace();
    heat_threads();
}

#endif
