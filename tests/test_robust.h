/* test_robust.h - calls from nothing, with memory that runs out at the k-th allocation, cancelled at the k-th progress call, and
 * with limits: for every k, until all goes well; each time the right status, nothing left behind, and outputs as they were.
 * The first part is for jobs of other groups, too. */

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

/* What a script may do: under a limit it must or may go on with less; it solves; it reports no progress. */
enum { ROB_MUST = 1, ROB_MAY = 2, ROB_SOLVES = 4, ROB_QUIET = 8, ROB_MOST = 20000 };

static const struct { const char *script; int flags; } rob_scripts[] = {
    {"triangles", 0}, {"voronoi triangles", 0}, {"cot triangles", 0}, {"matrices", ROB_QUIET}, {"b=whole matrices", ROB_QUIET},
    {"cocg k=6 columns", ROB_MUST | ROB_SOLVES}, {"cocg voronoi k=6 columns", ROB_MUST | ROB_SOLVES},
    {"minres k=6 columns", ROB_MUST | ROB_SOLVES},
    {"lanczos k=6 columns", ROB_SOLVES}, {"lanczos voronoi k=6 columns", ROB_SOLVES}, {"cocg k=6 apply", ROB_MUST | ROB_SOLVES},
    {"minres voronoi k=6 apply", ROB_MUST | ROB_SOLVES}, {"lanczos voronoi k=6 apply", ROB_SOLVES},
    {"cocg operator entries", ROB_MUST | ROB_SOLVES}, {"lanczos voronoi operator entries", ROB_SOLVES},
    {"cocg time=0.5 shifted", ROB_SOLVES}, {"minres time=0.5 shifted", ROB_SOLVES},
    {"points", 0}, {"exp points", 0}, {"queries=moved n_queries=7 nearest", 0},
    {"tufted_points", 0}, {"delaunay triangles", 0}, {"dissection solve", 0}, {"own solve_c", 0},
    {"factor_c solve_c factor | solve", 0}, {"mean geodesic | geodesic_each", 0}, {"tufted geodesic | geodesic_each", 0},
    {"krylov k=6 columns", 0}, {"krylov voronoi k=6 apply", 0}, {"krylov n_times=3 columns", 0}, {"direct voronoi k=6 apply", ROB_MAY},
    {"direct dissection k=6 columns", 0}, {"direct n_times=3 columns", ROB_MAY}, {"krylov dissection operator entries", 0},
    {"geodesic_points | geodesic_each", 0}, {"geodesic_polygons | geodesic_set", 0},
};

enum { ROB_SCRIPTS = sizeof rob_scripts / sizeof *rob_scripts };

static call_data rob_data;

/* A script from nothing: first of the list, then each call alone, by the direct method. */
static const char *rob_words(int variant, char text[80]) {
    if (variant < ROB_SCRIPTS) return rob_scripts[variant].script;
    snprintf(text, 80, "direct %s", call_table[variant - ROB_SCRIPTS].name);
    return text;
}

static hd_status rob_script(hd_context *ctx, int variant) {
    static call_world w;
    char text[80];
    const char *script = rob_words(variant, text);
    hd_status st;
    call_open(&w, &rob_data, ctx);
    w.what = script;
    st = call_prepare(&w, script);
    if (st >= 0) st = call_test(&w, script);
    call_close(&w);
    return st;
}

static int rob_is(const rob_job *job, int flag) {
    if (job->run != rob_script) return 0;
    return ((job->variant < ROB_SCRIPTS ? rob_scripts[job->variant].flags : ROB_MAY | ROB_QUIET) & flag) != 0;
}

/* ---- memory ---- */

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
        if (st >= 0 && m.calls >= k && m.live == 0 && rob_is(job, ROB_MUST) && !done_with_less++) continue;
        if (m.live != 0 || ctx.bytes_in_use != 0 || m.wrong) {
            test_memory_done(&m, &ctx, job->what);
            return;
        }
        if (st >= 0) break;
        CHECK_MSG(st == HD_ERR_MEMORY, "%s: allocation %lld failed, but %s", job->what, (long long)k, hd_status_name(st));
        if (st != HD_ERR_MEMORY) return;
    }
    CHECK_MSG(k < ROB_MOST && m.calls < k && (k > 1 || rob_is(job, ROB_QUIET)), "%s: stopped at %lld", job->what, (long long)k);
}

