/* heatdiff.h - heat kernels and diffusion distances on surfaces, without eigenvectors

   ==== [A] opening ====

   A surface is a pair of sparse matrices (L, B). L is the stiffness matrix, symmetric positive semi-definite.
   B is the mass matrix, symmetric positive definite. Heat f diffuses as K_t f with the heat kernel matrix
   K_t = exp(-t B^-1 L). This file builds (L, B) from a mesh or from points, and applies K_t through a
   rational approximation of the exponential,

       K_t f = a0 f - sum_i a_i (t L + theta_i B)^-1 B f,

   which takes a handful of sparse complex-symmetric systems. No eigenvectors are computed and none are left
   out. Every answer comes with a bound of its error. The method is that of G. Patane and M. Spagnuolo, "Heat
   diffusion kernel and distance on surface meshes and point sets", Computers & Graphics 37, 2013, called the
   paper below.

   In one C or C++ file:                             Everywhere else:

       #define HEATDIFF_IMPLEMENTATION                   #include "heatdiff.h"
       #include "heatdiff.h"

   and link with -lm. Give the implementation a file of its own: it takes some 12 s to compile at -O2, the
   declarations take none. Two calls make a heat kernel of a triangle mesh:

       hd_laplacian *lap = NULL;  hd_heat *heat = NULL;  hd_error err;
       if (hd_laplacian_triangles(&lap, xyz, n, tri, n_tri, NULL, &err) < 0) return fail(&err);
       if (hd_heat_create(&heat, lap, NULL, &err) < 0) return fail(&err);
       hd_heat_column(heat, HD_KERNEL_OPERATOR, 100 * lap->h * lap->h, source, u, NULL, NULL);   u[n] = K_t e_source
       hd_heat_free(heat);  hd_laplacian_free(lap);

   Conventions
     sign     L is positive semi-definite. This is minus the usual cotangent matrix of libigl. The rows of L
              sum to zero.
     units    L has no unit. B is an area, and so is t (length squared). k_t = K_t B^-1 is 1/area. If B = I
              (kind `cot`), t is a pure number.
     t        lap->h is the mean edge length, and times are usually chosen as t = c h^2. Below t = h^2 heat
              sees the mesh rather than the surface.
     kernels  K_t is not symmetric. Its column i diffuses the indicator of vertex i, whose heat is the mass
              b_i. k_t = K_t B^-1 is symmetric, the pointwise heat kernel k_t(x,y). Its column i diffuses one
              unit of heat placed at vertex i.
     border   natural (Neumann): no heat leaves through a border. Separate components exchange no heat at all.
     mass     Vertices without mass (in no face, or only in faces of zero area) are inert: K_t leaves their
              values as they are.
     norm     |f|_B = sqrt(f' B f). Errors are relative in this norm or relative to the largest value; each
              report field says which.

   Contents
     Declarations
     [A] opening     what the library computes, conventions, options, limits
     [B] base        version, linkage, status and error, context, sparse matrix
     [C] options     option structs (zeros are defaults), report structs, the Laplacian
     [D] functions   by task: matrices, operators, neighbours, pole sets, solvers, heat, geodesic distance

     Implementation, from the bottom up: a room calls only rooms above it in the file
     [00] platform   compilers, the C library, OpenMP, configuration macros
     [01] scalar     minima and maxima, checked sizes, complex arithmetic
     [02] error      filling hd_error
     [03] memory     counted allocation and scopes that free work arrays
     [04] context    progress, cancelling, parallel loops
     [05] arrays     prefix sums, sorting, union-find
     [06] vectors    dot products and norms, small dense eigenproblems and least squares
     [07] kernels    dense fronts, real and in lanes of four complex matrices, for each instruction set
     [08] sparse     compressed rows: build, check, transpose, multiply, renumber
     [09] spatial    k-d tree: nearest neighbours and radius search
     [10] geometry   triangles: checks, areas, cotangents, edges, defects
     [11] intrinsic  intrinsic Delaunay triangulations and the tufted cover
     [12] operators  the pair (L, B) of triangles, polygons, points and the caller's own matrices
     [13] degree     orderings by minimum degree, breadth-first orderings
     [14] dissection nested dissection of meshes in space
     [15] analysis   elimination tree, supernodes, plan of memory
     [16] schedule   tasks of a factorisation and their order
     [17] direct     multifrontal L D L' and triangular solves
     [18] selinv     selected inversion: entries of the inverse, quadratic forms
     [19] precond    Jacobi, SSOR and incomplete L D L'
     [20] iterative  COCG, COCR, CS-MINRES
     [21] rational   pole sets: tables, evaluation, sets shared by many times
     [22] poles      the family t L + theta_i B for one right-hand side, error bounds
     [23] lanczos    Lanczos for the exponential and shift-and-invert
     [24] plan       hd_heat: choice of method, kept factors and bases, the ledger of errors
     [25] kernel     fields, columns, entries, diagonals, edges
     [26] diffusion  diffusion distances, pairs, sampling
     [27] geodesic   the heat method
     [28] api        argument checks, defaults, lifetimes, bodies of the public functions
     [29] closing    end of the implementation, licence

   Options (macros)
     Beside the implementation only:
     HEATDIFF_IMPLEMENTATION   compiles the implementation; define it in one file
     HEATDIFF_ASSERT(x)        your own assert; default: assert() unless NDEBUG
     HEATDIFF_MALLOC(size), HEATDIFF_FREE(p)
                               used by contexts without an allocator; define both or none
     HEATDIFF_NO_OPENMP        no OpenMP, even if the compiler has it on
     HEATDIFF_FILENAME         "name" of this file, which includes itself for AVX2 and AVX-512. It is needed
                               only where that is neither heatdiff.h nor what the compiler says
                               (__FILE_NAME__)
     HEATDIFF_NO_SIMD          plain C only, no kernels for AVX2 and AVX-512
     HEATDIFF_USE_BLAS         dgemm of a BLAS (32-bit integers) for large fronts of real factors, where only
                               plain C kernels exist. It is twice as fast as those. The kernels for AVX2 and
                               AVX-512 are faster than OpenBLAS and stay in use
     HEATDIFF_NO_LARGE_PAGES   no madvise for large pages on Linux
     Wherever the file is included, the same everywhere:
     HEATDIFF_STATIC           all functions are static, for a single file that uses them
     HEATDIFF_API              your own linkage attribute
     No macro changes a public type or prototype.

   Limits
     Vertices and faces are counted in 32 bits, non-zeros and offsets in 64. The library prints nothing, opens
     no file and never exits.
     Arithmetic must be that of doubles (FLT_EVAL_METHOD 0). x87 registers keep more digits now and then: results
     are as accurate, but neither bits nor bounds of the error near rounding are promised. On 32-bit x86 compile
     with -msse2 -mfpmath=sse. -ffast-math takes away the same promises. Coordinates, matrices, fields and times
     that are not finite are still refused then, options are not.

   Threads
     There is no global or thread-local state. One object serves one thread at a time, and so does one
     context, because it counts memory. Two threads may work at once if they share no object and no context.
     One exception: plans read their Laplacian and never write to it. So several plans in several threads may
     share one Laplacian if every plan has a context of its own (hd_heat_opts.context). Without one, a plan
     uses the Laplacian's context. If you set allocators, they must allow calls from several threads.

   Licence: MIT or public domain, at your choice; see the end of the file. */

#ifndef HEATDIFF_H
#define HEATDIFF_H

/* ==== [B] base ==== */

#include <stddef.h>
#include <stdint.h>

#define HD_VERSION_MAJOR 0
#define HD_VERSION_MINOR 1
#define HD_VERSION_PATCH 0
/* Versions compare as numbers: HD_VERSION >= HD_MAKE_VERSION(0, 2, 0). */
#define HD_MAKE_VERSION(major, minor, patch) ((major) * 1000000 + (minor) * 1000 + (patch))
#define HD_VERSION HD_MAKE_VERSION(HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH)

#ifndef HEATDIFF_API
#if defined(HEATDIFF_STATIC) && (defined(__GNUC__) || defined(__clang__))
#define HEATDIFF_API static __attribute__((unused))   /* nobody calls all of them */
#elif defined(HEATDIFF_STATIC)
#define HEATDIFF_API static
#else
#define HEATDIFF_API extern
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A complex number. Same layout as C99 double complex and std::complex<double>. */
typedef struct hd_c64 { double re, im; } hd_c64;

/* Zero is success, negative is an error, positive means "usable, but read the report". One list makes codes
 * and texts. */
#define HD_STATUS_LIST(X)                                                                         \
    X(HD_OK, 0, "done")                                                                           \
    X(HD_WARN_ACCURACY, 1,                                                                        \
      "done, but the bound of the error is above the tolerance, or says little")                  \
    X(HD_ERR_ARGUMENT, -1, "an argument or option is out of its range")                           \
    X(HD_ERR_MEMORY, -2, "out of memory")                                                         \
    X(HD_ERR_MEMORY_LIMIT, -3, "the byte or allocation limit of the context is reached")          \
    X(HD_ERR_TOO_LARGE, -4, "a size does not fit its integer type")                               \
    X(HD_ERR_CANCELLED, -5, "cancelled by the progress callback")                                 \
    X(HD_ERR_NOT_CONVERGED, -6, "the iteration did not reach the tolerance")                      \
    X(HD_ERR_INDEX, -7, "an index is out of range")                                               \
    X(HD_ERR_NOT_FINITE, -8, "a value is not finite")                                             \
    X(HD_ERR_NOT_SYMMETRIC, -9, "a matrix is not symmetric")                                      \
    X(HD_ERR_NOT_POSITIVE, -10, "L is not positive semi-definite, or B is not positive definite") \
    X(HD_ERR_STRUCTURE, -11, "a sparse matrix is not well formed")                                \
    X(HD_ERR_EMPTY, -12, "nothing is left to compute on: no vertex has mass")                     \
    X(HD_ERR_BREAKDOWN, -13, "the iteration broke down")

typedef enum hd_status {
#define HD_STATUS_ENUM(name, value, text) name = value,
    HD_STATUS_LIST(HD_STATUS_ENUM)
#undef HD_STATUS_ENUM
    HD_STATUS_FORCE_INT = 0x7fffffff
} hd_status;

/* What went wrong, and where in the caller's data. Places that do not apply are -1. */
typedef struct hd_error {
    hd_status status;
    char text[160];        /* one line for people, without the numbers below */
    int64_t face, vertex;  /* ids as the caller numbers them */
    int64_t row, column;   /* of a matrix or of a field */
    int64_t pole;          /* index in the rational set, or of the matrix in a complex factorisation */
    double value;          /* the offending value; 0 if there is none */
} hd_error;

/* What a progress callback returns. Any other value is HD_ERR_ARGUMENT. Neither value is 0 or 1, so that a
 * callback of the wrong type is noticed. */
typedef enum hd_progress { HD_PROGRESS_CONTINUE = 0x100, HD_PROGRESS_CANCEL = 0x200 } hd_progress;

/* Memory functions. alloc returns NULL if there is no memory; its blocks must be aligned to 8 bytes. free
 * receives the size that the block was allocated with. Blocks are never resized, so there is no realloc. The
 * library calls both functions from the calling thread only. */
typedef struct hd_allocator {
    void *(*alloc)(void *user, size_t size);
    void (*free)(void *user, void *block, size_t size);
    void *user;
} hd_allocator;

/* One task of a parallel loop. worker numbers the threads; 0 is the thread that called the library. */
typedef void (*hd_task)(void *arg, int64_t index, int32_t worker);

/* Instruction sets of the dense kernels. GCC and Clang on x86-64 compile several versions; other compilers
 * and processors use plain C. Results of two instruction sets agree up to rounding. Within one instruction
 * set results are the same to the last bit for any number of threads. */
typedef enum hd_simd {
    HD_SIMD_AUTO = 0,           /* the best set that the processor has */
    HD_SIMD_NONE,               /* plain C */
    HD_SIMD_AVX2,               /* AVX2 with FMA, if the processor has it */
    HD_SIMD_AVX512              /* AVX-512, if the processor has it */
} hd_simd;

/* Memory, progress and threads of a computation. All zeros are good defaults: malloc, no limits, no progress,
 * and OpenMP's threads if compiled with OpenMP. The context belongs to the caller and must outlive every
 * object made with it. Wherever a function takes a context, NULL means one with these defaults. */
typedef struct hd_context {
    hd_allocator allocator;     /* both functions or none */
    uint64_t byte_limit;        /* most bytes in use at one time; 0: no limit */
    uint64_t allocation_limit;  /* most calls of alloc; 0: no limit */

    /* Called now and then during long work, by the calling thread only. done runs from 0 to 1 within a stage.
     * If it cancels, the running function frees everything and returns HD_ERR_CANCELLED. The stages:
     *   "neighbours"    search of neighbours among points
     *   "assemble"      building L and B
     *   "flip edges"    intrinsic Delaunay triangulation
     *   "order"         elimination order
     *   "analyse"       symbolic analysis
     *   "factor"        numerical factorisation
     *   "invert"        selected inversion
     *   "precondition"  preconditioners
     *   "solve"         solves and iterations
     *   "sample"        farthest points */
    hd_progress (*progress)(void *user, const char *stage, double done);
    void *progress_user;

    /* Runs task(arg, i, worker) for every i in [0, n_tasks), in any order, and returns when all tasks are
     * done. The calling thread is worker 0; other threads have numbers of their own. NULL: OpenMP if compiled
     * with it, else serial. Results depend neither on this function nor on the number of threads. */
    void (*parallel_for)(void *user, int64_t n_tasks, hd_task task, void *arg);
    void *parallel_user;
    int32_t threads;            /* of OpenMP: 0 for all, 1 for serial; ignored if parallel_for is set */
    hd_simd simd;

    /* Filled by the library. */
    uint64_t bytes_in_use, bytes_peak, allocations;
} hd_context;

/* A sparse matrix by compressed rows. In every row the columns ascend and occur once. val may be NULL in a
 * pattern. Matrices made by the library are freed with hd_csr_free. Your own arrays stay yours. */
typedef struct hd_csr {
    int32_t n_rows, n_cols;
    int64_t nnz;
    int64_t *row_ptr;      /* [n_rows + 1] */
    int32_t *col;          /* [nnz] */
    double *val;           /* [nnz] */
} hd_csr;

/* ==== [C] options and reports ==== */
/* Options are structs whose zeros mean defaults; a NULL pointer means all defaults. begin_zero and end_zero
 * must stay zero: they tell a cleared struct from an uninitialised one. */

typedef enum hd_laplacian_kind {
    /* fem for triangles, polygon for polygons, voronoi-exp for points. hd_laplacian.kind tells which. */
    HD_LAPLACIAN_DEFAULT = 0,
    /* Cotangent L, linear finite-element B: each triangle adds area/6 on the diagonal, area/12 off it. */
    HD_LAPLACIAN_FEM,
    /* Cotangent L, B diagonal: mixed Voronoi areas (Meyer, Desbrun, Schroeder, Barr 2003). */
    HD_LAPLACIAN_VORONOI_COT,
    /* Cotangent L, B = I (Pinkall, Polthier 1993). */
    HD_LAPLACIAN_COT,
    /* Faces of any number of corners k, planar or not. B is diagonal: each face gives area/k to each of its
     * corners (Alexa, Wardetzky 2011). */
    HD_LAPLACIAN_POLYGON,
    /* Points: L_ij = -v_i v_j exp(-|p_i - p_j|^2 / 4s) / (4 pi s^2) and B = diag(v). v_i is the area of the
     * Voronoi cell of point i in its tangent plane, s is the bandwidth (Liu, Prabhakaran, Guo 2012). */
    HD_LAPLACIAN_VORONOI_EXP,
    /* Points: L_ij = -exp(-|p_i - p_j|^2 / 4s) / (4 pi n s^2) and B = I (Belkin, Niyogi 2008). For evenly
     * spread samples B^-1 L tends to Laplacian/area, so the unit of t is an area times a squared length. */
    HD_LAPLACIAN_EXP,
    HD_LAPLACIAN_MATRICES       /* the caller's own two matrices */
} hd_laplacian_kind;

typedef struct hd_laplacian_opts {
    int32_t begin_zero;
    hd_laplacian_kind kind;     /* ignored by hd_laplacian_matrices */
    hd_context *context;
    /* Polygons: weight of the stabilising term for face functions that the gradient cannot see. It has no
     * effect on triangles; larger values stiffen faces with more corners. Default 1, at most 1e100. */
    double lambda;
    /* Points: s of the weights, a squared length. Default: from the sampling, see hd_laplacian_points. */
    double bandwidth;
    /* Points: exponentials below this value are left out, in (0, 1). Default 1e-8. */
    double weight_cut;
    /* Triangles: 1: edges are flipped along the surface until the triangulation is Delaunay. Then no
     * cotangent weight is negative, except on boundary edges opposite to an obtuse angle. Surfaces that are
     * not manifold or not orientable are covered twice. */
    int32_t intrinsic_delaunay;
    /* Triangles: 1: the same on the tufted cover, where a second sheet is glued to the boundary. Then no
     * weight is negative on any mesh. */
    int32_t tufted;
    /* With intrinsic_delaunay or tufted: all edges are lengthened by one small number, so that every triangle
     * satisfies the triangle inequality with a margin of mollify times the mean edge length. Default 1e-5; at
     * most 1; negative: lengths stay as they are. */
    double mollify;
    /* Points: number of nearest neighbours that determine the tangent plane and the cell or star of a point,
     * 6..128. Default 30. */
    int32_t neighbours;
    int32_t end_zero;
} hd_laplacian_opts;

/* What was found in a mesh. Nothing here is an error: faces that cannot be used are left out and counted. */
typedef struct hd_mesh_report {
    int32_t n_faces;                 /* given */
    int32_t n_faces_used;            /* assembled */
    int32_t n_repeated_corner;       /* left out: two corners are the same vertex */
    /* Left out: the cross product of two edges is exactly zero, or an area or cotangent overflows. Polygons:
     * fewer than three corners, or a zero vector area (for more than three corners, up to rounding). */
    int32_t n_zero_area;
    /* Left out: same corners as an earlier face. Polygons: in the same cyclic order, in either direction. */
    int32_t n_repeated_face;
    int64_t n_edges;                 /* distinct edges of the faces used */
    int64_t n_boundary_edges;        /* with one face */
    int64_t n_nonmanifold_edges;     /* with three faces or more: their weights are summed */
    int64_t n_misoriented_edges;     /* with two faces that run along the edge in the same direction */
    int32_t n_boundary_loops;        /* connected sets of boundary edges */
    int32_t n_inert;                 /* vertices without mass */
    /* Edges whose cotangent weight is negative. They are legitimate, but the maximum principle does not hold
     * then. Polygons: pairs of vertices, joined by edges or diagonals, whose entry of L is positive. Nearly
     * every face with more than three corners has some. */
    int64_t n_negative_weights;
    double smallest_angle;           /* in radians, of the faces used; polygons: of convex corners */

    /* With intrinsic_delaunay or tufted; else zero. All fields above, except n_negative_weights, describe the
     * faces as they were given. */
    int32_t n_sheets;                /* 1, or 2: the surface is covered twice */
    int32_t n_mollified;             /* faces that needed mollification */
    double mollify_epsilon;          /* added to the length of every edge */
    int64_t n_flips;                 /* on all sheets */
    int64_t n_not_delaunay;          /* edges that could not be flipped because of rounding */
    int64_t n_self_edges;            /* edges from a vertex to itself after the flips; weightless */
    double smallest_intrinsic_angle; /* after the flips, in radians */
} hd_mesh_report;

/* What was found in a point set, and what was chosen for it. Nothing here is an error. A place is a position
 * that holds one or more points. */
typedef struct hd_point_report {
    double bandwidth;                /* s of the exponential weights */
    double weight_cut, cut_radius;   /* exponentials below weight_cut, beyond cut_radius, are 0 */
    int32_t neighbours;              /* used for tangent planes and cells */
    int32_t n_coincident;            /* points at the place of an earlier point: they share its cell */
    int32_t n_isolated;              /* points without another within cut_radius: own components */
    int32_t n_no_area;               /* points whose neighbours lie on a line: inert for voronoi-exp */
    int32_t n_border;                /* places whose cell ends at the hull of their neighbours */
    int32_t most_in_row;             /* most non-zeros in a row of L, diagonal included */
    /* Places whose nearest neighbours spread across their plane more than 0.45 times as far as along it. This
     * happens at sharp creases, rims and tips, in strong noise, and where two sheets of the surface are
     * closer than about 1.5 spacings. Planes are uncertain there, and heat may cross to the other sheet. */
    int32_t n_not_flat;
} hd_point_report;

/* A discrete surface: the pair (L, B) on one pattern. The library makes and frees it. Read all fields freely,
 * change none. Rows are the vertices that have mass, in the caller's order. */
typedef struct hd_laplacian {
    int32_t n;                  /* vertices of the caller */
    int32_t n_active;           /* rows: vertices with mass */
    int32_t n_components;       /* connected components of the rows */
    hd_laplacian_kind kind;
    /* Mean length of the distinct edges, before any flip. Points: mean distance of a place to the nearest
     * other place. Matrices: as the caller gave it. */
    double h;
    /* Area of the faces used, before any flip. Points: of their cells or stars. Matrices: 1'B1. */
    double area;
    hd_csr L;                   /* n_active x n_active, every diagonal entry present */
    double *B;                  /* [L.nnz] values of B on the pattern of L, or NULL: B = diag(mass) */
    double *mass;               /* [n_active] b = B 1, the masses of the vertices */
    double *b_diag;             /* [n_active] diagonal of B; the same array as mass if B is diagonal */
    int32_t *vertex;            /* [n_active] row -> vertex */
    int32_t *row;               /* [n] vertex -> row, -1 without mass */
    int32_t *component;         /* [n_active] row -> component, numbered by first vertices */
    double *xyz;                /* [3 n_active] coordinates of the rows; NULL for matrices */
    double *component_mass;     /* [n_components] sum of mass */
    /* B >= b_ratio diag(B): 1 if B is diagonal, 1/2 for fem (0.42 if some edge joins a vertex to itself).
     * Matrices: proven by Gershgorin's circles or by factorisations. 0: unknown. */
    double b_ratio;
    /* 1: L 1 = 0, so that heat is conserved. Always so for meshes and points. Matrices: up to 4 DBL_EPSILON
     * sum_j |L_ij| in each row. Rounding in the row sums is then treated as zero, and t may be large. */
    int32_t conserves;
    /* Matrices and points: only n_inert. Tufted points: the triangles of their stars. */
    hd_mesh_report mesh;
    /* Zeros for meshes and matrices. Tufted points: n_not_flat; if neighbours were searched, also
     * neighbours and n_coincident. */
    hd_point_report points;
    hd_context *context;
} hd_laplacian;

typedef enum hd_pole_kind {
    HD_POLES_DEFAULT = 0,
    /* Best uniform (r,r) approximations, r = 1..14: smallest max |exp - c| on (-inf, 0]. */
    HD_POLES_UNIFORM,
    /* a0 = 0, c(0) = 1, smallest max (1 + |x|) |exp - c|, r = 2..14. The error is relative to the kernel's
     * own size, and heat is conserved up to rounding. */
    HD_POLES_KERNEL,
    HD_POLES_OWN,               /* the caller's */
    /* r = 2..14, as kernel sets but with a weight that rises to five times (1 + |x|) at large |x|. Made for
     * diagonals and distances. */
    HD_POLES_DIAGONAL
} hd_pole_kind;

enum { HD_MAX_POLES = 32 };

/* c(x) = a0 + sum_real a/(x - theta) + 2 Re sum_pairs a/(x - theta) for x = -t lambda <= 0. Of each conjugate
 * pair only the pole with Im theta > 0 is listed. A pole with Im theta = 0 is real and counts once. No pole
 * may lie on (-inf, 0]. */
typedef struct hd_rational {
    hd_pole_kind kind;
    int32_t degree;             /* real poles + 2 pairs */
    int32_t n_poles;            /* listed, at most HD_MAX_POLES */
    double a0;
    hd_c64 theta[HD_MAX_POLES];
    hd_c64 a[HD_MAX_POLES];
    /* In a set of your own, either error may be 0: unknown. If both are 0, bounds in reports are for c itself
     * rather than for exp. */
    double max_error;           /* max |exp(x) - c(x)| on (-inf, 0] */
    double max_weighted_error;  /* max (1 + |x|) |exp(x) - c(x)|; 0: unbounded or unknown */
} hd_rational;

typedef enum hd_method {
    HD_METHOD_AUTO = 0,         /* the cheapest by a model of flops and bytes, within the byte limit */
    HD_METHOD_ITERATIVE,        /* a Krylov method for each pole, or Lanczos for the exponential */
    HD_METHOD_DIRECT,           /* all poles factorised in one sweep: for many fields or columns */
    HD_METHOD_KRYLOV            /* shift-and-invert Lanczos: one real factor, for few fields or many times */
} hd_method;

/* The order in which a factorisation eliminates rows. */
typedef enum hd_ordering {
    HD_ORDERING_AUTO = 0,           /* nested dissection for large meshes, else minimum degree */
    HD_ORDERING_MINIMUM_DEGREE,     /* approximate minimum degree (Amestoy, Davis, Duff 1996) */
    HD_ORDERING_NESTED_DISSECTION,  /* cuts the mesh in space; needs coordinates */
    HD_ORDERING_OWN                 /* the caller's permutation */
} hd_ordering;

typedef enum hd_solver {
    HD_SOLVER_AUTO = 0,         /* Lanczos for small t if it costs less, else cocg */
    /* Conjugate orthogonal CG (van der Vorst, Melissen 1990); CG for real poles. */
    HD_SOLVER_COCG,
    /* Conjugate orthogonal conjugate residuals (Sogabe, Zhang 2007); CG for real poles. */
    HD_SOLVER_COCR,
    /* CS-MINRES (Choi 2013), which is MINRES on the Saunders process. Plain MINRES needs a Hermitian matrix.
     * For complex theta, t L + theta B is not Hermitian, and plain MINRES converges to a wrong result.
     * CS-MINRES needs a real positive definite preconditioner: here that of t L + |theta| B. */
    HD_SOLVER_MINRES,
    HD_SOLVER_LANCZOS           /* for the exponential, no poles: about 1.1 sqrt(t lambda_max) steps */
} hd_solver;

typedef enum hd_precond {
    HD_PRECOND_AUTO = 0,        /* mildl */
    HD_PRECOND_NONE,
    HD_PRECOND_JACOBI,          /* the diagonal */
    HD_PRECOND_SSOR,            /* symmetric successive over-relaxation, omega = 1 */
    HD_PRECOND_ILDL,            /* incomplete L D L' on the pattern of L, no fill */
    HD_PRECOND_MILDL            /* the same, 97 % of dropped fill goes to the diagonal (Gustafsson 1978) */
} hd_precond;

typedef struct hd_heat_opts {
    int32_t begin_zero;
    hd_method method;
    hd_solver solver;
    hd_precond precond;
    hd_pole_kind poles;         /* default: kernel for columns and entries, uniform for fields */
    /* Default: chosen so that the rational error relative to the answer is below about 1e-8 (direct: degree 9
     * and 3e-8). */
    int32_t degree;
    /* A set of your own, for any filter of the spectrum. It is copied. poles and degree are then ignored, and
     * Lanczos is not used. */
    const hd_rational *rational;
    double tol;                 /* the solver's part of |error|_B / |answer|_B; default 1e-9 */
    int32_t max_iterations;     /* per system; default 20000 */
    hd_ordering ordering;       /* of the methods that factorise */
    /* [n] with HD_ORDERING_OWN: perm[k] is the vertex eliminated k-th. Vertices without mass may stand
     * anywhere. It is copied. */
    const int32_t *perm;
    hd_context *context;        /* default: the Laplacian's */
    int32_t end_zero;
} hd_heat_opts;

typedef enum hd_kernel {
    HD_KERNEL_OPERATOR = 0,     /* K_t = exp(-t B^-1 L) */
    HD_KERNEL_SYMMETRIC         /* k_t = K_t B^-1 */
} hd_kernel;

typedef enum hd_distance_kind {
    /* d^2 = k_2t(i,i) - 2 k_2t(i,j) + k_2t(j,j) (Coifman, Lafon 2006). Intrinsic; the usual definition. */
    HD_DISTANCE_CLASSICAL = 0,
    /* d^2 = (e_i - e_j)' B K_2t (e_i - e_j), eq. (6) of the paper. Not intrinsic: for large t it tends to
     * |b_i - b_j|/sqrt(area). */
    HD_DISTANCE_WEIGHTED,
    /* d^2 = sum_l (x_l(i) - x_l(j))^2 / lambda_l over the eigenpairs of (L, B) with lambda_l > 0: the
     * effective resistance. It needs neither a time nor poles. */
    HD_DISTANCE_COMMUTE,
    /* The same with lambda_l^2 (Lipman, Rustamov, Funkhouser 2010). */
    HD_DISTANCE_BIHARMONIC
} hd_distance_kind;

/* How a part of an error bound is known. For several answers the report holds the largest number. */
typedef enum hd_evidence {
    HD_EVIDENCE_NONE = 0,       /* the part does not apply */
    HD_EVIDENCE_PROVEN,         /* a theorem, applied to norms and residuals of this answer */
    HD_EVIDENCE_MEASURED,       /* measured at some columns or solves of this answer, assumed for all of it */
    HD_EVIDENCE_ESTIMATED       /* a model of rounding */
} hd_evidence;

/* What happened, and how large the error can be. For several fields, columns or times: the worst of them.
 *
 * The error bound has three parts: the rational approximation of exp, the iterative solver, and rounding.
 * error_bound is their sum. It bounds the largest error of any value returned, relative to the largest
 * |value| returned: of each field, column and time, or of the whole list for entries and pairs. Each part has
 * its evidence. HD_EVIDENCE_NONE means that the part does not apply, and that the other parts are complete
 * without it. If the bound is above 1e-2 it says little, and the status is HD_WARN_ACCURACY. */
typedef struct hd_report {
    hd_status status;
    hd_error error;             /* filled if status < 0 */
    hd_method method;
    const char *reason;         /* why this method, in a few words */
    hd_solver solver;           /* HD_SOLVER_AUTO for direct, HD_SOLVER_LANCZOS for krylov */
    hd_precond precond;         /* HD_PRECOND_NONE for Lanczos and direct */
    hd_pole_kind poles;         /* HD_POLES_DEFAULT for Lanczos, which has none */
    int32_t degree;             /* 0 for Lanczos */
    int32_t n_poles;
    int64_t iterations;         /* total over systems and fields; Lanczos: steps */
    int64_t pole_iterations[HD_MAX_POLES];  /* per pole, summed over the fields */
    hd_ordering ordering;       /* of the factorisation; HD_ORDERING_AUTO without one */
    int64_t factor_nnz;         /* non-zeros of the factor L, diagonal included; 0 without a factorisation */
    double factor_flops;        /* real floating-point operations of all factorisations that the plan holds */
    double growth;              /* largest |pivot| / largest |diagonal entry|, see hd_ldl_report */
    /* Largest |b - A x| / |b| over the systems, in the norm of diag(B)^-1, computed from x. 0 for Lanczos.
     * After HD_ERR_NOT_CONVERGED: of the system that failed; for Lanczos its bound of the relative error. */
    double residual;
    double error_bound;         /* the sum of the next three */
    double error_rational, error_solver, error_rounding;
    hd_evidence evidence_rational, evidence_solver, evidence_rounding;
    /* Fields and columns: bound of |error|_B / |answer|_B. Otherwise HUGE_VAL and HD_EVIDENCE_NONE. */
    double error_bound_b;
    hd_evidence evidence_b;
    /* Diagonals, distances, pairs: bound of the largest error relative to the value itself. HUGE_VAL if it
     * does not apply, or if a value is zero that need not be zero. */
    double error_relative;
    double smallest;            /* diagonals and distances: the smallest value that is not zero */
    int64_t n_lost;             /* distances with at most about one sure digit, see hd_heat_distance */
    /* |1'B u - 1'B f| / 1'B|u|. 0 if L does not conserve heat or the filter is the caller's. */
    double mass_drift;
} hd_report;

typedef enum hd_geodesic_mass {
    HD_GEODESIC_MASS_BARYCENTRIC = 0,   /* a third of each face to each corner */
    HD_GEODESIC_MASS_VORONOI            /* mixed Voronoi areas, as in HD_LAPLACIAN_VORONOI_COT */
} hd_geodesic_mass;

typedef struct hd_geodesic_opts {
    int32_t begin_zero;
    /* How long heat flows, unit length^2. Larger values give smoother and less accurate distances. Default
     * h^2, with h the mean edge length. */
    double t;
    /* The diagonal of B. It determines how fast heat fades, and has little influence on the distance. */
    hd_geodesic_mass mass;
    hd_ordering ordering;       /* of both factorisations */
    /* [n] with HD_ORDERING_OWN: perm[k] is the vertex eliminated k-th, those without mass anywhere. */
    const int32_t *perm;
    hd_context *context;
    int32_t end_zero;
} hd_geodesic_opts;

/* What happened in a call. For several columns: the worst of them. */
typedef struct hd_geodesic_report {
    hd_status status;           /* HD_WARN_ACCURACY: a residual is above 1e-6 */
    hd_error error;             /* filled if status < 0 */
    double t, h;
    int32_t n_components;
    int32_t n_stages;           /* heat solves for a column: several where heat faded below 1e-200 */
    hd_ordering ordering;
    int64_t factor_nnz;         /* of each of the two factors, diagonal included */
    double factor_flops;        /* of both */
    /* |b - A x| / |b| of (L + B/t) u and of L phi. They tell how well the systems are solved, and nothing
     * about the error of the method itself. */
    double residual_heat;
    double residual_distance;
} hd_geodesic_report;

/* ==== [D] functions ==== */
/* Common to all functions. Arguments come in this order: the object that is made, or that the function works
 * on; what is asked for; the input; the output; report; err. A count stands before its array, but for meshes and
 * points, which are xyz, n. Functions return hd_status. After an error nothing
 * is left allocated, *out is unchanged, and output arrays hold unspecified numbers.
 * err and report may be NULL. */

/* ---- statuses ---- */

HEATDIFF_API const char *hd_status_name(hd_status status);  /* "HD_ERR_MEMORY" */
HEATDIFF_API const char *hd_status_text(hd_status status);  /* "out of memory" */

/* ---- sparse matrices ---- */

/* A from triplets (i, j, v) in any order. Values at the same place are summed in the order given.
 * v      [n_triplets], or NULL: a pattern
 * Errors HD_ERR_INDEX (row: index of the triplet), HD_ERR_NOT_FINITE (row: index of the triplet; if a sum
 *        overflows, its row and column)
 * Cost   O(n_rows + n_cols + n_triplets) */
HEATDIFF_API hd_status hd_csr_from_triplets(hd_csr *out, int32_t n_rows, int32_t n_cols,
                                            int64_t n_triplets, const int32_t *i,
                                            const int32_t *j, const double *v,
                                            hd_context *ctx, hd_error *err);

/* Checks offsets, indices, their order, and that values are finite. symmetric = 1: also checks A = A' up to
 * 1e-12 of the larger entry of each pair.
 * Errors HD_ERR_STRUCTURE, HD_ERR_INDEX, HD_ERR_NOT_FINITE, HD_ERR_NOT_SYMMETRIC, with row and column
 * Cost   O(nnz) */
HEATDIFF_API hd_status hd_csr_check(const hd_csr *a, int32_t symmetric, hd_context *ctx,
                                    hd_error *err);

/* out = A'. Cost O(nnz). */
HEATDIFF_API hd_status hd_csr_transpose(hd_csr *out, const hd_csr *a, hd_context *ctx,
                                        hd_error *err);

/* out = A B (Gustavson 1978).
 * Errors HD_ERR_NOT_FINITE (row, column: an entry overflows)
 * Cost   O(flops), and sorting the rows */
HEATDIFF_API hd_status hd_csr_product(hd_csr *out, const hd_csr *a, const hd_csr *b,
                                      hd_context *ctx, hd_error *err);

/* out = P A P' for a square A: row i of out is row perm[i] of A, and columns likewise.
 * Errors HD_ERR_INDEX if perm is not a permutation */
HEATDIFF_API hd_status hd_csr_permute(hd_csr *out, const hd_csr *a, const int32_t *perm,
                                      hd_context *ctx, hd_error *err);

/* y = A x. x [n_cols] and y [n_rows] must not overlap. ctx is for threads. A checked matrix never fails. */
HEATDIFF_API void hd_csr_apply(const hd_csr *a, const double *x, double *y, hd_context *ctx);

/* Frees what the library allocated with the same ctx, and clears the struct. */
HEATDIFF_API void hd_csr_free(hd_csr *a, hd_context *ctx);

/* ---- operators ---- */

/* The Laplacian of a triangle mesh.
 * xyz    [3 n] coordinates, finite
 * tri    [3 n_tri] vertex ids in [0, n)
 * opts   kind (fem, voronoi-cot, cot), intrinsic_delaunay, tufted, mollify, context; NULL: fem
 * Faces of zero area, faces with a repeated corner, and faces with the corners of an earlier face are left
 * out and counted in out->mesh. Vertices without mass become inert. Non-manifold edges and several components
 * are allowed.
 * intrinsic_delaunay and tufted give L and B of an intrinsic Delaunay triangulation of the same surface on
 * the same vertices (Bobenko, Springborn 2007; Sharp, Crane 2020). Then no off-diagonal entry of L is
 * positive (for boundaries see hd_laplacian_opts), and with voronoi-cot or cot heat obeys the maximum
 * principle. Entries that only rounding made positive, below 1e-13 of the cotangents of the faces at the
 * edge, are set to zero.
 * Errors HD_ERR_INDEX (face, value: the id), HD_ERR_NOT_FINITE (vertex), HD_ERR_EMPTY,
 *        HD_ERR_ARGUMENT, HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost   O(n + n_tri + flips) */
HEATDIFF_API hd_status hd_laplacian_triangles(hd_laplacian **out, const double *xyz, int32_t n,
                                              const int32_t *tri, int32_t n_tri,
                                              const hd_laplacian_opts *opts, hd_error *err);

/* The Laplacian of a mesh of polygons. Faces may have any number of corners, and may be triangles, non-planar
 * or non-convex.
 * xyz      [3 n] coordinates, finite
 * face_ptr [n_faces + 1] from 0, not descending. The corners of face f are face_idx[face_ptr[f]] ..
 *          face_idx[face_ptr[f + 1] - 1]
 * face_idx [face_ptr[n_faces]] vertex ids in [0, n)
 * opts     kind, lambda, context; NULL: polygon with lambda 1
 * With fem, voronoi-cot or cot every face is split into a fan of triangles from its first corner, and the
 * result is that of hd_laplacian_triangles. out->mesh then counts triangles, but errors name the polygon.
 * intrinsic_delaunay and tufted work on these triangles: with them the default kind is fem, and polygon is an
 * error.
 * On triangles the kind polygon has the cotangent L for any lambda. lap->h is the polygons' mean edge length.
 * The pattern of L contains the diagonals of the faces. hd_mesh_report says which faces are left out.
 * Errors   HD_ERR_INDEX (face, value: the id), HD_ERR_STRUCTURE (face: face_ptr descends there),
 *          HD_ERR_NOT_FINITE (vertex or face), HD_ERR_TOO_LARGE, HD_ERR_EMPTY, HD_ERR_ARGUMENT,
 *          HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost     a face with k corners: at most k^2 entries of L and as much time; work arrays are linear in k
 * Source   Alexa, Wardetzky 2011: L is the sum of D'M_f D over the faces, with their M_f, and with D the
 *          differences along the edges. The combinatorial part of M_f has one weight lambda for all faces */
HEATDIFF_API hd_status hd_laplacian_polygons(hd_laplacian **out, const double *xyz, int32_t n,
                                             const int64_t *face_ptr, const int32_t *face_idx,
                                             int32_t n_faces, const hd_laplacian_opts *opts,
                                             hd_error *err);

/* The Laplacian of points on a surface, given without faces.
 * xyz    [3 n] coordinates, finite
 * opts   kind voronoi-exp (default) or exp, bandwidth, weight_cut, neighbours, context
 * The bandwidth s balances two errors: the error of smoothing grows like s, the error of sampling falls like
 * 1/s^2. Let r_k be the distance of the k-th neighbour, and m the mean of pi r_k^2/k, the area of a point
 * (values above nine medians count as nine medians). The default is s = m (m/h^2)/4, but at least 0.3 m and
 * at most 1 m. This is 0.36 m for blue noise and 1 m for independent random points. Weights reach as far as
 * 8.6 sqrt(s). A row has about 230 s/m non-zeros: 80 and 230 for these two. weight_cut = 1e-4 halves that and
 * changes the operator by 0.1 %.
 * If s is a fixed multiple of m, the error levels off at 1 to 3 % as points become denser.
 * To go below that, let s/m grow as points become denser (Belkin, Niyogi 2008; Singer 2006).
 * Points at the same place share its cell. Points without area are inert for voronoi-exp. Points that no
 * other point reaches become components of their own. Cells at a border end at the hull of the neighbours.
 * lap->points counts each of these cases.
 * Errors HD_ERR_NOT_FINITE (vertex), HD_ERR_ARGUMENT, HD_ERR_EMPTY (fewer than two places, or all on a line),
 *        HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost   O(n log n + nnz)
 * Source Liu, Prabhakaran, Guo 2012 (voronoi-exp); Belkin, Niyogi 2008 (exp). Differences: weights are cut by
 *        distance, so that L is symmetric; neighbours more than 45 degrees off the tangent plane count with
 *        their height, so that points of another sheet two spacings away do not cut a cell */
HEATDIFF_API hd_status hd_laplacian_points(hd_laplacian **out, const double *xyz, int32_t n,
                                           const hd_laplacian_opts *opts, hd_error *err);

/* The tufted Laplacian of a point set on a surface: cotangent weights, none negative, 7 to 13 in a row.
 * xyz      [3 n] coordinates, finite
 * nbr_ptr  [n + 1] offsets into nbr; nbr_ptr[0] = 0. If nbr_ptr and nbr are NULL, the opts->neighbours
 *          nearest points of each point are searched; points at the place of an earlier one are inert then
 * nbr      ids of the neighbours of each point in any order, at most 256 of a point; about 30 nearest ones
 *          suit. The point itself, points at its place and repeated ids do no harm
 * opts     kind (fem, voronoi-cot, cot), neighbours, mollify, context; NULL: fem. tufted is always on
 * Each point's Delaunay star among its neighbours is computed in their tangent plane. All stars together form
 * a triangle soup in which each triangle counts a third. lap->mesh describes that soup. Points in no star are
 * inert.
 * Two sheets of a surface are kept separate if they are at least about two spacings apart (three for
 * independent random points). Closer sheets are mixed or treated as one rough sheet; lap->points.n_not_flat
 * counts such places.
 * HINT: if you know normals, leave neighbours whose normals point the other way out of nbr.
 * Errors   HD_ERR_STRUCTURE, HD_ERR_INDEX, HD_ERR_TOO_LARGE (row: the point), HD_ERR_NOT_FINITE (vertex),
 *          HD_ERR_ARGUMENT, HD_ERR_EMPTY, HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost     O(n log n + n_neighbours + flips)
 * Source   Sharp, Crane 2020, section 5.7 */
HEATDIFF_API hd_status hd_laplacian_tufted_points(hd_laplacian **out, const double *xyz, int32_t n,
                                                  const int64_t *nbr_ptr, const int32_t *nbr,
                                                  const hd_laplacian_opts *opts, hd_error *err);

/* The pair of the caller's own matrices, on any graph. Both are copied.
 * L      n x n, symmetric positive semi-definite: minus the cotangent matrix of libigl. Checked are L_ii >= 0
 *        and L_ij^2 <= L_ii L_jj. If its rows do not sum to zero, heat is not conserved
 * B      n x n, symmetric positive definite, any pattern. Rows of B without non-zeros are inert vertices.
 *        Definiteness is checked on the diagonal, by a factorisation if some row is not dominated by its
 *        diagonal, and later by solvers
 * h      unit length of the caller's mesh, for lap->h; 0 if there is none
 * The pair has the union of both patterns. Explicit zeros stay if their mirror entry is stored too.
 * Errors as hd_csr_check; HD_ERR_NOT_POSITIVE (row, column, value), HD_ERR_EMPTY, HD_ERR_MEMORY,
 *        HD_ERR_CANCELLED
 * Cost   linear, except for a factorisation of B */
HEATDIFF_API hd_status hd_laplacian_matrices(hd_laplacian **out, const hd_csr *L, const hd_csr *B,
                                             double h, const hd_laplacian_opts *opts,
                                             hd_error *err);

/* y = (alpha L + beta B) x for a field on the vertices. x and y [n] must not overlap. y is 0 at vertices
 * without mass. Uses the Laplacian's context. */
HEATDIFF_API hd_status hd_laplacian_apply(const hd_laplacian *lap, double alpha, double beta,
                                          const double *x, double *y, hd_error *err);

HEATDIFF_API void hd_laplacian_free(hd_laplacian *lap);  /* NULL is fine */

/* ---- neighbours of points ---- */

/* The k nearest points of each query point.
 * index      [k m] ids of points, k for each query, nearest first. Equally distant points are ordered by id.
 *            A query that is a point of the set finds itself too. -1 beyond n
 * distance2  [k m] squared distances, infinite beyond n; NULL: not wanted
 * xyz        [3 n] the points, finite
 * query      [3 m] the query points; NULL: all n points, m = n
 * The result is exact.
 * Errors     HD_ERR_ARGUMENT, HD_ERR_NOT_FINITE (vertex, or row for a query), HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost       O((n + k m) log n)
 * Source     Friedman, Bentley, Finkel 1977 */
HEATDIFF_API hd_status hd_neighbours_nearest(const double *xyz, int32_t n, const double *query,
                                             int32_t m, int32_t k, int32_t *index,
                                             double *distance2, hd_context *ctx, hd_error *err);

/* All points within a radius of each query point. Row i of out, m x n, lists by id the points at distance d
 * from query i with d^2 <= radius^2; its values are d^2. Arguments and errors as above. Free out with
 * hd_csr_free and the same ctx. */
HEATDIFF_API hd_status hd_neighbours_radius(hd_csr *out, const double *xyz, int32_t n,
                                            const double *query, int32_t m, double radius,
                                            hd_context *ctx, hd_error *err);

/* ---- rational approximations ---- */

/* A built-in set: HD_POLES_UNIFORM of degree 1..14, HD_POLES_KERNEL of degree 2..14, or HD_POLES_DIAGONAL of
 * degree 2..14. tools/poles.py computes and checks the constants.
 * Errors HD_ERR_ARGUMENT for any other kind or degree (value: a wrong degree)
 * Source Cody, Meinardus, Varga 1969; Carpenter, Ruttan, Varga 1984 */
HEATDIFF_API hd_status hd_rational_get(hd_rational *out, hd_pole_kind kind, int32_t degree,
                                       hd_error *err);

/* Kernel sets for many times that share their poles.
 * out    [n_times] out[q] is the set for t[q]
 * t      [n_times] > 0, in any order
 * tol    bound of max_weighted_error of every set
 * ctx    for scratch memory
 * theta_i/t[q] is the same for all q. So the factors of L + (theta_i/t[q]) B serve every time, and only the
 * weights differ. The number of pole pairs is the smallest multiple of four that reaches tol for all times.
 * At tol = 1e-6 it is 8 if the largest time is 10 times the smallest, 12 if it is 100 times, and 16 if it is
 * 1000 times.
 * Errors HD_ERR_ARGUMENT: a time is not positive and finite (row), or there is no such set
 *        (value: the ratio of the times); HD_ERR_MEMORY
 * Cost   under a millisecond for each time
 * Source Lopez-Fernandez, Palencia, Schaedle 2006, with free poles instead of poles on a hyperbola */
HEATDIFF_API hd_status hd_rational_shared(hd_rational *out, int32_t n_times, const double *t,
                                          double tol, hd_context *ctx, hd_error *err);

/* c(x) for real x <= 0. */
HEATDIFF_API double hd_rational_eval(const hd_rational *set, double x);

/* ---- shifted systems ---- */

typedef struct hd_solve_opts {
    int32_t begin_zero;
    hd_solver solver;           /* cocg, cocr or minres; default cocg */
    hd_precond precond;
    double tol;                 /* |b - A x| / |b| in the norm of diag(B)^-1; default 1e-10 */
    int32_t max_iterations;     /* default 20000 */
    hd_context *context;        /* default: the Laplacian's */
    int32_t end_zero;
} hd_solve_opts;

typedef struct hd_solve_report {
    int64_t iterations;
    double residual;            /* reached, computed from x, in the norm of diag(B)^-1 */
    double error_b;             /* bound of |x - exact|_B / |x|_B; infinite if nothing is known about B */
} hd_solve_report;

/* Solves (t L + theta B) x = rhs, a complex-symmetric system.
 * t      >= 0
 * theta  not on (-inf, 0]
 * rhs, x [n] on the vertices; they may be the same array. x is 0 at vertices without mass
 * report filled also if the status is HD_ERR_NOT_CONVERGED
 * Errors HD_ERR_ARGUMENT, HD_ERR_NOT_FINITE (row: of rhs, or of x if it overflows), HD_ERR_NOT_CONVERGED,
 *        HD_ERR_BREAKDOWN, HD_ERR_MEMORY, HD_ERR_CANCELLED; HD_WARN_ACCURACY
 * Cost   every call makes its own ordering and preconditioner */
HEATDIFF_API hd_status hd_shifted_solve(const hd_laplacian *lap, double t, hd_c64 theta,
                                        const hd_c64 *rhs, hd_c64 *x, const hd_solve_opts *opts,
                                        hd_solve_report *report, hd_error *err);

/* ---- direct solver ---- */

/* The factorisation P A P' = L D L' of a symmetric matrix without pivoting. L is unit lower triangular, D is
 * diagonal. It suits two classes of matrices: real matrices that are definite or quasi-definite, and
 * complex-symmetric matrices (A = A', never conjugated) whose real part is definite after a rotation, such as
 * t L + theta B. One analysis of a pattern serves any number of factorisations, and these allocate nothing
 * after the first of their kind. One thread at a time. */
typedef struct hd_ldl hd_ldl;

typedef struct hd_ldl_opts {
    int32_t begin_zero;
    /* Default: nested dissection if coordinates are given and there are many rows, else minimum degree. */
    hd_ordering ordering;
    const int32_t *perm;        /* [n] with HD_ORDERING_OWN: perm[k] is the row eliminated k-th */
    const double *xyz;          /* [3 n] coordinates of the rows; NULL: none */
    hd_context *context;
    int32_t end_zero;
} hd_ldl_opts;

typedef struct hd_ldl_report {
    hd_ordering ordering;
    int32_t n_supernodes;
    int32_t n_matrices;         /* in the factor; 0: only analysed */
    int64_t factor_nnz;         /* of L, diagonal included, without padding */
    int64_t stored;             /* entries of an array of factors, padding included */
    /* Of one real factorisation: the sum of the squares of L's column counts. A complex matrix takes four
     * times as many. */
    double factor_flops;
    /* Largest |pivot| / largest |diagonal entry of A|: what is lost because there is no pivoting. At most 3.8
     * for uniform sets and 4.2 for kernel sets. */
    double growth;
    double smallest_pivot;      /* smallest |pivot| / largest |diagonal entry of A| */
    int32_t n_negative;         /* real: negative pivots, which is the number of negative eigenvalues */
} hd_ldl_report;

/* Computes the ordering, the elimination tree and the supernodes.
 * a      n x n with a symmetric pattern. Its values are ignored, and diagonal entries may be missing
 * Errors as hd_csr_check; HD_ERR_INDEX (row) if perm is not a permutation; HD_ERR_ARGUMENT, HD_ERR_TOO_LARGE,
 *        HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost   nearly linear in the non-zeros of A, plus the ordering */
HEATDIFF_API hd_status hd_ldl_analyse(hd_ldl **out, const hd_csr *a, const hd_ldl_opts *opts,
                                      hd_ldl_report *report, hd_error *err);

/* Factorises a real matrix.
 * val    [nnz] in the order of the analysed pattern. Of each pair (i,j), (j,i) one entry is read
 * Errors HD_ERR_NOT_FINITE (row, column), HD_ERR_BREAKDOWN (row, value: a pivot too small to divide by),
 *        HD_ERR_MEMORY, HD_ERR_CANCELLED */
HEATDIFF_API hd_status hd_ldl_factor(hd_ldl *f, const double *val, hd_ldl_report *report,
                                     hd_error *err);

/* Factorises k complex-symmetric matrices in one sweep. Four at a time are stored side by side, so three cost
 * as much as four.
 * val    [k nnz], one matrix after the other
 * Errors as above; pole is the index of the matrix */
HEATDIFF_API hd_status hd_ldl_factor_complex(hd_ldl *f, int32_t k, const hd_c64 *val,
                                             hd_ldl_report *report, hd_error *err);

/* Solves A x = b for k real right-hand sides. Columns are ldb and ldx apart (0: n). x may be b. The first
 * call of a kind allocates its work arrays. */
HEATDIFF_API hd_status hd_ldl_solve(hd_ldl *f, int32_t k, const double *b, size_t ldb, double *x,
                                    size_t ldx, hd_error *err);

/* Solves A_q x_q = b_q for all matrices of the last complex factorisation. The arrays are
 * b_q = b + q ldb and x_q = x + q ldx. ldx = 0 means n. ldb = 0 means the same b for all. x may be b if
 * ldb is ldx or 0. */
HEATDIFF_API hd_status hd_ldl_solve_complex(hd_ldl *f, const hd_c64 *b, size_t ldb, hd_c64 *x,
                                            size_t ldx, hd_error *err);

/* Entries of A^-1 by selected inversion. A is the matrix of the last real factorisation, which is kept.
 * values [nnz] on the analysed pattern and in its order, both of each pair; NULL: not wanted
 * diag   [n] also where the pattern has no diagonal entry; NULL: not wanted
 * Errors HD_ERR_ARGUMENT (the last factorisation was not real, or failed), HD_ERR_MEMORY, HD_ERR_CANCELLED
 * Cost   about twice the flops of the factorisation (four times if both are wanted and diagonal entries are
 *        missing); work arrays live for the call
 * Source Takahashi, Fagan, Chin 1973; Erisman, Tinney 1975 */
HEATDIFF_API hd_status hd_ldl_inverse(hd_ldl *f, double *values, double *diag, hd_error *err);

/* The same for all k matrices of the last complex factorisation: values [k nnz], diag [k n]. A^-1 is complex
 * symmetric like A. */
HEATDIFF_API hd_status hd_ldl_inverse_complex(hd_ldl *f, hd_c64 *values, hd_c64 *diag,
                                              hd_error *err);

/* Single entries of A^-1: values[q] is the entry (i[q], j[q]).
 * values [n_entries] for the last real factorisation, [k n_entries] for all matrices of the last complex one
 * Each distinct j takes a forward sweep from j up the elimination tree and a backward sweep down to the
 * rows i. Fronts off these paths are not touched. For entries on the pattern, hd_ldl_inverse is faster from
 * some hundred columns on.
 * Errors HD_ERR_ARGUMENT, HD_ERR_INDEX (row: which entry), HD_ERR_MEMORY */
HEATDIFF_API hd_status hd_ldl_inverse_entries(hd_ldl *f, int64_t n_entries, const int32_t *i,
                                              const int32_t *j, double *values, hd_error *err);
HEATDIFF_API hd_status hd_ldl_inverse_entries_complex(hd_ldl *f, int64_t n_entries,
                                                      const int32_t *i, const int32_t *j,
                                                      hd_c64 *values, hd_error *err);

HEATDIFF_API void hd_ldl_free(hd_ldl *f);  /* NULL is fine */

/* ---- heat ---- */

typedef struct hd_heat hd_heat;

/* A plan for heat on lap, which must outlive the plan. Creating it is cheap: whatever a method needs is made
 * at its first use. So the first column, field or diagonal at a time t carries the factorisation, and further
 * ones at the same t are much faster. The plan keeps the renumbered pair, the analysis, work arrays, and the
 * factors or preconditioners of the last pole set and time.
 * One thread at a time for a plan. Plans with contexts of their own may share lap, see Threads at the top of
 * the file.
 * Errors HD_ERR_ARGUMENT, HD_ERR_INDEX (row: perm is not a permutation), HD_ERR_MEMORY */
HEATDIFF_API hd_status hd_heat_create(hd_heat **out, const hd_laplacian *lap,
                                      const hd_heat_opts *opts, hd_error *err);
HEATDIFF_API void hd_heat_free(hd_heat *heat);  /* NULL is fine */

/* Common to all queries of a plan:
 * kernel HD_KERNEL_OPERATOR for K_t, HD_KERNEL_SYMMETRIC for k_t = K_t B^-1
 * t      [n_times], n_times >= 1, in any order; unit length^2. One time: n_times = 1 and the address of t
 * report NULL, or what happened; with several columns or times the worst of them
 * err    NULL, or the error, which report->error has as well */

/* U = K_t F at each time.
 * t      >= 0. t = 0 copies F. For large t the answer tends to the mean over each component; t may be
 *        arbitrarily large
 * F      n x k doubles, column-major, columns ldf apart (0: n)
 * U      n x (k n_times), column q n_times + m for field q and time m, columns ldu apart (0: n). With one
 *        time U may be F. With the default degree, all fields of a call use the largest degree that one of
 *        them needs
 * Errors HD_ERR_ARGUMENT, HD_ERR_NOT_FINITE (row, column), HD_ERR_NOT_CONVERGED, HD_ERR_BREAKDOWN,
 *        HD_ERR_NOT_POSITIVE, HD_ERR_MEMORY, HD_ERR_CANCELLED; HD_WARN_ACCURACY
 * Cost   direct: one factorisation of all poles for each new t, then one sweep through the factors for eight
 *        fields at a time. krylov: one real factorisation, then 15 to 30 real solves for each field.
 *        iterative: one solve for each pole, started from the solutions before it, up to four fields in
 *        parallel. Many times: with krylov one factor and one basis serve all times within one or two
 *        decades, so that they cost little more than one; other methods take the times one by one
 * Source the paper, eqs. (8) and (9), with the signs given at the top of the file */
HEATDIFF_API hd_status hd_heat_apply(hd_heat *heat, int32_t n_times, const double *t, int32_t k,
                                     const double *F, size_t ldf, double *U, size_t ldu,
                                     hd_report *report, hd_error *err);

/* Columns of the kernel. That of K_t for a source s is K_t e_s: the field at time t that starts as 1 at s and 0
 * elsewhere; its total heat 1'B u is the mass of s.
 * U      as above, with sources in place of fields. The column of a vertex without mass is its unit vector
 *        for K_t, and zero for k_t
 * Errors and cost as above; HD_ERR_INDEX (vertex, column: which source). The first column at a time t carries
 * the factorisation. */
HEATDIFF_API hd_status hd_heat_columns(hd_heat *heat, hd_kernel kernel, int32_t n_times,
                                       const double *t, int32_t k, const int32_t *sources,
                                       double *U, size_t ldu, hd_report *report, hd_error *err);

/* One column at one time. u [n]. */
HEATDIFF_API hd_status hd_heat_column(hd_heat *heat, hd_kernel kernel, double t, int32_t source,
                                      double *u, hd_report *report, hd_error *err);

/* The diagonal of k_t or K_t at every vertex. That of k_t is the heat kernel signature (Sun et al. 2009),
 * also called auto-diffusion function (Gebal et al. 2009). It comes from selected inversion, without
 * eigenvectors and without columns.
 * t      > 0
 * D      n x n_times, column q for t[q], columns ldd apart (0: n). A vertex without mass has 0 (K_t: 1)
 * report the rational part is proven at every vertex. Rounding is measured by solves whose residuals are
 *        known, at the vertices where it is largest; with many times, at each time
 * If B is not diagonal, k_t leaves out the term a0 diag(B^-1) of a uniform set. It is as large as the set's
 * error, and the bound includes it.
 * Errors HD_ERR_ARGUMENT (also if n_times < 1, or if the method is iterative or krylov), HD_ERR_BREAKDOWN,
 *        HD_ERR_MEMORY, HD_ERR_CANCELLED; HD_WARN_ACCURACY
 * Cost   for each t the factors of all poles, and about twice as much again. Many times share one set of
 *        poles if neither poles nor a degree are chosen: 16 or 100 times over three decades cost four or five
 *        times as much as one */
HEATDIFF_API hd_status hd_heat_diagonal(hd_heat *heat, hd_kernel kernel, int32_t n_times,
                                        const double *t, double *D, size_t ldd, hd_report *report,
                                        hd_error *err);

/* k_t(i,j) for all edges (i,j) of the mesh and on the diagonal, from the same inversion.
 * kernel HD_KERNEL_SYMMETRIC. (Entries of K_t = k_t B are not symmetric)
 * t      > 0
 * values [L.nnz n_times], time by time, on the pattern of the Laplacian's L; indices are rows, not vertices
 * If B is not diagonal, a0 B^-1 is left out as above. With poles and degree by default, degree 14 takes over
 * if the rational part of the bound is above 5e-7. Rounding is measured in the rows where it is largest.
 * Errors and cost as above. */
HEATDIFF_API hd_status hd_heat_edges(hd_heat *heat, hd_kernel kernel, int32_t n_times,
                                     const double *t, double *values, hd_report *report,
                                     hd_error *err);

/* Diffusion distances from each of k sources to every vertex.
 * t      > 0. Commute and biharmonic have no time: t is ignored, n_times is 0 or 1
 * D      n x (k n_times), column q n_times + m for source q and time m, columns ldd apart (0: n)
 * report error_bound and error_relative are for the distance d itself. n_lost counts distances with at most
 *        about one sure digit: at t so large that all vertices look alike, or next to the source at small t.
 *        If there are any, the status is HD_WARN_ACCURACY. Nothing is ever NaN. hd_heat_pairs loses no
 *        digits there
 * Vertices without mass are treated as having a zero kernel row. Between components commute and biharmonic
 * are infinite (HUGE_VAL). With poles and degree by default, degree 14 takes over if the error bound relative
 * to the largest distance is, or will be, above 2.5e-6. Many times then share one set of poles.
 * Errors as hd_heat_diagonal
 * Cost   one diagonal at 2t, shared by all sources, and one column for each source. HD_DISTANCE_WEIGHTED with
 *        a full B: the diagonal is that of B K_2t and takes about twice as long. Commute: one real
 *        factorisation and its inversion; biharmonic: the same, and those of one pole */
HEATDIFF_API hd_status hd_heat_distance(hd_heat *heat, hd_distance_kind kind, int32_t n_times,
                                        const double *t, int32_t k, const int32_t *sources,
                                        double *D, size_t ldd, hd_report *report, hd_error *err);

/* K_t(i[q],j[q]) and diffusion distances of listed pairs.
 * t      >= 0; ignored by commute and biharmonic, with n_times 0 or 1
 * K, d   [n_pairs n_times], time by time; each may be NULL. K is not written for commute and biharmonic
 * The distance is |K_t B^-1 (e_i - e_j)|_B, from the columns at t of all vertices that occur, without
 * cancellation. If these columns would take more than half a GiB, it comes from entries and the diagonal at
 * 2t, one column at a time; then sort the pairs by i. Commute and biharmonic always work that way, and need
 * the direct method. */
HEATDIFF_API hd_status hd_heat_pairs(hd_heat *heat, hd_distance_kind kind, int32_t n_times,
                                     const double *t, int64_t n_pairs, const int32_t *i,
                                     const int32_t *j, double *K, double *d, hd_report *report,
                                     hd_error *err);

/* Farthest points: each is the vertex farthest from all points before it, under the given distance.
 * vertex   [count] the first n_given are given. With n_given = 0 the first vertex with mass begins
 * distance [count] or NULL: distance to the points before it (0 for the first)
 * Cost     a diagonal, and one column for each point
 * Source   Gonzalez 1985 */
HEATDIFF_API hd_status hd_heat_sample(hd_heat *heat, hd_distance_kind kind, double t, int32_t count,
                                      int32_t n_given, int32_t *vertex, double *distance,
                                      hd_report *report, hd_error *err);

/* Single entries of K_t or k_t.
 * t      >= 0
 * values [n_pairs n_times], time by time: the entry (i[q], j[q])
 * report the bound is relative to the largest |value| in the list. Far from the source, where the kernel is
 *        nearly zero, it may say nothing about a single value
 * Cost   one column for each distinct j, with n doubles of memory at a time */
HEATDIFF_API hd_status hd_heat_entries(hd_heat *heat, hd_kernel kernel, int32_t n_times,
                                       const double *t, int64_t n_pairs, const int32_t *i,
                                       const int32_t *j, double *values, hd_report *report,
                                       hd_error *err);

/* ---- geodesic distance ---- */

typedef struct hd_geodesic hd_geodesic;

/* A plan for distances along the surface of a triangle mesh, by the heat method.
 * xyz    [3 n] coordinates, finite
 * tri    [3 n_tri] vertex ids in [0, n). Neither xyz nor tri is used after this call. Faces are left out as
 *        in hd_laplacian_triangles. Paths lead around holes
 * opts   NULL: t = h^2, barycentric masses
 * Errors as hd_laplacian_triangles; HD_ERR_ARGUMENT, HD_ERR_BREAKDOWN (vertex: a pivot too small to
 *        divide by)
 * Cost   assembly, one analysis, two real factorisations on one pattern. The plan keeps both: 16 bytes for
 *        each non-zero of L, and about 430 bytes for each vertex
 * Source Crane, Weischedel, Wardetzky 2013, algorithm 1 and section 3.2.1 */
HEATDIFF_API hd_status hd_geodesic_create(hd_geodesic **out, const double *xyz, int32_t n,
                                          const int32_t *tri, int32_t n_tri,
                                          const hd_geodesic_opts *opts, hd_error *err);
HEATDIFF_API void hd_geodesic_free(hd_geodesic *g);  /* NULL is fine */

/* The distance of every vertex to the nearest source.
 * d        [n] in the unit of xyz: min |phi - phi_s| over the sources s of the vertex' component. It is zero
 *          at the sources. It is HUGE_VAL where no source can be reached: in components without one, and at
 *          vertices without mass
 * sources  [n_sources] at least one; repeated sources count once
 * The method itself has an error of the order of h: a few percent on coarse meshes, about one percent on fine
 * ones, and most where fronts meet. Near a source the relative error can be much larger. The result is not a
 * metric: d from i to j and d from j to i differ by about that error.
 * Errors   HD_ERR_ARGUMENT, HD_ERR_INDEX (vertex, column: which source), HD_ERR_MEMORY, HD_ERR_CANCELLED,
 *          HD_ERR_BREAKDOWN (rounding left no number). HD_WARN_ACCURACY, only if a report is given
 * Cost     two solves and two passes over the faces; with a report two more passes. Where heat fades below
 *          1e-200 of the source's, which is about 450 edges away at t = h^2, another solve follows for each
 *          such distance, on the part of the mesh that it reaches (report->n_stages). Such a solve allocates
 *          about 60 bytes for each vertex, for the time of the call. A call with more sources than any before
 *          allocates too; other calls do not
 * One thread at a time for a plan. */
HEATDIFF_API hd_status hd_geodesic_distance(hd_geodesic *g, int32_t n_sources,
                                            const int32_t *sources, double *d,
                                            hd_geodesic_report *report, hd_error *err);

/* The same for k sources, each by itself. Column q of D, n x k, columns ldd apart (0: n), holds the distances
 * to sources[q]. Eight sources are solved side by side, in a third of the time of eight calls. The first call
 * with three sources or more allocates about 150 bytes for each vertex. */
HEATDIFF_API hd_status hd_geodesic_distances(hd_geodesic *g, int32_t k, const int32_t *sources,
                                             double *D, size_t ldd, hd_geodesic_report *report,
                                             hd_error *err);

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

#if defined(__linux__) && !defined(HEATDIFF_NO_LARGE_PAGES)
#include <sys/mman.h>
#ifdef MADV_HUGEPAGE
#define HDI_LARGE_PAGES 1
#endif
#endif
#ifndef HDI_LARGE_PAGES
#define HDI_LARGE_PAGES 0
#endif

#ifndef HEATDIFF_ASSERT
#include <assert.h>
#define HEATDIFF_ASSERT(x) assert(x)
#endif

#if defined(__GNUC__) || defined(__clang__)
#define HDI_RESTRICT __restrict__
#define HDI_LOAD(p) __atomic_load_n(p, __ATOMIC_RELAXED)
#define HDI_STORE(p, v) __atomic_store_n(p, v, __ATOMIC_RELAXED)
#define HDI_PREFETCH(p) __builtin_prefetch(p)
/* Of p[i], which may lie outside of the array: no pointer may, so that it is a number. */
#define HDI_PREFETCH_AT(p, i)                                                                                          \
    __builtin_prefetch(HDI_RECAST(const void *, HDI_RECAST(uintptr_t, p) + HDI_CAST(uintptr_t, i) * sizeof *(p)))
#else
#define HDI_RESTRICT
#define HDI_LOAD(p) (*(p))
#define HDI_STORE(p, v) (*(p) = (v))
#define HDI_PREFETCH(p) ((void)0)
#define HDI_PREFETCH_AT(p, i) ((void)0)
#endif

/* Instruction sets. The kernels of room [07] are compiled for each, with function-level targets, and chosen at run time,
 * so that a plain cc -O2 uses what the processor has. Plain C serves everything else. GCC does not align the stack
 * for AVX on Windows (its bug 54412), and __builtin_cpu_supports of clang for MSVC needs a library that is not
 * linked there. */
#if defined(__x86_64__) && (defined(__clang__) ? !defined(_MSC_VER) : defined(__GNUC__) && !defined(_WIN32)) && \
    !defined(HEATDIFF_NO_SIMD)
#include <immintrin.h>
#define HDI_X86 1
#define HDI_AVX2 __attribute__((target("avx2,fma")))
#define HDI_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx2,fma")))
#else
#define HDI_X86 0
#endif
#if defined(__GNUC__) || defined(__clang__)
#define HDI_INLINE inline __attribute__((always_inline))
#else
#define HDI_INLINE inline
#endif
/* Loops of at most eight rounds over registers: without them the arrays would live in memory. */
#if defined(__clang__)
#define HDI_UNROLL _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define HDI_UNROLL _Pragma("GCC unroll 8")
#else
#define HDI_UNROLL
#endif

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"   /* of GCC's own avx512fintrin.h, which means it */
#endif

#ifdef __cplusplus
#define HDI_CAST(type, x) static_cast<type>(x)
#define HDI_RECAST(type, x) reinterpret_cast<type>(x)   /* of pointers and numbers */
extern "C" {
#else
#define HDI_CAST(type, x) ((type)(x))
#define HDI_RECAST(type, x) ((type)(x))
#endif

#ifdef HEATDIFF_USE_BLAS
void dgemm_(const char *ta, const char *tb, const int *m, const int *n, const int *k, const double *alpha, const double *a, const int *lda,
            const double *b, const int *ldb, const double *beta, double *c, const int *ldc);
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

/* By their bits: comparisons raise the invalid flag for NaN, and with -ffast-math compilers take it that
 * there is none. */
static HDI_INLINE uint64_t hdi_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static HDI_INLINE int hdi_finite(double x) { return (hdi_bits(x) >> 52 & 0x7ff) != 0x7ff; }
static HDI_INLINE int hdi_nan(double x) { return hdi_bits(x) << 1 > HDI_CAST(uint64_t, 0xffe) << 52; }
static int hdi_cfinite(hd_c64 a) { return hdi_finite(a.re) && hdi_finite(a.im); }
/* sqrt(a^2 + b^2): hypot's care only where it is needed. */
static double hdi_pythag(double a, double b) {
    const double s = a * a + b * b;
    return s > 1e-280 && s < 1e280 ? sqrt(s) : hypot(a, b);
}

static double hdi_max(double a, double b) { return a > b ? a : b; }
static double hdi_min(double a, double b) { return a < b ? a : b; }
static int64_t hdi_least(int64_t a, int64_t b) { return a < b ? a : b; }

/* A sum with what its additions rounded away (Knuth): sums that cancel keep their digits. */
typedef struct hdi_sum { double high, low; } hdi_sum;

static void hdi_sum_add(hdi_sum *s, double x) {
    const double t = s->high + x, z = t - s->high;
    s->low += (s->high - (t - z)) + (x - z);
    s->high = t;
}

/* *out = a * b + c; 0 if that does not fit, or is more than most. Counts of elements have 64 bits everywhere,
 * also where an address has 32. */
static int hdi_size(uint64_t a, uint64_t b, uint64_t c, uint64_t most, uint64_t *out) {
    if (c > most || (b && a > (most - c) / b)) return 0;
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

static hd_status hdi_missing(hd_error *e) { return hdi_fail(e, HD_ERR_ARGUMENT, "an argument that must not be NULL is NULL"); }

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

/* Asks for large pages where the system has them to give: fresh memory costs a seventh of the time then, of which a factor needs a lot. */
static void hdi_large_pages(char *raw, size_t total) {
#if HDI_LARGE_PAGES
    const size_t page = 4096, skip = (page - HDI_RECAST(size_t, raw) % page) % page;
    if (total >= HDI_CAST(size_t, 4) << 20) (void)madvise(raw + skip, (total - skip) & ~(page - 1), MADV_HUGEPAGE);
#else
    (void)raw;
    (void)total;
#endif
}

/* [count] elements of size bytes, not cleared. NULL with e filled when there are none to have; e must be clear before. */
static void *hdi_alloc(hd_context *ctx, uint64_t count, size_t size, hd_error *e) {
    size_t total, offset;
    uint64_t head[2];
    char *raw;
    if (!hdi_size(count, size, HDI_ALIGN + HDI_HEADER, SIZE_MAX / 2, head)) {
        hdi_fail(e, HD_ERR_TOO_LARGE, "an array would be larger than the address space");
        return NULL;
    }
    total = HDI_CAST(size_t, head[0]);
    if (hdi_alloc_check(ctx, total, e) < 0) return NULL;
    ctx->allocations++;
    raw = HDI_CAST(char *, ctx->allocator.alloc ? ctx->allocator.alloc(ctx->allocator.user, total) : HEATDIFF_MALLOC(total));
    if (raw && !ctx->allocator.alloc) hdi_large_pages(raw, total);
    if (!raw) {
        hdi_fail(e, HD_ERR_MEMORY, "out of memory");
        e->value = HDI_CAST(double, total);
        return NULL;
    }
    ctx->bytes_in_use += total;
    if (ctx->bytes_peak < ctx->bytes_in_use) ctx->bytes_peak = ctx->bytes_in_use;
    offset = HDI_HEADER + (HDI_ALIGN - (HDI_RECAST(size_t, raw) + HDI_HEADER) % HDI_ALIGN) % HDI_ALIGN;
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

enum { HDI_SCOPE_MOST = 32 };

/* Work arrays of one function. After a failed take all further ones give NULL, so one check of e->status serves for many. */
typedef struct hdi_scope {
    hd_context *ctx;
    hd_error *e;
    int32_t n;
    void *block[HDI_SCOPE_MOST];
} hdi_scope;

static hdi_scope hdi_scope_begin(hd_context *ctx, hd_error *e) {
    hdi_scope s;
    memset(&s, 0, sizeof s);
    hdi_error_clear(e);
    s.ctx = ctx;
    s.e = e;
    return s;
}

static void *hdi_take(hdi_scope *s, uint64_t count, size_t size) {
    void *p;
    if (s->e->status < 0) return NULL;
    if (s->n == HDI_SCOPE_MOST) {                /* a mistake of ours, which tests would see */
        hdi_fail(s->e, HD_ERR_TOO_LARGE, "a function takes more work arrays than its scope holds");
        return NULL;
    }
    p = hdi_alloc(s->ctx, count, size, s->e);
    if (p) s->block[s->n++] = p;
    return p;
}

static void *hdi_take_zero(hdi_scope *s, uint64_t count, size_t size) {
    void *p = hdi_take(s, count, size);
    if (p) memset(p, 0, HDI_CAST(size_t, count) * size);
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

#define HDI_TAKE(scope, type, count) HDI_CAST(type *, hdi_take(scope, HDI_CAST(uint64_t, count), sizeof(type)))
#define HDI_TAKE_ZERO(scope, type, count) HDI_CAST(type *, hdi_take_zero(scope, HDI_CAST(uint64_t, count), sizeof(type)))

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

/* Whether tasks would be done one after the other: some work is prepared for several at a time then for nothing. */
static int hdi_is_serial(const hd_context *ctx) {
    if (ctx->parallel_for) return 0;
#if HDI_OPENMP
    if (ctx->threads != 1 && !omp_in_parallel()) return ctx->threads == 0 && omp_get_max_threads() == 1;
#endif
    return 1;
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

/* Instruction sets of the kernels: 0 plain C, 1 AVX2 with FMA, 2 AVX-512. The best one that this processor and system can run. */
static int hdi_simd_best(void) {
#if HDI_X86
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) return 2;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return 1;
#endif
    return 0;
}

static int hdi_simd_level(const hd_context *ctx) {
    const int best = hdi_simd_best(), asked = ctx->simd == HD_SIMD_NONE ? 0 : ctx->simd == HD_SIMD_AVX2 ? 1 : 2;
    return asked < best ? asked : best;
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

/* ==== [06] vectors ====
 * Dot products, norms and small dense work. May call [05]. Sums run in two or four fixed strands: quick
 * without -ffast-math, and the same on every run. */

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

/* Eigenvalues of the symmetric tridiagonal matrix with diagonal d [m] and off-diagonal e [m] (e[i] is between
 * i and i + 1, e[m - 1] is unused), by implicit QL with Wilkinson's shift (Bowdler, Martin, Reinsch,
 * Wilkinson 1968). z0, z1 [m] are two rows that go through the same rotations: put in rows of the identity,
 * they come out as rows of the eigenvectors. Overwrites all. 0 when it does not converge. */
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

/* ---- packed triangles ---- */

/* Entries of a packed triangle. */
static int64_t hdi_triangle(int64_t u) { return u * (u + 1) / 2; }

/* ==== [07] kernels ====
 * The dense parts of a sparse factorisation, each written once: fronts of real numbers, and of packs of four
 * complex ones. May call [06]. The room has three parts:
 *   what kernels are given, and the tables through which the rest of the file calls them
 *   the vectors of each instruction set, a layer of some forty short functions
 *   the kernels themselves, which are read once for each set, and at last the choice of the set
 * For AVX2 and AVX-512 the file includes itself with HDI_SET named anew; everything else in it is closed
 * then. It knows its name from the compiler, or from HEATDIFF_FILENAME. Plain C is read in place: with
 * HEATDIFF_NO_SIMD, and on other processors, nothing is included.
 * Within one set every entry goes through the same operations in the same order however rows are shared out,
 * so that results do not depend on threads. The optional BLAS is called here only.
 * Kernels trust their input. No two arguments overlap unless said. */

/* ---- real fronts ---- */
/* A front is the dense part of a sparse LDL' factorisation that belongs to one supernode: m rows, of which
 * the first p are pivots, and u = m - p. Its panel P (column-major, m x p) becomes L, its update matrix U (u
 * x u, lower triangle, packed by columns) becomes U - L21 D L21' and goes to the parent. This work is based
 * on
 *   I. Duff, J. Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", ACM TOMS
 *     9, 1983: fronts, packed updates;
 *   K. Goto, R. van de Geijn, "Anatomy of high-performance matrix multiplication", ACM TOMS 34, 2008: blocks
 *     for registers and caches;
 *   J. Dongarra, I. Duff, D. Sorensen, H. van der Vorst, "Numerical linear algebra for high-performance
 *     computers", 1998: left-looking LDL'.
 * Ours: B = D L21' is copied into slices of nr columns, scaled on the way; A = L21 is read where it lies when
 * the front is small.
 *
 * Slices: a matrix B with kc rows and n columns is stored as slices of nr columns, slice c at B + c kc nr,
 * its entry (k,j) at [k nr + j]. Columns past the last are zero. */

enum {
    HDI_REAL_KC = 128,  /* columns of L taken at a time: 24 rows of them stay in a 48 KB cache */
    HDI_REAL_NC = 512,  /* columns of U taken at a time: their slices (512 KB) stay in the second cache */
    HDI_REAL_NB = 64,   /* pivots eliminated at a time in a large front, a multiple of nr */
    HDI_REAL_MR = 24,   /* largest mr */
    HDI_REAL_NR = 8     /* largest nr */
};

/* One instruction set. mr x nr is the register tile. L, A, P point at the entry (first row, first column)
 * named; ld is the distance of columns. */
typedef struct hdi_real_ops {
    int32_t mr, nr;
    /* slices B = (L diag(d))': L has n rows and kc columns. */
    void (*pack)(double *B, const double *L, int64_t ld, const double *d, int32_t n, int32_t kc);
    /* A = rows of L copied, mr apart, zeros past the last: n <= mr rows, kc columns. */
    void (*copy)(double *A, const double *L, int64_t ld, int32_t n, int32_t kc);
    /* Pivots k..k+nc-1, nc <= nr, in their own rows and the n <= mr - nr rows that follow: a -= L B over the
     * k columns before, B one slice; then LDL'. P at (k,0). d goes to the diagonal of P, 1/d to dinv[k..],
     * and rows k.. of the slice B become D L' of the block. */
    void (*block)(double *P, int64_t ld, int32_t k, int32_t nc, int32_t n, double *B, double *dinv);
    /* n <= mr rows below pivots k..k+nb-1, from column k1 <= k: L(:,c) = (a - L(:,k1..c-1) B(k1..c-1,c))
     * dinv(c), c ascending. P at (row,0); B slices of kb rows. */
    void (*rows)(double *P, int64_t ld, int32_t n, int32_t k1, int32_t k, int32_t nb, const double *B,
                 int32_t kb, const double *dinv);
    /* C -= A B: n <= mr rows, nb columns, ld apart, inner kc. Slices of kb rows. */
    void (*gemm)(double *C, int64_t ld, int32_t n, int32_t nb, const double *A, int64_t lda, const double *B,
                 int32_t kb, int32_t kc);
    /* U -= A B in rows i..i+n-1, n <= mr, columns j0..j1-1 as far as the triangle goes, j1 <= i + n. Slices
     * begin at column j0. */
    void (*update)(double *U, int64_t u, int64_t i, int32_t n, int64_t j0, int64_t j1, const double *A,
                   int64_t lda, const double *B, int32_t kc);
    /* y += x */
    void (*add)(double *y, const double *x, int64_t n);
    /* b = L11^-1 b, y -= L b: nc <= 8 columns, L at (0,0) of L11; below it n1 rows whose y follows b, then n2
     * whose y is t. first: t is not read, t = -L b. */
    void (*forward)(double *b, const double *L, int64_t ld, int32_t nc, int64_t n1, double *t, int64_t n2,
                    int first);
    /* b = L11^-T (b - L' y), the same rows. */
    void (*backward)(double *b, const double *L, int64_t ld, int32_t nc, int64_t n1, const double *t,
                     int64_t n2);
    /* t = x[idx] */
    void (*gather)(double *t, const double *x, const int32_t *idx, int64_t n);
    /* For eight right-hand sides, rows of eight: y[i] -= L x, x[nc] -= L' y, y being y[idx[i]], or y[i] if
     * idx is NULL. */
    void (*gemv8)(double *y, const int32_t *idx, const double *L, int64_t ld, int64_t n, const double *x,
                  int32_t nc);
    void (*dots8)(double *x, const double *L, int64_t ld, int64_t n, const double *y, const int32_t *idx,
                  int32_t nc);
    /* x = L^-1 x, x = L^-T x: unit lower L, nc <= 8. */
    void (*lower8)(double *x, const double *L, int64_t ld, int32_t nc);
    void (*upper8)(double *x, const double *L, int64_t ld, int32_t nc);
} hdi_real_ops;

/* C -= A B for n <= mr rows and nc <= nr columns; column j + 1 of C lies step - j dec after column j. Entries
 * with row < j + diag are left alone. A has kc columns, lda apart; B is one slice of kc rows. */
typedef struct hdi_real_tile {
    double *C;
    const double *A, *B;
    int64_t step, dec, lda;
    int32_t n, nc, diag, kc;
} hdi_real_tile;

/* ---- packs: four complex numbers side by side ---- */
/* An entry of a pack matrix is re[4], im[4]: the same entry for four poles. Every operation on entries is one
 * on vectors without any shuffle. */
enum { HDI_PACK = 8, HDI_PACK_ROWS = 48, HDI_PACK_DEPTH = 64, HDI_PACK_BLOCK = 16 };

/* C(i,j) = or -= sum_k A(i,k) B(j,k), k in [0,depth), for i in [i0,i1), j in [j0,j1), with lower only j <= i.
 * A(i,k) is at a + i a_row + k a_col, all strides in doubles; C(i,j) at c + i c_row + 8 j, or, packed, at c +
 * 8 (i (i + 1)/2 + j). */
typedef struct hdi_pack_job {
    const double *a, *b;
    double *c;
    int64_t a_row, a_col, b_row, b_col, c_row;
    int64_t depth, b_first;          /* b is row b_first of B */
    int lower, packed, store;
} hdi_pack_job;

static HDI_INLINE double *hdi_pack_row(const hdi_pack_job *g, int64_t i) {
    return g->c + (g->packed ? HDI_PACK * hdi_triangle(i) : i * g->c_row);
}

/* Rows [r0,r1) of a panel, columns [k0,k0+nb): l_ik = (a_ik - sum_{j in [k0,k)} l_ij s_kj) dinv_k, in place.
 * s_kj is at s + (k - k0) s_row + 8 (j - k0). */
typedef struct hdi_pack_rows {
    double *panel;
    int64_t row, first;          /* doubles from row to row; panel is row first */
    const double *s, *dinv;
    int64_t s_row;
    int32_t nb;
} hdi_pack_rows;

typedef struct hdi_pack_ops {
    void (*multiply)(const hdi_pack_job *g, int64_t i0, int64_t i1, int64_t j0, int64_t j1);
    void (*solve_rows)(const hdi_pack_rows *g, int64_t r0, int64_t r1);
    void (*scale)(const double *panel, int64_t row, int64_t r0, int64_t r1, int64_t k0, int64_t k1,
                  const double *d, double *s);
    void (*add)(double *to, const double *from, const int32_t *rel, int64_t b0, int64_t b1, int64_t off);
    void (*forward)(const double *l, int64_t u, int64_t p, const double *y, double *t);
    void (*backward)(const double *l, const int32_t *row, int64_t u, int64_t p, double *y, const double *x);
} hdi_pack_ops;

/* s = l d for an entry */
static HDI_INLINE void hdi_pack_times(const double *HDI_RESTRICT l, const double *HDI_RESTRICT d,
                                      double *HDI_RESTRICT s) {
    int q;
    for (q = 0; q < 4; q++) {
        s[q] = l[q] * d[q] - l[q + 4] * d[q + 4];
        s[q + 4] = l[q] * d[q + 4] + l[q + 4] * d[q];
    }
}

/* ---- vectors of each instruction set ---- */
/* What a set has to define, here by name_set. A port (NEON, WASM SIMD) adds one such layer, and one more
 * reading of the kernels where the set is chosen.
 *   vec                  HDI_WIDTH doubles
 *   all(a)               a in every lane
 *   load, store          anywhere in memory
 *   load_tail(p, n)      the first n lanes, then zeros; 0 < n < width, and n = width too where masks is 1
 *   load_some(p, n)      the same for any n; lanes from n on are not read
 *   rows, rows_of        rows lo..hi-1 of a tile as a set
 *   load_rows, store_rows(.., g, q)  lanes for rows q.. of it; others are neither read nor written
 *   add, sub, mul        and fma = a b + c, fnma = c - a b, fms = a b - c, fnma1 of single numbers
 *   cross_minus          a b - c d; cross_plus: a b + c d. Contracted or not, as the compiler does with plain
 *     C
 *   lane(v, k), low(v)   lane k everywhere; the lowest as a number
 *   sum(v), gather(x, idx)  when the set has kernels for a single right-hand side
 * and as constants:
 *   cols, regs           the tile of real kernels is regs vectors by cols columns, a multiple of width
 *   fused                products of entries are summed with fma
 *   masks                load_tail costs no more than load
 *   apart                the sums of a backward step are closed between its two parts
 *   tile_rows, tile_cols, solve_rows, sweep_rows, sweep_cols  entries of packs that are held in registers */
#define HDI_IN2 static HDI_INLINE
#define HDI_IN4 static HDI_AVX2 HDI_INLINE
#define HDI_IN8 static HDI_AVX512 HDI_INLINE

/* Two lanes, where the compiler has vectors; its own arithmetic serves every processor. On x87 registers
 * vectors would live in memory. */
enum {
    hdi_cols_plain = 4, hdi_regs_plain = 2, hdi_fused_plain = 0, hdi_masks_plain = 0, hdi_apart_plain = 1,
    hdi_tile_rows_plain = 1, hdi_tile_cols_plain = 1, hdi_solve_rows_plain = 1, hdi_sweep_rows_plain = 1,
    hdi_sweep_cols_plain = 2
};
#define HDI_TARGET_plain
#if (defined(__GNUC__) || defined(__clang__)) && !defined(HEATDIFF_NO_SIMD) && \
    (!defined(__i386__) || defined(__SSE2__))
typedef double hdi_v2 __attribute__((vector_size(16)));
typedef double hdi_v2_anywhere __attribute__((vector_size(16), aligned(8), may_alias));
HDI_IN2 hdi_v2 hdi_two(double a, double b) { const hdi_v2 v = {a, b}; return v; }
HDI_IN2 hdi_v2 hdi_load_plain(const double *p) {
    return *HDI_CAST(const hdi_v2_anywhere *, HDI_CAST(const void *, p));
}
HDI_IN2 void hdi_store_plain(double *p, hdi_v2 v) { *HDI_CAST(hdi_v2_anywhere *, HDI_CAST(void *, p)) = v; }
HDI_IN2 double hdi_low_plain(hdi_v2 v) { return v[0]; }
HDI_IN2 double hdi_high_plain(hdi_v2 v) { return v[1]; }
HDI_IN2 hdi_v2 hdi_add_plain(hdi_v2 a, hdi_v2 b) { return a + b; }
HDI_IN2 hdi_v2 hdi_sub_plain(hdi_v2 a, hdi_v2 b) { return a - b; }
HDI_IN2 hdi_v2 hdi_mul_plain(hdi_v2 a, hdi_v2 b) { return a * b; }
HDI_IN2 hdi_v2 hdi_fma_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c) { return a * b + c; }
HDI_IN2 hdi_v2 hdi_fnma_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c) { return c - a * b; }
HDI_IN2 hdi_v2 hdi_cross_minus_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c, hdi_v2 d) { return a * b - c * d; }
HDI_IN2 hdi_v2 hdi_cross_plus_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c, hdi_v2 d) { return a * b + c * d; }
#else
typedef struct hdi_v2 { double a, b; } hdi_v2;
HDI_IN2 hdi_v2 hdi_two(double a, double b) { hdi_v2 v; v.a = a; v.b = b; return v; }
HDI_IN2 hdi_v2 hdi_load_plain(const double *p) { return hdi_two(p[0], p[1]); }
HDI_IN2 void hdi_store_plain(double *p, hdi_v2 v) { p[0] = v.a; p[1] = v.b; }
HDI_IN2 double hdi_low_plain(hdi_v2 v) { return v.a; }
HDI_IN2 double hdi_high_plain(hdi_v2 v) { return v.b; }
HDI_IN2 hdi_v2 hdi_add_plain(hdi_v2 a, hdi_v2 b) { return hdi_two(a.a + b.a, a.b + b.b); }
HDI_IN2 hdi_v2 hdi_sub_plain(hdi_v2 a, hdi_v2 b) { return hdi_two(a.a - b.a, a.b - b.b); }
HDI_IN2 hdi_v2 hdi_mul_plain(hdi_v2 a, hdi_v2 b) { return hdi_two(a.a * b.a, a.b * b.b); }
HDI_IN2 hdi_v2 hdi_fma_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c) { return hdi_add_plain(hdi_mul_plain(a, b), c); }
HDI_IN2 hdi_v2 hdi_fnma_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c) { return hdi_sub_plain(c, hdi_mul_plain(a, b)); }
HDI_IN2 hdi_v2 hdi_cross_minus_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c, hdi_v2 d) {
    return hdi_sub_plain(hdi_mul_plain(a, b), hdi_mul_plain(c, d));
}
HDI_IN2 hdi_v2 hdi_cross_plus_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c, hdi_v2 d) {
    return hdi_add_plain(hdi_mul_plain(a, b), hdi_mul_plain(c, d));
}
#endif
typedef hdi_v2 hdi_vec_plain;
typedef struct hdi_span { int32_t lo, hi; } hdi_span;
typedef hdi_span hdi_rows_plain;
HDI_IN2 hdi_span hdi_rows_of_plain(int32_t lo, int32_t hi) {
    hdi_span g;
    g.lo = lo;
    g.hi = hi;
    return g;
}
HDI_IN2 hdi_v2 hdi_all_plain(double a) { return hdi_two(a, a); }
HDI_IN2 hdi_v2 hdi_fms_plain(hdi_v2 a, hdi_v2 b, hdi_v2 c) { return hdi_sub_plain(hdi_mul_plain(a, b), c); }
HDI_IN2 double hdi_fnma1_plain(double a, double b, double c) { return c - a * b; }
HDI_IN2 hdi_v2 hdi_lane_plain(hdi_v2 v, int k) {
    return hdi_all_plain(k ? hdi_high_plain(v) : hdi_low_plain(v));
}
HDI_IN2 double hdi_sum_plain(hdi_v2 v) { return hdi_low_plain(v) + hdi_high_plain(v); }
HDI_IN2 hdi_v2 hdi_gather_plain(const double *x, const int32_t *idx) { return hdi_two(x[idx[0]], x[idx[1]]); }
HDI_IN2 hdi_v2 hdi_load_tail_plain(const double *p, int64_t n) { (void)n; return hdi_two(p[0], 0); }
HDI_IN2 hdi_v2 hdi_load_some_plain(const double *p, int64_t n) {
    return n >= 2 ? hdi_load_plain(p) : hdi_two(n > 0 ? p[0] : 0.0, 0);
}
HDI_IN2 hdi_v2 hdi_load_rows_plain(const double *p, hdi_span g, int32_t q) {
    const int first = g.lo <= q && g.hi > q, second = g.lo <= q + 1 && g.hi > q + 1;
    return first && second ? hdi_load_plain(p) : hdi_two(first ? p[0] : 0.0, second ? p[1] : 0.0);
}
HDI_IN2 void hdi_store_rows_plain(double *p, hdi_v2 v, hdi_span g, int32_t q) {
    const int first = g.lo <= q && g.hi > q, second = g.lo <= q + 1 && g.hi > q + 1;
    if (first && second) hdi_store_plain(p, v);
    else if (first) p[0] = hdi_low_plain(v);
    else if (second) p[1] = hdi_high_plain(v);
}

#if HDI_X86
typedef __m256d hdi_v4;
typedef __m512d hdi_v8;

/* AVX2 with FMA. Tiles of 12 x 4. */
enum {
    hdi_cols_avx2 = 4, hdi_regs_avx2 = 3, hdi_fused_avx2 = 1, hdi_masks_avx2 = 0, hdi_apart_avx2 = 0,
    hdi_tile_rows_avx2 = 2, hdi_tile_cols_avx2 = 2, hdi_solve_rows_avx2 = 2, hdi_sweep_rows_avx2 = 2,
    hdi_sweep_cols_avx2 = 4
};
#define HDI_TARGET_avx2 HDI_AVX2
typedef __m256d hdi_vec_avx2;
typedef hdi_span hdi_rows_avx2;
HDI_IN4 hdi_span hdi_rows_of_avx2(int32_t lo, int32_t hi) { return hdi_rows_of_plain(lo, hi); }
HDI_IN4 hdi_v4 hdi_all_avx2(double a) { return _mm256_set1_pd(a); }
HDI_IN4 hdi_v4 hdi_load_avx2(const double *p) { return _mm256_loadu_pd(p); }
HDI_IN4 void hdi_store_avx2(double *p, hdi_v4 v) { _mm256_storeu_pd(p, v); }
HDI_IN4 hdi_v4 hdi_add_avx2(hdi_v4 a, hdi_v4 b) { return _mm256_add_pd(a, b); }
HDI_IN4 hdi_v4 hdi_sub_avx2(hdi_v4 a, hdi_v4 b) { return _mm256_sub_pd(a, b); }
HDI_IN4 hdi_v4 hdi_mul_avx2(hdi_v4 a, hdi_v4 b) { return _mm256_mul_pd(a, b); }
HDI_IN4 hdi_v4 hdi_fma_avx2(hdi_v4 a, hdi_v4 b, hdi_v4 c) { return _mm256_fmadd_pd(a, b, c); }
HDI_IN4 hdi_v4 hdi_fnma_avx2(hdi_v4 a, hdi_v4 b, hdi_v4 c) { return _mm256_fnmadd_pd(a, b, c); }
HDI_IN4 hdi_v4 hdi_fms_avx2(hdi_v4 a, hdi_v4 b, hdi_v4 c) { return _mm256_fmsub_pd(a, b, c); }
HDI_IN4 double hdi_fnma1_avx2(double a, double b, double c) { return __builtin_fma(-a, b, c); }
HDI_IN4 hdi_v4 hdi_cross_minus_avx2(hdi_v4 a, hdi_v4 b, hdi_v4 c, hdi_v4 d) { return a * b - c * d; }
HDI_IN4 hdi_v4 hdi_cross_plus_avx2(hdi_v4 a, hdi_v4 b, hdi_v4 c, hdi_v4 d) { return a * b + c * d; }
HDI_IN4 double hdi_low_avx2(hdi_v4 v) { return _mm256_cvtsd_f64(v); }
HDI_IN4 hdi_v4 hdi_lane_avx2(hdi_v4 v, int k) {
    switch (k) {
        case 0: return _mm256_permute4x64_pd(v, 0x00);
        case 1: return _mm256_permute4x64_pd(v, 0x55);
        case 2: return _mm256_permute4x64_pd(v, 0xaa);
        default: return _mm256_permute4x64_pd(v, 0xff);
    }
}
HDI_IN4 double hdi_sum_avx2(hdi_v4 v) {
    const __m256d pairs = _mm256_hadd_pd(v, v);
    return _mm_cvtsd_f64(_mm_add_pd(_mm256_castpd256_pd128(pairs), _mm256_extractf128_pd(pairs, 1)));
}
HDI_IN4 hdi_v4 hdi_gather_avx2(const double *x, const int32_t *idx) {
    return _mm256_i32gather_pd(x, _mm_loadu_si128(HDI_CAST(const __m128i *, HDI_CAST(const void *, idx))), 8);
}
/* lanes lo..hi-1 */
HDI_IN4 __m256i hdi_lanes_avx2(int64_t lo, int64_t hi) {
    const __m256i lane = _mm256_set_epi64x(3, 2, 1, 0);
    return _mm256_and_si256(_mm256_cmpgt_epi64(_mm256_set1_epi64x(hi), lane),
                            _mm256_cmpgt_epi64(lane, _mm256_set1_epi64x(lo - 1)));
}
HDI_IN4 hdi_v4 hdi_load_tail_avx2(const double *p, int64_t n) {
    return _mm256_maskload_pd(p, hdi_lanes_avx2(0, n));
}
HDI_IN4 hdi_v4 hdi_load_some_avx2(const double *p, int64_t n) {
    return n >= 4 ? _mm256_loadu_pd(p) : hdi_load_tail_avx2(p, n);
}
HDI_IN4 hdi_v4 hdi_load_rows_avx2(const double *p, hdi_span g, int32_t q) {
    if (g.lo <= q && g.hi >= q + 4) return _mm256_loadu_pd(p);
    return _mm256_maskload_pd(p, hdi_lanes_avx2(g.lo - q, g.hi - q));
}
/* By halves and singles: masked stores are slow on some processors. */
HDI_IN4 void hdi_store_rows_avx2(double *p, hdi_v4 v, hdi_span g, int32_t q) {
    const int32_t lo = g.lo - q, hi = g.hi - q;
    if (lo <= 0 && hi >= 4) _mm256_storeu_pd(p, v);
    else {
        const __m128d a = _mm256_castpd256_pd128(v), b = _mm256_extractf128_pd(v, 1);
        if (lo <= 0 && hi >= 2) _mm_storeu_pd(p, a);
        else if (lo <= 0 && hi >= 1) _mm_storel_pd(p, a);
        else if (lo <= 1 && hi >= 2) _mm_storeh_pd(p + 1, a);
        if (lo <= 2 && hi >= 4) _mm_storeu_pd(p + 2, b);
        else if (lo <= 2 && hi >= 3) _mm_storel_pd(p + 2, b);
        else if (lo <= 3 && hi >= 4) _mm_storeh_pd(p + 3, b);
    }
}

/* AVX-512. Tiles of 24 x 8. */
enum {
    hdi_cols_avx512 = 8, hdi_regs_avx512 = 3, hdi_fused_avx512 = 1, hdi_masks_avx512 = 1,
    hdi_tile_rows_avx512 = 4, hdi_tile_cols_avx512 = 3, hdi_solve_rows_avx512 = 6, hdi_sweep_rows_avx512 = 4,
    hdi_sweep_cols_avx512 = 8
};
#define HDI_TARGET_avx512 HDI_AVX512
typedef __m512d hdi_vec_avx512;
typedef uint32_t hdi_rows_avx512;                /* a bit for each */
HDI_IN8 uint32_t hdi_rows_of_avx512(int32_t lo, int32_t hi) {
    return ((1u << hi) - 1u) & ~0u << (lo > 0 ? lo : 0);
}
HDI_IN8 hdi_v8 hdi_all_avx512(double a) { return _mm512_set1_pd(a); }
HDI_IN8 hdi_v8 hdi_load_avx512(const double *p) { return _mm512_loadu_pd(p); }
HDI_IN8 void hdi_store_avx512(double *p, hdi_v8 v) { _mm512_storeu_pd(p, v); }
HDI_IN8 hdi_v8 hdi_add_avx512(hdi_v8 a, hdi_v8 b) { return _mm512_add_pd(a, b); }
HDI_IN8 hdi_v8 hdi_sub_avx512(hdi_v8 a, hdi_v8 b) { return _mm512_sub_pd(a, b); }
HDI_IN8 hdi_v8 hdi_mul_avx512(hdi_v8 a, hdi_v8 b) { return _mm512_mul_pd(a, b); }
HDI_IN8 hdi_v8 hdi_fma_avx512(hdi_v8 a, hdi_v8 b, hdi_v8 c) { return _mm512_fmadd_pd(a, b, c); }
HDI_IN8 hdi_v8 hdi_fnma_avx512(hdi_v8 a, hdi_v8 b, hdi_v8 c) { return _mm512_fnmadd_pd(a, b, c); }
HDI_IN8 double hdi_low_avx512(hdi_v8 v) { return _mm512_cvtsd_f64(v); }
HDI_IN8 hdi_v8 hdi_lane_avx512(hdi_v8 v, int k) { return _mm512_permutexvar_pd(_mm512_set1_epi64(k), v); }
HDI_IN8 hdi_v8 hdi_load_tail_avx512(const double *p, int64_t n) {
    return _mm512_maskz_loadu_pd(HDI_CAST(__mmask8, n >= 8 ? 0xff : n > 0 ? (1u << n) - 1u : 0), p);
}
HDI_IN8 hdi_v8 hdi_load_some_avx512(const double *p, int64_t n) { return hdi_load_tail_avx512(p, n); }
HDI_IN8 hdi_v8 hdi_load_rows_avx512(const double *p, uint32_t g, int32_t q) {
    return _mm512_maskz_loadu_pd(HDI_CAST(__mmask8, g >> q & 0xff), p);
}
HDI_IN8 void hdi_store_rows_avx512(double *p, hdi_v8 v, uint32_t g, int32_t q) {
    _mm512_mask_storeu_pd(p, HDI_CAST(__mmask8, g >> q & 0xff), v);
}
/* (x, x) of four doubles */
HDI_IN8 hdi_v8 hdi_twice512(const double *x) { return _mm512_broadcast_f64x4(_mm256_loadu_pd(x)); }
/* sum of products from its two halves: p - swap(q) below, p + swap(q) above */
HDI_IN8 hdi_v8 hdi_join512(hdi_v8 p, hdi_v8 q) {
    const hdi_v8 t = _mm512_shuffle_f64x2(q, q, 0x4e);
    return _mm512_mask_sub_pd(_mm512_add_pd(p, t), 0x0f, p, t);
}
#endif

/* Plain C comes first, where the file is read. */
#define HDI_SET plain
#define HDI_SOLO plain
#define HDI_WIDTH 2
#endif /* HEATDIFF_IMPLEMENTED */

/* ---- the kernels, once for each instruction set ---- */
/* The text from here to the choice of the set is read once for each set. HDI_OF(name) is name_set, HDI_SOLO
 * the set whose kernels for one right-hand side are taken. HDI_KERNEL begins what the tables hold, HDI_PART
 * what is made part of it, with constants for the arguments that are const int. */

#ifdef HDI_SET
#ifndef HDI_OF
#define HDI_PASTE_NOW(name, set) hdi_##name##_##set
#define HDI_PASTE(name, set) HDI_PASTE_NOW(name, set)
#define HDI_TARGET_NOW(set) HDI_TARGET_##set
#define HDI_TARGET_OF(set) HDI_TARGET_NOW(set)
#define HDI_OF(name) HDI_PASTE(name, HDI_SET)
#define HDI_KERNEL static HDI_TARGET_OF(HDI_SET)
#define HDI_PART HDI_KERNEL HDI_INLINE
#define HDI_EACH(i, n) HDI_UNROLL for (i = 0; i < (n); i++)

#define hdi_vec HDI_OF(vec)
#define hdi_vall HDI_OF(all)
#define hdi_vload HDI_OF(load)
#define hdi_vstore HDI_OF(store)
#define hdi_vadd HDI_OF(add)
#define hdi_vsub HDI_OF(sub)
#define hdi_vmul HDI_OF(mul)
#define hdi_vfma HDI_OF(fma)
#define hdi_vfnma HDI_OF(fnma)
#define hdi_vlane HDI_OF(lane)
#define hdi_vlow HDI_OF(low)
#define HDI_COLS HDI_CAST(int32_t, HDI_OF(cols))
#define HDI_REGS HDI_CAST(int32_t, HDI_OF(regs))
#endif

/* B = (L diag(d))' in slices */
HDI_KERNEL void HDI_OF(real_pack)(double *B, const double *L, int64_t ld, const double *d, int32_t n,
                                  int32_t kc) {
    int32_t k, q;
    for (; n > 0; n -= HDI_COLS, L += HDI_COLS) {
        const double *l = L;
        for (k = 0; k < kc; k++, l += ld, B += HDI_COLS) {
            HDI_UNROLL
            for (q = 0; q < HDI_COLS; q += HDI_WIDTH)
                hdi_vstore(B + q, hdi_vmul(HDI_OF(load_some)(l + q, n - q), hdi_vall(d[k])));
        }
    }
}

HDI_KERNEL void HDI_OF(real_copy)(double *A, const double *L, int64_t ld, int32_t n, int32_t kc) {
    enum { mr = HDI_REGS * HDI_WIDTH };
    int32_t k, q;
    for (k = 0; k < kc; k++, L += ld, A += mr) {
        HDI_UNROLL
        for (q = 0; q < mr; q += HDI_WIDTH) hdi_vstore(A + q, HDI_OF(load_some)(L + q, n - q));
    }
}

/* x(:,j) += a b_j for the columns of a slice */
HDI_PART void HDI_OF(real_term)(hdi_vec (*x)[HDI_REGS], const int nv, const hdi_vec *a, const double *b) {
    int j, v;
    HDI_EACH(j, HDI_COLS) {
        const hdi_vec s = hdi_vall(b[j]);
        HDI_EACH(v, nv) x[j][v] = hdi_vfma(a[v], s, x[j][v]);
    }
}

HDI_PART void HDI_OF(real_zero)(hdi_vec (*x)[HDI_REGS], const int nv) {
    int j, v;
    HDI_EACH(j, HDI_COLS)
        HDI_EACH(v, nv) x[j][v] = hdi_vall(0);
}

/* x = A B in nv vectors of rows: n of them, of which part is only a part of the last vector. */
HDI_PART void HDI_OF(real_sum)(hdi_vec (*x)[HDI_REGS], const int nv, const int part, int32_t n,
                               const double *A, int64_t lda, const double *B, int32_t kc) {
    const int32_t last = HDI_WIDTH * (nv - 1);
    int32_t k;
    int v;
    for (k = 0; k < kc; k++, A += lda, B += HDI_COLS) {
        hdi_vec a[HDI_REGS];
        HDI_EACH(v, nv)
            a[v] = part && v == nv - 1 ? HDI_OF(load_tail)(A + last, n - last) : hdi_vload(A + HDI_WIDTH * v);
        HDI_OF(real_term)(x, nv, a, B);
    }
}

HDI_PART void HDI_OF(real_product)(hdi_vec (*x)[HDI_REGS], const int nv, int32_t n, const double *A,
                                   int64_t lda, const double *B, int32_t kc) {
    HDI_OF(real_zero)(x, nv);
    if (!HDI_OF(masks) && n == HDI_WIDTH * nv) HDI_OF(real_sum)(x, nv, 0, n, A, lda, B, kc);
    else HDI_OF(real_sum)(x, nv, 1, n, A, lda, B, kc);
}

/* C -= A B for a tile whose n rows fill nv vectors, the last one perhaps in part. */
HDI_PART void HDI_OF(real_tile)(const int nv, const hdi_real_tile *t) {
    hdi_vec x[HDI_COLS][HDI_REGS];
    double *C = t->C;
    int64_t step = t->step;
    int j, v;
    HDI_OF(real_product)(x, nv, t->n, t->A, t->lda, t->B, t->kc);
    if (t->n == HDI_WIDTH * nv && t->nc == HDI_COLS && t->diag <= 1 - HDI_COLS) {
        HDI_EACH(j, HDI_COLS) {
            HDI_EACH(v, nv) hdi_vstore(C + HDI_WIDTH * v, hdi_vsub(hdi_vload(C + HDI_WIDTH * v), x[j][v]));
            C += step;
            step -= t->dec;
        }
        return;
    }
    /* Loads before stores: columns lie so close that a masked load would overlap the store before it, and
     * wait for it. */
    HDI_EACH(j, HDI_COLS) {
        const HDI_OF(rows) g = HDI_OF(rows_of)(t->diag + j, t->n);
        if (j >= t->nc) continue;
        HDI_EACH(v, nv)
            x[j][v] = hdi_vsub(HDI_OF(load_rows)(C + HDI_WIDTH * v, g, HDI_WIDTH * v), x[j][v]);
        C += step;
        step -= t->dec;
    }
    C = t->C;
    step = t->step;
    HDI_EACH(j, HDI_COLS) {
        const HDI_OF(rows) g = HDI_OF(rows_of)(t->diag + j, t->n);
        if (j >= t->nc) continue;
        HDI_EACH(v, nv) HDI_OF(store_rows)(C + HDI_WIDTH * v, x[j][v], g, HDI_WIDTH * v);
        C += step;
        step -= t->dec;
    }
}

/* One row of tiles; next is the distance of slices, s the first column less the first row, which grows with
 * packed columns only. */
HDI_KERNEL void HDI_OF(real_tiles)(const hdi_real_tile *first, int64_t n_cols, int64_t next, int64_t s) {
    hdi_real_tile t = *first;
    double *C = first->C;
    for (; n_cols > 0; n_cols -= HDI_COLS) {
        /* vectors wholly above the diagonal */
        const int32_t up = s < HDI_WIDTH ? 0 : HDI_CAST(int32_t, s - s % HDI_WIDTH);
        t.C = C + up;
        t.A = first->A + up;
        t.n = first->n - up;
        t.diag = s < -HDI_COLS ? -HDI_COLS : HDI_CAST(int32_t, s - up);
        t.nc = n_cols < HDI_COLS ? HDI_CAST(int32_t, n_cols) : HDI_COLS;
        if (t.n > HDI_WIDTH * (HDI_REGS - 1)) HDI_OF(real_tile)(HDI_REGS, &t);
        else if (HDI_REGS > 2 && t.n > HDI_WIDTH) HDI_OF(real_tile)(2, &t);
        else HDI_OF(real_tile)(1, &t);
        t.B += next;
        C += HDI_COLS * t.step - t.dec * (HDI_COLS * (HDI_COLS - 1) / 2);
        t.step -= t.dec * HDI_COLS;
        s += t.dec * HDI_COLS;
    }
}

HDI_KERNEL void HDI_OF(real_gemm)(double *C, int64_t ld, int32_t n, int32_t nb, const double *A, int64_t lda,
                                  const double *B, int32_t kb, int32_t kc) {
    const hdi_real_tile t = {C, A, B, ld, 0, lda, n, 0, 0, kc};
    HDI_OF(real_tiles)(&t, nb, HDI_CAST(int64_t, kb) * HDI_COLS, -HDI_COLS);
}

HDI_KERNEL void HDI_OF(real_update)(double *U, int64_t u, int64_t i, int32_t n, int64_t j0, int64_t j1,
                                    const double *A, int64_t lda, const double *B, int32_t kc) {
    double *C = U + (j0 * u - j0 * (j0 - 1) / 2 - j0 + i);
    const hdi_real_tile t = {C, A, B, u - j0 - 1, 1, lda, n, 0, 0, kc};
    HDI_OF(real_tiles)(&t, j1 - j0, HDI_CAST(int64_t, kc) * HDI_COLS, j0 - i);
}

/* X = (C - A B) over kc columns, then X = X inv(D L') with the block's D L' in the rows of B that follow. */
HDI_PART void HDI_OF(real_solve)(const int nv, const hdi_real_tile *t, const double *dinv) {
    const HDI_OF(rows) g = HDI_OF(rows_of)(0, t->n);
    const double *B = t->B + HDI_CAST(int64_t, t->kc) * HDI_COLS;
    hdi_vec x[HDI_COLS][HDI_REGS];
    double *C = t->C;
    int j, k, v;
    HDI_OF(real_product)(x, nv, t->n, t->A, t->lda, t->B, t->kc);
    HDI_EACH(j, HDI_COLS) {
        if (j >= t->nc) continue;
        HDI_EACH(v, nv) {
            const double *c = C + j * t->step + HDI_WIDTH * v;
            x[j][v] = hdi_vsub(v < nv - 1 ? hdi_vload(c) : HDI_OF(load_rows)(c, g, HDI_WIDTH * v), x[j][v]);
        }
    }
    HDI_UNROLL
    for (j = 0; j < HDI_COLS; j++, B += HDI_COLS, C += t->step) {
        if (j == t->nc) return;
        HDI_EACH(v, nv) {
            x[j][v] = hdi_vmul(x[j][v], hdi_vall(dinv[j]));
            if (v < nv - 1) hdi_vstore(C + HDI_WIDTH * v, x[j][v]);
            else HDI_OF(store_rows)(C + HDI_WIDTH * v, x[j][v], g, HDI_WIDTH * v);
        }
        HDI_EACH(k, HDI_COLS) {
            const hdi_vec b = hdi_vall(B[k]);
            if (k <= j) continue;
            HDI_EACH(v, nv) x[k][v] = hdi_vfnma(x[j][v], b, x[k][v]);
        }
    }
}

HDI_KERNEL void HDI_OF(real_rows)(double *P, int64_t ld, int32_t n, int32_t k1, int32_t k, int32_t nb,
                                  const double *B, int32_t kb, const double *dinv) {
    hdi_real_tile t;
    t.C = P + k * ld;
    t.step = t.lda = ld;
    t.dec = 0;
    t.n = n;
    t.diag = -HDI_COLS;
    t.A = P + k1 * ld;
    t.B = B + HDI_CAST(int64_t, k1) * HDI_COLS;
    t.kc = k - k1;
    dinv += k;
    for (; nb > 0; nb -= HDI_COLS, dinv += HDI_COLS) {
        t.nc = nb < HDI_COLS ? nb : HDI_COLS;
        if (n > HDI_WIDTH * (HDI_REGS - 1)) HDI_OF(real_solve)(HDI_REGS, &t, dinv);
        else if (HDI_REGS > 2 && n > HDI_WIDTH) HDI_OF(real_solve)(2, &t, dinv);
        else HDI_OF(real_solve)(1, &t, dinv);
        t.C += HDI_COLS * ld;
        t.B += HDI_CAST(int64_t, kb) * HDI_COLS;
        t.kc += HDI_COLS;
    }
}

/* Vectors of a block of pivots: the first hold the nc pivots' own rows, the others n rows that follow; rows
 * of vector v, and how many. */
HDI_PART int32_t HDI_OF(real_first)(const int v, int32_t nc) {
    enum { top = HDI_COLS / HDI_WIDTH };
    return v < top ? HDI_WIDTH * v : nc + HDI_WIDTH * (v - top);
}
HDI_PART int32_t HDI_OF(real_count)(const int v, int32_t nc, int32_t n) {
    return v < HDI_COLS / HDI_WIDTH ? nc - HDI_WIDTH * v : n - HDI_WIDTH * (v - HDI_COLS / HDI_WIDTH);
}

/* For the rows below the pivots the same operations as in real_solve. */
HDI_PART void HDI_OF(real_pivots)(const int nv, double *P, int64_t ld, int32_t kc, int32_t nc, int32_t n,
                                  double *S, double *dinv) {
    enum { top = HDI_COLS / HDI_WIDTH };
    const double *row = P, *slice = S;
    double *C = P + kc * ld, *T = S + HDI_CAST(int64_t, kc) * HDI_COLS;
    hdi_vec x[HDI_COLS][HDI_REGS];
    int j, k, v;
    HDI_OF(real_zero)(x, nv);
    for (k = 0; k < kc; k++, row += ld, slice += HDI_COLS) {
        hdi_vec a[HDI_REGS];
        HDI_EACH(v, nv) a[v] = HDI_OF(load_some)(row + HDI_OF(real_first)(v, nc),
                                                 HDI_OF(real_count)(v, nc, n));
        HDI_OF(real_term)(x, nv, a, slice);
    }
    HDI_EACH(j, HDI_COLS) {
        if (j >= nc) continue;
        HDI_EACH(v, nv) {
            const double *c = C + j * ld + HDI_OF(real_first)(v, nc);
            x[j][v] = hdi_vsub(HDI_OF(load_some)(c, HDI_OF(real_count)(v, nc, n)), x[j][v]);
        }
    }
    HDI_UNROLL
    for (j = 0; j < HDI_COLS; j++, C += ld, T += HDI_COLS) {
        hdi_vec l[HDI_REGS];
        double d, q;
        if (j == nc) return;
        d = hdi_vlow(hdi_vlane(x[j][j / HDI_WIDTH], j % HDI_WIDTH));
        if (d == 0) {                            /* which hdi_real_block finds on the diagonal */
            C[j] = d;
            return;
        }
        q = 1 / d;
        dinv[kc + j] = q;
        HDI_EACH(v, nv) {
            const int32_t first = v < top ? j + 1 - HDI_WIDTH * v : 0;
            l[v] = hdi_vmul(x[j][v], hdi_vall(q));
            if (v < top) hdi_vstore(T + HDI_WIDTH * v, x[j][v]);
            HDI_OF(store_rows)(C + HDI_OF(real_first)(v, nc), l[v],
                               HDI_OF(rows_of)(first, HDI_OF(real_count)(v, nc, n)), 0);
        }
        C[j] = d;
        HDI_EACH(k, HDI_COLS) {
            if (k <= j) continue;
            HDI_EACH(v, nv) x[k][v] = hdi_vfnma(l[v], hdi_vlane(x[j][k / HDI_WIDTH], k % HDI_WIDTH), x[k][v]);
        }
    }
}

HDI_KERNEL void HDI_OF(real_block)(double *P, int64_t ld, int32_t k, int32_t nc, int32_t n, double *B,
                                   double *dinv) {
    enum { top = HDI_COLS / HDI_WIDTH };
    if (top + 2 <= HDI_REGS && n > HDI_WIDTH) HDI_OF(real_pivots)(HDI_REGS, P, ld, k, nc, n, B, dinv);
    else if (top + 1 <= HDI_REGS && n > 0) HDI_OF(real_pivots)(top + 1, P, ld, k, nc, n, B, dinv);
    else HDI_OF(real_pivots)(top, P, ld, k, nc, n, B, dinv);
}

/* One right-hand side is bound by memory, and runs are short: AVX-512 takes AVX2's kernels, measured as fast
 * or faster. */
#if HDI_WIDTH <= 4
HDI_KERNEL void HDI_OF(real_add)(double *y, const double *x, int64_t n) {
    for (; n >= HDI_WIDTH; n -= HDI_WIDTH, x += HDI_WIDTH, y += HDI_WIDTH)
        hdi_vstore(y, hdi_vadd(hdi_vload(y), hdi_vload(x)));
    for (; n > 0; n--) *y++ += *x++;
}

HDI_KERNEL void HDI_OF(real_gather)(double *t, const double *x, const int32_t *idx, int64_t n) {
    for (; n >= HDI_WIDTH; n -= HDI_WIDTH, t += HDI_WIDTH, idx += HDI_WIDTH)
        hdi_vstore(t, HDI_OF(gather)(x, idx));
    for (; n > 0; n--) *t++ = x[*idx++];
}

/* The eight columns from L on; missing ones are the last one again. */
HDI_PART void HDI_OF(real_columns)(const double **l, const double *L, int64_t ld, int32_t nc) {
    int j;
    HDI_EACH(j, 8) l[j] = L + (j < nc ? j : nc - 1) * ld;
}

/* y - L b in the rows from i on that fill a vector, or, with part, in the rest of them. Even columns are
 * summed apart from odd ones. wide: more than four columns. */
HDI_PART hdi_vec HDI_OF(real_minus)(hdi_vec y, const double *const *l, int64_t i, const int part,
                                    int32_t rest, const hdi_vec *b, int wide) {
    hdi_vec s[2];
    int j;
    s[0] = y;
    s[1] = hdi_vall(0);
    HDI_EACH(j, 8) {
        if (j >= 4 && !wide) continue;
        s[j % 2] = hdi_vfnma(part ? HDI_OF(load_tail)(l[j] + i, rest) : hdi_vload(l[j] + i), b[j], s[j % 2]);
    }
    return hdi_vadd(s[0], s[1]);
}

HDI_PART void HDI_OF(real_sweep)(double *y, const double *const *l, int64_t n, const hdi_vec *b, int wide,
                                 const int keep) {
    int64_t i;
    for (i = 0; i + HDI_WIDTH <= n; i += HDI_WIDTH)
        hdi_vstore(y + i, HDI_OF(real_minus)(keep ? hdi_vload(y + i) : hdi_vall(0), l, i, 0, 0, b, wide));
    if (i < n) {
        const int32_t rest = HDI_CAST(int32_t, n - i);
        const hdi_vec from = keep ? HDI_OF(load_tail)(y + i, rest) : hdi_vall(0);
        const hdi_vec to = HDI_OF(real_minus)(from, l, i, 1, rest, b, wide);
        HDI_OF(store_rows)(y + i, to, HDI_OF(rows_of)(0, rest), 0);
    }
}

HDI_KERNEL void HDI_OF(real_forward)(double *b, const double *L, int64_t ld, int32_t nc, int64_t n1,
                                     double *t, int64_t n2, int first) {
    const double *l[8];
    double x[8];
    hdi_vec v[8];
    int j, k;
    HDI_EACH(j, 8) x[j] = j < nc ? b[j] : 0.0;
    HDI_EACH(j, 8)
        HDI_EACH(k, 8)
            if (k > j && k < nc) x[k] = HDI_OF(fnma1)(L[k + j * ld], x[j], x[k]);
    HDI_EACH(j, 8) {
        v[j] = hdi_vall(x[j]);
        if (j < nc) b[j] = x[j];
    }
    HDI_OF(real_columns)(l, L + nc, ld, nc);
    HDI_OF(real_sweep)(b + nc, l, n1, v, nc > 4, 1);
    HDI_EACH(j, 8) l[j] += n1;
    if (first) HDI_OF(real_sweep)(t, l, n2, v, nc > 4, 0);
    else HDI_OF(real_sweep)(t, l, n2, v, nc > 4, 1);
}

/* s += L' y */
HDI_PART void HDI_OF(real_dots)(hdi_vec *s, const double *const *l, int64_t n, const double *y, int wide) {
    int64_t i;
    int j;
    for (i = 0; i + HDI_WIDTH <= n; i += HDI_WIDTH) {
        const hdi_vec v = hdi_vload(y + i);
        HDI_EACH(j, 8)
            if (j < 4 || wide) s[j] = hdi_vfma(hdi_vload(l[j] + i), v, s[j]);
    }
    if (i < n) {
        const hdi_vec v = HDI_OF(load_tail)(y + i, n - i);
        HDI_EACH(j, 8) s[j] = hdi_vfma(HDI_OF(load_tail)(l[j] + i, n - i), v, s[j]);
    }
}

HDI_KERNEL void HDI_OF(real_backward)(double *b, const double *L, int64_t ld, int32_t nc, int64_t n1,
                                      const double *t, int64_t n2) {
    const double *l[8];
    hdi_vec s[8];
    double x[8];
    int j, k;
    HDI_OF(real_columns)(l, L + nc, ld, nc);
    HDI_EACH(j, 8) s[j] = hdi_vall(0);
    HDI_OF(real_dots)(s, l, n1, b + nc, nc > 4);
    HDI_EACH(j, 8) {
        l[j] += n1;
        x[j] = 0;
        if (!HDI_OF(apart)) continue;
        x[j] = HDI_OF(sum)(s[j]);
        s[j] = hdi_vall(0);
    }
    HDI_OF(real_dots)(s, l, n2, t, nc > 4);
    HDI_EACH(j, 8) x[j] = j < nc ? b[j] - (x[j] + HDI_OF(sum)(s[j])) : 0.0;
    HDI_UNROLL
    for (k = 7; k > 0; k--) {
        HDI_EACH(j, 8)
            if (j < k && k < nc) x[j] = HDI_OF(fnma1)(L[k + j * ld], x[k], x[j]);
    }
    HDI_EACH(j, 8)
        if (j < nc) b[j] = x[j];
}
#endif

/* y -= L x in n_rows rows from i on: eight right-hand sides */
HDI_PART void HDI_OF(real_gemv8_rows)(const int n_rows, double *y, const int32_t *idx, const double *l,
                                      int64_t ld, int64_t i, const double *x, int32_t nc) {
    enum { n_vec = 8 / HDI_WIDTH };
    hdi_vec s[HDI_WIDTH][n_vec];
    int32_t k;
    int r, v;
    HDI_EACH(r, n_rows)
        HDI_EACH(v, n_vec) s[r][v] = hdi_vall(0);
    l += i;
    for (k = 0; k < nc; k++, l += ld, x += 8) {
        if (n_rows > 2) HDI_PREFETCH(l + 32);
        HDI_EACH(r, n_rows) {
            const hdi_vec a = hdi_vall(l[r]);
            HDI_EACH(v, n_vec) s[r][v] = hdi_vfma(hdi_vload(x + HDI_WIDTH * v), a, s[r][v]);
        }
    }
    HDI_EACH(r, n_rows) {
        double *to = y + 8 * (idx ? HDI_CAST(int64_t, idx[i + r]) : i + r);
        HDI_EACH(v, n_vec) hdi_vstore(to + HDI_WIDTH * v, hdi_vsub(hdi_vload(to + HDI_WIDTH * v), s[r][v]));
    }
}

HDI_KERNEL void HDI_OF(real_gemv8)(double *y, const int32_t *idx, const double *L, int64_t ld, int64_t n,
                                   const double *x, int32_t nc) {
    int64_t i = 0;
    for (; i + HDI_WIDTH <= n; i += HDI_WIDTH) HDI_OF(real_gemv8_rows)(HDI_WIDTH, y, idx, L, ld, i, x, nc);
    if (HDI_WIDTH > 2)
        for (; i + 2 <= n; i += 2) HDI_OF(real_gemv8_rows)(2, y, idx, L, ld, i, x, nc);
    if (i < n) HDI_OF(real_gemv8_rows)(1, y, idx, L, ld, i, x, nc);
}

/* x -= L' y for nc <= n_cols columns */
HDI_PART void HDI_OF(real_dots8_cols)(const int n_cols, double *x, const double *L, int64_t ld, int64_t n,
                                      const double *y, const int32_t *idx, int32_t nc) {
    enum { n_vec = 8 / HDI_WIDTH };
    const double *l[HDI_WIDTH];
    hdi_vec s[HDI_WIDTH][n_vec];
    int64_t i;
    int j, v;
    HDI_EACH(j, n_cols) {
        l[j] = L + (j < nc ? j : nc - 1) * ld;
        HDI_EACH(v, n_vec) s[j][v] = hdi_vall(0);
    }
    for (i = 0; i < n; i++) {
        const double *from = y + 8 * (idx ? HDI_CAST(int64_t, idx[i]) : i);
        HDI_EACH(j, n_cols) {
            const hdi_vec a = hdi_vall(l[j][i]);
            HDI_EACH(v, n_vec) s[j][v] = hdi_vfma(hdi_vload(from + HDI_WIDTH * v), a, s[j][v]);
        }
    }
    HDI_UNROLL
    for (j = 0; j < n_cols; j++, x += 8) {
        if (j >= nc) continue;
        HDI_EACH(v, n_vec) hdi_vstore(x + HDI_WIDTH * v, hdi_vsub(hdi_vload(x + HDI_WIDTH * v), s[j][v]));
    }
}

HDI_KERNEL void HDI_OF(real_dots8)(double *x, const double *L, int64_t ld, int64_t n, const double *y,
                                   const int32_t *idx, int32_t nc) {
    for (; nc > HDI_WIDTH / 2; nc -= HDI_WIDTH, x += 8 * HDI_WIDTH, L += HDI_WIDTH * ld)
        HDI_OF(real_dots8_cols)(HDI_WIDTH, x, L, ld, n, y, idx, nc);
    if (nc > 0) HDI_OF(real_dots8_cols)(HDI_WIDTH / 2, x, L, ld, n, y, idx, nc);
}

#if HDI_WIDTH == 2
/* Sums first, then the difference: eight rows do not fit into the registers. */
HDI_KERNEL void HDI_OF(real_lower8)(double *x, const double *L, int64_t ld, int32_t nc) {
    int32_t j;
    for (j = 1; j < nc; j++) HDI_OF(real_gemv8)(x + 8 * j, NULL, L + j, ld, 1, x, j);
}

HDI_KERNEL void HDI_OF(real_upper8)(double *x, const double *L, int64_t ld, int32_t nc) {
    int32_t j;
    for (j = nc - 2; j >= 0; j--)
        HDI_OF(real_dots8)(x + 8 * j, L + j + 1 + j * ld, ld, nc - 1 - j, x + 8 * (j + 1), NULL, 1);
}
#else
/* The solve with the triangle, whose row k and column j < k is at L[k + j ld], or its transpose. */
HDI_PART void HDI_OF(real_triangle8)(const int up, double *x, const double *L, int64_t ld, int32_t nc) {
    hdi_vec v[8];
    int32_t j, k;
    HDI_EACH(j, 8) v[j] = j < nc ? hdi_vload(x + 8 * j) : hdi_vall(0);
    HDI_EACH(k, 8) {
        HDI_EACH(j, 8) {
            if (!up && j < k && k < nc) v[k] = hdi_vfnma(v[j], hdi_vall(L[k + j * ld]), v[k]);
            if (up && j < 7 - k && 7 - k < nc) v[j] = hdi_vfnma(v[7 - k], hdi_vall(L[7 - k + j * ld]), v[j]);
        }
    }
    HDI_EACH(j, 8)
        if (j < nc) hdi_vstore(x + 8 * j, v[j]);
}

HDI_KERNEL void HDI_OF(real_lower8)(double *x, const double *L, int64_t ld, int32_t nc) {
    int v;
    for (v = 0; v < 8; v += HDI_WIDTH) HDI_OF(real_triangle8)(0, x + v, L, ld, nc);
}

HDI_KERNEL void HDI_OF(real_upper8)(double *x, const double *L, int64_t ld, int32_t nc) {
    int v;
    for (v = 0; v < 8; v += HDI_WIDTH) HDI_OF(real_triangle8)(1, x + v, L, ld, nc);
}
#endif

/* ---- packs ---- */

#if HDI_WIDTH == 8
/* An entry is one register. A product with the factor (r, m) = ((re, re), (im, im)) is summed in two halves,
 * and only the sums are brought together: re = p.lo - q.hi, im = p.hi + q.lo. */
typedef struct HDI_OF(entry) { hdi_vec v; } HDI_OF(entry);
typedef struct HDI_OF(twice) { hdi_vec r, m; } HDI_OF(twice);
typedef struct HDI_OF(total) { hdi_vec p, q; } HDI_OF(total);

HDI_PART void HDI_OF(entry_load)(HDI_OF(entry) *x, const double *from) { x->v = hdi_vload(from); }
HDI_PART void HDI_OF(entry_store)(double *to, const HDI_OF(entry) *x) { hdi_vstore(to, x->v); }
HDI_PART void HDI_OF(twice_load)(HDI_OF(twice) *f, const double *from) {
    f->r = hdi_twice512(from);
    f->m = hdi_twice512(from + 4);
}
/* s = x */
HDI_PART void HDI_OF(total_begin)(HDI_OF(total) *s, const HDI_OF(entry) *x) {
    s->p = x->v;
    s->q = hdi_vall(0);
}
HDI_PART void HDI_OF(total_zero)(HDI_OF(total) *s) { s->p = s->q = hdi_vall(0); }
/* s += x f */
HDI_PART void HDI_OF(total_add)(HDI_OF(total) *s, const HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    s->p = hdi_vfma(x->v, f->r, s->p);
    s->q = hdi_vfma(x->v, f->m, s->q);
}
/* s -= x f */
HDI_PART void HDI_OF(total_take)(HDI_OF(total) *s, const HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    s->p = hdi_vfnma(x->v, f->r, s->p);
    s->q = hdi_vfnma(x->v, f->m, s->q);
}
HDI_PART void HDI_OF(total_end)(HDI_OF(entry) *x, const HDI_OF(total) *s) { x->v = hdi_join512(s->p, s->q); }
/* x = x f */
HDI_PART void HDI_OF(entry_times)(HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    x->v = hdi_join512(hdi_vmul(x->v, f->r), hdi_vmul(x->v, f->m));
}
HDI_PART void HDI_OF(entry_scale)(HDI_OF(entry) *x, const HDI_OF(twice) *f) { HDI_OF(entry_times)(x, f); }
/* c = c - s, or -s */
HDI_PART void HDI_OF(total_put)(double *c, const HDI_OF(total) *s, int store) {
    hdi_vstore(c, hdi_vsub(store ? hdi_vall(0) : hdi_vload(c), hdi_join512(s->p, s->q)));
}
/* Sweeps: what is taken from y is summed apart. */
HDI_PART void HDI_OF(sweep_begin)(HDI_OF(total) *s, const double *y) { (void)y; HDI_OF(total_zero)(s); }
HDI_PART void HDI_OF(sweep_take)(HDI_OF(total) *s, const HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    HDI_OF(total_add)(s, x, f);
}
HDI_PART void HDI_OF(sweep_end)(double *y, const HDI_OF(total) *s) { HDI_OF(total_put)(y, s, 0); }
#else
/* An entry is its real parts and its imaginary parts. */
typedef struct HDI_OF(entry) { hdi_vec re[4 / HDI_WIDTH], im[4 / HDI_WIDTH]; } HDI_OF(entry);
typedef HDI_OF(entry) HDI_OF(twice);
typedef HDI_OF(entry) HDI_OF(total);
#ifndef HDI_HALVES
#define HDI_HALVES HDI_EACH(h, 4 / HDI_WIDTH)
#endif

HDI_PART void HDI_OF(entry_load)(HDI_OF(entry) *x, const double *from) {
    int h;
    HDI_HALVES {
        x->re[h] = hdi_vload(from + HDI_WIDTH * h);
        x->im[h] = hdi_vload(from + 4 + HDI_WIDTH * h);
    }
}
HDI_PART void HDI_OF(entry_store)(double *to, const HDI_OF(entry) *x) {
    int h;
    HDI_HALVES {
        hdi_vstore(to + HDI_WIDTH * h, x->re[h]);
        hdi_vstore(to + 4 + HDI_WIDTH * h, x->im[h]);
    }
}
HDI_PART void HDI_OF(twice_load)(HDI_OF(twice) *f, const double *from) { HDI_OF(entry_load)(f, from); }
HDI_PART void HDI_OF(total_begin)(HDI_OF(total) *s, const HDI_OF(entry) *x) { *s = *x; }
HDI_PART void HDI_OF(total_end)(HDI_OF(entry) *x, const HDI_OF(total) *s) { *x = *s; }
HDI_PART void HDI_OF(total_zero)(HDI_OF(total) *s) {
    int h;
    HDI_HALVES s->re[h] = s->im[h] = hdi_vall(0);
}
/* s -= x f, summed as plain C does */
HDI_PART void HDI_OF(sweep_take)(HDI_OF(total) *s, const HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    int h;
    HDI_HALVES {
        s->re[h] = hdi_vsub(s->re[h], HDI_OF(cross_minus)(x->re[h], f->re[h], x->im[h], f->im[h]));
        s->im[h] = hdi_vsub(s->im[h], HDI_OF(cross_plus)(x->im[h], f->re[h], x->re[h], f->im[h]));
    }
}
/* s += x f, s -= x f, by fma where the set has it */
HDI_PART void HDI_OF(total_add)(HDI_OF(total) *s, const HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    int h;
    HDI_HALVES {
        if (HDI_OF(fused)) {
            s->re[h] = hdi_vfnma(x->im[h], f->im[h], hdi_vfma(x->re[h], f->re[h], s->re[h]));
            s->im[h] = hdi_vfma(x->re[h], f->im[h], hdi_vfma(x->im[h], f->re[h], s->im[h]));
        } else {
            s->re[h] = hdi_vadd(s->re[h], HDI_OF(cross_minus)(x->re[h], f->re[h], x->im[h], f->im[h]));
            s->im[h] = hdi_vadd(s->im[h], HDI_OF(cross_plus)(x->im[h], f->re[h], x->re[h], f->im[h]));
        }
    }
}
HDI_PART void HDI_OF(total_take)(HDI_OF(total) *s, const HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    int h;
    if (!HDI_OF(fused)) {
        HDI_OF(sweep_take)(s, x, f);
        return;
    }
    HDI_HALVES {
        s->re[h] = hdi_vfma(x->im[h], f->im[h], hdi_vfnma(x->re[h], f->re[h], s->re[h]));
        s->im[h] = hdi_vfnma(x->re[h], f->im[h], hdi_vfnma(x->im[h], f->re[h], s->im[h]));
    }
}
/* x = x f as plain C does, and by fma where the set has it */
HDI_PART void HDI_OF(entry_scale)(HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    int h;
    HDI_HALVES {
        const hdi_vec re = x->re[h];
        x->re[h] = HDI_OF(cross_minus)(re, f->re[h], x->im[h], f->im[h]);
        x->im[h] = HDI_OF(cross_plus)(re, f->im[h], x->im[h], f->re[h]);
    }
}
HDI_PART void HDI_OF(entry_times)(HDI_OF(entry) *x, const HDI_OF(twice) *f) {
    int h;
    if (!HDI_OF(fused)) {
        HDI_OF(entry_scale)(x, f);
        return;
    }
    HDI_HALVES {
        const hdi_vec re = x->re[h];
        x->re[h] = HDI_OF(fms)(re, f->re[h], hdi_vmul(x->im[h], f->im[h]));
        x->im[h] = hdi_vfma(re, f->im[h], hdi_vmul(x->im[h], f->re[h]));
    }
}
/* c = c - s, or -s; of zero with the sign that the set has always given it */
HDI_PART void HDI_OF(total_put)(double *c, const HDI_OF(total) *s, int store) {
    const hdi_vec zero = hdi_vall(HDI_OF(fused) ? 0.0 : -0.0);
    int h;
    HDI_HALVES {
        double *to = c + HDI_WIDTH * h;
        hdi_vstore(to, hdi_vsub(store ? zero : hdi_vload(to), s->re[h]));
        hdi_vstore(to + 4, hdi_vsub(store ? zero : hdi_vload(to + 4), s->im[h]));
    }
}
HDI_PART void HDI_OF(sweep_begin)(HDI_OF(total) *s, const double *y) { HDI_OF(entry_load)(s, y); }
HDI_PART void HDI_OF(sweep_end)(double *y, const HDI_OF(total) *s) { HDI_OF(entry_store)(y, s); }
#endif

/* A tile of mr x nr entries. */
HDI_PART void HDI_OF(pack_tile)(const hdi_pack_job *g, const int mr, const int nr, int64_t i0, int64_t j0) {
    const double *a = g->a + i0 * g->a_row, *b = g->b + (j0 - g->b_first) * g->b_row;
    HDI_OF(total) s[HDI_OF(tile_rows)][HDI_OF(tile_cols)];
    int64_t k;
    int i, j;
    HDI_EACH(i, mr)
        HDI_EACH(j, nr) HDI_OF(total_zero)(&s[i][j]);
    for (k = g->depth; k > 0; k--, a += g->a_col, b += g->b_col) {
        HDI_OF(twice) f[HDI_OF(tile_cols)];
        HDI_EACH(j, nr) HDI_OF(twice_load)(&f[j], b + j * g->b_row);
        HDI_EACH(i, mr) {
            HDI_OF(entry) x;
            HDI_OF(entry_load)(&x, a + i * g->a_row);
            HDI_EACH(j, nr) HDI_OF(total_add)(&s[i][j], &x, &f[j]);
        }
    }
    HDI_EACH(i, mr) {
        double *c = hdi_pack_row(g, i0 + i) + HDI_PACK * j0;
        HDI_EACH(j, nr)
            if (!g->lower || j0 + j <= i0 + i) HDI_OF(total_put)(c + HDI_PACK * j, &s[i][j], g->store);
    }
}

/* Rows i..end-1 of nr columns. */
HDI_PART void HDI_OF(pack_columns)(const hdi_pack_job *g, const int nr, int64_t i, int64_t end, int64_t j) {
    enum { mr = HDI_OF(tile_rows) };
    for (; i + mr <= end; i += mr) HDI_OF(pack_tile)(g, mr, nr, i, j);
    if (mr > 3 && end - i == 3) HDI_OF(pack_tile)(g, 3, nr, i, j);
    else if (mr > 2 && end - i == 2) HDI_OF(pack_tile)(g, 2, nr, i, j);
    else if (mr > 1 && end - i == 1) HDI_OF(pack_tile)(g, 1, nr, i, j);
}

HDI_KERNEL void HDI_OF(pack_multiply)(const hdi_pack_job *g, int64_t i0, int64_t i1, int64_t j0, int64_t j1) {
    enum { nr = HDI_OF(tile_cols) };
    int64_t ib, i, j;
    for (ib = i0; ib < i1; ib += HDI_PACK_ROWS) {
        const int64_t ie = hdi_least(ib + HDI_PACK_ROWS, i1), je = g->lower ? hdi_least(ie, j1) : j1;
        for (j = j0; j < je; j += nr) {
            i = g->lower && j > ib ? j : ib;
            if (je - j >= nr) HDI_OF(pack_columns)(g, nr, i, ie, j);
            else if (nr > 2 && je - j == 2) HDI_OF(pack_columns)(g, 2, i, ie, j);
            else if (nr > 1) HDI_OF(pack_columns)(g, 1, i, ie, j);
        }
    }
}

/* mr rows at once, for independent chains of multiply-adds. */
HDI_PART void HDI_OF(pack_solve_tile)(const hdi_pack_rows *g, const int mr, double *x) {
    int32_t k, j;
    int i;
    for (k = 0; k < g->nb; k++, x += HDI_PACK) {
        const double *s = g->s + k * g->s_row;
        HDI_OF(total) t[HDI_OF(solve_rows)];
        HDI_OF(entry) y;
        HDI_OF(twice) f;
        HDI_EACH(i, mr) {
            HDI_OF(entry_load)(&y, x + i * g->row);
            HDI_OF(total_begin)(&t[i], &y);
        }
        for (j = -k; j < 0; j++, s += HDI_PACK) {
            HDI_OF(twice_load)(&f, s);
            HDI_EACH(i, mr) {
                HDI_OF(entry_load)(&y, x + i * g->row + HDI_PACK * j);
                HDI_OF(total_take)(&t[i], &y, &f);
            }
        }
        HDI_OF(twice_load)(&f, g->dinv + HDI_PACK * k);
        HDI_EACH(i, mr) {
            HDI_OF(total_end)(&y, &t[i]);
            HDI_OF(entry_times)(&y, &f);
            HDI_OF(entry_store)(x + i * g->row, &y);
        }
    }
}

HDI_KERNEL void HDI_OF(pack_solve_rows)(const hdi_pack_rows *g, int64_t r0, int64_t r1) {
    enum { mr = HDI_OF(solve_rows) };
    int64_t i = r0 - g->first;
    r1 -= g->first;
    for (; i + mr <= r1; i += mr) HDI_OF(pack_solve_tile)(g, mr, g->panel + i * g->row);
    if (mr > 2)
        for (; i + 2 <= r1; i += 2) HDI_OF(pack_solve_tile)(g, 2, g->panel + i * g->row);
    if (mr > 1 && i < r1) HDI_OF(pack_solve_tile)(g, 1, g->panel + i * g->row);
}

/* S(i,k) = l_ik d_k for rows [r0,r1), columns [k0,k1) of a panel; S by rows of k1 - k0 entries, row 0 being
 * r0. */
HDI_KERNEL void HDI_OF(pack_scale)(const double *panel, int64_t row, int64_t r0, int64_t r1, int64_t k0,
                                   int64_t k1, const double *d, double *s) {
    int64_t i, k;
    for (i = r0; i < r1; i++) {
        for (k = k0; k < k1; k++, s += HDI_PACK) {
            HDI_OF(entry) x;
            HDI_OF(twice) f;
            HDI_OF(entry_load)(&x, panel + i * row + HDI_PACK * k);
            HDI_OF(twice_load)(&f, d + HDI_PACK * k);
            HDI_OF(entry_scale)(&x, &f);
            HDI_OF(entry_store)(s, &x);
        }
    }
}

/* to[rel_b] += from[b] for b in [b0,b1), entries; off is taken off rel. */
HDI_KERNEL void HDI_OF(pack_add)(double *to, const double *from, const int32_t *rel, int64_t b0, int64_t b1,
                                 int64_t off) {
    int64_t b;
    int q;
    for (b = b0; b < b1; b++) {
        double *t = to + HDI_PACK * (rel[b] - off);
        const double *f = from + HDI_PACK * b;
        HDI_UNROLL
        for (q = 0; q < HDI_PACK; q += HDI_WIDTH)
            hdi_vstore(t + q, hdi_vadd(hdi_vload(t + q), hdi_vload(f + q)));
    }
}

/* Sweeps of one right-hand side through u rows of a panel. Forward: t_i -= sum_k l_ik y_k. */
HDI_PART void HDI_OF(pack_forward_rows)(const int n_rows, const double *l, int64_t p, const double *y,
                                        double *t) {
    HDI_OF(total) s[HDI_OF(sweep_rows)];
    int64_t k;
    int i;
    HDI_EACH(i, n_rows) HDI_OF(sweep_begin)(&s[i], t + HDI_PACK * i);
    for (k = 0; k < p; k++, l += HDI_PACK) {
        HDI_OF(twice) f;
        HDI_OF(twice_load)(&f, y + HDI_PACK * k);
        HDI_EACH(i, n_rows) {
            HDI_OF(entry) x;
            HDI_OF(entry_load)(&x, l + HDI_PACK * p * i);
            HDI_OF(sweep_take)(&s[i], &x, &f);
        }
    }
    HDI_EACH(i, n_rows) HDI_OF(sweep_end)(t + HDI_PACK * i, &s[i]);
}

HDI_KERNEL void HDI_OF(pack_forward)(const double *l, int64_t u, int64_t p, const double *y, double *t) {
    enum { n_rows = HDI_OF(sweep_rows) };
    int64_t i = 0;
    for (; i + n_rows <= u; i += n_rows)
        HDI_OF(pack_forward_rows)(n_rows, l + HDI_PACK * p * i, p, y, t + HDI_PACK * i);
    if (n_rows > 1)
        for (; i < u; i++) HDI_OF(pack_forward_rows)(1, l + HDI_PACK * p * i, p, y, t + HDI_PACK * i);
}

/* Backward: y_k -= sum_i l_ik x[row_i] for n_cols pivots; row NULL: row_i = i. */
HDI_PART void HDI_OF(pack_backward_cols)(const int n_cols, const double *l, const int32_t *row, int64_t u,
                                         int64_t p, double *y, const double *x) {
    HDI_OF(total) s[HDI_OF(sweep_cols)];
    int64_t i;
    int c;
    HDI_EACH(c, n_cols) HDI_OF(sweep_begin)(&s[c], y + HDI_PACK * c);
    for (i = 0; i < u; i++, l += HDI_PACK * p) {
        HDI_OF(twice) f;
        HDI_PREFETCH_AT(l, 1024);
        HDI_OF(twice_load)(&f, x + HDI_PACK * (row ? HDI_CAST(int64_t, row[i]) : i));
        HDI_EACH(c, n_cols) {
            HDI_OF(entry) v;
            HDI_OF(entry_load)(&v, l + HDI_PACK * c);
            HDI_OF(sweep_take)(&s[c], &v, &f);
        }
    }
    HDI_EACH(c, n_cols) HDI_OF(sweep_end)(y + HDI_PACK * c, &s[c]);
}

HDI_KERNEL void HDI_OF(pack_backward)(const double *l, const int32_t *row, int64_t u, int64_t p, double *y,
                                      const double *x) {
    enum { most = HDI_OF(sweep_cols) };
    int64_t k;
    for (k = 0; k + most <= p; k += most)
        HDI_OF(pack_backward_cols)(most, l + HDI_PACK * k, row, u, p, y + HDI_PACK * k, x);
    l += HDI_PACK * k;
    y += HDI_PACK * k;
    switch (p - k) {
        case 1: if (most > 1) HDI_OF(pack_backward_cols)(1, l, row, u, p, y, x); break;
        case 2: if (most > 2) HDI_OF(pack_backward_cols)(2, l, row, u, p, y, x); break;
        case 3: if (most > 3) HDI_OF(pack_backward_cols)(3, l, row, u, p, y, x); break;
        case 4: if (most > 4) HDI_OF(pack_backward_cols)(4, l, row, u, p, y, x); break;
        case 5: if (most > 5) HDI_OF(pack_backward_cols)(5, l, row, u, p, y, x); break;
        case 6: if (most > 6) HDI_OF(pack_backward_cols)(6, l, row, u, p, y, x); break;
        case 7: if (most > 7) HDI_OF(pack_backward_cols)(7, l, row, u, p, y, x); break;
        default: break;
    }
}

static const hdi_real_ops *HDI_OF(real_ops)(void) {
    static const hdi_real_ops hdi_ops = {
        HDI_REGS * HDI_WIDTH, HDI_COLS,
        HDI_OF(real_pack), HDI_OF(real_copy), HDI_OF(real_block), HDI_OF(real_rows), HDI_OF(real_gemm),
        HDI_OF(real_update), HDI_PASTE(real_add, HDI_SOLO), HDI_PASTE(real_forward, HDI_SOLO),
        HDI_PASTE(real_backward, HDI_SOLO), HDI_PASTE(real_gather, HDI_SOLO),
        HDI_OF(real_gemv8), HDI_OF(real_dots8), HDI_OF(real_lower8), HDI_OF(real_upper8)
    };
    return &hdi_ops;
}

static const hdi_pack_ops *HDI_OF(pack_ops)(void) {
    static const hdi_pack_ops hdi_ops = {HDI_OF(pack_multiply), HDI_OF(pack_solve_rows), HDI_OF(pack_scale),
                                         HDI_OF(pack_add), HDI_OF(pack_forward), HDI_OF(pack_backward)};
    return &hdi_ops;
}

#undef HDI_SET
#undef HDI_SOLO
#undef HDI_WIDTH
#endif /* HDI_SET */

#ifndef HDI_KERNELS_READ
#define HDI_KERNELS_READ

/* ---- choice of the instruction set ---- */

#if HDI_X86
#ifndef HEATDIFF_FILENAME
#ifdef __FILE_NAME__
#define HEATDIFF_FILENAME __FILE_NAME__          /* without folders: it is looked for beside itself */
#elif defined(__has_include)
#if __has_include(__FILE__)
#define HEATDIFF_FILENAME __FILE__
#endif
#endif
#ifndef HEATDIFF_FILENAME
#define HEATDIFF_FILENAME "heatdiff.h"
#endif
#endif
#define HDI_SET avx2
#define HDI_SOLO avx2
#define HDI_WIDTH 4
#include HEATDIFF_FILENAME
#ifdef HDI_SET
#error "heatdiff.h: HEATDIFF_FILENAME is not the name of this file, which has to include itself"
#endif
#define HDI_SET avx512
#define HDI_SOLO avx2
#define HDI_WIDTH 8
#include HEATDIFF_FILENAME
#endif

/* Kernels of a level: 0 plain C, 1 AVX2, 2 AVX-512. Never NULL: a level that was not compiled gives the plain
 * kernels. */
static const hdi_real_ops *hdi_real_ops_get(int level) {
#if HDI_X86
    if (level >= 2) return hdi_real_ops_avx512();
    if (level == 1) return hdi_real_ops_avx2();
#endif
    (void)level;
    return hdi_real_ops_plain();
}

static const hdi_pack_ops *hdi_pack_ops_get(int level) {
#if HDI_X86
    if (level >= 2) return hdi_pack_ops_avx512();
    if (level == 1) return hdi_pack_ops_avx2();
#endif
    (void)level;
    return hdi_pack_ops_plain();
}

/* ---- factorisation ---- */

typedef struct hdi_real_pivots {
    double largest, smallest;  /* of |d|; begin with 0 and DBL_MAX */
    int64_t negative;
} hdi_real_pivots;

/* Columns of L, and of U padded to slices, that are taken at a time in fronts of at most p pivots and u rows
 * below. */
static int64_t hdi_real_depth(int64_t p) { return hdi_least(p, HDI_REAL_KC); }
static int64_t hdi_real_span(int64_t u) {
    return hdi_least((u + HDI_REAL_NR - 1) / HDI_REAL_NR * HDI_REAL_NR, HDI_REAL_NC);
}

/* Work, in doubles: of one thread in hdi_real_update and hdi_real_rows for such fronts, and of S. */
static int64_t hdi_real_work(int64_t u, int64_t p) {
#ifdef HEATDIFF_USE_BLAS
    if (u > 0 && p >= HDI_REAL_KC) return HDI_REAL_KC * (HDI_REAL_NC + HDI_REAL_MR + 1);
#endif
    return hdi_real_depth(p) * (hdi_real_span(u) + HDI_REAL_MR + 1);
}
static int64_t hdi_real_s_size(int64_t p) {
    const int64_t nb = HDI_REAL_NB;
    return (p + HDI_REAL_NR) * (p < nb ? p + HDI_REAL_NR : nb);
}

/* Rows r0..r1-1 below pivots k0..k0+nb-1: L(r,K) = (P(r,K) - L(r,0..k0-1) S) inv(D L') for S as
 * hdi_real_block left it; rows of S per slice: kb. work [hdi_real_work(u, p)] is used only when k0 >=
 * HDI_REAL_KC. */
static void hdi_real_rows(const hdi_real_ops *o, double *P, int64_t m, int32_t k0, int32_t nb,
                          const double *S, int32_t kb, const double *dinv,
                          int64_t r0, int64_t r1, double *work) {
    const int32_t k1 = k0 - k0 % HDI_REAL_KC, mr = o->mr, nr = o->nr;
    int64_t r;
    int32_t j;
    for (r = r0; r < r1; r += mr) {
        const int32_t n = HDI_CAST(int32_t, r1 - r < mr ? r1 - r : mr);
        for (j = 0; j < k1; j += HDI_REAL_KC) {
            o->copy(work, P + r + j * m, m, n, HDI_REAL_KC);
            o->gemm(P + r + k0 * m, m, n, nb, work, mr, S + HDI_CAST(int64_t, j) * nr, kb, HDI_REAL_KC);
        }
        o->rows(P + r, m, n, k1, k0, nb, S, kb, dinv);
    }
}

/* Pivots K = k0..k0+nb-1 in rows k0..end-1: LDL' of P(K,K) - L(K,0..k0-1) D L(K,0..k0-1)', and as
 * hdi_real_rows, to the last bit, below K. nb <= HDI_REAL_NB, k0 a multiple of nr; end = k0 + nb, or up to m
 * when k0 + nb <= HDI_REAL_KC. S [k0 + nb rows of slices] becomes D L(K,0..k0+nb-1)'. d is left on the
 * diagonal of P. work [hdi_real_work(u, p)]. Returns -1, or the first pivot that is zero or not finite. */
static int64_t hdi_real_block(const hdi_real_ops *o, double *P, int64_t m, int32_t k0, int32_t nb,
                              int64_t end, double *S, double *dinv, hdi_real_pivots *pivots, double *work) {
    const int32_t nr = o->nr, kb = k0 + nb;
    int32_t k, j;
    for (k = k0; k < kb; k += nr, S += HDI_CAST(int64_t, kb) * nr) {
        const int32_t nc = kb - k < nr ? kb - k : nr;
        const int32_t n = HDI_CAST(int32_t, end - k - nc < o->mr - nr ? end - k - nc : o->mr - nr);
        double *slice = S;
        for (j = 0; j < k; j += HDI_REAL_KC) {
            const int32_t kc = k - j < HDI_REAL_KC ? k - j : HDI_REAL_KC;
            double d[HDI_REAL_KC];
            int32_t q;
            for (q = 0; q < kc; q++) d[q] = P[(j + q) * (m + 1)];
            o->pack(slice, P + k + j * m, m, d, nc, kc);
            slice += HDI_CAST(int64_t, kc) * nr;
        }
        o->block(P + k, m, k, nc, n, S, dinv);
        for (j = k; j < k + nc; j++) {
            const double d = P[j * (m + 1)], a = fabs(d);
            if (a == 0 || !hdi_finite(a)) return j;
            if (a > pivots->largest) pivots->largest = a;
            if (a < pivots->smallest) pivots->smallest = a;
            pivots->negative += d < 0;
        }
        if (k + nc + n < end) hdi_real_rows(o, P, m, k, nc, S, kb, dinv, k + nc + n, end, work);
    }
    return -1;
}

#ifdef HEATDIFF_USE_BLAS
/* hdi_real_update by the BLAS' dgemm, in blocks of 128 rows and 256 columns, for fronts that are worth the
 * calls. Update of 1000 rows by 500 pivots on one core: plain C 22 GF/s, OpenBLAS 0.3.21 40 (58 when told to
 * use AVX-512), our AVX2 kernels 62, AVX-512 115: so only plain C gives way to it. */
enum { HDI_BLAS_LEAST = 128, HDI_BLAS_ROWS = 128, HDI_BLAS_COLS = 256 };

static void hdi_blas_update(double *U, int64_t u, const double *P, int64_t m, int32_t p, double *work,
                            int64_t r0, int64_t r1) {
    double *S = work, *C = work + HDI_BLAS_COLS * HDI_REAL_KC;
    const int ld = HDI_CAST(int, m), ld_s = HDI_BLAS_COLS, ld_c = HDI_BLAS_ROWS;
    const double one = 1, zero = 0;
    int64_t g, i, j, r;
    int32_t k, q;
    for (g = 0; g < r1; g += HDI_BLAS_COLS) {
        const int cols = HDI_CAST(int, r1 - g < HDI_BLAS_COLS ? r1 - g : HDI_BLAS_COLS);
        for (k = 0; k < p; k += HDI_REAL_KC) {
            const int depth = p - k < HDI_REAL_KC ? p - k : HDI_REAL_KC;
            for (q = 0; q < depth; q++)
                for (j = 0; j < cols; j++)
                    S[j + q * HDI_BLAS_COLS] = P[p + g + j + (k + q) * m] * P[(k + q) * (m + 1)];
            for (r = r0 > g ? r0 : g; r < r1; r += HDI_BLAS_ROWS) {
                const int rows = HDI_CAST(int, r1 - r < HDI_BLAS_ROWS ? r1 - r : HDI_BLAS_ROWS);
                dgemm_("N", "T", &rows, &cols, &depth, &one, P + p + r + k * m, &ld, S, &ld_s, &zero, C,
                       &ld_c);
                for (j = 0; j < cols; j++) {
                    const int64_t c = g + j;
                    double *to = U + (c * u - c * (c - 1) / 2 - c);
                    for (i = r > c ? r : c; i < r + rows; i++) to[i] -= C[i - r + j * HDI_BLAS_ROWS];
                }
            }
        }
    }
}
#endif

/* Rows r0..r1-1 of U -= L21 D L21', columns as far as the diagonal. work [hdi_real_work(u, p)]. */
static void hdi_real_update(const hdi_real_ops *o, double *U, int64_t u, const double *P, int64_t m,
                            int32_t p, double *work, int64_t r0, int64_t r1) {
    const int32_t mr = o->mr;
    double *B = work, *copy = work + hdi_real_depth(p) * hdi_real_span(u),
        *d = copy + hdi_real_depth(p) * HDI_REAL_MR;
    int64_t g, i;
    int32_t k, q;
#ifdef HEATDIFF_USE_BLAS
    if (o == hdi_real_ops_plain() && u >= HDI_BLAS_LEAST && p >= HDI_BLAS_LEAST) {
        hdi_blas_update(U, u, P, m, p, work, r0, r1);
        return;
    }
#endif
    for (g = 0; g < r1; g += HDI_REAL_NC) {
        const int64_t g1 = r1 - g < HDI_REAL_NC ? r1 : g + HDI_REAL_NC;
        for (k = 0; k < p; k += HDI_REAL_KC) {
            const int32_t kc = p - k < HDI_REAL_KC ? p - k : HDI_REAL_KC;
            for (q = 0; q < kc; q++) d[q] = P[(k + q) * (m + 1)];
            o->pack(B, P + p + g + k * m, m, d, HDI_CAST(int32_t, g1 - g), kc);
            for (i = r0 > g ? r0 : g; i < r1; i += mr) {
                const int32_t n = HDI_CAST(int32_t, r1 - i < mr ? r1 - i : mr);
                const int64_t j1 = i + n < g1 ? i + n : g1;
                const double *A = P + p + i + k * m;
                if (j1 - g > 96) {  /* many columns: the rows are worth a copy in one piece */
                    o->copy(copy, A, m, n, kc);
                    o->update(U, u, i, n, g, j1, copy, mr, B, kc);
                } else o->update(U, u, i, n, g, j1, A, m, B, kc);
            }
        }
    }
}

/* The child's packed update, columns c0..c1-1, added to the parent's front: (i,j) goes to (rel[i], rel[j]),
 * rel ascending. Different columns of one child never meet. */
static void hdi_real_extend(const hdi_real_ops *o, double *P, int64_t m, int32_t p, double *U,
                            const double *child, int64_t uc, const int32_t *rel, int64_t c0, int64_t c1) {
    enum { n_runs = 64 };
    const int64_t u = m - p;
    int32_t run[n_runs + 1];  /* rows that go to consecutive places, from run[q] to run[q + 1] - 1 */
    int64_t i, j;
    int32_t n = 0, q, first = 0;
    for (i = c0; i < uc; i++)
        if (i == c0 || rel[i] != rel[i - 1] + 1) {
            if (n == n_runs) break;
            run[n++] = HDI_CAST(int32_t, i);
        }
    run[i < uc ? n - 1 : n] = HDI_CAST(int32_t, i);
    for (j = c0; j < c1; j++) {
        const int64_t at = rel[j];
        const double *c = child + (j * uc - j * (j - 1) / 2 - j);
        double *y = at < p ? P + at * m : U + ((at - p) * u - (at - p) * (at - p - 1) / 2 - at);
        if (i == uc && uc - c0 >= 4 * n) {
            while (first + 1 < n && run[first + 1] <= j) first++;
            for (q = first; q < n; q++) {
                const int64_t a = q == first ? j : run[q];
                o->add(y + rel[a], c + a, run[q + 1] - a);
            }
        } else {
            int64_t r;
            for (r = j; r < uc; r++) y[rel[r]] += c[r];
        }
    }
}

/* ---- solves ---- */

/* x1 = L11^-T (dinv x1 - L21' x[idx]). t [m - p]. dinv may be NULL: ones. */
static void hdi_real_backward(const hdi_real_ops *o, const double *P, int64_t m, int32_t p,
                              const double *dinv, double *x1, const double *x,
                              const int32_t *idx, double *t) {
    int32_t k;
    o->gather(t, x, idx, m - p);
    if (dinv)
        for (k = 0; k < p; k++) x1[k] *= dinv[k];
    for (k = (p - 1) & ~7; k >= 0; k -= 8) {
        const int32_t nc = p - k < 8 ? p - k : 8;
        o->backward(x1 + k, P + k + k * m, m, nc, p - k - nc, t, m - p);
    }
}

/* The same for eight right-hand sides, x row-major [.][8]. */
static void hdi_real_backward8(const hdi_real_ops *o, const double *P, int64_t m, int32_t p,
                               const double *dinv, double *x1, const double *x, const int32_t *idx) {
    int32_t k, j;
    for (k = (p - 1) & ~7; k >= 0; k -= 8) {
        const int32_t nc = p - k < 8 ? p - k : 8;
        double *b = x1 + 8 * k;
        if (dinv)
            for (j = 0; j < 8 * nc; j++) b[j] *= dinv[k + j / 8];
        if (m > p) o->dots8(b, P + p + k * m, m, m - p, x, idx, nc);
        if (k + nc < p) o->dots8(b, P + k + nc + k * m, m, p - k - nc, b + 8 * nc, NULL, nc);
        o->upper8(b, P + k + k * m, m, nc);
    }
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

/* For sums that may have overflowed. */
static hd_status hdi_csr_check_finite(const hd_csr *a, const char *text, hd_error *e) {
    int32_t i;
    int64_t p;
    for (i = 0; a->val && i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            if (!hdi_finite(a->val[p]))
                return hdi_fail_row(e, HD_ERR_NOT_FINITE, text, i, a->col[p], a->val[p]);
    return HD_OK;
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
    if (hdi_csr_check_finite(&a, "triplets: the sum of those at one place is not finite", e) >= 0)
        *out = hdi_csr_keep(&s, a);
    return hdi_scope_end(&s);
}

/* Whether a stores the entry (i,j), zero or not. */
static int hdi_csr_stores(const hd_csr *a, int32_t i, int32_t j) {
    int64_t p = a->row_ptr[i], end = a->row_ptr[i + 1];
    while (p < end) {
        const int64_t middle = p + (end - p) / 2;
        if (a->col[middle] == j) return 1;
        if (a->col[middle] < j) p = middle + 1;
        else end = middle;
    }
    return 0;
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
    if (hdi_csr_check_finite(&c, "product: an entry is not finite", e) >= 0) *out = hdi_csr_keep(&s, c);
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
        HDI_PREFETCH_AT(Ax, p + HDI_AHEAD);
        HDI_PREFETCH_AT(Aj, p + HDI_AHEAD);
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

/* ==== [08] spatial ====
 * A k-d tree over points in space: the k nearest, and all within a radius. Exact. May call [07].
 * This work is based on
 *   J. Friedman, J. Bentley, R. Finkel, An algorithm for finding best matches in logarithmic expected time, 1977 (medians, buckets)
 * Deviations: every leaf holds HDI_LEAF points (the last one is padded), so that nodes need no pointers, and distances to a leaf's points are one
 * loop of fixed length, which compilers vectorise; nodes have boxes that fit tightly, as a surface fills little of its cells; candidates are only
 * gathered, and sorted at the end by buckets, as squared distances on a surface are spread evenly; and a query takes its first bound from the one
 * before it, its neighbour in the order of the leaves: no k-th neighbour is farther than the other's k-th neighbour by way of the other. */

enum {
    HDI_LEAF = 16,             /* of 4, 8, 16, 32 the quickest for the 30 nearest on surfaces */
    HDI_TREE_STACK = 40,       /* halves of 2^31 points are fewer */
    HDI_BUCKETS = 64,
    HDI_SEARCH_TASKS = 64      /* as many sets of work arrays */
};

typedef struct hdi_cell {
    double lo[3], hi[3];       /* box of its points */
    int32_t first, count;      /* its leaves */
} hdi_cell;

/* Nodes in preorder: the left child follows its parent, the right one comes after the left one's 2 count - 1 nodes. */
typedef struct hdi_tree {
    int32_t n, n_leaves;
    hdi_cell *node;            /* [2 n_leaves - 1] */
    double *x;                 /* [3 HDI_LEAF n_leaves] leaf by leaf: all x, all y, all z */
    int32_t *id;               /* [HDI_LEAF n_leaves] of the caller */
} hdi_tree;

typedef struct hdi_point { double x[3]; int32_t id; } hdi_point;

/* Puts the point that is k-th along axis in its place, smaller ones before it, larger ones behind (Hoare 1961). Pivots are medians of three
 * places drawn by a fixed generator: linear whatever the order of the file, also for equal points. */
static void hdi_select_point(hdi_point *a, int64_t n, int64_t k, int axis) {
    int64_t lo = 0, hi = n - 1;
    uint64_t seed = 12345;
    while (lo < hi) {
        double p[3], pivot;
        int64_t i = lo, j = hi;
        int q;
        for (q = 0; q < 3; q++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            p[q] = a[lo + HDI_CAST(int64_t, (seed >> 33) % HDI_CAST(uint64_t, hi - lo + 1))].x[axis];
        }
        pivot = hdi_max(hdi_min(p[0], p[1]), hdi_min(hdi_max(p[0], p[1]), p[2]));
        while (i <= j) {
            while (a[i].x[axis] < pivot) i++;
            while (a[j].x[axis] > pivot) j--;
            if (i <= j) {
                const hdi_point swap = a[i];
                a[i++] = a[j];
                a[j--] = swap;
            }
        }
        if (k <= j) hi = j;
        else if (k >= i) lo = i;
        else return;
    }
}

/* Box of the node's points; returns its longest axis. */
static int hdi_cell_box(hdi_cell *node, const hdi_point *a, int64_t n) {
    int64_t i;
    int c, axis = 0;
    for (c = 0; c < 3; c++) node->lo[c] = node->hi[c] = n > 0 ? a[0].x[c] : 0;
    for (i = 1; i < n; i++) {
        for (c = 0; c < 3; c++) {
            node->lo[c] = hdi_min(node->lo[c], a[i].x[c]);
            node->hi[c] = hdi_max(node->hi[c], a[i].x[c]);
        }
    }
    for (c = 1; c < 3; c++)
        if (node->hi[c] - node->lo[c] > node->hi[axis] - node->lo[axis]) axis = c;
    return axis;
}

static void hdi_tree_split(hdi_tree *t, hdi_point *a) {
    int32_t v;
    t->node[0].first = 0;
    t->node[0].count = t->n_leaves;
    for (v = 0; v < 2 * t->n_leaves - 1; v++) {   /* parents come first */
        hdi_cell *node = t->node + v;
        const int64_t begin = HDI_CAST(int64_t, node->first) * HDI_LEAF, end = hdi_least(t->n, begin + HDI_CAST(int64_t, node->count) * HDI_LEAF);
        const int axis = hdi_cell_box(node, a + begin, end - begin);
        const int32_t left = node->count / 2;
        if (!left) continue;
        hdi_select_point(a + begin, end - begin, HDI_CAST(int64_t, left) * HDI_LEAF, axis);
        node[1].first = node->first;
        node[1].count = left;
        node[2 * left].first = node->first + left;
        node[2 * left].count = node->count - left;
    }
}

/* Finite points and queries, whose squared distances are finite too. */
static hd_status hdi_points_check(const double *xyz, int32_t n, const double *query, int32_t m, hd_error *e) {
    double lo[3] = {0, 0, 0}, hi[3] = {0, 0, 0}, size = 0;
    int64_t i;
    int pass, c;
    for (pass = 0; pass < 2; pass++) {
        const double *x = pass ? query : xyz;
        for (i = 0; i < 3 * HDI_CAST(int64_t, pass ? m : n) && x; i++) {
            if (!hdi_finite(x[i]) && pass) return hdi_fail_row(e, HD_ERR_NOT_FINITE, "a coordinate of a query is not finite", i / 3, i % 3, x[i]);
            if (!hdi_finite(x[i])) {
                hdi_fail(e, HD_ERR_NOT_FINITE, "a coordinate is not finite");
                e->vertex = i / 3;
                e->value = x[i];
                return e->status;
            }
            lo[i % 3] = hdi_min(lo[i % 3], x[i]);
            hi[i % 3] = hdi_max(hi[i % 3], x[i]);
        }
    }
    for (c = 0; c < 3; c++) size = hdi_max(size, hi[c] - lo[c]);
    if (!(size < 1e150)) return hdi_fail_row(e, HD_ERR_NOT_FINITE, "points: squared distances are not finite", -1, -1, size);
    return HD_OK;
}

/* The tree of finite points, in s. id of point i: i. Cost O(n log n). */
static hd_status hdi_tree_make(hdi_tree *t, const double *xyz, int32_t n, hdi_scope *s) {
    const int64_t n_leaves = n > 0 ? (HDI_CAST(int64_t, n) + HDI_LEAF - 1) / HDI_LEAF : 1;   /* none: one leaf that is all padding */
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    hdi_point *a = HDI_TAKE(&own, hdi_point, n);
    int64_t i;
    int c;
    t->n = n;
    t->n_leaves = HDI_CAST(int32_t, n_leaves);
    t->node = HDI_TAKE(s, hdi_cell, 2 * n_leaves - 1);
    t->x = HDI_TAKE(s, double, 3 * HDI_LEAF * n_leaves);
    t->id = HDI_TAKE(s, int32_t, HDI_LEAF * n_leaves);
    if (s->e->status < 0) return hdi_scope_end(&own);
    for (i = 0; i < n; i++) {
        for (c = 0; c < 3; c++) a[i].x[c] = xyz[3 * i + c];
        a[i].id = HDI_CAST(int32_t, i);
    }
    hdi_tree_split(t, a);
    for (i = 0; i < HDI_LEAF * n_leaves; i++) {
        double *x = t->x + 3 * HDI_LEAF * (i / HDI_LEAF) + i % HDI_LEAF;
        for (c = 0; c < 3; c++) x[c * HDI_LEAF] = i < n ? a[i].x[c] : HUGE_VAL;   /* infinitely far: in no result */
        t->id[i] = i < n ? a[i].id : -1;
    }
    return hdi_scope_end(&own);
}

/* What a search has found so far: candidates no farther than bound. */
typedef struct hdi_found {
    double bound, prune;       /* squared; boxes farther than prune are left out. It is a little larger, whatever a compiler fuses */
    int32_t k;                 /* > 0: the k nearest are wanted; 0: all, and HDI_COUNT: only how many */
    int64_t m, room;           /* candidates; when there are more than room, something is done about it */
    int64_t counted;
    double *d;                 /* [room + HDI_LEAF] squared distances */
    int32_t *id;               /* [room + HDI_LEAF] */
    hdi_pair *sorted;          /* [room + HDI_LEAF] */
} hdi_found;

enum { HDI_COUNT = -1 };

static void hdi_found_bound(hdi_found *f, double bound) {
    f->bound = hdi_min(bound, 1e305);            /* hdi_points_check keeps squared distances below 1e301 */
    f->prune = f->bound * (1 + 8 * DBL_EPSILON);
}

/* The min(k, m) smallest pairs (distance, id) into f->sorted, ascending; returns how many. */
static int64_t hdi_found_sort(hdi_found *f) {
    const int64_t want = hdi_least(f->k, f->m);
    int64_t end[HDI_BUCKETS + 1], i, from = 0, b;
    double most = 0, scale;
    for (i = 0; i < f->m; i++) most = hdi_max(most, f->d[i]);
    scale = most > 1e-290 ? HDI_CAST(double, HDI_BUCKETS) * 0.9999 / most : 0;
    memset(end, 0, sizeof end);
    for (i = 0; i < f->m; i++) end[HDI_CAST(int32_t, f->d[i] * scale)]++;
    hdi_prefix_sum(end, HDI_BUCKETS);
    for (i = 0; i < f->m; i++) {
        hdi_pair *to = f->sorted + end[HDI_CAST(int32_t, f->d[i] * scale)]++;
        memcpy(&to->key, f->d + i, sizeof to->key);   /* the bits of doubles that are not negative are in order */
        to->id = f->id[i];
    }
    for (b = 0; b < HDI_BUCKETS && from < want; b++) {
        hdi_sort_pairs(f->sorted + from, end[b] - from);
        from = end[b];
    }
    return want;
}

/* Too many candidates: keeps the k nearest, whose last is the new bound. */
static void hdi_found_shrink(hdi_found *f) {
    int64_t i;
    if (f->k == HDI_COUNT) {
        f->counted += f->m;
        f->m = 0;
        return;
    }
    f->m = hdi_found_sort(f);
    for (i = 0; i < f->m; i++) {
        memcpy(f->d + i, &f->sorted[i].key, sizeof *f->d);
        f->id[i] = HDI_CAST(int32_t, f->sorted[i].id);
    }
    hdi_found_bound(f, f->d[f->m - 1]);
}

static void hdi_scan_leaf(const hdi_tree *t, int32_t leaf, const double *q, hdi_found *f) {
    const double *HDI_RESTRICT x = t->x + 3 * HDI_LEAF * HDI_CAST(int64_t, leaf), q0 = q[0], q1 = q[1], q2 = q[2], bound = f->bound;
    const int32_t *HDI_RESTRICT id = t->id + HDI_LEAF * HDI_CAST(int64_t, leaf);
    double *HDI_RESTRICT d = f->d + f->m, r[HDI_LEAF];
    int32_t *HDI_RESTRICT found = f->id + f->m;
    int64_t m = 0;
    int i;
    for (i = 0; i < HDI_LEAF; i++) {
        const double a = x[i] - q0, b = x[HDI_LEAF + i] - q1, c = x[2 * HDI_LEAF + i] - q2;
        r[i] = a * a + b * b + c * c;
    }
    for (i = 0; i < HDI_LEAF; i++) {   /* without a branch: half of them would be guessed wrong */
        d[m] = r[i];
        found[m] = id[i];
        m += r[i] <= bound;
    }
    f->m += m;
    if (f->m > f->room) hdi_found_shrink(f);
}

static double hdi_box_distance(const hdi_cell *v, const double *q) {
    const double a = hdi_max(hdi_max(v->lo[0] - q[0], q[0] - v->hi[0]), 0);
    const double b = hdi_max(hdi_max(v->lo[1] - q[1], q[1] - v->hi[1]), 0);
    const double c = hdi_max(hdi_max(v->lo[2] - q[2], q[2] - v->hi[2]), 0);
    return a * a + b * b + c * c;
}

/* Everything no farther than f->bound, which shrinks when the k nearest are wanted: nearer halves first. */
static void hdi_search(const hdi_tree *t, const double *q, hdi_found *f) {
    struct { int32_t node; double d; } stack[HDI_TREE_STACK];
    int32_t v = 0;
    int top = 0;
    f->m = 0;
    for (;;) {
        const hdi_cell *node = t->node + v;
        while (node->count > 1) {
            const int32_t l = v + 1, r = v + 2 * (node->count / 2);
            const double dl = hdi_box_distance(t->node + l, q), dr = hdi_box_distance(t->node + r, q);
            const int left = dl <= dr;
            const double d_far = left ? dr : dl;
            stack[top].node = left ? r : l;
            stack[top].d = d_far;
            top += d_far <= f->prune;
            v = left ? l : r;
            node = t->node + v;
            if (!((left ? dl : dr) <= f->prune)) break;
        }
        if (node->count == 1) hdi_scan_leaf(t, node->first, q, f);
        do {
            if (!top) return;
            top--;
        } while (!(stack[top].d <= f->prune));
        v = stack[top].node;
    }
}

/* Many queries, in blocks that do not depend on the threads; a task has work arrays of its own. */
typedef struct hdi_search_job {
    const hdi_tree *t;
    const double *query;       /* [3 n_queries] */
    const int32_t *order;      /* [n_queries] queries in an order that keeps near ones together; NULL: as they come */
    int64_t n_queries, per_task;
    int32_t k, *index;         /* k nearest: [k n_queries] */
    double *distance2;         /* NULL: not wanted */
    double radius2;            /* all within a radius: counts first, then columns and distances */
    hd_csr *out;
    int32_t *kept;             /* [n_queries] entries of the rows */
    hdi_found *found;          /* [tasks] */
} hdi_search_job;

static int64_t hdi_search_tasks(hdi_search_job *job, int64_t room) {
    const int64_t blocks = (job->n_queries + 255) / 256, fit = 1 + (HDI_CAST(int64_t, 64) << 20) / (28 * (room + HDI_LEAF));
    const int64_t tasks = hdi_least(hdi_least(blocks, HDI_SEARCH_TASKS), fit);
    job->per_task = tasks ? (job->n_queries + tasks - 1) / tasks : 0;
    return tasks;
}

/* Work arrays for candidates of every task. */
static void hdi_search_take(hdi_search_job *job, int64_t tasks, int64_t room, hdi_scope *s) {
    const int64_t size = room + HDI_LEAF;
    double *d = HDI_TAKE(s, double, tasks * size);
    hdi_pair *sorted = HDI_TAKE(s, hdi_pair, tasks * size);
    int32_t *id = HDI_TAKE(s, int32_t, tasks * size);
    int64_t i;
    job->found = HDI_TAKE_ZERO(s, hdi_found, tasks);
    if (s->e->status < 0) return;
    for (i = 0; i < tasks; i++) {
        job->found[i].room = room;
        job->found[i].d = d + i * size;
        job->found[i].id = id + i * size;
        job->found[i].sorted = sorted + i * size;
    }
}

static double hdi_distance2(const double *a, const double *b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

static void hdi_nearest_task(void *arg, int64_t index, int32_t worker) {
    const hdi_search_job *job = HDI_CAST(const hdi_search_job *, arg);
    const int64_t begin = index * job->per_task, end = hdi_least(job->n_queries, begin + job->per_task);
    hdi_found *f = job->found + index;
    const double *before = NULL;
    double reach = 0;                            /* distance of its k-th neighbour */
    int64_t i, p;
    (void)worker;
    f->k = job->k;
    for (i = begin; i < end; i++) {
        const int64_t v = job->order ? job->order[i] : i, k = job->k;
        const double *q = job->query + 3 * v;
        const double limit = before ? reach + sqrt(hdi_distance2(q, before)) : 0;
        int64_t m;
        hdi_found_bound(f, before ? limit * limit * (1 + 16 * DBL_EPSILON) : 1e305);
        hdi_search(job->t, q, f);
        m = hdi_found_sort(f);
        for (p = 0; p < k; p++) job->index[v * k + p] = p < m ? HDI_CAST(int32_t, f->sorted[p].id) : -1;
        for (p = 0; job->distance2 && p < k; p++) {
            if (p < m) memcpy(job->distance2 + v * k + p, &f->sorted[p].key, sizeof(double));
            else job->distance2[v * k + p] = HUGE_VAL;
        }
        before = m == k ? q : NULL;
        if (!before) continue;
        memcpy(&reach, &f->sorted[k - 1].key, sizeof reach);
        reach = sqrt(reach);
    }
}

/* index [k n_queries] and distance2 (or NULL) by queries: neighbours ascend by distance, equally far ones by id; -1 where there are no more.
 * queries NULL: the points xyz of the tree. */
static hd_status hdi_nearest(const hdi_tree *t, const double *xyz, const double *query, int64_t n_queries, int32_t k, int32_t *index,
                             double *distance2, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    const int64_t room = 2 * HDI_CAST(int64_t, k) + 32;
    hdi_search_job job;
    int64_t tasks;
    memset(&job, 0, sizeof job);
    job.t = t;
    job.query = query ? query : xyz;
    job.order = query ? NULL : t->id;
    job.n_queries = n_queries;
    job.k = k;
    job.index = index;
    job.distance2 = distance2;
    tasks = hdi_search_tasks(&job, room);
    hdi_search_take(&job, tasks, room, &s);
    if (e->status >= 0) hdi_parallel(ctx, tasks, hdi_nearest_task, &job);
    return hdi_scope_end(&s);
}

/* Sorts keys; work [n]. Runs of eight by insertion, then merged. */
static void hdi_sort_keys(uint64_t *a, int64_t n, uint64_t *work) {
    uint64_t *from = a, *to = work;
    int64_t i, j, run;
    for (i = 1; i < n; i++) {
        const uint64_t x = a[i];
        for (j = i; j & 7 && x < a[j - 1]; j--) a[j] = a[j - 1];
        a[j] = x;
    }
    for (run = 8; run < n; run *= 2) {
        uint64_t *swap = from;
        for (i = 0; i < n; i += 2 * run) {
            const int64_t middle = hdi_least(i + run, n), end = hdi_least(i + 2 * run, n);
            int64_t p = i, q = middle, out = i;
            while (p < middle && q < end) {
                const int second = from[q] < from[p];
                to[out++] = second ? from[q] : from[p];
                q += second;
                p += !second;
            }
            while (p < middle) to[out++] = from[p++];
            while (q < end) to[out++] = from[q++];
        }
        from = to;
        to = swap;
    }
    if (from != a) memcpy(a, from, HDI_CAST(size_t, n) * sizeof *a);
}

/* Counts are of a radius that is a little larger: compilers may round the distances of one pass otherwise
 * than those of the other. */
static void hdi_count_task(void *arg, int64_t index, int32_t worker) {
    const hdi_search_job *job = HDI_CAST(const hdi_search_job *, arg);
    const int64_t begin = index * job->per_task, end = hdi_least(job->n_queries, begin + job->per_task);
    hdi_found *f = job->found + index;
    int64_t i;
    (void)worker;
    f->k = HDI_COUNT;
    for (i = begin; i < end; i++) {
        const int64_t v = job->order ? job->order[i] : i;
        f->counted = 0;
        hdi_found_bound(f, job->radius2 * (1 + 8 * DBL_EPSILON) + DBL_MIN);
        hdi_search(job->t, job->query + 3 * v, f);
        job->out->row_ptr[v] = f->counted + f->m;
    }
}

/* One row: columns ascending. What was gathered is sorted by id with its place as a payload. */
static void hdi_within_row(const hdi_found *f, int32_t *col, double *val) {
    uint64_t *key = HDI_CAST(uint64_t *, HDI_CAST(void *, f->sorted)), *work = key + f->m;   /* room for twice as many */
    int64_t p;
    for (p = 0; p < f->m; p++) key[p] = HDI_CAST(uint64_t, f->id[p]) << 32 | HDI_CAST(uint64_t, p);
    hdi_sort_keys(key, f->m, work);
    for (p = 0; p < f->m; p++) {
        col[p] = HDI_CAST(int32_t, key[p] >> 32);
        if (val) val[p] = f->d[key[p] & 0xffffffffu];
    }
}

static void hdi_within_task(void *arg, int64_t index, int32_t worker) {
    const hdi_search_job *job = HDI_CAST(const hdi_search_job *, arg);
    const int64_t begin = index * job->per_task, end = hdi_least(job->n_queries, begin + job->per_task);
    hdi_found *f = job->found + index;
    hd_csr *out = job->out;
    int64_t i;
    (void)worker;
    f->k = 0;
    for (i = begin; i < end; i++) {
        const int64_t v = job->order ? job->order[i] : i;
        hdi_found_bound(f, job->radius2);
        hdi_search(job->t, job->query + 3 * v, f);
        hdi_within_row(f, out->col + out->row_ptr[v], out->val + out->row_ptr[v]);
        job->kept[v] = HDI_CAST(int32_t, f->m);
    }
}

/* out: row i lists the points of the tree whose squared distance from query i is at most radius2, values are these. Counted in a first pass, written
 * in a second one. Other arguments as in hdi_nearest. */
/* Closes the gaps that rows with fewer entries than were counted leave. */
static void hdi_within_close(hd_csr *a, const int32_t *kept) {
    int64_t to = 0;
    int32_t i;
    for (i = 0; i < a->n_rows; i++) {
        const int64_t from = a->row_ptr[i];
        if (from != to) {
            memmove(a->col + to, a->col + from, HDI_CAST(size_t, kept[i]) * sizeof *a->col);
            memmove(a->val + to, a->val + from, HDI_CAST(size_t, kept[i]) * sizeof *a->val);
        }
        a->row_ptr[i] = to;
        to += kept[i];
    }
    a->nnz = a->row_ptr[a->n_rows] = to;
}

static hd_status hdi_within(hd_csr *out, const hdi_tree *t, const double *xyz, const double *query, int32_t n_queries, double radius2, hd_context *ctx,
                            hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e), passes = hdi_scope_begin(ctx, e);
    hdi_search_job job;
    hd_csr a;
    int64_t tasks, widest = 0, i;
    memset(&job, 0, sizeof job);
    a = hdi_csr_take(&s, n_queries, t->n, 0, 0);
    job.t = t;
    job.query = query ? query : xyz;
    job.order = query ? NULL : t->id;
    job.n_queries = n_queries;
    job.radius2 = radius2;
    job.out = &a;
    tasks = hdi_search_tasks(&job, 256);
    hdi_search_take(&job, tasks, 256, &passes);
    if (e->status >= 0) hdi_parallel(ctx, tasks, hdi_count_task, &job);
    if (hdi_scope_end(&passes) < 0) return hdi_scope_end(&s);
    for (i = 0; i < n_queries; i++) widest = a.row_ptr[i] > widest ? a.row_ptr[i] : widest;
    a.nnz = hdi_prefix_sum(a.row_ptr, n_queries);
    a.col = HDI_TAKE(&s, int32_t, a.nnz);
    a.val = HDI_TAKE(&s, double, a.nnz);
    tasks = hdi_search_tasks(&job, widest);
    hdi_search_take(&job, tasks, widest, &passes);
    job.kept = HDI_TAKE(&passes, int32_t, n_queries);
    if (e->status >= 0) {
        hdi_parallel(ctx, tasks, hdi_within_task, &job);
        hdi_within_close(&a, job.kept);
    }
    if (hdi_scope_end(&passes) < 0) return hdi_scope_end(&s);
    *out = hdi_csr_keep(&s, a);
    return hdi_scope_end(&s);
}

/* ==== [09] geometry ====
 * Triangles: checks, corner cotangents, which faces are left out, edges, and who meets at a vertex. May call [08]. */

typedef struct hdi_mesh {
    const double *xyz;
    const int32_t *tri;
    const int32_t *face;/* [m] the caller's number of each face; NULL: their own */
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
static HDI_INLINE double hdi_det2(double a, double b, double c, double d) {
    const double x = a * b - c * d;
    volatile double p, q;
    if (fabs(x) > 4 * DBL_EPSILON * fabs(a * b)) return x;
    p = a * b;
    q = c * d;
    return p - q;
}

static HDI_INLINE void hdi_cross3(const double *a, const double *b, double *out) {
    out[0] = hdi_det2(a[1], b[2], a[2], b[1]);
    out[1] = hdi_det2(a[2], b[0], a[0], b[2]);
    out[2] = hdi_det2(a[0], b[1], a[1], b[0]);
}

/* Length without squares that underflow or overflow. */
static HDI_INLINE double hdi_norm3(const double *a) {
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

/* What a block of faces adds to the report. */
typedef struct hdi_face_tally {
    int32_t n_repeated_corner, n_zero_area, bad, bad_vertex;   /* bad: the first face whose area is not finite, or -1 */
    double steepest, bad_area;                     /* steepest: the largest cotangent, of the smallest angle */
} hdi_face_tally;

/* Area of face f, and its cotangents; 0 where it has none or where a cotangent would not be finite. */
static HDI_INLINE double hdi_face_measure(const hdi_mesh *mesh, int32_t f, double *cot, hdi_face_tally *tally) {
    const int32_t *v = mesh->tri + 3 * HDI_CAST(int64_t, f);
    double edge[3][3], cross[3], twice;
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        tally->n_repeated_corner++;
        return 0;
    }
    hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, v[2]), mesh->xyz + 3 * HDI_CAST(int64_t, v[1]), edge[0]);   /* edge q runs opposite to corner q */
    hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, v[0]), mesh->xyz + 3 * HDI_CAST(int64_t, v[2]), edge[1]);
    hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, v[1]), mesh->xyz + 3 * HDI_CAST(int64_t, v[0]), edge[2]);
    hdi_cross3(edge[2], edge[0], cross);
    twice = hdi_norm3(cross);
    if (!hdi_finite(twice)) {
        const int32_t id = mesh->face ? mesh->face[f] : f;
        if (tally->bad < 0 || id < tally->bad) {
            tally->bad = id;
            tally->bad_vertex = v[0];
            tally->bad_area = twice;
        }
        return 0;
    }
    if (twice / 24 >= DBL_MIN) {
        cot[0] = -hdi_dot3(edge[1], edge[2]) / twice;
        cot[1] = -hdi_dot3(edge[2], edge[0]) / twice;
        cot[2] = -hdi_dot3(edge[0], edge[1]) / twice;
    }
    if (twice / 24 < DBL_MIN || !hdi_finite(fabs(cot[0]) + fabs(cot[1]) + fabs(cot[2]))) {
        tally->n_zero_area++;
        return 0;
    }
    tally->steepest = hdi_max(tally->steepest, hdi_max(cot[0], hdi_max(cot[1], cot[2])));
    return twice / 2;
}

static void hdi_tally_clear(hdi_face_tally *tally) {
    memset(tally, 0, sizeof *tally);
    tally->bad = tally->bad_vertex = -1;
    tally->steepest = -HUGE_VAL;
}

static void hdi_tally_add(hdi_face_tally *all, const hdi_face_tally *t) {
    all->n_repeated_corner += t->n_repeated_corner;
    all->n_zero_area += t->n_zero_area;
    all->steepest = hdi_max(all->steepest, t->steepest);
    if (t->bad < 0 || (all->bad >= 0 && all->bad < t->bad)) return;
    all->bad = t->bad;
    all->bad_vertex = t->bad_vertex;
    all->bad_area = t->bad_area;
}

/* What the report says of faces one by one. */
static hd_status hdi_tally_report(const hdi_face_tally *tally, int32_t m, hd_mesh_report *rep, hd_error *e) {
    if (tally->bad >= 0)
        return hdi_fail_face(e, HD_ERR_NOT_FINITE, "a face is too large: its area is not finite", tally->bad, tally->bad_vertex, tally->bad_area);
    rep->n_faces = m;
    rep->n_repeated_corner = tally->n_repeated_corner;
    rep->n_zero_area = tally->n_zero_area;
    rep->n_faces_used = m - tally->n_repeated_corner - tally->n_zero_area;
    rep->smallest_angle = rep->n_faces_used > 0 ? atan2(1, tally->steepest) : 0;
    return HD_OK;
}

enum { HDI_FACES_PER_TASK = 8192, HDI_FACES_AHEAD = 16, HDI_VERTICES_AHEAD = 8 };   /* how far ahead memory is asked for what will be needed */

typedef struct hdi_measure_job { const hdi_mesh *mesh; hdi_face_tally *tally; } hdi_measure_job;

static void hdi_measure_task(void *arg, int64_t index, int32_t worker) {
    const hdi_measure_job *job = HDI_CAST(const hdi_measure_job *, arg);
    const int64_t begin = index * HDI_FACES_PER_TASK, end = hdi_least(job->mesh->m, begin + HDI_FACES_PER_TASK);
    hdi_face_tally tally;
    int64_t f;
    (void)worker;
    hdi_tally_clear(&tally);
    for (f = begin; f < end; f++) {
        const int32_t *ahead = job->mesh->tri + 3 * hdi_least(f + HDI_FACES_AHEAD, end - 1);
        HDI_PREFETCH(job->mesh->xyz + 3 * HDI_CAST(int64_t, ahead[0]));
        HDI_PREFETCH(job->mesh->xyz + 3 * HDI_CAST(int64_t, ahead[1]));
        HDI_PREFETCH(job->mesh->xyz + 3 * HDI_CAST(int64_t, ahead[2]));
        job->mesh->area[f] = hdi_face_measure(job->mesh, HDI_CAST(int32_t, f), job->mesh->cot + 3 * f, &tally);
    }
    job->tally[index] = tally;
}

/* All faces of a mesh whose indices are fine: cot and area. */
static hd_status hdi_faces_measure(const hdi_mesh *mesh, hd_mesh_report *rep, hdi_scope *s) {
    const int64_t n_tasks = (HDI_CAST(int64_t, mesh->m) + HDI_FACES_PER_TASK - 1) / HDI_FACES_PER_TASK;
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    hdi_face_tally all;
    hdi_measure_job job;
    int64_t i;
    hdi_tally_clear(&all);
    job.mesh = mesh;
    job.tally = HDI_TAKE(&own, hdi_face_tally, n_tasks);
    if (!job.tally) return hdi_scope_end(&own);
    hdi_parallel(s->ctx, n_tasks, hdi_measure_task, &job);
    for (i = 0; i < n_tasks; i++) hdi_tally_add(&all, job.tally + i);
    (void)hdi_tally_report(&all, mesh->m, rep, s->e);
    return hdi_scope_end(&own);
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

static int64_t hdi_most_corners(const hdi_mesh *mesh) {
    int64_t most = 1;
    int32_t i;
    for (i = 0; i < mesh->n; i++)
        if (mesh->corner_ptr[i + 1] - mesh->corner_ptr[i] > most) most = mesh->corner_ptr[i + 1] - mesh->corner_ptr[i];
    return most;
}

/* ---- sides ----
 * The sides of all faces with area, gathered by the smaller of their two vertices and sorted by the larger one, then by face: an edge is a run. */
typedef struct hdi_sides {
    int32_t *ptr;               /* [n + 1] runs at a vertex */
    uint64_t *key;              /* [3 m] larger vertex << 32 | 4 face + corner where the side begins */
    uint64_t *work;             /* [2 busiest vertex] */
} hdi_sides;

static const signed char hdi_next3[3] = {1, 2, 0}, hdi_prev3[3] = {2, 0, 1};

static int32_t hdi_key_face(uint64_t key) { return HDI_CAST(int32_t, (key & 0xffffffffu) >> 2); }
static int hdi_key_corner(uint64_t key) { return HDI_CAST(int, key & 3); }
static int32_t hdi_key_vertex(uint64_t key) { return HDI_CAST(int32_t, key >> 32); }
/* The corner opposite to the side. */
static int64_t hdi_key_opposite(uint64_t key) { return 3 * HDI_CAST(int64_t, hdi_key_face(key)) + hdi_prev3[hdi_key_corner(key)]; }

static void hdi_sides_gather(const hdi_mesh *mesh, hdi_sides *g) {
    const int32_t *v = mesh->tri;
    int32_t f, i, sum = 0, *at = g->ptr;
    memset(at, 0, (HDI_CAST(size_t, mesh->n) + 1) * sizeof *at);
    for (f = 0; f < mesh->m; f++, v += 3) {
        if (!(mesh->area[f] > 0)) continue;
        at[v[0] < v[1] ? v[0] : v[1]]++;
        at[v[1] < v[2] ? v[1] : v[2]]++;
        at[v[2] < v[0] ? v[2] : v[0]]++;
    }
    for (i = 0; i < mesh->n; i++) {
        const int32_t count = at[i];
        at[i] = sum;
        sum += count;
    }
    for (f = 0, v = mesh->tri; f < mesh->m; f++, v += 3) {
        const uint64_t low = HDI_CAST(uint64_t, f) << 2;
        const uint32_t a = HDI_CAST(uint32_t, v[0]), b = HDI_CAST(uint32_t, v[1]), c = HDI_CAST(uint32_t, v[2]);
        if (!(mesh->area[f] > 0)) continue;
        g->key[at[a < b ? a : b]++] = HDI_CAST(uint64_t, a < b ? b : a) << 32 | low;
        g->key[at[b < c ? b : c]++] = HDI_CAST(uint64_t, b < c ? c : b) << 32 | (low + 1);
        g->key[at[c < a ? c : a]++] = HDI_CAST(uint64_t, c < a ? a : c) << 32 | (low + 2);
    }
    memmove(at + 1, at, HDI_CAST(size_t, mesh->n) * sizeof *at);
    at[0] = 0;
}

/* Sorts the sides at vertex i. Most lists are short. */
static void hdi_sides_sort(hdi_sides *g, int32_t i) {
    uint64_t *a = g->key + g->ptr[i];
    const int64_t n = g->ptr[i + 1] - g->ptr[i];
    int64_t p, q;
    if (n > 24) {
        hdi_sort_keys(a, n, g->work);
        return;
    }
    for (p = 1; p < n; p++) {
        const uint64_t x = a[p];
        for (q = p; q > 0 && x < a[q - 1]; q--) a[q] = a[q - 1];
        a[q] = x;
    }
}

static HDI_INLINE double hdi_edge_length(const double *xyz, int32_t i, int32_t j) {
    double edge[3];
    hdi_sub3(xyz + 3 * HDI_CAST(int64_t, j), xyz + 3 * HDI_CAST(int64_t, i), edge);
    return hdi_norm3(edge);
}

/* Gathers the sides; g->work has room to sort those of the busiest vertex. */
static hd_status hdi_sides_make(hdi_sides *g, const hdi_mesh *mesh, hdi_scope *s) {
    int32_t i, most = 1;
    g->ptr = HDI_TAKE(s, int32_t, HDI_CAST(int64_t, mesh->n) + 1);
    g->key = HDI_TAKE(s, uint64_t, 3 * HDI_CAST(int64_t, mesh->m));
    if (s->e->status < 0) return s->e->status;
    hdi_sides_gather(mesh, g);
    for (i = 0; i < mesh->n; i++)
        if (g->ptr[i + 1] - g->ptr[i] > most) most = g->ptr[i + 1] - g->ptr[i];
    g->work = HDI_TAKE(s, uint64_t, 2 * HDI_CAST(int64_t, most));
    return s->e->status;
}

/* How many connected sets of vertices are united in parent [n], which is overwritten; single vertices are none. */
static int32_t hdi_count_sets(int32_t *parent, int32_t n) {
    int32_t i, count = 0;
    for (i = 0; i < n; i++) parent[i] = hdi_find(parent, i);
    for (i = 0; i < n; i++) {                    /* a set is a root with another vertex */
        const int32_t root = parent[i];
        if (root == i || root < 0 || parent[root] != root) continue;
        parent[root] = -1;                       /* counted; it is the smallest of its set, so it has been passed */
        count++;
    }
    return count;
}

/* ---- edges ---- */

/* The edges of a mesh from each vertex to later ones, in order. */
typedef struct hdi_edges {
    int32_t *first, *last;      /* [n + 1], [n] those of a vertex: from its first on, before its last; in between there may be unused ones */
    int32_t *to;                /* the later vertex; in intrinsic triangulations also the vertex itself */
    double *w;                  /* minus half the cotangents opposite to it */
    double *b;                  /* a twelfth of the areas of its faces; NULL: not wanted */
    int32_t *smaller, *larger;  /* [n] neighbours of a vertex: those before it and those after it */
    int32_t *parent;            /* [n] vertices united along edges */
    double length;              /* of all edges, each once */
    int32_t shift;              /* 2^shift vertices a block, which few edges leave */
} hdi_edges;

/* Room for the edges of m faces; room 0: for counts only. */
static hd_status hdi_edges_take(hdi_edges *g, int32_t n, int64_t room, int full, hdi_scope *s) {
    int32_t i;
    memset(g, 0, sizeof *g);
    g->shift = 31;
    g->first = HDI_TAKE(s, int32_t, HDI_CAST(int64_t, n) + 1);
    if (g->first) g->last = g->first + 1;
    if (room) g->to = HDI_TAKE(s, int32_t, room);
    if (room) g->w = HDI_TAKE(s, double, room);
    if (room && full) g->b = HDI_TAKE(s, double, room);
    g->smaller = HDI_TAKE_ZERO(s, int32_t, n);
    g->larger = HDI_TAKE_ZERO(s, int32_t, n);
    g->parent = HDI_TAKE(s, int32_t, n);
    for (i = 0; i < n && s->e->status >= 0; i++) g->parent[i] = i;
    return s->e->status;
}

/* The edge (i,j), i < j, which g->larger[i] counts already. */
static HDI_INLINE void hdi_edges_join(hdi_edges *g, int32_t i, int32_t j) {
    g->smaller[j]++;
    if (g->parent[i] != g->parent[j]) hdi_unite(g->parent, i, j);
}

/* All cotangents of the faces of a run of sides: what the rounding error of their edge's weight is relative to. */
static double hdi_run_cotangents(const hdi_mesh *mesh, const uint64_t *run, int64_t n) {
    double sum = 0;
    int64_t p;
    for (p = 0; p < n; p++) {
        const double *cot = mesh->cot + 3 * HDI_CAST(int64_t, hdi_key_face(run[p]));
        sum += fabs(cot[0]) + fabs(cot[1]) + fabs(cot[2]);
    }
    return sum;
}

/* The edges of Delaunay triangles without coordinates, which may run from a vertex to itself. Weights above zero, which are there by rounding only, become
 * zero when they are below 1e-13 of the cotangents that they are made of. */
static hd_status hdi_edges_flat(hdi_edges *g, const hdi_mesh *mesh, int full, hdi_scope *s) {
    hdi_sides sides;
    int32_t i, p, q, end, n_edges = 0;
    if (hdi_edges_take(g, mesh->n, 3 * HDI_CAST(int64_t, mesh->m), full, s) < 0 || hdi_sides_make(&sides, mesh, s) < 0) return s->e->status;
    for (i = 0; i < mesh->n; i++) {
        g->first[i] = n_edges;
        hdi_sides_sort(&sides, i);
        for (p = sides.ptr[i], end = sides.ptr[i + 1]; p < end; p = q, n_edges++) {
            const uint64_t *key = sides.key;
            const int32_t j = hdi_key_vertex(key[p]);
            double w = 0, b = 0;
            for (q = p; q < end && hdi_key_vertex(key[q]) == j; q++) {
                w -= mesh->cot[hdi_key_opposite(key[q])] / 2;
                b += mesh->area[hdi_key_face(key[q])];
            }
            if (w > 0 && w <= 1e-13 * hdi_run_cotangents(mesh, key + p, q - p)) w = 0;
            g->to[n_edges] = j;
            g->w[n_edges] = w;
            if (full) g->b[n_edges] = b / 12;
            if (j == i) continue;
            g->larger[i]++;
            hdi_edges_join(g, i, j);
        }
    }
    g->first[mesh->n] = n_edges;
    return HD_OK;
}

/* How masses are lumped. */
typedef enum hdi_lump { HDI_LUMP_THIRDS, HDI_LUMP_MIXED, HDI_LUMP_ONES } hdi_lump;

/* Adds the shares of a face. The mixed rule of a face without obtuse angle, (|ab|^2 cot c + |ac|^2 cot b) / 8 at a, is area/4 (1 + cot b cot c) there, as
 * |ab|^2 = 2 area (cot a + cot b) and the three products of two cotangents sum to 1. Here they are divided by their sum, so that the shares add up to the
 * area whatever rounding does, and cotangents may carry a factor. */
static HDI_INLINE void hdi_face_masses(double *mass, const int32_t *v, const double *cot, double area, hdi_lump lump) {
    if (lump == HDI_LUMP_THIRDS) {
        mass[v[0]] += area / 3;
        mass[v[1]] += area / 3;
        mass[v[2]] += area / 3;
    } else if (lump == HDI_LUMP_ONES) {
        mass[v[0]] = mass[v[1]] = mass[v[2]] = 1;
    } else {
        const double x[3] = {cot[1] * cot[2], cot[2] * cot[0], cot[0] * cot[1]}, sum = x[0] + x[1] + x[2], quarter = area / 4;
        const double obtuse = hdi_min(cot[0], hdi_min(cot[1], cot[2])) < 0, most = hdi_max(cot[0], hdi_max(cot[1], cot[2]));
        const int round = hdi_finite(sum) && sum > 1e-100;
        const double flat = quarter * obtuse, scale = quarter / (round ? sum : 1) * (1 - obtuse);
        int q;
        if (round) {                             /* without branches: which angle is obtuse is anyone's guess */
            mass[v[0]] += quarter + (flat * (cot[0] < 0) + scale * x[0]);
            mass[v[1]] += quarter + (flat * (cot[1] < 0) + scale * x[1]);
            mass[v[2]] += quarter + (flat * (cot[2] < 0) + scale * x[2]);
        } else {                                 /* a needle: its tip, which has the smallest angle, a quarter */
            for (q = 0; q < 3; q++) mass[v[q]] += quarter + (obtuse > 0 ? flat * (cot[q] < 0) : cot[q] < most ? quarter / 2 : 0);
        }
    }
}

static void hdi_mesh_masses(const hdi_mesh *mesh, hdi_lump lump, double *mass) {
    int64_t f;
    memset(mass, 0, HDI_CAST(size_t, mesh->n) * sizeof *mass);
    for (f = 0; f < mesh->m; f++)
        if (mesh->area[f] > 0) hdi_face_masses(mass, mesh->tri + 3 * f, mesh->cot + 3 * f, mesh->area[f], lump);
}

/* ---- one pass over a mesh ----
 * Vertices in their order, each with the faces whose smallest corner it is: these are measured, and their two sides at the vertex join those that wait there,
 * which were opposite to still smaller corners; then all its sides to later vertices are known, are sorted, and runs of them are its edges. What a face
 * needs is read once, and near what was read before.
 * Blocks of vertices are worked on at a time, after what faces give to vertices behind their block is there: few faces do, as neighbours tend to have numbers
 * close to each other, so these are measured twice. Where they do not, and for one thread, there is one block. All sums are taken in the same order, however
 * many blocks there are. */

typedef struct hdi_side { int32_t to; uint32_t turn; double cot, area; } hdi_side;     /* turn: 1 if it runs to the later vertex */

/* A block of vertices: what it found, and its work arrays. */
typedef struct hdi_pass_block {
    int32_t begin, end;         /* its vertices */
    int32_t from, to;           /* the vertices it gives masses and sides to */
    int32_t n_edges, n_boundary, n_nonmanifold, n_misoriented, n_repeated;
    double length;              /* of its edges since it was last noted */
    hdi_face_tally tally;
    hdi_side *side;             /* [busiest vertex] its sides, and work arrays */
    double *cot;                /* [3 busiest] */
    uint64_t *key, *work;       /* [busiest] */
} hdi_pass_block;

typedef struct hdi_pass {
    hdi_mesh *mesh;
    hdi_edges *edges;
    double *mass;               /* [n] or NULL: not wanted */
    hdi_lump lump;
    hd_mesh_report *rep;
    int32_t *face_ptr;          /* [n + 1] faces by their smallest corner */
    int32_t *wait_ptr, *waits;  /* [n + 1], [n] where the sides of a vertex wait, and where the next one comes */
    hdi_side *waiting;          /* [m] */
    int32_t *border;            /* [n] vertices united along boundary edges */
    double *length;             /* [HDI_BLOCKS_MOST] of edges, by blocks of a size that threads have no part in */
    hdi_pass_block *block;      /* [n_blocks] of 2^edges->shift vertices */
    int32_t n_blocks;
} hdi_pass;

enum { HDI_BLOCK_SHIFT = 14, HDI_BLOCKS_MOST = 64 };    /* larger: fewer faces leave; smaller: more threads have work */

/* Blocks of n vertices: the size as a power of two. */
static int32_t hdi_block_shift(int32_t n) {
    int32_t shift = HDI_BLOCK_SHIFT;
    while (n >> shift >= HDI_BLOCKS_MOST) shift++;
    return shift;
}

/* By value, so that no branch has to be guessed. */
static HDI_INLINE int32_t hdi_low32(int32_t a, int32_t b) { return a < b ? a : b; }
static HDI_INLINE int32_t hdi_high32(int32_t a, int32_t b) { return a < b ? b : a; }

/* Faces of vertex i that have the same corners as an earlier one get area 0. room: as large as two sides a face. */
static void hdi_pass_repeats(const hdi_pass *s, hdi_pass_block *k, int32_t i, void *room) {
    const int32_t begin = s->face_ptr[i], end = s->face_ptr[i + 1];
    const int32_t *v = s->mesh->tri + 3 * HDI_CAST(int64_t, begin);
    hdi_pair *pair = HDI_CAST(hdi_pair *, room);
    int64_t n = 0, p, q;
    int32_t f;
    double *area = s->mesh->area;
    for (f = begin; f < end; f++, v += 3) {
        const uint64_t sum = HDI_CAST(uint64_t, HDI_CAST(int64_t, v[0]) + v[1] + v[2] - i), no = HDI_CAST(uint64_t, f - begin);
        const uint64_t most = HDI_CAST(uint64_t, hdi_high32(hdi_high32(v[0], v[1]), v[2]));
        k->key[n++] = area[f] > 0 ? sum << 31 | most : no;     /* the sum of the two others and the larger say it all; no sum is 0 */
    }
    if (n <= 24) {
        for (p = 1; p < n; p++) {
            for (q = 0; q < p && k->key[q] != k->key[p]; q++) {}
            if (q == p) continue;
            area[begin + p] = 0;
            k->n_repeated++;
        }
        return;
    }
    for (p = 0; p < n; p++) {                    /* many: sorted with their places */
        pair[p].key = k->key[p];
        pair[p].id = p;
    }
    hdi_sort_pairs(pair, n);
    for (p = 1; p < n; p++) {
        if (pair[p].key != pair[p - 1].key) continue;
        area[begin + pair[p].id] = 0;
        k->n_repeated++;
    }
}

/* The shares of face v to those of its corners that the block gives to. */
static void hdi_pass_masses(const hdi_pass *s, const hdi_pass_block *k, const int32_t *v, const double *cot, double area) {
    static const int32_t hdi_three[3] = {0, 1, 2};
    double share[3] = {0, 0, 0};
    int q;
    hdi_face_masses(share, hdi_three, cot, area, s->lump);
    for (q = 0; q < 3; q++)
        if (v[q] >= k->from && v[q] < k->to) s->mass[v[q]] = s->lump == HDI_LUMP_ONES ? 1 : s->mass[v[q]] + share[q];
}

/* Measures the faces of vertex i; their sides are added to the n that k->side has, or wait at the vertex where they begin. Returns the number of sides. */
static int32_t hdi_pass_faces(const hdi_pass *s, hdi_pass_block *k, int32_t i, int32_t n) {
    const int32_t begin = s->face_ptr[i], end = s->face_ptr[i + 1], *tri = s->mesh->tri;
    const double *xyz = s->mesh->xyz;
    double *area = s->mesh->area;
    int32_t f;
    for (f = begin; f < end; f++) {
        const int32_t *ahead = tri + 3 * HDI_CAST(int64_t, f + HDI_FACES_AHEAD < s->mesh->m ? f + HDI_FACES_AHEAD : f);
        HDI_PREFETCH(xyz + 3 * HDI_CAST(int64_t, ahead[0]));
        HDI_PREFETCH(xyz + 3 * HDI_CAST(int64_t, ahead[1]));
        HDI_PREFETCH(xyz + 3 * HDI_CAST(int64_t, ahead[2]));
        area[f] = hdi_face_measure(s->mesh, f, k->cot + 3 * (f - begin), &k->tally);
    }
    if (end - begin > 1) hdi_pass_repeats(s, k, i, k->side + n);
    for (f = begin; f < end; f++) {
        const int32_t *v = tri + 3 * HDI_CAST(int64_t, f);
        const double *cot = k->cot + 3 * (f - begin);
        hdi_side *side = k->side + n;
        int32_t q, r, t, b, c, low;
        if (!(area[f] > 0)) continue;
        q = (v[1] == i) + 2 * (v[2] == i);       /* the corner at i */
        r = hdi_next3[q];
        t = hdi_prev3[q];
        b = v[r];
        c = v[t];
        if (s->mass && k->from == 0 && hdi_high32(b, c) < k->to) hdi_face_masses(s->mass, v, cot, area[f], s->lump);
        else if (s->mass) hdi_pass_masses(s, k, v, cot, area[f]);
        side[0].to = b;
        side[0].turn = 1;
        side[0].cot = cot[t];
        side[1].to = c;
        side[1].turn = 0;
        side[1].cot = cot[r];
        side[0].area = side[1].area = area[f];
        n += 2;
        low = hdi_low32(b, c);
        if (low < k->from || low >= k->to) continue;
        side = s->waiting + s->waits[low]++;
        side->to = hdi_high32(b, c);
        side->turn = b < c;
        side->cot = cot[q];
        side->area = area[f];
    }
    return n;
}

/* The keys of n sides in ascending order, into k->key. */
static HDI_INLINE void hdi_pass_order(hdi_pass_block *k, int32_t n) {
    uint64_t *key = k->key, *work = k->work;
    int32_t p, q;
    for (p = 0; p < n; p++) key[p] = HDI_CAST(uint64_t, k->side[p].to) << 32 | HDI_CAST(uint64_t, p);
    if (n > 16) {
        hdi_sort_keys(key, n, work);
        return;
    }
    for (p = 0; p < n; p++) {                    /* by counting who is smaller: no branch to be guessed */
        const uint64_t x = key[p];
        int32_t rank = 0;
        for (q = 0; q < n; q++) rank += key[q] < x;
        work[rank] = x;
    }
    k->key = work;
    k->work = key;
}

/* The edges from vertex i to later ones, from its n sides. Those that leave the block are not joined yet; boundary edges among them are marked by ~. Returns
 * the number of the next edge. */
static int32_t hdi_pass_edges(const hdi_pass *s, hdi_pass_block *k, int32_t i, int32_t n, int32_t at) {
    hdi_edges *g = s->edges;
    const uint64_t *key;
    const int32_t begin = at, end = k->end;
    int32_t p, q, n_boundary = 0, n_nonmanifold = 0, n_misoriented = 0;
    double length = 0;
    hdi_pass_order(k, n);
    key = k->key;
    for (p = 0; p < n; p = q, at++) {
        const hdi_side *side = k->side + (key[p] & 0xffffffffu);
        const int32_t j = side->to;
        double w = -side->cot / 2, b = side->area;
        uint32_t turns = side->turn;
        int boundary;
        for (q = p + 1; q < n && HDI_CAST(int32_t, key[q] >> 32) == j; q++) {
            const hdi_side *other = k->side + (key[q] & 0xffffffffu);
            w -= other->cot / 2;
            b += other->area;
            turns += other->turn;
        }
        boundary = q - p == 1;
        if (g->w) {
            g->to[at] = j >= end && boundary ? ~j : j;
            g->w[at] = w;
            if (g->b) g->b[at] = b / 12;
        }
        length += hdi_edge_length(s->mesh->xyz, i, j);
        n_boundary += boundary;
        n_nonmanifold += q - p > 2;
        n_misoriented += (q - p == 2) & (turns != 1);
        if (j >= end) continue;
        hdi_edges_join(g, i, j);
        if (boundary) hdi_unite(s->border, i, j);
    }
    g->larger[i] = at - begin;
    k->length += length;
    k->n_boundary += n_boundary;
    k->n_nonmanifold += n_nonmanifold;
    k->n_misoriented += n_misoriented;
    return at;
}

/* What the faces give to vertices behind their block: masses, and sides that wait there. */
static void hdi_pass_leaving(const hdi_pass *s) {
    int32_t i, b, f;
    for (b = 0; b + 1 < s->n_blocks; b++) {
        hdi_pass_block k = s->block[b];
        const int32_t end = s->face_ptr[k.end];
        k.from = k.end;
        k.to = s->mesh->n;
        for (f = s->face_ptr[k.begin]; f < end; f++) {
            const int32_t *v = s->mesh->tri + 3 * HDI_CAST(int64_t, f);
            if (hdi_high32(v[0], hdi_high32(v[1], v[2])) < k.end) continue;
            i = hdi_low32(v[0], hdi_low32(v[1], v[2]));
            (void)hdi_pass_faces(s, &k, i, 0);
            f = s->face_ptr[i + 1] - 1;          /* all faces of the vertex are done */
        }
    }
}

/* The edges that leave block k. */
static void hdi_pass_crossing(const hdi_pass *s, const hdi_pass_block *k) {
    hdi_edges *g = s->edges;
    int32_t i, p;
    for (i = k->begin; i < k->end; i++) {
        for (p = g->last[i] - 1; p >= g->first[i]; p--) {
            const int boundary = g->to[p] < 0;
            const int32_t j = boundary ? ~g->to[p] : g->to[p];
            if (j < k->end) break;
            g->to[p] = j;
            hdi_edges_join(g, i, j);
            if (boundary) hdi_unite(s->border, i, j);
        }
    }
}

/* Numbers of faces and waiting sides at each vertex, as offsets; the faces of the mesh in the order of their smallest corners. */
static void hdi_pass_sort(hdi_pass *s, int32_t *tri, int32_t *face) {
    const int32_t n = s->mesh->n, m = s->mesh->m, *v = s->mesh->tri;
    int32_t *HDI_RESTRICT faces = s->face_ptr, *HDI_RESTRICT waits = s->waits, f, i, sum = 0, wait_sum = 0, leaving = 0;
    const int32_t shift = s->edges->shift;
    memset(faces, 0, (HDI_CAST(size_t, n) + 1) * sizeof *faces);
    memset(waits, 0, HDI_CAST(size_t, n) * sizeof *waits);
    for (f = 0; f < m; f++, v += 3) {
        const int32_t lo = hdi_low32(v[0], v[1]), hi = hdi_high32(v[0], v[1]), low = hdi_low32(lo, v[2]);
        faces[low]++;
        waits[hdi_high32(lo, hdi_low32(hi, v[2]))]++;
        leaving += (low ^ hdi_high32(hi, v[2])) >> shift != 0;
    }
    if (leaving > m / 4) s->edges->shift = 31;
    for (i = 0; i < n; i++) {
        const int32_t count = faces[i], wait = waits[i];
        faces[i] = sum;
        waits[i] = s->wait_ptr[i] = wait_sum;
        sum += count;
        wait_sum += wait;
    }
    s->wait_ptr[n] = wait_sum;
    for (f = 0, v = s->mesh->tri; f < m; f++, v += 3) {
        const int32_t at = faces[hdi_low32(hdi_low32(v[0], v[1]), v[2])]++;
        memcpy(tri + 3 * HDI_CAST(int64_t, at), v, 3 * sizeof *v);
        face[at] = f;
    }
    memmove(faces + 1, faces, HDI_CAST(size_t, n) * sizeof *faces);
    faces[0] = 0;
    s->mesh->tri = tri;
    s->mesh->face = face;
}

/* Vertices of block k. Returns room for the sides of its busiest vertex, in whole cache lines that no other block writes to. */
static int32_t hdi_pass_extent(const hdi_pass *p, hdi_pass_block *k, int32_t b) {
    const int64_t step = HDI_CAST(int64_t, 1) << p->edges->shift;
    int32_t i, most = 1;
    memset(k, 0, sizeof *k);
    hdi_tally_clear(&k->tally);
    k->begin = HDI_CAST(int32_t, b * step);
    k->end = k->to = HDI_CAST(int32_t, hdi_least(p->mesh->n, (b + 1) * step));
    for (i = k->begin; i < k->end; i++) {
        const int32_t sides = 2 * (p->face_ptr[i + 1] - p->face_ptr[i]) + p->wait_ptr[i + 1] - p->wait_ptr[i];
        if (sides > most) most = sides;
        p->border[i] = i;
    }
    return (most + 31) & ~15;
}

/* The blocks and their work arrays. */
static hd_status hdi_pass_blocks(hdi_pass *p, hdi_scope *own) {
    int32_t b;
    int64_t sum = 0;
    hdi_side *side;
    double *cot;
    uint64_t *key, *work;
    p->n_blocks = ((p->mesh->n - 1) >> p->edges->shift) + 1;
    p->block = HDI_TAKE(own, hdi_pass_block, p->n_blocks);
    if (!p->block) return own->e->status;
    for (b = 0; b < p->n_blocks; b++) {
        p->block[b].n_edges = hdi_pass_extent(p, p->block + b, b);
        sum += p->block[b].n_edges;
    }
    side = HDI_TAKE(own, hdi_side, sum);
    cot = HDI_TAKE(own, double, 3 * sum);
    key = HDI_TAKE(own, uint64_t, sum);
    work = HDI_TAKE(own, uint64_t, sum);
    if (own->e->status < 0) return own->e->status;
    for (b = p->n_blocks; b-- > 0;) {
        sum -= p->block[b].n_edges;
        p->block[b].n_edges = 0;
        p->block[b].side = side + sum;
        p->block[b].cot = cot + 3 * sum;
        p->block[b].key = key + sum;
        p->block[b].work = work + sum;
    }
    return HD_OK;
}

/* Room of the pass; the faces of the mesh and their areas live in s, the rest in own. */
static hd_status hdi_pass_begin(hdi_pass *p, hdi_scope *own, hdi_scope *s) {
    const int32_t n = p->mesh->n;
    int32_t *tri = HDI_TAKE(s, int32_t, 3 * HDI_CAST(int64_t, p->mesh->m)), *face = HDI_TAKE(s, int32_t, p->mesh->m);
    p->mesh->area = HDI_TAKE(s, double, p->mesh->m);
    if (p->edges->w) p->edges->last = HDI_TAKE(s, int32_t, n);
    p->face_ptr = HDI_TAKE(own, int32_t, HDI_CAST(int64_t, n) + 1);
    p->wait_ptr = HDI_TAKE(own, int32_t, HDI_CAST(int64_t, n) + 1);
    p->waits = HDI_TAKE(own, int32_t, n);
    p->border = HDI_TAKE(own, int32_t, n);
    p->waiting = HDI_TAKE(own, hdi_side, p->mesh->m);
    p->length = HDI_TAKE_ZERO(own, double, HDI_BLOCKS_MOST);
    if (s->e->status < 0) return s->e->status;
    /* One block if nobody gains by more, or if edges are only counted: then nobody knows which leave their block. */
    p->edges->shift = p->edges->w && !hdi_is_serial(s->ctx) ? hdi_block_shift(n) : 31;
    hdi_pass_sort(p, tri, face);
    if (p->mass) memset(p->mass, 0, HDI_CAST(size_t, n) * sizeof *p->mass);
    return hdi_pass_blocks(p, own);
}

/* A block of vertices. Its edges begin where there would be room for one edge of each side before it. */
static void hdi_pass_task(void *arg, int64_t index, int32_t worker) {
    const hdi_pass *p = HDI_CAST(const hdi_pass *, arg);
    hdi_pass_block *all = p->block + index, k = *all;
    const int32_t begin = 2 * p->face_ptr[k.begin] + p->wait_ptr[k.begin], shift = hdi_block_shift(p->mesh->n);
    int32_t i, n, at = begin;
    (void)worker;
    for (i = k.begin; i < k.end; i++) {
        p->edges->first[i] = at;
        n = p->waits[i] - p->wait_ptr[i];
        memcpy(k.side, p->waiting + p->wait_ptr[i], HDI_CAST(size_t, n) * sizeof *k.side);
        n = hdi_pass_faces(p, &k, i, n);
        at = hdi_pass_edges(p, &k, i, n, at);
        p->edges->last[i] = at;
        if (i + 1 < k.end && (i + 1) >> shift == i >> shift) continue;
        p->length[i >> shift] = k.length;
        k.length = 0;
    }
    k.n_edges = at - begin;
    *all = k;
}

static hd_status hdi_pass_run(hdi_pass *p, hdi_scope *s) {
    hd_mesh_report *rep = p->rep;
    hdi_face_tally tally;
    int32_t b;
    hdi_tally_clear(&tally);
    hdi_pass_leaving(p);
    hdi_parallel(s->ctx, p->n_blocks, hdi_pass_task, p);
    for (b = 0; b < p->n_blocks; b++) {
        const hdi_pass_block *k = p->block + b;
        if (b + 1 < p->n_blocks) hdi_pass_crossing(p, k);
        hdi_tally_add(&tally, &k->tally);
        rep->n_repeated_face += k->n_repeated;
        rep->n_edges += k->n_edges;
        rep->n_boundary_edges += k->n_boundary;
        rep->n_nonmanifold_edges += k->n_nonmanifold;
        rep->n_misoriented_edges += k->n_misoriented;
    }
    for (b = 0; b < HDI_BLOCKS_MOST; b++) p->edges->length += p->length[b];
    if (hdi_tally_report(&tally, p->mesh->m, rep, s->e) < 0) return s->e->status;
    rep->n_faces_used -= rep->n_repeated_face;
    rep->n_boundary_loops = rep->n_boundary_edges ? hdi_count_sets(p->border, p->mesh->n) : 0;
    return HD_OK;
}

/* Checks the mesh, measures the faces, finds the edges, and leaves out the faces that contribute nothing. The arrays live in s. The faces of the mesh are in an
 * order of their own, without cotangents and corner lists. full -1: the edges are only counted; 1: with areas. mass [n] or NULL. */
static hd_status hdi_mesh_faces(hdi_mesh *mesh, hdi_edges *edges, int full, double *mass, hdi_lump lump, hd_mesh_report *rep, hdi_scope *s) {
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    hdi_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.mesh = mesh;
    pass.edges = edges;
    pass.mass = mass;
    pass.lump = lump;
    pass.rep = rep;
    rep->n_faces = mesh->m;
    if (3 * HDI_CAST(int64_t, mesh->m) > INT32_MAX) hdi_fail(s->e, HD_ERR_TOO_LARGE, "more than 2^31 face corners");
    if (s->e->status < 0 || hdi_mesh_check(mesh->xyz, mesh->n, mesh->tri, mesh->m, s->e) < 0) return hdi_scope_end(&own);
    if (hdi_edges_take(edges, mesh->n, full < 0 ? 0 : 3 * HDI_CAST(int64_t, mesh->m), full > 0, s) < 0) return hdi_scope_end(&own);
    if (hdi_pass_begin(&pass, &own, s) >= 0) (void)hdi_pass_run(&pass, s);
    return hdi_scope_end(&own);
}

static void hdi_mesh_clear(hdi_mesh *mesh, const double *xyz, int32_t n, const int32_t *tri, int32_t m) {
    memset(mesh, 0, sizeof *mesh);
    mesh->xyz = xyz;
    mesh->tri = tri;
    mesh->n = n;
    mesh->m = m;
}

/* The same with corner lists, for those who need no edges. */
static hd_status hdi_mesh_make(hdi_mesh *mesh, const double *xyz, int32_t n, const int32_t *tri, int32_t m, hd_mesh_report *rep, hdi_scope *s) {
    hdi_edges edges;
    hdi_mesh_clear(mesh, xyz, n, tri, m);
    if (hdi_mesh_faces(mesh, &edges, -1, NULL, HDI_LUMP_THIRDS, rep, s) < 0) return s->e->status;
    mesh->corner_ptr = HDI_TAKE(s, int64_t, HDI_CAST(int64_t, n) + 1);
    mesh->corner = HDI_TAKE(s, int32_t, 3 * HDI_CAST(int64_t, m));
    if (s->e->status < 0) return s->e->status;
    hdi_mesh_corners(mesh);
    return HD_OK;
}

/* ---- polygons ---- */

/* Faces with any number of corners. What the operator needs of a face is kept per corner. */
typedef struct hdi_poly {
    const double *xyz;
    const int64_t *ptr;
    const int32_t *idx;
    int32_t n, m;
    double lambda;
    double *area;        /* [m] length of the vector area; 0: the face is left out */
    double *g;           /* [3 corners] (corner before - corner after) / (2 sqrt(area)) */
    double *w;           /* [2 corners] see hdi_poly_frame; of triangles not set */
    int32_t *face;       /* [corners] the face of a corner */
    int64_t *corner_ptr; /* [n + 1] corners at each vertex, as indices into idx, faces ascending */
    int32_t *corner;     /* [corners]; corners of faces left out are not listed */
} hdi_poly;

static hd_status hdi_poly_check(const double *xyz, int32_t n, const int64_t *ptr, const int32_t *idx, int32_t m, hd_error *e) {
    int64_t c;
    int32_t f;
    if (hdi_mesh_check(xyz, n, NULL, 0, e) < 0) return e->status;
    if (m > 0 && ptr[0] != 0) return hdi_fail_face(e, HD_ERR_STRUCTURE, "face_ptr does not begin with 0", 0, -1, HDI_CAST(double, ptr[0]));
    for (f = 0; f < m; f++)
        if (ptr[f + 1] < ptr[f]) return hdi_fail_face(e, HD_ERR_STRUCTURE, "face_ptr descends", f, -1, HDI_CAST(double, ptr[f + 1]));
    if (m > 0 && ptr[m] > INT32_MAX) return hdi_fail(e, HD_ERR_TOO_LARGE, "more than 2^31 face corners");
    if (m > 0 && ptr[m] > 0 && !idx) return hdi_fail(e, HD_ERR_ARGUMENT, "an argument that must not be NULL is NULL");
    for (f = 0; f < m; f++)
        for (c = ptr[f]; c < ptr[f + 1]; c++)
            if (idx[c] < 0 || idx[c] >= n) return hdi_fail_face(e, HD_ERR_INDEX, "a face names a vertex that does not exist", f, -1, idx[c]);
    return HD_OK;
}

static const double *hdi_poly_at(const hdi_poly *poly, int64_t corner) { return poly->xyz + 3 * HDI_CAST(int64_t, poly->idx[corner]); }

/* The corners of the same face before and after c. */
static int64_t hdi_poly_before(const hdi_poly *poly, int64_t c) {
    const int32_t f = poly->face[c];
    return c > poly->ptr[f] ? c - 1 : poly->ptr[f + 1] - 1;
}

static int64_t hdi_poly_after(const hdi_poly *poly, int64_t c) {
    const int32_t f = poly->face[c];
    return c + 1 < poly->ptr[f + 1] ? c + 1 : poly->ptr[f];
}

/* The edge from corner c to the next. */
static void hdi_poly_edge(const hdi_poly *poly, int64_t c, double *edge) {
    hdi_sub3(hdi_poly_at(poly, hdi_poly_after(poly, c)), hdi_poly_at(poly, c), edge);
}

/* Twice the vector area of face f, as a fan from its first corner. Returns its length, or 0 when nothing but the rounding of the sum is left of
 * it, as in a bow tie. A triangle is one cross product of two edges: 0 only if that is exactly zero. */
static double hdi_poly_area(const hdi_poly *poly, int32_t f, double *twice) {
    const int64_t begin = poly->ptr[f], end = poly->ptr[f + 1];
    double spoke[3], edge[3], cross[3], length, sum = 0;
    int64_t c;
    int q;
    twice[0] = twice[1] = twice[2] = 0;
    for (c = begin + 1; c + 1 < end; c++) {
        hdi_sub3(hdi_poly_at(poly, c), hdi_poly_at(poly, begin), spoke);
        hdi_poly_edge(poly, c, edge);
        hdi_cross3(spoke, edge, cross);
        for (q = 0; q < 3; q++) twice[q] += cross[q];
        sum += hdi_norm3(cross);
    }
    length = hdi_norm3(twice);
    if (!hdi_finite(sum)) return sum;
    return length <= 4 * DBL_EPSILON * HDI_CAST(double, end - begin - 2) * sum ? 0 : length;
}

/* Fills frame with two orthonormal vectors in the plane across the unit normal, the first along the longest edge as projected into it. Returns its length. */
static double hdi_poly_axes(const hdi_poly *poly, int32_t f, const double *normal, double frame[2][3]) {
    double longest = 0, edge[3], length, along;
    int64_t c;
    int q;
    for (c = poly->ptr[f]; c < poly->ptr[f + 1]; c++) {
        hdi_poly_edge(poly, c, edge);
        along = hdi_dot3(edge, normal);
        for (q = 0; q < 3; q++) edge[q] -= along * normal[q];
        length = hdi_norm3(edge);
        if (!(length > longest)) continue;
        longest = length;
        for (q = 0; q < 3; q++) frame[0][q] = edge[q] / length;
    }
    if (longest > 0) hdi_cross3(normal, frame[0], frame[1]);
    return longest;
}

/* The projector on the kernel of the transposed projected edges is I - Q Q', Q [k x 2] an orthonormal basis of their range: Gram and Schmidt,
 * orthogonalised twice. What is kept are the rows of w = D'Q, D the difference along the edges. 0 when the face has no plane. */
static int hdi_poly_frame(const hdi_poly *poly, int32_t f, const double *normal) {
    const int64_t begin = poly->ptr[f], k = poly->ptr[f + 1] - begin;
    double *q = poly->w + 2 * begin, frame[2][3], edge[3], dot, norm, last[2];
    const double longest = hdi_poly_axes(poly, f, normal, frame);
    int64_t p;
    int turn;
    if (!(longest > 0)) return 0;
    for (p = 0, norm = 0; p < k; p++) {
        hdi_poly_edge(poly, begin + p, edge);
        q[2 * p] = hdi_dot3(edge, frame[0]) / longest;
        q[2 * p + 1] = hdi_dot3(edge, frame[1]) / longest;
        norm += q[2 * p] * q[2 * p];
    }
    for (p = 0, norm = sqrt(norm); p < k; p++) q[2 * p] /= norm;
    for (turn = 0; turn < 2; turn++) {
        for (p = 0, dot = 0; p < k; p++) dot += q[2 * p] * q[2 * p + 1];
        for (p = 0; p < k; p++) q[2 * p + 1] -= dot * q[2 * p];
    }
    for (p = 0, norm = 0; p < k; p++) norm += q[2 * p + 1] * q[2 * p + 1];
    norm = sqrt(norm);
    for (p = 0; p < k; p++) q[2 * p + 1] = norm > 1e-12 ? q[2 * p + 1] / norm : 0;   /* narrower than that: its direction is rounding */
    last[0] = q[2 * k - 2];
    last[1] = q[2 * k - 1];
    for (p = k - 1; p >= 0; p--) {
        q[2 * p] = (p > 0 ? q[2 * p - 2] : last[0]) - q[2 * p];
        q[2 * p + 1] = (p > 0 ? q[2 * p - 1] : last[1]) - q[2 * p + 1];
    }
    return 1;
}

/* Smallest angle at the corners of f that bend inwards, at most pi. */
static double hdi_poly_angle(const hdi_poly *poly, int32_t f, const double *normal) {
    double least = 4, in[3], out[3], cross[3];
    int64_t c;
    for (c = poly->ptr[f]; c < poly->ptr[f + 1]; c++) {
        hdi_poly_edge(poly, hdi_poly_before(poly, c), in);
        hdi_poly_edge(poly, c, out);
        hdi_cross3(in, out, cross);
        if (hdi_dot3(cross, normal) >= 0) least = hdi_min(least, atan2(hdi_norm3(cross), -hdi_dot3(in, out)));
    }
    return least;
}

/* g of face f; 0 when a square of it is not finite. */
static int hdi_poly_gradients(const hdi_poly *poly, int32_t f, double area) {
    int64_t c;
    int q, good = 1;
    for (c = poly->ptr[f]; c < poly->ptr[f + 1]; c++) {
        double *g = poly->g + 3 * c;
        hdi_sub3(hdi_poly_at(poly, hdi_poly_before(poly, c)), hdi_poly_at(poly, hdi_poly_after(poly, c)), g);
        for (q = 0; q < 3; q++) g[q] /= 2 * sqrt(area);
        good &= hdi_finite(hdi_dot3(g, g));
    }
    return good;
}

/* Everything about face f. mark [n] holds the last face that saw a vertex. */
static hd_status hdi_poly_measure(const hdi_poly *poly, int32_t f, int32_t *mark, hd_mesh_report *rep, hd_error *e) {
    const int64_t begin = poly->ptr[f], end = poly->ptr[f + 1];
    double normal[3], twice;
    int64_t c;
    int q;
    poly->area[f] = 0;
    for (c = begin; c < end; c++) {
        if (mark[poly->idx[c]] == f) {
            rep->n_repeated_corner++;
            return HD_OK;
        }
        mark[poly->idx[c]] = f;
    }
    twice = end - begin < 3 ? 0 : hdi_poly_area(poly, f, normal);
    if (!hdi_finite(twice)) return hdi_fail_face(e, HD_ERR_NOT_FINITE, "a face is too large: its area is not finite", f, poly->idx[begin], twice);
    if (twice == 0 || twice / (8 * HDI_CAST(double, end - begin)) < DBL_MIN || !hdi_poly_gradients(poly, f, twice / 2)) {
        rep->n_zero_area++;
        return HD_OK;
    }
    for (q = 0; q < 3; q++) normal[q] /= twice;
    if (end - begin > 3 && !hdi_poly_frame(poly, f, normal)) {
        rep->n_zero_area++;
        return HD_OK;
    }
    poly->area[f] = twice / 2;
    rep->smallest_angle = hdi_min(rep->smallest_angle, hdi_poly_angle(poly, f, normal));
    return HD_OK;
}

/* Corner lists of all vertices, over the faces that have an area. */
static void hdi_poly_corners(hdi_poly *poly) {
    const int64_t n_corners = poly->m ? poly->ptr[poly->m] : 0;
    int64_t c;
    int32_t i;
    memset(poly->corner_ptr, 0, (HDI_CAST(size_t, poly->n) + 1) * sizeof *poly->corner_ptr);
    for (c = 0; c < n_corners; c++)
        if (poly->area[poly->face[c]] > 0) poly->corner_ptr[poly->idx[c]]++;
    hdi_prefix_sum(poly->corner_ptr, poly->n);
    for (c = 0; c < n_corners; c++)
        if (poly->area[poly->face[c]] > 0) poly->corner[poly->corner_ptr[poly->idx[c]]++] = HDI_CAST(int32_t, c);
    for (i = poly->n; i > 0; i--) poly->corner_ptr[i] = poly->corner_ptr[i - 1];
    poly->corner_ptr[0] = 0;
}

/* From a face's smallest corner towards the smaller of its neighbours: the way in which faces with the same corners in the same cyclic order are
 * all read alike. One step from c, which is *forward or not. */
static int64_t hdi_poly_step(const hdi_poly *poly, int64_t c, int forward) { return forward ? hdi_poly_after(poly, c) : hdi_poly_before(poly, c); }

static int hdi_poly_way(const hdi_poly *poly, int64_t c) { return poly->idx[hdi_poly_after(poly, c)] < poly->idx[hdi_poly_before(poly, c)]; }

/* A number for the corners of the face in the order from its smallest corner c (the hash of Fowler, Noll and Vo, a vertex at a time). */
static uint64_t hdi_poly_key(const hdi_poly *poly, int64_t c) {
    const int forward = hdi_poly_way(poly, c);
    uint64_t key = 14695981039346656037u;
    int64_t at = c;
    do {
        key = (key ^ HDI_CAST(uint64_t, poly->idx[at])) * 1099511628211u;
        at = hdi_poly_step(poly, at, forward);
    } while (at != c);
    return key;
}

static int hdi_poly_same(const hdi_poly *poly, int64_t c, int64_t d) {
    const int forward_c = hdi_poly_way(poly, c), forward_d = hdi_poly_way(poly, d);
    int64_t a = c, b = d;
    do {
        if (poly->idx[a] != poly->idx[b]) return 0;
        a = hdi_poly_step(poly, a, forward_c);
        b = hdi_poly_step(poly, b, forward_d);
    } while (a != c && b != d);
    return a == c && b == d;
}

/* Gives faces that repeat an earlier one area 0: around each vertex, the faces in which it is the smallest corner are sorted by their keys.
 * least [m] the smallest corner of each face; work: as many pairs as the busiest vertex has corners. */
static void hdi_poly_repeats(hdi_poly *poly, int32_t *least, hdi_pair *work, hd_mesh_report *rep) {
    const int64_t n_corners = poly->m ? poly->ptr[poly->m] : 0;
    int64_t c, p, n, first;
    int32_t i;
    hdi_fill_i32(least, poly->m, -1);
    for (c = 0; c < n_corners; c++) {
        int32_t *best = least + poly->face[c];
        if (*best < 0 || poly->idx[c] < poly->idx[*best]) *best = HDI_CAST(int32_t, c);
    }
    for (i = 0; i < poly->n; i++) {
        n = 0;
        for (p = poly->corner_ptr[i]; p < poly->corner_ptr[i + 1]; p++) {
            c = poly->corner[p];
            if (least[poly->face[c]] != c) continue;
            work[n].key = hdi_poly_key(poly, c);
            work[n++].id = c;
        }
        hdi_sort_pairs(work, n);
        for (p = 1, first = 0; p < n; p++) {
            if (work[p].key != work[first].key) first = p;
            else if (hdi_poly_same(poly, work[p].id, work[first].id)) {
                poly->area[poly->face[work[p].id]] = 0;
                rep->n_repeated_face++;
            }
        }
    }
}

/* The most corners at a vertex, at least 1. */
static int64_t hdi_poly_busiest(const hdi_poly *poly) {
    int64_t most = 1;
    int32_t i;
    for (i = 0; i < poly->n; i++)
        if (poly->corner_ptr[i + 1] - poly->corner_ptr[i] > most) most = poly->corner_ptr[i + 1] - poly->corner_ptr[i];
    return most;
}

/* As hdi_mesh_make. The input must have passed hdi_poly_check. */
static hd_status hdi_poly_make(hdi_poly *poly, hd_mesh_report *rep, hdi_scope *s) {
    const int64_t n_corners = poly->m ? poly->ptr[poly->m] : 0;
    const int32_t m = poly->m;
    int32_t *mark, f;
    hdi_pair *work;
    int64_t c;
    rep->n_faces = m;
    rep->smallest_angle = m > 0 ? 4 : 0;
    poly->area = HDI_TAKE(s, double, m);
    poly->g = HDI_TAKE(s, double, 3 * n_corners);
    poly->w = HDI_TAKE(s, double, 2 * n_corners);
    poly->face = HDI_TAKE(s, int32_t, n_corners);
    poly->corner_ptr = HDI_TAKE(s, int64_t, HDI_CAST(int64_t, poly->n) + 1);
    poly->corner = HDI_TAKE(s, int32_t, n_corners);
    mark = HDI_TAKE(s, int32_t, poly->n > m ? poly->n : m);
    if (s->e->status < 0) return s->e->status;
    for (f = 0; f < m; f++)
        for (c = poly->ptr[f]; c < poly->ptr[f + 1]; c++) poly->face[c] = f;
    hdi_fill_i32(mark, poly->n, -1);
    for (f = 0; f < m; f++)
        if (hdi_poly_measure(poly, f, mark, rep, s->e) < 0) return s->e->status;
    hdi_poly_corners(poly);
    work = HDI_TAKE(s, hdi_pair, hdi_poly_busiest(poly));
    if (!work) return s->e->status;
    hdi_poly_repeats(poly, mark, work, rep);
    if (rep->n_repeated_face) hdi_poly_corners(poly);
    for (f = 0; f < m; f++) rep->n_faces_used += poly->area[f] > 0;
    if (!rep->n_faces_used) rep->smallest_angle = 0;
    return HD_OK;
}

/* Fans from the first corner of each face, into tri; NULL: counted only. Returns the number of triangles. */
static int64_t hdi_poly_fans(const int64_t *ptr, const int32_t *idx, int32_t m, int32_t *tri) {
    int64_t t = 0, c;
    int32_t f;
    for (f = 0; f < m; f++) {
        for (c = ptr[f] + 1; c + 1 < ptr[f + 1]; c++, t++) {
            if (!tri) continue;
            tri[3 * t] = idx[ptr[f]];
            tri[3 * t + 1] = idx[c];
            tri[3 * t + 2] = idx[c + 1];
        }
    }
    return t;
}

/* The face that triangle t is of. */
static int32_t hdi_poly_face_of(const int64_t *ptr, int32_t m, int64_t t) {
    int32_t f;
    for (f = 0; f < m; f++) {
        const int64_t k = ptr[f + 1] - ptr[f] - 2;
        if (k > t) return f;
        if (k > 0) t -= k;
    }
    return -1;
}

/* ---- intrinsic triangulations ----
 * Triangles that are known by the lengths of their sides and by which side is glued to which: what flips of edges need, and all that the operators
 * need. An edge may join a vertex to itself, two vertices may share several edges, a triangle may be glued to itself.
 * This work is based on
 *   A. Bobenko, B. Springborn, A discrete Laplace-Beltrami operator for simplicial surfaces, 2007 (intrinsic Delaunay, non-negative weights)
 *   M. Fisher, B. Springborn, P. Schroeder, A. Bobenko, An algorithm for the construction of intrinsic Delaunay triangulations, 2007 (flips)
 *   N. Sharp, K. Crane, A Laplacian for nonmanifold triangle meshes, 2020 (mollification, the tufted cover)
 *   W. Kahan, Miscalculating area and angles of a needle-like triangle, 2014 (areas from lengths)
 * Deviations: sheets around an edge of three faces or more follow each other by their angle in space, and copies of a face lie in layers (the paper takes
 * any order); an orientable manifold without boundary is its own cover, half of it is not stored; flips must also lower the sum of the six cotangents,
 * which in exact arithmetic they always do (Rippa 1990), so that rounding cannot make them run in circles. Zero-area faces are left out before.
 * Lengths are in units of the mean edge length: nothing overflows, and results do not depend on the unit of the coordinates. */

typedef struct hdi_intrinsic {
    int32_t n_sides;    /* three per face */
    int32_t n_sheets;   /* how often the surface is covered */
    double unit;        /* mean edge length of the input */
    int32_t *vert;      /* [n_sides] where side s begins; it runs to where the next side of its face begins */
    int32_t *twin;      /* [n_sides] the side glued to it, which runs the other way; -1: boundary */
    double *len;        /* [n_sides] length / unit, the same on both sides of an edge */
    double *area;       /* [n_sides / 3] area / unit^2; 0: these lengths make no triangle, the face contributes nothing */
} hdi_intrinsic;

static int32_t hdi_side_next(int32_t s) { return s % 3 == 2 ? s - 2 : s + 1; }
static int32_t hdi_side_prev(int32_t s) { return s % 3 == 0 ? s + 2 : s - 1; }

/* Area of the triangle with these sides, relatively exact for any shape; 0 where they make none. */
static double hdi_length_area(double a, double b, double c) {
    double t;
    if (a < b) { t = a; a = b; b = t; }
    if (b < c) { t = b; b = c; c = t; }
    if (a < b) { t = a; a = b; b = t; }
    t = c - (a - b);
    return t > 0 ? 0.25 * sqrt((a + (b + c)) * t * (c + (a - b)) * (a + (b - c))) : 0;
}

static void hdi_intrinsic_area(hdi_intrinsic *t, int32_t f) {
    const double *len = t->len + 3 * HDI_CAST(int64_t, f);
    t->area[f] = hdi_length_area(len[0], len[1], len[2]);
}

/* Cotangent of the angle opposite to side s, of a face with area. */
static double hdi_side_cot(const hdi_intrinsic *t, int32_t s) {
    const double a = t->len[s], b = t->len[hdi_side_next(s)], c = t->len[hdi_side_prev(s)];
    return (b * b + c * c - a * a) / (4 * t->area[s / 3]);
}

/* Sides from v to later vertices (of faces with area), sorted by the other vertex, then by side: edges are runs of the same key. */
static int64_t hdi_sides_at(const hdi_mesh *mesh, int32_t v, hdi_pair *list) {
    int64_t p, n = 0;
    for (p = mesh->corner_ptr[v]; p < mesh->corner_ptr[v + 1]; p++) {
        const int32_t c = mesh->corner[p], before = hdi_side_prev(c), to = mesh->tri[hdi_side_next(c)], from = mesh->tri[before];
        if (to > v) {
            list[n].key = HDI_CAST(uint64_t, to);
            list[n++].id = c;
        }
        if (from > v) {
            list[n].key = HDI_CAST(uint64_t, from);
            list[n++].id = before;
        }
    }
    hdi_sort_pairs(list, n);
    return n;
}

static double hdi_side_length(const hdi_mesh *mesh, int32_t s) {
    double edge[3];
    hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, mesh->tri[hdi_side_next(s)]), mesh->xyz + 3 * HDI_CAST(int64_t, mesh->tri[s]), edge);
    return hdi_norm3(edge);
}

/* mate [3 m]: the other side of edges with two faces, -1 elsewhere. Returns the sum of the edges' lengths. list: twice as many pairs as the busiest vertex
 * has corners. */
static double hdi_mesh_mates(const hdi_mesh *mesh, int32_t *mate, hdi_pair *list) {
    double length = 0;
    int64_t p, q, n;
    int32_t v;
    for (p = 0; p < 3 * HDI_CAST(int64_t, mesh->m); p++) mate[p] = -1;
    for (v = 0; v < mesh->n; v++) {
        n = hdi_sides_at(mesh, v, list);
        for (p = 0; p < n; p = q) {
            const int32_t s = HDI_CAST(int32_t, list[p].id);
            for (q = p + 1; q < n && list[q].key == list[p].key;) q++;
            length += hdi_side_length(mesh, s);
            if (q - p != 2) continue;
            mate[s] = HDI_CAST(int32_t, list[p + 1].id);
            mate[mate[s]] = s;
        }
    }
    return length;
}

/* turned[f] = 1 for faces that have to be turned over so that all mates run opposite ways; 0 if the surface has only one side. queue [m]. */
static int hdi_mesh_orient(const hdi_mesh *mesh, const int32_t *mate, signed char *turned, int32_t *queue) {
    int32_t start, head, tail, q;
    memset(turned, -1, HDI_CAST(size_t, mesh->m));
    for (start = 0; start < mesh->m; start++) {
        if (turned[start] >= 0 || !(mesh->area[start] > 0)) continue;
        turned[start] = 0;
        queue[0] = start;
        for (head = 0, tail = 1; head < tail; head++) {
            for (q = 0; q < 3; q++) {
                const int32_t s = 3 * queue[head] + q, t = mate[s], f = t / 3;
                int want;
                if (t < 0) continue;
                want = turned[queue[head]] ^ (mesh->tri[s] == mesh->tri[t]);
                if (turned[f] >= 0 && turned[f] != want) return 0;
                if (turned[f] >= 0) continue;
                turned[f] = HDI_CAST(signed char, want);
                queue[tail++] = f;
            }
        }
    }
    return 1;
}

static void hdi_unit3(const double *from, const double *to, double *out) {
    double norm;
    int k;
    hdi_sub3(to, from, out);
    norm = hdi_norm3(out);
    for (k = 0; k < 3; k++) out[k] /= norm;
}

/* Faces around an edge, its n sides in list: sorted by angle in space from the first side's face, counterclockwise as seen against the direction from
 * the smaller vertex to the larger one. */
static void hdi_sort_around(const hdi_mesh *mesh, int32_t lo, int32_t hi, hdi_pair *list, int64_t n) {
    const double *p = mesh->xyz + 3 * HDI_CAST(int64_t, lo), turn = 6.283185307179586;
    double axis[3], first[3], up[3], u[3];
    int64_t k;
    hdi_unit3(p, mesh->xyz + 3 * HDI_CAST(int64_t, hi), axis);
    hdi_unit3(p, mesh->xyz + 3 * HDI_CAST(int64_t, mesh->tri[hdi_side_prev(HDI_CAST(int32_t, list[0].id))]), first);
    hdi_cross3(axis, first, up);
    hdi_cross3(up, axis, first);                 /* its part across the axis, as long as up */
    for (k = 0; k < n; k++) {
        double angle;
        hdi_unit3(p, mesh->xyz + 3 * HDI_CAST(int64_t, mesh->tri[hdi_side_prev(HDI_CAST(int32_t, list[k].id))]), u);
        angle = atan2(hdi_dot3(up, u), hdi_dot3(first, u));
        if (angle < 0) angle += turn;
        list[k].key = HDI_CAST(uint64_t, hdi_min(angle / turn, 1) * 8796093022208.0);
    }
    hdi_sort_pairs(list, n);
}

/* Side s of the mesh on a sheet: place[face] is the number of the face there; the back runs through the face the other way round. */
static int32_t hdi_sheet_side(const int32_t *place, int32_t s, int back) { return 3 * place[s / 3] + (back ? 2 - s % 3 : s % 3); }

static void hdi_glue(hdi_intrinsic *t, int32_t a, int32_t b) {
    t->twin[a] = b;
    t->twin[b] = a;
}

/* The cover of two sheets: front of face f at place front[f], its back at back[f]. Around each edge the side of a face that looks counterclockwise is
 * glued to the side of the next face that looks back at it; so a single face at the boundary, front to back, if it is not to stay open. */
static void hdi_glue_cover(hdi_intrinsic *t, const hdi_mesh *mesh, const int32_t *front, const int32_t *back, int close, hdi_pair *list) {
    int64_t p, q, k, n;
    int32_t v;
    for (v = 0; v < mesh->n; v++) {
        n = hdi_sides_at(mesh, v, list);
        for (p = 0; p < n; p = q) {
            const int32_t other = HDI_CAST(int32_t, list[p].key);
            for (q = p + 1; q < n && list[q].key == list[p].key;) q++;
            if (q - p == 1 && !close) continue;
            if (q - p > 2) hdi_sort_around(mesh, v, other, list + p, q - p);
            for (k = p; k < q; k++) {            /* a front looks counterclockwise if its side runs from v, a back if it runs to v */
                const int32_t a = HDI_CAST(int32_t, list[k].id), b = HDI_CAST(int32_t, list[k + 1 < q ? k + 1 : p].id);
                const int back_a = mesh->tri[a] != v, back_b = mesh->tri[b] == v;
                hdi_glue(t, hdi_sheet_side(back_a ? back : front, a, back_a), hdi_sheet_side(back_b ? back : front, b, back_b));
            }
        }
    }
}

/* The faces with area at their places, their lengths and vertices. */
static void hdi_put_face(hdi_intrinsic *t, const hdi_mesh *mesh, int32_t f, const int32_t *place, int back) {
    int32_t q;
    for (q = 0; q < 3; q++) {
        const int32_t s = 3 * f + q, at = hdi_sheet_side(place, s, back);
        t->vert[at] = mesh->tri[back ? hdi_side_next(s) : s];
        t->len[at] = hdi_side_length(mesh, s) / t->unit;
        t->twin[at] = -1;
    }
}

/* The intrinsic triangulation of a mesh, in s: of itself where all its faces can be turned to one side, else of its two-sheeted cover. With close the
 * boundary is glued to the other sheet (the tufted cover), so that no boundary is left. */
static hd_status hdi_intrinsic_make(hdi_intrinsic *t, const hdi_mesh *mesh, int close, hd_mesh_report *rep, hdi_scope *s) {
    const int64_t n_sides = 3 * HDI_CAST(int64_t, mesh->m);
    int32_t *mate = HDI_TAKE(s, int32_t, n_sides);
    int32_t *front = HDI_TAKE(s, int32_t, HDI_CAST(int64_t, mesh->m) + 1);
    int32_t *back = HDI_TAKE(s, int32_t, HDI_CAST(int64_t, mesh->m) + 1);
    int32_t f, q, used = 0;
    signed char *turned = HDI_TAKE(s, signed char, mesh->m);
    hdi_pair *list = HDI_TAKE(s, hdi_pair, 2 * hdi_most_corners(mesh));
    int single;
    memset(t, 0, sizeof *t);
    if (s->e->status < 0) return s->e->status;
    t->unit = hdi_mesh_mates(mesh, mate, list) / HDI_CAST(double, rep->n_edges > 0 ? rep->n_edges : 1);
    single = rep->n_nonmanifold_edges == 0 && !(close && rep->n_boundary_edges) && hdi_mesh_orient(mesh, mate, turned, back);
    t->n_sheets = single ? 1 : 2;
    for (f = 0; f < mesh->m; f++) front[f] = mesh->area[f] > 0 ? used++ : 0;
    for (f = 0; f < mesh->m; f++) back[f] = front[f] + used;
    if (!single && used > INT32_MAX / 6) return hdi_fail(s->e, HD_ERR_TOO_LARGE, "more than 2^31 face corners in a cover of two sheets");
    t->n_sides = 3 * used * t->n_sheets;
    t->vert = HDI_TAKE(s, int32_t, t->n_sides);
    t->twin = HDI_TAKE(s, int32_t, t->n_sides);
    t->len = HDI_TAKE(s, double, t->n_sides);
    t->area = HDI_TAKE(s, double, t->n_sides / 3);
    if (s->e->status < 0) return s->e->status;
    for (f = 0; f < mesh->m; f++) {
        if (!(mesh->area[f] > 0)) continue;
        hdi_put_face(t, mesh, f, front, single && turned[f]);
        if (!single) hdi_put_face(t, mesh, f, back, 1);
        for (q = 3 * f; single && q < 3 * f + 3; q++)
            if (mate[q] >= 0 && mate[q] < q) hdi_glue(t, hdi_sheet_side(front, q, turned[f]), hdi_sheet_side(front, mate[q], turned[mate[q] / 3]));
    }
    if (single) return HD_OK;
    hdi_glue_cover(t, mesh, front, back, close, list);
    return HD_OK;
}

/* Mollification (Sharp, Crane 2020, section 4.5): the smallest length that, added to all sides, makes every triangle satisfy the triangle inequality
 * with delta to spare. delta < 0: nothing is added. */
static void hdi_mollify(hdi_intrinsic *t, double delta, hd_mesh_report *rep) {
    double add = 0;
    int32_t s, k, short_faces = 0;
    for (s = 0; s < t->n_sides && delta >= 0; s += 3) {
        double spare = t->len[s] + t->len[s + 1] - t->len[s + 2];
        for (k = 0; k < 2; k++) spare = hdi_min(spare, t->len[s + 2] + t->len[s + k] - t->len[s + 1 - k]);
        short_faces += spare < delta;
        add = hdi_max(add, delta - spare);
    }
    for (s = 0; s < t->n_sides; s++) t->len[s] += add;
    for (s = 0; s < t->n_sides / 3; s++) hdi_intrinsic_area(t, s);
    rep->n_mollified = short_faces / t->n_sheets;
    rep->mollify_epsilon = add * t->unit;
}

/* Four times the sum of the cotangents of a triangle; also what their rounding errors are relative to. */
static double hdi_harmonic(double a, double b, double c, double area) { return (a * a + b * b + c * c) / area; }

/* An edge is Delaunay when the cotangents opposite to it do not sum to less than zero, up to this much of all cotangents of its two faces. */
#define HDI_DELAUNAY_TOL 1e-14

static int hdi_not_delaunay(const hdi_intrinsic *t, int32_t a) {
    const int32_t b = t->twin[a], f = a / 3, g = b / 3;
    const double *p = t->len + 3 * HDI_CAST(int64_t, f), *q = t->len + 3 * HDI_CAST(int64_t, b < 0 ? 0 : g);
    double sum;
    if (b < 0 || f == g || !(t->area[f] > 0) || !(t->area[g] > 0)) return 0;   /* where a face is glued to itself the two sides are equal: Delaunay */
    sum = hdi_side_cot(t, a) + hdi_side_cot(t, b);
    return sum < 0 && sum < -HDI_DELAUNAY_TOL * (hdi_harmonic(p[0], p[1], p[2], t->area[f]) + hdi_harmonic(q[0], q[1], q[2], t->area[g]));
}

/* Flips the edge of side a, from i to j: side a comes to run from l to k, corners that were opposite to it. Returns 0 if it is fine as it is. The outer
 * sides move with it, a2 to a1, b1 to a2, b2 to b1, a1 to b2:
 *   before  a = ij, a1 = jk, a2 = ki    b = ji, b1 = il, b2 = lj        after  a = lk, a1 = ki, a2 = il    b = kl, b1 = lj, b2 = jk */
static int hdi_flip(hdi_intrinsic *t, int32_t a) {
    const int32_t b = t->twin[a], a1 = hdi_side_next(a), a2 = hdi_side_prev(a), b1 = b < 0 ? 0 : hdi_side_next(b), b2 = b < 0 ? 0 : hdi_side_prev(b);
    int32_t from[4], to[4], twin[4], vert[4], k, q;
    double len[4], x, y, d, area_f, area_g, before;
    if (!hdi_not_delaunay(t, a)) return 0;
    from[0] = to[1] = a2;
    from[1] = to[2] = b1;
    from[2] = to[3] = b2;
    from[3] = to[0] = a1;
    for (k = 0; k < 4; k++) {
        len[k] = t->len[from[k]];
        vert[k] = t->vert[from[k]];
        twin[k] = t->twin[from[k]];
        for (q = 0; q < 4; q++) {
            if (twin[k] != from[q]) continue;    /* outer sides that are glued to each other */
            twin[k] = to[q];
            break;
        }
    }
    /* The two triangles laid out in the plane, the edge along x: k and l are d apart. */
    x = ((len[0] - len[3]) * (len[0] + len[3]) + (len[2] - len[1]) * (len[2] + len[1])) / (2 * t->len[a]);
    y = 2 * (t->area[a / 3] + t->area[b / 3]) / t->len[a];
    d = sqrt(x * x + y * y);
    area_f = hdi_length_area(d, len[0], len[1]);
    area_g = hdi_length_area(d, len[2], len[3]);
    before = hdi_harmonic(t->len[a], len[0], len[3], t->area[a / 3]) + hdi_harmonic(t->len[a], len[1], len[2], t->area[b / 3]);
    if (!(area_f > 0 && area_g > 0 && hdi_harmonic(d, len[0], len[1], area_f) + hdi_harmonic(d, len[2], len[3], area_g) < before)) return 0;
    t->vert[a] = vert[2];                        /* l, where b2 begins */
    t->vert[b] = vert[0];                        /* k, where a2 begins */
    t->len[a] = t->len[b] = d;
    for (k = 0; k < 4; k++) {
        t->len[to[k]] = len[k];
        t->vert[to[k]] = vert[k];
        t->twin[to[k]] = twin[k];
        if (twin[k] >= 0) t->twin[twin[k]] = to[k];
    }
    t->area[a / 3] = area_f;
    t->area[b / 3] = area_g;
    return 1;
}

/* Flips until every edge is Delaunay: edges by their first side, after each flip the four around it, last come first served. The order depends on
 * nothing but the mesh. Stops after 64 flips per side, which no mesh has ever come near to; what is left is counted. */
static hd_status hdi_flip_all(hdi_intrinsic *t, hd_mesh_report *rep, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    int32_t *stack = HDI_TAKE(&s, int32_t, t->n_sides), seed, depth = 0, k;
    signed char *waits = HDI_TAKE_ZERO(&s, signed char, t->n_sides);
    const int64_t most = 64 * HDI_CAST(int64_t, t->n_sides);
    int64_t work = 0;
    if (e->status < 0) return hdi_scope_end(&s);
    for (seed = 0; seed < t->n_sides; seed++) {
        if (t->twin[seed] < seed) continue;      /* boundary, or done as its other side: who moves is put on the stack */
        stack[depth++] = seed;
        waits[seed] = 1;
        while (depth > 0) {
            const int32_t a = stack[--depth];
            waits[a] = 0;
            if (!(++work & 0xfffff) && hdi_progress(ctx, "flip edges", HDI_CAST(double, seed) / t->n_sides, e) < 0) return hdi_scope_end(&s);
            if (rep->n_flips >= most || !hdi_flip(t, a)) continue;
            rep->n_flips++;
            for (k = 0; k < 4; k++) {
                const int32_t b = t->twin[a], out = k == 0 ? hdi_side_prev(b) : k == 1 ? hdi_side_next(b) : k == 2 ? hdi_side_prev(a) : hdi_side_next(a);
                if (t->twin[out] < 0 || waits[out]) continue;
                stack[depth++] = out;
                waits[out] = 1;
            }
        }
    }
    for (seed = 0; seed < t->n_sides; seed++) {
        rep->n_not_delaunay += t->twin[seed] > seed && hdi_not_delaunay(t, seed);
        rep->n_self_edges += t->twin[seed] > seed && t->vert[seed] == t->vert[hdi_side_next(seed)];
    }
    return hdi_scope_end(&s);
}

/* The intrinsic triangles as a mesh for the operators, with areas and cotangents times weight; no coordinates. Corners of the same vertex come first
 * in their face: then sums come in the same order in both rows of an edge. */
static hd_status hdi_intrinsic_mesh(hdi_mesh *mesh, hdi_intrinsic *t, int32_t n, double weight, hd_mesh_report *rep, hdi_scope *s) {
    int32_t f, q;
    memset(mesh, 0, sizeof *mesh);
    mesh->tri = t->vert;
    mesh->n = n;
    mesh->m = t->n_sides / 3;
    mesh->area = t->area;
    mesh->cot = HDI_TAKE_ZERO(s, double, t->n_sides);
    if (s->e->status < 0) return s->e->status;
    rep->smallest_intrinsic_angle = mesh->m > 0 ? 4 : 0;
    for (f = 0; f < mesh->m; f++) {
        int32_t *v = t->vert + 3 * HDI_CAST(int64_t, f);
        double *len = t->len + 3 * HDI_CAST(int64_t, f), *cot = mesh->cot + 3 * HDI_CAST(int64_t, f), last = len[2];
        if (v[0] == v[2] && v[0] != v[1]) {      /* turned by one corner */
            v[2] = v[1];
            v[1] = v[0];
            len[2] = len[1];
            len[1] = len[0];
            len[0] = last;
        }
        if (!(t->area[f] > 0)) continue;
        for (q = 0; q < 3; q++) {                /* the angle at corner q is opposite to the side that begins at the next */
            cot[q] = hdi_side_cot(t, 3 * f + (q + 1) % 3);
            if (!hdi_finite(cot[q])) t->area[f] = 0;
        }
        if (!(t->area[f] > 0)) continue;
        rep->smallest_intrinsic_angle = hdi_min(rep->smallest_intrinsic_angle, atan2(1, hdi_max(cot[0], hdi_max(cot[1], cot[2]))));
        for (q = 0; q < 3; q++) cot[q] *= weight;
        t->area[f] *= weight * t->unit * t->unit;
        if (t->area[f] / 12 < DBL_MIN) t->area[f] = 0;
    }
    return HD_OK;
}

/* ---- soups ----
 * Triangles that come several times each: the stars of points, where every triangle comes from all its three corners if these agree. Their tufted cover is
 * that of Sharp and Crane with copies of a face in layers, one sheet upon the other. It is not stored: what matters are the lengths of all faces, which are
 * those in space unless they are flipped, and the gluing of those few edges that may not be Delaunay and of what comes to lie beside them. Faces get sides of
 * their own (all copies, front and back) when one of their edges is glued, and an edge is glued, all its sides at once, when it is looked at. */

typedef struct hdi_soup {
    hdi_mesh mesh;      /* each face once, its corners ascending; cot and area are those of lengths, unit 1 the mean edge length */
    hdi_sides sides;
    int32_t *tri;       /* [3 m] */
    int32_t *copies;    /* [m] how often a face came */
    int32_t *odd;       /* [m] how many of these had their corners in odd order */
    double *len;        /* [3 m] */
    double unit, add;   /* add: what is added to each length */
    double area;        /* of all copies, in space */
} hdi_soup;

/* Faces of a bucket: its keys, sorted, second corner << 32 | third corner << 1 | odd, become faces. Returns how many; with soup NULL they are only counted. */
static int64_t hdi_soup_bucket(hdi_soup *soup, int64_t m, int32_t i, const uint64_t *key, int64_t n) {
    int64_t p, q, count = 0;
    for (p = 0; p < n; p = q, count++) {
        int32_t odd = 0;
        for (q = p; q < n && key[q] >> 1 == key[p] >> 1; q++) odd += HDI_CAST(int32_t, key[q] & 1);
        if (!soup) continue;
        soup->tri[3 * (m + count)] = i;
        soup->tri[3 * (m + count) + 1] = HDI_CAST(int32_t, key[p] >> 32);
        soup->tri[3 * (m + count) + 2] = HDI_CAST(int32_t, (key[p] & 0xffffffffu) >> 1);
        soup->copies[m + count] = HDI_CAST(int32_t, q - p);
        soup->odd[m + count] = odd;
    }
    return count;
}

/* Different faces of the m triangles tri, into soup in s. */
static hd_status hdi_soup_faces(hdi_soup *soup, const int32_t *tri, int64_t m, int32_t n, hdi_scope *s) {
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    int64_t *ptr = HDI_TAKE_ZERO(&own, int64_t, HDI_CAST(int64_t, n) + 1), f, count = 0;
    uint64_t *key = HDI_TAKE(&own, uint64_t, m), *work = HDI_TAKE(&own, uint64_t, m < 4096 ? m : 4096), *large = work;
    int32_t i;
    int pass;
    if (s->e->status < 0) return hdi_scope_end(&own);
    for (pass = 0; pass < 2; pass++) {           /* by their smallest corner: counted, then put there */
        for (f = 0; f < m; f++) {
            const int32_t a = tri[3 * f], b = tri[3 * f + 1], c = tri[3 * f + 2];
            const int32_t first = a < b ? (a < c ? a : c) : b < c ? b : c, last = a > b ? (a > c ? a : c) : b > c ? b : c;
            const int64_t middle = HDI_CAST(int64_t, a) + b + c - first - last;
            const int odd = ((a > b) + (b > c) + (a > c)) & 1;
            if (pass) key[ptr[first]++] = HDI_CAST(uint64_t, middle) << 32 | HDI_CAST(uint64_t, last) << 1 | HDI_CAST(uint64_t, odd);
            else ptr[first]++;
        }
        if (!pass) hdi_prefix_sum(ptr, n);
    }
    for (i = n; i > 0; i--) ptr[i] = ptr[i - 1];
    ptr[0] = 0;
    for (i = 0; i < n; i++) {
        const int64_t begin = ptr[i], size = ptr[i + 1] - begin;
        if (size > 4096 && large == work) large = HDI_TAKE(&own, uint64_t, m);
        if (!large) return hdi_scope_end(&own);
        hdi_sort_keys(key + begin, size, large);
        count += hdi_soup_bucket(NULL, 0, i, key + begin, size);
    }
    soup->tri = HDI_TAKE(s, int32_t, 3 * count);
    soup->copies = HDI_TAKE(s, int32_t, count);
    soup->odd = HDI_TAKE(s, int32_t, count);
    if (s->e->status < 0) return hdi_scope_end(&own);
    for (i = 0, f = 0; i < n; i++) f += hdi_soup_bucket(soup, f, i, key + ptr[i], ptr[i + 1] - ptr[i]);
    soup->mesh.tri = soup->tri;
    soup->mesh.n = n;
    soup->mesh.m = HDI_CAST(int32_t, count);
    return hdi_scope_end(&own);
}

/* Edges of the soup, and the report: all copies count. border [n] unites the vertices of boundary edges. Returns the sum of the edges' lengths. */
static double hdi_soup_edges(hdi_soup *soup, int32_t *border, hd_mesh_report *rep) {
    const hdi_mesh *mesh = &soup->mesh;
    hdi_sides *g = &soup->sides;
    double length = 0;
    int32_t i, p, q;
    for (i = 0; i < mesh->n; i++) border[i] = i;
    for (i = 0; i < mesh->n; i++) {
        const int32_t end = g->ptr[i + 1];
        hdi_sides_sort(g, i);
        for (p = g->ptr[i]; p < end; p = q) {
            const int32_t j = hdi_key_vertex(g->key[p]);
            int64_t copies = 0, forward = 0;
            for (q = p; q < end && hdi_key_vertex(g->key[q]) == j; q++) {
                const int32_t f = hdi_key_face(g->key[q]), odd = soup->odd[f];
                copies += soup->copies[f];
                forward += hdi_key_corner(g->key[q]) < 2 ? soup->copies[f] - odd : odd;
            }
            length += hdi_edge_length(mesh->xyz, i, j);
            rep->n_edges++;
            rep->n_boundary_edges += copies == 1;
            rep->n_nonmanifold_edges += copies > 2;
            rep->n_misoriented_edges += copies == 2 && forward != 1;
            if (copies == 1) hdi_unite(border, i, j);
        }
    }
    return length;
}

/* Lengths of the faces in units of the mean one; how much the worst of a block lacks to satisfy the triangle inequality with delta to spare. */
typedef struct hdi_soup_job { hdi_soup *soup; double delta, *add, *steepest; int64_t *n_short; } hdi_soup_job;

static void hdi_soup_length_task(void *arg, int64_t index, int32_t worker) {
    const hdi_soup_job *job = HDI_CAST(const hdi_soup_job *, arg);
    hdi_soup *soup = job->soup;
    const int64_t end = hdi_least(soup->mesh.m, (index + 1) * HDI_FACES_PER_TASK);
    double add = 0;
    int64_t f, n_short = 0;
    int q;
    (void)worker;
    for (f = index * HDI_FACES_PER_TASK; f < end; f++) {
        double *len = soup->len + 3 * f, spare;
        if (!(soup->mesh.area[f] > 0)) continue;
        for (q = 0; q < 3; q++) len[q] = hdi_edge_length(soup->mesh.xyz, soup->tri[3 * f + q], soup->tri[3 * f + hdi_next3[q]]) / soup->unit;
        spare = hdi_min(len[0] + len[1] - len[2], hdi_min(len[2] + len[0] - len[1], len[2] + len[1] - len[0]));
        if (spare < job->delta) n_short += soup->copies[f];
        if (job->delta >= 0) add = hdi_max(add, job->delta - spare);
    }
    job->add[index] = add;
    job->n_short[index] = n_short;
}

static void hdi_soup_cot_task(void *arg, int64_t index, int32_t worker) {
    const hdi_soup_job *job = HDI_CAST(const hdi_soup_job *, arg);
    hdi_soup *soup = job->soup;
    const int64_t end = hdi_least(soup->mesh.m, (index + 1) * HDI_FACES_PER_TASK);
    int64_t f;
    int q;
    (void)worker;
    for (f = index * HDI_FACES_PER_TASK; f < end; f++) {
        double *len = soup->len + 3 * f, *cot = soup->mesh.cot + 3 * f, area;
        cot[0] = cot[1] = cot[2] = 0;
        if (!(soup->mesh.area[f] > 0)) continue;
        for (q = 0; q < 3; q++) len[q] += soup->add;
        soup->mesh.area[f] = area = hdi_length_area(len[0], len[1], len[2]);
        for (q = 0; q < 3 && area > 0; q++) {
            const double a = len[hdi_next3[q]], b = len[q], c = len[hdi_prev3[q]];
            cot[q] = (b * b + c * c - a * a) / (4 * area);
        }
    }
}

/* The soup of the m triangles tri among n points: faces, edges, lengths mollified by delta (see hdi_mollify), in s. */
static hd_status hdi_soup_make(hdi_soup *soup, const double *xyz, int32_t n, const int32_t *tri, int64_t m, double delta, hd_mesh_report *rep, hdi_scope *s) {
    hd_mesh_report faces;
    hdi_soup_job job;
    int64_t n_tasks, i, n_short = 0;
    int32_t f, *border;
    memset(soup, 0, sizeof *soup);
    memset(&faces, 0, sizeof faces);
    if (hdi_soup_faces(soup, tri, m, n, s) < 0) return s->e->status;
    soup->mesh.xyz = xyz;
    m = soup->mesh.m;
    n_tasks = (m + HDI_FACES_PER_TASK - 1) / HDI_FACES_PER_TASK;
    soup->mesh.cot = HDI_TAKE(s, double, 3 * m);
    soup->mesh.area = HDI_TAKE(s, double, m);
    soup->len = HDI_TAKE(s, double, 3 * m);
    job.soup = soup;
    job.delta = delta;
    job.add = HDI_TAKE(s, double, n_tasks);
    job.n_short = HDI_TAKE(s, int64_t, n_tasks);
    border = HDI_TAKE(s, int32_t, n);
    if (s->e->status < 0 || hdi_faces_measure(&soup->mesh, &faces, s) < 0) return s->e->status;
    rep->smallest_angle = faces.smallest_angle;
    for (f = 0; f < m; f++) {
        const double area = soup->mesh.area[f];
        rep->n_faces += soup->copies[f];
        *(area > 0 ? &rep->n_faces_used : &rep->n_zero_area) += soup->copies[f];
        soup->area += area * soup->copies[f];
    }
    if (hdi_sides_make(&soup->sides, &soup->mesh, s) < 0) return s->e->status;
    soup->unit = hdi_soup_edges(soup, border, rep) / HDI_CAST(double, rep->n_edges > 0 ? rep->n_edges : 1);
    rep->n_boundary_loops = rep->n_boundary_edges ? hdi_count_sets(border, n) : 0;
    hdi_parallel(s->ctx, n_tasks, hdi_soup_length_task, &job);
    for (i = 0; i < n_tasks; i++) {
        soup->add = hdi_max(soup->add, job.add[i]);
        n_short += job.n_short[i];
    }
    rep->n_mollified = delta >= 0 ? HDI_CAST(int32_t, n_short) : 0;
    rep->mollify_epsilon = soup->add * soup->unit;
    hdi_parallel(s->ctx, n_tasks, hdi_soup_cot_task, &job);
    return HD_OK;
}

/* What of a soup's cover has been unfolded. */
typedef struct hdi_cover {
    const hdi_soup *soup;
    hd_context *ctx;
    hd_error *e;
    hdi_intrinsic t;    /* twin -2: not glued yet */
    int32_t n, room;    /* faces of t, and those that there is room for */
    int32_t *first;     /* [m] where the copies of a face begin, front and back in turn; -1: not here */
    int32_t *origin;    /* [room] the face that a face of t is a copy of */
    int32_t *stack;     /* [3 room] sides to look at */
    signed char *waits; /* [3 room] 1: on the stack */
    signed char *glued; /* [3 m] at the first side of an edge */
    hdi_pair *list;     /* [most faces at an edge] */
    int32_t depth;
} hdi_cover;

static void hdi_cover_free(hdi_cover *c) {
    hdi_free(c->ctx, c->t.vert);
    hdi_free(c->ctx, c->t.twin);
    hdi_free(c->ctx, c->t.len);
    hdi_free(c->ctx, c->t.area);
    hdi_free(c->ctx, c->origin);
    hdi_free(c->ctx, c->stack);
    hdi_free(c->ctx, c->waits);
}

/* old with n elements in a block of room elements; NULL, old freed, when there is none. */
static void *hdi_regrow(hdi_cover *c, void *old, int64_t n, int64_t room, size_t size) {
    void *block = c->e->status < 0 ? NULL : hdi_alloc(c->ctx, HDI_CAST(uint64_t, room), size, c->e);
    if (block && n > 0) memcpy(block, old, HDI_CAST(size_t, n) * size);
    hdi_free(c->ctx, old);
    return block;
}

static hd_status hdi_cover_room(hdi_cover *c, int32_t more) {
    const int64_t n = c->n, need = n + more, room = need > 2 * HDI_CAST(int64_t, c->room) ? need + 1024 : 2 * HDI_CAST(int64_t, c->room);
    if (need <= c->room) return HD_OK;
    if (3 * room > INT32_MAX) return hdi_fail(c->e, HD_ERR_TOO_LARGE, "more than 2^31 face corners in a cover of two sheets");
    c->t.vert = HDI_CAST(int32_t *, hdi_regrow(c, c->t.vert, 3 * n, 3 * room, sizeof(int32_t)));
    c->t.twin = HDI_CAST(int32_t *, hdi_regrow(c, c->t.twin, 3 * n, 3 * room, sizeof(int32_t)));
    c->t.len = HDI_CAST(double *, hdi_regrow(c, c->t.len, 3 * n, 3 * room, sizeof(double)));
    c->t.area = HDI_CAST(double *, hdi_regrow(c, c->t.area, n, room, sizeof(double)));
    c->origin = HDI_CAST(int32_t *, hdi_regrow(c, c->origin, n, room, sizeof(int32_t)));
    c->stack = HDI_CAST(int32_t *, hdi_regrow(c, c->stack, c->depth, 3 * room, sizeof(int32_t)));
    c->waits = HDI_CAST(signed char *, hdi_regrow(c, c->waits, 3 * n, 3 * room, 1));
    if (c->e->status >= 0) c->room = HDI_CAST(int32_t, room);
    return c->e->status;
}

/* Unfolds face f: all its copies. */
static hd_status hdi_cover_face(hdi_cover *c, int32_t f) {
    const hdi_soup *soup = c->soup;
    int32_t k, q;
    if (c->first[f] >= 0) return HD_OK;
    if (soup->copies[f] > INT32_MAX / 6 || hdi_cover_room(c, 2 * soup->copies[f]) < 0)
        return c->e->status < 0 ? c->e->status : hdi_fail(c->e, HD_ERR_TOO_LARGE, "more than 2^31 face corners in a cover of two sheets");
    c->first[f] = c->n;
    for (k = 0; k < 2 * soup->copies[f]; k++, c->n++) {
        for (q = 0; q < 3; q++) {                /* a back runs through the face the other way round */
            const int32_t at = 3 * c->n + (k & 1 ? 2 - q : q);
            c->t.vert[at] = soup->tri[3 * HDI_CAST(int64_t, f) + (k & 1 ? hdi_next3[q] : q)];
            c->t.len[at] = soup->len[3 * HDI_CAST(int64_t, f) + q];
            c->t.twin[at] = -2;
            c->waits[at] = 0;
        }
        c->t.area[c->n] = soup->mesh.area[f];
        c->origin[c->n] = f;
    }
    c->t.n_sides = 3 * c->n;
    return HD_OK;
}

static void hdi_cover_push(hdi_cover *c, int32_t side) {
    if (c->t.twin[side] < 0 || c->waits[side]) return;
    c->stack[c->depth++] = side;
    c->waits[side] = 1;
}

/* The side of a soup's face f that begins at its corner q, on copy k, front or back. */
static int32_t hdi_cover_side(const hdi_cover *c, int32_t f, int32_t q, int32_t k, int back) {
    return 3 * (c->first[f] + 2 * k + back) + (back ? 2 - q : q);
}

/* Glues the edge whose sides are keys [p, q) at vertex v, and puts it on the stack: in layers of copies, in each by angle, around the edge the side of a face
 * that looks counterclockwise to the side of the next one that looks back at it. */
static hd_status hdi_cover_glue(hdi_cover *c, int32_t v, int32_t p, int32_t q) {
    const hdi_soup *soup = c->soup;
    const uint64_t *key = soup->sides.key;
    const int32_t n = q - p;
    int32_t i, layer, most = 0, first = -1, last = -1;
    if (c->glued[p]) return HD_OK;
    c->glued[p] = 1;
    for (i = 0; i < n; i++) {
        const int32_t f = hdi_key_face(key[p + i]);
        if (hdi_cover_face(c, f) < 0) return c->e->status;
        c->list[i].key = HDI_CAST(uint64_t, i);
        c->list[i].id = 3 * HDI_CAST(int64_t, f) + hdi_key_corner(key[p + i]);
        most = soup->copies[f] > most ? soup->copies[f] : most;
    }
    if (n > 2) hdi_sort_around(&soup->mesh, v, hdi_key_vertex(key[p]), c->list, n);
    for (layer = 0; layer < most; layer++) {
        for (i = 0; i < n; i++) {                /* corners ascend in a face: its front looks counterclockwise unless it is the side from last to first */
            const int32_t side = HDI_CAST(int32_t, c->list[i].id), f = side / 3, back = side % 3 == 2;
            int32_t counter, clock;
            if (layer >= soup->copies[f]) continue;
            counter = hdi_cover_side(c, f, side % 3, layer, back);
            clock = hdi_cover_side(c, f, side % 3, layer, !back);
            if (last >= 0) hdi_glue(&c->t, last, clock);
            else first = clock;
            if (last >= 0) hdi_cover_push(c, clock);
            last = counter;
        }
    }
    hdi_glue(&c->t, last, first);
    hdi_cover_push(c, first);
    return HD_OK;
}

/* Glues the edge of side s of the cover, if it is not yet: then s is still a side of its own face. */
static hd_status hdi_cover_need(hdi_cover *c, int32_t s) {
    const hdi_sides *g = &c->soup->sides;
    const int32_t i = c->t.vert[s], j = c->t.vert[hdi_side_next(s)], lo = i < j ? i : j, hi = i < j ? j : i;
    int32_t p = g->ptr[lo], end = g->ptr[lo + 1], q = end;
    if (c->t.twin[s] != -2) return HD_OK;
    while (p < q) {                              /* the first key of hi */
        const int32_t middle = p + (q - p) / 2;
        if (hdi_key_vertex(g->key[middle]) < hi) p = middle + 1;
        else q = middle;
    }
    for (q = p; q < end && hdi_key_vertex(g->key[q]) == hi;) q++;
    return hdi_cover_glue(c, lo, p, q);
}

/* Whether the edge of keys [p, q) may have to be flipped, however its faces are glued. Two faces that come equally often always follow each other. */
static int hdi_soup_suspect(const hdi_soup *soup, int32_t p, int32_t q) {
    const uint64_t *key = soup->sides.key;
    double least = HUGE_VAL, next = HUGE_VAL;
    int64_t copies = 0;
    int32_t i;
    for (i = p; i < q; i++) {
        const int32_t f = hdi_key_face(key[i]);
        const double cot = soup->mesh.cot[hdi_key_opposite(key[i])];
        if (cot < least) {
            next = least;
            least = cot;
        } else {
            next = hdi_min(next, cot);
        }
        if (soup->copies[f] > 1 && !(q - p == 2 && soup->copies[f] == soup->copies[hdi_key_face(key[p + q - 1 - i])])) next = hdi_min(next, cot);
        copies += soup->copies[f];
    }
    return !(least + (copies == 1 ? least : next) >= 0);
}

/* Flips until every edge is Delaunay, as hdi_flip_all: edges by their vertices, after each flip the four around it. */
static hd_status hdi_cover_flip(hdi_cover *c, int64_t most, hd_mesh_report *rep) {
    hdi_intrinsic *t = &c->t;
    int32_t k, side;
    while (c->depth > 0) {
        const int32_t a = c->stack[--c->depth], b = t->twin[a];
        c->waits[a] = 0;
        if (rep->n_flips >= most || !hdi_not_delaunay(t, a)) continue;
        for (k = 0; k < 4; k++)
            if (hdi_cover_need(c, k == 0 ? hdi_side_prev(b) : k == 1 ? hdi_side_next(b) : k == 2 ? hdi_side_prev(a) : hdi_side_next(a)) < 0) return c->e->status;
        if (!hdi_flip(t, a)) continue;
        rep->n_flips++;
        for (k = 0; k < 4; k++) {
            side = t->twin[a];
            hdi_cover_push(c, k == 0 ? hdi_side_prev(side) : k == 1 ? hdi_side_next(side) : k == 2 ? hdi_side_prev(a) : hdi_side_next(a));
        }
    }
    return HD_OK;
}

static hd_status hdi_cover_run(hdi_cover *c, hd_mesh_report *rep) {
    const hdi_soup *soup = c->soup;
    const hdi_sides *g = &soup->sides;
    int64_t most = 0;
    int32_t v, p, q, end, side;
    for (v = 0; v < soup->mesh.m; v++) most += 64 * 6 * HDI_CAST(int64_t, soup->copies[v]);
    for (v = 0; v < soup->mesh.n; v++) {
        for (p = g->ptr[v], end = g->ptr[v + 1]; p < end; p = q) {
            for (q = p + 1; q < end && hdi_key_vertex(g->key[q]) == hdi_key_vertex(g->key[p]);) q++;
            if (c->glued[p] || !hdi_soup_suspect(soup, p, q)) continue;
            if (hdi_cover_glue(c, v, p, q) < 0 || hdi_cover_flip(c, most, rep) < 0) return c->e->status;
        }
        if (!(v & 0xffff) && hdi_progress(c->ctx, "flip edges", HDI_CAST(double, v) / soup->mesh.n, c->e) < 0) return c->e->status;
    }
    for (side = 0; side < c->t.n_sides; side++) {
        rep->n_not_delaunay += c->t.twin[side] > side && hdi_not_delaunay(&c->t, side);
        rep->n_self_edges += c->t.twin[side] > side && c->t.vert[side] == c->t.vert[hdi_side_next(side)];
    }
    return HD_OK;
}

/* One face of the flat mesh, from its lengths: area and cotangents times weight. */
static void hdi_flat_face(hdi_mesh *flat, int32_t at, const double *len, double area, double unit, double weight, double *steepest) {
    double *cot = flat->cot + 3 * HDI_CAST(int64_t, at);
    int q;
    flat->area[at] = 0;
    if (!(area > 0)) return;
    for (q = 0; q < 3; q++) {
        const double a = len[hdi_next3[q]], b = len[q], c = len[hdi_prev3[q]];
        cot[q] = (b * b + c * c - a * a) / (4 * area);
    }
    if (!hdi_finite(fabs(cot[0]) + fabs(cot[1]) + fabs(cot[2]))) return;
    *steepest = hdi_max(*steepest, hdi_max(cot[0], hdi_max(cot[1], cot[2])));
    for (q = 0; q < 3; q++) cot[q] *= weight;
    area *= weight * unit * unit;
    flat->area[at] = area / 12 < DBL_MIN ? 0 : area;
}

/* The intrinsic Delaunay triangulation of a soup's cover as a mesh for the operators (no coordinates), in s: faces that were not unfolded as often as they
 * come, the others one by one; all with a third of their weight for a sheet, of which there are two. */
static hd_status hdi_soup_delaunay(hdi_mesh *flat, const hdi_soup *soup, hd_mesh_report *rep, hdi_scope *s) {
    const int32_t m = soup->mesh.m;
    double steepest = -HUGE_VAL;
    hdi_cover c;
    int32_t f, i, most = 1, *tri;
    memset(&c, 0, sizeof c);
    memset(flat, 0, sizeof *flat);
    c.soup = soup;
    c.ctx = s->ctx;
    c.e = s->e;
    c.t.unit = soup->unit;
    for (i = 0; i < soup->mesh.n; i++) most = soup->sides.ptr[i + 1] - soup->sides.ptr[i] > most ? soup->sides.ptr[i + 1] - soup->sides.ptr[i] : most;
    c.first = HDI_TAKE(s, int32_t, m);
    c.glued = HDI_TAKE_ZERO(s, signed char, 3 * HDI_CAST(int64_t, m));
    c.list = HDI_TAKE(s, hdi_pair, most);
    if (s->e->status >= 0) {
        hdi_fill_i32(c.first, m, -1);
        (void)hdi_cover_run(&c, rep);
    }
    flat->n = soup->mesh.n;
    flat->m = m + c.n;
    flat->tri = tri = HDI_TAKE(s, int32_t, 3 * HDI_CAST(int64_t, flat->m));
    flat->cot = HDI_TAKE(s, double, 3 * HDI_CAST(int64_t, flat->m));
    flat->area = HDI_TAKE(s, double, flat->m);
    if (s->e->status >= 0) {
        memcpy(tri, soup->tri, 3 * HDI_CAST(size_t, m) * sizeof *tri);
        if (c.n) memcpy(tri + 3 * HDI_CAST(int64_t, m), c.t.vert, 3 * HDI_CAST(size_t, c.n) * sizeof *tri);
        for (f = 0; f < m; f++)
            hdi_flat_face(flat, f, soup->len + 3 * HDI_CAST(int64_t, f), c.first[f] < 0 ? soup->mesh.area[f] : 0, soup->unit, soup->copies[f] / 3.0, &steepest);
        for (i = 0; i < c.n; i++) hdi_flat_face(flat, m + i, c.t.len + 3 * HDI_CAST(int64_t, i), c.t.area[i], soup->unit, 1.0 / 6, &steepest);
        rep->smallest_intrinsic_angle = hdi_finite(steepest) ? atan2(1, steepest) : 0;
        rep->n_sheets = 2;
    }
    hdi_cover_free(&c);
    return s->e->status;
}

/* ==== [10] operators ====
 * The pair (L, B) on one pattern. May call [09], [08] and [07].
 * This work is based on
 *   U. Pinkall, K. Polthier, Computing discrete minimal surfaces and their conjugates, 1993 (cotangent weights)
 *   M. Meyer, M. Desbrun, P. Schroeder, A. Barr, Discrete differential-geometry operators for triangulated 2-manifolds, 2003 (mixed areas)
 *   M. Alexa, M. Wardetzky, Discrete Laplacians on general polygonal meshes, 2011 (polygons)
 *   N. Sharp, K. Crane, A Laplacian for nonmanifold triangle meshes, 2020 (tufted points; the cover itself is in [09])
 *   J.-D. Boissonnat, A. Ghosh, Manifold reconstruction using tangential Delaunay complexes, 2014 (stars)
 * and, of point sets, on what is named there.
 * Deviations: the paper cites Desbrun 1999 for Voronoi areas, which lumps by thirds; pure Voronoi areas go negative on obtuse triangles. Those of
 * polygons and point sets are listed there. */

static void hdi_laplacian_free(hd_laplacian *lap, hd_context *ctx) {
    if (!lap) return;
    hdi_csr_free(ctx, &lap->L);
    if (lap->b_diag != lap->mass) hdi_free(ctx, lap->b_diag);
    hdi_free(ctx, lap->B);
    hdi_free(ctx, lap->mass);
    hdi_free(ctx, lap->vertex);
    hdi_free(ctx, lap->row);
    hdi_free(ctx, lap->component);
    hdi_free(ctx, lap->xyz);
    hdi_free(ctx, lap->component_mass);
    hdi_free(ctx, lap);
}

static hdi_lump hdi_lap_lump(hd_laplacian_kind kind) {
    return kind == HD_LAPLACIAN_FEM ? HDI_LUMP_THIRDS : kind == HD_LAPLACIAN_COT ? HDI_LUMP_ONES : HDI_LUMP_MIXED;
}

/* Numbers the rows: vertices with mass in their order. Fills row, vertex, mass, b_diag, n_active. */
static hd_status hdi_lap_rows(hd_laplacian *lap, const double *vertex_mass, hd_error *e) {
    int32_t v, k = 0;
    hd_context *ctx = lap->context;
    lap->row = HDI_CAST(int32_t *, hdi_alloc(ctx, HDI_CAST(uint64_t, lap->n), sizeof(int32_t), e));
    if (!lap->row) return e->status;
    for (v = 0; v < lap->n; v++) lap->row[v] = vertex_mass[v] > 0 ? k++ : -1;
    lap->n_active = k;
    lap->mesh.n_inert = lap->n - k;
    if (k == 0) return hdi_fail(e, HD_ERR_EMPTY, "no vertex has mass");
    lap->vertex = HDI_CAST(int32_t *, hdi_alloc(ctx, HDI_CAST(uint64_t, k), sizeof(int32_t), e));
    if (lap->vertex) lap->mass = HDI_CAST(double *, hdi_alloc(ctx, HDI_CAST(uint64_t, k), sizeof(double), e));
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
    lap->component = HDI_CAST(int32_t *, hdi_alloc(lap->context, HDI_CAST(uint64_t, lap->n_active), sizeof(int32_t), e));
    if (!lap->component) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) parent[i] = i;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1] && lap->L.col[p] < i; p++) hdi_unite(parent, i, lap->L.col[p]);
    for (i = 0; i < lap->n_active; i++) {
        const int32_t root = hdi_find(parent, i);    /* roots are smallest members, so they have their number already */
        lap->component[i] = root == i ? lap->n_components++ : lap->component[root];
    }
    lap->component_mass = HDI_CAST(double *, hdi_alloc(lap->context, HDI_CAST(uint64_t, lap->n_components), sizeof(double), e));
    if (!lap->component_mass) return hdi_scope_end(&s);
    memset(lap->component_mass, 0, HDI_CAST(size_t, lap->n_components) * sizeof(double));
    for (i = 0; i < lap->n_active; i++) lap->component_mass[lap->component[i]] += lap->mass[i];
    return hdi_scope_end(&s);
}

/* Components from the vertices that edges unite, parent [n], as hdi_lap_components has them from the pattern. */
static hd_status hdi_lap_united(hd_laplacian *lap, int32_t *parent, hd_error *e) {
    int32_t i;
    lap->component = HDI_CAST(int32_t *, hdi_alloc(lap->context, HDI_CAST(uint64_t, lap->n_active), sizeof(int32_t), e));
    if (!lap->component) return e->status;
    for (i = 0; i < lap->n_active; i++) {
        const int32_t root = lap->row[hdi_find(parent, lap->vertex[i])];
        lap->component[i] = root == i ? lap->n_components++ : lap->component[root];
    }
    lap->component_mass = HDI_CAST(double *, hdi_alloc(lap->context, HDI_CAST(uint64_t, lap->n_components), sizeof(double), e));
    if (!lap->component_mass) return e->status;
    memset(lap->component_mass, 0, HDI_CAST(size_t, lap->n_components) * sizeof(double));
    for (i = 0; i < lap->n_active; i++) lap->component_mass[lap->component[i]] += lap->mass[i];
    return HD_OK;
}

typedef struct hdi_lap_job {
    hd_laplacian *lap;
    const hdi_edges *g;
    int64_t *next;              /* [n_active] where each row goes on */
    int64_t *negative;          /* [blocks of 2^g->shift rows] edges with a weight above zero */
} hdi_lap_job;

/* The edge with number p from row i to a later row j, into that row. */
static HDI_INLINE void hdi_lap_mirror(const hdi_lap_job *job, int32_t i, int32_t j, int32_t p) {
    const int64_t at = job->next[j]++;
    job->lap->L.col[at] = i;
    job->lap->L.val[at] = job->g->w[p];
    if (job->lap->B) job->lap->B[at] = job->g->b[p];
}

/* Row i from its diagonal on; what it has before was written by those rows: each edge goes into both its rows, so that L and B are symmetric to the last
 * bit. Rows from end on have their part already. Returns the number of weights above zero. */
static HDI_INLINE int64_t hdi_lap_row(const hdi_lap_job *job, int32_t i, int32_t end) {
    hd_laplacian *lap = job->lap;
    const hdi_edges *g = job->g;
    const int32_t v = lap->vertex[i], last = g->last[v], *row = lap->row;
    const int64_t diagonal = job->next[i];
    double *L = lap->L.val, *B = lap->B, sum = 0, loops = 0;
    int32_t *col = lap->L.col, p;
    int64_t at, negative = 0;
    for (at = lap->L.row_ptr[i]; at < diagonal; at++) sum += L[at];
    for (p = g->first[v]; p < last; p++) {
        const int32_t j = row[g->to[p]];
        const double w = g->w[p];
        if (j == i) {                            /* an edge from the vertex to itself: no weight, and twice in its B */
            loops += B ? 2 * g->b[p] : 0;
            continue;
        }
        negative += w > 0;
        sum += w;
        col[++at] = j;
        L[at] = w;
        if (B) B[at] = g->b[p];
        if (j < end) hdi_lap_mirror(job, i, j, p);
    }
    col[diagonal] = i;
    L[diagonal] = -sum;
    if (B) B[diagonal] = lap->b_diag[i] = lap->mass[i] / 2 + loops;    /* a sixth of the areas that the mass has thirds of */
    return negative;
}

/* The row behind the block of row i. */
static int32_t hdi_lap_block_end(const hdi_lap_job *job, int64_t block) {
    return HDI_CAST(int32_t, hdi_least(job->lap->n_active, (block + 1) << job->g->shift));
}

static void hdi_lap_task(void *arg, int64_t index, int32_t worker) {
    const hdi_lap_job *job = HDI_CAST(const hdi_lap_job *, arg);
    const hd_laplacian *lap = job->lap;
    const hdi_edges *g = job->g;
    const int32_t end = hdi_lap_block_end(job, index);
    int32_t i;
    int64_t negative = 0;
    (void)worker;
    for (i = HDI_CAST(int32_t, index << g->shift); i < end; i++) {
        const int32_t v = lap->vertex[i + HDI_VERTICES_AHEAD < end ? i + HDI_VERTICES_AHEAD : i];
        if (g->last[v] > g->first[v]) {          /* the farthest neighbour: its row is new to the caches, those of others are in use */
            const int32_t far_row = lap->row[g->to[g->last[v] - 1]];
            const int64_t at = lap->L.row_ptr[far_row];
            HDI_PREFETCH(lap->L.col + at);
            HDI_PREFETCH(lap->L.val + at);
            HDI_PREFETCH(lap->B ? lap->B + at : lap->L.val + at);
        }
        negative += hdi_lap_row(job, i, end);
    }
    job->negative[index] = negative;
}

/* Block by block, the edges that leave it, into their later rows, where they come first. */
static void hdi_lap_crossing(const hdi_lap_job *job, int64_t n_blocks) {
    const hdi_edges *g = job->g;
    const hd_laplacian *lap = job->lap;
    int64_t b;
    int32_t i = 0, p;
    for (b = 0; b + 1 < n_blocks; b++) {
        const int32_t end = hdi_lap_block_end(job, b), behind = lap->vertex[end];
        for (; i < end; i++) {
            const int32_t v = lap->vertex[i], last = g->last[v];
            for (p = last; p > g->first[v] && g->to[p - 1] >= behind; p--) {}
            for (; p < last; p++) hdi_lap_mirror(job, i, lap->row[g->to[p]], p);
        }
    }
}

/* Pattern and values of L and, if the edges have areas, of a full B. */
static hd_status hdi_lap_assemble(hd_laplacian *lap, const hdi_edges *g, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    const int full = g->b != NULL;
    int64_t nnz = 0, n_blocks, b;
    double *B = NULL, *b_diag = NULL;
    hdi_lap_job job;
    hd_csr L;
    int32_t i;
    job.lap = lap;
    job.g = g;
    job.next = HDI_TAKE(&s, int64_t, lap->n_active);
    job.negative = HDI_TAKE(&s, int64_t, HDI_BLOCKS_MOST);
    for (i = 0; i < lap->n_active; i++) nnz += 1 + g->smaller[lap->vertex[i]] + g->larger[lap->vertex[i]];
    L = hdi_csr_take(&s, lap->n_active, lap->n_active, nnz, 1);
    if (full) B = HDI_TAKE(&s, double, nnz);
    if (full) b_diag = HDI_TAKE(&s, double, lap->n_active);
    if (e->status < 0) return hdi_scope_end(&s);
    lap->L = hdi_csr_keep(&s, L);
    lap->B = HDI_CAST(double *, hdi_keep(&s, B));
    if (full) lap->b_diag = HDI_CAST(double *, hdi_keep(&s, b_diag));
    for (i = 0; i < lap->n_active; i++) {
        const int32_t v = lap->vertex[i];
        job.next[i] = L.row_ptr[i];
        L.row_ptr[i + 1] = L.row_ptr[i] + 1 + g->smaller[v] + g->larger[v];
    }
    n_blocks = ((lap->n_active - 1) >> g->shift) + 1;
    hdi_lap_crossing(&job, n_blocks);
    hdi_parallel(lap->context, n_blocks, hdi_lap_task, &job);
    for (b = 0; b < n_blocks; b++) lap->mesh.n_negative_weights += job.negative[b];
    return hdi_scope_end(&s);
}

/* Statistics of the edges of row i, and the union of boundary edges in parent [n_active]. Returns the sum of the edges' lengths. An entry of L with
 * a count of no faces is a diagonal of polygons. */
static double hdi_edge_report(hd_laplacian *lap, const double *xyz, int32_t i, const int32_t *count, const int32_t *turn, int32_t *parent) {
    const int64_t begin = lap->L.row_ptr[i];
    hd_mesh_report *rep = &lap->mesh;
    double sum = 0, edge[3];
    int64_t p;
    for (p = begin; p < lap->L.row_ptr[i + 1]; p++) {
        const int32_t j = lap->L.col[p], faces = count[p - begin];
        if (j <= i) continue;
        rep->n_negative_weights += lap->L.val[p] > 0;
        if (faces == 0) continue;
        hdi_sub3(xyz + 3 * HDI_CAST(int64_t, lap->vertex[j]), xyz + 3 * HDI_CAST(int64_t, lap->vertex[i]), edge);
        sum += hdi_norm3(edge);
        rep->n_edges++;
        rep->n_nonmanifold_edges += faces > 2;
        rep->n_misoriented_edges += faces == 2 && turn[p - begin] != 0;
        if (faces != 1) continue;
        rep->n_boundary_edges++;
        hdi_unite(parent, i, j);
    }
    return sum;
}

/* Counts the sets of hdi_edge_report: a loop is a root with another vertex in its set. seen [n_active] is overwritten. */
static void hdi_boundary_loops(hd_laplacian *lap, int32_t *parent, int64_t *seen) {
    int32_t i;
    for (i = 0; i < lap->n_active; i++) seen[i] = 0;
    for (i = 0; i < lap->n_active; i++) {
        const int32_t root = hdi_find(parent, i);
        if (root == i || seen[root]) continue;
        seen[root] = 1;
        lap->mesh.n_boundary_loops++;
    }
}

/* The entries of the longest row, at least 1. */
static int64_t hdi_widest_row(const hd_csr *a) {
    int64_t widest = 1;
    int32_t i;
    for (i = 0; i < a->n_rows; i++)
        if (a->row_ptr[i + 1] - a->row_ptr[i] > widest) widest = a->row_ptr[i + 1] - a->row_ptr[i];
    return widest;
}

/* Copies the places of the rows. */
static hd_status hdi_lap_places(hd_laplacian *lap, const double *xyz, hd_error *e) {
    int32_t i;
    lap->xyz = HDI_CAST(double *, hdi_alloc(lap->context, 3 * HDI_CAST(uint64_t, lap->n_active), sizeof(double), e));
    if (!lap->xyz) return e->status;
    for (i = 0; i < lap->n_active; i++) memcpy(lap->xyz + 3 * HDI_CAST(int64_t, i), xyz + 3 * HDI_CAST(int64_t, lap->vertex[i]), 3 * sizeof *xyz);
    return HD_OK;
}

/* (L, B), places, components and h of the mesh, whose arrays come to live in s. full: B is, if its kind is. */
static hd_status hdi_lap_mesh(hd_laplacian *lap, hdi_mesh *mesh, int full, hdi_scope *s) {
    hdi_scope own = hdi_scope_begin(lap->context, s->e);
    double *vertex_mass = HDI_TAKE(&own, double, lap->n);
    hd_error *e = s->e;
    hdi_edges edges;
    if (!vertex_mass) return hdi_scope_end(&own);
    if (hdi_mesh_faces(mesh, &edges, full && lap->kind == HD_LAPLACIAN_FEM, vertex_mass, hdi_lap_lump(lap->kind), &lap->mesh, s) < 0) return hdi_scope_end(&own);
    if (hdi_lap_rows(lap, vertex_mass, e) < 0 || hdi_progress(lap->context, "assemble", 0.4, e) < 0) return hdi_scope_end(&own);
    if (hdi_lap_places(lap, mesh->xyz, e) < 0 || hdi_lap_united(lap, edges.parent, e) < 0) return hdi_scope_end(&own);
    if (hdi_lap_assemble(lap, &edges, e) < 0 || hdi_progress(lap->context, "assemble", 0.8, e) < 0) return hdi_scope_end(&own);
    lap->h = edges.length / HDI_CAST(double, lap->mesh.n_edges);
    return hdi_scope_end(&own);
}

static hd_status hdi_lap_triangles(hd_laplacian *lap, const double *xyz, const int32_t *tri, int32_t m, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    hdi_mesh mesh;
    int32_t f;
    hdi_mesh_clear(&mesh, xyz, lap->n, tri, m);
    if (hdi_lap_mesh(lap, &mesh, 1, &s) < 0) return hdi_scope_end(&s);
    for (f = 0; f < m; f++) lap->area += mesh.area[f];
    lap->b_ratio = lap->kind == HD_LAPLACIAN_FEM ? 0.5 : 1;   /* element matrix area/12 (1 1' + I) >= 1/2 of its diagonal, area/12 I */
    lap->conserves = 1;
    return hdi_scope_end(&s);
}

/* ---- polygons ----
 * Of a face with k corners X [k x 3], edges E, middles of edges B_f, the difference D along the edges and the vector area of length |f|,
 *     L_f = D'(B_f B_f'/|f| + lambda C C') D,        C an orthonormal basis of the kernel of the transposed edges projected along the vector area.
 * Deviations from Alexa and Wardetzky, all of form: D'B_f is half the differences of next but one corners, g sqrt(|f|) here, which knows no origin;
 * C C' = I - Q Q' with Q two columns, so that L_f = g g' + lambda (D'D - w w') costs a few products an entry, no k x k block is ever made,
 * and faces of hundreds of corners are fine. Their M has a positive definite part for any lambda > 0; we take one number for all faces.
 * On triangles the second part is zero, and is not computed. */

/* L_f between the different corners c and d of a face of k corners; beside: they share an edge of it. The same to the last bit for (d, c). */
static double hdi_poly_entry(const hdi_poly *poly, int64_t c, int64_t d, int64_t k, int beside) {
    const double *u = poly->w + 2 * c, *v = poly->w + 2 * d, first = hdi_dot3(poly->g + 3 * c, poly->g + 3 * d);
    return k == 3 ? first : first - poly->lambda * (beside + (u[0] * v[0] + u[1] * v[1]));
}

/* Distinct vertices of the faces at v, v itself first, as rows of lap, unsorted, into col. mark [n_active] as in hdi_product_row. Returns how many. */
static int64_t hdi_poly_ring(const hdi_poly *poly, const hd_laplacian *lap, int32_t v, int32_t *mark, int32_t *col) {
    const int32_t i = lap->row[v];
    int64_t p, d, n = 1;
    mark[i] = i;
    col[0] = i;
    for (p = poly->corner_ptr[v]; p < poly->corner_ptr[v + 1]; p++) {
        const int32_t f = poly->face[poly->corner[p]];
        for (d = poly->ptr[f]; d < poly->ptr[f + 1]; d++) {
            const int32_t j = lap->row[poly->idx[d]];
            if (mark[j] == i) continue;
            mark[j] = i;
            col[n++] = j;
        }
    }
    return n;
}

/* The pattern of L, columns ascending. mark [n_active]; col [n_active], work [n_active] serve rows of any length. */
static hd_status hdi_poly_pattern(hd_laplacian *lap, const hdi_poly *poly, int32_t *mark, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    int32_t *col = HDI_TAKE(&s, int32_t, lap->n_active), i;
    hdi_pair *work = HDI_TAKE(&s, hdi_pair, lap->n_active);
    int64_t nnz = 0;
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_fill_i32(mark, lap->n_active, -1);
    for (i = 0; i < lap->n_active; i++) nnz += hdi_poly_ring(poly, lap, lap->vertex[i], mark, col);
    lap->L = hdi_csr_take(&s, lap->n_active, lap->n_active, nnz, 1);
    if (e->status < 0) {
        memset(&lap->L, 0, sizeof lap->L);
        return hdi_scope_end(&s);
    }
    hdi_fill_i32(mark, lap->n_active, -1);
    for (i = 0; i < lap->n_active; i++) {
        const int64_t begin = lap->L.row_ptr[i], n = hdi_poly_ring(poly, lap, lap->vertex[i], mark, col);
        hdi_sort_indices(col, n, work);
        memcpy(lap->L.col + begin, col, HDI_CAST(size_t, n) * sizeof *col);
        lap->L.row_ptr[i + 1] = begin + n;
    }
    lap->L = hdi_csr_keep(&s, lap->L);
    return hdi_scope_end(&s);
}

/* Values of row i, and the faces along each of its edges: how many, and in which direction. Both rows of a pair add in the order of the faces, so that L is
 * symmetric to the last bit. place [n_active]: where a column stands in this row. */
static void hdi_poly_row(hd_laplacian *lap, const hdi_poly *poly, int32_t i, int64_t *place, int32_t *count, int32_t *turn) {
    const int32_t v = lap->vertex[i];
    const int64_t begin = lap->L.row_ptr[i], n = lap->L.row_ptr[i + 1] - begin;
    double *L = lap->L.val + begin, sum = 0;
    int64_t p, d;
    for (p = 0; p < n; p++) {
        place[lap->L.col[begin + p]] = p;
        L[p] = 0;
        count[p] = turn[p] = 0;
    }
    for (p = poly->corner_ptr[v]; p < poly->corner_ptr[v + 1]; p++) {
        const int64_t c = poly->corner[p], before = hdi_poly_before(poly, c), after = hdi_poly_after(poly, c);
        const int32_t f = poly->face[c];
        for (d = poly->ptr[f]; d < poly->ptr[f + 1]; d++) {
            const int64_t at = place[lap->row[poly->idx[d]]];
            const int beside = d == before || d == after;
            if (d == c) continue;
            L[at] += hdi_poly_entry(poly, c, d, poly->ptr[f + 1] - poly->ptr[f], beside);
            count[at] += beside;
            turn[at] += (d == after) - (d == before);
        }
    }
    for (p = 0; p < n; p++)
        if (lap->L.col[begin + p] != i) sum += L[p];
    L[place[i]] = -sum;
}

static hd_status hdi_poly_values(hd_laplacian *lap, const hdi_poly *poly, int32_t *parent, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    int64_t *place = HDI_TAKE(&s, int64_t, lap->n_active);
    const int64_t widest = hdi_widest_row(&lap->L);
    int32_t *count = HDI_TAKE(&s, int32_t, widest), *turn = HDI_TAKE(&s, int32_t, widest), i;
    double length = 0;
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) parent[i] = i;
    for (i = 0; i < lap->n_active; i++) {
        hdi_poly_row(lap, poly, i, place, count, turn);
        length += hdi_edge_report(lap, poly->xyz, i, count, turn, parent);
    }
    lap->h = length / HDI_CAST(double, lap->mesh.n_edges);
    hdi_boundary_loops(lap, parent, place);
    return hdi_scope_end(&s);
}

/* Area of each face to its corners in equal parts. */
static double hdi_poly_mass(const hdi_poly *poly, int32_t v) {
    double sum = 0;
    int64_t p;
    for (p = poly->corner_ptr[v]; p < poly->corner_ptr[v + 1]; p++) {
        const int32_t f = poly->face[poly->corner[p]];
        sum += poly->area[f] / HDI_CAST(double, poly->ptr[f + 1] - poly->ptr[f]);
    }
    return sum;
}

/* poly: xyz, ptr, idx, n, m and lambda set, the input checked. */
static hd_status hdi_lap_polygons(hd_laplacian *lap, hdi_poly *poly, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    double *vertex_mass;
    int32_t *mark, v, f;
    if (hdi_poly_make(poly, &lap->mesh, &s) < 0) return hdi_scope_end(&s);
    vertex_mass = HDI_TAKE(&s, double, lap->n);
    if (!vertex_mass) return hdi_scope_end(&s);
    for (v = 0; v < lap->n; v++) vertex_mass[v] = hdi_poly_mass(poly, v);
    if (hdi_lap_rows(lap, vertex_mass, e) < 0 || hdi_progress(lap->context, "assemble", 0.3, e) < 0) return hdi_scope_end(&s);
    if (hdi_lap_places(lap, poly->xyz, e) < 0) return hdi_scope_end(&s);
    mark = HDI_TAKE(&s, int32_t, lap->n_active);
    if (!mark || hdi_poly_pattern(lap, poly, mark, e) < 0) return hdi_scope_end(&s);
    if (hdi_poly_values(lap, poly, mark, e) < 0 || hdi_progress(lap->context, "assemble", 0.8, e) < 0) return hdi_scope_end(&s);
    for (f = 0; f < poly->m; f++) lap->area += poly->area[f];
    lap->b_ratio = 1;
    lap->conserves = 1;
    hdi_lap_components(lap, e);
    return hdi_scope_end(&s);
}

/* ---- intrinsic triangulations: Delaunay and tufted ---- */

/* What the intrinsic Laplacians are asked for. */
typedef struct hdi_intrinsic_task {
    int close;          /* tufted: the boundary is glued to the other sheet */
    double delta;       /* of mollification, relative to the mean edge length; negative: none */
} hdi_intrinsic_task;

/* Rows, components, L and B from intrinsic triangles that are Delaunay, with areas and cotangents but without coordinates. */
static hd_status hdi_lap_flat(hd_laplacian *lap, const hdi_mesh *flat, hdi_scope *s) {
    const int full = lap->kind == HD_LAPLACIAN_FEM;
    hd_error *e = s->e;
    hdi_edges edges;
    double *vertex_mass;
    if (hdi_edges_flat(&edges, flat, full, s) < 0) return e->status;
    vertex_mass = HDI_TAKE(s, double, flat->n);
    if (!vertex_mass) return e->status;
    hdi_mesh_masses(flat, hdi_lap_lump(lap->kind), vertex_mass);
    if (hdi_lap_rows(lap, vertex_mass, e) < 0 || hdi_progress(lap->context, "assemble", 0.5, e) < 0 || hdi_lap_united(lap, edges.parent, e) < 0) return e->status;
    lap->b_ratio = !full ? 1 : lap->mesh.n_self_edges ? 1 - sqrt(1.0 / 3) : 0.5;    /* element of corners v, v, w: 1/2, 1/6; 1/6, 1/6 */
    return hdi_lap_assemble(lap, &edges, e);
}

/* (L, B) of the intrinsic Delaunay triangulation of mesh, or of its cover: each sheet counts half. */
static hd_status hdi_lap_intrinsic(hd_laplacian *lap, const hdi_mesh *mesh, const hdi_intrinsic_task *task, hdi_scope *s) {
    hd_error *e = s->e;
    hd_context *ctx = lap->context;
    hdi_intrinsic t;
    hdi_mesh flat;
    double weight;
    int32_t f;
    if (hdi_intrinsic_make(&t, mesh, task->close, &lap->mesh, s) < 0) return e->status;
    hdi_mollify(&t, task->delta, &lap->mesh);
    if (hdi_progress(ctx, "flip edges", 0, e) < 0 || hdi_flip_all(&t, &lap->mesh, ctx, e) < 0) return e->status;
    weight = 1.0 / t.n_sheets;
    if (hdi_intrinsic_mesh(&flat, &t, lap->n, weight, &lap->mesh, s) < 0) return e->status;
    if (hdi_lap_flat(lap, &flat, s) < 0 || hdi_lap_places(lap, mesh->xyz, e) < 0 || hdi_progress(ctx, "assemble", 0.8, e) < 0) return e->status;
    for (f = 0; f < mesh->m; f++) lap->area += mesh->area[f];
    lap->h = t.unit;
    lap->mesh.n_sheets = t.n_sheets;
    lap->conserves = 1;
    return HD_OK;
}

static hd_status hdi_lap_triangles_intrinsic(hd_laplacian *lap, const double *xyz, const int32_t *tri, int32_t m, const hdi_intrinsic_task *task,
                                             hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    hdi_mesh mesh;
    if (hdi_mesh_make(&mesh, xyz, lap->n, tri, m, &lap->mesh, &s) < 0) return hdi_scope_end(&s);
    if (lap->mesh.n_faces_used == 0) hdi_fail(e, HD_ERR_EMPTY, "no vertex has mass");
    else hdi_lap_intrinsic(lap, &mesh, task, &s);
    return hdi_scope_end(&s);
}

/* The triangles as they are, or with a task their intrinsic Delaunay triangulation. */
static hd_status hdi_lap_faces(hd_laplacian *lap, const double *xyz, const int32_t *tri, int32_t m, const hdi_intrinsic_task *task, hd_error *e) {
    return task ? hdi_lap_triangles_intrinsic(lap, xyz, tri, m, task, e) : hdi_lap_triangles(lap, xyz, tri, m, e);
}

/* The faces split as fans, for the operators of triangles. */
static hd_status hdi_lap_fans(hd_laplacian *lap, const hdi_poly *poly, const hdi_intrinsic_task *task, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    const int64_t m = hdi_poly_fans(poly->ptr, poly->idx, poly->m, NULL);
    int32_t *tri = HDI_TAKE(&s, int32_t, 3 * m);
    if (!tri) return hdi_scope_end(&s);
    hdi_poly_fans(poly->ptr, poly->idx, poly->m, tri);
    if (hdi_lap_faces(lap, poly->xyz, tri, HDI_CAST(int32_t, m), task, e) < 0 && e->face >= 0) e->face = hdi_poly_face_of(poly->ptr, poly->m, e->face);
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
        HDI_PREFETCH_AT(Lx, p + HDI_AHEAD);
        HDI_PREFETCH_AT(Aj, p + HDI_AHEAD);
        if (Bx) {
            HDI_PREFETCH_AT(Bx, p + HDI_AHEAD);
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

/* Merges row v of L and B (both over vertices) on the active columns, the diagonal always there. An explicit
 * zero whose mirror entry neither matrix stores is left out: the pattern becomes symmetric. col NULL: counts
 * only. */
static int64_t hdi_pair_row(const hd_laplacian *lap, const hd_csr *L, const hd_csr *B, int32_t v, int32_t *col, double *Lx, double *Bx) {
    int64_t p = L->row_ptr[v], q = B->row_ptr[v], n = 0;
    const int64_t p_end = L->row_ptr[v + 1], q_end = B->row_ptr[v + 1];
    int diagonal = 0;
    while (p < p_end || q < q_end || !diagonal) {
        const int32_t cp = p < p_end ? L->col[p] : INT32_MAX, cq = q < q_end ? B->col[q] : INT32_MAX, cd = diagonal ? INT32_MAX : v;
        const int32_t c = cp < cq ? (cp < cd ? cp : cd) : (cq < cd ? cq : cd);
        const double l = cp == c ? L->val[p] : 0, b = cq == c ? B->val[q] : 0;
        const int kept = l != 0 || b != 0 || c == v || hdi_csr_stores(L, c, v) || hdi_csr_stores(B, c, v);
        if (lap->row[c] >= 0 && kept) {
            if (col) {
                col[n] = lap->row[c];
                Lx[n] = l;
                Bx[n] = b;
            }
            n++;
        }
        p += cp == c;
        q += cq == c;
        diagonal |= cd == c;
    }
    return n;
}

/* b = B 1, diag(B) and their signs; is B diagonal, how dominant is its diagonal; is L 1 = 0, up to the
 * rounding of its entries. root [n]: sqrt(diag(L)), raised by what the tolerance of the check for symmetry
 * leaves open. */
static hd_status hdi_pair_measure(hd_laplacian *lap, double *root, int *diagonal, hd_error *e) {
    int32_t i;
    int64_t p;
    *diagonal = 1;
    lap->conserves = 1;
    lap->b_ratio = 1;
    for (i = 0; i < lap->n_active; i++) {
        const int32_t v = lap->vertex[i];
        hdi_sum l_sum = {0, 0}, b_off = {0, 0};
        double l_abs = 0, l_diag = 0, b_sum = 0, b_diag = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            hdi_sum_add(&l_sum, lap->L.val[p]);
            l_abs += fabs(lap->L.val[p]);
            b_sum += lap->B[p];
            if (lap->L.col[p] != i) {
                hdi_sum_add(&b_off, fabs(lap->B[p]));
                continue;
            }
            l_diag = lap->L.val[p];
            b_diag = lap->B[p];
        }
        if (!(b_diag > 0)) return hdi_fail_row(e, HD_ERR_NOT_POSITIVE, "B: a diagonal entry is not positive", v, v, b_diag);
        if (l_diag + 1e-12 * l_abs < 0)
            return hdi_fail_row(e, HD_ERR_NOT_POSITIVE, "L has a negative diagonal entry: L is positive semi-definite "
                                "here, minus the cotangent matrix of libigl", v, v, l_diag);
        root[i] = sqrt(l_diag + 1e-12 * l_abs);
        if (fabs(l_sum.high + l_sum.low) > 4 * DBL_EPSILON * l_abs) lap->conserves = 0;
        if (b_off.high > 0) {                    /* Gershgorin */
            *diagonal = 0;
            b_off.high = (b_diag - b_off.high) - b_off.low;
            lap->b_ratio = hdi_min(lap->b_ratio, (1 - 4 * DBL_EPSILON) * b_off.high / b_diag);
        }
        lap->mass[i] = b_sum;
        lap->b_diag[i] = b_diag;
        lap->area += b_sum;
    }
    return HD_OK;
}

/* What every positive semi-definite L satisfies: L_ij^2 <= L_ii L_jj. root as above. */
static hd_status hdi_pair_semidefinite(const hd_laplacian *lap, const double *root, hd_error *e) {
    int32_t i, j;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            j = lap->L.col[p];
            if (j <= i || fabs(lap->L.val[p]) <= (1 + 1e-10) * root[i] * root[j]) continue;
            return hdi_fail_row(e, HD_ERR_NOT_POSITIVE, "L is not positive semi-definite: an entry is larger than the "
                                "diagonal entries of its row and column allow", lap->vertex[i], lap->vertex[j], lap->L.val[p]);
        }
    }
    return HD_OK;
}

/* Where rows of B are not dominated by their diagonal, as in finite elements: the smallest eigenvalue of D^-1 B, D = diag(B), by 40 Lanczos
 * steps. An estimate from above, to be proven: see hdi_lap_ratio. work [4 n]. */
static hd_status hdi_pair_ratio(const hd_laplacian *lap, double *work, double *ratio, hd_error *e) {
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
    if (!(least > 1e-12) && !(lap->b_ratio > 0)) return hdi_fail_row(e, HD_ERR_NOT_POSITIVE, "B is not positive definite", -1, -1, least);
    *ratio = least;
    return HD_OK;
}

static hd_status hdi_lap_matrices(hd_laplacian *lap, const hd_csr *L, const hd_csr *B, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    double *present = HDI_TAKE_ZERO(&s, double, lap->n), *b_diag, *root;
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
    root = HDI_TAKE(&s, double, lap->n_active);
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
    if (hdi_pair_measure(lap, root, &diagonal, e) < 0) return hdi_scope_end(&s);
    if (hdi_pair_semidefinite(lap, root, e) < 0) return hdi_scope_end(&s);
    if (diagonal) {
        hdi_free(lap->context, lap->B);
        hdi_free(lap->context, lap->b_diag);
        lap->B = NULL;
        lap->b_diag = lap->mass;
    }
    hdi_lap_components(lap, e);
    return hdi_scope_end(&s);
}

/* ---- point sets ---- */
/* This work is based on
 *   M. Belkin, P. Niyogi, Towards a theoretical foundation for Laplacian-based manifold methods, 2008 (exponential weights, `exp`)
 *   Y. Liu, B. Prabhakaran, X. Guo, Point-based manifold harmonics, 2012 (the same with Voronoi areas: symmetric L and diagonal B, `voronoi-exp`)
 * Deviations: the exponential is cut where it is small, by distance, so that the pattern is symmetric. Neighbours that stand off the tangent plane by
 * more than 45 degrees count with their height instead of their projection, so that points of another sheet two spacings away do not cut a cell. At a
 * border cells end at the convex hull of the neighbours. The papers leave coincident points, borders and the bandwidth to the reader. */

enum {
    HDI_CELL_SIDES = 12,       /* of the polygon that a cell is cut from */
    HDI_MOST_NEIGHBOURS = 128,
    HDI_CELLS_PER_TASK = 256
};

/* A set of different places, with the k nearest of each (the first is the place itself). */
typedef struct hdi_cloud {
    int32_t n, k;
    const double *xyz;
    const int32_t *first;      /* [n] the point that a place is named by */
    int32_t *nbr;             /* [k n] */
    double *d2;                /* [k n] */
    double *spacing2;          /* [n] area for each point nearby, by the disc to the last neighbour */
    double *area;              /* [n] of the cells */
    int8_t *border;            /* [n] 1: the cell ends where the neighbours do */
    int8_t *not_flat;          /* [n] see hdi_plane */
    double start[HDI_CELL_SIDES][2];   /* a regular polygon around the unit circle */
} hdi_cloud;

/* Eigenvalues w, ascending, and eigenvectors (rows of v) of a symmetric 3 x 3 matrix a, which is overwritten: Jacobi's rotations. */
static void hdi_eigen3(double a[3][3], double w[3], double v[3][3]) {
    int sweep, p, q, i, c;
    for (p = 0; p < 3; p++)
        for (q = 0; q < 3; q++) v[p][q] = p == q;
    for (sweep = 0; sweep < 30; sweep++) {
        const double off = fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]);
        if (off <= DBL_MIN || off <= 1e-17 * (fabs(a[0][0]) + fabs(a[1][1]) + fabs(a[2][2]))) break;
        for (i = 0; i < 3; i++) {
            double theta, t, co, si;
            p = i == 2;
            q = i == 0 ? 1 : 2;
            if (a[p][q] == 0) continue;
            theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
            t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
            co = 1 / sqrt(t * t + 1);
            si = t * co;
            for (c = 0; c < 3; c++) {
                const double x = a[p][c], y = a[q][c];
                a[p][c] = co * x - si * y;
                a[q][c] = si * x + co * y;
            }
            for (c = 0; c < 3; c++) {
                const double x = a[c][p], y = a[c][q], vx = v[p][c], vy = v[q][c];
                a[c][p] = co * x - si * y;
                a[c][q] = si * x + co * y;
                v[p][c] = co * vx - si * vy;
                v[q][c] = si * vx + co * vy;
            }
        }
    }
    for (i = 0; i < 3; i++) w[i] = a[i][i];
    for (p = 0; p < 2; p++) {                    /* three values in order */
        for (q = 0; q < 2 - p; q++) {
            if (w[q] <= w[q + 1]) continue;
            for (c = 0; c < 4; c++) {
                double *x = c < 3 ? &v[q][c] : w + q, *y = c < 3 ? &v[q + 1][c] : w + q + 1, swap = *x;
                *x = *y;
                *y = swap;
            }
        }
    }
}

typedef struct hdi_plane {
    double axis[3][3];   /* two along it, then the normal: orthonormal */
    double height;       /* of the plane above the point, along the normal */
    int8_t not_flat;     /* 1: see hd_point_report */
} hdi_plane;

/* The plane of a point and its n neighbours, rel [3 n] seen from it, by principal components of the point and
 * them, where near ones count much more, as far ones may belong to another sheet. */
static hdi_plane hdi_tangent_plane(const double *rel, int32_t n) {
    const double own = 1.05 * 1.05 * 1.05 * 1.05 * 1.05 * 1.05;
    double sum = own, reach2 = 0, mean[3] = {0, 0, 0}, cov[3][3], w[3], v[3][3];
    hdi_plane plane;
    int32_t k;
    int r, c;
    memset(cov, 0, sizeof cov);
    for (k = 0; k < n; k++) reach2 = hdi_max(reach2, hdi_dot3(rel + 3 * k, rel + 3 * k));
    for (k = 0; k < n; k++) {
        const double *d = rel + 3 * k, near2 = 1.05 - hdi_dot3(d, d) / reach2, weight = near2 * near2 * near2 * near2 * near2 * near2;
        sum += weight;
        for (r = 0; r < 3; r++) {
            mean[r] += weight * d[r];
            for (c = r; c < 3; c++) cov[r][c] += weight * d[r] * d[c];
        }
    }
    for (r = 0; r < 3; r++)
        for (c = r; c < 3; c++) cov[c][r] = cov[r][c] -= mean[r] * mean[c] / sum;
    hdi_eigen3(cov, w, v);
    memcpy(plane.axis, v + 1, 2 * sizeof *v);
    memcpy(plane.axis + 2, v, sizeof *v);
    plane.height = hdi_dot3(v[0], mean) / sum;
    /* squares; two sheets one spacing apart have a ratio of about 0.8. On a line both are only rounding */
    plane.not_flat = w[0] > 0.2 * w[1] && w[0] > 1e-12 * w[2];
    return plane;
}

enum { HDI_POLYGON_MOST = HDI_CELL_SIDES + 2 * HDI_MOST_NEIGHBOURS + 4 };

typedef struct hdi_polygon {
    int32_t n;
    double x[HDI_POLYGON_MOST][2];
} hdi_polygon;

/* Keeps what lies in a x <= b; says whether anything was cut off. A cut adds one corner to a convex polygon:
 * there is room for one by each neighbour and one by each side of their hull. Rounding can leave corners that
 * are not convex, and a line through those may add more: where there is no room for that, nothing is cut off.
 * */
static int hdi_polygon_clip(hdi_polygon *g, double a0, double a1, double b) {
    hdi_polygon cut;
    double last, here;
    int32_t i;
    int any = 0;
    for (i = 0; i < g->n && !any; i++) any = a0 * g->x[i][0] + a1 * g->x[i][1] > b;
    if (!any) return 0;
    cut.n = 0;
    last = a0 * g->x[g->n - 1][0] + a1 * g->x[g->n - 1][1] - b;
    for (i = 0; i < g->n; i++) {
        const double *from = g->x[i ? i - 1 : g->n - 1], *to = g->x[i];
        if (cut.n + 2 > HDI_POLYGON_MOST) return 0;
        here = a0 * to[0] + a1 * to[1] - b;
        if ((last <= 0) != (here <= 0)) {        /* one of both is not zero */
            const double s = last / (last - here);
            cut.x[cut.n][0] = from[0] + s * (to[0] - from[0]);
            cut.x[cut.n++][1] = from[1] + s * (to[1] - from[1]);
        }
        if (here <= 0) {
            cut.x[cut.n][0] = to[0];
            cut.x[cut.n++][1] = to[1];
        }
        last = here;
    }
    g->n = cut.n;
    memcpy(g->x, cut.x, HDI_CAST(size_t, cut.n) * sizeof *g->x);
    return 1;
}

static double hdi_polygon_area(const hdi_polygon *g) {
    double sum = 0;
    int32_t i;
    for (i = 0; i < g->n; i++) {
        const double *a = g->x[i], *b = g->x[i + 1 < g->n ? i + 1 : 0];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return sum / 2;
}

static double hdi_turn(const double *a, const double *b, const double *c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Clips g to the convex hull of the n points x, which are sorted here (Andrew 1979); says whether that cut anything. */
static int hdi_polygon_clip_hull(hdi_polygon *g, double (*x)[2], int32_t n) {
    double hull[2 * HDI_MOST_NEIGHBOURS + 4][2];
    int32_t i, j, m = 0, base = 0;
    int pass, cut = 0;
    for (i = 1; i < n; i++) {
        const double a = x[i][0], b = x[i][1];
        for (j = i; j > 0 && (a < x[j - 1][0] || (a == x[j - 1][0] && b < x[j - 1][1])); j--) memcpy(x[j], x[j - 1], sizeof *x);
        x[j][0] = a;
        x[j][1] = b;
    }
    for (pass = 0; pass < 2; pass++) {           /* the lower half from left to right, the upper one back */
        for (i = 0; i < n; i++) {
            const double *p = x[pass ? n - 1 - i : i];
            while (m >= base + 2 && hdi_turn(hull[m - 2], hull[m - 1], p) <= 0) m--;
            memcpy(hull[m++], p, sizeof *hull);
        }
        base = --m;                              /* the last one begins the other half */
    }
    for (i = 0; i < m && g->n; i++) {
        const double *a = hull[i], *b = hull[i + 1 < m ? i + 1 : 0], e0 = b[0] - a[0], e1 = b[1] - a[1];
        cut |= hdi_polygon_clip(g, e1, -e0, e1 * a[0] - e0 * a[1]);
    }
    return cut;
}

/* The middle one of the spacings around place i: an outlier has those of the surface. */
static double hdi_cell_spacing2(const hdi_cloud *cloud, int32_t i) {
    double s[HDI_MOST_NEIGHBOURS + 1];
    const int32_t *nbr = cloud->nbr + HDI_CAST(int64_t, i) * cloud->k;
    int32_t j, k;
    for (k = 0; k < cloud->k; k++) {
        const double x = cloud->spacing2[nbr[k]];
        for (j = k; j > 0 && x < s[j - 1]; j--) s[j] = s[j - 1];
        s[j] = x;
    }
    return s[cloud->k / 2];
}

/* Area of the cell of place i in its tangent plane; 0 where neighbours lie on a line. Lengths are in units of the distance of the last neighbour. */
static void hdi_cell_area(hdi_cloud *cloud, int32_t i) {
    const int64_t at = HDI_CAST(int64_t, i) * cloud->k;
    const double reach = sqrt(cloud->d2[at + cloud->k - 1]), unit = 1 / reach, *p = cloud->xyz + 3 * HDI_CAST(int64_t, i);
    double x[HDI_MOST_NEIGHBOURS + 1][2], rel[3 * (HDI_MOST_NEIGHBOURS + 1)], radius, outer2, area;
    hdi_plane plane;
    hdi_polygon g;
    int32_t k, v;
    for (k = 0; k < cloud->k; k++) {
        hdi_sub3(cloud->xyz + 3 * HDI_CAST(int64_t, cloud->nbr[at + k]), p, rel + 3 * k);
        for (v = 0; v < 3; v++) rel[3 * k + v] *= unit;
    }
    plane = hdi_tangent_plane(rel + 3, cloud->k - 1);   /* the first one is the place itself */
    radius = 2 * sqrt(hdi_cell_spacing2(cloud, i)) * unit;   /* random points leave a circle so large empty once in 3e5 times */
    g.n = HDI_CELL_SIDES;
    for (v = 0; v < g.n; v++) {
        g.x[v][0] = radius * cloud->start[v][0];
        g.x[v][1] = radius * cloud->start[v][1];
    }
    outer2 = 1.2 * radius * radius;
    for (k = 0; k < cloud->k; k++) {
        const double l2 = cloud->d2[at + k] * unit * unit;   /* and q2 the square in the plane */
        double q2;
        x[k][0] = hdi_dot3(plane.axis[0], rel + 3 * k);
        x[k][1] = hdi_dot3(plane.axis[1], rel + 3 * k);
        q2 = x[k][0] * x[k][0] + x[k][1] * x[k][1];
        if (k == 0 || l2 > 8 * outer2) continue;   /* max(q2, l2 - q2) is at least l2/2: the bisector is beyond all corners */
        if (!hdi_polygon_clip(&g, x[k][0], x[k][1], hdi_max(q2, l2 - q2) / 2)) continue;
        for (v = 0, outer2 = 0; v < g.n; v++) outer2 = hdi_max(outer2, g.x[v][0] * g.x[v][0] + g.x[v][1] * g.x[v][1]);
    }
    cloud->not_flat[i] = plane.not_flat;
    cloud->border[i] = HDI_CAST(int8_t, hdi_polygon_clip_hull(&g, x, cloud->k) || outer2 >= radius * radius);
    area = hdi_polygon_area(&g);
    cloud->area[i] = area > 1e-12 * radius * radius ? area * reach * reach : 0;
}

static void hdi_cell_task(void *arg, int64_t index, int32_t worker) {
    hdi_cloud *cloud = HDI_CAST(hdi_cloud *, arg);
    const int64_t end = hdi_least(cloud->n, (index + 1) * HDI_CELLS_PER_TASK);
    int64_t i;
    (void)worker;
    for (i = index * HDI_CELLS_PER_TASK; i < end; i++) hdi_cell_area(cloud, HDI_CAST(int32_t, i));
}

/* The number-k smallest of a, which is rearranged. */
static double hdi_kth(double *a, int64_t n, int64_t k) {
    int64_t lo = 0, hi = n - 1;
    while (lo < hi) {
        const double pivot = hdi_max(hdi_min(a[lo], a[hi]), hdi_min(hdi_max(a[lo], a[hi]), a[lo + (hi - lo) / 2]));
        int64_t i = lo, j = hi;
        while (i <= j) {
            while (a[i] < pivot) i++;
            while (a[j] > pivot) j--;
            if (i <= j) {
                const double swap = a[i];
                a[i++] = a[j];
                a[j--] = swap;
            }
        }
        if (k <= j) hi = j;
        else if (k >= i) lo = i;
        else break;
    }
    return a[k];
}

static uint64_t hdi_place_hash(const double *p) {
    uint64_t h = 0, bits;
    int c;
    for (c = 0; c < 3; c++) {
        const double x = p[c] + 0.0;             /* -0 is 0 */
        memcpy(&bits, &x, sizeof bits);
        h = (h ^ bits) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return h;
}

/* place[v]: number of the place where point v is, places numbered by their first point, first[q]: that point. Returns how many. */
static int32_t hdi_places(const double *xyz, int32_t n, int32_t *place, int32_t *first, hdi_scope *s) {
    const int64_t slots = 2 * HDI_CAST(int64_t, n) + 1;
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    int32_t *table = HDI_TAKE(&own, int32_t, slots), v, count = 0;
    if (!table) {
        hdi_scope_end(&own);
        return 0;
    }
    hdi_fill_i32(table, slots, -1);
    for (v = 0; v < n; v++) {
        const double *p = xyz + 3 * HDI_CAST(int64_t, v);
        int64_t at = HDI_CAST(int64_t, hdi_place_hash(p) % HDI_CAST(uint64_t, slots));
        for (; table[at] >= 0; at = at + 1 < slots ? at + 1 : 0) {
            const double *q = xyz + 3 * HDI_CAST(int64_t, first[table[at]]);
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) break;
        }
        if (table[at] < 0) {
            first[count] = v;
            table[at] = count++;
        }
        place[v] = table[at];
    }
    hdi_scope_end(&own);
    return count;
}

/* Neighbours, spacings, h and cells of the places. */
static hd_status hdi_cloud_measure(hdi_cloud *cloud, hd_laplacian *lap, hdi_scope *s) {
    hdi_tree tree;
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    double sum = 0;
    int32_t i;
    const int64_t n = cloud->n, k = cloud->k;
    cloud->spacing2 = HDI_TAKE(s, double, n);
    cloud->area = HDI_TAKE(s, double, n);
    cloud->border = HDI_TAKE(s, int8_t, n);
    cloud->not_flat = HDI_TAKE(s, int8_t, n);
    cloud->nbr = HDI_TAKE(s, int32_t, k * n);
    cloud->d2 = HDI_TAKE(s, double, k * n);
    if (s->e->status < 0 || hdi_tree_make(&tree, cloud->xyz, cloud->n, &own) < 0) return hdi_scope_end(&own);
    if (hdi_nearest(&tree, cloud->xyz, NULL, n, cloud->k, cloud->nbr, cloud->d2, s->ctx, s->e) < 0) return hdi_scope_end(&own);
    for (i = 0; i < n; i++) {
        const double *d2 = cloud->d2 + i * k;
        if (!(d2[1] > DBL_MIN / DBL_EPSILON)) {
            hdi_fail_face(s->e, HD_ERR_ARGUMENT, "two points are too close together: the square of their distance is no normal number", -1, cloud->first[i], d2[1]);
            return hdi_scope_end(&own);
        }
        sum += sqrt(d2[1]);
        cloud->spacing2[i] = 3.141592653589793 * d2[k - 1] / HDI_CAST(double, k - 1);
    }
    lap->h = sum / HDI_CAST(double, n);
    for (i = 0; i < HDI_CELL_SIDES; i++) {
        const double step = 6.283185307179586 / HDI_CAST(double, HDI_CELL_SIDES), r = 1 / cos(step / 2);
        cloud->start[i][0] = r * cos(step * i);
        cloud->start[i][1] = r * sin(step * i);
    }
    if (hdi_progress(s->ctx, "assemble", 0.2, s->e) >= 0) hdi_parallel(s->ctx, (n + HDI_CELLS_PER_TASK - 1) / HDI_CELLS_PER_TASK, hdi_cell_task, cloud);
    return hdi_scope_end(&own);
}

/* Bandwidth from the sampling: a multiple of m, the area that a point has, which is the mean of pi r_k^2 / k over the points, r_k the distance of the
 * k-th neighbour, and of h, the mean distance of the nearest one; no square counts more than nine medians of the former, so that outliers do not
 * matter. The multiple is that which balances the two errors on spheres and tori: smoothing takes lambda s/2 off an eigenvalue lambda, sampling about
 * 0.02 (m/s)^2 of all of them with points independent of each other, where m/h^2 is 4, and 0.0015 (m/s)^2 with blue noise, where it is 1.4. Hence
 * s = m (m/h^2)/4, between 0.3 and 1 m. */
static double hdi_cloud_bandwidth(const hdi_cloud *cloud, double *work) {
    double median, mean = 0, h = 0;
    int32_t i;
    memcpy(work, cloud->spacing2, HDI_CAST(size_t, cloud->n) * sizeof *work);
    median = hdi_kth(work, cloud->n, cloud->n / 2);
    for (i = 0; i < cloud->n; i++) {
        mean += hdi_min(cloud->spacing2[i], 9 * median);
        h += sqrt(hdi_min(cloud->d2[HDI_CAST(int64_t, i) * cloud->k + 1], 9 * median));
    }
    mean /= cloud->n;
    h /= cloud->n;
    return hdi_max(0.3, hdi_min(1, 0.25 * mean / (h * h))) * mean;
}

typedef struct hdi_weights {
    hd_laplacian *lap;
    double bandwidth, scale;   /* exp: of all weights */
} hdi_weights;

/* Squared distances of some rows become entries of L. Products commute, so that L is symmetric to the last bit. */
static void hdi_weights_task(void *arg, int64_t index, int32_t worker) {
    const hdi_weights *job = HDI_CAST(const hdi_weights *, arg);
    hd_laplacian *lap = job->lap;
    const int32_t begin = HDI_CAST(int32_t, index * HDI_CELLS_PER_TASK);
    const int32_t end = HDI_CAST(int32_t, hdi_least(lap->n_active, (index + 1) * HDI_CELLS_PER_TASK));
    const double quarter = -0.25 / job->bandwidth;
    const int voronoi = lap->kind == HD_LAPLACIAN_VORONOI_EXP;
    int32_t i;
    (void)worker;
    for (i = begin; i < end; i++) {
        double sum = 0, *diagonal = NULL;
        int64_t p;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int32_t j = lap->L.col[p];
            double *value = lap->L.val + p;
            if (j == i) {
                diagonal = value;
                continue;
            }
            *value = -exp(*value * quarter) * (voronoi ? (lap->mass[i] / job->bandwidth) * (lap->mass[j] / job->bandwidth) * 0.07957747154594767 : job->scale);
            sum += *value;
        }
        *diagonal = -sum;
    }
}

/* The pattern by a radius search over the rows, then the values in its place. */
static hd_status hdi_cloud_assemble(hd_laplacian *lap, double cut2, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    hd_point_report *rep = &lap->points;
    hdi_weights job;
    hdi_tree tree;
    int32_t i;
    if (hdi_tree_make(&tree, lap->xyz, lap->n_active, &s) < 0) return hdi_scope_end(&s);
    if (hdi_within(&lap->L, &tree, lap->xyz, NULL, lap->n_active, cut2, lap->context, e) < 0) return hdi_scope_end(&s);
    if (hdi_progress(lap->context, "assemble", 0.7, e) < 0) return hdi_scope_end(&s);
    job.lap = lap;
    job.bandwidth = rep->bandwidth;
    job.scale = 0.07957747154594767 / job.bandwidth / job.bandwidth / lap->n_active;
    hdi_parallel(lap->context, (HDI_CAST(int64_t, lap->n_active) + HDI_CELLS_PER_TASK - 1) / HDI_CELLS_PER_TASK, hdi_weights_task, &job);
    for (i = 0; i < lap->n_active; i++) {
        const int64_t count = lap->L.row_ptr[i + 1] - lap->L.row_ptr[i];
        rep->n_isolated += count == 1;
        if (!hdi_finite(lap->L.val[lap->L.row_ptr[i]])) {
            hdi_fail_face(e, HD_ERR_NOT_FINITE, "points: a weight is not finite; the bandwidth is too small for these lengths", -1, lap->vertex[i], rep->bandwidth);
            break;
        }
        rep->most_in_row = count > rep->most_in_row ? HDI_CAST(int32_t, count) : rep->most_in_row;
    }
    return hdi_scope_end(&s);
}

/* Masses of the points: equal shares of their place's cell, or 1; and what there is to report about them. */
static void hdi_cloud_masses(const hdi_cloud *cloud, hd_laplacian *lap, const int32_t *place, int32_t *copies, double *mass) {
    hd_point_report *rep = &lap->points;
    int32_t i;
    for (i = 0; i < cloud->n; i++) copies[i] = 0;
    for (i = 0; i < lap->n; i++) copies[place[i]]++;
    for (i = 0; i < lap->n; i++) mass[i] = lap->kind == HD_LAPLACIAN_EXP ? 1 : cloud->area[place[i]] / copies[place[i]];
    for (i = 0; i < cloud->n; i++) {
        lap->area += cloud->area[i];
        rep->n_border += cloud->border[i];
        rep->n_not_flat += cloud->not_flat[i];
        rep->n_no_area += cloud->area[i] > 0 ? 0 : copies[i];
    }
    rep->n_coincident = lap->n - cloud->n;
}

static hd_status hdi_lap_points(hd_laplacian *lap, const double *xyz, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    hd_point_report *rep = &lap->points;
    int32_t *place = HDI_TAKE(&s, int32_t, lap->n), *first = HDI_TAKE(&s, int32_t, lap->n), v;
    double *work = HDI_TAKE(&s, double, lap->n), *places;
    hdi_cloud cloud;
    memset(&cloud, 0, sizeof cloud);
    if (e->status < 0 || hdi_points_check(xyz, lap->n, NULL, 0, e) < 0) return hdi_scope_end(&s);
    cloud.n = hdi_places(xyz, lap->n, place, first, &s);
    if (e->status >= 0 && cloud.n < 2) hdi_fail(e, HD_ERR_EMPTY, "points: fewer than two different ones");
    places = HDI_TAKE(&s, double, 3 * HDI_CAST(int64_t, cloud.n));
    if (e->status < 0) return hdi_scope_end(&s);
    for (v = 0; v < cloud.n; v++) memcpy(places + 3 * HDI_CAST(int64_t, v), xyz + 3 * HDI_CAST(int64_t, first[v]), 3 * sizeof *places);
    cloud.xyz = places;
    cloud.first = first;
    cloud.k = HDI_CAST(int32_t, hdi_least(cloud.n, 1 + HDI_CAST(int64_t, rep->neighbours)));
    if (hdi_cloud_measure(&cloud, lap, &s) < 0) return hdi_scope_end(&s);
    if (rep->bandwidth == 0) rep->bandwidth = hdi_cloud_bandwidth(&cloud, work);
    rep->cut_radius = sqrt(-4 * log(rep->weight_cut) * rep->bandwidth);
    hdi_cloud_masses(&cloud, lap, place, first, work);
    if (hdi_lap_rows(lap, work, e) < 0 || hdi_progress(lap->context, "assemble", 0.4, e) < 0) return hdi_scope_end(&s);
    if (hdi_lap_places(lap, xyz, e) < 0) return hdi_scope_end(&s);
    if (hdi_cloud_assemble(lap, -4 * log(rep->weight_cut) * rep->bandwidth, e) < 0) return hdi_scope_end(&s);
    lap->b_ratio = 1;
    lap->conserves = 1;
    hdi_lap_components(lap, e);
    return hdi_scope_end(&s);
}

/* ---- point sets: the tufted Laplacian of the points' stars ---- */

enum { HDI_STAR_MOST = 256, HDI_STAR_POINTS = 1024 };   /* neighbours of a point that its star can be made of; points per task */

/* A number in [0, 1) for each point: which of four cocircular points are joined must be the same in the stars of all four, on a grid for instance. */
static double hdi_point_chance(int32_t i) {
    uint64_t x = (HDI_CAST(uint64_t, i) + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    return HDI_CAST(double, x >> 11) / 9007199254740992.0;
}

typedef struct hdi_star_point { double x, y, angle; int32_t id; } hdi_star_point;

/* An angle that needs no arc tangent: 0 along x, 1 along y, a turn is 4, half a turn 2 between any two opposite directions. */
static double hdi_star_angle(double x, double y) {
    const double sum = fabs(x) + fabs(y), q = sum > 0 ? y / sum : 0;
    return x < 0 ? 2 - q : y < 0 ? 4 + q : q;
}

/* c is to the left of the line from a to b. */
static int hdi_star_left(const hdi_star_point *a, const hdi_star_point *b, const hdi_star_point *c) {
    return hdi_det2(b->x - a->x, c->y - b->y, b->y - a->y, c->x - b->x) > 0;
}

#define HDI_STAR_SAME 1e-6   /* directions within this hdi_star_angle are the same one; opposite ones likewise */

/* p, n by angle: of those in the same direction only the nearest, which has the longest dual, stays. Returns how many are left. */
static int32_t hdi_star_directions(hdi_star_point *p, int32_t n) {
    const double turn = 4;
    int32_t i, m = 0;
    for (i = 0; i < n; i++) {
        const hdi_star_point x = p[i];
        if (m > 0 && x.angle - p[m - 1].angle < HDI_STAR_SAME) {
            if (x.x * x.x + x.y * x.y > p[m - 1].x * p[m - 1].x + p[m - 1].y * p[m - 1].y) p[m - 1] = x;
        } else {
            p[m++] = x;
        }
    }
    if (m > 1 && p[0].angle + turn - p[m - 1].angle < HDI_STAR_SAME) {       /* the last is in the direction of the first */
        if (p[m - 1].x * p[m - 1].x + p[m - 1].y * p[m - 1].y > p[0].x * p[0].x + p[0].y * p[0].y) {
            p[0] = p[m - 1];
            p[0].angle -= turn;
        }
        m--;
    }
    return m;
}

/* Sorts p by angle, equal ones as they come: the angle's bits, whose last eight make room for the place. */
static void hdi_star_sort(hdi_star_point *p, int32_t n) {
    hdi_star_point from[HDI_STAR_MOST];
    uint64_t key[HDI_STAR_MOST], work[HDI_STAR_MOST];
    int32_t i;
    for (i = 0; i < n; i++) {
        p[i].angle = hdi_star_angle(p[i].x, p[i].y) + 0.0;       /* no -0 */
        memcpy(key + i, &p[i].angle, sizeof *key);
        key[i] = (key[i] & ~HDI_CAST(uint64_t, 255)) | HDI_CAST(uint64_t, i);
        from[i] = p[i];
    }
    hdi_sort_keys(key, n, work);
    for (i = 0; i < n; i++) p[i] = from[key[i] & 255];
}

/* The star of the origin in the Delaunay triangulation of it and p[0..n), which are duals: the neighbour q stands at 2 q / |q|^2, so that the line
 * between the nearer and the farther half plane is its polar. The neighbours that bound the Voronoi cell are then the corners of the convex hull, found
 * by walking around it (Graham 1972). Where neighbours are a half turn apart the cell is open. Leaves them in p by angle; returns their number. */
static int32_t hdi_star_hull(hdi_star_point *p, int32_t n, int *closed) {
    const double half = 2, open_gap = half - HDI_STAR_SAME;
    hdi_star_point hull[HDI_STAR_MOST + 2], origin;
    int32_t i, at, first = 0, top = 0;
    double far_away = -1;
    hdi_star_sort(p, n);
    n = hdi_star_directions(p, n);
    *closed = 1;
    for (i = 0; i < n; i++) {                    /* begin behind a gap of a half turn, else at the nearest neighbour, which is a corner */
        const double r = p[i].x * p[i].x + p[i].y * p[i].y, gap = i ? p[i].angle - p[i - 1].angle : p[0].angle - p[n - 1].angle + 2 * half;
        if (gap >= open_gap) *closed = 0;
        if (gap >= open_gap || (*closed && r > far_away)) first = i;
        far_away = hdi_max(far_away, r);
    }
    memset(&origin, 0, sizeof origin);
    if (!*closed) hull[top++] = origin;
    for (i = 0, at = first; i < n; i++, at = at + 1 < n ? at + 1 : 0) {
        while (top > 1 && !hdi_star_left(hull + top - 2, hull + top - 1, p + at)) top--;
        hull[top++] = p[at];
    }
    {                                            /* once around: from the nearest to itself, or from the origin, a corner now, to itself */
        const hdi_star_point last = *closed ? p[first] : origin;
        while (top > 1 && !hdi_star_left(hull + top - 2, hull + top - 1, &last)) top--;
    }
    top -= !*closed;
    for (i = 0; i < top; i++) p[i] = hull[i + !*closed];
    return top;
}

typedef struct hdi_star_job {
    const double *xyz;
    const int32_t *name;/* [n] the caller's number of a point */
    int32_t n;
    const int64_t *ptr;
    int32_t *nbr;       /* [ptr[n]] neighbours of point i from ptr[i] on; then its star, counterclockwise in its plane */
    double *nearest;    /* [n] distance to the nearest neighbour in another place; 0: none */
    int32_t *size;      /* [n] corners of the star; negative: it is open between the last and the first */
    int8_t *not_flat;   /* [n] see hdi_plane */
} hdi_star_job;

static void hdi_star_unit_task(void *arg, int64_t index, int32_t worker) {
    const hdi_star_job *job = HDI_CAST(const hdi_star_job *, arg);
    const int64_t end = hdi_least((index + 1) * HDI_STAR_POINTS, job->n);
    int64_t i, p;
    (void)worker;
    for (i = index * HDI_STAR_POINTS; i < end; i++) {
        double least = 0, d[3];
        for (p = job->ptr[i]; p < job->ptr[i + 1]; p++) {
            double r;
            hdi_sub3(job->xyz + 3 * HDI_CAST(int64_t, job->nbr[p]), job->xyz + 3 * i, d);
            r = hdi_norm3(d);
            if (r > 0 && (least == 0 || r < least)) least = r;
        }
        job->nearest[i] = least;
    }
}

/* The star of point i. Lengths are in units of its nearest neighbour's distance. */
static void hdi_point_star(const hdi_star_job *job, int32_t i) {
    const double unit = job->nearest[i];
    double rel[3 * HDI_STAR_MOST];
    hdi_plane plane;
    hdi_star_point p[HDI_STAR_MOST];
    int32_t n = 0, m = 0, k, id[HDI_STAR_MOST];
    int closed;
    int64_t q;
    job->size[i] = 0;
    job->not_flat[i] = 0;
    for (q = job->ptr[i]; q < job->ptr[i + 1] && unit > 0; q++) {
        double *d = rel + 3 * n;
        hdi_sub3(job->xyz + 3 * HDI_CAST(int64_t, job->nbr[q]), job->xyz + 3 * HDI_CAST(int64_t, i), d);
        for (k = 0; k < 3; k++) d[k] /= unit;
        id[n] = job->nbr[q];
        n += hdi_dot3(d, d) > 0;                 /* the point itself and others in its place do not count */
    }
    if (n < 2) return;
    plane = hdi_tangent_plane(rel, n);
    job->not_flat[i] = plane.not_flat;
    for (k = 0; k < n; k++) {
        const double *d = rel + 3 * k, h = hdi_dot3(plane.axis[2], d), w = job->nearest[id[k]] / unit;
        const double x = hdi_dot3(plane.axis[0], d), y = hdi_dot3(plane.axis[1], d), r2 = x * x + y * y;
        double power = hdi_max(r2 + 2 * h * (h - 2 * plane.height) / 3, r2 / 4);
        if (!(r2 > 1e-12 * hdi_dot3(d, d))) continue;      /* straight above */
        power += 1e-9 * hdi_min(1, r2) * hdi_point_chance(job->name[i]);
        power -= 1e-9 * hdi_min(w * w, r2) * hdi_point_chance(job->name[id[k]]);
        p[m].x = 2 * x / power;
        p[m].y = 2 * y / power;
        p[m++].id = id[k];
    }
    if (m < 2) return;
    m = hdi_star_hull(p, m, &closed);
    for (k = 0; k < m; k++) job->nbr[job->ptr[i] + k] = p[k].id;
    job->size[i] = closed ? m : -m;
}

static void hdi_star_task(void *arg, int64_t index, int32_t worker) {
    const hdi_star_job *job = HDI_CAST(const hdi_star_job *, arg);
    const int64_t end = hdi_least((index + 1) * HDI_STAR_POINTS, job->n);
    int64_t i;
    (void)worker;
    for (i = index * HDI_STAR_POINTS; i < end; i++) hdi_point_star(job, HDI_CAST(int32_t, i));
}

static hd_status hdi_star_check(const int64_t *ptr, const int32_t *nbr, int32_t n, hd_error *e) {
    int32_t i;
    int64_t p;
    if (ptr[0] != 0) return hdi_fail_row(e, HD_ERR_STRUCTURE, "neighbours: offsets do not begin with 0", 0, -1, HDI_CAST(double, ptr[0]));
    for (i = 0; i < n; i++) {
        if (ptr[i + 1] < ptr[i]) return hdi_fail_row(e, HD_ERR_STRUCTURE, "neighbours: offsets descend", i, -1, HDI_CAST(double, ptr[i + 1]));
        if (ptr[i + 1] - ptr[i] > HDI_STAR_MOST)
            return hdi_fail_row(e, HD_ERR_TOO_LARGE, "neighbours: a point has more than 256", i, -1, HDI_CAST(double, ptr[i + 1] - ptr[i]));
        for (p = ptr[i]; p < ptr[i + 1]; p++)
            if (nbr[p] < 0 || nbr[p] >= n) return hdi_fail_row(e, HD_ERR_INDEX, "neighbours: an id is out of range", i, -1, nbr[p]);
    }
    return HD_OK;
}

/* From here on points are numbered in the order of the tree's leaves, whatever their order was: neighbours are near in memory too. points [3 n] in the order of
 * id; the tree's own ids become these numbers. NULL: no memory. */
static double *hdi_star_order(hdi_tree *tree, const double *xyz, hdi_scope *s) {
    double *points = HDI_TAKE(s, double, 3 * HDI_CAST(int64_t, tree->n));
    int32_t i;
    for (i = 0; i < tree->n && points; i++) memcpy(points + 3 * HDI_CAST(int64_t, i), xyz + 3 * HDI_CAST(int64_t, tree->id[i]), 3 * sizeof *points);
    return points;
}

/* Neighbours for points that come without: the nearest other places. Of several points in one place only the first takes part. xyz and name live in keep. */
static hd_status hdi_star_search(hdi_star_job *job, const double *xyz, int32_t n_points, hd_point_report *rep, hdi_scope *s, hdi_scope *keep) {
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    int32_t *place = HDI_TAKE(&own, int32_t, n_points), *first = HDI_TAKE(&own, int32_t, n_points), *name, *nbr, n, k, v;
    int64_t *ptr;
    double *places;
    hdi_tree tree;
    if (s->e->status < 0 || hdi_points_check(xyz, n_points, NULL, 0, s->e) < 0) return hdi_scope_end(&own);
    n = hdi_places(xyz, n_points, place, first, &own);
    k = HDI_CAST(int32_t, hdi_least(n, 1 + HDI_CAST(int64_t, rep->neighbours)));
    rep->n_coincident = n_points - n;
    places = HDI_TAKE(&own, double, 3 * HDI_CAST(int64_t, n));
    ptr = HDI_TAKE(s, int64_t, HDI_CAST(int64_t, n) + 1);
    nbr = HDI_TAKE(s, int32_t, HDI_CAST(int64_t, k) * n);
    name = HDI_TAKE(keep, int32_t, n);
    if (s->e->status < 0) return hdi_scope_end(&own);
    for (v = 0; v < n; v++) memcpy(places + 3 * HDI_CAST(int64_t, v), xyz + 3 * HDI_CAST(int64_t, first[v]), 3 * sizeof *places);
    if (hdi_tree_make(&tree, places, n, &own) < 0) return hdi_scope_end(&own);
    job->xyz = hdi_star_order(&tree, places, keep);
    if (!job->xyz) return hdi_scope_end(&own);
    for (v = 0; v < n; v++) {
        name[v] = first[tree.id[v]];
        tree.id[v] = v;
        ptr[v] = HDI_CAST(int64_t, v) * k;
    }
    ptr[n] = HDI_CAST(int64_t, n) * k;
    job->n = n;
    job->name = name;
    job->ptr = ptr;
    job->nbr = nbr;
    (void)hdi_nearest(&tree, job->xyz, NULL, n, k, nbr, NULL, s->ctx, s->e);
    return hdi_scope_end(&own);
}

/* The caller's neighbours, points and lists renumbered. */
static hd_status hdi_star_given(hdi_star_job *job, const double *xyz, int32_t n, const int64_t *nbr_ptr, const int32_t *nbr, hdi_scope *s, hdi_scope *keep) {
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    int32_t *inverse = HDI_TAKE(&own, int32_t, n), *name = HDI_TAKE(keep, int32_t, n), *list, v;
    int64_t *ptr = HDI_TAKE(s, int64_t, HDI_CAST(int64_t, n) + 1), p, q;
    hdi_tree tree;
    if (s->e->status < 0 || hdi_mesh_check(xyz, n, NULL, 0, s->e) < 0 || hdi_star_check(nbr_ptr, nbr, n, s->e) < 0) return hdi_scope_end(&own);
    list = HDI_TAKE(s, int32_t, nbr_ptr[n]);
    if (s->e->status < 0 || hdi_tree_make(&tree, xyz, n, &own) < 0) return hdi_scope_end(&own);
    job->xyz = hdi_star_order(&tree, xyz, keep);
    if (!job->xyz) return hdi_scope_end(&own);
    for (v = 0; v < n; v++) {
        name[v] = tree.id[v];
        inverse[name[v]] = v;
    }
    for (v = 0, q = 0; v < n; v++) {
        ptr[v] = q;
        for (p = nbr_ptr[name[v]]; p < nbr_ptr[name[v] + 1]; p++) list[q++] = inverse[nbr[p]];
    }
    ptr[n] = q;
    job->n = n;
    job->name = name;
    job->ptr = ptr;
    job->nbr = list;
    return hdi_scope_end(&own);
}

/* All triangles of all stars, a third each in the end: tri in s, counted in *m. Fills lap->h, the mean
 * distance to the nearest, and lap->points.n_not_flat. */
static int32_t *hdi_stars(hdi_star_job *job, int32_t *m, hd_laplacian *lap, hdi_scope *s) {
    const int64_t n_tasks = (HDI_CAST(int64_t, job->n) + HDI_STAR_POINTS - 1) / HDI_STAR_POINTS;
    int32_t *tri, i, k, n_near = 0;
    int64_t count = 0;
    job->nearest = HDI_TAKE(s, double, job->n);
    job->size = HDI_TAKE(s, int32_t, job->n);
    job->not_flat = HDI_TAKE(s, int8_t, job->n);
    if (s->e->status < 0) return NULL;
    hdi_parallel(s->ctx, n_tasks, hdi_star_unit_task, job);
    hdi_parallel(s->ctx, n_tasks, hdi_star_task, job);
    for (i = 0; i < job->n; i++) {
        count += job->size[i] < 0 ? -job->size[i] - 1 : job->size[i];
        n_near += job->nearest[i] > 0;
        lap->h += job->nearest[i];
        lap->points.n_not_flat += job->not_flat[i];
    }
    lap->h /= n_near > 0 ? n_near : 1;
    if (3 * count > INT32_MAX) hdi_fail(s->e, HD_ERR_TOO_LARGE, "more than 2^31 corners of triangles in the points' stars");
    tri = HDI_TAKE(s, int32_t, 3 * count);
    if (!tri) return NULL;
    *m = HDI_CAST(int32_t, count);
    count = 0;
    for (i = 0; i < job->n; i++) {
        const int32_t *star = job->nbr + job->ptr[i], size = job->size[i] < 0 ? -job->size[i] : job->size[i], last = size - (job->size[i] < 0);
        for (k = 0; k < last; k++) {
            tri[count++] = i;
            tri[count++] = star[k];
            tri[count++] = star[k + 1 < size ? k + 1 : 0];
        }
    }
    return tri;
}

typedef struct hdi_renumber_job {
    hd_laplacian *lap;
    const hd_laplacian *from;
    const int32_t *to;  /* [rows] */
} hdi_renumber_job;

/* Row r of the pair, its entries in key and work (each as long as the row), into its new place. */
static void hdi_renumber_row(const hdi_renumber_job *job, int32_t r, uint64_t *key, uint64_t *work) {
    const hd_laplacian *from = job->from;
    hd_laplacian *lap = job->lap;
    const int64_t begin = from->L.row_ptr[r], n = from->L.row_ptr[r + 1] - begin, at = lap->L.row_ptr[job->to[r]];
    int64_t p;
    for (p = 0; p < n; p++) key[p] = HDI_CAST(uint64_t, job->to[from->L.col[begin + p]]) << 32 | HDI_CAST(uint64_t, p);
    hdi_sort_keys(key, n, work);
    for (p = 0; p < n; p++) {
        const int64_t q = begin + HDI_CAST(int64_t, key[p] & 0xffffffffu);
        lap->L.col[at + p] = hdi_key_vertex(key[p]);
        lap->L.val[at + p] = from->L.val[q];
        if (lap->B) lap->B[at + p] = from->B[q];
    }
}

enum { HDI_RENUMBER_ROWS = 4096, HDI_RENUMBER_WIDTH = 64 };

static void hdi_renumber_task(void *arg, int64_t index, int32_t worker) {
    const hdi_renumber_job *job = HDI_CAST(const hdi_renumber_job *, arg);
    const int64_t *ptr = job->from->L.row_ptr, end = hdi_least((index + 1) * HDI_RENUMBER_ROWS, job->from->n_active);
    uint64_t key[HDI_RENUMBER_WIDTH], work[HDI_RENUMBER_WIDTH];
    int64_t r;
    (void)worker;
    for (r = index * HDI_RENUMBER_ROWS; r < end; r++)
        if (ptr[r + 1] - ptr[r] <= HDI_RENUMBER_WIDTH) hdi_renumber_row(job, HDI_CAST(int32_t, r), key, work);
}

/* Rows, components and matrices of the pair from, whose vertex v is name[v] of lap, in the order of lap's vertices. */
static hd_status hdi_lap_renumber(hd_laplacian *lap, const hd_laplacian *from, const int32_t *name, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    const int32_t rows = from->n_active;
    const int64_t widest = hdi_widest_row(&from->L);
    int32_t *to = HDI_TAKE(&s, int32_t, rows), *number = HDI_TAKE(&s, int32_t, from->n_components), *component = HDI_TAKE(&s, int32_t, rows), r, i;
    double *mass = HDI_TAKE_ZERO(&s, double, lap->n), *component_mass = HDI_TAKE(&s, double, from->n_components), *B = NULL, *b_diag = NULL;
    uint64_t *key = HDI_TAKE(&s, uint64_t, 2 * widest);
    hdi_renumber_job job;
    hd_csr L = hdi_csr_take(&s, rows, rows, from->L.nnz, 1);
    if (from->B) B = HDI_TAKE(&s, double, from->L.nnz);
    if (from->B) b_diag = HDI_TAKE(&s, double, rows);
    if (e->status < 0) return hdi_scope_end(&s);
    for (r = 0; r < rows; r++) mass[name[from->vertex[r]]] = from->mass[r];
    if (hdi_lap_rows(lap, mass, e) < 0) return hdi_scope_end(&s);
    lap->L = hdi_csr_keep(&s, L);
    if (from->B) {
        lap->B = HDI_CAST(double *, hdi_keep(&s, B));
        lap->b_diag = HDI_CAST(double *, hdi_keep(&s, b_diag));
    }
    lap->component = HDI_CAST(int32_t *, hdi_keep(&s, component));
    lap->component_mass = HDI_CAST(double *, hdi_keep(&s, component_mass));
    for (r = 0; r < rows; r++) {
        to[r] = i = lap->row[name[from->vertex[r]]];
        L.row_ptr[i + 1] = from->L.row_ptr[r + 1] - from->L.row_ptr[r];
        component[i] = from->component[r];
        if (B) b_diag[i] = from->b_diag[r];
    }
    for (i = 0; i < rows; i++) L.row_ptr[i + 1] += L.row_ptr[i];
    hdi_fill_i32(number, from->n_components, -1);
    for (i = 0; i < rows; i++) {                 /* numbered by their first row, as always */
        if (number[component[i]] < 0) {
            component_mass[lap->n_components] = from->component_mass[component[i]];
            number[component[i]] = lap->n_components++;
        }
        component[i] = number[component[i]];
    }
    job.lap = lap;
    job.from = from;
    job.to = to;
    hdi_parallel(lap->context, (HDI_CAST(int64_t, rows) + HDI_RENUMBER_ROWS - 1) / HDI_RENUMBER_ROWS, hdi_renumber_task, &job);
    for (r = 0; r < rows && widest > HDI_RENUMBER_WIDTH; r++)
        if (from->L.row_ptr[r + 1] - from->L.row_ptr[r] > HDI_RENUMBER_WIDTH) hdi_renumber_row(&job, r, key, key + widest);
    return hdi_scope_end(&s);
}

/* The soup of the stars of all points. xyz and name live in s, nothing else is left of neighbours and stars. */
static hd_status hdi_star_soup(hdi_soup *soup, hdi_star_job *job, hd_laplacian *lap, const double *xyz, const int64_t *nbr_ptr, const int32_t *nbr, double delta,
                               hdi_scope *s) {
    hdi_scope own = hdi_scope_begin(s->ctx, s->e);
    int32_t *tri, m = 0;
    memset(job, 0, sizeof *job);
    if ((nbr_ptr ? hdi_star_given(job, xyz, lap->n, nbr_ptr, nbr, &own, s) : hdi_star_search(job, xyz, lap->n, &lap->points, &own, s)) < 0)
        return hdi_scope_end(&own);
    tri = hdi_stars(job, &m, lap, &own);
    if (!tri || hdi_progress(s->ctx, "assemble", 0.2, s->e) < 0) return hdi_scope_end(&own);
    if (hdi_soup_make(soup, job->xyz, job->n, tri, m, delta, &lap->mesh, s) < 0) {
        if (s->e->face >= 0) s->e->vertex = job->name[soup->tri[3 * s->e->face]];    /* the caller knows no faces */
        s->e->face = -1;
    }
    return hdi_scope_end(&own);
}

/* The tufted Laplacian of a point set (Sharp, Crane 2020, section 5.7): every point's star in the Delaunay triangulation of its neighbourhood, in the
 * tangent plane by principal components, goes into one soup with the weight 1/3, since where neighbours agree each triangle comes three times.
 * Deviations:
 * 1. Cocircular points, which every grid is full of, are told apart by heights of at most 1e-9, else the
 *    stars would not agree.
 * 2. Neighbours off the plane count as farther away than their projections, so that the other sheet of a thin
 *    part does not cut the star. An arc of a circle that leaves the point along the plane and ends r away at
 *    height h is s = r + 2/3 h^2/r long, to this order: the bisector stands at s/2 instead of r/2. In noise
 *    the point itself is off the plane of its neighbourhood; so h^2 is the square of the neighbour's height
 *    above that plane less the square of the point's own, as where the plane cuts the Voronoi diagram of
 *    space. Bisectors keep at least a quarter of their distance, as a point may be farther off than its
 *    neighbours are away. (Boissonnat, Ghosh 2014 take the tangent plane and 1 for 2/3. Measured against the
 *    smooth kernel, the largest error as a mean of 6 to 10 sets, fem: on spheres, tori, noise and shells 2/3
 *    from the plane is better than projections alone or within 5 %; 1, or heights from the point, are worse
 *    on undersampled tori or in noise. Known loss: voronoi-cot, 500 to 1250 random points on a torus, 12 to
 *    36 % more error.) */
static hd_status hdi_tufted_points(hd_laplacian *lap, const double *xyz, const int64_t *nbr_ptr, const int32_t *nbr, double delta, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    hd_laplacian *inner = NULL;
    hdi_star_job job;
    hdi_soup soup;
    hdi_mesh flat;
    if (hdi_star_soup(&soup, &job, lap, xyz, nbr_ptr, nbr, delta, &s) < 0) return hdi_scope_end(&s);
    if (lap->mesh.n_faces_used == 0) hdi_fail(e, HD_ERR_EMPTY, "the points' neighbourhoods make no triangle");
    if (e->status >= 0 && hdi_soup_delaunay(&flat, &soup, &lap->mesh, &s) >= 0) inner = HDI_CAST(hd_laplacian *, hdi_alloc(lap->context, 1, sizeof *inner, e));
    if (!inner) return hdi_scope_end(&s);
    memset(inner, 0, sizeof *inner);
    inner->n = job.n;
    inner->kind = lap->kind;
    inner->context = lap->context;
    inner->mesh = lap->mesh;
    if (hdi_lap_flat(inner, &flat, &s) >= 0) {
        lap->mesh = inner->mesh;
        lap->area = soup.area / 3;
        lap->b_ratio = inner->b_ratio;
        lap->conserves = 1;
        if (hdi_lap_renumber(lap, inner, job.name, e) >= 0 && hdi_lap_places(lap, xyz, e) >= 0) (void)hdi_progress(lap->context, "assemble", 0.8, e);
    }
    hdi_laplacian_free(inner, lap->context);
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

static void *hdi_copy(const void *from, uint64_t count, size_t size, hd_context *ctx, hd_error *e) {
    void *to = e->status < 0 ? NULL : hdi_alloc(ctx, count, size, e);
    if (to && count > 0) memcpy(to, from, HDI_CAST(size_t, count) * size);
    return to;
}

enum { HDI_ROWS_AHEAD = 8 };     /* rows of a matrix taken in any order are asked for so many rows early */

/* P L P' and P B P' into out, whose perm is a valid one: entry (i, k) is put where (k, i) belongs, which is the same and leaves the columns of every row
 * ascending. */
static hd_status hdi_sym_permute(hd_laplacian *out, const hd_laplacian *lap, const int32_t *perm, hd_context *ctx, hd_error *e) {
    const int32_t n = lap->n_active;
    const uint64_t n1 = HDI_CAST(uint64_t, n) + 1, nnz = HDI_CAST(uint64_t, lap->L.nnz);
    hdi_scope s = hdi_scope_begin(ctx, e), keep = hdi_scope_begin(ctx, e);
    int32_t *inv = HDI_TAKE(&s, int32_t, n), i;
    int64_t *fill = HDI_TAKE(&s, int64_t, n1), p;
    double *B = NULL;
    hd_csr a = lap->L;
    a.row_ptr = HDI_TAKE(&keep, int64_t, n1);
    a.col = HDI_TAKE(&keep, int32_t, nnz);
    a.val = HDI_TAKE(&keep, double, nnz);
    if (lap->B) B = HDI_TAKE(&keep, double, nnz);
    if (e->status < 0) {
        hdi_scope_end(&s);
        return hdi_scope_end(&keep);
    }
    a.row_ptr[0] = 0;
    for (i = 0; i < n; i++) {
        inv[perm[i]] = i;
        fill[i] = a.row_ptr[i];
        a.row_ptr[i + 1] = a.row_ptr[i] + lap->L.row_ptr[perm[i] + 1] - lap->L.row_ptr[perm[i]];
    }
    for (i = 0; i < n; i++) {
        if (i + HDI_ROWS_AHEAD < n) {
            const int64_t ahead = lap->L.row_ptr[perm[i + HDI_ROWS_AHEAD]];
            HDI_PREFETCH(lap->L.col + ahead);
            HDI_PREFETCH(lap->L.val + ahead);
            if (B) HDI_PREFETCH(lap->B + ahead);
        }
        for (p = lap->L.row_ptr[perm[i]]; p < lap->L.row_ptr[perm[i] + 1]; p++) {
            const int64_t q = fill[inv[lap->L.col[p]]]++;
            a.col[q] = i;
            a.val[q] = lap->L.val[p];
            if (B) B[q] = lap->B[p];
        }
    }
    out->L = a;
    out->B = B;
    keep.n = 0;                                  /* all of it is the caller's now */
    return hdi_scope_end(&s);
}

/* A Laplacian with rows renumbered: row i of out is row perm[i] of lap. out lives in ctx. */
static hd_laplacian *hdi_sym_renumber(const hd_laplacian *lap, const int32_t *perm, hd_context *ctx, hd_error *e) {
    const size_t n = HDI_CAST(size_t, lap->n_active);
    hd_laplacian *out;
    int32_t i;
    hdi_error_clear(e);
    out = HDI_CAST(hd_laplacian *, hdi_copy(lap, 1, sizeof *lap, ctx, e));
    if (!out) return NULL;
    memset(&out->L, 0, sizeof out->L);
    out->context = ctx;
    out->B = NULL;
    out->xyz = NULL;                             /* an order has been found */
    out->mass = HDI_CAST(double *, hdi_copy(lap->mass, n, sizeof(double), ctx, e));
    out->vertex = HDI_CAST(int32_t *, hdi_copy(lap->vertex, n, sizeof(int32_t), ctx, e));
    out->component = HDI_CAST(int32_t *, hdi_copy(lap->component, n, sizeof(int32_t), ctx, e));
    out->row = HDI_CAST(int32_t *, hdi_copy(lap->row, HDI_CAST(uint64_t, lap->n), sizeof(int32_t), ctx, e));
    out->component_mass = HDI_CAST(double *, hdi_copy(lap->component_mass, HDI_CAST(uint64_t, lap->n_components), sizeof(double), ctx, e));
    out->b_diag = lap->B ? HDI_CAST(double *, hdi_copy(lap->b_diag, n, sizeof(double), ctx, e)) : out->mass;
    if (e->status < 0 || hdi_sym_permute(out, lap, perm, ctx, e) < 0) {
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

/* ---- minimum degree ordering ---- */
/* Eliminates, again and again, a vertex whose elimination joins fewest others. The graph that elimination leaves is never written down: an
 * eliminated vertex becomes an element, the list of those it joined, and a variable keeps the elements it lies in and the neighbours that no
 * element covers yet. Lists only shrink, so this fits into the room of A and one list more.
 * This work is based on
 *   P. Amestoy, T. Davis, I. Duff, An approximate minimum degree ordering algorithm, 1996 (the algorithm, and its letters: L_e, E_i, A_i)
 *   A. George, J. Liu, The evolution of the minimum degree ordering algorithm, 1989 (supervariables, mass elimination)
 *   F. Pellegrini, J. Roman, P. Amestoy, Hybridizing nested dissection and halo approximate minimum degree, 2000 (the halo)
 * Of our own: all that is known of a vertex lies in one half of a cache line, and what is needed soon is fetched early, which is what counts from
 * 1M vertices on; the hash table of twins is small; a halo needs no rows. (Renumbering breadth first before costs as much as it saves.)
 * Ties: the vertex whose degree was found last goes first. */

/* A variable, an element, or what became of them. */
typedef struct hdi_amd_node {
    int32_t at;                  /* its list begins at list[at]; of a vertex eliminated or merged with another one: that one */
    int32_t len;                 /* length of the list: elements first, then variables */
    int32_t elen;                /* how many are elements; HDI_AMD_PIVOT: this is an element itself */
    int32_t weight;              /* vertices it stands for, 0: it is gone. Negative: on the list that is being worked on */
    int32_t mark;                /* elements: |L_e \ L_me| + flag, 0 when absorbed; variables: seen when equal to flag */
    int32_t degree;              /* bound of the weight of the neighbours; of an element the weight of its list */
    int32_t next, prev;          /* of the same degree; later chain of the hash table, and hash. Of an element prev is its place in the order */
} hdi_amd_node;

enum { HDI_AMD_PIVOT = -1, HDI_AMD_BUCKETS = 1024 };

typedef struct hdi_amd {
    int32_t n, inner;            /* vertices, and those to be eliminated: 0..inner-1 */
    int32_t left;                /* weight of what is not eliminated, the halo included */
    int32_t done;                /* vertices in the order so far */
    int32_t least;               /* no variable has a smaller degree */
    int32_t flag, longest;       /* see mark; the heaviest element */
    int32_t free, size;          /* list[free..size-1] is unused */
    int32_t *head;               /* [n + 1] first variable of each degree, or -1 */
    int32_t *bucket;             /* [HDI_AMD_BUCKETS] */
    int32_t *list;
    hdi_amd_node *v;             /* [n] */
} hdi_amd;

static void hdi_amd_link(hdi_amd *g, int32_t i, int32_t degree) {
    const int32_t next = g->head[degree];
    g->v[i].degree = degree;
    g->v[i].next = next;
    g->v[i].prev = -1;
    if (next >= 0) g->v[next].prev = i;
    g->head[degree] = i;
    if (degree < g->least) g->least = degree;
}

static void hdi_amd_unlink(hdi_amd *g, int32_t i) {
    const int32_t next = g->v[i].next, prev = g->v[i].prev;
    if (next >= 0) g->v[next].prev = prev;
    if (prev >= 0) g->v[prev].next = next;
    else g->head[g->v[i].degree] = next;
}

/* Moves all lists together. Each marks its beginning with its owner, who keeps the entry that stood there. */
static void hdi_amd_compact(hdi_amd *g) {
    int32_t i, p, q = 0, end;
    for (i = 0; i < g->n; i++) {
        hdi_amd_node *v = g->v + i;
        if (v->weight == 0 || v->len == 0 || (v->elen == HDI_AMD_PIVOT && v->mark == 0)) continue;
        p = v->at;
        v->at = g->list[p];
        g->list[p] = -1 - i;
    }
    for (p = 0; p < g->free;) {
        if (g->list[p] >= 0) {
            p++;
            continue;
        }
        i = -1 - g->list[p];
        g->list[p] = g->v[i].at;
        g->v[i].at = q;
        for (end = p + g->v[i].len; p < end; p++) g->list[q++] = g->list[p];
    }
    g->free = q;
}

/* Variables of list[p..p+len-1] that are not in L_me yet are put to its end at list[q], which may be that same list; returns the new end.
 * Their own lists are read next: they are fetched already. */
static int32_t hdi_amd_collect(hdi_amd *g, int32_t p, int32_t len, int32_t q, int32_t *weight) {
    const int32_t end = p + len;
    int32_t ahead;
    for (ahead = p; ahead < end; ahead++) HDI_PREFETCH(g->v + g->list[ahead]);
    for (; p < end; p++) {
        const int32_t i = g->list[p], w = g->v[i].weight;
        if (w <= 0) continue;
        *weight += w;
        g->v[i].weight = -w;
        HDI_PREFETCH(g->list + g->v[i].at);
        g->list[q++] = i;
        if (i < g->inner) hdi_amd_unlink(g, i);
    }
    return q;
}

/* L_me = A_me and the L_e of all its elements e, without me. They are absorbed. A variable without elements becomes an element in place. */
static void hdi_amd_element(hdi_amd *g, int32_t me) {
    hdi_amd_node *v = g->v + me;
    int32_t begin, end, p, weight = 0;
    const int32_t elen = v->elen;
    if (elen > 0 && v->degree > g->size - g->free) hdi_amd_compact(g);
    /* Lists that are alive hold at most the nnz entries that they began with: L_me replaces the longer ones
     * it is made of, and whoever gets me into its list loses one entry at least. So n words and more are free
     * after compacting, and degrees are below n. */
    HEATDIFF_ASSERT(elen == 0 || v->degree <= g->size - g->free);
    begin = end = elen > 0 ? g->free : v->at;
    v->weight = -v->weight;
    for (p = v->at; p < v->at + elen; p++) {
        hdi_amd_node *e = g->v + g->list[p];
        end = hdi_amd_collect(g, e->at, e->len, end, &weight);
        e->mark = 0;
    }
    end = hdi_amd_collect(g, v->at + elen, v->len - elen, end, &weight);
    if (elen > 0) g->free = end;
    v->at = begin;
    v->len = end - begin;
    v->elen = HDI_AMD_PIVOT;
    v->degree = weight;
}

/* mark - flag = |L_e \ L_me| for all elements e that share a variable with L_me. */
static void hdi_amd_overlaps(hdi_amd *g, const hdi_amd_node *me) {
    hdi_amd_node *v = g->v;
    const int32_t flag = g->flag, *list = g->list, *l = list + me->at, *const l_end = l + me->len;
    for (; l < l_end; l++) {
        const hdi_amd_node *i = v + *l;
        const int32_t *e = list + i->at, *const e_end = e + i->elen, w = i->weight;   /* w is negative */
        for (; e < e_end; e++) {
            const int32_t mark = v[*e].mark;
            if (mark >= flag) v[*e].mark = mark + w;
            else if (mark != 0) v[*e].mark = v[*e].degree + flag + w;
        }
    }
}

/* A_i and E_i for the i of L_me: what me covers goes, so do elements inside L_me, me comes. Variables with no neighbours outside L_me are
 * eliminated with me. The others get their degree without the share of L_me, and are put into the hash table. */
static void hdi_amd_update(hdi_amd *g, int32_t me) {
    hdi_amd_node *v = g->v, *pivot = v + me;
    int32_t *list = g->list, *l = list + pivot->at, *const l_end = l + pivot->len;
    const int32_t flag = g->flag;
    for (; l < l_end; l++) {
        hdi_amd_node *i = v + *l;
        int32_t *const first = list + i->at, *from = first, *to = first, *end = first + i->elen, *vars, degree = 0;
        uint32_t hash = 0;
        for (; from < end; from++) {
            const int32_t e = *from, outside = v[e].mark - flag;
            if (outside > 0) {
                degree += outside;
                hash += HDI_CAST(uint32_t, e);
                *to++ = e;
            } else {
                v[e].mark = 0;                   /* it lies in L_me (or was absorbed already) */
            }
        }
        vars = to;
        for (end = first + i->len; from < end; from++) {
            const int32_t j = *from, w = v[j].weight;
            if (w <= 0) continue;
            degree += w;
            hash += HDI_CAST(uint32_t, j);
            *to++ = j;
        }
        if (to == first && *l < g->inner) {
            pivot->degree += i->weight;
            pivot->weight += i->weight;
            i->weight = 0;
            i->at = me;
            continue;
        }
        *to = *vars;                             /* there is room: an element or me itself has gone */
        *vars = *first;
        *first = me;
        i->elen = HDI_CAST(int32_t, vars - first) + 1;
        i->len = HDI_CAST(int32_t, to - first) + 1;
        if (degree < i->degree) i->degree = degree;
        hash *= 0x9E3779B1u;
        i->prev = HDI_CAST(int32_t, hash >> 1);
        hash >>= 22;
        i->next = g->bucket[hash];
        g->bucket[hash] = *l;
    }
}

/* Merges into i those of the chain behind it that have the same elements and variables: they will stay alike. */
static void hdi_amd_twins(hdi_amd *g, int32_t i) {
    hdi_amd_node *v = g->v, *a = v + i;
    const int32_t *list = g->list;
    int32_t last = i, j, p, stamped = 0;
    for (j = a->next; j >= 0; j = v[j].next) {
        hdi_amd_node *b = v + j;
        int same = a->prev == b->prev && a->len == b->len && a->elen == b->elen && (i < g->inner) == (j < g->inner);
        if (same && !stamped) {
            for (p = 1; p < a->len; p++) v[list[a->at + p]].mark = g->flag;
            stamped = 1;
        }
        for (p = 1; same && p < b->len; p++) same = v[list[b->at + p]].mark == g->flag;
        if (same) {
            a->weight += b->weight;
            b->weight = 0;
            b->at = i;
            v[last].next = b->next;
        } else {
            last = j;
        }
    }
    g->flag += stamped;
}

/* Twins all over L_me: they meet in the chains of the hash table, which is left empty. */
static void hdi_amd_merge(hdi_amd *g, const hdi_amd_node *me) {
    int32_t p, i, *head;
    for (p = me->at; p < me->at + me->len; p++) {
        i = g->list[p];
        if (g->v[i].weight == 0) continue;
        head = g->bucket + ((HDI_CAST(uint32_t, g->v[i].prev) << 1) >> 22);
        i = *head;
        *head = -1;
        for (; i >= 0 && g->v[i].next >= 0; i = g->v[i].next) hdi_amd_twins(g, i);
    }
}

/* Strikes from L_me what is gone; the others get their degrees. */
static void hdi_amd_restore(hdi_amd *g, hdi_amd_node *me) {
    int32_t p, q = me->at, end = me->at + me->len;
    for (p = q; p < end; p++) {
        const int32_t i = g->list[p], w = -g->v[i].weight;
        int32_t degree;
        if (w == 0) continue;
        g->v[i].weight = w;
        g->list[q++] = i;
        if (i >= g->inner) continue;
        degree = g->v[i].degree + me->degree - w;
        hdi_amd_link(g, i, degree < g->left - w ? degree : g->left - w);
    }
    if (g->free == end) g->free = q;
    me->len = q - me->at;
    if (me->len == 0) me->mark = 0;
}

/* New marks must be above all old ones; once in a long while they begin anew. */
static void hdi_amd_next_flag(hdi_amd *g, int32_t step) {
    int32_t i;
    if (g->flag < INT32_MAX - 2 * step - g->n) {
        g->flag += step;
        return;
    }
    for (i = 0; i < g->n; i++)
        if (g->v[i].mark) g->v[i].mark = 1;
    g->flag = 2;
}

/* Eliminates variables until the order holds as many as that. */
static void hdi_amd_run(hdi_amd *g, int32_t until) {
    while (g->done < until) {
        hdi_amd_node *pivot;
        int32_t me;
        while (g->head[g->least] < 0) g->least++;
        me = g->head[g->least];
        pivot = g->v + me;
        hdi_amd_unlink(g, me);
        if (g->head[g->least] >= 0) HDI_PREFETCH(g->list + g->v[g->head[g->least]].at);    /* likely the next one */
        hdi_amd_element(g, me);
        hdi_amd_overlaps(g, pivot);
        hdi_amd_update(g, me);
        if (pivot->degree > g->longest) g->longest = pivot->degree;
        hdi_amd_next_flag(g, g->longest + 1);
        hdi_amd_merge(g, pivot);
        pivot->weight = -pivot->weight;
        pivot->prev = g->done;
        g->done += pivot->weight;
        g->left -= pivot->weight;
        hdi_amd_restore(g, pivot);
    }
}

/* Words of work space for n vertices and lists of nnz entries. The elbow room of n is needed, that of nnz / 5 saves time (as in the paper). */
static int64_t hdi_amd_words(int64_t n, int64_t nnz) {
    return HDI_CAST(int64_t, sizeof(hdi_amd_node) / sizeof(int32_t)) * n + n + 1 + HDI_AMD_BUCKETS + nnz + nnz / 5 + n;
}

/* Lays out the work space of words. */
static void hdi_amd_begin(hdi_amd *g, int32_t n, int32_t inner, int32_t *work, int64_t words) {
    int32_t i;
    g->n = g->left = g->least = n;
    g->inner = inner;
    g->done = g->free = g->longest = 0;
    g->flag = 2;
    g->v = HDI_CAST(hdi_amd_node *, HDI_CAST(void *, work));
    g->head = HDI_CAST(int32_t *, HDI_CAST(void *, g->v + n));
    g->bucket = g->head + n + 1;
    g->list = g->bucket + HDI_AMD_BUCKETS;
    g->size = HDI_CAST(int32_t, work + words - g->list);
    for (i = 0; i <= n; i++) g->head[i] = -1;
    for (i = 0; i < HDI_AMD_BUCKETS; i++) g->bucket[i] = -1;
    for (i = 0; i < n; i++) {
        g->v[i].at = g->v[i].len = g->v[i].elen = g->v[i].degree = 0;
        g->v[i].weight = g->v[i].mark = 1;
        g->v[i].next = g->v[i].prev = -1;
    }
}

/* Rows longer than this would be in most lists, and are eliminated last whatever happens. */
static int32_t hdi_amd_dense(int32_t n) {
    const double d = 10 * sqrt(HDI_CAST(double, n));
    return d < 16 ? 16 : HDI_CAST(int32_t, d);
}

/* Takes i out of the graph. */
static void hdi_amd_drop(hdi_amd *g, int32_t i) {
    g->v[i].weight = 0;
    g->v[i].elen = HDI_AMD_PIVOT;
    g->left--;
}

/* All lists are there: rows without neighbours come first in the order, those dropped as dense last, the others into the list of their degree.
 * Returns how many the order holds without the dense ones. */
static int32_t hdi_amd_start(hdi_amd *g) {
    int32_t i, last = g->inner, count;
    for (i = 0; i < g->inner; i++) last -= g->v[i].weight == 0;
    count = last;
    for (i = 0; i < g->inner; i++) {
        if (g->v[i].weight == 0) {
            g->v[i].prev = last++;
        } else if (g->v[i].len == 0) {
            hdi_amd_drop(g, i);
            g->v[i].prev = g->done++;
        } else {
            hdi_amd_link(g, i, g->v[i].len);
        }
    }
    return count;
}

/* perm [inner] from the pivots' places: those merged or eliminated with others follow them. */
static void hdi_amd_number(hdi_amd *g, int32_t *perm) {
    hdi_amd_node *v = g->v;
    int32_t i, j, root, up;
    for (i = 0; i < g->inner; i++) {
        for (root = i; v[root].elen != HDI_AMD_PIVOT; root = v[root].at) {}
        for (j = i; j != root; j = up) {
            up = v[j].at;
            v[j].at = root;
        }
        perm[v[root].prev++] = i;
    }
}

/* int32 words of work space for hdi_sym_minimum_degree_part; nnz = ptr[k]. */
static int64_t hdi_sym_minimum_degree_work(int32_t k, int32_t h, int64_t nnz) {
    return hdi_amd_words(HDI_CAST(int64_t, k) + h, h > 0 ? 2 * nnz : nnz);
}

/* Orders the vertices 0..k-1 of a small graph that also has a halo, vertices k..k+h-1, which count in degrees but are never eliminated.
 * ptr, col   [k + 1], [ptr[k]] rows of the inner vertices with columns 0..k+h-1, those of inner vertices in both triangles; in any order, none twice
 *            in a row, the diagonal may be there. The halo has no rows; edges inside it do not matter.
 * perm       [k] perm[q] = vertex eliminated q-th
 * work       [hdi_sym_minimum_degree_work(k, h, ptr[k])] below 2^31, best aligned to 64 bytes
 * Allocates nothing and cannot fail. TRUSTS ITS INPUT. */
static void hdi_sym_minimum_degree_part(int32_t k, int32_t h, const int32_t *ptr, const int32_t *col, int32_t *perm, int32_t *work) {
    const int32_t n = k + h, dense = hdi_amd_dense(n);
    int32_t i, p, q = 0;
    hdi_amd g;
    hdi_amd_begin(&g, n, k, work, hdi_sym_minimum_degree_work(k, h, ptr[k]));
    for (i = 0; i < k; i++) {
        if (ptr[i + 1] - ptr[i] > dense) hdi_amd_drop(&g, i);
        for (p = ptr[i]; p < ptr[i + 1]; p++)
            if (col[p] >= k) g.v[col[p]].len++;
    }
    for (i = k; i < n; i++) {                    /* room for the lists of the halo */
        if (g.v[i].len > dense) hdi_amd_drop(&g, i);
        g.v[i].at = q;
        q += g.v[i].len;
        g.v[i].len = 0;
    }
    for (i = 0; i < k; i++) {
        g.v[i].at = q;
        if (g.v[i].weight == 0) continue;
        for (p = ptr[i]; p < ptr[i + 1]; p++) {
            hdi_amd_node *j = g.v + col[p];
            if (col[p] == i || j->weight == 0) continue;
            g.list[q++] = col[p];
            if (col[p] >= k) g.list[j->at + j->len++] = i;
        }
        g.v[i].len = q - g.v[i].at;
    }
    g.free = q;
    hdi_amd_run(&g, hdi_amd_start(&g));
    hdi_amd_number(&g, perm);
}

/* perm[q] = row of the symmetric pattern a (both triangles) that is eliminated q-th. */
static hd_status hdi_sym_minimum_degree(const hd_csr *a, int32_t *perm, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    const int32_t n = a->n_rows, dense = hdi_amd_dense(n);
    const int64_t words = hdi_amd_words(n, a->nnz);
    int32_t i, q = 0, count, *work;
    int64_t p;
    hdi_amd g;
    if (words - 9 * HDI_CAST(int64_t, n) > INT32_MAX) return hdi_fail(e, HD_ERR_TOO_LARGE, "a pattern is too large for a minimum degree ordering");
    work = HDI_TAKE(&s, int32_t, words);
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_amd_begin(&g, n, n, work, words);
    for (i = 0; i < n; i++)
        if (a->row_ptr[i + 1] - a->row_ptr[i] > dense) hdi_amd_drop(&g, i);
    for (i = 0; i < n; i++) {
        g.v[i].at = q;
        if (g.v[i].weight == 0) continue;
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            if (a->col[p] != i && g.v[a->col[p]].weight > 0) g.list[q++] = a->col[p];
        g.v[i].len = q - g.v[i].at;
    }
    g.free = q;
    count = hdi_amd_start(&g);
    while (g.done < count && hdi_progress(ctx, "order", HDI_CAST(double, g.done) / count, e) >= 0)
        hdi_amd_run(&g, count - g.done > 100000 ? g.done + 100000 : count);
    if (e->status >= 0) hdi_amd_number(&g, perm);
    return hdi_scope_end(&s);
}

/* ---- nested dissection ---- */
/* An elimination order for matrices whose rows have a place in space: separators last. The rows are numbered along a space-filling curve, so that
 * every part is a compact graph in cache. A part is halved on its clusters, small groups of neighbours that are made once and handed down: swept
 * along a line or by graph distance, then improved by exchanges on a few coarser copies. Around the cut that this gives, the smallest separator
 * within a band is found exactly, by vertex-disjoint paths. Both halves are halved in turn. Small parts are ordered by minimum degree, the
 * separators around them counted as neighbours.
 * This work is based on:
 *   A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10, 1973.
 *   G. M. Morton, A computer oriented geodetic data base and a new technique in file sequencing, IBM, 1966.
 *   B. Hendrickson, R. Leland, A multilevel algorithm for partitioning graphs, Supercomputing 1995.
 *   C. M. Fiduccia, R. M. Mattheyses, A linear-time heuristic for improving network partitions, DAC 1982.
 *   L. R. Ford, D. R. Fulkerson, Flows in networks, 1962 (and Menger's theorem).
 *   C. Ashcraft, J. W. H. Liu, Applications of the Dulmage-Mendelsohn decomposition and network flow to graph bisection improvement,
 *   SIAM J. Matrix Anal. Appl. 19, 1998: smallest separators in a band.
 * The clusters that a separator cuts through live on in both halves, with the weights of edges that they had: these only guide the next cut. */

enum {
    HDI_ND_LEAF = 1500,     /* vertices of a part that minimum degree orders: 300 to 3000 make little difference to fill, fewer cost time */
    HDI_ND_FRESH = 50,      /* clusters of a part that are too few to cut */
    HDI_ND_COARSE = 100,    /* vertices of a coarsest copy, about */
    HDI_ND_LAYERS = 5,      /* of the band, on each side of a cut: 3 cost a tenth more flops in the factor, 8 gain little */
    HDI_ND_WORDS = 20,      /* work space: words for a vertex */
    HDI_ND_SLACK = 1200,    /* and for a task */
    HDI_ND_LEVELS = 24,     /* most copies of a part */
    HDI_ND_BUCKETS = 128,   /* gains that are told apart, for each side */
    HDI_ND_TASKS = 64,      /* parts that are ordered in parallel */
    HDI_ND_BLOCK = 8192,    /* rows that are read by a task */
    HDI_ND_MIDDLE = 64,     /* the separator's layer in a band */
    HDI_ND_NONE = -2147483647,
    HDI_ND_DEAD = 2147483647
};

/* A part, or a coarse copy of one. At the finest copy weights are 1 (ew and w are NULL), and negative entries of adj are rows outside of the
 * part, already in a separator: ~row. */
typedef struct hdi_nd_graph {
    int32_t n;
    int32_t *ptr, *adj;    /* neighbours of v: adj[ptr[v]..ptr[v + 1]), no diagonal */
    int32_t *ew, *w;       /* weights of entries (edges of the part within) and of vertices (vertices of the part within) */
    int32_t *id;           /* the row whose place stands for v */
    int32_t *map;          /* vertex of the next coarser copy */
    int8_t *side;          /* 0, 1, and at the finest copy 2: separator */
} hdi_nd_graph;

/* Rows first..first + n - 1 of the order are to be found. clusters = 0: none are known. */
typedef struct hdi_nd_part { int32_t first, n, edge, n_edges, clusters, buffer; } hdi_nd_part;

/* The graphs of parts and of their clusters. Those of odd depth are in one of two buffers, of even depth in the other, each in its own slices. */
typedef struct hdi_nd_buffer {
    int32_t *ptr, *adj, *id, *map;   /* [2 n], [nnz], [n], [n]; ptr has n + 1 words for every part, also where a separator is empty */
    int32_t *cptr, *cadj, *cew, *cid; /* [2 n], [nnz / 4], [nnz / 4], [n] */
} hdi_nd_buffer;

/* Everything that the tasks share. */
typedef struct hdi_nd {
    hdi_nd_buffer buffer[2];
    float *xyz;
    int32_t *perm, *work;
    hdi_nd_part *part, *child;       /* of the running loop: part i halves into child[2 i], child[2 i + 1] */
} hdi_nd;

/* Work space left to a task; taken from its front, given back by forgetting the copy that was taken from. */
typedef struct hdi_nd_space { int32_t *at, *end; } hdi_nd_space;

/* A task's space, 20 n + 2 n_edges + 1200 words for a part of n vertices, is never used up. A split takes
 * 1.25 n (rows by number, sides), and the list of a cut's vertices 2 n; what else it takes is given back
 * before the next step. Of these steps the largest is hdi_nd_cut_clusters: 1.25 c for c <= n clusters, 2
 * n_edges, and copies, each of at most 2/3 of the vertices of the one before: one of N vertices takes 3.17 N,
 * all 9.5 c; where a copy fails it keeps 3.17 N at most, takes 5.5 N for a while, and hdi_nd_first_cut 11.5 N
 * on top, or hdi_nd_descend 4.25 N on top of all copies. With N = (2/3)^l c that is 9.5 c (1 - (2/3)^l) +
 * 14.67 N <= 14.67 c: together 19.2 n at most. Rounding adds less than 30 words a copy, of which there are
 * 24. The flow takes 10.25 n, fresh clusters 3.17 n + 5.5 (2/3 n), clusters of a half 2 n; hdi_nd_leaf looks
 * itself. */
static int32_t *hdi_nd_take(hdi_nd_space *s, int64_t words) {
    int32_t *p = s->at;
    HEATDIFF_ASSERT(words <= s->end - s->at);
    s->at += words;
    return p;
}

static int8_t *hdi_nd_take_bytes(hdi_nd_space *s, int64_t bytes) { return HDI_CAST(int8_t *, HDI_CAST(void *, hdi_nd_take(s, bytes / 4 + 1))); }

/* ---- order along the curve ---- */

/* The bits of x (10) two places apart. */
static uint32_t hdi_nd_spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

/* key[i] = place of row i on the Morton curve in a grid of 1024^3 cells; unit [3n] = the places scaled to [0, 1]. */
static void hdi_nd_keys(const double *xyz, int32_t n, uint32_t *key, float *unit) {
    double lo[3], hi[3], width = 0;
    int32_t i, d;
    for (d = 0; d < 3; d++) lo[d] = hi[d] = n ? 0.5 * xyz[d] : 0;   /* halves: a difference of two must not overflow */
    for (i = 0; i < n; i++)
        for (d = 0; d < 3; d++) {
            lo[d] = hdi_min(lo[d], 0.5 * xyz[3 * HDI_CAST(size_t, i) + HDI_CAST(size_t, d)]);
            hi[d] = hdi_max(hi[d], 0.5 * xyz[3 * HDI_CAST(size_t, i) + HDI_CAST(size_t, d)]);
        }
    for (d = 0; d < 3; d++) width = hdi_max(width, hi[d] - lo[d]);
    if (!(width > 0)) width = 1;
    for (i = 0; i < n; i++) {
        key[i] = 0;
        for (d = 0; d < 3; d++) {
            const size_t q = 3 * HDI_CAST(size_t, i) + HDI_CAST(size_t, d);
            const double u = (0.5 * xyz[q] - lo[d]) / width;
            unit[q] = HDI_CAST(float, u);
            key[i] |= hdi_nd_spread(HDI_CAST(uint32_t, u * 1023)) << d;
        }
    }
}

/* order = the rows by ascending key: three passes of ten bits. spare [n], count [1024]. */
static void hdi_nd_sort(const uint32_t *key, int32_t n, int32_t *order, int32_t *spare, int32_t *count) {
    int32_t i, shift, *from = spare, *to = order;
    for (i = 0; i < n; i++) from[i] = i;
    for (shift = 0; shift < 30; shift += 10) {
        int32_t sum = 0, *t;
        memset(count, 0, 1024 * sizeof *count);
        for (i = 0; i < n; i++) count[key[i] >> shift & 1023u]++;
        for (i = 0; i < 1024; i++) {
            const int32_t c = count[i];
            count[i] = sum;
            sum += c;
        }
        for (i = 0; i < n; i++) to[count[key[from[i]] >> shift & 1023u]++] = from[i];
        t = from;
        from = to;
        to = t;
    }
}

/* ---- coarse copies ---- */

/* Clusters of neighbours: each vertex still free takes its free neighbours, to at most limit of weight. One that finds none joins a neighbour's
 * cluster; without any, one left alone before. weight [n]. Returns their number. */
static int32_t hdi_nd_cluster(const hdi_nd_graph *g, int32_t limit, int32_t *weight) {
    int32_t v, p, n = 0, single = -1, *map = g->map;
    for (v = 0; v < g->n; v++) map[v] = -1;
    for (v = 0; v < g->n; v++) {
        int32_t wv, sum, join = -1;
        if (map[v] >= 0) continue;
        sum = wv = g->w ? g->w[v] : 1;
        map[v] = n;
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p];
            if (u < 0) continue;
            if (map[u] < 0) {
                const int32_t wu = g->w ? g->w[u] : 1;
                if (sum + wu > limit) continue;
                map[u] = n;
                sum += wu;
            } else if (join < 0 && map[u] != n && weight[map[u]] + wv <= limit + limit / 4) join = map[u];
        }
        if (sum == wv && join < 0 && single >= 0 && weight[single] + wv <= limit) join = single;
        if (sum > wv || join < 0) {
            if (sum == wv) single = n;
            weight[n++] = sum;
        } else {
            map[v] = join;
            weight[join] += wv;
        }
    }
    return n;
}

/* c = the graph of the clusters of g, with summed weights. c->n, c->w are set; c->adj, c->ew have room for space > 0 entries. member [g->n],
 * start [c->n + 1], mark [c->n]. 0 if the room is too small. */
static int hdi_nd_contract(const hdi_nd_graph *g, hdi_nd_graph *c, int32_t space, int32_t *member, int32_t *start, int32_t *mark) {
    const int32_t *map = g->map, *ew = g->ew;
    int32_t v, i, p, z = 0, *adj = c->adj, *sum = c->ew;
    memset(start, 0, HDI_CAST(size_t, c->n + 1) * sizeof *start);
    for (v = 0; v < g->n; v++) start[g->map[v]]++;
    for (i = 0, z = 0; i < c->n; i++) {
        z += start[i];
        start[i] = z;
        mark[i] = -1;
    }
    start[c->n] = z;
    for (v = g->n; v-- > 0;) member[--start[g->map[v]]] = v;
    for (i = 0, z = 0; i < c->n; i++) {
        int32_t m;
        const int32_t row = z;
        c->ptr[i] = z;
        c->id[i] = g->id[member[start[i]]];
        mark[i] = space - 1;                           /* where edges inside the cluster go, to be forgotten */
        sum[space - 1] = 0;
        for (m = start[i]; m < start[i + 1]; m++) {
            v = member[m];
            if (g->ptr[v + 1] - g->ptr[v] >= space - z) return 0;
            for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
                const int32_t u = g->adj[p], e = ew ? ew[p] : 1;
                int32_t d, at, fresh;
                if (u < 0) continue;
                d = map[u];
                at = mark[d];
                fresh = at < row;                      /* no branches from here on: they would be unpredictable */
                at = fresh ? z : at;
                mark[d] = at;
                adj[at] = d;
                sum[at] = e + (fresh ? 0 : sum[at]);
                z += fresh;
            }
        }
        mark[i] = -1;
    }
    c->ptr[c->n] = z;
    return 1;
}

/* Where copies are made: the room for their entries. */
typedef struct hdi_nd_room { int32_t *adj, *ew, n; } hdi_nd_room;

/* Makes level[1], coarser than level[0]. total: weight of all vertices. 0 if there is no room or not much to win. */
static int hdi_nd_coarser(hdi_nd_graph *level, int32_t total, hdi_nd_room *room, hdi_nd_space *s) {
    hdi_nd_graph *g = level, *c = level + 1;
    const int32_t mean = total / g->n, most = total / 24;   /* of weight in a cluster: that the coarsest copy can be halved */
    hdi_nd_space temp;
    int32_t *weight, *member, *start, *mark;
    g->map = hdi_nd_take(s, g->n);
    weight = hdi_nd_take(s, g->n);
    c->n = hdi_nd_cluster(g, 8 * mean < most ? 8 * mean : most, weight);
    if (c->n > g->n - g->n / 3) return 0;
    s->at = weight + c->n;
    c->w = weight;
    c->ptr = hdi_nd_take(s, c->n + 1);
    c->id = hdi_nd_take(s, c->n);
    c->side = hdi_nd_take_bytes(s, c->n);
    c->adj = room->adj;
    c->ew = room->ew;
    temp = *s;
    member = hdi_nd_take(&temp, g->n);
    start = hdi_nd_take(&temp, c->n + 1);
    mark = hdi_nd_take(&temp, c->n);
    if (!hdi_nd_contract(g, c, room->n, member, start, mark)) return 0;
    room->n -= c->ptr[c->n];
    room->adj += c->ptr[c->n];
    room->ew += c->ptr[c->n];
    return 1;
}

/* ---- buckets ---- */

/* Items by gain: doubly linked lists, one for each gain and side. prev of the first is -1 - bucket, of one in no list HDI_ND_NONE. */
typedef struct hdi_nd_queue {
    int32_t head[2 * HDI_ND_BUCKETS], top[2];
    int32_t *next, *prev;
} hdi_nd_queue;

static void hdi_nd_queue_clear(hdi_nd_queue *q) {
    memset(q->head, 0xff, sizeof q->head);
    q->top[0] = q->top[1] = -1;
}

static void hdi_nd_queue_add(hdi_nd_queue *q, int32_t item, int32_t side, int32_t gain) {
    const int32_t b = side * HDI_ND_BUCKETS + gain, h = q->head[b];
    q->next[item] = h;
    q->prev[item] = -1 - b;
    if (h >= 0) q->prev[h] = item;
    q->head[b] = item;
    if (gain > q->top[side]) q->top[side] = gain;
}

static void hdi_nd_queue_remove(hdi_nd_queue *q, int32_t item) {
    const int32_t next = q->next[item], prev = q->prev[item];
    if (prev >= 0) q->next[prev] = next;
    else q->head[-1 - prev] = next;
    if (next >= 0) q->prev[next] = prev;
    q->prev[item] = HDI_ND_NONE;
}

/* The item of largest gain on a side, or -1. */
static int32_t hdi_nd_queue_best(hdi_nd_queue *q, int32_t side) {
    const int32_t *head = q->head + side * HDI_ND_BUCKETS;
    int32_t t = q->top[side];
    while (t >= 0 && head[t] < 0) t--;
    q->top[side] = t;
    return t < 0 ? -1 : head[t];
}

/* ---- cutting edges ---- */

/* What a cut costs: its size, and a little for halves that differ. */
static double hdi_nd_cost(double cut, double a, double b) {
    const double im = (a - b) / (a + b + 1e-30);
    return (cut + 1) * (1 + 0.6 * im * im);
}

typedef struct hdi_nd_cut { double weight[2], cut, most; } hdi_nd_cut;

typedef struct hdi_nd_mover {
    const hdi_nd_graph *g;
    hdi_nd_queue q;
    int32_t *gain, *moved;    /* gain[v]: weight of the edges to the other side less of those to its own */
    int8_t *locked;
    int32_t shift;            /* gains of 2^shift are told apart */
} hdi_nd_mover;

static int32_t hdi_nd_bucket(const hdi_nd_mover *m, int32_t gain) {
    const int32_t half = HDI_ND_BUCKETS / 2, b = half + (gain < 0 ? -(-gain >> m->shift) : gain >> m->shift);
    return b < 0 ? 0 : b >= HDI_ND_BUCKETS ? HDI_ND_BUCKETS - 1 : b;
}

static hdi_nd_mover hdi_nd_mover_make(const hdi_nd_graph *g, hdi_nd_space *s) {
    hdi_nd_mover m;
    m.g = g;
    m.shift = 0;
    m.gain = hdi_nd_take(s, g->n);
    m.q.next = hdi_nd_take(s, g->n);
    m.q.prev = hdi_nd_take(s, g->n);
    m.moved = hdi_nd_take(s, g->n);
    m.locked = hdi_nd_take_bytes(s, g->n);
    return m;
}

/* Gains of all vertices; those on the cut enter the queue. Sets the cut's weights. */
static void hdi_nd_mover_start(hdi_nd_mover *m, hdi_nd_cut *cut) {
    const hdi_nd_graph *g = m->g;
    int32_t v, p, largest = 1;
    double sum = 0;
    cut->weight[0] = cut->weight[1] = 0;
    hdi_nd_queue_clear(&m->q);
    for (v = 0; v < g->n; v++) {
        int32_t in = 0, out = 0;
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p], e = g->ew ? g->ew[p] : 1;
            if (u < 0) continue;
            out += e & -(g->side[u] ^ g->side[v]);
            in += e;
        }
        in -= out;
        m->gain[v] = out - in;
        m->q.prev[v] = out ? HDI_ND_NONE + 1 : HDI_ND_NONE;   /* a mark: to be entered below */
        if (out > in && out > largest) largest = out;
        if (out && in > largest) largest = in;
        sum += out;
        cut->weight[g->side[v]] += g->w ? g->w[v] : 1;
    }
    cut->cut = 0.5 * sum;
    m->shift = 0;
    while (largest >> m->shift >= HDI_ND_BUCKETS / 2) m->shift++;
    for (v = 0; v < g->n; v++)
        if (m->q.prev[v] != HDI_ND_NONE) hdi_nd_queue_add(&m->q, v, g->side[v], hdi_nd_bucket(m, m->gain[v]));
    memset(m->locked, 0, HDI_CAST(size_t, g->n));
}

/* v changes its side; its neighbours' gains follow. */
static void hdi_nd_mover_move(hdi_nd_mover *m, int32_t v, hdi_nd_cut *cut) {
    const hdi_nd_graph *g = m->g;
    const int8_t to = HDI_CAST(int8_t, 1 - g->side[v]);
    const int32_t wv = g->w ? g->w[v] : 1;
    int32_t p;
    g->side[v] = to;
    cut->weight[to] += wv;
    cut->weight[1 - to] -= wv;
    cut->cut -= m->gain[v];
    m->gain[v] = -m->gain[v];
    for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
        const int32_t u = g->adj[p], e = g->ew ? g->ew[p] : 1;
        if (u < 0) continue;
        m->gain[u] += g->side[u] == to ? -2 * e : 2 * e;
        if (m->locked[u]) continue;
        if (m->q.prev[u] != HDI_ND_NONE) hdi_nd_queue_remove(&m->q, u);
        hdi_nd_queue_add(&m->q, u, g->side[u], hdi_nd_bucket(m, m->gain[u]));
    }
}

/* The vertex to move next: of largest gain, where the side it goes to stays below most or below the side it leaves. -1: none. */
static int32_t hdi_nd_mover_next(hdi_nd_mover *m, const hdi_nd_cut *cut) {
    int32_t s, best = -1, gain = 0;
    for (s = 0; s < 2; s++) {
        const int32_t v = hdi_nd_queue_best(&m->q, s);
        double after;
        if (v < 0) continue;
        after = cut->weight[1 - s] + (m->g->w ? m->g->w[v] : 1);
        if (after > cut->most && after >= cut->weight[s]) continue;
        if (best >= 0 && (m->gain[v] < gain || (m->gain[v] == gain && cut->weight[1] <= cut->weight[0]))) continue;
        best = v;
        gain = m->gain[v];
    }
    return best;
}

/* Fiduccia-Mattheyses: moves the best vertex, even at a loss, each once in a pass; goes back to the best cut seen. */
static void hdi_nd_refine_edges(hdi_nd_mover *m, hdi_nd_cut *cut, int32_t passes) {
    const int32_t patience = 20 + m->g->n / 20 < 200 ? 20 + m->g->n / 20 : 200;
    while (passes-- > 0) {
        double first, best;
        int32_t n = 0, keep = 0, v;
        hdi_nd_mover_start(m, cut);
        first = best = hdi_nd_cost(cut->cut, cut->weight[0], cut->weight[1]);
        if (hdi_max(cut->weight[0], cut->weight[1]) > cut->most) first = best = DBL_MAX;
        while (n - keep < patience && (v = hdi_nd_mover_next(m, cut)) >= 0) {
            double now;
            hdi_nd_queue_remove(&m->q, v);
            m->locked[v] = 1;
            hdi_nd_mover_move(m, v, cut);
            m->moved[n++] = v;
            now = hdi_nd_cost(cut->cut, cut->weight[0], cut->weight[1]);
            if (now < best && hdi_max(cut->weight[0], cut->weight[1]) <= cut->most) {
                best = now;
                keep = n;
            }
        }
        while (n > keep) {
            v = m->moved[--n];
            m->locked[v] = 1;
            hdi_nd_mover_move(m, v, cut);
        }
        if (!(best < first)) break;
    }
}

/* ---- the first cut ---- */

static const float *hdi_nd_place(const hdi_nd *nd, const hdi_nd_graph *g, int32_t v) { return nd->xyz + 3 * HDI_CAST(size_t, g->id[v]); }

static double hdi_nd_distance2(const float *a, const float *b) {
    const double x = HDI_CAST(double, a[0]) - HDI_CAST(double, b[0]), y = HDI_CAST(double, a[1]) - HDI_CAST(double, b[1]);
    const double z = HDI_CAST(double, a[2]) - HDI_CAST(double, b[2]);
    return x * x + y * y + z * z;
}

static int32_t hdi_nd_farthest(const hdi_nd *nd, const hdi_nd_graph *g, const float *from) {
    int32_t v, far_v = 0;
    double most = -1;
    for (v = 0; v < g->n; v++) {
        const double d = hdi_nd_distance2(hdi_nd_place(nd, g, v), from);
        if (d > most) {
            most = d;
            far_v = v;
        }
    }
    return far_v;
}

/* dist = number of edges from start; g->n where none leads. Returns the vertex reached last. */
static int32_t hdi_nd_steps(const hdi_nd_graph *g, int32_t start, int32_t *dist, int32_t *queue) {
    int32_t v, p, head = 0, tail = 1;
    for (v = 0; v < g->n; v++) dist[v] = g->n;
    dist[start] = 0;
    queue[0] = start;
    while (head < tail) {
        v = queue[head++];
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p];
            if (u < 0 || dist[u] < g->n) continue;
            dist[u] = dist[v] + 1;
            queue[tail++] = u;
        }
    }
    return queue[tail - 1];
}

/* A monotone map of doubles to integers. */
static uint64_t hdi_nd_key(double x) {
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    return u >> 63 ? ~u : u | 0x8000000000000000u;
}

/* Values along which the vertices are swept, as keys to sort by: 0 the longest straight line, 1 graph distance, others fixed directions. 0 if all
 * are equal. work [3 g->n]. */
static int hdi_nd_sweep_keys(const hdi_nd *nd, const hdi_nd_graph *g, int32_t kind, hdi_pair *key, int32_t *work) {
    static const signed char hdi_nd_direction[9][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};
    int32_t v, a, b, *da = work, *db = work + g->n, *queue = work + 2 * g->n;
    int differ = 0;
    double d[3] = {0, 0, 0};
    if (kind == 1) {
        a = hdi_nd_steps(g, hdi_nd_steps(g, 0, da, queue), da, queue);
        b = hdi_nd_steps(g, a, db, queue);
        hdi_nd_steps(g, b, da, queue);
    } else if (kind == 0) {
        const float *pa, *pb;
        a = hdi_nd_farthest(nd, g, hdi_nd_place(nd, g, 0));
        pa = hdi_nd_place(nd, g, a);
        pb = hdi_nd_place(nd, g, hdi_nd_farthest(nd, g, pa));
        for (v = 0; v < 3; v++) d[v] = HDI_CAST(double, pb[v]) - HDI_CAST(double, pa[v]);
    } else for (v = 0; v < 3; v++) d[v] = hdi_nd_direction[(kind - 2) % 9][v];
    for (v = 0; v < g->n; v++) {
        const float *x = hdi_nd_place(nd, g, v);
        key[v].key = hdi_nd_key(kind == 1 ? HDI_CAST(double, da[v] - db[v])
                                          : d[0] * HDI_CAST(double, x[0]) + d[1] * HDI_CAST(double, x[1]) + d[2] * HDI_CAST(double, x[2]));
        key[v].id = v;
        if (key[v].key != key[0].key) differ = 1;
    }
    return differ;
}

/* The sides that the best place in the order of key gives. */
static double hdi_nd_sweep(const hdi_nd_graph *g, const hdi_pair *key, double total) {
    double weight = 0, cut = 0, best = DBL_MAX;
    int32_t i, p, keep = 0;
    memset(g->side, 1, HDI_CAST(size_t, g->n));
    for (i = 0; i < g->n; i++) {
        const int32_t v = HDI_CAST(int32_t, key[i].id);
        double now;
        g->side[v] = 0;
        weight += g->w ? g->w[v] : 1;
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p], e = g->ew ? g->ew[p] : 1;
            if (u >= 0) cut += g->side[u] ? e : -e;
        }
        now = hdi_nd_cost(cut, weight, total - weight);
        if (fabs(2 * weight - total) > 0.2 * total) now = 1e30 * (1 + fabs(2 * weight - total) / total);
        if (now < best) {
            best = now;
            keep = i + 1;
        }
    }
    for (i = keep; i < g->n; i++) g->side[key[i].id] = 1;
    return best;
}

/* Cuts the coarsest copy: the best of several sweeps, each refined. */
static hdi_nd_cut hdi_nd_first_cut(const hdi_nd *nd, const hdi_nd_graph *g, int32_t total, hdi_nd_space s) {
    const int32_t tries = total > 20000 ? 11 : total > 3000 ? 5 : 2;
    int32_t t, any = 0, *work;
    double best = DBL_MAX;
    hdi_pair *key;
    int8_t *side;
    hdi_nd_mover m = hdi_nd_mover_make(g, &s);
    hdi_nd_cut cut, kept;
    cut.most = 0.6 * total;
    kept = cut;
    side = hdi_nd_take_bytes(&s, g->n);
    work = hdi_nd_take(&s, 3 * HDI_CAST(int64_t, g->n));
    if (HDI_RECAST(uintptr_t, s.at) % sizeof(uint64_t)) hdi_nd_take(&s, 1);
    key = HDI_CAST(hdi_pair *, HDI_CAST(void *, hdi_nd_take(&s, 4 * HDI_CAST(int64_t, g->n))));
    for (t = 0; t < tries; t++) {
        double cost;
        if (!hdi_nd_sweep_keys(nd, g, t, key, work) && (any || t + 1 < tries)) continue;
        any = 1;
        hdi_sort_pairs(key, g->n);
        cost = hdi_nd_sweep(g, key, total);
        hdi_nd_refine_edges(&m, &cut, 3);
        cost = hdi_nd_cost(cut.cut, cut.weight[0], cut.weight[1]);
        if (cost >= best) continue;
        best = cost;
        kept = cut;
        memcpy(side, g->side, HDI_CAST(size_t, g->n));
    }
    memcpy(g->side, side, HDI_CAST(size_t, g->n));
    return kept;
}

/* ---- smallest separator in a band ---- */

/* Vertex-disjoint paths through the band around a separator, from what lies beyond it on the side from to what lies beyond on the other. As many as
 * there can be are as many as a separator must have (Menger). A path enters v at state 2 v and leaves it at 2 v + 1. */
typedef struct hdi_nd_flow {
    const hdi_nd_graph *g;
    int32_t *band, n_band;      /* its vertices, by distance from the separator */
    int32_t *prev, *next;       /* on the path through v: HDI_ND_NONE without one, -1 at its ends */
    int32_t *seen, stamp;       /* states reached: [2 v], [2 v + 1] = stamp */
    int32_t *up, *log, n_log;   /* of a search: the state before each, all states seen */
    int32_t *link, head[2 * HDI_ND_MIDDLE], top;   /* states still to go on from, a list for each layer; the layer farthest on */
    int8_t *inside, from;       /* layer: 0 outside, else HDI_ND_MIDDLE plus the distance from the separator, minus on side from */
} hdi_nd_flow;

/* The band: the separator (band[0..n)) and what is near it, at most most vertices of each side and layers steps away. */
static void hdi_nd_flow_band(hdi_nd_flow *f, int32_t n, int32_t most, int32_t layers) {
    const hdi_nd_graph *g = f->g;
    int32_t i, p, begin = 0, room[2];
    room[0] = room[1] = most;
    f->n_band = n;
    memset(f->inside, 0, HDI_CAST(size_t, g->n));
    for (i = 0; i < n; i++) f->inside[f->band[i]] = HDI_ND_MIDDLE;
    while (layers-- > 0 && begin < f->n_band) {
        const int32_t end = f->n_band;
        for (; begin < end; begin++) {
            const int32_t v = f->band[begin];
            for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
                const int32_t u = g->adj[p];
                if (u < 0 || f->inside[u] || room[g->side[u]] == 0) continue;
                room[g->side[u]]--;
                f->inside[u] = HDI_CAST(int8_t, f->inside[v] + (g->side[u] == f->from ? -1 : 1));
                f->band[f->n_band++] = u;
            }
        }
    }
    for (i = 0; i < f->n_band; i++) {
        const int32_t v = f->band[i];
        f->prev[v] = f->next[v] = HDI_ND_NONE;
        f->seen[2 * v] = f->seen[2 * v + 1] = 0;
    }
    f->stamp = 0;
}

/* A path from state: changes the paths there are along it. */
static void hdi_nd_flow_augment(hdi_nd_flow *f, int32_t state) {
    int32_t up;
    f->next[state >> 1] = -1;
    for (; (up = f->up[state]) >= 0; state = up) {
        const int32_t a = up >> 1, b = state >> 1;
        if (!(up & 1)) continue;
        if (a == b) f->prev[a] = f->next[a] = HDI_ND_NONE;
        else {
            f->next[a] = b;
            f->prev[b] = a;
        }
    }
    f->prev[state >> 1] = -1;
}

/* State to comes after state from: among those of its layer. */
static void hdi_nd_flow_push(hdi_nd_flow *f, int32_t to, int32_t from) {
    const int32_t layer = f->inside[to >> 1];
    f->seen[to] = f->stamp;
    f->up[to] = from;
    f->link[to] = f->head[layer];
    f->head[layer] = to;
    f->log[f->n_log++] = to;
    if (layer > f->top) f->top = layer;
}

/* Searches from vertex v, always on from a state in the layer farthest on. 1: one path more. What a failed search has seen leads nowhere for good. */
static int hdi_nd_flow_search(hdi_nd_flow *f, int32_t v) {
    const hdi_nd_graph *g = f->g;
    int32_t p, i;
    for (i = 0; i <= 2 * HDI_ND_LAYERS; i++) f->head[HDI_ND_MIDDLE - HDI_ND_LAYERS + i] = -1;
    f->stamp++;
    f->n_log = f->top = 0;
    hdi_nd_flow_push(f, 2 * v, -1);
    while (f->top >= HDI_ND_MIDDLE - HDI_ND_LAYERS) {
        const int32_t state = f->head[f->top];
        int32_t to = -1;
        if (state < 0) {
            f->top--;
            continue;
        }
        f->head[f->top] = f->link[state];
        v = state >> 1;
        if (!(state & 1)) {             /* through v, or where a path is there already, back along it */
            to = f->prev[v] == HDI_ND_NONE ? state + 1 : f->prev[v] < 0 ? -1 : 2 * f->prev[v] + 1;
        } else {
            for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
                const int32_t u = g->adj[p];
                if (u < 0) continue;
                if (f->inside[u]) {
                    if (f->seen[2 * u] < f->stamp) hdi_nd_flow_push(f, 2 * u, state);
                } else if (g->side[u] != f->from) {
                    hdi_nd_flow_augment(f, state);
                    return 1;
                }
            }
            if (f->prev[v] != HDI_ND_NONE) to = state - 1;
        }
        if (to >= 0 && f->seen[to] < f->stamp) hdi_nd_flow_push(f, to, state);
    }
    while (f->n_log > 0) f->seen[f->log[--f->n_log]] = HDI_ND_DEAD;
    return 0;
}

static int hdi_nd_flow_starts(const hdi_nd_flow *f, int32_t v) {
    const hdi_nd_graph *g = f->g;
    int32_t p;
    for (p = g->ptr[v]; p < g->ptr[v + 1]; p++)
        if (g->adj[p] >= 0 && !f->inside[g->adj[p]] && g->side[g->adj[p]] == f->from) return 1;
    return 0;
}

/* Sets the sides of the band around the separator band[0..n) so that the separator is the smallest inside of it; of several such, the one nearest
 * to side from. */
static void hdi_nd_flow_run(hdi_nd_flow *f, int32_t n, int32_t most, int32_t layers) {
    int32_t i, k = 0, *start;
    hdi_nd_flow_band(f, n, most, layers);
    start = f->band + f->n_band;
    for (i = 0; i < f->n_band; i++)
        if (hdi_nd_flow_starts(f, f->band[i])) start[k++] = f->band[i];
    for (i = 0; i < k; i++)
        if (f->seen[2 * start[i]] != HDI_ND_DEAD && f->prev[start[i]] != -1) hdi_nd_flow_search(f, start[i]);
    for (i = 0; i < k; i++) f->seen[2 * start[i]] = HDI_ND_DEAD;
    f->stamp = HDI_ND_DEAD;
    for (i = 0; i < f->n_band; i++) {
        const int32_t v = f->band[i];
        f->g->side[v] = f->seen[2 * v + 1] == f->stamp ? f->from : HDI_CAST(int8_t, f->seen[2 * v] == f->stamp ? 2 : 1 - f->from);
    }
}

/* ---- parts ---- */

/* The cut of level[from] taken down to level[1], improved on each copy. */
static void hdi_nd_descend(hdi_nd_graph *level, int32_t from, int32_t total, hdi_nd_space s) {
    int32_t l, v;
    for (l = from - 1; l > 0; l--) {
        hdi_nd_graph *g = level + l;
        hdi_nd_space temp = s;
        hdi_nd_mover m = hdi_nd_mover_make(g, &temp);
        hdi_nd_cut cut;
        cut.most = 0.6 * total;
        for (v = 0; v < g->n; v++) g->side[v] = g[1].side[g->map[v]];
        hdi_nd_refine_edges(&m, &cut, 3);
    }
}

/* level[1] = clusters of level[0], about a dozen vertices each: clusters of clusters. They replace those of the part, if they fit. */
static void hdi_nd_fresh(const hdi_nd *nd, const hdi_nd_part *part, hdi_nd_graph *level, hdi_nd_space s) {
    const hdi_nd_buffer *b = nd->buffer + part->buffer;
    hdi_nd_graph temp[3];
    hdi_nd_room room;
    int32_t v, n = 0, *map = level->map;
    temp[0] = *level;
    room.n = part->n_edges;
    room.adj = hdi_nd_take(&s, room.n);
    room.ew = hdi_nd_take(&s, room.n);
    while (n < 2 && (n == 0 || temp[n].n > 2 * HDI_ND_COARSE) && hdi_nd_coarser(temp + n, part->n, &room, &s)) n++;
    level[1].n = 0;
    if (n == 0 || temp[n].ptr[temp[n].n] > part->n_edges / 4 - 1) return;
    for (v = 0; v < part->n; v++) map[v] = n == 1 ? temp[0].map[v] : temp[1].map[temp[0].map[v]];
    level[1].n = temp[n].n;
    level[1].ptr = b->cptr + 2 * HDI_CAST(size_t, part->first);
    level[1].adj = b->cadj + part->edge / 4;
    level[1].ew = b->cew + part->edge / 4;
    level[1].id = b->cid + part->first;
    memcpy(level[1].ptr, temp[n].ptr, HDI_CAST(size_t, temp[n].n + 1) * sizeof(int32_t));
    memcpy(level[1].adj, temp[n].adj, HDI_CAST(size_t, temp[n].ptr[temp[n].n]) * sizeof(int32_t));
    memcpy(level[1].ew, temp[n].ew, HDI_CAST(size_t, temp[n].ptr[temp[n].n]) * sizeof(int32_t));
    memcpy(level[1].id, temp[n].id, HDI_CAST(size_t, temp[n].n) * sizeof(int32_t));
}

/* near_cut[v] = v touches the other side. */
static void hdi_nd_near(const hdi_nd_graph *g, int8_t *near_cut) {
    int32_t v, p;
    for (v = 0; v < g->n; v++) {
        int8_t other = 0;
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) other = HDI_CAST(int8_t, other | (g->side[g->adj[p]] ^ g->side[v]));
        near_cut[v] = other;
    }
}

/* The sides of level[0]: cuts the coarsest copy and takes the cut down. Returns in list the vertices that touch the other side, of the side where
 * they are fewer. */
static int32_t hdi_nd_cut_clusters(const hdi_nd *nd, const hdi_nd_part *part, hdi_nd_graph *level, int32_t *list, hdi_nd_space s) {
    hdi_nd_room room;
    hdi_nd_graph *g = level;
    int32_t l, v, p, n = 0, kept = 0, touch[2] = {0, 0};
    int8_t *near_cut = NULL;
    l = level[1].n > 0;
    if (l) {
        level[1].w = hdi_nd_take(&s, level[1].n);
        level[1].side = hdi_nd_take_bytes(&s, level[1].n);
        memset(level[1].w, 0, HDI_CAST(size_t, level[1].n) * sizeof(int32_t));
        for (v = 0; v < g->n; v++) level[1].w[g->map[v]]++;
    }
    room.n = part->n_edges;
    room.adj = hdi_nd_take(&s, room.n);
    room.ew = hdi_nd_take(&s, room.n);
    while (l + 1 < HDI_ND_LEVELS && level[l].n > HDI_ND_COARSE && hdi_nd_coarser(level + l, part->n, &room, &s)) l++;
    hdi_nd_first_cut(nd, level + l, part->n, s);
    hdi_nd_descend(level, l, part->n, s);
    if (l > 0) {
        near_cut = hdi_nd_take_bytes(&s, level[1].n);
        hdi_nd_near(level + 1, near_cut);
        for (v = 0; v < g->n; v++) g->side[v] = level[1].side[g->map[v]];
    }
    for (v = 0; v < g->n; v++) {
        if (near_cut && !near_cut[g->map[v]]) continue;
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++)
            if (g->adj[p] >= 0 && g->side[g->adj[p]] != g->side[v]) {
                touch[g->side[v]]++;
                list[n++] = v;
                break;
            }
    }
    for (p = 0; p < n; p++)
        if (g->side[list[p]] == (touch[1] < touch[0])) list[kept++] = list[p];
    return kept;
}

/* Weighs the sides of g. 0 if they differ too much, or the separator is most of it. */
static int hdi_nd_measure(const hdi_nd_graph *g, int32_t *size) {
    int32_t v, count[3] = {0, 0, 0};
    for (v = 0; v < g->n; v++) count[g->side[v]]++;
    for (v = 0; v < 3; v++) size[v] = count[v];
    return count[0] <= g->n - g->n / 5 && count[1] <= g->n - g->n / 5 && count[2] <= g->n / 2;
}

/* Sides by number, for graphs on which all else failed. */
static void hdi_nd_halve(const hdi_nd_graph *g) {
    int32_t v, p;
    for (v = 0; v < g->n; v++) g->side[v] = v >= g->n / 2;
    for (v = 0; v < g->n / 2; v++)
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++)
            if (g->adj[p] >= g->n / 2) g->side[v] = 2;
}

/* Sets level[0].side to 0, 1 or 2 and size [3]. 0 if the part has no good separator. */
static int hdi_nd_dissect(const hdi_nd *nd, const hdi_nd_part *part, hdi_nd_graph *level, hdi_nd_space s, int32_t *size) {
    hdi_nd_flow f;
    hdi_nd_graph kept[2];
    const int64_t n = part->n;
    int32_t n_list;
    f.g = level;
    f.band = hdi_nd_take(&s, 2 * n);
    if (level[1].n < HDI_ND_FRESH) hdi_nd_fresh(nd, part, level, s);
    memcpy(kept, level, sizeof kept);
    n_list = hdi_nd_cut_clusters(nd, part, level, f.band, s);
    memcpy(level, kept, sizeof kept);   /* without what was in work space */
    hdi_nd_measure(level, size);
    f.prev = hdi_nd_take(&s, n);
    f.next = hdi_nd_take(&s, n);
    f.seen = hdi_nd_take(&s, 2 * n);
    f.up = hdi_nd_take(&s, 2 * n);
    f.link = hdi_nd_take(&s, 2 * n);
    f.log = hdi_nd_take(&s, 2 * n);
    f.inside = hdi_nd_take_bytes(&s, n);
    f.from = size[1] > size[0];
    hdi_nd_flow_run(&f, n_list, part->n / 12, HDI_ND_LAYERS);
    if (hdi_nd_measure(level, size)) return 1;
    hdi_nd_halve(level);
    return hdi_nd_measure(level, size);
}

static hdi_nd_space hdi_nd_space_of(const hdi_nd *nd, const hdi_nd_part *p, int64_t index) {
    hdi_nd_space s;
    s.at = nd->work + HDI_CAST(size_t, HDI_ND_WORDS) * HDI_CAST(size_t, p->first) + 2 * HDI_CAST(size_t, p->edge) +
           HDI_CAST(size_t, HDI_ND_SLACK) * HDI_CAST(size_t, index);
    s.end = s.at + HDI_CAST(size_t, HDI_ND_WORDS) * HDI_CAST(size_t, p->n) + 2 * HDI_CAST(size_t, p->n_edges) + HDI_ND_SLACK;
    return s;
}

/* level[0] = the part, level[1] = its clusters. */
static void hdi_nd_graphs_of(const hdi_nd *nd, const hdi_nd_part *p, hdi_nd_graph *level) {
    const hdi_nd_buffer *b = nd->buffer + p->buffer;
    memset(level, 0, 2 * sizeof *level);
    level->n = p->n;
    level->ptr = b->ptr + 2 * HDI_CAST(size_t, p->first);
    level->adj = b->adj + p->edge;
    level->id = b->id + p->first;
    level->map = b->map + p->first;
    level[1].n = p->clusters;
    level[1].ptr = b->cptr + 2 * HDI_CAST(size_t, p->first);
    level[1].adj = b->cadj + p->edge / 4;
    level[1].ew = b->cew + p->edge / 4;
    level[1].id = b->cid + p->first;
}

/* The vertices of one side into the child's slices. at [level->n]: numbers within the sides, ~row in the separator. */
static void hdi_nd_extract(const hdi_nd_graph *g, int8_t side, const int32_t *at, hdi_nd_graph *child) {
    int32_t v, p, i = 0, z = 0;
    for (v = 0; v < g->n; v++) {
        if (g->side[v] != side) continue;
        child->ptr[i] = z;
        child->id[i++] = g->id[v];
        for (p = g->ptr[v]; p < g->ptr[v + 1]; p++) {
            const int32_t u = g->adj[p];
            child->adj[z++] = u < 0 ? u : at[u];
        }
    }
    child->ptr[i] = z;
}

/* The clusters of g[0], which are in g[1], that have vertices on one side into the child's slices, with room for space entries. Returns their number,
 * 0 if the room is too small. */
static int32_t hdi_nd_extract_clusters(const hdi_nd_graph *g, int8_t side, hdi_nd_graph *child, int32_t space, hdi_nd_space s) {
    const hdi_nd_graph *c = g + 1;
    int32_t v, p, i = 0, n = 0, z = 0, *number = hdi_nd_take(&s, c->n), *list = hdi_nd_take(&s, c->n);
    for (v = 0; v < c->n; v++) number[v] = -1;
    for (v = 0; v < g->n; v++) {
        const int32_t q = g->map[v];
        if (g->side[v] != side) continue;
        if (number[q] < 0) {
            list[n] = q;
            number[q] = n++;
        }
        child->map[i++] = number[q];
    }
    for (i = 0; i < n; i++) {
        v = list[i];
        child[1].ptr[i] = z;
        child[1].id[i] = c->id[v];
        if (c->ptr[v + 1] - c->ptr[v] > space - z) return 0;
        for (p = c->ptr[v]; p < c->ptr[v + 1]; p++) {
            child[1].adj[z] = number[c->adj[p]];
            child[1].ew[z] = c->ew[p];
            z += child[1].adj[z] >= 0;
        }
    }
    child[1].ptr[n] = z;
    return n;
}

/* Orders a part by minimum degree, separators around it as halo, if there is space for that. Its graph is changed in place: rows of the halo become
 * numbers from n on. */
static void hdi_nd_leaf(const hdi_nd *nd, const hdi_nd_part *part, hdi_nd_space s) {
    hdi_nd_graph g[2];
    int32_t p, v, z = 0, n_halo = 0, outer = 0, mask = 1, *table, *local = nd->perm + part->first;
    const int64_t words = s.end - s.at;
    if (!part->n) return;
    hdi_nd_graphs_of(nd, part, g);
    for (p = 0; p < part->n_edges; p++) outer += g->adj[p] < 0;
    while (mask < 2 * outer) mask *= 2;
    table = s.at;
    for (p = 0; p < 2 * mask && 2 * HDI_CAST(int64_t, mask) <= words; p++) table[p] = 0;
    for (p = 0; p < part->n_edges && 2 * HDI_CAST(int64_t, mask) <= words; p++) {
        const uint32_t u = HDI_CAST(uint32_t, g->adj[p]);
        uint32_t h = (u * 2654435769u >> 7) & HDI_CAST(uint32_t, mask - 1);
        if (g->adj[p] >= 0) continue;
        while (table[2 * h] && table[2 * h] != g->adj[p]) h = (h + 1) & HDI_CAST(uint32_t, mask - 1);
        if (!table[2 * h]) {
            table[2 * h] = g->adj[p];
            table[2 * h + 1] = part->n + n_halo++;
        }
        g->adj[p] = table[2 * h + 1];
    }
    if (n_halo < outer && n_halo == 0) n_halo = part->n_edges;   /* not numbered */
    if (hdi_sym_minimum_degree_work(part->n, n_halo, part->n_edges) > words) {
        for (v = 0, p = 0; v < part->n; v++) {                     /* without the halo */
            for (; p < g->ptr[v + 1]; p++) {
                g->adj[z] = g->adj[p];
                z += g->adj[p] >= 0 && g->adj[p] < part->n;
            }
            g->ptr[v + 1] = z;
        }
        n_halo = 0;
    }
    if (hdi_sym_minimum_degree_work(part->n, n_halo, g->ptr[part->n]) <= words)
        hdi_sym_minimum_degree_part(part->n, n_halo, g->ptr, g->adj, local, s.at);
    else
        for (v = 0; v < part->n; v++) local[v] = v;
    for (v = 0; v < part->n; v++) local[v] = g->id[local[v]];
}

/* Halves a part: its separator is ordered, last in the part's range, child[2] are the rest. A small part is ordered whole, its children are empty. */
static void hdi_nd_split(const hdi_nd *nd, const hdi_nd_part *part, hdi_nd_part *child, hdi_nd_space s) {
    hdi_nd_graph level[HDI_ND_LEVELS], half[2];
    hdi_nd_space rest = s;
    const int small = part->n <= HDI_ND_LEAF || part->n_edges == 0;
    int32_t v, size[3], n[2] = {0, 0}, last, *at = hdi_nd_take(&rest, part->n);
    memset(child, 0, 2 * sizeof *child);
    hdi_nd_graphs_of(nd, part, level);
    level->side = hdi_nd_take_bytes(&rest, part->n);
    if (small || !hdi_nd_dissect(nd, part, level, rest, size)) {
        hdi_nd_leaf(nd, part, s);
        return;
    }
    last = part->first + part->n - size[2];
    for (v = 0; v < part->n; v++) {
        const int8_t t = level->side[v];
        if (t < 2) at[v] = n[t]++;
        else {
            nd->perm[last++] = level->id[v];
            at[v] = ~level->id[v];
        }
    }
    for (v = 0; v < 2; v++) {
        child[v].first = v ? part->first + n[0] : part->first;
        child[v].n = n[v];
        child[v].edge = v ? part->edge + child->n_edges : part->edge;
        child[v].buffer = 1 - part->buffer;
        hdi_nd_graphs_of(nd, child + v, half);
        hdi_nd_extract(level, HDI_CAST(int8_t, v), at, half);
        child[v].n_edges = half->ptr[n[v]];
        if (n[v] > HDI_ND_LEAF && level[1].n > 0)
            child[v].clusters = hdi_nd_extract_clusters(level, HDI_CAST(int8_t, v), half, child[v].n_edges / 4 - 1, rest);
    }
}

static void hdi_nd_split_task(void *arg, int64_t index, int32_t worker) {
    const hdi_nd *nd = HDI_CAST(const hdi_nd *, arg);
    (void)worker;
    hdi_nd_split(nd, nd->part + index, nd->child + 2 * index, hdi_nd_space_of(nd, nd->part + index, index));
}

/* Orders a part and all below it. A child has at most 4/5 of its part's vertices, so the stack grows to less than 100. */
static void hdi_nd_subtree_task(void *arg, int64_t index, int32_t worker) {
    const hdi_nd *nd = HDI_CAST(const hdi_nd *, arg);
    const hdi_nd_space s = hdi_nd_space_of(nd, nd->part + index, index);
    hdi_nd_part stack[128];
    int32_t n = 1;
    (void)worker;
    stack[0] = nd->part[index];
    while (n > 0) {
        const hdi_nd_part p = stack[--n];
        if (!p.n) continue;
        hdi_nd_split(nd, &p, stack + n, s);
        n += 2;
    }
}

/* order = rows along the curve, those with far too many entries last; inv = its inverse, -1 for these. Returns how many the others are. */
static int32_t hdi_nd_number(const hd_csr *a, const uint32_t *key, int32_t *order, int32_t *inv, int32_t *count) {
    const double dense = 10 * sqrt(HDI_CAST(double, a->n_rows)) + 16;
    int32_t i, k = 0, last = a->n_rows;
    hdi_nd_sort(key, a->n_rows, order, inv, count);
    for (i = 0; i < a->n_rows; i++) {
        const int32_t r = order[i];
        if (HDI_CAST(double, a->row_ptr[r + 1] - a->row_ptr[r]) > dense) inv[--last] = r;
        else order[k++] = r;
    }
    for (i = k; i < a->n_rows; i++) order[i] = inv[i];
    for (i = 0; i < a->n_rows; i++) inv[order[i]] = i < k ? i : -1;
    return k;
}

/* Reads the matrix in the order of the curve: blocks of rows go to the second buffer, with gaps between them, and from there to the first. */
typedef struct hdi_nd_load_job {
    const hdi_nd *nd;
    const hd_csr *a;
    const int32_t *order, *inv;
    const float *unit;
    int32_t n, *from, *to;     /* of block i: its place in the second buffer; its place in the first, [n_blocks + 1] */
} hdi_nd_load_job;

static void hdi_nd_load_task(void *arg, int64_t index, int32_t worker) {
    const hdi_nd_load_job *job = HDI_CAST(const hdi_nd_load_job *, arg);
    const int32_t first = HDI_CAST(int32_t, index) * HDI_ND_BLOCK, last = first + HDI_ND_BLOCK < job->n ? first + HDI_ND_BLOCK : job->n;
    int32_t k, z = 0, *ptr = job->nd->buffer[0].ptr, *adj = job->nd->buffer[1].adj + job->from[index];
    int64_t p;
    (void)worker;
    for (k = first; k < last; k++) {
        const int32_t r = job->order[k];
        if (k + 8 < last) HDI_PREFETCH(job->a->col + job->a->row_ptr[job->order[k + 8]]);
        memcpy(job->nd->xyz + 3 * HDI_CAST(size_t, k), job->unit + 3 * HDI_CAST(size_t, r), 3 * sizeof(float));
        ptr[k] = z;
        job->nd->buffer[0].id[k] = k;
        for (p = job->a->row_ptr[r]; p < job->a->row_ptr[r + 1]; p++) {
            adj[z] = job->inv[job->a->col[p]];
            z += job->a->col[p] != r && adj[z] >= 0;
        }
    }
    job->to[index] = z;
}

static void hdi_nd_move_task(void *arg, int64_t index, int32_t worker) {
    const hdi_nd_load_job *job = HDI_CAST(const hdi_nd_load_job *, arg);
    const int32_t first = HDI_CAST(int32_t, index) * HDI_ND_BLOCK, last = first + HDI_ND_BLOCK < job->n ? first + HDI_ND_BLOCK : job->n;
    const int32_t to = job->to[index], count = job->to[index + 1] - to;
    int32_t k, *ptr = job->nd->buffer[0].ptr;
    (void)worker;
    for (k = first; k < last; k++) ptr[k] += to;
    memcpy(job->nd->buffer[0].adj + to, job->nd->buffer[1].adj + job->from[index], HDI_CAST(size_t, count) * sizeof(int32_t));
}

/* The whole matrix as a part, its n rows numbered by order. unit [3 a->n_rows]: places of the rows. work [2 blocks + 2]. */
static hdi_nd_part hdi_nd_load(const hdi_nd *nd, const hd_csr *a, const int32_t *order, const int32_t *inv, int32_t n, const float *unit,
                               int32_t *work, hd_context *ctx) {
    const int32_t n_blocks = (n + HDI_ND_BLOCK - 1) / HDI_ND_BLOCK;
    hdi_nd_load_job job;
    hdi_nd_part part;
    int32_t i, k, z = 0;
    job.nd = nd;
    job.a = a;
    job.order = order;
    job.inv = inv;
    job.unit = unit;
    job.n = n;
    job.from = work;
    job.to = work + n_blocks;
    for (k = 0; k < n; k++) {
        if (k % HDI_ND_BLOCK == 0) job.from[k / HDI_ND_BLOCK] = z;
        z += HDI_CAST(int32_t, a->row_ptr[order[k] + 1] - a->row_ptr[order[k]]);
    }
    hdi_parallel(ctx, n_blocks, hdi_nd_load_task, &job);
    for (i = 0, z = 0; i < n_blocks; i++) {
        const int32_t count = job.to[i];
        job.to[i] = z;
        z += count;
    }
    job.to[n_blocks] = z;
    hdi_parallel(ctx, n_blocks, hdi_nd_move_task, &job);
    nd->buffer[0].ptr[n] = z;
    memset(&part, 0, sizeof part);
    part.n = n;
    part.n_edges = z;
    return part;
}

static void hdi_nd_buffer_make(hdi_nd_buffer *b, const hd_csr *a, hdi_scope *s) {
    const uint64_t n = HDI_CAST(uint64_t, a->n_rows) + 1, nnz = HDI_CAST(uint64_t, a->nnz) + 1;
    int32_t *p = HDI_TAKE(s, int32_t, 7 * n + nnz + 2 * (nnz / 4 + 1));
    if (!p) return;
    b->ptr = p;
    b->cptr = b->ptr + 2 * n;
    b->id = b->cptr + 2 * n;
    b->map = b->id + n;
    b->cid = b->map + n;
    b->adj = b->cid + n;
    b->cadj = b->adj + nnz;
    b->cew = b->cadj + nnz / 4 + 1;
}

/* Orders the part: halves in step, in parallel, until there are many; then each with all below it. */
static void hdi_nd_run(hdi_nd *nd, hd_context *ctx, hd_error *e) {
    int64_t n_parts = 1;
    double done = 0.1;
    for (; n_parts < HDI_ND_TASKS; n_parts *= 2, done += 0.05) {
        hdi_nd_part *t = nd->part;
        if (hdi_progress(ctx, "order", done, e) < 0) return;
        hdi_parallel(ctx, n_parts, hdi_nd_split_task, nd);
        nd->part = nd->child;
        nd->child = t;
    }
    if (hdi_progress(ctx, "order", done, e) < 0) return;
    hdi_parallel(ctx, n_parts, hdi_nd_subtree_task, nd);
}

/* perm[k] = row of the symmetric pattern a (both triangles, the diagonal may be there) that is eliminated k-th.
 * xyz    [3 n] places of the rows, finite. They need not differ; but the less they tell who is whose neighbour, the slower this is
 * Does not depend on the number of threads. Progress stage "order". Errors HD_ERR_TOO_LARGE, HD_ERR_MEMORY, HD_ERR_CANCELLED. */
static hd_status hdi_sym_nested_dissection(const hd_csr *a, const double *xyz, int32_t *perm, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    const uint64_t n = HDI_CAST(uint64_t, a->n_rows);
    hdi_nd nd;
    int32_t i, k, *order = HDI_TAKE(&s, int32_t, n + 1), *inv = HDI_TAKE(&s, int32_t, n + 1);
    int32_t *count = HDI_TAKE(&s, int32_t, 1024 + 2 * n / HDI_ND_BLOCK);
    uint32_t *key = HDI_TAKE(&s, uint32_t, n + 1);
    float *unit = HDI_TAKE(&s, float, 3 * n + 1);
    if (a->nnz > INT32_MAX / 2 || n > INT32_MAX / 4) hdi_fail(e, HD_ERR_TOO_LARGE, "a pattern is too large for nested dissection");
    memset(&nd, 0, sizeof nd);
    nd.perm = perm;
    nd.xyz = HDI_TAKE(&s, float, 3 * n + 1);
    nd.work = HDI_TAKE(&s, int32_t, HDI_ND_WORDS * n + 2 * HDI_CAST(uint64_t, a->nnz) + HDI_ND_SLACK * HDI_ND_TASKS);
    nd.part = HDI_TAKE(&s, hdi_nd_part, HDI_ND_TASKS);
    nd.child = HDI_TAKE(&s, hdi_nd_part, HDI_ND_TASKS);
    hdi_nd_buffer_make(nd.buffer, a, &s);
    hdi_nd_buffer_make(nd.buffer + 1, a, &s);
    if (e->status < 0) return hdi_scope_end(&s);
    hdi_nd_keys(xyz, a->n_rows, key, unit);
    k = hdi_nd_number(a, key, order, inv, count);
    nd.part[0] = hdi_nd_load(&nd, a, order, inv, k, unit, count, ctx);
    hdi_nd_run(&nd, ctx, e);
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = 0; i < k; i++) perm[i] = order[perm[i]];
    for (i = k; i < a->n_rows; i++) perm[i] = order[i];
    return hdi_scope_end(&s);
}

/* ---- analysis for a direct factorisation ---- */
/* From an elimination order to supernodes, the rows of their fronts, and a plan of execution. Everything here is nearly linear in the
 * non-zeros of A, the number of supernodes and the lengths of their row lists.
 * This part is based on
 *   J. Liu, The role of elimination trees in sparse factorization, 1990 (trees, postorders, the multifrontal stack)
 *   J. Gilbert, E. Ng, B. Peyton, An efficient algorithm to compute row and column counts for sparse Cholesky factorization, 1994
 *   C. Ashcraft, R. Grimes, The influence of relaxed supernode partitions on the multifrontal method, 1989
 * A front is a dense lower triangle over the rows of a supernode: its p pivots, then u rows below. Its first p columns become columns of L
 * (the panel, m = p + u rows), the rest is the update matrix for its parent. */
enum { HDI_PANEL = 128 };

typedef struct hdi_symbolic {
    int32_t n, n_super;
    int32_t *perm;               /* [n] elimination order: perm[k] = row of A */
    int32_t *super;              /* [n_super + 1] first pivot of each supernode; supernodes are in postorder */
    int32_t *parent;             /* [n_super] -1: root */
    int64_t *row_ptr;            /* [n_super + 1] */
    int32_t *row;                /* rows below the pivots, ascending, in elimination order */
    int32_t *rel;                /* where each stands in the parent's front */
    int32_t *inner;              /* [n_super] how many of them are pivots there */
    int64_t *panel, *panel_pack; /* [n_super + 1] where panels begin, in entries: real, packs */
    int64_t *a_ptr;              /* [n_super + 1] */
    int64_t *a_from;             /* entry of A (lower triangle in elimination order) ... */
    int32_t *a_row, *a_col;      /* ... and its place in the front */
    int32_t *super_of;           /* [n] supernode of a pivot */
    int64_t *update, *vector;    /* [n_super] where update matrices, and vectors of u entries in solves, live in their work spaces, in entries */
    int32_t *kid_ptr, *kid;      /* [n_super + 1], [n_super] children */
    int32_t n_tasks;             /* subtrees that can be worked on at the same time: */
    int32_t *task_begin, *task_end;  /* [n_tasks] supernodes */
    int32_t *task_of;            /* [n_super] -1: top */
    int32_t n_top;
    int32_t *top;                /* [n_top] the others, children before parents */
    int64_t work, vector_size;   /* entries of all that live at the same time */
    int32_t largest_front, largest_update, largest_pivots, task_pivots, task_update;
    int64_t nnz;                 /* of L without the zeros that amalgamation lets in */
    int64_t stored;              /* entries of all panels of packs */
    double flops;                /* of a real factorisation: sum of squared column counts */
    double flops_done;           /* the same with the zeros that are computed on */
    hd_ordering ordering;
} hdi_symbolic;

static void hdi_symbolic_free(hd_context *ctx, hdi_symbolic *s) {
    hdi_free(ctx, s->perm);
    hdi_free(ctx, s->super);
    hdi_free(ctx, s->parent);
    hdi_free(ctx, s->row_ptr);
    hdi_free(ctx, s->row);
    hdi_free(ctx, s->rel);
    hdi_free(ctx, s->inner);
    hdi_free(ctx, s->panel);
    hdi_free(ctx, s->panel_pack);
    hdi_free(ctx, s->a_ptr);
    hdi_free(ctx, s->a_from);
    hdi_free(ctx, s->a_row);
    hdi_free(ctx, s->a_col);
    hdi_free(ctx, s->super_of);
    hdi_free(ctx, s->update);
    hdi_free(ctx, s->vector);
    hdi_free(ctx, s->kid_ptr);
    hdi_free(ctx, s->kid);
    hdi_free(ctx, s->task_begin);
    hdi_free(ctx, s->task_end);
    hdi_free(ctx, s->task_of);
    hdi_free(ctx, s->top);
    memset(s, 0, sizeof *s);
}

/* Lower triangle of P A P' by rows: columns below i of row i, in no order. inv [n] gets the inverse of perm. */
static void hdi_sym_lower(const hd_csr *a, const int32_t *perm, int32_t *inv, int64_t *ptr, int32_t *col) {
    int64_t p, q = 0;
    int32_t i;
    for (i = 0; i < a->n_rows; i++) inv[perm[i]] = i;
    for (i = 0; i < a->n_rows; i++) {
        ptr[i] = q;
        if (i + HDI_ROWS_AHEAD < a->n_rows) HDI_PREFETCH(a->col + a->row_ptr[perm[i + HDI_ROWS_AHEAD]]);
        for (p = a->row_ptr[perm[i]]; p < a->row_ptr[perm[i] + 1]; p++) {
            const int32_t k = inv[a->col[p]];
            if (k < i) col[q++] = k;
        }
    }
    ptr[i] = q;
}

/* Elimination tree: parent[k] is the row of the first non-zero below the diagonal of column k of L. ancestor [n] shortens the walks. */
static void hdi_sym_etree(int32_t n, const int64_t *ptr, const int32_t *col, int32_t *parent, int32_t *ancestor) {
    int32_t i, k, next;
    int64_t p;
    for (i = 0; i < n; i++) {
        parent[i] = ancestor[i] = -1;
        for (p = ptr[i]; p < ptr[i + 1]; p++) {
            for (k = col[p]; k != -1 && k != i; k = next) {
                next = ancestor[k];
                ancestor[k] = i;
                if (next == -1) parent[k] = i;
            }
        }
    }
}

/* post[k] = k-th node of a postorder of the forest, children in ascending order. head, next, stack [n]. */
static void hdi_sym_postorder(int32_t n, const int32_t *parent, int32_t *post, int32_t *head, int32_t *next, int32_t *stack) {
    int32_t i, k = 0, top;
    hdi_fill_i32(head, n, -1);
    for (i = n; i-- > 0;) {
        if (parent[i] < 0) continue;
        next[i] = head[parent[i]];
        head[parent[i]] = i;
    }
    for (i = 0; i < n; i++) {
        if (parent[i] >= 0) continue;
        stack[0] = i;
        for (top = 0; top >= 0;) {
            const int32_t v = stack[top], child = head[v];
            if (child < 0) {
                post[k++] = v;
                top--;
            } else {
                head[v] = next[child];
                stack[++top] = child;
            }
        }
    }
}

/* Column counts of L, diagonal included, for a postordered tree. Row i of L is a subtree of the tree, its leaves entries of A; a column's count is what
 * the leaves add to it less what their least common ancestors take back. upper: the pattern by columns, i.e. for each k the rows i > k.
 * first, last_leaf, last_seen, set [n]. */
static void hdi_sym_counts(int32_t n, const int64_t *ptr, const int32_t *row, const int32_t *parent, int32_t *count, int32_t *first,
                           int32_t *last_leaf, int32_t *last_seen, int32_t *set) {
    int32_t j, q;
    int64_t p;
    for (j = 0; j < n; j++) {
        first[j] = last_leaf[j] = last_seen[j] = -1;
        set[j] = j;
    }
    for (j = 0; j < n; j++) {
        count[j] = first[j] == -1;               /* a leaf of the tree */
        for (q = j; q != -1 && first[q] == -1; q = parent[q]) first[q] = j;
    }
    for (j = 0; j < n; j++) {
        if (parent[j] >= 0) count[parent[j]]--;
        for (p = ptr[j]; p < ptr[j + 1]; p++) {
            const int32_t i = row[p];
            if (first[j] > last_seen[i]) {       /* j is a leaf of row subtree i */
                count[j]++;
                if (last_leaf[i] >= 0) {
                    int32_t root = last_leaf[i], walk, up;
                    while (root != set[root]) root = set[root];
                    for (walk = last_leaf[i]; walk != root; walk = up) {
                        up = set[walk];
                        set[walk] = root;
                    }
                    count[root]--;
                }
                last_leaf[i] = j;
            }
            last_seen[i] = j;
        }
        if (parent[j] >= 0) set[j] = parent[j];
    }
    for (j = 0; j < n; j++)
        if (parent[j] >= 0) count[parent[j]] += count[j];
}

/* ---- supernodes ---- */

/* A supernode while they are merged. */
typedef struct hdi_node {
    int32_t parent, pivots, rows;    /* rows of the front, pivots included */
    int32_t first, last;             /* list of columns, linked by next_col */
    int64_t zeros;                   /* let in by merging */
    int32_t merged;                  /* into its parent */
} hdi_node;

/* Entries of the trapezoid of p columns over m rows. */
static int64_t hdi_trapezoid(int64_t m, int64_t p) { return m * p - p * (p - 1) / 2; }

/* Merges the child into its parent when the zeros that this lets in are few, or the front is so small that its own overhead costs more. Tuned on
 * meshes of 36K to 1M vertices for pole lanes and real factors alike. */
static int hdi_sym_worth_merging(const hdi_node *child, const hdi_node *parent) {
    const int64_t p = HDI_CAST(int64_t, child->pivots) + parent->pivots, m = HDI_CAST(int64_t, child->pivots) + parent->rows;
    const int64_t all = hdi_trapezoid(m, p), zeros = child->zeros + parent->zeros + all - hdi_trapezoid(child->rows, child->pivots) - hdi_trapezoid(parent->rows, parent->pivots);
    const double share = HDI_CAST(double, zeros) / HDI_CAST(double, all);
    if (zeros == child->zeros + parent->zeros) return 1;
    return p <= 6 || (p <= 12 && share < 0.3) || (p <= 24 && share < 0.1) || share < 0.03;
}

static void hdi_sym_merge(hdi_node *node, int32_t c, int32_t s, int32_t *next_col) {
    hdi_node *child = node + c, *parent = node + s;
    const int64_t before = hdi_trapezoid(child->rows, child->pivots) + hdi_trapezoid(parent->rows, parent->pivots);
    parent->pivots += child->pivots;
    parent->rows += child->pivots;
    parent->zeros += child->zeros + hdi_trapezoid(parent->rows, parent->pivots) - before;
    next_col[child->last] = parent->first;       /* the child's columns come first */
    parent->first = child->first;
    child->merged = 1;
}

/* Supernodes of a postordered tree: columns with the same structure, then relaxed. Returns their number; nodes are in postorder.
 * of [n]: scratch. */
static int32_t hdi_sym_supernodes(int32_t n, const int32_t *parent, const int32_t *count, hdi_node *node, int32_t *next_col, int32_t *of) {
    int32_t j, k, s = -1;
    for (j = 0; j < n; j++) {
        next_col[j] = -1;
        if (j > 0 && parent[j - 1] == j && count[j - 1] == count[j] + 1) {
            node[s].pivots++;
            next_col[j - 1] = j;
            node[s].last = j;
        } else {
            s++;
            node[s].pivots = 1;
            node[s].rows = count[j];
            node[s].first = node[s].last = j;
            node[s].zeros = 0;
            node[s].merged = 0;
        }
        of[j] = s;
    }
    for (k = 0; k <= s; k++) node[k].parent = parent[node[k].last] < 0 ? -1 : of[parent[node[k].last]];
    return n > 0 ? s + 1 : 0;
}

/* Merges children into parents from the leaves up: of each node first the child with most rows below, which lets in fewest zeros, then the others. */
static void hdi_sym_relax(hdi_node *node, int32_t n_nodes, int32_t *next_col, int32_t *head, int32_t *next) {
    int32_t s, c;
    hdi_fill_i32(head, n_nodes, -1);
    for (s = n_nodes; s-- > 0;) {
        if (node[s].parent < 0) continue;
        next[s] = head[node[s].parent];
        head[node[s].parent] = s;
    }
    for (s = 0; s < n_nodes; s++) {              /* children have gone through their own merges */
        int32_t best = head[s];
        for (c = head[s]; c >= 0; c = next[c])
            if (node[c].rows - node[c].pivots > node[best].rows - node[best].pivots) best = c;
        if (best >= 0 && hdi_sym_worth_merging(node + best, node + s)) hdi_sym_merge(node, best, s, next_col);
        for (c = head[s]; c >= 0; c = next[c])
            if (c != best && hdi_sym_worth_merging(node + c, node + s)) hdi_sym_merge(node, c, s, next_col);
    }
}

/* Panels of packs come in blocks of at most HDI_PANEL columns, each from its first pivot's row on: what stands above the diagonal of a wide panel is
 * not kept. Entries before block q of a panel of m rows and p columns: */
static int64_t hdi_panel_block(int64_t m, int64_t p, int64_t q) {
    const int64_t full = q * HDI_PANEL < p ? q : p / HDI_PANEL, rest = q * HDI_PANEL < p ? 0 : p % HDI_PANEL;
    return HDI_PANEL * (full * m - HDI_PANEL * (full * (full - 1) / 2)) + rest * (m - HDI_PANEL * full);
}

/* A postorder of the merged nodes: of the children of a node, those come first whose subtrees need much more room while under way than they leave
 * behind (Liu). order[k] = k-th node, parents in terms of nodes are made direct. Returns the number of nodes. work: as many pairs as nodes. */
static int32_t hdi_sym_order_nodes(hdi_node *node, int32_t n_nodes, int32_t *order, int64_t *peak, int32_t *head, int32_t *next, int32_t *stack,
                                   hdi_pair *work) {
    int32_t s, c, k = 0, top;
    hdi_fill_i32(head, n_nodes, -1);
    for (s = n_nodes; s-- > 0;) {                /* parents are decided before their children */
        const int32_t up = node[s].parent;
        if (up >= 0 && node[up].merged) node[s].parent = node[up].parent;
        if (node[s].merged || node[s].parent < 0) continue;
        next[s] = head[node[s].parent];
        head[node[s].parent] = s;
    }
    for (s = 0; s < n_nodes; s++) {
        int64_t held = 0, most = 0, n_kids = 0, q;
        if (node[s].merged) continue;
        for (c = head[s]; c >= 0; c = next[c]) {
            work[n_kids].key = HDI_CAST(uint64_t, peak[c] - hdi_triangle(node[c].rows - node[c].pivots));
            work[n_kids++].id = c;
        }
        hdi_sort_pairs(work, n_kids);
        head[s] = -1;
        for (q = 0; q < n_kids; q++) {           /* ascending, put in front of each other: descending */
            c = HDI_CAST(int32_t, work[q].id);
            next[c] = head[s];
            head[s] = c;
        }
        for (c = head[s]; c >= 0; c = next[c]) {
            if (held + peak[c] > most) most = held + peak[c];
            held += hdi_triangle(node[c].rows - node[c].pivots);
        }
        held += hdi_triangle(node[s].rows - node[s].pivots);
        peak[s] = held > most ? held : most;
    }
    for (s = 0; s < n_nodes; s++) {
        if (node[s].merged || node[s].parent >= 0) continue;
        stack[0] = s;
        for (top = 0; top >= 0;) {
            const int32_t v = stack[top], child = head[v];
            if (child < 0) {
                order[k++] = v;
                top--;
            } else {
                head[v] = next[child];
                stack[++top] = child;
            }
        }
    }
    return k;
}

/* ---- the plan of execution ---- */

/* ---- the plan of memory ---- */
/* Sizes and lifetimes are known, so that places are given out beforehand: best fit in a list of gaps, ascending and coalesced; end is where the space beyond
 * them begins. */
typedef struct hdi_gaps {
    int64_t *at, *size;
    int32_t n, room;
    int64_t end;
} hdi_gaps;

/* [at, at + size) is free from now on. */
static void hdi_gaps_free(hdi_gaps *g, int64_t at, int64_t size) {
    int32_t i, k;
    if (size == 0) return;
    for (i = g->n; i > 0 && g->at[i - 1] > at; i--) {}
    if (i > 0 && g->at[i - 1] + g->size[i - 1] == at) {
        g->size[--i] += size;
    } else if (g->n < g->room) {
        for (k = g->n++; k > i; k--) {
            g->at[k] = g->at[k - 1];
            g->size[k] = g->size[k - 1];
        }
        g->at[i] = at;
        g->size[i] = size;
    } else {
        return;                                  /* a full list forgets: only a loss of space */
    }
    if (i + 1 < g->n && g->at[i] + g->size[i] == g->at[i + 1]) {
        g->size[i] += g->size[i + 1];
        for (k = i + 1; k + 1 < g->n; k++) {
            g->at[k] = g->at[k + 1];
            g->size[k] = g->size[k + 1];
        }
        g->n--;
    }
    if (g->at[g->n - 1] + g->size[g->n - 1] == g->end) g->end = g->at[--g->n];
}

static int64_t hdi_gaps_take(hdi_gaps *g, int64_t size) {
    int32_t i, k, best = -1;
    int64_t at = g->end;
    for (i = 0; i < g->n; i++)
        if (g->size[i] >= size && (best < 0 || g->size[i] < g->size[best])) best = i;
    if (best < 0) {
        g->end += size;
        return at;
    }
    at = g->at[best];
    g->at[best] += size;
    g->size[best] -= size;
    if (g->size[best]) return at;
    for (k = best; k + 1 < g->n; k++) {
        g->at[k] = g->at[k + 1];
        g->size[k] = g->size[k + 1];
    }
    g->n--;
    return at;
}

/* Places for a run of supernodes in the order in which they are worked on: list[begin..end), or these numbers themselves. With triangle, update matrices, else
 * vectors of solves. Children that belong to the same run or to none under way (other NULL) give their places back. Returns how far it got. */
static int64_t hdi_sym_place(const hdi_symbolic *s, hdi_gaps *g, const int32_t *list, int32_t begin, int32_t end, int triangle, int64_t *at) {
    int64_t most = g->end;
    int32_t q, k;
    for (q = begin; q < end; q++) {
        const int32_t v = list ? list[q] : q;
        const int64_t u = s->row_ptr[v + 1] - s->row_ptr[v];
        at[v] = hdi_gaps_take(g, triangle ? hdi_triangle(u) : u);
        if (g->end > most) most = g->end;
        for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
            const int64_t below = s->row_ptr[s->kid[k] + 1] - s->row_ptr[s->kid[k]];
            hdi_gaps_free(g, at[s->kid[k]], triangle ? hdi_triangle(below) : below);
        }
    }
    return most;
}

/* The whole plan: a space of its own for every subtree, of which only what its roots leave behind stays; the top takes what it finds free.
 * roots: as many pairs as supernodes. Returns the size of it all. */
static int64_t hdi_sym_spaces(const hdi_symbolic *s, hdi_gaps *g, int triangle, int64_t *at, hdi_pair *roots) {
    int64_t base = 0, from = 0, n_roots = 0, i;
    int32_t k, v;
    for (k = 0; k < s->n_tasks; k++) {
        g->n = 0;
        g->end = base;
        base = hdi_sym_place(s, g, NULL, s->task_begin[k], s->task_end[k], triangle, at);
    }
    for (k = 0; k < s->n_top; k++) {
        for (v = s->kid_ptr[s->top[k]]; v < s->kid_ptr[s->top[k] + 1]; v++) {
            const int32_t c = s->kid[v];
            const int64_t u = s->row_ptr[c + 1] - s->row_ptr[c];
            if (s->task_of[c] < 0 || u == 0) continue;
            roots[n_roots].key = HDI_CAST(uint64_t, at[c]);
            roots[n_roots++].id = triangle ? hdi_triangle(u) : u;
        }
    }
    hdi_sort_pairs(roots, n_roots);
    g->n = 0;
    g->end = base + 1;                           /* so that no gap touches it */
    for (i = 0; i <= n_roots; i++) {
        const int64_t to = i < n_roots ? HDI_CAST(int64_t, roots[i].key) : base;
        hdi_gaps_free(g, from, to - from);
        if (i < n_roots) from = to + roots[i].id;
    }
    return hdi_sym_place(s, g, s->top, 0, s->n_top, triangle, at);
}

/* Work of a front, in multiply-adds or so: the sum of its squared column lengths, and a little for its being there. */
static double hdi_sym_front_work(double m, double p) {
    const double u = m - p;
    return p * u * u + u * p * p + p * p * p / 3 + 40 * m;
}

/* Cuts the forest into subtrees of at most a 48th of the work, which can go on at the same time, small neighbours together; the rest is the top, where the
 * fronts are large enough to be shared. Then places the update matrices. */
static hd_status hdi_sym_plan(hdi_symbolic *s, hdi_scope *scope) {
    int32_t *task = s->task_of, v, k;
    hdi_pair *roots = HDI_TAKE(scope, hdi_pair, HDI_CAST(int64_t, s->n_super) + 1);
    hdi_gaps gaps;
    double *sum = HDI_TAKE_ZERO(scope, double, HDI_CAST(int64_t, s->n_super) + 1), total = 0, open = 0, limit;
    gaps.room = 1024;
    gaps.at = HDI_TAKE(scope, int64_t, gaps.room);
    gaps.size = HDI_TAKE(scope, int64_t, gaps.room);
    if (scope->e->status < 0) return scope->e->status;
    for (v = 0; v < s->n_super; v++) {
        const double work = hdi_sym_front_work(HDI_CAST(double, s->super[v + 1] - s->super[v] + s->row_ptr[v + 1] - s->row_ptr[v]), s->super[v + 1] - s->super[v]);
        sum[v] += work;
        total += work;
        if (s->parent[v] >= 0) sum[s->parent[v]] += sum[v];
    }
    limit = hdi_max(total / 48, 1e5);
    for (v = s->n_super; v-- > 0;) {
        const int32_t up = s->parent[v];
        task[v] = sum[v] > limit ? -1 : up < 0 || task[up] == -1 ? v : task[up];   /* -1: top; else the subtree's root */
    }
    s->n_tasks = s->n_top = 0;
    for (v = 0; v < s->n_super; v++) {
        if (task[v] < 0) {
            s->top[s->n_top++] = v;
            open = HUGE_VAL;                     /* a top node in between ends a task, whose supernodes are consecutive */
            continue;
        }
        if (v > 0 && task[v - 1] == task[v]) {
            s->task_end[s->n_tasks - 1] = v + 1;
            continue;
        }
        if (v > 0 && task[v - 1] >= 0 && open + sum[task[v]] <= limit) {
            open += sum[task[v]];
        } else {
            s->task_begin[s->n_tasks++] = v;
            open = sum[task[v]];
        }
        s->task_end[s->n_tasks - 1] = v + 1;
    }
    for (k = 0; k < s->n_tasks; k++) {
        for (v = s->task_begin[k]; v < s->task_end[k]; v++) {
            task[v] = k;
            if (s->super[v + 1] - s->super[v] > s->task_pivots) s->task_pivots = s->super[v + 1] - s->super[v];
            if (s->row_ptr[v + 1] - s->row_ptr[v] > s->task_update) s->task_update = HDI_CAST(int32_t, s->row_ptr[v + 1] - s->row_ptr[v]);
        }
    }
    s->work = hdi_sym_spaces(s, &gaps, 1, s->update, roots);
    s->vector_size = hdi_sym_spaces(s, &gaps, 0, s->vector, roots);
    return HD_OK;
}

/* Children lists of the supernodes. */
static void hdi_sym_kids(hdi_symbolic *s) {
    int32_t v, sum = 0;
    memset(s->kid_ptr, 0, (HDI_CAST(size_t, s->n_super) + 1) * sizeof *s->kid_ptr);
    for (v = 0; v < s->n_super; v++)
        if (s->parent[v] >= 0) s->kid_ptr[s->parent[v]]++;
    for (v = 0; v < s->n_super; v++) {
        const int32_t count = s->kid_ptr[v];
        s->kid_ptr[v] = sum;
        sum += count;
    }
    for (v = 0; v < s->n_super; v++)
        if (s->parent[v] >= 0) s->kid[s->kid_ptr[s->parent[v]]++] = v;
    for (v = s->n_super; v > 0; v--) s->kid_ptr[v] = s->kid_ptr[v - 1];
    s->kid_ptr[0] = 0;
}

/* Rows below the pivots: row i of L is a subtree of the supernodes' tree, walked up from the entries of row i of A; i ascends, so do the lists.
 * fill [n_super] 64 bit, mark [n_super]. */
static void hdi_sym_rows(hdi_symbolic *s, const int64_t *lower_ptr, const int32_t *lower, int64_t *fill, int32_t *mark) {
    int32_t i, v;
    int64_t p;
    for (v = 0; v < s->n_super; v++) {
        fill[v] = s->row_ptr[v];
        mark[v] = -1;
    }
    for (i = 0; i < s->n; i++)
        for (p = lower_ptr[i]; p < lower_ptr[i + 1]; p++)
            for (v = s->super_of[lower[p]]; v != s->super_of[i] && mark[v] != i; v = s->parent[v]) {
                mark[v] = i;
                s->row[fill[v]++] = i;
            }
    for (v = 0; v < s->n_super; v++) {           /* places in the parent's front: two ascending lists */
        const int32_t up = s->parent[v];
        int64_t q;
        s->inner[v] = 0;
        if (up < 0) continue;
        q = s->row_ptr[up];
        for (p = s->row_ptr[v]; p < s->row_ptr[v + 1]; p++) {
            if (s->row[p] < s->super[up + 1]) {
                s->inner[v]++;
                s->rel[p] = s->row[p] - s->super[up];
                continue;
            }
            while (s->row[q] != s->row[p]) q++;
            s->rel[p] = HDI_CAST(int32_t, q - s->row_ptr[up]) + s->super[up + 1] - s->super[up];
        }
    }
}

/* The lower triangle of P A P' by rows, as in hdi_sym_lower, and by columns with the entries' places in A, in one pass over A; the latter still in
 * rows and columns of the whole matrix. inv [n] gets the inverse of the order. */
static void hdi_sym_gather(hdi_symbolic *s, const hd_csr *a, int32_t *inv, int64_t *lower_ptr, int32_t *lower) {
    int64_t p, q = 0, below = 0;
    int32_t v, j;
    for (j = 0; j < s->n; j++) inv[s->perm[j]] = j;
    for (v = 0; v < s->n_super; v++) {
        s->a_ptr[v] = q;
        for (j = s->super[v]; j < s->super[v + 1]; j++) {
            lower_ptr[j] = below;
            if (j + HDI_ROWS_AHEAD < s->n) HDI_PREFETCH(a->col + a->row_ptr[s->perm[j + HDI_ROWS_AHEAD]]);
            for (p = a->row_ptr[s->perm[j]]; p < a->row_ptr[s->perm[j] + 1]; p++) {
                const int32_t i = inv[a->col[p]];
                if (i < j) {
                    lower[below++] = i;
                    continue;
                }
                s->a_from[q] = p;
                s->a_row[q] = i;
                s->a_col[q++] = j;
            }
        }
    }
    s->a_ptr[v] = q;
    lower_ptr[s->n] = below;
}

/* Rows and columns of the entries within the fronts. place [n]. */
static void hdi_sym_entries(hdi_symbolic *s, int32_t *place) {
    int32_t v;
    int64_t p;
    for (v = 0; v < s->n_super; v++) {
        const int32_t begin = s->super[v], end = s->super[v + 1];
        for (p = s->row_ptr[v]; p < s->row_ptr[v + 1]; p++) place[s->row[p]] = HDI_CAST(int32_t, p - s->row_ptr[v]) + end - begin;
        for (p = s->a_ptr[v]; p < s->a_ptr[v + 1]; p++) {
            const int32_t i = s->a_row[p];
            s->a_row[p] = i < end ? i - begin : place[i];
            s->a_col[p] -= begin;
        }
    }
}

/* Elimination tree, postorder and column counts; perm becomes postordered. The arrays of counts' work are borrowed from w [7 n]. */
static void hdi_sym_tree(const hd_csr *a, int32_t *perm, int32_t *parent, int32_t *count, int64_t *ptr, int32_t *col, int64_t *up_ptr, int32_t *up,
                         int32_t *w) {
    const int32_t n = a->n_rows;
    int32_t *inv = w, *post = w + n, *old = w + 2 * HDI_CAST(int64_t, n), *tmp = w + 3 * HDI_CAST(int64_t, n), i;
    int64_t p;
    hdi_sym_lower(a, perm, inv, ptr, col);
    hdi_sym_etree(n, ptr, col, parent, tmp);
    hdi_sym_postorder(n, parent, post, tmp, tmp + n, tmp + 2 * HDI_CAST(int64_t, n));
    memcpy(old, parent, HDI_CAST(size_t, n) * sizeof *old);
    for (i = 0; i < n; i++) inv[post[i]] = i;    /* old place -> new place */
    for (i = 0; i < n; i++) parent[i] = old[post[i]] < 0 ? -1 : inv[old[post[i]]];
    memset(up_ptr, 0, (HDI_CAST(size_t, n) + 1) * sizeof *up_ptr);
    for (p = 0; p < ptr[n]; p++) up_ptr[inv[col[p]]]++;
    hdi_prefix_sum(up_ptr, n);
    for (i = 0; i < n; i++)
        for (p = ptr[post[i]]; p < ptr[post[i] + 1]; p++) up[up_ptr[inv[col[p]]]++] = i;
    for (i = n; i > 0; i--) up_ptr[i] = up_ptr[i - 1];
    up_ptr[0] = 0;
    hdi_sym_counts(n, up_ptr, up, parent, count, tmp, tmp + n, tmp + 2 * HDI_CAST(int64_t, n), old);
    for (i = 0; i < n; i++) old[i] = perm[post[i]];
    memcpy(perm, old, HDI_CAST(size_t, n) * sizeof *perm);
}

/* Numbers the supernodes and their columns. perm comes in postordered, and leaves in elimination order. */
static void hdi_sym_number(hdi_symbolic *s, const hdi_node *node, const int32_t *order, const int32_t *next_col, const int32_t *perm, int32_t *number) {
    int32_t k, c, i = 0;
    s->super[0] = 0;
    s->row_ptr[0] = s->panel[0] = s->panel_pack[0] = 0;
    for (k = 0; k < s->n_super; k++) number[order[k]] = k;
    for (k = 0; k < s->n_super; k++) {
        const hdi_node *v = node + order[k];
        const int64_t m = v->rows, p = v->pivots;
        for (c = v->first; c >= 0; c = next_col[c]) {
            s->perm[i] = perm[c];
            s->super_of[i++] = k;
        }
        s->super[k + 1] = i;
        s->parent[k] = v->parent < 0 ? -1 : number[v->parent];
        s->row_ptr[k + 1] = s->row_ptr[k] + m - p;
        s->panel[k + 1] = s->panel[k] + m * p;
        s->panel_pack[k + 1] = s->panel_pack[k] + hdi_panel_block(m, p, p / HDI_PANEL + 1);
        if (m > s->largest_front) s->largest_front = v->rows;
        if (p > s->largest_pivots) s->largest_pivots = v->pivots;
        if (m - p > s->largest_update) s->largest_update = v->rows - v->pivots;
        for (c = 0; c < p; c++) s->flops_done += HDI_CAST(double, m - c) * HDI_CAST(double, m - c);
    }
    s->stored = s->panel_pack[s->n_super];
}

/* The analysis of a symmetric pattern under the order perm, which is used up. */
static hd_status hdi_symbolic_make(hdi_symbolic *s, const hd_csr *a, int32_t *perm, hd_context *ctx, hd_error *e) {
    hdi_scope w = hdi_scope_begin(ctx, e), keep = hdi_scope_begin(ctx, e);
    const int32_t n = a->n_rows;
    const uint64_t n1 = HDI_CAST(uint64_t, n) + 1, half = HDI_CAST(uint64_t, a->nnz);
    uint64_t supers;
    int32_t *parent = HDI_TAKE(&w, int32_t, n1), *count = HDI_TAKE(&w, int32_t, n1), *lower = HDI_TAKE(&w, int32_t, half);
    int32_t *upper = HDI_TAKE(&w, int32_t, half), *work = HDI_TAKE(&w, int32_t, 7 * n1), i, n_nodes;
    int64_t *lower_ptr = HDI_TAKE(&w, int64_t, n1), *upper_ptr = HDI_TAKE(&w, int64_t, n1);
    hdi_node *node = HDI_TAKE(&w, hdi_node, n1);
    hdi_pair *pairs = HDI_TAKE(&w, hdi_pair, n1);
    memset(s, 0, sizeof *s);
    s->n = n;
    if (e->status < 0) return hdi_scope_end(&w);
    hdi_sym_tree(a, perm, parent, count, lower_ptr, lower, upper_ptr, upper, work);
    if (hdi_progress(ctx, "analyse", 0.4, e) < 0) return hdi_scope_end(&w);
    for (i = 0; i < n; i++) {
        s->nnz += count[i];
        s->flops += HDI_CAST(double, count[i]) * count[i];
    }
    n_nodes = hdi_sym_supernodes(n, parent, count, node, work, work + n1);     /* work: next_col */
    hdi_sym_relax(node, n_nodes, work, work + n1, work + 2 * n1);
    s->n_super = hdi_sym_order_nodes(node, n_nodes, work + n1, upper_ptr, work + 2 * n1, work + 3 * n1, work + 4 * n1, pairs);
    supers = HDI_CAST(uint64_t, s->n_super) + 1;
    s->perm = HDI_TAKE(&keep, int32_t, n1);
    s->super_of = HDI_TAKE(&keep, int32_t, n1);
    s->super = HDI_TAKE(&keep, int32_t, supers);
    s->parent = HDI_TAKE(&keep, int32_t, supers);
    s->inner = HDI_TAKE(&keep, int32_t, supers);
    s->row_ptr = HDI_TAKE(&keep, int64_t, supers);
    s->panel_pack = HDI_TAKE(&keep, int64_t, supers);
    s->panel = HDI_TAKE(&keep, int64_t, supers);
    s->update = HDI_TAKE(&keep, int64_t, supers);
    s->vector = HDI_TAKE(&keep, int64_t, supers);
    s->a_ptr = HDI_TAKE(&keep, int64_t, supers);
    s->kid_ptr = HDI_TAKE(&keep, int32_t, supers);
    s->kid = HDI_TAKE(&keep, int32_t, supers);
    s->task_begin = HDI_TAKE(&keep, int32_t, supers);
    s->task_end = HDI_TAKE(&keep, int32_t, supers);
    s->task_of = HDI_TAKE(&keep, int32_t, supers);
    s->top = HDI_TAKE(&keep, int32_t, supers);
    if (e->status >= 0) hdi_sym_number(s, node, work + n1, work, perm, work + 2 * n1);
    s->row = HDI_TAKE(&keep, int32_t, e->status < 0 ? 0 : s->row_ptr[s->n_super]);
    s->rel = HDI_TAKE(&keep, int32_t, e->status < 0 ? 0 : s->row_ptr[s->n_super]);
    s->a_from = HDI_TAKE(&keep, int64_t, e->status < 0 ? 0 : lower_ptr[n] + n);
    s->a_row = HDI_TAKE(&keep, int32_t, e->status < 0 ? 0 : lower_ptr[n] + n);
    s->a_col = HDI_TAKE(&keep, int32_t, e->status < 0 ? 0 : lower_ptr[n] + n);
    if (e->status >= 0 && hdi_progress(ctx, "analyse", 0.6, e) >= 0) {
        hdi_sym_gather(s, a, work, lower_ptr, lower);
        hdi_sym_rows(s, lower_ptr, lower, upper_ptr, work + n1);
        hdi_sym_entries(s, work + n1);
        hdi_sym_kids(s);
        hdi_sym_plan(s, &w);
    }
    hdi_scope_end(&w);
    if (e->status < 0) {
        hdi_scope_end(&keep);
        memset(s, 0, sizeof *s);
        return e->status;
    }
    keep.n = 0;                                  /* all of it is the caller's now */
    return HD_OK;
}

/* ---- choice ---- */

/* From so many rows on nested dissection pays for itself: it takes three times as long to find as minimum degree, and saves half of the flops. For the poles of a
 * set that is soon, for one real factor and some solves late. Wide rows, those of exponential weights, make factors so large that it pays at once where
 * it has fewer flops: of minimum degree's, 1.07, 0.85, 0.68, 0.49 with 10, 20, 50, 150 thousand random points and 233 non-zeros a row. */
enum { HDI_DISSECT_FROM = 40000, HDI_DISSECT_REAL_FROM = 250000, HDI_DISSECT_WIDE_FROM = 15000, HDI_DISSECT_WIDE = 40 };

static hd_status hdi_sym_check(const int32_t *perm, int32_t n, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    char *seen = HDI_CAST(char *, hdi_take_zero(&s, HDI_CAST(uint64_t, n) + 1, 1));
    int32_t i;
    for (i = 0; seen && i < n && !e->status; i++) {
        if (perm[i] < 0 || perm[i] >= n || seen[perm[i]]) hdi_fail_row(e, HD_ERR_INDEX, "ordering: not a permutation", i, -1, perm[i]);
        else seen[perm[i]] = 1;
    }
    return hdi_scope_end(&s);
}

/* An elimination order of a symmetric pattern, of the given kind or by size (dissect_from). xyz may be NULL; own with HD_ORDERING_OWN. chosen: the kind. */
static hd_status hdi_sym_order(const hd_csr *a, const double *xyz, hd_ordering kind, int32_t dissect_from, const int32_t *own, int32_t *perm, int32_t *chosen, hd_context *ctx,
                               hd_error *e) {
    const int32_t n = a->n_rows;
    hdi_error_clear(e);
    if (a->nnz > HDI_DISSECT_WIDE * HDI_CAST(int64_t, n) && dissect_from > HDI_DISSECT_WIDE_FROM) dissect_from = HDI_DISSECT_WIDE_FROM;
    if (kind == HD_ORDERING_AUTO) kind = xyz && n >= dissect_from ? HD_ORDERING_NESTED_DISSECTION : HD_ORDERING_MINIMUM_DEGREE;
    *chosen = HDI_CAST(int32_t, kind);
    if (hdi_progress(ctx, "order", 0, e) < 0) return e->status;
    if (kind == HD_ORDERING_MINIMUM_DEGREE) return hdi_sym_minimum_degree(a, perm, ctx, e);
    if (kind == HD_ORDERING_NESTED_DISSECTION)
        return xyz ? hdi_sym_nested_dissection(a, xyz, perm, ctx, e) : hdi_fail(e, HD_ERR_ARGUMENT, "ordering: nested dissection needs coordinates");
    if (kind != HD_ORDERING_OWN) return hdi_fail(e, HD_ERR_ARGUMENT, "ordering: unknown kind");
    if (!own && n > 0) return hdi_fail(e, HD_ERR_ARGUMENT, "ordering: own, but no permutation is given");
    if (n > 0) memcpy(perm, own, HDI_CAST(size_t, n) * sizeof *perm);
    return hdi_sym_check(own, n, ctx, e);
}

/* ==== [12] direct ====
 * LDL' without pivoting on the supernodes of [11], multifrontal, for real matrices and for packs of four complex-symmetric ones (plain transpose, never
 * conjugated), and the triangular solves. May call [11].
 * This work is based on
 *   I. Duff, J. Reid, The multifrontal solution of indefinite sparse symmetric linear equations, 1983
 *   J. Liu, The multifrontal method for sparse matrix solution, 1992
 *   N. Higham, Factorizing complex symmetric matrices with positive definite real and imaginary parts, 1998 (why no pivoting is needed for poles: rotated
 *   by half the argument of theta, t L + theta B has a positive definite real part)
 * Deviation from the textbook: a front never exists as one matrix. Its panel is assembled where L will stand; its update matrix starts as -L21 D L21'
 * and the children's are added afterwards, so that it is neither cleared nor read before. */

enum { HDI_FRONT_COLS = 96, HDI_FRONT_CHUNK = 96 };

/* Where values of A come from: real numbers, up to four complex matrices, or t L + theta B, by entries of the pattern that was analysed. */
typedef struct hdi_values {
    const double *real;
    const hd_c64 *z[4];
    const double *l, *b, *b_diag;    /* b NULL: B is diagonal, b_diag by rows */
    double t;
    hd_c64 theta[4];
} hdi_values;

/* What the pivots of a part of the tree looked like. */
typedef struct hdi_pivots {
    double largest, smallest;        /* absolute values, over all matrices */
    int64_t negative;                /* real pivots below zero */
    int32_t failed, lane;            /* pivot that cannot be divided by, -1 none; its matrix */
    double value;
} hdi_pivots;

typedef struct hdi_factor {
    const hdi_symbolic *sym;
    hd_context *ctx;
    int32_t width;                   /* doubles per entry: 1 real, 8 pack */
    const hdi_pack_ops *pack;
    const hdi_real_ops *real;
    double *panel, *dinv;            /* [sym->stored], [n] entries */
    double *work;                    /* [sym->work] entries: update matrices */
    double *scratch;                 /* [n_tasks + 1][scratch_size], the last one larger: for the top */
    double *chunk_scratch;           /* [chunks of the largest front][chunk_size] */
    uint64_t scratch_size, chunk_size;   /* doubles */
    hdi_pivots *pivots;              /* [n_tasks + 1] */
    hdi_pivots all;                  /* of the last factorisation */
    double largest_entry;            /* |diagonal entry of A|, the largest */
    int32_t ready;
    /* a factorisation under way */
    const hdi_values *values;
    int32_t stop;
    double share;
    hd_error error;
} hdi_factor;

static int32_t hdi_front_pivots(const hdi_symbolic *s, int32_t v) { return s->super[v + 1] - s->super[v]; }
static int64_t hdi_front_below(const hdi_symbolic *s, int32_t v) { return s->row_ptr[v + 1] - s->row_ptr[v]; }

/* First place in the ascending rel[0..n) that is at least x. */
static int64_t hdi_lower_bound(const int32_t *rel, int64_t n, int64_t x) {
    int64_t lo = 0;
    while (n > 0) {
        const int64_t half = n / 2;
        if (rel[lo + half] < x) {
            lo += half + 1;
            n -= half + 1;
        } else {
            n = half;
        }
    }
    return lo;
}

static void hdi_pivots_clear(hdi_pivots *q) {
    memset(q, 0, sizeof *q);
    q->smallest = HUGE_VAL;
    q->failed = -1;
}

static void hdi_pivots_note(hdi_pivots *q, double size) {
    if (size > q->largest) q->largest = size;
    if (size < q->smallest) q->smallest = size;
}

/* ---- packs ---- */

/* One entry of A for four matrices. */
static void hdi_pack_value(const hdi_values *a, int64_t from, int diagonal, int32_t row, double *to) {
    int q;
    if (a->l) {
        const double l = a->t * a->l[from], b = a->b ? a->b[from] : diagonal ? a->b_diag[row] : 0;
        for (q = 0; q < 4; q++) {
            to[q] = l + a->theta[q].re * b;
            to[q + 4] = a->theta[q].im * b;
        }
        return;
    }
    for (q = 0; q < 4; q++) {
        to[q] = a->z[q][from].re;
        to[q + 4] = a->z[q][from].im;
    }
}

/* A block of columns of a panel of packs: columns [begin,begin+width), rows from begin on. at: its entry (0,0), were it there. */
typedef struct hdi_pack_block { double *at; int64_t begin, width, row; } hdi_pack_block;

static hdi_pack_block hdi_pack_block_of(double *panel, int64_t m, int64_t p, int64_t q) {
    hdi_pack_block b;
    b.begin = q * HDI_PANEL;
    b.width = hdi_least(p - b.begin, HDI_PANEL);
    b.row = HDI_PACK * b.width;
    b.at = panel + HDI_PACK * hdi_panel_block(m, p, q);
    return b;
}

/* Entry (i,k) of the front, i at least the block's first row. */
static double *hdi_pack_at(const hdi_pack_block *b, int64_t i, int64_t k) { return b->at + (i - b->begin) * b->row + HDI_PACK * (k - b->begin); }

/* Rows [r0,r1) of the panel of front v: cleared, entries of A, children. */
static void hdi_pack_assemble(const hdi_factor *f, int32_t v, int64_t r0, int64_t r1) {
    const hdi_symbolic *s = f->sym;
    const int64_t p = hdi_front_pivots(s, v), m = p + hdi_front_below(s, v);
    double *panel = f->panel + HDI_PACK * s->panel_pack[v];
    int64_t q, a, n, last;
    int32_t k;
    for (q = 0; q * HDI_PANEL < p; q++) {
        const hdi_pack_block b = hdi_pack_block_of(panel, m, p, q);
        const int64_t begin = r0 > b.begin ? r0 : b.begin;
        if (begin < r1) memset(hdi_pack_at(&b, begin, b.begin), 0, HDI_CAST(size_t, (r1 - begin) * b.row) * sizeof *panel);
    }
    for (n = s->a_ptr[v]; n < s->a_ptr[v + 1]; n++) {
        const int64_t i = s->a_row[n], j = s->a_col[n];
        if (i >= r0 && i < r1) {
            const hdi_pack_block b = hdi_pack_block_of(panel, m, p, j / HDI_PANEL);
            hdi_pack_value(f->values, s->a_from[n], i == j, s->perm[s->super[v] + j], hdi_pack_at(&b, i, j));
        }
    }
    for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
        const int32_t c = s->kid[k], *rel = s->rel + s->row_ptr[c];
        const int64_t u = hdi_front_below(s, c), from = hdi_lower_bound(rel, u, r0), end = hdi_lower_bound(rel, u, r1);
        const double *child = f->work + HDI_PACK * s->update[c];
        int64_t b0 = 0, b1;
        for (q = 0; q * HDI_PANEL < p && b0 < u; q++, b0 = b1) {   /* the child's columns that fall into block q */
            const hdi_pack_block b = hdi_pack_block_of(panel, m, p, q);
            b1 = hdi_lower_bound(rel, u, b.begin + b.width);
            for (a = from > b0 ? from : b0; a < end; a++) {
                last = a < b1 ? a + 1 : b1;
                f->pack->add(hdi_pack_at(&b, rel[a], b.begin), child + HDI_PACK * hdi_triangle(a), rel, b0, last, b.begin);
            }
        }
    }
}

/* Children's update matrices into rows [r0,r1) of that of front v. */
static void hdi_pack_extend(const hdi_factor *f, int32_t v, int64_t r0, int64_t r1) {
    const hdi_symbolic *s = f->sym;
    const int64_t p = hdi_front_pivots(s, v);
    double *update = f->work + HDI_PACK * s->update[v];
    int64_t a;
    int32_t k;
    for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
        const int32_t c = s->kid[k], *rel = s->rel + s->row_ptr[c];
        const int64_t u = hdi_front_below(s, c), inner = s->inner[c], end = hdi_lower_bound(rel, u, p + r1);
        const double *from = f->work + HDI_PACK * s->update[c];
        for (a = hdi_lower_bound(rel, u, p + r0); a < end; a++)
            f->pack->add(update + HDI_PACK * hdi_triangle(rel[a] - p), from + HDI_PACK * hdi_triangle(a), rel, inner, a + 1, p);
    }
}

/* The parts of one front, and room to work in. */
typedef struct hdi_front {
    double *panel, *update, *dinv;   /* where they stand; dinv of the first pivot */
    double *d, *S;                   /* [p] pivots, [block of pivots][p] scaled rows of L: S_ik = l_ik d_k */
    int64_t m, p, u, k0;
    int32_t nb, first;               /* block of pivots [k0,k0+nb) under way; number of the first pivot */
} hdi_front;

/* Entries (i,k0..k0+nb) of rows [r0,r1): minus sum_{k < k0} l_ik s_jk, block by block of the columns before; S is by rows of k0 + nb entries. */
static void hdi_pack_before(const hdi_factor *f, const hdi_front *w, int64_t r0, int64_t r1, int lower) {
    const hdi_pack_block to = hdi_pack_block_of(w->panel, w->m, w->p, w->k0 / HDI_PANEL);
    hdi_pack_job g;
    int64_t q;
    memset(&g, 0, sizeof g);
    g.a_col = g.b_col = HDI_PACK;
    g.b_row = HDI_PACK * (w->k0 + w->nb);
    g.c = hdi_pack_at(&to, r0, w->k0);
    g.c_row = to.row;
    g.lower = lower;
    for (q = 0; q * HDI_PANEL < w->k0; q++) {
        const hdi_pack_block b = hdi_pack_block_of(w->panel, w->m, w->p, q);
        g.a = hdi_pack_at(&b, r0, b.begin);
        g.a_row = b.row;
        g.b = w->S + HDI_PACK * b.begin;
        g.depth = w->k0 - b.begin < b.width ? w->k0 - b.begin : b.width;
        f->pack->multiply(&g, 0, r1 - r0, 0, w->nb);
    }
}

static hdi_pack_rows hdi_pack_rows_of(const hdi_front *w) {
    const hdi_pack_block b = hdi_pack_block_of(w->panel, w->m, w->p, w->k0 / HDI_PANEL);
    hdi_pack_rows r;
    r.panel = hdi_pack_at(&b, b.begin, w->k0);
    r.row = b.row;
    r.first = b.begin;
    r.s = w->S + HDI_PACK * w->k0;
    r.s_row = HDI_PACK * (w->k0 + w->nb);
    r.dinv = w->dinv + HDI_PACK * w->k0;
    r.nb = w->nb;
    return r;
}

/* Pivots [k0,k0+nb): their rows of L and S, left-looking. 0 when one cannot be divided by. */
static int hdi_pack_pivots(const hdi_factor *f, const hdi_front *w, hdi_pivots *note) {
    const int64_t k0 = w->k0, s_row = HDI_PACK * (k0 + w->nb);
    const hdi_pack_block own = hdi_pack_block_of(w->panel, w->m, w->p, k0 / HDI_PANEL);
    hdi_pack_rows r = hdi_pack_rows_of(w);
    int64_t q;
    int32_t i, j;
    int c;
    for (q = 0; q * HDI_PANEL < k0; q++) {
        const hdi_pack_block b = hdi_pack_block_of(w->panel, w->m, w->p, q);
        const int64_t end = k0 - b.begin < b.width ? k0 - b.begin : b.width;
        for (i = 0; i < w->nb; i++) {
            const double *l = hdi_pack_at(&b, k0 + i, b.begin);
            f->pack->scale(l, 0, 0, 1, 0, end, w->d + HDI_PACK * b.begin, w->S + i * s_row + HDI_PACK * b.begin);
        }
    }
    hdi_pack_before(f, w, k0, k0 + w->nb, 1);
    for (i = 0; i < w->nb; i++) {
        double *x = hdi_pack_at(&own, k0 + i, k0), *d = w->d + HDI_PACK * (k0 + i), *s = w->S + i * s_row + HDI_PACK * k0, t[HDI_PACK];
        r.nb = i;
        if (i > 0) f->pack->solve_rows(&r, k0 + i, k0 + i + 1);
        memcpy(d, x + HDI_PACK * i, HDI_PACK * sizeof *d);
        for (j = 0; j < i; j++) {
            hdi_pack_times(x + HDI_PACK * j, w->d + HDI_PACK * (k0 + j), s + HDI_PACK * j);
            hdi_pack_times(x + HDI_PACK * j, s + HDI_PACK * j, t);
            for (c = 0; c < HDI_PACK; c++) d[c] -= t[c];
        }
        for (c = 0; c < 4; c++) {
            const double size = hdi_pythag(d[c], d[c + 4]);
            hd_c64 one = hdi_c(0, 0);
            if (hdi_finite(size) && size > 0) one = hdi_cdiv(hdi_c(1, 0), hdi_c(d[c], d[c + 4]));
            if (!hdi_finite(size) || !(size > 0) || !hdi_cfinite(one)) {
                note->failed = w->first + HDI_CAST(int32_t, k0) + i;
                note->lane = c;
                note->value = size;
                return 0;
            }
            hdi_pivots_note(note, size);
            w->dinv[HDI_PACK * (k0 + i) + c] = one.re;
            w->dinv[HDI_PACK * (k0 + i) + c + 4] = one.im;
        }
    }
    return 1;
}

/* Columns [k0,k0+nb) of L in rows [r0,r1) of the front. */
static void hdi_pack_columns(const hdi_factor *f, const hdi_front *w, int64_t r0, int64_t r1) {
    const hdi_pack_rows r = hdi_pack_rows_of(w);
    hdi_pack_before(f, w, r0, r1, 0);
    f->pack->solve_rows(&r, r0, r1);
}

/* Rows [r0,r1) of U = -L21 D L21'. S: room for HDI_FRONT_COLS rows of HDI_PACK_DEPTH entries. */
static void hdi_pack_update(const hdi_factor *f, const hdi_front *w, double *S, int64_t r0, int64_t r1) {
    hdi_pack_job g;
    int64_t k, j;
    memset(&g, 0, sizeof g);
    g.c = w->update;
    g.a_col = g.b_col = HDI_PACK;
    g.lower = g.packed = 1;
    for (k = 0; k < w->p; k += HDI_PACK_DEPTH) {
        const hdi_pack_block b = hdi_pack_block_of(w->panel, w->m, w->p, k / HDI_PANEL);
        g.depth = hdi_least(w->p - k, HDI_PACK_DEPTH);
        g.store = k == 0;
        g.a = hdi_pack_at(&b, w->p, k);
        g.a_row = b.row;
        g.b = S;
        g.b_row = HDI_PACK * g.depth;
        for (j = 0; j < r1; j += HDI_FRONT_COLS) {
            const int64_t end = j + HDI_FRONT_COLS < r1 ? j + HDI_FRONT_COLS : r1;
            f->pack->scale(g.a, b.row, j, end, 0, g.depth, w->d + HDI_PACK * k, S);
            g.b_first = j;
            f->pack->multiply(&g, r0 > j ? r0 : j, r1, j, end);
        }
    }
}

/* ---- fronts ---- */

/* Doubles of scratch for fronts of at most so many pivots and rows below: of packs their pivots, their block of scaled rows, and a block of columns of the
 * update; of real ones the scaled rows, and the work of their kernels. */
static uint64_t hdi_front_scratch(int32_t pivots, int32_t below, int32_t width) {
    const uint64_t p = HDI_CAST(uint64_t, pivots), rows = p * HDI_PACK_BLOCK;
    const uint64_t cols = HDI_CAST(uint64_t, hdi_least(below, HDI_FRONT_COLS) * hdi_least(pivots, HDI_PACK_DEPTH));
    if (width == 1) return HDI_CAST(uint64_t, hdi_real_s_size(pivots) + hdi_real_work(below, pivots)) + 64;
    return HDI_PACK * (p + (rows > cols ? rows : cols)) + 64;
}

static hdi_front hdi_front_open(const hdi_factor *f, int32_t v, double *scratch) {
    const hdi_symbolic *s = f->sym;
    hdi_front w;
    w.p = hdi_front_pivots(s, v);
    w.u = hdi_front_below(s, v);
    w.m = w.p + w.u;
    w.panel = f->panel + f->width * (f->width == 1 ? s->panel[v] : s->panel_pack[v]);
    w.update = f->work + f->width * s->update[v];
    w.dinv = f->dinv + HDI_CAST(int64_t, f->width) * s->super[v];
    w.d = scratch;                               /* real pivots stay on the diagonal */
    w.S = f->width == 1 ? scratch : scratch + HDI_PACK * w.p;
    w.k0 = 0;
    w.nb = 0;
    w.first = s->super[v];
    return w;
}

/* Rows [r0,r1) of the update matrix of v, complete. */
static void hdi_pack_update_rows(const hdi_factor *f, const hdi_front *w, int32_t v, double *S, int64_t r0, int64_t r1) {
    if (r1 <= r0) return;
    hdi_pack_update(f, w, S, r0, r1);
    hdi_pack_extend(f, v, r0, r1);
}

static int hdi_pack_factor(const hdi_factor *f, int32_t v, double *scratch, hdi_pivots *note) {
    hdi_front w = hdi_front_open(f, v, scratch);
    hdi_pack_assemble(f, v, 0, w.m);
    for (; w.k0 < w.p; w.k0 += w.nb) {
        w.nb = HDI_CAST(int32_t, hdi_least(w.p - w.k0, HDI_PACK_BLOCK));
        if (!hdi_pack_pivots(f, &w, note)) return 0;
        if (w.k0 + w.nb < w.m) hdi_pack_columns(f, &w, w.k0 + w.nb, w.m);
    }
    hdi_pack_update_rows(f, &w, v, w.S, 0, w.u);
    return 1;
}

/* ---- real fronts ---- */

/* Panel and update matrix of v: cleared, and the entries of A. */
static void hdi_real_assemble(const hdi_factor *f, int32_t v, const hdi_front *w) {
    const hdi_symbolic *s = f->sym;
    const hdi_values *a = f->values;
    int64_t q;
    memset(w->panel, 0, HDI_CAST(size_t, w->m * w->p) * sizeof *w->panel);
    memset(w->update, 0, HDI_CAST(size_t, hdi_triangle(w->u)) * sizeof *w->update);
    for (q = s->a_ptr[v]; q < s->a_ptr[v + 1]; q++) {
        const int64_t from = s->a_from[q], i = s->a_row[q], j = s->a_col[q];
        double x;
        if (a->l) x = a->t * a->l[from] + a->theta[0].re * (a->b ? a->b[from] : i == j ? a->b_diag[s->perm[s->super[v] + j]] : 0);
        else x = a->real[from];
        w->panel[i + j * w->m] = x;
    }
}

/* Column [c0,c1) of the k-th child's update matrix into the front. */
static void hdi_real_child(const hdi_factor *f, const hdi_front *w, int32_t c, int64_t c0, int64_t c1) {
    const hdi_symbolic *s = f->sym;
    hdi_real_extend(f->real, w->panel, w->m, HDI_CAST(int32_t, w->p), w->update, f->work + s->update[c], hdi_front_below(s, c), s->rel + s->row_ptr[c], c0, c1);
}

static int hdi_real_pivots_of(const hdi_factor *f, const hdi_front *w, int64_t end, hdi_pivots *note, double *work) {
    hdi_real_pivots seen;
    int64_t bad;
    seen.largest = note->largest;
    seen.smallest = hdi_min(note->smallest, DBL_MAX);
    seen.negative = note->negative;
    bad = hdi_real_block(f->real, w->panel, w->m, HDI_CAST(int32_t, w->k0), w->nb, end, w->S, w->dinv, &seen, work);
    note->largest = seen.largest;
    note->smallest = seen.smallest;
    note->negative = seen.negative;
    if (bad < 0) return 1;
    note->failed = w->first + HDI_CAST(int32_t, bad);
    note->value = w->panel[bad * (w->m + 1)];
    return 0;
}

static int hdi_real_factor(const hdi_factor *f, int32_t v, double *scratch, hdi_pivots *note) {
    const hdi_symbolic *s = f->sym;
    hdi_front w = hdi_front_open(f, v, scratch);
    double *work = w.S + hdi_real_s_size(w.p);
    int32_t k;
    hdi_real_assemble(f, v, &w);
    for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) hdi_real_child(f, &w, s->kid[k], 0, hdi_front_below(s, s->kid[k]));
    for (; w.k0 < w.p; w.k0 += w.nb) {
        const int all = w.p <= HDI_REAL_NB;
        w.nb = HDI_CAST(int32_t, hdi_least(w.p - w.k0, HDI_REAL_NB));
        if (!hdi_real_pivots_of(f, &w, all ? w.m : w.k0 + w.nb, note, work)) return 0;
        if (!all && w.k0 + w.nb < w.m)
            hdi_real_rows(f->real, w.panel, w.m, HDI_CAST(int32_t, w.k0), w.nb, w.S, HDI_CAST(int32_t, w.k0) + w.nb, w.dinv, w.k0 + w.nb, w.m, work);
    }
    if (w.u > 0) hdi_real_update(f->real, w.update, w.u, w.panel, w.m, HDI_CAST(int32_t, w.p), work, 0, w.u);
    return 1;
}

/* ---- the tree ---- */

static int hdi_front_factor(const hdi_factor *f, int32_t v, double *scratch, hdi_pivots *note) {
    return f->width == 1 ? hdi_real_factor(f, v, scratch, note) : hdi_pack_factor(f, v, scratch, note);
}

static double *hdi_factor_scratch(const hdi_factor *f, int64_t i) { return f->scratch + f->scratch_size * HDI_CAST(size_t, i); }

/* A subtree, by one thread. */
static void hdi_factor_task(void *arg, int64_t index, int32_t worker) {
    hdi_factor *f = HDI_CAST(hdi_factor *, arg);
    const hdi_symbolic *s = f->sym;
    hdi_pivots *note = f->pivots + index;
    int32_t v;
    if (HDI_LOAD(&f->stop)) return;
    if (worker == 0 && hdi_progress(f->ctx, "factor", f->share * HDI_CAST(double, index) / s->n_tasks, &f->error) < 0) HDI_STORE(&f->stop, 1);
    for (v = s->task_begin[index]; v < s->task_end[index] && !HDI_LOAD(&f->stop); v++)
        if (!hdi_front_factor(f, v, hdi_factor_scratch(f, index), note)) HDI_STORE(&f->stop, 1);
}

/* A large front shared by all threads, in chunks of rows (or of a child's columns). */
typedef enum hdi_share_stage { HDI_SHARE_ASSEMBLE, HDI_SHARE_COLUMNS, HDI_SHARE_UPDATE } hdi_share_stage;

typedef struct hdi_share {
    hdi_factor *f;
    const hdi_front *w;
    int32_t v, child, n_chunks;
    hdi_share_stage stage;
    int64_t begin, end;
} hdi_share;

static void hdi_share_task(void *arg, int64_t index, int32_t worker) {
    const hdi_share *h = HDI_CAST(const hdi_share *, arg);
    const hdi_factor *f = h->f;
    const hdi_front *w = h->w;
    const int64_t chunk = h->n_chunks - 1 - index;       /* the last rows of a triangle are the longest */
    const int64_t r0 = h->begin + chunk * HDI_FRONT_CHUNK, r1 = r0 + HDI_FRONT_CHUNK < h->end ? r0 + HDI_FRONT_CHUNK : h->end;
    double *work = f->chunk_scratch + f->chunk_size * HDI_CAST(size_t, chunk);
    (void)worker;
    if (f->width > 1) {
        if (h->stage == HDI_SHARE_ASSEMBLE) hdi_pack_assemble(f, h->v, r0, r1);
        else if (h->stage == HDI_SHARE_COLUMNS) hdi_pack_columns(f, w, r0, r1);
        else hdi_pack_update_rows(f, w, h->v, work, r0, r1);
        return;
    }
    if (h->stage == HDI_SHARE_ASSEMBLE) hdi_real_child(f, w, h->child, r0, r1);
    else if (h->stage == HDI_SHARE_COLUMNS)
        hdi_real_rows(f->real, w->panel, w->m, HDI_CAST(int32_t, w->k0), w->nb, w->S, HDI_CAST(int32_t, w->k0) + w->nb, w->dinv, r0, r1, work);
    else hdi_real_update(f->real, w->update, w->u, w->panel, w->m, HDI_CAST(int32_t, w->p), work, r0, r1);
}

static void hdi_share_run(hdi_share *h, hdi_share_stage stage, int64_t begin, int64_t end) {
    if (end <= begin) return;
    h->stage = stage;
    h->begin = begin;
    h->end = end;
    h->n_chunks = HDI_CAST(int32_t, (end - begin + HDI_FRONT_CHUNK - 1) / HDI_FRONT_CHUNK);
    hdi_parallel(h->f->ctx, h->n_chunks, hdi_share_task, h);
}

static int hdi_front_shared(hdi_factor *f, int32_t v, double *scratch, hdi_pivots *note) {
    const hdi_symbolic *s = f->sym;
    hdi_front w = hdi_front_open(f, v, scratch);
    const int64_t most = f->width == 1 ? HDI_CAST(int64_t, HDI_REAL_NB) : HDI_CAST(int64_t, HDI_PACK_BLOCK);
    hdi_share h;
    int32_t k;
    h.f = f;
    h.w = &w;
    h.v = v;
    if (f->width > 1) {
        hdi_share_run(&h, HDI_SHARE_ASSEMBLE, 0, w.m);
    } else {
        hdi_real_assemble(f, v, &w);
        for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
            h.child = s->kid[k];
            hdi_share_run(&h, HDI_SHARE_ASSEMBLE, 0, hdi_front_below(s, h.child));
        }
    }
    for (; w.k0 < w.p; w.k0 += w.nb) {
        w.nb = HDI_CAST(int32_t, hdi_least(w.p - w.k0, most));
        if (!(f->width == 1 ? hdi_real_pivots_of(f, &w, w.k0 + w.nb, note, w.S + hdi_real_s_size(w.p)) : hdi_pack_pivots(f, &w, note))) return 0;
        hdi_share_run(&h, HDI_SHARE_COLUMNS, w.k0 + w.nb, w.m);
    }
    hdi_share_run(&h, HDI_SHARE_UPDATE, 0, w.u);
    return 1;
}

static void hdi_factor_free(hdi_factor *f) {
    if (!f->ctx) return;
    hdi_free(f->ctx, f->panel);
    hdi_free(f->ctx, f->dinv);
    hdi_free(f->ctx, f->work);
    hdi_free(f->ctx, f->scratch);
    hdi_free(f->ctx, f->chunk_scratch);
    hdi_free(f->ctx, f->pivots);
    memset(f, 0, sizeof *f);
}

/* Room for a factor of the given width; all that factoring and refactoring need. */
static hd_status hdi_factor_make(hdi_factor *f, const hdi_symbolic *sym, int32_t width, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    const uint64_t w = HDI_CAST(uint64_t, width);
    const int32_t n_parts = sym->n_tasks > 0 ? sym->n_tasks : 1, n_chunks = sym->largest_front / HDI_FRONT_CHUNK + 1;
    memset(f, 0, sizeof *f);
    f->sym = sym;
    f->width = width;
    f->pack = hdi_pack_ops_get(hdi_simd_level(ctx));
    f->real = hdi_real_ops_get(hdi_simd_level(ctx));
    f->scratch_size = hdi_front_scratch(sym->task_pivots, sym->task_update, width);
    f->chunk_size = hdi_front_scratch(sym->largest_pivots, sym->largest_update, width);
    f->panel = HDI_TAKE(&s, double, HDI_CAST(uint64_t, width == 1 ? sym->panel[sym->n_super] : sym->stored) * w);
    f->dinv = HDI_TAKE(&s, double, HDI_CAST(uint64_t, sym->n) * w);
    f->work = HDI_TAKE(&s, double, HDI_CAST(uint64_t, sym->work) * w);
    f->scratch = HDI_TAKE(&s, double, hdi_front_scratch(sym->largest_pivots, sym->largest_update, width) + f->scratch_size * HDI_CAST(uint64_t, n_parts));
    f->chunk_scratch = HDI_TAKE(&s, double, sym->n_top ? f->chunk_size * HDI_CAST(uint64_t, n_chunks) : 1);
    f->pivots = HDI_TAKE(&s, hdi_pivots, n_parts + 1);
    if (e->status < 0) {
        memset(f, 0, sizeof *f);
        return hdi_scope_end(&s);
    }
    s.n = 0;
    f->ctx = ctx;
    return HD_OK;
}

/* Collects what the parts saw; the failure of the lowest pivot is the one to tell. */
static hd_status hdi_factor_collect(hdi_factor *f, int32_t n_parts, hd_error *e) {
    int32_t i;
    hdi_pivots_clear(&f->all);
    for (i = 0; i < n_parts; i++) {
        const hdi_pivots *q = f->pivots + i;
        if (q->largest > f->all.largest) f->all.largest = q->largest;
        if (q->smallest < f->all.smallest) f->all.smallest = q->smallest;
        f->all.negative += q->negative;
        if (q->failed < 0 || (f->all.failed >= 0 && f->all.failed < q->failed)) continue;
        f->all.failed = q->failed;
        f->all.lane = q->lane;
        f->all.value = q->value;
    }
    if (f->error.status < 0) {
        *e = f->error;
        return e->status;
    }
    if (f->all.failed < 0) return HD_OK;
    hdi_fail_row(e, HD_ERR_BREAKDOWN, "LDL': a pivot is zero or not finite", f->sym->perm[f->all.failed], -1, f->all.value);
    if (f->width > 1) e->pole = f->all.lane;
    return e->status;
}

/* All fronts: subtrees at the same time, then the top, whose fronts are shared. */
static hd_status hdi_factor_run(hdi_factor *f, const hdi_values *values, hd_error *e) {
    const hdi_symbolic *s = f->sym;
    const int32_t n_parts = s->n_tasks + 1;
    double *scratch = hdi_factor_scratch(f, s->n_tasks);
    int32_t i;
    f->ready = f->stop = 0;
    f->values = values;
    f->share = s->n_top > 0 ? 0.5 : 1;
    hdi_error_clear(&f->error);
    for (i = 0; i < n_parts; i++) hdi_pivots_clear(f->pivots + i);
    hdi_parallel(f->ctx, s->n_tasks, hdi_factor_task, f);
    for (i = 0; i < s->n_top && !f->stop; i++) {
        const int32_t v = s->top[i];
        const int64_t m = hdi_front_pivots(s, v) + hdi_front_below(s, v);
        if (hdi_progress(f->ctx, "factor", 0.5 + 0.5 * i / s->n_top, &f->error) < 0) break;
        if (!(m >= 2 * HDI_FRONT_CHUNK ? hdi_front_shared(f, v, scratch, f->pivots + s->n_tasks) : hdi_front_factor(f, v, scratch, f->pivots + s->n_tasks))) break;
    }
    f->values = NULL;
    if (hdi_factor_collect(f, n_parts, e) < 0) return e->status;
    f->ready = 1;
    return HD_OK;
}

/* ---- solves ---- */
/* x [n] entries in elimination order. Forward, a front hands its parent a vector, as it does update matrices, so that subtrees are independent both ways.
 * Right-hand sides with few non-zeros touch few fronts: active [n_super] tells which (NULL: all), closed towards the roots. */
typedef struct hdi_sweep {
    const hdi_factor *f;
    double *x, *vec;             /* [n][k], [vector_size][k] entries */
    double *gather;              /* [largest_update][k] entries for each part, packs with k > 1 and real */
    int64_t gather_size;         /* doubles */
    int32_t k;                   /* right-hand sides side by side: packs any, real 1 or 8 */
    int32_t backward;
    const char *active;          /* forward */
    const char *wanted;          /* backward: fronts whose part of x is asked for, closed towards the roots; NULL: all */
} hdi_sweep;

/* The children's vectors, into the pivots' part of x and into t, which is cleared before. */
static void hdi_sweep_children(const hdi_sweep *z, int32_t v, double *y, double *t) {
    const hdi_symbolic *s = z->f->sym;
    const int64_t p = hdi_front_pivots(s, v), w = HDI_CAST(int64_t, z->f->width) * z->k;
    int64_t i, q;
    int32_t k;
    memset(t, 0, HDI_CAST(size_t, w * hdi_front_below(s, v)) * sizeof *t);
    for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
        const int32_t c = s->kid[k], *HDI_RESTRICT rel = s->rel + s->row_ptr[c];
        const int64_t uc = hdi_front_below(s, c), inner = s->inner[c];
        const double *HDI_RESTRICT from = z->vec + w * s->vector[c];
        double *HDI_RESTRICT below = t - w * p;
        if (z->active && !z->active[c]) continue;
        if (w == 1) {
            for (i = 0; i < inner; i++) y[rel[i]] += from[i];
            for (; i < uc; i++) below[rel[i]] += from[i];
            continue;
        }
        for (i = 0; i < uc; i++) {
            double *HDI_RESTRICT to = (i < inner ? y : below) + w * rel[i];
            for (q = 0; q < w; q += 8) {
                int e;
                for (e = 0; e < 8; e++) to[q + e] += from[w * i + q + e];
            }
        }
    }
}

/* y = L11^-1 y, t -= L21 y */
static void hdi_pack_forward_front(const hdi_sweep *z, int32_t v, double *y, double *t) {
    const hdi_factor *f = z->f;
    const int64_t p = hdi_front_pivots(f->sym, v), u = hdi_front_below(f->sym, v), row = HDI_PACK * z->k;
    double *panel = f->panel + HDI_PACK * f->sym->panel_pack[v];
    hdi_pack_job g;
    int64_t i, q;
    memset(&g, 0, sizeof g);
    g.a_col = HDI_PACK;
    g.b_row = HDI_PACK;
    g.b_col = g.c_row = row;
    for (q = 0; q * HDI_PANEL < p; q++) {
        const hdi_pack_block b = hdi_pack_block_of(panel, p + u, p, q);
        double *l = b.at;
        if (z->k == 1) {
            double *w = y + HDI_PACK * b.begin;
            for (i = 1; i < b.width; i++) f->pack->forward(l + i * b.row, 1, i, w, w + HDI_PACK * i);
            f->pack->forward(l + b.width * b.row, p - b.begin - b.width, b.width, w, w + b.row);
            f->pack->forward(l + (p - b.begin) * b.row, u, b.width, w, t);
            continue;
        }
        g.a_row = b.row;
        g.b = y + row * b.begin;
        for (i = 1; i < b.width; i++) {
            g.a = l + i * b.row;
            g.c = y + row * (b.begin + i);
            g.depth = i;
            f->pack->multiply(&g, 0, 1, 0, z->k);
        }
        g.depth = b.width;
        g.a = l + b.width * b.row;
        g.c = y + row * (b.begin + b.width);
        f->pack->multiply(&g, 0, p - b.begin - b.width, 0, z->k);
        g.a = l + (p - b.begin) * b.row;
        g.c = t;
        f->pack->multiply(&g, 0, u, 0, z->k);
    }
}

/* y = L11^-T (D^-1 y - L21' x[rows]) */
static void hdi_pack_backward_front(const hdi_sweep *z, int32_t v, double *y, double *gather) {
    const hdi_factor *f = z->f;
    const hdi_symbolic *s = f->sym;
    const int64_t p = hdi_front_pivots(s, v), u = hdi_front_below(s, v), row = HDI_PACK * z->k;
    const int32_t *idx = s->row + s->row_ptr[v];
    double *panel = f->panel + HDI_PACK * s->panel_pack[v], t[HDI_PACK];
    const double *dinv = f->dinv + HDI_PACK * HDI_CAST(int64_t, s->super[v]);
    hdi_pack_job g;
    int64_t i, q;
    for (i = 0; i < p * z->k; i++) {
        memcpy(t, y + HDI_PACK * i, sizeof t);
        hdi_pack_times(t, dinv + HDI_PACK * (i / z->k), y + HDI_PACK * i);
    }
    for (i = 0; i < u && z->k > 1; i++) memcpy(gather + i * row, z->x + row * idx[i], HDI_CAST(size_t, row) * sizeof *gather);
    memset(&g, 0, sizeof g);
    g.a_row = g.b_row = HDI_PACK;
    g.b_col = g.c_row = row;
    for (q = (p - 1) / HDI_PANEL; q >= 0; q--) {
        const hdi_pack_block b = hdi_pack_block_of(panel, p + u, p, q);
        double *l = b.at, *w = y + row * b.begin;
        if (z->k == 1) {
            f->pack->backward(l + (p - b.begin) * b.row, idx, u, b.width, w, z->x);
            f->pack->backward(l + b.width * b.row, NULL, p - b.begin - b.width, b.width, w, w + b.row);
            for (i = b.width - 1; i > 0; i--) f->pack->backward(l + i * b.row, NULL, 1, i, w, w + HDI_PACK * i);
            continue;
        }
        g.a_col = b.row;
        g.c = w;
        g.a = l + (p - b.begin) * b.row;
        g.b = gather;
        g.depth = u;
        f->pack->multiply(&g, 0, b.width, 0, z->k);
        g.a = l + b.width * b.row;
        g.b = w + row * b.width;
        g.depth = p - b.begin - b.width;
        f->pack->multiply(&g, 0, b.width, 0, z->k);
        g.depth = 1;
        for (i = b.width - 1; i > 0; i--) {
            g.a = l + i * b.row;
            g.b = w + row * i;
            f->pack->multiply(&g, 0, i, 0, z->k);
        }
    }
}

static void hdi_real_forward_front(const hdi_sweep *z, int32_t v, double *y, double *t) {
    const hdi_factor *f = z->f;
    const int32_t p = hdi_front_pivots(f->sym, v);
    const int64_t u = hdi_front_below(f->sym, v), m = p + u;
    const double *panel = f->panel + f->sym->panel[v];
    int32_t k, nc;
    for (k = 0; k < p; k += 8) {
        nc = p - k < 8 ? p - k : 8;
        if (z->k == 1) {
            f->real->forward(y + k, panel + k + k * m, m, nc, p - k - nc, t, u, 0);
            continue;
        }
        if (k) f->real->gemv8(y + 8 * k, NULL, panel + k, m, nc, y, k);
        f->real->lower8(y + 8 * k, panel + k + k * m, m, nc);
    }
    if (z->k > 1 && u > 0) f->real->gemv8(t, NULL, panel + p, m, u, y, p);
}

static void hdi_real_backward_front(const hdi_sweep *z, int32_t v, double *y, double *gather) {
    const hdi_factor *f = z->f;
    const hdi_symbolic *s = f->sym;
    const int32_t p = hdi_front_pivots(s, v), *idx = s->row + s->row_ptr[v];
    const int64_t m = p + hdi_front_below(s, v);
    if (z->k == 1) hdi_real_backward(f->real, f->panel + s->panel[v], m, p, f->dinv + s->super[v], y, z->x, idx, gather);
    else hdi_real_backward8(f->real, f->panel + s->panel[v], m, p, f->dinv + s->super[v], y, z->x, idx);
}

/* Fronts are too short for the processor to see where they lead: fetches as much of the panels as v's own takes, some way ahead. Halves the time of a
 * sweep from memory. */
static HDI_INLINE void hdi_factor_fetch(const hdi_factor *f, int32_t v, int backward) {   /* a function of its own would have no effect, and be left out */
    enum { AHEAD = 1024, MOST = 8192 };          /* doubles */
    const int64_t *at = f->width == 1 ? f->sym->panel : f->sym->panel_pack, end = f->width * at[f->sym->n_super];
    const int64_t ahead = (f->width == 1 ? 1 : 2) * (backward ? -AHEAD : AHEAD), first = f->width * at[v] + ahead, last = f->width * at[v + 1] + ahead;
    int64_t i;
    if (first < 0 || last > end || last - first > MOST) return;
    for (i = first; i < last; i += 8) HDI_PREFETCH(f->panel + i);
}

static void hdi_sweep_front(const hdi_sweep *z, int32_t v, int64_t part) {
    const hdi_factor *f = z->f;
    const int64_t w = HDI_CAST(int64_t, f->width) * z->k;
    double *y = z->x + w * f->sym->super[v], *t = z->vec + w * f->sym->vector[v], *gather = z->gather + z->gather_size * part;
    hdi_factor_fetch(f, v, z->backward);
    if (z->backward) {
        if (z->wanted && !z->wanted[v]) return;
        if (f->width == 1) hdi_real_backward_front(z, v, y, gather);
        else hdi_pack_backward_front(z, v, y, gather);
        return;
    }
    if (z->active && !z->active[v]) return;
    hdi_sweep_children(z, v, y, t);
    if (f->width == 1) hdi_real_forward_front(z, v, y, t);
    else hdi_pack_forward_front(z, v, y, t);
}

static void hdi_sweep_task(void *arg, int64_t index, int32_t worker) {
    const hdi_sweep *z = HDI_CAST(const hdi_sweep *, arg);
    const hdi_symbolic *s = z->f->sym;
    const int32_t begin = s->task_begin[index], end = s->task_end[index];
    int32_t v;
    (void)worker;
    if (z->backward)
        for (v = end; v-- > begin;) hdi_sweep_front(z, v, index);
    else
        for (v = begin; v < end; v++) hdi_sweep_front(z, v, index);
}

/* x = A^-1 x. On all threads with ctx, else (from within a task) on this one. */
static void hdi_sweep_run(hdi_sweep *z, hd_context *ctx) {
    const hdi_symbolic *s = z->f->sym;
    int32_t i;
    z->backward = 0;
    if (ctx && !z->active) hdi_parallel(ctx, s->n_tasks, hdi_sweep_task, z);
    else for (i = 0; i < s->n_tasks; i++) hdi_sweep_task(z, i, 0);
    for (i = 0; i < s->n_top; i++) hdi_sweep_front(z, s->top[i], s->n_tasks);
    z->backward = 1;
    for (i = s->n_top; i-- > 0;) hdi_sweep_front(z, s->top[i], s->n_tasks);
    if (ctx) hdi_parallel(ctx, s->n_tasks, hdi_sweep_task, z);
    else for (i = s->n_tasks; i-- > 0;) hdi_sweep_task(z, i, 0);
}

/* Doubles that a sweep of k right-hand sides works with besides x: vec, and gather for each part under way at the same time. */
static uint64_t hdi_sweep_size(const hdi_symbolic *s, int32_t width, int32_t k, int parallel) {
    const uint64_t w = HDI_CAST(uint64_t, width) * HDI_CAST(uint64_t, k), parts = parallel ? HDI_CAST(uint64_t, s->n_tasks) + 1 : 1;
    return w * (HDI_CAST(uint64_t, s->vector_size) + parts * HDI_CAST(uint64_t, s->largest_update)) + 16;
}

static hdi_sweep hdi_sweep_open(const hdi_factor *f, int32_t k, double *x, double *work, int parallel) {
    hdi_sweep z;
    memset(&z, 0, sizeof z);
    z.f = f;
    z.x = x;
    z.k = k;
    z.vec = work;
    z.gather = work + HDI_CAST(int64_t, f->width) * k * f->sym->vector_size;
    z.gather_size = parallel ? HDI_CAST(int64_t, f->width) * k * f->sym->largest_update : 0;
    return z;
}

/* Fronts that a right-hand side with a non-zero at pivot i touches: up the tree. */
static void hdi_sweep_touch(const hdi_symbolic *s, int32_t i, char *active) {
    int32_t v;
    for (v = s->super_of[i]; v >= 0 && !active[v]; v = s->parent[v]) active[v] = 1;
}

/* ==== [13] selinv ====
 * Entries of the inverse on the pattern of the factor, from the root down. May call [12].
 * This work is based on
 *   K. Takahashi, J. Fagan, M. Chin, Formation of a sparse bus impedance matrix and its application to short circuit study, 1973
 *   A. Erisman, W. Tinney, On computing certain elements of the inverse of a sparse matrix, 1975
 *   L. Lin, C. Yang, J. Meza, J. Lu, L. Ying, W. E, SelInv - an algorithm for selected inversion of a sparse symmetric matrix, 2011 (by supernodes)
 * With Z = A^-1 = L^-T D^-1 L^-1 and, for a block of pivots, M = L21 L11^-1:  Z21 = -Z22 M,  Z11 = L11^-T D^-1 L11^-1 - M' Z21. Plain transposes.
 * The factor stays as it is. A front's Z22 stands where its update matrix stood: its life is that of the update matrix run backwards, so that the plan of
 * memory serves both. What is new, the columns of the pivots, lives in a scratch panel until the children have taken their parts. */

enum { HDI_INV_ROWS = 48, HDI_INV_DEPTH = 64, HDI_INV_DEPTH_REAL = 128, HDI_INV_CHUNK = 48, HDI_INV_PIVOTS = 24, HDI_INV_SLICE = 6 };

/* What is wanted of an inverse Z: its entries in A's lower triangle in the order of sym->a_from; by pivots, its diagonal, or the quadratic forms x_j' Z x_j. */
typedef enum hdi_wanted { HDI_WANT_ENTRIES, HDI_WANT_DIAGONAL, HDI_WANT_FORMS } hdi_wanted;

/* The x_j of quadratic forms, columns of a symmetric matrix X on the pattern that was analysed, and room for them. Places to work in: one for each subtree, then
 * one for each block of columns under way in a front of the top. */
typedef struct hdi_forms {
    const hd_csr *a;             /* the pattern */
    const double *x;             /* X by its entries */
    int32_t *inv;                /* [n] pivot of a row of A */
    int32_t cols, n_slots;       /* columns of a block at most; blocks of a front of the top at the same time */
    uint64_t *active;            /* [1 + n_slots][n_super], all subtrees share the first: which columns of the block have come to a front. 0 between blocks */
    int32_t *column;             /* [n_tasks][task_pivots], [n_slots][largest_pivots] place in the block of a pivot's column, -1: not in it */
    hdi_pair *order;             /* [n_tasks][task_pivots], [largest_pivots] */
    double *room;                /* [n_tasks][task_size], [n_slots][slot_size] */
    uint64_t task_size, slot_size, aside_task, aside_slot;
} hdi_forms;

/* Inversion under way. Wanted of it are weighted sums over the numbers of an entry or form (four complex ones in a pack): sum_c coef[c] z_c, for each of n_sets
 * sets of weights. They are added to what is there. */
typedef struct hdi_inverse {
    hdi_factor *f;
    const double *coef;          /* [n_sets][width] */
    int32_t n_sets;
    hdi_wanted wanted;
    const hdi_forms *forms;
    double *values;              /* [n_sets][entries or n] */
    int64_t stride;              /* from set to set */
    double *scratch, *chunk;     /* [n_tasks][scratch_size] and one for the top; [chunks][chunk_size] */
    uint64_t scratch_size, top_size, chunk_size;
    int32_t stop;
    double done;
    hd_error error;
} hdi_inverse;

/* The parts of one front; a block of pivots [k0,k1) under way. */
typedef struct hdi_inverse_front {
    hdi_factor *f;
    double *panel, *z, *update;  /* L; Z of the pivots' columns in the same layout; Z22, a packed triangle */
    double *T, *S, *M, *D, *slices, *buffer;   /* D: -1/d of the pivots, then ones */
    int64_t m, p, u, k0, k1;
    int32_t v;
} hdi_inverse_front;

/* Doubles of a block of rows of Z that is gathered, and of all scratch of a front of at most so many rows and pivots and stored entries. */
static uint64_t hdi_inverse_buffer(int32_t width) {
    return width == 1 ? HDI_CAST(uint64_t, HDI_REAL_MR) * HDI_INV_DEPTH_REAL : HDI_CAST(uint64_t, HDI_PACK) * HDI_INV_ROWS * HDI_INV_DEPTH;
}

static uint64_t hdi_inverse_scratch(int64_t m, int64_t p, int64_t stored, int32_t width) {
    const int64_t w = hdi_least(p, HDI_PANEL), slices = width == 1 ? (m + w) * (w + HDI_REAL_NR) : 0;
    return HDI_CAST(uint64_t, width * (stored + 2 * w * w + m * (w + HDI_INV_SLICE) + w + HDI_INV_PIVOTS) + slices) + hdi_inverse_buffer(width) + 64;
}

static hdi_inverse_front hdi_inverse_open(hdi_factor *f, int32_t v, double *scratch) {
    const hdi_symbolic *s = f->sym;
    const int64_t *at = f->width == 1 ? s->panel : s->panel_pack;
    hdi_inverse_front w;
    int64_t most;
    memset(&w, 0, sizeof w);
    w.f = f;
    w.v = v;
    w.p = hdi_front_pivots(s, v);
    w.u = hdi_front_below(s, v);
    w.m = w.p + w.u;
    w.panel = f->panel + f->width * at[v];
    w.update = f->work + f->width * s->update[v];
    most = hdi_least(w.p, HDI_PANEL);
    w.z = scratch;
    w.T = w.z + f->width * (at[v + 1] - at[v]);
    w.S = w.T + f->width * most * most;
    w.M = w.S + f->width * most * most;
    w.D = w.M + f->width * w.m * (most + HDI_INV_SLICE);
    w.slices = w.D + f->width * (most + HDI_INV_PIVOTS);
    w.buffer = w.slices + (f->width == 1 ? (w.m + most) * (most + HDI_REAL_NR) : 0);
    return w;
}

/* ---- packs ---- */

/* Entry (i,j) of Z, j <= i, and how many of its row follow in place. */
static const double *hdi_pack_inverse_at(const hdi_inverse_front *w, int64_t i, int64_t j, int64_t *run) {
    if (j < w->p) {
        const hdi_pack_block b = hdi_pack_block_of(w->z, w->m, w->p, j / HDI_PANEL);
        *run = b.begin + b.width - j;
        return hdi_pack_at(&b, i, j);
    }
    *run = i - j + 1;
    return w->update + HDI_PACK * (hdi_triangle(i - w->p) + j - w->p);
}

/* Rows [i0,i1), columns [j0,j1) of the symmetric Z, by rows. */
static void hdi_pack_inverse_gather(const hdi_inverse_front *w, int64_t i0, int64_t i1, int64_t j0, int64_t j1, double *to) {
    const int64_t row = HDI_PACK * (j1 - j0);
    int64_t i, j, run, end;
    for (i = i0; i < i1; i++) {
        for (j = j0, end = hdi_least(i + 1, j1); j < end; j += run) {
            const double *from = hdi_pack_inverse_at(w, i, j, &run);
            run = hdi_least(run, end - j);
            memcpy(to + (i - i0) * row + HDI_PACK * (j - j0), from, HDI_CAST(size_t, run) * HDI_PACK * sizeof *to);
        }
    }
    for (j = j0 > i0 ? j0 : i0 + 1; j < j1; j++) {   /* above the diagonal: entry (j,i) */
        double *column = to + HDI_PACK * (j - j0);
        for (i = i0, end = hdi_least(i1, j); i < end; i += run) {
            const double *from = hdi_pack_inverse_at(w, j, i, &run);
            int64_t q;
            run = hdi_least(run, end - i);
            for (q = 0; q < run; q++) memcpy(column + (i + q - i0) * row, from + HDI_PACK * q, HDI_PACK * sizeof *to);
        }
    }
}

/* T = -L11^-T (from T L11' = -I, some columns at a time) and Z11 = L11^-T D^-1 L11^-1 of the block, by rows of as many entries. */
static void hdi_pack_inverse_pivots(const hdi_inverse_front *w) {
    const hdi_pack_block l = hdi_pack_block_of(w->panel, w->m, w->p, w->k0 / HDI_PANEL), z = hdi_pack_block_of(w->z, w->m, w->p, w->k0 / HDI_PANEL);
    const int64_t n = w->k1 - w->k0, row = HDI_PACK * n;
    const double *dinv = w->f->dinv + HDI_PACK * (w->f->sym->super[w->v] + w->k0);
    double *one = w->D + row;
    hdi_pack_rows x;
    hdi_pack_job g;
    int64_t i, k;
    memset(w->T, 0, HDI_CAST(size_t, n * row) * sizeof *w->T);
    memset(&x, 0, sizeof x);
    memset(&g, 0, sizeof g);
    for (i = 0; i < row; i++) w->D[i] = -dinv[i];
    for (i = 0; i < HDI_PACK * hdi_least(n, HDI_INV_PIVOTS); i++) one[i] = (i & 4) == 0;
    x.row = g.a_row = g.c_row = row;
    x.dinv = one;
    x.s_row = g.b_row = l.row;
    g.a_col = g.b_col = HDI_PACK;
    g.store = 1;
    for (k = 0; k < n; k += HDI_INV_PIVOTS) {
        const int64_t nb = hdi_least(n - k, HDI_INV_PIVOTS);
        int q;
        for (i = k; i < k + nb; i++)
            for (q = 0; q < 4; q++) w->T[i * row + HDI_PACK * i + q] = -1;
        g.c = w->T + HDI_PACK * k;
        for (i = 0; i < k; i += HDI_INV_PIVOTS) {
            g.a = w->T + HDI_PACK * i;
            g.b = l.at + k * l.row + HDI_PACK * i;
            g.depth = k - i;
            w->f->pack->multiply(&g, i, i + HDI_INV_PIVOTS, 0, nb);
        }
        x.panel = g.c;
        x.s = l.at + k * l.row + HDI_PACK * k;
        x.nb = HDI_CAST(int32_t, nb);
        w->f->pack->solve_rows(&x, 0, k + nb);
    }
    w->f->pack->scale(w->T, row, 0, n, 0, n, w->D, w->S);
    g.b_row = row;
    g.c = z.at;
    g.c_row = z.row;
    g.lower = 1;
    for (i = 0; i < n; i += HDI_INV_PIVOTS) {    /* (T S')(i,k) begins at entry i */
        g.a = w->T + HDI_PACK * i;
        g.b = w->S + HDI_PACK * i;
        g.depth = n - i;
        w->f->pack->multiply(&g, i, hdi_least(i + HDI_INV_PIVOTS, n), 0, hdi_least(i + HDI_INV_PIVOTS, n));
    }
}

/* M stands in slices of some columns, by rows: entry (row k1 + r, column j) at row r of slice j / HDI_INV_SLICE. Rows of a matrix of 128 columns are 8 KB apart,
 * and a tile's columns of them would all fall into one set of the cache. */
static double *hdi_pack_inverse_slice(const hdi_inverse_front *w, int64_t r, int64_t j) {
    return w->M + HDI_PACK * (j * (w->m - w->k1) + r * HDI_INV_SLICE);
}

/* Rows [r0,r1) of M = L21 L11^-1, rows counted in the front; T is triangular. */
static void hdi_pack_inverse_m(const hdi_inverse_front *w, int64_t r0, int64_t r1) {
    const hdi_pack_block l = hdi_pack_block_of(w->panel, w->m, w->p, w->k0 / HDI_PANEL);
    const int64_t n = w->k1 - w->k0;
    hdi_pack_job g;
    int64_t r, j;
    memset(&g, 0, sizeof g);
    g.a_row = l.row;
    g.a_col = g.b_col = HDI_PACK;
    g.b_row = HDI_PACK * n;
    g.c_row = HDI_CAST(int64_t, HDI_PACK) * HDI_INV_SLICE;
    g.store = 1;
    for (r = r0; r < r1; r += HDI_INV_ROWS) {
        for (j = 0; j < n; j += HDI_INV_SLICE) {
            g.a = hdi_pack_at(&l, r, w->k0 + j);
            g.b = w->T + HDI_PACK * (j * n + j);
            g.c = hdi_pack_inverse_slice(w, r - w->k1, j);
            g.depth = n - j;
            w->f->pack->multiply(&g, 0, hdi_least(r1 - r, HDI_INV_ROWS), 0, hdi_least(n - j, HDI_INV_SLICE));
        }
    }
}

/* Rows [r0,r1) of Z21 = -Z22 M. */
static void hdi_pack_inverse_below(const hdi_inverse_front *w, int64_t r0, int64_t r1, double *buffer) {
    const hdi_pack_block z = hdi_pack_block_of(w->z, w->m, w->p, w->k0 / HDI_PANEL);
    const int64_t n = w->k1 - w->k0;
    hdi_pack_job g;
    int64_t r, d, j;
    memset(&g, 0, sizeof g);
    g.a = buffer;
    g.a_col = g.b_row = HDI_PACK;
    g.b_col = HDI_CAST(int64_t, HDI_PACK) * HDI_INV_SLICE;
    g.c_row = z.row;
    for (r = r0; r < r1; r += HDI_INV_ROWS) {
        const int64_t end = hdi_least(r + HDI_INV_ROWS, r1);
        for (d = w->k1; d < w->m; d += HDI_INV_DEPTH) {
            g.depth = hdi_least(w->m - d, HDI_INV_DEPTH);
            g.a_row = HDI_PACK * g.depth;
            g.store = d == w->k1;
            hdi_pack_inverse_gather(w, r, end, d, d + g.depth, buffer);
            for (j = 0; j < n; j += HDI_INV_SLICE) {
                g.b = hdi_pack_inverse_slice(w, d - w->k1, j);
                g.c = hdi_pack_at(&z, r, w->k0 + j);
                w->f->pack->multiply(&g, 0, end - r, 0, hdi_least(n - j, HDI_INV_SLICE));
            }
        }
    }
}

/* Rows [r0,r1) of Z11 -= Z21' M, counted from the block's first pivot. */
static void hdi_pack_inverse_corner(const hdi_inverse_front *w, int64_t r0, int64_t r1) {
    const hdi_pack_block z = hdi_pack_block_of(w->z, w->m, w->p, w->k0 / HDI_PANEL);
    hdi_pack_job g;
    int64_t d, j;
    memset(&g, 0, sizeof g);
    g.a_row = g.b_row = HDI_PACK;
    g.a_col = z.row;
    g.b_col = HDI_CAST(int64_t, HDI_PACK) * HDI_INV_SLICE;
    g.c = z.at;
    g.c_row = z.row;
    g.lower = 1;
    for (d = w->k1; d < w->m; d += HDI_INV_DEPTH) {
        g.depth = hdi_least(w->m - d, HDI_INV_DEPTH);
        g.a = hdi_pack_at(&z, d, w->k0);
        for (j = 0; j < r1; j += HDI_INV_SLICE) {
            g.b = hdi_pack_inverse_slice(w, d - w->k1, j);
            g.b_first = j;
            w->f->pack->multiply(&g, r0 > j ? r0 : j, r1, j, hdi_least(r1, j + HDI_INV_SLICE));
        }
    }
}

/* Rows [r0,r1) of child c's Z22, out of the finished front. */
static void hdi_pack_inverse_child(const hdi_inverse_front *w, int32_t c, int64_t r0, int64_t r1) {
    const hdi_symbolic *s = w->f->sym;
    const int32_t *rel = s->rel + s->row_ptr[c];
    double *to = w->f->work + HDI_PACK * (s->update[c] + hdi_triangle(r0));
    int64_t a, b, run;
    for (a = r0; a < r1; a++) {
        for (b = 0; b <= a;) {
            const int64_t first = rel[b];
            const double *from = hdi_pack_inverse_at(w, rel[a], first, &run);
            for (; b <= a && rel[b] < first + run; b++, to += HDI_PACK) memcpy(to, from + HDI_PACK * (rel[b] - first), HDI_PACK * sizeof *to);
        }
    }
}

/* ---- real fronts ---- */

static int64_t hdi_column_packed(int64_t u, int64_t j) { return j * u - j * (j - 1) / 2; }

/* Entry (j,j) of Z; those below it in its column follow. */
static const double *hdi_real_inverse_at(const hdi_inverse_front *w, int64_t j) {
    return j < w->p ? w->z + j * (w->m + 1) : w->update + hdi_column_packed(w->u, j - w->p);
}

/* Rows [i0,i1), at most mr, columns [j0,j1) of the symmetric Z, by columns of mr, zeros past the last row. */
static void hdi_real_inverse_gather(const hdi_inverse_front *w, int64_t i0, int64_t i1, int64_t j0, int64_t j1, double *to) {
    const int64_t mr = w->f->real->mr;
    int64_t i, j;
    if (i1 - i0 < mr) memset(to, 0, HDI_CAST(size_t, mr * (j1 - j0)) * sizeof *to);
    for (j = j0; j < j1 && j < i1; j++) {
        const double *from = hdi_real_inverse_at(w, j) - j;
        for (i = i0 > j ? i0 : j; i < i1; i++) to[(j - j0) * mr + i - i0] = from[i];
    }
    for (i = i0; i < i1; i++) {                  /* above the diagonal: entry (j,i) */
        const double *from = hdi_real_inverse_at(w, i) - i;
        for (j = j0 > i ? j0 : i + 1; j < j1; j++) to[(j - j0) * mr + i - i0] = from[j];
    }
}

/* Slices of nr columns of X (column-major, rows x cols): entry (k,j) at [k nr + j] of its slice, zeros past the last column. */
static void hdi_real_slices(double *to, int32_t nr, const double *x, int64_t ld, int64_t rows, int64_t cols) {
    int64_t j, k;
    for (j = 0; j < cols; j++) {
        double *slice = to + j / nr * (rows * nr) + j % nr;
        for (k = 0; k < rows; k++) slice[k * nr] = x[j * ld + k];
    }
    for (; j % nr; j++) {
        double *slice = to + j / nr * (rows * nr) + j % nr;
        for (k = 0; k < rows; k++) slice[k * nr] = 0;
    }
}

static void hdi_real_clear(double *c, int64_t ld, int64_t rows, int64_t cols) {
    int64_t j;
    for (j = 0; j < cols; j++) memset(c + j * ld, 0, HDI_CAST(size_t, rows) * sizeof *c);
}

/* C -= X' Y for columns [i0,i1) of X; X and Y of `depth` rows, Y in slices of its n columns. */
static void hdi_real_cross(const hdi_inverse_front *w, double *c, int64_t ld, const double *x, int64_t ldx, int64_t i0, int64_t i1, const double *slices, int64_t n,
                           int64_t depth, double *buffer) {
    const hdi_real_ops *o = w->f->real;
    int64_t i, j;
    for (i = i0; i < i1; i += o->mr) {
        const int32_t rows = HDI_CAST(int32_t, hdi_least(i1 - i, o->mr));
        for (j = 0; j < depth; j += HDI_INV_DEPTH_REAL) {
            const int64_t here = hdi_least(depth - j, HDI_INV_DEPTH_REAL);
            hdi_real_slices(buffer, o->mr, x + i * ldx + j, ldx, here, rows);
            o->gemm(c + i, ld, rows, HDI_CAST(int32_t, n), buffer, o->mr, slices + j * o->nr, HDI_CAST(int32_t, depth), HDI_CAST(int32_t, here));
        }
    }
}

/* T = -L11^-1, column-major, in slices too, and Z11 = L11^-T D^-1 L11^-1. */
static void hdi_real_inverse_pivots(const hdi_inverse_front *w) {
    const int64_t n = w->k1 - w->k0;
    const double *l = w->panel + w->k0 * (w->m + 1), *dinv = w->f->dinv + w->f->sym->super[w->v] + w->k0;
    double *z = w->z + w->k0 * (w->m + 1);
    int64_t i, j, k;
    memset(w->T, 0, HDI_CAST(size_t, n * n) * sizeof *w->T);
    for (k = 0; k < n; k++) {
        double *t = w->T + k * n;
        t[k] = -1;
        for (j = k; j < n; j += 8) {
            const int64_t nc = hdi_least(n - j, 8);
            w->f->real->forward(t + j, l + j * (w->m + 1), w->m, HDI_CAST(int32_t, nc), n - j - nc, NULL, 0, 0);
        }
        for (i = 0; i < n; i++) w->S[k * n + i] = -dinv[i] * t[i];
    }
    hdi_real_slices(w->slices, w->f->real->nr, w->S, n, n, n);
    hdi_real_clear(z, w->m, n, n);
    hdi_real_cross(w, z, w->m, w->T, n, 0, n, w->slices, n, n, w->buffer);
    hdi_real_slices(w->slices, w->f->real->nr, w->T, n, n, n);
}

static void hdi_real_inverse_m(const hdi_inverse_front *w, int64_t r0, int64_t r1, double *buffer) {
    const hdi_real_ops *o = w->f->real;
    const int64_t n = w->k1 - w->k0, u = w->m - w->k1;
    int64_t r;
    hdi_real_clear(w->M + r0 - w->k1, u, r1 - r0, n);
    for (r = r0; r < r1; r += o->mr) {
        const int32_t rows = HDI_CAST(int32_t, hdi_least(r1 - r, o->mr));
        o->copy(buffer, w->panel + r + w->k0 * w->m, w->m, rows, HDI_CAST(int32_t, n));
        o->gemm(w->M + r - w->k1, u, rows, HDI_CAST(int32_t, n), buffer, o->mr, w->slices, HDI_CAST(int32_t, n), HDI_CAST(int32_t, n));
    }
}

/* Rows [r0,r1) of Z21 = -Z22 M; slices are those of M. */
static void hdi_real_inverse_below(const hdi_inverse_front *w, int64_t r0, int64_t r1, double *buffer) {
    const hdi_real_ops *o = w->f->real;
    const int64_t n = w->k1 - w->k0, u = w->m - w->k1;
    int64_t r, j;
    hdi_real_clear(w->z + r0 + w->k0 * w->m, w->m, r1 - r0, n);
    for (r = r0; r < r1; r += o->mr) {
        const int64_t end = hdi_least(r + o->mr, r1);
        for (j = w->k1; j < w->m; j += HDI_INV_DEPTH_REAL) {
            const int64_t last = hdi_least(j + HDI_INV_DEPTH_REAL, w->m);
            hdi_real_inverse_gather(w, r, end, j, last, buffer);
            o->gemm(w->z + r + w->k0 * w->m, w->m, HDI_CAST(int32_t, end - r), HDI_CAST(int32_t, n), buffer, o->mr, w->slices + (j - w->k1) * o->nr,
                    HDI_CAST(int32_t, u), HDI_CAST(int32_t, last - j));
        }
    }
}

/* Columns [r0,r1) of child c's Z22. */
static void hdi_real_inverse_child(const hdi_inverse_front *w, int32_t c, int64_t r0, int64_t r1) {
    const hdi_symbolic *s = w->f->sym;
    const int32_t *rel = s->rel + s->row_ptr[c];
    const int64_t u = hdi_front_below(s, c);
    double *to = w->f->work + s->update[c] + hdi_column_packed(u, r0);
    int64_t a, b;
    for (b = r0; b < r1; b++) {
        const double *from = hdi_real_inverse_at(w, rel[b]) - rel[b];
        for (a = b; a < u; a++) *to++ = from[rel[a]];
    }
}

/* ---- fronts ---- */

typedef enum hdi_inverse_stage { HDI_INVERSE_M, HDI_INVERSE_BELOW, HDI_INVERSE_CORNER, HDI_INVERSE_CHILD } hdi_inverse_stage;

/* One stage for rows [r0,r1). */
static void hdi_inverse_part(const hdi_inverse_front *w, hdi_inverse_stage stage, int32_t child, int64_t r0, int64_t r1, double *buffer) {
    const int real = w->f->width == 1;
    const int64_t n = w->k1 - w->k0, u = w->m - w->k1;
    switch (stage) {
        case HDI_INVERSE_M:
            if (real) hdi_real_inverse_m(w, r0, r1, buffer);
            else hdi_pack_inverse_m(w, r0, r1);
            break;
        case HDI_INVERSE_BELOW:
            if (real) hdi_real_inverse_below(w, r0, r1, buffer);
            else hdi_pack_inverse_below(w, r0, r1, buffer);
            break;
        case HDI_INVERSE_CORNER:                 /* slices: Z21 */
            if (real) hdi_real_cross(w, w->z + w->k0 * (w->m + 1), w->m, w->M, u, r0, r1, w->slices, n, u, buffer);
            else hdi_pack_inverse_corner(w, r0, r1);
            break;
        default:
            if (real) hdi_real_inverse_child(w, child, r0, r1);
            else hdi_pack_inverse_child(w, child, r0, r1);
    }
}

/* A stage of a large front, in chunks of rows shared by all threads. */
typedef struct hdi_inverse_share {
    const hdi_inverse *all;
    const hdi_inverse_front *w;
    hdi_inverse_stage stage;
    int32_t child;
    int64_t begin, end, chunk;
} hdi_inverse_share;

static void hdi_inverse_share_task(void *arg, int64_t index, int32_t worker) {
    const hdi_inverse_share *h = HDI_CAST(const hdi_inverse_share *, arg);
    const int64_t r0 = h->begin + index * h->chunk, r1 = hdi_least(r0 + h->chunk, h->end);
    (void)worker;
    hdi_inverse_part(h->w, h->stage, h->child, r0, r1, h->all->chunk + h->all->chunk_size * HDI_CAST(size_t, index));
}

/* Rows [begin,end) of a stage: at once, or with z as chunks. */
static void hdi_inverse_stage_run(const hdi_inverse *z, const hdi_inverse_front *w, hdi_inverse_stage stage, int32_t child, int64_t begin, int64_t end) {
    hdi_inverse_share h;
    if (end <= begin) return;
    if (!z) {
        hdi_inverse_part(w, stage, child, begin, end, w->buffer);
        return;
    }
    h.all = z;
    h.w = w;
    h.stage = stage;
    h.child = child;
    h.begin = begin;
    h.end = end;
    h.chunk = HDI_INV_CHUNK;
    if (stage == HDI_INVERSE_CORNER) h.chunk = HDI_REAL_MR;
    hdi_parallel(w->f->ctx, (end - begin + h.chunk - 1) / h.chunk, hdi_inverse_share_task, &h);
}

/* Entry (i,j) of Z, j <= i. */
static const double *hdi_inverse_at(const hdi_inverse_front *w, int64_t i, int64_t j) {
    int64_t run;
    return w->f->width == 1 ? hdi_real_inverse_at(w, j) + (i - j) : hdi_pack_inverse_at(w, i, j, &run);
}

/* sum_c coef[c] z_c for every set, to place `at`. */
static void hdi_inverse_put(const hdi_inverse *z, const double *from, int64_t at) {
    const int32_t width = z->f->width;
    int32_t q, c;
    for (q = 0; q < z->n_sets; q++) {
        const double *coef = z->coef + q * width;
        double sum = 0;
        for (c = 0; c < width; c++) sum += coef[c] * from[c];
        z->values[q * z->stride + at] += sum;
    }
}

/* ---- quadratic forms ---- */
/* x_j' Z x_j for all columns x_j of a symmetric X on the pattern of A, exactly. Where A is t L + theta B and X is B it is the diagonal of B Z B, which needs
 * entries of Z between neighbours of neighbours. Of x_j's non-zeros those that go before pivot j stand in fronts below that of j, called J, the others in
 * the rows of J. With y = L^-1 x_j,
 *     x_j' Z x_j = sum_{k below J} y_k^2/d_k + r' Z_JJ r,
 * r being what is left in the rows of J when the fronts below have been eliminated; and Z_JJ is there when J has been inverted. Plain transposes. Half of a mesh's
 * columns have nothing below, and r is x_j. The others go through the fronts on their ways to J in blocks; a front sees those that have come to it. Sweeps and
 * forms are three times the multiply-adds of the factorisation, of which whole solves would take 13 to 33 times.
 * The other exact way is an analysis on the pattern of B^2, whose selected inverse has all that B Z B needs. Both measured in turn, for a mesh of 50,000 vertices
 * with its column, in seconds of processor time: 0.67 here, 2.05 there, peak memory 345 and 1040 MB; at 150,000 vertices 2.9 and 10.3 s, 0.99 and 3.2 GB. So
 * this is the only one that is kept: twice the time of the diagonal of Z, and its memory. A million vertices take 48 s and 6.7 GB; there B^2 does not fit 24 GB. */

enum { HDI_FORM_COLS = 24, HDI_FORM_COLS_REAL = 8, HDI_FORM_SLOTS = 8, HDI_FORM_NEAR = 32 };
#define HDI_FORM_OPEN (HDI_CAST(uint64_t, 1) << 63)   /* of active: the front's rows are on the stack */

/* A block of columns of front J under way. Rows of fronts stand on a stack: a front's come when the first of its children that is touched is done, or it has none,
 * and are added to its parent's; so that there are never others than those of the front under way and of some of its ancestors. A row has the entries of the
 * columns that have come, and with a real factor those of eight, or of one. */
typedef struct hdi_form_block {
    const hdi_forms *q;
    const hdi_inverse_front *w;  /* J */
    const hdi_pair *list;        /* [k] first row and pivot of the columns */
    int32_t k;
    uint64_t *active;
    int32_t *column;
    double *top, *end;           /* of the stack */
    double *aside, *work;        /* rows of a child, and what Z r works with */
    double sum[HDI_CAST(int, HDI_FORM_COLS) * HDI_PACK];
} hdi_form_block;

/* The columns of a set, ascending; returns their number. */
static int32_t hdi_form_list(uint64_t set, int32_t *list) {
    int32_t c, n = 0;
    for (c = 0, set &= ~HDI_FORM_OPEN; set; c++, set >>= 1)
        if (set & 1) list[n++] = c;
    return n;
}

static int32_t hdi_form_count(uint64_t set) {
    int32_t n = 0;
    for (set &= ~HDI_FORM_OPEN; set; set &= set - 1) n++;
    return n;
}

/* Doubles of a row of k columns. */
static int32_t hdi_form_row(int32_t width, int32_t k) { return width > 1 ? width * k : k > 1 ? HDI_FORM_COLS_REAL : 1; }

/* Adds x to an entry. */
static void hdi_form_add(int32_t width, double x, double *to) {
    int32_t q;
    for (q = 0; q < (width == 1 ? 1 : 4); q++) to[q] += x;
}

/* Where pivot i of the matrix stands in the front. */
static int64_t hdi_form_place(const hdi_inverse_front *w, int32_t i) {
    const hdi_symbolic *s = w->f->sym;
    return i < s->super[w->v + 1] ? i - s->super[w->v] : w->p + hdi_lower_bound(s->row + s->row_ptr[w->v], w->u, i);
}

/* Rows of front v, cleared when they are new: they are on top of the stack. It has room for all: fronts are
 * worked on in the order of the tree, so that of the ways from J down to the front under way those fronts are
 * open that an earlier child has handed rows to, as hdi_form_rows counts them, and no front has more columns
 * than the block. */
static double *hdi_form_open(hdi_form_block *b, int32_t v, int32_t k) {
    const hdi_factor *f = b->w->f;
    const int64_t size = (hdi_front_pivots(f->sym, v) + hdi_front_below(f->sym, v)) * hdi_form_row(f->width, k);
    if (!(b->active[v] & HDI_FORM_OPEN)) {
        b->active[v] |= HDI_FORM_OPEN;
        HEATDIFF_ASSERT(size <= b->end - b->top);
        memset(b->top, 0, HDI_CAST(size_t, size) * sizeof *b->top);
        b->top += size;
    }
    return b->top - size;
}

/* Marks what the block's columns touch below J; returns the first. */
static int32_t hdi_form_touch(hdi_form_block *b) {
    const hdi_symbolic *s = b->w->f->sym;
    const int32_t first = s->super[b->w->v];
    int32_t c, v, least = b->w->v;
    int64_t p;
    for (c = 0; c < b->k; c++) {
        const int64_t row = s->perm[first + b->list[c].id];
        const uint64_t bit = HDI_CAST(uint64_t, 1) << c;
        for (p = b->q->a->row_ptr[row]; p < b->q->a->row_ptr[row + 1]; p++) {
            const int32_t i = b->q->inv[b->q->a->col[p]];
            if (i >= first || b->q->x[p] == 0) continue;
            v = s->super_of[i];
            if (v < least) least = v;
            for (; v != b->w->v && !(b->active[v] & bit); v = s->parent[v]) b->active[v] |= bit;
        }
    }
    return least;
}

/* Entries of x at the pivots of front v below J, those of the columns of set. */
static void hdi_form_below(const hdi_form_block *b, int32_t v, uint64_t set, double *y, int32_t row) {
    const hdi_symbolic *s = b->w->f->sym;
    const int32_t width = b->w->f->width, p = hdi_front_pivots(s, v), first = s->super[b->w->v], *rows = s->row + s->row_ptr[v];
    int64_t n;
    for (n = s->a_ptr[v]; n < s->a_ptr[v + 1]; n++) {
        const int32_t at = s->a_row[n] < p ? -1 : rows[s->a_row[n] - p] - first, c = at >= 0 && at < b->w->p ? b->column[at] : -1;
        double x;
        if (c < 0 || (x = b->q->x[s->a_from[n]]) == 0) continue;
        hdi_form_add(width, x, y + s->a_col[n] * HDI_CAST(int64_t, row) + width * hdi_form_count(set & ((HDI_CAST(uint64_t, 1) << c) - 1)));
    }
}

/* Entries of x in the rows of J, of all columns. */
static void hdi_form_own(const hdi_form_block *b, double *r, int32_t row) {
    const hdi_symbolic *s = b->w->f->sym;
    const int32_t width = b->w->f->width, first = s->super[b->w->v];
    int32_t c;
    int64_t p;
    for (c = 0; c < b->k; c++) {
        const int64_t of = s->perm[first + b->list[c].id];
        for (p = b->q->a->row_ptr[of]; p < b->q->a->row_ptr[of + 1]; p++) {
            const int32_t i = b->q->inv[b->q->a->col[p]];
            if (i >= first) hdi_form_add(width, b->q->x[p], r + hdi_form_place(b->w, i) * row + width * c);
        }
    }
}

/* sum += y^2/d of n pivots, for the k columns listed. */
static void hdi_form_squares(hdi_form_block *b, const double *dinv, const double *y, int32_t row, int64_t n, const int32_t *list, int32_t k) {
    const int32_t width = b->w->f->width;
    int64_t i;
    int32_t c, q;
    for (i = 0; i < n; i++, y += row, dinv += width) {
        for (c = 0; c < k; c++) {
            double *to = b->sum + width * list[c], t[HDI_PACK], z[HDI_PACK];
            if (width == 1) {
                *to += y[c] * y[c] * *dinv;
                continue;
            }
            hdi_pack_times(y + HDI_PACK * c, y + HDI_PACK * c, t);
            hdi_pack_times(t, dinv, z);
            for (q = 0; q < HDI_PACK; q++) to[q] += z[q];
        }
    }
}

/* What is left below the pivots of front v, to its parent: t by rows of the k columns listed. */
static void hdi_form_lift(hdi_form_block *b, int32_t v, const double *t, int32_t row, const int32_t *list, int32_t k) {
    const hdi_factor *f = b->w->f;
    const hdi_symbolic *s = f->sym;
    const int32_t up = s->parent[v], *rel = s->rel + s->row_ptr[v];
    const int64_t u = hdi_front_below(s, v);
    int32_t kept[HDI_FORM_COLS], to[HDI_FORM_COLS], n = up == b->w->v ? b->k : hdi_form_list(b->active[up], kept), c, a;
    int64_t i;
    double *rows;
    if (!(b->active[up] & HDI_FORM_OPEN)) {      /* where t stands now */
        memcpy(b->aside, t, HDI_CAST(size_t, u * row) * sizeof *t);
        t = b->aside;
    }
    for (c = a = 0; c < k; c++) {
        while (up != b->w->v && kept[a] != list[c]) a++;
        to[c] = up == b->w->v ? list[c] : a;
    }
    rows = hdi_form_open(b, up, n);
    n = hdi_form_row(f->width, n);
    for (i = 0; i < u; i++, t += row) {
        double *HDI_RESTRICT y = rows + rel[i] * HDI_CAST(int64_t, n);
        if (f->width > 1) f->pack->add(y, t, to, 0, k, 0);
        else
            for (c = 0; c < k; c++) y[to[c]] += t[c];
    }
}

/* Front v below J, for the columns that have come to it. */
static void hdi_form_front(hdi_form_block *b, int32_t v) {
    const hdi_factor *f = b->w->f;
    const int64_t p = hdi_front_pivots(f->sym, v);
    int32_t list[HDI_FORM_COLS];
    const int32_t k = hdi_form_list(b->active[v], list), row = hdi_form_row(f->width, k);
    double *y = hdi_form_open(b, v, k), *t = y + p * row;
    hdi_sweep z;
    memset(&z, 0, sizeof z);
    z.f = f;
    z.k = f->width == 1 ? row : k;
    hdi_form_below(b, v, b->active[v] & ~HDI_FORM_OPEN, y, row);
    if (f->width == 1) hdi_real_forward_front(&z, v, y, t);
    else hdi_pack_forward_front(&z, v, y, t);
    hdi_form_squares(b, f->dinv + HDI_CAST(int64_t, f->width) * f->sym->super[v], y, row, p, list, k);
    b->active[v] = 0;
    b->top = y;
    hdi_form_lift(b, v, t, row, list, k);
}

/* sum -= 2 r c, n rows of k columns. */
static void hdi_form_products(double *sum, const double *r, const double *c, int64_t n, int32_t k) {
    double t[HDI_PACK];
    int64_t i;
    int32_t j;
    int q;
    for (i = 0; i < n; i++) {
        for (j = 0; j < k; j++, r += HDI_PACK, c += HDI_PACK) {
            hdi_pack_times(r, c, t);
            for (q = 0; q < HDI_PACK; q++) sum[HDI_PACK * j + q] -= 2 * t[q];
        }
    }
}

/* sum += r' Z r for the rows of J: with W its lower triangle and half of its diagonal, 2 r' W r. c = -W r. */
static void hdi_pack_form(hdi_form_block *b, const double *r) {
    const hdi_inverse_front *w = b->w;
    const int64_t row = HDI_PACK * b->k;
    double *c = b->work, *buffer = c + HDI_INV_ROWS * row;
    hdi_pack_job g;
    int64_t i0, i, j, n;
    memset(&g, 0, sizeof g);
    g.a_col = g.b_row = HDI_PACK;
    g.b_col = g.c_row = row;
    g.c = c;
    for (i0 = 0; i0 < w->m; i0 += n) {
        n = hdi_least(HDI_INV_ROWS, w->m - i0);
        g.a = buffer;
        hdi_pack_inverse_gather(w, i0, i0 + n, i0, i0 + n, buffer);
        for (i = 0; i < HDI_PACK * n * n; i++) buffer[i] *= 0.5;
        g.depth = n;
        g.a_row = HDI_PACK * n;
        g.b = r + i0 * row;
        g.store = 1;
        w->f->pack->multiply(&g, 0, n, 0, b->k);
        g.store = 0;
        for (j = 0; j < i0; j += g.depth) {
            g.depth = hdi_least(HDI_INV_DEPTH, (j < w->p ? hdi_least(i0, w->p) : i0) - j);
            g.a = buffer;
            g.a_row = HDI_PACK * g.depth;
            g.b = r + j * row;
            if (j < w->p) {                      /* in place; blocks are of whole depths */
                const hdi_pack_block block = hdi_pack_block_of(w->z, w->m, w->p, j / HDI_PANEL);
                g.a = hdi_pack_at(&block, i0, j);
                g.a_row = block.row;
            } else {
                hdi_pack_inverse_gather(w, i0, i0 + n, j, j + g.depth, buffer);
            }
            w->f->pack->multiply(&g, 0, n, 0, b->k);
        }
        hdi_form_products(b->sum, r + i0 * row, c, n, b->k);
    }
}

static void hdi_real_form(hdi_form_block *b, const double *r, int32_t row) {
    const hdi_inverse_front *w = b->w;
    int64_t j;
    int32_t c;
    for (j = 0; j < w->m; j++) {
        const double *z = hdi_real_inverse_at(w, j), *x = r + j * row;
        double t[HDI_FORM_COLS_REAL] = {0};
        if (row == 1) t[0] = -hdi_dot(z + 1, x + 1, w->m - j - 1);
        else w->f->real->dots8(t, z + 1, w->m, w->m - j - 1, x + row, NULL, 1);
        for (c = 0; c < b->k; c++) b->sum[c] += x[c] * (z[0] * x[c] - 2 * t[c]);
    }
}

/* The forms of a block of columns. */
static void hdi_form_run(const hdi_inverse *z, hdi_form_block *b) {
    const hdi_symbolic *s = z->f->sym;
    const int32_t width = z->f->width, row = hdi_form_row(width, b->k);
    int32_t c, v;
    double *r;
    memset(b->sum, 0, sizeof b->sum);
    for (c = 0; c < b->k; c++) b->column[b->list[c].id] = c;
    for (v = hdi_form_touch(b); v < b->w->v; v++)
        if (b->active[v]) hdi_form_front(b, v);
    r = hdi_form_open(b, v, b->k);
    hdi_form_own(b, r, row);
    if (width == 1) hdi_real_form(b, r, row);
    else hdi_pack_form(b, r);
    b->active[v] = 0;
    for (c = 0; c < b->k; c++) {
        b->column[b->list[c].id] = -1;
        hdi_inverse_put(z, b->sum + width * c, s->super[v] + b->list[c].id);
    }
}

/* The form of pivot j's column when all of its non-zeros are in the rows of its front, and few: 1. Else 0, and the first of them. */
static int hdi_form_near(const hdi_inverse *z, const hdi_inverse_front *w, int64_t j, int32_t *least) {
    const hdi_symbolic *s = w->f->sym;
    const hdi_forms *q = z->forms;
    const int32_t first = s->super[w->v], width = w->f->width;
    const int64_t row = s->perm[first + j];
    int64_t at[HDI_FORM_NEAR], p;
    double x[HDI_FORM_NEAR], sum[HDI_PACK];
    int32_t n = 0, a, b, c;
    *least = HDI_CAST(int32_t, first + j);
    for (p = q->a->row_ptr[row]; p < q->a->row_ptr[row + 1]; p++) {
        const int32_t i = q->inv[q->a->col[p]];
        if (q->x[p] == 0) continue;
        if (i < *least) *least = i;
        if (n < HDI_FORM_NEAR) {
            at[n] = i;
            x[n] = q->x[p];
        }
        n++;
    }
    if (*least < first || n > HDI_FORM_NEAR) return 0;
    memset(sum, 0, sizeof sum);
    for (a = 0; a < n; a++) {
        at[a] = hdi_form_place(w, HDI_CAST(int32_t, at[a]));
        for (b = 0; b <= a; b++) {
            const double *from = hdi_inverse_at(w, at[a] > at[b] ? at[a] : at[b], at[a] > at[b] ? at[b] : at[a]), xx = (a == b ? 1 : 2) * x[a] * x[b];
            if (width == 1) sum[0] += xx * from[0];
            else
                for (c = 0; c < HDI_PACK; c++) sum[c] += xx * from[c];
        }
    }
    hdi_inverse_put(z, sum, first + j);
    return 1;
}

typedef struct hdi_form_job {
    const hdi_inverse *z;
    const hdi_inverse_front *w;
    const hdi_pair *list;
    int32_t n, n_blocks, begin;
} hdi_form_job;

/* Block begin + index, at a place of its own. */
static void hdi_form_task(void *arg, int64_t index, int32_t worker) {
    const hdi_form_job *job = HDI_CAST(const hdi_form_job *, arg);
    const hdi_forms *q = job->z->forms;
    const hdi_symbolic *s = job->z->f->sym;
    const int64_t at = job->begin + index, from = at * job->n / job->n_blocks, task = s->task_of[job->w->v];
    double *room = q->room + q->task_size * HDI_CAST(size_t, task >= 0 ? task : s->n_tasks) + (task >= 0 ? 0 : q->slot_size * HDI_CAST(size_t, index));
    hdi_form_block b;
    (void)worker;
    b.q = q;
    b.w = job->w;
    b.list = job->list + from;
    b.k = HDI_CAST(int32_t, (at + 1) * job->n / job->n_blocks - from);
    b.active = q->active + (task >= 0 ? 0 : (1 + index) * s->n_super);
    b.column = q->column + (task >= 0 ? task * s->task_pivots : HDI_CAST(int64_t, s->n_tasks) * s->task_pivots + index * s->largest_pivots);
    b.end = room + (task >= 0 ? q->task_size : q->slot_size);
    b.aside = room;
    b.work = room + (task >= 0 ? q->aside_task : q->aside_slot);
    b.top = b.work + (job->z->f->width == 1 ? 0 : HDI_CAST(size_t, HDI_PACK) * HDI_INV_ROWS * HDI_CAST(size_t, q->cols) + hdi_inverse_buffer(HDI_PACK));
    hdi_form_run(job->z, &b);
}

/* The forms of a front's pivots, one by one where that is possible, the others in blocks that do not depend on who works on them: at the top all threads do. Columns
 * that begin close to each other share more of their ways. */
static void hdi_forms_front(const hdi_inverse *z, const hdi_inverse_front *w) {
    const hdi_forms *q = z->forms;
    const hdi_symbolic *s = w->f->sym;
    const int32_t task = s->task_of[w->v];
    hdi_pair *order = q->order + HDI_CAST(int64_t, task >= 0 ? task : s->n_tasks) * s->task_pivots;
    hdi_form_job job;
    int64_t j;
    int32_t least;
    memset(&job, 0, sizeof job);
    for (j = 0; j < w->p; j++) {
        if (hdi_form_near(z, w, j, &least)) continue;
        order[job.n].key = HDI_CAST(uint64_t, least);
        order[job.n++].id = j;
    }
    if (job.n == 0) return;
    hdi_sort_pairs(order, job.n);
    job.z = z;
    job.w = w;
    job.list = order;
    job.n_blocks = (job.n + q->cols - 1) / q->cols;
    for (; job.begin < job.n_blocks; job.begin += task >= 0 ? 1 : q->n_slots) {
        if (task >= 0) hdi_form_task(&job, 0, 0);
        else hdi_parallel(w->f->ctx, hdi_least(job.n_blocks - job.begin, q->n_slots), hdi_form_task, &job);
    }
}

/* Rows on the stack at most, for columns of the fronts of subtrees and for those of all. need [n_super]. */
static void hdi_form_rows(const hdi_symbolic *s, int64_t *need, int64_t *in_tasks, int64_t *in_all) {
    int32_t v, k;
    *in_tasks = *in_all = 0;
    for (v = 0; v < s->n_super; v++) {
        const int64_t m = hdi_front_pivots(s, v) + hdi_front_below(s, v);
        need[v] = m;
        for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {   /* v's rows come after the first child */
            const int64_t sum = need[s->kid[k]] + (k > s->kid_ptr[v] ? m : 0);
            if (sum > need[v]) need[v] = sum;
        }
        if (need[v] > *in_all) *in_all = need[v];
        if (s->task_of[v] >= 0 && need[v] > *in_tasks) *in_tasks = need[v];
    }
}

static void hdi_forms_free(hdi_forms *q, hd_context *ctx) {
    hdi_free(ctx, q->inv);
    hdi_free(ctx, q->active);
    hdi_free(ctx, q->column);
    hdi_free(ctx, q->order);
    hdi_free(ctx, q->room);
    memset(q, 0, sizeof *q);
}

/* Room for the forms of x on the pattern of a, with factors of the given width. Blocks are narrower where the room for all that go on at the same time would be
 * more than half of the factor: on trees on which stacks grow high. */
static hd_status hdi_forms_make(hdi_forms *q, const hdi_symbolic *s, int32_t width, const hd_csr *a, const double *x, hd_context *ctx, hd_error *e) {
    hdi_scope keep = hdi_scope_begin(ctx, e);
    const uint64_t n_tasks = HDI_CAST(uint64_t, s->n_tasks), n_super = HDI_CAST(uint64_t, s->n_super), w = HDI_CAST(uint64_t, width);
    const int64_t stored = width == 1 ? s->panel[n_super] : s->stored;
    int64_t *need = HDI_TAKE(&keep, int64_t, n_super + 1), in_tasks, in_all;
    uint64_t columns, work, i;
    memset(q, 0, sizeof *q);
    if (e->status < 0) return hdi_scope_end(&keep);
    hdi_form_rows(s, need, &in_tasks, &in_all);
    q->a = a;
    q->x = x;
    q->n_slots = s->n_top ? HDI_FORM_SLOTS : 0;
    q->cols = width == 1 ? HDI_FORM_COLS_REAL : HDI_FORM_COLS;
    while (q->cols > 1 && q->cols * (s->n_tasks * in_tasks + q->n_slots * in_all) > stored / 2 + 65536) q->cols = width == 1 ? 1 : q->cols / 2;
    work = width == 1 ? 0 : w * HDI_INV_ROWS * HDI_CAST(uint64_t, q->cols) + hdi_inverse_buffer(width);
    q->aside_task = HDI_CAST(uint64_t, s->task_update) * HDI_CAST(uint64_t, q->cols) * w;
    q->aside_slot = HDI_CAST(uint64_t, s->largest_update) * HDI_CAST(uint64_t, q->cols) * w;
    q->task_size = q->aside_task + work + HDI_CAST(uint64_t, in_tasks) * HDI_CAST(uint64_t, q->cols) * w;
    q->slot_size = q->aside_slot + work + HDI_CAST(uint64_t, in_all) * HDI_CAST(uint64_t, q->cols) * w;
    columns = n_tasks * HDI_CAST(uint64_t, s->task_pivots) + HDI_CAST(uint64_t, q->n_slots) * HDI_CAST(uint64_t, s->largest_pivots);
    q->inv = HDI_TAKE(&keep, int32_t, s->n);
    q->active = HDI_CAST(uint64_t *, hdi_take_zero(&keep, (1 + HDI_CAST(uint64_t, q->n_slots)) * n_super, sizeof(uint64_t)));
    q->column = HDI_TAKE(&keep, int32_t, columns);
    q->order = HDI_TAKE(&keep, hdi_pair, n_tasks * HDI_CAST(uint64_t, s->task_pivots) + HDI_CAST(uint64_t, s->largest_pivots));
    q->room = HDI_TAKE(&keep, double, n_tasks * q->task_size + HDI_CAST(uint64_t, q->n_slots) * q->slot_size);
    if (e->status >= 0) {
        for (i = 0; i < HDI_CAST(uint64_t, s->n); i++) q->inv[s->perm[i]] = HDI_CAST(int32_t, i);
        for (i = 0; i < columns; i++) q->column[i] = -1;
        hdi_free(ctx, need);
        keep.n = 0;
        return HD_OK;
    }
    memset(q, 0, sizeof *q);
    return hdi_scope_end(&keep);
}

/* ---- the run ---- */

/* What is wanted of the front's columns. */
static void hdi_inverse_emit(const hdi_inverse *z, const hdi_inverse_front *w) {
    const hdi_symbolic *s = w->f->sym;
    int64_t n;
    if (z->wanted == HDI_WANT_FORMS) hdi_forms_front(z, w);
    else if (z->wanted == HDI_WANT_DIAGONAL)
        for (n = 0; n < w->p; n++) hdi_inverse_put(z, hdi_inverse_at(w, n, n), s->super[w->v] + n);
    else
        for (n = s->a_ptr[w->v]; n < s->a_ptr[w->v + 1]; n++) hdi_inverse_put(z, hdi_inverse_at(w, s->a_row[n], s->a_col[n]), n);
}

/* Z of front v, whose Z22 is there: its columns, what is wanted of them, and the children's Z22. shared: all threads, else this one. */
static void hdi_inverse_front_run(const hdi_inverse *z, int32_t v, double *scratch, int shared) {
    const hdi_symbolic *s = z->f->sym;
    const hdi_inverse *all = shared ? z : NULL;
    const int real = z->f->width == 1;
    hdi_inverse_front w = hdi_inverse_open(z->f, v, scratch);
    int32_t k;
    hdi_factor_fetch(z->f, v, 1);
    for (w.k0 = (w.p - 1) / HDI_PANEL * HDI_PANEL; w.k0 >= 0; w.k0 -= HDI_PANEL) {
        w.k1 = hdi_least(w.k0 + HDI_PANEL, w.p);
        if (real) hdi_real_inverse_pivots(&w);
        else hdi_pack_inverse_pivots(&w);
        if (w.k1 == w.m) continue;
        hdi_inverse_stage_run(all, &w, HDI_INVERSE_M, 0, w.k1, w.m);
        if (real) hdi_real_slices(w.slices, z->f->real->nr, w.M, w.m - w.k1, w.m - w.k1, w.k1 - w.k0);
        hdi_inverse_stage_run(all, &w, HDI_INVERSE_BELOW, 0, w.k1, w.m);
        if (real) hdi_real_slices(w.slices, z->f->real->nr, w.z + w.k1 + w.k0 * w.m, w.m, w.m - w.k1, w.k1 - w.k0);
        hdi_inverse_stage_run(all, &w, HDI_INVERSE_CORNER, 0, 0, w.k1 - w.k0);
    }
    hdi_inverse_emit(z, &w);
    for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) hdi_inverse_stage_run(all, &w, HDI_INVERSE_CHILD, s->kid[k], 0, hdi_front_below(s, s->kid[k]));
}

static void hdi_inverse_task(void *arg, int64_t index, int32_t worker) {
    hdi_inverse *z = HDI_CAST(hdi_inverse *, arg);
    const hdi_symbolic *s = z->f->sym;
    const int64_t i = s->n_tasks - 1 - index;
    int32_t v;
    if (HDI_LOAD(&z->stop)) return;
    if (worker == 0 && hdi_progress(z->f->ctx, "invert", z->done + (1 - z->done) * HDI_CAST(double, index) / s->n_tasks, &z->error) < 0) HDI_STORE(&z->stop, 1);
    for (v = s->task_end[i]; v-- > s->task_begin[i] && !HDI_LOAD(&z->stop);) hdi_inverse_front_run(z, v, z->scratch + z->scratch_size * HDI_CAST(size_t, i), 0);
}

static void hdi_inverse_free(hdi_inverse *z, hd_context *ctx) {
    hdi_free(ctx, z->scratch);
    hdi_free(ctx, z->chunk);
    z->scratch = z->chunk = NULL;
}

/* Room to invert factors of the given width. */
static hd_status hdi_inverse_make(hdi_inverse *z, const hdi_symbolic *s, int32_t width, hd_context *ctx, hd_error *e) {
    const int64_t *at = width == 1 ? s->panel : s->panel_pack;
    const int32_t n_chunks = s->largest_front / HDI_INV_CHUNK + HDI_CAST(int32_t, HDI_PANEL) / HDI_REAL_MR + 2;
    int32_t v;
    memset(z, 0, sizeof *z);
    for (v = 0; v < s->n_super; v++) {
        const int64_t p = hdi_front_pivots(s, v), m = p + hdi_front_below(s, v);
        const uint64_t size = hdi_inverse_scratch(m, p, at[v + 1] - at[v], width);
        if (size > z->top_size) z->top_size = size;
        if (s->task_of[v] >= 0 && size > z->scratch_size) z->scratch_size = size;
    }
    z->chunk_size = hdi_inverse_buffer(width);
    z->scratch = HDI_CAST(double *, hdi_alloc(ctx, z->scratch_size * HDI_CAST(uint64_t, s->n_tasks) + z->top_size, sizeof(double), e));
    if (z->scratch) z->chunk = HDI_CAST(double *, hdi_alloc(ctx, s->n_top ? z->chunk_size * HDI_CAST(uint64_t, n_chunks) : 1, sizeof(double), e));
    if (!z->chunk) hdi_inverse_free(z, ctx);
    return e->status;
}

/* Inverts the factor; coef, n_sets, wanted (with forms, its x), values and stride are set. Uses the space of the factor's update matrices. */
static hd_status hdi_inverse_run(hdi_inverse *z, hdi_factor *f, hd_error *e) {
    const hdi_symbolic *s = f->sym;
    int32_t i;
    z->f = f;
    z->stop = 0;
    z->done = s->n_top > 0 ? 0.5 : 0;
    hdi_error_clear(&z->error);
    for (i = s->n_top; i-- > 0 && !z->stop;) {
        const int32_t v = s->top[i];
        const int64_t m = hdi_front_pivots(s, v) + hdi_front_below(s, v);
        if (hdi_progress(f->ctx, "invert", 0.5 * (s->n_top - 1 - i) / s->n_top, &z->error) < 0) z->stop = 1;
        else hdi_inverse_front_run(z, v, z->scratch + z->scratch_size * HDI_CAST(size_t, s->n_tasks), m >= 2 * HDI_INV_CHUNK);
    }
    if (!z->stop) hdi_parallel(f->ctx, s->n_tasks, hdi_inverse_task, z);
    if (z->error.status < 0) *e = z->error;
    return e->status;
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
        HDI_PREFETCH_AT(u, ptr[i] + HDI_AHEAD / 4);
        HDI_PREFETCH_AT(col, ptr[i] + HDI_AHEAD);
        for (p = ptr[i]; p < ptr[i + 1]; p++) z[col[p]] = hdi_csub(z[col[p]], hdi_cmul(u[p], w));
    }
    for (i = n; i-- > 0;) {
        hd_c64 w = hdi_cmul(z[i], m->d_inv[i]);
        HDI_PREFETCH_AT(u, ptr[i] - HDI_AHEAD / 4);
        HDI_PREFETCH_AT(col, ptr[i] - HDI_AHEAD);
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
        HDI_PREFETCH_AT(Lx, p + HDI_AHEAD);
        HDI_PREFETCH_AT(Aj, p + HDI_AHEAD);
        if (Bx) {
            HDI_PREFETCH_AT(Bx, p + HDI_AHEAD);
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

/* Error in the B norm, relative to u and times 1/sqrt(b_ratio), as seen. The recurrence stops at a tenth of it. */
#define HDI_MASS_TOL 1e-14

/* Condition of diag(B)^-1 B is at most 4 for linear elements: about 30 steps to rounding. work [3 n]. */
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
 * Pole sets: the constants, evaluation, lookup; sets for many times, and their weights by least squares. May call [06].
 * This work is based on
 *   W. Cody, G. Meinardus, R. Varga, Chebyshev rational approximations to e^-x in [0, inf), 1969
 *   A. Carpenter, A. Ruttan, R. Varga, Extended numerical computations on the "1/9" conjecture, 1984 (the errors, to many digits)
 * The table is printed by tools/poles.py, which also checks it. Deviation: the paper takes coefficients from E. Gallopoulos and Y. Saad,
 * Efficient solution of parabolic equations by Krylov approximation methods, 1992, whose order-14 table is wrong in its last digits. */

/* poles.py: begin */
/* Computed by tools/poles.py, which also checks these digits. For every set: a0, max |e|, max W|e| (0 for
 * uniform sets, where it would be the same); then per pole Re theta, Im theta, Re a, Im a, the real pole first (odd r),
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
    /* diagonal r = 2 */
    0, 0.067537133737907679, 0.084246004368216873,
    0.093165638432949657, 0.78606720760465709, 0.0084246004368216873, -0.39955314986781715,
    /* diagonal r = 3 */
    0, 0.008827961386663535, 0.010442809434321652,
    0.82583993214481199, 0, -0.6708823891869552, 0,
    -0.38137972156259914, 1.879992248278864, 0.33439691365004542, -0.11579931529770687,
    /* diagonal r = 4 */
    0, 0.0011772217643792788, 0.0013423623600534568,
    0.95364093252912396, 0.99014596020921519, -0.14238645345641066, -0.8903168914974795,
    -1.0137929984233569, 3.0436577814491423, 0.14252068969241599, 0.17704643017030255,
    /* diagonal r = 5 */
    0, 0.00015286872126302198, 0.00017020187449105295,
    1.5305988264114367, 0, -1.5071962916274879, 0,
    0.79496963375585472, 2.0648242488303703, 0.81999666196924936, -0.39763577394813476,
    -1.7386371635751181, 4.2421940249737515, -0.066415536342954523, 0.10612573631193803,
    /* diagonal r = 6 */
    0, 1.9404126482242763e-05, 2.1243136355080079e-05,
    1.7403291915150134, 1.0508777810170973, -0.46945354680866597, -1.9337112147649937,
    0.46845091128664179, 3.1874731275997692, 0.53058373822256644, 0.53195920721973822,
    -2.5242654997752321, 5.4646451895220576, -0.061128067100264978, -0.014778077847248062,
    /* diagonal r = 7 */
    0, 2.412596399658805e-06, 2.6085677357032684e-06,
    2.2587108249348247, 0, -3.2523445692370117, 0,
    1.7285599625302293, 2.1435592178425069, 1.8605988718308413, -1.1049045554843731,
    0.02975382932653408, 4.3426481816353268, -0.23226156481092178, 0.48607958827629705,
    -3.3534714915089023, 6.7059077028578731, -0.0021652832581871267, -0.029590579663120412,
    /* diagonal r = 8 */
    0, 2.9479288418651553e-07, 3.1570971228532059e-07,
    2.5142509751129301, 1.0823272318226731, -1.1972697412305799, -4.1920853464776231,
    1.5665766326190609, 3.2671178582916962, 1.5321217388024098, 1.3129169180216853,
    -0.49031600390114177, 5.5221078207391807, -0.3473011302864667, -0.037278309794394476,
    -4.2159324328825925, 7.962476104494943, 0.012449164285608104, -0.0048644027630989142,
    /* diagonal r = 9 */
    0, 3.5524614672975907e-08, 3.7759512940471612e-08,
    3.0037632063722302, 0, -7.0120532960817847, 0,
    2.5889719865228709, 2.1905146441527563, 4.1540003879217764, -2.7667114907450197,
    1.2945586667253488, 4.4144394949515586, -0.60444229963006224, 1.5552295032232204,
    -1.0729254816698168, 6.7203973595020807, -0.047105620203199583, -0.20446296144071352,
    -5.1049774011321016, 9.2312447202954093, 0.0035741761764263497, 0.0045788157819185576,
    /* diagonal r = 10 */
    0, 4.2342178872084898e-09, 4.4732537833884187e-09,
    3.2873924431636969, 1.1022552213870953, -2.8289920084429534, -9.1064874041311423,
    2.5302908088373912, 3.3198444586612692, 3.9838641796477434, 3.0606974631135127,
    0.93765342127352547, 5.5805918225656841, -1.2543801051059043, -0.037404810718164969,
    -1.7055012565967682, 7.9336742051217808, 0.1009434281265153, -0.062378797736551063,
    -6.0159168215796504, 10.509773539372675, -0.0014354937780756717, 0.0019882812866436638,
    /* diagonal r = 11 */
    0, 5.0021846689596646e-10, 5.2580978086542119e-10,
    3.7589461970886253, 0, -15.148948949204554, 0,
    3.4181443270160519, 2.2221329996842121, 9.2125981360945897, -6.5902805609642856,
    2.3683553134810875, 4.4666139801276348, -1.4193485357460269, 4.3238105206994364,
    0.5128455800316476, 6.7620649790154106, -0.26684733005187411, -0.83260767428322346,
    -2.379100613238514, 9.1591928578650474, 0.049022113704178832, 0.040992343240600949,
    -6.9452579838979789, 11.79627716879928, -0.00094990945117058828, -0.00034571181787770053,
    /* diagonal r = 12 */
    0, 5.8661050518504886e-11, 6.1403279086032692e-11,
    4.0610869219941961, 1.116048086453026, -6.4724526450927371, -19.800986950452625,
    3.4300936656689154, 3.3573104594890664, 9.8055149092097036, 6.9636278019653055,
    2.1236663707526828, 5.6279851297529859, -3.777063165087494, 0.094270513988374965,
    0.032242520993688462, 7.9562992640911672, 0.45627066834523922, -0.34492929621099749,
    -3.0870878465596405, 10.394946906715006, -0.012301681054688813, 0.030667347038706546,
    -7.8903128787456671, 13.089450497161112, 3.1913686116974329e-05, -0.00040712600366819992,
    /* diagonal r = 13 */
    0, 6.8365743495114318e-12, 7.1306418567934206e-12,
    4.5202913913027034, 0, -32.783137527896145, 0,
    4.2310263506800085, 2.2448762717592685, 20.347189887795118, -15.274130373091314,
    3.3465717998601754, 4.5057579496393751, -3.1850618922459386, 11.17507781679377,
    1.8108756340281571, 6.8017763374151308, -1.0492043791856276, -2.7209511380543314,
    -0.49517616961888949, 9.1613738263301858, 0.29495176440813958, 0.19748383147240292,
    -3.8243861741232053, 11.639423888576662, -0.016465925177306037, -0.0011879972207539352,
    -8.8489656005868085, 14.388310285612475, 0.00015930835297385204, -3.0280580654715494e-05,
    /* diagonal r = 14 */
    0, 7.9251842589203527e-13, 8.2407404085801184e-13,
    4.8355707150445477, 1.1261687721267875, -14.567599485838048, -43.080327612915774,
    4.294404025993809, 3.3852827675703461, 23.360062602508137, 15.644916006216233,
    3.1843260042494643, 5.6657810904450612, -10.340872607797349, 0.68524673717873286,
    1.4408641893813143, 7.986286821448644, 1.6044788633921492, -1.3795300766921736,
    -1.0625421595687834, 10.375806417114624, -0.054252691775587503, 0.20350620469919772,
    -4.5870160409811707, 12.891449259479609, -0.0018442580277614033, -0.0077932972131342215,
    -9.8195193949567514, 15.692091318644374, 2.7577538544225898e-05, 5.7130444708159529e-05,
};
/* poles.py: end */

enum { HDI_RAT_UNIFORM_MAX = 14, HDI_RAT_KERNEL_MIN = 2, HDI_RAT_KERNEL_MAX = 14 };   /* diagonal sets too */

static int32_t hdi_rat_size(int32_t degree) { return 3 + 4 * ((degree + 1) / 2); }

static hd_status hdi_rational_get(hd_rational *out, hd_pole_kind kind, int32_t degree, hd_error *e) {
    const double *row = hdi_rat_table;
    int32_t r, i;
    if (kind != HD_POLES_UNIFORM && kind != HD_POLES_KERNEL && kind != HD_POLES_DIAGONAL)
        return hdi_fail(e, HD_ERR_ARGUMENT, "pole set: the kind is uniform, kernel or diagonal");
    if (kind == HD_POLES_UNIFORM && (degree < 1 || degree > HDI_RAT_UNIFORM_MAX))
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "pole set: uniform sets have degrees 1 to 14", -1, -1, degree);
    if (kind != HD_POLES_UNIFORM && (degree < HDI_RAT_KERNEL_MIN || degree > HDI_RAT_KERNEL_MAX))
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "pole set: kernel and diagonal sets have degrees 2 to 14", -1, -1, degree);
    for (r = 1; r < (kind == HD_POLES_UNIFORM ? degree : HDI_RAT_UNIFORM_MAX + 1); r++) row += hdi_rat_size(r);
    for (r = HDI_RAT_KERNEL_MIN; kind == HD_POLES_DIAGONAL && r <= HDI_RAT_KERNEL_MAX; r++) row += hdi_rat_size(r);
    for (r = HDI_RAT_KERNEL_MIN; kind != HD_POLES_UNIFORM && r < degree; r++) row += hdi_rat_size(r);
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
    if (!hdi_finite(set->a0) || hdi_nan(set->max_error) || set->max_error < 0 ||
        hdi_nan(set->max_weighted_error) || set->max_weighted_error < 0)
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

/* ---- shared sets ---- */
/* Poles that serve all times t in [t0, lambda t0], with weights of their own for each: t0 L + theta_i B is factorised once. With tau = t/t0 and the eigenvalue
 * of t0 B^-1 L called y = -x,
 *     exp(-tau y) ~ c(x) = 2 Re sum_i a_i(tau)/(x - theta_i),   a0 = 0, c(0) = 1,   error measured as (1 + tau y)|e|,
 * which is the measure of the kernel sets, for every tau. As a set for the time t itself, in hd_rational's terms, it reads tau theta_i, tau a_i.
 * This work is based on
 *   M. Lopez-Fernandez, C. Palencia, A. Schaedle, A spectral order method for inverting sectorial Laplace transforms, 2006: one contour for many times
 *   G. Golub, V. Pereyra, The differentiation of pseudo-inverses and nonlinear least squares problems whose variables separate, 1973 (in the script)
 *   C. Lawson, Contributions to the theory of linear least maximum approximation, 1961: least squares whose weights follow the error
 *   H. Ehlich, K. Zeller, Schwankung von Polynomen zwischen Gitterpunkten, 1964: the bound between points
 * Deviation: the poles are free, not on a hyperbola, which needs twice as many. The table is printed by tools/shared_poles.py (about 15 minutes), which
 * also checks it. */

/* shared_poles.py: begin */
/* Computed by tools/shared_poles.py, which also checks it. For every set: the largest ratio of times, number of pairs, largest weighted error
 * over all times (with rounding), largest sum 2 |a_i|/distance; then Re theta, Im theta of one of each pair, by ascending |theta|. Pairs ascend, and for each the
 * ratio. */
static const double hdi_shared_table[] = {
    1.8, 8, 9.79e-11, 24.3,
        2.50109297, 0.637058254, 2.17122959, 1.9179449, 1.49504902, 3.22060516, 0.436050967, 4.5644826,
        -1.07297888, 5.97718894, -3.15771065, 7.50082094, -6.07844808, 9.20332631, -10.5021249, 11.2188529,
    3.2, 8, 4.51e-09, 20,
        1.32441677, 0.395660883, 1.101686, 1.19827716, 0.643733983, 2.03754677, -0.078695318, 2.94869249,
        -1.12636701, 3.98942629, -2.64066158, 5.25101642, -4.94521348, 6.83154739, -8.76839225, 8.81974826,
    5.6, 8, 6.2e-08, 18.4,
        0.733524945, 0.245618174, 0.586586632, 0.749369194, 0.284720456, 1.29504979, -0.190295942, 1.92911923,
        -0.890396896, 2.74598052, -1.99998364, 3.88597908, -3.91266907, 5.4267002, -7.36220023, 7.39950913,
    10, 8, 4.54e-07, 15.7,
        0.38933325, 0.147131123, 0.295244873, 0.453067749, 0.103637894, 0.799453759, -0.191288461, 1.240481,
        -0.644255821, 1.90273983, -1.48095429, 2.93701838, -3.1068834, 4.41109813, -6.26071086, 6.32649569,
    18, 8, 2.51e-06, 15.7,
        0.214272192, 0.0871084771, 0.156889452, 0.270601827, 0.042367231, 0.487479442, -0.124726046, 0.798145365,
        -0.406624133, 1.34498027, -1.0314075, 2.27947063, -2.41635335, 3.68404484, -5.35829886, 5.55491346,
    32, 8, 9.02e-06, 15,
        0.118042015, 0.0515884795, 0.0834045137, 0.161802265, 0.0173343816, 0.297422085, -0.0684957203, 0.52445475,
        -0.254136191, 0.988519521, -0.746168995, 1.82612054, -1.95659371, 3.15503623, -4.67447313, 4.96927567,
    3.2, 12, 2.17e-12, 115,
        1.92786655, 0.413936484, 1.76523526, 1.25239208, 1.42646511, 2.12385622, 0.872061738, 3.03550226,
        0.0952089587, 3.94546451, 2.65349177, 4.0580223, -0.855927806, 4.89644448, -2.03717695, 5.99336073,
        -3.58576175, 7.30691663, -5.70793179, 8.88480747, -8.73677694, 10.7613992, -13.3826341, 13.0290528,
    5.6, 12, 9.32e-12, 124,
        1.1156037, 0.244935271, 1.01633585, 0.740033436, 0.815110899, 1.25163143, 0.506399449, 1.79370278,
        0.0813178661, 2.38531942, -0.474906106, 3.05499222, -1.19221576, 3.84895279, -2.14278852, 4.83216407,
        -3.46555416, 6.06263479, -5.37145261, 7.56888175, -8.18037212, 9.3672187, -12.5825862, 11.5383919,
    10, 12, 1.93e-10, 109,
        0.606585192, 0.148983193, 0.54319089, 0.451972033, 0.415106696, 0.771028768, 0.220043205, 1.12005973,
        -0.0459325315, 1.51967857, -0.389714287, 2.00894493, -0.84546104, 2.65611845, -1.51195213, 3.53553745,
        -2.54295616, 4.69603533, -4.15435782, 6.15594187, -6.66529732, 7.9245182, -10.7595029, 10.0667408,
    18, 12, 2.16e-09, 97.7,
        0.328962352, 0.0880300632, 0.289601762, 0.268133723, 0.210193247, 0.461773649, 0.0913926425, 0.681916346,
        -0.0636021013, 0.947559948, -0.260749437, 1.30987101, -0.549944731, 1.84805265, -1.03014202, 2.6216911,
        -1.84840448, 3.67929769, -3.21733837, 5.05592273, -5.47230152, 6.76249101, -9.29215097, 8.84998249,
    32, 12, 1.7e-08, 79.7,
        0.177202298, 0.0519617469, 0.152750504, 0.159216606, 0.104541218, 0.277132154, 0.0341451571, 0.414794873,
        -0.0538528238, 0.594104209, -0.167585098, 0.878697855, -0.360987965, 1.32667456, -0.720456336, 1.99136857,
        -1.38193402, 2.9442927, -2.56106306, 4.2259948, -4.60787875, 5.86756232, -8.21967815, 7.8867613,
    56, 12, 7.66e-08, 73.3,
        0.0993568233, 0.0308234041, 0.0841852586, 0.0948445007, 0.0542988842, 0.166796695, 0.0131936378, 0.255529272,
        -0.0278836613, 0.383826235, -0.0907624424, 0.600965888, -0.220519481, 0.970561357, -0.485486654, 1.53862809,
        -1.01407985, 2.3837056, -2.0164049, 3.57541408, -3.86254354, 5.15030042, -7.26625035, 7.12979997,
    100, 12, 3.46e-07, 59.4,
        0.0530389084, 0.0179228913, 0.0439461227, 0.0554515394, 0.0263011935, 0.0988436724, 0.00718078393, 0.154108391,
        -0.00978519934, 0.243091575, -0.0500451638, 0.409037963, -0.137848822, 0.699945077, -0.329748706, 1.18016961,
        -0.748359617, 1.92880072, -1.61152021, 3.04158614, -3.30046912, 4.55775039, -6.53123522, 6.47410686,
    180, 12, 1.07e-06, 50.7,
        0.0285941084, 0.00994811629, 0.0229792954, 0.0309253101, 0.0121923203, 0.0558979263, 0.00111338944, 0.0899480106,
        -0.00798721408, 0.159837539, -0.024220834, 0.288660417, -0.078465602, 0.524091584, -0.21781435, 0.931026694,
        -0.545008886, 1.58819196, -1.26124874, 2.62464373, -2.77671099, 4.10970812, -5.83383351, 6.05346785,
    320, 12, 2.87e-06, 47.7,
        0.0157490918, 0.00582992582, 0.01260877, 0.0181504325, 0.00663251864, 0.03255651, 0.00210384752, 0.0568802507,
        0.000720397382, 0.107742233, -0.00693788102, 0.20602894, -0.045822937, 0.391295126, -0.146709749, 0.734909428,
        -0.407452202, 1.32080078, -1.02972846, 2.28928991, -2.43159676, 3.72062216, -5.39962473, 5.61568469,
    560, 12, 7.03e-06, 52,
        0.00923946347, 0.003264387, 0.00734281524, 0.0101701597, 0.00372483133, 0.0184677681, 0.00220149636, 0.0333054682,
        -0.000345333209, 0.0670142119, -0.00742535811, 0.139153149, -0.0286477173, 0.283066178, -0.0997049815, 0.557471453,
        -0.310134676, 1.05573276, -0.832613436, 1.91747976, -2.08683304, 3.25909057, -4.85860887, 5.06175102,
    18, 16, 7.76e-12, 614,
        0.439898626, 0.088131475, 0.40985611, 0.266676728, 0.349438118, 0.452375522, 0.25812409, 0.651104361,
        0.135527886, 0.870562279, -0.0178680881, 1.1223819, -0.201658858, 1.42682694, -0.422791448, 1.81745393,
        -0.709483143, 2.3490016, -1.13854861, 3.05825336, -1.78165982, 3.95569018, -2.71937754, 5.06474782,
        -4.08305414, 6.41548739, -6.06366168, 8.02037619, -8.9647154, 9.89964046, -13.4684954, 12.1438193,
    32, 16, 3.21e-11, 503,
        0.239979628, 0.0522198928, 0.221428734, 0.158410161, 0.184227279, 0.270149529, 0.128377873, 0.392170289,
        0.0549572499, 0.531264638, -0.0334503759, 0.697107668, -0.130641414, 0.917707036, -0.261849279, 1.23196742,
        -0.460129267, 1.66670093, -0.762517255, 2.2591175, -1.24904709, 3.05467435, -2.01931755, 4.06497731,
        -3.1911992, 5.31830923, -4.95947908, 6.83703917, -7.6349403, 8.63821936, -11.8967707, 10.7956955,
    56, 16, 2.31e-10, 406,
        0.132689893, 0.0311164192, 0.121172518, 0.0946524895, 0.0981824369, 0.16238504, 0.0642855232, 0.237904775,
        0.0205363427, 0.326357792, -0.0246641236, 0.43994886, -0.0774865261, 0.607949214, -0.155812711, 0.853682685,
        -0.277471115, 1.21687052, -0.505332599, 1.73563076, -0.897530204, 2.43074221, -1.52579436, 3.34032435,
        -2.53020949, 4.51846715, -4.12002571, 5.98425334, -6.61447156, 7.74953009, -10.6969522, 9.87688976,
    100, 16, 1.55e-09, 328,
        0.071778581, 0.0180091365, 0.064929363, 0.0549345551, 0.0513668139, 0.0945655731, 0.030965224, 0.139572435,
        0.00751997286, 0.195492225, -0.0134487186, 0.270963005, -0.038950508, 0.400952062, -0.0899222901, 0.593564172,
        -0.180087998, 0.872801566, -0.329204345, 1.29660715, -0.626362178, 1.90358592, -1.13825508, 2.71607212,
        -1.99040331, 3.8027171, -3.39889748, 5.19303039, -5.68772851, 6.90515034, -9.53616096, 8.99857641,
    180, 16, 7.74e-09, 246,
        0.0381243456, 0.010209765, 0.0339090032, 0.0312942265, 0.0257300952, 0.0545648443, 0.014680896, 0.0814622705,
        0.00235050827, 0.114911654, -0.00506598999, 0.17229441, -0.021196038, 0.265867459, -0.0473718828, 0.407670916,
        -0.100607427, 0.645861608, -0.224220676, 0.997425451, -0.456542014, 1.49956027, -0.861273913, 2.22504603,
        -1.59739315, 3.23053883, -2.86791088, 4.54770837, -5.01194321, 6.20295728, -8.72850258, 8.23098972,
    320, 16, 2.98e-08, 181,
        0.0203114988, 0.00590460591, 0.0178692834, 0.0181319292, 0.0131840691, 0.0316447414, 0.00650703225, 0.047392023,
        0.00126091059, 0.0706752786, -9.8406006e-05, 0.109242403, -0.00918694067, 0.179587901, -0.0311220956, 0.289568892,
        -0.0599706248, 0.470198144, -0.144231372, 0.766676172, -0.323587206, 1.19458338, -0.648886269, 1.84644067,
        -1.27875811, 2.77461629, -2.40644509, 4.03224615, -4.39133524, 5.66062872, -7.92821025, 7.68599907,
    560, 16, 8.63e-08, 163,
        0.0114104116, 0.00341569632, 0.00987515058, 0.0105649003, 0.0070643226, 0.0187725583, 0.00396773758, 0.0283609532,
        0.00225025417, 0.0427136203, 0.00247325118, 0.072295592, -0.0025624665, 0.119407517, -0.00689143749, 0.205603102,
        -0.03552388, 0.350904948, -0.0994080939, 0.580481578, -0.21344774, 0.945835538, -0.479956357, 1.52124037,
        -1.00877089, 2.36899266, -2.01493635, 3.55591307, -3.85979096, 5.12473561, -7.26389966, 7.10217198,
    1000, 16, 3.93e-07, 127,
        0.00610948015, 0.00190882205, 0.00527701114, 0.00586321222, 0.00358734254, 0.0102249551, 0.00134657829, 0.0158754361,
        0.000660637871, 0.0265106564, 0.00121056914, 0.044595923, -0.00121660452, 0.0814061348, -0.00580940122, 0.136675814,
        -0.0202087683, 0.248160847, -0.0693408603, 0.432282039, -0.150992399, 0.731050942, -0.356949172, 1.22501382,
        -0.79639811, 1.98928011, -1.67582746, 3.10569692, -3.38024638, 4.63510107, -6.64071793, 6.56484471,
    1800, 16, 6.57e-07, 121,
        0.00334705732, 0.00110379449, 0.00285503655, 0.00342660974, 0.00193915235, 0.00612930592, 0.00163520018, 0.00936933322,
        0.0016429126, 0.0155404153, 0.0021950836, 0.0305202503, 0.00423779506, 0.0533655632, 0.00180774774, 0.103260991,
        -0.00974171098, 0.187577233, -0.0239239293, 0.333761144, -0.100365632, 0.601309997, -0.26296855, 1.03784104,
        -0.635159522, 1.74398167, -1.43168658, 2.80202834, -3.02023506, 4.27389596, -6.1245932, 6.18677233,
    3200, 16, 1.44e-06, 164,
        0.00199081633, 0.000616876591, 0.00172355324, 0.00190930985, 0.00123789351, 0.00335550898, 0.000821906952, 0.00513221322,
        0.00115737426, 0.0100568883, 0.00334477326, 0.0192921244, 0.00268559902, 0.0360238118, 0.00469267928, 0.0727716605,
        -0.00289536438, 0.140231882, -0.00548129996, 0.259653238, -0.0615915945, 0.479315385, -0.188682888, 0.869092893,
        -0.49877093, 1.51552451, -1.20957331, 2.52664981, -2.70113936, 3.96752406, -5.72293958, 5.86983017,
    5600, 16, 3.05e-06, 146,
        0.00108163095, 0.000390557113, 0.000915966886, 0.00124682623, 0.000719505445, 0.00225836706, 0.00146137454, 0.00299521149,
        0.00135727594, 0.00528274161, 0.00153963667, 0.0123112768, 0.00412742784, 0.025102761, 0.00185713922, 0.0515671917,
        0.0052857741, 0.102252836, -0.0131326495, 0.205175157, -0.0423931485, 0.393906186, -0.145848388, 0.737707419,
        -0.419778102, 1.32717872, -1.0579819, 2.28085398, -2.46924471, 3.686127, -5.43479744, 5.54810596,
    32, 20, 1.25e-12, 117,
        0.175988695, 0.0248101908, 0.15979093, 0.0950906275, 0.174083538, 0.142491372, 0.168085797, 0.247922589,
        0.133969023, 0.362666489, 0.0808351229, 0.489576034, 0.0114669125, 0.634254501, -0.0689606099, 0.804479557,
        -0.158675703, 1.0256016, -0.277253187, 1.32205812, -0.446373301, 1.71153722, -0.692393087, 2.21457838,
        -1.05069359, 2.85348622, -1.56956017, 3.65228987, -2.31479901, 4.63622504, -3.3741504, 5.82929786,
        -4.87848903, 7.25534197, -7.01563886, 8.92370443, -10.0830808, 10.8557306, -14.7669319, 13.1580288,
    56, 20, 5.7e-12, 464,
        0.130201681, 0.0215293176, 0.130428224, 0.0749500066, 0.118327775, 0.136513904, 0.0949383426, 0.203975245,
        0.0615542805, 0.279261591, 0.0199101588, 0.365512626, -0.0264601284, 0.46938332, -0.0767493619, 0.60574068,
        -0.139010745, 0.79537353, -0.230715637, 1.05576466, -0.372871024, 1.39868455, -0.581059388, 1.83768725,
        -0.876585684, 2.40549311, -1.3126599, 3.1430351, -1.96833777, 4.07489644, -2.93755718, 5.2164826,
        -4.34050208, 6.58434654, -6.3620336, 8.1982083, -9.30804149, 10.0781562, -13.862184, 12.3142498,
    100, 20, 2.37e-11, 1.38e+03,
        0.0873483077, 0.0179668933, 0.081520086, 0.0545126102, 0.0698808805, 0.0930024971, 0.0526139842, 0.135097122,
        0.0303233216, 0.182914729, 0.00550564915, 0.239647208, -0.0179572321, 0.313598572, -0.041792191, 0.419829965,
        -0.0763867206, 0.575344949, -0.136197416, 0.796628743, -0.241785108, 1.09872058, -0.417384167, 1.4915349,
        -0.678059965, 1.98942652, -1.05308326, 2.63889044, -1.6182886, 3.48328478, -2.47349729, 4.54648542,
        -3.74545526, 5.85237993, -5.62668376, 7.41862227, -8.42333658, 9.26391013, -12.8217747, 11.4786552,
    180, 20, 8.03e-11, 1.73e+03,
        0.0496897388, 0.0104110524, 0.0464290692, 0.0316258239, 0.0399850678, 0.0540483587, 0.0305115058, 0.0786634992,
        0.0186610283, 0.106644335, 0.00640839922, 0.140648737, -0.00318149897, 0.18681257, -0.00921761004, 0.259729793,
        -0.021239661, 0.372951049, -0.0476826523, 0.540045633, -0.104349663, 0.780230404, -0.213420637, 1.1101957,
        -0.39886115, 1.55088818, -0.696274748, 2.13229688, -1.16260838, 2.89317836, -1.88347413, 3.87683711,
        -3.00606178, 5.11882229, -4.72347745, 6.62686426, -7.34202221, 8.4210149, -11.5402136, 10.5784624,
    320, 20, 3.6e-10, 865,
        0.0256128635, 0.00596562405, 0.023566075, 0.0181852021, 0.0195545544, 0.0313391912, 0.0139527949, 0.0460936324,
        0.00697041683, 0.0631277469, 0.00292154568, 0.0859483167, -0.000831213802, 0.122610517, -0.00521549962, 0.178768995,
        -0.0130943011, 0.265758567, -0.0319137888, 0.397109134, -0.0738904378, 0.589514207, -0.15627997, 0.861101573,
        -0.300206605, 1.23477342, -0.536467701, 1.74480954, -0.923424116, 2.44008496, -1.55434815, 3.36536226,
        -2.57446322, 4.55612215, -4.1824557, 6.03230758, -6.69960117, 7.8137622, -10.8123776, 9.97176766,
    560, 20, 1.39e-09, 1.03e+03,
        0.0149650975, 0.00346371874, 0.01379907, 0.0105468809, 0.0114622482, 0.018157418, 0.00817370538, 0.0268724944,
        0.0045900912, 0.0367592904, 0.00310514117, 0.0515087015, 0.00249565196, 0.0749598818, 0.0028781712, 0.113215624,
        0.00128882258, 0.174365451, -0.00545798142, 0.269683384, -0.0248707074, 0.416197298, -0.07157116, 0.634880778,
        -0.167943255, 0.950689315, -0.346783377, 1.39632783, -0.660480523, 2.0151374, -1.20175275, 2.85109147,
        -2.09581091, 3.93854319, -3.54008068, 5.31552708, -5.86119538, 7.00027119, -9.7350972, 9.04935931,
    1000, 20, 4.32e-09, 582,
        0.00775205881, 0.00196724949, 0.00701953933, 0.00604496906, 0.00567930059, 0.010553859, 0.00395882011, 0.0155406511,
        0.00198773422, 0.0215535967, 0.00287726501, 0.0320248835, 0.00247727669, 0.049749431, 0.00198686093, 0.07721727,
        0.000499826141, 0.121559473, -0.00518422451, 0.192554747, -0.0207797075, 0.30345586, -0.0556499724, 0.472200593,
        -0.125119036, 0.723584524, -0.256067434, 1.09415211, -0.485518399, 1.63596643, -0.927976238, 2.41350542,
        -1.70172592, 3.45244123, -3.01380607, 4.81281804, -5.21036878, 6.50781374, -8.97993034, 8.58043335,
    1800, 20, 1.52e-08, 440,
        0.00415570169, 0.00107322832, 0.00372397619, 0.00329433537, 0.00288963394, 0.00577797922, 0.0018848577, 0.00869049398,
        0.00105104419, 0.0120857699, 0.00109800063, 0.0189363824, 0.000715557962, 0.0300261487, 0.000951401324, 0.0482870844,
        0.00103692883, 0.079596032, -0.000939244176, 0.131486432, -0.00761159229, 0.215665355, -0.0265328736, 0.349379006,
        -0.0737405483, 0.560988513, -0.178549902, 0.886923604, -0.388231501, 1.36712223, -0.765795528, 2.04771566,
        -1.44727405, 3.01154535, -2.65469642, 4.29889832, -4.73260543, 5.92766448, -8.36677178, 7.92425876,
    3200, 20, 4.46e-08, 529,
        0.00237663054, 0.000629940109, 0.00217227002, 0.00192311224, 0.00178134019, 0.00328597128, 0.00108996641, 0.0047876195,
        0.000709403109, 0.00720548991, 0.00152749412, 0.0114934491, 0.00151569191, 0.0196169204, 0.00152881324, 0.0326713865,
        0.00169360816, 0.0549908172, 0.00127444945, 0.0932552909, -0.0013672345, 0.157993438, -0.0114297794, 0.263433767,
        -0.0425207441, 0.437351648, -0.122132968, 0.712073574, -0.290063676, 1.12751522, -0.59456458, 1.74263211,
        -1.1830069, 2.6420721, -2.2676573, 3.87675854, -4.20401101, 5.47424167, -7.68274252, 7.46903136,
    5600, 20, 1.04e-07, 322,
        0.00127045497, 0.000356825795, 0.00111510097, 0.00110753074, 0.000842377115, 0.00198775828, 0.000630654304, 0.0029680863,
        0.000691443786, 0.00429418303, 0.00102477471, 0.00763518986, 0.00126008437, 0.0130184916, 0.00302189691, 0.0227878687,
        0.00427971253, 0.0406173561, 0.00406188468, 0.0712248561, 0.000724712197, 0.122638812, -0.00977508426, 0.209008398,
        -0.0367556516, 0.352616983, -0.0970479319, 0.587074736, -0.213466711, 0.953480342, -0.480477883, 1.53926128,
        -1.01935623, 2.3947812, -2.03862784, 3.58683649, -3.89788262, 5.15995853, -7.31741286, 7.14935448,
    10000, 20, 2.61e-07, 437,
        0.000739252428, 0.000204656841, 0.000686612271, 0.000605105689, 0.000516811924, 0.00101122136, 0.00028103206, 0.00155663257,
        0.00032472849, 0.0026158375, 0.000758171428, 0.00449322811, 0.000717894173, 0.00829603779, 0.000819155307, 0.0148744472,
        0.00301885198, 0.0271859256, 0.00289613082, 0.0505566596, 0.000524180952, 0.0900522007, -0.00671448427, 0.157827355,
        -0.0254249601, 0.272626195, -0.0710599072, 0.462131534, -0.162645944, 0.797032277, -0.393779593, 1.31506611,
        -0.861541679, 2.11388314, -1.79977171, 3.26273323, -3.57203923, 4.80324544, -6.91046345, 6.7458015,
    18000, 20, 5.22e-07, 240,
        0.000368958555, 0.000117607259, 0.000331278628, 0.000366098565, 0.000279988615, 0.000629673521, 0.000201838289, 0.000877739489,
        0.000194376687, 0.00147623553, 0.00046571398, 0.00273640476, 0.000402662544, 0.0050600742, 0.0015132128, 0.00940486831,
        0.0021430546, 0.018084252, 0.00263866733, 0.0332952769, 0.00266079487, 0.060939415, 0.000846080281, 0.110739089,
        -0.00615240657, 0.198797071, -0.0222773689, 0.358471255, -0.110551865, 0.639139908, -0.28144407, 1.10484405,
        -0.675353971, 1.84553206, -1.51577982, 2.95510892, -3.17801314, 4.47166917, -6.37313307, 6.40189773,
    32000, 20, 1.07e-06, 500,
        0.000245708578, 4.94384018e-05, 0.000202529425, 0.000173893876, 0.000143598554, 0.000322749653, 9.30249599e-05, 0.000496022042,
        0.000156856569, 0.000978748577, 0.000503642187, 0.00187142784, 0.000663955465, 0.0037235778, 0.00185588118, 0.00640466165,
        0.00245768238, 0.0134187752, 0.00289173888, 0.0253328203, 0.00297068676, 0.0476529019, 0.00142631771, 0.0895059998,
        0.000961106041, 0.170217908, -0.0278552192, 0.321409582, -0.085176649, 0.564932158, -0.241572163, 0.997317378,
        -0.602470103, 1.68094675, -1.36940965, 2.72417342, -2.93321399, 4.19355364, -6.0169499, 6.11276065,
    560, 24, 4.67e-11, 2.5e+03,
        0.0166801795, 0.00339264444, 0.0156289514, 0.0103018826, 0.0135447233, 0.0176015245, 0.0104920292, 0.0256104668,
        0.00663696104, 0.0347420395, 0.00262130647, 0.0454154533, -0.000249800662, 0.0598429209, -0.00293375472, 0.081765993,
        -0.00636509599, 0.111701213, -0.00456487826, 0.155867258, -0.00685369848, 0.229962143, -0.0264761209, 0.3380569,
        -0.0651978792, 0.461766482, -0.0909202974, 0.646522338, -0.164932342, 0.927314461, -0.314327971, 1.29055138,
        -0.538277953, 1.74312382, -0.855182804, 2.34715133, -1.35569212, 3.15412408, -2.1446696, 4.17946924,
        -3.34540387, 5.43817811, -5.14281921, 6.94968468, -7.84447152, 8.73171589, -12.1283019, 10.8590981,
    1000, 24, 1.32e-10, 2.51e+03,
        0.00932375564, 0.00195441821, 0.008723049, 0.00594360064, 0.00754514991, 0.0101809957, 0.00583961921, 0.0148622266,
        0.0037910874, 0.0201891069, 0.00186636415, 0.0267545989, 0.0013971116, 0.0353507565, 0.00185364438, 0.0511095078,
        0.00207218071, 0.0738035563, 0.00412736569, 0.109752655, -0.000757175083, 0.165956037, -0.0151297558, 0.246512091,
        -0.037826455, 0.342305728, -0.0506884396, 0.498924076, -0.106078017, 0.736408584, -0.217981459, 1.05332242,
        -0.399020747, 1.47136804, -0.680872948, 2.03309589, -1.12813389, 2.78294266, -1.83287574, 3.75360509,
        -2.92818075, 4.9870663, -4.61746143, 6.50108027, -7.21217739, 8.30842074, -11.3868737, 10.4836262,
    1800, 24, 4.57e-10, 1.93e+03,
        0.00502400517, 0.00109240641, 0.00467747268, 0.00332249128, 0.00399378267, 0.0056952509, 0.00296398413, 0.00831736595,
        0.00171477081, 0.0115551525, 0.00119521759, 0.0152441636, 0.00140731656, 0.0220371146, 0.00102812725, 0.0321037599,
        0.000850816723, 0.0479264177, 0.00191421509, 0.0693315661, 0.00502489614, 0.108371897, -0.00186532945, 0.166954398,
        -0.0191424711, 0.248803268, -0.0332731152, 0.35462581, -0.0552029311, 0.539773021, -0.127659726, 0.808701817,
        -0.263470179, 1.17480665, -0.488100132, 1.67045994, -0.856150915, 2.34029843, -1.44755326, 3.24908402,
        -2.42857681, 4.42916924, -3.9885585, 5.89560213, -6.45129441, 7.6695706, -10.5047497, 9.80409131,
    3200, 24, 1.54e-09, 1.66e+03,
        0.00276922555, 0.000625758341, 0.0025785298, 0.00190034735, 0.00218739695, 0.00326118615, 0.00165940769, 0.00482062589,
        0.00105564415, 0.00647610236, 0.000870272555, 0.00896053795, 0.000764640679, 0.0129845497, 0.00137062991, 0.0194079896,
        0.00212409185, 0.0307652347, 0.00317596274, 0.0499966739, 0.00262297666, 0.0793401243, -0.00360419778, 0.118920699,
        -0.014556406, 0.176047824, -0.0147583281, 0.266131325, -0.0351491546, 0.422736561, -0.0932127448, 0.64557341,
        -0.200252232, 0.954964623, -0.385830158, 1.38995347, -0.680243304, 2.00527778, -1.21317614, 2.86707458,
        -2.11396752, 3.98229166, -3.56769762, 5.39369611, -5.91340211, 7.12772155, -9.83624091, 9.22488199,
    5600, 24, 4.26e-09, 1.27e+03,
        0.00153591531, 0.00035301368, 0.001418328, 0.00107486615, 0.00118159998, 0.00184949069, 0.000840705828, 0.00274281148,
        0.000518564319, 0.0037676282, 0.00042396916, 0.0053560969, 0.000662178614, 0.00806792948, 0.000886343655, 0.0126452437,
        0.00119710631, 0.0196794814, 0.00240678304, 0.031107819, 0.00455227532, 0.0510595386, 0.00482246657, 0.0849872393,
        -0.00196458257, 0.136878464, -0.0190416153, 0.203375672, -0.0255647962, 0.306186588, -0.0490505614, 0.484271173,
        -0.115487439, 0.754351313, -0.253983824, 1.14882831, -0.516208745, 1.71040792, -0.985558176, 2.47933202,
        -1.78320844, 3.51027652, -3.11941776, 4.84569462, -5.32834835, 6.50359923, -9.09951753, 8.53263518,
    10000, 24, 1.05e-08, 1.2e+03,
        0.000853803544, 0.0001993623, 0.000781867582, 0.000612187738, 0.000649515866, 0.00106855509, 0.000487516014, 0.00157761697,
        0.000320760931, 0.00213372201, 0.000458602585, 0.00324343335, 0.000573961701, 0.00507335945, 0.00095207243, 0.00814498054,
        0.00149920325, 0.0133639545, 0.00236078336, 0.0221413753, 0.00344952194, 0.0373140256, 0.00309340459, 0.0628638344,
        -0.00224447341, 0.102856275, -0.0147984221, 0.155664254, -0.0203604154, 0.239418621, -0.0384788597, 0.384760052,
        -0.0899832217, 0.611835492, -0.20230188, 0.955191335, -0.42488298, 1.45548043, -0.828401451, 2.15819342,
        -1.54389485, 3.13128787, -2.78425403, 4.41350682, -4.88674261, 6.02451311, -8.53852044, 7.99644383,
    18000, 24, 3.3e-08, 1.08e+03,
        0.000464698761, 0.000113650293, 0.000432659128, 0.000341296429, 0.000355513348, 0.000586062762, 0.000269768787, 0.000901077172,
        0.000214625625, 0.00111281224, 0.000128623549, 0.0018645761, 0.000406683665, 0.00313349021, 0.000430568513, 0.00539412451,
        0.000571335645, 0.00904711796, 0.00105932138, 0.0148229872, 0.00145879181, 0.0242585224, 0.00358694573, 0.040790507,
        0.0054593365, 0.0708024554, 0.00289481601, 0.121461073, -0.00837055978, 0.200990058, -0.0334507035, 0.325249387,
        -0.0821813588, 0.517880004, -0.175562797, 0.812154942, -0.348144212, 1.27349264, -0.711486126, 1.95251884,
        -1.3667912, 2.899187, -2.54076113, 4.18236201, -4.58369232, 5.81558167, -8.18131602, 7.82463444,
    32000, 24, 6.53e-08, 1.27e+03,
        0.000263463414, 6.56033217e-05, 0.000245675796, 0.000204365886, 0.000234454503, 0.000339243999, 0.00015273925, 0.000460394507,
        0.000107070516, 0.000680333641, 0.000216944098, 0.00112287985, 0.000217609339, 0.00192158776, 0.000318721679, 0.00331448992,
        0.00101069322, 0.00578792514, 0.00152232277, 0.0100982391, 0.00248686203, 0.0173603829, 0.00426747425, 0.0304450238,
        0.00624206762, 0.0537986859, 0.0061143663, 0.0931422291, 0.00206393805, 0.157863889, -0.00999922125, 0.262417037,
        -0.0416988283, 0.425656817, -0.107714809, 0.703714635, -0.275604826, 1.13620963, -0.583455738, 1.75814504,
        -1.17006751, 2.67035501, -2.25264086, 3.92751084, -4.19622845, 5.56036097, -7.69497723, 7.59383411,
};
/* shared_poles.py: end */

enum {
    HDI_SHARED_FEWEST = 4,       /* pairs: poles are factorised in packs of four */
    HDI_SHARED_LAWSON = 3,       /* steps: they gain a third of the error, more gain nothing to speak of */
    HDI_SHARED_MOST = 64         /* largest degree of a polynomial in the bound */
};

/* The fewest poles that hold the weighted error below target for all times within a factor lambda: 1, or 0 when none do (then split the times; out is as it was).
 * For one time, lambda <= 1, that is a kernel set. Else weights are 0 until hdi_shared_fit fills them in, and the errors are what it is known to reach: recorded
 * are the errors on dense times with what rounding can add, and a quarter more is proven for any time. */
static int hdi_shared_pick(hd_rational *out, double lambda, double target) {
    const int32_t size = HDI_CAST(int32_t, sizeof hdi_shared_table / sizeof *hdi_shared_table);
    hd_rational set;
    hd_error e;
    int32_t k, i, n;
    for (k = 2 * HDI_SHARED_FEWEST; lambda <= 1 && k <= HDI_RAT_KERNEL_MAX; k += 2) {
        if (hdi_rational_get(&set, HD_POLES_KERNEL, k, &e) < 0 || !(set.max_weighted_error <= target)) continue;
        *out = set;
        return 1;
    }
    for (k = 0; k < size; k += 4 + 2 * n) {
        const double *row = hdi_shared_table + k, error = 1.25 * row[2];
        n = HDI_CAST(int32_t, row[1]);
        if (!(lambda <= row[0] && error <= target)) continue;
        memset(out, 0, sizeof *out);
        out->kind = HD_POLES_KERNEL;
        out->degree = 2 * n;
        out->n_poles = n;
        out->max_error = out->max_weighted_error = error;
        for (i = 0; i < n; i++) out->theta[i] = hdi_c(row[4 + 2 * i], row[5 + 2 * i]);
        return 1;
    }
    return 0;
}

/* x with the smallest |A x - b|, by Householder reflections: A rows x cols of full rank, column-major, rows >= cols. x comes in b; A is overwritten. Without full
 * rank x is finite, and no more. */
static void hdi_least_squares(double *A, int64_t rows, int64_t cols, double *b) {
    int64_t j, k;
    for (k = 0; k < cols; k++) {
        double *v = A + k * rows + k;
        const int64_t m = rows - k;
        const double norm = sqrt(hdi_dot(v, v, m)), head = v[0] > 0 ? -norm : norm;
        if (norm == 0) continue;
        v[0] -= head;                            /* I - v v'/(-head v0) takes the column to (head, 0, ..) */
        for (j = k + 1; j < cols; j++) hdi_axpy(hdi_dot(v, v + (j - k) * rows, m) / (head * v[0]), v, v + (j - k) * rows, m);
        hdi_axpy(hdi_dot(v, b + k, m) / (head * v[0]), v, b + k, m);
        v[0] = head;
    }
    for (k = cols - 1; k >= 0; k--) {
        b[k] = A[k * rows + k] != 0 ? b[k] / A[k * rows + k] : 0;
        hdi_axpy(-b[k], A + k * rows, b, k);
    }
}

/* (1 + tau y)(exp(-tau y) - c(-y)) at y = p/q, q = 0 being infinity. size receives the sum of the moduli of what is summed. */
static double hdi_shared_error(const hd_rational *set, double tau, double p, double q, double *size) {
    const double s = p < 745 / tau * q ? tau * p / q : 745, first = (1 + s) * exp(-s), top = q + tau * p;
    double sum = first;
    int32_t i;
    *size = (1 + s) * first;                     /* s is off by half an ulp */
    for (i = 0; i < set->n_poles; i++) {
        const hd_c64 a = set->a[i], d = hdi_c(p + q * set->theta[i].re, q * set->theta[i].im);
        const double inv = 1 / hdi_cabs2(d);
        sum += 2 * top * (a.re * d.re + a.im * d.im) * inv;
        *size += 2 * top * sqrt(hdi_cabs2(a) * inv);
    }
    return sum;
}

/* The fit: points y_k, k < points, and infinity as the last row. The unknowns are Re a, Im a, scaled and then reflected by I - v v' so that c(0) = 1 fixes the
 * first of them. */
typedef struct hdi_shared_work {
    int32_t n, points;
    int64_t rows;                /* points + 1 */
    double *A, *b;               /* [rows 2n], [rows] weighted with 1 + tau y */
    double *M, *x;               /* [(rows + 2n - 1) (2n - 1)], [rows + 2n - 1] of one step */
    double *w, *e;               /* [rows] Lawson's weights; errors */
    double *scale, *v, *best;    /* [2n] */
    double first;                /* the unknown that is known */
} hdi_shared_work;

static int32_t hdi_shared_points(int32_t n_poles) { return 8 * n_poles + 96; }

/* Doubles that hdi_shared_fit works in. */
static uint64_t hdi_shared_room(int32_t n_poles) {
    const uint64_t n = HDI_CAST(uint64_t, 2 * n_poles), rows = HDI_CAST(uint64_t, hdi_shared_points(n_poles)) + 1;
    return rows * n + rows + (rows + n) * n + 2 * rows + 3 * n;
}

static hdi_shared_work hdi_shared_begin(int32_t n_poles, double *room) {
    hdi_shared_work k;
    const int32_t n = 2 * n_poles;
    k.n = n_poles;
    k.points = hdi_shared_points(n_poles);
    k.rows = k.points + 1;
    k.A = room;
    k.b = k.A + k.rows * n;
    k.M = k.b + k.rows;
    k.x = k.M + (k.rows + n - 1) * (n - 1);
    k.w = k.x + (k.rows + n - 1);
    k.e = k.w + k.rows;
    k.scale = k.e + k.rows;
    k.v = k.scale + n;
    k.best = k.v + n;
    k.first = 0;
    return k;
}

/* A, b: the weighted problem, columns scaled to a norm near 1. */
static void hdi_shared_matrix(hdi_shared_work *k, const hd_rational *set, double tau) {
    double least = HUGE_VAL, most = 0;
    int64_t r;
    int32_t i;
    for (i = 0; i < k->n; i++) {
        least = hdi_min(least, hdi_cabs(set->theta[i]));
        most = hdi_max(most, hdi_cabs(set->theta[i]));
    }
    for (r = 0; r < k->rows; r++) {
        const int last = r == k->points;
        const double part = HDI_CAST(double, r) / (k->points - 1), q = last ? 0 : 1, p = last ? 1 : 0.02 * least * exp(part * log(750 * most / least));
        k->b[r] = last ? 0 : (1 + tau * p) * exp(-tau * p);
        for (i = 0; i < k->n; i++) {             /* -2 Re a/(p + theta q): x = -y */
            const hd_c64 f = hdi_cdiv(hdi_c(-2 * (q + tau * p), 0), hdi_c(p + q * set->theta[i].re, q * set->theta[i].im));
            k->A[i * k->rows + r] = f.re;
            k->A[(k->n + i) * k->rows + r] = -f.im;
        }
    }
    for (i = 0; i < k->n; i++) {                 /* both parts alike */
        double *re = k->A + i * k->rows, *im = re + k->n * k->rows;
        const double s = 1 / sqrt(hdi_dot(re, re, k->rows) + hdi_dot(im, im, k->rows));
        for (r = 0; r < k->rows; r++) {
            re[r] *= s;
            im[r] *= s;
        }
        k->scale[i] = k->scale[k->n + i] = s;
    }
}

/* A becomes A (I - v v'), after which c(0) = 1 says x_0 = first. */
static void hdi_shared_condition(hdi_shared_work *k, const hd_rational *set) {
    const int32_t n = 2 * k->n;
    double norm, head;
    int32_t i;
    for (i = 0; i < k->n; i++) {
        const hd_c64 f = hdi_cdiv(hdi_c(-2, 0), set->theta[i]);
        k->v[i] = k->scale[i] * f.re;
        k->v[k->n + i] = k->scale[i] * -f.im;
    }
    norm = sqrt(hdi_dot(k->v, k->v, n));
    head = k->v[0] > 0 ? -norm : norm;
    k->first = 1 / head;
    k->v[0] -= head;
    norm = sqrt(-head * k->v[0]);                /* |v|/sqrt(2) */
    for (i = 0; i < n; i++) k->v[i] /= norm;
    memset(k->e, 0, HDI_CAST(size_t, k->rows) * sizeof(double));
    for (i = 0; i < n; i++) hdi_axpy(k->v[i], k->A + i * k->rows, k->e, k->rows);
    for (i = 0; i < n; i++) hdi_axpy(-k->v[i], k->e, k->A + i * k->rows, k->rows);
}

/* One weighted least squares problem: x [2n], and the errors e at the points; returns the largest. A touch of damping, of the size of rounding, keeps weights
 * small where the error does not care. */
static double hdi_shared_step(hdi_shared_work *k) {
    const int32_t n = 2 * k->n;
    const int64_t ld = k->rows + n - 1;
    double worst = 0;
    int64_t r;
    int32_t i;
    memset(k->M, 0, HDI_CAST(size_t, ld) * HDI_CAST(size_t, n - 1) * sizeof(double));
    memset(k->x, 0, HDI_CAST(size_t, ld) * sizeof(double));
    for (i = 1; i < n; i++) {
        double *m = k->M + (i - 1) * ld;
        for (r = 0; r < k->rows; r++) m[r] = k->w[r] * k->A[i * k->rows + r];
        m[k->rows + i - 1] = 2 * DBL_EPSILON;
    }
    for (r = 0; r < k->rows; r++) {
        k->e[r] = k->b[r] - k->first * k->A[r];
        k->x[r] = k->w[r] * k->e[r];
    }
    hdi_least_squares(k->M, ld, n - 1, k->x);
    for (i = 1; i < n; i++) hdi_axpy(-k->x[i - 1], k->A + i * k->rows, k->e, k->rows);
    for (r = 0; r < k->rows; r++) worst = hdi_max(worst, fabs(k->e[r]));
    return worst;
}

/* The weights a of the last step: undo reflection and scaling. */
static void hdi_shared_take(const hdi_shared_work *k, double *a) {
    const int32_t n = 2 * k->n;
    double dot;
    int32_t i;
    a[0] = k->first;
    for (i = 1; i < n; i++) a[i] = k->x[i - 1];
    dot = hdi_dot(k->v, a, n);
    for (i = 0; i < n; i++) a[i] = k->scale[i] * (a[i] - dot * k->v[i]);
}

/* How far exp's part of the weighted error is from a polynomial of degree m on y in [c - w, c + w]: Bernstein's bound 2 M rho^-m/(rho - 1) on an ellipse, or
 * what is left of it altogether. */
static double hdi_shared_exp_rest(double tau, double c, double w, int32_t m) {
    const double rho = hdi_min(hdi_max(2 * m / (tau * w), 1.3), 1e6), half = w * (rho + 1 / rho) / 2;
    const double M = (1 + tau * (c + half)) * exp(-tau * (c - half));
    return hdi_min(2 * M * pow(rho, -m) / (rho - 1), (1 + tau * (c - w)) * exp(-tau * (c - w)));
}

/* A bound of the weighted error on y in [lo, hi], or on [lo, inf) when hi is 0, that holds between points too.
 * In u, y = c + w u (or 1/y = c + w u), a fraction (1 + tau y)/(y + theta) is a constant and g/(u - z), and the Chebyshev coefficients of 1/(u - z) are known:
 * |b_j| = 2 rho^-j/|sqrt(z^2 - 1)|, rho + 1/rho = |z - 1| + |z + 1|. So the error is a polynomial of degree m and a rest that is bounded; m is taken so that the
 * rest is small against goal. A polynomial of degree m is at most 1/cos(m pi/2n) times its largest value at n Chebyshev points (Ehlich, Zeller). Rounding of
 * the evaluation is allowed for. */
static double hdi_shared_panel(const hd_rational *set, double tau, double lo, double hi, double goal) {
    const double pi = 3.141592653589793238, c = hi > 0 ? (lo + hi) / 2 : 0.5 / lo, w = hi > 0 ? (hi - lo) / 2 : 0.5 / lo;
    double inv[HD_MAX_POLES], part[HD_MAX_POLES], rest = HUGE_VAL, most = 0, size, largest = 0;
    int32_t i, j, m;
    for (i = 0; i < set->n_poles; i++) {
        const hd_c64 theta = set->theta[i], pole = hi > 0 ? hdi_c(-theta.re, -theta.im) : hdi_cdiv(hdi_c(-1, 0), theta);
        const hd_c64 z = hdi_c((pole.re - c) / w, pole.im / w);
        const double left = hypot(z.re + 1, z.im), right = hypot(z.re - 1, z.im), s = (left + right) / 2, rho = s + sqrt(hdi_max(s * s - 1, 0));
        const double g = 2 * hdi_cabs(set->a[i]) * hypot(1 - tau * theta.re, tau * theta.im) / (w * (hi > 0 ? 1 : hdi_cabs2(theta)));
        inv[i] = 1 / rho;
        part[i] = 2 * g / (sqrt(left * right) * (rho - 1));
    }
    for (m = 8; m <= HDI_SHARED_MOST; m += 4) {
        rest = hi > 0 ? hdi_shared_exp_rest(tau, c, w, m) : (1 + tau * lo) * exp(-tau * lo);
        for (i = 0; i < set->n_poles; i++) rest += part[i] * pow(inv[i], m);
        if (rest <= 0.02 * goal || m == HDI_SHARED_MOST) break;
    }
    for (j = 0; j < 4 * m; j++) {
        const double u = c + w * cos(pi * (j + 0.5) / (4 * m)), e = hi > 0 ? hdi_shared_error(set, tau, u, 1, &size) : hdi_shared_error(set, tau, 1, u, &size);
        most = hdi_max(most, fabs(e));
        largest = hdi_max(largest, size);
    }
    return (most + rest + 4 * DBL_EPSILON * largest) / cos(pi / 8) + rest;
}

/* max_weighted_error and max_error: bounds that hold for all y >= 0. Panels double in length, away from the poles; the last is [lo, inf). */
static void hdi_shared_bound(hd_rational *set, double tau, double goal) {
    double least = HUGE_VAL, most = 0, lo = 0, hi;
    int32_t i;
    for (i = 0; i < set->n_poles; i++) {
        least = hdi_min(least, hdi_cabs(set->theta[i]));
        most = hdi_max(most, hdi_cabs(set->theta[i]));
    }
    set->max_error = set->max_weighted_error = 0;
    for (hi = least / 8; hi > 0; lo = hi, hi = lo < 2 * most || tau * lo < 45 ? 2 * lo : 0) {
        const double e = hdi_shared_panel(set, tau, lo, hi, goal);
        set->max_weighted_error = hdi_max(set->max_weighted_error, e);
        set->max_error = hdi_max(set->max_error, e / (1 + tau * lo));
    }
    hi = hdi_shared_panel(set, tau, lo, 0, goal);
    set->max_weighted_error = hdi_max(set->max_weighted_error, hi);
    set->max_error = hdi_max(set->max_error, hi / (1 + tau * lo));
}

/* The weights of a shared set for the time tau t0, tau > 0, and their errors: near the smallest largest (1 + tau y)|e|, by least squares and Lawson's steps. Both
 * errors are bounds for all y >= 0, for any tau; small ones for tau in [1, lambda] of the pick. room: hdi_shared_room doubles. THE SET IS TRUSTED: pairs only,
 * Im theta > 0. */
static void hdi_shared_fit(hd_rational *set, double tau, double *room) {
    hdi_shared_work k = hdi_shared_begin(set->n_poles, room);
    double lowest = HUGE_VAL;
    int32_t step, i;
    int64_t r;
    hdi_shared_matrix(&k, set, tau);
    hdi_shared_condition(&k, set);
    for (r = 0; r < k.rows; r++) k.w[r] = 1;
    for (step = 0; step <= HDI_SHARED_LAWSON; step++) {
        const double worst = hdi_shared_step(&k);
        double top = 0;
        if (worst < lowest) {
            lowest = worst;
            hdi_shared_take(&k, k.best);
        }
        for (r = 0; r < k.rows; r++) {
            k.w[r] *= sqrt(fabs(k.e[r]) / worst + 1e-3);
            top = hdi_max(top, k.w[r]);
        }
        for (r = 0; r < k.rows; r++) k.w[r] /= top;
    }
    set->a0 = 0;
    for (i = 0; i < k.n; i++) set->a[i] = hdi_c(k.best[i], k.best[k.n + i]);
    hdi_shared_bound(set, tau, lowest);
}

/* Sets for n_times times, each in terms of its own time: theta_i/t is the same for all. */
static hd_status hdi_rational_shared(hd_rational *out, int32_t n_times, const double *t, double tol, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    double least = HUGE_VAL, most = 0, *room;
    hd_rational set;
    int32_t q, i;
    if (n_times < 1 || !(tol > 0)) return hdi_fail_row(e, HD_ERR_ARGUMENT, "shared poles: no times, or tol is not positive", -1, -1, n_times < 1 ? n_times : tol);
    for (q = 0; q < n_times; q++) {
        if (!hdi_finite(t[q]) || !(t[q] > 0)) return hdi_fail_row(e, HD_ERR_ARGUMENT, "shared poles: a time is not positive or not finite", q, -1, t[q]);
        least = hdi_min(least, t[q]);
        most = hdi_max(most, t[q]);
    }
    if (!hdi_shared_pick(&set, most / least, tol))
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "shared poles: no set is that exact over so wide a range of times", -1, -1, most / least);
    room = HDI_TAKE(&s, double, hdi_shared_room(set.n_poles));
    for (q = 0; room && q < n_times; q++) {
        const double tau = t[q] / least;
        if (least < most) hdi_shared_fit(&set, tau, room);    /* a single time has its weights */
        out[q] = set;
        for (i = 0; i < set.n_poles; i++) {
            out[q].theta[i] = hdi_cscale(tau, set.theta[i]);
            out[q].a[i] = hdi_cscale(tau, set.a[i]);
        }
    }
    return hdi_scope_end(&s);
}

/* ==== [22] poles ====
 * The family t L + theta_i B over the poles of a set, for one right-hand side: solutions, their weighted sum, and what it can be off by.
 * May call [15] and [16].
 * One right-hand side goes through its poles one after the other, since what is solved already is a good start for the next: with
 * A_p = A_q + (theta_p - theta_q) B,  A_p sum c_q x_q = (sum c_q) b + B sum c_q (theta_p - theta_q) x_q,  and for sum c_q = 1 the residual is a
 * combination that least squares make small. The conjugate of a solution is that of the conjugate pole, and counts as another one.
 * Parallel tasks are right-hand sides, and preconditioners. */

/* ---- what answers can be off by ---- */
/* An error r in the system of a pole, b - A x = r, is an error A^-1 r in its solution. Two norms bound it:
 *   |A^-1 r|_B <= |r|_(B^-1) / min |t lambda + theta|
 *   |A^-1 r|_M <= |r|_(B^-1) max (1 + t lambda)/|t lambda + theta|,   M = B + t L,
 * and |r|_(B^-1)^2 <= |r|_(D^-1)^2 / b_ratio, D = diag(B). At vertex v, |e_v| <= |e|_B / sqrt(b_ratio D_v), and
 * |e_v| <= sqrt(g_v) |e|_M for g = diag(M^-1): far less where heat has spread over many vertices. */

/* Bounds by parts, of an error in one of the norms, or of values. */
typedef struct hdi_parts { double rational, solver, rounding; } hdi_parts;

static double hdi_parts_sum(const hdi_parts *p) { return p->rational + p->solver + p->rounding; }

/* A product of bounds: where one is nothing so is the other's part, and infinity is no operand. */
static double hdi_bound_times(double a, double b) {
    if (a == 0 || b == 0) return 0;
    return hdi_finite(a) && hdi_finite(b) ? a * b : HUGE_VAL;
}

static hdi_parts hdi_parts_scale(double s, hdi_parts p) {
    p.rational = hdi_bound_times(s, p.rational);
    p.solver = hdi_bound_times(s, p.solver);
    p.rounding = hdi_bound_times(s, p.rounding);
    return p;
}

static hdi_parts hdi_parts_least(hdi_parts a, hdi_parts b) {
    a.rational = hdi_min(a.rational, b.rational);
    a.solver = hdi_min(a.solver, b.solver);
    a.rounding = hdi_min(a.rounding, b.rounding);
    return a;
}

/* The account that every query keeps of its errors, and that becomes the report's. Absolute, over the values noted. */
typedef struct hdi_ledger {
    hdi_parts off;               /* the largest of each part */
    hdi_parts known;             /* evidence of each part, as hd_evidence; hdi_ledger_begin sets it */
    double largest, smallest;    /* |value|; smallest: not zero, HUGE_VAL when there is none */
    double relative;             /* largest error over its value; negative: not asked */
    int64_t n_values;
} hdi_ledger;

static hdi_ledger hdi_ledger_begin(hd_evidence rational, hd_evidence solver, hd_evidence rounding, int relative) {
    hdi_ledger l;
    memset(&l, 0, sizeof l);
    l.known.rational = rational;
    l.known.solver = solver;
    l.known.rounding = rounding;
    l.smallest = HUGE_VAL;
    l.relative = relative ? 0 : -1;
    return l;
}

static double hdi_quotient(double a, double b) { return a == 0 ? 0 : b > 0 ? a / b : HUGE_VAL; }

/* A value and what it can be off by. */
static void hdi_ledger_note(hdi_ledger *l, double value, hdi_parts off) {
    const double size = fabs(value);
    l->off.rational = hdi_max(l->off.rational, off.rational);
    l->off.solver = hdi_max(l->off.solver, off.solver);
    l->off.rounding = hdi_max(l->off.rounding, off.rounding);
    l->largest = hdi_max(l->largest, size);
    if (size > 0) l->smallest = hdi_min(l->smallest, size);
    if (l->relative >= 0) {                      /* relative to the exact value, which is at least size - all */
        const double all = hdi_parts_sum(&off);
        l->relative = hdi_max(l->relative, all == 0 ? 0 : hdi_quotient(all, size - all));
    }
    l->n_values++;
}

static void hdi_evidence_worst(hd_evidence *to, double evidence) {
    if (evidence > HDI_CAST(double, *to)) *to = HDI_CAST(hd_evidence, HDI_CAST(int, evidence));
}

/* Above this a bound says nothing worth having. */
#define HDI_BOUND_USEFUL 1e-2

static void hdi_bound_judge(double bound, hd_report *rep) {
    if (!(bound <= HDI_BOUND_USEFUL) && rep->status == HD_OK) rep->status = HD_WARN_ACCURACY;
}

/* The one way from errors to a report, which keeps the worst of all ledgers that it is given. */
static void hdi_ledger_close(const hdi_ledger *l, hd_report *rep) {
    hdi_parts part = l->off;
    double total;
    if (l->n_values == 0) return;
    part.rational = hdi_quotient(part.rational, l->largest);
    part.solver = hdi_quotient(part.solver, l->largest);
    part.rounding = hdi_quotient(part.rounding, l->largest);
    total = hdi_parts_sum(&part);
    rep->error_rational = hdi_max(rep->error_rational, part.rational);
    rep->error_solver = hdi_max(rep->error_solver, part.solver);
    rep->error_rounding = hdi_max(rep->error_rounding, part.rounding);
    rep->error_bound = hdi_max(rep->error_bound, total);
    hdi_evidence_worst(&rep->evidence_rational, l->known.rational);
    hdi_evidence_worst(&rep->evidence_solver, l->known.solver);
    hdi_evidence_worst(&rep->evidence_rounding, l->known.rounding);
    if (hdi_finite(l->smallest)) rep->smallest = rep->smallest > 0 ? hdi_min(rep->smallest, l->smallest) : l->smallest;
    if (l->relative >= 0 && rep->error_relative < l->relative) rep->error_relative = l->relative;
    hdi_bound_judge(total, rep);
}

/* What rounding adds to a residual b - (t L + theta B) x in row i is at most c_i sum_j M_ij |x_j| with M = t |L| + |theta| |B|
 * and c_i half a unit in the last place for every term of the row and HDI_NOISE_TERMS more (N. Higham, Accuracy and Stability
 * of Numerical Algorithms, 2002, section 3.1). In the norm of D^-1 that is at most sqrt(sum_j noise_j |x_j|^2),
 * noise_j = sum_i M_ij (c_i^2/D_i) sum_k M_ik, by Cauchy and Schwarz. work [n]. */
#define HDI_NOISE_TERMS 8

static void hdi_noise_weights(const hd_laplacian *lap, double t, double theta, double *noise, double *work) {
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        const double terms = HDI_CAST(double, lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) + HDI_NOISE_TERMS, c = terms * DBL_EPSILON / 2;
        double sum = lap->B ? 0 : theta * lap->mass[i];
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) sum += t * fabs(lap->L.val[p]) + (lap->B ? theta * fabs(lap->B[p]) : 0);
        work[i] = hdi_min(c * c * (sum / lap->b_diag[i]), 1e150);   /* beyond, no digit is left anyway */
    }
    for (i = 0; i < lap->n_active; i++) {
        double sum = lap->B ? 0 : theta * lap->mass[i] * work[i];
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) sum += (t * fabs(lap->L.val[p]) + (lap->B ? theta * fabs(lap->B[p]) : 0)) * work[lap->L.col[p]];
        noise[i] = hdi_min(sum, 1e300);
    }
}

/* Largest |theta| of a set. */
static double hdi_rat_reach(const hd_rational *set) {
    double most = 0;
    int32_t p;
    for (p = 0; p < set->n_poles; p++) most = hdi_max(most, hdi_cabs(set->theta[p]));
    return most;
}

/* max (1 + x)/|x + theta| over x >= 0 */
static double hdi_pole_reach(hd_c64 theta) {
    const double x = theta.re < 1 ? theta.im * theta.im / (1 - theta.re) - theta.re : -1;
    const double inside = x > 0 ? (1 + x) / hypot(x + theta.re, theta.im) : 0;
    return hdi_max(inside, hdi_max(1, 1 / hdi_cabs(theta)));
}

/* Re 1/(x + theta) >= 1/(this (1 + x)) for x >= 0; HUGE_VAL where the left side may be negative. */
static double hdi_resolvent_factor(hd_c64 theta) {
    return theta.re > 0 ? hdi_max(1, theta.re) + theta.im * theta.im / theta.re : HUGE_VAL;
}

/* 1/sqrt(b_ratio): from the norm of D^-1 to that of B^-1. */
static double hdi_ratio_root(const hd_laplacian *lap) { return lap->b_ratio > 0 ? 1 / sqrt(lap->b_ratio) : HUGE_VAL; }

/* What is shared by all right-hand sides: the pair, and preconditioners for a set and a time. */
typedef struct hdi_family {
    hd_context *ctx;
    const hd_laplacian *lap;
    const hdi_upper *up;
    const double *weight;        /* [n] 1/diag(B) */
    double *noise, *noise_work;  /* [n] weights of rounding for set and t */
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
    const uint64_t n = HDI_CAST(uint64_t, fam->lap->n_active), upper = HDI_CAST(uint64_t, fam->up->ptr[n]);
    const uint64_t size = fam->precond == HD_PRECOND_NONE ? 0 : fam->precond == HD_PRECOND_JACOBI ? n : n + upper;
    int32_t i;
    if (fam->filled && fam->t == t && memcmp(&fam->set, set, sizeof *set) == 0) return HD_OK;
    fam->filled = 0;
    if (fam->n_values < set->n_poles) {
        hdi_family_free(fam);
        fam->values = HDI_CAST(hd_c64 *, hdi_alloc(fam->ctx, HDI_CAST(uint64_t, set->n_poles) * (size + 1), sizeof(hd_c64), e));
        if (!fam->values) return e->status;
        fam->n_values = set->n_poles;
    }
    fam->set = *set;
    fam->t = t;
    hdi_noise_weights(fam->lap, t, hdi_rat_reach(set), fam->noise, fam->noise_work);
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
    uint64_t stride;             /* of work from pole to pole, at least 2 n */
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
static hd_status hdi_family_fill(hdi_family *fam, hd_c64 *work, uint64_t stride, hd_error *e) {
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

/* Right-hand sides at a time: at most, by iterations, and in a batch through the factors of poles. */
enum { HDI_LANES = 24, HDI_LANES_ITERATIVE = 4, HDI_LANES_BATCH = 8, HDI_BATCHES = 3, HDI_CHECK_MOST = 4 };

enum { HDI_LANCZOS_MAX = 4096 };

/* The state of a Lanczos process in the B inner product. */
typedef struct hdi_lanczos {
    double *v, *c, *c_old;                /* [n] v_m, B v_m, B v_(m-1) */
    double *alpha, *beta;                 /* [MAX + 1] T: diagonal, and beta[j] between j - 1 and j */
    double *d, *e, *z0, *z1, *y;          /* [MAX + 1] */
    hd_c64 *work;                         /* [2 MAX] */
    double noise;                         /* largest error of a step by rounding, in the B norm */
    int32_t m;
} hdi_lanczos;

/* One right-hand side under way. Arrays are [n] rows unless said otherwise. */
typedef struct hdi_lane {
    double *f, *rhs, *u;         /* the field, B f, the answer */
    double *tmp;                 /* [4 n] */
    double *target, *sums, *spare_sums;  /* [n_components] heat per component, work */
    hd_c64 *b, *vectors;
    hdi_krylov k[HD_MAX_POLES];
    hdi_lanczos lanczos;
    int32_t n_systems, skip;
    int32_t exponent;            /* the field is the caller's times 2^-exponent */
    double f_off, rhs_off;       /* what f, and B^-1 times the right-hand side, are off by in the B norm */
    /* outcome, norms absolute */
    double f_norm, u_norm;
    hdi_parts off, off_m;        /* bounds of the error in the norms of B and of B + tL */
    hd_evidence rounding;        /* how the part of rounding is known */
    double residual;
    double b_norm;               /* of the right-hand side, in the norm of diag(B)^-1 */
    double first_norm;           /* bound of |x|_B of one of the solutions, and its pole */
    double energy;               /* bound of f'B (B + tL)^-1 B f */
    int32_t first_pole;
    int32_t negative;            /* x'Lx < 0 was seen */
    int32_t watch;               /* direct: a row whose entries of all solutions are kept, -1: none */
    hd_c64 pole_value[HD_MAX_POLES];
    double pole_off[HD_MAX_POLES];   /* residual of each in the norm of diag(B)^-1, as far as it is seen */
    double seen_b, seen_m;       /* what these residuals make of the answer, in the norms of B and of B + tL */
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
    const uint64_t n = HDI_CAST(uint64_t, lap->n_active), n_comp = HDI_CAST(uint64_t, lap->n_components);
    if (lane->f) return HD_OK;
    lane->f = HDI_CAST(double *, hdi_alloc(ctx, 7 * n, sizeof(double), e));
    if (lane->f) lane->target = HDI_CAST(double *, hdi_alloc(ctx, 3 * n_comp, sizeof(double), e));
    if (!lane->target) {
        hdi_lane_free(lane, ctx);
        return e->status;
    }
    lane->rhs = lane->f + n;
    lane->u = lane->rhs + n;
    lane->tmp = lane->u + n;
    lane->sums = lane->target + n_comp;
    lane->spare_sums = lane->sums + n_comp;
    return HD_OK;
}

/* Room for Lanczos. */
static hd_status hdi_lane_lanczos(hdi_lane *lane, const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    const uint64_t n = HDI_CAST(uint64_t, lap->n_active), most = HDI_LANCZOS_MAX + 1;
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
static uint64_t hdi_lane_stride(const hdi_family *fam) {
    return HDI_CAST(uint64_t, hdi_krylov_vectors(fam->solver)) * HDI_CAST(uint64_t, fam->lap->n_active);
}

/* Room for the systems of a set, and their constants. */
static hd_status hdi_lane_systems(hdi_lane *lane, const hdi_family *fam, hd_error *e) {
    const uint64_t n = HDI_CAST(uint64_t, fam->lap->n_active), n_comp = HDI_CAST(uint64_t, fam->lap->n_components);
    const uint64_t n_vec = HDI_CAST(uint64_t, hdi_krylov_vectors(fam->solver)), count = HDI_CAST(uint64_t, fam->set.n_poles);
    uint64_t i, j;
    if (!lane->vectors || lane->n_systems < fam->set.n_poles) {
        hdi_free(fam->ctx, lane->b);
        hdi_free(fam->ctx, lane->vectors);
        lane->vectors = NULL;
        lane->n_systems = 0;
        lane->b = HDI_CAST(hd_c64 *, hdi_alloc(fam->ctx, 3 * n + n_comp, sizeof(hd_c64), e));
        if (lane->b) lane->vectors = HDI_CAST(hd_c64 *, hdi_alloc(fam->ctx, count * n_vec * n, sizeof(hd_c64), e));
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

/* Bound of |x - exact|_B by the residual. */
static double hdi_pole_error(const hdi_krylov *k) {
    return k->r_norm * hdi_ratio_root(k->a.lap) / hdi_pole_distance(k->a.theta);
}

/* What an error of x_p does to the answer at most. */
static double hdi_pole_weight(const hdi_family *fam, int32_t p) { return hdi_rat_count(&fam->set, p) * hdi_cabs(fam->set.a[p]); }

/* A residual where a measurement will do: twice what was found, and an eighth of what rounding could hide at the very worst,
 * about a unit in the last place of every row. */
static double hdi_residual_seen(double found, double rounding) { return 2 * found + rounding / 8; }

/* Enters the residual of pole p, found and by rounding, both in the norm of D^-1, into the lane's bounds. found counts
 * as a part of rounding where nothing was iterated. */
static void hdi_lane_residual(hdi_lane *lane, const hd_laplacian *lap, const hd_rational *set, int32_t p, double found, double rounding, int iterated) {
    const double weight = hdi_rat_count(set, p) * hdi_cabs(set->a[p]) * hdi_ratio_root(lap);
    const double by_b = weight / hdi_pole_distance(set->theta[p]), by_m = weight * hdi_pole_reach(set->theta[p]);
    const double solver = iterated ? found : 0, rest = rounding + found - solver;
    /* The sum of the answers loses half a unit of each |a x| twice a pole; |x|_B by that is at most rounding/|theta|. */
    const double sum = weight / hdi_rat_reach(set) * rounding * (2 * set->n_poles + 2) / (HDI_NOISE_TERMS + 1);
    lane->pole_off[p] = hdi_residual_seen(found, rounding);
    lane->seen_b += by_b * lane->pole_off[p];
    lane->seen_m += by_m * lane->pole_off[p];
    lane->off.solver += by_b * solver;
    lane->off_m.solver += by_m * solver;
    lane->off.rounding += by_b * rest + sum;
    lane->off_m.rounding += by_m * rest;
    if (lane->b_norm > 0) lane->residual = hdi_max(lane->residual, found / lane->b_norm);
}

static void hdi_lane_clear_off(hdi_lane *lane) {
    memset(&lane->off, 0, sizeof lane->off);
    memset(&lane->off_m, 0, sizeof lane->off_m);
    lane->seen_b = lane->seen_m = 0;
    lane->rounding = HD_EVIDENCE_PROVEN;
    lane->residual = 0;
    lane->negative = 0;
}

/* u = a0 f - sum a_i x_i, in the order of the poles, and the bounds of its error but for the rational part. */
static void hdi_lane_sum(hdi_lane *lane, const hdi_family *fam) {
    const int32_t n = fam->lap->n_active;
    double *HDI_RESTRICT u = lane->u;
    int32_t i, j;
    for (j = 0; j < n; j++) u[j] = fam->set.a0 * lane->f[j];
    for (i = 0; i < fam->set.n_poles; i++) {
        const hd_c64 *HDI_RESTRICT x = lane->k[i].x;
        const double c = hdi_rat_count(&fam->set, i), are = c * fam->set.a[i].re, aim = c * fam->set.a[i].im;
        for (j = 0; j < n; j++) u[j] -= are * x[j].re - aim * x[j].im;
        hdi_lane_residual(lane, fam->lap, &fam->set, i, lane->k[i].r_norm, sqrt(hdi_cnorm2w(x, fam->noise, n)), 1);
    }
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
    if (sum.re == 0 && sum.im == 0) return;
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
    part.share = n_poles > 0 ? watch->share / n_poles : 0;
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

/* ---- the same by factorisation ---- */

/* What is told of the solutions of a pack's four systems for one right-hand side, in one pass over L and B. */
typedef struct hdi_check {
    const hd_laplacian *lap;
    double t, theta[HDI_PACK];   /* re[4], im[4] */
    double coef[HDI_PACK];       /* u += coef' x, by real and imaginary parts */
    const double *weight, *noise;/* 1/diag(B); weights of rounding */
    const double *rhs, *x;       /* x: its row i at x + i stride */
    int64_t stride;
    double *u, *bu;              /* the answer, and B times it */
    double norm2[4], size2[4];   /* |rhs - A x|^2 in the norm of weight; |x|^2 in that of noise */
    double first2;               /* |x|_B^2 of the first system */
} hdi_check;

static void hdi_check_c(hdi_check *const *c, int32_t k) {
    const hd_laplacian *lap = c[0]->lap;
    int64_t p;
    int32_t i, r;
    int q;
    for (r = 0; r < k; r++) {
        hdi_check *h = c[r];
        for (i = 0; i < lap->n_active; i++) {
            const double *x = h->x + h->stride * i;
            double l[HDI_PACK], b[HDI_PACK];
            for (q = 0; q < HDI_PACK; q++) {
                l[q] = 0;
                b[q] = lap->B ? 0 : lap->mass[i] * x[q];
            }
            for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
                const double *v = h->x + h->stride * lap->L.col[p];
                for (q = 0; q < HDI_PACK; q++) l[q] += lap->L.val[p] * v[q];
                if (lap->B) for (q = 0; q < HDI_PACK; q++) b[q] += lap->B[p] * v[q];
            }
            for (q = 0; q < 4; q++) {
                const double re = h->rhs[i] - h->t * l[q] - (h->theta[q] * b[q] - h->theta[q + 4] * b[q + 4]);
                const double im = -h->t * l[q + 4] - (h->theta[q] * b[q + 4] + h->theta[q + 4] * b[q]);
                h->norm2[q] += h->weight[i] * (re * re + im * im);
                h->size2[q] += h->noise[i] * (x[q] * x[q] + x[q + 4] * x[q + 4]);
            }
            h->first2 += x[0] * b[0] + x[4] * b[4];
            for (q = 0; q < HDI_PACK; q++) {
                h->u[i] += h->coef[q] * x[q];
                h->bu[i] += h->coef[q] * b[q];
            }
        }
    }
}

#if HDI_X86
/* What is summed for one right-hand side. */
typedef struct hdi_check512 { hdi_v8 l, b, norm, first, size; } hdi_check512;

/* Row i is complete: l and b hold its products with L and B. */
static HDI_AVX512 HDI_INLINE void hdi_check512_row(hdi_check *h, hdi_check512 *s, int32_t i, const double *x) {
    const hdi_v8 t = _mm512_set1_pd(h->t), re = hdi_twice512(h->theta), im = hdi_twice512(h->theta + 4);
    const hdi_v8 turned = _mm512_mask_sub_pd(im, 0x0f, _mm512_setzero_pd(), im);
    const hdi_v8 weight = _mm512_set1_pd(h->weight[i]), noise = _mm512_set1_pd(h->noise[i]);
    const hdi_v8 v = _mm512_loadu_pd(x), coef = _mm512_loadu_pd(h->coef);
    hdi_v8 r = _mm512_fnmadd_pd(t, s->l, _mm512_maskz_mov_pd(0x0f, _mm512_set1_pd(h->rhs[i])));
    r = _mm512_fnmadd_pd(re, s->b, r);
    r = _mm512_fnmadd_pd(turned, _mm512_shuffle_f64x2(s->b, s->b, 0x4e), r);
    s->norm = _mm512_fmadd_pd(_mm512_mul_pd(weight, r), r, s->norm);
    s->first = _mm512_fmadd_pd(v, s->b, s->first);
    s->size = _mm512_fmadd_pd(_mm512_mul_pd(noise, v), v, s->size);
    h->u[i] += _mm512_reduce_add_pd(_mm512_mul_pd(coef, v));
    h->bu[i] += _mm512_reduce_add_pd(_mm512_mul_pd(coef, s->b));
}

static HDI_AVX512 HDI_INLINE void hdi_check512_end(hdi_check *h, const hdi_check512 *s) {
    double norm[HDI_PACK], size[HDI_PACK], first[HDI_PACK];
    int q;
    _mm512_storeu_pd(norm, s->norm);
    _mm512_storeu_pd(size, s->size);
    _mm512_storeu_pd(first, s->first);
    for (q = 0; q < 4; q++) {
        h->norm2[q] += norm[q] + norm[q + 4];
        h->size2[q] += size[q] + size[q + 4];
    }
    h->first2 += first[0] + first[4];
}

/* n right-hand sides, whose rows of x stand side by side. */
static HDI_AVX512 HDI_INLINE void hdi_check512_of(hdi_check *const *c, const int n) {
    const hd_laplacian *lap = c[0]->lap;
    const hdi_v8 zero = _mm512_setzero_pd();
    const int64_t stride = c[0]->stride;
    const int full = lap->B != NULL;
    hdi_check512 s[HDI_CHECK_MOST];
    int64_t p;
    int32_t i;
    int r;
    HDI_UNROLL
    for (r = 0; r < n; r++) s[r].norm = s[r].first = s[r].size = zero;
    for (i = 0; i < lap->n_active; i++) {
        const double *at = c[0]->x + stride * i;
        HDI_UNROLL
        for (r = 0; r < n; r++) {
            s[r].l = s[r].b = zero;
            if (full) continue;
            s[r].b = _mm512_mul_pd(_mm512_set1_pd(lap->mass[i]), _mm512_loadu_pd(at + HDI_PACK * r));
        }
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double *from = c[0]->x + stride * lap->L.col[p];
            const hdi_v8 lx = _mm512_set1_pd(lap->L.val[p]), bx = full ? _mm512_set1_pd(lap->B[p]) : zero;
            HDI_UNROLL
            for (r = 0; r < n; r++) {
                const hdi_v8 v = _mm512_loadu_pd(from + HDI_PACK * r);
                s[r].l = _mm512_fmadd_pd(lx, v, s[r].l);
                if (full) s[r].b = _mm512_fmadd_pd(bx, v, s[r].b);
            }
        }
        HDI_UNROLL
        for (r = 0; r < n; r++) hdi_check512_row(c[r], &s[r], i, at + HDI_PACK * r);
    }
    HDI_UNROLL
    for (r = 0; r < n; r++) hdi_check512_end(c[r], &s[r]);
}

static HDI_AVX512 void hdi_check_512(hdi_check *const *c, int32_t k) {
    switch (k) {
        case 1: hdi_check512_of(c, 1); break;
        case 2: hdi_check512_of(c, 2); break;
        case 3: hdi_check512_of(c, 3); break;
        default: hdi_check512_of(c, HDI_CHECK_MOST); break;
    }
}
#endif

/* What has been analysed and factorised for a plan: the pair in elimination order, the poles of a set at a time in packs (and a lone real pole in the real
 * factor), or B + g L for shift-and-invert Lanczos. */
typedef struct hdi_elim {
    hd_context *ctx;
    const hd_laplacian *source;  /* entries of its matrices are what the factors are made of */
    hd_laplacian *lap;           /* the same in elimination order, scaled */
    double scale;
    double *weight;              /* [n] 1/diag(B) */
    double *noise, *noise_shift; /* [n] weights of rounding, of the poles' matrices and of B + shift L; [n] work after them */
    double *reach;               /* [n] bound of diag((B + tL)^-1) for reach_t, or NULL */
    double reach_t;
    hdi_symbolic sym;
    hdi_factor pack[HD_MAX_POLES / 4], real;
    int32_t n_packs, filled;     /* packs that have room; 1: they hold set and t */
    int32_t lone;                /* pole in the real factor, -1 none */
    hd_rational set;
    double t;
    double shift;                /* the real factor is that of B + shift L; 0: of something else */
} hdi_elim;

static void hdi_elim_free(hdi_elim *m) {
    int32_t i;
    if (!m->ctx) return;
    for (i = 0; i < m->n_packs; i++) hdi_factor_free(m->pack + i);
    hdi_factor_free(&m->real);
    hdi_symbolic_free(m->ctx, &m->sym);
    hdi_free(m->ctx, m->weight);
    hdi_free(m->ctx, m->reach);
    hdi_laplacian_free(m->lap, m->ctx);
    memset(m, 0, sizeof *m);
}

/* perm of the vertices -> perm of the rows */
static void hdi_elim_own(const hd_laplacian *lap, const int32_t *perm, int32_t *rows) {
    int32_t i, k = 0;
    for (i = 0; i < lap->n; i++)
        if (lap->row[perm[i]] >= 0) rows[k++] = lap->row[perm[i]];
}

/* Ordering, analysis, and the pair renumbered by it. */
static hd_status hdi_elim_make(hdi_elim *m, const hd_laplacian *lap, hd_ordering ordering, int32_t dissect_from, const int32_t *own, double scale, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    int32_t *perm = HDI_TAKE(&s, int32_t, lap->n_active), *rows = HDI_TAKE(&s, int32_t, lap->n_active), chosen = 0, i;
    if (e->status < 0) return hdi_scope_end(&s);
    memset(m, 0, sizeof *m);
    m->ctx = ctx;
    m->source = lap;
    m->scale = scale;
    if (own) hdi_elim_own(lap, own, rows);
    if (e->status >= 0 && hdi_sym_order(&lap->L, lap->xyz, ordering, dissect_from, own ? rows : NULL, perm, &chosen, ctx, e) >= 0) {
        if (hdi_progress(ctx, "analyse", 0, e) >= 0 && hdi_symbolic_make(&m->sym, &lap->L, perm, ctx, e) >= 0) {
            m->sym.ordering = HDI_CAST(hd_ordering, chosen);
            m->lap = hdi_sym_renumber(lap, m->sym.perm, ctx, e);
        }
    }
    if (m->lap) {
        (void)hdi_sym_scale(m->lap);
        m->weight = HDI_CAST(double *, hdi_alloc(ctx, 4 * HDI_CAST(uint64_t, lap->n_active), sizeof(double), e));
        m->noise = m->weight ? m->weight + lap->n_active : NULL;
        m->noise_shift = m->weight ? m->noise + lap->n_active : NULL;
        for (i = 0; m->weight && i < lap->n_active; i++) m->weight[i] = 1 / m->lap->b_diag[i];
    }
    if (e->status < 0) hdi_elim_free(m);
    return hdi_scope_end(&s);
}

/* t L + theta B in terms of the source's entries; t comes scaled, as B does in lap. */
static hdi_values hdi_elim_values(const hdi_elim *m, double t) {
    hdi_values v;
    memset(&v, 0, sizeof v);
    v.l = m->source->L.val;
    v.b = m->source->B;
    v.b_diag = m->source->b_diag;
    v.t = t;
    return v;
}

/* Largest |diagonal entry| of t L + theta_q B, over k of them. */
static double hdi_elim_diagonal(const hd_laplacian *lap, double t, const hd_c64 *theta, int32_t k) {
    double most = 0;
    int64_t p;
    int32_t i, q;
    for (i = 0; i < lap->n_active; i++) {
        const double b = lap->b_diag[i];
        double l = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.col[p] == i) l = t * lap->L.val[p];
        for (q = 0; q < k; q++) most = hdi_max(most, hdi_cabs2(hdi_c(l + theta[q].re * b, theta[q].im * b)));
    }
    return sqrt(most);
}

static hd_status hdi_elim_real(hdi_elim *m, double t, double theta, hd_error *e) {
    const hd_c64 real = hdi_c(theta, 0);
    hdi_values v = hdi_elim_values(m, t);
    v.theta[0] = hdi_cscale(m->scale, real);
    m->shift = 0;
    if (!m->real.ctx && hdi_factor_make(&m->real, &m->sym, 1, m->ctx, e) < 0) return e->status;
    m->real.largest_entry = hdi_elim_diagonal(m->lap, t, &real, 1);
    return hdi_factor_run(&m->real, &v, e);
}

/* The factor of B + g L. */
static hd_status hdi_elim_shift(hdi_elim *m, double g, hd_error *e) {
    if (m->shift == g && m->real.ready) return HD_OK;
    if (m->lone >= 0) m->filled = 0;
    if (hdi_elim_real(m, g, 1, e) < 0) return e->status;
    if (m->real.all.negative) return hdi_fail(e, HD_ERR_NOT_POSITIVE, "L is not positive semi-definite, or B not positive definite: B + g L has a negative pivot");
    hdi_noise_weights(m->lap, g, 1, m->noise_shift, m->noise_shift + m->lap->n_active);
    m->shift = g;
    return HD_OK;
}

/* Packs a set needs; lone: the real pole that goes to the real factor because it would need a pack to itself. */
static int32_t hdi_elim_packs(const hd_rational *set, int32_t *lone) {
    *lone = set->n_poles % 4 == 1 && set->theta[0].im == 0 ? 0 : -1;
    return (set->n_poles - (*lone + 1) + 3) / 4;
}

/* Pole in place q of pack i, or the last one again. */
static int32_t hdi_elim_pole(const hdi_elim *m, int32_t i, int32_t q) {
    const int32_t p = m->lone + 1 + 4 * i + q;
    return p < m->set.n_poles ? p : m->set.n_poles - 1;
}

/* Factors of all poles of a set at a time. */
static hd_status hdi_elim_poles(hdi_elim *m, const hd_rational *set, double t, hd_error *e) {
    hdi_values v = hdi_elim_values(m, t);
    int32_t i, q, n_packs;
    if (m->filled && m->t == t && m->set.n_poles == set->n_poles && memcmp(m->set.theta, set->theta, HDI_CAST(size_t, set->n_poles) * sizeof *set->theta) == 0) {
        m->set = *set;                           /* weights cost nothing */
        return HD_OK;
    }
    m->filled = 0;
    m->reach_t = -1;
    m->set = *set;
    m->t = t;
    n_packs = hdi_elim_packs(set, &m->lone);
    for (; m->n_packs < n_packs; m->n_packs++)
        if (hdi_factor_make(m->pack + m->n_packs, &m->sym, HDI_PACK, m->ctx, e) < 0) return e->status;
    if (m->lone >= 0 && hdi_elim_real(m, t, set->theta[0].re, e) < 0) return e->status;
    for (i = 0; i < n_packs; i++) {
        hd_c64 theta[4];
        for (q = 0; q < 4; q++) {
            theta[q] = set->theta[hdi_elim_pole(m, i, q)];
            v.theta[q] = hdi_cscale(m->scale, theta[q]);
        }
        m->pack[i].largest_entry = hdi_elim_diagonal(m->lap, t, theta, 4);
        if (hdi_factor_run(m->pack + i, &v, e) < 0) {
            if (e->pole >= 0) e->pole = hdi_elim_pole(m, i, HDI_CAST(int32_t, e->pole));
            return e->status;
        }
    }
    hdi_noise_weights(m->lap, t, hdi_rat_reach(set), m->noise, m->noise_shift + m->lap->n_active);
    m->filled = 1;
    return HD_OK;
}

/* A batch of right-hand sides, each in a lane, solved through all poles. */
typedef struct hdi_batch {
    double *x, *xr, *work;       /* [n][k] packs, [n] or [n][8] real, sweeps */
    char *active;                /* [n_super] */
} hdi_batch;

/* Doubles of a batch's arrays. */
static uint64_t hdi_batch_size(const hdi_elim *m, int32_t k, uint64_t *x, uint64_t *xr) {
    const uint64_t n = HDI_CAST(uint64_t, m->sym.n), pack = hdi_sweep_size(&m->sym, HDI_PACK, k, 1), real = hdi_sweep_size(&m->sym, 1, k > 1 ? 8 : 1, 1);
    *x = HDI_PACK * n * HDI_CAST(uint64_t, k);
    *xr = n * (k > 1 ? 8 : 1);
    return *x + *xr + (pack > real ? pack : real) + HDI_CAST(uint64_t, m->sym.n_super) / sizeof(double) + 8;
}

static hd_status hdi_not_semidefinite(hd_error *e) {
    return hdi_fail(e, HD_ERR_NOT_POSITIVE, "L is not positive semi-definite: a vector with x'Lx < 0 was met (is it minus the matrix meant?)");
}

/* Keeps of the solution x of pole p what measures the resolvent: |x|_B, and a bound of f'B (B + tL)^-1 B f, which is at most
 * a factor times Re of rhs'x. Real parts of x are stride apart; norm2: |x|_B^2 as computed; off: bound of its residual. */
static void hdi_lane_first(hdi_lane *lane, const hd_laplacian *lap, const hd_rational *set, int32_t p, double norm2, double off, const double *x, int64_t stride) {
    const hd_c64 theta = set->theta[p];
    const double error = off * hdi_ratio_root(lap) / hdi_pole_distance(theta);
    const double factor = hdi_resolvent_factor(theta);
    double sum = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++)
        if (lane->rhs[i] != 0) sum += lane->rhs[i] * x[stride * i];
    lane->first_pole = p;
    lane->first_norm = sqrt(norm2) + error;
    /* t x^*Lx = Re x^*b - Re theta |x|_B^2, which rounding alone does not make negative */
    if (sum - theta.re * norm2 < -1e-6 * (fabs(sum) + fabs(theta.re) * norm2) - lane->b_norm * error) lane->negative = 1;
    if (hdi_finite(factor)) lane->energy = hdi_min(lane->energy, factor * (fabs(sum) + lane->f_norm * error));
}

/* Checks of a pack's systems for the lanes listed, their bounds, and their part of the answer. lane[q] has its solution at x + 8 at[q]. */
static void hdi_batch_pack(const hdi_elim *m, int32_t i, hdi_lane *const *lane, const int32_t *at, int32_t k, const double *x, int64_t stride) {
    const int32_t left = m->set.n_poles - (m->lone + 1 + 4 * i), n_here = left < 4 ? left : 4;
    hdi_check c[HDI_CHECK_MOST], *list[HDI_CHECK_MOST] = {NULL};
    int32_t r;
    int q, together = 1;
    for (r = 0; r < k; r++) {
        hdi_check *h = list[r] = c + r;
        memset(h, 0, sizeof *h);
        h->lap = m->lap;
        h->t = m->t;
        for (q = 0; q < 4; q++) {
            const int32_t p = hdi_elim_pole(m, i, q);
            const double count = q < n_here ? hdi_rat_count(&m->set, p) : 0;
            h->theta[q] = m->set.theta[p].re;
            h->theta[q + 4] = m->set.theta[p].im;
            h->coef[q] = -count * m->set.a[p].re;
            h->coef[q + 4] = count * m->set.a[p].im;
        }
        h->weight = m->weight;
        h->noise = m->noise;
        h->rhs = lane[r]->rhs;
        h->x = x + HDI_PACK * at[r];
        h->stride = stride;
        h->u = lane[r]->u;
        h->bu = lane[r]->tmp;
        together = together && at[r] == at[0] + r;
    }
#if HDI_X86
    if (together && m->pack[i].pack == hdi_pack_ops_get(2)) hdi_check_512(list, k);
    else
#endif
    hdi_check_c(list, k);
    for (r = 0; r < k; r++) {
        hdi_lane *to = lane[r];
        for (q = 0; q < n_here; q++) {
            const int32_t p = hdi_elim_pole(m, i, q);
            hdi_lane_residual(to, m->lap, &m->set, p, sqrt(c[r].norm2[q]), sqrt(c[r].size2[q]), 0);
            if (to->watch >= 0) to->pole_value[p] = hdi_c(c[r].x[stride * to->watch + q], c[r].x[stride * to->watch + q + 4]);
            if (i > 0 || q > 0) continue;
            hdi_lane_first(to, m->lap, &m->set, p, hdi_max(0, c[r].first2), sqrt(c[r].norm2[q]) + sqrt(c[r].size2[q]), c[r].x, stride);
        }
    }
}

/* The lone real pole's part. */
static void hdi_batch_real(const hdi_elim *m, hdi_lane *lane, const double *x, int64_t stride) {
    const hd_laplacian *lap = m->lap;
    const double theta = m->set.theta[0].re, a = m->set.a[0].re;
    double norm2 = 0, size2 = 0, first2 = 0, r;
    int64_t p;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        double l = 0, b = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double v = x[stride * lap->L.col[p]];
            l += lap->L.val[p] * v;
            if (lap->B) b += lap->B[p] * v;
        }
        if (!lap->B) b = lap->mass[i] * x[stride * i];
        r = lane->rhs[i] - m->t * l - theta * b;
        norm2 += m->weight[i] * r * r;
        size2 += m->noise[i] * x[stride * i] * x[stride * i];
        first2 += x[stride * i] * b;
        lane->u[i] -= a * x[stride * i];
        lane->tmp[i] -= a * b;
    }
    hdi_lane_residual(lane, lap, &m->set, 0, sqrt(norm2), sqrt(size2), 0);
    if (lane->watch >= 0) lane->pole_value[0] = hdi_c(x[stride * lane->watch], 0);
    hdi_lane_first(lane, lap, &m->set, 0, hdi_max(0, first2), sqrt(norm2) + sqrt(size2), x, stride);
}

/* u = a0 f - sum a_i x_i for k lanes (those that are skipped cost, but do not count). ctx: threads for the sweeps; NULL within a task. */
static void hdi_batch_run(const hdi_elim *m, const hdi_batch *b, hdi_lane *lane, int32_t k, hd_context *ctx) {
    const hdi_symbolic *s = &m->sym;
    const int32_t n = s->n, n_packs = (m->set.n_poles - (m->lone + 1) + 3) / 4, wide = k > 1 ? 8 : 1;
    int64_t j, touched = 0;
    int32_t i, r, n_list = 0, at[HDI_LANES_BATCH];
    hdi_lane *list[HDI_LANES_BATCH];
    hdi_sweep z;
    for (r = 0; r < k; r++) {
        if (lane[r].skip) continue;
        list[n_list] = lane + r;
        at[n_list++] = r;
    }
    memset(b->active, 0, HDI_CAST(size_t, s->n_super));
    for (r = 0; r < k; r++) {
        double norm2 = 0;
        for (j = 0; j < n; j++) {
            const double v = lane[r].skip ? 0 : lane[r].rhs[j];
            if (!lane[r].skip) {
                lane[r].u[j] = m->set.a0 * lane[r].f[j];
                lane[r].tmp[j] = m->set.a0 * v;  /* B u, as far as it has got */
            }
            if (v == 0) continue;
            norm2 += m->weight[j] * v * v;
            if (touched++ < 64 * HDI_CAST(int64_t, k)) hdi_sweep_touch(s, HDI_CAST(int32_t, j), b->active);
        }
        lane[r].b_norm = sqrt(norm2);
        hdi_lane_clear_off(lane + r);
        lane[r].energy = lane[r].f_norm * lane[r].f_norm;
    }
    if (m->lone >= 0) {
        for (j = 0; j < n; j++)
            for (r = 0; r < wide; r++) b->xr[wide * j + r] = r < k && !lane[r].skip ? lane[r].rhs[j] : 0;
        z = hdi_sweep_open(&m->real, wide, b->xr, b->work, ctx != NULL);
        z.active = touched < 64 * HDI_CAST(int64_t, k) ? b->active : NULL;
        hdi_sweep_run(&z, ctx);
        for (r = 0; r < k; r++)
            if (!lane[r].skip) hdi_batch_real(m, lane + r, b->xr + r, wide);
    }
    for (i = 0; i < n_packs; i++) {
        memset(b->x, 0, HDI_CAST(size_t, n) * HDI_CAST(size_t, k) * HDI_PACK * sizeof *b->x);
        for (r = 0; r < k; r++) {
            for (j = 0; j < n && !lane[r].skip; j++) {
                double *to = b->x + HDI_PACK * (k * j + r);
                to[0] = to[1] = to[2] = to[3] = lane[r].rhs[j];
            }
        }
        z = hdi_sweep_open(m->pack + i, k, b->x, b->work, ctx != NULL);
        z.active = touched < 64 * HDI_CAST(int64_t, k) ? b->active : NULL;
        hdi_sweep_run(&z, ctx);
        for (r = 0; r < n_list; r += HDI_CHECK_MOST)
            hdi_batch_pack(m, i, list + r, at + r, n_list - r < HDI_CHECK_MOST ? n_list - r : HDI_CHECK_MOST, b->x, HDI_PACK * HDI_CAST(int64_t, k));
    }
}

static void hdi_gather(const hd_laplacian *lap, const double *on_vertices, double *on_rows) {
    int32_t i;
    for (i = 0; i < lap->n_active; i++) on_rows[i] = on_vertices[lap->vertex[i]];
}

/* B without the zeros that the common pattern has. */
static hd_csr hdi_lap_mass_matrix(const hd_laplacian *lap, hdi_scope *s) {
    int64_t nnz = 0, p;
    int32_t i;
    hd_csr b;
    for (p = 0; p < lap->L.nnz; p++) nnz += lap->B[p] != 0;
    b = hdi_csr_take(s, lap->n_active, lap->n_active, nnz, 1);
    if (s->e->status < 0) return b;
    for (i = 0, nnz = 0; i < lap->n_active; i++) {
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            if (lap->B[p] == 0) continue;
            b.col[nnz] = lap->L.col[p];
            b.val[nnz++] = lap->B[p];
        }
        b.row_ptr[i + 1] = nnz;
    }
    return b;
}

/* Whether B - sigma diag(B) has an LDL' without a negative pivot, and so no negative eigenvalue (Sylvester).
 * value [nnz]: room. */
static int hdi_lap_exceeds(const hd_laplacian *lap, const hd_csr *b, double sigma, double *value, hdi_factor *f,
                           hd_error *e) {
    hdi_values v;
    int32_t i;
    int64_t p;
    memset(&v, 0, sizeof v);
    v.real = value;
    for (i = 0; i < b->n_rows; i++)
        for (p = b->row_ptr[i]; p < b->row_ptr[i + 1]; p++)
            value[p] = b->col[p] == i ? (1 - sigma) * lap->b_diag[i] : b->val[p];
    if (hdi_factor_run(f, &v, e) >= 0) return f->all.negative == 0;
    if (e->status == HD_ERR_BREAKDOWN) hdi_error_clear(e);   /* a pivot of zero proves nothing */
    return 0;
}

/* A proven b_ratio where Gershgorin's, in lap, is poor: values from the estimate downwards, each tried by a
 * factorisation. What that rounds is a matrix E with |x'Ex| <= eps (nnz(L) + 2 n) x'diag(B)x (after Rump
 * 2006): so much is added to sigma. Where all fail, B has a negative eigenvalue, or the ratio is not known.
 * */
static hd_status hdi_lap_ratio(hd_laplacian *lap, hd_error *e) {
    hdi_scope s = hdi_scope_begin(lap->context, e);
    const double dominant = hdi_max(lap->b_ratio, 0);
    double *work = HDI_TAKE(&s, double, 4 * HDI_CAST(int64_t, lap->n_active)), least, sigma, slack;
    int32_t *perm = HDI_TAKE(&s, int32_t, lap->n_active), chosen, tries;
    hd_csr b = hdi_lap_mass_matrix(lap, &s);
    double *value = HDI_TAKE(&s, double, b.nnz);
    hdi_symbolic sym;
    hdi_factor f;
    memset(&sym, 0, sizeof sym);
    memset(&f, 0, sizeof f);
    lap->b_ratio = dominant;
    if (e->status >= 0 && hdi_pair_ratio(lap, work, &least, e) >= 0 &&
        hdi_sym_order(&b, NULL, HD_ORDERING_MINIMUM_DEGREE, 0, NULL, perm, &chosen, lap->context, e) >= 0 &&
        hdi_symbolic_make(&sym, &b, perm, lap->context, e) >= 0 &&
        hdi_factor_make(&f, &sym, 1, lap->context, e) >= 0) {
        slack = DBL_EPSILON * (HDI_CAST(double, sym.nnz) + 2.0 * lap->n_active);
        for (tries = 0; e->status >= 0; tries++) {
            sigma = tries == 0 ? 0.8 * least : ldexp(least, 1 - 2 * tries);
            if (sigma < hdi_max(dominant, 1e-12)) break;
            if (hdi_lap_exceeds(lap, &b, sigma + slack, value, &f, e)) {
                lap->b_ratio = sigma;
                break;
            }
            if (tries != 1 || e->status < 0 || hdi_lap_exceeds(lap, &b, -slack, value, &f, e)) continue;
            if (f.all.negative) hdi_fail(e, HD_ERR_NOT_POSITIVE, "B is not positive definite: it has a negative pivot");
        }
    }
    hdi_factor_free(&f);
    hdi_symbolic_free(lap->context, &sym);
    return hdi_scope_end(&s);
}

/* Sets the heat of each component to c0 times that of the right-hand side: the constants' part of c(-t B^-1 L) f, exactly. */
static void hdi_conserve(const hd_laplacian *lap, hdi_lane *lane, double c0) {
    int32_t c;
    if (!lap->conserves) return;
    hdi_component_sums(lap, lap->mass, lane->u, lane->sums);
    for (c = 0; c < lap->n_components; c++) lane->sums[c] = (c0 * lane->target[c] - lane->sums[c]) / lap->component_mass[c];
    hdi_component_add(lap, lane->sums, lane->u);
}

/* What rounding does to the heat of components, n sums of masses times values, and to that of the field itself where it is
 * dense; and what is left of L 1, which counts as zero where it is so to rounding, up to 1e-8. Same in both norms. */
static double hdi_conserve_off(const hd_laplacian *lap, const hdi_lane *lane, double drift_t, int dense) {
    const double sums = HDI_CAST(double, lap->n_active) * DBL_EPSILON / 2;
    const double given = dense ? (sums + 4 * DBL_EPSILON) * lane->f_norm : 0;
    return (sums + 32 * DBL_EPSILON + hdi_min(drift_t, 1e-8)) * lane->u_norm + given + lane->rhs_off;
}

static void hdi_lane_rounding(hdi_lane *lane, double off) {
    lane->off.rounding += off;
    lane->off_m.rounding += off;
}

/* The same for c0 = 1, with the means in lane->sums kept. */
static void hdi_conserve_sums(const hd_laplacian *lap, hdi_lane *lane) {
    double *sums = lane->sums;
    lane->sums = lane->spare_sums;
    hdi_conserve(lap, lane, 1);
    lane->sums = sums;
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

/* Errors of a set, for |exp(x) - c(x)| and for (1 + |x|) times that. Of the caller's own sets either may be unknown, 0: a
 * weighted one bounds the other; without both, bounds hold for c itself. */
static double hdi_set_uniform(const hd_rational *set) {
    return set->max_error > 0 ? set->max_error : set->max_weighted_error;
}
static double hdi_set_weighted(const hd_rational *set) {
    return set->max_weighted_error > 0 ? set->max_weighted_error : set->max_error > 0 ? HUGE_VAL : 0;
}

/* Bounds of (exp - c)(-t B^-1 L) f in both norms. That of a weighted set is relative to the resolvent (B + t L)^-1 B f, which
 * a solution bounds; the constants drop out of built-in sets, whose c(0) = 1. */
static void hdi_rational_bound(const hd_laplacian *lap, const hd_rational *set, hdi_lane *lane) {
    const double weighted = hdi_set_weighted(set);
    const int constants = lap->conserves && set->kind == HD_POLES_OWN;
    int32_t p;
    for (p = 0; p < set->n_poles && constants; p++) {   /* c(0), by which constants are multiplied, and what they leave when taken out */
        const double off = 8 * DBL_EPSILON * hdi_rat_count(set, p) * hdi_cabs(set->a[p]) / hdi_pole_distance(set->theta[p]) * lane->f_norm;
        lane->off.rounding += off;
        lane->off_m.rounding += off;
    }
    for (p = 0; p < set->n_poles; p++)           /* the sum of the answers again: |x_v| <= sqrt(g_v) |x|_M */
        lane->off_m.rounding += (set->n_poles + 1) * DBL_EPSILON * hdi_rat_count(set, p) * hdi_cabs(set->a[p]) * hdi_pole_reach(set->theta[p]) * sqrt(lane->energy);
    if (set->a0 != 0 && lane->f_off > 0) {       /* nothing is known of f's error in the norm of B + tL */
        lane->off.rounding += fabs(set->a0) * lane->f_off;
        lane->off_m.rounding = HUGE_VAL;
        lane->rounding = HD_EVIDENCE_ESTIMATED;
    }
    lane->off.rational = hdi_set_uniform(set) * lane->f_norm;
    lane->off_m.rational = hdi_finite(weighted) ? weighted * (constants ? lane->f_norm : sqrt(lane->energy)) : HUGE_VAL;
    if (hdi_finite(weighted) && set->n_poles > 0) {
        const double resolvent = constants ? lane->f_norm : hdi_resolvent_ratio(set->theta[lane->first_pole]) * lane->first_norm;
        lane->off.rational = hdi_min(lane->off.rational, weighted * hdi_min(resolvent, lane->f_norm));
    }
}

/* Is u'Lu of an answer negative, beyond rounding? Matrices of the caller's own may be anything; a mesh's are not asked. */
static int hdi_lane_negative(const hd_laplacian *lap, const hdi_lane *lane) {
    double sum = 0, size = 0;
    int32_t i;
    int64_t p;
    if (lap->kind != HD_LAPLACIAN_MATRICES) return 0;
    for (i = 0; i < lap->n_active; i++) {
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double v = lane->u[i] * lap->L.val[p] * lane->u[lap->L.col[p]];
            sum += v;
            size += fabs(v);
        }
    }
    return sum < -1e-10 * size;
}

/* The right-hand side without its constants, complex. */
static void hdi_lane_rhs(hdi_lane *lane, const hd_laplacian *lap) {
    int32_t i;
    for (i = 0; i < lap->n_components; i++) lane->sums[i] = lap->conserves ? lane->target[i] / lap->component_mass[i] : 0;
    for (i = 0; i < lap->n_active; i++) lane->b[i] = hdi_c(lane->rhs[i] - lap->mass[i] * lane->sums[lap->component[i]], 0);
}

/* K_t f through a pole set. The tolerance is relative to the answer, which is not known before: a first round aims at it relative to f,
 * which is never too strict as |K_t f|_B <= |f|_B, and the next ones go on from there relative to what came out. */
static hd_status hdi_family_run(const hdi_family *fam, double tol, double drift_t, hdi_lane *lane, const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = fam->lap;
    const double c0 = fam->set.kind == HD_POLES_OWN ? hdi_rational_eval(&fam->set, 0) : 1;
    double aim = tol * lane->f_norm, room;
    hdi_watch part = *watch;
    hd_status status = HD_OK;
    int32_t round;
    hdi_lane_rhs(lane, lap);
    for (round = 0; round < 6; round++) {
        part.from = watch->from + watch->share * (round ? 0.7 : 0);
        part.share = watch->share * (round ? 0.3 : 0.7);
        status = hdi_lane_run(lane, fam, round == 0, aim, &part, e);
        if (status < 0) return status;
        hdi_lane_clear_off(lane);
        lane->b_norm = fam->set.n_poles > 0 ? lane->k[0].b_norm : 0;
        hdi_lane_sum(lane, fam);
        hdi_conserve(lap, lane, c0);
        lane->u_norm = sqrt(hdi_max(0, hdi_b_norm2(lap, lane->u, lane->tmp)));
        room = tol * (lane->u_norm - lane->off.solver);
        if (lane->off.solver <= room || status == HD_WARN_ACCURACY) break;
        aim = room > 0.01 * aim ? (1 - tol) * room : 0.01 * aim;
    }
    lane->first_pole = 0;
    lane->first_norm = 0;
    lane->energy = lane->f_norm * lane->f_norm;
    if (fam->set.n_poles > 0) {
        const hd_c64 *x = lane->k[0].x;
        hdi_lane_first(lane, lap, &fam->set, 0, hdi_b_norm2_complex(lap, x, lane->tmp), lane->k[0].r_norm, &x->re, 2);
        if (lane->negative || hdi_lane_negative(lap, lane)) return hdi_not_semidefinite(e);
    }
    hdi_rational_bound(lap, &fam->set, lane);
    hdi_lane_rounding(lane, hdi_conserve_off(lap, lane, drift_t, 1));
    return lane->off.solver <= tol * (lane->u_norm - lane->off.solver) ? HD_OK : HD_WARN_ACCURACY;
}

/* What is left to do after the poles' factors have been applied: constants, norms, bounds. limit: of rounding, relative to
 * the answer, above which the status warns. */
static hd_status hdi_elim_finish(const hdi_elim *m, double limit, double drift_t, int dense, hdi_lane *lane) {
    const hd_laplacian *lap = m->lap;
    int32_t i;
    hdi_conserve(lap, lane, m->set.kind == HD_POLES_OWN ? hdi_rational_eval(&m->set, 0) : 1);
    for (i = 0; i < lap->n_active && lap->conserves; i++) lane->tmp[i] += lap->mass[i] * lane->sums[lap->component[i]];   /* B u, what was added included */
    lane->u_norm = sqrt(hdi_max(0, hdi_dot(lane->u, lane->tmp, lap->n_active)));
    if (hdi_lane_negative(lap, lane)) lane->negative = 1;
    hdi_rational_bound(lap, &m->set, lane);
    hdi_lane_rounding(lane, hdi_conserve_off(lap, lane, drift_t, dense));
    return lane->off.rounding <= limit * (lane->u_norm - lane->off.rounding) ? HD_OK : HD_WARN_ACCURACY;
}

/* ---- entries of the kernel without columns ---- */

/* values [n_sets][stride] += sum over poles p of Re(weight[set][p] Z_p), Z_p = (t L + theta_p B)^-1: entries of the lower triangle in the order of the analysis,
 * or by pivots the diagonal, or that of B Z_p B. The factors are there, and stay. */
static hd_status hdi_elim_invert(hdi_elim *m, int32_t n_sets, const hd_c64 *weight, hdi_wanted wanted, double *values, int64_t stride, hd_error *e) {
    hdi_scope s = hdi_scope_begin(m->ctx, e);
    double *coef = HDI_TAKE(&s, double, HDI_PACK * HDI_CAST(uint64_t, n_sets));
    const int32_t n_poles = m->set.n_poles;
    hdi_forms forms;
    hdi_inverse z;
    double *b = NULL;
    int64_t p;
    int32_t i, k, q;
    if (wanted == HDI_WANT_FORMS) {              /* the source's entries, scaled as m->lap is */
        b = HDI_TAKE(&s, double, m->source->L.nnz);
        for (p = 0; b && p < m->source->L.nnz; p++) b[p] = m->scale * m->source->B[p];
    }
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = -1; i < (n_poles - (m->lone + 1) + 3) / 4 && e->status >= 0; i++) {   /* -1: the lone real pole */
        if (i < 0 && m->lone < 0) continue;
        memset(coef, 0, HDI_PACK * HDI_CAST(size_t, n_sets) * sizeof *coef);
        for (k = 0; k < n_sets; k++) {
            if (i < 0) coef[k] = weight[HDI_CAST(int64_t, k) * n_poles].re;
            for (q = 0; i >= 0 && q < 4 && m->lone + 1 + 4 * i + q < n_poles; q++) {
                const hd_c64 w = weight[HDI_CAST(int64_t, k) * n_poles + m->lone + 1 + 4 * i + q];
                coef[HDI_PACK * k + q] = w.re;
                coef[HDI_PACK * k + q + 4] = -w.im;
            }
        }
        if (i <= 0 && hdi_inverse_make(&z, &m->sym, i < 0 ? 1 : HDI_PACK, m->ctx, e) < 0) break;
        if (i <= 0 && wanted == HDI_WANT_FORMS && hdi_forms_make(&forms, &m->sym, i < 0 ? 1 : HDI_PACK, &m->source->L, b, m->ctx, e) < 0) {
            hdi_inverse_free(&z, m->ctx);
            break;
        }
        z.coef = coef;
        z.n_sets = n_sets;
        z.wanted = wanted;
        z.forms = &forms;
        z.values = values;
        z.stride = stride;
        (void)hdi_inverse_run(&z, i < 0 ? &m->real : m->pack + i, e);
        if (i >= 0 && e->status >= 0 && 4 * (i + 1) < n_poles - (m->lone + 1)) continue;   /* the next pack works in the same room */
        hdi_inverse_free(&z, m->ctx);
        if (wanted == HDI_WANT_FORMS) hdi_forms_free(&forms, m->ctx);
    }
    return hdi_scope_end(&s);
}

enum { HDI_RESOLVENT_POLES = 8, HDI_RESOLVENT_POINTS = 160 };

/* Weights with (B + tL)^-1 <= (1 + *slack) sum_p Re(weight_p (tL + theta_p B)^-1): 1/(1 + x) by least squares of the relative error. 0: not to be had; for
 * sets of few poles. work: columns [2 HDI_RESOLVENT_POLES + 1][HDI_RESOLVENT_POINTS]. */
static int hdi_resolvent_weights(const hd_rational *set, hd_c64 *weight, double *slack) {
    double work[(2 * HDI_RESOLVENT_POLES + 1) * HDI_RESOLVENT_POINTS], *b = work + 2 * HDI_RESOLVENT_POLES * HDI_RESOLVENT_POINTS, worst = 0;
    int32_t p, i, cols = 0;
    if (set->n_poles > HDI_RESOLVENT_POLES) return 0;
    for (p = 0; p < set->n_poles; cols += set->theta[p].im != 0 ? 2 : 1, p++) {
        for (i = 0; i < HDI_RESOLVENT_POINTS; i++) {
            const double s = (i + 0.5) / HDI_CAST(double, HDI_RESOLVENT_POINTS), x = 2 * s / ((1 - s) * (1 - s));
            const hd_c64 f = hdi_cdiv(hdi_c(1 + x, 0), hdi_c(x + set->theta[p].re, set->theta[p].im));
            work[cols * HDI_RESOLVENT_POINTS + i] = f.re;
            if (set->theta[p].im != 0) work[(cols + 1) * HDI_RESOLVENT_POINTS + i] = -f.im;
            b[i] = 1;
        }
    }
    hdi_least_squares(work, HDI_RESOLVENT_POINTS, cols, b);
    for (p = 0, cols = 0; p < set->n_poles; p++) {
        const int pair = set->theta[p].im != 0;
        weight[p] = hdi_c(b[cols], pair ? b[cols + 1] : 0);
        cols += pair ? 2 : 1;
    }
    for (i = 0; i <= 8 * HDI_RESOLVENT_POINTS; i++) {   /* the end is x = infinity */
        const double s = i / (8 * HDI_CAST(double, HDI_RESOLVENT_POINTS)), q = 0.5 * (1 - s) * (1 - s);   /* x = s/q */
        double sum = 0;
        for (p = 0; p < set->n_poles; p++) sum += hdi_cmul(weight[p], hdi_cdiv(hdi_c(q + s, 0), hdi_c(s + q * set->theta[p].re, q * set->theta[p].im))).re;
        worst = hdi_max(worst, fabs(sum - 1));
    }
    *slack = 2 * worst;
    return worst < 0.2;
}

/* What the constants alone are of diag((B + tL)^-1), however much of them rounding has eaten. */
static double hdi_constant_part(const hd_laplacian *lap, int32_t i) {
    return lap->conserves ? 1 / lap->component_mass[lap->component[i]] : 0;
}

/* m->reach: a bound of diag((B + tL)^-1) for the time of the poles, from the real factor at hand or a new one. */
static hd_status hdi_elim_bound(hdi_elim *m, hd_error *e) {
    const double theta = m->lone >= 0 ? m->set.theta[0].re : 1, factor = 1.01 * hdi_max(1, theta);   /* 1.01: rounding */
    const size_t n = HDI_CAST(size_t, m->sym.n);
    hdi_inverse z;
    int32_t i;
    if (m->reach && m->reach_t == m->t) return HD_OK;
    if (!m->reach) m->reach = HDI_CAST(double *, hdi_alloc(m->ctx, n, sizeof(double), e));
    if (m->reach && (m->lone >= 0 || hdi_elim_real(m, m->t, theta, e) >= 0) && hdi_inverse_make(&z, &m->sym, 1, m->ctx, e) >= 0) {
        memset(m->reach, 0, n * sizeof *m->reach);
        z.coef = &factor;
        z.n_sets = 1;
        z.wanted = HDI_WANT_DIAGONAL;
        z.values = m->reach;
        z.stride = m->sym.n;
        (void)hdi_inverse_run(&z, &m->real, e);
        hdi_inverse_free(&z, m->ctx);
        for (i = 0; i < m->sym.n; i++) {
            const double most = m->lap->b_ratio > 0 ? 1 / (m->lap->b_ratio * m->lap->b_diag[i]) : HUGE_VAL;
            if (!(m->reach[i] > 0 && m->reach[i] < most)) m->reach[i] = most;
            m->reach[i] = hdi_max(m->reach[i], hdi_constant_part(m->lap, i));
        }
        m->reach_t = m->t;
    }
    if (e->status < 0) {
        hdi_free(m->ctx, m->reach);
        m->reach = NULL;
    }
    return e->status;
}

/* The pole whose Re (tL + theta B)^-1 bounds (B + tL)^-1 best, times *factor: Re 1/(x + theta) >= 1/(factor (1 + x)) for x >= 0. -1: none does. */
static int32_t hdi_resolvent_pole(const hd_rational *set, double *factor) {
    int32_t p, best = -1;
    for (p = 0; p < set->n_poles; p++) {
        const double f = hdi_resolvent_factor(set->theta[p]);
        if (set->theta[p].re <= 0 || (best >= 0 && f >= *factor)) continue;
        best = p;
        *factor = f;
    }
    return best;
}

/* ==== [23] lanczos ====
 * Owns K_t f without poles: Lanczos for the exponential, and shift-and-invert Lanczos on one real factor. May call [22].
 * This work is based on
 *   M. Hochbruck, Ch. Lubich, On Krylov subspace approximations to the matrix exponential operator, 1997
 *   I. Moret, P. Novati, RD-rational approximations of the matrix exponential, 2004
 *   J. van den Eshof, M. Hochbruck, Preconditioning Lanczos approximations to the matrix exponential, 2006 */

/* ---- Lanczos for the exponential ---- */
/* The basis is not kept. A first sweep finds the coefficients, a second one makes the same vectors again, to the last bit, and adds them up: as
 * much work as writing them to fresh memory and reading them back would be, with six vectors in place of hundreds.
 * No reorthogonalisation: the few huge eigenvalues that slivers have come back as copies, which costs a third more steps (bunny, t = 100 h^2: 280
 * where full reorthogonalisation takes 200) and no accuracy. Simon's partial reorthogonalisation saves those steps and takes 2.4 times as long. */

/* t beta_(m+1) |e_m' phi_1(-t T) e_1|, phi_1(z) = (e^z - 1)/z: bounds the error of m steps from a vector of norm one. For the error is
 * beta int_0^t exp(-(t-s) B^-1 L) v_(m+1) e_m' exp(-s T) e_1 ds, the last factor has one sign for all s, and the first shrinks. */
static hd_status hdi_lanczos_bound(hdi_lanczos *z, double t, double *bound, hd_error *e) {
    const int32_t m = z->m;
    double sum = 0, least = 0, most = 0;
    int32_t i;
    for (i = 0; i < m; i++) {
        z->d[i] = z->alpha[i];
        z->e[i] = i + 1 < m ? z->beta[i + 1] : 0;
        z->z0[i] = i == 0;
        z->z1[i] = i == m - 1;
    }
    if (!hdi_tridiag_eigen(z->d, z->e, z->z0, z->z1, m)) return hdi_fail(e, HD_ERR_BREAKDOWN, "Lanczos: the projected eigenproblem did not converge");
    for (i = 0; i < m; i++) {
        least = hdi_min(least, z->d[i]);
        most = hdi_max(most, fabs(z->d[i]));
    }
    if (least < -1e-8 * most - 2 * sqrt(HDI_CAST(double, m)) * z->noise) return hdi_not_semidefinite(e);
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

/* What the process works on. */
typedef struct hdi_lanczos_task {
    const hd_laplacian *lap;
    const double *weight, *noise;        /* [n] 1/diag(B); weights of rounding of a product with L */
    double t, tol;
    double drift;                        /* change of a constant in unit time */
    int32_t max_iterations;
} hdi_lanczos_task;

/* A start: v of B norm one, c = B v. */
static void hdi_lanczos_start(hdi_lane *lane, int32_t n, double f0_norm) {
    hdi_lanczos *z = &lane->lanczos;
    int32_t i;
    for (i = 0; i < n; i++) {
        z->v[i] = lane->f[i] / f0_norm;
        z->c[i] = lane->rhs[i] / f0_norm;
        z->c_old[i] = 0;
    }
    z->beta[0] = z->noise = 0;
    z->m = 0;
}

/* One step: from v_j, c = B v_j, c_old = B v_(j-1) to the next, and alpha_j, beta_(j+1). work [4 n]. */
static hd_status hdi_lanczos_step(const hdi_lanczos_task *task, hdi_lanczos *z, double *HDI_RESTRICT w, double *mass,
                                  hd_error *e) {
    const hd_laplacian *lap = task->lap;
    const int32_t n = lap->n_active, j = z->m;
    const double *HDI_RESTRICT weight = task->weight, *HDI_RESTRICT noise = task->noise;
    double *HDI_RESTRICT v = z->v, *HDI_RESTRICT c = z->c, *HDI_RESTRICT c_old = z->c_old, alpha = 0, norm = 0, scale, off = 0;
    int32_t i;
    hdi_csr_apply_rows(&lap->L, v, w, 0, n);
    for (i = 0; i < n; i++) {
        w[i] -= z->beta[j] * c_old[i];
        alpha += v[i] * w[i];
        off += noise[i] * (v[i] * v[i]);
    }
    off = sqrt(off) * hdi_ratio_root(lap);
    if (alpha < -1e-6 * z->beta[j] - 4 * off) return hdi_not_semidefinite(e);
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
    z->noise = hdi_max(z->noise, off + 8 * DBL_EPSILON * (fabs(alpha) + z->beta[j] + z->beta[j + 1]));
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

/* A bound of what rounding does to m steps from a vector of norm one. With L v_j = B (sum of v_i T_ij) + errors of size noise
 * in B^-1, the answer is off by sum_j int_0^t exp(-(t-s) B^-1 L) (error j) e_j' exp(-s T) e_1 ds: at most noise sqrt(m) times
 * the integral of |exp(-s T) e_1|, which falls with s, so that sums from the left are above it. Then the sum of the answer. */
static double hdi_lanczos_rounding(const hdi_lanczos *z, double t) {
    const int32_t m = z->m;
    double integral = 0, from = 0, to, size = 0;
    int32_t i, k;
    for (k = 24; k >= 0; k--) {
        to = ldexp(t, -2 * k);
        for (size = 0, i = 0; i < m; i++) size += z->z0[i] * z->z0[i] * exp(-2 * from * hdi_max(0, z->d[i]));
        integral += sqrt(size) * (to - from);
        from = to;
    }
    for (size = 0, i = 0; i < m; i++) size += z->y[i] * z->y[i];
    return sqrt(HDI_CAST(double, m)) * (hdi_residual_seen(0, z->noise) * integral + m * DBL_EPSILON * sqrt(size));
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
static hd_status hdi_lanczos_first(const hdi_lanczos_task *task, double f0_norm, double fixed_norm2, hdi_lane *lane,
                                   const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = task->lap;
    const double t = task->t, tol = task->tol;
    const int32_t most = task->max_iterations < HDI_LANCZOS_MAX ? task->max_iterations : HDI_LANCZOS_MAX;
    hdi_lanczos *z = &lane->lanczos;
    double bound = 0, bound_before = 0, best = DBL_MAX, start = 0;
    int32_t look = 1, looked = 0, best_m = 0;
    hd_rational set;
    if (hdi_rational_get(&set, HD_POLES_UNIFORM, 14, e) < 0) return e->status;
    hdi_lanczos_start(lane, lap->n_active, f0_norm);
    for (;;) {
        if (hdi_lanczos_step(task, z, lane->tmp, lane->tmp + lap->n_active, e) < 0) return e->status;
        if (z->m < look && z->beta[z->m] > 0 && z->m < most) continue;
        if (hdi_lanczos_bound(z, t, &bound, e) < 0) return e->status;
        hdi_lanczos_coefficients(z, t, &set);
        lane->u_norm = sqrt(fixed_norm2 + f0_norm * f0_norm * hdi_dot(z->y, z->y, z->m));
        lane->off.solver = f0_norm * bound;
        lane->off.rounding = f0_norm * (hdi_lanczos_rounding(z, t) + set.max_error);   /* the coefficients are by poles */
        if (lane->off.solver <= tol * lane->u_norm || z->beta[z->m] == 0) return HD_OK;
        if (bound < best / 2) {
            best = bound;
            best_m = z->m;
        } else if (best < 1e-10 && z->m > best_m + 20 + z->m / 4) {
            return HD_WARN_ACCURACY;             /* what rounding leaves */
        }
        if (z->m >= most) {
            hdi_fail(e, HD_ERR_NOT_CONVERGED, "Lanczos did not reach the tolerance in its largest number of steps; use poles");
            e->value = lane->off.solver / lane->u_norm;
            return e->status;
        }
        if (start == 0) start = lane->off.solver;
        if (hdi_watch_look(watch, 0.5 * hdi_krylov_done(start, lane->off.solver, tol * lane->u_norm), e) < 0) return e->status;
        look = z->m + hdi_lanczos_pace(z->m, looked, lane->off.solver, f0_norm * bound_before, tol * lane->u_norm);
        looked = z->m;
        bound_before = bound;
    }
}

/* Second sweep: u += f0_norm sum y_j v_j. */
static hd_status hdi_lanczos_second(const hdi_lanczos_task *task, double f0_norm, hdi_lane *lane, const hdi_watch *watch,
                                    hd_error *e) {
    const int32_t n = task->lap->n_active, m = lane->lanczos.m;
    int32_t j;
    hdi_lanczos_start(lane, n, f0_norm);
    for (j = 0; j < m; j++) {
        hdi_axpy(f0_norm * lane->lanczos.y[j], lane->lanczos.v, lane->u, n);
        if (j % 16 == 0 && hdi_watch_look(watch, 0.5 + 0.5 * j / m, e) < 0) return e->status;
        if (j + 1 < m && hdi_lanczos_step(task, &lane->lanczos, lane->tmp, lane->tmp + n, e) < 0) return e->status;
    }
    lane->lanczos.m = m;
    return HD_OK;
}

/* K_t f by Lanczos. The constants of each component need none of it. */
static hd_status hdi_lanczos_run(const hdi_lanczos_task *task, hdi_lane *lane, const hdi_watch *watch, hd_error *e) {
    const hd_laplacian *lap = task->lap;
    const int32_t n = lap->n_active;
    hd_status status = HD_OK;
    double f0_norm, fixed = 0;
    int32_t i;
    memset(lane->u, 0, HDI_CAST(size_t, n) * sizeof *lane->u);
    hdi_lane_clear_off(lane);
    lane->rounding = HD_EVIDENCE_ESTIMATED;
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
        status = hdi_lanczos_first(task, f0_norm, fixed, lane, watch, e);
        if (status >= 0 && hdi_lanczos_second(task, f0_norm, lane, watch, e) < 0) return e->status;
        lane->steps = lane->lanczos.m;
    }
    if (status >= 0) hdi_conserve(lap, lane, 1);
    hdi_lane_rounding(lane, hdi_conserve_off(lap, lane, task->t * task->drift, 1));
    return status;
}

enum { HDI_SILAN_MAX = 160, HDI_SILAN_POINTS = 96, HDI_SILAN_WIDE = 8 };

/* The process for 1 or 8 right-hand sides side by side; times share it. */
typedef struct hdi_silan {
    const hdi_elim *m;
    int32_t k, wide, steps;      /* right-hand sides, 1 or 8, steps taken */
    double *v[HDI_SILAN_MAX + 1];/* [n][wide] the basis */
    double *c, *w, *work;        /* [n][wide] B v and S B v; sweeps */
    double *probe;               /* [2 n] a solution and its residual */
    double alpha[HDI_SILAN_MAX][HDI_SILAN_WIDE], beta[HDI_SILAN_MAX + 1][HDI_SILAN_WIDE];
    double noise[HDI_SILAN_MAX][HDI_SILAN_WIDE];   /* what rounding can do to a solve, in the norm of D^-1 */
    double solved;               /* largest residual found of a solve over that */
    double f_norm[HDI_SILAN_WIDE], whole[HDI_SILAN_WIDE];   /* |f|_B without and with its constants */
    double mu[HDI_SILAN_MAX], vectors[HDI_SILAN_MAX * HDI_SILAN_MAX];   /* eigenvalues of T of one right-hand side, rows of its eigenvectors */
    int32_t vectors_of, vectors_m;
    int32_t done[HDI_SILAN_WIDE];/* steps that were enough, 0: not yet */
    double g;
} hdi_silan;

/* ---- shift-and-invert Lanczos ---- */
/* Lanczos in the B inner product for S = (B + g L)^-1 B, whose large eigenvalues are those of the smooth modes: with S V = V T + beta v e_m',
 * exp(-t B^-1 L) f ~ |f|_B V exp(-t (T^-1 - 1)/g) e_1 for every t around 10 g. One real factor and one basis serve all these times. */
static void hdi_silan_free(hdi_silan *z, hd_context *ctx) {
    int32_t i;
    for (i = 0; i <= HDI_SILAN_MAX; i++) hdi_free(ctx, z->v[i]);
    hdi_free(ctx, z->c);
    hdi_free(ctx, z->work);
    memset(z, 0, sizeof *z);
}

/* y = B x for wide right-hand sides side by side. */
static void hdi_mass_rows_body(const hd_laplacian *lap, int32_t wide, const double *HDI_RESTRICT x, double *HDI_RESTRICT y, int32_t begin, int32_t end) {
    int32_t i, r;
    int64_t p;
    for (i = begin; i < end; i++) {
        if (wide == 1) {
            double s = 0;
            for (p = lap->L.row_ptr[i]; lap->B && p < lap->L.row_ptr[i + 1]; p++) s += lap->B[p] * x[lap->L.col[p]];
            y[i] = lap->B ? s : lap->mass[i] * x[i];
            continue;
        }
        for (r = 0; r < HDI_SILAN_WIDE; r++) y[HDI_SILAN_WIDE * HDI_CAST(int64_t, i) + r] = lap->B ? 0 : lap->mass[i] * x[HDI_SILAN_WIDE * HDI_CAST(int64_t, i) + r];
        for (p = lap->L.row_ptr[i]; lap->B && p < lap->L.row_ptr[i + 1]; p++) {
            const double b = lap->B[p], *HDI_RESTRICT from = x + HDI_SILAN_WIDE * HDI_CAST(int64_t, lap->L.col[p]);
            double *HDI_RESTRICT to = y + HDI_SILAN_WIDE * HDI_CAST(int64_t, i);
            for (r = 0; r < HDI_SILAN_WIDE; r++) to[r] += b * from[r];
        }
    }
}

typedef struct hdi_mass_job { const hd_laplacian *lap; int32_t wide; const double *x; double *y; } hdi_mass_job;

static void hdi_mass_task(void *arg, int64_t index, int32_t worker) {
    const hdi_mass_job *j = HDI_CAST(const hdi_mass_job *, arg);
    const int64_t begin = index * HDI_ROWS_PER_TASK, end = begin + HDI_ROWS_PER_TASK;
    (void)worker;
    hdi_mass_rows_body(j->lap, j->wide, j->x, j->y, HDI_CAST(int32_t, begin), HDI_CAST(int32_t, end < j->lap->n_active ? end : j->lap->n_active));
}

static void hdi_mass_apply(const hd_laplacian *lap, int32_t wide, const double *x, double *y, hd_context *ctx) {
    hdi_mass_job j;
    j.lap = lap;
    j.wide = wide;
    j.x = x;
    j.y = y;
    hdi_parallel(ctx, (HDI_CAST(int64_t, lap->n_active) + HDI_ROWS_PER_TASK - 1) / HDI_ROWS_PER_TASK, hdi_mass_task, &j);
}

/* out[r] = sum_i x_ir y_ir */
static void hdi_wide_dots(const double *HDI_RESTRICT x, const double *HDI_RESTRICT y, int64_t n, int32_t wide, double *out) {
    int64_t i;
    int r;
    if (wide == 1) {
        out[0] = hdi_dot(x, y, n);
        return;
    }
    for (r = 0; r < HDI_SILAN_WIDE; r++) out[r] = 0;
    for (i = 0; i < n; i++)
        for (r = 0; r < HDI_SILAN_WIDE; r++) out[r] += x[HDI_SILAN_WIDE * i + r] * y[HDI_SILAN_WIDE * i + r];
}

/* Starts from the lanes' f and rhs = B f without constants, which lanes keep apart in sums; |f|_B of what is left. */
static hd_status hdi_silan_start(hdi_silan *z, hdi_lane *lane, hd_context *ctx, hd_error *e) {
    const hd_laplacian *lap = z->m->lap;
    const uint64_t n = HDI_CAST(uint64_t, lap->n_active), wide = HDI_CAST(uint64_t, z->wide);
    int64_t i;
    int32_t r;
    if (!z->v[0]) z->v[0] = HDI_CAST(double *, hdi_alloc(ctx, n * wide, sizeof(double), e));
    if (z->v[0] && !z->c) z->c = HDI_CAST(double *, hdi_alloc(ctx, 2 * n * wide + 2 * n, sizeof(double), e));
    if (z->c && !z->work) z->work = HDI_CAST(double *, hdi_alloc(ctx, hdi_sweep_size(&z->m->sym, 1, z->wide, 1), sizeof(double), e));
    if (e->status < 0) return e->status;
    z->w = z->c + n * wide;
    z->probe = z->w + n * wide;
    z->solved = 0;
    z->steps = 0;
    z->vectors_of = -1;
    for (r = 0; r < z->wide; r++) {
        double norm;
        z->done[r] = 0;
        z->f_norm[r] = 0;
        z->whole[r] = r < z->k ? lane[r].f_norm : 0;
        if (r < z->k && !lane[r].skip) {
            for (i = 0; i < lap->n_components; i++) lane[r].sums[i] = lap->conserves ? lane[r].target[i] / lap->component_mass[i] : 0;
            for (i = 0; i < lap->n_active; i++) {
                const double mean = lane[r].sums[lap->component[i]];
                z->v[0][z->wide * i + r] = lane[r].f[i] - mean;
                z->c[z->wide * i + r] = lane[r].rhs[i] - lap->mass[i] * mean;
            }
        }
        norm = 0;
        for (i = 0; i < lap->n_active && r < z->k && !lane[r].skip; i++) norm += z->v[0][z->wide * i + r] * z->c[z->wide * i + r];
        if (norm > 0 && sqrt(norm) > DBL_EPSILON * lane[r].f_norm) z->f_norm[r] = sqrt(norm);
        else z->done[r] = -1;                    /* nothing there but constants */
        for (i = 0; i < lap->n_active; i++) {
            const int64_t at = z->wide * i + r;
            z->v[0][at] = z->f_norm[r] > 0 ? z->v[0][at] / z->f_norm[r] : 0;
            z->c[at] = z->f_norm[r] > 0 ? z->c[at] / z->f_norm[r] : 0;
        }
    }
    return HD_OK;
}

/* The residual of the solve w = S B v of right-hand side 0, held against what rounding can make of it. Some of the first
 * solves are looked at. */
static void hdi_silan_probe(hdi_silan *z) {
    const hd_laplacian *lap = z->m->lap;
    double *x = z->probe, *r = x + lap->n_active, sum = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) x[i] = z->w[HDI_CAST(int64_t, z->wide) * i];
    hdi_pair_apply(lap, z->g, 1, x, r);
    for (i = 0; i < lap->n_active; i++) {
        const double d = z->c[HDI_CAST(int64_t, z->wide) * i] - r[i];
        sum += z->m->weight[i] * (d * d);
    }
    if (z->noise[z->steps][0] > 0) z->solved = hdi_max(z->solved, sqrt(sum) / z->noise[z->steps][0]);
}

/* out[r] = sqrt(sum_i weight_i x_ir^2) */
static void hdi_wide_norms(const double *HDI_RESTRICT x, const double *HDI_RESTRICT weight, int64_t n, int32_t wide, double *out) {
    int64_t i;
    int r;
    for (r = 0; r < HDI_SILAN_WIDE; r++) out[r] = 0;
    if (wide == 1) out[0] = hdi_norm2w(x, weight, n);
    for (i = 0; wide > 1 && i < n; i++)
        for (r = 0; r < HDI_SILAN_WIDE; r++) out[r] += weight[i] * (x[HDI_SILAN_WIDE * i + r] * x[HDI_SILAN_WIDE * i + r]);
    for (r = 0; r < HDI_SILAN_WIDE; r++) out[r] = sqrt(out[r]);
}

/* One step for all. */
static hd_status hdi_silan_step(hdi_silan *z, hd_context *ctx, hd_error *e) {
    const hd_laplacian *lap = z->m->lap;
    const int64_t n = lap->n_active, count = n * z->wide;
    const int32_t j = z->steps, wide = z->wide;
    const double *HDI_RESTRICT v = z->v[j], *HDI_RESTRICT v_old = j > 0 ? z->v[j - 1] : z->v[j];
    double *HDI_RESTRICT w = z->w, norm[HDI_SILAN_WIDE], inv[HDI_SILAN_WIDE], *HDI_RESTRICT next;
    hdi_sweep s;
    int64_t i;
    int32_t r;
    if (!z->v[j + 1]) z->v[j + 1] = HDI_CAST(double *, hdi_alloc(ctx, HDI_CAST(uint64_t, count), sizeof(double), e));
    if (!z->v[j + 1]) return e->status;
    memcpy(w, z->c, HDI_CAST(size_t, count) * sizeof *w);
    s = hdi_sweep_open(&z->m->real, wide, w, z->work, 1);
    hdi_sweep_run(&s, ctx);
    hdi_wide_norms(w, z->m->noise_shift, n, wide, z->noise[j]);
    if (j == 0 || j == 3) hdi_silan_probe(z);
    hdi_wide_dots(w, z->c, n, wide, z->alpha[j]);
    for (r = 0; r < wide; r++) inv[r] = j > 0 ? z->beta[j][r] : 0;
    if (wide == 1)
        for (i = 0; i < n; i++) w[i] -= z->alpha[j][0] * v[i] + inv[0] * v_old[i];
    else
        for (i = 0; i < n; i++)
            for (r = 0; r < HDI_SILAN_WIDE; r++)
                w[HDI_SILAN_WIDE * i + r] -= z->alpha[j][r] * v[HDI_SILAN_WIDE * i + r] + inv[r] * v_old[HDI_SILAN_WIDE * i + r];
    hdi_mass_apply(lap, wide, w, z->c, ctx);
    hdi_wide_dots(w, z->c, n, wide, norm);
    for (r = 0; r < wide; r++) {
        z->beta[j + 1][r] = norm[r] > 0 ? sqrt(norm[r]) : 0;
        inv[r] = norm[r] > 0 ? 1 / z->beta[j + 1][r] : 0;
    }
    next = z->v[j + 1];
    if (wide == 1) {
        for (i = 0; i < n; i++) {
            next[i] = w[i] * inv[0];
            z->c[i] *= inv[0];
        }
    } else {
        for (i = 0; i < n; i++) {
            for (r = 0; r < HDI_SILAN_WIDE; r++) {
                next[HDI_SILAN_WIDE * i + r] = w[HDI_SILAN_WIDE * i + r] * inv[r];
                z->c[HDI_SILAN_WIDE * i + r] *= inv[r];
            }
        }
    }
    z->steps = j + 1;
    return HD_OK;
}

/* Eigenvalues of T_m of right-hand side r, and rows p and q of its eigenvectors. */
static int hdi_silan_eigen(const hdi_silan *z, int32_t r, int32_t m, int32_t p, int32_t q, double *d, double *x, double *y) {
    double off[HDI_SILAN_MAX];
    int32_t i;
    for (i = 0; i < m; i++) {
        d[i] = z->alpha[i][r];
        off[i] = i + 1 < m ? z->beta[i + 1][r] : 0;
        x[i] = i == p;
        y[i] = i == q;
    }
    return hdi_tridiag_eigen(d, off, x, y, m);
}

/* exp(-s (1/mu - 1)/g): mu is an eigenvalue of T in (0, 1]; what rounding makes of tiny ones belongs to modes that are gone. */
static double hdi_silan_decay(double mu, double s_over_g) { return mu > 1e-15 ? exp(-s_over_g * hdi_max(0, 1 / mu - 1)) : s_over_g > 0 ? 0 : 1; }

/* (F(a) - F(b))/(a - b) for F(x) = exp(-tau (1/x - 1)), a and b in (0, 1]; fa, fb: F there. */
static double hdi_silan_slope(double a, double fa, double b, double fb, double tau) {
    const double d = a - b;
    double x;
    if (fabs(d) > 0.1 * a) return (fa - fb) / d;
    if (!(b > 1e-15) || !(a > 1e-15)) return 0;
    x = -tau * d / (a * b);                      /* log(F(b)/F(a)) */
    if (fabs(x) < 1e-8) return fa * tau / (a * b);
    return x > 0 ? fb * expm1(-x) / d : -fa * expm1(x) / d;   /* from the larger one */
}

/* The bound of the error for right-hand side r after m steps at time t, relative to |f|_B, and |u|_B relative to it too. The error is beta times
 * sum_j x_j y_j F[mu_j, S] v_(m+1), with mu_j the eigenvalues of T, x and y the first and last rows of its eigenvectors, F[.,.] the divided difference;
 * S has its eigenvalues in (0, 1], where the sum is a smooth function of them, so that its maximum on points that crowd at both ends is the bound. */
static hd_status hdi_silan_bound(const hdi_silan *z, int32_t r, int32_t m, double t, double *bound, double *size, hd_error *e) {
    double d[HDI_SILAN_MAX], x[HDI_SILAN_MAX], y[HDI_SILAN_MAX], f[HDI_SILAN_MAX], most = 0, norm = 0;
    const double tau = t / z->g;
    int32_t i, k;
    if (!hdi_silan_eigen(z, r, m, 0, m - 1, d, x, y)) return hdi_fail(e, HD_ERR_BREAKDOWN, "Lanczos: the projected eigenproblem did not converge");
    for (i = 0; i < m; i++) {
        /* 1/(1 + g lambda); but what is left of a constant is only rounding */
        if (d[i] > 1.001 + 10 * (1 + z->solved) * z->noise[0][r] && z->f_norm[r] > 1e-8 * z->whole[r]) return hdi_not_semidefinite(e);
        f[i] = hdi_silan_decay(d[i], tau);
        norm += x[i] * f[i] * x[i] * f[i];
        x[i] *= y[i];
    }
    *size = sqrt(norm);
    for (k = 1; k <= HDI_SILAN_POINTS; k++) {
        const double s = sin(1.5707963267948966 * k / HDI_CAST(double, HDI_SILAN_POINTS)), at = s * s, fa = hdi_silan_decay(at, tau);
        double sum = 0;
        for (i = 0; i < m; i++) sum += x[i] * hdi_silan_slope(d[i], f[i], at, fa, tau);
        most = hdi_max(most, fabs(sum));
    }
    *bound = 1.2 * z->beta[m][r] * most;         /* for what falls between the points */
    return HD_OK;
}

/* All rows of T's eigenvectors, two at a time through the same rotations; kept for the next time. */
static hd_status hdi_silan_vectors(hdi_silan *z, int32_t r, int32_t m, hd_error *e) {
    int32_t k;
    if (z->vectors_of == r && z->vectors_m == m) return HD_OK;
    z->vectors_of = -1;
    for (k = 0; k < m; k += 2) {
        double *x = z->vectors + HDI_CAST(int64_t, k) * m, spare[HDI_SILAN_MAX];
        if (!hdi_silan_eigen(z, r, m, k, k + 1 < m ? k + 1 : k, z->mu, x, k + 1 < m ? x + m : spare))
            return hdi_fail(e, HD_ERR_BREAKDOWN, "Lanczos: the projected eigenproblem did not converge");
    }
    z->vectors_of = r;
    z->vectors_m = m;
    return HD_OK;
}

/* Coefficients of the basis for right-hand side r after m steps at time t, times |f|_B: y = exp(-t (T^-1 - 1)/g) e_1. */
static hd_status hdi_silan_coefficients(hdi_silan *z, int32_t r, int32_t m, double t, double *out, hd_error *e) {
    double first[HDI_SILAN_MAX];
    int32_t i;
    if (hdi_silan_vectors(z, r, m, e) < 0) return e->status;
    for (i = 0; i < m; i++) first[i] = z->f_norm[r] * z->vectors[i] * hdi_silan_decay(z->mu[i], t / z->g);
    for (i = 0; i < m; i++) out[i] = hdi_dot(z->vectors + HDI_CAST(int64_t, i) * m, first, m);
    return HD_OK;
}

/* Steps until the bounds of all right-hand sides at all times are below tol times their answers. fixed[r] is |constants|_B^2. */
static hd_status hdi_silan_run(hdi_silan *z, const double *t, int32_t n_times, double tol, const double *fixed, hd_context *ctx, hd_error *e) {
    double best[HDI_SILAN_WIDE], reached[HDI_SILAN_WIDE];   /* reached: bound relative to f: of an answer that has died away no digit is to be had */
    int32_t r, q, left = 0, look = 4, best_m[HDI_SILAN_WIDE], most = HDI_SILAN_MAX - 1;
    hd_status worst = HD_OK;
    for (r = 0; r < z->k; r++) {
        left += z->done[r] == 0;
        best[r] = HUGE_VAL;
        best_m[r] = 0;
    }
    while (left > 0) {
        double miss_all = 1;
        if (hdi_progress(ctx, "solve", hdi_min(0.95, z->steps / 40.0), e) < 0 || hdi_silan_step(z, ctx, e) < 0) return e->status;
        if (z->steps < look && z->steps < most) continue;
        for (r = 0; r < z->k; r++) {
            double miss = 0, worst_bound = 0;
            if (z->done[r]) continue;
            for (q = 0; q < n_times && z->beta[z->steps][r] > 0 && (q < 2 || miss <= 1); q++) {   /* last and first time first: the worst, as a rule */
                const double at = t[q == 0 ? n_times - 1 : q - 1];
                double bound, size;
                if (hdi_silan_bound(z, r, z->steps, at, &bound, &size, e) < 0) return e->status;
                size = sqrt(size * size + fixed[r] / (z->f_norm[r] * z->f_norm[r]));
                miss = hdi_max(miss, size > 0 ? bound / (tol * size) : bound > 0 ? HUGE_VAL : 0);
                worst_bound = hdi_max(worst_bound, bound);
            }
            reached[r] = worst_bound;
            if (miss < best[r] / 2 && z->steps < most) {
                best[r] = miss;
                best_m[r] = z->steps;
            } else if (z->steps > best_m[r] + 12 || z->steps >= most) {
                if (miss > 1 && reached[r] > 1e-6) return hdi_fail(e, HD_ERR_NOT_CONVERGED, "shift-and-invert Lanczos did not reach the tolerance");
                if (miss > 1) worst = HD_WARN_ACCURACY;
                miss = 1;
            }
            if (miss <= 1) {
                z->done[r] = z->steps;
                left--;
            }
            miss_all = hdi_max(miss_all, miss);
        }
        /* a step gains a factor of two or so */
        look = z->steps + (miss_all > 1 ? HDI_CAST(int32_t, hdi_min(8, 0.6 * log2(hdi_min(miss_all, 1e30)))) : 1);
        if (look <= z->steps) look = z->steps + 1;
    }
    return worst;
}

/* What rounding does to the answer of right-hand side r after m steps, relative to |f|_B: with S V = V T + ... + errors Phi_j
 * of the steps, it is off by sum_j (sum_k x_k V_jk F[mu_k, S]) Phi_j, divided differences as in hdi_silan_bound. A solve's
 * residual is an error no larger in the B norm. y: the answer's coefficients. T's eigenvectors are there. */
static double hdi_silan_rounding(const hdi_silan *z, int32_t r, int32_t m, double t, const double *y) {
    double f[HDI_SILAN_MAX], most[HDI_SILAN_MAX], slope[HDI_SILAN_MAX], sum = 0, size = 0;
    const double tau = t / z->g, root = hdi_ratio_root(z->m->lap);
    int32_t i, j, k;
    for (i = 0; i < m; i++) {
        f[i] = hdi_silan_decay(z->mu[i], tau);
        most[i] = 0;
        size += fabs(y[i]);
    }
    for (k = 2; k <= HDI_SILAN_POINTS; k += 2) {
        const double s = sin(1.5707963267948966 * k / HDI_CAST(double, HDI_SILAN_POINTS)), at = s * s, fa = hdi_silan_decay(at, tau);
        for (i = 0; i < m; i++) slope[i] = z->vectors[i] * hdi_silan_slope(z->mu[i], f[i], at, fa, tau);
        for (j = 0; j < m; j++) most[j] = hdi_max(most[j], fabs(hdi_dot(z->vectors + HDI_CAST(int64_t, j) * m, slope, m)));
    }
    for (j = 0; j < m; j++) {
        const double product = z->m->lap->B ? z->noise[j][r] : 0;   /* of B w, which makes the next right-hand side */
        const double step = root * (hdi_residual_seen(z->solved * z->noise[j][r], z->noise[j][r]) + product) + 4 * DBL_EPSILON * (fabs(z->alpha[j][r]) + z->beta[j][r] * (j > 0) + z->beta[j + 1][r]);
        sum += 1.5 * most[j] * step;
    }
    return z->f_norm[r] * sum + m * DBL_EPSILON * size;
}

/* The answer of right-hand side r at time t into its lane: constants and the basis' part. */
static hd_status hdi_silan_answer(hdi_silan *z, int32_t r, double t, double drift, hdi_lane *lane, hd_error *e) {
    const hd_laplacian *lap = z->m->lap;
    const int32_t m = z->done[r], n = lap->n_active;
    double y[HDI_SILAN_MAX], bound = 0, size, *HDI_RESTRICT u = lane->u;
    int64_t i, begin;
    int32_t j;
    for (i = 0; i < n; i++) u[i] = lane->sums[lap->component[i]];
    hdi_lane_clear_off(lane);
    lane->rounding = HD_EVIDENCE_MEASURED;
    lane->steps = m > 0 ? m : 0;
    if (m > 0) {
        if (hdi_silan_coefficients(z, r, m, t, y, e) < 0 || hdi_silan_bound(z, r, m, t, &bound, &size, e) < 0) return e->status;
        for (begin = 0; begin < n; begin += 1024) {   /* rows in blocks that stay in cache */
            const int64_t end = begin + 1024 < n ? begin + 1024 : n;
            for (j = 0; j < m; j++) {
                const double *HDI_RESTRICT v = z->v[j];
                if (z->wide == 1) for (i = begin; i < end; i++) u[i] += y[j] * v[i];
                else for (i = begin; i < end; i++) u[i] += y[j] * v[HDI_SILAN_WIDE * i + r];
            }
        }
        lane->off.solver = bound * z->f_norm[r];
        lane->off.rounding = hdi_silan_rounding(z, r, m, t, y);
    }
    hdi_conserve_sums(lap, lane);
    lane->u_norm = sqrt(hdi_max(0, hdi_b_norm2(lap, lane->u, lane->tmp)));
    hdi_lane_rounding(lane, hdi_conserve_off(lap, lane, t * drift, 1));
    return HD_OK;
}

/* ==== [24] ground ====
 * Owns L with one vertex of each component held at zero: its inverse, for distances without a time, and a bound of the
 * smallest eigenvalue that is not zero. May call [22]. */

/* L with one vertex of each component held at zero. All by rows in elimination order. */
typedef struct hdi_ground {
    hdi_factor factor;
    char *held;                  /* [n] */
    double *diag, *mean, *form;  /* [n] of G; G b; of G B G less the means' part, when formed */
    double *trace;               /* [n_components] at least 1/lambda for the smallest eigenvalue that is not zero */
    double largest_trace;
    double *mean_off;            /* [n_components] G b is off by at most sqrt(G_vv) times this */
    int32_t formed;
} hdi_ground;

/* ---- the pair grounded ---- */
/* With one vertex of each component held at zero L has an inverse G, and
 *     commute time  d^2 = (e_i - e_j)' G (e_i - e_j),     biharmonic  d^2 = |P G (e_i - e_j)|_B^2,
 * P taking out the mean of each component: exactly, and whatever the spectrum. diag(G) comes by selected inversion; that of
 * G B G is minus the derivative of diag((L + s B)^-1) at s = 0, which an imaginary s gives without cancellation.
 * This part is based on
 *   W. Squire, G. Trapp, Using complex variables to estimate derivatives of real functions, 1998
 * Components whose rows of L do not sum to zero are not held: there L has an inverse of its own. */

static void hdi_ground_free(hdi_ground *g, hd_context *ctx) {
    hdi_factor_free(&g->factor);
    hdi_free(ctx, g->held);
    hdi_free(ctx, g->diag);
    hdi_free(ctx, g->trace);
    memset(g, 0, sizeof *g);
}

/* Does L 1 vanish on each component, to rounding? free [n_components]: 1 where it does. */
static void hdi_ground_components(const hd_laplacian *lap, char *loose) {
    int32_t i;
    int64_t p;
    memset(loose, 1, HDI_CAST(size_t, lap->n_components));
    for (i = 0; i < lap->n_active && !lap->conserves; i++) {
        double sum = 0, size = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            sum += lap->L.val[p];
            size += fabs(lap->L.val[p]);
        }
        if (fabs(sum) > HDI_CAST(double, lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) * DBL_EPSILON * size) loose[lap->component[i]] = 0;
    }
}

/* L with the rows and columns held replaced by those of the identity, by entries of the source; imaginary: its B times that, or 0. */
static void hdi_ground_values(const hdi_elim *m, const hdi_ground *g, double imaginary, double *real, hd_c64 *z) {
    const hd_laplacian *lap = m->source;
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int32_t j = lap->L.col[p];
            const int held = g->held[m->lap->row[lap->vertex[i]]] || g->held[m->lap->row[lap->vertex[j]]];
            const double l = held ? i == j : lap->L.val[p], b = held ? 0 : lap->B ? lap->B[p] : i == j ? lap->mass[i] : 0;
            if (real) real[p] = l;
            else z[p] = hdi_c(l, imaginary * b);
        }
    }
}

/* out [n] += the diagonal of the inverse, by pivots, its part c times unit. */
static hd_status hdi_ground_diagonal(const hdi_elim *m, hdi_factor *f, int c, double unit, double *out, hd_error *e) {
    double coef[HDI_PACK];
    hdi_inverse z;
    memset(coef, 0, sizeof coef);
    coef[c] = unit;
    if (hdi_inverse_make(&z, &m->sym, f->width, m->ctx, e) < 0) return e->status;
    memset(out, 0, HDI_CAST(size_t, m->sym.n) * sizeof *out);
    z.coef = coef;
    z.n_sets = 1;
    z.wanted = HDI_WANT_DIAGONAL;
    z.values = out;
    z.stride = m->sym.n;
    (void)hdi_inverse_run(&z, f, e);
    hdi_inverse_free(&z, m->ctx);
    return e->status;
}

/* x = G x; rows held are zero in both. work: a sweep's. */
static void hdi_ground_solve(const hdi_elim *m, const hdi_ground *g, double *x, double *work) {
    hdi_sweep z;
    int32_t i;
    for (i = 0; i < m->sym.n; i++)
        if (g->held[i]) x[i] = 0;
    z = hdi_sweep_open(&g->factor, 1, x, work, 1);
    hdi_sweep_run(&z, m->ctx);
}

/* r = b - L x on the rows not held, by differences x_j - x_i: rows of L sum to zero but for `rest`, and neighbours are much
 * alike, so that next to nothing is lost. x as it stands for G b is then off by at most sqrt(G_vv) times off of v's component: for
 * |e_v' G r| <= sqrt(G_vv r'Gr), and r'Gr <= (sum |r_i| sqrt(G_ii))^2. extra: as much more in each |r_i|, or NULL. off
 * [n_components], or NULL. */
static void hdi_ground_residual(const hdi_elim *m, const hdi_ground *g, const double *b, const double *x, const double *extra, double *r, double *off) {
    const hd_laplacian *lap = m->lap;
    int32_t i;
    int64_t p;
    if (off) memset(off, 0, HDI_CAST(size_t, lap->n_components) * sizeof *off);
    for (i = 0; i < lap->n_active; i++) {
        const double c = (HDI_CAST(double, lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) + 4) * DBL_EPSILON;
        double size = fabs(b[i]), rest = 0;
        r[i] = b[i];
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1] && !g->held[i]; p++) {
            const double v = lap->L.val[p] * (x[lap->L.col[p]] - x[i]);
            r[i] -= v;
            size += fabs(v);
            rest += lap->L.val[p];
        }
        if (g->held[i]) r[i] = 0;
        else if (!lap->conserves) r[i] -= rest * x[i];
        size += lap->conserves ? 0 : fabs(rest * x[i]);
        if (!g->held[i] && off) off[lap->component[i]] += (fabs(r[i]) + c * size + (extra ? extra[i] : 0)) * sqrt(hdi_max(0, g->diag[i]));
    }
}

/* x = G b, solved, then once more for what is left; off as above. r [n], sweep: work. */
static void hdi_ground_refined(const hdi_elim *m, const hdi_ground *g, const double *b, const double *extra, double *x, double *off, double *r, double *sweep) {
    int32_t i;
    memcpy(x, b, HDI_CAST(size_t, m->sym.n) * sizeof *x);
    hdi_ground_solve(m, g, x, sweep);
    hdi_ground_residual(m, g, b, x, NULL, r, NULL);
    hdi_ground_solve(m, g, r, sweep);
    for (i = 0; i < m->sym.n; i++) x[i] += r[i];
    hdi_ground_residual(m, g, b, x, extra, r, off);
}

/* Factor, diag(G) and the trace. */
static hd_status hdi_ground_make(hdi_elim *m, hdi_ground *g, hd_error *e) {
    hdi_scope s = hdi_scope_begin(m->ctx, e);
    const hd_laplacian *lap = m->lap;
    const size_t n = HDI_CAST(size_t, lap->n_active), n_comp = HDI_CAST(size_t, lap->n_components);
    double *val;
    char *loose;
    hdi_values v;
    int32_t i;
    int64_t p;
    if (g->diag) return HD_OK;
    val = HDI_TAKE(&s, double, lap->L.nnz);
    loose = HDI_TAKE(&s, char, n_comp);
    if (e->status >= 0) g->held = HDI_CAST(char *, hdi_alloc(m->ctx, n, 1, e));
    if (g->held) g->diag = HDI_CAST(double *, hdi_alloc(m->ctx, 3 * n, sizeof(double), e));
    if (g->diag) g->trace = HDI_CAST(double *, hdi_alloc(m->ctx, 2 * n_comp, sizeof(double), e));
    if (g->trace && hdi_factor_make(&g->factor, &m->sym, 1, m->ctx, e) >= 0) {
        memset(g->trace, 0, n_comp * sizeof *g->trace);
        g->mean_off = g->trace + n_comp;
        g->mean = g->diag + n;
        g->form = g->mean + n;
        hdi_ground_components(lap, loose);
        for (i = lap->n_active; i-- > 0;) {      /* the last of each component */
            g->held[i] = loose[lap->component[i]];
            if (g->held[i]) loose[lap->component[i]] = 0;
        }
        hdi_ground_values(m, g, 0, val, NULL);
        memset(&v, 0, sizeof v);
        v.real = val;
        if (hdi_progress(m->ctx, "factor", 0, e) >= 0 && hdi_factor_run(&g->factor, &v, e) >= 0 && hdi_ground_diagonal(m, &g->factor, 0, 1, g->diag, e) >= 0) {
            if (g->factor.all.negative) hdi_not_semidefinite(e);
            for (i = 0; i < lap->n_active; i++) {
                double size = lap->B ? 0 : lap->mass[i];
                for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1] && lap->B; p++) size += fabs(lap->B[p]);
                if (g->held[i]) g->diag[i] = 0;
                g->trace[lap->component[i]] += hdi_max(0, g->diag[i]) * size;
            }
            for (i = 0; i < lap->n_components; i++) g->largest_trace = hdi_max(g->largest_trace, g->trace[i]);
        }
    }
    if (e->status < 0) hdi_ground_free(g, m->ctx);
    return hdi_scope_end(&s);
}

/* diag of G B G less the means' part: form; and G b: mean, with what that can be off by. */
static hd_status hdi_ground_forms(hdi_elim *m, hdi_ground *g, hd_error *e) {
    hdi_scope s = hdi_scope_begin(m->ctx, e);
    const hd_laplacian *lap = m->lap;
    const double step = g->largest_trace > 0 ? 1e-9 / g->largest_trace : 1;
    double *work, *b;
    char *loose;
    hdi_factor pack;
    hdi_values v;
    hd_c64 *val;
    int32_t i;
    if (g->formed) return HD_OK;
    loose = HDI_TAKE(&s, char, lap->n_components);
    val = HDI_TAKE(&s, hd_c64, lap->L.nnz);
    work = HDI_TAKE(&s, double, hdi_sweep_size(&m->sym, 1, 1, 1));
    b = HDI_TAKE(&s, double, 2 * HDI_CAST(uint64_t, lap->n_active));
    if (e->status >= 0 && hdi_factor_make(&pack, &m->sym, HDI_PACK, m->ctx, e) >= 0) {
        hdi_ground_values(m, g, step * m->scale, NULL, val);
        memset(&v, 0, sizeof v);
        v.z[0] = v.z[1] = v.z[2] = v.z[3] = val;
        if (hdi_factor_run(&pack, &v, e) >= 0) (void)hdi_ground_diagonal(m, &pack, 4, -1 / step, g->form, e);
        hdi_factor_free(&pack);
    }
    if (e->status < 0) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) b[i] = g->held[i] ? 0 : lap->mass[i];
    hdi_ground_refined(m, g, b, NULL, g->mean, g->mean_off, b + lap->n_active, work);
    hdi_ground_components(lap, loose);
    for (i = 0; i < lap->n_active; i++) {
        if (!loose[lap->component[i]]) g->mean[i] = 0;   /* nothing to take out */
        g->form[i] = g->held[i] ? 0 : hdi_max(0, g->form[i] - g->mean[i] * g->mean[i] / lap->component_mass[lap->component[i]]);
    }
    g->formed = 1;
    return hdi_scope_end(&s);
}

/* Column `row` of G, or with forms of P' G B G P, into u [n]; its error at v is at most sqrt(G_vv) times what is returned.
 * work: hdi_ground_room. */
static double hdi_ground_column(const hdi_elim *m, const hdi_ground *g, int32_t row, int forms, double *u, double *work) {
    const hd_laplacian *lap = m->lap;
    const int32_t n = lap->n_active, c = lap->component[row];
    const double mass = lap->component_mass[c], ws = forms ? g->mean[row] : 0, trace = g->trace[c];
    double *b = work, *y = b + n, *extra = y + n, *r = extra + n, *by = r + n, *sweep = by + lap->n_components, off;
    int32_t i;
    int64_t p;
    for (i = 0; i < n; i++) b[i] = i == row && !g->held[i];
    hdi_ground_refined(m, g, b, NULL, u, by, r, sweep);
    off = by[c];
    if (!forms) return off;
    for (i = 0; i < n; i++) {                    /* b = B y */
        double sum = lap->B ? 0 : lap->mass[i] * u[i], size = fabs(sum);
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1] && lap->B; p++) {
            sum += lap->B[p] * u[lap->L.col[p]];
            size += fabs(lap->B[p] * u[lap->L.col[p]]);
        }
        b[i] = g->held[i] ? 0 : sum;
        extra[i] = (HDI_CAST(double, lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) + 2) * DBL_EPSILON / 8 * size;
    }
    hdi_ground_refined(m, g, b, extra, y, by, r, sweep);
    for (i = 0; i < n; i++) u[i] = y[i] - (lap->component[i] == c ? ws * g->mean[i] / mass : 0);
    return trace * off + by[c] + g->mean_off[c] * (fabs(ws) / mass + sqrt(trace * g->diag[row] / mass));
}

static uint64_t hdi_ground_room(const hdi_elim *m) {
    return 4 * HDI_CAST(uint64_t, m->sym.n) + HDI_CAST(uint64_t, m->lap->n_components) + hdi_sweep_size(&m->sym, 1, 1, 1);
}

/* ==== [25] plan ====
 * Owns the plan hd_heat: which method a request takes, the copies of the pair, factors and bases that are kept, the run of
 * a request, and the report. May call [24] and [23].
 * This work is based on
 *   G. Patane, M. Spagnuolo, Heat diffusion kernel and distance on surface meshes and point sets, 2013, eqs. (8), (9)
 * Deviations: MINRES, which the paper names, is not valid for complex poles (see hd_solver). The constants of each
 * component are carried exactly, so that uniform sets conserve heat too. */

#define HDI_ROUNDING_LIMIT 1e-7              /* the direct method's own error by default is 3e-8 */

struct hd_heat {
    hd_context *ctx;
    const hd_laplacian *source;  /* the caller's */
    double scale;                /* what B, and with it t, is multiplied by in the two copies below, each made when it is first needed */
    hd_heat_opts opts;           /* resolved, perm and rational copied */
    int32_t *perm;
    int32_t iterations_asked, poles_asked, no_factors;   /* no_factors: they did not fit */
    int32_t exacting;            /* a tol below the default is asked for: sets of the highest degree */
    double limit;                /* of rounding relative to the answer, above which the status warns: tol, or by default */
    uint64_t no_factors_limit;   /* the byte limit that factors did not fit */
    hd_rational own_set;
    hdi_elim elim;               /* to factorise */
    hdi_ground ground;           /* made when it is first needed; of elim */
    hdi_silan *silan;
    double *batch_room;          /* arrays of the batches */
    uint64_t batch_doubles;
    hd_laplacian *lap;           /* to iterate on: renumbered and scaled */
    hdi_upper up;
    double *weight;              /* [n] 1/diag(B) */
    hdi_family fam;              /* of the last set and time */
    hdi_lane lane[HDI_LANES];    /* work arrays, kept from call to call */
    double lambda_max;           /* bound of the largest eigenvalue of B^-1 L */
    double *noise;               /* [n] weights of rounding of a product with L, in lap's order */
    double drift;                /* conserving pairs: a constant's change in unit time, were row sums not taken as zero */
};

/* The bounds of a lane's error at the vertices of the components where the answer is not zero: by the B norm, and by that of
 * B + tL with reach, a bound of diag((B + tL)^-1), where that is at hand (else NULL). */
static hdi_parts hdi_lane_bound(const hd_laplacian *lap, const hdi_lane *lane, const double *reach) {
    double smallest_b = HUGE_VAL, largest_g = 0, *touched = lane->spare_sums;
    hdi_parts by_b;
    int32_t i;
    memset(touched, 0, HDI_CAST(size_t, lap->n_components) * sizeof *touched);
    for (i = 0; i < lap->n_active; i++)
        if (lane->u[i] != 0) touched[lap->component[i]] = 1;
    for (i = 0; i < lap->n_active; i++) {
        if (touched[lap->component[i]] == 0) continue;
        smallest_b = hdi_min(smallest_b, lap->b_diag[i]);
        if (reach) largest_g = hdi_max(largest_g, reach[i]);
    }
    if (!hdi_finite(smallest_b)) smallest_b = lap->b_diag[0];   /* nothing came out */
    by_b = hdi_parts_scale(hdi_ratio_root(lap) / sqrt(smallest_b), lane->off);
    return reach ? hdi_parts_least(by_b, hdi_parts_scale(sqrt(largest_g), lane->off_m)) : by_b;
}

/* Adds the numbers of one field to the report, where the worst stays. ledger: a new one, or NULL when single values are noted
 * elsewhere. */
static void hdi_heat_judge(const hd_laplacian *lap, const hdi_lane *lane, hdi_ledger *ledger, const double *reach, int own, hd_report *rep) {
    double largest = 0, heat = 0, heat_in = 0, heat_abs = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        largest = hdi_max(largest, fabs(lane->u[i]));
        heat += lap->mass[i] * lane->u[i];
        heat_abs += fabs(lap->mass[i] * lane->u[i]);
    }
    for (i = 0; i < lap->n_components; i++) heat_in += lane->target[i];
    if (ledger) {
        const double total = hdi_parts_sum(&lane->off);
        hdi_parts off = hdi_lane_bound(lap, lane, reach);
        if (total > 0) off.rounding += DBL_EPSILON * largest;    /* of the value itself */
        hdi_ledger_note(ledger, largest, off);
        hdi_ledger_close(ledger, rep);
        rep->error_bound_b = hdi_max(rep->error_bound_b, hdi_quotient(total, lane->u_norm - total));
        hdi_bound_judge(rep->error_bound_b, rep);
        hdi_evidence_worst(&rep->evidence_b, hdi_max(ledger->known.rational, hdi_max(ledger->known.solver, ledger->known.rounding)));
    }
    rep->residual = hdi_max(rep->residual, lane->residual);
    if (lap->conserves && !own && heat_abs > 0) rep->mass_drift = hdi_max(rep->mass_drift, fabs(heat - heat_in) / heat_abs);
}

/* Gershgorin: every eigenvalue of B^-1 L is below this. A guess where b_ratio is not known: it serves for
 * choices only. */
static double hdi_lambda_bound(const hd_laplacian *lap) {
    double most = 0;
    int32_t i;
    int64_t p = 0;
    for (i = 0; i < lap->n_active; i++) {
        double sum = 0;
        for (; p < lap->L.row_ptr[i + 1]; p++) sum += fabs(lap->L.val[p]);
        most = hdi_max(most, sum / lap->b_diag[i]);
    }
    return most / hdi_max(lap->b_ratio, 1e-12);
}

/* |1'L 1| / 1'B1 of the component where it is largest, by sums without rounding to speak of (Neumaier 1974). */
static hd_status hdi_heat_drift(const hd_laplacian *lap, double *drift, hd_context *ctx, hd_error *e) {
    hdi_scope s = hdi_scope_begin(ctx, e);
    double *sum = HDI_TAKE_ZERO(&s, double, 2 * HDI_CAST(uint64_t, lap->n_components)), *rest;
    int64_t p;
    int32_t i;
    if (!sum) return hdi_scope_end(&s);
    rest = sum + lap->n_components;
    *drift = 0;
    for (i = 0; i < lap->n_active && lap->conserves; i++) {
        const int32_t c = lap->component[i];
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const double v = lap->L.val[p], t = sum[c] + v;
            rest[c] += fabs(sum[c]) >= fabs(v) ? sum[c] - t + v : v - t + sum[c];
            sum[c] = t;
        }
    }
    for (i = 0; i < lap->n_components && lap->conserves; i++) *drift = hdi_max(*drift, fabs(sum[i] + rest[i]) / lap->component_mass[i]);
    return hdi_scope_end(&s);
}

/* The power of four that brings the largest diagonal entry of B near one, see hdi_sym_scale. */
static double hdi_heat_scale(const hd_laplacian *lap) {
    double largest = 0;
    int32_t i;
    int exponent;
    for (i = 0; i < lap->n_active; i++) largest = hdi_max(largest, lap->b_diag[i]);
    frexp(largest, &exponent);
    return ldexp(1, -2 * (exponent / 2));
}

/* 1/diag(B), and room for three more vectors. */
static double *hdi_make_weight(const hd_laplacian *lap, hd_context *ctx, hd_error *e) {
    double *w = HDI_CAST(double *, hdi_alloc(ctx, 4 * HDI_CAST(uint64_t, lap->n_active), sizeof *w, e));
    int32_t i;
    for (i = 0; w && i < lap->n_active; i++) w[i] = 1 / lap->b_diag[i];
    return w;
}

/* The copy of the pair to iterate on. */
static hd_status hdi_heat_iterative(hd_heat *heat, hd_error *e) {
    if (heat->weight) return HD_OK;
    hdi_error_clear(e);
    if (!heat->lap) {
        if (hdi_progress(heat->ctx, "order", 0, e) < 0) return e->status;
        heat->lap = hdi_sym_ordered(heat->source, heat->ctx, e);
        if (!heat->lap) return e->status;
        (void)hdi_sym_scale(heat->lap);
    }
    if (!heat->up.ptr && hdi_upper_make(&heat->up, &heat->lap->L, heat->ctx, e) < 0) return e->status;
    heat->weight = hdi_make_weight(heat->lap, heat->ctx, e);
    if (!heat->weight) return e->status;
    heat->noise = heat->weight + heat->lap->n_active;
    heat->fam.noise = heat->noise + heat->lap->n_active;
    heat->fam.noise_work = heat->fam.noise + heat->lap->n_active;
    hdi_noise_weights(heat->lap, 1, 0, heat->noise, heat->fam.noise_work);
    heat->fam.ctx = heat->ctx;
    heat->fam.lap = heat->lap;
    heat->fam.up = &heat->up;
    heat->fam.weight = heat->weight;
    heat->fam.solver = heat->opts.solver == HD_SOLVER_COCR || heat->opts.solver == HD_SOLVER_MINRES ? heat->opts.solver : HD_SOLVER_COCG;
    heat->fam.precond = heat->opts.precond;
    heat->fam.max_iterations = heat->opts.max_iterations;
    return e->status;
}

/* The copy of the pair in elimination order, analysed. */
static hd_status hdi_heat_analysed(hd_heat *heat, hd_error *e) {
    if (heat->elim.ctx) return HD_OK;
    return hdi_elim_make(&heat->elim, heat->source, heat->opts.ordering, HDI_DISSECT_FROM, heat->perm, heat->scale, heat->ctx, e);
}

/* Checks a right-hand side. *exponent: its largest part is between 2^(exponent - 1) and 2^exponent. */
static hd_status hdi_solve_rhs(const hd_laplacian *lap, const hd_c64 *rhs, int *exponent, hd_error *e) {
    double largest = 0;
    int32_t v;
    for (v = 0; v < lap->n; v++) {
        if (!hdi_cfinite(rhs[v]))
            return hdi_fail_row(e, HD_ERR_NOT_FINITE, "solve: a value of the right-hand side is not finite", v,
                                -1, hdi_finite(rhs[v].re) ? rhs[v].im : rhs[v].re);
        if (lap->row[v] >= 0) largest = hdi_max(largest, hdi_max(fabs(rhs[v].re), fabs(rhs[v].im)));
    }
    frexp(largest, exponent);
    return HD_OK;
}

/* One system with a plan made for it. */
static hd_status hdi_shifted_solve(hd_heat *heat, double t, hd_c64 theta, const hd_c64 *rhs, hd_c64 *x, double tol, hd_solve_report *report,
                                   hd_error *e) {
    const hd_laplacian *lap;
    hdi_lane *lane = heat->lane;
    hdi_krylov *k = lane->k;
    hdi_watch watch;
    hd_rational set;
    hd_status status;
    double b_norm;
    int32_t i, v;
    int exponent, unit;
    if (hdi_solve_rhs(heat->source, rhs, &exponent, e) < 0 || hdi_heat_iterative(heat, e) < 0) return e->status;
    lap = heat->lap;
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
    for (i = 0; i < lap->n_active; i++) {        /* near one, so that no norm underflows or overflows */
        const hd_c64 r = rhs[lap->vertex[i]];
        lane->b[i] = hdi_c(ldexp(r.re, -exponent), ldexp(r.im, -exponent));
    }
    frexp(heat->scale, &unit);                   /* the answer is in units of the right-hand side's, times those of B */
    unit += exponent - 1;
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
    for (v = 0; v < lap->n; v++) {
        x[v] = hdi_c(ldexp(x[v].re, unit), ldexp(x[v].im, unit));
        if (!hdi_cfinite(x[v]) && e->status >= 0)
            hdi_fail_row(e, HD_ERR_NOT_FINITE, "solve: a value of the solution is not finite", v, -1, x[v].re);
    }
    return e->status;
}

/* Lanczos where the caller leaves the choice and asks for no pole set, B needs no solve, and its steps are few: a step reads L once and
 * streams about ten vectors, and stores one; through the poles a step reads as much five times over, in complex. */
static hd_solver hdi_heat_choose(const hd_heat *heat, double t) {
    const hd_heat_opts *o = &heat->opts;
    const double steps = 1.2 * sqrt(t * heat->lambda_max) + 10;
    if (o->solver) return o->solver;
    if (o->rational || o->poles || o->degree || o->precond != HD_PRECOND_MILDL || heat->source->B) return HD_SOLVER_COCG;
    return steps <= 400 ? HD_SOLVER_LANCZOS : HD_SOLVER_COCG;
}

typedef enum hdi_query { HDI_QUERY_FIELD, HDI_QUERY_OPERATOR, HDI_QUERY_SYMMETRIC } hdi_query;

/* Single entries of the kernel, sorted by their column: item q is order[begin[q]] to order[begin[q + 1] - 1]. */
typedef struct hdi_entry_list {
    hdi_pair *order;             /* [n] key: the column; id: which entry */
    int64_t *begin;              /* [k + 1] */
    const int32_t *rows;         /* [n] */
    double *values;              /* [n] for each time */
    hdi_ledger *ledger;          /* for each time */
    int64_t n;
} hdi_entry_list;

/* What is asked for: k items, each a field, a column, or the entries of a column. */
typedef struct hdi_request {
    hdi_query query;
    int32_t k, n_times;
    const double *t;             /* [n_times] in the caller's unit and order */
    const double *F;             /* fields, columns ldf apart */
    const int32_t *sources;      /* columns */
    const hdi_entry_list *list;  /* entries */
    double *U;                   /* item q at time m goes to column q n_times + m, ldu apart; NULL: nowhere */
    size_t ldf, ldu;
} hdi_request;

/* A call under way: a few items at a time, each in a lane. */
typedef struct hdi_heat_call {
    hd_heat *heat;
    hdi_request ask;
    hd_report *rep;
    hd_report own_report;
    hd_error *e, *err;           /* the report's; the caller's, or NULL */
    hdi_scope s;
    double t;                    /* the time under way, scaled */
    int32_t now;                 /* which of ask.t that is */
    const double *times;         /* [n_times] scaled, ascending; or t alone */
    int32_t n_times;
    const int32_t *time_column;  /* which of ask.t each is; NULL: in order */
    hd_method method;
    hd_solver solver;
    const hd_laplacian *lap;     /* the copy of the pair that the method works on; the caller's for t = 0 */
    const hd_rational *set;      /* instead of what the plan would take */
    int32_t diagonal, degree;    /* by default a set made for diagonals; its degree, 0: as ever */
    int32_t relative;            /* the report has errors relative to each value too */
    int32_t deflated;            /* direct: right-hand sides are without their constants */
    int32_t watching;            /* direct: the lanes keep the source's own entry, see hdi_lane.watch */
    double still;                /* t = 0 stands for a t so small that K_t f is f to rounding; |K_t - 1| <= this */
    int32_t equal;               /* t is so large that each component has its mean */
    double *off_b, *off_m;       /* [k] the columns' errors by rounding, as seen, in both norms; NULL: not wanted */
    hdi_lane *lane;              /* [HDI_LANES], the plan's */
    int32_t n_lanes, batch;      /* lanes that exist; first item in lane 0 */
    int32_t stop;
} hdi_heat_call;

/* t for the scaled pair. Where that is beyond all doubles anything as large does, and as small where it vanishes. */
static double hdi_heat_scaled(const hd_heat *heat, double t) {
    return t > 0 ? hdi_max(1e-300, hdi_min(t * heat->scale, 1e300)) : 0;
}

static hd_status hdi_heat_begin(hdi_heat_call *h, hd_heat *heat, hdi_query query, hd_report *report, hd_error *err) {
    memset(h, 0, sizeof *h);
    h->rep = report ? report : &h->own_report;
    memset(h->rep, 0, sizeof *h->rep);
    h->e = &h->rep->error;
    h->err = err;
    hdi_error_clear(h->e);
    h->heat = heat;
    h->ask.query = query;
    h->ask.n_times = h->n_times = 1;
    h->times = &h->t;
    if (!heat) return hdi_missing(h->e);
    h->s = hdi_scope_begin(heat->ctx, h->e);
    h->rep->reason = "nothing was asked for";
    h->lap = heat->source;
    h->lane = heat->lane;
    return HD_OK;
}

/* ---- choice of the method ---- */

/* Seconds that methods would take at rates one core has been seen to reach, and the bytes they would hold. */
typedef struct hdi_cost { double iterative, direct, krylov, direct_bytes, krylov_bytes; } hdi_cost;

/* Rates: flops of packs, with seconds per non-zero for what small fronts cost besides, and of real fronts; bytes per second of sweeps; seconds per
 * non-zero of a step of Lanczos (with what looks at its bound cost, per step squared) and of COCG; per row of an ordering with its analysis.
 * Measured on meshes of 36K to 1M vertices. */
#define HDI_RATE_PACK 70e9
#define HDI_ENTRY_PACK 12e-9
#define HDI_RATE_REAL 25e9
#define HDI_RATE_SWEEP 15e9
#define HDI_STEP_LANCZOS 1.6e-9
#define HDI_LOOK_LANCZOS 0.4e-6
#define HDI_STEP_COCG 4e-9
#define HDI_ROW_ANALYSIS 0.8e-6

/* Before the analysis, what little fill a surface can have: nnz(L) = 30 n, 22 n^1.5 flops; where rows are wider than 10 so much more of the former and its square
 * of the latter (point sets with 233 and 117 a row, 20 to 150 thousand: 1220 to 1700 n and 13000 n^1.5, 600 to 830 n and 3500 n^1.5). */
static hdi_cost hdi_heat_cost(const hdi_heat_call *h) {
    const hd_heat *heat = h->heat;
    const hd_heat_opts *o = &heat->opts;
    const hdi_symbolic *s = heat->elim.ctx ? &heat->elim.sym : NULL;
    const double n = heat->source->n_active, entries = HDI_CAST(double, heat->source->L.nnz), k = h->ask.k, hh = heat->source->h * heat->source->h * heat->scale;
    const double wide = hdi_max(1, entries / (10 * n));
    const double nnz = s ? HDI_CAST(double, s->nnz) : 30 * n * wide, flops = s ? s->flops_done : 22 * n * sqrt(n) * wide * wide;
    const double stored = s ? HDI_CAST(double, s->stored + s->work) : 40 * n * wide;
    const double real_stored = s ? HDI_CAST(double, s->panel[s->n_super] + s->work) : 40 * n * wide;
    const double analysis = s ? 0 : HDI_ROW_ANALYSIS * n * wide;
    const int32_t poles = o->rational ? o->rational->n_poles : o->degree ? (o->degree + 1) / 2 : 5;
    const int32_t pairs = o->rational ? poles : o->degree ? o->degree / 2 : 4, packs = pairs > 4 ? (pairs + 3) / 4 : 1;
    const double span = h->times[h->n_times - 1] / h->times[0], windows = span > 100 ? ceil(log(span) / log(100.0)) : 1;
    const double steps = 24 + 8 * log10(hdi_max(1, pow(span, 1 / windows)));
    double one, factor;
    hdi_cost c;
    int32_t q;
    c.iterative = 0.4e-6 * n;
    for (q = 0; q < h->n_times; q++) {
        const double t = h->times[q], tau = hh > 0 ? t / hh : t * heat->lambda_max / 10;
        if (hdi_heat_choose(heat, t) == HD_SOLVER_LANCZOS) {
            one = 1.2 * sqrt(t * heat->lambda_max) + 10;
            one *= (entries + 6 * n) * HDI_STEP_LANCZOS + one * HDI_LOOK_LANCZOS;
        } else {
            one = poles * (8 + hdi_min(14 * sqrt(tau), 400)) * 0.6 * (entries + 6 * n) * (heat->source->B ? 1.3 : 1) * HDI_STEP_COCG;
        }
        c.iterative += k * one;
    }
    c.krylov = analysis + windows * flops / HDI_RATE_REAL + k * windows * steps * (16 * nnz + 100 * n) / HDI_RATE_SWEEP + k * h->n_times * steps * 8 * n / HDI_RATE_SWEEP;
    factor = packs * (16 * flops / HDI_RATE_PACK + HDI_ENTRY_PACK * nnz) + (poles % 4 == 1 ? flops / HDI_RATE_REAL : 0);
    c.direct = analysis + h->n_times * (factor + k * packs * (64 * nnz + 400 * n) / (k > 1 ? 1.6 * HDI_RATE_SWEEP : 0.6 * HDI_RATE_SWEEP));
    if (heat->elim.filled && heat->elim.t == h->t && h->n_times == 1) c.direct -= factor;
    c.direct_bytes = 64 * packs * stored + 200 * n + 8 * real_stored;
    c.krylov_bytes = 8 * real_stored + 8 * n * (k > 1 ? 8 * steps : steps) + 200 * n;
    c.direct_bytes += hdi_min(k, HDI_LANES) * 140 * n;       /* lanes, and rows of a batch */
    c.krylov_bytes += hdi_min(k, HDI_SILAN_WIDE) * 80 * n;
    if (heat->elim.n_packs >= packs) c.direct_bytes = 0;     /* there already */
    if (heat->silan) c.krylov_bytes = 0;
    return c;
}

/* By the model, or as asked. The analysis is made only when iterating does not win against the least that a factorisation could cost. */
static hd_status hdi_heat_pick(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    const hd_context *ctx = heat->ctx;
    const double room = ctx->byte_limit ? HDI_CAST(double, ctx->byte_limit) - HDI_CAST(double, ctx->bytes_in_use) : HUGE_VAL;
    hdi_cost c;
    int no_direct, no_krylov;
    h->method = heat->opts.method;
    h->rep->reason = h->method == HD_METHOD_AUTO ? "chosen by cost" : "asked for";
    if (h->method == HD_METHOD_AUTO && heat->iterations_asked) {
        h->method = HD_METHOD_ITERATIVE;
        h->rep->reason = "a solver or preconditioner is asked for";
    }
    if (h->method == HD_METHOD_AUTO && heat->no_factors && ctx->byte_limit == heat->no_factors_limit) {
        h->method = HD_METHOD_ITERATIVE;
        h->rep->reason = "factors did not fit the byte limit";
    }
    if (h->method != HD_METHOD_AUTO) return HD_OK;
    c = hdi_heat_cost(h);
    if (!heat->elim.ctx && c.iterative > hdi_min(c.direct, heat->poles_asked ? HUGE_VAL : c.krylov) && hdi_min(c.direct_bytes, c.krylov_bytes) < room) {
        if (hdi_heat_analysed(heat, h->e) < 0) return h->e->status;
        c = hdi_heat_cost(h);
    }
    no_direct = c.direct_bytes > room;
    no_krylov = c.krylov_bytes > room || heat->poles_asked;
    h->method = HD_METHOD_ITERATIVE;
    h->rep->reason = no_direct && c.krylov_bytes > room ? "factors would not fit the byte limit" : "iterations cost less than a factorisation";
    if (!no_krylov && c.krylov < c.iterative && (no_direct || c.krylov <= c.direct)) {
        h->method = HD_METHOD_KRYLOV;
        h->rep->reason = h->n_times > 1 ? "one real factor serves many times" : "few columns: one real factor costs less than those of the poles";
    } else if (!no_direct && c.direct < c.iterative) {
        h->method = HD_METHOD_DIRECT;
        h->rep->reason = h->ask.k > 1 ? "many columns: solves with the factors of the poles cost least" : "the factors of the poles cost least";
    }
    return HD_OK;
}

/* Below, t lambda is nothing beside one. */
#define HDI_STILL 1e-18

/* From here on (t lambda_max) the question is worth its price, and what exp(-t lambda) is nothing after. */
#define HDI_EQUAL_FROM 1e8
#define HDI_EQUAL_BEYOND 750

/* Is t (scaled) so large that nothing is left but the means of the components? 1, 0, or an error. */
static int hdi_heat_equal(hd_heat *heat, double t, hd_error *e) {
    if (!heat->source->conserves || heat->opts.rational || t * heat->lambda_max < HDI_EQUAL_FROM) return 0;
    if (heat->elim.ctx && hdi_ground_make(&heat->elim, &heat->ground, e) >= 0) return t > 2 * HDI_EQUAL_BEYOND * heat->ground.largest_trace;
    if (e->status == HD_ERR_BREAKDOWN) hdi_error_clear(e);   /* not to be told: go on as ever */
    return 0;
}

/* The method, its copy of the pair, and what of the report is known by now. */
static hd_status hdi_heat_engine(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    if (h->n_times == 1 && !heat->opts.rational && h->t * heat->lambda_max < HDI_STILL) {   /* |exp(-t lambda) - 1| <= t lambda */
        h->still = h->t * heat->lambda_max;
        h->t = 0;
    }
    if (h->t == 0) {                             /* nothing to solve */
        h->method = heat->opts.method == HD_METHOD_AUTO ? HD_METHOD_ITERATIVE : heat->opts.method;
        h->rep->reason = "t = 0";
    } else if (hdi_heat_pick(h) < 0) {
        return h->e->status;
    } else if (h->method == HD_METHOD_ITERATIVE) {
        if (hdi_heat_iterative(heat, h->e) < 0) return h->e->status;
        h->lap = heat->lap;
    } else {
        if (hdi_heat_analysed(heat, h->e) < 0) return h->e->status;
        h->lap = heat->elim.lap;
        h->rep->ordering = heat->elim.sym.ordering;
        h->rep->factor_nnz = heat->elim.sym.nnz;
        if (h->n_times == 1) h->equal = hdi_heat_equal(heat, h->t, h->e);
        if (h->e->status < 0) return h->e->status;
    }
    h->rep->method = h->method;
    h->solver = h->method == HD_METHOD_ITERATIVE ? hdi_heat_choose(heat, h->t) : h->method == HD_METHOD_KRYLOV ? HD_SOLVER_LANCZOS : HD_SOLVER_AUTO;
    h->rep->solver = h->solver;
    h->rep->precond = h->method == HD_METHOD_ITERATIVE && h->solver != HD_SOLVER_LANCZOS ? heat->opts.precond : HD_PRECOND_NONE;
    return HD_OK;
}

static hd_status hdi_heat_end(hdi_heat_call *h) {
    const hd_error kept = *h->e;
    if (h->s.e) hdi_scope_end(&h->s);
    *h->e = kept;
    if (kept.status < 0) h->rep->status = kept.status;
    if (h->rep->evidence_b == HD_EVIDENCE_NONE) h->rep->error_bound_b = HUGE_VAL;
    if (!h->relative) h->rep->error_relative = HUGE_VAL;
    if (h->err) *h->err = kept;
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
static int32_t hdi_uniform_degree(const hd_laplacian *lap, const hdi_lane *lane, int direct) {
    hd_rational set;
    hd_error e;
    double least = 0;
    int32_t c, r;
    for (c = 0; c < lap->n_components && lap->conserves; c++) least += lane->target[c] * lane->target[c] / lap->component_mass[c];
    for (r = 8; r < HDI_RAT_UNIFORM_MAX; r = !direct ? r + 2 : r == 8 ? 9 : HDI_RAT_UNIFORM_MAX)
        if (hdi_rational_get(&set, HD_POLES_UNIFORM, r, &e) == HD_OK && set.max_error * lane->f_norm <= (direct ? 2e-9 : 1e-9) * sqrt(least)) break;
    return r;
}

/* All fields, before anything is solved or written. */
static hd_status hdi_fields_check(const hdi_heat_call *h) {
    int32_t q, v;
    for (q = 0; q < h->ask.k; q++) {
        const double *f = h->ask.F + HDI_CAST(size_t, q) * h->ask.ldf;
        for (v = 0; v < h->heat->source->n; v++)
            if (!hdi_finite(f[v])) return hdi_fail_row(h->e, HD_ERR_NOT_FINITE, "heat: a value of the field is not finite", v, q, f[v]);
    }
    return HD_OK;
}

static int32_t hdi_heat_source(const hdi_heat_call *h, int32_t q) {
    return h->ask.sources ? h->ask.sources[q] : HDI_CAST(int32_t, h->ask.list->order[h->ask.list->begin[q]].key);
}

/* Brings fields whose squares could leave the range of doubles near one, by a power of two. */
static void hdi_lane_unit(const hd_laplacian *lap, hdi_lane *lane) {
    double most = 0;
    int32_t i;
    int exponent = 0;
    for (i = 0; i < lap->n_active; i++) most = hdi_max(most, fabs(lane->f[i]));
    if (most > 0) frexp(most, &exponent);
    if (exponent > -256 && exponent < 256) return;
    lane->exponent = exponent;
    for (i = 0; i < lap->n_active; i++) lane->f[i] = ldexp(lane->f[i], -exponent);
}

/* What rounding does to B f for a full B, in the B norm after B^-1. Much where f lies along B's small eigenvectors. */
static double hdi_lane_rhs_off(const hd_laplacian *lap, const double *f) {
    double sum = 0;
    int32_t i;
    int64_t p;
    for (i = 0; i < lap->n_active && lap->B; i++) {
        double size = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) size += fabs(lap->B[p] * f[lap->L.col[p]]);
        size *= HDI_CAST(double, lap->L.row_ptr[i + 1] - lap->L.row_ptr[i]) * DBL_EPSILON / 2;
        sum += size * size / lap->b_diag[i];
    }
    return sum > 0 ? sqrt(sum) * hdi_ratio_root(lap) : 0;
}

/* Field and right-hand side of item q. A vertex without mass needs no solve: skip. */
static hd_status hdi_heat_load(const hdi_heat_call *h, int32_t q, hdi_lane *lane) {
    const hd_laplacian *lap = h->lap;
    const size_t bytes = HDI_CAST(size_t, lap->n_active) * sizeof(double);
    int32_t row;
    lane->skip = 0;
    lane->status = HD_OK;
    hdi_lane_clear_off(lane);
    lane->steps = 0;
    lane->exponent = 0;
    lane->f_off = lane->rhs_off = 0;
    lane->watch = -1;
    if (h->ask.query == HDI_QUERY_FIELD) {
        hdi_gather(lap, h->ask.F + HDI_CAST(size_t, q) * h->ask.ldf, lane->f);
        hdi_lane_unit(lap, lane);
        hdi_pair_apply(lap, 0, 1, lane->f, lane->rhs);
        lane->rhs_off = hdi_lane_rhs_off(lap, lane->f);
    } else {
        row = lap->row[hdi_heat_source(h, q)];
        lane->skip = row < 0;
        if (lane->skip) return HD_OK;
        lane->watch = h->watching ? row : -1;
        memset(lane->f, 0, bytes);
        memset(lane->rhs, 0, bytes);
        if (h->ask.query == HDI_QUERY_OPERATOR) {
            int64_t p;
            lane->f[row] = 1;
            for (p = lap->L.row_ptr[row]; p < lap->L.row_ptr[row + 1] && lap->B; p++) lane->rhs[lap->L.col[p]] = lap->B[p];   /* B e_row */
            if (!lap->B) lane->rhs[row] = lap->mass[row];
        } else {
            lane->rhs[row] = 1;
            if (h->method == HD_METHOD_DIRECT && h->t > 0 && h->heat->elim.set.a0 == 0 && lap->b_ratio > 0) {   /* B^-1 e is not needed, only a bound of its norm */
                hdi_component_sums(lap, NULL, lane->rhs, lane->target);
                lane->f_norm = 1 / sqrt(lap->b_ratio * lap->b_diag[row]);
                return HD_OK;
            }
            if (hdi_mass_solve(lap, lane->rhs, lane->f, lane->tmp, h->e) < 0) return h->e->status;
        }
    }
    hdi_heat_measure(lap, lane);
    if (h->ask.query == HDI_QUERY_SYMMETRIC && lap->B) lane->f_off = HDI_MASS_TOL * hdi_ratio_root(lap) * lane->f_norm;
    return HD_OK;
}

/* The unit of answers in terms of the method's copy of the pair: k_t has that of B^-1. */
static double hdi_heat_unit(const hdi_heat_call *h) {
    return h->ask.query == HDI_QUERY_SYMMETRIC && h->lap != h->heat->source ? h->heat->scale : 1;
}

/* The entries of item q, from the lane's answer. */
static void hdi_heat_store_entries(const hdi_heat_call *h, int32_t q, const hdi_lane *lane) {
    const hd_laplacian *lap = h->lap;
    const hdi_entry_list *list = h->ask.list;
    const double unit = hdi_heat_unit(h);
    double *values = list->values + list->n * h->now;
    int64_t p;
    for (p = list->begin[q]; p < list->begin[q + 1]; p++) {
        const hdi_pair at = list->order[p];
        const int32_t v = list->rows[at.id], row = lap->row[v];
        hdi_parts off;
        memset(&off, 0, sizeof off);
        values[at.id] = row < 0 ? 0 : unit * lane->u[row];
        if (lane->skip) values[at.id] = h->ask.query == HDI_QUERY_OPERATOR && HDI_CAST(uint64_t, v) == at.key;
        if (!lane->skip && row >= 0) off = hdi_parts_scale(unit * hdi_ratio_root(lap) / sqrt(lap->b_diag[row]), lane->off);
        hdi_ledger_note(list->ledger + h->now, values[at.id], off);
    }
}

/* What item q asked for at the time under way, from the lane's answer. */
static void hdi_heat_store(const hdi_heat_call *h, int32_t q, const hdi_lane *lane) {
    const hd_laplacian *lap = h->lap;
    const size_t column = HDI_CAST(size_t, q) * HDI_CAST(size_t, h->ask.n_times) + HDI_CAST(size_t, h->now);
    const double unit = hdi_heat_unit(h);
    double *u = h->ask.U ? h->ask.U + column * h->ask.ldu : NULL;
    int32_t i;
    if (h->ask.list) hdi_heat_store_entries(h, q, lane);
    if (!u) return;
    if (h->ask.query == HDI_QUERY_FIELD) {       /* vertices without mass keep their value */
        const double *f = h->ask.F + HDI_CAST(size_t, q) * h->ask.ldf;
        if (u != f) memmove(u, f, HDI_CAST(size_t, lap->n) * sizeof *u);
    } else {
        memset(u, 0, HDI_CAST(size_t, lap->n) * sizeof *u);
        if (lane->skip) u[hdi_heat_source(h, q)] = h->ask.query == HDI_QUERY_OPERATOR;
    }
    for (i = 0; i < lap->n_active && !lane->skip; i++)
        u[lap->vertex[i]] = lane->exponent ? ldexp(lane->u[i], lane->exponent) : unit * lane->u[i];
}

/* The degree of a uniform set that serves all fields; columns, whose constants are known to be small, get the highest. */
static hd_status hdi_heat_degree(const hdi_heat_call *h, int32_t *degree) {
    int32_t q, r;
    *degree = h->ask.query == HDI_QUERY_FIELD ? 8 : HDI_RAT_UNIFORM_MAX;
    if (h->ask.query == HDI_QUERY_FIELD && hdi_lane_make(h->lane, h->lap, h->heat->ctx, h->e) < 0) return h->e->status;
    for (q = 0; q < h->ask.k && h->ask.query == HDI_QUERY_FIELD; q++) {
        if (hdi_heat_load(h, q, h->lane) < 0) return h->e->status;
        r = hdi_uniform_degree(h->lap, h->lane, h->method == HD_METHOD_DIRECT);
        if (r > *degree) *degree = r;
    }
    return HD_OK;
}

/* The pole set of this call. */
static hd_status hdi_heat_set(const hdi_heat_call *h, hd_rational *set) {
    const hd_heat_opts *o = &h->heat->opts;
    const hd_pole_kind kind = o->poles ? o->poles : h->ask.query == HDI_QUERY_FIELD ? HD_POLES_UNIFORM : h->diagonal ? HD_POLES_DIAGONAL : HD_POLES_KERNEL;
    int32_t degree = o->degree ? o->degree : h->degree ? h->degree : h->heat->exacting ? HDI_RAT_KERNEL_MAX : h->method == HD_METHOD_DIRECT ? 9 : 10;   /* four pairs fill a pack, a real pole costs little */
    if (h->set || o->rational) {
        *set = h->set ? *h->set : *o->rational;
        return HD_OK;
    }
    if (!o->degree && !h->heat->exacting && kind == HD_POLES_UNIFORM && hdi_heat_degree(h, &degree) < 0) return h->e->status;
    return hdi_rational_get(set, kind, degree, h->e);
}

static hdi_lanczos_task hdi_heat_lanczos_task(const hd_heat *heat, double t) {
    hdi_lanczos_task task;
    task.lap = heat->lap;
    task.weight = heat->weight;
    task.noise = heat->noise;
    task.t = heat->lambda_max > 0 ? hdi_min(t, 1e100 / heat->lambda_max) : t;   /* beyond, all that moves is gone */
    task.tol = heat->opts.tol;
    task.drift = heat->drift;
    task.max_iterations = heat->opts.max_iterations;
    return task;
}

static void hdi_heat_task(void *arg, int64_t index, int32_t worker) {
    hdi_heat_call *h = HDI_CAST(hdi_heat_call *, arg);
    hdi_lane *lane = h->lane + index;
    const hdi_lanczos_task task = hdi_heat_lanczos_task(h->heat, h->t);
    hdi_watch watch;
    hdi_error_clear(&lane->error);
    if (lane->skip) return;
    watch.ctx = worker == 0 ? h->heat->ctx : NULL;
    watch.stop = &h->stop;
    watch.stage = "solve";
    watch.share = 1.0 / h->ask.k;
    watch.from = watch.share * HDI_CAST(double, h->batch + index);
    lane->status = hdi_watch_look(&watch, 0, &lane->error);
    if (lane->status >= 0) {
        if (h->solver == HD_SOLVER_LANCZOS) lane->status = hdi_lanczos_run(&task, lane, &watch, &lane->error);
        else lane->status = hdi_family_run(&h->heat->fam, h->heat->opts.tol, h->t * h->heat->drift, lane, &watch, &lane->error);
    }
    if (lane->status < 0) HDI_STORE(&h->stop, 1);
}

/* A new ledger for what the method computes. */
static hdi_ledger hdi_heat_ledger(const hdi_heat_call *h) {
    const int lanczos = h->solver == HD_SOLVER_LANCZOS, still = h->t == 0 || h->equal;
    const hd_rational *set = h->method == HD_METHOD_DIRECT ? &h->heat->elim.set : &h->heat->fam.set;
    const int itself = set->kind == HD_POLES_OWN && hdi_set_uniform(set) == 0;   /* bounds are for c itself */
    const hd_evidence rational = still || lanczos || itself ? HD_EVIDENCE_NONE : HD_EVIDENCE_PROVEN;
    const hd_evidence solver = still || h->method == HD_METHOD_DIRECT ? HD_EVIDENCE_NONE
                             : h->method == HD_METHOD_KRYLOV ? HD_EVIDENCE_ESTIMATED : HD_EVIDENCE_PROVEN;
    return hdi_ledger_begin(rational, solver, HD_EVIDENCE_PROVEN, 0);
}

/* Judges lane i of the batch. */
static void hdi_heat_note(hdi_heat_call *h, hdi_ledger ledger, int32_t i, int own) {
    const hdi_lane *lane = h->lane + i;
    const hdi_elim *m = &h->heat->elim;
    const double *reach = h->method == HD_METHOD_DIRECT && h->t > 0 && !h->equal && m->reach && m->reach_t == m->t ? m->reach : NULL;
    ledger.known.rounding = lane->rounding;
    hdi_heat_judge(h->lap, lane, h->ask.list ? NULL : &ledger, reach, own, h->rep);
    if (h->ask.list) h->ask.list->ledger[h->now].known = ledger.known;
    if (h->off_b) h->off_b[h->batch + i] = lane->seen_b;
    if (h->off_m) h->off_m[h->batch + i] = lane->seen_m;
}

/* Report and errors of the lanes, in their order: the first failure that is not "another task failed" is the one to tell. */
static hd_status hdi_heat_collect(hdi_heat_call *h, int32_t n) {
    const hd_rational *set = &h->heat->fam.set;
    const int own = h->heat->opts.rational != NULL, poles = h->method == HD_METHOD_ITERATIVE && h->solver != HD_SOLVER_LANCZOS;
    const hdi_ledger blank = hdi_heat_ledger(h);
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
        if (lane->skip) {                        /* exact */
            if (!h->ask.list) hdi_evidence_worst(&h->rep->evidence_b, HD_EVIDENCE_PROVEN);
            continue;
        }
        if (lane->status > h->rep->status) h->rep->status = lane->status;
        h->rep->iterations += lane->steps;
        for (p = 0; poles && h->t > 0 && !h->equal && p < set->n_poles; p++) {
            h->rep->pole_iterations[p] += lane->k[p].iterations;
            h->rep->iterations += lane->k[p].iterations;
        }
        hdi_heat_note(h, blank, i, own);
    }
    return HD_OK;
}

static void hdi_report_set(hd_report *rep, const hd_rational *set) {
    rep->poles = set->kind;
    rep->degree = set->degree;
    rep->n_poles = set->n_poles;
}

/* Lanes for the items of the call, at most so many at a time. */
static hd_status hdi_heat_lanes(hdi_heat_call *h, int32_t most) {
    int32_t i;
    h->n_lanes = h->ask.k < most ? h->ask.k : most;
    for (i = 0; i < h->n_lanes; i++)
        if (hdi_lane_make(h->lane + i, h->lap, h->heat->ctx, h->e) < 0) break;
    return h->e->status;
}

/* Loads the next items into the lanes; how many they are. */
static int32_t hdi_heat_load_some(hdi_heat_call *h) {
    const int32_t left = h->ask.k - h->batch, n = left < h->n_lanes ? left : h->n_lanes;
    int32_t i;
    for (i = 0; i < n; i++)
        if (hdi_heat_load(h, h->batch + i, h->lane + i) < 0) break;
    return n;
}

/* Judges and stores the answers of n lanes. */
static hd_status hdi_heat_store_some(hdi_heat_call *h, int32_t n) {
    int32_t i;
    if (h->e->status < 0 || hdi_heat_collect(h, n) < 0) return h->e->status;
    for (i = 0; i < n; i++) hdi_heat_store(h, h->batch + i, h->lane + i);
    return HD_OK;
}

/* ---- iterative ---- */

/* Lanes, the pole set and its preconditioners. */
static hd_status hdi_iterative_prepare(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    hd_rational set;
    int32_t i;
    if (hdi_heat_lanes(h, HDI_LANES_ITERATIVE) < 0) return h->e->status;
    for (i = 0; i < h->n_lanes && h->solver == HD_SOLVER_LANCZOS; i++)
        if (hdi_lane_lanczos(h->lane + i, h->lap, heat->ctx, h->e) < 0) return h->e->status;
    if (h->solver == HD_SOLVER_LANCZOS) return HD_OK;
    if (hdi_heat_set(h, &set) < 0 || hdi_family_set(&heat->fam, &set, h->t, h->e) < 0) return h->e->status;
    hdi_report_set(h->rep, &set);
    for (i = 0; i < h->n_lanes; i++)
        if (hdi_lane_systems(h->lane + i, &heat->fam, h->e) < 0) return h->e->status;
    return hdi_family_fill(&heat->fam, h->lane->vectors, hdi_lane_stride(&heat->fam), h->e);
}

static hd_status hdi_heat_by_iterations(hdi_heat_call *h) {
    int32_t n;
    for (h->batch = 0; h->batch < h->ask.k; h->batch += n) {
        n = hdi_heat_load_some(h);
        /* told here too: the calling thread may find all lanes taken */
        if (h->e->status >= 0 && hdi_progress(h->heat->ctx, "solve", HDI_CAST(double, h->batch) / h->ask.k, h->e) >= 0)
            hdi_parallel(h->heat->ctx, n, hdi_heat_task, h);
        if (hdi_heat_store_some(h, n) < 0) break;
    }
    return h->e->status;
}

/* ---- direct ---- */

/* Growth of built-in sets is at most 4.2, of shared ones 7.9, wherever L is positive semi-definite, and the pivots of a real
 * pole are positive. */
static hd_status hdi_direct_growth(hdi_heat_call *h) {
    const hdi_elim *m = &h->heat->elim;
    int32_t i;
    if (m->lone >= 0 && m->real.all.negative) return hdi_not_semidefinite(h->e);
    for (i = 0; 4 * i < m->set.n_poles - (m->lone + 1) && m->set.kind != HD_POLES_OWN; i++)
        if (m->pack[i].all.largest > 50 * m->pack[i].largest_entry) return hdi_not_semidefinite(h->e);
    return HD_OK;
}

/* The pole set and its factors. */
static hd_status hdi_direct_factors(hdi_heat_call *h) {
    hdi_elim *m = &h->heat->elim;
    hd_report *rep = h->rep;
    hd_rational set;
    int32_t i;
    if (hdi_heat_set(h, &set) < 0 || hdi_elim_poles(m, &set, h->t, h->e) < 0 || hdi_direct_growth(h) < 0) return h->e->status;
    hdi_report_set(rep, &set);
    for (i = 0; 4 * i < set.n_poles - (m->lone + 1); i++) {
        rep->factor_flops += 16 * m->sym.flops;
        rep->growth = hdi_max(rep->growth, m->pack[i].all.largest / m->pack[i].largest_entry);
    }
    if (m->lone >= 0) {
        rep->factor_flops += m->sym.flops;
        rep->growth = hdi_max(rep->growth, m->real.all.largest / m->real.largest_entry);
    }
    return HD_OK;
}

/* Items that are solved at the same time: `count` batches of `width` lanes, a task each. */
typedef struct hdi_batches {
    hdi_heat_call *h;
    int32_t width, count, n_here;
    uint64_t doubles;            /* of a batch's arrays */
} hdi_batches;

/* How many, and room for them: lanes, and the batches' arrays in the plan. No more batches than take the room of a pack. */
static hd_status hdi_batches_make(hdi_batches *b, hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    const uint64_t n = HDI_CAST(uint64_t, h->lap->n_active), most = 8 * HDI_CAST(uint64_t, heat->elim.sym.stored);
    uint64_t x, xr;
    b->h = h;
    b->n_here = 0;
    b->width = h->ask.k < HDI_LANES_BATCH ? h->ask.k : HDI_LANES_BATCH;
    b->doubles = hdi_batch_size(&heat->elim, b->width, &x, &xr);
    b->count = (h->ask.k + b->width - 1) / b->width;
    if (b->count > HDI_BATCHES) b->count = HDI_BATCHES;
    while (b->count > 1 && HDI_CAST(uint64_t, b->count) * (b->doubles + 7 * n * HDI_CAST(uint64_t, b->width)) > most) b->count--;
    if (hdi_heat_lanes(h, b->count * b->width) < 0) return h->e->status;
    if (heat->batch_doubles >= b->doubles * HDI_CAST(uint64_t, b->count)) return HD_OK;
    hdi_free(heat->ctx, heat->batch_room);
    heat->batch_doubles = 0;
    heat->batch_room = HDI_CAST(double *, hdi_alloc(heat->ctx, b->doubles * HDI_CAST(uint64_t, b->count), sizeof(double), h->e));
    if (heat->batch_room) heat->batch_doubles = b->doubles * HDI_CAST(uint64_t, b->count);
    return h->e->status;
}

/* The arrays of one batch. */
static hdi_batch hdi_batches_get(const hdi_batches *b, int64_t index) {
    const hdi_elim *m = &b->h->heat->elim;
    hdi_batch one;
    uint64_t x, xr;
    (void)hdi_batch_size(m, b->width, &x, &xr);
    one.x = b->h->heat->batch_room + b->doubles * HDI_CAST(size_t, index);
    one.xr = one.x + x;
    one.work = one.xr + xr;
    one.active = HDI_CAST(char *, HDI_CAST(void *, one.x + b->doubles)) - m->sym.n_super - 8;
    return one;
}

static void hdi_batches_task(void *arg, int64_t index, int32_t worker) {
    const hdi_batches *b = HDI_CAST(const hdi_batches *, arg);
    const hdi_heat_call *h = b->h;
    const hd_heat *heat = h->heat;
    const hdi_batch batch = hdi_batches_get(b, index);
    hdi_lane *lane = h->lane + index * b->width;
    const int32_t left = b->n_here - HDI_CAST(int32_t, index) * b->width, n = left < b->width ? left : b->width;
    int32_t r;
    (void)worker;
    hdi_batch_run(&heat->elim, &batch, lane, n, b->count > 1 ? NULL : heat->ctx);
    for (r = 0; r < n; r++) {
        if (lane[r].skip) continue;
        lane[r].status = hdi_elim_finish(&heat->elim, heat->limit, h->t * heat->drift, h->deflated, lane + r);
        if (lane[r].negative) lane[r].status = hdi_not_semidefinite(&lane[r].error);
    }
}

/* Above this t lambda_max columns, too, are solved without their constants: these are nearly all of the answer then, and
 * rounding of them would be most of the error. Below, their right-hand sides stay sparse. */
#define HDI_DEFLATE 3e5

/* Takes the constants out of a dense right-hand side, for the digits of the rest; they are put back exactly in the end. */
static void hdi_lane_deflate(hdi_lane *lane, const hd_laplacian *lap) {
    int32_t i;
    for (i = 0; i < lap->n_components; i++) lane->sums[i] = lap->conserves ? lane->target[i] / lap->component_mass[i] : 0;
    for (i = 0; i < lap->n_active && lap->conserves; i++) lane->rhs[i] -= lap->mass[i] * lane->sums[lap->component[i]];
}

static hd_status hdi_heat_by_direct(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    hdi_batches b;
    int32_t i;
    if (hdi_direct_factors(h) < 0 || (!h->diagonal && hdi_elim_bound(&heat->elim, h->e) < 0)) return h->e->status;
    if (hdi_batches_make(&b, h) < 0) return h->e->status;
    h->deflated = !h->watching && (h->ask.query == HDI_QUERY_FIELD || h->t * heat->lambda_max > HDI_DEFLATE);
    for (h->batch = 0; h->batch < h->ask.k; h->batch += b.n_here) {
        if (hdi_progress(heat->ctx, "solve", HDI_CAST(double, h->batch) / h->ask.k, h->e) < 0) return h->e->status;
        b.n_here = hdi_heat_load_some(h);
        for (i = 0; i < b.n_here && h->deflated; i++)
            if (!h->lane[i].skip) hdi_lane_deflate(h->lane + i, h->lap);
        if (h->e->status >= 0) hdi_parallel(heat->ctx, (b.n_here + b.width - 1) / b.width, hdi_batches_task, &b);
        if (hdi_heat_store_some(h, b.n_here) < 0) return h->e->status;
    }
    return h->e->status;
}

/* ---- krylov ---- */

/* A shift for times [from, to]; that of the factor at hand when it will do. Not so large that B drowns beside g L. */
static double hdi_krylov_shift(const hdi_elim *m, double from, double to, double lambda_max) {
    const double best = hdi_min(sqrt(from) * sqrt(to) / 10, lambda_max > 0 ? 1e12 / lambda_max : HUGE_VAL), have = m->real.ready ? m->shift : 0;
    return have > 0 && best <= 3 * have && have <= 3 * best && to / from < 10 ? have : best;
}

/* The end of window w of n_windows of equal ratio, from time q0 on; times ascend. */
static int32_t hdi_window_end(const double *times, int32_t n_times, int32_t q0, int32_t w, int32_t n_windows) {
    const double end = times[0] * pow(times[n_times - 1] / times[0], (w + 1.0) / n_windows);
    int32_t q1 = q0 + 1;
    while (q1 < n_times && (w + 1 >= n_windows || times[q1] <= end * (1 + 1e-13))) q1++;   /* 1e-13: rounding of pow */
    return q1;
}

/* How many windows cost least: every one needs a factor and a basis, whose length grows with the ratio of its times. */
static int32_t hdi_krylov_windows(const hdi_symbolic *s, double span) {
    const double factor = s->flops_done / HDI_RATE_REAL, step = 16 * HDI_CAST(double, s->nnz) / HDI_RATE_SWEEP + 1e-8 * s->n;
    double best = HUGE_VAL;
    int32_t w, least = 1;
    for (w = 1; w <= 16; w++) {
        const double ratio = pow(span, 1.0 / w), steps = 22 + 4 * log10(hdi_max(1, ratio)) + 0.35 * sqrt(ratio) + (ratio > 1e4 ? 1e9 : 0);
        const double cost = w * (factor + steps * step);
        if (cost < best) {
            best = cost;
            least = w;
        }
    }
    return least;
}

/* One basis for items batch to batch + n - 1 and the times [q0, q1). */
static hd_status hdi_krylov_window(hdi_heat_call *h, int32_t n, int32_t q0, int32_t q1) {
    hd_heat *heat = h->heat;
    hdi_silan *z = heat->silan;
    double fixed[HDI_SILAN_WIDE];
    hd_status status;
    int32_t i, q;
    int64_t c;
    if (hdi_elim_shift(&heat->elim, hdi_krylov_shift(&heat->elim, h->times[q0], h->times[q1 - 1], heat->lambda_max), h->e) < 0) return h->e->status;
    z->g = heat->elim.shift;
    z->k = n;
    if (hdi_silan_start(z, h->lane, heat->ctx, h->e) < 0) return h->e->status;
    for (i = 0; i < n; i++)
        for (fixed[i] = 0, c = 0; c < h->lap->n_components && h->lap->conserves && !h->lane[i].skip; c++)
            fixed[i] += h->lane[i].target[c] * h->lane[i].target[c] / h->lap->component_mass[c];
    status = hdi_silan_run(z, h->times + q0, q1 - q0, heat->opts.tol, fixed, heat->ctx, h->e);
    if (status < 0) return status;
    for (q = q0; q < q1; q++) {
        for (i = 0; i < n; i++) {
            hdi_lane *lane = h->lane + i;
            lane->status = status;
            if (!lane->skip && hdi_silan_answer(z, i, h->times[q], heat->drift, lane, h->e) < 0) return h->e->status;
            if (!lane->skip && (lane->off.solver > heat->opts.tol * lane->u_norm || lane->off.rounding > heat->limit * lane->u_norm))
                lane->status = HD_WARN_ACCURACY;
        }
        for (i = 0; i < n && q > q0; i++) h->lane[i].steps = 0;   /* counted once */
        h->now = h->time_column ? h->time_column[q] : h->now;
        if (hdi_heat_store_some(h, n) < 0) return h->e->status;
    }
    return HD_OK;
}

static hd_status hdi_heat_by_krylov(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    const double span = h->times[h->n_times - 1] / h->times[0];
    const int32_t wide = h->ask.k > 3 ? HDI_SILAN_WIDE : 1;
    const int32_t n_windows = h->n_times > 1 ? hdi_krylov_windows(&heat->elim.sym, span) : 1;
    int32_t n, q0, q1, w;
    if (heat->silan && heat->silan->wide != wide) hdi_silan_free(heat->silan, heat->ctx);
    if (!heat->silan) {
        heat->silan = HDI_CAST(hdi_silan *, hdi_alloc(heat->ctx, 1, sizeof *heat->silan, h->e));
        if (!heat->silan) return h->e->status;
        memset(heat->silan, 0, sizeof *heat->silan);
    }
    heat->silan->wide = wide;
    heat->silan->m = &heat->elim;
    if (hdi_heat_lanes(h, wide) < 0) return h->e->status;
    for (w = 0, q0 = 0; q0 < h->n_times; w++, q0 = q1) {
        q1 = hdi_window_end(h->times, h->n_times, q0, w, n_windows);
        for (h->batch = 0; h->batch < h->ask.k; h->batch += n) {
            n = hdi_heat_load_some(h);
            if (h->e->status < 0 || hdi_krylov_window(h, n, q0, q1) < 0) return h->e->status;
        }
    }
    h->rep->factor_flops = heat->elim.sym.flops;
    h->rep->growth = heat->elim.real.largest_entry > 0 ? heat->elim.real.all.largest / heat->elim.real.largest_entry : 0;
    return h->e->status;
}

/* ---- the run ---- */

/* Did a method that auto chose run into the byte limit? Then what was factorised goes, and iterations take its place. */
static int hdi_heat_retreat(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    int32_t i;
    if (heat->opts.method != HD_METHOD_AUTO || h->e->status != HD_ERR_MEMORY_LIMIT || !heat->elim.ctx) return 0;
    if (heat->no_factors && heat->no_factors_limit == heat->ctx->byte_limit) return 0;
    if (h->batch > 0 && h->ask.query == HDI_QUERY_FIELD) return 0;   /* fields may have been overwritten by their answers */
    for (i = 0; i < HDI_LANES; i++) hdi_lane_free(heat->lane + i, heat->ctx);
    if (heat->ground.diag) hdi_ground_free(&heat->ground, heat->ctx);
    hdi_elim_free(&heat->elim);
    if (heat->silan) hdi_silan_free(heat->silan, heat->ctx);
    hdi_free(heat->ctx, heat->silan);
    hdi_free(heat->ctx, heat->batch_room);
    heat->silan = NULL;
    heat->batch_room = NULL;
    heat->batch_doubles = 0;
    heat->no_factors = 1;
    heat->no_factors_limit = heat->ctx->byte_limit;
    hdi_error_clear(h->e);
    return 1;
}

/* Answers that need no solve: the field itself where t is nothing, the means where t is all. */
static hd_status hdi_heat_plain(hdi_heat_call *h) {
    const hd_laplacian *lap = h->lap;
    hdi_lane *lane = h->lane;
    int32_t i;
    if (hdi_lane_make(lane, lap, h->heat->ctx, h->e) < 0) return h->e->status;
    for (h->batch = 0; h->batch < h->ask.k; h->batch++) {
        if (hdi_heat_load(h, h->batch, lane) < 0) return h->e->status;
        if (!lane->skip) {
            for (i = 0; i < lap->n_active; i++) lane->u[i] = h->equal ? lane->target[lap->component[i]] / lap->component_mass[lap->component[i]] : lane->f[i];
            lane->u_norm = h->equal ? sqrt(hdi_max(0, hdi_b_norm2(lap, lane->u, lane->tmp))) : lane->f_norm;
            if (h->equal) hdi_lane_rounding(lane, hdi_conserve_off(lap, lane, 0, h->ask.query == HDI_QUERY_FIELD));
            else hdi_lane_rounding(lane, h->still * lane->f_norm);
            if (!h->equal && h->ask.query == HDI_QUERY_SYMMETRIC) hdi_lane_rounding(lane, 2 * DBL_EPSILON * lane->f_norm);
            if (!h->equal && lane->f_off > 0) {
                hdi_lane_rounding(lane, lane->f_off);
                lane->rounding = HD_EVIDENCE_ESTIMATED;
            }
        }
        if (hdi_heat_store_some(h, 1) < 0) return h->e->status;
    }
    return HD_OK;
}

/* One time by the method picked for it. */
static hd_status hdi_heat_answer(hdi_heat_call *h) {
    if (hdi_heat_engine(h) < 0) return h->e->status;
    if (h->t == 0 || h->equal) return hdi_heat_plain(h);
    if (h->method == HD_METHOD_DIRECT) return hdi_heat_by_direct(h);
    if (h->method == HD_METHOD_KRYLOV) return hdi_heat_by_krylov(h);
    return hdi_iterative_prepare(h) < 0 ? h->e->status : hdi_heat_by_iterations(h);
}

/* The time under way, and if factors do not fit the byte limit by iterations. */
static hd_status hdi_heat_single(hdi_heat_call *h) {
    if (hdi_heat_answer(h) < 0 && hdi_heat_retreat(h)) (void)hdi_heat_answer(h);
    if (h->e->status >= 0 && h->ask.list) hdi_ledger_close(h->ask.list->ledger + h->now, h->rep);
    return h->e->status;
}

static hd_status hdi_vertex_check(const hd_laplacian *lap, int32_t v, hd_error *e) {
    if (v >= 0 && v < lap->n) return HD_OK;
    return hdi_fail_face(e, HD_ERR_INDEX, "heat: a source or vertex is not in the mesh", -1, v, v);
}

/* Sources, or vertices of pairs: *which gets the index of one that is not in the mesh. */
static hd_status hdi_vertices_check(const hd_laplacian *lap, int64_t k, const int32_t *vertex, int64_t *which, hd_error *e) {
    int64_t q;
    for (q = 0; q < k && e->status >= 0; q++)
        if (hdi_vertex_check(lap, vertex[q], e) < 0) *which = q;
    return e->status;
}

static hd_status hdi_sources_check(hdi_heat_call *h, int32_t k, const int32_t *sources) {
    return hdi_vertices_check(h->heat->source, k, sources, &h->e->column, h->e);
}

/* Checks the times of a call and takes them up; with `positive` 0 is none. */
static hd_status hdi_times_check(hdi_heat_call *h, int32_t n_times, const double *t, int positive) {
    int32_t q;
    if (n_times < 1) return hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: there is no time");
    if (!t) return hdi_missing(h->e);
    for (q = 0; q < n_times; q++) {
        if (positive && !(hdi_finite(t[q]) && t[q] > 0))
            return hdi_fail_row(h->e, HD_ERR_ARGUMENT, "heat: t is not positive and finite", -1, q, t[q]);
        if (!hdi_finite(t[q]) || t[q] < 0)
            return hdi_fail_row(h->e, HD_ERR_ARGUMENT, "heat: t is negative or not finite", -1, q, t[q]);
    }
    h->ask.n_times = n_times;
    h->ask.t = t;
    h->t = hdi_heat_scaled(h->heat, t[0]);
    return HD_OK;
}

/* The start of a query of a kernel. */
static hd_status hdi_kernel_begin(hdi_heat_call *h, hd_heat *heat, hd_kernel kernel, hd_report *report, hd_error *err) {
    const hdi_query query = kernel == HD_KERNEL_SYMMETRIC ? HDI_QUERY_SYMMETRIC : HDI_QUERY_OPERATOR;
    if (hdi_heat_begin(h, heat, query, report, err) < 0) return h->e->status;
    if (kernel == HD_KERNEL_OPERATOR || kernel == HD_KERNEL_SYMMETRIC) return HD_OK;
    return hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: the kernel is operator or symmetric");
}

/* Sets a leading dimension's default and checks it. */
static size_t hdi_leading(hdi_heat_call *h, size_t ld) {
    const size_t n = HDI_CAST(size_t, h->heat->source->n);
    if (ld && ld < n) hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: a leading dimension is smaller than the number of vertices");
    return ld ? ld : n;
}

/* Queries that have but one way. */
static hd_status hdi_direct_only(hdi_heat_call *h) {
    const hd_method asked = h->heat->opts.method;
    if (asked == HD_METHOD_ITERATIVE || asked == HD_METHOD_KRYLOV)
        return hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: diagonals and distances to all vertices need the direct method");
    return HD_OK;
}

/* The worse of two reports, counts added. */
static void hdi_report_merge(hd_report *all, const hd_report *one) {
    hd_report sum = *one;
    int32_t p;
    sum.status = all->status > sum.status ? all->status : sum.status;
    sum.iterations += all->iterations;
    for (p = 0; p < HD_MAX_POLES; p++) sum.pole_iterations[p] += all->pole_iterations[p];
    sum.degree = all->degree > sum.degree ? all->degree : sum.degree;
    sum.n_poles = all->n_poles > sum.n_poles ? all->n_poles : sum.n_poles;
    sum.growth = hdi_max(all->growth, sum.growth);
    sum.residual = hdi_max(all->residual, sum.residual);
    sum.error_rational = hdi_max(all->error_rational, sum.error_rational);
    sum.error_solver = hdi_max(all->error_solver, sum.error_solver);
    sum.error_rounding = hdi_max(all->error_rounding, sum.error_rounding);
    hdi_evidence_worst(&sum.evidence_rational, all->evidence_rational);
    hdi_evidence_worst(&sum.evidence_solver, all->evidence_solver);
    hdi_evidence_worst(&sum.evidence_rounding, all->evidence_rounding);
    hdi_evidence_worst(&sum.evidence_b, all->evidence_b);
    sum.error_bound_b = hdi_max(all->error_bound_b, sum.error_bound_b);
    sum.error_bound = hdi_max(all->error_bound, sum.error_bound);
    sum.mass_drift = hdi_max(all->mass_drift, sum.mass_drift);
    sum.error_relative = hdi_max(all->error_relative, sum.error_relative);
    sum.smallest = all->smallest > 0 && (sum.smallest == 0 || all->smallest < sum.smallest) ? all->smallest : sum.smallest;
    sum.n_lost += all->n_lost;
    *all = sum;
}

/* The n_times times of a call, ascending and scaled, times factor, and which each is. h->t becomes the last. */
static hd_status hdi_heat_sort_times(hdi_heat_call *h, double factor) {
    const int32_t n = h->ask.n_times;
    hdi_pair *order = HDI_TAKE(&h->s, hdi_pair, n);
    double *sorted = HDI_TAKE(&h->s, double, n);
    int32_t *column = HDI_TAKE(&h->s, int32_t, n), q;
    if (h->e->status < 0) return h->e->status;
    for (q = 0; q < n; q++) {                    /* bits of doubles that are not negative are in their order */
        const double v = h->ask.t[q] + 0.0;
        memcpy(&order[q].key, &v, sizeof v);
        order[q].id = q;
    }
    hdi_sort_pairs(order, n);
    for (q = 0; q < n; q++) {
        column[q] = HDI_CAST(int32_t, order[q].id);
        sorted[q] = hdi_min(factor * hdi_heat_scaled(h->heat, h->ask.t[column[q]]), 1e300);
    }
    h->times = sorted;
    h->n_times = n;
    h->time_column = column;
    h->t = sorted[n - 1];
    return HD_OK;
}

/* The times one by one. */
static hd_status hdi_heat_each_time(hdi_heat_call *h) {
    hd_report one;
    int32_t q;
    for (q = 0; q < h->ask.n_times; q++) {
        hdi_heat_call c = *h;
        memset(&one, 0, sizeof one);
        hdi_error_clear(&one.error);
        memset(&c.s, 0, sizeof c.s);
        c.rep = &one;
        c.e = &one.error;
        c.err = NULL;
        c.now = q;
        c.t = hdi_heat_scaled(h->heat, h->ask.t[q]);
        c.times = &c.t;
        c.n_times = 1;
        c.time_column = NULL;
        (void)hdi_heat_single(&c);
        (void)hdi_heat_end(&c);
        if (one.status < 0) {
            *h->rep = one;
            h->e->column = q;
            return one.status;
        }
        if (q == 0) *h->rep = one;
        else hdi_report_merge(h->rep, &one);
    }
    return h->rep->status;
}

/* Many times by one krylov basis or few, where that is the method. 0: it is not. */
static int hdi_heat_together(hdi_heat_call *h) {
    hd_heat *heat = h->heat;
    int32_t q;
    if (hdi_heat_sort_times(h, 1) < 0) return 1;
    if (h->times[0] * heat->lambda_max < HDI_STILL || hdi_heat_engine(h) < 0 || h->method != HD_METHOD_KRYLOV) return h->e->status < 0 && !hdi_heat_retreat(h);
    if (hdi_heat_equal(heat, h->t, h->e) || h->e->status < 0) return h->e->status < 0;
    if (hdi_heat_by_krylov(h) < 0) return !hdi_heat_retreat(h);
    for (q = 0; q < h->ask.n_times && h->ask.list; q++) hdi_ledger_close(h->ask.list->ledger + q, h->rep);
    return 1;
}

/* Runs a request whose arguments are checked. */
static hd_status hdi_heat_run(hdi_heat_call *h) {
    if (h->e->status < 0 || h->ask.k == 0) return hdi_heat_end(h);
    if (h->ask.n_times == 1) (void)hdi_heat_single(h);
    else if (!hdi_heat_together(h)) (void)hdi_heat_each_time(h);
    return hdi_heat_end(h);
}

/* Entries (i[q], j[q]) sorted by column, and a ledger for each time; the request of h becomes that. list: what it points to. */
static hd_status hdi_entry_list_make(hdi_heat_call *h, hdi_entry_list *list, int64_t n, const int32_t *i, const int32_t *j) {
    int64_t q;
    list->n = n;
    list->rows = i;
    list->order = HDI_TAKE(&h->s, hdi_pair, n);
    list->begin = HDI_TAKE(&h->s, int64_t, n + 1);
    list->ledger = HDI_TAKE(&h->s, hdi_ledger, h->ask.n_times);
    if (h->e->status < 0) return h->e->status;
    for (q = 0; q < n; q++) {
        list->order[q].key = HDI_CAST(uint64_t, j[q]);
        list->order[q].id = q;
    }
    hdi_sort_pairs(list->order, n);
    for (q = 0; q < n; q++)                      /* at most as many distinct columns as vertices */
        if (q == 0 || list->order[q].key != list->order[q - 1].key) list->begin[h->ask.k++] = q;
    list->begin[h->ask.k] = n;
    for (q = 0; q < h->ask.n_times; q++)
        list->ledger[q] = hdi_ledger_begin(HD_EVIDENCE_NONE, HD_EVIDENCE_NONE, HD_EVIDENCE_NONE, 0);
    h->ask.list = list;
    return HD_OK;
}

/* ==== [26] kernel ====
 * Owns entries of the kernel that come by selected inversion: diagonals, edges, and how rounding of them is measured.
 * May call [25]. */

/* ---- diagonals ---- */

/* What the report says of selected inversion. */
static void hdi_inverse_tell(hdi_heat_call *h) {
    h->method = h->rep->method = HD_METHOD_DIRECT;
    h->diagonal = 1;
    h->rep->reason = "selected inversion of the factors of the poles";
    h->rep->ordering = h->heat->elim.sym.ordering;
    h->rep->factor_nnz = h->heat->elim.sym.nnz;
}


/* Columns within another call: k of them at the (scaled) time t through the factors that the plan holds or makes. */
typedef struct hdi_columns {
    double t;
    hd_kernel kernel;
    const hd_rational *set;
    int32_t k, equal, watching;
    const int32_t *sources;
    double *U;                   /* NULL: only the lanes' accounts are wanted */
    size_t ldu;
    double *off_b, *off_m;       /* [k] */
} hdi_columns;

static hd_status hdi_direct_columns(hd_heat *heat, const hdi_columns *c, hd_report *rep) {
    hdi_heat_call h;
    if (hdi_kernel_begin(&h, heat, c->kernel, rep, NULL) < 0) return hdi_heat_end(&h);
    h.t = c->t;
    h.ask.k = c->k;
    h.method = HD_METHOD_DIRECT;
    h.diagonal = 1;
    h.ask.sources = c->sources;
    h.set = c->set;
    h.ask.U = c->U;
    h.ask.ldu = c->ldu;
    h.equal = c->equal;
    h.watching = c->watching;
    h.off_b = c->off_b;
    h.off_m = c->off_m;
    if (hdi_heat_analysed(heat, h.e) >= 0) {
        h.lap = heat->elim.lap;
        if (h.equal) (void)hdi_heat_plain(&h);
        else (void)hdi_heat_by_direct(&h);
    }
    return hdi_heat_end(&h);
}

/* ---- rounding of inversions ---- */
/* What rounding does to entries found by inversion no theorem says well. It is measured at a few rows where it is largest: a
 * solve with the same poles, whose own error its residual bounds, is held against the entry. */
enum { HDI_PROBES = 3 };
#define HDI_PROBE_SAFETY 4   /* differences seen at the probes stand for those of all rows */
#define HDI_PROBE_OWN 100    /* and more so for functions of the caller's, whose poles may lie beside the spectrum */

/* Can rounding be told from the values alone? k_t(i,i) is at least what the constants are of it, most (of row i) times value:
 * returns the relative error that a smaller value shows. For sets that approximate exp. */
static double hdi_below_constants(const hd_laplacian *lap, const hd_rational *set, int32_t i, double value, double times) {
    const double least = times * (lap->conserves && set->kind != HD_POLES_OWN ? 1 / lap->component_mass[lap->component[i]] : 0);
    return value < 0.999 * least ? hdi_quotient(least - value, fabs(value)) : 0;
}

/* A pole beside the spectrum makes its matrix nearly singular, in a direction that the probed rows may miss. What rounding
 * of its entries, (|theta| + t lambda) eps, then does to the inverse in the B norm: estimated by first-order perturbation.
 * Poles further than 1 from the spectrum are left to the probes. */
static double hdi_own_near(const hd_heat *heat, const hd_rational *set, double t) {
    double sum = 0;
    int32_t p;
    for (p = 0; p < set->n_poles && set->kind == HD_POLES_OWN; p++) {
        const double d = hdi_pole_distance(set->theta[p]);
        const double size = hdi_rat_count(set, p) * hdi_cabs(set->a[p]) * (hdi_cabs(set->theta[p]) + t * heat->lambda_max);
        if (d < 1) sum += DBL_EPSILON * hdi_quotient(hdi_quotient(size, d), d);
    }
    return sum;
}

/* The largest entry of diag(B^-1), or a bound of it: a matrix whose B norm is x has entries of at most this times x. */
static double hdi_largest_spread(const hd_laplacian *lap) {
    double most = 0;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) most = hdi_max(most, 1 / lap->b_diag[i]);
    return hdi_quotient(most, lap->b_ratio);
}

typedef struct hdi_probe { int32_t k, row[HDI_PROBES]; } hdi_probe;

/* Rows to look at: where t L_ii/b_ii and where t L_ii k_ii is largest, and `also` (-1: none). k may be NULL. */
static hdi_probe hdi_probe_rows(const hd_laplacian *lap, const double *k, int32_t also) {
    hdi_probe x;
    double most[2] = {-1, -1};
    int32_t i, q, at[HDI_PROBES] = {-1, -1, -1};
    int64_t p;
    for (i = 0; i < lap->n_active; i++) {
        double l = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.col[p] == i) l = lap->L.val[p];
        if (l / lap->b_diag[i] > most[0]) {
            most[0] = l / lap->b_diag[i];
            at[0] = i;
        }
        if (k && l * k[i] > most[1]) {
            most[1] = l * k[i];
            at[1] = i;
        }
    }
    at[2] = also;
    for (x.k = 0, i = 0; i < HDI_PROBES; i++) {
        for (q = 0; q < x.k && x.row[q] != at[i]; q++) {}
        if (at[i] >= 0 && q == x.k) x.row[x.k++] = at[i];
    }
    return x;
}

/* Their columns by the poles of set at the call's time; what is found stays in the plan's lanes. */
static hd_status hdi_probe_run(hdi_heat_call *h, hdi_probe *x, hd_kernel kernel, const hd_rational *set) {
    hd_heat *heat = h->heat;
    const hd_rational own = *set;                /* it may be the plan's, which the call sets anew */
    int32_t vertex[HDI_PROBES], i;
    hdi_columns c;
    hd_report rep;
    for (i = 0; i < x->k; i++) vertex[i] = heat->elim.lap->vertex[x->row[i]];
    memset(&c, 0, sizeof c);
    c.t = h->t;
    c.kernel = kernel;
    c.set = &own;
    c.k = x->k;
    c.sources = vertex;
    c.watching = 1;
    if (x->k > 0 && hdi_direct_columns(heat, &c, &rep) < 0) *h->e = rep.error;
    else if (x->k > 0) h->rep->residual = hdi_max(h->rep->residual, rep.residual);
    return h->e->status;
}

/* Probe q's own entry by the weights of `set`, a set in terms of a time that is tau times that of the factors, and a bound of
 * its error. g: of diag((B + tL)^-1) there. f: what a0 multiplies. */
static double hdi_probe_value(const hd_heat *heat, const hdi_probe *x, int32_t q, const hd_rational *set, double tau, double f, double g, double *off) {
    const hdi_elim *m = &heat->elim;
    const hd_laplacian *lap = m->lap;
    const hdi_lane *lane = heat->lane + q;
    const double b = lap->b_diag[x->row[q]];
    double value = set->a0 * f, by_b = 0, by_m = 0;
    int32_t p;
    for (p = 0; p < set->n_poles; p++) {
        const double count = hdi_rat_count(set, p), weight = count * hdi_cabs(set->a[p]) * hdi_ratio_root(lap) * lane->pole_off[p];
        value -= count / tau * hdi_cmul(set->a[p], lane->pole_value[p]).re;
        by_m += weight * hdi_pole_reach(set->theta[p]);
        by_b += weight / hdi_pole_distance(set->theta[p]);
    }
    *off = hdi_min(g > 0 && hdi_finite(g) ? sqrt(g) * by_m : HUGE_VAL, by_b * hdi_ratio_root(lap) / sqrt(b)) + 4 * DBL_EPSILON * fabs(value);
    return value;
}

/* Entries of k_t for one time, in elimination order and in the unit of the scaled pair. */
typedef struct hdi_entries {
    double *k, *g;               /* [n] or by the analysis' entries; g: diag((B + tL)^-1) or a bound of it, both in turn */
    int64_t size;
    double weighted, uniform;    /* of the set: |error| <= weighted g, uniform diag(B^-1) */
    double left_out;             /* besides, times diag(B^-1): a0 of a set where B is full */
    hd_rational resolvent;       /* the poles with weights for g */
} hdi_entries;

/* Factors for h->t, and from them k and g. room [2 size]. */
static hd_status hdi_entries_make(hdi_heat_call *h, hdi_wanted wanted, double *room, int64_t size, hdi_entries *x) {
    hdi_elim *m = &h->heat->elim;
    hd_c64 weight[2 * HD_MAX_POLES];
    double factor = 1, slack = 0;
    int32_t p, best, i;
    memset(room, 0, HDI_CAST(size_t, 2 * size) * sizeof *room);
    memset(weight, 0, sizeof weight);
    if (hdi_direct_factors(h) < 0) return h->e->status;
    for (p = 0; p < m->set.n_poles; p++) weight[p] = hdi_cscale(-hdi_rat_count(&m->set, p), m->set.a[p]);
    best = 0;
    if (!hdi_resolvent_weights(&m->set, weight + m->set.n_poles, &slack)) {
        slack = 0;
        best = hdi_resolvent_pole(&m->set, &factor);
        for (p = 0; p < m->set.n_poles; p++) weight[m->set.n_poles + p] = hdi_c(p == best ? factor : 0, 0);
    }
    if (hdi_progress(h->heat->ctx, "invert", 0, h->e) < 0 || hdi_elim_invert(m, 2, weight, wanted, room, size, h->e) < 0) return h->e->status;
    x->resolvent = m->set;
    x->resolvent.kind = HD_POLES_OWN;
    x->resolvent.a0 = x->resolvent.max_error = x->resolvent.max_weighted_error = 0;
    for (p = 0; p < m->set.n_poles; p++) x->resolvent.a[p] = hdi_cscale(-1 / hdi_rat_count(&m->set, p), weight[m->set.n_poles + p]);
    x->k = room;
    x->g = room + size;
    x->size = size;
    x->weighted = best >= 0 ? (1 + slack) * hdi_set_weighted(&m->set) : HUGE_VAL;
    x->uniform = hdi_set_uniform(&m->set);       /* 0: bounds hold for c itself */
    if (x->uniform == 0) x->weighted = 0;
    x->left_out = 0;
    for (i = 0; i < m->sym.n && wanted != HDI_WANT_ENTRIES; i++)
        x->g[i] = hdi_max(x->g[i], hdi_constant_part(m->lap, i) * (wanted == HDI_WANT_FORMS ? m->lap->mass[i] * m->lap->mass[i] : 1));
    return HD_OK;
}

/* Bound of the rational error of k_t(i,i), from g(i,i) and diag(B)(i). */
static double hdi_entry_error(const hdi_entries *x, double g, double b, double b_ratio) {
    const double spread = b_ratio > 0 ? 1 / (b_ratio * b) : HUGE_VAL, out = x->left_out > 0 ? x->left_out * spread : 0;
    const double uniform = x->uniform > 0 ? x->uniform * spread : 0;
    return (hdi_finite(x->weighted) ? hdi_min(x->weighted * hdi_max(0, g), uniform) : uniform) + out;
}

/* Place of each of the analysis' entries: row and column in elimination order. */
static void hdi_entry_place(const hdi_symbolic *s, int32_t v, int64_t n, int32_t *i, int32_t *j) {
    const int32_t begin = s->super[v], end = s->super[v + 1];
    *j = begin + s->a_col[n];
    *i = s->a_row[n] < end - begin ? begin + s->a_row[n] : s->row[s->row_ptr[v] + s->a_row[n] - (end - begin)];
}

/* diag(k_t B), a0 included, for a full B: from the entries of k_t on the pattern of B. */
static void hdi_operator_diagonal(const hdi_elim *m, const double *k, double *diag) {
    const hdi_symbolic *s = &m->sym;
    int32_t v, i, j;
    int64_t n;
    for (i = 0; i < s->n; i++) diag[i] = m->set.a0;
    for (v = 0; v < s->n_super; v++) {
        for (n = s->a_ptr[v]; n < s->a_ptr[v + 1]; n++) {
            const double kb = k[n] * m->source->B[s->a_from[n]] * m->scale;
            hdi_entry_place(s, v, n, &i, &j);
            diag[i] += kb;
            if (i != j) diag[j] += kb;
        }
    }
}

/* Bound of a diagonal's error relative to the value itself above which the highest degree takes over: on all meshes tried errors are below 1e-7 then. With
 * B = I errors come closer to their bound. */
static double hdi_diagonal_limit(const hd_heat *heat) {
    const hd_laplacian_kind kind = heat->source->kind;
    return kind == HD_LAPLACIAN_COT || kind == HD_LAPLACIAN_EXP ? 4.2e-7 : 5.3e-7;
}

/* The ledger of values found by inversion. */
static hdi_ledger hdi_inverse_ledger(const hdi_heat_call *h, int relative) {
    const hd_rational *set = &h->heat->elim.set;
    const int itself = set->kind == HD_POLES_OWN && hdi_set_uniform(set) == 0 && (set->a0 == 0 || !h->heat->source->B);
    return hdi_ledger_begin(h->equal || itself ? HD_EVIDENCE_NONE : HD_EVIDENCE_PROVEN, HD_EVIDENCE_NONE, HD_EVIDENCE_MEASURED, relative);
}

/* Values by rows to vertices; their errors, off and rounding relative to size, to the report, in the caller's unit. Returns the largest off relative to its value. */
static double hdi_diagonal_tell(hdi_heat_call *h, hd_kernel kernel, const double *value, const double *off, const double *size, double rounding, double *out) {
    const hd_laplacian *lap = h->lap;
    const double unit = kernel == HD_KERNEL_SYMMETRIC ? h->heat->scale : 1;
    hdi_ledger ledger = hdi_inverse_ledger(h, 1);
    double most = 0;
    int32_t i, v;
    h->relative = 1;
    for (v = 0; v < lap->n; v++) out[v] = kernel == HD_KERNEL_OPERATOR && lap->row[v] < 0;
    for (i = 0; i < lap->n_active; i++) {
        hdi_parts part;
        memset(&part, 0, sizeof part);
        part.rational = unit * off[i];
        part.rounding = 4 * DBL_EPSILON * unit * fabs(value[i]) + (rounding > 0 ? unit * rounding * fabs(size[i]) : 0);
        out[lap->vertex[i]] = unit * value[i];
        hdi_ledger_note(&ledger, unit * value[i], part);
        most = hdi_max(most, hdi_quotient(off[i], fabs(value[i])));
    }
    hdi_ledger_close(&ledger, h->rep);
    return most;
}

/* Where t is so large that k_t(i,i) = 1/mass of the component. */
static void hdi_diagonal_equal(hdi_heat_call *h, hd_kernel kernel, double *value, double *off, double *out) {
    const hd_laplacian *lap = h->lap;
    int32_t i;
    for (i = 0; i < lap->n_active; i++) {
        value[i] = (kernel == HD_KERNEL_OPERATOR ? lap->mass[i] : 1) / lap->component_mass[lap->component[i]];
        off[i] = 0;
    }
    (void)hdi_diagonal_tell(h, kernel, value, off, value, HDI_CAST(double, lap->n_active) * DBL_EPSILON, out);
}

/* The kernel's diagonal at one time with the set for it, on vertices; bounds into the report. *relative: the largest of the
 * rational error relative to the value. */
static hd_status hdi_diagonal_once(hdi_heat_call *h, hd_kernel kernel, double *out, double *relative) {
    hd_heat *heat = h->heat;
    const hd_laplacian *lap;
    const hdi_symbolic *s;
    const int full = kernel == HD_KERNEL_OPERATOR && heat->source->B;
    hdi_scope scope = hdi_scope_begin(heat->ctx, h->e);
    double *room, *value, *off, *g, *own, rounding = 0;
    const double *size_of;
    hdi_entries x;
    hdi_probe probe;
    int64_t size, n;
    int32_t i, v, worst = 0;
    *relative = 0;
    if (hdi_heat_analysed(heat, h->e) < 0) return hdi_scope_end(&scope);
    h->lap = lap = heat->elim.lap;
    h->equal = hdi_heat_equal(heat, h->t, h->e);
    s = &heat->elim.sym;
    size = full ? s->a_ptr[s->n_super] : s->n;
    room = HDI_TAKE(&scope, double, 2 * size);
    value = HDI_TAKE(&scope, double, 4 * HDI_CAST(uint64_t, s->n));
    if (h->e->status < 0) return hdi_scope_end(&scope);
    off = value + s->n;
    g = off + s->n;
    own = g + s->n;
    if (h->equal) {
        hdi_diagonal_equal(h, kernel, value, off, out);
        return hdi_scope_end(&scope);
    }
    if (hdi_entries_make(h, full ? HDI_WANT_ENTRIES : HDI_WANT_DIAGONAL, room, size, &x) < 0) return hdi_scope_end(&scope);
    if (full) {
        hdi_operator_diagonal(&heat->elim, x.k, value);
        for (v = 0; v < s->n_super; v++)
            for (n = s->a_ptr[v]; n < s->a_ptr[v + 1]; n++)
                if (s->a_row[n] == s->a_col[n]) g[s->super[v] + s->a_col[n]] = hdi_max(x.g[n], hdi_constant_part(lap, s->super[v] + s->a_col[n]));
        for (i = 0; i < s->n; i++) off[i] = hdi_min(x.weighted == 0 ? 0 : hdi_finite(x.weighted) ? x.weighted * sqrt(hdi_max(0, g[i]) * lap->b_diag[i]) : HUGE_VAL,
                                                    x.uniform * hdi_ratio_root(lap));
    } else {
        const double a0 = heat->elim.set.a0;
        if (lap->B) x.left_out = fabs(a0);       /* a full B's inverse is not at hand, and a0 is of the size of the set's error */
        for (i = 0; i < s->n; i++) {
            const double b = kernel == HD_KERNEL_OPERATOR ? lap->mass[i] : 1;
            g[i] = x.g[i];
            value[i] = b * (x.k[i] + (lap->B ? 0 : a0 / lap->mass[i]));
            off[i] = b * hdi_entry_error(&x, x.g[i], lap->b_diag[i], lap->b_ratio);
        }
    }
    /* Rounding is relative to the value; of any function of the caller's, which may vanish, to the resolvent. */
    size_of = value;
    if (heat->elim.set.kind == HD_POLES_OWN) {
        for (i = 0; i < s->n; i++) {
            const double most = lap->b_ratio > 0 ? 1 / (lap->b_ratio * lap->b_diag[i]) : HUGE_VAL;
            own[i] = (g[i] > 0 && g[i] < most ? g[i] : most) * (kernel == HD_KERNEL_OPERATOR ? lap->b_diag[i] : 1);
        }
        size_of = own;
    }
    for (i = 1; i < s->n; i++)
        if (off[i] * value[worst] > off[worst] * value[i]) worst = i;
    probe = hdi_probe_rows(lap, value, s->n > 0 ? worst : -1);
    if (hdi_probe_run(h, &probe, kernel, &heat->elim.set) < 0) return hdi_scope_end(&scope);
    for (i = 0; i < probe.k; i++) {
        const int32_t row = probe.row[i];
        const double f = kernel == HD_KERNEL_OPERATOR ? 1 : lap->B ? 0 : 1 / lap->mass[row];
        double by, there = hdi_probe_value(heat, &probe, i, &heat->elim.set, 1, f, g[row], &by);
        rounding = hdi_max(rounding, hdi_quotient(HDI_PROBE_SAFETY * fabs(there - value[row]) + by, fabs(size_of[row])));
    }
    for (i = 0; i < s->n; i++) rounding = hdi_max(rounding, hdi_below_constants(lap, &heat->elim.set, i, value[i], kernel == HD_KERNEL_OPERATOR ? lap->mass[i] : 1));
    if (size_of == own) {
        const double near = hdi_own_near(heat, &heat->elim.set, h->t);
        double most = 0;
        for (i = 0; i < s->n && near > 0; i++) {
            const double b = lap->b_diag[i], spread = (kernel == HD_KERNEL_OPERATOR ? 1 : 1 / b) / lap->b_ratio;
            most = hdi_max(most, hdi_quotient(spread, own[i]));
        }
        rounding = HDI_PROBE_OWN * rounding + near * most;
    }
    *relative = hdi_diagonal_tell(h, kernel, value, off, size_of, rounding, out);
    return hdi_scope_end(&scope);
}

/* The analysis' entries on the pattern of the source's L: one of each pair (i,j), (j,i) is there, the other is the same. */
static void hdi_entries_spread(const hdi_elim *m, const double *k, double unit, double *val) {
    const hdi_symbolic *s = &m->sym;
    const hd_csr *a = &m->source->L;
    int32_t v, i, j;
    int64_t n;
    for (v = 0; v < s->n_super; v++) {
        for (n = s->a_ptr[v]; n < s->a_ptr[v + 1]; n++) {
            const int64_t p = s->a_from[n];
            int64_t other;
            hdi_entry_place(s, v, n, &i, &j);
            val[p] = unit * k[n];
            if (i == j) continue;
            i = s->perm[i];                      /* a_from is entry (j,i): rows of A are walked from column j */
            j = s->perm[j];
            other = a->row_ptr[i] + hdi_lower_bound(a->col + a->row_ptr[i], a->row_ptr[i + 1] - a->row_ptr[i], j);
            val[other] = unit * k[n];
        }
    }
}

/* Adds a0 B^-1 where B is diagonal, and notes the rational error: that of an entry (i,j) is at most the larger of those of (i,i)
 * and (j,j). k and g [n]: their diagonals. */
static void hdi_edges_judge(const hdi_elim *m, hdi_entries *x, double *k, double *g, hdi_ledger *ledger) {
    const hdi_symbolic *s = &m->sym;
    const hd_laplacian *lap = m->lap;
    hdi_parts part;
    int32_t v, i;
    int64_t n;
    memset(&part, 0, sizeof part);
    if (lap->B) x->left_out = fabs(m->set.a0);
    for (v = 0; v < s->n_super; v++) {
        for (n = s->a_ptr[v]; n < s->a_ptr[v + 1]; n++) {
            if (s->a_row[n] != s->a_col[n]) continue;
            i = s->super[v] + s->a_col[n];
            if (!lap->B) x->k[n] += m->set.a0 / lap->mass[i];
            k[i] = x->k[n];
            g[i] = x->g[n];
            part.rational = m->scale * hdi_entry_error(x, g[i], lap->b_diag[i], lap->b_ratio);
            part.rounding = 4 * DBL_EPSILON * m->scale * fabs(k[i]);
            hdi_ledger_note(ledger, m->scale * k[i], part);
        }
    }
}

/* Rounding of a row: the probe's own entry, and what its column differs by from the entries of the row. */
static hdi_parts hdi_edges_rounding(const hd_heat *heat, const hdi_probe *probe, int32_t q, const double *k, const double *g, const double *values) {
    const hd_laplacian *lap = heat->source, *in = heat->elim.lap;
    const int32_t at = probe->row[q], row = lap->row[in->vertex[at]];
    double by, there = hdi_probe_value(heat, probe, q, &heat->elim.set, 1, lap->B ? 0 : 1 / in->mass[at], g[at], &by), most;
    /* columns of uniform sets carry the constants exactly, which the entries do not; a full B's entries are without a0 B^-1 */
    const int comparable = heat->elim.set.a0 == 0 || (heat->elim.set.kind == HD_POLES_OWN && !lap->B);
    hdi_parts part;
    int64_t p;
    most = heat->scale * (HDI_PROBE_SAFETY * fabs(there - k[at]) + by);
    for (p = lap->L.row_ptr[row]; p < lap->L.row_ptr[row + 1] && comparable; p++) {
        const int32_t j = in->row[lap->vertex[lap->L.col[p]]];
        const double off = hdi_max(1, g[at] > 0 ? sqrt(hdi_max(0, g[j]) / g[at]) : 1) * by;
        most = hdi_max(most, fabs(heat->scale * heat->lane[q].u[j] - values[p]) + heat->scale * off);
    }
    memset(&part, 0, sizeof part);
    part.rounding = heat->elim.set.kind == HD_POLES_OWN ? HDI_PROBE_OWN * most : most;
    part.rounding += 4 * DBL_EPSILON * heat->scale * fabs(k[at]);
    return part;
}

/* Where t is so large that k_t is 1/mass of the component. */
static void hdi_edges_equal(hdi_heat_call *h, double *values) {
    const hd_laplacian *lap = h->heat->source;
    hdi_ledger ledger = hdi_inverse_ledger(h, 0);
    hdi_parts part;
    int32_t i;
    int64_t p;
    memset(&part, 0, sizeof part);
    for (i = 0; i < lap->n_active; i++) {
        const double k = 1 / lap->component_mass[lap->component[i]];
        part.rounding = HDI_CAST(double, lap->n_active) * DBL_EPSILON * k;
        hdi_ledger_note(&ledger, k, part);
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) values[p] = k;
    }
    hdi_ledger_close(&ledger, h->rep);
}

/* With the set's degree, into values. */
static hd_status hdi_edges_once(hdi_heat_call *h, double *values, double *rational) {
    hd_heat *heat = h->heat;
    hdi_scope scope = hdi_scope_begin(heat->ctx, h->e);
    const hdi_symbolic *s = &heat->elim.sym;
    const int64_t size = s->a_ptr[s->n_super];
    double *room = HDI_TAKE(&scope, double, 2 * HDI_CAST(uint64_t, size)), *k = HDI_TAKE(&scope, double, 2 * HDI_CAST(uint64_t, s->n));
    hdi_entries x;
    int32_t i;
    *rational = 0;
    h->lap = heat->elim.lap;
    h->equal = h->e->status >= 0 && hdi_heat_equal(heat, h->t, h->e);
    if (h->equal) hdi_edges_equal(h, values);
    else if (h->e->status >= 0 && hdi_entries_make(h, HDI_WANT_ENTRIES, room, size, &x) >= 0) {
        hdi_ledger ledger = hdi_inverse_ledger(h, 0);
        hdi_probe probe;
        int32_t top = 0;
        hdi_edges_judge(&heat->elim, &x, k, k + s->n, &ledger);
        *rational = hdi_quotient(ledger.off.rational, ledger.largest);
        hdi_entries_spread(&heat->elim, x.k, heat->scale, values);
        for (i = 1; i < s->n; i++)
            if (k[i] > k[top]) top = i;
        probe = hdi_probe_rows(h->lap, k, s->n > 0 ? top : -1);
        if (hdi_probe_run(h, &probe, HD_KERNEL_SYMMETRIC, &heat->elim.set) >= 0)
            for (i = 0; i < probe.k; i++) {
                hdi_parts part = hdi_edges_rounding(heat, &probe, i, k, k + s->n, values);
                part.rounding += heat->scale * hdi_own_near(heat, &heat->elim.set, h->t) * hdi_largest_spread(h->lap);
                hdi_ledger_note(&ledger, heat->scale * k[probe.row[i]], part);
            }
        hdi_ledger_close(&ledger, h->rep);
    }
    return hdi_scope_end(&scope);
}

/* The diagonal of the kernel on vertices, or with `edges` k_t on the pattern of L, with the set's degree by default. Where the bound shows vertices (of tiny cells
 * among large ones, slivers) whose error relative to their own value may be above the promise, of edges that relative to the largest value, a second time with the
 * highest degree. The error seen is a fifth of the bound or so on all meshes tried: 1e-7. */
static hd_status hdi_entries_sure(hdi_heat_call *h, hd_kernel kernel, int edges, double *out) {
    const hd_report before = *h->rep;
    const hd_heat *heat = h->heat;
    const double loose = kernel == HD_KERNEL_OPERATOR && heat->source->B ? 50 : 1;   /* the bound, of the operator's diagonal */
    double rational;
    hd_status st;
    if ((edges ? hdi_edges_once(h, out, &rational) : hdi_diagonal_once(h, kernel, out, &rational)) < 0) return h->e->status;
    if (heat->poles_asked || heat->exacting || h->degree) return HD_OK;
    if (rational <= loose * hdi_diagonal_limit(heat)) return HD_OK;
    *h->rep = before;
    h->degree = HDI_RAT_KERNEL_MAX;
    st = edges ? hdi_edges_once(h, out, &rational) : hdi_diagonal_once(h, kernel, out, &rational);
    h->degree = 0;
    if (st != HD_ERR_MEMORY_LIMIT) return st;
    *h->rep = before;                            /* no room for twice the factors: the first answer it is */
    return edges ? hdi_edges_once(h, out, &rational) : hdi_diagonal_once(h, kernel, out, &rational);
}

/* Largest weighted error of shared sets for diagonals, and for distances, where much cancels. */
#define HDI_SHARED_TOL 2.5e-8
#define HDI_SHARED_DISTANCE_TOL 2e-10

/* ---- diagonals at many times ---- */

/* After packs that did not fit the byte limit: those that are there go, and the call begins anew. */
static void hdi_heat_forget(hdi_heat_call *h) {
    hdi_elim *m = &h->heat->elim;
    hd_report *rep = h->rep;
    while (m->n_packs > 0) hdi_factor_free(m->pack + --m->n_packs);
    m->filled = 0;
    hdi_error_clear(h->e);
    memset(rep, 0, sizeof *rep);
    hdi_inverse_tell(h);
    h->set = NULL;
}

/* Packs that a shared set for a ratio of times takes; 0: there is none. */
static int32_t hdi_shared_packs(double ratio, double tol) {
    hd_rational set;
    return hdi_shared_pick(&set, ratio * (1 + 1e-12), tol) ? (set.n_poles + 3) / 4 : 0;
}

/* How many windows of equal ratio take the fewest packs in all for times in a range of this ratio, and how many packs those are. */
static int32_t hdi_shared_windows(double ratio, double tol, int32_t most, int32_t *packs) {
    int32_t w, best = 0;
    for (w = 1; w <= most && w <= 64; w++) {
        const int32_t each = hdi_shared_packs(pow(ratio, 1.0 / w), tol);
        if (each == 0 || (best > 0 && w * each >= *packs)) continue;
        best = w;
        *packs = w * each;
    }
    return best;
}

/* Weights of k and of a bound of g for every time in turn, for poles of the first: (t L + tau theta B)^-1 = (t0 L + theta B)^-1 / tau. */
static void hdi_shared_weights(const hd_rational *set, int32_t n_times, const double *t, hd_c64 *weight) {
    int32_t q, p;
    for (q = 0; q < n_times; q++) {
        double factor = 1, tau = t[q] / t[0];
        const int32_t best = hdi_resolvent_pole(set + q, &factor);
        hd_c64 *k = weight + 2 * HDI_CAST(int64_t, q) * set->n_poles, *g = k + set->n_poles;
        for (p = 0; p < set->n_poles; p++) {
            k[p] = hdi_cscale(-hdi_rat_count(set, p) / tau, set[q].a[p]);
            g[p] = hdi_c(p == best ? factor / tau : 0, 0);
        }
    }
}

/* k_t(v,v) for the (scaled) times t[0..n_times), ascending, by one set of poles, into the columns that `column` names. */
static hd_status hdi_diagonal_window(hdi_heat_call *h, int32_t n_times, const double *t, const int32_t *column, double *D, size_t ldd) {
    hd_heat *heat = h->heat;
    hdi_elim *m = &heat->elim;
    hdi_scope s = hdi_scope_begin(heat->ctx, h->e);
    const uint64_t n = HDI_CAST(uint64_t, m->sym.n), sets = 2 * HDI_CAST(uint64_t, n_times);
    hd_rational *set = HDI_TAKE(&s, hd_rational, n_times);
    hd_c64 *weight = HDI_TAKE_ZERO(&s, hd_c64, sets * HD_MAX_POLES);
    double *room = HDI_TAKE_ZERO(&s, double, sets * n), *off = HDI_TAKE(&s, double, n);
    int32_t q, i, r, worst = -1;
    double most = 0;
    hdi_probe probe;
    if (h->e->status < 0 || hdi_rational_shared(set, n_times, t, HDI_SHARED_TOL, heat->ctx, h->e) < 0) return hdi_scope_end(&s);
    h->t = t[0];
    h->set = set;
    if (hdi_direct_factors(h) < 0) return hdi_scope_end(&s);
    hdi_shared_weights(set, n_times, t, weight);
    if (hdi_progress(heat->ctx, "invert", 0, h->e) < 0 || hdi_elim_invert(m, 2 * n_times, weight, HDI_WANT_DIAGONAL, room, HDI_CAST(int64_t, n), h->e) < 0) return hdi_scope_end(&s);
    h->set = NULL;
    h->lap = m->lap;
    for (i = 0; i < m->sym.n; i++) {             /* of the last time: there rounding is largest */
        const double *k = room + 2 * HDI_CAST(size_t, n_times - 1) * n, *g = k + n;
        if (worst < 0 || g[i] * most > k[i]) {
            worst = i;
            most = hdi_quotient(k[i], g[i]);
        }
    }
    probe = hdi_probe_rows(m->lap, room + 2 * HDI_CAST(size_t, n_times - 1) * n, worst);
    if (hdi_probe_run(h, &probe, HD_KERNEL_SYMMETRIC, set) < 0) return hdi_scope_end(&s);
    for (q = 0; q < n_times; q++) {
        const double *k = room + 2 * HDI_CAST(size_t, q) * n, *g = k + n;
        double rounding = 0;
        for (r = 0; r < probe.k; r++) {
            const int32_t row = probe.row[r];
            double by, there = hdi_probe_value(heat, &probe, r, set + q, t[q] / t[0], 0, g[row], &by);
            rounding = hdi_max(rounding, hdi_quotient(HDI_PROBE_SAFETY * fabs(there - k[row]) + by, fabs(k[row])));
        }
        for (i = 0; i < m->sym.n; i++) rounding = hdi_max(rounding, hdi_below_constants(m->lap, set + q, i, k[i], 1));
        for (i = 0; i < m->sym.n; i++) off[i] = hdi_min(set[q].max_weighted_error * hdi_max(0, g[i]), set[q].max_error / (m->lap->b_ratio * m->lap->b_diag[i]));
        (void)hdi_diagonal_tell(h, HD_KERNEL_SYMMETRIC, k, off, k, rounding, D + HDI_CAST(size_t, column[q]) * ldd);
    }
    return hdi_scope_end(&s);
}

/* All times, in windows that share their poles. */
static hd_status hdi_diagonal_windows(hdi_heat_call *h, int32_t n_windows, double *D, size_t ldd) {
    int32_t w, q0, q1;
    for (w = 0, q0 = 0; q0 < h->n_times; w++, q0 = q1) {
        q1 = hdi_window_end(h->times, h->n_times, q0, w, n_windows);
        if (hdi_diagonal_window(h, q1 - q0, h->times + q0, h->time_column + q0, D, ldd) < 0) break;
    }
    return h->e->status;
}

/* All times of a call: by shared poles where that takes fewer packs, else one by one. A set of degree 9, which one time
 * takes, costs as much as 9/8 packs: a pack and a real factor. */
static hd_status hdi_diagonal_run(hdi_heat_call *h, hd_kernel kernel, double *D, size_t ldd) {
    hd_heat *heat = h->heat;
    int32_t q;
    if (hdi_heat_analysed(heat, h->e) < 0) return h->e->status;
    hdi_inverse_tell(h);
    if (kernel == HD_KERNEL_SYMMETRIC && h->ask.n_times > 1 && !heat->poles_asked && !heat->exacting) {
        int32_t packs = 0, windows;
        if (hdi_heat_sort_times(h, 1) < 0) return h->e->status;
        windows = hdi_shared_windows(h->times[h->n_times - 1] / h->times[0], HDI_SHARED_TOL, h->n_times, &packs);
        if (windows > 0 && 8 * packs < 9 * h->n_times && !hdi_heat_equal(heat, h->t, h->e)) {
            if (hdi_diagonal_windows(h, windows, D, ldd) != HD_ERR_MEMORY_LIMIT) return h->e->status;
            hdi_heat_forget(h);                  /* one by one takes less */
        }
    }
    for (q = 0; q < h->ask.n_times && h->e->status >= 0; q++) {
        h->t = hdi_heat_scaled(heat, h->ask.t[q]);
        if (hdi_entries_sure(h, kernel, 0, D + HDI_CAST(size_t, q) * ldd) < 0) h->e->column = q;
    }
    return h->e->status;
}

/* k_t on the pattern of L at all times of a call, nnz(L) values each. */
static hd_status hdi_edges_run(hdi_heat_call *h, double *values) {
    const size_t nnz = HDI_CAST(size_t, h->heat->source->L.nnz);
    int32_t q;
    if (hdi_heat_analysed(h->heat, h->e) < 0) return h->e->status;
    hdi_inverse_tell(h);
    for (q = 0; q < h->ask.n_times && h->e->status >= 0; q++) {
        h->t = hdi_heat_scaled(h->heat, h->ask.t[q]);
        if (hdi_entries_sure(h, HD_KERNEL_SYMMETRIC, 1, values + HDI_CAST(size_t, q) * nnz) < 0) h->e->column = q;
    }
    return h->e->status;
}

/* ==== [27] diffusion ====
 * Owns distances: the metric of a kind and a time, one to all, pairs. May call [26]. */

/* ---- distances ---- */

/* What distances of one kind at one time are made of: d^2 = f_ss - 2 f_sv + f_vv, f(v,v) by rows of the source, and bounds of
 * their errors: the rational one of f is at most weighted times a form with diagonal g, and at most uniform times one with
 * diagonal spread; that of a column by rounding at most sqrt(g_v) times a number that is known of each column. */
typedef struct hdi_metric {
    hd_distance_kind kind;
    double t;                    /* of columns, scaled */
    double unit;                 /* of f to the plan's numbers */
    hd_rational set;             /* of the factors */
    int filter, equal;           /* no time; t is as good as infinite */
    double *diag, *g, *spread;
    hd_rational resolvent;       /* weights for g */
    double weighted, uniform;    /* HUGE_VAL: it bounds nothing */
    double left_out;             /* times the form of spread, besides: a0 B^-1 of a full B */
    double rounding;             /* of diag, relative to it, or with own to g: of any function of the caller's, which may vanish */
    int own;
} hdi_metric;

/* A column of f by vertices, and what rounding can put it off by: sqrt(g_v) times off_m, and sqrt(spread_v) times off_b. */
typedef struct hdi_metric_column { double *u, off_m, off_b; } hdi_metric_column;

/* What rounding of a function of the caller's is relative to: the resolvent, or where that bounds nothing the mass. */
static double hdi_own_size(double g, double spread) { return g > 0 && hdi_finite(g) ? g : spread; }

/* Commute and biharmonic, from L grounded. */
static hd_status hdi_metric_ground(hd_heat *heat, hdi_metric *x, hdi_scope *scope, hd_error *e) {
    const int forms = x->kind == HD_DISTANCE_BIHARMONIC;
    hdi_elim *m = &heat->elim;
    hdi_ground *g = &heat->ground;
    double *work, *u;
    hdi_probe probe;
    int32_t i, farthest = 0, nearest = 0;
    if (hdi_ground_make(m, g, e) < 0 || (forms && hdi_ground_forms(m, g, e) < 0)) return e->status;
    work = HDI_TAKE(scope, double, hdi_ground_room(m));
    u = HDI_TAKE(scope, double, m->sym.n);
    if (!work || !u) return scope->e->status;
    x->unit = forms ? 1 / heat->scale : 1;
    for (i = 0; i < m->sym.n; i++) {
        const int32_t r = m->sym.perm[i];
        x->diag[r] = x->unit * (forms ? g->form[i] : g->diag[i]);
        x->g[r] = hdi_max(0, g->diag[i]);
        x->spread[r] = HUGE_VAL;
    }
    for (i = 1; i < m->sym.n; i++) {
        if (g->diag[i] > g->diag[farthest]) farthest = i;
        if (g->diag[i] > 0 && !(g->diag[nearest] > 0 && g->diag[nearest] <= g->diag[i])) nearest = i;
    }
    probe = hdi_probe_rows(m->lap, g->diag, m->sym.n > 0 ? farthest : -1);
    for (i = 0; i <= probe.k && m->sym.n > 0; i++) {   /* and the nearest, where the relative error is largest */
        const int32_t row = i < probe.k ? probe.row[i] : nearest;
        const double there = forms ? g->form[row] : g->diag[row];
        const double off = hdi_ground_column(m, g, row, forms, u, work) * sqrt(hdi_max(0, g->diag[row]));
        x->rounding = hdi_max(x->rounding, hdi_quotient(4 * HDI_PROBE_SAFETY * fabs(u[row] - there) + off, there));
    }
    return HD_OK;
}

/* Where t is so large that kernels are the means of the components. */
static void hdi_metric_equal(const hd_laplacian *lap, hdi_metric *x) {
    int32_t r;
    for (r = 0; r < lap->n_active; r++) {
        const double b = lap->mass[r], k = 1 / lap->component_mass[lap->component[r]];
        x->diag[r] = x->kind == HD_DISTANCE_WEIGHTED ? b * (b * k) : k;
        x->g[r] = x->spread[r] = 0;
    }
    x->rounding = HDI_CAST(double, lap->n_active) * DBL_EPSILON;
}

/* The diagonal by inversion of the factors of the poles, at h->t. */
static hd_status hdi_metric_invert(hdi_heat_call *h, hdi_metric *x, hdi_scope *scope) {
    hd_heat *heat = h->heat;
    hdi_elim *m = &heat->elim;
    const hd_laplacian *lap = heat->source;
    const int weighted = x->kind == HD_DISTANCE_WEIGHTED, full = weighted && lap->B != NULL;
    double *room = HDI_TAKE(scope, double, 2 * HDI_CAST(uint64_t, m->sym.n));
    hdi_entries entries;
    hdi_probe probe;
    int32_t i;
    if (!room || hdi_entries_make(h, full ? HDI_WANT_FORMS : HDI_WANT_DIAGONAL, room, m->sym.n, &entries) < 0) return h->e->status;
    if (lap->B && !full) x->left_out = fabs(m->set.a0);
    for (i = 0; i < m->sym.n; i++) {
        const int32_t r = m->sym.perm[i];
        const double b = lap->b_diag[r], w = full ? 1 / heat->scale : weighted ? b * m->lap->mass[i] : heat->scale;   /* no square of b */
        x->diag[r] = w * (entries.k[i] + (lap->B ? 0 : m->set.a0 / m->lap->mass[i])) + (full ? m->set.a0 * b : 0);
        x->g[r] = w * entries.g[i];
        x->spread[r] = weighted ? b : lap->b_ratio > 0 ? 1 / (lap->b_ratio * b) : HUGE_VAL;
    }
    x->own = m->set.kind == HD_POLES_OWN;
    x->set = m->set;
    x->resolvent = entries.resolvent;
    x->weighted = entries.weighted;
    x->uniform = entries.uniform;
    probe = hdi_probe_rows(m->lap, entries.k, -1);
    if (hdi_probe_run(h, &probe, full ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC, &x->set) < 0) return h->e->status;
    for (i = 0; i < probe.k; i++) {
        const int32_t row = probe.row[i];
        double by, there, value = entries.k[row];
        if (full) {                              /* f is (B K)(v,v): the column is K e_v */
            hdi_pair_apply(m->lap, 0, 1, heat->lane[i].u, heat->lane[i].tmp);
            there = heat->lane[i].tmp[row];
            (void)hdi_probe_value(heat, &probe, i, &x->set, 1, 1, HUGE_VAL, &by);
            by *= sqrt(m->lap->b_diag[row]) / (hdi_ratio_root(m->lap) / sqrt(m->lap->b_diag[row]));   /* |(B e)_v| <= sqrt(B_vv) |e|_B */
            value = (x->diag[m->sym.perm[row]]) * heat->scale;
            by += HDI_PROBE_SAFETY * fabs(there - value);
        } else {
            there = hdi_probe_value(heat, &probe, i, &x->set, 1, 0, entries.g[row], &by);
            by += HDI_PROBE_SAFETY * fabs(there - value);
        }
        if (x->own) value = hdi_own_size(entries.g[row], m->lap->b_ratio > 0 ? 1 / (m->lap->b_ratio * m->lap->b_diag[row]) : HUGE_VAL);
        x->rounding = hdi_max(x->rounding, hdi_quotient(by, fabs(value)));
    }
    if (x->own) {
        const double near = hdi_own_near(heat, &x->set, h->t);
        double most = 0;
        for (i = 0; i < m->sym.n && near > 0; i++) {
            const double spread = hdi_quotient(1 / m->lap->b_diag[i], m->lap->b_ratio);
            most = hdi_max(most, hdi_quotient(spread, hdi_own_size(entries.g[i], spread)));
        }
        x->rounding = HDI_PROBE_OWN * x->rounding + near * most;
    }
    for (i = 0; i < m->sym.n && x->set.a0 == 0; i++)
        x->rounding = hdi_max(x->rounding, hdi_below_constants(m->lap, &x->set, i, entries.k[i], full ? m->lap->mass[i] * m->lap->mass[i] : 1));
    return HD_OK;
}

static hd_status hdi_metric_make(hd_heat *heat, hd_distance_kind kind, double t, int32_t degree, hdi_metric *x, hdi_scope *keep, hd_report *rep) {
    const hd_laplacian *lap = heat->source;
    const size_t n = HDI_CAST(size_t, lap->n_active);
    hd_error *e = keep->e;
    hdi_scope scope;
    hdi_heat_call h;
    memset(x, 0, sizeof *x);
    x->kind = kind;
    x->filter = kind >= HD_DISTANCE_COMMUTE;
    x->diag = HDI_TAKE(keep, double, 3 * n + 1);
    if (!x->diag) return e->status;
    x->g = x->diag + n;
    x->spread = x->g + n;
    scope = hdi_scope_begin(heat->ctx, e);
    x->t = hdi_min(2 * hdi_heat_scaled(heat, t), 1e300);
    x->unit = kind == HD_DISTANCE_WEIGHTED ? 1 : heat->scale;
    if (hdi_heat_begin(&h, heat, HDI_QUERY_SYMMETRIC, rep, NULL) < 0 || hdi_heat_analysed(heat, h.e) < 0) {
        *e = *h.e;
        return hdi_heat_end(&h);
    }
    hdi_inverse_tell(&h);
    h.t = x->t;
    h.degree = degree;
    h.lap = heat->elim.lap;
    h.relative = 1;
    if (x->filter) {
        rep->reason = "one real factor of L, one vertex of each component held";
        (void)hdi_metric_ground(heat, x, &scope, h.e);
        rep->factor_flops = heat->elim.sym.flops;
    } else {
        x->equal = hdi_heat_equal(heat, x->t, h.e);
        if (x->equal) hdi_metric_equal(lap, x);
        else if (h.e->status >= 0) (void)hdi_metric_invert(&h, x, &scope);
    }
    if (h.e->status < 0 && e->status >= 0) *e = *h.e;
    hdi_heat_end(&h);
    return hdi_scope_end(&scope);
}

/* Column s of f into u [n], by vertices, from what the plan gives: of k_t, or of K_t e_s. work [2 n_active]. */
static void hdi_metric_of_column(const hd_laplacian *lap, const hdi_metric *x, double *u, double *work) {
    int32_t i;
    if (x->kind != HD_DISTANCE_WEIGHTED) {
        for (i = 0; i < lap->n; i++) u[i] = lap->row[i] < 0 ? 0 : u[i];
        return;
    }
    hdi_gather(lap, u, work);
    hdi_pair_apply(lap, 0, 1, work, work + lap->n_active);
    for (i = 0; i < lap->n; i++) u[i] = lap->row[i] < 0 ? 0 : work[lap->n_active + lap->row[i]];
}

/* Columns of f for k sources, step apart; c [k]. rep: residual. */
static hd_status hdi_metric_columns(hd_heat *heat, const hdi_metric *x, int32_t k, const int32_t *sources, double *D, size_t step, hdi_metric_column *c, hd_report *rep, hd_error *e) {
    hdi_scope s = hdi_scope_begin(heat->ctx, e);
    const hd_laplacian *lap = heat->source;
    const size_t n = HDI_CAST(size_t, lap->n_active);
    const double unit = x->kind == HD_DISTANCE_WEIGHTED ? 1 / sqrt(heat->scale) : sqrt(heat->scale);
    double *work, *off, *u;
    hdi_columns query;
    hd_report columns;
    int32_t r, i;
    for (r = 0; r < k; r++) c[r].u = D + HDI_CAST(size_t, r) * step;
    if (x->filter) {
        work = HDI_TAKE(&s, double, hdi_ground_room(&heat->elim));
        u = HDI_TAKE(&s, double, n);
        for (r = 0; r < k && e->status >= 0; r++) {
            const int32_t row = heat->elim.lap->row[sources[r]];
            if (hdi_progress(heat->ctx, "solve", HDI_CAST(double, r) / k, e) < 0) break;
            c[r].off_m = 0;
            c[r].off_b = HUGE_VAL;
            memset(c[r].u, 0, HDI_CAST(size_t, lap->n) * sizeof(double));
            if (row < 0) continue;
            c[r].off_m = x->unit * hdi_ground_column(&heat->elim, &heat->ground, row, x->kind == HD_DISTANCE_BIHARMONIC, u, work);
            for (i = 0; i < heat->elim.sym.n; i++) c[r].u[heat->elim.lap->vertex[i]] = x->unit * u[i];
        }
        return hdi_scope_end(&s);
    }
    off = HDI_TAKE_ZERO(&s, double, 2 * HDI_CAST(uint64_t, k) + 1);
    work = HDI_TAKE(&s, double, 2 * n + 1);
    if (e->status < 0) return hdi_scope_end(&s);
    memset(&query, 0, sizeof query);
    query.t = x->t;
    query.kernel = x->kind == HD_DISTANCE_WEIGHTED ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
    query.set = &x->set;
    query.k = k;
    query.equal = x->equal;
    query.sources = sources;
    query.U = D;
    query.ldu = step;
    query.off_b = off;
    query.off_m = off + k;
    if (hdi_direct_columns(heat, &query, &columns) < 0) *e = columns.error;
    else rep->residual = hdi_max(rep->residual, columns.residual);
    for (r = 0; r < k && e->status >= 0; r++) {
        hdi_metric_of_column(lap, x, c[r].u, work);
        c[r].off_m = unit * off[k + r];
        c[r].off_b = unit * off[r] * (x->kind == HD_DISTANCE_WEIGHTED ? sqrt(heat->scale) : 1);
    }
    return hdi_scope_end(&s);
}

/* Bound of the rational error of d^2 between s and v: of the form of g, whose column g_sv is known or not, and of that of
 * spread; either bounds it alone. */
static double hdi_metric_rational(const hdi_metric *x, double gs, double gv, const double *gsv, double ss, double sv) {
    const double root = sqrt(hdi_max(0, gs)) + sqrt(hdi_max(0, gv)), wide = sqrt(ss) + sqrt(sv);
    double form = root * root, bound = HUGE_VAL;
    if (x->filter || x->equal) return 0;
    if (x->uniform == 0) return x->left_out > 0 ? x->left_out * wide * wide : 0;
    if (gsv) form = hdi_min(form, hdi_max(0, gs + gv - 2 * *gsv) + (x->rounding + 8 * DBL_EPSILON) * (fabs(gs) + fabs(gv)));
    if (hdi_finite(x->weighted)) bound = x->weighted * form;
    bound = hdi_min(bound, x->uniform * wide * wide);
    return x->left_out > 0 ? bound + x->left_out * wide * wide : bound;
}

/* d from column s of f, in place. g: the same column of the resolvent, whose own d^2 bounds the rational error; NULL: from the
 * diagonals, which is less sharp near s. Between components the last two kinds are infinite. */
static void hdi_metric_distance(const hd_laplacian *lap, const hdi_metric *x, int32_t s, const hdi_metric_column *c, const double *g, hd_report *rep, hdi_ledger *ledger) {
    const int32_t rs = lap->row[s];
    const double fs = rs < 0 ? 0 : x->diag[rs], gs = rs < 0 ? 0 : x->g[rs], ss = rs < 0 ? 0 : x->spread[rs];
    double *u = c->u;
    int32_t v;
    for (v = 0; v < lap->n; v++) {
        const int32_t r = lap->row[v];
        const double f = r < 0 ? 0 : x->diag[r], gv = r < 0 ? 0 : x->g[r], sv = r < 0 ? 0 : x->spread[r], d2 = fs - 2 * u[v] + f;
        double rational, rounding = 0, delta, error, d;
        hdi_parts part;
        if (v == s) {
            u[v] = 0;
            continue;
        }
        if (x->filter && (r < 0 || rs < 0 || lap->component[r] != lap->component[rs])) {
            u[v] = HUGE_VAL;
            continue;
        }
        rational = hdi_metric_rational(x, gs, gv, g ? g + v : NULL, ss, sv);
        if (r >= 0 && rs >= 0) {
            const double by_m = hdi_bound_times(hdi_finite(gv) ? sqrt(hdi_max(0, gv)) : HUGE_VAL, c->off_m);
            rounding = 2 * hdi_min(by_m, hdi_bound_times(hdi_finite(sv) ? sqrt(sv) : HUGE_VAL, c->off_b));
        }
        if (x->rounding > 0) rounding += x->rounding * (x->own ? hdi_own_size(gs, ss) + hdi_own_size(gv, sv) : fabs(fs) + fabs(f));
        rounding += 4 * DBL_EPSILON * (fabs(fs) + fabs(f));
        delta = rational + rounding;
        d = d2 > 0 ? sqrt(d2) : 0;
        u[v] = d;
        error = d2 > delta ? delta / d : sqrt(2 * delta);
        rep->n_lost += delta > 0 && d2 < 10 * delta;
        memset(&part, 0, sizeof part);
        if (delta > 0) {
            part.rational = hdi_finite(delta) ? error * (rational / delta) : rational;
            part.rounding = hdi_finite(delta) ? error * (rounding / delta) : rounding;
        }
        hdi_ledger_note(ledger, d, part);
    }
}

static hdi_ledger hdi_metric_ledger(const hdi_metric *x) {
    const int none = x->filter || x->equal || (x->uniform == 0 && x->left_out == 0);
    return hdi_ledger_begin(none ? HD_EVIDENCE_NONE : HD_EVIDENCE_PROVEN, HD_EVIDENCE_NONE, HD_EVIDENCE_MEASURED, 1);
}

/* Bound of the error relative to the largest distance that sends the default to the highest degree, and what the bound of degree 9 is to be expected at, as
 * seen on meshes of 1K to 50K vertices: so much times sqrt(t)/h. */
#define HDI_DISTANCE_SURE 2.5e-6
#define HDI_DISTANCE_EXPECTED 4.4e-7

/* Are the poles beyond our choice, or the highest degree as it is? */
static int hdi_metric_settled(const hd_heat *heat, hd_distance_kind kind) {
    return kind >= HD_DISTANCE_COMMUTE || heat->poles_asked || heat->exacting;
}

/* Did the factors of the highest degree not fit the byte limit? Then those of the default are to be tried. */
static int hdi_metric_retry(const hd_heat *heat, hd_error *e) {
    if (e->status != HD_ERR_MEMORY_LIMIT || heat->elim.n_packs == 0) return 0;
    hdi_error_clear(e);
    return 1;
}

/* The same columns of the resolvent's bound g, in f's units. */
static hd_status hdi_metric_resolvent(hd_heat *heat, const hdi_metric *x, int32_t source, double *g, double *work, hd_error *e) {
    hdi_columns query;
    hd_report rep;
    memset(&query, 0, sizeof query);
    query.t = x->t;
    query.kernel = x->kind == HD_DISTANCE_WEIGHTED ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC;
    query.set = &x->resolvent;
    query.k = 1;
    query.sources = &source;
    query.U = g;
    query.ldu = HDI_CAST(size_t, heat->source->n);
    if (hdi_direct_columns(heat, &query, &rep) < 0) *e = rep.error;
    else hdi_metric_of_column(heat->source, x, g, work);
    return e->status;
}

/* One time, all sources: columns step apart. degree 0: by default. */
static hd_status hdi_distance_once(hd_heat *heat, hd_distance_kind kind, double t, int32_t degree, int32_t k, const int32_t *sources, double *D, size_t step,
                                   hd_report *rep, hd_error *e) {
    hdi_scope s = hdi_scope_begin(heat->ctx, e);
    const size_t n = HDI_CAST(size_t, heat->source->n);
    double *work = HDI_TAKE(&s, double, 2 * n + 1), *g = NULL;
    hdi_metric_column *column = HDI_TAKE(&s, hdi_metric_column, HDI_CAST(uint64_t, k) + 1);
    hdi_metric x;
    int32_t r;
    memset(rep, 0, sizeof *rep);
    if (e->status < 0 || hdi_metric_make(heat, kind, t, degree, &x, &s, rep) < 0) return hdi_scope_end(&s);
    rep->error_relative = 0;
    (void)hdi_metric_columns(heat, &x, k, sources, D, step, column, rep, e);
    if (e->status >= 0 && !x.filter && !x.equal && x.weighted > 0 && hdi_finite(x.weighted)) g = HDI_TAKE(&s, double, n);
    for (r = 0; r < k && e->status >= 0; r++) {
        hdi_ledger ledger = hdi_metric_ledger(&x);
        if (g && hdi_metric_resolvent(heat, &x, sources[r], g, work, e) < 0) break;
        hdi_metric_distance(heat->source, &x, sources[r], column + r, g, rep, &ledger);
        hdi_ledger_close(&ledger, rep);
    }
    return hdi_scope_end(&s);
}

/* out [n_sets][n] += the weighted sums of column `row` of the inverses, or with mass of the inverses times the (full, scaled) B, rows in elimination order: pairs only.
 * x [8 n], work as a sweep's, active [n_super], spare [3 n]. pole_off: the poles' residuals as seen, in the norm of D^-1. */
static void hdi_shared_column(const hdi_elim *m, int32_t row, int mass, int32_t n_sets, const hd_c64 *weight, double *out, double *x, double *work, char *active,
                              double *spare, double *pole_off) {
    const int32_t n = m->sym.n, n_poles = m->set.n_poles;
    hdi_check check, *list = &check;
    const int64_t begin = m->lap->L.row_ptr[row], end = m->lap->L.row_ptr[row + 1];
    int64_t p;
    int32_t i, k, q, j;
    memset(active, 0, HDI_CAST(size_t, m->sym.n_super));
    hdi_sweep_touch(&m->sym, row, active);
    for (p = begin; p < end && mass; p++) hdi_sweep_touch(&m->sym, m->lap->L.col[p], active);
    for (i = 0; 4 * i < n_poles; i++) {
        hdi_sweep z;
        memset(x, 0, HDI_CAST(size_t, n) * HDI_PACK * sizeof *x);
        for (q = 0; q < 4 && !mass; q++) x[HDI_PACK * HDI_CAST(int64_t, row) + q] = 1;
        for (p = begin; p < end && mass; p++)
            for (q = 0; q < 4; q++) x[HDI_PACK * HDI_CAST(int64_t, m->lap->L.col[p]) + q] = m->lap->B[p];
        z = hdi_sweep_open(m->pack + i, 1, x, work, 1);
        z.active = active;
        hdi_sweep_run(&z, m->ctx);
        memset(&check, 0, sizeof check);
        memset(spare, 0, 3 * HDI_CAST(size_t, n) * sizeof *spare);
        if (!mass) spare[row] = 1;
        for (p = begin; p < end && mass; p++) spare[m->lap->L.col[p]] = m->lap->B[p];
        check.lap = m->lap;
        check.t = m->t;
        check.weight = m->weight;
        check.noise = m->noise;
        check.rhs = spare;
        check.x = x;
        check.stride = HDI_PACK;
        check.u = spare + n;
        check.bu = check.u + n;
        for (q = 0; q < 4; q++) {
            check.theta[q] = m->set.theta[hdi_elim_pole(m, i, q)].re;
            check.theta[q + 4] = m->set.theta[hdi_elim_pole(m, i, q)].im;
        }
        hdi_check_c(&list, 1);
        for (q = 0; q < 4 && 4 * i + q < n_poles; q++) pole_off[4 * i + q] = hdi_residual_seen(sqrt(check.norm2[q]), sqrt(check.size2[q]));
        for (k = 0; k < n_sets; k++) {
            const hd_c64 *w = weight + HDI_CAST(int64_t, k) * n_poles + 4 * i;
            double *HDI_RESTRICT to = out + HDI_CAST(int64_t, k) * n, c[HDI_PACK];
            for (q = 0; q < 4; q++) {
                c[q] = 4 * i + q < n_poles ? w[q].re : 0;
                c[q + 4] = 4 * i + q < n_poles ? -w[q].im : 0;
            }
            for (j = 0; j < n; j++)
                for (q = 0; q < HDI_PACK; q++) to[j] += c[q] * x[HDI_PACK * HDI_CAST(int64_t, j) + q];
        }
    }
}

/* Distances of the first two kinds at the (scaled, ascending) times h->times[q0..q1) of the kernel by one set of poles. */
static hd_status hdi_distance_window(hdi_heat_call *h, hd_distance_kind kind, int32_t q0, int32_t q1, int32_t k, const int32_t *sources, double *D, size_t ldd) {
    hd_heat *heat = h->heat;
    hdi_elim *m = &heat->elim;
    const hd_laplacian *lap = heat->source;
    hdi_scope s = hdi_scope_begin(heat->ctx, h->e);
    const int32_t n_times = q1 - q0, n = m->sym.n;
    const int weighted = kind == HD_DISTANCE_WEIGHTED, full = weighted && lap->B != NULL;
    const uint64_t size = 2 * HDI_CAST(uint64_t, n_times) * HDI_CAST(uint64_t, n);
    const double *t = h->times + q0, unit = weighted ? 1 / heat->scale : heat->scale;
    hd_rational *set = HDI_TAKE(&s, hd_rational, n_times);
    hd_c64 *weight = HDI_TAKE_ZERO(&s, hd_c64, 2 * HDI_CAST(uint64_t, n_times) * HD_MAX_POLES);
    double *room = HDI_TAKE_ZERO(&s, double, size), *column = HDI_TAKE(&s, double, size), *x = HDI_TAKE(&s, double, HDI_PACK * HDI_CAST(uint64_t, n));
    double *work = HDI_TAKE(&s, double, hdi_sweep_size(&m->sym, HDI_PACK, 1, 1)), *g = HDI_TAKE(&s, double, lap->n), *spare = HDI_TAKE(&s, double, 3 * HDI_CAST(uint64_t, n));
    double *product = full ? HDI_TAKE(&s, double, 2 * HDI_CAST(uint64_t, n)) : NULL, *rounding = HDI_TAKE_ZERO(&s, double, n_times);
    char *active = HDI_CAST(char *, hdi_take(&s, HDI_CAST(size_t, m->sym.n_super) + 1, 1));
    double pole_off[HD_MAX_POLES];
    hdi_metric metric;
    hdi_probe probe;
    int32_t q, r, i, p;
    memset(&metric, 0, sizeof metric);
    metric.kind = kind;
    metric.diag = HDI_TAKE(&s, double, 3 * HDI_CAST(uint64_t, n) + 1);
    if (h->e->status < 0 || hdi_rational_shared(set, n_times, t, HDI_SHARED_DISTANCE_TOL, heat->ctx, h->e) < 0) return hdi_scope_end(&s);
    metric.g = metric.diag + n;
    metric.spread = metric.g + n;
    h->t = t[0];
    h->set = set;
    h->lap = m->lap;
    h->relative = 1;
    if (hdi_direct_factors(h) < 0) return hdi_scope_end(&s);
    hdi_shared_weights(set, n_times, t, weight);
    if (hdi_progress(heat->ctx, "invert", 0, h->e) < 0 || hdi_elim_invert(m, 2 * n_times, weight, full ? HDI_WANT_FORMS : HDI_WANT_DIAGONAL, room, n, h->e) < 0)
        return hdi_scope_end(&s);
    probe = hdi_probe_rows(m->lap, room + 2 * HDI_CAST(size_t, n_times - 1) * HDI_CAST(size_t, n), -1);
    for (i = 0; i < probe.k; i++) {              /* columns of the forms' rows, as those of sources are found */
        memset(column, 0, HDI_CAST(size_t, size) * sizeof *column);
        hdi_shared_column(m, probe.row[i], full, 2 * n_times, weight, column, x, work, active, spare, pole_off);
        for (q = 0; q < n_times; q++) {
            const double *f = room + 2 * HDI_CAST(size_t, q) * HDI_CAST(size_t, n), *c = column + 2 * HDI_CAST(size_t, q) * HDI_CAST(size_t, n);
            const int32_t row = probe.row[i];
            double there = c[row], off = 0;
            if (full) {
                hdi_pair_apply(m->lap, 0, 1, c, product);
                there = product[row];
            }
            for (p = 0; p < set[q].n_poles; p++) off += 2 * hdi_cabs(set[q].a[p]) * pole_off[p] * hdi_ratio_root(m->lap) * hdi_pole_reach(set[q].theta[p]);
            off *= sqrt(hdi_max(0, f[n + row]));
            rounding[q] = hdi_max(rounding[q], hdi_quotient(HDI_PROBE_SAFETY * fabs(there - f[row]) + off, fabs(f[row])));
        }
    }
    for (q = 0; q < n_times; q++)
        for (i = 0; i < n; i++)
            rounding[q] = hdi_max(rounding[q], hdi_below_constants(m->lap, set + q, i, room[2 * HDI_CAST(size_t, q) * HDI_CAST(size_t, n) + HDI_CAST(size_t, i)],
                                                                   full ? m->lap->mass[i] * m->lap->mass[i] : 1));
    for (r = 0; r < k; r++) {
        const int32_t row = m->lap->row[sources[r]];
        if (hdi_progress(heat->ctx, "solve", HDI_CAST(double, r) / k, h->e) < 0) break;
        memset(column, 0, HDI_CAST(size_t, size) * sizeof *column);
        memset(pole_off, 0, sizeof pole_off);
        if (row >= 0) hdi_shared_column(m, row, full, 2 * n_times, weight, column, x, work, active, spare, pole_off);
        for (q = 0; q < n_times; q++) {
            const double *f = room + 2 * HDI_CAST(size_t, q) * HDI_CAST(size_t, n), *c = column + 2 * HDI_CAST(size_t, q) * HDI_CAST(size_t, n);
            double *u = D + (HDI_CAST(size_t, r) * HDI_CAST(size_t, h->n_times) + HDI_CAST(size_t, h->time_column[q0 + q])) * ldd;
            const double bs = weighted && !full && row >= 0 ? m->lap->mass[row] : 1;
            hdi_metric_column of;
            hdi_ledger ledger;
            memset(u, 0, HDI_CAST(size_t, lap->n) * sizeof *u);
            memset(g, 0, HDI_CAST(size_t, lap->n) * sizeof *g);
            if (full) {                          /* B of what is B times the inverses */
                hdi_pair_apply(m->lap, 0, 1, c, product);
                hdi_pair_apply(m->lap, 0, 1, c + n, product + n);
                c = product;
            }
            for (i = 0; i < n; i++) {
                const int32_t at = m->sym.perm[i], v = m->lap->vertex[i];
                const double b = weighted && !full ? m->lap->mass[i] : 1, unit_f = unit * b * b;
                metric.diag[at] = unit_f * f[i];
                metric.g[at] = unit_f * f[n + i];
                metric.spread[at] = weighted ? lap->b_diag[at] : lap->b_ratio > 0 ? 1 / (lap->b_ratio * lap->b_diag[at]) : HUGE_VAL;
                u[v] = unit * b * bs * c[i];
                g[v] = unit * b * bs * c[n + i];
            }
            metric.weighted = set[q].max_weighted_error;
            metric.uniform = set[q].max_error;
            metric.rounding = rounding[q];
            of.u = u;
            of.off_m = 0;
            of.off_b = HUGE_VAL;
            for (p = 0; p < set[q].n_poles; p++) of.off_m += 2 * hdi_cabs(set[q].a[p]) * pole_off[p] * hdi_ratio_root(m->lap) * hdi_pole_reach(set[q].theta[p]);
            of.off_m *= sqrt(unit) * bs;
            ledger = hdi_metric_ledger(&metric);
            hdi_metric_distance(lap, &metric, sources[r], &of, g, h->rep, &ledger);
            hdi_ledger_close(&ledger, h->rep);
        }
    }
    if (n > 0 && k > 0 && h->e->status >= 0) {   /* how well the systems are solved */
        probe.k = 1;
        probe.row[0] = m->lap->row[sources[0]] >= 0 ? m->lap->row[sources[0]] : 0;
        (void)hdi_probe_run(h, &probe, HD_KERNEL_SYMMETRIC, set);
    }
    return hdi_scope_end(&s);
}

/* All times through shared poles, when that is cheaper than one by one. 0: it is not, or not possible. */
static int hdi_distance_windows(hdi_heat_call *h, hd_distance_kind kind, int32_t k, const int32_t *sources, double *D, size_t ldd) {
    hd_heat *heat = h->heat;
    const int32_t n_times = h->ask.n_times;
    int32_t packs = 0, windows, w, q0, q1;
    if (n_times < 2 || heat->poles_asked || heat->exacting) return 0;
    if (hdi_heat_sort_times(h, 2) < 0 || hdi_heat_analysed(heat, h->e) < 0) return 0;
    windows = hdi_shared_windows(h->times[n_times - 1] / h->times[0], HDI_SHARED_DISTANCE_TOL, n_times, &packs);
    if (windows == 0 || packs > n_times || hdi_heat_equal(heat, h->t, h->e) || h->e->status < 0) return 0;
    hdi_inverse_tell(h);
    for (w = 0, q0 = 0; q0 < n_times; w++, q0 = q1) {
        q1 = hdi_window_end(h->times, n_times, q0, w, windows);
        if (hdi_distance_window(h, kind, q0, q1, k, sources, D, ldd) < 0) break;
    }
    return 1;
}

/* Distances at one time. Where much cancels, or is sure to, with the highest degree if there is room for its factors. */
static hd_status hdi_distance_time(hd_heat *heat, hd_distance_kind kind, double t, int32_t k, const int32_t *sources, double *D,
                                   size_t step, hd_report *rep, hd_error *e) {
    const int settled = hdi_metric_settled(heat, kind);
    const double expected = heat->source->h > 0 ? HDI_DISTANCE_EXPECTED * sqrt(t) / heat->source->h : 0;
    const int sure = !settled && kind == HD_DISTANCE_CLASSICAL && expected > HDI_DISTANCE_SURE;
    if (!sure) (void)hdi_distance_once(heat, kind, t, 0, k, sources, D, step, rep, e);
    if (e->status >= 0 && !settled && (sure || rep->error_rational > HDI_DISTANCE_SURE))
        (void)hdi_distance_once(heat, kind, t, HDI_RAT_KERNEL_MAX, k, sources, D, step, rep, e);
    if (settled || !hdi_metric_retry(heat, e)) return e->status;
    return hdi_distance_once(heat, kind, t, 0, k, sources, D, step, rep, e);
}

/* One to all: all times and sources of a call. */
static hd_status hdi_distance_run(hdi_heat_call *h, hd_distance_kind kind, int32_t k, const int32_t *sources, double *D, size_t ldd) {
    hd_heat *heat = h->heat;
    const int timeless = kind >= HD_DISTANCE_COMMUTE;
    const int32_t n_times = timeless ? 1 : h->ask.n_times;
    hd_report one;
    int32_t q;
    if (!timeless && hdi_distance_windows(h, kind, k, sources, D, ldd) && h->e->status != HD_ERR_MEMORY_LIMIT) return h->e->status;
    if (h->e->status == HD_ERR_MEMORY_LIMIT && n_times > 1) hdi_heat_forget(h);   /* one by one takes less */
    for (q = 0; q < n_times && h->e->status >= 0; q++) {
        (void)hdi_distance_time(heat, kind, timeless ? 0 : h->ask.t[q], k, sources, D + HDI_CAST(size_t, q) * ldd,
                                ldd * HDI_CAST(size_t, n_times), &one, h->e);
        if (h->e->status < 0) h->e->column = q;
        else if (q == 0) *h->rep = one;
        else hdi_report_merge(h->rep, &one);
    }
    return h->e->status;
}

/* ---- pairs ---- */

/* Distinct vertices of the pairs, ascending, and where each pair's two stand among them. list [2 n_pairs], place [2 n_pairs]. Returns their number. */
static int32_t hdi_pairs_vertices(int64_t n_pairs, const int32_t *i, const int32_t *j, hdi_pair *order, int32_t *list, int32_t *place) {
    int32_t n = 0;
    int64_t q;
    for (q = 0; q < 2 * n_pairs; q++) {
        order[q].key = HDI_CAST(uint64_t, q % 2 ? j[q / 2] : i[q / 2]);
        order[q].id = q;
    }
    hdi_sort_pairs(order, 2 * n_pairs);
    for (q = 0; q < 2 * n_pairs; q++) {
        if (q == 0 || order[q].key != order[q - 1].key) list[n++] = HDI_CAST(int32_t, order[q].key);
        place[order[q].id] = n - 1;
    }
    return n;
}

/* |u - v|_B of fields on vertices, v NULL: |u|_B; whatever their size, with B times scale near one. work [2 n_active]. */
static double hdi_vertex_norm(const hd_laplacian *lap, const double *u, const double *v, double *work, double scale) {
    double most = 0;
    int32_t r;
    int exponent = 0;
    for (r = 0; r < lap->n_active; r++) {
        work[r] = u[lap->vertex[r]] - (v ? v[lap->vertex[r]] : 0);
        most = hdi_max(most, fabs(work[r]));
    }
    if (most == 0) return 0;
    frexp(most, &exponent);
    for (r = 0; r < lap->n_active; r++) work[r] = ldexp(work[r], -exponent);
    if (lap->B) {
        double sum = 0;
        int64_t p;
        for (r = 0; r < lap->n_active; r++) {
            double s = 0;
            for (p = lap->L.row_ptr[r]; p < lap->L.row_ptr[r + 1]; p++) s += scale * lap->B[p] * work[lap->L.col[p]];
            sum += work[r] * s;
        }
        return ldexp(sqrt(hdi_max(0, sum)) / sqrt(scale), exponent);
    }
    for (most = 0, r = 0; r < lap->n_active; r++) most += scale * lap->mass[r] * (work[r] * work[r]);
    return ldexp(sqrt(most) / sqrt(scale), exponent);
}

/* The parts of a report's bound. */
static hdi_parts hdi_parts_of(const hd_report *rep) {
    hdi_parts p;
    p.rational = rep->error_rational;
    p.solver = rep->error_solver;
    p.rounding = rep->error_rounding;
    return p;
}

/* Shares out what stands in rounding as another bound has it. */
static void hdi_parts_share(hdi_parts *to, const hdi_parts *as) {
    const double all = to->rounding, sum = hdi_parts_sum(as);
    if (!(sum > 0 && hdi_finite(sum) && hdi_finite(all))) return;
    to->rational = all * (as->rational / sum);
    to->solver = all * (as->solver / sum);
    to->rounding = all * (as->rounding / sum);
}

/* Kernel entries and distances of the pairs from columns at t: K_t(i,j) = (K_t e_j)_i, and |K_t B^-1 (e_i - e_j)|_B, which loses nothing
 * beside what the columns are off by: the report's bound of columns becomes that of distances. */
static void hdi_pairs_of_columns(const hd_laplacian *lap, hd_distance_kind kind, double scale, const double *U, int64_t n_pairs, const int32_t *i, const int32_t *j, const int32_t *place,
                                 double *K, double *d, double *work, hd_report *rep) {
    const size_t n = HDI_CAST(size_t, lap->n);
    const hdi_parts share = hdi_parts_of(rep);
    const double bound_b = rep->error_bound_b;
    hdi_ledger of_k = hdi_ledger_begin(rep->evidence_rational, rep->evidence_solver, rep->evidence_rounding, 0), of_d = of_k;
    hdi_parts part;
    int64_t q, p;
    memset(&part, 0, sizeof part);
    of_d.relative = 0;
    for (q = 0; q < n_pairs; q++) {
        const double *ui = U + n * HDI_CAST(size_t, place[2 * q]), *uj = U + n * HDI_CAST(size_t, place[2 * q + 1]);
        const int32_t ri = lap->row[i[q]], rj = lap->row[j[q]];
        const double size_i = hdi_vertex_norm(lap, ui, NULL, work, scale), size_j = hdi_vertex_norm(lap, uj, NULL, work, scale);
        double distance, off;
        if (K && kind == HD_DISTANCE_WEIGHTED) {
            K[q] = uj[i[q]];
            off = bound_b * size_j * (ri < 0 ? 0 : hdi_ratio_root(lap) / sqrt(lap->b_diag[ri]));
        } else if (K) {                          /* symmetric columns: K_t(i,j) = (k_t(i,.) B)_j, and |(B e)_j| <= sqrt(B_jj) |e|_B */
            K[q] = rj < 0 ? i[q] == j[q] : lap->B ? 0 : ui[j[q]] * lap->mass[rj];
            for (p = rj < 0 ? 0 : lap->L.row_ptr[rj]; rj >= 0 && lap->B && p < lap->L.row_ptr[rj + 1]; p++) K[q] += lap->B[p] * ui[lap->vertex[lap->L.col[p]]];
            off = bound_b * size_i * (rj < 0 ? 0 : sqrt(lap->b_diag[rj]));
        }
        if (K) {
            part.rounding = off + 8 * DBL_EPSILON * fabs(K[q]);
            hdi_ledger_note(&of_k, K[q], part);
        }
        if (!d) continue;
        distance = i[q] == j[q] ? 0 : hdi_vertex_norm(lap, ui, uj, work, scale);
        d[q] = distance;
        if (i[q] == j[q]) continue;
        part.rounding = (bound_b + 4 * DBL_EPSILON) * (size_i + size_j);
        rep->n_lost += distance < 10 * part.rounding;
        hdi_ledger_note(&of_d, distance, part);
    }
    rep->error_bound = rep->error_rational = rep->error_solver = rep->error_rounding = rep->error_relative = rep->smallest = 0;
    rep->error_bound_b = HUGE_VAL;
    rep->evidence_b = HD_EVIDENCE_NONE;
    hdi_parts_share(&of_k.off, &share);
    hdi_parts_share(&of_d.off, &share);
    hdi_ledger_close(&of_k, rep);
    rep->smallest = 0;                           /* of the distances */
    hdi_ledger_close(&of_d, rep);
}

/* Distances one by one from entries and the diagonal, for more vertices than columns fit; each is judged by itself. */
static hd_status hdi_pairs_distances(hd_heat *heat, hd_distance_kind kind, double t, int64_t n_pairs, const int32_t *i, const int32_t *j, double *d, hd_report *rep) {
    hd_error *e = &rep->error;
    hdi_scope s = hdi_scope_begin(heat->ctx, e);
    double *f = HDI_TAKE(&s, double, heat->source->n);
    hdi_ledger ledger;
    hdi_metric_column c;
    hdi_metric x;
    int64_t q;
    if (!f || hdi_metric_make(heat, kind, t, 0, &x, &s, rep) < 0) return hdi_scope_end(&s);
    rep->error_relative = 0;
    ledger = hdi_metric_ledger(&x);
    for (q = 0; q < n_pairs && e->status >= 0; q++) {   /* a column for each run of the same first vertex */
        if (q == 0 || i[q] != i[q - 1]) {
            hdi_ledger all = hdi_metric_ledger(&x);
            if (hdi_metric_columns(heat, &x, 1, i + q, f, HDI_CAST(size_t, heat->source->n), &c, rep, e) < 0) break;
            hdi_metric_distance(heat->source, &x, i[q], &c, NULL, rep, &all);
            ledger.off.rational = hdi_max(ledger.off.rational, all.off.rational);   /* of the pairs, as of all vertices */
            ledger.off.rounding = hdi_max(ledger.off.rounding, all.off.rounding);
            ledger.relative = hdi_max(ledger.relative, all.relative);
        }
        d[q] = f[j[q]];
        if (hdi_finite(d[q])) ledger.largest = hdi_max(ledger.largest, d[q]);
        if (d[q] > 0 && hdi_finite(d[q])) ledger.smallest = hdi_min(ledger.smallest, d[q]);
        ledger.n_values += i[q] != j[q] && hdi_finite(d[q]);
    }
    if (e->status >= 0) hdi_ledger_close(&ledger, rep);
    return hdi_scope_end(&s);
}

/* Both, each of which may be NULL, without columns in store. */
static hd_status hdi_pairs_by_entries(hd_heat *heat, hd_distance_kind kind, double t, int64_t n_pairs, const int32_t *i,
                                      const int32_t *j, double *K, double *d, hd_report *rep) {
    hdi_heat_call h;
    hdi_entry_list list;
    hd_report one;
    memset(rep, 0, sizeof *rep);
    hdi_error_clear(&rep->error);
    if (K && kind < HD_DISTANCE_COMMUTE) {
        if (hdi_kernel_begin(&h, heat, HD_KERNEL_OPERATOR, rep, NULL) < 0 || hdi_times_check(&h, 1, &t, 0) < 0) return hdi_heat_end(&h);
        list.values = K;
        (void)hdi_entry_list_make(&h, &list, n_pairs, i, j);
        if (hdi_heat_run(&h) < 0) return rep->status;
    }
    if (!d) return rep->status;
    memset(&one, 0, sizeof one);
    hdi_error_clear(&one.error);
    rep->error_relative = 0;                     /* of the distances */
    if (hdi_pairs_distances(heat, kind, t, n_pairs, i, j, d, &one) < 0) {
        rep->error = one.error;
        return rep->status = one.error.status;
    }
    hdi_report_merge(rep, &one);
    return rep->status;
}

/* Columns that are held at the same time: at most so many doubles, half a GiB. */
#define HDI_PAIRS_DOUBLES (INT64_C(1) << 26)

/* Pairs at time t; rep, cleared, gets the report. */
static hd_status hdi_pairs_once(hd_heat *heat, hd_distance_kind kind, double t, int64_t n_pairs, const int32_t *i, const int32_t *j,
                                double *K, double *d, hd_report *rep) {
    const hd_laplacian *lap = heat->source;
    hd_error e;
    hdi_scope s;
    hdi_heat_call h;
    hdi_pair *order;
    double *work, *U;
    int32_t *list, *place, n_list;
    hdi_error_clear(&e);
    s = hdi_scope_begin(heat->ctx, &e);
    order = HDI_TAKE(&s, hdi_pair, 2 * n_pairs);
    list = HDI_TAKE(&s, int32_t, 2 * n_pairs);
    place = HDI_TAKE(&s, int32_t, 2 * n_pairs);
    work = HDI_TAKE(&s, double, 2 * HDI_CAST(uint64_t, lap->n) + 1);
    n_list = e.status < 0 ? 0 : hdi_pairs_vertices(n_pairs, i, j, order, list, place);
    if (e.status >= 0 && (kind >= HD_DISTANCE_COMMUTE || HDI_CAST(int64_t, n_list) * lap->n > HDI_PAIRS_DOUBLES)) {
        hdi_scope_end(&s);
        return hdi_pairs_by_entries(heat, kind, t, n_pairs, i, j, K, d, rep);
    }
    U = HDI_TAKE(&s, double, HDI_CAST(uint64_t, lap->n) * HDI_CAST(uint64_t, n_list));
    if (hdi_kernel_begin(&h, heat, kind == HD_DISTANCE_WEIGHTED ? HD_KERNEL_OPERATOR : HD_KERNEL_SYMMETRIC, rep, NULL) < 0 ||
        hdi_times_check(&h, 1, &t, 0) < 0 || e.status < 0) {
        if (e.status < 0) *h.e = e;
        hdi_heat_end(&h);
    } else {
        h.ask.k = n_list;
        h.ask.sources = list;
        h.ask.U = U;
        h.ask.ldu = HDI_CAST(size_t, lap->n);
        if (hdi_heat_run(&h) >= 0) hdi_pairs_of_columns(lap, kind, heat->scale, U, n_pairs, i, j, place, K, d, work, rep);
    }
    hdi_scope_end(&s);
    return rep->status;
}

/* The pairs at all times of a call. */
static hd_status hdi_pairs_run(hdi_heat_call *h, hd_distance_kind kind, int64_t n_pairs, const int32_t *i, const int32_t *j, double *K,
                               double *d) {
    const int32_t n_times = kind >= HD_DISTANCE_COMMUTE ? 1 : h->ask.n_times;
    hd_report one;
    int32_t q;
    for (q = 0; q < n_times; q++) {
        const int64_t at = n_pairs * q;
        const double t = kind >= HD_DISTANCE_COMMUTE ? 0 : h->ask.t[q];
        if (hdi_pairs_once(h->heat, kind, t, n_pairs, i, j, K ? K + at : NULL, d ? d + at : NULL, &one) < 0) {
            *h->rep = one;
            if (n_times > 1) h->e->column = q;
            return h->e->status;
        }
        if (q == 0) *h->rep = one;
        else hdi_report_merge(h->rep, &one);
    }
    return h->e->status;
}

/* ---- farthest points ---- */

/* The vertex that is farthest from those chosen, the first of several; without mass never. */
static int32_t hdi_sample_next(const hd_laplacian *lap, const double *nearest) {
    int32_t v, best = -1;
    for (v = 0; v < lap->n; v++)
        if (lap->row[v] >= 0 && (best < 0 || nearest[v] > nearest[best])) best = v;
    return best;
}

/* Gonzalez 1985. */
static hd_status hdi_sample_run(hdi_heat_call *h, hd_distance_kind kind, double t, int32_t count, int32_t n_given, int32_t *vertex,
                                double *distance) {
    hd_heat *heat = h->heat;
    const hd_laplacian *lap = heat->source;
    const int settled = hdi_metric_settled(heat, kind);
    double *nearest = HDI_TAKE(&h->s, double, lap->n), *u = HDI_TAKE(&h->s, double, lap->n);
    hdi_metric x;
    hdi_metric_column c;
    hdi_ledger ledger;
    hd_report one;
    int32_t q, v;
    memset(&one, 0, sizeof one);
    if (h->e->status >= 0) (void)hdi_metric_make(heat, kind, t, settled ? 0 : HDI_RAT_KERNEL_MAX, &x, &h->s, &one);
    if (!settled && hdi_metric_retry(heat, h->e)) (void)hdi_metric_make(heat, kind, t, 0, &x, &h->s, &one);
    if (h->e->status < 0) return h->e->status;
    one.error_relative = 0;
    for (v = 0; v < lap->n; v++) nearest[v] = HUGE_VAL;
    for (q = 0; q < count && h->e->status >= 0; q++) {
        if (q >= n_given) vertex[q] = q == 0 ? lap->vertex[0] : hdi_sample_next(lap, nearest);
        if (distance) distance[q] = q == 0 ? 0 : hdi_max(0, nearest[vertex[q]]);
        if (q + 1 == count || hdi_progress(heat->ctx, "sample", HDI_CAST(double, q) / count, h->e) < 0) break;
        if (hdi_metric_columns(heat, &x, 1, vertex + q, u, HDI_CAST(size_t, lap->n), &c, &one, h->e) < 0) break;
        ledger = hdi_metric_ledger(&x);
        hdi_metric_distance(lap, &x, vertex[q], &c, NULL, &one, &ledger);
        hdi_ledger_close(&ledger, &one);
        for (v = 0; v < lap->n; v++) nearest[v] = hdi_min(nearest[v], u[v]);
        nearest[vertex[q]] = -1;                 /* not again, even when no distance is left */
    }
    one.error = *h->e;
    *h->rep = one;
    return h->e->status;
}

/* ==== [28] geodesic ====
 * Geodesic distance by the heat method on triangle meshes. May call [18].
 * This work is based on
 *   K. Crane, C. Weischedel, M. Wardetzky, Geodesics in heat: a new approach to computing distance based on heat flow, 2013
 * Three steps: (B + t L) u = the indicator of the sources; X = -grad u / |grad u| on every face; L phi = div X, where phi is the distance but for a constant.
 * Deviations:
 *   L has one row taken out for each component, which is exact, instead of a small number added to its diagonal, which tilts phi on large meshes.
 *   X follows |u|. Where cotangents are negative u can be so too, here and there far from the sources, and with its sign would point the wrong way.
 *   Heat far away is smaller than any double. What has faded is solved for again from where it still could be told (hdi_geo_further), so that
 *   distances do not end where u underflows.
 *   A face is kept as its triangle in the plane: corners (0,0), (2l,0), (2p,2q), and everything is written in l, p, q: no cotangents, no cancellation. */

typedef struct hdi_geo_face { double l, p, q; int32_t v[3], spare; } hdi_geo_face;   /* lengths in units of h; v in elimination order, the longest edge first */

enum { HDI_GEO_WIDE = 8, HDI_GEO_WIDE_FROM = 3 };

struct hd_geodesic {
    hd_context *ctx, context;
    int32_t n, n_active, n_faces, n_components;
    double h, t;
    hdi_symbolic sym;
    hdi_factor heat, poisson;    /* of L + B/t, and of L with the rows pin replaced by those of the identity */
    hdi_geo_face *face;          /* [n_faces] in elimination order of their first corner to go */
    double *mass;                /* [n_active] diagonal of B/t, from here on all in elimination order */
    int32_t *row;                /* [n] vertex -> row, -1 without mass */
    int32_t *component;          /* [n_active] */
    int32_t *pin;                /* [n_components] the last row of each */
    char *active;                /* [n_super] fronts that the sources touch */
    char *reached;               /* [n_components] has a source */
    char *mark;                  /* [n_active] sources; how far the heat could be told */
    double *x, *b, *r, *work;    /* [n_active] each; sweeps */
    double *wide_x, *wide_b, *wide_work;   /* the same for eight columns side by side, made when they are first needed */
    int64_t *value_ptr;          /* [n_components + 1] */
    double *value;               /* [value_size] of phi at the sources, by component, ascending */
    hdi_pair *sorted;            /* [value_size] */
    int32_t value_size;
    int64_t n_staged;            /* fronts that all stages after the first ones went to, so far */
};

/* ---- making ---- */

static void hdi_geo_free(hd_geodesic *g) {
    hd_context own, *ctx;
    if (!g) return;
    own = g->context;
    ctx = g->ctx == &g->context ? &own : g->ctx;
    g->heat.ctx = g->heat.ctx ? ctx : NULL;
    g->poisson.ctx = g->poisson.ctx ? ctx : NULL;
    hdi_factor_free(&g->heat);
    hdi_factor_free(&g->poisson);
    hdi_symbolic_free(ctx, &g->sym);
    hdi_free(ctx, g->face);
    hdi_free(ctx, g->mass);
    hdi_free(ctx, g->row);
    hdi_free(ctx, g->component);
    hdi_free(ctx, g->pin);
    hdi_free(ctx, g->active);
    hdi_free(ctx, g->reached);
    hdi_free(ctx, g->mark);
    hdi_free(ctx, g->x);
    hdi_free(ctx, g->b);
    hdi_free(ctx, g->r);
    hdi_free(ctx, g->work);
    hdi_free(ctx, g->wide_x);
    hdi_free(ctx, g->wide_b);
    hdi_free(ctx, g->wide_work);
    hdi_free(ctx, g->value_ptr);
    hdi_free(ctx, g->value);
    hdi_free(ctx, g->sorted);
    hdi_free(ctx, g);
}

/* Face f in its plane, the longest edge on the axis: the height is then as small as it gets, and loses nothing. */
static hdi_geo_face hdi_geo_frame(const hdi_mesh *mesh, int32_t f, const int32_t *row, double h) {
    const int32_t *v = mesh->tri + 3 * HDI_CAST(int64_t, f);
    double edge[3][3], length[3];
    hdi_geo_face out;
    int i, q, k = 0;
    for (q = 0; q < 3; q++) {                    /* edge q leaves corner q */
        hdi_sub3(mesh->xyz + 3 * HDI_CAST(int64_t, v[(q + 1) % 3]), mesh->xyz + 3 * HDI_CAST(int64_t, v[q]), edge[q]);
        for (i = 0; i < 3; i++) edge[q][i] /= h;
        length[q] = hdi_norm3(edge[q]);
        if (length[q] > length[k]) k = q;
    }
    out.l = length[k] / 2;
    out.p = -hdi_dot3(edge[k], edge[(k + 2) % 3]) / length[k] / 2;
    out.q = mesh->area[f] / h / h / length[k];   /* half the height */
    for (q = 0; q < 3; q++) out.v[q] = row[v[(k + q) % 3]];
    out.spare = 0;
    return out;
}

static int32_t hdi_geo_first(const int32_t *v, const int32_t *row) {
    const int32_t a = row[v[0]], b = row[v[1]], c = row[v[2]], d = a < b ? a : b;
    return c < d ? c : d;
}

/* The faces with an area, sorted by the first of their corners to be eliminated, so that passes over them run through the vectors once. */
static hd_status hdi_geo_faces(hd_geodesic *g, const hdi_mesh *mesh, hd_error *e) {
    hdi_scope s = hdi_scope_begin(g->ctx, e);
    int64_t *at = HDI_TAKE_ZERO(&s, int64_t, HDI_CAST(int64_t, g->n_active) + 1);
    int32_t f;
    g->face = HDI_CAST(hdi_geo_face *, at ? hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n_faces), sizeof *g->face, e) : NULL);
    if (!g->face) return hdi_scope_end(&s);
    for (f = 0; f < mesh->m; f++)
        if (mesh->area[f] > 0) at[hdi_geo_first(mesh->tri + 3 * HDI_CAST(int64_t, f), g->row)]++;
    hdi_prefix_sum(at, g->n_active);
    for (f = 0; f < mesh->m; f++)
        if (mesh->area[f] > 0) g->face[at[hdi_geo_first(mesh->tri + 3 * HDI_CAST(int64_t, f), g->row)]++] = hdi_geo_frame(mesh, f, g->row, g->h);
    return hdi_scope_end(&s);
}

/* What is per row, in elimination order. */
static hd_status hdi_geo_rows(hd_geodesic *g, const hd_laplacian *lap, hd_error *e) {
    int32_t i, v;
    g->mass = HDI_CAST(double *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n_active), sizeof(double), e));
    if (g->mass) g->row = HDI_CAST(int32_t *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n), sizeof(int32_t), e));
    if (g->row) g->component = HDI_CAST(int32_t *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n_active), sizeof(int32_t), e));
    if (g->component) g->pin = HDI_CAST(int32_t *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n_components), sizeof(int32_t), e));
    if (e->status < 0) return e->status;
    for (v = 0; v < g->n; v++) g->row[v] = -1;
    for (i = 0; i < g->n_active; i++) {
        const int32_t from = g->sym.perm[i];
        g->row[lap->vertex[from]] = i;
        g->component[i] = lap->component[from];
        g->pin[g->component[i]] = i;
        g->mass[i] = lap->mass[from] / g->t;
        if (!hdi_finite(g->mass[i])) return hdi_fail_face(e, HD_ERR_ARGUMENT, "geodesic: t is too small for the mesh", -1, lap->vertex[from], g->t);
    }
    return HD_OK;
}

/* Factors the matrix val; what only factoring needs is given back. */
static hd_status hdi_geo_factor(hd_geodesic *g, hdi_factor *f, const hd_laplacian *lap, const double *val, hd_error *e) {
    hdi_values v;
    memset(&v, 0, sizeof v);
    v.real = val;
    if (hdi_factor_make(f, &g->sym, 1, g->ctx, e) < 0) return e->status;
    if (hdi_factor_run(f, &v, e) < 0) {
        if (e->row >= 0) e->vertex = lap->vertex[e->row];
        e->row = -1;
        return e->status;
    }
    hdi_free(g->ctx, f->work);
    hdi_free(g->ctx, f->scratch);
    hdi_free(g->ctx, f->chunk_scratch);
    f->work = f->scratch = f->chunk_scratch = NULL;
    return HD_OK;
}

/* L + B/t, then L with the row and column of one vertex of each component replaced by those of the identity: phi is zero there. */
static hd_status hdi_geo_factors(hd_geodesic *g, const hd_laplacian *lap, hd_error *e) {
    hdi_scope s = hdi_scope_begin(g->ctx, e);
    double *val = HDI_TAKE(&s, double, lap->L.nnz);
    int32_t i, k;
    int64_t p;
    if (!val) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) val[p] = lap->L.val[p] + (lap->L.col[p] == i ? lap->mass[i] / g->t : 0);
    if (hdi_geo_factor(g, &g->heat, lap, val, e) < 0) return hdi_scope_end(&s);
    for (i = 0; i < lap->n_active; i++) {
        const int32_t row = g->row[lap->vertex[i]], pin = g->pin[lap->component[i]];
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            k = g->row[lap->vertex[lap->L.col[p]]];
            val[p] = row == pin || k == pin ? row == k : lap->L.val[p];
        }
    }
    (void)hdi_geo_factor(g, &g->poisson, lap, val, e);
    return hdi_scope_end(&s);
}

static hd_status hdi_geo_room(hd_geodesic *g, hd_error *e) {
    const uint64_t n = HDI_CAST(uint64_t, g->n_active);
    g->active = HDI_CAST(char *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->sym.n_super), 1, e));
    if (g->active) g->reached = HDI_CAST(char *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n_components), 1, e));
    if (g->reached) g->mark = HDI_CAST(char *, hdi_alloc(g->ctx, n, 1, e));
    if (g->mark) g->value_ptr = HDI_CAST(int64_t *, hdi_alloc(g->ctx, HDI_CAST(uint64_t, g->n_components) + 1, sizeof(int64_t), e));
    if (g->value_ptr) g->x = HDI_CAST(double *, hdi_alloc(g->ctx, n, sizeof(double), e));
    if (g->x) g->b = HDI_CAST(double *, hdi_alloc(g->ctx, n, sizeof(double), e));
    if (g->b) g->r = HDI_CAST(double *, hdi_alloc(g->ctx, n, sizeof(double), e));
    if (g->r) g->work = HDI_CAST(double *, hdi_alloc(g->ctx, hdi_sweep_size(&g->sym, 1, 1, 1), sizeof(double), e));
    return e->status;
}

/* Ordering, analysis and both factors. */
static hd_status hdi_geo_analyse(hd_geodesic *g, const hd_laplacian *lap, const hd_geodesic_opts *o, hd_error *e) {
    hdi_scope s = hdi_scope_begin(g->ctx, e);
    int32_t *perm = HDI_TAKE(&s, int32_t, lap->n_active), *own = HDI_TAKE(&s, int32_t, lap->n_active), chosen = 0;
    if (e->status < 0) return hdi_scope_end(&s);
    if (o->ordering == HD_ORDERING_OWN) hdi_elim_own(lap, o->perm, own);
    if (hdi_sym_order(&lap->L, lap->xyz, o->ordering, HDI_DISSECT_FROM, own, perm, &chosen, g->ctx, e) < 0) return hdi_scope_end(&s);
    if (hdi_progress(g->ctx, "analyse", 0, e) >= 0) (void)hdi_symbolic_make(&g->sym, &lap->L, perm, g->ctx, e);
    g->sym.ordering = HDI_CAST(hd_ordering, chosen);
    return hdi_scope_end(&s);
}

static hd_status hdi_geo_make(hd_geodesic *g, const double *xyz, const int32_t *tri, int32_t m, const hd_geodesic_opts *o, hd_error *e) {
    hdi_scope s = hdi_scope_begin(g->ctx, e);
    hd_laplacian *lap = HDI_CAST(hd_laplacian *, hdi_alloc(g->ctx, 1, sizeof *lap, e));
    hdi_mesh mesh;
    if (!lap) return hdi_scope_end(&s);
    hdi_mesh_clear(&mesh, xyz, g->n, tri, m);
    memset(lap, 0, sizeof *lap);
    lap->n = g->n;
    lap->context = g->ctx;
    lap->kind = o->mass == HD_GEODESIC_MASS_VORONOI ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM;   /* the row sums of fem are the lumped mass */
    if (hdi_progress(g->ctx, "assemble", 0, e) >= 0 && hdi_lap_mesh(lap, &mesh, 0, &s) >= 0) {
        g->n_active = lap->n_active;
        g->n_components = lap->n_components;
        g->n_faces = lap->mesh.n_faces_used;
        g->h = lap->h;
        g->t = o->t > 0 ? o->t : lap->h * lap->h;
        if (!hdi_finite(g->t) || !(g->t > 0)) hdi_fail_row(e, HD_ERR_ARGUMENT, "geodesic: the square of the mean edge length is no number to compute with", -1, -1, lap->h);
    }
    if (e->status >= 0 && hdi_geo_analyse(g, lap, o, e) >= 0 && hdi_geo_rows(g, lap, e) >= 0 && hdi_geo_faces(g, &mesh, e) >= 0) {
        hdi_scope_end(&s);                       /* the mesh is not needed any more */
        if (hdi_geo_factors(g, lap, e) >= 0) (void)hdi_geo_room(g, e);
    }
    hdi_laplacian_free(lap, g->ctx);
    return hdi_scope_end(&s);
}

/* ---- passes over the faces ---- */

/* What -grad |u| / |grad |u|| of a face adds to div X: g[1], g[2] at corners 1 and 2, minus their sum at corner 0. Without heat above least, or without a slope
 * beyond rounding (where fronts of symmetric meshes meet, rounding would choose a side), nothing. Returns the largest |u|, by which u is normalised before
 * anything is squared. */
static HDI_INLINE double hdi_geo_flow(const hdi_geo_face *f, double u0, double u1, double u2, double least, double *g) {
    const double a0 = fabs(u0), a1 = fabs(u1), a2 = fabs(u2), m = hdi_max(hdi_max(a0, a1), a2), s = m >= least ? 1 / m : 0;
    const double d1 = (a1 - a0) * s, d2 = (a2 - a0) * s;
    const double x = f->q * d1, y = f->l * d2 - f->p * d1;   /* grad u times the area */
    const double norm2 = x * x + y * y, w = norm2 > 1e-26 * f->l * f->l ? -1 / sqrt(norm2) : 0;
    g[1] = (f->q * x - f->p * y) * w;
    g[2] = f->l * y * w;
    return m;
}

/* b = div X, integrated against the hat functions: the right-hand side of L phi = b. Returns how many faces have some heat, but less than least. */
static int64_t hdi_geo_divergence(const hd_geodesic *g, const double *HDI_RESTRICT u, double least, double *HDI_RESTRICT b) {
    int64_t faint = 0;
    int32_t f;
    memset(b, 0, HDI_CAST(size_t, g->n_active) * sizeof *b);
    for (f = 0; f < g->n_faces; f++) {
        const hdi_geo_face *a = g->face + f;
        double d[3];
        const double m = hdi_geo_flow(a, u[a->v[0]], u[a->v[1]], u[a->v[2]], least, d);
        faint += m < least && m > 0;
        b[a->v[0]] -= d[1] + d[2];
        b[a->v[1]] += d[1];
        b[a->v[2]] += d[2];
    }
    return faint;
}

/* The same for eight columns side by side. Returns the columns with faint faces as bits. */
static int hdi_geo_divergence8_plain(const hd_geodesic *g, const double *HDI_RESTRICT u, const double *HDI_RESTRICT least, double *HDI_RESTRICT b) {
    int32_t f, c;
    int faint = 0;
    for (f = 0; f < g->n_faces; f++) {
        const hdi_geo_face *a = g->face + f;
        const int64_t i = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[0]), j = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[1]), k = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[2]);
        for (c = 0; c < HDI_GEO_WIDE; c++) {
            double d[3];
            const double m = hdi_geo_flow(a, u[i + c], u[j + c], u[k + c], least[c], d);
            faint |= (m < least[c] && m > 0) << c;
            b[i + c] -= d[1] + d[2];
            b[j + c] += d[1];
            b[k + c] += d[2];
        }
    }
    return faint;
}

#if HDI_X86
/* hdi_geo_flow, four or eight columns at a time. */
static HDI_AVX2 int hdi_geo_divergence8_256(const hd_geodesic *g, const double *u, const double *least, double *b) {
    const hdi_v4 zero = _mm256_setzero_pd(), one = _mm256_set1_pd(1), minus = _mm256_set1_pd(-1), sign = _mm256_set1_pd(-0.0);
    int32_t f, c;
    int faint = 0;
    for (f = 0; f < g->n_faces; f++) {
        const hdi_geo_face *a = g->face + f;
        const int64_t i = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[0]), j = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[1]), k = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[2]);
        const hdi_v4 l = _mm256_set1_pd(a->l), p = _mm256_set1_pd(a->p), q = _mm256_set1_pd(a->q), flat = _mm256_set1_pd(1e-26 * a->l * a->l);
        for (c = 0; c < HDI_GEO_WIDE; c += 4) {
            const hdi_v4 u0 = _mm256_andnot_pd(sign, _mm256_loadu_pd(u + i + c)), u1 = _mm256_andnot_pd(sign, _mm256_loadu_pd(u + j + c));
            const hdi_v4 u2 = _mm256_andnot_pd(sign, _mm256_loadu_pd(u + k + c)), m = _mm256_max_pd(_mm256_max_pd(u0, u1), u2);
            const hdi_v4 lit = _mm256_cmp_pd(m, _mm256_loadu_pd(least + c), _CMP_GE_OQ);
            const hdi_v4 s = _mm256_and_pd(lit, _mm256_div_pd(one, _mm256_blendv_pd(one, m, lit)));
            const hdi_v4 d1 = _mm256_mul_pd(_mm256_sub_pd(u1, u0), s), d2 = _mm256_mul_pd(_mm256_sub_pd(u2, u0), s);
            const hdi_v4 x = _mm256_mul_pd(q, d1), y = _mm256_fmsub_pd(l, d2, _mm256_mul_pd(p, d1)), norm2 = _mm256_fmadd_pd(x, x, _mm256_mul_pd(y, y));
            const hdi_v4 slope = _mm256_cmp_pd(norm2, flat, _CMP_GT_OQ);
            const hdi_v4 length = _mm256_sqrt_pd(_mm256_blendv_pd(one, norm2, slope));
            const hdi_v4 w = _mm256_and_pd(slope, _mm256_div_pd(minus, length));
            const hdi_v4 g1 = _mm256_mul_pd(_mm256_fmsub_pd(q, x, _mm256_mul_pd(p, y)), w), g2 = _mm256_mul_pd(_mm256_mul_pd(l, y), w);
            faint |= (_mm256_movemask_pd(_mm256_cmp_pd(m, zero, _CMP_GT_OQ)) & ~_mm256_movemask_pd(lit)) << c;
            _mm256_storeu_pd(b + i + c, _mm256_sub_pd(_mm256_loadu_pd(b + i + c), _mm256_add_pd(g1, g2)));
            _mm256_storeu_pd(b + j + c, _mm256_add_pd(_mm256_loadu_pd(b + j + c), g1));
            _mm256_storeu_pd(b + k + c, _mm256_add_pd(_mm256_loadu_pd(b + k + c), g2));
        }
    }
    return faint;
}

static HDI_AVX512 int hdi_geo_divergence8_512(const hd_geodesic *g, const double *u, const double *least, double *b) {
    const hdi_v8 zero = _mm512_setzero_pd(), one = _mm512_set1_pd(1), minus = _mm512_set1_pd(-1), sign = _mm512_set1_pd(-0.0), low = _mm512_loadu_pd(least);
    int32_t f;
    int faint = 0;
    for (f = 0; f < g->n_faces; f++) {
        const hdi_geo_face *a = g->face + f;
        const int64_t i = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[0]), j = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[1]), k = HDI_GEO_WIDE * HDI_CAST(int64_t, a->v[2]);
        const hdi_v8 l = _mm512_set1_pd(a->l), p = _mm512_set1_pd(a->p), q = _mm512_set1_pd(a->q);
        const hdi_v8 u0 = _mm512_andnot_pd(sign, _mm512_loadu_pd(u + i)), u1 = _mm512_andnot_pd(sign, _mm512_loadu_pd(u + j));
        const hdi_v8 u2 = _mm512_andnot_pd(sign, _mm512_loadu_pd(u + k)), m = _mm512_max_pd(_mm512_max_pd(u0, u1), u2);
        const __mmask8 lit = _mm512_cmp_pd_mask(m, low, _CMP_GE_OQ);
        const hdi_v8 s = _mm512_maskz_div_pd(lit, one, m);
        const hdi_v8 d1 = _mm512_mul_pd(_mm512_sub_pd(u1, u0), s), d2 = _mm512_mul_pd(_mm512_sub_pd(u2, u0), s);
        const hdi_v8 x = _mm512_mul_pd(q, d1), y = _mm512_fmsub_pd(l, d2, _mm512_mul_pd(p, d1)), norm2 = _mm512_fmadd_pd(x, x, _mm512_mul_pd(y, y));
        const __mmask8 slope = _mm512_cmp_pd_mask(norm2, _mm512_set1_pd(1e-26 * a->l * a->l), _CMP_GT_OQ);
        const hdi_v8 w = _mm512_maskz_div_pd(slope, minus, _mm512_sqrt_pd(norm2));
        const hdi_v8 g1 = _mm512_mul_pd(_mm512_fmsub_pd(q, x, _mm512_mul_pd(p, y)), w), g2 = _mm512_mul_pd(_mm512_mul_pd(l, y), w);
        faint |= _mm512_cmp_pd_mask(m, zero, _CMP_GT_OQ) & ~lit;
        _mm512_storeu_pd(b + i, _mm512_sub_pd(_mm512_loadu_pd(b + i), _mm512_add_pd(g1, g2)));
        _mm512_storeu_pd(b + j, _mm512_add_pd(_mm512_loadu_pd(b + j), g1));
        _mm512_storeu_pd(b + k, _mm512_add_pd(_mm512_loadu_pd(b + k), g2));
    }
    return faint;
}
#endif

static int hdi_geo_divergence8(const hd_geodesic *g, const double *u, const double *least, double *b) {
    const int level = hdi_simd_level(g->ctx);
    memset(b, 0, HDI_GEO_WIDE * HDI_CAST(size_t, g->n_active) * sizeof *b);
#if HDI_X86
    if (level >= 2) return hdi_geo_divergence8_512(g, u, least, b);
    if (level == 1) return hdi_geo_divergence8_256(g, u, least, b);
#endif
    (void)level;
    return hdi_geo_divergence8_plain(g, u, least, b);
}

/* r -= L x */
static void hdi_geo_subtract(const hd_geodesic *g, const double *HDI_RESTRICT x, double *HDI_RESTRICT r) {
    int32_t f;
    for (f = 0; f < g->n_faces; f++) {
        const hdi_geo_face *a = g->face + f;
        const double d1 = x[a->v[1]] - x[a->v[0]], d2 = x[a->v[2]] - x[a->v[0]];
        const double gx = d1 / (2 * a->l), gy = (d2 - a->p / a->l * d1) / (2 * a->q);    /* grad x */
        const double g1 = a->q * gx - a->p * gy, g2 = a->l * gy;
        r[a->v[0]] += g1 + g2;
        r[a->v[1]] -= g1;
        r[a->v[2]] -= g2;
    }
}

/* ---- heat beyond what a double can hold ---- */
/* u falls by about a factor of e over a distance of sqrt(t), and at t = h^2 it is gone after some 700 edges. Let S be where it could be told, and u' = u
 * beyond S, 0 on it. Then A u' = f, A = L + B/t, is zero but for the rows along the border of S, and there it is known: f_i = sum over j beyond of A_ij u_j for i in
 * S, f_j = -sum over i in S of A_ij u_i beyond. Solved with f scaled to one, the same u goes on, as far again as before. Only directions are wanted,
 * so that the scale is of no interest. A face belongs to the first stage that tells one of its corners.
 * A stage costs what it touches, so that a long strip costs in proportion to its length: the faces around the
 * rows just told; forward, the fronts on the ways from the border towards the root, as far as they have
 * something to hand on; backward, those that heat beyond S comes to from above. u' is 0 on S, and fades. */

static const double hdi_geo_faint = 1e-200;      /* of the largest u: below, doubles are soon at their end */
enum { HDI_GEO_BEYOND = 0, HDI_GEO_EARLIER = 1, HDI_GEO_NOW = 2 };

/* g->x is zero but for the pivots of front, g->r is zero between stages, and so is g->active. */
typedef struct hdi_geo_far {
    hd_geodesic *g;
    int64_t *around_ptr;         /* [n_active + 1] */
    int32_t *around;             /* [3 n_faces] faces around each row */
    int32_t *told;               /* [n_active] rows in the order in which they are told, */
    int32_t n_told, now;         /* those of this stage from now on */
    int32_t *front, n_fronts;    /* [n_super] */
    int32_t *end, n_ends;        /* [n_super] where the way up ends, ascending */
    hdi_pair *open;              /* [n_super] fronts to go to: forward a heap, backward a stack */
    int32_t n_open;
} hdi_geo_far;

static hd_status hdi_geo_far_begin(hdi_geo_far *w, hd_geodesic *g, hdi_scope *s) {
    const size_t n = HDI_CAST(size_t, g->n_active), n_super = HDI_CAST(size_t, g->sym.n_super);
    int32_t f, i;
    int q;
    memset(w, 0, sizeof *w);
    w->g = g;
    w->around_ptr = HDI_TAKE_ZERO(s, int64_t, n + 1);
    w->around = HDI_TAKE(s, int32_t, 3 * HDI_CAST(int64_t, g->n_faces));
    w->told = HDI_TAKE(s, int32_t, n);
    w->front = HDI_TAKE(s, int32_t, n_super);
    w->end = HDI_TAKE(s, int32_t, n_super);
    w->open = HDI_TAKE(s, hdi_pair, n_super);
    if (s->e->status < 0) return s->e->status;
    for (f = 0; f < g->n_faces; f++)
        for (q = 0; q < 3; q++) w->around_ptr[g->face[f].v[q]]++;
    hdi_prefix_sum(w->around_ptr, g->n_active);
    for (f = 0; f < g->n_faces; f++)
        for (q = 0; q < 3; q++) w->around[w->around_ptr[g->face[f].v[q]]++] = f;
    for (i = g->n_active; i > 0; i--) w->around_ptr[i] = w->around_ptr[i - 1];
    w->around_ptr[0] = 0;
    for (w->n_fronts = 0; w->n_fronts < g->sym.n_super; w->n_fronts++) w->front[w->n_fronts] = w->n_fronts;
    memset(g->mark, HDI_GEO_BEYOND, n);
    memset(g->active, 0, n_super);
    memset(g->r, 0, n * sizeof *g->r);
    return HD_OK;
}

/* Marks what u tells, of the rows beyond. */
static void hdi_geo_tell(hdi_geo_far *w, double least) {
    const hd_geodesic *g = w->g;
    int32_t k, i;
    for (; w->now < w->n_told; w->now++) g->mark[w->told[w->now]] = HDI_GEO_EARLIER;
    for (k = 0; k < w->n_fronts; k++)
        for (i = g->sym.super[w->front[k]]; i < g->sym.super[w->front[k] + 1]; i++) {
            if (g->mark[i] != HDI_GEO_BEYOND || !(fabs(g->x[i]) >= least)) continue;
            g->mark[i] = HDI_GEO_NOW;
            w->told[w->n_told++] = i;
        }
}

/* The largest |u| beyond. */
static double hdi_geo_largest(const hdi_geo_far *w) {
    const hd_geodesic *g = w->g;
    double most = 0;
    int32_t k, i;
    for (k = 0; k < w->n_fronts; k++)
        for (i = g->sym.super[w->front[k]]; i < g->sym.super[w->front[k] + 1]; i++)
            if (g->mark[i] == HDI_GEO_BEYOND) most = hdi_max(most, fabs(g->x[i]));
    return most;
}

/* Whether row i is the first corner of a face that is told now: each face is visited from one corner. */
static int hdi_geo_visit(const hd_geodesic *g, const hdi_geo_face *a, int32_t i) {
    int q = 0;
    while (g->mark[a->v[q]] != HDI_GEO_NOW) q++;
    return a->v[q] == i;
}

/* Forward, tasks come before the top: the vectors of its fronts take the room that theirs leave. */
static void hdi_geo_open(hdi_geo_far *w, int32_t v) {
    const hdi_symbolic *s = &w->g->sym;
    const uint64_t place = HDI_CAST(uint64_t, v) + (s->task_of[v] < 0 ? HDI_CAST(uint64_t, s->n_super) : 0);
    int64_t i = w->n_open, up;
    hdi_pair x;
    if (w->g->active[v]) return;
    w->g->active[v] = 1;
    w->n_open++;
    x.key = ~place;
    x.id = v;
    for (; i > 0 && hdi_pair_less(w->open + (up = (i - 1) / 2), &x); i = up) w->open[i] = w->open[up];
    w->open[i] = x;
}

/* f along the border of what is told, into g->r, with its fronts opened. */
static void hdi_geo_border(hdi_geo_far *w) {
    const hd_geodesic *g = w->g;
    int64_t p;
    int32_t n;
    int q;
    for (n = w->now; n < w->n_told; n++)
        for (p = w->around_ptr[w->told[n]]; p < w->around_ptr[w->told[n] + 1]; p++) {
            const hdi_geo_face *a = g->face + w->around[p];
            double weight[3];                    /* of L, of the edge opposite to a corner: -cot/2 */
            if (g->mark[a->v[0]] && g->mark[a->v[1]] && g->mark[a->v[2]]) continue;
            if (!hdi_geo_visit(g, a, w->told[n])) continue;
            weight[0] = -a->p / a->q / 2;
            weight[1] = -(a->l - a->p) / a->q / 2;
            weight[2] = -(a->q / a->l - a->p / a->l * ((a->l - a->p) / a->q)) / 2;
            for (q = 0; q < 3; q++) {
                const int32_t j = a->v[(q + 1) % 3], k = a->v[(q + 2) % 3];
                const int32_t in = g->mark[j] ? j : k, out = g->mark[j] ? k : j;
                if (g->mark[in] != HDI_GEO_NOW || g->mark[out] != HDI_GEO_BEYOND) continue;
                g->r[in] += weight[q] * g->x[out];
                g->r[out] -= weight[q] * g->x[in];
                hdi_geo_open(w, g->sym.super_of[in]);
                hdi_geo_open(w, g->sym.super_of[out]);
            }
        }
}

/* The largest |f|, which then becomes 1. 0: there is no border, or none with numbers to compute with. */
static int hdi_geo_scale(const hdi_geo_far *w) {
    const hd_geodesic *g = w->g;
    double most = 0;
    const int32_t *super = g->sym.super;
    int32_t k, i;
    for (k = 0; k < w->n_open; k++)
        for (i = super[w->open[k].id]; i < super[w->open[k].id + 1]; i++) most = hdi_max(most, fabs(g->r[i]));
    if (!(most > DBL_MIN)) return 0;
    for (k = 0; k < w->n_open; k++)
        for (i = super[w->open[k].id]; i < super[w->open[k].id + 1]; i++) g->r[i] /= most;
    return 1;
}

/* From the open fronts upwards, as long as a front has something to hand on. */
static void hdi_geo_forward(hdi_geo_far *w, const hdi_sweep *z) {
    const hdi_symbolic *s = &w->g->sym;
    w->n_ends = 0;
    while (w->n_open > 0) {
        const int32_t v = HDI_CAST(int32_t, w->open[0].id);
        const double *up = z->vec + s->vector[v];
        const int64_t below = hdi_front_below(s, v);
        int64_t i = 0;
        w->open[0] = w->open[--w->n_open];
        if (w->n_open > 0) hdi_sift_down(w->open, 0, w->n_open);
        hdi_sweep_front(z, v, 0);
        while (i < below && !(fabs(up[i]) >= DBL_MIN)) i++;
        if (i < below) hdi_geo_open(w, s->parent[v]);
        else w->end[w->n_ends++] = v;
    }
}

/* Whether a front that nothing came to forward has heat: from its rows above, of those beyond. */
static int hdi_geo_warm(const hd_geodesic *g, int32_t v) {
    int64_t p;
    for (p = g->sym.row_ptr[v]; p < g->sym.row_ptr[v + 1]; p++)
        if (g->mark[g->sym.row[p]] == HDI_GEO_BEYOND && fabs(g->x[g->sym.row[p]]) >= DBL_MIN) return 1;
    return 0;
}

/* From the ends of the way up down again, the highest first: an end with another one above it may have got
 * heat from there, by fronts that nothing came to forward. */
static void hdi_geo_backward(hdi_geo_far *w, const hdi_sweep *z) {
    const hdi_symbolic *s = &w->g->sym;
    int32_t k;
    w->n_fronts = 0;
    while (w->n_ends > 0) {
        const int32_t end = w->end[--w->n_ends];
        if (s->parent[end] >= 0 && w->g->active[s->parent[end]]) continue;   /* comes with it, or did */
        w->open[w->n_open++].id = end;
        while (w->n_open > 0) {
            const int32_t v = HDI_CAST(int32_t, w->open[--w->n_open].id);
            hdi_sweep_front(z, v, 0);
            w->g->active[v] = 1;
            w->front[w->n_fronts++] = v;
            for (k = s->kid_ptr[v]; k < s->kid_ptr[v + 1]; k++) {
                const int32_t kid = s->kid[k];
                if (w->g->active[kid] || hdi_geo_warm(w->g, kid)) w->open[w->n_open++].id = kid;
            }
        }
    }
}

/* g->x = A^-1 f, f in g->r, where it matters. What was in g->x goes. */
static void hdi_geo_stage(hdi_geo_far *w) {
    hd_geodesic *g = w->g;
    const int32_t *super = g->sym.super;
    double *swap = g->x;
    hdi_sweep z;
    int32_t k;
    for (k = 0; k < w->n_fronts; k++) {
        const int32_t v = w->front[k];
        memset(g->x + super[v], 0, HDI_CAST(size_t, super[v + 1] - super[v]) * sizeof *g->x);
    }
    g->x = g->r;
    g->r = swap;
    z = hdi_sweep_open(&g->heat, 1, g->x, g->work, 1);
    z.active = g->active;
    hdi_geo_forward(w, &z);
    z.backward = 1;
    hdi_geo_backward(w, &z);
    for (k = 0; k < w->n_fronts; k++) g->active[w->front[k]] = 0;
    g->n_staged += w->n_fronts;
}

/* div X of the faces of which nothing was told before this stage. */
static void hdi_geo_divergence_now(const hdi_geo_far *w, double least) {
    const hd_geodesic *g = w->g;
    int32_t n;
    int64_t p;
    for (n = w->now; n < w->n_told; n++)
        for (p = w->around_ptr[w->told[n]]; p < w->around_ptr[w->told[n] + 1]; p++) {
            const hdi_geo_face *a = g->face + w->around[p];
            const int32_t i = a->v[0], j = a->v[1], k = a->v[2];
            double d[3];
            if (g->mark[i] == HDI_GEO_EARLIER || g->mark[j] == HDI_GEO_EARLIER) continue;
            if (g->mark[k] == HDI_GEO_EARLIER || !hdi_geo_visit(g, a, w->told[n])) continue;
            (void)hdi_geo_flow(a, g->x[i], g->x[j], g->x[k], least, d);
            g->b[i] -= d[1] + d[2];
            g->b[j] += d[1];
            g->b[k] += d[2];
        }
}

static void hdi_geo_sweep(const hd_geodesic *g, const hdi_factor *f, int32_t k, double *x, const char *active) {
    hdi_sweep z = hdi_sweep_open(f, k, x, k == 1 ? g->work : g->wide_work, 1);
    z.active = active;
    hdi_sweep_run(&z, g->ctx);
}

/* Adds to b what lies beyond u >= least, stage by stage. u is in g->x. Where heat ends for good (no more of the component, weights of zero), the rest has no direction. */
static hd_status hdi_geo_further(hd_geodesic *g, double least, int32_t *n_stages, hd_error *e) {
    hdi_scope s = hdi_scope_begin(g->ctx, e);
    hdi_geo_far w;
    if (hdi_geo_far_begin(&w, g, &s) < 0) return hdi_scope_end(&s);
    hdi_geo_tell(&w, least);
    while (w.n_told < g->n_active) {
        hdi_geo_border(&w);
        if (!hdi_geo_scale(&w) || hdi_progress(g->ctx, "solve", 0.5, e) < 0) break;
        hdi_geo_stage(&w);
        ++*n_stages;
        least = hdi_geo_largest(&w) * hdi_geo_faint;
        if (!(least > DBL_MIN)) break;
        hdi_geo_tell(&w, least);
        hdi_geo_divergence_now(&w, least);
    }
    return hdi_scope_end(&s);
}

/* ---- queries ---- */

/* Indicator of the sources into x, with the fronts that it touches. Sources twice count once. */
static void hdi_geo_start(hd_geodesic *g, const int32_t *sources, int32_t k) {
    int32_t q;
    memset(g->x, 0, HDI_CAST(size_t, g->n_active) * sizeof *g->x);
    memset(g->active, 0, HDI_CAST(size_t, g->sym.n_super));
    memset(g->reached, 0, HDI_CAST(size_t, g->n_components));
    for (q = 0; q < k; q++) {
        const int32_t i = g->row[sources[q]];
        if (i < 0) continue;
        g->x[i] = 1;
        g->reached[g->component[i]] = 1;
        hdi_sweep_touch(&g->sym, i, g->active);
    }
}

/* What u has to have to be told from nothing: relative to what the sources have. */
static double hdi_geo_least(const hd_geodesic *g, const int32_t *sources, int32_t k, const double *u, int64_t stride) {
    double most = 0;
    int32_t q;
    for (q = 0; q < k; q++)
        if (g->row[sources[q]] >= 0) most = hdi_max(most, fabs(u[stride * g->row[sources[q]]]));
    return hdi_max(most * hdi_geo_faint, DBL_MIN);
}

/* |r| / |b| of the heat equation, r = b - A u, b the indicator of the sources; work r [n_active]. */
static double hdi_geo_heat_residual(const hd_geodesic *g, const int32_t *sources, int32_t k, const double *u, double *r) {
    double b2 = 0, r2 = 0;
    int32_t i, q;
    memset(r, 0, HDI_CAST(size_t, g->n_active) * sizeof *r);
    for (q = 0; q < k; q++)
        if (g->row[sources[q]] >= 0) r[g->row[sources[q]]] = 1;
    for (i = 0; i < g->n_active; i++) {
        b2 += r[i] * r[i];
        r[i] -= g->mass[i] * u[i];
    }
    hdi_geo_subtract(g, u, r);
    for (i = 0; i < g->n_active; i++) r2 += r[i] * r[i];
    return b2 > 0 ? sqrt(r2 / b2) : 0;
}

/* |b - L phi| / |b|; b in g->r, which is used up. */
static double hdi_geo_residual(const hd_geodesic *g, const double *phi) {
    double b2 = 0, r2 = 0;
    int32_t i;
    for (i = 0; i < g->n_active; i++) b2 += g->r[i] * g->r[i];
    hdi_geo_subtract(g, phi, g->r);
    for (i = 0; i < g->n_active; i++) r2 += g->r[i] * g->r[i];
    return b2 > 0 ? sqrt(r2 / b2) : 0;
}

/* Room for phi at k sources. */
static hd_status hdi_geo_values_room(hd_geodesic *g, int32_t k, hd_error *e) {
    const uint64_t most = HDI_CAST(uint64_t, k < g->n_active ? k : g->n_active);
    if (HDI_CAST(size_t, g->value_size) >= most) return HD_OK;
    hdi_free(g->ctx, g->value);
    hdi_free(g->ctx, g->sorted);
    g->value_size = 0;
    g->sorted = NULL;
    g->value = HDI_CAST(double *, hdi_alloc(g->ctx, most, sizeof(double), e));
    if (g->value) g->sorted = HDI_CAST(hdi_pair *, hdi_alloc(g->ctx, most, sizeof(hdi_pair), e));
    if (g->sorted) g->value_size = HDI_CAST(int32_t, most);
    return e->status;
}

/* phi at the sources, ascending within each component. */
static void hdi_geo_values(hd_geodesic *g, const int32_t *sources, int32_t k, const double *phi) {
    int32_t q, n = 0;
    memset(g->mark, 0, HDI_CAST(size_t, g->n_active));
    memset(g->value_ptr, 0, (HDI_CAST(size_t, g->n_components) + 1) * sizeof *g->value_ptr);
    for (q = 0; q < k; q++) {
        const int32_t i = g->row[sources[q]];
        uint64_t bits;
        if (i < 0 || g->mark[i]) continue;
        g->mark[i] = 1;
        memcpy(&bits, phi + i, sizeof bits);
        g->sorted[n].key = bits >> 63 ? ~bits : bits | HDI_CAST(uint64_t, 1) << 63;   /* in the order of the doubles */
        g->sorted[n++].id = i;
        g->value_ptr[g->component[i]]++;
    }
    hdi_sort_pairs(g->sorted, n);
    hdi_prefix_sum(g->value_ptr, g->n_components);
    for (q = 0; q < n; q++) g->value[g->value_ptr[g->component[g->sorted[q].id]]++] = phi[g->sorted[q].id];
    for (q = g->n_components; q > 0; q--) g->value_ptr[q] = g->value_ptr[q - 1];
    g->value_ptr[0] = 0;
}

/* Smallest |phi - value| over the ascending values. */
static double hdi_geo_nearest(const double *value, int64_t n, double phi) {
    int64_t lo = 0, hi = n;
    while (lo < hi) {
        const int64_t mid = lo + (hi - lo) / 2;
        if (value[mid] < phi) lo = mid + 1;
        else hi = mid;
    }
    if (lo == 0) return value[0] - phi;
    return lo < n ? hdi_min(value[lo] - phi, phi - value[lo - 1]) : phi - value[n - 1];
}

/* phi to distances: zero at the sources, infinite where none is. Returns whether all is finite that should be. */
static int hdi_geo_distances(const hd_geodesic *g, const double *phi, double *d) {
    int fine = 1;
    int32_t v;
    for (v = 0; v < g->n; v++) {
        const int32_t i = g->row[v], c = i < 0 ? -1 : g->component[i];
        d[v] = HUGE_VAL;
        if (i < 0 || !g->reached[c]) continue;
        d[v] = g->h * hdi_geo_nearest(g->value + g->value_ptr[c], g->value_ptr[c + 1] - g->value_ptr[c], phi[i]);
        fine &= hdi_finite(d[v]);
    }
    return fine;
}

static void hdi_geo_judge(hd_geodesic_report *rep, double heat, double distance) {
    rep->residual_heat = hdi_max(rep->residual_heat, heat);
    rep->residual_distance = hdi_max(rep->residual_distance, distance);
    if (!(heat <= 1e-6) || !(distance <= 1e-6)) rep->status = HD_WARN_ACCURACY;
}

static hd_status hdi_geo_not_finite(hd_error *e, int32_t column) {
    hdi_fail(e, HD_ERR_BREAKDOWN, "geodesic: rounding has eaten the answer: the mesh has faces that are too thin");
    e->column = column;
    return e->status;
}

/* Distance to the set of sources. */
static hd_status hdi_geo_one(hd_geodesic *g, const int32_t *sources, int32_t k, double *d, hd_geodesic_report *rep, hd_error *e) {
    double least, heat = 0;
    int32_t i, n_stages = 1;
    if (hdi_geo_values_room(g, k, e) < 0) return e->status;
    hdi_geo_start(g, sources, k);
    hdi_geo_sweep(g, &g->heat, 1, g->x, g->active);
    if (rep) heat = hdi_geo_heat_residual(g, sources, k, g->x, g->r);
    least = hdi_geo_least(g, sources, k, g->x, 1);
    if (hdi_geo_divergence(g, g->x, least, g->b) && hdi_geo_further(g, least, &n_stages, e) < 0) return e->status;
    if (rep) memcpy(g->r, g->b, HDI_CAST(size_t, g->n_active) * sizeof *g->r);
    for (i = 0; i < g->n_components; i++) g->b[g->pin[i]] = 0;
    hdi_geo_sweep(g, &g->poisson, 1, g->b, NULL);
    hdi_geo_values(g, sources, k, g->b);
    if (!hdi_geo_distances(g, g->b, d)) return hdi_geo_not_finite(e, -1);
    for (i = 0; i < k; i++) d[sources[i]] = 0;   /* those without mass too */
    if (!rep) return HD_OK;
    rep->n_stages = rep->n_stages > n_stages ? rep->n_stages : n_stages;
    hdi_geo_judge(rep, heat, hdi_geo_residual(g, g->b));
    return HD_OK;
}

static hd_status hdi_geo_wide_room(hd_geodesic *g, hd_error *e) {
    const uint64_t n = HDI_GEO_WIDE * HDI_CAST(uint64_t, g->n_active);
    if (!g->wide_x) g->wide_x = HDI_CAST(double *, hdi_alloc(g->ctx, n, sizeof(double), e));
    if (g->wide_x && !g->wide_b) g->wide_b = HDI_CAST(double *, hdi_alloc(g->ctx, n, sizeof(double), e));
    if (g->wide_b && !g->wide_work) g->wide_work = HDI_CAST(double *, hdi_alloc(g->ctx, hdi_sweep_size(&g->sym, 1, HDI_GEO_WIDE, 1), sizeof(double), e));
    return e->status;
}

static void hdi_geo_column(const hd_geodesic *g, const double *wide, int32_t c, double *x) {
    int32_t i;
    for (i = 0; i < g->n_active; i++) x[i] = wide[HDI_GEO_WIDE * HDI_CAST(int64_t, i) + c];
}

/* phi of up to eight single sources to distances, the columns in d; those with a bit in skip need not be finite. */
static int hdi_geo_wide_distances(const hd_geodesic *g, const int32_t *sources, int32_t k, int skip, double *d, size_t ldd) {
    double at[HDI_GEO_WIDE];
    int32_t component[HDI_GEO_WIDE], v, c, fine = 1;
    for (c = 0; c < k; c++) {
        const int32_t i = g->row[sources[c]];
        component[c] = i < 0 ? -1 : g->component[i];
        at[c] = i < 0 ? 0 : g->wide_b[HDI_GEO_WIDE * HDI_CAST(int64_t, i) + c];
    }
    for (v = 0; v < g->n; v++) {
        const int32_t i = g->row[v], of = i < 0 ? -2 : g->component[i];
        for (c = 0; c < k; c++) {
            double *to = d + HDI_CAST(size_t, c) * ldd + v;
            *to = HUGE_VAL;
            if (of != component[c]) continue;
            *to = g->h * fabs(g->wide_b[HDI_GEO_WIDE * HDI_CAST(int64_t, i) + c] - at[c]);
            fine &= skip >> c & 1 || hdi_finite(*to);
        }
    }
    for (c = 0; c < k; c++) d[HDI_CAST(size_t, c) * ldd + HDI_CAST(size_t, sources[c])] = 0;
    return fine;
}

/* Residuals of the heat equation of eight columns; then, with u gone, those of phi. */
static void hdi_geo_wide_heat(hd_geodesic *g, const int32_t *sources, int32_t k, double *heat) {
    int32_t c;
    for (c = 0; c < k; c++) {
        hdi_geo_column(g, g->wide_x, c, g->x);
        heat[c] = hdi_geo_heat_residual(g, sources + c, 1, g->x, g->r);
    }
}

static void hdi_geo_wide_judge(hd_geodesic *g, int32_t k, int skip, const double *heat, hd_geodesic_report *rep) {
    int32_t c;
    for (c = 0; c < k; c++) {
        if (skip >> c & 1) continue;
        hdi_geo_column(g, g->wide_x, c, g->r);   /* the right-hand side */
        hdi_geo_column(g, g->wide_b, c, g->x);
        hdi_geo_judge(rep, heat[c], hdi_geo_residual(g, g->x));
        rep->n_stages = rep->n_stages > 1 ? rep->n_stages : 1;
    }
}

/* Distances to up to eight sources, each for itself, side by side. Columns whose heat fades out are done again alone. */
static hd_status hdi_geo_wide(hd_geodesic *g, const int32_t *sources, int32_t k, double *d, size_t ldd, hd_geodesic_report *rep, hd_error *e) {
    const size_t size = HDI_GEO_WIDE * HDI_CAST(size_t, g->n_active) * sizeof(double);
    double least[HDI_GEO_WIDE], heat[HDI_GEO_WIDE];
    int32_t c, i;
    int faint;
    if (hdi_geo_wide_room(g, e) < 0) return e->status;
    memset(g->wide_x, 0, size);
    memset(g->active, 0, HDI_CAST(size_t, g->sym.n_super));
    for (c = 0; c < k; c++) {
        if (g->row[sources[c]] < 0) continue;
        g->wide_x[HDI_GEO_WIDE * HDI_CAST(int64_t, g->row[sources[c]]) + c] = 1;
        hdi_sweep_touch(&g->sym, g->row[sources[c]], g->active);
    }
    hdi_geo_sweep(g, &g->heat, HDI_GEO_WIDE, g->wide_x, g->active);
    for (c = 0; c < HDI_GEO_WIDE; c++) least[c] = c < k ? hdi_geo_least(g, sources + c, 1, g->wide_x + c, HDI_GEO_WIDE) : DBL_MIN;
    faint = hdi_geo_divergence8(g, g->wide_x, least, g->wide_b);
    if (rep) hdi_geo_wide_heat(g, sources, k, heat);
    if (rep) memcpy(g->wide_x, g->wide_b, size);
    for (i = 0; i < g->n_components; i++) memset(g->wide_b + HDI_GEO_WIDE * HDI_CAST(int64_t, g->pin[i]), 0, HDI_GEO_WIDE * sizeof(double));
    hdi_geo_sweep(g, &g->poisson, HDI_GEO_WIDE, g->wide_b, NULL);
    if (!hdi_geo_wide_distances(g, sources, k, faint, d, ldd)) return hdi_geo_not_finite(e, -1);
    if (rep) hdi_geo_wide_judge(g, k, faint, heat, rep);
    for (c = 0; c < k; c++)
        if (faint >> c & 1 && hdi_geo_one(g, sources + c, 1, d + HDI_CAST(size_t, c) * ldd, rep, e) < 0) return e->status;
    return HD_OK;
}

/* ==== [29] api ====
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

#define HDI_CLEARED(opts) (!(opts)->begin_zero && !(opts)->end_zero)

/* The same where options may name the context. Those that were not cleared are an error, and nothing in them
 * is followed. */
static hd_status hdi_enter_with(hdi_call *c, int cleared, hd_context *ctx, const char *text, hd_error *err) {
    if (hdi_enter(c, cleared ? ctx : NULL, err) < 0) return c->e->status;
    return cleared ? HD_OK : hdi_fail(c->e, HD_ERR_ARGUMENT, text);
}

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
    if (hdi_enter_with(c, !opts || HDI_CLEARED(opts), opts ? opts->context : NULL,
                       "laplacian options: not cleared before use", err) < 0) return NULL;
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

static hd_laplacian_kind hdi_lap_kind(const hd_laplacian_opts *opts, hd_laplacian_kind otherwise) {
    return opts && HDI_CLEARED(opts) && opts->kind != HD_LAPLACIAN_DEFAULT ? opts->kind : otherwise;
}

static int hdi_kind_of_triangles(hd_laplacian_kind kind) {
    return kind == HD_LAPLACIAN_FEM || kind == HD_LAPLACIAN_VORONOI_COT || kind == HD_LAPLACIAN_COT;
}

/* What is asked for of triangles besides their kind, checked. Returns whether that is an intrinsic triangulation. */
static int hdi_intrinsic_opts(const hd_laplacian_opts *opts, hdi_intrinsic_task *task, hd_error *e) {
    task->close = opts && opts->tufted;
    task->delta = opts && opts->mollify != 0 ? opts->mollify : 1e-5;
    if (hdi_nan(task->delta) || task->delta > 1) hdi_fail(e, HD_ERR_ARGUMENT, "laplacian options: mollify is above 1 or not a number");
    return opts && (opts->intrinsic_delaunay || opts->tufted);
}

HEATDIFF_API hd_status hd_laplacian_triangles(hd_laplacian **out, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri,
                                              const hd_laplacian_opts *opts, hd_error *err) {
    hdi_intrinsic_task task;
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, n, hdi_lap_kind(opts, HD_LAPLACIAN_FEM), err, &c);
    int intrinsic;
    if (!lap) return c.e->status;
    if (!out || (n > 0 && !xyz) || (n_tri > 0 && !tri)) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (n_tri < 0) return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian: a size is negative"));
    if (!hdi_kind_of_triangles(lap->kind))
        return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of triangles: the kind is fem, voronoi-cot or cot"));
    intrinsic = hdi_intrinsic_opts(opts, &task, c.e);
    if (c.e->status < 0 || hdi_progress(c.ctx, "assemble", 0, c.e) < 0) return hdi_lap_done(out, lap, c.e->status);
    return hdi_lap_done(out, lap, hdi_lap_faces(lap, xyz, tri, n_tri, intrinsic ? &task : NULL, c.e));
}

HEATDIFF_API hd_status hd_laplacian_polygons(hd_laplacian **out, const double *xyz, int32_t n, const int64_t *face_ptr, const int32_t *face_idx,
                                             int32_t n_faces, const hd_laplacian_opts *opts, hd_error *err) {
    const int flips = opts && (opts->intrinsic_delaunay || opts->tufted);
    const hd_laplacian_kind kind = hdi_lap_kind(opts, flips ? HD_LAPLACIAN_FEM : HD_LAPLACIAN_POLYGON);
    const int splits = hdi_kind_of_triangles(kind);
    hdi_intrinsic_task task;
    hdi_poly poly;
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, n, kind, err, &c);
    if (!lap) return c.e->status;
    memset(&poly, 0, sizeof poly);
    poly.xyz = xyz;
    poly.ptr = face_ptr;
    poly.idx = face_idx;
    poly.n = n;
    poly.m = n_faces;
    poly.lambda = opts && opts->lambda != 0 ? opts->lambda : 1;
    if (!out || (n > 0 && !xyz) || (n_faces > 0 && !face_ptr)) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (n_faces < 0) return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian: a size is negative"));
    if (!splits && kind != HD_LAPLACIAN_POLYGON)
        return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of polygons: the kind is polygon, fem, voronoi-cot or cot"));
    if (!hdi_finite(poly.lambda) || !(poly.lambda > 0 && poly.lambda <= 1e100))
        return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of polygons: lambda is not between 0 and 1e100"));
    if (hdi_intrinsic_opts(opts, &task, c.e) && !splits)
        return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of polygons: intrinsic triangulations are for fem, voronoi-cot and cot"));
    if (c.e->status < 0 || hdi_progress(c.ctx, "assemble", 0, c.e) < 0 || hdi_poly_check(xyz, n, face_ptr, face_idx, n_faces, c.e) < 0)
        return hdi_lap_done(out, lap, c.e->status);
    return hdi_lap_done(out, lap, splits ? hdi_lap_fans(lap, &poly, flips ? &task : NULL, c.e) : hdi_lap_polygons(lap, &poly, c.e));
}

HEATDIFF_API hd_status hd_laplacian_matrices(hd_laplacian **out, const hd_csr *L, const hd_csr *B, double h, const hd_laplacian_opts *opts,
                                             hd_error *err) {
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, L ? L->n_rows : 0, HD_LAPLACIAN_MATRICES, err, &c);
    if (!lap) return c.e->status;
    if (!out || !L || !B || !L->val || !B->val) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (!hdi_finite(h) || h < 0) return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "laplacian of matrices: h is negative or not finite"));
    if (hdi_csr_check(L, 1, c.ctx, c.e) < 0 || hdi_csr_check(B, 1, c.ctx, c.e) < 0) return hdi_lap_done(out, lap, c.e->status);
    if (L->n_rows != B->n_rows)
        return hdi_lap_done(out, lap, hdi_fail_row(c.e, HD_ERR_ARGUMENT, "laplacian of matrices: L and B differ in size", L->n_rows, B->n_rows, 0));
    lap->h = h;
    if (hdi_lap_matrices(lap, L, B, c.e) >= 0 && lap->b_ratio < 0.01) (void)hdi_lap_ratio(lap, c.e);
    return hdi_lap_done(out, lap, c.e->status);
}

static hd_status hdi_point_neighbours(hd_point_report *rep, const hd_laplacian_opts *opts, hd_error *e) {
    rep->neighbours = opts && opts->neighbours ? opts->neighbours : 30;
    if (rep->neighbours < 6 || rep->neighbours > HDI_MOST_NEIGHBOURS) return hdi_fail(e, HD_ERR_ARGUMENT, "laplacian of points: neighbours lies in 6..128");
    return HD_OK;
}

/* Options of point sets, resolved, into lap->points. */
static hd_status hdi_point_opts(hd_laplacian *lap, const hd_laplacian_opts *opts, hd_error *e) {
    hd_point_report *rep = &lap->points;
    rep->bandwidth = opts ? opts->bandwidth : 0;
    rep->weight_cut = opts && opts->weight_cut != 0 ? opts->weight_cut : 1e-8;
    if (lap->kind != HD_LAPLACIAN_VORONOI_EXP && lap->kind != HD_LAPLACIAN_EXP)
        return hdi_fail(e, HD_ERR_ARGUMENT, "laplacian of points: the kind is voronoi-exp or exp (hd_laplacian_tufted_points has fem, voronoi-cot and cot)");
    if (opts && (opts->intrinsic_delaunay || opts->tufted))
        return hdi_fail(e, HD_ERR_ARGUMENT, "laplacian of points: exponential weights know no triangles; hd_laplacian_tufted_points makes some");
    if (!hdi_finite(rep->bandwidth) || rep->bandwidth < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "laplacian of points: the bandwidth is negative or not finite");
    if (!hdi_finite(rep->weight_cut) || !(rep->weight_cut > 0 && rep->weight_cut < 1)) return hdi_fail(e, HD_ERR_ARGUMENT, "laplacian of points: weight_cut lies in (0, 1)");
    return hdi_point_neighbours(rep, opts, e);
}

HEATDIFF_API hd_status hd_laplacian_points(hd_laplacian **out, const double *xyz, int32_t n, const hd_laplacian_opts *opts, hd_error *err) {
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, n, hdi_lap_kind(opts, HD_LAPLACIAN_VORONOI_EXP), err, &c);
    if (!lap) return c.e->status;
    if (!out || (n > 0 && !xyz)) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (hdi_point_opts(lap, opts, c.e) < 0 || hdi_progress(c.ctx, "assemble", 0, c.e) < 0) return hdi_lap_done(out, lap, c.e->status);
    return hdi_lap_done(out, lap, hdi_lap_points(lap, xyz, c.e));
}

HEATDIFF_API hd_status hd_laplacian_tufted_points(hd_laplacian **out, const double *xyz, int32_t n, const int64_t *nbr_ptr, const int32_t *nbr,
                                                  const hd_laplacian_opts *opts, hd_error *err) {
    hdi_intrinsic_task task;
    hdi_call c;
    hd_laplacian *lap = hdi_lap_new(opts, n, hdi_lap_kind(opts, HD_LAPLACIAN_FEM), err, &c);
    if (!lap) return c.e->status;
    if (!out || (n > 0 && !xyz) || (nbr_ptr && nbr_ptr[n] > 0 && !nbr) || (nbr && !nbr_ptr)) return hdi_lap_done(out, lap, hdi_missing(c.e));
    if (!hdi_kind_of_triangles(lap->kind))
        return hdi_lap_done(out, lap, hdi_fail(c.e, HD_ERR_ARGUMENT, "tufted laplacian of points: the kind is fem, voronoi-cot or cot"));
    (void)hdi_intrinsic_opts(opts, &task, c.e);
    if (c.e->status < 0 || (!nbr_ptr && hdi_point_neighbours(&lap->points, opts, c.e) < 0)) return hdi_lap_done(out, lap, c.e->status);
    if (hdi_progress(c.ctx, "assemble", 0, c.e) < 0) return hdi_lap_done(out, lap, c.e->status);
    return hdi_lap_done(out, lap, hdi_tufted_points(lap, xyz, nbr_ptr, nbr, task.delta, c.e));
}

/* Points, queries and sizes; *m becomes the number of queries. */
static hd_status hdi_neighbours_check(const double *xyz, int32_t n, const double *query, int32_t *m, hd_error *e) {
    if (n < 0 || (query && *m < 0)) return hdi_fail(e, HD_ERR_ARGUMENT, "neighbours: a size is negative");
    if (!query) *m = n;
    if (n > 0 && !xyz) return hdi_missing(e);
    return hdi_points_check(xyz, n, query, *m, e);
}

HEATDIFF_API hd_status hd_neighbours_nearest(const double *xyz, int32_t n, const double *query, int32_t m, int32_t k, int32_t *index,
                                             double *distance2, hd_context *ctx, hd_error *err) {
    hdi_call c;
    hdi_scope s;
    hdi_tree tree;
    if (hdi_enter(&c, ctx, err) < 0 || hdi_neighbours_check(xyz, n, query, &m, c.e) < 0) return c.e->status;
    if (k < 1) return hdi_fail(c.e, HD_ERR_ARGUMENT, "neighbours: k is not positive");
    if (m > 0 && !index) return hdi_missing(c.e);
    s = hdi_scope_begin(c.ctx, c.e);
    if (hdi_progress(c.ctx, "neighbours", 0, c.e) >= 0 && hdi_tree_make(&tree, xyz, n, &s) >= 0 && hdi_progress(c.ctx, "neighbours", 0.1, c.e) >= 0)
        (void)hdi_nearest(&tree, xyz, query, m, k, index, distance2, c.ctx, c.e);
    return hdi_scope_end(&s);
}

HEATDIFF_API hd_status hd_neighbours_radius(hd_csr *out, const double *xyz, int32_t n, const double *query, int32_t m, double radius, hd_context *ctx,
                                            hd_error *err) {
    hdi_call c;
    hdi_scope s;
    hdi_tree tree;
    if (hdi_enter(&c, ctx, err) < 0 || hdi_neighbours_check(xyz, n, query, &m, c.e) < 0) return c.e->status;
    if (!out) return hdi_missing(c.e);
    if (hdi_nan(radius) || radius < 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "neighbours: the radius is negative or not a number");
    s = hdi_scope_begin(c.ctx, c.e);
    if (hdi_progress(c.ctx, "neighbours", 0, c.e) >= 0 && hdi_tree_make(&tree, xyz, n, &s) >= 0 && hdi_progress(c.ctx, "neighbours", 0.1, c.e) >= 0)
        (void)hdi_within(out, &tree, xyz, query, m, hdi_min(radius, 1e152) * hdi_min(radius, 1e152), c.ctx, c.e);
    return hdi_scope_end(&s);
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

HEATDIFF_API hd_status hd_rational_shared(hd_rational *out, int32_t n_times, const double *t, double tol, hd_context *ctx, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, ctx, err) < 0) return c.e->status;
    return out && t ? hdi_rational_shared(out, n_times, t, tol, c.ctx, c.e) : hdi_missing(c.e);
}

HEATDIFF_API double hd_rational_eval(const hd_rational *set, double x) { return hdi_rational_eval(set, x); }

/* ---- shifted systems ---- */

static hd_status hdi_solve_check(double t, hd_c64 theta, const hd_solve_opts *o, hd_error *e) {
    if (!hdi_finite(t) || t < 0) return hdi_fail_row(e, HD_ERR_ARGUMENT, "solve: t is negative or not finite", -1, -1, t);
    if (!hdi_cfinite(theta) || (theta.im == 0 && theta.re <= 0)) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: theta lies on (-inf, 0] or is not finite");
    if (o->solver < HD_SOLVER_AUTO || o->solver > HD_SOLVER_MINRES) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: the solver is cocg, cocr or minres");
    if (o->precond < HD_PRECOND_AUTO || o->precond > HD_PRECOND_MILDL) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: unknown preconditioner");
    if (!hdi_finite(o->tol) || o->tol < 0 || o->tol >= 1) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: tol is not in [0, 1)");
    if (o->max_iterations < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "solve: max_iterations is negative");
    return HD_OK;
}

/* ---- direct solver ---- */

struct hd_ldl {
    hd_context *ctx, context;
    hdi_symbolic sym;
    int32_t n;
    int64_t nnz, *row_ptr;       /* of the pattern: where values are not finite */
    int32_t *col, *inv;          /* inv: row of A -> elimination order */
    hdi_factor real, *pack;      /* pack [n_packs] */
    int32_t n_packs, n_matrices; /* of the last factorisation; n_matrices 0: real or none */
    double *x[2], *work[2];      /* sweeps: real, packs */
};

HEATDIFF_API void hd_ldl_free(hd_ldl *f) {
    hd_context own, *ctx;
    int32_t i;
    if (!f) return;
    own = f->context;
    ctx = f->ctx == &f->context ? &own : f->ctx;
    f->real.ctx = f->real.ctx ? ctx : NULL;
    hdi_factor_free(&f->real);
    for (i = 0; i < f->n_packs; i++) {
        f->pack[i].ctx = f->pack[i].ctx ? ctx : NULL;
        hdi_factor_free(f->pack + i);
    }
    hdi_free(ctx, f->pack);
    for (i = 0; i < 2; i++) {
        hdi_free(ctx, f->x[i]);
        hdi_free(ctx, f->work[i]);
    }
    hdi_free(ctx, f->row_ptr);
    hdi_free(ctx, f->col);
    hdi_free(ctx, f->inv);
    hdi_symbolic_free(ctx, &f->sym);
    hdi_free(ctx, f);
}

static void hdi_ldl_tell(const hd_ldl *f, const hdi_factor *of, hd_ldl_report *rep) {
    if (!rep) return;
    memset(rep, 0, sizeof *rep);
    rep->ordering = f->sym.ordering;
    rep->n_supernodes = f->sym.n_super;
    rep->factor_nnz = f->sym.nnz;
    rep->stored = of && of->width == 1 ? f->sym.panel[f->sym.n_super] : f->sym.stored;
    rep->factor_flops = f->sym.flops;
    if (!of) return;
    rep->n_matrices = of->width == 1 ? 1 : f->n_matrices;
    rep->growth = of->largest_entry > 0 ? of->all.largest / of->largest_entry : 0;
    rep->smallest_pivot = of->largest_entry > 0 && hdi_finite(of->all.smallest) ? of->all.smallest / of->largest_entry : 0;
    rep->n_negative = HDI_CAST(int32_t, of->all.negative);
}

HEATDIFF_API hd_status hd_ldl_analyse(hd_ldl **out, const hd_csr *a, const hd_ldl_opts *opts, hd_ldl_report *report, hd_error *err) {
    hd_ldl_opts o;
    hdi_call c;
    hdi_scope s;
    hd_csr shape;
    hd_ldl *f;
    int32_t *perm, i;
    memset(&o, 0, sizeof o);
    if (opts) o = *opts;
    if (hdi_enter_with(&c, HDI_CLEARED(&o), o.context, "ldl options: not cleared before use", err) < 0) return c.e->status;
    if (!out || !a) return hdi_missing(c.e);
    shape = *a;
    shape.val = NULL;
    if (hdi_csr_check(&shape, 1, c.ctx, c.e) < 0) return c.e->status;
    f = HDI_CAST(hd_ldl *, hdi_alloc(c.ctx, 1, sizeof *f, c.e));
    if (!f) return c.e->status;
    memset(f, 0, sizeof *f);
    if (c.ctx == &c.context) {
        f->context = c.context;
        c.ctx = &f->context;
    }
    f->ctx = c.ctx;
    f->n = a->n_rows;
    f->nnz = a->nnz;
    s = hdi_scope_begin(c.ctx, c.e);
    perm = HDI_TAKE(&s, int32_t, f->n);
    if (perm && hdi_sym_order(&shape, o.xyz, o.ordering, HDI_DISSECT_FROM, o.perm, perm, &i, c.ctx, c.e) >= 0 && hdi_symbolic_make(&f->sym, &shape, perm, c.ctx, c.e) >= 0) {
        f->sym.ordering = HDI_CAST(hd_ordering, i);
        f->row_ptr = HDI_CAST(int64_t *, hdi_copy(a->row_ptr, HDI_CAST(uint64_t, f->n) + 1, sizeof *f->row_ptr, c.ctx, c.e));
        f->col = HDI_CAST(int32_t *, hdi_copy(a->col, HDI_CAST(uint64_t, f->nnz), sizeof *f->col, c.ctx, c.e));
        if (c.e->status >= 0) f->inv = HDI_CAST(int32_t *, hdi_alloc(c.ctx, HDI_CAST(uint64_t, f->n), sizeof *f->inv, c.e));
        for (i = 0; f->inv && i < f->n; i++) f->inv[f->sym.perm[i]] = i;
    }
    if (hdi_scope_end(&s) < 0) {
        hd_ldl_free(f);
        return c.e->status;
    }
    hdi_ldl_tell(f, NULL, report);
    *out = f;
    return HD_OK;
}

/* Finds the first value that is not finite, and the largest diagonal entry. stride: doubles per value. */
static hd_status hdi_ldl_values(const hd_ldl *f, const double *val, int stride, double *largest, hd_error *e) {
    int32_t i;
    int64_t p;
    for (i = 0; i < f->n; i++) {
        for (p = f->row_ptr[i]; p < f->row_ptr[i + 1]; p++) {
            const double re = val[stride * p], im = stride > 1 ? val[stride * p + 1] : 0;
            if (!hdi_finite(re) || !hdi_finite(im))
                return hdi_fail_row(e, HD_ERR_NOT_FINITE, "LDL': a value of the matrix is not finite", i, f->col[p], hdi_finite(re) ? im : re);
            if (f->col[p] == i) *largest = hdi_max(*largest, hypot(re, im));
        }
    }
    return HD_OK;
}

HEATDIFF_API hd_status hd_ldl_factor(hd_ldl *f, const double *val, hd_ldl_report *report, hd_error *err) {
    hdi_values v;
    hdi_call c;
    double largest = 0;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f || (f->nnz > 0 && !val)) return hdi_missing(c.e);
    f->n_matrices = 0;
    f->real.ready = 0;
    if (hdi_ldl_values(f, val, 1, &largest, c.e) < 0) return c.e->status;
    if (!f->real.ctx && hdi_factor_make(&f->real, &f->sym, 1, f->ctx, c.e) < 0) return c.e->status;
    memset(&v, 0, sizeof v);
    v.real = val;
    f->real.largest_entry = largest;
    if (hdi_factor_run(&f->real, &v, c.e) < 0) return c.e->status;
    hdi_ldl_tell(f, &f->real, report);
    return HD_OK;
}

/* Room for packs for k matrices. */
static hd_status hdi_ldl_packs(hd_ldl *f, int32_t k, hd_error *e) {
    const int32_t want = (k + 3) / 4;
    hdi_factor *pack;
    int32_t i;
    if (f->n_packs >= want) return HD_OK;
    pack = HDI_CAST(hdi_factor *, hdi_alloc(f->ctx, HDI_CAST(uint64_t, want), sizeof *pack, e));
    if (!pack) return e->status;
    memset(pack, 0, HDI_CAST(size_t, want) * sizeof *pack);
    for (i = 0; i < f->n_packs; i++) pack[i] = f->pack[i];
    hdi_free(f->ctx, f->pack);
    f->pack = pack;
    for (; f->n_packs < want; f->n_packs++)
        if (hdi_factor_make(f->pack + f->n_packs, &f->sym, HDI_PACK, f->ctx, e) < 0) return e->status;
    return HD_OK;
}

HEATDIFF_API hd_status hd_ldl_factor_complex(hd_ldl *f, int32_t k, const hd_c64 *val, hd_ldl_report *report, hd_error *err) {
    hd_ldl_report all, one;
    hdi_call c;
    int32_t i, q;
    memset(&all, 0, sizeof all);
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f || (f->nnz > 0 && !val)) return hdi_missing(c.e);
    if (k < 1) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the number of matrices is not positive");
    f->n_matrices = 0;
    f->real.ready = 0;
    if (hdi_ldl_packs(f, k, c.e) < 0) return c.e->status;
    for (i = 0; 4 * i < k; i++) {
        hdi_factor *pack = f->pack + i;
        hdi_values v;
        memset(&v, 0, sizeof v);
        pack->largest_entry = 0;
        for (q = 0; q < 4; q++) {                /* a matrix that is not there is the last one again */
            v.z[q] = f->nnz > 0 ? val + f->nnz * (4 * i + q < k ? 4 * i + q : k - 1) : val;
            if (f->nnz > 0 && 4 * i + q < k && hdi_ldl_values(f, &v.z[q]->re, 2, &pack->largest_entry, c.e) < 0) {
                c.e->pole = 4 * i + q;
                return c.e->status;
            }
        }
        if (hdi_factor_run(pack, &v, c.e) < 0) {
            if (c.e->pole >= 0) c.e->pole += 4 * i;
            return c.e->status;
        }
        hdi_ldl_tell(f, pack, &one);
        if (i == 0) all = one;
        all.growth = hdi_max(all.growth, one.growth);
        all.smallest_pivot = hdi_min(all.smallest_pivot, one.smallest_pivot);
    }
    all.n_matrices = f->n_matrices = k;
    if (report) *report = all;
    return HD_OK;
}

/* Vectors and work of sweeps, kept. which: 0 real, 1 packs. */
static hd_status hdi_ldl_room(hd_ldl *f, int which, hd_error *e) {
    const int32_t width = which ? HDI_PACK : 1, k = which ? 1 : 8;
    if (f->x[which]) return HD_OK;
    if (!f->work[which]) f->work[which] = HDI_CAST(double *, hdi_alloc(f->ctx, hdi_sweep_size(&f->sym, width, k, 1), sizeof(double), e));
    if (f->work[which]) f->x[which] = HDI_CAST(double *, hdi_alloc(f->ctx, HDI_CAST(uint64_t, f->n) * HDI_CAST(uint64_t, width * k), sizeof(double), e));
    return e->status;
}

HEATDIFF_API hd_status hd_ldl_solve(hd_ldl *f, int32_t k, const double *b, size_t ldb, double *x, size_t ldx, hd_error *err) {
    hdi_call c;
    hdi_sweep z;
    int32_t i, q, r, n_cols;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f || (k > 0 && f->n > 0 && (!b || !x))) return hdi_missing(c.e);
    if (!f->real.ready) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the last factorisation was not a real one");
    if (k < 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the number of right-hand sides is negative");
    ldb = ldb ? ldb : HDI_CAST(size_t, f->n);
    ldx = ldx ? ldx : HDI_CAST(size_t, f->n);
    if (ldb < HDI_CAST(size_t, f->n) || ldx < HDI_CAST(size_t, f->n)) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: a leading dimension is smaller than n");
    if (hdi_ldl_room(f, 0, c.e) < 0) return c.e->status;
    for (q = 0; q < k; q += n_cols) {            /* eight at a time, or one by one */
        const int32_t wide = k - q > 1 ? 8 : 1;
        n_cols = k - q < wide ? k - q : wide;
        for (i = 0; i < f->n; i++)
            for (r = 0; r < wide; r++)
                f->x[0][HDI_CAST(int64_t, wide) * i + r] = r < n_cols ? b[HDI_CAST(size_t, q + r) * ldb + HDI_CAST(size_t, f->sym.perm[i])] : 0;
        z = hdi_sweep_open(&f->real, wide, f->x[0], f->work[0], 1);
        hdi_sweep_run(&z, f->ctx);
        for (i = 0; i < f->n; i++)
            for (r = 0; r < n_cols; r++) x[HDI_CAST(size_t, q + r) * ldx + HDI_CAST(size_t, f->sym.perm[i])] = f->x[0][HDI_CAST(int64_t, wide) * i + r];
    }
    return HD_OK;
}

HEATDIFF_API hd_status hd_ldl_solve_complex(hd_ldl *f, const hd_c64 *b, size_t ldb, hd_c64 *x, size_t ldx, hd_error *err) {
    hdi_call c;
    hdi_sweep z;
    int32_t i, q, p;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f || (f->n > 0 && (!b || !x))) return hdi_missing(c.e);
    if (f->n_matrices == 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the last factorisation was not a complex one");
    ldx = ldx ? ldx : HDI_CAST(size_t, f->n);
    if ((ldb && ldb < HDI_CAST(size_t, f->n)) || ldx < HDI_CAST(size_t, f->n)) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: a leading dimension is smaller than n");
    if (b == x && ldb && ldb != ldx) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: x may be b only when both have the same leading dimension");
    if (hdi_ldl_room(f, 1, c.e) < 0) return c.e->status;
    for (p = (f->n_matrices - 1) / 4; p >= 0; p--) {   /* from the last: x may be the b of all */
        const int32_t n_here = f->n_matrices - 4 * p < 4 ? f->n_matrices - 4 * p : 4;
        for (i = 0; i < f->n; i++) {
            double *to = f->x[1] + HDI_PACK * HDI_CAST(int64_t, i);
            for (q = 0; q < 4; q++) {
                const hd_c64 v = b[HDI_CAST(size_t, 4 * p + (q < n_here ? q : 0)) * ldb + HDI_CAST(size_t, f->sym.perm[i])];
                to[q] = v.re;
                to[q + 4] = v.im;
            }
        }
        z = hdi_sweep_open(f->pack + p, 1, f->x[1], f->work[1], 1);
        hdi_sweep_run(&z, f->ctx);
        for (i = 0; i < f->n; i++) {
            const double *from = f->x[1] + HDI_PACK * HDI_CAST(int64_t, i);
            for (q = 0; q < n_here; q++) x[HDI_CAST(size_t, 4 * p + q) * ldx + HDI_CAST(size_t, f->sym.perm[i])] = hdi_c(from[q], from[q + 4]);
        }
    }
    return HD_OK;
}

/* The analysis' entries x to their places in the pattern and to those across the diagonal, `stride` doubles from one place to the next. Diagonal ones to
 * diag, unless NULL. val may be NULL. Returns how many there are on the diagonal. */
static int32_t hdi_ldl_spread(const hd_ldl *f, const double *x, double *val, double *diag, int stride) {
    const hdi_symbolic *s = &f->sym;
    int32_t v, found = 0;
    int64_t q;
    for (v = 0; v < s->n_super; v++) {
        for (q = s->a_ptr[v]; q < s->a_ptr[v + 1]; q++) {
            const int64_t p = s->a_from[q];
            const int32_t i = s->perm[s->super[v] + s->a_col[q]], j = f->col[p];   /* entry p is (i,j): rows of A are walked from the column's pivot */
            if (val) val[stride * p] = x[q];
            if (i == j) found++;
            if (i == j && diag) diag[HDI_CAST(int64_t, stride) * i] = x[q];
            if (i != j && val) val[stride * (f->row_ptr[j] + hdi_lower_bound(f->col + f->row_ptr[j], f->row_ptr[j + 1] - f->row_ptr[j], i))] = x[q];
        }
    }
    return found;
}

/* One factor, real or of up to four matrices: part c of matrix q goes to values + stride (q nnz) + c, and so for diag. */
static hd_status hdi_ldl_invert(hd_ldl *f, hdi_factor *of, int32_t n_matrices, double *values, double *diag, hd_error *e) {
    const int32_t stride = of->width == 1 ? 1 : 2, n_sets = stride * n_matrices;
    const int64_t entries = f->sym.a_ptr[f->sym.n_super], size = values ? entries : f->n;
    hdi_scope s = hdi_scope_begin(f->ctx, e);
    double coef[HDI_PACK * HDI_PACK], *x = HDI_TAKE(&s, double, HDI_CAST(uint64_t, n_sets) * HDI_CAST(uint64_t, size > f->n ? size : f->n));
    int32_t q, i, found = 0;
    hdi_inverse z;
    memset(coef, 0, sizeof coef);
    for (q = 0; q < n_sets; q++) coef[q * of->width + q / stride + q % stride * 4] = 1;   /* numbers of a pack: four real parts, four imaginary ones */
    if (e->status < 0 || hdi_inverse_make(&z, &f->sym, of->width, f->ctx, e) < 0) return hdi_scope_end(&s);
    z.coef = coef;
    z.n_sets = n_sets;
    z.values = x;
    if (values) {
        memset(x, 0, HDI_CAST(size_t, n_sets) * HDI_CAST(size_t, entries) * sizeof *x);
        z.stride = entries;
        (void)hdi_inverse_run(&z, of, e);
        for (q = 0; q < n_sets && e->status >= 0; q++)
            found = hdi_ldl_spread(f, x + q * entries, values + stride * (q / stride * f->nnz) + q % stride,
                                   diag ? diag + stride * HDI_CAST(int64_t, q / stride) * f->n + q % stride : NULL, stride);
    }
    if (diag && e->status >= 0 && (!values || found < f->n)) {
        memset(x, 0, HDI_CAST(size_t, n_sets) * HDI_CAST(size_t, f->n) * sizeof *x);
        z.wanted = HDI_WANT_DIAGONAL;
        z.stride = f->n;
        (void)hdi_inverse_run(&z, of, e);
        for (q = 0; q < n_sets && e->status >= 0; q++)
            for (i = 0; i < f->n; i++)
                diag[stride * (HDI_CAST(int64_t, q / stride) * f->n + f->sym.perm[i]) + q % stride] = x[HDI_CAST(int64_t, q) * f->n + i];
    }
    hdi_inverse_free(&z, f->ctx);
    return hdi_scope_end(&s);
}

HEATDIFF_API hd_status hd_ldl_inverse(hd_ldl *f, double *values, double *diag, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f) return hdi_missing(c.e);
    if (!f->real.ready) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the last factorisation was not a real one");
    return values || diag ? hdi_ldl_invert(f, &f->real, 1, values, diag, c.e) : HD_OK;
}

HEATDIFF_API hd_status hd_ldl_inverse_complex(hd_ldl *f, hd_c64 *values, hd_c64 *diag, hd_error *err) {
    hdi_call c;
    int32_t p;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f) return hdi_missing(c.e);
    if (f->n_matrices == 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the last factorisation was not a complex one");
    for (p = 0; 4 * p < f->n_matrices && (values || diag); p++) {
        const int32_t n_here = f->n_matrices - 4 * p < 4 ? f->n_matrices - 4 * p : 4;
        if (hdi_ldl_invert(f, f->pack + p, n_here, values ? &values[4 * p * f->nnz].re : NULL, diag ? &diag[HDI_CAST(int64_t, 4) * p * f->n].re : NULL, c.e) < 0) return c.e->status;
    }
    return HD_OK;
}

/* Entries of one factor's inverses for the runs of equal j in order: part c of matrix q goes to values + stride (q n_entries + entry) + c. */
static void hdi_ldl_some(const hd_ldl *f, const hdi_factor *of, int32_t n_matrices, const hdi_pair *order, int64_t n_entries, const int32_t *i, char *active, char *wanted, double *values) {
    const hdi_symbolic *s = &f->sym;
    const int32_t width = of->width, stride = width == 1 ? 1 : 2, which = width == 1 ? 0 : 1;
    double *x = f->x[which];
    int64_t begin, end, p;
    int32_t v, q;
    memset(x, 0, HDI_CAST(size_t, s->n) * HDI_CAST(size_t, width) * sizeof *x);
    for (begin = 0; begin < n_entries; begin = end) {
        const int32_t source = f->inv[order[begin].key];
        hdi_sweep z = hdi_sweep_open(of, 1, x, f->work[which], 1);
        memset(active, 0, HDI_CAST(size_t, s->n_super));
        memset(wanted, 0, HDI_CAST(size_t, s->n_super));
        hdi_sweep_touch(s, source, active);
        for (end = begin; end < n_entries && order[end].key == order[begin].key; end++) hdi_sweep_touch(s, f->inv[i[order[end].id]], wanted);
        for (q = 0; q < (width == 1 ? 1 : 4); q++) x[HDI_CAST(int64_t, width) * source + q] = 1;
        z.active = active;
        z.wanted = wanted;
        hdi_sweep_run(&z, NULL);
        for (p = begin; p < end; p++) {
            const double *at = x + HDI_CAST(int64_t, width) * f->inv[i[order[p].id]];
            for (q = 0; q < n_matrices * stride; q++) values[stride * (q / stride * n_entries + order[p].id) + q % stride] = at[q / stride + q % stride * 4];
        }
        for (v = 0; v < s->n_super; v++)         /* what has been touched is cleared for the next */
            if (active[v] || wanted[v])
                memset(x + HDI_CAST(int64_t, width) * s->super[v], 0, HDI_CAST(size_t, s->super[v + 1] - s->super[v]) * HDI_CAST(size_t, width) * sizeof *x);
    }
}

static hd_status hdi_ldl_entries(hd_ldl *f, int complex_ones, int64_t n_entries, const int32_t *i, const int32_t *j, double *values, hd_error *e) {
    hdi_scope s;
    hdi_pair *order;
    char *marks;
    int64_t q;
    int32_t p;
    if (n_entries < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "ldl: the number of entries is negative");
    if (n_entries > 0 && (!i || !j || !values)) return hdi_missing(e);
    for (q = 0; q < n_entries; q++)
        if (i[q] < 0 || i[q] >= f->n || j[q] < 0 || j[q] >= f->n) return hdi_fail_row(e, HD_ERR_INDEX, "ldl: an entry is not in the matrix", q, -1, i[q] < 0 || i[q] >= f->n ? i[q] : j[q]);
    if (n_entries == 0 || hdi_ldl_room(f, complex_ones, e) < 0) return e->status;
    s = hdi_scope_begin(f->ctx, e);
    order = HDI_TAKE(&s, hdi_pair, n_entries);
    marks = HDI_TAKE(&s, char, 2 * HDI_CAST(uint64_t, f->sym.n_super));
    if (e->status < 0) return hdi_scope_end(&s);
    for (q = 0; q < n_entries; q++) {
        order[q].key = HDI_CAST(uint64_t, j[q]);
        order[q].id = q;
    }
    hdi_sort_pairs(order, n_entries);
    for (p = 0; complex_ones && 4 * p < f->n_matrices; p++)
        hdi_ldl_some(f, f->pack + p, f->n_matrices - 4 * p < 4 ? f->n_matrices - 4 * p : 4, order, n_entries, i, marks, marks + f->sym.n_super, values + 8 * p * n_entries);
    if (!complex_ones) hdi_ldl_some(f, &f->real, 1, order, n_entries, i, marks, marks + f->sym.n_super, values);
    return hdi_scope_end(&s);
}

HEATDIFF_API hd_status hd_ldl_inverse_entries(hd_ldl *f, int64_t n_entries, const int32_t *i, const int32_t *j, double *values, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f) return hdi_missing(c.e);
    if (!f->real.ready) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the last factorisation was not a real one");
    return hdi_ldl_entries(f, 0, n_entries, i, j, values, c.e);
}

HEATDIFF_API hd_status hd_ldl_inverse_entries_complex(hd_ldl *f, int64_t n_entries, const int32_t *i, const int32_t *j, hd_c64 *values, hd_error *err) {
    hdi_call c;
    if (hdi_enter(&c, f ? f->ctx : NULL, err) < 0) return c.e->status;
    if (!f) return hdi_missing(c.e);
    if (f->n_matrices == 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "ldl: the last factorisation was not a complex one");
    return hdi_ldl_entries(f, 1, n_entries, i, j, values ? &values->re : NULL, c.e);
}

/* ---- heat ---- */

static hd_status hdi_heat_check(const hd_heat_opts *o, hd_error *e) {
    if (o->method < HD_METHOD_AUTO || o->method > HD_METHOD_KRYLOV) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown method");
    if (o->solver < HD_SOLVER_AUTO || o->solver > HD_SOLVER_LANCZOS) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown solver");
    if (o->precond < HD_PRECOND_AUTO || o->precond > HD_PRECOND_MILDL) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown preconditioner");
    if (o->poles != HD_POLES_DIAGONAL && (o->poles < HD_POLES_DEFAULT || o->poles > HD_POLES_KERNEL)) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: poles are uniform, kernel or diagonal; own sets go into rational");
    if (o->degree < 0 || o->degree > HDI_RAT_UNIFORM_MAX) return hdi_fail_row(e, HD_ERR_ARGUMENT, "heat: the degree is not in 1..14", -1, -1, o->degree);
    if ((o->poles == HD_POLES_KERNEL || o->poles == HD_POLES_DIAGONAL) && o->degree && o->degree < HDI_RAT_KERNEL_MIN)
        return hdi_fail_row(e, HD_ERR_ARGUMENT, "heat: kernel and diagonal sets have degrees 2 to 14", -1, -1, o->degree);
    if (!hdi_finite(o->tol) || o->tol < 0 || o->tol >= 1) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: tol is not in [0, 1)");
    if (o->max_iterations < 0) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: max_iterations is negative");
    if (o->ordering < HD_ORDERING_AUTO || o->ordering > HD_ORDERING_OWN) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: unknown ordering");
    if (o->ordering == HD_ORDERING_OWN && !o->perm) return hdi_fail(e, HD_ERR_ARGUMENT, "ordering: own, but no permutation is given");
    if (o->method == HD_METHOD_KRYLOV && (o->rational || o->poles || o->degree))
        return hdi_fail(e, HD_ERR_ARGUMENT, "heat: the krylov method has no use for poles or a degree");
    if ((o->method == HD_METHOD_KRYLOV || o->method == HD_METHOD_DIRECT) && (o->solver || o->precond))
        return hdi_fail(e, HD_ERR_ARGUMENT, "heat: solver and precond belong to the iterative method");
    if (o->rational && o->solver == HD_SOLVER_LANCZOS) return hdi_fail(e, HD_ERR_ARGUMENT, "heat: Lanczos has no use for a pole set");
    return o->rational ? hdi_rational_check(o->rational, e) : HD_OK;
}

HEATDIFF_API hd_status hd_heat_create(hd_heat **out, const hd_laplacian *lap, const hd_heat_opts *opts, hd_error *err) {
    hdi_call c;
    hd_heat *heat;
    if (hdi_enter_with(&c, !opts || HDI_CLEARED(opts),
                       opts && opts->context ? opts->context : lap ? lap->context : NULL,
                       "heat options: not cleared before use", err) < 0) return c.e->status;
    if (!out || !lap) return hdi_missing(c.e);
    if (opts && hdi_heat_check(opts, c.e) < 0) return c.e->status;
    heat = HDI_CAST(hd_heat *, hdi_alloc(c.ctx, 1, sizeof *heat, c.e));
    if (!heat) return c.e->status;
    memset(heat, 0, sizeof *heat);
    heat->ctx = c.ctx;
    heat->source = lap;
    if (opts) heat->opts = *opts;
    if (heat->opts.rational) {
        heat->own_set = *heat->opts.rational;
        heat->own_set.kind = HD_POLES_OWN;
        heat->opts.rational = &heat->own_set;
    }
    heat->iterations_asked = heat->opts.solver || heat->opts.precond;
    heat->poles_asked = heat->opts.rational || heat->opts.poles || heat->opts.degree;
    heat->opts.precond = heat->opts.precond ? heat->opts.precond : HD_PRECOND_MILDL;
    heat->exacting = heat->opts.tol > 0 && heat->opts.tol < 1e-9;
    heat->limit = heat->opts.tol > 0 ? heat->opts.tol : HDI_ROUNDING_LIMIT;
    heat->opts.tol = heat->opts.tol > 0 ? heat->opts.tol : 1e-9;
    heat->opts.max_iterations = heat->opts.max_iterations ? heat->opts.max_iterations : 20000;
    heat->scale = hdi_heat_scale(lap);
    heat->lambda_max = hdi_lambda_bound(lap) / heat->scale;
    if (heat->opts.ordering == HD_ORDERING_OWN) {
        if (hdi_sym_check(heat->opts.perm, lap->n, c.ctx, c.e) >= 0)
            heat->perm = HDI_CAST(int32_t *, hdi_copy(heat->opts.perm, HDI_CAST(uint64_t, lap->n), sizeof *heat->perm, c.ctx, c.e));
        if (!heat->perm) {
            hd_heat_free(heat);
            return c.e->status;
        }
    }
    heat->opts.perm = heat->perm;
    if (hdi_heat_drift(lap, &heat->drift, c.ctx, c.e) < 0) {
        hd_heat_free(heat);
        return c.e->status;
    }
    heat->drift /= heat->scale;
    *out = heat;
    return HD_OK;
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
    if (heat->ground.diag) hdi_ground_free(&heat->ground, ctx);
    hdi_elim_free(&heat->elim);
    if (heat->silan) hdi_silan_free(heat->silan, ctx);
    hdi_free(ctx, heat->silan);
    hdi_free(ctx, heat->batch_room);
    hdi_free(ctx, heat->perm);
    hdi_free(ctx, heat);
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
    if (hdi_enter_with(&c, HDI_CLEARED(&o), o.context ? o.context : lap ? lap->context : NULL,
                       "solve options: not cleared before use", err) < 0) return c.e->status;
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

/* Fields that lie ldf apart and whose answers will lie ldu apart in the same array: they go where their answers will be. */
static void hdi_fields_spread(hdi_request *ask, size_t n, double *U) {
    int32_t q;
    for (q = 1; q < ask->k && ask->ldu != ask->ldf; q++) {
        const size_t at = HDI_CAST(size_t, ask->ldu > ask->ldf ? ask->k - q : q);
        memmove(U + at * ask->ldu, U + at * ask->ldf, n * sizeof *U);
    }
    ask->ldf = ask->ldu;
}

HEATDIFF_API hd_status hd_heat_apply(hd_heat *heat, int32_t n_times, const double *t, int32_t k, const double *F, size_t ldf,
                                     double *U, size_t ldu, hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_heat_begin(&h, heat, HDI_QUERY_FIELD, report, err) < 0) return hdi_heat_end(&h);
    if (hdi_times_check(&h, n_times, t, 0) < 0) return hdi_heat_end(&h);
    if (k < 0) hdi_fail(h.e, HD_ERR_ARGUMENT, "heat: a number of fields or columns is negative");
    else if (k > 0 && (!F || !U)) hdi_missing(h.e);
    h.ask.k = k;
    h.ask.F = F;
    h.ask.U = U;
    h.ask.ldf = hdi_leading(&h, ldf);
    h.ask.ldu = hdi_leading(&h, ldu);
    if (h.e->status < 0 || hdi_fields_check(&h) < 0) return hdi_heat_end(&h);
    if (U == F && n_times > 1) hdi_fail(h.e, HD_ERR_ARGUMENT, "heat: U may be F for one time only");
    else if (U == F) hdi_fields_spread(&h.ask, HDI_CAST(size_t, heat->source->n), U);
    return hdi_heat_run(&h);
}

HEATDIFF_API hd_status hd_heat_columns(hd_heat *heat, hd_kernel kernel, int32_t n_times, const double *t, int32_t k,
                                       const int32_t *sources, double *U, size_t ldu, hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_kernel_begin(&h, heat, kernel, report, err) < 0) return hdi_heat_end(&h);
    if (hdi_times_check(&h, n_times, t, 0) < 0) return hdi_heat_end(&h);
    if (k < 0) hdi_fail(h.e, HD_ERR_ARGUMENT, "heat: a number of fields or columns is negative");
    else if (k > 0 && (!sources || !U)) hdi_missing(h.e);
    h.ask.k = k;
    h.ask.sources = sources;
    h.ask.U = U;
    h.ask.ldu = hdi_leading(&h, ldu);
    if (h.e->status >= 0) (void)hdi_sources_check(&h, k, sources);
    return hdi_heat_run(&h);
}

HEATDIFF_API hd_status hd_heat_column(hd_heat *heat, hd_kernel kernel, double t, int32_t source, double *u, hd_report *report,
                                      hd_error *err) {
    return hd_heat_columns(heat, kernel, 1, &t, 1, &source, u, 0, report, err);
}

/* Pairs of vertices. */
static hd_status hdi_pairs_check(hdi_heat_call *h, int64_t n_pairs, const int32_t *i, const int32_t *j) {
    const hd_laplacian *lap = h->heat->source;
    if (n_pairs < 0) return hdi_fail(h->e, HD_ERR_ARGUMENT, "heat: the number of pairs is negative");
    if (n_pairs > 0 && (!i || !j)) return hdi_missing(h->e);
    if (hdi_vertices_check(lap, n_pairs, i, &h->e->row, h->e) < 0) return h->e->status;
    return hdi_vertices_check(lap, n_pairs, j, &h->e->row, h->e);
}

HEATDIFF_API hd_status hd_heat_entries(hd_heat *heat, hd_kernel kernel, int32_t n_times, const double *t, int64_t n_pairs,
                                       const int32_t *i, const int32_t *j, double *values, hd_report *report, hd_error *err) {
    hdi_heat_call h;
    hdi_entry_list list;
    if (hdi_kernel_begin(&h, heat, kernel, report, err) < 0) return hdi_heat_end(&h);
    if (hdi_times_check(&h, n_times, t, 0) < 0 || hdi_pairs_check(&h, n_pairs, i, j) < 0) return hdi_heat_end(&h);
    if (n_pairs > 0 && !values) hdi_missing(h.e);
    list.values = values;
    if (h.e->status >= 0) (void)hdi_entry_list_make(&h, &list, n_pairs, i, j);
    return hdi_heat_run(&h);
}

HEATDIFF_API hd_status hd_heat_diagonal(hd_heat *heat, hd_kernel kernel, int32_t n_times, const double *t, double *D, size_t ldd,
                                        hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_kernel_begin(&h, heat, kernel, report, err) < 0) return hdi_heat_end(&h);
    if (hdi_times_check(&h, n_times, t, 1) < 0 || hdi_direct_only(&h) < 0) return hdi_heat_end(&h);
    if (!D) hdi_missing(h.e);
    ldd = hdi_leading(&h, ldd);
    if (h.e->status >= 0) (void)hdi_diagonal_run(&h, kernel, D, ldd);
    return hdi_heat_end(&h);
}

HEATDIFF_API hd_status hd_heat_edges(hd_heat *heat, hd_kernel kernel, int32_t n_times, const double *t, double *values,
                                     hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_kernel_begin(&h, heat, kernel, report, err) < 0) return hdi_heat_end(&h);
    if (hdi_times_check(&h, n_times, t, 1) < 0 || hdi_direct_only(&h) < 0) return hdi_heat_end(&h);
    if (!values) hdi_missing(h.e);
    else if (kernel != HD_KERNEL_SYMMETRIC)
        hdi_fail(h.e, HD_ERR_ARGUMENT, "edges: the kernel is the symmetric one; K_t = k_t B is not symmetric");
    if (h.e->status >= 0) (void)hdi_edges_run(&h, values);
    return hdi_heat_end(&h);
}

/* The start of a query of a distance. Commute and biharmonic have no time: n_times is 0 or 1 and t is not looked at. */
static hd_status hdi_distance_begin(hdi_heat_call *h, hd_heat *heat, hd_distance_kind kind, int32_t n_times, const double *t,
                                    int positive, hd_report *report, hd_error *err) {
    if (hdi_heat_begin(h, heat, HDI_QUERY_SYMMETRIC, report, err) < 0) return h->e->status;
    h->relative = 1;
    if (kind < HD_DISTANCE_CLASSICAL || kind > HD_DISTANCE_BIHARMONIC)
        return hdi_fail(h->e, HD_ERR_ARGUMENT, "distance: unknown kind");
    if (kind < HD_DISTANCE_COMMUTE) return hdi_times_check(h, n_times, t, positive);
    if (n_times > 1 || n_times < 0)
        return hdi_fail_row(h->e, HD_ERR_ARGUMENT, "distance: commute and biharmonic have one time", -1, -1, n_times);
    return hdi_direct_only(h);
}

HEATDIFF_API hd_status hd_heat_distance(hd_heat *heat, hd_distance_kind kind, int32_t n_times, const double *t, int32_t k,
                                        const int32_t *sources, double *D, size_t ldd, hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_distance_begin(&h, heat, kind, n_times, t, 1, report, err) < 0 || hdi_direct_only(&h) < 0) return hdi_heat_end(&h);
    if (k < 0) hdi_fail(h.e, HD_ERR_ARGUMENT, "heat: a number of fields or columns is negative");
    else if (k > 0 && (!sources || !D)) hdi_missing(h.e);
    ldd = hdi_leading(&h, ldd);
    if (h.e->status >= 0 && hdi_sources_check(&h, k, sources) >= 0 && k > 0)
        (void)hdi_distance_run(&h, kind, k, sources, D, ldd);
    return hdi_heat_end(&h);
}

HEATDIFF_API hd_status hd_heat_pairs(hd_heat *heat, hd_distance_kind kind, int32_t n_times, const double *t, int64_t n_pairs,
                                     const int32_t *i, const int32_t *j, double *K, double *d, hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_distance_begin(&h, heat, kind, n_times, t, 0, report, err) < 0) return hdi_heat_end(&h);
    h.relative = d != NULL;
    if (hdi_pairs_check(&h, n_pairs, i, j) >= 0 && n_pairs > 0) (void)hdi_pairs_run(&h, kind, n_pairs, i, j, K, d);
    return hdi_heat_end(&h);
}

HEATDIFF_API hd_status hd_heat_sample(hd_heat *heat, hd_distance_kind kind, double t, int32_t count, int32_t n_given,
                                      int32_t *vertex, double *distance, hd_report *report, hd_error *err) {
    hdi_heat_call h;
    if (hdi_distance_begin(&h, heat, kind, 1, &t, 1, report, err) < 0 || hdi_direct_only(&h) < 0) return hdi_heat_end(&h);
    if (count < 1 || n_given < 0 || n_given > count || count > heat->source->n_active)
        hdi_fail_row(h.e, HD_ERR_ARGUMENT, "sample: more points than vertices, or none", -1, -1, count);
    else if (!vertex) hdi_missing(h.e);
    if (h.e->status >= 0 && hdi_sources_check(&h, n_given, vertex) >= 0)
        (void)hdi_sample_run(&h, kind, t, count, n_given, vertex, distance);
    return hdi_heat_end(&h);
}

/* ---- geodesic distance ---- */

static hd_status hdi_geo_check(const hd_geodesic_opts *o, hd_error *e) {
    if (!hdi_finite(o->t) || o->t < 0) return hdi_fail_row(e, HD_ERR_ARGUMENT, "geodesic: t is negative or not finite", -1, -1, o->t);
    if (o->mass < HD_GEODESIC_MASS_BARYCENTRIC || o->mass > HD_GEODESIC_MASS_VORONOI) return hdi_fail(e, HD_ERR_ARGUMENT, "geodesic: unknown mass");
    if (o->ordering < HD_ORDERING_AUTO || o->ordering > HD_ORDERING_OWN) return hdi_fail(e, HD_ERR_ARGUMENT, "geodesic: unknown ordering");
    if (o->ordering == HD_ORDERING_OWN && !o->perm) return hdi_fail(e, HD_ERR_ARGUMENT, "ordering: own, but no permutation is given");
    return HD_OK;
}

HEATDIFF_API hd_status hd_geodesic_create(hd_geodesic **out, const double *xyz, int32_t n, const int32_t *tri, int32_t n_tri, const hd_geodesic_opts *opts,
                                          hd_error *err) {
    hd_geodesic_opts o;
    hd_geodesic *g;
    hdi_call c;
    memset(&o, 0, sizeof o);
    if (opts) o = *opts;
    if (hdi_enter_with(&c, HDI_CLEARED(&o), o.context, "geodesic options: not cleared before use", err) < 0) return c.e->status;
    if (!out || (n > 0 && !xyz) || (n_tri > 0 && !tri)) return hdi_missing(c.e);
    if (n < 0 || n_tri < 0) return hdi_fail(c.e, HD_ERR_ARGUMENT, "geodesic: a size is negative");
    if (hdi_geo_check(&o, c.e) < 0) return c.e->status;
    if (o.ordering == HD_ORDERING_OWN && hdi_sym_check(o.perm, n, c.ctx, c.e) < 0) return c.e->status;
    g = HDI_CAST(hd_geodesic *, hdi_alloc(c.ctx, 1, sizeof *g, c.e));
    if (!g) return c.e->status;
    memset(g, 0, sizeof *g);
    if (c.ctx == &c.context) {
        g->context = c.context;
        c.ctx = &g->context;
    }
    g->ctx = c.ctx;
    g->n = n;
    if (hdi_geo_make(g, xyz, tri, n_tri, &o, c.e) < 0) {
        hdi_geo_free(g);
        return c.e->status;
    }
    *out = g;
    return HD_OK;
}

HEATDIFF_API void hd_geodesic_free(hd_geodesic *g) { hdi_geo_free(g); }

static void hdi_geo_tell_plan(const hd_geodesic *g, hd_geodesic_report *rep) {
    if (!rep) return;
    rep->t = g->t;
    rep->h = g->h;
    rep->n_components = g->n_components;
    rep->ordering = g->sym.ordering;
    rep->factor_nnz = g->sym.nnz;
    rep->factor_flops = 2 * g->sym.flops;
}

static hd_status hdi_geo_end(hd_geodesic_report *rep, hd_error *e) {
    if (rep && e->status < 0) {
        rep->status = e->status;
        rep->error = *e;
    }
    return rep ? rep->status : e->status;
}

/* Checks the arguments of a query; the report is filled with what is known of the plan. */
static hd_status hdi_geo_begin(hd_geodesic *g, const int32_t *sources, int32_t k, const double *d, hd_geodesic_report *rep, hd_error *err,
                               hdi_call *c) {
    int32_t q;
    if (rep) {
        memset(rep, 0, sizeof *rep);
        hdi_error_clear(&rep->error);
    }
    if (hdi_enter(c, g ? g->ctx : NULL, err) < 0) return c->e->status;
    if (!g || (k > 0 && (!sources || !d))) return hdi_missing(c->e);
    hdi_geo_tell_plan(g, rep);
    for (q = 0; q < k; q++) {
        if (sources[q] >= 0 && sources[q] < g->n) continue;
        hdi_fail_face(c->e, HD_ERR_INDEX, "geodesic: a source is not in the mesh", -1, sources[q], sources[q]);
        c->e->column = q;
        return c->e->status;
    }
    return hdi_progress(g->ctx, "solve", 0, c->e);
}

HEATDIFF_API hd_status hd_geodesic_distance(hd_geodesic *g, int32_t n_sources, const int32_t *sources, double *d, hd_geodesic_report *report,
                                            hd_error *err) {
    hdi_call c;
    if (hdi_geo_begin(g, sources, n_sources, d, report, err, &c) < 0) return hdi_geo_end(report, c.e);
    if (n_sources < 1) hdi_fail(c.e, HD_ERR_ARGUMENT, "geodesic: there is no source");
    else (void)hdi_geo_one(g, sources, n_sources, d, report, c.e);
    return hdi_geo_end(report, c.e);
}

HEATDIFF_API hd_status hd_geodesic_distances(hd_geodesic *g, int32_t k, const int32_t *sources, double *D, size_t ldd,
                                             hd_geodesic_report *report, hd_error *err) {
    hdi_call c;
    int32_t q, n_cols;
    if (hdi_geo_begin(g, sources, k, D, report, err, &c) < 0) return hdi_geo_end(report, c.e);
    ldd = ldd ? ldd : HDI_CAST(size_t, g->n);
    if (k < 0) hdi_fail(c.e, HD_ERR_ARGUMENT, "geodesic: the number of sources is negative");
    else if (ldd < HDI_CAST(size_t, g->n)) hdi_fail(c.e, HD_ERR_ARGUMENT, "geodesic: the leading dimension is smaller than n");
    for (q = 0; q < k && c.e->status >= 0; q += n_cols) {
        const int32_t wide = k - q >= HDI_GEO_WIDE_FROM;
        double *to = D + HDI_CAST(size_t, q) * ldd;
        n_cols = !wide ? 1 : k - q < HDI_GEO_WIDE ? k - q : HDI_GEO_WIDE;
        if (hdi_progress(g->ctx, "solve", HDI_CAST(double, q) / k, c.e) < 0) break;
        if (wide) (void)hdi_geo_wide(g, sources + q, n_cols, to, ldd, report, c.e);
        else (void)hdi_geo_one(g, sources + q, 1, to, report, c.e);
    }
    return hdi_geo_end(report, c.e);
}

/* ==== [30] closing ==== */

#ifdef __cplusplus
}
#endif

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#endif /* HDI_KERNELS_READ */
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
