/* test_borders.h - vertices held at zero: the pair that is left, every query against the truth, and closed forms */

#ifndef TEST_BORDERS_H
#define TEST_BORDERS_H

#define BORD_PI 3.14159265358979323846

/* ---- which vertices, and what is left of the pair ---- */

/* Ends of edges with one face, by comparing all edges of all faces. ptr NULL: triangles. */
static char *bord_ends(int32_t n, const int64_t *ptr, const int32_t *idx, int32_t m) {
    char *mark = KIT_NEW(char, n);
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
    const int32_t n = lap->n, m = all->n_active, mark_kit = kit_mark();
    double *L = (double *)kit_keep(test_dense(&all->L, NULL), free), *B = (double *)kit_keep(test_dense_mass(all), free), off = 0;
    double *Lh = (double *)kit_keep(test_dense(&lap->L, NULL), free), *Bh = (double *)kit_keep(test_dense_mass(lap), free);
    char *leaks = KIT_NEW(char, lap->n_components);
    int32_t v, i, j, row = 0, held = 0, n_leaks = 0;
    for (v = 0; v < n; v++) {
        const int32_t want = mark[v] ? HD_ROW_HELD : all->row[v] < 0 ? HD_ROW_INERT : row++;
        held += mark[v];
        CHECK_MSG(lap->row[v] == want && (want < 0 || lap->vertex[want] == v), "%s: vertex %d has row %d, not %d", what, v, lap->row[v], want);
    }
    CHECK_MSG(lap->n_active == row && lap->n_held == held && all->n_held == 0 && lap->mesh.n_inert == all->mesh.n_inert, "%s: %d rows, %d held", what,
              lap->n_active, lap->n_held);
    CHECK(!lap->B == !all->B && lap->area == all->area && lap->h == all->h && lap->b_ratio == all->b_ratio);
    for (i = 0; i < row; i++) {
        const int32_t from = all->row[lap->vertex[i]];
        double mass = 0;
        for (j = 0; j < row; j++) {
            const size_t at = (size_t)i * (size_t)row + (size_t)j, was = (size_t)from * (size_t)m + (size_t)all->row[lap->vertex[j]];
            off = fmax(off, fmax(fabs(Lh[at] - L[was]), fabs(Bh[at] - B[was])));
            mass += B[was];
        }
        for (v = 0; v < n; v++)
            if (mark[v] && all->row[v] >= 0) leaks[lap->component[i]] = (char)(leaks[lap->component[i]] ||
                    L[(size_t)from * (size_t)m + (size_t)all->row[v]] != 0);
        CHECK(fabs(lap->mass[i] - mass) <= 1e-14 * mass && lap->b_diag[i] == B[(size_t)from * (size_t)m + (size_t)from]);
        if (lap->xyz) CHECK(memcmp(lap->xyz + 3 * i, all->xyz + 3 * from, 3 * sizeof(double)) == 0);
    }
    CHECK_MSG(off == 0, "%s: L and B are off by %g", what, off);
    for (i = 0; i < lap->n_components; i++) n_leaks += leaks[i];
    CHECK_MSG(lap->conserves == (!all->conserves || n_leaks == lap->n_components ? 0 : n_leaks > 0 ? 2 : 1),
        "%s: conserves %d", what, (int)lap->conserves);
    for (i = 0; i < lap->n_components; i++) CHECK((lap->component_mass[i] == HUGE_VAL) == (lap->conserves == 2 && leaks[i]));
    kit_release(mark_kit);
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
    CHECK_MSG(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), o, &e) == HD_OK, "%s", e.text);
    return lap;
}

static hd_laplacian *bord_kept(const shape *s, const hd_laplacian_opts *o) {
    return (hd_laplacian *)kit_keep(bord_triangles(s, o), kit_free_laplacian);
}

