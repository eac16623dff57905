/* patches.c - the signature of a mesh that is too large for one factorisation: file to file, piece by piece

   Build and run from the project's folder:

       cc -O2 examples/patches.c -o patches -lm && ./patches -size 200 -piece 10000 signature.npy
       ./patches -memory 6 -t 10 -t 100 scan.ply signature.npy
       mpirun -np 4 ./patches scan.ply signature.npy

   The vertices are cut into pieces along a curve that fills space. For each piece the library makes patches:
   the piece, or parts of it, with margins as wide as heat reaches. A finished piece is a file of its own beside
   the answer, so that a run that was stopped goes on where it was. Several processes take the pieces in turn.
   They share nothing but these files, need no MPI library, and give the same bits in any number. Whoever finds
   all pieces there writes the answer, [vertices][times] of k_t(v,v) in the .npy format.

   Options:
     -size N              a wavy sheet of N x N vertices in place of a file (OBJ, OFF, PLY, STL)
     -t C                 a time in h^2, h being the mean length of an edge; up to 8 of them (10)
     -piece K             vertices of a piece (100000)
     -memory G            byte limit in GB; patches become as small as it asks for (none)
     -kind NAME           fem, or voronoi-cot (the default)
     -rank R -ranks N     which of how many processes; else what mpirun or srun say */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-function"     /* meshio.h does more */
#endif
#include "../tools/meshio.h"

#include <time.h>

enum { TIMES = 8 };

typedef struct settings {
    const char *mesh, *out;
    int size, piece, rank, ranks, n_times, fem;
    double t[TIMES], memory;
} settings;

/* What stands before the values in the file of a piece. */
typedef struct head { int64_t n, first, count, n_times; double t[TIMES], bound; } head;

/* A vertex and its place on the curve. */
typedef struct place { uint64_t key; int32_t vertex; } place;

static int from_environment(const char *a, const char *b, const char *c, int otherwise) {
    const char *const names[3] = {a, b, c};
    int k;
    for (k = 0; k < 3; k++)
        if (getenv(names[k])) return atoi(getenv(names[k]));
    return otherwise;
}

static int read_options(settings *s, int argc, char **argv) {
    int k;
    memset(s, 0, sizeof *s);
    s->piece = 100000;
    s->rank = from_environment("OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID", 0);
    s->ranks = from_environment("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_NTASKS", 1);
    for (k = 1; k < argc; k++) {
        const char *const name = argv[k], *value = "";
        if (name[0] == '-' && k + 1 < argc) value = argv[++k];
        if (name[0] != '-') *(s->mesh ? &s->out : &s->mesh) = name;
        else if (strcmp(name, "-size") == 0) s->size = atoi(value);
        else if (strcmp(name, "-t") == 0 && s->n_times < TIMES) s->t[s->n_times++] = atof(value);
        else if (strcmp(name, "-piece") == 0) s->piece = atoi(value);
        else if (strcmp(name, "-memory") == 0) s->memory = atof(value);
        else if (strcmp(name, "-kind") == 0) s->fem = strcmp(value, "fem") == 0;
        else if (strcmp(name, "-rank") == 0) s->rank = atoi(value);
        else if (strcmp(name, "-ranks") == 0) s->ranks = atoi(value);
        else return 0;
    }
    if (s->size > 0) s->out = s->mesh;
    if (s->n_times == 0) s->t[s->n_times++] = 10;
    return s->out && (s->size > 1 || s->mesh) && s->piece > 0 && s->ranks > 0 && s->rank >= 0;
}

static int fail(const char *what, const char *why) {
    fprintf(stderr, "patches: %s: %s\n", what, why);
    return 1;
}

/* A sheet of unit squares, cut into triangles. */
static void make_sheet(int side, double *xyz, int32_t *tri) {
    int32_t i, j, v;
    for (i = 0; i < side; i++)
        for (j = 0; j < side; j++, xyz += 3) {
            xyz[0] = i + 0.2 * sin(12.9 * i + 78.2 * j);
            xyz[1] = j + 0.2 * sin(39.4 * i + 11.1 * j);
            xyz[2] = 0.05 * side * sin(9.0 * i / side) * cos(7.0 * j / side);
            if (i + 1 == side || j + 1 == side) continue;
            v = i * side + j;
            tri[0] = tri[3] = v;
            tri[1] = v + side;
            tri[2] = tri[4] = v + side + 1;
            tri[5] = v + 1;
            tri += 6;
        }
}

