/* test_krylov.h - (t L + theta B) x = b by every solver and preconditioner, against dense LU */

#ifndef TEST_KRYLOV_H
#define TEST_KRYLOV_H

static const hd_solver kry_solvers[2] = {HD_SOLVER_COCG, HD_SOLVER_MINRES};
static const hd_precond kry_preconds[5] = {HD_PRECOND_NONE, HD_PRECOND_JACOBI, HD_PRECOND_SSOR, HD_PRECOND_ILDL, HD_PRECOND_MILDL};

/* Poles on both sides, some nearly imaginary, some far from the axis: a stray conjugate cannot hide. */
static const hd_c64 kry_thetas[6] = {{2.4, 2.4}, {0.05, 11}, {-9.7, 15.8}, {1, -30}, {0.7, 0}, {5, 0}};

/* The dense solution on vertices; inert ones get 0. */
static void kry_dense(const hd_laplacian *lap, double t, hd_c64 theta, const hd_c64 *rhs, hd_c64 *x) {
    const int32_t n = lap->n_active;
    double *L = test_dense(&lap->L, NULL), *B = test_dense_mass(lap);
    dense_c64 *a = KIT_NEW(dense_c64, (int64_t)n * n), *b = KIT_NEW(dense_c64, n);
    int32_t i;
    for (i = 0; i < n * n; i++) a[i] = dense_c(t * L[i] + theta.re * B[i], theta.im * B[i]);
    for (i = 0; i < n; i++) b[i] = dense_c(rhs[lap->vertex[i]].re, rhs[lap->vertex[i]].im);
    CHECK(dense_complex_solve(a, b, n));
    memset(x, 0, (size_t)lap->n * sizeof *x);
    for (i = 0; i < n; i++) x[lap->vertex[i]] = test_c(b[i].re, b[i].im);
    free(L);
    free(B);
}

/* |x|_B of a vector on vertices. */
static double kry_norm(const hd_laplacian *lap, const hd_c64 *x) {
    const int32_t n = lap->n, mark = kit_mark();
    double *part = KIT_NEW(double, n), *y = KIT_NEW(double, n), s = 0;
    int32_t i, k;
    for (k = 0; k < 2; k++) {
        for (i = 0; i < n; i++) part[i] = k ? x[i].im : x[i].re;
        CHECK(hd_laplacian_apply(lap, 0, 1, part, y, NULL) == HD_OK);
        s += dense_dot(part, y, n);
    }
    kit_release(mark);
    return s > 0 ? sqrt(s) : 0;
}

/* |b - A x| / |b| in the norm of diag(B)^-1, computed here. */
static double kry_residual(const hd_laplacian *lap, double t, hd_c64 theta, const hd_c64 *b, const hd_c64 *x) {
    double *part = KIT_NEW(double, lap->n), *l = KIT_NEW(double, lap->n), *m = KIT_NEW(double, lap->n), up = 0, down = 0;
    hd_c64 *r = KIT_NEW(hd_c64, lap->n);
    int32_t i, k;
    for (i = 0; i < lap->n; i++) r[i] = b[i];
    for (k = 0; k < 2; k++) {
        for (i = 0; i < lap->n; i++) part[i] = k ? x[i].im : x[i].re;
        CHECK(hd_laplacian_apply(lap, t, 0, part, l, NULL) == HD_OK && hd_laplacian_apply(lap, 0, 1, part, m, NULL) == HD_OK);
        for (i = 0; i < lap->n; i++) {           /* part stands for part or i part */
            r[i].re -= k ? -theta.im * m[i] : l[i] + theta.re * m[i];
            r[i].im -= k ? l[i] + theta.re * m[i] : theta.im * m[i];
        }
    }
    for (i = 0; i < lap->n_active; i++) {
        const int32_t v = lap->vertex[i];
        up += (r[v].re * r[v].re + r[v].im * r[v].im) / lap->b_diag[i];
        down += (b[v].re * b[v].re + b[v].im * b[v].im) / lap->b_diag[i];
    }
    return sqrt(up / down);
}

