/* test_sources.h - sources that are no vertices: points of faces and edges, weighted points, sets of vertices and curves; against dense
 * eigensolutions with the load vector, closed forms, and the queries of vertices */

#ifndef TEST_SOURCES_H
#define TEST_SOURCES_H

/* ---- sources, and what they are as functionals ---- */

enum { SRC_KINDS = 6, SRC_ROOM = 24 };

/* A source with room for its arrays. */
typedef struct src_room {
    hd_source s;
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

/* Which: a point of a triangle, one of an edge, four vertices, two weighted points, the first and the last vertex of all, a curve. The arrays
 * are those of x. */
static void src_make(src_room *x, const hd_laplacian *lap, int which) {
    const int32_t m = lap->n_active;
    int32_t q;
    memset(x, 0, sizeof *x);
    x->s.vertex = x->vertex;
    x->s.count = 1;
    x->s.corners = 3;
    x->s.bary = x->bary;
    src_corner(x, 0, lap, m / 2, 0.2, 0.3);
    if (which == 1) {
        x->s.corners = 2;
        x->bary[1] = 0.8;
    } else if (which == 2) {
        x->s.count = 4;
        x->s.corners = 0;
        x->s.bary = NULL;
        for (q = 0; q < 4; q++) x->vertex[q] = lap->vertex[m / 3 + q];
    } else if (which == 3) {
        x->s.count = 2;
        x->s.weight = x->weight;
        x->weight[0] = 0.5;
        x->weight[1] = 1.5;
        src_corner(x, 1, lap, m / 4, 0.6, 0.1);
    } else if (which == 4) {
        x->s.count = 2;
        x->s.corners = 1;
        x->s.bary = NULL;
        x->s.weight = x->weight;
        x->weight[0] = 0.75;
        x->weight[1] = 0.25;
        x->vertex[0] = 0;
        x->vertex[1] = lap->row[lap->n - 1] == HD_ROW_HELD ? lap->vertex[0] : lap->n - 1;
    } else if (which == 5) {
        x->s.count = 3;
        x->s.curve = 1;
        x->s.length = x->weight;
        x->weight[0] = 0.3;
        x->weight[1] = 0.7;
        for (q = 0; q < 9; q++) x->vertex[q] = x->vertex[q % 3];
        for (q = 0; q < 9; q++) x->bary[q] = q < 3 ? x->bary[q] : q == 4 ? 1 : q == 8 ? 0.5 : q == 6 ? 0.5 : 0;
    }
}

/* c [n] by vertices, from the definition: points by their weights, pieces of curves by their midpoints. */
static double *src_load(const hd_source *s, int32_t n) {
    const int32_t corners = s->corners ? s->corners : 1;
    double *c = DENSE_NEW(double, n);
    int32_t q, k;
    for (q = 0; q < s->count; q++)
        for (k = 0; k < corners; k++) {
            const int64_t at = (int64_t)q * corners + k;
            const double b = s->bary ? s->bary[at] : 1.0 / corners;
            double w = s->weight ? s->weight[q] : 1;
            if (s->curve) w = ((q > 0 ? s->length[q - 1] : 0) + (q + 1 < s->count ? s->length[q] : 0)) / 2;
            c[s->vertex[at]] += w * b;
        }
    return c;
}

static void src_normalise(double *c, int32_t n) {
    double sum = 0;
    int32_t v;
    for (v = 0; v < n; v++) sum += c[v];
    for (v = 0; v < n; v++) c[v] /= sum;
}

/* ---- columns and distances against dense eigensolutions ---- */

/* Columns of all sources at once, at several times. */
static void src_columns(const heat_case *c, hd_method method) {
    const hd_laplacian *lap = c->lap;
    const double unit = all_unit(lap), times[3] = {0.7 * unit, (lap->conserves ? 60 : 3) * unit, 0};
    const int32_t n = lap->n, m = lap->n_active;
    hd_heat *heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
    double *U = DENSE_NEW(double, 3 * SRC_KINDS * n), *rhs = DENSE_NEW(double, m), *rows = DENSE_NEW(double, m);
    src_room room[SRC_KINDS];
    hd_source s[SRC_KINDS];
    hd_report rep;
    int32_t i, v;
    int k, w, q;
    for (w = 0; w < SRC_KINDS; w++) {
        src_make(room + w, lap, w);
        s[w] = room[w].s;
    }
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(eng_ok(hd_heat_columns_from(heat, kernel, 3, times, SRC_KINDS, s, U, 0, &rep, NULL), &rep, c->what));
        CHECK_MSG(rep.error_bound_b < 1e-6, "%s, method %d, kernel %d: bound %g", c->what, (int)method, k, rep.error_bound_b);
        for (w = 0; w < SRC_KINDS; w++) {
            double *load = src_load(s + w, n);
            for (i = 0; i < m; i++) rows[i] = load[lap->vertex[i]];
            if (k) memcpy(rhs, rows, (size_t)m * sizeof *rhs);
            else dense_apply(c->pair.B, rows, rhs, m);
            for (q = 0; q < 3; q++) {
                const double *u = U + (size_t)(3 * w + q) * (size_t)n;
                heat_judge(c, times[q], rhs, u, &rep);
                for (v = 0; v < n; v++)
                    if (lap->row[v] < 0) CHECK_MSG(u[v] == (lap->row[v] == HD_ROW_INERT && !k ? load[v] : 0), "%s: source %d at vertex %d: %g", c->what, w, v, u[v]);
            }
            for (v = 0; v < n && !k; v++)
                CHECK_MSG(fabs(U[(size_t)(3 * w + 2) * (size_t)n + (size_t)v] - (lap->row[v] == HD_ROW_HELD ? 0 : load[v])) <= 1e-15, "%s: load %d of vertex %d", c->what, w, v);
            free(load);
        }
    }
    hd_heat_free(heat);
    free(U);
    free(rhs);
    free(rows);
}

/* d(v, s) of the definition, by the matrix H of the kind. */
static double src_distance(const double *H, const hd_laplacian *lap, hd_distance_kind kind, const double *load, int32_t v) {
    double ss = 0, sv = 0;
    int32_t p, q, own = -2, far_away = lap->row[v] < 0;
    for (p = 0; p < lap->n; p++) {
        const int32_t r = lap->row[p];
        if (load[p] == 0) continue;
        far_away |= r < 0 || (own != -2 && lap->component[r] != own);
        own = r < 0 ? -1 : lap->component[r];
        sv += load[p] * all_at(H, lap, p, v);
        for (q = 0; q < lap->n; q++) ss += load[q] == 0 ? 0 : load[p] * load[q] * all_at(H, lap, p, q);
    }
    if (kind >= HD_DISTANCE_COMMUTE && (far_away || lap->component[lap->row[v]] != own)) return HUGE_VAL;
    return sqrt(fmax(0, ss - 2 * sv + all_at(H, lap, v, v)));
}

