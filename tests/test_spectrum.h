/* test_spectrum.h - eigenpairs against dense eigensolutions and closed forms, proofs of completeness, truncated kernels */

#ifndef TEST_SPECTRUM_H
#define TEST_SPECTRUM_H

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
    double *y = KIT_NEW(double, lap->n), *b = KIT_NEW(double, lap->n), worst = 0, orth = 0, off = 0;
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
    CHECK_MSG(worst < tol && off < 0.1 * tol && orth < 1e-12, "%s: residual %g, told off by %g, orthogonal to %g", what, worst, off,
              orth);
}

static void spec_free(void *p) { hd_spectrum_free((hd_spectrum *)p); }

/* Freed with the rest. */
static hd_spectrum *spec_of(const hd_laplacian *lap, int32_t count, double below) {
    hd_spectrum *s = spec_make(lap, count, below, HD_OK);
    if (!s) truth_stop("no spectrum");
    return (hd_spectrum *)kit_keep(s, spec_free);
}

/* Pairs against the sorted eigenvalues [n]. */
static void spec_check(const hd_laplacian *lap, const hd_spectrum *s, const double *want, double tol, const char *what) {
    const int32_t n = lap->n_active;
    double off = 0;
    int32_t i;
    for (i = 0; i < s->count; i++) off = fmax(off, fabs(s->value[i] - want[i]));
    CHECK_MSG(off <= 1e-11 * want[n - 1] && s->proven, "%s, %d pairs: off by %g of %g, proven %d", what, s->count, off, want[n - 1],
              s->proven);
    if (s->count < n) CHECK_MSG(s->next <= want[s->count] * (1 + 1e-11) &&
                                s->next >= want[s->count > 0 ? s->count - 1 : 0] * (1 - 1e-8) - 1e-9 * want[n - 1],
                                "%s, %d pairs: the next is %g, bound %g", what, s->count, want[s->count], s->next);
    else CHECK(s->next == HUGE_VAL);
    spec_check_vectors(lap, s, tol, what);
}

/* The sorted eigenvalues of a pair, dense. */
static double *spec_dense(const hd_laplacian *lap) {
    dense_pair p;
    double *sorted = KIT_NEW(double, lap->n_active);
    CHECK(dense_pair_solve(&p, test_dense(&lap->L, NULL), test_dense_mass(lap), lap->n_active));
    memcpy(sorted, p.lambda, (size_t)lap->n_active * sizeof *sorted);
    qsort(sorted, (size_t)lap->n_active, sizeof *sorted, spec_compare);
    dense_pair_free(&p);
    return sorted;
}

static void spec_against_dense(void) {
    static const double apart[3] = {9, 0, 0};
    const shape *s[4];
    int32_t k, q, c;
    s[0] = kit_shape("ico/2");
    s[1] = kit_shape("torus/13/9");
    s[2] = kit_shape("flat/10/9/0.3");
    s[3] = kit_own(shape_disjoint(s[1], s[1], apart));
    for (k = 0; k < 4; k++)
        for (q = 0; q < 3; q++) {
            const hd_laplacian *lap = kit_triangles(s[k], op_kinds[q]);
            const int32_t n = lap->n_active, counts[6] = {1, 2, 10, n / 2, n - 1, n};
            const double *want = spec_dense(lap);
            char what[60];
            snprintf(what, sizeof what, "shape %d, kind %d", k, q);
            for (c = 0; c < 6; c++) {
                const hd_spectrum *z = spec_of(lap, counts[c], 0);
                CHECK(z->count == counts[c] && z->n == lap->n && z->n_constant == (counts[c] > 1 && k == 3 ? 2 : 1));
                spec_check(lap, z, want, 2e-10, what);
            }
        }
}

/* The eigenvalues of a torus of nx x ny nodes; of a path or cycle with ny = 1. */
static double *spec_lattice_values(int32_t nx, int32_t ny, int closed) {
    double *v = KIT_NEW(double, nx * ny);
    int32_t i, j;
    for (i = 0; i < nx; i++)
        for (j = 0; j < ny; j++) {
            const double x = sin(heat_pi * i / (closed ? nx : 2 * nx)), y = sin(heat_pi * j / ny);
            v[i * ny + j] = 4 * x * x + (ny > 1 ? 4 * y * y : 0);
        }
    qsort(v, (size_t)(nx * ny), sizeof *v, spec_compare);
    return v;
}

