/* test_borders.h - vertices held at zero: the pair that is left, every query against dense eigensolutions, and closed forms */

#ifndef TEST_BORDERS_H
#define TEST_BORDERS_H

#define BORD_PI 3.14159265358979323846

/* ---- which vertices, and what is left of the pair ---- */

/* Ends of edges with one face, by comparing all edges of all faces. ptr NULL: triangles. */
static char *bord_ends(int32_t n, const int64_t *ptr, const int32_t *idx, int32_t m) {
    char *mark = DENSE_NEW(char, n);
    int32_t f, g;
    int64_t c, d;
    for (f = 0; f < m; f++) {
        const int64_t b = ptr ? ptr[f] : 3 * f, e = ptr ? ptr[f + 1] : 3 * f + 3;
        for (c = b; c < e; c++) {
            const int32_t i = idx[c], j = idx[c + 1 < e ? c + 1 : b];
            int faces = 0;
            for (g = 0; g < m; g++) {
                const int64_t gb = ptr ? ptr[g] : 3 * g, ge = ptr ? ptr[g + 1] : 3 * g + 3;
                for (d = gb; d < ge; d++) {
                    const int32_t k = idx[d], l = idx[d + 1 < ge ? d + 1 : gb];
                    faces += (k == i && l == j) || (k == j && l == i);
                }
            }
            if (faces == 1) mark[i] = mark[j] = 1;
        }
    }
    return mark;
}

/* Is lap the natural one without the vertices in mark? */
static void bord_check_pair(const hd_laplacian *lap, const hd_laplacian *all, const char *mark, const char *what) {
    const int32_t n = lap->n, m = all->n_active;
    double *L = test_dense(&all->L, NULL), *B = test_dense_mass(all), *Lh = test_dense(&lap->L, NULL), *Bh = test_dense_mass(lap), off = 0;
    char *leaks = DENSE_NEW(char, lap->n_components);
    int32_t v, i, j, row = 0, held = 0, n_leaks = 0;
    for (v = 0; v < n; v++) {
        const int32_t want = mark[v] ? HD_ROW_HELD : all->row[v] < 0 ? HD_ROW_INERT : row++;
        held += mark[v];
        CHECK_MSG(lap->row[v] == want && (want < 0 || lap->vertex[want] == v), "%s: vertex %d has row %d, not %d", what, v, lap->row[v], want);
    }
    CHECK_MSG(lap->n_active == row && lap->n_held == held && all->n_held == 0 && lap->mesh.n_inert == all->mesh.n_inert, "%s: %d rows, %d held", what,
              lap->n_active, lap->n_held);
    CHECK(!lap->B == !all->B && lap->area == all->area && lap->h == all->h && lap->b_ratio == all->b_ratio && lap->holding == NULL);
    for (i = 0; i < row; i++) {
        const int32_t from = all->row[lap->vertex[i]];
        double mass = 0;
        for (j = 0; j < row; j++) {
            const size_t at = (size_t)i * (size_t)row + (size_t)j, was = (size_t)from * (size_t)m + (size_t)all->row[lap->vertex[j]];
            off = fmax(off, fmax(fabs(Lh[at] - L[was]), fabs(Bh[at] - B[was])));
            mass += B[was];
        }
        for (v = 0; v < n; v++)
            if (mark[v] && all->row[v] >= 0) leaks[lap->component[i]] = (char)(leaks[lap->component[i]] || L[(size_t)from * (size_t)m + (size_t)all->row[v]] != 0);
        CHECK(fabs(lap->mass[i] - mass) <= 1e-14 * mass && lap->b_diag[i] == B[(size_t)from * (size_t)m + (size_t)from]);
        if (lap->xyz) CHECK(memcmp(lap->xyz + 3 * i, all->xyz + 3 * from, 3 * sizeof(double)) == 0);
    }
    CHECK_MSG(off == 0, "%s: L and B are off by %g", what, off);
    for (i = 0; i < lap->n_components; i++) n_leaks += leaks[i];
    CHECK_MSG(lap->conserves == (!all->conserves || n_leaks == lap->n_components ? 0 : n_leaks > 0 ? 2 : 1), "%s: conserves %d", what, (int)lap->conserves);
    for (i = 0; i < lap->n_components; i++) CHECK((lap->component_mass[i] == HUGE_VAL) == (lap->conserves == 2 && leaks[i]));
    free(leaks);
    free(L);
    free(B);
    free(Lh);
    free(Bh);
}

static hd_laplacian_opts bord_opts(hd_laplacian_kind kind, hd_border border, int32_t n_held, const int32_t *held) {
    hd_laplacian_opts o;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.border = border;
    o.n_held = n_held;
    o.held = held;
    return o;
}

static hd_laplacian *bord_triangles(const shape *s, const hd_laplacian_opts *o) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, o, &e) == HD_OK, "%s", e.text);
    return lap;
}

/* The disk of rings 0..m with 6 k vertices each: in the plane, or over the upper half of the unit sphere. */
static shape bord_disk(int32_t m, int round) {
    shape s = shape_make(1 + 3 * (int64_t)m * (m + 1), 6 * (int64_t)m * m);
    int32_t k, q, t = 0;
    shape_put_vertex(&s, 0, 0, 0, round);
    for (k = 1; k <= m; k++) {
        const int32_t first = 1 + 3 * k * (k - 1), inner = k > 1 ? 1 + 3 * (k - 1) * (k - 2) : 0, n = 6 * k, n_in = k > 1 ? 6 * (k - 1) : 1;
        const double r = (double)k / m, x = round ? sin(r * BORD_PI / 2) : r, z = round ? cos(r * BORD_PI / 2) : 0;
        for (q = 0; q < n; q++) {
            const int32_t a = first + q, b = first + (q + 1) % n, side = q / k, at = q % k, c = inner + (side * (k - 1) + at) % n_in;
            shape_put_vertex(&s, a, x * cos(2 * BORD_PI * q / n), x * sin(2 * BORD_PI * q / n), z);
            shape_put_triangle(&s, t++, a, b, c);
            if (at > 0) shape_put_triangle(&s, t++, a, c, inner + (side * (k - 1) + at - 1) % n_in);
        }
    }
    CHECK(t == s.n_tri);
    return s;
}

