/* test_operators_all.h - every question on every operator beyond the plain ones of triangles: polygons, points with exponential weights, stars of points,
 * intrinsic triangulations; each against the truth of its own pair (L, B). And what each door to the operators takes */

#ifndef TEST_OPERATORS_ALL_H
#define TEST_OPERATORS_ALL_H

/* For test_lengths.h. */
static shape all_soup(void) { return trial_tangle(); }
static shape all_needles(void) { return trial_needles(2); }

/* ---- queries ---- */

#define ALL_FIELDS " query=apply|times method=auto|direct|krylov|iterative k=2 times=3 span=90 th=0.7|5|60"
#define ALL_COLUMNS " query=column kernel=operator|symmetric method=auto|direct|krylov|iterative k=2 th=0.7|5|60"
#define ALL_ENTRIES " query=entries kernel=operator|symmetric method=auto|direct|krylov|iterative k=24 th=0.7|5"
#define ALL_PAIRS " query=pairs kind=classical|weighted method=auto|direct|krylov|iterative k=24 th=0.7|5"
#define ALL_DIAGONAL " query=diagonal kernel=operator|symmetric method=auto|direct th=0.7|5|40"
#define ALL_DISTANCE " query=distance kind=classical|weighted method=auto|direct k=3 th=0.7|5|10"
#define ALL_TIMELESS " query=pairs|distance kind=commute|biharmonic method=auto|direct k=6"
#define ALL_QUERIES(pairs) \
    {pairs ALL_FIELDS, 5e-7, 0, 0}, {pairs ALL_COLUMNS, 5e-6, 0, 0}, {pairs ALL_ENTRIES, 5e-6, 0, 0}, {pairs ALL_PAIRS, 5e-6, 0, 0}, \
    {pairs ALL_DIAGONAL, 1e-6, 0, 0}, {pairs ALL_DISTANCE, 1e-6, 0, 0}, {pairs ALL_TIMELESS, 1e-8, 0, 0}

static const case_row all_rows[] = {
    ALL_QUERIES("shape=qtorus/8/6 op=poly"),
    ALL_QUERIES("shape=tromino/3/3/0.2 op=poly+half|cot+tuft|fem+id"),
    ALL_QUERIES("shape=cloud/50/0 op=vexp|tuft"),
    ALL_QUERIES("shape=cloud/50/1 op=exp|tuft+vor"),
    ALL_QUERIES("shape=needles/1 op=fem+id"),
    ALL_QUERIES("shape=tangle op=fem+tuft|vor+id"),
};

/* Which operator a door gives, and that methods that do not invert refuse what takes an inverse. */
static void all_operators(void) {
    static const struct { const char *spec; hd_laplacian_kind kind; } rows[] = {
        {"qtorus/8/6 poly", HD_LAPLACIAN_POLYGON}, {"tromino/3/3/0.2 poly+half", HD_LAPLACIAN_POLYGON}, {"tromino/3/3/0.2 cot+tuft", HD_LAPLACIAN_COT},
        {"tromino/3/3/0.2 fem+id", HD_LAPLACIAN_FEM}, {"cloud/50/0 vexp", HD_LAPLACIAN_VORONOI_EXP}, {"cloud/50/1 exp", HD_LAPLACIAN_EXP},
        {"cloud/50/0 tuft", HD_LAPLACIAN_FEM}, {"cloud/50/1 tuft+vor", HD_LAPLACIAN_VORONOI_COT}, {"tangle vor+id", HD_LAPLACIAN_VORONOI_COT}};
    int k, m;
    for (k = 0; k < (int)(sizeof rows / sizeof *rows); k++) {
        const hd_laplacian *lap = kit_pair(rows[k].spec);
        double *D = KIT_NEW(double, lap->n), t = trial_unit(lap);
        const int32_t source = lap->vertex[0];
        CHECK_MSG(lap->kind == rows[k].kind && (lap->B != NULL) == (lap->kind == HD_LAPLACIAN_FEM), "%s: kind %d", rows[k].spec, (int)lap->kind);
        for (m = 0; m < 2; m++) {
            hd_heat *heat = kit_heat(lap, m ? "method=krylov" : "method=iterative");
            CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, NULL) == HD_ERR_ARGUMENT);
            CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, D, 0, NULL) == HD_ERR_ARGUMENT);
        }
    }
}