static void src_distances(const heat_case *c, hd_heat *heat, hd_distance_kind kind, int32_t n_times, const double *t) {
    const hd_laplacian *lap = c->lap;
    const int32_t n = lap->n;
    double *D = DENSE_NEW(double, n_times * SRC_KINDS * n);
    src_room room[SRC_KINDS];
    hd_source s[SRC_KINDS];
    hd_report rep;
    int32_t v, m;
    int w;
    for (w = 0; w < SRC_KINDS; w++) {
        src_make(room + w, lap, w);
        s[w] = room[w].s;
    }
    CHECK(eng_ok(hd_heat_distance_from(heat, kind, n_times, t, SRC_KINDS, s, D, 0, &rep, NULL), &rep, c->what));
    for (m = 0; m < n_times; m++) {
        double *H = diag_gram(c, kind, t[m]);
        const double noise = all_slack(c, kind, t[m]) * all_largest(H, lap->n_active);
        for (w = 0; w < SRC_KINDS; w++) {
            const double *d = D + (size_t)(n_times * w + m) * (size_t)n;
            double *load = src_load(s + w, n), off = 0, size = 0;
            src_normalise(load, n);
            for (v = 0; v < n; v++) {
                const double want = src_distance(H, lap, kind, load, v), diff = all_off(d[v], want, noise);
                if (!(diff <= off)) off = diff;
                if (want < HUGE_VAL) size = fmax(size, want);
            }
            CHECK_MSG(off <= rep.error_bound * size && off <= 1e-6 * size, "%s, distance %d from source %d, t %g (%d): off by %g of %g, bound %g", c->what, (int)kind, w,
                      t[m], (int)n_times, off, size, rep.error_bound);
            free(load);
        }
        free(H);
    }
    free(D);
}

/* ---- from eigenpairs, and farthest points ---- */

/* Columns from two thirds of the pairs: what is left out is within the bound, and that says something at late times. */
static void src_pair_columns(const heat_case *c, const hd_spectrum *z, const hd_source *s) {
    const hd_laplacian *lap = c->lap;
    const double unit = all_unit(lap), times[3] = {2 * unit, (lap->conserves ? 200 : 10) * unit, 0};
    const int32_t n = lap->n, m = lap->n_active;
    double *U = DENSE_NEW(double, 3 * SRC_KINDS * n), *bound = DENSE_NEW(double, 3 * SRC_KINDS * n), *rows = DENSE_NEW(double, m), *rhs = DENSE_NEW(double, m);
    int32_t i, j, v;
    int k, w, q;
    for (k = 0; k < 2; k++) {
        CHECK(hd_spectrum_columns_from(z, k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR, 3, times, SRC_KINDS, s, U, bound, 0, NULL) == HD_OK);
        for (w = 0; w < SRC_KINDS; w++) {
            double *load = src_load(s + w, n);
            for (i = 0; i < m; i++) rows[i] = load[lap->vertex[i]];
            if (k) memcpy(rhs, rows, (size_t)m * sizeof *rhs);
            else dense_apply(c->pair.B, rows, rhs, m);
            for (q = 0; q < 3; q++) {
                const double *u = U + (size_t)(3 * w + q) * (size_t)n, *b = bound + (size_t)(3 * w + q) * (size_t)n;
                double size = 0;
                for (j = 0; j < m; j++) {
                    double want = 0;
                    for (i = 0; i < m; i++) {
                        const double *x = c->pair.x + (size_t)i * (size_t)m;
                        want += exp(-times[q] * c->pair.lambda[i]) * x[j] * dense_dot(rhs, x, m);
                    }
                    size = fmax(size, fabs(want));
                    CHECK_MSG(fabs(u[lap->vertex[j]] - want) <= b[lap->vertex[j]] + 1e-12 * size, "%s, source %d, t %g: %g for %g, bound %g", c->what, w, times[q],
                              u[lap->vertex[j]], want, b[lap->vertex[j]]);
                }
                for (v = 0; v < n; v++) {
                    if (q == 1) CHECK_MSG(b[v] <= 1e-2 * size, "%s, source %d: bound %g of %g", c->what, w, b[v], size);
                    if (lap->row[v] < 0) CHECK(u[v] == (lap->row[v] == HD_ROW_INERT && !k ? load[v] : 0));
                }
            }
            free(load);
        }
    }
    free(U);
    free(bound);
    free(rows);
    free(rhs);
}

static void src_pair_distances(const heat_case *c, const hd_spectrum *z, const hd_source *s) {
    const hd_laplacian *lap = c->lap;
    const double t = (lap->conserves ? 100 : 5) * all_unit(lap);
    const int32_t n = lap->n;
    double *D = DENSE_NEW(double, SRC_KINDS * n), *bound = DENSE_NEW(double, SRC_KINDS * n);
    int32_t v;
    int kind, w;
    for (kind = 0; kind < 4; kind++) {
        double *H = diag_gram(c, (hd_distance_kind)kind, t);
        const double noise = all_slack(c, (hd_distance_kind)kind, t) * all_largest(H, lap->n_active);
        CHECK(hd_spectrum_distance_from(z, (hd_distance_kind)kind, kind < 2, &t, SRC_KINDS, s, D, bound, 0, NULL) == HD_OK);
        for (w = 0; w < SRC_KINDS; w++) {
            double *load = src_load(s + w, n);
            src_normalise(load, n);
            for (v = 0; v < n; v++) {
                const double d = D[(size_t)w * (size_t)n + (size_t)v], want = src_distance(H, lap, (hd_distance_kind)kind, load, v);
                CHECK_MSG(all_off(d, want, noise) <= bound[(size_t)w * (size_t)n + (size_t)v], "%s, distance %d from source %d: %g for %g, bound %g", c->what, kind, w, d, want,
                          bound[(size_t)w * (size_t)n + (size_t)v]);
            }
            free(load);
        }
        free(H);
    }
    free(D);
    free(bound);
}

/* A source that is a vertex is that vertex, to the last bit. */
static void src_pair_same(const heat_case *c, const hd_spectrum *z) {
    const int32_t n = c->lap->n, id[2] = {c->lap->vertex[c->lap->n_active / 2], n - 1};
    const double times[2] = {all_unit(c->lap), 30 * all_unit(c->lap)};
    double *room = DENSE_NEW(double, 16 * n), *U = room, *V = room + 4 * n, *a = room + 8 * n, *b = room + 12 * n;
    const size_t bytes = 4 * (size_t)n * sizeof *U;
    hd_source s[2];
    int k;
    memset(s, 0, sizeof s);
    for (k = 0; k < 2; k++) {
        s[k].count = 1;
        s[k].vertex = id + k;
    }
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(hd_spectrum_columns(z, kernel, 2, times, 2, id, U, a, 0, NULL) == HD_OK && hd_spectrum_columns_from(z, kernel, 2, times, 2, s, V, b, 0, NULL) == HD_OK);
        CHECK(memcmp(U, V, bytes) == 0 && memcmp(a, b, bytes) == 0);
    }
    for (k = 0; k < 4; k++) {
        const int32_t n_times = k < 2 ? 2 : 1;
        CHECK(hd_spectrum_distance(z, (hd_distance_kind)k, n_times, times, 2, id, U, a, 0, NULL) == HD_OK &&
              hd_spectrum_distance_from(z, (hd_distance_kind)k, n_times, times, 2, s, V, b, 0, NULL) == HD_OK);
        CHECK(memcmp(U, V, bytes / (k < 2 ? 1 : 2)) == 0 && memcmp(a, b, bytes / (k < 2 ? 1 : 2)) == 0);
    }
    free(room);
}