static void kry_one(const hd_laplacian *lap, double t, hd_c64 theta, const hd_c64 *rhs, const hd_c64 *want, hd_solver solver, hd_precond precond,
                    const char *what) {
    const int32_t mark = kit_mark();
    hd_c64 *x = KIT_NEW(hd_c64, lap->n);
    hd_solve_opts o;
    hd_solve_report rep;
    hd_error e;
    hd_status st;
    int32_t i;
    double off = HUGE_VAL, size = kry_norm(lap, want), slack = 0;
    for (i = 0; i < lap->n_active; i++) slack = fmax(slack, lap->L.val[op_find(&lap->L, i, i)] / lap->b_diag[i]);
    slack = 1e-12 + 4 * DBL_EPSILON * t * slack / hypot(theta.re, theta.im);    /* the oracle's own rounding */
    memset(&o, 0, sizeof o);
    memset(&rep, 0, sizeof rep);
    o.solver = solver;
    o.precond = precond;
    o.tol = 1e-12;
    memcpy(x, rhs, (size_t)lap->n * sizeof *x);
    st = hd_shifted_solve(lap, t, theta, x, x, &o, &rep, &e);    /* in place */
    for (i = 0; st >= 0 && i < lap->n; i++) {
        if (lap->row[i] < 0) CHECK(x[i].re == 0 && x[i].im == 0);
        x[i].re -= want[i].re;
        x[i].im -= want[i].im;
    }
    if (st >= 0) off = kry_norm(lap, x);
    CHECK_MSG(off <= 1e-9 * size && off <= (rep.error_b + slack) * size && (rep.residual <= 1e-12 || st == HD_WARN_ACCURACY),
              "%s: solver %d precond %d theta %g%+gi t %g: off by %g, bound %g, residual %g: %s", what, (int)solver, (int)precond, theta.re, theta.im, t,
              off / size, rep.error_b, rep.residual, e.text);
    kit_release(mark);
}

static void kry_random(const hd_laplacian *lap, uint64_t seed, hd_c64 *rhs) {
    int32_t i;
    for (i = 0; i < lap->n; i++) {
        rhs[i].re = dense_signed(&seed);
        rhs[i].im = 3 * dense_signed(&seed);
    }
}

static void kry_all(const hd_laplacian *lap, double unit, const char *what) {
    static const double times[3] = {0.4, 25, 3000};
    hd_c64 *rhs = KIT_NEW(hd_c64, lap->n), *want = KIT_NEW(hd_c64, lap->n);
    int i;
    for (i = 0; i < 18 * 10; i++) {              /* times, shifts; solvers, preconditioners */
        const double t = times[i / 60] * unit;
        const hd_c64 theta = kry_thetas[i / 10 % 6];
        if (i % 10 == 0) {
            kry_random(lap, (uint64_t)(1 + i), rhs);
            kry_dense(lap, t, theta, rhs, want);
        }
        kry_one(lap, t, theta, rhs, want, kry_solvers[i / 5 % 2], kry_preconds[i % 5], what);
    }
}

/* A path with its ends held at zero: L 1 is not 0, nothing is conserved, no constants to deflate. */
static hd_laplacian *kry_dirichlet(int32_t n) {
    hd_csr L = kit_own_csr(test_path_csr(n, 0)), B = kit_own_csr(test_path_csr(n, 1));
    hd_laplacian *lap = NULL;
    hd_error e;
    int64_t p;
    int32_t i;
    for (i = 0; i < n; i++) {
        for (p = L.row_ptr[i]; p < L.row_ptr[i + 1]; p++)
            if (L.col[p] == i) L.val[p] = 2;
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 4 + 0.1 * i : 1;    /* a full B, on a cycle */
    }
    CHECK_MSG(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, &e) == HD_OK, "%s", e.text);
    CHECK(lap && lap->conserves == 0);
    return lap;
}

static void kry_against_dense(void) {
    static const char *const pairs[3] = {"bumpy/1/5 fem", "bumpy/1/5 vor", "bumpy/1/5 cot"};
    const double offset[3] = {4, 0, 0};
    shape two = kit_own_shape(shape_disjoint(kit_shape("bumpy/1/5"), kit_shape("flat/6/5/0.4"), offset));
    const hd_laplacian *lap;
    int32_t f;
    int q;
    for (q = 0; q < 3; q++) {
        lap = kit_pair(pairs[q]);
        kry_all(lap, q == 2 ? 1 : lap->h * lap->h, pairs[q]);
    }
    for (f = 0; f < 3 * two.n_tri; f++)          /* vertex 7 leaves all its faces: inert, in the midst of the others */
        if (two.tri[f] == 7) two.tri[f] = two.tri[f - f % 3 + (f + 1) % 3];
    lap = kit_triangles(&two, HD_LAPLACIAN_FEM);
    CHECK(lap->n_components == 2 && lap->row[7] == -1 && lap->n_active == lap->n - 1);
    kry_all(lap, lap->h * lap->h, "two pieces");
    kry_all(kit_own_laplacian(kry_dirichlet(33)), 1, "dirichlet");
}

