/* test_doors.h - what every public function says of arguments that it cannot take: the status, the reason, and where.
 * Contexts that have become bad, arrays that are missing, sizes and options beyond their ranges. Nothing may be changed. */

#ifndef TEST_DOORS_H
#define TEST_DOORS_H

/* Objects that live in one context, each with something that it could answer. */
typedef struct doors {
    hd_context ctx;
    shape s;
    hd_laplacian *lap, *pair;            /* of a ball; of two matrices. Both can be updated */
    hd_heat *heat, *loop;                /* loop: iterative */
    hd_spectrum *spectrum;
    hd_geodesic *geodesic;
    hd_ldl *real, *complex_;             /* factorised */
    hd_csr L, B;
    hd_error e;
} doors;

enum { DOORS_N = 12, DOORS_SMALL = 5 };

static const char *const doors_missing = "must not be NULL";

/* The call fails with this status, and with this in its text. */
#define DOORS(call, want, say) \
    CHECK_MSG((call) == (want) && d->e.status == (want) && strstr(d->e.text, say), "%s: %s", hd_status_name(d->e.status), d->e.text)
#define DOORS_BAD(call, say) DOORS(call, HD_ERR_ARGUMENT, say)
#define DOORS_NULL(call) DOORS(call, HD_ERR_ARGUMENT, doors_missing)

/* The same with a place that the error names. */
#define DOORS_AT(call, want, say, where, at) do { DOORS(call, want, say); CHECK(d->e.where == (at)); } while (0)

/* The diagonal of L + I (12 entries of it), for the factors. */
static void doors_shift(const hd_csr *L, double *real, hd_c64 *complex_) {
    int64_t p;
    int32_t i;
    for (i = 0; i < L->n_rows; i++)
        for (p = L->row_ptr[i]; p < L->row_ptr[i + 1]; p++) {
            real[p] = L->val[p] + (L->col[p] == i);
            complex_[p] = test_c(real[p], L->col[p] == i);
        }
}

static void doors_open(doors *d) {
    double val[32];
    hd_c64 both[32];
    hd_laplacian_opts lo;
    hd_heat_opts ho;
    hd_spectrum_opts so;
    hd_geodesic_opts go;
    hd_ldl_opts fo;
    memset(d, 0, sizeof *d);
    memset(&lo, 0, sizeof lo);
    memset(&ho, 0, sizeof ho);
    memset(&so, 0, sizeof so);
    memset(&go, 0, sizeof go);
    memset(&fo, 0, sizeof fo);
    lo.context = ho.context = so.context = go.context = fo.context = &d->ctx;
    lo.updatable = go.updatable = 1;
    so.count = 4;
    d->s = shape_icosphere(0);
    d->L = test_path_csr(DOORS_SMALL, 0);
    d->B = test_diagonal_csr(DOORS_SMALL, NULL);
    doors_shift(&d->L, val, both);
    CHECK(d->s.n == DOORS_N && d->L.nnz <= 32);
    CHECK(hd_laplacian_triangles(&d->lap, d->s.xyz, d->s.n, d->s.tri, d->s.n_tri, &lo, &d->e) == HD_OK);
    CHECK(hd_laplacian_matrices(&d->pair, &d->L, &d->B, 1, &lo, &d->e) == HD_OK);
    CHECK(hd_heat_create(&d->heat, d->lap, &ho, &d->e) == HD_OK);
    ho.method = HD_METHOD_ITERATIVE;
    CHECK(hd_heat_create(&d->loop, d->lap, &ho, &d->e) == HD_OK);
    CHECK(hd_spectrum_create(&d->spectrum, d->lap, &so, &d->e) == HD_OK);
    CHECK(hd_geodesic_create(&d->geodesic, d->s.xyz, d->s.n, d->s.tri, d->s.n_tri, &go, &d->e) == HD_OK);
    CHECK(hd_ldl_analyse(&d->real, &d->L, &fo, NULL, &d->e) == HD_OK && hd_ldl_factor(d->real, val, NULL, &d->e) == HD_OK);
    CHECK(hd_ldl_analyse(&d->complex_, &d->L, &fo, NULL, &d->e) == HD_OK &&
          hd_ldl_factor_complex(d->complex_, 1, both, NULL, &d->e) == HD_OK);
}

static void doors_close(doors *d) {
    hd_ldl_free(d->complex_);
    hd_ldl_free(d->real);
    hd_geodesic_free(d->geodesic);
    hd_spectrum_free(d->spectrum);
    hd_heat_free(d->loop);
    hd_heat_free(d->heat);
    hd_laplacian_free(d->pair);
    hd_laplacian_free(d->lap);
    hd_csr_free(&d->L, NULL);
    hd_csr_free(&d->B, NULL);
    shape_free(&d->s);
    CHECK(d->ctx.bytes_in_use == 0);
}

static hd_mesh_view doors_view(const doors *d) {
    hd_mesh_view v;
    memset(&v, 0, sizeof v);
    v.xyz_double = d->s.xyz;
    v.n = d->s.n;
    v.tri_i32 = d->s.tri;
    v.n_indices = 3 * (int64_t)d->s.n_tri;
    return v;
}

/* One vertex. */
static hd_source doors_source(const int32_t *vertex) {
    hd_source s;
    memset(&s, 0, sizeof s);
    s.count = 1;
    s.vertex = vertex;
    return s;
}

/* ---- a bad context ---- */

/* A number of threads below zero, put into a context that objects live in: every function that reads it says so. */
#define DOORS_CONTEXT(call) DOORS_BAD(call, "n_threads is negative")

