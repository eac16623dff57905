/* test_geodesic_all.h - the heat method on polygons, intrinsic triangles and points, and with borders: against a dense computation by other formulas,
 * against distances known exactly, and against triangles */

#ifndef TEST_GEODESIC_ALL_H
#define TEST_GEODESIC_ALL_H

static hd_geodesic_opts gall_options(void) {
    hd_geodesic_opts o;
    memset(&o, 0, sizeof o);
    return o;
}

static hd_geodesic *gall_polygons(const shape_poly *s, const hd_geodesic_opts *o) {
    hd_geodesic *g = NULL;
    hd_error e;
    CHECK_MSG(hd_geodesic_create(&g, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), o, &e) == HD_OK, "%s", e.text);
    return g;
}

static hd_geodesic *gall_triangles(const shape *s, const hd_geodesic_opts *o) {
    hd_geodesic *g = NULL;
    hd_error e;
    CHECK_MSG(hd_geodesic_create(&g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), o, &e) == HD_OK, "%s", e.text);
    return g;
}

static hd_geodesic *gall_points(const double *xyz, int32_t n, const hd_geodesic_opts *o) {
    hd_geodesic *g = NULL;
    hd_error e;
    CHECK_MSG(at_tufted_geodesic(&g, xyz, n, o, &e) == HD_OK, "%s", e.text);
    return g;
}

/* ---- polygons against their definition, dense ---- */

/* One step of the definition: (B + t L) u = the indicator, with the rows in held (or none) taken out. */
static void gall_dense_heat(const double *L, const double *mass, double t, const char *held, const int32_t *sources, int32_t k, int32_t n, double *u) {
    double *A = KIT_NEW(double, (int64_t)n * n);
    int32_t i, q;
    for (i = 0; i < n * n; i++) {
        const int32_t a = i / n, b = i % n;
        A[i] = t * L[i] + (a == b ? mass[a] : 0);
        if ((held && (held[a] || held[b])) || (a == b && mass[a] == 0)) A[i] = a == b;
    }
    for (i = 0; i < n; i++) u[i] = 0;
    for (q = 0; q < k; q++) u[sources[q]] = !(held && held[sources[q]]);
    CHECK(dense_cholesky(A, n));
    dense_forward(A, u, n);
    dense_backward(A, u, n);
}

/* div of the unit field down |u| of every face by the middles of its edges: D'B B'D u / |B'D u|, with an origin in the face. */
static void gall_dense_divergence(const shape_poly *s, const double *u, double *b) {
    int32_t f, p, c;
    for (p = 0; p < s->n; p++) b[p] = 0;
    for (f = 0; f < s->n_faces; f++) {
        const int32_t k = (int32_t)(s->face_ptr[f + 1] - s->face_ptr[f]), *v = s->face_idx + s->face_ptr[f];
        double Y[3] = {0, 0, 0}, most = 0, size = 0, length;
        for (p = 0; p < k; p++) {
            const int32_t i = v[p], j = v[(p + 1) % k];
            for (c = 0; c < 3; c++) {
                const double middle = (s->xyz[3 * i + c] + s->xyz[3 * j + c]) / 2 - s->xyz[3 * v[0] + c];
                Y[c] += middle * (fabs(u[j]) - fabs(u[i]));
            }
            most = fmax(most, fabs(u[i]));
            size = fmax(size, shape_distance(s->xyz + 3 * i, s->xyz + 3 * j));
        }
        length = sqrt(shape_dot(Y, Y));
        for (c = 0; c < 3; c++) Y[c] = length > 1e-13 * most * size ? -Y[c] / length : 0;
        for (p = 0; p < k; p++) {
            const int32_t i = v[p], j = v[(p + 1) % k];
            double flow = 0;
            for (c = 0; c < 3; c++) flow += ((s->xyz[3 * i + c] + s->xyz[3 * j + c]) / 2 - s->xyz[3 * v[0] + c]) * Y[c];
            b[j] += flow;
            b[i] -= flow;
        }
    }
}

/* component [n] by the smallest vertex; -1 in no face. */
static void gall_components(const shape_poly *s, int32_t *component) {
    int32_t f, changed = 1;
    int64_t c;
    for (f = 0; f < s->n; f++) component[f] = -1;
    for (c = 0; c < s->face_ptr[s->n_faces]; c++) component[s->face_idx[c]] = s->face_idx[c];
    while (changed)
        for (changed = 0, f = 0; f < s->n_faces; f++)
            for (c = s->face_ptr[f] + 1; c < s->face_ptr[f + 1]; c++) {
                int32_t *a = component + s->face_idx[c], *b = component + s->face_idx[c - 1];
                changed |= *a != *b;
                if (*a < *b) *b = *a;
                else *a = *b;
            }
}

