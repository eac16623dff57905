/* calls.h - every public function by a short name, with arguments by name; used by failures, robust, doors and threads

   A test says what it does in words: "held direct | n_times=3 columns" holds two vertices, and makes a plan of the direct
   method; that is preparation. What follows the bar is tested: columns at three times. A word is
       a call    of CALLS below. In the preparation the objects that it needs are made first, and what it makes is kept
       a choice  of call_choices, such as `direct`
       x=y       a field of call_args gets a number, NULL, or the value of another field
   Without a bar the last word is tested, and all else is preparation, with that of the call itself in CALLS.
   Where a function changes its name or its arguments, CALLS and call_args say so, and no test. */

#ifndef TEST_CALLS_H
#define TEST_CALLS_H

/* ---- arguments ---- */

typedef struct call_args {
    hd_laplacian *lap, *lap2, *lap3, **out_lap;      /* 2, 3, 4: room for further objects, by x=y */
    hd_heat *heat, *heat2, *heat3, *heat4, **out_heat;
    hd_ldl *ldl, *ldl2, *ldl3, **out_ldl;
    hd_spectrum *spectrum, **out_spectrum;
    hd_geodesic *geodesic, **out_geodesic;
    hd_csr *out_csr;
    hd_rational *out_set;
    hd_context *ctx;

    int32_t n, n_tri, n_times, k, count, n_filters, n_sets, n_matrices, n_queries;
    int32_t rows, cols, source, degree, kernel, kind, poles, query;
    int64_t n_pairs, n_triplets;
    size_t ldf, ld;                          /* of what is given, and of answers */
    double h, time, alpha, beta, tol, lambda_max, x;
    hd_c64 theta;

    const double *xyz, *moved, *lengths, *queries, *triplet_v, *f, *val, *val2, *with_nan, *with_inf;
    const double *t, *late, *endless, *fading, *low, *bad, *zero, *set_t;          /* times; set_t: of a set */
    double set_time, set2_time;
    const int32_t *tri, *nbr, *own_nbr, *perm, *ids, *other, *far_id, *low_id, *triplet_i, *triplet_j;
    const int64_t *face_ptr, *nbr_ptr, *own_ptr;
    const int64_t *back;                     /* first points of sources, the second of which has none */
    int64_t *bent;
    const hd_sources *sources, *curve;
    const hd_c64 *zval, *zb;
    const hd_rational *set, *set2, *both;    /* of filters; both: two that share their poles */
    const hd_filter *filter, *filter2;
    double *u, *v, *bound;                   /* answers */
    hd_c64 *z, *zd;
    int32_t *vertex;

    hd_csr A, L, B, full;                    /* structs, and pointers to them */
    hd_csr *a, *l, *b, *whole;              /* whole: the full one, for b */
    hd_mesh mesh, *view;
    hd_sources from;                         /* for sources */
    hd_laplacian_opts lo, *lap_opts;
    hd_heat_opts ho, *heat_opts;
    hd_spectrum_opts so, *spectrum_opts;
    hd_geodesic_opts go, *geodesic_opts;
    hd_ldl_opts fo, *ldl_opts;
    hd_solve_opts vo, *solve_opts;
    hd_filter filters[2];
    hd_estimate *estimate;
    hd_report *rep;
    hd_geodesic_report *geodesic_rep;
    hd_ldl_report *ldl_rep;
    hd_solve_report *solve_rep;
    hd_error *err;
} call_args;

/* ---- functions ---- */

