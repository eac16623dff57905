/* rough_surfaces.c - how much heat changes on a noisy, incomplete or unevenly sampled surface

   Build and run from the project's folder:

       cc -O2 tools/rough_surfaces.c -o rough_surfaces -lm && ./rough_surfaces
       ./rough_surfaces FOLDER           also writes pictures and meshes to FOLDER, which must exist
       ./rough_surfaces FOLDER MESH      the same for a mesh of your own
       ./rough_surfaces --check          computes nothing but what is held against tools/README.md: the middle time

   Variants of one surface are made in memory: noise along the normals, holes, an end cut off, and triangles
   that are a hundred times finer in some places than in others. On each variant the heat kernel k_t(x,
   source) and the diffusion distance to the source are computed at three times, by operators on meshes and on
   points. They are compared with the answer of the same operator on the original, at the vertices that both
   have.

   The tables, in Markdown, show the changes in percent of the original's largest value: root mean square and
   largest. The last table is about the maximum principle: how far heat falls below zero on bad triangles. The
   pictures show the original beside its variants in the same colours; the meshes carry both fields.

   Without a mesh of your own, the numbers are held against those in tools/README.md, and the exit status is 1 if
   one is not as it says there. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "meshio.h"
#include "picture.h"
#include "shapes.h"

#define VARIANTS_PROGRAM "rough_surfaces"
#include "variants.h"

enum { TIMES = 3, MIDDLE = 1, FIELDS = 2 * TIMES, SOURCES = 8 };

/* Heat kernel and distance on a surface: value[q n + i], first TIMES kernels, then TIMES distances. */
typedef struct answer { int32_t n; double *value; } answer;

enum { ORIGINAL, NOISE_1, NOISE_2, NOISE_3, HOLES_1, HOLES_2, CUT, UNEVEN, VARIANTS };
static surface variant[VARIANTS];
static double times[TIMES];
static int32_t source;                  /* on the original */

/* ---- what tools/README.md says ---- */

enum { ROWS = 8, KERNEL = MIDDLE, DISTANCE = TIMES + MIDDLE };      /* the variants, and one of them scaled */

/* Changes at the middle time: of the kernel in the mean and at most, and of the distance. */
static const double page_meshes[ROWS][4] = {{.1, .5, .1, .3}, {1.8, 5.6, 1.1, 2.7}, {7.2, 22.9, 4.1, 10.3}, {1.3, 5.8, 1.1, 2.2},
                                            {2.1, 12.3, 2.9, 8}, {5.7, 25.4, 9.4, 29}, {0, 0, 3.9, 14}, {.3, 1.4, .3, 1.4}},
                    page_points[ROWS][4] = {{.1, .3, .2, .3}, {.7, 2.6, 1.9, 2.8}, {4.4, 13.9, 1.7, 6.2}, {1.4, 7.3, 1, 5.1},
                                            {.3, 3, .4, 2.4}, {1, 9.6, 1.7, 6.8}, {0, 0, 3.8, 13}, {2.7, 10.3, 7.1, 13.5}},
                    page_stars[ROWS][4] = {{.1, .5, .1, .3}, {1.8, 5.6, 1.1, 2.7}, {8, 25.3, 5.2, 10.7}, {2.4, 9.9, 4.2, 9.2},
                                           {.3, 1.9, .3, 1.2}, {.5, 2.9, .6, 1.7}, {0, 0, 3.6, 12.1}, {.5, 5.2, .6, 4.2}};

/* How many weights are negative, and the least value of heat: voronoi-cot, with Delaunay flips, tufted. */
static const struct least { int32_t weights; double value; } page_least[6][3] = {
    {{25, -.01}, {0, 0}, {0, 0}},       {{506, -.1}, {0, 0}, {0, 0}},   {{25, -.005}, {1, -.006}, {0, 0}},
    {{480, -.0002}, {0, 0}, {0, 0}},    {{5261, -.2}, {0, 0}, {0, 0}},  {{4614, -.5}, {534, -1}, {0, 0}}};

static int own_mesh, check, wrong;

/* Other processors and compilers round other sines, and a flip that comes out the other way changes a digit. So numbers may
 * be off by a tenth of themselves; and by a tenth of a percent, because the page rounds to that and says that operators on
 * meshes agree to that. */
