/* test_sources.h - sources that are no vertices: points of faces and edges, weighted points, sets of vertices and curves; against the truth, closed
 * forms, and the queries of vertices */

#ifndef TEST_SOURCES_H
#define TEST_SOURCES_H

/* ---- against the truth ---- */

#define SRC_POINTS " corners=1|2|3 curve=0|1 k=2"
#define SRC_QUERIES(pairs, late) \
    {pairs " query=from kernel=operator|symmetric method=direct|krylov|iterative times=2 span=" late " th=0.7" SRC_POINTS, 5e-6, 0, 0}, \
    {pairs " query=distance_from kind=classical|weighted th=0.7|5" SRC_POINTS, 5e-6, 0, 0}, \
    {pairs " query=distance_from kind=classical|weighted times=3 span=" late " th=0.7 corners=1|3 curve=1", 5e-6, 0, 0}, \
    {pairs " query=distance_from kind=commute|biharmonic" SRC_POINTS, 1e-8, 0, 0}

static const case_row src_rows[] = {
    SRC_QUERIES("shape=flat/7/6/0.3 op=fem+held", "4"),
    SRC_QUERIES("shape=qtorus/8/6 op=poly", "30"),
    SRC_QUERIES("shape=tromino/3/3/0.2 op=poly+half|cot+tuft", "30"),
    SRC_QUERIES("shape=cloud/50/0 op=vexp|tuft", "30"),
    SRC_QUERIES("shape=cloud/50/1 op=exp|tuft+vor", "30"),
    SRC_QUERIES("shape=needles/1 op=fem+id", "30"),
    SRC_QUERIES("shape=tangle op=fem+tuft|vor+id", "10"),
    /* late, and in two components of unlike vertices */
    {"shape=two/1/0.2/5 op=fem|vor query=from kernel=operator|symmetric method=direct|krylov|iterative apart=1 th=0.7|2000" SRC_POINTS, 5e-6, 0, 0},
    {"shape=two/1/0.2/5 op=fem|vor query=distance_from kind=classical|weighted apart=1 th=0.7|2000" SRC_POINTS, 5e-6, 0, 0},
};

static void src_cases(void) { CASES(src_rows); }

/* ---- sources, and what they are as functionals ---- */

enum { SRC_KINDS = 6, SRC_OTHER = 6, SRC_ROOM = 24 };

/* A source, or two, with room for its arrays. */
typedef struct src_room {
    hd_sources s;
    int64_t first[3];
    int32_t vertex[SRC_ROOM];
    double bary[SRC_ROOM], weight[SRC_ROOM];
} src_room;

/* A vertex, two of its neighbours in L, and three barycentric coordinates. */
static void src_corner(src_room *x, int32_t at, const hd_laplacian *lap, int32_t row, double b0, double b1) {
    const hd_csr *L = &lap->L;
    int32_t v[3], k = 1;
    int64_t p;
    v[0] = v[1] = v[2] = lap->vertex[row];
    for (p = L->row_ptr[row]; p < L->row_ptr[row + 1] && k < 3; p++)
        if (L->col[p] != row) v[k++] = lap->vertex[L->col[p]];
    for (k = 0; k < 3; k++) x->vertex[3 * at + k] = v[k];
    x->bary[3 * at] = b0;
    x->bary[3 * at + 1] = b1;
    x->bary[3 * at + 2] = 1 - b0 - b1;
}

/* Which: a point of a triangle, one of an edge, four vertices, two weighted points, the first and the last vertex of all, a curve; another
 * curve. The arrays are those of x. */
static void src_make(src_room *x, const hd_laplacian *lap, int which) {
    const int32_t m = lap->n_active;
    int32_t q;
    memset(x, 0, sizeof *x);
    x->s = hd_vertices(1, x->vertex);
    x->s.first = x->first;
    x->first[1] = 1;
    x->s.corners = 3;
    x->s.bary = x->bary;
    src_corner(x, 0, lap, which == SRC_OTHER ? m / 4 : m / 2, 0.2, 0.3);
    if (which == 1) {
        x->s.corners = 2;
        x->bary[1] = 0.8;
    } else if (which == 2) {
        x->first[1] = 4;
        x->s.corners = 0;
        x->s.bary = NULL;
        for (q = 0; q < 4; q++) x->vertex[q] = lap->vertex[m / 3 + q];
    } else if (which == 3) {
        x->first[1] = 2;
        x->s.weight = x->weight;
        x->weight[0] = 0.5;
        x->weight[1] = 1.5;
        src_corner(x, 1, lap, m / 4, 0.6, 0.1);
    } else if (which == 4) {
        x->first[1] = 2;
        x->s.corners = 1;
        x->s.bary = NULL;
        x->s.weight = x->weight;
        x->weight[0] = 0.75;
        x->weight[1] = 0.25;
        x->vertex[0] = 0;
        x->vertex[1] = lap->row[lap->n - 1] == HD_ROW_HELD ? lap->vertex[0] : lap->n - 1;
    } else if (which >= 5) {
        x->first[1] = which == 5 ? 3 : 2;
        x->s.curve = 1;
        x->s.length = x->weight;
        x->weight[0] = 0.3;
        x->weight[1] = 0.7;
        x->weight[x->first[1] - 1] = (double)NAN;        /* is not read */
        for (q = 0; q < 9; q++) x->vertex[q] = x->vertex[q % 3];
        for (q = 0; q < 9; q++) x->bary[q] = q < 3 ? x->bary[q] : q == 4 ? 1 : q == 8 ? 0.5 : q == 6 ? 0.5 : 0;
    }
}

static void src_make_all(src_room *room, const hd_laplacian *lap) {
    int w;
    for (w = 0; w < SRC_KINDS; w++) src_make(room + w, lap, w);
}

/* Two sources of the same kind as sources of one call. */
static void src_join(src_room *to, const src_room *a, const src_room *b) {
    const int32_t corners = a->s.corners ? a->s.corners : 1;
    int32_t q, c, at = 0;
    memset(to, 0, sizeof *to);
    to->s = a->s;
    to->s.count = 2;
    to->s.first = to->first;
    to->s.vertex = to->vertex;
    to->s.bary = a->s.bary ? to->bary : NULL;
    to->s.weight = a->s.weight || b->s.weight ? to->weight : NULL;
    to->s.length = a->s.length ? to->weight : NULL;
    to->first[1] = a->first[1];
    to->first[2] = a->first[1] + b->first[1];
    for (q = 0; q < 2; q++) {
        const src_room *x = q ? b : a;
        int32_t p;
        for (p = 0; p < x->first[1]; p++, at++) {
            to->weight[at] = x->s.weight || x->s.length ? x->weight[p] : 1;
            for (c = 0; c < corners; c++) {
                to->vertex[corners * at + c] = x->vertex[corners * p + c];
                to->bary[corners * at + c] = x->bary[corners * p + c];
            }
        }
    }
}

/* c [n] of source k by vertices, from the definition: points by their weights, pieces of curves by their midpoints. */
static double *src_load(const hd_sources *s, int32_t k, int32_t n) {
    const int32_t corners = s->corners ? s->corners : 1;
    const int64_t begin = s->first ? s->first[k] : k, end = s->first ? s->first[k + 1] : k + 1;
    double *c = KIT_NEW(double, n);
    int64_t q;
    int32_t i;
    for (q = begin; q < end; q++)
        for (i = 0; i < corners; i++) {
            const int64_t at = q * corners + i;
            const double b = s->bary ? s->bary[at] : 1.0 / corners;
            double w = s->weight ? s->weight[q] : 1;
            if (s->curve) w = ((q > begin ? s->length[q - 1] : 0) + (q + 1 < end ? s->length[q] : 0)) / 2;
            c[s->vertex[at]] += w * b;
        }
    return c;
}

/* ---- what is exact ---- */