static void doors_context_parts(doors *d) {
    const int32_t zero = 0, one[2] = {0, 1}, perm[DOORS_SMALL] = {4, 3, 2, 1, 0};
    const double x[DOORS_SMALL] = {1, 0, 0, 0, 0}, t = 1;
    double y[3 * DOORS_N] = {0}, D[8] = {0};
    int32_t index[DOORS_N];
    hd_csr out;
    hd_filter f;
    hd_rational set;
    hd_ldl_opts fo;
    hd_ldl *ldl = NULL;
    memset(&f, 0, sizeof f);
    memset(&fo, 0, sizeof fo);
    fo.context = &d->ctx;
    DOORS_CONTEXT(hd_csr_from_triplets(&out, 1, 1, 1, &zero, &zero, x, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_csr_check(&d->L, 1, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_csr_transpose(&out, &d->L, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_csr_product(&out, &d->L, &d->B, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_csr_permute(&out, &d->L, perm, &d->ctx, &d->e));
    hd_csr_apply(&d->L, x, y, &d->ctx);          /* tells nothing, and goes on without it */
    CHECK(y[0] == 1 && y[1] == -1 && y[2] == 0);
    DOORS_CONTEXT(hd_neighbours_nearest(d->s.xyz, d->s.n, NULL, 0, 1, index, NULL, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_neighbours_radius(&out, d->s.xyz, d->s.n, NULL, 0, 1, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_rational_shared(&set, 1, &t, 0, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_rational_fit(&set, &f, 1, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_rational_fit_shared(&set, 1, &f, 1, &d->ctx, &d->e));
    DOORS_CONTEXT(hd_ldl_analyse(&ldl, &d->L, &fo, NULL, &d->e));
    DOORS_CONTEXT(hd_ldl_factor(d->real, d->L.val, NULL, &d->e));
    DOORS_CONTEXT(hd_ldl_factor_complex(d->complex_, 1, NULL, NULL, &d->e));
    DOORS_CONTEXT(hd_ldl_solve(d->real, 1, x, 0, y, 0, &d->e));
    DOORS_CONTEXT(hd_ldl_solve_complex(d->complex_, NULL, 0, NULL, 0, &d->e));
    DOORS_CONTEXT(hd_ldl_inverse(d->real, NULL, D, &d->e));
    DOORS_CONTEXT(hd_ldl_inverse_complex(d->complex_, NULL, NULL, &d->e));
    DOORS_CONTEXT(hd_ldl_inverse_entries(d->real, 1, one, one, D, &d->e));
    DOORS_CONTEXT(hd_ldl_inverse_entries_complex(d->complex_, 0, one, one, NULL, &d->e));
    CHECK(!ldl);
}

static void doors_context_surfaces(doors *d) {
    const hd_mesh_view view = doors_view(d);
    const int32_t v = 0;
    const hd_source from = doors_source(&v);
    const double t = 1;
    double u[3 * DOORS_N] = {0};
    hd_spectrum_opts so;
    hd_laplacian_opts lo;
    hd_geodesic_opts go;
    hd_laplacian *lap = rob_mark_lap;
    hd_geodesic *g = NULL;
    hd_spectrum *s = NULL;
    hd_heat *heat = rob_mark_heat;
    memset(&so, 0, sizeof so);
    memset(&lo, 0, sizeof lo);
    memset(&go, 0, sizeof go);
    so.count = 1;
    lo.context = go.context = &d->ctx;
    DOORS_CONTEXT(hd_laplacian_view(&lap, &view, &lo, &d->e));
    DOORS_CONTEXT(hd_laplacian_lengths(&lap, u, d->s.n, d->s.tri, d->s.n_tri, &lo, &d->e));
    DOORS_CONTEXT(hd_laplacian_apply(d->lap, 1, 0, d->s.xyz, u, &d->e));
    DOORS_CONTEXT(hd_laplacian_update(d->lap, d->s.xyz, &d->e));
    DOORS_CONTEXT(hd_laplacian_update_view(d->lap, &view, &d->e));
    DOORS_CONTEXT(hd_laplacian_update_matrices(d->pair, &d->L, &d->B, 1, &d->e));
    DOORS_CONTEXT(hd_times_auto(d->lap, 1, u, &d->e));
    DOORS_CONTEXT(hd_times_spectral(d->lap, 1, &t, u, &d->e));
    DOORS_CONTEXT(hd_spectrum_create(&s, d->lap, &so, &d->e));
    DOORS_CONTEXT(hd_spectrum_columns(d->spectrum, HD_KERNEL_OPERATOR, 1, &t, 1, &v, u, NULL, 0, &d->e));
    DOORS_CONTEXT(hd_spectrum_columns_from(d->spectrum, HD_KERNEL_OPERATOR, 1, &t, 1, &from, u, NULL, 0, &d->e));
    DOORS_CONTEXT(hd_spectrum_diagonal(d->spectrum, HD_KERNEL_OPERATOR, 1, &t, u, NULL, 0, &d->e));
    DOORS_CONTEXT(hd_spectrum_distance(d->spectrum, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, u, NULL, 0, &d->e));
    DOORS_CONTEXT(hd_spectrum_distance_from(d->spectrum, HD_DISTANCE_CLASSICAL, 1, &t, 1, &from, u, NULL, 0, &d->e));
    DOORS_CONTEXT(hd_shifted_solve(d->lap, 1, test_c(1, 1), NULL, NULL, NULL, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_create(&heat, d->lap, NULL, &d->e));
    DOORS_CONTEXT(hd_geodesic_create(&g, d->s.xyz, d->s.n, d->s.tri, d->s.n_tri, &go, &d->e));
    DOORS_CONTEXT(hd_geodesic_create_view(&g, &view, &go, &d->e));
    DOORS_CONTEXT(hd_geodesic_create_lengths(&g, u, d->s.n, d->s.tri, d->s.n_tri, &go, &d->e));
    DOORS_CONTEXT(hd_geodesic_update(d->geodesic, d->s.xyz, &d->e));
    DOORS_CONTEXT(hd_geodesic_update_view(d->geodesic, &view, &d->e));
    DOORS_CONTEXT(hd_geodesic_distance(d->geodesic, 1, &v, u, NULL, &d->e));
    DOORS_CONTEXT(hd_geodesic_distance_each(d->geodesic, 1, &v, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_geodesic_distance_from(d->geodesic, &from, u, NULL, &d->e));
    CHECK(lap == rob_mark_lap && heat == rob_mark_heat && !g && !s && u[0] == 0);
}

static void doors_context_heat(doors *d) {
    const int32_t v = 0;
    const hd_source from = doors_source(&v);
    const double t = 1, f[DOORS_N] = {1};
    double u[8 * DOORS_N] = {0};
    int32_t vertex[2] = {0, 0};
    hd_heat *const h = d->heat;
    hd_rational set;
    hd_estimate estimate;
    hd_report rep;
    memset(&set, 0, sizeof set);
    DOORS_CONTEXT(hd_heat_set_rational(h, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_apply(h, 1, &t, 1, f, 0, u, 0, &rep, &d->e));
    CHECK(rep.status == HD_ERR_ARGUMENT && strstr(rep.error.text, "n_threads"));
    DOORS_CONTEXT(hd_heat_derivative(h, 1, &t, 1, f, 0, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_adjoint(h, 1, &t, 1, f, 0, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_columns(h, HD_KERNEL_OPERATOR, 1, &t, 1, &v, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_columns_from(h, HD_KERNEL_OPERATOR, 1, &t, 1, &from, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_column(h, HD_KERNEL_OPERATOR, t, 0, u, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, &t, 1, &v, &v, u, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_diagonal(h, HD_KERNEL_OPERATOR, 1, &t, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_trace(h, 1, &t, u, NULL, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_filter_diagonals(h, 1, &set, u, 0, NULL, NULL, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_normalised(h, 1, &t, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_scale_invariant(h, 1, 2, 3, 1, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_edges(h, HD_KERNEL_SYMMETRIC, 1, &t, u, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_distance(h, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_distance_from(h, HD_DISTANCE_CLASSICAL, 1, &t, 1, &from, u, 0, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_pairs(h, HD_DISTANCE_CLASSICAL, 1, &t, 1, &v, &v, u, u, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_sample(h, HD_DISTANCE_CLASSICAL, t, 2, 0, vertex, u, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_sample_from(h, HD_DISTANCE_CLASSICAL, t, 1, &from, 2, vertex, u, NULL, &d->e));
    DOORS_CONTEXT(hd_heat_estimate(h, HD_QUERY_COLUMNS, 1, &t, 1, &estimate, &d->e));
    CHECK(u[0] == 0 && vertex[1] == 0);
}

static void doors_context(void) {
    doors all, *const d = &all;
    doors_open(d);
    d->ctx.n_threads = -1;
    doors_context_parts(d);
    doors_context_surfaces(d);
    doors_context_heat(d);
    d->ctx.n_threads = 0;
    doors_close(d);
}

/* ---- matrices and factorisations ---- */

static void doors_matrices(doors *d) {
    const int32_t i[2] = {0, 1}, j[2] = {0, 1}, perm[DOORS_SMALL] = {4, 3, 2, 1, 0}, low = -1, high = 2;
    const double v[2] = {1, 2};
    hd_csr out, bad = d->L, wide = d->L;
    memset(&out, 0, sizeof out);
    bad.nnz = -1;
    wide.n_cols = DOORS_SMALL + 1;
    DOORS_NULL(hd_csr_from_triplets(&out, 2, 2, 2, i, NULL, v, NULL, &d->e));
    DOORS_NULL(hd_csr_from_triplets(&out, 2, 2, 2, NULL, j, v, NULL, &d->e));
    DOORS_BAD(hd_csr_from_triplets(&out, -1, 2, 0, i, j, v, NULL, &d->e), "negative");
    DOORS_BAD(hd_csr_from_triplets(&out, 2, -1, 0, i, j, v, NULL, &d->e), "negative");
    DOORS_BAD(hd_csr_from_triplets(&out, 2, 2, -1, i, j, v, NULL, &d->e), "negative");
    DOORS_AT(hd_csr_from_triplets(&out, 2, 2, 1, &low, j, v, NULL, &d->e), HD_ERR_INDEX, "", value, -1);
    DOORS_AT(hd_csr_from_triplets(&out, 2, 2, 1, &high, j, v, NULL, &d->e), HD_ERR_INDEX, "", value, 2);
    DOORS_AT(hd_csr_from_triplets(&out, 2, 2, 1, i, &low, v, NULL, &d->e), HD_ERR_INDEX, "", value, -1);
    DOORS_AT(hd_csr_from_triplets(&out, 2, 2, 1, i, &high, v, NULL, &d->e), HD_ERR_INDEX, "", value, 2);
    DOORS_NULL(hd_csr_transpose(NULL, &d->L, NULL, &d->e));
    DOORS(hd_csr_transpose(&out, &bad, NULL, &d->e), HD_ERR_STRUCTURE, "negative size");
    DOORS_NULL(hd_csr_product(NULL, &d->L, &d->B, NULL, &d->e));
    DOORS_NULL(hd_csr_product(&out, &d->L, NULL, NULL, &d->e));
    DOORS(hd_csr_product(&out, &bad, &d->B, NULL, &d->e), HD_ERR_STRUCTURE, "negative size");
    DOORS(hd_csr_product(&out, &d->L, &bad, NULL, &d->e), HD_ERR_STRUCTURE, "negative size");
    DOORS_AT(hd_csr_product(&out, &wide, &d->L, NULL, &d->e), HD_ERR_ARGUMENT, "inner sizes", row, DOORS_SMALL + 1);
    DOORS_NULL(hd_csr_permute(NULL, &d->L, perm, NULL, &d->e));
    DOORS_NULL(hd_csr_permute(&out, &d->L, NULL, NULL, &d->e));
    DOORS(hd_csr_permute(&out, &bad, perm, NULL, &d->e), HD_ERR_STRUCTURE, "negative size");
    DOORS_AT(hd_csr_permute(&out, &wide, perm, NULL, &d->e), HD_ERR_ARGUMENT, "not square", column, DOORS_SMALL + 1);
    bad = d->L;
    bad.n_cols = -1;
    DOORS(hd_csr_check(&bad, 0, NULL, &d->e), HD_ERR_STRUCTURE, "negative size");
    bad = d->L;
    bad.n_rows = -1;
    DOORS(hd_csr_check(&bad, 0, NULL, &d->e), HD_ERR_STRUCTURE, "negative size");
    bad = d->L;
    bad.row_ptr = NULL;
    DOORS(hd_csr_check(&bad, 0, NULL, &d->e), HD_ERR_STRUCTURE, "missing array");
    bad = d->L;
    bad.col = NULL;
    DOORS(hd_csr_check(&bad, 0, NULL, &d->e), HD_ERR_STRUCTURE, "missing array");
    CHECK(!out.row_ptr && !out.col && !out.val);
}

/* A pattern without values has a product and a permutation without values. */
static void doors_patterns(doors *d) {
    const int32_t perm[DOORS_SMALL] = {4, 3, 2, 1, 0};
    hd_csr pattern = d->L, out;
    pattern.val = NULL;
    CHECK(hd_csr_product(&out, &pattern, &d->B, NULL, &d->e) == HD_OK && !out.val && out.nnz == d->L.nnz);
    hd_csr_free(&out, NULL);
    CHECK(hd_csr_product(&out, &d->B, &pattern, NULL, &d->e) == HD_OK && !out.val && out.nnz == d->L.nnz);
    hd_csr_free(&out, NULL);
    CHECK(hd_csr_permute(&out, &pattern, perm, NULL, &d->e) == HD_OK && !out.val && out.nnz == d->L.nnz && out.col[0] == 0 && out.col[1] == 1);
    hd_csr_free(&out, NULL);
}

static void doors_factors(doors *d) {
    const int32_t i[2] = {0, 1}, low[2] = {0, -1}, high[2] = {0, DOORS_SMALL};
    double x[2 * DOORS_SMALL] = {0}, v[2];
    hd_c64 z[2 * DOORS_SMALL], w[2];
    hd_ldl *ldl = NULL;
    memset(z, 0, sizeof z);
    DOORS_NULL(hd_ldl_analyse(NULL, &d->L, NULL, NULL, &d->e));
    DOORS_NULL(hd_ldl_analyse(&ldl, NULL, NULL, NULL, &d->e));
    DOORS_NULL(hd_ldl_factor(NULL, x, NULL, &d->e));
    DOORS_NULL(hd_ldl_factor(d->real, NULL, NULL, &d->e));
    DOORS_NULL(hd_ldl_factor_complex(NULL, 1, z, NULL, &d->e));
    DOORS_BAD(hd_ldl_factor_complex(d->complex_, 0, z, NULL, &d->e), "not positive");
    DOORS_NULL(hd_ldl_solve(NULL, 1, x, 0, x, 0, &d->e));
    DOORS_NULL(hd_ldl_solve(d->real, 1, NULL, 0, x, 0, &d->e));
    DOORS_NULL(hd_ldl_solve(d->real, 1, x, 0, NULL, 0, &d->e));
    DOORS_BAD(hd_ldl_solve(d->real, -1, x, 0, x, 0, &d->e), "is negative");
    DOORS_BAD(hd_ldl_solve(d->complex_, 1, x, 0, x, 0, &d->e), "not a real one");
    DOORS_BAD(hd_ldl_solve(d->real, 1, x, DOORS_SMALL - 1, x, 0, &d->e), "leading dimension");
    DOORS_BAD(hd_ldl_solve(d->real, 1, x, 0, x, DOORS_SMALL - 1, &d->e), "leading dimension");
    DOORS_NULL(hd_ldl_solve_complex(NULL, z, 0, z, 0, &d->e));
    DOORS_NULL(hd_ldl_solve_complex(d->complex_, NULL, 0, z, 0, &d->e));
    DOORS_NULL(hd_ldl_solve_complex(d->complex_, z, 0, NULL, 0, &d->e));
    DOORS_BAD(hd_ldl_solve_complex(d->real, z, 0, z, 0, &d->e), "not a complex one");
    DOORS_BAD(hd_ldl_solve_complex(d->complex_, z, DOORS_SMALL - 1, z, 0, &d->e), "leading dimension");
    DOORS_BAD(hd_ldl_solve_complex(d->complex_, z, DOORS_SMALL + 1, z, DOORS_SMALL + 2, &d->e), "same leading dimension");
    DOORS_BAD(hd_ldl_inverse_entries(d->real, -1, i, i, v, &d->e), "is negative");
    DOORS_NULL(hd_ldl_inverse_entries(d->real, 2, NULL, i, v, &d->e));
    DOORS_NULL(hd_ldl_inverse_entries(d->real, 2, i, NULL, v, &d->e));
    DOORS_NULL(hd_ldl_inverse_entries(d->real, 2, i, i, NULL, &d->e));
    DOORS_AT(hd_ldl_inverse_entries(d->real, 2, low, i, v, &d->e), HD_ERR_INDEX, "not in the matrix", row, 1);
    DOORS_AT(hd_ldl_inverse_entries(d->real, 2, i, low, v, &d->e), HD_ERR_INDEX, "not in the matrix", value, -1);
    DOORS_AT(hd_ldl_inverse_entries(d->real, 2, high, i, v, &d->e), HD_ERR_INDEX, "not in the matrix", value, DOORS_SMALL);
    DOORS_AT(hd_ldl_inverse_entries_complex(d->complex_, 2, i, high, w, &d->e), HD_ERR_INDEX, "not in the matrix", row, 1);
    CHECK(hd_ldl_inverse_entries(d->real, 0, NULL, NULL, NULL, &d->e) == HD_OK);
    CHECK(hd_ldl_inverse_entries_complex(d->complex_, 0, NULL, NULL, NULL, &d->e) == HD_OK);
    CHECK(hd_ldl_inverse(d->real, NULL, NULL, &d->e) == HD_OK && hd_ldl_inverse_complex(d->complex_, NULL, NULL, &d->e) == HD_OK);
    CHECK(!ldl);
}

/* ---- Laplacians ---- */

static void doors_laplacians(doors *d) {
    const int64_t ptr[2] = {0, 3};
    const shape *const s = &d->s;
    const double nan = (double)NAN;
    hd_laplacian *lap = rob_mark_lap;
    hd_laplacian_opts o, zero;
    hd_csr none = d->L;
    double y[DOORS_N];
    memset(&zero, 0, sizeof zero);
    none.val = NULL;
    DOORS_NULL(hd_laplacian_matrices(NULL, &d->L, &d->B, 1, NULL, &d->e));
    DOORS_NULL(hd_laplacian_matrices(&lap, &d->L, NULL, 1, NULL, &d->e));
    DOORS_NULL(hd_laplacian_matrices(&lap, &none, &d->B, 1, NULL, &d->e));
    DOORS_NULL(hd_laplacian_matrices(&lap, &d->L, &none, 1, NULL, &d->e));
    DOORS_BAD(hd_laplacian_matrices(&lap, &d->L, &d->B, -1, NULL, &d->e), "h is negative");
    DOORS_BAD(hd_laplacian_matrices(&lap, &d->L, &d->B, nan, NULL, &d->e), "h is negative or not finite");
    DOORS_NULL(hd_laplacian_lengths(&lap, NULL, s->n, s->tri, s->n_tri, NULL, &d->e));
    DOORS_NULL(hd_laplacian_polygons(NULL, s->xyz, s->n, ptr, s->tri, 1, NULL, &d->e));
    DOORS_NULL(hd_laplacian_points(NULL, s->xyz, s->n, NULL, &d->e));
    DOORS_NULL(hd_laplacian_points(&lap, NULL, s->n, NULL, &d->e));
    DOORS_NULL(hd_laplacian_tufted_points(NULL, s->xyz, s->n, NULL, NULL, NULL, &d->e));
    DOORS_NULL(hd_laplacian_tufted_points(&lap, NULL, s->n, NULL, NULL, NULL, &d->e));
    DOORS_NULL(hd_laplacian_tufted_points(&lap, s->xyz, 1, ptr, NULL, NULL, &d->e));
    DOORS_NULL(hd_laplacian_tufted_points(&lap, s->xyz, s->n, NULL, s->tri, NULL, &d->e));
    DOORS_BAD(hd_laplacian_polygons(&lap, s->xyz, s->n, ptr, s->tri, -1, NULL, &d->e), "size is negative");
    DOORS_BAD(hd_laplacian_polygons(&lap, s->xyz, -1, ptr, s->tri, 1, NULL, &d->e), "size is negative");
    o = zero;
    o.updatable = 1;
    DOORS_BAD(hd_laplacian_lengths(&lap, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), "of lengths: it is not updatable");
    DOORS_BAD(hd_laplacian_points(&lap, s->xyz, s->n, &o, &d->e), "not updatable");
    DOORS_BAD(hd_laplacian_tufted_points(&lap, s->xyz, s->n, NULL, NULL, &o, &d->e), "not updatable");
    o.tufted = 1;
    DOORS_BAD(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), "intrinsic triangulation is not updatable");
    DOORS_BAD(hd_laplacian_polygons(&lap, s->xyz, s->n, ptr, s->tri, 1, &o, &d->e), "intrinsic triangulation is not updatable");
    o.updatable = 0;
    DOORS_BAD(hd_laplacian_points(&lap, s->xyz, s->n, &o, &d->e), "use no triangles");
    o.tufted = 0;
    o.intrinsic_delaunay = 1;
    DOORS_BAD(hd_laplacian_points(&lap, s->xyz, s->n, &o, &d->e), "use no triangles");
    o.kind = HD_LAPLACIAN_POLYGON;
    DOORS_BAD(hd_laplacian_polygons(&lap, s->xyz, s->n, ptr, s->tri, 1, &o, &d->e), "intrinsic triangulations are for");
    o = zero;
    o.weight_cut = nan;
    DOORS_BAD(hd_laplacian_points(&lap, s->xyz, s->n, &o, &d->e), "weight_cut");
    o.weight_cut = -1;
    DOORS_BAD(hd_laplacian_points(&lap, s->xyz, s->n, &o, &d->e), "weight_cut");
    o.weight_cut = 1;
    DOORS_BAD(hd_laplacian_points(&lap, s->xyz, s->n, &o, &d->e), "weight_cut");
    o = zero;
    o.border = (hd_border)7;
    DOORS_BAD(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), "border is natural");
    o.border = (hd_border)-1;
    DOORS_BAD(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), "border is natural");
    o = zero;
    o.n_held = -1;
    DOORS_BAD(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), "n_held is negative");
    DOORS_NULL(hd_laplacian_apply(d->lap, 1, 1, NULL, y, &d->e));
    DOORS_NULL(hd_laplacian_apply(d->lap, 1, 1, s->xyz, NULL, &d->e));
    CHECK(lap == rob_mark_lap);
}

static void doors_updates(doors *d) {
    const double nan = (double)NAN;
    const hd_mesh_view view = doors_view(d);
    hd_csr none = d->L, tall = d->L, wide = d->L, bent = d->L;
    const int64_t version = d->pair->version;
    int64_t ptr[DOORS_SMALL + 1];
    none.val = NULL;
    tall.n_rows = DOORS_SMALL - 1;
    wide.n_cols = DOORS_SMALL + 1;
    memcpy(ptr, d->L.row_ptr, sizeof ptr);
    ptr[0] = 1;
    bent.row_ptr = ptr;
    DOORS_NULL(hd_laplacian_update(NULL, d->s.xyz, &d->e));
    DOORS_NULL(hd_laplacian_update(d->lap, NULL, &d->e));
    DOORS_NULL(hd_laplacian_update_view(NULL, &view, &d->e));
    DOORS_NULL(hd_laplacian_update_view(d->lap, NULL, &d->e));
    DOORS_BAD(hd_laplacian_update(d->pair, d->s.xyz, &d->e), "matrices of your own");
    DOORS_NULL(hd_laplacian_update_matrices(NULL, &d->L, &d->B, 1, &d->e));
    DOORS_NULL(hd_laplacian_update_matrices(d->pair, NULL, &d->B, 1, &d->e));
    DOORS_NULL(hd_laplacian_update_matrices(d->pair, &d->L, NULL, 1, &d->e));
    DOORS_NULL(hd_laplacian_update_matrices(d->pair, &none, &d->B, 1, &d->e));
    DOORS_NULL(hd_laplacian_update_matrices(d->pair, &d->L, &none, 1, &d->e));
    DOORS_BAD(hd_laplacian_update_matrices(d->lap, &d->L, &d->B, 1, &d->e), "not made of matrices");
    DOORS_BAD(hd_laplacian_update_matrices(d->pair, &d->L, &d->B, -1, &d->e), "h is negative");
    DOORS_BAD(hd_laplacian_update_matrices(d->pair, &d->L, &d->B, nan, &d->e), "h is negative or not finite");
    DOORS_BAD(hd_laplacian_update_matrices(d->pair, &tall, &d->B, 1, &d->e), "another size");
    DOORS_BAD(hd_laplacian_update_matrices(d->pair, &d->L, &tall, 1, &d->e), "another size");
    DOORS_BAD(hd_laplacian_update_matrices(d->pair, &wide, &d->B, 1, &d->e), "another size");
    DOORS_BAD(hd_laplacian_update_matrices(d->pair, &d->L, &wide, 1, &d->e), "another size");
    DOORS(hd_laplacian_update_matrices(d->pair, &bent, &d->B, 1, &d->e), HD_ERR_STRUCTURE, "does not begin with 0");
    DOORS(hd_laplacian_update_matrices(d->pair, &d->L, &bent, 1, &d->e), HD_ERR_STRUCTURE, "does not begin with 0");
    CHECK(d->pair->version == version);
}

/* Views that say too little, too much, or sizes beyond all. */
static void doors_views(doors *d) {
    static const uint16_t tri16[3] = {0, 1, 2};
    static const float small[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const hd_mesh_view good = doors_view(d);
    hd_laplacian *lap = rob_mark_lap;
    hd_geodesic *g = NULL;
    hd_mesh_view v;
    hd_laplacian_opts lo;
    hd_geodesic_opts go;
    memset(&lo, 0, sizeof lo);
    memset(&go, 0, sizeof go);
    DOORS_NULL(hd_laplacian_view(&lap, NULL, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_view(&g, NULL, NULL, &d->e));
#define DOORS_VIEW(set, want, say) v = good; set; DOORS(hd_laplacian_view(&lap, &v, NULL, &d->e), want, say)
    DOORS_VIEW(v.begin_zero = 1, HD_ERR_ARGUMENT, "not cleared");
    DOORS_VIEW(v.end_zero = 1, HD_ERR_ARGUMENT, "not cleared");
    DOORS_VIEW(v.xyz_float = small, HD_ERR_ARGUMENT, "set one of xyz_float");
    DOORS_VIEW(v.xyz_double = NULL, HD_ERR_ARGUMENT, "set one of xyz_float");
    DOORS_VIEW(v.tri_u16 = tri16, HD_ERR_ARGUMENT, "set one of tri_u16");
    DOORS_VIEW(v.tri_i32 = NULL, HD_ERR_ARGUMENT, "set one of tri_u16");
    DOORS_VIEW(v.n = -1, HD_ERR_ARGUMENT, "count is negative");
    DOORS_VIEW(v.n_indices = -3, HD_ERR_ARGUMENT, "count is negative");
    DOORS_VIEW(v.n_indices = 4, HD_ERR_ARGUMENT, "multiple of three");
    DOORS_VIEW(v.stride = 23, HD_ERR_ARGUMENT, "stride is shorter");
    DOORS_VIEW(v.n = (int64_t)INT32_MAX + 1, HD_ERR_TOO_LARGE, "more than 2^31 - 1");
    DOORS_VIEW(v.n_indices = 3 * ((int64_t)INT32_MAX + 1), HD_ERR_TOO_LARGE, "more than 2^31 - 1");
    DOORS_VIEW(v.stride = SIZE_MAX / 4, HD_ERR_TOO_LARGE, "beyond the address space");
#undef DOORS_VIEW
    lo.begin_zero = go.begin_zero = 1;
    DOORS_BAD(hd_laplacian_view(&lap, &good, &lo, &d->e), "not cleared");
    DOORS_BAD(hd_geodesic_create_view(&g, &good, &go, &d->e), "not cleared");
    lo.begin_zero = go.begin_zero = 0;
    lo.end_zero = go.end_zero = 1;
    DOORS_BAD(hd_laplacian_view(&lap, &good, &lo, &d->e), "not cleared");
    DOORS_BAD(hd_geodesic_create_view(&g, &good, &go, &d->e), "not cleared");
    v = good;
    v.n = DOORS_N - 1;
    DOORS_AT(hd_laplacian_update_view(d->lap, &v, &d->e), HD_ERR_ARGUMENT, "another number of vertices", value, DOORS_N - 1);
    DOORS_AT(hd_geodesic_update_view(d->geodesic, &v, &d->e), HD_ERR_ARGUMENT, "another number of vertices", value, DOORS_N - 1);
    CHECK(lap == rob_mark_lap && !g);
}

static void doors_neighbours(doors *d) {
    const double nan = (double)NAN;
    int32_t index[DOORS_N];
    hd_csr out;
    memset(&out, 0, sizeof out);
    DOORS_BAD(hd_neighbours_nearest(d->s.xyz, -1, NULL, 0, 1, index, NULL, NULL, &d->e), "size is negative");
    DOORS_BAD(hd_neighbours_nearest(d->s.xyz, d->s.n, d->s.xyz, -1, 1, index, NULL, NULL, &d->e), "size is negative");
    DOORS_NULL(hd_neighbours_nearest(NULL, d->s.n, NULL, 0, 1, index, NULL, NULL, &d->e));
    DOORS_NULL(hd_neighbours_nearest(d->s.xyz, d->s.n, NULL, 0, 1, NULL, NULL, NULL, &d->e));
    DOORS_BAD(hd_neighbours_nearest(d->s.xyz, d->s.n, NULL, 0, 0, index, NULL, NULL, &d->e), "k is not positive");
    CHECK(hd_neighbours_nearest(d->s.xyz, d->s.n, d->s.xyz, 0, 1, NULL, NULL, NULL, &d->e) == HD_OK);      /* no question */
    DOORS_NULL(hd_neighbours_radius(NULL, d->s.xyz, d->s.n, NULL, 0, 1, NULL, &d->e));
    DOORS_BAD(hd_neighbours_radius(&out, d->s.xyz, d->s.n, NULL, 0, -1, NULL, &d->e), "radius is negative");
    DOORS_BAD(hd_neighbours_radius(&out, d->s.xyz, d->s.n, NULL, 0, nan, NULL, &d->e), "not a number");
    CHECK(!out.row_ptr);
}

/* ---- eigenpairs, filters, shifted systems ---- */

static void doors_spectra(doors *d) {
    const double t[2] = {1, 2}, bad[2] = {1, (double)NAN}, low[2] = {1, -1};
    const int32_t v[2] = {0, 1}, far[2] = {0, DOORS_N};
    const hd_source from = doors_source(v);
    const hd_spectrum *const s = d->spectrum;
    double u[4 * DOORS_N];
    hd_spectrum_opts o, zero;
    hd_spectrum *made = NULL;
    memset(&zero, 0, sizeof zero);
    zero.count = 2;
    DOORS_NULL(hd_spectrum_create(NULL, d->lap, &zero, &d->e));
    DOORS_NULL(hd_spectrum_create(&made, NULL, &zero, &d->e));
    DOORS_NULL(hd_spectrum_create(&made, d->lap, NULL, &d->e));
#define DOORS_SPECTRUM(field, bad_value, say) o = zero; o.field = bad_value; DOORS_BAD(hd_spectrum_create(&made, d->lap, &o, &d->e), say)
    DOORS_SPECTRUM(begin_zero, 1, "not cleared");
    DOORS_SPECTRUM(end_zero, 1, "not cleared");
    DOORS_SPECTRUM(count, -1, "neither a count nor a bound");
    DOORS_SPECTRUM(count, 0, "neither a count nor a bound");
    DOORS_SPECTRUM(count, DOORS_N + 1, "more pairs than rows");
    DOORS_SPECTRUM(below, -1, "below is negative");
    DOORS_SPECTRUM(below, (double)NAN, "below is negative or not finite");
    DOORS_SPECTRUM(tol, -1, "tol is not in");
    DOORS_SPECTRUM(tol, 1, "tol is not in");
    DOORS_SPECTRUM(tol, (double)NAN, "tol is not in");
    DOORS_SPECTRUM(ordering, (hd_ordering)99, "unknown ordering");
    DOORS_SPECTRUM(ordering, (hd_ordering)-1, "unknown ordering");
    DOORS_SPECTRUM(ordering, HD_ORDERING_OWN, "no permutation");
#undef DOORS_SPECTRUM
    o = zero;
    o.ordering = HD_ORDERING_OWN;
    o.perm = d->s.tri;
    CHECK(hd_spectrum_create(&made, d->lap, &o, &d->e) < 0 && d->e.status < 0 && !made);      /* not a permutation */
    DOORS_NULL(hd_spectrum_columns(NULL, HD_KERNEL_OPERATOR, 1, t, 1, v, u, NULL, 0, &d->e));
    DOORS_NULL(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, NULL, 1, v, u, NULL, 0, &d->e));
    DOORS_NULL(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, t, 1, NULL, u, NULL, 0, &d->e));
    DOORS_NULL(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, t, 1, v, NULL, NULL, 0, &d->e));
    DOORS_NULL(hd_spectrum_columns_from(s, HD_KERNEL_OPERATOR, 1, t, 1, NULL, u, NULL, 0, &d->e));
    DOORS_BAD(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 0, NULL, 1, v, u, NULL, 0, &d->e), "there is no time");
    DOORS_BAD(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, t, -1, v, u, NULL, 0, &d->e), "is negative");
    DOORS_BAD(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, t, 1, v, u, NULL, DOORS_N - 1, &d->e), "would overlap");
    DOORS_BAD(hd_spectrum_columns(s, (hd_kernel)9, 1, t, 1, v, u, NULL, 0, &d->e), "unknown kernel");
    DOORS_AT(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 2, low, 1, v, u, NULL, 0, &d->e), HD_ERR_ARGUMENT, "t is negative", value, -1);
    DOORS_BAD(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 2, bad, 1, v, u, NULL, 0, &d->e), "t is negative or not finite");
    DOORS_AT(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, t, 2, far, u, NULL, 0, &d->e), HD_ERR_INDEX, "", column, 1);
    CHECK(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 1, t, 0, NULL, NULL, NULL, 0, &d->e) == HD_OK);
    DOORS_BAD(hd_spectrum_distance(s, (hd_distance_kind)-1, 1, t, 1, v, u, NULL, 0, &d->e), "unknown distance");
    DOORS_BAD(hd_spectrum_distance(s, (hd_distance_kind)99, 1, t, 1, v, u, NULL, 0, &d->e), "unknown distance");
    DOORS_BAD(hd_spectrum_distance(s, HD_DISTANCE_COMMUTE, 2, t, 1, v, u, NULL, 0, &d->e), "has no time");
    DOORS_BAD(hd_spectrum_distance_from(s, HD_DISTANCE_BIHARMONIC, 2, t, 1, &from, u, NULL, 0, &d->e), "has no time");
    DOORS_BAD(hd_times_auto(NULL, 1, u, &d->e), "missing");
    DOORS_BAD(hd_times_auto(d->lap, 1, NULL, &d->e), "missing");
    DOORS_BAD(hd_times_auto(d->lap, 0, u, &d->e), "there is no time");
    DOORS_BAD(hd_times_spectral(NULL, 1, t, u, &d->e), "missing");
    DOORS_BAD(hd_times_spectral(d->lap, 1, NULL, u, &d->e), "missing");
    DOORS_BAD(hd_times_spectral(d->lap, 1, t, NULL, &d->e), "missing");
    DOORS_BAD(hd_times_spectral(d->lap, 0, t, u, &d->e), "there is no time");
    DOORS_AT(hd_times_spectral(d->lap, 2, low, u, &d->e), HD_ERR_ARGUMENT, "c is not positive", column, 1);
    DOORS_AT(hd_times_spectral(d->lap, 2, bad, u, &d->e), HD_ERR_ARGUMENT, "c is not positive", column, 1);
}

/* The Laplacian exp is divided by the area, and its times come in the square of it: the mean of the logs is one time. */
static void doors_times_exp(doors *d) {
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    double t[3];
    memset(&o, 0, sizeof o);
    o.kind = HD_LAPLACIAN_EXP;
    CHECK(hd_laplacian_points(&lap, d->s.xyz, d->s.n, &o, &d->e) >= 0);
    CHECK(hd_times_auto(lap, 3, t, &d->e) == HD_OK);
    CHECK(fabs(t[0] / (0.0024 * lap->area * lap->area) - 1) < 1e-12 && fabs(t[2] / (0.37 * lap->area * lap->area) - 1) < 1e-12);
    CHECK(fabs(t[1] / sqrt(t[0] * t[2]) - 1) < 1e-12 && hd_times_auto(lap, 1, t, &d->e) == HD_OK && fabs(t[0] / t[1] - 1) < 1e-12);
    hd_laplacian_free(lap);
}

/* One vertex has no eigenvalue but that of the constants, and no time follows from it. */
static void doors_one_vertex(doors *d) {
    const hd_csr L = test_diagonal_csr(1, NULL);
    hd_csr zero = L, B = test_diagonal_csr(1, NULL);
    const double c = 1;
    double t = 7, nothing = 0;
    hd_laplacian *lap = NULL;
    zero.val = &nothing;
    CHECK(hd_laplacian_matrices(&lap, &zero, &B, 1, NULL, &d->e) == HD_OK && lap->conserves);
    DOORS_BAD(hd_times_spectral(lap, 1, &c, &t, &d->e), "only eigenvalues are those of constants");
    CHECK(t == 7);
    hd_laplacian_free(lap);
    zero = L;
    hd_csr_free(&zero, NULL);
    hd_csr_free(&B, NULL);
}

static void doors_rationals(doors *d) {
    const double t = 1, nan = (double)NAN;
    const double tols[3] = {nan, -1, 1};
    hd_filter f;
    hd_rational set;
    hd_solve_opts o, zero;
    hd_c64 x[DOORS_N];
    int k;
    memset(&f, 0, sizeof f);
    memset(&zero, 0, sizeof zero);
    memset(x, 0, sizeof x);
    DOORS_NULL(hd_rational_shared(NULL, 1, &t, 0, NULL, &d->e));
    DOORS_NULL(hd_rational_shared(&set, 1, NULL, 0, NULL, &d->e));
    DOORS_NULL(hd_rational_fit(NULL, &f, 1, NULL, &d->e));
    DOORS_NULL(hd_rational_fit(&set, NULL, 1, NULL, &d->e));
    DOORS_NULL(hd_rational_fit_shared(NULL, 1, &f, 1, NULL, &d->e));
    DOORS_NULL(hd_rational_fit_shared(&set, 1, NULL, 1, NULL, &d->e));
    DOORS_BAD(hd_rational_fit_shared(&set, 0, &f, 1, NULL, &d->e), "there is none");
    DOORS_NULL(hd_shifted_solve(NULL, 1, test_c(1, 1), x, x, NULL, NULL, &d->e));
    DOORS_NULL(hd_shifted_solve(d->lap, 1, test_c(1, 1), NULL, x, NULL, NULL, &d->e));
    DOORS_NULL(hd_shifted_solve(d->lap, 1, test_c(1, 1), x, NULL, NULL, NULL, &d->e));
    DOORS_BAD(hd_shifted_solve(d->lap, -1, test_c(1, 1), x, x, NULL, NULL, &d->e), "t is negative");
    DOORS_BAD(hd_shifted_solve(d->lap, nan, test_c(1, 1), x, x, NULL, NULL, &d->e), "t is negative or not finite");
    DOORS_BAD(hd_shifted_solve(d->lap, 1, test_c(0, 0), x, x, NULL, NULL, &d->e), "theta lies on");
    DOORS_BAD(hd_shifted_solve(d->lap, 1, test_c(nan, 1), x, x, NULL, NULL, &d->e), "not finite");
    for (k = 0; k < 3; k++) {
        o = zero;
        o.tol = tols[k];
        DOORS_BAD(hd_shifted_solve(d->lap, 1, test_c(1, 1), x, x, &o, NULL, &d->e), "tol is not in");
    }
#define DOORS_SOLVE(field, bad_value, say) o = zero; o.field = bad_value; DOORS_BAD(hd_shifted_solve(d->lap, 1, test_c(1, 1), x, x, &o, NULL, &d->e), say)
    DOORS_SOLVE(solver, HD_SOLVER_LANCZOS, "cocg, cocr or minres");
    DOORS_SOLVE(solver, (hd_solver)-1, "cocg, cocr or minres");
    DOORS_SOLVE(precond, (hd_precond)99, "unknown preconditioner");
    DOORS_SOLVE(precond, (hd_precond)-1, "unknown preconditioner");
    DOORS_SOLVE(max_iterations, -1, "max_iterations");
#undef DOORS_SOLVE
}

/* ---- plans ---- */

static void doors_plans(doors *d) {
    hd_heat *heat = rob_mark_heat;
    hd_heat_opts o, zero;
    hd_rational set;
    memset(&zero, 0, sizeof zero);
    CHECK(hd_rational_get(&set, HD_POLES_UNIFORM, 4, &d->e) == HD_OK);
#define DOORS_PLAN(put, say) o = zero; put; DOORS_BAD(hd_heat_create(&heat, d->lap, &o, &d->e), say)
    DOORS_PLAN(o.method = (hd_method)-1, "unknown method");
    DOORS_PLAN(o.solver = (hd_solver)-1, "unknown solver");
    DOORS_PLAN(o.precond = (hd_precond)-1, "unknown preconditioner");
    DOORS_PLAN(o.poles = (hd_pole_kind)-1, "poles are uniform");
    DOORS_PLAN((o.poles = HD_POLES_DIAGONAL, o.degree = 1), "degrees 2 to 14");
    DOORS_PLAN(o.ordering = (hd_ordering)-1, "unknown ordering");
    DOORS_PLAN(o.ordering = (hd_ordering)99, "unknown ordering");
    DOORS_PLAN(o.ordering = HD_ORDERING_OWN, "no permutation");
    DOORS_PLAN((o.method = HD_METHOD_KRYLOV, o.rational = &set), "no use for poles");
    DOORS_PLAN((o.method = HD_METHOD_KRYLOV, o.poles = HD_POLES_UNIFORM), "no use for poles");
    DOORS_PLAN((o.method = HD_METHOD_KRYLOV, o.degree = 7), "no use for poles");
    DOORS_PLAN((o.method = HD_METHOD_KRYLOV, o.solver = HD_SOLVER_COCG), "belong to the iterative");
    DOORS_PLAN((o.method = HD_METHOD_DIRECT, o.solver = HD_SOLVER_COCG), "belong to the iterative");
    DOORS_PLAN((o.method = HD_METHOD_DIRECT, o.precond = HD_PRECOND_JACOBI), "belong to the iterative");
#undef DOORS_PLAN
    CHECK(heat == rob_mark_heat);
}

static void doors_queries(doors *d) {
    const double t[2] = {1, 2}, low[2] = {1, -1}, nan[2] = {1, (double)NAN}, zero = 0;
    const int32_t v[2] = {0, 1}, far[2] = {0, DOORS_N};
    hd_heat *const h = d->heat;
    double f[8 * DOORS_N] = {0}, u[8 * DOORS_N] = {0};
    hd_report rep;
    DOORS_NULL(hd_heat_set_rational(NULL, NULL, &d->e));
    DOORS_BAD(hd_heat_apply(h, 0, t, 1, f, 0, u, 0, NULL, &d->e), "there is no time");
    DOORS_NULL(hd_heat_apply(h, 1, NULL, 1, f, 0, u, 0, NULL, &d->e));
    DOORS_AT(hd_heat_apply(h, 2, low, 1, f, 0, u, 0, NULL, &d->e), HD_ERR_ARGUMENT, "t is negative", column, 1);
    DOORS_AT(hd_heat_apply(h, 2, nan, 1, f, 0, u, 0, &rep, &d->e), HD_ERR_ARGUMENT, "t is negative", column, 1);
    CHECK(rep.error.column == 1);
    DOORS_NULL(hd_heat_apply(h, 1, t, 1, NULL, 0, u, 0, NULL, &d->e));
    DOORS_NULL(hd_heat_apply(h, 1, t, 1, f, 0, NULL, 0, NULL, &d->e));
    DOORS_BAD(hd_heat_apply(h, 1, t, -1, f, 0, u, 0, NULL, &d->e), "is negative");
    DOORS_BAD(hd_heat_apply(h, 1, t, 1, f, DOORS_N - 1, u, 0, NULL, &d->e), "leading dimension");
    DOORS_BAD(hd_heat_apply(h, 1, t, 1, f, 0, u, DOORS_N - 1, NULL, &d->e), "leading dimension");
    DOORS_BAD(hd_heat_apply(h, 2, t, 1, f, 0, f, 0, NULL, &d->e), "one time only");
    DOORS_BAD(hd_heat_columns(h, (hd_kernel)9, 1, t, 1, v, u, 0, NULL, &d->e), "operator or symmetric");
    DOORS_BAD(hd_heat_columns(h, HD_KERNEL_OPERATOR, 1, t, -1, v, u, 0, NULL, &d->e), "is negative");
    DOORS_NULL(hd_heat_columns(h, HD_KERNEL_OPERATOR, 1, t, 1, NULL, u, 0, NULL, &d->e));
    DOORS_NULL(hd_heat_columns(h, HD_KERNEL_OPERATOR, 1, t, 1, v, NULL, 0, NULL, &d->e));
    DOORS_AT(hd_heat_columns(h, HD_KERNEL_OPERATOR, 1, t, 2, far, u, 0, NULL, &d->e), HD_ERR_INDEX, "", column, 1);
    DOORS_BAD(hd_heat_columns_from(h, HD_KERNEL_OPERATOR, 0, t, 0, NULL, u, 0, NULL, &d->e), "there is no time");
    DOORS_BAD(hd_heat_entries(h, HD_KERNEL_OPERATOR, 0, t, 1, v, v, u, NULL, &d->e), "there is no time");
    DOORS_BAD(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, t, -1, v, v, u, NULL, &d->e), "pairs is negative");
    DOORS_NULL(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, t, 1, NULL, v, u, NULL, &d->e));
    DOORS_NULL(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, t, 1, v, NULL, u, NULL, &d->e));
    DOORS_NULL(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, t, 1, v, v, NULL, NULL, &d->e));
    DOORS_AT(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, t, 2, far, v, u, NULL, &d->e), HD_ERR_INDEX, "", row, 1);
    DOORS_AT(hd_heat_entries(h, HD_KERNEL_OPERATOR, 1, t, 2, v, far, u, NULL, &d->e), HD_ERR_INDEX, "", row, 1);
    DOORS_AT(hd_heat_diagonal(h, HD_KERNEL_OPERATOR, 1, &zero, u, 0, NULL, &d->e), HD_ERR_ARGUMENT, "not positive", column, 0);
    DOORS_NULL(hd_heat_diagonal(h, HD_KERNEL_OPERATOR, 1, t, NULL, 0, NULL, &d->e));
    DOORS_BAD(hd_heat_diagonal(h, (hd_kernel)9, 1, t, u, 0, NULL, &d->e), "operator or symmetric");
    DOORS_NULL(hd_heat_trace(h, 1, t, NULL, NULL, NULL, &d->e));
    DOORS_BAD(hd_heat_trace(h, 0, t, u, NULL, NULL, &d->e), "there is no time");
    DOORS_NULL(hd_heat_normalised(h, 1, t, NULL, 0, NULL, &d->e));
    DOORS_BAD(hd_heat_normalised(h, 0, t, u, 0, NULL, &d->e), "there is no time");
    DOORS_BAD(hd_heat_edges(h, HD_KERNEL_OPERATOR, 1, t, u, NULL, &d->e), "the kernel is the symmetric one");
    DOORS_NULL(hd_heat_edges(h, HD_KERNEL_SYMMETRIC, 1, t, NULL, NULL, &d->e));
    DOORS_BAD(hd_heat_edges(h, HD_KERNEL_SYMMETRIC, 0, t, u, NULL, &d->e), "there is no time");
    CHECK(u[0] == 0);
}

/* Diagonals and distances of a plan that may only iterate; signatures and distances with bad numbers. */
static void doors_distances(doors *d) {
    const double t[2] = {1, 2}, inf = (double)INFINITY;
    const int32_t v[2] = {0, 1}, far[2] = {0, DOORS_N};
    const hd_source from = doors_source(v);
    const hd_distance_kind C = HD_DISTANCE_CLASSICAL;
    hd_heat *const h = d->heat;
    double u[8 * DOORS_N] = {0};
    int32_t vertex[2] = {0, DOORS_N};
    hd_rational set;
    const char *const direct = "need the direct method";
    memset(&set, 0, sizeof set);
    DOORS_BAD(hd_heat_diagonal(d->loop, HD_KERNEL_OPERATOR, 1, t, u, 0, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_trace(d->loop, 1, t, u, NULL, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_normalised(d->loop, 1, t, u, 0, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_scale_invariant(d->loop, 1, 2, 3, 1, u, 0, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_edges(d->loop, HD_KERNEL_SYMMETRIC, 1, t, u, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_distance(d->loop, C, 1, t, 1, v, u, 0, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_distance(d->loop, HD_DISTANCE_COMMUTE, 0, NULL, 1, v, u, 0, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_sample(d->loop, C, 1, 2, 0, vertex, u, NULL, &d->e), direct);
    DOORS_BAD(hd_heat_scale_invariant(h, 0, 2, 3, 1, u, 0, NULL, &d->e), "0 < t0 < t1");
    DOORS_BAD(hd_heat_scale_invariant(h, 2, 1, 3, 1, u, 0, NULL, &d->e), "0 < t0 < t1");
    DOORS_BAD(hd_heat_scale_invariant(h, 2, inf, 3, 1, u, 0, NULL, &d->e), "0 < t0 < t1");
    DOORS_BAD(hd_heat_scale_invariant(h, 1, 2, 2, 1, u, 0, NULL, &d->e), "3 or more");
    DOORS_BAD(hd_heat_scale_invariant(h, 1, 2, 3, 0, u, 0, NULL, &d->e), "n_freq in 1..");
    DOORS_BAD(hd_heat_scale_invariant(h, 1, 2, 3, 3, u, 0, NULL, &d->e), "n_freq in 1..");
    DOORS_NULL(hd_heat_scale_invariant(h, 1, 2, 3, 1, NULL, 0, NULL, &d->e));
    DOORS_BAD(hd_heat_filter_diagonals(h, 1, &set, u, 0, NULL, NULL, NULL, &d->e), "no set of a filter");
    DOORS_NULL(hd_heat_filter_diagonals(h, 1, NULL, u, 0, NULL, NULL, NULL, &d->e));
    DOORS_NULL(hd_heat_filter_diagonals(h, 1, &set, NULL, 0, NULL, NULL, NULL, &d->e));
    DOORS_BAD(hd_heat_distance(h, (hd_distance_kind)-1, 1, t, 1, v, u, 0, NULL, &d->e), "unknown kind");
    DOORS_BAD(hd_heat_distance(h, (hd_distance_kind)99, 1, t, 1, v, u, 0, NULL, &d->e), "unknown kind");
    DOORS_AT(hd_heat_distance(h, HD_DISTANCE_COMMUTE, 2, t, 1, v, u, 0, NULL, &d->e), HD_ERR_ARGUMENT, "n_times is 0 or 1", value, 2);
    DOORS_AT(hd_heat_distance(h, HD_DISTANCE_BIHARMONIC, -1, t, 1, v, u, 0, NULL, &d->e), HD_ERR_ARGUMENT, "n_times is 0 or 1", value, -1);
    DOORS_BAD(hd_heat_distance(h, C, 1, t, -1, v, u, 0, NULL, &d->e), "is negative");
    DOORS_NULL(hd_heat_distance(h, C, 1, t, 1, NULL, u, 0, NULL, &d->e));
    DOORS_NULL(hd_heat_distance(h, C, 1, t, 1, v, NULL, 0, NULL, &d->e));
    DOORS_AT(hd_heat_distance(h, C, 1, t, 2, far, u, 0, NULL, &d->e), HD_ERR_INDEX, "", column, 1);
    CHECK(hd_heat_distance(h, C, 1, t, 0, NULL, NULL, 0, NULL, &d->e) == HD_OK);
    DOORS_BAD(hd_heat_pairs(h, C, 1, t, -1, v, v, u, u, NULL, &d->e), "pairs is negative");
    DOORS_NULL(hd_heat_pairs(h, C, 1, t, 1, NULL, v, u, u, NULL, &d->e));
    DOORS_BAD(hd_heat_pairs(h, C, 0, t, 1, v, v, u, u, NULL, &d->e), "there is no time");
    DOORS_BAD(hd_heat_sample(h, C, 1, 0, 0, vertex, u, NULL, &d->e), "more points than vertices, or none");
    DOORS_BAD(hd_heat_sample(h, C, 1, 2, -1, vertex, u, NULL, &d->e), "more points than vertices, or none");
    DOORS_BAD(hd_heat_sample(h, C, 1, 2, 3, vertex, u, NULL, &d->e), "more points than vertices, or none");
    DOORS_AT(hd_heat_sample(h, C, 1, DOORS_N + 1, 0, vertex, u, NULL, &d->e), HD_ERR_ARGUMENT, "more points", value, DOORS_N + 1);
    DOORS_NULL(hd_heat_sample(h, C, 1, 2, 0, NULL, u, NULL, &d->e));
    DOORS_AT(hd_heat_sample(h, C, 1, 2, 2, vertex, u, NULL, &d->e), HD_ERR_INDEX, "", column, 1);
    DOORS_BAD(hd_heat_sample_from(h, C, 1, -1, &from, 2, vertex, u, NULL, &d->e), "sources is negative");
    DOORS_NULL(hd_heat_sample_from(h, C, 1, 1, NULL, 2, vertex, u, NULL, &d->e));
    CHECK(u[0] == 0);
}

/* ---- geodesic plans ---- */

static void doors_geodesics(doors *d) {
    const int64_t ptr[2] = {0, 3};
    const int32_t v[2] = {0, DOORS_N};
    const shape *const s = &d->s;
    double len[3 * 20], u[2 * DOORS_N] = {0};
    hd_geodesic_opts o, zero;
    hd_geodesic *g = NULL;
    hd_geodesic_report rep;
    int k;
    CHECK(s->n_tri == 20);
    for (k = 0; k < 60; k++) len[k] = 1;
    memset(&zero, 0, sizeof zero);
    DOORS_NULL(hd_geodesic_create(NULL, s->xyz, s->n, s->tri, s->n_tri, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create(&g, NULL, s->n, s->tri, s->n_tri, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create(&g, s->xyz, s->n, NULL, s->n_tri, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_polygons(&g, NULL, s->n, ptr, s->tri, 1, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_polygons(&g, s->xyz, s->n, NULL, s->tri, 1, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_points(&g, NULL, s->n, NULL, NULL, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_points(&g, s->xyz, 1, ptr, NULL, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_points(&g, s->xyz, s->n, NULL, s->tri, NULL, &d->e));
    DOORS_BAD(hd_geodesic_create_points(&g, s->xyz, -1, ptr, s->tri, NULL, &d->e), "size is negative");
    DOORS_NULL(hd_geodesic_create_lengths(&g, NULL, s->n, s->tri, s->n_tri, NULL, &d->e));
    DOORS_NULL(hd_geodesic_create_lengths(&g, len, s->n, NULL, s->n_tri, NULL, &d->e));
    DOORS_BAD(hd_geodesic_create(&g, s->xyz, -1, s->tri, s->n_tri, NULL, &d->e), "size is negative");
    DOORS_BAD(hd_geodesic_create(&g, s->xyz, s->n, s->tri, -1, NULL, &d->e), "size is negative");
#define DOORS_GEODESIC(field, bad_value, say) o = zero; o.field = bad_value; DOORS_BAD(hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), say)
    DOORS_GEODESIC(begin_zero, 1, "not cleared");
    DOORS_GEODESIC(end_zero, 1, "not cleared");
    DOORS_GEODESIC(t, -1, "t is negative");
    DOORS_GEODESIC(t, (double)NAN, "t is negative or not finite");
    DOORS_GEODESIC(t_in_h2, -1, "t_in_h2 is negative");
    DOORS_GEODESIC(t_in_h2, (double)INFINITY, "t_in_h2 is negative or not finite");
    DOORS_GEODESIC(mass, (hd_geodesic_mass)-1, "unknown mass");
    DOORS_GEODESIC(mass, (hd_geodesic_mass)99, "unknown mass");
    DOORS_GEODESIC(border, (hd_geodesic_border)-1, "unknown border");
    DOORS_GEODESIC(border, (hd_geodesic_border)99, "unknown border");
    DOORS_GEODESIC(ordering, (hd_ordering)99, "unknown ordering");
    DOORS_GEODESIC(ordering, HD_ORDERING_OWN, "no permutation");
    DOORS_GEODESIC(lambda, -1, "lambda is not between");
    DOORS_GEODESIC(lambda, 1e101, "lambda is not between");
    DOORS_GEODESIC(lambda, (double)NAN, "lambda is not between");
    DOORS_GEODESIC(neighbours, 5, "6..128");
    DOORS_GEODESIC(neighbours, 129, "6..128");
    DOORS_GEODESIC(mollify, (double)NAN, "mollify");
    DOORS_GEODESIC(mollify, 2, "mollify");
#undef DOORS_GEODESIC
    o = zero;
    o.ordering = HD_ORDERING_OWN;
    o.perm = s->tri;
    CHECK(hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e) < 0 && !g);     /* not a permutation */
    o = zero;
    o.updatable = 1;
    DOORS_BAD(hd_geodesic_create_lengths(&g, len, s->n, s->tri, s->n_tri, &o, &d->e), "of lengths is not updatable");
    DOORS_BAD(hd_geodesic_create_polygons(&g, s->xyz, s->n, ptr, s->tri, 1, &o, &d->e), "triangles in space are updatable");
    o.tufted = 1;
    DOORS_BAD(hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, &o, &d->e), "triangles in space are updatable");
    o = zero;
    o.mass = HD_GEODESIC_MASS_VORONOI;
    DOORS_BAD(hd_geodesic_create_polygons(&g, s->xyz, s->n, ptr, s->tri, 1, &o, &d->e), "of triangles, not of polygons");
    o = zero;
    o.border = HD_GEODESIC_BORDER_DIRICHLET;
    DOORS_BAD(hd_geodesic_create_points(&g, s->xyz, s->n, NULL, NULL, &o, &d->e), "cannot tell their border");
    DOORS_NULL(hd_geodesic_update(NULL, s->xyz, &d->e));
    DOORS_NULL(hd_geodesic_update(d->geodesic, NULL, &d->e));
    DOORS_NULL(hd_geodesic_update_view(NULL, NULL, &d->e));
    DOORS_NULL(hd_geodesic_distance(NULL, 1, v, u, NULL, &d->e));
    DOORS_NULL(hd_geodesic_distance(d->geodesic, 1, NULL, u, &rep, &d->e));
    CHECK(rep.status == HD_ERR_ARGUMENT && strstr(rep.error.text, doors_missing));
    DOORS_NULL(hd_geodesic_distance(d->geodesic, 1, v, NULL, NULL, &d->e));
    DOORS_BAD(hd_geodesic_distance(d->geodesic, 0, v, u, NULL, &d->e), "there is no source");
    DOORS_AT(hd_geodesic_distance(d->geodesic, 2, v, u, NULL, &d->e), HD_ERR_INDEX, "not in the mesh", column, 1);
    DOORS_BAD(hd_geodesic_distance_each(d->geodesic, -1, v, u, 0, NULL, &d->e), "is negative");
    DOORS_BAD(hd_geodesic_distance_each(d->geodesic, 1, v, u, DOORS_N - 1, NULL, &d->e), "leading dimension");
    DOORS_NULL(hd_geodesic_distance_from(d->geodesic, NULL, u, NULL, &d->e));
    CHECK(!g && u[0] == 0);
}

/* ---- what is taken ---- */

/* An order of one's own and columns farther apart change places, not values. */
static void doors_spectrum_taken(doors *d) {
    const double t = 0.3;
    const int32_t v[2] = {2, 9};
    double u[2 * DOORS_N], apart[2 * (DOORS_N + 3)];
    int32_t perm[DOORS_N], q;
    hd_spectrum_opts o;
    hd_spectrum *own = NULL;
    memset(&o, 0, sizeof o);
    for (q = 0; q < DOORS_N; q++) perm[q] = DOORS_N - 1 - q;
    o.count = 4;
    o.tol = 1e-9;
    o.ordering = HD_ORDERING_OWN;
    o.perm = perm;
    if (!CHECK_MSG(hd_spectrum_create(&own, d->lap, &o, &d->e) == HD_OK, "%s", d->e.text)) return;
    for (q = 0; q < 4; q++) CHECK(fabs(own->value[q] - d->spectrum->value[q]) <= 1e-9 * d->spectrum->value[3]);
    CHECK(hd_spectrum_columns(own, HD_KERNEL_OPERATOR, 1, &t, 2, v, u, NULL, 0, &d->e) == HD_OK);
    CHECK(hd_spectrum_columns(own, HD_KERNEL_OPERATOR, 1, &t, 2, v, apart, NULL, DOORS_N + 3, &d->e) == HD_OK);
    CHECK(memcmp(u, apart, DOORS_N * sizeof *u) == 0 && memcmp(u + DOORS_N, apart + DOORS_N + 3, DOORS_N * sizeof *u) == 0);
    hd_spectrum_free(own);
}

/* Fields that lie farther apart than their answers, in one array. */
static void doors_in_place(doors *d) {
    enum { K = 3, WIDE = DOORS_N + 4 };
    const double t = 0.2;
    double F[K * WIDE], U[K * DOORS_N];
    int32_t q;
    for (q = 0; q < K * WIDE; q++) F[q] = q % 11 - 3;
    CHECK(hd_heat_apply(d->heat, 1, &t, K, F, WIDE, U, DOORS_N, NULL, &d->e) == HD_OK);
    CHECK(hd_heat_apply(d->heat, 1, &t, K, F, WIDE, F, DOORS_N, NULL, &d->e) == HD_OK && memcmp(F, U, sizeof U) == 0);
}

/* A plan takes sets of one time, one lambda_max and the same poles; Lanczos takes none. */
static void doors_filter_sets(doors *d) {
    const double top = hd_laplacian_lambda_max(d->lap);
    double D[2 * DOORS_N];
    hd_rational sets[2];
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_filter f;
    int k;
    memset(&o, 0, sizeof o);
    memset(&f, 0, sizeof f);
    f.kind = HD_FILTER_HEAT;
    f.a = 1;
    CHECK(hd_rational_fit(sets, &f, top, NULL, &d->e) == HD_OK);
    o.rational = sets;
    if (!CHECK(hd_heat_create(&heat, d->lap, &o, &d->e) == HD_OK)) return;
    DOORS_BAD(hd_heat_filter_diagonals(heat, 0, sets, D, 0, NULL, NULL, NULL, &d->e), "there is none");
    for (k = 0; k < 5; k++) {
        sets[1] = sets[0];
        if (k == 0) CHECK(hd_heat_filter_diagonals(heat, 2, sets, D, 0, NULL, NULL, NULL, &d->e) >= 0 && D[0] > 0 && memcmp(D, D + DOORS_N, sizeof D / 2) == 0);
        if (k == 1) sets[1].t *= 2;
        if (k == 2) sets[1].lambda_max *= 2;
        if (k == 3) sets[1].theta[0].re += 1;
        if (k == 4) sets[1].theta[0].im = -1;
        if (k > 0 && k < 4) DOORS_AT(hd_heat_filter_diagonals(heat, 2, sets, D, 0, NULL, NULL, NULL, &d->e), HD_ERR_ARGUMENT, "differs from the plan", column, 1);
        if (k == 4) DOORS_AT(hd_heat_filter_diagonals(heat, 2, sets, D, 0, NULL, NULL, NULL, &d->e), HD_ERR_ARGUMENT, "theta needs", column, 1);
    }
    hd_heat_free(heat);
    heat = NULL;
    o.rational = NULL;
    o.method = HD_METHOD_ITERATIVE;
    o.solver = HD_SOLVER_LANCZOS;
    CHECK(hd_heat_create(&heat, d->lap, &o, &d->e) == HD_OK);
    DOORS_BAD(hd_heat_set_rational(heat, sets, &d->e), "");
    hd_heat_free(heat);
}

static hd_progress doors_stop(void *user, const char *stage, double done) {
    int *left = (int *)user;
    (void)stage;
    (void)done;
    return (*left)-- > 0 ? HD_PROGRESS_CONTINUE : HD_PROGRESS_CANCEL;
}

/* An update that is cancelled half way leaves a plan that says so until the next one. */
static void doors_half_updated(doors *d) {
    const int32_t v = 3;
    double before[DOORS_N], after[DOORS_N];
    int k, left, told = 0, st = HD_ERR_CANCELLED;
    CHECK(hd_geodesic_update(d->geodesic, d->s.xyz, &d->e) >= 0 && hd_geodesic_distance(d->geodesic, 1, &v, before, NULL, &d->e) >= 0);
    d->ctx.progress = doors_stop;
    d->ctx.progress_user = &left;
    for (k = 0; k < 100 && st == HD_ERR_CANCELLED; k++) {
        left = k;
        st = hd_geodesic_update(d->geodesic, d->s.xyz, &d->e);
        left = 1 << 20;
        if (st != HD_ERR_CANCELLED) break;
        if (hd_geodesic_distance(d->geodesic, 1, &v, after, NULL, &d->e) >= 0) continue;       /* nothing had changed yet */
        CHECK(d->e.status == HD_ERR_ARGUMENT && strstr(d->e.text, "the last update failed"));
        told++;
    }
    CHECK(st >= 0 && told > 0);
    d->ctx.progress = NULL;
    CHECK(hd_geodesic_distance(d->geodesic, 1, &v, after, NULL, &d->e) >= 0 && memcmp(before, after, sizeof before) == 0);
}

static void doors_arguments(void) {
    doors all, *const d = &all;
    doors_open(d);
    doors_matrices(d);
    doors_patterns(d);
    doors_factors(d);
    doors_laplacians(d);
    doors_updates(d);
    doors_views(d);
    doors_neighbours(d);
    doors_spectra(d);
    doors_one_vertex(d);
    doors_times_exp(d);
    doors_rationals(d);
    doors_plans(d);
    doors_queries(d);
    doors_distances(d);
    doors_geodesics(d);
    doors_spectrum_taken(d);
    doors_in_place(d);
    doors_filter_sets(d);
    doors_half_updated(d);
    doors_close(d);
}

static void test_doors(void) {
    CHECK(strcmp(hd_status_text((hd_status)12345), "unknown status") == 0);
    CHECK(strcmp(hd_status_text(HD_STATUS_FORCE_INT), "unknown status") == 0);
    CHECK(strcmp(hd_status_name(HD_STATUS_FORCE_INT), "HD_UNKNOWN_STATUS") == 0);
    doors_context();
    doors_arguments();
}

#endif