/* Borders, a list with one vertex twice, and both; triangulations as they are, intrinsic Delaunay, tufted. */
static void bord_pairs_triangles(void) {
    static const char *const specs[4] = {"disk/4/1", "flat/9/7/0.3", "spare/4/1", "tangle"};
    static const int32_t held[4] = {17, 3, 17, 40};
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    int k, q, way, which;
    int32_t v;
    for (k = 0; k < 4; k++) {
        const shape *s = kit_shape(specs[k]);
        char *ends = bord_ends(s->n, NULL, s->tri, s->n_tri), *mark = KIT_NEW(char, s->n);
        for (q = 0; q < 9; q++) {
            hd_laplacian_opts o = bord_opts(kinds[q / 3], HD_BORDER_NATURAL, 0, NULL);
            hd_laplacian *all;
            way = q % 3;
            o.triangulation = way == 1 ? HD_TRIANGULATION_DELAUNAY : way == 2 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
            all = bord_kept(s, &o);
            for (which = 1; which < 4; which++) {
                hd_laplacian *lap;
                char what[60];
                snprintf(what, sizeof what, "%s, kind %d, way %d, held %d", specs[k], q / 3, way, which);
                o.border = which & 1 ? HD_BORDER_DIRICHLET : HD_BORDER_NATURAL;
                o.n_held = which & 2 ? 4 : 0;
                o.held = held;
                for (v = 0; v < s->n; v++) mark[v] = (char)((which & 1) && ends[v]);
                for (v = 0; v < o.n_held; v++) mark[held[v]] = 1;
                lap = bord_kept(s, &o);
                bord_check_pair(lap, all, mark, what);
                if (which == 1 && k < 3) CHECK(lap->conserves == 0 && lap->n_components == all->n_components);
            }
        }
    }
}

/* A line of held vertices splits a component in two. */
static void bord_split(void) {
    int32_t held[5], q;
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 5, held);
    hd_laplacian *lap;
    for (q = 0; q < 5; q++) held[q] = 9 * q + 4;
    lap = bord_kept(kit_shape("flat/9/5/0"), &o);
    CHECK(lap->n_components == 2 && lap->n_active == 40 && lap->component[0] == 0 && lap->component[4] == 1);
    CHECK(fabs(lap->component_mass[0] - lap->component_mass[1]) <= 0.05 * lap->component_mass[0]);   /* the diagonals all lean to one side */
}

/* Masses of components by the order of those that have rows: the first is held altogether; of the third a vertex is held (which conserves nothing
 * there), and then none. */
static void bord_masses(void) {
    const double apart[3] = {4, 1, 0}, further[3] = {9, 1, 0};
    const shape *ball = kit_shape("ico/1"), *disk = kit_shape("disk/5/0"), *small = kit_shape("disk/3/0");
    shape two = kit_own_shape(shape_disjoint(ball, disk, apart)), three = kit_own_shape(shape_disjoint(&two, small, further));
    int32_t *held = KIT_NEW(int32_t, ball->n + 1), q, more, round;
    double *xyz = KIT_NEW(double, 3 * (int64_t)three.n);
    for (q = 0; q < ball->n; q++) held[q] = q;
    held[ball->n] = two.n;
    for (q = 0; q < 3 * three.n; q++) xyz[q] = 3 * three.xyz[q];
    for (more = 1; more >= 0; more--) {
        hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_VORONOI_COT, HD_BORDER_NATURAL, ball->n + more, held);
        hd_laplacian *lap;
        o.updatable = 1;
        lap = bord_kept(&three, &o);
        for (round = 0; round < 2; round++) {    /* the second time all is of three times the size */
            double mass[2] = {0, 0};
            CHECK(lap->n_components == 2 && lap->conserves == 1 + more);
            for (q = 0; q < lap->n_active; q++) mass[lap->component[q]] += lap->mass[q];
            if (more) mass[1] = HUGE_VAL;
            for (q = 0; q < 2; q++)
                CHECK_MSG(fabs(lap->component_mass[q] - mass[q]) < 1e-13 || lap->component_mass[q] == mass[q], "component %d: %g, not %g", (int)q,
                          lap->component_mass[q], mass[q]);
            CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), NULL) == HD_OK);
        }
    }
}

