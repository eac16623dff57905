/* robustness.c - bad meshes by the thousand, and what heatdiff.h makes of them

   Build and run from the project's folder:

       gcc -O2 tools/robustness.c -o robustness -lm && ./robustness

   robustness [--count N] [--seed S] [--kind NAME] [--case SEED] [--kept] [--shrink X]

   --count    cases, default 10000
   --seed     of the first case, default 1. Case number i has the seed S + i, which determines everything
   --kind     only cases whose kind contains this
   --case     one case by its seed; every call is printed
   --kept     only the cases of kept_shapes.h, which once found a fault; other runs begin with them
   --shrink   bounds are multiplied by this before comparisons: far below one, they must find fault

   A case is a small bad surface, an operator on it, a time and some vertices. The library may refuse the
   surface or a query with a status and a text that suit. Whatever it answers must be finite, and must agree
   with itself within the bounds that it reports:
     methods    columns by auto, direct, krylov, COCG and Lanczos, two by two
     heat       1'B K_t e_s = 1'B e_s, where heat is conserved
     symmetry   k_t(i,j) = k_t(j,i), and b_i K_t(i,j) = b_j K_t(j,i) where B is diagonal
     semigroup  K_s K_t = K_(s+t), in the norm of B
     eigenpairs sums over the smallest eigenpairs, with their own bounds, against the columns
     diagonal   against columns, trace against diagonal
     entries    against columns
     distance   by diagonals against pairs by columns, symmetry, the triangle inequality, columns from sources
     adjoint    g'K_t f = f'K_t'g
     derivative by two methods, and its heat, which is zero
     geodesic   zero at the source, infinite in other components only
   A contradiction is printed with the seed of its case; the exit status is then 1. It is also 1 when less is
   answered than was, or with fewer finite bounds: kinds and queries have a floor each. Two tables tell how
   calls ended, by the kind of surface and by query. `worst` is the largest difference / sum of the bounds. Nothing
   here depends on the clock; on Unix a case that takes five minutes ends the program with its seed. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"    /* of shapes.h, not all is used here */
#endif

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "shapes.h"
#include "kept_shapes.h"

#if defined(__unix__)
#include <signal.h>
#include <unistd.h>
#endif

/* ==== [1] surfaces ==== */

enum { MOST_VERTICES = 300, MOST_FACES = 600, MOST_CORNERS = 2400, MOST_SIDE = 8 };

/* Faces of any number of corners; triangles: all have three. points: there are no faces. */
typedef struct mesh {
    int32_t n, n_faces, n_corners;
    int polygons, points;
    double xyz[3 * MOST_VERTICES];
    int64_t ptr[MOST_FACES + 1];
    int32_t idx[MOST_CORNERS];
} mesh;

static int draw(uint64_t *seed, int n) { return (int)(shape_uniform(seed) * n); }
static int chance(uint64_t *seed, double p) { return shape_uniform(seed) < p; }
static double power10(uint64_t *seed, double lo, double hi) {
    return pow(10, lo + (hi - lo) * shape_uniform(seed));
}

static int32_t put_vertex(mesh *m, double x, double y, double z) {
    if (m->n == MOST_VERTICES) return m->n - 1;
    m->xyz[3 * m->n] = x;
    m->xyz[3 * m->n + 1] = y;
    m->xyz[3 * m->n + 2] = z;
    return m->n++;
}

static void put_face(mesh *m, int k, const int32_t *corner) {
    if (m->n_faces == MOST_FACES || m->n_corners + k > MOST_CORNERS) return;
    if (k > 0) memcpy(m->idx + m->n_corners, corner, (size_t)k * sizeof *corner);
    m->n_corners += k;
    m->ptr[++m->n_faces] = m->n_corners;
}

static void put_triangle(mesh *m, int32_t a, int32_t b, int32_t c) {
    const int32_t v[3] = {a, b, c};
    put_face(m, 3, v);
}

static double *place(mesh *m, int32_t v) { return m->xyz + 3 * v; }

/* The triangles of a sheet whose vertices begin at `first`. */
static void put_sheet_faces(mesh *m, int32_t first, int nx, int ny) {
    int i, j;
    for (j = 0; j + 1 < ny; j++)
        for (i = 0; i + 1 < nx; i++) {
            const int32_t a = first + j * nx + i, q[4] = {a, a + 1, a + nx + 1, a + nx};
            if (m->polygons) put_face(m, 4, q);
            else {
                put_triangle(m, q[0], q[1], q[2]);
                put_triangle(m, q[0], q[2], q[3]);
            }
        }
}

/* A bumpy sheet of nx by ny vertices, of triangles or of quadrangles, somewhere near the origin. */
static void put_sheet(mesh *m, uint64_t *seed, int nx, int ny) {
    const double at[3] = {shape_signed(seed), shape_signed(seed), shape_signed(seed)},
                 shake = chance(seed, 0.7) ? 0.3 : 0;
    const int32_t first = m->n;
    int i, j;
    for (j = 0; j < ny; j++)
        for (i = 0; i < nx; i++)
            put_vertex(m, at[0] + (i + shake * shape_signed(seed)) / nx,
                       at[1] + (j + shake * shape_signed(seed)) / nx,
                       at[2] + (shake > 0 ? 0.1 * sin(6.0 * i / nx) * cos(4.0 * j / ny) : 0));
    put_sheet_faces(m, first, nx, ny);
}

static void put_shape(mesh *m, shape *s) {
    const int32_t first = m->n;
    int32_t i;
    for (i = 0; i < s->n; i++) put_vertex(m, s->xyz[3 * i], s->xyz[3 * i + 1], s->xyz[3 * i + 2]);
    for (i = 0; i < s->n_tri; i++)
        put_triangle(m, first + s->tri[3 * i], first + s->tri[3 * i + 1], first + s->tri[3 * i + 2]);
    shape_free(s);
}

/* A good surface to begin with. */
static void put_good(mesh *m, uint64_t *seed) {
    shape s;
    if (!m->polygons && chance(seed, 0.25)) {
        s = chance(seed, 0.5) ? shape_bumpy(1, shape_random(seed)) : shape_torus(7, 4, 1, 0.4);
        put_shape(m, &s);
    } else put_sheet(m, seed, 3 + draw(seed, 5), 3 + draw(seed, 4));
}

/* ---- what is wrong with them ---- */

/* Three corners that follow each other in a face; 0: there is no such face. */
static int some_corner(mesh *m, uint64_t *seed, int32_t v[3]) {
    const int32_t f = m->n_faces > 0 ? draw(seed, m->n_faces) : 0;
    int64_t k, p, q;
    if (m->n_faces == 0) return 0;
    p = m->ptr[f];
    k = m->ptr[f + 1] - p;
    if (k < 3) return 0;
    q = draw(seed, (int)k);
    v[0] = m->idx[p + q];
    v[1] = m->idx[p + (q + 1) % k];
    v[2] = m->idx[p + (q + 2) % k];
    return 1;
}

/* Third corners almost on the opposite side, or not far from an end of it. */
static void slivers(mesh *m, uint64_t *seed) {
    int count = 1 + draw(seed, 6), k;
    int32_t v[3];
    while (count-- > 0) {
        const double h = power10(seed, -12, -1), u = chance(seed, 0.3) ? h : shape_uniform(seed);
        if (!some_corner(m, seed, v)) continue;
        for (k = 0; k < 3; k++) {
            const double a = place(m, v[0])[k], b = place(m, v[1])[k];
            place(m, v[2])[k] = a + u * (b - a) + h * (place(m, v[2])[k] - (a + b) / 2);
        }
    }
}