/* Loads at t = 0; vertices in no face, and held ones; a source that is a vertex is that vertex, to the last bit. */
static void src_same(const hd_laplacian *lap, const char *method, const char *what) {
    const double unit = trial_unit(lap), times[3] = {unit, 20 * unit, 0};
    const int32_t n = lap->n, id[2] = {lap->vertex[lap->n_active / 2], n - 1};
    hd_heat *heat = kit_heat(lap, method);
    double *U = KIT_NEW(double, 3 * SRC_KINDS * n), *V = KIT_NEW(double, 6 * n);
    src_room room[SRC_KINDS];
    hd_report a, b;
    int32_t q, v;
    int k, w;
    src_make_all(room, lap);
    for (k = 0; k < 2; k++)
        for (w = 0; w < SRC_KINDS; w++) {
            const double *load = src_load(&room[w].s, 0, n);
            CHECK_MSG(hd_heat_columns(heat, (hd_kernel)k, 3, times, &room[w].s, U, 0, &a, NULL) >= 0, "%s: %s", what, a.error.text);
            for (q = 0; q < 3; q++)
                for (v = 0; v < n; v++) {
                    const double u = U[(size_t)q * (size_t)n + (size_t)v];
                    if (lap->row[v] < 0) CHECK_MSG(u == (lap->row[v] == HD_ROW_INERT && k == HD_KERNEL_OPERATOR ? load[v] : 0),
                            "%s: source %d at vertex %d: %g", what, w, v, u);
                    else if (q == 2 && k == HD_KERNEL_OPERATOR) CHECK_MSG(fabs(u - load[v]) <= 1e-15, "%s: load %d of vertex %d", what, w, v);
                }
        }
    src_make(room, lap, 0);
    room[0].vertex[5] = id[1];
    room[0].vertex[3] = room[0].vertex[4] = id[0];
    for (q = 0; q < 6; q++) room[0].bary[q] = q == 0 || q == 5;
    room[0].s.count = 2;
    room[0].s.first = NULL;
    for (k = 0; k < 2; k++) {
        CHECK(hd_heat_columns(heat, (hd_kernel)k, 3, times, VERTICES(2, id), U, 0, &a, NULL) >= 0 &&
            hd_heat_columns(heat, (hd_kernel)k, 3, times, &room[0].s, V, 0, &b, NULL) >= 0);
        CHECK(memcmp(U, V, (size_t)(6 * n) * sizeof *U) == 0 && a.error_bound == b.error_bound && a.iterations == b.iterations);
    }
    for (k = 0; k < 4 && strcmp(method, "method=direct") == 0; k++) {
        /* a plan each: eigenpairs that one query leaves are of use to the next */
        const int32_t n_times = k < 2 ? 2 : 1;
        CHECK(hd_heat_distance(kit_heat(lap, method), (hd_distance_kind)k, n_times, times, VERTICES(2, id), U, 0, &a, NULL) >= 0);
        CHECK(hd_heat_distance(kit_heat(lap, method), (hd_distance_kind)k, n_times, times, &room[0].s, V, 0, &b, NULL) >= 0);
        CHECK_MSG(memcmp(U, V, (size_t)(2 * n_times * n) * sizeof *U) == 0 && a.error_bound == b.error_bound,
            "%s, distance %d: %g, bounds %g %g", what, k,
                  dense_max_diff(U, V, 2 * n_times * n), a.error_bound, b.error_bound);
    }
}

/* Columns of a kernel, or distances of a kind. */
static hd_status src_ask(hd_heat *heat, int query, int32_t m, const double *t, const hd_sources *s, double *U, hd_report *rep) {
    if (query < 2) return hd_heat_columns(heat, (hd_kernel)query, m, t, s, U, 0, rep, NULL);
    return hd_heat_distance(heat, (hd_distance_kind)(query - 2), m, t, s, U, 0, rep, NULL);
}

/* The same but for so much of the largest, and infinite in the same places. */
static void src_alike(const double *u, const double *v, int32_t n, double tol, const char *what) {
    double most = 0, off = 0;
    int32_t i;
    for (i = 0; i < n; i++) {
        const double gap = u[i] == v[i] ? 0 : fabs(u[i] - v[i]);
        if (u[i] < HUGE_VAL) most = fmax(most, fabs(u[i]));
        off = gap >= 0 ? fmax(off, gap) : HUGE_VAL;
    }
    CHECK_MSG(off <= tol * most, "%s: off by %g, the largest is %g", what, off, most);
}

/* Pairs of the same kind: points of triangles, vertices, curves by their lengths and by coordinates. Is there such a pair? */
static int src_pair_of(src_room *both, src_room one[2], const hd_laplacian *lap, int which) {
    static const int kinds[4][2] = {{0, 3}, {2, 4}, {5, SRC_OTHER}, {SRC_OTHER, 5}};
    int q;
    if (which == 3 && !lap->xyz) return 0;
    for (q = 0; q < 2; q++) {
        src_make(one + q, lap, kinds[which][q]);
        if (which == 3) one[q].s.length = NULL;
    }
    src_join(both, one, one + 1);
    return 1;
}

/* Two sources of a call have the columns of each alone but for rounding, which depends on how many there are: those of a call with the same
 * source twice are the same to the last bit. Distances agree within their bounds. */
static void src_together(const hd_laplacian *lap, const char *method, const char *what) {
    const double times[2] = {trial_unit(lap), 20 * trial_unit(lap)};
    const int32_t n = lap->n;
    const int kinds = strcmp(method, "method=direct") == 0 ? 6 : 2;
    double *U = KIT_NEW(double, 4 * n), *V = KIT_NEW(double, 4 * n);
    src_room both, one[2], twice;
    hd_report rep, alone;
    int w, k, q, c;
    for (w = 0; w < 4; w++)
        for (k = 0; k < kinds && src_pair_of(&both, one, lap, w); k++) {        /* two kernels, four kinds of distances */
            const int32_t m = k < 4 ? 2 : 1, size = m * n;
            CHECK_MSG(src_ask(kit_heat(lap, method), k, m, times, &both.s, U, &rep) >= 0, "%s: %s", what, rep.error.text);
            for (q = 0; q < 2; q++) {
                const double *u = U + q * size;
                CHECK(src_ask(kit_heat(lap, method), k, m, times, &one[q].s, V, &alone) >= 0);
                src_alike(u, V, size, k < 2 ? 1e-12 : rep.error_bound + alone.error_bound, what);
                src_join(&twice, one + q, one + q);
                CHECK(src_ask(kit_heat(lap, method), k, m, times, &twice.s, V, &alone) >= 0);
                for (c = 0; c < 2; c++)
                    if (k >= 2) src_alike(u, V + c * size, size, rep.error_bound + alone.error_bound, what);
                    else CHECK_MSG(memcmp(u, V + c * size, (size_t)size * sizeof *u) == 0 || !TEST_EXACT, "%s, %s, pair %d, kernel %d: %g",
                                   what, method, w, k, dense_max_diff(u, V + c * size, size));
            }
        }
}

/* What one source takes of the column of another. */
static void src_symmetric(const hd_laplacian *lap, const char *method, const char *what) {
    const double t = 5 * trial_unit(lap);
    const int32_t n = lap->n;
    double *U = KIT_NEW(double, SRC_KINDS * n), M[SRC_KINDS][SRC_KINDS], size = 0, off = 0;
    hd_heat *heat = kit_heat(lap, method);
    src_room room[SRC_KINDS];
    hd_report rep;
    int p, q;
    src_make_all(room, lap);
    for (p = 0; p < SRC_KINDS; p++)
        CHECK_MSG(hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t, &room[p].s, U + (size_t)p * (size_t)n, 0, &rep, NULL) >= 0,
            "%s: %s", what, rep.error.text);
    for (p = 0; p < SRC_KINDS; p++) {
        const double *load = src_load(&room[p].s, 0, n);
        for (q = 0; q < SRC_KINDS; q++) M[p][q] = dense_dot(load, U + (size_t)q * (size_t)n, n);
    }
    for (p = 0; p < SRC_KINDS; p++)
        for (q = 0; q < SRC_KINDS; q++) {
            off = fmax(off, fabs(M[p][q] - M[q][p]));
            size = fmax(size, fabs(M[p][q]));
        }
    CHECK_MSG(off <= 2e-8 * size, "%s: k(s, s') is not symmetric: %g of %g", what, off, size);
}

static void src_exact(void) {
    static const char *const pairs[] = {"flat/9/8/0.3 fem+held", "qtorus/8/6 poly", "tromino/4/4/0.2 cot+tuft",
        "cloud/90/0 vexp", "cloud/90/1 exp", "cloud/90/0 tuft", "needles/2 fem+id",
                                        "tangle fem+tuft", "tangle vor+id"};
    static const char *const methods[3] = {"method=direct", "method=krylov", "method=iterative"};
    int k, m;
    for (k = 0; k < (int)(sizeof pairs / sizeof *pairs); k++) {
        const int32_t mark = kit_mark();
        const hd_laplacian *lap = kit_pair(pairs[k]);
        for (m = 0; m < 3; m++) {
            src_same(lap, methods[m], pairs[k]);
            src_symmetric(lap, methods[m], pairs[k]);
            src_together(lap, methods[m], pairs[k]);
        }
        kit_release(mark);
    }
}

/* Points without barycentric coordinates are the means of their corners. */
static void src_means(void) {
    const hd_laplacian *lap = kit_pair("flat/6/5/0.2 fem");
    const double t = 4 * lap->h * lap->h, third = 1.0 / 3;
    double *U = KIT_NEW(double, 2 * lap->n);
    hd_heat *heat = kit_heat(lap, "method=direct");
    src_room room;
    src_make(&room, lap, 0);
    room.bary[0] = room.bary[1] = third;
    room.bary[2] = 1 - 2 * third;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, &room.s, U, 0, NULL, NULL) == HD_OK);
    room.s.bary = NULL;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, &room.s, U + lap->n, 0, NULL, NULL) == HD_OK);
    CHECK(dense_max_diff(U, U + lap->n, lap->n) <= 1e-12 * dense_max_abs(U, lap->n));
}

/* ---- from eigenpairs, and farthest points ---- */

/* Is value within bound of the truth in w->want[at], and what that may be off by? Infinite ones are so in both. */
static int src_near(const trial_work *w, int32_t at, double value, double bound) {
    return (double)q_fabs(value - w->want[at]) <= bound + w->off[at] + 1e-12 * fabs(value);
}

