/* test_doors.h - what every public function says of arguments that it cannot take: the status, the reason, and where.
 * Contexts that have become bad, arrays that are missing, sizes and options beyond their ranges. Nothing may be changed. */

#ifndef TEST_DOORS_H
#define TEST_DOORS_H

/* What calls say of bad arguments: a list of words, one after the other. which: the calls, NULL for all that take the last
 * argument of the words, but for those that other rows name with the same words. place: a field of hd_error and its value,
 * or NULL. */
typedef struct door_row { const char *which; hd_status want; const char *say, *place, *words; } door_row;

#define BAD HD_ERR_ARGUMENT,
static const door_row door_rows[] = {
    /* what need not be there, and no question at all */
    {NULL, HD_OK, "", NULL,
     "queries=NULL; triplet_v=NULL; v=NULL; bound=NULL; zd=NULL; rep=NULL; geodesic_rep=NULL; solve_rep=NULL; err=NULL; "
     "lap_opts=NULL; heat_opts=NULL; ldl_opts=NULL; geodesic_opts=NULL; solve_opts=NULL; ctx=NULL; t=zero"},
    {"inverse_c", HD_OK, "", NULL, "z=NULL"}, {"nearest inverse diagonal sample sample_from", HD_OK, "", NULL, "u=NULL"},
    {"inverse", HD_OK, "", NULL, "v=NULL u=NULL"}, {"diagonal", BAD "must not be NULL", NULL, "v=NULL u=NULL"},
    {"entries pairs", HD_OK, "", NULL, "ids=NULL other=NULL u=NULL n_pairs=0"},
    {"nearest", HD_OK, "", NULL, "queries=xyz n_queries=0 vertex=NULL"}, {"distance geodesic_each", HD_OK, "", NULL, "k=0 ids=NULL u=NULL"},
    {"eigen_columns eigen_distance columns columns_sparse sample", HD_OK, "", NULL, "k=0 ids=NULL"}, {"sample_from", HD_OK, "", NULL, "sources=NULL"},
    {NULL, HD_OK, "", NULL, "from.count=0 from.vertex=NULL sources=sources; from.begin_zero=0 sources=curve"},
    {"diagonal distance distance_from", BAD "t is not positive and finite", "column=0", "t=zero"},
    {"shared_poles", BAD "a time is not positive", "row=0", "t=zero"},

    /* sizes */
    {NULL, BAD "size is negative", NULL, "n=-1; n_tri=-1; rows=-1; cols=-1; n_triplets=-1; queries=xyz n_queries=-1"},
    {"nearest", BAD "k is not positive", NULL, "k=0; k=-1"}, {"geodesic_set", BAD "it has no point", "column=0", "k=0; k=-1"},
    {NULL, BAD "is negative", NULL, "k=-1; n_pairs=-1; n_sets=-1"}, {NULL, BAD "is not positive", NULL, "n_matrices=0"},
    {NULL, BAD "there is none", NULL, "n_filters=0; n_filters=-1"},
    {NULL, BAD "more points than vertices, or none", NULL, "count=0; count=-1"},
    {"sample sample_from", BAD "more points", "value=22", "count=22"},
    {"eigen_columns eigen_diagonal eigen_distance eigen_columns_from eigen_distance_from", BAD "would overlap", NULL, "ld=20"},
    {NULL, BAD "leading dimension", NULL, "ld=20; ldf=20"}, {"solve_c", BAD "same leading dimension", NULL, "zb=z ldf=22 ld=23"},
    {"distance pairs distance_from", BAD "n_times is 0 or 1", "value=2", "commute n_times=2"},
    {"distance pairs distance_from", BAD "n_times is 0 or 1", "value=-1", "biharmonic n_times=-1"},
    {"eigen_distance eigen_distance_from", BAD "has no time", NULL, "commute n_times=2; biharmonic n_times=2"},
    {"apply", BAD "one time only", NULL, "n_times=2 f=u"},

    /* times, and other numbers */
    {"shared_poles", BAD "no times", NULL, "n_times=0; n_times=-1"},
    {NULL, BAD "there is no time", NULL, "n_times=0; n_times=-1"},
    {"shared_poles", BAD "a time is not positive", "row=1", "n_times=2 t=low"},
    {"shared_poles", BAD "a time is not positive or not finite", "row=1", "n_times=2 t=bad"},
    {"diagonal distance distance_from", BAD "t is not positive and finite", "column=1", "n_times=2 t=low; n_times=2 t=bad"},
    {"apply derivative adjoint columns columns_sparse columns_from pairs entries estimate", BAD "t is negative or not finite", "column=1",
     "n_times=2 t=low; n_times=2 t=bad"},
    {NULL, BAD "t is negative or not finite", "value=-1", "n_times=2 t=low"},
    {NULL, BAD "t is negative or not finite", NULL, "n_times=2 t=bad"},
    {"shifted column", BAD "t is negative", "value=-1", "time=-1"},
    {"shifted column", BAD "t is negative or not finite", NULL, "time=nan; time=inf"},
    {"sample sample_from", BAD "t is not positive", NULL, "time=0"}, {NULL, BAD "", "value=-1", "time=-1"},
    {NULL, BAD "", NULL, "time=nan; time=inf"},
    {NULL, BAD "tol is not positive", NULL, "tol=-1; tol=nan"}, {NULL, BAD "h is negative", NULL, "h=-1"},
    {NULL, BAD "h is negative or not finite", NULL, "h=nan"}, {NULL, BAD "lambda_max is unknown", NULL, "lambda_max=-1; lambda_max=nan"},
    {"shifted", BAD "not finite", NULL, "theta.re=nan"}, {"shifted", BAD "theta lies on", NULL, "theta.re=0 theta.im=0"},

    /* data that are not finite */
    {NULL, HD_ERR_NOT_FINITE, "", NULL, "xyz=with_nan; xyz=with_inf"},
    {NULL, HD_ERR_NOT_FINITE, "", "vertex=0", "moved=with_nan; moved=with_inf"},
    {NULL, HD_ERR_NOT_FINITE, "", "face=0", "lengths=with_nan; lengths=with_inf"},
    {NULL, HD_ERR_NOT_FINITE, "", "row=2", "triplet_v=with_nan; triplet_v=with_inf"},
    {"apply derivative adjoint", HD_ERR_NOT_FINITE, "", NULL, "f=with_nan; f=with_inf"},

    /* kinds, and objects of the wrong kind */
    {"eigen_columns eigen_diagonal eigen_columns_from", BAD "unknown kernel", NULL, "kernel=9; kernel=-1"},
    {NULL, BAD "operator or symmetric", NULL, "kernel=9; kernel=-1"},
    {NULL, BAD "unknown", NULL, "kind=-1; kind=99"},
    {NULL, BAD "unknown query", NULL, "query=99; query=-1"}, {NULL, BAD "uniform or kernel", NULL, "poles=99"},
    {NULL, BAD "degrees 1 to 14", "value=99", "degree=99"},
    {"diagonal distance sample sample_from distance_from", BAD "need the direct method", NULL, "heat=heat2"},
    {"distance", BAD "need the direct method", NULL, "heat=heat2 commute"},
    {"distance sample", BAD "need the direct method", NULL, "heat=heat4 kind=2; heat=heat4 kind=3"},
    {"apply derivative columns columns_sparse columns_from entries pairs diagonal distance distance_from sample sample_from", HD_OK, "", NULL, "heat=heat4; heat=heat4 f=u"},
    {"solve inverse", BAD "not a real one", NULL, "ldl=ldl2"},
    {"solve_c inverse_c", BAD "not a complex one", NULL, "ldl=ldl3"},
    {"update", BAD "matrices of your own", NULL, "lap=lap2"}, {"update_matrices", BAD "not made of matrices", NULL, "lap=lap3"},

    /* indices */
    {NULL, HD_ERR_INDEX, "", "value=-1", "source=-1"}, {NULL, HD_ERR_INDEX, "", "vertex=21", "source=21"},
    {"pairs entries", HD_ERR_INDEX, "", "row=1", "n_pairs=2 ids=far_id"},
    {"pairs entries", HD_ERR_INDEX, "", "value=-1", "n_pairs=2 ids=low_id"},
    {NULL, HD_ERR_INDEX, "", "value=21", "n_pairs=2 other=far_id"}, {NULL, HD_ERR_INDEX, "", "row=1", "n_pairs=2 other=low_id"},
    {"columns columns_sparse distance sample eigen_columns eigen_distance geodesic_each", HD_ERR_INDEX, "", "column=1", "k=2 ids=far_id; k=2 ids=low_id"},
    {"columns columns_sparse distance sample eigen_columns eigen_distance geodesic_each", HD_ERR_INDEX, "", "row=0", "k=2 ids=far_id; k=2 ids=low_id"},
    {"geodesic_set", HD_ERR_INDEX, "", "column=0", "k=2 ids=far_id"}, {"geodesic_set", HD_ERR_INDEX, "", "row=1", "k=2 ids=far_id"},
    {"columns columns_sparse distance sample eigen_columns eigen_distance geodesic_set geodesic_each", HD_ERR_INDEX, "", "vertex=21", "k=2 ids=far_id"},
    {"columns columns_sparse distance sample eigen_columns eigen_distance geodesic_set geodesic_each", HD_ERR_INDEX, "", "value=-1", "k=2 ids=low_id"},
    {"triplets", HD_ERR_INDEX, "", "value=-1", "n_triplets=2 triplet_i=low_id"},
    {"triplets", HD_ERR_INDEX, "", "value=21", "n_triplets=2 triplet_i=far_id"},
    {"triplets", HD_ERR_INDEX, "", "row=1", "n_triplets=2 triplet_j=low_id; n_triplets=2 triplet_j=far_id"},

    /* sources: two points, and one */
    {NULL, BAD "not cleared", NULL, "from.begin_zero=1 sources=sources; from.end_zero=1 sources=sources"},
    {NULL, BAD "is negative", NULL, "from.count=-1 sources=sources; from.corners=-1 sources=sources"},
    {NULL, BAD "must not be NULL", NULL, "from.vertex=NULL sources=sources"},
    {NULL, BAD "it has no point", "column=1", "from.first=back sources=sources"},
    {NULL, BAD "no weights", NULL, "from.curve=1 sources=sources"},
    {NULL, BAD "at least two points", "column=1", "from.curve=1 from.weight=NULL sources=sources"},
    {NULL, HD_ERR_INDEX, "", "row=0", "from.vertex=low_id sources=sources; from.vertex=far_id sources=sources"},
    {NULL, HD_ERR_INDEX, "", "column=0", "from.vertex=low_id sources=sources; from.vertex=far_id sources=sources"},
    {NULL, BAD "is negative", "value=-1", "from.bary=low sources=sources"},
    {NULL, HD_ERR_NOT_FINITE, "", "column=1", "from.weight=with_nan sources=sources; from.weight=with_inf sources=sources"},
    {NULL, HD_ERR_NOT_FINITE, "", "row=0", "from.weight=with_nan sources=sources; from.weight=with_inf sources=sources"},

    /* matrices */
    {NULL, HD_ERR_STRUCTURE, "negative size", NULL, "A.nnz=-1 a=a; A.n_rows=-1 a=a; A.n_cols=-1 a=a"},
    {NULL, HD_ERR_STRUCTURE, "missing array", NULL, "A.row_ptr=NULL a=a; A.col=NULL a=a"},
    {NULL, BAD "must not be NULL", NULL, "L.val=NULL l=l; B.val=NULL b=b"},
    {NULL, HD_ERR_STRUCTURE, "does not begin with 0", NULL, "L.row_ptr=bent l=l; B.row_ptr=bent b=b"},
    {"update_matrices", BAD "another size", NULL, "L.n_rows=8; B.n_rows=8; L.n_cols=10; B.n_cols=10"},

    /* options of Laplacians */
    {"triangles", BAD "", NULL, "lo.kind=99; lo.kind=8"},
    {"triangles", BAD "border is natural", NULL, "lo.border=7; lo.border=-1"},
    {"triangles", BAD "n_held is negative", NULL, "lo.n_held=-1"},
    {"lengths", BAD "of lengths: it is not updatable", NULL, "updatable"},
    {"points tufted_points", BAD "not updatable", NULL, "updatable"},
    {"triangles polygons", BAD "intrinsic triangulation is not updatable", NULL, "updatable tufted"},
    {"points", BAD "the kind is voronoi-exp or exp", NULL, "fem; polygonal"}, {"tufted_points", BAD "the kind is fem", NULL, "exp"},
    {"points", BAD "the triangulation is tufted", NULL, "delaunay"},
    {"triangles", BAD "unknown triangulation", NULL, "lo.triangulation=3; lo.triangulation=-1"},
    {"triangles tufted_points points", BAD "stiffening is for", NULL, "lo.stiffening=2"},
    {"polygons", BAD "stiffening is for", NULL, "fem lo.stiffening=2"},
    {"polygons", BAD "stiffening is not between", NULL, "lo.stiffening=-1; lo.stiffening=1e101; lo.stiffening=nan"},
    {"triangles tufted_points", BAD "for exponential weights", NULL, "lo.bandwidth2=1; lo.weight_cut=0.1"},
    {"triangles", BAD "neighbours is for points", NULL, "lo.neighbours=20"},
    {"tufted_points", BAD "neighbours is for points", NULL, "nbr_ptr=own_ptr nbr=own_nbr lo.neighbours=20"},
    {"triangles points polygons", BAD "mollify is for", NULL, "lo.mollify=1e-4"},
    {"geodesic", BAD "mollify is for", NULL, "go.mollify=1e-4"},
    {"matrices", BAD "of the options only", NULL, "tufted; lo.mollify=1; lo.neighbours=9; lo.stiffening=1; lo.weight_cut=0.5"},
    {"matrices", BAD "the kind is matrices", NULL, "fem"}, {"triangles", BAD "the kind is fem", NULL, "polygonal; lo.kind=7"},
    {"polygons", BAD "intrinsic triangulations are for", NULL, "delaunay polygonal"},
    {"points", BAD "weight_cut", NULL, "lo.weight_cut=nan; lo.weight_cut=-1; lo.weight_cut=1"},
    {NULL, BAD "must not be NULL", NULL, "nbr_ptr=own_ptr; nbr=own_nbr"},

    /* views */
    {NULL, BAD "not cleared", NULL, "mesh.begin_zero=1 view=view; mesh.end_zero=1 view=view"},
    {NULL, BAD "set one of xyz, xyz_float", NULL, "mesh.xyz=xyz view=view; mesh.lengths=lengths view=view"},
    {NULL, BAD "must not be NULL", NULL, "mesh.xyz_float=NULL view=view"},
    {"view geodesic_view", BAD "set one of corner", NULL, "mesh.corner_u16=tri"},
    {"view geodesic_view", BAD "must not be NULL", NULL, "mesh.corner=NULL; mesh.shape=1"},
    {NULL, BAD "size is negative", NULL, "mesh.n=-1 view=view"},
    {"view geodesic_view", BAD "size is negative", NULL, "mesh.n_faces=-1"},
    {"view geodesic_view", BAD "unknown shape", NULL, "mesh.shape=3; mesh.shape=-1"},
    {"view geodesic_view", BAD "points have no faces", NULL, "mesh.shape=2"},
    {"view geodesic_view", BAD "face_ptr is for polygons", NULL, "mesh.face_ptr=face_ptr"},
    {"view geodesic_view", BAD "neighbours are those of points", NULL, "mesh.nbr_ptr=own_ptr; mesh.nbr=own_nbr"},
    {"view geodesic_view", BAD "lengths are those of triangles", NULL,
     "mesh.shape=1 mesh.xyz_float=NULL mesh.lengths=lengths mesh.face_ptr=face_ptr"},
    {NULL, BAD "lengths have no stride", NULL, "mesh.xyz_float=NULL mesh.lengths=lengths mesh.stride=24 view=view"},
    {NULL, BAD "stride is shorter", NULL, "mesh.stride=11 view=view"},
    {"view geodesic_view", HD_ERR_TOO_LARGE, "beyond the address space", NULL, "mesh.stride=-1; mesh.stride=-4; mesh.stride=-40"},
    {"view geodesic_view", HD_ERR_EMPTY, "", NULL,
     "mesh.n_faces=0; mesh.n=0 mesh.n_faces=0 mesh.xyz_float=NULL mesh.corner=NULL; "
     "mesh.n=1 mesh.n_faces=0 mesh.stride=-1"},
    {"view geodesic_view", HD_ERR_INDEX, "does not exist", NULL, "mesh.n=0"},
    {"update_view geodesic_update_view", BAD "another number of vertices", "value=20", "mesh.n=20"},
    {"update_view geodesic_update_view", HD_OK, "", NULL, "mesh.corner=NULL mesh.n_faces=1"},

    /* options of eigenpairs, shifted systems, plans */
    {NULL, BAD "unknown ordering", NULL,
     "so.ordering=99; so.ordering=-1; ho.ordering=-1; ho.ordering=99; go.ordering=99; go.ordering=-1"},
    {NULL, BAD "no permutation", NULL, "own so.perm=NULL; own ho.perm=NULL; own go.perm=NULL; own fo.perm=NULL"},
    {NULL, HD_ERR_INDEX, "", NULL, "own so.perm=tri; own go.perm=tri; own fo.perm=tri"},
    {NULL, BAD "unknown preconditioner", NULL, "vo.precond=99; vo.precond=-1; ho.precond=-1; ho.precond=9"},
    {NULL, BAD "max_iterations", NULL, "vo.max_iterations=-1; ho.max_iterations=-1"},
    {NULL, BAD "tol is not in", NULL, "so.tol=-1; so.tol=1; so.tol=nan; vo.tol=nan; vo.tol=-1; vo.tol=1; ho.tol=-1e-3; ho.tol=1; ho.tol=nan"},
    {"eigenpairs", BAD "neither a count nor a bound", NULL, "so.count=-1"},
    {"eigenpairs", BAD "neither a count nor", NULL, "so.count=0"},
    {"eigenpairs", BAD "more pairs than rows", NULL, "so.count=22"}, {"eigenpairs", BAD "below is negative", NULL, "so.below=-1"},
    {"eigenpairs", BAD "below is negative or not finite", NULL, "so.below=nan"},
    {"shifted", BAD "cocg or minres", NULL, "vo.solver=2; vo.solver=4; vo.solver=-1"},
    {"plan", BAD "unknown method", NULL, "ho.method=-1; ho.method=9"},
    {"plan", BAD "unknown solver", NULL, "ho.solver=-1; ho.solver=2; ho.solver=9"},
    {"plan", BAD "poles are uniform", NULL, "ho.poles=-1; ho.poles=3"},
    {"plan", BAD "", "value=1", "ho.poles=2 ho.degree=1"},
    {"plan", BAD "", NULL, "ho.degree=-1; ho.degree=15; lanczos ho.rational=set"},
    {"plan", BAD "no use for poles", NULL, "krylov ho.rational=set; krylov ho.poles=1; krylov ho.degree=7; local ho.poles=1; local ho.degree=9"},
    {"plan", BAD "belong to the iterative", NULL, "krylov cocg; local cocg; local jacobi; direct cocg; direct jacobi"},
    {"plan", BAD "cut is not in", NULL, "ho.cut=-1e-3; ho.cut=1; ho.cut=nan"},

    /* options of geodesic plans */
    {"geodesic", BAD "t is negative", NULL, "go.t=-1"}, {"geodesic", BAD "t is negative or not finite", NULL, "go.t=nan"},
    {"geodesic", BAD "t_in_h2 is negative", NULL, "go.t_in_h2=-1"},
    {"geodesic", BAD "t_in_h2 is negative or not", NULL, "go.t_in_h2=inf"},
    {"geodesic", BAD "outside 1e-100 .. 1e100", NULL, "go.t=1e-101; go.t_in_h2=1e101"},
    {"geodesic", BAD "unknown mass", NULL, "go.mass=-1; go.mass=99"},
    {"geodesic", BAD "unknown border", NULL, "go.border=-1; go.border=99"},
    {"geodesic", BAD "stiffening is for", NULL, "go.stiffening=1"},
    {"geodesic_polygons", BAD "stiffening is not between", NULL, "go.stiffening=-1; go.stiffening=1e101; go.stiffening=nan"},
    {"geodesic_points", BAD "6..128", NULL, "go.neighbours=5; go.neighbours=129"},
    {"geodesic", BAD "mollify", NULL, "go.mollify=nan; go.mollify=2"},
    {"geodesic_lengths", BAD "of lengths is not updatable", NULL, "updatable"},
    {"geodesic_polygons", BAD "triangles in space are updatable", NULL, "updatable"},
    {"geodesic", BAD "triangles in space are updatable", NULL, "updatable tufted"},
    {"geodesic_polygons", BAD "of triangles, not of polygons", NULL, "voronoi"},
    {"geodesic_points", BAD "cannot tell their border", NULL, "absorbing"},

    /* after these an object has changed */
    {NULL, HD_ERR_NOT_FINITE, "", NULL, "val=with_nan; val=with_inf"}, {"set_rational", HD_OK, "", NULL, "n_sets=2 set=both; n_sets=0 set=NULL; n_sets=0"},
};
#undef BAD