/* Farthest points from two sources: those of brute force with dense distances. */
static void src_samples(const heat_case *c, const hd_source *s) {
    enum { COUNT = 6, FROM = 2 };
    const hd_laplacian *lap = c->lap;
    const double t = (lap->conserves ? 10 : 3) * all_unit(lap);
    const int32_t n = lap->n;
    int kind, q, k;
    for (kind = 0; kind < 4; kind++) {
        double *H = diag_gram(c, (hd_distance_kind)kind, t), *load[FROM], distance[COUNT];
        const double noise = all_slack(c, (hd_distance_kind)kind, t) * all_largest(H, lap->n_active);
        hd_heat *heat = diag_plan(lap, HD_POLES_DIAGONAL, 14);
        int32_t vertex[COUNT], again[COUNT], v;
        hd_source one;
        hd_report rep;
        for (k = 0; k < FROM; k++) src_normalise(load[k] = src_load(s + k, n), n);
        CHECK(eng_ok(hd_heat_sample_from(heat, (hd_distance_kind)kind, t, FROM, s, COUNT, vertex, distance, &rep, NULL), &rep, c->what));
        for (q = 0; q < COUNT; q++) {
            double best = -1, own = -1;
            for (v = 0; v < n; v++) {
                double near = HUGE_VAL;
                if (lap->row[v] < 0) continue;
                for (k = 0; k < FROM; k++) near = fmin(near, src_distance(H, lap, (hd_distance_kind)kind, load[k], v));
                for (k = 0; k < q; k++) {
                    const int32_t r = lap->row[vertex[k]], w = lap->row[v];
                    const size_t m = (size_t)lap->n_active;
                    const int apart = kind > 1 && lap->component[r] != lap->component[w];
                    near = apart ? near : fmin(near, sqrt(fmax(0, H[(size_t)r * m + (size_t)r] - 2 * H[(size_t)r * m + (size_t)w] + H[(size_t)w * m + (size_t)w])));
                }
                best = fmax(best, near);
                if (v == vertex[q]) own = near;
            }
            CHECK_MSG(own == best || own >= best * (1 - 1e-5), "%s, distance %d, point %d: %g is not the largest, %g", c->what, kind, q, own, best);
            CHECK_MSG(all_off(distance[q], own, noise) <= 1e-5 * own || distance[q] == own, "%s, distance %d, point %d: distance %g, not %g", c->what, kind, q, distance[q], own);
        }
        for (k = 0; k < FROM; k++) free(load[k]);
        memset(&one, 0, sizeof one);             /* a vertex as a source is that vertex given */
        one.count = 1;
        one.vertex = again;
        again[0] = lap->vertex[lap->n_active / 3];
        CHECK(heat_sample(heat, (hd_distance_kind)kind, t, COUNT, 1, again, distance, &rep) >= 0);
        CHECK(hd_heat_sample_from(heat, (hd_distance_kind)kind, t, 1, &one, COUNT - 1, vertex, NULL, &rep, NULL) >= 0 && memcmp(vertex, again + 1, sizeof vertex - sizeof *vertex) == 0);
        CHECK(hd_heat_sample_from(heat, (hd_distance_kind)kind, t, 0, NULL, 2, vertex, NULL, &rep, NULL) >= 0 && vertex[0] == lap->vertex[0]);
        hd_heat_free(heat);
        free(H);
    }
}

static void src_pairs(void) {
    int k;
    for (k = 0; k < 4; k++) {
        const int32_t held[2] = {3, 40};
        const hd_laplacian_opts o = bord_opts(k == 1 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, k == 2 ? HD_BORDER_DIRICHLET : HD_BORDER_NATURAL, k == 2 ? 2 : 0, held);
        hd_laplacian *lap = k < 3 ? all_triangles(shape_grid(9, 8, 0.3), o) : all_laplacian(0);
        heat_case c = heat_case_of(lap, k == 3 ? all_names[0] : k == 2 ? "fem, held" : k == 1 ? "voronoi-cot" : "fem");
        src_room room[SRC_KINDS];
        hd_source s[SRC_KINDS];
        hd_spectrum *z = spec_make(lap, 2 * lap->n_active / 3, 0, HD_OK);
        int w;
        for (w = 0; w < SRC_KINDS; w++) {
            src_make(room + w, lap, w);
            s[w] = room[w].s;
        }
        src_pair_columns(&c, z, s);
        src_pair_distances(&c, z, s);
        src_pair_same(&c, z);
        src_samples(&c, s + 2);
        hd_spectrum_free(z);
        heat_case_free(&c);
    }
}

/* ---- a source that is a vertex is that vertex, to the last bit ---- */

static void src_same(const heat_case *c, hd_method method) {
    const hd_laplacian *lap = c->lap;
    const double unit = all_unit(lap), times[3] = {unit, 20 * unit, 400 * unit};
    const int32_t n = lap->n, id[2] = {lap->vertex[lap->n_active / 2], n - 1};
    hd_heat *heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
    double *U = DENSE_NEW(double, 6 * n), *V = DENSE_NEW(double, 6 * n);
    src_room room;
    hd_source s[2];
    hd_report a, b;
    int32_t q;
    int k;
    src_make(&room, lap, 0);
    room.vertex[5] = id[1];
    room.vertex[3] = room.vertex[4] = id[0];
    for (q = 0; q < 6; q++) room.bary[q] = q == 0 || q == 5;
    s[0] = s[1] = room.s;
    s[1].vertex += 3;
    s[1].bary += 3;
    for (k = 0; k < 2; k++) {
        const hd_kernel kernel = k ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        CHECK(eng_ok(hd_heat_columns(heat, kernel, 3, times, 2, id, U, 0, &a, NULL), &a, c->what));
        CHECK(eng_ok(hd_heat_columns_from(heat, kernel, 3, times, 2, s, V, 0, &b, NULL), &b, c->what));
        CHECK(memcmp(U, V, (size_t)(6 * n) * sizeof *U) == 0 && a.error_bound == b.error_bound && a.iterations == b.iterations);
    }
    for (k = 0; k < 4 && method != HD_METHOD_ITERATIVE && method != HD_METHOD_KRYLOV; k++) {
        const int32_t n_times = k < 2 ? 3 : 1;
        hd_heat_free(heat);                      /* eigenpairs that one query leaves are of use to the next */
        heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
        CHECK(eng_ok(hd_heat_distance(heat, (hd_distance_kind)k, n_times, times, 2, id, U, 0, &a, NULL), &a, c->what));
        hd_heat_free(heat);
        heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
        CHECK(eng_ok(hd_heat_distance_from(heat, (hd_distance_kind)k, n_times, times, 2, s, V, 0, &b, NULL), &b, c->what));
        CHECK_MSG(memcmp(U, V, (size_t)(2 * n_times * n) * sizeof *U) == 0 && a.error_bound == b.error_bound, "%s, distance %d: %g, bounds %g %g", c->what, k,
                  dense_max_diff(U, V, 2 * n_times * n), a.error_bound, b.error_bound);
    }
    hd_heat_free(heat);
    free(U);
    free(V);
}

/* Points without barycentric coordinates are the means of their corners. */
static void src_means(void) {
    shape g = shape_grid(6, 5, 0.2);
    hd_laplacian *lap = test_laplacian(&g, HD_LAPLACIAN_FEM);
    hd_heat *heat = eng_plan(lap, HD_METHOD_DIRECT, HD_POLES_DEFAULT, 0);
    const double t = 4 * lap->h * lap->h, third = 1.0 / 3;
    double *U = DENSE_NEW(double, 2 * g.n);
    src_room room;
    hd_source s[2];
    hd_report rep;
    src_make(&room, lap, 0);
    room.bary[0] = room.bary[1] = third;
    room.bary[2] = 1 - 2 * third;
    s[0] = s[1] = room.s;
    s[1].bary = NULL;
    CHECK(eng_ok(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &t, 2, s, U, 0, &rep, NULL), &rep, "means"));
    CHECK(dense_max_diff(U, U + g.n, g.n) <= 1e-12 * dense_max_abs(U, g.n));
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&g);
    free(U);
}

/* ---- symmetry: what one source takes of the column of another ---- */

