/* polygon_mesh.c - heat on a mesh of polygons

   Build and run from the project's folder:

       cc -O2 examples/polygon_mesh.c -o polygon_mesh -lm && ./polygon_mesh

   A sphere is made of quadrilaterals and of two caps with 64 corners each. The polygon Laplacian takes these
   faces as they are. Splitting them into triangles gives another operator, which depends on the diagonals
   chosen. The heat kernel of the unit sphere is known: k_t = sum (2l+1)/(4 pi) exp(-l(l+1) t) P_l(cos angle).
   The example prints how far both operators are from it, for a source on the equator. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { AROUND = 64, RINGS = 31, N = AROUND * RINGS, FACES = AROUND * (RINGS - 1) + 2 };
enum { SOURCE = RINGS / 2 * AROUND };   /* a vertex on the equator */

static double xyz[3 * N], u[N];
static int64_t face_ptr[FACES + 1];
static int32_t face_idx[4 * AROUND * (RINGS - 1) + 2 * AROUND];

static void make_sphere(void) {
    int32_t i, j, f = 0;
    int64_t c = 0;
    for (j = 0; j < RINGS; j++) {
        const double latitude = 3.14159265358979 * ((j + 1.0) / (RINGS + 1) - 0.5);
        for (i = 0; i < AROUND; i++) {
            double *p = xyz + 3 * (j * AROUND + i);
            p[0] = cos(latitude) * cos(6.283185307179586 * i / AROUND);
            p[1] = cos(latitude) * sin(6.283185307179586 * i / AROUND);
            p[2] = sin(latitude);
        }
    }
    for (j = 0; j + 1 < RINGS; j++) {
        for (i = 0; i < AROUND; i++) {
            const int32_t a = j * AROUND + i, b = j * AROUND + (i + 1) % AROUND;
            face_idx[c++] = a;
            face_idx[c++] = b;
            face_idx[c++] = b + AROUND;
            face_idx[c++] = a + AROUND;
            face_ptr[++f] = c;
        }
    }
    for (i = 0; i < AROUND; i++) face_idx[c++] = AROUND - 1 - i;     /* the caps: two faces of many corners */
    face_ptr[++f] = c;
    for (i = 0; i < AROUND; i++) face_idx[c++] = (RINGS - 1) * AROUND + i;
    face_ptr[++f] = c;
}

static double exact(double t, double z) {
    double before = 1, now = z, sum = 1 + 3 * exp(-2 * t) * z;
    int l;
    for (l = 2; l < 200; l++) {                                      /* Legendre polynomials by recurrence */
        const double next = ((2 * l - 1) * z * now - (l - 1) * before) / l;
        before = now;
        now = next;
        sum += (2 * l + 1) * exp(-l * (l + 1) * t) * now;
    }
    return sum / (4 * 3.14159265358979);
}

/* Largest difference of the symmetric kernel's column from the sphere's, relative to the largest value.
 * Negative after an error. */
static double error_of(hd_laplacian_kind kind, double t) {
    hd_laplacian_opts opts;
    hd_mesh mesh = hd_triangles(xyz, N, face_idx, FACES);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_report report;
    hd_error err;
    double worst = 0;
    int32_t i;
    memset(&opts, 0, sizeof opts);
    opts.kind = kind;
    mesh.shape = HD_POLYGONS;
    mesh.face_ptr = face_ptr;
    if (hd_laplacian_create(&lap, &mesh, &opts, &err) < 0) {
        fprintf(stderr, "polygon_mesh: %s (face %lld)\n", err.text, (long long)err.face);
        return -1;
    }
    if (hd_heat_create(&heat, lap, NULL, &err) < 0 ||
        hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, SOURCE, u, &report, NULL) < 0) worst = -1;
    for (i = 0; i < N && worst >= 0; i++) {
        const double *p = xyz + 3 * i, *q = xyz + 3 * SOURCE;
        const double cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        worst = fmax(worst, fabs(u[i] - exact(t, cosine)) / exact(t, 1));
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return worst;
}

int main(void) {
    static const double times[] = {0.02, 0.1, 0.5};
    int k;
    make_sphere();
    printf("sphere: %d vertices, %d faces, two of them with %d corners\n", (int)N, (int)FACES, (int)AROUND);
    for (k = 0; k < 3; k++) {
        const double polygon = error_of(HD_LAPLACIAN_POLYGON, times[k]);
        const double fans = error_of(HD_LAPLACIAN_VORONOI_COT, times[k]);
        if (polygon < 0 || fans < 0) return 1;
        printf("t = %4.2f: error against the sphere %.1e of the largest value, split into triangles %.1e\n",
               times[k], polygon, fans);
    }
    return 0;
}
