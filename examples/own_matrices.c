/* own_matrices.c - heat on any graph, from your own L and B, and a filter of your own

   Build and run from the project's folder:

       cc -O2 examples/own_matrices.c -o own_matrices -lm && ./own_matrices

   The graph is a ring of n points with unit weights and unit masses. Its heat kernel is known:
   K_t(j,0) = 1/n sum_k exp(-t (2 - 2 cos 2 pi k/n)) cos 2 pi j k/n.
   Then the example computes one step of backward Euler, (B + t L)^-1 B f, which is a rational function with
   one real pole. Any other filter of the spectrum that has poles and weights works the same way. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { N = 200 };

static double exact(double t, int j, int euler) {
    double sum = 0;
    int k;
    for (k = 0; k < N; k++) {
        const double a = 6.283185307179586 * k / N, lambda = 2 - 2 * cos(a);
        sum += (euler ? 1 / (1 + t * lambda) : exp(-t * lambda)) * cos(a * j);
    }
    return sum / N;
}

static double compare(const double *u, double t, int euler) {
    double worst = 0;
    int j;
    for (j = 0; j < N; j++) worst = fmax(worst, fabs(u[j] - exact(t, j, euler)));
    return worst;
}

static int fail(const hd_error *e) {
    fprintf(stderr, "own_matrices: %s: %s (row %lld, column %lld)\n", hd_status_name(e->status), e->text,
            (long long)e->row, (long long)e->column);
    return 1;
}

int main(void) {
    int32_t row[4 * N], col[4 * N], i;
    double val[4 * N], u[N];
    hd_csr L, B;
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_heat_opts opts;
    hd_rational euler;
    hd_report report;
    hd_error err;
    const double t = 50;

    for (i = 0; i < N; i++) {                       /* the edge (i, j): +1 on both diagonals, -1 off */
        const int32_t j = (i + 1) % N;
        row[4 * i] = i;     col[4 * i] = i;     val[4 * i] = 1;
        row[4 * i + 1] = j; col[4 * i + 1] = j; val[4 * i + 1] = 1;
        row[4 * i + 2] = i; col[4 * i + 2] = j; val[4 * i + 2] = -1;
        row[4 * i + 3] = j; col[4 * i + 3] = i; val[4 * i + 3] = -1;
    }
    if (hd_csr_from_triplets(&L, N, N, 4 * N, row, col, val, NULL, &err) < 0) return fail(&err);
    for (i = 0; i < N; i++) {
        row[i] = col[i] = i;
        val[i] = 1;
    }
    if (hd_csr_from_triplets(&B, N, N, N, row, col, val, NULL, &err) < 0) return fail(&err);
    if (hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &err) < 0) return fail(&err);
    hd_csr_free(&L, NULL);                          /* the pair is copied */
    hd_csr_free(&B, NULL);

    if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);
    if (hd_heat_column(heat, HD_KERNEL_OPERATOR, t, 0, u, &report, NULL) < 0) return fail(&report.error);
    printf("heat kernel of a ring of %d points at t = %g: error %.1e, largest value %.3e, error bound %.1e\n",
           N, t, compare(u, t, 0), u[0], report.error_bound * u[0]);
    hd_heat_free(heat);
    heat = NULL;

    /* 1/(1 - x) = a/(x - theta) with theta = 1 and a = -1, for x = -t lambda. */
    memset(&euler, 0, sizeof euler);
    euler.degree = euler.n_poles = 1;
    euler.theta[0].re = 1;
    euler.a[0].re = -1;
    memset(&opts, 0, sizeof opts);
    opts.rational = &euler;
    if (hd_heat_create(&heat, lap, &opts, &err) < 0) return fail(&err);
    if (hd_heat_column(heat, HD_KERNEL_OPERATOR, t, 0, u, &report, NULL) < 0) return fail(&report.error);
    printf("a step of backward Euler: error %.1e, largest value %.3e, in %lld iterations\n", compare(u, t, 1),
           u[0], (long long)report.iterations);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
