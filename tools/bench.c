/* bench.c - what the parts of heatdiff.h cost, beside what the machine could do.

   Build:  cc -O2 tools/bench.c -o bench -lm        Run:  ./bench [MESH ...]

   Without a mesh it makes its own. Times are the shortest of several repetitions on one thread; ratios are taken in one run, as machines
   drift. "floor" is the time to read (and write) each array once at the speed at which memcpy copies blocks of the same total size, so that small
   matrices are held against the caches they fit in. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "meshio.h"
#include "shapes.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
#if defined(CLOCK_MONOTONIC)
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
#else
    return (double)clock() / CLOCKS_PER_SEC;
#endif
}

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
    printf("  %-34s %9.3f ms   floor %8.3f ms   ratio %.2f   %.1f GB/s\n", what, 1e3 * seconds, 1e3 * bytes / speed, seconds * speed / bytes,
           1e-9 * bytes / seconds);
}

static double time_apply(const hd_csr *a, const double *x, double *y) {
    double best = 1e30;
    int r, k, reps = (int)(20000000 / (a->nnz + 1)) + 1;
    for (r = 0; r < 7; r++) {
        const double t0 = now();
        for (k = 0; k < reps; k++) hdi_csr_apply_rows(a, x, y, 0, a->n_rows);
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
        for (k = 0; k < reps; k++) hdi_precond_apply(m, x, y);
        if ((now() - t0) / reps < best) best = (now() - t0) / reps;
    }
    return best;
}

static void bench_products(hd_heat *heat, double t) {
    const hd_laplacian *lap = heat->lap;
    const size_t n = (size_t)lap->n_active;
    const double nnz = (double)lap->L.nnz, dn = (double)n;
    double *x = (double *)calloc(4 * n, sizeof *x), *y = x + 2 * n, bytes;
    hdi_system a;
    size_t i;
    if (!x) return;
    for (i = 0; i < 2 * n; i++) x[i] = 1 + (double)(i % 7);
    bytes = 12 * nnz + 8 * (dn + 1) + 16 * dn;
    line("L x, real", time_apply(&lap->L, x, y), bytes, copy_speed((size_t)bytes));
    a.lap = lap;
    a.t = t;
    a.theta = hdi_c(2.4, 2.4);
    bytes = (lap->B ? 20 : 12) * nnz + 8 * (dn + 1) + (lap->B ? 32 : 40) * dn;
    line("(t L + theta B) x, complex", time_system(&a, (hd_c64 *)(void *)x, (hd_c64 *)(void *)y), bytes, copy_speed((size_t)bytes));
    bytes = 20 * (double)heat->up.ptr[n] + 8 * dn + 16 * dn + 32 * dn;
    if (heat->fam.filled) line("modified ILDL(0) solve, complex", time_precond(heat->fam.m, (hd_c64 *)(void *)x, (hd_c64 *)(void *)y), 2 * bytes, copy_speed((size_t)bytes));
    free(x);
}

static void bench_solvers(const hd_laplacian *lap) {
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
            if (hd_heat_column(heat, taus[k] * lap->h * lap->h, lap->vertex[lap->n_active / 2], u, &rep) >= 0) {
                t2 = now();
                printf("  column, t = %4g h^2, %-8s plan %7.1f ms, solve %8.1f ms, %5lld steps, %.3f ms a step\n", taus[k],
                       s == 0 ? "cocg" : "lanczos", 1e3 * (t1 - t0), 1e3 * (t2 - t1), (long long)rep.iterations, 1e3 * (t2 - t1) / (double)rep.iterations);
            }
            if (s == 0 && k == 2) bench_products(heat, 100 * lap->h * lap->h);
            hd_heat_free(heat);
        }
    }
    free(u);
}

static void bench_mesh(const char *name, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri) {
    static const hd_laplacian_kind kinds[] = {HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_FEM};
    int k;
    for (k = 0; k < 2; k++) {
        hd_laplacian *lap = NULL;
        hd_laplacian_opts o;
        double t0 = now(), t1;
        memset(&o, 0, sizeof o);
        o.kind = kinds[k];
        if (hd_laplacian_triangles(&lap, xyz, n, tri, n_tri, &o, NULL) < 0) return;
        t1 = now();
        printf("%s, %s: %d vertices, %lld non-zeros, assembled in %.1f ms\n", name, k ? "fem" : "voronoi-cot", (int)n, (long long)lap->L.nnz, 1e3 * (t1 - t0));
        bench_solvers(lap);
        hd_laplacian_free(lap);
    }
}

static void bench_file(const char *path) {
    mio_mesh mesh;
    mio_error e;
    int32_t *tri = NULL, *face = NULL, n_tri = 0;
    double t0 = now();
    if (mio_load(&mesh, path, NULL, &e) < 0) {
        fprintf(stderr, "bench: %s\n", e.text);
        return;
    }
    printf("%s: loaded in %.1f ms\n", path, 1e3 * (now() - t0));
    if (mio_triangulate(&mesh, &tri, &n_tri, &face, &e) >= 0) bench_mesh(path, mesh.xyz, mesh.n, tri, n_tri);
    free(tri);
    free(face);
    mio_free(&mesh);
}

int main(int argc, char **argv) {
    int i;
    printf("memcpy of 256 MB: %.1f GB/s, read and written counted\n", 1e-9 * copy_speed(256000000));
    for (i = 1; i < argc; i++) bench_file(argv[i]);
    if (argc == 1) {
        shape s = shape_torus(1000, 500, 1, 0.4);
        bench_mesh("torus", s.xyz, s.n, s.tri, s.n_tri);
        shape_free(&s);
        s = shape_bumpy(7, 1);
        bench_mesh("bumpy", s.xyz, s.n, s.tri, s.n_tri);
        shape_free(&s);
    }
    return 0;
}