/* Polygons, points, tufted points, and matrices. */
static void bord_pairs_others(void) {
    static const int32_t held[3] = {5, 60, 161};
    const shape_poly *p = &kit_body("tromino/3/3/0.1")->p;
    const shape *s = kit_shape("ico/2");
    char *ends = bord_ends(p->n, p->face_ptr, p->face_idx, p->n_faces), *mark = KIT_NEW(char, s->n);
    int q, which;
    for (q = 0; q < 3; q++) mark[held[q]] = 1;
    for (q = 0; q < 4; q++) {
        hd_laplacian *lap[2] = {NULL, NULL}, *mesh = kit_pair("ico/2 fem");
        hd_csr B = mesh->L;
        B.val = mesh->B;
        for (which = 0; which < 2; which++) {
            const hd_border border = q == 0 && which ? HD_BORDER_DIRICHLET : HD_BORDER_NATURAL;
            const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, border, q > 0 && which ? 3 : 0, held);
            const hd_status st = q == 0   ? hd_laplacian_create(lap + which, MESH_POLYGONS(p->xyz, p->n, p->face_ptr, p->face_idx, p->n_faces), &o, NULL)
                                 : q == 1 ? hd_laplacian_create(lap + which, MESH_POINTS(s->xyz, s->n), &o, NULL)
                                 : q == 2 ? at_tufted(lap + which, s->xyz, s->n, NULL, NULL, &o, NULL)
                                          : hd_laplacian_matrices(lap + which, &mesh->L, &B, mesh->h, &o, NULL);
            CHECK(st == HD_OK);
            kit_keep(lap[which], kit_free_laplacian);
        }
        bord_check_pair(lap[1], lap[0], q ? mark : ends, q == 0 ? "polygons" : q == 1 ? "points" : q == 2 ? "tufted points" : "matrices");
    }
}

/* ---- queries ---- */

/* Borders and a vertex, on a disk with vertices in no face; a component that keeps its heat beside one of which a vertex is held. */
#define BORD_COLUMNS " method=auto|direct|krylov|iterative th=0.7|4"
#define BORD_QUERIES(pairs) \
    {pairs " query=column kernel=operator|symmetric k=4" BORD_COLUMNS, 5e-6, 0, 0}, {pairs " query=apply|from k=3" BORD_COLUMNS, 5e-6, 0, 0}, \
    {pairs " query=times method=auto|krylov times=4 span=20 th=1", 5e-6, 0, 0}, \
    {pairs " query=diagonal kernel=operator|symmetric th=1|4", 5e-6, 0, 0}, {pairs " query=diagonal times=4 span=20 th=1", 5e-6, 0, 0}, \
    {pairs " query=entries kernel=operator|symmetric k=30 th=1|4", 1e-5, 0, 0}, {pairs " query=pairs kind=classical|weighted k=30 th=0.5|2", 1e-5, 0, 0}, \
    {pairs " query=distance kind=classical|weighted k=3 th=0.5|2", 1e-5, 0, 0}, {pairs " query=distance kind=classical|weighted times=4 span=4 th=0.5", 1e-5, 0, 0}, \
    {pairs " query=pairs|distance kind=commute|biharmonic k=30", 1e-6, 0, 0}

static const case_row bord_rows[] = {
    BORD_QUERIES("shape=spare/5/1 op=fem+held|vor+held|cot+held"),
    BORD_QUERIES("shape=split/8/2 op=fem+pin"),
    {"shape=split/8/2 op=fem+pin query=column|apply method=direct|krylov|iterative th=30|1000", 5e-6, 0, 0},
};

static void bord_cases(void) { CASES(bord_rows); }

/* Every column of u is zero at vertices that are held. */
static void bord_held_zero(const hd_laplacian *lap, const double *u, int32_t count, const char *what) {
    int32_t q, v;
    for (q = 0; q < count; q++)
        for (v = 0; v < lap->n; v++)
            if (lap->row[v] == HD_ROW_HELD) CHECK_MSG(u[(size_t)q * (size_t)lap->n + (size_t)v] == 0,
                    "%s: vertex %d is held and has %g", what, v, u[q * lap->n + v]);
}

