/* test_local.h - answers on the part of the mesh that heat reaches, held against all of the mesh by another method */

enum { LOC_MOST_TIMES = 4 };

/* Column k of U, whose bound rep has, against the same by poles of degree 14. */
static void loc_compare(const double *U, const hd_report *rep, const double *want, const hd_report *whole, int64_t n, int32_t k,
                        const char *what) {
    const double *u = U + n * k, *w = want + n * k, size = dense_max_abs(w, n), off = dense_max_diff(u, w, n);
    CHECK_MSG(off <= 1.000001 * (rep->error_bound * (size + off) + whole->error_bound * size), "%s, column %d: error %g, bound %g", what, k,
              off / size, rep->error_bound);
}

/* A call by both methods: columns of a vertex at one or several times, of three vertices, of a point in a face, a field around a
 * vertex, its derivative, the adjoint. Returns how many vertices were touched. */
static int32_t loc_call(const hd_laplacian *lap, hd_heat *local, hd_heat *whole, int32_t kind, hd_kernel kernel, double t, int32_t v,
                        const char *what) {
    const int32_t row = lap->row[v], mark = kit_mark(), k = kind == 1 ? LOC_MOST_TIMES : kind == 2 ? 3 : 1;
    const int32_t near = row < 0 ? v : lap->vertex[lap->L.col[lap->L.row_ptr[row]]], vs[4] = {v, (v + lap->n / 2) % lap->n, lap->n - 1 - v, near};
    const double ts[LOC_MOST_TIMES] = {t / 3, t, t / 30, t / 10}, weight[2] = {0.25, 0.75};
    const int64_t first[2] = {0, 2};
    double *U = KIT_NEW(double, (int64_t)lap->n * k), *want = KIT_NEW(double, (int64_t)lap->n * k), *f = KIT_NEW(double, lap->n);
    const double *at = kind == 1 ? ts : &t;
    const int32_t n_times = kind == 1 ? LOC_MOST_TIMES : 1;
    hd_sources sources = hd_vertices(kind == 2 ? 3 : 1, vs);
    hd_report rep[2];
    hd_status status[2];
    hd_error e;
    int32_t q;
    memset(f, 0, (size_t)lap->n * sizeof *f);
    if (kind == 3) {                             /* weights of two vertices */
        sources = hd_vertices(1, near == v ? vs : vs + 2);
        sources.first = first;
        sources.weight = weight;
        if (near == v) sources.first = NULL, sources.weight = NULL;
        else sources.vertex = vs + 2;
    }
    f[v] = 1;
    f[near] -= 0.7;
    for (q = 0; q < 2; q++) {
        hd_heat *heat = q ? whole : local;
        double *to = q ? want : U;
        if (kind < 4) status[q] = hd_heat_columns(heat, kernel, n_times, at, &sources, to, 0, rep + q, &e);
        else if (kind == 4) status[q] = hd_heat_apply(heat, 1, at, 1, f, 0, to, 0, rep + q, &e);
        else if (kind == 5) status[q] = hd_heat_derivative(heat, 1, at, 1, f, 0, to, 0, rep + q, &e);
        else status[q] = hd_heat_adjoint(heat, 1, at, 1, f, 0, to, 0, rep + q, &e);
        if (!CHECK_MSG(status[q] >= 0, "%s: %s", what, e.text)) break;
    }
    if (q == 2) {
        CHECK_MSG(rep[0].method == HD_METHOD_LOCAL && rep[0].solver == HD_SOLVER_LANCZOS && rep[0].n_touched <= lap->n_active, "%s", what);
        CHECK_MSG(lap->row[v] < 0 || rep[0].evidence_local == HD_EVIDENCE_MEASURED, "%s: evidence %d", what, (int)rep[0].evidence_local);
        CHECK_MSG(rep[0].error_bound >= rep[0].error_local && rep[0].error_rational == 0, "%s", what);
        CHECK_MSG(kind == 2 || rep[0].n_touched < lap->n_active || rep[0].error_local == 0, "%s: nothing lies beyond", what);
        for (q = 0; q < k; q++) loc_compare(U, rep, want, rep + 1, lap->n, q, what);
    }
    q = rep[0].n_touched;
    kit_release(mark);
    return q;
}

