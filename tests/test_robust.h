/* test_robust.h - memory that runs out at the k-th allocation, cancelling at the k-th progress call, and limits: for every k,
 * until all goes well; each time the right status, nothing left behind, and outputs as they were */

#ifndef TEST_ROBUST_H
#define TEST_ROBUST_H

/* ---- jobs: each does one thing in a given context, frees what it made, and returns the first error ---- */

static hd_laplacian *const rob_mark_lap = (hd_laplacian *)&test_passed;    /* not a Laplacian: only compared */
static hd_heat *const rob_mark_heat = (hd_heat *)&test_failed;

typedef struct rob_job {
    const char *what;
    hd_status (*run)(hd_context *ctx, int variant);
    int variant;
} rob_job;

static hd_status rob_laplacian_of(hd_context *ctx, hd_laplacian_kind kind, hd_laplacian **out) {
    const double offset[3] = {3, 0, 0};
    shape a = shape_icosphere(0), b = shape_grid(3, 3, 0.2), s = shape_disjoint(&a, &b, offset);
    hd_laplacian_opts o;
    hd_error e;
    hd_status st;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.context = ctx;
    *out = rob_mark_lap;
    st = hd_laplacian_triangles(out, s.xyz, s.n, s.tri, s.n_tri, &o, &e);
    CHECK(e.status == st && (st >= 0) == (*out != rob_mark_lap));
    shape_free(&a);
    shape_free(&b);
    shape_free(&s);
    return st;
}

static hd_status rob_triangles(hd_context *ctx, int variant) {
    hd_laplacian *lap;
    const hd_status st = rob_laplacian_of(ctx, op_kinds[variant], &lap);
    if (st >= 0) hd_laplacian_free(lap);
    return st;
}

/* 0: diagonal B; 1: full B that needs its smallest eigenvalue estimated. */
static hd_status rob_matrices(hd_context *ctx, int variant) {
    hd_csr L = test_path_csr(9, 0), B = variant ? test_path_csr(9, 1) : test_diagonal_csr(9, NULL);
    hd_laplacian_opts o;
    hd_laplacian *lap = rob_mark_lap;
    hd_error e;
    hd_status st;
    int64_t p;
    int32_t i;
    for (i = 0; variant && i < 9; i++)
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 2.001 : 1;
    memset(&o, 0, sizeof o);
    o.context = ctx;
    st = hd_laplacian_matrices(&lap, &L, &B, 0, &o, &e);
    CHECK(e.status == st && (st >= 0) == (lap != rob_mark_lap));
    if (st >= 0) hd_laplacian_free(lap);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    return st;
}

