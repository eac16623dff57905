/* paper_figures.h - Figures 1 to 8 of the paper, for paper.c, which see

   Figures 5 and 6: errors of columns, over t and over the number of eigenpairs. Figure 7: condition
   numbers of t L + theta B. Figures 1 to 4 and 8: level sets. Include what paper.c includes before. */

#ifndef PAPER_FIGURES_H
#define PAPER_FIGURES_H

#include <time.h>

enum { TIMES = 5, SOURCES = 4 };

static const double IN_H2[TIMES] = {1, 10, 100, 1000, 10000};
enum { MIDDLE = 2 };                    /* of them: the time of Table 1 */

/* Ways to a column of the kernel. */
typedef enum route_kind { PLAIN_COCG, MILDL_COCG, DIRECT, KRYLOV, DEFAULT, ROUTES } route_kind;

static int quick;
static hd_context serial;               /* one thread */

static double cpu(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* ---- columns and eigenpairs ---- */

static hd_heat_opts route(route_kind kind) {
    hd_heat_opts o;
    memset(&o, 0, sizeof o);
    if (kind == PLAIN_COCG || kind == MILDL_COCG) {   /* the paper's set; tol as small as its error */
        o.method = HD_METHOD_ITERATIVE;
        o.solver = HD_SOLVER_COCG;
        o.precond = kind == PLAIN_COCG ? HD_PRECOND_NONE : HD_PRECOND_MILDL;
        o.poles = HD_POLES_UNIFORM;
        o.degree = 7;
        o.tol = 1e-7;
    }
    if (kind == DIRECT) o.method = HD_METHOD_DIRECT;
    if (kind == KRYLOV) o.method = HD_METHOD_KRYLOV;
    return o;
}

static hd_heat_opts poles(hd_pole_kind kind, int32_t degree) {
    hd_heat_opts o;
    memset(&o, 0, sizeof o);
    o.method = HD_METHOD_DIRECT;
    o.poles = kind;
    o.degree = degree;
    return o;
}

/* Columns of K_t by a new plan. Returns the seconds of the processor. */
static double columns(const hd_laplacian *lap, hd_heat_opts o, int n_times, const double *t, int32_t k,
                      const int32_t *sources, double *U, hd_report *report) {
    hd_heat *heat = NULL;
    hd_error e;
    double from = cpu();
    if (hd_heat_create(&heat, lap, &o, &e) < 0) stop("heat", &e);
    if (hd_heat_columns(heat, HD_KERNEL_OPERATOR, n_times, t, VERTICES(k, sources), U, 0, report, &e) < 0)
        stop("columns", &e);
    from = cpu() - from;
    hd_heat_free(heat);
    return from;
}

/* The least of three times, of one if it is long. */
static double columns_timed(const hd_laplacian *lap, hd_heat_opts o, int n_times, const double *t, int32_t k,
                            const int32_t *sources, double *U, hd_report *report) {
    double least = columns(lap, o, n_times, t, k, sources, U, report);
    int run;
    for (run = 1; run < 3 && least < 2; run++)
        least = fmin(least, columns(lap, o, n_times, t, k, sources, U, report));
    return least;
}

static double off(const double *u, const double *truth, int32_t n) {
    return dense_max_diff(u, truth, n) / dense_max_abs(truth, n);
}

/* One column to compare with; gap: how far another method is from it. */
static void truth_column(const hd_laplacian *lap, double t, int32_t source, double *u, double *gap) {
    double *other = DENSE_NEW(double, lap->n);
    hd_heat_opts o = route(KRYLOV);
    o.tol = 1e-12;
    columns(lap, poles(HD_POLES_KERNEL, 14), 1, &t, 1, &source, u, NULL);
    columns(lap, o, 1, &t, 1, &source, other, NULL);
    *gap = fmax(*gap, off(other, u, lap->n));
    free(other);
}

static void some_vertices(int32_t n, int32_t k, int32_t *vertex) {
    uint64_t seed = 7;
    int32_t i;
    for (i = 0; i < k; i++) vertex[i] = (int32_t)(shape_uniform(&seed) * n);
}

static hd_spectrum *eigenpairs(const hd_laplacian *lap, int32_t count, double *seconds) {
    hd_spectrum *s = NULL;
    hd_spectrum_opts o;
    hd_error e;
    double from = cpu();
    memset(&o, 0, sizeof o);
    o.count = count < lap->n_active ? count : lap->n_active;
    o.tol = 1e-8;                       /* enough for the errors compared here */
    if (hd_spectrum_create(&s, lap, &o, &e) < 0) stop("eigenpairs", &e);
    if (seconds) *seconds = cpu() - from;
    return s;
}

/* ---- Figures 5 and 6: errors ---- */

enum { KINDS = 5, CUTS = 10 };

static const struct { const char *name; hd_pole_kind kind; int32_t degree; } SETS[KINDS] = {
    {"uniform, degree 5", HD_POLES_UNIFORM, 5}, {"uniform, degree 7", HD_POLES_UNIFORM, 7},
    {"kernel, degree 5", HD_POLES_KERNEL, 5}, {"kernel, degree 7", HD_POLES_KERNEL, 7},
    {"kernel, degree 9", HD_POLES_KERNEL, 9}};

static const int32_t CUT_AT[CUTS] = {10, 20, 50, 100, 200, 300, 400, 500, 700, 1000};

/* What errors are taken from: some sources, the true columns at a time. */
typedef struct study {
    const hd_laplacian *lap;
    hd_spectrum *pairs;
    dense_pair dense;                   /* n = 0: none */
    int32_t source[SOURCES];
    double *truth, *U;                  /* [SOURCES n] */
    double gap;
} study;

/* y = B e_i, for a surface whose vertices all have mass. */
static void mass_column(const hd_laplacian *lap, int32_t i, double *y) {
    double *e = DENSE_NEW(double, lap->n);
    e[i] = 1;
    hd_laplacian_apply(lap, 0, 1, e, y, NULL);
    free(e);
}

static void dense_of(const hd_laplacian *lap, dense_pair *p) {
    const int32_t n = lap->n;
    double *L = DENSE_NEW(double, (int64_t)n * n), *B = DENSE_NEW(double, (int64_t)n * n), *e
        = DENSE_NEW(double, n);
    int32_t i;
    for (i = 0; i < n; i++) {
        memset(e, 0, (size_t)n * sizeof *e);
        e[i] = 1;
        hd_laplacian_apply(lap, 1, 0, e, L + (size_t)i * (size_t)n, NULL);
        hd_laplacian_apply(lap, 0, 1, e, B + (size_t)i * (size_t)n, NULL);
    }
    free(e);
    if (!dense_pair_solve(p, L, B, n)) stop("dense eigensolution", NULL);
}

static void study_begin(study *s, const hd_laplacian *lap, int32_t count, int with_dense) {
    memset(s, 0, sizeof *s);
    s->lap = lap;
    s->pairs = eigenpairs(lap, count, NULL);
    if (with_dense) dense_of(lap, &s->dense);
    some_vertices(lap->n, SOURCES, s->source);
    s->truth = DENSE_NEW(double, SOURCES * (int64_t)lap->n);
    s->U = DENSE_NEW(double, SOURCES * (int64_t)lap->n);
}

static void study_end(study *s) {
    hd_spectrum_free(s->pairs);
    if (s->dense.n) dense_pair_free(&s->dense);
    free(s->truth);
    free(s->U);
}

static void study_truth(study *s, double t) {
    const size_t n = (size_t)s->lap->n;
    int k;
    for (k = 0; k < SOURCES; k++)
        if (s->dense.n) {
            mass_column(s->lap, s->source[k], s->U);
            dense_pair_heat(&s->dense, t, s->U, s->truth + (size_t)k * n);
        }
        else truth_column(s->lap, t, s->source[k], s->truth + (size_t)k * n, &s->gap);
}

/* The largest error of the sources' columns in U. */
static double study_error(const study *s) {
    const int32_t n = s->lap->n;
    double worst = 0;
    int k;
    for (k = 0; k < SOURCES; k++)
        worst = fmax(worst, off(s->U + (size_t)k * (size_t)n, s->truth + (size_t)k * (size_t)n, n));
    return worst;
}

static double study_route(study *s, hd_heat_opts o, double t) {
    columns(s->lap, o, 1, &t, SOURCES, s->source, s->U, NULL);
    return study_error(s);
}

/* Errors of the first CUT_AT[..] eigenpairs: error[c], 0 beyond what there is. */
static void study_cuts(study *s, double t, double *error) {
    const int32_t n = s->lap->n;
    double *y = DENSE_NEW(double, n * (int64_t)SOURCES);
    int32_t l = 0, i;
    int c, k;
    for (k = 0; k < SOURCES; k++) mass_column(s->lap, s->source[k], y + (size_t)k * (size_t)n);
    memset(s->U, 0, SOURCES * (size_t)n * sizeof *s->U);
    for (c = 0; c < CUTS; c++) {
        for (; l < CUT_AT[c] && l < s->pairs->count; l++)
            for (k = 0; k < SOURCES; k++) {
                const double *x = s->pairs->vector + (size_t)l * (size_t)n;
                const double f = exp(-t * s->pairs->value[l]) * dense_dot(x, y + (size_t)k * (size_t)n, n);
                double *u = s->U + (size_t)k * (size_t)n;
                for (i = 0; i < n; i++) u[i] += f * x[i];
            }
        error[c] = CUT_AT[c] <= s->pairs->count ? study_error(s) : 0;
    }
    free(y);
}

/* Figure 5: errors over t. */
static void errors_over_time(page *p, study *s, const char *title, const char *caption) {
    static const int cut_of[2] = {3, 7};
    chart c;
    chart_curve *set[KINDS], *lazy, *cut[2];
    const double h2 = s->lap->h * s->lap->h, step = quick ? 1 : 0.5;
    double error[CUTS], e;
    char name[CHART_NAME];
    int k;
    chart_begin(&c, "fig-5", title, "t / h&#178;", "largest error / largest value");
    c.lowest = 1e-15;
    for (k = 0; k < KINDS; k++) {
        set[k] = chart_add(&c, SETS[k].name);
        set[k]->colour = k < 2 ? 2 * k : k == 2 ? 1 : k == 3 ? 3 : 5;
    }
    lazy = chart_add(&c, "default");
    lazy->colour = 0;
    for (k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "%d eigenpairs", (int)CUT_AT[cut_of[k]]);
        cut[k] = chart_add(&c, name);
        cut[k]->colour = 7;
        cut[k]->marker = k ? 3 : 4;
        cut[k]->dashed = 1;
    }
    for (e = -0.5; e < 4.01; e += step) {
        const double in_h2 = pow(10, e), t = in_h2 * h2;
        study_truth(s, t);
        for (k = 0; k < KINDS; k++)
            chart_point(set[k], in_h2, study_route(s, poles(SETS[k].kind, SETS[k].degree), t));
        chart_point(lazy, in_h2, study_route(s, route(DEFAULT), t));
        study_cuts(s, t, error);
        for (k = 0; k < 2; k++)
            if (error[cut_of[k]] > 0) chart_point(cut[k], in_h2, error[cut_of[k]]);
    }
    page_chart(p, &c, caption);
}