/* Columns from two thirds of the pairs: what is left out is within the bound, and that says something at late times. */
static void src_pair_columns(trial_work *w, const hd_spectrum *z, const src_room *room) {
    const hd_laplacian *lap = w->s->lap;
    const double times[3] = {2 * w->s->unit, (lap->conserves ? 200 : 10) * w->s->unit, 0};
    const int32_t n = lap->n;
    double *U = KIT_NEW(double, 3 * SRC_KINDS * n), *bound = KIT_NEW(double, 3 * SRC_KINDS * n);
    int32_t v;
    int k, q;
    for (k = 0; k < 2; k++) {
        for (q = 0; q < SRC_KINDS; q++)
            CHECK(hd_spectrum_columns(z, (hd_kernel)k, 3, times, &room[q].s, U + 3 * q * n, bound + 3 * q * n, 0, NULL) == HD_OK);
        for (q = 0; q < 3 * SRC_KINDS; q++) {
            const double *u = U + (size_t)q * (size_t)n, *b = bound + (size_t)q * (size_t)n, *load = src_load(&room[q / 3].s, 0, n),
                size = dense_max_abs(u, n);
            trial_filter_for(w, times[q % 3], 0);
            if (k == HD_KERNEL_SYMMETRIC) trial_want_symmetric(w, load);
            else trial_want_field(w, load, load, 0);
            for (v = 0; v < n; v++) {
                CHECK_MSG(src_near(w, v, u[v], b[v] + 1e-12 * size), "%s, source %d, time %d: %g for %g, bound %g", w->text,
                    q / 3, q % 3, u[v], (double)w->want[v], b[v]);
                if (q % 3 == 1) CHECK_MSG(b[v] <= 1e-2 * size, "%s, source %d: bound %g of %g", w->text, q / 3, b[v], size);
                if (lap->row[v] < 0) CHECK(u[v] == (lap->row[v] == HD_ROW_INERT && k == HD_KERNEL_OPERATOR ? load[v] : 0));
            }
        }
    }
}

/* The truth of distances of a kind from source k, infinite ones as HUGE_VAL, into want. */
static void src_want_distances(trial_work *w, hd_distance_kind kind, double t, const hd_sources *s, int32_t k) {
    const hd_laplacian *lap = w->s->lap;
    const double *load = src_load(s, k, lap->n);
    quad *share = (quad *)kit_keep(truth_room(lap->n, sizeof(quad)), free), sum = 0;
    int32_t v, p, own = -2;
    int apart = 0;
    trial_distance_for(w, kind, 2 * t, 0);
    for (v = 0; v < lap->n; v++) sum += load[v];
    for (v = 0; v < lap->n; v++) share[v] = load[v] / sum;
    for (p = 0; p < lap->n; p++) {
        const int32_t r = lap->row[p];
        if (load[p] == 0) continue;
        apart |= r < 0 || (own != -2 && lap->component[r] != own);
        own = r < 0 ? -1 : lap->component[r];
    }
    for (v = 0; v < lap->n; v++) {
        const int out = trial_timeless(kind) && (apart || lap->row[v] < 0 || lap->component[lap->row[v]] != own);
        w->want[v] = out ? (quad)HUGE_VAL : trial_want_distance_from(w, share, v, kind == HD_DISTANCE_WEIGHTED, w->off + v);
        if (out) w->off[v] = 0;
    }
}

static void src_pair_distances(trial_work *w, const hd_spectrum *z, const src_room *room) {
    const hd_laplacian *lap = w->s->lap;
    const double t = (lap->conserves ? 100 : 5) * w->s->unit;
    const int32_t n = lap->n;
    double *D = KIT_NEW(double, SRC_KINDS * n), *bound = KIT_NEW(double, SRC_KINDS * n);
    int32_t v;
    int kind, q;
    for (kind = 0; kind < 4; kind++) {
        for (q = 0; q < SRC_KINDS; q++)
            CHECK(hd_spectrum_distance(z, (hd_distance_kind)kind, kind < 2, &t, &room[q].s, D + q * n, bound + q * n, 0, NULL) == HD_OK);
        for (q = 0; q < SRC_KINDS; q++) {
            const double size = dense_max_abs(D, n);
            src_want_distances(w, (hd_distance_kind)kind, t, &room[q].s, 0);
            for (v = 0; v < n; v++) {
                const double d = D[(size_t)q * (size_t)n + (size_t)v], b = bound[(size_t)q * (size_t)n + (size_t)v];
                CHECK_MSG(d == (double)w->want[v] || src_near(w, v, d, b + (size < HUGE_VAL ? 1e-13 * size : 0)),
                    "%s, distance %d from source %d: %g for %g, bound %g", w->text, kind, q, d,
                          (double)w->want[v], b);
            }
        }
    }
}

/* A source that is a vertex is that vertex, to the last bit. */
static void src_pair_same(const hd_laplacian *lap, const hd_spectrum *z) {
    const int32_t n = lap->n, id[2] = {lap->vertex[lap->n_active / 2], n - 1};
    const double times[2] = {trial_unit(lap), 30 * trial_unit(lap)};
    double *room = KIT_NEW(double, 16 * n), *U = room, *V = room + 4 * n, *a = room + 8 * n, *b = room + 12 * n;
    const int64_t first[3] = {0, 1, 2};
    hd_sources s = hd_vertices(2, id);
    int k;
    s.first = first;
    for (k = 0; k < 6; k++) {                    /* two kernels, four kinds of distances */
        const int32_t n_times = k < 4 ? 2 : 1;
        const size_t bytes = (size_t)(2 * n_times * n) * sizeof *U;
        if (k < 2) CHECK(hd_spectrum_columns(z, (hd_kernel)k, 2, times, VERTICES(2, id), U, a, 0, NULL) == HD_OK &&
                hd_spectrum_columns(z, (hd_kernel)k, 2, times, &s, V, b, 0, NULL) == HD_OK);
        else CHECK(hd_spectrum_distance(z, (hd_distance_kind)(k - 2), n_times, times, VERTICES(2, id), U, a, 0, NULL) == HD_OK &&
                   hd_spectrum_distance(z, (hd_distance_kind)(k - 2), n_times, times, &s, V, b, 0, NULL) == HD_OK);
        CHECK(memcmp(U, V, bytes) == 0 && memcmp(a, b, bytes) == 0);
    }
}

/* Two sources of a call have the answers of each alone, to the last bit. */
static void src_pair_together(const hd_laplacian *lap, const hd_spectrum *z) {
    const double times[2] = {trial_unit(lap), 30 * trial_unit(lap)};
    const int32_t n = lap->n;
    double *room = KIT_NEW(double, 16 * n), *U = room, *V = room + 4 * n, *a = room + 8 * n, *b = room + 12 * n;
    src_room both, one[2];
    int w, k, q;
    for (w = 0; w < 4; w++)
        for (k = 0; k < 6 && src_pair_of(&both, one, lap, w); k++) {       /* two kernels, four kinds of distances */
            const int32_t m = k < 4 ? 2 : 1;
            const size_t bytes = (size_t)(2 * m * n) * sizeof *U;
            if (k < 2) CHECK(hd_spectrum_columns(z, (hd_kernel)k, m, times, &both.s, U, a, 0, NULL) == HD_OK);
            else CHECK(hd_spectrum_distance(z, (hd_distance_kind)(k - 2), m, times, &both.s, U, a, 0, NULL) == HD_OK);
            for (q = 0; q < 2; q++) {
                double *v = V + m * q * n, *off = b + m * q * n;
                if (k < 2) CHECK(hd_spectrum_columns(z, (hd_kernel)k, m, times, &one[q].s, v, off, 0, NULL) == HD_OK);
                else CHECK(hd_spectrum_distance(z, (hd_distance_kind)(k - 2), m, times, &one[q].s, v, off, 0, NULL) == HD_OK);
            }
            CHECK_MSG(memcmp(U, V, bytes) == 0 && memcmp(a, b, bytes) == 0, "pair %d, query %d: %g", w, k, dense_max_diff(U, V, 2 * m * n));
        }
}