enum { DOOR_ROWS = sizeof door_rows / sizeof *door_rows };

/* Arguments that must not be NULL. */
static const char *const door_pointers =
    "lap heat spectrum geodesic ldl out_lap out_heat out_spectrum out_geodesic out_ldl out_csr out_set xyz moved lengths tri "
    "face_ptr view triplet_i triplet_j a l b val zval f zb t ids other sources set filter u z vertex estimate "
    "spectrum_opts";

typedef struct doors {
    call_data data;
    call_world w;
    call_args good;
    hd_context ctx;
} doors;

/* 2 and 3: a pair of matrices, triangles that move; an iterative plan, one of a filter; complex factors, real ones. 4: a plan of parts. */
static void doors_open(doors *d) {
    memset(d, 0, sizeof *d);
    call_data_make(&d->data, call_pair_of_shapes());
    call_open(&d->w, &d->data, &d->ctx);
    d->w.what = "doors";
    CHECK(call_words(&d->w, "updatable matrices lap2=lap triangles lap3=lap geodesic", 1) == HD_OK);
    CHECK(call_words(&d->w, "lo.updatable=0 go.updatable=0 triangles iterative plan heat2=heat local plan heat4=heat auto", 1) == HD_OK);
    CHECK(call_words(&d->w, "plan set_rational heat3=heat plan eigenpairs", 1) == HD_OK);
    CHECK(call_words(&d->w, "analyse factor_c ldl2=ldl analyse factor ldl3=ldl", 1) == HD_OK);
    d->good = d->w.a;
}