/* Byte limits from nothing upwards. */
static void rob_byte_limits(const rob_job *job) {
    const int goes_on = rob_is(job, ROB_MUST | ROB_MAY);
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_status st = HD_ERR_MEMORY_LIMIT;
    uint64_t limit, need, least;
    CHECK(job->run(&ctx, job->variant) >= 0);
    need = least = ctx.bytes_peak;
    for (limit = need / 2; limit < need && goes_on; limit += 1 + need / 200) {
        ctx = test_memory_context(&m);
        ctx.byte_limit = limit;
        if (job->run(&ctx, job->variant) < 0) continue;
        least = ctx.bytes_peak;
        break;
    }
    CHECK_MSG(!rob_is(job, ROB_MUST) || least < need, "%s: nothing less than %llu", job->what, (unsigned long long)need);
    for (limit = 1; limit < least; limit += 1 + need / 60) {
        ctx = test_memory_context(&m);
        ctx.byte_limit = limit;
        st = job->run(&ctx, job->variant);
        if (!CHECK_MSG((st == HD_ERR_MEMORY_LIMIT || (st >= 0 && goes_on)) && m.live == 0 && ctx.bytes_in_use == 0 &&
                           ctx.bytes_peak <= limit, "%s: limit %llu of %llu: %s", job->what, (unsigned long long)limit,
                       (unsigned long long)need, hd_status_name(st))) return;
    }
    ctx = test_memory_context(&m);
    ctx.byte_limit = need;                       /* exactly enough is enough */
    CHECK_MSG(job->run(&ctx, job->variant) >= 0, "%s: limit of its own peak", job->what);
    need = ctx.allocations;
    for (limit = 1; limit <= need; limit++) {
        ctx = test_memory_context(&m);
        ctx.allocation_limit = limit;
        st = job->run(&ctx, job->variant);
        if (!CHECK_MSG((limit == need ? st >= 0 : st == HD_ERR_MEMORY_LIMIT) && m.live == 0 && ctx.allocations == limit,
                       "%s: %llu of %llu allocations: %s", job->what, (unsigned long long)limit, (unsigned long long)need,
                       hd_status_name(st))) return;
    }
}

/* Small meshes must not pay for large ones: the most bytes in use for a Laplacian and one column on a sphere of 162
 * vertices, which examples/embedded computes on a microcontroller. limit: of the context, 0 none. */
static uint64_t rob_small_peak(hd_laplacian_kind kind, hd_method method, uint64_t limit, double *u) {
    shape s = kit_own_shape(shape_icosphere(2));
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
    CHECK(s.n == 162 && hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &lap_opts, &e) == HD_OK);
    CHECK(hd_heat_create(&heat, lap, &heat_opts, &e) == HD_OK);
    CHECK_MSG(hd_heat_column(heat, HD_KERNEL_OPERATOR, 10 * lap->h * lap->h, 0, u, NULL, &e) == HD_OK, "%s", e.text);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    CHECK(m.live == 0 && ctx.bytes_in_use == 0);
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
    CHECK_MSG(peak <= 126000 && memcmp(u, v, sizeof u) == 0, "162 vertices in 128 KiB: %llu bytes, off by %g",
              (unsigned long long)peak, fabs(u[0] - v[0]));
}

/* ---- cancelling ---- */

static void rob_stop_each_progress(const rob_job *job, hd_progress answer, hd_status want) {
    test_memory m;
    hd_context ctx;
    rob_progress p;
    hd_status st;
    int64_t k;
    for (k = 1; k < ROB_MOST; k++) {
        ctx = test_memory_context(&m);
        rob_watch(&p, &ctx, k);
        p.answer = answer;
        st = job->run(&ctx, job->variant);
        if (m.live != 0 || ctx.bytes_in_use != 0) test_memory_done(&m, &ctx, job->what);
        if (st >= 0) break;
        if (!CHECK_MSG(st == want, "%s: progress call %lld: %s", job->what, (long long)k, hd_status_name(st))) return;
    }
    CHECK_MSG(k < ROB_MOST && p.calls < k, "%s: stopped at %lld", job->what, (long long)k);
    CHECK_MSG(p.solving > 0 || !rob_is(job, ROB_SOLVES), "%s: progress is not called while solving", job->what);
    CHECK_MSG(k > 1 || rob_is(job, ROB_QUIET), "%s: progress is never called", job->what);
}

