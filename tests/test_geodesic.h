/* test_geodesic.h - geodesic distance by the heat method: against a dense computation of the same definition by other formulas, against distances known exactly,
 * and the properties that distances have */

#ifndef TEST_GEODESIC_H
#define TEST_GEODESIC_H

/* ---- the oracle: the definition, in three dimensions and dense ---- */

/* Angles' cotangents, normals, gradients as the paper writes them; L made definite by adding constants of each component, not by taking rows out. */
typedef struct geo_dense {
    const shape *s;
    double h, t, *A, *L;        /* [n n] Cholesky factors of B + t L and of L + the constants, vertices without faces like identity */
    int32_t *component;         /* [n] smallest vertex; -1 in no face */
} geo_dense;

static void geo_minus(const double *a, const double *b, double *out) {
    int c;
    for (c = 0; c < 3; c++) out[c] = a[c] - b[c];
}

static void geo_cross(const double *a, const double *b, double *out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Cotangents, area, unit normal of face f. */
static double geo_face(const shape *s, int32_t f, double cot[3], double normal[3]) {
    const int32_t *v = s->tri + 3 * f;
    double a[3], b[3], twice = 0;
    int q, c;
    for (q = 0; q < 3; q++) {
        geo_minus(s->xyz + 3 * v[(q + 1) % 3], s->xyz + 3 * v[q], a);
        geo_minus(s->xyz + 3 * v[(q + 2) % 3], s->xyz + 3 * v[q], b);
        geo_cross(a, b, normal);
        twice = sqrt(shape_dot(normal, normal));
        cot[q] = shape_dot(a, b) / twice;
    }
    for (c = 0; c < 3; c++) normal[c] /= twice;
    return twice / 2;
}

/* Mixed area of corner q (Meyer et al.), or a third. */
static double geo_corner_mass(const shape *s, int32_t f, int q, hd_geodesic_mass mass) {
    const int32_t *v = s->tri + 3 * f;
    double cot[3], normal[3], area = geo_face(s, f, cot, normal), b, c;
    if (mass == HD_GEODESIC_MASS_BARYCENTRIC) return area / 3;
    if (cot[0] < 0 || cot[1] < 0 || cot[2] < 0) return cot[q] < 0 ? area / 2 : area / 4;
    b = shape_distance(s->xyz + 3 * v[q], s->xyz + 3 * v[(q + 1) % 3]);
    c = shape_distance(s->xyz + 3 * v[q], s->xyz + 3 * v[(q + 2) % 3]);
    return (b * b * cot[(q + 2) % 3] + c * c * cot[(q + 1) % 3]) / 8;
}

static double geo_mean_edge(const shape *s) {
    char *seen = KIT_NEW(char, (int64_t)s->n * s->n);
    double sum = 0;
    int64_t count = 0;
    int32_t f;
    int q;
    for (f = 0; f < s->n_tri; f++) {
        for (q = 0; q < 3; q++) {
            const int64_t a = s->tri[3 * f + q], b = s->tri[3 * f + (q + 1) % 3];
            if (seen[a * s->n + b]) continue;
            seen[a * s->n + b] = seen[b * s->n + a] = 1;
            sum += shape_distance(s->xyz + 3 * a, s->xyz + 3 * b);
            count++;
        }
    }
    return sum / (double)count;
}

/* t 0: h^2. */
static geo_dense geo_dense_make(const shape *s, double t, hd_geodesic_mass mass) {
    const size_t n = (size_t)s->n;
    geo_dense g;
    int32_t i, f, changed = 1;
    int q;
    g.s = s;
    g.h = geo_mean_edge(s);
    g.t = t > 0 ? t : g.h * g.h;
    g.A = DENSE_NEW(double, n * n);
    g.L = DENSE_NEW(double, n * n);
    g.component = DENSE_NEW(int32_t, n);
    for (i = 0; i < s->n; i++) g.component[i] = -1;
    for (f = 0; f < 3 * s->n_tri; f++) g.component[s->tri[f]] = s->tri[f];
    while (changed) {
        for (changed = 0, f = 0; f < 3 * s->n_tri; f++) {
            const int32_t a = s->tri[f], b = s->tri[f - f % 3 + (f + 1) % 3];
            const int32_t least = g.component[a] < g.component[b] ? g.component[a] : g.component[b];
            changed |= g.component[a] != least || g.component[b] != least;
            g.component[a] = g.component[b] = least;
        }
    }
    for (f = 0; f < s->n_tri; f++) {
        double cot[3], normal[3];
        geo_face(s, f, cot, normal);
        for (q = 0; q < 3; q++) {
            const size_t a = (size_t)s->tri[3 * f + q], b = (size_t)s->tri[3 * f + (q + 1) % 3];
            const double w = cot[(q + 2) % 3] / 2;
            g.A[a * n + a] += geo_corner_mass(s, f, q, mass);
            g.L[a * n + b] -= w;
            g.L[b * n + a] -= w;
            g.L[a * n + a] += w;
            g.L[b * n + b] += w;
        }
    }
    for (i = 0; i < s->n * s->n; i++) {
        const int32_t a = i / s->n, b = i % s->n;
        g.A[i] += g.t * g.L[i];
        if (g.component[a] == g.component[b] && g.component[a] >= 0) g.L[i] += 1.0 / s->n;
        if (a == b && g.component[a] < 0) g.A[i] = g.L[i] = 1;
    }
    CHECK(dense_cholesky(g.A, s->n) && dense_cholesky(g.L, s->n));
    return g;
}

static void geo_dense_free(geo_dense *g) {
    free(g->A);
    free(g->L);
    free(g->component);
}

/* div of the unit field down u, by the paper's formulas. */
static void geo_dense_divergence(const shape *s, const double *u, double *b) {
    int32_t i, f;
    int q, c;
    for (i = 0; i < s->n; i++) b[i] = 0;
    for (f = 0; f < s->n_tri; f++) {
        const int32_t *v = s->tri + 3 * f;
        double cot[3], normal[3], X[3] = {0, 0, 0}, e1[3], e2[3], norm, longest = 0, most = 0;
        geo_face(s, f, cot, normal);
        for (q = 0; q < 3; q++) {                /* sum of u_q (N x opposite edge) */
            double edge[3], turned[3];
            geo_minus(s->xyz + 3 * v[(q + 2) % 3], s->xyz + 3 * v[(q + 1) % 3], edge);
            geo_cross(normal, edge, turned);
            for (c = 0; c < 3; c++) X[c] -= fabs(u[v[q]]) * turned[c];
            longest = fmax(longest, sqrt(shape_dot(edge, edge)));
            most = fmax(most, fabs(u[v[q]]));
        }
        norm = sqrt(shape_dot(X, X));            /* a slope of rounding is none */
        for (c = 0; c < 3; c++) X[c] = norm > 1e-13 * longest * most ? X[c] / norm : 0;
        for (q = 0; q < 3; q++) {
            geo_minus(s->xyz + 3 * v[(q + 1) % 3], s->xyz + 3 * v[q], e1);
            geo_minus(s->xyz + 3 * v[(q + 2) % 3], s->xyz + 3 * v[q], e2);
            b[v[q]] += (cot[(q + 2) % 3] * shape_dot(e1, X) + cot[(q + 1) % 3] * shape_dot(e2, X)) / 2;
        }
    }
}

/* Distances from phi: that of each source counts where its heat is. A [n n] Cholesky factor of the heat equation, or NULL: v is given. u: heat. held as there. */
static void geo_dense_from(const double *A, const double *u, double *v, const double *phi, const int32_t *component, const int32_t *sources, int32_t k, int32_t n, double *d) {
    double *least = KIT_NEW(double, n), *most = KIT_NEW(double, n);
    int32_t i, q;
    for (i = 0; i < n; i++) least[i] = HUGE_VAL;
    for (i = 0; i < n; i++) most[i] = -HUGE_VAL;
    for (q = 0; q < k; q++) {
        const int32_t c = component[sources[q]];
        if (c < 0) continue;
        least[c] = fmin(least[c], phi[sources[q]]);
        most[c] = fmax(most[c], phi[sources[q]]);
    }
    if (A) {
        for (i = 0; i < n; i++) v[i] = 0;
        for (q = 0; q < k; q++)
            if (component[sources[q]] >= 0) v[sources[q]] = phi[sources[q]] - least[component[sources[q]]];
        dense_forward(A, v, n);
        dense_backward(A, v, n);
    }
    TRAPS_OFF;                                   /* 0/0 in components without a source */
    for (i = 0; i < n; i++) {
        const int32_t c = component[i];
        d[i] = HUGE_VAL;
        if (c >= 0 && least[c] < HUGE_VAL) d[i] = fabs(phi[i] - least[c] - fmin(fmax(v[i] / u[i], 0), most[c] - least[c]));
    }
    TRAPS_ON;
    for (q = 0; q < k; q++) d[sources[q]] = 0;
}

static void geo_dense_distance(const geo_dense *g, const int32_t *sources, int32_t k, double *d) {
    const shape *s = g->s;
    double *u = KIT_NEW(double, s->n), *phi = KIT_NEW(double, s->n), *v = KIT_NEW(double, s->n);
    int32_t q;
    for (q = 0; q < k; q++) u[sources[q]] = 1;
    dense_forward(g->A, u, s->n);
    dense_backward(g->A, u, s->n);
    geo_dense_divergence(s, u, phi);
    dense_forward(g->L, phi, s->n);
    dense_backward(g->L, phi, s->n);
    geo_dense_from(g->A, u, v, phi, g->component, sources, k, s->n, d);
}

/* ---- short forms ---- */

static hd_geodesic *geo_plan(const shape *s, double t, hd_geodesic_mass mass, hd_context *ctx) {
    hd_geodesic_opts o;
    hd_geodesic *g = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.t = t;
    o.mass = mass;
    o.context = ctx;
    CHECK_MSG(hd_geodesic_create(&g, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e) == HD_OK, "%s", e.text);
    return g;
}

static double *geo_of(const shape *s, double t, const int32_t *sources, int32_t k) {
    hd_geodesic *g = geo_plan(s, t, HD_GEODESIC_MASS_BARYCENTRIC, NULL);
    double *d = DENSE_NEW(double, s->n);
    CHECK(hd_geodesic_distance(g, TOGETHER(k, sources), d, 0, NULL, NULL) == HD_OK);
    hd_geodesic_free(g);
    return d;
}

/* Largest |a - b|, both infinite counting as equal. */
static double geo_difference(const double *a, const double *b, int64_t n) {
    double worst = 0;
    int64_t i;
    for (i = 0; i < n; i++)
        if (a[i] != b[i] && !(fabs(a[i] - b[i]) <= worst)) worst = fabs(a[i] - b[i]);
    return worst;
}

static double geo_largest(const double *d, int64_t n) {
    double most = 0;
    int64_t i;
    for (i = 0; i < n; i++)
        if (d[i] < HUGE_VAL && d[i] > most) most = d[i];
    return most;
}

static void geo_rotate(double *p, double scale) {
    const double c = 0.6, s = 0.8, x = p[0], y = c * p[1] - s * p[2], z = s * p[1] + c * p[2];
    p[0] = scale * (c * x - s * y + 0.7);
    p[1] = scale * (s * x + c * y - 1.2);
    p[2] = scale * (z + 0.3);
}

/* A tent of long obtuse triangles: the grid sheared far. */
static shape geo_sheared(int32_t nx, int32_t ny, double shear) {
    shape s = shape_grid(nx, ny, 0.2);
    int32_t i;
    for (i = 0; i < s.n; i++) {
        s.xyz[3 * i] += shear * s.xyz[3 * i + 1];
        s.xyz[3 * i + 2] = 0.3 * fabs(s.xyz[3 * i] - 1);
    }
    return s;
}

static shape geo_two(void) {
    const double offset[3] = {4, 0.3, 0};
    shape a = kit_own_shape(shape_bumpy(2, 3)), b = kit_own_shape(shape_torus(11, 7, 1, 0.4)), s = shape_disjoint(&a, &b, offset);
    return s;
}

/* ---- against the oracle ---- */

static void geo_against_dense(shape s, const char *what) {
    static const double times[5] = {0, 0.2, 10, 300, 1e6};
    const double hh = geo_mean_edge(&s) * geo_mean_edge(&s);
    double *d = KIT_NEW(double, 8 * s.n), *want = KIT_NEW(double, 8 * s.n);
    int k, mass;
    for (k = 0; k < 5; k++) {
        for (mass = 0; mass < 2; mass++) {
            geo_dense oracle = geo_dense_make(&s, times[k] * hh, (hd_geodesic_mass)mass);
            hd_geodesic *g = geo_plan(&s, times[k] * hh, (hd_geodesic_mass)mass, NULL);
            const int32_t sources[8] = {s.n / 3, 0, s.n - 1, s.n / 2, 1, s.n / 2, 7, s.n - 2};
            hd_geodesic_report rep;
            const double tol = times[k] > 1e3 ? 1e-7 : 1e-9;      /* u is flat: its slopes are differences of nearly equal numbers */
            int32_t q, n_sources;
            for (n_sources = 1; n_sources <= 8; n_sources += 7) {
                geo_dense_distance(&oracle, sources, n_sources, want);
                CHECK(hd_geodesic_distance(g, TOGETHER(n_sources, sources), d, 0, &rep, NULL) == HD_OK);
                CHECK_MSG(geo_difference(d, want, s.n) <= tol * geo_largest(want, s.n), "%s, t %g h2, mass %d, %d sources: off by %g", what, times[k], mass,
                          (int)n_sources, geo_difference(d, want, s.n) / geo_largest(want, s.n));
                CHECK_MSG(rep.residual_heat < (times[k] > 100 ? 1e-7 : 1e-13) && rep.residual_distance < 1e-11, "%s: residuals %g %g", what, rep.residual_heat, rep.residual_distance);
            }
            CHECK_MSG(fabs(rep.h - oracle.h) <= 1e-13 * oracle.h && fabs(rep.t - oracle.t) <= 1e-12 * oracle.t && rep.n_stages == 1 && rep.factor_nnz >= s.n / 2,
                      "%s: report", what);
            for (q = 0; q < 8; q++) geo_dense_distance(&oracle, sources + q, 1, want + q * s.n);
            CHECK(hd_geodesic_distance(g, VERTICES(8, sources), d, 0, &rep, NULL) == HD_OK && rep.n_stages == 1 &&
                rep.residual_distance > 0 && rep.residual_distance < 1e-11);
            CHECK_MSG(geo_difference(d, want, 8 * s.n) <= tol * geo_largest(want, 8 * s.n), "%s, t %g h2, mass %d: eight columns off by %g", what, times[k], mass,
                      geo_difference(d, want, 8 * s.n) / geo_largest(want, 8 * s.n));
            hd_geodesic_free(g);
            geo_dense_free(&oracle);
        }
    }
    shape_free(&s);
}

/* ---- exact distances ---- */

/* Heat from one end of a tube, all of its rim: u depends on the height alone, so that the method is exact, however far u falls. tau: t over the squared height of a
 * row. */
static void geo_tube(int32_t around, int32_t rows, double tau, int32_t n_stages) {
    const double row = 1.0 / (rows - 1);
    shape s = kit_own_shape(shape_cylinder(around, rows, row * around / 6, 1));
    hd_geodesic *g = geo_plan(&s, tau * row * row, HD_GEODESIC_MASS_BARYCENTRIC, NULL);
    double *d = KIT_NEW(double, s.n), worst = 0;
    int32_t *sources = KIT_NEW(int32_t, around), i;
    hd_geodesic_report rep;
    for (i = 0; i < around; i++) sources[i] = i * rows;
    CHECK(hd_geodesic_distance(g, TOGETHER(around, sources), d, 0, &rep, NULL) == HD_OK);
    for (i = 0; i < s.n; i++) worst = fmax(worst, fabs(d[i] - s.xyz[3 * i + 1] - 0.5));
    CHECK_MSG(worst <= 1e-9, "tube of %d x %d, t %g rows: off by %g, %d stages", (int)around, (int)rows, tau, worst, (int)rep.n_stages);
    CHECK_MSG(rep.n_stages == n_stages, "tube of %d rows: %d stages", (int)rows, (int)rep.n_stages);
    hd_geodesic_free(g);
}

/* Straight lines in the plane and great circles on the sphere are approached. most: bounds on the largest error, level by level. */
static void geo_refine(int ball, const double *most, int levels) {
    double before = 1e30;
    int k;
    for (k = 0; k < levels; k++) {
        const int32_t nx = (8 << k) + 1;
        shape s = ball ? shape_icosphere(k + 2) : shape_grid(nx, nx, 0.25);
        const int32_t source = ball ? 5 : nx * (nx / 2) + nx / 2;
        double *d = geo_of(&s, 0, &source, 1), worst = 0;
        int32_t i;
        for (i = 0; i < s.n; i++) {
            const double chord = shape_distance(s.xyz + 3 * i, s.xyz + 3 * source);
            worst = fmax(worst, fabs(d[i] - (ball ? 2 * asin(fmin(1, chord / 2)) : chord)));
        }
        CHECK_MSG(worst <= most[k] && worst < 0.85 * before, "%s, level %d: error %g after %g", ball ? "sphere" : "plane", k, worst, before);
        before = worst;
        free(d);
        shape_free(&s);
    }
}

/* A jittered strip of many stages: every step along it is a step of about its length. */
static void geo_long(void) {
    shape s = kit_own_shape(shape_grid(4000, 4, 0.25));
    const int32_t source = 2 * 4000;
    hd_geodesic *g = geo_plan(&s, 0, HD_GEODESIC_MASS_BARYCENTRIC, NULL);
    double *d = KIT_NEW(double, 4 * s.n), worst = 0;
    const int32_t four[4] = {source, source + 3999, source + 1700, 5};
    hd_geodesic_report rep;
    int32_t i;
    CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, &rep, NULL) == HD_OK);
    CHECK_MSG(rep.n_stages >= 6 && rep.n_stages < 14, "%d stages", (int)rep.n_stages);
    for (i = 1; i < 4000; i++) worst = fmax(worst, fabs((d[source + i] - d[source + i - 1]) / (s.xyz[3 * (source + i)] - s.xyz[3 * (source + i) - 3]) - 1));
    CHECK_MSG(worst < 0.3, "a step is off by %g", worst);
    CHECK_MSG(fabs(d[source + 3999] - 1) < 0.01, "the other end is at %g", d[source + 3999]);
    for (i = 0; i < 4; i++) CHECK(hd_geodesic_distance(g, VERTICES(1, four + i), d + i * s.n, 0, NULL, NULL) == HD_OK);
    {
        double *wide = KIT_NEW(double, 4 * s.n);
        CHECK(hd_geodesic_distance(g, VERTICES(4, four), wide, 0, &rep, NULL) == HD_OK && rep.n_stages >= 6);
        CHECK(memcmp(wide, d, 4 * (size_t)s.n * sizeof *d) == 0);      /* all are done again alone */
    }
    hd_geodesic_free(g);
}

