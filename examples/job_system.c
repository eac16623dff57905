/* job_system.c - the library's parallel work on the threads of your own job system

   Build and run from the project's folder:

       cc -O2 examples/job_system.c -o job_system -lm -lpthread && ./job_system

   A job system of three POSIX threads stands for that of an engine. hd_context.parallel_for hands it every parallel
   loop of the library, which then starts no threads of its own. The program prints the time and the answer with the
   job system and without threads; the answers are the same to the last bit. Without POSIX threads the jobs run one
   after another, which is a valid parallel_for too. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if (defined(__unix__) || defined(__APPLE__)) && !defined(HEATDIFF_NO_THREADS)
#include <pthread.h>
#define WITH_THREADS 1
#endif

/* ---- the job system: one loop at a time, whose tasks are claimed one by one ---- */

enum { HELPERS = 3 };

typedef struct job_system {
    hd_task task;
    void *arg;
    int64_t n_tasks, next, left;
    int64_t loops, by_helpers;           /* for the last lines of this program */
#ifdef WITH_THREADS
    pthread_mutex_t lock;
    pthread_cond_t work, done;
    pthread_t thread[HELPERS];
    int started, quit;
#endif
} job_system;

#ifdef WITH_THREADS
/* Claims and runs tasks until none is left to claim. Called with the lock, returns with it. */
static void jobs_run(job_system *j, int32_t worker) {
    while (j->next < j->n_tasks) {
        const int64_t i = j->next++;
        pthread_mutex_unlock(&j->lock);
        j->task(j->arg, i, worker);
        pthread_mutex_lock(&j->lock);
        j->by_helpers += worker > 0;
        if (--j->left == 0) pthread_cond_broadcast(&j->done);
    }
}

static void *jobs_thread(void *arg) {
    job_system *j = (job_system *)arg;
    int32_t worker;
    pthread_mutex_lock(&j->lock);
    worker = ++j->started;               /* 1, 2, ...: 0 is the thread that calls the library */
    while (!j->quit) {
        jobs_run(j, worker);
        if (!j->quit) pthread_cond_wait(&j->work, &j->lock);
    }
    pthread_mutex_unlock(&j->lock);
    return NULL;
}

/* What hd_context.parallel_for asks for: returns when every task is done. The caller works too. */
static void jobs_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    job_system *j = (job_system *)user;
    pthread_mutex_lock(&j->lock);
    j->task = task;
    j->arg = arg;
    j->n_tasks = j->left = n_tasks;
    j->next = 0;
    j->loops++;
    pthread_cond_broadcast(&j->work);
    jobs_run(j, 0);
    while (j->left > 0) pthread_cond_wait(&j->done, &j->lock);
    pthread_mutex_unlock(&j->lock);
}

static void jobs_start(job_system *j) {
    int i;
    memset(j, 0, sizeof *j);
    pthread_mutex_init(&j->lock, NULL);
    pthread_cond_init(&j->work, NULL);
    pthread_cond_init(&j->done, NULL);
    for (i = 0; i < HELPERS; i++)
        if (pthread_create(&j->thread[i], NULL, jobs_thread, j) != 0) exit(1);
}

static void jobs_end(job_system *j) {
    int i;
    pthread_mutex_lock(&j->lock);
    j->quit = 1;
    pthread_cond_broadcast(&j->work);
    pthread_mutex_unlock(&j->lock);
    for (i = 0; i < HELPERS; i++) pthread_join(j->thread[i], NULL);
}
#else
static void jobs_for(void *user, int64_t n_tasks, hd_task task, void *arg) {
    int64_t i;
    ((job_system *)user)->loops++;
    for (i = 0; i < n_tasks; i++) task(arg, i, 0);
}

static void jobs_start(job_system *j) { memset(j, 0, sizeof *j); }
static void jobs_end(job_system *j) { (void)j; }
#endif

/* ---- the work ---- */

enum { NU = 240, NV = 100, N = NU * NV };

static void make_torus(double *xyz, int32_t *tri) {
    int32_t i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const double u = 6.283185307179586 * i / NU, v = 6.283185307179586 * j / NV;
            const int32_t a = i * NV + j, b = (i + 1) % NU * NV + j, c = (i + 1) % NU * NV + (j + 1) % NV;
            const int32_t corner[6] = {a, b, c, a, c, i * NV + (j + 1) % NV};
            xyz[3 * a] = (2 + cos(v)) * cos(u);
            xyz[3 * a + 1] = (2 + cos(v)) * sin(u);
            xyz[3 * a + 2] = sin(v);
            memcpy(tri + 6 * a, corner, sizeof corner);
        }
    }
}

static double seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* The signature of every vertex, with a context. Returns a status; what went wrong is in err. */
static hd_status signature(hd_context *ctx, const double *xyz, const int32_t *tri, double *u, hd_error *err) {
    hd_laplacian_opts opts = {0};
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    opts.context = ctx;                  /* the plan takes the context of its Laplacian */
    if (hd_laplacian_create(&lap, &mesh, &opts, err) >= 0 && hd_heat_create(&heat, lap, NULL, err) >= 0) {
        const double t = 50 * lap->h * lap->h;
        hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, u, 0, NULL, NULL, NULL, err);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return err->status;
}

int main(void) {
    static double xyz[3 * N], u[N], alone[N];
    static int32_t tri[6 * N];
    hd_context jobs_context = {0}, serial = {0};
    job_system jobs;
    hd_error err;
    hd_status status;
    double since;

    make_torus(xyz, tri);
    jobs_start(&jobs);
    jobs_context.parallel_for = jobs_for;
    jobs_context.parallel_user = &jobs;
    serial.n_threads = 1;

    since = seconds();
    status = signature(&serial, xyz, tri, alone, &err);
    printf("without threads:     %.2f s of processor time\n", seconds() - since);
    since = seconds();
    if (status >= 0) status = signature(&jobs_context, xyz, tri, u, &err);
    printf("with the job system: %.2f s of processor time, on all of its threads together\n", seconds() - since);
    jobs_end(&jobs);
    if (status < 0) return fprintf(stderr, "job_system: %s: %s\n", hd_status_name(status), err.text), 1;
    printf("%ld loops, %ld tasks done by other threads, signature of vertex 0: %.12f\n", (long)jobs.loops, (long)jobs.by_helpers, u[0]);
    if (memcmp(u, alone, sizeof u) != 0) return puts("the answers differ"), 1;
    puts("the answers are the same to the last bit");
    return 0;
}
