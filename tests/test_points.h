/* test_points.h - neighbours against brute force; cells, operators and heat of point sets against what is known of planes, spheres and tori,
 * against a dense computation of the same formulas, and by their invariances */

#ifndef TEST_POINTS_H
#define TEST_POINTS_H

static const double pts_pi = 3.141592653589793;

/* ---- neighbours ---- */

enum { PTS_SETS = 9 };

/* Sets of n points that k-d trees may stumble over. Those with whole-number coordinates have exact distances and many ties. */
static const char *pts_set(int which, int32_t n, double *xyz, int *exact) {
    static const char *const names[PTS_SETS] = {"ball", "grid", "one place", "line", "axis", "clusters", "two places", "plane", "falling"};
    uint64_t seed = 42;
    int32_t i;
    int c;
    *exact = which == 1 || which == 2 || which == 6;
    for (i = 0; i < n; i++) {
        double *p = xyz + 3 * (size_t)i;
        for (c = 0; c < 3; c++) p[c] = dense_signed(&seed);
        if (which == 1) {
            p[0] = i % 7;
            p[1] = i / 7 % 7;
            p[2] = i / 49;
        }
        if (which == 2 || which == 6)
            for (c = 0; c < 3; c++) p[c] = which == 6 && i % 3 == 0 ? 5 : 1;
        if (which == 3) {
            p[1] = 2 * p[0];
            p[2] = -p[0];
        }
        if (which == 4) p[1] = p[2] = 0;
        if (which == 5)
            for (c = 0; c < 3; c++) p[c] = 1e-6 * p[c] + i % 4;
        if (which == 7) p[2] = 0;
        if (which == 8) {
            p[0] = pow(0.9, i);
            p[1] = -p[0];
        }
    }
    return names[which];
}