/* Stages on a strip so long that each sees little of it, however high the tree. */
static void geo_strip(hd_ordering ordering) {
    shape s = kit_own_shape(shape_grid(10001, 2, 0.2));
    const int32_t source = 3000;
    double *d = KIT_NEW(double, s.n), worst = 0;
    hd_geodesic *g = NULL;
    hd_geodesic_opts o;
    hd_geodesic_report rep;
    int32_t i;
    memset(&o, 0, sizeof o);
    o.ordering = ordering;
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, NULL) == HD_OK);
    CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, &rep, NULL) == HD_OK && rep.n_stages >= 12);
    for (i = 0; i < 10001; i++) worst = fmax(worst, fabs(d[i] - fabs(s.xyz[3 * i] - s.xyz[3 * source])));
    CHECK_MSG(worst < 0.01, "off by %g", worst);
    hd_geodesic_free(g);
}

/* What a stage leaves out is nothing: the same in orders whose trees have nothing in common. */
static void geo_stages_ordered(shape s, int32_t source, double t) {
    double *want = KIT_NEW(double, s.n), *d = KIT_NEW(double, s.n);
    int32_t *perm = KIT_NEW(int32_t, s.n), i;
    hd_geodesic *g = NULL;
    hd_geodesic_opts o;
    hd_geodesic_report rep;
    memset(&o, 0, sizeof o);
    o.t = t;
    o.perm = perm;
    for (i = 0; i < s.n; i++) perm[i] = (source + i) % s.n;
    for (i = HD_ORDERING_MINIMUM_DEGREE; i <= HD_ORDERING_OWN; i++) {
        o.ordering = (hd_ordering)i;
        CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, NULL) == HD_OK);
        CHECK(hd_geodesic_distance(g, VERTICES(1, &source), i == HD_ORDERING_MINIMUM_DEGREE ? want : d, 0, &rep, NULL) == HD_OK);
        CHECK_MSG(rep.n_stages > 3, "%d stages", (int)rep.n_stages);
        if (i > HD_ORDERING_MINIMUM_DEGREE) {
            const double off = geo_difference(d, want, s.n) / geo_largest(want, s.n);
            CHECK_MSG(off < 1e-10, "order %d, t %g: off by %g", (int)i, t, off);
        }
        hd_geodesic_free(g);
    }
    shape_free(&s);
}