/* 0: create alone; then columns, fields and entries by each solver. */
static hd_status rob_heat(hd_context *ctx, int variant) {
    static const hd_solver solvers[4] = {HD_SOLVER_COCG, HD_SOLVER_COCR, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    hd_laplacian *lap;
    hd_heat *heat = rob_mark_heat;
    hd_heat_opts o;
    hd_report rep;
    hd_error e;
    const int32_t sources[6] = {0, 5, 13, 14, 2, 20};
    double F[21 * 6], U[21 * 6];
    hd_status st = rob_laplacian_of(ctx, variant & 1 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM, &lap);
    const int task = variant / 8;
    int32_t i;
    if (st < 0) return st;
    memset(&o, 0, sizeof o);
    memset(&rep, 0, sizeof rep);
    o.solver = solvers[variant / 2 % 4];
    for (i = 0; i < 21 * 6; i++) F[i] = i % 5;
    st = hd_heat_create(&heat, lap, &o, &e);
    CHECK(e.status == st && (st >= 0) == (heat != rob_mark_heat));
    if (st >= 0) {
        const double t = lap->h * lap->h;
        if (task == 0) st = heat_columns(heat, t, HD_KERNEL_SYMMETRIC, 6, sources, U, 0, &rep);
        if (task == 1) st = heat_apply(heat, t, 6, F, 0, U, 0, &rep);
        if (task == 2) st = heat_entries(heat, t, HD_KERNEL_OPERATOR, 6, sources, sources, U, &rep);
        CHECK(rep.status == st && (st >= 0 || rep.error.status == st));
        hd_heat_free(heat);
    }
    hd_laplacian_free(lap);
    return st;
}

static hd_status rob_solve(hd_context *ctx, int variant) {
    hd_laplacian *lap;
    hd_c64 x[21];
    hd_solve_opts o;
    hd_error e;
    hd_status st = rob_laplacian_of(ctx, HD_LAPLACIAN_FEM, &lap);
    if (st < 0) return st;
    memset(&o, 0, sizeof o);
    memset(x, 0, sizeof x);
    x[4] = test_c(1, -2);
    o.solver = kry_solvers[variant];
    st = hd_shifted_solve(lap, 0.5, test_c(-1, 3), x, x, &o, NULL, &e);
    CHECK(e.status == st);
    hd_laplacian_free(lap);
    return st;
}

static hd_status rob_apply(hd_context *ctx, int variant) {
    hd_laplacian *lap;
    double x[21] = {1}, y[21];
    hd_error e;
    hd_status st = rob_laplacian_of(ctx, HD_LAPLACIAN_FEM, &lap);
    if (st < 0) return st;
    st = hd_laplacian_apply(lap, variant, 2, x, y, &e);
    CHECK(e.status == st);
    hd_laplacian_free(lap);
    return st;
}

static hd_status rob_csr(hd_context *ctx, int variant) {
    hd_csr a = test_path_csr(7, 1), out, before;
    const int32_t perm[7] = {3, 1, 0, 6, 5, 2, 4};
    hd_error e;
    hd_status st = HD_OK;
    memset(&out, 0x6b, sizeof out);
    before = out;
    if (variant == 0) st = hd_csr_from_triplets(&out, 7, 7, 7, perm, perm, a.val, ctx, &e);
    if (variant == 1) st = hd_csr_transpose(&out, &a, ctx, &e);
    if (variant == 2) st = hd_csr_product(&out, &a, &a, ctx, &e);
    if (variant == 3) st = hd_csr_permute(&out, &a, perm, ctx, &e);
    if (variant == 4) st = hd_csr_check(&a, 1, ctx, &e);
    CHECK(e.status == st);
    if (st < 0 || variant == 4) CHECK(memcmp(&out, &before, sizeof out) == 0);
    else hd_csr_free(&out, ctx);
    hd_csr_free(&a, NULL);
    return st;
}

static const rob_job rob_jobs[] = {
    {"triangles fem", rob_triangles, 0}, {"triangles voronoi", rob_triangles, 1}, {"triangles cot", rob_triangles, 2},
    {"matrices", rob_matrices, 0},       {"matrices full", rob_matrices, 1},
    {"columns cocg fem", rob_heat, 0},   {"columns cocg", rob_heat, 1},          {"columns cocr", rob_heat, 2},
    {"columns minres", rob_heat, 4},     {"columns lanczos fem", rob_heat, 6},   {"columns lanczos", rob_heat, 7},
    {"fields cocg fem", rob_heat, 8},    {"fields minres", rob_heat, 13},        {"fields lanczos", rob_heat, 15},
    {"entries cocg", rob_heat, 16},      {"entries lanczos", rob_heat, 23},
    {"solve cocg", rob_solve, 0},        {"solve cocr", rob_solve, 1},           {"solve minres", rob_solve, 2},
    {"apply", rob_apply, 1},
    {"triplets", rob_csr, 0},            {"transpose", rob_csr, 1},              {"product", rob_csr, 2},
    {"permute", rob_csr, 3},             {"check", rob_csr, 4},
    {"points", pts_robust, 0},           {"points exp", pts_robust, 1},          {"nearest", pts_robust, 2},           {"within", pts_robust, 3},
    {"tufted points", pts_robust, 4},
};

enum { ROB_JOBS = sizeof rob_jobs / sizeof *rob_jobs, ROB_MOST = 20000 };

/* ---- memory ---- */

/* Iterations through poles take their preconditioners in turns when there is no memory for all at once. */
static int rob_can_do_with_less(const rob_job *job) { return job->run == rob_heat && job->variant / 2 % 4 != 3; }

static void rob_fail_each_allocation(const rob_job *job) {
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_status st;
    int64_t k;
    int done_with_less = 0;
    for (k = 1; k < ROB_MOST; k++) {
        ctx = test_memory_context(&m);
        m.fail_at = k;
        st = job->run(&ctx, job->variant);
        if (st >= 0 && m.calls >= k && m.live == 0 && rob_can_do_with_less(job) && !done_with_less++) continue;
        if (m.live != 0 || ctx.bytes_in_use != 0 || m.wrong) {
            test_memory_done(&m, &ctx, job->what);
            return;
        }
        if (st >= 0) break;
        if (!CHECK_MSG(st == HD_ERR_MEMORY, "%s: allocation %lld failed, but %s", job->what, (long long)k, hd_status_name(st))) return;
    }
    CHECK_MSG(k > 1 && k < ROB_MOST && m.calls < k, "%s: stopped at %lld", job->what, (long long)k);    /* all were tried */
}

/* Byte limits from nothing upwards. */
static void rob_byte_limits(const rob_job *job) {
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_status st = HD_ERR_MEMORY_LIMIT;
    uint64_t limit, need, least;
    CHECK(job->run(&ctx, job->variant) >= 0);
    need = least = ctx.bytes_peak;
    for (limit = need / 2; limit < need && rob_can_do_with_less(job); limit += 1 + need / 200) {
        ctx = test_memory_context(&m);
        ctx.byte_limit = limit;
        if (job->run(&ctx, job->variant) < 0) continue;
        least = ctx.bytes_peak;
        break;
    }
    CHECK_MSG(!rob_can_do_with_less(job) || least < need, "%s: nothing less than %llu", job->what, (unsigned long long)need);
    for (limit = 1; limit < least; limit += 1 + need / 60) {
        ctx = test_memory_context(&m);
        ctx.byte_limit = limit;
        st = job->run(&ctx, job->variant);
        if (!CHECK_MSG(st == HD_ERR_MEMORY_LIMIT && m.live == 0 && ctx.bytes_in_use == 0 && ctx.bytes_peak <= limit, "%s: limit %llu of %llu: %s", job->what,
                       (unsigned long long)limit, (unsigned long long)need, hd_status_name(st))) return;
    }
    ctx = test_memory_context(&m);
    ctx.byte_limit = need;                       /* exactly enough is enough */
    CHECK_MSG(job->run(&ctx, job->variant) >= 0, "%s: limit of its own peak", job->what);
    need = ctx.allocations;
    for (limit = 1; limit <= need; limit++) {
        ctx = test_memory_context(&m);
        ctx.allocation_limit = limit;
        st = job->run(&ctx, job->variant);
        if (!CHECK_MSG(st == (limit == need ? HD_OK : HD_ERR_MEMORY_LIMIT) && m.live == 0 && ctx.allocations == limit, "%s: %llu of %llu allocations: %s", job->what,
                       (unsigned long long)limit, (unsigned long long)need, hd_status_name(st))) return;
    }
}

/* Small meshes must not pay for large ones: the most bytes in use for a Laplacian and one column on a sphere of 162
 * vertices, which examples/embedded computes on a microcontroller. limit: of the context, 0 none. */
static uint64_t rob_small_peak(hd_laplacian_kind kind, hd_method method, uint64_t limit, double *u) {
    shape s = shape_icosphere(2);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian_opts lap_opts;
    hd_heat_opts heat_opts;
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_error e;
    ctx.simd = HD_SIMD_NONE;
    ctx.byte_limit = limit;
    memset(&lap_opts, 0, sizeof lap_opts);
    memset(&heat_opts, 0, sizeof heat_opts);
    lap_opts.context = &ctx;
    lap_opts.kind = kind;
    heat_opts.method = method;
    if (kind == HD_LAPLACIAN_VORONOI_COT) heat_opts.solver = HD_SOLVER_LANCZOS;
    CHECK(s.n == 162 && hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lap_opts, &e) == HD_OK);
    CHECK(hd_heat_create(&heat, lap, &heat_opts, &e) == HD_OK);
    CHECK_MSG(hd_heat_column(heat, HD_KERNEL_OPERATOR, 10 * lap->h * lap->h, 0, u, NULL, &e) == HD_OK, "%s", e.text);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    CHECK(m.live == 0 && ctx.bytes_in_use == 0);
    shape_free(&s);
    return ctx.bytes_peak;
}

