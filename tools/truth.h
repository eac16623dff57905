/* truth.h - all eigenpairs of a small pair (L, B), and sums over them, in far more digits than the library has

   Eigenpairs by dense elimination and QL in numbers of 192 bits. Sums are numbers of 113 bits where TRUTH_QUAD is defined
   (GCC, with -lquadmath), else long double: 64 bits on x86, 113 on some other processors, 53 at worst. What that makes of each
   value is summed up beside it, for those who compare. Where the library defines the rows of L to sum to zero, so do we. */

#ifndef TRUTH_H
#define TRUTH_H

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef TRUTH_QUAD
#include <quadmath.h>
__extension__ typedef __float128 quad;
enum { QUAD_BITS = 113 };
#define q_fabs fabsq
#define q_exp expq
#define q_sqrt sqrtq
#define q_fmin fminq
#define q_ldexp ldexpq
#else
typedef long double quad;
enum { QUAD_BITS = LDBL_MANT_DIG };
#define q_fabs fabsl
#define q_exp expl
#define q_sqrt sqrtl
#define q_fmin fminl
#define q_ldexp ldexpl
#endif

/* 2^-104 with 113 bits: what a term may be off by, with room for the roundings before it. */
#define TRUTH_EPS ldexp(512, -QUAD_BITS)

static void truth_stop(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(2);
}

static void *truth_room(int64_t count, size_t size) {
    void *p = calloc(count > 0 ? (size_t)count : 1, size);
    if (!p) truth_stop("out of memory");
    return p;
}

#define TRUTH_NEW(type, count) ((type *)truth_room((int64_t)(count), sizeof(type)))

/* ==== [1] numbers of 192 bits ==== */
/* A number is sign * 0.m * 2^e: m in words, the lowest first, the top bit of the highest set; sign 0 is
 * zero. Results are cut off, not rounded: relative errors are below 2^-189. */

#ifdef __SIZEOF_INT128__
typedef uint64_t w_word;
__extension__ typedef unsigned __int128 w_double_word;
enum { WORD_BITS = 64 };
#else
typedef uint32_t w_word;
typedef uint64_t w_double_word;
enum { WORD_BITS = 32 };
#endif
enum { WIDE_BITS = 192, WORDS = WIDE_BITS / WORD_BITS };

typedef struct w_wide { w_word m[WORDS]; int64_t e; int sign; } w_wide;

static w_wide w_zero(void) {
    w_wide r;
    memset(&r, 0, sizeof r);
    return r;
}

static w_wide w_double(double x) {
    w_wide r = w_zero();
    uint64_t m;
    int e = 0;
    if (x == 0) return r;
    m = (uint64_t)ldexp(frexp(fabs(x), &e), 53) << 11;
    r.m[WORDS - 1] = (w_word)(m >> (64 - WORD_BITS));
    if (WORD_BITS < 64) r.m[WORDS - 2] = (w_word)m;
    r.e = e;
    r.sign = x < 0 ? -1 : 1;
    return r;
}

static quad w_quad(w_wide a) {
    quad q = 0;
    int k;
    for (k = 0; k < WORDS; k++) q = q_ldexp(q + (quad)a.m[k], -WORD_BITS);
    return a.sign == 0 ? 0 : q_ldexp(a.sign < 0 ? -q : q, (int)a.e);
}

static w_wide w_neg(w_wide a) {
    a.sign = -a.sign;
    return a;
}

static w_wide w_half(w_wide a) {
    a.e--;
    return a;
}

static int w_zeros(w_word m) {                   /* above the highest bit */
    int bits = 0;
    for (; m && !(m >> (WORD_BITS - 1)); m = (w_word)(m << 1)) bits++;
    return bits;
}

