/* test_operators_all.h - every question on every operator beyond the plain ones of triangles: polygons, points with exponential weights, stars of points,
 * intrinsic triangulations; each against the dense eigensolution of its own pair (L, B) */

#ifndef TEST_OPERATORS_ALL_H
#define TEST_OPERATORS_ALL_H

/* ---- operators ---- */

static hd_laplacian *all_polygons(shape_poly s, hd_laplacian_opts o) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(hd_laplacian_polygons(&lap, s.xyz, s.n, s.face_ptr, s.face_idx, s.n_faces, &o, &e) == HD_OK, "%s", e.text);
    shape_poly_free(&s);
    return lap;
}

static hd_laplacian *all_triangles(shape s, hd_laplacian_opts o) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &e) == HD_OK, "%s", e.text);
    shape_free(&s);
    return lap;
}

static hd_laplacian *all_points(shape s, hd_laplacian_opts o) {
    hd_laplacian *lap = NULL;
    hd_error e;
    const hd_status st = o.tufted ? hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &o, &e) : hd_laplacian_points(&lap, s.xyz, s.n, &o, &e);
    CHECK_MSG(st == HD_OK, "%s", e.text);
    shape_free(&s);
    return lap;
}

/* Two pieces, of which the second has borders and edges of three faces, and a vertex in no face. */
static shape all_soup(void) {
    static const double offset[3] = {9, 1, 0};
    shape a = shape_icosphere(1), b = shape_grid(8, 6, 0.3), s = shape_disjoint(&a, &b, offset);
    int32_t f;
    for (f = a.n_tri; f < s.n_tri; f++) {
        if (s.tri[3 * f] == a.n + 20) s.tri[3 * f] = a.n + 4;
        if (f % 11 == 0) s.tri[3 * f + 1] = a.n + 30;
    }
    s.n--;                                       /* the last corner of the grid: its faces go to its neighbour, and the vertex before is in no face then */
    for (f = 0; f < 3 * s.n_tri; f++)
        if (s.tri[f] >= s.n - 1) s.tri[f] = s.n - 2;
    shape_free(&a);
    shape_free(&b);
    return s;
}

static shape all_needles(void) {
    shape s = shape_bumpy(2, 5);
    int32_t i;
    for (i = 0; i < s.n; i++) s.xyz[3 * i] *= 6;
    return s;
}

/* Points of a sphere of which two are in one place. */
static shape all_cloud(int32_t n, int blue) {
    shape s = shape_points(n, shape_on_sphere, 12.566370614359172, blue, 3);
    memcpy(s.xyz + 3 * (n - 1), s.xyz + 3 * 7, 3 * sizeof(double));
    return s;
}

static const char *const all_names[] = {"polygon, quadrilaterals", "polygon, notches", "voronoi-exp", "exp", "fem, tufted points", "voronoi-cot, tufted points",
                                        "fem, intrinsic", "fem, tufted soup", "voronoi-cot, intrinsic soup", "cot, tufted fans"};

enum { ALL_OPERATORS = sizeof all_names / sizeof *all_names };