/* Third corners turned over onto the other side, by half a turn and a little. */
static void folds(mesh *m, uint64_t *seed) {
    int count = 1 + draw(seed, 8), k;
    int32_t v[3];
    while (count-- > 0) {
        const double lift = chance(seed, 0.3) ? 0 : power10(seed, -14, -1);
        double d[3], w[3], along = 0, length = 0;
        if (!some_corner(m, seed, v)) continue;
        for (k = 0; k < 3; k++) {
            d[k] = place(m, v[1])[k] - place(m, v[0])[k];
            w[k] = place(m, v[2])[k] - place(m, v[0])[k];
            along += d[k] * w[k];
            length += d[k] * d[k];
        }
        for (k = 0; k < 3 && length > 0; k++)
            place(m, v[2])[k] += -2 * (w[k] - along / length * d[k]) + lift * shape_signed(seed);
    }
}

static void fans(mesh *m, uint64_t *seed) {
    int count = 1 + draw(seed, 3), k;
    int32_t v[3];
    while (count-- > 0 && some_corner(m, seed, v)) {
        const double reach = power10(seed, -6, 1);
        for (k = 3 + draw(seed, 9); k > 0; k--) {
            const double *p = place(m, v[0]);
            const int32_t w = put_vertex(m, p[0] + reach * shape_signed(seed), p[1] + reach * shape_signed(seed),
                                         p[2] + reach * shape_signed(seed));
            if (chance(seed, 0.5)) put_triangle(m, v[0], v[1], w);
            else put_triangle(m, v[1], v[0], w);
            if (chance(seed, 0.2)) put_triangle(m, v[0], w, v[2]);
        }
    }
}

static void crossings(mesh *m, uint64_t *seed) {
    const double part = shape_uniform(seed), reach = power10(seed, -1, 1);
    int32_t i;
    for (i = 0; i < 3 * m->n; i++)
        if (chance(seed, part)) m->xyz[i] += reach * shape_signed(seed);
}

/* All faces again, on vertices at the same places or next to them. */
static void sheets(mesh *m, uint64_t *seed) {
    const int32_t n = m->n, n_faces = m->n_faces;
    const double gap = chance(seed, 0.5) ? 0 : power10(seed, -15, -2), joined = chance(seed, 0.5) ? 0.1 : 0;
    int32_t other[MOST_VERTICES], corner[64], i;
    int64_t p;
    for (i = 0; i < n; i++) {
        const double *x = place(m, i);
        other[i] = chance(seed, joined) ? i : put_vertex(m, x[0], x[1] + gap, x[2] + gap * shape_signed(seed));
    }
    for (i = 0; i < n_faces; i++) {
        const int64_t k = m->ptr[i + 1] - m->ptr[i];
        const int turn = chance(seed, 0.5);
        if (k > 64) continue;
        for (p = 0; p < k; p++) corner[p] = other[m->idx[turn ? m->ptr[i + 1] - 1 - p : m->ptr[i] + p]];
        put_face(m, (int)k, corner);
    }
}

/* Faces that are there already, turned and reversed, and faces with a corner twice. */
static void repeats(mesh *m, uint64_t *seed) {
    int count = 2 + draw(seed, 20);
    int32_t v[3];
    while (count-- > 0) {
        if (!some_corner(m, seed, v)) continue;
        switch (draw(seed, 5)) {
        case 0: put_triangle(m, v[0], v[1], v[1]); break;
        case 1: put_triangle(m, v[0], v[0], v[0]); break;
        case 2: put_triangle(m, v[2], v[1], v[0]); break;
        default: put_triangle(m, v[1], v[2], v[0]);
        }
    }
}

static void isolated(mesh *m, uint64_t *seed) {
    int count = 1 + draw(seed, 20);
    while (count-- > 0) {
        const int32_t v = put_vertex(m, shape_signed(seed), 5 * shape_signed(seed), 1e6 * shape_signed(seed));
        if (chance(seed, 0.2)) {                 /* a face of its own */
            const double *x = place(m, v), r = power10(seed, -3, 3);
            const int32_t a = put_vertex(m, x[0] + r, x[1], x[2]), b = put_vertex(m, x[0], x[1] + r, x[2]);
            put_triangle(m, v, a, b);
        }
    }
}

/* Third corners exactly on the opposite side, or at its end. */
static void flat(mesh *m, uint64_t *seed) {
    int count = 1 + draw(seed, 10), k;
    int32_t v[3];
    while (count-- > 0) {
        const double u = draw(seed, 3) * 0.5;
        if (!some_corner(m, seed, v)) continue;
        for (k = 0; k < 3; k++)
            place(m, v[2])[k] = (1 - u) * place(m, v[0])[k] + u * place(m, v[1])[k];
    }
}

/* Another part with a size of its own, one factor for all, or one along x. */
static void scales(mesh *m, uint64_t *seed) {
    const int way = draw(seed, 4);
    const double most = chance(seed, 0.2) ? 40 : 30, a = power10(seed, -most, most), b = power10(seed, -12, 0);
    const int32_t first = m->n;
    int32_t i;
    if (way < 2) put_good(m, seed);
    for (i = way < 2 ? 3 * first : 0; i < 3 * m->n; i++) m->xyz[i] *= way == 3 ? (i % 3 ? 1 : b) : a;
    if (way == 1 && first > 0) put_triangle(m, 0, 1, first);     /* parts that hang together */
}

static void soup(mesh *m, uint64_t *seed) {
    const int n = 4 + draw(seed, 40);
    int count = 1 + draw(seed, 3 * n), i;
    m->n = m->n_faces = m->n_corners = 0;
    for (i = 0; i < n; i++) put_vertex(m, shape_signed(seed), shape_signed(seed), shape_signed(seed));
    while (count-- > 0) put_triangle(m, draw(seed, n), draw(seed, n), draw(seed, n));
}

/* Points on a sphere, in a plane or along a line, many of them at the same places. */
static void clouds(mesh *m, uint64_t *seed) {
    const int n = 3 + draw(seed, 60), way = draw(seed, 5);
    const double twice = chance(seed, 0.5) ? 0.3 : 0, scale = chance(seed, 0.3) ? power10(seed, -30, 30) : 1;
    int i, k;
    m->n = m->n_faces = m->n_corners = 0;
    m->points = 1;
    for (i = 0; i < n; i++) {
        double p[3];
        if (way < 2) shape_on_sphere(seed, p);
        else shape_on_square(seed, p);
        if (way == 3) p[1] *= power10(seed, -12, 0);
        if (way == 4) for (k = 0; k < 3; k++) p[k] = draw(seed, 4);
        if (i > 0 && chance(seed, twice)) memcpy(p, place(m, draw(seed, i)), sizeof p);
        else for (k = 0; k < 3; k++) p[k] *= scale;
        put_vertex(m, p[0], p[1], p[2]);
    }
}

/* Corners in any order and repeated, faces of none to twelve corners. */
static void bad_polygons(mesh *m, uint64_t *seed) {
    int count = 1 + draw(seed, 6), k, q;
    int32_t corner[12];
    while (count-- > 0) {
        k = draw(seed, 13);
        for (q = 0; q < k; q++) corner[q] = q > 0 && chance(seed, 0.2) ? corner[q - 1] : draw(seed, m->n);
        put_face(m, k, corner);
    }
    if (chance(seed, 0.5)) crossings(m, seed);
}

/* The least share of calls, in percent, that must be answered, and of bounds that must be finite. What 10,000 cases reach,
 * but for one percent. */
typedef struct share { int answers, bounds; } share;