static double gall_mean_edge(const shape_poly *s) {
    char *seen = KIT_NEW(char, (int64_t)s->n * s->n);
    double sum = 0, count = 0;
    int32_t f, p;
    for (f = 0; f < s->n_faces; f++) {
        const int32_t k = (int32_t)(s->face_ptr[f + 1] - s->face_ptr[f]), *v = s->face_idx + s->face_ptr[f];
        for (p = 0; p < k; p++) {
            const int64_t i = v[p], j = v[(p + 1) % k];
            if (!seen[i * s->n + j]) {
                sum += shape_distance(s->xyz + 3 * i, s->xyz + 3 * j);
                count++;
            }
            seen[i * s->n + j] = seen[j * s->n + i] = 1;
        }
    }
    return sum / count;
}

/* The heat of the values of phi at the sources above the least one of their component, with the same border as the heat of the sources. */
static void gall_dense_values(const double *L, const double *mass, double t, hd_geodesic_border border, const char *held, const double *phi, const int32_t *component,
                              const int32_t *sources, int32_t k, int32_t n, double *v) {
    double *one = KIT_NEW(double, n), *least = KIT_NEW(double, n);
    int32_t i, q, p;
    for (i = 0; i < n; i++) least[i] = HUGE_VAL;
    for (i = 0; i < n; i++) v[i] = 0;
    for (q = 0; q < k; q++)
        if (component[sources[q]] >= 0) least[component[sources[q]]] = fmin(least[component[sources[q]]], phi[sources[q]]);
    for (q = 0; q < k; q++) {
        const double mean = border == HD_GEODESIC_BORDER_MEAN ? 0.5 : 1;
        for (p = 0; p < q && sources[p] != sources[q]; p++) {}
        if (p < q || component[sources[q]] < 0) continue;
        gall_dense_heat(L, mass, t, border == HD_GEODESIC_BORDER_DIRICHLET ? held : NULL, sources + q, 1, n, one);
        for (i = 0; i < n; i++) v[i] += mean * one[i] * (phi[sources[q]] - least[component[sources[q]]]);
        if (border != HD_GEODESIC_BORDER_MEAN) continue;
        gall_dense_heat(L, mass, t, held, sources + q, 1, n, one);
        for (i = 0; i < n; i++) v[i] += mean * one[i] * (phi[sources[q]] - least[component[sources[q]]]);
    }
}

/* held: marks of the border. border: which of the three conditions. */
static void gall_dense_distance(const shape_poly *s, double lambda, double t, hd_geodesic_border border, const char *held, const int32_t *sources, int32_t k,
                                double *d) {
    double *mass = KIT_NEW(double, s->n), *L = poly_dense(s, lambda, mass), *u = KIT_NEW(double, s->n), *w = KIT_NEW(double, s->n), *phi = KIT_NEW(double, s->n);
    double *H = poly_dense(s, lambda, mass), *v = KIT_NEW(double, s->n);
    int32_t *component = KIT_NEW(int32_t, s->n), i;
    gall_components(s, component);
    gall_dense_heat(L, mass, t, border == HD_GEODESIC_BORDER_DIRICHLET ? held : NULL, sources, k, s->n, u);
    if (border == HD_GEODESIC_BORDER_MEAN) {
        gall_dense_heat(L, mass, t, held, sources, k, s->n, w);
        for (i = 0; i < s->n; i++) u[i] = (u[i] + w[i]) / 2;
    }
    gall_dense_divergence(s, u, phi);
    for (i = 0; i < s->n * s->n; i++) {
        const int32_t a = i / s->n, b = i % s->n;
        if (component[a] >= 0 && component[a] == component[b]) L[i] += 1.0 / s->n;
        if (a == b && component[a] < 0) L[i] = 1;
    }
    CHECK(dense_cholesky(L, s->n));
    dense_forward(L, phi, s->n);
    dense_backward(L, phi, s->n);
    gall_dense_values(H, mass, t, border, held, phi, component, sources, k, s->n, v);
    geo_dense_from(NULL, u, v, phi, component, sources, k, s->n, d);
    free(L);
    free(H);
}

/* Marks the ends of edges with one face. */
static char *gall_border(const shape_poly *s) {
    char *held = DENSE_NEW(char, s->n);
    int32_t *count = KIT_NEW(int32_t, (int64_t)s->n * s->n), f, p, i, j;
    for (f = 0; f < s->n_faces; f++)
        for (p = 0; p < s->face_ptr[f + 1] - s->face_ptr[f]; p++) {
            const int32_t *v = s->face_idx + s->face_ptr[f], k = (int32_t)(s->face_ptr[f + 1] - s->face_ptr[f]);
            count[(int64_t)v[p] * s->n + v[(p + 1) % k]]++;
            count[(int64_t)v[(p + 1) % k] * s->n + v[p]]++;
        }
    for (i = 0; i < s->n; i++)
        for (j = 0; j < s->n; j++) held[i] |= count[(int64_t)i * s->n + j] == 1;
    return held;
}