/* Figure 6: errors over the number of eigenpairs, and of poles, which do not depend on it. */
static void errors_over_pairs(page *p, study *s, const char *title, const char *caption) {
    chart c;
    const double h2 = s->lap->h * s->lap->h;
    double error[CUTS];
    char name[CHART_NAME];
    int m, k;
    chart_begin(&c, "fig-6", title, "eigenpairs", "largest error / largest value");
    c.lowest = 1e-15;
    for (m = 0; m < 4; m++) {
        static const int colour[4] = {0, 1, 2, 3};
        chart_curve *q, *flat;
        snprintf(name, sizeof name, "t = %g h&#178;", IN_H2[m]);
        q = chart_add(&c, name);
        q->colour = q->marker = colour[m];
        study_truth(s, IN_H2[m] * h2);
        study_cuts(s, IN_H2[m] * h2, error);
        for (k = 0; k < CUTS; k++)
            if (error[k] > 0) chart_point(q, CUT_AT[k], error[k]);
        snprintf(name, sizeof name, "default, t = %g h&#178;", IN_H2[m]);
        flat = chart_add(&c, name);
        flat->colour = colour[m];
        flat->marker = -1;
        flat->dashed = flat->unnamed = 1;
        error[0] = study_route(s, route(DEFAULT), IN_H2[m] * h2);
        chart_point(flat, CUT_AT[0], error[0]);
        chart_point(flat, q->n ? q->x[q->n - 1] : CUT_AT[1], error[0]);
    }
    page_chart(p, &c, caption);
}

