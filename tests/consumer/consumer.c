/* Heat on an octahedron, as a program of a user would compute it: with the implementation in this file, or, with CONSUMER_SHARED, from
 * the shared library. */
#ifndef CONSUMER_SHARED
#define HEATDIFF_IMPLEMENTATION
#endif
#include <heatdiff.h>
#include <stdio.h>

int main(void) {
    static const double xyz[] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const int32_t tri[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    double u[6];
    const hd_mesh mesh = hd_triangles(xyz, 6, tri, 8);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    if (hd_laplacian_create(&lap, &mesh, NULL, NULL) < 0 || hd_heat_create(&heat, lap, NULL, NULL) < 0 ||
        hd_heat_column(heat, HD_KERNEL_OPERATOR, 1.0, 0, u, NULL, NULL) < 0)
        return 1;
    printf("%d.%d.%d %.6f %.6f\n", HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH, u[0], u[1]);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
