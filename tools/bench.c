/* bench.c - the speed of heatdiff.h, compared with other libraries and with what the machine can do

       bench [--threads LIST] [--jobs LIST] [--columns K] [--seconds S] [--umfpack] [--fresh] [--csv]
             [MESH ...]
       bench parts [MESH ...]
       bench busy [--threads N] [--seconds S] [MESH ...]
       bench estimate|choices [MESH ...]

   Build:  cc -O2 tools/bench.c -o bench -lm
   With the rivals (see bench_rivals.h; CMake does this if it finds them):
       c++ -std=c++17 -O3 -march=native -DNDEBUG -fopenmp -I/usr/include/eigen3 -c tools/bench_rivals.cpp
       cc -O2 -fopenmp -DHEATDIFF_BENCH_RIVALS tools/bench.c bench_rivals.o -o bench \
          -lumfpack -lcholmod -lopenblas -lstdc++ -lm
   For the eigenpairs of the job signature, add -DHEATDIFF_BENCH_ARPACK to the first and -larpack to the
   second.

   Jobs, by default all:
       one        one column, t = 100 h^2, from (L, B) to the answer
       small      the same for t = h^2 and 10 h^2, with the masses fem and voronoi-cot
       columns    100 columns, t = 100 h^2
       further    one more column after everything is factorised
       times      one column at 16 times from 10 to 10^4 h^2
       stages     ordering, analysis, four complex factors and their solves, on one thread and on all
       geodesic   distances by the heat method from one source and from further ones, each alone and eight at
                  a time. CGAL runs on one thread. Errors: largest difference from CGAL, with its shift of
                  1e-8 reduced to 1e-14, relative to the largest distance
       signature  heat kernel signature of every vertex, t = 10 h^2 and 100 h^2, from (L, B) to the answer.
                  The rival computes the smallest 300 eigenpairs by ARPACK, above 60000 rows only on request.
                  Also: the stages at 100 h^2 (the inversion beside the rival's Lanczos; the check of rounding
                  is a column), the time as a multiple of four complex factors, 16 and 100 times from 10 to
                  10^4 h^2, and classical distances from one vertex to all at 100 h^2 as multiples of one
                  signature
       assembly   (L, B) from the triangles, masses fem and voronoi-cot, on one thread. The rival is lists of
                  triplets from which Eigen makes two matrices. Ours also finds edges, components and defects.
                  Errors: largest difference between both, relative to the largest entry
       pairs      the smallest 500 eigenpairs, from (L, B) to the vectors, by hd_spectrum_create with its proof
                  that none is missing, and by ARPACK on one factor. Both with the tolerance 1e-10. Errors:
                  the largest |L x - lambda B x| of each, in the norm of diag(B)^-1, relative to lambda.
                  Above 60000 rows the rival runs only on request
       eigen      Eigen's SimplicialLDLT; one column through the poles by UMFPACK and by Eigen's SparseLU.
                  Slow: above 60000 rows only on request

   estimate compares what hd_heat_estimate says with what a run takes. choices times all methods for columns
   and says how often the default is the fastest.

   How it is measured. Both sides start with the same two matrices in memory and use the same number of
   threads. After a warm-up they take turns, and the best run of each counts; only freeing is left out. A
   rival that takes more than ten seconds for signatures runs once.

   Accuracy. Every adjustable accuracy is set, outside the measured time, to the least work that reaches an
   error of 1e-7 relative to the largest value of a column: tol for us, the number of Lanczos steps for them.
   UMFPACK and SparseLU use the best uniform poles of degree 7, with the error that this gives. Errors are
   differences from the direct method with kernel poles of degree 14; for many times, from a rival's Lanczos
   with full reorthogonalisation. The two references are compared with each other. Errors of signatures are
   the largest over the vertices, relative to the vertex's own value, at 10, 100 and 10^4 h^2. The 300
   eigenpairs have the error of all that they leave out.

   Memory. With the GNU library, memory freed by one run stays in the process for the next. Fresh pages cost
   time that says more about the machine than about either side, above all on virtual machines. --fresh leaves
   malloc as it is.

   The table shows ms, the ratio rival's time / ours, and errors; then for us GF/s of the factorisation and
   its share of the machine's fused multiply-adds, GB/s of factors read in solves, non-zeros of L, peak bytes,
   and these bytes over 64 bytes for each non-zero, the least that four complex factors need; last the rival's
   non-zeros and bytes. Stages are named by the library's progress callback. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "bench_rivals.h"
#include "meshio.h"
#include "shapes.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#ifdef HEATDIFF_BENCH_RIVALS
enum { HAVE_RIVALS = 1 };
#else
enum { HAVE_RIVALS = 0 };
static int rival_absent(rival_result *r) { memset(r, 0, sizeof *r); return 0; }
int rival_silan(const rival_job *job, double *U,
                rival_result *r) { (void)job; (void)U; return rival_absent(r); }
int rival_silan_block(const rival_job *job, double *U,
                      rival_result *r) { (void)job; (void)U; return rival_absent(r); }
int rival_silan_times(const rival_job *job, double *U,
                      rival_result *r) { (void)job; (void)U; return rival_absent(r); }
int rival_umfpack(const rival_job *job, const rival_poles *p, double *U,
                  rival_result *r) { (void)p; return rival_silan(job, U, r); }
int rival_eigen_lu(const rival_job *job, const rival_poles *p, double *U,
                   rival_result *r) { (void)p; return rival_silan(job, U, r); }
int rival_eigen_ldlt(const rival_job *job, double *U,
                     rival_result *r) { (void)job; (void)U; return rival_absent(r); }
int rival_eigenpairs(const rival_job *job, double *U,
                     rival_result *r) { (void)job; (void)U; return rival_absent(r); }
int rival_reference(const rival_job *job, double *U,
                    rival_result *r) { (void)job; (void)U; return rival_absent(r); }
int rival_assembly(const rival_mesh *mesh, int voronoi, const rival_pair *check,
                   rival_result *r) { (void)mesh; (void)voronoi; (void)check; return rival_absent(r); }
int rival_geodesic(const rival_mesh *mesh, double shift, int32_t k, const int32_t *s, double *D,
                   rival_result *r) {
    (void)mesh; (void)shift; (void)k; (void)s; (void)D;
    return rival_absent(r);
}
void rival_machine(int32_t threads,
                   rival_machine_result *r) { (void)threads; memset(r, 0, sizeof *r); r->simd = r->blas = "";
                                              }
#endif

static double now(void) {
#if defined(CLOCK_MONOTONIC)
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
#else
    return (double)clock() / CLOCKS_PER_SEC;
#endif
}

/* ==== parts ==== */

/* Bytes per second that memcpy moves, reading and writing counted, over blocks of `bytes` altogether. */
static double copy_speed(size_t bytes) {
    const size_t half = bytes / 2 + 64;
    char *a = (char *)malloc(half), *b = (char *)malloc(half);
    double best = 1e30;
    int r, k, reps = (int)(200000000 / half) + 1;
    if (!a || !b) return 0;
    memset(a, 1, half);
    memset(b, 2, half);
    for (r = 0; r < 7; r++) {
        const double t0 = now();
        for (k = 0; k < reps; k++) {
            memcpy(b, a, half);
            a[k % 64] = b[(k + 1) % 64];
        }
        if ((now() - t0) / reps < best) best = (now() - t0) / reps;
    }
    free(a);
    free(b);
    return 2.0 * (double)half / best;
}

static void line(const char *what, double seconds, double bytes, double speed) {
    printf("  %-34s %9.3f ms   floor %8.3f ms   ratio %.2f   %.1f GB/s\n", what, 1e3 * seconds,
           1e3 * bytes / speed, seconds * speed / bytes, 1e-9 * bytes / seconds);
}

static double time_apply(const hd_laplacian *lap, const double *x, double *y) {
    double best = 1e30;
    int r, k, reps = (int)(20000000 / (lap->L.nnz + 1)) + 1;
    for (r = 0; r < 7; r++) {
        const double t0 = now();
        for (k = 0; k < reps; k++) hdi_pair_apply(lap, 1, 0, x, y);
        if ((now() - t0) / reps < best) best = (now() - t0) / reps;
    }
    return best;
}

static double time_system(const hdi_system *a, const hd_c64 *x, hd_c64 *y) {
    double best = 1e30;
    int r, k, reps = (int)(10000000 / (a->lap->L.nnz + 1)) + 1;
    for (r = 0; r < 7; r++) {
        const double t0 = now();
        for (k = 0; k < reps; k++) (void)hdi_system_apply(a, x, y);
        if ((now() - t0) / reps < best) best = (now() - t0) / reps;
    }
    return best;
}

static double time_precond(const hdi_precond *m, const hd_c64 *x, hd_c64 *y) {
    double best = 1e30;
    int r, k, reps = (int)(5000000 / (m->up->ptr[m->up->n] + 1)) + 1;
    for (r = 0; r < 7; r++) {
        const double t0 = now();
        for (k = 0; k < reps; k++) m->row->apply(m, x, y, NULL);
        if ((now() - t0) / reps < best) best = (now() - t0) / reps;
    }
    return best;
}

static void parts_products(hd_heat *heat, double t) {
    const hd_laplacian *lap = heat->fam.lap;
    const size_t n = (size_t)lap->n_active;
    const double nnz = (double)lap->L.nnz, dn = (double)n;
    double *x = (double *)calloc(4 * n, sizeof *x), *y = x + 2 * n, bytes;
    hdi_system a;
    size_t i;
    if (!x) return;
    for (i = 0; i < 2 * n; i++) x[i] = 1 + (double)(i % 7);
    bytes = 12 * nnz + 8 * (dn + 1) + 16 * dn;
    line("L x, real", time_apply(lap, x, y), bytes, copy_speed((size_t)bytes));
    a.lap = lap;
    a.t = t;
    a.theta = hdi_c(2.4, 2.4);
    bytes = (lap->B ? 20 : 12) * nnz + 8 * (dn + 1) + (lap->B ? 32 : 40) * dn;
    line("(t L + theta B) x, complex", time_system(&a, (hd_c64 *)(void *)x, (hd_c64 *)(void *)y), bytes,
         copy_speed((size_t)bytes));
    bytes = 20 * (double)heat->fam.up.ptr[n] + 8 * dn + 16 * dn + 32 * dn;
    if (heat->fam.filled) {
        const double seconds = time_precond(&heat->lane->k->m, (hd_c64 *)(void *)x, (hd_c64 *)(void *)y);
        line("modified ILDL(0) solve, complex", seconds, 2 * bytes, copy_speed((size_t)bytes));
    }
    free(x);
}

static void parts_solvers(const hd_laplacian *lap) {
    static const hd_solver solvers[] = {HD_SOLVER_COCG, HD_SOLVER_LANCZOS};
    static const double taus[] = {1, 10, 100, 1000};
    double *u = (double *)malloc((size_t)lap->n * sizeof *u);
    size_t s, k;
    for (s = 0; u && s < 2; s++) {
        for (k = 0; k < 4; k++) {
            hd_heat_opts o;
            hd_heat *heat = NULL;
            hd_report rep;
            double t0, t1, t2;
            memset(&o, 0, sizeof o);
            o.solver = solvers[s];
            if (o.solver == HD_SOLVER_LANCZOS && taus[k] > 100) continue;
            t0 = now();
            if (hd_heat_create(&heat, lap, &o, NULL) < 0) continue;
            t1 = now();
            if (hd_heat_column(heat, HD_KERNEL_OPERATOR, taus[k] * lap->h * lap->h, lap->vertex[lap->n_active / 2], u, &rep, NULL) >= 0) {
                t2 = now();
                printf("  column, t = %4g h^2, %-8s plan %7.1f ms, solve %8.1f ms, %5lld steps, %.3f ms a "
                       "step\n", taus[k],
                       s == 0 ? "cocg" : "lanczos", 1e3 * (t1 - t0), 1e3 * (t2 - t1),
                       (long long)rep.iterations, 1e3 * (t2 - t1) / (double)rep.iterations);
            }
            if (s == 0 && k == 2) parts_products(heat, 100 * lap->h * lap->h);
            hd_heat_free(heat);
        }
    }
    free(u);
}

static void parts_mesh(const char *name, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri) {
    static const hd_laplacian_kind kinds[] = {HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_FEM};
    int k;
    for (k = 0; k < 2; k++) {
        hd_laplacian *lap = NULL;
        hd_laplacian_opts o;
        double t0 = now(), t1;
        memset(&o, 0, sizeof o);
        o.kind = kinds[k];
        if (hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, n_tri), &o, NULL) < 0) return;
        t1 = now();
        printf("%s, %s: %d vertices, %lld non-zeros, assembled in %.1f ms\n", name, k ? "fem" : "voronoi-cot",
               (int)n, (long long)lap->L.nnz, 1e3 * (t1 - t0));
        parts_solvers(lap);
        hd_laplacian_free(lap);
    }
}

/* ==== the machine ==== */

#if HDI_X86
/* Flops of independent sums: enough of them to hide the latency of the multiply-add, few enough for the
 * registers. */