static void rob_small_memory(void) {
    static const struct { hd_laplacian_kind kind; hd_method method; uint64_t most; const char *name; } jobs[4] = {
        {HD_LAPLACIAN_FEM, HD_METHOD_ITERATIVE, 168000, "iterations"},
        {HD_LAPLACIAN_VORONOI_COT, HD_METHOD_ITERATIVE, 98000, "Lanczos"},
        {HD_LAPLACIAN_FEM, HD_METHOD_KRYLOV, 242000, "one real factor"},
        {HD_LAPLACIAN_FEM, HD_METHOD_DIRECT, 652000, "factors of the poles"}};
    double u[162], v[162];
    uint64_t peak;
    int k;
    for (k = 3; k >= 0; k--) {                    /* the last one leaves the u of iterations */
        peak = rob_small_peak(jobs[k].kind, jobs[k].method, 0, u);
        CHECK_MSG(peak <= jobs[k].most, "162 vertices, %s: %llu bytes, at most %llu", jobs[k].name, (unsigned long long)peak,
                  (unsigned long long)jobs[k].most);
    }
    /* with less memory preconditioners are made in turns, and are the same */
    peak = rob_small_peak(HD_LAPLACIAN_FEM, HD_METHOD_ITERATIVE, 128 << 10, v);
    CHECK_MSG(peak <= 126000 && memcmp(u, v, sizeof u) == 0, "162 vertices in 128 KiB: %llu bytes, off by %g", (unsigned long long)peak,
              fabs(u[0] - v[0]));
}