/* What is exact: zeros at held vertices and of columns from them, fields at t = 0 and at vertices in no face, infinite distances. */
static void bord_exact(const char *spec, const char *method) {
    const hd_laplacian *lap = kit_pair(spec);
    hd_heat *heat = kit_heat(lap, method), *plain = kit_heat(lap, "");
    const int32_t n = lap->n, held = n - 4, free_one = lap->vertex[lap->n_active / 2], sources[3] = {free_one, held, lap->vertex[0]};
    const int32_t i[3] = {free_one, held, held}, j[3] = {lap->vertex[0], free_one, held};
    const double t = 2 * trial_unit(lap), times[2] = {0, t};
    double *u = KIT_NEW(double, 6 * n), *f = kit_random(n, 3), K[3], d[3];
    hd_report rep;
    int32_t v, pick[5];
    int k;
    CHECK(lap->row[held] == HD_ROW_HELD && lap->mesh.n_inert > 0);
    for (k = 0; k < 2; k++) {
        CHECK_MSG(hd_heat_columns(heat, (hd_kernel)k, 2, times, VERTICES(3, sources), u, 0, &rep, NULL) >= 0, "%s: %s", spec,
            rep.error.text);
        bord_held_zero(lap, u, 6, "columns");
        for (v = 0; v < n; v++) CHECK(u[2 * n + v] == 0 && u[3 * n + v] == 0 && (k == HD_KERNEL_SYMMETRIC || u[v] == (v == sources[0])));
        CHECK(heat_diagonal(plain, 1, &t, (hd_kernel)k, u, 0, &rep) >= 0);
        bord_held_zero(lap, u, 1, "diagonal");
        for (v = 0; v < n; v++) CHECK(lap->row[v] != HD_ROW_INERT || u[v] == (k == HD_KERNEL_OPERATOR));
        CHECK(heat_entries(heat, t, (hd_kernel)k, 3, i, j, K, &rep) >= 0 && K[0] != 0 && K[1] == 0 && K[2] == 0);
    }
    CHECK(heat_times(heat, 2, times, HD_KERNEL_OPERATOR, 0, f, u, 0, &rep) >= 0);
    bord_held_zero(lap, u, 2, "a field");
    for (v = 0; v < n; v++) CHECK((lap->row[v] == HD_ROW_HELD || u[v] == f[v]) && (lap->row[v] != HD_ROW_INERT || u[n + v] == u[v]));
    CHECK(heat_apply(heat, t, 1, f, 0, f, 0, &rep) >= 0 && memcmp(f, u + n, (size_t)n * sizeof *f) == 0);   /* in place */
    for (k = 0; k < 4; k++) {                    /* held vertices are in no component */
        CHECK(heat_distance(plain, (hd_distance_kind)k, k < 2, &t, 2, sources, u, 0, &rep) >= 0 && u[free_one] == 0);
        CHECK((u[held] == HUGE_VAL) == (k > 1) && (u[n + free_one] == HUGE_VAL) == (k > 1));
        CHECK(heat_entries(plain, t, HD_KERNEL_OPERATOR, 3, i, j, K, &rep) >= 0);
        CHECK(heat_pairs(plain, (hd_distance_kind)k, t, 3, i, j, d, &rep) >= 0 && d[2] == 0);
        CHECK(k > 1 ? d[1] == HUGE_VAL : d[1] > 0 && K[1] == 0 && K[2] == 0);
    }
    CHECK(heat_sample(plain, HD_DISTANCE_CLASSICAL, t, 5, pick, f, &rep) >= 0);
    for (v = 0; v < 5; v++) CHECK(lap->row[pick[v]] >= 0);
}