static double pts_d2(const double *a, const double *b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/* How many points are nearer than d2 by more than rounding, and how many are not farther by more than it. */
static void pts_rank(const double *xyz, int32_t n, const double *q, double d2, int32_t *nearer, int32_t *within) {
    int32_t i;
    for (i = 0, *nearer = *within = 0; i < n; i++) {
        const double d = pts_d2(xyz + 3 * (size_t)i, q);
        *nearer += d < d2 * (1 - 1e-14);
        *within += d <= d2 * (1 + 1e-14);
    }
}

/* One row of results: in order, right distances, nobody twice, nobody nearer left out; with exact distances also ties by id. */
static int pts_row(const double *xyz, int32_t n, const double *q, int32_t k, const int32_t *id, const double *d2, int exact) {
    const int32_t want = k < n ? k : n;
    int32_t p, nearer, within;
    int ok = 1;
    for (p = 0; p < want; p++) {
        if (id[p] < 0 || id[p] >= n) return 0;
        ok &= fabs(d2[p] - pts_d2(xyz + 3 * (size_t)id[p], q)) <= 1e-15 * d2[p];
        if (p > 0) ok &= d2[p] > d2[p - 1] || (d2[p] == d2[p - 1] && id[p] > id[p - 1]);
        pts_rank(xyz, n, q, d2[p], &nearer, &within);
        ok &= nearer <= p && within > p;
    }
    if (exact && want > 0 && want < n) {         /* of equally far ones those with small ids were taken */
        int32_t i, before = 0;
        for (i = 0; i <= id[want - 1]; i++) before += pts_d2(xyz + 3 * (size_t)i, q) == d2[want - 1];
        for (p = 0; p < want; p++) before -= d2[p] == d2[want - 1];
        ok &= before == 0;
    }
    for (p = want; p < k; p++) ok &= id[p] == -1 && d2[p] > DBL_MAX;
    return ok;
}

static void pts_nearest(void) {
    static const int32_t sizes[] = {1, 2, 5, 16, 17, 33, 343, 700}, ks[] = {1, 2, 7, 30, 400};
    double *xyz = KIT_NEW(double, 3 * 700), *query = KIT_NEW(double, 3 * 60), *d2 = KIT_NEW(double, 700 * 400);
    int32_t *id = KIT_NEW(int32_t, 700 * 400), i;
    size_t a, b;
    int which, exact;
    uint64_t seed = 3;
    hd_error e;
    for (i = 0; i < 180; i++) query[i] = i < 90 ? floor(4 * dense_signed(&seed)) : 2 * dense_signed(&seed);
    for (i = 90; i < 99; i++) query[i] = 1e6;    /* far away */
    for (which = 0; which < PTS_SETS; which++) {
        for (a = 0; a < sizeof sizes / sizeof *sizes; a++) {
            const int32_t n = sizes[a];
            const char *what = pts_set(which, n, xyz, &exact);
            for (b = 0; b < sizeof ks / sizeof *ks; b++) {
                const int32_t k = ks[b];
                int32_t bad = 0;
                CHECK(hd_neighbours_nearest(xyz, n, NULL, n, k, id, d2, NULL, &e) == HD_OK);
                for (i = 0; i < n; i++) bad += !pts_row(xyz, n, xyz + 3 * (size_t)i, k, id + (size_t)i * (size_t)k, d2 + (size_t)i * (size_t)k, exact);
                CHECK_MSG(bad == 0, "%s: n %d, k %d: %d rows wrong", what, (int)n, (int)k, (int)bad);
                CHECK(hd_neighbours_nearest(xyz, n, query, 60, k, id, d2, NULL, &e) == HD_OK);
                for (i = 0, bad = 0; i < 60; i++) bad += !pts_row(xyz, n, query + 3 * i, k, id + i * k, d2 + i * k, exact && i < 30);
                CHECK_MSG(bad == 0, "%s: n %d, k %d: %d queries wrong", what, (int)n, (int)k, (int)bad);
            }
        }
    }
}

static void pts_neighbour_errors(void) {
    double xyz[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, query[12] = {0, 0, 0, 1, 1, 1, 0, 0, 0, 0, NAN, 0}, d2[9];
    int32_t id[9];
    hd_error e;
    CHECK(hd_neighbours_nearest(xyz, 3, NULL, 3, 0, id, d2, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_neighbours_nearest(xyz, 3, NULL, 3, 1, NULL, d2, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_neighbours_nearest(NULL, 3, NULL, 3, 1, id, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_neighbours_nearest(xyz, -1, NULL, 3, 1, id, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_neighbours_nearest(xyz, 3, query, -2, 1, id, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_neighbours_nearest(xyz, 3, query, 4, 1, id, NULL, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 3 && e.column == 1);
    xyz[4] = INFINITY;
    CHECK(hd_neighbours_nearest(xyz, 3, NULL, 0, 1, id, NULL, NULL, &e) == HD_ERR_NOT_FINITE && e.vertex == 1);
    xyz[4] = 1e200;
    CHECK(hd_neighbours_nearest(xyz, 3, NULL, 0, 1, id, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.vertex == 1 && e.value == 1e200);
    CHECK(hd_neighbours_nearest(NULL, 0, xyz, 3, 1, id, NULL, NULL, &e) == HD_ERR_ARGUMENT && e.row == 1 && e.column == 1 && e.value == 1e200);
    xyz[4] = 0;
    CHECK(hd_neighbours_nearest(xyz, 3, NULL, 0, 2, id, NULL, NULL, NULL) == HD_OK && id[0] == 0 && id[1] == 1 && id[2] == 1);
    CHECK(hd_neighbours_nearest(NULL, 0, query, 1, 2, id, d2, NULL, &e) == HD_OK && id[0] == -1 && id[1] == -1);   /* no points */
}

/* ---- operators ---- */

static hd_laplacian *pts_make(const double *xyz, int32_t n, hd_laplacian_kind kind, double bandwidth) {
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.bandwidth2 = bandwidth;
    CHECK_MSG(hd_laplacian_create(&lap, MESH_POINTS(xyz, n), &o, &e) == HD_OK, "%s", e.text);
    return kit_own_laplacian(lap);
}

/* Every entry by the formulas of the operators, from coordinates and masses; zero rows; symmetric to the last bit. */
static void pts_entries(const hd_laplacian *lap, const double *xyz, const char *what) {
    const double s = lap->points.bandwidth2, cut = lap->points.weight_cut;
    const int voronoi = lap->kind == HD_LAPLACIAN_VORONOI_EXP;
    double worst = 0, worst_row = 0;
    int64_t wrong = 0, asymmetric = 0, p;
    int32_t i, j;
    CHECK_MSG(!test_csr_fault(&lap->L, 1), "%s: %s", what, test_csr_fault(&lap->L, 1));
    CHECK(lap->conserves == 1 && lap->b_ratio == 1 && !lap->B && lap->b_diag == lap->mass);
    CHECK(fabs(lap->points.cut_radius - sqrt(-4 * s * log(cut))) <= 1e-13 * lap->points.cut_radius);
    for (i = 0; i < lap->n_active; i++) {
        const double *a = xyz + 3 * (size_t)lap->vertex[i];
        double sum = 0, size = 0;
        CHECK(memcmp(a, lap->xyz + 3 * (size_t)i, 3 * sizeof *a) == 0 && lap->row[lap->vertex[i]] == i);
        p = lap->L.row_ptr[i];
        for (j = 0; j < lap->n_active; j++) {
            const double r2 = pts_d2(a, xyz + 3 * (size_t)lap->vertex[j]), weight = exp(-r2 / (4 * s));
            const int here = p < lap->L.row_ptr[i + 1] && lap->L.col[p] == j;
            const double value = voronoi ? lap->mass[i] * lap->mass[j] * weight / (4 * pts_pi * s * s) : weight / (lap->n * s * 4 * pts_pi * s);
            if (i != j && fabs(weight - cut) > 1e-12 * cut) wrong += here != (weight > cut);
            if (!here) continue;
            sum += lap->L.val[p];
            size += fabs(lap->L.val[p]);
            if (i != j) {
                const int64_t q = op_find(&lap->L, j, i);
                worst = fmax(worst, fabs(lap->L.val[p] / -value - 1));
                asymmetric += q < 0 || lap->L.val[p] != lap->L.val[q];
            }
            p++;
        }
        worst_row = fmax(worst_row, size > 0 ? fabs(sum) / size : 0);
    }
    CHECK_MSG(wrong == 0 && worst < 1e-13, "%s: %lld entries out of place, values off by %g", what, (long long)wrong, worst);
    CHECK_MSG(asymmetric == 0 && worst_row < 1e-14, "%s: %lld entries differ from their mirror, row sum %g", what, (long long)asymmetric, worst_row);
}

/* No negative eigenvalue, one zero for each component. */
static void pts_spectrum(const hd_laplacian *lap, const char *what) {
    dense_pair p;
    double top;
    int32_t i, zeros = 0, negative = 0;
    CHECK(dense_pair_solve(&p, test_dense(&lap->L, NULL), test_dense_mass(lap), lap->n_active));
    top = dense_max_abs(p.lambda, lap->n_active);
    for (i = 0; i < lap->n_active; i++) {
        negative += p.lambda[i] < -1e-12 * top;
        zeros += fabs(p.lambda[i]) < 1e-12 * top;
    }
    CHECK_MSG(negative == 0 && zeros == lap->n_components, "%s: %d negative, %d zero of %d", what, (int)negative, (int)zeros, (int)lap->n_components);
    dense_pair_free(&p);
}

static void pts_operators(void) {
    static const hd_laplacian_kind kinds[] = {HD_LAPLACIAN_VORONOI_EXP, HD_LAPLACIAN_EXP};
    int blue, k;
    for (blue = 0; blue < 2; blue++) {
        shape s = kit_own_shape(shape_points(150, shape_on_torus, 8 * pts_pi * pts_pi, blue, 5));
        for (k = 0; k < 2; k++) {
            hd_laplacian *lap = pts_make(s.xyz, s.n, kinds[k], 0), *narrow;
            double sum = 0, h = 0;
            int32_t i, j;
            CHECK(lap->kind == kinds[k] && lap->n_active == s.n && lap->points.bandwidth2 > 0 && lap->points.neighbours == 30);
            pts_entries(lap, s.xyz, "torus");
            for (i = 0; i < s.n; i++) {
                double least = HUGE_VAL;
                for (j = 0; j < s.n; j++) least = i == j ? least : fmin(least, pts_d2(s.xyz + 3 * i, s.xyz + 3 * j));
                h += sqrt(least) / s.n;
                sum += lap->mass[i];
            }
            CHECK(fabs(lap->h - h) <= 1e-13 * h);
            CHECK(fabs(sum - (k ? s.n : lap->area)) <= 1e-12 * sum);
            narrow = pts_make(s.xyz, s.n, kinds[k], lap->points.bandwidth2 / 10);
            CHECK(narrow->L.nnz < lap->L.nnz && narrow->points.bandwidth2 == lap->points.bandwidth2 / 10);
            pts_entries(narrow, s.xyz, "torus, narrow");
            pts_spectrum(lap, "torus");
            pts_spectrum(narrow, "torus, narrow");
        }
    }
}

/* ---- cells ---- */

static void pts_areas(void) {
    static const shape_sampler on[2] = {shape_on_sphere, shape_on_torus};
    static const double area[2] = {4 * 3.141592653589793, 8 * 9.869604401089358};
    int which, blue;
    for (which = 0; which < 2; which++) {
        for (blue = 0; blue < 2; blue++) {
            shape s = kit_own_shape(shape_points(10000, on[which], area[which], blue, 11));
            hd_laplacian *lap = pts_make(s.xyz, s.n, HD_LAPLACIAN_VORONOI_EXP, 1e-3);
            CHECK_MSG(fabs(lap->area / area[which] - 1) < (blue ? 0.003 : 0.006), "surface %d, blue %d: area %g of the true one", which, blue,
                      lap->area / area[which]);
            CHECK_MSG(lap->points.n_border < (blue ? 1 : 60), "%d cells at a border that is not there", (int)lap->points.n_border);
        }
    }
}

/* Cells in the plane: of a square grid, exactly; of random points, against counting on which cell the nodes of a fine grid lie. */
static void pts_plane(void) {
    enum { FINE = 500, N = 200 };
    shape grid = kit_own_shape(shape_grid(21, 21, 0)), s;
    double *query = KIT_NEW(double, 3 * FINE * FINE), count[N] = {0}, worst = 0;
    int32_t *id = KIT_NEW(int32_t, FINE * FINE), i, inner = 0;
    hd_laplacian *lap = pts_make(grid.xyz, grid.n, HD_LAPLACIAN_VORONOI_EXP, 0);
    for (i = 0; i < grid.n; i++) {
        const int edge = (i % 21 == 0) + (i % 21 == 20) + (i / 21 == 0) + (i / 21 == 20);
        CHECK_MSG(fabs(lap->mass[i] * 400 * (1 << edge) - 1) < 1e-12, "grid point %d: %g cells", (int)i, lap->mass[i] * 400);
    }
    CHECK(fabs(lap->area - 1) < 1e-12 && fabs(lap->h - 0.05) < 1e-15);
    for (i = 0; i < FINE * FINE; i++) {
        query[3 * i] = (i % FINE + 0.5) / FINE;
        query[3 * i + 1] = (i / FINE + 0.5) / FINE;
    }
    s = kit_own_shape(shape_points(N, shape_on_square, 1, 0, 3));
    lap = pts_make(s.xyz, N, HD_LAPLACIAN_VORONOI_EXP, 0);
    CHECK(hd_neighbours_nearest(s.xyz, N, query, FINE * FINE, 1, id, NULL, NULL, NULL) == HD_OK);
    for (i = 0; i < FINE * FINE; i++) count[id[i]] += 1.0 / (FINE * FINE);
    for (i = 0; i < N; i++) {
        const double *p = s.xyz + 3 * i;
        const double margin = fmin(fmin(p[0], 1 - p[0]), fmin(p[1], 1 - p[1]));
        CHECK_MSG(lap->mass[i] <= count[i] + 0.05 / N || margin < 0.12, "point %d: cell %g, not %g", (int)i, lap->mass[i] * N, count[i] * N);
        if (margin < 0.2) continue;
        inner++;
        worst = fmax(worst, fabs(lap->mass[i] - count[i]) * N);
    }
    CHECK_MSG(inner > 40 && worst < 0.02, "%d inner cells, the worst off by %g of the mean cell", (int)inner, worst);
    CHECK_MSG(lap->area > 0.85 && lap->area < 1.05, "area of 200 random points in a square %g", lap->area);
    CHECK(lap->points.n_border > 20 && lap->points.n_border < 120);
}

/* Two sheets, two points' spacings apart, have twice the area of one. */
static void pts_sheets(void) {
    enum { N = 1000 };
    shape s = kit_own_shape(shape_points(N, shape_on_square, 1, 1, 8)), t = kit_own_shape(shape_points(N, shape_on_square, 1, 1, 9)), both;
    hd_laplacian *one = pts_make(s.xyz, N, HD_LAPLACIAN_VORONOI_EXP, 0), *two;
    static const double gaps[] = {2, 3, 20};
    size_t k;
    for (k = 0; k < 3; k++) {
        const double offset[3] = {0, 0, gaps[k] / sqrt((double)N)};
        double each = 0;
        int32_t i;
        both = kit_own_shape(shape_disjoint(&s, &t, offset));
        two = pts_make(both.xyz, both.n, HD_LAPLACIAN_VORONOI_EXP, one->points.bandwidth2);
        for (i = 0; i < N; i++) each += two->mass[i];
        CHECK_MSG(fabs(each / one->area - 1) < 0.04 && fabs(two->area / one->area / 2 - 1) < 0.04, "gap %g: areas %g and %g of one sheet", gaps[k],
                  each / one->area, two->area / one->area);
        CHECK(two->n_components == (gaps[k] < 10 ? 1 : 2));
    }
}

/* ---- what must not matter, and what must be told ---- */

/* Largest difference of L (in units of its largest entry) and of the masses between two Laplacians, vertex v of a being map[v] of b. */
static double pts_difference(const hd_laplacian *a, const hd_laplacian *b, const int32_t *map, double mass_unit, double l_unit) {
    double worst = 0, top = dense_max_abs(a->L.val, a->L.nnz);
    int64_t p;
    int32_t i;
    if (a->n_active != b->n_active || a->L.nnz != b->L.nnz) return HUGE_VAL;
    for (i = 0; i < a->n_active; i++) {
        const int32_t v = map ? map[a->vertex[i]] : a->vertex[i];
        worst = fmax(worst, fabs(a->mass[i] - b->mass[b->row[v]] * mass_unit) / a->mass[i]);
        for (p = a->L.row_ptr[i]; p < a->L.row_ptr[i + 1]; p++) {
            const int32_t u = a->vertex[a->L.col[p]];
            worst = fmax(worst, fabs(a->L.val[p] - l_unit * op_l(b, v, map ? map[u] : u)) / top);
        }
    }
    return worst;
}

static void pts_invariance(void) {
    enum { N = 300 };
    shape s = kit_own_shape(shape_points(N, shape_on_torus, 8 * pts_pi * pts_pi, 0, 21)), t = kit_own_shape(shape_points(N, shape_on_torus, 1, 0, 1));
    int32_t perm[N], i;
    uint64_t seed = 4;
    int kind, c;
    dense_shuffle(perm, N, &seed);
    for (kind = 0; kind < 2; kind++) {
        const hd_laplacian_kind k = kind ? HD_LAPLACIAN_EXP : HD_LAPLACIAN_VORONOI_EXP;
        hd_laplacian *a = pts_make(s.xyz, N, k, 0), *b;
        double d;
        for (i = 0; i < N; i++) {                /* a rotation by 3-4-5 about z, a cyclic turn of the axes, and a shift */
            const double *p = s.xyz + 3 * i;
            t.xyz[3 * i] = 0.6 * p[0] - 0.8 * p[1] + 10;
            t.xyz[3 * i + 1] = p[2] - 3;
            t.xyz[3 * i + 2] = 0.8 * p[0] + 0.6 * p[1] + 0.5;
        }
        b = pts_make(t.xyz, N, k, 0);
        d = pts_difference(a, b, NULL, 1, 1);
        CHECK_MSG(d < 1e-11, "rigid motion: %g", d);
        for (i = 0; i < N; i++) for (c = 0; c < 3; c++) t.xyz[3 * i + c] = 1e-6 * s.xyz[3 * i + c];
        b = pts_make(t.xyz, N, k, 0);            /* L of voronoi-exp has no unit, that of exp 1/length^4 */
        d = pts_difference(a, b, NULL, kind ? 1 : 1e12, kind ? 1e-24 : 1);
        CHECK_MSG(d < 1e-11 && fabs(b->points.bandwidth2 * 1e12 / a->points.bandwidth2 - 1) < 1e-13, "scale: %g", d);
        for (i = 0; i < N; i++) memcpy(t.xyz + 3 * perm[i], s.xyz + 3 * i, 3 * sizeof(double));
        b = pts_make(t.xyz, N, k, 0);
        d = pts_difference(a, b, perm, 1, 1);
        CHECK_MSG(d < 1e-12, "permutation: %g", d);
    }
}

static void pts_coincident(void) {
    enum { N = 400, COPIES = 40, M = N + COPIES + 3 };
    shape s = kit_own_shape(shape_points(N, shape_on_sphere, 4 * pts_pi, 0, 2)), t = kit_own_shape(shape_points(M, shape_on_sphere, 4 * pts_pi, 0, 3));
    hd_laplacian *a = pts_make(s.xyz, N, HD_LAPLACIAN_VORONOI_EXP, 0), *b;
    int32_t i;
    s.xyz[3 * 7] = 0;
    a = pts_make(s.xyz, N, HD_LAPLACIAN_VORONOI_EXP, 0);
    memcpy(t.xyz, s.xyz, 3 * N * sizeof(double));
    for (i = 0; i < COPIES; i++) memcpy(t.xyz + 3 * (N + i), s.xyz + 3 * 5, 3 * sizeof(double));   /* more than neighbours are looked at */
    for (i = N + COPIES; i < M; i++) memcpy(t.xyz + 3 * i, s.xyz + 3 * 7, 3 * sizeof(double));
    t.xyz[3 * (M - 1)] = -0.0;                   /* is 0 */
    b = pts_make(t.xyz, M, HD_LAPLACIAN_VORONOI_EXP, 0);
    CHECK(b->points.n_coincident == COPIES + 3 && b->n_active == M && b->points.n_isolated == 0 && b->n_components == 1);
    CHECK(fabs(b->h - a->h) < 1e-14 && fabs(b->area - a->area) < 1e-13 && fabs(b->points.bandwidth2 - a->points.bandwidth2) < 1e-14);
    CHECK(fabs(b->mass[5] * (COPIES + 1) - a->mass[5]) < 1e-15 && b->mass[5] == b->mass[N] && b->mass[5] == b->mass[N + COPIES - 1]);
    CHECK(fabs(b->mass[7] * 4 - a->mass[7]) < 1e-15 && b->mass[M - 1] == b->mass[7] && b->mass[9] == a->mass[9]);
    CHECK(fabs(op_l(a, 5, 7) - (COPIES + 1) * 4 * op_l(b, 5, M - 1)) < 1e-13 * fabs(op_l(a, 5, 5)) && op_l(a, 20, 21) == op_l(b, 20, 21));
    pts_entries(b, t.xyz, "coincident");
    pts_spectrum(b, "coincident");
    b = pts_make(t.xyz, M, HD_LAPLACIAN_EXP, 0);
    CHECK(b->mass[5] == 1 && b->points.n_coincident == COPIES + 3);
    pts_entries(b, t.xyz, "coincident exp");
}

/* Outliers are components of their own, small, and change little for the others. */
static void pts_outliers(void) {
    enum { N = 1000 };
    shape s = kit_own_shape(shape_points(N + 2, shape_on_sphere, 4 * pts_pi, 1, 2));
    hd_laplacian *clean = pts_make(s.xyz, N, HD_LAPLACIAN_VORONOI_EXP, 0), *lap;
    hd_heat *heat = NULL;
    hd_report rep;
    double *u = KIT_NEW(double, N + 2), largest = 0;
    int32_t i;
    for (i = 0; i < 3; i++) {
        s.xyz[3 * N + i] = 40;
        s.xyz[3 * N + 3 + i] = i == 0 ? 7 : 0;
    }
    lap = pts_make(s.xyz, N + 2, HD_LAPLACIAN_VORONOI_EXP, 0);
    CHECK(lap->points.n_isolated == 2 && lap->n_components == 3 && lap->n_active == N + 2);
    for (i = 0; i < N; i++) largest = fmax(largest, fabs(lap->mass[i] / clean->mass[i] - 1));
    CHECK_MSG(largest < 1e-12, "cells changed by %g", largest);
    CHECK_MSG(lap->mass[N] + lap->mass[N + 1] < 30 * clean->area / N, "outliers' cells %g, %g", lap->mass[N], lap->mass[N + 1]);
    CHECK_MSG(fabs(lap->points.bandwidth2 / clean->points.bandwidth2 - 1) < 0.15, "bandwidth %g times", lap->points.bandwidth2 / clean->points.bandwidth2);
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK && heat_column(heat, 0.1, 3, u, &rep) == HD_OK);
    CHECK(u[N] == 0 && u[N + 1] == 0 && u[3] > 0);
    CHECK(heat_column(heat, 0.1, N, u, &rep) == HD_OK && fabs(u[N] - 1) < 1e-12 && u[0] == 0);
    hd_heat_free(heat);
}

static hd_status pts_status(const double *xyz, int32_t n, hd_laplacian_kind kind, double bandwidth, double cut, int32_t neighbours, hd_error *e) {
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_status st;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.bandwidth2 = bandwidth;
    o.weight_cut = cut;
    o.neighbours = neighbours;
    st = hd_laplacian_create(&lap, MESH_POINTS(xyz, n), &o, e);
    CHECK((st >= 0) == (lap != NULL) && e->status == st);
    hd_laplacian_free(lap);
    return st;
}

static void pts_errors(void) {
    shape s = kit_own_shape(shape_points(50, shape_on_sphere, 4 * pts_pi, 0, 2));
    const double keep = s.xyz[10];
    double small[150];
    hd_error e;
    int32_t i, k;
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_DEFAULT, 0, 0, 0, &e) == HD_OK);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_FEM, 0, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_COT, 0, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_MATRICES, 0, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, -1, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, NAN, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, INFINITY, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 1, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, -1e-8, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 0, 5, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 0, 129, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_VORONOI_EXP, 0, 1e-4, 128, &e) == HD_OK);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_VORONOI_EXP, 1e300, 0, 6, &e) >= 0);           /* all with all */
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_VORONOI_EXP, 1e-300, 0, 6, &e) >= 0);          /* none with none */
    for (k = 0; k < 150; k++) small[k] = s.xyz[k] * 1e-60;
    CHECK(pts_status(small, 50, HD_LAPLACIAN_VORONOI_EXP, 0, 0, 0, &e) == HD_ERR_ARGUMENT && e.vertex >= 0 && e.value > 0 && e.value < 1e-100);
    CHECK(pts_status(s.xyz, -1, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(NULL, 3, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_create(NULL, MESH_POINTS(s.xyz, 50), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(pts_status(NULL, 0, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_EMPTY);
    CHECK(pts_status(s.xyz, 1, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_EMPTY);
    CHECK(pts_status(s.xyz, 2, HD_LAPLACIAN_VORONOI_EXP, 0, 0, 0, &e) == HD_ERR_EMPTY);     /* on a line */
    CHECK(pts_status(s.xyz, 2, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_OK);
    CHECK(pts_status(s.xyz, 3, HD_LAPLACIAN_VORONOI_EXP, 0, 0, 0, &e) == HD_OK);
    s.xyz[10] = NAN;
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_NOT_FINITE && e.vertex == 3 && e.value != e.value);
    s.xyz[10] = -1e101;
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_ARGUMENT && e.vertex == 3 && e.value == -1e101);
    s.xyz[10] = keep;
    for (i = 0; i < 150; i++) s.xyz[i] *= 1e-170;
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_ERR_ARGUMENT && e.vertex >= 0);
    for (i = 0; i < 50; i++) {                   /* a line in space */
        s.xyz[3 * i] = 0.1 * i;
        s.xyz[3 * i + 1] = 0.3 * i;
        s.xyz[3 * i + 2] = -0.2 * i;
    }
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_VORONOI_EXP, 0, 0, 0, &e) == HD_ERR_EMPTY);
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 0, 0, 0, &e) == HD_OK);
    memcpy(s.xyz, s.xyz + 3, 3 * sizeof(double));
    CHECK(pts_status(s.xyz, 50, HD_LAPLACIAN_EXP, 1e-300, 0, 0, &e) == HD_ERR_NOT_FINITE && e.vertex == 0);   /* weight of a pair in one place */
}

