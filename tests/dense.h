/* dense.h - small dense matrices for the tests: the oracle that the library is held against

   Nothing here knows how the library computes: eigensolutions by Householder and implicit QR, complex systems by LU with
   pivoting. Meant for n up to some hundreds. Memory that cannot be had ends the program: a test has nothing better to do. */

#ifndef DENSE_H
#define DENSE_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- memory and chance ---- */

static void *dense_alloc(int64_t count, size_t size) {
    void *p = calloc(count > 0 ? (size_t)count : 1, size);
    if (!p) {
        fprintf(stderr, "tests: out of memory\n");
        exit(2);
    }
    return p;
}

#define DENSE_NEW(type, count) ((type *)dense_alloc((int64_t)(count), sizeof(type)))

/* xorshift64*: the same numbers on every machine. */
static uint64_t dense_random(uint64_t *state) {
    uint64_t x = *state ? *state : 88172645463325252u;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return x * 2685821657736338717u;
}

/* In [-1, 1). */
static double dense_signed(uint64_t *state) { return (double)(dense_random(state) >> 11) * (1.0 / 4503599627370496.0) - 1; }

/* A random permutation of 0..n-1 (Fisher, Yates). */
static void dense_shuffle(int32_t *perm, int32_t n, uint64_t *state) {
    int32_t i;
    for (i = 0; i < n; i++) perm[i] = i;
    for (i = n - 1; i > 0; i--) {
        const int32_t j = (int32_t)(dense_random(state) % (uint64_t)(i + 1)), keep = perm[i];
        perm[i] = perm[j];
        perm[j] = keep;
    }
}

/* ---- vectors ---- */

static double dense_dot(const double *x, const double *y, int32_t n) {
    double s = 0;
    int32_t i;
    for (i = 0; i < n; i++) s += x[i] * y[i];
    return s;
}

static double dense_max_abs(const double *x, int64_t n) {
    double m = 0;
    int64_t i;
    for (i = 0; i < n; i++)
        if (!(fabs(x[i]) <= m)) m = fabs(x[i]);    /* a NaN is handed on */
    return m;
}

static double dense_max_diff(const double *x, const double *y, int64_t n) {
    double m = 0;
    int64_t i;
    for (i = 0; i < n; i++)
        if (!(fabs(x[i] - y[i]) <= m)) m = fabs(x[i] - y[i]);
    return m;
}

/* y = A x, A n x n by rows. */
static void dense_apply(const double *a, const double *x, double *y, int32_t n) {
    int32_t i;
    for (i = 0; i < n; i++) y[i] = dense_dot(a + (size_t)i * (size_t)n, x, n);
}

/* ---- symmetric eigensolution ---- */

/* Householder: A = Q T Q', T tridiagonal with diagonal d [n] and off-diagonal e [n - 1]. q [n n] receives Q' by rows, so that the
 * rows become eigenvectors when T's rotations are applied to them. a is destroyed. */
static void dense_tridiagonal(double *a, double *q, double *d, double *e, int32_t n) {
    const size_t ld = (size_t)n;
    double *p = DENSE_NEW(double, n), *beta = DENSE_NEW(double, n);
    int32_t i, j, k;
    for (k = 0; k + 2 < n; k++) {
        double *v = a + (size_t)k * ld;          /* row k right of the diagonal: by symmetry the column below it */
        double norm = 0, alpha, scale = 0;
        for (i = k + 1; i < n; i++) norm = hypot(norm, v[i]);
        alpha = v[k + 1] > 0 ? -norm : norm;
        e[k] = alpha;
        v[k + 1] -= alpha;
        for (i = k + 1; i < n; i++) scale += v[i] * v[i];
        beta[k] = scale > 0 ? 2 / scale : 0;
        if (beta[k] == 0) continue;
        for (i = k + 1; i < n; i++) p[i] = beta[k] * dense_dot(a + (size_t)i * ld + k + 1, v + k + 1, n - k - 1);
        scale = beta[k] / 2 * dense_dot(p + k + 1, v + k + 1, n - k - 1);
        for (i = k + 1; i < n; i++) p[i] -= scale * v[i];
        for (i = k + 1; i < n; i++)
            for (j = k + 1; j < n; j++) a[(size_t)i * ld + (size_t)j] -= v[i] * p[j] + p[i] * v[j];
    }
    if (n > 1) e[n - 2] = a[ld * (ld - 2) + ld - 1];
    for (i = 0; i < n; i++) d[i] = a[(size_t)i * ld + (size_t)i];
    memset(q, 0, ld * ld * sizeof *q);
    for (i = 0; i < n; i++) q[(size_t)i * ld + (size_t)i] = 1;
    for (k = n - 3; k >= 0; k--) {               /* Q' = I H_(n-3) ... H_0, from the right */
        const double *v = a + (size_t)k * ld;
        for (i = k + 1; i < n; i++) {
            double *row = q + (size_t)i * ld;
            const double s = beta[k] * dense_dot(row + k + 1, v + k + 1, n - k - 1);
            for (j = k + 1; j < n; j++) row[j] -= s * v[j];
        }
    }
    free(p);
    free(beta);
}

