/* Meshes that move: an updated Laplacian and the plans on it are as good as new ones. */

/* The shape bent and stretched, vertex by vertex. */
static void mov_bend(const shape *s, double how, double *xyz) {
    int32_t i;
    for (i = 0; i < s->n; i++) {
        const double *p = s->xyz + 3 * i;
        xyz[3 * i] = p[0] * (1 + 0.3 * how) + 0.1 * how * sin(3 * p[1]);
        xyz[3 * i + 1] = p[1] + 0.2 * how * p[0] * p[0];
        xyz[3 * i + 2] = p[2] - 0.4 * how * cos(2 * p[0] + p[1]);
    }
}

/* All that a Laplacian says besides L and B. */
static void mov_same_report(const hd_laplacian *a, const hd_laplacian *b, const char *what) {
    int32_t i;
    CHECK_MSG(dense_max_diff(a->mass, b->mass, b->n_active) <= 1e-14 * dense_max_abs(b->mass, b->n_active), "%s: masses", what);
    CHECK_MSG(dense_max_diff(a->b_diag, b->b_diag, b->n_active) <= 1e-14 * dense_max_abs(b->mass, b->n_active), "%s: diag(B)", what);
    CHECK_MSG(a->n_components == b->n_components && memcmp(a->component, b->component, (size_t)b->n_active * sizeof(int32_t)) == 0 &&
              a->conserves == b->conserves, "%s: %d components, not %d", what, a->n_components, b->n_components);
    for (i = 0; i < b->n_components; i++)        /* infinite where heat is lost */
        CHECK_MSG(a->component_mass[i] == b->component_mass[i] || fabs(a->component_mass[i] - b->component_mass[i]) <= 1e-13 * (b->area + b->n), "%s: components", what);
    CHECK_MSG(fabs(a->area - b->area) <= 1e-13 * b->area && fabs(a->h - b->h) <= 1e-13 * b->h, "%s: area or h", what);
    CHECK_MSG(memcmp(a->xyz, b->xyz, 3 * (size_t)b->n_active * sizeof(double)) == 0, "%s: places", what);
    CHECK_MSG(a->mesh.n_faces_used == b->mesh.n_faces_used && a->mesh.n_zero_area == b->mesh.n_zero_area &&
              a->mesh.n_negative_weights == b->mesh.n_negative_weights && a->mesh.n_edges == b->mesh.n_edges &&
              a->mesh.n_boundary_edges == b->mesh.n_boundary_edges && a->mesh.n_nonmanifold_edges == b->mesh.n_nonmanifold_edges &&
              a->mesh.n_misoriented_edges == b->mesh.n_misoriented_edges && a->mesh.n_boundary_loops == b->mesh.n_boundary_loops &&
              fabs(a->mesh.smallest_angle - b->mesh.smallest_angle) <= 1e-12, "%s: report", what);
}

/* L and B are symmetric to the last bit. */
static void mov_symmetric(const hd_laplacian *lap, const char *what) {
    int32_t i;
    int64_t p, q, wrong = 0;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int32_t j = lap->L.col[p];
            for (q = lap->L.row_ptr[j]; q < lap->L.row_ptr[j + 1] && lap->L.col[q] < i; q++) {}
            wrong += q == lap->L.row_ptr[j + 1] || lap->L.col[q] != i || memcmp(lap->L.val + p, lap->L.val + q, sizeof(double)) ||
                     (lap->B && memcmp(lap->B + p, lap->B + q, sizeof(double)));
        }
    CHECK_MSG(wrong == 0, "%s: %d entries are not symmetric", what, (int)wrong);
}

/* The same bits as a new one. */
static void mov_same_bits(const hd_laplacian *a, const hd_laplacian *b, const char *what) {
    const size_t nnz = (size_t)b->L.nnz * sizeof(double), n = (size_t)b->n_active * sizeof(double);
    if (!CHECK_MSG(a->n_active == b->n_active && a->L.nnz == b->L.nnz && memcmp(a->L.col, b->L.col, (size_t)b->L.nnz * sizeof(int32_t)) == 0,
                   "%s: another pattern", what)) return;
    CHECK_MSG(memcmp(a->L.val, b->L.val, nnz) == 0, "%s: L", what);
    CHECK_MSG(!a->B == !b->B && (!b->B || memcmp(a->B, b->B, nnz) == 0), "%s: B", what);
    CHECK_MSG(memcmp(a->mass, b->mass, n) == 0 && memcmp(a->b_diag, b->b_diag, n) == 0, "%s: masses", what);
    CHECK_MSG(memcmp(a->component_mass, b->component_mass, (size_t)b->n_components * sizeof(double)) == 0, "%s: components", what);
    CHECK_MSG(a->area == b->area && a->h == b->h && a->b_ratio == b->b_ratio && a->conserves == b->conserves, "%s: area, h, ratio or conservation", what);
    CHECK_MSG(memcmp(&a->mesh, &b->mesh, sizeof a->mesh) == 0, "%s: report", what);
    mov_symmetric(a, what);
    CHECK_MSG(!b->xyz || memcmp(a->xyz, b->xyz, 3 * n) == 0, "%s: places", what);
}