HDI_AVX512 static double multiply_add_512(int64_t rounds, volatile double *sink) {
    const __m512d m = _mm512_set1_pd(0.999999999), a = _mm512_set1_pd(1e-9);
    __m512d s0 = a, s1 = a, s2 = a, s3 = a, s4 = a, s5 = a, s6 = a, s7 = a, s8 = a, s9 = a;
    int64_t k;
    for (k = 0; k < rounds; k++) {
        s0 = _mm512_fmadd_pd(s0, m, a); s1 = _mm512_fmadd_pd(s1, m, a);
        s2 = _mm512_fmadd_pd(s2, m, a); s3 = _mm512_fmadd_pd(s3, m, a);
        s4 = _mm512_fmadd_pd(s4, m, a); s5 = _mm512_fmadd_pd(s5, m, a);
        s6 = _mm512_fmadd_pd(s6, m, a); s7 = _mm512_fmadd_pd(s7, m, a);
        s8 = _mm512_fmadd_pd(s8, m, a); s9 = _mm512_fmadd_pd(s9, m, a);
    }
    s0 = _mm512_add_pd(_mm512_add_pd(_mm512_add_pd(s0, s1), _mm512_add_pd(s2, s3)),
                       _mm512_add_pd(_mm512_add_pd(s4, s5), _mm512_add_pd(s6, s7)));
    *sink = _mm512_reduce_add_pd(_mm512_add_pd(s0, _mm512_add_pd(s8, s9)));
    return 160.0 * (double)rounds;
}

HDI_AVX2 static double multiply_add_256(int64_t rounds, volatile double *sink) {
    const __m256d m = _mm256_set1_pd(0.999999999), a = _mm256_set1_pd(1e-9);
    __m256d s0 = a, s1 = a, s2 = a, s3 = a, s4 = a, s5 = a, s6 = a, s7 = a, s8 = a, s9 = a;
    double out[4];
    int64_t k;
    for (k = 0; k < rounds; k++) {
        s0 = _mm256_fmadd_pd(s0, m, a); s1 = _mm256_fmadd_pd(s1, m, a);
        s2 = _mm256_fmadd_pd(s2, m, a); s3 = _mm256_fmadd_pd(s3, m, a);
        s4 = _mm256_fmadd_pd(s4, m, a); s5 = _mm256_fmadd_pd(s5, m, a);
        s6 = _mm256_fmadd_pd(s6, m, a); s7 = _mm256_fmadd_pd(s7, m, a);
        s8 = _mm256_fmadd_pd(s8, m, a); s9 = _mm256_fmadd_pd(s9, m, a);
    }
    s0 = _mm256_add_pd(_mm256_add_pd(_mm256_add_pd(s0, s1), _mm256_add_pd(s2, s3)),
                       _mm256_add_pd(_mm256_add_pd(s4, s5), _mm256_add_pd(s6, s7)));
    _mm256_storeu_pd(out, _mm256_add_pd(s0, _mm256_add_pd(s8, s9)));
    *sink = out[0];
    return 80.0 * (double)rounds;
}
#endif

/* Parallel work for measuring: multiply-adds, or a share of an array to sum. */
typedef struct load_job { int simd; const double *x; int64_t share; double flops[256]; } load_job;

static void load_task(void *arg, int64_t index, int32_t worker) {
    load_job *j = (load_job *)arg;
    volatile double sink = 0;
    (void)worker;
#if HDI_X86
    if (j->simd)
        j->flops[index] = j->simd > 1 ? multiply_add_512(10000000, &sink) : multiply_add_256(10000000, &sink);
#endif
    if (!j->simd) sink = hdi_dot(j->x + index * j->share, j->x + index * j->share, j->share);
    (void)sink;
}

/* The best of a few runs, in GF/s (simd > 0) or GB/s. */
static double load_speed(int threads, int simd, const double *x, int64_t n) {
    hd_context ctx;
    load_job j;
    double best = 0;
    int r, k;
    memset(&ctx, 0, sizeof ctx);
    memset(&j, 0, sizeof j);
    ctx.n_threads = threads;
    j.simd = simd;
    j.x = x;
    j.share = n / threads;
    hdi_hold(&ctx);
    for (r = 0; r < 5; r++) {
        const double t0 = now();
        double work = 8.0 * (double)(j.share * threads), seconds;
        hdi_parallel(&ctx, threads, load_task, &j);
        seconds = now() - t0;
        for (k = 0; simd && k < threads; k++) work = (k ? work : 0) + j.flops[k];
        if (work / seconds > best) best = work / seconds;
    }
    hdi_let_go(&ctx);
    return 1e-9 * best;
}

/* ==== one of our runs ==== */

enum { STAGE_OTHER, STAGE_ORDER, STAGE_ANALYSE, STAGE_FACTOR, STAGE_INVERT, STAGE_SOLVE, STAGES };

/* Stage times, from the library's progress calls. Time after the last call belongs to its stage. */
typedef struct watch { const char *name; int stage; double since, seconds[STAGES]; } watch;

static void watch_turn(watch *w, int stage) {
    const double t = now();
    w->seconds[w->stage] += t - w->since;
    w->since = t;
    w->stage = stage;
}

static hd_progress watch_progress(void *user, const char *name, double done) {
    static const char *const names[STAGES] = {"", "order", "analyse", "factor", "invert", "solve"};
    watch *w = (watch *)user;
    int k;
    (void)done;
    if (name == w->name) return HD_PROGRESS_CONTINUE;
    w->name = name;
    for (k = STAGES - 1; k > 0 && strcmp(name, names[k]); k--) {}
    watch_turn(w, k);
    return HD_PROGRESS_CONTINUE;
}

static void watch_start(watch *w) {
    memset(w, 0, sizeof *w);
    w->since = now();
}

typedef struct settings {
    int jobs, csv, umfpack, fresh, columns, n_threads, asked, busy;
    int32_t threads[16];
    double seconds;
} settings;

/* A pair under test. */
typedef struct bench {
    const settings *set;
    const char *mesh, *mass;
    const hd_laplacian *lap;
    const rival_mesh *surface;
    rival_pair pair;
    double *own_B;
    int32_t threads;
    double hh, peak[2];          /* h^2; GF/s on one thread and on all */
    rival_ordering ordering;     /* that suits shift-invert Lanczos best, once known */
} bench;

/* What to ask the library for: columns at times[0], or one at many times; the diagonal of k_t at all times;
 * distances from the first vertex at times[0]. */
typedef enum query { COLUMNS, DIAGONAL, DISTANCES } query;

typedef struct ask {
    query what;
    hd_method method;
    int32_t degree;              /* of kernel poles, 0: the library's choice */
    double tol;                  /* 0: the library's */
    int32_t n_times, n_columns;
    const double *times;
    const int32_t *vertices;
} ask;

typedef struct ours {
    int fine;
    double total, stage[STAGES], bytes, error;
    hd_report report;
} ours;

/* A plan and what it reports to. */
typedef struct plan { hd_context ctx; watch w; hd_heat *heat; } plan;

/* A context of as many threads as are measured. */
static hd_context bench_context(const bench *b) {
    hd_context ctx;
    memset(&ctx, 0, sizeof ctx);
    ctx.n_threads = b->threads;
    return ctx;
}

static hd_status plan_open(plan *p, const bench *b, const ask *a) {
    hd_heat_opts o;
    memset(p, 0, sizeof *p);
    memset(&o, 0, sizeof o);
    p->ctx.n_threads = b->threads;
    p->ctx.progress = watch_progress;
    p->ctx.progress_user = &p->w;
    o.context = &p->ctx;
    o.method = a->method;
    o.degree = a->degree;
    o.poles = a->degree ? HD_POLES_KERNEL : HD_POLES_DEFAULT;
    o.tol = a->tol;
    watch_start(&p->w);
    return hd_heat_create(&p->heat, b->lap, &o, NULL);
}

static void plan_close(plan *p) { hd_heat_free(p->heat); }

static hd_status plan_call(hd_heat *heat, const ask *a, double *U, hd_report *r) {
    if (a->what == DIAGONAL)
        return hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, a->n_times, a->times, U, 0, NULL, NULL, r, NULL);
    if (a->what == DISTANCES)
        return hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, a->times, VERTICES(1, a->vertices), U, 0, r, NULL);
    return hd_heat_columns(heat, HD_KERNEL_OPERATOR, a->n_times, a->times, VERTICES(a->n_columns, a->vertices), U, 0, r, NULL);
}

/* Runs what is asked for on the plan; times since watch_start. */
static void plan_run(plan *p, const ask *a, double *U, ours *out) {
    const hd_status st = plan_call(p->heat, a, U, &out->report);
    int k;
    watch_turn(&p->w, STAGE_OTHER);
    out->fine = st >= 0;
    out->bytes = (double)p->ctx.bytes_peak;
    for (out->total = 0, k = 0; k < STAGES; k++) out->total += out->stage[k] = p->w.seconds[k];
    p->w.name = NULL;
    if (st < 0) fprintf(stderr, "bench: %s: %s\n", hd_status_name(st), out->report.error.text);
}

/* From (L, B) to the answer. */
static void run_cold(const bench *b, const ask *a, double *U, ours *out) {
    plan p;
    memset(out, 0, sizeof *out);
    if (plan_open(&p, b, a) >= 0) plan_run(&p, a, U, out);
    plan_close(&p);
}

/* Largest error of the first columns, relative to each column's largest value. U by vertices, R by rows. */
static double error_of(const bench *b, const double *U, const double *R, int n) {
    double worst = 0;
    int32_t i;
    int c;
    for (c = 0; c < n; c++) {
        const double *u = U + (size_t)c * (size_t)b->lap->n, *r = R + (size_t)c * (size_t)b->pair.n;
        double e = 0, m = 0;
        for (i = 0; i < b->pair.n; i++) {
            const double d = fabs(u[b->lap->vertex[i]] - r[i]);
            if (!(d <= e)) e = d;
            if (fabs(r[i]) > m) m = fabs(r[i]);
        }
        if (!(e / m <= worst)) worst = e / m;
    }
    return worst;
}

/* Columns, or one column at all times, by rows in place: U [n x k] becomes R [rows x k]. */
static void vertices_to_rows(const bench *b, double *U, int k) {
    const size_t n = (size_t)b->lap->n, rows = (size_t)b->pair.n;
    size_t c, i;
    for (c = 0; c < (size_t)k; c++)
        for (i = 0; i < rows; i++) U[c * rows + i] = U[c * n + (size_t)b->lap->vertex[i]];
}

static int many(const ask *a) { return a->n_times > 1 ? a->n_times : a->n_columns; }

/* An array that has been written to, so that no fresh page falls into the measured time. */
static double *answers(const bench *b, int k) {
    const size_t bytes = (size_t)b->lap->n * (size_t)k * sizeof(double);
    double *u = (double *)malloc(bytes + 64);
    if (u) memset(u, 1, bytes + 64);
    else fprintf(stderr, "bench: out of memory\n");
    return u;
}

static const double TARGET = 1e-7;

/* References for the first k columns (or all times) of what is asked for, by rows; NULL when there are
 * none. */
static double *reference(const bench *b, const ask *a, int k) {
    double *R = answers(b, k);
    ask exact = *a;
    ours run;
    if (!R) return NULL;
    if (HAVE_RIVALS && a->n_times > 1) {
        rival_job job;
        rival_result r;
        const int32_t row = b->lap->row[a->vertices[0]];
        memset(&job, 0, sizeof job);
        job.pair = &b->pair;
        job.n_times = a->n_times;
        job.times = a->times;
        job.n_sources = 1;
        job.sources = &row;
        job.threads = b->threads;
        if (rival_reference(&job, R, &r)) return R;
        fprintf(stderr, "bench: %s\n", r.note);
    }
    exact.method = HD_METHOD_DIRECT;
    exact.degree = 14;
    exact.tol = 0;
    if (a->n_times == 1) exact.n_columns = k;
    run_cold(b, &exact, R, &run);
    if (run.fine) {
        vertices_to_rows(b, R, k);
        return R;
    }
    free(R);
    return NULL;
}

/* The largest tol that reaches the target on a kept plan, then on a fresh one, which may choose another method
 * for another tol. Not timed. 0 where tol has no effect. */
static double find_tol(const bench *b, const ask *a, const double *R, double *U) {
    enum { GRID = 88 };          /* 10^(-1 - q/8) */
    ask probe = *a;
    ours run;
    plan p;
    int low = -1, high = GRID, tries;
    if (!R || plan_open(&p, b, a) < 0) return 0;
    memset(&run, 0, sizeof run);
    plan_run(&p, a, U, &run);
    if (!run.fine || run.report.method == HD_METHOD_DIRECT) {
        plan_close(&p);
        return 0;
    }
    while (high - low > 1) {     /* low misses the target, high is taken to reach it */
        const int q = (low + high) / 2;
        p.heat->opts.tol = pow(10, -1 - q / 8.0);
        plan_run(&p, a, U, &run);
        if (run.fine && error_of(b, U, R, many(a)) <= TARGET) high = q;
        else low = q;
    }
    plan_close(&p);
    for (tries = 0; high + tries <= GRID; tries++) {
        probe.tol = pow(10, -1 - (high + tries) / 8.0);
        run_cold(b, &probe, U, &run);
        if (run.fine && error_of(b, U, R, many(a)) <= TARGET) break;
    }
    return probe.tol;
}

/* ==== the table ==== */

typedef struct entry {
    const char *job, *part;      /* part: a stage of the job, or NULL */
    double tau;                  /* t / h^2; 0: none */
    int32_t threads;
    char ours[40], rival[40];
    double seconds, rival_seconds, error, rival_error;   /* errors -1: none */
    double gflops, gbytes, nnz, bytes, rival_nnz, rival_bytes;
    int packs;                   /* 1: bytes are to be held against 64 a non-zero */
} entry;

static void row_clear(entry *r, const bench *b, const char *job, const char *part, double tau) {
    memset(r, 0, sizeof *r);
    r->job = job;
    r->part = part;
    r->tau = tau;
    r->threads = b->threads;
    r->error = r->rival_error = -1;
}

/* Prints a number with this many digits, or a dash if there is none. */
static void cell(int width, const char *format, double x, int there) {
    char text[32];
    snprintf(text, sizeof text, format, x);
    printf("%*s", width, there ? text : "-");
}

