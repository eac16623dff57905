/* One build with some of the switches HEATDIFF_NO_...: what it has gives right numbers, what it lacks answers
   HD_ERR_NOT_BUILT with the name of the switch. tests/switches.sh builds and runs this with each switch and with
   sensible sets of them. The numbers are closed forms: on the octahedron L = w (4 I - A), w = 1/sqrt(3), and A has the
   eigenvalues 4, 0 and -2 with 1, 3 and 2 eigenvectors. */
#include "heatdiff.h"
#include "../tools/mesh_args.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A switch of this build by name, or NULL. What is not defined stands for itself. */
#define TEXT(x) #x
#define SWITCH(name) is_on(#name, TEXT(name))
static const char *is_on(const char *name, const char *value) { return strcmp(name, value) == 0 ? NULL : name; }

/* The switch of a part that is taken away, by this one or by one that implies it; NULL if the part is there. */
static struct {
    const char *direct, *local, *pole_factors, *diagonal, *diffusion, *geodesic, *spectrum, *iterative, *intrinsic, *points, *polygons;
} no;

#define IMPLIED(name, by) ((by) || is_on(#name, TEXT(name)) ? #name : NULL)

static const char *either(const char *first, const char *second) { return first ? first : second; }

static void find_switches(void) {
    no.direct = SWITCH(HEATDIFF_NO_DIRECT);
    no.local = IMPLIED(HEATDIFF_NO_LOCAL, no.direct);
    no.pole_factors = IMPLIED(HEATDIFF_NO_POLE_FACTORS, no.direct);
    no.diagonal = IMPLIED(HEATDIFF_NO_DIAGONAL, no.pole_factors);
    no.diffusion = IMPLIED(HEATDIFF_NO_DIFFUSION, no.diagonal);
    no.geodesic = IMPLIED(HEATDIFF_NO_GEODESIC, no.direct);
    no.spectrum = IMPLIED(HEATDIFF_NO_SPECTRUM, no.direct);
    no.iterative = SWITCH(HEATDIFF_NO_ITERATIVE);
    no.intrinsic = SWITCH(HEATDIFF_NO_INTRINSIC);
    no.points = SWITCH(HEATDIFF_NO_POINTS);
    no.polygons = SWITCH(HEATDIFF_NO_POLYGONS);
}

static int n_checks, n_failed;
static hd_error err;

static void check_at(int line, int good, const char *what) {
    n_checks++;
    if (good) return;
    n_failed++;
    printf("line %d: %s (%s)\n", line, what, err.text);
}
#define CHECK(good) check_at(__LINE__, good, #good)

/* Is the status that of a build without what `lacking` names, or HD_OK? Returns whether results can be looked at. */
static int built_at(int line, hd_status status, const char *lacking, const char *what) {
    if (!lacking) check_at(line, status == HD_OK, what);
    else check_at(line, status == HD_ERR_NOT_BUILT && err.status == status && strstr(err.text, lacking) != NULL, what);
    return status == HD_OK;
}
#define BUILT(call, lacking) built_at(__LINE__, call, lacking, #call)

static int near_to(double x, double y) { return fabs(x - y) <= 2e-7; }

static const double xyz[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
static const int32_t tri[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
static const double T = 0.7;

/* f(L) between two vertices for f with the values at the eigenvalues 0, 4 w and 6 w. */
static double between(int i, int j, double f0, double f4, double f6) {
    if (i == j) return (f0 + 3 * f4 + 2 * f6) / 6;
    return i / 2 == j / 2 ? (f0 - 3 * f4 + 2 * f6) / 6 : (f0 - f6) / 6;
}

static double heat_of(int i, int j, double t) {
    const double w = 1 / sqrt(3.0);
    return between(i, j, 1, exp(-4 * w * t), exp(-6 * w * t));
}

/* The derivative in t. */
static double rate_of(int i, int j, double t) {
    const double w = 1 / sqrt(3.0);
    return between(i, j, 0, -4 * w * exp(-4 * w * t), -6 * w * exp(-6 * w * t));
}

static hd_laplacian *octahedron(hd_laplacian_opts *o) {
    hd_laplacian *lap = NULL;
    o->kind = HD_LAPLACIAN_COT;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 6, tri, 8), o, &err) == HD_OK && lap->n_active == 6);
    return lap;
}

/* The middle of the first face. */
static hd_sources middle(void) {
    hd_sources s = hd_vertices(1, tri);
    s.corners = 3;
    return s;
}