static void src_symmetric(const heat_case *c, hd_method method) {
    const hd_laplacian *lap = c->lap;
    const double t = 5 * all_unit(lap);
    const int32_t n = lap->n;
    hd_heat *heat = eng_plan(lap, method, HD_POLES_DEFAULT, 0);
    double *U = DENSE_NEW(double, SRC_KINDS * n), M[SRC_KINDS][SRC_KINDS], size = 0, off = 0;
    src_room room[SRC_KINDS];
    hd_source s[SRC_KINDS];
    hd_report rep;
    int p, q;
    for (p = 0; p < SRC_KINDS; p++) {
        src_make(room + p, lap, p);
        s[p] = room[p].s;
    }
    CHECK(eng_ok(hd_heat_columns_from(heat, HD_KERNEL_SYMMETRIC, 1, &t, SRC_KINDS, s, U, 0, &rep, NULL), &rep, c->what));
    for (p = 0; p < SRC_KINDS; p++) {
        double *load = src_load(s + p, n);
        for (q = 0; q < SRC_KINDS; q++) M[p][q] = dense_dot(load, U + (size_t)q * (size_t)n, n);
        free(load);
    }
    for (p = 0; p < SRC_KINDS; p++)
        for (q = 0; q < SRC_KINDS; q++) {
            off = fmax(off, fabs(M[p][q] - M[q][p]));
            size = fmax(size, fabs(M[p][q]));
        }
    CHECK_MSG(off <= 2e-8 * size, "%s: k(s, s') is not symmetric: %g of %g", c->what, off, size);
    hd_heat_free(heat);
    free(U);
}

static void src_operators(void) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    int k, m, kind;
    for (k = -1; k < ALL_OPERATORS; k++) {
        const int32_t held[2] = {3, 40};
        const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_DIRICHLET, 2, held);
        hd_laplacian *lap = k < 0 ? all_triangles(shape_grid(9, 8, 0.3), o) : all_laplacian(k);
        heat_case c = heat_case_of(lap, k < 0 ? "fem, held" : all_names[k]);
        const double unit = all_unit(c.lap), late = k < 0 ? 12 : 2000;
        const double times[5] = {0.7 * unit, 5 * unit, fmin(40, late) * unit, late * unit, 9 * unit};
        hd_heat *heat = eng_create(c.lap, NULL);
        for (m = 0; m < 3; m++) {
            src_columns(&c, methods[m]);
            src_same(&c, methods[m]);
            src_symmetric(&c, methods[m]);
        }
        for (kind = 0; kind < 4; kind++) {
            for (m = 0; m < (kind < 2 ? 4 : 1); m++) src_distances(&c, heat, (hd_distance_kind)kind, 1, times + m);
            if (kind < 2) src_distances(&c, heat, (hd_distance_kind)kind, 5, times);
        }
        hd_heat_free(heat);
        heat_case_free(&c);
    }
}

/* From eigenpairs, late, where sources lie in two components of unlike vertices. */
static void src_two(void) {
    const double offset[3] = {4, 0, 0};
    shape ball = shape_bumpy(1, 5), other = shape_bumpy(1, 9), two = shape_disjoint(&ball, &other, offset);
    int kind;
    for (kind = 0; kind < 2; kind++) {
        heat_case c = heat_case_of(test_laplacian(&two, kind ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM), "two");
        const double t = 2000 * all_unit(c.lap);
        hd_heat *heat = eng_create(c.lap, NULL);
        src_distances(&c, heat, HD_DISTANCE_CLASSICAL, 1, &t);
        src_distances(&c, heat, HD_DISTANCE_WEIGHTED, 1, &t);
        hd_heat_free(heat);
        heat_case_free(&c);
    }
    shape_free(&ball);
    shape_free(&other);
    shape_free(&two);
}

/* The report of farthest points is one of distances: the same evidence, and a bound as small. */
static void src_sample_report(void) {
    shape s = shape_bumpy(2, 5);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    const double t[2] = {3 * lap->h * lap->h, 1000 * lap->h * lap->h};
    double *d = DENSE_NEW(double, s.n), far[5];
    int32_t vertex[5];
    int kind, q;
    for (kind = 0; kind < 4; kind++)
        for (q = 0; q < (kind < 2 ? 2 : 1); q++) {
            hd_heat *heat = eng_create(lap, NULL);
            hd_report one, all;
            vertex[0] = 7;
            CHECK(heat_sample(heat, (hd_distance_kind)kind, t[q], 5, 1, vertex, far, &all) >= 0);
            CHECK(heat_distance(heat, (hd_distance_kind)kind, 1, t + q, 1, vertex, d, 0, &one) >= 0);
            CHECK_MSG(all.evidence_rational == one.evidence_rational && all.evidence_solver == one.evidence_solver && all.evidence_rounding == one.evidence_rounding,
                      "kind %d, t %d: evidence %d %d %d, of distances %d %d %d", kind, q, (int)all.evidence_rational, (int)all.evidence_solver, (int)all.evidence_rounding,
                      (int)one.evidence_rational, (int)one.evidence_solver, (int)one.evidence_rounding);
            CHECK_MSG(all.error_bound > 0 && all.error_bound <= 1e-6 && all.error_bound <= 10 * one.error_bound,
                      "kind %d, t %d: bound %g, of distances %g", kind, q, all.error_bound, one.error_bound);
            hd_heat_free(heat);
        }
    hd_laplacian_free(lap);
    shape_free(&s);
    free(d);
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
static double src_square_error(int32_t n, int distance) {
    shape s = shape_grid(n, n, 0);
    hd_laplacian *lap = op_make(s.xyz, s.n, s.tri, s.n_tri, HD_LAPLACIAN_FEM);
    hd_heat *heat = eng_create(lap, NULL);
    const double t = 0.02, px = 1 / 3.0, py = 2 / 3.0;
    double *u = DENSE_NEW(double, s.n), off = 0;
    const double ss = src_interval(2 * t, px, px) * src_interval(2 * t, py, py);
    src_room room;
    hd_report rep;
    int32_t v;
    src_make(&room, lap, 0);
    src_place(&s, px, py, room.vertex, room.bary);
    if (distance) CHECK(eng_ok(hd_heat_distance_from(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &room.s, u, 0, &rep, NULL), &rep, "square"));
    else CHECK(eng_ok(hd_heat_columns_from(heat, HD_KERNEL_SYMMETRIC, 1, &t, 1, &room.s, u, 0, &rep, NULL), &rep, "square"));
    for (v = 0; v < s.n; v++) {
        const double x = s.xyz[3 * v], y = s.xyz[3 * v + 1], at = distance ? 2 * t : t;
        const double k = src_interval(at, px, x) * src_interval(at, py, y), vv = src_interval(2 * t, x, x) * src_interval(2 * t, y, y);
        const double diff = distance ? u[v] * u[v] - (ss - 2 * k + vv) : u[v] - k;
        off += diff * diff;
    }
    off = sqrt(off / s.n);
    free(u);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
    return off;
}

static void src_square(void) {
    int q;
    for (q = 0; q < 2; q++) {
        const double a = src_square_error(17, q), b = src_square_error(33, q), c = src_square_error(65, q);
        CHECK_MSG(a / b > 3.7 && b / c > 3.8 && c < 0.005, "%s: errors %g %g %g", q ? "distance" : "column", a, b, c);
    }
}

/* A line across the square: heat depends on x alone; the load is exact for linear functions, and does not feel how the line is cut. */
static void src_line(void) {
    enum { N = 33, CUTS = 400 };
    shape s = shape_grid(N, N, 0);
    hd_laplacian *lap = op_make(s.xyz, s.n, s.tri, s.n_tri, HD_LAPLACIAN_VORONOI_COT);
    hd_heat *heat = eng_create(lap, NULL);
    int32_t *vertex = DENSE_NEW(int32_t, 3 * (CUTS + 2 * N)), v, q, n = 0;
    double *bary = DENSE_NEW(double, 3 * (CUTS + 2 * N)), *u = DENSE_NEW(double, s.n), *w = DENSE_NEW(double, s.n);
    const double t = 0.02, x = 0.3717, zero = 0;
    double off = 0, sum[3] = {0, 0, 0}, cell = 1.0 / (N - 1), at = x - floor(x / cell) * cell;
    src_room room;
    hd_report rep;
    /* crossings of rows and of diagonals */
    for (q = 0; q < N; q++) {
        src_place(&s, x, q * cell, vertex + 3 * n, bary + 3 * n);
        n++;
        if (q + 1 == N) continue;
        src_place(&s, x, q * cell + at, vertex + 3 * n, bary + 3 * n);
        n++;
    }
    src_make(&room, lap, 0);
    room.s.curve = 1;
    room.s.vertex = vertex;
    room.s.bary = bary;
    room.s.count = n;
    CHECK(eng_ok(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &zero, 1, &room.s, w, 0, &rep, NULL), &rep, "line"));
    for (v = 0; v < s.n; v++) {
        sum[0] += w[v];
        sum[1] += w[v] * s.xyz[3 * v];
        sum[2] += w[v] * s.xyz[3 * v + 1];
    }
    CHECK_MSG(fabs(sum[0] - 1) < 1e-13 && fabs(sum[1] - x) < 1e-13 && fabs(sum[2] - 0.5) < 1e-13, "line: %.17g %.17g %.17g", sum[0], sum[1], sum[2]);
    CHECK(eng_ok(hd_heat_columns_from(heat, HD_KERNEL_SYMMETRIC, 1, &t, 1, &room.s, u, 0, &rep, NULL), &rep, "line"));
    for (v = 0; v < s.n; v++) off = fmax(off, fabs(u[v] - src_interval(t, x, s.xyz[3 * v])));
    CHECK_MSG(off < 0.01, "line: heat is off by %g", off);
    /* cut again in the middle of each piece: the same load */
    for (q = n - 1; q > 0; q--) {
        memmove(vertex + 6 * q, vertex + 3 * q, 3 * sizeof *vertex);
        memmove(bary + 6 * q, bary + 3 * q, 3 * sizeof *bary);
    }
    for (q = 0; q + 1 < n; q++) {
        const double from = (q / 2) * cell + (q % 2 ? at : 0), to = (q + 1) / 2 * cell + (q % 2 ? 0 : at);
        src_place(&s, x, (from + to) / 2, vertex + 3 * (2 * q + 1), bary + 3 * (2 * q + 1));
    }
    room.s.count = 2 * n - 1;
    CHECK(eng_ok(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &zero, 1, &room.s, u, 0, &rep, NULL), &rep, "line"));
    CHECK_MSG(dense_max_diff(u, w, s.n) < 1e-15, "line: cut again it is off by %g", dense_max_diff(u, w, s.n));
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&s);
    free(vertex);
    free(bary);
    free(u);
    free(w);
}