/* ---- properties ---- */

static void geo_moved(void) {
    static const double scales[5] = {1, 1e-3, 1e-45, 250, 1e45};
    shape s = kit_own_shape(shape_bumpy(3, 8)), r;
    const int32_t sources[2] = {17, 400};
    double *want = geo_of(&s, 0, sources, 2), *d, worst;
    int32_t i;
    int k;
    for (k = 0; k < 5; k++) {
        r = kit_own_shape(shape_make(s.n, s.n_tri));
        memcpy(r.tri, s.tri, 3 * (size_t)s.n_tri * sizeof *s.tri);
        memcpy(r.xyz, s.xyz, 3 * (size_t)s.n * sizeof *s.xyz);
        for (i = 0; i < r.n; i++) geo_rotate(r.xyz + 3 * i, scales[k]);
        d = geo_of(&r, 0, sources, 2);
        for (worst = 0, i = 0; i < s.n; i++) worst = fmax(worst, fabs(d[i] / scales[k] - want[i]));
        CHECK_MSG(worst < 1e-9, "moved, scale %g: off by %g", scales[k], worst);
        free(d);
    }
    free(want);
}

/* Vertices and faces renumbered, corners turned, some faces turned over, faces given twice, faces without area. */
static void geo_renumbered(void) {
    shape s = kit_own_shape(geo_two()), r = kit_own_shape(shape_make(s.n + 3, s.n_tri + 4));
    int32_t *perm = KIT_NEW(int32_t, s.n), *face = KIT_NEW(int32_t, s.n_tri), sources[2] = {40, 200}, moved[2], i;
    uint64_t seed = 5;
    double *want = geo_of(&s, 0, sources, 2), *d, worst = 0;
    int q;
    dense_shuffle(perm, s.n, &seed);
    dense_shuffle(face, s.n_tri, &seed);
    for (i = 0; i < s.n; i++) memcpy(r.xyz + 3 * perm[i], s.xyz + 3 * i, 3 * sizeof(double));
    for (i = 0; i < s.n_tri; i++)
        for (q = 0; q < 3; q++) r.tri[3 * face[i] + (i % 5 ? q + i : 3 * i + 3 - q) % 3] = perm[s.tri[3 * i + q]];
    memcpy(r.tri + 3 * s.n_tri, r.tri + 9, 6 * sizeof *r.tri);             /* again */
    for (q = 0; q < 3; q++) r.tri[3 * s.n_tri + 6 + q] = r.tri[q % 2];     /* a corner twice */
    for (q = 0; q < 3; q++) r.tri[3 * s.n_tri + 9 + q] = s.n + q;          /* three vertices in one place */
    for (q = 0; q < 9; q++) r.xyz[3 * s.n + q] = 2;
    for (q = 0; q < 2; q++) moved[q] = perm[sources[q]];
    d = geo_of(&r, 0, moved, 2);
    for (i = 0; i < s.n; i++) worst = fmax(worst, fabs(d[perm[i]] - want[i]));
    CHECK_MSG(worst < 1e-9, "renumbered: off by %g", worst);
    for (q = 0; q < 3; q++) CHECK(d[s.n + q] == HUGE_VAL);
    free(want);
    free(d);
}