/* inner: a vertex off the border, from which Dirichlet is asked too. */
static void gall_against_dense(shape_poly s, int32_t inner, const char *what) {
    static const double times[4] = {0, 0.3, 20, 1e4}, lambdas[2] = {0, 0.8};
    const double h = gall_mean_edge(&s);
    const int32_t several[8] = {s.n / 3, 0, s.n - 1, s.n / 2, 1, s.n / 2, 2, s.n - 2};
    double *d = KIT_NEW(double, 8 * s.n), *want = KIT_NEW(double, 8 * s.n);
    char *held = gall_border(&s);
    int k, border, q;
    for (k = 0; k < 8; k++)
        for (border = 0; border < 3; border++) {
            const double t = (times[k / 2] > 0 ? times[k / 2] : 1) * h * h, lambda = lambdas[k % 2] > 0 ? lambdas[k % 2] : 1.0 / 6;
            const hd_geodesic_border b = (hd_geodesic_border)border;
            const double tol = times[k / 2] > 1e3 ? 1e-6 : 1e-9;         /* u is flat: its slopes are differences of nearly equal numbers */
            hd_geodesic_opts o = gall_options();
            hd_geodesic *g;
            hd_geodesic_report rep;
            if (k % 2) o.t = times[k / 2] * h * h;
            else o.t_in_h2 = times[k / 2];
            o.stiffening = lambdas[k % 2];
            o.border = b;
            g = gall_polygons(&s, &o);
            if (b == HD_GEODESIC_BORDER_DIRICHLET) {
                const int32_t one[3] = {inner, inner, inner};
                gall_dense_distance(&s, lambda, t, b, held, one, 1, want);
                CHECK(hd_geodesic_distance(g, VERTICES(1, one), d, 0, &rep, NULL) == HD_OK && rep.residual_heat < 1e-12 &&
                    rep.residual_distance < 1e-10);
                CHECK(geo_difference(d, want, s.n) <= tol * geo_largest(want, s.n));
                CHECK(hd_geodesic_distance(g, VERTICES(3, one), d, 0, &rep, NULL) == HD_OK && rep.residual_heat < 1e-12 &&
                    rep.residual_distance < 1e-10);
                CHECK(geo_difference(d + 2 * s.n, want, s.n) <= tol * geo_largest(want, s.n));
                for (q = 0; q < s.n && !held[q]; q++) {}
                if (q < s.n) CHECK(hd_geodesic_distance(g, VERTICES(1, &q), d, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.vertex == q &&
                    strstr(rep.error.text, "border"));
            } else {
                gall_dense_distance(&s, lambda, t, b, held, several, 8, want);
                CHECK(hd_geodesic_distance(g, TOGETHER(8, several), d, 0, &rep, NULL) == HD_OK && rep.n_stages == 1);
                CHECK_MSG(geo_difference(d, want, s.n) <= tol * geo_largest(want, s.n), "%s, t %g, border %d: off by %g", what, times[k / 2], border,
                          geo_difference(d, want, s.n) / geo_largest(want, s.n));
                CHECK_MSG(rep.residual_heat < (times[k / 2] > 100 ? 1e-7 : 1e-12) && rep.residual_distance < 1e-10 && fabs(rep.h - h) < 1e-13 * h, "%s: residuals %g %g", what,
                          rep.residual_heat, rep.residual_distance);
                for (q = 0; q < 8; q++) gall_dense_distance(&s, lambda, t, b, held, several + q, 1, want + q * s.n);
                CHECK(hd_geodesic_distance(g, VERTICES(8, several), d, 0, &rep, NULL) == HD_OK &&
                    rep.residual_heat < (times[k / 2] > 100 ? 1e-7 : 1e-12));
                CHECK_MSG(geo_difference(d, want, 8 * s.n) <= tol * geo_largest(want, 8 * s.n), "%s, t %g, border %d: eight columns off by %g", what, times[k / 2], border,
                          geo_difference(d, want, 8 * s.n) / geo_largest(want, 8 * s.n));
            }
            hd_geodesic_free(g);
        }
    free(held);
    shape_poly_free(&s);
}

/* ---- the same answers by other ways ---- */

/* Triangles given as polygons, and the intrinsic triangulations of a closed mesh that is Delaunay already. */
static void gall_equal(void) {
    shape s = kit_own_shape(shape_icosphere(3));
    shape_poly p = kit_own_poly(shape_poly_of(&s));
    const int32_t sources[4] = {5, 100, 17, 600};
    double *want = KIT_NEW(double, 5 * s.n), *d = KIT_NEW(double, 5 * s.n);
    hd_geodesic_opts o = gall_options();
    hd_geodesic *g = gall_triangles(&s, NULL);
    hd_geodesic_report rep;
    int way;
    CHECK(hd_geodesic_distance(g, TOGETHER(4, sources), want, 0, NULL, NULL) == HD_OK &&
        hd_geodesic_distance(g, VERTICES(4, sources), want + s.n, 0, NULL, NULL) == HD_OK);
    hd_geodesic_free(g);
    for (way = 0; way < 5; way++) {
        o.triangulation = way == 1 || way == 4 ? HD_TRIANGULATION_DELAUNAY : way == 2 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
        o.mollify = way ? -1 : 0;
        o.border = way == 0 ? HD_GEODESIC_BORDER_MEAN : HD_GEODESIC_BORDER_NATURAL;
        if (way == 3) o.border = HD_GEODESIC_BORDER_NATURAL;
        g = way == 0 || way == 4 ? gall_polygons(&p, &o) : way == 3 ? gall_points(s.xyz, s.n, &o) : gall_triangles(&s, &o);
        CHECK(hd_geodesic_distance(g, TOGETHER(4, sources), d, 0, &rep, NULL) == HD_OK && rep.residual_heat < 1e-13 &&
            rep.residual_distance < 1e-11);
        CHECK(hd_geodesic_distance(g, VERTICES(4, sources), d + s.n, 0, &rep, NULL) == HD_OK && rep.residual_heat < 1e-13 &&
            rep.residual_distance < 1e-11);
        CHECK_MSG(geo_difference(d, want, 5 * s.n) < 1e-10, "way %d is off by %g", way, geo_difference(d, want, 5 * s.n));
        hd_geodesic_free(g);
    }
}

/* Slivers in a plane: flipped along the surface they are as good as any. The residuals compare the frames of faces with L as it was assembled. */
static void gall_slivers(void) {
    const double squeeze[3] = {1, 5, 20};
    int k, way;
    for (k = 0; k < 3; k++) {
        shape s = kit_own_shape(shape_grid(31, 31, 0.3));
        const int32_t source = 480;
        double *d = KIT_NEW(double, s.n), error[3];
        int32_t i;
        for (i = 0; i < s.n; i++) s.xyz[3 * i + 1] /= squeeze[k];
        for (way = 0; way < 3; way++) {
            hd_geodesic_opts o = gall_options();
            hd_geodesic *g;
            hd_geodesic_report rep;
            o.triangulation = way == 1 ? HD_TRIANGULATION_DELAUNAY : way == 2 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
            g = gall_triangles(&s, &o);
            CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, &rep, NULL) == HD_OK);
            CHECK_MSG(rep.residual_heat < 1e-9 && rep.residual_distance < 1e-9, "residuals %g %g", rep.residual_heat, rep.residual_distance);
            hd_geodesic_free(g);
            for (i = 0, error[way] = 0; i < s.n; i++) error[way] += fabs(d[i] - shape_distance(s.xyz + 3 * i, s.xyz + 3 * source)) / s.n;
        }
        CHECK_MSG(error[1] < 0.015 && error[2] < 0.015 && (k == 0 || error[0] > 4 * error[1]), "1:%g: errors %g %g %g", squeeze[k], error[0], error[1], error[2]);
    }
}