static void doors_close(doors *d) {
    call_close(&d->w);
    CHECK(d->ctx.bytes_in_use == 0);
    call_world_free(&d->w);
    call_data_free(&d->data);
}

/* Good arguments for this call. */
static void doors_ready(doors *d, const call_row *c) {
    d->w.a = d->good;
    if (strcmp(c->name, "update_matrices") == 0) d->w.a.lap = d->good.lap2;
    else if (strncmp(c->name, "update", 6) == 0) d->w.a.lap = d->good.lap3;
    if (strcmp(c->name, "set_rational") == 0) d->w.a.heat = d->good.heat3;
    if (CALL_TAKES(c, "ldl") && strstr(c->name, "_c")) d->w.a.ldl = d->good.ldl2;
}

/* Does the error name this place? */
static int doors_at(const hd_error *e, const char *place) {
    static const char *const names[5] = {"face=", "vertex=", "row=", "column=", "value="};
    const double at[5] = {(double)e->face, (double)e->vertex, (double)e->row, (double)e->column, e->value};
    int k;
    for (k = 0; place && k < 5; k++)
        if (strncmp(place, names[k], strlen(names[k])) == 0) return at[k] == strtod(place + strlen(names[k]), NULL);
    return !place;
}

/* Such arguments, then the call; nothing is written where it fails, but by calls whose answers stand where questions did. */
static void doors_try(doors *d, const call_row *c, const char *words, hd_status want, const char *say, const char *place) {
    const hd_error *const e = &d->w.e;
    const int mixed = strstr(words, "f=u") || strstr(words, "zb=z");
    hd_status st;
    size_t k;
    int clean = 1, said;
    doors_ready(d, c);
    d->w.what = words;
    (void)call_words(&d->w, words, 0);
    st = call_one(&d->w, c, 0);
    for (k = 0; st < 0 && !mixed && k < d->w.out_size / sizeof(double); k++) clean &= d->w.out[k] == 0;
    said = strstr(e->text, say) || (strcmp(say, "must not be NULL") == 0 && strstr(e->text, "is missing"));
    CHECK_MSG((want < 0 ? st == want : st >= 0) && said, "%s %s: %s: %s", words, c->name, hd_status_name(st), e->text);
    CHECK_MSG(want >= 0 || doors_at(e, place), "%s %s: row %d, column %d, vertex %d, value %g", words, c->name, (int)e->row,
              (int)e->column, (int)e->vertex, e->value);
    CHECK_MSG(clean, "%s %s: something is written", words, c->name);
}

