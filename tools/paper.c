/* paper.c - the experiments of the paper that this library is based on, done again, as one HTML page

       paper [--quick] [--largest N] [--charts] FOLDER [MESH ...]

   Build:  cc -O3 tools/paper.c -o paper -lm

   The paper is G. Patane, M. Spagnuolo, "Heat diffusion kernel and distance on surface meshes and point
   sets", 2013. FOLDER, which must exist, receives paper.html and paper.csv, with Table 1 and Figures 1 to
   9 on shapes made in memory, and on the meshes given. --largest leaves out shapes with more vertices
   (default 60000; with 150000 there are two more). --quick takes small shapes and fewer eigenpairs, for
   tests. --charts also writes each chart as an SVG file.

   Seconds are of the processor, on one thread, from L and B to the answer; the least of three runs if they
   are short. Errors are the largest over the vertices, relative to the largest value of the column. They
   are differences from a dense eigensolution on small meshes, and elsewhere from the direct method with
   poles of degree 14, which is compared with Lanczos at the smallest tolerance. All numbers come from the
   run, but those in columns named after the paper. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "../tests/dense.h"
#include "meshio.h"
#include "page.h"
#include "picture.h"
#include "shapes.h"

#define VARIANTS_PROGRAM "paper"
#include "variants.h"
#include "paper_figures.h"

enum { MOST_SUBJECTS = 40, BATCH = 32, SEVERAL = 16 };

static const char USAGE[] = "usage: paper [--quick] [--largest N] [--charts] FOLDER [MESH ...]\n";

/* A shape, what the paper measured at this size (seconds, 0: nothing), and what this run measures. */
typedef struct subject {
    char name[96];
    shape s;
    int points, family;                 /* family: the same surface at several sizes */
    double paper_pairs, paper_rational;
    int32_t n;
    double pairs_seconds, pairs_residual, seconds[ROUTES], error[ROUTES];
    long long steps[ROUTES];
    int pairs_proven;
    /* by time: one column by default; the first column and a further one, direct; one from eigenpairs */
    double one[TIMES], first[TIMES], further[TIMES], from_pairs[TIMES], one_error[TIMES], pairs_error[TIMES];
    /* 16 times at once */
    double several_first, several_further, several_from_pairs;
} subject;

static subject subjects[MOST_SUBJECTS];
static int n_subjects;
static int32_t n_pairs;                 /* eigenpairs of Table 1 */
static double truth_gap;                /* largest difference of the two references */

/* rows and columns of a part of the sum that stays in the first cache */
enum { TILE = 128, LANES = 8 };

/* U += the sum over all pairs of weight[l][column] x_l, for some rows and LANES columns, n apart. */
static void sum_pairs(const hd_spectrum *s, const double *weight, int32_t row, int32_t rows, double *U,
                      int lanes) {
    double sum[LANES][TILE];
    int32_t l, i;
    int q;
    memset(sum, 0, sizeof sum);
    for (l = 0; l < s->count; l++) {
        const double *x = s->vector + (size_t)l * (size_t)s->n + row, *w = weight + (size_t)l * LANES;
        for (q = 0; q < LANES; q++) {
            const double f = w[q];
            double *to = sum[q];
            for (i = 0; i < rows; i++) to[i] += f * x[i];
        }
    }
    for (q = 0; q < lanes; q++)
        memcpy(U + (size_t)q * (size_t)s->n + row, sum[q], (size_t)rows * sizeof(double));
}

/* (X' B e_i)_l for all pairs, from the few rows that vertex i touches. All vertices have mass. */
static void source_weights(const hd_spectrum *s, int32_t i, double *w) {
    const hd_laplacian *lap = s->lap;
    const size_t n = (size_t)s->n;
    int64_t p;
    int32_t l;
    for (l = 0; l < s->count; l++) {
        const double *x = s->vector + (size_t)l * n;
        w[l] = 0;
        if (!lap->B) w[l] = lap->mass[i] * x[i];
        else for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) w[l] += lap->B[p] * x[lap->L.col[p]];
    }
}

/* Columns of K_t from eigenpairs, as hd_spectrum_columns orders them, LANES side by side and without bounds:
 * faster than that. */
