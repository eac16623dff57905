/* spectral_vs_exact.c - how many eigenpairs does a heat kernel need?

   Kernels from the first k eigenpairs of the Laplacian, as most programs compute them, against the exact one,
   at several times. For large t a few pairs are enough; for small t hundreds are not. The bound that comes
   with a truncated kernel says so without the exact one.

       cc -O2 examples/spectral_vs_exact.c -o spectral_vs_exact -lm && ./spectral_vs_exact

   It prints a table: for each time and each k the largest error of the column of a vertex, relative to the
   largest value of the column, and the bound of it. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { RINGS = 120, SIDES = 60, N = RINGS * SIDES, MOST = 500 };

/* A torus with three bumps. */
static void make_torus(double *xyz, int32_t *tri) {
    int32_t i, j, k = 0;
    for (i = 0; i < RINGS; i++) {
        for (j = 0; j < SIDES; j++) {
            const double u = 6.283185307179586 * i / RINGS, v = 6.283185307179586 * j / SIDES;
            const double r = 2 + 0.8 * cos(v) + 0.15 * sin(3 * u);
            const int32_t a = i * SIDES + j, b = (i + 1) % RINGS * SIDES + j;
            const int32_t c = (i + 1) % RINGS * SIDES + (j + 1) % SIDES, d = i * SIDES + (j + 1) % SIDES;
            const int32_t corner[6] = {a, b, c, a, c, d};
            int q;
            xyz[3 * a] = r * cos(u);
            xyz[3 * a + 1] = r * sin(u);
            xyz[3 * a + 2] = 0.8 * sin(v);
            for (q = 0; q < 6; q++) tri[k++] = corner[q];
        }
    }
}

static double largest(const double *x, const double *y) {
    double most = 0;
    int32_t i;
    for (i = 0; i < N; i++) most = fmax(most, fabs(x[i] - (y ? y[i] : 0)));
    return most;
}

int main(void) {
    static const int32_t counts[6] = {10, 20, 50, 100, 200, MOST};
    static const double times[6] = {3, 10, 30, 100, 1000, 10000};    /* in squares of the edge length */
    double *xyz = (double *)malloc(3 * N * sizeof *xyz), *u = (double *)malloc(3 * N * sizeof *u);
    int32_t *tri = (int32_t *)malloc(6 * N * sizeof *tri);
    const int32_t source = 17;
    const hd_sources from = hd_vertices(1, &source);
    double *exact = u, *some = u + N, *bound = u + 2 * N;
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_spectrum *spectrum[6] = {NULL, NULL, NULL, NULL, NULL, NULL};
    hd_spectrum_opts opts = {0};
    hd_error err = {0};
    int status = 1, k, q;
    if (!xyz || !u || !tri) goto end;
    make_torus(xyz, tri);
    if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) goto end;
    if (hd_heat_create(&heat, lap, NULL, &err) < 0) goto end;
    printf("%d vertices; error of the kernel from k pairs (and its bound), relative to the largest value\n", N);
    printf("  t/h^2");
    for (k = 0; k < 6; k++) {
        opts.count = counts[k];
        if (hd_spectrum_create(&spectrum[k], lap, &opts, &err) < 0) goto end;
        printf("       k = %-8d", counts[k]);
    }
    for (q = 0; q < 6; q++) {
        const double t = times[q] * lap->h * lap->h;
        double size;
        if (hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, source, exact, NULL, &err) < 0) goto end;
        size = largest(exact, NULL);
        printf("\n%7g", times[q]);
        for (k = 0; k < 6; k++) {
            if (hd_spectrum_columns(spectrum[k], HD_KERNEL_SYMMETRIC, 1, &t, &from, some, bound, 0, &err) < 0) goto end;
            printf("  %8.1e (%7.1e)", largest(exact, some) / size, largest(bound, NULL) / size);
        }
    }
    printf("\nAll pairs are there: %s\n", spectrum[5]->proven ? "proven" : "not proven");
    status = 0;
end:
    if (status) fprintf(stderr, "%s\n", err.status ? err.text : "out of memory");
    for (k = 0; k < 6; k++) hd_spectrum_free(spectrum[k]);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(xyz);
    free(u);
    free(tri);
    return status;
}