/* Every frame: the Laplacian, and columns, a diagonal and distances of plans that have been used before. */
static void mov_frames(const shape *s, hd_laplacian_kind kind, const char *what) {
    /* the fourth plan has diagonals and distances only: a query of another kind would make factors anew anyway */
    static const hd_method methods[4] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT};
    double *xyz = KIT_NEW(double, 3 * s->n), *u = KIT_NEW(double, s->n), *want = KIT_NEW(double, s->n);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian *lap = test_laplacian_at(s, s->xyz, kind, 1, &ctx), *fresh;
    hd_heat *plan[4], *other;
    const double h2 = lap->h * lap->h;
    int k, frame;
    int32_t i;
    for (k = 0; k < 4; k++) {
        const hd_heat_opts o = eng_opts(methods[k]);
        plan[k] = eng_create(lap, &o);
    }
    for (frame = 0; frame < 4; frame++) {
        int64_t calls;
        hd_error e;
        mov_bend(s, 0.3 * frame, xyz);
        calls = m.calls;
        CHECK_MSG(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_OK, "%s: %s", what, e.text);
        CHECK_MSG(m.calls == calls && lap->version == frame + 1, "%s: the update allocates", what);
        fresh = test_laplacian_at(s, xyz, kind, 0, NULL);
        mov_same_bits(lap, fresh, what);
        for (k = 0; k < 3; k++) {
            const hd_heat_opts o = eng_opts(methods[k]);
            const int32_t source = lap->vertex[(frame * 37) % lap->n_active];
            const double t = frame == 3 ? 1e9 * h2 : 20 * h2;   /* the same: nothing of the last frame may serve again */
            hd_report rep, rep2;
            other = eng_create(fresh, &o);
            CHECK(eng_ok(heat_column(plan[k], t, source, u, &rep), &rep, what) && eng_ok(heat_column(other, t, source, want, &rep2), &rep2, what));
            CHECK_MSG(dense_max_diff(u, want, s->n) <= (rep.error_bound + rep2.error_bound) * dense_max_abs(want, s->n),
                      "%s: frame %d, %s: off by %g", what, frame, eng_name(methods[k]), dense_max_diff(u, want, s->n));
            CHECK_MSG(rep.error_bound <= 1e-5, "%s: frame %d, %s: bound %g", what, frame, eng_name(methods[k]), rep.error_bound);
            if (k == 0) {
                CHECK(eng_ok(heat_diagonal(plan[3], 1, &t, HD_KERNEL_SYMMETRIC, u, 0, &rep), &rep, what));
                CHECK(eng_ok(heat_diagonal(other, 1, &t, HD_KERNEL_SYMMETRIC, want, 0, &rep2), &rep2, what));
                CHECK_MSG(dense_max_diff(u, want, s->n) <= (rep.error_bound + rep2.error_bound) * dense_max_abs(want, s->n), "%s: diagonal", what);
                CHECK(eng_ok(heat_distance(plan[3], HD_DISTANCE_COMMUTE, 1, &t, 1, &source, u, 0, &rep), &rep, what));
                CHECK(eng_ok(heat_distance(other, HD_DISTANCE_COMMUTE, 1, &t, 1, &source, want, 0, &rep2), &rep2, what));
                for (i = 0; i < s->n; i++) CHECK(u[i] == want[i] || fabs(u[i] - want[i]) <= 1e-9 * want[i]);
            }
            hd_heat_free(other);
        }
        hd_laplacian_free(fresh);
    }
    for (k = 0; k < 4; k++) hd_heat_free(plan[k]);
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, what);
}

/* What cannot be taken leaves everything as it was. */
static void mov_errors(void) {
    shape s = kit_own_shape(shape_grid(6, 5, 0));
    double *xyz = KIT_NEW(double, 3 * s.n), *before;
    hd_laplacian *lap = kit_own_laplacian(test_laplacian_at(&s, s.xyz, HD_LAPLACIAN_FEM, 1, NULL)), *plain = kit_own_laplacian(test_laplacian_at(&s, s.xyz, HD_LAPLACIAN_FEM, 0, NULL));
    hd_laplacian_opts o;
    hd_laplacian *none = NULL;
    hd_error e;
    int32_t i;
    before = KIT_NEW(double, lap->L.nnz);
    memcpy(before, lap->L.val, (size_t)lap->L.nnz * sizeof *before);
    memcpy(xyz, s.xyz, 3 * (size_t)s.n * sizeof *xyz);
    xyz[7] = NAN;
    CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_ERR_NOT_FINITE && e.vertex == 2);
    for (i = 0; i < 3 * s.n; i++) xyz[i] = 1;
    CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_ERR_EMPTY && e.vertex == lap->vertex[0]);
    for (i = 0; i < 3 * s.n; i++) xyz[i] = 1e90 * s.xyz[i];
    CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_ERR_ARGUMENT && e.face >= 0);
    CHECK(hd_laplacian_update(plain, MESH_POINTS(s.xyz, plain->n), &e) == HD_ERR_ARGUMENT && hd_laplacian_update(NULL, MESH_POINTS(s.xyz, 0), &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(NULL, lap->n), &e) == HD_ERR_ARGUMENT);
    CHECK(lap->version == 0 && memcmp(before, lap->L.val, (size_t)lap->L.nnz * sizeof *before) == 0);
    memset(&o, 0, sizeof o);
    o.updatable = o.triangulation = HD_TRIANGULATION_TUFTED;
    CHECK(hd_laplacian_create(&none, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e) == HD_ERR_ARGUMENT && none == NULL);
    /* one face of many loses its area */
    memcpy(xyz, s.xyz, 3 * (size_t)s.n * sizeof *xyz);
    memcpy(xyz + 3 * s.tri[0], s.xyz + 3 * s.tri[1], 3 * sizeof *xyz);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_OK && lap->mesh.n_zero_area >= 1 && lap->mesh.n_faces_used + lap->mesh.n_zero_area == s.n_tri);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(s.xyz, lap->n), &e) == HD_OK && memcmp(before, lap->L.val, (size_t)lap->L.nnz * sizeof *before) == 0 && lap->mesh.n_zero_area == 0);
}

/* Geodesic distances of a plan that moves with the mesh. */
static void mov_geodesic(const shape *s, const char *what) {
    double *xyz = KIT_NEW(double, 3 * s->n), *d = KIT_NEW(double, s->n), *want = KIT_NEW(double, s->n);
    const int32_t source = s->tri[0];
    hd_geodesic_opts o;
    hd_geodesic *plan = NULL, *fresh = NULL;
    hd_geodesic_report rep, rep2;
    hd_error e;
    int32_t i;
    int frame;
    memset(&o, 0, sizeof o);
    CHECK(hd_geodesic_create(&fresh, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e) == HD_OK);
    CHECK(hd_geodesic_update(fresh, MESH_POINTS(s->xyz, s->n), &e) == HD_ERR_ARGUMENT && hd_geodesic_update(NULL, MESH_POINTS(s->xyz, s->n), &e) == HD_ERR_ARGUMENT);
    hd_geodesic_free(fresh);
    o.updatable = 1;
    CHECK(hd_geodesic_create(&plan, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e) == HD_OK);
    for (frame = 1; frame < 4; frame++) {
        mov_bend(s, 0.3 * frame, xyz);
        CHECK_MSG(hd_geodesic_update(plan, MESH_POINTS(xyz, s->n), &e) == HD_OK, "%s: %s", what, e.text);
        o.updatable = 0;
        CHECK(hd_geodesic_create(&fresh, MESH_TRIANGLES(xyz, s->n, s->tri, s->n_tri), &o, &e) == HD_OK);
        CHECK(hd_geodesic_distance(plan, VERTICES(1, &source), d, 0, &rep, NULL) == HD_OK &&
            hd_geodesic_distance(fresh, VERTICES(1, &source), want, 0, &rep2, NULL) == HD_OK);
        CHECK(fabs(rep.h - rep2.h) <= 1e-13 * rep2.h && fabs(rep.t - rep2.t) <= 1e-13 * rep2.t && rep.residual_distance < 1e-9);
        for (i = 0; i < s->n; i++)
            CHECK_MSG(d[i] == want[i] || fabs(d[i] - want[i]) <= 1e-9 * dense_max_abs(xyz, 3 * s->n), "%s: frame %d: %g for %g", what, frame, d[i], want[i]);
        hd_geodesic_free(fresh);
    }
    memcpy(want, d, (size_t)s->n * sizeof *d);
    memcpy(xyz, s->xyz, 3 * (size_t)s->n * sizeof *xyz);
    memcpy(xyz + 3 * s->tri[0], s->xyz + 3 * s->tri[1], 3 * sizeof *xyz);
    CHECK(hd_geodesic_update(plan, MESH_POINTS(xyz, s->n), &e) == HD_ERR_EMPTY && (e.face >= 0 || e.vertex >= 0));
    CHECK(hd_geodesic_distance(plan, VERTICES(1, &source), d, 0, &rep, NULL) == HD_OK &&
        memcmp(d, want, (size_t)s->n * sizeof *d) == 0);   /* as it was */
    hd_geodesic_free(plan);
}