/* Pairs whose columns are all zero, at a time when nothing is known of columns any more: exact, and no NaN in the report. */
static void bord_faded_pairs(const trial_work *w) {
    const hd_laplacian *lap = w->s->lap;
    hd_heat *heat = kit_heat(lap, "");
    const int32_t held = lap->n - 4, i[2] = {held, held}, j[2] = {held, held + 1};
    const double t = 60 / w->s->exact.edge;
    double K[2], d[2];
    hd_report rep;
    int kind;
    CHECK(heat_entries(heat, t, HD_KERNEL_OPERATOR, 1, i, j, K, &rep) >= 0 && K[0] == 0 && rep.error_bound == 0);
    for (kind = 0; kind < 2; kind++) {
        CHECK(lap->row[held] == HD_ROW_HELD && heat_pairs(heat, (hd_distance_kind)kind, t, 1, i, j, d, &rep) >= 0 &&
            d[0] == 0 && rep.error_bound == 0);
        CHECK(heat_pairs(heat, (hd_distance_kind)kind, t, 2, i, j, d, &rep) >= 0 && rep.error_bound >= 0);
    }
}

/* Truncated kernels of all eigenpairs. */
static void bord_spectrum(trial_work *w) {
    const hd_laplacian *lap = w->s->lap;
    const double t = 3 * w->s->unit;
    const int32_t n = lap->n, sources[2] = {lap->vertex[1], n - 4};
    double *u = KIT_NEW(double, 2 * n), *bound = KIT_NEW(double, 2 * n), off = 0;
    hd_spectrum_opts o;
    hd_spectrum *s = NULL;
    int32_t v;
    memset(&o, 0, sizeof o);
    o.count = lap->n_active;
    if (!CHECK(hd_spectrum_create(&s, lap, &o, NULL) == HD_OK && s->proven && s->n_constant == 0)) return;
    for (v = 0; v < s->count; v++) bord_held_zero(lap, s->vector + (size_t)v * (size_t)n, 1, "an eigenvector");
    CHECK(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, &t, VERTICES(2, sources), u, bound, 0, NULL) == HD_OK);
    bord_held_zero(lap, u, 2, "truncated column");
    for (v = 0; v < n; v++) CHECK(u[n + v] == 0 && bound[n + v] == 0);
    CHECK(hd_spectrum_diagonal(s, HD_KERNEL_OPERATOR, 1, &t, u, NULL, 0, NULL) == HD_OK);
    for (v = 0; v < n; v++) CHECK(lap->row[v] >= 0 || u[v] == (lap->row[v] == HD_ROW_INERT));
    CHECK(hd_spectrum_diagonal(s, HD_KERNEL_SYMMETRIC, 1, &t, u, NULL, 0, NULL) == HD_OK);
    trial_filter_for(w, t, 0);
    for (v = 0; v < n; v++) off = fmax(off, fabs(u[v] - (double)trial_want_entry(w, v, v, 0, 0, 0, w->off)));
    CHECK_MSG(off <= 1e-9 * dense_max_abs(u, n), "truncated diagonal off by %g", off);
    CHECK(hd_spectrum_distance(s, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, sources + 1), u, NULL, 0, NULL) == HD_OK);
    trial_filter_for(w, 2 * t, 0);
    for (off = 0, v = 0; v < n; v++) off = fmax(off, fabs(u[v] - (double)trial_want_distance(w, sources[1], v, 0, w->off)));
    CHECK_MSG(off <= 1e-8 * dense_max_abs(u, n), "truncated distance from a held vertex off by %g", off);
    hd_spectrum_free(s);
}

static void bord_queries(void) {
    static const char *const pairs[3] = {"spare/5/1 fem+held", "spare/5/1 vor+held", "spare/5/1 cot+held"};
    static const char *const methods[3] = {"method=direct", "method=krylov", "method=iterative"};
    trial_work *w = case_truth_of("shape=spare/5/1 op=fem+held");
    int q;
    for (q = 0; q < 9; q++) bord_exact(pairs[q / 3], methods[q % 3]);
    bord_faded_pairs(w);
    bord_spectrum(w);
}