/* ---- Figure 7: condition numbers ---- */

/* y = (t L + theta B) x, or its conjugate with conj = -1; on rows, all of which have mass. [re; im] */
static void shifted(const hd_laplacian *lap, double t, hd_c64 theta, int conj, const double *x, double *y) {
    const int32_t n = lap->n;
    double *z = DENSE_NEW(double, n);
    int32_t i;
    int part;
    for (part = 0; part < 2; part++) {
        const double *same = x + (part ? n : 0), *other = x + (part ? 0 : n);
        double *out = y + (part ? n : 0);
        hd_laplacian_apply(lap, t, theta.re, same, out, NULL);
        hd_laplacian_apply(lap, 0, theta.im * conj * (part ? 1 : -1), other, z, NULL);
        for (i = 0; i < n; i++) out[i] += z[i];
    }
    free(z);
}

static double unit(double *x, int64_t n) {
    double s = 0;
    int64_t i;
    for (i = 0; i < n; i++) s += x[i] * x[i];
    s = sqrt(s);
    for (i = 0; i < n; i++) x[i] /= s;
    return s;
}

enum { POWER_STEPS = 60 };              /* of an iteration that comes from below, a few percent at the end */

static double largest_singular(const hd_laplacian *lap, double t, hd_c64 theta) {
    const int64_t n = 2 * (int64_t)lap->n;
    double *x = DENSE_NEW(double, n), *y = DENSE_NEW(double, n), s = 0;
    uint64_t seed = 3;
    int64_t i;
    int k;
    for (i = 0; i < n; i++) x[i] = dense_signed(&seed);
    unit(x, n);
    for (k = 0; k < POWER_STEPS; k++) {
        shifted(lap, t, theta, 1, x, y);
        shifted(lap, t, theta, -1, y, x);
        s = sqrt(unit(x, n));
    }
    free(x);
    free(y);
    return s;
}

