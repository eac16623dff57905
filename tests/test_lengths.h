/* test_lengths.h - triangles that are known by the lengths of their sides: against the same ones in space, and flat tori, which have no shape in
 * space, in closed form */

#ifndef TEST_LENGTHS_H
#define TEST_LENGTHS_H

/* The lengths of a mesh in space, times a unit. */
static double *len_of(const shape *s, double unit) {
    double *len = DENSE_NEW(double, 3 * s->n_tri);
    int32_t f, q;
    for (f = 0; f < s->n_tri; f++)
        for (q = 0; q < 3; q++) len[3 * f + q] = unit * src_gap(s->xyz + 3 * s->tri[3 * f + q], s->xyz + 3 * s->tri[3 * f + (q + 1) % 3]);
    return len;
}

static hd_laplacian *len_make(const double *len, int32_t n, const int32_t *tri, int32_t m, const hd_laplacian_opts *o) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(hd_laplacian_create(&lap, MESH_LENGTHS(len, n, tri, m), o, &e) == HD_OK, "%s", e.text);
    return kit_own_laplacian(lap);
}

/* ---- the same as in space ---- */

static void len_same(const hd_laplacian *a, const hd_laplacian *b, double unit, const char *what) {
    const double area = unit * unit;
    double off_l = 0, off_b = 0;
    int32_t i;
    int64_t p;
    CHECK_MSG(a->n_active == b->n_active && a->L.nnz == b->L.nnz && a->n_components == b->n_components && a->conserves == b->conserves && a->n_held == b->n_held &&
              a->b_ratio == b->b_ratio && a->kind == b->kind && b->xyz == NULL, "%s", what);
    if (a->n_active != b->n_active || a->L.nnz != b->L.nnz) return;
    CHECK_MSG(fabs(b->h - unit * a->h) <= 1e-13 * b->h && fabs(b->area - area * a->area) <= 1e-12 * b->area, "%s: h %g, area %g", what, b->h, b->area);
    CHECK(memcmp(a->row, b->row, (size_t)a->n * sizeof *a->row) == 0 && memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0);
    for (p = 0; p < a->L.nnz; p++) {
        off_l = fmax(off_l, fabs(a->L.val[p] - b->L.val[p]));
        if (a->B) off_b = fmax(off_b, fabs(a->B[p] - b->B[p] / area));
    }
    for (i = 0; i < a->n_active; i++) off_b = fmax(off_b, a->kind == HD_LAPLACIAN_COT ? fabs(a->mass[i] - b->mass[i]) : fabs(a->mass[i] - b->mass[i] / area));
    CHECK_MSG(off_l <= 1e-11 && off_b <= 1e-13 * (a->kind == HD_LAPLACIAN_COT ? 1 : a->area), "%s: L is off by %g, B by %g", what, off_l, off_b);
    CHECK(a->mesh.n_faces == b->mesh.n_faces && a->mesh.n_faces_used == b->mesh.n_faces_used && a->mesh.n_repeated_corner == b->mesh.n_repeated_corner &&
          a->mesh.n_zero_area == b->mesh.n_zero_area && a->mesh.n_repeated_face == b->mesh.n_repeated_face && a->mesh.n_edges == b->mesh.n_edges &&
          a->mesh.n_boundary_edges == b->mesh.n_boundary_edges && a->mesh.n_nonmanifold_edges == b->mesh.n_nonmanifold_edges &&
          a->mesh.n_misoriented_edges == b->mesh.n_misoriented_edges && a->mesh.n_boundary_loops == b->mesh.n_boundary_loops && a->mesh.n_inert == b->mesh.n_inert &&
          a->mesh.n_sheets == b->mesh.n_sheets && fabs(a->mesh.smallest_angle - b->mesh.smallest_angle) < 1e-12);
}

static void len_operators(void) {
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    static const double units[3] = {1, 3.7e-45, 1e45};
    const int32_t held[2] = {5, 9};
    int k, q, w;
    for (k = 0; k < 5; k++) {
        shape s = k == 0 ? shape_grid(9, 8, 0.3) : k == 1 ? shape_bumpy(2, 5) : k == 2 ? trial_spare(shape_icosphere(2)) : k == 3 ? all_soup() : all_needles();
        for (q = 0; q < 3; q++)
            for (w = 0; w < (k == 3 ? 1 : 3); w++) {     /* without angles in space the sheets of a soup may be glued otherwise */
                const double unit = units[(k + q + w) % 3];
                hd_laplacian_opts o = bord_opts(kinds[q], k == 0 && w == 1 ? HD_BORDER_DIRICHLET : HD_BORDER_NATURAL, q, held);
                hd_laplacian *a, *b;
                double *len = len_of(&s, unit);
                char what[60];
                snprintf(what, sizeof what, "shape %d, kind %d, way %d", k, q, w);
                o.triangulation = w == 1 ? HD_TRIANGULATION_DELAUNAY : w == 2 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
                a = bord_triangles(&s, &o);
                b = len_make(len, s.n, s.tri, s.n_tri, &o);
                len_same(a, b, unit, what);
                hd_laplacian_free(a);
                free(len);
            }
        shape_free(&s);
    }
}