static double row_share(const entry *r, const bench *b) { return r->gflops / b->peak[r->threads > 1]; }

static void row_csv(const entry *r, const bench *b) {
    const double ratio = r->rival_seconds > 0 ? r->rival_seconds / r->seconds : 0, share = b->peak[0] > 0
                         ? row_share(r, b) : 0;
    const double packs = r->packs && r->nnz > 0 ? r->bytes / (64 * r->nnz) : 0;
    printf("%s,%s,%d,\"%s%s%s\",%g,", b->mesh, b->mass, (int)b->pair.n, r->job, r->part ? ": " : "",
           r->part ? r->part : "", r->tau);
    printf("%d,\"%s\",%.6g,\"%s\",%.6g,%.4g,%.3g,%.3g,", (int)r->threads, r->ours, r->seconds, r->rival,
           r->rival_seconds, ratio, r->error, r->rival_error);
    printf("%.4g,%.4g,%.4g,%.0f,%.0f,%.4g,%.0f,%.0f\n", r->gflops, share, r->gbytes, r->nnz, r->bytes, packs,
           r->rival_nnz, r->rival_bytes);
}

static void row_print(const entry *r, const bench *b) {
    if (b->set->csv) {
        row_csv(r, b);
    } else {
        printf("%s%-*s", r->part ? "  " : "", r->part ? 16 : 18, r->part ? r->part : r->job);
        cell(6, "%g", r->tau, r->tau > 0);
        printf("%3d  %-22.22s", (int)r->threads, r->ours);
        cell(10, "%.2f", 1e3 * r->seconds, r->seconds > 0);
        printf("  %-22.22s", r->rival);
        cell(10, "%.2f", 1e3 * r->rival_seconds, r->rival_seconds > 0);
        cell(7, "%.2f", r->rival_seconds / r->seconds, r->rival_seconds > 0 && r->seconds > 0);
        cell(9, "%.1e", r->error, r->error >= 0);
        cell(9, "%.1e", r->rival_error, r->rival_error >= 0);
        cell(8, "%.1f", r->gflops, r->gflops > 0);
        cell(5, "%.0f%%", 100 * row_share(r, b), r->gflops > 0 && b->peak[0] > 0);
        cell(6, "%.1f", r->gbytes, r->gbytes > 0);
        cell(11, "%.0f", r->nnz, r->nnz > 0);
        cell(8, "%.0f", 1e-6 * r->bytes, r->bytes > 0);
        cell(6, "%.2f", r->bytes / (64 * r->nnz), r->packs && r->bytes > 0);
        cell(11, "%.0f", r->rival_nnz, r->rival_nnz > 0);
        cell(8, "%.0f", 1e-6 * r->rival_bytes, r->rival_bytes > 0);
        printf("\n");
    }
    fflush(stdout);
}

static void table_head(const bench *b) {
    if (b->set->csv) return;
    printf("%-18s%6s%3s  %-22s%10s  %-22s%10s%7s%9s%9s", "job", "t/h2", "th", "ours", "ms", "rival", "ms",
           "ratio", "error", "rival's");
    printf("%8s%5s%6s%11s%8s%6s%11s%8s\n", "GF/s", "peak", "GB/s", "nnz(L)", "MB", "/64B", "rival nnz", "MB");
    fflush(stdout);
}

static const char *ordering_name(hd_ordering o) {
    return o == HD_ORDERING_MINIMUM_DEGREE ? " md" : o == HD_ORDERING_NESTED_DISSECTION ? " nd"
           : o == HD_ORDERING_OWN ? " own" : "";
}

static void describe_ours(char *to, size_t size, const ask *a, const ours *o) {
    const hd_report *r = &o->report;
    const char *asked = a->method == HD_METHOD_AUTO ? "auto: " : "", *order = ordering_name(r->ordering);
    const long long steps = (long long)r->iterations / a->n_times;   /* of many times: on average */
    if (!o->fine) snprintf(to, size, "failed");
    else if (r->method == HD_METHOD_DIRECT)
        snprintf(to, size, "%sdirect r=%d%s", asked, (int)r->degree, order);
    else if (r->method >= HD_METHOD_KRYLOV)
        snprintf(to, size, "%s%s %lld%s", asked, r->method == HD_METHOD_LOCAL ? "local" : "krylov", steps, order);
    else snprintf(to, size, "%s%s %lld", asked, r->solver == HD_SOLVER_LANCZOS ? "lanczos" : "cocg", steps);
}

/* Our part of a row. GB/s are given where it is clear what a solve reads: for one column, shift-and-invert
 * Lanczos reads the factor twice in each step. */
static void row_ours(entry *r, const ask *a, const ours *o) {
    const hd_report *rep = &o->report;
    const double solve = o->stage[STAGE_SOLVE], factor = o->stage[STAGE_FACTOR];
    describe_ours(r->ours, sizeof r->ours, a, o);
    if (!o->fine) return;
    r->seconds = o->total;
    r->error = o->error;
    r->nnz = (double)rep->factor_nnz;
    r->bytes = o->bytes;
    r->packs = rep->method == HD_METHOD_DIRECT;
    if (factor > 0 && a->n_times == 1 && rep->method != HD_METHOD_ITERATIVE)
        r->gflops = 1e-9 * rep->factor_flops / factor;
    if (solve > 0 && rep->method == HD_METHOD_KRYLOV && a->n_columns == 1 && a->n_times == 1)
        r->gbytes = 16e-9 * r->nnz * (double)rep->iterations / solve;
}

/* ==== contests ==== */

typedef enum rival_kind { SILAN, SILAN_BLOCK, SILAN_TIMES, UMFPACK, EIGEN_LU } rival_kind;

typedef struct opponent {
    rival_kind kind;
    rival_job job;
    rival_window window[RIVAL_MAX_WINDOWS];
    rival_result best;
    int fine;
} opponent;

static int rival_run(const opponent *o, rival_result *r) {
    hd_rational set;
    rival_poles poles;
    (void)hd_rational_exp(&set, HD_POLES_UNIFORM, 7, NULL);
    poles.n = set.n_poles;
    poles.a0 = set.a0;
    poles.theta = &set.theta[0].re;
    poles.a = &set.a[0].re;
    switch (o->kind) {
        case SILAN: return rival_silan(&o->job, NULL, r);
        case SILAN_BLOCK: return rival_silan_block(&o->job, NULL, r);
        case SILAN_TIMES: return rival_silan_times(&o->job, NULL, r);
        case UMFPACK: return rival_umfpack(&o->job, &poles, NULL, r);
        default: return rival_eigen_lu(&o->job, &poles, NULL, r);
    }
}

static double rival_seconds(const opponent *o, const rival_result *r) {
    return o->job.n_sources > 1 ? r->total_columns : r->total;
}

/* The same job for a rival. rows [columns]: the sources, which must stay. */
static opponent opponent_make(const bench *b, rival_kind kind, const ask *a, const int32_t *rows,
                              const double *R, int n_R) {
    opponent o;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.job.pair = &b->pair;
    o.job.n_times = a->n_times;
    o.job.times = a->times;
    o.job.n_sources = a->n_columns;
    o.job.sources = rows;
    o.job.reference = R;
    o.job.n_reference = n_R;
    o.job.target = TARGET;
    o.job.threads = b->threads;
    if (kind == SILAN) o.job.ordering = b->ordering;
    if (b->pair.n > 400000) o.job.seconds = b->set->seconds;
    return o;
}

/* The warm-up, in which a rival finds its best ordering, steps and windows. Later runs reuse them. */
static void opponent_warm(opponent *o) {
    rival_result r;
    o->fine = rival_run(o, &r);
    o->best = r;
    if (!o->fine) return;
    o->job.ordering = r.ordering;
    o->job.steps = o->kind == SILAN || o->kind == SILAN_BLOCK ? r.steps : 0;
    if (o->kind != SILAN_TIMES) return;
    memcpy(o->window, r.window, sizeof o->window);
    o->job.window = o->window;
    o->job.n_windows = r.windows;
}

static void opponent_turn(opponent *o, int first) {
    rival_result r;
    if (!o->fine || !rival_run(o, &r)) return;
    if (first || rival_seconds(o, &r) < rival_seconds(o, &o->best)) o->best = r;
}

/* Waits until the threads of the rivals stop spinning, so that they do not slow down the other side. */
static void rest(void) {
#if defined(CLOCK_MONOTONIC)
    struct timespec t = {0, 60000000};
    nanosleep(&t, NULL);
#endif
}

/* Seven rounds; fewer if they take long, but at least two. */
static int round_wanted(const bench *b, int round, double start) {
    return round < 2 || (round < 7 && now() - start < b->set->seconds);
}

/* Both sides in turns after a warm-up. Keeps our best run by total time, with the error of the last run (all
 * runs have the same error). */
static void contest(const bench *b, const ask *a, const double *R, int n_R, double *U, ours *best,
                    opponent *o, int n_o) {
    double start;
    int k, round;
    run_cold(b, a, U, best);
    for (k = 0; k < n_o; k++) opponent_warm(o + k);
    start = now();
    for (round = 0; best->fine && round_wanted(b, round, start); round++) {
        ours run;
        rest();
        run_cold(b, a, U, &run);
        if (round == 0 || run.total < best->total) *best = run;
        for (k = 0; k < n_o; k++) {
            rest();
            opponent_turn(o + k, round == 0);
        }
    }
    best->error = best->fine && R ? error_of(b, U, R, n_R) : -1;
}

static void describe_rival(char *to, size_t size, const opponent *o) {
    static const char *const names[] = {"SI-Lanczos", "SI-Lanczos", "SI-Lanczos", "UMFPACK", "SparseLU"};
    const rival_result *r = &o->best;
    const char *order = o->kind == EIGEN_LU ? " colamd" : r->ordering == RIVAL_METIS ? " metis" : " amd";
    if (!o->fine) snprintf(to, size, "%s: %.20s", names[o->kind], r->note);
    else if (o->kind == UMFPACK || o->kind == EIGEN_LU) snprintf(to, size, "%s r=7%s", names[o->kind], order);
    else if (o->kind == SILAN_BLOCK)
        snprintf(to, size, "%s %d x%d%s", names[o->kind], (int)r->steps, (int)r->width, order);
    else snprintf(to, size, "%s %d%s", names[o->kind], (int)r->steps, order);
}

static void row_rival(entry *r, const opponent *o) {
    describe_rival(r->rival, sizeof r->rival, o);
    if (!o->fine) return;
    r->rival_seconds = rival_seconds(o, &o->best);
    r->rival_error = o->best.error;
    r->rival_nnz = o->best.nnz;
    r->rival_bytes = o->best.bytes;
}

static void contest_rows(const bench *b, const char *job, const ask *a, const ours *best, const opponent *o,
                         int n_o) {
    int k = 0;
    do {
        entry r;
        row_clear(&r, b, job, NULL, a->n_times > 1 ? 0 : a->times[0] / b->hh);
        row_ours(&r, a, best);
        if (n_o > 0) row_rival(&r, o + k);
        row_print(&r, b);
    } while (++k < n_o);
}

/* The stages of the two best runs. */
static void stage_rows(const bench *b, const char *job, const ours *best, const opponent *o) {
    static const char *const names[] = {"order + analyse", "factor", "solve"};
    const double *s = best->stage, mine[] = {s[STAGE_OTHER] + s[STAGE_ORDER] + s[STAGE_ANALYSE],
                                             s[STAGE_FACTOR], s[STAGE_SOLVE]};
    const double theirs[] = {o->best.analyse, o->best.factor, o->best.first};
    int k;
    for (k = 0; k < 3; k++) {
        entry r;
        row_clear(&r, b, job, names[k], 0);
        r.seconds = mine[k];
        if (o->fine) r.rival_seconds = theirs[k];
        row_print(&r, b);
    }
}

/* ==== jobs ==== */

static ask ask_column(hd_method method, const double *t, const int32_t *vertex) {
    ask a;
    memset(&a, 0, sizeof a);
    a.method = method;
    a.n_times = a.n_columns = 1;
    a.times = t;
    a.vertices = vertex;
    return a;
}

static int32_t middle(const bench *b) { return b->pair.n / 2; }

/* One column against shift-invert Lanczos, with the ordering that suits it remembered. Returns the method. */
static hd_method one_column(bench *b, const char *job, hd_method method, double tau, const double *R,
                            double *U, int stages) {
    const double t = tau * b->hh;
    const int32_t row = middle(b), vertex = b->lap->vertex[row];
    ask a = ask_column(method, &t, &vertex);
    opponent o = opponent_make(b, SILAN, &a, &row, R, 1);
    ours best;
    a.tol = find_tol(b, &a, R, U);
    contest(b, &a, R, 1, U, &best, &o, HAVE_RIVALS);
    if (o.fine) b->ordering = o.best.ordering;
    contest_rows(b, job, &a, &best, &o, HAVE_RIVALS);
    if (stages && best.fine && best.report.method != HD_METHOD_ITERATIVE) stage_rows(b, job, &best, &o);
    return best.report.method;
}

/* How far the two references are from each other. */
static void compare_references(const bench *b, double t, const double *R) {
    const int32_t row = middle(b);
    double *S, e = 0, m = 0;
    rival_job job;
    rival_result r;
    int32_t i;
    if (!HAVE_RIVALS || !(S = answers(b, 1))) return;
    memset(&job, 0, sizeof job);
    job.pair = &b->pair;
    job.n_times = job.n_sources = 1;
    job.times = &t;
    job.sources = &row;
    job.threads = b->threads;
    if (rival_reference(&job, S, &r)) {
        for (i = 0; i < b->pair.n; i++) {
            e = hdi_max(e, fabs(S[i] - R[i]));
            m = hdi_max(m, fabs(R[i]));
        }
        printf("%s  references: direct of degree 14 and reorthogonalised Lanczos differ by %.1e\n",
               b->set->csv ? "# " : "", e / m);
    }
    free(S);
}