static void bord_pairs_triangles(void) {
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    const int32_t held[4] = {17, 3, 17, 40};
    shape s[4], disk = bord_disk(4, 1), grid = shape_grid(9, 7, 0.3);
    const double apart[3] = {5, 0, 0};
    int32_t k, q, w, i;
    s[0] = disk;
    s[1] = grid;
    s[2] = eng_with_inert(&disk);
    s[3] = shape_disjoint(&disk, &grid, apart);
    for (k = 0; k < 4; k++) {
        char *ends = bord_ends(s[k].n, NULL, s[k].tri, s[k].n_tri), *listed = DENSE_NEW(char, s[k].n);
        for (q = 0; q < 3; q++) listed[held[q + 1]] = 1;
        for (q = 0; q < 3; q++) {
            for (w = 0; w < 3; w++) {            /* as it is, intrinsic Delaunay, tufted */
                hd_laplacian_opts o = bord_opts(kinds[q], HD_BORDER_NATURAL, 0, NULL);
                hd_laplacian *all, *lap;
                char what[60];
                snprintf(what, sizeof what, "shape %d, kind %d, way %d", k, q, w);
                o.intrinsic_delaunay = w == 1;
                o.tufted = w == 2;
                all = bord_triangles(s + k, &o);
                o.border = HD_BORDER_DIRICHLET;
                lap = bord_triangles(s + k, &o);
                bord_check_pair(lap, all, ends, what);
                CHECK(lap->conserves == 0 && lap->n_components == all->n_components);
                hd_laplacian_free(lap);
                o.border = HD_BORDER_NATURAL;
                o.n_held = 4;
                o.held = held;
                lap = bord_triangles(s + k, &o);
                bord_check_pair(lap, all, listed, what);
                hd_laplacian_free(lap);
                hd_laplacian_free(all);
            }
        }
        for (i = 0; i < s[k].n; i++) ends[i] = (char)(ends[i] | listed[i]);   /* both together */
        {
            hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 4, held);
            hd_laplacian *lap = bord_triangles(s + k, &o), *all = bord_triangles(s + k, NULL);
            bord_check_pair(lap, all, ends, "both");
            hd_laplacian_free(lap);
            hd_laplacian_free(all);
        }
        free(ends);
        free(listed);
    }
    for (k = 0; k < 4; k++) shape_free(s + k);
}

/* A line of held vertices splits a component in two. */
static void bord_split(void) {
    shape s = shape_grid(9, 5, 0);
    int32_t held[5], q;
    hd_laplacian_opts o;
    hd_laplacian *lap;
    for (q = 0; q < 5; q++) held[q] = 9 * q + 4;
    o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 5, held);
    lap = bord_triangles(&s, &o);
    CHECK(lap->n_components == 2 && lap->n_active == 40 && lap->component[0] == 0 && lap->component[4] == 1);
    CHECK(fabs(lap->component_mass[0] - lap->component_mass[1]) <= 0.05 * lap->component_mass[0]);   /* the diagonals all lean to one side */
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* Masses of components by the order of those that have rows: the first is held altogether; of the third a vertex is held (which conserves nothing
 * there), and then none. */
static void bord_masses(void) {
    shape ball = shape_icosphere(1), disk = bord_disk(5, 0), small = bord_disk(3, 0);
    const double apart[3] = {4, 1, 0}, further[3] = {9, 1, 0};
    shape two = shape_disjoint(&ball, &disk, apart), three = shape_disjoint(&two, &small, further);
    int32_t *held = DENSE_NEW(int32_t, ball.n + 1), q, more, round;
    double *xyz = DENSE_NEW(double, 3 * (int64_t)three.n);
    for (q = 0; q < ball.n; q++) held[q] = q;
    held[ball.n] = two.n;
    for (more = 1; more >= 0; more--) {
        hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_VORONOI_COT, HD_BORDER_NATURAL, ball.n + more, held);
        hd_laplacian *lap;
        o.updatable = 1;
        lap = bord_triangles(&three, &o);
        for (round = 0; round < 2; round++) {    /* the second time all is of three times the size */
            double mass[2] = {0, 0};
            CHECK(lap->n_components == 2 && lap->conserves == 1 + more);
            for (q = 0; q < lap->n_active; q++) mass[lap->component[q]] += lap->mass[q];
            if (more) mass[1] = HUGE_VAL;
            for (q = 0; q < 2; q++)
                CHECK_MSG(fabs(lap->component_mass[q] - mass[q]) < 1e-13 || lap->component_mass[q] == mass[q], "component %d: %g, not %g", (int)q,
                          lap->component_mass[q], mass[q]);
            for (q = 0; q < 3 * three.n; q++) xyz[q] = 3 * three.xyz[q];
            CHECK(hd_laplacian_update(lap, xyz, NULL) == HD_OK);
        }
        hd_laplacian_free(lap);
    }
    shape_free(&ball);
    shape_free(&disk);
    shape_free(&small);
    shape_free(&two);
    shape_free(&three);
    free(held);
    free(xyz);
}

static void bord_pairs_polygons(void) {
    shape_poly s = shape_trominoes(3, 3, 0.1);
    char *ends = bord_ends(s.n, s.face_ptr, s.face_idx, s.n_faces);
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_POLYGON, HD_BORDER_DIRICHLET, 0, NULL);
    hd_laplacian *lap = NULL, *all = mov_polygons(&s, s.xyz, HD_LAPLACIAN_POLYGON, 0, NULL);
    hd_error e;
    CHECK_MSG(hd_laplacian_polygons(&lap, s.xyz, s.n, s.face_ptr, s.face_idx, s.n_faces, &o, &e) == HD_OK, "%s", e.text);
    bord_check_pair(lap, all, ends, "polygons");
    hd_laplacian_free(lap);
    hd_laplacian_free(all);
    free(ends);
    shape_poly_free(&s);
}