/* A torus turned by some of its steps is the same torus; a ball has a point opposite to each. */
static void geo_symmetric(void) {
    shape torus = kit_own_shape(shape_torus(24, 10, 1, 0.45)), ball = kit_own_shape(shape_icosphere(3));
    const int32_t a = 3, b = 7 * 10 + 3, c = 33;
    int32_t opposite = 0, i, j;
    double *x = geo_of(&torus, 0, &a, 1), *y = geo_of(&torus, 0, &b, 1), worst = 0, most = 0;
    for (i = 0; i < torus.n; i++) worst = fmax(worst, fabs(x[i] - y[(i + 70) % torus.n]));
    CHECK_MSG(worst < 1e-11, "torus: %g", worst);
    free(x);
    free(y);
    for (i = 0; i < ball.n; i++)
        if (shape_dot(ball.xyz + 3 * i, ball.xyz + 3 * c) < shape_dot(ball.xyz + 3 * opposite, ball.xyz + 3 * c)) opposite = i;
    x = geo_of(&ball, 0, &c, 1);
    y = geo_of(&ball, 0, &opposite, 1);
    for (worst = 0, i = 0; i < ball.n; i++) {
        for (j = 0; j < ball.n && !(fabs(ball.xyz[3 * i] + ball.xyz[3 * j]) + fabs(ball.xyz[3 * i + 1] + ball.xyz[3 * j + 1]) + fabs(ball.xyz[3 * i + 2] + ball.xyz[3 * j + 2]) < 1e-9);) j++;
        if (CHECK(j < ball.n)) worst = fmax(worst, fabs(x[i] - y[j]));
        most = fmax(most, x[i]);
    }
    CHECK_MSG(worst < 1e-10 && most == x[opposite], "ball: %g, farthest %g of %g", worst, x[opposite], most);
    free(x);
    free(y);
}