/* Is it in the list? */
static int doors_listed(const char *list, const char *item, char mark) {
    const size_t n = strlen(item);
    const char *at = list;
    while ((at = strstr(at, item)) != NULL) {
        if ((at == list || at[-1] == ' ') && (at == list || mark == ' ' || at[-2] == mark) && (at[n] == mark || !at[n])) return 1;
        at += n;
    }
    return 0;
}

/* Does the row speak of these words and this call? */
static int doors_applies(int row, const char *words, const call_row *c) {
    static const char *const options[6] = {"lo.a->lap_opts", "ho.a->heat_opts", "so.a->spectrum_opts", "go.a->geodesic_opts", "fo.a->ldl_opts",
                                           "vo.a->solve_opts"};
    const char *last = strrchr(words, ' '), *field = last ? last + 1 : words;
    char name[48];
    int k;
    if (!strstr(c->args, "a->err") || !doors_listed(door_rows[row].words, words, ';')) return 0;
    if (door_rows[row].which) return doors_listed(door_rows[row].which, c->name, ' ');
    for (k = 0; k < DOOR_ROWS; k++)
        if (door_rows[k].which && doors_listed(door_rows[k].words, words, ';') && doors_listed(door_rows[k].which, c->name, ' '))
            return 0;
    for (k = 0; k < 6; k++)                      /* of options: every call that takes them */
        if (strncmp(field, options[k], 3) == 0) return call_takes(c, options[k] + 3, strlen(options[k] + 3));
    snprintf(name, sizeof name, "a->%.*s", (int)strcspn(field, "="), field);
    return call_takes(c, name, strlen(name));
}

