/* convergence.c - how fast the Laplacians approach those of the smooth surface, as tables in Markdown

       cc -O2 tools/convergence.c -o convergence -lm && ./convergence

   The surfaces are the unit sphere and a torus of revolution (R = 2, r = 0.7), as meshes of four sizes. For
   each mesh the program computes the first 20 eigenvalues and eight columns of the symmetric heat kernel, and
   compares them with the smooth ones. Those are known in closed form on the sphere. On the torus u separates,
   and functions exp(imu) f(v) come from Fourier series in v. The order printed is that of the last step.

   The vertices of "shaken" meshes are moved along the surface at random by up to a fifth of an edge, because
   regular meshes look better than typical ones. The same follows for point sets, either independent of each
   other (random) or at a distance from each other (blue noise). They use the default bandwidth, and one that
   shrinks more slowly than the area of a point. The last table compares the summed areas of points with the
   area of the surface. The program takes some minutes. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "../tests/dense.h"
#include "shapes.h"

static const double PI = 3.14159265358979324, R = 2, r = 0.7;
enum { COUNT = 20, BLOCK = 36, LEVELS = 4, SOURCES = 8, WAVES = 24, TURNS = 40, NODES = 192 };

static const int32_t POINTS[LEVELS] = {500, 1260, 3175, 8000};

static void stop(const char *what, const hd_error *e) {
    fprintf(stderr, "convergence: %s: %s\n", what, e ? e->text : "");
    exit(1);
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* ---- the smooth surfaces ---- */

/* Modes of the torus: cos(m u) or sin(m u) times a function of v, given by its coefficients of 1, cos v, sin
 * v, cos 2v, .. */
typedef struct torus_mode { int m; double lambda, coef[2 * WAVES + 1]; } torus_mode;

static torus_mode *modes;
static int n_modes;

static double wave(int k, double v) { return k % 2 ? cos((k + 1) / 2 * v) : k ? sin(k / 2 * v) : 1; }
static double wave_slope(int k, double v) {
    return k % 2 ? -((k + 1) / 2) * sin((k + 1) / 2 * v) : k ? k / 2 * cos(k / 2 * v) : 0;
}

/* Galerkin with w = R + r cos v: int (w/r) f'g' + (m^2 r/w) f g dv = lambda int r w f g dv. The trapezoidal
 * rule is exact here, up to rounding. */
static void torus_modes(void) {
    enum { K = 2 * WAVES + 1 };
    int m, i, j, q;
    modes = DENSE_NEW(torus_mode, TURNS * K);
    for (m = 0; m < TURNS; m++) {
        double *A = DENSE_NEW(double, K * K), *B = DENSE_NEW(double, K * K);
        dense_pair p;
        for (q = 0; q < NODES; q++) {
            const double v = 2 * PI * q / NODES, w = R + r * cos(v), step = 2 * PI / NODES;
            for (i = 0; i < K; i++)
                for (j = 0; j < K; j++) {
                    A[i * K + j] += step * (w / r * wave_slope(i, v) * wave_slope(j, v) + m * m * r / w
                                            * wave(i, v) * wave(j, v));
                    B[i * K + j] += step * r * w * wave(i, v) * wave(j, v);
                }
        }
        if (!dense_pair_solve(&p, A, B, K)) stop("torus", NULL);
        for (i = 0; i < K; i++, n_modes++) {
            modes[n_modes].m = m;
            modes[n_modes].lambda = p.lambda[i];
            memcpy(modes[n_modes].coef, p.x + i * K, K * sizeof(double));
        }
        dense_pair_free(&p);
    }
}

static void torus_angles(const double *p, double *u, double *v) {
    *u = atan2(p[2], p[0]);
    *v = atan2(p[1], sqrt(p[0] * p[0] + p[2] * p[2]) - R);
}

static void smooth_eigenvalues(int torus, double *lambda) {
    double all[2 * TURNS * (2 * WAVES + 1)];
    int i, n = 0;
    for (i = 0; !torus && i < COUNT; i++) lambda[i] = floor(sqrt(i)) * (floor(sqrt(i)) + 1);
    if (!torus) return;
    for (i = 0; i < n_modes; i++) {
        all[n++] = modes[i].lambda;
        if (modes[i].m) all[n++] = modes[i].lambda;
    }
    qsort(all, (size_t)n, sizeof *all, ascending);
    memcpy(lambda, all, COUNT * sizeof *all);
}