static hd_laplacian *all_laplacian(int k) {
    static const hd_laplacian_kind kinds[] = {HD_LAPLACIAN_DEFAULT, HD_LAPLACIAN_POLYGON, HD_LAPLACIAN_DEFAULT, HD_LAPLACIAN_EXP, HD_LAPLACIAN_DEFAULT,
                                              HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_DEFAULT, HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    static const hd_laplacian_kind comes[] = {HD_LAPLACIAN_POLYGON, HD_LAPLACIAN_POLYGON, HD_LAPLACIAN_VORONOI_EXP, HD_LAPLACIAN_EXP, HD_LAPLACIAN_FEM,
                                              HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_FEM, HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    hd_laplacian_opts o;
    hd_laplacian *lap;
    memset(&o, 0, sizeof o);
    o.kind = kinds[k];
    o.tufted = k == 4 || k == 5 || k == 7 || k == 9;
    o.intrinsic_delaunay = k == 6 || k == 8;
    o.lambda = k == 1 ? 0.5 : 0;
    if (k == 0) lap = all_polygons(shape_quad_torus(12, 8, 2, 0.8), o);
    else if (k == 1) lap = all_polygons(shape_trominoes(4, 4, 0.2), o);
    else if (k == 9) lap = all_polygons(shape_trominoes(3, 4, 0.2), o);
    else if (k < 6) lap = all_points(all_cloud(k < 4 ? 90 : 130, k % 2), o);
    else lap = all_triangles(k == 6 ? all_needles() : all_soup(), o);
    CHECK_MSG(lap->kind == comes[k] && (lap->B != NULL) == (lap->kind == HD_LAPLACIAN_FEM), "%s: kind %d", all_names[k], (int)lap->kind);
    return lap;
}

/* t = 1 in numbers of steps from point to point; with B = I masses are 1 instead of areas. */
static double all_unit(const hd_laplacian *lap) {
    return lap->kind == HD_LAPLACIAN_COT ? 1 : lap->kind == HD_LAPLACIAN_EXP ? lap->area * lap->h * lap->h : lap->h * lap->h;
}

/* ---- columns and fields, by every method ---- */

static void all_heat(const heat_case *c, hd_method method) {
    const hd_laplacian *lap = c->lap;
    const double unit = all_unit(lap), times[3] = {60 * unit, 0.7 * unit, 5 * unit};
    const int32_t n = lap->n, source = lap->vertex[lap->n_active / 2];
    hd_heat *heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
    double *U = DENSE_NEW(double, 3 * n), *rhs = DENSE_NEW(double, lap->n_active);
    hd_report rep;
    int m, k;
    for (m = 0; m < 3; m++) heat_against_dense(c, heat, times[m]);
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        heat_source_rhs(c, source, kernel, rhs);
        CHECK_MSG(heat_times(heat, 3, times, kernel, source, NULL, U, 0, &rep) >= 0, "%s: %s", c->what, rep.error.text);
        CHECK(rep.error_bound_b < 1e-6 && (method == HD_METHOD_AUTO || rep.method == method));
        for (m = 0; m < 3; m++) heat_judge(c, times[m], rhs, U + (size_t)m * (size_t)n, &rep);
    }
    hd_heat_free(heat);
    free(U);
    free(rhs);
}

/* ---- what selected inversion answers ---- */

static double all_at(const double *H, const hd_laplacian *lap, int32_t v, int32_t w) {
    const int32_t i = lap->row[v], j = lap->row[w];
    return i < 0 || j < 0 ? 0 : H[(size_t)i * (size_t)lap->n_active + (size_t)j];
}

/* The distance of vertices v, w by H; infinite between components for those without a time. */
static double all_distance(const double *H, const hd_laplacian *lap, hd_distance_kind kind, int32_t v, int32_t w) {
    const int32_t i = lap->row[v], j = lap->row[w];
    if (v == w) return 0;
    if (kind >= HD_DISTANCE_COMMUTE && (i < 0 || j < 0 || lap->component[i] != lap->component[j])) return HUGE_VAL;
    return sqrt(fmax(0, all_at(H, lap, v, v) - 2 * all_at(H, lap, v, w) + all_at(H, lap, w, w)));
}

static double all_slack(const heat_case *c, hd_distance_kind kind, double t) { return kind >= HD_DISTANCE_COMMUTE ? 1e-11 : diag_slack(c, t); }

/* How far d is off, beyond what the oracle may be: a difference of numbers of this size. */
static double all_off(double d, double want, double size) {
    if (want == HUGE_VAL || d == HUGE_VAL) return d == want ? 0 : HUGE_VAL;
    return fmax(0, fabs(d - want) - fmin(sqrt(size), want > 0 ? size / want : HUGE_VAL));
}

static double all_largest(const double *H, int32_t n) {
    double most = 0;
    int32_t i;
    for (i = 0; i < n; i++) most = fmax(most, H[(size_t)i * (size_t)n + (size_t)i]);
    return most;
}

static void all_diagonal(const heat_case *c, hd_heat *heat, double t) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n_active;
    double *K = diag_kernel(c, t), *KB = diag_product(K, c->pair.B, n), *D = DENSE_NEW(double, lap->n), *E = DENSE_NEW(double, lap->L.nnz), off, size;
    const double slack = diag_slack(c, t);
    hd_report rep;
    int64_t p;
    int32_t v;
    int q;
    for (q = 0; q < 2; q++) {
        CHECK_MSG(heat_diagonal(heat, 1, &t, q ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, D, 0, &rep) >= 0, "%s: %s", c->what, rep.error.text);
        for (v = 0, off = size = 0; v < lap->n; v++) {
            const double want = lap->row[v] < 0 ? !q : all_at(q ? K : KB, lap, v, v);
            off = fmax(off, fabs(D[v] - want));
            size = fmax(size, fabs(want));
        }
        CHECK_MSG(off <= (rep.error_bound + slack) * size && off <= (1e-6 + slack) * size, "%s, t %g: the diagonal is off by %g, bound %g", c->what, t, off / size, rep.error_bound);
    }
    CHECK_MSG(heat_edges(heat, t, E, &rep) >= 0, "%s: %s", c->what, rep.error.text);
    for (v = 0, off = size = 0; v < n; v++)
        for (p = lap->L.row_ptr[v]; p < lap->L.row_ptr[v + 1]; p++) {
            const double want = K[(size_t)v * (size_t)n + (size_t)lap->L.col[p]];
            off = fmax(off, fabs(E[p] - want));
            size = fmax(size, fabs(want));
        }
    CHECK_MSG(off <= (rep.error_bound + slack) * size && off <= (1e-6 + slack) * size, "%s, t %g: edges are off by %g, bound %g", c->what, t, off / size, rep.error_bound);
    free(K);
    free(KB);
    free(D);
    free(E);
}

