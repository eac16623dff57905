/* kit.h - what tests work on, made from a line of text and freed by itself

   Everything made here is freed when the group ends, the last first; kit_release(mark) frees what was made after
   `mark = kit_mark()`, for loops. Makers stop the program where they fail: tests of failures make things themselves. */

#ifndef KIT_H
#define KIT_H

typedef struct kit_entry { void *object; void (*destroy)(void *object); } kit_entry;
static kit_entry *kit_list;
static int32_t kit_count, kit_room;

static int32_t kit_mark(void) { return kit_count; }

static void kit_release(int32_t mark) {
    while (kit_count > mark) {
        kit_count--;
        kit_list[kit_count].destroy(kit_list[kit_count].object);
    }
    if (kit_count > 0) return;
    free(kit_list);
    kit_list = NULL;
    kit_room = 0;
}

static void *kit_keep(void *object, void (*destroy)(void *object)) {
    if (kit_count == kit_room) {
        kit_room = kit_room ? 2 * kit_room : 64;
        kit_list = (kit_entry *)realloc(kit_list, (size_t)kit_room * sizeof *kit_list);
        if (!kit_list) truth_stop("out of memory");
    }
    kit_list[kit_count].object = object;
    kit_list[kit_count++].destroy = destroy;
    return object;
}

static void kit_free_laplacian(void *p) { hd_laplacian_free((hd_laplacian *)p); }
static void kit_free_heat(void *p) { hd_heat_free((hd_heat *)p); }
static void kit_free_body(void *p) {
    trial_body_free((trial_body *)p);
    free(p);
}
static void kit_free_csr(void *p) {
    hd_csr_free((hd_csr *)p, NULL);
    free(p);
}

/* Zeros. */
#define KIT_NEW(type, count) ((type *)kit_keep(truth_room((int64_t)(count), sizeof(type)), free))

/* An array that lives until the group ends, filled by xorshift: numbers in [-1, 1). */
static double *kit_random(int64_t count, uint64_t seed) {
    double *x = KIT_NEW(double, count);
    int64_t i;
    for (i = 0; i < count; i++) x[i] = dense_signed(&seed);
    return x;
}

/* A shape: "bumpy/3/7", see trial_body_make and trial_shape in tools/trials.h. Triangles in s, polygons in p, the matrix of a
 * graph in L. */
static const trial_body *kit_body(const char *spec) {
    trial_body *b = KIT_NEW(trial_body, 1);
    if (!trial_body_make(b, spec)) truth_stop(spec);
    kit_list[kit_count - 1].destroy = kit_free_body;
    return b;
}

static const shape *kit_shape(const char *spec) { return &kit_body(spec)->s; }

/* The pair of a shape by an operator: kit_pair("sphere/2 fem"), kit_pair("bumpy/3/1 vor+id"); one thread. */
static hd_laplacian *kit_pair(const char *spec) {
    char name[64];
    const char *op = strchr(spec, ' ');
    hd_laplacian *lap = NULL;
    hd_error e;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(spec, " "), spec);
    if (trial_pair(&lap, name, op ? op + 1 : "fem", 1, &e) < 0) truth_stop(e.text);
    return (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
}

/* A shape that is made elsewhere, freed with the rest. */
static const shape *kit_own(shape s) {
    trial_body *b = KIT_NEW(trial_body, 1);
    if (!s.xyz) truth_stop("out of memory");
    b->s = s;
    kit_list[kit_count - 1].destroy = kit_free_body;
    return &b->s;
}

/* The pair of triangles, with threads as the library has them. */
static hd_laplacian *kit_triangles(const shape *s, hd_laplacian_kind kind) {
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    if (hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, &e) < 0) truth_stop(e.text);
    return (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
}

