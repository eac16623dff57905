/* levels.h - level sets of a field on a mesh, as polylines

   The field is linear along edges. A vertex whose value equals the level counts as above it. Between the
   crossings of a face lie straight segments, and segments that meet on an edge are joined. Where a face has
   four crossings and more, the mean of its corners tells whether the parts above hang together or those
   below. Faces with a value that is not finite have no segments. */

#ifndef LEVELS_H
#define LEVELS_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Faces have corner face_idx[face_ptr[f]] .. face_idx[face_ptr[f + 1] - 1]. */
typedef struct lev_mesh {
    const double *xyz;
    const int64_t *face_ptr;
    const int32_t *face_idx;
    int32_t n_faces;
} lev_mesh;

typedef struct lev_line {
    double level, length;
    int64_t first, count;            /* of its points */
    int closed;                      /* the first point follows the last again, without being repeated */
} lev_line;

typedef struct lev_set {
    lev_line *line;
    int64_t n_lines, room_lines;
    double *xyz;                     /* [3 n_points] */
    int64_t n_points, room_points;
} lev_set;

/* Two crossings that a face joins; an edge is its smaller vertex << 32 | the larger. */
typedef struct lev_segment { uint64_t edge[2]; } lev_segment;

typedef struct lev_work {
    const lev_mesh *mesh;
    const double *f;
    double level;
    lev_segment *segment;
    int64_t n_segments, room_segments;
    uint64_t *node;                  /* edges that are crossed, ascending */
    int64_t n_nodes;
    int64_t *start, *at;             /* [n_nodes + 1], [2 n_segments]: segments at each node */
    char *used;                      /* [n_segments] */
} lev_work;

static void lev_free(lev_set *s)
{
    free(s->line);
    free(s->xyz);
    memset(s, 0, sizeof *s);
}

/* Room for one more item of this size. Returns 0 without memory. */
static int lev_room(void **items, int64_t n, int64_t *room, size_t size)
{
    const int64_t more = *room ? 2 * *room : 64;
    void *grown;
    if (n < *room) return 1;
    grown = realloc(*items, (size_t)more * size);
    if (!grown) return 0;
    *items = grown;
    *room = more;
    return 1;
}

static uint64_t lev_edge(int32_t i, int32_t j)
{
    return i < j ? (uint64_t)i << 32 | (uint32_t)j : (uint64_t)j << 32 | (uint32_t)i;
}

/* The point at share s of the way from x to y, 0 < s < 1. It lies between them also as rounded: s is below 1
 * by more of y - x than the difference can have been rounded up. */
static double lev_between(double x, double y, double s)
{
    return isfinite(y - x) ? x + s * (y - x) : (1 - s) * x + s * y;
}

static void lev_point(const lev_work *w, uint64_t edge, double *p)
{
    const size_t i = (size_t)(edge >> 32), j = (size_t)(edge & 0xffffffffu);
    const double a = w->f[i], b = w->f[j], u = (w->level - a) / (b - a);
    int c;
    /* the values may be so far apart that their difference overflows */
    const double s = isfinite(b - a) ? u : (w->level / 2 - a / 2) / (b / 2 - a / 2);
    for (c = 0; c < 3; c++) {
        const double x = w->mesh->xyz[3 * i + (size_t)c], y = w->mesh->xyz[3 * j + (size_t)c];
        p[c] = s <= 0 ? x : s >= 1 ? y : lev_between(x, y, s);
    }
}

static int lev_join(lev_work *w, uint64_t a, uint64_t b)
{
    if (!lev_room((void **)&w->segment, w->n_segments, &w->room_segments, sizeof *w->segment)) return 0;
    w->segment[w->n_segments].edge[0] = a;
    w->segment[w->n_segments++].edge[1] = b;
    return 1;
}

/* The segments of a face: from each crossing to the next one around a run of corners on one side, the side
 * whose parts are apart. */
static int lev_face(lev_work *w, const int32_t *v, int64_t k)
{
    const double *f = w->f;
    double sum = 0;
    int64_t p, q;
    int apart;
    for (p = 0; p < k; p++) {
        if (!isfinite(f[v[p]])) return 1;
        sum += f[v[p]] / (double)k;
    }
    apart = !(sum >= w->level);
    for (p = 0; p < k; p++) {
        const int64_t before = p > 0 ? p - 1 : k - 1;
        if ((f[v[p]] >= w->level) != apart || (f[v[before]] >= w->level) == apart) continue;
        /* a run of the side that is apart begins at p and ends before q */
        for (q = (p + 1) % k; (f[v[q]] >= w->level) == apart; q = (q + 1) % k) { }
        if (!lev_join(w, lev_edge(v[before], v[p]), lev_edge(v[q > 0 ? q - 1 : k - 1], v[q]))) return 0;
    }
    return 1;
}

static int lev_compare(const void *pa, const void *pb)
{
    const uint64_t a = *(const uint64_t *)pa, b = *(const uint64_t *)pb;
    return a < b ? -1 : a > b;
}

static int64_t lev_node(const lev_work *w, uint64_t edge)
{
    int64_t lo = 0, hi = w->n_nodes;
    while (hi - lo > 1) {
        const int64_t mid = lo + (hi - lo) / 2;
        if (w->node[mid] <= edge) lo = mid;
        else hi = mid;
    }
    return lo;
}