/* X(short name, function, what comes before, its arguments); V the same of functions without a status, as a statement. */
#define CALLS(X, V)                                                                                                            \
    X(triplets, hd_csr_from_triplets, "",                                                                                      \
      (a->out_csr, a->rows, a->cols, a->n_triplets, a->triplet_i, a->triplet_j, a->triplet_v, a->ctx, a->err))                 \
    X(triangles, hd_laplacian_create, "",                                                                                      \
      (a->out_lap, MESH_TRIANGLES(a->xyz, a->n, a->tri, a->n_tri), a->lap_opts, a->err))                                       \
    X(view, hd_laplacian_create, "", (a->out_lap, a->view, a->lap_opts, a->err))                                               \
    X(lengths, hd_laplacian_create, "",                                                                                        \
      (a->out_lap, MESH_LENGTHS(a->lengths, a->n, a->tri, a->n_tri), a->lap_opts, a->err))                                     \
    X(polygons, hd_laplacian_create, "",                                                                                       \
      (a->out_lap, MESH_POLYGONS(a->xyz, a->n, a->face_ptr, a->tri, a->n_tri), a->lap_opts, a->err))                           \
    X(points, hd_laplacian_create, "", (a->out_lap, MESH_POINTS(a->xyz, a->n), a->lap_opts, a->err))                           \
    X(tufted_points, at_tufted, "", (a->out_lap, a->xyz, a->n, a->nbr_ptr, a->nbr, a->lap_opts, a->err))                       \
    X(matrices, hd_laplacian_matrices, "", (a->out_lap, a->l, a->b, a->h, a->lap_opts, a->err))                                \
    X(lap_apply, hd_laplacian_apply, "", (a->lap, a->alpha, a->beta, a->f, a->u, a->err))                                      \
    X(update, hd_laplacian_update, "updatable", (a->lap, MESH_POINTS(a->moved, a->n), a->err))                                 \
    X(update_view, hd_laplacian_update, "updatable", (a->lap, a->view, a->err))                                                \
    X(update_matrices, hd_laplacian_update_matrices, "updatable matrices", (a->lap, a->l, a->b, a->h, a->err))                 \
    V(lambda_max, hd_laplacian, "", a->u[0] = (a->lap)->lambda_max)                                                            \
    X(nearest, hd_neighbours_nearest, "",                                                                                      \
      (a->xyz, a->n, a->queries, a->n_queries, a->k, a->vertex, a->u, a->ctx, a->err))                                         \
    X(poles, hd_rational_exp, "", (a->out_set, (hd_pole_kind)a->poles, a->degree, a->err))                                     \
    X(shared_poles, hd_rational_shared, "", (a->out_set, a->n_times, a->t, a->tol, a->ctx, a->err))                            \
    V(poles_at, hd_rational_eval, "poles", a->u[0] = hd_rational_eval(a->set, a->x))                                           \
    X(fit, hd_rational_fit, "", (a->out_set, a->n_filters, a->filter, a->lambda_max, a->ctx, a->err))                          \
    V(filter_at, hd_filter_eval, "", a->u[0] = hd_filter_eval(a->filter, a->x))                                                \
    X(shifted, hd_shifted_solve, "", (a->lap, a->time, a->theta, a->zb, a->z, a->solve_opts, a->solve_rep, a->err))            \
    X(analyse, hd_ldl_analyse, "", (a->out_ldl, a->a, a->ldl_opts, a->ldl_rep, a->err))                                        \
    X(factor, hd_ldl_factor, "", (a->ldl, a->val, a->ldl_rep, a->err))                                                         \
    X(factor_c, hd_ldl_factor_complex, "", (a->ldl, a->n_matrices, a->zval, a->ldl_rep, a->err))                               \
    X(solve, hd_ldl_solve, "factor", (a->ldl, a->k, a->f, a->ldf, a->u, a->ld, a->err))                                        \
    X(solve_c, hd_ldl_solve_complex, "factor_c", (a->ldl, a->zb, a->ldf, a->z, a->ld, a->err))                                 \
    X(inverse, hd_ldl_inverse, "factor", (a->ldl, a->u, a->v, a->err))                                                         \
    X(inverse_c, hd_ldl_inverse_complex, "factor_c", (a->ldl, a->z, a->zd, a->err))                                            \
    X(plan, hd_heat_create, "", (a->out_heat, a->lap, a->heat_opts, a->err))                                                   \
    X(set_rational, hd_heat_set_rational, "", (a->heat, a->n_sets, a->set, a->err))                                            \
    X(apply, hd_heat_apply, "", (a->heat, a->n_times, a->t, a->k, a->f, a->ldf, a->u, a->ld, a->rep, a->err))                  \
    X(derivative, hd_heat_derivative, "", (a->heat, a->n_times, a->t, a->k, a->f, a->ldf, a->u, a->ld, a->rep, a->err))        \
    X(adjoint, hd_heat_adjoint, "", (a->heat, a->n_times, a->t, a->k, a->f, a->ldf, a->u, a->ld, a->rep, a->err))              \
    X(columns, hd_heat_columns, "",                                                                                            \
      (a->heat, (hd_kernel)a->kernel, a->n_times, a->t, VERTICES(a->k, a->ids), a->u, a->ld, a->rep, a->err))                  \
    X(columns_sparse, at_sparse, "",                                                                                           \
      (a->out_csr, a->heat, (hd_kernel)a->kernel, a->n_times, a->t, VERTICES(a->k, a->ids), a->rep, a->err))                   \
    X(column, hd_heat_column, "", (a->heat, (hd_kernel)a->kernel, a->time, a->source, a->u, a->rep, a->err))                   \
    X(columns_from, hd_heat_columns, "",                                                                                       \
      (a->heat, (hd_kernel)a->kernel, a->n_times, a->t, a->sources, a->u, a->ld, a->rep, a->err))                              \
    X(diagonal, hd_heat_diagonal, "",                                                                                          \
      (a->heat, (hd_kernel)a->kernel, a->n_times, a->t, a->u, a->ld, a->v, a->bound, a->rep, a->err))                          \
    X(times_auto, hd_times_auto, "", (a->lap, a->n_times, a->u, a->err))                                                       \
    X(distance, hd_heat_distance, "",                                                                                          \
      (a->heat, (hd_distance_kind)a->kind, a->n_times, a->t, VERTICES(a->k, a->ids), a->u, a->ld, a->rep, a->err))             \
    X(distance_from, hd_heat_distance, "",                                                                                     \
      (a->heat, (hd_distance_kind)a->kind, a->n_times, a->t, a->sources, a->u, a->ld, a->rep, a->err))                         \
    X(pairs, hd_heat_distance_pairs, "",                                                                                       \
      (a->heat, (hd_distance_kind)a->kind, a->n_times, a->t, a->n_pairs, a->ids, a->other, a->u, a->rep, a->err))              \
    X(sample, hd_heat_sample, "",                                                                                              \
      (a->heat, (hd_distance_kind)a->kind, a->time, VERTICES(a->k, a->ids), a->count, a->vertex, a->u, a->rep, a->err))        \
    X(sample_from, hd_heat_sample, "",                                                                                         \
      (a->heat, (hd_distance_kind)a->kind, a->time, a->sources, a->count, a->vertex, a->u, a->rep, a->err))                    \
    X(entries, hd_heat_entries, "",                                                                                            \
      (a->heat, (hd_kernel)a->kernel, a->n_times, a->t, a->n_pairs, a->ids, a->other, a->u, a->rep, a->err))                   \
    X(eigenpairs, hd_spectrum_create, "", (a->out_spectrum, a->lap, a->spectrum_opts, a->err))                                 \
    X(eigen_columns, hd_spectrum_columns, "",                                                                                  \
      (a->spectrum, (hd_kernel)a->kernel, a->n_times, a->t, VERTICES(a->k, a->ids), a->u, a->v, a->ld, a->err))                \
    X(eigen_diagonal, hd_spectrum_diagonal, "",                                                                                \
      (a->spectrum, (hd_kernel)a->kernel, a->n_times, a->t, a->u, a->v, a->ld, a->err))                                        \
    X(eigen_distance, hd_spectrum_distance, "",                                                                                \
      (a->spectrum, (hd_distance_kind)a->kind, a->n_times, a->t, VERTICES(a->k, a->ids), a->u, a->v, a->ld, a->err))           \
    X(eigen_columns_from, hd_spectrum_columns, "",                                                                             \
      (a->spectrum, (hd_kernel)a->kernel, a->n_times, a->t, a->sources, a->u, a->v, a->ld, a->err))                            \
    X(eigen_distance_from, hd_spectrum_distance, "",                                                                           \
      (a->spectrum, (hd_distance_kind)a->kind, a->n_times, a->t, a->sources, a->u, a->v, a->ld, a->err))                       \
    X(estimate, hd_heat_estimate, "", (a->heat, (hd_query)a->query, a->n_times, a->t, a->k, a->estimate, a->err))              \
    X(geodesic, hd_geodesic_create, "",                                                                                        \
      (a->out_geodesic, MESH_TRIANGLES(a->xyz, a->n, a->tri, a->n_tri), a->geodesic_opts, a->err))                             \
    X(geodesic_lengths, hd_geodesic_create, "",                                                                                \
      (a->out_geodesic, MESH_LENGTHS(a->lengths, a->n, a->tri, a->n_tri), a->geodesic_opts, a->err))                           \
    X(geodesic_view, hd_geodesic_create, "", (a->out_geodesic, a->view, a->geodesic_opts, a->err))                             \
    X(geodesic_polygons, hd_geodesic_create, "",                                                                               \
      (a->out_geodesic, MESH_POLYGONS(a->xyz, a->n, a->face_ptr, a->tri, a->n_tri), a->geodesic_opts, a->err))                 \
    X(geodesic_points, at_tufted_geodesic, "", (a->out_geodesic, a->xyz, a->n, a->geodesic_opts, a->err))                      \
    X(geodesic_update, hd_geodesic_update, "updatable", (a->geodesic, MESH_POINTS(a->moved, a->n), a->err))                    \
    X(geodesic_update_view, hd_geodesic_update, "updatable", (a->geodesic, a->view, a->err))                                   \
    X(geodesic_set, hd_geodesic_distance, "",                                                                                  \
      (a->geodesic, TOGETHER(a->k, a->ids), a->u, a->ld, a->geodesic_rep, a->err))                                             \
    X(geodesic_each, hd_geodesic_distance, "",                                                                                 \
      (a->geodesic, VERTICES(a->k, a->ids), a->u, a->ld, a->geodesic_rep, a->err))                                             \
    X(geodesic_from, hd_geodesic_distance, "", (a->geodesic, a->sources, a->u, a->ld, a->geodesic_rep, a->err))

