/* test_bounds.h - error bounds where they are hard to keep: truths by closed forms, in double-double, or from
   a better answer that knows its own bound

   Every answer must be as near to the truth as its report says, or come with an honest error. A bound that
   says nothing (above 0.01, or not finite) must come with HD_WARN_ACCURACY. tools/bounds.c asks the same of
   many more cases; here are those that need larger meshes, and those that were once found wrong. */

#ifndef TEST_BOUNDS_H
#define TEST_BOUNDS_H

/* ---- double-double ---- */

/* hi + lo, good to 2^-104 or so (Dekker 1971, Knuth). */
typedef struct bnd_dd { double hi, lo; } bnd_dd;

static bnd_dd bnd_sum(double a, double b) {
    bnd_dd r;
    const double s = a + b, t = s - a;
    r.hi = s;
    r.lo = (a - (s - t)) + (b - t);
    return r;
}

static bnd_dd bnd_product(double a, double b) {
    const double ca = 134217729.0 * a, cb = 134217729.0 * b, ah = ca - (ca - a), bh = cb - (cb - b);
    const double al = a - ah, bl = b - bh;
    bnd_dd r;
    r.hi = a * b;
    r.lo = ((ah * bh - r.hi) + ah * bl + al * bh) + al * bl;
    return r;
}

static bnd_dd bnd_add(bnd_dd a, bnd_dd b) {
    const bnd_dd s = bnd_sum(a.hi, b.hi), t = bnd_sum(a.lo, b.lo), u = bnd_sum(s.hi, s.lo + t.hi);
    return bnd_sum(u.hi, u.lo + t.lo);
}

static bnd_dd bnd_neg(bnd_dd a) {
    a.hi = -a.hi;
    a.lo = -a.lo;
    return a;
}

static bnd_dd bnd_mul(bnd_dd a, bnd_dd b) {
    const bnd_dd p = bnd_product(a.hi, b.hi);
    return bnd_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static bnd_dd bnd_of(double a) { return bnd_sum(a, 0); }

static bnd_dd bnd_div(bnd_dd a, bnd_dd b) {
    const double q = a.hi / b.hi;
    const bnd_dd r = bnd_add(a, bnd_neg(bnd_mul(b, bnd_of(q))));
    return bnd_sum(q, r.hi / b.hi);
}

static void bnd_dd_works(void) {
    uint64_t seed = 3;
    int k;
    for (k = 0; k < 200; k++) {
        const bnd_dd a = bnd_sum(dense_signed(&seed), 1e-17 * dense_signed(&seed));
        const bnd_dd b = bnd_sum(2 + dense_signed(&seed), 1e-17 * dense_signed(&seed));
        const bnd_dd e = bnd_add(bnd_mul(bnd_div(a, b), b), bnd_neg(a));
        CHECK(fabs(e.hi) < 1e-30);
    }
}

/* ---- checks ---- */

/* `error` of an answer beside its largest value, where the truth is good to `slack` of it. */
static void bnd_judge(const char *what, hd_status st, const hd_report *r, double error, double slack) {
    if (st < 0) {
        CHECK_MSG(r->error.text[0] != 0, "%s: %s without a word", what, hd_status_name(st));
        return;
    }
    CHECK_MSG(error <= r->error_bound + slack,
              "%s: %s, error %.3g, error_bound %.3g (the truth is good to %.1g)", what, hd_status_name(st),
              error, r->error_bound, slack);
    CHECK_MSG(st != HD_OK || r->error_bound <= 1e-2, "%s: HD_OK with error_bound %.3g", what, r->error_bound);
}

/* The largest difference beside the largest value of u; HUGE_VAL when u has something that is no number. */
static double bnd_error(const double *u, const double *want, int64_t n) {
    const double most = dense_max_abs(u, n), off = dense_max_diff(u, want, n);
    return !(most <= DBL_MAX) ? HUGE_VAL : most > 0 ? off / most : off > 0 ? HUGE_VAL : 0;
}

static hd_heat *bnd_plan(const hd_laplacian *lap, hd_method m, hd_solver s, hd_pole_kind poles,
                         int32_t degree, double tol) {
    hd_heat_opts o;
    hd_heat *h = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.method = m;
    o.solver = s;
    o.poles = poles;
    o.degree = degree;
    o.tol = tol;
    if (!CHECK(hd_heat_create(&h, lap, &o, &e) == HD_OK)) printf("    %s\n", e.text);
    return h;
}

/* The best that the direct method does. */
static hd_heat *bnd_reference(const hd_laplacian *lap) {
    return bnd_plan(lap, HD_METHOD_DIRECT, HD_SOLVER_AUTO, HD_POLES_KERNEL, 14, 0);
}

static const char *bnd_method(hd_method m) {
    return m == HD_METHOD_DIRECT      ? "direct"
           : m == HD_METHOD_KRYLOV    ? "krylov"
           : m == HD_METHOD_ITERATIVE ? "iterative"
                                      : "auto";
}

/* Edges a-b of weight w, B = I; extra (or NULL) is added on the diagonal, and L takes the sign. */
static hd_laplacian *bnd_graph(int32_t n, int32_t m, const int32_t *a, const int32_t *b, const double *w,
                               const double *extra, double sign) {
    int32_t *i = DENSE_NEW(int32_t, 4 * m + n), *j = DENSE_NEW(int32_t, 4 * m + n), e, k = 0, side;
    double *v = DENSE_NEW(double, 4 * m + n);
    hd_laplacian *lap = NULL;
    hd_csr L, B = test_diagonal_csr(n, NULL);
    hd_error err;
    for (e = 0; e < m; e++)
        for (side = 0; side < 2; side++) {
            const int32_t p = side ? b[e] : a[e], q = side ? a[e] : b[e];
            i[k] = j[k] = p;
            v[k++] = sign * w[e];
            i[k] = p;
            j[k] = q;
            v[k++] = -sign * w[e];
        }
    for (e = 0; extra && e < n; e++) {
        i[k] = j[k] = e;
        v[k++] = extra[e];
    }
    memset(&L, 0, sizeof L);
    CHECK(hd_csr_from_triplets(&L, n, n, k, i, j, v, NULL, NULL) == HD_OK);
    if (!CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &err) == HD_OK)) printf("    %s\n", err.text);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    free(i);
    free(j);
    free(v);
    return lap;
}