static void all_distances(const heat_case *c, hd_heat *heat, hd_distance_kind kind, double t) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, sources[3] = {lap->vertex[0], lap->vertex[lap->n_active - 1], lap->row[n - 1] < 0 ? n - 1 : n / 2};
    double *H = diag_gram(c, kind, t), *D = DENSE_NEW(double, 3 * n);
    const double noise = all_slack(c, kind, t) * all_largest(H, lap->n_active);
    hd_report rep;
    int32_t v;
    int s;
    CHECK_MSG(heat_distance(heat, kind, 1, &t, 3, sources, D, 0, &rep) >= 0, "%s, distance %d: %s", c->what, (int)kind, rep.error.text);
    for (s = 0; s < 3; s++) {
        double off = 0, size = 0;
        for (v = 0; v < n; v++) {
            const double want = all_distance(H, lap, kind, sources[s], v);
            const double diff = all_off(D[(size_t)s * (size_t)n + (size_t)v], want, noise);
            if (!(diff <= off)) off = diff;
            if (want < HUGE_VAL) size = fmax(size, want);
        }
        CHECK_MSG(off <= rep.error_bound * size && off <= 1e-6 * size, "%s, distance %d from %d, t %g: off by %g, bound %g", c->what, (int)kind, (int)sources[s], t,
                  off / size, rep.error_bound);
    }
    free(H);
    free(D);
}

/* Pairs: far and near, equal, of different components, without mass. */
static void all_pairs(const heat_case *c, hd_heat *heat, hd_distance_kind kind, double t) {
    enum { PAIRS = 24 };
    const hd_laplacian *lap = c->lap;
    double *H = diag_gram(c, kind, t), *K = diag_kernel(c, t), *KB = diag_product(K, c->pair.B, lap->n_active), k[PAIRS], d[PAIRS], off = 0, off_k = 0, size = 0, size_k = 0;
    const double noise = all_slack(c, kind, t) * all_largest(H, lap->n_active);
    int32_t i[PAIRS], j[PAIRS], q;
    uint64_t seed = 9;
    hd_report rep;
    for (q = 0; q < PAIRS; q++) {
        i[q] = q < 4 ? lap->n - 1 : (int32_t)(dense_random(&seed) % (uint64_t)lap->n);
        j[q] = q == 0 ? i[q] : q < 8 ? lap->vertex[q] : (int32_t)(dense_random(&seed) % (uint64_t)lap->n);
        k[q] = -7;
    }
    CHECK_MSG(heat_pairs(heat, kind, t, PAIRS, i, j, k, d, &rep) >= 0, "%s, pairs %d: %s", c->what, (int)kind, rep.error.text);
    for (q = 0; q < PAIRS; q++) {
        const double want = all_distance(H, lap, kind, i[q], j[q]), want_k = i[q] == j[q] && lap->row[i[q]] < 0 ? 1 : all_at(KB, lap, i[q], j[q]);
        const double diff = all_off(d[q], want, noise);
        if (!(diff <= off)) off = diff;
        if (want < HUGE_VAL) size = fmax(size, want);
        if (kind >= HD_DISTANCE_COMMUTE) CHECK(k[q] == -7);
        else if (!(fabs(k[q] - want_k) <= off_k)) off_k = fabs(k[q] - want_k);
        size_k = fmax(size_k, fabs(want_k));
    }
    CHECK_MSG(off <= 1e-6 * size, "%s, pairs %d, t %g: d is off by %g", c->what, (int)kind, t, off / size);
    CHECK_MSG(off_k <= (1e-6 + diag_slack(c, t)) * size_k, "%s, pairs %d, t %g: K is off by %g", c->what, (int)kind, t, off_k / size_k);
    free(H);
    free(K);
    free(KB);
}

