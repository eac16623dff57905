/* test_spectrum.h - eigenpairs against dense eigensolutions and closed forms, proofs of completeness, truncated kernels */

#ifndef TEST_SPECTRUM_H
#define TEST_SPECTRUM_H

#define SPEC_PI 3.14159265358979323846

static hd_spectrum *spec_make(const hd_laplacian *lap, int32_t count, double below, hd_status want) {
    hd_spectrum_opts o;
    hd_spectrum *s = NULL;
    hd_error e;
    hd_status st;
    memset(&o, 0, sizeof o);
    o.count = count;
    o.below = below;
    st = hd_spectrum_create(&s, lap, &o, &e);
    CHECK_MSG(st == want && (st < 0) == !s, "%d pairs of %d: %s %s", count, lap->n_active, hd_status_name(st), st < 0 ? e.text : "");
    return s;
}

static int spec_compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Residuals and orthogonality, computed here. */
static void spec_check_vectors(const hd_laplacian *lap, const hd_spectrum *s, double tol, const char *what) {
    double *y = DENSE_NEW(double, lap->n), *b = DENSE_NEW(double, lap->n), worst = 0, orth = 0, off = 0;
    int32_t q, p, i;
    for (q = 0; q < s->count; q++) {
        const double *x = s->vector + (size_t)q * (size_t)s->n;
        const double first = s->n_constant < s->count ? s->value[s->n_constant] : 1;
        double r = 0, big = 0;
        CHECK(hd_laplacian_apply(lap, 1, -s->value[q], x, y, NULL) == HD_OK && hd_laplacian_apply(lap, 0, 1, x, b, NULL) == HD_OK);
        for (i = 0; i < lap->n_active; i++) r += y[lap->vertex[i]] * y[lap->vertex[i]] / lap->b_diag[i];
        r = sqrt(r) / fmax(s->value[q], first);
        worst = fmax(worst, r);
        if (q >= s->n_constant) off = fmax(off, fabs(r - s->residual[q]));
        for (p = 0; p <= q; p++) orth = fmax(orth, fabs(dense_dot(b, s->vector + (size_t)p * (size_t)s->n, s->n) - (p == q)));
        for (i = 0; i < s->n; i++)
            if (fabs(x[i]) > fabs(big)) big = x[i];
        CHECK(big > 0 && (q == 0 || s->value[q] >= s->value[q - 1]));
    }
    CHECK_MSG(worst < tol && off < 0.1 * tol && orth < 1e-12, "%s: residual %g, told off by %g, orthogonal to %g", what, worst, off, orth);
    free(y);
    free(b);
}

/* The sorted eigenvalues of a pair, dense. */
static dense_pair spec_dense(const hd_laplacian *lap, double **sorted) {
    dense_pair p;
    CHECK(dense_pair_solve(&p, test_dense(&lap->L, NULL), test_dense_mass(lap), lap->n_active));
    *sorted = DENSE_NEW(double, lap->n_active);
    memcpy(*sorted, p.lambda, (size_t)lap->n_active * sizeof **sorted);
    qsort(*sorted, (size_t)lap->n_active, sizeof **sorted, spec_compare);
    return p;
}

static void spec_check_values(const hd_spectrum *s, const double *want, int32_t n, const char *what) {
    double off = 0;
    int32_t i;
    for (i = 0; i < s->count; i++) off = fmax(off, fabs(s->value[i] - want[i]));
    CHECK_MSG(off <= 1e-11 * want[n - 1] && s->proven, "%s, %d pairs: off by %g of %g, proven %d", what, s->count, off, want[n - 1], s->proven);
    if (s->count < n) CHECK_MSG(s->next <= want[s->count] * (1 + 1e-11) && s->next >= want[s->count > 0 ? s->count - 1 : 0] * (1 - 1e-8) - 1e-9 * want[n - 1],
                                "%s, %d pairs: the next is %g, bound %g", what, s->count, want[s->count], s->next);
    else CHECK(s->next == HUGE_VAL);
}

