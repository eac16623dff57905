/* filters.c - any filter of the spectrum: wave kernel signatures of every vertex, without eigenvectors

   The wave kernel signature at an energy e is the diagonal of exp(-(e - log L)^2 / (2 sigma^2)), divided by
   its integral (Aubry, Schlickewei, Cremers 2011). hd_rational_fit makes poles for one such filter, and from
   there every query works as it does for heat. Here it makes poles that all energies share,
   so that one factorisation serves them all, and hd_heat_diagonal gives the diagonals and their
   integrals. The same sums over the first 100 eigenpairs show what they miss at high energies.

       cc -O2 examples/filters.c -o filters -lm && ./filters

   It prints the number of poles and the bound of all diagonals, then a row for each energy: the error of the
   poles, the signature where the torus is thin and where it is thick, and the error of the signature from 100
   eigenpairs. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { RINGS = 120, SIDES = 60, N = RINGS * SIDES, PAIRS = 100, ENERGIES = 6 };

/* A torus with three bumps. */
static void make_torus(double *xyz, int32_t *tri) {
    int32_t i, j, k = 0;
    for (i = 0; i < RINGS; i++) {
        for (j = 0; j < SIDES; j++) {
            const double u = 6.283185307179586 * i / RINGS, v = 6.283185307179586 * j / SIDES;
            const double thick = 0.6 + 0.2 * sin(3 * u), r = 2 + thick * cos(v);
            const int32_t a = i * SIDES + j, b = (i + 1) % RINGS * SIDES + j;
            const int32_t c = (i + 1) % RINGS * SIDES + (j + 1) % SIDES, d = i * SIDES + (j + 1) % SIDES;
            const int32_t corner[6] = {a, b, c, a, c, d};
            int q;
            xyz[3 * a] = r * cos(u);
            xyz[3 * a + 1] = r * sin(u);
            xyz[3 * a + 2] = thick * sin(v);
            for (q = 0; q < 6; q++) tri[k++] = corner[q];
        }
    }
}

/* The signature from eigenpairs. */
static void from_pairs(const hd_spectrum *s, const hd_filter *f, double *wks) {
    double sum = 0;
    int32_t v, k;
    for (v = 0; v < N; v++) wks[v] = 0;
    for (k = 0; k < s->count; k++) {
        const double g = k < s->n_constant ? 0 : hd_filter_eval(f, s->value[k]), *x = s->vector + (size_t)k * N;
        for (v = 0; v < N; v++) wks[v] += g * x[v] * x[v];
        sum += g;
    }
    for (v = 0; v < N; v++) wks[v] /= sum;
}

int main(void) {
    double *xyz = (double *)malloc(3 * N * sizeof *xyz), *u = (double *)malloc((ENERGIES + 1) * N * sizeof *u);
    int32_t *tri = (int32_t *)malloc(6 * N * sizeof *tri);
    double *pairs = u + ENERGIES * N, integral[ENERGIES];
    const hd_mesh mesh = hd_triangles(xyz, N, tri, 2 * N);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_spectrum *spectrum = NULL;
    hd_spectrum_opts opts = {0};
    hd_filter f[ENERGIES] = {{0}};
    hd_rational set[ENERGIES];
    hd_report report;
    hd_error err = {0};
    int status = 1, q;
    int32_t v;
    if (!xyz || !u || !tri) goto end;
    make_torus(xyz, tri);
    opts.count = PAIRS;
    if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) goto end;
    if (hd_heat_create(&heat, lap, NULL, &err) < 0) goto end;
    if (hd_spectrum_create(&spectrum, lap, &opts, &err) < 0) goto end;
    for (q = 0; q < ENERGIES; q++) {
        f[q].kind = HD_FILTER_WAVE;
        f[q].a = log(spectrum->value[4]) + 1.1 * q;
        f[q].b = 0.3;
        f[q].tol = 1e-8;
    }
    if (hd_rational_fit(set, ENERGIES, f, lap->lambda_max, NULL, &err) < 0) goto end;
    if (hd_heat_set_rational(heat, ENERGIES, set, &err) < 0) goto end;
    if (hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 0, NULL, u, 0, integral, NULL, &report, &err) < 0) goto end;
    printf("%d vertices, %d poles for all energies, bound %.0e\nenergy  off by   thin     thick    "
           "%d pairs are off by\n", N, (int)set[0].degree, report.error_bound, PAIRS);
    for (q = 0; q < ENERGIES; q++) {
        double *wks = u + q * N, most = 0, off = 0;
        for (v = 0; v < N; v++) wks[v] /= integral[q];
        from_pairs(spectrum, f + q, pairs);
        for (v = 0; v < N; v++) {
            most = fmax(most, wks[v]);
            off = fmax(off, fabs(pairs[v] - wks[v]));
        }
        printf("%6.2f  %.1e  %.5f  %.5f  %.1e\n", f[q].a, set[q].max_error, wks[3 * RINGS / 12 * SIDES],
               wks[RINGS / 12 * SIDES], off / most);
    }
    status = 0;
end:
    if (status) fprintf(stderr, "%s\n", err.status ? err.text : "out of memory");
    hd_spectrum_free(spectrum);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    free(xyz);
    free(u);
    free(tri);
    return status;
}
