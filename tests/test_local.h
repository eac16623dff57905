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
    const int32_t vs[3] = {lap->n / 3, lap->n - 1, 1125};       /* held, without mass, and another */
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
        CHECK(out.n_rows == 9 && out.n_cols == lap->n && out.row_ptr[9] == out.nnz && out.nnz > 3000);
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

/* Where eigenpairs answer better than poles a row is answered twice: the matrix has the entries of the second answer only. */
static void loc_sparse_twice(void) {
    const shape *s = kit_shape("flat/30/24/0.2");
    hd_laplacian *lap = NULL;
    hd_laplacian_opts o;
    int32_t v;
    int q, pairs = 0;
    memset(&o, 0, sizeof o);
    o.border = HD_BORDER_DIRICHLET;
    if (!CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, NULL) == HD_OK)) return;
    v = kit_own_laplacian(lap)->vertex[0];       /* beside a corner, where little heat is left */
    for (q = 0; q < 5; q++) {
        const double t = ldexp(lap->h * lap->h, q);
        hd_csr out;
        hd_report rep;
        memset(&out, 0, sizeof out);
        CHECK(at_sparse(&out, kit_heat(lap, "method=direct"), HD_KERNEL_OPERATOR, 1, &t, VERTICES(1, &v), &rep, NULL) >= 0);
        CHECK_MSG(out.nnz == out.row_ptr[1], "%d entries, and a row of %d", (int)out.nnz, (int)out.row_ptr[1]);
        pairs += strstr(rep.reason, "eigenpairs") != NULL;
        hd_csr_free(&out, NULL);
    }
    CHECK(pairs > 0);
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
    CHECK(rep.status == HD_OK && rep.error_bound >= 1e-3 && rep.error_bound < 1.001e-3 && out.nnz > 20 && out.nnz < rep.n_touched / 2);
    for (p = 0; p < out.nnz; p++) u[out.col[p]] = 0;
    CHECK(dense_max_abs(u, lap->n) < 1e-3 * most);
    o.cut = 0.05;                                /* a larger bound warns */
    CHECK(hd_heat_columns_sparse(kit_plan(lap, &o), HD_KERNEL_SYMMETRIC, 1, &t, VERTICES(1, &v), &out, &rep, NULL) == HD_WARN_ACCURACY);
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
    CHECK(hd_heat_entries(whole, HD_KERNEL_SYMMETRIC, 1, &t, 5, i, j, b, &all, NULL) >= 0);
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
    double *u = KIT_NEW(double, s->n), *w = KIT_NEW(double, s->n), *xyz = KIT_NEW(double, 3 * s->n), t, heat_out = 0, heat_all = 0;
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
    for (i = 0; i < s->n; i++) heat_out += lap->mass[lap->row[i]] * u[i], heat_all += fabs(lap->mass[lap->row[i]] * u[i]);
    CHECK_MSG(rep.mass_drift > 0 && fabs(rep.mass_drift - fabs(heat_out - lap->mass[lap->row[v]]) / heat_all) < 1e-13, "drift %g", rep.mass_drift);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, 3000 * t, v, w, &rep, NULL) >= 0 && rep.method != HD_METHOD_LOCAL && rep.error_local == 0);
    for (i = 0; i < 3 * s->n; i++) xyz[i] = s->xyz[i] * (1 + 1e-9 * sin(i));     /* so little that the ball stays */
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
    const hd_laplacian *lap = kit_pair("ico/4 fem");
    hd_heat *heat = kit_heat(lap, "method=local");
    const double t = lap->h * lap->h / 10;
    hd_estimate e[2];
    CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1, &t, 1, e, NULL) == HD_OK && hd_heat_estimate(heat, HD_QUERY_FIELDS, 1, &t, 1, e + 1, NULL) == HD_OK);
    CHECK(e[0].method == HD_METHOD_LOCAL && e[0].cost[0].fits && e[1].cost[0].fits && e[0].cost[0].flops > 0);
    CHECK(e[0].cost[0].flops < e[1].cost[0].flops);
}

/* Columns of two sources at two times, dense. */
static hd_status loc_two(hd_heat *heat, const hd_laplacian *lap, double *U, hd_report *rep) {
    const double h2 = lap->h * lap->h, t[2] = {h2 / 2, h2 / 8};
    const int32_t v[2] = {lap->n / 2, lap->n / 3};
    return hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 2, t, VERTICES(2, v), U, 0, rep, NULL);
}

/* The same where an allocation fails or memory is short: the plan says so, or goes another way where it may; afterwards it gives the same
 * bits, and nothing is left. auto, and local. */
static void loc_starved(hd_method method) {
    const shape *s = kit_shape("flat/66/66/0.3");
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    double *want = KIT_NEW(double, 4 * s->n), *u = KIT_NEW(double, 4 * s->n);
    const size_t size = 4 * (size_t)s->n * sizeof *u;
    hd_laplacian *lap;
    hd_heat *heat;
    hd_report rep, clean;
    hd_heat_opts o = {0};
    int64_t calls = 0, k;
    uint64_t peak = 0, before;
    ctx.n_threads = 1;
    lap = test_laplacian_at(s, s->xyz, HD_LAPLACIAN_FEM, 0, &ctx);
    o.method = method;
    before = ctx.bytes_in_use;
    for (k = 0; k <= calls + 16; k += k > 0 && k <= calls ? CASES_FEW ? 15 : 3 : 1) {     /* failures, then limits */
        hd_status st;
        const uint64_t limit = k > calls ? before + peak * (uint64_t)(k - calls) / 15 : 0;
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
        m.fail_at = k > 0 && k <= calls ? m.calls + k : 0;
        ctx.byte_limit = limit;
        ctx.bytes_peak = ctx.bytes_in_use;
        if (k == 0) calls = -m.calls;
        st = loc_two(heat, lap, k ? u : want, &rep);
        if (k == 0) {
            calls += m.calls;
            peak = ctx.bytes_peak - before;
            clean = rep;
            CHECK(st == HD_OK && rep.method == HD_METHOD_LOCAL && calls > 50);
        } else if (k <= calls) {
            CHECK_MSG(st == HD_ERR_MEMORY, "allocation %d of %d: %s", (int)k, (int)calls, hd_status_name(st));
        } else {
            CHECK_MSG(st >= 0 || (st == HD_ERR_MEMORY_LIMIT && limit < before + peak), "limit %d of 15: %s", (int)(k - calls), hd_status_name(st));
            CHECK(ctx.bytes_peak <= limit);
            CHECK(st < 0 || rep.method == HD_METHOD_LOCAL || (method == HD_METHOD_AUTO && rep.n_touched == 0 && rep.evidence_local == 0));
            if (st >= 0) CHECK(fail_agree(u, want, size / sizeof *u, rep.error_bound, clean.error_bound));
        }
        m.fail_at = 0;
        ctx.byte_limit = 0;
        if (k % 5 == 0) CHECK(loc_two(heat, lap, u, NULL) == HD_OK && (k > calls || memcmp(u, want, size) == 0));
        hd_heat_free(heat);
        CHECK_MSG(ctx.bytes_in_use == before, "%d of %d: %d bytes are left", (int)k, (int)calls, (int)(ctx.bytes_in_use - before));
    }
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, "local");
}