/* ---- accuracy ---- */

/* Mean error on the unit sphere of eight sources. *h as the report says. */
static double gall_sphere(hd_geodesic *g, const double *xyz, int32_t n, double *h) {
    double *d = KIT_NEW(double, 8 * n), sum = 0;
    int32_t sources[8], i, q;
    hd_geodesic_report rep;
    for (q = 0; q < 8; q++) sources[q] = (int32_t)((int64_t)q * (n - 1) / 7);
    CHECK(hd_geodesic_distance(g, VERTICES(8, sources), d, 0, &rep, NULL) == HD_OK && rep.residual_distance < 1e-10);
    for (q = 0; q < 8; q++)
        for (i = 0; i < n; i++) sum += fabs(d[q * n + i] - 2 * asin(fmin(1, shape_distance(xyz + 3 * i, xyz + 3 * sources[q]) / 2)));
    *h = rep.h;
    hd_geodesic_free(g);
    return sum / (8.0 * n);
}

static double gall_sphere_poly(shape_poly s, double *h) {
    const double e = gall_sphere(gall_polygons(&s, NULL), s.xyz, s.n, h);
    shape_poly_free(&s);
    return e;
}

/* The mean error at edge length h as interpolated between two meshes of triangles, in the logarithms. */
static double gall_between(const double *h, const double *e, int n, double at) {
    int k = 0;
    while (k + 2 < n && at < h[k + 1]) k++;
    return exp(log(e[k]) + (log(at) - log(h[k])) * (log(e[k + 1]) - log(e[k])) / (log(h[k + 1]) - log(h[k])));
}

/* On the sphere polygons and points spread evenly are at most 1.5 times as far off as triangles with edges as long. Independent random points have long and
 * short edges: 2.2 times, as far as the triangles of their convex hull. */
static void gall_accuracy(void) {
    double h[3], e[3], at, error;
    int k, blue;
    for (k = 0; k < 3; k++) {
        shape s = shape_icosphere(k + 2);
        e[k] = gall_sphere(gall_triangles(&s, NULL), s.xyz, s.n, h + k);
        shape_free(&s);
    }
    for (k = 0; k < 2; k++) {
        error = gall_sphere_poly(shape_quad_sphere(10 << k), &at);
        CHECK_MSG(error < 1.5 * gall_between(h, e, 3, at), "quads of edges %g: %g, triangles %g", at, error, gall_between(h, e, 3, at));
        error = gall_sphere_poly(shape_hex_sphere(k + 2), &at);
        CHECK_MSG(error < 1.5 * gall_between(h, e, 3, at), "hexagons of edges %g: %g, triangles %g", at, error, gall_between(h, e, 3, at));
        for (blue = 0; blue < 2; blue++) {
            shape s = shape_points(500 << (2 * k), shape_on_sphere, 12.566370614359172, blue, 5);
            error = gall_sphere(gall_points(s.xyz, s.n, NULL), s.xyz, s.n, &at);
            CHECK_MSG(error < (blue ? 1.5 : 2.2) * gall_between(h, e, 3, at), "%s points of edges %g: %g, triangles %g", blue ? "even" : "random", at, error,
                      gall_between(h, e, 3, at));
            shape_free(&s);
        }
    }
}