/* Smallest ones: a single vertex, and a single triangle. */
static void kry_tiny(void) {
    const double d = 2.5, xyz[9] = {0, 0, 0, 3, 0, 0, 0, 4, 0};
    const int32_t tri[3] = {0, 1, 2};
    hd_csr L = kit_own_csr(test_diagonal_csr(1, &d)), B = kit_own_csr(test_diagonal_csr(1, &d));
    hd_laplacian *lap = NULL;
    hd_c64 rhs = {3, -4}, x;
    int k, q;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK && lap->conserves == 0);
    for (k = 0; k < 2; k++) {
        for (q = 0; q < 5; q++) {
            hd_solve_opts o;
            memset(&o, 0, sizeof o);
            o.solver = kry_solvers[k];
            o.precond = kry_preconds[q];
            CHECK(hd_shifted_solve(lap, 2, test_c(-1, 2), &rhs, &x, &o, NULL, NULL) >= 0);    /* 2.5 (1 + 2i) x = 3 - 4i */
            CHECK_MSG(hypot(x.re + 0.4, x.im + 0.8) < 1e-9, "%g %+g i", x.re, x.im);
        }
    }
    hd_laplacian_free(lap);
    lap = op_make(xyz, 3, tri, 1, HD_LAPLACIAN_FEM);
    kry_all(lap, 16, "one triangle");
}

/* Masses below 1e-100 are refused, and those that are just larger serve. */
static void kry_tiny_masses(void) {
    const hd_laplacian *lap = kit_pair("ico/0 fem");
    hd_laplacian *tiny = NULL;
    hd_c64 rhs[12], x[12];
    hd_solve_opts o;
    hd_solve_report rep;
    hd_error e;
    hd_csr B = lap->L;
    double *mass = KIT_NEW(double, lap->L.nnz);
    int64_t p;
    int32_t i;
    int k;
    B.val = mass;
    for (p = 0; p < lap->L.nnz; p++) mass[p] = lap->B[p] * 1e-100;
    CHECK(hd_laplacian_matrices(&tiny, &lap->L, &B, 0, NULL, &e) == HD_ERR_NOT_POSITIVE && e.row == 0 && e.column == 0 && e.value == mass[0] &&
          strstr(e.text, "1e-100"));
    for (p = 0; p < lap->L.nnz; p++) mass[p] = lap->B[p] * 1e-98;
    memset(&o, 0, sizeof o);
    CHECK(hd_laplacian_matrices(&tiny, &lap->L, &B, 0, NULL, &e) >= 0);
    for (i = 0; i < 12; i++) rhs[i] = test_c(i - 5, -0.5);
    for (k = 0; k < 2 && tiny; k++) {                /* 1'(t L + theta B) x = theta 1'B x */
        double re = 0, im = 0;
        o.solver = kry_solvers[k];
        CHECK(hd_shifted_solve(tiny, 1e-3, test_c(-4, -4), rhs, x, &o, &rep, &e) == HD_OK && rep.residual < 1e-8);
        for (i = 0; i < 12; i++) {
            re += tiny->mass[i] * x[i].re;
            im += tiny->mass[i] * x[i].im;
        }
        CHECK_MSG(fabs(-4 * re + 4 * im - 6) < 1e-6 && fabs(-4 * re - 4 * im + 6) < 1e-6, "%g %g", -4 * re + 4 * im, -4 * re - 4 * im);
    }
    hd_laplacian_free(tiny);
}

/* t = 0: theta B x = b, and the zero right-hand side. */
static void kry_special(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    hd_c64 *rhs = KIT_NEW(hd_c64, lap->n), *want = KIT_NEW(hd_c64, lap->n), *x = KIT_NEW(hd_c64, lap->n);
    hd_solve_report rep;
    int32_t i;
    int k;
    kry_random(lap, 6, rhs);
    kry_dense(lap, 0, test_c(-3, 7), rhs, want);
    for (k = 0; k < 2; k++) kry_one(lap, 0, test_c(-3, 7), rhs, want, kry_solvers[k], HD_PRECOND_AUTO, "t = 0");
    memset(rhs, 0, (size_t)lap->n * sizeof *rhs);
    memset(x, 0x7f, (size_t)lap->n * sizeof *x);
    CHECK(hd_shifted_solve(lap, 1, test_c(1, 1), rhs, x, NULL, &rep, NULL) == HD_OK);
    CHECK(rep.iterations == 0 && rep.residual == 0 && rep.error_b == 0);
    for (i = 0; i < lap->n; i++) CHECK(x[i].re == 0 && x[i].im == 0);
    for (i = 0; i < lap->n; i++) rhs[i] = test_c(lap->mass[i], 2 * lap->mass[i]);    /* B (1 + 2i): the solution is a constant */
    CHECK(hd_shifted_solve(lap, 1, test_c(0, 2), rhs, x, NULL, &rep, NULL) >= 0);
    for (i = 0; i < lap->n; i++) CHECK(hypot(x[i].re - 1, x[i].im + 0.5) < 1e-14);
}