/* ---- geodesic distances ---- */

/* Points in triangles. The arrays stay the caller's. */
static hd_source src_in_triangles(int32_t count, const int32_t *vertex, const double *bary) {
    hd_source s;
    memset(&s, 0, sizeof s);
    s.count = count;
    s.corners = 3;
    s.vertex = vertex;
    s.bary = bary;
    return s;
}

static hd_geodesic *src_geodesic(const shape *s, double t) {
    hd_geodesic_opts o;
    hd_geodesic *g = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.t = t;
    CHECK_MSG(hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, &o, &e) == HD_OK, "%s", e.text);
    return g;
}

static double src_gap(const double *a, const double *b) { return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2)); }

/* Points of faces of the sphere: the largest and the mean error in edges, which are those of vertices; and exact corners. */
static void src_geo_sphere(int levels) {
    shape s = shape_icosphere(levels);
    hd_geodesic *g = src_geodesic(&s, 0);
    double *d = DENSE_NEW(double, s.n), most = 0, mean = 0, h = 0;
    int q, k, i;
    for (q = 0; q < 8; q++) {
        const int32_t f = (7919 * q + 17) % s.n_tri, *v = s.tri + 3 * f;
        const double b[3] = {0.2 + 0.05 * q, 0.5 - 0.03 * q, 0.3 - 0.02 * q};
        double p[3] = {0, 0, 0}, flat[3], size;
        hd_geodesic_report rep;
        const hd_source src = src_in_triangles(1, v, b);
        int32_t at;
        CHECK(hd_geodesic_distance_from(g, &src, d, &rep, NULL) == HD_OK && rep.n_stages == 1 && rep.residual_heat > 0 && rep.residual_heat < 1e-13 && rep.residual_distance < 1e-12);
        h = rep.h;
        for (k = 0; k < 3; k++)
            for (i = 0; i < 3; i++) p[i] += b[k] * s.xyz[3 * v[k] + i];
        memcpy(flat, p, sizeof p);
        size = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (i = 0; i < 3; i++) p[i] /= size;
        for (k = 0; k < 3; k++) CHECK(fabs(d[v[k]] - src_gap(flat, s.xyz + 3 * v[k])) < 1e-14);
        for (at = 0; at < s.n; at++) {
            const double off = fabs(d[at] - 2 * asin(fmin(1, src_gap(p, s.xyz + 3 * at) / 2)));
            most = fmax(most, off);
            mean += off / (8 * s.n);
        }
    }
    CHECK_MSG(most < 0.3 * h && mean < 0.06 * h, "sphere %d: off by %g edges, %g on average", levels, most / h, mean / h);
    hd_geodesic_free(g);
    shape_free(&s);
    free(d);
}

/* Points and a line of the square. */
static void src_geo_square(void) {
    enum { N = 41 };
    shape s = shape_grid(N, N, 0);
    hd_geodesic *g = src_geodesic(&s, 0);
    double *d = DENSE_NEW(double, s.n), bary[3 * 2 * N], p[2][2] = {{0.213, 0.307}, {0.751, 0.822}}, off[2] = {0, 0}, x = 0.4127;
    const double cell = 1.0 / (N - 1), at = x - floor(x / cell) * cell;
    int32_t vertex[3 * 2 * N], v, q, n = 0;
    hd_geodesic_report rep;
    hd_source src = src_in_triangles(2, vertex, bary);
    for (q = 0; q < 2; q++) src_place(&s, p[q][0], p[q][1], vertex + 3 * q, bary + 3 * q);
    CHECK(hd_geodesic_distance_from(g, &src, d, &rep, NULL) == HD_OK && rep.n_stages == 1);
    for (v = 0; v < s.n; v++) {
        const double *a = s.xyz + 3 * v;
        off[0] += fabs(d[v] - fmin(hypot(a[0] - p[0][0], a[1] - p[0][1]), hypot(a[0] - p[1][0], a[1] - p[1][1]))) / s.n;
    }
    for (q = 0; q < N; q++) {
        src_place(&s, x, q * cell, vertex + 3 * n, bary + 3 * n);
        n++;
        if (q + 1 < N) src_place(&s, x, q * cell + at, vertex + 3 * n, bary + 3 * n);
        n += q + 1 < N;
    }
    src.count = n;
    src.curve = 1;
    CHECK(hd_geodesic_distance_from(g, &src, d, &rep, NULL) == HD_OK && rep.n_stages == 1);
    for (v = 0; v < s.n; v++) off[1] = fmax(off[1], fabs(d[v] - fabs(s.xyz[3 * v] - x)));
    CHECK_MSG(off[0] < 0.3 * cell && off[1] < 0.1 * cell, "square: points off by %g edges on average, a line by at most %g", off[0] / cell, off[1] / cell);
    hd_geodesic_free(g);
    shape_free(&s);
    free(d);
}