static void pairs_columns(const hd_spectrum *s, int n_times, const double *t, int32_t k,
                          const int32_t *sources, double *U) {
    const int all = n_times * k;
    double *w = DENSE_NEW(double, s->count), *weight = DENSE_NEW(double, (int64_t)s->count * LANES);
    int32_t l, row;
    int c, q;
    for (c = 0; c < all; c += LANES) {
        const int lanes = all - c < LANES ? all - c : LANES;
        for (q = 0; q < lanes; q++) {
            if (q == 0 || (c + q) % n_times == 0) source_weights(s, sources[(c + q) / n_times], w);
            for (l = 0; l < s->count; l++)
                weight[l * LANES + q] = w[l] * exp(-t[(c + q) % n_times] * s->value[l]);
        }
        for (row = 0; row < s->n; row += TILE)
            sum_pairs(s, weight, row, s->n - row < TILE ? s->n - row : TILE, U + (size_t)c * (size_t)s->n,
                      lanes);
    }
    free(w);
    free(weight);
}

static double from_pairs_timed(const hd_spectrum *pairs, int n_times, const double *t, int32_t k,
                               const int32_t *sources, double *U) {
    double least = 1e30;
    int run;
    for (run = 0; run < 3; run++) {
        const double from = cpu();
        pairs_columns(pairs, n_times, t, k, sources, U);
        least = fmin(least, cpu() - from);
    }
    return least;
}

/* ---- the shapes ---- */

static subject *subject_add(const char *name, shape s, int points) {
    subject *q = subjects + n_subjects;
    if (!s.xyz || n_subjects == MOST_SUBJECTS) stop(name, NULL);
    n_subjects++;
    snprintf(q->name, sizeof q->name, "%s", name);
    q->s = s;
    q->points = points;
    return q;
}

static void subject_of_paper(subject *q, double pairs, double rational) {
    if (quick) return;
    q->paper_pairs = pairs;
    q->paper_rational = rational;
}

/* Seconds of the paper: for 500 eigenpairs and for one column, on a 2.7 GHz Intel i7, at these sizes. */
static void make_subjects(int32_t largest) {
    static const struct { int32_t n; double pairs, rational; } sizes[] = {
        {10000, 59.65, 0.50}, {30000, 111.28, 1.78}, {50000, 176.47, 3.21}, {100000, 372.16, 7.44}};
    const double area = 8 * 9.8696044010893586;      /* of the points' torus: 8 pi^2 */
    shape base = shape_demo(quick ? 1500 : 10000), coarse = shape_demo(quick ? 1500 : 4000);
    surface f;
    subject *q;
    size_t k;
    int32_t source = 0, i;
    q = subject_add("torus, smooth", quick ? shape_torus(24, 12, 2, 0.7) : shape_torus(63, 32, 2, 0.7), 0);
    subject_of_paper(q, 12.00, 0.01);
    for (i = 0; i < base.n; i++)
        if (base.xyz[3 * i] > base.xyz[3 * source]) source = i;
    f = noisy(&base, 0.3 * mean_edge(&base), "noise");
    free(f.of);
    subject_add("animal, noise of 0.3 h", f.s, 0);
    f = holes(&base, 0.15, source, "holes");
    free(f.of);
    subject_add("animal, 15 % cut out", f.s, 0);
    f = uneven(&coarse, 10, 1, "uneven");
    free(f.of);
    subject_add("animal, sampled unevenly", f.s, 0);
    subject_add("square, with a border", quick ? shape_grid(20, 20, 0.4) : shape_grid(141, 141, 0.4), 0);
    subject_add("points on a torus", shape_points(quick ? 500 : 20000, shape_on_torus, area, 1, 1), 1);
    for (k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        if (k > 0 && (quick || sizes[k].n > largest)) continue;
        q = subject_add("animal, irregular", quick ? shape_demo(1500) : shape_demo(sizes[k].n), 0);
        subject_of_paper(q, sizes[k].pairs, sizes[k].rational);
        q->family = 1;
    }
    if (!quick && largest >= 58140)
        subject_of_paper(subject_add("torus, smooth", shape_torus(340, 171, 2, 0.7), 0), 186.06, 7.92);
    if (!quick && largest >= 150000)
        subject_add("points on a torus", shape_points(150000, shape_on_torus, area, 1, 1), 1);
    shape_free(&base);
    shape_free(&coarse);
}