/* One component is held, the other one is not, and keeps its heat, to the time when only means are left. */
static void bord_mixed(void) {
    static const char *const methods[3] = {"method=direct", "method=krylov", "method=iterative"};
    static const double factors[3] = {1, 30, 1000};
    const double apart[3] = {3, 0, 0};
    const int32_t held = 7;
    const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 1, &held);
    const shape *disk = kit_shape("disk/5/0");
    shape two = kit_own_shape(shape_disjoint(disk, disk, apart));
    const hd_laplacian *lap = bord_kept(&two, &o);
    const int32_t n = lap->n, source = disk->n + 11, sources[2] = {2, source};
    const double late = 1e11 * lap->h * lap->h, mean = 1 / lap->component_mass[1];
    double *u = KIT_NEW(double, 2 * n);
    hd_heat *heat = kit_heat(lap, "");
    hd_report rep;
    int32_t v;
    int k;
    CHECK(lap->n_components == 2 && lap->conserves == 2 && lap->component_mass[0] == HUGE_VAL);
    for (k = 0; k < 9; k++) {
        double sum = 0;
        CHECK(heat_column(kit_heat(lap, methods[k / 3]), factors[k % 3] * lap->h * lap->h, source, u, &rep) >= 0);
        for (v = disk->n; v < n; v++) sum += lap->mass[lap->row[v]] * u[v];
        sum /= lap->mass[lap->row[source]];
        CHECK_MSG(fabs(sum - 1) <= 1e-12 && rep.mass_drift <= 1e-12, "%s, time %d: heat is 1 + %g, drift %g", methods[k / 3],
            k % 3, sum - 1, rep.mass_drift);
        for (v = 0; v < disk->n; v++) CHECK(u[v] == 0);
    }
    for (k = 0; k < 2; k++) {
        double off = 0;
        if (k) CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &late, u + n, 0, NULL, NULL, &rep, NULL) >= 0);
        else CHECK(hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &late, VERTICES(2, sources), u, 0, &rep, NULL) >= 0);
        for (v = 0; v < n; v++) off = fmax(off, fmax(k ? 0 : fabs(u[v]), fabs(u[n + v] - (v < disk->n ? 0 : mean))));
        CHECK_MSG(off <= 1e-10 * mean && off <= (rep.error_bound + 1e-13) * mean, "late %s: off by %g of %g, bound %g",
            k ? "diagonal" : "columns", off, mean, rep.error_bound);
    }
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

static double bord_order(const double *off) { return log(off[0] / off[1]) / log(2); }

/* Errors of K_t f for an eigenfunction f, relative to the answer, at two sizes. */
static void bord_modes(void) {
    static const struct { const char *spec[2]; double (*mode)(const double *), lambda; } rows[3] = {
        {{"flat/25/25/0", "flat/49/49/0"}, bord_mode_square, 5 * BORD_PI * BORD_PI},
        {{"disk/16/0", "disk/32/0"}, bord_mode_disk, 2.404825557695772769 * 2.404825557695772769},
        {{"disk/16/1", "disk/32/1"}, bord_mode_sphere, 2}};
    int q, k;
    for (q = 0; q < 6; q++) {
        const double lambda = rows[q / 2].lambda, t = 0.3 / lambda;
        double off[2] = {0, 0};
        for (k = 0; k < 2; k++) {
            const shape *s = kit_shape(rows[q / 2].spec[k]);
            const hd_laplacian_opts o = bord_opts(q % 2 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 0, NULL);
            double *f = KIT_NEW(double, s->n);
            int32_t v;
            for (v = 0; v < s->n; v++) f[v] = rows[q / 2].mode(s->xyz + 3 * v);
            CHECK(heat_apply(kit_heat(bord_kept(s, &o), ""), t, 1, f, 0, f, 0, NULL) == HD_OK);
            for (v = 0; v < s->n; v++) off[k] = fmax(off[k], fabs(f[v] * exp(t * lambda) - rows[q / 2].mode(s->xyz + 3 * v)));
        }
        CHECK_MSG(off[1] < 0.01 && bord_order(off) >= 1.9, "%s, %d: errors %g, %g, order %.2f", rows[q / 2].spec[0], q % 2,
            off[0], off[1], bord_order(off));
    }
}