static void bord_pairs_points(void) {
    shape s = shape_icosphere(2);
    const int32_t held[3] = {5, 60, 161};
    char *mark = DENSE_NEW(char, s.n);
    hd_laplacian *lap = NULL, *all = NULL;
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_NATURAL, 3, held), none = o;
    hd_csr B;
    int q;
    none.n_held = 0;
    for (q = 0; q < 3; q++) mark[held[q]] = 1;
    CHECK(hd_laplacian_points(&lap, s.xyz, s.n, &o, NULL) == HD_OK && hd_laplacian_points(&all, s.xyz, s.n, &none, NULL) == HD_OK);
    bord_check_pair(lap, all, mark, "points");
    hd_laplacian_free(lap);
    hd_laplacian_free(all);
    CHECK(hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &o, NULL) == HD_OK &&
          hd_laplacian_tufted_points(&all, s.xyz, s.n, NULL, NULL, &none, NULL) == HD_OK);
    bord_check_pair(lap, all, mark, "tufted points");
    hd_laplacian_free(lap);
    B = all->L;
    B.val = all->B;
    CHECK(hd_laplacian_matrices(&lap, &all->L, &B, all->h, &o, NULL) == HD_OK);
    {
        hd_laplacian *same = NULL;
        CHECK(hd_laplacian_matrices(&same, &all->L, &B, all->h, NULL, NULL) == HD_OK);
        bord_check_pair(lap, same, mark, "matrices");
        hd_laplacian_free(same);
    }
    hd_laplacian_free(lap);
    hd_laplacian_free(all);
    free(mark);
    shape_free(&s);
}

/* ---- queries, against dense eigensolutions of what is left ---- */

/* sum_k g_k x_k(i) x_k(j); zero at vertices without a row. */
static double bord_form(const heat_case *c, const double *x, const double *g, int32_t i, int32_t j) {
    const int32_t n = c->lap->n_active, a = c->lap->row[i], b = c->lap->row[j];
    double sum = 0;
    int32_t k;
    for (k = 0; k < n && a >= 0 && b >= 0; k++) sum += g[k] * x[(size_t)k * (size_t)n + (size_t)a] * x[(size_t)k * (size_t)n + (size_t)b];
    return sum;
}

/* x, or B x by rows. */
static double *bord_vectors(const heat_case *c, int mass) {
    const int32_t n = c->lap->n_active;
    double *x = DENSE_NEW(double, (int64_t)n * n);
    int32_t k;
    for (k = 0; k < n; k++) {
        const double *from = c->pair.x + (size_t)k * (size_t)n;
        if (mass) dense_apply(c->pair.B, from, x + (size_t)k * (size_t)n, n);
        else memcpy(x + (size_t)k * (size_t)n, from, (size_t)n * sizeof *x);
    }
    return x;
}

static double *bord_weights(const heat_case *c, hd_distance_kind kind, double t) {
    double *g = DENSE_NEW(double, c->lap->n_active);
    int32_t k;
    for (k = 0; k < c->lap->n_active; k++) {
        const double l = c->pair.lambda[k];
        g[k] = kind == HD_DISTANCE_COMMUTE ? 1 / l : kind == HD_DISTANCE_BIHARMONIC ? 1 / (l * l) : exp(-t * l);
    }
    return g;
}

/* Columns of sources that are held are zero, and so is every answer at held vertices. */
static void bord_held_zero(const hd_laplacian *lap, const double *u, int32_t count, const char *what) {
    int32_t q, v;
    for (q = 0; q < count; q++)
        for (v = 0; v < lap->n; v++)
            if (lap->row[v] == HD_ROW_HELD) CHECK_MSG(u[(size_t)q * (size_t)lap->n + (size_t)v] == 0, "%s: vertex %d is held and has %g", what, v, u[q * lap->n + v]);
}

static void bord_columns(const heat_case *c, hd_method method, double t, int32_t held) {
    const hd_heat_opts o = eng_opts(method);
    hd_heat *heat = eng_create(c->lap, &o);
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, sources[3] = {lap->vertex[lap->n_active / 2], held, lap->vertex[0]};
    double *u = DENSE_NEW(double, 6 * n), *f = DENSE_NEW(double, n);
    const double times[2] = {0, t};
    hd_report rep;
    uint64_t seed = 3;
    int32_t v;
    int k;
    heat_against_dense(c, heat, t);
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(eng_ok(hd_heat_columns(heat, kernel, 2, times, 3, sources, u, 0, &rep, NULL), &rep, c->what));
        bord_held_zero(lap, u, 6, "columns");
        for (v = 0; v < n; v++) CHECK(u[2 * n + v] == 0 && u[3 * n + v] == 0 && (k || u[v] == (v == sources[0])));
    }
    for (v = 0; v < n; v++) f[v] = dense_signed(&seed);
    CHECK(eng_ok(hd_heat_apply(heat, 2, times, 1, f, 0, u, 0, &rep, NULL), &rep, c->what));
    bord_held_zero(lap, u, 2, "a field");
    for (v = 0; v < n; v++) CHECK(lap->row[v] == HD_ROW_HELD || u[v] == f[v]);
    CHECK(eng_ok(heat_apply(heat, t, 1, f, 0, f, 0, &rep), &rep, c->what) && memcmp(f, u + n, (size_t)n * sizeof *f) == 0);   /* in place */
    for (v = 0; v < n; v++) CHECK(lap->row[v] != HD_ROW_INERT || u[n + v] == u[v]);
    hd_heat_free(heat);
    free(u);
    free(f);
}