/* A cycle of weights 1. */
static hd_laplacian *bnd_cycle(int32_t n, const double *extra, double sign) {
    int32_t *a = DENSE_NEW(int32_t, n), *b = DENSE_NEW(int32_t, n), k;
    double *w = DENSE_NEW(double, n);
    hd_laplacian *lap;
    for (k = 0; k < n; k++) {
        a[k] = k;
        b[k] = (k + 1) % n;
        w[k] = 1;
    }
    lap = bnd_graph(n, n, a, b, w, extra, sign);
    free(a);
    free(b);
    free(w);
    return lap;
}

/* ---- commute time and biharmonic ---- */

/* d[v] from vertex s to every vertex of its component, of the doubles of L off the diagonal and of B, in
 * double-double: x = L^-1 (e_s - e_v) by Cholesky with one vertex grounded, d^2 = x_s - x_v, or for
 * biharmonic |x|_B^2 with the mean taken out. */
static void bnd_resistances(const hd_laplacian *lap, int32_t s, int biharmonic, double *d) {
    const int32_t n = lap->n_active, part = lap->component[lap->row[s]];
    int32_t *at = DENSE_NEW(int32_t, n), i, j, k, m = 0;
    bnd_dd *a, *x, *mass, total = bnd_of(0);
    int64_t p;
    for (i = 0; i < n; i++) at[i] = lap->component[i] == part ? m++ : -1;
    a = DENSE_NEW(bnd_dd, m * m);
    x = DENSE_NEW(bnd_dd, m);
    mass = DENSE_NEW(bnd_dd, m);
    for (i = 0; i < n; i++) {
        for (p = lap->L.row_ptr[i]; at[i] >= 0 && p < lap->L.row_ptr[i + 1]; p++) {
            j = lap->L.col[p];
            mass[at[i]] = bnd_add(mass[at[i]], bnd_of(lap->B ? lap->B[p] : i == j ? lap->mass[i] : 0));
            if (j == i) continue;
            a[at[i] * m + at[j]] = bnd_of(lap->L.val[p]);
            a[at[i] * m + at[i]] = bnd_add(a[at[i] * m + at[i]], bnd_of(-lap->L.val[p]));
        }
        if (at[i] >= 0) total = bnd_add(total, mass[at[i]]);
    }
    for (j = 0; j < m - 1; j++)                  /* L = U' D U on all but the last, U unit and upper */
        for (i = j + 1; i < m - 1; i++) {
            const bnd_dd f = bnd_div(a[j * m + i], a[j * m + j]);
            if (f.hi == 0) continue;
            for (k = i; k < m - 1; k++)
                a[i * m + k] = bnd_add(a[i * m + k], bnd_neg(bnd_mul(f, a[j * m + k])));
        }
    for (k = 0; k < n; k++) {
        bnd_dd sum = bnd_of(0);
        const int32_t v = lap->vertex[k], is = at[lap->row[s]], iv = at[k];
        if (iv < 0) continue;
        memset(x, 0, (size_t)m * sizeof *x);
        if (iv != is) {
            x[is] = bnd_of(1);
            x[iv] = bnd_of(-1);
        }
        for (j = 0; j < m - 1; j++) {
            x[j] = bnd_div(x[j], a[j * m + j]);
            for (i = j + 1; i < m - 1; i++) x[i] = bnd_add(x[i], bnd_neg(bnd_mul(a[j * m + i], x[j])));
        }
        x[m - 1] = bnd_of(0);
        for (j = m - 2; j >= 0; j--) {
            bnd_dd t = bnd_of(0);
            for (i = j + 1; i < m - 1; i++) t = bnd_add(t, bnd_mul(a[j * m + i], x[i]));
            x[j] = bnd_add(x[j], bnd_neg(bnd_div(t, a[j * m + j])));
        }
        if (!biharmonic) {
            sum = bnd_add(x[is], bnd_neg(x[iv]));
        } else {
            bnd_dd mean = bnd_of(0);
            for (i = 0; i < m; i++) mean = bnd_add(mean, bnd_mul(mass[i], x[i]));
            mean = bnd_div(mean, total);
            for (i = 0; i < m; i++) x[i] = bnd_add(x[i], bnd_neg(mean));
            for (i = 0; i < n; i++)
                for (p = lap->L.row_ptr[i]; at[i] >= 0 && p < lap->L.row_ptr[i + 1]; p++) {
                    const double b = lap->B ? lap->B[p] : lap->L.col[p] == i ? lap->mass[i] : 0;
                    sum = bnd_add(sum, bnd_mul(bnd_of(b), bnd_mul(x[at[i]], x[at[lap->L.col[p]]])));
                }
        }
        d[v] = sum.hi > 0 ? sqrt(sum.hi) : 0;
    }
    free(at);
    free(a);
    free(x);
    free(mass);
}

static void bnd_resistances_hold(const hd_laplacian *lap, const char *what, double x) {
    double *d = DENSE_NEW(double, lap->n), *want = DENSE_NEW(double, lap->n);
    hd_heat *heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
    const int32_t source = 0;
    char text[80];
    int kind;
    for (kind = 0; kind < 2; kind++) {
        hd_report r;
        const hd_status st = heat_distance(heat, kind ? HD_DISTANCE_BIHARMONIC : HD_DISTANCE_COMMUTE, 1,
                                              NULL, 1, &source, d, 0, &r);
        double most = 0, off = 0;
        int32_t v;
        snprintf(text, sizeof text, "%s, %s %g", kind ? "biharmonic" : "commute", what, x);
        bnd_resistances(lap, source, kind, want);
        for (v = 0; v < lap->n && st >= 0; v++) {
            if (lap->component[lap->row[v]] != lap->component[lap->row[source]]) {
                CHECK(d[v] == HUGE_VAL);
                continue;
            }
            most = dense_max_abs(d + v, 1) > most ? d[v] : most;
            if (!(fabs(d[v] - want[v]) <= off)) off = fabs(d[v] - want[v]);
        }
        bnd_judge(text, st, &r, most > 0 ? off / most : HUGE_VAL, 1e-15);
    }
    hd_heat_free(heat);
    free(d);
    free(want);
}

/* Beside a second sphere so much smaller. */
static void bnd_small_component(void) {
    shape s = shape_icosphere(1), small = shape_icosphere(1);
    const double offset[3] = {5, 5, 5};
    double ratio;
    int32_t i;
    for (ratio = 1; ratio > 1e-9; ratio /= 10) {
        shape both = shape_disjoint(&s, &small, offset);
        hd_laplacian *lap = test_laplacian(&both, HD_LAPLACIAN_FEM);
        bnd_resistances_hold(lap, "beside a component of size", ratio);
        hd_laplacian_free(lap);
        shape_free(&both);
        for (i = 0; i < 3 * small.n; i++) small.xyz[i] /= 10;
    }
    shape_free(&s);
    shape_free(&small);
}

