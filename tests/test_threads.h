/* test_threads.h - the library's own threads: when they start and end, what is counted, nested use, fork, any order of claims */

#ifndef TEST_THREADS_H
#define TEST_THREADS_H

#ifndef _WIN32
#include <sys/wait.h>
#endif

/* The sanitizer of threads has one of its own, and knows no threads after a fork. */
#if defined(__SANITIZE_THREAD__)
#define THR_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define THR_SANITIZER 1
#endif
#endif

/* Threads of this process besides the first, -1 where the system does not tell. */
static int thr_running(void) {
    int n = -1;
#if defined(__linux__) && !defined(THR_SANITIZER)
    DIR *d = opendir("/proc/self/task");
    struct dirent *entry;
    for (n = -1; d && (entry = readdir(d)) != NULL;) n += entry->d_name[0] != '.';
    if (d) closedir(d);
#endif
    return n;
}

static hd_heat *thr_plan(const hd_laplacian *lap, hd_context *ctx) {
    hd_heat_opts o = eng_opts(HD_METHOD_DIRECT);
    o.context = ctx;
    return eng_create(lap, &o);
}

static void thr_column(hd_heat *heat, const hd_laplacian *lap, int32_t source, double *u) {
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, 50 * lap->h * lap->h, source, u, NULL, NULL) >= 0);
}

/* They start with the first long work and end with the last object, whatever order objects are freed in. */
static void thr_lifetime(const shape *s, const double *want, double *u) {
    const int before = thr_running();
    const int own = hdi_threads_linked();
    hd_context ctx;
    hd_laplacian *lap, *other;
    hd_heat *heat;
    int32_t *index = DENSE_NEW(int32_t, 7 * s->n);
    memset(&ctx, 0, sizeof ctx);
    ctx.n_threads = 3;
    CHECK(hd_context_threads(&ctx) == (own ? 3 : 1) && hd_context_threads(NULL) >= 1);
    lap = test_laplacian_at(s, s->xyz, HD_LAPLACIAN_FEM, 0, &ctx);
    heat = thr_plan(lap, &ctx);
    thr_column(heat, lap, 5, u);
    CHECK(memcmp(u, want, (size_t)s->n * sizeof *u) == 0);
    CHECK((ctx.threads != NULL) == own && (ctx.regions > 0) == own && ctx.n_holders == 2);
    CHECK(before < 0 || thr_running() == before + 2 * own);
    ctx.n_threads = 2;                           /* from the next long work on */
    thr_column(heat, lap, 6, u);
    CHECK(before < 0 || thr_running() <= before + 2 * own);
    hd_heat_free(heat);
    CHECK((ctx.threads != NULL) == own);
    other = test_laplacian_at(s, s->xyz, HD_LAPLACIAN_FEM, 0, &ctx);
    hd_laplacian_free(lap);
    CHECK(ctx.n_holders == 1);
    hd_laplacian_free(other);
    CHECK(!ctx.threads && ctx.n_holders == 0 && ctx.bytes_in_use == 0 && thr_running() == before);
    CHECK(hd_neighbours_nearest(s->xyz, s->n, NULL, 0, 7, index, NULL, &ctx, NULL) == HD_OK);   /* makes no object */
    CHECK(!ctx.threads && ctx.n_holders == 0 && thr_running() == before);
    lap = NULL;
    CHECK(hd_laplacian_triangles(&lap, s->xyz, s->n, s->tri, -1, NULL, NULL) == HD_ERR_ARGUMENT && thr_running() == before);
    free(index);
}