static void spec_against_dense(void) {
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    shape s[4];
    const double apart[3] = {9, 0, 0};
    int32_t k, q, c;
    s[0] = shape_icosphere(2);
    s[1] = shape_torus(13, 9, 2, 0.8);
    s[2] = shape_grid(10, 9, 0.3);
    s[3] = shape_disjoint(s + 1, s + 1, apart);
    for (k = 0; k < 4; k++) {
        for (q = 0; q < 3; q++) {
            hd_laplacian *lap = test_laplacian(s + k, kinds[q]);
            const int32_t n = lap->n_active, counts[6] = {1, 2, 10, n / 2, n - 1, n};
            double *want;
            dense_pair p = spec_dense(lap, &want);
            char what[60];
            snprintf(what, sizeof what, "shape %d, kind %d", k, q);
            for (c = 0; c < 6; c++) {
                hd_spectrum *z = spec_make(lap, counts[c], 0, HD_OK);
                if (!z) continue;
                CHECK(z->count == counts[c] && z->n == lap->n && z->n_constant == (counts[c] > 1 && k == 3 ? 2 : 1));
                spec_check_values(z, want, n, what);
                spec_check_vectors(lap, z, 2e-10, what);
                hd_spectrum_free(z);
            }
            dense_pair_free(&p);
            free(want);
            hd_laplacian_free(lap);
        }
    }
    for (k = 0; k < 4; k++) shape_free(s + k);
}

/* A torus of nx x ny nodes, or a path or cycle with ny = 1: B = I. */
static hd_laplacian *spec_lattice(int32_t nx, int32_t ny, int closed) {
    int32_t *a = DENSE_NEW(int32_t, 2 * nx * ny), *b = DENSE_NEW(int32_t, 2 * nx * ny), i, j, m = 0;
    double *w = DENSE_NEW(double, 2 * nx * ny);
    hd_laplacian *lap;
    for (i = 0; i < nx; i++)
        for (j = 0; j < ny; j++) {
            if (closed || i + 1 < nx) {
                a[m] = i * ny + j;
                b[m++] = (i + 1) % nx * ny + j;
            }
            if (ny > 1) {
                a[m] = i * ny + j;
                b[m++] = i * ny + (j + 1) % ny;
            }
        }
    for (i = 0; i < m; i++) w[i] = 1;
    lap = bnd_graph(nx * ny, m, a, b, w, NULL, 1);
    free(a);
    free(b);
    free(w);
    return lap;
}

/* Its eigenvalues. */
static double *spec_lattice_values(int32_t nx, int32_t ny, int closed) {
    double *v = DENSE_NEW(double, nx * ny);
    int32_t i, j;
    for (i = 0; i < nx; i++)
        for (j = 0; j < ny; j++) {
            const double x = sin(SPEC_PI * i / (closed ? nx : 2 * nx)), y = sin(SPEC_PI * j / ny);
            v[i * ny + j] = 4 * x * x + (ny > 1 ? 4 * y * y : 0);
        }
    qsort(v, (size_t)(nx * ny), sizeof *v, spec_compare);
    return v;
}

static void spec_closed_forms(void) {
    static const int32_t nx[5] = {40, 24, 32, 900, 901}, ny[5] = {30, 24, 32, 1, 1}, closed[5] = {1, 1, 1, 0, 1}, count[5] = {120, 200, 90, 100, 80};
    int32_t k;
    for (k = 0; k < 5; k++) {
        hd_laplacian *lap = spec_lattice(nx[k], ny[k], closed[k]);
        double *want = spec_lattice_values(nx[k], ny[k], closed[k]);
        hd_spectrum *z = spec_make(lap, count[k], 0, HD_OK);
        char what[60];
        snprintf(what, sizeof what, "%d x %d", nx[k], ny[k]);
        if (z) spec_check_values(z, want, nx[k] * ny[k], what);
        /* a path of 900 has eigenvalues of 1e-5, where rounding of L x is 1e-15 */
        if (z) spec_check_vectors(lap, z, nx[k] < 900 ? 2e-10 : 1e-9, what);
        hd_spectrum_free(z);
        hd_laplacian_free(lap);
        free(want);
    }
}