typedef struct call_row { const char *name, *function, *before, *args; hd_status (*run)(const call_args *a); } call_row;

#define CALL_STATUS(name, function, before, args) static hd_status call_##name(const call_args *a) { return function args; }
#define CALL_VOID(name, function, before, what) static hd_status call_##name(const call_args *a) { what; return HD_OK; }
CALLS(CALL_STATUS, CALL_VOID)

#define CALL_ROW(name, function, before, args) {#name, #function, before, #args, call_##name},
static const call_row call_table[] = {CALLS(CALL_ROW, CALL_ROW)};
enum { N_CALLS = sizeof call_table / sizeof *call_table };

/* Does it take this argument, of so many letters? */
static int call_takes(const call_row *c, const char *field, size_t length) {
    const char *at = c->args;
    while ((at = strstr(at, field)) != NULL) {
        if (strchr(",)[", at[length])) return 1;
        at += length;
    }
    return 0;
}

#define CALL_TAKES(c, field) call_takes(c, "a->" field, sizeof "a->" field - 1)

/* ---- words ---- */

typedef enum call_type { CALL_INT, CALL_LONG, CALL_SIZE, CALL_DOUBLE, CALL_POINTER, CALL_TYPES } call_type;

typedef struct call_field { const char *name; size_t at; call_type type; } call_field;

#define CALL_AT(field) offsetof(call_args, field)
#define I(field) {#field, CALL_AT(field), CALL_INT}
#define L(field) {#field, CALL_AT(field), CALL_LONG}
#define S(field) {#field, CALL_AT(field), CALL_SIZE}
#define D(field) {#field, CALL_AT(field), CALL_DOUBLE}
#define P(field) {#field, CALL_AT(field), CALL_POINTER}
static const call_field call_fields[] = {
    P(lap), P(lap2), P(lap3), P(out_lap), P(heat), P(heat2), P(heat3), P(heat4), P(out_heat), P(ldl), P(ldl2), P(ldl3), P(out_ldl),
    P(spectrum), P(out_spectrum), P(geodesic), P(out_geodesic), P(out_csr), P(out_set), P(ctx), I(n), I(n_tri), I(n_times), I(k),
    I(count), I(n_filters), I(n_sets), I(n_matrices), I(n_queries), I(rows),
    I(cols), I(source), I(degree), I(kernel), I(kind), I(poles), I(query), L(n_pairs), L(n_triplets), S(ldf), S(ld),
    D(h), D(time), D(alpha), D(beta), D(tol), D(lambda_max), D(x), D(theta.re), D(theta.im),
    D(set_time), D(set2_time),
    P(xyz), P(moved), P(lengths), P(queries), P(triplet_v), P(f), P(val), P(val2), P(with_nan), P(with_inf), P(t), P(late),
    P(endless), P(fading), P(low), P(bad), P(zero), P(set_t), P(tri), P(nbr), P(own_nbr), P(perm), P(ids), P(other),
    P(far_id), P(low_id), P(triplet_i), P(triplet_j), P(face_ptr), P(nbr_ptr), P(own_ptr), P(bent), P(sources), P(curve), P(zval),
    P(zb), P(set), P(set2), P(both), P(filter), P(filter2), P(u), P(v), P(bound), P(z), P(zd), P(vertex), P(a), P(l), P(b),
    P(whole),
    P(view), P(lap_opts), P(heat_opts), P(spectrum_opts), P(geodesic_opts), P(ldl_opts), P(solve_opts), P(estimate), P(rep),
    P(geodesic_rep), P(err), I(A.n_rows), I(A.n_cols), L(A.nnz), P(A.row_ptr), P(A.col), P(A.val),
    I(L.n_rows), I(L.n_cols), P(L.row_ptr), P(L.val), I(B.n_rows), I(B.n_cols), P(B.row_ptr), P(B.col), P(B.val), L(B.nnz),
    P(full.row_ptr), P(full.col), P(full.val), L(full.nnz), P(solve_rep), P(ldl_rep), I(mesh.begin_zero), I(mesh.end_zero),
    I(from.begin_zero), I(from.end_zero), I(from.count), P(from.first), I(from.corners), I(from.curve), P(from.vertex),
    P(from.bary), P(from.weight), P(from.length), P(back),
    I(mesh.shape), P(mesh.xyz_float), P(mesh.xyz), P(mesh.lengths), P(mesh.corner_u16), P(mesh.corner), P(mesh.face_ptr),
    P(mesh.nbr_ptr), P(mesh.nbr), I(mesh.n), I(mesh.n_faces), S(mesh.stride),
    I(lo.begin_zero), I(lo.end_zero), I(lo.kind), I(lo.triangulation), I(go.updatable), I(go.triangulation), I(lo.border),
    I(lo.n_held), I(lo.updatable), I(lo.neighbours), D(lo.stiffening), D(lo.bandwidth2), D(lo.weight_cut), D(lo.mollify),
    I(ho.begin_zero), I(ho.end_zero), I(ho.method), I(ho.solver), I(ho.precond), I(ho.poles), I(ho.degree), P(ho.rational),
    D(ho.tol), D(ho.cut), I(ho.max_iterations), I(ho.ordering), P(ho.perm), I(so.begin_zero), I(so.end_zero), I(so.count), D(so.below),
    D(so.tol), I(so.ordering), P(so.perm), I(go.begin_zero), I(go.end_zero), D(go.t), D(go.t_in_h2), I(go.mass), I(go.border),
    I(go.ordering), P(go.perm), D(go.stiffening), I(go.neighbours), D(go.mollify), I(fo.begin_zero), I(fo.end_zero), I(fo.ordering),
    P(fo.perm), P(fo.xyz), I(vo.begin_zero), I(vo.end_zero), I(vo.solver), I(vo.precond), D(vo.tol), I(vo.max_iterations),
};
#undef I
#undef L
#undef S
#undef D
#undef P