/* ---- doors between the operators ---- */

static int all_same(const hd_laplacian *a, const hd_laplacian *b) {
    return a->n_active == b->n_active && a->L.nnz == b->L.nnz && a->h == b->h &&
           memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0 &&
           memcmp(a->L.val, b->L.val, (size_t)a->L.nnz * sizeof(double)) == 0 &&
           memcmp(a->mass, b->mass, (size_t)a->n_active * sizeof(double)) == 0 &&
           memcmp(a->vertex, b->vertex, (size_t)a->n_active * sizeof *a->vertex) == 0 && memcmp(&a->mesh, &b->mesh, sizeof a->mesh) == 0;
}

/* The neighbours that are searched are those one would have given, and points in the place of an earlier one have none. */
static void all_neighbours(void) {
    enum { N = 200, K = 12 };
    const shape *s = kit_shape("points/200/1/1");
    int32_t *nbr = KIT_NEW(int32_t, N * (K + 1)), i;
    int64_t *ptr = KIT_NEW(int64_t, N + 2);
    double *twice = KIT_NEW(double, 3 * N + 3);
    hd_laplacian *found = NULL, *given = NULL, *more = NULL;
    hd_laplacian_opts o;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.neighbours = K;
    CHECK(hd_neighbours_nearest(s->xyz, N, NULL, N, K + 1, nbr, NULL, NULL, &e) == HD_OK);
    for (i = 0; i <= N; i++) ptr[i] = (int64_t)i * (K + 1);
    CHECK_MSG(at_tufted(&found, s->xyz, N, NULL, NULL, &o, &e) == HD_OK, "%s", e.text);
    CHECK(at_tufted(&given, s->xyz, N, ptr, nbr, NULL, &e) == HD_OK);
    CHECK(all_same(found, given) && found->points.neighbours == K && found->points.n_coincident == 0 && found->n_active == N);
    memcpy(twice, s->xyz, 3 * 6 * sizeof(double));           /* the sixth once more behind itself */
    memcpy(twice + 3 * 6, s->xyz + 3 * 5, 3 * (N - 5) * sizeof(double));
    CHECK(at_tufted(&more, twice, N + 1, NULL, NULL, &o, &e) == HD_OK);
    CHECK(more->points.n_coincident == 1 && more->mesh.n_inert == 1 && more->row[5] == 5 && more->row[6] == -1 && fabs(more->area / found->area - 1) < 1e-14);
    CHECK(more->L.nnz == found->L.nnz);
    for (i = 0; i < found->L.nnz && i < more->L.nnz; i++)    /* faces may come in another order */
        CHECK(fabs(more->L.val[i] - found->L.val[i]) <= 1e-12 * (1 + fabs(found->L.val[i])));
    hd_laplacian_free(found);
    hd_laplacian_free(given);
    hd_laplacian_free(more);
}