/* ---- Table 1 ---- */

static void measure_times(subject *q, const hd_laplacian *lap, const hd_spectrum *pairs, double *U) {
    int32_t source[BATCH];
    double *truth = DENSE_NEW(double, lap->n);
    int m;
    some_vertices(lap->n, BATCH, source);
    for (m = 0; m < TIMES; m++) {
        const double t = IN_H2[m] * lap->h * lap->h;
        double all;
        truth_column(lap, t, source[0], truth, &truth_gap);
        q->one[m] = columns_timed(lap, route(DEFAULT), 1, &t, 1, source, U, NULL);
        q->one_error[m] = off(U, truth, lap->n);
        q->first[m] = columns_timed(lap, route(DIRECT), 1, &t, 1, source, U, NULL);
        all = columns_timed(lap, route(DIRECT), 1, &t, BATCH, source, U, NULL);
        q->further[m] = fmax(0, all - q->first[m]) / (BATCH - 1);
        q->from_pairs[m] = from_pairs_timed(pairs, 1, &t, BATCH, source, U) / BATCH;
        q->pairs_error[m] = off(U, truth, lap->n);
    }
    free(truth);
}

/* One source at 16 times over four decades, and further sources. */
static void measure_several(subject *q, const hd_laplacian *lap, const hd_spectrum *pairs, double *U) {
    enum { MORE = 4 };
    int32_t source[MORE + 1];
    double t[SEVERAL], all;
    int m;
    some_vertices(lap->n, MORE + 1, source);
    for (m = 0; m < SEVERAL; m++) t[m] = lap->h * lap->h * pow(10, 4.0 * m / (SEVERAL - 1));
    q->several_first = columns(lap, route(DEFAULT), SEVERAL, t, 1, source, U, NULL);
    all = columns(lap, route(DEFAULT), SEVERAL, t, MORE + 1, source, U, NULL);
    q->several_further = fmax(0, all - q->several_first) / MORE;
    q->several_from_pairs = from_pairs_timed(pairs, SEVERAL, t, MORE, source, U) / MORE;
}

/* The sum above against the library's. */
static void check_pairs(const hd_spectrum *pairs, double t, int32_t source, double *U, double *V) {
    hd_error e;
    pairs_columns(pairs, 1, &t, 1, &source, U);
    if (hd_spectrum_columns(pairs, HD_KERNEL_OPERATOR, 1, &t, VERTICES(1, &source), V, NULL, 0, &e) < 0)
        stop("columns from eigenpairs", &e);
    if (!(off(U, V, pairs->n) < 1e-10)) stop("two sums over eigenpairs differ", NULL);
}

static void measure(subject *q) {
    hd_laplacian *lap = laplacian(q->points ? &STARS : &FEM, &q->s, &serial);
    double *truth = DENSE_NEW(double, lap->n), *U = DENSE_NEW(double, (int64_t)lap->n * 5 * SEVERAL);
    const double t = IN_H2[MIDDLE] * lap->h * lap->h;
    hd_spectrum *pairs;
    int32_t source;
    int k;
    if (lap->n_active != lap->n) stop(q->name, NULL);   /* vertices without mass: sums here know none */
    q->n = lap->n;
    some_vertices(lap->n, 1, &source);
    truth_column(lap, t, source, truth, &truth_gap);
    for (k = 0; k < ROUTES; k++) {
        hd_report report;
        q->seconds[k] = columns_timed(lap, route((route_kind)k), 1, &t, 1, &source, U, &report);
        q->error[k] = off(U, truth, lap->n);
        q->steps[k] = report.iterations;
    }
    pairs = eigenpairs(lap, n_pairs, &q->pairs_seconds);
    q->pairs_residual = pairs->largest_residual;
    q->pairs_proven = pairs->proven;
    check_pairs(pairs, t, source, U, truth);
    measure_times(q, lap, pairs, U);
    measure_several(q, lap, pairs, U);
    hd_spectrum_free(pairs);
    hd_laplacian_free(lap);
    free(truth);
    free(U);
    fprintf(stderr, "paper: %s, %d vertices: %.1f s for %d eigenpairs, %.3f s for a column\n", q->name,
            (int)q->n, q->pairs_seconds, (int)n_pairs, q->seconds[DEFAULT]);
}

