/* geodesic.c - distances along a surface by the heat method, and samples spread evenly over it

   Build and run from the project's folder:

       cc -O2 examples/geodesic.c -o geodesic -lm && ./geodesic

   A torus is made in memory, and one plan answers all questions. First, distances around the tube are
   compared with the exact ones. Then eight vertices are chosen, each the farthest from those before it.
   Finally the distances from all eight are computed at once, to print how close the two nearest samples are. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NU = 192, NV = 72, N = NU * NV, SAMPLES = 8 };

static void make_torus(double *xyz, int32_t *tri) {
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

static int fail(const hd_error *e, hd_geodesic *g) {
    fprintf(stderr, "geodesic: %s: %s (face %lld, vertex %lld)\n", hd_status_name(e->status), e->text,
            (long long)e->face, (long long)e->vertex);
    hd_geodesic_free(g);
    return 1;
}

int main(void) {
    static double xyz[3 * N], d[N], D[SAMPLES * N];
    static int32_t tri[6 * N];
    int32_t sample[SAMPLES] = {0}, i, k;
    int64_t first[2] = {0, 1};
    hd_sources sources;
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_geodesic *g = NULL;
    hd_geodesic_report report;
    hd_error err;
    double nearest = HUGE_VAL;

    make_torus(xyz, tri);
    if (hd_geodesic_create(&g, &mesh, NULL, &err) < 0) return fail(&err, NULL);

    /* Around the tube, from its outermost point. The shortest way is a circle of radius 1. */
    sources = hd_vertices(1, sample);
    if (hd_geodesic_distance(g, &sources, d, 0, &report, NULL) < 0) return fail(&report.error, g);
    printf("torus: %d vertices, mean edge length h = %.4f, heat flows for t = %.3g\n", (int)N, report.h,
           report.t);
    for (i = NV / 8; i <= NV / 2; i += NV / 8)
        printf("around the tube by %3d degrees: %.4f, exact %.4f\n", 360 * (int)i / NV, d[i],
               6.283185307179586 * i / NV);

    /* Each new sample is the vertex farthest from the k samples before it, which are one source. */
    sources.first = first;
    for (k = 1; k < SAMPLES; k++) {
        first[1] = k;
        if (hd_geodesic_distance(g, &sources, d, 0, &report, NULL) < 0) return fail(&report.error, g);
        for (i = 0; i < N; i++)
            if (d[i] > d[sample[k]]) sample[k] = i;
        printf("sample %d: vertex %5d, %.3f from those before\n", (int)k, (int)sample[k], d[sample[k]]);
    }

    /* Distances from each sample by itself. Eight columns take little longer than two. */
    sources = hd_vertices(SAMPLES, sample);
    if (hd_geodesic_distance(g, &sources, D, 0, &report, NULL) < 0) return fail(&report.error, g);
    for (k = 0; k < SAMPLES; k++)
        for (i = 0; i < SAMPLES; i++)
            if (i != k && D[k * N + sample[i]] < nearest) nearest = D[k * N + sample[i]];
    printf("the two nearest samples are %.3f apart; residuals %.1e (heat) and %.1e (distance)\n", nearest,
           report.residual_heat, report.residual_distance);
    hd_geodesic_free(g);
    return 0;
}
