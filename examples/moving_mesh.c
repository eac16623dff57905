/* moving_mesh.c - heat on a surface that moves: the same faces, new coordinates every frame

   Build and run from the project's folder:

       cc -O2 examples/moving_mesh.c -o moving_mesh -lm && ./moving_mesh

   A torus swings. In every frame the Laplacian takes the new coordinates, and the plans for heat and for
   distances go on with the ordering and the analysis that they have. The last line compares the mean time of
   a frame with that of making everything anew. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

enum { NU = 160, NV = 64, N = NU * NV, FRAMES = 12 };

static void make_faces(int32_t *tri) {
    int32_t i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const int32_t next_i = (i + 1) % NU, next_j = (j + 1) % NV;
            const int32_t a = i * NV + j, b = next_i * NV + j, c = next_i * NV + next_j, d = i * NV + next_j;
            int32_t *t = tri + 6 * a;
            t[0] = a; t[1] = b; t[2] = c;
            t[3] = a; t[4] = c; t[5] = d;
        }
    }
}

static void move(double *xyz, double phase) {
    int32_t i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const double u = 6.283185307179586 * i / NU, v = 6.283185307179586 * j / NV;
            const double tube = 1 + 0.2 * sin(3 * u + phase);
            double *p = xyz + 3 * (i * NV + j);
            p[0] = (2 + tube * cos(v)) * cos(u);
            p[1] = (2 + tube * cos(v)) * sin(u);
            p[2] = tube * sin(v) + 0.3 * sin(2 * u + phase);
        }
    }
}

static double seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

static int fail(const hd_error *e) {
    fprintf(stderr, "moving_mesh: %s: %s\n", hd_status_name(e->status), e->text);
    return 1;
}

int main(void) {
    static double xyz[3 * N], u[N];
    static int32_t tri[6 * N];
    hd_laplacian_opts opts = {0};
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL, *other = NULL;
    hd_heat *heat = NULL, *anew = NULL;
    hd_report report;
    hd_error err;
    double t, moving = 0, making = 0, since;
    int frame;

    make_faces(tri);
    move(xyz, 0);
    opts.updatable = 1;
    if (hd_laplacian_create(&lap, &mesh, &opts, &err) < 0) return fail(&err);
    if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);
    t = 30 * lap->h * lap->h;
    if (hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, 0, u, &report, &err) < 0) return fail(&err);

    for (frame = 1; frame <= FRAMES; frame++) {
        move(xyz, 0.3 * frame);

        since = seconds();
        if (hd_laplacian_update(lap, &mesh, &err) < 0) return fail(&err);
        if (hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, 0, u, &report, &err) < 0) return fail(&err);
        moving += seconds() - since;
        printf("frame %2d: heat at the source %.6f, half way round %.6f, error at most %.0e of the largest\n",
               frame, u[0], u[N / 2], report.error_bound);

        since = seconds();
        if (hd_laplacian_create(&other, &mesh, NULL, &err) < 0) return fail(&err);
        if (hd_heat_create(&anew, other, NULL, &err) < 0) return fail(&err);
        if (hd_heat_column(anew, HD_KERNEL_SYMMETRIC, t, 0, u, NULL, &err) < 0) return fail(&err);
        making += seconds() - since;
        hd_heat_free(anew);
        hd_laplacian_free(other);
    }
    printf("%d vertices: %.1f ms a frame, %.1f ms when all is made anew\n", (int)N, 1e3 * moving / FRAMES,
           1e3 * making / FRAMES);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
