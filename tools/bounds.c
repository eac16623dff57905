/* bounds.c - the error bounds that heatdiff.h reports, held against the true errors

   Build and run from the project's folder:

       gcc -O2 tools/bounds.c -o bounds -lquadmath -lm && ./bounds --count 100000

   Small shapes, good and bad, are asked everything that the library answers, by every method. The truth is
   that of the exact doubles in the pair (L, B): all eigenpairs by dense elimination and QL in numbers of 192
   bits, then sums in numbers of 113 bits. Where the library defines the rows of L to sum to zero, so do we:
   the diagonal is minus the sum of the others, exactly. (A caller's own L whose rows sum to more than their
   rounding is taken as it is.)

   bounds [--quick] [--count N] [--seed S] [--query NAME] [--shape NAME] [--method NAME] [--op NAME]
          [--table ROWS:COLUMNS] [--csv FILE]
   bounds --case "shape=grid/9/6 op=fem query=column t=1e-3 ..."
   bounds --self

   --quick    the small version: the fixed cases and some thousand comparisons on the smaller shapes
   --count    comparisons, in all; default 1000000
   --seed     of the cases that are drawn; default 1
   --query, --shape, --method, --op   only cases whose query, shape, method or operator contains this
   --table    also prints a Markdown table with these rows and columns, each shape, op, t, query or method.
              A cell says how many answers were compared, the largest true error / bound and its median. May
              be given several times
   --csv      a line for every comparison goes to this file
   --case     one case, as the table's footnotes and the lines of the file name it; what is left out is the
              default. Everything about it is printed
   --shrink   bounds are multiplied by this before the comparison: below one, the comparison must find fault
   --self     only the checks of this program itself, which every run begins with

   A comparison is one column of an answer (or one list of entries, pairs or edges) against the bounds
   reported for it. The table's columns:
     compared   comparisons made
     errors     calls that ended with an honest error (status < 0), not compared
     warned     comparisons whose status was HD_WARN_ACCURACY
     below      how often error_bound was smaller than the truth by more than the truth's own error: must be 0
     below B    the same of error_bound_b, in the norm of B
     below rel  the same of error_relative, of each value relative to itself
     useless    HD_OK together with a bound above 0.01 or not finite: must be 0
     bad        a value or a bound that is not a number where the truth is one: must be 0
     worst      the largest true error / bound, of the three, without what the truth itself may be wrong by
     median     of true error / error_bound, and of true error / error_bound_b
     stored     for every eighth case on a shape with rows that sum to zero: how often error_bound is below
   the truth of L as it is stored, rounded diagonal included (only told, not a fault) The exit status is 1
   when any count that must be 0 is not.

   The truth's own error: eigenvalues are good to n 2^-178 of the largest, terms to 2^-104 of themselves; what
   that makes of each value is summed up beside it and allowed for. It matters where a bound is zero or next
   to nothing is left of the answer; the last line says how often. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"    /* headers of helpers: not all are used here */
#pragma GCC diagnostic ignored "-Wpedantic"           /* constants of 113 bits */
#endif

#include <float.h>
#include <math.h>
#include <quadmath.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "shapes.h"

__extension__ typedef __float128 quad;
__extension__ typedef unsigned __int128 uint128;

static void stop(const char *what) {
    fprintf(stderr, "bounds: %s\n", what);
    exit(2);
}

static void *room(int64_t count, size_t size) {
    void *p = calloc(count > 0 ? (size_t)count : 1, size);
    if (!p) stop("out of memory");
    return p;
}

#define ROOM(type, count) ((type *)room((int64_t)(count), sizeof(type)))

/* ==== [1] numbers of 192 bits ==== */
/* A number is sign * 0.m * 2^e: m in three words, the lowest first, the top bit of the highest set; sign 0 is
 * zero. Results are cut off, not rounded: relative errors are below 2^-189. */

enum { LIMBS = 3, WIDE_BITS = 64 * LIMBS };

typedef struct wide { uint64_t m[LIMBS]; int64_t e; int sign; } wide;

static wide w_zero(void) {
    wide r;
    memset(&r, 0, sizeof r);
    return r;
}

static wide w_double(double x) {
    wide r = w_zero();
    int e = 0;
    if (x == 0) return r;
    r.m[LIMBS - 1] = (uint64_t)ldexp(frexp(fabs(x), &e), 53) << 11;
    r.e = e;
    r.sign = x < 0 ? -1 : 1;
    return r;
}

static quad w_quad(wide a) {
    quad q = 0;
    int k;
    for (k = 0; k < LIMBS; k++) q = (q + (quad)a.m[k]) * 0x1p-64Q;
    return a.sign == 0 ? 0 : ldexpq(a.sign < 0 ? -q : q, (int)a.e);
}

static wide w_neg(wide a) {
    a.sign = -a.sign;
    return a;
}

static wide w_half(wide a) {
    a.e--;
    return a;
}

/* Left until the top bit is set. */
static wide w_normal(wide a) {
    int words = 0, bits, k;
    while (words < LIMBS && a.m[LIMBS - 1 - words] == 0) words++;
    if (words == LIMBS) return w_zero();
    bits = __builtin_clzll((unsigned long long)a.m[LIMBS - 1 - words]);
    for (k = LIMBS - 1; k >= 0; k--) {
        const uint64_t high = k >= words ? a.m[k - words] : 0, low = k > words ? a.m[k - words - 1] : 0;
        a.m[k] = bits ? high << bits | low >> (64 - bits) : high;
    }
    a.e -= 64 * words + bits;
    return a;
}

/* |a| < |b| */
static int w_smaller(const wide *a, const wide *b) {
    int k;
    if (!a->sign || !b->sign) return !a->sign && b->sign;
    if (a->e != b->e) return a->e < b->e;
    for (k = LIMBS - 1; k >= 0; k--)
        if (a->m[k] != b->m[k]) return a->m[k] < b->m[k];
    return 0;
}

static wide w_add(wide a, wide b) {
    int64_t shift;
    int words, bits, k;
    uint64_t carry = 0;
    if (w_smaller(&a, &b)) {
        const wide keep = a;
        a = b;
        b = keep;
    }
    shift = a.e - b.e;
    if (!b.sign || shift >= WIDE_BITS) return a;
    words = (int)(shift / 64);
    bits = (int)(shift % 64);
    for (k = 0; k < LIMBS; k++) {                /* b to the right */
        const uint64_t low = k + words < LIMBS ? b.m[k + words] : 0,
                       high = k + words + 1 < LIMBS ? b.m[k + words + 1] : 0;
        b.m[k] = bits ? low >> bits | high << (64 - bits) : low;
    }
    if (a.sign == b.sign) {
        for (k = 0; k < LIMBS; k++) {
            const uint128 t = (uint128)a.m[k] + b.m[k] + carry;
            a.m[k] = (uint64_t)t;
            carry = (uint64_t)(t >> 64);
        }
        if (!carry) return a;
        for (k = 0; k < LIMBS; k++) a.m[k] = a.m[k] >> 1 | (k + 1 < LIMBS ? a.m[k + 1] : 1) << 63;
        a.e++;
        return a;
    }
    for (k = 0; k < LIMBS; k++) {
        const uint128 t = (uint128)a.m[k] - b.m[k] - carry;
        a.m[k] = (uint64_t)t;
        carry = (uint64_t)(t >> 64) & 1;
    }
    return a.m[LIMBS - 1] >> 63 ? a : w_normal(a);
}

static wide w_sub(wide a, wide b) { return w_add(a, w_neg(b)); }

static wide w_mul(wide a, wide b) {
    uint64_t p[2 * LIMBS];
    wide r;
    int i, j;
    if (!a.sign || !b.sign) return w_zero();
    memset(p, 0, sizeof p);
    for (i = 0; i < LIMBS; i++) {
        uint64_t carry = 0;
        for (j = 0; j < LIMBS; j++) {
            const uint128 t = (uint128)a.m[i] * b.m[j] + p[i + j] + carry;
            p[i + j] = (uint64_t)t;
            carry = (uint64_t)(t >> 64);
        }
        p[i + LIMBS] = carry;
    }
    r.e = a.e + b.e;
    r.sign = a.sign * b.sign;
    if (p[2 * LIMBS - 1] >> 63) {
        memcpy(r.m, p + LIMBS, sizeof r.m);
    } else {
        for (i = 0; i < LIMBS; i++) r.m[i] = p[LIMBS + i] << 1 | p[LIMBS + i - 1] >> 63;
        r.e--;
    }
    return r;
}

/* 1/a by Newton, three steps from a double. */
static wide w_recip(wide a) {
    const int64_t e = a.e;
    const wide one = w_double(1);
    wide x;
    int k, sign = a.sign;
    if (!sign) stop("division by zero");
    a.e = 0;
    a.sign = 1;
    x = w_double(1 / ldexp((double)a.m[LIMBS - 1], -64));
    for (k = 0; k < 3; k++) x = w_add(x, w_mul(x, w_sub(one, w_mul(a, x))));
    x.e -= e;
    x.sign = sign;
    return x;
}

static wide w_div(wide a, wide b) { return w_mul(a, w_recip(b)); }

/* The root of a >= 0, as a/sqrt(a), by Newton. */
static wide w_sqrt(wide a) {
    const wide one = w_double(1);
    wide f = a, x;
    int k;
    if (a.sign <= 0) return w_zero();
    f.e = a.e & 1;                               /* in [1/2, 2) */
    x = w_double(1 / sqrt(ldexp((double)f.m[LIMBS - 1], (int)f.e - 64)));
    for (k = 0; k < 3; k++) x = w_add(x, w_half(w_mul(x, w_sub(one, w_mul(f, w_mul(x, x))))));
    x.e -= (a.e - f.e) / 2;
    return w_mul(a, x);
}

/* ==== [2] dense eigenvalues ==== */
/* Matrices n x n by columns: (i,j) is at a[j n + i]. Householder's tridiagonal form and implicit QL as
 * EISPACK's tred2 and tql2 have them (Bowdler, Martin, Reinsch, Wilkinson 1968). */

static void tridiagonal(wide *a, int n, wide *d, wide *e) {
    int i, j, k;
    for (j = 0; j < n; j++) d[j] = a[j * n + n - 1];
    for (i = n - 1; i > 0; i--) {
        wide h = w_zero(), f, g, hh;
        for (k = 0; k < i; k++) h = w_add(h, w_mul(d[k], d[k]));
        if (!h.sign) {
            e[i] = w_zero();
            for (j = 0; j < i; j++) {
                d[j] = a[j * n + i - 1];
                a[j * n + i] = a[i * n + j] = w_zero();
            }
            d[i] = h;
            continue;
        }
        f = d[i - 1];
        g = w_sqrt(h);
        if (f.sign > 0) g = w_neg(g);
        e[i] = g;
        h = w_sub(h, w_mul(f, g));
        d[i - 1] = w_sub(f, g);
        for (j = 0; j < i; j++) e[j] = w_zero();
        for (j = 0; j < i; j++) {
            const wide *column = a + j * n;
            f = d[j];
            a[i * n + j] = f;
            g = w_add(e[j], w_mul(column[j], f));
            for (k = j + 1; k < i; k++) {
                g = w_add(g, w_mul(column[k], d[k]));
                e[k] = w_add(e[k], w_mul(column[k], f));
            }
            e[j] = g;
        }
        hh = w_recip(h);
        f = w_zero();
        for (j = 0; j < i; j++) {
            e[j] = w_mul(e[j], hh);
            f = w_add(f, w_mul(e[j], d[j]));
        }
        hh = w_half(w_mul(f, hh));
        for (j = 0; j < i; j++) e[j] = w_sub(e[j], w_mul(hh, d[j]));
        for (j = 0; j < i; j++) {
            f = d[j];
            g = e[j];
            for (k = j; k < i; k++) a[j * n + k] = w_sub(a[j * n + k], w_add(w_mul(f, e[k]), w_mul(g, d[k])));
            d[j] = a[j * n + i - 1];
            a[j * n + i] = w_zero();
        }
        d[i] = h;
    }
    for (i = 0; i < n - 1; i++) {                /* the product of the reflections */
        a[i * n + n - 1] = a[i * n + i];
        a[i * n + i] = w_double(1);
        if (d[i + 1].sign) {
            const wide r = w_recip(d[i + 1]);
            for (k = 0; k <= i; k++) d[k] = w_mul(a[(i + 1) * n + k], r);
            for (j = 0; j <= i; j++) {
                wide g = w_zero();
                for (k = 0; k <= i; k++) g = w_add(g, w_mul(a[(i + 1) * n + k], a[j * n + k]));
                for (k = 0; k <= i; k++) a[j * n + k] = w_sub(a[j * n + k], w_mul(g, d[k]));
            }
        }
        for (k = 0; k <= i; k++) a[(i + 1) * n + k] = w_zero();
    }
    for (j = 0; j < n; j++) {
        d[j] = a[j * n + n - 1];
        a[j * n + n - 1] = w_zero();
    }
    a[n * n - 1] = w_double(1);
    e[0] = w_zero();
}

static wide w_hypot(wide a, wide b) { return w_sqrt(w_add(w_mul(a, a), w_mul(b, b))); }

static void ql(wide *a, int n, wide *d, wide *e) {
    wide f = w_zero(), most = w_zero();
    int i, k, l, m, steps;
    for (i = 1; i < n; i++) e[i - 1] = e[i];
    e[n - 1] = w_zero();
    for (l = 0; l < n; l++) {
        wide size = d[l], tiny = e[l];
        size.sign = size.sign != 0;
        tiny.sign = tiny.sign != 0;
        size = w_add(size, tiny);
        if (w_smaller(&most, &size)) most = size;
        tiny = most;
        tiny.e -= WIDE_BITS - 3;
        for (m = l; m < n - 1 && w_smaller(&tiny, e + m); m++) {}
        for (steps = 0; m > l && w_smaller(&tiny, e + l); steps++) {
            const wide one = w_double(1), el1 = e[l + 1];
            wide g = d[l], p = w_half(w_div(w_sub(d[l + 1], g), e[l])), r = w_hypot(p, one), h, dl1, c = one,
                 c2 = one, c3 = one, s = w_zero(), s2 = s;
            if (steps == 200) stop("QL does not converge");
            if (p.sign < 0) r = w_neg(r);
            d[l] = w_div(e[l], w_add(p, r));
            d[l + 1] = w_mul(e[l], w_add(p, r));
            dl1 = d[l + 1];
            h = w_sub(g, d[l]);
            for (i = l + 2; i < n; i++) d[i] = w_sub(d[i], h);
            f = w_add(f, h);
            p = d[m];
            for (i = m - 1; i >= l; i--) {
                wide *x = a + i * n, *y = x + n;
                c3 = c2;
                c2 = c;
                s2 = s;
                g = w_mul(c, e[i]);
                h = w_mul(c, p);
                r = w_hypot(p, e[i]);
                e[i + 1] = w_mul(s, r);
                if (!r.sign) {
                    s = w_zero();
                    c = one;
                } else {
                    const wide q = w_recip(r);
                    s = w_mul(e[i], q);
                    c = w_mul(p, q);
                }
                p = w_sub(w_mul(c, d[i]), w_mul(s, g));
                d[i + 1] = w_add(h, w_mul(s, w_add(w_mul(c, g), w_mul(s, d[i]))));
                for (k = 0; k < n; k++) {
                    const wide t = y[k];
                    y[k] = w_add(w_mul(s, x[k]), w_mul(c, t));
                    x[k] = w_sub(w_mul(c, x[k]), w_mul(s, t));
                }
            }
            if (!dl1.sign) stop("QL breaks down");
            p = w_neg(w_div(w_mul(w_mul(s, s2), w_mul(w_mul(c3, el1), e[l])), dl1));
            e[l] = w_mul(s, p);
            d[l] = w_mul(c, p);
        }
        d[l] = w_add(d[l], f);
        e[l] = w_zero();
    }
}

/* ==== [3] the truth ==== */

/* All eigenpairs of L x = lambda B x. Modes are grouped by component, ascending in each; x and y = B x by
 * rows, zero outside of the row's own component. A pair that conserves heat has lambda = 0 exactly in the
 * first mode of each component. */
typedef struct truth {
    int32_t n, n_comp;
    int conserves;
    quad *lambda, *x, *y;
    double *xd, *yd;             /* |x|, |y| */
    int32_t *comp, *first;       /* of a row; [n_comp + 1] modes of a component */
    double off;                  /* bound on the errors of lambda */
    double edge, top;            /* the smallest and largest |lambda| that is not zero */
    double x_most, y_most;
} truth;

static void truth_free(truth *T) {
    free(T->lambda);
    free(T->x);
    free(T->y);
    free(T->xd);
    free(T->yd);
    free(T->comp);
    free(T->first);
    memset(T, 0, sizeof *T);
}

static double mass_entry(const hd_laplacian *lap, int32_t i, int64_t p) {
    return lap->B ? lap->B[p] : lap->L.col[p] == i ? lap->mass[i] : 0;
}

static int32_t find(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Components of the entries of L and B that are not zero, numbered by their first row. Returns how many. */
static int32_t truth_components(const hd_laplacian *lap, int32_t *comp) {
    const int32_t n = lap->n_active;
    int32_t *parent = ROOM(int32_t, n), i, count = 0;
    int64_t p;
    for (i = 0; i < n; i++) parent[i] = i;
    for (i = 0; i < n; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.val[p] != 0 || mass_entry(lap, i, p) != 0) {
                const int32_t a = find(parent, i), b = find(parent, lap->L.col[p]);
                parent[a > b ? a : b] = a > b ? b : a;
            }
    for (i = 0; i < n; i++) comp[i] = find(parent, i) == i ? count++ : comp[find(parent, i)];
    free(parent);
    return count;
}

/* Is what the rows of L sum to no more than rounding? The sums are exact. */
static int sums_are_rounding(const hd_laplacian *lap) {
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        wide sum = w_zero();
        double size = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            sum = w_add(sum, w_double(lap->L.val[p]));
            size += fabs(lap->L.val[p]);
        }
        if (fabsq(w_quad(sum)) >
            (quad)size * (quad)(lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) * (quad)DBL_EPSILON)
            return 0;
    }
    return 1;
}