/* Farthest points from two sources: those of brute force with true distances. turn: by which the kind of the sources goes. */
static void src_samples(trial_work *w, int turn) {
    enum { COUNT = 6, FROM = 2 };
    const hd_laplacian *lap = w->s->lap;
    const double t = (lap->conserves ? 10 : 3) * w->s->unit;
    const int32_t n = lap->n;
    double *near = KIT_NEW(double, n), distance[COUNT], own[COUNT];
    int kind, q;
    for (kind = 0; kind < 4; kind++) {
        hd_heat *heat = kit_heat(lap, "poles=kernel degree=14");
        int32_t vertex[COUNT], again[COUNT], v;
        src_room both, alone[2];
        hd_report rep;
        (void)src_pair_of(&both, alone, lap, (turn + kind) % 2);
        for (v = 0; v < n; v++) near[v] = HUGE_VAL;
        CHECK_MSG(hd_heat_sample(heat, (hd_distance_kind)kind, t, &both.s, COUNT, vertex, distance, &rep, NULL) >= 0,
            "%s: %s", w->text, rep.error.text);
        for (q = -FROM; q < COUNT; q++) {
            double best = -1;
            if (q >= 0) {
                const double far = near[vertex[q]];
                for (v = 0; v < n; v++)
                    if (lap->row[v] >= 0) best = fmax(best, near[v]);
                CHECK_MSG(far == best || far >= best * (1 - 1e-5), "%s, distance %d, point %d: %g is not the largest, %g",
                    w->text, kind, q, far, best);
                CHECK_MSG(distance[q] == far || fabs(distance[q] - far) <= 1e-5 * far,
                    "%s, distance %d, point %d: distance %g, not %g", w->text, kind, q, distance[q], far);
            }
            if (q < 0) src_want_distances(w, (hd_distance_kind)kind, t, &both.s, FROM + q);
            else src_want_distances(w, (hd_distance_kind)kind, t, VERTICES(COUNT, vertex), q);
            for (v = 0; v < n; v++) near[v] = fmin(near[v], (double)w->want[v]);
        }
        /* a point found, as a source, is that point; and without sources the first vertex comes first */
        CHECK(heat_sample(heat, (hd_distance_kind)kind, t, COUNT, again, distance, &rep) >= 0 && again[0] == lap->vertex[0] &&
            distance[0] == 0);
        CHECK(hd_heat_sample(heat, (hd_distance_kind)kind, t, VERTICES(1, again), COUNT - 1, vertex, own, &rep, NULL) >= 0 &&
            memcmp(vertex, again + 1, sizeof vertex - sizeof *vertex) == 0);
        for (q = 1; q < COUNT; q++) CHECK(own[q - 1] == distance[q] || fabs(own[q - 1] - distance[q]) <= 1e-5 * distance[q]);
        CHECK(hd_heat_sample(heat, (hd_distance_kind)kind, t, VERTICES(0, NULL), 2, vertex, own, &rep, NULL) >= 0);
        CHECK(vertex[0] == lap->vertex[0] && own[0] == 0 && vertex[1] == again[1]);
    }
}

static void src_pairs(void) {
    static const char *const pairs[] = {"shape=flat/8/7/0.3 op=fem", "shape=flat/8/7/0.3 op=vor",
        "shape=flat/8/7/0.3 op=fem+held", "shape=qtorus/8/6 op=poly", "shape=cloud/50/0 op=tuft",
                                        "shape=tangle op=vor+id"};
    int k;
    for (k = 0; k < (int)(sizeof pairs / sizeof *pairs); k++) {
        const int32_t mark = kit_mark();
        trial_work *w = case_truth_of(pairs[k]);
        const hd_laplacian *lap = w->s->lap;
        src_room room[SRC_KINDS];
        hd_spectrum_opts o;
        hd_spectrum *z = NULL;
        src_make_all(room, lap);
        memset(&o, 0, sizeof o);
        o.count = 2 * lap->n_active / 3;
        if (CHECK(hd_spectrum_create(&z, lap, &o, NULL) == HD_OK)) {
            if (k < 4) src_pair_columns(w, z, room);
            if (k < 4) src_pair_distances(w, z, room);
            src_pair_same(lap, z);
            src_pair_together(lap, z);
        }
        src_samples(w, k);
        hd_spectrum_free(z);
        kit_release(mark);
    }
}

/* The report of farthest points is one of distances: the same evidence, and a bound as small. */
static void src_sample_report(void) {
    const hd_laplacian *lap = kit_pair("bumpy/2/5 fem");
    const double t[2] = {3 * lap->h * lap->h, 1000 * lap->h * lap->h};
    double *d = KIT_NEW(double, lap->n), far[4];
    int32_t vertex[5];
    int q;
    for (q = 0; q < 6; q++) {                    /* two kinds at two times, two without a time */
        const hd_distance_kind kind = (hd_distance_kind)(q < 4 ? q / 2 : q - 2);
        hd_heat *heat = kit_heat(lap, "");
        hd_report one, all;
        vertex[0] = 7;
        CHECK(hd_heat_sample(heat, kind, t[q % 2], VERTICES(1, vertex), 4, vertex + 1, far, &all, NULL) >= 0);
        CHECK(heat_distance(heat, kind, 1, t + q % 2, 1, vertex, d, 0, &one) >= 0);
        CHECK_MSG(all.evidence_rational == one.evidence_rational && all.evidence_solver == one.evidence_solver &&
            all.evidence_rounding == one.evidence_rounding,
                  "kind %d, t %d: evidence %d %d %d", (int)kind, q % 2, (int)all.evidence_rational, (int)all.evidence_solver,
                      (int)all.evidence_rounding);
        CHECK_MSG(all.error_bound > 0 && all.error_bound <= 1e-6 && all.error_bound <= 10 * one.error_bound,
            "kind %d, t %d: bound %g, of distances %g", (int)kind, q % 2, all.error_bound,
                  one.error_bound);
    }
}

/* ---- closed forms ---- */

/* The kernel of an interval of length 1 with isolated ends. */
static double src_interval(double t, double x, double y) {
    const double pi = BORD_PI;
    double sum = 1;
    int k;
    for (k = 1; k < 200; k++) sum += 2 * exp(-t * pi * pi * k * k) * cos(pi * k * x) * cos(pi * k * y);
    return sum;
}

/* The corners and the barycentric coordinates of the place x, y of the unit square of n x n vertices without jitter. */
static void src_place(const shape *s, double x, double y, int32_t *vertex, double *bary) {
    int32_t f, q;
    for (f = 0; f < s->n_tri; f++) {
        const int32_t *v = s->tri + 3 * f;
        const double *a = s->xyz + 3 * v[0], *b = s->xyz + 3 * v[1], *c = s->xyz + 3 * v[2];
        const double area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        bary[1] = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
        bary[2] = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
        bary[0] = 1 - bary[1] - bary[2];
        if (bary[0] < -1e-12 || bary[1] < -1e-12 || bary[2] < -1e-12) continue;
        for (q = 0; q < 3; q++) {
            vertex[q] = v[q];
            bary[q] = fmax(0, bary[q]);
        }
        return;
    }
    CHECK(0);
}

/* The mean error of the column of a point in a face, at t = 0.02, or of the squared distance. (The largest one of distances is that of the
 * diagonal at two corners of the square, for vertices as for other sources, and falls like h^1.7.) */
static double src_square_error(const char *spec, int distance) {
    const shape *s = kit_shape(spec);
    const hd_laplacian *lap = kit_triangles(s, HD_LAPLACIAN_FEM);
    hd_heat *heat = kit_heat(lap, "");
    const double t = 0.02, px = 1 / 3.0, py = 2 / 3.0, ss = src_interval(2 * t, px, px) * src_interval(2 * t, py, py);
    double *u = KIT_NEW(double, s->n), off = 0;
    src_room room;
    int32_t v;
    src_make(&room, lap, 0);
    src_place(s, px, py, room.vertex, room.bary);
    CHECK((distance ? hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, &room.s, u, 0, NULL, NULL)
                    : hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t, &room.s, u, 0, NULL, NULL)) == HD_OK);
    for (v = 0; v < s->n; v++) {
        const double x = s->xyz[3 * v], y = s->xyz[3 * v + 1], at = distance ? 2 * t : t;
        const double k = src_interval(at, px, x) * src_interval(at, py, y), vv = src_interval(2 * t, x, x) * src_interval(2 * t, y, y);
        const double diff = distance ? u[v] * u[v] - (ss - 2 * k + vv) : u[v] - k;
        off += diff * diff;
    }
    return sqrt(off / s->n);
}

static void src_square(void) {
    int q;
    for (q = 0; q < 2; q++) {
        const double a = src_square_error("flat/17/17/0", q), b = src_square_error("flat/33/33/0", q), c = src_square_error("flat/65/65/0", q);
        CHECK_MSG(a / b > 3.7 && b / c > 3.8 && c < 0.005, "%s: errors %g %g %g", q ? "distance" : "column", a, b, c);
    }
}

/* A line across the square of n x n vertices, its crossings of rows and of diagonals, or with the middles between them. Returns how many points. */
static int32_t src_crossings(const shape *s, int32_t n, double x, int middles, int32_t *vertex, double *bary) {
    const double cell = 1.0 / (n - 1), at = x - floor(x / cell) * cell;
    int32_t q, count = 0;
    for (q = 0; q < 2 * n - 1; q++) {
        const double y = q / 2 * cell + (q % 2 ? at : 0), next = (q + 1) / 2 * cell + (q % 2 ? 0 : at);
        src_place(s, x, y, vertex + 3 * count, bary + 3 * count);
        count++;
        if (!middles || q == 2 * n - 2) continue;
        src_place(s, x, (y + next) / 2, vertex + 3 * count, bary + 3 * count);
        count++;
    }
    return count;
}