/* One word may make several. */
static const struct { const char *name; size_t at; int32_t value; } call_choices[] = {
    {"fem", CALL_AT(lo.kind), HD_LAPLACIAN_FEM}, {"voronoi", CALL_AT(lo.kind), HD_LAPLACIAN_VORONOI_COT},
    {"voronoi", CALL_AT(go.mass), HD_GEODESIC_MASS_VORONOI}, {"cot", CALL_AT(lo.kind), HD_LAPLACIAN_COT},
    {"exp", CALL_AT(lo.kind), HD_LAPLACIAN_EXP}, {"polygonal", CALL_AT(lo.kind), HD_LAPLACIAN_POLYGON},
    {"held", CALL_AT(lo.n_held), 2}, {"border", CALL_AT(lo.border), HD_BORDER_DIRICHLET},
    {"mean", CALL_AT(go.border), HD_GEODESIC_BORDER_MEAN}, {"absorbing", CALL_AT(go.border), HD_GEODESIC_BORDER_DIRICHLET},
    {"updatable", CALL_AT(lo.updatable), 1}, {"updatable", CALL_AT(go.updatable), 1},
    {"delaunay", CALL_AT(lo.triangulation), HD_TRIANGULATION_DELAUNAY},
    {"delaunay", CALL_AT(go.triangulation), HD_TRIANGULATION_DELAUNAY},
    {"tufted", CALL_AT(lo.triangulation), HD_TRIANGULATION_TUFTED},
    {"tufted", CALL_AT(go.triangulation), HD_TRIANGULATION_TUFTED}, {"auto", CALL_AT(ho.method), HD_METHOD_AUTO},
    {"iterative", CALL_AT(ho.method), HD_METHOD_ITERATIVE}, {"direct", CALL_AT(ho.method), HD_METHOD_DIRECT},
    {"krylov", CALL_AT(ho.method), HD_METHOD_KRYLOV}, {"local", CALL_AT(ho.method), HD_METHOD_LOCAL},
    {"cocg", CALL_AT(ho.solver), HD_SOLVER_COCG},
    {"cocg", CALL_AT(vo.solver), HD_SOLVER_COCG}, {"minres", CALL_AT(ho.solver), HD_SOLVER_MINRES},
    {"minres", CALL_AT(vo.solver), HD_SOLVER_MINRES}, {"lanczos", CALL_AT(ho.solver), HD_SOLVER_LANCZOS},
    {"ssor", CALL_AT(vo.precond), HD_PRECOND_SSOR}, {"ildl", CALL_AT(vo.precond), HD_PRECOND_ILDL},
    {"mildl", CALL_AT(vo.precond), HD_PRECOND_MILDL}, {"jacobi", CALL_AT(ho.precond), HD_PRECOND_JACOBI},
    {"dissection", CALL_AT(fo.ordering), HD_ORDERING_NESTED_DISSECTION}, {"own", CALL_AT(fo.ordering), HD_ORDERING_OWN},
    {"own", CALL_AT(so.ordering), HD_ORDERING_OWN}, {"own", CALL_AT(go.ordering), HD_ORDERING_OWN},
    {"own", CALL_AT(ho.ordering), HD_ORDERING_OWN}, {"operator", CALL_AT(kernel), HD_KERNEL_OPERATOR},
    {"weighted", CALL_AT(kind), HD_DISTANCE_WEIGHTED}, {"commute", CALL_AT(kind), HD_DISTANCE_COMMUTE},
    {"commute", CALL_AT(n_times), 0}, {"biharmonic", CALL_AT(kind), HD_DISTANCE_BIHARMONIC}, {"biharmonic", CALL_AT(n_times), 0},
    {"wave", CALL_AT(filters[0].kind), HD_FILTER_WAVE},
};

static const call_field *call_field_of(const char *name, size_t length) {
    size_t i;
    for (i = 0; i < sizeof call_fields / sizeof *call_fields; i++)
        if (call_fields[i].name[0] == name[0] && strncmp(call_fields[i].name, name, length) == 0 && !call_fields[i].name[length])
            return call_fields + i;
    return NULL;
}

static const call_row *call_of(const char *name) {
    int i;
    for (i = 0; i < N_CALLS; i++) if (strcmp(call_table[i].name, name) == 0) return call_table + i;
    return NULL;
}

/* x=y. */
static void call_put(call_args *a, const call_field *field, const char *value) {
    static const size_t size[CALL_TYPES] = {sizeof(int32_t), sizeof(int64_t), sizeof(size_t), sizeof(double), sizeof(void *)};
    const call_field *other = call_field_of(value, strlen(value));
    char *const at = (char *)a + field->at;
    char *end = NULL;
    const double d = other || strcmp(value, "NULL") == 0 ? 0 : strtod(value, &end);
    const int64_t whole = field->type == CALL_DOUBLE ? 0 : (int64_t)d;
    const int32_t half = (int32_t)whole;
    const size_t full = whole < 0 ? SIZE_MAX / (size_t)-whole : (size_t)whole;       /* -4: a quarter of all there is */
    const int good = other ? other->type == field->type : field->type == CALL_POINTER ? strcmp(value, "NULL") == 0 : end && !*end;
    if (!good) CHECK_MSG(good, "%s cannot be %s", field->name, value);
    if (other) memcpy(at, (char *)a + other->at, size[field->type]);
    else if (field->type == CALL_POINTER) memset(at, 0, sizeof(void *));
    else memcpy(at, field->type == CALL_INT ? (const void *)&half : field->type == CALL_LONG ? (const void *)&whole :
                    field->type == CALL_SIZE ? (const void *)&full : (const void *)&d, size[field->type]);
}

/* A choice. Is there one of this name? */
static int call_choose(call_args *a, const char *name) {
    size_t i;
    int found = 0;
    for (i = 0; i < sizeof call_choices / sizeof *call_choices; i++) {
        if (strcmp(call_choices[i].name, name) != 0) continue;
        memcpy((char *)a + call_choices[i].at, &call_choices[i].value, sizeof(int32_t));
        found = 1;
    }
    return found;
}

/* The next word of a script into text, NULL at its end. */
static const char *call_next(const char *at, char text[40]) {
    size_t n;
    at += strspn(at, " ");
    n = strcspn(at, " ");
    if (!n || (n >= 40 && !CHECK_MSG(0, "a long word: %s", at))) return NULL;
    memcpy(text, at, n);
    text[n] = 0;
    return at + n;
}