static void spec_closed_forms(void) {
    static const int32_t nx[5] = {40, 24, 32, 900, 901}, ny[5] = {30, 24, 32, 1, 1}, count[5] = {120, 200, 90, 100, 80};
    int32_t k;
    for (k = 0; k < 5; k++) {
        const hd_laplacian *lap = kit_lattice(nx[k], ny[k], k != 3, 1, 1);
        char what[60];
        snprintf(what, sizeof what, "%d x %d", nx[k], ny[k]);
        /* a path of 900 has eigenvalues of 1e-5, where rounding of L x is 1e-15 */
        spec_check(lap, spec_of(lap, count[k], 0), spec_lattice_values(nx[k], ny[k], k != 3), nx[k] < 900 ? 2e-10 : 1e-9, what);
    }
}

enum { SPEC_RING = 12 };

/* Rings that do not touch, the last one so stiff, and their sorted eigenvalues. */
static hd_laplacian *spec_rings(int32_t rings, double stiff, double *want) {
    const int32_t n = rings * SPEC_RING;
    int32_t *a = KIT_NEW(int32_t, n), *b = KIT_NEW(int32_t, n), i;
    double *w = KIT_NEW(double, n), *one = spec_lattice_values(SPEC_RING, 1, 1);
    for (i = 0; i < n; i++) {
        a[i] = i;
        b[i] = i / SPEC_RING * SPEC_RING + (i + 1) % SPEC_RING;
        w[i] = i < n - SPEC_RING ? 1 : stiff;
        want[i] = w[i] * one[i % SPEC_RING];
    }
    qsort(want, (size_t)n, sizeof *want, spec_compare);
    return kit_graph(n, n, a, b, w, NULL);
}

/* Every eigenvalue as often as there are rings, more often than a block has vectors, and pairs of them on top. */
static void spec_copies(void) {
    enum { RINGS = 21, N = RINGS * SPEC_RING };
    static const int32_t counts[4] = {5, RINGS, 100, N};
    double want[N];
    const hd_laplacian *lap = spec_rings(RINGS, 1, want);
    int32_t c;
    for (c = 0; c < 4; c++) spec_check(lap, spec_of(lap, counts[c], 0), want, 2e-10, "copies");
}

/* Shifts have far to go from the last value of one ring to the first of a stiffer one; beyond the digits there is an error. */
static void spec_far_apart(void) {
    static const double stiff[4] = {1e3, 1e11, 1e60, 1e95};
    double want[2 * SPEC_RING];
    int32_t c;
    for (c = 0; c < 4; c++) {
        const hd_laplacian *lap = spec_rings(2, stiff[c], want);
        hd_spectrum *z;
        if (c > 1) CHECK(spec_make(lap, SPEC_RING + 4, 0, HD_ERR_NOT_CONVERGED) == NULL);
        if (c > 1) continue;
        z = spec_of(lap, SPEC_RING + 4, 0);
        spec_check(lap, z, want, 2e-10, "far apart");
        CHECK_MSG(z->n_factors <= 50, "%g: %d factors", stiff[c], (int)z->n_factors);
    }
}

/* The spherical harmonics: groups of 2l + 1, near l (l + 1). */
static void spec_sphere(void) {
    const hd_laplacian *lap = kit_pair("ico/4 fem");
    const hd_spectrum *z = spec_of(lap, 121, 0);
    int32_t l, m, at = 0;
    for (l = 0; l <= 10; l++)
        for (m = 0; m < 2 * l + 1; m++, at++) CHECK_MSG(fabs(z->value[at] - l * (l + 1.0)) <= 0.05 * l * (l + 1), "l = %d: %g", l,
                                                        z->value[at]);
    CHECK(z->proven && at == 121 && z->next > 11 * 12 * 0.95);
    spec_check_vectors(lap, z, 2e-10, "sphere");
}