/* A source that lies everywhere, after one that does not: auto goes another way, of which alone the report tells. */
static void loc_retreat(void) {
    const hd_laplacian *lap = kit_pair("flat/72/72/0.3 vor");
    hd_heat *heat = kit_heat(lap, ""), *direct = kit_heat(lap, "method=direct poles=kernel degree=14");
    const int32_t n = lap->n;
    const int64_t first[3] = {0, 1, n + 1};
    int32_t *v = KIT_NEW(int32_t, n + 1), i, q;
    double *U = KIT_NEW(double, 2 * n), *want = KIT_NEW(double, 2 * n), t[2] = {lap->h * lap->h, 0.1 * lap->h * lap->h};
    hd_sources s = hd_vertices(2, v);
    hd_report rep, all;
    v[0] = n / 2;
    for (i = 0; i < n; i++) v[i + 1] = i;
    s.first = first;
    for (q = 0; q < 2; q++) {
        CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, t + q, &s, U, 0, &rep, NULL) == HD_OK);
        CHECK(hd_heat_columns(direct, HD_KERNEL_OPERATOR, 1, t + q, &s, want, 0, &all, NULL) == HD_OK);
        CHECK(rep.method != HD_METHOD_LOCAL && rep.n_touched == 0 && rep.evidence_local == HD_EVIDENCE_NONE && rep.error_local == 0);
        for (i = 0; i < 2; i++) loc_compare(U, &rep, want, &all, n, i, "a source everywhere");
    }
}

/* Lists whose last column is that of a held vertex, and distances: how the error is known is not lost, and it is in error_local. */
static void loc_lists(void) {
    const hd_laplacian *lap = kit_pair("flat/60/40/0.4 fem+held");
    hd_heat *local = kit_heat(lap, "method=local"), *whole = kit_heat(lap, "method=krylov tol=1e-11");
    const double t = lap->h * lap->h;
    int32_t i[3] = {0, 900, 30}, j[3] = {0, 901, 31}, held = lap->n - 1, q;
    double a[3], b[3];
    hd_report rep, all;
    while (lap->row[held] != HD_ROW_HELD) held--;
    i[2] = j[2] = held;
    i[0] = j[0] = lap->vertex[lap->n_active / 2];
    CHECK(hd_heat_entries(local, HD_KERNEL_SYMMETRIC, 1, &t, 3, i, j, a, &rep, NULL) == HD_OK);
    CHECK(hd_heat_entries(whole, HD_KERNEL_SYMMETRIC, 1, &t, 3, i, j, b, &all, NULL) >= 0);
    CHECK(a[2] == 0 && rep.error_local > 0 && rep.evidence_local == HD_EVIDENCE_MEASURED && rep.error_rational == 0);
    for (q = 0; q < 3; q++) CHECK(fabs(a[q] - b[q]) <= (rep.error_bound + all.error_bound) * dense_max_abs(b, 3));
    j[0]++;
    CHECK(hd_heat_distance_pairs(local, HD_DISTANCE_CLASSICAL, 1, &t, 3, i, j, a, &rep, NULL) == HD_OK);
    CHECK(hd_heat_distance_pairs(whole, HD_DISTANCE_CLASSICAL, 1, &t, 3, i, j, b, &all, NULL) >= 0);
    CHECK(rep.method == HD_METHOD_LOCAL && rep.evidence_local == HD_EVIDENCE_MEASURED && rep.evidence_rational == HD_EVIDENCE_NONE);
    CHECK(rep.error_local > 0 && rep.error_rational == 0 && rep.error_local + rep.error_solver + rep.error_rounding <= rep.error_bound * 1.0001);
    for (q = 0; q < 3; q++) CHECK(fabs(a[q] - b[q]) <= (rep.error_bound + all.error_bound) * dense_max_abs(b, 3));
}

/* Fields that become their own answers, far apart or not; times in any order, with 0 and one that leaves the means only. */
static void loc_calls(void) {
    const hd_laplacian *lap = kit_pair("bumpy/4/5 vor");
    hd_heat *heat = kit_heat(lap, "method=local");
    const int32_t n = lap->n, v = 9;
    const double unit = lap->h * lap->h, t[5] = {3 * unit, 0, 1e15 * unit, unit, 0.2 * unit};
    double *f = KIT_NEW(double, 4 * n), *want = KIT_NEW(double, 5 * n);
    hd_report rep;
    hd_estimate cost;
    int32_t q;
    for (q = 0; q < 3; q++) f[q * (n + 1) + 100 * q] = 1;
    for (q = 0; q < 3; q++) CHECK(hd_heat_apply(heat, 1, t + 3, 1, f + q * (n + 1), 0, want + q * n, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_apply(heat, 1, t + 3, 3, f, (size_t)n + 1, f, (size_t)n, &rep, NULL) == HD_OK && rep.n_touched < n);
    CHECK(memcmp(f, want, 3 * (size_t)n * sizeof *f) == 0);
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 5, t, VERTICES(1, &v), want, 0, &rep, NULL) == HD_OK && rep.n_touched == n);
    for (q = 0; q < 5; q++) {
        CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t[q], v, f, &rep, NULL) == HD_OK);
        CHECK_MSG(dense_max_diff(f, want + q * n, n) <= 2 * rep.error_bound, "time %d: %g", q, dense_max_diff(f, want + q * n, n));
    }
    CHECK(want[n + v] == 1 && fabs(want[2 * n] / want[2 * n + n - 1] - 1) < 1e-9);
    for (q = HD_QUERY_FIELDS; q <= HD_QUERY_PAIRS; q++)
        CHECK(hd_heat_estimate(heat, (hd_query)q, 1, t, 3, &cost, NULL) == HD_OK && cost.method == HD_METHOD_LOCAL && cost.cost[HD_METHOD_LOCAL].possible &&
              cost.cost[HD_METHOD_AUTO].seconds > 0 && !cost.analysed);
    CHECK(hd_heat_estimate(heat, HD_QUERY_DISTANCE_COMMUTE, 1, t, 3, &cost, NULL) == HD_ERR_ARGUMENT);
}

/* Paths of 48 vertices and vertices without an edge in between, which have no entry in L. */
static void loc_lone(void) {
    enum { N = 6000 };
    int32_t *a = KIT_NEW(int32_t, N), *b = KIT_NEW(int32_t, N), m = 0, i, q;
    const int32_t at[3] = {99, 60, N - 1};
    const hd_laplacian *lap;
    for (i = 0; i + 1 < N; i++)
        if (i % 50 < 48) a[m] = i, b[m++] = i + 1;
    lap = kit_graph(N, m, a, b, NULL, NULL);
    for (q = 0; q < 3; q++)
        for (i = 0; i < 2; i++) {
            double *u = KIT_NEW(double, N), off = 0;
            hd_report rep;
            int32_t k;
            CHECK(hd_heat_column(kit_heat(lap, i ? "method=local" : ""), HD_KERNEL_OPERATOR, 100, at[q], u, &rep, NULL) == HD_OK);
            CHECK(rep.method == HD_METHOD_LOCAL && rep.error_local == 0 && rep.n_touched == (at[q] % 50 == 49 ? 1 : 49));
            for (k = 0; k < N; k++) off += k / 50 == at[q] / 50 && (k % 50 == 49) == (at[q] % 50 == 49) ? u[k] - 1 : fabs(u[k]);
            CHECK(fabs(off + (at[q] % 50 == 49 ? 0 : 48)) < 1e-9 && u[at[q]] > 0);
        }
}

