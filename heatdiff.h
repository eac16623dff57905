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
                     [07] sparse  [09] geometry  [10] operators  [14] precond  [15] krylov  [16] rational
                     [17] shifted  [18] heat  [21] api  [22] closing
     Rooms are numbered from the bottom up; each calls only those above it in the file.

   Options (macros)
     HEATDIFF_IMPLEMENTATION   in one file only: compiles the implementation
     HEATDIFF_STATIC           wherever the file is included: all functions are static (implies one user, one file)
     HEATDIFF_API              beside the declarations and the implementation alike: your own linkage attribute
     HEATDIFF_ASSERT(x)        beside the implementation: your own assert; without it, assert() unless NDEBUG
     HEATDIFF_MALLOC(size), HEATDIFF_REALLOC(p, size), HEATDIFF_FREE(p)
                               beside the implementation: all three or none; the default of contexts without allocator
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

/* Memory. alloc and realloc return NULL when there is none; blocks must be aligned to 16 bytes. realloc and free receive
 * the size the block had. Called by one thread at a time for one context. */
typedef struct hd_allocator {
    void *(*alloc)(void *user, size_t size);
    void *(*realloc)(void *user, void *block, size_t old_size, size_t new_size);
    void (*free)(void *user, void *block, size_t size);
    void *user;
} hd_allocator;

/* One task of a parallel loop. worker tells the thread: 0 is the one that called the library. */
typedef void (*hd_task)(void *arg, int64_t index, int32_t worker);

/* The surroundings of a computation. All zeros are good defaults: malloc, no limits, no progress, and OpenMP's threads
 * when compiled with OpenMP (serial otherwise). The context belongs to the caller and must outlive every object made
 * with it; wherever a function takes a context, NULL means one of these defaults. */
typedef struct hd_context {
    hd_allocator allocator;     /* all three functions or none */
    uint64_t byte_limit;        /* most bytes in use at one time; 0: no limit */
    uint64_t allocation_limit;  /* most calls of alloc and realloc; 0: no limit */

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
    int32_t n_zero_area;             /* left out: cross product of two edges exactly zero (or too small for a double) */
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
    double residual;            /* largest |b - A x| / |b| over the systems, in the norm of diag(B)^-1; computed, not recurred */
    double error_rational;      /* bound of |exp's approximation error|_B / |answer|_B */
    double error_solver;        /* bound of the solvers' part, |.|_B / |answer|_B */
    double error_bound_b;       /* the two together */
    double error_bound;         /* bound of the largest error at a vertex, relative to the largest |value| of the answer */
    double mass_drift;          /* |1'B u - 1'B f| / 1'B|f|, 0 when the pair does not conserve heat or the filter is the caller's */
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
 * theta not on (-inf, 0], t >= 0. The report is filled too when the status is HD_ERR_NOT_CONVERGED.
 * Errors HD_ERR_ARGUMENT, HD_ERR_NOT_CONVERGED, HD_ERR_BREAKDOWN, HD_ERR_MEMORY, HD_ERR_CANCELLED. HD_WARN_ACCURACY. */
HEATDIFF_API hd_status hd_shifted_solve(const hd_laplacian *lap, double t, hd_c64 theta, const hd_c64 *rhs, hd_c64 *x,
                                        const hd_solve_opts *opts, hd_solve_report *report, hd_error *err);

/* ---- heat ---- */

typedef struct hd_heat hd_heat;

/* A plan for heat on lap, which must outlive it. Decides and allocates what does not depend on t. */
HEATDIFF_API hd_status hd_heat_create(hd_heat **out, const hd_laplacian *lap, const hd_heat_opts *opts, hd_error *err);
HEATDIFF_API void hd_heat_free(hd_heat *heat);  /* NULL is fine */

/* U = K_t F.
 * t      >= 0, unit length^2 (t = 0 copies F)
 * F, U   n x k doubles, column-major, columns ldf and ldu apart (0: n); U may be F
 * Cost   per field and pole one iterative solve, poles in parallel
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