/* The same bits whatever runs the loops. */
static void pts_threads(void) {
    shape s = kit_own_shape(shape_points(3000, shape_on_torus, 8 * pts_pi * pts_pi, 0, 6));
    hd_laplacian *lap[3] = {NULL, NULL, NULL};
    hd_context ctx[3];
    hd_laplacian_opts o;
    int64_t calls = 0;
    int way;
    memset(ctx, 0, sizeof ctx);
    ctx[0].n_threads = 1;
    ctx[1].parallel_user = ctx[2].parallel_user = &calls;
    ctx[1].parallel_for = sparse_reverse_for;
    ctx[2].parallel_for = heat_shuffled_for;
    for (way = 0; way < 3; way++) {
        memset(&o, 0, sizeof o);
        o.context = ctx + way;
        if (!CHECK(hd_laplacian_create(&lap[way], MESH_POINTS(s.xyz, s.n), &o, NULL) == HD_OK)) return;
        if (way == 0) continue;
        CHECK(lap[way]->L.nnz == lap[0]->L.nnz && lap[way]->area == lap[0]->area && lap[way]->points.bandwidth2 == lap[0]->points.bandwidth2);
        CHECK(memcmp(lap[way]->L.col, lap[0]->L.col, (size_t)lap[0]->L.nnz * sizeof(int32_t)) == 0);
        CHECK(memcmp(lap[way]->L.val, lap[0]->L.val, (size_t)lap[0]->L.nnz * sizeof(double)) == 0);
        CHECK(memcmp(lap[way]->mass, lap[0]->mass, (size_t)s.n * sizeof(double)) == 0);
    }
    for (way = 0; way < 3; way++) hd_laplacian_free(lap[way]);
}