/* Cancelled among several lanes, also where other workers run: the caller is told of the cancelling, not of its consequences. */
static void rob_cancel_lanes(void) {
    call_world w;
    call_data d;
    int64_t calls_of = 0, k;
    hd_status st = HD_ERR_CANCELLED;
    memset(&w, 0, sizeof w);
    call_data_make(&d, shape_icosphere(3));
    for (k = 1; k < 200 && st == HD_ERR_CANCELLED; k += 3) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        rob_progress p;
        ctx.parallel_for = sparse_reverse_for;
        ctx.parallel_user = &calls_of;
        call_open(&w, &d, &ctx);
        w.what = "cancelled lanes";
        CHECK(call_prepare(&w, "k=4 operator columns") == HD_OK);
        rob_watch(&p, &ctx, k);
        st = call_test(&w, "columns");
        CHECK_MSG(st == (p.calls >= k ? HD_ERR_CANCELLED : HD_OK), "%s", hd_status_name(st));
        if (st < 0) CHECK_MSG(strstr(w.rep.error.text, "progress") != NULL, "%s", w.rep.error.text);
        ctx.progress = NULL;                     /* the plan is as good as before */
        CHECK(call_test(&w, "columns") == HD_OK);
        call_close(&w);
        test_memory_done(&m, &ctx, w.what);
    }
    CHECK_MSG(k > 4 && k < 200 && calls_of > 0, "%d cancelled, %d loops", (int)k, (int)calls_of);
    call_world_free(&w);
    call_data_free(&d);
}

/* A plan that ran out of memory in one call serves another: after its first call, and after one that needs other
 * preconditioners. */
static void rob_plan_survives(void) {
    static const char *const before[2] = {"lap_apply", "t=zero column"}, *const fails[2] = {"t=late k=1 apply", "time=2 column"};
    call_world w;
    call_data d;
    double *want;
    int q;
    memset(&w, 0, sizeof w);
    call_data_make(&d, call_pair_of_shapes());
    for (q = 0, want = NULL; q < 2; q++) {
        hd_status st = HD_ERR_MEMORY;
        int64_t k;
        for (k = 0; k < 100 && st == HD_ERR_MEMORY; k++) {
            test_memory m;
            hd_context ctx = test_memory_context(&m);
            call_open(&w, &d, &ctx);
            w.what = fails[q];
            CHECK(call_words(&w, "iterative operator plan", 1) == HD_OK && call_words(&w, before[q], 1) >= 0);
            m.fail_at = k ? m.calls + k : 0;
            if (k) st = call_words(&w, fails[q], 0);
            m.fail_at = 0;
            CHECK(call_words(&w, "time=0.7 source=2 column", 0) >= 0);
            if (!want) memcpy(want = (double *)dense_alloc((int64_t)w.out_size, 1), w.out, w.out_size);
            CHECK_MSG(memcmp(want, w.out, w.out_size) == 0, "%s, allocation %d", w.what, (int)k);
            call_close(&w);
            test_memory_done(&m, &ctx, w.what);
        }
        CHECK_MSG(st >= 0 && k > (q ? 1 : 2), "%s: %s after %d", fails[q], hd_status_name(st), (int)k);
    }
    free(want);
    call_world_free(&w);
    call_data_free(&d);
}