/* Each point is the farthest from those before it, as far as told. */
static void all_samples(const heat_case *c, hd_heat *heat, hd_distance_kind kind, double t) {
    enum { COUNT = 7 };
    const hd_laplacian *lap = c->lap;
    double *H = diag_gram(c, kind, t), distance[COUNT], size = sqrt(2 * all_largest(H, lap->n_active));
    int32_t vertex[COUNT], q, p, v;
    hd_report rep;
    vertex[0] = lap->vertex[1];
    CHECK_MSG(heat_sample(heat, kind, t, COUNT, 1, vertex, distance, &rep) >= 0, "%s, sample %d: %s", c->what, (int)kind, rep.error.text);
    for (q = 1; q < COUNT; q++) {
        double farthest = 0, own = HUGE_VAL;
        for (p = 0; p < q; p++) own = fmin(own, all_distance(H, lap, kind, vertex[p], vertex[q]));
        for (v = 0; v < lap->n; v++) {
            double nearest = lap->row[v] < 0 ? 0 : HUGE_VAL;
            for (p = 0; p < q; p++) nearest = fmin(nearest, all_distance(H, lap, kind, vertex[p], v));
            farthest = fmax(farthest, nearest);
        }
        CHECK_MSG(lap->row[vertex[q]] >= 0 && (own == farthest || own >= farthest - 1e-6 * size), "%s, sample %d: point %d at %g, not %g", c->what, (int)kind, (int)q, own, farthest);
        CHECK_MSG(own == distance[q] || fabs(own - distance[q]) <= 1e-6 * size, "%s, sample %d: distance %g, not %g", c->what, (int)kind, distance[q], own);
    }
    free(H);
}

static void all_inversions(const heat_case *c, hd_method method) {
    const double unit = all_unit(c->lap), times[3] = {0.7 * unit, 5 * unit, 40 * unit};
    hd_heat *heat = eng_plan(c->lap, method, HD_POLES_DEFAULT, 0);
    int m, kind;
    for (m = 0; m < 3; m++) all_diagonal(c, heat, times[m]);
    for (kind = 0; kind < 4; kind++) {
        for (m = 0; m < (kind < 2 ? 2 : 1); m++) {
            all_distances(c, heat, (hd_distance_kind)kind, times[m]);
            all_pairs(c, heat, (hd_distance_kind)kind, times[m]);
        }
        all_samples(c, heat, (hd_distance_kind)kind, times[1]);
    }
    hd_heat_free(heat);
}

/* Methods that do not invert answer pairs by columns, and refuse the rest. */
static void all_refusals(const heat_case *c, hd_method method) {
    const double t = 5 * all_unit(c->lap);
    const int32_t source = c->lap->vertex[0];
    hd_heat *heat = eng_plan(c->lap, method, HD_POLES_DEFAULT, 0);
    double *D = DENSE_NEW(double, c->lap->n);
    all_pairs(c, heat, HD_DISTANCE_CLASSICAL, t);
    all_pairs(c, heat, HD_DISTANCE_WEIGHTED, t);
    CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, NULL) == HD_ERR_ARGUMENT);
    CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, D, 0, NULL) == HD_ERR_ARGUMENT);
    hd_heat_free(heat);
    free(D);
}