static void hold(const char *operator_name, const char *what, double got, double page, double least) {
    if (own_mesh || fabs(got - page) <= least + 0.1 * fabs(page)) return;
    fprintf(stderr, "rough_surfaces: %s, %s: %.4g, where tools/README.md says %.4g\n", operator_name, what, got, page);
    wrong++;
}

static void hold_row(const char *operator_name, const char *what, double got[FIELDS][2], const double page[4]) {
    hold(operator_name, what, got[KERNEL][0], page[0], 0.1);
    hold(operator_name, what, got[KERNEL][1], page[1], 0.2);
    hold(operator_name, what, got[DISTANCE][0], page[2], 0.1);
    hold(operator_name, what, got[DISTANCE][1], page[3], 0.2);
}

/* Without a negative weight heat is nowhere negative, by theory: it may be below zero by its bound, which must be small.
 * Otherwise the least value, of which the page has one digit, is the one there up to a factor of two. */
static void hold_least(const char *operator_name, const char *what, int64_t weights, double value, double bound,
                       struct least page) {
    hold(operator_name, what, (double)weights, page.weights, 0);
    if (own_mesh || (page.value < 0 ? value < page.value / 2 && value > 2 * page.value
                                    : value >= -fmin(bound, 3e-8) && bound < 1e-5)) return;
    fprintf(stderr, "rough_surfaces: %s, %s: least value %.3g within %.3g, where tools/README.md says %.3g\n",
            operator_name, what, value, bound, page.value);
    wrong++;
}

/* ---- heat ---- */

/* With unit > 0, times and values are scaled as if the surface had this area. 0: no scaling. */
static answer solve(const method *m, const surface *f, double unit) {
    answer a;
    hd_laplacian *lap = laplacian(m, &f->s, NULL);
    hd_heat *heat = NULL;
    hd_report report;
    hd_error e;
    const double scale = unit > 0 ? lap->area / unit : 1;
    const int first = check ? MIDDLE : 0, count = check ? 1 : TIMES;
    double t[TIMES], *k;
    int32_t here = 0, i;
    while (here < f->s.n && f->of[here] != source) here++;
    if (here == f->s.n) stop("the source is gone", NULL);
    for (i = 0; i < TIMES; i++) t[i] = scale * times[i];
    a.n = f->s.n;
    a.value = (double *)room(FIELDS * (int64_t)a.n, sizeof *a.value);
    if (hd_heat_create(&heat, lap, NULL, &e) < 0) stop(m->name, &e);
    k = a.value + (size_t)first * (size_t)a.n;
    if (hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, count, t + first, VERTICES(1, &here), k, 0, &report, NULL) < 0)
        stop(m->name, &report.error);
    k += TIMES * (size_t)a.n;
    if (hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, count, t + first, VERTICES(1, &here), k, 0, &report, NULL) < 0)
        stop(m->name, &report.error);
    for (i = 0; i < TIMES * a.n; i++) a.value[i] *= scale;              /* k_t is 1/area, d_t is 1/length */
    for (; i < FIELDS * a.n; i++) a.value[i] *= sqrt(scale);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return a;
}

/* ---- pictures and meshes ---- */

static void picture(const char *folder, const char *name, int n, const int *which, const answer *a,
                    int field) {
    pic_panel panel[4];
    pic_opts o;
    pic_image image;
    char path[500];
    int k;
    memset(panel, 0, sizeof panel);
    memset(&o, 0, sizeof o);
    for (k = 0; k < n; k++) {
        const int v = which[k];
        panel[k].n = a[v].n;
        /* as points, so that they are seen */
        panel[k].n_tri = v == UNEVEN && n > 2 ? 0 : variant[v].s.n_tri;
        panel[k].xyz = variant[v].s.xyz;
        panel[k].tri = variant[v].s.tri;
        panel[k].field = a[v].value + (size_t)field * (size_t)a[v].n;
        panel[k].caption = variant[v].name;
    }
    o.width = n > 2 ? 920 : 1200;
    o.height = n > 2 ? 236 : 560;
    o.point_radius = 0.3 * mean_edge(&variant[ORIGINAL].s);
    o.columns = n;
    o.view_given = 1;
    o.azimuth = 28;
    o.elevation = 14;
    o.no_legend = n > 2;
    snprintf(path, sizeof path, "%.400s/%s.png", folder, name);
    if (pic_render_grid(&image, panel, n, &o) != PIC_OK ||
        pic_png_write(path, image.rgb, image.width, image.height) != PIC_OK)
        stop(path, NULL);
    pic_image_free(&image);
}

