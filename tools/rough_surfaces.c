/* rough_surfaces.c - how much heat changes on a noisy, incomplete or unevenly sampled surface

   Build and run from the project's folder:

       cc -O2 tools/rough_surfaces.c -o rough_surfaces -lm && ./rough_surfaces
       ./rough_surfaces FOLDER           also writes pictures and meshes to FOLDER, which must exist
       ./rough_surfaces FOLDER MESH      the same for a mesh of your own

   Variants of one surface are made in memory: noise along the normals, holes, an end cut off, and triangles
   that are a hundred times finer in some places than in others. On each variant the heat kernel k_t(x,
   source) and the diffusion distance to the source are computed at three times, by operators on meshes and on
   points. They are compared with the answer of the same operator on the original, at the vertices that both
   have.

   The tables, in Markdown, show the changes in percent of the original's largest value: root mean square and
   largest. The last table is about the maximum principle: how far heat falls below zero on bad triangles. The
   pictures show the original beside its variants in the same colours; the meshes carry both fields. */

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

/* ---- heat ---- */

/* With unit > 0, times and values are scaled as if the surface had this area. 0: no scaling. */
static answer solve(const method *m, const surface *f, double unit) {
    answer a;
    hd_laplacian *lap = laplacian(m, &f->s, NULL);
    hd_heat *heat = NULL;
    hd_report report;
    hd_error e;
    const double scale = unit > 0 ? lap->area / unit : 1;
    double t[TIMES];
    int32_t here = 0, i;
    while (here < f->s.n && f->of[here] != source) here++;
    if (here == f->s.n) stop("the source is gone", NULL);
    for (i = 0; i < TIMES; i++) t[i] = scale * times[i];
    a.n = f->s.n;
    a.value = (double *)room(FIELDS * (int64_t)a.n, sizeof *a.value);
    if (hd_heat_create(&heat, lap, NULL, &e) < 0) stop(m->name, &e);
    if (hd_heat_columns(heat, HD_KERNEL_SYMMETRIC, TIMES, t, 1, &here, a.value, 0, &report, NULL) < 0)
        stop(m->name, &report.error);
    if (hd_heat_distance(heat, HD_DISTANCE_CLASSICAL, TIMES, t, 1, &here, a.value + TIMES * (size_t)a.n, 0, &report, NULL) < 0)
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
static void print_change(const surface *f, const answer *a, const answer *original) {
    int32_t i, n;
    int q;
    for (q = 0; q < FIELDS; q++) {
        const double *u = a->value + (size_t)q * (size_t)a->n,
            *u0 = original->value + (size_t)q * (size_t)original->n;
        double top = 0, sum = 0, worst = 0;
        for (i = 0; i < original->n; i++) top = fmax(top, fabs(u0[i]));
        for (i = n = 0; i < a->n; i++) {
            const double off = f->of[i] < 0 ? 0 : 100 * fabs(u[i] - u0[f->of[i]]) / top;
            n += f->of[i] >= 0;
            worst = fmax(worst, off);
            sum += off * off;
        }
        printf(" %.1f (%.3g) |", sqrt(sum / n), worst < 99.5 ? floor(10 * worst + 0.5) / 10 : worst);
    }
    printf("\n");
    fflush(stdout);
}

static void table(const method *m, const char *folder) {
    answer a[VARIANTS], scaled;
    hd_laplacian *lap = laplacian(m, &variant[ORIGINAL].s, NULL);
    int v;
    printf("\n| %s | k_t, t = %.4g | t = %.4g | t = %.4g | d_t, t = %.4g | t = %.4g | t = %.4g |\n"
           "|---|---|---|---|---|---|---|\n", m->name, times[0], times[1],
           times[2], times[0], times[1], times[2]);
    for (v = 0; v < VARIANTS; v++) {
        a[v] = solve(m, variant + v, 0);
        if (v == ORIGINAL) continue;
        printf("| %s |", variant[v].name);
        print_change(variant + v, a + v, a);
        if (v != NOISE_3) continue;
        scaled = solve(m, variant + v, lap->area);
        printf("| the same, scaled to the original's area |");
        print_change(variant + v, &scaled, a);
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
static void print_lowest(const method *m, const shape *s) {
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
        for (m = 0; m < 3; m++) print_lowest(methods[m], &f.s);
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
    make_variants(file);
    lap = laplacian(&FEM, &variant[ORIGINAL].s, NULL);
    for (k = 0; k < TIMES; k++) times[k] = lap->area * 0.002 * pow(10, k);
    printf("%d vertices, area %.4g, h = %.3g. Change of the heat kernel k_t(x, %d) and of the diffusion "
           "distance at t = 0.002, 0.02 and 0.2 of the area,\n"
           "in per cent of the original's largest value: root of the mean square (largest).\n",
               (int)variant[ORIGINAL].s.n, lap->area, lap->h, (int)source);
    hd_laplacian_free(lap);
    table(&FEM, folder);
    table(&PLAIN, NULL);
    table(&DELAUNAY, NULL);
    if (variant[ORIGINAL].s.n <= 20000) {
        table(&POINTS, NULL);
        table(&STARS, NULL);
    }
    maximum_principle();
    for (k = 0; k < VARIANTS; k++) {
        shape_free(&variant[k].s);
        free(variant[k].of);
    }
    return 0;
}