/* k_t(x_i, source), a column for each source. */
static void sphere_kernel(const shape_poly *s, double t, const int32_t *source, double *k) {
    int32_t i;
    int l, q;
    for (q = 0; q < SOURCES; q++) {
        for (i = 0; i < s->n; i++, k++) {
            const double z = shape_dot(s->xyz + 3 * i, s->xyz + 3 * source[q]);
            double before = 1, now = z;
            *k = 1 / (4 * PI) + 3 * exp(-2 * t) * z / (4 * PI);
            for (l = 2; l * (l + 1) * t < 40; l++) {
                const double next = ((2 * l - 1) * z * now - (l - 1) * before) / l;
                before = now;
                now = next;
                *k += (2 * l + 1) * exp(-l * (l + 1) * t) * now / (4 * PI);
            }
        }
    }
}

static void torus_kernel(const shape_poly *s, double t, const int32_t *source, double *k) {
    enum { K = 2 * WAVES + 1 };
    double *at = DENSE_NEW(double, K * s->n), *u = DENSE_NEW(double, s->n), *f = DENSE_NEW(double, s->n), v;
    int32_t i;
    int q, j, c;
    for (i = 0; i < s->n; i++) {
        torus_angles(s->xyz + 3 * i, u + i, &v);
        for (j = 0; j < K; j++) at[K * i + j] = wave(j, v);
    }
    for (i = 0; i < SOURCES * s->n; i++) k[i] = 0;
    for (q = 0; q < n_modes; q++) {
        const double fade = exp(-modes[q].lambda * t) / (modes[q].m ? PI : 2 * PI);
        if (modes[q].lambda * t > 36) continue;
        for (i = 0; i < s->n; i++) f[i] = dense_dot(modes[q].coef, at + K * i, K);
        for (c = 0; c < SOURCES; c++)
            for (i = 0; i < s->n; i++)
                k[c * s->n + i] += fade * f[source[c]] * f[i] * cos(modes[q].m * (u[i] - u[source[c]]));
    }
    free(at);
    free(u);
    free(f);
}

/* ---- meshes ---- */

static void onto(int torus, double *p) {
    double ring[3] = {0, 0, 0}, len = sqrt(p[0] * p[0] + p[2] * p[2]);
    int c;
    if (torus) {
        ring[0] = R * p[0] / len;
        ring[2] = R * p[2] / len;
    }
    for (c = 0; c < 3; c++) p[c] -= ring[c];
    len = sqrt(shape_dot(p, p));
    for (c = 0; c < 3; c++) p[c] = ring[c] + p[c] / len * (torus ? r : 1);
}

typedef enum faces { TRIANGLES, QUADS, HEXAGONS } faces;

/* level 0 .. LEVELS - 1; each halves the edges. */
static shape_poly surface(int torus, faces kind, int level, int shaken) {
    const int32_t nv = (kind == HEXAGONS ? 8 : 10) << level;
    shape t = torus ? shape_torus(3 * nv, nv, R, r) : shape_icosphere(level + 2);
    shape_poly s = kind == TRIANGLES ? shape_poly_of(&t) : kind == HEXAGONS ? shape_dual(&t)
                                     : torus ? shape_quad_torus(3 * nv, nv, R, r)
                                     : shape_quad_sphere(5 << level);
    const double edge = sqrt((torus ? 4 * PI * PI * R * r : 4 * PI) / s.n);
    uint64_t seed = 5;
    int32_t i;
    if (!s.xyz) stop("out of memory", NULL);
    for (i = 0; i < 3 * s.n; i++)
        if (shaken) s.xyz[i] += 0.2 * edge * dense_signed(&seed);
    for (i = 0; i < s.n; i++) onto(torus, s.xyz + 3 * i);
    shape_free(&t);
    return s;
}

/* A random point of this torus, uniform by area: there are more points on the outside. */
static void on_torus(uint64_t *seed, double p[3]) {
    const double u = 2 * PI * shape_uniform(seed);
    double v, q;
    do {
        v = 2 * PI * shape_uniform(seed);
        q = R + r * cos(v);
    } while ((R + r) * shape_uniform(seed) > q);
    p[0] = q * cos(u);
    p[1] = r * sin(v);
    p[2] = q * sin(u);
}

static double true_area(int torus) { return torus ? 4 * PI * PI * R * r : 4 * PI; }

static shape_poly points_on(int torus, int32_t n, int blue) {
    shape t = shape_points(n, torus ? on_torus : shape_on_sphere, true_area(torus), blue, 1);
    shape_poly s = shape_poly_of(&t);
    if (!s.xyz) stop("out of memory", NULL);
    shape_free(&t);
    return s;
}

