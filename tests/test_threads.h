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

/* A column, the same bits each time, and for direct a distance: u [2 n]. */
static void *thr_user_run(void *arg) {
    thr_user *w = (thr_user *)arg;
    const size_t n = (size_t)w->lap->n;
    const int32_t source = 5;
    const double t = 50 * w->lap->h * w->lap->h;
    double *u = (double *)malloc(2 * n * sizeof *u);
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
        w->good = hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, source, u, NULL, NULL) >= 0 &&
                  (w->method != HD_METHOD_DIRECT || k > 0 ||
                   hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, 1, &source, u + n, 0, NULL, NULL) >= 0);
        if (w->method != HD_METHOD_DIRECT) memset(u + n, 0, n * sizeof *u);
        if (k == 0 && w->good) memcpy(w->u, u, 2 * n * sizeof *u);
        w->good = w->good && memcmp(u, w->u, 2 * n * sizeof *u) == 0;
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
    const size_t size = 2 * (size_t)s->n;
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
    thr_counts(&s, &small);
    thr_fork(&s, want, u);
#ifdef LDL_THREADS
    thr_nested(&s, want);
#endif
    thr_release();
    free(want);
    free(u);
    shape_free(&s);
    shape_free(&small);
}

#endif