/* A full B, whose inverse reaches far: the ball grows until the error is small. */
static void loc_full(double beside) {
    enum { N = 3000 };
    const int32_t mark = kit_mark();
    hd_csr L = kit_own_csr(test_path_csr(N, 1)), B = kit_own_csr(test_path_csr(N, 1));
    hd_laplacian *lap = NULL;
    hd_heat *local, *whole;
    double *u = KIT_NEW(double, N), *w = KIT_NEW(double, N), *f = KIT_NEW(double, N);
    const double t = 1;
    hd_report rep, all;
    int64_t p;
    int32_t i, q;
    for (i = 0; i < N; i++)
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 1 : beside;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, NULL) == HD_OK);
    kit_own_laplacian(lap);
    local = kit_heat(lap, "method=local");
    whole = kit_heat(lap, "method=krylov");
    f[N / 2] = 1;
    f[N / 2 + 1] = -1;
    for (q = 0; q < 3; q++) {
        CHECK((q < 2 ? hd_heat_column(local, (hd_kernel)q, t, N / 2, u, &rep, NULL) : hd_heat_derivative(local, 1, &t, 1, f, 0, u, 0, &rep, NULL)) == HD_OK);
        CHECK((q < 2 ? hd_heat_column(whole, (hd_kernel)q, t, N / 2, w, &all, NULL) : hd_heat_derivative(whole, 1, &t, 1, f, 0, w, 0, &all, NULL)) == HD_OK);
        CHECK_MSG(rep.n_touched < N / 8 && rep.error_bound < 1e-6, "%g, query %d: %d vertices, bound %g", beside, q, (int)rep.n_touched, rep.error_bound);
        loc_compare(u, &rep, w, &all, N, 0, "full B");
    }
    kit_release(mark);
}

/* Hardly any time, a full B whose inverse reaches far, and a small tolerance: what counts is B^-1 c beyond the ball and, for an
 * adjoint, B u there. */
static void loc_inverse(void) {
    enum { N = 3000 };
    const int32_t mark = kit_mark();
    hd_csr L = kit_own_csr(test_path_csr(N, 1)), B = kit_own_csr(test_path_csr(N, 1));
    hd_laplacian *lap = NULL;
    double *u = KIT_NEW(double, N), *w = KIT_NEW(double, N), *g = KIT_NEW(double, N);
    const double t = 1e-5;
    hd_report rep, all;
    int64_t p;
    int32_t i, q;
    for (i = 0; i < N; i++)
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 1 : 0.4;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, NULL) == HD_OK);
    kit_own_laplacian(lap);
    memset(g, 0, N * sizeof *g);
    g[N / 2] = 1;
    for (q = 0; q < 2; q++) {
        hd_heat *local = kit_heat(lap, "method=local tol=1e-10"), *whole = kit_heat(lap, "method=krylov tol=1e-13");
        if (q) CHECK(hd_heat_adjoint(local, 1, &t, 1, g, 0, u, 0, &rep, NULL) >= 0 && hd_heat_adjoint(whole, 1, &t, 1, g, 0, w, 0, &all, NULL) >= 0);
        else CHECK(hd_heat_column(local, HD_KERNEL_SYMMETRIC, t, N / 2, u, &rep, NULL) >= 0 && hd_heat_column(whole, HD_KERNEL_SYMMETRIC, t, N / 2, w, &all, NULL) >= 0);
        CHECK(rep.n_touched < N / 2 && rep.error_local > 0 && rep.error_bound < 1e-6);
        loc_compare(u, &rep, w, &all, N, 0, q ? "adjoint at hardly any time" : "column at hardly any time");
    }
    kit_release(mark);
}

/* A tiny sphere beside: values there could be off by so much more, as its masses are so much smaller. */
static void loc_uneven(void) {
    double local[2];
    int32_t q;
    for (q = 0; q < 2; q++) {
        const hd_laplacian *lap = kit_pair(q ? "two/3/2/3 vor" : "two/3/0/3 vor");
        const int32_t v = 5;
        const double t = 0.001;
        double *u = KIT_NEW(double, lap->n);
        hd_report rep;
        CHECK(hd_heat_column(kit_heat(lap, "method=local tol=1e-4"), HD_KERNEL_OPERATOR, t, v, u, &rep, NULL) >= 0);
        CHECK(rep.n_touched < lap->n_active / 2);
        local[q] = rep.error_local;
    }
    CHECK_MSG(local[1] > 50 * local[0] && local[1] < 200 * local[0], "%g and %g", local[0], local[1]);
}

/* Diagonals and traces in patches, which a byte limit makes small, against all of the mesh by poles of degree 14. */
static void loc_patches(const char *spec, hd_kernel kernel, const char *plan) {
    const hd_laplacian *lap = kit_pair(spec);
    hd_heat *local = kit_heat(lap, plan), *whole;
    const int32_t n = lap->n;
    const double t[2] = {trial_unit(lap) / 16, trial_unit(lap) / 64};
    double *D = KIT_NEW(double, 2 * (int64_t)n), *W = KIT_NEW(double, 2 * (int64_t)n), Z[2], bound[2], Y[2], sure[2];
    const int32_t mark = kit_mark();
    hd_report rep, all;
    hd_context *ctx = lap->context;
    const uint64_t before = ctx->bytes_in_use;
    hd_status status = HD_ERR_MEMORY_LIMIT;
    uint64_t need;
    hd_error e;
    int32_t i, q;
    ctx->bytes_peak = before;
    whole = kit_heat(lap, "method=direct poles=kernel degree=14");
    CHECK(hd_heat_diagonal(whole, kernel, 2, t, W, 0, Y, sure, &all, NULL) >= 0);
    kit_release(mark);
    need = (ctx->bytes_peak - before) / 10;
    for (q = 6; q < 9 && status == HD_ERR_MEMORY_LIMIT; q++) {
        ctx->bytes_peak = ctx->bytes_in_use;
        ctx->byte_limit = ctx->bytes_in_use + (uint64_t)q * need;
        status = hd_heat_diagonal(local, kernel, 2, t, D, 0, Z, bound, &rep, &e);
    }
    if (CHECK_MSG(status == HD_OK, "%s: %s", spec, e.text)) {
        CHECK_MSG(rep.method == HD_METHOD_LOCAL && rep.n_touched > 0 && rep.n_touched < lap->n_active, "%s: %d touched", spec, (int)rep.n_touched);
        CHECK_MSG(rep.error_local > 0 && rep.evidence_local == HD_EVIDENCE_MEASURED && rep.error_local < rep.error_bound, "%s", spec);
        CHECK_MSG(rep.error_relative < 1e-4, "%s: %g", spec, rep.error_relative);
        CHECK(ctx->bytes_peak <= ctx->byte_limit);
        for (q = 0; q < 2; q++) {
            for (i = 0; i < n; i++) {
                const double off = fabs(D[q * n + i] - W[q * n + i]), size = fabs(W[q * n + i]);
                if (!CHECK_MSG(off <= (1 + 1e-9) * (rep.error_relative + all.error_relative) * size, "%s, time %d, vertex %d: %g of %g", spec, q, i,
                               off / size, rep.error_relative)) break;
            }
            CHECK_MSG(fabs(Z[q] - Y[q]) <= bound[q] + sure[q] && bound[q] < 1e-5 * Z[q], "%s: trace %g of %g", spec, Z[q] - Y[q], bound[q]);
        }
        CHECK(hd_heat_diagonal(local, kernel, 2, t, NULL, 0, Y, NULL, &all, NULL) == HD_OK && all.method == HD_METHOD_LOCAL && all.error_local > 0);
        if (!CASES_FEW && lap->n > 3000) {       /* every third vertex, twice, as entries */
            const int32_t some = (n + 2) / 3;
            int32_t *v = KIT_NEW(int32_t, 2 * some);
            double *X = KIT_NEW(double, 4 * (int64_t)some);
            for (i = 0; i < 2 * some; i++) v[i] = i % some * 3;
            CHECK(hd_heat_entries(local, kernel, 2, t, 2 * some, v, v, X, &all, NULL) == HD_OK && all.method == HD_METHOD_LOCAL);
            CHECK(!*plan || all.n_patches > 0);
            for (i = 0; i < 4 * some; i++) {
                const int32_t at = i / (2 * some) * n + v[i % (2 * some)];
                if (!CHECK_MSG(fabs(X[i] - D[at]) <= (all.error_relative + rep.error_relative) * fabs(D[at]), "%s: entry %d", spec, (int)at)) break;
            }
        }
        for (q = 0; q < 2; q++) CHECK_MSG(fabs(Z[q] - Y[q]) <= 2 * bound[q], "%s: %g", spec, Z[q] - Y[q]);
    }
    ctx->byte_limit = 0;
}