/* The vertices nearest to eight places that are the same for all meshes. */
static void sources_on(const shape_poly *s, int torus, int32_t *source) {
    uint64_t seed = 9;
    int32_t i;
    int q, c;
    for (q = 0; q < SOURCES; q++) {
        double p[3];
        for (c = 0; c < 3; c++) p[c] = (torus && c != 1 ? R + r : 1) * dense_signed(&seed);
        onto(torus, p);
        for (i = source[q] = 0; i < s->n; i++)
            if (shape_distance(s->xyz + 3 * i, p) < shape_distance(s->xyz + 3 * source[q], p)) source[q] = i;
    }
}

/* ---- the discrete surfaces ---- */

/* X <- Ritz vectors of L, B on the space of the n x BLOCK columns of Y, by ascending Ritz value. */
static void ritz(const hd_laplacian *lap, const double *Y, double *X, double *lambda) {
    const int32_t n = lap->n;
    double *a = DENSE_NEW(double, BLOCK * BLOCK), *b = DENSE_NEW(double, BLOCK * BLOCK),
        *z = DENSE_NEW(double, n), sorted[BLOCK];
    dense_pair p;
    int i, j, k;
    int32_t q;
    for (i = 0; i < BLOCK; i++) {
        hd_laplacian_apply(lap, 1, 0, Y + (size_t)i * (size_t)n, z, NULL);
        for (j = 0; j < BLOCK; j++) a[i * BLOCK + j] = dense_dot(z, Y + (size_t)j * (size_t)n, n);
        hd_laplacian_apply(lap, 0, 1, Y + (size_t)i * (size_t)n, z, NULL);
        for (j = 0; j < BLOCK; j++) b[i * BLOCK + j] = dense_dot(z, Y + (size_t)j * (size_t)n, n);
    }
    if (!dense_pair_solve(&p, a, b, BLOCK)) stop("eigenvalues", NULL);
    memcpy(sorted, p.lambda, sizeof sorted);
    qsort(sorted, BLOCK, sizeof *sorted, ascending);
    memcpy(lambda, sorted, COUNT * sizeof *lambda);
    /* the order of the columns does not matter to the iteration */
    for (k = 0; k < BLOCK; k++)
        for (q = 0; q < n; q++) {
            double sum = 0;
            for (j = 0; j < BLOCK; j++) sum += p.x[k * BLOCK + j] * Y[(size_t)j * (size_t)n + (size_t)q];
            X[(size_t)k * (size_t)n + (size_t)q] = sum;
        }
    dense_pair_free(&p);
    free(z);
}