/* The middle of an edge, moved h towards the third corner, makes a triangle of no height: cotangents of 1/h.
 */
static void bnd_sliver(void) {
    shape s = shape_icosphere(1);
    int k;
    for (k = 6; k <= 13; k++) {
        shape t = shape_make(s.n + 1, s.n_tri + 2);
        const int32_t a = s.tri[21], b = s.tri[22], c = s.tri[23];
        hd_laplacian *lap;
        int q;
        memcpy(t.xyz, s.xyz, 3 * (size_t)s.n * sizeof *s.xyz);
        memcpy(t.tri, s.tri, 3 * (size_t)s.n_tri * sizeof *s.tri);
        for (q = 0; q < 3; q++) {
            const double m = (s.xyz[3 * a + q] + s.xyz[3 * b + q]) / 2;
            t.xyz[3 * s.n + q] = m + (s.xyz[3 * c + q] - m) * pow(10, -k);
        }
        shape_put_triangle(&t, 7, a, s.n, c);
        shape_put_triangle(&t, s.n_tri, s.n, b, c);
        shape_put_triangle(&t, s.n_tri + 1, a, b, s.n);
        lap = test_laplacian(&t, HD_LAPLACIAN_FEM);
        bnd_resistances_hold(lap, "with a sliver of height", pow(10, -k));
        hd_laplacian_free(lap);
        shape_free(&t);
    }
    shape_free(&s);
}

/* No edges at all: every vertex is a component. */
static void bnd_no_edges(void) {
    const double none = 0;
    const int32_t zero = 0;
    int32_t n, v;
    for (n = 1; n <= 5; n += 4) {
        hd_laplacian *lap = bnd_graph(n, 1, &zero, &zero, &none, NULL, 1);
        hd_heat *heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        double d[5];
        hd_report r;
        const hd_status st = heat_distance(heat, HD_DISTANCE_COMMUTE, 1, NULL, 1, &zero, d, 0, &r);
        if (CHECK_MSG(st >= 0, "%d vertices: %s %s", (int)n, hd_status_name(st), r.error.text))
            for (v = 0; v < n; v++) CHECK(v == 0 ? d[v] == 0 : d[v] == HUGE_VAL);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
}

/* ---- matrices that are not positive semi-definite ---- */

/* exp(-tL) for L = 1 + 0.9 of the neighbours on a cycle. */
static double bnd_cycle_heat(int32_t n, int32_t apart, double t) {
    double sum = 0;
    int32_t k;
    for (k = 0; k < n; k++)
        sum += exp(-t * (1 + 1.8 * cos(2 * heat_pi * k / n))) * cos(2 * heat_pi * k * apart / n);
    return sum / n;
}

/* Minus the matrix of a graph is told by its diagonal. Indefinite ones whose entries look innocent are met later: an error,
 * or the truth within the bounds. */
static void bnd_turned(void) {
    enum { N = 100 };
    hd_laplacian *lap = NULL;
    double u[N], want[N], t, w[N], extra[N];
    int32_t a[N], b[N];
    hd_csr one = test_diagonal_csr(N, NULL), minus = test_diagonal_csr(N, NULL);
    hd_error err;
    const int32_t source = 0;
    char text[80];
    hd_report r;
    hd_status st;
    int m, refused = 0;
    int32_t i;
    for (i = 0; i < N; i++) {
        a[i] = i;
        b[i] = (i + 1) % N;
        w[i] = 0.9;
        extra[i] = 2.8;
        minus.val[i] = -1;
    }
    CHECK(hd_laplacian_matrices(&lap, &minus, &one, 0, NULL, &err) == HD_ERR_NOT_POSITIVE && !lap && strstr(err.text, "libigl") && err.row == 0);
    hd_csr_free(&one, NULL);
    hd_csr_free(&minus, NULL);
    lap = bnd_graph(N, N, a, b, w, extra, -1);
    for (t = 1; t < 20; t *= 10) {
        for (i = 0; i < N; i++) want[i] = bnd_cycle_heat(N, i, t);
        for (m = HD_METHOD_AUTO; m <= HD_METHOD_KRYLOV; m++) {
            hd_heat *heat = bnd_plan(lap, (hd_method)m, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            snprintf(text, sizeof text, "indefinite L, column, %s, t = %g", bnd_method((hd_method)m), t);
            st = heat_column(heat, t, source, u, &r);
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-13);
            refused += st == HD_ERR_NOT_POSITIVE;
            hd_heat_free(heat);
        }
        {
            hd_heat *heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            snprintf(text, sizeof text, "indefinite L, diagonal, t = %g", t);
            st = heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, u, 0, &r);
            for (i = 0; i < N; i++) want[i] = bnd_cycle_heat(N, 0, t);
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-13);
            snprintf(text, sizeof text, "indefinite L, distance, t = %g", t);
            st = heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, u, 0, &r);
            for (i = 0; i < N; i++)
                want[i] =
                    sqrt(fmax(0, 2 * (bnd_cycle_heat(N, 0, 2 * t) - bnd_cycle_heat(N, i, 2 * t))));
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-13);
            refused += st == HD_ERR_NOT_POSITIVE;
            hd_heat_free(heat);
        }
    }
    CHECK_MSG(refused >= 8, "only %d of ten were refused", refused);
    hd_laplacian_free(lap);
}

/* ---- sizes at the ends of doubles, and nothing left ---- */