/* ---- cancelling ---- */

typedef struct rob_progress { int64_t calls, stop_at, solving; hd_progress answer; } rob_progress;

static hd_progress rob_on_progress(void *user, const char *stage, double done) {
    rob_progress *p = (rob_progress *)user;
    CHECK(stage && stage[0] && done >= 0 && done <= 1);
    p->solving += strcmp(stage, "solve") == 0;
    return ++p->calls == p->stop_at ? p->answer : HD_PROGRESS_CONTINUE;
}

static void rob_stop_each_progress(const rob_job *job, hd_progress answer, hd_status want) {
    test_memory m;
    hd_context ctx;
    rob_progress p;
    hd_status st;
    int64_t k;
    for (k = 1; k < ROB_MOST; k++) {
        ctx = test_memory_context(&m);
        memset(&p, 0, sizeof p);
        p.stop_at = k;
        p.answer = answer;
        ctx.progress = rob_on_progress;
        ctx.progress_user = &p;
        st = job->run(&ctx, job->variant);
        if (m.live != 0 || ctx.bytes_in_use != 0) test_memory_done(&m, &ctx, job->what);
        if (st >= 0) break;
        if (!CHECK_MSG(st == want, "%s: progress call %lld: %s", job->what, (long long)k, hd_status_name(st))) return;
    }
    CHECK_MSG(k < ROB_MOST && p.calls < k, "%s: stopped at %lld", job->what, (long long)k);
    CHECK_MSG(p.solving > 0 || (job->run != rob_heat && job->run != rob_solve), "%s: progress is not called while solving", job->what);
    CHECK_MSG(k > 1 || job->run == rob_csr || job->run == rob_matrices, "%s: progress is never called", job->what);
}

/* Cancelled among several lanes, also where other workers run: the caller is told of the cancelling, not of its consequences. */
static void rob_cancel_lanes(void) {
    shape s = shape_icosphere(1);
    int64_t calls = 0, k;
    const int32_t sources[4] = {1, 2, 3, 4};
    double U[42 * 4];
    for (k = 1; k < 200; k += 3) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        hd_laplacian_opts lo;
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        hd_report rep;
        rob_progress p;
        hd_status st;
        memset(&lo, 0, sizeof lo);
        memset(&p, 0, sizeof p);
        lo.context = &ctx;
        ctx.parallel_for = sparse_reverse_for;
        ctx.parallel_user = &calls;
        CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) == HD_OK);
        CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
        p.stop_at = k;
        p.answer = HD_PROGRESS_CANCEL;
        ctx.progress = rob_on_progress;
        ctx.progress_user = &p;
        st = heat_columns(heat, 2 * lap->h * lap->h, HD_KERNEL_OPERATOR, 4, sources, U, 0, &rep);
        CHECK_MSG(st == (p.calls >= k ? HD_ERR_CANCELLED : HD_OK), "%s", hd_status_name(st));
        if (st < 0) CHECK_MSG(strstr(rep.error.text, "progress") != NULL, "%s", rep.error.text);
        ctx.progress = NULL;                     /* the plan is as good as before */
        CHECK(heat_columns(heat, 2 * lap->h * lap->h, HD_KERNEL_OPERATOR, 4, sources, U, 0, &rep) == HD_OK);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        test_memory_done(&m, &ctx, "cancelled lanes");
        if (st >= 0) break;
    }
    CHECK(k > 1 && k < 200);
    shape_free(&s);
}