/* One component: rows[0..m), its modes from `at` on. exact: the diagonal of L is minus the sum of the row's
 * others. */
static int truth_component(truth *T, const hd_laplacian *lap, const int32_t *rows, int32_t m, int32_t at,
                           int exact) {
    wide *L = ROOM(wide, m * m), *G = ROOM(wide, m * m), *d = ROOM(wide, m), *e = ROOM(wide, m),
         total = w_zero();
    int32_t *place = ROOM(int32_t, T->n), *order = ROOM(int32_t, m), i, j, k;
    int ok = 1;
    int64_t p;
    for (i = 0; i < T->n; i++) place[i] = -1;
    for (i = 0; i < m; i++) place[rows[i]] = i;
    for (i = 0; i < m; i++) {
        wide sum = w_zero();
        for (p = lap->L.row_ptr[rows[i]]; p < lap->L.row_ptr[rows[i] + 1]; p++) {
            const wide b = w_double(mass_entry(lap, rows[i], p)), l = w_double(lap->L.val[p]);
            j = place[lap->L.col[p]];
            if (j < 0) continue;
            L[j * m + i] = w_add(L[j * m + i], w_half(l));   /* the mean of the entry and its mirror */
            L[i * m + j] = w_add(L[i * m + j], w_half(l));
            G[j * m + i] = b;
            total = w_add(total, b);
            if (j != i) sum = w_add(sum, l);
        }
        if (exact) e[i] = w_neg(sum);
    }
    for (i = 0; i < m && exact; i++) L[i * m + i] = e[i];
    for (j = 0; j < m && ok; j++) {              /* B = G G', G lower triangular */
        for (k = 0; k < j; k++) {
            if (!G[k * m + j].sign) continue;
            for (i = j; i < m; i++)
                if (G[k * m + i].sign) G[j * m + i] = w_sub(G[j * m + i], w_mul(G[k * m + i], G[k * m + j]));
        }
        ok = G[j * m + j].sign > 0;
        if (!ok) break;
        G[j * m + j] = w_sqrt(G[j * m + j]);
        d[j] = w_recip(G[j * m + j]);
        for (i = j + 1; i < m; i++) G[j * m + i] = w_mul(G[j * m + i], d[j]);
    }
    for (k = 0; k < 2 && ok; k++) {              /* L = G^-1 L, transposed; twice */
        for (j = 0; j < m; j++) {
            wide *column = L + j * m;
            int32_t q;
            for (i = 0; i < m; i++) {
                column[i] = w_mul(column[i], d[i]);
                for (q = i + 1; q < m; q++)
                    if (G[i * m + q].sign) column[q] = w_sub(column[q], w_mul(G[i * m + q], column[i]));
            }
        }
        for (j = 0; j < m; j++)
            for (i = 0; i < j; i++) {
                const wide t = L[j * m + i];
                L[j * m + i] = L[i * m + j];
                L[i * m + j] = t;
            }
    }
    if (ok) {
        wide *diag = ROOM(wide, m);
        memcpy(diag, d, (size_t)m * sizeof *diag);
        tridiagonal(L, m, d, e);
        ql(L, m, d, e);
        for (i = 0; i < m; i++) {                /* ascending; zero comes first */
            for (j = i; j > 0 && w_sub(d[order[j - 1]], d[i]).sign > 0; j--) order[j] = order[j - 1];
            order[j] = i;
        }
        if (exact) {
            /* the one of the constant is the smallest in size */
            for (i = 1, k = 0; i < m; i++)
                if (w_smaller(d + order[i], d + order[k])) k = i;
            j = order[k];
            memmove(order + 1, order, (size_t)k * sizeof *order);
            order[0] = j;
        }
        for (k = 0; k < m; k++) {
            const int zero = exact && k == 0;
            wide *v = L + order[k] * m;
            const quad lambda = zero ? 0 : w_quad(d[order[k]]);
            T->lambda[at + k] = lambda;
            if ((double)fabsq(lambda) > T->top) T->top = (double)fabsq(lambda);
            for (i = 0; i < m; i++) {            /* y = G v */
                wide sum = w_zero();
                for (j = 0; j <= i; j++)
                    if (G[j * m + i].sign) sum = w_add(sum, w_mul(G[j * m + i], v[j]));
                T->y[rows[i] * T->n + at + k] = w_quad(sum);
            }
            for (i = m - 1; i >= 0; i--) {       /* x = G'^-1 v */
                for (j = i + 1; j < m; j++)
                    if (G[i * m + j].sign) v[i] = w_sub(v[i], w_mul(G[i * m + j], v[j]));
                v[i] = w_mul(v[i], diag[i]);
                T->x[rows[i] * T->n + at + k] = w_quad(v[i]);
            }
            if (zero) {
                const wide one = w_recip(w_sqrt(total));
                for (i = 0; i < m; i++) {
                    wide sum = w_zero();
                    for (p = lap->L.row_ptr[rows[i]]; p < lap->L.row_ptr[rows[i] + 1]; p++)
                        sum = w_add(sum, w_double(mass_entry(lap, rows[i], p)));
                    T->x[rows[i] * T->n + at] = w_quad(one);
                    T->y[rows[i] * T->n + at] = w_quad(w_mul(sum, one));
                }
            }
        }
        free(diag);
    }
    free(L);
    free(G);
    free(d);
    free(e);
    free(place);
    free(order);
    return ok;
}

/* 0: B is not positive definite. */
static int truth_make(truth *T, const hd_laplacian *lap, int exact) {
    const int32_t n = lap->n_active;
    int32_t *rows = ROOM(int32_t, n), c, i, m;
    int ok = 1;
    memset(T, 0, sizeof *T);
    T->n = n;
    T->conserves = exact;
    T->lambda = ROOM(quad, n);
    T->x = ROOM(quad, n * n);
    T->y = ROOM(quad, n * n);
    T->xd = ROOM(double, n * n);
    T->yd = ROOM(double, n * n);
    T->comp = ROOM(int32_t, n);
    T->n_comp = truth_components(lap, T->comp);
    T->first = ROOM(int32_t, T->n_comp + 1);
    for (c = 0; c < T->n_comp && ok; c++) {
        for (i = 0, m = 0; i < n; i++)
            if (T->comp[i] == c) rows[m++] = i;
        ok = truth_component(T, lap, rows, m, T->first[c],
                             exact && isfinite(lap->component_mass[lap->component[rows[0]]]));
        T->first[c + 1] = T->first[c] + m;
    }
    for (i = 0; i < n * n; i++) {
        T->xd[i] = (double)fabsq(T->x[i]);
        T->yd[i] = (double)fabsq(T->y[i]);
        T->x_most = fmax(T->x_most, T->xd[i]);
        T->y_most = fmax(T->y_most, T->yd[i]);
    }
    T->off = T->top * ldexp(n, -WIDE_BITS + 14);   /* n eps |L|, and some room */
    T->edge = T->top;
    /* (a pair that need not conserve heat may do so up to rounding) */
    for (i = 0; i < n; i++)
        if ((double)fabsq(T->lambda[i]) > T->off) T->edge = fmin(T->edge, (double)fabsq(T->lambda[i]));
    if (exact && T->off > 1e-18 * T->edge)
        fprintf(stderr, "bounds: note: eigenvalues of %g beside %g\n", T->edge, T->top);
    free(rows);
    if (!ok) truth_free(T);
    return ok;
}

/* What the truth is to be made for: exp(-t lambda) or poles of one's own, 1/lambda, 1/lambda^2, the
 * derivative -lambda exp(-t lambda), a filter by its formula; or the square of the first. */
typedef enum form { FORM_HEAT, FORM_COMMUTE, FORM_BIHARMONIC, FORM_DERIVATIVE, FORM_FILTER } form;

/* Filters are evaluated in doubles. */
#define FILTER_OFF 1e-13

/* A function of every lambda, and what each term is off by relative to itself; last: where the modes of a
 * component end that count. */
typedef struct filter {
    quad *g;
    double *off, cut;
    int32_t *last;
    hd_filter of;                /* FORM_FILTER */
} filter;

static filter filter_make(const truth *T) {
    filter f;
    f.g = ROOM(quad, T->n);
    f.off = ROOM(double, T->n);
    f.last = ROOM(int32_t, T->n_comp);
    f.cut = 0;
    memset(&f.of, 0, sizeof f.of);
    return f;
}

static void filter_free(filter *f) {
    free(f->g);
    free(f->off);
    free(f->last);
}

/* c(x), and how much rounding there is in it. */
static quad rational(const hd_rational *set, quad x, double *off) {
    quad sum = set->a0, size = fabsq(sum);
    int32_t p;
    for (p = 0; p < set->n_poles; p++) {         /* a/(x - theta) = a conj(x - theta)/|x - theta|^2 */
        const quad re = x - set->theta[p].re, im = -(quad)set->theta[p].im, d = re * re + im * im,
                   a = set->a[p].re, b = set->a[p].im;
        const quad count = set->theta[p].im != 0 ? 2 : 1;
        sum += count * (a * re + b * im) / d;
        size +=
            count * (fabsq(a) + fabsq(b)) * (fabsq(x) + fabsq(set->theta[p].re) + fabsq(im) + fabsq(re)) / d;
    }
    *off = sum == 0 ? 0 : (double)(size / fabsq(sum)) * 0x1p-104;
    return sum;
}

static void filter_fill(filter *f, const truth *T, form what, double t, const hd_rational *own, int squared) {
    int32_t c, l;
    f->cut = 0;
    for (c = 0; c < T->n_comp; c++) {
        f->last[c] = T->first[c + 1];
        for (l = T->first[c]; l < T->first[c + 1]; l++) {
            const quad lambda = T->lambda[l], x = -(quad)t * lambda;
            double off = lambda == 0 ? 0 : T->off / (double)fabsq(lambda);
            quad g;
            if (what == FORM_COMMUTE) g = lambda == 0 ? 0 : 1 / lambda;
            else if (what == FORM_BIHARMONIC) g = lambda == 0 ? 0 : 1 / (lambda * lambda);
            else if (what == FORM_FILTER) {
                g = hd_filter_eval(&f->of, (double)lambda > 0 ? (double)lambda : 0);
                off = FILTER_OFF;
            } else if (own) g = rational(own, x, &off);
            else {
                off = (double)(fabsq(x) * 0x1p-108Q + (lambda == 0 ? 0 : (quad)t * (quad)T->off)) + 0x1p-104;
                g = x < -11000 ? 0 : expq(x);
                if (what == FORM_DERIVATIVE) {
                    off += lambda == 0 ? 0 : T->off / (double)fabsq(lambda);
                    g *= -lambda;
                }
            }
            if (squared) g *= g;
            f->g[l] = g;
            f->off[l] = (2 * off + 0x1p-104) * (double)fabsq(g);
            if ((what == FORM_HEAT || what == FORM_DERIVATIVE) && !own && x < -200) {   /* smaller from here on */
                f->last[c] = l;
                f->cut = what == FORM_HEAT ? 1.4e-87 : 1.4e-87 * T->top;
                break;
            }
        }
    }
}

/* sum_l left(i,l) g_l w_l over the modes of component c; *off: bound on its error. Terms beyond the cut are
 * counted in it. */
static quad truth_sum(const truth *T, const filter *f, int32_t c, const quad *left, const double *left_abs,
                      const quad *gw, const double *gw_off, double beyond, double *off) {
    quad sum = 0;
    double err = f->cut * beyond;
    int32_t l;
    for (l = T->first[c]; l < f->last[c]; l++) {
        sum += left[l] * gw[l];
        err += left_abs[l] * gw_off[l];
    }
    *off = err;
    return sum;
}

/* ==== [4] shapes ==== */

/* A shape by name, "grid/9/6": what it is and up to four numbers. */
typedef struct body {
    shape s;
    shape_poly p;
    hd_csr L;
    int points, matrix;
    uint64_t seed;               /* of the masses of a graph */
} body;

static double power10(uint64_t *seed, double lo, double hi) {
    return pow(10, lo + (hi - lo) * shape_uniform(seed));
}

static int draw(uint64_t *seed, int n) { return (int)(shape_uniform(seed) * n); }
static int chance(uint64_t *seed, double p) { return shape_uniform(seed) < p; }

/* m x m vertices, places given by the caller; triangles, and quadrilaterals too. */
static void lattice(body *b, int m) {
    int32_t i, j, t = 0;
    b->s = shape_make(m * m, 2 * (m - 1) * (m - 1));
    b->p = shape_poly_make(m * m, (m - 1) * (m - 1), 4 * (m - 1) * (m - 1));
    if (!b->s.xyz || !b->p.xyz) stop("out of memory");
    for (i = 0; i + 1 < m; i++)
        for (j = 0; j + 1 < m; j++) {
            const int32_t a = i * m + j;
            shape_put_triangle(&b->s, t++, a, a + m, a + 1);
            shape_put_triangle(&b->s, t++, a + 1, a + m, a + m + 1);
            shape_put_quad(&b->p, a, a + m, a + m + 1, a + 1);
        }
}

/* The icosahedron's faces cut into f^2: a sphere of 10 f^2 + 2 vertices. */
static shape sphere(int f) {
    shape ico = shape_icosphere(0), s = shape_make(10 * f * f + 2, 20 * f * f);
    int32_t *at = ROOM(int32_t, (f + 1) * (f + 1)), t, i, j, k, n = 0, m = 0;
    int c;
    if (!ico.xyz || !s.xyz) stop("out of memory");
    for (t = 0; t < 20; t++) {
        const int32_t *v = ico.tri + 3 * t;
        for (i = 0; i <= f; i++)
            for (j = 0; i + j <= f; j++) {
                double p[3], len;
                for (c = 0; c < 3; c++)
                    p[c] = (f - i - j) * ico.xyz[3 * v[0] + c] + i * ico.xyz[3 * v[1] + c] +
                           j * ico.xyz[3 * v[2] + c];
                len = sqrt(shape_dot(p, p));
                for (c = 0; c < 3; c++) p[c] /= len;
                for (k = 0; k < n && shape_distance(p, s.xyz + 3 * k) > 1e-9; k++) {}
                if (k == n) shape_put_vertex(&s, n++, p[0], p[1], p[2]);
                at[i * (f + 1) + j] = k;
            }
        for (i = 0; i < f; i++)
            for (j = 0; i + j < f; j++) {
                shape_put_triangle(&s, m++, at[i * (f + 1) + j], at[(i + 1) * (f + 1) + j],
                                   at[i * (f + 1) + j + 1]);
                if (i + j < f - 1)
                    shape_put_triangle(&s, m++, at[(i + 1) * (f + 1) + j], at[(i + 1) * (f + 1) + j + 1],
                                       at[i * (f + 1) + j + 1]);
            }
    }
    free(at);
    shape_free(&ico);
    return s;
}

/* Room for more vertices and triangles. */
static shape enlarge(shape *s, int32_t vertices, int32_t triangles) {
    shape r = shape_make(s->n + vertices, s->n_tri + triangles);
    if (!r.xyz) stop("out of memory");
    memcpy(r.xyz, s->xyz, 3 * (size_t)s->n * sizeof *s->xyz);
    memcpy(r.tri, s->tri, 3 * (size_t)s->n_tri * sizeof *s->tri);
    r.n = s->n;
    r.n_tri = s->n_tri;
    shape_free(s);
    return r;
}

/* The middle of an edge of triangle f moved h towards the third corner: two slivers and a thin triangle take
 * its place. */
static void put_sliver(shape *s, int32_t f, double h) {
    const int32_t a = s->tri[3 * f], b = s->tri[3 * f + 1], c = s->tri[3 * f + 2], k = s->n;
    int d;
    *s = enlarge(s, 1, 2);
    for (d = 0; d < 3; d++) {
        const double m = (s->xyz[3 * a + d] + s->xyz[3 * b + d]) / 2;
        s->xyz[3 * k + d] = m + (s->xyz[3 * c + d] - m) * h;
    }
    s->n++;
    shape_put_triangle(s, f, a, k, c);
    shape_put_triangle(s, s->n_tri++, k, b, c);
    shape_put_triangle(s, s->n_tri++, a, b, k);
}

/* Symmetric weights as a dense matrix, diagonals the sums of their rows and what is added. */
typedef struct weights { int n; double *w, *extra; double sign; } weights;

static void join(weights *g, int i, int j, double w) { g->w[i * g->n + j] = g->w[j * g->n + i] = w; }

static void csr_dense(hd_csr *out, const double *a, int n) {
    int32_t *I = ROOM(int32_t, n * n), *J = ROOM(int32_t, n * n);
    double *V = ROOM(double, n * n);
    int i, j, k = 0;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++)
            if (a[i * n + j] != 0) {
                I[k] = i;
                J[k] = j;
                V[k++] = a[i * n + j];
            }
    if (hd_csr_from_triplets(out, n, n, k, I, J, V, NULL, NULL) < 0) stop("triplets");
    free(I);
    free(J);
    free(V);
}

static void graph_matrix(body *b, weights *g) {
    int i, j;
    for (i = 0; i < g->n; i++) {
        double sum = 0;
        for (j = 0; j < g->n; j++) {
            if (i != j) sum += g->w[i * g->n + j];
            g->w[i * g->n + j] = -g->sign * g->w[i * g->n + j];
        }
        g->w[i * g->n + i] = g->sign * sum + g->extra[i];
    }
    csr_dense(&b->L, g->w, g->n);
    b->matrix = 1;
    free(g->w);
    free(g->extra);
}