/* Pairs of an octahedron times 10^100 and 10^-100: distances are 1/length^2 and have all their digits. */
static void bnd_octahedron(void) {
    static const double xyz[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const int32_t tri[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    static const int32_t i[3] = {0, 0, 2}, j[3] = {1, 2, 5};
    static const double sizes[3] = {1, 1e100, 1e-100};
    double at[18], K[3], d[3], K1[3], d1[3];
    int q, p;
    for (q = 0; q < 3; q++) {
        hd_laplacian *lap = NULL;
        hd_heat *heat;
        hd_report r;
        for (p = 0; p < 18; p++) at[p] = sizes[q] * xyz[p];
        CHECK(hd_laplacian_triangles(&lap, at, 6, tri, 8, NULL, NULL) == HD_OK);
        heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        CHECK(heat_pairs(heat, HD_DISTANCE_CLASSICAL, 0.3 * lap->h * lap->h, 3, i, j, q ? K1 : K, q ? d1 : d, &r) == HD_OK);
        CHECK_MSG(r.n_lost == 0 && r.error_bound < 1e-5 && r.error_relative < 1e-5, "bound %g, relative %g", r.error_bound, r.error_relative);
        for (p = 0; p < 3 && q; p++)
            CHECK_MSG(fabs(K1[p] / K[p] - 1) < 1e-9 && fabs(d1[p] * sizes[q] / d[p] - 1) < 1e-9, "pair %d: K %g, d %g", p, K1[p], d1[p]);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
}

/* Where distances underflow there are none, and so no order of samples: the status says so. */
static void bnd_nothing_left(void) {
    hd_laplacian *lap = bnd_cycle(40, NULL, 1);
    hd_heat *heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
    double d[40], far[4], t;
    const int32_t source = 3;
    int32_t vertex[4];
    hd_report r;
    for (t = 5e4; t < 1e300; t *= 1e33) {
        CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, d, 0, &r) == HD_WARN_ACCURACY);
        CHECK(r.n_lost == 39 && !(r.error_bound <= 1e-2) && r.error_bound == r.error_bound);
        CHECK(heat_sample(heat, HD_DISTANCE_CLASSICAL, t, 4, 0, vertex, far, &r) == HD_WARN_ACCURACY && !(r.error_bound <= 1e-2));
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

/* ---- single entries ---- */

/* An error relative to the value itself, where that may be next to nothing. */
static double bnd_beside(double error, double value) { return error / fmax(fabs(value), DBL_MIN); }

/* K of a vertex and its antipode: tiny at small times, and the bound is relative to what is returned. */
static void bnd_far_entry(void) {
    shape s = shape_icosphere(4);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0),
            *best = bnd_reference(lap);
    double *u = DENSE_NEW(double, s.n), value, K, d, c;
    int32_t i, far_off = 0;
    const int32_t source = 0;
    char text[80];
    for (i = 0; i < s.n; i++)
        if (dense_dot(s.xyz + 3 * i, s.xyz, 3) < dense_dot(s.xyz + 3 * far_off, s.xyz, 3)) far_off = i;
    for (c = 1; c < 2000; c *= 4) {
        const double t = c * lap->h * lap->h;
        hd_report r, r0;
        hd_status st;
        double slack;
        CHECK(heat_columns(best, t, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, &r0) >= 0);
        slack = r0.error_bound * dense_max_abs(u, s.n);
        snprintf(text, sizeof text, "k_t of antipodes, t = %g h^2", c);
        st = heat_entries(heat, t, HD_KERNEL_SYMMETRIC, 1, &far_off, &source, &value, &r);
        bnd_judge(text, st, &r, bnd_beside(fabs(value - u[far_off]), value), bnd_beside(slack, value));
        CHECK(heat_columns(best, t, HD_KERNEL_OPERATOR, 1, &source, u, 0, &r0) >= 0);
        slack = r0.error_bound * dense_max_abs(u, s.n);
        snprintf(text, sizeof text, "K_t of antipodes, as a pair, t = %g h^2", c);
        st = heat_pairs(heat, HD_DISTANCE_CLASSICAL, t, 1, &far_off, &source, &K, &d, &r);
        bnd_judge(text, st, &r, bnd_beside(fabs(K - u[far_off]), K), bnd_beside(slack, K));
    }
    hd_heat_free(heat);
    hd_heat_free(best);
    hd_laplacian_free(lap);
    free(u);
    shape_free(&s);
}

/* ---- rows that almost sum to zero, long times ---- */

/* A cycle that loses heat at the rate eps everywhere: K_t f = exp(-eps t) times that of the cycle, at this t
 * the mean. */
static void bnd_almost_conserving(void) {
    enum { N = 64 };
    double extra[N], f[N], u[N], want[N], eps, t = 1e11;
    hd_laplacian *lap;
    char text[80];
    int m;
    int32_t i;
    for (i = 0; i < N; i++) {
        extra[i] = 4e-12;
        f[i] = i + 1;
    }
    lap = bnd_cycle(N, extra, 1);
    eps = lap->L.val[0] - 2;
    CHECK(eps > 3e-12 && eps < 5e-12);
    for (m = HD_METHOD_AUTO; m <= HD_METHOD_KRYLOV; m++) {
        hd_heat *heat = bnd_plan(lap, (hd_method)m, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        hd_report r;
        hd_status st = heat_apply(heat, t, 1, f, 0, u, 0, &r);
        for (i = 0; i < N; i++) want[i] = exp(-eps * t) * (N + 1) / 2;
        snprintf(text, sizeof text, "field, almost conserving, %s", bnd_method((hd_method)m));
        bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-14);
        st = heat_column(heat, t, 0, u, &r);
        for (i = 0; i < N; i++) want[i] = exp(-eps * t) / N;
        snprintf(text, sizeof text, "column, almost conserving, %s", bnd_method((hd_method)m));
        bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-14);
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
}

/* A path and its first eigenvector: K_t f = exp(-t lambda) f, up to the rounding of f, which has larger parts
 * that fade. */
static void bnd_long_path(void) {
    int32_t n, i;
    int q, m;
    char text[80];
    for (n = 1000; n <= 100000; n *= 10) {
        int32_t *a = DENSE_NEW(int32_t, n), *b = DENSE_NEW(int32_t, n);
        double *w = DENSE_NEW(double, n), *f = DENSE_NEW(double, n), *u = DENSE_NEW(double, n),
               *want = DENSE_NEW(double, n);
        const double lambda = 4 * pow(sin(heat_pi / 2 / n), 2);
        hd_laplacian *lap;
        for (i = 0; i < n; i++) {
            a[i] = i;
            b[i] = i + 1;
            w[i] = 1;
            f[i] = cos(heat_pi * (i + 0.5) / n);
        }
        lap = bnd_graph(n, n - 1, a, b, w, NULL, 1);
        for (q = 0; q < 2; q++)
            for (m = HD_METHOD_DIRECT; m <= HD_METHOD_KRYLOV; m++) {
                const double t = (q ? 0.1 : 0.01) * n * n;
                hd_heat *heat = bnd_plan(lap, (hd_method)m, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
                hd_report r;
                const hd_status st = heat_apply(heat, t, 1, f, 0, u, 0, &r);
                for (i = 0; i < n; i++) want[i] = exp(-t * lambda) * f[i];
                snprintf(text, sizeof text, "path of %d, t = %g, %s", (int)n, t, bnd_method((hd_method)m));
                bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, n), 2e-15);
                for (i = 0; i < n; i++) want[i] -= u[i];
                if (st >= 0) {
                    const double error = sqrt(dense_dot(want, want, n) / dense_dot(u, u, n));
                    CHECK_MSG(error <= r.error_bound_b + 2e-15,
                              "%s: error in the norm %.3g, error_bound_b %.3g", text, error, r.error_bound_b);
                }
                hd_heat_free(heat);
            }
        hd_laplacian_free(lap);
        free(a);
        free(b);
        free(w);
        free(f);
        free(u);
        free(want);
    }
}

/* ---- poles of the caller's own ---- */

/* The kernel set of degree 8, told with a weighted error that is loose: true, and of no help. */
static void bnd_loose_set(void) {
    shape s = shape_icosphere(3);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    hd_heat *best = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_KERNEL, 14, 0);
    double *d = DENSE_NEW(double, s.n), *want = DENSE_NEW(double, s.n), c;
    const int32_t source = 0;
    char text[80];
    int q;
    for (q = 0; q < 2; q++)
        for (c = 1; c < 200; c *= 10) {
            const double t = c * lap->h * lap->h;
            hd_rational set;
            hd_heat_opts o;
            hd_heat *heat = NULL;
            hd_report r, r0;
            hd_status st;
            CHECK(hd_rational_get(&set, HD_POLES_KERNEL, 8, NULL) == HD_OK);
            set.kind = HD_POLES_OWN;
            set.max_error = 2.9e-7;
            set.max_weighted_error = q ? 3e-7 : 1;
            memset(&o, 0, sizeof o);
            o.rational = &set;
            CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
            CHECK(heat_distance(best, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, want, 0, &r0) >= 0);
            st = heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, d, 0, &r);
            snprintf(text, sizeof text, "distance, own set, weighted error %g, t = %g h^2",
                     set.max_weighted_error, c);
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(d, want, s.n), 1.01 * r0.error_bound);
            hd_heat_free(heat);
        }
    hd_heat_free(best);
    hd_laplacian_free(lap);
    free(d);
    free(want);
    shape_free(&s);
}

