/* heatdiff.h - heat diffusion kernels on surfaces, without a spectrum

   ==== [A] opening ====

   A surface is a pair of sparse matrices (L, B): L the stiffness matrix, symmetric positive semi-definite, B the mass
   matrix, symmetric positive definite. Heat f diffuses as K_t f, with the heat kernel matrix K_t = exp(-t B^-1 L).
   This file builds (L, B) from a mesh and applies K_t through a rational approximation of the exponential,

       K_t f = a0 f - sum_i a_i (t L + theta_i B)^-1 B f,

   a handful of sparse complex-symmetric systems. No eigenvectors are computed, none are left out, and every answer
   comes with a bound of its error. The method is that of G. Patane and M. Spagnuolo, "Heat diffusion kernel and
   distance on surface meshes and point sets", Computers & Graphics 37, 2013.

   In one C or C++ file:                             Everywhere else:

       #define HEATDIFF_IMPLEMENTATION                   #include "heatdiff.h"
       #include "heatdiff.h"

   and link with -lm. Two working calls make a heat kernel of a triangle mesh:

       hd_laplacian *lap = NULL;  hd_heat *heat = NULL;  hd_error err;
       if (hd_laplacian_triangles(&lap, xyz, n, tri, n_tri, NULL, &err) < 0) return fail(&err);
       if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);
       hd_heat_column(heat, 100 * lap->h * lap->h, source, u, NULL);          u[n] = K_t e_source
       hd_heat_free(heat);  hd_laplacian_free(lap);

   Conventions
     sign     L is positive semi-definite: minus the usual cotangent matrix of libigl. Its rows sum to zero.
     units    L has no unit, B is an area, t an area (length squared), k_t = K_t B^-1 is 1/area. With B = I (kind `cot`)
              t is a pure number. lap->h is the mean edge length: t = c h^2 is how times are usually chosen.
              t below h^2 sees the mesh, not the surface.
     kernels  K_t is not symmetric: column i diffuses the indicator of vertex i, of mass b_i. k_t = K_t B^-1 is the
              symmetric pointwise heat kernel k_t(x,y), column i diffuses a unit of heat put at vertex i.
     border   natural (Neumann): no heat leaves. Components that do not touch exchange none, exactly.
     vertices that carry no mass (in no face, or only in faces of zero area) take no part: K_t leaves them alone.
     norm     |f|_B = sqrt(f' B f). Errors are relative in this norm, or to the largest value, as each report field says.

   Contents
     declarations    [B] base  [C] options and reports  [D] functions
     implementation  [00] platform  [01] scalar  [02] error  [03] memory  [04] context  [05] arrays  [06] dense
                     [07] sparse  [09] geometry  [10] operators  [11] symbolic  [14] precond  [15] krylov
                     [16] rational  [17] shifted  [18] heat  [21] api  [22] closing
     Rooms are numbered from the bottom up; each calls only those above it in the file.

   Options (macros)
     HEATDIFF_IMPLEMENTATION   in one file only: compiles the implementation
     HEATDIFF_STATIC           wherever the file is included: all functions are static (implies one user, one file)
     HEATDIFF_API              beside the declarations and the implementation alike: your own linkage attribute
     HEATDIFF_ASSERT(x)        beside the implementation: your own assert; without it, assert() unless NDEBUG
     HEATDIFF_MALLOC(size), HEATDIFF_FREE(p)
                               beside the implementation: both or none; what contexts without an allocator use
     HEATDIFF_NO_OPENMP        beside the implementation: no OpenMP even when compiled with it
     No macro changes a public type or prototype.

   Limits
     Vertices and faces are counted in 32 bits, non-zeros and offsets in 64. No global or thread-local state: contexts and
     objects that share none can be used from different threads. The library prints nothing, opens no file, never exits.

   Licence: MIT or public domain, at your choice; see the end of the file. */

#ifndef HEATDIFF_H
#define HEATDIFF_H

/* ==== [B] base ==== */

#include <stddef.h>
#include <stdint.h>

#define HD_VERSION_MAJOR 0
#define HD_VERSION_MINOR 1
#define HD_VERSION_PATCH 0
/* Comparable: HD_VERSION >= HD_MAKE_VERSION(0, 2, 0) */
#define HD_MAKE_VERSION(major, minor, patch) ((major) * 1000000 + (minor) * 1000 + (patch))
#define HD_VERSION HD_MAKE_VERSION(HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH)

#ifndef HEATDIFF_API
#ifdef HEATDIFF_STATIC
#define HEATDIFF_API static
#else
#define HEATDIFF_API extern
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A complex number; same layout as C99 double complex and std::complex<double>. */
typedef struct hd_c64 { double re, im; } hd_c64;

/* Zero is success, negative an error, positive "usable, but read the report". One list makes codes and texts. */
#define HD_STATUS_LIST(X)                                                                                              \
    X(HD_OK, 0, "done")                                                                                                \
    X(HD_WARN_ACCURACY, 1, "done, but rounding kept the error above the tolerance asked for")                          \
    X(HD_ERR_ARGUMENT, -1, "an argument or option is out of its range")                                                \
    X(HD_ERR_MEMORY, -2, "out of memory")                                                                              \
    X(HD_ERR_MEMORY_LIMIT, -3, "the byte or allocation limit of the context is reached")                               \
    X(HD_ERR_TOO_LARGE, -4, "a size does not fit its integer type")                                                    \
    X(HD_ERR_CANCELLED, -5, "cancelled by the progress callback")                                                      \
    X(HD_ERR_NOT_CONVERGED, -6, "the iteration did not reach the tolerance")                                           \
    X(HD_ERR_INDEX, -7, "an index is out of range")                                                                    \
    X(HD_ERR_NOT_FINITE, -8, "a value is not finite")                                                                  \
    X(HD_ERR_NOT_SYMMETRIC, -9, "a matrix is not symmetric")                                                           \
    X(HD_ERR_NOT_POSITIVE, -10, "a mass matrix is not positive definite")                                              \
    X(HD_ERR_STRUCTURE, -11, "a sparse matrix is not well formed")                                                     \
    X(HD_ERR_EMPTY, -12, "nothing is left to compute on: no vertex has mass")                                          \
    X(HD_ERR_BREAKDOWN, -13, "the iteration broke down")

typedef enum hd_status {
#define HD_STATUS_ENUM(name, value, text) name = value,
    HD_STATUS_LIST(HD_STATUS_ENUM)
#undef HD_STATUS_ENUM
    HD_STATUS_FORCE_INT = 0x7fffffff
} hd_status;

/* What went wrong and where in the caller's data. Places that do not apply are -1. */
typedef struct hd_error {
    hd_status status;
    char text[160];        /* one line for people, without the numbers below */
    int64_t face, vertex;  /* ids as the caller numbers them */
    int64_t row, column;   /* of a matrix, or of a field */
    int64_t pole;          /* index in the rational set */
    double value;          /* the offending value; 0 when none */
} hd_error;

/* What a progress callback returns. Neither is 0 or 1, so that a callback of the wrong type is noticed (anything else
 * than these two is HD_ERR_ARGUMENT). */
typedef enum hd_progress { HD_PROGRESS_CONTINUE = 0x100, HD_PROGRESS_CANCEL = 0x200 } hd_progress;

/* Memory. alloc returns NULL when there is none; blocks must be aligned to 8 bytes. free receives the size the block had.
 * Nothing is ever resized, so there is no realloc to write. Called by the calling thread only. */
typedef struct hd_allocator {
    void *(*alloc)(void *user, size_t size);
    void (*free)(void *user, void *block, size_t size);
    void *user;
} hd_allocator;

/* One task of a parallel loop. worker tells the thread: 0 is the one that called the library. */
typedef void (*hd_task)(void *arg, int64_t index, int32_t worker);

/* The surroundings of a computation. All zeros are good defaults: malloc, no limits, no progress, and OpenMP's threads
 * when compiled with OpenMP (serial otherwise). The context belongs to the caller and must outlive every object made
 * with it; wherever a function takes a context, NULL means one of these defaults. */
typedef struct hd_context {
    hd_allocator allocator;     /* both functions or none */
    uint64_t byte_limit;        /* most bytes in use at one time; 0: no limit */
    uint64_t allocation_limit;  /* most calls of alloc; 0: no limit */

    /* Called now and then during long work, by the calling thread only. stage names the work, done runs from 0 to 1
     * within it. Cancelling makes the running function return HD_ERR_CANCELLED with everything freed. */
    hd_progress (*progress)(void *user, const char *stage, double done);
    void *progress_user;

    /* Runs task(arg, i, worker) for every i in [0, n_tasks), in any order, and returns when all are done. The calling
     * thread is worker 0, others have numbers of their own. NULL: OpenMP if compiled with it, else serial. Results do
     * not depend on it, nor on the number of threads. */
    void (*parallel_for)(void *user, int64_t n_tasks, hd_task task, void *arg);
    void *parallel_user;
    int32_t threads;            /* for OpenMP: 0 all, 1 serial. Not looked at when parallel_for is given */

    /* Filled by the library. */
    uint64_t bytes_in_use, bytes_peak, allocations;
} hd_context;

/* A sparse matrix by compressed rows. In every row the columns ascend and occur once. val may be NULL in a pattern.
 * Made by the library: free with hd_csr_free. Made of your own arrays: free those yourself. */
typedef struct hd_csr {
    int32_t n_rows, n_cols;
    int64_t nnz;
    int64_t *row_ptr;      /* [n_rows + 1] */
    int32_t *col;          /* [nnz] */
    double *val;           /* [nnz] */
} hd_csr;

/* ==== [C] options and reports ==== */
/* Options are structs whose zeros mean the defaults; NULL means all defaults. begin_zero and end_zero must stay zero:
 * they tell a cleared struct from a forgotten one. */

typedef enum hd_laplacian_kind {
    HD_LAPLACIAN_FEM = 0,       /* cotangent L, linear finite-element B: area/6 on the diagonal, area/12 off it, per triangle */
    HD_LAPLACIAN_VORONOI_COT,   /* cotangent L, B diagonal: mixed Voronoi areas (Meyer, Desbrun, Schroeder, Barr 2003) */
    HD_LAPLACIAN_COT,           /* cotangent L, B = I (Pinkall, Polthier 1993) */
    HD_LAPLACIAN_MATRICES       /* the caller's own two matrices */
} hd_laplacian_kind;

typedef struct hd_laplacian_opts {
    int32_t begin_zero;
    hd_laplacian_kind kind;     /* default fem; not looked at by hd_laplacian_matrices */
    hd_context *context;
    int32_t end_zero;
} hd_laplacian_opts;

/* What was found in a mesh. Nothing here is an error: what is left out is counted. */
typedef struct hd_mesh_report {
    int32_t n_faces;                 /* given */
    int32_t n_faces_used;            /* assembled */
    int32_t n_repeated_corner;       /* left out: two corners are the same vertex */
    int32_t n_zero_area;             /* left out: cross product of two edges exactly zero (or an area or cotangent that no double holds) */
    int32_t n_repeated_face;         /* left out: same three corners as an earlier face */
    int64_t n_edges;                 /* distinct edges of the faces used */
    int64_t n_boundary_edges;        /* with one face */
    int64_t n_nonmanifold_edges;     /* with three faces or more: their weights are summed, nothing special */
    int64_t n_misoriented_edges;     /* with two faces that run along it in the same direction */
    int32_t n_boundary_loops;        /* connected sets of boundary edges */
    int32_t n_inert;                 /* vertices without mass */
    int64_t n_negative_weights;      /* edges whose cotangent weight is negative: legitimate, but no maximum principle */
    double smallest_angle;           /* over the faces used, in radians */
} hd_mesh_report;

/* A discrete surface: the pair (L, B) on one pattern. Read it freely, change nothing; made and freed by the library.
 * Rows are the vertices that have mass, in the caller's order. */
typedef struct hd_laplacian {
    int32_t n;                  /* vertices of the caller */
    int32_t n_active;           /* rows: vertices with mass */
    int32_t n_components;       /* connected components of the rows */
    hd_laplacian_kind kind;
    double h;                   /* mean length of the distinct edges; 0 for matrices */
    double area;                /* of the faces used; 1'B1 for matrices */
    hd_csr L;                   /* n_active x n_active, values of L, every diagonal entry present */
    double *B;                  /* [L.nnz] values of B on the pattern of L, or NULL: B is diagonal, B = diag(mass) */
    double *mass;               /* [n_active] b = B 1, the vertices' masses */
    double *b_diag;             /* [n_active] diagonal of B; the same array as mass when B is diagonal */
    int32_t *vertex;            /* [n_active] row -> vertex */
    int32_t *row;               /* [n] vertex -> row, -1 without mass */
    int32_t *component;         /* [n_active] row -> component, numbered by their first vertex */
    double *component_mass;     /* [n_components] sum of mass */
    double b_ratio;             /* B >= b_ratio diag(B): 1 when B is diagonal, 1/2 for fem, 0 when not known */
    int32_t conserves;          /* 1: L 1 = 0, so that heat is conserved (always so for meshes) */
    hd_mesh_report mesh;        /* zeros for matrices but n_inert */
    hd_context *context;
} hd_laplacian;

typedef enum hd_pole_kind {
    HD_POLES_DEFAULT = 0,
    HD_POLES_UNIFORM,           /* best uniform (r,r) approximations, r = 1..14: smallest max |exp - c| on (-inf, 0] */
    HD_POLES_KERNEL,            /* a0 = 0, c(0) = 1 exactly, smallest max (1 + |x|) |exp - c|, r = 2..14: the error is
                                   relative to the kernel's own size, and heat is conserved to rounding */
    HD_POLES_OWN                /* the caller's */
} hd_pole_kind;

enum { HD_MAX_POLES = 32 };

/* c(x) = a0 + sum_real a/(x - theta) + 2 Re sum_pairs a/(x - theta), for x = -t lambda <= 0. One of each conjugate pair is listed,
 * that with Im theta > 0; a pole with Im theta = 0 is real and counts once. No pole may lie on (-inf, 0]. */
typedef struct hd_rational {
    hd_pole_kind kind;
    int32_t degree;             /* real poles + 2 pairs */
    int32_t n_poles;            /* listed, at most HD_MAX_POLES */
    double a0;
    hd_c64 theta[HD_MAX_POLES];
    hd_c64 a[HD_MAX_POLES];
    double max_error;           /* max |exp(x) - c(x)| on (-inf, 0]; 0 in a set of your own: not known, the reports' bounds then
                                   hold for c itself */
    double max_weighted_error;  /* max (1 + |x|) |exp(x) - c(x)|; 0: not bounded or not known */
} hd_rational;

typedef enum hd_method {
    HD_METHOD_AUTO = 0,
    HD_METHOD_ITERATIVE         /* a Krylov method per pole, or Lanczos */
} hd_method;

typedef enum hd_solver {
    HD_SOLVER_AUTO = 0,         /* Lanczos for small t where it costs less, else cocg */
    HD_SOLVER_COCG,             /* conjugate orthogonal CG (van der Vorst, Melissen 1990); CG for real poles */
    HD_SOLVER_COCR,             /* conjugate orthogonal conjugate residuals (Sogabe, Zhang 2007); CG for real poles */
    HD_SOLVER_MINRES,           /* CS-MINRES (Choi 2013): MINRES on the Saunders process. Plain MINRES needs a Hermitian matrix,
                                   which tL + theta B is not for complex theta: its Lanczos recurrence is then wrong and it
                                   converges to something else. This one needs a real positive definite preconditioner, and
                                   takes the one made for tL + |theta| B */
    HD_SOLVER_LANCZOS           /* Lanczos for the exponential itself, no poles: about 1.1 sqrt(t lambda_max) steps */
} hd_solver;

typedef enum hd_precond {
    HD_PRECOND_AUTO = 0,        /* mildl */
    HD_PRECOND_NONE,
    HD_PRECOND_JACOBI,          /* the diagonal */
    HD_PRECOND_SSOR,            /* symmetric successive over-relaxation, omega = 1 */
    HD_PRECOND_ILDL,            /* incomplete LDL' on the pattern of L, no fill */
    HD_PRECOND_MILDL            /* the same, 97 % of the dropped fill moved to the diagonal (modified; Gustafsson 1978) */
} hd_precond;

typedef struct hd_heat_opts {
    int32_t begin_zero;
    hd_method method;
    hd_solver solver;
    hd_precond precond;
    hd_pole_kind poles;         /* default: kernel for columns and entries, uniform for fields */
    int32_t degree;             /* default: chosen so that the rational error relative to the answer is below 1e-8 or so */
    const hd_rational *rational;/* a set of your own (any filter of the spectrum), copied; then poles and degree are not looked at
                                   and Lanczos is not used */
    double tol;                 /* solver's part of the error, |error|_B / |answer|_B; default 1e-9 */
    int32_t max_iterations;     /* per system; default 20000 */
    hd_context *context;        /* default: that of the Laplacian */
    int32_t end_zero;
} hd_heat_opts;

typedef enum hd_kernel {
    HD_KERNEL_OPERATOR = 0,     /* K_t = exp(-t B^-1 L) */
    HD_KERNEL_SYMMETRIC         /* k_t = K_t B^-1 */
} hd_kernel;

/* What happened, and how far off the answer can be. With several fields or columns, the worst of them. */
typedef struct hd_report {
    hd_status status;
    hd_error error;             /* filled when status < 0 */
    hd_method method;
    hd_solver solver;
    hd_precond precond;         /* HD_PRECOND_NONE for Lanczos */
    hd_pole_kind poles;         /* HD_POLES_DEFAULT for Lanczos, which has none */
    int32_t degree;             /* 0 for Lanczos */
    int32_t n_poles;
    int64_t iterations;         /* total over systems and fields (Lanczos: steps) */
    int64_t pole_iterations[HD_MAX_POLES];  /* per pole, summed over the fields */
    double residual;            /* largest |b - A x| / |b| over the systems, in the norm of diag(B)^-1; computed, not recurred. 0 for Lanczos. With
                                   HD_ERR_NOT_CONVERGED that of the system that failed (Lanczos: its bound of the relative error) */
    double error_rational;      /* bound of |exp's approximation error|_B / |answer|_B */
    double error_solver;        /* bound of the solvers' part, |.|_B / |answer|_B */
    double error_bound_b;       /* the two together */
    double error_bound;         /* bound of the largest error at a vertex, relative to the largest |value| of the answer */
    double mass_drift;          /* |1'B u - 1'B f| / 1'B|u|, 0 when the pair does not conserve heat or the filter is the caller's */
} hd_report;

/* ==== [D] functions ==== */
/* Common to all: pointers to results come first. Functions return hd_status; on an error nothing is left allocated, *out is
 * left as it was, and the numbers in output arrays are unspecified. err and report may be NULL. */

/* ---- statuses ---- */

HEATDIFF_API const char *hd_status_name(hd_status status);  /* "HD_ERR_MEMORY" */
HEATDIFF_API const char *hd_status_text(hd_status status);  /* "out of memory" */

/* ---- sparse matrices ---- */

/* A from triplets (i, j, v) in any order; those with the same place are summed in the order given. v may be NULL: a pattern.
 * Cost O(n_rows + n_cols + n_triplets). Errors HD_ERR_INDEX (row: index of the triplet), HD_ERR_NOT_FINITE. */
HEATDIFF_API hd_status hd_csr_from_triplets(hd_csr *out, int32_t n_rows, int32_t n_cols, int64_t n_triplets, const int32_t *i,
                                            const int32_t *j, const double *v, hd_context *ctx, hd_error *err);

/* Checks offsets, indices, order and finiteness; with symmetric = 1 also A = A' up to 1e-12 of the larger entry of the pair.
 * Errors HD_ERR_STRUCTURE, HD_ERR_INDEX, HD_ERR_NOT_FINITE, HD_ERR_NOT_SYMMETRIC, with row and column. Cost O(nnz). */
HEATDIFF_API hd_status hd_csr_check(const hd_csr *a, int32_t symmetric, hd_context *ctx, hd_error *err);

/* out = A'. Cost O(nnz). */
HEATDIFF_API hd_status hd_csr_transpose(hd_csr *out, const hd_csr *a, hd_context *ctx, hd_error *err);

/* out = A B (Gustavson 1978). Cost O(flops + sorting of the rows). */
HEATDIFF_API hd_status hd_csr_product(hd_csr *out, const hd_csr *a, const hd_csr *b, hd_context *ctx, hd_error *err);

/* out = P A P', a square A with rows and columns renumbered: row i of out is row perm[i] of A. Errors HD_ERR_INDEX when perm is not
 * a permutation. */
HEATDIFF_API hd_status hd_csr_permute(hd_csr *out, const hd_csr *a, const int32_t *perm, hd_context *ctx, hd_error *err);

/* y = A x. x [n_cols], y [n_rows], not overlapping. ctx is for its threads. Never fails on a checked matrix. */
HEATDIFF_API void hd_csr_apply(const hd_csr *a, const double *x, double *y, hd_context *ctx);

/* Frees what the library allocated with the same ctx and clears the struct. */
HEATDIFF_API void hd_csr_free(hd_csr *a, hd_context *ctx);

/* ---- operators ---- */

/* The Laplacian of a triangle mesh.
 * xyz    [3 n] coordinates, finite
 * tri    [3 n_tri] vertex ids in [0, n)
 * opts   kind of Laplacian, context; NULL: fem
 * Faces of zero area, with a repeated corner, or with the corners of an earlier face are left out and counted in out->mesh;
 * vertices without mass become inert. Non-manifold edges and several components are fine.
 * Errors HD_ERR_INDEX (face, value: the id), HD_ERR_NOT_FINITE (vertex), HD_ERR_EMPTY. Cost O(n + n_tri). */
HEATDIFF_API hd_status hd_laplacian_triangles(hd_laplacian **out, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri,
                                              const hd_laplacian_opts *opts, hd_error *err);

/* The pair of the caller's own matrices on any graph, copied.
 * L      n x n, symmetric positive semi-definite. Rows need not sum to zero (then heat is not conserved)
 * B      n x n, symmetric positive definite; any pattern. Rows of B without any non-zero are inert vertices. Definiteness is
 *        checked on the diagonal, and on B itself where a solver meets it (HD_ERR_NOT_POSITIVE)
 * h      unit length of the caller's mesh for lap->h; 0 if none
 * Errors as hd_csr_check, HD_ERR_NOT_POSITIVE (row, value), HD_ERR_EMPTY. */
HEATDIFF_API hd_status hd_laplacian_matrices(hd_laplacian **out, const hd_csr *L, const hd_csr *B, double h, const hd_laplacian_opts *opts,
                                             hd_error *err);

/* y = (alpha L + beta B) x for a field on the vertices. x, y [n], not overlapping. y is 0 at vertices without mass. */
HEATDIFF_API hd_status hd_laplacian_apply(const hd_laplacian *lap, double alpha, double beta, const double *x, double *y, hd_error *err);

HEATDIFF_API void hd_laplacian_free(hd_laplacian *lap);  /* NULL is fine */

/* ---- rational approximations ---- */

/* A built-in set: uniform r = 1..14, kernel r = 2..14. Errors HD_ERR_ARGUMENT. Constants by tools/poles.py. */
HEATDIFF_API hd_status hd_rational_get(hd_rational *out, hd_pole_kind kind, int32_t degree, hd_error *err);

/* c(x) for real x <= 0. */
HEATDIFF_API double hd_rational_eval(const hd_rational *set, double x);

/* ---- shifted systems ---- */

typedef struct hd_solve_opts {
    int32_t begin_zero;
    hd_solver solver;           /* cocg, cocr or minres; default cocg */
    hd_precond precond;
    double tol;                 /* |b - A x| / |b| in the norm of diag(B)^-1; default 1e-10 */
    int32_t max_iterations;     /* default 20000 */
    hd_context *context;        /* default: that of the Laplacian */
    int32_t end_zero;
} hd_solve_opts;

typedef struct hd_solve_report {
    int64_t iterations;
    double residual;            /* reached, computed from x, in the norm of diag(B)^-1 */
    double error_b;             /* bound of |x - exact|_B / |x|_B; infinite when nothing is known about B */
} hd_solve_report;

/* (t L + theta B) x = rhs, complex symmetric. rhs, x [n] on the vertices, may be the same array; 0 at vertices without mass.
 * theta not on (-inf, 0], t >= 0. The report is filled too when the status is HD_ERR_NOT_CONVERGED. Every call makes its own ordering and
 * preconditioner.
 * Errors HD_ERR_ARGUMENT, HD_ERR_NOT_CONVERGED, HD_ERR_BREAKDOWN, HD_ERR_MEMORY, HD_ERR_CANCELLED. HD_WARN_ACCURACY. */
HEATDIFF_API hd_status hd_shifted_solve(const hd_laplacian *lap, double t, hd_c64 theta, const hd_c64 *rhs, hd_c64 *x,
                                        const hd_solve_opts *opts, hd_solve_report *report, hd_error *err);

/* ---- heat ---- */

typedef struct hd_heat hd_heat;

/* A plan for heat on lap, which must outlive it. Decides and allocates what does not depend on t: it holds the pair a second time, renumbered for
 * the iterations, and keeps its work arrays and the last preconditioners from call to call. One thread at a time. */
HEATDIFF_API hd_status hd_heat_create(hd_heat **out, const hd_laplacian *lap, const hd_heat_opts *opts, hd_error *err);
HEATDIFF_API void hd_heat_free(hd_heat *heat);  /* NULL is fine */

/* U = K_t F.
 * t      >= 0, unit length^2 (t = 0 copies F)
 * F, U   n x k doubles, column-major, columns ldf and ldu apart (0: n); U may be F
 *        With a degree by default, all fields of a call share the largest that one of them needs
 * Cost   per field one iterative solve a pole, each started from those before it; up to four fields in parallel
 * Errors HD_ERR_ARGUMENT, HD_ERR_NOT_FINITE (row, column), HD_ERR_NOT_CONVERGED, HD_ERR_BREAKDOWN, HD_ERR_NOT_POSITIVE, HD_ERR_MEMORY,
 *        HD_ERR_CANCELLED; details in report->error. HD_WARN_ACCURACY.
 * Source Patane, Spagnuolo 2013, eqs. (8), (9); signs as in the opening. */
HEATDIFF_API hd_status hd_heat_apply(hd_heat *heat, double t, int32_t k, const double *F, size_t ldf, double *U, size_t ldu,
                                     hd_report *report);

/* u = K_t e_source: the heat that reaches each vertex from a unit at source (its own area's worth). u [n]. */
HEATDIFF_API hd_status hd_heat_column(hd_heat *heat, double t, int32_t source, double *u, hd_report *report);

/* Several columns of K_t or of k_t = K_t B^-1. U n x k as above, column q for sources[q]. The column of a vertex without mass is
 * its unit vector for the operator, zero for the symmetric kernel. */
HEATDIFF_API hd_status hd_heat_columns(hd_heat *heat, double t, hd_kernel kernel, int32_t k, const int32_t *sources, double *U, size_t ldu,
                                       hd_report *report);

/* Single entries: values[q] = (i[q], j[q]) of K_t or k_t. One column per distinct j is solved, n doubles at a time. */
HEATDIFF_API hd_status hd_heat_entries(hd_heat *heat, double t, hd_kernel kernel, int64_t n_pairs, const int32_t *i, const int32_t *j,
                                       double *values, hd_report *report);

#ifdef __cplusplus
}
#endif

#endif /* HEATDIFF_H */

/* ===================================================================================================================== */
#ifdef HEATDIFF_IMPLEMENTATION
#ifndef HEATDIFF_IMPLEMENTED
#define HEATDIFF_IMPLEMENTED

/* ==== [00] platform ====
 * Compilers and the C library. Everything that depends on either is here. */

#include <float.h>
#include <math.h>
#include <string.h>
#if defined(_OPENMP) && !defined(HEATDIFF_NO_OPENMP)
#include <omp.h>
#define HDI_OPENMP 1
#else
#define HDI_OPENMP 0
#endif

#if defined(HEATDIFF_MALLOC) && defined(HEATDIFF_FREE)
#elif !defined(HEATDIFF_MALLOC) && !defined(HEATDIFF_FREE)
#include <stdlib.h>
#define HEATDIFF_MALLOC(size) malloc(size)
#define HEATDIFF_FREE(p) free(p)
#else
#error "heatdiff.h: define both of HEATDIFF_MALLOC and HEATDIFF_FREE, or none"
#endif

#ifndef HEATDIFF_ASSERT
#include <assert.h>
#define HEATDIFF_ASSERT(x) assert(x)
#endif