/* Many sources at once are nearly as good as each by itself, and no vertex comes much nearer than it is. */
static void gall_many(void) {
    shape_poly p = kit_own_poly(shape_quad_sphere(16));
    shape s = kit_own_shape(shape_grid(31, 31, 0.3));
    int32_t sources[40], k, i, way;
    double *d = KIT_NEW(double, p.n);
    for (way = 0; way < 2; way++) {
        const double *xyz = way ? s.xyz : p.xyz;
        const int32_t n = way ? s.n : p.n;
        hd_geodesic *g = way ? gall_triangles(&s, NULL) : gall_polygons(&p, NULL);
        hd_geodesic_report rep;
        uint64_t seed = 11;
        double mean = 0, least = 1;
        for (k = 0; k < 40; k++) sources[k] = (int32_t)(dense_random(&seed) % (uint64_t)n);
        CHECK(hd_geodesic_distance(g, TOGETHER(40, sources), d, 0, &rep, NULL) == HD_OK);
        for (i = 0; i < n; i++) {
            double want = HUGE_VAL;
            for (k = 0; k < 40; k++) want = fmin(want, shape_distance(xyz + 3 * i, xyz + 3 * sources[k]));
            if (!way) want = 2 * asin(want / 2);
            mean += fabs(d[i] - want) / n / rep.h;
            if (want > 2 * rep.h) least = fmin(least, d[i] / want);
        }
        CHECK_MSG(mean < 0.35 && least > 0.6, "%d: mean error %g h, least ratio %g", (int)way, mean, least);
        hd_geodesic_free(g);
    }
}

/* In a convex piece of the plane the mean border lets heat flow longer: at 8 h^2 it is less than half as far off as the natural one. */
static void gall_borders(void) {
    shape s = kit_own_shape(shape_grid(31, 31, 0.3)), ball = kit_own_shape(shape_icosphere(2));
    const int32_t source = 15 * 31 + 8;
    double *d = KIT_NEW(double, s.n > ball.n ? s.n : ball.n), *e = KIT_NEW(double, ball.n), error[2];
    int b;
    for (b = 0; b < 2; b++) {
        hd_geodesic_opts o = gall_options();
        hd_geodesic *g;
        int32_t i;
        o.t = 8 / 900.0;
        o.border = (hd_geodesic_border)b;
        g = gall_triangles(&s, &o);
        CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, NULL, NULL) == HD_OK);
        hd_geodesic_free(g);
        for (i = 0, error[b] = 0; i < s.n; i++) error[b] += fabs(d[i] - shape_distance(s.xyz + 3 * i, s.xyz + 3 * source)) / s.n;
    }
    CHECK_MSG(error[1] < 0.5 * error[0], "errors %g, %g", error[0], error[1]);
    for (b = 0; b < 3; b++) {                    /* a closed surface has no border */
        hd_geodesic_opts o = gall_options();
        hd_geodesic *g;
        o.border = (hd_geodesic_border)b;
        g = gall_triangles(&ball, &o);
        CHECK(hd_geodesic_distance(g, VERTICES(1, &source), b ? e : d, 0, NULL, NULL) == HD_ERR_INDEX || b == 0 ||
            geo_difference(d, e, ball.n) == 0);
        hd_geodesic_free(g);
    }
}

/* ---- long ways ---- */

/* The cells of a tube of around x rows vertices as quadrangles. */
static shape_poly gall_tube(int32_t around, int32_t rows, double radius) {
    shape s = kit_own_shape(shape_cylinder(around, rows, radius, 1));
    shape_poly p = shape_poly_make(s.n, (int64_t)around * (rows - 1), 4 * (int64_t)around * (rows - 1));
    int32_t i, j;
    memcpy(p.xyz, s.xyz, 3 * (size_t)s.n * sizeof *s.xyz);
    for (i = 0; i < around; i++)
        for (j = 0; j + 1 < rows; j++) {
            const int32_t next = (i + 1) % around;
            shape_put_quad(&p, i * rows + j, next * rows + j, next * rows + j + 1, i * rows + j + 1);
        }
    return p;
}