/* Polygons split for an intrinsic triangulation are the triangles of their fans. */
static void all_fans(void) {
    const shape_poly *s = &kit_body("qtorus/9/7")->p;
    int32_t *tri = KIT_NEW(int32_t, 6 * s->n_faces), f;
    hd_laplacian *fans = NULL, *triangles = NULL;
    hd_laplacian_opts o;
    hd_error e;
    uint64_t seed = 21;
    int way;
    for (f = 0; f < 3 * s->n; f++) s->xyz[f] += 0.2 * dense_signed(&seed);
    for (f = 0; f < s->n_faces; f++) {
        static const int fan[6] = {0, 1, 2, 0, 2, 3};
        int k;
        for (k = 0; k < 6; k++) tri[6 * f + k] = s->face_idx[s->face_ptr[f] + fan[k]];
    }
    for (way = 0; way < 2; way++) {
        memset(&o, 0, sizeof o);
        o.triangulation = way ? HD_TRIANGULATION_TUFTED : !way ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
        CHECK(hd_laplacian_create(&fans, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e) == HD_OK &&
            fans->kind == HD_LAPLACIAN_FEM && fans->mesh.n_flips > 0);
        CHECK(hd_laplacian_create(&triangles, MESH_TRIANGLES(s->xyz, s->n, tri, 2 * s->n_faces), &o, &e) == HD_OK && all_same(fans, triangles));
        hd_laplacian_free(fans);
        hd_laplacian_free(triangles);
        o.kind = HD_LAPLACIAN_POLYGON;
        CHECK(hd_laplacian_create(&fans, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e) == HD_ERR_ARGUMENT);
    }
    o.kind = HD_LAPLACIAN_DEFAULT;
    o.mollify = 2;
    CHECK(hd_laplacian_create(&fans, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e) == HD_ERR_ARGUMENT);
}

/* 0 triangles, 1 points, 2 tufted points: the status, and the kind of what comes. */
static hd_status all_door(int door, const shape *s, int32_t n, const hd_laplacian_opts *o, int *kind, hd_error *e) {
    hd_laplacian *lap = NULL;
    const hd_status st = door == 0   ? hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, n, s->tri, s->n_tri), o, e)
                         : door == 1 ? hd_laplacian_create(&lap, MESH_POINTS(s->xyz, n), o, e)
                                     : at_tufted(&lap, s->xyz, n, NULL, NULL, o, e);
    CHECK((st < 0) == (lap == NULL));
    *kind = lap ? (int)lap->kind : -1;
    hd_laplacian_free(lap);
    return st;
}

/* What each door does not take. */
static void all_kinds(void) {
    static const hd_laplacian_kind usual[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_EXP, HD_LAPLACIAN_FEM};
    const shape *s = kit_shape("ico/1");
    hd_laplacian_opts o;
    hd_error e;
    int k, door, kind;
    for (k = HD_LAPLACIAN_DEFAULT; k <= HD_LAPLACIAN_MATRICES + 1; k++)
        for (door = 0; door < 3; door++) {
            const int points = k == HD_LAPLACIAN_VORONOI_EXP || k == HD_LAPLACIAN_EXP, faces = k >= HD_LAPLACIAN_FEM && k <= HD_LAPLACIAN_COT;
            const int taken = k == 0 || (door == 1 ? points : faces);
            memset(&o, 0, sizeof o);
            o.kind = (hd_laplacian_kind)k;
            CHECK_MSG(all_door(door, s, s->n, &o, &kind, &e) == (taken ? HD_OK : HD_ERR_ARGUMENT), "door %d, kind %d: %s", door, k, e.text);
            CHECK(kind == (!taken ? -1 : k ? k : (int)usual[door]));
            o.triangulation = HD_TRIANGULATION_TUFTED;
            if (door == 1) CHECK((all_door(door, s, s->n, &o, &kind, &e) == HD_OK) == (k <= HD_LAPLACIAN_COT));
        }
    memset(&o, 0, sizeof o);
    o.neighbours = 5;
    CHECK(all_door(2, s, s->n, &o, &kind, &e) == HD_ERR_ARGUMENT);
    o.neighbours = 0;
    o.mollify = 2;
    CHECK(all_door(2, s, s->n, &o, &kind, &e) == HD_ERR_ARGUMENT);
    CHECK(all_door(2, s, 0, NULL, &kind, &e) == HD_ERR_EMPTY && all_door(2, s, 2, NULL, &kind, &e) == HD_ERR_EMPTY);
    s->xyz[7] = HUGE_VAL;
    CHECK(all_door(2, s, s->n, NULL, &kind, &e) == HD_ERR_NOT_FINITE && e.vertex == 2);
}

static void all_cases(void) { CASES(all_rows); }

static void test_operators_all(void) {
    all_neighbours();
    all_fans();
    all_kinds();
    all_operators();
    all_cases();
}

#endif