/* Diagonals, entries and edges of both kernels. */
static void bord_diagonals(const heat_case *c, hd_heat *heat, const double *t, int32_t n_times, int32_t held) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, far_one = lap->vertex[lap->n_active - 1];
    const int32_t i[4] = {held, far_one, lap->vertex[0], held}, j[4] = {held, held, far_one, far_one};
    double *d = DENSE_NEW(double, n_times * n), value[16], *edges = DENSE_NEW(double, lap->L.nnz), *x = bord_vectors(c, 0), *y = bord_vectors(c, 1);
    hd_report rep;
    int32_t m, v, q;
    int k;
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(eng_ok(hd_heat_diagonal(heat, kernel, n_times, t, d, 0, &rep, NULL), &rep, c->what));
        bord_held_zero(lap, d, n_times, "diagonal");
        for (m = 0; m < n_times; m++) {
            double *g = bord_weights(c, HD_DISTANCE_CLASSICAL, t[m]), worst = 0;
            for (v = 0; v < n; v++) {
                const int32_t a = lap->row[v];
                double want = lap->row[v] == HD_ROW_INERT && !k;
                for (q = 0; q < lap->n_active && a >= 0; q++) {
                    const size_t at = (size_t)q * (size_t)lap->n_active + (size_t)a;
                    want += g[q] * x[at] * (k ? x[at] : y[at]);
                }
                if (a >= 0 && fabs(want) > 1e-250) worst = fmax(worst, fabs(d[m * n + v] - want) / want);
                else CHECK(d[m * n + v] == want || a >= 0);
            }
            CHECK_MSG(worst <= rep.error_relative + 1e-9, "%s, t %g: diagonal off by %g, bound %g", c->what, t[m], worst,
                      rep.error_relative);
            free(g);
        }
        CHECK(eng_ok(hd_heat_entries(heat, kernel, 1, t, 4, i, j, value, &rep, NULL), &rep, c->what));
        CHECK(value[0] == 0 && value[1] == 0 && value[3] == 0);
        {
            double *g = bord_weights(c, HD_DISTANCE_CLASSICAL, t[0]), want = 0;
            const size_t a = (size_t)lap->row[i[2]], b = (size_t)lap->row[j[2]];
            for (q = 0; q < lap->n_active; q++) want += g[q] * x[(size_t)q * (size_t)lap->n_active + a] * (k ? x : y)[(size_t)q * (size_t)lap->n_active + b];
            CHECK_MSG(fabs(value[2] - want) <= rep.error_bound * fabs(value[2]) + 1e-12 * fabs(value[2]) + 1e-14 / lap->mass[0], "%s: entry %g for %g, bound %g", c->what,
                      value[2], want, rep.error_bound);
            free(g);
        }
    }
    CHECK(eng_ok(heat_edges(heat, t[0], edges, &rep), &rep, c->what));
    {
        double *g = bord_weights(c, HD_DISTANCE_CLASSICAL, t[0]), worst = 0;
        int64_t p;
        for (v = 0; v < lap->n_active; v++)
            for (p = lap->L.row_ptr[v]; p < lap->L.row_ptr[v + 1]; p++)
                worst = fmax(worst, fabs(edges[p] - bord_form(c, x, g, lap->vertex[v], lap->vertex[lap->L.col[p]])));
        CHECK_MSG(worst <= (rep.error_bound + 1e-12) * dense_max_abs(edges, lap->L.nnz), "%s: edges off by %g of %g, bound %g", c->what, worst,
                  dense_max_abs(edges, lap->L.nnz), rep.error_bound);
        free(g);
    }
    free(d);
    free(edges);
    free(x);
    free(y);
}

/* Distances of all kinds, pairs and samples. */
static void bord_distances(const heat_case *c, hd_heat *heat, const double *t, int32_t n_times, int32_t held) {
    static const hd_distance_kind kinds[4] = {HD_DISTANCE_CLASSICAL, HD_DISTANCE_WEIGHTED, HD_DISTANCE_COMMUTE, HD_DISTANCE_BIHARMONIC};
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, sources[2] = {lap->vertex[lap->n_active / 2], held};
    const int32_t pi[3] = {sources[0], held, held}, pj[3] = {lap->vertex[0], sources[0], held};
    double *d = DENSE_NEW(double, 2 * n_times * n), K[3], pd[3], far_off[5];
    hd_report rep;
    int32_t q, m, r, v, pick[5];
    for (q = 0; q < 4; q++) {
        const int timeless = q > 1;
        double *x = bord_vectors(c, q == 1);
        CHECK(eng_ok(heat_distance(heat, kinds[q], timeless ? 0 : n_times, timeless ? NULL : t, 2, sources, d, 0, &rep), &rep, c->what));
        for (m = 0; m < (timeless ? 1 : n_times); m++) {
            double *g = bord_weights(c, kinds[q], 2 * t[m]);
            for (r = 0; r < 2; r++) {
                const double *of = d + (size_t)(r * (timeless ? 1 : n_times) + m) * (size_t)n, ss = bord_form(c, x, g, sources[r], sources[r]);
                double worst = 0, most = 0;
                for (v = 0; v < n; v++) {
                    const double want = v == sources[r] ? 0 : sqrt(fmax(0, ss + bord_form(c, x, g, v, v) - 2 * bord_form(c, x, g, sources[r], v)));
                    if (timeless && v != sources[r] && (r == 1 || lap->row[v] < 0 || lap->component[lap->row[v]] != lap->component[lap->row[sources[r]]])) {
                        CHECK(of[v] == HUGE_VAL);            /* held vertices are in no component */
                        continue;
                    }
                    worst = fmax(worst, fabs(of[v] - want));
                    most = fmax(most, want);
                }
                CHECK_MSG(worst <= (rep.error_bound + 1e-10) * most && rep.error_bound < 1e-4, "%s, distance %d, t %g, source %d: off by %g of %g, bound %g", c->what, q, t[m], r,
                          worst, most, rep.error_bound);
            }
            free(g);
        }
        CHECK(eng_ok(heat_pairs(heat, kinds[q], timeless ? 0 : t[0], 3, pi, pj, K, pd, &rep), &rep, c->what));
        CHECK(pd[2] == 0 && (timeless ? pd[1] == HUGE_VAL : pd[1] > 0 && K[1] == 0 && K[2] == 0));
        free(x);
    }
    CHECK(eng_ok(heat_sample(heat, HD_DISTANCE_CLASSICAL, t[0], 5, 0, pick, far_off, &rep), &rep, c->what));
    for (v = 0; v < 5; v++) CHECK(lap->row[pick[v]] >= 0);
    free(d);
}