/* ---- polygons and matrices ---- */

static hd_laplacian *mov_polygons(const shape_poly *s, const double *xyz, hd_laplacian_kind kind, int updatable, hd_context *ctx) {
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.updatable = updatable;
    o.context = ctx;
    CHECK_MSG(hd_laplacian_create(&lap, MESH_POLYGONS(xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e) == HD_OK, "%s", e.text);
    return lap;
}

/* A column by a plan that moved, against that of a new plan: the same bits, as the pairs are. */
static void mov_same_column(hd_heat *plan, const hd_laplacian *fresh, hd_method method, double t, const char *what) {
    double *u = KIT_NEW(double, fresh->n), *want = KIT_NEW(double, fresh->n);
    const hd_heat_opts o = eng_opts(method);
    hd_heat *other = eng_create(fresh, &o);
    hd_report rep;
    CHECK(eng_ok(heat_column(plan, t, fresh->vertex[3], u, &rep), &rep, what) && eng_ok(heat_column(other, t, fresh->vertex[3], want, &rep), &rep, what));
    CHECK_MSG(memcmp(u, want, (size_t)fresh->n * sizeof *u) == 0, "%s, %s: another column", what, eng_name(method));
    hd_heat_free(other);
}

static void mov_polygon_frames(const shape_poly *s, hd_laplacian_kind kind, const char *what) {
    double *xyz = KIT_NEW(double, 3 * s->n);
    const shape points = {s->n, s->xyz, 0, NULL};
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian *lap = mov_polygons(s, s->xyz, kind, 1, &ctx), *fresh;
    hd_heat *plan[3];
    hd_error e;
    int frame, k;
    for (k = 0; k < 3; k++) {
        const hd_heat_opts o = eng_opts(methods[k]);
        plan[k] = eng_create(lap, &o);
    }
    for (frame = 0; frame < 4; frame++) {
        int64_t calls;
        mov_bend(&points, 0.3 * (3 - frame), xyz);   /* the last frame is the start again */
        calls = m.calls;
        CHECK_MSG(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_OK, "%s: %s", what, e.text);
        CHECK_MSG(m.calls == calls && lap->version == frame + 1, "%s: the update allocates", what);
        fresh = mov_polygons(s, xyz, kind, 0, NULL);
        mov_same_bits(lap, fresh, what);
        for (k = 0; k < 3 && kind == HD_LAPLACIAN_POLYGON; k++) mov_same_column(plan[k], fresh, methods[k], 20 * fresh->h * fresh->h, what);
        hd_laplacian_free(fresh);
    }
    /* what cannot be taken leaves everything as it was */
    fresh = mov_polygons(s, xyz, kind, 0, NULL);
    for (k = 0; k < 3; k++) {
        mov_bend(&points, 0.1, xyz);
        if (k == 0) xyz[7] = NAN;
        for (frame = 0; k == 1 && frame < 3 * s->n; frame++) xyz[frame] = 1;
        for (frame = 0; k == 2 && frame < 3 * s->n; frame++) xyz[frame] = 1e90 * s->xyz[frame];
        CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == (k == 0 ? HD_ERR_NOT_FINITE : k == 1 ? HD_ERR_EMPTY : HD_ERR_ARGUMENT));
        CHECK(k == 0 ? e.vertex == 2 : k == 1 ? e.vertex >= 0 : e.face >= 0 && e.face < s->n_faces);
        mov_same_bits(lap, fresh, what);
        CHECK(lap->version == 4);
    }
    /* one face loses its area, and gets it back */
    memcpy(xyz, s->xyz, 3 * (size_t)s->n * sizeof *xyz);
    for (k = 1; k < s->face_ptr[1]; k++) memcpy(xyz + 3 * s->face_idx[k], xyz + 3 * s->face_idx[0], 3 * sizeof *xyz);
    if (hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_OK) CHECK(lap->mesh.n_zero_area > fresh->mesh.n_zero_area && lap->mesh.n_faces_used < fresh->mesh.n_faces_used);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(s->xyz, lap->n), &e) == HD_OK && lap->mesh.n_faces_used == fresh->mesh.n_faces_used);
    hd_laplacian_free(fresh);
    for (k = 0; k < 3; k++) hd_heat_free(plan[k]);
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, what);
}

/* Every update that a new Laplacian of these places would refuse is refused like that, and leaves all as it was. */
static void mov_refused(const shape_poly *s, hd_laplacian_kind kind, hd_laplacian_opts o, const char *what) {
    static const double scales[6] = {1e49, 1e51, 1e101, 1e-51, 1e-170, NAN};
    double *xyz = KIT_NEW(double, 3 * s->n);
    hd_laplacian *lap = NULL, *same = NULL, *fresh;
    hd_error e, e2;
    int32_t i, k, version = 1, refused = 0;
    o.kind = kind;
    o.updatable = 1;
    CHECK_MSG(hd_laplacian_create(&lap, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e) == HD_OK, "%s", e.text);
    CHECK(hd_laplacian_create(&same, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e) == HD_OK);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(s->xyz, lap->n), &e) == HD_OK && hd_laplacian_update(same, MESH_POINTS(s->xyz, same->n), &e) == HD_OK);
    o.updatable = 0;
    for (k = 0; k < 18; k++) {
        hd_status st, want;
        for (i = 0; i < 3 * s->n; i++) xyz[i] = s->xyz[i] * (1 + k / 6) * (k % 6 == 5 && i == 7 ? NAN : scales[k % 6 == 5 ? 0 : k % 6]);
        fresh = NULL;
        st = hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e);
        want = hd_laplacian_create(&fresh, MESH_POLYGONS(xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, &e2);
        CHECK_MSG(st == want && ((st != HD_ERR_NOT_FINITE && st != HD_ERR_ARGUMENT) || (e.face == e2.face && e.vertex == e2.vertex && strcmp(e.text, e2.text) == 0)),
                  "%s, %d: %s, face %d, new %s, face %d", what, (int)k, hd_status_name(st), (int)e.face, hd_status_name(want), (int)e2.face);
        hd_laplacian_free(fresh);
        if (st == HD_OK) CHECK(lap->version == ++version && hd_laplacian_update(lap, MESH_POINTS(s->xyz, lap->n), &e) == HD_OK && lap->version == ++version);
        else refused++;
        mov_same_bits(lap, same, what);
        CHECK(lap->version == version);
    }
    CHECK_MSG(refused >= 9, "%s: %d updates refused", what, (int)refused);
    hd_laplacian_free(lap);
    hd_laplacian_free(same);
}