/* Left until the top bit is set. */
static w_wide w_normal(w_wide a) {
    int words = 0, bits, k;
    while (words < WORDS && a.m[WORDS - 1 - words] == 0) words++;
    if (words == WORDS) return w_zero();
    bits = w_zeros(a.m[WORDS - 1 - words]);
    for (k = WORDS - 1; k >= 0; k--) {
        const w_word high = k >= words ? a.m[k - words] : 0, low = k > words ? a.m[k - words - 1] : 0;
        a.m[k] = bits ? (w_word)(high << bits | low >> (WORD_BITS - bits)) : high;
    }
    a.e -= WORD_BITS * words + bits;
    return a;
}

/* |a| < |b| */
static int w_smaller(const w_wide *a, const w_wide *b) {
    int k;
    if (!a->sign || !b->sign) return !a->sign && b->sign;
    if (a->e != b->e) return a->e < b->e;
    for (k = WORDS - 1; k >= 0; k--)
        if (a->m[k] != b->m[k]) return a->m[k] < b->m[k];
    return 0;
}

static w_wide w_add(w_wide a, w_wide b) {
    int64_t shift;
    int words, bits, k;
    w_word carry = 0;
    if (w_smaller(&a, &b)) {
        const w_wide keep = a;
        a = b;
        b = keep;
    }
    shift = a.e - b.e;
    if (!b.sign || shift >= WIDE_BITS) return a;
    words = (int)(shift / WORD_BITS);
    bits = (int)(shift % WORD_BITS);
    for (k = 0; k < WORDS; k++) {                /* b to the right */
        const w_word low = k + words < WORDS ? b.m[k + words] : 0,
                       high = k + words + 1 < WORDS ? b.m[k + words + 1] : 0;
        b.m[k] = bits ? (w_word)(low >> bits | high << (WORD_BITS - bits)) : low;
    }
    if (a.sign == b.sign) {
        for (k = 0; k < WORDS; k++) {
            const w_double_word t = (w_double_word)a.m[k] + b.m[k] + carry;
            a.m[k] = (w_word)t;
            carry = (w_word)(t >> WORD_BITS);
        }
        if (!carry) return a;
        for (k = 0; k < WORDS; k++) a.m[k] = (w_word)(a.m[k] >> 1 | (k + 1 < WORDS ? a.m[k + 1] : 1) << (WORD_BITS - 1));
        a.e++;
        return a;
    }
    for (k = 0; k < WORDS; k++) {
        const w_double_word t = (w_double_word)a.m[k] - b.m[k] - carry;
        a.m[k] = (w_word)t;
        carry = (w_word)(t >> WORD_BITS) & 1;
    }
    return a.m[WORDS - 1] >> (WORD_BITS - 1) ? a : w_normal(a);
}

static w_wide w_sub(w_wide a, w_wide b) { return w_add(a, w_neg(b)); }

static w_wide w_mul(w_wide a, w_wide b) {
    w_word p[2 * WORDS];
    w_wide r;
    int i, j;
    if (!a.sign || !b.sign) return w_zero();
    memset(p, 0, sizeof p);
    for (i = 0; i < WORDS; i++) {
        w_word carry = 0;
        for (j = 0; j < WORDS; j++) {
            const w_double_word t = (w_double_word)a.m[i] * b.m[j] + p[i + j] + carry;
            p[i + j] = (w_word)t;
            carry = (w_word)(t >> WORD_BITS);
        }
        p[i + WORDS] = carry;
    }
    r.e = a.e + b.e;
    r.sign = a.sign * b.sign;
    if (p[2 * WORDS - 1] >> (WORD_BITS - 1)) {
        memcpy(r.m, p + WORDS, sizeof r.m);
    } else {
        for (i = 0; i < WORDS; i++) r.m[i] = (w_word)(p[WORDS + i] << 1 | p[WORDS + i - 1] >> (WORD_BITS - 1));
        r.e--;
    }
    return r;
}