/* ---- the smooth sphere ---- */

static double pts_sphere_kernel(double t, double x) {
    double a = 1, b = x, sum = 1 + 3 * exp(-2 * t) * x;
    int l;
    for (l = 1; l < 40; l++) {                   /* Legendre polynomials by their recurrence */
        const double c = ((2 * l + 1) * x * b - l * a) / (l + 1);
        a = b;
        b = c;
        sum += (2 * l + 3) * exp(-(l + 1) * (l + 2) * t) * b;
    }
    return sum / (4 * pts_pi);
}

/* Rayleigh quotients of spherical harmonics and the heat kernel, against the closed forms. The errors are those of the operators at their default
 * bandwidth, of which a third is left as room. scale: exp tends to Laplacian/area. */
static void pts_sphere(hd_laplacian_kind kind, int blue, double tol_value, double tol_kernel) {
    enum { N = 2000 };
    shape s = kit_own_shape(shape_points(N, shape_on_sphere, 4 * pts_pi, blue, 1));
    hd_laplacian *lap = pts_make(s.xyz, N, kind, 0);
    hd_heat *heat = NULL;
    hd_report rep;
    const double scale = kind == HD_LAPLACIAN_EXP ? lap->area : 1, t = 0.15;
    double *x = KIT_NEW(double, N), *y = KIT_NEW(double, N), worst = 0, top = 0;
    int f, i;
    for (f = 0; f < 5; f++) {                    /* x, y, z with eigenvalue 2; xy, x^2 - z^2 with 6 */
        double num = 0, den = 0, lambda;
        for (i = 0; i < N; i++) {
            const double *p = s.xyz + 3 * i;
            x[i] = f < 3 ? p[f] : f == 3 ? p[0] * p[1] : p[0] * p[0] - p[2] * p[2];
        }
        CHECK(hd_laplacian_apply(lap, 1, 0, x, y, NULL) == HD_OK);
        for (i = 0; i < N; i++) {
            num += x[i] * y[i];
            den += lap->mass[i] * x[i] * x[i];
        }
        lambda = num / den * scale;
        CHECK_MSG(fabs(lambda / (f < 3 ? 2 : 6) - 1) < tol_value, "kind %d, blue %d: eigenvalue %g, not %d", kind, blue, lambda, f < 3 ? 2 : 6);
    }
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK && heat_column(heat, t * scale, 17, x, &rep) >= 0);
    for (i = 0; i < N; i++) {
        const double *p = s.xyz + 3 * i, *q = s.xyz + 3 * 17, truth = pts_sphere_kernel(t, p[0] * q[0] + p[1] * q[1] + p[2] * q[2]);
        worst = fmax(worst, fabs(x[i] / (kind == HD_LAPLACIAN_EXP ? lap->area / N : lap->mass[17]) - truth));
        top = fmax(top, truth);
    }
    CHECK_MSG(worst / top < tol_kernel, "kind %d, blue %d: heat kernel off by %g of its largest value", kind, blue, worst / top);
    hd_heat_free(heat);
}