/* A pair of poles 10^-k above an eigenvalue of a cycle: bounds are of the filter itself, c(x) = 2 Re i/(x -
 * theta). Where the distance to the eigenvalue matters, it is that of the doubles: eigenvalues are had in
 * long double. */
static void bnd_near_poles(void) {
    enum { N = 60 };
    const double pi_hi = 3.141592653589793, pi_lo = 1.2246467991473532e-16;
    hd_laplacian *lap = bnd_cycle(N, NULL, 1);
    double u[N], want[N];
    char text[80];
    int k, q;
    int32_t i;
    for (k = 3; k < 8; k++) {
        long double x[N], truth = 0, term[N];
        hd_rational set;
        hd_heat_opts o;
        hd_heat *heat = NULL;
        hd_report r;
        hd_status st;
        const double t = 1;
        for (q = 0; q < N; q++) {
            const long double half = sinl(((long double)pi_hi + (long double)pi_lo) * q / N);
            x[q] = -4 * half * half;
        }
        memset(&set, 0, sizeof set);
        set.kind = HD_POLES_OWN;
        set.degree = 2;
        set.n_poles = 1;
        set.theta[0] = test_c((double)x[7], pow(10, -k));
        set.a[0] = test_c(0, 1);
        for (q = 0; q < N;
             q++) { /* 2 Re i/(x - theta) = -2 Im theta/|x - theta|^2, as Im 1/(x - theta) = Im theta/|.|^2 */
            const long double dr = x[q] - (long double)set.theta[0].re, di = (long double)set.theta[0].im;
            term[q] = -2 * di / (dr * dr + di * di);
            truth += term[q] / N;
        }
        memset(&o, 0, sizeof o);
        o.rational = &set;
        o.method = HD_METHOD_DIRECT;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        st = heat_diagonal(heat, 1, &t, HD_KERNEL_SYMMETRIC, u, 0, &r);
        for (i = 0; i < N; i++) want[i] = (double)truth;
        snprintf(text, sizeof text, "diagonal, poles 1e-%d off the spectrum", k);
        bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-14);
        st = heat_column(heat, t, 3, u, &r);
        for (i = 0; i < N; i++) {
            long double sum = 0;
            for (q = 0; q < N; q++)
                sum += term[q] * cosl(2 * ((long double)pi_hi + (long double)pi_lo) * q * (i - 3) / N) / N;
            want[i] = (double)sum;
        }
        snprintf(text, sizeof text, "column, poles 1e-%d off the spectrum", k);
        bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1e-14);
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
}

/* ---- a mass matrix that is nearly singular ---- */

/* B = tridiag(1/2, 1 + 1e-9, 1/2) on a long path, and a field along its smallest eigenvector. */
static void bnd_near_singular_mass(void) {
    enum { N = 20000 };
    int32_t *i = DENSE_NEW(int32_t, 3 * N), *j = DENSE_NEW(int32_t, 3 * N), k = 0, p;
    double *l = DENSE_NEW(double, 3 * N), *m = DENSE_NEW(double, 3 * N), *f = DENSE_NEW(double, N),
           *u = DENSE_NEW(double, N), *want = DENSE_NEW(double, N);
    const double least = (1e-9 + 2 * pow(sin(heat_pi / (N + 1) / 2), 2)) / (1 + 1e-9);
    hd_csr L, B;
    hd_laplacian *lap = NULL;
    hd_heat *best;
    char text[80];
    int c, q;
    for (p = 0; p < N; p++) {
        i[k] = j[k] = p;
        l[k] = p == 0 || p == N - 1 ? 1 : 2;
        m[k++] = 1 + 1e-9;
        for (q = -1; q <= 1; q += 2) {
            if (p + q < 0 || p + q >= N) continue;
            i[k] = p;
            j[k] = p + q;
            l[k] = -1;
            m[k++] = 0.5;
        }
    }
    memset(&L, 0, sizeof L);
    memset(&B, 0, sizeof B);
    CHECK(hd_csr_from_triplets(&L, N, N, k, i, j, l, NULL, NULL) == HD_OK &&
          hd_csr_from_triplets(&B, N, N, k, i, j, m, NULL, NULL) == HD_OK);
    if (CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK)) {
        CHECK_MSG(lap->b_ratio <= least, "b_ratio %.3g, but B is %.3g of its diagonal", lap->b_ratio, least);
        best = bnd_reference(lap);
        for (c = 0; c < 3; c++)
            for (q = 0; q < 2; q++) {
                hd_heat *heat =
                    c ? bnd_plan(lap, HD_METHOD_DIRECT, HD_SOLVER_AUTO, HD_POLES_UNIFORM, 4 * c, 0)
                      : bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
                hd_report r, r0;
                hd_status st, st0;
                for (p = 0; p < N; p++)
                    f[p] = 1 + (p % 2 ? -1e5 : 1e5) * (q ? sin(heat_pi * (p + 1) / (N + 1)) : 1);
                st0 = heat_apply(best, 1, 1, f, 0, want, 0, &r0);
                st = heat_apply(heat, 1, 1, f, 0, u, 0, &r);
                snprintf(text, sizeof text, "mass nearly singular, field %d, %s", q,
                         c ? c == 1 ? "degree 4" : "degree 8" : "default");
                /* degree 4 and 8 are seen to err by more than 1e-3 and 1e-6 of the largest value */
                bnd_judge(text, st, &r, st < 0 || st0 < 0 ? 0 : bnd_error(u, want, N),
                          r0.error_bound < 1e-6 ? r0.error_bound : 1e-6);
                hd_heat_free(heat);
            }
        hd_heat_free(best);
    }
    hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    free(i);
    free(j);
    free(l);
    free(m);
    free(f);
    free(u);
    free(want);
}