/* Words x=y alone. */
static void call_assign(call_args *a, const char *words) {
    char text[40];
    while ((words = call_next(words, text)) != NULL) {
        const size_t n = strcspn(text, "=");
        call_put(a, call_field_of(text, n), text + n + 1);
    }
}

/* ---- what calls work with: never changed by them ---- */

enum { CALL_SMALL = 9, CALL_BLOCKS = 40 };      /* rows of L and B */

typedef struct call_data {
    shape s;
    call_args good;
    hd_csr A, L, B, full;
    double h;
    int64_t bent[CALL_SMALL + 1];
    double t[3], late[3], endless[3], fading[3], bad[2], minus[2];
    int32_t held[2], far_id[2], point[9], curve[14];
    hd_sources curves;
    hd_rational sets[2], both[2];
    void *block[CALL_BLOCKS];
    int n_blocks;
} call_data;

static void *call_new(call_data *d, int64_t count, size_t size) {
    if (d->n_blocks == CALL_BLOCKS) exit(2);
    return d->block[d->n_blocks++] = dense_alloc(count, size);
}

#define CALL_NEW(d, type, count) ((type *)call_new(d, count, sizeof(type)))

/* A ball and a grid: closed and with a border, two components. */
static shape call_pair_of_shapes(void) {
    const double offset[3] = {3, 0, 0};
    shape a = shape_icosphere(0), b = shape_grid(3, 3, 0.2), s = shape_disjoint(&a, &b, offset);
    shape_free(&a);
    shape_free(&b);
    return s;
}

/* 2 along the diagonal of a face's corners, -1 beside it, and 1 for each vertex. */
static void call_make_triplets(call_data *d) {
    const int64_t count = 12 * (int64_t)d->s.n_tri + d->s.n;
    int32_t *i = CALL_NEW(d, int32_t, count), *j = CALL_NEW(d, int32_t, count), f, q;
    double *v = CALL_NEW(d, double, count);
    int64_t p = 0;
    for (f = 0; f < d->s.n_tri; f++)
        for (q = 0; q < 12; q++, p++) {
            const int32_t from = d->s.tri[3 * f + q % 3], to = d->s.tri[3 * f + (q + 1) % 3];
            i[p] = q < 6 ? from : to;
            j[p] = q / 3 % 2 ? i[p] : from + to - i[p];
            v[p] = q / 3 % 2 ? 1 : -1;
        }
    for (f = 0; f < d->s.n; f++, p++) {
        i[p] = j[p] = f;
        v[p] = 1;
    }
    CHECK(p == count && hd_csr_from_triplets(&d->A, d->s.n, d->s.n, count, i, j, v, NULL, NULL) == HD_OK);
    d->good.rows = d->good.cols = d->s.n;
    d->good.n_triplets = count;
    d->good.triplet_i = i;
    d->good.triplet_j = j;
    d->good.triplet_v = v;
}

/* Positions in other forms; the sides of triangles; neighbours; fields. */
static void call_arrays(call_data *d) {
    const int32_t n = d->s.n, n_tri = d->s.n_tri;
    double *lengths = CALL_NEW(d, double, 3 * n_tri), *moved = CALL_NEW(d, double, 3 * n), *f = CALL_NEW(d, double, 6 * n);
    float *small = CALL_NEW(d, float, 3 * n);
    int64_t *face_ptr = CALL_NEW(d, int64_t, n_tri + 1), *own_ptr = CALL_NEW(d, int64_t, n + 1);
    int32_t *nbr = CALL_NEW(d, int32_t, 12 * n), *perm = CALL_NEW(d, int32_t, n), k, j;
    double *with_nan = CALL_NEW(d, double, d->good.n_triplets), *with_inf = CALL_NEW(d, double, d->good.n_triplets);
    hd_c64 *zb = CALL_NEW(d, hd_c64, 3 * n), *zval = CALL_NEW(d, hd_c64, 3 * d->A.nnz);
    int64_t p;
    call_args *a = &d->good;
    for (k = 0; k < 3 * n_tri; k++) {
        lengths[k] = shape_distance(d->s.xyz + 3 * d->s.tri[k], d->s.xyz + 3 * d->s.tri[k - k % 3 + (k + 1) % 3]);
        d->h += lengths[k] / (3 * n_tri);
    }
    for (k = 0; k <= n_tri; k++) face_ptr[k] = 3 * k;
    for (k = 0; k <= n; k++) own_ptr[k] = 12 * k;
    for (k = 0; k < n; k++) {
        perm[k] = n - 1 - k;
        for (j = 0; j < 12; j++) nbr[12 * k + j] = k < 12 ? j : 12 + j % (n - 12);
    }
    for (k = 0; k < 3 * n; k++) {
        small[k] = (float)d->s.xyz[k];
        moved[k] = d->s.xyz[k] * (1 + 0.01 * (k % 5));
        zb[k] = test_c(k % 5, 1);
    }
    for (k = 0; k < 6 * n; k++) f[k] = k % 7 - k % 3;
    for (p = 0; p < 3 * d->A.nnz; p++) zval[p] = test_c(d->A.val[p % d->A.nnz], 0.25 * (double)(p / d->A.nnz));
    for (p = 0; p < d->good.n_triplets; p++) with_nan[p] = with_inf[p] = 1;
    with_nan[2] = (double)NAN;
    with_inf[2] = (double)INFINITY;
    a->with_nan = with_nan;
    a->with_inf = with_inf;
    a->lengths = lengths;
    a->moved = moved;
    a->f = f;
    a->face_ptr = face_ptr;
    a->own_ptr = own_ptr;
    a->own_nbr = nbr;
    a->perm = perm;
    a->zb = zb;
    a->zval = zval;
    a->mesh.xyz_float = small;
}

/* Two sources: two points in and at a face with weights, and one; two curves: over an edge of it into the face behind, and within it and
 * back. */