/* Distances to all vertices by patches and balls, within the byte limit or as asked for, against those by poles of degree 14. A
 * source is one vertex or three. */
static void loc_distances(const char *spec, hd_distance_kind kind, const char *plan) {
    const hd_laplacian *lap = kit_pair(spec);
    hd_heat *local = kit_heat(lap, plan);
    const int32_t n = lap->n, v[4] = {n / 2, n / 3, n / 3 + 1, n / 3 + 2};
    const int64_t first[3] = {0, 1, 4};
    const double t[2] = {trial_unit(lap) / 99, trial_unit(lap) / 198}, weight[4] = {1, 0.5, 0.2, 0.3};
    double *D = KIT_NEW(double, 4 * (int64_t)n), *W = KIT_NEW(double, 4 * (int64_t)n);
    hd_sources sources = hd_vertices(2, v);
    hd_context *ctx = lap->context;
    const uint64_t before = ctx->bytes_in_use;
    const int32_t mark = kit_mark();
    hd_report rep, all;
    hd_error e;
    int32_t i, q;
    sources.first = first;
    sources.weight = weight;
    ctx->bytes_peak = before;
    CHECK(hd_heat_distance(kit_heat(lap, "method=direct poles=kernel degree=14"), kind, 2, t, &sources, W, 0, &all, NULL) >= 0);
    kit_release(mark);
    ctx->byte_limit = ctx->bytes_in_use + (ctx->bytes_peak - before) / 2;
    ctx->bytes_peak = ctx->bytes_in_use;
    if (CHECK_MSG(hd_heat_distance(local, kind, 2, t, &sources, D, 0, &rep, &e) == HD_OK, "%s: %s", spec, e.text)) {
        CHECK_MSG(rep.method == HD_METHOD_LOCAL && rep.n_patches > 1 && rep.n_touched < lap->n_active, "%s: %d", spec,
                  (int)rep.n_patches);
        CHECK_MSG(rep.error_bound < 1e-6 && rep.n_lost == 0 && rep.error_relative < 1e-4, "%s: %g, %g", spec, rep.error_bound, rep.error_relative);
        CHECK(ctx->bytes_peak <= ctx->byte_limit);
        for (q = 0; q < 4; q++) {
            const double size = dense_max_abs(W + q * n, n);
            for (i = 0; i < n; i++) {
                const double off = fabs(D[q * n + i] - W[q * n + i]), own = fmax(D[q * n + i], W[q * n + i]);
                if (!CHECK_MSG(off <= 1.000001 * (rep.error_bound + all.error_bound) * size && off <= 1.000001 * (rep.error_relative + all.error_relative) * own,
                               "%s, column %d, vertex %d: %g of %g", spec, q, i, off / size, rep.error_bound)) break;
            }
        }
    }
    ctx->byte_limit = 0;
    kit_release(mark);
    local = kit_heat(lap, "method=local");
    {
        int32_t far[2][4];
        double d[2][4], u;
        CHECK(hd_heat_sample(local, kind, t[1], NULL, 4, far[0], d[0], &rep, NULL) >= 0 && rep.method == HD_METHOD_LOCAL);
        CHECK(hd_heat_sample(kit_heat(lap, "method=direct"), kind, t[1], NULL, 4, far[1], d[1], NULL, NULL) >= 0 && far[0][0] == far[1][0]);
        for (i = 1; i < 4; i++) CHECK_MSG(fabs(d[0][i] - d[1][i]) < 1e-6 * d[1][1], "%s: point %d is %g from the others, not %g", spec, i, d[0][i], d[1][i]);
        CHECK(hd_heat_distance(local, HD_DISTANCE_COMMUTE, 0, NULL, &sources, &u, 0, NULL, &e) == HD_ERR_ARGUMENT);
    }
}

/* Where one patch is all of the mesh its diagonal leaves nothing out: the error of d^2 is that of its column on a ball, twice. */
static void loc_distance_column(const char *spec) {
    const int32_t mark = kit_mark();
    const hd_laplacian *lap = kit_pair(spec);
    const int32_t v = lap->n / 3;
    hd_heat *local = kit_heat(lap, "method=local tol=1e-12");    /* that of columns within distances */
    const double t = lap->h * lap->h / 2;
    double *d = KIT_NEW(double, lap->n), *u = KIT_NEW(double, lap->n), own;
    hd_report rep, column;
    CHECK(hd_heat_distance(local, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &v), d, 0, &rep, NULL) >= 0);
    CHECK(hd_heat_column(local, HD_KERNEL_SYMMETRIC, 2 * t, v, u, &column, NULL) >= 0 && column.n_touched < lap->n);
    CHECK_MSG(rep.n_patches == 1 && rep.n_touched == lap->n, "%s: %d patches", spec, (int)rep.n_patches);
    own = 2 * column.error_bound * dense_max_abs(u, lap->n) / pow(dense_max_abs(d, lap->n), 2);
    CHECK_MSG(own > 1e-12 && rep.error_bound > own, "%s: %g by the column, %g in all", spec, own, rep.error_bound);
    kit_release(mark);
}

/* What has no local answer is refused. */
static void loc_refused(void) {
    const hd_laplacian *lap = kit_pair("ico/3 fem");
    hd_heat *heat = kit_heat(lap, "method=local");
    const double t = lap->h * lap->h;
    double *u = KIT_NEW(double, lap->n);
    const int32_t first = 0;
    hd_rational set = {0};
    hd_report rep;
    hd_error e;
    memset(u, 0, (size_t)lap->n * sizeof *u);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_BIHARMONIC, 0, NULL, VERTICES(1, &first), u, 0, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_heat_apply(heat, 1, &t, 1, u, 0, u, 0, NULL, &e) == HD_OK && dense_max_abs(u, lap->n) == 0);
    CHECK(hd_heat_set_rational(heat, 1, &set, &e) == HD_OK);      /* a set without poles, and with the term of B^-1 alone */
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, u, 0, NULL, NULL, NULL, &e) == HD_OK && dense_max_abs(u, lap->n) == 0);
    set.a0 = 2;
    CHECK(hd_heat_set_rational(heat, 1, &set, &e) == HD_OK);
    CHECK(hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &t, u, 0, NULL, NULL, NULL, &e) == HD_OK && u[0] == 2 && dense_max_abs(u, lap->n) == 2);
    CHECK(hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &first), u, 0, &rep, &e) == HD_WARN_ACCURACY);
    CHECK(rep.n_lost == lap->n - 1);             /* the diagonal of B^-1 is not at hand */
}