/* Components by themselves, vertices in no face, sources among them. */
static void geo_parts(void) {
    const double offset[3] = {4, 0.3, 0};
    shape a = kit_own_shape(shape_bumpy(2, 3)), b = kit_own_shape(shape_torus(11, 7, 1, 0.4)), s = kit_own_shape(shape_disjoint(&a, &b, offset)), r = kit_own_shape(shape_make(s.n + 2, s.n_tri));
    const double hh = 0.04;
    const int32_t first = 9, second = 50, both[3] = {9, a.n + 50, s.n}, lone = s.n + 1;
    double *da = geo_of(&a, hh, &first, 1), *db = geo_of(&b, hh, &second, 1), *d;
    int32_t i, n;
    memcpy(r.tri, s.tri, 3 * (size_t)s.n_tri * sizeof *s.tri);
    memcpy(r.xyz, s.xyz, 3 * (size_t)s.n * sizeof *s.xyz);
    for (i = 0; i < 6; i++) r.xyz[3 * s.n + i] = 1;
    for (n = 1; n <= 3; n++) {
        d = geo_of(&r, hh, both, n);
        CHECK(geo_difference(d, da, a.n) < 1e-11 * geo_largest(da, a.n));
        if (n == 1) for (i = a.n; i < r.n; i++) CHECK(d[i] == HUGE_VAL);
        else CHECK(geo_difference(d + a.n, db, b.n) < 1e-11 * geo_largest(db, b.n));
        CHECK((n == 3 ? d[s.n] == 0 : d[s.n] == HUGE_VAL) && d[s.n + 1] == HUGE_VAL && d[9] == 0);
        free(d);
    }
    d = geo_of(&r, hh, &lone, 1);
    for (i = 0; i < r.n; i++) CHECK(d[i] == (i == lone ? 0 : HUGE_VAL));
    free(d);
    {
        hd_geodesic *g = geo_plan(&r, hh, HD_GEODESIC_MASS_BARYCENTRIC, NULL);
        const int32_t columns[11] = {9, lone, a.n + 50, s.n, 9, 0, 1, 2, 3, r.n - 1, a.n};
        const size_t ld = (size_t)r.n + 5;
        hd_geodesic_report rep;
        double *all = KIT_NEW(double, 11 * ld), *one = KIT_NEW(double, r.n);
        int32_t k, q;
        for (k = 0; k <= 11; k++) {
            for (i = 0; i < (int32_t)(11 * ld); i++) all[i] = -7;
            CHECK(hd_geodesic_distance(g, VERTICES(k, columns), all, ld, &rep, NULL) == HD_OK && (k == 0 || rep.residual_distance > 0));
            for (q = 0; q < k; q++) {
                CHECK(hd_geodesic_distance(g, VERTICES(1, columns + q), one, 0, NULL, NULL) == HD_OK);
                CHECK_MSG(geo_difference(one, all + (size_t)q * ld, r.n) < 1e-12, "column %d of %d: off by %g", (int)q, (int)k, geo_difference(one, all + (size_t)q * ld, r.n));
                for (i = r.n; i < (int32_t)ld; i++) CHECK(all[(size_t)q * ld + (size_t)i] == -7);
            }
        }
        hd_geodesic_free(g);
    }
    free(da);
    free(db);
}