/* "tree/n/s": the s-th random tree, where a little heat leaves at one vertex. */
static void random_tree(body *b, weights *g, const double *p) {
    uint64_t seed = 7 + (uint64_t)p[1];
    const int loose = chance(&seed, 0.5) ? 3 : g->n;     /* bushy, or hardly more than a path */
    int i;
    for (i = 1; i < g->n; i++)
        join(g, i, i - 1 - (int)((i < loose ? i : loose) * shape_uniform(&seed)), 1 + floor(7 * shape_uniform(&seed)));
    g->extra[(int)(g->n * shape_uniform(&seed))] = power10(&seed, -8, 0);
    b->seed = seed;
}

/* "graph/n/k": a random tree and n more edges, weights 1..7, one edge of 10^k; "lattice/m/k": a grid graph of
 * the same kind. */
static void random_graph(weights *g, const double *p, int grid) {
    uint64_t seed = 5 + (uint64_t)(97 * p[0] + p[1]);
    const int m = (int)p[0];
    int i;
    for (i = 1; i < g->n; i++) {
        const double w = 1 + floor(7 * shape_uniform(&seed));
        if (!grid) join(g, i, (int)(i * shape_uniform(&seed)), w);
        else if (i % m) join(g, i, i - 1, w);
        if (grid && i >= m) join(g, i, i - m, 1 + floor(7 * shape_uniform(&seed)));
    }
    for (i = 0; i < g->n && !grid; i++) {
        const int a = (int)(g->n * shape_uniform(&seed)), c = (int)(g->n * shape_uniform(&seed));
        if (a != c) join(g, a, c, 1 + floor(7 * shape_uniform(&seed)));
    }
    if (p[1] > 0) join(g, g->n / 2, g->n / 2 - 1, pow(10, p[1]));
}

static int make_graph(body *b, const char *name, const double *p) {
    weights g;
    int i;
    g.n = strcmp(name, "lattice") == 0 ? (int)(p[0] * p[0]) : (int)p[0];
    if (g.n < 1 || g.n > 400) return 0;
    g.w = ROOM(double, g.n * g.n);
    g.extra = ROOM(double, g.n);
    g.sign = 1;
    if (strcmp(name, "graph") == 0 || strcmp(name, "lattice") == 0) {
        random_graph(&g, p, name[0] == 'l');
    } else if (strcmp(name, "tree") == 0) {
        random_tree(b, &g, p);
    } else if (strcmp(name, "path") == 0) {
        for (i = 0; i + 1 < g.n; i++) join(&g, i, i + 1, 1);
    } else if (strcmp(name, "star") == 0) {
        for (i = 1; i < g.n; i++) join(&g, 0, i, 1);
    } else if (strcmp(name, "weak") == 0) {
        /* two cycles, or as many as p[2], in a chain of edges 2^-k */
        const int parts = p[2] > 1 ? (int)p[2] : 2, m = g.n / parts;
        if (m < 3) return 0;
        for (i = 0; i < parts * m; i++) join(&g, i, i % m == m - 1 ? i - m + 1 : i + 1, 1);
        for (i = 1; i < parts; i++) join(&g, (i - 1) * m, i * m, ldexp(1, -(int)p[1]));
        for (i = parts * m; i < g.n; i++) join(&g, i - 1, i, 1);
    } else if (strcmp(name, "none") != 0) {
        /* cycles: plain, turned, with something on one diagonal entry or on all */
        for (i = 0; i < g.n && g.n > 2; i++) join(&g, i, (i + 1) % g.n, 1);
        if (strcmp(name, "turned") == 0) g.sign = -1;
        else if (strcmp(name, "penalty") == 0) g.extra[0] = pow(10, p[1]);
        else if (strcmp(name, "leak") == 0) for (i = 0; i < g.n; i++) g.extra[i] = p[1];
        else if (strcmp(name, "cycle") != 0) return 0;
    }
    graph_matrix(b, &g);
    return 1;
}

static int make_mesh(body *b, const char *name, const double *p) {
    uint64_t seed = 3 + (uint64_t)(1000 * fabs(p[1]) + p[0]);
    const int m = (int)p[0];
    int i, j;
    if (strcmp(name, "grid") == 0 || strcmp(name, "strip") == 0) {
        /* side, power: graded either way, or one way */
        if (m < 2) return 0;
        lattice(b, m);
        for (i = 0; i < m; i++)
            for (j = 0; j < m; j++)
                shape_put_vertex(&b->s, i * m + j, pow((i + 0.5) / m, p[1]),
                                 name[0] == 'g' ? pow((j + 0.5) / m, p[1]) : (j + 0.5) / m, 0);
    } else if (strcmp(name, "bump") == 0 || strcmp(name, "split") == 0 || strcmp(name, "inert") == 0) {
        /* side, seed */
        if (m < 2) return 0;
        lattice(b, m);
        for (i = 0; i < m; i++)
            for (j = 0; j < m; j++) {
                const double dx = 0.35 * shape_signed(&seed), dy = 0.35 * shape_signed(&seed);
                shape_put_vertex(&b->s, i * m + j, (i + dx) / m, (j + dy) / m, 0.6 / m * shape_signed(&seed));
            }
        if (name[0] == 's') {
            /* cut along a line of vertices, which become two each */
            b->s = enlarge(&b->s, m, 0);
            for (j = 0; j < m; j++, b->s.n++)
                memcpy(b->s.xyz + 3 * b->s.n, b->s.xyz + 3 * (m / 2 * m + j), 3 * sizeof(double));
            for (i = 2 * (m / 2) * (m - 1); i < b->s.n_tri; i++)
                for (j = 0; j < 3; j++)
                    if (b->s.tri[3 * i + j] / m == m / 2 && b->s.tri[3 * i + j] < m * m)
                        b->s.tri[3 * i + j] += m * m - m / 2 * m;
        } else if (name[0] == 'i') {             /* two vertices in no face */
            b->s = enlarge(&b->s, 2, 0);
            for (j = 0; j < 2; j++) shape_put_vertex(&b->s, b->s.n++, j, 1, 2);
        }
        if (name[0] != 'b') shape_poly_free(&b->p);
    } else if (strcmp(name, "soup") == 0) {      /* m triangles, each for itself */
        b->s = shape_make(3 * m, m);
        for (i = 0; i < 9 * m; i++) b->s.xyz[i] = shape_signed(&seed);
        for (i = 0; i < m; i++) shape_put_triangle(&b->s, i, 3 * i, 3 * i + 1, 3 * i + 2);
    } else if (strcmp(name, "sphere") == 0 || strcmp(name, "sliver") == 0) {
        if (m < 1 || m > 4) return 0;
        b->s = sphere(m);
        if (name[1] == 'l') put_sliver(&b->s, 7, pow(10, -p[1]));
        for (i = 1; name[1] == 'l' && i < (int)p[2]; i++)
            put_sliver(&b->s, 7 + 3 * i, power10(&seed, -p[1], -2));
    } else if (strcmp(name, "two") == 0) {       /* two spheres, one 10^-k as large, so far off */
        shape large, small;
        double offset[3];
        if (m < 1 || m > 3) return 0;
        large = sphere(m);
        small = sphere(m);
        offset[0] = offset[1] = offset[2] = p[2];
        for (i = 0; i < 3 * small.n; i++) small.xyz[i] *= pow(10, -p[1]);
        b->s = shape_disjoint(&large, &small, offset);
        shape_free(&large);
        shape_free(&small);
    } else if (strcmp(name, "cone") == 0) {
        /* rings, corners of a ring: masses fall by 10^13 towards the tip */
        const int k = (int)p[1];
        int t = 0;
        if (m < 2 || k < 3) return 0;
        b->s = shape_make(m * k + 1, k + 2 * k * (m - 1));
        shape_put_vertex(&b->s, m * k, 0, 0, 0);
        for (i = 0; i < m; i++)
            for (j = 0; j < k; j++) {
                const double r = pow(10, -6.5 * i / (m - 1)), a = 6.283185307179586 * (j + 0.5 * (i % 2)) / k;
                shape_put_vertex(&b->s, i * k + j, r * cos(a), r * sin(a), r);
                if (i > 0) {
                    shape_put_triangle(&b->s, t++, (i - 1) * k + j, (i - 1) * k + (j + 1) % k, i * k + j);
                    shape_put_triangle(&b->s, t++, i * k + j, (i - 1) * k + (j + 1) % k, i * k + (j + 1) % k);
                }
                if (i == m - 1) shape_put_triangle(&b->s, t++, i * k + j, i * k + (j + 1) % k, m * k);
            }
        b->s.n_tri = t;
    } else if (strcmp(name, "fan") == 0) {
        /* triangles about a vertex, spokes of all lengths */
        if (m < 3) return 0;
        b->s = shape_make(m + 1, m - 1);
        shape_put_vertex(&b->s, m, 0, 0, 0.1);
        for (i = 0; i < m; i++) {
            const double r = power10(&seed, -p[1], 0), a = 6.0 * i / m;
            shape_put_vertex(&b->s, i, r * cos(a), r * sin(a), 0);
            if (i > 0) shape_put_triangle(&b->s, i - 1, m, i - 1, i);
        }
    } else if (strcmp(name, "five") == 0) {      /* three triangles */
        static const double xyz[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, .2, 2, 0, .1};
        static const int32_t tri[] = {0, 1, 2, 1, 3, 2, 1, 4, 3};
        b->s = shape_make(5, 3);
        memcpy(b->s.xyz, xyz, sizeof xyz);
        memcpy(b->s.tri, tri, sizeof tri);
    } else if (strcmp(name, "points") == 0) {
        /* number, 0 sphere, 1 torus, 2 square, blue or not */
        b->s = shape_points(m, p[1] == 0 ? shape_on_sphere : p[1] == 1 ? shape_on_torus : shape_on_square,
                            p[1] == 0 ? 12.566370614359172 : p[1] == 1 ? 78.95683520871486 : 1, p[2] > 0, 17);
        b->points = 1;
    } else {
        return 0;
    }
    if (!b->s.xyz) stop("out of memory");
    return 1;
}

static int body_make(body *b, const char *spec) {
    char name[16];
    double p[4] = {0, 0, 0, 0};
    memset(b, 0, sizeof *b);
    b->seed = 41;
    if (sscanf(spec, "%15[a-z]/%lf/%lf/%lf/%lf", name, p, p + 1, p + 2, p + 3) < 1) return 0;
    return make_mesh(b, name, p) || make_graph(b, name, p);
}

static void body_free(body *b) {
    shape_free(&b->s);
    shape_poly_free(&b->p);
    hd_csr_free(&b->L, NULL);
}

/* one thread: the answers do not depend on it, and small problems are quicker */
static hd_context serial;

/* B for a graph: "I", "diag" over twelve decades, "massN" over N, "tri" uneven, "near" the smallest eigenvalue
 * of which is 1e-9. */
static hd_status graph_pair(hd_laplacian **out, const body *b, const char *op, double scale, hd_error *e) {
    const int n = b->L.n_rows;
    double *a = ROOM(double, n * n);
    const double decades = strncmp(op, "mass", 4) == 0 ? atof(op + 4)
                           : strcmp(op, "diag") == 0   ? 12
                           : strcmp(op, "tri") == 0    ? 4
                                                       : 0;
    uint64_t seed = b->seed;
    hd_csr B;
    hd_laplacian_opts o;
    hd_status st;
    int i;
    memset(&o, 0, sizeof o);
    o.context = &serial;
    for (i = 0; i < n; i++) {
        a[i * n + i] = decades > 0 ? power10(&seed, -decades / 2, decades / 2) : 1;
        if (strcmp(op, "near") == 0) a[i * n + i] = 1 + 1e-9;
    }
    for (i = 0; i + 1 < n; i++) {
        double w = 0;
        if (strcmp(op, "near") == 0) w = 0.5;
        if (strcmp(op, "tri") == 0)
            w = 0.49 * shape_signed(&seed) * fmin(a[i * n + i], a[(i + 1) * n + i + 1]);
        a[i * n + i + 1] = a[(i + 1) * n + i] = w;
    }
    for (i = 0; i < n * n; i++) a[i] *= scale * scale;
    csr_dense(&B, a, n);
    st = hd_laplacian_matrices(out, &b->L, &B, 0, &o, e);
    hd_csr_free(&B, NULL);
    free(a);
    return st;
}

/* The pair of a shape by an operator: fem, vor, cot, poly with +id or +tuft; vexp, exp, tuft for points; all
 * these also with +held; I, diag, massN, tri, near for graphs. */
static hd_status pair_make(hd_laplacian **out, const char *spec, const char *op, double scale, hd_error *e) {
    hd_laplacian_opts o;
    hd_status st;
    body b;
    int32_t held;
    int i;
    if (!body_make(&b, spec)) {
        fprintf(stderr, "bounds: no such shape: %s\n", spec);
        exit(2);
    }
    if (b.matrix) {
        st = graph_pair(out, &b, op, scale, e);
        body_free(&b);
        return st;
    }
    memset(&o, 0, sizeof o);
    o.context = &serial;
    o.kind = strncmp(op, "fem", 3) == 0   ? HD_LAPLACIAN_FEM
             : strncmp(op, "vor", 3) == 0 ? HD_LAPLACIAN_VORONOI_COT
             : strncmp(op, "cot", 3) == 0 ? HD_LAPLACIAN_COT
             : strncmp(op, "vexp", 4) == 0 ? HD_LAPLACIAN_VORONOI_EXP
             : strncmp(op, "exp", 3) == 0 ? HD_LAPLACIAN_EXP
                                          : HD_LAPLACIAN_DEFAULT;
    o.intrinsic_delaunay = strstr(op, "+id") != NULL;
    o.tufted = strstr(op, "+tuft") != NULL;
    if (strstr(op, "+held")) {                   /* a vertex, and the border of a mesh */
        o.n_held = 1;
        o.held = &held;
        o.border = b.points ? HD_BORDER_NATURAL : HD_BORDER_DIRICHLET;
        held = b.s.n / 3;
    }
    for (i = 0; i < 3 * b.s.n; i++) b.s.xyz[i] *= scale;
    if (b.points) {
        if (strncmp(op, "tuft", 4) == 0) st = hd_laplacian_tufted_points(out, b.s.xyz, b.s.n, NULL, NULL, &o, e);
        else st = hd_laplacian_points(out, b.s.xyz, b.s.n, &o, e);
    } else if (strncmp(op, "poly", 4) == 0) {
        shape_poly q = b.p.xyz ? b.p : shape_poly_of(&b.s);
        st = hd_laplacian_polygons(out, b.s.xyz, q.n, q.face_ptr, q.face_idx, q.n_faces, &o, e);
        if (!b.p.xyz) shape_poly_free(&q);
    } else {
        st = hd_laplacian_triangles(out, b.s.xyz, b.s.n, b.s.tri, b.s.n_tri, &o, e);
    }
    body_free(&b);
    return st;
}

/* A time that is neither small nor large: h^2, or for the operators that have no unit one over the mean of
 * diag(L)/diag(B). */
static double unit_time(const hd_laplacian *lap) {
    double sum = 0;
    int32_t i;
    int64_t p;
    if (lap->h > 0 && lap->kind != HD_LAPLACIAN_COT && lap->kind != HD_LAPLACIAN_EXP) return lap->h * lap->h;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.col[p] == i) sum += fabs(lap->L.val[p]) / lap->b_diag[i];
    return sum > 0 ? lap->n_active / sum : 1;
}

/* ==== [5] cases ==== */

enum { QUERY_APPLY, QUERY_COLUMN, QUERY_TIMES, QUERY_DERIVATIVE, QUERY_ADJOINT, QUERY_FROM, QUERY_FILTER,
       QUERY_ENTRIES, QUERY_PAIRS, QUERY_DIAGONAL, QUERY_EDGES, QUERY_DISTANCE, QUERY_DISTANCE_FROM, QUERIES };
enum { OWN_NONE, OWN_COPY, OWN_COPY0, OWN_LOOSE, OWN_NEAR, OWN_RANDOM, OWN_RESOLVENT, OWN_A0, OWNS };
enum { FIELD_RANDOM, FIELD_SMOOTH, FIELD_NEARLY, FIELD_HUGE, FIELD_TINY, FIELD_DELTA, FIELD_ALTERNATE,
       FIELD_MODE, FIELD_CONSTANT, FIELD_STEP, FIELD_LINEAR, FIELD_ZERO, FIELD_LEVEL, FIELDS };

static const char *const query_names[] = {"apply",    "column", "times",    "derivative",    "adjoint",
                                          "from",     "filter", "entries",  "pairs",         "diagonal",
                                          "edges",    "distance", "distance_from", NULL};
static const char *const kernel_names[] = {"operator", "symmetric", NULL};
static const char *const kind_names[] = {"classical", "weighted", "commute", "biharmonic", NULL};
static const char *const method_names[] = {"auto", "iterative", "direct", "krylov", NULL};
static const char *const solver_names[] = {"auto", "cocg", "cocr", "minres", "lanczos", NULL};
static const char *const precond_names[] = {"auto", "none", "jacobi", "ssor", "ildl", "mildl", NULL};
static const char *const pole_names[] = {"default", "uniform", "kernel", "own", "diagonal", NULL};
static const char *const own_names[] = {"none",   "copy",      "copy0", "loose", "near",
                                        "random", "resolvent", "a0",    NULL};
static const char *const field_names[] = {"random", "smooth",    "nearly", "huge",     "tiny",
                                          "delta",  "alternate", "mode",   "constant", "step",
                                          "linear", "zero",      "level",  NULL};

typedef struct trial {
    char shape[32], op[16];
    double scale, t, th, span, tol, own_x;       /* th > 0: t in units of the shape's own */
    int query, kernel, kind, method, solver, precond, poles, degree, own, n_times, k, field, corners;
    int64_t seed;
} trial;

