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
    hd_heat_opts o;
    hd_heat *heat = NULL;
    memset(&o, 0, sizeof o);
    o.method = HD_METHOD_DIRECT;
    o.context = ctx;
    CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK);
    return heat;
}

static void thr_column(hd_heat *heat, const hd_laplacian *lap, int32_t source, double *u) {
    CHECK(hd_heat_column(heat, HD_KERNEL_SYMMETRIC, 50 * lap->h * lap->h, source, u, NULL, NULL) >= 0);
}

/* Can this build start threads? */
static int thr_own(void) {
    hd_context ctx;
    memset(&ctx, 0, sizeof ctx);
    ctx.n_threads = 3;
    CHECK(hd_context_threads(&ctx) == 3 || hd_context_threads(&ctx) == 1);
    return hd_context_threads(&ctx) == 3;
}

/* ---- the same bits ---- */

/* By so many threads, or by a user's loop that does tasks in another order. */
enum { THR_WAYS = 5 };
static const int32_t thr_ways[THR_WAYS] = {1, 2, 3, 8, 0};

/* Each way the same answers. Returns how many ways shared loops; stop > 0: cancelled at that progress call. */
static int thr_same(call_world *w, const call_data *d, const char *script, int64_t stop) {
    double *first = NULL;
    int q, shared = 0;
    for (q = 0; q < THR_WAYS; q++) {
        test_memory m;
        hd_context ctx = test_memory_context(&m);
        rob_progress p;
        int64_t loops = 0;
        hd_status st;
        memset(&p, 0, sizeof p);
        ctx.n_threads = thr_ways[q];
        ctx.parallel_for = thr_ways[q] ? NULL : heat_shuffled_for;
        ctx.parallel_user = &loops;
        call_open(w, d, &ctx);
        w->what = script;
        st = call_prepare(w, script);
        CHECK_MSG(st >= 0, "%s: %s", script, w->e.text);
        if (stop) rob_watch(&p, &ctx, stop);
        loops = 0;
        ctx.regions = 0;
        st = call_test(w, script);
        CHECK_MSG(stop && p.calls >= stop ? st == HD_ERR_CANCELLED && p.calls == stop : st >= 0, "%s, way %d: %s", script, q,
                  hd_status_name(st));
        if (!first) memcpy(first = (double *)dense_alloc((int64_t)w->out_size, 1), w->out, w->out_size);
        if (!stop) CHECK_MSG(memcmp(first, w->out, w->out_size) == 0, "%s, way %d: other bits", script, q);
        shared += loops > 0 || ctx.regions > 0;
        ctx.progress = NULL;
        call_close(w);
        CHECK_MSG(!ctx.threads && ctx.n_holders == 0, "%s, way %d: threads are left", script, q);
        test_memory_done(&m, &ctx, script);
    }
    free(first);
    return shared;
}

/* Every call, and solvers that a plan would not choose. */
static void thr_calls(void) {
    static const char *const more[16] = {"iterative cocg columns", "iterative cocg k=1 apply", "iterative minres columns",
                                        "krylov columns", "iterative lanczos columns", "voronoi delaunay triangles",
                                        "weighted distance", "held border pairs", "local n_times=3 columns_sparse",
                                         "local operator entries", "local columns_from", "local k=1 apply", "local k=1 derivative",
                                         "local n_times=2 distance", "weighted local distance_from", "local sample"};
    call_data d;
    call_world w;
    char text[80];
    int k, shared = 0;
    memset(&w, 0, sizeof w);
    call_data_make(&d, shape_bumpy(3, 5));
    for (k = 0; k < N_CALLS + 16; k++) {
        snprintf(text, sizeof text, "%s%s", k < N_CALLS ? "direct " : "", k < N_CALLS ? call_table[k].name : more[k - N_CALLS]);
        shared += thr_same(&w, &d, text, 0) > 0;
    }
    CHECK_MSG(shared > N_CALLS / 3, "only %d calls had loops to share", shared);
    call_world_free(&w);
    call_data_free(&d);
}