/* Slivers, needles, soups: whatever comes out are numbers, zero at the source, not negative. */
static void geo_ugly_of(shape s, const char *what, int finite) {
    static const double times[4] = {0, 1e-8, 1e8, 1e-90};
    const double hh = geo_mean_edge(&s) * geo_mean_edge(&s);
    const int32_t sources[4] = {s.n / 2, 0, s.n - 1, 3};
    double *d = KIT_NEW(double, 4 * s.n);
    int32_t i;
    int k;
    for (k = 0; k < 4; k++) {
        hd_geodesic *g = geo_plan(&s, times[k] * hh, HD_GEODESIC_MASS_BARYCENTRIC, NULL);
        hd_geodesic_report rep;
        hd_status st = hd_geodesic_distance(g, VERTICES(4, sources), d, 0, &rep, NULL);
        CHECK_MSG(st >= 0 || st == HD_ERR_BREAKDOWN, "%s: %s", what, rep.error.text);
        for (i = 0; st >= 0 && i < 4 * s.n; i++)
            if (!CHECK_MSG(d[i] >= 0 && (d[i] <= DBL_MAX || !finite), "%s, t %g h2: %g at %d", what, times[k], d[i], (int)i)) break;
        if (st >= 0) CHECK(d[sources[0]] == 0 && d[s.n] == 0 && d[4 * s.n - 1] >= 0);
        hd_geodesic_free(g);
    }
    shape_free(&s);
}

static shape geo_flattened(shape s, double factor) {
    int32_t i;
    for (i = 0; i < s.n; i++) s.xyz[3 * i + 1] *= factor;
    return s;
}

static void geo_ugly(void) {
    shape s;
    geo_ugly_of(geo_flattened(shape_grid(12, 9, 0.3), 1e-3), "flattened", 1);
    geo_ugly_of(geo_flattened(shape_grid(12, 9, 0.3), 1e-6), "slivers", 1);
    geo_ugly_of(geo_flattened(shape_grid(12, 9, 0.3), 1e-12), "thinner slivers", 1);
    geo_ugly_of(geo_flattened(shape_bumpy(2, 4), 1e-5), "a ball pressed flat", 1);
    geo_ugly_of(geo_sheared(10, 10, 30), "sheared far", 1);
    geo_ugly_of(trial_jumble(60, 150, 4), "soup", 0);
    s = shape_icosphere(2);
    memcpy(s.xyz + 3 * 20, s.xyz + 3 * 21, 3 * sizeof(double));      /* two vertices in one place: faces without area, needles beside them */
    s.xyz[3 * 40] += 1e-9;
    geo_ugly_of(s, "a vertex moved onto another", 1);
}

/* ---- plans ---- */

static void geo_plans(void) {
    shape s = kit_own_shape(shape_bumpy(3, 2));
    hd_geodesic *g = geo_plan(&s, 0, HD_GEODESIC_MASS_BARYCENTRIC, NULL), *own = NULL;
    const int32_t sources[5] = {5, 5, 17, 5, 17}, pair[2] = {17, 5};
    double *a = KIT_NEW(double, s.n), *b = KIT_NEW(double, s.n);
    int32_t *perm = KIT_NEW(int32_t, s.n), i;
    uint64_t seed = 3;
    hd_geodesic_opts o;
    hd_geodesic_report rep;
    hd_error e;
    int k;
    CHECK(hd_geodesic_distance(g, TOGETHER(5, sources), a, 0, NULL, NULL) == HD_OK);              /* twice is once */
    CHECK(hd_geodesic_distance(g, TOGETHER(2, pair), b, 0, &rep, NULL) == HD_OK && memcmp(a, b, (size_t)s.n * sizeof *a) == 0);
    CHECK(rep.status == HD_OK && rep.error.status == HD_OK && rep.n_components == 1 && rep.ordering == HD_ORDERING_MINIMUM_DEGREE && rep.factor_flops > 0);
    CHECK(hd_geodesic_distance(g, VERTICES(1, pair), b, 0, NULL, NULL) == HD_OK);                 /* a query leaves nothing behind */
    CHECK(hd_geodesic_distance(g, TOGETHER(2, pair), b, 0, NULL, NULL) == HD_OK && memcmp(a, b, (size_t)s.n * sizeof *a) == 0);
    for (i = 0; i < s.n; i++) perm[i] = i;
    CHECK(hd_geodesic_distance(g, TOGETHER(s.n, perm), b, 0, NULL, NULL) == HD_OK);               /* everywhere is a source */
    for (i = 0; i < s.n; i++) CHECK(b[i] == 0);
    memset(&o, 0, sizeof o);
    for (k = HD_ORDERING_MINIMUM_DEGREE; k <= HD_ORDERING_OWN; k++) {
        dense_shuffle(perm, s.n, &seed);
        o.ordering = (hd_ordering)k;
        o.perm = perm;
        CHECK(hd_geodesic_create(&own, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e) == HD_OK);
        CHECK(hd_geodesic_distance(own, TOGETHER(2, pair), b, 0, &rep, NULL) == HD_OK && rep.ordering == (hd_ordering)k);
        CHECK_MSG(geo_difference(a, b, s.n) < 1e-9, "ordering %d: off by %g", k, geo_difference(a, b, s.n));
        hd_geodesic_free(own);
    }
    own = NULL;
    perm[3] = perm[4];
    CHECK(hd_geodesic_create(&own, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e) == HD_ERR_INDEX && !own);
    hd_geodesic_free(g);
}