/* A plan that ran out of memory in one call serves the next: in its first call, and in one that needs other preconditioners. */
static void rob_plan_survives(void) {
    shape s = shape_icosphere(0);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    double want[12], u[12];
    int64_t k;
    int q;
    memset(&lo, 0, sizeof lo);
    lo.context = &ctx;
    CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) == HD_OK);
    for (q = 0; q < 2; q++) {
        for (k = 0; k < 100; k++) {
            hd_heat *heat = heat_plan(lap, HD_SOLVER_AUTO, HD_POLES_DEFAULT, 0, 0);
            hd_status st = HD_OK;
            if (q) CHECK(heat_column(heat, 0.2, 2, u, NULL) >= 0);
            m.fail_at = k ? m.calls + k : 0;
            if (k) st = q ? heat_column(heat, 0.7, 3, u, NULL) : heat_apply(heat, 0.3, 1, want, 0, u, 0, NULL);
            m.fail_at = 0;
            CHECK(heat_column(heat, 0.7, 2, k ? u : want, NULL) >= 0);
            CHECK(k == 0 || memcmp(u, want, sizeof u) == 0);
            hd_heat_free(heat);
            if (k && st >= 0) break;
            CHECK(k == 0 || st == HD_ERR_MEMORY);
        }
        CHECK(k < 100 && (q || k > 1));
    }
    hd_laplacian_free(lap);
    test_memory_done(&m, &ctx, "plan");
    shape_free(&s);
}