/* Along a strip heat fades out, and is solved for again. */
static void src_geo_strip(void) {
    enum { N = 1201 };
    shape s = shape_grid(N, 4, 0);
    hd_geodesic *g = src_geodesic(&s, 0);
    double *d = DENSE_NEW(double, s.n), bary[3], off = 0;
    const double x = 10.3 / (N - 1), y = 1.6 / (N - 1);
    int32_t vertex[3], v;
    hd_geodesic_report rep;
    const hd_source src = src_in_triangles(1, vertex, bary);
    src_place(&s, x, y, vertex, bary);
    CHECK(hd_geodesic_distance_from(g, &src, d, &rep, NULL) == HD_OK && rep.n_stages > 1);
    for (v = 0; v < s.n; v++) off = fmax(off, fabs(d[v] - hypot(s.xyz[3 * v] - x, s.xyz[3 * v + 1] - y)));
    CHECK_MSG(off < 1.0 / (N - 1), "strip: off by %g edges", off * (N - 1));
    hd_geodesic_free(g);
    shape_free(&s);
    free(d);
}

/* Vertices give what they give as such, to the last bit; points in no face, and components. */
static void src_geo_rules(void) {
    const double apart[3] = {5, 0, 0};
    shape a = shape_icosphere(2), b = shape_grid(6, 5, 0.2), s = shape_disjoint(&a, &b, apart);
    hd_geodesic *g = src_geodesic(&s, 0);
    double *d = DENSE_NEW(double, s.n), *e = DENSE_NEW(double, s.n), bary[6] = {0, 1, 0, 1, 0, 0};
    int32_t vertex[6] = {0, 5, 1, a.n + 3, 0, 9}, id[2] = {5, a.n + 3}, v;
    hd_geodesic_report rep;
    hd_error err;
    hd_source src = src_in_triangles(2, vertex, bary);
    CHECK(hd_geodesic_distance_from(g, &src, d, &rep, NULL) == HD_OK && hd_geodesic_distance(g, 2, id, e, NULL, NULL) == HD_OK);
    CHECK(memcmp(d, e, (size_t)s.n * sizeof *d) == 0);
    src.count = 1;
    memcpy(vertex, s.tri, 3 * sizeof *vertex);
    bary[0] = bary[1] = bary[2] = 1 / 3.0;
    CHECK(hd_geodesic_distance_from(g, &src, d, NULL, NULL) == HD_OK);
    for (v = 0; v < s.n; v++) CHECK(v < a.n ? d[v] >= 0 && d[v] < 4 : d[v] == HUGE_VAL);
    src.count = 2;
    vertex[4] = a.n + 4;                         /* no face has these three */
    vertex[5] = a.n + 20;
    bary[4] = bary[5] = 0.25;
    bary[3] = 0.5;
    CHECK(hd_geodesic_distance_from(g, &src, d, &rep, &err) == HD_ERR_ARGUMENT && err.row == 1 && strstr(err.text, "no face") && rep.status == err.status);
    src.curve = 1;
    CHECK(hd_geodesic_distance_from(g, &src, d, NULL, &err) == HD_ERR_ARGUMENT && err.row == 0);
    bary[1] = -1;
    CHECK(hd_geodesic_distance_from(g, &src, d, NULL, &err) == HD_ERR_ARGUMENT && err.row == 0 && err.vertex == vertex[1]);
    CHECK(hd_geodesic_distance_from(g, NULL, d, NULL, &err) == HD_ERR_ARGUMENT && hd_geodesic_distance_from(g, &src, NULL, NULL, &err) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance_from(NULL, &src, d, NULL, &err) == HD_ERR_ARGUMENT);
    hd_geodesic_free(g);
    shape_free(&a);
    shape_free(&b);
    shape_free(&s);
    free(d);
    free(e);
}

/* A plan of the triangles of a shape: 0 as they are, 1 by their lengths, 2 intrinsic Delaunay, 3 tufted, 4 as polygons that are split, 5 points. */
static hd_geodesic *src_plan(const shape *s, int kind, hd_geodesic_border border, double t) {
    shape_poly p = shape_poly_of(s);
    double *length = DENSE_NEW(double, 3 * s->n_tri);
    hd_geodesic *g = NULL;
    hd_geodesic_opts o;
    hd_error e;
    int32_t q;
    memset(&o, 0, sizeof o);
    o.t = t;
    o.border = border;
    o.intrinsic_delaunay = kind == 2 || kind == 4;
    o.tufted = kind == 3;
    for (q = 0; q < 3 * s->n_tri; q++) length[q] = src_gap(s->xyz + 3 * s->tri[q], s->xyz + 3 * s->tri[q % 3 == 2 ? q - 2 : q + 1]);
    if (kind == 1) (void)hd_geodesic_create_lengths(&g, length, s->n, s->tri, s->n_tri, &o, &e);
    else if (kind == 4) (void)hd_geodesic_create_polygons(&g, p.xyz, p.n, p.face_ptr, p.face_idx, p.n_faces, &o, &e);
    else if (kind == 5) (void)hd_geodesic_create_points(&g, s->xyz, s->n, NULL, NULL, &o, &e);
    else (void)hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, &o, &e);
    CHECK_MSG(g != NULL, "plan %d: %s", kind, e.text);
    shape_poly_free(&p);
    free(length);
    return g;
}

/* Where another kind of plan has the same triangles, it gives the same distances from points in faces, on an edge, and from curves. */
static void src_geo_kinds(const shape *s, int last) {
    double *d = DENSE_NEW(double, s->n), *want = DENSE_NEW(double, s->n);
    const double bary[9] = {0.2, 0.3, 0.5, 0, 0.6, 0.4, 0.7, 0.2, 0.1};
    const int32_t far_face = s->n_tri / 2;
    int32_t vertex[9];
    int b, kind, which;
    for (b = 0; b < (last == 5 ? 1 : 3); b++) {
        hd_geodesic *g = src_plan(s, 0, (hd_geodesic_border)b, 0.02);
        for (kind = 1; kind <= last; kind++) {
            hd_geodesic *other = src_plan(s, kind, (hd_geodesic_border)b, 0.02);
            for (which = 0; which < 3; which++) {    /* a point; three points, of two faces; a curve in a face */
                hd_source src = src_in_triangles(which == 0 ? 1 : 3, vertex, bary);
                hd_geodesic_report rep;
                int q;
                for (q = 0; q < 3; q++) memcpy(vertex + 3 * q, s->tri + 3 * (which == 1 && q == 2 ? far_face : 3), 3 * sizeof *vertex);
                src.curve = which == 2;
                CHECK(hd_geodesic_distance_from(g, &src, want, &rep, NULL) == HD_OK && hd_geodesic_distance_from(other, &src, d, &rep, NULL) == HD_OK);
                CHECK_MSG(dense_max_diff(d, want, s->n) < 1e-11, "border %d, plan %d, source %d: off by %g", b, kind, which, dense_max_diff(d, want, s->n));
            }
            hd_geodesic_free(other);
        }
        hd_geodesic_free(g);
    }
    free(d);
    free(want);
}

