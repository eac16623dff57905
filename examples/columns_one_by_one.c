/* columns_one_by_one.c - many heat columns at one time t that are not known all at once

   Build and run from the project's folder:

       cc -O2 examples/columns_one_by_one.c -o columns_one_by_one -lm && ./columns_one_by_one

   A program that asks for a column whenever a user clicks on a vertex cannot ask for many at once. Three plans answer
   the same clicks, and the program prints the time of each:

   HD_METHOD_KRYLOV  one real factor, then some twenty solves with it for each column. The best for a few columns.
   HD_METHOD_AUTO    sees one column at a time and takes what is best for it, whatever was asked for before.
   HD_METHOD_DIRECT  factorises the systems of all poles at the first click, and each click then takes one solve. Set it
                     where you know that many columns at the same t will follow.

   The answers differ by less than the bounds on their errors, which the program checks. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { NU = 200, NV = 80, N = NU * NV, CLICKS = 12, PLANS = 3 };

static void make_torus(double *xyz, int32_t *tri) {
    int32_t i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const double u = 6.283185307179586 * i / NU, v = 6.283185307179586 * j / NV, tube = 1 + 0.2 * sin(3 * u);
            const int32_t a = i * NV + j, b = (i + 1) % NU * NV + j, c = (i + 1) % NU * NV + (j + 1) % NV;
            const int32_t corner[6] = {a, b, c, a, c, i * NV + (j + 1) % NV};
            xyz[3 * a] = (2 + tube * cos(v)) * cos(u);
            xyz[3 * a + 1] = (2 + tube * cos(v)) * sin(u);
            xyz[3 * a + 2] = tube * sin(v);
            memcpy(tri + 6 * a, corner, sizeof corner);
        }
    }
}

static int fail(const hd_error *e) {
    fprintf(stderr, "columns_one_by_one: %s: %s\n", hd_status_name(e->status), e->text);
    return 1;
}

int main(void) {
    static const hd_method methods[PLANS] = {HD_METHOD_KRYLOV, HD_METHOD_AUTO, HD_METHOD_DIRECT};
    static const char *const names[4] = {"auto", "iterative", "direct", "krylov"};
    static double xyz[3 * N], u[PLANS][N];
    static int32_t tri[6 * N];
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *plan[PLANS] = {NULL, NULL, NULL};
    hd_report report[PLANS];
    hd_error err;
    double total[PLANS] = {0, 0, 0}, t;
    int click, k, i;

    make_torus(xyz, tri);
    if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) return fail(&err);
    t = 100 * lap->h * lap->h;
    for (k = 0; k < PLANS; k++) {
        hd_heat_opts opts = {0};
        opts.method = methods[k];
        if (hd_heat_create(&plan[k], lap, &opts, &err) < 0) return fail(&err);
    }
    for (click = 0; click < CLICKS; click++) {
        const int32_t vertex = (int32_t)(((long)click * 7919) % N);
        printf("click %2d:", click + 1);
        for (k = 0; k < PLANS; k++) {
            const clock_t since = clock();
            double ms;
            if (hd_heat_column(plan[k], HD_KERNEL_SYMMETRIC, t, vertex, u[k], &report[k], &err) < 0) return fail(&err);
            ms = 1e3 * (double)(clock() - since) / CLOCKS_PER_SEC;
            total[k] += ms;
            printf("  %s%s %6.1f ms", k == 1 ? "auto: " : "", names[report[k].method], ms);
        }
        printf("\n");
        for (k = 1; k < PLANS; k++)
            for (i = 0; i < N; i++)
                if (fabs(u[k][i] - u[0][i]) > (report[k].error_bound + report[0].error_bound) * u[0][vertex])
                    return printf("vertex %d: the answers differ by more than their bounds\n", i), 1;
    }
    printf("in all:    krylov %.0f ms, auto %.0f ms, direct %.0f ms of processor time; auto takes %s: %s\n", total[0], total[1],
           total[2], names[report[1].method], report[1].reason);
    for (k = 0; k < PLANS; k++) hd_heat_free(plan[k]);
    hd_laplacian_free(lap);
    return 0;
}