/* Options that nobody cleared, by all functions that take some: an error, whatever their context points to. */
static void rob_not_cleared(void) {
    shape s = shape_icosphere(0);
    hd_laplacian *lap = test_laplacian(&s, HD_LAPLACIAN_FEM), *made = rob_mark_lap;
    hd_csr L = test_path_csr(4, 0), B = test_diagonal_csr(4, NULL);
    const int64_t face_ptr[2] = {0, 3};
    hd_laplacian_opts lo;
    hd_solve_opts so;
    hd_ldl_opts fo;
    hd_heat_opts ho;
    hd_geodesic_opts go;
    hd_heat *heat = rob_mark_heat;
    hd_geodesic *g = NULL;
    hd_ldl *f = NULL;
    hd_c64 x[12];
    hd_error e;
    int k;
    memset(x, 0, sizeof x);
#define ROB_NOT_CLEARED(call) \
    CHECK((call) == HD_ERR_ARGUMENT && e.status == HD_ERR_ARGUMENT && strstr(e.text, "not cleared") && made == rob_mark_lap && heat == rob_mark_heat && !g && !f)
    for (k = 0; k < 3; k++) {                    /* rubbish everywhere; all but the first word; all but the last */
        memset(&lo, 0xa5, sizeof lo);
        memset(&so, 0xa5, sizeof so);
        memset(&fo, 0xa5, sizeof fo);
        memset(&ho, 0xa5, sizeof ho);
        memset(&go, 0xa5, sizeof go);
        if (k == 1) lo.begin_zero = so.begin_zero = fo.begin_zero = ho.begin_zero = go.begin_zero = 0;
        if (k == 2) lo.end_zero = so.end_zero = fo.end_zero = ho.end_zero = go.end_zero = 0;
        ROB_NOT_CLEARED(hd_laplacian_triangles(&made, s.xyz, s.n, s.tri, s.n_tri, &lo, &e));
        ROB_NOT_CLEARED(hd_laplacian_polygons(&made, s.xyz, s.n, face_ptr, s.tri, 1, &lo, &e));
        ROB_NOT_CLEARED(hd_laplacian_points(&made, s.xyz, s.n, &lo, &e));
        ROB_NOT_CLEARED(hd_laplacian_tufted_points(&made, s.xyz, s.n, NULL, NULL, &lo, &e));
        ROB_NOT_CLEARED(hd_laplacian_matrices(&made, &L, &B, 0, &lo, &e));
        ROB_NOT_CLEARED(hd_shifted_solve(lap, 1, test_c(1, 1), x, x, &so, NULL, &e));
        ROB_NOT_CLEARED(hd_ldl_analyse(&f, &L, &fo, NULL, &e));
        ROB_NOT_CLEARED(hd_heat_create(&heat, lap, &ho, &e));
        ROB_NOT_CLEARED(hd_geodesic_create(&g, s.xyz, s.n, s.tri, s.n_tri, &go, &e));
        ROB_NOT_CLEARED(hd_geodesic_create_polygons(&g, s.xyz, s.n, face_ptr, s.tri, 1, &go, &e));
        ROB_NOT_CLEARED(hd_geodesic_create_points(&g, s.xyz, s.n, NULL, NULL, &go, &e));
    }
#undef ROB_NOT_CLEARED
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* Patterns without entries, over no arrays at all: nothing is read from them, nor copied (which a sanitizer sees). */
static void rob_nothing(void) {
    static const hd_ordering orderings[4] = {HD_ORDERING_AUTO, HD_ORDERING_MINIMUM_DEGREE, HD_ORDERING_NESTED_DISSECTION, HD_ORDERING_OWN};
    const int32_t perm[2] = {1, 0};
    const double xyz[6] = {0, 0, 0, 1, 0, 0};
    int64_t ptr[3] = {0, 0, 0};
    hd_csr none, out;
    hd_ldl_opts o;
    hd_error e;
    int32_t n;
    int k;
    memset(&none, 0, sizeof none);
    none.row_ptr = ptr;
    for (n = 0; n < 3; n += 2) {
        none.n_rows = none.n_cols = n;
        CHECK(hd_csr_check(&none, 1, NULL, &e) == HD_OK);
        CHECK(hd_csr_transpose(&out, &none, NULL, &e) == HD_OK);
        hd_csr_free(&out, NULL);
        CHECK(hd_csr_permute(&out, &none, n ? perm : NULL, NULL, &e) == HD_OK);
        hd_csr_free(&out, NULL);
        CHECK(hd_csr_product(&out, &none, &none, NULL, &e) == HD_OK);
        hd_csr_free(&out, NULL);
        for (k = 0; k < 4; k++) {
            hd_ldl *f = NULL;
            memset(&o, 0, sizeof o);
            o.ordering = orderings[k];
            o.xyz = n ? xyz : NULL;
            o.perm = n ? perm : NULL;
            if (hd_ldl_analyse(&f, &none, &o, NULL, &e) < 0) {
                CHECK(n == 0 && k >= 2 && e.status == HD_ERR_ARGUMENT);     /* nothing was given that these two ask for */
                continue;
            }
            CHECK(hd_ldl_factor(f, NULL, NULL, &e) == (n ? HD_ERR_BREAKDOWN : HD_OK));
            CHECK(hd_ldl_factor_complex(f, 5, NULL, NULL, &e) == (n ? HD_ERR_BREAKDOWN : HD_OK));
            if (n == 0) CHECK(hd_ldl_solve_complex(f, NULL, 0, NULL, 0, &e) == HD_OK);
            hd_ldl_free(f);
        }
    }
}

/* ---- with floating-point traps on ---- */

#if defined(__GLIBC__) && (defined(__x86_64__) || defined(__i386__)) && !defined(__clang__)   /* clang divides first and chooses then */
#define ROB_TRAPS 1
#include <fenv.h>
#include <setjmp.h>
#include <signal.h>
extern int feenableexcept(int excepts);
extern int fedisableexcept(int excepts);

static jmp_buf rob_trapped;

static void rob_on_trap(int sig) {
    (void)sig;
    longjmp(rob_trapped, 1);
}

static void rob_trap_laplacian(hd_laplacian *lap, hd_context *ctx, const char **at) {
    static const hd_method methods[4] = {HD_METHOD_AUTO, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT, HD_METHOD_KRYLOV};
    const int32_t sources[3] = {0, 7, 9};
    double *u = DENSE_NEW(double, 20 * lap->n), *f = DENSE_NEW(double, 3 * lap->n);
    const double t = lap->h > 0 ? 20 * lap->h * lap->h : 2, times[3] = {t, 5 * t, 1e6 * t};
    int32_t v;
    int m, k;
    for (v = 0; v < lap->n; v++) f[v] = v % 5 - 1;           /* the second field is zero, the third constant */
    for (v = 0; v < lap->n; v++) f[2 * lap->n + v] = 2;
    for (m = 0; m < 4; m++) {
        hd_heat_opts o;
        hd_heat *heat = NULL;
        memset(&o, 0, sizeof o);
        o.method = methods[m];
        o.context = ctx;
        if (hd_heat_create(&heat, lap, &o, NULL) < 0) continue;
        *at = "columns";
        (void)heat_columns(heat, t, HD_KERNEL_OPERATOR, 3, sources, u, 0, NULL);
        (void)heat_column(heat, 0, 3, u, NULL);
        *at = "fields";
        (void)heat_apply(heat, t, 3, f, 0, u, 0, NULL);
        (void)heat_apply(heat, t, 1, f + lap->n, 0, u, 0, NULL);
        *at = "times";
        (void)heat_times(heat, 3, times, HD_KERNEL_SYMMETRIC, 3, NULL, u, 0, NULL);
        *at = "diagonal";
        (void)heat_diagonal(heat, 3, times, HD_KERNEL_SYMMETRIC, u, 0, NULL);
        *at = "distances";
        for (k = 0; k < 4; k++) (void)heat_distance(heat, (hd_distance_kind)k, 1, &t, 2, sources, u, 0, NULL);
        hd_heat_free(heat);
    }
    free(u);
    free(f);
}

static void rob_trap_geodesic(const shape *s, hd_context *ctx) {
    const int32_t sources[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    hd_geodesic_opts o;
    hd_geodesic *g = NULL;
    hd_geodesic_report rep;
    double *d = DENSE_NEW(double, 9 * s->n);
    memset(&o, 0, sizeof o);
    o.context = ctx;
    if (CHECK(hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, &o, NULL) >= 0)) {
        (void)hd_geodesic_distance(g, 1, sources + 3, d, &rep, NULL);
        (void)hd_geodesic_distance_each(g, 9, sources, d, 0, &rep, NULL);
    }
    hd_geodesic_free(g);
    free(d);
}

/* Matrices with zero pivots, of all sizes of the kernels' blocks. */
static void rob_trap_pivots(hd_context *ctx) {
    enum { N = 40 };
    int32_t i[N * N], j[N * N], n, zero;
    double v[N * N];
    hd_c64 z[N * N];
    int64_t c, p;
    for (n = 1; n <= N; n += 3) {
        hd_csr a;
        hd_ldl_opts o;
        hd_ldl *f = NULL;
        hd_error e;
        memset(&o, 0, sizeof o);
        o.context = ctx;
        c = 0;
        for (p = 0; p < (int64_t)n * n; p++) {
            i[c] = (int32_t)(p / n);
            j[c] = (int32_t)(p % n);
            v[c++] = i[p] == j[p] ? n : 1;
        }
        CHECK(hd_csr_from_triplets(&a, n, n, c, i, j, v, NULL, NULL) == HD_OK && hd_ldl_analyse(&f, &a, &o, NULL, NULL) == HD_OK);
        for (zero = 0; zero < n; zero += 2) {
            for (p = 0; p < a.nnz; p++) {        /* row and column of zeros */
                const int32_t row = (int32_t)(p / n), column = (int32_t)(p % n);
                v[p] = row == zero || column == zero ? 0 : row == column ? n : 1;
                z[p] = test_c(v[p], v[p] / 2);
            }
            CHECK(hd_ldl_factor(f, v, NULL, &e) == HD_ERR_BREAKDOWN && e.row == zero && e.value == 0);
            CHECK(hd_ldl_factor_complex(f, 1, z, NULL, &e) == HD_ERR_BREAKDOWN && e.row == zero && e.value == 0);
        }
        hd_ldl_free(f);
        hd_csr_free(&a, NULL);
    }
}

/* Bad input is told as ever: no check compares numbers that are none. */
static void rob_trap_bad_input(const shape *s, const hd_laplacian *lap) {
    const double bad[2] = {(double)NAN, (double)INFINITY};
    const double keep = s->xyz[3];
    const int32_t i[2] = {0, 1};
    double v[2] = {1, 2};
    hd_laplacian *none = NULL;
    hd_geodesic *g = NULL;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_csr a;
    double *u = DENSE_NEW(double, s->n);
    int q;
    CHECK(hd_heat_create(&heat, lap, NULL, NULL) == HD_OK);
    memset(&o, 0, sizeof o);
    for (q = 0; q < 2; q++) {
        s->xyz[3] = bad[q];
        CHECK(hd_laplacian_triangles(&none, s->xyz, s->n, s->tri, s->n_tri, NULL, NULL) == HD_ERR_NOT_FINITE);
        CHECK(hd_laplacian_points(&none, s->xyz, s->n, NULL, NULL) == HD_ERR_NOT_FINITE);
        CHECK(hd_geodesic_create(&g, s->xyz, s->n, s->tri, s->n_tri, NULL, NULL) == HD_ERR_NOT_FINITE);
        s->xyz[3] = keep;
        v[1] = bad[q];
        CHECK(hd_csr_from_triplets(&a, 2, 2, 2, i, i, v, NULL, NULL) == HD_ERR_NOT_FINITE);
        u[2] = bad[q];
        CHECK(heat_apply(heat, 1, 1, u, 0, u, 0, NULL) == HD_ERR_NOT_FINITE);
        u[2] = 0;
        CHECK(heat_column(heat, bad[q], 0, u, NULL) == HD_ERR_ARGUMENT);
        CHECK(heat_diagonal(heat, 1, bad + q, HD_KERNEL_SYMMETRIC, u, 0, NULL) == HD_ERR_ARGUMENT);
        CHECK(heat_times(heat, 1, bad + q, HD_KERNEL_SYMMETRIC, 0, NULL, u, 0, NULL) == HD_ERR_ARGUMENT);
        CHECK(heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, bad + q, 1, i, u, 0, NULL) == HD_ERR_ARGUMENT);
        o.tol = bad[q];
        CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_ERR_ARGUMENT);
        if (q == 0) CHECK(hd_neighbours_radius(&a, s->xyz, s->n, NULL, 0, bad[q], NULL, NULL) == HD_ERR_ARGUMENT);
        if (q == 1 && CHECK(hd_neighbours_radius(&a, s->xyz, s->n, NULL, 0, bad[q], NULL, NULL) == HD_OK)) {
            CHECK(a.nnz == (int64_t)s->n * s->n);
            hd_csr_free(&a, NULL);
        }
    }
    hd_heat_free(heat);
    free(u);
}