typedef enum key_type { KEY_TEXT, KEY_REAL, KEY_INT, KEY_NAME, KEY_SEED } key_type;
typedef struct key { const char *name; key_type type; size_t at; const char *const *names; } key;

static const key keys[] = {{"shape", KEY_TEXT, offsetof(trial, shape), NULL},
                           {"op", KEY_TEXT, offsetof(trial, op), NULL},
                           {"scale", KEY_REAL, offsetof(trial, scale), NULL},
                           {"query", KEY_NAME, offsetof(trial, query), query_names},
                           {"kernel", KEY_NAME, offsetof(trial, kernel), kernel_names},
                           {"kind", KEY_NAME, offsetof(trial, kind), kind_names},
                           {"method", KEY_NAME, offsetof(trial, method), method_names},
                           {"solver", KEY_NAME, offsetof(trial, solver), solver_names},
                           {"precond", KEY_NAME, offsetof(trial, precond), precond_names},
                           {"poles", KEY_NAME, offsetof(trial, poles), pole_names},
                           {"degree", KEY_INT, offsetof(trial, degree), NULL},
                           {"own", KEY_NAME, offsetof(trial, own), own_names},
                           {"x", KEY_REAL, offsetof(trial, own_x), NULL},
                           {"tol", KEY_REAL, offsetof(trial, tol), NULL},
                           {"t", KEY_REAL, offsetof(trial, t), NULL},
                           {"th", KEY_REAL, offsetof(trial, th), NULL},
                           {"span", KEY_REAL, offsetof(trial, span), NULL},
                           {"times", KEY_INT, offsetof(trial, n_times), NULL},
                           {"k", KEY_INT, offsetof(trial, k), NULL},
                           {"corners", KEY_INT, offsetof(trial, corners), NULL},
                           {"field", KEY_NAME, offsetof(trial, field), field_names},
                           {"seed", KEY_SEED, offsetof(trial, seed), NULL}};

enum { KEYS = sizeof keys / sizeof *keys };

static trial trial_default(void) {
    trial c;
    memset(&c, 0, sizeof c);
    strcpy(c.op, "fem");
    c.scale = c.span = 1;
    c.n_times = c.k = c.corners = 1;
    return c;
}

/* What differs from the default. */
static void trial_print(const trial *c, char *out, size_t size) {
    const trial plain = trial_default();
    size_t at = 0;
    int q;
    out[0] = 0;
    for (q = 0; q < KEYS && at < size; q++) {
        const void *v = (const char *)c + keys[q].at, *d = (const char *)&plain + keys[q].at;
        const size_t bytes = keys[q].type == KEY_TEXT ? strlen((const char *)v) + 1
                             : keys[q].type == KEY_REAL || keys[q].type == KEY_SEED ? 8
                                                                                    : sizeof(int);
        double x = 0;
        int i = 0, digits;
        int64_t s = 0;
        if (q != 1 && q != 3 && memcmp(v, d, bytes) == 0) continue;
        if (keys[q].type == KEY_REAL) memcpy(&x, v, 8);
        else if (keys[q].type == KEY_SEED) memcpy(&s, v, 8);
        else if (keys[q].type != KEY_TEXT) memcpy(&i, v, sizeof i);
        at += (size_t)snprintf(out + at, size - at, "%s%s=", at ? " " : "", keys[q].name);
        if (at >= size) break;
        switch (keys[q].type) {
        case KEY_TEXT: at += (size_t)snprintf(out + at, size - at, "%s", (const char *)v); break;
        case KEY_NAME: at += (size_t)snprintf(out + at, size - at, "%s", keys[q].names[i]); break;
        case KEY_INT: at += (size_t)snprintf(out + at, size - at, "%d", i); break;
        case KEY_SEED: at += (size_t)snprintf(out + at, size - at, "%lld", (long long)s); break;
        default:
            for (digits = 1; digits < 17; digits++) {   /* the shortest that reads back the same */
                char text[40];
                snprintf(text, sizeof text, "%.*g", digits, x);
                if (strtod(text, NULL) == x) break;
            }
            at += (size_t)snprintf(out + at, size - at, "%.*g", digits, x);
        }
    }
}

static trial trial_parse(const char *text) {
    trial c = trial_default();
    char word[160];
    int used = 0, q, i;
    while (sscanf(text, " %159s%n", word, &used) == 1) {
        char *value = strchr(word, '=');
        text += used;
        if (value) *value++ = 0;
        for (q = 0; q < KEYS && strcmp(word, keys[q].name) != 0; q++) {}
        if (!value || q == KEYS) {
            fprintf(stderr, "bounds: --case: not understood: %s\n", word);
            exit(2);
        }
        if (keys[q].type == KEY_TEXT) {
            snprintf((char *)&c + keys[q].at,
                     keys[q].at == offsetof(trial, shape) ? sizeof c.shape : sizeof c.op, "%s", value);
        } else if (keys[q].type == KEY_REAL) {
            const double x = strtod(value, NULL);
            memcpy((char *)&c + keys[q].at, &x, sizeof x);
        } else if (keys[q].type == KEY_SEED) {
            const int64_t s = strtoll(value, NULL, 10);
            memcpy((char *)&c + keys[q].at, &s, sizeof s);
        } else {
            if (keys[q].type == KEY_INT) i = atoi(value);
            else {
                for (i = 0; keys[q].names[i] && strcmp(value, keys[q].names[i]) != 0; i++) {}
                if (!keys[q].names[i]) {
                    fprintf(stderr, "bounds: --case: %s: unknown: %s\n", word, value);
                    exit(2);
                }
            }
            memcpy((char *)&c + keys[q].at, &i, sizeof i);
        }
    }
    return c;
}

/* The programs that once found bounds too small, as far as shapes of this size show them. */
static const char *const fixed_cases[] = {
    /* heat that steps of an iteration do not bring to the heaviest vertices */
    "shape=tree/12/13 op=mass16 query=adjoint kernel=symmetric tol=1e-06 t=1.0671480976020037e-13 field=delta seed=969656",
    "shape=tree/12/14 op=mass16 query=adjoint kernel=symmetric method=krylov tol=1e-13 t=2.1931916859483007e-20 field=delta seed=505400",
    "shape=tree/12/15 op=mass16 query=adjoint method=iterative solver=lanczos tol=1e-06 t=1.1041697244236753e-07 field=delta seed=1967",
    "shape=tree/12/16 op=mass2 query=adjoint method=iterative t=1.7184737090578872e-13 field=delta seed=551821",
    /* constants with a ripple, which have next to no derivative */
    "shape=sphere/2 op=fem query=derivative method=iterative th=1 field=level seed=20",
    "shape=sphere/2 op=fem query=derivative method=iterative solver=minres th=1 field=level seed=30",
    "shape=bump/5/1 op=cot query=derivative th=0.1 field=level seed=42",
    /* adjoints without diffusion, derivatives in extreme units and of what has faded, several sources with a
       full B, a filter whose peak is far below lambda_max */
    "shape=none/3 op=I scale=1e-05 query=adjoint kernel=symmetric poles=uniform t=6278.213696441455 field=nearly seed=306889",
    "shape=none/4 op=diag query=adjoint method=direct t=123627245.05210805 field=smooth seed=199966",
    "shape=weak/66/43/6 op=I scale=1e+80 query=derivative kernel=symmetric t=5e-324 field=smooth seed=940513",
    "shape=leak/40/1e-9 op=diag scale=1e+05 query=derivative kernel=symmetric method=krylov tol=1e-06 t=5604461452.496679 field=mode seed=772598",
    "shape=graph/30/1 op=near query=filter kernel=symmetric method=direct t=1240.377498234705 seed=380473",
    "shape=two/2/8 op=fem query=filter method=direct t=4.501707098294611 seed=461665",
    /* commute time and biharmonic beside a small component, and with a sliver */
    "shape=two/2/3/5 query=distance kind=commute",
    "shape=two/2/6/5 query=distance kind=commute",
    "shape=two/2/8/5 query=distance kind=commute",
    "shape=two/2/3/5 query=distance kind=biharmonic",
    "shape=two/2/6/5 query=distance kind=biharmonic",
    "shape=two/2/8/5 query=distance kind=biharmonic",
    "shape=sliver/2/7 query=distance kind=commute",
    "shape=sliver/2/10 query=distance kind=commute",
    "shape=sliver/2/13 query=distance kind=commute",
    "shape=sliver/2/7 query=distance kind=biharmonic",
    "shape=sliver/2/10 query=distance kind=biharmonic",
    "shape=sliver/2/13 query=distance kind=biharmonic",
    /* the sign of libigl */
    "shape=turned/40 op=I query=column t=1",
    "shape=turned/40 op=I query=column t=10",
    "shape=turned/40 op=I query=column t=10 method=krylov",
    "shape=turned/40 op=I query=column t=10 method=iterative",
    "shape=turned/40 op=I query=diagonal kernel=symmetric t=10",
    "shape=turned/40 op=I query=distance t=1",
    /* one entry far from the source */
    "shape=sphere/3 query=entries kernel=symmetric th=0.05 k=1 seed=3",
    "shape=sphere/3 query=entries kernel=symmetric th=0.2 k=1 seed=4",
    "shape=cycle/60 op=I query=entries th=1 k=1 seed=1",
    "shape=cycle/60 op=I query=pairs th=0.5 k=3 seed=2",
    /* eigenvalues of two parts, nothing between 5 and 1e11: shifts must get there */
    "shape=two/1/5 op=fem query=pairs kernel=symmetric kind=weighted t=5.88162318566344 k=10 seed=175710",
    "shape=two/1/5 op=fem query=distance th=20 k=10 seed=175710",
    /* rows that almost sum to zero */
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear method=krylov",
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear method=direct",
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear",
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear method=iterative",
    "shape=leak/64/4e-12 op=I query=column t=1e11 method=krylov",
    "shape=leak/64/4e-12 op=I query=column t=1e11 method=direct",
    /* rounding of the factor in long times */
    "shape=path/80 op=I query=apply t=100 field=mode seed=1 method=krylov",
    "shape=path/80 op=I query=apply t=1000 field=mode seed=1 method=krylov",
    "shape=path/80 op=I query=apply t=1000 field=mode seed=1 method=direct",
    "shape=path/80 op=I query=apply t=1e4 field=random method=krylov tol=1e-13",
    /* poles of one's own: a loose weighted error, next to the spectrum */
    "shape=sphere/3 query=distance own=loose degree=8 th=1",
    "shape=sphere/3 query=distance own=loose degree=8 th=10",
    "shape=sphere/3 query=distance own=loose degree=8 th=100",
    "shape=sphere/3 query=distance own=copy0 degree=8 th=10",
    "shape=cycle/60 op=I query=diagonal kernel=symmetric own=near x=3 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=diagonal kernel=symmetric own=near x=5 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=diagonal kernel=symmetric own=near x=7 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=column own=near x=5 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=column own=near x=7 method=direct t=1 seed=13",
    "shape=grid/6/2 op=fem+id query=edges degree=11 own=near x=7 tol=1e-11 t=417.9347234573265 seed=20079",
    "shape=grid/6/2 op=fem+id query=diagonal degree=11 own=near x=7 tol=1e-11 t=417.9347234573265 seed=20079",
    "shape=leak/40/1e-3 op=I scale=1e-05 query=distance method=direct degree=4 own=near x=5 "
    "t=8.874288504572718 span=22.899661973943026 times=3 seed=849640",
    "shape=weak/66/35/6 op=I query=column poles=kernel degree=3 t=252134.45926565715 k=4 seed=122858",
    "shape=graph/30/12 op=near scale=1e-80 query=times kernel=symmetric tol=1e-13 t=7.701053733488825e-173 "
    "span=322.49545416235975 times=7 field=nearly seed=466076",
    "shape=path/71 op=diag query=distance kind=biharmonic t=0.010021720690390704 seed=586095",
    "shape=weak/60/45 op=diag query=distance kind=biharmonic tol=1e-13 t=2.187386761734381e-05 seed=631770",
    "shape=weak/66/34/6 op=I query=edges kernel=symmetric degree=6 own=a0 x=2 tol=1e-11 t=1e+100 seed=468408",
    "shape=weak/66/46/6 op=I query=distance kind=biharmonic t=4999.9999999999945 seed=341872",
    "shape=penalty/60/4 op=tri scale=1e-80 query=column kernel=symmetric degree=2 own=a0 x=3 t=1e+100 k=40 seed=19214",
    /* a mass matrix that is nearly singular, and a field along it */
    "shape=path/80 op=near query=apply t=1 field=alternate",
    "shape=path/80 op=near query=apply t=1 field=alternate poles=uniform degree=4 method=direct",
    "shape=path/80 op=near query=apply t=1 field=alternate poles=uniform degree=8 method=direct",
    "shape=path/80 op=near query=apply t=1 field=alternate method=krylov",
    "shape=path/80 op=near query=diagonal kernel=symmetric t=1",
    "shape=path/80 op=near query=column t=1 method=direct",
    /* many times at once on graded meshes */
    "shape=grid/9/4 query=distance times=16 span=100 th=1",
    "shape=grid/9/6 query=distance times=16 span=100 th=1",
    "shape=grid/9/10 query=distance times=16 span=100 th=1",
    "shape=grid/9/6 query=distance kind=weighted times=16 span=100 th=1",
    "shape=grid/9/10 query=diagonal kernel=symmetric times=16 span=1000 th=1",
    /* weak edges, stiff penalties */
    "shape=penalty/60/6 op=I query=column kernel=symmetric t=10 method=iterative solver=lanczos",
    "shape=penalty/60/6 op=I query=column kernel=symmetric t=1000 method=iterative solver=lanczos",
    "shape=penalty/60/6 op=I query=column t=100 method=krylov",
    "shape=penalty/60/9 op=I query=column t=100 method=direct",
    "shape=weak/60/20 op=I query=apply field=step t=3145728 method=iterative solver=lanczos",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472 method=iterative solver=lanczos",
    "shape=weak/60/20 op=I query=apply field=step t=3145728 method=krylov",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472 method=krylov",
    "shape=weak/60/40 op=I query=apply field=step t=3298534883328 method=krylov",
    "shape=weak/60/40 op=I query=apply field=step t=3298534883328 method=direct",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472 method=direct",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472",
    /* huge and tiny fields, forty columns, tiny and huge times */
    "shape=sphere/2 query=apply t=0.1 field=tiny",
    "shape=sphere/2 query=apply t=0.1 field=tiny method=direct",
    "shape=sphere/2 query=apply t=0.1 field=tiny method=krylov",
    "shape=sphere/2 query=apply t=0.1 field=huge",
    "shape=sphere/2 query=apply t=0.1 field=huge method=direct",
    "shape=sphere/2 query=apply t=0.1 field=huge method=krylov",
    "shape=sphere/2 query=apply t=0.1 field=huge method=iterative",
    "shape=sphere/2 query=apply t=0.1 k=40 method=direct",
    "shape=sphere/2 query=apply t=0.1 k=40",
    "shape=none/5 op=I query=distance kind=commute",
    "shape=none/1 op=I query=distance kind=commute",
    "shape=none/5 op=I query=column t=1",
    "shape=sphere/2 op=vor query=column t=5e-324 method=krylov",
    "shape=sphere/2 op=vor query=diagonal kernel=symmetric t=1e16",
    "shape=cycle/60 op=I query=times t=5e-324 span=2e323 times=2 method=krylov",
    "shape=five query=column t=1e-310 method=direct",
    "shape=five query=column t=1e-310 method=krylov",
    "shape=five query=column t=1e300 method=direct",
    "shape=five query=column t=1e300 method=krylov",
    "shape=five query=column t=1e300 method=iterative",
    "shape=five query=diagonal kernel=symmetric t=1e300",
    "shape=five query=diagonal kernel=symmetric t=1e-310",
    "shape=five query=distance th=1e4",
    "shape=five query=distance th=1e10",
    "shape=five query=distance kind=weighted th=1e10",
    /* heat that fades, at t lambda_1 of about 1 to 600 */
    "shape=grid/9/1 op=fem+held query=column th=4 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=4",
    "shape=grid/9/1 op=fem+held query=column th=15 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=15",
    "shape=grid/9/1 op=fem+held query=column th=30 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=30",
    "shape=grid/9/1 op=fem+held query=column th=60 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=60",
    "shape=grid/9/1 op=fem+held query=column th=110 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=110",
    "shape=grid/9/1 op=fem+held query=column th=370 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=370",
    "shape=grid/9/1 op=fem+held query=column th=2200 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=2200",
    "shape=grid/9/1 op=fem+held query=apply field=random k=3 th=30",
    "shape=grid/9/1 op=fem+held query=apply field=random k=3 th=370",
    "shape=grid/9/1 op=fem+held query=entries k=20 th=30",
    "shape=grid/9/1 op=fem+held query=entries k=20 th=370",
    "shape=grid/9/1 op=fem+held query=edges kernel=symmetric th=30",
    "shape=grid/9/1 op=fem+held query=edges kernel=symmetric th=370",
    "shape=grid/9/1 op=fem+held query=diagonal kernel=operator th=30",
    "shape=grid/9/1 op=fem+held query=diagonal kernel=operator th=370",
    "shape=grid/9/1 op=fem+held query=pairs k=10 th=30",
    "shape=grid/9/1 op=fem+held query=pairs k=10 th=370",
    "shape=grid/9/1 op=fem+held query=distance th=30",
    "shape=grid/9/1 op=fem+held query=distance th=370",
    "shape=grid/9/1 op=fem+held query=column method=direct k=4 th=30",
    "shape=grid/9/1 op=fem+held query=column method=direct k=4 th=370",
    "shape=grid/9/1 op=fem+held query=times th=1 span=1000 times=16",
    "shape=grid/9/1 op=fem+held query=diagonal kernel=symmetric th=1 span=1000 times=16",
    "shape=sphere/2 op=fem+held query=column th=1000 k=6",
    "shape=sliver/2/6 op=fem+held query=column th=1e4",
    "shape=two/2/3 op=fem+held query=column th=100 k=6",
    "shape=leak/64/4e-12 op=I query=diagonal kernel=symmetric t=1e13",
    "shape=leak/64/4e-12 op=I query=column t=1e13 k=4"};