static void call_sources(call_data *d) {
    static const double bary[9] = {0.25, 0.5, 0.25, 1, 0, 0, 0.5, 0.125, 0.375}, weight[3] = {2, 0.5, 3};
    static const int64_t first[3] = {0, 2, 3}, curve_first[3] = {0, 3, 7}, back[3] = {0, 2, 2};
    const int32_t *t = d->s.tri, *other = t;
    int32_t f, q, behind = t[0];
    hd_sources *const from = &d->good.from;
    for (f = 1; f < d->s.n_tri; f++) {
        const int32_t *g = t + 3 * f;
        int has = 0, third = 0;
        for (q = 0; q < 3; q++) {
            has += g[q] == t[1] || g[q] == t[2];
            third = g[q] == t[1] || g[q] == t[2] ? third : g[q];
        }
        if (has == 2) {
            other = g;
            behind = third;
        }
    }
    CHECK(other != t);
    for (q = 0; q < 9; q++) d->point[q] = t[q % 3];
    d->curve[0] = t[0];
    d->curve[1] = d->curve[2] = t[1];
    d->curve[3] = d->curve[4] = t[2];
    d->curve[5] = behind;
    for (q = 0; q < 8; q++) d->curve[6 + q] = t[(q + 1) / 2 % 3];
    from->count = 2;
    from->first = first;
    from->corners = 3;
    from->vertex = d->point;
    from->bary = bary;
    from->weight = weight;
    d->curves.count = 2;
    d->curves.first = curve_first;
    d->curves.corners = 2;
    d->curves.vertex = d->curve;
    d->curves.curve = 1;
    d->good.curve = &d->curves;
    d->good.back = back;
}

static void call_times(call_data *d) {
    static const double low[2] = {1, -1}, zero[1] = {0}, t[3] = {1, 7, 40}, fading[3] = {40, 1, 10};
    const double unit = d->h * d->h;
    int k;
    for (k = 0; k < 3; k++) {
        d->t[k] = t[k] * unit;
        d->late[k] = 200 * t[k] * unit;
        d->endless[k] = (1 << k) * 3e7 * unit;   /* a plan asks whether only the means are left */
        d->fading[k] = fading[k] * unit;         /* of held vertices */
    }
    d->bad[0] = 1;
    d->bad[1] = (double)NAN;
    d->good.t = d->t;
    d->good.late = d->late;
    d->good.endless = d->endless;
    d->good.fading = d->fading;
    d->good.low = low;
    d->good.bad = d->bad;
    d->good.zero = zero;
    d->good.time = d->t[0];
}

static void call_small_matrices(call_data *d) {
    double *twice = CALL_NEW(d, double, 3 * CALL_SMALL);
    int64_t p;
    int32_t i;
    d->L = test_path_csr(CALL_SMALL, 0);
    d->B = test_diagonal_csr(CALL_SMALL, NULL);
    d->full = test_path_csr(CALL_SMALL, 1);
    for (i = 0; i < CALL_SMALL; i++)
        for (p = d->full.row_ptr[i]; p < d->full.row_ptr[i + 1]; p++) d->full.val[p] = d->full.col[p] == i ? 2.001 : 1;
    for (p = 0; p < d->L.nnz; p++) twice[p] = 2 * d->L.val[p];
    memcpy(d->bent, d->L.row_ptr, sizeof d->bent);
    d->bent[0] = 1;
    d->good.bent = d->bent;
    d->good.val2 = twice;
}

/* Takes the shape. */
static void call_data_make(call_data *d, shape s) {
    static const int32_t ids[6] = {0, 5, 13, 14, 2, 20}, other[6] = {3, 5, 1, 17, 20, 20}, low[2] = {0, -1};
    call_args *const a = &d->good;
    int k;
    memset(d, 0, sizeof *d);
    d->s = s;
    call_make_triplets(d);
    call_arrays(d);
    call_sources(d);
    call_times(d);
    call_small_matrices(d);
    d->held[0] = 2;
    d->held[1] = 15;
    d->far_id[1] = s.n;
    a->xyz = s.xyz;
    a->n = s.n;
    a->tri = s.tri;
    a->n_tri = s.n_tri;
    a->mesh.corner = s.tri;
    a->mesh.n = s.n;
    a->mesh.n_faces = s.n_tri;
    a->ids = ids;
    a->other = other;
    a->low_id = low;
    a->far_id = d->far_id;
    a->A = d->A;
    a->val = d->A.val;
    a->L = d->L;
    a->B = d->B;
    a->full = d->full;
    a->lo.held = d->held;
    a->filters[0].kind = HD_FILTER_HEAT;
    a->filters[1].kind = HD_FILTER_RESOLVENT;
    a->filters[0].a = a->filters[1].a = a->filters[0].b = 2;
    a->filters[0].tol = a->filters[1].tol = 1e-3;        /* few poles: a fit takes long */
    a->kernel = HD_KERNEL_SYMMETRIC;
    a->poles = HD_POLES_UNIFORM;
    a->query = HD_QUERY_COLUMNS;
    a->so.count = 8;
    for (k = 0; k < 2; k++) CHECK(hd_rational_fit(d->sets + k, 1, a->filters + k, 1000 / (d->h * d->h), NULL, NULL) == HD_OK);
    CHECK(hd_rational_fit(d->both, 2, a->filters, 1000 / (d->h * d->h), NULL, NULL) == HD_OK);
    a->set = d->sets;
    a->both = d->both;
    a->set2 = d->sets + 1;
    a->set_time = d->sets[0].t;
    a->set2_time = d->sets[1].t;
    call_assign(a, "n_times=1 n_sets=1 n_filters=1 k=3 n_matrices=3 source=3 count=5");
    call_assign(a, "n_pairs=6 degree=7 h=0.5 alpha=1 beta=2 tol=1e-6 lambda_max=100 x=-2");
    call_assign(a, "theta.re=-1 theta.im=3");
    call_assign(a, "ho.perm=perm so.perm=perm go.perm=perm fo.perm=perm fo.xyz=xyz");
}

static void call_data_free(call_data *d) {
    while (d->n_blocks > 0) free(d->block[--d->n_blocks]);
    hd_csr_free(&d->A, NULL);
    hd_csr_free(&d->L, NULL);
    hd_csr_free(&d->B, NULL);
    hd_csr_free(&d->full, NULL);
    shape_free(&d->s);
}

/* ---- a world: a context, the objects in it, and the last answer ---- */

enum { CALL_KEPT = 5, CALL_SETS = 5 };

typedef struct call_world {
    const call_data *data;
    hd_context *ctx;
    call_args a;
    double *out;                         /* all answers: doubles, and n ints */
    size_t out_size;
    hd_laplacian *lap, *laps[CALL_KEPT]; /* just made, and kept */
    hd_heat *heat, *heats[CALL_KEPT];
    hd_spectrum *spectrum, *spectra[CALL_KEPT];
    hd_geodesic *geodesic, *geodesics[CALL_KEPT];
    hd_ldl *ldl, *ldls[CALL_KEPT];
    int n_laps, n_heats, n_spectra, n_geodesics, n_ldls;
    hd_csr csr;
    hd_rational sets[CALL_SETS], kept_sets[CALL_SETS];
    hd_estimate estimate;
    hd_report rep;
    hd_geodesic_report geodesic_rep;
    hd_solve_report solve_rep;
    hd_error e;
    int has_report;
    const char *what;                    /* for messages */
} call_world;