/* Heat of a line depends on x alone; the load is exact for linear functions, and does not feel how the line is cut. */
static void src_line(void) {
    enum { N = 33 };
    const shape *s = kit_shape("flat/33/33/0");
    const hd_laplacian *lap = kit_triangles(s, HD_LAPLACIAN_VORONOI_COT);
    hd_heat *heat = kit_heat(lap, "");
    int32_t *vertex = KIT_NEW(int32_t, 12 * N), v;
    double *bary = KIT_NEW(double, 12 * N), *u = KIT_NEW(double, s->n), *w = KIT_NEW(double, s->n), off = 0, sum[3] = {0, 0, 0};
    const double t = 0.02, x = 0.3717, zero = 0;
    src_room room;
    src_make(&room, lap, 0);
    room.s.curve = 1;
    room.s.vertex = vertex;
    room.s.bary = bary;
    room.first[1] = src_crossings(s, N, x, 0, vertex, bary);
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &zero, &room.s, w, 0, NULL, NULL) == HD_OK);
    for (v = 0; v < s->n; v++) {
        sum[0] += w[v];
        sum[1] += w[v] * s->xyz[3 * v];
        sum[2] += w[v] * s->xyz[3 * v + 1];
    }
    CHECK_MSG(fabs(sum[0] - 1) < 1e-13 && fabs(sum[1] - x) < 1e-13 && fabs(sum[2] - 0.5) < 1e-13, "line: %.17g %.17g %.17g", sum[0], sum[1], sum[2]);
    CHECK(hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t, &room.s, u, 0, NULL, NULL) == HD_OK);
    for (v = 0; v < s->n; v++) off = fmax(off, fabs(u[v] - src_interval(t, x, s->xyz[3 * v])));
    CHECK_MSG(off < 0.01, "line: heat is off by %g", off);
    room.first[1] = src_crossings(s, N, x, 1, vertex, bary);
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &zero, &room.s, u, 0, NULL, NULL) == HD_OK);
    CHECK_MSG(dense_max_diff(u, w, s->n) < 1e-15, "line: cut again it is off by %g", dense_max_diff(u, w, s->n));
}

/* ---- geodesic distances ---- */

/* A source of points in triangles. The arrays stay the caller's. */
static hd_sources src_in_triangles(int64_t first[2], int32_t points, const int32_t *vertex, const double *bary) {
    hd_sources s = hd_vertices(1, vertex);
    first[0] = 0;
    first[1] = points;
    s.first = first;
    s.corners = 3;
    s.bary = bary;
    return s;
}

static double src_gap(const double *a, const double *b) { return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2)); }

/* A plan of the triangles of a shape: 0 as they are, 1 by their lengths, 2 intrinsic Delaunay, 3 tufted, 4 as polygons that are split, 5 points. */
static hd_geodesic *src_plan(const shape *s, int kind, hd_geodesic_border border, double t) {
    shape_poly p = kit_own_poly(shape_poly_of(s));
    double *length = KIT_NEW(double, 3 * s->n_tri);
    hd_geodesic *g = NULL;
    hd_geodesic_opts o;
    hd_error e;
    int32_t q;
    memset(&o, 0, sizeof o);
    o.t = t;
    o.border = border;
    o.triangulation = kind == 2 || kind == 4 ? HD_TRIANGULATION_DELAUNAY : kind == 3 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
    for (q = 0; q < 3 * s->n_tri; q++) length[q] = src_gap(s->xyz + 3 * s->tri[q], s->xyz + 3 * s->tri[q % 3 == 2 ? q - 2 : q + 1]);
    if (kind == 1) (void)hd_geodesic_create(&g, MESH_LENGTHS(length, s->n, s->tri, s->n_tri), &o, &e);
    else if (kind == 4) (void)hd_geodesic_create(&g, MESH_POLYGONS(p.xyz, p.n, p.face_ptr, p.face_idx, p.n_faces), &o, &e);
    else if (kind == 5) (void)at_tufted_geodesic(&g, s->xyz, s->n, &o, &e);
    else (void)hd_geodesic_create(&g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e);
    CHECK_MSG(g != NULL, "plan %d: %s", kind, e.text);
    return g;
}

/* For test_lengths.h; freed by the caller. */
static hd_geodesic *src_geodesic(const shape *s, double t) { return src_plan(s, 0, HD_GEODESIC_BORDER_NATURAL, t); }

static void src_free_geodesic(void *g) { hd_geodesic_free((hd_geodesic *)g); }
static hd_geodesic *src_kept(hd_geodesic *g) { return (hd_geodesic *)kit_keep(g, src_free_geodesic); }

/* Points of faces of the sphere: the largest and the mean error in edges, which are those of vertices; and exact corners. */
static void src_geo_sphere(const char *spec) {
    const shape *s = kit_shape(spec);
    hd_geodesic *g = src_kept(src_geodesic(s, 0));
    double *d = KIT_NEW(double, s->n), most = 0, mean = 0, h = 0;
    int q, k, i;
    for (q = 0; q < 8; q++) {
        const int32_t f = (7919 * q + 17) % s->n_tri, *v = s->tri + 3 * f;
        const double b[3] = {0.2 + 0.05 * q, 0.5 - 0.03 * q, 0.3 - 0.02 * q};
        double p[3] = {0, 0, 0}, flat[3], size;
        hd_geodesic_report rep;
        int64_t first[2];
        const hd_sources src = src_in_triangles(first, 1, v, b);
        int32_t at;
        CHECK(hd_geodesic_distance(g, &src, d, 0, &rep, NULL) == HD_OK && rep.n_stages == 1 && rep.residual_heat > 0 &&
            rep.residual_heat < 1e-13 && rep.residual_distance < 1e-12);
        h = rep.h;
        for (k = 0; k < 9; k++) p[k % 3] += b[k / 3] * s->xyz[3 * v[k / 3] + k % 3];
        memcpy(flat, p, sizeof p);
        size = sqrt(dense_dot(p, p, 3));
        for (i = 0; i < 3; i++) p[i] /= size;
        for (k = 0; k < 3; k++) CHECK(fabs(d[v[k]] - src_gap(flat, s->xyz + 3 * v[k])) < 1e-14);
        for (at = 0; at < s->n; at++) {
            const double off = fabs(d[at] - 2 * asin(fmin(1, src_gap(p, s->xyz + 3 * at) / 2)));
            most = fmax(most, off);
            mean += off / (8 * s->n);
        }
    }
    CHECK_MSG(most < 0.3 * h && mean < 0.06 * h, "%s: off by %g edges, %g on average", spec, most / h, mean / h);
}

/* Points and a line of the square; a strip, along which heat fades out and is solved for again. */
static void src_geo_flat(void) {
    enum { N = 41, LONG = 1201 };
    const shape *s = kit_shape("flat/41/41/0"), *strip = kit_shape("flat/1201/4/0");
    hd_geodesic *g = src_kept(src_geodesic(s, 0));
    double *d = KIT_NEW(double, strip->n), bary[6 * N], p[2][2] = {{0.213, 0.307}, {0.751, 0.822}}, off[3] = {0, 0, 0}, x = 0.4127, y;
    const double cell = 1.0 / (N - 1);
    int32_t vertex[6 * N], v, q;
    hd_geodesic_report rep;
    int64_t first[2];
    hd_sources src = src_in_triangles(first, 2, vertex, bary);
    for (q = 0; q < 2; q++) src_place(s, p[q][0], p[q][1], vertex + 3 * q, bary + 3 * q);
    CHECK(hd_geodesic_distance(g, &src, d, 0, &rep, NULL) == HD_OK && rep.n_stages == 1);
    for (v = 0; v < s->n; v++) {
        const double *a = s->xyz + 3 * v;
        off[0] += fabs(d[v] - fmin(hypot(a[0] - p[0][0], a[1] - p[0][1]), hypot(a[0] - p[1][0], a[1] - p[1][1]))) / s->n;
    }
    first[1] = src_crossings(s, N, x, 0, vertex, bary);
    src.curve = 1;
    CHECK(hd_geodesic_distance(g, &src, d, 0, &rep, NULL) == HD_OK && rep.n_stages == 1);
    for (v = 0; v < s->n; v++) off[1] = fmax(off[1], fabs(d[v] - fabs(s->xyz[3 * v] - x)));
    CHECK_MSG(off[0] < 0.3 * cell && off[1] < 0.1 * cell, "square: points off by %g edges on average, a line by at most %g",
        off[0] / cell, off[1] / cell);
    x = 10.3 / (LONG - 1);
    y = 1.6 / (LONG - 1);
    src = src_in_triangles(first, 1, vertex, bary);
    src_place(strip, x, y, vertex, bary);
    CHECK(hd_geodesic_distance(src_kept(src_geodesic(strip, 0)), &src, d, 0, &rep, NULL) == HD_OK && rep.n_stages > 1);
    for (v = 0; v < strip->n; v++) off[2] = fmax(off[2], fabs(d[v] - hypot(strip->xyz[3 * v] - x, strip->xyz[3 * v + 1] - y)));
    CHECK_MSG(off[2] < 1.0 / (LONG - 1), "strip: off by %g edges", off[2] * (LONG - 1));
}