enum { FIXED = sizeof fixed_cases / sizeof *fixed_cases };

/* ---- drawing ---- */


/* What an index is drawn with these odds, in parts. */
static int among(uint64_t *seed, const int *parts, int n) {
    int sum = 0, i, r;
    for (i = 0; i < n; i++) sum += parts[i];
    r = draw(seed, sum);
    for (i = 0; i + 1 < n && r >= parts[i]; i++) r -= parts[i];
    return i;
}

static double draw_time(uint64_t *seed, double unit) {
    static const double odd[] = {1e-300, 1e30, 1e300, 1e-310, 5e-324, 1e100};
    const double u = shape_uniform(seed);
    if (u < 0.03) return odd[draw(seed, 6)];
    if (u < 0.10) return unit * power10(seed, -12, -2);
    if (u < 0.15) return unit * power10(seed, 6, 12);
    if (u < 0.20) return unit * pow(10, draw(seed, 5));
    return unit * power10(seed, -2, 6);
}

static trial trial_draw(uint64_t *seed, const trial *from, double unit) {
    static const int queries[] = {8, 8, 4, 4, 4, 4, 3, 6, 6, 8, 2, 10, 4}, methods[] = {5, 6, 5, 5},
                     fields[] = {6, 4, 3, 1, 1, 2, 2, 2, 1, 2, 1, 1, 3};
    static const double tols[] = {0, 0, 0, 1e-6, 1e-11, 1e-13};
    trial c = *from;
    int direct;
    c.query = among(seed, queries, QUERIES);
    c.kernel = draw(seed, 2);
    c.seed = (int64_t)(shape_random(seed) >> 44);
    c.t = draw_time(seed, unit);
    c.tol = tols[draw(seed, 6)];
    c.kind = c.query == QUERY_DISTANCE || c.query == QUERY_DISTANCE_FROM ? draw(seed, 4) : c.query == QUERY_PAIRS ? draw(seed, 8) % 5 : 0;
    if (c.kind == 4) c.kind = 0;
    direct = c.query >= QUERY_DIAGONAL || (c.query == QUERY_PAIRS && c.kind >= 2);
    c.method = direct ? 2 * draw(seed, 2) : among(seed, methods, c.query == QUERY_FILTER ? 3 : 4);
    if (c.method == HD_METHOD_ITERATIVE) {
        c.solver = draw(seed, c.query == QUERY_FILTER ? 4 : 5);
        if (c.solver != HD_SOLVER_LANCZOS) c.precond = draw(seed, 5);
    }
    if (c.method != HD_METHOD_KRYLOV && c.solver != HD_SOLVER_LANCZOS && c.kind < 2) {
        static const int which[] = {10, 3, 4, 0, 2};
        c.poles = among(seed, which, 5);
        if (chance(seed, c.poles ? 0.6 : 0.1)) c.degree = 2 + draw(seed, 13);
        if (c.query == QUERY_DERIVATIVE) c.poles = c.degree = 0;
        if (c.query != QUERY_DERIVATIVE && chance(seed, 0.1)) {   /* sets of one's own have none */
            c.poles = 0;
            c.own = 1 + draw(seed, OWNS - 1);
            c.degree = 2 + draw(seed, 13);
            c.own_x = 1 + draw(seed, 7);
        }
    }
    if (c.query == QUERY_FILTER) c.poles = c.degree = c.own = 0;
    c.field = c.query == QUERY_APPLY || c.query == QUERY_DERIVATIVE || c.query == QUERY_ADJOINT || (c.query == QUERY_TIMES && chance(seed, 0.5))
                  ? among(seed, fields, FIELDS)
                  : 0;
    if (c.query == QUERY_ADJOINT && chance(seed, 0.3)) c.field = FIELD_DELTA;
    /* rounding of huge fields over tiny times leaves the range of doubles */
    if (c.query == QUERY_DERIVATIVE && c.field == FIELD_HUGE) c.field = FIELD_RANDOM;
    if (c.query == QUERY_TIMES) c.kind = chance(seed, 0.5);   /* a field or a column */
    c.k = c.query == QUERY_ENTRIES || c.query == QUERY_PAIRS  ? 1 + draw(seed, chance(seed, 0.5) ? 2 : 20)
          : c.query == QUERY_APPLY || c.query == QUERY_COLUMN ? (chance(seed, 0.05) ? 40 : 1 + draw(seed, 6))
          : c.query == QUERY_DISTANCE                         ? 1 + draw(seed, 3)
                                                              : 1;
    if (c.query == QUERY_TIMES ||
        ((c.query == QUERY_DIAGONAL || (c.query == QUERY_DISTANCE && c.kind < 2)) && chance(seed, 0.4))) {
        c.n_times = chance(seed, 0.6) ? 16 : 2 + draw(seed, 8);
        c.span = power10(seed, 0, 3);
        if (c.t > 1e290) c.t = 1e290;
    }
    if (c.query == QUERY_FROM || c.query == QUERY_FILTER || c.query == QUERY_DISTANCE_FROM)
        c.corners = chance(seed, 0.4) ? 3 : 1;
    return c;
}

/* ==== [6] comparing ==== */

typedef struct tally {
    char name[48];
    int64_t compared, errors, warned, below, below_b, below_relative, useless, bad, stored, stored_below,
        n_ratio, n_ratio_b, most, most_b;
    float *ratio, *ratio_b;
    double worst;
    char worst_case[400];
} tally;

enum { ROWS = 256 };
static tally rows_of_table[ROWS];
static int n_rows_of_table;
static double shrink = 1;
/* comparisons in which the truth's own error is above a hundredth of the bound */
static int64_t unsure;
static FILE *csv;
static int verbose;

static tally *row_of(const char *name) {
    int i;
    for (i = 0; i < n_rows_of_table; i++)
        if (strcmp(rows_of_table[i].name, name) == 0) return rows_of_table + i;
    if (n_rows_of_table == ROWS) stop("the table is full");
    snprintf(rows_of_table[n_rows_of_table].name, sizeof rows_of_table->name, "%s", name);
    return rows_of_table + n_rows_of_table++;
}

static void keep_ratio(float **list, int64_t *n, int64_t *most, double value) {
    if (*n == *most) {
        *most = *most ? 2 * *most : 256;
        *list = (float *)realloc(*list, (size_t)*most * sizeof **list);
        if (!*list) stop("out of memory");
    }
    (*list)[(*n)++] = (float)value;
}

/* ---- tables by any two properties of a case ---- */

enum { AXIS_SHAPE, AXIS_OP, AXIS_T, AXIS_QUERY, AXIS_METHOD, AXES };
static const char *const axis_names[] = {"shape", "op", "t", "query", "method", NULL};
enum { VALUES = 64, VALUE_SIZE = 24 };
static char axis_values[AXES][VALUES][VALUE_SIZE];
static int n_axis_values[AXES];

typedef struct record { unsigned char value[AXES]; float ratio; } record;
static record *records;
static int64_t n_records, most_records;

static unsigned char axis_value(int axis, const char *text) {
    int i;
    for (i = 0; i < n_axis_values[axis]; i++)
        if (strcmp(axis_values[axis][i], text) == 0) return (unsigned char)i;
    if (i == VALUES) stop("a table has too many rows or columns");
    snprintf(axis_values[axis][i], VALUE_SIZE, "%s", text);
    n_axis_values[axis]++;
    return (unsigned char)i;
}

/* A letter before a range of times sorts it. */
static void keep_record(const trial *c, double unit, double ratio) {
    static const char *const ranges[] = {"a below 1e-2", "b 1e-2 to 1", "c 1 to 1e2", "d 1e2 to 1e4",
                                         "e 1e4 to 1e6", "f above 1e6"};
    static const double limits[] = {1e-2, 1, 1e2, 1e4, 1e6};
    const int timeless = c->query >= QUERY_PAIRS && c->kind >= HD_DISTANCE_COMMUTE;
    char shape[VALUE_SIZE];
    record r;
    int range = 0;
    while (range < 5 && !(c->t / unit < limits[range])) range++;
    snprintf(shape, sizeof shape, "%.*s", (int)strcspn(c->shape, "/"), c->shape);
    r.value[AXIS_SHAPE] = axis_value(AXIS_SHAPE, shape);
    r.value[AXIS_OP] = axis_value(AXIS_OP, c->op);
    r.value[AXIS_T] = axis_value(AXIS_T, timeless ? "g no time" : ranges[range]);
    r.value[AXIS_QUERY] = axis_value(AXIS_QUERY, query_names[c->query]);
    r.value[AXIS_METHOD] = axis_value(AXIS_METHOD, method_names[c->method]);
    r.ratio = (float)ratio;
    if (n_records == most_records) {
        most_records = most_records ? 2 * most_records : 1024;
        records = (record *)realloc(records, (size_t)most_records * sizeof *records);
        if (!records) stop("out of memory");
    }
    records[n_records++] = r;
}

/* A shape with its truths, and room for answers. */
typedef struct subject {
    hd_laplacian *lap;
    truth exact, stored;         /* by the library's definition; by what is stored, when that differs */
    int has_stored;
    double unit;
    filter f;
} subject;

/* One case under way. */
typedef struct work {
    subject *s;
    const trial *c;
    const truth *T;
    int stored;                  /* told only */
    hd_report rep;
    hd_rational set;
    const hd_rational *own;      /* what the truth is a filter of; NULL: exp */
    const char *text;
    tally *row;
    quad *want, *gw;
    double *off, *gw_off;
    int32_t columns;
} work;

/* e'Be of a difference on vertices */
static quad norm_b(const hd_laplacian *lap, const quad *e) {
    quad sum = 0;
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        quad b = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double m = mass_entry(lap, i, p);
            if (m != 0) b += (quad)m * e[lap->vertex[lap->L.col[p]]];
        }
        sum += b * e[lap->vertex[i]];
    }
    return sum > 0 ? sqrtq(sum) : 0;
}

static quad ratio_of(quad error, quad bound) { return error == 0 ? 0 : bound > 0 ? error / bound : 1e30Q; }

/* n values against the truth and its own error. has_b, relative: which bounds there are beside error_bound.
 * skip: a place to leave out (-1: none). */
static void compare(work *w, const double *value, int64_t n, int has_b, int relative, int64_t skip) {
    const quad vertex = (quad)(w->rep.error_bound * shrink), b = (quad)(w->rep.error_bound_b * shrink),
               rel = (quad)(w->rep.error_relative * shrink);
    const int finite = w->rep.error_bound <= DBL_MAX, finite_b = w->rep.error_bound_b <= DBL_MAX,
              finite_rel = w->rep.error_relative <= DBL_MAX;
    quad largest = 0, worst = 0, worst_plain = 0, worst_rel = 0, own = 0, ratio, ratio_b = 0,
         ratio_rel = 0;
    int bad = isnan(w->rep.error_bound) || isnan(w->rep.error_bound_b) || isnan(w->rep.error_relative), below,
        below_b = 0, below_rel = 0, useless;
    tally *r = w->row;
    int64_t i;
    for (i = 0; i < n; i++) {
        if (i == skip) continue;
        if (fabsq(w->want[i]) > 1e307Q) return;  /* beyond doubles: nothing to compare */
        if (!(fabs(value[i]) <= DBL_MAX)) bad = 1;
        else if (fabs(value[i]) > (double)largest) largest = (quad)fabs(value[i]);
    }
    for (i = 0; i < n && !bad; i++) {
        const quad e = i == skip ? 0 : fabsq(value[i] - w->want[i]), sure = e - (quad)w->off[i] - 1e-322Q;
        if (e > worst_plain) worst_plain = e;
        if (sure > worst) worst = sure;
        if ((quad)w->off[i] > own) own = w->off[i];
        if (relative && i != skip && finite_rel) {
            if (sure > rel * (quad)fabs(value[i]) * (1 + 1e-12Q)) below_rel = 1;
            if (sure > 0 && ratio_of(sure, rel * (quad)fabs(value[i])) > worst_rel)
                worst_rel = ratio_of(sure, rel * (quad)fabs(value[i]));
        }
    }
    below = !bad && finite && worst > vertex * largest * (1 + 1e-12Q);
    ratio = !finite || worst <= 0 ? 0 : ratio_of(worst, vertex * largest);
    ratio_rel = finite_rel ? worst_rel : 0;
    if (has_b && !bad) {
        const hd_laplacian *lap = w->s->lap;
        quad *e = ROOM(quad, 2 * lap->n), *u = e + lap->n, error, off, size;
        for (i = 0; i < n; i++) u[i] = value[i];
        size = norm_b(lap, u);
        for (i = 0; i < n; i++) e[i] = value[i] - w->want[i];
        error = norm_b(lap, e);
        for (i = 0; i < n; i++) e[i] = (quad)w->off[i] + 1e-322Q;
        /* entries of B are not all positive, but dominated by the diagonal */
        off = 2 * norm_b(lap, e);
        below_b = finite_b && error - off > b * size * (1 + 1e-12Q);
        ratio_b = finite_b && error > off ? ratio_of(error - off, b * size) : 0;
        free(e);
    }
    useless = w->rep.status == HD_OK &&
              (!(w->rep.error_bound <= 0.01) || (has_b && !(w->rep.error_bound_b <= 0.01)));
    if (w->stored) {
        r->stored++;
        r->stored_below += bad || below;
        if (verbose)
            printf("  against L as stored: true %.3e\n", largest > 0 ? (double)(worst_plain / largest) : 0);
        return;
    }
    unsure += !bad && finite && own > 0.01Q * vertex * largest;
    r->compared++;
    r->warned += w->rep.status > 0;
    r->below += below;
    r->below_b += below_b;
    r->below_relative += below_rel;
    r->useless += useless;
    r->bad += bad;
    keep_ratio(&r->ratio, &r->n_ratio, &r->most, (double)ratio);
    if (has_b) keep_ratio(&r->ratio_b, &r->n_ratio_b, &r->most_b, (double)ratio_b);
    if (ratio < ratio_b) ratio = ratio_b;
    if (ratio < ratio_rel) ratio = ratio_rel;
    if (bad) ratio = 2e30Q;
    keep_record(w->c, w->s->unit, (double)ratio);
    if ((double)ratio > r->worst) {
        r->worst = (double)ratio;
        snprintf(r->worst_case, sizeof r->worst_case, "%s", w->text);
    }
    if (csv)
        fprintf(csv, "\"%s\",\"%s\",%d,%s,%.4g,%.4g,%.4g,%.4g,%.4g,%d,%d,%d,%d,%d\n", r->name, w->text,
                (int)w->columns, hd_status_name(w->rep.status),
                largest > 0 ? (double)(worst_plain / largest) : 0, w->rep.error_bound,
                (double)ratio_b * w->rep.error_bound_b, w->rep.error_bound_b, w->rep.error_relative, below,
                below_b, below_rel, useless, bad);
    if (verbose)
        printf("  %s column %d: %s true %.3e bound %.3e%s; B norm %.3e bound %.3e%s; relative bound %.3e "
               "(ratio %.3g)%s%s%s\n",
               r->name, (int)w->columns, hd_status_name(w->rep.status),
               largest > 0 ? (double)(worst_plain / largest) : 0, w->rep.error_bound, below ? " BELOW" : "",
               (double)ratio_b * w->rep.error_bound_b, w->rep.error_bound_b, below_b ? " BELOW" : "",
               w->rep.error_relative, (double)ratio_rel, below_rel ? " BELOW" : "", useless ? " USELESS" : "",
               bad ? " NOT FINITE" : "");
    w->columns++;
}

/* ---- answers, by the truth ---- */

/* Every row from the weights w->gw = g times what stands right of it, into want and off; `identity`: the
 * value of inert vertex v is value[v]. */
static void want_rows(work *w, int left_y, double beyond, const double *inert) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = w->T;
    int32_t v;
    for (v = 0; v < lap->n; v++) {
        const int32_t r = lap->row[v];
        w->want[v] = inert && r != HD_ROW_HELD ? inert[v] : 0;
        w->off[v] = 0;
        if (r < 0) continue;
        w->want[v] = truth_sum(T, &w->s->f, T->comp[r], (left_y ? T->y : T->x) + r * T->n,
                               (left_y ? T->yd : T->xd) + r * T->n, w->gw, w->gw_off,
                               beyond * (left_y ? T->y_most : T->x_most), w->off + v);
    }
}

/* gw = g z for a vector z over the modes. */
static void weigh(work *w, const quad *z, const double *z_off) {
    const truth *T = w->T;
    const filter *f = &w->s->f;
    int32_t c, l;
    for (l = 0; l < T->n; l++) w->gw[l] = w->gw_off[l] = 0;
    for (c = 0; c < T->n_comp; c++)
        for (l = T->first[c]; l < f->last[c]; l++) {
            w->gw[l] = f->g[l] * z[l];
            w->gw_off[l] = f->off[l] * (double)fabsq(z[l]) + (z_off ? (double)fabsq(f->g[l]) * z_off[l] : 0);
        }
}

