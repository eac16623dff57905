/* own_allocator.c - memory of your own, a memory limit, and cancelling

   Build and run from the project's folder:

       cc -O2 examples/own_allocator.c -o own_allocator -lm && ./own_allocator

   All memory that the library needs comes from a buffer of 32 MiB. The allocator is a stack: it counts the
   bytes in use, and starts over when all blocks are freed. Then the same work runs with too low a limit, and
   once more with a progress callback that cancels it. Both return an ordinary status, with everything
   freed. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <stdio.h>
#include <string.h>

typedef struct arena { unsigned char *base; size_t size, used, out; } arena;

static void *arena_alloc(void *user, size_t size) {
    arena *a = (arena *)user;
    const size_t at = (a->used + 15) / 16 * 16;
    if (size > a->size || at > a->size - size) return NULL;
    a->used = at + size;
    a->out += size;
    return a->base + at;
}

static void arena_free(void *user, void *block, size_t size) {
    arena *a = (arena *)user;
    a->out -= size;
    /* The last block is free at once. */
    if ((unsigned char *)block + size == a->base + a->used) a->used -= size;
    if (a->out == 0) a->used = 0;
}

static hd_progress count_down(void *user, const char *stage, double done) {
    int *left = (int *)user;
    (void)stage;
    (void)done;
    return (*left)-- > 0 ? HD_PROGRESS_CONTINUE : HD_PROGRESS_CANCEL;
}

enum { SIDE = 60, N = SIDE * SIDE };

static hd_status work(hd_context *ctx, const double *xyz, const int32_t *tri, double *u) {
    hd_laplacian_opts lap_opts;
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * (SIDE - 1) * (SIDE - 1));
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_status status;
    memset(&lap_opts, 0, sizeof lap_opts);
    lap_opts.context = ctx;
    status = hd_laplacian_create(&lap, &mesh, &lap_opts, NULL);
    if (status >= 0) status = hd_heat_create(&heat, lap, NULL, NULL);
    if (status >= 0) status = hd_heat_column(heat, HD_KERNEL_OPERATOR, 50 * lap->h * lap->h, N / 2, u, NULL, NULL);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return status;
}

int main(void) {
    static unsigned char memory[32 << 20];
    static double xyz[3 * N], u[N];
    static int32_t tri[6 * (SIDE - 1) * (SIDE - 1)];
    arena a;
    hd_context ctx;
    hd_status status;
    int32_t i, j, *t = tri;
    int left = 5;

    for (i = 0; i < N; i++) {
        xyz[3 * i] = i % SIDE;
        xyz[3 * i + 1] = i / SIDE;
    }
    for (i = 0; i + 1 < SIDE; i++) {
        for (j = 0; j + 1 < SIDE; j++) {
            const int32_t p = i * SIDE + j;
            *t++ = p; *t++ = p + 1; *t++ = p + SIDE + 1;
            *t++ = p; *t++ = p + SIDE + 1; *t++ = p + SIDE;
        }
    }
    memset(&a, 0, sizeof a);
    a.base = memory;
    a.size = sizeof memory;
    memset(&ctx, 0, sizeof ctx);
    ctx.allocator.alloc = arena_alloc;
    ctx.allocator.free = arena_free;
    ctx.allocator.user = &a;

    status = work(&ctx, xyz, tri, u);
    printf("from a buffer: %s, value at the source %.4e, at most %llu bytes in %llu allocations,"
           " not freed: %llu\n",
           hd_status_text(status), u[N / 2], (unsigned long long)ctx.bytes_peak,
           (unsigned long long)ctx.allocations, (unsigned long long)ctx.bytes_in_use);
    if (status < 0) return 1;

    ctx.byte_limit = ctx.bytes_peak / 16;
    status = work(&ctx, xyz, tri, u);
    printf("with a sixteenth of that: %s; not freed: %llu\n", hd_status_text(status),
           (unsigned long long)ctx.bytes_in_use);
    if (status != HD_ERR_MEMORY_LIMIT) return 1;

    ctx.byte_limit = 0;
    ctx.progress = count_down;
    ctx.progress_user = &left;
    status = work(&ctx, xyz, tri, u);
    printf("stopped after a few callbacks: %s; not freed: %llu\n", hd_status_text(status),
           (unsigned long long)ctx.bytes_in_use);
    return status == HD_ERR_CANCELLED && ctx.bytes_in_use == 0 ? 0 : 1;
}