/* The same of geodesic plans, with times that can make it refuse more: distances stay as they were to the last bit. */
static void mov_geodesic_refused(const shape *s, hd_geodesic_border border) {
    static const double scales[8] = {1e-30, 1e-45, 1e-60, 1e-160, 1e45, 1e60, 1e155, NAN};
    double *xyz = KIT_NEW(double, 3 * s->n), *d = KIT_NEW(double, s->n), *want = KIT_NEW(double, s->n);
    const int32_t sources[2] = {s->n / 2, s->n / 2 + 1};
    int32_t i, k, refused = 0;
    int way;
    for (way = 0; way < 3; way++) {
        hd_geodesic_opts o;
        hd_geodesic *g = NULL, *fresh;
        hd_geodesic_report rep, rep2;
        hd_error e, e2;
        memset(&o, 0, sizeof o);
        o.border = border;
        o.updatable = 1;
        o.t = way == 1 ? 1e-90 : 0;
        o.t_in_h2 = way == 2 ? 1e-100 : 0;
        CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e) == HD_OK);
        o.updatable = 0;
        CHECK(hd_geodesic_distance(g, TOGETHER(2, sources), want, 0, &rep, &e) >= 0);
        for (k = 0; k < 9; k++) {
            hd_status st, like;
            for (i = 0; i < 3 * s->n; i++) xyz[i] = s->xyz[i] * (k < 8 ? scales[k] : i / 3 == s->tri[0] ? 0 : 1);
            for (i = 0; i < 3 && k == 8; i++) memcpy(xyz + 3 * s->tri[i], s->xyz + 3 * s->tri[0], 3 * sizeof *xyz);
            fresh = NULL;
            st = hd_geodesic_update(g, MESH_POINTS(xyz, s->n), &e);
            like = hd_geodesic_create(&fresh, MESH_TRIANGLES(xyz, s->n, s->tri, s->n_tri), &o, &e2);
            CHECK_MSG(st == like || k == 8, "way %d, %d: %s, new %s", way, (int)k, hd_status_name(st), hd_status_name(like));
            hd_geodesic_free(fresh);
            if (st == HD_OK) CHECK(hd_geodesic_update(g, MESH_POINTS(s->xyz, s->n), &e) == HD_OK);
            refused += st < 0;
            CHECK_MSG(hd_geodesic_distance(g, TOGETHER(2, sources), d, 0, &rep2, &e) >= 0, "way %d, %d, after %s: %s", way, (int)k,
                hd_status_name(st), e.text);
            if (st < 0) CHECK_MSG(memcmp(d, want, (size_t)s->n * sizeof *d) == 0 && rep.t == rep2.t && rep.h == rep2.h && rep.residual_heat == rep2.residual_heat, "way %d, %d", way, (int)k);
            memcpy(want, d, (size_t)s->n * sizeof *d);       /* after an update sums were taken in another order */
            rep = rep2;
        }
        hd_geodesic_free(g);
    }
    CHECK_MSG(refused >= 14, "%d updates refused", (int)refused);
}

/* Errors name the polygon, in whatever order polygons and vertices stand: far squares and pentagons, each spoilt in turn. */
static void mov_names(void) {
    enum { N = 7 };
    static const int32_t place[N] = {4, 1, 6, 0, 5, 2, 3};
    shape_poly s = kit_own_poly(shape_poly_make(5 * N, N, 5 * N));
    double xyz[15 * N];
    int32_t f, k;
    int kind;
    for (k = 0; k < 5 * N; k++) {
        s.xyz[3 * k] = 10 * (k / 5) + cos(1.2566370614359172 * (k % 5));
        s.xyz[3 * k + 1] = sin(1.2566370614359172 * (k % 5));
        s.xyz[3 * k + 2] = 0;
    }
    for (f = 0; f < N; f++) {
        const int32_t v = 5 * place[f], corner[5] = {v, v + 1, v + 2, v + 3, v + 4};
        shape_put_face(&s, f == 2 ? 2 : 4 + f % 2, corner);  /* one is no face at all */
    }
    for (kind = HD_LAPLACIAN_FEM; kind <= HD_LAPLACIAN_POLYGON; kind++) {
        hd_laplacian *lap = kit_own_laplacian(mov_polygons(&s, s.xyz, (hd_laplacian_kind)kind, 1, NULL));
        for (f = 0; f < N; f++) {
            hd_error e;
            memcpy(xyz, s.xyz, sizeof xyz);
            xyz[15 * place[f] + 3] *= 1e90;
            xyz[15 * place[f] + 7] *= 1e90;
            CHECK_MSG(f == 2 || (hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_ERR_ARGUMENT && e.face == f), "kind %d: face %d for %d", kind, (int)e.face, (int)f);
        }
    }
}

/* Faces that lose their area take their edges along, as in a new Laplacian; those that have none from the start never count. */
static void mov_lost(hd_laplacian_kind kind, int32_t lost) {
    shape s = kit_own_shape(shape_grid(8, 7, 0.2));
    hd_laplacian *lap, *fresh;
    double *xyz = KIT_NEW(double, 3 * s.n);
    hd_error e;
    s.tri[3] = s.tri[4];
    lap = test_laplacian_at(&s, s.xyz, kind, 1, NULL);
    memcpy(xyz, s.xyz, 3 * (size_t)s.n * sizeof *xyz);
    memcpy(xyz + 3 * lost, s.xyz + 3 * (lost + 1), 3 * sizeof *xyz);
    fresh = test_laplacian_at(&s, xyz, kind, 0, NULL);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_OK && lap->mesh.n_zero_area > 0);
    CHECK_MSG(lap->mesh.n_edges == fresh->mesh.n_edges && lap->mesh.n_boundary_edges == fresh->mesh.n_boundary_edges && lap->mesh.n_boundary_loops == fresh->mesh.n_boundary_loops,
              "vertex %d: %d edges, %d, %d loops for %d, %d, %d", (int)lost, (int)lap->mesh.n_edges, (int)lap->mesh.n_boundary_edges, (int)lap->mesh.n_boundary_loops,
              (int)fresh->mesh.n_edges, (int)fresh->mesh.n_boundary_edges, (int)fresh->mesh.n_boundary_loops);
    CHECK(memcmp(&lap->mesh, &fresh->mesh, sizeof lap->mesh) == 0);
    CHECK_MSG(lap->h == fresh->h && lap->area == fresh->area, "vertex %d: h %g for %g", (int)lost, lap->h, fresh->h);
    hd_laplacian_free(lap);
    hd_laplacian_free(fresh);
}