static void job_one(bench *b) {
    const double t = 100 * b->hh;
    const int32_t vertex = b->lap->vertex[middle(b)];
    const ask a = ask_column(HD_METHOD_AUTO, &t, &vertex);
    double *R = reference(b, &a, 1), *U = answers(b, 1);
    if (R && U) {
        if (one_column(b, "one", HD_METHOD_AUTO, 100, R, U, 1) != HD_METHOD_KRYLOV)
            (void)one_column(b, "one", HD_METHOD_KRYLOV, 100, R, U, 1);
        compare_references(b, t, R);
    }
    free(R);
    free(U);
}

static void job_small(bench *b) {
    static const double taus[] = {1, 10};
    int k;
    for (k = 0; k < 2; k++) {
        const double t = taus[k] * b->hh;
        const int32_t vertex = b->lap->vertex[middle(b)];
        const ask a = ask_column(HD_METHOD_AUTO, &t, &vertex);
        double *R = reference(b, &a, 1), *U = answers(b, 1);
        if (R && U)
            (void)one_column(b, b->lap->B ? "small, fem" : "small, voronoi", HD_METHOD_AUTO, taus[k], R, U,
                             0);
        free(R);
        free(U);
    }
}

/* Sources for many columns, all over the mesh: rows and vertices. */
static int spread(const bench *b, int k, int32_t *rows, int32_t *vertices) {
    int c;
    if (k > b->pair.n) k = b->pair.n;
    for (c = 0; c < k; c++) {
        rows[c] = (int32_t)((int64_t)b->pair.n * (2 * c + 1) / (2 * k));
        vertices[c] = b->lap->vertex[rows[c]];
    }
    return k;
}

enum { MOST_COLUMNS = 1000, REFERENCES = 8, FURTHER = 9, UMFPACK_ROWS = 300000, EIGEN_ROWS = 60000 };

static int umfpack_fits(const bench *b) {
    return HAVE_RIVALS && (b->pair.n <= UMFPACK_ROWS || b->set->umfpack);
}

static void job_columns(bench *b) {
    const double t = 100 * b->hh;
    int32_t rows[MOST_COLUMNS], vertices[MOST_COLUMNS];
    const int k = spread(b, b->set->columns, rows, vertices), n_R = k < REFERENCES ? k : REFERENCES;
    ask a = ask_column(HD_METHOD_DIRECT, &t, vertices);
    double *R, *U;
    a.n_columns = k;
    R = reference(b, &a, n_R);
    U = answers(b, k);
    if (R && U) {
        const int n_o = umfpack_fits(b) ? 2 : HAVE_RIVALS;
        opponent o[2];
        ours best;
        o[0] = opponent_make(b, SILAN_BLOCK, &a, rows, R, n_R);
        o[1] = opponent_make(b, UMFPACK, &a, rows, R, n_R);
        contest(b, &a, R, n_R, U, &best, o, n_o);
        contest_rows(b, "columns", &a, &best, o, n_o);
    }
    free(R);
    free(U);
}

/* The fastest of the columns, one by one, on a plan that already has its factors. */
static double further_columns(plan *p, ask a, double *U, ours *run) {
    const int32_t *v = a.vertices;
    double best = 1e30;
    int c;
    for (c = 0; c < FURTHER; c++) {
        a.vertices = v + c;
        watch_start(&p->w);
        plan_run(p, &a, U + (size_t)c * (size_t)p->heat->source->n, run);
        if (!run->fine) return 0;
        if (c && run->total < best) best = run->total;
    }
    return best;
}

static void job_further(bench *b) {
    const double t = 100 * b->hh;
    int32_t rows[FURTHER], vertices[FURTHER];
    const int k = spread(b, FURTHER, rows, vertices), n_o = umfpack_fits(b);
    ask a = ask_column(HD_METHOD_DIRECT, &t, vertices), all = a;
    double *R, *U = answers(b, k), best = 1e30, best_rival = 1e30, start;
    int round;
    all.n_columns = k;
    R = k == FURTHER ? reference(b, &all, k) : NULL;
    if (R && U) {
        opponent o = opponent_make(b, UMFPACK, &all, rows, R, k);
        plan p;
        ours run;
        entry r;
        memset(&run, 0, sizeof run);
        o.job.one_by_one = 1;
        if (plan_open(&p, b, &a) >= 0) (void)further_columns(&p, a, U, &run);
        if (n_o) opponent_warm(&o);
        start = now();
        for (round = 0; run.fine && round_wanted(b, round, start); round++) {
            rest();
            best = hdi_min(best, further_columns(&p, a, U, &run));
            rest();
            if (n_o) opponent_turn(&o, round == 0);
            if (o.fine) best_rival = hdi_min(best_rival, o.best.further);
        }
        row_clear(&r, b, "further", NULL, 100);
        row_ours(&r, &a, &run);
        if (n_o) row_rival(&r, &o);
        r.seconds = best;
        r.error = run.fine ? error_of(b, U, R, k) : -1;
        r.rival_seconds = o.fine ? best_rival : 0;
        row_print(&r, b);
        plan_close(&p);
    }
    free(R);
    free(U);
}

static void job_times(bench *b) {
    enum { TIMES = 16 };
    double times[TIMES], *R, *U = answers(b, TIMES);
    const int32_t row_of = middle(b), vertex = b->lap->vertex[row_of];
    ask a = ask_column(HD_METHOD_AUTO, times, &vertex);
    int k;
    for (k = 0; k < TIMES; k++) times[k] = 10 * pow(1000, k / (TIMES - 1.0)) * b->hh;
    a.n_times = TIMES;
    R = reference(b, &a, TIMES);
    if (R && U) {
        opponent o = opponent_make(b, SILAN_TIMES, &a, &row_of, R, TIMES);
        ours best;
        a.tol = find_tol(b, &a, R, U);
        contest(b, &a, R, TIMES, U, &best, &o, HAVE_RIVALS);
        contest_rows(b, "times", &a, &best, &o, HAVE_RIVALS);
        if (o.fine) printf("%s  rival's windows: %s\n", b->set->csv ? "# " : "", o.best.note);
    }
    free(R);
    free(U);
}

/* ---- stages ---- */

typedef struct stages {
    double best[STAGES], total, further, field, batch, flops, nnz, bytes, error;
} stages;

/* One dense field, and 24 columns at a time, on a plan that already has its factors. */
static void stages_warm(plan *p, const ask *a, const double *F, double *U, stages *s) {
    ask more = *a;
    ours run;
    double t0 = now();
    hd_report rep;
    memset(&run, 0, sizeof run);
    watch_start(&p->w);
    if (hd_heat_apply(p->heat, 1, &a->times[0], 1, F, 0, U, 0, &rep, NULL) >= 0)
        s->field = hdi_min(s->field, now() - t0);
    watch_turn(&p->w, STAGE_OTHER);
    if (p->w.seconds[STAGE_FACTOR] > 0) fprintf(stderr, "bench: a field made new factors\n");
    p->w.name = NULL;
    more.n_columns = 24;
    watch_start(&p->w);
    plan_run(p, &more, U, &run);
    if (run.fine && run.stage[STAGE_FACTOR] == 0) s->batch = hdi_min(s->batch, run.total / more.n_columns);
}

/* Each stage's best of several cold runs. */
static int stages_run(const bench *b, const ask *a, const double *F, const double *R, double *U, stages *s) {
    double start = 0;
    int round, k;
    memset(s, 0, sizeof *s);
    for (k = 0; k < STAGES; k++) s->best[k] = 1e30;
    s->total = s->further = s->field = s->batch = 1e30;
    for (round = -1; round < 0 || round_wanted(b, round, start); round++) {
        plan p;
        ours run;
        memset(&run, 0, sizeof run);
        if (round <= 0) start = now();
        rest();
        if (plan_open(&p, b, a) >= 0) plan_run(&p, a, U, &run);
        if (run.fine && round >= 0) {
            for (k = 0; k < STAGES; k++) s->best[k] = hdi_min(s->best[k], run.stage[k]);
            s->total = hdi_min(s->total, run.total);
            s->flops = run.report.factor_flops;
            s->nnz = (double)run.report.factor_nnz;
            s->bytes = run.bytes;
            s->error = error_of(b, U, R, 1);
            s->further = hdi_min(s->further, further_columns(&p, *a, U, &run));
            stages_warm(&p, a, F, U, s);
        }
        plan_close(&p);
        if (!run.fine) return 0;
    }
    return 1;
}

static void stages_row(const bench *b, const char *part, const char *what, double seconds, double gflops,
                       double gbytes) {
    entry r;
    if (!(seconds > 0) || seconds >= 1e30) return;
    row_clear(&r, b, "stages", part, 0);
    snprintf(r.ours, sizeof r.ours, "%s", what);
    r.seconds = seconds;
    r.gflops = gflops;
    r.gbytes = gbytes;
    row_print(&r, b);
}

/* A dense field reads every non-zero of four complex factors twice. What a column reads in the forward sweep
 * depends on its place in the elimination tree. */
static void stages_print(const bench *b, const ask *a, const stages *s) {
    entry r;
    row_clear(&r, b, "stages", NULL, a->times[0] / b->hh);
    snprintf(r.ours, sizeof r.ours, "direct r=%d, one column", (int)a->degree);
    r.seconds = s->total;
    r.error = s->error;
    r.nnz = s->nnz;
    r.bytes = s->bytes;
    r.packs = 1;
    row_print(&r, b);
    stages_row(b, "order", "", s->best[STAGE_OTHER] + s->best[STAGE_ORDER], 0, 0);
    stages_row(b, "analyse", "", s->best[STAGE_ANALYSE], 0, 0);
    stages_row(b, "factor", "four complex", s->best[STAGE_FACTOR], 1e-9 * s->flops / s->best[STAGE_FACTOR],
               0);
    stages_row(b, "solve", "first column", s->best[STAGE_SOLVE], 0, 0);
    stages_row(b, "solve", "further column", s->further, 0, 0);
    stages_row(b, "solve", "dense field", s->field, 0, 128e-9 * s->nnz / s->field);
    stages_row(b, "solve", "one of 24 columns", s->batch, 0, 0);
}

static void job_stages(bench *b) {
    const double t = 100 * b->hh;
    int32_t rows[24], vertices[24], i;
    const int k = spread(b, 24, rows, vertices), all = b->threads;
    ask a = ask_column(HD_METHOD_DIRECT, &t, vertices);
    double *R = reference(b, &a, 1), *U = answers(b, 24), *F = answers(b, 1);
    stages s;
    a.degree = 8;
    for (i = 0; F && i < b->lap->n; i++) F[i] = 1 + i % 7;
    if (R && U && F && k == 24) {
        b->threads = 1;
        if (stages_run(b, &a, F, R, U, &s)) stages_print(b, &a, &s);
        b->threads = all;
        if (all > 1 && stages_run(b, &a, F, R, U, &s)) stages_print(b, &a, &s);
    }
    free(R);
    free(U);
    free(F);
}

/* ---- signature ---- */

enum { SIG_10, SIG_100, SIG_POLES, SIG_16, SIG_MANY, SIG_DISTANCE, SIG_ASKS, SIG_TAUS = 3, SIG_CHECKS = 3,
       SIG_TIMES = 100, SIG_PAIRS = 300 };

static const double SIG_TAU[SIG_TAUS] = {10, 100, 10000};

typedef struct signature {
    ask ask[SIG_ASKS];
    ours best[SIG_ASKS];
    double tau[SIG_TAUS], t16[16], many[SIG_TIMES], *R[SIG_TAUS], *distance, rival_error[2];
    double busy[SIG_ASKS], rival_busy;   /* least seconds of the processor, of all threads */
    int32_t vertex;
    rival_job job;
    rival_result theirs;
    int there;
} signature;

/* Processor time of the process. It says more than the clock if other programs are running. It includes
 * threads that spin while they wait. */
static double processor(void) { return (double)clock() / CLOCKS_PER_SEC; }

static void signature_open(signature *s, const bench *b) {
    int k;
    memset(s, 0, sizeof *s);
    for (k = 0; k < SIG_TAUS; k++) s->tau[k] = SIG_TAU[k] * b->hh;
    for (k = 0; k < 16; k++) s->t16[k] = 10 * pow(1000, k / 15.0) * b->hh;
    for (k = 0; k < SIG_TIMES; k++) s->many[k] = 10 * pow(1000, k / (SIG_TIMES - 1.0)) * b->hh;
    s->vertex = b->lap->vertex[middle(b)];
    for (k = 0; k < SIG_ASKS; k++) {
        s->ask[k] = ask_column(HD_METHOD_DIRECT, s->tau + 1, &s->vertex);
        s->ask[k].what = k == SIG_POLES ? COLUMNS : k == SIG_DISTANCE ? DISTANCES : DIAGONAL;
    }
    s->ask[SIG_10].times = s->tau;
    s->ask[SIG_POLES].degree = 8;
    s->ask[SIG_16].times = s->t16;
    s->ask[SIG_16].n_times = 16;
    s->ask[SIG_MANY].times = s->many;
    s->ask[SIG_MANY].n_times = SIG_TIMES;
    s->job.pair = &b->pair;
    s->job.times = s->tau;
    s->job.n_times = 2;
    s->job.n_eigen = SIG_PAIRS;
    s->job.threads = b->threads;
}

static void signature_close(signature *s) {
    int k;
    for (k = 0; k < SIG_TAUS; k++) free(s->R[k]);
    free(s->distance);
}