/* The elimination order of a larger mesh, and what is made by it; cancelled, nothing is left behind. */
static void thr_orders(void) {
    call_data d;
    call_world w;
    int64_t stop;
    memset(&w, 0, sizeof w);
    call_data_make(&d, shape_bumpy(5, 2));
    CHECK(thr_same(&w, &d, "dissection | analyse", 0) >= (thr_own() ? 4 : 1));
    CHECK(thr_same(&w, &d, "dissection analyse | factor solve", 0) >= (thr_own() ? 4 : 1));
    for (stop = 1; stop <= 3; stop++) thr_same(&w, &d, "dissection | analyse", stop);
    call_world_free(&w);
    call_data_free(&d);
}

/* A user's loop in which the calling thread takes no part. */
static void thr_aside_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    int64_t i;
    (void)user;
    for (i = 0; i < n_tasks; i++) task(arg, i, 1);
}

/* Then progress is told between loops, and can cancel. */
static void thr_aside(void) {
    call_data d;
    call_world w;
    int64_t stop;
    memset(&w, 0, sizeof w);
    call_data_make(&d, shape_bumpy(5, 2));
    for (stop = 1; stop <= 2; stop++) {
        static const char script[] = "dissection analyse | factor";
        hd_context ctx;
        rob_progress p;
        memset(&ctx, 0, sizeof ctx);
        memset(&p, 0, sizeof p);
        p.answer = HD_PROGRESS_CANCEL;
        p.stop_at = stop;
        ctx.parallel_for = thr_aside_for;
        ctx.progress_user = &p;
        call_open(&w, &d, &ctx);
        w.what = "aside";
        CHECK(call_prepare(&w, script) >= 0);
        ctx.progress = rob_on_progress;
        CHECK_MSG(call_test(&w, script) == HD_ERR_CANCELLED && p.calls == stop, "%d calls of progress", (int)p.calls);
        ctx.progress = NULL;
        CHECK(call_test(&w, script) >= 0);       /* all of it now */
        call_close(&w);
        CHECK(ctx.bytes_in_use == 0);
    }
    call_world_free(&w);
    call_data_free(&d);
}

/* ---- when they run ---- */

/* They start with the first long work and end with the last object, whatever order objects are freed in. */
static void thr_lifetime(const shape *s, const double *want, double *u) {
    const int before = thr_running();
    const int own = thr_own();
    hd_context ctx;
    hd_laplacian *lap, *other;
    hd_heat *heat;
    int32_t *index = KIT_NEW(int32_t, 7 * s->n);
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
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, -1), NULL, NULL) == HD_ERR_ARGUMENT && thr_running() == before);
}

/* What is asked of other threads: a solve of a large mesh is one loop; a small one is no loop, and starts nobody. */
static void thr_counts(void) {
    int k;
    for (k = 0; k < 4; k++) {
        const int large = k < 2, serial = k % 2;
        hd_context ctx;
        call_data d;
        call_world w;
        memset(&ctx, 0, sizeof ctx);
        memset(&w, 0, sizeof w);
        ctx.n_threads = serial ? 1 : 2;
        call_data_make(&d, shape_bumpy(large ? 4 : 1, 5));
        call_open(&w, &d, &ctx);
        w.what = "counts";
        CHECK(call_prepare(&w, "k=1 solve") == HD_OK);
        ctx.regions = ctx.helped = ctx.waits = 0;
        CHECK(call_test(&w, "solve") == HD_OK);
        CHECK_MSG(ctx.regions == (large && !serial && thr_own() ? 1 : 0), "%d rows: %d loops", (int)d.s.n, (int)ctx.regions);
        CHECK(!serial || (!ctx.threads && ctx.helped == 0 && ctx.waits == 0));
        call_close(&w);
        call_world_free(&w);
        call_data_free(&d);
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
    out[THR_ASKED - 1] = lap->lambda_max;
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
            w->good = hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(1, &source), u + n, 0, NULL, NULL) >= 0 &&
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
    hd_laplacian *lap = kit_own_laplacian(test_laplacian_at(s, s->xyz, HD_LAPLACIAN_FEM, 0, NULL));
    const size_t size = 2 * (size_t)s->n + THR_ASKED;
    double *u = KIT_NEW(double, USERS * size);
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
}
#endif