/* Only the modes of one row's component are not zero in its row of x or y. */
static void want_column(work *w, int32_t source, int symmetric, double *inert) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = w->T;
    const int32_t r = lap->row[source];
    int32_t v;
    for (v = 0; v < lap->n; v++) inert[v] = !symmetric && v == source && r == HD_ROW_INERT;
    if (r >= 0) {
        weigh(w, (symmetric ? T->x : T->y) + r * T->n, NULL);
    } else {
        memset(w->gw, 0, (size_t)T->n * sizeof *w->gw);
        memset(w->gw_off, 0, (size_t)T->n * sizeof *w->gw_off);
    }
    want_rows(w, 0, r < 0 ? 0 : T->n * (symmetric ? T->x_most : T->y_most), inert);
    for (v = 0; v < lap->n && r >= 0; v++)       /* between components nothing at all */
        if (lap->row[v] >= 0 && T->comp[lap->row[v]] != T->comp[r]) w->want[v] = w->off[v] = 0;
}

/* dual: of the transpose, Y g X' f instead of X g Y' f. */
static void want_field(work *w, const double *f, const double *inert, int dual) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = w->T;
    quad *z = ROOM(quad, T->n);
    double *off = ROOM(double, T->n), beyond = 0;
    int32_t r, l;
    for (r = 0; r < T->n; r++) {
        const quad *y = (dual ? T->x : T->y) + r * T->n;
        const double *yd = (dual ? T->xd : T->yd) + r * T->n, x = f[lap->vertex[r]];
        if (x == 0) continue;
        for (l = T->first[T->comp[r]]; l < T->first[T->comp[r] + 1]; l++) {
            z[l] += y[l] * x;
            off[l] += 0x1p-106 * yd[l] * fabs(x);
        }
        beyond += (dual ? T->x_most : T->y_most) * fabs(x);
    }
    weigh(w, z, off);
    want_rows(w, dual, T->n * beyond, inert);
    free(z);
    free(off);
}

/* One entry of left g right', 1 on the diagonal of inert vertices if asked. */
static quad want_entry(work *w, int32_t i, int32_t j, int left_y, int right_y, int inert_one, double *off) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = w->T;
    const filter *f = &w->s->f;
    const int32_t a = lap->row[i], b = lap->row[j];
    quad sum = 0;
    int32_t l;
    *off = 0;
    if (a < 0 || b < 0) return inert_one && i == j && a == HD_ROW_INERT;
    if (T->comp[a] != T->comp[b]) return 0;
    *off = f->cut * T->n * (left_y ? T->y_most : T->x_most) * (right_y ? T->y_most : T->x_most);
    for (l = T->first[T->comp[a]]; l < f->last[T->comp[a]]; l++) {
        const quad z = (left_y ? T->y : T->x)[a * T->n + l] * (right_y ? T->y : T->x)[b * T->n + l];
        sum += f->g[l] * z;
        *off += f->off[l] * (double)fabsq(z);
    }
    return sum;
}

/* The distance of two vertices: the root of the sum of g (z_i - z_j)^2. */
static quad want_distance(work *w, int32_t i, int32_t j, int weighted, double *off) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = w->T;
    const filter *f = &w->s->f;
    const int32_t row[2] = {lap->row[i], lap->row[j]};
    const quad *z = weighted ? T->y : T->x;
    const int same = row[0] >= 0 && row[1] >= 0 && T->comp[row[0]] == T->comp[row[1]];
    quad sum = 0, root;
    double err = f->cut * T->n * (weighted ? T->y_most : T->x_most) * (weighted ? T->y_most : T->x_most);
    int32_t l, k;
    *off = 0;
    if (i == j) return 0;
    for (k = 0; k < 2; k++) {
        if (row[k] < 0 || (same && k > 0)) continue;
        for (l = T->first[T->comp[row[k]]]; l < f->last[T->comp[row[k]]]; l++) {
            const quad d = z[row[k] * T->n + l] - (same ? z[row[1] * T->n + l] : 0);
            sum += f->g[l] * d * d;
            err += f->off[l] * (double)(d * d) +
                   (double)fabsq(f->g[l] * d) * 0x1p-108 *
                       (double)(fabsq(z[row[0] >= 0 ? row[0] * T->n + l : row[1] * T->n + l]) + fabsq(d));
        }
    }
    if (sum < 0) sum = 0;
    root = sqrtq(sum);
    *off = root > 0 ? (double)fminq(err / root, sqrtq(err)) : sqrt(err);
    return root;
}

/* ---- calls ---- */

static void row_name(work *w, const char *query) {
    char name[48];
    const trial *c = w->c;
    const char *method = c->method == HD_METHOD_ITERATIVE
                             ? (c->solver ? solver_names[c->solver] : "iterative")
                             : method_names[c->method];
    snprintf(name, sizeof name, "%-18s %s", query, method);
    w->row = row_of(name);
}

static int failed(work *w) {
    if (w->rep.status >= 0) return 0;
    if (!w->stored) w->row->errors++;
    if (verbose) printf("  %s: %s: %s\n", w->row->name, hd_status_name(w->rep.status), w->rep.error.text);
    return 1;
}

static void filter_for(work *w, double t, int squared) {
    filter_fill(&w->s->f, w->T, FORM_HEAT, t, w->own, squared);
}

/* A field on the vertices. */
static void make_field(const work *w, int what, uint64_t *seed, double *f) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = &w->s->exact;
    const double small = what == FIELD_TINY    ? (chance(seed, 0.5) ? 1e-170 : 1e-300)
                         : what == FIELD_LEVEL ? (chance(seed, 0.8) ? 1 : 1e300)
                         : chance(seed, 0.5)   ? 1e160
                                               : 1e200;
    double coefficient[6];
    int32_t v, r, l, c;
    const int32_t one = draw(seed, lap->n),
                  mode = what == FIELD_MODE && w->c->seed < T->n ? (int32_t)w->c->seed : draw(seed, T->n);
    const double ripple = ldexp(1, -10 - (int)(w->c->seed % 43));   /* of a level field: down to an ulp */
    for (l = 0; l < 6; l++) coefficient[l] = shape_signed(seed);
    for (v = 0; v < lap->n; v++) {
        const double u = shape_signed(seed);
        r = lap->row[v];
        f[v] = u;
        if (what == FIELD_HUGE || what == FIELD_TINY) f[v] = small * u;
        else if (what == FIELD_NEARLY) f[v] = 1 + 1e-6 * u;
        else if (what == FIELD_DELTA) f[v] = v == one;
        else if (what == FIELD_ALTERNATE) f[v] = 1 + (v % 2 ? -1e5 : 1e5);
        else if (what == FIELD_CONSTANT) f[v] = 3;
        else if (what == FIELD_STEP) f[v] = v < lap->n / 2 ? 1 : -1;
        else if (what == FIELD_LINEAR) f[v] = v + 1;
        else if (what == FIELD_ZERO) f[v] = 0;
        else if (what == FIELD_LEVEL) f[v] = small * (1 + ripple * u);
        else if (what == FIELD_MODE) f[v] = r < 0 ? 0 : (double)T->x[r * T->n + mode];
        else if (what == FIELD_SMOOTH) {
            f[v] = 0;
            for (l = 0; r >= 0 && l < 6; l++) {
                c = T->comp[r];
                if (T->first[c] + l < T->first[c + 1])
                    f[v] += coefficient[l] * (double)T->x[r * T->n + T->first[c] + l];
            }
        }
        if (what == FIELD_MODE || what == FIELD_SMOOTH) f[v] = isfinite(f[v]) ? f[v] : 0;
    }
}

static void run_columns(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n, k = c->k < 1 ? 1 : c->k > 64 ? 64 : c->k;
    const int symmetric = c->query == QUERY_COLUMN && c->kernel == HD_KERNEL_SYMMETRIC;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *F = ROOM(double, n * k), *U = ROOM(double, n * k), *inert = ROOM(double, n);
    int32_t source[64], q;
    if (c->query == QUERY_APPLY) {
        for (q = 0; q < k; q++) make_field(w, q == 0 ? c->field : draw(&seed, FIELD_HUGE), &seed, F + q * n);
        row_name(w, "apply");
        hd_heat_apply(heat, 1, &c->t, k, F, 0, U, 0, &w->rep, NULL);
    } else {
        for (q = 0; q < k; q++) source[q] = draw(&seed, n);
        row_name(w, symmetric ? "columns of k_t" : "columns of K_t");
        hd_heat_columns(heat, (hd_kernel)c->kernel, 1, &c->t, k, source, U, 0, &w->rep, NULL);
    }
    if (!failed(w)) {
        filter_for(w, c->t, 0);
        for (q = 0; q < k; q++) {
            if (c->query == QUERY_APPLY) want_field(w, F + q * n, F + q * n, 0);
            else want_column(w, source[q], symmetric, inert);
            compare(w, U + q * n, n, 1, 0, -1);
        }
    }
    free(F);
    free(U);
    free(inert);
}

/* The derivative in t and the transpose, of a field. */
static void run_training(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n;
    const int dual = c->query == QUERY_ADJOINT;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *f = ROOM(double, 2 * n), *u = f + n;
    make_field(w, c->field, &seed, f);
    row_name(w, dual ? "adjoint" : "derivative");
    if (dual) hd_heat_adjoint(heat, 1, &c->t, 1, f, 0, u, 0, &w->rep, NULL);
    else hd_heat_derivative(heat, 1, &c->t, 1, f, 0, u, 0, &w->rep, NULL);
    if (!failed(w)) {
        filter_fill(&w->s->f, w->T, dual ? FORM_HEAT : FORM_DERIVATIVE, c->t, w->own, 0);
        want_field(w, f, dual ? f : NULL, dual);
        compare(w, u, n, !dual, 0, -1);          /* error_bound_b of the transpose is in another norm */
    }
    free(f);
}

/* One to four points between `corners` vertices of one component each, with weights: c as a field. Between vertices all
 * numbers are sixteenths, so that c is exact. */
typedef struct points { int32_t vertex[12]; double bary[12], weight[4]; } points;

static hd_source draw_source(const work *w, uint64_t *seed, points *p, double *c) {
    const hd_laplacian *lap = w->s->lap;
    const int32_t first = draw(seed, lap->n_active), corners = w->c->corners;
    hd_source s;
    int32_t i;
    memset(&s, 0, sizeof s);
    s.count = 1 + draw(seed, 4);
    s.corners = corners;
    s.vertex = p->vertex;
    s.bary = corners > 1 ? p->bary : NULL;
    s.weight = p->weight;
    for (i = 0; i < corners * s.count; i++) {
        const int32_t point = i / corners, corner = i % corners;
        int32_t row = draw(seed, lap->n_active);
        if (lap->component[row] != lap->component[first]) row = first;
        p->vertex[i] = lap->vertex[row];
        if (corners == 1) p->weight[point] = 0.1 + shape_uniform(seed);
        else if (corner == 0) p->weight[point] = (1 + draw(seed, 16)) / 16.0;
        p->bary[i] = corners == 1 ? 1 : corner == 2 ? 1 - p->bary[i - 1] - p->bary[i - 2] : draw(seed, 9) / 16.0;
        c[p->vertex[i]] += p->bary[i] * p->weight[point];
    }
    return s;
}

/* Columns of several vertices at once, and columns of filters. */
static void run_from(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n;
    const int symmetric = c->kernel == HD_KERNEL_SYMMETRIC, by_filter = c->query == QUERY_FILTER;
    const double t = by_filter ? w->set.t : c->t;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *u = ROOM(double, 3 * n), *field = u + n, *inert = field + n;
    points at;
    hd_source s = draw_source(w, &seed, &at, field);
    row_name(w, by_filter ? symmetric ? "filter, k_t" : "filter, K_t" : symmetric ? "k_t from" : "K_t from");
    hd_heat_columns_from(heat, (hd_kernel)c->kernel, 1, &t, 1, &s, u, 0, &w->rep, NULL);
    if (!failed(w)) {
        filter_fill(&w->s->f, w->T, by_filter ? FORM_FILTER : FORM_HEAT, c->t, w->own, 0);
        if (symmetric) {                         /* x g x' c: as the transpose, and x on the left */
            quad *z = ROOM(quad, w->T->n);
            double *off = ROOM(double, w->T->n), beyond = 0;
            int32_t r, l;
            for (r = 0; r < w->T->n; r++) {
                const double f = field[lap->vertex[r]];
                for (l = w->T->first[w->T->comp[r]]; f != 0 && l < w->T->first[w->T->comp[r] + 1]; l++) {
                    z[l] += w->T->x[r * w->T->n + l] * f;
                    off[l] += 0x1p-106 * w->T->xd[r * w->T->n + l] * fabs(f);
                }
                beyond += w->T->x_most * fabs(f);
            }
            weigh(w, z, off);
            want_rows(w, 0, w->T->n * beyond, inert);
            free(z);
            free(off);
        } else want_field(w, field, field, 0);
        compare(w, u, n, 1, 0, -1);
    }
    free(u);
}

static double *times_of(const trial *c) {
    const int m = c->n_times;
    double *t = ROOM(double, m);
    int q;
    for (q = 0; q < m; q++)
        t[q] = m == 1       ? c->t
               : q == 0     ? c->t
               : q == m - 1 ? c->t * c->span
                            : c->t * pow(c->span, (double)q / (m - 1));
    return t;
}

static void run_times(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n, m = c->n_times;
    const int by_column = c->kind > 0, symmetric = by_column && c->kernel == HD_KERNEL_SYMMETRIC;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *f = ROOM(double, n), *U = ROOM(double, n * m), *inert = ROOM(double, n), *t = times_of(c);
    const int32_t source = draw(&seed, n);
    int32_t q;
    make_field(w, c->field, &seed, f);
    for (q = 0; q < m && c->seed % 2; q++) {     /* in another order */
        const int32_t other = draw(&seed, m);
        const double keep = t[q];
        t[q] = t[other];
        t[other] = keep;
    }
    row_name(w, by_column ? "times, column" : "times, field");
    if (by_column) hd_heat_columns(heat, (hd_kernel)c->kernel, m, t, 1, &source, U, 0, &w->rep, NULL);
    else hd_heat_apply(heat, m, t, 1, f, 0, U, 0, &w->rep, NULL);
    for (q = 0; q < m && !failed(w); q++) {
        filter_for(w, t[q], 0);
        if (by_column) want_column(w, source, symmetric, inert);
        else want_field(w, f, f, 0);
        compare(w, U + q * n, n, 1, 0, -1);
    }
    free(f);
    free(U);
    free(inert);
    free(t);
}

static void run_entries(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const int32_t n = w->s->lap->n, k = c->k < 1 ? 1 : c->k > 64 ? 64 : c->k;
    const int symmetric = c->query == QUERY_ENTRIES && c->kernel == HD_KERNEL_SYMMETRIC,
              weighted = c->kind == HD_DISTANCE_WEIGHTED;
    uint64_t seed = (uint64_t)c->seed + 1;
    double K[64], d[64];
    int32_t i[64], j[64], q, m = 0;
    const int few = chance(&seed, 0.5);
    for (q = 0; q < k; q++) {
        i[q] = draw(&seed, n);
        j[q] = few && q > 0 ? j[0] : draw(&seed, n);
    }
    memset(K, 0, sizeof K);
    memset(d, 0, sizeof d);
    if (c->query == QUERY_ENTRIES) {
        row_name(w, symmetric ? "entries of k_t" : "entries of K_t");
        hd_heat_entries(heat, (hd_kernel)c->kernel, 1, &c->t, k, i, j, K, &w->rep, NULL);
    } else {
        row_name(w, c->kind >= HD_DISTANCE_COMMUTE ? "pairs, no time" : "pairs, d");
        hd_heat_pairs(heat, (hd_distance_kind)c->kind, 1, &c->t, k, i, j, K, d, &w->rep, NULL);
    }
    if (failed(w)) return;
    if (c->query == QUERY_PAIRS) {
        /* distances first; with a filter they are those of columns at t */
        if (c->kind >= HD_DISTANCE_COMMUTE)
            filter_fill(&w->s->f, w->T, c->kind == HD_DISTANCE_COMMUTE ? FORM_COMMUTE : FORM_BIHARMONIC, 0,
                        NULL, 0);
        else filter_for(w, c->t, 1);
        for (q = 0; q < k; q++) {
            const int32_t a = w->s->lap->row[i[q]], b = w->s->lap->row[j[q]];
            if (i[q] == j[q] ||
                (c->kind >= HD_DISTANCE_COMMUTE && (a < 0 || b < 0 || w->T->comp[a] != w->T->comp[b])))
                continue;
            w->want[m] = want_distance(w, i[q], j[q], weighted, w->off + m);
            d[m++] = d[q];
        }
        if (m > 0) compare(w, d, m, 0, 1, -1);
        if (c->kind >= HD_DISTANCE_COMMUTE) return;
        row_name(w, "pairs, K_t");
    }
    filter_for(w, c->t, 0);
    for (q = 0; q < k; q++) w->want[q] = want_entry(w, i[q], j[q], 0, !symmetric, !symmetric, w->off + q);
    compare(w, K, k, 0, 0, -1);
}

static void run_diagonal(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int symmetric = c->kernel == HD_KERNEL_SYMMETRIC;
    double *D = ROOM(double, lap->n * c->n_times), *t = times_of(c);
    int32_t q, v;
    row_name(w, symmetric        ? c->n_times > 1 ? "diagonal k_t, many" : "diagonal of k_t"
                : c->n_times > 1 ? "diagonal K_t, many"
                                 : "diagonal of K_t");
    hd_heat_diagonal(heat, (hd_kernel)c->kernel, c->n_times, t, D, 0, &w->rep, NULL);
    for (q = 0; q < c->n_times && !failed(w); q++) {
        filter_for(w, t[q], 0);
        for (v = 0; v < lap->n; v++) w->want[v] = want_entry(w, v, v, 0, !symmetric, !symmetric, w->off + v);
        compare(w, D + q * lap->n, lap->n, 0, 1, -1);
    }
    free(D);
    free(t);
}