/* A set of the caller's own serves for many times, and in the ball that is there, until it is taken away. */
static void loc_own_set(void) {
    const hd_laplacian *lap = kit_pair("flat/72/72/0.3 fem");
    hd_heat *heat = kit_heat(lap, "");
    const double t = lap->h * lap->h, ts[2] = {t, t / 2};
    const int32_t v = 9;
    double *u = KIT_NEW(double, lap->n), *w = KIT_NEW(double, 2 * (int64_t)lap->n), *x = KIT_NEW(double, lap->n);
    hd_rational set;
    hd_report rep, more;
    CHECK(hd_rational_exp(&set, HD_POLES_KERNEL, 10, NULL) == HD_OK);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t, 9, u, &rep, NULL) == HD_OK && rep.method == HD_METHOD_LOCAL);
    CHECK(hd_heat_set_rational(heat, 1, &set, NULL) == HD_OK);
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 2, ts, VERTICES(1, &v), w, 0, &rep, NULL) >= 0 && rep.method == HD_METHOD_LOCAL);
    CHECK(rep.poles == HD_POLES_OWN && rep.error_local > 0 && rep.evidence_local == HD_EVIDENCE_PROVEN);
    CHECK(dense_max_diff(u, w, lap->n) < 1e-6);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t, v, x, &more, NULL) >= 0 && memcmp(x, w, (size_t)lap->n * sizeof *x) == 0);
    CHECK(more.error_bound <= rep.error_bound);
    set.a[0].re *= 0.9;                          /* the same poles */
    CHECK(hd_heat_set_rational(heat, 1, &set, NULL) == HD_OK && hd_heat_column(heat, HD_KERNEL_OPERATOR, t, v, x, NULL, NULL) >= 0);
    CHECK(hd_heat_column(filt_plan(lap, &set, "method=direct"), HD_KERNEL_OPERATOR, t, v, w, NULL, NULL) >= 0 && dense_max_diff(x, w, lap->n) < 1e-6);
    CHECK(hd_heat_set_rational(heat, 0, NULL, NULL) == HD_OK);
    CHECK(hd_heat_column(heat, HD_KERNEL_OPERATOR, t, 9, w, &rep, NULL) == HD_OK && rep.method == HD_METHOD_LOCAL);
    CHECK(memcmp(u, w, (size_t)lap->n * sizeof *u) == 0);
}

/* A set that is a0 alone: k is a0 B^-1, whose columns go on beyond a ball, and its bound says so. */
static void loc_constant_set(void) {
    const hd_laplacian *lap = kit_pair("flat/72/72/0.3 fem");
    const double t = lap->h * lap->h;
    double *u = KIT_NEW(double, lap->n), *w = KIT_NEW(double, lap->n);
    hd_rational set = {0};
    hd_report rep;
    set.a0 = 3;
    CHECK(hd_heat_column(filt_plan(lap, &set, "method=direct"), HD_KERNEL_SYMMETRIC, t, 9, w, NULL, NULL) >= 0);
    CHECK(hd_heat_column(filt_plan(lap, &set, "method=local"), HD_KERNEL_SYMMETRIC, t, 9, u, &rep, NULL) >= 0 && rep.n_touched < lap->n / 2);
    CHECK_MSG(rep.error_local > 0 && dense_max_diff(u, w, lap->n) <= (rep.error_bound + 1e-14) * dense_max_abs(w, lap->n), "%g", rep.error_local);
}

/* 1/(1 + a lambda)^2, and 1 less that. */
static double loc_square(double lambda, void *user) {
    const double x = 1 + *(const double *)user * lambda;
    return 1 / (x * x);
}

static double loc_high(double lambda, void *user) { return 1 - loc_square(lambda, user); }

/* Answers by the set of a filter on a ball and on all of the mesh: a column of K_t or k_t, a field, its adjoint, entries, or a sparse
 * row, which is a column. Returns the error over its bound, or 0 where that may be rounding. */
static double loc_filter_call(const hd_laplacian *lap, hd_heat *local, hd_heat *whole, int32_t kind, int32_t v, const char *what) {
    const int32_t mark = kit_mark(), n = lap->n, i[3] = {v, (v + 1) % n, (v + n / 2) % n}, j[3] = {v, v, v};
    double *room = KIT_NEW(double, 3 * (int64_t)n), *f = room + 2 * n, size, off, sure;
    hd_report rep[2];
    hd_csr row = {0};
    hd_error e;
    int32_t q, p;
    memset(room, 0, 3 * (size_t)n * sizeof *room);
    f[v] = 1;
    for (q = 0; q < 2; q++) {
        hd_heat *heat = q ? whole : local;
        double *u = room + q * n;
        if (kind < 2) hd_heat_columns(heat, (hd_kernel)kind, 0, NULL, VERTICES(1, &v), u, 0, rep + q, &e);
        else if (kind == 2) hd_heat_apply(heat, 0, NULL, 1, f, 0, u, 0, rep + q, &e);
        else if (kind == 3) hd_heat_adjoint(heat, 0, NULL, 1, f, 0, u, 0, rep + q, &e);
        else if (kind == 4) hd_heat_entries(heat, HD_KERNEL_SYMMETRIC, 0, NULL, 3, i, j, u, rep + q, &e);
        else hd_heat_columns_sparse(heat, HD_KERNEL_SYMMETRIC, 0, NULL, VERTICES(1, &v), &row, rep + q, &e);
        if (!CHECK_MSG(rep[q].status >= 0, "%s: %s", what, e.text)) return 0;
        for (p = 0; kind == 5 && p < row.nnz; p++) u[row.col[p]] = row.val[p];
    }
    hd_csr_free(&row, NULL);
    size = dense_max_abs(room + n, n);
    off = dense_max_diff(room, room + n, n);
    sure = rep[0].error_rounding + rep[1].error_rounding;
    CHECK_MSG(rep[0].method == HD_METHOD_LOCAL && rep[0].solver == HD_SOLVER_AUTO && rep[0].poles == HD_POLES_OWN, "%s", what);
    CHECK_MSG(rep[0].evidence_local == HD_EVIDENCE_PROVEN && rep[0].error_bound >= rep[0].error_local && rep[0].mass_drift == 0, "%s", what);
    CHECK_MSG(off <= (rep[0].error_local + sure) * (size + off) * 1.000001, "%s: error %g, bound %g", what, off / size, rep[0].error_local);
    CHECK_MSG(rep[0].error_local < 1.1e-7 && rep[0].n_touched < n / 2, "%s: bound %g, %d of %d vertices", what, rep[0].error_local,
              (int)rep[0].n_touched, (int)n);
    kit_release(mark);
    return off > 1e-12 * size ? rep[0].error_local / (off / size) : 0;
}