#if defined(__GNUC__) || defined(__clang__)
#define HDI_RESTRICT __restrict__
#define HDI_NODISCARD __attribute__((warn_unused_result))
#define HDI_LOAD(p) __atomic_load_n(p, __ATOMIC_RELAXED)
#define HDI_STORE(p, v) __atomic_store_n(p, v, __ATOMIC_RELAXED)
#define HDI_PREFETCH(p) __builtin_prefetch(p)
#else
#define HDI_RESTRICT
#define HDI_NODISCARD
#define HDI_LOAD(p) (*(p))
#define HDI_STORE(p, v) (*(p) = (v))
#define HDI_PREFETCH(p) ((void)0)
#endif

#ifdef __cplusplus
#define HDI_CAST(type, x) static_cast<type>(x)
extern "C" {
#else
#define HDI_CAST(type, x) ((type)(x))
#endif

/* ==== [01] scalar ====
 * Numbers: complex arithmetic without the language's care for NaN, checked sizes. May call [00]. */

static hd_c64 hdi_c(double re, double im) { hd_c64 z; z.re = re; z.im = im; return z; }
static hd_c64 hdi_cadd(hd_c64 a, hd_c64 b) { return hdi_c(a.re + b.re, a.im + b.im); }
static hd_c64 hdi_csub(hd_c64 a, hd_c64 b) { return hdi_c(a.re - b.re, a.im - b.im); }
static hd_c64 hdi_cmul(hd_c64 a, hd_c64 b) { return hdi_c(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re); }
static hd_c64 hdi_cscale(double s, hd_c64 a) { return hdi_c(s * a.re, s * a.im); }
static hd_c64 hdi_cconj(hd_c64 a) { return hdi_c(a.re, -a.im); }
static double hdi_cabs2(hd_c64 a) { return a.re * a.re + a.im * a.im; }
static double hdi_cabs(hd_c64 a) { return hypot(a.re, a.im); }

/* a / b, scaled by the larger part of b so that no square overflows (Smith 1962). */
static hd_c64 hdi_cdiv(hd_c64 a, hd_c64 b) {
    double q, d;
    if (fabs(b.re) >= fabs(b.im)) {
        q = b.im / b.re;
        d = b.re + b.im * q;
        return hdi_c((a.re + a.im * q) / d, (a.im - a.re * q) / d);
    }
    q = b.re / b.im;
    d = b.re * q + b.im;
    return hdi_c((a.re * q + a.im) / d, (a.im * q - a.re) / d);
}

static int hdi_finite(double x) { return fabs(x) <= DBL_MAX; }
static int hdi_cfinite(hd_c64 a) { return hdi_finite(a.re) && hdi_finite(a.im); }
/* sqrt(a^2 + b^2): hypot's care only where it is needed. */
static double hdi_pythag(double a, double b) {
    const double s = a * a + b * b;
    return s > 1e-280 && s < 1e280 ? sqrt(s) : hypot(a, b);
}

static double hdi_max(double a, double b) { return a > b ? a : b; }
static double hdi_min(double a, double b) { return a < b ? a : b; }

/* *out = a * b + c; 0 if that does not fit. */
static int hdi_size(size_t a, size_t b, size_t c, size_t *out) {
    if (b && a > (SIZE_MAX - c) / b) return 0;
    *out = a * b + c;
    return 1;
}

/* ==== [02] error ====
 * Status texts and filled errors. Internal functions take an error that is never NULL. May call [01]. */

static void hdi_error_clear(hd_error *e) {
    memset(e, 0, sizeof *e);
    e->face = e->vertex = e->row = e->column = e->pole = -1;
}

/* The one place where an error is born: a good line for a breakpoint. */
static hd_status hdi_fail(hd_error *e, hd_status status, const char *text) {
    size_t len = strlen(text);
    hdi_error_clear(e);
    if (len > sizeof e->text - 1) len = sizeof e->text - 1;
    memcpy(e->text, text, len);
    e->status = status;
    return status;
}

static hd_status hdi_fail_row(hd_error *e, hd_status status, const char *text, int64_t row, int64_t column, double value) {
    hdi_fail(e, status, text);
    e->row = row;
    e->column = column;
    e->value = value;
    return status;
}

static hd_status hdi_fail_face(hd_error *e, hd_status status, const char *text, int64_t face, int64_t vertex, double value) {
    hdi_fail(e, status, text);
    e->face = face;
    e->vertex = vertex;
    e->value = value;
    return status;
}

/* ==== [03] memory ====
 * Counted allocation, aligned to 64 bytes with the block's size kept in front; and scopes, which free the work arrays of a
 * function at its one exit. May call [02]. */

enum { HDI_ALIGN = 64, HDI_HEADER = 2 * sizeof(uint64_t) };

static hd_status hdi_alloc_check(hd_context *ctx, size_t total, hd_error *e) {
    const int bytes = ctx->byte_limit && (total > ctx->byte_limit || ctx->bytes_in_use > ctx->byte_limit - total);
    if (bytes || (ctx->allocation_limit && ctx->allocations >= ctx->allocation_limit)) {
        hdi_fail(e, HD_ERR_MEMORY_LIMIT, bytes ? "the byte limit of the context is reached" : "the allocation limit of the context is reached");
        e->value = HDI_CAST(double, total);
    }
    return e->status;
}

/* [count] elements of size bytes, not cleared. NULL with e filled when there are none to have; e must be clear before. */
static void *hdi_alloc(hd_context *ctx, size_t count, size_t size, hd_error *e) {
    size_t total, offset;
    uint64_t head[2];
    char *raw;
    if (!hdi_size(count, size, HDI_ALIGN + HDI_HEADER, &total)) {
        hdi_fail(e, HD_ERR_TOO_LARGE, "an array would be larger than the address space");
        return NULL;
    }
    if (hdi_alloc_check(ctx, total, e) < 0) return NULL;
    ctx->allocations++;
    raw = HDI_CAST(char *, ctx->allocator.alloc ? ctx->allocator.alloc(ctx->allocator.user, total) : HEATDIFF_MALLOC(total));
    if (!raw) {
        hdi_fail(e, HD_ERR_MEMORY, "out of memory");
        e->value = HDI_CAST(double, total);
        return NULL;
    }
    ctx->bytes_in_use += total;
    if (ctx->bytes_peak < ctx->bytes_in_use) ctx->bytes_peak = ctx->bytes_in_use;
    offset = HDI_HEADER + (HDI_ALIGN - ((size_t)raw + HDI_HEADER) % HDI_ALIGN) % HDI_ALIGN;
    head[0] = total;
    head[1] = offset;
    memcpy(raw + offset - HDI_HEADER, head, sizeof head);
    return raw + offset;
}

static void hdi_free(hd_context *ctx, void *block) {
    uint64_t head[2];
    char *raw;
    if (!block) return;
    memcpy(head, HDI_CAST(char *, block) - HDI_HEADER, sizeof head);
    raw = HDI_CAST(char *, block) - head[1];
    ctx->bytes_in_use -= head[0];
    if (ctx->allocator.free) ctx->allocator.free(ctx->allocator.user, raw, HDI_CAST(size_t, head[0]));
    else HEATDIFF_FREE(raw);
}

/* Work arrays of one function. After a failed take all further ones give NULL, so one check of e->status serves for many. */
typedef struct hdi_scope {
    hd_context *ctx;
    hd_error *e;
    int32_t n;
    void *block[24];
} hdi_scope;

static hdi_scope hdi_scope_begin(hd_context *ctx, hd_error *e) {
    hdi_scope s;
    memset(&s, 0, sizeof s);
    hdi_error_clear(e);
    s.ctx = ctx;
    s.e = e;
    return s;
}

static void *hdi_take(hdi_scope *s, size_t count, size_t size) {
    void *p;
    HEATDIFF_ASSERT(s->n < HDI_CAST(int32_t, sizeof s->block / sizeof *s->block));
    if (s->e->status < 0) return NULL;
    p = hdi_alloc(s->ctx, count, size, s->e);
    if (p) s->block[s->n++] = p;
    return p;
}

static void *hdi_take_zero(hdi_scope *s, size_t count, size_t size) {
    void *p = hdi_take(s, count, size);
    if (p) memset(p, 0, count * size);
    return p;
}

/* Takes a block out of the scope: it becomes the caller's. */
static void *hdi_keep(hdi_scope *s, void *block) {
    int32_t i;
    for (i = 0; i < s->n; i++)
        if (s->block[i] == block) s->block[i] = NULL;
    return block;
}

static hd_status hdi_scope_end(hdi_scope *s) {
    while (s->n > 0) hdi_free(s->ctx, s->block[--s->n]);
    return s->e->status;
}

#define HDI_TAKE(scope, type, count) HDI_CAST(type *, hdi_take(scope, HDI_CAST(size_t, count), sizeof(type)))
#define HDI_TAKE_ZERO(scope, type, count) HDI_CAST(type *, hdi_take_zero(scope, HDI_CAST(size_t, count), sizeof(type)))

/* ==== [04] context ====
 * Progress, cancelling and parallel loops. May call [03]. */

static hd_status hdi_context_check(const hd_context *ctx, hd_error *e) {
    if (!ctx->allocator.alloc != !ctx->allocator.free)
        return hdi_fail(e, HD_ERR_ARGUMENT, "context: the allocator needs both alloc and free, or none");
    if (ctx->threads < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "context: threads is negative");
    return HD_OK;
}

/* By the calling thread only. */
static hd_status hdi_progress(hd_context *ctx, const char *stage, double done, hd_error *e) {
    hd_progress answer;
    if (!ctx->progress) return HD_OK;
    answer = ctx->progress(ctx->progress_user, stage, done);
    if (answer == HD_PROGRESS_CONTINUE) return HD_OK;
    if (answer == HD_PROGRESS_CANCEL) return hdi_fail(e, HD_ERR_CANCELLED, "cancelled by the progress callback");
    return hdi_fail(e, HD_ERR_ARGUMENT, "context: progress returned neither HD_PROGRESS_CONTINUE nor HD_PROGRESS_CANCEL");
}

static void hdi_parallel(hd_context *ctx, int64_t n_tasks, hd_task task, void *arg) {
    int64_t i;
    if (ctx->parallel_for && n_tasks > 1) {
        ctx->parallel_for(ctx->parallel_user, n_tasks, task, arg);
        return;
    }
#if HDI_OPENMP
    if (n_tasks > 1 && ctx->threads != 1 && !omp_in_parallel()) {
        const int threads = ctx->threads > 0 ? ctx->threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
        for (i = 0; i < n_tasks; i++) task(arg, i, omp_get_thread_num());
        return;
    }
#endif
    for (i = 0; i < n_tasks; i++) task(arg, i, 0);
}

/* ==== [05] arrays ====
 * Sorting, prefix sums, union-find. May call [04]. */

/* count[i] becomes the sum of those before it, count[n] the sum of all. */
static int64_t hdi_prefix_sum(int64_t *count, int64_t n) {
    int64_t i, sum = 0;
    for (i = 0; i < n; i++) {
        const int64_t c = count[i];
        count[i] = sum;
        sum += c;
    }
    count[n] = sum;
    return sum;
}

/* A key with a payload; ordered by both, so that sorting is stable where payloads ascend. */
typedef struct hdi_pair { uint64_t key; int64_t id; } hdi_pair;

static int hdi_pair_less(const hdi_pair *a, const hdi_pair *b) { return a->key != b->key ? a->key < b->key : a->id < b->id; }

static void hdi_sift_down(hdi_pair *a, int64_t i, int64_t n) {
    const hdi_pair x = a[i];
    int64_t child;
    while ((child = 2 * i + 1) < n) {
        if (child + 1 < n && hdi_pair_less(a + child, a + child + 1)) child++;
        if (!hdi_pair_less(&x, a + child)) break;
        a[i] = a[child];
        i = child;
    }
    a[i] = x;
}

/* Insertion sort for the short lists that meshes are full of, heapsort for the rest: never quadratic. */
static void hdi_sort_pairs(hdi_pair *a, int64_t n) {
    int64_t i, j;
    if (n <= 24) {
        for (i = 1; i < n; i++) {
            const hdi_pair x = a[i];
            for (j = i; j > 0 && hdi_pair_less(&x, a + j - 1); j--) a[j] = a[j - 1];
            a[j] = x;
        }
        return;
    }
    for (i = n / 2; i-- > 0;) hdi_sift_down(a, i, n);
    for (i = n; i-- > 1;) {
        const hdi_pair x = a[i];
        a[i] = a[0];
        a[0] = x;
        hdi_sift_down(a, 0, i);
    }
}

/* Sorts n indices; work [n] for long lists. */
static void hdi_sort_indices(int32_t *a, int64_t n, hdi_pair *work) {
    int64_t i, j;
    if (n <= 24) {
        for (i = 1; i < n; i++) {
            const int32_t x = a[i];
            for (j = i; j > 0 && x < a[j - 1]; j--) a[j] = a[j - 1];
            a[j] = x;
        }
        return;
    }
    for (i = 0; i < n; i++) {
        work[i].key = HDI_CAST(uint64_t, a[i]);
        work[i].id = 0;
    }
    hdi_sort_pairs(work, n);
    for (i = 0; i < n; i++) a[i] = HDI_CAST(int32_t, work[i].key);
}

/* Union-find with path halving; the smaller id is always the root, so roots do not depend on the order of the calls. */
static int32_t hdi_find(int32_t *parent, int32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void hdi_unite(int32_t *parent, int32_t i, int32_t j) {
    const int32_t a = hdi_find(parent, i), b = hdi_find(parent, j);
    if (a < b) parent[b] = a;
    else parent[a] = b;
}

/* ==== [06] dense ====
 * Vectors. May call [01]. Sums run in four fixed strands: quick without -ffast-math, and the same on every run. */

static double hdi_dot(const double *HDI_RESTRICT x, const double *HDI_RESTRICT y, int64_t n) {
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    int64_t i;
    for (i = 0; i + 4 <= n; i += 4) {
        s0 += x[i] * y[i];
        s1 += x[i + 1] * y[i + 1];
        s2 += x[i + 2] * y[i + 2];
        s3 += x[i + 3] * y[i + 3];
    }
    for (; i < n; i++) s0 += x[i] * y[i];
    return (s0 + s1) + (s2 + s3);
}

/* x' y, no conjugate: the bilinear form of complex-symmetric methods. */
static hd_c64 hdi_cdotu(const hd_c64 *HDI_RESTRICT x, const hd_c64 *HDI_RESTRICT y, int64_t n) {
    hd_c64 s0 = hdi_c(0, 0), s1 = s0;
    int64_t i;
    for (i = 0; i + 2 <= n; i += 2) {
        s0 = hdi_cadd(s0, hdi_cmul(x[i], y[i]));
        s1 = hdi_cadd(s1, hdi_cmul(x[i + 1], y[i + 1]));
    }
    for (; i < n; i++) s0 = hdi_cadd(s0, hdi_cmul(x[i], y[i]));
    return hdi_cadd(s0, s1);
}

/* sum w_i |x_i|^2 */
static double hdi_cnorm2w(const hd_c64 *HDI_RESTRICT x, const double *HDI_RESTRICT w, int64_t n) {
    double s0 = 0, s1 = 0;
    int64_t i;
    for (i = 0; i + 2 <= n; i += 2) {
        s0 += w[i] * hdi_cabs2(x[i]);
        s1 += w[i + 1] * hdi_cabs2(x[i + 1]);
    }
    for (; i < n; i++) s0 += w[i] * hdi_cabs2(x[i]);
    return s0 + s1;
}

static double hdi_norm2w(const double *HDI_RESTRICT x, const double *HDI_RESTRICT w, int64_t n) {
    double s0 = 0, s1 = 0;
    int64_t i;
    for (i = 0; i + 2 <= n; i += 2) {
        s0 += w[i] * (x[i] * x[i]);
        s1 += w[i + 1] * (x[i + 1] * x[i + 1]);
    }
    for (; i < n; i++) s0 += w[i] * (x[i] * x[i]);
    return s0 + s1;
}

static void hdi_axpy(double a, const double *HDI_RESTRICT x, double *HDI_RESTRICT y, int64_t n) {
    int64_t i;
    for (i = 0; i < n; i++) y[i] += a * x[i];
}

/* Eigenvalues of the symmetric tridiagonal matrix with diagonal d [m] and off-diagonal e [m] (e[i] between i and i + 1; e[m - 1] unused),
 * by implicit QL with Wilkinson's shift (Bowdler, Martin, Reinsch, Wilkinson 1968). z0, z1 [m] are two rows that go through the same
 * rotations: put in rows of the identity, they come out as rows of the eigenvectors. Overwrites all. 0 when it does not converge. */
static int hdi_tridiag_eigen(double *d, double *e, double *z0, double *z1, int32_t m) {
    int32_t l, i, k, sweep;
    if (m > 0) e[m - 1] = 0;
    for (l = 0; l < m; l++) {
        for (sweep = 0;; sweep++) {
            double g, r, s = 1, c = 1, p = 0;
            for (k = l; k < m - 1; k++)
                if (fabs(e[k]) <= DBL_EPSILON * (fabs(d[k]) + fabs(d[k + 1]))) break;
            if (k == l) break;
            if (sweep == 60) return 0;
            g = (d[l + 1] - d[l]) / (2 * e[l]);
            r = hdi_pythag(g, 1);
            g = d[k] - d[l] + e[l] / (g + (g >= 0 ? r : -r));
            for (i = k - 1; i >= l; i--) {       /* chase the bulge upwards */
                const double f = s * e[i], b = c * e[i];
                double z;
                r = hdi_pythag(f, g);
                e[i + 1] = r;
                if (r == 0) {
                    d[i + 1] -= p;
                    e[k] = 0;
                    break;
                }
                s = f / r;
                c = g / r;
                g = d[i + 1] - p;
                r = (d[i] - g) * s + 2 * c * b;
                p = s * r;
                d[i + 1] = g + p;
                g = c * r - b;
                z = z0[i + 1];
                z0[i + 1] = s * z0[i] + c * z;
                z0[i] = c * z0[i] - s * z;
                z = z1[i + 1];
                z1[i + 1] = s * z1[i] + c * z;
                z1[i] = c * z1[i] - s * z;
            }
            if (r == 0 && i >= l) continue;
            d[l] -= p;
            e[l] = g;
            e[k] = 0;
        }
    }
    return 1;
}

/* ==== [07] sparse ====
 * Compressed rows: build, check, transpose, multiply, renumber. May call [06]. */

static void hdi_csr_free(hd_context *ctx, hd_csr *a) {
    hdi_free(ctx, a->row_ptr);
    hdi_free(ctx, a->col);
    hdi_free(ctx, a->val);
    memset(a, 0, sizeof *a);
}

/* An empty shell with room for nnz entries in s. */
static hd_csr hdi_csr_take(hdi_scope *s, int32_t n_rows, int32_t n_cols, int64_t nnz, int values) {
    hd_csr a;
    a.n_rows = n_rows;
    a.n_cols = n_cols;
    a.nnz = nnz;
    a.row_ptr = HDI_TAKE_ZERO(s, int64_t, HDI_CAST(int64_t, n_rows) + 1);
    a.col = HDI_TAKE(s, int32_t, nnz);
    a.val = values ? HDI_TAKE(s, double, nnz) : NULL;
    return a;
}

static hd_csr hdi_csr_keep(hdi_scope *s, hd_csr a) {
    hdi_keep(s, a.row_ptr);
    hdi_keep(s, a.col);
    hdi_keep(s, a.val);
    return a;
}

/* t = a' into arrays of the right size; t->row_ptr zero. The columns of t ascend whatever the order in a. */
static void hdi_csr_transpose_into(const hd_csr *a, hd_csr *t) {
    int64_t p;
    int32_t i;
    for (p = 0; p < a->nnz; p++) t->row_ptr[a->col[p]]++;
    hdi_prefix_sum(t->row_ptr, t->n_rows);
    for (i = 0; i < a->n_rows; i++) {
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const int64_t q = t->row_ptr[a->col[p]]++;
            t->col[q] = i;
            if (t->val) t->val[q] = a->val[p];
        }
    }
    for (i = t->n_rows; i > 0; i--) t->row_ptr[i] = t->row_ptr[i - 1];
    t->row_ptr[0] = 0;
}

/* Sums entries with the same place, in their order. */
static void hdi_csr_merge(hd_csr *a) {
    int64_t p, q = 0, end = 0;
    int32_t i;
    for (i = 0; i < a->n_rows; i++) {
        const int64_t begin = q;
        p = end;
        end = a->row_ptr[i + 1];
        for (; p < end; p++) {
            if (q > begin && a->col[q - 1] == a->col[p]) {
                if (a->val) a->val[q - 1] += a->val[p];
                continue;
            }
            a->col[q] = a->col[p];
            if (a->val) a->val[q] = a->val[p];
            q++;
        }
        a->row_ptr[i + 1] = q;
    }
    a->nnz = q;
}

static hd_status hdi_csr_from_triplets(hd_csr *out, int32_t n_rows, int32_t n_cols, int64_t n, const int32_t *ti, const int32_t *tj,
                                       const double *tv, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    hd_csr t, a;
    int64_t q;
    for (q = 0; q < n; q++) {
        if (ti[q] < 0 || ti[q] >= n_rows || tj[q] < 0 || tj[q] >= n_cols)
            return hdi_fail_row(e, HD_ERR_INDEX, "triplet: row or column out of range", q, -1, ti[q] < 0 || ti[q] >= n_rows ? ti[q] : tj[q]);
        if (tv && !hdi_finite(tv[q])) return hdi_fail_row(e, HD_ERR_NOT_FINITE, "triplet: value not finite", q, -1, tv[q]);
    }
    t = hdi_csr_take(&s, n_cols, n_rows, n, tv != NULL);   /* by columns, in the order given; its transpose has sorted rows */
    a = hdi_csr_take(&s, n_rows, n_cols, n, tv != NULL);
    if (e->status < 0) return hdi_scope_end(&s);
    for (q = 0; q < n; q++) t.row_ptr[tj[q]]++;
    hdi_prefix_sum(t.row_ptr, n_cols);
    for (q = 0; q < n; q++) {
        const int64_t p = t.row_ptr[tj[q]]++;
        t.col[p] = ti[q];
        if (tv) t.val[p] = tv[q];
    }
    for (q = n_cols; q > 0; q--) t.row_ptr[q] = t.row_ptr[q - 1];
    t.row_ptr[0] = 0;
    hdi_csr_transpose_into(&t, &a);
    hdi_csr_merge(&a);
    *out = hdi_csr_keep(&s, a);
    return hdi_scope_end(&s);
}

static hd_status hdi_csr_check_rows(const hd_csr *a, hd_error *e) {
    int32_t i;
    int64_t p;
    if (a->n_rows < 0 || a->n_cols < 0 || a->nnz < 0 || !a->row_ptr || (a->nnz && !a->col))
        return hdi_fail(e, HD_ERR_STRUCTURE, "matrix: negative size or missing array");
    if (a->row_ptr[0] != 0) return hdi_fail_row(e, HD_ERR_STRUCTURE, "matrix: row_ptr does not begin with 0", 0, -1, 0);
    for (i = 0; i < a->n_rows; i++)
        if (a->row_ptr[i + 1] < a->row_ptr[i] || a->row_ptr[i + 1] > a->nnz)
            return hdi_fail_row(e, HD_ERR_STRUCTURE, "matrix: row_ptr descends or exceeds nnz", i, -1, HDI_CAST(double, a->row_ptr[i + 1]));
    if (a->row_ptr[a->n_rows] != a->nnz)
        return hdi_fail_row(e, HD_ERR_STRUCTURE, "matrix: row_ptr does not end with nnz", a->n_rows, -1, HDI_CAST(double, a->row_ptr[a->n_rows]));
    for (i = 0; i < a->n_rows; i++) {
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            if (a->col[p] < 0 || a->col[p] >= a->n_cols)
                return hdi_fail_row(e, HD_ERR_INDEX, "matrix: column out of range", i, a->col[p], a->col[p]);
            if (p > a->row_ptr[i] && a->col[p] <= a->col[p - 1])
                return hdi_fail_row(e, HD_ERR_STRUCTURE, "matrix: columns do not ascend in a row", i, a->col[p], a->col[p]);
            if (a->val && !hdi_finite(a->val[p])) return hdi_fail_row(e, HD_ERR_NOT_FINITE, "matrix: value not finite", i, a->col[p], a->val[p]);
        }
    }
    return HD_OK;
}

static hd_status hdi_csr_check_symmetric(const hd_csr *a, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    hd_csr t;
    int32_t i;
    if (a->n_rows != a->n_cols) return hdi_fail_row(e, HD_ERR_NOT_SYMMETRIC, "matrix: not square", a->n_rows, a->n_cols, 0);
    t = hdi_csr_take(&s, a->n_cols, a->n_rows, a->nnz, a->val != NULL);
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_csr_transpose_into(a, &t);
    for (i = 0; i < a->n_rows && !e->status; i++) {   /* merge the rows: a missing entry is a zero */
        int64_t p = a->row_ptr[i], q = t.row_ptr[i];
        const int64_t p_end = a->row_ptr[i + 1], q_end = t.row_ptr[i + 1];
        while ((p < p_end || q < q_end) && !e->status) {
            const int32_t cp = p < p_end ? a->col[p] : INT32_MAX, cq = q < q_end ? t.col[q] : INT32_MAX;
            const double x = a->val ? (cp <= cq ? a->val[p] : 0) : cp <= cq, y = a->val ? (cq <= cp ? t.val[q] : 0) : cq <= cp;
            if (fabs(x - y) > 1e-12 * hdi_max(fabs(x), fabs(y)))
                hdi_fail_row(e, HD_ERR_NOT_SYMMETRIC, "matrix: not symmetric", i, cp <= cq ? cp : cq, x - y);
            p += cp <= cq;
            q += cq <= cp;
        }
    }
    return hdi_scope_end(&s);
}

static hd_status hdi_csr_check(const hd_csr *a, int symmetric, hd_context *ctx, hd_error *e) {
    if (hdi_csr_check_rows(a, e) < 0) return e->status;
    return symmetric ? hdi_csr_check_symmetric(a, ctx, e) : HD_OK;
}

static hd_status hdi_csr_transpose(hd_csr *out, const hd_csr *a, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    hd_csr t = hdi_csr_take(&s, a->n_cols, a->n_rows, a->nnz, a->val != NULL);
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_csr_transpose_into(a, &t);
    *out = hdi_csr_keep(&s, t);
    return hdi_scope_end(&s);
}

/* Columns of row i of A B, unsorted, into col (NULL: counted only). mark [b->n_cols] holds the last row that saw a column. */
static int64_t hdi_product_row(const hd_csr *a, const hd_csr *b, int32_t i, int32_t *mark, int32_t *col) {
    int64_t p, q, n = 0;
    for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
        const int32_t k = a->col[p];
        for (q = b->row_ptr[k]; q < b->row_ptr[k + 1]; q++) {
            if (mark[b->col[q]] == i) continue;
            mark[b->col[q]] = i;
            if (col) col[n] = b->col[q];
            n++;
        }
    }
    return n;
}

static void hdi_fill_i32(int32_t *a, int64_t n, int32_t value) {
    int64_t i;
    for (i = 0; i < n; i++) a[i] = value;
}

static hd_status hdi_csr_product(hd_csr *out, const hd_csr *a, const hd_csr *b, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    const int values = a->val && b->val;
    int32_t *mark = HDI_TAKE(&s, int32_t, b->n_cols);
    double *sum = HDI_TAKE(&s, double, b->n_cols);
    hdi_pair *work = HDI_TAKE(&s, hdi_pair, b->n_cols);
    int64_t nnz = 0, p, q;
    hd_csr c;
    int32_t i;
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_fill_i32(mark, b->n_cols, -1);
    for (i = 0; i < a->n_rows; i++) nnz += hdi_product_row(a, b, i, mark, NULL);
    c = hdi_csr_take(&s, a->n_rows, b->n_cols, nnz, values);
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_fill_i32(mark, b->n_cols, -1);
    for (i = 0; i < a->n_rows; i++) {
        int32_t *col = c.col + c.row_ptr[i];
        const int64_t n = hdi_product_row(a, b, i, mark, col);
        c.row_ptr[i + 1] = c.row_ptr[i] + n;
        hdi_sort_indices(col, n, work);
        if (!values) continue;
        for (p = 0; p < n; p++) sum[col[p]] = 0;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            for (q = b->row_ptr[a->col[p]]; q < b->row_ptr[a->col[p] + 1]; q++) sum[b->col[q]] += a->val[p] * b->val[q];
        for (p = 0; p < n; p++) c.val[c.row_ptr[i] + p] = sum[col[p]];
    }
    *out = hdi_csr_keep(&s, c);
    return hdi_scope_end(&s);
}