/* The shape of Table 1 that is looked at closely: the largest of the family. */
static const subject *looked_at(void) {
    const subject *best = NULL;
    int k;
    for (k = 0; k < n_subjects; k++)
        if (subjects[k].family && subjects[k].n <= 60000 && (!best || subjects[k].n > best->n))
            best = subjects + k;
    return best;
}

static int by_size(const void *a, const void *b) {
    const subject *x = (const subject *)a, *y = (const subject *)b;
    return (x->n > y->n) - (x->n < y->n);
}

enum { ERROR_TEXT = 24 };

/* 2e-8, and not 2e-08, with a hyphen at which no line ends. */
static const char *as_error(double v, char text_of[ERROR_TEXT]) {
    const int power = v > 0 ? (int)floor(log10(v)) : 0;
    const double digit = v / pow(10, power);
    if (digit < 9.5)
        snprintf(text_of, ERROR_TEXT, "%.0fe%s%d", digit, power < 0 ? "&#8209;" : "", abs(power));
    else snprintf(text_of, ERROR_TEXT, "1e%s%d", power + 1 < 0 ? "&#8209;" : "", abs(power + 1));
    return text_of;
}

static void page_error(page *p, const char *of, double v) {
    char number[ERROR_TEXT];
    page_number(p, p->table, of, p->columns[p->column], "row", (double)p->row + 1, "value", v);
    page_cell(p, "", as_error(v, number));
}

static void paper_cells(page *p, const subject *q) {
    const double v[3] = {q->paper_pairs, q->paper_rational, q->paper_pairs / q->paper_rational};
    static const char *const format[3] = {"%.2f", "%.2f", "%.0f"};
    int m;
    for (m = 0; m < 3; m++)
        if (q->paper_pairs > 0) page_value(p, "p", q->name, v[m], format[m]);
        else page_cell(p, "p none", "&#8211;");
}

static void seconds_table(page *p) {
    static char pairs[40];
    const char *names[] = {"shape", "vertices", pairs, "COCG, ms", "COCG + ILDL, ms", "direct, ms",
        "krylov, ms", "default, ms", "pairs / COCG", "pairs / default", "paper: 500 pairs, s",
        "paper: column, s", "paper: ratio"};
    int k, m;
    snprintf(pairs, sizeof pairs, "%d eigenpairs, s", (int)n_pairs);
    page_table_begin(p, "table-1", "One column at t = 100 h&#178;, on one thread, seconds of the processor. "
                     "COCG: the paper's way, poles of degree 7, no factorisation; + ILDL: with the "
                     "preconditioner modified ILDL(0). The paper's own shapes: Neptune, where ours is the "
                     "animal, and a torus.", 13, names);
    for (k = 0; k < n_subjects; k++) {
        const subject *q = subjects + k;
        page_cell(p, "", q->name);
        page_value(p, "", q->name, q->n, "%.0f");
        page_value(p, "", q->name, q->pairs_seconds, q->pairs_seconds < 10 ? "%.2f" : "%.1f");
        for (m = 0; m < ROUTES; m++)
            page_value(p, "", q->name, 1e3 * q->seconds[m], q->seconds[m] < 0.01 ? "%.1f" : "%.0f");
        page_value(p, "", q->name, q->pairs_seconds / q->seconds[PLAIN_COCG], "%.0f");
        page_value(p, "", q->name, q->pairs_seconds / q->seconds[DEFAULT], "%.0f");
        paper_cells(p, q);
    }
    page_table_end(p);
}