static void mesh(const char *folder, const char *name, const surface *f, const answer *a) {
    static const char *const names[FIELDS] = {"kernel_0", "kernel_1", "kernel_2", "distance_0", "distance_1",
                                              "distance_2"};
    mio_mesh m;
    mio_output o;
    mio_error e;
    char path[500];
    int32_t i;
    memset(&m, 0, sizeof m);
    memset(&o, 0, sizeof o);
    m.n = f->s.n;
    m.xyz = f->s.xyz;
    m.n_faces = f->s.n_tri;
    m.face_idx = f->s.tri;
    m.face_ptr = (int64_t *)room(f->s.n_tri + 1, sizeof *m.face_ptr);
    for (i = 0; i <= f->s.n_tri; i++) m.face_ptr[i] = 3 * (int64_t)i;
    o.rows = o.ld = m.n;
    o.cols = FIELDS;
    o.values = a->value;
    o.names = names;
    snprintf(path, sizeof path, "%.400s/%s.ply", folder, name);
    if (mio_write(path, MIO_PLY, &m, &o, &e) < 0) stop(path, NULL);
    free(m.face_ptr);
}

static void show(const char *folder, const answer *a) {
    static const int pairs[3][2] = {{ORIGINAL, NOISE_3}, {ORIGINAL, HOLES_2}, {ORIGINAL, UNEVEN}},
        all[4] = {ORIGINAL, NOISE_3, HOLES_2, UNEVEN};
    static const char *const names[VARIANTS] = {"original", "", "", "noise", "", "holes", "cut", "uneven"};
    int k;
    for (k = 0; k < 3; k++) picture(folder, names[pairs[k][1]], 2, pairs[k], a, TIMES + MIDDLE);
    picture(folder, "rough", 4, all, a, TIMES + MIDDLE);
    for (k = 0; k < VARIANTS; k++)
        if (names[k][0]) mesh(folder, names[k], variant + k, a + k);
}

/* ---- tables ---- */

/* The change of every field from the original, at common vertices, in percent of the largest value. */
static void print_change(const surface *f, const answer *a, const answer *original, double got[FIELDS][2]) {
    int32_t i, n;
    int q;
    for (q = 0; q < FIELDS; q++) {
        const double *u = a->value + (size_t)q * (size_t)a->n,
            *u0 = original->value + (size_t)q * (size_t)original->n;
        double top = 0, sum = 0, worst = 0;
        if (check && q % TIMES != MIDDLE) {
            printf(" |");
            continue;
        }
        for (i = 0; i < original->n; i++) top = fmax(top, fabs(u0[i]));
        for (i = n = 0; i < a->n; i++) {
            const double off = f->of[i] < 0 ? 0 : 100 * fabs(u[i] - u0[f->of[i]]) / top;
            n += f->of[i] >= 0;
            worst = fmax(worst, off);
            sum += off * off;
        }
        got[q][0] = sqrt(sum / n);
        got[q][1] = worst;
        printf(" %.1f (%.3g) |", got[q][0], worst < 99.5 ? floor(10 * worst + 0.5) / 10 : worst);
    }
    printf("\n");
    fflush(stdout);
}

