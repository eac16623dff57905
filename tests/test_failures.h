/* test_failures.h - every public call with every allocation failing in turn, with failures at random, cancelled at every progress
 * call, and with limits to the byte. Each time the right status, nothing left behind, and the same objects asked again
 * give the same bits. test_robust.h does the same for calls from nothing; here objects are made first and survive. */

#ifndef TEST_FAILURES_H
#define TEST_FAILURES_H

/* What a case works with. Clear before use; what is not NULL is freed at the end. */
typedef struct fail_world {
    hd_context ctx;
    test_memory m;
    rob_progress p;
    shape s;
    hd_laplacian *lap;
    hd_heat *heat;
    hd_spectrum *spectrum;
    hd_geodesic *geodesic;
    hd_ldl *ldl;
    hd_csr a;                   /* of NULL context */
    double out[2048];
    size_t n_out;               /* doubles that the call has written */
    hd_error e;
    hd_report rep;
    int has_report;
} fail_world;

/* What a case may do under a byte limit: nothing but say so; go on in another way; besides, the way may depend on what was
 * asked before. Where an allocation fails, or the call is cancelled, each must say so. */
enum { FAIL_TELLS = 0, FAIL_GOES_ON, FAIL_DEPENDS };

typedef struct fail_case {
    const char *name;
    hd_status (*prepare)(fail_world *w, int variant);     /* NULL: nothing; must go well */
    hd_status (*call)(fail_world *w, int variant);
    int prepare_variant, variant, goes_on;
} fail_case;

static int64_t fail_memory, fail_random, fail_cancelled, fail_limited;     /* how many failures there were */

/* ---- making things ---- */

/* A ball and a grid: closed and with a border, two components, one vertex in no face. */
static shape fail_shape(void) {
    const double offset[3] = {3, 0, 0};
    shape a = shape_icosphere(0), b = shape_grid(3, 3, 0.2), s = shape_disjoint(&a, &b, offset);
    shape_free(&a);
    shape_free(&b);
    return s;
}

enum { FAIL_UPDATABLE = 1, FAIL_HELD = 2, FAIL_BORDER = 4, FAIL_DELAUNAY = 8, FAIL_TUFTED = 16, FAIL_VORONOI = 32, FAIL_EXP = 64 };

static hd_laplacian_opts fail_opts(fail_world *w, int variant) {
    static const int32_t held[2] = {2, 15};
    hd_laplacian_opts o;
    memset(&o, 0, sizeof o);
    o.context = &w->ctx;
    if (variant & FAIL_UPDATABLE) o.updatable = 1;
    if (variant & FAIL_BORDER) o.border = HD_BORDER_DIRICHLET;
    if (variant & FAIL_DELAUNAY) o.intrinsic_delaunay = 1;
    if (variant & FAIL_TUFTED) o.tufted = 1;
    if (variant & FAIL_VORONOI) o.kind = HD_LAPLACIAN_VORONOI_COT;
    if (variant & FAIL_EXP) o.kind = HD_LAPLACIAN_EXP;
    if (variant & FAIL_HELD) {
        o.n_held = 2;
        o.held = held;
    }
    return o;
}

/* Entries of L and masses are what a Laplacian has to show. */
static void fail_show_laplacian(fail_world *w, const hd_laplacian *lap) {
    size_t n = (size_t)lap->L.nnz;
    if (n > 1500) n = 1500;
    memcpy(w->out, lap->L.val, n * sizeof *w->out);
    memcpy(w->out + n, lap->mass, (size_t)lap->n_active * sizeof *w->out);
    w->n_out = n + (size_t)lap->n_active;
}

static hd_status fail_triangles(fail_world *w, int variant) {
    const hd_laplacian_opts o = fail_opts(w, variant);
    w->s = fail_shape();
    return hd_laplacian_triangles(&w->lap, w->s.xyz, w->s.n, w->s.tri, w->s.n_tri, &o, &w->e);
}

/* By all functions that make a Laplacian: made, shown, freed. */
enum { FAIL_BY_TRIANGLES = 0, FAIL_BY_VIEW = 1 << 8, FAIL_BY_POLYGONS = 2 << 8, FAIL_BY_POINTS = 3 << 8, FAIL_BY_TUFTED_POINTS = 4 << 8,
       FAIL_BY_NEIGHBOURS = 5 << 8, FAIL_BY_FANS = 6 << 8, FAIL_BY_LENGTHS = 7 << 8 };

/* The sides of the triangles of fail_shape. */
static void fail_lengths(const shape *s, double *lengths) {
    int32_t f, q;
    for (f = 0; f < s->n_tri; f++)
        for (q = 0; q < 3; q++)
            lengths[3 * f + q] = shape_distance(s->xyz + 3 * s->tri[3 * f + q], s->xyz + 3 * s->tri[3 * f + (q + 1) % 3]);
}

static hd_mesh_view fail_view(const shape *s, float *xyz) {
    hd_mesh_view view;
    int32_t k;
    memset(&view, 0, sizeof view);
    for (k = 0; k < 3 * s->n; k++) xyz[k] = (float)s->xyz[k];
    view.xyz_float = xyz;
    view.n = s->n;
    view.tri_i32 = s->tri;
    view.n_indices = 3 * (int64_t)s->n_tri;
    return view;
}

static hd_status fail_make(fail_world *w, int variant) {
    hd_laplacian_opts o = fail_opts(w, variant);
    hd_laplacian *lap = rob_mark_lap;
    shape s = fail_shape();
    float xyz[3 * 21];
    const hd_mesh_view view = fail_view(&s, xyz);
    double lengths[3 * 64];
    int64_t ptr[64];
    int32_t nbr[21 * 12], k, j;
    hd_status st = HD_OK;
    CHECK(s.n_tri < 64);
    for (k = 0; k <= s.n_tri; k++) ptr[k] = 3 * k;
    switch (variant >> 8) {
    case 0: st = hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &w->e); break;
    case 1: st = hd_laplacian_view(&lap, &view, &o, &w->e); break;
    case 6: o.kind = HD_LAPLACIAN_FEM;           /* and on */
    /* fall through */
    case 2: st = hd_laplacian_polygons(&lap, s.xyz, s.n, ptr, s.tri, s.n_tri, &o, &w->e); break;
    case 3: st = hd_laplacian_points(&lap, s.xyz, s.n, &o, &w->e); break;
    case 4: st = hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &o, &w->e); break;
    case 5:
        for (k = 0; k <= s.n; k++) ptr[k] = 12 * k;
        for (k = 0; k < s.n; k++) for (j = 0; j < 12; j++) nbr[12 * k + j] = k < 12 ? j : 12 + j % 9;
        st = hd_laplacian_tufted_points(&lap, s.xyz, s.n, ptr, nbr, &o, &w->e);
        break;
    case 7:
        fail_lengths(&s, lengths);
        st = hd_laplacian_lengths(&lap, lengths, s.n, s.tri, s.n_tri, &o, &w->e);
        break;
    }
    CHECK((st >= 0) == (lap != rob_mark_lap));
    if (st >= 0) {
        fail_show_laplacian(w, lap);
        hd_laplacian_free(lap);
    }
    shape_free(&s);
    return st;
}

/* 1: full B; else diagonal. */
static hd_csr fail_matrix(int which, double diagonal) {
    hd_csr a = which == 1 ? test_path_csr(9, 1) : which == 2 ? test_diagonal_csr(9, NULL) : test_path_csr(9, 0);
    int64_t p;
    int32_t i;
    for (i = 0; which == 1 && i < 9; i++)
        for (p = a.row_ptr[i]; p < a.row_ptr[i + 1]; p++) a.val[p] = a.col[p] == i ? diagonal : 1;
    return a;
}

