/* bad_mesh.c - heat on a mesh of slivers, with cotangent weights and with an intrinsic Delaunay triangulation

   Build and run from the project's folder:

       cc -O2 examples/bad_mesh.c -o bad_mesh -lm && ./bad_mesh

   Heat is never negative. But if the two angles opposite to an edge sum to more than 180 degrees, the
   cotangent weight of the edge is negative, and the computed heat may be negative too. This example makes a
   torus whose vertices are joined askew, so that many edges are of that kind. A Delaunay triangulation
   flips edges along the surface before the Laplacian is assembled. Then no weight is negative, on the same
   vertices and the same surface. The example prints the smallest value of K_t e_i relative to the largest,
   for three times and both Laplacians. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NU = 64, NV = 32, N = NU * NV, ASKEW = 3 };

/* Row i of the grid is turned by i * ASKEW steps around the tube. NU * ASKEW steps are six whole turns, so
 * that the last row meets the first. */
static void make_torus(double *xyz, int32_t *tri) {
    int32_t i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const double u = 6.283185307179586 * i / NU, v = 6.283185307179586 * (j + ASKEW * i) / NV;
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
    fprintf(stderr, "bad_mesh: %s: %s (face %lld, vertex %lld)\n", hd_status_name(e->status), e->text,
            (long long)e->face, (long long)e->vertex);
    return 1;
}

/* The smallest value of column 0 of K_t, relative to the largest. */
static hd_status smallest(hd_heat *heat, double t, double *least, hd_report *report) {
    static double u[N];
    double low = 0, high = 0;
    int32_t i;
    if (hd_heat_column(heat, HD_KERNEL_OPERATOR, t, 0, u, report, NULL) < 0) return report->status;
    for (i = 0; i < N; i++) {
        low = fmin(low, u[i]);
        high = fmax(high, u[i]);
    }
    *least = low / high;
    return report->status;
}

int main(void) {
    static double xyz[3 * N];
    static int32_t tri[6 * N];
    static const double times[] = {0.1, 1, 10};
    int intrinsic, k;

    make_torus(xyz, tri);
    for (intrinsic = 0; intrinsic < 2; intrinsic++) {
        const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        hd_laplacian_opts opts;
        hd_report report;
        hd_error err;
        double least = 0;

        memset(&opts, 0, sizeof opts);
        /* A diagonal B. With a full one, as in fem, heat can be negative at small times whatever L is. */
        opts.kind = HD_LAPLACIAN_VORONOI_COT;
        opts.triangulation = intrinsic ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
        if (hd_laplacian_create(&lap, &mesh, &opts, &err) < 0) return fail(&err);
        printf("%s: %lld edges flipped, %lld of %lld weights negative, smallest angle %.2f degrees\n",
               intrinsic ? "intrinsic Delaunay" : "plain cotangents",
               (long long)lap->mesh.n_flips, (long long)lap->mesh.n_negative_weights,
               (long long)lap->mesh.n_edges,
               57.29577951308232 * (intrinsic ? lap->mesh.smallest_intrinsic_angle
                                    : lap->mesh.smallest_angle));
        if (hd_heat_create(&heat, lap, NULL, &err) < 0) {
            hd_laplacian_free(lap);
            return fail(&err);
        }
        for (k = 0; k < 3; k++) {
            if (smallest(heat, times[k] * lap->h * lap->h, &least, &report) < 0) {
                hd_heat_free(heat);
                hd_laplacian_free(lap);
                return fail(&report.error);
            }
            printf("  t = %4.1f h^2: smallest value %9.1e of the largest, error at most %.1e of it\n",
                   times[k], least, report.error_bound);
        }
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    return 0;
}