/* L and B of a mesh as matrices over vertices: rows are vertices where every vertex has a mass. */
static hd_csr mov_matrix(const hd_laplacian *lap, const double *val, int diagonal) {
    hd_csr a = lap->L;
    int32_t i;
    if (!diagonal) {
        a.val = DENSE_NEW(double, a.nnz);
        memcpy(a.val, val, (size_t)a.nnz * sizeof(double));
        return a;
    }
    a.nnz = a.n_rows;
    a.row_ptr = DENSE_NEW(int64_t, a.n_rows + 1);
    a.col = DENSE_NEW(int32_t, a.n_rows);
    a.val = DENSE_NEW(double, a.n_rows);
    for (i = 0; i < a.n_rows; i++) {
        a.row_ptr[i] = a.col[i] = i;
        a.val[i] = val[i];
    }
    a.row_ptr[i] = i;
    return a;
}

static void mov_matrix_free(hd_csr *a, int diagonal) {
    if (diagonal) {
        free(a->row_ptr);
        free(a->col);
    }
    free(a->val);
}

static void mov_matrix_frames(const shape *s, hd_laplacian_kind kind, const char *what) {
    const int diagonal = kind != HD_LAPLACIAN_FEM;
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    double *xyz = KIT_NEW(double, 3 * s->n);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian *lap = NULL, *fresh = NULL, *mesh = test_laplacian_at(s, s->xyz, kind, 1, NULL);
    hd_laplacian_opts o;
    hd_heat *plan[3];
    hd_csr L = mov_matrix(mesh, mesh->L.val, 0), B = mov_matrix(mesh, diagonal ? mesh->mass : mesh->B, diagonal);
    hd_error e;
    int frame, k;
    memset(&o, 0, sizeof o);
    o.updatable = 1;
    o.context = &ctx;
    CHECK_MSG(hd_laplacian_matrices(&lap, &L, &B, mesh->h, &o, &e) == HD_OK, "%s: %s", what, e.text);
    for (k = 0; k < 3; k++) {
        const hd_heat_opts ho = eng_opts(methods[k]);
        plan[k] = eng_create(lap, &ho);
    }
    for (frame = 0; frame < 4; frame++) {
        uint64_t bytes;
        mov_bend(s, 0.3 * (3 - frame), xyz);
        CHECK(hd_laplacian_update(mesh, MESH_POINTS(xyz, mesh->n), NULL) == HD_OK);
        memcpy(L.val, mesh->L.val, (size_t)L.nnz * sizeof(double));
        memcpy(B.val, diagonal ? mesh->mass : mesh->B, (size_t)B.nnz * sizeof(double));
        if (frame == 2) L.val[0] += 0.5;         /* heat is lost there */
        bytes = m.bytes;
        CHECK_MSG(hd_laplacian_update_matrices(lap, &L, &B, mesh->h, &e) == HD_OK, "%s: %s", what, e.text);
        CHECK_MSG(m.bytes == bytes && lap->version == frame + 1, "%s: the update keeps memory", what);
        o.updatable = 0;
        o.context = NULL;
        fresh = NULL;
        CHECK(hd_laplacian_matrices(&fresh, &L, &B, mesh->h, &o, &e) == HD_OK && fresh->conserves == (frame != 2));
        mov_same_bits(lap, fresh, what);
        for (k = 0; k < 3; k++) mov_same_column(plan[k], fresh, methods[k], 20 * mesh->h * mesh->h, what);
        if (frame < 3) hd_laplacian_free(fresh);
    }
    /* errors, after which all is as it was */
    for (k = 0; k < 7; k++) {
        static const hd_status want[7] = {HD_ERR_NOT_FINITE, HD_ERR_NOT_SYMMETRIC, HD_ERR_NOT_POSITIVE, HD_ERR_NOT_POSITIVE,
                                          HD_ERR_ARGUMENT, HD_ERR_STRUCTURE, HD_ERR_STRUCTURE};
        hd_csr Lx = mov_matrix(mesh, L.val, 0), Bx = mov_matrix(mesh, B.val, diagonal), *dense = k == 5 ? &Lx : &Bx;
        int64_t p;
        if (k == 0) Lx.val[4] = NAN;
        if (k == 1) Lx.val[1] += 1;
        for (p = 0; k == 2 && p < Lx.nnz; p++) Lx.val[p] = -Lx.val[p];
        for (p = 0; k == 3 && p < Bx.nnz; p++) Bx.val[p] = -Bx.val[p];
        if (k >= 5) {                            /* a matrix with an entry in two far corners */
            hd_csr a;
            int32_t ij[2][4] = {{0, lap->n - 1, 0, 1}, {lap->n - 1, 0, 0, 1}};
            const double v[4] = {0.5, 0.5, 1, 1};
            CHECK(hd_csr_from_triplets(&a, lap->n, lap->n, 4, ij[0], ij[1], v, NULL, NULL) == HD_OK);
            CHECK(hd_laplacian_update_matrices(lap, dense == &Lx ? &a : &L, dense == &Lx ? &B : &a, 1, &e) == want[k] && e.row >= 0);
            hd_csr_free(&a, NULL);
        } else {
            CHECK_MSG(hd_laplacian_update_matrices(lap, &Lx, &Bx, k == 4 ? -1 : 1, &e) == want[k], "%s, error %d: %s", what, k, e.text);
        }
        mov_same_bits(lap, fresh, what);
        CHECK(lap->version == 4);
        mov_matrix_free(&Lx, 0);
        mov_matrix_free(&Bx, diagonal);
    }
    CHECK(hd_laplacian_update(lap, MESH_POINTS(s->xyz, lap->n), &e) == HD_ERR_ARGUMENT && strstr(e.text, "matrices") != NULL);
    CHECK(hd_laplacian_update_matrices(fresh, &L, &B, 1, &e) == HD_ERR_ARGUMENT && hd_laplacian_update_matrices(mesh, &L, &B, 1, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_update_matrices(NULL, &L, &B, 1, &e) == HD_ERR_ARGUMENT && hd_laplacian_update_matrices(lap, NULL, &B, 1, &e) == HD_ERR_ARGUMENT);
    hd_laplacian_free(fresh);
    for (k = 0; k < 3; k++) hd_heat_free(plan[k]);
    hd_laplacian_free(lap);
    hd_laplacian_free(mesh);
    mov_matrix_free(&L, 0);
    mov_matrix_free(&B, diagonal);
    test_memory_done(&m, &ctx, what);
}

/* A vertex without mass stays one, and a diagonal B stays diagonal; entries of zero may lie outside of the pattern. */
static void mov_matrix_pattern(void) {
    enum { N = 5, E = 13 };
    static const int32_t I[E] = {0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 0, 3}, J[E] = {0, 1, 0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 0};
    static const double l[E] = {1, -1, -1, 2, -1, -1, 2, -1, -1, 1, 0, 0, 0}, b[N] = {1, 2, 3, 4, 0};
    static const int32_t D[N + 2] = {0, 1, 2, 3, 4, 3, 4}, C[N + 2] = {0, 1, 2, 3, 4, 4, 3}, M[N + 2] = {0, 1, 2, 3, 4, 0, 1}, W[N + 2] = {0, 1, 2, 3, 4, 1, 0};
    double more[N + 2] = {1, 2, 3, 4, 0, 0.1, 0.1};
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_csr L, wide, B, bad;
    hd_error e;
    double x[N] = {1, 0, 0, 0, 0}, y[N];
    memset(&o, 0, sizeof o);
    o.updatable = 1;
    CHECK(hd_csr_from_triplets(&L, N, N, E - 2, I, J, l, NULL, &e) == HD_OK && hd_csr_from_triplets(&wide, N, N, E, I, J, l, NULL, &e) == HD_OK);
    CHECK(hd_csr_from_triplets(&B, N, N, N, D, C, b, NULL, &e) == HD_OK && wide.nnz == L.nnz + 2);
    CHECK_MSG(hd_laplacian_matrices(&lap, &L, &B, 1, &o, &e) >= 0 && lap->n_active == 4, "%s", e.text);
    CHECK(hd_laplacian_update_matrices(lap, &wide, &B, 1, &e) == HD_OK && lap->version == 1);
    CHECK(hd_laplacian_apply(lap, 1, 10, x, y, &e) == HD_OK && y[0] == 11 && y[1] == -1 && y[2] == 0 && y[3] == 0 && y[4] == 0);
    B.val[4] = 1;
    CHECK(hd_laplacian_update_matrices(lap, &L, &B, 1, &e) == HD_ERR_STRUCTURE && e.row == 4 && e.column == 4 && e.value == 1 && strstr(e.text, "without mass"));
    B.val[4] = 0;
    CHECK(hd_csr_from_triplets(&bad, N, N, N + 2, D, C, more, NULL, &e) == HD_OK);
    CHECK(hd_laplacian_update_matrices(lap, &L, &bad, 1, &e) == HD_ERR_STRUCTURE && e.row == 3 && e.column == 4 && e.value == 0.1);
    hd_csr_free(&bad, NULL);
    CHECK(hd_csr_from_triplets(&bad, N, N, N + 2, M, W, more, NULL, &e) == HD_OK);
    CHECK(hd_laplacian_update_matrices(lap, &L, &bad, 1, &e) == HD_ERR_STRUCTURE && strstr(e.text, "B was diagonal"));
    hd_csr_free(&bad, NULL);
    more[6] = 0.2;
    CHECK(hd_csr_from_triplets(&bad, N, N, N + 2, M, W, more, NULL, &e) == HD_OK);
    CHECK(hd_laplacian_update_matrices(lap, &L, &bad, 1, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 0 && e.column == 1);
    hd_csr_free(&bad, NULL);
    CHECK(hd_laplacian_apply(lap, 1, 10, x, y, &e) == HD_OK && y[0] == 11 && y[1] == -1 && lap->version == 1);
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&wide, NULL);
    hd_csr_free(&B, NULL);
}

/* ---- values that part what the pattern joins ---- */

/* Heat at a very large t spreads evenly over its part of the grid, and leaves it where a vertex is held. part [n], area [parts]; 0: heat is lost. */
static void mov_parts_check(const hd_laplacian *lap, hd_heat *const *plan, const int32_t *part, const double *area, const char *what) {
    const double t = 1e12;
    double *u = KIT_NEW(double, lap->n);
    int32_t source, v;
    hd_report rep;
    int k;
    for (k = 0; k < 3; k++)
        for (source = 12; source <= 18; source += 6) {
            const double even = area[part[source]] > 0 ? 1 / area[part[source]] : 0, mass = lap->mass[lap->row[source]];
            CHECK(eng_ok(heat_column(plan[k], t, source, u, &rep), &rep, what));
            CHECK_MSG(even == 0 || rep.error_bound <= 1e-6, "%s, %s: bound %g", what, eng_name(rep.method), rep.error_bound);
            for (v = 0; v < lap->n; v++) {
                const double want = lap->row[v] >= 0 && part[v] == part[source] ? even * mass : 0;
                CHECK_MSG(fabs(u[v] - want) <= (even > 0 ? rep.error_bound * even : 1e-9) * mass, "%s, %s: %d to %d: %g, not %g", what, eng_name(rep.method), source, v, u[v], want);
            }
        }
    CHECK(eng_ok(heat_diagonal(plan[0], 1, &t, HD_KERNEL_SYMMETRIC, u, 0, &rep), &rep, what));
    for (v = 0; v < lap->n; v++)
        if (lap->row[v] >= 0 && area[part[v]] > 0) CHECK_MSG(fabs(u[v] * area[part[v]] - 1) <= 1e-6, "%s: diagonal at %d: %g", what, v, u[v]);
    for (k = HD_DISTANCE_COMMUTE; k <= HD_DISTANCE_BIHARMONIC; k++) {
        source = 12;
        CHECK(eng_ok(heat_distance(plan[0], (hd_distance_kind)k, 1, &t, 1, &source, u, 0, &rep), &rep, what));
        for (v = 0; v < lap->n; v++) CHECK_MSG((u[v] == HUGE_VAL) == (lap->row[v] < 0 || part[v] != part[source]), "%s: distance to %d: %g", what, v, u[v]);
    }
}

/* A strip of the grid closes and opens again. kind polygon: its triangles as polygons. held: a vertex on the left is. */
static void mov_strip(hd_laplacian_kind kind, int held, const char *what) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    shape s = kit_own_shape(shape_grid(10, 7, 0));
    const int32_t corner = 0;
    int64_t *ptr = KIT_NEW(int64_t, s.n_tri + 1);
    double *xyz = KIT_NEW(double, 3 * s.n), *L[2];
    int32_t *part = KIT_NEW(int32_t, s.n), i;
    hd_laplacian *lap[2] = {NULL, NULL};
    hd_heat *plan[3];
    hd_laplacian_opts o;
    hd_error e;
    int frame, k;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.n_held = held;
    o.held = &corner;
    for (i = 0; i <= s.n_tri; i++) ptr[i] = 3 * i;
    for (frame = 0; frame < 4; frame++) {
        const int closed = frame % 2;
        const double area[2] = {held ? 0 : closed ? 24 / 81.0 : 54 / 81.0, 30 / 81.0};
        memcpy(xyz, s.xyz, 3 * (size_t)s.n * sizeof *xyz);
        for (i = 0; i < s.n; i++) {
            part[i] = closed && i % 10 >= 5;
            if (closed && i % 10 == 5) memcpy(xyz + 3 * i, s.xyz + 3 * (i - 1), 3 * sizeof *xyz);
        }
        for (k = frame > 0; k < 2; k++) {        /* the one that moves, at first; and a new one */
            o.updatable = k == 0;
            CHECK((kind == HD_LAPLACIAN_POLYGON ? hd_laplacian_create(lap + k, MESH_POLYGONS(xyz, s.n, ptr, s.tri, s.n_tri), &o, &e)
                                                : hd_laplacian_create(lap + k, MESH_TRIANGLES(xyz, s.n, s.tri, s.n_tri), &o, &e)) == HD_OK);
        }
        for (k = 0; k < 3 && frame == 0; k++) {
            const hd_heat_opts ho = eng_opts(methods[k]);
            plan[k] = eng_create(lap[0], &ho);
        }
        if (frame > 0) CHECK_MSG(hd_laplacian_update(lap[0], MESH_POINTS(xyz, lap[0]->n), &e) == HD_OK, "%s: %s", what, e.text);
        CHECK_MSG(lap[0]->n_components == 1 + closed && lap[0]->conserves == (!held ? 1 : closed ? 2 : 0), "%s: %d components", what, lap[0]->n_components);
        mov_same_report(lap[0], lap[1], what);
        L[0] = test_dense(&lap[0]->L, NULL);
        L[1] = test_dense(&lap[1]->L, NULL);
        CHECK_MSG(dense_max_diff(L[0], L[1], lap[1]->n_active * lap[1]->n_active) <= 1e-14 * dense_max_abs(L[1], lap[1]->n_active * lap[1]->n_active), "%s: L", what);
        free(L[0]);
        free(L[1]);
        mov_parts_check(lap[0], plan, part, area, what);
        hd_laplacian_free(lap[1]);
        lap[1] = NULL;
    }
    for (k = 0; k < 3; k++) hd_heat_free(plan[k]);
    hd_laplacian_free(lap[0]);
}