/* The smallest singular values of t L + theta B for all poles of the set, by inverse iteration on factors. */
static void smallest_singular(const hd_laplacian *lap, double t, const hd_rational *set, double *s) {
    const size_t n = (size_t)lap->n, nnz = (size_t)lap->L.nnz;
    const int32_t m = set->n_poles;
    hd_c64 *val = DENSE_NEW(hd_c64, (size_t)m * nnz), *x = DENSE_NEW(hd_c64, (size_t)m * n);
    hd_ldl_opts o;
    hd_ldl *f = NULL;
    hd_error e;
    uint64_t seed = 3;
    size_t i, p;
    int32_t q;
    int k;
    memset(&o, 0, sizeof o);
    o.xyz = lap->xyz;
    o.context = &serial;
    for (q = 0; q < m; q++)
        for (i = 0; i < n; i++)
            for (p = (size_t)lap->L.row_ptr[i]; p < (size_t)lap->L.row_ptr[i + 1]; p++) {
                const double b = lap->B ? lap->B[p] : (size_t)lap->L.col[p] == i ? lap->mass[i] : 0;
                val[(size_t)q * nnz + p].re = t * lap->L.val[p] + set->theta[q].re * b;
                val[(size_t)q * nnz + p].im = set->theta[q].im * b;
            }
    if (hd_ldl_analyse(&f, &lap->L, &o, NULL, &e) < 0 || hd_ldl_factor_complex(f, m, val, NULL, &e) < 0)
        stop("factor", &e);
    for (i = 0; i < (size_t)m * n; i++) {
        x[i].re = dense_signed(&seed);
        x[i].im = dense_signed(&seed);
    }
    for (k = 0; k < 2 * POWER_STEPS; k++) {   /* A^-1, then the conjugate of A^-1 conj(x), which is A^-H x */
        if (hd_ldl_solve_complex(f, x, n, x, n, &e) < 0) stop("solve", &e);
        for (i = 0; i < (size_t)m * n; i++) x[i].im = -x[i].im;
        for (q = 0; q < m; q++) s[q] = 1 / unit((double *)(void *)(x + (size_t)q * n), 2 * (int64_t)n);
    }
    hd_ldl_free(f);
    free(val);
    free(x);
}

