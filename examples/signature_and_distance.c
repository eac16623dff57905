/* signature_and_distance.c - the heat kernel signature of every vertex, diffusion distances, and farthest
 * points

   Build and run from the project's folder:

       cc -O2 examples/signature_and_distance.c -o signature_and_distance -lm && ./signature_and_distance

   A torus is made in memory. Its signature k_t(x,x) at three times comes from selected inversion, without
   eigenvectors. A torus is symmetric, so the signature depends only on the position around the tube. Then the
   example prints distances from one vertex, and spreads points over the torus, each the farthest from those
   before it. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NU = 72, NV = 36, N = NU * NV, TIMES = 3, POINTS = 8 };

static double xyz[3 * N], signature[TIMES * N], distance[TIMES * N];
static int32_t tri[6 * N];

static void make_torus(void) {
    int32_t i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const double u = 6.283185307179586 * i / NU, v = 6.283185307179586 * j / NV;
            const int32_t next_i = (i + 1) % NU, next_j = (j + 1) % NV;
            const int32_t a = i * NV + j, b = next_i * NV + j, c = next_i * NV + next_j, d = i * NV + next_j;
            double *p = xyz + 3 * a;
            int32_t *t = tri + 6 * a;
            p[0] = (2 + cos(v)) * cos(u);
            p[1] = (2 + cos(v)) * sin(u);
            p[2] = sin(v);
            t[0] = a; t[1] = b; t[2] = c;
            t[3] = a; t[4] = c; t[5] = d;
        }
    }
}

static int fail(const hd_error *e) {
    fprintf(stderr, "signature_and_distance: %s: %s (vertex %lld)\n", hd_status_name(e->status), e->text,
            (long long)e->vertex);
    return 1;
}

/* Largest difference between vertices that a rotation of the torus maps to each other. */
static double unevenness(const double *d) {
    double worst = 0;
    int32_t i;
    for (i = 0; i < N; i++) worst = fmax(worst, fabs(d[i] - d[i % NV]));
    return worst;
}

int main(void) {
    const int32_t source = 0, opposite = NU / 2 * NV;       /* both on the outer rim, on opposite sides */
    const hd_sources from = hd_vertices(1, &source);
    int32_t point[POINTS], q;
    double t[TIMES], apart[POINTS];
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_report report;
    hd_error err;

    make_torus();
    if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) return fail(&err);
    if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);
    for (q = 0; q < TIMES; q++) t[q] = pow(10, q + 1) * lap->h * lap->h;

    if (hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, TIMES, t, signature, 0, NULL, NULL, &report, NULL) < 0)
        return fail(&report.error);
    for (q = 0; q < TIMES; q++)
        printf("k_t(x,x) at t = %4.0f h^2: %.6f on the outer rim, %.6f on the inner rim; unevenness %.1e\n",
               t[q] / (lap->h * lap->h), signature[q * N], signature[q * N + NV / 2],
               unevenness(signature + q * N));
    printf("    error at most %.1e of each value\n", report.error_relative);

    if (hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, TIMES, t, &from, distance, 0, &report, NULL) < 0)
        return fail(&report.error);
    for (q = 0; q < TIMES; q++)
        printf("distance at t = %4.0f h^2: %.6f to the next vertex, %.6f to the far side\n",
               t[q] / (lap->h * lap->h), distance[q * N + 1], distance[q * N + opposite]);
    if (hd_heat_distance(heat, HD_DISTANCE_BIHARMONIC, 1, NULL, &from, distance, 0, &report, NULL) < 0)
        return fail(&report.error);
    printf("biharmonic distance: %.6f to the next vertex, %.6f to the far side\n", distance[1],
           distance[opposite]);

    if (hd_heat_sample(heat, HD_DISTANCE_BIHARMONIC, 0, NULL, POINTS, point, apart, &report, NULL) < 0)
        return fail(&report.error);
    for (q = 0; q < POINTS; q++)
        printf("point %d: vertex %4d, at distance %.4f from the points before it\n", (int)q + 1,
               (int)point[q], apart[q]);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