static char call_mark;                   /* no object is here */

static void call_open(call_world *w, const call_data *d, hd_context *ctx) {
    const size_t n = (size_t)d->s.n, doubles = 64 * n + 700;
    double *out = w->out;
    call_args *const a = &w->a;
    if (w->data != d) {
        free(out);
        out = DENSE_NEW(double, doubles + 2 * n);
    }
    memset(w, 0, sizeof *w);
    w->data = d;
    w->ctx = ctx;
    w->out = out;
    w->out_size = (doubles + 2 * n) * sizeof *out;
    *a = d->good;
    a->u = out;
    a->v = out + 44 * n + 700;
    a->bound = out + 60 * n + 700;
    a->z = (hd_c64 *)(void *)a->u;
    a->zd = (hd_c64 *)(void *)a->v;
    a->vertex = (int32_t *)(void *)(out + doubles);
    a->out_lap = &w->lap;
    a->out_heat = &w->heat;
    a->out_spectrum = &w->spectrum;
    a->out_geodesic = &w->geodesic;
    a->out_ldl = &w->ldl;
    a->out_csr = &w->csr;
    a->out_set = w->sets;
    a->set_t = &a->set_time;
    a->a = &a->A;
    a->l = &a->L;
    a->b = &a->B;
    a->whole = &a->full;
    a->view = &a->mesh;
    a->sources = &a->from;
    a->filter = a->filters;
    a->filter2 = a->filters + 1;
    a->lap_opts = &a->lo;
    a->heat_opts = &a->ho;
    a->spectrum_opts = &a->so;
    a->geodesic_opts = &a->go;
    a->ldl_opts = &a->fo;
    a->solve_opts = &a->vo;
    a->estimate = &w->estimate;
    a->rep = &w->rep;
    a->geodesic_rep = &w->geodesic_rep;
    a->solve_rep = &w->solve_rep;
    a->err = &w->e;
    a->ctx = a->lo.context = a->ho.context = a->so.context = a->go.context = a->fo.context = ctx;
}

static void call_close(call_world *w) {
    while (w->n_heats > 0) hd_heat_free(w->heats[--w->n_heats]);
    while (w->n_spectra > 0) hd_spectrum_free(w->spectra[--w->n_spectra]);
    while (w->n_geodesics > 0) hd_geodesic_free(w->geodesics[--w->n_geodesics]);
    while (w->n_ldls > 0) hd_ldl_free(w->ldls[--w->n_ldls]);
    while (w->n_laps > 0) hd_laplacian_free(w->laps[--w->n_laps]);
}

/* The room of its answers, too, which call_open uses again. */
static void call_world_free(call_world *w) {
    free(w->out);
    memset(w, 0, sizeof *w);
}

/* Appends numbers to what out has, as far as there is room for. Returns what it has then. */
static size_t call_show(call_world *w, size_t has, const void *numbers, size_t count) {
    const size_t room = 44 * (size_t)w->data->s.n + 700 - has;
    if (count > room) count = room;
    if (count) memcpy(w->out + has, numbers, count * sizeof *w->out);
    return has + count;
}

/* What was made is an answer. It is freed then, or kept as an argument of what follows. */
#define CALL_MADE(object, list, count, free_it) \
    if (w->object == (void *)&call_mark) w->object = NULL; \
    else if (w->object && keep && w->count < CALL_KEPT) w->a.object = w->list[w->count++] = w->object; \
    else free_it(w->object)

/* A Laplacian? */
static int call_updates(const call_row *c) { return strncmp(c->name, "update", 6) == 0; }

static void call_take(call_world *w, const call_row *c, int keep) {
    size_t has = 0;
    if (w->lap && (char *)w->lap != &call_mark) {
        has = call_show(w, has, w->lap->L.val, (size_t)w->lap->L.nnz);
        (void)call_show(w, has, w->lap->mass, (size_t)w->lap->n_active);
    }
    if (w->spectrum && (char *)w->spectrum != &call_mark) {
        has = call_show(w, has, w->spectrum->value, (size_t)w->spectrum->count);
        (void)call_show(w, has, w->spectrum->vector, (size_t)w->spectrum->count * (size_t)w->spectrum->n);
    }
    if (CALL_TAKES(c, "out_csr")) {
        (void)call_show(w, has, w->csr.val, w->csr.val ? (size_t)w->csr.nnz : 0);
        hd_csr_free(&w->csr, w->a.ctx);
    }
    if (CALL_TAKES(c, "out_set")) (void)call_show(w, has, w->sets, sizeof w->sets / (sizeof *w->out));
    if (CALL_TAKES(c, "out_set") && keep) {
        memcpy(w->kept_sets, w->sets, sizeof w->sets);
        w->a.set = w->kept_sets;
        w->a.set_time = w->sets[0].t;
    }
    if (w->a.lap && call_updates(c)) (void)call_show(w, 0, w->a.lap->L.val, (size_t)w->a.lap->L.nnz);
    if (CALL_TAKES(c, "estimate")) w->out[0] = w->estimate.cost[HD_METHOD_DIRECT].flops;
    if (CALL_TAKES(c, "estimate")) w->out[1] = w->estimate.cost[HD_METHOD_ITERATIVE].flops;
    if (keep && strcmp(c->name, "lambda_max") == 0) w->a.lambda_max = w->out[0];
}

static void call_keep(call_world *w, int keep) {
    CALL_MADE(lap, laps, n_laps, hd_laplacian_free);
    CALL_MADE(heat, heats, n_heats, hd_heat_free);
    CALL_MADE(spectrum, spectra, n_spectra, hd_spectrum_free);
    CALL_MADE(geodesic, geodesics, n_geodesics, hd_geodesic_free);
    CALL_MADE(ldl, ldls, n_ldls, hd_ldl_free);
}

/* Nothing is in the answers, and no object is made. */
static void call_clear(call_world *w, const call_row *c, int keep) {
    const call_args *const a = &w->a;
    const size_t n = (size_t)w->data->s.n;
    if (!keep) memset(w->out, 0, w->out_size);
    if (CALL_TAKES(c, "f") && a->f == a->u) memcpy(a->u, w->data->good.f, 3 * n * sizeof *a->u);      /* in place */
    if (CALL_TAKES(c, "zb") && a->zb == a->z) memcpy(a->z, w->data->good.zb, 3 * n * sizeof *a->z);
    w->lap = (hd_laplacian *)(void *)&call_mark;
    w->heat = (hd_heat *)(void *)&call_mark;
    w->spectrum = (hd_spectrum *)(void *)&call_mark;
    w->geodesic = (hd_geodesic *)(void *)&call_mark;
    w->ldl = (hd_ldl *)(void *)&call_mark;
    memset(&w->csr, 0x6b, sizeof w->csr);
    memset(w->sets, 0, CALL_TAKES(c, "out_set") ? sizeof w->sets : 0);
    memset(&w->rep, 0, sizeof w->rep);
    memset(&w->geodesic_rep, 0, sizeof w->geodesic_rep);
    memset(&w->e, 0, sizeof w->e);
}