/* Filters on a mesh of which their columns reach a part. Bounds are not far above the errors. */
static void loc_filters(const char *spec, double unit) {
    enum { FILTERS = 5, KINDS = 6 };
    const int32_t mark = kit_mark();
    const hd_laplacian *lap = kit_pair(spec);
    const double t = unit * lap->h * lap->h, square = t / 4;
    hd_filter list[FILTERS] = {{0, HD_FILTER_WAVE, 0, 0.5, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_OWN, 0, 0, loc_square, NULL, 1e-6, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_OWN, 0, 0, loc_high, NULL, 1e-6, 0, 0, 0, 1, 0},
                               {0, HD_FILTER_MEXICAN_HAT, 0, 0, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_HEAT, 0, 0, NULL, NULL, 1e-8, 0, 0, 0, 0, 0}};
    hd_heat *local = kit_heat(lap, "method=local"), *whole = kit_heat(lap, "method=direct");
    double ratio[FILTERS * KINDS], up;
    hd_rational set[2];
    hd_error e;
    int32_t q, kind, n = 0, i;
    char what[96];
    list[0].a = log(4 / t);
    list[1].user = list[2].user = (void *)&square;
    list[3].a = list[4].a = 2 * t;
    for (q = 0; q < FILTERS; q++) {
        CHECK_MSG(hd_rational_fit(set, 1, list + q, lap->lambda_max, NULL, &e) >= 0, "%s", e.text);
        set[1] = *set;                           /* the first counts */
        set[1].a[0].re += 1;
        CHECK(hd_heat_set_rational(local, 2, set, NULL) == HD_OK && hd_heat_set_rational(whole, 1, set, NULL) == HD_OK);
        for (kind = 0; kind < KINDS; kind++) {
            snprintf(what, sizeof what, "%s, filter %d, call %d", spec, (int)q, (int)kind);
            ratio[n] = loc_filter_call(lap, local, whole, kind, lap->n / 7 * (kind + 1) + q, what);
            for (i = n++; i > 0 && ratio[i] < ratio[i - 1]; i--) up = ratio[i], ratio[i] = ratio[i - 1], ratio[i - 1] = up;
        }
    }
    for (q = 0; q < n && ratio[q] == 0;) q++;
    CHECK_MSG(n - q >= n / 3 && ratio[(q + n) / 2] < 300, "%s: %d errors seen, a bound is %g times its error", spec, (int)(n - q),
              q < n ? ratio[(q + n) / 2] : 0);
    kit_release(mark);
}

/* Diagonals and traces of all sets of a plan by patches, which a byte limit makes small, and of all of the mesh. Their difference is
 * what patches leave out, and rounding: no more than is reported. tight: how far above the errors bounds are, or 0 for rounding. */
static double loc_filter_diagonal(const hd_laplacian *lap, hd_kernel kernel, int32_t n_sets, const hd_rational *sets, int32_t n_times,
                                  const double *t, const char *what) {
    const int32_t mark = kit_mark(), n = lap->n, columns = n_sets > 1 ? n_sets : n_times ? n_times : 1;
    double *D = KIT_NEW(double, columns * (int64_t)n), *W = KIT_NEW(double, columns * (int64_t)n), tight = 0;
    double Z[8], Y[8], bound[8], sure[8], value;
    const int32_t own = kit_mark();
    hd_heat *heat = kit_heat(lap, "method=direct");
    hd_context *ctx = lap->context;
    const uint64_t before = ctx->bytes_in_use;
    hd_status status = HD_ERR_MEMORY_LIMIT;
    hd_report rep, all;
    uint64_t need;
    hd_error e;
    int32_t i, q;
    ctx->bytes_peak = before;
    CHECK(hd_heat_set_rational(heat, n_sets, sets, NULL) == HD_OK);
    CHECK_MSG(hd_heat_diagonal(heat, kernel, n_times, t, W, 0, Y, sure, &all, &e) >= 0, "%s: %s", what, e.text);
    kit_release(own);
    need = (ctx->bytes_peak - before) / 10;
    heat = kit_heat(lap, "method=local");
    CHECK(hd_heat_set_rational(heat, n_sets, sets, NULL) == HD_OK);
    for (q = 5; q < 20 && status == HD_ERR_MEMORY_LIMIT; q += 2) {
        ctx->byte_limit = ctx->bytes_in_use + (uint64_t)q * need;
        status = hd_heat_diagonal(heat, kernel, n_times, t, D, 0, Z, bound, &rep, &e);
    }
    ctx->byte_limit = 0;
    if (CHECK_MSG(status >= 0, "%s: %s", what, e.text)) {
        const double size = dense_max_abs(W, columns * (int64_t)n), rest = all.error_rounding + rep.error_rounding;
        CHECK_MSG(rep.method == HD_METHOD_LOCAL && rep.poles == HD_POLES_OWN && rep.n_touched > 0 && rep.n_patches > 1, "%s", what);
        CHECK_MSG(rep.evidence_local == HD_EVIDENCE_MEASURED && rep.error_bound >= rep.error_local && rep.error_local < 1.1e-7,
                  "%s: bound %g, %d of %d rows", what, rep.error_local, (int)rep.n_touched, (int)n);
        for (q = 0; q < columns; q++) {
            const double top = dense_max_abs(W + q * (int64_t)n, n), off = dense_max_diff(D + q * (int64_t)n, W + q * (int64_t)n, n);
            CHECK_MSG(off <= (rep.error_local + rest) * size * 1.000001, "%s, %d: error %g, bound %g", what, (int)q, off / size, rep.error_local);
            if (off > 1e-12 * top) tight = fmax(tight, rep.error_local / (off / size));
            for (i = 0; i < n; i++) {
                const double rest_at = fabs(D[q * (int64_t)n + i] - W[q * (int64_t)n + i]), at = fabs(W[q * (int64_t)n + i]);
                if (!CHECK_MSG(!(rest_at > (rep.error_relative + all.error_relative) * at), "%s, %d, vertex %d", what, (int)q, (int)i)) break;
            }
            CHECK_MSG(fabs(Z[q] - Y[q]) <= bound[q] + sure[q], "%s, %d: trace %g of %g", what, (int)q, Z[q] - Y[q], bound[q]);
        }
        if (n_sets == 1 && n > 768) {            /* entries are of the same */
            int32_t *v = KIT_NEW(int32_t, n / 3);
            double *X = KIT_NEW(double, (n / 3) * (int64_t)columns);
            for (i = 0; i < n / 3; i++) v[i] = 3 * i;
            CHECK(hd_heat_entries(heat, kernel, n_times, t, n / 3, v, v, X, &rep, &e) >= 0 && rep.method == HD_METHOD_LOCAL && rep.n_patches > 0);
            for (i = 0; i < n / 3; i++) {
                value = W[3 * i];
                if (!CHECK_MSG(!(fabs(X[i] - value) > (rep.error_relative + all.error_relative) * fabs(value)), "%s: entry %d", what, (int)i)) break;
            }
        }
    }
    kit_release(mark);
    return tight;
}