/* The kernel of the square, by sines, and the heat that is left of the field one. */
static void bord_square(void) {
    const double t = 0.02;
    double off[2], heat_off[2], want = 0, left = 0;
    int32_t k, a, v;
    for (a = 1; a < 60; a += 2) {
        want += 2 * exp(-BORD_PI * BORD_PI * a * a * t);             /* at the middle, in one direction */
        left += 8 / (BORD_PI * BORD_PI * a * a) * exp(-BORD_PI * BORD_PI * a * a * t);
    }
    for (k = 0; k < 2; k++) {
        const shape *s = kit_shape(k ? "flat/49/49/0" : "flat/25/25/0");
        const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 0, NULL);
        const hd_laplacian *all = bord_kept(s, NULL);
        hd_heat *heat = kit_heat(bord_kept(s, &o), "");
        double *u = KIT_NEW(double, s->n), sum = 0;
        hd_report rep;
        CHECK(heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, u, 0, &rep) == HD_OK);
        off[k] = fabs(u[s->n / 2] / (want * want) - 1);
        for (v = 0; v < s->n; v++) u[v] = 1;
        CHECK(heat_apply(heat, t, 1, u, 0, u, 0, &rep) == HD_OK && rep.mass_drift == 0);
        for (v = 0; v < s->n; v++) sum += all->mass[all->row[v]] * u[v];
        heat_off[k] = fabs(sum - left * left);
    }
    CHECK_MSG(off[1] < 0.01 && bord_order(off) >= 1.9, "kernel of the square: %g, %g", off[0], off[1]);
    CHECK_MSG(heat_off[1] < 0.01 && bord_order(heat_off) >= 1.9, "heat of the square: %g, %g", heat_off[0], heat_off[1]);
}

/* Eigenvalues: a path of n free nodes has 4 sin^2(k pi / (2 (n + 1))). */
static void bord_path(void) {
    enum { N = 12 };
    const hd_csr *L = kit_csr(test_path_csr(N + 2, 0)), *B = kit_csr(test_diagonal_csr(N + 2, NULL));
    const int32_t ends[2] = {0, N + 1};
    const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_NATURAL, 2, ends);
    hd_laplacian *lap = NULL;
    hd_spectrum_opts so;
    hd_spectrum *s = NULL;
    int32_t k;
    memset(&so, 0, sizeof so);
    so.count = N;
    CHECK(hd_laplacian_matrices(&lap, L, B, 1, &o, NULL) == HD_OK && hd_spectrum_create(&s, lap, &so, NULL) == HD_OK);
    for (k = 0; k < N; k++) {
        const double want = 4 * pow(sin((k + 1) * BORD_PI / (2 * (N + 1))), 2);
        CHECK_MSG(fabs(s->value[k] - want) <= 1e-13 * 4, "eigenvalue %d of a path: %g for %g", k, s->value[k], want);
    }
    hd_spectrum_free(s);
    hd_laplacian_free(lap);
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

static hd_laplacian *bord_polygons(const shape_poly *p, const double *xyz, const hd_laplacian_opts *o) {
    hd_laplacian *lap = NULL;
    CHECK(hd_laplacian_create(&lap, MESH_POLYGONS(xyz, p->n, p->face_ptr, p->face_idx, p->n_faces), o, NULL) == HD_OK);
    return (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
}

static void bord_updates(void) {
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_POLYGON};
    static const int32_t held[2] = {2, 9};
    const shape *s = kit_shape("disk/6/1");
    shape_poly p = kit_own_poly(shape_poly_of(s));
    double *xyz = KIT_NEW(double, 3 * s->n), *u = KIT_NEW(double, s->n), *want = KIT_NEW(double, s->n);
    int32_t q, frame, v;
    for (q = 0; q < 3; q++) {
        hd_laplacian_opts o = bord_opts(kinds[q], HD_BORDER_DIRICHLET, 2, held);
        hd_laplacian *lap, *fresh;
        hd_heat *heat;
        hd_error e;
        o.updatable = 1;
        lap = bord_polygons(&p, s->xyz, &o);
        heat = kit_heat(lap, "");
        CHECK(heat_column(heat, 3 * lap->h * lap->h, lap->vertex[20], u, NULL) >= 0);
        o.updatable = 0;
        for (frame = 1; frame < 4; frame++) {
            const double t = 3 * lap->h * lap->h;
            for (v = 0; v < 3 * s->n; v++) xyz[v] = s->xyz[v] * (1 + 0.1 * frame * (v % 3)) + 0.04 * frame * sin(3 * s->xyz[v - v % 3] + v % 3);
            CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_OK && lap->version == frame);
            fresh = bord_polygons(&p, xyz, &o);
            bord_same(lap, fresh, q == 2 ? 0 : 1e-13, "moved");
            CHECK(heat_column(heat, t, lap->vertex[20], u, NULL) == HD_OK && heat_column(kit_heat(fresh, ""), t,
                lap->vertex[20], want, NULL) == HD_OK);
            CHECK(dense_max_diff(u, want, s->n) <= 1e-7 * dense_max_abs(want, s->n));
        }
        memset(xyz, 0, 3 * (size_t)s->n * sizeof *xyz);      /* no area: refused, and nothing has changed */
        CHECK(hd_laplacian_update(lap, MESH_POINTS(xyz, lap->n), &e) == HD_ERR_EMPTY && lap->version == 3);
        CHECK(heat_column(heat, 3 * lap->h * lap->h, lap->vertex[20], want, NULL) >= 0);
    }
}