static hd_status hdi_csr_permute(hd_csr *out, const hd_csr *a, const int32_t *perm, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    int32_t *inverse = HDI_TAKE(&s, int32_t, a->n_rows);
    hd_csr b, t;
    int32_t i;
    int64_t p;
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_fill_i32(inverse, a->n_rows, -1);
    for (i = 0; i < a->n_rows; i++) {
        if (perm[i] < 0 || perm[i] >= a->n_rows || inverse[perm[i]] >= 0) {
            hdi_fail_row(e, HD_ERR_INDEX, "permutation: an index is out of range or occurs twice", i, -1, perm[i]);
            return hdi_scope_end(&s);
        }
        inverse[perm[i]] = i;
    }
    t = hdi_csr_take(&s, a->n_rows, a->n_rows, a->nnz, a->val != NULL);   /* (P A P')', rows in the old order of columns */
    b = hdi_csr_take(&s, a->n_rows, a->n_rows, a->nnz, a->val != NULL);
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = 0; i < a->n_rows; i++) {
        int64_t q = t.row_ptr[i];
        for (p = a->row_ptr[perm[i]]; p < a->row_ptr[perm[i] + 1]; p++, q++) {
            t.col[q] = inverse[a->col[p]];
            if (t.val) t.val[q] = a->val[p];
        }
        t.row_ptr[i + 1] = q;
    }
    hdi_csr_transpose_into(&t, &b);    /* twice transposed: the columns of every row ascend */
    memset(t.row_ptr, 0, (HDI_CAST(size_t, t.n_rows) + 1) * sizeof *t.row_ptr);
    hdi_csr_transpose_into(&b, &t);
    *out = hdi_csr_keep(&s, t);
    return hdi_scope_end(&s);
}

/* How far ahead of a sweep over a matrix its entries are asked for, once a row. The processor's own prefetching stops at page borders: with
 * this, L x runs at the speed of memory, 37 GB/s instead of 20 on the machine it was tuned on (7 entries a row, 130 MB). */
enum { HDI_AHEAD = 512 };

/* y = A x for rows [begin, end). */
static void hdi_csr_apply_rows(const hd_csr *a, const double *HDI_RESTRICT x, double *HDI_RESTRICT y, int32_t begin, int32_t end) {
    const int64_t *HDI_RESTRICT Ap = a->row_ptr;
    const int32_t *HDI_RESTRICT Aj = a->col;
    const double *HDI_RESTRICT Ax = a->val;
    int64_t p = Ap[begin];
    int32_t i;
    for (i = begin; i < end; i++) {
        const int64_t row_end = Ap[i + 1];
        double sum = 0;
        HDI_PREFETCH(Ax + p + HDI_AHEAD);
        HDI_PREFETCH(Aj + p + HDI_AHEAD);
        for (; p < row_end; p++) sum += Ax[p] * x[Aj[p]];
        y[i] = sum;
    }
}

/* Rows in blocks of about the same number of non-zeros would be fairer, but surface rows are all alike. */
enum { HDI_ROWS_PER_TASK = 16384 };

typedef struct hdi_apply_job { const hd_csr *a; const double *x; double *y; } hdi_apply_job;

static void hdi_apply_task(void *arg, int64_t index, int32_t worker) {
    const hdi_apply_job *job = HDI_CAST(const hdi_apply_job *, arg);
    const int64_t begin = index * HDI_ROWS_PER_TASK, end = begin + HDI_ROWS_PER_TASK;
    (void)worker;
    hdi_csr_apply_rows(job->a, job->x, job->y, HDI_CAST(int32_t, begin), HDI_CAST(int32_t, end < job->a->n_rows ? end : job->a->n_rows));
}

static void hdi_csr_apply(const hd_csr *a, const double *x, double *y, hd_context *ctx) {
    hdi_apply_job job;
    job.a = a;
    job.x = x;
    job.y = y;
    hdi_parallel(ctx, (HDI_CAST(int64_t, a->n_rows) + HDI_ROWS_PER_TASK - 1) / HDI_ROWS_PER_TASK, hdi_apply_task, &job);
}

/* ==== [09] geometry ====
 * Triangles: checks, corner cotangents, which faces are left out, and who meets at a vertex. May call [05]. */

typedef struct hdi_mesh {
    const double *xyz;
    const int32_t *tri;
    int32_t n, m;
    double *cot;        /* [3 m] cotangent at each corner */
    double *area;       /* [m] 0: the face is left out */
    int64_t *corner_ptr;/* [n + 1] corners at each vertex, as indices into tri, faces ascending */
    int32_t *corner;    /* [3 m]; corners of faces left out are not listed */
} hdi_mesh;

static void hdi_sub3(const double *a, const double *b, double *out) {
    out[0] = a[0] - b[0];
    out[1] = a[1] - b[1];
    out[2] = a[2] - b[2];
}

static double hdi_dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* a b - c d with both products rounded. A compiler may contract this to fused multiply-adds, which leaves the rounding of one product
 * where exactly zero is right; when the result is that small it is computed again in steps that cannot be fused. */
static double hdi_det2(double a, double b, double c, double d) {
    const double x = a * b - c * d;
    volatile double p, q;
    if (fabs(x) > 4 * DBL_EPSILON * fabs(a * b)) return x;
    p = a * b;
    q = c * d;
    return p - q;
}

static void hdi_cross3(const double *a, const double *b, double *out) {
    out[0] = hdi_det2(a[1], b[2], a[2], b[1]);
    out[1] = hdi_det2(a[2], b[0], a[0], b[2]);
    out[2] = hdi_det2(a[0], b[1], a[1], b[0]);
}

/* Length without squares that underflow or overflow. */
static double hdi_norm3(const double *a) {
    const double m = hdi_max(fabs(a[0]), hdi_max(fabs(a[1]), fabs(a[2])));
    double b[3];
    if (m == 0 || (m > 1e-140 && m < 1e140)) return sqrt(hdi_dot3(a, a));
    b[0] = a[0] / m;
    b[1] = a[1] / m;
    b[2] = a[2] / m;
    return m * sqrt(hdi_dot3(b, b));
}

static hd_status hdi_mesh_check(const double *xyz, int32_t n, const int32_t *tri, int32_t m, hd_error *e) {
    int64_t i;
    for (i = 0; i < 3 * HDI_CAST(int64_t, n); i++)
        if (!hdi_finite(xyz[i])) return hdi_fail_face(e, HD_ERR_NOT_FINITE, "a coordinate is not finite", -1, i / 3, xyz[i]);
    for (i = 0; i < 3 * HDI_CAST(int64_t, m); i++)
        if (tri[i] < 0 || tri[i] >= n) return hdi_fail_face(e, HD_ERR_INDEX, "a face names a vertex that does not exist", i / 3, -1, tri[i]);
    return HD_OK;
}

/* Area and cotangents of face f; area 0 where it has none or where a cotangent would not be finite. */
static hd_status hdi_face_measure(hdi_mesh *mesh, int32_t f, hd_mesh_report *rep, hd_error *e) {
    const int32_t *v = mesh->tri + 3 * HDI_CAST(int64_t, f);
    double edge[3][3], cross[3], twice, *cot = mesh->cot + 3 * HDI_CAST(int64_t, f);
    int q;
    mesh->area[f] = 0;
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        rep->n_repeated_corner++;
        return HD_OK;
    }
    for (q = 0; q < 3; q++)   /* edge q runs opposite to corner q */
        hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, v[(q + 2) % 3]), mesh->xyz + 3 * HDI_CAST(int64_t, v[(q + 1) % 3]), edge[q]);
    hdi_cross3(edge[2], edge[0], cross);
    twice = hdi_norm3(cross);
    if (!hdi_finite(twice)) return hdi_fail_face(e, HD_ERR_NOT_FINITE, "a face is too large: its area is not finite", f, v[0], twice);
    for (q = 0; q < 3; q++) cot[q] = -hdi_dot3(edge[(q + 1) % 3], edge[(q + 2) % 3]) / twice;
    if (twice / 24 < DBL_MIN || !hdi_finite(cot[0]) || !hdi_finite(cot[1]) || !hdi_finite(cot[2])) {
        rep->n_zero_area++;
        return HD_OK;
    }
    mesh->area[f] = twice / 2;
    rep->smallest_angle = hdi_min(rep->smallest_angle, atan2(1, hdi_max(cot[0], hdi_max(cot[1], cot[2]))));
    return HD_OK;
}

/* Corner lists of all vertices, over the faces that have an area. */
static void hdi_mesh_corners(hdi_mesh *mesh) {
    const int64_t n_corners = 3 * HDI_CAST(int64_t, mesh->m);
    int64_t c;
    int32_t i;
    memset(mesh->corner_ptr, 0, (HDI_CAST(size_t, mesh->n) + 1) * sizeof *mesh->corner_ptr);
    for (c = 0; c < n_corners; c++)
        if (mesh->area[c / 3] > 0) mesh->corner_ptr[mesh->tri[c]]++;
    hdi_prefix_sum(mesh->corner_ptr, mesh->n);
    for (c = 0; c < n_corners; c++)
        if (mesh->area[c / 3] > 0) mesh->corner[mesh->corner_ptr[mesh->tri[c]]++] = HDI_CAST(int32_t, c);
    for (i = mesh->n; i > 0; i--) mesh->corner_ptr[i] = mesh->corner_ptr[i - 1];
    mesh->corner_ptr[0] = 0;
}

/* Gives faces with the corners of an earlier one area 0: around each vertex, the faces in which it is the smallest corner are sorted
 * by their two other corners. work: as many pairs as the busiest vertex has corners. */
static void hdi_mesh_repeats(hdi_mesh *mesh, hdi_pair *work, hd_mesh_report *rep) {
    int32_t i;
    int64_t p, n;
    for (i = 0; i < mesh->n; i++) {
        n = 0;
        for (p = mesh->corner_ptr[i]; p < mesh->corner_ptr[i + 1]; p++) {
            const int32_t c = mesh->corner[p], f = c / 3, *v = mesh->tri + 3 * HDI_CAST(int64_t, f);
            const int32_t a = v[(c + 1) % 3], b = v[(c + 2) % 3], lo = a < b ? a : b, hi = a < b ? b : a;
            if (lo < i) continue;
            work[n].key = HDI_CAST(uint64_t, lo) << 32 | HDI_CAST(uint64_t, hi);
            work[n++].id = f;
        }
        hdi_sort_pairs(work, n);
        for (p = 1; p < n; p++) {
            if (work[p].key != work[p - 1].key) continue;
            mesh->area[work[p].id] = 0;
            rep->n_repeated_face++;
        }
    }
}

static int64_t hdi_most_corners(const hdi_mesh *mesh) {
    int64_t most = 1;
    int32_t i;
    for (i = 0; i < mesh->n; i++)
        if (mesh->corner_ptr[i + 1] - mesh->corner_ptr[i] > most) most = mesh->corner_ptr[i + 1] - mesh->corner_ptr[i];
    return most;
}

/* Checks the mesh, measures the faces, and leaves out those that contribute nothing. The arrays live in s. */
static hd_status hdi_mesh_make(hdi_mesh *mesh, const double *xyz, int32_t n, const int32_t *tri, int32_t m, hd_mesh_report *rep,
                               hdi_scope *s) {
    const int64_t n_corners = 3 * HDI_CAST(int64_t, m);
    hdi_pair *work;
    int32_t f;
    memset(mesh, 0, sizeof *mesh);
    mesh->xyz = xyz;
    mesh->tri = tri;
    mesh->n = n;
    mesh->m = m;
    rep->n_faces = m;
    rep->smallest_angle = m > 0 ? 4 : 0;
    if (n_corners > INT32_MAX) return hdi_fail(s->e, HD_ERR_TOO_LARGE, "more than 2^31 face corners");
    if (hdi_mesh_check(xyz, n, tri, m, s->e) < 0) return s->e->status;
    mesh->cot = HDI_TAKE(s, double, n_corners);
    mesh->area = HDI_TAKE(s, double, m);
    mesh->corner_ptr = HDI_TAKE(s, int64_t, HDI_CAST(int64_t, n) + 1);
    mesh->corner = HDI_TAKE(s, int32_t, n_corners);
    if (s->e->status < 0) return s->e->status;
    for (f = 0; f < m; f++)
        if (hdi_face_measure(mesh, f, rep, s->e) < 0) return s->e->status;
    hdi_mesh_corners(mesh);
    work = HDI_TAKE(s, hdi_pair, hdi_most_corners(mesh));
    if (!work) return s->e->status;
    hdi_mesh_repeats(mesh, work, rep);
    if (rep->n_repeated_face) hdi_mesh_corners(mesh);
    for (f = 0; f < m; f++) rep->n_faces_used += mesh->area[f] > 0;
    if (!rep->n_faces_used) rep->smallest_angle = 0;
    return HD_OK;
}

/* ==== [10] operators ====
 * The pair (L, B) on one pattern. May call [09] and [07].
 * This work is based on
 *   U. Pinkall, K. Polthier, Computing discrete minimal surfaces and their conjugates, 1993 (cotangent weights)
 *   M. Meyer, M. Desbrun, P. Schroeder, A. Barr, Discrete differential-geometry operators for triangulated 2-manifolds, 2003 (mixed areas)
 * Deviation: the paper cites Desbrun 1999 for Voronoi areas, which lumps by thirds; pure Voronoi areas go negative on obtuse triangles. */

static void hdi_laplacian_free(hd_laplacian *lap, hd_context *ctx) {
    if (!lap) return;
    hdi_csr_free(ctx, &lap->L);
    if (lap->b_diag != lap->mass) hdi_free(ctx, lap->b_diag);
    hdi_free(ctx, lap->B);
    hdi_free(ctx, lap->mass);
    hdi_free(ctx, lap->vertex);
    hdi_free(ctx, lap->row);
    hdi_free(ctx, lap->component);
    hdi_free(ctx, lap->component_mass);
    hdi_free(ctx, lap);
}

/* Area that corner c of a face contributes to its vertex under the mixed rule. */
static double hdi_mixed_area(const hdi_mesh *mesh, int32_t c) {
    const int32_t f = c / 3, q = c % 3, a = mesh->tri[c];
    const double *cot = mesh->cot + 3 * HDI_CAST(int64_t, f), area = mesh->area[f];
    double sum = 0, edge[3];
    int k;
    if (cot[0] < 0 || cot[1] < 0 || cot[2] < 0) return cot[q] < 0 ? area / 2 : area / 4;
    for (k = 1; k <= 2; k++) {   /* |a b|^2 cot(c) + |a c|^2 cot(b) */
        hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, mesh->tri[3 * f + (q + k) % 3]), mesh->xyz + 3 * HDI_CAST(int64_t, a), edge);
        sum += hdi_dot3(edge, edge) * cot[(q + 3 - k) % 3];
    }
    return sum / 8;
}

static double hdi_vertex_mass(const hdi_mesh *mesh, int32_t v, hd_laplacian_kind kind) {
    double sum = 0;
    int64_t p;
    if (mesh->corner_ptr[v] == mesh->corner_ptr[v + 1]) return 0;
    if (kind == HD_LAPLACIAN_COT) return 1;
    for (p = mesh->corner_ptr[v]; p < mesh->corner_ptr[v + 1]; p++)
        sum += kind == HD_LAPLACIAN_FEM ? mesh->area[mesh->corner[p] / 3] / 3 : hdi_mixed_area(mesh, mesh->corner[p]);
    return sum;
}

/* Numbers the rows: vertices with mass in their order. Fills row, vertex, mass, b_diag, n_active. */
static hd_status hdi_lap_rows(hd_laplacian *lap, const double *vertex_mass, hd_error *e) {
    int32_t v, k = 0;
    hd_context *ctx = lap->context;
    lap->row = HDI_CAST(int32_t *, hdi_alloc(ctx, HDI_CAST(size_t, lap->n), sizeof(int32_t), e));
    if (!lap->row) return e->status;
    for (v = 0; v < lap->n; v++) lap->row[v] = vertex_mass[v] > 0 ? k++ : -1;
    lap->n_active = k;
    lap->mesh.n_inert = lap->n - k;
    if (k == 0) return hdi_fail(e, HD_ERR_EMPTY, "no vertex has mass");
    lap->vertex = HDI_CAST(int32_t *, hdi_alloc(ctx, HDI_CAST(size_t, k), sizeof(int32_t), e));
    if (lap->vertex) lap->mass = HDI_CAST(double *, hdi_alloc(ctx, HDI_CAST(size_t, k), sizeof(double), e));
    if (e->status < 0) return e->status;
    lap->b_diag = lap->mass;
    for (v = 0; v < lap->n; v++) {
        if (lap->row[v] < 0) continue;
        lap->vertex[lap->row[v]] = v;
        lap->mass[lap->row[v]] = vertex_mass[v];
    }
    return HD_OK;
}

/* Components over the pattern of L, numbered by their first row, and their masses. */
static hd_status hdi_lap_components(hd_laplacian *lap, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    int32_t *parent = HDI_TAKE(&s, int32_t, lap->n_active), i;
    int64_t p;
    if (!parent) return hdi_scope_end(&s);
    lap->component = HDI_CAST(int32_t *, hdi_alloc(lap->context, HDI_CAST(size_t, lap->n_active), sizeof(int32_t), e));
    if (!lap->component) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) parent[i] = i;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1] && lap->L.col[p] < i; p++) hdi_unite(parent, i, lap->L.col[p]);
    for (i = 0; i < lap->n_active; i++) {
        const int32_t root = hdi_find(parent, i);    /* roots are smallest members, so they have their number already */
        lap->component[i] = root == i ? lap->n_components++ : lap->component[root];
    }
    lap->component_mass = HDI_CAST(double *, hdi_alloc(lap->context, HDI_CAST(size_t, lap->n_components), sizeof(double), e));
    if (!lap->component_mass) return hdi_scope_end(&s);
    memset(lap->component_mass, 0, HDI_CAST(size_t, lap->n_components) * sizeof(double));
    for (i = 0; i < lap->n_active; i++) lap->component_mass[lap->component[i]] += lap->mass[i];
    return hdi_scope_end(&s);
}

/* Distinct neighbours of vertex v and v itself, as rows of lap, unsorted, into col. mark [n_active] as in hdi_product_row. */
static int64_t hdi_ring(const hdi_mesh *mesh, const hd_laplacian *lap, int32_t v, int32_t *mark, int32_t *col) {
    const int32_t i = lap->row[v];
    int64_t p, n = 1;
    int k;
    mark[i] = i;
    col[0] = i;
    for (p = mesh->corner_ptr[v]; p < mesh->corner_ptr[v + 1]; p++) {
        const int32_t c = mesh->corner[p], f = c / 3;
        for (k = 1; k <= 2; k++) {
            const int32_t j = lap->row[mesh->tri[3 * f + (c + k) % 3]];
            if (mark[j] == i) continue;
            mark[j] = i;
            col[n++] = j;
        }
    }
    return n;
}

/* The pattern of L, columns ascending. */
static hd_status hdi_lap_pattern(hd_laplacian *lap, const hdi_mesh *mesh, int32_t *mark, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    const int64_t ring = 2 * hdi_most_corners(mesh) + 1;
    int32_t *col = HDI_TAKE(&s, int32_t, ring), i;
    hdi_pair *work = HDI_TAKE(&s, hdi_pair, ring);
    int64_t nnz = 0;
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_fill_i32(mark, lap->n_active, -1);
    for (i = 0; i < lap->n_active; i++) nnz += hdi_ring(mesh, lap, lap->vertex[i], mark, col);
    lap->L = hdi_csr_take(&s, lap->n_active, lap->n_active, nnz, 1);
    if (e->status < 0) {
        memset(&lap->L, 0, sizeof lap->L);
        return hdi_scope_end(&s);
    }
    hdi_fill_i32(mark, lap->n_active, -1);
    for (i = 0; i < lap->n_active; i++) {
        const int64_t begin = lap->L.row_ptr[i], n = hdi_ring(mesh, lap, lap->vertex[i], mark, col);
        hdi_sort_indices(col, n, work);
        memcpy(lap->L.col + begin, col, HDI_CAST(size_t, n) * sizeof *col);
        lap->L.row_ptr[i + 1] = begin + n;
    }
    lap->L = hdi_csr_keep(&s, lap->L);
    return hdi_scope_end(&s);
}

/* Values of row i. Contributions come in the order of the faces in both rows of an edge, so L and B are symmetric to the last bit.
 * place [n_active]: where a column stands in this row. */
static void hdi_lap_row_values(hd_laplacian *lap, const hdi_mesh *mesh, int32_t i, int64_t *place) {
    const int32_t v = lap->vertex[i];
    const int64_t begin = lap->L.row_ptr[i], end = lap->L.row_ptr[i + 1];
    double *L = lap->L.val, *B = lap->B, sum = 0;
    int64_t p;
    int k;
    for (p = begin; p < end; p++) {
        place[lap->L.col[p]] = p;
        L[p] = 0;
        if (B) B[p] = 0;
    }
    for (p = mesh->corner_ptr[v]; p < mesh->corner_ptr[v + 1]; p++) {
        const int32_t c = mesh->corner[p], f = c / 3, q = c % 3;
        for (k = 1; k <= 2; k++) {   /* the edge to corner q + k is opposite to the third one */
            const int64_t at = place[lap->row[mesh->tri[3 * f + (q + k) % 3]]];
            L[at] -= mesh->cot[3 * f + (q + 3 - k) % 3] / 2;
            if (B) B[at] += mesh->area[f] / 12;
        }
        if (B) B[place[i]] += mesh->area[f] / 6;
    }
    for (p = begin; p < end; p++)
        if (lap->L.col[p] != i) sum += L[p];
    L[place[i]] = -sum;
}

/* Faces along each edge of row i to later rows: how many, and in which direction. */
static void hdi_edge_counts(const hd_laplacian *lap, const hdi_mesh *mesh, int32_t i, const int64_t *place, int32_t *count, int32_t *turn) {
    const int32_t v = lap->vertex[i];
    const int64_t begin = lap->L.row_ptr[i], n = lap->L.row_ptr[i + 1] - begin;
    int64_t p;
    int k;
    for (p = 0; p < n; p++) count[p] = turn[p] = 0;
    for (p = mesh->corner_ptr[v]; p < mesh->corner_ptr[v + 1]; p++) {
        const int32_t c = mesh->corner[p], f = c / 3;
        for (k = 1; k <= 2; k++) {
            const int64_t at = place[lap->row[mesh->tri[3 * f + (c + k) % 3]]] - begin;
            count[at]++;
            turn[at] += k == 1 ? 1 : -1;
        }
    }
}

/* Statistics of the edges of row i, and the union of boundary edges in parent [n_active]. Returns the sum of the edges' lengths. */
static double hdi_edge_report(hd_laplacian *lap, const hdi_mesh *mesh, int32_t i, const int32_t *count, const int32_t *turn, int32_t *parent) {
    const int64_t begin = lap->L.row_ptr[i];
    hd_mesh_report *rep = &lap->mesh;
    double sum = 0, edge[3];
    int64_t p;
    for (p = begin; p < lap->L.row_ptr[i + 1]; p++) {
        const int32_t j = lap->L.col[p], faces = count[p - begin];
        if (j <= i) continue;
        hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, lap->vertex[j]), mesh->xyz + 3 * HDI_CAST(int64_t, lap->vertex[i]), edge);
        sum += hdi_norm3(edge);
        rep->n_edges++;
        rep->n_nonmanifold_edges += faces > 2;
        rep->n_misoriented_edges += faces == 2 && turn[p - begin] != 0;
        rep->n_negative_weights += lap->L.val[p] > 0;
        if (faces != 1) continue;
        rep->n_boundary_edges++;
        hdi_unite(parent, i, j);
    }
    return sum;
}

/* Values of L and B, edge statistics and h. */
static hd_status hdi_lap_values(hd_laplacian *lap, const hdi_mesh *mesh, int32_t *parent, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    int64_t *place = HDI_TAKE(&s, int64_t, lap->n_active), widest = 1;
    int32_t *count, *turn, i;
    double length = 0;
    for (i = 0; i < lap->n_active; i++)
        if (lap->L.row_ptr[i + 1] - lap->L.row_ptr[i] > widest) widest = lap->L.row_ptr[i + 1] - lap->L.row_ptr[i];
    count = HDI_TAKE(&s, int32_t, widest);
    turn = HDI_TAKE(&s, int32_t, widest);
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) parent[i] = i;
    for (i = 0; i < lap->n_active; i++) {
        hdi_lap_row_values(lap, mesh, i, place);
        hdi_edge_counts(lap, mesh, i, place, count, turn);
        length += hdi_edge_report(lap, mesh, i, count, turn, parent);
        if (lap->B) lap->b_diag[i] = lap->B[place[i]];
    }
    lap->h = length / HDI_CAST(double, lap->mesh.n_edges);
    for (i = 0; i < lap->n_active; i++) {   /* a loop is a root with another vertex in its set */
        const int32_t root = hdi_find(parent, i);
        if (root == i || place[root] == -1) continue;
        place[root] = -1;
        lap->mesh.n_boundary_loops++;
    }
    return hdi_scope_end(&s);
}

static hd_status hdi_lap_triangles(hd_laplacian *lap, const double *xyz, const int32_t *tri, int32_t m, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    hdi_mesh mesh;
    double *vertex_mass;
    int32_t *mark, v, f;
    if (hdi_mesh_make(&mesh, xyz, lap->n, tri, m, &lap->mesh, &s) < 0) return hdi_scope_end(&s);
    vertex_mass = HDI_TAKE(&s, double, lap->n);
    if (!vertex_mass) return hdi_scope_end(&s);
    for (v = 0; v < lap->n; v++) vertex_mass[v] = hdi_vertex_mass(&mesh, v, lap->kind);
    if (hdi_lap_rows(lap, vertex_mass, e) < 0 || hdi_progress(lap->context, "assemble", 0.3, e) < 0) return hdi_scope_end(&s);
    mark = HDI_TAKE(&s, int32_t, lap->n_active);
    if (!mark || hdi_lap_pattern(lap, &mesh, mark, e) < 0) return hdi_scope_end(&s);
    if (lap->kind == HD_LAPLACIAN_FEM) {
        lap->B = HDI_CAST(double *, hdi_alloc(lap->context, HDI_CAST(size_t, lap->L.nnz), sizeof(double), e));
        if (!lap->B) return hdi_scope_end(&s);
        lap->b_diag = HDI_CAST(double *, hdi_alloc(lap->context, HDI_CAST(size_t, lap->n_active), sizeof(double), e));
        if (!lap->b_diag) return hdi_scope_end(&s);
    }
    if (hdi_lap_values(lap, &mesh, mark, e) < 0 || hdi_progress(lap->context, "assemble", 0.8, e) < 0) return hdi_scope_end(&s);
    for (f = 0; f < m; f++) lap->area += mesh.area[f];
    lap->b_ratio = lap->kind == HD_LAPLACIAN_FEM ? 0.5 : 1;   /* element matrix area/12 (1 1' + I) >= 1/2 of its diagonal, area/12 I */
    lap->conserves = 1;
    hdi_lap_components(lap, e);
    return hdi_scope_end(&s);
}

/* y = (alpha L + beta B) x on rows. */
static void hdi_pair_apply(const hd_laplacian *lap, double alpha, double beta, const double *HDI_RESTRICT x, double *HDI_RESTRICT y) {
    const int64_t *HDI_RESTRICT Ap = lap->L.row_ptr;
    const int32_t *HDI_RESTRICT Aj = lap->L.col;
    const double *HDI_RESTRICT Lx = lap->L.val, *HDI_RESTRICT Bx = lap->B;
    int32_t i;
    int64_t p = 0;
    for (i = 0; i < lap->n_active; i++) {
        double l = 0, b = 0;
        HDI_PREFETCH(Lx + p + HDI_AHEAD);
        HDI_PREFETCH(Aj + p + HDI_AHEAD);
        if (Bx) {
            HDI_PREFETCH(Bx + p + HDI_AHEAD);
            for (; p < Ap[i + 1]; p++) {
                l += Lx[p] * x[Aj[p]];
                b += Bx[p] * x[Aj[p]];
            }
        } else {
            for (; p < Ap[i + 1]; p++) l += Lx[p] * x[Aj[p]];
            b = lap->mass[i] * x[i];
        }
        y[i] = alpha * l + beta * b;
    }
}

/* |x|_B^2; work [n_active] is used when B is not diagonal. */
static double hdi_b_norm2(const hd_laplacian *lap, const double *x, double *work) {
    if (!lap->B) return hdi_norm2w(x, lap->mass, lap->n_active);
    hdi_pair_apply(lap, 0, 1, x, work);
    return hdi_dot(x, work, lap->n_active);
}