/* A product makes no object; it has threads like any other call, and ends them. */
static void thr_product(void) {
    enum { N = 200000 };
    hd_csr a = test_path_csr(N, 1);
    double *x = DENSE_NEW(double, N), *y = DENSE_NEW(double, N);
    const int before = thr_running();
    hd_context ctx;
    uint64_t seed = 1;
    int32_t i;
    memset(&ctx, 0, sizeof ctx);
    ctx.n_threads = 2;
    for (i = 0; i < N; i++) x[i] = dense_signed(&seed);
    hd_csr_apply(&a, x, y, &ctx);
    CHECK(ctx.regions == (hdi_threads_linked() ? 1 : 0) && !ctx.threads && ctx.n_holders == 0 && thr_running() == before);
    for (i = 0; i < N; i++) y[i] -= 2 * x[i] - x[(i + 1) % N] - x[(i + N - 1) % N];
    CHECK(dense_max_abs(y, N) < 1e-14);
    hd_csr_free(&a, NULL);
    free(x);
    free(y);
}

/* What is asked of other threads: a solve is one loop; a small one is no loop, and starts nobody. */
static void thr_counts(const shape *s, const shape *small) {
    const uint64_t own = hdi_threads_linked() ? 1 : 0;
    const shape *const shapes[2] = {s, small};
    int k, serial;
    for (k = 0; k < 2; k++) {
        for (serial = 0; serial < 2; serial++) {
            hd_csr a = ldl_mesh_pattern(shapes[k]);
            double *val = DENSE_NEW(double, a.nnz), *x = DENSE_NEW(double, a.n_rows);
            hd_context ctx;
            hd_ldl_opts o;
            hd_ldl *f = NULL;
            int32_t i;
            int64_t p;
            for (i = 0; i < a.n_rows; i++)
                for (p = a.row_ptr[i]; p < a.row_ptr[i + 1]; p++) val[p] = a.col[p] == i ? 9 : -1;
            memset(&ctx, 0, sizeof ctx);
            ctx.n_threads = serial ? 1 : 2;
            o = ldl_opts_of(HD_ORDERING_AUTO, NULL, shapes[k]->xyz, &ctx);
            CHECK(hd_ldl_analyse(&f, &a, &o, NULL, NULL) == HD_OK && hd_ldl_factor(f, val, NULL, NULL) == HD_OK);
            ctx.regions = ctx.helped = ctx.waits = 0;
            x[0] = 1;
            CHECK(hd_ldl_solve(f, 1, x, 0, x, 0, NULL) == HD_OK);
            CHECK_MSG(ctx.regions == (serial || k ? 0 : own), "%d rows: %lld loops", (int)a.n_rows, (long long)ctx.regions);
            CHECK(!serial || (!ctx.threads && ctx.helped == 0 && ctx.waits == 0));
            hd_ldl_free(f);
            hd_csr_free(&a, NULL);
            free(val);
            free(x);
        }
    }
}