static void bord_update_matrices(void) {
    static const int32_t held[3] = {0, 20, 33};
    hd_laplacian *mesh = kit_pair("flat/8/7/0.2 fem"), *lap = NULL, *fresh = NULL;
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_NATURAL, 3, held);
    hd_csr L = mesh->L, B = mesh->L;
    double *val = KIT_NEW(double, L.nnz);
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
}

/* What is refused: n_held, which of the nine list entries is another, the border. */
static void bord_errors(void) {
    static int32_t held[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    static const struct { const char *what; int32_t n_held, third, listed; int border; hd_status want; } rows[] = {
        {"all held", 9, 3, 1, HD_BORDER_NATURAL, HD_ERR_EMPTY},         {"no such vertex", 9, 9, 1, HD_BORDER_NATURAL, HD_ERR_INDEX},
        {"a negative id", 9, -1, 1, HD_BORDER_NATURAL, HD_ERR_INDEX},   {"a negative count", -1, 3, 1, HD_BORDER_NATURAL, HD_ERR_ARGUMENT},
        {"no list", 1, 3, 0, HD_BORDER_NATURAL, HD_ERR_ARGUMENT},       {"an unknown border", 0, 3, 1, 2, HD_ERR_ARGUMENT}};
    const shape *s = kit_shape("flat/3/3/0"), *ball = kit_shape("ico/1");
    const hd_csr *L = kit_csr(test_path_csr(5, 0)), *B = kit_csr(test_diagonal_csr(5, NULL));
    hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_DEFAULT, HD_BORDER_DIRICHLET, 0, NULL);
    hd_laplacian *lap = NULL;
    hd_error e;
    int q;
    CHECK(hd_laplacian_create(&lap, MESH_POINTS(ball->xyz, ball->n), &o, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(at_tufted(&lap, ball->xyz, ball->n, NULL, NULL, &o, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(hd_laplacian_matrices(&lap, L, B, 0, &o, &e) == HD_ERR_ARGUMENT && !lap);
    lap = bord_kept(ball, &o);                   /* closed: there is nothing to hold */
    CHECK(lap->n_held == 0 && lap->conserves && lap->n_active == ball->n);
    lap = NULL;
    for (q = 0; q < (int)(sizeof rows / sizeof *rows); q++) {
        o = bord_opts(HD_LAPLACIAN_FEM, (hd_border)rows[q].border, rows[q].n_held, rows[q].listed ? held : NULL);
        held[3] = rows[q].third;
        CHECK_MSG(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e) == rows[q].want && !lap, "%s: %s", rows[q].what, e.text);
        if (rows[q].third == 9) CHECK(e.row == 3 && e.value == 9);
    }
}

static void test_borders(void) {
    bord_pairs_triangles();
    bord_split();
    bord_masses();
    bord_pairs_others();
    bord_cases();
    bord_queries();
    bord_mixed();
    bord_modes();
    bord_square();
    bord_path();
    bord_updates();
    bord_update_matrices();
    bord_errors();
}

#endif