static void spec_below(void) {
    const hd_laplacian *lap = kit_lattice(40, 1, 0, 1, 1);
    const double *want = spec_lattice_values(40, 1, 0);
    int32_t k;
    for (k = 0; k < 40; k++) {
        const double below = k == 39 ? 5 : 0.5 * (want[k] + want[k + 1]);
        const int32_t most = k % 2 ? k + 7 : k / 2 + 1, count = most > 40 ? 40 : most;
        const hd_spectrum *z = spec_of(lap, 0, below);
        CHECK_MSG(z->count == k + 1, "%d below %g, found %d", k + 1, below, z->count);
        spec_check(lap, z, want, 2e-10, "below");
        z = spec_of(lap, count, below);          /* whichever ends first */
        CHECK(z->count == (count < k + 1 ? count : k + 1) && z->proven);
    }
}

/* L without constants, with a full B: own matrices, L plus or minus 0.3 B. */
static void spec_own(void) {
    const hd_laplacian *lap = kit_pair("torus/14/9 fem");
    double *value = KIT_NEW(double, lap->L.nnz);
    hd_csr L = lap->L, B = lap->L;
    int64_t q;
    int k;
    L.val = value;
    B.val = lap->B;
    for (k = 1; k >= -1; k -= 2) {
        hd_laplacian *own = NULL;
        const hd_spectrum *z;
        for (q = 0; q < L.nnz; q++) value[q] = lap->L.val[q] + 0.3 * k * lap->B[q];
        CHECK(hd_laplacian_matrices(&own, &L, &B, 0, NULL, NULL) == HD_OK || k < 0);
        if (!own) continue;
        kit_keep(own, kit_free_laplacian);
        if (k < 0) {
            CHECK(spec_make(own, 5, 0, HD_ERR_NOT_POSITIVE) == NULL);
            continue;
        }
        z = spec_of(own, 60, 0);
        spec_check(own, z, spec_dense(own), 2e-10, "own");
        CHECK(z->n_constant == 0 && fabs(z->value[0] - 0.3) < 1e-12);
    }
}

/* Weights over 15 decades: rounding is above the small eigenvalues, and the status says so. */
static void spec_rounding(void) {
    enum { N = 400 };
    int32_t a[N], b[N], i;
    double w[N];
    hd_spectrum *z;
    for (i = 0; i < N; i++) {
        a[i] = i;
        b[i] = (i + 1) % N;
        w[i] = i % 2 ? 1e15 : 1;
    }
    z = spec_make(kit_graph(N, N, a, b, w, NULL), 6, 0, HD_WARN_ACCURACY);
    if (z) CHECK((!z->proven || z->n_poor > 0) && z->largest_residual > 0.1);
    for (i = 0; z && i < 6; i++) CHECK(z->residual[i] >= 0);
    hd_spectrum_free(z);
}

/* Shifts next to an eigenvalue: no residual stays above the tolerance. One of these shifts left 1.2e-10 where steps of inverse
   iteration enlarged rounding in the direction of that eigenvalue's vector. */
static void spec_next_to_shifts(void) {
    const hd_laplacian *lap = kit_pair("bumpy/4/5 fem");
    const hd_spectrum *z = spec_of(lap, 300, 0);
    CHECK_MSG(z->n_poor == 0 && z->proven && z->largest_residual <= 1e-10, "%d poor, %g", z->n_poor, z->largest_residual);
    spec_check_vectors(lap, z, 1e-10, "next to shifts");
}

/* Memory follows the vertices and the pairs: 8.6, 10.9, 19.3 and 30.7 MB while a part of it did not. */
static void spec_memory(void) {
    static const int32_t level[4] = {2, 3, 4, 4}, count[4] = {10, 20, 20, 200};
    static const double most[4] = {1.1e6, 3.4e6, 11.5e6, 24.5e6};
    int32_t k;
    for (k = 0; k < 4; k++) {
        shape s = kit_own_shape(shape_icosphere(level[k]));
        hd_laplacian *lap = kit_triangles(&s, HD_LAPLACIAN_FEM);
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
    }
}