static void run_edges(work *w, hd_heat *heat) {
    const hd_laplacian *lap = w->s->lap;
    double *values = ROOM(double, lap->L.nnz);
    int32_t i;
    int64_t p;
    row_name(w, "edges");
    hd_heat_edges(heat, HD_KERNEL_SYMMETRIC, 1, &w->c->t, values, &w->rep, NULL);
    if (!failed(w)) {
        filter_for(w, w->c->t, 0);
        for (i = 0; i < lap->n_active; i++)
            for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
                w->want[p] = want_entry(w, lap->vertex[i], lap->vertex[lap->L.col[p]], 0, 0, 0, w->off + p);
        compare(w, values, lap->L.nnz, 0, 0, -1);
    }
    free(values);
}

static void run_distance(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n,
                  k = c->k < 1   ? 1
                      : c->k > 8 ? 8
                                 : c->k,
                  m = c->kind >= HD_DISTANCE_COMMUTE ? 1 : c->n_times;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *D = ROOM(double, n * k * m), *t = times_of(c);
    char name[32];
    int32_t source[8], q, r, v;
    for (r = 0; r < k; r++) source[r] = draw(&seed, n);
    snprintf(name, sizeof name, "distance, %s%s",
             c->kind < 2    ? kind_names[c->kind]
             : c->kind == 2 ? "comm."
                            : "biharm.",
             m > 1 ? ", many" : "");
    name[18] = 0;
    row_name(w, name);
    hd_heat_distance(heat, (hd_distance_kind)c->kind, m, t, k, source, D, 0, &w->rep, NULL);
    for (r = 0; r < k && !failed(w); r++)
        for (q = 0; q < m; q++) {
            double *d = D + (r * m + q) * n;
            int32_t count = 0, skip = -1;
            if (c->kind >= HD_DISTANCE_COMMUTE)
                filter_fill(&w->s->f, w->T, c->kind == HD_DISTANCE_COMMUTE ? FORM_COMMUTE : FORM_BIHARMONIC,
                            0, NULL, 0);
            else filter_for(w, 2 * t[q], 0);
            for (v = 0; v < n; v++) {
                const int32_t a = lap->row[v], b = lap->row[source[r]];
                if (c->kind >= HD_DISTANCE_COMMUTE && (a < 0 || b < 0 || w->T->comp[a] != w->T->comp[b]))
                    continue;
                if (v == source[r]) skip = count;
                w->want[count] =
                    want_distance(w, source[r], v, c->kind == HD_DISTANCE_WEIGHTED, w->off + count);
                d[count++] = d[v];
            }
            if (count > 1 || skip < 0) compare(w, d, count, 0, 1, skip);
        }
    free(D);
    free(t);
}

/* The distance of a source of several vertices, c of sum 1, to v: the root of sum g (z_v - sum c_q z_q)^2. */
static quad want_distance_from(work *w, const quad *c, int32_t v, int weighted, double *off) {
    const hd_laplacian *lap = w->s->lap;
    const truth *T = w->T;
    const filter *f = &w->s->f;
    const quad *z = weighted ? T->y : T->x;
    const double most = weighted ? T->y_most : T->x_most;
    quad sum = 0, root;
    double err = 4 * f->cut * T->n * most * most;
    int32_t part, l, r;
    for (part = 0; part < T->n_comp; part++)
        for (l = T->first[part]; l < f->last[part]; l++) {
            quad d = 0, size = 0;
            for (r = 0; r < T->n; r++) {
                const int there = lap->vertex[r] == v;
                const quad x = T->comp[r] == part ? z[r * T->n + l] * (there - c[lap->vertex[r]]) : 0;
                d += x;
                size += fabsq(x);
            }
            sum += f->g[l] * d * d;
            err += f->off[l] * (double)(d * d) + (double)fabsq(f->g[l] * d) * 0x1p-104 * (double)size;
        }
    root = sum > 0 ? sqrtq(sum) : 0;
    *off = root > 0 ? (double)fminq(err / root, sqrtq(err)) : sqrt(err);
    return root;
}

static void run_distance_from(work *w, hd_heat *heat) {
    const trial *c = w->c;
    const hd_laplacian *lap = w->s->lap;
    const int32_t n = lap->n;
    uint64_t seed = (uint64_t)c->seed + 1;
    double *d = ROOM(double, 2 * n), *field = d + n;
    quad *share = ROOM(quad, n), sum = 0;
    int32_t v, count = 0;
    points at;
    hd_source s = draw_source(w, &seed, &at, field);
    char name[32];
    snprintf(name, sizeof name, "from, %s", kind_names[c->kind]);
    row_name(w, name);
    hd_heat_distance_from(heat, (hd_distance_kind)c->kind, 1, &c->t, 1, &s, d, 0, &w->rep, NULL);
    if (!failed(w)) {
        if (c->kind >= HD_DISTANCE_COMMUTE)
            filter_fill(&w->s->f, w->T, c->kind == HD_DISTANCE_COMMUTE ? FORM_COMMUTE : FORM_BIHARMONIC, 0, NULL, 0);
        else filter_for(w, 2 * c->t, 0);
        for (v = 0; v < n; v++) sum += field[v];
        for (v = 0; v < n; v++) share[v] = field[v] / sum;
        for (v = 0; v < n; v++) {
            const int32_t r = lap->row[v];
            if (share[v] == 1) continue;         /* the source is this vertex */
            if (c->kind >= HD_DISTANCE_COMMUTE &&
                (r < 0 || w->T->comp[r] != w->T->comp[lap->row[at.vertex[0]]])) continue;
            w->want[count] = want_distance_from(w, share, v, c->kind == HD_DISTANCE_WEIGHTED, w->off + count);
            d[count++] = d[v];
        }
        if (count > 0) compare(w, d, count, 0, 1, -1);
    }
    free(share);
    free(d);
}

/* A filter of the spectrum near 1/t, fitted; 0: there is none. */
static int make_filter(work *w) {
    const trial *c = w->c;
    const double lambda_max = hd_laplacian_lambda_max(w->s->lap);
    hd_filter *f = &w->s->f.of;
    memset(f, 0, sizeof *f);
    if (!(c->t > 1e-100 && c->t < 1e100 && lambda_max > 0 && lambda_max < 1e100)) return 0;
    f->a = c->t;
    f->b = 0.5;
    switch (c->seed % 5) {
    case 0: f->kind = HD_FILTER_WAVE; f->a = -log(c->t); f->b = 0.7; break;
    case 1: f->kind = HD_FILTER_MEXICAN_HAT; break;
    case 2: f->kind = HD_FILTER_RESOLVENT; break;
    case 3: f->kind = HD_FILTER_FRACTIONAL; break;
    default: f->kind = HD_FILTER_BAND; f->a = 1 / c->t; f->b = 4 / c->t;
    }
    return hd_rational_fit(&w->set, f, lambda_max, &serial, NULL) >= 0;
}

/* A set of the caller's own; 0: this one cannot be had. */
static int make_own(work *w) {
    const trial *c = w->c;
    hd_rational *s = &w->set;
    uint64_t seed = (uint64_t)c->seed + 9;
    const int degree = c->degree < 2 ? 8 : c->degree;
    int32_t p;
    memset(s, 0, sizeof *s);
    w->own = NULL;
    if (c->query == QUERY_FILTER) return make_filter(w);
    if (c->own == OWN_NONE) return 1;
    if (c->own == OWN_COPY || c->own == OWN_COPY0 || c->own == OWN_LOOSE || c->own == OWN_A0) {
        if (hd_rational_get(s, HD_POLES_KERNEL, degree, NULL) < 0) return 0;
        s->kind = HD_POLES_OWN;
        if (c->own == OWN_LOOSE) s->max_weighted_error = 1;
        if (c->own == OWN_COPY0 || c->own == OWN_A0) {
            s->max_error = s->max_weighted_error = 0;
            w->own = s;
        }
        if (c->own == OWN_A0) s->a0 = 0.5;
        return 1;
    }
    s->kind = HD_POLES_OWN;
    w->own = s;
    if (c->own == OWN_NEAR) {                    /* 10^-x above an eigenvalue */
        const truth *T = &w->s->exact;
        const double t = c->query == QUERY_DISTANCE ? 2 * c->t : c->t;
        s->degree = 2;
        s->n_poles = 1;
        s->theta[0].re = -t * (double)T->lambda[c->seed % T->n];
        s->theta[0].im = pow(10, -c->own_x);
        s->a[0].im = 1;
    } else if (c->own == OWN_RESOLVENT) {        /* 1/(1 - x) */
        s->degree = s->n_poles = 1;
        s->theta[0].re = 1;
        s->a[0].re = -1;
    } else {
        s->n_poles = 1 + draw(&seed, 6);
        s->a0 = chance(&seed, 0.3) ? shape_signed(&seed) : 0;
        for (p = 0; p < s->n_poles; p++) {
            s->theta[p].re = 6 * shape_signed(&seed);
            s->theta[p].im = power10(&seed, -1, 1);
            s->a[p].re = shape_signed(&seed);
            s->a[p].im = shape_signed(&seed);
            s->degree += 2;
        }
    }
    return isfinite(s->theta[0].re);
}

static void run_one(subject *s, const trial *c, const char *text, int stored) {
    hd_heat_opts o;
    hd_heat *heat = NULL;
    hd_error e;
    work w;
    const int64_t most = (s->lap->L.nnz > s->lap->n ? s->lap->L.nnz : s->lap->n) + 64;
    memset(&o, 0, sizeof o);
    memset(&w, 0, sizeof w);
    w.s = s;
    w.c = c;
    w.stored = stored;
    w.T = stored ? &s->stored : &s->exact;
    w.text = text;
    if (!make_own(&w)) return;
    o.method = (hd_method)c->method;
    o.solver = (hd_solver)c->solver;
    o.precond = (hd_precond)c->precond;
    o.poles = (hd_pole_kind)c->poles;
    o.degree = c->own ? 0 : c->degree;
    o.tol = c->tol;
    o.max_iterations = 5000;
    o.rational = c->own || c->query == QUERY_FILTER ? &w.set : NULL;
    o.context = &serial;
    if (hd_heat_create(&heat, s->lap, &o, &e) < 0) {
        if (verbose) printf("  no plan: %s\n", e.text);
        return;
    }
    w.want = ROOM(quad, most);
    w.off = ROOM(double, most);
    w.gw = ROOM(quad, s->lap->n_active);
    w.gw_off = ROOM(double, s->lap->n_active);
    switch (c->query) {
    case QUERY_APPLY: case QUERY_COLUMN: run_columns(&w, heat); break;
    case QUERY_TIMES: run_times(&w, heat); break;
    case QUERY_DERIVATIVE: case QUERY_ADJOINT: run_training(&w, heat); break;
    case QUERY_FROM: case QUERY_FILTER: run_from(&w, heat); break;
    case QUERY_DISTANCE_FROM: run_distance_from(&w, heat); break;
    case QUERY_ENTRIES: case QUERY_PAIRS: run_entries(&w, heat); break;
    case QUERY_DIAGONAL: run_diagonal(&w, heat); break;
    case QUERY_EDGES: run_edges(&w, heat); break;
    default: run_distance(&w, heat);
    }
    free(w.want);
    free(w.off);
    free(w.gw);
    free(w.gw_off);
    hd_heat_free(heat);
}

static void subject_free(subject *s) {
    if (s->lap) {
        filter_free(&s->f);
        truth_free(&s->exact);
        if (s->has_stored) truth_free(&s->stored);
        hd_laplacian_free(s->lap);
    }
    memset(s, 0, sizeof *s);
}

/* The pair and its truth; 0: there is none. */
static int subject_make(subject *s, const trial *c, int want_stored) {
    hd_error e;
    int exact;
    memset(s, 0, sizeof *s);
    if (pair_make(&s->lap, c->shape, c->op, c->scale, &e) < 0) {
        if (verbose) printf("  %s %s: %s\n", c->shape, c->op, e.text);
        return 0;
    }
    exact = s->lap->conserves && (s->lap->kind != HD_LAPLACIAN_MATRICES || sums_are_rounding(s->lap));
    if (s->lap->n_active > 400 || !truth_make(&s->exact, s->lap, exact)) {
        if (verbose) printf("  %s %s: B is not positive definite\n", c->shape, c->op);
        hd_laplacian_free(s->lap);
        memset(s, 0, sizeof *s);
        return 0;
    }
    s->has_stored = want_stored && exact && truth_make(&s->stored, s->lap, 0);
    s->unit = unit_time(s->lap);
    s->f = filter_make(&s->exact);
    return 1;
}

/* One case on its subject. */
static void trial_run(subject *s, trial *c, int stored) {
    char text[400];
    if (c->th > 0) c->t = c->th * s->unit;
    c->th = 0;
    if (c->n_times < 1) c->n_times = 1;
    if (c->n_times > 64) c->n_times = 64;
    trial_print(c, text, sizeof text);
    if (verbose)
        printf("%s\n  n %d, components %d, eigenvalues %g .. %g, conserves %d (truth: %d), unit of time %g\n",
               text, (int)s->lap->n_active, (int)s->exact.n_comp, s->exact.edge, s->exact.top,
               (int)s->lap->conserves, s->exact.conserves, s->unit);
    run_one(s, c, text, 0);
    if (stored && s->has_stored && !(c->query >= QUERY_PAIRS && c->kind >= HD_DISTANCE_COMMUTE))
        run_one(s, c, text, 1);
}

/* ==== [7] checks of this program ==== */

static void check(int ok, const char *what) {
    if (ok) return;
    fprintf(stderr, "bounds: this program is wrong: %s\n", what);
    exit(2);
}

/* K_t of a truth against a closed form for the row i, column j. */
typedef quad (*closed_form)(int n, int i, int j, quad t);

static quad closed_cycle(int n, int i, int j, quad t) {
    quad sum = 0;
    int k;
    for (k = 0; k < n; k++)
        sum += expq(-t * (2 - 2 * cosq(2 * M_PIq * k / n))) * cosq(2 * M_PIq * k * (i - j) / n);
    return sum / n;
}

static quad closed_path(int n, int i, int j, quad t) {
    quad sum = 0;
    int k;
    for (k = 0; k < n; k++)
        sum += expq(-t * (2 - 2 * cosq(M_PIq * k / n))) * cosq(M_PIq * k * (i + 0.5Q) / n) *
               cosq(M_PIq * k * (j + 0.5Q) / n) * (k ? 2 : 1);
    return sum / n;
}

static void check_closed(const char *spec, closed_form f, int n) {
    trial c = trial_default();
    subject s;
    static const double ts[] = {1e-3, 1, 30, 1000};
    quad worst = 0;
    int q, i, j;
    strcpy(c.shape, spec);
    strcpy(c.op, "I");
    check(subject_make(&s, &c, 0), "a graph has no truth");
    for (q = 0; q < 4; q++) {
        filter_fill(&s.f, &s.exact, FORM_HEAT, ts[q], NULL, 0);
        for (i = 0; i < n; i++)
            for (j = 0; j < n; j++) {
                quad sum = 0, e;
                int l;
                for (l = 0; l < s.f.last[0]; l++)
                    sum += s.exact.x[i * n + l] * s.f.g[l] * s.exact.y[j * n + l];
                e = fabsq(sum - f(n, i, j, (quad)ts[q]));
                if (e > worst) worst = e;
            }
    }
    check(worst < 1e-31Q, "eigenpairs of a graph with a closed form");
    subject_free(&s);
}

/* |L x - lambda B x| and |x' B x - 1| of all pairs, and all of them there: for pairs without a closed form.
 */
static void check_residuals(const char *spec, const char *op) {
    trial c = trial_default();
    subject s;
    quad worst = 0, unit = 0;
    int i, k, l, n;
    int64_t p;
    snprintf(c.shape, sizeof c.shape, "%s", spec);
    snprintf(c.op, sizeof c.op, "%s", op);
    check(subject_make(&s, &c, 0), "a shape has no truth");
    n = s.lap->n_active;
    for (k = 0; k < n; k++) {
        for (i = 0; i < n; i++) {
            quad lx = 0, bx = 0, size = 0, sum = 0;
            for (p = s.lap->L.row_ptr[i]; p < s.lap->L.row_ptr[i + 1]; p++) {
                const int j = s.lap->L.col[p];
                const quad x = s.exact.x[j * n + k], v = s.lap->L.val[p];
                bx += mass_entry(s.lap, i, p) * x;
                size += fabsq(v * x) + fabsq(s.exact.lambda[k] * mass_entry(s.lap, i, p) * x);
                if (s.exact.conserves && j == i) continue;
                lx += v * x;
                sum += v;
            }
            if (s.exact.conserves) lx -= sum * s.exact.x[i * n + k];
            size += fabsq(sum * s.exact.x[i * n + k]) +
                    1e-15Q * s.exact.top * (quad)s.lap->mass[i] * (quad)s.exact.x_most;
            if (fabsq(lx - s.exact.lambda[k] * bx) > worst * size)
                worst = fabsq(lx - s.exact.lambda[k] * bx) / size;
            if (size > 0 && fabsq(bx - s.exact.y[i * n + k]) > worst * (fabsq(bx) + (quad)s.exact.y_most))
                worst = fabsq(bx - s.exact.y[i * n + k]) / (fabsq(bx) + (quad)s.exact.y_most);
        }
        for (l = 0; l < n; l++) {
            quad sum = l == k ? -1 : 0;
            for (i = 0; i < n; i++) sum += s.exact.x[i * n + k] * s.exact.y[i * n + l];
            if (fabsq(sum) > unit) unit = fabsq(sum);
        }
    }
    if (verbose)
        printf("  %s %s: eigenvalues %g .. %g, residual %.2g, orthonormal to %.2g\n", spec, op, s.exact.edge,
               s.exact.top, (double)worst, (double)unit);
    check(worst < 1e-29Q, "residuals of eigenpairs");
    check(unit < 1e-30Q, "eigenvectors are not orthonormal");
    subject_free(&s);
}