/* Diagonals and distances of degree 14. */
static int signature_references(signature *s, const bench *b) {
    int k, fine = 1;
    for (k = 0; k < SIG_TAUS; k++) {
        ask a = s->ask[SIG_10];
        a.times = s->tau + k;
        s->R[k] = reference(b, &a, 1);
        fine = fine && s->R[k];
    }
    s->distance = reference(b, s->ask + SIG_DISTANCE, 1);
    return fine && s->distance;
}

/* Those diagonals at a few vertices against columns of k_t by reorthogonalised Lanczos. */
static void signature_check(const signature *s, const bench *b) {
    int32_t rows[SIG_CHECKS], vertices[SIG_CHECKS];
    const int n = spread(b, SIG_CHECKS, rows, vertices);
    double *S, e[SIG_TAUS] = {0, 0, 0};
    rival_job job;
    rival_result r;
    int k, c, fine = 1;
    if (!HAVE_RIVALS || !(S = answers(b, SIG_CHECKS))) return;
    memset(&job, 0, sizeof job);
    job.pair = &b->pair;
    job.n_times = job.symmetric = 1;
    job.n_sources = n;
    job.sources = rows;
    job.threads = b->threads;
    for (k = 0; k < SIG_TAUS && fine; k++) {
        job.times = s->tau + k;
        fine = rival_reference(&job, S, &r);
        for (c = 0; c < n && fine; c++) {
            const double exact = S[(size_t)c * (size_t)b->pair.n + (size_t)rows[c]];
            e[k] = hdi_max(e[k], fabs(s->R[k][rows[c]] - exact) / exact);
        }
    }
    if (fine)
        printf("%s  references: diagonals of degree 14 and reorthogonalised Lanczos at %d vertices differ "
               "by %.1e, %.1e, %.1e at t = 10, 100, 10^4 h^2\n",
               b->set->csv ? "# " : "", n, e[0], e[1], e[2]);
    else fprintf(stderr, "bench: %s\n", r.note);
    free(S);
}

/* Largest |u - r| / r over the rows. */
static double diagonal_error(const bench *b, const double *u, const double *r) {
    double worst = 0;
    int32_t i;
    for (i = 0; i < b->pair.n; i++) {
        const double e = fabs(u[i] - r[i]) / r[i];
        if (!(e <= worst)) worst = e;
    }
    return worst;
}

/* Error of our answers to ask k, which get renumbered on the way: for many times at those of the
 * references. */
static double signature_error(const signature *s, const bench *b, int k, double *U) {
    const size_t rows = (size_t)b->pair.n, n_times = (size_t)s->ask[k].n_times;
    if (k == SIG_DISTANCE) return error_of(b, U, s->distance, 1);
    if (k == SIG_POLES) return -1;
    vertices_to_rows(b, U, s->ask[k].n_times);
    if (n_times == 1) return diagonal_error(b, U, s->R[k == SIG_100]);
    return hdi_max(diagonal_error(b, U, s->R[0]),
                   hdi_max(diagonal_error(b, U + (n_times - 1) / 3 * rows, s->R[1]),
                           diagonal_error(b, U + (n_times - 1) * rows, s->R[2])));
}

/* Keeps our best run; for the four poles, the best by the time of their factors alone. */
static void signature_ours(signature *s, const bench *b, int k, double *U, int first) {
    ours run, *best = s->best + k;
    double busy;
    rest();
    busy = processor();
    run_cold(b, s->ask + k, U, &run);
    busy = processor() - busy;
    if (first || busy < s->busy[k]) s->busy[k] = busy;
    run.error = first && run.fine ? signature_error(s, b, k, U) : best->error;
    if (first || (run.fine && (k == SIG_POLES ? run.stage[STAGE_FACTOR] < best->stage[STAGE_FACTOR]
                               : run.total < best->total)))
        *best = run;
}

static void signature_rival(signature *s, const bench *b, double *U, int first) {
    rival_result r;
    double busy;
    rest();
    if (first) {
        busy = processor();
        s->there = rival_eigenpairs(&s->job, U, &s->theirs);
        s->rival_busy = processor() - busy;
        s->job.ordering = s->theirs.ordering;
        s->rival_error[0] = s->there ? diagonal_error(b, U, s->R[0]) : -1;
        s->rival_error[1] = s->there ? diagonal_error(b, U + b->pair.n, s->R[1]) : -1;
    } else if (s->there && s->theirs.total < 10 && rival_eigenpairs(&s->job, NULL, &r) &&
               r.total < s->theirs.total) {
        s->theirs = r;
    }
}

static void signature_contest(signature *s, const bench *b, double *U, int rival) {
    int k, round, fine = 1;
    double start;
    for (k = 0; k < SIG_ASKS; k++) {
        signature_ours(s, b, k, U, 1);
        fine = fine && s->best[k].fine;
    }
    if (rival) signature_rival(s, b, U, 1);
    start = now();
    for (round = 0; fine && round_wanted(b, round, start); round++) {
        for (k = 0; k < SIG_ASKS; k++) signature_ours(s, b, k, U, 0);
        if (rival) signature_rival(s, b, U, 0);
    }
}

/* One time, k = 0 or 1, beside the rival's. */
static void signature_row(const signature *s, const bench *b, int k, int rival) {
    const rival_result *t = &s->theirs;
    entry r;
    row_clear(&r, b, "signature", NULL, SIG_TAU[k]);
    row_ours(&r, s->ask + k, s->best + k);
    r.packs = 0;
    if (rival && s->there) {
        snprintf(r.rival, sizeof r.rival, "ARPACK %d pairs %s", (int)t->width,
                 t->ordering == RIVAL_METIS ? "metis" : "amd");
        r.rival_seconds = t->total;
        r.rival_error = s->rival_error[k];
        r.rival_nnz = t->nnz;
        r.rival_bytes = t->bytes;
    } else if (rival) {
        snprintf(r.rival, sizeof r.rival, "ARPACK: %.30s", t->note);
    }
    row_print(&r, b);
}

static void signature_stage(const bench *b, const char *part, double seconds, double rival, double gflops) {
    entry r;
    row_clear(&r, b, "signature", part, 0);
    r.seconds = seconds;
    r.rival_seconds = rival;
    r.gflops = gflops;
    row_print(&r, b);
}

/* The time of answer k as a multiple of one signature. The goal is at most `goal`. */
static void signature_multiple(const signature *s, const bench *b, int k, const char *part,
                               const char *goal) {
    const ours *o = s->best + k;
    entry r;
    if (!o->fine) return;
    row_clear(&r, b, "signature", part, 0);
    snprintf(r.ours, sizeof r.ours, "%.2f x a signature", o->total / s->best[SIG_100].total);
    snprintf(r.rival, sizeof r.rival, "goal: %s x", goal);
    r.seconds = o->total;
    r.error = o->error;
    row_print(&r, b);
}

/* Four complex factors. The goal is that a signature takes at most `goal` times as long. */
static void signature_poles(const signature *s, const bench *b, const char *goal) {
    const ours *o = s->best + SIG_POLES;
    entry r;
    row_clear(&r, b, "signature", "four poles", 0);
    r.seconds = o->stage[STAGE_FACTOR];
    r.gflops = 1e-9 * o->report.factor_flops / r.seconds;
    snprintf(r.ours, sizeof r.ours, "1/%.2f of a signature", s->best[SIG_100].total / r.seconds);
    snprintf(r.rival, sizeof r.rival, "goal: 1/%s", goal);
    row_print(&r, b);
}

static void signature_print(const signature *s, const bench *b, int rival) {
    const ours *one = s->best + SIG_100;
    const rival_result *t = &s->theirs;
    signature_row(s, b, 0, rival);
    signature_row(s, b, 1, rival);
    if (!one->fine || !s->best[SIG_POLES].fine) return;
    signature_stage(b, "order + analyse", one->stage[STAGE_OTHER] + one->stage[STAGE_ORDER]
                    + one->stage[STAGE_ANALYSE], t->analyse, 0);
    signature_stage(b, "factor", one->stage[STAGE_FACTOR], t->factor,
                    1e-9 * one->report.factor_flops / one->stage[STAGE_FACTOR]);
    signature_stage(b, "invert", one->stage[STAGE_INVERT], t->first - t->further, 0);
    signature_stage(b, "check", one->stage[STAGE_SOLVE], 0, 0);
    if (t->further > 0) signature_stage(b, "sum of squares", 0, t->further, 0);
    signature_poles(s, b, "4");
    signature_multiple(s, b, SIG_16, "16 times", "6");
    signature_multiple(s, b, SIG_MANY, "100 times", "8");
    signature_multiple(s, b, SIG_DISTANCE, "distances", "1.2");
    printf("%s  seconds of all processors: signature %.2f, 16 times %.2f, 100 times %.2f, distances %.2f",
           b->set->csv ? "# " : "", s->busy[SIG_100], s->busy[SIG_16], s->busy[SIG_MANY],
           s->busy[SIG_DISTANCE]);
    if (s->there)
        printf("; rival %.1f, choice of its ordering included, for %d solves", s->rival_busy, (int)t->steps);
    printf("\n");
}

static void job_signature(bench *b) {
    const int rival = HAVE_RIVALS && (b->pair.n <= EIGEN_ROWS || b->set->asked);
    double *U = answers(b, SIG_TIMES);
    signature s;
    signature_open(&s, b);
    if (U && signature_references(&s, b)) {
        signature_contest(&s, b, U, rival);
        signature_print(&s, b, rival);
        signature_check(&s, b);
    }
    signature_close(&s);
    free(U);
}

/* ---- Eigen ---- */

typedef struct real_run { int fine; double analyse, factor, solve, bytes; hd_ldl_report report; } real_run;

/* (B + g L) x = B e_row: our real factor. */
static void real_solve(const bench *b, double g, int32_t row, double *x, real_run *out) {
    const hd_csr *L = &b->lap->L;
    double t0 = now(), t1, t2, *val = (double *)malloc((size_t)L->nnz * sizeof *val);
    hd_ldl *f = NULL;
    hd_ldl_opts o;
    hd_context ctx;
    int64_t p;
    ctx = bench_context(b);
    memset(&o, 0, sizeof o);
    memset(out, 0, sizeof *out);
    o.context = &ctx;
    o.xyz = b->lap->xyz;
    for (p = 0; val && p < L->nnz; p++) val[p] = b->pair.B[p] + g * L->val[p];
    if (val && hd_ldl_analyse(&f, L, &o, NULL, NULL) >= 0) {
        t1 = now();
        out->fine = hd_ldl_factor(f, val, &out->report, NULL) >= 0;
        t2 = now();
        memset(x, 0, (size_t)b->pair.n * sizeof *x);
        for (p = L->row_ptr[row]; p < L->row_ptr[row + 1]; p++) x[L->col[p]] = b->pair.B[p];
        out->fine = out->fine && hd_ldl_solve(f, 1, x, 0, x, 0, NULL) >= 0;
        out->solve = now() - t2;
        out->factor = t2 - t1;
        out->analyse = t1 - t0;
        out->bytes = (double)ctx.bytes_peak + 8.0 * (double)L->nnz;
    }
    hd_ldl_free(f);
    free(val);
}

static void real_best(real_run *best, const real_run *r, int first) {
    if (first || r->analyse + r->factor + r->solve < best->analyse + best->factor + best->solve) *best = *r;
}

static void real_rows(const bench *b, const real_run *mine, const rival_result *theirs, double difference) {
    static const char *const names[] = {NULL, "order + analyse", "factor", "solve"};
    const double m[] = {mine->analyse + mine->factor + mine->solve, mine->analyse, mine->factor, mine->solve};
    const double t[] = {theirs->total, theirs->analyse, theirs->factor, theirs->first};
    int k;
    for (k = 0; k < 4; k++) {
        entry r;
        row_clear(&r, b, "eigen", names[k], 0);
        r.seconds = m[k];
        r.rival_seconds = t[k];
        if (k == 0) {
            snprintf(r.ours, sizeof r.ours, "real LDL'%s", ordering_name(mine->report.ordering));
            snprintf(r.rival, sizeof r.rival, "SimplicialLDLT amd");
            r.error = difference;
            r.nnz = (double)mine->report.factor_nnz;
            r.bytes = mine->bytes;
            r.rival_nnz = theirs->nnz;
            r.rival_bytes = theirs->bytes;
        }
        if (k == 2) r.gflops = 1e-9 * mine->report.factor_flops / m[k];
        if (k == 3) r.gbytes = 16e-9 * (double)mine->report.factor_nnz / m[k];
        row_print(&r, b);
    }
}

/* Solving with B + 10 h^2 L; Eigen has one thread, so have we. The error is the difference between the two
 * solutions. */
static void eigen_real(bench *b) {
    const double t = 100 * b->hh, g = 0.1 * t;
    const int32_t row_of = middle(b), vertex = b->lap->vertex[row_of], all = b->threads;
    const ask a = ask_column(HD_METHOD_KRYLOV, &t, &vertex);
    double *x = answers(b, 1), *y = answers(b, 1), start, e = 0, m = 0;
    opponent o = opponent_make(b, SILAN, &a, &row_of, NULL, 0);
    real_run best, run;
    rival_result theirs, r;
    int32_t i;
    int round;
    b->threads = o.job.threads = 1;
    if (x && y) {
        real_solve(b, g, row_of, x, &best);
        if (best.fine && rival_eigen_ldlt(&o.job, y, &theirs)) {
            for (i = 0; i < b->pair.n; i++) {
                e = hdi_max(e, fabs(x[i] - y[i]));
                m = hdi_max(m, fabs(y[i]));
            }
            start = now();
            for (round = 0; round_wanted(b, round, start); round++) {
                real_solve(b, g, row_of, x, &run);
                real_best(&best, &run, round == 0);
                if (rival_eigen_ldlt(&o.job, NULL, &r) && (round == 0 || r.total < theirs.total)) theirs = r;
            }
            real_rows(b, &best, &theirs, e / m);
        }
    }
    b->threads = all;
    free(x);
    free(y);
}