/* Copies of one piece: every eigenvalue as often, more often than a block has vectors; a cycle has pairs of them on top. */
static void spec_copies(void) {
    enum { COPIES = 21, N = 12 };
    int32_t a[COPIES * N], b[COPIES * N], i, k, c;
    double w[COPIES * N], want[COPIES * N], *one = spec_lattice_values(N, 1, 1);
    const int32_t counts[4] = {5, COPIES, 100, COPIES * N};
    hd_laplacian *lap;
    for (k = 0; k < COPIES; k++)
        for (i = 0; i < N; i++) {
            a[k * N + i] = k * N + i;
            b[k * N + i] = k * N + (i + 1) % N;
            w[k * N + i] = 1;
            want[i * COPIES + k] = one[i];
        }
    lap = bnd_graph(COPIES * N, COPIES * N, a, b, w, NULL, 1);
    for (c = 0; c < 4; c++) {
        hd_spectrum *z = spec_make(lap, counts[c], 0, HD_OK);
        if (z) spec_check_values(z, want, COPIES * N, "copies");
        if (z) spec_check_vectors(lap, z, 2e-10, "copies");
        hd_spectrum_free(z);
    }
    hd_laplacian_free(lap);
    free(one);
}

/* Two rings, one of them stiffer by so much that shifts have far to go from the last value of the one to the
 * first of the other. */
static void spec_far_apart(void) {
    enum { N = 12 };
    static const double stiff[4] = {1e3, 1e11, 1e60, 1e150};   /* beyond the digits there is an error */
    int32_t a[2 * N], b[2 * N], i, c;
    double w[2 * N], want[2 * N], *one = spec_lattice_values(N, 1, 1);
    for (c = 0; c < 4; c++) {
        hd_laplacian *lap;
        hd_spectrum *z;
        for (i = 0; i < 2 * N; i++) {
            a[i] = i;
            b[i] = i / N * N + (i + 1) % N;
            w[i] = i < N ? 1 : stiff[c];
            want[i] = i < 2 ? 0 : i < N + 1 ? one[i - 1] : stiff[c] * one[i - N];
        }
        lap = bnd_graph(2 * N, 2 * N, a, b, w, NULL, 1);
        z = spec_make(lap, N + 4, 0, stiff[c] > 1e16 ? HD_ERR_NOT_CONVERGED : HD_OK);
        if (z) spec_check_values(z, want, 2 * N, "far apart");
        if (z) spec_check_vectors(lap, z, 2e-10, "far apart");
        if (z) CHECK_MSG(z->proven && z->n_factors <= 50, "%g: proven %d, %d factors", stiff[c], z->proven, (int)z->n_factors);
        hd_spectrum_free(z);
        hd_laplacian_free(lap);
    }
    free(one);
}

/* The spherical harmonics: groups of 2l + 1, near l (l + 1). */
static void spec_sphere(void) {
    shape s = shape_icosphere(4);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_spectrum *z = spec_make(lap, 121, 0, HD_OK);
    int32_t l, m, at = 0;
    for (l = 0; z && l <= 10; l++)
        for (m = 0; m < 2 * l + 1; m++, at++)
            CHECK_MSG(fabs(z->value[at] - l * (l + 1.0)) <= 0.05 * l * (l + 1), "l = %d: %g", l, z->value[at]);
    if (z) CHECK(z->proven && at == 121 && z->next > 11 * 12 * 0.95);
    if (z) spec_check_vectors(lap, z, 2e-10, "sphere");
    hd_spectrum_free(z);
    hd_laplacian_free(lap);
    shape_free(&s);
}

static void spec_below(void) {
    hd_laplacian *lap = spec_lattice(40, 1, 0);
    double *want = spec_lattice_values(40, 1, 0);
    int32_t k, count;
    for (k = 0; k < 40; k++) {
        const double below = k == 39 ? 5 : 0.5 * (want[k] + want[k + 1]);
        hd_spectrum *z = spec_make(lap, 0, below, HD_OK);
        if (z) CHECK_MSG(z->count == k + 1, "%d below %g, found %d", k + 1, below, z->count);
        if (z) spec_check_values(z, want, 40, "below");
        hd_spectrum_free(z);
        count = k % 2 ? k + 7 : k / 2 + 1;       /* whichever ends first */
        z = spec_make(lap, count > 40 ? 40 : count, below, HD_OK);
        if (z) CHECK(z->count == (count < k + 1 ? count : k + 1) && z->proven);
        hd_spectrum_free(z);
    }
    hd_laplacian_free(lap);
    free(want);
}