typedef void (*spoiler)(mesh *m, uint64_t *seed);
static const struct kind { const char *name; spoiler spoil; share least; } kinds[] = {
    {"slivers", slivers, {97, 92}},   {"folded", folds, {98, 89}},     {"fans", fans, {97, 91}},
    {"crossing", crossings, {98, 91}}, {"two sheets", sheets, {98, 91}}, {"repeated", repeats, {98, 89}},
    {"isolated", isolated, {98, 91}}, {"no area", flat, {92, 84}},     {"scales", scales, {97, 90}},
    {"soup", soup, {73, 68}},         {"points", clouds, {97, 94}},    {"polygons", bad_polygons, {97, 85}},
    {"mixed", NULL, {94, 86}}};
enum { KINDS = sizeof kinds / sizeof *kinds, KIND_POLYGONS = 11, KIND_POINTS = 10 };

static void make_mesh(mesh *m, int kind, uint64_t *seed) {
    int count = 2 + draw(seed, 2);
    memset(m, 0, sizeof *m);
    m->polygons = kind == KIND_POLYGONS;
    put_good(m, seed);
    if (kinds[kind].spoil) kinds[kind].spoil(m, seed);
    else while (count-- > 0) kinds[draw(seed, KIND_POINTS - 1)].spoil(m, seed);
    if (m->polygons && chance(seed, 0.4)) kinds[draw(seed, KIND_POINTS - 1)].spoil(m, seed);
}

/* ---- shapes that are kept ---- */

/* The next number of a text; 0 and no step: there is none. */
static int number(const char **text, double *x) {
    char *end;
    *x = strtod(*text, &end);
    if (end == *text) return 0;
    *text = end;
    return 1;
}

static void put_vertices(mesh *m, const char **text) {
    double x[3];
    while (number(text, x) && number(text, x + 1) && number(text, x + 2)) put_vertex(m, x[0], x[1], x[2]);
}

/* x of the columns, y of the rows, one z. */
static void put_grid(mesh *m, const char **text, int nx, int ny) {
    double x[MOST_SIDE], y[MOST_SIDE], z = 0;
    int i, j;
    for (i = 0; i < nx; i++) (void)number(text, x + i);
    for (j = 0; j < ny; j++) (void)number(text, y + j);
    (void)number(text, &z);
    for (j = 0; j < ny; j++)
        for (i = 0; i < nx; i++) put_vertex(m, x[i], y[j], z);
}

static void put_ball_faces(mesh *m) {
    shape s = shape_icosphere(1);
    int32_t i;
    for (i = 0; i < s.n_tri; i++)
        put_triangle(m, m->n + s.tri[3 * i], m->n + s.tri[3 * i + 1], m->n + s.tri[3 * i + 2]);
    shape_free(&s);
}

/* By words and numbers, see kept_shapes.h. */
static void make_kept(mesh *m, const char *text) {
    double a[4];
    while (*text) {
        const char word = *text;
        text += strcspn(text, " ");
        if (word == 'b') put_ball_faces(m);
        if (word == 's' || word == 'g') {
            (void)(number(&text, a) && number(&text, a + 1));
            put_sheet_faces(m, m->n, (int)a[0], (int)a[1]);
        }
        if (word == 'g') put_grid(m, &text, (int)a[0], (int)a[1]);
        if (word == 's' || word == 'b' || word == 'v') put_vertices(m, &text);
        while (word == 'f' && number(&text, a) && number(&text, a + 1) && number(&text, a + 2))
            put_triangle(m, (int32_t)a[0], (int32_t)a[1], (int32_t)a[2]);
        if (word == 'a' && number(&text, a) && number(&text, a + 1) && number(&text, a + 2) && number(&text, a + 3))
            memcpy(place(m, (int32_t)a[0]), a + 1, 3 * sizeof *a);
        text += strspn(text, " ");
    }
}

static uint64_t hash_of(const mesh *m) {
    const unsigned char *p = (const unsigned char *)m->xyz;
    size_t n = 3 * (size_t)m->n * sizeof *m->xyz;
    uint64_t h = 0xcbf29ce484222325u;
    while (n-- > 0) h = (h ^ *p++) * 0x100000001b3u;
    p = (const unsigned char *)m->idx;
    n = (size_t)m->n_corners * sizeof *m->idx;
    while (n-- > 0) h = (h ^ *p++) * 0x100000001b3u;
    return h;
}

/* ==== [2] outcomes ==== */

enum { QUERY_LAPLACIAN, QUERY_AUTO, QUERY_DIRECT, QUERY_KRYLOV, QUERY_COCG, QUERY_LANCZOS, QUERY_SEMIGROUP,
       QUERY_SPECTRUM, QUERY_DIAGONAL, QUERY_ENTRIES, QUERY_DISTANCE, QUERY_PAIRS, QUERY_ADJOINT,
       QUERY_DERIVATIVE, QUERY_GEODESIC, QUERIES };
/* calls, bounds: how many of them a case asks for and gets if all goes well. */
static const struct query { const char *name; int calls, bounds; share least; } queries[QUERIES] = {
    {"Laplacian", 1, 0, {96, 0}},       {"column: auto", 2, 2, {96, 88}},   {"column: direct", 2, 2, {96, 88}},
    {"column: krylov", 2, 2, {95, 87}}, {"column: COCG", 2, 2, {94, 94}},   {"column: Lanczos", 2, 2, {94, 94}},
    {"field", 3, 3, {96, 90}},          {"eigenpairs", 2, 1, {94, 94}},     {"diagonal, trace", 3, 3, {96, 88}},
    {"entries", 1, 1, {95, 87}},        {"distance", 4, 4, {95, 87}},
    {"pairs", 4, 4, {95, 85}},          {"adjoint", 2, 2, {96, 88}},        {"derivative", 2, 2, {95, 76}},
    {"geodesic", 2, 0, {89, 0}}};
/* The same for kept cases, and for each query on each kind of surface. */
static const share least_kept = {93, 81}, least_each = {70, 50};

/* Statuses that occur; what remains is `other`. */
static const hd_status columns_of_table[] = {HD_ERR_EMPTY, HD_ERR_NOT_FINITE, HD_ERR_NOT_POSITIVE,
                                             HD_ERR_NOT_CONVERGED, HD_ERR_BREAKDOWN};
enum { STATUSES = sizeof columns_of_table / sizeof *columns_of_table };

/* bounds: answers with a finite one. */
typedef struct tally { int64_t calls, ok, warned, by_status[STATUSES + 1], bounds, checks, wrong; double worst; } tally;

static tally tallies[KINDS + 1][QUERIES];          /* the last row: cases that are kept */
static int64_t cases[KINDS + 1];
static double shrink = 1;
static int verbose;

/* A case under way. */
typedef struct work {
    uint64_t seed, chance;
    int kind, query;             /* query: whose checks they are */
    char op[80];
    hd_context ctx;
    mesh m;
    hd_laplacian *lap;
    int32_t n;
    double unit, t;
    int32_t source[3];           /* with mass where there is one */
    const kept *kept;            /* NULL: the case is drawn */
    const char *said;            /* the contradiction printed last: many values may show it */
} work;

static void contradiction(work *w, const char *what, double value, double allowed) {
    tallies[w->kind][w->query].wrong++;
    if (w->said == what) return;
    w->said = what;
    printf("case %llu (%s, %s, t %.3g, %s): %s: %.6g, allowed %.6g\n", (unsigned long long)w->seed,
           w->kept ? w->kept->what : kinds[w->kind].name, w->op, w->t, queries[w->query].name, what, value, allowed);
    fflush(stdout);
}

/* Values or differences against the sum of their bounds. Bounds that are infinite promise nothing:
 * the floors below say how many there may be. */