/* As geo_tube: from all of a rim the distance is linear in the height, and exact, through all stages. way 0: quadrangles; 1: tufted; 2: intrinsic. */
static void gall_rim(int32_t around, int32_t rows, double tau, int way) {
    const double row = 1.0 / (rows - 1), radius = row * around / 6;
    shape s = kit_own_shape(shape_cylinder(around, rows, radius, 1));
    shape_poly p = kit_own_poly(gall_tube(around, rows, radius));
    double *d = KIT_NEW(double, s.n), worst = 0;
    int32_t *sources = KIT_NEW(int32_t, around), i;
    hd_geodesic_opts o = gall_options();
    hd_geodesic_report rep;
    hd_geodesic *g;
    o.t = tau * row * row;
    o.triangulation = way == 1 ? HD_TRIANGULATION_TUFTED : way == 2 ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
    o.mollify = way ? -1 : 0;
    g = way ? gall_triangles(&s, &o) : gall_polygons(&p, &o);
    for (i = 0; i < around; i++) sources[i] = i * rows;
    CHECK(hd_geodesic_distance(g, TOGETHER(around, sources), d, 0, &rep, NULL) == HD_OK && rep.n_stages > 1);
    for (i = 0; i < s.n; i++) worst = fmax(worst, fabs(d[i] - s.xyz[3 * i + 1] - 0.5));
    CHECK_MSG(worst <= 1e-9, "rim of %d x %d, way %d: off by %g, %d stages", (int)around, (int)rows, way, worst, (int)rep.n_stages);
    hd_geodesic_free(g);
}

/* A source with heat held at zero along the border of a strip that needs stages: distances go on past the first. */
static void gall_strip(void) {
    shape s = kit_own_shape(shape_grid(1500, 9, 0));
    const int32_t source = 4 * 1500;
    double *d = KIT_NEW(double, s.n), least;
    int32_t i;
    int b;
    for (b = 0; b < 3; b++) {
        hd_geodesic_opts o = gall_options();
        hd_geodesic_report rep;
        hd_geodesic *g;
        const int32_t from = source + (b == 2 ? 700 : 0);    /* not on the border that is held */
        o.border = (hd_geodesic_border)b;
        g = gall_triangles(&s, &o);
        CHECK(hd_geodesic_distance(g, VERTICES(1, &from), d, 0, &rep, NULL) == HD_OK && rep.n_stages > 1);
        for (i = 1, least = 1; i < 800; i++) least = fmin(least, (d[from + i] - d[from + i - 1]) * 1499);
        /* between borders at zero heat flows to the sides rather than along */
        CHECK_MSG(least > (b < 2 ? 0.7 : 0.3) && d[from + 799] < 800 / 1499.0, "border %d: a step of %g, %g after 799", b, least, d[from + 799]);
        hd_geodesic_free(g);
    }
}

/* ---- points ---- */

