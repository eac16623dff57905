/* heat_on_mesh.c - the heat kernel of a triangle mesh, with its error bound

   Build and run from the project's folder:

       cc -O2 examples/heat_on_mesh.c -o heat_on_mesh -lm && ./heat_on_mesh

   A torus is made in memory. Heat starts at one vertex and is followed up to three times t. For each t
   the example prints how warm it is at the source and on the far side, the total heat (it is conserved), and
   the bound on the error. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NU = 96, NV = 48, N = NU * NV };

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

static int fail(const hd_error *e) {
    fprintf(stderr, "heat_on_mesh: %s: %s (face %lld, vertex %lld)\n", hd_status_name(e->status), e->text,
            (long long)e->face, (long long)e->vertex);
    return 1;
}

int main(void) {
    static double xyz[3 * N], u[N];
    static int32_t tri[6 * N];
    static const double times[] = {10, 100, 1000};
    const int32_t source = 0, opposite = NU / 2 * NV;   /* on the far side of the ring */
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_report report;
    hd_error err;
    int k;

    make_torus(xyz, tri);
    if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) return fail(&err);
    printf("torus: %d vertices, area %.4f (smooth surface: %.4f), mean edge length h = %.4f\n", (int)lap->n,
           lap->area, 8 * 9.869604401089358, lap->h);

    if (hd_heat_create(&heat, lap, NULL, &err) < 0) {
        hd_laplacian_free(lap);
        return fail(&err);
    }
    for (k = 0; k < 3; k++) {
        const double t = times[k] * lap->h * lap->h;
        int32_t i;
        double mass = 0;
        if (hd_heat_column(heat, HD_KERNEL_OPERATOR, t, source, u, &report, NULL) < 0) {
            hd_heat_free(heat);
            hd_laplacian_free(lap);
            return fail(&report.error);
        }
        for (i = 0; i < lap->n_active; i++) mass += lap->mass[i] * u[lap->vertex[i]];
        printf("t = %4.0f h^2: at the source %.3e, on the far side %.3e, total heat %.12f of the initial,"
               " error at most %.1e of the largest value\n",
               times[k], u[source], u[opposite], mass / lap->mass[lap->row[source]], report.error_bound);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