/* The child of a fork uses and frees what its parent made, and starts threads of its own; the parent goes on. */
static void thr_fork(const shape *s, const double *want, double *u) {
#if !defined(_WIN32) && !defined(THR_SANITIZER)
    const size_t size = (size_t)s->n * sizeof *u;
    hd_context ctx;
    hd_laplacian *lap;
    hd_heat *heat;
    pid_t pid;
    int status = -1, k;
    memset(&ctx, 0, sizeof ctx);
    ctx.n_threads = 2;
    lap = test_laplacian_at(s, s->xyz, HD_LAPLACIAN_FEM, 0, &ctx);
    heat = thr_plan(lap, &ctx);
    thr_column(heat, lap, 9, u);
    for (k = 0; k < 2; k++) {
        fflush(stdout);
        pid = fork();
        if (pid == 0) {
            if (k == 0) thr_column(heat, lap, 5, u);
            status = k == 0 && memcmp(u, want, size) != 0;
            hd_heat_free(heat);                  /* the second child frees without having used anything */
            hd_laplacian_free(lap);
            _exit(status || ctx.threads || test_failed_in_group);
        }
        CHECK(pid > 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    thr_column(heat, lap, 5, u);
    CHECK(memcmp(u, want, size) == 0);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    CHECK(!ctx.threads);
#else
    (void)s; (void)want; (void)u;
#endif
}

#ifdef LDL_THREADS
typedef struct thr_user { const hd_laplacian *lap; double *u; hd_method method; int32_t n_threads; int good; } thr_user;

/* Eigenvalues by a context of the caller's, and what asks the Laplacian itself without memory: out [THR_ASKED]. */
enum { THR_ASKED = 10 };
static int thr_ask(const hd_laplacian *lap, hd_context *ctx, double *out) {
    hd_spectrum_opts o;
    hd_spectrum *s = NULL;
    int good;
    memset(&o, 0, sizeof o);
    o.context = ctx;
    o.count = THR_ASKED - 4;
    good = hd_spectrum_create(&s, lap, &o, NULL) == HD_OK && hd_times_auto(lap, 3, out + o.count, NULL) == HD_OK;
    if (good) memcpy(out, s->value, (size_t)o.count * sizeof *out);
    out[THR_ASKED - 1] = hd_laplacian_lambda_max(lap);
    hd_spectrum_free(s);
    return good;
}

/* A column, the same bits each time, and for direct a distance and the above: u [2 n + THR_ASKED]. */
static void *thr_user_run(void *arg) {
    thr_user *w = (thr_user *)arg;
    const size_t n = (size_t)w->lap->n;
    const int32_t source = 5;
    const double t = 50 * w->lap->h * w->lap->h;
    const size_t size = 2 * n + THR_ASKED;
    double *u = (double *)calloc(size, sizeof *u);
    hd_context ctx;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    int k;
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    ctx.n_threads = w->n_threads;
    o.context = &ctx;
    o.method = w->method;
    w->good = u && hd_heat_create(&heat, w->lap, &o, NULL) == HD_OK;
    for (k = 0; w->good && k < 3; k++) {
        w->good = hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, source, u, NULL, NULL) >= 0;
        if (w->good && k == 0 && w->method == HD_METHOD_DIRECT)
            w->good = hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, u + n, 0, NULL, NULL) >= 0 &&
                      thr_ask(w->lap, &ctx, u + 2 * n);
        if (k == 0 && w->good) memcpy(w->u, u, size * sizeof *u);
        w->good = w->good && memcmp(u, w->u, size * sizeof *u) == 0;
    }
    hd_heat_free(heat);
    w->good = w->good && !ctx.threads && ctx.bytes_in_use == 0;
    free(u);
    return NULL;
}

/* A user's threads, each with a plan and a context of its own, share a Laplacian. */
static void thr_nested(const shape *s, const double *want) {
    static const hd_method methods[3] = {HD_METHOD_DIRECT, HD_METHOD_KRYLOV, HD_METHOD_ITERATIVE};
    enum { USERS = 8 };
    hd_laplacian *lap = test_laplacian_at(s, s->xyz, HD_LAPLACIAN_FEM, 0, NULL);
    const size_t size = 2 * (size_t)s->n + THR_ASKED;
    double *u = DENSE_NEW(double, USERS * size);
    pthread_t thread[USERS];
    thr_user user[USERS];
    int k;
    for (k = 0; k < USERS; k++) {
        user[k].lap = lap;
        user[k].u = u + (size_t)k * size;
        user[k].method = methods[k % 3];
        user[k].n_threads = k % 4;               /* all, one, two, three */
        CHECK(pthread_create(thread + k, NULL, thr_user_run, user + k) == 0);
    }
    for (k = 0; k < USERS; k++) pthread_join(thread[k], NULL);
    for (k = 0; k < USERS; k++) {
        CHECK_MSG(user[k].good, "user %d", k);
        CHECK_MSG(memcmp(user[k].u, user[k % 3].u, size * sizeof *u) == 0, "user %d, unlike user %d", k, k % 3);
    }
    CHECK(memcmp(u, want, (size_t)s->n * sizeof *u) == 0);
    hd_laplacian_free(lap);
    free(u);
}
#endif

/* Tasks of a loop that release others: each is done once, after what it waits for, by any number of threads. A
 * binary tree, from the leaves up. */
typedef struct thr_tree { hd_context *ctx; int32_t *order, *pending; int64_t *sum; int32_t leaves; int64_t wrong; } thr_tree;