/* The largest error of a source on a square: the points, or the straight line from the first to the last of them. -1: it was refused. */
static double src_square_off(hd_geodesic *g, const shape *s, const hd_source *src, hd_error *e) {
    double *d = DENSE_NEW(double, s->n), p[8][2] = {{0, 0}}, most = -1;
    hd_geodesic_report rep;
    int32_t q, c, v;
    if (hd_geodesic_distance_from(g, src, d, &rep, e) == HD_OK && rep.residual_heat < 1e-13) {
        for (q = 0; q < src->count; q++)
            for (c = 0; c < 6; c++) p[q][c % 2] += src->bary[3 * q + c / 2] * s->xyz[3 * src->vertex[3 * q + c / 2] + c % 2];
        for (v = 0; v < s->n; v++) {
            const double *x = s->xyz + 3 * v;
            double want = HUGE_VAL;
            for (q = 0; q < src->count; q++) want = fmin(want, hypot(x[0] - p[q][0], x[1] - p[q][1]));
            if (src->curve) {
                const double dx = p[src->count - 1][0] - p[0][0], dy = p[src->count - 1][1] - p[0][1];
                const double at = fmax(0, fmin(1, ((x[0] - p[0][0]) * dx + (x[1] - p[0][1]) * dy) / (dx * dx + dy * dy)));
                want = hypot(p[0][0] + at * dx - x[0], p[0][1] + at * dy - x[1]);
            }
            most = fmax(most, fabs(d[v] - want));
        }
        for (q = 0; q < src->count && !src->curve; q++)
            for (c = 0; c < 3; c++) {
                const int32_t corner = src->vertex[3 * q + c];
                if (src->bary[3 * q + c] > 0) CHECK(fabs(d[corner] - hypot(s->xyz[3 * corner] - p[q][0], s->xyz[3 * corner + 1] - p[q][1])) < 1e-14);
            }
    }
    free(d);
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
    shape s = shape_grid(N, N, 0);
    int b, q;
    for (b = 0; b < 3; b++) {
        const int zero = b == HD_GEODESIC_BORDER_DIRICHLET;
        hd_geodesic *g = src_plan(&s, 0, (hd_geodesic_border)b, 0);
        hd_source src;
        double off;
        hd_error e;
        for (q = 0; q < KINDS; q++) {
            src = src_in_triangles(at[q].count, at[q].vertex, at[q].bary);
            src.curve = at[q].curve;
            off = src_square_off(g, &s, &src, &e);
            if (zero && at[q].row >= 0) CHECK_MSG(off < 0 && e.status == HD_ERR_ARGUMENT && e.row == at[q].row && strstr(e.text, "border"), "%s: %g, row %d", at[q].what, off, (int)e.row);
            else CHECK_MSG(off >= 0 && off < (zero ? 0.13 : 0.05), "border %d, %s: off by %g", b, at[q].what, off);
        }
        src = src_in_triangles(2, stays, first); /* a curve that stays where it is */
        src.curve = 1;
        CHECK(src_square_off(g, &s, &src, &e) < 0 && e.status == HD_ERR_ARGUMENT);
        hd_geodesic_free(g);
    }
    shape_free(&s);
}

/* ---- errors ---- */

static void src_refused(hd_heat *heat, const hd_source *s, hd_status want, int64_t row, int64_t vertex, const char *what) {
    hd_source two[2];
    const double t = 1;
    double u[200];
    hd_report rep;
    hd_status st;
    memset(two, 0, sizeof two);
    two[0].count = 1;
    two[0].vertex = s->vertex;
    two[1] = *s;
    st = hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &t, 2, two, u, 0, &rep, NULL);
    CHECK_MSG(st == want && (want == HD_OK || rep.error.column == 1) &&
              rep.error.row == row && rep.error.vertex == vertex, "%s: %s, %s, column %d, row %d, vertex %d", what, hd_status_name(rep.status), rep.error.text,
              (int)rep.error.column, (int)rep.error.row, (int)rep.error.vertex);
    CHECK(hd_heat_distance_from(heat, HD_DISTANCE_CLASSICAL, 1, &t, 2, two, u, 0, &rep, NULL) == want);
}

/* One vertex of weight 2 is twice its column, and a vertex that is held has no heat to give, whatever its weight. */
static void src_one_vertex(const hd_laplacian *lap, hd_heat *heat, int32_t held) {
    const int32_t id[2] = {3, held};
    const double t = 1, two = 2;
    double u[25], v[25];
    hd_source s;
    int32_t i;
    int q;
    memset(&s, 0, sizeof s);
    s.count = 1;
    s.weight = &two;
    CHECK(lap->n == 25);
    for (q = 0; q < 2; q++) {
        const hd_kernel kernel = q ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        s.vertex = id;
        CHECK(hd_heat_columns_from(heat, kernel, 1, &t, 1, &s, u, 0, NULL, NULL) == HD_OK);
        CHECK(hd_heat_columns(heat, kernel, 1, &t, 1, id, v, 0, NULL, NULL) == HD_OK);
        for (i = 0; i < 25; i++) CHECK(fabs(u[i] - 2 * v[i]) <= 1e-9 * fabs(v[3]));
        s.vertex = id + 1;
        CHECK(hd_heat_columns_from(heat, kernel, 1, &t, 1, &s, u, 0, NULL, NULL) == HD_OK);
        for (i = 0; i < 25; i++) CHECK(u[i] == 0);
    }
}

/* Weights near both ends of what is allowed: the answer is that of weight 1, times the weight, by every method. */
static void src_far_weights(void) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_ITERATIVE, HD_METHOD_KRYLOV};
    shape ball = shape_icosphere(1);
    hd_laplacian *lap = test_laplacian(&ball, HD_LAPLACIAN_FEM);
    const int32_t id[2] = {3, 11};
    const double t = 3 * lap->h * lap->h;
    double *u = DENSE_NEW(double, ball.n), *one = DENSE_NEW(double, ball.n), weight[2];
    hd_source s;
    int32_t i;
    int q, k;
    memset(&s, 0, sizeof s);
    s.count = 2;
    s.vertex = id;
    s.weight = weight;
    for (q = 0; q < 6; q++) {
        const hd_kernel kernel = q % 2 ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
        hd_heat *heat = eng_plan(lap, methods[q / 2], HD_POLES_DEFAULT, 0);
        for (k = 0; k < 3; k++) {
            const int exponent = k == 0 ? 0 : k == 1 ? 300 : -300;
            double most = 0;
            hd_report rep;
            weight[0] = ldexp(1, exponent);
            weight[1] = ldexp(0.5, exponent);
            CHECK(hd_heat_columns_from(heat, kernel, 1, &t, 1, &s, k ? u : one, 0, &rep, NULL) == HD_OK && rep.error_bound <= 1e-6);
            for (i = 0; i < ball.n; i++) most = fmax(most, fabs(one[i]));
            for (i = 0; i < ball.n && k; i++)
                CHECK_MSG(fabs(ldexp(u[i], -exponent) - one[i]) <= 1e-12 * most, "method %d, 2^%d: %.17g, %.17g", q, exponent, ldexp(u[i], -exponent), one[i]);
        }
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    shape_free(&ball);
    free(u);
    free(one);
}