static void job_eigen(bench *b) {
    const double t = 100 * b->hh;
    const int32_t row_of = middle(b), vertex = b->lap->vertex[row_of];
    ask a = ask_column(HD_METHOD_DIRECT, &t, &vertex);
    double *R, *U;
    if (!HAVE_RIVALS || (b->pair.n > EIGEN_ROWS && !b->set->asked)) return;
    eigen_real(b);
    R = reference(b, &a, 1);
    U = answers(b, 1);
    if (R && U) {
        opponent o[2];
        ours best;
        o[0] = opponent_make(b, EIGEN_LU, &a, &row_of, R, 1);
        o[1] = opponent_make(b, UMFPACK, &a, &row_of, R, 1);
        contest(b, &a, R, 1, U, &best, o, umfpack_fits(b) ? 2 : 1);
        contest_rows(b, "one, by poles", &a, &best, o, umfpack_fits(b) ? 2 : 1);
    }
    free(R);
    free(U);
}

/* ---- geodesic ---- */

enum { GEO_SOURCES = 9 };            /* the first, and as many as go side by side */

typedef struct geo_run { int fine; double total, further, batch, bytes, nnz; } geo_run;

/* Times from the mesh to the first distances, the best time of further ones, and the time of each if eight
 * are computed at once. D [n x GEO_SOURCES]. */
static void geo_ours(const bench *b, const int32_t *sources, double *D, geo_run *r) {
    const size_t n = (size_t)b->surface->n;
    hd_geodesic_opts o;
    hd_geodesic_report rep;
    hd_geodesic *g = NULL;
    hd_context ctx;
    double t0 = now();
    int q;
    memset(&o, 0, sizeof o);
    ctx = bench_context(b);
    memset(r, 0, sizeof *r);
    o.context = &ctx;
    r->fine = hd_geodesic_create(&g, MESH_TRIANGLES(b->surface->xyz, b->surface->n, b->surface->tri, b->surface->n_tri), &o, NULL) >= 0 &&
              hd_geodesic_distance(g, VERTICES(1, sources), D, 0, NULL, NULL) >= 0;
    r->total = now() - t0;
    for (q = 1; q < GEO_SOURCES && r->fine; q++) {
        t0 = now();
        r->fine = hd_geodesic_distance(g, VERTICES(1, sources + q), D + (size_t)q * n, 0, NULL, NULL) >= 0;
        if (q == 1 || now() - t0 < r->further) r->further = now() - t0;
    }
    for (q = 0; q < 2 && r->fine; q++) {
        t0 = now();
        r->fine = hd_geodesic_distance(g, VERTICES(GEO_SOURCES - 1, sources + 1), D + n, 0, NULL, NULL) >= 0;
        r->batch = (now() - t0) / (GEO_SOURCES - 1);
    }
    if (r->fine) r->fine = hd_geodesic_distance(g, VERTICES(1, sources), D, 0, &rep, NULL) >= 0;
    r->nnz = r->fine ? (double)rep.factor_nnz : 0;
    r->bytes = (double)ctx.bytes_peak;
    hd_geodesic_free(g);
}

static void geo_best(geo_run *best, const geo_run *r) {
    best->total = hdi_min(best->total, r->total);
    best->further = hdi_min(best->further, r->further);
    best->batch = hdi_min(best->batch, r->batch);
}

static double geo_error(const double *D, const double *R, size_t size) {
    double worst = 0, most = 0;
    size_t i;
    for (i = 0; i < size; i++) {
        /* other components: CGAL has numbers there */
        if (!(R[i] <= DBL_MAX) || !(D[i] <= DBL_MAX)) continue;
        worst = hdi_max(worst, fabs(D[i] - R[i]));
        most = hdi_max(most, D[i]);
    }
    return most > 0 ? worst / most : -1;
}

static void geo_row(const bench *b, const char *part, const char *what, double seconds, double rival,
                    const geo_run *mine, const rival_result *theirs, int there, double error,
                    double rival_error) {
    entry r;
    row_clear(&r, b, "geodesic", part, 1);
    snprintf(r.ours, sizeof r.ours, "%s", what);
    snprintf(r.rival, sizeof r.rival, there ? "CGAL Heat_method_3" : "CGAL: %.28s", theirs->note);
    if (!HAVE_RIVALS) r.rival[0] = 0;
    r.seconds = seconds;
    r.rival_seconds = there ? rival : 0;
    r.nnz = mine->nnz;
    r.bytes = part ? 0 : mine->bytes;
    r.error = error;
    r.rival_error = rival_error;
    row_print(&r, b);
}

static void job_geodesic(bench *b) {
    const size_t n = (size_t)b->surface->n, size = GEO_SOURCES * n;
    double *D = (double *)malloc(3 * size * sizeof *D), *E = D + size, *R = E + size, error = -1,
        rival_error = -1, start;
    int32_t rows[GEO_SOURCES], sources[GEO_SOURCES];
    rival_result theirs, r;
    geo_run mine, run;
    int round, there;
    if (D && spread(b, GEO_SOURCES, rows, sources) == GEO_SOURCES) {
        geo_ours(b, sources, D, &mine);
        there = rival_geodesic(b->surface, 0, GEO_SOURCES, sources, E, &theirs);
        if (there && rival_geodesic(b->surface, 1e-14, GEO_SOURCES, sources, R, &r)) {
            error = geo_error(D, R, size);
            rival_error = geo_error(E, R, size);
        }
        start = now();
        for (round = 0; mine.fine && round_wanted(b, round, start); round++) {
            rest();
            geo_ours(b, sources, D, &run);
            if (run.fine) geo_best(&mine, &run);
            rest();
            if (!there || !rival_geodesic(b->surface, 0, GEO_SOURCES, sources, NULL, &r)) continue;
            theirs.total = hdi_min(theirs.total, r.total);
            theirs.further = hdi_min(theirs.further, r.further);
        }
        geo_row(b, NULL, "first source", mine.total, theirs.total, &mine, &theirs, there, error, rival_error);
        geo_row(b, "further", "one more", mine.further, theirs.further, &mine, &theirs, there, -1, -1);
        geo_row(b, "further", "of eight at a time", mine.batch, theirs.further, &mine, &theirs, there, -1,
                -1);
    }
    free(D);
}

/* ---- assembly ---- */

/* Both begin with the mesh in memory; the masses are those of b. */
static void job_assembly(bench *b) {
    const int voronoi = !b->lap->B;
    const double start = now();
    rival_result theirs, r;
    double best = 0, bytes = 0;
    int round, there = 0;
    entry row;
    memset(&theirs, 0, sizeof theirs);
    for (round = 0; round < 2 || round_wanted(b, round, start); round++) {
        hd_laplacian *lap = NULL;
        hd_laplacian_opts o;
        hd_context ctx;
        double t;
        memset(&o, 0, sizeof o);
        ctx = bench_context(b);
        o.context = &ctx;
        o.kind = voronoi ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM;
        rest();
        t = now();
        if (hd_laplacian_create(&lap, MESH_TRIANGLES(b->surface->xyz, b->surface->n, b->surface->tri, b->surface->n_tri), &o, NULL) < 0)
            return;
        t = now() - t;
        if (round < 2 || t < best) best = t;         /* the first run warms up */
        bytes = (double)ctx.bytes_peak;
        hd_laplacian_free(lap);
        rest();
        if (!rival_assembly(b->surface, voronoi, round ? NULL : &b->pair, &r)) continue;
        if (!there) theirs.error = r.error;
        if (round < 2 || r.total < theirs.total) theirs.total = r.total;
        there = 1;
    }
    row_clear(&row, b, "assembly", NULL, 0);
    snprintf(row.ours, sizeof row.ours, "hd_laplacian_create");
    snprintf(row.rival, sizeof row.rival, there ? "Eigen, setFromTriplets" : "Eigen: %.28s", r.note);
    if (!HAVE_RIVALS) row.rival[0] = 0;
    row.seconds = best;
    row.rival_seconds = there ? theirs.total : 0;
    row.error = there ? theirs.error : -1;
    row.nnz = (double)b->lap->L.nnz;
    row.bytes = bytes;
    row_print(&row, b);
}

/* ---- eigenpairs ---- */

enum { PAIRS = 500 };

/* (A x)(row) for A = L or B. */
static double pair_row(const rival_pair *p, const double *A, const double *x, int32_t row) {
    double sum = 0;
    int64_t q;
    for (q = p->ptr[row]; q < p->ptr[row + 1]; q++) sum += A[q] * x[p->col[q]];
    return sum;
}

/* The largest residual of k vectors by rows, beside constants, with the values that suit them best. */
static double pairs_residual(const bench *b, const double *X, int k) {
    const rival_pair *p = &b->pair;
    double worst = 0;
    int j;
    int32_t i;
    for (j = 0; j < k; j++) {
        const double *x = X + (size_t)j * (size_t)p->n;
        double up = 0, down = 0, sum = 0, value;
        for (i = 0; i < p->n; i++) {
            up += x[i] * pair_row(p, p->L, x, i);
            down += x[i] * pair_row(p, p->B, x, i);
        }
        value = up / down;
        for (i = 0; i < p->n; i++) {
            const double r = pair_row(p, p->L, x, i) - value * pair_row(p, p->B, x, i);
            sum += r * r / b->lap->b_diag[i];
        }
        if (value * b->hh > 1e-9) worst = hdi_max(worst, sqrt(sum / down) / value);   /* else a constant */
    }
    return worst;
}

static double pairs_ours(const bench *b, double *X, entry *row) {
    hd_spectrum *s = NULL;
    hd_spectrum_opts o;
    hd_context ctx;
    double t;
    memset(&o, 0, sizeof o);
    ctx = bench_context(b);
    o.context = &ctx;
    o.count = PAIRS;
    rest();
    t = now();
    if (hd_spectrum_create(&s, b->lap, &o, NULL) < 0) return 0;
    t = now() - t;
    memcpy(X, s->vector, (size_t)s->n * PAIRS * sizeof *X);
    vertices_to_rows(b, X, PAIRS);
    row->error = pairs_residual(b, X, PAIRS);
    row->nnz = (double)s->factor_nnz;
    row->bytes = (double)ctx.bytes_peak;
    snprintf(row->ours, sizeof row->ours, "%d runs, %s", (int)s->n_runs, s->proven ? "proven" : "not proven");
    hd_spectrum_free(s);
    return t;
}

static void job_pairs(bench *b) {
    const int rival = HAVE_RIVALS && (b->pair.n <= EIGEN_ROWS || b->set->asked);
    double *X = b->pair.n >= 3 * PAIRS ? answers(b, PAIRS) : NULL;
    rival_job job;
    rival_result r;
    entry row;
    if (!X) return;
    memset(&job, 0, sizeof job);
    memset(&r, 0, sizeof r);
    row_clear(&row, b, "pairs", NULL, 0);
    row.seconds = pairs_ours(b, X, &row);
    job.pair = &b->pair;
    job.times = &b->hh;                          /* none is wanted; the trial of orderings takes one */
    job.n_eigen = PAIRS;
    job.threads = b->threads;
    rest();
    if (rival && rival_eigenpairs(&job, X, &r)) {
        snprintf(row.rival, sizeof row.rival, "ARPACK, %d solves", (int)r.steps);
        row.rival_seconds = r.total;
        row.rival_error = pairs_residual(b, X, PAIRS);
        row.rival_nnz = r.nnz;
        row.rival_bytes = r.bytes;
    } else if (rival) snprintf(row.rival, sizeof row.rival, "ARPACK: %.30s", r.note);
    if (row.seconds > 0) row_print(&row, b);
    free(X);
}

/* ==== meshes ==== */

/* of both masses */
enum { JOB_SMALL = 1, JOB_ASSEMBLY = 9, JOBS = 11, JOBS_OF_BOTH = 1 << JOB_SMALL | 1 << JOB_ASSEMBLY };

static const struct { const char *name; void (*run)(bench *); } jobs[JOBS] = {
    {"one", job_one}, {"small", job_small}, {"columns", job_columns}, {"further", job_further},
    {"times", job_times}, {"stages", job_stages},
    {"geodesic", job_geodesic}, {"signature", job_signature}, {"eigen", job_eigen},
    {"assembly", job_assembly}, {"pairs", job_pairs}};

static void bench_open(bench *b, const settings *set, const char *mesh, const rival_mesh *surface,
                       const hd_laplacian *lap, int32_t threads, const double *peak) {
    const hd_csr *L = &lap->L;
    int32_t i;
    int64_t p;
    memset(b, 0, sizeof *b);
    b->set = set;
    b->mesh = mesh;
    b->mass = lap->B ? "fem" : "voronoi-cot";
    b->surface = surface;
    b->lap = lap;
    b->threads = threads;
    b->hh = lap->h * lap->h;
    b->peak[0] = peak[0];
    b->peak[1] = peak[1];
    if (!lap->B) b->own_B = (double *)calloc((size_t)L->nnz, sizeof *b->own_B);
    for (i = 0; b->own_B && i < lap->n_active; i++)
        for (p = L->row_ptr[i]; p < L->row_ptr[i + 1]; p++)
            if (L->col[p] == i) b->own_B[p] = lap->mass[i];
    b->pair.n = lap->n_active;
    b->pair.ptr = L->row_ptr;
    b->pair.col = L->col;
    b->pair.L = L->val;
    b->pair.B = lap->B ? lap->B : b->own_B;
}