/* ---- tufted: thin parts ---- */

/* Each point makes six triangles or so, which count three times where its neighbours make them too. */
static hd_laplacian *pts_tufted(const double *xyz, int32_t n) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(at_tufted(&lap, xyz, n, NULL, NULL, NULL, &e) == HD_OK, "%s", e.text);
    CHECK_MSG(lap->mesh.n_faces > 3 * n && lap->mesh.n_faces < 9 * n && lap->mesh.n_faces_used <= lap->mesh.n_faces, "%d faces of %d points",
              (int)lap->mesh.n_faces, (int)n);
    return kit_own_laplacian(lap);
}

/* Largest difference of the symmetric kernel's column 0 from want, relative to its largest value. */
static double pts_kernel_error(const hd_laplacian *lap, double t, const double *want) {
    const int32_t source = 0;
    double *u = KIT_NEW(double, lap->n), worst = 0;
    hd_heat *heat = NULL;
    hd_report rep;
    int32_t i;
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, &rep) >= 0);
    for (i = 0; i < lap->n; i++) worst = fmax(worst, fabs(u[i] - want[i]));
    worst /= dense_max_abs(want, lap->n);
    hd_heat_free(heat);
    return worst;
}

/* The unit sphere and one that is some spacings smaller: heat stays on its own. What cannot be told apart is
 * counted. */