/* ---- doors between the operators ---- */

static int all_same(const hd_laplacian *a, const hd_laplacian *b) {
    return a->n_active == b->n_active && a->L.nnz == b->L.nnz && a->h == b->h && memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0 &&
           memcmp(a->L.val, b->L.val, (size_t)a->L.nnz * sizeof(double)) == 0 && memcmp(a->mass, b->mass, (size_t)a->n_active * sizeof(double)) == 0 &&
           memcmp(a->vertex, b->vertex, (size_t)a->n_active * sizeof *a->vertex) == 0 && memcmp(&a->mesh, &b->mesh, sizeof a->mesh) == 0;
}

/* The neighbours that are searched are those one would have given, and points in the place of an earlier one have none. */
static void all_neighbours(void) {
    enum { N = 200, K = 12 };
    shape s = shape_points(N, shape_on_torus, 78.95683520871486, 1, 8);
    int32_t *nbr = DENSE_NEW(int32_t, N * (K + 1));
    int64_t *ptr = DENSE_NEW(int64_t, N + 2);
    double *twice = DENSE_NEW(double, 3 * N + 3);
    hd_laplacian *found = NULL, *given = NULL, *more = NULL;
    hd_laplacian_opts o;
    hd_error e;
    int32_t i;
    memset(&o, 0, sizeof o);
    o.neighbours = K;
    CHECK(hd_neighbours_nearest(s.xyz, N, NULL, N, K + 1, nbr, NULL, NULL, &e) == HD_OK);
    for (i = 0; i <= N; i++) ptr[i] = (int64_t)i * (K + 1);
    CHECK_MSG(hd_laplacian_tufted_points(&found, s.xyz, N, NULL, NULL, &o, &e) == HD_OK, "%s", e.text);
    CHECK(hd_laplacian_tufted_points(&given, s.xyz, N, ptr, nbr, &o, &e) == HD_OK);
    CHECK(all_same(found, given) && found->points.neighbours == K && found->points.n_coincident == 0 && found->n_active == N);
    memcpy(twice, s.xyz, 3 * 6 * sizeof(double));            /* the sixth once more behind itself */
    memcpy(twice + 3 * 6, s.xyz + 3 * 5, 3 * (N - 5) * sizeof(double));
    CHECK(hd_laplacian_tufted_points(&more, twice, N + 1, NULL, NULL, &o, &e) == HD_OK);
    CHECK(more->points.n_coincident == 1 && more->mesh.n_inert == 1 && more->row[5] == 5 && more->row[6] == -1 && more->area == found->area);
    CHECK(memcmp(more->L.val, found->L.val, (size_t)found->L.nnz * sizeof(double)) == 0 && more->L.nnz == found->L.nnz);
    hd_laplacian_free(found);
    hd_laplacian_free(given);
    hd_laplacian_free(more);
    shape_free(&s);
    free(nbr);
    free(ptr);
    free(twice);
}