/* Columns and fields of a plan are right, at one time, at several, and at t = 0. */
static void check_columns(hd_heat *heat) {
    const double t[3] = {T, 0.2 * T, 3 * T}, zero = 0, f[6] = {1, 2, 3, 4, 5, 6};
    const hd_sources source = middle();
    double u[18];
    int q, i, j;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, t, &source, u, 0, NULL, &err) == HD_OK);
    for (i = 0; i < 6; i++) CHECK(near_to(u[i], (heat_of(i, tri[0], T) + heat_of(i, tri[1], T) + heat_of(i, tri[2], T)) / 3));
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 3, t, VERTICES(1, tri), u, 0, NULL, &err) == HD_OK);
    for (q = 0; q < 3; q++)
        for (i = 0; i < 6; i++) CHECK(near_to(u[6 * q + i], heat_of(i, 0, t[q])));
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, T, 1, u, NULL, &err) == HD_OK);
    for (i = 0; i < 6; i++) CHECK(near_to(u[i], heat_of(i, 1, T)));
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, 1e15, 1, u, NULL, &err) == HD_OK);       /* the means are left */
    for (i = 0; i < 6; i++) CHECK(near_to(u[i], 1 / 6.0));
    CHECK(hd_heat_apply(heat, 1, &zero, 1, f, 0, u, 0, NULL, &err) == HD_OK && u[3] == f[3]);
    CHECK(hd_heat_apply(heat, 1, t, 1, f, 0, u, 0, NULL, &err) == HD_OK);
    for (i = 0; i < 6; i++) {
        double sum = 0;
        for (j = 0; j < 6; j++) sum += heat_of(i, j, T) * f[j];
        CHECK(fabs(u[i] - sum) <= 2e-6);
    }
    /* L is symmetric and B is the identity: K_t is its own adjoint */
    CHECK(hd_heat_adjoint(heat, 1, t, 1, f, 0, u + 6, 0, NULL, &err) == HD_OK);
    for (i = 0; i < 6; i++) CHECK(fabs(u[i] - u[6 + i]) <= 2e-6);
    CHECK(hd_heat_derivative(heat, 1, t, 1, f, 0, u, 0, NULL, &err) >= 0);
    for (i = 0; i < 6; i++) {
        double sum = 0;
        for (j = 0; j < 6; j++) sum += rate_of(i, j, T) * f[j];
        CHECK(fabs(u[i] - sum) <= 2e-6);
    }
    CHECK(hd_heat_entries(heat, HD_KERNEL_SYMMETRIC, 1, t, 2, tri, tri + 1, u, NULL, &err) == HD_OK);
    CHECK(near_to(u[0], heat_of(0, 2, T)) && near_to(u[1], heat_of(2, 4, T)));
}

/* A plan by a method and a solver: made if all it needs is there, and right. */
static void check_plan(const hd_laplacian *lap, hd_method method, hd_solver solver, const char *lacking) {
    hd_heat_opts o;
    hd_heat *heat = NULL;
    memset(&o, 0, sizeof o);
    o.method = method;
    o.solver = solver;
    if (!BUILT(hd_heat_create(&heat, lap, &o, &err), lacking)) return;
    check_columns(heat);
    hd_heat_free(heat);
}

static void check_plans(const hd_laplacian *lap) {
    const char *poles = no.iterative ? no.pole_factors : NULL;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    check_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, NULL);
    check_plan(lap, HD_METHOD_ITERATIVE, HD_SOLVER_AUTO, no.iterative);
    check_plan(lap, HD_METHOD_ITERATIVE, HD_SOLVER_COCG, no.iterative);
    check_plan(lap, HD_METHOD_AUTO, HD_SOLVER_LANCZOS, no.iterative);
    check_plan(lap, HD_METHOD_DIRECT, HD_SOLVER_AUTO, either(no.direct, no.pole_factors));
    check_plan(lap, HD_METHOD_KRYLOV, HD_SOLVER_AUTO, no.direct);
    check_plan(lap, HD_METHOD_LOCAL, HD_SOLVER_AUTO, either(no.direct, no.local));
    memset(&o, 0, sizeof o);
    o.degree = 10;
    if (!BUILT(hd_heat_create(&heat, lap, &o, &err), poles)) return;
    check_columns(heat);
    hd_heat_free(heat);
}