/* Vertices give what they give as such, to the last bit; points in no face, and components. */
static void src_geo_rules(void) {
    const double apart[3] = {5, 0, 0};
    const shape *a = kit_shape("ico/2"), *b = kit_shape("flat/6/5/0.2");
    shape s = kit_own_shape(shape_disjoint(a, b, apart));
    hd_geodesic *g = src_kept(src_geodesic(&s, 0));
    double *d = KIT_NEW(double, s.n), *e = KIT_NEW(double, s.n), bary[6] = {0, 1, 0, 1, 0, 0};
    int32_t vertex[6] = {0, 5, 1, a->n + 3, 0, 9}, id[2] = {5, a->n + 3}, v;
    hd_geodesic_report rep;
    hd_error err;
    int64_t first[2];
    hd_sources src = src_in_triangles(first, 2, vertex, bary);
    CHECK(hd_geodesic_distance(g, &src, d, 0, &rep, NULL) == HD_OK && hd_geodesic_distance(g, TOGETHER(2, id), e, 0, NULL, NULL) == HD_OK);
    CHECK(memcmp(d, e, (size_t)s.n * sizeof *d) == 0);
    first[1] = 1;
    memcpy(vertex, s.tri, 3 * sizeof *vertex);
    bary[0] = bary[1] = bary[2] = 1 / 3.0;
    CHECK(hd_geodesic_distance(g, &src, d, 0, NULL, NULL) == HD_OK);
    for (v = 0; v < s.n; v++) CHECK(v < a->n ? d[v] >= 0 && d[v] < 4 : d[v] == HUGE_VAL);
    first[1] = 2;
    vertex[4] = a->n + 4;                        /* no face has these three */
    vertex[5] = a->n + 20;
    bary[4] = bary[5] = 0.25;
    bary[3] = 0.5;
    CHECK(hd_geodesic_distance(g, &src, d, 0, &rep, &err) == HD_ERR_ARGUMENT && err.column == 0 && err.row == 1 &&
        strstr(err.text, "no face") && rep.status == err.status);
    src.curve = 1;
    CHECK(hd_geodesic_distance(g, &src, d, 0, NULL, &err) == HD_ERR_ARGUMENT && err.row == 0);
    bary[1] = -1;
    CHECK(hd_geodesic_distance(g, &src, d, 0, NULL, &err) == HD_ERR_ARGUMENT && err.row == 0 && err.vertex == vertex[1]);
    CHECK(hd_geodesic_distance(g, NULL, d, 0, NULL, &err) == HD_ERR_ARGUMENT &&
        hd_geodesic_distance(g, &src, NULL, 0, NULL, &err) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(NULL, &src, d, 0, NULL, &err) == HD_ERR_ARGUMENT);
}

/* Where another kind of plan has the same triangles, it gives the same distances from points in faces, on an edge, and from curves. */
static void src_geo_kinds(void) {
    static const double bary[9] = {0.2, 0.3, 0.5, 0, 0.6, 0.4, 0.7, 0.2, 0.1};
    int q, kind, which;
    for (q = 0; q < 4; q++) {                    /* a sphere, and a cap with three kinds of borders */
        const shape *s = kit_shape(q ? "disk/6/1" : "ico/2");
        const hd_geodesic_border border = (hd_geodesic_border)(q ? q - 1 : 0);
        double *d = KIT_NEW(double, s->n), *want = KIT_NEW(double, s->n);
        hd_geodesic *g = src_kept(src_plan(s, 0, border, 0.02));
        for (kind = 1; kind <= (q ? 4 : 5); kind++) {
            hd_geodesic *other = src_kept(src_plan(s, kind, border, 0.02));
            for (which = 0; which < 3; which++) {    /* a point; three points, of two faces; a curve in a face */
                int32_t vertex[9], p;
                int64_t first[2];
                hd_sources src = src_in_triangles(first, which == 0 ? 1 : 3, vertex, bary);
                for (p = 0; p < 3; p++) memcpy(vertex + 3 * p, s->tri + 3 * (which == 1 && p == 2 ? s->n_tri / 2 : 3), 3 * sizeof *vertex);
                src.curve = which == 2;
                CHECK(hd_geodesic_distance(g, &src, want, 0, NULL, NULL) == HD_OK &&
                    hd_geodesic_distance(other, &src, d, 0, NULL, NULL) == HD_OK);
                CHECK_MSG(dense_max_diff(d, want, s->n) < 1e-11, "border %d, plan %d, source %d: off by %g", q, kind, which,
                    dense_max_diff(d, want, s->n));
            }
        }
    }
}

/* The largest error of a source on a square: the points, or the straight line from the first to the last of them. -1: it was refused. */
static double src_square_off(hd_geodesic *g, const shape *s, const hd_sources *src, hd_error *e) {
    double *d = KIT_NEW(double, s->n), p[8][2] = {{0, 0}}, most = -1;
    hd_geodesic_report rep;
    const int32_t points = (int32_t)src->first[1];
    int32_t q, c, v;
    if (hd_geodesic_distance(g, src, d, 0, &rep, e) == HD_OK && rep.residual_heat < 1e-13) {
        for (q = 0; q < points; q++)
            for (c = 0; c < 6; c++) p[q][c % 2] += src->bary[3 * q + c / 2] * s->xyz[3 * src->vertex[3 * q + c / 2] + c % 2];
        for (v = 0; v < s->n; v++) {
            const double *x = s->xyz + 3 * v;
            double want = HUGE_VAL;
            for (q = 0; q < points; q++) want = fmin(want, hypot(x[0] - p[q][0], x[1] - p[q][1]));
            if (src->curve) {
                const double dx = p[points - 1][0] - p[0][0], dy = p[points - 1][1] - p[0][1];
                const double at = fmax(0, fmin(1, ((x[0] - p[0][0]) * dx + (x[1] - p[0][1]) * dy) / (dx * dx + dy * dy)));
                want = hypot(p[0][0] + at * dx - x[0], p[0][1] + at * dy - x[1]);
            }
            most = fmax(most, fabs(d[v] - want));
        }
        for (q = 0; q < points && !src->curve; q++)
            for (c = 0; c < 3; c++) {
                const int32_t corner = src->vertex[3 * q + c];
                if (src->bary[3 * q + c] > 0) CHECK(fabs(d[corner] - hypot(s->xyz[3 * corner] - p[q][0], s->xyz[3 * corner + 1] - p[q][1])) < 1e-14);
            }
    }
    return most;
}

/* Where heat is held at zero no point and no piece of a source may have a corner: it would be far off, or have no heat at all. */
static void src_geo_borders(void) {
    enum { N = 41, A = N / 2, KINDS = 7 };
    static const double third[6] = {1 / 3.0, 1 / 3.0, 1 / 3.0, 1 / 3.0, 1 / 3.0, 1 / 3.0}, edge[3] = {0.5, 0.5, 0};
    static const double first[9] = {1, 0, 0, 1, 0, 0, 1, 0, 0};
    static const struct { const char *what; int32_t count, curve, vertex[9], row; const double *bary; } at[KINDS] = {
        {"one corner", 1, 0, {A, A + 1 + N, A + N}, 0, third},
        {"two corners", 1, 0, {A, A + 1, A + 1 + N}, 0, third},
        {"three corners", 1, 0, {N - 2, N - 1, 2 * N - 1}, 0, third},
        {"an edge", 1, 0, {A, A + 1, A + 1 + N}, 0, edge},
        {"one of two points", 2, 0, {30 * N + A, 30 * N + A + 1, 31 * N + A + 1, A, A + 1, A + 1 + N}, 1, third},
        {"a curve that ends there", 3, 1, {A + 2 * N, A, A + 1, A + N, A, A + 1, A, A + N, A + 1}, 1, first},
        {"vertices beside it", 2, 0, {A + N, A, A + 1, A + N + 1, A, A + 1}, -1, first}};
    const int32_t stays[6] = {A + 4 * N, A, A + 1, A + 4 * N, A, A + 1};
    const shape *s = kit_shape("flat/41/41/0");
    int b, q;
    for (b = 0; b < 3; b++) {
        const int zero = b == HD_GEODESIC_BORDER_DIRICHLET;
        hd_geodesic *g = src_kept(src_plan(s, 0, (hd_geodesic_border)b, 0));
        int64_t points[2];
        hd_sources src;
        double off;
        hd_error e;
        for (q = 0; q < KINDS; q++) {
            src = src_in_triangles(points, at[q].count, at[q].vertex, at[q].bary);
            src.curve = at[q].curve;
            off = src_square_off(g, s, &src, &e);
            if (zero && at[q].row >= 0) CHECK_MSG(off < 0 && e.status == HD_ERR_ARGUMENT && e.row == at[q].row && e.column == 0 &&
                    strstr(e.text, "border"), "%s: %g, row %d", at[q].what, off, (int)e.row);
            else CHECK_MSG(off >= 0 && off < (zero ? 0.13 : 0.05), "border %d, %s: off by %g", b, at[q].what, off);
        }
        src = src_in_triangles(points, 2, stays, first); /* a curve that stays where it is */
        src.curve = 1;
        CHECK(src_square_off(g, s, &src, &e) < 0 && e.status == HD_ERR_ARGUMENT);
    }
}