static void pts_shells(void) {
    enum { N = 500 };
    static const double gaps[] = {1, 1.5, 2, 3}, origin[3] = {0, 0, 0};
    static const double tol_area[] = {1, 0.02, 0.02, 0.02}, tol_kernel[] = {1, 0.35, 0.06, 0.06};
    const double t = 0.1;
    size_t k;
    for (k = 0; k < 4; k++) {
        shape a = kit_own_shape(shape_points(N, shape_on_sphere, 4 * pts_pi, 1, 3));
        shape b = kit_own_shape(shape_points(N, shape_on_sphere, 4 * pts_pi, 1, 4));
        const double q = 1 - gaps[k] * sqrt(4 * pts_pi / N);
        double *want = KIT_NEW(double, 2 * N), area, worst;    /* zeros on the smaller one */
        shape both;
        hd_laplacian *lap, *cells;
        int32_t i, flagged;
        for (i = 0; i < 3 * N; i++) b.xyz[i] *= q;
        both = kit_own_shape(shape_disjoint(&a, &b, origin));
        for (i = 0; i < N; i++) want[i] = pts_sphere_kernel(t, shape_dot(a.xyz, a.xyz + 3 * i));
        lap = pts_tufted(both.xyz, both.n);
        cells = pts_make(both.xyz, both.n, HD_LAPLACIAN_VORONOI_EXP, 0);
        flagged = lap->points.n_not_flat;
        area = lap->area / (4 * pts_pi * (1 + q * q)) - 1;
        worst = pts_kernel_error(lap, t, want);
        CHECK_MSG(fabs(area) < tol_area[k] && worst < tol_kernel[k],
                  "%g spacings: area %+g, kernel off by %g", gaps[k], area, worst);
        CHECK_MSG(gaps[k] < 1.5 ? flagged > 1.8 * N : gaps[k] < 2 ? flagged > 0.2 * N : flagged == 0,
                  "%g spacings: %d places not flat", gaps[k], (int)flagged);
        CHECK(gaps[k] < 2 || lap->n_components == 2);
        CHECK(cells->points.n_not_flat == flagged);
    }
}