static void errors_table(page *p) {
    static const char *const names[] = {"shape", "vertices", "from eigenpairs", "COCG", "COCG + ILDL",
                                        "direct", "krylov", "default", "steps of COCG", "steps with ILDL"};
    int k, m;
    page_table_begin(p, "table-errors", "What these seconds bought: largest error of the same columns, "
                     "relative to the column's largest value, and the steps of all systems.", 10, names);
    for (k = 0; k < n_subjects; k++) {
        const subject *q = subjects + k;
        page_cell(p, "", q->name);
        page_value(p, "", q->name, q->n, "%.0f");
        page_error(p, q->name, q->pairs_error[MIDDLE]);
        for (m = 0; m < ROUTES; m++) page_error(p, q->name, q->error[m]);
        page_value(p, "", q->name, (double)q->steps[PLAIN_COCG], "%.0f");
        page_value(p, "", q->name, (double)q->steps[MILDL_COCG], "%.0f");
    }
    page_table_end(p);
}

/* The number of sources from which on eigenpairs cost less in all; 0: never, or only beyond all vertices. */
static double pay_back(const subject *q, double from_pairs, double first, double further) {
    const double count = fmax(1, ceil((q->pairs_seconds - first) / (further - from_pairs)));
    return further > from_pairs && count <= q->n ? count : 0;
}

/* In brackets: where the eigenpairs are off by more than this. */
static const double POOR = 1e-3;

static void pay_back_cell(page *p, const subject *q, double count, int poor) {
    if (count > 0) page_value(p, "", q->name, count, poor ? "(%.0f)" : "%.0f");
    else page_cell(p, "", "never");
}

static void pay_back_table(page *p) {
    static const char *const names[] = {"shape", "vertices", "t = h&#178;", "10 h&#178;", "100 h&#178;",
                                        "1000 h&#178;", "10&#8308; h&#178;", "16 times at once"};
    int k, m;
    page_table_begin(p, "table-pay-back", "Number of sources from which on the eigenbasis costs less in all "
                     "than the direct method at this one time, or than the default at 16 times from h&#178; "
                     "to 10&#8308; h&#178;. Never: not even with all vertices as sources. In brackets: "
                     "columns from the eigenpairs are off by more than a thousandth, so that it does not pay "
                     "at any number; 16 times: at the smallest of them.", 8, names);
    for (k = 0; k < n_subjects; k++) {
        const subject *q = subjects + k;
        page_cell(p, "", q->name);
        page_value(p, "", q->name, q->n, "%.0f");
        for (m = 0; m < TIMES; m++)
            pay_back_cell(p, q, pay_back(q, q->from_pairs[m], q->first[m], q->further[m]),
                          q->pairs_error[m] > POOR);
        pay_back_cell(p, q, pay_back(q, q->several_from_pairs, q->several_first, q->several_further),
                      q->pairs_error[0] > POOR);
    }
    page_table_end(p);
}

static void close_table(page *p, const subject *q) {
    static const char *const names[] = {"t", "one column by default, ms", "error",
        "error from eigenpairs", "eigenpairs / column", "further column, direct, ms",
        "further column, eigenpairs, ms"};
    char caption[300], t[40];
    int m;
    snprintf(caption, sizeof caption, "%s, %d vertices: one column against %d eigenpairs, which took %.3g s. "
             "Sums over them run at %.1f GF/s.", q->name, (int)q->n, (int)n_pairs, q->pairs_seconds,
             2e-9 * q->n * n_pairs / q->from_pairs[MIDDLE]);
    page_table_begin(p, "table-times", caption, 7, names);
    for (m = 0; m < TIMES; m++) {
        if (IN_H2[m] == 1e4) snprintf(t, sizeof t, "10&#8308; h&#178;");
        else snprintf(t, sizeof t, "%g h&#178;", IN_H2[m]);
        page_cell(p, "", t);
        page_value(p, "", t, 1e3 * q->one[m], "%.0f");
        page_error(p, t, q->one_error[m]);
        page_error(p, t, q->pairs_error[m]);
        page_value(p, "", t, q->pairs_seconds / q->one[m], "%.0f");
        page_value(p, "", t, 1e3 * q->further[m], "%.2g");
        page_value(p, "", t, 1e3 * q->from_pairs[m], "%.2g");
    }
    page_table_end(p);
}

static chart_curve *seconds_curve(chart *c, const char *name, int colour, int marker, int dashed) {
    chart_curve *q = chart_add(c, name);
    q->colour = colour;
    q->marker = marker;
    q->dashed = dashed;
    return q;
}