/* Makes the Laplacian. The mesh itself is gone afterwards. */
static int make_pair(const settings *s, hd_laplacian **lap, hd_context *context) {
    const size_t side = (size_t)s->size;
    hd_laplacian_opts opts = {0};
    hd_mesh mesh;
    hd_error err;
    mio_error e;
    mio_mesh m;
    int32_t *tri = NULL, n_tri = 0;
    memset(&m, 0, sizeof m);
    if (s->size > 0) {
        m.n = s->size * s->size;
        n_tri = 2 * (s->size - 1) * (s->size - 1);
        m.xyz = malloc(3 * side * side * sizeof *m.xyz);
        tri = malloc(6 * side * side * sizeof *tri);
        if (!m.xyz || !tri) return fail("mesh", "not enough memory");
        make_sheet(s->size, m.xyz, tri);
    } else if (mio_load(&m, s->mesh, NULL, &e) != MIO_OK ||
               mio_triangulate(&m, &tri, &n_tri, NULL, &e) != MIO_OK) {
        return fail("mesh", e.text);
    }
    mesh = hd_triangles(m.xyz, m.n, tri, n_tri);
    opts.kind = s->fem ? HD_LAPLACIAN_FEM : HD_LAPLACIAN_VORONOI_COT;
    opts.context = context;
    if (hd_laplacian_create(lap, &mesh, &opts, &err) < 0) return fail("laplacian", err.text);
    free(tri);
    mio_free(&m);
    return 0;
}

static int compare_places(const void *a, const void *b) {
    const place *p = a, *q = b;
    return p->key < q->key ? -1 : p->key > q->key ? 1 : p->vertex < q->vertex ? -1 : 1;
}

/* Orders the vertices along a curve that fills their box: by the bits of their coordinates in turn. */
static place *make_places(const hd_laplacian *lap) {
    place *at = malloc((size_t)lap->n * sizeof *at);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, size = 0;
    int32_t v, c, bit;
    for (v = 0; at && v < lap->n_active; v++)
        for (c = 0; c < 3; c++) low[c] = fmin(low[c], lap->xyz[3 * (int64_t)v + c]);
    for (v = 0; at && v < lap->n_active; v++)
        for (c = 0; c < 3; c++) size = fmax(size, lap->xyz[3 * (int64_t)v + c] - low[c]);
    for (v = 0; at && v < lap->n; v++) {
        const int32_t row = lap->row[v];
        at[v].key = 0;
        at[v].vertex = v;
        for (bit = 19; bit >= 0 && row >= 0; bit--)
            for (c = 0; c < 3; c++) {
                const double x = (lap->xyz[3 * (int64_t)row + c] - low[c]) / size;
                at[v].key = at[v].key << 1 | ((uint64_t)(x * 1048575) >> bit & 1);
            }
    }
    if (at) qsort(at, (size_t)lap->n, sizeof *at, compare_places);
    return at;
}

static void name_piece(const settings *s, int64_t first, char *name, size_t room) {
    snprintf(name, room, "%s.%lld", s->out, (long long)(first / s->piece));
}

/* Opens the file of a finished piece of this very question. */
static FILE *open_piece(const settings *s, const head *want, head *found) {
    char name[4096];
    FILE *f;
    name_piece(s, want->first, name, sizeof name);
    f = fopen(name, "rb");
    if (f && fread(found, sizeof *found, 1, f) == 1 && memcmp(found, want, offsetof(head, bound)) == 0) return f;
    if (f) fclose(f);
    return NULL;
}

/* Writes a piece beside its place, and moves it there at the end. */
static int write_piece(const settings *s, const head *h, const double *values) {
    char name[4096], part[4200];
    const size_t count = (size_t)(h->count * h->n_times);
    FILE *f;
    int fine;
    name_piece(s, h->first, name, sizeof name);
    snprintf(part, sizeof part, "%s.part%d", name, s->rank);
    f = fopen(part, "wb");
    if (!f) return fail(part, strerror(errno));
    fine = fwrite(h, sizeof *h, 1, f) == 1 && fwrite(values, sizeof *values, count, f) == count;
    fine = fclose(f) == 0 && fine;
    return fine && rename(part, name) == 0 ? 0 : fail(part, strerror(errno));
}