static void within(work *w, const char *what, double value, double allowed) {
    const double limit = allowed * shrink + DBL_MIN;   /* what underflows is nothing to compare */
    tally *t = &tallies[w->kind][w->query];
    if (allowed > DBL_MAX) return;
    t->checks++;
    if (verbose && w->query) printf("    %s: %.3g of %.3g\n", what, value, limit);
    if (!(value <= limit)) contradiction(w, what, value, limit);
    if (value / limit > t->worst) t->worst = value / limit;
}

static void count_status(tally *t, hd_status st) {
    int q = 0;
    t->calls++;
    if (st == HD_OK) t->ok++;
    else if (st > 0) t->warned++;
    else {
        while (q < STATUSES && columns_of_table[q] != st) q++;
        t->by_status[q]++;
    }
}

/* How a call ended. 1: there is an answer. */
static int ended(work *w, int query, hd_status st, const hd_error *e) {
    if (w->query != query) w->said = NULL;
    w->query = query;
    count_status(&tallies[w->kind][query], st);
    if (verbose) printf("  %s: %s %s\n", queries[query].name, hd_status_name(st), st < 0 ? e->text : "");
    if (st < 0 && (e->status != st || strlen(e->text) < 10))
        contradiction(w, "an error without a text", (double)st, 0);
    if (query == QUERY_GEODESIC && strstr(e->text, "source lies on the border")) return 0;
    if (st < 0 && (st == HD_ERR_ARGUMENT || st == HD_ERR_INDEX || st == HD_ERR_MEMORY || st == HD_ERR_STRUCTURE ||
                   st == HD_ERR_TOO_LARGE || st == HD_ERR_NOT_SYMMETRIC || st == HD_ERR_NOT_BUILT)) {
        contradiction(w, e->text, (double)st, 0);
    }
    return st >= 0;
}

/* The same with a report: bounds must be numbers, and poor ones must come with a warning. */
static int answered(work *w, int query, hd_status st, const hd_report *r) {
    if (!ended(w, query, st, &r->error)) return 0;
    if (verbose)
        printf("    method %d, bound %.3g = %.3g + %.3g + %.3g, in B %.3g, relative %.3g; %s\n", (int)r->method,
               r->error_bound, r->error_rational, r->error_solver, r->error_rounding, r->error_bound_b,
               r->error_relative, r->reason ? r->reason : "");
    if (isnan(r->error_bound) || isnan(r->error_bound_b) || isnan(r->error_relative) || isnan(r->mass_drift))
        contradiction(w, "a bound that is not a number", r->error_bound, 0);
    if (st == HD_OK && !(r->error_bound <= 0.01)) contradiction(w, "no warning", r->error_bound, 0.01);
    if (r->status != st) contradiction(w, "another status in the report", (double)r->status, (double)st);
    tallies[w->kind][query].bounds += r->error_bound <= DBL_MAX;
    return 1;
}

static double largest(const double *u, int64_t n) {
    double most = 0;
    int64_t i;
    for (i = 0; i < n; i++)
        if (!(fabs(u[i]) <= most)) most = fabs(u[i]);    /* NaN, if one is last; all_finite finds others */
    return most;
}

static int all_finite(work *w, const double *u, int64_t n) {
    int64_t i;
    for (i = 0; i < n; i++)
        if (!(fabs(u[i]) <= DBL_MAX)) {
            contradiction(w, "a value that is not finite", u[i], 0);
            return 0;
        }
    return 1;
}

static int finite_bounds(const double *u, int64_t n) {
    while (n > 0 && u[n - 1] <= DBL_MAX) n--;
    return n == 0;
}

static double difference(const double *u, const double *v, int64_t n) {
    double most = 0;
    int64_t i;
    for (i = 0; i < n; i++)
        if (!(fabs(u[i] - v[i]) <= most)) most = fabs(u[i] - v[i]);
    return most;
}

/* An infinite bound of zero is infinite. */
static double times(double bound, double size) { return bound > DBL_MAX ? bound : bound * size; }

static double *room(int64_t count) {
    double *p = (double *)calloc(count > 0 ? (size_t)count : 1, sizeof *p);
    if (!p) {
        fprintf(stderr, "robustness: out of memory\n");
        exit(2);
    }
    return p;
}

/* ==== [3] operators ==== */

static hd_status surface_pair(work *w, hd_laplacian_opts *o, hd_error *e) {
    static const hd_laplacian_kind three[] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    static const char *const names[] = {"fem", "voronoi-cot", "cot"};
    const int k = draw(&w->chance, 3), cover = draw(&w->chance, 3);
    const int polygon = w->m.polygons && chance(&w->chance, 0.6);
    int32_t held[3];
    int i;
    o->kind = polygon ? HD_LAPLACIAN_POLYGON : three[k];
    o->triangulation = polygon ? HD_TRIANGULATION_GIVEN : (hd_triangulation)cover;
    o->border = chance(&w->chance, 0.25) ? HD_BORDER_DIRICHLET : HD_BORDER_NATURAL;
    if (chance(&w->chance, 0.15)) {
        o->n_held = 3;
        o->held = held;
        for (i = 0; i < 3; i++) held[i] = draw(&w->chance, w->m.n);
    }
    snprintf(w->op, sizeof w->op, "%s%s%s%s", polygon ? "polygon" : names[k],
             polygon || !cover ? "" : cover == 1 ? " delaunay" : " tufted", o->border ? " dirichlet" : "",
             o->n_held ? " held" : "");
    if (w->m.polygons)
        return hd_laplacian_create(&w->lap, MESH_POLYGONS(w->m.xyz, w->m.n, w->m.ptr, w->m.idx, w->m.n_faces), o, e);
    return hd_laplacian_create(&w->lap, MESH_TRIANGLES(w->m.xyz, w->m.n, w->m.idx, w->m.n_faces), o, e);
}

/* As its name says. */
static hd_status kept_pair(work *w, hd_laplacian_opts *o, hd_error *e) {
    snprintf(w->op, sizeof w->op, "%s", w->kept->op);
    o->kind = strstr(w->op, "voronoi-cot") ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM;
    o->triangulation = strstr(w->op, "delaunay") != NULL ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
    o->border = strstr(w->op, "dirichlet") ? HD_BORDER_DIRICHLET : HD_BORDER_NATURAL;
    return hd_laplacian_create(&w->lap, MESH_TRIANGLES(w->m.xyz, w->m.n, w->m.idx, w->m.n_faces), o, e);
}

static hd_status point_pair(work *w, hd_laplacian_opts *o, hd_error *e) {
    const int k = draw(&w->chance, 3);
    o->kind = k == 0 ? HD_LAPLACIAN_VORONOI_EXP : k == 1 ? HD_LAPLACIAN_EXP : HD_LAPLACIAN_DEFAULT;
    snprintf(w->op, sizeof w->op, "%s", k == 0 ? "voronoi-exp" : k == 1 ? "exp" : "tufted");
    if (k == 2) o->triangulation = HD_TRIANGULATION_TUFTED;
    return hd_laplacian_create(&w->lap, MESH_POINTS(w->m.xyz, w->m.n), o, e);
}

/* Columns ascend, and both of each pair are there and the same. */
static void check_symmetric(work *w, const hd_csr *a) {
    int32_t i;
    int64_t p, q;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const int32_t j = a->col[p];
            if (j < 0 || j >= a->n_cols || (p > a->row_ptr[i] && j <= a->col[p - 1])) {
                contradiction(w, "columns of L do not ascend", j, 0);
                return;
            }
            for (q = a->row_ptr[j]; q < a->row_ptr[j + 1] && a->col[q] != i; q++) {}
            if (q == a->row_ptr[j + 1] || a->val[q] != a->val[p]) contradiction(w, "L is not symmetric", a->val[p], 0);
        }
}

/* Masses positive, L symmetric, zero on constants where it says so. Sets the unit of time: one over the mean
 * of diag(L)/diag(B), or h^2. */