/* Filters alone and together, and a set of one's own at two times. */
static void loc_filter_patches(const hd_laplacian *lap, const char *spec, double unit) {
    enum { FILTERS = 5 };
    const int32_t mark = kit_mark();
    const double t = unit * lap->h * lap->h, ts[2] = {t, t / 3};
    double square = t / 4, tight[FILTERS + 1], up;
    hd_filter list[FILTERS] = {{0, HD_FILTER_WAVE, 0, 0.5, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_WAVE, 0, 0.5, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_MEXICAN_HAT, 0, 0, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_OWN, 0, 0, loc_square, NULL, 1e-6, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_OWN, 0, 0, loc_high, NULL, 1e-6, 0, 0, 0, 1, 0}};
    hd_rational set[FILTERS];
    int32_t q, kernel, n = 0, i;
    hd_error e;
    char what[96];
    list[0].a = log(4 / t);
    list[1].a = log(8 / t);
    list[2].a = t;
    list[3].user = list[4].user = (void *)&square;
    for (q = 0; q <= FILTERS; q++) {
        const int together = q == FILTERS;
        kernel = q % 2;
        snprintf(what, sizeof what, "%s, filter %d, kernel %d", spec, (int)q, (int)kernel);
        CHECK_MSG(hd_rational_fit(set, together ? 3 : 1, together ? list : list + q, lap->lambda_max, NULL, &e) >= 0, "%s", e.text);
        tight[n++] = loc_filter_diagonal(lap, (hd_kernel)kernel, together ? 3 : 1, set, 0, NULL, what);
    }
    CHECK(hd_rational_exp(set, HD_POLES_KERNEL, 10, NULL) == HD_OK);
    (void)loc_filter_diagonal(lap, HD_KERNEL_SYMMETRIC, 1, set, 2, ts, spec);
    for (q = 0; q < n; q++)
        for (i = q; i > 0 && tight[i] < tight[i - 1]; i--) up = tight[i], tight[i] = tight[i - 1], tight[i - 1] = up;
    for (q = 0; q < n && tight[q] == 0;) q++;
    CHECK_MSG(n - q >= n / 3 && tight[(q + n - 1) / 2] < 1e4, "%s: %d errors seen, a bound is %g times its error", spec, (int)(n - q),
              q < n ? tight[(q + n - 1) / 2] : 0);
    kit_release(mark);
}

/* Distances by the first of a plan's sets from a vertex and from three, by patches and balls, which a byte limit makes small, and on all
 * of the mesh. Pairs and samples of it too. */
static void loc_filter_distance(const hd_laplacian *lap, const char *plan, hd_distance_kind kind, int32_t n_sets, const hd_rational *sets,
                                int32_t n_times, const double *t, const char *what) {
    enum { FEW = 4 };
    const int32_t mark = kit_mark(), n = lap->n, v[FEW] = {n / 2, n / 3, n / 3 + 1, n / 3 + 2}, columns = n_times > 1 ? 2 * n_times : 2;
    const int64_t first[3] = {0, 1, 4};
    const double weight[4] = {1, 0.5, 0.2, 0.3}, time = n_times ? *t : sets->t;
    double *D = KIT_NEW(double, 2 * columns * (int64_t)n), *W = D + columns * (int64_t)n, d[2][FEW], size, off;
    const int32_t own = kit_mark();
    hd_heat *heat = kit_heat(lap, "method=direct");
    hd_sources sources = hd_vertices(2, v);
    hd_context *ctx = lap->context;
    const uint64_t before = ctx->bytes_in_use;
    hd_status status = HD_ERR_MEMORY_LIMIT;
    hd_report rep, all;
    uint64_t need;
    hd_error e;
    int32_t i, q, far[FEW];
    sources.first = first;
    sources.weight = weight;
    ctx->bytes_peak = before;
    CHECK(hd_heat_set_rational(heat, n_sets, sets, NULL) == HD_OK);
    CHECK_MSG(hd_heat_distance(heat, kind, n_times, t, &sources, W, 0, &all, &e) >= 0, "%s: %s", what, e.text);
    need = (ctx->bytes_peak - before) / 10;
    CHECK(hd_heat_sample(heat, kind, time, NULL, FEW, far, d[1], NULL, NULL) >= 0);
    kit_release(own);
    heat = kit_heat(lap, plan);
    CHECK(hd_heat_set_rational(heat, n_sets, sets, NULL) == HD_OK);
    for (q = 4; q < 20 && status == HD_ERR_MEMORY_LIMIT; q += 2) {
        ctx->byte_limit = ctx->bytes_in_use + (uint64_t)q * need;
        status = hd_heat_distance(heat, kind, n_times, t, &sources, D, 0, &rep, &e);
    }
    if (CHECK_MSG(status >= 0, "%s: %s", what, e.text)) {
        CHECK_MSG(rep.method == HD_METHOD_LOCAL && rep.poles == HD_POLES_OWN && rep.n_patches > 1 && rep.n_touched < n, "%s", what);
        CHECK_MSG(rep.evidence_local == HD_EVIDENCE_MEASURED && rep.error_local > 0 && rep.error_local < 1e-8 && rep.n_lost == all.n_lost, "%s", what);
        for (q = 0; q < columns; q++) {
            size = dense_max_abs(W + q * (int64_t)n, n);
            off = dense_max_diff(D + q * (int64_t)n, W + q * (int64_t)n, n);
            CHECK_MSG(off <= (rep.error_local + rep.error_rounding + all.error_rounding) * size * 1.000001, "%s, column %d: error %g, bound %g", what,
                      (int)q, off / size, rep.error_local);
        }
        ctx->byte_limit += 10 * need;            /* for the balls of other points */
        CHECK(hd_heat_sample(heat, kind, time, NULL, FEW, far, d[0], &rep, NULL) >= 0 && (!*plan || rep.method == HD_METHOD_LOCAL));
        for (i = 1; i < FEW; i++) CHECK_MSG(fabs(d[0][i] - d[1][i]) < 1e-6 * d[1][1], "%s: %g from the others, not %g", what, d[0][i], d[1][i]);
        CHECK(n_times || (hd_heat_distance_pairs(heat, kind, 0, NULL, 3, v + 1, v, d[0], &rep, NULL) >= 0 &&
                           (!*plan || rep.method == HD_METHOD_LOCAL)));
        CHECK_MSG(n_times || fabs(d[0][0] - W[v[1]]) <= rep.error_bound * size, "%s: a pair", what);
    }
    ctx->byte_limit = 0;
    kit_release(mark);
}

static void loc_filter_distances(const char *spec, const char *plan, double unit) {
    enum { FILTERS = 4 };
    const int32_t mark = kit_mark();
    const hd_laplacian *lap = kit_pair(spec);
    const double t = unit * lap->h * lap->h, ts[2] = {t, t / 3};
    double square = t / 4;
    hd_filter list[FILTERS] = {{0, HD_FILTER_WAVE, 0, 0.5, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_WAVE, 0, 0.5, NULL, NULL, 1e-7, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_OWN, 0, 0, loc_square, NULL, 1e-6, 0, 0, 0, 0, 0},
                               {0, HD_FILTER_HEAT, 0, 0, NULL, NULL, 1e-8, 0, 0, 0, 0, 0}};
    hd_rational set[FILTERS];
    int32_t q;
    hd_error e;
    char what[96];
    list[0].a = log(4 / t);
    list[1].a = log(8 / t);
    list[2].user = (void *)&square;
    list[3].a = 2 * t;
    for (q = 0; q < FILTERS; q += q == 0 ? 2 : 1) {      /* the first two together */
        const int32_t count = q == 0 ? 2 : 1;
        snprintf(what, sizeof what, "%s, filter %d", spec, (int)q);
        CHECK_MSG(hd_rational_fit(set, count, list + q, lap->lambda_max, NULL, &e) >= 0, "%s", e.text);
        loc_filter_distance(lap, plan, q < 3 ? HD_DISTANCE_CLASSICAL : HD_DISTANCE_WEIGHTED, count, set, 0, NULL, what);
    }
    CHECK(hd_rational_exp(set, HD_POLES_KERNEL, 10, NULL) == HD_OK);
    loc_filter_distance(lap, plan, HD_DISTANCE_CLASSICAL, 1, set, 2, ts, spec);
    kit_release(mark);
}