/* Three pages of a book: with lengths the sheets are glued in some order, and the pair is still one without negative weights. */
static void len_book(void) {
    const int32_t tri[9] = {0, 1, 2, 0, 1, 3, 1, 0, 4};
    const double len[9] = {3, 2, 2, 3, 2.5, 1, 3, 1.1, 2.2};
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 0, NULL);
    hd_laplacian *lap;
    int32_t i;
    int64_t p;
    o.triangulation = HD_TRIANGULATION_TUFTED;
    lap = len_make(len, 5, tri, 3, &o);
    CHECK_MSG(lap->mesh.n_nonmanifold_edges == 1 && lap->mesh.n_flips > 0 && lap->mesh.n_sheets == 2 && lap->mesh.n_negative_weights == 0 && lap->mesh.n_not_delaunay == 0, "%d %d %d %d",
              (int)lap->mesh.n_nonmanifold_edges, (int)lap->mesh.n_sheets, (int)lap->mesh.n_negative_weights, (int)lap->mesh.n_not_delaunay);
    for (i = 0; i < lap->n_active; i++) {
        double sum = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            CHECK(lap->L.col[p] == i || lap->L.val[p] <= 0);
            sum += lap->L.val[p];
        }
        CHECK(fabs(sum) < 1e-12);
    }
}

/* ---- flat tori ---- */

/* nx x ny vertices, sides of cells a and b. The second step leads `shear` vertices further along the first one, so that triangles are long; the
 * surface is the same. tri [6 nx ny], len as much. */
static void len_torus(int32_t nx, int32_t ny, double a, double b, int32_t shear, int32_t *tri, double *len) {
    const double up = hypot(b, shear * a), across = hypot(b, (shear + 1) * a);
    int32_t i, j, q, t = 0;
    for (j = 0; j < ny; j++)
        for (i = 0; i < nx; i++) {
            const int32_t above = (j + 1) % ny * nx, v = j * nx + i, w = j * nx + (i + 1) % nx, x = above + (i + shear) % nx, y = above + (i + shear + 1) % nx;
            const int32_t corner[6] = {v, w, y, v, y, x};
            const double side[6] = {a, up, across, across, a, up};
            for (q = 0; q < 6; q++, t++) {
                tri[t] = corner[q];
                len[t] = side[q];
            }
        }
}

/* With squares L is the stencil of five points whatever the diagonals, once they are Delaunay; the kernel is a product of those of two rings. */
static void len_rings(void) {
    enum { NX = 13, NY = 9 };
    const double side = 0.25, t = 3 * side * side;
    int32_t tri[6 * NX * NY], shear, v;
    double len[6 * NX * NY], u[NX * NY];
    for (shear = 0; shear < 4; shear++) {
        hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_VORONOI_COT, HD_BORDER_NATURAL, 0, NULL);
        hd_laplacian *lap;
        hd_heat *heat;
        hd_report rep;
        double off = 0;
        int32_t lost = 0;
        int64_t p;
        int method;
        o.triangulation = shear > 0 ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
        o.mollify = shear > 0 ? -1 : 0;
        len_torus(NX, NY, side, side, shear, tri, len);
        lap = len_make(len, NX * NY, tri, 2 * NX * NY, &o);
        CHECK(lap->n_components == 1 && lap->mesh.n_boundary_edges == 0 && lap->mesh.n_edges == 3 * NX * NY && lap->mesh.n_nonmanifold_edges == 0);
        CHECK_MSG((lap->mesh.n_flips > 0) == (shear > 0) && fabs(lap->area - NX * NY * side * side) < 1e-13, "flips %d, area %g", (int)lap->mesh.n_flips, lap->area);
        for (v = 0; v < NX * NY; v++) {
            off = fmax(off, fabs(lap->mass[v] - side * side));
            for (p = lap->L.row_ptr[v]; p < lap->L.row_ptr[v + 1]; p++) {
                const int32_t w = lap->L.col[p], dx = (v % NX - w % NX + NX) % NX, dy = (v / NX - w / NX + NY) % NY;
                const int near_by = (dx == 0 && (dy == 1 || dy == NY - 1)) || (dy == 0 && (dx == 1 || dx == NX - 1));
                off = fmax(off, fabs(lap->L.val[p] - (v == w ? 4 : near_by ? -1 : 0)));
                lost += near_by;
            }
        }
        CHECK_MSG(off < 1e-12 && lost == 4 * NX * NY, "shear %d: the stencil is off by %g", (int)shear, off);
        for (method = HD_METHOD_ITERATIVE; method <= HD_METHOD_KRYLOV; method++) {
            heat = eng_plan(lap, (hd_method)method, HD_POLES_DEFAULT, 0);
            CHECK(eng_ok(heat_column(heat, t, 7, u, &rep), &rep, "torus"));
            for (v = 0, off = 0; v < NX * NY; v++) off = fmax(off, fabs(u[v] - heat_cycle(NX, 3, 7, v % NX) * heat_cycle(NY, 3, 0, v / NX)));
            CHECK_MSG(off <= rep.error_bound * u[7] + 1e-13, "torus, method %d: off by %g, bound %g", method, off, rep.error_bound * u[7]);
        }
    }
}

