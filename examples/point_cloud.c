/* point_cloud.c - heat on a surface that is given by points only

   Build and run from the project's folder:

       cc -O2 examples/point_cloud.c -o point_cloud -lm && ./point_cloud

   Points lie on the unit sphere, without faces. The library finds tangent planes and cells, and chooses the
   bandwidth of the exponential weights. Heat diffuses from one point. The heat kernel of the sphere is known,
   so the example can print the difference from the smooth surface: some percent for random points, less for
   evenly spread ones. The error bound in the report says something else. It is about the exponential of the
   two matrices, and says nothing about how well the matrices represent the sphere. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 4000 };

/* Points at random, or along a spiral with equal areas in between (a Fibonacci lattice). */
static void make_sphere(double *xyz, int spiral) {
    int32_t i;
    srand(1);
    for (i = 0; i < N; i++) {
        const double z = 2 * (spiral ? (i + 0.5) / N : rand() / (RAND_MAX + 1.0)) - 1;
        const double a = spiral ? 2.399963229728653 * i : 6.283185307179586 * (rand() / (RAND_MAX + 1.0));
        xyz[3 * i] = sqrt(1 - z * z) * cos(a);
        xyz[3 * i + 1] = sqrt(1 - z * z) * sin(a);
        xyz[3 * i + 2] = z;
    }
}

/* k_t of the unit sphere at an angle with cosine x: sum over l of (2l+1)/(4 pi) exp(-l(l+1)t) P_l(x). */
static double exact(double t, double x) {
    double before = 1, p = x, sum = 1;
    int l;
    for (l = 1; l < 60; l++) {
        const double next = ((2 * l + 1) * x * p - l * before) / (l + 1);
        sum += (2 * l + 1) * exp(-l * (l + 1) * t) * p;
        before = p;
        p = next;
    }
    return sum / 12.566370614359172;
}

static int fail(const hd_error *e) {
    fprintf(stderr, "point_cloud: %s: %s (vertex %lld)\n", hd_status_name(e->status), e->text,
            (long long)e->vertex);
    return 1;
}

/* Builds the pair, diffuses a unit of heat from point 0 and compares with the smooth sphere. */
static int show(const double *xyz, const char *what) {
    static double u[N];
    const int32_t source = 0;
    const double t = 0.1;
    double worst = 0;
    hd_mesh cloud = hd_triangles(xyz, N, NULL, 0);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_report report;
    hd_error err;
    int32_t i;
    cloud.shape = HD_POINTS;
    if (hd_laplacian_create(&lap, &cloud, NULL, &err) < 0) return fail(&err);
    printf("%s: %d points, h = %.4f, area of the cells %.3f (sphere: 12.566)\n", what, N, lap->h, lap->area);
    printf("  bandwidth %.2e = %.2f h^2, weights up to a distance of %.3f, %.0f in a row\n",
           lap->points.bandwidth2, lap->points.bandwidth2 / (lap->h * lap->h), lap->points.cut_radius,
           (double)lap->L.nnz / lap->n_active);
    if (hd_heat_create(&heat, lap, NULL, &err) < 0 ||
        hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, source, u, &report, NULL) < 0) {
        const hd_error *why = heat ? &report.error : &err;
        hd_heat_free(heat);
        hd_laplacian_free(lap);
        return fail(why);
    }
    for (i = 0; i < N; i++) {
        const double *p = xyz + 3 * i, cosine = p[0] * xyz[0] + p[1] * xyz[1] + p[2] * xyz[2];
        worst = fmax(worst, fabs(u[i] - exact(t, cosine)));
    }
    printf("  heat kernel at t = %g: %.4f at the source (sphere: %.4f), largest difference %.1f %% of that;"
           " error bound for these matrices %.0e\n",
           t, u[source], exact(t, 1), 100 * worst / exact(t, 1), report.error_bound);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}

int main(void) {
    static double xyz[3 * N];
    make_sphere(xyz, 0);
    if (show(xyz, "at random")) return 1;
    make_sphere(xyz, 1);
    return show(xyz, "along a spiral");
}