/* Means over the components in the B inner product, of a functional b'x: out[c] = sum over c of weight_i x_i. */
static void hdi_component_sums(const hd_laplacian *lap, const double *weight, const double *x, double *out) {
    int32_t i;
    if (lap->n_components == 1) {
        out[0] = weight ? hdi_dot(weight, x, lap->n_active) : 0;
        for (i = 0; !weight && i < lap->n_active; i++) out[0] += x[i];
        return;
    }
    memset(out, 0, HDI_CAST(size_t, lap->n_components) * sizeof *out);
    for (i = 0; i < lap->n_active; i++) out[lap->component[i]] += weight ? weight[i] * x[i] : x[i];
}

/* x_i += value[component of i] */
static void hdi_component_add(const hd_laplacian *lap, const double *value, double *x) {
    int32_t i;
    for (i = 0; i < lap->n_active; i++) x[i] += value[lap->component[i]];
}

/* ---- the caller's own matrices ---- */

/* Merges row i of L and B (both over vertices) on the active columns, the diagonal always there. col NULL: counts only. */
static int64_t hdi_pair_row(const hd_laplacian *lap, const hd_csr *L, const hd_csr *B, int32_t v, int32_t *col, double *Lx, double *Bx) {
    int64_t p = L->row_ptr[v], q = B->row_ptr[v], n = 0;
    const int64_t p_end = L->row_ptr[v + 1], q_end = B->row_ptr[v + 1];
    int diagonal = 0;
    while (p < p_end || q < q_end || !diagonal) {
        const int32_t cp = p < p_end ? L->col[p] : INT32_MAX, cq = q < q_end ? B->col[q] : INT32_MAX, cd = diagonal ? INT32_MAX : v;
        const int32_t c = cp < cq ? (cp < cd ? cp : cd) : (cq < cd ? cq : cd);
        if (lap->row[c] >= 0) {
            if (col) {
                col[n] = lap->row[c];
                Lx[n] = cp == c ? L->val[p] : 0;
                Bx[n] = cq == c ? B->val[q] : 0;
            }
            n++;
        }
        p += cp == c;
        q += cq == c;
        diagonal |= cd == c;
    }
    return n;
}

/* b = B 1, diag(B) and their signs; is B diagonal, how dominant is its diagonal; is L 1 = 0. */
static hd_status hdi_pair_measure(hd_laplacian *lap, int *diagonal, hd_error *e) {
    int32_t i;
    int64_t p;
    *diagonal = 1;
    lap->conserves = 1;
    lap->b_ratio = 1;
    for (i = 0; i < lap->n_active; i++) {
        double l_sum = 0, l_abs = 0, b_sum = 0, b_off = 0, b_diag = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            l_sum += lap->L.val[p];
            l_abs += fabs(lap->L.val[p]);
            b_sum += lap->B[p];
            if (lap->L.col[p] == i) b_diag = lap->B[p];
            else b_off += fabs(lap->B[p]);
        }
        if (!(b_diag > 0)) return hdi_fail_row(e, HD_ERR_NOT_POSITIVE, "B: a diagonal entry is not positive", lap->vertex[i], lap->vertex[i], b_diag);
        if (fabs(l_sum) > 1e-11 * l_abs) lap->conserves = 0;
        if (b_off > 0) *diagonal = 0;
        lap->b_ratio = hdi_min(lap->b_ratio, 1 - b_off / b_diag);
        lap->mass[i] = b_sum;
        lap->b_diag[i] = b_diag;
        lap->area += b_sum;
    }
    return HD_OK;
}

/* Where rows of B are not dominated by their diagonal, as in finite elements: the smallest eigenvalue of D^-1 B, D = diag(B), by 40 Lanczos
 * steps, a fifth taken off for safety. An estimate, not a bound: meshes know theirs exactly. work [4 n]. */
static hd_status hdi_pair_ratio(hd_laplacian *lap, double *work, hd_error *e) {
    enum { STEPS = 40 };
    const int32_t n = lap->n_active;
    double *v = work, *v_old = v + n, *w = v_old + n, *s = w + n, d[STEPS], off[STEPS], z[2 * STEPS], beta = 0, norm = 0, least;
    int32_t i, m = 0, k;
    for (i = 0; i < n; i++) {                    /* B in the scaling D^-1/2 B D^-1/2; an uneven start, the same every time */
        s[i] = 1 / sqrt(lap->b_diag[i]);
        v[i] = 1 + 0.5 * sin(1.7 * i);
        v_old[i] = 0;
        norm += v[i] * v[i];
    }
    for (i = 0; i < n; i++) v[i] /= sqrt(norm);
    while (m < STEPS && m < n) {
        double alpha = 0;
        norm = 0;
        for (i = 0; i < n; i++) v[i] *= s[i];
        hdi_pair_apply(lap, 0, 1, v, w);
        for (i = 0; i < n; i++) {
            v[i] /= s[i];
            w[i] = w[i] * s[i] - beta * v_old[i];
            alpha += v[i] * w[i];
        }
        for (i = 0; i < n; i++) {
            w[i] -= alpha * v[i];
            norm += w[i] * w[i];
        }
        d[m] = alpha;
        beta = sqrt(norm);
        off[m++] = beta;
        if (beta < 1e-14) break;
        for (i = 0; i < n; i++) {
            v_old[i] = v[i];
            v[i] = w[i] / beta;
        }
    }
    for (k = 0; k < 2 * STEPS; k++) z[k] = 0;
    if (!hdi_tridiag_eigen(d, off, z, z + STEPS, m)) return hdi_fail(e, HD_ERR_BREAKDOWN, "B: the estimate of its smallest eigenvalue did not converge");
    for (least = d[0], k = 1; k < m; k++) least = hdi_min(least, d[k]);
    if (!(least > 1e-12)) return hdi_fail_row(e, HD_ERR_NOT_POSITIVE, "B is not positive definite", -1, -1, least);
    lap->b_ratio = hdi_min(1, 0.8 * least);
    return HD_OK;
}

static hd_status hdi_lap_matrices(hd_laplacian *lap, const hd_csr *L, const hd_csr *B, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    double *present = HDI_TAKE_ZERO(&s, double, lap->n), *b_diag;
    int64_t nnz = 0, p;
    int32_t i;
    int diagonal;
    if (!present) return hdi_scope_end(&s);
    for (i = 0; i < lap->n; i++)
        for (p = B->row_ptr[i]; p < B->row_ptr[i + 1]; p++)
            if (B->val[p] != 0) present[i] = 1;
    if (hdi_lap_rows(lap, present, e) < 0) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) nnz += hdi_pair_row(lap, L, B, lap->vertex[i], NULL, NULL, NULL);
    lap->L = hdi_csr_take(&s, lap->n_active, lap->n_active, nnz, 1);
    lap->B = HDI_TAKE(&s, double, nnz);
    b_diag = HDI_TAKE(&s, double, lap->n_active);
    if (e->status < 0) {
        memset(&lap->L, 0, sizeof lap->L);
        lap->B = NULL;
        return hdi_scope_end(&s);
    }
    lap->L = hdi_csr_keep(&s, lap->L);
    lap->B = HDI_CAST(double *, hdi_keep(&s, lap->B));
    lap->b_diag = HDI_CAST(double *, hdi_keep(&s, b_diag));
    for (i = 0; i < lap->n_active; i++) {
        p = lap->L.row_ptr[i];
        lap->L.row_ptr[i + 1] = p + hdi_pair_row(lap, L, B, lap->vertex[i], lap->L.col + p, lap->L.val + p, lap->B + p);
    }
    if (hdi_pair_measure(lap, &diagonal, e) < 0) return hdi_scope_end(&s);
    if (diagonal) {
        hdi_free(lap->context, lap->B);
        hdi_free(lap->context, lap->b_diag);
        lap->B = NULL;
        lap->b_diag = lap->mass;
    }
    if (lap->b_ratio < 0.01) {
        double *work = HDI_TAKE(&s, double, 4 * HDI_CAST(int64_t, lap->n_active));
        if (!work || hdi_pair_ratio(lap, work, e) < 0) return hdi_scope_end(&s);
    }
    hdi_lap_components(lap, e);
    return hdi_scope_end(&s);
}

/* ==== [11] symbolic ====
 * Orderings, and the pair renumbered by one. May call [10].
 * This work is based on
 *   E. Cuthill, J. McKee, Reducing the bandwidth of sparse symmetric matrices, 1969
 *   A. George, J. Liu, An implementation of a pseudoperipheral node finder, 1979
 * Breadth-first levels keep neighbours close in memory, and an incomplete factorisation along them is a good one: on the bunny, modified
 * ILDL(0) needs 752 steps instead of 1404 in the order of the file, and 1834 in a random one. */

/* Vertices of the component of start, breadth first, each ring by ascending degree; returns their number. seen [n] is stamp for those
 * visited. last: where the last level begins. work: as many pairs as the widest row. */
static int32_t hdi_sym_levels(const hd_csr *a, int32_t start, int32_t *order, int32_t *seen, int32_t stamp, hdi_pair *work, int32_t *last, int32_t *depth) {
    int32_t n = 1, head = 0, level_end = 1;
    int64_t p, k, q;
    order[0] = start;
    seen[start] = stamp;
    *last = 0;
    *depth = 0;
    for (; head < n; head++) {
        const int32_t i = order[head];
        if (head == level_end) {
            *last = head;
            level_end = n;
            ++*depth;
        }
        for (k = 0, p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) {
            const int32_t j = a->col[p];
            if (seen[j] == stamp) continue;
            seen[j] = stamp;
            work[k].key = HDI_CAST(uint64_t, a->row_ptr[j + 1] - a->row_ptr[j]);
            work[k++].id = j;
        }
        hdi_sort_pairs(work, k);
        for (q = 0; q < k; q++) order[n++] = HDI_CAST(int32_t, work[q].id);
    }
    return n;
}

/* Cuthill-McKee order of a symmetric pattern: perm[new] = old. */
static hd_status hdi_sym_cuthill_mckee(const hd_csr *a, int32_t *perm, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    const int32_t n = a->n_rows;
    int32_t *seen = HDI_TAKE(&s, int32_t, n), i, k, count, last, depth, deeper, start, done = 0, stamp = 0;
    int64_t widest = 1;
    hdi_pair *work;
    for (i = 0; i < n; i++)
        if (a->row_ptr[i + 1] - a->row_ptr[i] > widest) widest = a->row_ptr[i + 1] - a->row_ptr[i];
    work = HDI_TAKE(&s, hdi_pair, widest);
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_fill_i32(seen, n, -1);
    for (i = 0; i < n; i++) {
        if (seen[i] >= 0) continue;              /* a new component: walk to an end of it */
        start = i;
        count = hdi_sym_levels(a, start, perm + done, seen, stamp++, work, &last, &depth);
        for (k = 0; k < 4 && count > 1; k++) {
            start = perm[done + last];           /* levels are sorted by degree only within rings, any of the last will do */
            hdi_sym_levels(a, start, perm + done, seen, stamp++, work, &last, &deeper);
            if (deeper <= depth) break;
            depth = deeper;
        }
        done += count;
    }
    return hdi_scope_end(&s);
}

static void *hdi_copy(const void *from, size_t count, size_t size, hd_context *ctx, hd_error *e) {
    void *to = e->status < 0 ? NULL : hdi_alloc(ctx, count, size, e);
    if (to) memcpy(to, from, count * size);
    return to;
}

/* A Laplacian with rows renumbered: row i of out is row perm[i] of lap. out lives in ctx. */
static hd_laplacian *hdi_sym_renumber(const hd_laplacian *lap, const int32_t *perm, hd_context *ctx, hd_error *e) {
    const size_t n = HDI_CAST(size_t, lap->n_active);
    hd_csr b = lap->L, pb;
    hd_laplacian *out;
    int32_t i;
    hdi_error_clear(e);
    out = HDI_CAST(hd_laplacian *, hdi_copy(lap, 1, sizeof *lap, ctx, e));
    if (!out) return NULL;
    memset(&out->L, 0, sizeof out->L);
    out->context = ctx;
    out->B = NULL;
    out->mass = HDI_CAST(double *, hdi_copy(lap->mass, n, sizeof(double), ctx, e));
    out->vertex = HDI_CAST(int32_t *, hdi_copy(lap->vertex, n, sizeof(int32_t), ctx, e));
    out->component = HDI_CAST(int32_t *, hdi_copy(lap->component, n, sizeof(int32_t), ctx, e));
    out->row = HDI_CAST(int32_t *, hdi_copy(lap->row, HDI_CAST(size_t, lap->n), sizeof(int32_t), ctx, e));
    out->component_mass = HDI_CAST(double *, hdi_copy(lap->component_mass, HDI_CAST(size_t, lap->n_components), sizeof(double), ctx, e));
    out->b_diag = lap->B ? HDI_CAST(double *, hdi_copy(lap->b_diag, n, sizeof(double), ctx, e)) : out->mass;
    if (e->status >= 0 && lap->B) {
        b.val = lap->B;
        if (hdi_csr_permute(&pb, &b, perm, ctx, e) >= 0) {
            out->B = pb.val;
            pb.val = NULL;
            hdi_csr_free(ctx, &pb);
        }
    }
    if (e->status < 0 || hdi_csr_permute(&out->L, &lap->L, perm, ctx, e) < 0) {
        hdi_laplacian_free(out, ctx);
        return NULL;
    }
    for (i = 0; i < lap->n_active; i++) {
        out->mass[i] = lap->mass[perm[i]];
        out->b_diag[i] = lap->b_diag[perm[i]];
        out->component[i] = lap->component[perm[i]];
        out->vertex[i] = lap->vertex[perm[i]];
        out->row[out->vertex[i]] = i;
    }
    return out;
}

/* Multiplies B by a power of four that brings its largest diagonal entry near one, and returns it: exp(-t B^-1 L) is the same with t multiplied
 * alike, to the last bit, and squares of areas neither underflow nor overflow whatever the unit of length. */
static double hdi_sym_scale(hd_laplacian *lap) {
    double largest = 0, scale;
    int32_t i;
    int64_t p;
    int exponent;
    for (i = 0; i < lap->n_active; i++) largest = hdi_max(largest, lap->b_diag[i]);
    frexp(largest, &exponent);
    scale = ldexp(1, -2 * (exponent / 2));       /* even: norms scale exactly too */
    for (i = 0; i < lap->n_active; i++) lap->mass[i] *= scale;
    for (i = 0; i < lap->n_active && lap->B; i++) lap->b_diag[i] *= scale;
    for (p = 0; p < lap->L.nnz && lap->B; p++) lap->B[p] *= scale;
    for (i = 0; i < lap->n_components; i++) lap->component_mass[i] *= scale;
    return scale;
}

/* The same pair in an order that iterations like. */
static hd_laplacian *hdi_sym_ordered(const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    int32_t *perm = HDI_TAKE(&s, int32_t, lap->n_active);
    hd_laplacian *out = NULL;
    if (perm && hdi_sym_cuthill_mckee(&lap->L, perm, ctx, e) >= 0) out = hdi_sym_renumber(lap, perm, ctx, e);
    hdi_scope_end(&s);
    return out;
}

/* ==== [14] precond ====
 * Preconditioners M = (I + U') D (I + U), U strictly upper triangular on the pattern of L, D diagonal: one application serves them all,
 * complex-symmetric and real. May call [10].
 *   none    D = I, U = 0         jacobi  D = diag(A), U = 0
 *   ssor    D = diag(A), U = D^-1 upper(A): with omega = 1 the product form of SSOR
 *   ildl    incomplete LDL' without fill
 *   mildl   the same, with a part of the dropped fill added to the diagonal (I. Gustafsson, A class of first order factorization
 *           methods, 1978), which keeps what smooth vectors see of A. */

/* The strictly upper pattern of L: rows ascend, and so do columns within a row. */
typedef struct hdi_upper {
    int32_t n;
    int64_t *ptr;    /* [n + 1] */
    int32_t *col;
} hdi_upper;

static void hdi_upper_free(hd_context *ctx, hdi_upper *u) {
    hdi_free(ctx, u->ptr);
    hdi_free(ctx, u->col);
    memset(u, 0, sizeof *u);
}

static hd_status hdi_upper_make(hdi_upper *u, const hd_csr *L, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    int64_t *ptr = HDI_TAKE(&s, int64_t, HDI_CAST(int64_t, L->n_rows) + 1), p, nnz = 0;
    int32_t *col = HDI_TAKE(&s, int32_t, (L->nnz - L->n_rows) / 2), i;   /* a symmetric pattern with full diagonal */
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = 0; i < L->n_rows; i++) {
        ptr[i] = nnz;
        for (p = L->row_ptr[i]; p < L->row_ptr[i + 1]; p++)
            if (L->col[p] > i) col[nnz++] = L->col[p];
    }
    ptr[L->n_rows] = nnz;
    u->n = L->n_rows;
    u->ptr = HDI_CAST(int64_t *, hdi_keep(&s, ptr));
    u->col = HDI_CAST(int32_t *, hdi_keep(&s, col));
    return hdi_scope_end(&s);
}

/* A = t L + theta B, never formed. */
typedef struct hdi_system {
    const hd_laplacian *lap;
    double t;
    hd_c64 theta;
} hdi_system;

/* Upper values and diagonal of A; u may be NULL. */
static void hdi_system_upper(const hdi_system *a, const hdi_upper *up, hd_c64 *u, hd_c64 *d) {
    const hd_laplacian *lap = a->lap;
    int32_t i;
    int64_t p, q = 0;
    for (i = 0; i < up->n; i++) {
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double l = a->t * lap->L.val[p];
            if (lap->L.col[p] < i) continue;
            if (lap->L.col[p] == i) {
                d[i] = hdi_c(l + a->theta.re * lap->b_diag[i], a->theta.im * lap->b_diag[i]);
                continue;
            }
            if (u) u[q++] = lap->B ? hdi_c(l + a->theta.re * lap->B[p], a->theta.im * lap->B[p]) : hdi_c(l, 0);
        }
    }
}