/* Subspace iteration with (L + B)^-1 B. */
static void eigenvalues(const hd_laplacian *lap, double *lambda) {
    const size_t n = (size_t)lap->n;
    double *val = DENSE_NEW(double, lap->L.nnz), *X = DENSE_NEW(double, BLOCK * lap->n),
        *Y = DENSE_NEW(double, BLOCK * lap->n), old[COUNT] = {0}, change = 1;
    hd_ldl_opts o;
    hd_ldl *f = NULL;
    hd_error e;
    uint64_t seed = 1;
    int64_t p;
    size_t i;
    const double enough = lap->mesh.n_faces ? 1e-11 : 1e-6;
    int step;
    memset(&o, 0, sizeof o);
    o.xyz = lap->xyz;
    for (i = 0; i < n; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            val[p] = lap->L.val[p] + (lap->B ? lap->B[p] : (size_t)lap->L.col[p] == i ? lap->mass[i] : 0);
    if (hd_ldl_analyse(&f, &lap->L, &o, NULL, &e) < 0 || hd_ldl_factor(f, val, NULL, &e) < 0)
        stop("factor", &e);
    for (i = 0; i < BLOCK * n; i++) X[i] = dense_signed(&seed);
    for (step = 0; step < 100 && change > enough; step++) {
        for (i = 0; i < BLOCK; i++) hd_laplacian_apply(lap, 0, 1, X + i * n, Y + i * n, NULL);
        if (hd_ldl_solve(f, BLOCK, Y, 0, Y, 0, &e) < 0) stop("solve", &e);
        ritz(lap, Y, X, lambda);
        for (i = 1, change = 0; i < COUNT; i++) change = fmax(change, fabs(lambda[i] - old[i]) / lambda[i]);
        memcpy(old, lambda, sizeof old);
    }
    hd_ldl_free(f);
    free(val);
    free(X);
    free(Y);
}

/* A row of a table. Points: bandwidth 0 is the default. p means the default for the fewest points, then
 * shrinking like h^p. */
typedef struct operator_def { const char *name; hd_laplacian_kind kind; int points, tufted; double bandwidth;
                              } operator_def;

static hd_laplacian *laplacian(const shape_poly *s, const operator_def *op, double bandwidth) {
    hd_laplacian_opts lo;
    hd_laplacian *lap = NULL;
    hd_error e;
    hd_status status;
    memset(&lo, 0, sizeof lo);
    lo.kind = op->kind;
    lo.bandwidth2 = bandwidth;
    if (op->tufted) lo.triangulation = HD_TRIANGULATION_TUFTED;
    if (op->points) status = hd_laplacian_create(&lap, MESH_POINTS(s->xyz, s->n), &lo, &e);
    else status = hd_laplacian_create(&lap, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &lo, &e);
    if (status < 0) stop("laplacian", &e);
    if (lap->n_active != lap->n) stop("vertices without mass", NULL);
    return lap;
}

/* Largest relative error of the eigenvalues 2 to COUNT, and of the kernel's columns, at a vertex and in the
 * mean square, relative to their largest value. */
static void errors(const shape_poly *s, int torus, const hd_laplacian *lap, double out[3]) {
    /* tends to Laplacian/area, with masses of 1 for area/n */
    const int exponential = lap->kind == HD_LAPLACIAN_EXP;
    const double t = torus ? 0.3 : 0.1, slower = exponential ? lap->area : 1, thinner = exponential
                     ? lap->n / lap->area : 1;
    int32_t source[SOURCES], i;
    double lambda[COUNT], want[COUNT], *k = DENSE_NEW(double, SOURCES * s->n),
        *u = DENSE_NEW(double, SOURCES * s->n), top, sum = 0, t_of_heat;
    hd_heat_opts ho;
    hd_heat *heat = NULL;
    hd_report report;
    hd_error e;
    memset(&ho, 0, sizeof ho);
    ho.degree = lap->mesh.n_faces ? 14 : 0;      /* points are far from such digits */
    sources_on(s, torus, source);
    if (hd_heat_create(&heat, lap, &ho, &e) < 0) stop("heat", &e);
    t_of_heat = t * slower;
    if (hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, 1, &t_of_heat, VERTICES(SOURCES, source), u, 0, &report, NULL) < 0)
        stop("heat", &report.error);
    if (torus) torus_kernel(s, t, source, k);
    else sphere_kernel(s, t, source, k);
    eigenvalues(lap, lambda);
    smooth_eigenvalues(torus, want);
    out[0] = out[1] = out[2] = 0;
    for (i = 1; i < COUNT; i++) out[0] = fmax(out[0], fabs(slower * lambda[i] / want[i] - 1));
    top = dense_max_abs(k, SOURCES * s->n);
    for (i = 0; i < SOURCES * s->n; i++) {
        const double off = (thinner * u[i] - k[i]) / top, mass = lap->mass[i % s->n];
        out[1] = fmax(out[1], fabs(off));
        out[2] += mass * off * off;
        sum += mass;
    }
    out[2] = sqrt(out[2] / sum);
    hd_heat_free(heat);
    free(k);
    free(u);
}

static void print_row(const char *name, int32_t n, double (*e)[3], const double *h) {
    int level, q;
    printf("| %s | %d |", name, (int)n);
    for (q = 0; q < 3; q++) {
        for (level = 0; level < LEVELS; level++)
            printf(" %.1e%s", e[level][q], level + 1 < LEVELS ? "," : " |");
        printf(" %.2f |", log(e[LEVELS - 2][q] / e[LEVELS - 1][q]) / log(h[LEVELS - 2] / h[LEVELS - 1]));
    }
    printf("\n");
    fflush(stdout);
}

static void mesh_row(const operator_def *op, int torus, faces mesh, int shaken) {
    double e[LEVELS][3], h[LEVELS];
    char name[80];
    int32_t n = 0;
    int level;
    for (level = 0; level < LEVELS; level++) {
        shape_poly s = surface(torus, mesh, level, shaken);
        hd_laplacian *lap = laplacian(&s, op, 0);
        errors(&s, torus, lap, e[level]);
        h[level] = lap->h;
        n = s.n;
        hd_laplacian_free(lap);
        shape_poly_free(&s);
    }
    snprintf(name, sizeof name, "%s%s", op->name, shaken ? ", shaken" : "");
    print_row(name, n, e, h);
}