/* The torus of seven vertices, each joined to all others, of equilateral triangles: L = (7 I - J)/sqrt(3), B = 5/6 A I + A/6 J with A the area of a
 * triangle. */
static void len_seven(void) {
    int32_t tri[42], f, v;
    double len[42], u[7], d[7];
    const double A = sqrt(3) / 4, lambda = 42 / (5 * sqrt(3) * A), t = 0.05, fade = exp(-t * lambda), fade2 = exp(-2 * t * lambda);
    hd_laplacian *lap;
    hd_heat *heat;
    hd_geodesic *g = NULL;
    hd_spectrum_opts so;
    hd_spectrum *spectrum = NULL;
    hd_report rep;
    hd_error e;
    for (f = 0; f < 7; f++) {
        const int32_t corner[6] = {f, (f + 1) % 7, (f + 3) % 7, f, (f + 3) % 7, (f + 2) % 7};
        memcpy(tri + 6 * f, corner, sizeof corner);
    }
    for (f = 0; f < 42; f++) len[f] = 1;
    lap = len_make(len, 7, tri, 14, NULL);
    CHECK(lap->mesh.n_edges == 21 && lap->mesh.n_boundary_edges == 0 && lap->mesh.n_misoriented_edges == 0 && fabs(lap->area - 14 * A) < 1e-14 && lap->h == 1);
    heat = kit_plan(lap, NULL);
    CHECK(eng_ok(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, 2, u, &rep, &e), &rep, "seven"));
    /* eigenvectors: constants, of mass 14 A, and six of them with x'Bx = 5/6 A |x|^2 */
    for (v = 0; v < 7; v++)
        CHECK_MSG(fabs(u[v] - 1 / (14 * A) - fade * ((v == 2) - 1 / 7.0) / (5 * A / 6)) <= rep.error_bound * u[2] + 1e-14, "seven: %g", u[v]);
    CHECK(eng_ok(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, tri), d, 0, &rep, NULL), &rep, "seven"));
    for (v = 1; v < 7; v++) CHECK_MSG(fabs(d[v] - sqrt(2 * fade2 / (5 * A / 6))) <= rep.error_bound * d[v] + 1e-13, "seven: distance %g", d[v]);
    memset(&so, 0, sizeof so);
    so.count = 7;
    CHECK(hd_spectrum_create(&spectrum, lap, &so, &e) == HD_OK && spectrum->count == 7);
    for (v = 1; v < 7 && spectrum; v++) CHECK_MSG(fabs(spectrum->value[v] - lambda) < 1e-9, "seven: %.15g for %.15g", spectrum->value[v], lambda);
    CHECK(hd_geodesic_create(&g, MESH_LENGTHS(len, 7, tri, 14), NULL, &e) == HD_OK &&
        hd_geodesic_distance(g, VERTICES(1, tri), d, 0, NULL, NULL) == HD_OK);
    for (v = 1; v < 7; v++) CHECK_MSG(fabs(d[v] - 1) < 0.2 && fabs(d[v] - d[1]) < 1e-12, "seven: geodesic %g", d[v]);
    hd_geodesic_free(g);
    hd_spectrum_free(spectrum);
}