/* Nodes, and the segments at each. */
static int lev_graph(lev_work *w)
{
    const size_t n = (size_t)w->n_segments;
    int64_t i;
    w->node = (uint64_t *)malloc((2 * n + 1) * sizeof *w->node);
    w->start = (int64_t *)calloc(2 * n + 2, sizeof *w->start);
    w->at = (int64_t *)malloc((2 * n + 1) * sizeof *w->at);
    w->used = (char *)calloc(n + 1, 1);
    if (!w->node || !w->start || !w->at || !w->used) return 0;
    for (i = 0; i < 2 * w->n_segments; i++) w->node[i] = w->segment[i / 2].edge[i % 2];
    qsort(w->node, 2 * n, sizeof *w->node, lev_compare);
    for (i = 0; i < 2 * w->n_segments; i++)
        if (i == 0 || w->node[i] != w->node[i - 1]) w->node[w->n_nodes++] = w->node[i];
    for (i = 0; i < 2 * w->n_segments; i++) w->start[lev_node(w, w->segment[i / 2].edge[i % 2]) + 1]++;
    for (i = 0; i < w->n_nodes; i++) w->start[i + 1] += w->start[i];
    for (i = 2 * w->n_segments - 1; i >= 0; i--) {
        const int64_t k = lev_node(w, w->segment[i / 2].edge[i % 2]);
        w->at[--w->start[k + 1]] = i / 2;
    }
    /* start[k + 1] is now where node k begins */
    memmove(w->start, w->start + 1, (size_t)w->n_nodes * sizeof *w->start);
    w->start[w->n_nodes] = 2 * w->n_segments;
    return 1;
}

static int lev_add_point(lev_set *s, lev_line *line, const double *p)
{
    double d[3];
    int c;
    if (line->count > 0) {
        for (c = 0; c < 3; c++) d[c] = p[c] - s->xyz[3 * (s->n_points - 1) + c];
        if (d[0] == 0 && d[1] == 0 && d[2] == 0) return 1;           /* through a vertex */
        line->length += sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    if (!lev_room((void **)&s->xyz, s->n_points, &s->room_points, 3 * sizeof *s->xyz)) return 0;
    memcpy(s->xyz + 3 * s->n_points++, p, 3 * sizeof *p);
    line->count++;
    return 1;
}

/* Follows unused segments from a node that has one to a node that is not simple, or back. */
static int lev_follow(lev_work *w, lev_set *s, int64_t from)
{
    lev_line line;
    double p[3];
    int64_t here = from, k, i;
    memset(&line, 0, sizeof line);
    line.level = w->level;
    line.first = s->n_points;
    lev_point(w, w->node[here], p);
    if (!lev_add_point(s, &line, p)) return 0;
    do {
        /* There is an unused one: at the beginning by the caller's word, later because the second segment of
         * a node is used only together with the first. */
        for (i = w->start[here]; w->used[w->at[i]]; i++) { }
        k = w->at[i];
        w->used[k] = 1;
        here = lev_node(w, w->segment[k].edge[w->segment[k].edge[0] == w->node[here]]);
        lev_point(w, w->node[here], p);
        if (!lev_add_point(s, &line, p)) return 0;
    } while (here != from && w->start[here + 1] - w->start[here] == 2);
    line.closed = here == from && line.count > 2;
    if (line.closed) {                           /* the first point was added again */
        line.count--;
        s->n_points--;
    }
    if (line.count < 2 || (line.closed && line.count < 3)) {             /* a single place, or to and fro */
        s->n_points = line.first;
        return 1;
    }
    if (!lev_room((void **)&s->line, s->n_lines, &s->room_lines, sizeof *s->line)) return 0;
    s->line[s->n_lines++] = line;
    return 1;
}

/* Lines that end or branch, from their ends; then loops. */
static int lev_lines(lev_work *w, lev_set *s)
{
    int64_t i, p;
    int loops;
    for (loops = 0; loops < 2; loops++)
        for (i = 0; i < w->n_nodes; i++) {
            if (!loops && w->start[i + 1] - w->start[i] == 2) continue;
            for (p = w->start[i]; p < w->start[i + 1]; p++)
                if (!w->used[w->at[p]] && !lev_follow(w, s, i)) return 0;
        }
    return 1;
}

/* Adds the lines where the field f (a value per vertex) has this level. Returns 0 without memory. */
static int lev_trace(lev_set *s, const lev_mesh *mesh, const double *f, double level)
{
    lev_work w;
    int fine = 1;
    int32_t i;
    memset(&w, 0, sizeof w);
    w.mesh = mesh;
    w.f = f;
    w.level = level;
    for (i = 0; i < mesh->n_faces && fine; i++) {
        const int64_t first = mesh->face_ptr[i];
        fine = lev_face(&w, mesh->face_idx + first, mesh->face_ptr[i + 1] - first);
    }
    if (fine) fine = lev_graph(&w) && lev_lines(&w, s);
    free(w.segment);
    free(w.node);
    free(w.start);
    free(w.at);
    free(w.used);
    return fine;
}

#endif