/* L without constants, with a full B: own matrices. */
static void spec_own(void) {
    shape s = shape_torus(14, 9, 2, 0.7);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM), *own = NULL;
    hd_csr L, B;
    double *value = DENSE_NEW(double, lap->L.nnz), *want;
    dense_pair p;
    hd_spectrum *z;
    int64_t q;
    for (q = 0; q < lap->L.nnz; q++) value[q] = lap->L.val[q] + 0.3 * lap->B[q];
    L = lap->L;
    L.val = value;
    B = lap->L;
    B.val = lap->B;
    CHECK(hd_laplacian_matrices(&own, &L, &B, 0, NULL, NULL) == HD_OK);
    p = spec_dense(own, &want);
    z = spec_make(own, 60, 0, HD_OK);
    if (z) spec_check_values(z, want, own->n_active, "own");
    if (z) spec_check_vectors(own, z, 2e-10, "own");
    if (z) CHECK(z->n_constant == 0 && fabs(z->value[0] - 0.3) < 1e-12);
    hd_spectrum_free(z);
    for (q = 0; q < L.nnz; q++) value[q] = lap->L.val[q] - 0.3 * lap->B[q];
    hd_laplacian_free(own);
    own = NULL;
    if (hd_laplacian_matrices(&own, &L, &B, 0, NULL, NULL) == HD_OK) CHECK(spec_make(own, 5, 0, HD_ERR_NOT_POSITIVE) == NULL);
    hd_laplacian_free(own);
    hd_laplacian_free(lap);
    dense_pair_free(&p);
    free(want);
    free(value);
    shape_free(&s);
}

/* Weights over 15 decades: rounding is above the small eigenvalues, and the status says so. */
static void spec_rounding(void) {
    int32_t a[400], b[400], i;
    double w[400];
    hd_laplacian *lap;
    hd_spectrum *z;
    for (i = 0; i < 400; i++) {
        a[i] = i;
        b[i] = (i + 1) % 400;
        w[i] = i % 2 ? 1e15 : 1;
    }
    lap = bnd_graph(400, 400, a, b, w, NULL, 1);
    z = spec_make(lap, 6, 0, HD_WARN_ACCURACY);
    if (z) CHECK((!z->proven || z->n_poor > 0) && z->largest_residual > 0.1);
    for (i = 0; z && i < 6; i++) CHECK(z->residual[i] >= 0);
    hd_spectrum_free(z);
    hd_laplacian_free(lap);
}

/* Shifts next to an eigenvalue: no residual stays above the tolerance. One of these shifts left 1.2e-10 where steps of inverse
   iteration enlarged rounding in the direction of that eigenvalue's vector. */