/* What comes from selected inversion, and distances. */
static void check_signatures(const hd_laplacian *lap) {
    const int32_t zero = 0, one = 1, two = 2;
    const hd_sources source = middle();
    const double t = T, off = heat_of(0, 0, 2 * T) - heat_of(0, 2, 2 * T);
    hd_heat *heat = NULL;
    hd_report rep;
    double d[6] = {0}, values[24] = {0};
    int32_t vertex[3] = {0, 0, 0};
    int i;
    CHECK(hd_heat_create(&heat, lap, NULL, &err) == HD_OK);
    if (BUILT(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, d, 0, NULL, NULL, &rep, &err), no.diagonal))
        for (i = 0; i < 6; i++) CHECK(near_to(d[i], heat_of(0, 0, T)));
    else CHECK(rep.status == HD_ERR_NOT_BUILT);
    if (BUILT(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &t, NULL, 0, values, NULL, NULL, &err), no.diagonal)) CHECK(near_to(values[0], 6 * heat_of(0, 0, T)));
    if (BUILT(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, d, 0, values, NULL, NULL, &err), no.diagonal)) CHECK(near_to(d[3] / values[0], 1 / 6.0));
    CHECK(hd_times_auto(lap, 2, values, &err) == HD_OK && near_to(values[0], 6 * 0.0024) && near_to(values[1], 6 * 0.37));
    if (BUILT(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &zero), d, 0, NULL, &err), no.diffusion))
        CHECK(d[0] == 0 && near_to(d[2], sqrt(2 * off)) && near_to(d[5], d[2]) && d[1] > d[2]);
    if (BUILT(hd_heat_distance_pairs(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &zero, &two, d, NULL, &err), no.diffusion))
        CHECK(near_to(d[0], sqrt(2 * off)));
    if (BUILT(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, &source, d, 0, NULL, &err), no.diffusion))
        CHECK(near_to(d[0], sqrt(off * 2 / 3)) && near_to(d[0], d[tri[1]]) && d[1] > d[0]);
    if (BUILT(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, NULL, 2, vertex, d, NULL, &err), no.diffusion))
        CHECK(vertex[0] == 0 && vertex[1] == one && d[0] == 0);
    if (BUILT(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, VERTICES(1, &zero), 1, vertex, d, NULL, &err), no.diffusion))
        CHECK(vertex[0] == one && d[0] > 0);
    if (BUILT(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, &source, 2, vertex, d, NULL, &err), no.diffusion))
        CHECK(d[0] > d[1] && d[1] > 0);
    hd_heat_free(heat);
}

/* Of intrinsic triangles, polygons and points, which other switches take away. */
static void check_geodesic_kinds(void) {
    static const int64_t ptr[9] = {0, 3, 6, 9, 12, 15, 18, 21, 24};
    hd_geodesic_opts o;
    hd_geodesic *g = NULL;
    memset(&o, 0, sizeof o);
    o.triangulation = HD_TRIANGULATION_DELAUNAY;
    if (BUILT(hd_geodesic_create(&g, MESH_TRIANGLES(xyz, 6, tri, 8), &o, &err), no.intrinsic)) hd_geodesic_free(g);
    if (BUILT(hd_geodesic_create(&g, MESH_POLYGONS(xyz, 6, ptr, tri, 8), NULL, &err), no.polygons)) hd_geodesic_free(g);
    o.triangulation = HD_TRIANGULATION_TUFTED;
    if (BUILT(hd_geodesic_create(&g, MESH_POINTS(xyz, 6), &o, &err), either(no.points, no.intrinsic))) hd_geodesic_free(g);
}