static void gall_coincident(void) {
    shape s = kit_own_shape(shape_points(300, shape_on_sphere, 12.566370614359172, 1, 9));
    double *xyz = KIT_NEW(double, 3 * (s.n + 2)), *d = KIT_NEW(double, s.n + 2), *want = KIT_NEW(double, s.n);
    const int32_t source = 7, twin = s.n, three[3] = {twin, 100, 200};
    hd_geodesic *g = gall_points(s.xyz, s.n, NULL);
    hd_geodesic_opts o = gall_options();
    hd_error e;
    CHECK(hd_geodesic_distance(g, VERTICES(1, &source), want, 0, NULL, NULL) == HD_OK && want[7] == 0);
    hd_geodesic_free(g);
    memcpy(xyz, s.xyz, 3 * (size_t)s.n * sizeof *xyz);
    memcpy(xyz + 3 * s.n, s.xyz + 3 * 7, 3 * sizeof *xyz);
    memcpy(xyz + 3 * s.n + 3, s.xyz + 3 * 100, 3 * sizeof *xyz);
    g = gall_points(xyz, s.n + 2, NULL);
    CHECK(hd_geodesic_distance(g, VERTICES(1, &twin), d, 0, NULL, NULL) == HD_OK && d[7] == 0 && d[twin] == 0 && d[twin + 1] == d[100]);
    CHECK(geo_difference(d, want, s.n) < 1e-10);
    CHECK(hd_geodesic_distance(g, TOGETHER(3, three), d, 0, NULL, NULL) == HD_OK);    /* neither twin need be named first, or both */
    CHECK_MSG(d[7] == 0 && d[twin] == 0 && d[100] == 0 && d[twin + 1] == 0 && d[200] == 0, "twins at %g, %g", d[7], d[twin + 1]);
    hd_geodesic_free(g);
    o.border = HD_GEODESIC_BORDER_MEAN;
    CHECK(at_tufted_geodesic(&g, s.xyz, s.n, &o, &e) == HD_ERR_ARGUMENT && strstr(e.text, "border"));
    CHECK(at_tufted_geodesic(&g, s.xyz, 2, NULL, &e) == HD_ERR_EMPTY);
    CHECK(at_tufted_geodesic(&g, s.xyz, -1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(at_tufted_geodesic(&g, NULL, 3, NULL, &e) == HD_ERR_ARGUMENT);
}

/* ---- options, threads, failures ---- */

static void gall_errors(void) {
    shape s = kit_own_shape(shape_icosphere(1));
    shape_poly p = kit_own_poly(shape_quad_sphere(3));
    hd_geodesic *g = geo_mark;
    hd_geodesic_opts o;
    hd_error e;
    int64_t ptr[3] = {0, 4, 3};
#define GALL_BAD(field, value, kind)                                                                                                \
    o = gall_options();                                                                                                             \
    o.field = value;                                                                                                                \
    CHECK(((kind) == 0 ? hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e)                                                 \
           : (kind) == 1 ? hd_geodesic_create(&g, MESH_POLYGONS(p.xyz, p.n, p.face_ptr, p.face_idx, p.n_faces), &o, &e)                   \
                         : at_tufted_geodesic(&g, s.xyz, s.n, &o, &e)) == HD_ERR_ARGUMENT && e.text[0] && g == geo_mark)
    GALL_BAD(border, (hd_geodesic_border)3, 0);
    GALL_BAD(border, (hd_geodesic_border)-1, 1);
    GALL_BAD(mollify, 2, 0);
    GALL_BAD(mollify, NAN, 2);
    GALL_BAD(stiffening, -1, 1);
    GALL_BAD(stiffening, HUGE_VAL, 1);
    GALL_BAD(neighbours, 5, 2);
    GALL_BAD(neighbours, 129, 2);
    GALL_BAD(mass, HD_GEODESIC_MASS_VORONOI, 1);
    GALL_BAD(updatable, 1, 1);
    GALL_BAD(updatable, 1, 2);
    GALL_BAD(t, -1, 1);
    GALL_BAD(t, NAN, 2);
    GALL_BAD(t_in_h2, -1, 0);
    GALL_BAD(t_in_h2, HUGE_VAL, 1);
    o = gall_options();
    o.updatable = o.triangulation = HD_TRIANGULATION_TUFTED;
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e) == HD_ERR_ARGUMENT && strstr(e.text, "updatable"));
    CHECK(hd_geodesic_create(&g, MESH_POLYGONS(p.xyz, p.n, NULL, p.face_idx, p.n_faces), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_create(&g, MESH_POLYGONS(p.xyz, p.n, ptr, p.face_idx, 2), NULL, &e) == HD_ERR_STRUCTURE && e.face == 1);
    CHECK(hd_geodesic_create(&g, MESH_POLYGONS(p.xyz, 5, p.face_ptr, p.face_idx, p.n_faces), NULL, &e) == HD_ERR_INDEX && e.face >= 0);
    CHECK(hd_geodesic_create(&g, MESH_POLYGONS(p.xyz, p.n, p.face_ptr, p.face_idx, 0), NULL, &e) == HD_ERR_EMPTY);
    CHECK(g == geo_mark);
}

static void gall_thread_run(const shape_poly *s, hd_simd simd, int way, double *out) {
    static const int32_t sources[11] = {1, 4, 600, 7, 300, 520, 20, 390, 22, 60, 450};
    ldl_way *w = KIT_NEW(ldl_way, 1);
    hd_geodesic_opts o = gall_options();
    hd_geodesic *g;
    int k;
    ldl_way_begin(w, way, simd);
    o.context = &w->ctx;
    for (k = 0; k < 3; k++) {
        o.triangulation = k == 1 ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
        o.border = k == 1 ? HD_GEODESIC_BORDER_MEAN : HD_GEODESIC_BORDER_NATURAL;
        g = k < 2 ? gall_polygons(s, &o) : gall_points(s->xyz, s->n, &o);
        CHECK(hd_geodesic_distance(g, TOGETHER(3, sources), out, 0, NULL, NULL) == HD_OK);
        CHECK(hd_geodesic_distance(g, VERTICES(11, sources), out + s->n, 0, NULL, NULL) == HD_OK);
        out += 12 * s->n;
        hd_geodesic_free(g);
    }
    ldl_way_end(w, way);
}

/* The same bits with any number of threads, and nearly the same with any instructions. */
static void gall_threads(void) {
    shape_poly s = kit_own_poly(shape_quad_sphere(12));
    const int64_t size = 36 * (int64_t)s.n;
    double *first = KIT_NEW(double, size), *other = KIT_NEW(double, size), *top = KIT_NEW(double, size);
    int level, way;
    for (level = 0; level < 4; level++) {
        gall_thread_run(&s, ldl_simds[level], 0, first);
        if (level == 0) memcpy(top, first, (size_t)size * sizeof *top);
        CHECK_MSG(geo_difference(first, top, size) < 1e-9, "level %d is off by %g", level, geo_difference(first, top, size));
        for (way = 1; way < LDL_WAYS; way += 2) {
            gall_thread_run(&s, ldl_simds[level], way, other);
            CHECK_MSG(memcmp(first, other, (size_t)size * sizeof *first) == 0, "way %d of threading gives other bits, level %d", way, level);
        }
    }
}