static void spec_next_to_shifts(void) {
    shape s = shape_bumpy(4, 5);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_spectrum *z = spec_make(lap, 300, 0, HD_OK);
    if (z) CHECK_MSG(z->n_poor == 0 && z->proven && z->largest_residual <= 1e-10, "%d poor, %g", z->n_poor, z->largest_residual);
    if (z) spec_check_vectors(lap, z, 1e-10, "next to shifts");
    hd_spectrum_free(z);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* Memory follows the vertices and the pairs: 8.6, 10.9, 19.3 and 30.7 MB while a part of it did not. */
static void spec_memory(void) {
    static const int32_t level[4] = {2, 3, 4, 4}, count[4] = {10, 20, 20, 200};
    static const double most[4] = {1.1e6, 3.4e6, 11.5e6, 24.5e6};
    int32_t k;
    for (k = 0; k < 4; k++) {
        shape s = shape_icosphere(level[k]);
        hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
        hd_spectrum_opts o;
        hd_spectrum *z = NULL;
        hd_context ctx;
        memset(&ctx, 0, sizeof ctx);
        memset(&o, 0, sizeof o);
        ctx.n_threads = 1;
        o.context = &ctx;
        o.count = count[k];
        CHECK(hd_spectrum_create(&z, lap, &o, NULL) == HD_OK);
        hd_spectrum_free(z);
        CHECK_MSG(ctx.bytes_in_use == 0 && (double)ctx.bytes_peak <= most[k], "%d pairs of %d: %g bytes", count[k], s.n, (double)ctx.bytes_peak);
        hd_laplacian_free(lap);
        shape_free(&s);
    }
}

/* f(lambda) of the exact pair at two rows: sum over pairs, of B x where mass is 1. */
static double spec_exact(const dense_pair *p, const double *B, int power, double t, int32_t i, int32_t j, int mass_i, int mass_j) {
    const int32_t n = p->n;
    double sum = 0;
    int32_t k;
    for (k = 0; k < n; k++) {
        const double *x = p->x + (size_t)k * (size_t)n, l = p->lambda[k];
        const double f = power == 0 ? exp(-t * l) : l == 0 ? 0 : power == 1 ? 1 / l : 1 / (l * l);
        const double xi = mass_i ? dense_dot(B + (size_t)i * (size_t)n, x, n) : x[i], xj = mass_j ? dense_dot(B + (size_t)j * (size_t)n, x, n) : x[j];
        sum += f * xi * xj;
    }
    return sum;
}

/* Within the bound everywhere; and at times that suit the pairs the bound says something. */
static void spec_check_bound(double got, double bound, double want, double size, int good, const char *what, double t) {
    CHECK_MSG(fabs(got - want) <= bound + 1e-13 * size, "%s, t = %g: %.12g for %.12g, bound %g", what, t, got, want, bound);
    if (good) CHECK_MSG(bound <= 1e-3 * size, "%s, t = %g: bound %g of %g", what, t, bound, size);
}

static void spec_kernels(void) {
    static const hd_laplacian_kind kinds[2] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT};
    static const double times[5] = {0, 0.02, 0.2, 1, 10};
    static const hd_distance_kind distances[4] = {HD_DISTANCE_CLASSICAL, HD_DISTANCE_WEIGHTED, HD_DISTANCE_COMMUTE, HD_DISTANCE_BIHARMONIC};
    shape s = shape_torus(16, 9, 1.5, 0.6);
    const int32_t source = 31, n = s.n;
    double *U = DENSE_NEW(double, 5 * n), *bound = DENSE_NEW(double, 5 * n);
    int32_t kind, k, q, v;
    for (kind = 0; kind < 2; kind++) {
        hd_laplacian *lap = test_laplacian(&s, kinds[kind]);
        hd_spectrum *z = spec_make(lap, 60, 0, HD_OK);
        double *sorted;
        dense_pair p = spec_dense(lap, &sorted);
        for (k = 0; z && k < 2; k++) {
            const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
            CHECK(hd_spectrum_columns(z, kernel, 5, times, 1, &source, U, bound, 0, NULL) == HD_OK);
            for (q = 0; q < 5; q++)
                for (v = 0; v < n; v++) {
                    const double size = spec_exact(&p, p.B, 0, times[q], source, source, 0, !k);
                    spec_check_bound(U[q * n + v], bound[q * n + v], spec_exact(&p, p.B, 0, times[q], v, source, 0, !k), size, times[q] > 0.5, "column", times[q]);
                }
            CHECK(hd_spectrum_diagonal(z, kernel, 5, times, U, bound, 0, NULL) == HD_OK);
            for (q = 0; q < 5; q++)
                for (v = 0; v < n; v++) {
                    const double want = spec_exact(&p, p.B, 0, times[q], v, v, 0, !k);
                    spec_check_bound(U[q * n + v], bound[q * n + v], want, want, times[q] > 0.5, "diagonal", times[q]);
                }
        }
        for (k = 0; z && k < 4; k++) {
            const int power = k < 2 ? 0 : k - 1, mass = k == 1, n_times = k < 2 ? 5 : 1;
            CHECK(hd_spectrum_distance(z, distances[k], n_times, times, 1, &source, U, bound, 0, NULL) == HD_OK);
            for (q = 0; q < n_times; q++)
                for (v = 0; v < n; v++) {
                    const double t = 2 * times[q], a = spec_exact(&p, p.B, power, t, v, v, mass, mass), c = spec_exact(&p, p.B, power, t, source, source, mass, mass);
                    const double d2 = a + c - 2 * spec_exact(&p, p.B, power, t, v, source, mass, mass);
                    const double lost = sqrt(1e-15 * (a + c));    /* of the reference, by cancellation */
                    CHECK_MSG(fabs(U[q * n + v] - sqrt(fmax(0, d2))) <= bound[q * n + v] + lost, "distance %d, t = %g: %g for %g, bound %g", k, times[q], U[q * n + v],
                              sqrt(fmax(0, d2)), bound[q * n + v]);
                    if (k < 2 && times[q] == 1 && v != source) CHECK(bound[q * n + v] < 0.05 * U[q * n + v]);
                }
        }
        hd_spectrum_free(z);
        dense_pair_free(&p);
        free(sorted);
        hd_laplacian_free(lap);
    }
    free(U);
    free(bound);
    shape_free(&s);
}

