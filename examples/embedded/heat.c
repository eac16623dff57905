/* heat.c - heat on a sphere without an operating system

   A program for a microcontroller, or for anything else that has neither malloc nor files. All memory that the
   library takes comes from a fixed array, by a small allocator. It makes a sphere in memory, lets heat spread
   from one vertex, by iterations and with a factorisation, and prints the values with the memory that they
   took.

   Build and run on this machine, from the project's folder:

       cc -O2 examples/embedded/heat.c -o heat -lm && ./heat

   and for a Cortex-M7 with QEMU (packages of Debian: gcc-arm-none-eabi, libnewlib-arm-none-eabi,
   qemu-system-arm):

       arm-none-eabi-gcc -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard -Os -ffunction-sections \
           -fdata-sections -nostartfiles examples/embedded/heat.c examples/embedded/start.c \
           -T examples/embedded/mps2.ld -Wl,--gc-sections -o heat.elf -lm
       qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none \
           -semihosting-config enable=on,target=native -kernel heat.elf

   Printing is the only thing that differs, see board_write. With -DTABLE the program finds out instead which
   meshes fit into 128, 256 and 512 KiB; tools/README.md shows that. */

/* Nothing may call malloc. A context without an allocator would be out of memory. */
#include <stddef.h>
#define HEATDIFF_MALLOC(size) ((void)(size), (void *)NULL)
#define HEATDIFF_FREE(p) ((void)(p))
#define HEATDIFF_NO_THREADS
#ifdef __arm__
#define HEATDIFF_ASSERT(x) ((void)0)             /* newlib's assert prints by stdio */
#endif
#define HEATDIFF_IMPLEMENTATION
#include "../../heatdiff.h"

/* ---- the board ---- */

#ifdef __arm__
void board_write(const char *text);              /* start.c */
size_t board_code_bytes(void);                   /* code and constants */
size_t board_stack_bytes(void);                  /* the deepest the stack has been */
#else
#include <stdio.h>
static void board_write(const char *text) { fputs(text, stdout); }
static size_t board_code_bytes(void) { return 0; }
static size_t board_stack_bytes(void) { return 0; }
#endif

static void write_number(uint64_t value, unsigned base, int digits) {
    char text[24];
    int at = (int)sizeof text - 1;
    text[at] = 0;
    do {
        text[--at] = "0123456789abcdef"[value % base];
        value /= base;
    } while (value > 0 || (int)sizeof text - 1 - at < digits);
    board_write(text + at);
}

/* Six decimals for people, and all bits for those who compare. */
static void write_value(const char *name, double value) {
    const double size = value < 0 ? -value : value;
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    board_write(name);
    board_write(value < 0 ? " -" : " ");
    write_number((uint64_t)size, 10, 1);
    board_write(".");
    write_number((uint64_t)((size - (double)(uint64_t)size) * 1e6), 10, 6);
    board_write(" bits ");
    write_number(bits, 16, 16);
    board_write("\n");
}

static void write_count(const char *before, uint64_t value, const char *after) {
    board_write(before);
    write_number(value, 10, 1);
    board_write(after);
}

/* ---- memory ---- */

/* First fit. Free blocks are kept by their addresses and joined with their neighbours. */
typedef struct block { struct block *next; size_t size; } block;
typedef struct arena { unsigned char *base; block *free; size_t used; } arena;

#ifdef TABLE
static uint64_t memory[(3 << 20) / 8];
#else
static uint64_t memory[(256 << 10) / 8];
#endif

static size_t arena_round(size_t size) { return (size + sizeof(block) - 1) / sizeof(block) * sizeof(block); }

static void arena_begin(arena *a, size_t size) {
    a->base = (unsigned char *)memory;
    a->free = (block *)(void *)memory;
    a->free->next = NULL;
    a->free->size = size;
    a->used = 0;
}

static void *arena_alloc(void *user, size_t size) {
    arena *a = (arena *)user;
    block **link = &a->free, *b, *rest;
    size_t end;
    size = arena_round(size);
    while (*link && (*link)->size < size) link = &(*link)->next;
    b = *link;
    if (!b) return NULL;
    if (b->size > size) {
        rest = (block *)(void *)((unsigned char *)b + size);
        rest->next = b->next;
        rest->size = b->size - size;
        *link = rest;
    } else {
        *link = b->next;
    }
    end = (size_t)((unsigned char *)b - a->base) + size;
    if (end > a->used) a->used = end;
    return b;
}

