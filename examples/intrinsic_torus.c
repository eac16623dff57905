/* intrinsic_torus.c - heat and distances on a surface that has no shape in space, from a point inside a face

   Build and run from the project's folder:

       cc -O2 examples/intrinsic_torus.c -o intrinsic_torus -lm && ./intrinsic_torus

   A flat torus is a rectangle whose opposite sides are joined. It cannot stand in space without being bent or
   stretched, but its triangles are known by the lengths of their sides, and nothing else is needed. Heat
   starts inside a face rather than at a vertex. Heat, diffusion distance and geodesic distance are compared
   with the exact ones. Finally the same torus is cut into long triangles, and flips of edges along the surface
   turn these into good ones. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NX = 60, NY = 48, N = NX * NY };
static const double CELL = 1.0 / NX;                 /* the torus is 1 by 0.8 */

/* Each row of cells is joined to the next one `shear` vertices further along. */
static void make_torus(int32_t shear, int32_t *tri, double *lengths) {
    const double up = CELL * hypot(1, shear), across = CELL * hypot(1, shear + 1);
    int32_t i, j;
    for (j = 0; j < NY; j++)
        for (i = 0; i < NX; i++) {
            const int32_t row = j * NX, above = (j + 1) % NY * NX;
            const int32_t a = row + i, b = row + (i + 1) % NX;
            const int32_t c = above + (i + shear + 1) % NX, d = above + (i + shear) % NX;
            int32_t *t = tri + 6 * a;
            double *len = lengths + 6 * a;
            t[0] = a; t[1] = b; t[2] = c;
            t[3] = a; t[4] = c; t[5] = d;
            len[0] = CELL; len[1] = up; len[2] = across;     /* ab, bc, ca */
            len[3] = across; len[4] = CELL; len[5] = up;     /* ac, cd, da */
        }
}

/* The heat kernel of a circle. */
static double circle(double t, double length, double x) {
    const double turn = 6.283185307179586 / length;
    double sum = 1 / length;
    int k;
    for (k = 1; k < 100; k++) sum += 2 / length * exp(-t * turn * turn * k * k) * cos(turn * k * x);
    return sum;
}

static int fail(const char *what, const hd_error *e) {
    fprintf(stderr, "intrinsic_torus: %s: %s: %s (face %lld)\n", what, hd_status_name(e->status), e->text,
            (long long)e->face);
    return 1;
}

int main(void) {
    static int32_t tri[6 * N];
    static double lengths[6 * N], u[N], d[N], far[N];
    const double t = 0.01, bary[3] = {1 / 3.0, 1 / 3.0, 1 / 3.0};
    hd_laplacian_opts opts = {0};
    hd_mesh mesh = hd_triangles(NULL, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_geodesic *g = NULL;
    hd_sources source = hd_vertices(1, tri);
    hd_report report;
    hd_error err;
    int32_t v;

    make_torus(0, tri, lengths);
    mesh.lengths = lengths;
    if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) return fail("lengths", &err);
    if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail("plan", &err);
    if (hd_geodesic_create(&g, &mesh, NULL, &err) < 0) return fail("plan", &err);
    printf("a flat torus of %d vertices, area %.3f, border %d\n", (int)N, lap->area,
           (int)lap->mesh.n_boundary_edges);

    source.corners = 3;                          /* the middle of the first face */
    source.bary = bary;
    if (hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t, &source, u, 0, &report, &err) < 0 ||
        hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, 1, &t, &source, d, 0, &report, &err) < 0 ||
        hd_geodesic_distance(g, &source, far, 0, NULL, &err) < 0)
        return fail("source", &err);
    printf("  x      y      heat   exact     diffusion distance, exact     geodesic, exact\n");
    for (v = 0; v < N; v += N / 8 + 5) {
        const double x = (v % NX - 2 / 3.0) * CELL, y = (v / NX - 1 / 3.0) * CELL;
        const double k = circle(2 * t, 1, x) * circle(2 * t, 0.8, y);
        const double own = circle(2 * t, 1, 0) * circle(2 * t, 0.8, 0);
        const double dx = x > 0.5 ? 1 - x : x, dy = y > 0.4 ? 0.8 - y : y;
        printf("%6.3f %6.3f %7.4f %7.4f %14.4f %7.4f %18.4f %7.4f\n", x, y, u[v],
               circle(t, 1, x) * circle(t, 0.8, y), d[v], sqrt(2 * own - 2 * k), far[v], hypot(dx, dy));
    }
    hd_heat_free(heat);
    hd_geodesic_free(g);
    hd_laplacian_free(lap);

    make_torus(5, tri, lengths);
    opts.triangulation = HD_TRIANGULATION_DELAUNAY;
    lap = NULL;
    if (hd_laplacian_create(&lap, &mesh, &opts, &err) < 0) return fail("flips", &err);
    printf("cut into long triangles: smallest angle %.1f degrees, %.1f after %lld flips\n",
           57.29577951308232 * lap->mesh.smallest_angle,
           57.29577951308232 * lap->mesh.smallest_intrinsic_angle, (long long)lap->mesh.n_flips);
    hd_laplacian_free(lap);
    return 0;
}