/* First entry of row i of u at or after column c; columns are few. */
static int64_t hdi_upper_find(const hdi_upper *up, int32_t i, int32_t c) {
    int64_t lo = up->ptr[i], hi = up->ptr[i + 1];
    while (lo < hi) {
        const int64_t mid = lo + (hi - lo) / 2;
        if (up->col[mid] < c) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

/* A pivot that lost nearly all of its diagonal entry, or turned away from it, is replaced by that entry: an incomplete factorisation
 * may break down where the complete one cannot. */
static hd_c64 hdi_pivot(hd_c64 d, hd_c64 a) {
    const double along = d.re * a.re + d.im * a.im;
    if (along > 1e-3 * hdi_cabs2(a) && hdi_cfinite(d)) return d;
    return a;
}

/* Right-looking incomplete LDL' of the complex-symmetric A, plain transpose. On entry u holds the upper part, d and diag the diagonal; on
 * exit u the factor. Row k updates the entries (i, j) between its own columns; where the pattern has none, `keep` of the update
 * goes to the diagonal entries of i and j. Work per row k: the shorter of the two searches, so that a vertex with very many neighbours
 * costs no square of their number. mark [n] = -1 on entry. */
static void hdi_ildl(const hdi_upper *up, hd_c64 *u, hd_c64 *d, const hd_c64 *diag, double keep, int64_t *mark) {
    int32_t k;
    int64_t p, q;
    for (k = 0; k < up->n; k++) {
        const int64_t begin = up->ptr[k], end = up->ptr[k + 1];
        hd_c64 sum = hdi_c(0, 0);
        d[k] = hdi_pivot(d[k], diag[k]);
        for (p = begin; p < end; p++) {
            mark[up->col[p]] = p;
            u[p] = hdi_cdiv(u[p], d[k]);
            sum = hdi_cadd(sum, u[p]);
        }
        for (p = begin; p < end; p++) {
            const int32_t i = up->col[p];
            const int64_t row_len = up->ptr[i + 1] - up->ptr[i];
            const hd_c64 w = hdi_cmul(u[p], d[k]);
            hd_c64 kept = hdi_c(0, 0);
            if (row_len > 8 * (end - p)) {     /* look up the columns of k in the longer row i */
                for (q = p + 1; q < end; q++) {
                    const int64_t at = hdi_upper_find(up, i, up->col[q]);
                    if (at == up->ptr[i + 1] || up->col[at] != up->col[q]) continue;
                    u[at] = hdi_csub(u[at], hdi_cmul(w, u[q]));
                    d[up->col[q]] = hdi_cadd(d[up->col[q]], hdi_cscale(keep, hdi_cmul(w, u[q])));
                    kept = hdi_cadd(kept, u[q]);
                }
            } else {
                for (q = up->ptr[i]; q < up->ptr[i + 1]; q++) {
                    const int64_t at = mark[up->col[q]];
                    if (at < begin) continue;
                    u[q] = hdi_csub(u[q], hdi_cmul(w, u[at]));
                    d[up->col[q]] = hdi_cadd(d[up->col[q]], hdi_cscale(keep, hdi_cmul(w, u[at])));
                    kept = hdi_cadd(kept, u[at]);
                }
            }
            /* own update, and of the rest of the row what was not kept: the part before p is put back by the lines above */
            d[i] = hdi_csub(d[i], hdi_cmul(w, u[p]));
            d[i] = hdi_csub(d[i], hdi_cscale(keep, hdi_cmul(w, hdi_csub(hdi_csub(sum, u[p]), kept))));
        }
    }
}

typedef struct hdi_precond {
    hd_precond kind;
    const hdi_upper *up;
    hd_c64 *u;        /* [nnz of up] or NULL */
    hd_c64 *d_inv;    /* [n] or NULL */
} hdi_precond;

/* Fills m, whose arrays are there. work [n] complex, mark [n]. */
static void hdi_precond_make(hdi_precond *m, const hdi_system *a, hd_c64 *work, int64_t *mark) {
    const int32_t n = m->up->n;
    int32_t i;
    int64_t p;
    if (m->kind == HD_PRECOND_NONE) return;
    hdi_system_upper(a, m->up, m->u, m->d_inv);
    if (m->kind == HD_PRECOND_SSOR) {
        for (i = 0; i < n; i++)
            for (p = m->up->ptr[i]; p < m->up->ptr[i + 1]; p++) m->u[p] = hdi_cdiv(m->u[p], m->d_inv[i]);
    } else if (m->kind != HD_PRECOND_JACOBI) {
        memcpy(work, m->d_inv, HDI_CAST(size_t, n) * sizeof *work);
        for (i = 0; i < n; i++) mark[i] = -1;
        hdi_ildl(m->up, m->u, m->d_inv, work, m->kind == HD_PRECOND_MILDL ? 0.97 : 0, mark);
    }
    for (i = 0; i < n; i++) m->d_inv[i] = hdi_cdiv(hdi_c(1, 0), m->d_inv[i]);
}

/* z = M^-1 r: (I + U') w = r, z = (I + U)^-1 D^-1 w. z may not be r. */
static void hdi_precond_apply(const hdi_precond *m, const hd_c64 *HDI_RESTRICT r, hd_c64 *HDI_RESTRICT z) {
    const int64_t *HDI_RESTRICT ptr = m->up->ptr;
    const int32_t *HDI_RESTRICT col = m->up->col;
    const hd_c64 *HDI_RESTRICT u = m->u;
    const int32_t n = m->up->n;
    int32_t i;
    int64_t p;
    if (!m->d_inv) {
        memcpy(z, r, HDI_CAST(size_t, n) * sizeof *z);
        return;
    }
    if (!u) {
        for (i = 0; i < n; i++) z[i] = hdi_cmul(r[i], m->d_inv[i]);
        return;
    }
    memcpy(z, r, HDI_CAST(size_t, n) * sizeof *z);
    for (i = 0; i < n; i++) {
        const hd_c64 w = z[i];
        HDI_PREFETCH(u + ptr[i] + HDI_AHEAD / 4);
        HDI_PREFETCH(col + ptr[i] + HDI_AHEAD);
        for (p = ptr[i]; p < ptr[i + 1]; p++) z[col[p]] = hdi_csub(z[col[p]], hdi_cmul(u[p], w));
    }
    for (i = n; i-- > 0;) {
        hd_c64 w = hdi_cmul(z[i], m->d_inv[i]);
        HDI_PREFETCH(u + ptr[i] - HDI_AHEAD / 4);
        HDI_PREFETCH(col + ptr[i] - HDI_AHEAD);
        for (p = ptr[i]; p < ptr[i + 1]; p++) w = hdi_csub(w, hdi_cmul(u[p], z[col[p]]));
        z[i] = w;
    }
}

/* ==== [15] krylov ====
 * Iterative solvers for (t L + theta B) x = b, complex symmetric: every inner product is x'y without conjugate, unless it is a norm.
 * For real theta and b every number stays real and cocg is the conjugate gradient method. May call [14].
 * This work is based on
 *   H. van der Vorst, J. Melissen, A Petrov-Galerkin type method for solving Ax = b, where A is symmetric complex, 1990 (cocg)
 *   T. Sogabe, S.-L. Zhang, A COCR method for solving complex symmetric linear systems, 2007 (cocr)
 *   S.-C. Choi, Minimal residual methods for complex symmetric, skew symmetric, and skew Hermitian systems, 2013 (minres)
 *   Y. Saad, M. Yeung, J. Erhel, F. Guyomarc'h, A deflated version of the conjugate gradient algorithm, 2000 (deflation)
 * Where L 1 = 0, the constants W of the components are known eigenvectors: A W = theta B W. Right-hand sides come without them (1'b = 0
 * per component), and they are kept out of all directions: that takes the smallest eigenvalue out of the iteration, and the caller, who
 * knows their part of the solution exactly, conserves heat. */

/* y = A x on rows; returns x'y. */
static hd_c64 hdi_system_apply(const hdi_system *a, const hd_c64 *HDI_RESTRICT x, hd_c64 *HDI_RESTRICT y) {
    const int64_t *HDI_RESTRICT Ap = a->lap->L.row_ptr;
    const int32_t *HDI_RESTRICT Aj = a->lap->L.col;
    const double *HDI_RESTRICT Lx = a->lap->L.val, *HDI_RESTRICT Bx = a->lap->B, *HDI_RESTRICT b = a->lap->mass;
    const double t = a->t;
    const hd_c64 theta = a->theta;
    hd_c64 dot = hdi_c(0, 0);
    const int32_t n = a->lap->n_active;
    int32_t i;
    int64_t p = 0;
    for (i = 0; i < n; i++) {
        const int64_t end = Ap[i + 1];
        hd_c64 l = hdi_c(0, 0), m = hdi_c(0, 0), s;
        HDI_PREFETCH(Lx + p + HDI_AHEAD);
        HDI_PREFETCH(Aj + p + HDI_AHEAD);
        if (Bx) {
            HDI_PREFETCH(Bx + p + HDI_AHEAD);
            for (; p < end; p++) {
                const hd_c64 v = x[Aj[p]];
                l.re += Lx[p] * v.re;
                l.im += Lx[p] * v.im;
                m.re += Bx[p] * v.re;
                m.im += Bx[p] * v.im;
            }
        } else {
            for (; p < end; p++) {
                const hd_c64 v = x[Aj[p]];
                l.re += Lx[p] * v.re;
                l.im += Lx[p] * v.im;
            }
            m = hdi_cscale(b[i], x[i]);
        }
        s = hdi_cadd(hdi_cscale(t, l), hdi_cmul(theta, m));
        y[i] = s;
        dot = hdi_cadd(dot, hdi_cmul(x[i], s));
    }
    return dot;
}

/* Takes the B-mean of every component out of z. sums [n_components]. */
static void hdi_deflate(const hd_laplacian *lap, hd_c64 *z, hd_c64 *sums) {
    const double *b = lap->mass;
    const int32_t *comp = lap->component;
    int32_t i;
    if (!lap->conserves) return;
    if (lap->n_components == 1) {
        hd_c64 s0 = hdi_c(0, 0), s1 = s0;
        for (i = 0; i + 2 <= lap->n_active; i += 2) {
            s0 = hdi_cadd(s0, hdi_cscale(b[i], z[i]));
            s1 = hdi_cadd(s1, hdi_cscale(b[i + 1], z[i + 1]));
        }
        for (; i < lap->n_active; i++) s0 = hdi_cadd(s0, hdi_cscale(b[i], z[i]));
        s0 = hdi_cscale(1 / lap->component_mass[0], hdi_cadd(s0, s1));
        for (i = 0; i < lap->n_active; i++) z[i] = hdi_csub(z[i], s0);
        return;
    }
    memset(sums, 0, HDI_CAST(size_t, lap->n_components) * sizeof *sums);
    for (i = 0; i < lap->n_active; i++) sums[comp[i]] = hdi_cadd(sums[comp[i]], hdi_cscale(b[i], z[i]));
    for (i = 0; i < lap->n_components; i++) sums[i] = hdi_cscale(1 / lap->component_mass[i], sums[i]);
    for (i = 0; i < lap->n_active; i++) z[i] = hdi_csub(z[i], sums[comp[i]]);
}

enum { HDI_KRYLOV_VECTORS = 8 };

/* One system under solution. It can be stopped and taken up again. */
typedef struct hdi_krylov {
    hdi_system a;
    hdi_precond m;
    hd_solver solver;
    const double *weight;                /* [n] 1/diag(B): the residual's norm */
    hd_c64 *sums;                        /* [n_components] */
    hd_c64 *spare;                       /* [n] the best x so far, when a round may spoil it */
    hd_c64 *x, *r;                       /* [n] solution and residual */
    hd_c64 *v[HDI_KRYLOV_VECTORS - 2];   /* [n] each, as many as the solver needs */
    double r_norm, b_norm;               /* in the norm of diag(B)^-1 */
    int64_t iterations;
    int32_t broken, ready;
    hd_c64 rho, phibar, s1, s2;          /* recurrences */
    double beta, beta_old, c1, c2;
} hdi_krylov;

/* Vectors of a system's own, x and r among them; one more after them is work within a step. */
static int hdi_krylov_vectors(hd_solver solver) { return solver == HD_SOLVER_COCG ? 3 : solver == HD_SOLVER_COCR ? 6 : 7; }

static void hdi_krylov_precond(hdi_krylov *k, const hd_c64 *r, hd_c64 *z) {
    hdi_precond_apply(&k->m, r, z);
    hdi_deflate(k->a.lap, z, k->sums);
}

/* r = b - A x from x, and its norm: the truth that recurrences drift away from. */
static void hdi_krylov_residual(hdi_krylov *k, const hd_c64 *b) {
    const int32_t n = k->a.lap->n_active;
    int32_t i;
    hdi_system_apply(&k->a, k->x, k->r);
    for (i = 0; i < n; i++) k->r[i] = hdi_csub(b[i], k->r[i]);
    k->r_norm = sqrt(hdi_cnorm2w(k->r, k->weight, n));
    k->ready = 0;
}

/* What rounding contributes to the residual of x at most, in the same norm; in practice less than half of it. */
static double hdi_krylov_noise(const hdi_krylov *k) {
    const hd_laplacian *lap = k->a.lap;
    const double theta = hdi_cabs(k->a.theta);
    double sum = 0;
    int64_t p = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        double a = theta * lap->b_diag[i];
        for (; p < lap->L.row_ptr[i + 1]; p++) a += k->a.t * fabs(lap->L.val[p]);
        sum += k->weight[i] * a * a * hdi_cabs2(k->x[i]);
    }
    return DBL_EPSILON * sqrt(sum);
}

/* x += alpha p, r -= alpha q; returns the new norm of r. */
static double hdi_krylov_step(hdi_krylov *k, hd_c64 alpha, const hd_c64 *HDI_RESTRICT p, const hd_c64 *HDI_RESTRICT q) {
    hd_c64 *HDI_RESTRICT x = k->x, *HDI_RESTRICT r = k->r;
    const double *HDI_RESTRICT w = k->weight;
    const int32_t n = k->a.lap->n_active;
    double norm = 0;
    int32_t i;
    for (i = 0; i < n; i++) {
        x[i] = hdi_cadd(x[i], hdi_cmul(alpha, p[i]));
        r[i] = hdi_csub(r[i], hdi_cmul(alpha, q[i]));
        norm += w[i] * hdi_cabs2(r[i]);
    }
    return sqrt(norm);
}

/* z = M^-1 r without its constants taken out: their B-means go to k->sums instead. Returns r'z, which constants do not change (1'r = 0). */
static hd_c64 hdi_krylov_precond_dot(hdi_krylov *k, const hd_c64 *HDI_RESTRICT r, hd_c64 *HDI_RESTRICT z) {
    const hd_laplacian *lap = k->a.lap;
    const double *HDI_RESTRICT b = lap->mass;
    const int32_t n = lap->n_active, *comp = lap->n_components > 1 ? lap->component : NULL;
    hd_c64 dot = hdi_c(0, 0), mean = dot, *sums = k->sums;
    int32_t i;
    hdi_precond_apply(&k->m, r, z);
    memset(sums, 0, HDI_CAST(size_t, lap->n_components) * sizeof *sums);
    for (i = 0; i < n; i++) {
        dot = hdi_cadd(dot, hdi_cmul(r[i], z[i]));
        if (comp) sums[comp[i]] = hdi_cadd(sums[comp[i]], hdi_cscale(b[i], z[i]));
        else mean = hdi_cadd(mean, hdi_cscale(b[i], z[i]));
    }
    if (!comp) sums[0] = mean;
    for (i = 0; i < lap->n_components; i++) sums[i] = hdi_cscale(lap->conserves ? 1 / lap->component_mass[i] : 0, sums[i]);
    return dot;
}

/* p = z - its B-means + beta p */
static void hdi_krylov_deflated_direction(const hdi_krylov *k, hd_c64 beta, const hd_c64 *HDI_RESTRICT z, hd_c64 *HDI_RESTRICT p) {
    const int32_t n = k->a.lap->n_active, *comp = k->a.lap->n_components > 1 ? k->a.lap->component : NULL;
    const hd_c64 mean = k->sums[0];
    int32_t i;
    for (i = 0; i < n; i++) p[i] = hdi_cadd(hdi_csub(z[i], comp ? k->sums[comp[i]] : mean), hdi_cmul(beta, p[i]));
}

/* p = z + beta p */
static void hdi_krylov_direction(hd_c64 beta, const hd_c64 *HDI_RESTRICT z, hd_c64 *HDI_RESTRICT p, int32_t n) {
    int32_t i;
    for (i = 0; i < n; i++) p[i] = hdi_cadd(z[i], hdi_cmul(beta, p[i]));
}

/* A quotient of the recurrence; marks the method as broken when it is none. */
static hd_c64 hdi_krylov_quotient(hdi_krylov *k, hd_c64 a, hd_c64 b) {
    const hd_c64 q = hdi_cdiv(a, b);
    if (!hdi_cfinite(q)) k->broken = 1;
    return q;
}

static void hdi_cocg_step(hdi_krylov *k) {
    hd_c64 *p = k->v[0], *q = k->v[1], alpha, rho;
    if (!k->ready) {
        memset(p, 0, HDI_CAST(size_t, k->a.lap->n_active) * sizeof *p);
        k->rho = hdi_krylov_precond_dot(k, k->r, q);
        hdi_krylov_deflated_direction(k, hdi_c(0, 0), q, p);
    }
    alpha = hdi_krylov_quotient(k, k->rho, hdi_system_apply(&k->a, p, q));
    if (k->broken) return;
    k->r_norm = hdi_krylov_step(k, alpha, p, q);
    rho = hdi_krylov_precond_dot(k, k->r, q);    /* q is free now: z = M^-1 r */
    hdi_krylov_deflated_direction(k, hdi_krylov_quotient(k, rho, k->rho), q, p);
    k->rho = rho;
}

static void hdi_cocr_step(hdi_krylov *k) {
    const int32_t n = k->a.lap->n_active;
    hd_c64 *p = k->v[0], *q = k->v[1], *z = k->v[2], *az = k->v[3], *mq = k->v[4], alpha, rho;
    int32_t i;
    if (!k->ready) {
        hdi_krylov_precond(k, k->r, z);
        k->rho = hdi_system_apply(&k->a, z, az);
        memcpy(p, z, HDI_CAST(size_t, n) * sizeof *p);
        memcpy(q, az, HDI_CAST(size_t, n) * sizeof *q);
    }
    hdi_krylov_precond(k, q, mq);
    alpha = hdi_krylov_quotient(k, k->rho, hdi_cdotu(q, mq, n));
    if (k->broken) return;
    k->r_norm = hdi_krylov_step(k, alpha, p, q);
    for (i = 0; i < n; i++) z[i] = hdi_csub(z[i], hdi_cmul(alpha, mq[i]));
    rho = hdi_system_apply(&k->a, z, az);
    alpha = hdi_krylov_quotient(k, rho, k->rho);
    hdi_krylov_direction(alpha, z, p, n);
    hdi_krylov_direction(alpha, az, q, n);
    k->rho = rho;
}

/* sqrt of y^* M y for y = M^-1 w, by w^* y; M is real and positive definite. */
static double hdi_minres_beta(hdi_krylov *k, const hd_c64 *w, const hd_c64 *y) {
    const int32_t n = k->a.lap->n_active;
    double s = 0;
    int32_t i;
    for (i = 0; i < n; i++) s += w[i].re * y[i].re + w[i].im * y[i].im;
    if (!(s >= 0)) k->broken = 1;
    return s > 0 ? sqrt(s) : 0;
}

/* The Saunders process A conj(V_k) = V_(k+1) T_k, with unitary V (in the M geometry) and a complex-symmetric tridiagonal T whose
 * off-diagonals are real, and the QR factorisation of T by rotations [c s; -conj(s) c]. */
static void hdi_minres_step(hdi_krylov *k) {
    const int32_t n = k->a.lap->n_active;
    hd_c64 *w_old = k->v[0], *w = k->v[1], *y = k->v[2], *d = k->v[3], *d_old = k->v[4], *v = k->v[5];
    hd_c64 alpha, eps, dbar, delta, gbar, gamma, phi, s;
    double beta, size, c;
    int32_t i;
    if (!k->ready) {
        memcpy(w, k->r, HDI_CAST(size_t, n) * sizeof *w);
        hdi_krylov_precond(k, w, y);
        k->beta = hdi_minres_beta(k, w, y);
        k->beta_old = 1;
        k->phibar = hdi_c(k->beta, 0);
        k->c1 = k->c2 = 1;
        k->s1 = k->s2 = hdi_c(0, 0);
        for (i = 0; i < n; i++) w_old[i] = d[i] = d_old[i] = hdi_c(0, 0);
        if (k->beta == 0) k->broken = 1;
    }
    if (k->broken) return;
    beta = k->beta;
    for (i = 0; i < n; i++) v[i] = hdi_cscale(1 / beta, hdi_cconj(y[i]));
    alpha = hdi_system_apply(&k->a, v, y);
    for (i = 0; i < n; i++) {                    /* w_old becomes the new w */
        const hd_c64 u = hdi_csub(y[i], hdi_cscale(beta / k->beta_old, w_old[i]));
        w_old[i] = hdi_csub(u, hdi_cscale(1 / beta, hdi_cmul(alpha, w[i])));
    }
    k->v[0] = w;
    k->v[1] = w_old;
    hdi_krylov_precond(k, w_old, y);
    k->beta_old = beta;
    k->beta = hdi_minres_beta(k, w_old, y);
    /* column of T: (eps) (delta) gamma below the two old rotations */
    eps = hdi_cscale(beta, k->s2);
    dbar = hdi_c(k->c2 * beta, 0);
    if (!k->ready) eps = dbar = hdi_c(0, 0);
    delta = hdi_cadd(hdi_cscale(k->c1, dbar), hdi_cmul(k->s1, alpha));
    gbar = hdi_csub(hdi_cscale(k->c1, alpha), hdi_cmul(hdi_cconj(k->s1), dbar));
    size = hypot(hdi_cabs(gbar), k->beta);
    if (size == 0) {
        k->broken = 1;
        return;
    }
    c = hdi_cabs(gbar) / size;
    gamma = hdi_cabs(gbar) > 0 ? hdi_cscale(size / hdi_cabs(gbar), gbar) : hdi_c(size, 0);
    s = hdi_cscale(k->beta / (size * size), gamma);
    phi = hdi_cscale(c, k->phibar);
    k->phibar = hdi_cscale(-1, hdi_cmul(hdi_cconj(s), k->phibar));
    for (i = 0; i < n; i++) {
        const hd_c64 u = hdi_csub(hdi_csub(v[i], hdi_cmul(delta, d[i])), hdi_cmul(eps, d_old[i]));
        d_old[i] = hdi_cdiv(u, gamma);
        k->x[i] = hdi_cadd(k->x[i], hdi_cmul(phi, d_old[i]));
    }
    k->v[3] = d_old;
    k->v[4] = d;
    phi = hdi_cscale(k->beta > 0 ? c / k->beta : 0, k->phibar);
    for (i = 0; i < n; i++) k->r[i] = hdi_cadd(hdi_cscale(hdi_cabs2(s), k->r[i]), hdi_cmul(phi, w_old[i]));
    k->r_norm = sqrt(hdi_cnorm2w(k->r, k->weight, n));
    k->c2 = k->c1;
    k->s2 = k->s1;
    k->c1 = c;
    k->s1 = s;
}

/* From x = 0. b_norm: what the residual is reported against. */
static void hdi_krylov_start(hdi_krylov *k, const hd_c64 *b, double b_norm) {
    const size_t bytes = HDI_CAST(size_t, k->a.lap->n_active) * sizeof *k->x;
    memset(k->x, 0, bytes);
    memcpy(k->r, b, bytes);
    k->r_norm = sqrt(hdi_cnorm2w(b, k->weight, k->a.lap->n_active));
    k->b_norm = b_norm;
    k->iterations = 0;
    k->broken = k->ready = 0;
}

/* What a solver is told and tells while it runs. */
typedef struct hdi_watch {
    hd_context *ctx;             /* for progress; NULL: not the calling thread */
    int32_t *stop;               /* set by any thread that failed, read by all */
    double from, share;          /* of the progress bar */
    const char *stage;
} hdi_watch;

static hd_status hdi_watch_look(const hdi_watch *w, double done, hd_error *e) {
    if (w->stop && HDI_LOAD(w->stop)) return hdi_fail(e, HD_ERR_CANCELLED, "stopped because another task failed or was cancelled");
    if (!w->ctx) return HD_OK;
    return hdi_progress(w->ctx, w->stage, w->from + w->share * hdi_min(1, hdi_max(0, done)), e);
}

static double hdi_krylov_done(double start, double now, double target) {
    if (!(now > target) || !(start > target)) return 1;
    return target > 0 ? log(start / now) / log(start / target) : 0;
}

/* Iterates until the residual norm by the recurrence is at most target, or gains nothing more. Near rounding it ends at floor_share of what that may
 * contribute: below, recurrences go astray. left: steps allowed, counted down. */
static hd_status hdi_krylov_round(hdi_krylov *k, double target, double floor_share, double start, int64_t *left, const hdi_watch *watch, hd_error *e) {
    double best = k->r_norm, least = target;
    int64_t step, best_step = 0;
    int near_rounding = 0;
    for (step = 1; k->r_norm > least && !k->broken && *left > 0; step++, --*left) {
        if (!near_rounding && k->r_norm < 1e-9 * k->b_norm) {
            near_rounding = 1;
            least = hdi_max(target, floor_share * hdi_krylov_noise(k));
        }
        if (step % 16 == 1 && hdi_watch_look(watch, hdi_krylov_done(start, k->r_norm, target), e) < 0) return e->status;
        if (k->solver == HD_SOLVER_COCG) hdi_cocg_step(k);
        else if (k->solver == HD_SOLVER_COCR) hdi_cocr_step(k);
        else hdi_minres_step(k);
        if (!hdi_finite(k->r_norm)) k->broken = 1;
        k->ready = 1;
        k->iterations += !k->broken;
        if (k->r_norm < best / 2) {
            best = k->r_norm;
            best_step = step;
        } else if (best < 1e-7 * k->b_norm && (step - best_step > 50 + best_step || k->r_norm > 1e3 * best)) {
            break;
        }
    }
    return HD_OK;
}

/* Solves until the residual norm, computed from x, is at most target. Rounding may keep it above: then it stops where another round no longer
 * halves it, with the best x and HD_WARN_ACCURACY. */
static hd_status hdi_krylov_run(hdi_krylov *k, const hd_c64 *b, double target, int64_t max_iterations, const hdi_watch *watch, hd_error *e) {
    const size_t bytes = HDI_CAST(size_t, k->a.lap->n_active) * sizeof *k->x;
    const double start = k->r_norm;
    double before = k->r_norm, floor_share = 0.5;
    int64_t left = max_iterations;
    while (k->r_norm > target) {
        memcpy(k->spare, k->x, bytes);
        if (hdi_krylov_round(k, target, floor_share, start, &left, watch, e) < 0) return e->status;
        hdi_krylov_residual(k, b);               /* the recurrence says done: believe x alone */
        if (k->r_norm <= target) return HD_OK;
        if (left <= 0) return hdi_fail(e, HD_ERR_NOT_CONVERGED, "the iteration did not reach the tolerance in max_iterations steps");
        if (!(k->r_norm <= before / 2)) {
            if (!(k->r_norm <= before)) {
                memcpy(k->x, k->spare, bytes);
                hdi_krylov_residual(k, b);
            }
            if (k->r_norm <= 1e-7 * k->b_norm) return HD_WARN_ACCURACY;
            return hdi_fail(e, HD_ERR_BREAKDOWN, "the iteration broke down: no step brings the residual down");
        }
        before = k->r_norm;
        floor_share /= 4;
        k->broken = 0;
    }
    return HD_OK;
}

/* ---- conjugate gradients for B u = w, with the diagonal as preconditioner ---- */

/* Condition of diag(B)^-1 B is at most 4 for linear elements: about 30 steps to rounding. work [3 n]. u is the start too when warm. */
static hd_status hdi_mass_solve(const hd_laplacian *lap, const double *w, double *u, double *work, hd_error *e) {
    const int32_t n = lap->n_active;
    double *r = work, *p = work + n, *q = work + 2 * HDI_CAST(int64_t, n), rho = 0, rho_new, start;
    int32_t i, step;
    if (!lap->B) {
        for (i = 0; i < n; i++) u[i] = w[i] / lap->mass[i];
        return HD_OK;
    }
    for (i = 0; i < n; i++) {
        u[i] = 0;
        r[i] = w[i];
        p[i] = w[i] / lap->b_diag[i];
        rho += r[i] * p[i];
    }
    start = rho;
    for (step = 0; step < 1000 && rho > 1e-30 * start; step++) {
        double alpha, mu;
        hdi_pair_apply(lap, 0, 1, p, q);
        mu = hdi_dot(p, q, n);
        if (!(mu > 0)) return hdi_fail(e, HD_ERR_NOT_POSITIVE, "B is not positive definite: a vector with x'Bx <= 0 was met");
        alpha = rho / mu;
        rho_new = 0;
        for (i = 0; i < n; i++) {
            u[i] += alpha * p[i];
            r[i] -= alpha * q[i];
            rho_new += r[i] * (r[i] / lap->b_diag[i]);
        }
        for (i = 0; i < n; i++) p[i] = r[i] / lap->b_diag[i] + rho_new / rho * p[i];
        rho = rho_new;
    }
    if (rho > 1e-24 * start) return hdi_fail(e, HD_ERR_NOT_CONVERGED, "conjugate gradients on B did not converge");
    return HD_OK;
}

/* ==== [16] rational ====
 * Pole sets: the constants, evaluation, lookup. May call [02].
 * This work is based on
 *   W. Cody, G. Meinardus, R. Varga, Chebyshev rational approximations to e^-x in [0, inf), 1969
 *   A. Carpenter, A. Ruttan, R. Varga, Extended numerical computations on the "1/9" conjecture, 1984 (the errors, to many digits)
 * The table is printed by tools/poles.py, which also checks it. Deviation: the paper takes coefficients from E. Gallopoulos and Y. Saad,
 * Efficient solution of parabolic equations by Krylov approximation methods, 1992, whose order-14 table is wrong in its last digits. */

/* poles.py: begin */
/* Computed by tools/poles.py, which also checks these digits. For every set: a0, max |e|, max (1 + |x|)|e| (0 for
 * uniform sets, where it is infinite); then per pole Re theta, Im theta, Re a, Im a, the real pole first (odd r),
 * then one of each conjugate pair by ascending Im theta. */
static const double hdi_rat_table[] = {
    /* uniform r = 1 */
    -0.066831042161850457, 0.066831042161850457, 0,
    0.57899948579809069, 0, -0.65638976389221459, 0,
    /* uniform r = 2 */
    0.0073586701695805296, 0.0073586701695805296, 0,
    0.58479863263849063, 1.1855377812415786, 0.16885872734712942, -0.80945019772077931,
    /* uniform r = 3 */
    -0.00079938063633568784, 0.00079938063633568784, 0,
    1.3688493230338539, 0, -1.4838485523029699, 0,
    0.1982084787507408, 2.4107321029593383, 0.69116392297431128, 0.043182218073431144,
    /* uniform r = 4 */
    8.6522406952888525e-05, 8.6522406952888525e-05, 0,
    1.5483932232971223, 1.1918229466274257, -0.061686779567832924, -1.9050409793030814,
    -0.36784538618153984, 3.6581212986786671, 0.073395957163942205, 0.44999992247406273,
    /* uniform r = 5 */
    -9.3457131530266459e-06, 9.3457131530266459e-06, 0,
    2.1554154620085582, 0, -3.2718193944526841, 0,
    1.4405959942514726, 2.3969835252938436, 1.872385779133247, -0.37820630682407314,
    -1.039505662793798, 4.9213907336950271, -0.23878868408807533, 0.1037386723036791,
    /* uniform r = 6 */
    1.0084543748996708e-06, 1.0084543748996708e-06, 0,
    2.4006027476632035, 1.1931292641501556, -0.5790130101295049, -4.2868875753470874,
    1.1585523628230172, 3.6147724480383845, 0.66300688564711041, 1.4514124962062376,
    -1.7819885196256904, 6.1965120962654252, -0.083581626491457076, -0.1064292055299528,
    /* uniform r = 7 */
    -1.0874974913752479e-07, 1.0874974913752479e-07, 0,
    2.9410969231931401, 0, -7.1876259359111989, 0,
    2.4231963513685186, 2.3930293109369369, 4.4566693870505469, -1.5604498955857686,
    0.75760863371246978, 4.8436185091371495, -0.90260521366982582, 0.74003615604162754,
    -2.575726086391994, 7.4809774314099506, 0.039680465809293214, -0.052477616257074373,
    /* uniform r = 8 */
    1.1722652116334906e-08, 1.1722652116334906e-08, 0,
    3.2209452399451135, 1.193619604620652, -1.8317717057715204, -9.5256080740643352,
    2.292249142304867, 3.6007714934833812, 2.4362407257817651, 3.7167556135083242,
    0.26949098091275148, 6.0820325874935435, -0.63258805131157436, -0.44392309694789683,
    -3.4085395096636528, 8.7730345535790395, 0.028129757023298989, 0.011577384208923706,
    /* uniform r = 9 */
    -1.2632924833223142e-09, 1.2632924833223142e-09, 0,
    3.7264404432550844, 0, -15.772898239504569, 0,
    3.319683616428744, 2.391341566842359, 10.197195761527098, -4.5617679367058406,
    2.0477955245274946, 4.8162322656968408, -2.463888128203831, 2.7896859476773539,
    -0.2857163595193854, 7.328757959381476, 0.15496216680440175, -0.44758718068124026,
    -4.2722773396054796, 10.071413406121069, -0.001822294456751083, 0.013400277260199545,
    /* uniform r = 10 */
    1.3611205233454478e-10, 1.3611205233454478e-10, 0,
    4.0277324675187485, 1.1938560664553324, -4.8183819908450349, -21.054597238399712,
    3.2837528832313008, 3.5943867723559029, 7.1171651040990547, 8.819533157873197,
    1.7154060157689568, 6.0389349254839191, -2.5655849548411278, -1.216385706120203,
    -0.89440470160948071, 8.582756898613388, 0.27258698029640305, 0.014211727031631144,
    -5.1611912720200763, 11.375156251916541, -0.0057849038580128857, 0.00068585070894470123,
    /* uniform r = 11 */
    -1.466311194937487e-11, 1.466311194937487e-11, 0,
    4.5116223104974447, 0, -34.597639064522525, 0,
    4.1765093418863453, 2.3904652786364111, 22.940708037241691, -11.849855003577504,
    3.1429903144926743, 4.8030732473603912, -5.9835669564958307, 8.464457243990104,
    1.3125381205883064, 7.2683188400373346, 0.30851281175845968, -1.9833753212408136,
    -1.5468803139623493, 9.8431732969045136, 0.034047278889549823, 0.14565219397515317,
    -6.07106100332373, 12.683520454768697, -0.00088167237609111193, -0.0022803681114908587,
    /* uniform r = 12 */
    1.5794568370512388e-12, 1.5794568370512388e-12, 0,
    4.8274934521610646, 1.1939879912230829, -11.799379956012233, -46.411635333526789,
    4.2061242043183009, 3.5909207588846161, 18.785977421525416, 20.237285126063455,
    2.9178685450793056, 6.0173459240923721, -8.2382559342348074, -2.7961912623038074,
    0.85170709671550171, 8.5038328256346354, 1.3194115340711865, -0.18352358287334647,
    -2.2359682461306796, 11.109296232702841, -0.068571494249760098, 0.038419082886648047,
    -6.9986879086036167, 13.995916624970729, 0.00081843349926244424, -0.00058135358242612139,
    /* uniform r = 13 */
    -1.701187076340353e-13, 1.701187076340353e-13, 0,
    5.2967144802299906, 0, -75.873006181213668, 0,
    5.0116980787831418, 2.3899519823816431, 51.163592836068737, -29.08335883143636,
    4.1395468351420019, 4.795667068660693, -13.766087342116609, 23.108957560381263,
    2.6231285284511738, 7.2369922995548599, 0.21557854180001412, -6.7885062085917687,
    0.34222764042845077, 9.7449668797523543, 0.3514391652167202, 0.76099293791750688,
    -2.9561938216958206, 12.3805302110159, -0.028327816379376824, -0.028043097521075505,
    -7.941584223750314, 15.311867991179952, 0.00030770539329353248, 0.00026269393788859625,
    /* uniform r = 14 */
    1.8321743782540412e-14, 1.8321743782540412e-14, 0,
    5.6231425727459774, 1.1940690463439669, -27.875161940145645, -102.14733999056452,
    5.0893450605806247, 3.5888240290270064, 46.933274488831294, 45.643649768827764,
    3.9933697105785684, 6.004831642235037, -23.498232091082702, -5.8083591297142076,
    2.2697838292311125, 8.461737973040222, 4.8071120988325085, -1.3209793837428725,
    -0.20875863825013014, 10.99126056190126, -0.3763600387822697, 0.33518347029450102,
    -3.7032750494234481, 13.656371871483268, 0.0094390253107361696, -0.017184791958483017,
    -8.8977731864688892, 16.630982619902085, -7.1542880635890667e-05, 0.000143610433495413,
    /* kernel r = 2 */
    0, 0.051108697372623239, 0.063980688685425308,
    0.16320527768573678, 0.87733679087466765, 0.031990344342712654, -0.45979936196783966,
    /* kernel r = 3 */
    0, 0.00745906676988528, 0.0088183221102323874,
    0.8798015821197086, 0, -0.73534036524477964, 0,
    -0.33721344119511504, 1.9541487926740835, 0.36326102156727363, -0.10252518797876559,
    /* kernel r = 4 */
    0, 0.0010120856976999712, 0.0011532131178395126,
    1.0012360323169205, 1.0127617101099595, -0.13761671564544589, -0.95434825302787096,
    -0.97286730739639971, 3.1161187929322116, 0.13819332220436564, 0.19529624922132863,
    /* kernel r = 5 */
    0, 0.00013078245680312435, 0.00014551067979511832,
    1.5806093311274052, 0, -1.6122437160843628, 0,
    0.843553972886251, 2.1013943510247364, 0.88359375622762082, -0.3972530923862384,
    -1.6952612176103943, 4.3211502060056315, -0.077544653525337001, 0.10643877122683623,
    /* kernel r = 6 */
    0, 1.638314696524711e-05, 1.7924880198471096e-05,
    1.7945759395664347, 1.0668585076598631, -0.47709182719857313, -2.0765388880040847,
    0.52082001907831077, 3.2368346334064566, 0.54011018294395463, 0.58917410821405081,
    -2.4764673804111004, 5.5538270612585094, -0.063009393305282255, -0.020796603152995204,
    /* kernel r = 7 */
    0, 2.007830442073598e-06, 2.1697492625409359e-06,
    2.3180179159733298, 0, -3.4984001114290937, 0,
    1.7872478061237842, 2.1731406610644242, 2.0241255609443409, -1.1357867052202091,
    0.086340585596481098, 4.4039484306993435, -0.275547357094857, 0.50411746985771744,
    -3.3010696378106434, 6.8056689480255645, 0.00062076699043166618, -0.031415613930841656,
    /* kernel r = 8 */
    0, 2.4209559291471657e-07, 2.5914832316995525e-07,
    2.5778411129104528, 1.0959438169159568, -1.2402897408000026, -4.535665340747884,
    1.6292171157213193, 3.3086435834880898, 1.5945552799403819, 1.4693800628500309,
    -0.42983460476831181, 5.5940888506046926, -0.36795890305394635, -0.064109325493075353,
    -4.1592354424518296, 8.0717415744368086, 0.013693493487728595, -0.0037850242658920568,
    /* kernel r = 9 */
    0, 2.8825963558001348e-08, 3.0626155801710728e-08,
    3.0713450226657519, 0, -7.5893629384965875, 0,
    2.6562121325966497, 2.2160275244154701, 4.5534535733548021, -2.8906843944388783,
    1.3606863883385651, 4.4665319611831311, -0.72817698410138931, 1.6425105098106356,
    -1.0088910545423591, 6.8018482204817037, -0.033839861426141794, -0.22239372477279631,
    -5.0442868895785287, 9.3488471465502485, 0.0032447261079453621, 0.0052781650662087473,
    /* kernel r = 10 */
    0, 3.3980492073661269e-09, 3.5884693817965778e-09,
    3.3584002402004272, 1.1141516278605672, -2.9677205307755861, -9.91052365991907,
    2.6007667800133114, 3.3559120538410001, 4.20480425256613, 3.4491641122160686,
    1.0069637754111034, 5.6421429560295602, -1.3490724118382724, -0.11632133222631107,
    -1.6381413993361127, 8.0236147586366826, 0.11376754023753484, -0.057681865180030337,
    -5.9514487693418872, 10.634797950299786, -0.001778848395571201, 0.0019297581104926614,
    /* kernel r = 11 */
    0, 3.9730696947998664e-10, 4.1748342453909563e-10,
    3.8332183712946759, 0, -16.481507483830317, 0,
    3.4922192648607329, 2.2446054795526318, 10.153504941666789, -6.9635953747327139,
    2.4418021196743629, 4.5121760948739746, -1.730833523918363, 4.621644764708309,
    0.58514520103460266, 6.832187993893176, -0.22948944346560068, -0.91711736213774675,
    -2.3085659875823956, 9.2568448861169603, 0.048536753145843402, 0.048861184803813074,
    -6.8771737021020174, 11.928023400569286, -0.00096498572225115387, -0.00049687257940143144,
    /* kernel r = 12 */
    0, 4.6139281299509227e-11, 4.8280233496799053e-11,
    4.1382945420084258, 1.1266387346355662, -6.8546772558004792, -21.655019778353157,
    3.5069928511369963, 3.3893169577755753, 10.45426176342802, 7.8859541106539766,
    2.1999034387642564, 5.6821853529458179, -4.1035264683107693, -0.10172864885451351,
    0.10739752362683333, 8.0342672070492611, 0.52037335075659918, -0.33671566992549118,
    -3.0134905313773017, 10.49967209249359, -0.016523575004090227, 0.031651031786665867,
    -7.8187452945066056, 13.22735490579292, 9.218495485902652e-05, -0.00043011639656504916,
    /* kernel r = 13 */
    0, 5.3274682645140082e-12, 5.5549314504561607e-12,
    4.6003186239560838, 0, -35.832702967153821, 0,
    4.3109379106874526, 2.2650278330294737, 22.524786855717082, -16.280365555487887,
    3.4261195237858839, 4.5464533066236994, -3.9237379660439289, 12.051278497946296,
    1.8897702502524776, 6.8639047258691539, -0.96932272715987244, -3.0226093342264937,
    -0.41726813627308068, 9.2465740514728552, 0.30205114620199147, 0.23951267078582653,
    -3.7478189492516516, 11.750680664732304, -0.017600832317060167, -0.0031747712607510634,
    -8.7740317501807983, 14.531897139913655, 0.00017500717591853763, -8.5810658868229069e-06,
    /* kernel r = 14 */
    0, 6.1211671246271845e-13, 6.3630943624031441e-13,
    4.9181935097255458, 1.1357420011221835, -15.547814833333383, -47.319463172876425,
    4.3768473690907914, 3.4141584431277341, 25.103289328651723, 17.784530104821886,
    3.2663886298189055, 5.7144627312626648, -11.320276072648364, 0.24037867645161715,
    1.5223129087577738, 8.0557414538243783, 1.843962196246469, -1.387416066359866,
    -0.98196506093423674, 10.467711454192054, -0.078142978167783206, 0.21550257610584828,
    -4.5075605895604021, 13.008767567859003, -0.0010383125651999775, -0.0086362070804686056,
    -9.7413256359447953, 15.840947521360885, 2.0671816855185641e-05, 6.5573823084788806e-05,
};
/* poles.py: end */

enum { HDI_RAT_UNIFORM_MAX = 14, HDI_RAT_KERNEL_MIN = 2, HDI_RAT_KERNEL_MAX = 14 };

static int32_t hdi_rat_size(int32_t degree) { return 3 + 4 * ((degree + 1) / 2); }

static hd_status hdi_rational_get(hd_rational *out, hd_pole_kind kind, int32_t degree, hd_error *e) {
    const double *row = hdi_rat_table;
    int32_t r, i;
    if (kind != HD_POLES_UNIFORM && kind != HD_POLES_KERNEL) return hdi_fail(e, HD_ERR_ARGUMENT, "pole set: the kind is uniform or kernel");
    if (kind == HD_POLES_UNIFORM && (degree < 1 || degree > HDI_RAT_UNIFORM_MAX))
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "pole set: uniform sets have degrees 1 to 14", -1, -1, degree);
    if (kind == HD_POLES_KERNEL && (degree < HDI_RAT_KERNEL_MIN || degree > HDI_RAT_KERNEL_MAX))
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "pole set: kernel sets have degrees 2 to 14", -1, -1, degree);
    for (r = 1; r < (kind == HD_POLES_UNIFORM ? degree : HDI_RAT_UNIFORM_MAX + 1); r++) row += hdi_rat_size(r);
    for (r = HDI_RAT_KERNEL_MIN; kind == HD_POLES_KERNEL && r < degree; r++) row += hdi_rat_size(r);
    memset(out, 0, sizeof *out);
    out->kind = kind;
    out->degree = degree;
    out->n_poles = (degree + 1) / 2;
    out->a0 = row[0];
    /* The table's errors are the exact optimum; its numbers, rounded to double, lose up to 7 % of that at degree 14, and the sum of
     * a dozen terms of size 1e4 some more. */
    out->max_error = 1.1 * row[1] + 1e-14;
    out->max_weighted_error = row[2] > 0 ? 1.1 * row[2] + 1e-14 : 0;
    for (i = 0; i < out->n_poles; i++) {
        out->theta[i] = hdi_c(row[3 + 4 * i], row[4 + 4 * i]);
        out->a[i] = hdi_c(row[5 + 4 * i], row[6 + 4 * i]);
    }
    return HD_OK;
}