static void arena_free(void *user, void *p, size_t size) {
    arena *a = (arena *)user;
    block **link = &a->free, *b = (block *)p, *before = NULL;
    while (*link && *link < b) {
        before = *link;
        link = &before->next;
    }
    b->size = arena_round(size);
    b->next = *link;
    *link = b;
    if (b->next && (unsigned char *)b + b->size == (unsigned char *)b->next) {
        b->size += b->next->size;
        b->next = b->next->next;
    }
    if (before && (unsigned char *)before + before->size == (unsigned char *)b) {
        before->size += b->size;
        before->next = b->next;
    }
}

/* ---- meshes ---- */

enum { LEVELS = 3, MOST = 642, MOST_TRI = 1280 };

static double xyz[3 * MOST], heat_at[MOST];
static int32_t tri[3 * MOST_TRI];
static int32_t n_vertices, n_triangles;

/* The middle of edge (i, j), on the sphere. The same point may have been made from the other side already. */
static int32_t middle(int32_t i, int32_t j) {
    double p[3], norm = 0;
    int32_t k, c;
    for (c = 0; c < 3; c++) {
        p[c] = xyz[3 * i + c] + xyz[3 * j + c];
        norm += p[c] * p[c];
    }
    for (c = 0; c < 3; c++) p[c] /= sqrt(norm);
    for (k = 12; k < n_vertices; k++) {
        const double *q = xyz + 3 * k;
        if (fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]) < 1e-9) return k;
    }
    memcpy(xyz + 3 * n_vertices, p, sizeof p);
    return n_vertices++;
}

/* An icosahedron, refined: 12, 42, 162 or 642 vertices. Each triangle becomes its own middle one, and three
 * more at the end of the list. */
static void make_sphere(int level) {
    static const int8_t corners[12][2] = {{-1, 1}, {1, 1}, {-1, -1}, {1, -1}};
    static const int8_t faces[60] = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2,
                                     10, 7, 6, 7, 1, 8, 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5,
                                     2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1};
    const double golden = 0.5 + 0.5 * sqrt(5.0), norm = sqrt(1 + golden * golden);
    int32_t i, k, count;
    for (i = 0; i < 12; i++) {                   /* (+-1, +-golden, 0) and its turns */
        const int turn = i / 4;
        xyz[3 * i + turn % 3] = corners[i % 4][0] / norm;
        xyz[3 * i + (turn + 1) % 3] = corners[i % 4][1] * golden / norm;
        xyz[3 * i + (turn + 2) % 3] = 0;
    }
    n_vertices = 12;
    n_triangles = 20;
    for (i = 0; i < 60; i++) tri[i] = faces[i];
    for (; level > 0; level--) {
        for (i = 0, count = n_triangles; i < count; i++) {
            int32_t *t = tri + 3 * i, m[3];
            for (k = 0; k < 3; k++) m[k] = middle(t[k], t[(k + 1) % 3]);
            for (k = 0; k < 3; k++) {
                int32_t *more = tri + 3 * n_triangles++;
                more[0] = t[k];
                more[1] = m[k];
                more[2] = m[(k + 2) % 3];
            }
            memcpy(t, m, sizeof m);
        }
    }
}

#ifdef TABLE
static void make_grid(int32_t side) {
    int32_t i, j, *t = tri;
    n_vertices = side * side;
    for (i = 0; i < n_vertices; i++) {
        xyz[3 * i] = i % side;
        xyz[3 * i + 1] = i / side;
        xyz[3 * i + 2] = 0;
    }
    for (i = 0; i + 1 < side; i++) {
        for (j = 0; j + 1 < side; j++) {
            const int32_t p = i * side + j, two[6] = {p, p + 1, p + side + 1, p, p + side + 1, p + side};
            memcpy(t, two, sizeof two);
            t += 6;
        }
    }
    n_triangles = (int32_t)(t - tri) / 3;
}
#endif

/* ---- heat ---- */

