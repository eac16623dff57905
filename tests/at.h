/* Heat queries at a single time, and of one field or column at many: what most tests ask. Errors come by the report. */

#ifndef HD_TEST_AT_H
#define HD_TEST_AT_H

static hd_status heat_apply(hd_heat *heat, double t, int32_t k, const double *F, size_t ldf, double *U, size_t ldu,
                            hd_report *report) {
    return hd_heat_apply(heat, 1, &t, k, F, ldf, U, ldu, report, NULL);
}

static hd_status heat_columns(hd_heat *heat, double t, hd_kernel kernel, int32_t k, const int32_t *sources, double *U, size_t ldu,
                              hd_report *report) {
    return hd_heat_columns(heat, kernel, 1, &t, VERTICES(k, sources), U, ldu, report, NULL);
}

static hd_status heat_column(hd_heat *heat, double t, int32_t source, double *u, hd_report *report) {
    return hd_heat_column(heat, HD_KERNEL_OPERATOR, t, source, u, report, NULL);
}

/* f NULL: the column of source. */
static hd_status heat_times(hd_heat *heat, int32_t n_times, const double *t, hd_kernel kernel, int32_t source, const double *f,
                            double *U, size_t ldu, hd_report *report) {
    if (f) return hd_heat_apply(heat, n_times, t, 1, f, 0, U, ldu, report, NULL);
    return hd_heat_columns(heat, kernel, n_times, t, VERTICES(1, &source), U, ldu, report, NULL);
}

/* The answer into an empty matrix, which stays so after an error. */
static hd_status at_sparse(hd_csr *out, hd_heat *heat, hd_kernel kernel, int32_t n_times, const double *t, const hd_sources *sources,
                           hd_report *report, hd_error *e) {
    hd_csr own;
    hd_status st;
    memset(&own, 0, sizeof own);
    st = hd_heat_columns_sparse(heat, kernel, n_times, t, sources, out ? &own : NULL, report, e);
    if (st >= 0) *out = own;
    return st >= 0 || (!own.row_ptr && !own.col && !own.val) ? st : HD_STATUS_FORCE_INT;
}

static hd_status heat_diagonal(hd_heat *heat, int32_t n_times, const double *t, hd_kernel kernel, double *D, size_t ldd,
                               hd_report *report) {
    return hd_heat_diagonal(heat, kernel, n_times, t, D, ldd, NULL, NULL, report, NULL);
}

static hd_status heat_entries(hd_heat *heat, double t, hd_kernel kernel, int64_t n_pairs, const int32_t *i, const int32_t *j,
                              double *values, hd_report *report) {
    return hd_heat_entries(heat, kernel, 1, &t, n_pairs, i, j, values, report, NULL);
}

static hd_status heat_distance(hd_heat *heat, hd_distance_kind kind, int32_t n_times, const double *t, int32_t k,
                               const int32_t *sources, double *D, size_t ldd, hd_report *report) {
    return hd_heat_distance(heat, kind, n_times, t, VERTICES(k, sources), D, ldd, report, NULL);
}

static hd_status heat_pairs(hd_heat *heat, hd_distance_kind kind, double t, int64_t n_pairs, const int32_t *i, const int32_t *j,
                            double *d, hd_report *report) {
    return hd_heat_distance_pairs(heat, kind, 1, &t, n_pairs, i, j, d, report, NULL);
}

/* Vertices after none. */
static hd_status heat_sample(hd_heat *heat, hd_distance_kind kind, double t, int32_t count, int32_t *vertex, double *distance,
                             hd_report *report) {
    return hd_heat_sample(heat, kind, t, NULL, count, vertex, distance, report, NULL);
}

/* Points whose stars are triangulated; o NULL: by default. */
static hd_status at_tufted(hd_laplacian **out, const double *xyz, int32_t n, const int64_t *nbr_ptr, const int32_t *nbr,
                           const hd_laplacian_opts *o, hd_error *e) {
    hd_laplacian_opts own;
    memset(&own, 0, sizeof own);
    if (o) own = *o;
    own.triangulation = HD_TRIANGULATION_TUFTED;
    return hd_laplacian_create(out, MESH_STARS(xyz, n, nbr_ptr, nbr), &own, e);
}

static hd_status at_tufted_geodesic(hd_geodesic **out, const double *xyz, int32_t n, const hd_geodesic_opts *o, hd_error *e) {
    hd_geodesic_opts own;
    memset(&own, 0, sizeof own);
    if (o) own = *o;
    own.triangulation = HD_TRIANGULATION_TUFTED;
    return hd_geodesic_create(out, MESH_POINTS(xyz, n), &own, e);
}

#endif