/* All singular values of a complex-symmetric A are the absolute eigenvalues of [Re A, -Im A; -Im A, -Re A]
 * (Takagi's factorisation). Returns largest / smallest. */
static double exact_condition(const dense_pair *p, double t, hd_c64 theta) {
    const int32_t n = p->n, m = 2 * n;
    double *a = DENSE_NEW(double, (int64_t)m * m), *x = DENSE_NEW(double, (int64_t)m * m), *d
        = DENSE_NEW(double, m);
    double lo = 1e300, hi = 0;
    int32_t i, j;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) {
            const size_t at = (size_t)i * (size_t)n + (size_t)j, row = (size_t)i * (size_t)m + (size_t)j,
                low = (size_t)(i + n) * (size_t)m + (size_t)j;
            const double re = t * p->L[at] + theta.re * p->B[at], im = theta.im * p->B[at];
            a[row] = re;
            a[low + (size_t)n] = -re;
            a[row + (size_t)n] = a[low] = -im;
        }
    if (!dense_symmetric_eigen(a, x, d, m)) stop("dense eigenvalues", NULL);
    for (i = 0; i < m; i++) {
        lo = fmin(lo, fabs(d[i]));
        hi = fmax(hi, fabs(d[i]));
    }
    free(a);
    free(x);
    free(d);
    return hi / lo;
}

/* Figure 7, over t for the poles of the uniform set of degree 7. Returns how far estimates are from exact
 * ones. */
static double conditions(page *p, const hd_laplacian *lap, const dense_pair *dense, const char *title,
                         const char *caption) {
    chart c;
    chart_curve *exact[HD_MAX_POLES], *estimate[HD_MAX_POLES];
    hd_rational set;
    double low[HD_MAX_POLES], worst = 0, e;
    char name[CHART_NAME];
    int32_t q;
    chart_begin(&c, "fig-7", title, "t / h&#178;", "condition number");
    if (hd_rational_exp(&set, HD_POLES_UNIFORM, 7, NULL) < 0) stop("poles", NULL);
    for (q = 0; q < set.n_poles; q++) {
        snprintf(name, sizeof name, "&#952; = %.2f%+.2fi", set.theta[q].re, set.theta[q].im);
        if (set.theta[q].im == 0) snprintf(name, sizeof name, "&#952; = %.2f", set.theta[q].re);
        exact[q] = chart_add(&c, name);
        exact[q]->colour = q;
        exact[q]->marker = -1;
    }
    for (q = 0; q < set.n_poles; q++) {
        estimate[q] = chart_add(&c, "estimate");
        estimate[q]->colour = estimate[q]->marker = q;
        estimate[q]->unnamed = 1;
        estimate[q]->no_line = dense != NULL;
    }
    for (e = -1; e < 4.01; e += quick ? 2.5 : 1) {
        const double t = pow(10, e) * lap->h * lap->h;
        smallest_singular(lap, t, &set, low);
        for (q = 0; q < set.n_poles; q++) {
            const double about = largest_singular(lap, t, set.theta[q]) / low[q];
            chart_point(estimate[q], pow(10, e), about);
            if (!dense) continue;
            chart_point(exact[q], pow(10, e), exact_condition(dense, t, set.theta[q]));
            worst = fmax(worst, fabs(about / exact[q]->y[exact[q]->n - 1] - 1));
        }
    }
    for (q = 0; q < set.n_poles && !dense; q++) {    /* the legend needs named curves */
        estimate[q]->unnamed = 0;
        memcpy(estimate[q]->name, exact[q]->name, CHART_NAME);
    }
    page_chart(p, &c, caption);
    return worst;
}