static void kry_not_converged(void) {
    const hd_laplacian *lap = kit_pair("bumpy/2/1 fem");
    const double t = 1000 * lap->h * lap->h;
    const hd_c64 theta = {0.1, 0.3};
    hd_c64 *rhs = KIT_NEW(hd_c64, lap->n), *x = KIT_NEW(hd_c64, lap->n);
    hd_solve_opts o;
    hd_solve_report rep;
    hd_error e;
    int k;
    kry_random(lap, 8, rhs);
    for (k = 0; k < 2; k++) {
        double own;
        memset(&o, 0, sizeof o);
        memset(&rep, 0, sizeof rep);
        o.solver = kry_solvers[k];
        o.precond = HD_PRECOND_JACOBI;
        o.max_iterations = 3;
        CHECK(hd_shifted_solve(lap, t, theta, rhs, x, &o, &rep, &e) == HD_ERR_NOT_CONVERGED && e.status == HD_ERR_NOT_CONVERGED);
        CHECK_MSG(rep.iterations == 3, "%lld iterations", (long long)rep.iterations);
        own = kry_residual(lap, t, theta, rhs, x);
        CHECK_MSG(fabs(rep.residual - own) < 1e-10 * own && own > 1e-10, "residual %g, not %g", rep.residual, own);
        o.max_iterations = 0;
        CHECK(hd_shifted_solve(lap, t, theta, rhs, x, &o, &rep, &e) >= 0);
        own = kry_residual(lap, t, theta, rhs, x);
        CHECK_MSG(own <= 1.01e-10, "residual %g", own);
    }
}