/* Zeros that the caller's matrices store join nothing: two paths of three vertices, and what lies between them. */
static void mov_stored_zeros(void) {
    enum { N = 6, E = 11 };
    static const int32_t I[E] = {0, 1, 2, 3, 4, 5, 0, 1, 3, 4, 2}, J[E] = {0, 1, 2, 3, 4, 5, 1, 2, 4, 5, 3};
    double l[2 * E] = {1, 2, 1, 1, 2, 1, -1, -1, -1, -1, 0}, b[2 * E] = {1, 1, 1, 1, 1, 1, 0.1, 0.1, 0.1, 0.1, 0}, t = 1e12, u[N];
    const int32_t source = 0;
    int32_t ij[2][2 * E], i;
    int frame;
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    hd_heat *heat;
    hd_report rep;
    hd_error e;
    hd_csr L, B, D = kit_own_csr(test_diagonal_csr(N, NULL));
    memcpy(ij[0], I, sizeof I);
    memcpy(ij[1], J, sizeof J);
    L = test_symmetric_csr(N, E, ij[0], ij[1], l);
    memcpy(ij[0], I, sizeof I);
    memcpy(ij[1], J, sizeof J);
    B = test_symmetric_csr(N, E, ij[0], ij[1], b);
    memset(&o, 0, sizeof o);
    CHECK(hd_laplacian_matrices(&lap, &L, &D, 1, &o, &e) == HD_OK && lap->n_components == 2 && lap->component_mass[1] == 3);
    heat = eng_create(lap, NULL);
    CHECK(eng_ok(heat_column(heat, t, 0, u, &rep), &rep, "stored zeros"));
    for (i = 0; i < N; i++) CHECK_MSG(fabs(u[i] - (i < 3) / 3.0) <= 1e-9, "stored zeros: %g at %d", u[i], i);
    CHECK(eng_ok(heat_distance(heat, HD_DISTANCE_COMMUTE, 1, &t, 1, &source, u, 0, &rep), &rep, "stored zeros") && fabs(u[2] - sqrt(2)) <= 1e-9 && u[3] == HUGE_VAL);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    lap = NULL;
    /* a full B: joined while one of the two has a value there; without vertex 1 the first path falls apart too */
    o.updatable = 1;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, &o, &e) == HD_OK && lap->n_components == 2);
    for (frame = 0; frame < 4; frame++) {
        const double between = frame < 2 ? frame == 0 : 0, mass = frame == 2 ? 0.1 : 0;
        int64_t p;
        for (i = 2; i <= 3; i++)
            for (p = L.row_ptr[i]; p < L.row_ptr[i + 1]; p++) {
                if (L.col[p] == i) L.val[p] = 1 + between;
                if (L.col[p] != 5 - i) continue;
                L.val[p] = -between;
                B.val[p] = mass;
            }
        CHECK_MSG(hd_laplacian_update_matrices(lap, &L, &B, 1, &e) == HD_OK, "%s", e.text);
        CHECK_MSG(lap->n_components == (frame == 0 || frame == 2 ? 1 : 2) && lap->component[5] == lap->n_components - 1, "stored zeros, frame %d: %d components", frame, lap->n_components);
        CHECK(fabs(lap->component_mass[lap->component[5]] - (lap->n_components == 1 ? 6.8 + 2 * mass : 3.4)) <= 1e-14);
    }
    hd_laplacian_free(lap);
    lap = NULL;
    o.held = ij[0];
    o.n_held = 1;
    ij[0][0] = 1;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, &o, &e) == HD_OK && lap->n_components == 3 && lap->conserves == 2);
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
}