static void check_pair(work *w) {
    const hd_laplacian *lap = w->lap;
    const int32_t n = lap->n_active;
    double rate = 0;
    int32_t i;
    int64_t p;
    all_finite(w, lap->L.val, lap->L.nnz);
    all_finite(w, lap->mass, n);
    if (lap->B) all_finite(w, lap->B, lap->L.nnz);
    check_symmetric(w, &lap->L);
    for (i = 0; i < n; i++) {
        double sum = 0, size = 0, diagonal = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            sum += lap->L.val[p];
            size += fabs(lap->L.val[p]);
            if (lap->L.col[p] == i) diagonal = lap->L.val[p];
        }
        if (lap->conserves == 1) within(w, "row sum of L", fabs(sum), 64 * DBL_EPSILON * size);
        if (!(diagonal >= 0)) contradiction(w, "negative diagonal", diagonal, 0);
        if (!(lap->mass[i] > 0 || lap->B)) contradiction(w, "mass not positive", lap->mass[i], 0);
        if (!(lap->b_diag[i] > 0)) contradiction(w, "diagonal of B not positive", lap->b_diag[i], 0);
        rate += diagonal / lap->b_diag[i] / n;
    }
    w->unit = rate > 0 && rate <= DBL_MAX ? 1 / rate : 1;
    if (chance(&w->chance, 0.5) && lap->h > 0 && lap->kind != HD_LAPLACIAN_COT && lap->kind != HD_LAPLACIAN_EXP)
        w->unit = lap->h * lap->h;
    if (!(w->unit > 0) || w->unit > 1e200) w->unit = 1;
}

static int make_pair(work *w) {
    hd_laplacian_opts o;
    hd_error e;
    hd_status st;
    int k;
    memset(&o, 0, sizeof o);
    memset(&e, 0, sizeof e);
    o.context = &w->ctx;
    st = w->kept ? kept_pair(w, &o, &e) : w->m.points ? point_pair(w, &o, &e) : surface_pair(w, &o, &e);
    if (!ended(w, QUERY_LAPLACIAN, st, &e)) return 0;
    w->n = w->lap->n;
    check_pair(w);
    if (w->kept) {
        w->t = w->kept->t;
        memcpy(w->source, w->kept->source, sizeof w->source);
        w->chance = w->kept->chance;
        return 1;
    }
    w->t = w->unit * power10(&w->chance, -2, 6);
    if (!(w->t > 0)) w->t = DBL_MIN;
    for (k = 0; k < 3; k++) {
        w->source[k] = w->lap->vertex[draw(&w->chance, w->lap->n_active)];
        if (chance(&w->chance, 0.03)) w->source[k] = draw(&w->chance, w->n);
    }
    return 1;
}

/* y = B x on the rows, from vertices. */
static void mass_times(const hd_laplacian *lap, const double *x, double *y) {
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        y[i] = lap->B ? 0 : lap->mass[i] * x[lap->vertex[i]];
        for (p = lap->L.row_ptr[i]; lap->B && p < lap->L.row_ptr[i + 1]; p++)
            y[i] += lap->B[p] * x[lap->vertex[lap->L.col[p]]];
    }
}

/* |x|_B, and what rounding of this sum can hide. */
static double norm_b(const hd_laplacian *lap, const double *x) {
    double *y = room(lap->n_active), sum = 0;
    int32_t i;
    mass_times(lap, x, y);
    for (i = 0; i < lap->n_active; i++) sum += x[lap->vertex[i]] * y[i];
    free(y);
    return sum > 0 ? sqrt(sum) : 0;
}

/* ==== [4] queries and what they must agree on ==== */

static hd_heat *plan(work *w, hd_method method, hd_solver solver) {
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.method = method;
    o.solver = solver;
    o.max_iterations = 2000;
    o.context = &w->ctx;
    if (hd_heat_create(&heat, w->lap, &o, &e) < 0) contradiction(w, e.text, (double)e.status, 0);
    return heat;
}

/* Three columns of k_t and one of K_t, with their bounds. */
typedef struct answer {
    double *k, *K;               /* [3 n] and [n]; NULL: none */
    double bound_k, bound_K, bound_b;
    int heat;                    /* there is a K */
} answer;

/* Heat of a column of K_t: off by at most |1|_B |error|_B, and the rounding of our own sum. */
static void check_heat(work *w, const answer *a) {
    const hd_laplacian *lap = w->lap;
    const int32_t r = lap->row[w->source[0]];
    double sum = 0, size = 0, area = 0, allowed;
    int32_t i;
    if (lap->conserves != 1 || r < 0) return;
    for (i = 0; i < lap->n_active; i++) {
        if (lap->component[i] != lap->component[r]) continue;
        sum += lap->mass[i] * a->K[lap->vertex[i]];
        size += fabs(lap->mass[i] * a->K[lap->vertex[i]]);
        area += lap->mass[i];
    }
    allowed = times(a->bound_b, norm_b(lap, a->K) * sqrt(area) * (1 + 1e-6)) + (2 * w->n + 8) * DBL_EPSILON * size;
    within(w, "heat", fabs(sum - lap->mass[r]), allowed);
}

static void check_symmetry(work *w, const answer *a) {
    int32_t i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < i; j++) {
            const double *u = a->k + (int64_t)i * w->n, *v = a->k + (int64_t)j * w->n;
            within(w, "symmetry", fabs(u[w->source[j]] - v[w->source[i]]),
                   times(a->bound_k, largest(u, w->n) + largest(v, w->n)));
        }
}

static answer columns(work *w, int query, hd_method method, hd_solver solver) {
    hd_heat *heat = plan(w, method, solver);
    answer a;
    hd_report r;
    hd_status st;
    memset(&a, 0, sizeof a);
    if (!heat) return a;
    a.k = room(4 * (int64_t)w->n);
    a.K = a.k + 3 * (int64_t)w->n;
    st = hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &w->t, VERTICES(3, w->source), a.k, 0, &r, NULL);
    a.bound_k = r.error_bound;
    if (!answered(w, query, st, &r) || !all_finite(w, a.k, 3 * (int64_t)w->n)) {
        free(a.k);
        a.k = NULL;
    } else {
        check_symmetry(w, &a);
        st = hd_heat_column(heat, HD_KERNEL_OPERATOR, w->t, w->source[0], a.K, &r, NULL);
        a.bound_K = r.error_bound;
        a.bound_b = r.error_bound_b;
        a.heat = answered(w, query, st, &r) && all_finite(w, a.K, w->n);
        if (a.heat) check_heat(w, &a);
    }
    hd_heat_free(heat);
    return a;
}

static void check_methods(work *w, const answer *a, const answer *b) {
    int q;
    if (!a->k || !b->k) return;
    for (q = 0; q < 3; q++) {
        const double *u = a->k + (int64_t)q * w->n, *v = b->k + (int64_t)q * w->n;
        within(w, "two methods, k_t", difference(u, v, w->n),
               times(a->bound_k, largest(u, w->n)) + times(b->bound_k, largest(v, w->n)));
    }
    if (!a->heat || !b->heat) return;
    within(w, "two methods, K_t", difference(a->K, b->K, w->n),
           times(a->bound_K, largest(a->K, w->n)) + times(b->bound_K, largest(b->K, w->n)));
}