static void doors_row(doors *d, int row) {
    const door_row *const r = door_rows + row;
    const char *at = r->words;
    char words[80];
    int k, tried;
    while (*at) {
        const size_t n = strcspn(at, ";");
        snprintf(words, sizeof words, "%.*s", (int)n, at);
        at += n + (at[n] ? 2 : 0);
        for (k = 0, tried = 0; k < N_CALLS; k++) {
            if (!doors_applies(row, words, call_table + k)) continue;
            doors_try(d, call_table + k, words, r->want, r->say, r->place);
            tried++;
        }
        CHECK_MSG(tried > 0, "no call for %s", words);
    }
}

static void doors_rows(void) {
    static doors d;
    int row;
    doors_open(&d);
    for (row = 0; row < DOOR_ROWS; row++) doors_row(&d, row);
    doors_close(&d);
}

/* Rows above say where NULL is fine. No place for the error is fine. */
static void doors_missing(void) {
    static doors d;
    const char *at = door_pointers;
    char name[40], field[48], words[48];
    int row, k, tried;
    doors_open(&d);
    while ((at = call_next(at, name)) != NULL) {
        snprintf(words, sizeof words, "%s=NULL", name);
        snprintf(field, sizeof field, "a->%s", name);
        for (k = 0, tried = 0; k < N_CALLS; k++) {
            const call_row *const c = call_table + k;
            int fine = !strstr(c->args, "a->err");
            for (row = 0; row < DOOR_ROWS; row++) fine |= doors_applies(row, words, c);
            if (fine || !call_takes(c, field, strlen(field))) continue;
            doors_try(&d, c, words, HD_ERR_ARGUMENT, "must not be NULL", NULL);
            d.w.a.err = NULL;
            CHECK(c->run(&d.w.a) == HD_ERR_ARGUMENT);
            tried++;
        }
        CHECK_MSG(tried > 0, "no call for %s", words);
    }
    doors_close(&d);
}