static hd_status fail_matrices(fail_world *w, int variant) {
    hd_laplacian_opts o = fail_opts(w, variant);
    hd_csr L = fail_matrix(0, 0), B = fail_matrix(variant & FAIL_EXP ? 1 : 2, 2.001);
    hd_status st;
    o.kind = HD_LAPLACIAN_DEFAULT;
    if (o.n_held) o.n_held = 1;                  /* there are nine vertices */
    st = hd_laplacian_matrices(&w->lap, &L, &B, 0.5, &o, &w->e);
    if (st >= 0) fail_show_laplacian(w, w->lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    return st;
}

static hd_status fail_make_matrices(fail_world *w, int variant) {
    const hd_status st = fail_matrices(w, variant);
    hd_laplacian_free(w->lap);
    w->lap = NULL;
    return st;
}

/* ---- updates ---- */

/* 0: xyz; 1: a view of floats; 2: own matrices with a B that has to be factorised. After a failure nothing has changed. */
static hd_status fail_update(fail_world *w, int variant) {
    const size_t size = (size_t)w->lap->L.nnz * sizeof(double);
    double before[600], xyz[3 * 21];
    float small[3 * 21];
    hd_mesh_view view;
    hd_csr L, B;
    hd_status st;
    int32_t k;
    CHECK(size <= sizeof before);
    memcpy(before, w->lap->L.val, size);
    for (k = 0; k < 3 * w->s.n; k++) xyz[k] = w->s.xyz[k] * (1 + 0.01 * (k % 5));
    if (variant == 0) st = hd_laplacian_update(w->lap, xyz, &w->e);
    else if (variant == 1) {
        view = fail_view(&w->s, small);
        st = hd_laplacian_update_view(w->lap, &view, &w->e);
    } else {
        L = fail_matrix(0, 0);
        B = fail_matrix(1, 2.002);
        for (k = 0; k < (int32_t)L.nnz; k++) L.val[k] *= 2;
        st = hd_laplacian_update_matrices(w->lap, &L, &B, 0.5, &w->e);
        hd_csr_free(&L, NULL);
        hd_csr_free(&B, NULL);
    }
    if (st < 0) CHECK(memcmp(before, w->lap->L.val, size) == 0);
    else fail_show_laplacian(w, w->lap);
    return st;
}

/* ---- plans ---- */

/* method, solver, preconditioner, Laplacian */
enum { FAIL_SOLVER = 4, FAIL_PRECOND = 64, FAIL_LAP = 1024 };

static hd_heat_opts fail_heat_opts(int variant) {
    hd_heat_opts o;
    memset(&o, 0, sizeof o);
    o.method = (hd_method)(variant & 3);
    o.solver = (hd_solver)(variant / FAIL_SOLVER % 8);
    o.precond = (hd_precond)(variant / FAIL_PRECOND % 8);
    return o;
}

static hd_status fail_plan(fail_world *w, int variant) {
    const hd_heat_opts o = fail_heat_opts(variant);
    const hd_status st = fail_triangles(w, variant / FAIL_LAP);
    return st < 0 ? st : hd_heat_create(&w->heat, w->lap, &o, &w->e);
}

static hd_status fail_create_plan(fail_world *w, int variant) {
    const hd_heat_opts o = fail_heat_opts(variant);
    hd_heat *heat = rob_mark_heat;
    const hd_status st = hd_heat_create(&heat, w->lap, &o, &w->e);
    CHECK((st >= 0) == (heat != rob_mark_heat));
    if (st >= 0) hd_heat_free(heat);
    w->n_out = 0;
    return st;
}

enum { FAIL_FIELDS, FAIL_COLUMNS, FAIL_COLUMN, FAIL_ENTRIES, FAIL_DERIVATIVE, FAIL_ADJOINT, FAIL_COLUMNS_FROM, FAIL_DIAGONAL, FAIL_DIAGONAL_K, FAIL_EDGES, FAIL_CLASSICAL, FAIL_WEIGHTED,
       FAIL_COMMUTE, FAIL_BIHARMONIC, FAIL_PAIRS, FAIL_PAIRS_WEIGHTED, FAIL_PAIRS_COMMUTE, FAIL_PAIRS_BIHARMONIC, FAIL_SAMPLE,
       FAIL_SAMPLE_COMMUTE, FAIL_LARGE, FAIL_LARGE_PAIRS, FAIL_TRACE, FAIL_NORMALISED, FAIL_INVARIANT, FAIL_DISTANCE_FROM, FAIL_ESTIMATE,
       FAIL_QUERIES };

/* A point in a face with a weight, and a curve across two edges. */
static void fail_sources(hd_source sources[2]) {
    static const int32_t point[6] = {0, 11, 5, 0, 5, 1}, curve[6] = {0, 11, 0, 5, 5, 1};
    static const double bary[6] = {0.25, 0.5, 0.25, 1, 0, 0}, weight[2] = {2, 0.5};
    memset(sources, 0, 2 * sizeof *sources);
    sources[0].count = 2;
    sources[0].corners = 3;
    sources[0].vertex = point;
    sources[0].bary = bary;
    sources[0].weight = weight;
    sources[1].count = 3;
    sources[1].corners = 2;
    sources[1].vertex = curve;
    sources[1].curve = 1;
}

/* What few eigenpairs serve where heat fades, as a variant of its own. */
enum { FAIL_FADING = 1000, FAIL_FADING_INSIDE = 1000, FAIL_FADING_COLUMNS, FAIL_FADING_ENTRIES, FAIL_FADING_DIAGONAL, FAIL_FADING_DIAGONAL_K,
       FAIL_FADING_EDGES, FAIL_FADING_TRACE, FAIL_FADING_ESTIMATE, FAIL_FADING_END };

/* So large a time that the plan asks whether only the means are left, and so many of that. */
enum { FAIL_HUGE = 2000 };

/* A variant above the list: many times. */
static hd_status fail_ask(fail_world *w, int variant) {
    static const int32_t id[6] = {0, 5, 13, 14, 2, 20}, other[6] = {3, 5, 1, 17, 20, 20};
    static const double f[21] = {1, 0, 2, 0, 0, 3, 0, -1, 0, 0, 4, 0, 0, 1, 0, 0, 0, 7, 0, 0, 1};
    const int q = variant % FAIL_HUGE % FAIL_QUERIES;
    const int32_t many = variant % FAIL_HUGE >= FAIL_QUERIES ? 3 : 1;
    hd_heat *const h = w->heat;
    double *const u = w->out;
    hd_report *const r = &w->rep;
    hd_error *const e = &w->e;
    double t[3] = {1, 7, 40};
    hd_estimate estimate;
    hd_source sources[2];
    int32_t vertex[6] = {4}, k;
    fail_sources(sources);
    for (k = 0; k < 3; k++) {
        t[k] *= w->lap->h * w->lap->h * (q == FAIL_LARGE || q == FAIL_LARGE_PAIRS ? 200 : 1);
        if (variant >= FAIL_HUGE) t[k] = (1 << k) * 3e8 / hd_laplacian_lambda_max(w->lap);
    }
    w->has_report = q != FAIL_ESTIMATE;
    w->n_out = (size_t)(21 * many);
    switch (q) {
    case FAIL_FIELDS: return hd_heat_apply(h, many, t, 1, f, 0, u, 0, r, e);
    case FAIL_COLUMNS: w->n_out *= 6; return hd_heat_columns(h, HD_KERNEL_SYMMETRIC, many, t, 6, id, u, 0, r, e);
    case FAIL_COLUMN: w->n_out = 21; return hd_heat_column(h, HD_KERNEL_OPERATOR, t[0], 3, u, r, e);
    case FAIL_ENTRIES: w->n_out = (size_t)(6 * many); return hd_heat_entries(h, HD_KERNEL_OPERATOR, many, t, 6, id, other, u, r, e);
    case FAIL_DERIVATIVE: return hd_heat_derivative(h, many, t, 1, f, 0, u, 0, r, e);
    case FAIL_ADJOINT: return hd_heat_adjoint(h, many, t, 1, f, 0, u, 0, r, e);
    case FAIL_COLUMNS_FROM: w->n_out *= 2; return hd_heat_columns_from(h, HD_KERNEL_SYMMETRIC, many, t, 2, sources, u, 0, r, e);
    case FAIL_TRACE: w->n_out = (size_t)(2 * many); return hd_heat_trace(h, many, t, u, u + many, r, e);
    case FAIL_NORMALISED: return hd_heat_normalised(h, many, t, u, 0, r, e);
    case FAIL_INVARIANT: w->n_out = 42; return hd_heat_scale_invariant(h, t[0], t[2], 3 + many, 2, u, 0, r, e);
    case FAIL_DISTANCE_FROM: w->n_out *= 2; return hd_heat_distance_from(h, HD_DISTANCE_CLASSICAL, many, t, 2, sources, u, 0, r, e);
    case FAIL_DIAGONAL: return hd_heat_diagonal(h, HD_KERNEL_SYMMETRIC, many, t, u, 0, r, e);
    case FAIL_DIAGONAL_K: return hd_heat_diagonal(h, HD_KERNEL_OPERATOR, many, t, u, 0, r, e);
    case FAIL_EDGES: w->n_out = (size_t)(w->lap->L.nnz * many); return hd_heat_edges(h, HD_KERNEL_SYMMETRIC, many, t, u, r, e);
    case FAIL_LARGE:
    case FAIL_CLASSICAL: w->n_out *= 3; return hd_heat_distance(h, HD_DISTANCE_CLASSICAL, many, t, 3, id, u, 0, r, e);
    case FAIL_WEIGHTED: return hd_heat_distance(h, HD_DISTANCE_WEIGHTED, many, t, 1, id, u, 0, r, e);
    case FAIL_COMMUTE: w->n_out = 42; return hd_heat_distance(h, HD_DISTANCE_COMMUTE, 0, NULL, 2, id, u, 0, r, e);
    case FAIL_BIHARMONIC: w->n_out = 42; return hd_heat_distance(h, HD_DISTANCE_BIHARMONIC, 0, NULL, 2, id, u, 0, r, e);
    case FAIL_LARGE_PAIRS:
    case FAIL_PAIRS: w->n_out = (size_t)(12 * many); return hd_heat_pairs(h, HD_DISTANCE_CLASSICAL, many, t, 6, id, other, u, u + 6 * many, r, e);
    case FAIL_PAIRS_WEIGHTED: w->n_out = 12; return hd_heat_pairs(h, HD_DISTANCE_WEIGHTED, 1, t, 6, id, other, u, u + 6, r, e);
    case FAIL_PAIRS_COMMUTE: w->n_out = 6; return hd_heat_pairs(h, HD_DISTANCE_COMMUTE, 0, NULL, 6, id, other, NULL, u, r, e);
    case FAIL_PAIRS_BIHARMONIC: w->n_out = 6; return hd_heat_pairs(h, HD_DISTANCE_BIHARMONIC, 0, NULL, 6, id, other, NULL, u, r, e);
    case FAIL_SAMPLE: w->n_out = 5; return hd_heat_sample(h, HD_DISTANCE_CLASSICAL, t[0], 5, 1, vertex, u, r, e);
    case FAIL_SAMPLE_COMMUTE: w->n_out = 5; return hd_heat_sample(h, HD_DISTANCE_COMMUTE, 0, 5, 1, vertex, u, r, e);
    default:
        w->n_out = 2;
        memset(&estimate, 0, sizeof estimate);
        k = hd_heat_estimate(h, HD_QUERY_COLUMNS, many, t, 100, &estimate, e);
        u[0] = estimate.cost[HD_METHOD_DIRECT].flops;
        u[1] = estimate.cost[HD_METHOD_ITERATIVE].flops;
        return (hd_status)k;
    }
}

static hd_status fail_fading(fail_world *w, int variant) {
    static const int32_t id[6] = {0, 5, 13, 14, 3, 20}, other[6] = {3, 5, 1, 17, 20, 20};
    const double unit = w->lap->h * w->lap->h, t[3] = {40 * unit, unit, 10 * unit};
    hd_heat *const h = w->heat;
    double *const u = w->out;
    hd_report *const r = &w->rep;
    hd_error *const e = &w->e;
    hd_estimate estimate;
    hd_status st;
    int32_t k;
    w->has_report = variant != FAIL_FADING_ESTIMATE;
    w->n_out = 63;
    switch (variant) {
    case FAIL_FADING_INSIDE:
        w->n_out = 21;
        for (k = 0; k < 21; k++) u[k] = 1 + k % 3;
        return hd_heat_apply(h, 1, t, 1, u, 0, u, 0, r, e);
    case FAIL_FADING_COLUMNS: w->n_out = 6 * 63; return hd_heat_columns(h, HD_KERNEL_SYMMETRIC, 3, t, 6, id, u, 0, r, e);
    case FAIL_FADING_ENTRIES: w->n_out = 18; return hd_heat_entries(h, HD_KERNEL_OPERATOR, 3, t, 6, id, other, u, r, e);
    case FAIL_FADING_DIAGONAL: return hd_heat_diagonal(h, HD_KERNEL_SYMMETRIC, 3, t, u, 0, r, e);
    case FAIL_FADING_DIAGONAL_K: return hd_heat_diagonal(h, HD_KERNEL_OPERATOR, 3, t, u, 0, r, e);
    case FAIL_FADING_EDGES: w->n_out = (size_t)(w->lap->L.nnz * 3); return hd_heat_edges(h, HD_KERNEL_SYMMETRIC, 3, t, u, r, e);
    case FAIL_FADING_TRACE: w->n_out = 3; return hd_heat_trace(h, 3, t, u, NULL, r, e);
    default:
        memset(&estimate, 0, sizeof estimate);
        st = hd_heat_estimate(h, HD_QUERY_DIAGONAL, 3, t, 0, &estimate, e);
        w->n_out = 1;
        u[0] = estimate.cost[HD_METHOD_DIRECT].flops;
        return st;
    }
}

/* The plan has answered once; then the surface moves, and the next answer is the one that fails. */
static hd_status fail_plan_moved(fail_world *w, int variant) {
    hd_status st = fail_plan(w, (variant & (FAIL_LAP - 1)) | FAIL_UPDATABLE * FAIL_LAP);
    if (st >= 0) st = fail_ask(w, variant / FAIL_LAP);
    if (st >= 0) st = fail_update(w, 0);
    return st;
}

/* Another filter for a plan, and a column through it. */
static hd_status fail_filter(fail_world *w, int variant) {
    const hd_filter_kind kind = variant ? HD_FILTER_RESOLVENT : HD_FILTER_HEAT;
    hd_filter f;
    hd_rational set;
    memset(&f, 0, sizeof f);
    f.kind = kind;
    f.a = 2;
    f.tol = 1e-6;
    CHECK(hd_rational_fit(&set, &f, hd_laplacian_lambda_max(w->lap), NULL, NULL) == HD_OK);
    w->n_out = 21;
    if (hd_heat_set_rational(w->heat, &set, &w->e) < 0) return w->e.status;
    w->has_report = 1;
    return hd_heat_column(w->heat, HD_KERNEL_SYMMETRIC, set.t, 3, w->out, &w->rep, &w->e);
}

/* Back to the exponential after a filter has been at work. */
static hd_status fail_unfilter(fail_world *w, int variant) {
    w->n_out = 21;
    if (hd_heat_set_rational(w->heat, NULL, &w->e) < 0) return w->e.status;
    return fail_ask(w, variant);
}

static hd_status fail_plan_filtered(fail_world *w, int variant) {
    const hd_status st = fail_plan(w, variant);
    return st < 0 ? st : fail_filter(w, 0);
}

static hd_status fail_times(fail_world *w, int variant) {
    static const double c[3] = {0.1, 1, 3};
    w->n_out = 3;
    return variant ? hd_times_spectral(w->lap, 3, c, w->out, &w->e) : hd_times_auto(w->lap, 3, w->out, &w->e);
}

static hd_status fail_shifted(fail_world *w, int variant) {
    hd_solve_opts o;
    hd_c64 x[21];
    hd_status st;
    memset(&o, 0, sizeof o);
    memset(x, 0, sizeof x);
    x[4] = test_c(1, -2);
    o.solver = (hd_solver)(variant % 4);
    o.precond = (hd_precond)(variant / 4);
    st = hd_shifted_solve(w->lap, 0.5, test_c(-1, 3), x, x, &o, NULL, &w->e);
    w->n_out = 42;
    memcpy(w->out, x, sizeof x);
    return st;
}

static hd_status fail_lap_apply(fail_world *w, int variant) {
    const double x[21] = {1, 2, 3};
    (void)variant;
    w->n_out = 21;
    return hd_laplacian_apply(w->lap, 1, 2, x, w->out, &w->e);
}

/* ---- eigenpairs ---- */

static hd_status fail_create_spectrum(fail_world *w, int variant) {
    hd_spectrum_opts o;
    hd_spectrum *const mark = (hd_spectrum *)&test_passed, *s = mark;
    hd_status st;
    memset(&o, 0, sizeof o);
    o.count = variant;
    if (!variant) o.below = 8;
    st = hd_spectrum_create(&s, w->lap, &o, &w->e);
    CHECK((st >= 0) == (s != mark));
    if (st < 0) return st;
    w->n_out = (size_t)s->count * 22;
    memcpy(w->out, s->value, (size_t)s->count * sizeof(double));
    memcpy(w->out + s->count, s->vector, 21 * (size_t)s->count * sizeof(double));
    hd_spectrum_free(s);
    return st;
}

static hd_status fail_spectrum(fail_world *w, int variant) {
    hd_spectrum_opts o;
    hd_status st = fail_triangles(w, variant);
    memset(&o, 0, sizeof o);
    o.count = 8;
    return st < 0 ? st : hd_spectrum_create(&w->spectrum, w->lap, &o, &w->e);
}

static hd_status fail_spectrum_ask(fail_world *w, int variant) {
    static const int32_t id[3] = {0, 5, 13};
    const double t[2] = {0.3, 2};
    double *const u = w->out, *const b = u + 200;
    w->n_out = 200 + 126;
    memset(u, 0, 200 * sizeof *u);
    switch (variant) {
    case 0: return hd_spectrum_columns(w->spectrum, HD_KERNEL_SYMMETRIC, 2, t, 3, id, u, b, 0, &w->e);
    case 1: w->n_out = 242; return hd_spectrum_diagonal(w->spectrum, HD_KERNEL_SYMMETRIC, 2, t, u, b, 0, &w->e);
    case 2: w->n_out = 242; return hd_spectrum_diagonal(w->spectrum, HD_KERNEL_OPERATOR, 2, t, u, b, 0, &w->e);
    case 3: return hd_spectrum_distance(w->spectrum, HD_DISTANCE_CLASSICAL, 2, t, 3, id, u, b, 0, &w->e);
    case 4: return hd_spectrum_distance(w->spectrum, HD_DISTANCE_WEIGHTED, 2, t, 3, id, u, b, 0, &w->e);
    case 5: w->n_out = 263; return hd_spectrum_distance(w->spectrum, HD_DISTANCE_COMMUTE, 0, NULL, 3, id, u, b, 0, &w->e);
    default: w->n_out = 263; return hd_spectrum_distance(w->spectrum, HD_DISTANCE_BIHARMONIC, 0, NULL, 3, id, u, b, 0, &w->e);
    }
}

/* ---- geodesic distance ---- */

/* 1: updatable, 2: voronoi, 4: a view, and: */
enum { FAIL_GEO_LENGTHS = 8, FAIL_GEO_POLYGONS = 16, FAIL_GEO_POINTS = 32, FAIL_GEO_MEAN = 64, FAIL_GEO_DELAUNAY = 128 };

static hd_status fail_geodesic_make(fail_world *w, int variant, hd_geodesic **g) {
    hd_geodesic_opts o;
    hd_mesh_view view;
    float xyz[3 * 21];
    double lengths[3 * 64];
    int64_t ptr[64];
    int32_t k;
    if (!w->s.xyz) w->s = fail_shape();
    CHECK(w->s.n_tri < 64);
    memset(&o, 0, sizeof o);
    o.context = &w->ctx;
    o.updatable = variant & 1;
    if (variant & 2) o.mass = HD_GEODESIC_MASS_VORONOI;
    if (variant & FAIL_GEO_MEAN) o.border = HD_GEODESIC_BORDER_MEAN;
    if (variant & FAIL_GEO_DELAUNAY) o.intrinsic_delaunay = 1;
    for (k = 0; k <= w->s.n_tri; k++) ptr[k] = 3 * k;
    fail_lengths(&w->s, lengths);
    if (variant & FAIL_GEO_LENGTHS) return hd_geodesic_create_lengths(g, lengths, w->s.n, w->s.tri, w->s.n_tri, &o, &w->e);
    if (variant & FAIL_GEO_POLYGONS) return hd_geodesic_create_polygons(g, w->s.xyz, w->s.n, ptr, w->s.tri, w->s.n_tri, &o, &w->e);
    if (variant & FAIL_GEO_POINTS) return hd_geodesic_create_points(g, w->s.xyz, w->s.n, NULL, NULL, &o, &w->e);
    if (~variant & 4) return hd_geodesic_create(g, w->s.xyz, w->s.n, w->s.tri, w->s.n_tri, &o, &w->e);
    view = fail_view(&w->s, xyz);
    return hd_geodesic_create_view(g, &view, &o, &w->e);
}

static hd_status fail_create_geodesic(fail_world *w, int variant) {
    hd_geodesic *const mark = (hd_geodesic *)&test_passed, *g = mark;
    const hd_status st = fail_geodesic_make(w, variant, &g);
    CHECK((st >= 0) == (g != mark));
    if (st >= 0) hd_geodesic_free(g);
    return st;
}

static hd_status fail_geodesic(fail_world *w, int variant) { return fail_geodesic_make(w, variant, &w->geodesic); }

static hd_status fail_geodesic_ask(fail_world *w, int variant) {
    static const int32_t id[6] = {0, 5, 13, 14, 2, 20};
    hd_geodesic_report rep;
    hd_source sources[2];
    double xyz[3 * 21];
    float small[3 * 21];
    hd_mesh_view view;
    hd_status st = HD_OK;
    int32_t k;
    if (variant == 2) {
        for (k = 0; k < 3 * w->s.n; k++) xyz[k] = w->s.xyz[k] * (1 + 0.01 * (k % 5));
        st = hd_geodesic_update(w->geodesic, xyz, &w->e);
    }
    if (variant == 3) {
        view = fail_view(&w->s, small);
        st = hd_geodesic_update_view(w->geodesic, &view, &w->e);
    }
    if (st < 0) return st;
    w->n_out = variant == 0 || variant >= 4 ? 21 : 126;
    fail_sources(sources);
    if (variant == 0) st = hd_geodesic_distance(w->geodesic, 4, id, w->out, &rep, &w->e);
    else if (variant >= 4) st = hd_geodesic_distance_from(w->geodesic, sources + variant - 4, w->out, &rep, &w->e);
    else st = hd_geodesic_distance_each(w->geodesic, 6, id, w->out, 0, &rep, &w->e);
    CHECK(rep.status == st && (st >= 0 || rep.error.status == st));
    return st;
}

/* ---- factorisations ---- */

static hd_ldl_opts fail_ldl_opts(fail_world *w, int variant) {
    static const int32_t perm[21] = {20, 19, 18, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
    hd_ldl_opts o;
    memset(&o, 0, sizeof o);
    o.ordering = (hd_ordering)(variant % 4);
    o.perm = perm;
    o.xyz = w->s.xyz;
    o.context = &w->ctx;
    return o;
}

/* L of the two pieces with something on the diagonal. */
static void fail_ldl_values(fail_world *w) {
    hd_laplacian *lap;
    int64_t p;
    int32_t i;
    w->s = fail_shape();
    lap = test_laplacian(&w->s, HD_LAPLACIAN_FEM);
    CHECK(hd_csr_transpose(&w->a, &lap->L, NULL, NULL) == HD_OK);
    for (i = 0; i < 21; i++) for (p = w->a.row_ptr[i]; p < w->a.row_ptr[i + 1]; p++) w->a.val[p] += w->a.col[p] == i;
    hd_laplacian_free(lap);
}

static hd_status fail_ldl_pattern(fail_world *w, int variant) {
    (void)variant;
    fail_ldl_values(w);
    return HD_OK;
}

static hd_status fail_analyse(fail_world *w, int variant) {
    const hd_ldl_opts o = fail_ldl_opts(w, variant);
    hd_ldl *const mark = (hd_ldl *)&test_passed, *f = mark;
    const hd_status st = hd_ldl_analyse(&f, &w->a, &o, NULL, &w->e);
    CHECK((st >= 0) == (f != mark));
    if (st >= 0) hd_ldl_free(f);
    return st;
}

static hd_status fail_complex(fail_world *w, int32_t k) {
    hd_c64 val[600];
    int64_t p;
    CHECK(k * w->a.nnz <= 600);
    for (p = 0; p < k * w->a.nnz; p++) val[p] = test_c(w->a.val[p % w->a.nnz], 0.25 * (double)(p / w->a.nnz));
    return hd_ldl_factor_complex(w->ldl, k, val, NULL, &w->e);
}

/* variant: ordering + 4 (0 analysed, 1 factorised, 2 complex). */
static hd_status fail_ldl(fail_world *w, int variant) {
    hd_ldl_opts o;
    hd_status st;
    fail_ldl_values(w);
    o = fail_ldl_opts(w, variant);
    st = hd_ldl_analyse(&w->ldl, &w->a, &o, NULL, &w->e);
    if (st >= 0 && variant / 4 == 1) st = hd_ldl_factor(w->ldl, w->a.val, NULL, &w->e);
    if (st >= 0 && variant / 4 == 2) st = fail_complex(w, 3);
    return st;
}

static hd_status fail_ldl_ask(fail_world *w, int variant) {
    static const int32_t i[4] = {0, 5, 13, 20}, j[4] = {1, 5, 20, 13};
    double *const x = w->out;
    hd_c64 b[63], z[63 + 600];
    hd_status st = HD_OK;
    int32_t k;
    for (k = 0; k < 63; k++) {
        b[k] = test_c(k % 5, 1);
        x[k + 600] = k % 7;
    }
    memset(z, 0, sizeof z);
    w->n_out = 0;
    switch (variant) {
    case 0: return hd_ldl_factor(w->ldl, w->a.val, NULL, &w->e);
    case 1: return fail_complex(w, 3);
    case 2: w->n_out = 63; return hd_ldl_solve(w->ldl, 3, x + 600, 0, x, 0, &w->e);
    case 3: w->n_out = (size_t)w->a.nnz + 21; return hd_ldl_inverse(w->ldl, x, x + w->a.nnz, &w->e);
    case 4: w->n_out = 4; return hd_ldl_inverse_entries(w->ldl, 4, i, j, x, &w->e);
    case 5: st = hd_ldl_solve_complex(w->ldl, b, 21, z, 0, &w->e); break;
    case 6: st = hd_ldl_inverse_complex(w->ldl, z, z + 3 * w->a.nnz, &w->e); break;
    default: st = hd_ldl_inverse_entries_complex(w->ldl, 4, i, j, z, &w->e); break;
    }
    w->n_out = 2 * (sizeof z / sizeof *z);
    memcpy(x, z, sizeof z);
    return st;
}

/* ---- matrices, neighbours, poles ---- */

static hd_status fail_small(fail_world *w, int variant) {
    static const int32_t i[7] = {3, 1, 0, 6, 5, 2, 4};
    hd_csr a = test_path_csr(7, 1), out, before;
    shape s = fail_shape();
    const double t[5] = {1, 2, 5, 30, 90};
    hd_rational sets[5];
    hd_filter filter;
    int32_t index[100];
    hd_status st = HD_OK;
    memset(&out, 0x6b, sizeof out);
    before = out;
    w->n_out = 0;
    switch (variant) {
    case 0: st = hd_csr_from_triplets(&out, 7, 7, 7, i, i, a.val, &w->ctx, &w->e); break;
    case 1: st = hd_csr_transpose(&out, &a, &w->ctx, &w->e); break;
    case 2: st = hd_csr_product(&out, &a, &a, &w->ctx, &w->e); break;
    case 3: st = hd_csr_permute(&out, &a, i, &w->ctx, &w->e); break;
    case 4: st = hd_neighbours_radius(&out, s.xyz, s.n, NULL, 0, 1.2, &w->ctx, &w->e); break;
    case 5: st = hd_csr_check(&a, 1, &w->ctx, &w->e); break;
    case 6: w->n_out = 84; st = hd_neighbours_nearest(s.xyz, s.n, NULL, 0, 4, index, w->out, &w->ctx, &w->e); break;
    case 8:
        memset(&filter, 0, sizeof filter);
        filter.kind = HD_FILTER_WAVE;
        filter.b = 2;
        filter.tol = 1e-4;
        st = hd_rational_fit(sets, &filter, 100, &w->ctx, &w->e);
        if (st >= 0) {
            w->n_out = sizeof *sets / sizeof(double);
            memcpy(w->out, sets, sizeof *sets);
        }
        break;
    default:
        st = hd_rational_shared(sets, 5, t, 1e-6, &w->ctx, &w->e);
        if (st >= 0) {
            w->n_out = 5 * (sizeof *sets / sizeof(double));
            memcpy(w->out, sets, sizeof sets);
        }
        break;
    }
    if (st < 0 || variant >= 5) CHECK(memcmp(&out, &before, sizeof out) == 0);
    else {
        w->n_out = (size_t)out.nnz;
        memcpy(w->out, out.val, (size_t)out.nnz * sizeof(double));
        hd_csr_free(&out, &w->ctx);
    }
    hd_csr_free(&a, NULL);
    shape_free(&s);
    return st;
}

/* ---- the cases ---- */

enum { FAIL_COCG = 1 + 4 * 1, FAIL_COCR = 1 + 4 * 2, FAIL_MINRES = 1 + 4 * 3, FAIL_LANCZOS = 1 + 4 * 4, FAIL_DIRECT = 2, FAIL_KRYLOV = 3 };

static const fail_case fail_cases[] = {
    {"triangles", NULL, fail_make, 0, 0, 0},
    {"triangles, voronoi, updatable", NULL, fail_make, 0, FAIL_VORONOI | FAIL_UPDATABLE, 0},
    {"triangles, held, updatable", NULL, fail_make, 0, FAIL_HELD | FAIL_BORDER | FAIL_UPDATABLE, 0},
    {"triangles, held", NULL, fail_make, 0, FAIL_HELD | FAIL_BORDER, 0},
    {"delaunay", NULL, fail_make, 0, FAIL_DELAUNAY, 0},
    {"delaunay, held", NULL, fail_make, 0, FAIL_DELAUNAY | FAIL_HELD | FAIL_BORDER | FAIL_VORONOI, 0},
    {"tufted", NULL, fail_make, 0, FAIL_TUFTED, 0},
    {"tufted, held", NULL, fail_make, 0, FAIL_TUFTED | FAIL_HELD, 0},
    {"view", NULL, fail_make, 0, FAIL_BY_VIEW, 0},
    {"view, held, updatable", NULL, fail_make, 0, FAIL_BY_VIEW | FAIL_HELD | FAIL_UPDATABLE, 0},
    {"polygons", NULL, fail_make, 0, FAIL_BY_POLYGONS, 0},
    {"polygons, held, updatable", NULL, fail_make, 0, FAIL_BY_POLYGONS | FAIL_HELD | FAIL_BORDER | FAIL_UPDATABLE, 0},
    {"polygons, fem", NULL, fail_make, 0, FAIL_BY_FANS | FAIL_UPDATABLE, 0},
    {"polygons, delaunay", NULL, fail_make, 0, FAIL_BY_FANS | FAIL_DELAUNAY, 0},
    {"points", NULL, fail_make, 0, FAIL_BY_POINTS, 0},
    {"points, held", NULL, fail_make, 0, FAIL_BY_POINTS | FAIL_HELD, 0},
    {"points, exp", NULL, fail_make, 0, FAIL_BY_POINTS | FAIL_EXP, 0},
    {"tufted points", NULL, fail_make, 0, FAIL_BY_TUFTED_POINTS | FAIL_HELD, 0},
    {"tufted points, own neighbours", NULL, fail_make, 0, FAIL_BY_NEIGHBOURS, 0},
    {"lengths", NULL, fail_make, 0, FAIL_BY_LENGTHS, 0},
    {"lengths, held", NULL, fail_make, 0, FAIL_BY_LENGTHS | FAIL_HELD | FAIL_BORDER | FAIL_VORONOI, 0},
    {"lengths, delaunay", NULL, fail_make, 0, FAIL_BY_LENGTHS | FAIL_DELAUNAY, 0},
    {"lengths, tufted", NULL, fail_make, 0, FAIL_BY_LENGTHS | FAIL_TUFTED, 0},
    {"matrices", NULL, fail_make_matrices, 0, FAIL_UPDATABLE, 0},
    {"matrices, full B, held", NULL, fail_make_matrices, 0, FAIL_EXP | FAIL_HELD, 0},
    {"update", fail_triangles, fail_update, FAIL_UPDATABLE, 0, 0},
    {"update, held", fail_triangles, fail_update, FAIL_UPDATABLE | FAIL_HELD | FAIL_BORDER, 0, 0},
    {"update, view", fail_triangles, fail_update, FAIL_UPDATABLE, 1, 0},
    {"update, matrices", fail_matrices, fail_update, FAIL_UPDATABLE | FAIL_EXP, 2, 0},
    {"apply", fail_triangles, fail_lap_apply, 0, 0, 0},
    {"shifted, cocg", fail_triangles, fail_shifted, 0, 1 + 4 * 5, 0},
    {"shifted, cocr", fail_triangles, fail_shifted, 0, 2 + 4 * 3, 0},
    {"shifted, minres", fail_triangles, fail_shifted, FAIL_HELD, 3 + 4 * 4, 0},
    {"plan", fail_triangles, fail_create_plan, 0, 0, 0},
    {"plan, direct", fail_triangles, fail_create_plan, FAIL_HELD, 2, 0},
    {"filter", fail_plan, fail_filter, FAIL_DIRECT, 0, 0},
    {"filter, cocg", fail_plan, fail_filter, FAIL_COCG, 1, 1},
    {"filter after another", fail_plan_filtered, fail_filter, FAIL_DIRECT, 1, FAIL_GOES_ON},
    {"heat after a filter", fail_plan_filtered, fail_unfilter, FAIL_DIRECT, FAIL_COLUMNS, FAIL_GOES_ON},
    {"times", fail_triangles, fail_times, 0, 0, 0},
    {"times by eigenvalues", fail_triangles, fail_times, FAIL_HELD, 1, 0},
    {"eigenpairs", fail_triangles, fail_create_spectrum, 0, 8, 0},
    {"eigenpairs, all", fail_triangles, fail_create_spectrum, FAIL_VORONOI, 21, 0},
    {"eigenpairs, held", fail_triangles, fail_create_spectrum, FAIL_HELD, 5, 0},
    {"eigenpairs, below", fail_triangles, fail_create_spectrum, 0, 0, 0},
    {"eigenpairs, columns", fail_spectrum, fail_spectrum_ask, 0, 0, 0},
    {"eigenpairs, diagonal", fail_spectrum, fail_spectrum_ask, 0, 1, 0},
    {"eigenpairs, diagonal of K", fail_spectrum, fail_spectrum_ask, 0, 2, 0},
    {"eigenpairs, distance", fail_spectrum, fail_spectrum_ask, FAIL_HELD, 3, 0},
    {"eigenpairs, weighted", fail_spectrum, fail_spectrum_ask, 0, 4, 0},
    {"eigenpairs, commute", fail_spectrum, fail_spectrum_ask, 0, 5, 0},
    {"eigenpairs, biharmonic", fail_spectrum, fail_spectrum_ask, FAIL_VORONOI, 6, 0},
    {"geodesic", NULL, fail_create_geodesic, 0, 0, 0},
    {"geodesic, updatable, voronoi", NULL, fail_create_geodesic, 0, 3, 0},
    {"geodesic, view", NULL, fail_create_geodesic, 0, 4, 0},
    {"geodesic, lengths, mean border", NULL, fail_create_geodesic, 0, FAIL_GEO_LENGTHS | FAIL_GEO_MEAN, 0},
    {"geodesic, polygons", NULL, fail_create_geodesic, 0, FAIL_GEO_POLYGONS, 0},
    {"geodesic, polygons, delaunay", NULL, fail_create_geodesic, 0, FAIL_GEO_POLYGONS | FAIL_GEO_DELAUNAY, 0},
    {"geodesic, points", NULL, fail_create_geodesic, 0, FAIL_GEO_POINTS, 0},
    {"geodesic, point", fail_geodesic, fail_geodesic_ask, 0, 4, 0},
    {"geodesic, curve, mean border", fail_geodesic, fail_geodesic_ask, FAIL_GEO_MEAN, 5, 0},
    {"geodesic, curve, lengths", fail_geodesic, fail_geodesic_ask, FAIL_GEO_LENGTHS | FAIL_GEO_DELAUNAY, 5, 0},
    {"geodesic, polygons, columns", fail_geodesic, fail_geodesic_ask, FAIL_GEO_POLYGONS, 1, 0},
    {"geodesic, points, set", fail_geodesic, fail_geodesic_ask, FAIL_GEO_POINTS, 0, 0},
    {"geodesic, set", fail_geodesic, fail_geodesic_ask, 0, 0, 0},
    {"geodesic, columns", fail_geodesic, fail_geodesic_ask, 2, 1, 0},
    {"geodesic, update", fail_geodesic, fail_geodesic_ask, 1, 2, 0},
    {"geodesic, update, view", fail_geodesic, fail_geodesic_ask, 1, 3, 0},
    {"ldl, analyse", fail_ldl_pattern, fail_analyse, 0, 0, 0},
    {"ldl, dissection", fail_ldl_pattern, fail_analyse, 0, 2, 0},
    {"ldl, own", fail_ldl_pattern, fail_analyse, 0, 3, 0},
    {"ldl, factor", fail_ldl, fail_ldl_ask, 0, 0, 0},
    {"ldl, factor after complex", fail_ldl, fail_ldl_ask, 8, 0, 0},
    {"ldl, complex", fail_ldl, fail_ldl_ask, 2, 1, 0},
    {"ldl, solve", fail_ldl, fail_ldl_ask, 4, 2, 0},
    {"ldl, inverse", fail_ldl, fail_ldl_ask, 4, 3, 0},
    {"ldl, entries", fail_ldl, fail_ldl_ask, 6, 4, 0},
    {"ldl, complex solve", fail_ldl, fail_ldl_ask, 8, 5, 0},
    {"ldl, complex inverse", fail_ldl, fail_ldl_ask, 8, 6, 0},
    {"ldl, complex entries", fail_ldl, fail_ldl_ask, 10, 7, 0},
    {"triplets", NULL, fail_small, 0, 0, 0},
    {"transpose", NULL, fail_small, 0, 1, 0},
    {"product", NULL, fail_small, 0, 2, 0},
    {"permute", NULL, fail_small, 0, 3, 0},
    {"radius", NULL, fail_small, 0, 4, 0},
    {"check", NULL, fail_small, 0, 5, 0},
    {"nearest", NULL, fail_small, 0, 6, 0},
    {"shared poles", NULL, fail_small, 0, 7, 0},
    {"fit", NULL, fail_small, 0, 8, 0},
};

enum { FAIL_CASES = sizeof fail_cases / sizeof *fail_cases };

/* ---- one case ---- */

static void fail_begin(fail_world *w, const fail_case *c) {
    memset(w, 0, sizeof *w);
    w->ctx = test_memory_context(&w->m);
    w->ctx.n_threads = 1;
    if (c->prepare) CHECK_MSG(c->prepare(w, c->prepare_variant) >= 0, "%s: %s", c->name, w->e.text);
    memset(&w->e, 0, sizeof w->e);
    w->has_report = 0;
}

static void fail_end(fail_world *w, const fail_case *c) {
    w->ctx.progress = NULL;
    hd_heat_free(w->heat);
    hd_spectrum_free(w->spectrum);
    hd_geodesic_free(w->geodesic);
    hd_ldl_free(w->ldl);
    hd_laplacian_free(w->lap);
    hd_csr_free(&w->a, NULL);
    shape_free(&w->s);
    test_memory_done(&w->m, &w->ctx, c->name);
}

/* The call, with its error and report looked at. */
static hd_status fail_call(fail_world *w, const fail_case *c) {
    hd_status st;
    memset(w->out, 0, sizeof w->out);
    memset(&w->rep, 0, sizeof w->rep);
    st = c->call(w, c->variant);
    CHECK_MSG(w->e.status == (st < 0 ? st : HD_OK) && (st >= 0 || w->e.text[0]), "%s: %s, but the error says %s", c->name, hd_status_name(st), hd_status_name(w->e.status));
    if (w->has_report) CHECK_MSG(w->rep.status == st && (st >= 0 || w->rep.error.status == st), "%s: the report says %s", c->name, hd_status_name(w->rep.status));
    return st;
}

/* What a clean call does. */
typedef struct fail_want {
    double out[2048];
    double again[2048];         /* by a second call, which may use what the first one kept */
    size_t n_out;
    int64_t calls, progress;
    uint64_t before, after, peak;
    uint64_t after_again;
    double bound;
} fail_want;

static void fail_clean(fail_world *w, const fail_case *c, fail_want *want) {
    fail_begin(w, c);
    want->before = w->ctx.bytes_in_use;
    want->calls = w->m.calls;
    w->ctx.bytes_peak = w->ctx.bytes_in_use;
    w->ctx.progress = rob_on_progress;
    w->ctx.progress_user = &w->p;
    CHECK_MSG(fail_call(w, c) >= 0, "%s: %s", c->name, w->e.text);
    want->calls = w->m.calls - want->calls;
    want->progress = w->p.calls;
    want->after = w->ctx.bytes_in_use;
    want->peak = w->ctx.bytes_peak;
    want->n_out = w->n_out;
    want->bound = w->rep.error_bound;
    memcpy(want->out, w->out, w->n_out * sizeof *w->out);
    CHECK_MSG(fail_call(w, c) >= 0 && w->n_out == want->n_out && (c->goes_on == FAIL_DEPENDS || memcmp(w->out, want->out, w->n_out * sizeof *w->out) == 0),
              "%s: the second time other bits", c->name);
    memcpy(want->again, w->out, w->n_out * sizeof *w->out);
    want->after_again = w->ctx.bytes_in_use;
    fail_end(w, c);
}

/* How far two answers are apart, relative to the largest value. */
static double fail_far(const double *a, const double *b, size_t n) {
    double most = 0, far = 0;
    size_t k;
    for (k = 0; k < n; k++) {
        if (a[k] == b[k]) continue;              /* both infinite, too */
        far = fmax(far, fabs(a[k] - b[k]));
        most = fmax(most, fabs(b[k]));
    }
    return most > 0 ? far / most : far;
}

/* Do they agree within their bounds, each relative to its largest value? */
static int fail_agree(const double *a, const double *b, size_t n, double bound_a, double bound_b) {
    double most_a = 0, most_b = 0;
    size_t k;
    int ok = 1;
    for (k = 0; k < n; k++) {
        most_a = fmax(most_a, fabs(a[k]));
        most_b = fmax(most_b, fabs(b[k]));
    }
    for (k = 0; k < n; k++) ok &= a[k] == b[k] || fabs(a[k] - b[k]) <= bound_a * most_a + bound_b * most_b;
    return ok;
}

/* After a failure: what is in use is not more than an answer leaves; asked again, the same bits and bytes. */
static void fail_recover(fail_world *w, const fail_case *c, const fail_want *want, const char *how, int64_t k) {
    hd_status st;
    w->m.fail_at = 0;
    w->m.fail_one_in = 0;
    w->ctx.progress = NULL;
    w->ctx.byte_limit = 0;
    CHECK_MSG(c->prepare || w->ctx.bytes_in_use == want->before, "%s: %s %lld leaves %llu bytes", c->name, how, (long long)k,
              (unsigned long long)(w->ctx.bytes_in_use - want->before));
    st = fail_call(w, c);
    CHECK_MSG(st >= 0 && w->n_out == want->n_out, "%s: after %s %lld: %s %s", c->name, how, (long long)k, hd_status_name(st), w->e.text);
    if (memcmp(w->out, want->out, w->n_out * sizeof *w->out) == 0 || memcmp(w->out, want->again, w->n_out * sizeof *w->out) == 0) {
        CHECK_MSG(c->goes_on || w->ctx.bytes_in_use == want->after || w->ctx.bytes_in_use == want->after_again, "%s: after %s %lld: %llu bytes in use, not %llu",
                  c->name, how, (long long)k, (unsigned long long)w->ctx.bytes_in_use, (unsigned long long)want->after);
    } else {
        CHECK_MSG(c->goes_on == FAIL_DEPENDS && w->has_report && fail_agree(w->out, want->out, w->n_out, w->rep.error_bound, want->bound),
                  "%s: after %s %lld: other bits, off by %g, where bounds are %g and %g", c->name, how, (long long)k, fail_far(w->out, want->out, w->n_out),
                  w->rep.error_bound, want->bound);
        CHECK_MSG(w->rep.error_bound <= fmax(2 * want->bound, 1e-6), "%s: after %s %lld: bound %g, not %g", c->name, how, (long long)k, w->rep.error_bound,
                  want->bound);
    }
    fail_end(w, c);
}

static void fail_each_allocation(fail_world *w, const fail_case *c, const fail_want *want) {
    int64_t k;
    hd_status st;
    for (k = 1; k <= want->calls; k++) {
        fail_begin(w, c);
        w->m.fail_at = w->m.calls + k;
        st = fail_call(w, c);
        CHECK_MSG(st == HD_ERR_MEMORY, "%s: allocation %lld failed, but %s", c->name, (long long)k, hd_status_name(st));
        fail_memory++;
        fail_recover(w, c, want, "failed allocation", k);
    }
}

static void fail_at_random(fail_world *w, const fail_case *c, const fail_want *want) {
    int64_t k;
    hd_status st;
    for (k = 1; k <= 12; k++) {
        fail_begin(w, c);
        w->m.random = (uint32_t)k * 2654435761u;
        w->m.fail_one_in = 2 + (want->calls >> (k % 4));
        st = fail_call(w, c);
        CHECK_MSG(st == HD_ERR_MEMORY || st >= 0, "%s: at random %lld, but %s", c->name, (long long)k, hd_status_name(st));
        fail_random += w->m.failed;
        CHECK_MSG(st < 0 || w->m.failed == 0, "%s: at random %lld, but %s", c->name, (long long)k, hd_status_name(st));
        fail_recover(w, c, want, "failures at random", k);
    }
}

static void fail_each_progress(fail_world *w, const fail_case *c, const fail_want *want) {
    int64_t k;
    hd_status st;
    for (k = 1; k <= want->progress; k++) {
        fail_begin(w, c);
        w->p.stop_at = k;
        w->p.answer = HD_PROGRESS_CANCEL;
        w->ctx.progress = rob_on_progress;
        w->ctx.progress_user = &w->p;
        st = fail_call(w, c);
        CHECK_MSG(st == HD_ERR_CANCELLED, "%s: cancelled at %lld, but %s", c->name, (long long)k, hd_status_name(st));
        CHECK_MSG(w->p.calls == k, "%s: cancelled at %lld, but asked %lld times", c->name, (long long)k, (long long)w->p.calls);
        fail_cancelled++;
        fail_recover(w, c, want, "cancelling", k);
    }
}

/* Limits to the byte: what it took suffices; a byte less does not, or leads another way that keeps to the limit. */
static void fail_limits(fail_world *w, const fail_case *c, const fail_want *want) {
    uint64_t limit;
    hd_status st;
    int k;
    for (k = 0; k < 8; k++) {
        limit = k == 0 ? want->peak : k == 1 ? want->peak - 1 : want->before + (want->peak - want->before) * (uint64_t)(8 - k) / 7;
        if (want->peak == want->before || limit <= want->before) continue;
        fail_begin(w, c);
        w->ctx.byte_limit = limit;
        w->ctx.bytes_peak = w->ctx.bytes_in_use;
        st = fail_call(w, c);
        CHECK_MSG(w->ctx.bytes_peak <= limit, "%s: %llu bytes under a limit of %llu", c->name, (unsigned long long)w->ctx.bytes_peak, (unsigned long long)limit);
        if (k == 0) CHECK_MSG(st >= 0, "%s: a limit of its own peak: %s", c->name, w->e.text);
        else if (limit < want->peak) CHECK_MSG(st == HD_ERR_MEMORY_LIMIT || (c->goes_on && st >= 0), "%s: limit %llu of %llu, but %s", c->name, (unsigned long long)limit,
                       (unsigned long long)want->peak, hd_status_name(st));
        fail_limited += st < 0;
        fail_recover(w, c, want, "limit", (int64_t)limit);
    }
}

static void fail_run(const fail_case *c) {
    static fail_world w;
    static fail_want want;
    fail_clean(&w, c, &want);
    CHECK_MSG(want.n_out <= 2048, "%s", c->name);
    fail_each_allocation(&w, c, &want);
    fail_at_random(&w, c, &want);
    fail_each_progress(&w, c, &want);
    fail_limits(&w, c, &want);
}

/* Documented: under a byte limit preconditioners are made in turns, an estimate guesses where the analysis does not fit,
 * auto takes iterations, times do without shared poles, and fields take the fewest poles. Distances may come from
 * eigenpairs or from poles, by what the plan has. */
static int fail_goes_on(int way, int query) {
    if (way <= 3 || query == FAIL_ESTIMATE || query == FAIL_CLASSICAL || query == FAIL_WEIGHTED || query == FAIL_PAIRS ||
        query == FAIL_PAIRS_WEIGHTED || query == FAIL_SAMPLE || query == FAIL_LARGE || query == FAIL_LARGE_PAIRS ||
        query == FAIL_DISTANCE_FROM || query == FAIL_INVARIANT)
        return FAIL_DEPENDS;
    return way == 5 ? FAIL_GOES_ON : FAIL_TELLS;
}

/* Every query by every method that answers it. */
static void fail_queries(void) {
    static const struct { int method; const char *name; } ways[7] = {
        {0, "auto"}, {FAIL_COCG, "cocg"}, {FAIL_COCR, "cocr"}, {FAIL_MINRES, "minres"}, {FAIL_LANCZOS, "lanczos"}, {FAIL_DIRECT, "direct"}, {FAIL_KRYLOV, "krylov"}};
    static const int laplacians[3] = {0, FAIL_VORONOI, FAIL_HELD | FAIL_BORDER};
    char name[64];
    fail_case c;
    int way, q;
    c.name = name;
    c.call = fail_ask;
    for (way = 0; way < 7; way++) {
        for (q = 0; q < 2 * FAIL_QUERIES; q++) {
            const int query = q % FAIL_QUERIES, direct = way == 0 || way == 5;
            if (query >= FAIL_DIAGONAL && query != FAIL_ESTIMATE && !direct && query != FAIL_PAIRS) continue;
            /* what these three add is the same for all solvers of poles */
            if ((way == 2 || way == 3) && query >= FAIL_DERIVATIVE && query <= FAIL_COLUMNS_FROM) continue;
            c.variant = q;
            c.prepare = fail_plan;
            c.prepare_variant = ways[way].method + FAIL_LAP * laplacians[(q + way) % 3];
            c.goes_on = fail_goes_on(way, query);
            snprintf(name, sizeof name, "%s, query %d, Laplacian %d", ways[way].name, q, laplacians[(q + way) % 3]);
            fail_run(&c);
            if (query == FAIL_ESTIMATE) continue;
            c.variant = FAIL_HUGE + q;
            c.prepare_variant = ways[way].method + FAIL_LAP * laplacians[(q + way) % 2];
            snprintf(name, sizeof name, "%s, query %d, Laplacian %d, endless", ways[way].name, q, laplacians[(q + way) % 2]);
            if (direct) fail_run(&c);
            if (q >= FAIL_QUERIES) continue;
            c.variant = q;
            c.prepare = fail_plan_moved;
            c.prepare_variant = ways[way].method + FAIL_LAP * q;
            snprintf(name, sizeof name, "%s, query %d after a move", ways[way].name, q);
            fail_run(&c);
        }
    }
}

static void fail_fading_queries(void) {
    static const int laplacians[2] = {FAIL_HELD, FAIL_HELD | FAIL_BORDER | FAIL_VORONOI};
    char name[64];
    fail_case c;
    int q, w;
    memset(&c, 0, sizeof c);
    c.name = name;
    c.prepare = fail_plan;
    c.call = fail_fading;
    c.goes_on = FAIL_DEPENDS;                    /* with poles */
    for (q = FAIL_FADING; q < FAIL_FADING_END; q++)
        for (w = 0; w < 2; w++) {
            c.variant = q;
            c.prepare_variant = FAIL_LAP * laplacians[w];
            snprintf(name, sizeof name, "fading, query %d, Laplacian %d", q, laplacians[w]);
            fail_run(&c);
        }
}

/* What the allocation limit says is what suffices, one more each time. */
static void fail_allocation_limit(void) {
    shape s = fail_shape();
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_context ctx;
    hd_status st = HD_ERR_MEMORY_LIMIT;
    hd_error e;
    uint64_t count = 0;
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    o.context = &ctx;
    for (ctx.allocation_limit = 1; st == HD_ERR_MEMORY_LIMIT && count < 1000; count++) {
        ctx.allocations = 0;
        st = hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &o, &e);
        if (st == HD_ERR_MEMORY_LIMIT && !CHECK_MSG(e.value == (double)(ctx.allocation_limit + 1) && strstr(e.text, "allocation"), "%s: %g", e.text, e.value)) break;
        ctx.allocation_limit = (uint64_t)e.value;
    }
    CHECK_MSG(st == HD_OK && count == ctx.allocations, "%s after %d", hd_status_name(st), (int)count);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* All eigenpairs, no time and endless times: neither a value nor a bound is NaN (0 times infinity), and the values are
 * those in closed form. */
static void fail_spectrum_ends(void) {
    static const double times[4] = {0, 1, 1e300, DBL_MAX};
    static const int32_t id[2] = {0, 13};
    fail_world w;
    hd_spectrum_opts o;
    double u[21 * 8], b[21 * 8];
    int32_t k;
    memset(&w, 0, sizeof w);
    memset(&o, 0, sizeof o);
    CHECK(fail_triangles(&w, FAIL_VORONOI) == HD_OK);
    o.count = w.lap->n_active;
    CHECK(hd_spectrum_create(&w.spectrum, w.lap, &o, NULL) >= 0 && w.spectrum->next >= HUGE_VAL);
    CHECK(hd_spectrum_columns(w.spectrum, HD_KERNEL_OPERATOR, 4, times, 2, id, u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 8; k++) CHECK_MSG(fabs(u[k]) <= 1.0001 && b[k] >= 0 && b[k] < 1e-6, "%d: %g, bound %g", (int)k, u[k], b[k]);
    for (k = 0; k < 21; k++) CHECK_MSG(fabs(u[k] - (k == 0)) < 1e-9 && fabs(u[84 + k] - (k == 13)) < 1e-9, "t = 0, vertex %d: %g, %g", (int)k, u[k], u[84 + k]);
    CHECK(hd_spectrum_diagonal(w.spectrum, HD_KERNEL_OPERATOR, 4, times, u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 4; k++) CHECK_MSG(u[k] >= 0 && u[k] <= 1.0001 && b[k] >= 0 && b[k] < 1e-6, "%d: %g, bound %g", (int)k, u[k], b[k]);
    CHECK(hd_spectrum_distance(w.spectrum, HD_DISTANCE_CLASSICAL, 3, times + 1, 2, id, u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 6; k++) CHECK_MSG(u[k] >= 0 && u[k] < 100 && b[k] >= 0, "%d: %g, bound %g", (int)k, u[k], b[k]);
    for (k = 0; k < 12; k++) CHECK_MSG(u[42 + k] < 1e-9, "one value on the component, at vertex %d: %g", (int)k, u[42 + k]);
    CHECK(hd_spectrum_distance(w.spectrum, HD_DISTANCE_BIHARMONIC, 0, NULL, 2, id, u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 2; k++) CHECK_MSG(u[k] >= 0 && b[k] >= 0, "%d: %g, bound %g", (int)k, u[k], b[k]);
    hd_spectrum_free(w.spectrum);
    hd_laplacian_free(w.lap);
    shape_free(&w.s);
}

/* Points so far apart that squares of distances overflow have no neighbours: an error or an answer, and no harm. */
static void fail_far_points(void) {
    double xyz[3 * 9];
    hd_laplacian *lap = NULL;
    hd_status st;
    int32_t k;
    for (k = 0; k < 27; k++) xyz[k] = (k % 7 - 3) * 1e200 + (k % 4) * 1e199;
    st = hd_laplacian_tufted_points(&lap, xyz, 9, NULL, NULL, NULL, NULL);
    CHECK(st < 0 ? !lap : lap != NULL);
    if (st >= 0) hd_laplacian_free(lap);
    lap = NULL;
    st = hd_laplacian_points(&lap, xyz, 9, NULL, NULL);
    CHECK(st < 0 ? !lap : lap != NULL);
    if (st >= 0) hd_laplacian_free(lap);
}

/* Areas of faces that a double can hold, and whose sum it cannot. */
static void fail_large_area(void) {
    static const double xyz[12] = {0, 0, 0, 1.5e154, 0, 0, 0, 1.5e154, 0, 1.5e154, 1.5e154, 0};
    static const int32_t tri[6] = {0, 1, 2, 2, 1, 3};
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK(hd_laplacian_triangles(&lap, xyz, 4, tri, 2, NULL, &e) == HD_ERR_NOT_FINITE && !lap);
    CHECK(strstr(e.text, "area") != NULL);
}

/* A time of -0 is 0. */
static void fail_minus_zero(void) {
    static const int32_t i[2] = {0, 3}, j[2] = {5, 3};
    static const double t = -0.0;
    double K[2], d[2];
    hd_heat *heat = NULL;
    fail_world w;
    memset(&w, 0, sizeof w);
    CHECK(fail_triangles(&w, FAIL_VORONOI) == HD_OK && hd_heat_create(&heat, w.lap, NULL, NULL) == HD_OK);
    CHECK(hd_heat_pairs(heat, HD_DISTANCE_CLASSICAL, 1, &t, 2, i, j, K, d, NULL, NULL) == HD_OK);
    CHECK(K[0] == 0 && K[1] == 1 && d[0] > 0 && d[1] == 0);
    hd_heat_free(heat);
    hd_laplacian_free(w.lap);
    shape_free(&w.s);
}

static void test_failures(void) {
    int k;
    fail_minus_zero();
    fail_allocation_limit();
    fail_far_points();
    fail_large_area();
    fail_spectrum_ends();
    fail_memory = fail_random = fail_cancelled = fail_limited = 0;
    for (k = 0; k < FAIL_CASES; k++) fail_run(fail_cases + k);
    fail_queries();
    fail_fading_queries();
    printf("failures: %lld allocations in turn, %lld at random, %lld cancelled, %lld by limits\n", (long long)fail_memory, (long long)fail_random,
           (long long)fail_cancelled, (long long)fail_limited);
    CHECK(fail_memory > 1000 && fail_random > 100 && fail_cancelled > 100 && fail_limited > 100);
}

#endif