/* So many columns by one real factor, and in what elimination order. */
static void thr_light_ask(call_world *w, int32_t k, hd_ordering ordering, double *kept, const char *what) {
    const size_t bytes = (size_t)k * (size_t)w->data->s.n * sizeof *kept;
    w->what = what;
    w->a.k = k;
    CHECK(call_words(w, "columns", 0) >= 0 && w->rep.method == HD_METHOD_KRYLOV && w->rep.ordering == ordering);
    if (kept[0] == 0) memcpy(kept, w->out, bytes);
    CHECK_MSG(memcmp(kept, w->out, bytes) == 0, "%s: %d columns differ", what, (int)k);
}

/* Few columns of a large mesh have an elimination order of their own. No answer depends on what a plan was asked
 * before, nor on the number of threads, nor on an update between; another order gives the same column. */
static void thr_light(void) {
    static const int32_t ids[4] = {7, 11000, 23000, 40000};
    const hd_ordering light = HD_ORDERING_MINIMUM_DEGREE, full = HD_ORDERING_NESTED_DISSECTION;
    call_data d;
    call_world w;
    double *one, *four, t;
    int q, frame;
    memset(&w, 0, sizeof w);
    call_data_make(&d, shape_bumpy(6, 4));
    t = 100 * d.h * d.h;
    one = KIT_NEW(double, 2 * d.s.n);          /* of each frame */
    four = KIT_NEW(double, 8 * d.s.n);
    for (q = CASES_FEW; q < 2; q++) {           /* where each takes long: with threads only */
        hd_context ctx;
        memset(&ctx, 0, sizeof ctx);
        ctx.n_threads = q ? 3 : 1;
        call_open(&w, &d, &ctx);
        w.a.ids = ids;
        w.a.t = &t;
        w.what = "light";
        CHECK(call_words(&w, "voronoi updatable triangles krylov operator plan", 1) == HD_OK);
        for (frame = 0; frame < 2 - q; frame++) {
            double *u = one + frame * d.s.n, *v = four + 4 * frame * d.s.n;
            if (frame) CHECK(call_words(&w, "update", 0) == HD_OK);
            if (q == CASES_FEW) thr_light_ask(&w, 1, light, u, "first");
            thr_light_ask(&w, 4, full, v, q ? "threads" : "after one");
            CHECK_MSG(dense_max_diff(u, v, d.s.n) <= 1e-9 * dense_max_abs(u, d.s.n), "frame %d, other orders differ by %g", frame,
                      dense_max_diff(u, v, d.s.n));
            thr_light_ask(&w, 1, light, u, q ? "threads" : "after four");
        }
        if (q == 0) CHECK(call_words(&w, "krylov plan", 1) == HD_OK);
        if (q == 0) thr_light_ask(&w, 1, light, one + d.s.n, "a new plan");
        call_close(&w);
        CHECK(ctx.bytes_in_use == 0);
    }
    call_world_free(&w);
    call_data_free(&d);
}

static void thr_lives(void) {
    shape s = kit_own_shape(shape_bumpy(4, 5));
    double *want = KIT_NEW(double, s.n), *u = KIT_NEW(double, s.n);
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
    thr_counts();
    thr_fork(&s, want, u);
#ifdef LDL_THREADS
    thr_nested(&s, want);
#endif
}

static void test_threads(void) {
    thr_calls();
    thr_orders();
    thr_aside();
    thr_lives();
    thr_light();
#ifdef GUARD_IN_USE
    CHECK(GUARD_IN_USE == 0);                    /* all that threads had is free */
#endif
}

#endif