/* h: the typical distance. */
static void point_row(const operator_def *op, int torus, int blue) {
    double e[LEVELS][3], h[LEVELS], first = 0;
    char name[80];
    int32_t n = 0;
    int level;
    for (level = 0; level < LEVELS; level++) {
        shape_poly s = points_on(torus, n = POINTS[level], blue);
        hd_laplacian *lap;
        h[level] = sqrt(true_area(torus) / n);
        lap = laplacian(&s, op, op->bandwidth > 0 &&
                        level > 0 ? first * pow(h[level] / h[0], op->bandwidth) : 0);
        if (level == 0) first = lap->points.bandwidth2;
        errors(&s, torus, lap, e[level]);
        hd_laplacian_free(lap);
        shape_poly_free(&s);
    }
    snprintf(name, sizeof name, "%s, %s", op->name, blue ? "blue noise" : "random");
    print_row(name, n, e, h);
}

static void area_table(void) {
    static const operator_def cells = {"", HD_LAPLACIAN_VORONOI_EXP, 1, 0, 0},
        stars = {"", HD_LAPLACIAN_FEM, 1, 1, 0};
    enum { N = 10000 };
    int torus, blue;
    printf("Areas of %d points, summed, over that of the surface, less 1\n\n"
           "| points | Voronoi cells | stars (tufted) |\n|---|---|---|\n", N);
    for (torus = 0; torus < 2; torus++)
        for (blue = 0; blue < 2; blue++) {
            shape_poly s = points_on(torus, N, blue);
            hd_laplacian *lap = laplacian(&s, &cells, 0), *tufted = laplacian(&s, &stars, 0);
            printf("| %s, %s | %+.2e | %+.2e |\n", torus ? "torus" : "sphere", blue ? "blue noise" : "random",
                   lap->area / true_area(torus) - 1, tufted->area / true_area(torus) - 1);
            hd_laplacian_free(lap);
            hd_laplacian_free(tufted);
            shape_poly_free(&s);
        }
}

static const struct { operator_def op; faces mesh; } MESHES[] = {
    {{"fem, triangles", HD_LAPLACIAN_FEM, 0, 0, 0}, TRIANGLES},
    {{"voronoi-cot, triangles", HD_LAPLACIAN_VORONOI_COT, 0, 0, 0}, TRIANGLES},
    {{"polygon, triangles", HD_LAPLACIAN_POLYGON, 0, 0, 0}, TRIANGLES},
    {{"polygon, quadrilaterals", HD_LAPLACIAN_POLYGON, 0, 0, 0}, QUADS},
    {{"fem, split quadrilaterals", HD_LAPLACIAN_FEM, 0, 0, 0}, QUADS},
    {{"polygon, hexagons", HD_LAPLACIAN_POLYGON, 0, 0, 0}, HEXAGONS},
    {{"fem, split hexagons", HD_LAPLACIAN_FEM, 0, 0, 0}, HEXAGONS}};

static const operator_def CLOUDS[] = {
    {"voronoi-exp", HD_LAPLACIAN_VORONOI_EXP, 1, 0, 0},
    {"voronoi-exp, bandwidth like h^1.5", HD_LAPLACIAN_VORONOI_EXP, 1, 0, 1.5},
    {"exp", HD_LAPLACIAN_EXP, 1, 0, 0},
    {"exp, bandwidth like h^1.5", HD_LAPLACIAN_EXP, 1, 0, 1.5},
    {"tufted, fem", HD_LAPLACIAN_FEM, 1, 1, 0},
    {"tufted, voronoi-cot", HD_LAPLACIAN_VORONOI_COT, 1, 1, 0}};

int main(void) {
    int torus, second;
    size_t q;
    torus_modes();
    for (torus = 0; torus < 2; torus++) {
        printf("%s\n\n"
               "| operator | vertices | eigenvalues 2 to %d, largest relative error | order | k_t, largest "
               "error | order | k_t, mean square | order |\n"
               "|---|---|---|---|---|---|---|---|\n", torus ? "Torus, t = 0.3" : "Sphere, t = 0.1", COUNT);
        for (second = 0; second < 2; second++)
            for (q = 0; q < sizeof MESHES / sizeof *MESHES; q++)
                mesh_row(&MESHES[q].op, torus, MESHES[q].mesh, second);
        for (second = 0; second < 2; second++)
            for (q = 0; q < sizeof CLOUDS / sizeof *CLOUDS; q++) point_row(CLOUDS + q, torus, second);
        printf("\n");
    }
    area_table();
    free(modes);
    return 0;
}