/* 1 for a real pole, 2 for a pair. */
static double hdi_rat_count(const hd_rational *set, int32_t i) { return set->theta[i].im == 0 ? 1 : 2; }

static double hdi_rational_eval(const hd_rational *set, double x) {
    double sum = set->a0;
    int32_t i;
    for (i = 0; i < set->n_poles; i++)
        sum += hdi_rat_count(set, i) * hdi_cdiv(set->a[i], hdi_csub(hdi_c(x, 0), set->theta[i])).re;
    return sum;
}

static hd_status hdi_rational_check(const hd_rational *set, hd_error *e) {
    int32_t i;
    if (set->n_poles < 0 || set->n_poles > HD_MAX_POLES) return hdi_fail(e, HD_ERR_ARGUMENT, "own pole set: n_poles is not in 0..HD_MAX_POLES");
    if (!hdi_finite(set->a0) || !(set->max_error >= 0) || !(set->max_weighted_error >= 0))
        return hdi_fail(e, HD_ERR_NOT_FINITE, "own pole set: a0 is not finite or an error negative");
    for (i = 0; i < set->n_poles; i++) {
        const int bad = !hdi_cfinite(set->theta[i]) || !hdi_cfinite(set->a[i]);
        const char *text = bad ? "own pole set: a pole or weight is not finite" : "own pole set: theta needs Im > 0, or Im = 0 and Re > 0";
        if (!bad && (set->theta[i].im > 0 || (set->theta[i].im == 0 && set->theta[i].re > 0))) continue;
        hdi_fail(e, bad ? HD_ERR_NOT_FINITE : HD_ERR_ARGUMENT, text);
        e->pole = i;
        return e->status;
    }
    return HD_OK;
}

/* min |x - theta| over x <= 0, i.e. min |t lambda + theta|: how far A stays from singular, in the B geometry. */
static double hdi_pole_distance(hd_c64 theta) { return theta.re >= 0 ? hdi_cabs(theta) : fabs(theta.im); }

/* ==== [17] shifted ====
 * The family t L + theta_i B over the poles of a set, for one right-hand side: solutions, their weighted sum, and what it can be off by.
 * May call [15] and [16].
 * One right-hand side goes through its poles one after the other, since what is solved already is a good start for the next: with
 * A_p = A_q + (theta_p - theta_q) B,  A_p sum c_q x_q = (sum c_q) b + B sum c_q (theta_p - theta_q) x_q,  and for sum c_q = 1 the residual is a
 * combination that least squares make small. The conjugate of a solution is that of the conjugate pole, and counts as another one.
 * Parallel tasks are right-hand sides, and preconditioners. */

/* What is shared by all right-hand sides: the pair, and preconditioners for a set and a time. */
typedef struct hdi_family {
    hd_context *ctx;
    const hd_laplacian *lap;
    const hdi_upper *up;
    const double *weight;        /* [n] 1/diag(B) */
    hd_solver solver;
    hd_precond precond;
    int64_t max_iterations;
    hd_rational set;
    double t;
    int32_t filled;              /* the preconditioners are those of set and t */
    int32_t n_values;            /* poles that values has room for */
    hdi_precond m[HD_MAX_POLES];
    hd_c64 *values;
} hdi_family;

static void hdi_family_free(hdi_family *fam) {
    hdi_free(fam->ctx, fam->values);
    fam->values = NULL;
    fam->n_values = 0;
    fam->filled = 0;
}

/* Takes up a set and a time, with room for the preconditioners. hdi_family_fill is to follow when filled is 0. */
static hd_status hdi_family_set(hdi_family *fam, const hd_rational *set, double t, hd_error *e) {
    const size_t n = HDI_CAST(size_t, fam->lap->n_active), upper = HDI_CAST(size_t, fam->up->ptr[n]);
    const size_t size = fam->precond == HD_PRECOND_NONE ? 0 : fam->precond == HD_PRECOND_JACOBI ? n : n + upper;
    int32_t i;
    if (fam->filled && fam->t == t && memcmp(&fam->set, set, sizeof *set) == 0) return HD_OK;
    fam->filled = 0;
    if (fam->n_values < set->n_poles) {
        hdi_family_free(fam);
        fam->values = HDI_CAST(hd_c64 *, hdi_alloc(fam->ctx, HDI_CAST(size_t, set->n_poles), (size + 1) * sizeof(hd_c64), e));
        if (!fam->values) return e->status;
        fam->n_values = set->n_poles;
    }
    fam->set = *set;
    fam->t = t;
    for (i = 0; i < set->n_poles; i++) {
        fam->m[i].kind = fam->precond;
        fam->m[i].up = fam->up;
        fam->m[i].d_inv = size ? fam->values + HDI_CAST(size_t, i) * (size + 1) : NULL;
        fam->m[i].u = size > n ? fam->m[i].d_inv + n : NULL;
    }
    return HD_OK;
}

typedef struct hdi_fill_job {
    hdi_family *fam;
    hd_c64 *work;
    size_t stride;               /* of work from pole to pole, at least 2 n */
} hdi_fill_job;

static void hdi_fill_task(void *arg, int64_t index, int32_t worker) {
    hdi_fill_job *job = HDI_CAST(hdi_fill_job *, arg);
    hd_c64 *work = job->work + job->stride * HDI_CAST(size_t, index);
    hdi_system a;
    (void)worker;
    a.lap = job->fam->lap;
    a.t = job->fam->t;
    a.theta = job->fam->set.theta[index];
    if (job->fam->solver == HD_SOLVER_MINRES) a.theta = hdi_c(hdi_cabs(a.theta), 0);   /* real, positive definite */
    hdi_precond_make(job->fam->m + index, &a, work, HDI_CAST(int64_t *, HDI_CAST(void *, work + job->fam->lap->n_active)));
}

/* Makes the preconditioners, one parallel task each. */
static hd_status hdi_family_fill(hdi_family *fam, hd_c64 *work, size_t stride, hd_error *e) {
    hdi_fill_job job;
    if (fam->filled) return HD_OK;
    if (hdi_progress(fam->ctx, "precondition", 0, e) < 0) return e->status;
    job.fam = fam;
    job.work = work;
    job.stride = stride;
    hdi_parallel(fam->ctx, fam->set.n_poles, hdi_fill_task, &job);
    fam->filled = 1;
    return HD_OK;
}

/* Right-hand sides at a time. */
enum { HDI_LANES = 4 };

enum { HDI_LANCZOS_MAX = 4096 };

/* The state of a Lanczos process in the B inner product. */
typedef struct hdi_lanczos {
    double *v, *c, *c_old;                /* [n] v_m, B v_m, B v_(m-1) */
    double *alpha, *beta;                 /* [MAX + 1] T: diagonal, and beta[j] between j - 1 and j */
    double *d, *e, *z0, *z1, *y;          /* [MAX + 1] */
    hd_c64 *work;                         /* [2 MAX] */
    int32_t m;
} hdi_lanczos;

/* One right-hand side under way. Arrays are [n] rows unless said otherwise. */
typedef struct hdi_lane {
    double *f, *rhs, *u;         /* the field, B f, the answer */
    double *tmp;                 /* [4 n] */
    double *target, *sums;       /* [n_components] heat per component, work */
    hd_c64 *b, *vectors;
    hdi_krylov k[HD_MAX_POLES];
    hdi_lanczos lanczos;
    int32_t n_systems, skip;
    /* outcome, norms absolute */
    double f_norm, u_norm;
    double rational, solver;     /* bounds in the B norm */
    double residual;
    int64_t steps;               /* of Lanczos */
    hd_status status;
    hd_error error;
} hdi_lane;

static void hdi_lane_free(hdi_lane *lane, hd_context *ctx) {
    hdi_free(ctx, lane->f);
    hdi_free(ctx, lane->target);
    hdi_free(ctx, lane->b);
    hdi_free(ctx, lane->vectors);
    hdi_free(ctx, lane->lanczos.v);
    hdi_free(ctx, lane->lanczos.alpha);
    memset(lane, 0, sizeof *lane);
}

static hd_status hdi_lane_make(hdi_lane *lane, const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    const size_t n = HDI_CAST(size_t, lap->n_active), n_comp = HDI_CAST(size_t, lap->n_components);
    if (lane->f) return HD_OK;
    lane->f = HDI_CAST(double *, hdi_alloc(ctx, 7 * n, sizeof(double), e));
    if (lane->f) lane->target = HDI_CAST(double *, hdi_alloc(ctx, 2 * n_comp, sizeof(double), e));
    if (!lane->target) {
        hdi_lane_free(lane, ctx);
        return e->status;
    }
    lane->rhs = lane->f + n;
    lane->u = lane->rhs + n;
    lane->tmp = lane->u + n;
    lane->sums = lane->target + n_comp;
    return HD_OK;
}

/* Room for Lanczos. */
static hd_status hdi_lane_lanczos(hdi_lane *lane, const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    const size_t n = HDI_CAST(size_t, lap->n_active), most = HDI_LANCZOS_MAX + 1;
    hdi_lanczos *z = &lane->lanczos;
    if (z->alpha) return HD_OK;
    hdi_free(ctx, z->v);
    z->v = HDI_CAST(double *, hdi_alloc(ctx, 3 * n, sizeof(double), e));
    if (z->v) z->alpha = HDI_CAST(double *, hdi_alloc(ctx, 11 * most, sizeof(double), e));
    if (!z->alpha) return e->status;             /* the lane frees what it has */
    z->c = z->v + n;
    z->c_old = z->c + n;
    z->beta = z->alpha + most;
    z->d = z->beta + most;
    z->e = z->d + most;
    z->z0 = z->e + most;
    z->z1 = z->z0 + most;
    z->y = z->z1 + most;
    z->work = HDI_CAST(hd_c64 *, HDI_CAST(void *, z->y + most));
    return HD_OK;
}

/* Complex numbers that a system has in a lane. */
static size_t hdi_lane_stride(const hdi_family *fam) {
    return HDI_CAST(size_t, hdi_krylov_vectors(fam->solver)) * HDI_CAST(size_t, fam->lap->n_active);
}

/* Room for the systems of a set, and their constants. */
static hd_status hdi_lane_systems(hdi_lane *lane, const hdi_family *fam, hd_error *e) {
    const size_t n = HDI_CAST(size_t, fam->lap->n_active), n_comp = HDI_CAST(size_t, fam->lap->n_components);
    const size_t n_vec = HDI_CAST(size_t, hdi_krylov_vectors(fam->solver)), count = HDI_CAST(size_t, fam->set.n_poles);
    size_t i, j;
    if (!lane->vectors || lane->n_systems < fam->set.n_poles) {
        hdi_free(fam->ctx, lane->b);
        hdi_free(fam->ctx, lane->vectors);
        lane->vectors = NULL;
        lane->n_systems = 0;
        lane->b = HDI_CAST(hd_c64 *, hdi_alloc(fam->ctx, 3 * n + n_comp, sizeof(hd_c64), e));
        if (lane->b) lane->vectors = HDI_CAST(hd_c64 *, hdi_alloc(fam->ctx, count, n_vec * n * sizeof(hd_c64), e));
        if (!lane->vectors) return e->status;
        lane->n_systems = fam->set.n_poles;
    }
    for (i = 0; i < count; i++) {
        hdi_krylov *k = lane->k + i;
        hd_c64 *v = lane->vectors + i * n_vec * n;
        memset(k, 0, sizeof *k);
        k->x = v;
        k->r = v + n;
        for (j = 2; j < n_vec; j++) k->v[j - 2] = v + j * n;
        k->v[n_vec - 2] = lane->b + n;           /* a work vector that all systems share, as they run one after the other */
        k->spare = lane->b + 2 * n;
        k->sums = lane->b + 3 * n;
        k->a.lap = fam->lap;
        k->a.t = fam->t;
        k->a.theta = fam->set.theta[i];
        k->solver = fam->solver;
        k->weight = fam->weight;
        k->m = fam->m[i];
    }
    return HD_OK;
}

/* Bound of |x_i - exact|_B by the residual: |A^-1 r|_B <= |r|_(B^-1) / min |t lambda + theta|, and |r|_(B^-1)^2 <= |r|_(D^-1)^2 / b_ratio. */
static double hdi_pole_error(const hdi_krylov *k) {
    return k->r_norm / (sqrt(k->a.lap->b_ratio) * hdi_pole_distance(k->a.theta));
}

/* What an error of x_p does to the answer at most. */
static double hdi_pole_weight(const hdi_family *fam, int32_t p) { return hdi_rat_count(&fam->set, p) * hdi_cabs(fam->set.a[p]); }

/* u = a0 f - sum a_i x_i, in the order of the poles. Returns the bound of the solvers' part in the B norm. */
static double hdi_lane_sum(hdi_lane *lane, const hdi_family *fam) {
    const int32_t n = fam->lap->n_active;
    double error = 0, *HDI_RESTRICT u = lane->u;
    int32_t i, j;
    for (j = 0; j < n; j++) u[j] = fam->set.a0 * lane->f[j];
    for (i = 0; i < fam->set.n_poles; i++) {
        const hd_c64 *HDI_RESTRICT x = lane->k[i].x;
        const double c = hdi_rat_count(&fam->set, i), are = c * fam->set.a[i].re, aim = c * fam->set.a[i].im;
        for (j = 0; j < n; j++) u[j] -= are * x[j].re - aim * x[j].im;
        error += hdi_pole_weight(fam, i) * hdi_pole_error(lane->k + i);
    }
    return error;
}

enum { HDI_WARM_POLES = 6, HDI_WARM_MAX = 2 * HDI_WARM_POLES };

/* Inner products of solution p with those of poles p to last, into gram[q - p][0] = x_q^* D x_p and gram[q - p][1] = x_q' D x_p,
 * D = diag(B). */
static void hdi_warm_products(const hdi_lane *lane, const double *d, int32_t p, int32_t last, int32_t n, hd_c64 gram[][2]) {
    const hd_c64 *HDI_RESTRICT y = lane->k[p].x;
    int32_t q, i;
    for (q = p; q <= last; q++) {
        const hd_c64 *HDI_RESTRICT x = lane->k[q].x;
        double rr = 0, ii = 0, ri = 0, ir = 0;
        for (i = 0; i < n; i++) {
            const double yr = d[i] * y[i].re, yi = d[i] * y[i].im;
            rr += x[i].re * yr;
            ii += x[i].im * yi;
            ri += x[i].re * yi;
            ir += x[i].im * yr;
        }
        gram[q - p][0] = hdi_c(rr + ii, ri - ir);
        gram[q - p][1] = hdi_c(rr - ii, ri + ir);
    }
}

/* Solves the Hermitian h c = 1 (m x m, rows of HDI_WARM_MAX) by L D L^*, in place; a pivot that rounding has eaten ends the set of
 * useful directions: the rest get zero. */
static void hdi_warm_solve(hd_c64 h[][HDI_WARM_MAX], hd_c64 *c, int32_t m) {
    int32_t i, j, k;
    for (i = 0; i < m; i++) {
        const double full = h[i][i].re;
        c[i] = hdi_c(1, 0);
        for (j = 0; j < i; j++) {
            hd_c64 s = h[i][j];
            for (k = 0; k < j; k++) s = hdi_csub(s, hdi_cscale(h[k][k].re, hdi_cmul(h[i][k], hdi_cconj(h[j][k]))));
            h[i][j] = h[j][j].re > 0 ? hdi_cscale(1 / h[j][j].re, s) : hdi_c(0, 0);
            h[i][i].re -= h[j][j].re * hdi_cabs2(h[i][j]);
            c[i] = hdi_csub(c[i], hdi_cmul(h[i][j], c[j]));
        }
        if (h[i][i].re <= 1e-13 * full) h[i][i].re = 0;
    }
    for (i = m; i-- > 0;) {
        c[i] = h[i][i].re > 0 ? hdi_cscale(1 / h[i][i].re, c[i]) : hdi_c(0, 0);
        for (j = i + 1; j < m; j++) {
            if (h[i][i].re > 0) c[i] = hdi_csub(c[i], hdi_cmul(hdi_cconj(h[j][i]), c[j]));
        }
    }
}

/* Start of system p from the solutions of poles p + 1 to last, whose inner products are in gram. A point is a pole or its conjugate. */
static void hdi_warm_start(hdi_lane *lane, const hdi_family *fam, int32_t p, int32_t last, hd_c64 gram[][HDI_WARM_POLES + 1][2]) {
    const int32_t n = fam->lap->n_active;
    hd_c64 h[HDI_WARM_MAX][HDI_WARM_MAX], c[HDI_WARM_MAX], shift[HDI_WARM_MAX], sum = hdi_c(0, 0), *HDI_RESTRICT x = lane->k[p].x;
    int32_t m = 0, i, j, pole[HDI_WARM_MAX], conj[HDI_WARM_MAX];
    for (i = p + 1; i <= last; i++) {
        for (j = 0; j < (fam->set.theta[i].im == 0 ? 1 : 2); j++, m++) {
            pole[m] = i;
            conj[m] = j;
            shift[m] = hdi_csub(fam->set.theta[p], j ? hdi_cconj(fam->set.theta[i]) : fam->set.theta[i]);
        }
    }
    for (i = 0; i < m; i++) {
        for (j = 0; j <= i; j++) {
            const hd_c64 *g = gram[pole[j]][pole[i] - pole[j]];   /* x_i^* D x_j and x_i' D x_j for the poles behind the points */
            hd_c64 v = conj[i] == conj[j] ? g[0] : g[1];
            if (conj[j]) v = hdi_cconj(v);
            h[i][j] = hdi_cmul(hdi_cmul(hdi_cconj(shift[i]), shift[j]), v);
        }
    }
    hdi_warm_solve(h, c, m);
    for (i = 0; i < m; i++) sum = hdi_cadd(sum, c[i]);
    for (i = 0; i < m; i++) {
        const hd_c64 w = hdi_cdiv(c[i], sum), *HDI_RESTRICT y = lane->k[pole[i]].x;
        const double sign = conj[i] ? -1 : 1;
        if (!hdi_cfinite(w)) continue;
        for (j = 0; j < n; j++) x[j] = hdi_cadd(x[j], hdi_cmul(w, hdi_c(y[j].re, sign * y[j].im)));
    }
}

/* Runs the systems until the bound of their part of the answer's error is at most aim: each may use up an equal share of what those before it
 * left over. From where they are, or fresh, each started from those before it; the last pole comes first, which measures best. */
static hd_status hdi_lane_run(hdi_lane *lane, const hdi_family *fam, int fresh, double aim, const hdi_watch *watch, hd_error *e) {
    const int32_t n_poles = fam->set.n_poles;
    const double b_norm = sqrt(hdi_cnorm2w(lane->b, fam->weight, fam->lap->n_active));
    hd_c64 gram[HD_MAX_POLES][HDI_WARM_POLES + 1][2];
    hdi_watch part = *watch;
    hd_status worst = HD_OK, status;
    double left = aim;
    int32_t p;
    part.share = watch->share / n_poles;
    for (p = n_poles; p-- > 0;) {
        hdi_krylov *k = lane->k + p;
        const int32_t last = p + HDI_WARM_POLES < n_poles ? p + HDI_WARM_POLES : n_poles - 1;
        const double weight = hdi_pole_weight(fam, p), fair = hdi_max(left / (p + 1), 0.1 * aim / n_poles);
        const double share = weight > 0 ? fair / weight : DBL_MAX;
        if (fresh) hdi_krylov_start(k, lane->b, b_norm);
        if (fresh && p < last && b_norm > 0) {
            hdi_warm_start(lane, fam, p, last, gram);
            hdi_krylov_residual(k, lane->b);
            if (!(k->r_norm < b_norm)) hdi_krylov_start(k, lane->b, b_norm);
        }
        part.from = watch->from + part.share * (n_poles - 1 - p);
        status = hdi_krylov_run(k, lane->b, share * sqrt(fam->lap->b_ratio) * hdi_pole_distance(fam->set.theta[p]),
                                fam->max_iterations - k->iterations, &part, e);
        if (status < 0) {
            if (status == HD_ERR_NOT_CONVERGED) e->value = k->r_norm / k->b_norm;
            if (status != HD_ERR_CANCELLED) e->pole = p;
            return status;
        }
        if (status > worst) worst = status;
        left -= weight * hdi_pole_error(k);
        if (fresh && p > 0) hdi_warm_products(lane, fam->lap->b_diag, p, last, fam->lap->n_active, gram[p]);
    }
    return worst;
}

/* max (1 + x)^-1 |x + theta| over x >= 0: then |(B + t L)^-1 B f|_B <= this |(t L + theta B)^-1 B f|_B. */
static double hdi_resolvent_ratio(hd_c64 theta) {
    const double x = theta.re < 1 ? theta.im * theta.im / (1 - theta.re) - theta.re : -1;
    const double inside = x > 0 ? hypot(x + theta.re, theta.im) / (1 + x) : 0;
    return hdi_max(inside, hdi_max(1, hdi_cabs(theta)));
}

/* ==== [18] heat ====
 * K_t f for one field: through the poles, or by Lanczos for the exponential; the stopping rule, conservation, and the bound of the error.
 * May call [17].
 * This work is based on
 *   G. Patane, M. Spagnuolo, Heat diffusion kernel and distance on surface meshes and point sets, 2013, eqs. (8), (9)
 *   M. Hochbruck, Ch. Lubich, On Krylov subspace approximations to the matrix exponential operator, 1997 (Lanczos and its error)
 * Deviations: MINRES, which the paper names, is not valid for complex poles (see hd_solver); the constants of each component are carried
 * exactly, so that uniform sets conserve heat too. */

struct hd_heat {
    hd_context *ctx;
    hd_laplacian *lap;           /* the caller's, renumbered, B and with it t multiplied by scale */
    double scale;
    hd_heat_opts opts;           /* resolved */
    hd_rational own_set;
    hdi_upper up;
    double *weight;              /* [n] 1/diag(B) */
    hdi_family fam;              /* of the last set and time */
    hdi_lane lane[HDI_LANES];    /* work arrays, kept from call to call */
    double lambda_max;           /* bound of the largest eigenvalue of B^-1 L */
};