/* ---- many times at once ---- */

/* On planar grids x = (i/m)^p: sixteen times in one call beside the same times one by one, each with its
 * bound. */
static void bnd_graded_times(void) {
    enum { M = 13, TIMES = 16 };
    double *D = DENSE_NEW(double, TIMES * M * M), *d = DENSE_NEW(double, M * M), ts[TIMES];
    char text[80];
    int kind, p, q;
    int32_t i, j, source;
    for (p = 2; p <= 10; p += 2) {
        shape s = shape_grid(M, M, 0);
        hd_laplacian *lap;
        hd_heat *heat;
        for (i = 0; i < M; i++)
            for (j = 0; j < M; j++)
                shape_put_vertex(&s, i * M + j, pow((i + 0.5) / M, p), pow((j + 0.5) / M, p), 0);
        lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
        heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        for (q = 0; q < TIMES; q++) ts[q] = pow(100, q / 15.0) * lap->h * lap->h;
        for (kind = HD_DISTANCE_CLASSICAL; kind <= HD_DISTANCE_WEIGHTED; kind++)
            for (source = 0; source < s.n; source += s.n / 2) {
                hd_report r, one;
                const hd_status st =
                    heat_distance(heat, (hd_distance_kind)kind, TIMES, ts, 1, &source, D, 0, &r);
                for (q = 0; q < TIMES && CHECK(st >= 0); q++) {
                    if (heat_distance(heat, (hd_distance_kind)kind, 1, ts + q, 1, &source, d, 0, &one) < 0)
                        continue;
                    snprintf(text, sizeof text, "%s, power %d, source %d, time %d of 16 at once",
                             kind ? "weighted" : "classical", p, (int)source, q);
                    bnd_judge(text, st, &r, bnd_error(D + q * s.n, d, s.n),
                              1.01 * one.error_bound *
                                  fmax(1, dense_max_abs(d, s.n) / dense_max_abs(D + q * s.n, s.n)));
                }
            }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        shape_free(&s);
    }
    free(D);
    free(d);
}

/* ---- stiff penalties, weak edges ---- */

static void bnd_penalty(void) {
    enum { N = 60 };
    double extra[N], u[N], want[N], t;
    hd_laplacian *lap;
    hd_heat *best, *heat;
    const int32_t source = 3;
    char text[80];
    memset(extra, 0, sizeof extra);
    extra[0] = 1e6;
    lap = bnd_cycle(N, extra, 1);
    best = bnd_reference(lap);
    heat = bnd_plan(lap, HD_METHOD_ITERATIVE, HD_SOLVER_LANCZOS, HD_POLES_DEFAULT, 0, 0);
    for (t = 10; t < 2000; t *= 10) {
        hd_report r, r0;
        hd_status st;
        CHECK(heat_columns(best, t, HD_KERNEL_SYMMETRIC, 1, &source, want, 0, &r0) >= 0);
        st = heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 1, &source, u, 0, &r);
        snprintf(text, sizeof text, "Lanczos with a penalty of 1e6, t = %g", t);
        bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 1.01 * r0.error_bound);
    }
    hd_heat_free(best);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
}

/* Two cycles joined by an edge of weight eps = 2^-k: f = +-1 on them decays with lambda = eps/15 (1 +
 * O(eps)). */
static void bnd_weak_edge(void) {
    enum { N = 60 };
    int32_t a[N + 1], b[N + 1], i;
    double w[N + 1], f[N], u[N], want[N];
    char text[80];
    int k, m;
    for (k = 20; k <= 40; k += 10) {
        const double eps = ldexp(1, -k), t = 3 / eps;
        hd_laplacian *lap;
        for (i = 0; i < N; i++) {
            a[i] = i;
            b[i] = i % 30 == 29 ? i - 29 : i + 1;
            w[i] = 1;
            f[i] = i < 30 ? 1 : -1;
            want[i] = exp(-0.2) * f[i];
        }
        a[N] = 0;
        b[N] = 30;
        w[N] = eps;
        lap = bnd_graph(N, N + 1, a, b, w, NULL, 1);
        for (m = HD_METHOD_ITERATIVE; m <= HD_METHOD_KRYLOV; m++) {
            hd_heat *heat =
                bnd_plan(lap, (hd_method)m, m == HD_METHOD_ITERATIVE ? HD_SOLVER_LANCZOS : HD_SOLVER_AUTO,
                         HD_POLES_DEFAULT, 0, 0);
            hd_report r;
            const hd_status st = heat_apply(heat, t, 1, f, 0, u, 0, &r);
            snprintf(text, sizeof text, "weak edge 2^-%d, %s", k,
                     m == HD_METHOD_ITERATIVE ? "Lanczos" : bnd_method((hd_method)m));
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, N), 10 * eps + 1e-15);
            hd_heat_free(heat);
        }
        hd_laplacian_free(lap);
    }
}

/* ---- sizes that squares do not hold ---- */

