/* The same numbers on every processor. One small surface goes through every method, and a weighted sum of each answer is compared with
 * what x86-64 computed, to 1e-12 of the sum of magnitudes (iterations: 1e-9, their tolerance). Takes a few milliseconds, so that
 * emulators and small machines can run it. */

static void plat_is(const char *what, const double *u, int32_t n, double want, double tol) {
    double sum = 0, size = 0;
    int32_t i;
    for (i = 0; i < n; i++) {
        const double term = u[i] * (1 + i % 7);
        sum += term;
        size += fabs(term);
    }
    CHECK_MSG(fabs(sum - want) <= tol * size, "%s: %.17g, not %.17g", what, sum, want);
}

static void plat_heat(const hd_laplacian *lap, const char *what, const double want[2]) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    const double t[1] = {3 * lap->h * lap->h};
    double *u = KIT_NEW(double, lap->n);
    int k;
    for (k = 0; k < 3; k++) {
        hd_heat *heat = NULL;
        hd_heat_opts o;
        memset(&o, 0, sizeof o);
        o.method = methods[k];
        o.tol = 1e-12;
        o.degree = methods[k] == HD_METHOD_KRYLOV ? 0 : 12;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t[0], 5, u, NULL, NULL) >= 0);
        plat_is(what, u, lap->n, want[0], k ? 1e-9 : 1e-12);
        if (k == 0) {
            CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, t, u, 0, NULL, NULL, NULL, NULL) >= 0);
            plat_is(what, u, lap->n, want[1], 1e-12);
        }
        hd_heat_free(heat);
    }
}

static void test_platform(void) {
    static const double fem[2] = {2.5543600282776149, 197.3638785557259}, flipped[2] = {2.9845496459786554, 206.81190328240322},
                        points[2] = {2.5341179078977927, 322.10133008115127};
    shape ball = kit_own_shape(shape_bumpy(2, 9));
    const int32_t source = 7;
    const double t = 0.1;
    double *d = KIT_NEW(double, ball.n);
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_heat *heat = NULL;
    hd_geodesic *geo = NULL;
    memset(&o, 0, sizeof o);
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(ball.xyz, ball.n, ball.tri, ball.n_tri), NULL, NULL) == HD_OK);
    plat_heat(lap, "fem", fem);
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &source), d, 0, NULL, NULL) >= 0);
    plat_is("distance", d, ball.n, 541.53341078606354, 1e-12);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    o.kind = HD_LAPLACIAN_VORONOI_COT;
    o.triangulation = HD_TRIANGULATION_DELAUNAY;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(ball.xyz, ball.n, ball.tri, ball.n_tri), &o, NULL) == HD_OK);
    plat_heat(lap, "intrinsic", flipped);
    hd_laplacian_free(lap);
    CHECK(at_tufted(&lap, ball.xyz, ball.n, NULL, NULL, NULL, NULL) == HD_OK);
    plat_heat(lap, "points", points);
    hd_laplacian_free(lap);
    CHECK(hd_geodesic_create(&geo, MESH_TRIANGLES(ball.xyz, ball.n, ball.tri, ball.n_tri), NULL, NULL) == HD_OK);
    CHECK(hd_geodesic_distance(geo, VERTICES(1, &source), d, 0, NULL, NULL) >= 0);
    plat_is("geodesic", d, ball.n, 1061.2440935015238, 1e-12);
    hd_geodesic_free(geo);
}