/* Sets the heat of each component to c0 times that of the right-hand side: the constants' part of c(-t B^-1 L) f, exactly. */
static void hdi_conserve(const hd_laplacian *lap, hdi_lane *lane, double c0) {
    int32_t c;
    if (!lap->conserves) return;
    hdi_component_sums(lap, lap->mass, lane->u, lane->sums);
    for (c = 0; c < lap->n_components; c++) lane->sums[c] = (c0 * lane->target[c] - lane->sums[c]) / lap->component_mass[c];
    hdi_component_add(lap, lane->sums, lane->u);
}

/* ---- Lanczos for the exponential ---- */
/* The basis is not kept. A first sweep finds the coefficients, a second one makes the same vectors again, to the last bit, and adds them up: as
 * much work as writing them to fresh memory and reading them back would be, with six vectors in place of hundreds.
 * No reorthogonalisation: the few huge eigenvalues that slivers have come back as copies, which costs a third more steps (bunny, t = 100 h^2: 280
 * where full reorthogonalisation takes 200) and no accuracy. Simon's partial reorthogonalisation saves those steps and takes 2.4 times as long. */

/* t beta_(m+1) |e_m' phi_1(-t T) e_1|, phi_1(z) = (e^z - 1)/z: bounds the error of m steps from a vector of norm one. For the error is
 * beta int_0^t exp(-(t-s) B^-1 L) v_(m+1) e_m' exp(-s T) e_1 ds, the last factor has one sign for all s, and the first shrinks. */
static hd_status hdi_lanczos_bound(hdi_lanczos *z, double t, double *bound, hd_error *e) {
    const int32_t m = z->m;
    double sum = 0;
    int32_t i;
    for (i = 0; i < m; i++) {
        z->d[i] = z->alpha[i];
        z->e[i] = i + 1 < m ? z->beta[i + 1] : 0;
        z->z0[i] = i == 0;
        z->z1[i] = i == m - 1;
    }
    if (!hdi_tridiag_eigen(z->d, z->e, z->z0, z->z1, m)) return hdi_fail(e, HD_ERR_BREAKDOWN, "Lanczos: the projected eigenproblem did not converge");
    for (i = 0; i < m; i++) {
        const double x = t * z->d[i];
        sum += z->z0[i] * z->z1[i] * (fabs(x) > 1e-8 ? -expm1(-x) / x : 1 - x / 2);
    }
    *bound = t * z->beta[m] * fabs(sum);
    return HD_OK;
}

/* y = exp(-t T) e_1 through the best uniform set of degree 14: O(m) a pole, and as exact as rounding would leave an eigensolution. */
static void hdi_lanczos_coefficients(hdi_lanczos *z, double t, const hd_rational *set) {
    const int32_t m = z->m;
    hd_c64 *d = z->work, *g = z->work + m;
    int32_t i, p;
    for (i = 0; i < m; i++) z->y[i] = i == 0 ? set->a0 : 0;
    for (p = 0; p < set->n_poles; p++) {
        for (i = 0; i < m; i++) {                /* (t T + theta) g = e_1 by L D L' */
            const double off = i ? t * z->beta[i] : 0;
            d[i] = hdi_c(t * z->alpha[i] + set->theta[p].re, set->theta[p].im);
            g[i] = hdi_c(i == 0, 0);
            if (!i) continue;
            d[i] = hdi_csub(d[i], hdi_cdiv(hdi_c(off * off, 0), d[i - 1]));
            g[i] = hdi_cscale(-off, hdi_cdiv(g[i - 1], d[i - 1]));
        }
        for (i = m; i-- > 0;) {
            if (i + 1 < m) g[i] = hdi_csub(g[i], hdi_cscale(t * z->beta[i + 1], g[i + 1]));
            g[i] = hdi_cdiv(g[i], d[i]);
            z->y[i] -= hdi_rat_count(set, p) * hdi_cmul(set->a[p], g[i]).re;
        }
    }
}

/* A start: v of B norm one, c = B v. */
static void hdi_lanczos_start(hdi_lane *lane, int32_t n, double f0_norm) {
    hdi_lanczos *z = &lane->lanczos;
    int32_t i;
    for (i = 0; i < n; i++) {
        z->v[i] = lane->f[i] / f0_norm;
        z->c[i] = lane->rhs[i] / f0_norm;
        z->c_old[i] = 0;
    }
    z->beta[0] = 0;
    z->m = 0;
}

/* One step: from v_j, c = B v_j, c_old = B v_(j-1) to the next, and alpha_j, beta_(j+1). work [4 n]. */
static hd_status hdi_lanczos_step(const hd_laplacian *lap, const double *weight, hdi_lanczos *z, double *HDI_RESTRICT w, double *mass, hd_error *e) {
    const int32_t n = lap->n_active, j = z->m;
    double *HDI_RESTRICT v = z->v, *HDI_RESTRICT c = z->c, *HDI_RESTRICT c_old = z->c_old, alpha = 0, norm = 0, scale;
    int32_t i;
    hdi_csr_apply_rows(&lap->L, v, w, 0, n);
    for (i = 0; i < n; i++) {
        w[i] -= z->beta[j] * c_old[i];
        alpha += v[i] * w[i];
    }
    if (lap->B) {
        hdi_axpy(-alpha, c, w, n);
        if (hdi_mass_solve(lap, w, v, mass, e) < 0) return e->status;
        norm = hdi_dot(w, v, n);
    } else {                                     /* the same in one pass */
        for (i = 0; i < n; i++) {
            w[i] -= alpha * c[i];
            v[i] = w[i] * weight[i];
            norm += w[i] * v[i];
        }
    }
    z->alpha[j] = alpha;
    z->beta[j + 1] = norm > 0 ? sqrt(norm) : 0;
    z->m = j + 1;
    scale = norm > 0 ? 1 / z->beta[j + 1] : 0;
    for (i = 0; i < n; i++) {
        v[i] *= scale;
        c_old[i] = w[i] * scale;
    }
    z->c = c_old;
    z->c_old = c;
    return HD_OK;
}

/* Steps to the next look at the bound: half of what a straight line through the last two looks promises, as convergence speeds up. */
static int32_t hdi_lanczos_pace(int32_t m, int32_t m_before, double bound, double bound_before, double target) {
    const int32_t most = m < 64 ? 1 : m / 32;
    double rate, want;
    if (!(bound < bound_before) || !(target > 0) || m == m_before) return most;
    rate = log(bound_before / bound) / (m - m_before);
    want = 0.5 * log(bound / target) / rate;
    return want < 1 ? 1 : want > most ? most : HDI_CAST(int32_t, want);
}

/* First sweep: as many steps as the bound asks for, and the coefficients in y. fixed_norm2 is what |u|_B^2 has besides. */
static hd_status hdi_lanczos_first(const hd_heat *heat, double t, double f0_norm, double fixed_norm2, hdi_lane *lane, const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = heat->lap;
    const double tol = heat->opts.tol;
    const int32_t most = heat->opts.max_iterations < HDI_LANCZOS_MAX ? heat->opts.max_iterations : HDI_LANCZOS_MAX;
    hdi_lanczos *z = &lane->lanczos;
    double bound = 0, bound_before = 0, best = DBL_MAX, start = 0;
    int32_t look = 1, looked = 0, best_m = 0;
    hd_rational set;
    if (hdi_rational_get(&set, HD_POLES_UNIFORM, 14, e) < 0) return e->status;
    lane->rational = f0_norm * set.max_error;    /* of the coefficients; the basis has no error of this kind */
    hdi_lanczos_start(lane, lap->n_active, f0_norm);
    for (;;) {
        if (hdi_lanczos_step(lap, heat->weight, z, lane->tmp, lane->tmp + lap->n_active, e) < 0) return e->status;
        if (z->m < look && z->beta[z->m] > 0 && z->m < most) continue;
        if (hdi_lanczos_bound(z, t, &bound, e) < 0) return e->status;
        hdi_lanczos_coefficients(z, t, &set);
        lane->u_norm = sqrt(fixed_norm2 + f0_norm * f0_norm * hdi_dot(z->y, z->y, z->m));
        lane->solver = f0_norm * bound;
        if (lane->solver <= tol * lane->u_norm || z->beta[z->m] == 0) return HD_OK;
        if (bound < best / 2) {
            best = bound;
            best_m = z->m;
        } else if (best < 1e-10 && z->m > best_m + 20 + z->m / 4) {
            return HD_WARN_ACCURACY;             /* what rounding leaves */
        }
        if (z->m >= most) {
            hdi_fail(e, HD_ERR_NOT_CONVERGED, "Lanczos did not reach the tolerance in its largest number of steps; use poles");
            e->value = lane->solver / lane->u_norm;
            return e->status;
        }
        if (start == 0) start = lane->solver;
        if (hdi_watch_look(watch, 0.5 * hdi_krylov_done(start, lane->solver, tol * lane->u_norm), e) < 0) return e->status;
        look = z->m + hdi_lanczos_pace(z->m, looked, lane->solver, f0_norm * bound_before, tol * lane->u_norm);
        looked = z->m;
        bound_before = bound;
    }
}

/* Second sweep: u += f0_norm sum y_j v_j. */
static hd_status hdi_lanczos_second(const hd_heat *heat, double f0_norm, hdi_lane *lane, const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = heat->lap;
    const int32_t n = lap->n_active, m = lane->lanczos.m;
    int32_t j;
    hdi_lanczos_start(lane, n, f0_norm);
    for (j = 0; j < m; j++) {
        hdi_axpy(f0_norm * lane->lanczos.y[j], lane->lanczos.v, lane->u, n);
        if (j % 16 == 0 && hdi_watch_look(watch, 0.5 + 0.5 * j / m, e) < 0) return e->status;
        if (j + 1 < m && hdi_lanczos_step(lap, heat->weight, &lane->lanczos, lane->tmp, lane->tmp + n, e) < 0) return e->status;
    }
    lane->lanczos.m = m;
    return HD_OK;
}

/* K_t f by Lanczos. The constants of each component need none of it. */
static hd_status hdi_heat_lanczos(const hd_heat *heat, double t, hdi_lane *lane, const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = heat->lap;
    const int32_t n = lap->n_active;
    hd_status status = HD_OK;
    double f0_norm, fixed = 0;
    int32_t i;
    memset(lane->u, 0, HDI_CAST(size_t, n) * sizeof *lane->u);
    if (lap->conserves) {
        for (i = 0; i < lap->n_components; i++) {
            lane->sums[i] = -lane->target[i] / lap->component_mass[i];
            fixed += lane->target[i] * lane->target[i] / lap->component_mass[i];
        }
        hdi_component_add(lap, lane->sums, lane->f);               /* f0 = f - constants, rhs0 = B f0 */
        for (i = 0; i < n; i++) lane->rhs[i] += lap->mass[i] * lane->sums[lap->component[i]];
        for (i = 0; i < n; i++) lane->u[i] = -lane->sums[lap->component[i]];
    }
    f0_norm = hdi_dot(lane->f, lane->rhs, n);
    f0_norm = f0_norm > 0 ? sqrt(f0_norm) : 0;
    lane->u_norm = sqrt(fixed);
    if (f0_norm > DBL_EPSILON * lane->f_norm) {
        status = hdi_lanczos_first(heat, t, f0_norm, fixed, lane, watch, e);
        if (status >= 0 && hdi_lanczos_second(heat, f0_norm, lane, watch, e) < 0) return e->status;
        lane->steps = lane->lanczos.m;
    }
    if (status >= 0) hdi_conserve(lap, lane, 1);
    return status;
}

/* ---- through the poles ---- */

/* |x|_B^2 of a complex vector; tmp [3 n]. */
static double hdi_b_norm2_complex(const hd_laplacian *lap, const hd_c64 *x, double *tmp) {
    const int32_t n = lap->n_active;
    double *work = tmp + 2 * HDI_CAST(int64_t, n);
    int32_t i;
    if (!lap->B) return hdi_cnorm2w(x, lap->mass, n);
    for (i = 0; i < n; i++) {
        tmp[i] = x[i].re;
        tmp[n + i] = x[i].im;
    }
    return hdi_max(0, hdi_b_norm2(lap, tmp, work) + hdi_b_norm2(lap, tmp + n, work));
}

/* Bound of |(exp - c)(-t B^-1 L) f|_B. A weighted set's error is relative to the resolvent (B + t L)^-1 B f, which a solution bounds; the
 * constants drop out of built-in sets. */
static double hdi_rational_bound(const hdi_family *fam, const hdi_lane *lane) {
    double bound = fam->set.max_error * lane->f_norm;
    if (fam->set.max_weighted_error > 0 && fam->set.n_poles > 0) {
        const double g = sqrt(hdi_b_norm2_complex(fam->lap, lane->k[0].x, lane->tmp)) + hdi_pole_error(lane->k);
        const double resolvent = fam->lap->conserves && fam->set.kind == HD_POLES_OWN ? lane->f_norm : g;
        bound = hdi_min(bound, fam->set.max_weighted_error * hdi_resolvent_ratio(fam->set.theta[0]) * resolvent);
    }
    return bound;
}

/* The right-hand side without its constants, complex. */
static void hdi_lane_rhs(hdi_lane *lane, const hd_laplacian *lap) {
    int32_t i;
    for (i = 0; i < lap->n_components; i++) lane->sums[i] = lap->conserves ? lane->target[i] / lap->component_mass[i] : 0;
    for (i = 0; i < lap->n_active; i++) lane->b[i] = hdi_c(lane->rhs[i] - lap->mass[i] * lane->sums[lap->component[i]], 0);
}

/* K_t f through a pole set. The tolerance is relative to the answer, which is not known before: a first round aims at it relative to f,
 * which is never too strict as |K_t f|_B <= |f|_B, and the next ones go on from there relative to what came out. */
static hd_status hdi_heat_poles(const hdi_family *fam, double tol, hdi_lane *lane, const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = fam->lap;
    const double c0 = fam->set.kind == HD_POLES_OWN ? hdi_rational_eval(&fam->set, 0) : 1;
    double aim = tol * lane->f_norm, room;
    hdi_watch part = *watch;
    hd_status status = HD_OK;
    int32_t i, round;
    hdi_lane_rhs(lane, lap);
    for (round = 0; round < 6; round++) {
        part.from = watch->from + watch->share * (round ? 0.7 : 0);
        part.share = watch->share * (round ? 0.3 : 0.7);
        status = hdi_lane_run(lane, fam, round == 0, aim, &part, e);
        if (status < 0) return status;
        lane->solver = hdi_lane_sum(lane, fam);
        hdi_conserve(lap, lane, c0);
        lane->u_norm = sqrt(hdi_max(0, hdi_b_norm2(lap, lane->u, lane->tmp)));
        room = tol * (lane->u_norm - lane->solver);
        if (lane->solver <= room || status == HD_WARN_ACCURACY) break;
        aim = room > 0.01 * aim ? (1 - tol) * room : 0.01 * aim;
    }
    for (i = 0; i < fam->set.n_poles; i++)
        if (lane->k[i].b_norm > 0) lane->residual = hdi_max(lane->residual, lane->k[i].r_norm / lane->k[i].b_norm);
    lane->rational = hdi_rational_bound(fam, lane);
    return lane->solver <= tol * (lane->u_norm - lane->solver) ? HD_OK : HD_WARN_ACCURACY;
}

/* Adds the numbers of one field to the report, where the worst stays. */
static void hdi_heat_judge(const hd_laplacian *lap, const hdi_lane *lane, int own, hd_report *rep) {
    const double floor_b = lane->u_norm - lane->solver - lane->rational, total = lane->solver + lane->rational;
    double largest = 0, smallest_b = DBL_MAX, heat = 0, heat_in = 0, heat_abs = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        largest = hdi_max(largest, fabs(lane->u[i]));
        if (lane->u[i] != 0) smallest_b = hdi_min(smallest_b, lap->b_diag[i]);
        heat += lap->mass[i] * lane->u[i];
        heat_abs += fabs(lap->mass[i] * lane->u[i]);
    }
    for (i = 0; i < lap->n_components; i++) heat_in += lane->target[i];
    if (total > 0) {
        rep->error_solver = hdi_max(rep->error_solver, floor_b > 0 ? lane->solver / floor_b : HUGE_VAL);
        rep->error_rational = hdi_max(rep->error_rational, floor_b > 0 ? lane->rational / floor_b : HUGE_VAL);
        rep->error_bound_b = hdi_max(rep->error_bound_b, floor_b > 0 ? total / floor_b : HUGE_VAL);
        rep->error_bound = hdi_max(rep->error_bound, largest > 0 ? total / sqrt(lap->b_ratio * smallest_b) / largest : HUGE_VAL);
    }
    rep->residual = hdi_max(rep->residual, lane->residual);
    if (lap->conserves && !own && heat_abs > 0) rep->mass_drift = hdi_max(rep->mass_drift, fabs(heat - heat_in) / heat_abs);
}

/* ==== [21] api ====
 * Argument checks, defaults, lifetimes; the bodies of the public functions. May call everything. */

HEATDIFF_API const char *hd_status_name(hd_status status) {
    switch (status) {
#define HD_STATUS_NAME(name, value, text) case name: return #name;
        HD_STATUS_LIST(HD_STATUS_NAME)
#undef HD_STATUS_NAME
        case HD_STATUS_FORCE_INT: break;
    }
    return "HD_UNKNOWN_STATUS";
}

HEATDIFF_API const char *hd_status_text(hd_status status) {
    switch (status) {
#define HD_STATUS_TEXT(name, value, text) case name: return text;
        HD_STATUS_LIST(HD_STATUS_TEXT)
#undef HD_STATUS_TEXT
        case HD_STATUS_FORCE_INT: break;
    }
    return "unknown status";
}

/* What a public function works with: an error and a context that are there, whatever the caller gave. */
typedef struct hdi_call {
    hd_error error;
    hd_error *e;
    hd_context context;
    hd_context *ctx;
} hdi_call;

static hd_status hdi_enter(hdi_call *c, hd_context *ctx, hd_error *err) {
    memset(&c->context, 0, sizeof c->context);
    c->e = err ? err : &c->error;
    c->ctx = ctx ? ctx : &c->context;
    hdi_error_clear(c->e);
    return hdi_context_check(c->ctx, c->e);
}

static hd_status hdi_missing(hd_error *e) { return hdi_fail(e, HD_ERR_ARGUMENT, "an argument that must not be NULL is NULL"); }

HEATDIFF_API hd_status hd_csr_from_triplets(hd_csr *out, int32_t n_rows, int32_t n_cols, int64_t n_triplets, const int32_t *i,
                                            const int32_t *j, const double *v, hd_context *ctx, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, ctx, err) < 0) return c.e->status;
    if (!out || (n_triplets > 0 && (!i || !j))) return hdi_missing(c.e);
    if (n_rows < 0 || n_cols < 0 || n_triplets < 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "triplets: a size is negative");
    return hdi_csr_from_triplets(out, n_rows, n_cols, n_triplets, i, j, v, c.ctx, c.e);
}

HEATDIFF_API hd_status hd_csr_check(const hd_csr *a, int32_t symmetric, hd_context *ctx, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, ctx, err) < 0) return c.e->status;
    return a ? hdi_csr_check(a, symmetric, c.ctx, c.e) : hdi_missing(c.e);
}

HEATDIFF_API hd_status hd_csr_transpose(hd_csr *out, const hd_csr *a, hd_context *ctx, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, ctx, err) < 0) return c.e->status;
    if (!out || !a) return hdi_missing(c.e);
    return hdi_csr_check_rows(a, c.e) < 0 ? c.e->status : hdi_csr_transpose(out, a, c.ctx, c.e);
}

HEATDIFF_API hd_status hd_csr_product(hd_csr *out, const hd_csr *a, const hd_csr *b, hd_context *ctx, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, ctx, err) < 0) return c.e->status;
    if (!out || !a || !b) return hdi_missing(c.e);
    if (hdi_csr_check_rows(a, c.e) < 0 || hdi_csr_check_rows(b, c.e) < 0) return c.e->status;
    if (a->n_cols != b->n_rows) return hdi_fail_row(c.e, HD_ERR_ARGUMENT, "product: the inner sizes differ", a->n_cols, b->n_rows, 0);
    return hdi_csr_product(out, a, b, c.ctx, c.e);
}

HEATDIFF_API hd_status hd_csr_permute(hd_csr *out, const hd_csr *a, const int32_t *perm, hd_context *ctx, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, ctx, err) < 0) return c.e->status;
    if (!out || !a || (a->n_rows > 0 && !perm)) return hdi_missing(c.e);
    if (hdi_csr_check_rows(a, c.e) < 0) return c.e->status;
    if (a->n_rows != a->n_cols) return hdi_fail_row(c.e, HD_ERR_ARGUMENT, "permute: the matrix is not square", a->n_rows, a->n_cols, 0);
    return hdi_csr_permute(out, a, perm, c.ctx, c.e);
}

HEATDIFF_API void hd_csr_apply(const hd_csr *a, const double *x, double *y, hd_context *ctx) {
    hdi_call c;
    if (hdi_enter(&c, ctx, NULL) < 0) c.ctx = &c.context;
    hdi_csr_apply(a, x, y, c.ctx);
}

HEATDIFF_API void hd_csr_free(hd_csr *a, hd_context *ctx) {
    hdi_call c;
    (void)hdi_enter(&c, ctx, NULL);
    if (a) hdi_csr_free(c.ctx, a);
}

/* ---- operators ---- */

/* A Laplacian without content, with a context that lives as long as it does. A context of the library's own sits behind the struct. */
typedef struct hdi_laplacian { hd_laplacian lap; hd_context context; } hdi_laplacian;

static hd_laplacian *hdi_lap_new(const hd_laplacian_opts *opts, int32_t n, hd_laplacian_kind kind, hd_error *err, hdi_call *c) {
    hdi_laplacian *shell;
    if (hdi_enter(c, opts ? opts->context : NULL, err) < 0) return NULL;
    if (opts && (opts->begin_zero || opts->end_zero)) {
        hdi_fail(c->e, HD_ERR_ARGUMENT, "laplacian options: not cleared before use");
        return NULL;
    }
    if (n < 0) {
        hdi_fail(c->e, HD_ERR_ARGUMENT, "laplacian: a size is negative");
        return NULL;
    }
    shell = HDI_CAST(hdi_laplacian *, hdi_alloc(c->ctx, 1, sizeof *shell, c->e));
    if (!shell) return NULL;
    memset(shell, 0, sizeof *shell);
    shell->lap.n = n;
    shell->lap.kind = kind;
    if (c->ctx == &c->context) {                 /* what was counted on the stack moves along */
        shell->context = c->context;
        c->ctx = &shell->context;
    }
    shell->lap.context = c->ctx;
    return &shell->lap;
}

static hd_status hdi_lap_done(hd_laplacian **out, hd_laplacian *lap, hd_status status) {
    if (status >= 0) *out = lap;
    else hd_laplacian_free(lap);
    return status;
}

HEATDIFF_API hd_status hd_laplacian_triangles(hd_laplacian **out, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri,
                                              const hd_laplacian_opts *opts, hd_error *err) {
    const hd_laplacian_kind kind = opts ? opts->kind : HD_LAPLACIAN_FEM;
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, n, kind, err, &c);
    if (!lap) return c.e->status;
    if (!out || (n > 0 && !xyz) || (n_tri > 0 && !tri)) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (n_tri < 0) return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian: a size is negative"));
    if (kind != HD_LAPLACIAN_FEM && kind != HD_LAPLACIAN_VORONOI_COT && kind != HD_LAPLACIAN_COT)
        return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of triangles: the kind is fem, voronoi-cot or cot"));
    if (hdi_progress(c.ctx, "assemble", 0, c.e) < 0) return hdi_lap_done(out, lap, c.e->status);
    return hdi_lap_done(out, lap, hdi_lap_triangles(lap, xyz, tri, n_tri, c.e));
}

HEATDIFF_API hd_status hd_laplacian_matrices(hd_laplacian **out, const hd_csr *L, const hd_csr *B, double h, const hd_laplacian_opts *opts,
                                             hd_error *err) {
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, L ? L->n_rows : 0, HD_LAPLACIAN_MATRICES, err, &c);
    if (!lap) return c.e->status;
    if (!out || !L || !B || !L->val || !B->val) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (!(h >= 0) || !hdi_finite(h)) return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of matrices: h is negative or not finite"));
    if (hdi_csr_check(L, 1, c.ctx, c.e) < 0 || hdi_csr_check(B, 1, c.ctx, c.e) < 0) return hdi_lap_done(out, lap, c.e->status);
    if (L->n_rows != B->n_rows)
        return hdi_lap_done(out, lap, hdi_fail_row(c.e, HD_ERR_ARGUMENT, "laplacian of matrices: L and B differ in size", L->n_rows, B->n_rows, 0));
    lap->h = h;
    return hdi_lap_done(out, lap, hdi_lap_matrices(lap, L, B, c.e));
}

static void hdi_gather(const hd_laplacian *lap, const double *on_vertices, double *on_rows) {
    int32_t i;
    for (i = 0; i < lap->n_active; i++) on_rows[i] = on_vertices[lap->vertex[i]];
}

HEATDIFF_API hd_status hd_laplacian_apply(const hd_laplacian *lap, double alpha, double beta, const double *x, double *y, hd_error *err) {
    hdi_call c;
    hdi_scope s;
    double *in, *out;
    int32_t v;
    if (hdi_enter(&c, lap ? lap->context : NULL, err) < 0) return c.e->status;
    if (!lap || !x || !y) return hdi_missing(c.e);
    s = hdi_scope_begin(c.ctx, c.e);
    in = HDI_TAKE(&s, double, lap->n_active);
    out = HDI_TAKE(&s, double, lap->n_active);
    if (c.e->status < 0) return hdi_scope_end(&s);
    hdi_gather(lap, x, in);
    hdi_pair_apply(lap, alpha, beta, in, out);
    for (v = 0; v < lap->n; v++) y[v] = lap->row[v] >= 0 ? out[lap->row[v]] : 0;
    return hdi_scope_end(&s);
}

HEATDIFF_API void hd_laplacian_free(hd_laplacian *lap) {
    hd_context ctx;
    hd_context *use;
    if (!lap) return;
    use = lap->context;
    if (use == &HDI_CAST(hdi_laplacian *, HDI_CAST(void *, lap))->context) {   /* about to be freed itself */
        ctx = *use;
        use = &ctx;
    }
    hdi_laplacian_free(lap, use);
}

/* ---- rational approximations ---- */

HEATDIFF_API hd_status hd_rational_get(hd_rational *out, hd_pole_kind kind, int32_t degree, hd_error *err) {
    hdi_call c;
    (void)hdi_enter(&c, NULL, err);
    return out ? hdi_rational_get(out, kind, degree, c.e) : hdi_missing(c.e);
}

HEATDIFF_API double hd_rational_eval(const hd_rational *set, double x) { return hdi_rational_eval(set, x); }

/* ---- shifted systems ---- */

static double *hdi_make_weight(const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    double *w = HDI_CAST(double *, hdi_alloc(ctx, HDI_CAST(size_t, lap->n_active), sizeof *w, e));
    int32_t i;
    for (i = 0; w && i < lap->n_active; i++) w[i] = 1 / lap->b_diag[i];
    return w;
}