/* After an error no object is made, and no matrix. */
static int call_made(const call_world *w) {
    hd_csr mark;
    memset(&mark, 0x6b, sizeof mark);
    return (char *)w->lap != &call_mark || (char *)w->heat != &call_mark || (char *)w->spectrum != &call_mark ||
           (char *)w->geodesic != &call_mark || (char *)w->ldl != &call_mark || memcmp(&w->csr, &mark, sizeof mark) != 0;
}

/* What is wrong with the error, the reports, what is made and what is updated, of a call with this status? NULL: nothing. */
static const char *call_wrong(const call_world *w, const call_row *c, hd_status st, int64_t version) {
    const call_args *const a = &w->a;
    const hd_status bad = st < 0 ? st : HD_OK;
    const int makes = strstr(c->args, "a->out_") && !CALL_TAKES(c, "out_set");
    if (a->err && (w->e.status != bad || (st < 0 && !w->e.text[0]))) return "the error says something else";
    if (a->err && st >= 0 && makes && (w->e.face & w->e.vertex & w->e.row & w->e.column & w->e.pole) != -1)
        return "the error names a place";
    if (w->has_report && (w->rep.status != st || (st < 0 && w->rep.error.status != st))) return "the report says something else";
    if (CALL_TAKES(c, "geodesic_rep") && a->geodesic_rep &&
        (w->geodesic_rep.status != st || (st < 0 && w->geodesic_rep.error.status != st))) return "the report says something else";
    if (makes && (st >= 0) != call_made(w)) return st < 0 ? "out is changed" : "nothing is made";
    if (a->lap && call_updates(c) && a->lap->version != version + (st >= 0)) return "the Laplacian has another version";
    return NULL;
}

static hd_status call_one(call_world *w, const call_row *c, int keep) {
    const int64_t version = w->a.lap ? w->a.lap->version : 0;
    const char *wrong;
    hd_status st;
    call_clear(w, c, keep);
    st = c->run(&w->a);
    w->has_report = CALL_TAKES(c, "rep") && w->a.rep;
    wrong = call_wrong(w, c, st, version);
    CHECK_MSG(!wrong, "%s: %s: %s, but %s", w->what, c->name, hd_status_name(st), wrong);
    if (st >= 0) call_take(w, c, keep);
    call_keep(w, keep && st >= 0);
    return st;
}

/* ---- progress ---- */

typedef struct rob_progress { int64_t calls, stop_at, solving; hd_progress answer; } rob_progress;

static hd_progress rob_on_progress(void *user, const char *stage, double done) {
    rob_progress *p = (rob_progress *)user;
    CHECK(stage && stage[0] && done >= 0 && done <= 1);
    p->solving += strcmp(stage, "solve") == 0;
    return ++p->calls == p->stop_at ? p->answer : HD_PROGRESS_CONTINUE;
}

/* From now on the context's progress is counted, and cancelled at this call; 0: at none. */
static void rob_watch(rob_progress *p, hd_context *ctx, int64_t stop_at) {
    memset(p, 0, sizeof *p);
    p->stop_at = stop_at;
    p->answer = HD_PROGRESS_CANCEL;
    ctx->progress = rob_on_progress;
    ctx->progress_user = p;
}

/* ---- scripts ---- */

static hd_status call_words(call_world *w, const char *words, int keep);

/* Makes what the call works on. */
static hd_status call_need(call_world *w, const call_row *c) {
    const int lap = CALL_TAKES(c, "lap") || CALL_TAKES(c, "heat") || CALL_TAKES(c, "spectrum");
    hd_status st = HD_OK;
    if (lap && !w->a.lap) st = call_words(w, "triangles", 1);
    if (st >= 0 && CALL_TAKES(c, "heat") && !w->a.heat) st = call_words(w, "plan", 1);
    if (st >= 0 && CALL_TAKES(c, "spectrum") && !w->a.spectrum) st = call_words(w, "eigenpairs", 1);
    if (st >= 0 && CALL_TAKES(c, "geodesic") && !w->a.geodesic) st = call_words(w, "geodesic", 1);
    if (st >= 0 && CALL_TAKES(c, "ldl") && !w->a.ldl) st = call_words(w, "analyse", 1);
    return st;
}

/* Runs words up to a bar or the end, or until a call fails. keep: they prepare. */
static hd_status call_words(call_world *w, const char *words, int keep) {
    char text[40];
    hd_status st = HD_OK;
    while (st >= 0 && (words = call_next(words, text)) != NULL && text[0] != '|') {
        const char *is = strchr(text, '=');
        const call_row *c = is ? NULL : call_of(text);
        const call_field *field = is ? call_field_of(text, (size_t)(is - text)) : NULL;
        if (c) {
            if (keep) st = call_need(w, c);
            if (st >= 0) st = call_one(w, c, keep);
        } else if (field) call_put(&w->a, field, is + 1);
        else if (is || !call_choose(&w->a, text)) CHECK_MSG(0, "what is %s?", text);
    }
    return st;
}

/* The words before the bar, or all but the last one and what comes before it; then what the tested calls need. */
static hd_status call_prepare(call_world *w, const char *script) {
    const char *bar = strchr(script, '|'), *last = strrchr(script, ' ');
    char text[200];
    const call_row *c;
    hd_status st;
    if (!bar) {
        c = call_of(last ? last + 1 : script);
        if (!c && !CHECK_MSG(c, "no call at the end of: %s", script)) return HD_ERR_ARGUMENT;
        snprintf(text, sizeof text, "%.*s %s", last ? (int)(last - script) : 0, script, c->before);
        st = call_words(w, text, 1);
        return st < 0 ? st : call_need(w, c);
    }
    w->what = script;
    st = call_words(w, script, 1);
    for (bar++; st >= 0 && (bar = call_next(bar, text)) != NULL;)
        if ((c = call_of(text)) != NULL) st = call_need(w, c);
    return st;
}

/* The words after the bar, or the last one. */
static hd_status call_test(call_world *w, const char *script) {
    const char *bar = strchr(script, '|'), *last = strrchr(script, ' ');
    return call_words(w, bar ? bar + 1 : last ? last + 1 : script, 0);
}

#endif