/* Numbers of 192 bits: identities that fail when a carry is lost. */
static void check_wide(void) {
    uint64_t seed = 12;
    int i;
    for (i = 0; i < 2000; i++) {
        const wide a =
            w_mul(w_double(shape_signed(&seed) * power10(&seed, -30, 30)), w_double(shape_signed(&seed)));
        const wide b = w_mul(w_double(shape_signed(&seed) * power10(&seed, -30, 30)),
                             w_double(1 + shape_uniform(&seed)));
        wide e = w_sub(w_mul(w_add(a, b), w_sub(a, b)), w_sub(w_mul(a, a), w_mul(b, b))),
             size = w_add(w_mul(a, a), w_mul(b, b));
        check(!e.sign || e.e < size.e - (WIDE_BITS - 11), "(a + b)(a - b)");
        e = w_sub(w_mul(w_div(a, b), b), a);
        check(!e.sign || e.e < a.e - (WIDE_BITS - 8), "a/b b");
        size = w_mul(a, a);
        e = w_sqrt(size);
        e = w_sub(w_mul(e, e), size);
        check(!e.sign || e.e < size.e - (WIDE_BITS - 8), "the square of a root");
        check(w_sub(w_add(a, b), w_add(b, a)).sign == 0, "a + b and b + a");
        check(w_quad(w_double(1.0 / 3)) == (quad)(1.0 / 3), "a double there and back");
    }
}

/* A bound that is far too small must be found to be so, and no other. */
static void check_comparison(void) {
    trial c = trial_parse("shape=sphere/2 query=column th=10 poles=kernel degree=6 method=direct k=2 seed=5");
    subject s;
    int64_t below;
    check(subject_make(&s, &c, 0), "a sphere has no truth");
    trial_run(&s, &c, 0);
    below = rows_of_table[0].below;
    check(n_rows_of_table == 1 && rows_of_table[0].compared == 2, "comparisons are not counted");
    shrink = 1e-9;
    trial_run(&s, &c, 0);
    shrink = 1;
    check(rows_of_table[0].below == below + 2 && rows_of_table[0].below_b == 2, "a bound that is too small "
                                                                                "is not found");
    check(below == 0, "a bound that should hold does not");
    free(rows_of_table[0].ratio);
    free(rows_of_table[0].ratio_b);
    memset(rows_of_table, 0, sizeof *rows_of_table);
    n_rows_of_table = 0;
    n_records = 0;
    subject_free(&s);
}

static void check_all(void) {
    FILE *const keep = csv;
    const double factor = shrink;
    csv = NULL;
    shrink = 1;
    check_wide();
    check_closed("cycle/12", closed_cycle, 12);
    check_closed("path/15", closed_path, 15);
    check_residuals("sphere/1", "fem");
    check_residuals("grid/4/10", "fem");
    check_residuals("two/1/8", "vor");
    check_residuals("penalty/9/12", "diag");
    check_residuals("weak/12/40", "tri");
    check_comparison();
    csv = keep;
    shrink = factor;
}

/* ==== [8] the run ==== */

/* What is drawn from: a shape with the operators it suits. */
typedef struct family { const char *pattern; int from, to; const char *ops; } family;

/* A %d in a pattern runs from .. to. */
static const family large[] = {{"grid/9/%d", 1, 10, "fem vor cot poly"},
                               {"grid/6/%d", 1, 10, "fem vor fem+id"},
                               {"strip/8/%d", 2, 8, "fem vor vor+tuft"},
                               {"sphere/%d", 1, 3, "fem vor cot poly fem+id vor+tuft"},
                               {"sliver/2/%d", 3, 13, "fem vor cot fem+id"},
                               {"sliver/3/%d/4", 3, 13, "fem vor"},
                               {"bump/8/%d", 1, 3, "fem vor cot poly fem+id vor+id"},
                               {"two/2/%d", 0, 8, "fem vor"},
                               {"two/1/%d/5", 1, 8, "fem vor"},
                               {"cone/%d/6", 5, 14, "fem vor"},
                               {"split/%d/2", 6, 8, "fem vor cot"},
                               {"soup/%d/1", 1, 12, "fem vor"},
                               {"inert/%d/1", 5, 7, "fem vor"},
                               {"fan/20/%d", 0, 6, "fem vor cot"},
                               {"five", 0, 0, "fem vor poly"},
                               {"points/60/%d/1", 0, 2, "vexp exp tuft"},
                               {"points/90/%d/0", 0, 2, "vexp exp tuft"},
                               {"graph/60/%d", 0, 12, "I diag tri"},
                               {"graph/30/%d", 0, 12, "I diag near"},
                               {"lattice/8/%d", 0, 12, "I diag tri"},
                               {"cycle/%d", 58, 61, "I diag tri near"},
                               {"path/%d", 70, 72, "I diag tri near"},
                               {"weak/60/%d", 8, 46, "I diag"},
                               {"weak/66/%d/6", 8, 46, "I"},
                               {"penalty/60/%d", 0, 12, "I diag tri"},
                               {"leak/40/1e-%d", 1, 14, "I diag"},
                               {"turned/24", 0, 0, "I"},
                               {"star/40", 0, 0, "I diag near"},
                               {"none/%d", 1, 5, "I diag"},
                               {"tree/12/%d", 1, 20, "mass2 mass8 mass16"},
                               {"tree/24/%d", 21, 40, "mass2 mass8 mass16"},
                               {"grid/9/%d", 1, 10, "fem+held vor+held poly+held"},
                               {"strip/8/%d", 2, 8, "vor+tuft+held"},
                               {"bump/8/%d", 1, 3, "fem+held cot+held fem+id+held"},
                               {"sphere/%d", 1, 3, "fem+held vor+held"},
                               {"sliver/2/%d", 3, 13, "fem+held"},
                               {"two/2/%d", 0, 8, "fem+held vor+held"},
                               {"split/%d/2", 6, 8, "fem+held"},
                               {"inert/%d/1", 5, 7, "fem+held vor+held"},
                               {"points/60/%d/1", 0, 2, "vexp+held exp+held tuft+held"}};
static const family small[] = {{"grid/5/%d", 2, 10, "fem vor"},
                               {"grid/5/3", 0, 0, "poly cot"},
                               {"sphere/%d", 1, 2, "fem vor"},
                               {"sliver/1/%d", 5, 13, "fem"},
                               {"bump/5/1", 0, 0, "fem vor cot poly vor+id"},
                               {"two/1/%d", 3, 7, "fem"},
                               {"cone/6/4", 0, 0, "fem vor"},
                               {"split/5/2", 0, 0, "vor"},
                               {"soup/5/1", 0, 0, "fem"},
                               {"inert/5/1", 0, 0, "fem"},
                               {"fan/12/3", 0, 0, "vor"},
                               {"points/40/0/1", 0, 0, "vexp exp tuft"},
                               {"graph/24/%d", 3, 11, "I diag"},
                               {"lattice/5/6", 0, 0, "I tri"},
                               {"path/30", 0, 0, "I near"},
                               {"weak/24/%d", 12, 40, "I"},
                               {"penalty/24/%d", 3, 9, "I"},
                               {"leak/24/1e-%d", 4, 12, "I"},
                               {"tree/12/%d", 1, 20, "mass8 mass16"},
                               {"bump/6/1", 0, 0, "fem+held vor+held"},
                               {"two/1/%d", 0, 7, "fem+held"},
                               {"inert/5/1", 0, 0, "vor+held"}};

typedef struct settings {
    int quick;
    int64_t count;
    uint64_t seed;
    const char *query, *shape, *method, *op;
} settings;

static int64_t compared_in_all(void) {
    int64_t sum = 0;
    int i;
    for (i = 0; i < n_rows_of_table; i++) sum += rows_of_table[i].compared;
    return sum;
}

static int wanted(const settings *o, const trial *c) {
    const char *method =
        c->method == HD_METHOD_ITERATIVE && c->solver ? solver_names[c->solver] : method_names[c->method];
    return (!o->query || strstr(query_names[c->query], o->query)) &&
           (!o->shape || strstr(c->shape, o->shape)) && (!o->op || strstr(c->op, o->op)) &&
           (!o->method || strstr(method, o->method));
}

static void run_fixed(const settings *o) {
    subject *made = ROOM(subject, FIXED);        /* each shape once */
    trial *of = ROOM(trial, FIXED);
    int i, k;
    for (i = 0; i < FIXED; i++) {
        of[i] = trial_parse(fixed_cases[i]);
        for (k = 0; strcmp(of[k].shape, of[i].shape) != 0 || strcmp(of[k].op, of[i].op) != 0; k++) {}
        if (!wanted(o, of + i) || (!made[k].lap && !subject_make(made + k, of + i, 0))) continue;
        trial_run(made + k, of + i, 0);
    }
    for (i = 0; i < FIXED; i++) subject_free(made + i);
    free(made);
    free(of);
}

/* Every member of the families in turn, as many comparisons on each. list NULL: they are counted. */
static int64_t run_families(const settings *o, const family *list, int n_list, int64_t each) {
    static const double scales[] = {1, 1, 1e-5, 1e5, 1, 1e80, 1, 1e-80};
    int64_t members = 0;
    int f, x, step;
    for (f = 0; f < n_list; f++) {
        step = o->quick && list[f].to > list[f].from ? (list[f].to - list[f].from + 3) / 4 : 1;
        if (step < 1) step = 1;
        for (x = list[f].from; x <= list[f].to; x += step) {
            const char *op = list[f].ops;
            char spec[32];
            snprintf(spec, sizeof spec, list[f].pattern, x);
            while (*op) {
                trial c = trial_default();
                uint64_t seed = o->seed * 1000003 + (uint64_t)members;
                const int64_t before = compared_in_all();
                subject s;
                int64_t q;
                snprintf(c.shape, sizeof c.shape, "%s", spec);
                snprintf(c.op, sizeof c.op, "%.*s", (int)strcspn(op, " "), op);
                op += strcspn(op, " ");
                op += *op == ' ';
                members++;
                if (each == 0 || (o->shape && !strstr(spec, o->shape))) continue;
                c.scale = scales[shape_random(&seed) % 8];
                if (!subject_make(&s, &c, !o->quick)) continue;
                for (q = 0; compared_in_all() - before < each && q < 2 * each; q++) {
                    trial one = trial_draw(&seed, &c, s.unit);
                    if (wanted(o, &one)) trial_run(&s, &one, q % 8 == 0);
                }
                subject_free(&s);
            }
        }
    }
    return members;
}

static int by_size(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double median(float *list, int64_t n) {
    if (n == 0) return 0;
    qsort(list, (size_t)n, sizeof *list, by_size);
    return list[n / 2];
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const tally *)a)->name, ((const tally *)b)->name);
}

static int print_table(void) {
    int64_t wrong = 0, sum = 0, errors = 0, useless = 0;
    int i;
    qsort(rows_of_table, (size_t)n_rows_of_table, sizeof *rows_of_table, by_name);
    printf("%-28s %9s %7s %8s %6s %8s %9s %7s %5s %9s %9s %9s %12s\n", "query and method", "compared",
           "errors", "warned", "below", "below B", "below rel", "useless", "bad", "worst", "median",
           "median B", "stored");
    for (i = 0; i < n_rows_of_table; i++) {
        tally *r = rows_of_table + i;
        char stored[32], b[32];
        snprintf(stored, sizeof stored, r->stored ? "%lld/%lld" : "-", (long long)r->stored_below,
                 (long long)r->stored);
        snprintf(b, sizeof b, r->n_ratio_b ? "%.2g" : "-", median(r->ratio_b, r->n_ratio_b));
        printf("%-28s %9lld %7lld %8lld %6lld %8lld %9lld %7lld %5lld %9.2g %9.2g %9s %12s\n", r->name,
               (long long)r->compared, (long long)r->errors, (long long)r->warned, (long long)r->below,
               (long long)r->below_b, (long long)r->below_relative, (long long)r->useless, (long long)r->bad,
               r->worst, median(r->ratio, r->n_ratio), b, stored);
        wrong += r->below + r->below_b + r->below_relative + r->bad;
        useless += r->useless;
        sum += r->compared;
        errors += r->errors;
    }
    for (i = 0; i < n_rows_of_table; i++)
        if (rows_of_table[i].worst > 1)
            printf("worst of %s: %.3g\n    --case \"%s\"\n", rows_of_table[i].name, rows_of_table[i].worst,
                   rows_of_table[i].worst_case);
    printf("%lld comparisons, %lld honest errors; below the truth or not finite: %lld; useless without a "
           "warning: %lld\n",
           (long long)sum, (long long)errors, (long long)wrong, (long long)useless);
    printf("the truth's own error was above a hundredth of the bound in %lld comparisons\n",
           (long long)unsure);
    return wrong + useless > 0;
}

static int by_text(const void *a, const void *b) { return strcmp((const char *)a, (const char *)b); }

/* "2599; 0.91; 2e-4" of the records with these two values; "" if there are none */
static void print_cell(int rows, int row, int columns, int column, float *list) {
    int64_t i, n = 0;
    for (i = 0; i < n_records; i++)
        if (records[i].value[rows] == row && records[i].value[columns] == column) list[n++] = records[i].ratio;
    printf(" |");
    if (n == 0) return;
    median(list, n);      /* sorts them */
    printf(" %lld; %.2g; %.1g", (long long)n, list[n - 1], list[n / 2]);
}

static void print_axes(int rows, int columns) {
    char head[VALUES][VALUE_SIZE], side[VALUES][VALUE_SIZE];
    float *list = ROOM(float, n_records);
    const int n = n_axis_values[columns], m = n_axis_values[rows];
    int i, k;
    memcpy(head, axis_values[columns], sizeof head);
    memcpy(side, axis_values[rows], sizeof side);
    qsort(head, (size_t)n, VALUE_SIZE, by_text);
    qsort(side, (size_t)m, VALUE_SIZE, by_text);
    printf("\n| %s", axis_names[rows]);
    for (k = 0; k < n; k++) printf(" | %s", head[k] + (columns == AXIS_T ? 2 : 0));
    printf(" |\n|");
    for (k = 0; k <= n; k++) printf("---|");
    for (i = 0; i < m; i++) {
        printf("\n| %s", side[i] + (rows == AXIS_T ? 2 : 0));
        for (k = 0; k < n; k++) print_cell(rows, axis_value(rows, side[i]), columns, axis_value(columns, head[k]), list);
        printf(" |");
    }
    printf("\n");
    free(list);
}

/* The two axes of ROWS:COLUMNS; 0 if the text is something else. */
static int parse_axes(const char *text, int *axes) {
    int k, i;
    for (k = 0; k < 2; k++) {
        const size_t size = strcspn(text, ":");
        for (i = 0; i < AXES && (strlen(axis_names[i]) != size || strncmp(axis_names[i], text, size) != 0);) i++;
        if (i == AXES || (text[size] == ':') != (k == 0)) return 0;
        axes[k] = i;
        text += size + (k == 0);
    }
    return 1;
}

static const char *argument(int argc, char **argv, int *i) {
    if (*i + 1 >= argc) {
        fprintf(stderr, "bounds: %s takes a value\n", argv[*i]);
        exit(2);
    }
    return argv[++*i];
}

int main(int argc, char **argv) {
    settings o;
    const char *only = NULL;
    int i, self = 0, axes[8][2], n_tables = 0, wrong;
    memset(&o, 0, sizeof o);
    o.count = 1000000;
    o.seed = 1;
    serial.n_threads = 1;
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) o.quick = 1;
        else if (strcmp(argv[i], "--self") == 0) self = 1;
        else if (strcmp(argv[i], "--count") == 0) o.count = strtoll(argument(argc, argv, &i), NULL, 10);
        else if (strcmp(argv[i], "--seed") == 0) o.seed = strtoull(argument(argc, argv, &i), NULL, 10);
        else if (strcmp(argv[i], "--query") == 0) o.query = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--shape") == 0) o.shape = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--method") == 0) o.method = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--op") == 0) o.op = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--case") == 0) only = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--shrink") == 0) shrink = strtod(argument(argc, argv, &i), NULL);
        else if (strcmp(argv[i], "--table") == 0) {
            if (n_tables == 8 || !parse_axes(argument(argc, argv, &i), axes[n_tables++])) {
                fprintf(stderr, "bounds: --table takes two of shape, op, t, query, method, as in shape:t\n");
                return 2;
            }
        } else if (strcmp(argv[i], "--csv") == 0) {
            csv = fopen(argument(argc, argv, &i), "w");
            if (!csv) stop("the csv file cannot be written");
            fprintf(csv, "row,case,column,status,true,error_bound,true_b,error_bound_b,error_relative,below,"
                         "below_b,below_relative,useless,bad\n");
        } else {
            fprintf(stderr, "usage: bounds [--quick] [--count N] [--seed S] [--query NAME] [--shape NAME] "
                            "[--method NAME] [--op NAME] [--table ROWS:COLUMNS] [--csv FILE]\n"
                            "              [--case CASE] [--shrink F] [--self]\n");
            return 2;
        }
    }
    verbose = self;
    check_all();
    if (self) return 0;
    if (only) {
        trial c = trial_parse(only);
        subject s;
        verbose = 1;
        if (!subject_make(&s, &c, 1)) return 2;
        trial_run(&s, &c, 1);
        subject_free(&s);
        return print_table();
    }
    run_fixed(&o);
    if (o.quick) {
        const int n = sizeof small / sizeof *small;
        run_families(&o, small, n, 1 + 4000 / run_families(&o, small, n, 0));
    } else {
        const int n = sizeof large / sizeof *large;
        const int64_t members = run_families(&o, large, n, 0);
        run_families(&o, large, n, (o.count + members - 1) / members);
    }
    if (csv) fclose(csv);
    wrong = print_table();
    for (i = 0; i < n_tables; i++) print_axes(axes[i][0], axes[i][1]);
    return wrong;
}