static void bnd_shifted_sizes(const hd_laplacian *lap) {
    static const double sizes[] = {1, 1e160, 1e200, 1e-160, 1e-170, 1e-200};
    const int32_t n = lap->n;
    hd_c64 *rhs = DENSE_NEW(hd_c64, n), *x = DENSE_NEW(hd_c64, n), *ref = DENSE_NEW(hd_c64, n);
    const hd_c64 theta = test_c(1, 1);
    hd_solve_report r;
    hd_error e;
    hd_status st;
    int q;
    int32_t i;
    for (q = 0; q < 6; q++) {
        double most = 0, off = 0;
        rhs[3] = test_c(sizes[q], 0);
        memset(&r, 0, sizeof r);
        st = hd_shifted_solve(lap, 0.1, theta, rhs, q ? x : ref, NULL, &r, &e);
        if (q == 0) CHECK(st == HD_OK);
        if (q == 0 || st < 0) continue;
        for (i = 0; i < n; i++) {
            most = fmax(most, fabs(ref[i].re));
            if (!(fabs(x[i].re / sizes[q] - ref[i].re) <= off)) off = fabs(x[i].re / sizes[q] - ref[i].re);
        }
        CHECK_MSG(off <= 1e-6 * most || (st > 0 && r.error_b > 1e-6),
                  "right-hand side of %g: %s, off by %.3g of the largest value, error_b %.3g", sizes[q],
                  hd_status_name(st), off / most, r.error_b);
    }
    for (q = 0; q < 2; q++) {
        rhs[3] = test_c(q ? HUGE_VAL : (double)NAN, 0);
        st = hd_shifted_solve(lap, 0.1, theta, rhs, x, NULL, &r, &e);
        CHECK_MSG(st < 0, "right-hand side that is not finite: %s", hd_status_name(st));
    }
    free(rhs);
    free(x);
    free(ref);
}

/* U over F with columns farther apart: refused, or right. */
static void bnd_overlap(const hd_laplacian *lap) {
    enum { K = 40 };
    const int32_t n = lap->n, ldu = n + 5;
    double *F = DENSE_NEW(double, ldu * K), *G = DENSE_NEW(double, n * K), *R = DENSE_NEW(double, n * K);
    int m;
    int32_t i, c;
    for (m = HD_METHOD_AUTO; m <= HD_METHOD_KRYLOV; m++) {
        hd_heat *heat = bnd_plan(lap, (hd_method)m, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
        hd_report r, r0;
        hd_status st;
        double off = 0;
        for (i = 0; i < n * K; i++) F[i] = G[i] = sin(1.7 * i);
        CHECK(heat_apply(heat, 0.1, K, G, 0, R, 0, &r0) >= 0);
        st = heat_apply(heat, 0.1, K, F, (size_t)n, F, (size_t)ldu, &r);
        for (c = 0; c < K && st >= 0; c++) off = fmax(off, bnd_error(F + c * ldu, R + c * n, n));
        CHECK_MSG(st == HD_ERR_ARGUMENT || (st >= 0 && off <= r.error_bound + r0.error_bound),
                  "U over F with another stride, %s: %s, off by %.3g, bound %.3g", bnd_method((hd_method)m),
                  hd_status_name(st), off, r.error_bound);
        if (m == HD_METHOD_AUTO) {
            CHECK(heat_apply(heat, 0.1, 0, F, 0, G, 0, &r) == HD_OK);
            CHECK(r.reason != NULL);             /* a report that is printed */
        }
        hd_heat_free(heat);
    }
    free(F);
    free(G);
    free(R);
}

/* Fields whose squares are beyond doubles; the reference is the same field of ordinary size. */
static void bnd_field_sizes(const hd_laplacian *lap) {
    static const int sizes[] = {-564, -996, 531, 664}; /* powers of two: the fields differ by nothing else */
    const int32_t n = lap->n;
    double *f = DENSE_NEW(double, n), *g = DENSE_NEW(double, n), *u = DENSE_NEW(double, n),
           *want = DENSE_NEW(double, n);
    hd_heat *best = bnd_reference(lap);
    hd_report r, r0;
    char text[80];
    int q, m;
    int32_t i;
    for (i = 0; i < n; i++) f[i] = sin(1.7 * i * i);
    CHECK(heat_apply(best, 0.1, 1, f, 0, want, 0, &r0) >= 0);
    for (q = 0; q < 4; q++)
        for (m = HD_METHOD_AUTO; m <= HD_METHOD_KRYLOV; m++) {
            hd_heat *heat = bnd_plan(lap, (hd_method)m, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            hd_status st;
            for (i = 0; i < n; i++) g[i] = ldexp(f[i], sizes[q]);
            st = heat_apply(heat, 0.1, 1, g, 0, u, 0, &r);
            for (i = 0; i < n; i++) u[i] = ldexp(u[i], -sizes[q]);
            snprintf(text, sizeof text, "field of size 2^%d, %s", sizes[q], bnd_method((hd_method)m));
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, n), 1.01 * r0.error_bound);
            hd_heat_free(heat);
        }
    hd_heat_free(best);
    free(f);
    free(g);
    free(u);
    free(want);
}