static double bord_least(const double *x, int32_t n) {
    double least = x[0];
    int32_t i;
    for (i = 1; i < n; i++) least = fmin(least, x[i]);
    return least;
}

/* Pairs whose columns are all zero, at a time when nothing is known of columns any more: exact, and no NaN in the report. */
static void bord_faded_pairs(const heat_case *c, hd_heat *heat, int32_t held) {
    const int32_t i[2] = {held, held}, j[2] = {held, held + 1};
    const double t = 60 / bord_least(c->pair.lambda, c->lap->n_active);
    double K[2], d[2];
    hd_report rep;
    int q;
    for (q = 0; q < 2; q++) {
        const hd_distance_kind kind = q ? HD_DISTANCE_WEIGHTED : HD_DISTANCE_CLASSICAL;
        CHECK(c->lap->row[held] == HD_ROW_HELD && heat_pairs(heat, kind, t, 1, i, j, K, d, &rep) >= 0 && K[0] == 0 && d[0] == 0 && rep.error_bound == 0);
        CHECK(heat_pairs(heat, kind, t, 2, i, j, K, d, &rep) >= 0 && rep.error_bound >= 0);
    }
}

/* Truncated kernels of all eigenpairs, and shifted systems. */
static void bord_spectrum(const heat_case *c, double t, int32_t held) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n, sources[2] = {lap->vertex[1], held};
    hd_spectrum *s = spec_make(lap, lap->n_active, 0, HD_OK);
    double *u = DENSE_NEW(double, 2 * n), *bound = DENSE_NEW(double, 2 * n), *x = bord_vectors(c, 0), *g = bord_weights(c, HD_DISTANCE_CLASSICAL, t), off = 0;
    int32_t v;
    CHECK(s && s->proven && s->n_constant == 0);
    for (v = 0; v < s->count; v++) bord_held_zero(lap, s->vector + (size_t)v * (size_t)n, 1, "an eigenvector");
    CHECK(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, &t, 2, sources, u, bound, 0, NULL) == HD_OK);
    bord_held_zero(lap, u, 2, "truncated column");
    for (v = 0; v < n; v++) CHECK(u[n + v] == 0 && bound[n + v] == 0);
    CHECK(hd_spectrum_diagonal(s, HD_KERNEL_OPERATOR, 1, &t, u, NULL, 0, NULL) == HD_OK);
    for (v = 0; v < n; v++) CHECK(lap->row[v] >= 0 || u[v] == (lap->row[v] == HD_ROW_INERT));
    CHECK(hd_spectrum_diagonal(s, HD_KERNEL_SYMMETRIC, 1, &t, u, NULL, 0, NULL) == HD_OK);
    for (v = 0; v < n; v++) off = fmax(off, fabs(u[v] - bord_form(c, x, g, v, v)));
    CHECK_MSG(off <= 1e-9 * dense_max_abs(u, n), "%s: truncated diagonal off by %g", c->what, off);
    CHECK(hd_spectrum_distance(s, HD_DISTANCE_CLASSICAL, 1, &t, 1, sources + 1, u, NULL, 0, NULL) == HD_OK);
    free(g);
    g = bord_weights(c, HD_DISTANCE_CLASSICAL, 2 * t);
    for (off = 0, v = 0; v < n; v++) off = fmax(off, fabs(u[v] - sqrt(bord_form(c, x, g, v, v))));
    CHECK_MSG(off <= 1e-8 * dense_max_abs(u, n), "%s: truncated distance from a held vertex off by %g", c->what, off);
    hd_spectrum_free(s);
    free(u);
    free(bound);
    free(x);
    free(g);
}

/* Every query, in methods and kinds; the second case has a component that keeps its heat. */
static void bord_queries(void) {
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    shape disk = bord_disk(6, 1), odd = eng_with_inert(&disk);
    int32_t q, m;
    for (q = 0; q < 3; q++) {
        const hd_laplacian_opts o = bord_opts(kinds[q], HD_BORDER_DIRICHLET, 0, NULL);
        hd_laplacian *lap = bord_triangles(&odd, &o);
        heat_case c = heat_case_of(lap, "held border");
        const double unit = kinds[q] == HD_LAPLACIAN_COT ? 1 : lap->h * lap->h, t[4] = {unit, 3 * unit, 10 * unit, 20 * unit};
        const int32_t held = odd.n - 4;
        hd_heat *heat = eng_create(lap, NULL);
        CHECK(lap->row[held] == HD_ROW_HELD && lap->mesh.n_inert > 0);
        for (m = 0; m < 3; m++) bord_columns(&c, methods[m], t[m], held);
        bord_diagonals(&c, heat, t, 1, held);
        bord_diagonals(&c, heat, t, 4, held);
        bord_distances(&c, heat, t, 1, held);
        bord_distances(&c, heat, t, 4, held);
        bord_spectrum(&c, t[1], held);
        bord_faded_pairs(&c, heat, held);
        hd_heat_free(heat);
        heat_case_free(&c);
    }
    shape_free(&disk);
    shape_free(&odd);
}