/* Every kind of call on a pair at several times. parts: how many of them must be of parts. */
static void loc_pair(const char *spec, int32_t parts) {
    const int32_t mark = kit_mark();
    const hd_laplacian *lap = kit_pair(spec);
    hd_heat *local = kit_heat(lap, "method=local"), *whole = kit_heat(lap, "method=direct poles=kernel degree=14");
    static const double times[3] = {0.05, 1, 6};
    const double unit = trial_unit(lap);
    char what[96];
    int32_t i, kind, v = lap->n / 3;
    for (i = 0; i < 3; i++)
        for (kind = 0; kind < 7; kind++, v = (v + 7919) % lap->n) {
            snprintf(what, sizeof what, "%s, call %d at %g", spec, kind, times[i]);
            parts -= loc_call(lap, local, whole, kind, i == 1 ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC, times[i] * unit, v, what) < lap->n_active;
        }
    CHECK_MSG(parts <= 0, "%s: %d calls on parts are missing", spec, parts);
    kit_release(mark);
}

/* Sparse rows are the columns without zeros, to the bit, by any method and in the caller's order of times. */
static void loc_sparse(void) {
    const hd_laplacian *lap = kit_pair("inert/50/0 fem+held");
    static const char *const plans[3] = {"method=local", "method=direct", "method=krylov"};
    const int32_t vs[3] = {lap->n / 3, lap->n - 1, 1100};       /* held, without mass, and another */
    const double t[3] = {2 * lap->h * lap->h, lap->h * lap->h, 3 * lap->h * lap->h};
    double *U = KIT_NEW(double, 9 * (int64_t)lap->n);
    hd_csr out = {0};
    hd_report rep;
    int32_t p, q, i;
    for (p = 0; p < 3; p++) {
        hd_heat *heat = kit_heat(lap, plans[p]);
        int64_t wrong = 0, at = 0;
        CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 3, t, VERTICES(3, vs), U, 0, NULL, NULL) >= 0);
        CHECK(hd_heat_columns_sparse(heat, HD_KERNEL_OPERATOR, 3, t, VERTICES(3, vs), &out, &rep, NULL) >= 0);
        CHECK(out.n_rows == 9 && out.n_cols == lap->n && out.row_ptr[9] == out.nnz);
        for (q = 0; q < 9; q++)
            for (i = 0; i < lap->n; i++) {
                const double u = U[(int64_t)q * lap->n + i];
                if (u == 0) continue;
                wrong += at >= out.row_ptr[q + 1] || out.col[at] != i || memcmp(out.val + at, &u, sizeof u) != 0;
                at++;
            }
        CHECK_MSG(wrong == 0 && at == out.nnz, "%s: %d values differ", plans[p], (int)wrong);
    }
    hd_csr_free(&out, NULL);
}

/* What is cut is small, and the bound says so. */
static void loc_cut(void) {
    const hd_laplacian *lap = kit_pair("bumpy/4/1 vor");
    hd_heat_opts o = {0};
    hd_heat *heat;
    const int32_t v = 77;
    const double t = 4 * lap->h * lap->h;
    double *u = KIT_NEW(double, lap->n), most;
    hd_csr out = {0};
    hd_report rep;
    int64_t p;
    o.method = HD_METHOD_LOCAL;
    o.cut = 1e-3;
    heat = kit_plan(lap, &o);
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, v, u, NULL, NULL) == HD_OK);
    CHECK(hd_heat_columns_sparse(heat, HD_KERNEL_SYMMETRIC, 1, &t, VERTICES(1, &v), &out, &rep, NULL) == HD_OK);
    most = dense_max_abs(u, lap->n);
    CHECK(rep.error_bound >= 1e-3 && rep.error_bound < 1.001e-3 && out.nnz > 20 && out.nnz < rep.n_touched / 2);
    for (p = 0; p < out.nnz; p++) u[out.col[p]] = 0;
    CHECK(dense_max_abs(u, lap->n) < 1e-3 * most);
    hd_csr_free(&out, NULL);
}

/* Entries, of which some lie beyond the part. */
static void loc_entries(void) {
    const hd_laplacian *lap = kit_pair("bumpy/4/5 fem");
    hd_heat *local = kit_heat(lap, "method=local"), *whole = kit_heat(lap, "method=direct degree=14");
    const int32_t i[5] = {5, 2000, 700, 11, 12}, j[5] = {5, 5, 700, 700, 700};
    const double t = lap->h * lap->h / 2;
    double a[5], b[5];
    hd_report rep, all;
    int32_t q;
    CHECK(hd_heat_entries(local, HD_KERNEL_SYMMETRIC, 1, &t, 5, i, j, a, &rep, NULL) == HD_OK);
    CHECK(hd_heat_entries(whole, HD_KERNEL_SYMMETRIC, 1, &t, 5, i, j, b, &all, NULL) == HD_OK);
    CHECK(rep.method == HD_METHOD_LOCAL && rep.evidence_local == HD_EVIDENCE_MEASURED && rep.error_bound < 1e-5);
    for (q = 0; q < 5; q++)
        CHECK(fabs(a[q] - b[q]) <= (rep.error_bound + all.error_bound) * dense_max_abs(b, 5) * 1.000001);
}