/* K_s (K_t e) against K_(s+t) e. K_s does not lengthen anything in the norm of B. */
static void check_semigroup(work *w, hd_heat *heat) {
    const double s = w->t * power10(&w->chance, -1, 1), both = s + w->t;
    double *u = room(4 * (int64_t)w->n), *v = u + w->n, *x = v + w->n, *d = x + w->n, allowed;
    hd_report r[3];
    int32_t i;
    if (answered(w, QUERY_SEMIGROUP,
                 hd_heat_column(heat, HD_KERNEL_OPERATOR, w->t, w->source[0], u, r, NULL), r) &&
        all_finite(w, u, w->n) &&
        answered(w, QUERY_SEMIGROUP, hd_heat_apply(heat, 1, &s, 1, u, 0, v, 0, r + 1, NULL), r + 1) &&
        answered(w, QUERY_SEMIGROUP,
                 hd_heat_column(heat, HD_KERNEL_OPERATOR, both, w->source[0], x, r + 2, NULL), r + 2) &&
        all_finite(w, v, w->n) && all_finite(w, x, w->n)) {
        for (i = 0; i < w->n; i++) d[i] = v[i] - x[i];
        allowed = times(r[0].error_bound_b, norm_b(w->lap, u)) + times(r[1].error_bound_b, norm_b(w->lap, v)) +
                  times(r[2].error_bound_b, norm_b(w->lap, x));
        within(w, "semigroup", norm_b(w->lap, d), allowed * (1 + 1e-6));
    }
    free(u);
}

/* A few eigenpairs: ascending, not negative, and their sums within their own bounds of the columns. */
static void check_spectrum(work *w, const answer *a) {
    hd_spectrum_opts o;
    hd_spectrum *s = NULL;
    hd_error e;
    double *u = room(6 * (int64_t)w->n), *bound = u + 3 * (int64_t)w->n;
    /* L itself is rounded, and may have negative eigenvalues as small as this */
    const double rounding = w->n * DBL_EPSILON * w->lap->lambda_max;
    int32_t i, q;
    memset(&o, 0, sizeof o);
    memset(&e, 0, sizeof e);
    o.context = &w->ctx;
    o.count = w->lap->n_active < 6 || chance(&w->chance, 0.2) ? w->lap->n_active : 6;
    if (ended(w, QUERY_SPECTRUM, hd_spectrum_create(&s, w->lap, &o, &e), &e)) {
        all_finite(w, s->value, s->count);
        all_finite(w, s->vector, (int64_t)s->count * w->n);
        for (i = 0; i < s->count; i++)
            if ((s->value[i] < -rounding && s->n_poor == 0) || (i > 0 && s->value[i] < s->value[i - 1]))
                contradiction(w, "eigenvalue", s->value[i], i > 0 ? s->value[i - 1] : 0);
        if (ended(w, QUERY_SPECTRUM, hd_spectrum_columns(s, HD_KERNEL_SYMMETRIC, 1, &w->t, VERTICES(3, w->source), u, bound, 0, &e),
                  &e)) {
            tallies[w->kind][QUERY_SPECTRUM].bounds += finite_bounds(bound, 3 * (int64_t)w->n);
            for (q = 0; q < 3 && a->k && s->proven; q++)
                for (i = 0; i < w->n; i++)
                    within(w, "eigenpairs and columns",
                           fabs(u[(int64_t)q * w->n + i] - a->k[(int64_t)q * w->n + i]),
                           bound[(int64_t)q * w->n + i] +
                               times(a->bound_k, largest(a->k + (int64_t)q * w->n, w->n)));
        }
    }
    hd_spectrum_free(s);
    free(u);
}

static void check_diagonal(work *w, hd_heat *heat, const answer *a) {
    double *d = room(2 * (int64_t)w->n), *K = d + w->n, Z = 0, bound = 0, sum = 0, off = 0;
    hd_report r, rk, rz;
    int32_t i;
    if (answered(w, QUERY_DIAGONAL, hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &w->t, d, 0, NULL, NULL, &r, NULL), &r) &&
        all_finite(w, d, w->n) && a->k)
        for (i = 0; i < 3; i++) {
            const double *u = a->k + (int64_t)i * w->n;
            within(w, "diagonal and columns", fabs(d[w->source[i]] - u[w->source[i]]),
                   times(r.error_bound, largest(d, w->n)) + times(a->bound_k, largest(u, w->n)));
            within(w, "diagonal, relative", fabs(d[w->source[i]] - u[w->source[i]]),
                   times(r.error_relative, d[w->source[i]]) + times(a->bound_k, largest(u, w->n)));
        }
    if (answered(w, QUERY_DIAGONAL, hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &w->t, K, 0, NULL, NULL, &rk, NULL), &rk) &&
        answered(w, QUERY_DIAGONAL, hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, 1, &w->t, NULL, 0, &Z, &bound, &rz, NULL), &rz) &&
        all_finite(w, K, w->n) && all_finite(w, &Z, 1)) {
        for (i = 0; i < w->n; i++)
            if (w->lap->row[i] >= 0) {
                sum += K[i];
                off += times(rk.error_bound, largest(K, w->n)) + 2 * w->n * DBL_EPSILON * fabs(K[i]);
            }
        within(w, "trace and diagonal", fabs(Z - sum), off + bound);
        if (bound <= 0.5 && (Z < -bound || Z > w->lap->n_active * (1 + 1e-12) + bound))
            contradiction(w, "trace", Z, w->lap->n_active);
    }
    free(d);
}

static void check_entries(work *w, hd_heat *heat, const answer *a) {
    const int32_t i[4] = {draw(&w->chance, w->n), draw(&w->chance, w->n), w->source[0], w->source[1]},
                  j[4] = {w->source[0], w->source[1], w->source[2], w->source[1]};
    static const int column[4] = {0, 1, 2, 1};
    double v[4];
    hd_report r;
    int q;
    if (!answered(w, QUERY_ENTRIES, hd_heat_entries(heat, HD_KERNEL_SYMMETRIC, 1, &w->t, 4, i, j, v, &r, NULL), &r) ||
        !all_finite(w, v, 4) || !a->k)
        return;
    for (q = 0; q < 4; q++) {
        const double *u = a->k + column[q] * (int64_t)w->n;
        within(w, "entries and columns", fabs(v[q] - u[i[q]]),
               times(r.error_bound, largest(v, 4)) + times(a->bound_k, largest(u, w->n)));
    }
}