static hd_status hdi_solve_check(double t, hd_c64 theta, const hd_solve_opts *o, hd_error *e) {
    if (o->begin_zero || o->end_zero) return hdi_fail(e, HD_ERR_ARGUMENT, "solve options: not cleared before use");
    if (!(t >= 0) || !hdi_finite(t)) return hdi_fail_row(e, HD_ERR_ARGUMENT, "solve: t is negative or not finite", -1, -1, t);
    if (!hdi_cfinite(theta) || (theta.im == 0 && theta.re <= 0)) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: theta lies on (-inf, 0] or is not finite");
    if (o->solver < HD_SOLVER_AUTO || o->solver > HD_SOLVER_MINRES) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: the solver is cocg, cocr or minres");
    if (o->precond < HD_PRECOND_AUTO || o->precond > HD_PRECOND_MILDL) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: unknown preconditioner");
    if (!(o->tol >= 0) || o->tol >= 1) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: tol is not in [0, 1)");
    if (o->max_iterations < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: max_iterations is negative");
    return HD_OK;
}

/* ---- heat ---- */

static hd_status hdi_heat_check(const hd_heat_opts *o, hd_error *e) {
    if (o->begin_zero || o->end_zero) return hdi_fail(e, HD_ERR_ARGUMENT, "heat options: not cleared before use");
    if (o->method < HD_METHOD_AUTO || o->method > HD_METHOD_ITERATIVE) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown method");
    if (o->solver < HD_SOLVER_AUTO || o->solver > HD_SOLVER_LANCZOS) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown solver");
    if (o->precond < HD_PRECOND_AUTO || o->precond > HD_PRECOND_MILDL) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown preconditioner");
    if (o->poles < HD_POLES_DEFAULT || o->poles > HD_POLES_KERNEL) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: poles are uniform or kernel; own sets go into rational");
    if (o->degree < 0 || o->degree > HDI_RAT_UNIFORM_MAX) return hdi_fail_row(e, HD_ERR_ARGUMENT, "heat: the degree is not in 1..14", -1, -1, o->degree);
    if (o->poles == HD_POLES_KERNEL && o->degree && o->degree < HDI_RAT_KERNEL_MIN)
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "heat: kernel sets have degrees 2 to 14", -1, -1, o->degree);
    if (!(o->tol >= 0) || o->tol >= 1) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: tol is not in [0, 1)");
    if (o->max_iterations < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: max_iterations is negative");
    if (o->rational && o->solver == HD_SOLVER_LANCZOS) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: Lanczos has no use for a pole set");
    return o->rational ? hdi_rational_check(o->rational, e) : HD_OK;
}

/* Gershgorin: every eigenvalue of B^-1 L is below this. */
static double hdi_lambda_bound(const hd_laplacian *lap) {
    double most = 0;
    int32_t i;
    int64_t p = 0;
    for (i = 0; i < lap->n_active; i++) {
        double sum = 0;
        for (; p < lap->L.row_ptr[i + 1]; p++) sum += fabs(lap->L.val[p]);
        most = hdi_max(most, sum / lap->b_diag[i]);
    }
    return most / lap->b_ratio;
}

HEATDIFF_API hd_status hd_heat_create(hd_heat **out, const hd_laplacian *lap, const hd_heat_opts *opts, hd_error *err) {
    hdi_call c;
    hd_heat *heat;
    hdi_scope s;
    if (hdi_enter(&c, opts && opts->context ? opts->context : lap ? lap->context : NULL, err) < 0) return c.e->status;
    if (!out || !lap) return hdi_missing(c.e);
    if (opts && hdi_heat_check(opts, c.e) < 0) return c.e->status;
    s = hdi_scope_begin(c.ctx, c.e);
    heat = HDI_TAKE_ZERO(&s, hd_heat, 1);
    if (!heat) return hdi_scope_end(&s);
    heat->ctx = c.ctx;
    if (opts) heat->opts = *opts;
    if (heat->opts.rational) {
        heat->own_set = *heat->opts.rational;
        heat->own_set.kind = HD_POLES_OWN;
        heat->opts.rational = &heat->own_set;
    }
    heat->opts.precond = heat->opts.precond ? heat->opts.precond : HD_PRECOND_MILDL;
    heat->opts.tol = heat->opts.tol > 0 ? heat->opts.tol : 1e-9;
    heat->opts.max_iterations = heat->opts.max_iterations ? heat->opts.max_iterations : 20000;
    hdi_keep(&s, heat);
    if (hdi_progress(c.ctx, "order", 0, c.e) >= 0) heat->lap = hdi_sym_ordered(lap, c.ctx, c.e);
    if (heat->lap) heat->scale = hdi_sym_scale(heat->lap);
    if (heat->lap && hdi_upper_make(&heat->up, &heat->lap->L, c.ctx, c.e) >= 0) heat->weight = hdi_make_weight(heat->lap, c.ctx, c.e);
    if (heat->weight) heat->lambda_max = hdi_lambda_bound(heat->lap);
    heat->fam.ctx = c.ctx;
    heat->fam.lap = heat->lap;
    heat->fam.up = &heat->up;
    heat->fam.weight = heat->weight;
    heat->fam.solver = heat->opts.solver == HD_SOLVER_COCR || heat->opts.solver == HD_SOLVER_MINRES ? heat->opts.solver : HD_SOLVER_COCG;
    heat->fam.precond = heat->opts.precond;
    heat->fam.max_iterations = heat->opts.max_iterations;
    if (heat->weight) *out = heat;
    else hd_heat_free(heat);
    return hdi_scope_end(&s);
}

HEATDIFF_API void hd_heat_free(hd_heat *heat) {
    hd_context *ctx;
    int32_t i;
    if (!heat) return;
    ctx = heat->ctx;
    for (i = 0; i < HDI_LANES; i++) hdi_lane_free(heat->lane + i, ctx);
    hdi_family_free(&heat->fam);
    hdi_upper_free(ctx, &heat->up);
    hdi_free(ctx, heat->weight);
    hdi_laplacian_free(heat->lap, ctx);
    hdi_free(ctx, heat);
}

/* One system with a plan made for it. */
static hd_status hdi_shifted_solve(hd_heat *heat, double t, hd_c64 theta, const hd_c64 *rhs, hd_c64 *x, double tol, hd_solve_report *report,
                                   hd_error *e) {
    const hd_laplacian *lap = heat->lap;
    hdi_lane *lane = heat->lane;
    hdi_krylov *k = lane->k;
    hdi_watch watch;
    hd_rational set;
    hd_status status;
    double b_norm;
    int32_t i, v;
    memset(&watch, 0, sizeof watch);
    memset(&set, 0, sizeof set);
    watch.ctx = heat->ctx;
    watch.share = 1;
    watch.stage = "solve";
    set.n_poles = 1;
    set.theta[0] = theta;
    if (hdi_family_set(&heat->fam, &set, t * heat->scale, e) < 0 || hdi_lane_make(lane, lap, heat->ctx, e) < 0) return e->status;
    if (hdi_lane_systems(lane, &heat->fam, e) < 0) return e->status;
    if (hdi_family_fill(&heat->fam, lane->vectors, hdi_lane_stride(&heat->fam), e) < 0) return e->status;
    for (i = 0; i < lap->n_active; i++) lane->b[i] = hdi_cscale(heat->scale, rhs[lap->vertex[i]]);
    b_norm = sqrt(hdi_cnorm2w(lane->b, heat->weight, lap->n_active));
    memset(k->sums, 0, HDI_CAST(size_t, lap->n_components) * sizeof *k->sums);
    if (lap->conserves) {                        /* constants apart: b - B mean(b), and mean(b)/theta to the solution */
        for (i = 0; i < lap->n_active; i++) k->sums[lap->component[i]] = hdi_cadd(k->sums[lap->component[i]], lane->b[i]);
        for (i = 0; i < lap->n_components; i++) k->sums[i] = hdi_cscale(1 / lap->component_mass[i], k->sums[i]);
        for (i = 0; i < lap->n_active; i++) lane->b[i] = hdi_csub(lane->b[i], hdi_cscale(lap->mass[i], k->sums[lap->component[i]]));
        for (v = 0; v < lap->n; v++) x[v] = lap->row[v] >= 0 ? hdi_cdiv(k->sums[lap->component[lap->row[v]]], theta) : hdi_c(0, 0);
    } else {
        for (v = 0; v < lap->n; v++) x[v] = hdi_c(0, 0);
    }
    hdi_krylov_start(k, lane->b, b_norm);
    status = hdi_krylov_run(k, lane->b, tol * b_norm, heat->fam.max_iterations, &watch, e);
    for (i = 0; i < lap->n_active; i++) x[lap->vertex[i]] = k->x[i] = hdi_cadd(x[lap->vertex[i]], k->x[i]);
    if (report) {
        const double error = hdi_pole_error(k), norm = sqrt(hdi_b_norm2_complex(lap, k->x, lane->tmp)) - error;
        report->iterations = k->iterations;
        report->residual = b_norm > 0 ? k->r_norm / b_norm : 0;
        report->error_b = error == 0 ? 0 : norm > 0 ? error / norm : HUGE_VAL;
    }
    if (status > 0) e->status = status;
    return e->status;
}

HEATDIFF_API hd_status hd_shifted_solve(const hd_laplacian *lap, double t, hd_c64 theta, const hd_c64 *rhs, hd_c64 *x,
                                        const hd_solve_opts *opts, hd_solve_report *report, hd_error *err) {
    hd_solve_opts o;
    hd_heat_opts plan;
    hd_heat *heat = NULL;
    hdi_call c;
    memset(&o, 0, sizeof o);
    memset(&plan, 0, sizeof plan);
    if (opts) o = *opts;
    if (hdi_enter(&c, o.context ? o.context : lap ? lap->context : NULL, err) < 0) return c.e->status;
    if (!lap || !rhs || !x) return hdi_missing(c.e);
    if (hdi_solve_check(t, theta, &o, c.e) < 0) return c.e->status;
    plan.solver = o.solver ? o.solver : HD_SOLVER_COCG;
    plan.precond = o.precond;
    plan.max_iterations = o.max_iterations;
    plan.context = o.context;
    if (hd_heat_create(&heat, lap, &plan, c.e) < 0) return c.e->status;
    hdi_shifted_solve(heat, t, theta, rhs, x, o.tol > 0 ? o.tol : 1e-10, report, c.e);
    hd_heat_free(heat);
    return c.e->status;
}

/* Lanczos where the caller leaves the choice and asks for no pole set, B needs no solve, and its steps are few: a step reads L once and
 * streams about ten vectors, and stores one; through the poles a step reads as much five times over, in complex. */
static hd_solver hdi_heat_choose(const hd_heat *heat, double t) {
    const hd_heat_opts *o = &heat->opts;
    const double steps = 1.2 * sqrt(t * heat->lambda_max) + 10;
    if (o->solver) return o->solver;
    if (o->rational || o->poles || o->degree || o->precond != HD_PRECOND_MILDL || heat->lap->B) return HD_SOLVER_COCG;
    return steps <= 400 ? HD_SOLVER_LANCZOS : HD_SOLVER_COCG;
}

typedef enum hdi_query { HDI_QUERY_FIELD, HDI_QUERY_OPERATOR, HDI_QUERY_SYMMETRIC } hdi_query;

/* A heat call under way: k items, each a field, a column, or the pairs that share a column; a few at a time, each in a lane. */
typedef struct hdi_heat_call {
    hd_heat *heat;
    hdi_query query;
    double t;
    int32_t k;
    hd_solver solver;
    hd_report *rep;
    hd_report own_report;
    hd_error *e;
    hdi_scope s;
    hdi_lane *lane;              /* [HDI_LANES], the plan's */
    int32_t n_lanes, batch;      /* lanes that exist; first item in lane 0 */
    int32_t stop;
    const double *F;             /* fields */
    double *U;                   /* answers, columns */
    size_t ldf, ldu;
    const int32_t *sources;      /* columns */
    const hdi_pair *order;       /* entries: sorted by column; where each column begins; rows; values */
    const int64_t *begin;
    const int32_t *rows;
    double *values;
} hdi_heat_call;

static hd_status hdi_heat_begin(hdi_heat_call *h, hd_heat *heat, hdi_query query, double t, int32_t k, hd_report *report) {
    memset(h, 0, sizeof *h);
    h->rep = report ? report : &h->own_report;
    memset(h->rep, 0, sizeof *h->rep);
    h->e = &h->rep->error;
    hdi_error_clear(h->e);
    h->heat = heat;
    h->query = query;
    h->t = t;
    h->k = k;
    if (!heat) return hdi_missing(h->e);
    h->s = hdi_scope_begin(heat->ctx, h->e);
    if (!(t >= 0) || !hdi_finite(t)) return hdi_fail_row(h->e, HD_ERR_ARGUMENT, "heat: t is negative or not finite", -1, -1, t);
    if (k < 0) return hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: a number of fields or columns is negative");
    h->t = t * heat->scale;
    if (!hdi_finite(h->t)) return hdi_fail_row(h->e, HD_ERR_ARGUMENT, "heat: t is too large for these masses", -1, -1, t);
    h->solver = hdi_heat_choose(heat, h->t);
    h->rep->method = HD_METHOD_ITERATIVE;
    h->rep->solver = h->solver;
    h->rep->precond = h->solver == HD_SOLVER_LANCZOS ? HD_PRECOND_NONE : heat->opts.precond;
    h->lane = heat->lane;
    return HD_OK;
}

static hd_status hdi_heat_end(hdi_heat_call *h) {
    const hd_status warned = h->rep->status;
    hd_status st = h->e->status;
    if (h->s.e) st = hdi_scope_end(&h->s);
    h->rep->status = st < 0 ? st : warned;
    return h->rep->status;
}

/* Norm of f and heat per component, from f and rhs. */
static void hdi_heat_measure(const hd_laplacian *lap, hdi_lane *lane) {
    const double f2 = hdi_dot(lane->f, lane->rhs, lap->n_active);
    lane->f_norm = f2 > 0 ? sqrt(f2) : 0;
    hdi_component_sums(lap, NULL, lane->rhs, lane->target);
}

/* Degree of a uniform set: even ones, as an odd one costs as much as the next; the first whose error is 1e-9 of the least that the
 * answer can be, which is what its constants amount to. */
static int32_t hdi_uniform_degree(const hd_laplacian *lap, const hdi_lane *lane) {
    hd_rational set;
    hd_error e;
    double least = 0;
    int32_t c, r;
    for (c = 0; c < lap->n_components && lap->conserves; c++) least += lane->target[c] * lane->target[c] / lap->component_mass[c];
    for (r = 8; r < HDI_RAT_UNIFORM_MAX; r += 2)
        if (hdi_rational_get(&set, HD_POLES_UNIFORM, r, &e) == HD_OK && set.max_error * lane->f_norm <= 1e-9 * sqrt(least)) break;
    return r;
}

/* All fields, before anything is solved or written. */
static hd_status hdi_fields_check(const hdi_heat_call *h) {
    int32_t q, v;
    for (q = 0; q < h->k; q++) {
        const double *f = h->F + HDI_CAST(size_t, q) * h->ldf;
        for (v = 0; v < h->heat->lap->n; v++)
            if (!hdi_finite(f[v])) return hdi_fail_row(h->e, HD_ERR_NOT_FINITE, "heat: a value of the field is not finite", v, q, f[v]);
    }
    return HD_OK;
}

static int32_t hdi_heat_source(const hdi_heat_call *h, int32_t q) {
    return h->sources ? h->sources[q] : HDI_CAST(int32_t, h->order[h->begin[q]].key);
}

/* Field and right-hand side of item q. A vertex without mass needs no solve: skip. */
static hd_status hdi_heat_load(const hdi_heat_call *h, int32_t q, hdi_lane *lane) {
    const hd_laplacian *lap = h->heat->lap;
    const size_t bytes = HDI_CAST(size_t, lap->n_active) * sizeof(double);
    int32_t row;
    lane->skip = 0;
    lane->status = HD_OK;
    lane->rational = lane->solver = lane->residual = 0;
    lane->steps = 0;
    if (h->query == HDI_QUERY_FIELD) {
        hdi_gather(lap, h->F + HDI_CAST(size_t, q) * h->ldf, lane->f);
        hdi_pair_apply(lap, 0, 1, lane->f, lane->rhs);
    } else {
        row = lap->row[hdi_heat_source(h, q)];
        lane->skip = row < 0;
        if (lane->skip) return HD_OK;
        memset(lane->f, 0, bytes);
        memset(lane->rhs, 0, bytes);
        if (h->query == HDI_QUERY_OPERATOR) {
            lane->f[row] = 1;
            hdi_pair_apply(lap, 0, 1, lane->f, lane->rhs);
        } else {
            lane->rhs[row] = 1;
            if (hdi_mass_solve(lap, lane->rhs, lane->f, lane->tmp, h->e) < 0) return h->e->status;
        }
    }
    hdi_heat_measure(lap, lane);
    return HD_OK;
}

/* What item q asked for, from the lane's answer. */
static void hdi_heat_store(const hdi_heat_call *h, int32_t q, const hdi_lane *lane) {
    const hd_laplacian *lap = h->heat->lap;
    const double *answer = h->t > 0 ? lane->u : lane->f, unit = h->query == HDI_QUERY_SYMMETRIC ? h->heat->scale : 1;   /* B^-1 */
    const int32_t source = h->query == HDI_QUERY_FIELD ? -1 : hdi_heat_source(h, q);
    double *u = h->U ? h->U + HDI_CAST(size_t, q) * h->ldu : NULL;
    int64_t p;
    int32_t i;
    if (h->values) {
        for (p = h->begin[q]; p < h->begin[q + 1]; p++) {
            const int32_t v = h->rows[h->order[p].id];
            const double own = h->query == HDI_QUERY_OPERATOR && v == source;
            h->values[h->order[p].id] = lane->skip ? own : lap->row[v] < 0 ? 0 : unit * answer[lap->row[v]];
        }
        return;
    }
    if (h->query == HDI_QUERY_FIELD) {           /* vertices without mass keep their value */
        const double *f = h->F + HDI_CAST(size_t, q) * h->ldf;
        if (u != f) memmove(u, f, HDI_CAST(size_t, lap->n) * sizeof *u);
    } else {
        memset(u, 0, HDI_CAST(size_t, lap->n) * sizeof *u);
        if (lane->skip) u[source] = h->query == HDI_QUERY_OPERATOR;
    }
    for (i = 0; i < lap->n_active && !lane->skip; i++) u[lap->vertex[i]] = unit * answer[i];
}

/* The degree of a uniform set that serves all fields; columns, whose constants are known to be small, get the highest. */
static hd_status hdi_heat_degree(const hdi_heat_call *h, int32_t *degree) {
    int32_t q, r;
    *degree = h->query == HDI_QUERY_FIELD ? 8 : HDI_RAT_UNIFORM_MAX;
    for (q = 0; q < h->k && h->query == HDI_QUERY_FIELD; q++) {
        if (hdi_heat_load(h, q, h->lane) < 0) return h->e->status;
        r = hdi_uniform_degree(h->heat->lap, h->lane);
        if (r > *degree) *degree = r;
    }
    return HD_OK;
}

/* The pole set of this call. */
static hd_status hdi_heat_set(const hdi_heat_call *h, hd_rational *set) {
    const hd_heat_opts *o = &h->heat->opts;
    const hd_pole_kind kind = o->poles ? o->poles : h->query == HDI_QUERY_FIELD ? HD_POLES_UNIFORM : HD_POLES_KERNEL;
    int32_t degree = o->degree ? o->degree : 10;
    if (o->rational) {
        *set = *o->rational;
        return HD_OK;
    }
    if (!o->degree && kind == HD_POLES_UNIFORM && hdi_heat_degree(h, &degree) < 0) return h->e->status;
    return hdi_rational_get(set, kind, degree, h->e);
}

static void hdi_heat_task(void *arg, int64_t index, int32_t worker) {
    hdi_heat_call *h = HDI_CAST(hdi_heat_call *, arg);
    hdi_lane *lane = h->lane + index;
    hdi_watch watch;
    hdi_error_clear(&lane->error);
    if (lane->skip) return;
    watch.ctx = worker == 0 ? h->heat->ctx : NULL;
    watch.stop = &h->stop;
    watch.stage = "solve";
    watch.share = 1.0 / h->k;
    watch.from = watch.share * HDI_CAST(double, h->batch + index);
    lane->status = hdi_watch_look(&watch, 0, &lane->error);
    if (lane->status >= 0) {
        if (h->solver == HD_SOLVER_LANCZOS) lane->status = hdi_heat_lanczos(h->heat, h->t, lane, &watch, &lane->error);
        else lane->status = hdi_heat_poles(&h->heat->fam, h->heat->opts.tol, lane, &watch, &lane->error);
    }
    if (lane->status < 0) HDI_STORE(&h->stop, 1);
}

/* Report and errors of the lanes, in their order: the first failure that is not "another task failed" is the one to tell. */
static hd_status hdi_heat_collect(hdi_heat_call *h, int32_t n) {
    const hd_rational *set = &h->heat->fam.set;
    int32_t i, p;
    for (i = 0; i < n; i++) {
        const hdi_lane *lane = h->lane + i;
        if (lane->status >= 0 || (h->e->status < 0 && h->e->status != HD_ERR_CANCELLED)) continue;
        *h->e = lane->error;
        h->e->column = h->batch + i;
    }
    if (h->e->status == HD_ERR_NOT_CONVERGED) h->rep->residual = h->e->value;   /* what was achieved */
    if (h->e->status < 0) return h->e->status;
    for (i = 0; i < n; i++) {
        const hdi_lane *lane = h->lane + i;
        if (lane->skip) continue;
        if (lane->status > h->rep->status) h->rep->status = lane->status;
        h->rep->iterations += lane->steps;
        for (p = 0; h->solver != HD_SOLVER_LANCZOS && p < set->n_poles; p++) {
            h->rep->pole_iterations[p] += lane->k[p].iterations;
            h->rep->iterations += lane->k[p].iterations;
        }
        hdi_heat_judge(h->heat->lap, lane, set->kind == HD_POLES_OWN && h->solver != HD_SOLVER_LANCZOS, h->rep);
    }
    return HD_OK;
}

/* Lanes, the pole set and its preconditioners. */
static hd_status hdi_heat_prepare(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    hd_rational set;
    int32_t i;
    h->n_lanes = h->k < HDI_LANES ? h->k : HDI_LANES;
    for (i = 0; i < h->n_lanes; i++) {
        if (hdi_lane_make(h->lane + i, heat->lap, heat->ctx, h->e) < 0) return h->e->status;
        if (h->solver == HD_SOLVER_LANCZOS && h->t > 0 && hdi_lane_lanczos(h->lane + i, heat->lap, heat->ctx, h->e) < 0) return h->e->status;
    }
    if (h->t == 0 || h->solver == HD_SOLVER_LANCZOS) return HD_OK;
    if (hdi_heat_set(h, &set) < 0 || hdi_family_set(&heat->fam, &set, h->t, h->e) < 0) return h->e->status;
    h->rep->poles = set.kind;
    h->rep->degree = set.degree;
    h->rep->n_poles = set.n_poles;
    for (i = 0; i < h->n_lanes; i++)
        if (hdi_lane_systems(h->lane + i, &heat->fam, h->e) < 0) return h->e->status;
    return hdi_family_fill(&heat->fam, h->lane->vectors, hdi_lane_stride(&heat->fam), h->e);
}

static hd_status hdi_heat_run(hdi_heat_call *h) {
    int32_t i, n;
    if (h->e->status < 0 || h->k == 0 || hdi_heat_prepare(h) < 0) return hdi_heat_end(h);
    for (h->batch = 0; h->batch < h->k; h->batch += n) {
        n = h->k - h->batch < h->n_lanes ? h->k - h->batch : h->n_lanes;
        for (i = 0; i < n; i++)
            if (hdi_heat_load(h, h->batch + i, h->lane + i) < 0) return hdi_heat_end(h);
        if (h->t > 0) {
            hdi_parallel(h->heat->ctx, n, hdi_heat_task, h);
            if (hdi_heat_collect(h, n) < 0) return hdi_heat_end(h);
        }
        for (i = 0; i < n; i++) hdi_heat_store(h, h->batch + i, h->lane + i);
    }
    return hdi_heat_end(h);
}

/* Sets a leading dimension's default and checks it. */
static size_t hdi_leading(hdi_heat_call *h, size_t ld) {
    const size_t n = HDI_CAST(size_t, h->heat->lap->n);
    if (ld && ld < n) hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: a leading dimension is smaller than the number of vertices");
    return ld ? ld : n;
}

HEATDIFF_API hd_status hd_heat_apply(hd_heat *heat, double t, int32_t k, const double *F, size_t ldf, double *U, size_t ldu,
                                     hd_report *report) {
    hdi_heat_call h;
    if (hdi_heat_begin(&h, heat, HDI_QUERY_FIELD, t, k, report) < 0) return hdi_heat_end(&h);
    if (k > 0 && (!F || !U)) hdi_missing(h.e);
    h.F = F;
    h.U = U;
    h.ldf = hdi_leading(&h, ldf);
    h.ldu = hdi_leading(&h, ldu);
    if (h.e->status >= 0) (void)hdi_fields_check(&h);
    return hdi_heat_run(&h);
}

static hd_status hdi_vertex_check(const hd_laplacian *lap, int32_t v, hd_error *e) {
    if (v >= 0 && v < lap->n) return HD_OK;
    return hdi_fail_face(e, HD_ERR_INDEX, "heat: a source or vertex is not in the mesh", -1, v, lap->n);
}

static hd_status hdi_kernel_begin(hdi_heat_call *h, hd_heat *heat, double t, hd_kernel kernel, int32_t k, hd_report *report) {
    const hdi_query query = kernel == HD_KERNEL_SYMMETRIC ? HDI_QUERY_SYMMETRIC : HDI_QUERY_OPERATOR;
    if (hdi_heat_begin(h, heat, query, t, k, report) < 0) return h->e->status;
    if (kernel == HD_KERNEL_OPERATOR || kernel == HD_KERNEL_SYMMETRIC) return HD_OK;
    return hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: the kernel is operator or symmetric");
}

HEATDIFF_API hd_status hd_heat_columns(hd_heat *heat, double t, hd_kernel kernel, int32_t k, const int32_t *sources, double *U, size_t ldu,
                                       hd_report *report) {
    hdi_heat_call h;
    int32_t q;
    if (hdi_kernel_begin(&h, heat, t, kernel, k, report) < 0) return hdi_heat_end(&h);
    if (k > 0 && (!sources || !U)) hdi_missing(h.e);
    h.sources = sources;
    h.U = U;
    h.ldu = hdi_leading(&h, ldu);
    for (q = 0; q < k && !h.e->status; q++)
        if (hdi_vertex_check(heat->lap, sources[q], h.e) < 0) h.e->column = q;
    return hdi_heat_run(&h);
}

HEATDIFF_API hd_status hd_heat_column(hd_heat *heat, double t, int32_t source, double *u, hd_report *report) {
    return hd_heat_columns(heat, t, HD_KERNEL_OPERATOR, 1, &source, u, 0, report);
}

HEATDIFF_API hd_status hd_heat_entries(hd_heat *heat, double t, hd_kernel kernel, int64_t n_pairs, const int32_t *i, const int32_t *j,
                                       double *values, hd_report *report) {
    hdi_heat_call h;
    hdi_pair *order;
    int64_t q, *begin;
    if (hdi_kernel_begin(&h, heat, t, kernel, 0, report) < 0) return hdi_heat_end(&h);
    if (n_pairs < 0) hdi_fail(h.e, HD_ERR_ARGUMENT, "heat: the number of pairs is negative");
    else if (n_pairs > 0 && (!i || !j || !values)) hdi_missing(h.e);
    for (q = 0; q < n_pairs && !h.e->status; q++)
        if (hdi_vertex_check(heat->lap, i[q], h.e) < 0 || hdi_vertex_check(heat->lap, j[q], h.e) < 0) h.e->row = q;
    order = h.e->status < 0 ? NULL : HDI_TAKE(&h.s, hdi_pair, n_pairs);
    begin = HDI_TAKE(&h.s, int64_t, n_pairs + 1);
    if (h.e->status < 0) return hdi_heat_end(&h);
    for (q = 0; q < n_pairs; q++) {
        order[q].key = HDI_CAST(uint64_t, j[q]);
        order[q].id = q;
    }
    hdi_sort_pairs(order, n_pairs);
    for (q = 0; q < n_pairs; q++)                /* at most n distinct columns */
        if (q == 0 || order[q].key != order[q - 1].key) begin[h.k++] = q;
    begin[h.k] = n_pairs;
    h.order = order;
    h.begin = begin;
    h.rows = i;
    h.values = values;
    return hdi_heat_run(&h);
}

/* ==== [22] closing ==== */

#ifdef __cplusplus
}
#endif

#endif /* HEATDIFF_IMPLEMENTED */
#endif /* HEATDIFF_IMPLEMENTATION */

/* Two licences, take the one you like better.

   MIT License. Copyright (c) 2026 The heatdiff authors.
   Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated documentation files (the
   "Software"), to deal in the Software without restriction, including without limitation the rights to use, copy, modify, merge, publish,
   distribute, sublicense, and/or sell copies of the Software, and to permit persons to whom the Software is furnished to do so, subject to
   the following conditions: The above copyright notice and this permission notice shall be included in all copies or substantial portions
   of the Software. THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
   WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR COPYRIGHT HOLDERS
   BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN
   CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.

   Public domain (www.unlicense.org). This is free and unencumbered software released into the public domain. Anyone is free to copy, modify,
   publish, use, compile, sell, or distribute this software, either in source code form or as a compiled binary, for any purpose, commercial or
   non-commercial, and by any means. THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED
   TO THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS BE LIABLE FOR ANY
   CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE
   SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE. */