/* ---- Figures 1 to 4 and 8: level sets ---- */

/* k_t at t = part of the area from a vertex. */
static double *heat_on(const method *m, const shape *s, double part, int32_t source) {
    hd_laplacian *lap = laplacian(m, s, &serial);
    hd_heat *heat = NULL;
    hd_error e;
    double *u = DENSE_NEW(double, s->n);
    const double t = part * lap->area;
    if (hd_heat_create(&heat, lap, NULL, &e) < 0 ||
        hd_heat_column(heat, HD_KERNEL_SYMMETRIC, t, source, u, NULL, &e) < 0) stop(m->name, &e);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return u;
}

/* Root of the mean square of the change at common vertices, in percent of the largest value. of NULL: the
 * first vertices are the same. */
static double change(const double *u, int32_t n, const int32_t *of, const double *u0, int32_t n0) {
    double sum = 0;
    int32_t i, count = 0;
    for (i = 0; i < n; i++) {
        const int32_t j = of ? of[i] : i < n0 ? i : -1;
        if (j < 0) continue;
        sum += (u[i] - u0[j]) * (u[i] - u0[j]);
        count++;
    }
    return 100 * sqrt(sum / count) / dense_max_abs(u0, n0);
}

typedef struct gallery {
    page *p;
    const char *figure;
    const shape *whole;
    double *original;                   /* k_t there, by fem */
    int32_t source;
    int turn;                           /* the animal is seen from a given side */
} gallery;

enum { SEEN_WIDE = 520, SEEN_HIGH = 400 };
static const double SEEN_AT = 0.02;     /* t / area */

static void gallery_show(const gallery *g, const shape *s, const double *u, int points, const char *name,
                         double changed) {
    pic_panel panel;
    pic_opts o;
    pic_image image;
    char caption[240];
    memset(&panel, 0, sizeof panel);
    memset(&o, 0, sizeof o);
    panel.n = s->n;
    panel.xyz = s->xyz;
    panel.n_tri = points ? 0 : s->n_tri;
    panel.tri = s->tri;
    panel.field = u;
    o.width = SEEN_WIDE;
    o.height = SEEN_HIGH;
    o.no_legend = 1;
    o.isolines = 14;
    o.view_given = g->turn;
    o.azimuth = 28;
    o.elevation = 14;
    if (pic_render(&image, &panel, &o) != PIC_OK) stop("picture", NULL);
    snprintf(caption, sizeof caption, changed < 0 ? "%s, %d vertices" : "%s, %d vertices: changed by "
             "%.2g&nbsp;%%", name,
             (int)s->n, changed);
    page_picture(g->p, &image, name, caption);
    pic_image_free(&image);
    if (changed >= 0) page_number(g->p, g->figure, name, "k_t, root of the mean square", "vertices", s->n,
                                  "change in percent of the largest value", changed);
}

/* k_t by an operator on a variant, and its picture. */
static void gallery_add(const gallery *g, const method *m, const surface *f, const char *name) {
    int32_t here = 0;
    double *u;
    while (here < f->s.n && f->of[here] != g->source) here++;
    if (here == f->s.n) stop("the source is gone", NULL);
    u = heat_on(m, &f->s, SEEN_AT, here);
    gallery_show(g, &f->s, u, m->points, name, change(u, f->s.n, f->of, g->original, g->whole->n));
    free(u);
}

static void gallery_variant(const gallery *g, surface f) {
    gallery_add(g, &FEM, &f, f.name);
    shape_free(&f.s);
    free(f.of);
}

static void gallery_open(gallery *g, const char *figure, const char *head) {
    g->figure = figure;
    page_add(g->p, "<h2 id=\"%s\">%s</h2>\n<div class=\"pictures\">\n", figure, head);
}