/* Heat from vertex 0 at t = 10 h^2, in `size` bytes. peak: the part of them that was ever used. */
static hd_status work(size_t size, hd_laplacian_kind kind, hd_method method, size_t *peak) {
    hd_context ctx;
    hd_laplacian_opts lap_opts;
    hd_heat_opts heat_opts;
    const hd_mesh mesh = hd_triangles(xyz, n_vertices, tri, n_triangles);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_status status;
    arena a;
    arena_begin(&a, size);
    memset(&ctx, 0, sizeof ctx);
    ctx.allocator.alloc = arena_alloc;
    ctx.allocator.free = arena_free;
    ctx.allocator.user = &a;
    ctx.byte_limit = size;                       /* so that the library takes ways that need less in time */
    memset(&lap_opts, 0, sizeof lap_opts);
    lap_opts.context = &ctx;
    lap_opts.kind = kind;
    memset(&heat_opts, 0, sizeof heat_opts);
    heat_opts.method = method;
    status = hd_laplacian_create(&lap, &mesh, &lap_opts, NULL);
    if (status >= 0) status = hd_heat_create(&heat, lap, &heat_opts, NULL);
    if (status >= 0)
        status = hd_heat_column(heat, HD_KERNEL_OPERATOR, 10 * lap->h * lap->h, 0, heat_at, NULL, NULL);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    *peak = a.used;
    return ctx.bytes_in_use > 0 ? HD_ERR_MEMORY : status;
}

#ifndef TABLE
static int show(const char *name, size_t size, hd_laplacian_kind kind, hd_method method) {
    size_t peak;
    const hd_status status = work(size, kind, method, &peak);
    write_count("", (uint64_t)n_vertices, " vertices ");
    board_write(name);
    write_count(", in ", size, " bytes: ");
    board_write(hd_status_text(status));
    write_count(", peak ", peak, "");
    write_count(", deepest stack until now ", board_stack_bytes(), "\n");
    if (status < 0) return 1;
    write_value("  at the source ", heat_at[0]);
    write_value("  beside it     ", heat_at[12]);
    write_value("  far away      ", heat_at[3]);
    return 0;
}

int main(void) {
    int failed;
    make_sphere(2);
    failed = show("by iterations", 128 << 10, HD_LAPLACIAN_FEM, HD_METHOD_ITERATIVE);
    failed |= show("by iterations, Voronoi areas", 128 << 10, HD_LAPLACIAN_VORONOI_COT, HD_METHOD_ITERATIVE);
    failed |= show("with one real factor", 256 << 10, HD_LAPLACIAN_FEM, HD_METHOD_KRYLOV);
    make_sphere(1);
    failed |= show("with the factors of the poles", 256 << 10, HD_LAPLACIAN_FEM, HD_METHOD_DIRECT);
    write_count("code and constants ", board_code_bytes(), " bytes\n");
    write_count("deepest stack ", board_stack_bytes(), " bytes\n");
    return failed;
}
#else
static void table_row(const char *mesh) {
    static const struct { const char *name; hd_laplacian_kind kind; hd_method method; } way[4] = {
        {"iterations, fem", HD_LAPLACIAN_FEM, HD_METHOD_ITERATIVE},
        {"iterations, voronoi-cot", HD_LAPLACIAN_VORONOI_COT, HD_METHOD_ITERATIVE},
        {"krylov, fem", HD_LAPLACIAN_FEM, HD_METHOD_KRYLOV},
        {"direct, fem", HD_LAPLACIAN_FEM, HD_METHOD_DIRECT}};
    size_t peak, room;
    int i;
    for (i = 0; i < 4; i++) {
        board_write(mesh);
        write_count(" ", (uint64_t)n_vertices, ", ");
        board_write(way[i].name);
        if (work(sizeof memory, way[i].kind, way[i].method, &peak) < 0) {
            board_write(": does not fit at all\n");
            continue;
        }
        write_count(": takes ", (peak + 1023) / 1024, " KiB;");
        /* with less, to the KiB */
        for (room = 1 << 10; work(room, way[i].kind, way[i].method, &peak) < 0; room += 1 << 10) { }
        write_count(" needs ", room >> 10, " KiB\n");
    }
}

int main(void) {
    make_sphere(1);
    table_row("sphere");
    make_sphere(2);
    table_row("sphere");
    make_sphere(3);
    table_row("sphere");
    make_grid(8);
    table_row("grid");
    make_grid(16);
    table_row("grid");
    make_grid(24);
    table_row("grid");
    write_count("code and constants ", board_code_bytes(), " bytes\n");
    write_count("deepest stack ", board_stack_bytes(), " bytes\n");
    return 0;
}
#endif