static void thr_tree_task(void *arg, int64_t index, int32_t worker) {
    thr_tree *w = (thr_tree *)arg;
    const int32_t i = (int32_t)index, up = i / 2;
    (void)worker;
    if (i < w->leaves) w->sum[i] = w->sum[2 * i] + w->sum[2 * i + 1];
    else w->sum[i] = i;
    if (up > 0 && HDI_ATOMIC_ADD(w->pending + up, -1) == 0) hdi_release(w->ctx->threads, up, w->order);
}

static void thr_release(void) {
    enum { LEAVES = 512 };
    int32_t order[2 * LEAVES], pending[2 * LEAVES], i, threads, round;
    int64_t sum[2 * LEAVES];
    for (threads = 2; threads < 9; threads++) {
        hd_context ctx;
        thr_tree w;
        memset(&ctx, 0, sizeof ctx);
        memset(&w, 0, sizeof w);
        ctx.n_threads = threads;
        w.ctx = &ctx;
        w.order = order;
        w.pending = pending;
        w.sum = sum;
        w.leaves = LEAVES;
        hdi_hold(&ctx);
        for (round = 0; round < 50 && hdi_threads_own(&ctx, 2 * LEAVES); round++) {
            for (i = 0; i < 2 * LEAVES; i++) pending[i] = 2;
            for (i = 0; i < LEAVES; i++) order[i] = LEAVES + i;
            memset(sum, 0, sizeof sum);
            hdi_parallel_ordered(&ctx, 2 * LEAVES - 1, LEAVES, order, thr_tree_task, &w);
            CHECK(sum[1] == (int64_t)LEAVES * (3 * LEAVES - 1) / 2);
        }
        hdi_let_go(&ctx);
        CHECK(!ctx.threads && ctx.regions == (uint64_t)round);
    }
}

#if HDI_THREADS
/* The caller's tasks wait until another thread has one, and that one until the caller sleeps. */
typedef struct thr_nap { hd_threads *threads; int32_t begun, slept; } thr_nap;

static int thr_caller_sleeps(hd_threads *t) {
    int yes;
    hdi_lock(&t->lock);
    yes = t->caller_asleep;
    hdi_unlock(&t->lock);
    return yes;
}

static void thr_nap_task(void *arg, int64_t index, int32_t worker) {
    thr_nap *w = (thr_nap *)arg;
    const time_t start = time(NULL);
    (void)index;
    if (worker > 0 && HDI_ATOMIC_ADD(&w->begun, 1) == 1) {
        while (!thr_caller_sleeps(w->threads) && time(NULL) < start + 30) {}
        HDI_ATOMIC_SET(&w->slept, thr_caller_sleeps(w->threads));
    }
    while (worker == 0 && HDI_ATOMIC_GET(&w->begun) == 0 && time(NULL) < start + 60) {}
}
#endif

/* No more threads start than there are tasks besides the caller's; and a caller that has nothing to do sleeps. */
static void thr_few_tasks(void) {
#if HDI_THREADS
    enum { TASKS = HDI_TASKS_START };
    hd_context ctx;
    thr_nap w;
    memset(&ctx, 0, sizeof ctx);
    memset(&w, 0, sizeof w);
    ctx.n_threads = 4 * TASKS;
    hdi_hold(&ctx);
    w.threads = hdi_threads_own(&ctx, TASKS - 1);
    CHECK(!w.threads);                           /* too few to start any */
    w.threads = hdi_threads_own(&ctx, TASKS);
    if (w.threads) {
        CHECK_MSG(w.threads->n == TASKS - 1, "%d threads", (int)w.threads->n);
        hdi_parallel(&ctx, TASKS, thr_nap_task, &w);
        CHECK(w.begun > 0 && w.slept && ctx.waits > 0 && ctx.helped == (uint64_t)w.begun && ctx.regions == 1);
        CHECK(hdi_threads_own(&ctx, TASKS - 1) == w.threads);    /* those that run take part in loops of few tasks, too */
    }
    CHECK(w.threads || !hdi_threads_linked());
    hdi_let_go(&ctx);
    CHECK(!ctx.threads);
#endif
}