/* The smallest eigenpairs, and distances at a time where few are left. */
static void check_spectrum(const hd_laplacian *lap) {
    const int32_t zero = 0;
    const double t = 2, w = 1 / sqrt(3.0), opposite = sqrt(2 * exp(-8 * w * t));
    hd_spectrum_opts o;
    hd_spectrum *s = NULL;
    hd_heat *heat = NULL;
    hd_estimate estimate;
    hd_report rep;
    double u[6] = {0}, d[6];
    int i;
    memset(&o, 0, sizeof o);
    o.count = 6;
    if (BUILT(hd_spectrum_create(&s, lap, &o, &err), no.spectrum)) {
        CHECK(s->proven && s->n_constant == 1 && near_to(s->value[1], 4 * w) && near_to(s->value[4], 6 * w));
        CHECK(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, &t, VERTICES(1, &zero), u, NULL, 0, &err) == HD_OK);
        for (i = 0; i < 6; i++) CHECK(near_to(u[i], heat_of(i, 0, t)));
    } else {
        (void)BUILT(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, &t, VERTICES(1, &zero), u, NULL, 0, &err), no.spectrum);
        (void)BUILT(hd_spectrum_diagonal(s, HD_KERNEL_OPERATOR, 1, &t, u, NULL, 0, &err), no.spectrum);
        (void)BUILT(hd_spectrum_distance(s, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &zero), u, NULL, 0, &err), no.spectrum);
    }
    hd_spectrum_free(s);
    CHECK(hd_heat_create(&heat, lap, NULL, &err) == HD_OK);
    (void)BUILT(hd_heat_estimate(heat, HD_QUERY_SPECTRUM, 0, NULL, 3, &estimate, &err), no.spectrum);
    if (no.diffusion) {
        hd_heat_free(heat);
        return;
    }
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &zero), d, 0, &rep, &err) >= 0);
    CHECK((strstr(rep.reason, "eigenpairs") != NULL) == !no.spectrum && fabs(d[1] - opposite) <= rep.error_bound * opposite);
    CHECK(no.spectrum || fabs(d[1] - opposite) <= 1e-12 * opposite);
    hd_heat_free(heat);
}

static void check_geodesic(void) {
    hd_geodesic *g = NULL;
    hd_geodesic_report rep;
    const int32_t zero = 0;
    const hd_sources source = middle();
    double d[6] = {0};
    if (!BUILT(hd_geodesic_create(&g, MESH_TRIANGLES(xyz, 6, tri, 8), NULL, &err), no.geodesic)) {
        (void)BUILT(hd_geodesic_distance(NULL, VERTICES(1, &zero), d, 0, &rep, &err), no.geodesic);
        CHECK(rep.status == HD_ERR_NOT_BUILT && strstr(rep.error.text, no.geodesic) != NULL);
        (void)BUILT(hd_geodesic_distance(NULL, VERTICES(1, &zero), d, 0, NULL, &err), no.geodesic);
        (void)BUILT(hd_geodesic_distance(NULL, &source, d, 0, NULL, &err), no.geodesic);
        (void)BUILT(hd_geodesic_create(&g, MESH_LENGTHS(d, 6, tri, 8), NULL, &err), no.geodesic);
        (void)BUILT(hd_geodesic_update(NULL, MESH_POINTS(xyz, 6), &err), no.geodesic);
        hd_geodesic_free(g);
        return;
    }
    CHECK(hd_geodesic_distance(g, VERTICES(1, &zero), d, 0, &rep, &err) == HD_OK);
    CHECK(d[0] == 0 && d[2] > 1 && d[2] < 2 && near_to(d[2], d[5]) && d[1] > d[2] && d[1] < 3);
    CHECK(hd_geodesic_distance(g, &source, d, 0, &rep, &err) == HD_OK && near_to(d[0], sqrt(2 / 3.0)) && near_to(d[0], d[tri[1]]) &&
        d[1] > d[0]);
    hd_geodesic_free(g);
    check_geodesic_kinds();
}

static void check_shifted(const hd_laplacian *lap) {
    const double w = 1 / sqrt(3.0);
    const hd_c64 theta = {2, 0};
    hd_c64 b[6], x[6];
    int i;
    memset(b, 0, sizeof b);
    memset(x, 0, sizeof x);
    b[0].re = 1;
    if (!BUILT(hd_shifted_solve(lap, T, theta, b, x, NULL, NULL, &err), no.iterative)) return;
    for (i = 0; i < 6; i++)
        CHECK(near_to(x[i].re, between(i, 0, 0.5, 1 / (4 * w * T + 2), 1 / (6 * w * T + 2))) && near_to(x[i].im, 0));
}