/* At a time when only means are left: of the component that keeps its heat. */
static void bord_mixed_late(const hd_laplacian *lap, int32_t n_first) {
    const double t = 1e11 * lap->h * lap->h;
    const int32_t sources[2] = {2, n_first + 11};
    hd_heat *heat = eng_create(lap, NULL);
    double *u = DENSE_NEW(double, 2 * lap->n), off = 0, most = 0;
    hd_report rep;
    int32_t v;
    CHECK(lap->component_mass[0] == HUGE_VAL && hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t, 2, sources, u, 0, &rep, NULL) >= 0);
    for (v = 0; v < lap->n; v++) {
        off = fmax(off, fmax(fabs(u[v]), fabs(u[lap->n + v] - (v < n_first ? 0 : 1 / lap->component_mass[1]))));
        most = fmax(most, u[lap->n + v]);
    }
    CHECK_MSG(off <= 1e-10 * most && off <= (rep.error_bound + 1e-13) * most, "late columns: off by %g of %g, bound %g", off, most, rep.error_bound);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, u, 0, &rep, NULL) >= 0);
    for (off = 0, v = 0; v < lap->n; v++) off = fmax(off, fabs(u[v] - (v < n_first ? 0 : 1 / lap->component_mass[1])));
    CHECK_MSG(off <= 1e-10 * most && off <= (rep.error_bound + 1e-13) * most, "late diagonal: off by %g of %g, bound %g", off, most, rep.error_bound);
    hd_heat_free(heat);
    free(u);
}

/* One component is held, the other one is not: bounds hold, and the other one keeps its heat. */
static void bord_mixed(void) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    shape disk = bord_disk(5, 0);
    const double apart[3] = {3, 0, 0}, factors[3] = {1, 30, 1000};
    shape two = shape_disjoint(&disk, &disk, apart);
    int32_t m, k, v, held = 7;
    const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 1, &held);
    heat_case c = heat_case_of(bord_triangles(&two, &o), "one of two held");
    const hd_laplacian *lap = c.lap;
    double *u = DENSE_NEW(double, two.n);
    CHECK(lap->n_components == 2 && lap->conserves == 2);
    for (m = 0; m < 3; m++) {
        const hd_heat_opts ho = eng_opts(methods[m]);
        hd_heat *heat = eng_create(lap, &ho);
        for (k = 0; k < 3; k++) {
            const double t = factors[k] * lap->h * lap->h;
            const int32_t source = disk.n + 11;
            double sum = 0;
            hd_report rep;
            heat_against_dense(&c, heat, t);
            CHECK(heat_column(heat, t, source, u, &rep) >= 0);
            for (v = disk.n; v < two.n; v++) sum += lap->mass[lap->row[v]] * u[v];
            sum /= lap->mass[lap->row[source]];
            CHECK_MSG(fabs(sum - 1) <= 1e-12 && rep.mass_drift <= 1e-12, "method %d, t %g: heat is 1 + %g, drift %g", m, t, sum - 1, rep.mass_drift);
            for (v = 0; v < disk.n; v++) CHECK(u[v] == 0);
        }
        hd_heat_free(heat);
    }
    bord_mixed_late(lap, disk.n);
    free(u);
    heat_case_free(&c);
    shape_free(&disk);
    shape_free(&two);
}

/* ---- closed forms ---- */

static double bord_bessel0(double x) {
    double term = 1, sum = 1;
    int k;
    for (k = 1; k < 40; k++) sum += term *= -x * x / (4.0 * k * k);
    return sum;
}

static double bord_mode_square(const double *p) { return sin(BORD_PI * p[0]) * sin(2 * BORD_PI * p[1]); }
static double bord_mode_disk(const double *p) { return bord_bessel0(2.404825557695772769 * sqrt(p[0] * p[0] + p[1] * p[1])); }
static double bord_mode_sphere(const double *p) { return p[2]; }

/* Error of K_t f for an eigenfunction f with this eigenvalue, relative to the answer. */
static double bord_mode_error(const shape *s, hd_laplacian_kind kind, double (*mode)(const double *), double lambda, double t) {
    const hd_laplacian_opts o = bord_opts(kind, HD_BORDER_DIRICHLET, 0, NULL);
    hd_laplacian *lap = bord_triangles(s, &o);
    hd_heat *heat = eng_create(lap, NULL);
    double *f = DENSE_NEW(double, s->n), off = 0;
    hd_report rep;
    int32_t v;
    for (v = 0; v < s->n; v++) f[v] = mode(s->xyz + 3 * v);
    CHECK(eng_ok(heat_apply(heat, t, 1, f, 0, f, 0, &rep), &rep, "a mode"));
    for (v = 0; v < s->n; v++) off = fmax(off, fabs(f[v] * exp(t * lambda) - mode(s->xyz + 3 * v)));
    free(f);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return off;
}

static void bord_modes(void) {
    static const char *const names[3] = {"square", "disk", "hemisphere"};
    static double (*const modes[3])(const double *) = {bord_mode_square, bord_mode_disk, bord_mode_sphere};
    const double lambda[3] = {5 * BORD_PI * BORD_PI, 2.404825557695772769 * 2.404825557695772769, 2};
    int32_t q, w, k;
    for (q = 0; q < 3; q++) {
        for (w = 0; w < 2; w++) {
            double off[2];
            for (k = 0; k < 2; k++) {
                shape s = q == 0 ? shape_grid(k ? 49 : 25, k ? 49 : 25, 0) : bord_disk(k ? 32 : 16, q == 2);
                off[k] = bord_mode_error(&s, w ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, modes[q], lambda[q], 0.3 / lambda[q]);
                shape_free(&s);
            }
            CHECK_MSG(off[1] < 0.01 && log(off[0] / off[1]) / log(2) >= 1.9, "%s, %d: errors %g, %g, order %.2f", names[q], w, off[0], off[1], log(off[0] / off[1]) / log(2));
        }
    }
}