/* coarse: its vertices are the first ones of whole, and those of fine (NULL: there is none). */
static void level_sets(page *p, const shape *coarse, const shape *whole, const shape *fine, int turn,
                       const char *id) {
    gallery g;
    surface same = begin(whole, ""), start = begin(coarse, "");
    const double h = mean_edge(whole);
    char figure[5][40];
    static const int number[5] = {1, 2, 3, 4, 8};
    double *u;
    int32_t i;
    int k;
    for (k = 0; k < 5; k++) snprintf(figure[k], sizeof figure[k], "fig-%d%s", number[k], id);
    memset(&g, 0, sizeof g);
    g.p = p;
    g.whole = whole;
    g.turn = turn;
    for (i = 0; i < coarse->n; i++)
        if (coarse->xyz[3 * i] > coarse->xyz[3 * g.source]) g.source = i;
    g.original = heat_on(&FEM, whole, SEEN_AT, g.source);
    gallery_open(&g, figure[0], "Figure 1: two Laplacians");
    gallery_show(&g, whole, g.original, 0, "fem", -1);
    gallery_add(&g, &PLAIN, &same, "voronoi-cot");
    page_add(p, "</div>\n");
    gallery_open(&g, figure[1], "Figure 2: coarse and fine");
    if (whole != coarse) gallery_add(&g, &FEM, &start, "coarse");
    gallery_show(&g, whole, g.original, 0, "the surface of Figure 1", -1);
    if (fine) {
        u = heat_on(&FEM, fine, SEEN_AT, g.source);
        gallery_show(&g, fine, u, 0, "fine", change(u, fine->n, NULL, g.original, whole->n));
        free(u);
    }
    page_add(p, "</div>\n");
    gallery_open(&g, figure[2], "Figure 3: noise");
    gallery_variant(&g, noisy(whole, 0.05 * h, "noise of 0.05 h"));
    gallery_variant(&g, noisy(whole, 0.2 * h, "noise of 0.2 h"));
    gallery_variant(&g, noisy(whole, 0.5 * h, "noise of 0.5 h"));
    page_add(p, "</div>\n");
    gallery_open(&g, figure[3], "Figure 4: missing parts");
    gallery_variant(&g, holes(whole, 0.05, g.source, "5 % cut out"));
    gallery_variant(&g, holes(whole, 0.15, g.source, "15 % cut out"));
    gallery_variant(&g, cut(whole, 0.25, "an end cut off"));
    page_add(p, "</div>\n");
    gallery_open(&g, figure[4], "Figure 8: points without faces");
    gallery_add(&g, &POINTS, &same, "voronoi-exp");
    gallery_add(&g, &STARS, &same, "tufted");
    page_add(p, "</div>\n");
    free(g.original);
    shape_free(&same.s);
    free(same.of);
    shape_free(&start.s);
    free(start.of);
}

static void own_level_sets(page *p) {
    shape coarse = shape_demo(1500), whole = shape_subdivide(&coarse), fine;
    int32_t i;
    for (i = 0; i < whole.n; i++) shape_animal_project(whole.xyz + 3 * i, 2);
    fine = shape_subdivide(&whole);
    for (i = 0; i < fine.n; i++) shape_animal_project(fine.xyz + 3 * i, 2);
    if (!fine.xyz) stop("shape", NULL);
    page_add(p, "<p>Level sets of k<sub>t</sub> from the middle of the trunk at t = %g of the area. Changes "
             "are roots of the mean square over common vertices, in percent of the largest value, against "
             "<code>fem</code> on the surface of Figure 1. Noise and holes change the surface itself, and "
             "most of what changes is that: <code>tools/README.md</code> separates the two.</p>\n", SEEN_AT);
    level_sets(p, &coarse, &whole, &fine, 1, "");
    shape_free(&coarse);
    shape_free(&whole);
    shape_free(&fine);
}