/* What is told of n numbers is within its bounds of what w wants; at times that suit the pairs the bounds say something. */
static void spec_within(const trial_work *w, const double *got, const double *bound, int32_t n, int good, const char *what, double t) {
    double most = 0, said = 0;
    int32_t v;
    for (v = 0; v < n; v++) {
        const double want = (double)w->want[v];
        most = fmax(most, fabs(want));
        said = fmax(said, bound[v]);
        CHECK_MSG(fabs(got[v] - want) <= bound[v] + w->off[v] + 1e-15 * fabs(want), "%s, t = %g: %.12g for %.12g, bound %g", what, t,
                  got[v], want, bound[v]);
    }
    if (good) CHECK_MSG(said <= 1e-3 * most, "%s, t = %g: bounds up to %g of %g", what, t, said, most);
}

static void spec_kernels_of(const char *text, int good) {
    const int32_t source = 31;
    trial_work *w = case_truth_of(text);
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n;
    const double times[5] = {0, 5e-4 * lap->area, 5e-3 * lap->area, 0.03 * lap->area, 0.3 * lap->area};
    const hd_spectrum *z = spec_of(lap, n / 2, 0);
    double *U = KIT_NEW(double, 5 * n), *bound = KIT_NEW(double, 5 * n);
    int32_t k, q, v;
    for (k = 0; k < 4; k++) {                    /* columns and diagonals of both kernels */
        const int operator_ = k % 2 == 0;
        const hd_kernel kernel = operator_ ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
        if (k < 2) CHECK(hd_spectrum_columns(z, kernel, 5, times, VERTICES(1, &source), U, bound, 0, NULL) == HD_OK);
        else CHECK(hd_spectrum_diagonal(z, kernel, 5, times, U, bound, 0, NULL) == HD_OK);
        for (q = 0; q < 5; q++) {
            trial_filter_for(w, times[q], 0);
            for (v = 0; v < n; v++) w->want[v] = trial_want_entry(w, v, k < 2 ? source : v, 0, operator_, operator_, w->off + v);
            spec_within(w, U + q * n, bound + q * n, n, q >= good, k < 2 ? "column" : "diagonal", times[q]);
        }
    }
    for (k = HD_DISTANCE_CLASSICAL; k <= HD_DISTANCE_BIHARMONIC; k++) {
        const int timed = !trial_timeless(k);
        CHECK(hd_spectrum_distance(z, (hd_distance_kind)k, timed ? 5 : 1, times, VERTICES(1, &source), U, bound, 0, NULL) == HD_OK);
        for (q = 0; q < (timed ? 5 : 1); q++) {
            trial_distance_for(w, k, 2 * times[q], 0);
            for (v = 0; v < n; v++) w->want[v] = trial_want_distance(w, source, v, k == HD_DISTANCE_WEIGHTED, w->off + v);
            spec_within(w, U + q * n, bound + q * n, n, 0, "distance", times[q]);
            for (v = 0; v < n && timed && q == 3; v++) CHECK(v == source || bound[q * n + v] < 0.05 * U[q * n + v]);
        }
    }
}

static void spec_kernels(void) {
    spec_kernels_of("shape=torus/9/8 op=fem", 3);
    spec_kernels_of("shape=torus/9/8 op=vor", 3);
    spec_kernels_of("shape=bumpy/1/3 op=vor", 4);
}