/* 1/a by Newton, three steps from a double. */
static w_wide w_recip(w_wide a) {
    const int64_t e = a.e;
    const w_wide one = w_double(1);
    w_wide x;
    int k, sign = a.sign;
    if (!sign) truth_stop("division by zero");
    a.e = 0;
    a.sign = 1;
    x = w_double(1 / ldexp((double)a.m[WORDS - 1], -WORD_BITS));
    for (k = 0; k < 3; k++) x = w_add(x, w_mul(x, w_sub(one, w_mul(a, x))));
    x.e -= e;
    x.sign = sign;
    return x;
}

static w_wide w_div(w_wide a, w_wide b) { return w_mul(a, w_recip(b)); }

/* The root of a >= 0, as a/sqrt(a), by Newton. */
static w_wide w_sqrt(w_wide a) {
    const w_wide one = w_double(1);
    w_wide f = a, x;
    int k;
    if (a.sign <= 0) return w_zero();
    f.e = a.e & 1;                               /* in [1/2, 2) */
    x = w_double(1 / sqrt(ldexp((double)f.m[WORDS - 1], (int)f.e - WORD_BITS)));
    for (k = 0; k < 3; k++) x = w_add(x, w_half(w_mul(x, w_sub(one, w_mul(f, w_mul(x, x))))));
    x.e -= (a.e - f.e) / 2;
    return w_mul(a, x);
}

/* ==== [2] dense eigenvalues ==== */
/* Matrices n x n by columns: (i,j) is at a[j n + i]. Householder's tridiagonal form and implicit QL as
 * EISPACK's tred2 and tql2 have them (Bowdler, Martin, Reinsch, Wilkinson 1968). */