/* Programs that stop at the first division by zero, overflow or invalid operation can use the library on ordinary input, faces without area and zero
 * pivots among it. */
static void rob_traps(void) {
    static const hd_simd simds[3] = {HD_SIMD_AUTO, HD_SIMD_NONE, HD_SIMD_AVX2};
    const double offset[3] = {5, 0, 0};
    shape ball = shape_bumpy(2, 5), grid = shape_grid(9, 8, 0.3), s = shape_disjoint(&ball, &grid, offset);
    hd_laplacian *lap = NULL;
    hd_laplacian_opts lo;
    hd_context ctx;
    const char *volatile stage = "";
    const char *at = "";
    void (*before)(int) = signal(SIGFPE, rob_on_trap);
    volatile int k = 0, q = 0;
    int32_t f;
    for (f = 0; f < s.n_tri; f += 23) s.tri[3 * f + 1] = s.tri[3 * f];               /* a corner twice */
    for (f = 5; f < s.n_tri; f += 41) memcpy(s.xyz + 3 * s.tri[3 * f], s.xyz + 3 * s.tri[3 * f + 1], 3 * sizeof(double));    /* two places the same */
    memcpy(s.xyz + 3, s.xyz, 3 * sizeof(double));
    if (setjmp(rob_trapped)) {
        fedisableexcept(FE_ALL_EXCEPT);
        CHECK_MSG(0, "trapped: %s, kind %d, instruction set %d, %s", stage, q, k, at);
        signal(SIGFPE, before);
        return;
    }
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
    memset(&ctx, 0, sizeof ctx);
    memset(&lo, 0, sizeof lo);
    lo.context = &ctx;
    for (k = 0; k < 3; k++) {
        ctx.simd = simds[k];
        for (q = 0; q < 5; q++) {
            stage = "triangles";
            lo.kind = op_kinds[q % 3];
            lo.intrinsic_delaunay = q == 3;
            lo.tufted = q == 4;
            if (CHECK(hd_laplacian_triangles(&lap, s.xyz, s.n, s.tri, s.n_tri, &lo, NULL) >= 0)) {
                rob_trap_laplacian(lap, &ctx, &at);
                hd_laplacian_free(lap);
            }
        }
        lo.kind = HD_LAPLACIAN_DEFAULT;
        lo.tufted = 0;
        stage = "points";
        if (CHECK(hd_laplacian_points(&lap, s.xyz, s.n, &lo, NULL) >= 0)) {
            rob_trap_laplacian(lap, &ctx, &at);
            hd_laplacian_free(lap);
        }
        stage = "tufted points";
        if (CHECK(hd_laplacian_tufted_points(&lap, s.xyz, s.n, NULL, NULL, &lo, NULL) >= 0)) {
            rob_trap_laplacian(lap, &ctx, &at);
            hd_laplacian_free(lap);
        }
        at = "";
        stage = "geodesic";
        rob_trap_geodesic(&s, &ctx);
        stage = "pivots";
        rob_trap_pivots(&ctx);
    }
    stage = "bad input";
    lap = test_laplacian(&ball, HD_LAPLACIAN_FEM);
    rob_trap_bad_input(&ball, lap);
    fedisableexcept(FE_ALL_EXCEPT);
    signal(SIGFPE, before);
    hd_laplacian_free(lap);
    shape_free(&ball);
    shape_free(&grid);
    shape_free(&s);
}
#endif

static void test_robust(void) {
    int k;
    for (k = 0; k < ROB_JOBS; k++) {
        rob_fail_each_allocation(rob_jobs + k);
        rob_byte_limits(rob_jobs + k);
        rob_stop_each_progress(rob_jobs + k, HD_PROGRESS_CANCEL, HD_ERR_CANCELLED);
        rob_stop_each_progress(rob_jobs + k, (hd_progress)1, HD_ERR_ARGUMENT);
        rob_stop_each_progress(rob_jobs + k, (hd_progress)0, HD_ERR_ARGUMENT);
    }
    rob_small_memory();
    rob_cancel_lanes();
    rob_plan_survives();
    rob_not_cleared();
    rob_nothing();
#ifdef ROB_TRAPS
    rob_traps();
#endif
}

#endif