static void src_errors(void) {
    shape g = shape_grid(5, 5, 0);
    const int32_t held = 7;
    const hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 1, &held);
    hd_laplacian *lap = bord_triangles(&g, &o);
    hd_heat *heat = eng_create(lap, NULL);
    const int32_t id[6] = {1, 2, 6, 2, 6, 7};
    double bary[6] = {0.5, 0.25, 0.25, 0.5, 0.25, 0.25}, weight[2] = {1, 2}, t = 1, u[75];
    hd_source s, ok;
    hd_report rep;
    hd_error err;
    memset(&ok, 0, sizeof ok);
    ok.count = 2;
    ok.corners = 3;
    ok.vertex = id;
    ok.bary = bary;
    s = ok;
    src_refused(heat, &s, HD_OK, -1, -1, "fine");
    s.begin_zero = 1;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "not cleared");
    s = ok;
    s.count = 0;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "no point");
    s = ok;
    s.corners = -1;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "corners");
    s = ok;
    bary[4] = -0.25;
    src_refused(heat, &s, HD_ERR_ARGUMENT, 1, 6, "negative");
    bary[4] = 0.26;
    src_refused(heat, &s, HD_ERR_ARGUMENT, 1, -1, "sum");
    bary[4] = NAN;
    src_refused(heat, &s, HD_ERR_NOT_FINITE, 1, 6, "no number");
    bary[4] = 0.25;
    s.weight = weight;
    src_refused(heat, &s, HD_OK, -1, -1, "weights");
    weight[1] = HUGE_VAL;
    src_refused(heat, &s, HD_ERR_NOT_FINITE, 1, -1, "infinite weight");
    weight[1] = weight[0] = 0;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "no weight");
    weight[0] = 1;
    weight[1] = -1;
    CHECK(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &t, 1, &s, u, 0, &rep, NULL) == HD_OK);
    CHECK(hd_heat_distance_from(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &s, u, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.column == 0);
    weight[1] = 2;
    s.curve = 1;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "weights of a curve");
    s.weight = NULL;
    src_refused(heat, &s, HD_ERR_ARGUMENT, 1, 7, "a curve without coordinates");
    s.length = weight;
    src_refused(heat, &s, HD_OK, -1, -1, "a curve with lengths");
    weight[0] = -1;
    src_refused(heat, &s, HD_ERR_ARGUMENT, 0, -1, "a negative length");
    weight[0] = 0;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "no length");
    weight[0] = HUGE_VAL;
    src_refused(heat, &s, HD_ERR_NOT_FINITE, 0, -1, "an infinite length");
    weight[0] = 1e200;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "a length beyond all");
    s.count = 1;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "one point of a curve");
    s = ok;
    s.end_zero = 1;
    src_refused(heat, &s, HD_ERR_ARGUMENT, -1, -1, "not cleared at its end");
    s = ok;
    s.count = 1 << 30;
    src_refused(heat, &s, HD_ERR_TOO_LARGE, -1, -1, "too many points");
    src_one_vertex(lap, heat, held);
    s = ok;
    s.vertex = NULL;
    CHECK(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &t, 1, &s, u, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.column == 0);
    s = ok;
    s.vertex = id + 1;
    s.corners = 1;
    s.count = 5;
    s.bary = NULL;
    src_refused(heat, &s, HD_OK, -1, -1, "vertices, one held");
    {
        int32_t bad[3] = {0, 1, 25};
        s.vertex = bad;
        s.count = 3;
        src_refused(heat, &s, HD_ERR_INDEX, 2, 25, "no such vertex");
        bad[2] = -1;
        src_refused(heat, &s, HD_ERR_INDEX, 2, -1, "a negative vertex");
    }
    CHECK(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &t, 0, NULL, NULL, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_columns_from(heat, HD_KERNEL_OPERATOR, 1, &t, 1, NULL, u, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_distance_from(heat, HD_DISTANCE_CLASSICAL, 1, &t, 0, NULL, NULL, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_distance_from(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &ok, NULL, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    {
        hd_spectrum *z = spec_make(lap, 5, 0, HD_OK);
        hd_source bad = ok;
        int32_t chosen[3];
        bad.begin_zero = 1;
        CHECK(hd_heat_sample_from(heat, HD_DISTANCE_CLASSICAL, t, -1, &ok, 2, chosen, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
        CHECK(hd_heat_sample_from(heat, HD_DISTANCE_CLASSICAL, t, 1, NULL, 2, chosen, NULL, NULL, NULL) == HD_ERR_ARGUMENT);
        CHECK(hd_heat_sample_from(heat, HD_DISTANCE_CLASSICAL, t, 1, &bad, 2, chosen, NULL, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.column == 0);
        CHECK(hd_spectrum_columns_from(z, HD_KERNEL_OPERATOR, 1, &t, 1, &bad, u, NULL, 0, &err) == HD_ERR_ARGUMENT && err.column == 0);
        CHECK(hd_spectrum_columns_from(z, HD_KERNEL_OPERATOR, 1, &t, 1, NULL, u, NULL, 0, NULL) == HD_ERR_ARGUMENT);
        CHECK(hd_spectrum_distance_from(z, HD_DISTANCE_COMMUTE, 2, NULL, 1, &ok, u, NULL, 0, NULL) == HD_ERR_ARGUMENT);
        CHECK(hd_spectrum_distance_from(z, HD_DISTANCE_COMMUTE, 0, NULL, 0, NULL, NULL, NULL, 0, NULL) == HD_OK);
        hd_spectrum_free(z);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    shape_free(&g);
}

/* Every allocation fails once; nothing stays behind. */
static void src_memory(void) {
    shape g = shape_grid(5, 5, 0);
    int64_t fail = 1;
    int done = 0;
    for (; !done && fail < 2000; fail++) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        hd_laplacian_opts o = bord_opts(HD_LAPLACIAN_FEM, HD_BORDER_NATURAL, 0, NULL);
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        hd_geodesic_opts go;
        hd_geodesic *geo = NULL;
        hd_spectrum_opts so;
        hd_spectrum *z = NULL;
        const double t[2] = {0.1, 0.3};
        double u[100];
        src_room room[2];
        hd_source s[2];
        hd_status st;
        o.context = &ctx;
        ctx.n_threads = 1;
        m.fail_at = fail;
        st = hd_laplacian_triangles(&lap, g.xyz, g.n, g.tri, g.n_tri, &o, NULL);
        if (st == HD_OK) st = hd_heat_create(&heat, lap, NULL, NULL);
        if (st == HD_OK) {
            src_make(room, lap, 0);
            src_make(room + 1, lap, 5);
            s[0] = room[0].s;
            s[1] = room[1].s;
            st = hd_heat_columns_from(heat, HD_KERNEL_SYMMETRIC, 2, t, 2, s, u, 0, NULL, NULL);
        }
        if (st == HD_OK) st = hd_heat_distance_from(heat, HD_DISTANCE_BIHARMONIC, 0, NULL, 2, s, u, 0, NULL, NULL);
        if (st == HD_OK) st = hd_heat_sample_from(heat, HD_DISTANCE_BIHARMONIC, 0, 2, s, 3, room[1].vertex, u, NULL, NULL);
        memset(&so, 0, sizeof so);
        so.count = 4;
        if (st == HD_OK) st = hd_spectrum_create(&z, lap, &so, NULL);
        if (st == HD_OK) st = hd_spectrum_columns_from(z, HD_KERNEL_SYMMETRIC, 1, t, 1, s, u, NULL, 0, NULL);
        if (st == HD_OK) st = hd_spectrum_distance_from(z, HD_DISTANCE_COMMUTE, 0, NULL, 1, s, u, NULL, 0, NULL);
        memset(&go, 0, sizeof go);
        go.context = &ctx;
        if (st == HD_OK) st = hd_geodesic_create(&geo, g.xyz, g.n, g.tri, g.n_tri, &go, NULL);
        src_place(&g, 0.6, 0.3, room[0].vertex, room[0].bary);
        if (st == HD_OK) st = hd_geodesic_distance_from(geo, &room[0].s, u, NULL, NULL);
        CHECK(st == HD_OK || st == HD_ERR_MEMORY);
        done = st == HD_OK;
        hd_geodesic_free(geo);
        hd_spectrum_free(z);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        test_memory_done(&m, &ctx, "sources");
    }
    CHECK(done && fail > 40);
    shape_free(&g);
}

static void test_sources(void) {
    src_two();
    src_sample_report();
    src_operators();
    src_means();
    src_pairs();
    src_square();
    src_line();
    src_geo_sphere(3);
    src_geo_sphere(4);
    src_geo_square();
    src_geo_strip();
    src_geo_rules();
    {
        shape ball = shape_icosphere(2), cap = bord_disk(6, 1);
        src_geo_kinds(&ball, 5);
        src_geo_kinds(&cap, 4);
        shape_free(&ball);
        shape_free(&cap);
    }
    src_geo_borders();
    src_far_weights();
    src_errors();
    src_memory();
}

#endif