static void table(const method *m, const char *folder, const double page[ROWS][4]) {
    answer a[VARIANTS], scaled;
    hd_laplacian *lap = laplacian(m, &variant[ORIGINAL].s, NULL);
    double got[FIELDS][2];
    int v, row = 0;
    printf("\n| %s | k_t, t = %.4g | t = %.4g | t = %.4g | d_t, t = %.4g | t = %.4g | t = %.4g |\n"
           "|---|---|---|---|---|---|---|\n", m->name, times[0], times[1],
           times[2], times[0], times[1], times[2]);
    for (v = 0; v < VARIANTS; v++) {
        a[v] = solve(m, variant + v, 0);
        if (v == ORIGINAL) continue;
        printf("| %s |", variant[v].name);
        print_change(variant + v, a + v, a, got);
        hold_row(m->name, variant[v].name, got, page[row++]);
        if (v != NOISE_3) continue;
        scaled = solve(m, variant + v, lap->area);
        printf("| the same, scaled to the original's area |");
        print_change(variant + v, &scaled, a, got);
        hold_row(m->name, "scaled", got, page[row++]);
        free(scaled.value);
    }
    if (folder) show(folder, a);
    for (v = 0; v < VARIANTS; v++) free(a[v].value);
    hd_laplacian_free(lap);
}

/* The sources most likely to make heat negative: d/dt K_t(i,j) = -L_ij/b_i at t = 0 is smallest there. The
 * rest is random. */
static void suspects(const hd_laplacian *lap, int32_t *vertex) {
    double cold[SOURCES] = {0};
    uint64_t seed = 5;
    int32_t i;
    int64_t p;
    int k;
    for (k = 0; k < SOURCES; k++) vertex[k] = lap->vertex[(int32_t)(shape_uniform(&seed) * lap->n_active)];
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int32_t j = lap->L.col[p];
            const double rate = j == i ? 0 : lap->L.val[p] / lap->mass[i];
            for (k = 0; k < SOURCES / 2 && rate > 0; k++)
                if (vertex[k] == lap->vertex[j] || rate > cold[k]) break;
            if (rate <= 0 || k == SOURCES / 2 || rate <= cold[k]) continue;
            cold[k] = rate;
            vertex[k] = lap->vertex[j];
        }
}

/* How far K_t e_i falls below zero, relative to its largest value, for several sources and times; and the
 * largest bound on the error. */
static void print_lowest(const method *m, const shape *s, const char *name, struct least page) {
    static const double in_h2[] = {0.01, 0.1, 1, 10};
    hd_laplacian *lap = laplacian(m, s, NULL);
    hd_heat *heat = NULL;
    hd_report report;
    hd_error e;
    double *u = (double *)room(s->n, sizeof *u), low = 0, bound = 0;
    int32_t vertex[SOURCES], i;
    int k, q;
    suspects(lap, vertex);
    if (hd_heat_create(&heat, lap, NULL, &e) < 0) stop(m->name, &e);
    for (q = 0; q < 4; q++)
        for (k = 0; k < SOURCES; k++) {
            double least = 0, top = 0;
            if (hd_heat_column(heat, HD_KERNEL_OPERATOR, in_h2[q] * lap->h * lap->h, vertex[k], u, &report, NULL) < 0)
                stop(m->name, &report.error);
            for (i = 0; i < s->n; i++) {
                least = fmin(least, u[i]);
                top = fmax(top, u[i]);
            }
            low = fmin(low, least / top);
            bound = fmax(bound, report.error_bound);
        }
    printf(" %lld | %.0e (%.0e) |", (long long)lap->mesh.n_negative_weights, low, bound);
    hold_least(m->name, name, lap->mesh.n_negative_weights, low, bound, page);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(u);
}

static void maximum_principle(void) {
    static const int rows[] = {ORIGINAL, NOISE_3, HOLES_2, UNEVEN, ORIGINAL, HOLES_2};
    const method *const methods[3] = {&PLAIN, &DELAUNAY, &TUFTED};
    int k, m;
    int32_t i;
    printf("\n| least value of K_t e_i, t = 0.01 to 10 h^2 (bound on its error) | voronoi-cot: weights < 0 "
           "| least | Delaunay: weights < 0 | least | tufted: "
           "weights < 0 | least |\n|---|---|---|---|---|---|---|\n");
    for (k = 0; k < 6; k++) {
        surface f = begin(&variant[rows[k]].s, "needles");
        for (i = 0; i < f.s.n && k >= 4; i++) f.s.xyz[3 * i] *= 10;
        printf("| %s%s |", variant[rows[k]].name, k >= 4 ? ", ten times as long" : "");
        for (m = 0; m < 3; m++) print_lowest(methods[m], &f.s, variant[rows[k]].name, page_least[k][m]);
        printf("\n");
        fflush(stdout);
        shape_free(&f.s);
        free(f.of);
    }
}