static void w_tridiagonal(w_wide *a, int n, w_wide *d, w_wide *e) {
    int i, j, k;
    for (j = 0; j < n; j++) d[j] = a[j * n + n - 1];
    for (i = n - 1; i > 0; i--) {
        w_wide h = w_zero(), f, g, hh;
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
            const w_wide *column = a + j * n;
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
            const w_wide r = w_recip(d[i + 1]);
            for (k = 0; k <= i; k++) d[k] = w_mul(a[(i + 1) * n + k], r);
            for (j = 0; j <= i; j++) {
                w_wide g = w_zero();
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

static w_wide w_hypot(w_wide a, w_wide b) { return w_sqrt(w_add(w_mul(a, a), w_mul(b, b))); }

static void w_ql(w_wide *a, int n, w_wide *d, w_wide *e) {
    w_wide f = w_zero(), most = w_zero();
    int i, k, l, m, steps;
    for (i = 1; i < n; i++) e[i - 1] = e[i];
    e[n - 1] = w_zero();
    for (l = 0; l < n; l++) {
        w_wide size = d[l], tiny = e[l];
        size.sign = size.sign != 0;
        tiny.sign = tiny.sign != 0;
        size = w_add(size, tiny);
        if (w_smaller(&most, &size)) most = size;
        tiny = most;
        tiny.e -= WIDE_BITS - 3;
        for (m = l; m < n - 1 && w_smaller(&tiny, e + m); m++) {}
        for (steps = 0; m > l && w_smaller(&tiny, e + l); steps++) {
            const w_wide one = w_double(1), el1 = e[l + 1];
            w_wide g = d[l], p = w_half(w_div(w_sub(d[l + 1], g), e[l])), r = w_hypot(p, one), h, dl1, c = one,
                 c2 = one, c3 = one, s = w_zero(), s2 = s;
            if (steps == 200) truth_stop("QL does not converge");
            if (p.sign < 0) r = w_neg(r);
            d[l] = w_div(e[l], w_add(p, r));
            d[l + 1] = w_mul(e[l], w_add(p, r));
            dl1 = d[l + 1];
            h = w_sub(g, d[l]);
            for (i = l + 2; i < n; i++) d[i] = w_sub(d[i], h);
            f = w_add(f, h);
            p = d[m];
            for (i = m - 1; i >= l; i--) {
                w_wide *x = a + i * n, *y = x + n;
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
                    const w_wide q = w_recip(r);
                    s = w_mul(e[i], q);
                    c = w_mul(p, q);
                }
                p = w_sub(w_mul(c, d[i]), w_mul(s, g));
                d[i + 1] = w_add(h, w_mul(s, w_add(w_mul(c, g), w_mul(s, d[i]))));
                for (k = 0; k < n; k++) {
                    const w_wide t = y[k];
                    y[k] = w_add(w_mul(s, x[k]), w_mul(c, t));
                    x[k] = w_sub(w_mul(c, x[k]), w_mul(s, t));
                }
            }
            if (!dl1.sign) truth_stop("QL breaks down");
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
typedef struct truth_pairs {
    int32_t n, n_comp;
    int conserves;
    quad *lambda, *x, *y;
    double *xd, *yd;             /* |x|, |y| */
    int32_t *comp, *first;       /* of a row; [n_comp + 1] modes of a component */
    double off;                  /* bound on the errors of lambda */
    double edge, top;            /* the smallest and largest |lambda| that is not zero */
    double x_most, y_most;
} truth_pairs;

static void truth_free(truth_pairs *T) {
    free(T->lambda);
    free(T->x);
    free(T->y);
    free(T->xd);
    free(T->yd);
    free(T->comp);
    free(T->first);
    memset(T, 0, sizeof *T);
}

static double truth_mass(const hd_laplacian *lap, int32_t i, int64_t p) {
    return lap->B ? lap->B[p] : lap->L.col[p] == i ? lap->mass[i] : 0;
}

static int32_t truth_root(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Components of the entries of L and B that are not zero, numbered by their first row. Returns how many. */
static int32_t truth_components(const hd_laplacian *lap, int32_t *comp) {
    const int32_t n = lap->n_active;
    int32_t *parent = TRUTH_NEW(int32_t, n), i, count = 0;
    int64_t p;
    for (i = 0; i < n; i++) parent[i] = i;
    for (i = 0; i < n; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.val[p] != 0 || truth_mass(lap, i, p) != 0) {
                const int32_t a = truth_root(parent, i), b = truth_root(parent, lap->L.col[p]);
                parent[a > b ? a : b] = a > b ? b : a;
            }
    for (i = 0; i < n; i++) comp[i] = truth_root(parent, i) == i ? count++ : comp[truth_root(parent, i)];
    free(parent);
    return count;
}

/* Is what the rows of L sum to no more than rounding? The sums are exact. */
static int truth_rounding(const hd_laplacian *lap) {
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        w_wide sum = w_zero();
        double size = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            sum = w_add(sum, w_double(lap->L.val[p]));
            size += fabs(lap->L.val[p]);
        }
        if (q_fabs(w_quad(sum)) >
            (quad)size * (quad)(lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) * (quad)DBL_EPSILON)
            return 0;
    }
    return 1;
}

/* One component: rows[0..m), its modes from `at` on. exact: the diagonal of L is minus the sum of the row's
 * others. */
static int truth_component(truth_pairs *T, const hd_laplacian *lap, const int32_t *rows, int32_t m, int32_t at,
                           int exact) {
    w_wide *L = TRUTH_NEW(w_wide, m * m), *G = TRUTH_NEW(w_wide, m * m), *d = TRUTH_NEW(w_wide, m), *e = TRUTH_NEW(w_wide, m),
         total = w_zero();
    int32_t *place = TRUTH_NEW(int32_t, T->n), *order = TRUTH_NEW(int32_t, m), i, j, k;
    int ok = 1;
    int64_t p;
    for (i = 0; i < T->n; i++) place[i] = -1;
    for (i = 0; i < m; i++) place[rows[i]] = i;
    for (i = 0; i < m; i++) {
        w_wide sum = w_zero();
        for (p = lap->L.row_ptr[rows[i]]; p < lap->L.row_ptr[rows[i] + 1]; p++) {
            const w_wide b = w_double(truth_mass(lap, rows[i], p)), l = w_double(lap->L.val[p]);
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
            w_wide *column = L + j * m;
            int32_t q;
            for (i = 0; i < m; i++) {
                column[i] = w_mul(column[i], d[i]);
                for (q = i + 1; q < m; q++)
                    if (G[i * m + q].sign) column[q] = w_sub(column[q], w_mul(G[i * m + q], column[i]));
            }
        }
        for (j = 0; j < m; j++)
            for (i = 0; i < j; i++) {
                const w_wide t = L[j * m + i];
                L[j * m + i] = L[i * m + j];
                L[i * m + j] = t;
            }
    }
    if (ok) {
        w_wide *diag = TRUTH_NEW(w_wide, m);
        memcpy(diag, d, (size_t)m * sizeof *diag);
        w_tridiagonal(L, m, d, e);
        w_ql(L, m, d, e);
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
            w_wide *v = L + order[k] * m;
            const quad lambda = zero ? 0 : w_quad(d[order[k]]);
            T->lambda[at + k] = lambda;
            if ((double)q_fabs(lambda) > T->top) T->top = (double)q_fabs(lambda);
            for (i = 0; i < m; i++) {            /* y = G v */
                w_wide sum = w_zero();
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
                const w_wide one = w_recip(w_sqrt(total));
                for (i = 0; i < m; i++) {
                    w_wide sum = w_zero();
                    for (p = lap->L.row_ptr[rows[i]]; p < lap->L.row_ptr[rows[i] + 1]; p++)
                        sum = w_add(sum, w_double(truth_mass(lap, rows[i], p)));
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
static int truth_make(truth_pairs *T, const hd_laplacian *lap, int exact) {
    const int32_t n = lap->n_active;
    int32_t *rows = TRUTH_NEW(int32_t, n), c, i, m;
    int ok = 1;
    memset(T, 0, sizeof *T);
    T->n = n;
    T->conserves = exact;
    T->lambda = TRUTH_NEW(quad, n);
    T->x = TRUTH_NEW(quad, n * n);
    T->y = TRUTH_NEW(quad, n * n);
    T->xd = TRUTH_NEW(double, n * n);
    T->yd = TRUTH_NEW(double, n * n);
    T->comp = TRUTH_NEW(int32_t, n);
    T->n_comp = truth_components(lap, T->comp);
    T->first = TRUTH_NEW(int32_t, T->n_comp + 1);
    for (c = 0; c < T->n_comp && ok; c++) {
        for (i = 0, m = 0; i < n; i++)
            if (T->comp[i] == c) rows[m++] = i;
        ok = truth_component(T, lap, rows, m, T->first[c],
                             exact && isfinite(lap->component_mass[lap->component[rows[0]]]));
        T->first[c + 1] = T->first[c] + m;
    }
    for (i = 0; i < n * n; i++) {
        T->xd[i] = (double)q_fabs(T->x[i]);
        T->yd[i] = (double)q_fabs(T->y[i]);
        T->x_most = fmax(T->x_most, T->xd[i]);
        T->y_most = fmax(T->y_most, T->yd[i]);
    }
    T->off = T->top * ldexp(n, -WIDE_BITS + 14);   /* n eps |L|, and some room */
    T->edge = T->top;
    /* (a pair that need not conserve heat may do so up to rounding) */
    for (i = 0; i < n; i++)
        if ((double)q_fabs(T->lambda[i]) > T->off) T->edge = fmin(T->edge, (double)q_fabs(T->lambda[i]));
    if (exact && T->off > 1e-18 * T->edge)
        fprintf(stderr, "note: eigenvalues of %g beside %g\n", T->edge, T->top);
    free(rows);
    if (!ok) truth_free(T);
    return ok;
}

/* What the truth is to be made for: exp(-t lambda) or poles of one's own, 1/lambda, 1/lambda^2, the
 * derivative -lambda exp(-t lambda), a filter by its formula; or the square of the first. */
typedef enum truth_form { FORM_HEAT, FORM_COMMUTE, FORM_BIHARMONIC, FORM_DERIVATIVE, FORM_FILTER } truth_form;

/* Filters are evaluated in doubles. */
#define FILTER_OFF 1e-13

/* A function of every lambda, and what each term is off by relative to itself; last: where the modes of a
 * component end that count. */
typedef struct truth_filter {
    quad *g;
    double *off, cut;
    int32_t *last;
    hd_filter of;                /* FORM_FILTER */
} truth_filter;

static truth_filter truth_filter_make(const truth_pairs *T) {
    truth_filter f;
    f.g = TRUTH_NEW(quad, T->n);
    f.off = TRUTH_NEW(double, T->n);
    f.last = TRUTH_NEW(int32_t, T->n_comp);
    f.cut = 0;
    memset(&f.of, 0, sizeof f.of);
    return f;
}

static void truth_filter_free(truth_filter *f) {
    free(f->g);
    free(f->off);
    free(f->last);
}

/* c(x), and how much rounding there is in it. */
static quad truth_rational(const hd_rational *set, quad x, double *off) {
    quad sum = set->a0, size = q_fabs(sum);
    int32_t p;
    for (p = 0; p < set->n_poles; p++) {         /* a/(x - theta) = a conj(x - theta)/|x - theta|^2 */
        const quad re = x - set->theta[p].re, im = -(quad)set->theta[p].im, d = re * re + im * im,
                   a = set->a[p].re, b = set->a[p].im;
        const quad count = set->theta[p].im != 0 ? 2 : 1;
        sum += count * (a * re + b * im) / d;
        size +=
            count * (q_fabs(a) + q_fabs(b)) * (q_fabs(x) + q_fabs(set->theta[p].re) + q_fabs(im) + q_fabs(re)) / d;
    }
    *off = sum == 0 ? 0 : (double)(size / q_fabs(sum)) * TRUTH_EPS;
    return sum;
}

static void truth_filter_fill(truth_filter *f, const truth_pairs *T, truth_form what, double t, const hd_rational *own, int squared) {
    int32_t c, l;
    f->cut = 0;
    for (c = 0; c < T->n_comp; c++) {
        f->last[c] = T->first[c + 1];
        for (l = T->first[c]; l < T->first[c + 1]; l++) {
            const quad lambda = T->lambda[l], x = -(quad)t * lambda;
            double off = lambda == 0 ? 0 : T->off / (double)q_fabs(lambda);
            quad g;
            if (what == FORM_COMMUTE) g = lambda == 0 ? 0 : 1 / lambda;
            else if (what == FORM_BIHARMONIC) g = lambda == 0 ? 0 : 1 / (lambda * lambda);
            else if (what == FORM_FILTER) {
                g = hd_filter_eval(&f->of, (double)lambda > 0 ? (double)lambda : 0);
                off = FILTER_OFF;
            } else if (own) g = truth_rational(own, x, &off);
            else {
                off = (double)(q_fabs(x) * (TRUTH_EPS / 16) + (lambda == 0 ? 0 : (quad)t * (quad)T->off)) + TRUTH_EPS;
                g = x < -11000 ? 0 : q_exp(x);
                if (what == FORM_DERIVATIVE) {
                    off += lambda == 0 ? 0 : T->off / (double)q_fabs(lambda);
                    g *= -lambda;
                }
            }
            if (squared) g *= g;
            f->g[l] = g;
            f->off[l] = (2 * off + TRUTH_EPS) * (double)q_fabs(g);
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
static quad truth_sum(const truth_pairs *T, const truth_filter *f, int32_t c, const quad *left, const double *left_abs,
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

#endif