/* Distances of the three sources by diagonals and by pairs. */
static void check_distance(work *w, hd_heat *heat, hd_distance_kind kind) {
    static const int32_t of[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    const int timeless = kind == HD_DISTANCE_COMMUTE || kind == HD_DISTANCE_BIHARMONIC;
    double *D = room(3 * (int64_t)w->n), d[3], bound, most = 0;
    int32_t i[3], j[3], q, v;
    hd_report r, rp;
    for (q = 0; q < 3; q++) {
        i[q] = w->source[of[q][0]];
        j[q] = w->source[of[q][1]];
    }
    if (!answered(w, QUERY_DISTANCE, hd_heat_distance(heat, kind, 1, &w->t, VERTICES(3, w->source), D, 0, &r, NULL), &r)) {
        free(D);
        return;
    }
    for (v = 0; v < 3 * w->n; v++) {
        if (!(D[v] >= 0) || (!timeless && D[v] > DBL_MAX)) contradiction(w, "distance", D[v], 0);
        if (D[v] <= DBL_MAX && D[v] > most) most = D[v];
    }
    bound = times(r.error_bound, most);
    for (q = 0; q < 3; q++) {
        const double a = D[(int64_t)of[q][0] * w->n + j[q]], b = D[(int64_t)of[q][1] * w->n + i[q]];
        if (a > DBL_MAX || b > DBL_MAX) {
            if (a != b) contradiction(w, "infinite one way", a, b);
            continue;
        }
        within(w, "symmetry of distances", fabs(a - b), 2 * bound);
        for (v = 0; v < w->n; v++) {
            const double from = D[(int64_t)of[q][0] * w->n + v], to = D[(int64_t)of[q][1] * w->n + v];
            if (from > DBL_MAX && to > DBL_MAX) continue;
            within(w, "triangle inequality", from - to - a, 3 * bound);
        }
    }
    if (answered(w, QUERY_PAIRS, hd_heat_distance_pairs(heat, kind, 1, &w->t, 3, i, j, d, &rp, NULL), &rp)) {
        for (q = 0, most = 0; q < 3; q++)
            if (d[q] <= DBL_MAX && d[q] > most) most = d[q];
        for (q = 0; q < 3; q++) {
            const double a = D[(int64_t)of[q][0] * w->n + j[q]];
            if (!(d[q] >= 0)) contradiction(w, "distance of a pair", d[q], 0);
            if (a > DBL_MAX || d[q] > DBL_MAX) {
                if (a != d[q]) contradiction(w, "infinite as a pair", d[q], a);
            } else within(w, "distances and pairs", fabs(d[q] - a), bound + times(rp.error_bound, most));
        }
    }
    free(D);
}

static double dot_abs(const double *a, const double *b, int32_t n, double *size) {
    double sum = 0;
    int32_t i;
    *size = 0;
    for (i = 0; i < n; i++) {
        sum += a[i] * b[i];
        *size += fabs(a[i] * b[i]);
    }
    return sum;
}

static double sum_abs(const double *a, int32_t n) {
    double sum = 0;
    while (n-- > 0) sum += fabs(a[n]);
    return sum;
}

static void check_adjoint(work *w, hd_heat *heat) {
    const int32_t n = w->n;
    double *f = room(4 * (int64_t)n), *g = f + n, *u = g + n, *v = u + n, size[2], x, y;
    hd_report r, ra;
    int32_t i;
    for (i = 0; i < n; i++) {
        f[i] = shape_signed(&w->chance);
        g[i] = shape_signed(&w->chance);
    }
    if (answered(w, QUERY_ADJOINT, hd_heat_apply(heat, 1, &w->t, 1, f, 0, u, 0, &r, NULL), &r) && all_finite(w, u, n) &&
        answered(w, QUERY_ADJOINT, hd_heat_adjoint(heat, 1, &w->t, 1, g, 0, v, 0, &ra, NULL), &ra) &&
        all_finite(w, v, n)) {
        x = dot_abs(g, u, n, size);
        y = dot_abs(f, v, n, size + 1);
        within(w, "adjoint", fabs(x - y),
               times(r.error_bound, largest(u, n) * sum_abs(g, n)) +
                   times(ra.error_bound, largest(v, n) * sum_abs(f, n)) +
                   n * DBL_EPSILON * (size[0] + size[1]));
    }
    free(f);
}

static void check_derivative(work *w, hd_heat *one, hd_heat *other) {
    const int32_t n = w->n;
    double *f = room(3 * (int64_t)n), *u = f + n, *v = u + n, sum = 0, size = 0, area = 0;
    hd_report r, rv;
    int32_t i;
    for (i = 0; i < n; i++) f[i] = shape_signed(&w->chance);
    if (answered(w, QUERY_DERIVATIVE, hd_heat_derivative(one, 1, &w->t, 1, f, 0, u, 0, &r, NULL), &r) &&
        all_finite(w, u, n)) {
        for (i = 0; i < w->lap->n_active; i++) {
            sum += w->lap->mass[i] * u[w->lap->vertex[i]];
            size += fabs(w->lap->mass[i] * u[w->lap->vertex[i]]);
            area += w->lap->mass[i];
        }
        if (w->lap->conserves == 1)
            within(w, "heat of the derivative", fabs(sum),
                   times(r.error_bound_b, norm_b(w->lap, u) * sqrt(area) * (1 + 1e-6)) +
                       (2 * n + 8) * DBL_EPSILON * size);
        if (answered(w, QUERY_DERIVATIVE, hd_heat_derivative(other, 1, &w->t, 1, f, 0, v, 0, &rv, NULL), &rv) &&
            all_finite(w, v, n))
            within(w, "two methods, derivative", difference(u, v, n),
                   times(r.error_bound, largest(u, n)) + times(rv.error_bound, largest(v, n)));
    }
    free(f);
}

static hd_status geodesic_plan(work *w, hd_geodesic **g, hd_error *e) {
    hd_geodesic_opts o;
    const int cover = draw(&w->chance, 3);
    memset(&o, 0, sizeof o);
    o.context = &w->ctx;
    o.border = (hd_geodesic_border)draw(&w->chance, 3);
    if (w->m.points) {
        o.border = HD_GEODESIC_BORDER_NATURAL;
        o.triangulation = HD_TRIANGULATION_TUFTED;
        return hd_geodesic_create(g, MESH_POINTS(w->m.xyz, w->m.n), &o, e);
    }
    o.triangulation = (hd_triangulation)cover;
    if (w->m.polygons)
        return hd_geodesic_create(g, MESH_POLYGONS(w->m.xyz, w->m.n, w->m.ptr, w->m.idx, w->m.n_faces), &o, e);
    return hd_geodesic_create(g, MESH_TRIANGLES(w->m.xyz, w->m.n, w->m.idx, w->m.n_faces), &o, e);
}

static void check_geodesic(work *w) {
    hd_geodesic *g = NULL;
    hd_geodesic_report r;
    hd_error e;
    double *d = room(w->m.n);
    const int32_t s = draw(&w->chance, w->m.n);
    int32_t i;
    memset(&e, 0, sizeof e);
    if (ended(w, QUERY_GEODESIC, geodesic_plan(w, &g, &e), &e) &&
        ended(w, QUERY_GEODESIC, hd_geodesic_distance(g, VERTICES(1, &s), d, 0, &r, &e), &e)) {
        if (d[s] != 0) contradiction(w, "not zero at the source", d[s], 0);
        for (i = 0; i < w->m.n; i++)
            if (!(d[i] >= 0)) contradiction(w, "geodesic distance", d[i], 0);
    }
    hd_geodesic_free(g);
    free(d);
}

/* ==== [5] cases ==== */

static void run_queries(work *w) {
    hd_heat *direct = plan(w, HD_METHOD_DIRECT, HD_SOLVER_AUTO), *krylov = plan(w, HD_METHOD_KRYLOV, HD_SOLVER_AUTO);
    answer a[5];
    int i, j;
    a[0] = columns(w, QUERY_AUTO, HD_METHOD_AUTO, HD_SOLVER_AUTO);
    a[1] = columns(w, QUERY_DIRECT, HD_METHOD_DIRECT, HD_SOLVER_AUTO);
    a[2] = columns(w, QUERY_KRYLOV, HD_METHOD_KRYLOV, HD_SOLVER_AUTO);
    a[3] = columns(w, QUERY_COCG, HD_METHOD_ITERATIVE, HD_SOLVER_COCG);
    a[4] = columns(w, QUERY_LANCZOS, HD_METHOD_ITERATIVE, HD_SOLVER_LANCZOS);
    for (i = 0; i < 5; i++)
        for (j = 0; j < i; j++) {
            w->query = QUERY_AUTO + i;
            check_methods(w, a + i, a + j);
        }
    if (direct && krylov) {
        check_semigroup(w, chance(&w->chance, 0.5) ? direct : krylov);
        check_spectrum(w, a + 1);
        check_diagonal(w, direct, a + 2);
        check_entries(w, krylov, a + 1);
        for (i = 0; i < 4; i++) check_distance(w, direct, (hd_distance_kind)i);
        check_adjoint(w, chance(&w->chance, 0.5) ? direct : krylov);
        check_derivative(w, direct, krylov);
    }
    for (i = 0; i < 5; i++) free(a[i].k);
    hd_heat_free(direct);
    hd_heat_free(krylov);
}

#if defined(__unix__)
enum { PATIENCE = 300 };         /* seconds that no case takes */
static volatile uint64_t seed_now;
static void too_long(int number) {
    (void)number;
    fprintf(stderr, "robustness: case %llu does not end\n", (unsigned long long)seed_now);
    _exit(3);
}
#endif

static int kind_of(uint64_t seed) { return (int)(seed % KINDS); }

/* One that is drawn, or with its number one that is kept. */
static void run_case(uint64_t seed, const kept *old) {
    work *w = (work *)calloc(1, sizeof *w);
    if (!w) exit(2);
    w->seed = seed;
    w->kept = old;
    w->chance = seed * 0x9e3779b97f4a7c15u;
    w->kind = old ? KINDS : kind_of(seed);
    w->ctx.n_threads = 1;
#if defined(__unix__)
    seed_now = seed;
    alarm(PATIENCE);
#endif
    cases[w->kind]++;
    if (old) {
        make_kept(&w->m, old->shape[0]);
        if (old->shape[1]) make_kept(&w->m, old->shape[1]);
        if (hash_of(&w->m) != old->hash) contradiction(w, "not the shape that was kept", w->m.n, 0);
    } else make_mesh(&w->m, w->kind, &w->chance);
    if (make_pair(w)) run_queries(w);
    check_geodesic(w);
    hd_laplacian_free(w->lap);
    w->lap = NULL;
    if (w->ctx.bytes_in_use) contradiction(w, "bytes left in use", (double)w->ctx.bytes_in_use, 0);
    free(w);
}

static void run_kept(void) {
    size_t i;
    for (i = 0; i < sizeof kept_shapes / sizeof *kept_shapes; i++) {
        if (verbose) printf("%s\n", kept_shapes[i].what);
        run_case(i, kept_shapes + i);
    }
}

/* ==== [6] tables ==== */

static void add(tally *sum, const tally *t) {
    int q;
    sum->calls += t->calls;
    sum->ok += t->ok;
    sum->warned += t->warned;
    for (q = 0; q <= STATUSES; q++) sum->by_status[q] += t->by_status[q];
    sum->bounds += t->bounds;
    sum->checks += t->checks;
    sum->wrong += t->wrong;
    if (t->worst > sum->worst) sum->worst = t->worst;
}

static double percent(int64_t part, int64_t whole) { return whole > 0 ? 100.0 * (double)part / (double)whole : 100; }

/* Whether enough calls were answered, and enough bounds finite, in n cases that ask for so many each. Cases are drawn: the
 * shares of n may be less than those of all by 1/sqrt(n), which is two standard deviations at least. Kept cases are as they
 * are. Fewer than 20 say nothing. */
static int fell_short(const char *name, const char *of, const tally *t, int64_t n, int calls, int bounds, share least,
                      int drawn) {
    const double less = drawn ? 100 / sqrt((double)n) : 0, answers = percent(t->ok + t->warned, n * calls),
                 finite = percent(t->bounds, n * bounds);
    if ((drawn && n < 20) || n == 0 || (answers >= least.answers - less && finite >= least.bounds - less)) return 0;
    printf("%s%s%s: %.1f %% answered, %.1f %% with a finite bound; at least %d and %d, less %.1f\n", name,
           *of ? ", " : "", of, answers, finite, least.answers, least.bounds, less);
    return 1;
}

static void print_row(const char *name, const tally *t, int64_t calls, int64_t bounds) {
    int q;
    printf("%-16s %8lld %8lld %7lld", name, (long long)t->calls, (long long)t->ok, (long long)t->warned);
    for (q = 0; q <= STATUSES; q++) printf(" %8lld", (long long)t->by_status[q]);
    printf(" %8.1f %8.1f %9lld %6lld %8.2g\n", percent(t->ok + t->warned, calls), percent(t->bounds, bounds),
           (long long)t->checks, (long long)t->wrong, t->worst);
}

static void print_head(const char *name) {
    printf("\n%-16s %8s %8s %7s %8s %8s %8s %8s %8s %8s %8s %8s %9s %6s %8s\n", name, "calls", "ok", "warned", "empty",
           "infinite", "not pos.", "not conv", "breakd.", "other", "% answ.", "% bounds", "checks", "wrong", "worst");
}

static int kinds_fell_short(int *wrong) {
    int k, q, fell = 0;
    print_head("surface");
    for (k = 0; k <= KINDS; k++) {
        const char *name = k < KINDS ? kinds[k].name : "kept";
        tally sum;
        int calls = 0, bounds = 0;
        memset(&sum, 0, sizeof sum);
        for (q = 0; q < QUERIES; q++) {
            add(&sum, &tallies[k][q]);
            calls += queries[q].calls;
            bounds += queries[q].bounds;
        }
        print_row(name, &sum, cases[k] * calls, cases[k] * bounds);
        fell += fell_short(name, "", &sum, cases[k], calls, bounds, k < KINDS ? kinds[k].least : least_kept, k < KINDS);
        for (q = 0; q < QUERIES && k < KINDS; q++)
            fell += fell_short(name, queries[q].name, &tallies[k][q], cases[k], queries[q].calls, queries[q].bounds,
                               least_each, 1);
        *wrong += sum.wrong > 0;
    }
    return fell;
}

static int queries_fell_short(void) {
    int k, q, fell = 0;
    print_head("query");
    for (q = 0; q < QUERIES; q++) {
        tally sum;
        int64_t n = 0;
        memset(&sum, 0, sizeof sum);
        for (k = 0; k < KINDS; k++) {
            add(&sum, &tallies[k][q]);
            n += cases[k];
        }
        print_row(queries[q].name, &sum, n * queries[q].calls, n * queries[q].bounds);
        fell += fell_short(queries[q].name, "", &sum, n, queries[q].calls, queries[q].bounds, queries[q].least, 1);
    }
    return fell;
}

/* The exit status. */
static int print_tables(void) {
    int wrong = 0;
    const int short_kinds = kinds_fell_short(&wrong), short_queries = queries_fell_short();
    printf("\ncontradictions in %d rows; too little was answered in %d\n", wrong, short_kinds + short_queries);
    return wrong + short_kinds + short_queries > 0;
}

static const char *argument(int argc, char **argv, int *i) {
    if (*i + 1 < argc) return argv[++*i];
    fprintf(stderr, "robustness: %s takes a value\n", argv[*i]);
    exit(2);
}

int main(int argc, char **argv) {
    uint64_t seed = 1, only = 0, q;
    int64_t count = 10000;
    const char *kind = NULL;
    int i, only_kept = 0, one = 0;
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--count") == 0) count = strtoll(argument(argc, argv, &i), NULL, 10);
        else if (strcmp(argv[i], "--seed") == 0) seed = strtoull(argument(argc, argv, &i), NULL, 10);
        else if (strcmp(argv[i], "--kind") == 0) kind = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--shrink") == 0) shrink = strtod(argument(argc, argv, &i), NULL);
        else if (strcmp(argv[i], "--kept") == 0) only_kept = 1;
        else if (strcmp(argv[i], "--case") == 0) {
            only = strtoull(argument(argc, argv, &i), NULL, 10);
            one = verbose = 1;
        } else {
            fprintf(stderr, "usage: robustness [--count N] [--seed S] [--kind NAME] [--case SEED] [--kept] "
                            "[--shrink X]\n");
            return 2;
        }
    }
#if defined(__unix__)
    signal(SIGALRM, too_long);
#endif
    if (one) run_case(only, NULL);
    else run_kept();
    for (q = seed; !one && !only_kept && q < seed + (uint64_t)count; q++)
        if (!kind || strstr(kinds[kind_of(q)].name, kind)) run_case(q, NULL);
    return print_tables();
}
