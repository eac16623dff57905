/* regions.c - a polygon mesh cut into regions around a few vertices, and distances that bending leaves alone

   Build and run from the project's folder:

       cc -O2 examples/regions.c -o regions -lm && ./regions

   A sheet of squares is rolled into three quarters of a tube. Distances along the surface do not change then.
   Five vertices are marked on both. Every vertex belongs to the nearest mark, which cuts the sheet into
   regions; and the distances among the marks, a table that multidimensional scaling and matching begin with,
   agree, while straight lines through space do not. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NX = 80, NY = 50, N = (NX + 1) * (NY + 1), N_FACES = NX * NY, MARKS = 5 };

static const int32_t mark[MARKS] = {12 * (NY + 1) + 8, 15 * (NY + 1) + 40, 40 * (NY + 1) + 25,
                                    70 * (NY + 1) + 10, 66 * (NY + 1) + 44};

/* The sheet, 8 long and 5 wide; rolled: around an axis along y. */
static void make_sheet(int rolled, double *xyz, int64_t *ptr, int32_t *idx) {
    const double radius = 8 / 4.71238898038469;          /* 8 is three quarters of the way around */
    int32_t i, j;
    for (i = 0; i <= NX; i++)
        for (j = 0; j <= NY; j++) {
            double *p = xyz + 3 * (i * (NY + 1) + j), x = 0.1 * i;
            p[0] = rolled ? radius * sin(x / radius) : x;
            p[1] = 0.1 * j;
            p[2] = rolled ? radius * cos(x / radius) : 0;
        }
    for (i = 0; i < NX; i++)
        for (j = 0; j < NY; j++) {
            const int32_t f = i * NY + j, a = i * (NY + 1) + j, b = a + NY + 1;
            const int32_t corner[4] = {a, b, b + 1, a + 1};
            ptr[f] = 4 * f;
            memcpy(idx + 4 * f, corner, sizeof corner);
        }
    ptr[N_FACES] = 4 * N_FACES;
}

static double straight(const double *xyz, int32_t i, int32_t j) {
    const double *p = xyz + 3 * i, *q = xyz + 3 * j, x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return sqrt(x * x + y * y + z * z);
}

int main(void) {
    static double xyz[2][3 * N], D[2][MARKS * N];
    static int64_t ptr[N_FACES + 1];
    static int32_t idx[4 * N_FACES];
    hd_geodesic_opts opts = {0};
    hd_geodesic_report report;
    hd_error err;
    double most = 0, most_straight = 0;
    int32_t size[MARKS], moved = 0, i, k, q;
    int way;

    opts.border = HD_GEODESIC_BORDER_MEAN;               /* the sheet has one: see hd_geodesic_border */
    opts.t_in_h2 = 8;
    for (way = 0; way < 2; way++) {
        hd_mesh mesh = hd_triangles(xyz[way], N, idx, N_FACES);
        const hd_sources marks = hd_vertices(MARKS, mark);
        hd_geodesic *g = NULL;
        make_sheet(way, xyz[way], ptr, idx);
        mesh.shape = HD_POLYGONS;
        mesh.face_ptr = ptr;
        if (hd_geodesic_create(&g, &mesh, &opts, &err) < 0)
            return fprintf(stderr, "regions: %s\n", err.text), 1;
        if (hd_geodesic_distance(g, &marks, D[way], 0, &report, &err) < 0)
            return fprintf(stderr, "regions: %s\n", err.text), 1;
        hd_geodesic_free(g);
    }

    memset(size, 0, sizeof size);
    for (i = 0; i < N; i++) {
        int32_t nearest[2] = {0, 0};
        for (way = 0; way < 2; way++)
            for (k = 1; k < MARKS; k++)
                if (D[way][k * N + i] < D[way][nearest[way] * N + i]) nearest[way] = k;
        size[nearest[0]]++;
        moved += nearest[0] != nearest[1];
    }
    printf("%d squares, h = %.3g, t = %.3g; vertices in the regions:", (int)N_FACES, report.h, report.t);
    for (k = 0; k < MARKS; k++) printf(" %d", (int)size[k]);
    printf("\n%d of %d vertices are in another region of the rolled sheet\n", (int)moved, (int)N);

    puts("distances among the marks: flat, rolled (exact)");
    for (k = 0; k < MARKS; k++) {
        for (q = 0; q < k; q++) {                        /* the mean of both directions is symmetric */
            const double exact = straight(xyz[0], mark[k], mark[q]);
            const double flat = (D[0][k * N + mark[q]] + D[0][q * N + mark[k]]) / 2;
            const double rolled = (D[1][k * N + mark[q]] + D[1][q * N + mark[k]]) / 2;
            printf("  %.3f %.3f (%.3f)", flat, rolled, exact);
            most = fmax(most, fabs(rolled - flat) / exact);
            most_straight = fmax(most_straight, fabs(straight(xyz[1], mark[k], mark[q]) - exact) / exact);
        }
        if (k) puts("");
    }
    printf("rolling changes them by at most %.2f %%, and straight lines by %.0f %%\n", 100 * most,
           100 * most_straight);
    return 0;
}