/* [4 1; 1 3], and 1 + i times that. */
static void check_ldl(void) {
    const int32_t i[4] = {0, 0, 1, 1}, j[4] = {0, 1, 0, 1};
    const double v[4] = {4, 1, 1, 3}, b[2] = {1, 2};
    hd_c64 cv[4], cb[2], cx[2];
    hd_csr a;
    hd_ldl *f = NULL;
    double x[2] = {0}, entry[4] = {0};
    int k;
    for (k = 0; k < 4; k++) cv[k].re = cv[k].im = v[k];
    for (k = 0; k < 2; k++) {
        cb[k].re = b[k];
        cb[k].im = 0;
    }
    memset(cx, 0, sizeof cx);
    CHECK(hd_csr_from_triplets(&a, 2, 2, 4, i, j, v, NULL, &err) == HD_OK);
    if (!BUILT(hd_ldl_analyse(&f, &a, NULL, NULL, &err), no.direct)) {
        (void)BUILT(hd_ldl_factor(NULL, v, NULL, &err), no.direct);
        (void)BUILT(hd_ldl_solve(NULL, 1, b, 0, x, 0, &err), no.direct);
        (void)BUILT(hd_ldl_factor_complex(NULL, 1, cv, NULL, &err), no.direct);
        hd_csr_free(&a, NULL);
        return;
    }
    CHECK(hd_ldl_factor(f, v, NULL, &err) == HD_OK && hd_ldl_solve(f, 1, b, 0, x, 0, &err) == HD_OK);
    CHECK(near_to(x[0], 1 / 11.0) && near_to(x[1], 7 / 11.0));
    if (BUILT(hd_ldl_inverse(f, NULL, x, &err), no.diagonal)) CHECK(near_to(x[0], 3 / 11.0) && near_to(x[1], 4 / 11.0));
    if (BUILT(hd_ldl_inverse(f, entry, NULL, &err), no.diagonal)) CHECK(near_to(entry[1], -1 / 11.0));
    if (BUILT(hd_ldl_factor_complex(f, 1, cv, NULL, &err), no.pole_factors)) {
        CHECK(hd_ldl_solve_complex(f, cb, 0, cx, 0, &err) == HD_OK);
        CHECK(near_to(cx[1].re, 3.5 / 11.0) && near_to(cx[1].im, -3.5 / 11.0));
        if (BUILT(hd_ldl_inverse_complex(f, NULL, cx, &err), no.diagonal)) CHECK(near_to(cx[0].im, -1.5 / 11.0));
    } else {
        (void)BUILT(hd_ldl_solve_complex(f, cb, 0, cx, 0, &err), no.pole_factors);
    }
    hd_ldl_free(f);
    hd_csr_free(&a, NULL);
}

/* The octahedron is Delaunay: flips change nothing. Its faces as polygons have B = 2/sqrt(3) I. */
static void check_surfaces(void) {
    static const int64_t ptr[9] = {0, 3, 6, 9, 12, 15, 18, 21, 24};
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    double u[6], b = 2 / sqrt(3.0), t = T;
    hd_heat *heat = NULL;
    memset(&o, 0, sizeof o);
    o.kind = HD_LAPLACIAN_COT;
    o.triangulation = HD_TRIANGULATION_DELAUNAY;
    if (BUILT(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 6, tri, 8), &o, &err), no.intrinsic)) {
        check_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, NULL);
        hd_laplacian_free(lap);
    }
    o.kind = HD_LAPLACIAN_DEFAULT;
    (void)BUILT(hd_laplacian_create(&lap, MESH_POLYGONS(xyz, 6, ptr, tri, 8), &o, &err), either(no.polygons, no.intrinsic));
    if (err.status == HD_OK) hd_laplacian_free(lap);
    if (!BUILT(hd_laplacian_create(&lap, MESH_POLYGONS(xyz, 6, ptr, tri, 8), NULL, &err), no.polygons)) return;
    CHECK(hd_heat_create(&heat, lap, NULL, &err) == HD_OK);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t * b, 0, u, NULL, &err) == HD_OK);
    CHECK(near_to(u[0], heat_of(0, 0, t)) && near_to(u[1], heat_of(0, 1, t)) && near_to(u[2], heat_of(0, 2, t)));
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

/* Points evenly on the unit sphere (a Fibonacci lattice). */
static void check_points(void) {
    enum { N = 150 };
    static double p[3 * N], ones[N], y[N];
    const double from[3] = {0.9, 0.1, 0};
    int32_t i, nearest = -1;
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    memset(&o, 0, sizeof o);
    for (i = 0; i < N; i++) {
        const double z = 1 - (2 * i + 1.0) / (double)N, r = sqrt(1 - z * z), phi = 2.399963229728653 * i;
        p[3 * i] = r * cos(phi);
        p[3 * i + 1] = r * sin(phi);
        p[3 * i + 2] = z;
        ones[i] = 1;
    }
    if (BUILT(hd_neighbours_nearest(xyz, 6, from, 1, 1, &nearest, NULL, NULL, &err), no.points)) CHECK(nearest == 0);
    if (BUILT(hd_laplacian_create(&lap, MESH_POINTS(p, N), NULL, &err), no.points)) {
        CHECK(lap->n_active == N && fabs(lap->area - 12.566370614359172) < 1);
        CHECK(hd_laplacian_apply(lap, 1, 0, ones, y, &err) == HD_OK && fabs(y[0]) < 1e-9);
        hd_laplacian_free(lap);
    }
    o.triangulation = HD_TRIANGULATION_TUFTED;
    if (BUILT(hd_laplacian_create(&lap, MESH_POINTS(p, N), &o, &err), either(no.points, no.intrinsic))) {
        CHECK(lap->n_active == N && fabs(lap->area - 12.566370614359172) < 1);
        hd_laplacian_free(lap);
    }
}