/* Patterns without entries, over no arrays at all: nothing is read from them, nor copied (which a sanitizer sees). */
static void rob_nothing(void) {
    static const hd_ordering orderings[4] = {HD_ORDERING_AUTO, HD_ORDERING_MINIMUM_DEGREE, HD_ORDERING_NESTED_DISSECTION,
                                             HD_ORDERING_OWN};
    const int32_t perm[2] = {1, 0};
    const double xyz[6] = {0, 0, 0, 1, 0, 0};
    int64_t ptr[3] = {0, 0, 0};
    hd_csr none;
    hd_ldl_opts o;
    hd_error e;
    int32_t n;
    int k;
    memset(&none, 0, sizeof none);
    none.row_ptr = ptr;
    for (n = 0; n < 3; n += 2) {
        none.n_rows = none.n_cols = n;
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

/* Not with clang, which divides first and chooses then. */
#if defined(__GLIBC__) && (defined(__x86_64__) || defined(__i386__)) && !defined(__clang__)
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

/* Everything of one mesh by one set of kernels; statuses are as they come. stage: what goes on. */
static void rob_trap_calls(const call_data *d, hd_context *ctx, const char *volatile *stage) {
    static const char *const laplacians[7] = {"triangles", "voronoi triangles", "cot triangles", "delaunay triangles",
                                              "tufted triangles", "points", "tufted_points"};
    static const char *const methods[4] = {"auto plan", "iterative plan", "direct plan", "krylov plan"};
    static const char *const asked[8] = {"operator columns", "time=0 operator column", "apply", "n_times=3 t=late columns",
                                         "n_times=3 t=late diagonal", "distance", "weighted distance", "commute distance"};
    static const char *const others[3] = {"geodesic k=1 geodesic_set", "geodesic k=6 geodesic_each", "biharmonic distance"};
    static call_world w;
    double *f = KIT_NEW(double, 3 * d->s.n);   /* the second field is zero, the third constant */
    int32_t i;
    int q, m, k;
    for (i = 0; i < d->s.n; i++) f[i] = i % 5 - 1;
    for (i = 0; i < d->s.n; i++) f[2 * d->s.n + i] = 2;
    for (q = 0; q < 7; q++)
        for (m = 0; m < 4; m++) {
            call_open(&w, d, ctx);
            w.what = *stage = laplacians[q];
            w.a.f = f;
            CHECK(call_words(&w, laplacians[q], 1) >= 0);
            if (call_words(&w, methods[m], 1) < 0) continue;
            for (k = 0; k < 8; k++) {
                w.a.n_times = 1;
                w.a.t = d->t;
                w.what = *stage = asked[k];
                (void)call_words(&w, asked[k], 0);
            }
            for (k = 0; k < 3 && q == 0; k++) (void)call_words(&w, *stage = others[k], 1);
            call_close(&w);
        }
    call_world_free(&w);
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

/* Programs that stop at the first division by zero, overflow or invalid operation can use the library on ordinary input, faces
 * without area and zero pivots among it, and bad arguments are told as ever. */
static void rob_traps(void) {
    static const hd_simd simds[3] = {HD_SIMD_AUTO, HD_SIMD_NONE, HD_SIMD_AVX2};
    const double offset[3] = {5, 0, 0};
    shape ball = kit_own_shape(shape_bumpy(2, 5)), grid = kit_own_shape(shape_grid(9, 8, 0.3)), s = shape_disjoint(&ball, &grid, offset);
    static call_data d;
    hd_context ctx;
    const char *volatile stage = "";
    void (*before)(int) = signal(SIGFPE, rob_on_trap);
    volatile int k = 0;
    int32_t f;
    for (f = 0; f < s.n_tri; f += 23) s.tri[3 * f + 1] = s.tri[3 * f];               /* a corner twice */
    for (f = 5; f < s.n_tri; f += 41)                                                /* two places the same */
        memcpy(s.xyz + 3 * s.tri[3 * f], s.xyz + 3 * s.tri[3 * f + 1], 3 * sizeof(double));
    memcpy(s.xyz + 3, s.xyz, 3 * sizeof(double));
    call_data_make(&d, s);
    if (setjmp(rob_trapped)) {
        fedisableexcept(FE_ALL_EXCEPT);
        CHECK_MSG(0, "trapped: %s, instruction set %d", stage, k);
        signal(SIGFPE, before);
        return;
    }
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
    memset(&ctx, 0, sizeof ctx);
    for (k = 0; k < 3; k++) {
        ctx.simd = simds[k];
        rob_trap_calls(&d, &ctx, &stage);
        stage = "pivots";
        rob_trap_pivots(&ctx);
    }
    stage = "bad arguments";
    doors_rows();
    fedisableexcept(FE_ALL_EXCEPT);
    signal(SIGFPE, before);
    call_data_free(&d);
}
#endif

static void rob_calls(void) {
    char text[80];
    rob_job job;
    call_data_make(&rob_data, call_pair_of_shapes());
    job.run = rob_script;
    for (job.variant = 0; job.variant < ROB_SCRIPTS + N_CALLS; job.variant++) {
        job.what = rob_words(job.variant, text);
        rob_fail_each_allocation(&job);
        if (job.variant >= ROB_SCRIPTS) continue;
        rob_stop_each_progress(&job, HD_PROGRESS_CANCEL, HD_ERR_CANCELLED);
        rob_byte_limits(&job);
        rob_stop_each_progress(&job, (hd_progress)1, HD_ERR_ARGUMENT);
        rob_stop_each_progress(&job, (hd_progress)0, HD_ERR_ARGUMENT);
    }
    call_data_free(&rob_data);
}

static void test_robust(void) {
    rob_calls();
    rob_small_memory();
    rob_cancel_lanes();
    rob_plan_survives();
    rob_nothing();
#ifdef ROB_TRAPS
    rob_traps();
#endif
}

#endif