/* Against the plan, with vertices in no face and two components. */
static void spec_against_heat(void) {
    static const double apart[3] = {9, 0, 0}, t = 0.3;
    const shape *s = kit_own(shape_disjoint(kit_shape("torus/20/12"), kit_shape("spare/9/1"), apart));
    const hd_laplacian *lap = kit_triangles(s, HD_LAPLACIAN_DEFAULT);
    hd_heat *heat = kit_heat(lap, "");
    const hd_spectrum *z = spec_of(lap, 250, 0);
    const int32_t n = lap->n, sources[2] = {5, 240};
    double *u = KIT_NEW(double, 2 * n), *w = KIT_NEW(double, 2 * n), *b = KIT_NEW(double, 2 * n);
    int32_t k, v;
    CHECK(lap->row[5] >= 0 && lap->row[240] == HD_ROW_INERT && lap->n_components == 2);
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(hd_heat_columns(heat, kernel, 1, &t, VERTICES(2, sources), u, 0, NULL, NULL) >= 0 &&
              hd_spectrum_columns(z, kernel, 1, &t, VERTICES(2, sources), w, b, 0, NULL) == HD_OK);
        CHECK_MSG(dense_max_diff(u, w, 2 * n) <= 1e-6 * dense_max_abs(u, n), "columns off by %g", dense_max_diff(u, w, 2 * n));
        CHECK(w[n + 240] == (k ? 0 : 1));
        CHECK(hd_heat_diagonal(heat, kernel, 1, &t, u, 0, NULL, NULL, NULL, NULL) >= 0 && hd_spectrum_diagonal(z, kernel, 1, &t, w, b, 0,
            NULL) == HD_OK);
        CHECK_MSG(dense_max_diff(u, w, n) <= 1e-6 * dense_max_abs(u, n), "diagonal off by %g", dense_max_diff(u, w, n));
    }
    for (k = HD_DISTANCE_CLASSICAL; k <= HD_DISTANCE_BIHARMONIC; k++) {
        CHECK(hd_heat_distance(heat, (hd_distance_kind)k, k < 2, &t, VERTICES(1, sources), u, 0, NULL, NULL) >= 0);
        CHECK(hd_spectrum_distance(z, (hd_distance_kind)k, k < 2, &t, VERTICES(1, sources), w, b, 0, NULL) == HD_OK);
        for (v = 0; v < n; v++)
            CHECK_MSG(u[v] == HUGE_VAL || w[v] == HUGE_VAL ? u[v] == w[v] : fabs(u[v] - w[v]) <= b[v] + 1e-5 * fabs(u[v]),
                      "distance %d at %d: %g and %g, bound %g", k, v, u[v], w[v], b[v]);
    }
}

/* The same bits with any number of threads. */
static void spec_threads(void) {
    const hd_laplacian *lap = kit_triangles(kit_shape("ico/4"), HD_LAPLACIAN_FEM);
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
              memcmp(z[k]->vector, z[0]->vector, 70 * (size_t)lap->n * sizeof(double)) == 0);
    }
    for (k = 0; k < 3; k++) {
        hd_spectrum_free(z[k]);
        CHECK(ctx[k].bytes_in_use == 0);
    }
}

/* A run looks for all that are asked for while these are few: one from below, and a factor that counts. */
static void spec_one_run(void) {
    const hd_spectrum *z = spec_of(kit_pair("bumpy/3/5 fem"), 20, 0);
    CHECK(z->proven && z->count >= 20);
    CHECK_MSG(z->n_runs == 1 && z->n_factors == 2, "%d runs, %d factors", (int)z->n_runs, (int)z->n_factors);
}

/* B in other units: distances from the pairs and their bounds change by powers of two only. */
static void spec_units(void) {
    static const int units[] = {0, -330, -300, 200, 300, 326};
    const int32_t source = 2;
    double want[4][12], bound[4][12];
    int32_t q, i, a;
    for (q = 0; q < 6; q++) {
        const int k = units[q];
        const double t = ldexp(3, k);
        const hd_spectrum *s = spec_of(kit_path(12, 0, k), 5, 0);
        for (a = HD_DISTANCE_CLASSICAL; a <= HD_DISTANCE_BIHARMONIC; a++) {
            const int power = a == HD_DISTANCE_CLASSICAL ? k / 2 : a == HD_DISTANCE_COMMUTE ? 0 : -k / 2;
            double d[12], off[12];
            CHECK(hd_spectrum_distance(s, (hd_distance_kind)a, !trial_timeless(a), &t, VERTICES(1, &source), d, off, 0,
                NULL) == HD_OK);
            for (i = 0; i < 12; i++) {
                d[i] = ldexp(d[i], power);
                off[i] = ldexp(off[i], power);
                if (q == 0) want[a][i] = d[i];
                if (q == 0) bound[a][i] = off[i];
                CHECK_MSG(fabs(d[i] - want[a][i]) <= 1e-12 * want[a][i] && fabs(off[i] - bound[a][i]) <= 1e-9 * bound[a][i],
                          "unit 2^%d, kind %d: %g +- %g, want %g +- %g", k, (int)a, d[i], off[i], want[a][i], bound[a][i]);
            }
        }
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
    spec_units();
}

#endif