/* A point of the square of n x n vertices above and right of this one: in the lower triangle, between the two, in the upper one. */
static void src_geo_point(int32_t base, int way, int32_t n, int32_t *vertex, double *bary) {
    vertex[0] = base;
    vertex[1] = way == 2 ? base + n : base + 1;
    vertex[2] = base + n + 1;
    bary[0] = 0.375;
    bary[1] = way == 1 ? 0 : 0.25;
    bary[2] = 1 - bary[0] - bary[1];
}

/* Sources of a call have the distances of each alone, to the last bit: vertices, points of triangles, curves. Weights and lengths say
 * nothing, and what is wrong with one source is told of it. */
static void src_geo_together(void) {
    enum { N = 41, A = 30 * N + N / 2 };
    static const double some[7] = {5, 0, 2, 0.5, 7, 1, 0};
    static const int64_t first[3][4] = {{0, 2, 3, 6}, {0, 1, 3, 4}, {0, 2, 5, 7}};
    static const int32_t id[6] = {A, 3 * N + 7, A + 5, 12 * N + 1, A, 35 * N + 35};
    static const int32_t base[2][7] = {{0, 3, 90, -90}, {0, 0, 5, 5, 5, -8, -8}}, way[2][7] = {{0, 1, 2, 0}, {0, 1, 0, 1, 2, 1, 2}};
    const shape *s = kit_shape("flat/41/41/0");
    double *D = KIT_NEW(double, 3 * s->n), *d = KIT_NEW(double, s->n), bary[21];
    int32_t vertex[21], q;
    hd_error e;
    int w, border;
    for (border = 0; border < 3; border++) {
        hd_geodesic *g = src_kept(src_plan(s, 0, (hd_geodesic_border)border, 0));
        for (w = 0; w < 3; w++) {
            hd_sources all = hd_vertices(3, w ? vertex : id);
            for (q = 0; q < 7 && w; q++) src_geo_point(A + base[w - 1][q], way[w - 1][q], N, vertex + 3 * q, bary + 3 * q);
            all.first = first[w];
            all.corners = w ? 3 : 0;
            all.bary = w ? bary : NULL;
            all.curve = w == 2;
            CHECK_MSG(hd_geodesic_distance(g, &all, D, 0, NULL, &e) == HD_OK, "sources %d: %s", w, e.text);
            for (q = 0; q < 3; q++) {
                hd_sources one = all;
                one.count = 1;
                one.first = first[w] + q;
                one.weight = w < 2 ? some : NULL;
                one.length = some;
                CHECK(hd_geodesic_distance(g, &one, d, 0, NULL, NULL) == HD_OK);
                CHECK_MSG(memcmp(d, D + q * s->n, (size_t)s->n * sizeof *d) == 0, "border %d, sources %d: column %d is off by %g", border,
                    w, q,
                          dense_max_diff(d, D + q * s->n, s->n));
            }
            if (!w && border == HD_GEODESIC_BORDER_DIRICHLET) {
                int32_t bad[6] = {A, A + 1, A + 2, A + 3, 0, A + 4};
                all.vertex = bad;
                CHECK(hd_geodesic_distance(g, &all, D, 0, NULL, &e) == HD_ERR_ARGUMENT && e.column == 2 && e.row == 1 && e.vertex == 0);
                CHECK(hd_geodesic_distance(g, VERTICES(5, bad), D, 0, NULL, &e) == HD_ERR_ARGUMENT && e.column == 4 && e.row == 0);
            }
            if (!w) continue;
            vertex[3 * first[w][1] + 3] = 0;     /* the second point of the second source is in no face: nor is a piece to it */
            CHECK(hd_geodesic_distance(g, &all, D, 0, NULL, &e) == HD_ERR_ARGUMENT && strstr(e.text, "no face"));
            CHECK_MSG(e.column == 1 && e.row == (w == 1), "sources %d: column %d, row %d", w, (int)e.column, (int)e.row);
        }
    }
}

/* ---- errors ---- */

/* Columns and distances: the status, and the source, the point and the vertex that are told. */
static void src_refused(hd_heat *heat, const hd_sources *s, hd_status want, int64_t column, int64_t row, int64_t vertex, const char *what) {
    const double t = 1;
    double u[200];
    hd_report rep;
    const hd_status st = hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, s, u, 0, &rep, NULL);
    CHECK_MSG(st == want && rep.error.column == column && rep.error.row == row && rep.error.vertex == vertex,
        "%s: %s, %s, column %d, row %d, vertex %d", what,
              hd_status_name(rep.status), rep.error.text, (int)rep.error.column, (int)rep.error.row, (int)rep.error.vertex);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, s, u, 0, &rep, NULL) == want);
}

/* One vertex of weight 2 is twice its column, and a vertex that is held has no heat to give, whatever its weight. */
static void src_one_vertex(hd_heat *heat, int32_t held) {
    enum { N = 25 };
    const int32_t id[2] = {3, held};
    const double t = 1, two = 2;
    double u[N], v[N];
    hd_sources s;
    int32_t i;
    int k;
    for (k = 0; k < 2; k++) {
        s = hd_vertices(1, id);
        s.weight = &two;
        CHECK(hd_heat_columns(heat, (hd_kernel)k, 1, &t, &s, u, 0, NULL, NULL) == HD_OK &&
            hd_heat_columns(heat, (hd_kernel)k, 1, &t, VERTICES(1, id), v, 0, NULL, NULL) == HD_OK);
        for (i = 0; i < N; i++) CHECK(fabs(u[i] - 2 * v[i]) <= 1e-9 * fabs(v[3]));
        s.vertex = id + 1;
        CHECK(hd_heat_columns(heat, (hd_kernel)k, 1, &t, &s, u, 0, NULL, NULL) == HD_OK && dense_max_abs(u, N) == 0);
    }
}

/* Weights near both ends of what is allowed: the answer is that of weight 1, times the weight, by every method. */
static void src_far_weights(void) {
    static const char *const methods[3] = {"method=direct", "method=iterative", "method=krylov"};
    static const int exponents[3] = {0, 300, -300};
    static const int32_t id[2] = {3, 11};
    static const int64_t first[2] = {0, 2};
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    const double t = 3 * lap->h * lap->h;
    double *u = KIT_NEW(double, lap->n), *one = KIT_NEW(double, lap->n), weight[2];
    hd_sources s = hd_vertices(1, id);
    int32_t i;
    int q, k;
    s.first = first;
    s.weight = weight;
    for (q = 0; q < 6; q++) {
        hd_heat *heat = kit_heat(lap, methods[q / 2]);
        for (k = 0; k < 3; k++) {
            hd_report rep;
            weight[0] = ldexp(1, exponents[k]);
            weight[1] = ldexp(0.5, exponents[k]);
            CHECK(hd_heat_columns(heat, (hd_kernel)(q % 2), 1, &t, &s, k ? u : one, 0, &rep, NULL) == HD_OK && rep.error_bound <= 1e-6);
            for (i = 0; i < lap->n && k; i++)
                CHECK_MSG(fabs(ldexp(u[i], -exponents[k]) - one[i]) <= 1e-12 * dense_max_abs(one, lap->n),
                    "%s, 2^%d: %.17g, %.17g", methods[q / 2], exponents[k], ldexp(u[i], -exponents[k]), one[i]);
        }
    }
}