/* The same on a path with a full B, or with a diagonal one, against sums over all eigenpairs. */
static void loc_filter_truth(double beside) {
    enum { N = 768 };
    const int32_t mark = kit_mark(), v = N / 3;
    hd_csr L = kit_own_csr(test_path_csr(N, 0)), B = kit_own_csr(test_path_csr(N, 0));
    double *d = KIT_NEW(double, N), *w = KIT_NEW(double, N), *z = KIT_NEW(double, N), square = 0.05;
    hd_filter f[2] = {{0, HD_FILTER_OWN, 0, 0, loc_square, NULL, 1e-7, 0, 0, 0, 0, 0}, {0, HD_FILTER_OWN, 0, 0, loc_high, NULL, 1e-7, 0, 0, 0, 1, 0}};
    hd_laplacian *lap = NULL;
    hd_rational set[2];
    dense_pair pair;
    hd_report rep;
    int64_t p;
    int32_t i, k, q;
    for (i = 0; i < N; i++)
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 1 + 0.5 * (i % 3) : beside;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 1, NULL, NULL) == HD_OK);
    kit_own_laplacian(lap);
    CHECK(dense_pair_solve(&pair, test_dense(&L, NULL), test_dense(&B, NULL), N));
    f[0].user = f[1].user = &square;
    CHECK(hd_rational_fit(set, 1, f, lap->lambda_max, NULL, NULL) >= 0 && hd_rational_fit(set + 1, 1, f + 1, lap->lambda_max, NULL, NULL) >= 0);
    for (q = 0; q < 2; q++) {
        hd_heat *heat = filt_plan(lap, set + q, "method=local");
        hd_context *ctx = &trial_serial;
        hd_status status = HD_ERR_MEMORY_LIMIT;
        memset(w, 0, N * sizeof *w);
        for (k = 0; k < N; k++) {
            const double *x = pair.x + (int64_t)k * N, g = f[q].f(pair.lambda[k], &square);
            dense_apply(pair.B, x, z, N);
            for (i = 0; i < N; i++) w[i] += g * pow(q ? z[i] - z[v] : x[i] - x[v], 2);
        }
        for (i = 0; i < N; i++) w[i] = sqrt(w[i]);
        for (k = 1; k < 60 && status == HD_ERR_MEMORY_LIMIT; k++) {
            ctx->byte_limit = ctx->bytes_in_use + 30000 * (uint64_t)k;
            status = hd_heat_distance(heat, (hd_distance_kind)q, 0, NULL, VERTICES(1, &v), d, 0, &rep, NULL);
        }
        CHECK_MSG(status >= 0 && rep.n_patches > 1 && rep.n_touched < N && rep.error_bound < 1e-4, "%d patches, bound %g", (int)rep.n_patches, rep.error_bound);
        CHECK_MSG(dense_max_diff(d, w, N) <= rep.error_bound * dense_max_abs(d, N), "%g beside, filter %d: %g of %g", beside, (int)q,
                  dense_max_diff(d, w, N) / dense_max_abs(w, N), rep.error_bound);
        ctx->byte_limit = 0;
    }
    dense_pair_free(&pair);
    kit_release(mark);
}

/* Two components, of which patches hold parts or all. */
static void loc_filter_components(void) {
    const shape *large = kit_shape("bumpy/4/1"), *small = kit_shape("flat/60/60/0.3");
    const double offset[3] = {9, 9, 9};
    const shape *s = kit_own(shape_disjoint(large, small, offset));
    hd_laplacian_opts o = {0};
    hd_laplacian *lap = NULL;
    o.kind = HD_LAPLACIAN_VORONOI_COT;
    o.context = &trial_serial;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, NULL) == HD_OK);
    lap = (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
    loc_filter_patches(lap, "two components", 0.1);
}

static void test_local(void) {
    static const struct { const char *spec; int32_t parts; } pairs[] = {
        {"bumpy/4/1 fem", 8}, {"bumpy/4/5 vor", 14}, {"cylinder/8/300 vor", 0}, {"grid/50/4 fem", 3}, {"flat/60/40/0.4 fem+held", 9},
        {"two/3/1/3 fem", 12}, {"cone/40/40 vor", 1}, {"qtorus/60/30 poly", 8}, {"needles/4 fem+id", 3}, {"points/1200/1/1 vexp", 0}};
    size_t i;
    for (i = 0; i < sizeof pairs / sizeof *pairs; i += CASES_FEW ? 4 : 1) loc_pair(pairs[i].spec, pairs[i].parts);
    loc_sparse();
    loc_sparse_twice();
    loc_cut();
    loc_entries();
    loc_auto();
    loc_estimate();
    loc_starved(HD_METHOD_AUTO);
    loc_starved(HD_METHOD_LOCAL);
    loc_retreat();
    loc_lists();
    loc_calls();
    loc_lone();
    loc_full(0.25);
    loc_full(0.3);
    loc_full(0.49);
    loc_inverse();
    loc_uneven();
    if (!CASES_FEW) loc_patches("flat/72/72/0.3 fem", HD_KERNEL_SYMMETRIC, "");
    loc_patches("inert/70/0 fem+held", HD_KERNEL_OPERATOR, "method=local");
    if (!CASES_FEW) loc_patches("bumpy/4/5 vor+id", HD_KERNEL_SYMMETRIC, "method=local");
    if (!CASES_FEW) loc_distances("flat/72/72/0.3 fem", HD_DISTANCE_WEIGHTED, "method=local");
    loc_distances("inert/70/0 vor+held", HD_DISTANCE_CLASSICAL, "method=local");
    if (!CASES_FEW) loc_distances("flat/72/72/0.3 vor", HD_DISTANCE_WEIGHTED, "");
    loc_distance_column("flat/30/30/0.3 vor");
    loc_distance_column("flat/30/30/0.3 fem");
    loc_refused();
    loc_filters("bumpy/5/1 vor", 1);
    if (!CASES_FEW) loc_filters("bumpy/5/1 fem", 0.5);
    loc_filter_patches(kit_pair("flat/72/72/0.3 fem"), "flat/72/72/0.3 fem", 1);
    if (!CASES_FEW) loc_filter_patches(kit_pair("bumpy/5/1 vor"), "bumpy/5/1 vor", 1);
    if (!CASES_FEW) loc_filter_patches(kit_pair("inert/70/0 fem+held"), "inert/70/0 fem+held", 0.5);
    if (!CASES_FEW) loc_filter_distances("flat/72/72/0.3 fem", "method=local", 0.3);
    loc_filter_distances("inert/70/0 vor+held", "", 0.3);
    loc_filter_truth(0.2);
    if (!CASES_FEW) loc_filter_truth(0);
    loc_filter_components();
    loc_own_set();
    loc_constant_set();
}