/* Figure 9: a line through the sizes of one surface, points alone for the other shapes. */
static void seconds_chart(page *p) {
    chart c;
    chart_curve *q[5], *other[3];
    int k, m;
    char name[CHART_NAME];
    chart_begin(&c, "fig-9", "Seconds over the number of vertices", "vertices", "seconds");
    snprintf(name, sizeof name, "%d eigenpairs", (int)n_pairs);
    q[0] = seconds_curve(&c, name, 1, 1, 0);
    q[1] = seconds_curve(&c, "column: COCG", 4, 2, 0);
    q[2] = seconds_curve(&c, "column: default", 0, 0, 0);
    for (m = 0; m < 3; m++) {
        other[m] = seconds_curve(&c, q[m]->name, q[m]->colour, q[m]->marker, 0);
        other[m]->no_line = other[m]->unnamed = 1;
    }
    if (!quick) {
        q[3] = seconds_curve(&c, "paper, 2013: 500 eigenpairs", 7, 1, 1);
        q[4] = seconds_curve(&c, "paper, 2013: column", 7, 0, 1);
    }
    for (k = 0; k < n_subjects; k++) {
        const subject *s = subjects + k;
        chart_curve **to = s->family ? q : other;
        chart_point(to[0], s->n, s->pairs_seconds);
        chart_point(to[1], s->n, s->seconds[PLAIN_COCG]);
        chart_point(to[2], s->n, s->seconds[DEFAULT]);
        if (s->paper_pairs <= 0) continue;
        chart_point(q[3], s->n, s->paper_pairs);
        chart_point(q[4], s->n, s->paper_rational);
    }
    page_chart(p, &c, "Figure 9, as measured here at t = 100 h&#178;, and as the paper printed it (2.7 GHz "
               "Intel i7; Neptune and a torus). Lines join the sizes of one surface; other shapes are "
               "points.");
}

/* ---- the page ---- */

static void summary(page *p) {
    const subject *q = looked_at();
    char of_pairs[TIMES][ERROR_TEXT], of_one[TIMES][ERROR_TEXT];
    double least = 1e300;
    int m, worse = 0;
    for (m = 0; m <= MIDDLE; m++) {
        least = fmin(least, q->pairs_seconds / q->one[m]);
        worse += !(q->one_error[m] < q->pairs_error[m]);
    }
    page_add(p, "<p>G. Patan&#232;, M. Spagnuolo, <em>Heat diffusion kernel and distance on surface meshes "
             "and point sets</em>, 2013, replaces the eigenvectors of the Laplacian by a few sparse linear "
             "systems. Here are its Table 1 and Figures 1 to 9, computed again by <code>heatdiff.h</code> on "
             "shapes made in memory. All numbers come from this run, but those in columns named after the "
             "paper.</p>\n");
    page_add(p, "<ul>\n<li><strong>Speed.</strong> On %d vertices %d eigenpairs took %.3g s, and one column "
             "by default %.0f, %.0f and %.0f ms at t = 1, 10 and 100 h&#178;: the eigenpairs %.0f times as "
             "long or more, and %.0f times as long as the paper's own way (COCG, degree 7, no "
             "preconditioner). The eigensolver is this library's; the paper's ratios of 20 to 1200 are to a "
             "slower one.</li>\n", (int)q->n, (int)n_pairs, q->pairs_seconds,
             1e3 * q->one[0], 1e3 * q->one[1], 1e3 * q->one[2], least,
             q->pairs_seconds / q->seconds[PLAIN_COCG]);
    for (m = 0; m < TIMES; m++) {
        as_error(q->pairs_error[m], of_pairs[m]);
        as_error(q->one_error[m], of_one[m]);
    }
    page_add(p, "<li><strong>Error.</strong> At t = 1, 10 and 100 h&#178; columns from the eigenpairs are "
             "off by %s, %s and %s of the largest value, those by default by %s, %s and %s%s. At 1000 and "
             "10&#8308; h&#178; the eigenpairs are off by %s and %s, the default by %s and %s: for large "
             "times few eigenpairs are enough.</li>\n",
             of_pairs[0], of_pairs[1], of_pairs[2], of_one[0], of_one[1], of_one[2],
             worse ? "" : ", less at each of these times", of_pairs[3], of_pairs[4], of_one[3], of_one[4]);
    page_add(p, "<li><strong>Degree 7.</strong> The error of the paper's set is absolute. Relative to a "
             "column, which spreads and falls as t grows, it rises (Figure 5). The same systems with poles "
             "made for the kernel do not have this weakness.</li>\n</ul>\n");
}