/* Returns freed memory after a job on a large mesh, because the next mesh has other sizes. */
static void give_back(void) {
#if defined(__GLIBC__)
    (void)malloc_trim(0);
#endif
}

static void bench_pair(const settings *set, const char *mesh, const rival_mesh *surface,
                       const hd_laplacian *lap, int32_t threads, const double *peak) {
    bench b;
    int k;
    bench_open(&b, set, mesh, surface, lap, threads, peak);
    if (!set->csv) {
        printf("\n%s, %s: %d rows, %lld non-zeros, %d thread%s\n", mesh, b.mass, (int)lap->n_active,
               (long long)lap->L.nnz, (int)threads, threads > 1 ? "s" : "");
        table_head(&b);
    }
    for (k = 0; b.pair.B && k < JOBS; k++) {
        if (!(set->jobs >> k & 1) || (!(JOBS_OF_BOTH >> k & 1) && !lap->B)) continue;
        jobs[k].run(&b);
        if (lap->n_active > 400000) give_back();
    }
    free(b.own_B);
}

static void bench_mesh(const settings *set, const char *name, const double *xyz, int32_t n,
                       const int32_t *tri, int32_t n_tri, const double *peak) {
    static const hd_laplacian_kind kinds[] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT};
    rival_mesh surface;
    int k, q;
    surface.n = n;
    surface.n_tri = n_tri;
    surface.xyz = xyz;
    surface.tri = tri;
    for (k = 0; k < 2; k++) {
        hd_laplacian *lap = NULL;
        hd_laplacian_opts o;
        hd_error e;
        memset(&o, 0, sizeof o);
        o.kind = kinds[k];
        if (k == 1 && !(set->jobs & JOBS_OF_BOTH)) break;
        if (hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, n_tri), &o, &e) < 0) {
            fprintf(stderr, "bench: %s: %s\n", name, e.text);
            return;
        }
        for (q = 0; q < set->n_threads; q++)
            bench_pair(set, name, &surface, lap, set->threads[q], peak + 2 * q);
        hd_laplacian_free(lap);
    }
}

/* ==== threads beside other processes ==== */
/* Every job on one thread and on all, in turns: alone, then beside as many busy processes as there are
 * processors, niced and not. Beside others the middle of the runs tells more than the best one. */

#if defined(__unix__) || defined(__APPLE__)
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#define BENCH_BUSY 1
#endif

#ifdef BENCH_BUSY
enum { BUSY_MOST = 64, BUSY_RUNS = 41 };

typedef struct busy_job { const char *name; hd_method method; query what; int32_t n_times, n_columns; int warm, stage; } busy_job;

/* warm: asked once before the clock starts, then so many times, of which the mean counts; stage: of which the
 * seconds count, -1 all */
static const busy_job busy_jobs[] = {
    {"assembly", HD_METHOD_AUTO, COLUMNS, 0, 0, 0, -1},
    {"one column", HD_METHOD_AUTO, COLUMNS, 1, 1, 0, -1},
    {"100 columns", HD_METHOD_DIRECT, COLUMNS, 1, 100, 0, -1},
    {"  factor", HD_METHOD_DIRECT, COLUMNS, 1, 100, 0, STAGE_FACTOR},
    {"  solve", HD_METHOD_DIRECT, COLUMNS, 1, 100, 0, STAGE_SOLVE},
    {"further column", HD_METHOD_DIRECT, COLUMNS, 1, 1, 10, -1},
    {"16 times", HD_METHOD_AUTO, COLUMNS, 16, 1, 0, -1},
    {"signature", HD_METHOD_AUTO, DIAGONAL, 1, 1, 0, -1},
    {"  inversion", HD_METHOD_AUTO, DIAGONAL, 1, 1, 0, STAGE_INVERT}};
enum { BUSY_JOBS = sizeof busy_jobs / sizeof *busy_jobs };

typedef struct busy_run { double seconds, stage[STAGES]; double regions, helped, waits; } busy_run;

static void busy_once(const bench *b, const busy_job *j, double *U, busy_run *r) {
    double times[16], t0;
    int32_t vertices[100];
    plan p;
    ours out;
    ask a;
    int k;
    memset(&a, 0, sizeof a);
    memset(r, 0, sizeof *r);
    for (k = 0; k < 16; k++) times[k] = (k ? 10 * pow(10, k / 5.0) : 100) * b->hh;
    for (k = 0; k < 100; k++) vertices[k] = b->lap->vertex[(int64_t)k * b->pair.n / 100];
    a.what = j->what;
    a.method = j->method;
    a.n_times = j->n_times;
    a.n_columns = j->n_columns;
    a.times = times;
    a.vertices = vertices;
    if (j->n_times == 0) {
        hd_laplacian_opts o;
        hd_laplacian *lap = NULL;
        memset(&o, 0, sizeof o);
        memset(&p, 0, sizeof p);
        p.ctx.n_threads = b->threads;
        o.context = &p.ctx;
        t0 = now();
        (void)hd_laplacian_create(&lap, MESH_TRIANGLES(b->surface->xyz, b->surface->n, b->surface->tri, b->surface->n_tri), &o, NULL);
        r->seconds = now() - t0;
        hd_laplacian_free(lap);
    } else if (plan_open(&p, b, &a) >= 0) {
        if (j->warm) plan_run(&p, &a, U, &out);
        p.ctx.regions = p.ctx.helped = p.ctx.waits = 0;
        watch_start(&p.w);
        for (k = 0; k < (j->warm ? j->warm : 1); k++) plan_run(&p, &a, U, &out);
        for (k = 0; k < STAGES; k++) r->stage[k] = out.stage[k];
        r->seconds = j->warm ? out.total / j->warm : out.total;
        plan_close(&p);
    }
    r->regions = (double)p.ctx.regions;
    r->helped = (double)p.ctx.helped;
    r->waits = (double)p.ctx.waits;
}

static int busy_less(const void *x, const void *y) {
    const double a = *(const double *)x, b = *(const double *)y;
    return (a > b) - (a < b);
}

/* One job in turns; jobs that only look at a stage of the one before share its runs. Returns how many were printed. */
static int busy_print(bench *b, int first, double *U, int32_t all) {
    double seconds[BUSY_JOBS][2][BUSY_RUNS];
    busy_run r;
    const double start = now();
    double count[3] = {0, 0, 0};
    int n = 0, k, q, last = first + 1;
    while (last < BUSY_JOBS && busy_jobs[last].stage >= 0) last++;
    for (n = 0; n < BUSY_RUNS && (n < 3 || now() - start < b->set->seconds); n++) {
        for (q = 0; q < 2; q++) {
            const int many = (q + n) % 2;        /* who begins takes turns as well */
            b->threads = many ? all : 1;
            busy_once(b, busy_jobs + first, U, &r);
            for (k = first; k < last; k++)
                seconds[k][many][n] = busy_jobs[k].stage < 0 ? r.seconds : r.stage[busy_jobs[k].stage];
            if (!many) continue;
            count[0] += r.regions;
            count[1] += r.helped;
            count[2] += r.waits;
        }
    }
    for (k = first; k < last; k++) {
        double *one = seconds[k][0], *many = seconds[k][1];
        for (q = 0; q < 2; q++) qsort(seconds[k][q], (size_t)n, sizeof(double), busy_less);
        printf("  %-16s %9.2f %9.2f %6.2f  %9.2f %9.2f %6.2f", busy_jobs[k].name, 1e3 * one[0], 1e3 * many[0],
               one[0] / many[0], 1e3 * one[n / 2], 1e3 * many[n / 2], one[n / 2] / many[n / 2]);
        if (k == first) printf("  %7.0f %8.0f %6.1f  %d", count[0] / n, count[1] / n, count[2] / n, n);
        printf("\n");
    }
    fflush(stdout);
    return last - first;
}

static int busy_start(pid_t *pid, int n, int niced) {
    int k;
    for (k = 0; k < n; k++) {
        pid[k] = fork();
        if (pid[k] < 0) return k;
        if (pid[k] > 0) continue;
        if (niced && nice(19) == -1) _exit(1);
        for (;;) (void)busy_less(&k, &k);
    }
    return n;
}

static void busy_mesh(const settings *set, const char *name, const double *xyz, int32_t n, const int32_t *tri,
                      int32_t n_tri, const double *peak) {
    static const char *const states[] = {"alone", "beside niced processes", "beside other processes"};
    const int32_t all = set->threads[0];
    rival_mesh surface;
    hd_laplacian *lap = NULL;
    double *U = (double *)malloc((size_t)n * 100 * sizeof *U);
    pid_t pid[BUSY_MOST];
    int state, k;
    bench b;
    surface.n = n;
    surface.n_tri = n_tri;
    surface.xyz = xyz;
    surface.tri = tri;
    if (!U || hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, n_tri), NULL, NULL) < 0) {
        free(U);
        return;
    }
    bench_open(&b, set, name, &surface, lap, all, peak);
    printf("\n%s, %d rows\n", name, (int)lap->n_active);
    for (state = 0; state < 3; state++) {
        const int others = state ? busy_start(pid, (int)hdi_least(hd_context_threads(NULL), BUSY_MOST), state == 1) : 0;
        printf("\n%s, %d rows, %s; ms on 1 and on %d threads, ratio; regions, tasks of others, waits, runs\n"
               "                      best 1     best n  ratio   middle 1  middle n  ratio  regions   helped  waits  runs\n",
               name, (int)lap->n_active, states[state], (int)all);
        for (k = 0; k < BUSY_JOBS;) k += busy_print(&b, k, U, all);
        for (k = 0; k < others; k++) kill(pid[k], SIGKILL);
        for (k = 0; k < others; k++) waitpid(pid[k], NULL, 0);
    }
    free(b.own_B);
    free(U);
    hd_laplacian_free(lap);
}
#else
static void busy_mesh(const settings *set, const char *name, const double *xyz, int32_t n, const int32_t *tri,
                      int32_t n_tri, const double *peak) {
    (void)set; (void)name; (void)xyz; (void)n; (void)tri; (void)n_tri; (void)peak;
    printf("busy processes need POSIX\n");
}
#endif

/* ==== estimates and choices ==== */
/* What hd_heat_estimate says against what a run takes: processor time on one thread, the less of two runs with
 * new plans, or of one that takes long; bytes beyond what the plan held before. */

typedef void (*mesh_job)(const char *name, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri);

enum { TRIAL_MOST = 100 };

typedef struct trial { const char *name; hd_query query; hd_method method; int32_t k; } trial;

static const trial trials[] = {
    {"column, krylov", HD_QUERY_COLUMNS, HD_METHOD_KRYLOV, 1},
    {"column, direct", HD_QUERY_COLUMNS, HD_METHOD_DIRECT, 1},
    {"column, iterative", HD_QUERY_COLUMNS, HD_METHOD_ITERATIVE, 1},
    {"8 columns, krylov", HD_QUERY_COLUMNS, HD_METHOD_KRYLOV, 8},
    {"100 columns, direct", HD_QUERY_COLUMNS, HD_METHOD_DIRECT, 100},
    {"diagonal", HD_QUERY_DIAGONAL, HD_METHOD_AUTO, 0},
    {"distance", HD_QUERY_DISTANCE, HD_METHOD_AUTO, 1}};
enum { TRIALS = sizeof trials / sizeof *trials };

typedef struct trial_result {
    hd_estimate expected;
    hd_report report;
    double seconds, bytes;
} trial_result;

/* U [n k] or [n]. The status of the run; HD_ERR_MEMORY_LIMIT if the estimate is above so many bytes (0: none). */
static hd_status trial_once(const hd_laplacian *lap, const trial *x, double t, double most, double *U, trial_result *r) {
    int32_t source[TRIAL_MOST], k;
    hd_context ctx;
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_status status;
    clock_t start;
    uint64_t before;
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    ctx.n_threads = 1;
    o.context = &ctx;
    o.method = x->method;
    for (k = 0; k < TRIAL_MOST; k++) source[k] = lap->vertex[(int64_t)k * lap->n_active / TRIAL_MOST];
    start = clock();                             /* the analysis is part of the estimate, or of the run */
    status = hd_heat_create(&heat, lap, &o, NULL);
    before = ctx.bytes_in_use;
    if (status >= 0) status = hd_heat_estimate(heat, x->query, 1, &t, x->k, &r->expected, NULL);
    if (status >= 0 && most > 0 && r->expected.cost[0].bytes > most) status = HD_ERR_MEMORY_LIMIT;
    if (status >= 0) {
        r->expected.cost[0].bytes += (double)ctx.bytes_in_use - (double)before;
        if (r->expected.analysed)                /* by the estimate, for the run */
            r->expected.cost[0].seconds += HDI_ROW_ANALYSIS * lap->n_active;
        ctx.bytes_peak = ctx.bytes_in_use;
        if (x->query == HD_QUERY_COLUMNS)
            status = hd_heat_columns(heat, HD_KERNEL_OPERATOR, 1, &t, VERTICES(x->k, source), U, 0, &r->report, NULL);
        else if (x->query == HD_QUERY_DIAGONAL)
            status = hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, U, 0, NULL, NULL, &r->report, NULL);
        else status = hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, VERTICES(x->k, source), U, 0, &r->report, NULL);
    }
    r->seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    r->bytes = (double)ctx.bytes_peak - (double)before;
    hd_heat_free(heat);
    return status;
}

static hd_status trial_run(const hd_laplacian *lap, const trial *x, double t, double most, double *U, trial_result *r) {
    hd_status status = trial_once(lap, x, t, most, U, r);
    trial_result again;
    if (status < 0 || r->seconds > 2) return status;
    status = trial_once(lap, x, t, most, U, &again);
    r->seconds = hdi_min(r->seconds, again.seconds);
    return status;
}