/* One implicit QR step with Wilkinson's shift on the unreduced block lo..hi (Golub, Van Loan, section 8.3). */
static void dense_qr_step(double *d, double *e, double *q, int32_t lo, int32_t hi, int32_t n) {
    const double half = (d[hi - 1] - d[hi]) / 2, b = e[hi - 1];
    const double shift = d[hi] - b * (b / (half + (half < 0 ? -hypot(half, b) : hypot(half, b))));
    double x = d[lo] - shift, z = e[lo];
    int32_t k, i;
    for (k = lo; k < hi; k++) {
        const double r = hypot(x, z), c = r > 0 ? x / r : 1, s = r > 0 ? z / r : 0, dk = d[k], ek = e[k], dl = d[k + 1];
        double *u = q + (size_t)k * (size_t)n, *w = u + n;
        if (k > lo) e[k - 1] = r;
        d[k] = c * c * dk + 2 * c * s * ek + s * s * dl;
        d[k + 1] = s * s * dk - 2 * c * s * ek + c * c * dl;
        e[k] = c * s * (dl - dk) + (c * c - s * s) * ek;
        x = e[k];
        if (k + 1 < hi) {
            z = s * e[k + 1];
            e[k + 1] *= c;
        }
        for (i = 0; i < n; i++) {
            const double uk = u[i];
            u[i] = c * uk + s * w[i];
            w[i] = c * w[i] - s * uk;
        }
    }
}

/* Eigenvalues d [n] and eigenvectors, the rows of q [n n], of the symmetric a [n n], which is destroyed. 1 on success. */
static int dense_symmetric_eigen(double *a, double *q, double *d, int32_t n) {
    double *e = DENSE_NEW(double, n);
    int32_t hi = n - 1, lo, steps = 0;
    dense_tridiagonal(a, q, d, e, n);
    while (hi > 0 && steps < 60 * n) {
        for (lo = hi; lo > 0; lo--)
            if (fabs(e[lo - 1]) <= DBL_EPSILON / 2 * (fabs(d[lo - 1]) + fabs(d[lo]))) break;
        if (lo > 0) e[lo - 1] = 0;
        if (lo == hi) hi--;
        else {
            dense_qr_step(d, e, q, lo, hi, n);
            steps++;
        }
    }
    free(e);
    return hi <= 0;
}

/* ---- the pair L x = lambda B x ---- */

typedef struct dense_pair {
    int32_t n;
    double *L, *B;      /* [n n] */
    double *lambda;     /* [n], not sorted */
    double *x;          /* [n n], row k: the eigenvector of lambda[k], x_j' B x_k = 1 if j = k, else 0 */
} dense_pair;

static void dense_pair_free(dense_pair *p) {
    free(p->L);
    free(p->B);
    free(p->lambda);
    free(p->x);
    memset(p, 0, sizeof *p);
}

/* r [n n] lower: B = R R'. 0 if B is not positive definite. */
static int dense_cholesky(double *r, int32_t n) {
    const size_t ld = (size_t)n;
    int32_t i, j;
    for (i = 0; i < n; i++) {
        for (j = 0; j <= i; j++) {
            const double s = r[(size_t)i * ld + (size_t)j] - dense_dot(r + (size_t)i * ld, r + (size_t)j * ld, j);
            if (j < i) r[(size_t)i * ld + (size_t)j] = s / r[(size_t)j * ld + (size_t)j];
            else if (s > 0) r[(size_t)i * ld + (size_t)i] = sqrt(s);
            else return 0;
        }
    }
    return 1;
}

/* x = R^-1 x */
static void dense_forward(const double *r, double *x, int32_t n) {
    int32_t i;
    for (i = 0; i < n; i++) x[i] = (x[i] - dense_dot(r + (size_t)i * (size_t)n, x, i)) / r[(size_t)i * (size_t)n + (size_t)i];
}

/* x = R'^-1 x */
static void dense_backward(const double *r, double *x, int32_t n) {
    int32_t i, j;
    for (i = n - 1; i >= 0; i--) {
        x[i] /= r[(size_t)i * (size_t)n + (size_t)i];
        for (j = 0; j < i; j++) x[j] -= r[(size_t)i * (size_t)n + (size_t)j] * x[i];
    }
}

static void dense_transpose(double *a, int32_t n) {
    int32_t i, j;
    for (i = 0; i < n; i++) {
        for (j = 0; j < i; j++) {
            const double keep = a[(size_t)i * (size_t)n + (size_t)j];
            a[(size_t)i * (size_t)n + (size_t)j] = a[(size_t)j * (size_t)n + (size_t)i];
            a[(size_t)j * (size_t)n + (size_t)i] = keep;
        }
    }
}