/* An ear: a ball pressed flat, five spacings thick in the middle and none at the rim; as the mesh of the same
 * vertices has it. */
static void pts_ear(void) {
    shape s = kit_own_shape(shape_icosphere(4));
    const double edge = 0.075;
    double *want = KIT_NEW(double, s.n), t, worst;
    uint64_t seed = 6;
    hd_laplacian *mesh = NULL, *lap;
    hd_heat *heat = NULL;
    hd_report rep;
    const int32_t source = 0;
    int32_t i;
    for (i = 0; i < 3 * s.n; i++) s.xyz[i] += 0.2 * edge * shape_signed(&seed);
    for (i = 0; i < s.n; i++) {
        const double len = sqrt(shape_dot(s.xyz + 3 * i, s.xyz + 3 * i));
        s.xyz[3 * i] /= len;
        s.xyz[3 * i + 1] /= len;
        s.xyz[3 * i + 2] *= 0.15 / len;
    }
    CHECK(hd_laplacian_create(&mesh, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), NULL, NULL) == HD_OK);
    t = 0.02 * mesh->area;
    CHECK(hd_heat_create(&heat, mesh, NULL, NULL) == HD_OK);
    CHECK(heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, &source, want, 0, &rep) >= 0);
    lap = pts_tufted(s.xyz, s.n);
    worst = pts_kernel_error(lap, t, want);
    CHECK_MSG(fabs(lap->area / mesh->area - 1) < 0.01 && worst < 0.05, "area %+g, kernel off by %g",
              lap->area / mesh->area - 1, worst);
    CHECK_MSG(lap->points.n_not_flat < s.n / 5, "%d places not flat", (int)lap->points.n_not_flat);
    hd_heat_free(heat);
    hd_laplacian_free(mesh);
}