/* Cancels at the last of so many reports. */
static hd_progress thr_cancel(void *user, const char *stage, double done) {
    int *left = (int *)user;
    (void)stage;
    (void)done;
    return --*left > 0 ? HD_PROGRESS_CONTINUE : HD_PROGRESS_CANCEL;
}

/* Nested dissection and the analysis for any number of threads: the same permutation and the same supernodes, in
 * one loop for the order. Cancelled, nothing is left behind. */
static void thr_orders(void) {
    static const int32_t n_threads[] = {1, 2, 3, 8};
    shape s = shape_bumpy(5, 2);
    hd_laplacian *lap = test_laplacian_at(&s, s.xyz, HD_LAPLACIAN_FEM, 0, NULL);
    const int32_t n = lap->n_active;
    const size_t bytes = (size_t)n * sizeof(int32_t);
    int32_t *first = DENSE_NEW(int32_t, n), *final = DENSE_NEW(int32_t, n), *perm = DENSE_NEW(int32_t, n);
    int64_t loops = 0;
    int q, cancelled, left;
    for (q = 0; q < 5; q++) {
        for (cancelled = 0; cancelled < 2; cancelled++) {
            hd_context ctx;
            hdi_symbolic sym;
            hd_error e;
            memset(&ctx, 0, sizeof ctx);
            hdi_error_clear(&e);
            ctx.n_threads = q < 4 ? n_threads[q] : 0;
            ctx.parallel_for = q < 4 ? NULL : heat_shuffled_for;
            ctx.parallel_user = &loops;
            ctx.progress_user = &left;
            ctx.progress = cancelled ? thr_cancel : NULL;
            hdi_hold(&ctx);
            left = q % 4 ? 1 : 3;                /* the calling thread may find all of a loop taken */
            if (cancelled) {
                CHECK(hdi_nd_order(&lap->L, lap->xyz, perm, &ctx, &e) == HD_ERR_CANCELLED && left == 0);
            } else {
                CHECK(hdi_nd_order(&lap->L, lap->xyz, perm, &ctx, &e) == HD_OK);
                if (q > 0 && q < 4) CHECK(ctx.regions > 0 && ctx.threads);
                if (q == 0) memcpy(first, perm, bytes);
                CHECK_MSG(memcmp(first, perm, bytes) == 0, "way %d: another permutation", q);
                CHECK(hdi_symbolic_make(&sym, &lap->L, perm, &ctx, &e) == HD_OK);
                if (q == 0) memcpy(final, sym.perm, bytes);
                CHECK_MSG(memcmp(final, sym.perm, bytes) == 0, "way %d: another elimination order", q);
                hdi_symbolic_free(&ctx, &sym);
            }
            hdi_let_go(&ctx);
            CHECK(ctx.bytes_in_use == 0 && !ctx.threads);
        }
    }
    free(first);
    free(final);
    free(perm);
    hd_laplacian_free(lap);
    shape_free(&s);
}

/* k columns; returns the ordering that the report names. */
static hd_ordering thr_columns(hd_heat *heat, const hd_laplacian *lap, int32_t k, double *U) {
    const int32_t sources[4] = {7, 11000, 23000, 40000};
    const double t = 100 * lap->h * lap->h;
    hd_report rep;
    hd_error e;
    CHECK(hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, k, sources, U, 0, &rep, &e) >= 0 && rep.method == HD_METHOD_KRYLOV);
    return rep.ordering;
}

/* Few columns of a large mesh have an elimination order of their own. No answer depends on what a plan was asked
 * before, nor on the number of threads, nor on an update between; another order gives the same column. */