/* Against the plan, with a vertex in no face and two components. */
static void spec_against_heat(void) {
    static const hd_distance_kind distances[4] = {HD_DISTANCE_CLASSICAL, HD_DISTANCE_WEIGHTED, HD_DISTANCE_COMMUTE, HD_DISTANCE_BIHARMONIC};
    shape one = shape_icosphere(3), two = shape_torus(20, 12, 2, 0.8), s;
    const double apart[3] = {9, 0, 0}, t = 0.3;
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_spectrum *z;
    double *xyz, *u, *w, *b;
    int32_t k, v, n, sources[2];
    s = shape_disjoint(&one, &two, apart);
    n = s.n + 1;
    xyz = DENSE_NEW(double, 3 * n);
    u = DENSE_NEW(double, 2 * n);
    w = DENSE_NEW(double, 2 * n);
    b = DENSE_NEW(double, 2 * n);
    memcpy(xyz, s.xyz, 3 * (size_t)s.n * sizeof *xyz);
    sources[0] = 5;
    sources[1] = s.n;
    CHECK(hd_laplacian_triangles(&lap, xyz, n, s.tri, s.n_tri, NULL, NULL) == HD_OK && hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    z = spec_make(lap, 250, 0, HD_OK);
    for (k = 0; z && k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(hd_heat_columns(heat, kernel, 1, &t, 2, sources, u, 0, NULL, NULL) >= 0 && hd_spectrum_columns(z, kernel, 1, &t, 2, sources, w, b, 0, NULL) == HD_OK);
        CHECK_MSG(dense_max_diff(u, w, 2 * n) <= 1e-6 * dense_max_abs(u, n), "columns off by %g", dense_max_diff(u, w, 2 * n));
        CHECK(w[n + s.n] == (k ? 0 : 1));
        CHECK(hd_heat_diagonal(heat, kernel, 1, &t, u, 0, NULL, NULL) >= 0 && hd_spectrum_diagonal(z, kernel, 1, &t, w, b, 0, NULL) == HD_OK);
        CHECK_MSG(dense_max_diff(u, w, n) <= 1e-6 * dense_max_abs(u, n), "diagonal off by %g", dense_max_diff(u, w, n));
    }
    for (k = 0; z && k < 4; k++) {
        CHECK(hd_heat_distance(heat, distances[k], k < 2, &t, 1, sources, u, 0, NULL, NULL) >= 0 &&
              hd_spectrum_distance(z, distances[k], k < 2, &t, 1, sources, w, b, 0, NULL) == HD_OK);
        for (v = 0; v < n; v++) {
            if (u[v] == HUGE_VAL || w[v] == HUGE_VAL) CHECK_MSG(u[v] == w[v], "distance %d at %d: %g and %g", k, v, u[v], w[v]);
            else CHECK_MSG(fabs(u[v] - w[v]) <= b[v] + 1e-5 * fabs(u[v]), "distance %d at %d: %g and %g, bound %g", k, v, u[v], w[v], b[v]);
        }
    }
    hd_spectrum_free(z);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&one);
    shape_free(&two);
    shape_free(&s);
    free(xyz);
    free(u);
    free(w);
    free(b);
}