/* 1/(1 + lambda) of the octahedron, with whatever a plan has for it. */
static void check_filter(const hd_laplacian *lap) {
    const char *lacking = no.iterative && no.pole_factors ? no.pole_factors : NULL;
    hd_filter f, two[2];
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_rational set, sets[2];
    const double w = 1 / sqrt(3.0), f4 = 1 / (1 + 4 * w), f6 = 1 / (1 + 6 * w);
    double u[6], both[12], sum[2] = {0, 0};
    int i;
    memset(&f, 0, sizeof f);
    memset(&o, 0, sizeof o);
    f.kind = HD_FILTER_RESOLVENT;
    f.a = 1;
    CHECK(hd_rational_fit(&set, 1, &f, lap->lambda_max, NULL, &err) == HD_OK && near_to(hd_rational_eval(&set, -2 * set.t), 1 / 3.0));
    o.rational = &set;
    if (BUILT(hd_heat_create(&heat, lap, &o, &err), lacking)) {
        CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, set.t, 0, u, NULL, &err) >= 0);
        for (i = 0; i < 6; i++) CHECK(near_to(u[i], between(i, 0, 1, f4, f6)));
        hd_heat_free(heat);
    }
    heat = NULL;
    CHECK(hd_heat_create(&heat, lap, NULL, &err) == HD_OK);
    if (BUILT(hd_heat_set_rational(heat, 1, &set, &err), lacking)) {
        if (BUILT(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &set.t, u, 0, NULL, NULL, NULL, &err), no.diagonal))
            for (i = 0; i < 6; i++) CHECK(near_to(u[i], between(i, i, 1, f4, f6)));
        CHECK(hd_rational_fit(&set, 1, &f, lap->lambda_max, NULL, &err) == HD_OK && hd_heat_set_rational(heat, 1, &set, &err) == HD_OK);
        if (BUILT(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 0, NULL, u, 0, sum, NULL, NULL, &err), no.diagonal))
            CHECK(near_to(sum[0], 1 + 3 * f4 + 2 * f6));
        two[0] = two[1] = f;
        two[1].a = 2;
        CHECK(hd_rational_fit(sets, 2, two, lap->lambda_max, NULL, &err) == HD_OK && hd_heat_set_rational(heat, 2, sets, &err) == HD_OK);
        if (BUILT(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 0, NULL, both, 0, sum, NULL, NULL, &err), no.diagonal))
            CHECK(near_to(sum[0], 1 + 3 * f4 + 2 * f6) && near_to(both[6], sum[1] / 6) && near_to(sum[1], 1 + 3 / (1 + 8 * w) + 2 / (1 + 12 * w)));
    }
    hd_heat_free(heat);
}

static void check_poles(const hd_laplacian *lap) {
    hd_rational set;
    CHECK(hd_rational_exp(&set, HD_POLES_UNIFORM, 7, &err) == HD_OK && near_to(hd_rational_eval(&set, -1), exp(-1.0)));
    CHECK(hd_rational_exp(&set, HD_POLES_KERNEL, 10, &err) == HD_OK && near_to(hd_rational_eval(&set, -2), exp(-2.0)));
    check_filter(lap);
}

int main(void) {
    hd_laplacian_opts o;
    hd_laplacian *lap;
    find_switches();
    memset(&o, 0, sizeof o);
    lap = octahedron(&o);
    check_plans(lap);
    check_signatures(lap);
    check_spectrum(lap);
    check_geodesic();
    check_shifted(lap);
    check_ldl();
    check_surfaces();
    check_points();
    check_poles(lap);
    hd_laplacian_free(lap);
    printf("%d passed, %d failed\n", n_checks - n_failed, n_failed);
    return n_failed != 0;
}