/* ---- the surfaces ---- */

static int less(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The vertex area in the coarsest places over that in the finest, without the outermost hundredth of the
 * vertices at either end. */
static double unevenness(const shape *s) {
    hd_laplacian *lap = laplacian(&PLAIN, s, NULL);
    const int32_t n = lap->n_active;
    double *area = (double *)room(n, sizeof *area), ratio;
    memcpy(area, lap->mass, (size_t)n * sizeof *area);
    qsort(area, (size_t)n, sizeof *area, less);
    ratio = area[n - 1 - n / 100] / area[n / 100];
    free(area);
    hd_laplacian_free(lap);
    return ratio;
}

/* The original and its variants, of the animal, or of a mesh from a file. */
static void make_variants(const char *file) {
    shape coarse = file ? load(file) : shape_demo(1500), whole;
    double h, size, lo[3], hi[3];
    int32_t i;
    int k;
    surface used = begin(&coarse, "");
    take_out(&used, NULL);
    shape_free(&coarse);
    coarse = used.s;
    whole = file ? begin(&coarse, "").s : shape_subdivide(&coarse);
    if (!coarse.xyz || !whole.xyz) stop("shape", NULL);
    for (i = 0; !file && i < whole.n; i++) shape_animal_project(whole.xyz + 3 * i, 2);
    /* where x is largest: the middle of the trunk */
    for (i = source = 0; i < coarse.n; i++)
        if (coarse.xyz[3 * i] > coarse.xyz[3 * source]) source = i;
    h = mean_edge(&whole);
    size = size_of(&whole, lo, hi);
    variant[ORIGINAL] = begin(&whole, "original");
    for (k = 0; k < 3; k++) {
        static const double part[] = {0.05, 0.2, 0.5};
        char name[64];
        snprintf(name, sizeof name, "noise of %.2g h (%.2g %% of the size)", part[k],
                 100 * part[k] * h / size);
        variant[NOISE_1 + k] = noisy(&whole, part[k] * h, name);
    }
    variant[HOLES_1] = holes(&whole, 0.05, source, "5 % cut out in holes");
    variant[HOLES_2] = holes(&whole, 0.15, source, "15 % cut out in holes");
    variant[CUT] = cut(&whole, 0.25, "an end cut off");
    variant[UNEVEN] = uneven(&coarse, 10, !file, "");
    snprintf(variant[UNEVEN].name, sizeof variant[UNEVEN].name, "areas of vertices 1 : %.0f",
             unevenness(&variant[UNEVEN].s));
    shape_free(&coarse);
    shape_free(&whole);
    free(used.of);
}

int main(int argc, char **argv) {
    const char *folder = argc > 1 && argv[1][0] ? argv[1] : NULL, *file = argc > 2 ? argv[2] : NULL;
    hd_laplacian *lap;
    int k;
    check = folder && strcmp(folder, "--check") == 0;
    if (check) folder = NULL;
    own_mesh = file != NULL;
    make_variants(file);
    lap = laplacian(&FEM, &variant[ORIGINAL].s, NULL);
    for (k = 0; k < TIMES; k++) times[k] = lap->area * 0.002 * pow(10, k);
    printf("%d vertices, area %.4g, h = %.3g. Change of the heat kernel k_t(x, %d) and of the diffusion "
           "distance at t = 0.002, 0.02 and 0.2 of the area,\n"
           "in per cent of the original's largest value: root of the mean square (largest).\n",
               (int)variant[ORIGINAL].s.n, lap->area, lap->h, (int)source);
    hd_laplacian_free(lap);
    table(&FEM, folder, page_meshes);
    table(&PLAIN, NULL, page_meshes);
    table(&DELAUNAY, NULL, page_meshes);
    if (variant[ORIGINAL].s.n <= 20000) {
        table(&POINTS, NULL, page_points);
        table(&STARS, NULL, page_stars);
    }
    maximum_principle();
    for (k = 0; k < VARIANTS; k++) {
        shape_free(&variant[k].s);
        free(variant[k].of);
    }
    if (wrong) fprintf(stderr, "rough_surfaces: %d numbers are not as tools/README.md says\n", wrong);
    return wrong > 0;
}