/* Polygons split for an intrinsic triangulation are the triangles of their fans. */
static void all_fans(void) {
    shape_poly s = shape_quad_torus(9, 7, 2, 0.9);
    int32_t *tri = DENSE_NEW(int32_t, 6 * s.n_faces), f;
    hd_laplacian *fans = NULL, *triangles = NULL;
    hd_laplacian_opts o;
    hd_error e;
    uint64_t seed = 21;
    int way;
    for (f = 0; f < 3 * s.n; f++) s.xyz[f] += 0.2 * dense_signed(&seed);
    for (f = 0; f < s.n_faces; f++) {
        const int32_t *v = s.face_idx + s.face_ptr[f];
        tri[6 * f] = tri[6 * f + 3] = v[0];
        tri[6 * f + 1] = v[1];
        tri[6 * f + 2] = tri[6 * f + 4] = v[2];
        tri[6 * f + 5] = v[3];
    }
    for (way = 0; way < 2; way++) {
        memset(&o, 0, sizeof o);
        o.tufted = way;
        o.intrinsic_delaunay = !way;
        CHECK(hd_laplacian_polygons(&fans, s.xyz, s.n, s.face_ptr, s.face_idx, s.n_faces, &o, &e) == HD_OK && fans->kind == HD_LAPLACIAN_FEM && fans->mesh.n_flips > 0);
        CHECK(hd_laplacian_triangles(&triangles, s.xyz, s.n, tri, 2 * s.n_faces, &o, &e) == HD_OK && all_same(fans, triangles));
        o.kind = HD_LAPLACIAN_POLYGON;
        CHECK(hd_laplacian_polygons(&fans, s.xyz, s.n, s.face_ptr, s.face_idx, s.n_faces, &o, &e) == HD_ERR_ARGUMENT);
        hd_laplacian_free(fans);
        hd_laplacian_free(triangles);
    }
    o.kind = HD_LAPLACIAN_DEFAULT;
    o.mollify = 2;
    CHECK(hd_laplacian_polygons(&fans, s.xyz, s.n, s.face_ptr, s.face_idx, s.n_faces, &o, &e) == HD_ERR_ARGUMENT);
    shape_poly_free(&s);
    free(tri);
}

/* What each door does not take. */
static void all_kinds(void) {
    shape s = shape_icosphere(1);
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_error e;
    int k;
    for (k = HD_LAPLACIAN_DEFAULT; k <= HD_LAPLACIAN_MATRICES + 1; k++) {
        const int triangles = k >= HD_LAPLACIAN_FEM && k <= HD_LAPLACIAN_COT, exponential = k == HD_LAPLACIAN_VORONOI_EXP || k == HD_LAPLACIAN_EXP;
        memset(&o, 0, sizeof o);
        o.kind = (hd_laplacian_kind)k;
        CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &e) == (k == 0 || triangles ? HD_OK : HD_ERR_ARGUMENT));
        if (e.status == HD_OK) {
            CHECK((int)lap->kind == (k ? k : HD_LAPLACIAN_FEM));
            hd_laplacian_free(lap);
        }
        CHECK(hd_laplacian_points(&lap, s.xyz, s.n, &o, &e) == (k == 0 || exponential ? HD_OK : HD_ERR_ARGUMENT));
        if (e.status == HD_OK) {
            CHECK((int)lap->kind == (k ? k : HD_LAPLACIAN_VORONOI_EXP));
            hd_laplacian_free(lap);
        }
        CHECK(hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &o, &e) == (k == 0 || triangles ? HD_OK : HD_ERR_ARGUMENT));
        if (e.status == HD_OK) {
            CHECK((int)lap->kind == (k ? k : HD_LAPLACIAN_FEM));
            hd_laplacian_free(lap);
        }
        o.tufted = 1;
        CHECK(hd_laplacian_points(&lap, s.xyz, s.n, &o, &e) == HD_ERR_ARGUMENT);
    }
    memset(&o, 0, sizeof o);
    o.neighbours = 5;
    CHECK(hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &o, &e) == HD_ERR_ARGUMENT);
    o.neighbours = 0;
    o.mollify = 2;
    CHECK(hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &o, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_tufted_points(&lap, s.xyz, 0, NULL, NULL, NULL, &e) == HD_ERR_EMPTY && hd_laplacian_tufted_points(&lap, s.xyz, 2, NULL, NULL, NULL, &e) == HD_ERR_EMPTY);
    s.xyz[7] = HUGE_VAL;
    CHECK(hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, NULL, &e) == HD_ERR_NOT_FINITE && e.vertex == 2);
    shape_free(&s);
}

static void test_operators_all(void) {
    static const hd_method methods[4] = {HD_METHOD_AUTO, HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    int k, m;
    all_neighbours();
    all_fans();
    all_kinds();
    for (k = 0; k < ALL_OPERATORS; k++) {
        heat_case c = heat_case_of(all_laplacian(k), all_names[k]);
        for (m = 0; m < 4; m++) {
            all_heat(&c, methods[m]);
            if (m < 2) all_inversions(&c, methods[m]);
            else all_refusals(&c, methods[m]);
        }
        heat_case_free(&c);
    }
}

#endif