/* Takes L and B [n n] over. 1 on success. Eigenvalues that are zero but for rounding become zero, so that large times are fine. */
static int dense_pair_solve(dense_pair *p, double *L, double *B, int32_t n) {
    const size_t size = (size_t)n * (size_t)n * sizeof(double);
    double *r = DENSE_NEW(double, (int64_t)n * n), *c = DENSE_NEW(double, (int64_t)n * n), top;
    int32_t i;
    int ok;
    p->n = n;
    p->L = L;
    p->B = B;
    p->lambda = DENSE_NEW(double, n);
    p->x = DENSE_NEW(double, (int64_t)n * n);
    memcpy(r, B, size);
    memcpy(c, L, size);
    ok = dense_cholesky(r, n);
    for (i = 0; ok && i < n; i++) dense_forward(r, c + (size_t)i * (size_t)n, n);    /* L R'^-1, by rows as L is symmetric */
    dense_transpose(c, n);
    for (i = 0; ok && i < n; i++) dense_forward(r, c + (size_t)i * (size_t)n, n);
    ok = ok && dense_symmetric_eigen(c, p->x, p->lambda, n);
    for (i = 0; ok && i < n; i++) dense_backward(r, p->x + (size_t)i * (size_t)n, n);
    top = dense_max_abs(p->lambda, n);
    for (i = 0; i < n; i++)
        if (fabs(p->lambda[i]) < 1e-13 * n * top) p->lambda[i] = 0;
    free(r);
    free(c);
    return ok;
}

/* u = X g X' rhs: with rhs = B f this is g(B^-1 L) f. g [n] on the eigenvalues. */
static void dense_pair_filter(const dense_pair *p, const double *g, const double *rhs, double *u) {
    int32_t i, k;
    memset(u, 0, (size_t)p->n * sizeof *u);
    for (k = 0; k < p->n; k++) {
        const double *x = p->x + (size_t)k * (size_t)p->n, c = g[k] * dense_dot(x, rhs, p->n);
        for (i = 0; i < p->n; i++) u[i] += c * x[i];
    }
}

/* u = exp(-t B^-1 L) B^-1 rhs */
static void dense_pair_heat(const dense_pair *p, double t, const double *rhs, double *u) {
    double *g = DENSE_NEW(double, p->n);
    int32_t k;
    for (k = 0; k < p->n; k++) g[k] = exp(-t * p->lambda[k]);
    dense_pair_filter(p, g, rhs, u);
    free(g);
}

static double dense_pair_norm(const dense_pair *p, const double *x) {
    double *y = DENSE_NEW(double, p->n), s;
    dense_apply(p->B, x, y, p->n);
    s = dense_dot(x, y, p->n);
    free(y);
    return s > 0 ? sqrt(s) : 0;
}

/* ---- complex systems ---- */

typedef struct dense_c64 { double re, im; } dense_c64;

static dense_c64 dense_c(double re, double im) {
    dense_c64 z;
    z.re = re;
    z.im = im;
    return z;
}

/* a - b c */
static dense_c64 dense_cfma(dense_c64 a, dense_c64 b, dense_c64 c) {
    return dense_c(a.re - (b.re * c.re - b.im * c.im), a.im - (b.re * c.im + b.im * c.re));
}

static dense_c64 dense_cquotient(dense_c64 a, dense_c64 b) {
    const double m = hypot(b.re, b.im), re = b.re / m, im = b.im / m;
    return dense_c((a.re * re + a.im * im) / m, (a.im * re - a.re * im) / m);
}

/* Solves A x = b in place of b, by LU with partial pivoting; a [n n] by rows is destroyed. 0 if A is singular. */
static int dense_complex_solve(dense_c64 *a, dense_c64 *b, int32_t n) {
    int32_t i, j, k;
    for (k = 0; k < n; k++) {
        dense_c64 *pivot = a + (size_t)k * (size_t)n, *row, keep;
        int32_t best = k;
        for (i = k + 1; i < n; i++)
            if (hypot(a[(size_t)i * (size_t)n + (size_t)k].re, a[(size_t)i * (size_t)n + (size_t)k].im) >
                hypot(a[(size_t)best * (size_t)n + (size_t)k].re, a[(size_t)best * (size_t)n + (size_t)k].im)) best = i;
        row = a + (size_t)best * (size_t)n;
        if (hypot(row[k].re, row[k].im) == 0) return 0;
        for (j = 0; best != k && j < n; j++) {
            keep = row[j];
            row[j] = pivot[j];
            pivot[j] = keep;
        }
        keep = b[best];
        b[best] = b[k];
        b[k] = keep;
        for (i = k + 1; i < n; i++) {
            dense_c64 *target = a + (size_t)i * (size_t)n, l;
            if (target[k].re == 0 && target[k].im == 0) continue;
            l = dense_cquotient(target[k], pivot[k]);
            for (j = k + 1; j < n; j++) target[j] = dense_cfma(target[j], l, pivot[j]);
            b[i] = dense_cfma(b[i], l, b[k]);
        }
    }
    for (k = n - 1; k >= 0; k--) {
        for (j = k + 1; j < n; j++) b[k] = dense_cfma(b[k], a[(size_t)k * (size_t)n + (size_t)j], b[j]);
        b[k] = dense_cquotient(b[k], a[(size_t)k * (size_t)n + (size_t)k]);
    }
    return 1;
}

#endif