/* The kernel of the square, by sines, and the heat that is left of the field one. */
static void bord_square(void) {
    const double t = 0.02;
    double off[2], heat_off[2], want = 0, left = 0;
    int32_t k, a;
    for (a = 1; a < 60; a += 2) {
        want += 2 * exp(-BORD_PI * BORD_PI * a * a * t);             /* at the middle, in one direction */
        left += 8 / (BORD_PI * BORD_PI * a * a) * exp(-BORD_PI * BORD_PI * a * a * t);
    }
    for (k = 0; k < 2; k++) {
        shape s = shape_grid(k ? 49 : 25, k ? 49 : 25, 0);
        const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 0, NULL);
        hd_laplacian *lap = bord_triangles(&s, &o), *all = bord_triangles(&s, NULL);
        hd_heat *heat = eng_create(lap, NULL);
        const int32_t middle = s.n / 2;
        double *u = DENSE_NEW(double, s.n), sum = 0;
        hd_report rep;
        int32_t v;
        CHECK(eng_ok(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, u, 0, &rep), &rep, "the square"));
        off[k] = fabs(u[middle] / (want * want) - 1);
        for (v = 0; v < s.n; v++) u[v] = 1;
        CHECK(eng_ok(heat_apply(heat, t, 1, u, 0, u, 0, &rep), &rep, "the square") && rep.mass_drift == 0);
        for (v = 0; v < s.n; v++) sum += all->mass[all->row[v]] * u[v];
        heat_off[k] = fabs(sum - left * left);
        free(u);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        hd_laplacian_free(all);
        shape_free(&s);
    }
    CHECK_MSG(off[1] < 0.01 && log(off[0] / off[1]) / log(2) >= 1.9, "kernel of the square: %g, %g", off[0], off[1]);
    CHECK_MSG(heat_off[1] < 0.01 && log(heat_off[0] / heat_off[1]) / log(2) >= 1.9, "heat of the square: %g, %g", heat_off[0], heat_off[1]);
}

/* Eigenvalues on a square: a path of n free nodes has 4 sin^2(k pi / (2 (n + 1))), the square sums of two. */
static void bord_path(void) {
    enum { N = 12 };
    hd_csr L = test_path_csr(N + 2, 0), B = test_diagonal_csr(N + 2, NULL);
    const int32_t ends[2] = {0, N + 1};
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_NATURAL, 2, ends);
    hd_laplacian *lap = NULL;
    hd_spectrum *s;
    int32_t k;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, &o, NULL) == HD_OK);
    s = spec_make(lap, N, 0, HD_OK);
    for (k = 0; k < N; k++) {
        const double want = 4 * pow(sin((k + 1) * BORD_PI / (2 * (N + 1))), 2);
        CHECK_MSG(fabs(s->value[k] - want) <= 1e-13 * 4, "eigenvalue %d of a path: %g for %g", k, s->value[k], want);
    }
    hd_spectrum_free(s);
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
}

/* ---- updates, errors, memory ---- */

static void bord_same(const hd_laplacian *lap, const hd_laplacian *fresh, double tol, const char *what) {
    CHECK(lap->n_active == fresh->n_active && lap->L.nnz == fresh->L.nnz && lap->conserves == fresh->conserves && lap->n_held == fresh->n_held);
    CHECK_MSG(dense_max_diff(lap->L.val, fresh->L.val, lap->L.nnz) <= tol * dense_max_abs(fresh->L.val, lap->L.nnz), "%s: L", what);
    if (lap->B) CHECK_MSG(dense_max_diff(lap->B, fresh->B, lap->L.nnz) <= tol * dense_max_abs(fresh->B, lap->L.nnz), "%s: B", what);
    CHECK_MSG(dense_max_diff(lap->mass, fresh->mass, lap->n_active) <= tol * dense_max_abs(fresh->mass, lap->n_active), "%s: masses", what);
    CHECK(dense_max_diff(lap->b_diag, fresh->b_diag, lap->n_active) <= tol * dense_max_abs(fresh->b_diag, lap->n_active));
    CHECK(dense_max_diff(lap->component_mass, fresh->component_mass, lap->n_components) <= 10 * tol * fresh->area);
    CHECK(fabs(lap->h - fresh->h) <= tol * lap->h && fabs(lap->area - fresh->area) <= 10 * tol * lap->area && lap->b_ratio == fresh->b_ratio);
    if (lap->xyz) CHECK(memcmp(lap->xyz, fresh->xyz, 3 * (size_t)lap->n_active * sizeof(double)) == 0);
}

