/* vertex_buffer.c - a mesh straight from the buffers of a renderer, heat painted into its colours, frame by frame

   Build and run from the project's folder:

       cc -O2 examples/vertex_buffer.c -o vertex_buffer -lm && ./vertex_buffer

   A vertex is 20 bytes: three floats of its position, a packed normal, a packed colour. Indices have 16 bits. The
   library reads both as they lie there. Each frame the surface moves in place, the Laplacian takes the new
   positions from the same buffer, and heat from one vertex goes back into the colours.

   Buffers of real models repeat vertices along seams of their textures. Weld those first: heat crosses no seam.
   Strips must be turned into lists of triangles. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

enum { NU = 160, NV = 64, N = NU * NV, FRAMES = 8 };

typedef struct vertex { float position[3]; int8_t normal[4]; uint8_t colour[4]; } vertex;

static vertex vertices[N];
static uint16_t indices[6 * N];

static void make_faces(void) {
    int i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const int a = i * NV + j, b = (i + 1) % NU * NV + j, c = (i + 1) % NU * NV + (j + 1) % NV, d = i * NV + (j + 1) % NV;
            const int corner[6] = {a, b, c, a, c, d};
            int q;
            for (q = 0; q < 6; q++) indices[6 * a + q] = (uint16_t)corner[q];
        }
    }
}

static void move(float phase) {
    int i, j;
    for (i = 0; i < NU; i++) {
        for (j = 0; j < NV; j++) {
            const float u = 6.2831853f * (float)i / NU, v = 6.2831853f * (float)j / NV, tube = 1 + 0.2f * sinf(3 * u + phase);
            float *p = vertices[i * NV + j].position;
            p[0] = (2 + tube * cosf(v)) * cosf(u);
            p[1] = (2 + tube * cosf(v)) * sinf(u);
            p[2] = tube * sinf(v) + 0.3f * sinf(2 * u + phase);
        }
    }
}

/* Red where it is warm, relative to the source. Returns how many vertices have more than a tenth. */
static int paint(const double *u, int source) {
    int i, warm = 0;
    for (i = 0; i < N; i++) {
        const double share = u[i] / u[source];
        vertices[i].colour[0] = (uint8_t)(255 * (share > 0 ? share : 0));
        warm += share > 0.1;
    }
    return warm;
}

static int fail(const hd_error *e) {
    fprintf(stderr, "vertex_buffer: %s: %s (face %ld, vertex %ld)\n", hd_status_name(e->status), e->text, (long)e->face, (long)e->vertex);
    return 1;
}

int main(void) {
    static double u[N];
    hd_mesh mesh = {0};
    hd_laplacian_opts opts = {0};
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_report report;
    hd_error err;
    double t;
    int frame;

    make_faces();
    move(0);
    mesh.xyz_float = vertices[0].position;
    mesh.stride = sizeof(vertex);
    mesh.n = N;
    mesh.corner_u16 = indices;
    mesh.n_faces = 2 * N;
    opts.updatable = 1;                          /* the mesh will move */
    if (hd_laplacian_create(&lap, &mesh, &opts, &err) < 0) return fail(&err);
    if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);
    t = 100 * lap->h * lap->h;

    for (frame = 1; frame <= FRAMES; frame++) {
        const clock_t since = clock();
        move(0.3f * (float)frame);
        if (hd_laplacian_update(lap, &mesh, &err) < 0) return fail(&err);
        if (hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, 0, u, &report, &err) < 0) return fail(&err);
        printf("frame %d: %d vertices are warm, error at most %.0e, %.1f ms\n", frame, paint(u, 0), report.error_bound,
               1e3 * (double)(clock() - since) / CLOCKS_PER_SEC);
    }
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