/* Points are refused, and told why. */
static void mov_points(const shape *s) {
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.updatable = 1;
    CHECK(hd_laplacian_create(&lap, MESH_POINTS(s->xyz, s->n), &o, &e) == HD_ERR_ARGUMENT && !lap && strstr(e.text, "pattern") != NULL);
    CHECK(at_tufted(&lap, s->xyz, s->n, NULL, NULL, &o, &e) == HD_ERR_ARGUMENT && !lap && strstr(e.text, "triangles") != NULL);
}

/* Vertices held at zero, with the border or without it: an update fills what a new Laplacian has. kind polygon: its triangles
 * as polygons. */
static void mov_held(hd_laplacian_kind kind, hd_border border) {
    shape s = kit_own_shape(shape_grid(11, 8, 0.2));
    const int32_t held[3] = {25, 26, 50};
    int64_t *ptr = KIT_NEW(int64_t, s.n_tri + 1);
    double *xyz = KIT_NEW(double, 3 * s.n);
    hd_laplacian *lap[2] = {NULL, NULL};
    hd_laplacian_opts o;
    hd_error e;
    int frame, k;
    int32_t i;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.border = border;
    o.held = held;
    o.n_held = 3;
    for (i = 0; i <= s.n_tri; i++) ptr[i] = 3 * i;
    for (frame = 0; frame < 3; frame++) {
        mov_bend(&s, 0.4 * frame, xyz);
        for (k = frame > 0; k < 2; k++) {
            o.updatable = k == 0;
            CHECK((kind == HD_LAPLACIAN_POLYGON ? hd_laplacian_create(lap + k, MESH_POLYGONS(xyz, s.n, ptr, s.tri, s.n_tri), &o, &e)
                                                : hd_laplacian_create(lap + k, MESH_TRIANGLES(xyz, s.n, s.tri, s.n_tri), &o, &e)) == HD_OK);
        }
        if (frame > 0) CHECK_MSG(hd_laplacian_update(lap[0], MESH_POINTS(xyz, lap[0]->n), &e) == HD_OK, "held: %s", e.text);
        CHECK(lap[0]->n_held == lap[1]->n_held && lap[0]->conserves == 0 && lap[0]->n_components == lap[1]->n_components);
        mov_same_bits(lap[0], lap[1], "held");
        hd_laplacian_free(lap[1]);
        lap[1] = NULL;
    }
    hd_laplacian_free(lap[0]);
}