/* Errors on a small mesh against the dense eigensolution, and on a larger one. */
static void error_figures(page *p) {
    shape small = shape_bumpy(quick ? 2 : 3, 1), large = shape_demo(quick ? 1500 : 10000);
    hd_laplacian *a = laplacian(&FEM, &small, &serial), *b = laplacian(&FEM, &large, &serial);
    study s, l;
    char title[2][80], caption[400];
    study_begin(&s, a, a->n, 1);
    study_begin(&l, b, quick ? 200 : 1000, 0);
    snprintf(title[0], sizeof title[0], "Ball with bumps, %d vertices", (int)a->n);
    snprintf(title[1], sizeof title[1], "Animal, %d vertices", (int)b->n);
    page_add(p, "<h2 id=\"fig-5\">Figure 5: error over t</h2>\n<div class=\"charts\">\n");
    snprintf(caption, sizeof caption, "%s, against the dense eigensolution.", title[0]);
    errors_over_time(p, &s, title[0], caption);
    snprintf(caption, sizeof caption, "%s, against the direct method.", title[1]);
    errors_over_time(p, &l, title[1], caption);
    page_add(p, "</div>\n<p>Columns of four sources, the worst of them. On the larger shape the truth is the "
             "direct method with kernel poles of degree 14, from which Lanczos at tolerance 1e-12 differs by "
             "%.0e at most; errors below <span class=\"whole\">1e-15</span> are drawn there.</p>\n", l.gap);
    page_add(p, "<h2 id=\"fig-6\">Figure 6: error over the number of eigenpairs</h2>\n<div "
             "class=\"charts\">\n");
    snprintf(caption, sizeof caption, "%s, against the dense eigensolution. Dashed: the default method.",
             title[0]);
    errors_over_pairs(p, &s, title[0], caption);
    snprintf(caption, sizeof caption, "%s, up to %d eigenpairs. Dashed: the default method.", title[1],
             (int)l.pairs->count);
    errors_over_pairs(p, &l, title[1], caption);
    page_add(p, "</div>\n");
    study_end(&s);
    study_end(&l);
    hd_laplacian_free(a);
    hd_laplacian_free(b);
    shape_free(&small);
    shape_free(&large);
}

static void condition_figures(page *p) {
    shape small = shape_bumpy(2, 1), large = shape_demo(quick ? 1500 : 10000);
    hd_laplacian *a = laplacian(&FEM, &small, &serial), *b = laplacian(&FEM, &large, &serial);
    dense_pair dense;
    char title[2][80], caption[400];
    double worst;
    dense_of(a, &dense);
    snprintf(title[0], sizeof title[0], "Ball with bumps, %d vertices", (int)a->n);
    snprintf(title[1], sizeof title[1], "Animal, %d vertices", (int)b->n);
    page_add(p, "<h2 id=\"fig-7\">Figure 7: condition numbers of t L + &#952; B</h2>\n<div "
             "class=\"charts\">\n");
    snprintf(caption, sizeof caption, "%s. Lines: exact, from all singular values. Points: estimates.",
             title[0]);
    worst = conditions(p, a, &dense, title[0], caption);
    snprintf(caption, sizeof caption, "%s, estimates by power and inverse iteration.", title[1]);
    conditions(p, b, NULL, title[1], caption);
    page_add(p, "</div>\n<p>Poles of the uniform set of degree 7, one of each conjugate pair, in the "
             "Euclidean norm. On the small shape the estimates, which come from below, are off by at most "
             "%.1f %%.</p>\n",
                 100 * worst);
    dense_pair_free(&dense);
    hd_laplacian_free(a);
    hd_laplacian_free(b);
    shape_free(&small);
    shape_free(&large);
}

/* A mesh from a file: errors and level sets. */
static void mesh_figures(page *p, const shape *s, const char *name, int number) {
    hd_laplacian *lap = laplacian(&FEM, s, &serial);
    study l;
    char id[20];
    if (s->n_tri == 0 || s->n > 60000) {
        hd_laplacian_free(lap);
        return;
    }
    page_add(p, "<h2>%s: errors</h2>\n<div class=\"charts\">\n", name);
    study_begin(&l, lap, quick ? 100 : 1000, 0);
    errors_over_time(p, &l, name, "As Figure 5.");
    errors_over_pairs(p, &l, name, "As Figure 6.");
    page_add(p, "</div>\n");
    study_end(&l);
    hd_laplacian_free(lap);
    snprintf(id, sizeof id, "-mesh-%d", number);
    level_sets(p, s, s, NULL, 0, id);
}

#endif