/* Options that nobody cleared: rubbish everywhere, also in the context; all but the first word; all but the last. */
#define DOORS_RUBBISH(field, pointer) \
    if (CALL_TAKES(c, pointer)) { \
        memset(&d.good.field, 0xa5, sizeof d.good.field); \
        if (k == 1) d.good.field.begin_zero = 0; \
        if (k == 2) d.good.field.end_zero = 0; \
    }

static void doors_not_cleared(void) {
    static doors d;
    call_args good;
    int i, k, tried = 0;
    doors_open(&d);
    good = d.good;
    for (i = 0; i < N_CALLS; i++)
        for (k = 0; k < 3 && strstr(call_table[i].args, "_opts"); k++, tried++) {
            const call_row *const c = call_table + i;
            DOORS_RUBBISH(lo, "lap_opts")
            DOORS_RUBBISH(ho, "heat_opts")
            DOORS_RUBBISH(so, "spectrum_opts")
            DOORS_RUBBISH(go, "geodesic_opts")
            DOORS_RUBBISH(fo, "ldl_opts")
            DOORS_RUBBISH(vo, "solve_opts")
            doors_try(&d, c, "", HD_ERR_ARGUMENT, "not cleared", NULL);
            d.good = good;
        }
    CHECK(tried > 40);
    doors_close(&d);
}