/* One piece: the diagonal at its vertices. */
static int run_piece(const settings *s, hd_heat *heat, const place *at, head *h, int32_t *vertex, double *values) {
    const clock_t begin = clock();
    hd_report rep;
    hd_error err;
    int64_t k;
    for (k = 0; k < h->count; k++) vertex[k] = at[h->first + k].vertex;
    if (hd_heat_entries(heat, HD_KERNEL_SYMMETRIC, s->n_times, h->t, h->count, vertex, vertex, values, &rep,
                        &err) < 0) return fail("signature", err.text);
    h->bound = rep.error_bound;
    fprintf(stderr, "process %d: piece %lld of %lld, %d patches, %.1f s, off by %.0e of the largest at most\n",
            s->rank, (long long)(h->first / s->piece), (long long)((h->n - 1) / s->piece + 1),
            (int)rep.n_patches, (double)(clock() - begin) / CLOCKS_PER_SEC, rep.error_bound);
    return write_piece(s, h, values);
}

/* The answer from all pieces, if they are there. */
static int join(const settings *s, const head *all, const place *at, double *values) {
    double *D = malloc((size_t)(all->n * all->n_times) * sizeof *D), bound = 0;
    mio_output out;
    mio_error e;
    char part[4200];
    head want = *all, found;
    int64_t k, m;
    if (!D) return fail("answer", "not enough memory");
    for (want.first = 0; want.first < all->n; want.first += s->piece) {
        FILE *f;
        want.count = want.n - want.first < s->piece ? want.n - want.first : s->piece;
        f = open_piece(s, &want, &found);
        if (!f) return free(D), 0;               /* another process is at work on it */
        k = (int64_t)fread(values, sizeof *values, (size_t)(want.count * want.n_times), f);
        fclose(f);
        if (k < want.count * want.n_times) return free(D), fail("answer", "a piece cannot be read");
        for (m = 0; m < want.n_times; m++)
            for (k = 0; k < want.count; k++) D[m * all->n + at[want.first + k].vertex] = values[m * want.count + k];
        bound = fmax(bound, found.bound);
    }
    memset(&out, 0, sizeof out);
    out.rows = out.ld = all->n;
    out.cols = (int32_t)all->n_times;
    out.values = D;
    snprintf(part, sizeof part, "%s.part%d", s->out, s->rank);
    k = mio_write_npy(part, &out, &e) == MIO_OK && rename(part, s->out) == 0;
    free(D);
    if (!k) return fail("answer", part);
    printf("%s: %lld vertices, %d times, off by %.0e of the largest value nearby at most\n", s->out,
           (long long)all->n, s->n_times, bound);
    return 0;
}

int main(int argc, char **argv) {
    hd_context context = {0};
    hd_heat_opts opts = {0};
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_error err;
    settings s;
    head h, found;
    place *at;
    double *values;
    int32_t *vertex;
    int64_t k = 0;
    int status = 0, q;
    if (!read_options(&s, argc, argv)) return fail("options", "patches [OPTIONS] [MESH] OUT.npy, see the file");
    context.byte_limit = (uint64_t)(s.memory * 1e9);
    opts.method = HD_METHOD_LOCAL;
    if (make_pair(&s, &lap, &context)) return 1;
    if (hd_heat_create(&heat, lap, &opts, &err) < 0) return fail("plan", err.text);
    at = make_places(lap);
    values = malloc((size_t)s.piece * (size_t)s.n_times * sizeof *values);
    vertex = malloc((size_t)s.piece * sizeof *vertex);
    if (!at || !values || !vertex) return fail("pieces", "not enough memory");
    memset(&h, 0, sizeof h);
    h.n = lap->n;
    h.n_times = s.n_times;
    for (q = 0; q < s.n_times; q++) h.t[q] = s.t[q] * lap->h * lap->h;
    for (; h.first < h.n && !status; h.first += s.piece, k++) {
        FILE *f;
        h.count = h.n - h.first < s.piece ? h.n - h.first : s.piece;
        if (k % s.ranks != s.rank) continue;
        f = open_piece(&s, &h, &found);
        if (f) fclose(f);
        else status = run_piece(&s, heat, at, &h, vertex, values);
    }
    if (!status) status = join(&s, &h, at, values);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(at);
    free(values);
    free(vertex);
    return status;
}
