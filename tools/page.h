/* page.h - a report as one HTML page: text, tables, charts in SVG, embedded pictures, and all numbers as CSV

       page p;
       chart c;
       page_open(&p, "Title");
       page_add(&p, "<p>%d vertices</p>", n);
       chart_begin(&c, "fig1", "What it shows", "vertices", "seconds");
       chart_point(chart_add(&c, "here"), 1000, 0.2);
       page_chart(&p, &c, "Caption.");
       page_write(&p, "folder", "report", 0);

   The page needs nothing besides itself. It follows the reader's light or dark colours. Charts are drawn
   for a width of 480 units, so that their text stays readable on a phone; on narrow screens each row of a
   table becomes a list. Only the C library; memory that cannot be had ends the program. */

#ifndef PAGE_H
#define PAGE_H

#include "picture.h"

#include <stdarg.h>

/* ---- text that grows ---- */

typedef struct text { char *at; size_t used, size; } text;

static void text_room(text *s, size_t more) {
    if (s->used + more + 1 <= s->size) return;
    s->size = 2 * (s->used + more) + 4096;
    s->at = (char *)realloc(s->at, s->size);
    if (s->at) return;
    fprintf(stderr, "page: out of memory\n");
    exit(1);
}

#if defined(__GNUC__) || defined(__clang__)
__attribute__((format(printf, 2, 0)))
#endif
static void text_add_list(text *s, const char *format, va_list list) {
    va_list again;
    int n;
    va_copy(again, list);
    n = vsnprintf(NULL, 0, format, again);
    va_end(again);
    if (n < 0) return;
    text_room(s, (size_t)n);
    vsnprintf(s->at + s->used, s->size - s->used, format, list);
    s->used += (size_t)n;
}

#if defined(__GNUC__) || defined(__clang__)
__attribute__((format(printf, 2, 3)))
#endif
static void text_add(text *s, const char *format, ...) {
    va_list list;
    va_start(list, format);
    text_add_list(s, format, list);
    va_end(list);
}

/* RFC 4648. */
static void text_base64(text *s, const uint8_t *p, size_t n) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t i;
    text_room(s, 4 * (n / 3 + 1));
    for (i = 0; i < n; i += 3) {
        const uint32_t b = (uint32_t)p[i] << 16 | (i + 1 < n ? (uint32_t)p[i + 1] << 8 : 0)
                         | (i + 2 < n ? (uint32_t)p[i + 2] : 0);
        s->at[s->used++] = digit[b >> 18];
        s->at[s->used++] = digit[b >> 12 & 63];
        s->at[s->used++] = i + 1 < n ? digit[b >> 6 & 63] : '=';
        s->at[s->used++] = i + 2 < n ? digit[b & 63] : '=';
    }
    s->at[s->used] = 0;
}

static void text_write(const text *s, const char *path) {
    FILE *f = fopen(path, "wb");
    const int ok = f && fwrite(s->at, 1, s->used, f) == s->used;
    if ((f && fclose(f) != 0) || !ok) {
        fprintf(stderr, "page: cannot write %s\n", path);
        exit(1);
    }
}

/* ---- charts ---- */

enum { CHART_LINES = 24, CHART_POINTS = 32, CHART_NAME = 64 };

/* One curve, or points alone. Colour and marker are numbers from 0; marker -1: none. */
typedef struct chart_curve {
    char name[CHART_NAME];
    int n, colour, marker, dashed, no_line, unnamed;
    double x[CHART_POINTS], y[CHART_POINTS];
} chart_curve;

typedef struct chart {
    const char *figure, *title, *x_name, *y_name;     /* figure: for the CSV and file names */
    int n;
    double lowest;                                    /* > 0: smaller y are drawn here */
    chart_curve curve[CHART_LINES];
} chart;

static void chart_begin(chart *c, const char *figure, const char *title, const char *x, const char *y) {
    memset(c, 0, sizeof *c);
    c->figure = figure;
    c->title = title;
    c->x_name = x;
    c->y_name = y;
}

/* A new curve, in the colour and with the marker of its number. */
static chart_curve *chart_add(chart *c, const char *name) {
    chart_curve *q = c->curve + c->n;
    if (c->n == CHART_LINES) {
        fprintf(stderr, "page: too many curves\n");
        exit(1);
    }
    snprintf(q->name, sizeof q->name, "%s", name);
    q->colour = q->marker = c->n++;
    return q;
}