/* A context that has become bad while objects live in it: every call that reads it says so. */
static void doors_context(void) {
    static doors d;
    test_memory m;
    int i;
    doors_open(&d);
    for (i = 0; i < N_CALLS; i++) {
        if (!strstr(call_table[i].args, "a->err") || strcmp(call_table[i].name, "poles") == 0) continue;
        d.ctx.n_threads = -1;
        doors_try(&d, call_table + i, "", HD_ERR_ARGUMENT, "n_threads is negative", NULL);
        d.ctx.n_threads = 0;
        d.ctx.allocator = test_memory_context(&m).allocator;
        d.ctx.allocator.free = NULL;
        doors_try(&d, call_table + i, "", HD_ERR_ARGUMENT, "allocator", NULL);
        d.ctx.allocator.alloc = NULL;
    }
    doors_close(&d);
}

/* ---- what is taken ---- */

/* The Laplacian exp is divided by the area, and its times come in the square of it: the mean of the logs is one time. */
static void doors_times_exp(doors *d) {
    double area, t[3];
    d->w.a = d->good;
    CHECK(call_words(&d->w, "exp points n_times=3 times_auto", 1) == HD_OK);
    memcpy(t, d->w.out, sizeof t);
    area = d->w.a.lap->area;
    CHECK(fabs(t[0] / (0.0024 * area * area) - 1) < 1e-12 && fabs(t[2] / (0.37 * area * area) - 1) < 1e-12);
    CHECK(fabs(t[1] / sqrt(t[0] * t[2]) - 1) < 1e-12);
    CHECK(call_words(&d->w, "n_times=1 times_auto", 0) == HD_OK && fabs(d->w.out[0] / t[1] - 1) < 1e-12);
}

/* An order of one's own and columns farther apart change places, not values; nor does it matter how far apart fields lie that
 * become their own answers. */