/* Adds a mesh or points from a file to Table 1. Vertices in no face are left out. */
static shape subject_of_file(const char *path) {
    const char *base = strrchr(path, '/');
    shape s = load(path);
    surface used = begin(&s, "");
    if (used.s.n_tri) take_out(&used, NULL);
    shape_free(&s);
    free(used.of);
    subject_add(base ? base + 1 : path, used.s, used.s.n_tri == 0);
    return used.s;
}

static void how_measured(page *p) {
    double residual = 0;
    int k, proven = 0;
    char gap[ERROR_TEXT], most[ERROR_TEXT];
    for (k = 0; k < n_subjects; k++) {
        residual = fmax(residual, subjects[k].pairs_residual);
        proven += subjects[k].pairs_proven != 0;
    }
    page_add(p, "<h2>How it was measured</h2>\n<p>Seconds of the processor, one thread, least of three runs "
             "if they are short, from L and B to the answer. Errors: largest difference over the vertices, "
             "relative to the largest value of the column. On larger shapes they are taken from the direct "
             "method with kernel poles of degree 14; Lanczos at tolerance 1e-12 differed from it by %s at "
             "most. Residuals of the eigenpairs are below %s (1e-8 was asked for), and on %d of %d shapes "
             "the count of negative pivots proves that none is missing. All of it took %.0f s of the "
             "processor.</p>\n", as_error(truth_gap, gap), as_error(residual, most), proven, n_subjects,
             cpu());
    page_add(p, "<p>The text of the paper was not at hand. Its numbers are those of its Table 1 as noted "
             "when this library was begun. Which of its shapes stands in which figure of level sets was not "
             "noted.</p>\n");
}

int main(int argc, char **argv) {
    const char *folder = NULL;
    int32_t largest = 60000;
    int k, charts = 0, first = 0;
    shape meshes[MOST_SUBJECTS];
    page p;
    for (k = 1; k < argc && !first; k++) {
        if (!strcmp(argv[k], "--quick")) quick = 1;
        else if (!strcmp(argv[k], "--charts")) charts = 1;
        else if (!strcmp(argv[k], "--largest") && k + 1 < argc) largest = (int32_t)atol(argv[++k]);
        else if (argv[k][0] == '-') break;
        else first = k;
    }
    if (!first || argc - first > MOST_SUBJECTS / 2) return fputs(USAGE, stderr), 2;
    folder = argv[first++];
    serial.n_threads = 1;
    n_pairs = quick ? 60 : 500;
    make_subjects(largest);
    for (k = first; k < argc; k++) meshes[k - first] = subject_of_file(argv[k]);
    for (k = 0; k < n_subjects; k++) measure(subjects + k);
    qsort(subjects, (size_t)n_subjects, sizeof *subjects, by_size);
    page_open(&p, "Heat kernels without eigenvectors: the paper's experiments, done again");
    summary(&p);
    page_add(&p, "<h2>Table 1: seconds</h2>\n");
    seconds_table(&p);
    errors_table(&p);
    page_add(&p, "<h2>When the eigenbasis pays</h2>\n<p>The paper compares one column with a basis that "
             "serves any number of columns and times. So the fair question is how many sources it "
             "takes.</p>\n");
    pay_back_table(&p);
    close_table(&p, looked_at());
    own_level_sets(&p);
    error_figures(&p);
    condition_figures(&p);
    page_add(&p, "<h2 id=\"fig-9\">Figure 9: seconds over size</h2>\n<div class=\"charts\">\n");
    seconds_chart(&p);
    page_add(&p, "</div>\n");
    for (k = first; k < argc; k++) mesh_figures(&p, meshes + (k - first), argv[k], k - first);
    how_measured(&p);
    page_write(&p, folder, "paper", charts);
    for (k = 0; k < n_subjects; k++) shape_free(&subjects[k].s);
    return 0;
}