static void src_errors(void) {
    enum { POINTS, CURVE, SINGLE };
    /* a source that is fine, and the one in question */
    static const int32_t id[12] = {1, 2, 6, 1, 2, 6, 1, 2, 6, 2, 6, 7};
    static const double none[2] = {0, 0}, usual[2] = {1, 2}, infinite[2] = {1, HUGE_VAL}, negative[2] = {-1, 2},
        far_off[2] = {1e200, 2}, first_infinite[2] = {HUGE_VAL, 2};
    /* bary4: that of the second point's second corner, one of which has 0.5, 0.25, 0.25; weight, length: NULL for none */
    static const struct { const char *what; int kind, count, corners, cleared, last; double bary4; const double *weight,
        *length; hd_status want; int column, row, vertex; } rows[] = {
        {"fine", POINTS, 2, 3, 1, 7, 0.25, NULL, NULL, HD_OK, -1, -1, -1},
        {"not cleared", POINTS, 2, 3, 0, 7, 0.25, NULL, NULL, HD_ERR_ARGUMENT, -1, -1, -1},
        {"not cleared at its end", POINTS, 2, 3, -1, 7, 0.25, NULL, NULL, HD_ERR_ARGUMENT, -1, -1, -1},
        {"no point", POINTS, 0, 3, 1, 7, 0.25, NULL, NULL, HD_ERR_ARGUMENT, 1, -1, -1},
        {"corners", POINTS, 2, -1, 1, 7, 0.25, NULL, NULL, HD_ERR_ARGUMENT, -1, -1, -1},
        {"too many points", POINTS, 1 << 30, 3, 1, 7, 0.25, NULL, NULL, HD_ERR_TOO_LARGE, 1, -1, -1},
        {"negative", POINTS, 2, 3, 1, 7, -0.25, NULL, NULL, HD_ERR_ARGUMENT, 1, 1, 6},
        {"sum", POINTS, 2, 3, 1, 7, 0.26, NULL, NULL, HD_ERR_ARGUMENT, 1, 1, -1},
        {"infinite", POINTS, 2, 3, 1, 7, HUGE_VAL, NULL, NULL, HD_ERR_NOT_FINITE, 1, 1, 6},
        {"weights", POINTS, 2, 3, 1, 7, 0.25, usual, NULL, HD_OK, -1, -1, -1},
        {"infinite weight", POINTS, 2, 3, 1, 7, 0.25, infinite, NULL, HD_ERR_NOT_FINITE, 1, 1, -1},
        {"no weight", POINTS, 2, 3, 1, 7, 0.25, none, NULL, HD_ERR_ARGUMENT, 1, -1, -1},
        {"weights of a curve", CURVE, 2, 3, 1, 7, 0.25, usual, NULL, HD_ERR_ARGUMENT, -1, -1, -1},
        {"a curve without coordinates", CURVE, 2, 3, 1, 7, 0.25, NULL, NULL, HD_ERR_ARGUMENT, 1, 1, 7},
        {"a curve with lengths", CURVE, 2, 3, 1, 7, 0.25, NULL, usual, HD_OK, -1, -1, -1},
        {"a negative length", CURVE, 2, 3, 1, 7, 0.25, NULL, negative, HD_ERR_ARGUMENT, 1, 0, -1},
        {"no length", CURVE, 2, 3, 1, 7, 0.25, NULL, none, HD_ERR_ARGUMENT, 1, -1, -1},
        {"an infinite length", CURVE, 2, 3, 1, 7, 0.25, NULL, first_infinite, HD_ERR_NOT_FINITE, 1, 0, -1},
        {"a length beyond all", CURVE, 2, 3, 1, 7, 0.25, NULL, far_off, HD_ERR_ARGUMENT, 1, -1, -1},
        {"one point of a curve", CURVE, 1, 3, 1, 7, 0.25, NULL, far_off, HD_ERR_ARGUMENT, 1, -1, -1},
        {"vertices, one held", SINGLE, 6, 1, 1, 7, 0.25, NULL, NULL, HD_OK, -1, -1, -1},
        {"no such vertex", SINGLE, 6, 1, 1, 25, 0.25, NULL, NULL, HD_ERR_INDEX, 1, 5, 25},
        {"a negative vertex", SINGLE, 6, 1, 1, -1, 0.25, NULL, NULL, HD_ERR_INDEX, 1, 5, -1}};
    const int32_t held = 7;
    const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 1, &held);
    hd_laplacian *lap = bord_kept(kit_shape("flat/5/5/0"), &o);
    hd_heat *heat = kit_heat(lap, "");
    double bary[12] = {0.5, 0.25, 0.25, 0.25, 0.5, 0.25, 0.5, 0.25, 0.25, 0.5, 0.25, 0.25}, part[4] = {1, 1, 0, 0}, t = 1, u[75],
        mixed[2] = {1, -1};
    const int64_t one[2] = {0, 2};
    int64_t first[3] = {0, 2, 4};
    int32_t vertex[12], chosen[3];
    hd_sources s, ok;
    hd_spectrum_opts so;
    hd_spectrum *z = NULL;
    hd_report rep;
    hd_error err;
    int q;
    memcpy(vertex, id, sizeof id);
    ok = hd_vertices(2, vertex);
    ok.first = first;
    ok.corners = 3;
    ok.bary = bary;
    for (q = 0; q < (int)(sizeof rows / sizeof *rows); q++) {
        s = ok;
        first[2] = 2 + (int64_t)rows[q].count;
        s.corners = rows[q].corners;
        s.begin_zero = rows[q].cleared == 0;
        s.end_zero = rows[q].cleared < 0;
        s.curve = rows[q].kind == CURVE;
        if (rows[q].weight) memcpy(part + 2, rows[q].weight, 2 * sizeof *part);
        if (rows[q].length) memcpy(part + 2, rows[q].length, 2 * sizeof *part);
        s.weight = rows[q].weight ? part : NULL;
        s.length = rows[q].length ? part : NULL;
        if (rows[q].kind == SINGLE) {
            s.bary = NULL;
            s.vertex = vertex + 4;
        }
        bary[10] = rows[q].bary4;
        vertex[11] = rows[q].last;
        src_refused(heat, &s, rows[q].want, rows[q].column, rows[q].row, rows[q].vertex, rows[q].what);
    }
    first[2] = 4;
    vertex[11] = 7;
    bary[10] = (double)NAN;
    src_refused(heat, &ok, HD_ERR_NOT_FINITE, 1, 1, 6, "no number");
    bary[10] = 0.25;
    first[1] = -1;
    src_refused(heat, &ok, HD_ERR_ARGUMENT, 0, -1, -1, "first points before the first");
    first[1] = 5;
    first[0] = -1;
    src_refused(heat, &ok, HD_ERR_ARGUMENT, 0, -1, -1, "a first point that is none");
    src_one_vertex(heat, held);
    ok.first = one;
    ok.count = 1;
    s = ok;
    s.weight = mixed;                            /* weights that add up to zero: columns, but no distances */
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, &s, u, 0, &rep, NULL) == HD_OK);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, &s, u, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.column == 0);
    s = ok;
    s.vertex = NULL;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, &s, u, 0, &rep, NULL) == HD_ERR_ARGUMENT &&
        strstr(rep.error.text, "must not be NULL"));
    s.count = 0;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, &s, NULL, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, &s, NULL, 0, NULL, NULL) == HD_OK);
    s.count = -1;
    CHECK(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, &s, 2, chosen, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
    s = ok;
    s.begin_zero = 1;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, NULL, u, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, NULL, NULL, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, NULL, NULL, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, &ok, NULL, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, NULL, 2, chosen, NULL, NULL, NULL) == HD_OK);
    CHECK(hd_heat_sample(heat, HD_DISTANCE_CLASSICAL, t, &s, 2, chosen, NULL, &rep, NULL) == HD_ERR_ARGUMENT &&
        strstr(rep.error.text, "cleared"));
    memset(&so, 0, sizeof so);
    so.count = 5;
    CHECK(hd_spectrum_create(&z, lap, &so, NULL) == HD_OK);
    CHECK(hd_spectrum_columns(z, HD_KERNEL_OPERATOR, 1, &t, &s, u, NULL, 0, &err) == HD_ERR_ARGUMENT && strstr(err.text, "cleared"));
    CHECK(hd_spectrum_columns(z, HD_KERNEL_OPERATOR, 1, &t, NULL, u, NULL, 0, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_spectrum_distance(z, HD_DISTANCE_COMMUTE, 2, NULL, &ok, u, NULL, 0, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_spectrum_distance(z, HD_DISTANCE_COMMUTE, 0, NULL, NULL, NULL, NULL, 0, NULL) == HD_ERR_ARGUMENT);
    s.begin_zero = s.count = 0;
    CHECK(hd_spectrum_columns(z, HD_KERNEL_OPERATOR, 1, &t, &s, NULL, NULL, 0, NULL) == HD_OK);
    CHECK(hd_spectrum_distance(z, HD_DISTANCE_COMMUTE, 0, NULL, &s, NULL, NULL, 0, NULL) == HD_OK);
    ok.weight = mixed;                           /* the second source has no weight to divide by */
    ok.first = first;
    ok.count = 2;
    first[0] = 0;
    first[1] = 1;
    first[2] = 2;
    CHECK(hd_spectrum_distance(z, HD_DISTANCE_COMMUTE, 0, NULL, &ok, u, NULL, 0, &err) == HD_ERR_ARGUMENT && err.column == 1);
    hd_spectrum_free(z);
}

/* As many weighted sources as there are vertices: twice their columns. */
static void src_many(void) {
    const hd_laplacian *lap = kit_pair("ico/1 fem");
    const double t = 3 * lap->h * lap->h;
    const int32_t n = lap->n;
    int32_t *id = KIT_NEW(int32_t, n), i;
    double *weight = KIT_NEW(double, n), *u = KIT_NEW(double, n * n), *one = KIT_NEW(double, n * n);
    hd_heat *heat = kit_heat(lap, "method=direct");
    hd_sources s = hd_vertices(n, id);
    for (i = 0; i < n; i++) {
        id[i] = i;
        weight[i] = 2;
    }
    s.weight = weight;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, &s, u, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, VERTICES(n, id), one, 0, NULL, NULL) == HD_OK);
    for (i = 0; i < n * n; i++) CHECK(fabs(u[i] - 2 * one[i]) <= 1e-9);
}

static void test_sources(void) {
    src_many();
    src_cases();
    src_exact();
    src_means();
    src_pairs();
    src_sample_report();
    src_square();
    src_line();
    src_geo_sphere("ico/3");
    src_geo_sphere("ico/4");
    src_geo_flat();
    src_geo_rules();
    src_geo_kinds();
    src_geo_borders();
    src_geo_together();
    src_far_weights();
    src_errors();
}

#endif