/* The kernel of a circle of this length. */
static double len_circle(double t, double length, double x) {
    double sum = 1 / length;
    int k;
    for (k = 1; k < 200; k++) sum += 2 / length * exp(-t * pow(2 * BORD_PI * k / length, 2)) * cos(2 * BORD_PI * k * x / length);
    return sum;
}

/* Heat and geodesic distance from the middle of a face of a smooth flat torus of 1 by 0.8; heat converges like h^2. */
static void len_smooth(void) {
    double heat_off[3];
    int level;
    for (level = 0; level < 3; level++) {
        const int32_t nx = 10 << level, ny = 8 << level, n = nx * ny;
        const double cell = 1.0 / nx, t = 0.02, bary[3] = {1 / 3.0, 1 / 3.0, 1 / 3.0};
        int32_t *tri = KIT_NEW(int32_t, 6 * n), v;
        double *len = KIT_NEW(double, 6 * n), *u = KIT_NEW(double, n), *d = KIT_NEW(double, n), off = 0, geo = 0;
        hd_geodesic *g = NULL;
        hd_laplacian *lap;
        hd_heat *heat;
        hd_sources s;
        hd_report rep;
        len_torus(nx, ny, cell, cell, 0, tri, len);
        lap = len_make(len, n, tri, 2 * n, NULL);
        heat = kit_plan(lap, NULL);
        s = hd_vertices(1, tri);
        s.corners = 3;
        s.bary = bary;
        CHECK(eng_ok(hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t, &s, u, 0, &rep, NULL), &rep, "flat torus"));
        CHECK(hd_geodesic_create(&g, MESH_LENGTHS(len, n, tri, 2 * n), NULL, NULL) == HD_OK);
        CHECK(hd_geodesic_distance(g, &s, d, 0, NULL, NULL) == HD_OK);
        for (v = 0; v < n; v++) {
            const double x = (v % nx - 2 / 3.0) * cell, y = (v / nx - 1 / 3.0) * cell;
            const double dx = fmin(fabs(x), 1 - fabs(x)), dy = fmin(fabs(y), 0.8 - fabs(y));
            const double diff = u[v] - len_circle(t, 1, x) * len_circle(t, 0.8, y);
            off += diff * diff / n;
            geo += fabs(d[v] - hypot(dx, dy)) / n;
        }
        heat_off[level] = sqrt(off);
        CHECK_MSG(geo < 0.6 * cell, "flat torus: geodesics are off by %g edges", geo / cell);
        hd_geodesic_free(g);
    }
    CHECK_MSG(heat_off[0] / heat_off[1] > 3.6 && heat_off[1] / heat_off[2] > 3.9, "flat torus: heat is off by %g %g %g", heat_off[0], heat_off[1], heat_off[2]);
}

/* ---- geodesics as in space ---- */

static void len_geodesic(void) {
    shape s = kit_own_shape(shape_bumpy(3, 5));
    const int32_t sources[2] = {3, 200};
    const double unit = 1e-40;
    double *len = len_of(&s, unit), *a = KIT_NEW(double, s.n), *b = KIT_NEW(double, s.n);
    hd_geodesic *space = src_geodesic(&s, 0), *g = NULL;
    int32_t v;
    double off = 0;
    CHECK(hd_geodesic_create(&g, MESH_LENGTHS(len, s.n, s.tri, s.n_tri), NULL, NULL) == HD_OK);
    CHECK(hd_geodesic_distance(space, TOGETHER(2, sources), a, 0, NULL, NULL) == HD_OK &&
        hd_geodesic_distance(g, TOGETHER(2, sources), b, 0, NULL, NULL) == HD_OK);
    for (v = 0; v < s.n; v++) off = fmax(off, fabs(a[v] - b[v] / unit));
    CHECK_MSG(off < 1e-10, "geodesics by lengths are off by %g", off);
    hd_geodesic_free(space);
    hd_geodesic_free(g);
    free(len);
}

/* ---- bad input ---- */

static void len_refused(const double *len, const shape *s, const hd_laplacian_opts *o, hd_status want, int64_t face, const char *text) {
    hd_laplacian *lap = NULL;
    hd_geodesic *g = NULL;
    hd_error e;
    const hd_status st = hd_laplacian_create(&lap, MESH_LENGTHS(len, s->n, s->tri, s->n_tri), o, &e);
    CHECK_MSG(st == want && !lap && e.face == face && strstr(e.text, text) != NULL, "%s: %s, %s, face %d", text, hd_status_name(st), e.text, (int)e.face);
    if (!o) CHECK(hd_geodesic_create(&g, MESH_LENGTHS(len, s->n, s->tri, s->n_tri), NULL, &e) == want && !g && e.face == face);
}