static void geo_errors(void) {
    shape s = kit_own_shape(shape_icosphere(1));
    hd_geodesic *g = NULL;
    hd_geodesic_opts good, o;
    hd_geodesic_report rep;
    hd_error e;
    const int32_t beyond[3] = {1, 2, 42}, below = -1, zero = 0;
    double d[42 * 2], keep;
    int32_t face[3] = {0, 0, 1};
    memset(&good, 0, sizeof good);
#define GEO_BAD_OPTION(field, bad)                                                                                     \
    o = good;                                                                                                          \
    o.field = bad;                                                                                                     \
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, &e) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT && e.text[0] && !g)
    GEO_BAD_OPTION(begin_zero, 1);
    GEO_BAD_OPTION(end_zero, 1);
    GEO_BAD_OPTION(t, -1);
    GEO_BAD_OPTION(t, (double)NAN);
    GEO_BAD_OPTION(t, HUGE_VAL);
    GEO_BAD_OPTION(t, 1e-310);
    GEO_BAD_OPTION(mass, (hd_geodesic_mass)2);
    GEO_BAD_OPTION(ordering, (hd_ordering)9);
    GEO_BAD_OPTION(ordering, HD_ORDERING_OWN);
#undef GEO_BAD_OPTION
    CHECK(hd_geodesic_create(NULL, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(NULL, s.n, s.tri, s.n_tri), NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, NULL, s.n_tri), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, -1, s.tri, s.n_tri), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, -1), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, 0), NULL, &e) == HD_ERR_EMPTY);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(NULL, 0, NULL, 0), NULL, &e) == HD_ERR_EMPTY);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, face, 1), NULL, &e) == HD_ERR_EMPTY);
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, 12, s.tri, s.n_tri), NULL, &e) == HD_ERR_INDEX && e.face >= 0 && e.value >= 12);
    keep = s.xyz[3 * 7 + 1];
    s.xyz[3 * 7 + 1] = (double)NAN;
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), NULL, &e) == HD_ERR_NOT_FINITE && e.vertex == 7 && !g);
    s.xyz[3 * 7 + 1] = keep;
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), NULL, &e) == HD_OK && e.status == HD_OK);
    CHECK(hd_geodesic_distance(g, TOGETHER(3, beyond), d, 0, &rep, NULL) == HD_ERR_INDEX && rep.status == HD_ERR_INDEX);
    CHECK(rep.error.vertex == 42 && rep.error.value == 42 && rep.error.column == 0 && rep.error.row == 2);
    CHECK(hd_geodesic_distance(g, VERTICES(1, &below), d, 0, &rep, NULL) == HD_ERR_INDEX);
    CHECK(rep.error.vertex == -1 && rep.error.value == -1 && rep.error.column == 0 && rep.error.row == 0);
    CHECK(hd_geodesic_distance(g, VERTICES(3, beyond), d, 0, &rep, NULL) == HD_ERR_INDEX && rep.error.column == 2 && rep.error.row == 0);
    CHECK(hd_geodesic_distance(g, TOGETHER(0, beyond), d, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.column == 0);
    CHECK(hd_geodesic_distance(g, TOGETHER(-1, beyond), d, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(g, NULL, d, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.text[0]);
    CHECK(hd_geodesic_distance(g, VERTICES(1, NULL), d, 0, &rep, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(g, VERTICES(1, beyond), NULL, 0, &rep, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(NULL, TOGETHER(1, beyond), d, 0, &rep, NULL) == HD_ERR_ARGUMENT && rep.error.text[0]);
    CHECK(hd_geodesic_distance(NULL, VERTICES(1, beyond), d, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(g, VERTICES(-1, beyond), d, 0, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(g, VERTICES(1, beyond), d, 41, NULL, NULL) == HD_ERR_ARGUMENT);
    CHECK(hd_geodesic_distance(g, VERTICES(0, NULL), NULL, 0, &rep, NULL) == HD_OK && rep.h > 0);
    CHECK(hd_geodesic_distance(g, VERTICES(1, &zero), d, 0, &rep, NULL) == HD_OK && d[0] == 0 && d[1] > 0);  /* as good as before */
    hd_geodesic_free(g);
    hd_geodesic_free(NULL);
}

/* One triangle, the smallest mesh of all: equilateral, so that heat runs straight from a corner to the middle of the edge opposite. */
static void geo_triangle(void) {
    const double xyz[9] = {0, 0, 0, 1, 0, 0, 0.5, 0.86602540378443865, 0};
    const int32_t tri[3] = {0, 1, 2}, source = 0;
    hd_geodesic *g = NULL;
    double d[3];
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(xyz, 3, tri, 1), NULL, NULL) == HD_OK);
    CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, NULL, NULL) == HD_OK);
    CHECK_MSG(d[0] == 0 && fabs(d[1] - xyz[7]) < 1e-14 && fabs(d[2] - xyz[7]) < 1e-14, "%.17g %.17g %.17g", d[0], d[1], d[2]);
    hd_geodesic_free(g);
}

/* Components of one right-angled triangle each, where L loses its rank without any rounding to help: a row is taken out in every one of them. */
static void geo_triangles(void) {
    enum { M = 5 };
    double xyz[9 * M], d[3 * M];
    int32_t tri[3 * M], sources[M], i;
    hd_geodesic *g = NULL;
    hd_geodesic_report rep;
    memset(xyz, 0, sizeof xyz);
    for (i = 0; i < M; i++) {
        xyz[9 * i + 2] = xyz[9 * i + 5] = xyz[9 * i + 8] = i;
        xyz[9 * i + 3] = xyz[9 * i + 7] = 1;
        tri[3 * i] = 3 * i;
        tri[3 * i + 1] = 3 * i + 1;
        tri[3 * i + 2] = 3 * i + 2;
        sources[i] = 3 * i;
    }
    CHECK(hd_geodesic_create(&g, MESH_TRIANGLES(xyz, 3 * M, tri, M), NULL, NULL) == HD_OK);
    CHECK(hd_geodesic_distance(g, TOGETHER(M, sources), d, 0, &rep, NULL) == HD_OK && rep.n_components == M);
    for (i = 0; i < M; i++) CHECK_MSG(d[3 * i] == 0 && fabs(d[3 * i + 1] - sqrt(0.5)) < 1e-14 && fabs(d[3 * i + 2] - sqrt(0.5)) < 1e-14, "%.17g %.17g", d[3 * i + 1], d[3 * i + 2]);
    hd_geodesic_free(g);
}

/* ---- threads, instruction sets, failures ---- */

static int64_t geo_thread_run(const shape *s, hd_simd simd, int way, double *out) {
    static const int32_t sources[11] = {1, 4, 2600, 7, 300, 5200, 20, 3900, 22, 600, 4500};     /* from 2562 on in a strip that needs stages */
    ldl_way *w = KIT_NEW(ldl_way, 1);
    hd_geodesic *g;
    int64_t calls;
    ldl_way_begin(w, way, simd);
    g = geo_plan(s, 0, HD_GEODESIC_MASS_BARYCENTRIC, &w->ctx);
    CHECK(hd_geodesic_distance(g, TOGETHER(3, sources), out, 0, NULL, NULL) == HD_OK);
    CHECK(hd_geodesic_distance(g, VERTICES(11, sources), out + s->n, 0, NULL, NULL) == HD_OK);
    hd_geodesic_free(g);
    ldl_way_end(w, way);
    calls = w->calls;
#ifdef LDL_THREADS
    calls += w->pool.loops;
#endif
    return calls;
}

static void geo_threads(void) {
    const double offset[3] = {3, 0, 0};
    shape ball = kit_own_shape(shape_bumpy(4, 6)), strip = kit_own_shape(shape_grid(900, 3, 0.2)), s = kit_own_shape(shape_disjoint(&ball, &strip, offset));
    const int64_t size = 12 * (int64_t)s.n;
    double *first = KIT_NEW(double, size), *other = KIT_NEW(double, size), *top = KIT_NEW(double, size);
    int64_t calls = 0;
    int level, way, i;
    for (i = 3 * ball.n; i < 3 * s.n; i++) s.xyz[i] *= 60;               /* edges as long as the ball's */
    for (level = 0; level < 4; level++) {
        geo_thread_run(&s, ldl_simds[level], 0, first);
        if (level == 0) memcpy(top, first, (size_t)size * sizeof *top);
        CHECK_MSG(geo_difference(first, top, size) < 1e-8, "level %d is off by %g", level, geo_difference(first, top, size));
        for (way = 1; way < LDL_WAYS; way++) {
            if (way < 4 && level > 0) continue;
            calls += geo_thread_run(&s, ldl_simds[level], way, other);
            CHECK_MSG(memcmp(first, other, (size_t)size * sizeof *first) == 0, "way %d of threading gives other bits, level %d", way, level);
        }
    }
    CHECK(calls > 0);
}

static hd_geodesic *const geo_mark = (hd_geodesic *)&test_passed;    /* not a plan: only compared */

static void test_geodesic(void) {
    static const double plane[5] = {0.1, 0.06, 0.04, 0.03, 0.02}, ball[5] = {0.12, 0.07, 0.04, 0.025, 0.02};
    geo_against_dense(shape_bumpy(2, 5), "ball");
    geo_against_dense(shape_torus(14, 9, 1, 0.4), "torus");
    geo_against_dense(shape_grid(13, 11, 0.35), "grid");
    geo_against_dense(geo_sheared(11, 11, 2.5), "obtuse");
    geo_against_dense(geo_two(), "two components");
    geo_triangle();
    geo_triangles();
    geo_tube(4, 60, 1, 1);
    geo_tube(7, 60, 30, 1);
    geo_tube(3, 3000, 1, 7);
    geo_tube(5, 400, 1e-3, 6);
    geo_tube(3, 5000, 100, 2);
    geo_refine(0, plane, 5);
    geo_refine(1, ball, 4);
    geo_long();
    geo_strip(HD_ORDERING_MINIMUM_DEGREE);
    geo_strip(HD_ORDERING_NESTED_DISSECTION);
    geo_stages_ordered(shape_grid(130, 130, 0), 8000, 1e-12);
    geo_stages_ordered(shape_grid(900, 6, 0.4), 5, 1e-8);
    geo_stages_ordered(shape_bumpy(5, 2), 0, 1e-14);
    geo_stages_ordered(shape_cylinder(620, 2, 0.16, 1 / 620.0), 0, 2.6e-8);   /* ends above others */
    geo_moved();
    geo_renumbered();
    geo_symmetric();
    geo_parts();
    geo_ugly();
    geo_plans();
    geo_errors();
    geo_threads();
}

#endif