static void thr_light(void) {
    shape s = shape_bumpy(6, 4);
    const size_t bytes = (size_t)s.n * sizeof(double);
    double *kept = DENSE_NEW(double, s.n), *one = DENSE_NEW(double, s.n), *four = DENSE_NEW(double, 4 * s.n), *u = DENSE_NEW(double, 4 * s.n);
    double *xyz = DENSE_NEW(double, 3 * s.n);
    hd_context ctx[2];
    int q, i;
    for (i = 0; i < 3 * s.n; i++) xyz[i] = s.xyz[i] * (i % 3 ? 1 : 1.25);
    for (q = 0; q < 2; q++) {
        hd_laplacian *lap;
        hd_heat_opts opts;
        hd_heat *heat = NULL;
        hd_error e;
        memset(ctx + q, 0, sizeof *ctx);
        memset(&opts, 0, sizeof opts);
        ctx[q].n_threads = q ? 3 : 1;
        opts.method = HD_METHOD_KRYLOV;
        lap = test_laplacian_at(&s, s.xyz, HD_LAPLACIAN_VORONOI_COT, 1, ctx + q);
        CHECK(hd_heat_create(&heat, lap, &opts, &e) == HD_OK);
        if (q == 0) CHECK(thr_columns(heat, lap, 1, kept) == HD_ORDERING_MINIMUM_DEGREE);
        CHECK(thr_columns(heat, lap, 4, u) == HD_ORDERING_NESTED_DISSECTION);
        if (q == 0) memcpy(four, u, 4 * bytes);
        CHECK_MSG(memcmp(four, u, 4 * bytes) == 0, "way %d: four columns differ", q);
        CHECK_MSG(dense_max_diff(kept, u, s.n) <= 1e-9 * dense_max_abs(kept, s.n), "other orders differ by %g",
                  dense_max_diff(kept, u, s.n));
        CHECK(thr_columns(heat, lap, 1, u) == HD_ORDERING_MINIMUM_DEGREE);
        CHECK_MSG(memcmp(kept, u, bytes) == 0, "way %d: one column differs", q);
        if (q == 0) {                            /* both copies of the pair follow an update */
            CHECK(hd_laplacian_update(lap, xyz, &e) == HD_OK);
            CHECK(thr_columns(heat, lap, 1, one) == HD_ORDERING_MINIMUM_DEGREE);
            CHECK(thr_columns(heat, lap, 4, u) == HD_ORDERING_NESTED_DISSECTION);
            CHECK_MSG(dense_max_diff(one, u, s.n) <= 1e-9 * dense_max_abs(one, s.n), "updated, other orders differ by %g",
                      dense_max_diff(one, u, s.n));
            hd_heat_free(heat);
            opts.method = HD_METHOD_AUTO;
            CHECK(hd_heat_create(&heat, lap, &opts, &e) == HD_OK);
            CHECK(thr_columns(heat, lap, 1, u) == HD_ORDERING_MINIMUM_DEGREE);
            CHECK_MSG(memcmp(one, u, bytes) == 0, "updated: a new plan's column differs");
        }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        CHECK(ctx[q].bytes_in_use == 0);
    }
    free(kept);
    free(one);
    free(four);
    free(u);
    free(xyz);
    shape_free(&s);
}

static void test_threads(void) {
    shape s = shape_bumpy(4, 5), small = shape_bumpy(1, 5);
    double *want = DENSE_NEW(double, s.n), *u = DENSE_NEW(double, s.n);
    hd_context serial;
    hd_laplacian *lap;
    hd_heat *heat;
    memset(&serial, 0, sizeof serial);
    serial.n_threads = 1;
    lap = test_laplacian_at(&s, s.xyz, HD_LAPLACIAN_FEM, 0, &serial);
    heat = thr_plan(lap, &serial);
    thr_column(heat, lap, 5, want);
    CHECK(serial.regions == 0 && !serial.threads);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    thr_lifetime(&s, want, u);
    thr_product();
    thr_counts(&s, &small);
    thr_fork(&s, want, u);
#ifdef LDL_THREADS
    thr_nested(&s, want);
#endif
    thr_release();
    thr_few_tasks();
    thr_orders();
    thr_light();
    CHECK(GUARD_IN_USE == 0);                    /* all that threads had is free */
    free(want);
    free(u);
    shape_free(&s);
    shape_free(&small);
}

#endif