static void kry_errors(void) {
    const double bad[3][2] = {{-2, 0}, {1, (double)INFINITY}, {(double)NAN, 1}};
    const hd_laplacian *lap = kit_pair("ico/0 fem");
    hd_c64 rhs[12], x[12];
    hd_error e;
    int k;
    memset(rhs, 0, sizeof rhs);
    for (k = 0; k < 2; k++)
        CHECK(hd_shifted_solve(lap, 1, test_c(bad[k][0], bad[k][1]), rhs, x, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT);
}

/* Right-hand sides of any size: the answer scales with them, whatever squares would do. Values that are none are told. */
static void kry_sizes(void) {
    static const double sizes[6] = {1, 1e-170, 1e-230, 1e160, 1e200, 1e240};
    const double scales[3] = {1, 1e-30, 1e30};
    shape s = kit_own_shape(shape_bumpy(1, 5));
    hd_c64 *rhs = KIT_NEW(hd_c64, s.n), *x = KIT_NEW(hd_c64, s.n), *want = KIT_NEW(hd_c64, s.n);
    hd_solve_report rep;
    hd_solve_opts o;
    hd_error e;
    int32_t v;
    int k, q, r, pick;
    memset(&o, 0, sizeof o);
    for (pick = 0; pick < 3; pick++) {
        shape own = kit_own_shape(shape_bumpy(1, 5));
        hd_laplacian *lap;
        double h2;
        for (v = 0; v < 3 * s.n; v++) own.xyz[v] *= scales[pick];
        lap = kit_triangles(&own, pick ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        h2 = lap->h * lap->h;
        for (k = 0; k < 2; k++) {
            o.solver = kry_solvers[k];
            for (q = 0; q < 6; q++) {
                double off = 0;
                const double size = sizes[q] * h2;
                for (v = 0; v < s.n; v++) rhs[v] = test_c(size * sin(1.0 + v), size * (v % 3));
                memset(&rep, 0, sizeof rep);
                CHECK(hd_shifted_solve(lap, 3 * h2, test_c(-1, 2), rhs, q ? x : want, &o, &rep, &e) == HD_OK);
                CHECK_MSG(rep.residual > 0 && rep.residual <= 1e-10 && rep.error_b > 0 && rep.error_b < 1e-8, "size %g: residual %g, error %g", size, rep.residual, rep.error_b);
                for (v = 0; v < s.n && q; v++) off = fmax(off, hypot(x[v].re / sizes[q] - want[v].re, x[v].im / sizes[q] - want[v].im) / hypot(want[v].re, want[v].im));
                CHECK_MSG(off < 1e-8, "size %g, scale %g, solver %d: off by %g", size, scales[pick], k, off);
            }
            for (q = 0; q < 4; q++) {
                const double bad = q % 2 ? (double)NAN : -(double)INFINITY;
                rhs[7] = test_c(q < 2 ? bad : 1, q < 2 ? 0 : bad);
                CHECK(hd_shifted_solve(lap, 3 * h2, test_c(-1, 2), rhs, x, &o, &rep, &e) == HD_ERR_NOT_FINITE && e.row == 7 && !isfinite(e.value));
            }
            rhs[7] = test_c(0, 0);
        }
        for (r = 0; r < s.n; r++) rhs[r] = test_c(0, 0);
        CHECK(hd_shifted_solve(lap, 3 * h2, test_c(-1, 2), rhs, x, NULL, &rep, &e) == HD_OK && x[3].re == 0 && rep.residual == 0);
        for (r = 0; r < s.n; r++) rhs[r] = test_c(1e308, 0);
        if (pick == 1) CHECK(hd_shifted_solve(lap, 3 * h2, test_c(-1, 2), rhs, x, NULL, &rep, &e) == HD_ERR_NOT_FINITE && e.row >= 0);    /* over areas of 1e-60 */
    }
}

static void kry_steps(const hd_laplacian *lap, double t, hd_c64 theta, int64_t steps[5]) {
    hd_c64 *x = KIT_NEW(hd_c64, lap->n);
    int k;
    for (k = 0; k < 5; k++) {
        hd_solve_opts o;
        hd_solve_report rep;
        memset(&o, 0, sizeof o);
        memset(x, 0, (size_t)lap->n * sizeof *x);
        x[7] = test_c(1, 2);
        o.solver = HD_SOLVER_COCG;
        o.precond = kry_preconds[k];
        CHECK(hd_shifted_solve(lap, t, theta, x, x, &o, &rep, NULL) == HD_OK);
        steps[k] = rep.iterations;
    }
}

/* The preconditioner asked for is the one that works: the diagonal helps where rows differ, the others each more; an exact factor, of a cycle in
 * its order, takes few steps. The order is found again where rows are shuffled. */
static void kry_precond_asked(void) {
    static const struct { const char *pair; double most[4]; } rows[4] = {      /* of the steps before, ILDL and MILDL of those of SSOR */
        {"grid/16/2 fem", {0.8, 0.55, 0.5, 0.6}}, {"flat/20/30/0.2 vor", {0.97, 0.42, 0.85, 0.7}}, {"needles/2 fem", {0.99, 0.5, 0.8, 0.95}},
        {"path/60 diag", {0.1, 0.6, 0.5, 0.5}}};
    const hd_laplacian *lap = kit_own_laplacian(kry_dirichlet(60));
    hd_laplacian *shuffled = NULL;
    hd_csr L, B = lap->L;
    int32_t perm[60];
    uint64_t seed = 3;
    int64_t steps[5], again[5];
    int k, q;
    dense_shuffle(perm, lap->n, &seed);
    B.val = lap->B;
    L = kit_own_csr(test_csr_ordered(&lap->L, perm));
    B = kit_own_csr(test_csr_ordered(&B, perm));
    CHECK(hd_laplacian_matrices(&shuffled, &L, &B, 1, NULL, NULL) == HD_OK);
    kry_steps(lap, 30, test_c(0.1, 1), steps);
    kry_steps(kit_own_laplacian(shuffled), 30, test_c(0.1, 1), again);
    CHECK_MSG(steps[3] <= 4 && again[3] <= 4 && steps[1] >= 12, "%d steps with the diagonal, %d with a factor, %d of shuffled rows", (int)steps[1],
              (int)steps[3], (int)again[3]);
    for (k = 0; k < 4; k++) {
        lap = kit_pair(rows[k].pair);
        kry_steps(lap, 300 * trial_unit(lap), test_c(0.1, 1), steps);
        for (q = 1; q < 5; q++) {
            const int64_t than = steps[q < 3 ? q - 1 : 2];
            CHECK_MSG((double)steps[q] <= rows[k].most[q - 1] * (double)than, "%s, preconditioner %d: %d steps, not far fewer than %d", rows[k].pair, q,
                      (int)steps[q], (int)than);
        }
    }
}

static void test_krylov(void) {
    kry_precond_asked();
    kry_against_dense();
    kry_tiny();
    kry_special();
    kry_tiny_masses();
    kry_not_converged();
    kry_errors();
    kry_sizes();
}

#endif
