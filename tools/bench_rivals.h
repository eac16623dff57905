/* bench_rivals.h - what a user would otherwise take for the jobs of heatdiff.h, for the benchmark to hold it against.

   Rivals: shift-invert Lanczos for exp on one supernodal factor of CHOLMOD, the poles of a rational approximation by UMFPACK and by Eigen's
   SparseLU, Eigen's SimplicialLDLT; for diagonals the smallest eigenpairs by ARPACK; CGAL's heat method for geodesic distances. Each at its best as far as
   we could find it: the notes in bench_rivals.cpp say what was tried.

   Build bench_rivals.cpp as C++17 with optimisation for this machine, which Eigen needs to be fast:
       c++ -std=c++17 -O3 -march=native -DNDEBUG -fopenmp -I/usr/include/eigen3 -c tools/bench_rivals.cpp
   and link with  -lumfpack -lcholmod -lopenblas -fopenmp; with -DHEATDIFF_BENCH_ARPACK here and -larpack there the eigenpairs come along, with
   -DHEATDIFF_BENCH_CGAL CGAL, whose headers are all that it needs. Another BLAS works too; then see to its number of threads yourself.

   Everything is timed from the two matrices to the answer: nothing is left out but the freeing of memory. */

#ifndef BENCH_RIVALS_H
#define BENCH_RIVALS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Symmetric L and B on one pattern, rows sorted, both triangles, every diagonal entry present. A diagonal B has zeros off the diagonal. */
typedef struct rival_pair {
    int32_t n;
    const int64_t *ptr;         /* [n + 1] */
    const int32_t *col;
    const double *L, *B;
} rival_pair;

/* c(x) = a0 + sum_real a/(x - theta) + 2 Re sum_pairs a/(x - theta), listed as in hd_rational: real, imaginary, real, ... */
typedef struct rival_poles {
    int32_t n;
    double a0;
    const double *theta, *a;    /* [2 n] */
} rival_poles;

typedef enum rival_ordering { RIVAL_ORDERING_BEST = 0, RIVAL_AMD, RIVAL_METIS } rival_ordering;

/* Times [first, last) that share a factor of B + g L and a basis. */
typedef struct rival_window { int32_t first, last, steps; double g; } rival_window;
enum { RIVAL_MAX_WINDOWS = 3 };

/* What to do, and how. Zeros are the defaults. */
typedef struct rival_job {
    const rival_pair *pair;
    int32_t n_times;
    const double *times;        /* [n_times] ascending; one for every function but rival_silan_times */
    int32_t n_sources;
    const int32_t *sources;     /* [n_sources] rows; one for rival_silan and rival_silan_times */
    const double *reference;    /* [n x n_reference] exact columns of the first sources (or of all the times), or NULL */
    int32_t n_reference;
    double target;              /* error asked for, relative to each column's largest entry; default 1e-7 */
    double gamma;               /* Lanczos shift: factor of B + gamma t L; default 0.1 */
    int32_t steps;              /* Lanczos steps; 0: the fewest that reach target at the reference, found in an untimed run */
    const rival_window *window; /* for rival_silan_times: windows that an earlier call found */
    int32_t n_windows;          /* 0: found in untimed runs */
    int32_t one_by_one;         /* rival_umfpack: 1: columns one after another, each on all threads; 0: shared among the threads */
    int32_t width;              /* columns in a block, at most; default 32, above 400000 rows 8 */
    rival_ordering ordering;    /* default: the better one in an untimed trial */
    int32_t threads;            /* default 1 */
    int32_t warm_runs, runs;    /* untimed, and timed of which the quickest counts; default 0 and 1 */
    double seconds;             /* no column is begun after so many seconds of solving, the rest is extrapolated; 0: no limit */
    int32_t n_keep;             /* answers wanted of the columns (or times); default all */
    int32_t symmetric;          /* for rival_reference: 1: columns of k_t = K_t inv(B) */
    int32_t n_eigen;            /* for rival_eigenpairs: how many; default 300 */
} rival_job;

/* Seconds and what they bought. All of one run, the quickest. 0: does not apply or not known. */
typedef struct rival_result {
    double analyse;             /* shifted matrices, ordering, symbolic analysis */
    double factor;
    double first;               /* the first column (or all times of it) */
    double columns;             /* all columns, the first among them */
    double further;             /* one_by_one: the quickest column after the first */
    double total;               /* analyse + factor + first: one column from nothing */
    double total_columns;       /* analyse + factor + columns: all columns from nothing */
    int32_t columns_run;        /* fewer than asked for: columns is extrapolated from these */
    int32_t steps;              /* Lanczos steps; of all windows together */
    int32_t windows;            /* factors by rival_silan_times, and what they were for */
    rival_window window[RIVAL_MAX_WINDOWS];
    int32_t width;              /* columns in a block */
    rival_ordering ordering;
    double nnz;                 /* entries of L; UMFPACK and SparseLU: of L + U, one pole */
    double flops;               /* of one factor */
    double bytes;               /* most held at a time: factors, matrices, vectors; without the answers */
    double error;               /* largest error against the reference, relative to each column's largest entry; -1 without one */
    char note[200];
} rival_result;