/* Noise along the normals, of up to half a spacing: triangles follow it no more than they must, and points
 * without noise are flat. */
static void pts_noise(void) {
    enum { N = 2000 };
    const double area = 8 * pts_pi * pts_pi, h = sqrt(area / N);
    static const double most[] = {0.01, 0.035, 0.18};
    int k, c;
    for (k = 0; k < 3; k++) {
        shape s = kit_own_shape(shape_points(N, shape_on_torus, area, 0, 12));
        const double noise[] = {0, 0.2, 0.5};
        uint64_t seed = 5;
        hd_laplacian *lap;
        int32_t i;
        for (i = 0; i < N; i++) {
            double *p = s.xyz + 3 * i, ring = sqrt(p[0] * p[0] + p[1] * p[1]);
            const double off = noise[k] * h * 0.7 * (shape_signed(&seed) + shape_signed(&seed));
            const double normal[3] = {p[0] * (1 - 2 / ring), p[1] * (1 - 2 / ring), p[2]};
            for (c = 0; c < 3; c++) p[c] += off * normal[c];
        }
        lap = pts_tufted(s.xyz, N);
        CHECK_MSG(fabs(lap->area / area - 1) < most[k], "noise %g: area %+g", noise[k], lap->area / area - 1);
        CHECK_MSG(k == 2 ? lap->points.n_not_flat > N / 5 : lap->points.n_not_flat <= 5 * k,
                  "noise %g: %d places not flat", noise[k], (int)lap->points.n_not_flat);
    }
}

/* Points on a line have no plane, and are flat. */
static void pts_line(void) {
    uint64_t seed = 2;
    int k, c;
    for (k = 0; k < 20; k++) {
        double xyz[3 * 40], to[3], u;
        hd_laplacian *lap;
        int32_t i;
        for (c = 0; c < 3; c++) to[c] = shape_signed(&seed);
        for (i = 0; i < 40; i++)
            for (u = shape_uniform(&seed), c = 0; c < 3; c++) xyz[3 * i + c] = u * to[c];
        lap = pts_make(xyz, 40, HD_LAPLACIAN_EXP, 1);
        CHECK(lap->points.n_not_flat == 0);
    }
}

/* ---- memory; used by test_robust.h ---- */

static void test_points(void) {
    pts_nearest();
    pts_neighbour_errors();
    pts_operators();
    pts_areas();
    pts_plane();
    pts_sheets();
    pts_invariance();
    pts_coincident();
    pts_outliers();
    pts_errors();
    pts_threads();
    pts_sphere(HD_LAPLACIAN_VORONOI_EXP, 0, 0.06, 0.14);
    pts_sphere(HD_LAPLACIAN_VORONOI_EXP, 1, 0.03, 0.04);
    pts_sphere(HD_LAPLACIAN_EXP, 0, 0.15, 0.5);
    pts_sphere(HD_LAPLACIAN_EXP, 1, 0.05, 0.13);
    pts_shells();
    pts_ear();
    pts_noise();
    pts_line();
}

#endif