static void bord_updates(void) {
    shape s = bord_disk(6, 1);
    shape_poly p = shape_poly_of(&s);
    double *xyz = DENSE_NEW(double, 3 * s.n), *u = DENSE_NEW(double, s.n), *want = DENSE_NEW(double, s.n);
    const int32_t held[2] = {2, 9};
    int32_t q, frame;
    for (q = 0; q < 3; q++) {                    /* fem, voronoi-cot, polygon */
        const hd_laplacian_kind kind = q == 0 ? HD_LAPLACIAN_FEM : q == 1 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_POLYGON;
        hd_laplacian_opts o = bord_opts(kind, HD_BORDER_DIRICHLET, 2, held);
        hd_laplacian *lap = NULL, *fresh = NULL;
        hd_heat *heat, *other;
        hd_report rep;
        hd_error e;
        o.updatable = 1;
        CHECK(hd_laplacian_polygons(&lap, s.xyz, p.n, p.face_ptr, p.face_idx, p.n_faces, &o, &e) == HD_OK);
        heat = eng_create(lap, NULL);
        CHECK(heat_column(heat, 3 * lap->h * lap->h, lap->vertex[20], u, &rep) >= 0);
        o.updatable = 0;
        for (frame = 1; frame < 4; frame++) {
            const double t = 3 * lap->h * lap->h;
            mov_bend(&s, 0.2 * frame, xyz);
            CHECK(hd_laplacian_update(lap, xyz, &e) == HD_OK && lap->version == frame);
            CHECK(hd_laplacian_polygons(&fresh, xyz, p.n, p.face_ptr, p.face_idx, p.n_faces, &o, &e) == HD_OK);
            bord_same(lap, fresh, q == 2 ? 0 : 1e-13, "moved");
            other = eng_create(fresh, NULL);
            CHECK(eng_ok(heat_column(heat, t, lap->vertex[20], u, &rep), &rep, "moved") && eng_ok(heat_column(other, t, lap->vertex[20], want, &rep), &rep, "fresh"));
            CHECK(dense_max_diff(u, want, s.n) <= 1e-7 * dense_max_abs(want, s.n));
            hd_heat_free(other);
            hd_laplacian_free(fresh);
        }
        memset(xyz, 0, 3 * (size_t)s.n * sizeof *xyz);       /* no area: refused, and nothing has changed */
        CHECK(hd_laplacian_update(lap, xyz, &e) == HD_ERR_EMPTY && lap->version == 3);
        CHECK(heat_column(heat, 3 * lap->h * lap->h, lap->vertex[20], want, &rep) >= 0);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    shape_free(&s);
    shape_poly_free(&p);
    free(xyz);
    free(u);
    free(want);
}

static void bord_update_matrices(void) {
    shape s = shape_grid(8, 7, 0.2);
    hd_laplacian *mesh = bord_triangles(&s, NULL), *lap = NULL, *fresh = NULL;
    const int32_t held[3] = {0, 20, 33};
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_NATURAL, 3, held);
    hd_csr L = mesh->L, B = mesh->L;
    double *val = DENSE_NEW(double, L.nnz);
    int64_t p;
    B.val = mesh->B;
    o.updatable = 1;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, &o, NULL) == HD_OK);
    for (p = 0; p < L.nnz; p++) val[p] = 2 * L.val[p];
    L.val = val;
    CHECK(hd_laplacian_update_matrices(lap, &L, &B, 3, NULL) == HD_OK && lap->version == 1 && lap->h == 3);
    CHECK(hd_laplacian_matrices(&fresh, &L, &B, 3, &o, NULL) == HD_OK);
    bord_same(lap, fresh, 0, "matrices moved");
    val[0] = -1;                                 /* a negative diagonal entry, of a vertex that is held */
    CHECK(hd_laplacian_update_matrices(lap, &L, &B, 4, NULL) == HD_ERR_NOT_POSITIVE && lap->version == 1);
    bord_same(lap, fresh, 0, "after an error");
    hd_laplacian_free(fresh);
    hd_laplacian_free(lap);
    hd_laplacian_free(mesh);
    free(val);
    shape_free(&s);
}

static void bord_refused(const shape *s, const hd_laplacian_opts *o, hd_status want, const char *what) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, o, &e) == want && !lap, "%s: %s", what, e.text);
}

static void bord_errors(void) {
    shape s = shape_grid(3, 3, 0), ball = shape_icosphere(1);
    int32_t held[9], v;
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 9, held);
    hd_laplacian *lap = NULL;
    hd_csr L = test_path_csr(5, 0), B = test_diagonal_csr(5, NULL);
    hd_error e;
    for (v = 0; v < 9; v++) held[v] = v;
    bord_refused(&s, &o, HD_ERR_EMPTY, "all held");
    held[3] = 9;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &e) == HD_ERR_INDEX && e.row == 3 && e.value == 9);
    held[3] = -1;
    bord_refused(&s, &o, HD_ERR_INDEX, "a negative id");
    o.n_held = -1;
    bord_refused(&s, &o, HD_ERR_ARGUMENT, "a negative count");
    o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 1, NULL);
    bord_refused(&s, &o, HD_ERR_ARGUMENT, "no list");
    o = bord_opts(HD_LAPLACIAN_FEM, (hd_border)2, 0, NULL);
    bord_refused(&s, &o, HD_ERR_ARGUMENT, "an unknown border");
    o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_DIRICHLET, 0, NULL);
    CHECK(hd_laplacian_points(&lap, ball.xyz, ball.n, &o, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(hd_laplacian_tufted_points(&lap, ball.xyz, ball.n, NULL, NULL, &o, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, &o, &e) == HD_ERR_ARGUMENT && !lap);
    lap = bord_triangles(&ball, &o);             /* closed: there is nothing to hold */
    CHECK(lap->n_held == 0 && lap->conserves && lap->n_active == ball.n && !lap->holding);
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    shape_free(&s);
    shape_free(&ball);
}

/* Every allocation fails once; nothing stays behind. */
static void bord_memory(void) {
    shape s = bord_disk(3, 0);
    const int32_t held = 1;
    int64_t fail = 1;
    int done = 0;
    for (; !done && fail < 1000; fail++) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 1, &held);
        hd_laplacian *lap = NULL;
        hd_status st;
        o.context = &ctx;
        o.updatable = (int32_t)(fail % 2);
        m.fail_at = fail;
        st = hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, NULL);
        CHECK(st == HD_OK || st == HD_ERR_MEMORY);
        done = st == HD_OK;
        hd_laplacian_free(lap);
        test_memory_done(&m, &ctx, "held");
    }
    CHECK(done && fail > 20);
    shape_free(&s);
}

static void test_borders(void) {
    bord_pairs_triangles();
    bord_split();
    bord_masses();
    bord_pairs_polygons();
    bord_pairs_points();
    bord_queries();
    bord_mixed();
    bord_modes();
    bord_square();
    bord_path();
    bord_updates();
    bord_update_matrices();
    bord_errors();
    bord_memory();
}

#endif