static void spec_threads(void) {
    shape s = shape_icosphere(4);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_spectrum *z[3] = {NULL, NULL, NULL};
    hd_context ctx[3];
    int32_t k;
    for (k = 0; k < 3; k++) {
        hd_spectrum_opts o;
        memset(ctx + k, 0, sizeof *ctx);
        memset(&o, 0, sizeof o);
        ctx[k].n_threads = k + 1;
        o.count = 70;
        o.context = ctx + k;
        CHECK(hd_spectrum_create(z + k, lap, &o, NULL) == HD_OK);
        CHECK(z[k] && memcmp(z[k]->value, z[0]->value, 70 * sizeof(double)) == 0 && z[k]->n_solves == z[0]->n_solves &&
              memcmp(z[k]->vector, z[0]->vector, 70 * (size_t)s.n * sizeof(double)) == 0);
    }
    for (k = 0; k < 3; k++) {
        hd_spectrum_free(z[k]);
        CHECK(ctx[k].bytes_in_use == 0);
    }
    hd_laplacian_free(lap);
    shape_free(&s);
}

static hd_status spec_robust(hd_context *ctx, int variant) {
    hd_laplacian *lap;
    hd_spectrum_opts o;
    hd_spectrum *z = NULL;
    hd_error e;
    double u[21];
    const double t = 0.5;
    const int32_t source = 3;
    hd_status st = rob_laplacian_of(ctx, variant ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, &lap);
    if (st < 0) return st;
    memset(&o, 0, sizeof o);
    o.count = 5;
    st = hd_spectrum_create(&z, lap, &o, &e);
    CHECK(e.status == (st < 0 ? st : HD_OK) && (st < 0) == !z);
    if (st >= 0) st = hd_spectrum_columns(z, HD_KERNEL_OPERATOR, 1, &t, 1, &source, u, NULL, 0, &e);
    hd_spectrum_free(z);
    hd_laplacian_free(lap);
    return st;
}