/* Auto takes a part where heat reaches little, in the time and memory of that; the same ball keeps its factor, and follows updates to the bit. */
static void loc_auto(void) {
    const int32_t mark = kit_mark();
    const shape *s = kit_shape("flat/150/150/0.3");
    hd_laplacian_opts lo = {0};
    hd_laplacian *lap = NULL;
    hd_context ctx = {0};
    hd_heat *heat, *other;
    hd_report rep;
    const int32_t v = 150 * 75 + 75;
    double *u = KIT_NEW(double, s->n), *w = KIT_NEW(double, s->n), *xyz = KIT_NEW(double, 3 * s->n), t;
    uint64_t before;
    hd_heat_opts o = {0};
    int32_t i;
    lo.updatable = 1;
    lo.context = &ctx;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &lo, NULL) == HD_OK);
    kit_keep(lap, kit_free_laplacian);
    CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    t = 2 * lap->h * lap->h;
    before = ctx.bytes_in_use;
    ctx.bytes_peak = 0;
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t, v, u, &rep, NULL) == HD_OK);
    CHECK(rep.method == HD_METHOD_LOCAL && rep.n_touched < s->n / 8 && rep.error_bound < 2e-7);
    CHECK(ctx.bytes_peak - before < 5000 * (uint64_t)rep.n_touched);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, 3000 * t, v, w, &rep, NULL) >= 0 && rep.method != HD_METHOD_LOCAL && rep.error_local == 0);
    for (i = 0; i < 3 * s->n; i++) xyz[i] = s->xyz[i] * (1 + 1e-3 * sin(i));
    CHECK(hd_laplacian_update(lap, MESH_TRIANGLES(xyz, s->n, s->tri, s->n_tri), NULL) == HD_OK);
    o.method = HD_METHOD_LOCAL;
    CHECK(hd_heat_create(&other, lap, &o, NULL) == HD_OK);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t, v, u, &rep, NULL) == HD_OK && rep.method == HD_METHOD_LOCAL);
    CHECK(hd_heat_column(other, HD_KERNEL_OPERATOR, t, v, w, NULL, NULL) == HD_OK && memcmp(u, w, (size_t)s->n * sizeof *u) == 0);
    hd_heat_free(heat);
    hd_heat_free(other);
    kit_release(mark);
}

/* An estimate of what was asked for is there on any mesh; of fields, which it does not know, it is of all of the mesh. */
static void loc_estimate(void) {
    const hd_laplacian *lap = kit_pair("ico/3 fem");
    hd_heat *heat = kit_heat(lap, "method=local");
    const double t = lap->h * lap->h / 10;
    hd_estimate e[2];
    CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1, &t, 1, e, NULL) == HD_OK && hd_heat_estimate(heat, HD_QUERY_FIELDS, 1, &t, 1, e + 1, NULL) == HD_OK);
    CHECK(e[0].method == HD_METHOD_LOCAL && e[0].cost[0].fits && e[1].cost[0].fits && e[0].cost[0].flops > 0);
    CHECK(e[0].cost[0].flops < e[1].cost[0].flops);
}

/* What has no local answer is refused. */
static void loc_refused(void) {
    const hd_laplacian *lap = kit_pair("ico/3 fem");
    hd_heat *heat = kit_heat(lap, "method=local");
    const double t = lap->h * lap->h;
    double *u = KIT_NEW(double, lap->n);
    const hd_rational set = {0};
    hd_error e;
    memset(u, 0, (size_t)lap->n * sizeof *u);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, u, 0, NULL, NULL, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_set_rational(heat, 1, &set, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_apply(heat, 1, &t, 1, u, 0, u, 0, NULL, &e) == HD_OK && dense_max_abs(u, lap->n) == 0);
}

static void test_local(void) {
    loc_pair("bumpy/4/1 fem", 8);
    loc_pair("bumpy/4/5 vor", 14);
    loc_pair("flat/60/40/0.4 fem+held", 9);
    loc_pair("cylinder/8/300 vor", 5);
    loc_pair("grid/50/4 fem", 3);
    loc_pair("needles/4 fem+id", 3);
    loc_pair("two/3/1/3 fem", 12);
    loc_pair("cone/40/40 vor", 1);
    loc_pair("qtorus/60/30 poly", 8);
    loc_pair("points/1500/1/1 vexp", 1);
    loc_sparse();
    loc_cut();
    loc_entries();
    loc_auto();
    loc_estimate();
    loc_refused();
}