static void chart_point(chart_curve *q, double x, double y) {
    if (q->n == CHART_POINTS) {
        fprintf(stderr, "page: too many points of %s\n", q->name);
        exit(1);
    }
    q->x[q->n] = x;
    q->y[q->n++] = y;
}

/* Both axes are logarithmic; lo and hi are exponents. */
typedef struct chart_axis { double lo, hi, from, to; } chart_axis;

static double chart_at(const chart_axis *a, double v) {
    return a->from + (log10(v) - a->lo) / (a->hi - a->lo) * (a->to - a->from);
}

static chart_axis chart_range(const chart *c, int vertical, double from, double to) {
    chart_axis a = {1e300, -1e300, 0, 0};
    int k, i;
    a.from = from;
    a.to = to;
    for (k = 0; k < c->n; k++)
        for (i = 0; i < c->curve[k].n; i++) {
            double v = vertical ? c->curve[k].y[i] : c->curve[k].x[i];
            if (vertical && v < c->lowest) v = c->lowest;
            if (!(v > 0)) continue;
            a.lo = fmin(a.lo, log10(v));
            a.hi = fmax(a.hi, log10(v));
        }
    a.lo = vertical ? floor(a.lo + 1e-9) : a.lo - 0.04 * (a.hi - a.lo);
    a.hi = vertical ? ceil(a.hi - 1e-9) : a.hi + 0.04 * (a.hi - a.lo);
    if (!(a.hi - a.lo >= 1e-3)) a.hi = a.lo + 1;
    return a;
}

/* A power of ten, in plain digits up to a power of most. */
static void chart_number(text *s, int power, int most) {
    if (power >= 0 && power <= most) text_add(s, "%.0f", pow(10, power));
    else if (power < 0 && power >= -2) text_add(s, "%.*f", -power, pow(10, power));
    else text_add(s, "10<tspan dy=\"-5\" font-size=\"9.5\">%s%d</tspan>", power < 0 ? "&#8722;" : "",
                  abs(power));
}