static void estimate_mesh(const char *name, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri) {
    hd_laplacian *lap = NULL;
    double *U = (double *)malloc((size_t)n * TRIAL_MOST * sizeof *U);
    trial_result r;
    int k;
    if (!U || hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, n_tri), NULL, NULL) < 0) {
        fprintf(stderr, "bench: %s: no Laplacian\n", name);
        free(U);
        return;
    }
    if (n < 20000) printf("| vertices | query, method | MB estimated | measured | ratio | s estimated | measured | ratio |\n"
                          "|---|---|---|---|---|---|---|---|\n");
    for (k = 0; k < TRIALS; k++) {
        const hd_status status = trial_run(lap, trials + k, 100 * lap->h * lap->h, 9e9, U, &r);
        const hd_cost *c = &r.expected.cost[0];
        printf("| %d | %s | %.4g | ", (int)lap->n_active, trials[k].name, 1e-6 * c->bytes);
        if (status < 0) printf("| | %.3g | | |\n", c->seconds);
        else printf("%.4g | %.3f | %.3g | %.3g | %.2f |\n", 1e-6 * r.bytes, c->bytes / r.bytes, c->seconds, r.seconds,
                    c->seconds / r.seconds);
        fflush(stdout);
    }
    free(U);
    hd_laplacian_free(lap);
}

/* Which method auto takes for columns, and how much longer it takes than the best one. */
static void choices_mesh(const char *name, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri) {
    static const double tau[] = {1, 10, 100, 1000};
    static const int32_t ks[] = {1, 8, 50};
    static const char *const methods[] = {"auto", "iterative", "direct", "krylov", "local"};
    double *U = (double *)malloc((size_t)n * TRIAL_MOST * sizeof *U), worst = 1, log_sum = 0;
    int kind, i, q, m, cases = 0, right = 0;
    for (kind = 0; kind < 3 && U; kind++) {
        hd_laplacian *lap = NULL;
        hd_laplacian_opts o;
        hd_status status;
        memset(&o, 0, sizeof o);
        o.kind = kind == 0 ? HD_LAPLACIAN_FEM : HD_LAPLACIAN_VORONOI_COT;
        status = kind < 2 ? hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, n_tri), &o, NULL)
                          : hd_laplacian_create(&lap, MESH_POINTS(xyz, n), NULL, NULL);
        for (i = 0; i < 12 && status >= 0; i++) {
            const double t = tau[i / 3] * lap->h * lap->h;
            double seconds[HD_METHOD_LOCAL + 1], best = HUGE_VAL;
            trial x = {"", HD_QUERY_COLUMNS, HD_METHOD_AUTO, ks[i % 3]};
            trial_result r, by_auto;
            q = trial_once(lap, &x, t, 1, U, &by_auto) == HD_ERR_MEMORY_LIMIT ? (int)by_auto.expected.method : 0;
            printf("%s %s, t = %g h^2, %d columns:", name, kind == 0 ? "fem" : kind == 1 ? "voronoi-cot" : "points", tau[i / 3],
                   (int)x.k);
            for (m = HD_METHOD_ITERATIVE; m <= HD_METHOD_LOCAL; m++) {
                seconds[m] = HUGE_VAL;
                if (!by_auto.expected.cost[m].possible) continue;
                x.method = (hd_method)m;
                seconds[m] = trial_run(lap, &x, t, 9e9, U, &r) < 0 ? HUGE_VAL : r.seconds;
                best = hdi_min(best, seconds[m]);
                printf(" %s %.4f (%.4f),", methods[m], seconds[m], r.expected.cost[0].seconds);
            }
            printf(" auto %s %.2f\n", methods[q], seconds[q ? q : 1] / best);
            fflush(stdout);
            cases++;
            right += seconds[q ? q : 1] <= 1.1 * best;
            worst = hdi_max(worst, seconds[q ? q : 1] / best);
            log_sum += log(seconds[q ? q : 1] / best);
        }
        hd_laplacian_free(lap);
    }
    printf("%s: %d of %d choices within 1.1 of the best, on average %.2f times its time, at most %.2f\n", name, right, cases,
           exp(log_sum / (cases ? cases : 1)), worst);
    free(U);
}

/* A mesh from a file, for a job (set NULL) or for the contests. */
static int bench_file(const settings *set, mesh_job job, const char *path, const double *peak) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    mio_mesh mesh;
    mio_error e;
    int32_t *tri = NULL, *face = NULL, n_tri = 0;
    double t0 = now();
    if (mio_load(&mesh, path, NULL, &e) < 0) {
        fprintf(stderr, "bench: %s\n", e.text);
        return 0;
    }
    if (!set) printf("%s: loaded in %.1f ms\n", path, 1e3 * (now() - t0));
    if (mio_triangulate(&mesh, &tri, &n_tri, &face, &e) >= 0) {
        if (set) (set->busy ? busy_mesh : bench_mesh)(set, name, mesh.xyz, mesh.n, tri, n_tri, peak);
        else job(path, mesh.xyz, mesh.n, tri, n_tri);
    }
    free(tri);
    free(face);
    mio_free(&mesh);
    return 1;
}

static void bench_shape(const settings *set, mesh_job job, const char *name, shape s, const double *peak) {
    if (set) (set->busy ? busy_mesh : bench_mesh)(set, name, s.xyz, s.n, s.tri, s.n_tri, peak);
    else job(name, s.xyz, s.n, s.tri, s.n_tri);
    shape_free(&s);
}

/* ==== main ==== */

static int usage(const char *what) {
    if (what) fprintf(stderr, "bench: %s\n", what);
    fprintf(stderr, "usage: bench [--threads LIST] [--jobs LIST] [--columns K] [--seconds S] [--umfpack] "
                    "[--fresh] [--csv] [MESH ...]\n"
                    "       bench parts [MESH ...]\n"
                    "       bench estimate|choices [MESH ...]\n"
                    "       bench busy [--threads N] [--seconds S] [MESH ...]\n"
                    "  --threads 1,2   numbers of threads, one after another; default: all\n"
                    "  --jobs LIST     of "
                    "one,small,columns,further,times,stages,geodesic,signature,eigen,assembly; default: all\n"
                    "  --columns K     columns of the job of that name, default 100\n"
                    "  --seconds S     rounds of a contest begin within S seconds, at least two; default 10\n"
                    "  --umfpack       UMFPACK also above 300000 rows\n"
                    "  --fresh         freed memory goes back to the system at once, as malloc likes it\n"
                    "  --csv           commas, all digits, seconds and bytes\n");
    return 2;
}

/* 1,2,4 -> threads */
static int parse_threads(settings *set, const char *s) {
    char *end;
    for (set->n_threads = 0; set->n_threads < 16; s = end + 1) {
        const long k = strtol(s, &end, 10);
        if (end == s || k < 1 || k > 256) return 0;
        set->threads[set->n_threads++] = (int32_t)k;
        if (*end != ',') return *end == 0;
    }
    return 0;
}

static int parse_jobs(settings *set, const char *s) {
    for (set->jobs = 0; *s;) {
        const size_t len = strcspn(s, ",");
        int k;
        for (k = 0; k < JOBS && (strlen(jobs[k].name) != len || strncmp(s, jobs[k].name, len)); k++) {}
        if (k == JOBS) return 0;
        set->jobs |= 1 << k;
        s += len + (s[len] == ',');
    }
    set->asked = 1;
    return set->jobs != 0;
}

/* Prints the machine's peaks for each number of threads. */
static void measure_machine(const settings *set, double *peak) {
    const int64_t n = (int64_t)1 << 25;
    const int simd = HDI_X86 ? hdi_simd_best() : 0;
    const char *mark = set->csv ? "# " : "", *const simd_names[] = {"plain C", "AVX2", "AVX-512"};
    double *x = (double *)malloc((size_t)n * sizeof *x);
    rival_machine_result m;
    int64_t i;
    int q;
    for (i = 0; x && i < n; i++) x[i] = 1;
    memset(&m, 0, sizeof m);
    m.blas = "";
    for (q = 0; q < set->n_threads; q++) {
        double *p = peak + 2 * q, read[2];
        p[0] = simd ? load_speed(1, simd, NULL, 0) : 0;
        p[1] = simd ? load_speed(set->threads[q], simd, NULL, 0) : 0;
        read[0] = x ? load_speed(1, 0, x, n) : 0;
        read[1] = x ? load_speed(set->threads[q], 0, x, n) : 0;
        if (HAVE_RIVALS) rival_machine(set->threads[q], &m);
        p[0] = hdi_max(p[0], m.peak_1);
        p[1] = hdi_max(p[1], m.peak_n);
        read[0] = hdi_max(read[0], m.read_1);
        read[1] = hdi_max(read[1], m.read_n);
        printf("%smachine: %s, %.1f GF/s and %.1f GB/s read on 1 thread, %.1f and %.1f on %d", mark,
               simd_names[simd], p[0], read[0], p[1], read[1], (int)set->threads[q]);
        printf("%s%s\n", m.blas[0] ? "; OpenBLAS: " : "", m.blas);
    }
    free(x);
#if defined(__GLIBC__) && defined(__USE_MISC)
    {
        double load;
        if (getloadavg(&load, 1) == 1 && load > 0.3)
            printf("%sload average %.1f: others are at work, which shows in what follows, on many threads "
                   "most of all\n", mark, load);
    }
#endif
}

static int parse(settings *set, int argc, char **argv, int *first) {
    int i;
    for (i = 1; i < argc && argv[i][0] == '-'; i++) {
        const char *s = argv[i], *next = i + 1 < argc ? argv[i + 1] : "";
        if (!strcmp(s, "--csv")) set->csv = 1;
        else if (!strcmp(s, "--umfpack")) set->umfpack = 1;
        else if (!strcmp(s, "--fresh")) set->fresh = 1;
        else if (!strcmp(s, "--threads") && parse_threads(set, next)) i++;
        else if (!strcmp(s, "--jobs") && parse_jobs(set, next)) i++;
        else if (!strcmp(s, "--columns") && (set->columns = atoi(next)) > 0 && set->columns <= MOST_COLUMNS)
            i++;
        else if (!strcmp(s, "--seconds") && (set->seconds = atof(next)) > 0) i++;
        else return 0;
    }
    *first = i;
    return 1;
}

/* Freed memory stays in the process, in one heap for all threads. */
static void keep_memory(void) {
#if defined(__GLIBC__)
    (void)mallopt(M_MMAP_MAX, 0);
    (void)mallopt(M_TRIM_THRESHOLD, -1);
    (void)mallopt(M_ARENA_MAX, 1);
#endif
}

/* A job that is no contest, for the meshes given or for shapes of its own. */
static int bench_job(int argc, char **argv, mesh_job job) {
    int i, fine = 1;
    for (i = 2; i < argc; i++) fine &= bench_file(NULL, job, argv[i], NULL);
    if (argc > 2) return fine ? 0 : 1;
    if (job == estimate_mesh || job == choices_mesh) {
        for (i = job == choices_mesh ? 4 : 5; i <= (job == choices_mesh ? 6 : 8); i++)
            bench_shape(NULL, job, "bumpy", shape_bumpy(i, 5), NULL);
        if (job == choices_mesh) bench_shape(NULL, job, "grid", shape_grid(100, 100, 0.3), NULL);
    } else {
        bench_shape(NULL, job, "torus", shape_torus(1000, 500, 1, 0.4), NULL);
        bench_shape(NULL, job, "bumpy", shape_bumpy(7, 1), NULL);
    }
    return fine ? 0 : 1;
}

int main(int argc, char **argv) {
    settings set;
    double peak[32];
    int i, first, fine = 1;
    if (argc > 1 && !strcmp(argv[1], "parts")) {
        printf("memcpy of 256 MB: %.1f GB/s, read and written counted\n", 1e-9 * copy_speed(256000000));
        return bench_job(argc, argv, parts_mesh);
    }
    if (argc > 1 && !strcmp(argv[1], "estimate")) return bench_job(argc, argv, estimate_mesh);
    if (argc > 1 && !strcmp(argv[1], "choices")) return bench_job(argc, argv, choices_mesh);
    memset(&set, 0, sizeof set);
    set.jobs = (1 << JOBS) - 1;
    set.columns = 100;
    set.seconds = 10;
    set.n_threads = 1;
    set.threads[0] = hd_context_threads(NULL);
    set.busy = argc > 1 && !strcmp(argv[1], "busy");
    if (!parse(&set, argc - set.busy, argv + set.busy, &first))
        return usage(argc > 1 && strcmp(argv[1], "--help") ? "an argument is not understood" : NULL);
    if (!set.fresh) keep_memory();
    first += set.busy;
    if (!HAVE_RIVALS && !set.busy) printf("%sbuilt without rivals: times and errors of ours alone\n", set.csv ? "# " : "");
    measure_machine(&set, peak);
    if (set.csv)
        printf("mesh,mass,rows,job,t_over_h2,threads,ours,seconds,rival,rival_seconds,ratio,error,"
               "rival_error,gflops,peak_share,gbytes,nnz,bytes,"
               "bytes_per_64nnz,rival_nnz,rival_bytes\n");
    fflush(stdout);
    for (i = first; i < argc; i++) fine &= bench_file(&set, NULL, argv[i], peak);
    if (first == argc) {
        bench_shape(&set, NULL, "torus", shape_torus(250, 200, 1, 0.4), peak);
        bench_shape(&set, NULL, "bumpy", shape_bumpy(7, 1), peak);
    }
    return fine ? 0 : 1;
}