/* Each returns 1, or 0 with the reason in result->note. U [n x n_keep] receives the answers, columns one after another; NULL: not wanted. */

/* K_t e_source by shift-invert Lanczos on one CHOLMOD factor. */
int rival_silan(const rival_job *job, double *U, rival_result *result);

/* Many columns of one K_t: the same in lock-step over blocks of columns, the blocks shared among the threads. first is 0, total = total_columns. */
int rival_silan_block(const rival_job *job, double *U, rival_result *result);

/* K_t e_source for many t. Times are split into 1, 2 or 3 windows with a factor and a basis each: shifts, windows and steps that are quickest at
 * the target error, found in untimed runs unless they are given. Needs a reference for every time. */
int rival_silan_times(const rival_job *job, double *U, rival_result *result);

/* Columns of c(-t B^-1 L) by UMFPACK: one complex LU per pole, without iterative refinement. */
int rival_umfpack(const rival_job *job, const rival_poles *poles, double *U, rival_result *result);

/* The same by Eigen's SparseLU with COLAMD. */
int rival_eigen_lu(const rival_job *job, const rival_poles *poles, double *U, rival_result *result);

/* Eigen's SimplicialLDLT of B + gamma t L: analyse, factor, and one solve as first. No heat: U receives the solution for B e_source. */
int rival_eigen_ldlt(const rival_job *job, double *U, rival_result *result);

/* k_t(i,i) at every row i and all times from the smallest eigenpairs: ARPACK's Lanczos with implicit restarts on one CHOLMOD factor, then sums of squares.
 * No sources. U [n x n_times]; without times U [n x n_eigen] receives the vectors. first: the eigenpairs and one time, further: one more time, steps: solves, width: eigenpairs. */
int rival_eigenpairs(const rival_job *job, double *U, rival_result *result);

/* Columns to measure others against: shift-invert Lanczos with full reorthogonalisation until nothing changes any more. For one source and all times
 * (n_sources == 1), or for one time and all sources. U [n x (times or sources)]. result->error: the last change. */
int rival_reference(const rival_job *job, double *U, rival_result *result);

typedef struct rival_mesh { int32_t n, n_tri; const double *xyz; const int32_t *tri; } rival_mesh;

/* Geodesic distances by CGAL's Heat_method_3, Direct (no intrinsic Delaunay triangulation), from each source for itself: t = h^2, lumped barycentric masses. On one
 * thread. shift: what is added to the diagonal of L for every corner of a face; 0: what CGAL adds, 1e-8. D [n x n_sources] or NULL. result: total is that of
 * the plan and the first source, analyse that of the plan (CGAL solves for some source in it), first and further as above. Making CGAL's mesh is not timed.
 * 0 with a note when built without CGAL, or when the mesh is none for it (not manifold). */
int rival_geodesic(const rival_mesh *mesh, double shift, int32_t n_sources, const int32_t *sources, double *D, rival_result *result);

/* (L, B) of a triangle mesh as two lists of triplets, room reserved, nine of L a triangle and nine (voronoi: three, mixed areas) of B, which Eigen's
 * setFromTriplets makes matrices of. On one thread. total: lists and matrices, analyse: the lists alone. check: NULL, or the pair to compare with: error is the
 * largest difference of L and of B, relative to the largest entry; -1 if the patterns differ in size. Bad faces are for the caller to keep away. */
int rival_assembly(const rival_mesh *mesh, int voronoi, const rival_pair *check, rival_result *result);

typedef struct rival_machine_result {
    double peak_1, peak_n;      /* fused multiply-add, 1e9 flops a second, on 1 and on n threads; 0: no AVX2 or not an x86 */
    double read_1, read_n;      /* reading memory, 1e9 bytes a second */
    const char *simd;           /* "AVX-512", "AVX2", "" */
    const char *blas;           /* kernels OpenBLAS has picked, "" when not OpenBLAS */
} rival_machine_result;

void rival_machine(int32_t threads, rival_machine_result *result);

#ifdef __cplusplus
}
#endif

#endif