/* Lines and numbers at powers of ten; where the axis spans few of them, at 2 and 5 too. */
static void chart_grid(text *s, const chart_axis *a, const chart_axis *other, int vertical) {
    const int lo = (int)ceil(a->lo - 1e-9), hi = (int)floor(a->hi + 1e-9), step = (hi - lo) / 9 + 1;
    const int few = a->hi - a->lo < 2.2;
    int p, m;
    for (p = lo - 1; p <= hi; p++)
        for (m = 1; m < 10; m++) {
            const double v = m * pow(10, p), at = chart_at(a, v);
            const int named = m == 1 ? (p - lo) % step == 0 : few && (m == 2 || m == 5);
            if (log10(v) < a->lo - 1e-9 || log10(v) > a->hi + 1e-9 || (m > 1 && !named)) continue;
            if (vertical) text_add(s, "<line class=\"g\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>",
                                   other->from, other->to, at, at);
            else text_add(s, "<line class=\"g\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>", at, at,
                          other->from, other->to);
            if (!named) continue;
            if (vertical) text_add(s, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", other->from - 6, at
                                   + 4.5);
            else text_add(s, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", at, other->from + 17);
            if (m == 1) chart_number(s, p, few ? 5 : 3);
            else text_add(s, "%g", v);
            text_add(s, "</text>");
        }
}

static void chart_marker(text *s, int kind, double x, double y, int colour) {
    static const char *const path[] = {
        "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z", "M-3.6-3.6h7.2v7.2h-7.2z", "M0-4.8L4.4 3.2H-4.4z",
        "M0-5L5 0L0 5L-5 0z", "M0 4.8L4.4-3.2H-4.4z", "M-4-4L4 4M-4 4L4-4", "M-5 0H5M0-5V5",
        "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0M-2 0h4"};
    if (kind < 0) return;
    text_add(s, "<path class=\"m%s c%d\" transform=\"translate(%.1f %.1f)\" d=\"%s\"/>", kind % 8 >= 5 ? "o"
             : "",
             colour % 8, x, y, path[kind % 8]);
}

static void chart_draw_curve(text *s, const chart_curve *q, const chart_axis *x, const chart_axis *y,
                             double lowest) {
    int i;
    if (!q->no_line && q->n > 1) {
        text_add(s, "<polyline class=\"l c%d%s\" points=\"", q->colour % 8, q->dashed ? " d" : "");
        for (i = 0; i < q->n; i++)
            text_add(s, "%.1f,%.1f ", chart_at(x, q->x[i]), chart_at(y, fmax(q->y[i], lowest)));
        text_add(s, "\"/>");
    }
    for (i = 0; i < q->n; i++)
        chart_marker(s, q->marker, chart_at(x, q->x[i]), chart_at(y, fmax(q->y[i], lowest)), q->colour);
}

/* Names of the curves in rows above the plot. Returns how high they are. */
static double chart_legend(text *s, const chart *c, double left, double right) {
    double x = left, y = 13;
    int k;
    for (k = 0; k < c->n; k++) {
        const chart_curve *q = c->curve + k;
        const double wide = 44 + 6.9 * (double)strlen(q->name);   /* of these letters, about */
        if (q->unnamed || q->n == 0) continue;
        if (x > left && x + wide > right) {
            x = left;
            y += 19;
        }
        if (!q->no_line) text_add(s, "<line class=\"l c%d%s\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" "
                                  "y2=\"%.1f\"/>",
                                  q->colour % 8, q->dashed ? " d" : "", x, x + 26, y - 4.5, y - 4.5);
        chart_marker(s, q->marker, x + 13, y - 4.5, q->colour);
        text_add(s, "<text x=\"%.1f\" y=\"%.1f\">%s</text>", x + 32, y, q->name);
        x += wide;
    }
    return y + 12;
}

static const char chart_style[] =
    "svg.chart{--ink:#23262d; --soft:#666c76; --line:#d9dce1; --c0:#0067a5; --c1:#c8500a; --c2:#00805a; "
    "--c3:#b0457e;--c4:#a57c00; --c5:#5b4bb7; --c6:#3a97c4; --c7:#6d6d6d; font:12.5px "
    "system-ui,sans-serif}\n@media(prefers-color-scheme:dark){svg.chart{--ink:#e6e8ec; --soft:#a3a9b4; "
    "--line:#3a3f48; --c0:#5fb4ea;--c1:#f08c4b; --c2:#3cc79a; --c3:#e489bd; --c4:#e0bb3f; --c5:#a99cf5; "
    "--c6:#8fd3f2; --c7:#b4b4b4}}\nsvg.chart text{fill:var(--ink)} svg.chart .n{fill:var(--soft)} svg.chart "
    ".g{stroke:var(--line); stroke-width:1}svg.chart .l{fill:none; stroke-width:1.8; stroke-linejoin:round} "
    "svg.chart .d{stroke-dasharray:6 4}svg.chart .mo{fill:none!important; stroke-width:1.8} svg.chart "
    ".m{stroke:none!important}\nsvg.chart .c0{stroke:var(--c0); fill:var(--c0)} svg.chart "
    ".c1{stroke:var(--c1); fill:var(--c1)}svg.chart .c2{stroke:var(--c2); fill:var(--c2)} svg.chart "
    ".c3{stroke:var(--c3); fill:var(--c3)}svg.chart .c4{stroke:var(--c4); fill:var(--c4)} svg.chart "
    ".c5{stroke:var(--c5); fill:var(--c5)}svg.chart .c6{stroke:var(--c6); fill:var(--c6)} svg.chart "
    ".c7{stroke:var(--c7); fill:var(--c7)}svg.chart .l{fill:none!important}\n";

/* The drawing. alone: a file of its own, which carries its style. */
static void chart_draw(text *s, const chart *c, int alone) {
    enum { WIDE = 480, HIGH = 330, LEFT = 50, RIGHT = 18 };
    text legend = {NULL, 0, 0};
    const double top = chart_legend(&legend, c, LEFT, WIDE - RIGHT) + 18;
    const chart_axis x = chart_range(c, 0, LEFT, WIDE - RIGHT), y = chart_range(c, 1, top + HIGH - 72, top);
    const double base = y.from;
    int k;
    text_add(s, "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %.0f\" "
             "role=\"img\" aria-label=\"%s\">", WIDE, base + 40, c->title);
    if (alone) text_add(s, "<style>%s</style>", chart_style);
    text_add(s, "%s", legend.at ? legend.at : "");
    chart_grid(s, &x, &y, 0);
    chart_grid(s, &y, &x, 1);
    text_add(s, "<text class=\"n\" x=\"2\" y=\"%.1f\">%s</text>", top - 12, c->y_name);
    text_add(s, "<text class=\"n\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>", WIDE - RIGHT, base
             + 35, c->x_name);
    for (k = 0; k < c->n; k++) chart_draw_curve(s, c->curve + k, &x, &y, c->lowest);
    text_add(s, "</svg>\n");
    free(legend.at);
}

/* ---- the page ---- */

typedef struct page {
    text body, csv, charts[CHART_LINES];      /* charts: drawings by themselves, for other documents */
    char chart_name[CHART_LINES][CHART_NAME];
    int n_charts, column, n_columns;
    const char *const *columns;
    const char *table;
    long row;
} page;

static const char page_style[] =
    ":root{color-scheme:light dark; --ink:#23262d; --soft:#5d636e; --line:#d9dce1; --paper:#fff; "
    "--box:#f5f6f8}\n@media(prefers-color-scheme:dark){:root{--ink:#e6e8ec; --soft:#a3a9b4; --line:#3a3f48; "
    "--paper:#16181c; --box:#1f2228}}\n*{box-sizing:border-box} body{margin:0 auto; max-width:1120px; "
    "padding:1rem 1.2rem 4rem; color:var(--ink);background:var(--paper); font:16px/1.5 system-ui,sans-serif; "
    "overflow-wrap:break-word}\nh1{font-size:1.7rem; line-height:1.25; margin:.6rem 0} h2{font-size:1.25rem; "
    "margin:2.6rem 0 .4rem; line-height:1.3}p,ul{max-width:46rem} p{margin:.5rem 0} "
    ".soft,figcaption,caption{color:var(--soft); font-size:.92rem}\na{color:inherit} figure{margin:1rem 0} "
    "figcaption{margin-top:.3rem; max-width:46rem} img,svg.chart{display:block;width:100%; height:auto} "
    "img{border-radius:6px} .charts{display:grid; gap:1.2rem "
    "2rem;grid-template-columns:repeat(auto-fill,minmax(min(100%,26rem),1fr))} .charts "
    "figure{max-width:40rem} .pictures{display:grid; gap:0 1rem; "
    "grid-template-columns:repeat(auto-fill,minmax(min(100%,17rem),1fr))} .pictures "
    "figure{max-width:26rem}\ntable{border-collapse:collapse; margin:1rem 0; width:100%; font-size:.92rem; "
    "font-variant-numeric:tabular-nums}caption{text-align:left; padding-bottom:.4rem} th,td{padding:.28rem "
    ".35rem; border-bottom:1px solid var(--line);text-align:right; vertical-align:bottom} "
    "td,th:first-child,.whole{white-space:nowrap} sub{line-height:0} th:first-child,td:first-child{text-align:left; "
    "padding-left:0}th{font-weight:600} "
    "td.p{color:var(--soft)}\n@media(max-width:760px){table,tbody,tr,td,caption{display:block} "
    "thead{display:none} tr{background:var(--box);border-radius:6px; padding:.4rem .7rem; margin:.5rem 0} "
    "td{display:flex; justify-content:space-between; gap:1rem;padding:.12rem 0; border:0; text-align:right; "
    "white-space:normal} td.none{display:none} td:first-child{font-weight:600; "
    "padding-bottom:.3rem}td:not(:first-child)::before{content:attr(data-name); color:var(--soft); "
    "text-align:left}}\n";

static void page_open(page *p, const char *title) {
    memset(p, 0, sizeof *p);
    text_add(&p->body, "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
             "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>%s</title>\n"
             "<style>\n%s%s</style></head>\n<body>\n<h1>%s</h1>\n", title, page_style, chart_style, title);
    text_add(&p->csv, "figure,of,series,x_name,x,y_name,y\n");
}

#if defined(__GNUC__) || defined(__clang__)
__attribute__((format(printf, 2, 3)))
#endif
static void page_add(page *p, const char *format, ...) {
    va_list list;
    va_start(list, format);
    text_add_list(&p->body, format, list);
    va_end(list);
}

static void page_number(page *p, const char *figure, const char *of, const char *series, const char *x_name,
                        double x, const char *y_name, double y) {
    text_add(&p->csv, "%s,\"%s\",\"%s\",\"%s\",%.9g,\"%s\",%.9g\n", figure, of, series, x_name, x, y_name, y);
}

static void page_chart(page *p, const chart *c, const char *caption) {
    int k, i;
    page_add(p, "<figure>");
    chart_draw(&p->body, c, 0);
    page_add(p, "<figcaption>%s</figcaption></figure>\n", caption);
    for (k = 0; k < c->n; k++)
        for (i = 0; i < c->curve[k].n; i++)
            page_number(p, c->figure, c->title, c->curve[k].name, c->x_name, c->curve[k].x[i], c->y_name,
                        c->curve[k].y[i]);
    if (p->n_charts == CHART_LINES) return;
    snprintf(p->chart_name[p->n_charts], CHART_NAME, "%s-%d", c->figure, p->n_charts);
    chart_draw(&p->charts[p->n_charts++], c, 1);
}

/* A table: begin, then cells row by row, then end. */
static void page_table_begin(page *p, const char *id, const char *caption, int n,
                             const char *const *columns) {
    int k;
    p->n_columns = n;
    p->columns = columns;
    p->column = 0;
    p->table = id;
    p->row = 0;
    page_add(p, "<table id=\"%s\"><caption>%s</caption><thead><tr>", id, caption);
    for (k = 0; k < n; k++) page_add(p, "<th>%s</th>", columns[k]);
    page_add(p, "</tr></thead><tbody>\n");
}

static void page_cell(page *p, const char *kind, const char *content) {
    if (p->column == 0) page_add(p, "<tr>");
    page_add(p, "<td class=\"%s\" data-name=\"%s\"><span>%s</span></td>", kind, p->columns[p->column],
             content);
    if (++p->column < p->n_columns) return;
    p->column = 0;
    p->row++;
    page_add(p, "</tr>\n");
}

/* A number, and its line of the CSV. */
static void page_value(page *p, const char *kind, const char *of, double v, const char *format) {
    char number[40];
    const char *name = p->columns[p->column];
    text_add(&p->csv, "%s,\"%s\",\"%s\",\"row\",%ld,\"%s\",%.9g\n", p->table, of, name, p->row + 1, "value",
             v);
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#endif
    snprintf(number, sizeof number, format, v);
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
    page_cell(p, kind, number);
}

static void page_table_end(page *p) { page_add(p, "</tbody></table>\n"); }

/* A picture, written into the page as a PNG. */
static void page_picture(page *p, const pic_image *image, const char *alt, const char *caption) {
    uint8_t *png = NULL;
    size_t size = 0;
    if (pic_png_encode(&png, &size, image->rgb, image->width, image->height) != PIC_OK) {
        fprintf(stderr, "page: a picture could not be encoded\n");
        exit(1);
    }
    page_add(p, "<figure><img alt=\"%s\" width=\"%d\" height=\"%d\" src=\"data:image/png;base64,", alt,
             (int)image->width, (int)image->height);
    text_base64(&p->body, png, size);
    page_add(p, "\"><figcaption>%s</figcaption></figure>\n", caption);
    free(png);
}

/* Writes NAME.html, NAME.csv, and the charts NAME-FIGURE-NUMBER.svg if wanted, into the folder. */
static void page_write(page *p, const char *folder, const char *name, int with_charts) {
    char path[600];
    int k;
    page_add(p, "<p class=\"soft\"><a download=\"%s.csv\" href=\"data:text/csv;base64,", name);
    text_base64(&p->body, (const uint8_t *)p->csv.at, p->csv.used);
    page_add(p, "\">All numbers as CSV</a></p>\n</body></html>\n");
    snprintf(path, sizeof path, "%.400s/%.100s.html", folder, name);
    text_write(&p->body, path);
    snprintf(path, sizeof path, "%.400s/%.100s.csv", folder, name);
    text_write(&p->csv, path);
    for (k = 0; k < p->n_charts; k++) {
        snprintf(path, sizeof path, "%.400s/%.100s-%s.svg", folder, name, p->chart_name[k]);
        if (with_charts) text_write(&p->charts[k], path);
        free(p->charts[k].at);
    }
    free(p->body.at);
    free(p->csv.at);
}

#endif