/* Pairs of every kind that is made of faces: some of them come twice, have no area, stand three at an edge, or are turned over. */
static void mov_all_symmetric(const shape *s) {
    hd_laplacian_opts o;
    hd_laplacian *lap;
    double *len = KIT_NEW(double, 3 * s->n_tri);
    hd_error e;
    int kind, way, k;
    int32_t f;
    for (f = 0; f < s->n_tri; f++)
        for (k = 0; k < 3; k++) {
            const double *a = s->xyz + 3 * s->tri[3 * f + k], *b = s->xyz + 3 * s->tri[3 * f + (k + 1) % 3];
            len[3 * f + k] = sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
        }
    for (kind = HD_LAPLACIAN_FEM; kind <= HD_LAPLACIAN_COT; kind++)
        for (way = 0; way < 5; way++) {
            hd_status st;
            memset(&o, 0, sizeof o);
            o.kind = (hd_laplacian_kind)kind;
            o.triangulation = way == 1 ? HD_TRIANGULATION_DELAUNAY : way == 2 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
            lap = NULL;
            st = way < 3 ? hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e)
               : way < 4 ? hd_laplacian_create(&lap, MESH_LENGTHS(len, s->n, s->tri, s->n_tri), &o, &e)
                         : at_tufted(&lap, s->xyz, s->n, NULL, NULL, &o, &e);
            CHECK_MSG(st == HD_OK, "kind %d, way %d: %s", kind, way, e.text);
            if (lap) mov_symmetric(lap, "a mesh");
            hd_laplacian_free(lap);
        }
}

static void test_moving(void) {
    int kind;
    shape ball = kit_own_shape(shape_bumpy(3, 5)), sheet = kit_own_shape(shape_grid(13, 11, 0.3)), soup = kit_own_shape(trial_jumble(300, 500, 9));
    mov_frames(&ball, HD_LAPLACIAN_FEM, "ball, fem");
    mov_frames(&ball, HD_LAPLACIAN_COT, "ball, cot");
    mov_frames(&sheet, HD_LAPLACIAN_VORONOI_COT, "sheet, voronoi-cot");
    mov_frames(&soup, HD_LAPLACIAN_FEM, "soup, fem");
    mov_errors();
    for (kind = HD_LAPLACIAN_FEM; kind <= HD_LAPLACIAN_POLYGON; kind++) {
        mov_held((hd_laplacian_kind)kind, HD_BORDER_NATURAL);
        mov_held((hd_laplacian_kind)kind, HD_BORDER_DIRICHLET);
    }
    mov_all_symmetric(&ball);
    mov_all_symmetric(&soup);
    {
        shape_poly torus = kit_own_poly(shape_quad_torus(14, 9, 2, 0.7)), cells = kit_own_poly(shape_hex_sphere(2)), mixed = shape_trominoes(4, 5, 0.3);
        mov_polygon_frames(&torus, HD_LAPLACIAN_POLYGON, "torus of quads");
        mov_polygon_frames(&cells, HD_LAPLACIAN_POLYGON, "sphere of hexagons");
        mov_polygon_frames(&mixed, HD_LAPLACIAN_POLYGON, "trominoes");
        mov_polygon_frames(&torus, HD_LAPLACIAN_FEM, "torus of quads, split");
        shape_poly_free(&mixed);
    }
    mov_matrix_frames(&ball, HD_LAPLACIAN_FEM, "matrices of fem");
    mov_matrix_frames(&ball, HD_LAPLACIAN_VORONOI_COT, "matrices of voronoi-cot");
    mov_matrix_pattern();
    mov_strip(HD_LAPLACIAN_FEM, 0, "strip, fem");
    mov_strip(HD_LAPLACIAN_VORONOI_COT, 1, "strip, voronoi-cot, held");
    mov_strip(HD_LAPLACIAN_POLYGON, 0, "strip, polygon");
    mov_strip(HD_LAPLACIAN_POLYGON, 1, "strip, polygon, held");
    mov_stored_zeros();
    mov_points(&ball);
    mov_names();
    mov_lost(HD_LAPLACIAN_FEM, 27);
    mov_lost(HD_LAPLACIAN_VORONOI_COT, 41);
    {
        shape flat = kit_own_shape(shape_grid(9, 7, 0));        /* its whole area overflows before that of a face does */
        shape_poly split = kit_own_poly(shape_poly_of(&flat)), mixed = shape_trominoes(4, 5, 0.1);
        const int32_t held[2] = {10, 24};
        hd_laplacian_opts o;
        memset(&o, 0, sizeof o);
        mov_refused(&split, HD_LAPLACIAN_FEM, o, "fem");
        mov_refused(&split, HD_LAPLACIAN_VORONOI_COT, o, "voronoi-cot");
        mov_refused(&mixed, HD_LAPLACIAN_COT, o, "cot of trominoes");
        mov_refused(&mixed, HD_LAPLACIAN_POLYGON, o, "trominoes");
        o.border = HD_BORDER_DIRICHLET;
        o.held = held;
        o.n_held = 2;
        mov_refused(&split, HD_LAPLACIAN_FEM, o, "fem, held");
        mov_refused(&mixed, HD_LAPLACIAN_POLYGON, o, "trominoes, held");
        mov_geodesic_refused(&flat, HD_GEODESIC_BORDER_NATURAL);
        mov_geodesic_refused(&flat, HD_GEODESIC_BORDER_MEAN);
        shape_poly_free(&mixed);
    }
    mov_geodesic(&ball, "ball");
    mov_geodesic(&sheet, "sheet");
}