/* Two squares of four cells: a component without a source has no heat, and that is no reason for stages. Each plan holds its context. */
static void gall_cold(void) {
    shape_poly p = kit_own_poly(shape_poly_make(18, 8, 32));
    hd_geodesic_opts o = gall_options();
    hd_geodesic_report rep;
    hd_context ctx;
    hd_geodesic *g;
    double d[18];
    const int32_t source = 4, both[2] = {4, 13};
    uint64_t made[4];
    int32_t i, f;
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    for (i = 0; i < 18; i++) {
        p.xyz[3 * i] = i % 3 + i / 9 * 10;
        p.xyz[3 * i + 1] = i % 9 / 3;
        p.xyz[3 * i + 2] = 0;
    }
    for (f = 0; f < 8; f++) {
        const int32_t v = f / 4 * 9 + f % 4 / 2 * 3 + f % 2;
        const int32_t corner[4] = {v, v + 1, v + 4, v + 3};
        shape_put_face(&p, 4, corner);
    }
    g = gall_polygons(&p, &o);
    CHECK(ctx.n_holders == 1);
    CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, &rep, NULL) == HD_OK);
    CHECK_MSG(rep.n_stages == 1 && d[4] == 0 && d[0] > 1 && d[0] < 2 && d[13] == HUGE_VAL, "%d stages, %g, %g", (int)rep.n_stages, d[0], d[13]);
    for (i = 0; i < 4; i++) {                    /* warm in both components or one: as many allocations when asked again */
        const uint64_t before = ctx.allocations;
        CHECK(hd_geodesic_distance(g, TOGETHER(2 - i % 2, both), d, 0, NULL, NULL) == HD_OK);
        made[i] = ctx.allocations - before;
    }
    CHECK_MSG(made[0] == made[2] && made[1] == made[3], "%d and %d allocations with two sources, %d and %d with one", (int)made[0], (int)made[2],
              (int)made[1], (int)made[3]);
    hd_geodesic_free(g);
    CHECK(ctx.n_holders == 0 && ctx.bytes_in_use == 0);
}

/* Rings of cells that double in size, small ones listed beside large ones: what is flat is so beside its own face. */
static void gall_face_orders(void) {
    enum { RINGS = 25, AROUND = 8 };
    double d[2][(RINGS + 1) * AROUND];
    const int32_t source = 0;
    int32_t i, r, way;
    for (way = 0; way < 2; way++) {
        shape_poly p = kit_own_poly(shape_poly_make((RINGS + 1) * AROUND, RINGS * AROUND, 4 * RINGS * AROUND));
        hd_geodesic *g;
        for (i = 0; i < p.n; i++) {
            p.xyz[3 * i] = ldexp(cos(i % AROUND * 6.283185307179586 / AROUND), i / AROUND);
            p.xyz[3 * i + 1] = ldexp(sin(i % AROUND * 6.283185307179586 / AROUND), i / AROUND);
            p.xyz[3 * i + 2] = 0;
        }
        for (i = 0; i < RINGS; i++) {
            const int32_t ring = way == 0 ? i : i % 2 ? RINGS - 1 - i / 2 : i / 2;
            for (r = 0; r < 2 * AROUND; r++) {   /* every other ring goes in between */
                const int32_t v = ring * AROUND + r / 2, w = ring * AROUND + (r / 2 + 1) % AROUND;
                const int32_t corner[4] = {v, w, w + AROUND, v + AROUND};
                const int32_t other = RINGS - 1 - ring, v2 = other * AROUND + r / 2, w2 = other * AROUND + (r / 2 + 1) % AROUND;
                const int32_t corner2[4] = {v2, w2, w2 + AROUND, v2 + AROUND};
                if (way == 0 && r % 2 == 0) shape_put_face(&p, 4, corner);
                if (way == 1 && ring < other && r % 2 == 0) shape_put_face(&p, 4, corner);
                if (way == 1 && ring < other && r % 2 == 1) shape_put_face(&p, 4, corner2);
                if (way == 1 && ring == other && r % 2 == 0) shape_put_face(&p, 4, corner);
            }
        }
        CHECK(p.n_faces == RINGS * AROUND);
        g = gall_polygons(&p, NULL);
        CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d[way], 0, NULL, NULL) == HD_OK);
        hd_geodesic_free(g);
    }
    for (i = 0; i < (RINGS + 1) * AROUND; i++) CHECK_MSG(fabs(d[0][i] - d[1][i]) <= 1e-3 * d[0][i], "vertex %d: %g, %g", (int)i, d[0][i], d[1][i]);
}

static void test_geodesic_all(void) {
    gall_cold();
    gall_face_orders();
    test_geodesic();
    gall_against_dense(shape_trominoes(3, 3, 0.25), 24, "trominoes");
    gall_against_dense(poly_mixed(), 7, "mixed");
    gall_against_dense(gall_tube(9, 8, 0.2), 20, "tube");
    gall_equal();
    gall_slivers();
    gall_accuracy();
    gall_many();
    gall_borders();
    gall_rim(5, 900, 1, 0);
    gall_rim(3, 5000, 100, 0);
    gall_rim(5, 900, 1, 1);
    gall_rim(5, 900, 1, 2);
    gall_strip();
    gall_coincident();
    gall_errors();
    gall_threads();
}

#endif