static void len_errors(void) {
    shape s = kit_own_shape(shape_grid(5, 4, 0.2));
    double *len = len_of(&s, 1), was;
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_POLYGON, HD_BORDER_NATURAL, 0, NULL);
    hd_geodesic_opts go;
    hd_geodesic *g = NULL;
    hd_laplacian *lap = NULL;
    hd_error e;
    len_refused(len, &s, &o, HD_ERR_ARGUMENT, -1, "kind");
    o.kind = HD_LAPLACIAN_FEM;
    o.updatable = 1;
    len_refused(len, &s, &o, HD_ERR_ARGUMENT, -1, "updatable");
    memset(&go, 0, sizeof go);
    go.updatable = 1;
    CHECK(hd_geodesic_create(&g, MESH_LENGTHS(len, s.n, s.tri, s.n_tri), &go, &e) == HD_ERR_ARGUMENT && !g);
    go.updatable = 0;
    go.ordering = HD_ORDERING_NESTED_DISSECTION;
    CHECK(hd_geodesic_create(&g, MESH_LENGTHS(len, s.n, s.tri, s.n_tri), &go, &e) == HD_ERR_ARGUMENT && !g && strstr(e.text, "coordinates"));
    len_refused(NULL, &s, NULL, HD_ERR_ARGUMENT, -1, "NULL");
    was = len[3 * 7 + 2];
    len[3 * 7 + 2] = NAN;
    len_refused(len, &s, NULL, HD_ERR_NOT_FINITE, 7, "not finite");
    len[3 * 7 + 2] = -was;
    len_refused(len, &s, NULL, HD_ERR_ARGUMENT, 7, "negative");
    len[3 * 7 + 2] = (len[3 * 7] + len[3 * 7 + 1]) * (1 + 1e-12);
    len_refused(len, &s, NULL, HD_ERR_ARGUMENT, 7, "longer than");
    CHECK(hd_laplacian_create(&lap, MESH_LENGTHS(len, s.n, s.tri, s.n_tri), NULL, &e) == HD_ERR_ARGUMENT && e.value == len[3 * 7 + 2]);
    len[3 * 7 + 2] = was * (1 + 1e-11);
    CHECK(hd_laplacian_create(&lap, MESH_LENGTHS(len, s.n, s.tri, s.n_tri), NULL, &e) == HD_ERR_ARGUMENT && strstr(e.text, "different lengths") && e.face >= 0 &&
          (s.tri[3 * 7 + 2] == e.vertex || s.tri[3 * 7] == e.vertex) && (e.value == len[3 * 7 + 2] || e.value == was));
    len[3 * 7 + 2] = was * (1 + 1e-13);          /* that is rounding */
    lap = len_make(len, s.n, s.tri, s.n_tri, NULL);
    CHECK(hd_laplacian_update(lap, MESH_POINTS(s.xyz, lap->n), &e) == HD_ERR_ARGUMENT);
    lap = NULL;
    len[3 * 7 + 2] = was;
    s.tri[4] = s.n;
    len_refused(len, &s, NULL, HD_ERR_INDEX, 1, "vertex");
    s.tri[4] = 0;
    CHECK(hd_laplacian_create(&lap, MESH_LENGTHS(len, s.n, s.tri, 0), NULL, &e) == HD_ERR_EMPTY && hd_laplacian_create(&lap, MESH_LENGTHS(len, s.n, s.tri, -1), NULL, &e) == HD_ERR_ARGUMENT);
    free(len);
}

/* A face whose sides lie on each other has no area, and is left out. */
static void len_flat_face(void) {
    const int32_t tri[6] = {0, 1, 2, 1, 0, 3};
    const double len[6] = {2, 2, 2, 2, 1.5, 0.5};
    hd_laplacian *lap = len_make(len, 4, tri, 2, NULL);
    CHECK(lap->mesh.n_zero_area == 1 && lap->mesh.n_faces_used == 1 && lap->n_active == 3 && lap->mesh.n_inert == 1 && fabs(lap->area - sqrt(3)) < 1e-15);
}

static void test_lengths(void) {
    len_operators();
    len_book();
    len_rings();
    len_seven();
    len_smooth();
    len_geodesic();
    len_errors();
    len_flat_face();
}

#endif
