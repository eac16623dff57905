/* signatures.c - signatures in the forms that other programs take: normalised, scale-invariant, auto-diffusion

   Build and run from the project's folder:

       cc -O2 examples/signatures.c -o signatures -lm && ./signatures

   Two wavy sheets are made in memory, the second one 3 times as large. Plain heat kernel signatures differ
   between the two at the same times. Divided by the heat trace they are alike as soon as the times suit each
   sheet; scale-invariant ones are alike at the same times, without any choice. */

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 40, N = SIDE * SIDE, FACES = 2 * (SIDE - 1) * (SIDE - 1), TIMES = 6, STEPS = 161, FREQUENCIES = 6 };

static double xyz[3 * N], plain[2][TIMES * N], normalised[2][TIMES * N], many[STEPS * N], invariant[2][FREQUENCIES * N];
static int32_t tri[3 * FACES];

static void make_sheet(double scale) {
    int32_t i, j, *t = tri;
    for (i = 0; i < SIDE; i++) {
        for (j = 0; j < SIDE; j++) {
            const double x = i / (SIDE - 1.0), y = j / (SIDE - 1.0);
            double *p = xyz + 3 * (i * SIDE + j);
            p[0] = scale * x;
            p[1] = scale * y;
            p[2] = scale * 0.15 * sin(9 * x) * cos(6 * y * y);
            if (i + 1 == SIDE || j + 1 == SIDE) continue;
            t[0] = t[3] = i * SIDE + j;
            t[1] = t[0] + SIDE;
            t[2] = t[4] = t[1] + 1;
            t[5] = t[0] + 1;
            t += 6;
        }
    }
}

static int fail(const hd_error *e) {
    fprintf(stderr, "signatures: %s: %s\n", hd_status_name(e->status), e->text);
    return 1;
}

/* Of k_t(v,v) at times that are evenly spaced in log t, N apart: scaling shifts log k along log t and adds a
 * constant. Steps remove the constant, and the modulus of a Fourier transform the shift (Bronstein, Kokkinos
 * 2010). */
static void scale_invariant(const double *k, double *out) {
    const int m = STEPS - 1;
    int j, q;
    for (q = 0; q < FREQUENCIES; q++) {
        double re = 0, im = 0;
        for (j = 0; j < m; j++) {
            const double step = log(k[(j + 1) * N] / k[j * N]), angle = 6.283185307179586 * j * q / m;
            re += step * cos(angle);
            im -= step * sin(angle);
        }
        out[q * N] = hypot(re, im);
    }
}

/* Largest difference relative to the largest value. */
static double differ(const double *a, const double *b, int count) {
    double off = 0, most = 0;
    int i;
    for (i = 0; i < count; i++) {
        off = fmax(off, fabs(a[i] - b[i]));
        most = fmax(most, fabs(a[i]));
    }
    return off / most;
}

int main(void) {
    const double t0 = 1e-6, t1 = 1e4;
    double t[TIMES], trace[TIMES], steps[STEPS], slow, diffusion[N];
    hd_spectrum_opts pair = {0};
    hd_error err;
    hd_report report;
    int which, k;
    pair.count = 2;                              /* the first is that of constants */
    for (which = 0; which < 2; which++) {
        const hd_mesh mesh = hd_triangles(xyz, N, tri, FACES);
        hd_laplacian *lap = NULL;
        hd_heat *heat = NULL;
        hd_spectrum *spectrum = NULL;
        make_sheet(which ? 3 : 1);
        if (hd_laplacian_create(&lap, &mesh, NULL, &err) < 0) return fail(&err);
        if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);

        /* times that suit the area, the heat trace, and signatures whose integral is 1 */
        if (hd_times_auto(lap, TIMES, t, &err) < 0) return fail(&err);
        if (hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, TIMES, t, normalised[which], 0, trace, NULL, &report,
                             &err) < 0) return fail(&err);
        printf("area %.4f\n", lap->area);
        for (k = 0; k < TIMES; k++) printf("  t = %8.5f: trace %9.4f\n", t[k], trace[k]);
        printf("  traces and signatures are off by %.0e at most\n", report.error_relative);
        for (k = 0; k < TIMES * N; k++) normalised[which][k] *= lap->area / trace[k / N];

        /* the same times for both sheets */
        for (k = 0; k < TIMES; k++) t[k] = 0.003 * pow(4, k);
        if (hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, TIMES, t, plain[which], 0, NULL, NULL, NULL, &err) < 0)
            return fail(&err);
        for (k = 0; k < STEPS; k++) steps[k] = t0 * pow(t1 / t0, k / (STEPS - 1.0));
        if (hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, STEPS, steps, many, 0, NULL, NULL, &report, &err) < 0)
            return fail(&err);
        for (k = 0; k < N; k++) scale_invariant(many + k, invariant[which] + k);
        printf("  scale-invariant signatures come from values off by %.0e at most\n", report.error_relative);

        /* the auto-diffusion function: the signature at 1 over the first eigenvalue */
        if (hd_spectrum_create(&spectrum, lap, &pair, &err) < 0) return fail(&err);
        slow = 1 / spectrum->value[1];
        hd_spectrum_free(spectrum);
        if (hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &slow, diffusion, 0, NULL, NULL, NULL, &err) < 0)
            return fail(&err);
        printf("  auto-diffusion at t = %.4f: %.4f at a corner, %.4f in the middle\n", slow,
               diffusion[0] * lap->area, diffusion[N / 2 + SIDE / 2] * lap->area);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    printf("differences between the sheet and its enlargement:\n");
    printf("  plain, at the same times             %.0e\n", differ(plain[0], plain[1], TIMES * N));
    printf("  normalised, times that suit the area %.0e\n", differ(normalised[0], normalised[1], TIMES * N));
    printf("  scale-invariant, at the same times   %.0e\n",
           differ(invariant[0], invariant[1], FREQUENCIES * N));
    return 0;
}