static void spec_errors(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    static const rob_job jobs[2] = {{"spectrum fem", spec_robust, 0}, {"spectrum voronoi", spec_robust, 1}};
    hd_spectrum_opts o;
    hd_spectrum *z = NULL;
    hd_error e;
    double u[42], t = 1;
    int32_t k, bad = 42;
    for (k = 0; k < 8; k++) {
        memset(&o, 0, sizeof o);
        o.count = k == 0 ? -1 : k == 1 ? 0 : k == 2 ? s.n + 1 : 5;
        o.below = k == 3 ? -1 : k == 4 ? (double)NAN : 0;
        o.tol = k == 5 ? 2 : 0;
        o.ordering = k == 6 ? HD_ORDERING_OWN : HD_ORDERING_AUTO;
        o.end_zero = k == 7;
        CHECK_MSG(hd_spectrum_create(&z, lap, &o, &e) == HD_ERR_ARGUMENT && !z && e.text[0], "case %d", k);
    }
    CHECK(hd_spectrum_create(&z, lap, NULL, &e) == HD_ERR_ARGUMENT && hd_spectrum_create(NULL, lap, &o, &e) == HD_ERR_ARGUMENT);
    hd_spectrum_free(NULL);
    z = spec_make(lap, 5, 0, HD_OK);
    CHECK(hd_spectrum_columns(z, HD_KERNEL_OPERATOR, 1, &t, 1, &bad, u, NULL, 0, &e) == HD_ERR_INDEX && e.vertex == 42 && e.column == 0);
    CHECK(hd_spectrum_columns(z, HD_KERNEL_OPERATOR, 0, &t, 1, &bad, u, NULL, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_spectrum_columns(z, (hd_kernel)7, 1, &t, 0, &bad, u, NULL, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_spectrum_diagonal(z, HD_KERNEL_OPERATOR, 1, &t, u, NULL, 7, &e) == HD_ERR_ARGUMENT);
    bad = 0;
    t = -1;
    CHECK(hd_spectrum_distance(z, HD_DISTANCE_CLASSICAL, 1, &t, 1, &bad, u, NULL, 0, &e) == HD_ERR_ARGUMENT && e.value == -1);
    CHECK(hd_spectrum_distance(z, (hd_distance_kind)9, 1, &t, 1, &bad, u, NULL, 0, &e) == HD_ERR_ARGUMENT);
    hd_spectrum_free(z);
    hd_laplacian_free(lap);
    shape_free(&s);
    for (k = 0; k < 2; k++) {
        rob_fail_each_allocation(jobs + k);
        rob_byte_limits(jobs + k);
        rob_stop_each_progress(jobs + k, HD_PROGRESS_CANCEL, HD_ERR_CANCELLED);
    }
}

/* A run looks for all that are asked for while these are few: one from below, and a factor that counts. */
static void spec_one_run(void) {
    shape s = shape_bumpy(3, 5);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_spectrum *z = NULL;
    hd_spectrum_opts o;
    memset(&o, 0, sizeof o);
    o.count = 20;
    CHECK(hd_spectrum_create(&z, lap, &o, NULL) == HD_OK && z->proven && z->count >= 20);
    CHECK_MSG(z->n_runs == 1 && z->n_factors == 2, "%d runs, %d factors", (int)z->n_runs, (int)z->n_factors);
    hd_spectrum_free(z);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* B in other units: distances from the pairs and their bounds change by powers of two only. */
static void spec_units(void) {
    static const int units[] = {0, -940, -600, 400, 600, 940};
    double want[4][12], bound[4][12], b[12];
    int32_t q, i, a;
    for (q = 0; q < 6; q++) {
        const int k = units[q];
        const int32_t source = 2;
        const double t = ldexp(3, k);
        hd_csr L = test_path_csr(12, 0), B;
        hd_laplacian *lap = NULL;
        hd_spectrum *s = NULL;
        hd_spectrum_opts o;
        for (i = 0; i < 12; i++) b[i] = ldexp(1 + i % 3, k);
        B = test_diagonal_csr(12, b);
        memset(&o, 0, sizeof o);
        o.count = 5;
        CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK && hd_spectrum_create(&s, lap, &o, NULL) == HD_OK);
        for (a = HD_DISTANCE_CLASSICAL; a <= HD_DISTANCE_BIHARMONIC; a++) {
            const int power = a == HD_DISTANCE_CLASSICAL ? k / 2 : a == HD_DISTANCE_COMMUTE ? 0 : -k / 2;
            double d[12], off[12];
            CHECK(hd_spectrum_distance(s, (hd_distance_kind)a, a < HD_DISTANCE_COMMUTE, &t, 1, &source, d, off, 0, NULL) == HD_OK);
            for (i = 0; i < 12; i++) {
                d[i] = ldexp(d[i], power);
                off[i] = ldexp(off[i], power);
                if (q == 0) want[a][i] = d[i];
                if (q == 0) bound[a][i] = off[i];
                CHECK_MSG(fabs(d[i] - want[a][i]) <= 1e-12 * want[a][i] && fabs(off[i] - bound[a][i]) <= 1e-9 * bound[a][i],
                          "unit 2^%d, kind %d: %g +- %g, want %g +- %g", k, (int)a, d[i], off[i], want[a][i], bound[a][i]);
            }
        }
        hd_spectrum_free(s);
        hd_laplacian_free(lap);
        hd_csr_free(&L, NULL);
        hd_csr_free(&B, NULL);
    }
}

static void test_spectrum(void) {
    spec_one_run();
    spec_against_dense();
    spec_closed_forms();
    spec_copies();
    spec_far_apart();
    spec_sphere();
    spec_below();
    spec_own();
    spec_rounding();
    spec_next_to_shifts();
    spec_memory();
    spec_kernels();
    spec_against_heat();
    spec_threads();
    spec_errors();
    spec_units();
}

#endif