static void bnd_sizes(void) {
    shape s = shape_icosphere(2);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    bnd_shifted_sizes(lap);
    bnd_overlap(lap);
    bnd_field_sizes(lap);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* ---- times without end ---- */

/* exp(-t lambda) of a small mesh by its eigenpairs, for any t. */
static void bnd_small_truth(const dense_pair *p, double t, int32_t source, int what, double *want) {
    int32_t v, k;
    TRAPS_OFF;                                   /* t times an eigenvalue may overflow */
    for (v = 0; v < p->n; v++) {
        double sum = 0;
        for (k = 0; k < p->n; k++) {
            const double *x = p->x + k * p->n, g = exp(-t * p->lambda[k]);
            double bx = 0;
            int32_t i;
            if (what == 2 && p->lambda[k] == 0) continue;   /* constants, of one component */
            for (i = 0; i < p->n; i++) bx += p->B[source * p->n + i] * x[i];
            if (what == 0) sum += x[v] * g * bx;                                      /* column of K_t */
            else if (what == 1) sum += x[v] * g * x[v];                               /* diagonal of k_t */
            else if (what == 2) sum = hypot(sum, g * (x[v] - x[source]));             /* classical */
            else {                                                                    /* weighted */
                double by = 0;
                for (i = 0; i < p->n; i++) by += p->B[v * p->n + i] * x[i];
                sum = hypot(sum, g * (by - bx));
            }
        }
        want[v] = sum;
    }
    TRAPS_ON;
}

static void bnd_all_times_of(const hd_laplacian *lap, const char *name) {
    static const double times[] = {4.9e-324, 1e-320, 1e-310, 1e-308, 1e-300, 1e-200,
                                   1,        1e16,   1e100,  1e200,  1e300,  1e307};
    const int32_t n = lap->n, source = 0;
    double *u = DENSE_NEW(double, 2 * n), *want = DENSE_NEW(double, n), c;
    dense_pair p;
    char text[100];
    int m, q, kind;
    CHECK(dense_pair_solve(&p, test_dense(&lap->L, NULL), test_dense_mass(lap), n));
    for (m = HD_METHOD_AUTO; m <= HD_METHOD_KRYLOV; m++)
        for (q = 0; q < 12; q++) {
            hd_heat *heat = bnd_plan(lap, (hd_method)m, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            hd_report r;
            hd_status st = heat_column(heat, times[q], source, u, &r);
            bnd_small_truth(&p, times[q], source, 0, want);
            snprintf(text, sizeof text, "%s, column, %s, t = %g", name, bnd_method((hd_method)m), times[q]);
            bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, n), 1e-12);
            if (m == HD_METHOD_KRYLOV) {
                const double ts[2] = {times[q], 1};
                st = heat_times(heat, 2, ts, HD_KERNEL_OPERATOR, source, NULL, u, 0, &r);
                snprintf(text, sizeof text, "%s, krylov, times %g and 1", name, times[q]);
                bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, n), 1e-12);
                bnd_small_truth(&p, 1, source, 0, want);
                bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u + n, want, n), 1e-12);
            }
            if (m == HD_METHOD_DIRECT) {
                st = heat_diagonal(heat, 1, times + q, HD_KERNEL_SYMMETRIC, u, 0, &r);
                bnd_small_truth(&p, times[q], source, 1, want);
                snprintf(text, sizeof text, "%s, diagonal, t = %g", name, times[q]);
                bnd_judge(text, st, &r, st < 0 ? 0 : bnd_error(u, want, n), 1e-12);
            }
            hd_heat_free(heat);
        }
    for (kind = HD_DISTANCE_CLASSICAL; kind <= HD_DISTANCE_WEIGHTED; kind++)
        for (c = 1; c < 1e12; c *= 10) {
            const double t = c * lap->h * lap->h;
            hd_heat *heat = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            hd_report r;
            const hd_status st = heat_distance(heat, (hd_distance_kind)kind, 1, &t, 1, &source, u, 0, &r);
            double off;
            bnd_small_truth(&p, t, source, 2 + kind, want);
            off = st < 0 ? 0 : bnd_error(u, want, n);
            if (dense_max_abs(want, n) < 1e-290 && dense_max_abs(u, n) == 0)
                off = 0; /* nothing at all is right there */
            snprintf(text, sizeof text, "%s, distance %d, t = %g h^2", name, kind, c);
            bnd_judge(text, st, &r, off, 1e-11);
            hd_heat_free(heat);
        }
    dense_pair_free(&p);
    free(u);
    free(want);
}

static void bnd_all_times(void) {
    static const double xyz[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, .2, 2, 0, .1};
    static const int32_t tri[] = {0, 1, 2, 1, 3, 2, 1, 4, 3};
    shape s = shape_make(5, 3), ball = shape_icosphere(1);
    hd_laplacian *lap;
    memcpy(s.xyz, xyz, sizeof xyz);
    memcpy(s.tri, tri, sizeof tri);
    lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    bnd_all_times_of(lap, "five vertices");
    hd_laplacian_free(lap);
    lap = test_laplacian(&ball, HD_LAPLACIAN_VORONOI_COT);
    bnd_all_times_of(lap, "sphere");
    hd_laplacian_free(lap);
    shape_free(&s);
    shape_free(&ball);
}

/* ---- a mesh of many parts ---- */

/* The signature of the truck by the default plan beside columns by another method, at some of its vertices.
 */
static void bnd_truck(void) {
    shape s = tri_file("truck.obj");
    hd_laplacian *lap;
    hd_heat *columns, *plan;
    double *D, *u, t, worst = 0, slack = 0;
    hd_report r, c;
    hd_status st;
    int32_t i, at = -1;
    if (!s.xyz) return;
    lap = test_laplacian(&s, HD_LAPLACIAN_FEM);
    columns = bnd_plan(lap, HD_METHOD_KRYLOV, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 1e-13);
    plan = bnd_plan(lap, HD_METHOD_AUTO, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
    D = DENSE_NEW(double, s.n);
    u = DENSE_NEW(double, s.n);
    t = 10 * lap->h * lap->h;
    st = heat_diagonal(plan, 1, &t, HD_KERNEL_SYMMETRIC, D, 0, &r);
    CHECK(st >= 0);
    for (i = 1700; i < 1950 && i < lap->n_active && st >= 0; i++) {
        const int32_t v = lap->vertex[i];
        double error, own;
        if (!CHECK(heat_columns(columns, t, HD_KERNEL_SYMMETRIC, 1, &v, u, 0, &c) >= 0)) break;
        error = fabs(u[v] - D[v]) / fabs(D[v]);
        own = c.error_bound * dense_max_abs(u, s.n) / fabs(D[v]);
        if (error - own <= worst - slack && at >= 0) continue;
        worst = error;
        slack = own;
        at = v;
    }
    CHECK_MSG(worst <= r.error_relative + slack,
              "truck, diagonal: vertex %d is off by %.3g of itself (column good to %.2g), error_relative "
              "%.3g",
              (int)at, worst, slack, r.error_relative);
    hd_heat_free(columns);
    hd_heat_free(plan);
    hd_laplacian_free(lap);
    free(D);
    free(u);
    shape_free(&s);
}

static void test_bounds(void) {
    bnd_dd_works();
    bnd_small_component();
    bnd_sliver();
    bnd_no_edges();
    bnd_turned();
    bnd_octahedron();
    bnd_nothing_left();
    bnd_far_entry();
    bnd_almost_conserving();
    bnd_long_path();
    bnd_loose_set();
    bnd_near_poles();
    bnd_near_singular_mass();
    bnd_graded_times();
    bnd_penalty();
    bnd_weak_edge();
    bnd_sizes();
    bnd_all_times();
    bnd_truck();
}

#endif