/* The pair of a graph of m edges a, b of weights w (NULL: 1), B diagonal of this mass (NULL: 1). */
static hd_laplacian *kit_graph(int32_t n, int32_t m, const int32_t *a, const int32_t *b, const double *w, const double *mass) {
    const int32_t mark = kit_mark();
    int32_t *i = KIT_NEW(int32_t, 4 * m + n), *j = KIT_NEW(int32_t, 4 * m + n), k;
    double *v = KIT_NEW(double, 4 * m + n), *one = KIT_NEW(double, n);
    hd_laplacian *lap = NULL;
    hd_csr L, B;
    hd_error e;
    memset(&L, 0, sizeof L);
    memset(&B, 0, sizeof B);
    for (k = 0; k < 4 * m; k++) {                /* its four entries */
        const int32_t at[2] = {a[k / 4], b[k / 4]};
        i[k] = at[k % 2];
        j[k] = at[k / 2 % 2];
        v[k] = (i[k] == j[k] ? 1 : -1) * (w ? w[k / 4] : 1);
    }
    for (k = 0; k < n; k++) {                    /* zeros: every vertex has a diagonal entry */
        i[4 * m + k] = j[4 * m + k] = k;
        one[k] = mass ? mass[k] : 1;
    }
    if (hd_csr_from_triplets(&L, n, n, 4 * (int64_t)m + n, i, j, v, NULL, &e) < 0) truth_stop(e.text);
    if (hd_csr_from_triplets(&B, n, n, n, i + 4 * m, j + 4 * m, one, NULL, &e) < 0) truth_stop(e.text);
    if (hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) < 0) truth_stop(e.text);
    hd_csr_free(&L, NULL);
    hd_csr_free(&B, NULL);
    kit_release(mark);
    return (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
}

/* The graph of nx x ny nodes, (i, j) at i ny + j: paths of weight 1, closed ones if asked, and across them cycles of weight wy. */
static hd_laplacian *kit_lattice(int32_t nx, int32_t ny, int closed, double wy, double mass) {
    const int32_t mark = kit_mark(), n = nx * ny;
    int32_t *a = KIT_NEW(int32_t, 2 * n), *b = KIT_NEW(int32_t, 2 * n), i, j, m = 0;
    double *w = KIT_NEW(double, 2 * n), *masses = KIT_NEW(double, n);
    hd_laplacian *lap;
    for (i = 0; i < nx; i++)
        for (j = 0; j < ny; j++) {
            masses[i * ny + j] = mass;
            if (closed || i + 1 < nx) {
                w[m] = 1;
                a[m] = i * ny + j;
                b[m++] = (i + 1) % nx * ny + j;
            }
            if (ny > 1) {
                w[m] = wy;
                a[m] = i * ny + j;
                b[m++] = i * ny + (j + 1) % ny;
            }
        }
    lap = kit_graph(n, m, a, b, w, masses);
    kit_count--;                                 /* it stays, the lists go */
    kit_release(mark);
    return (hd_laplacian *)kit_keep(lap, kit_free_laplacian);
}

/* A path of n vertices, weights 2^l, masses 1, 2, 3 times 2^b. */
static hd_laplacian *kit_path(int32_t n, int l, int b) {
    int32_t *from = KIT_NEW(int32_t, n), *to = KIT_NEW(int32_t, n), i;      /* freed with the rest */
    double *w = KIT_NEW(double, n), *mass = KIT_NEW(double, n);
    for (i = 0; i < n; i++) {
        from[i] = i;
        to[i] = i + 1;
        w[i] = ldexp(1, l);
        mass[i] = ldexp(1 + i % 3, b);
    }
    return kit_graph(n, n - 1, from, to, w, mass);
}

/* A plan by options, without a context of its own: that must live until the group ends. */
static hd_heat *kit_plan(const hd_laplacian *lap, const hd_heat_opts *o) {
    hd_heat *heat = NULL;
    hd_error e;
    if (hd_heat_create(&heat, lap, o, &e) < 0) truth_stop(e.text);
    return (hd_heat *)kit_keep(heat, kit_free_heat);
}

/* A plan by words of tools/trials.h: kit_heat(lap, "method=direct degree=9 tol=1e-10"); one thread. */
static hd_heat *kit_heat(const hd_laplacian *lap, const char *options) {
    const trial c = trial_parse(options);
    const hd_heat_opts o = trial_options(&c);
    return kit_plan(lap, &o);
}

/* What is made elsewhere and freed with the rest. */
static hd_csr *kit_csr(hd_csr a) {
    hd_csr *own = KIT_NEW(hd_csr, 1);
    *own = a;
    kit_list[kit_count - 1].destroy = kit_free_csr;
    return own;
}

static hd_csr kit_own_csr(hd_csr a) { return *kit_csr(a); }
static hd_laplacian *kit_own_laplacian(hd_laplacian *lap) { return (hd_laplacian *)kit_keep(lap, kit_free_laplacian); }

static shape kit_own_shape(shape s) {
    trial_body *b = KIT_NEW(trial_body, 1);
    b->s = s;
    kit_list[kit_count - 1].destroy = kit_free_body;
    return s;
}

static shape_poly kit_own_poly(shape_poly p) {
    trial_body *b = KIT_NEW(trial_body, 1);
    b->p = p;
    kit_list[kit_count - 1].destroy = kit_free_body;
    return p;
}

#endif