static void doors_apart(doors *d) {
    enum { N = 21, WIDE = N + 3 };
    call_args *const a = &d->w.a;
    double first[3 * N], far[3 * WIDE];
    const hd_spectrum *s = d->good.spectrum;
    int32_t q;
    *a = d->good;
    CHECK(call_words(&d->w, "own so.count=4 so.tol=1e-9 eigenpairs k=2 v=NULL eigen_columns", 1) == HD_OK);
    for (q = 0; q < 4; q++) CHECK(fabs(a->spectrum->value[q] - s->value[q]) <= 1e-9 * s->value[3]);
    memcpy(first, d->w.out, sizeof first);
    CHECK(call_words(&d->w, "ld=24 eigen_columns", 0) == HD_OK);
    for (q = 0; q < 2; q++) CHECK(memcmp(first + q * N, d->w.out + q * WIDE, N * sizeof *first) == 0);
    for (q = 0; q < 3 * WIDE; q++) far[q] = q % 11 - 3;
    a->f = far;
    CHECK(call_words(&d->w, "k=3 ldf=24 ld=21 apply", 0) == HD_OK);
    memcpy(first, d->w.out, sizeof first);
    CHECK(hd_heat_apply(a->heat, 1, a->t, 3, far, WIDE, far, N, NULL, NULL) == HD_OK && memcmp(far, first, sizeof first) == 0);
}

/* A plan takes sets of one time, one lambda_max and the same poles; Lanczos takes none. After an error the sets before are still there. */
static void doors_filter_sets(doors *d) {
    const size_t bytes = 21 * sizeof(double);
    double before[21];
    hd_rational sets[2];
    int k;
    for (k = 0; k < 6; k++) {
        sets[0] = sets[1] = d->data.sets[0];
        if (k == 1) sets[1].t *= 2;
        if (k == 2) sets[1].lambda_max *= 2;
        if (k == 3) sets[1].theta[0].re += 1;
        if (k == 4) sets[1].theta[0].im = -1;
        if (k == 5) sets[0].t = sets[1].t = 0;
        d->good.set = sets;
        doors_try(d, call_of("set_rational"), "n_sets=2", k ? HD_ERR_ARGUMENT : HD_OK,
                  k == 0 ? "" : k == 4 ? "theta needs" : "differs from the first", k == 5 ? "column=0" : "column=1");
        CHECK(call_words(&d->w, "n_times=0 t=NULL diagonal", 0) >= 0);
        if (k == 0) memcpy(before, d->w.out, bytes);
        CHECK(d->w.out[0] > 0 && memcmp(d->w.out, d->w.out + 21, bytes) == 0 && memcmp(d->w.out, before, bytes) == 0);
        CHECK(d->w.a.v[0] > 0 && d->w.a.v[0] == d->w.a.v[1] && d->w.a.bound[0] > 0 && d->w.a.bound[0] == d->w.a.bound[1]);
    }
    d->good.set = d->data.sets;
    d->w.a = d->good;
    CHECK(call_words(&d->w, "iterative lanczos plan heat3=heat", 1) == HD_OK);
    d->good.heat3 = d->w.a.heat3;
    doors_try(d, call_of("set_rational"), "", HD_ERR_ARGUMENT, "", NULL);
}

/* An update that is cancelled half way leaves a plan that says so until the next one. */
static void doors_half_updated(doors *d) {
    rob_progress p;
    double before[21];
    int told = 0;
    hd_status st = HD_ERR_CANCELLED;
    d->w.a = d->good;
    CHECK(call_words(&d->w, "geodesic_update geodesic_set", 0) >= 0);
    memcpy(before, d->w.out, sizeof before);
    rob_watch(&p, &d->ctx, 0);
    for (p.stop_at = 1; p.stop_at < 100; p.stop_at++) {
        p.calls = 0;
        st = call_words(&d->w, "geodesic_update", 0);
        if (st != HD_ERR_CANCELLED) break;
        if (call_words(&d->w, "geodesic_set", 0) >= 0) continue;      /* nothing had changed yet */
        CHECK(d->w.e.status == HD_ERR_ARGUMENT && strstr(d->w.e.text, "the last update failed"));
        told++;
    }
    CHECK(st >= 0 && told > 0);
    d->ctx.progress = NULL;
    CHECK(call_words(&d->w, "geodesic_set", 0) >= 0 && memcmp(before, d->w.out, sizeof before) == 0);
}

static void doors_taken(void) {
    static doors d;
    doors_open(&d);
    doors_times_exp(&d);
    doors_apart(&d);
    doors_filter_sets(&d);
    doors_half_updated(&d);
    doors_close(&d);
}

static void test_doors(void) {
    doors_rows();
    doors_missing();
    doors_not_cleared();
    doors_context();
    doors_taken();
}

#endif
