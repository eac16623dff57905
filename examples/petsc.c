/* petsc.c - beyond one machine: heat kernels of a mesh that is distributed by rows, on PETSc and MPI

   It needs PETSc with complex scalars and MUMPS, and SLEPc for a second opinion (leave -DUSE_SLEPC and slepc
   out if you do not have it). On Debian: apt install libpetsc-complex-dev libslepc-complex-dev openmpi-bin.
   From the project's folder:

       export PKG_CONFIG_PATH=$(find /usr/lib/petscdir /usr/lib/slepcdir -path '*complex*' -name pkgconfig |
           paste -sd:)
       mpicc -O2 -DUSE_SLEPC examples/petsc.c -o petsc $(pkg-config --cflags --libs slepc petsc) -lm
       OMP_NUM_THREADS=1 mpirun -np 4 ./petsc -size 100 -pole_groups 2

   Open MPI refuses more ranks than there are processors unless mpirun has --oversubscribe. Without the
   first line pkg-config may find PETSc with real scalars, and this file refuses to compile.
   Vertices need the number of bits that PetscInt has: beyond 2^31 take a PETSc with 64-bit indices.

   The answer is the library's,

       K_t f = a0 f - sum_i a_i (t L + theta_i B)^-1 B f,

   in three steps that each spread over machines by themselves:

     rows     A rank holds a range of rows. It takes the faces that touch its vertices, lets
              hd_laplacian_create assemble L and B of this patch, and keeps the rows of its own vertices:
              they are complete, because all their faces are there. Nobody holds the whole mesh, and assembly
              sends nothing. The mesh is a formula, or a file (-mesh), whose vertices are numbered along its
              longest side, so that near ones are near in number. Every rank reads the whole file here, and
              keeps the faces that touch its vertices. If it is too large for that, let one rank read it and
              send every face to the owners of its corners.
     poles    hd_rational_exp gives pairs of conjugate poles. Ranks are divided into groups, every group holds
              all rows, and takes some of the poles (-pole_groups) for some of the sources (-source_groups).
              Poles do not wait for each other; the answers are summed once, at the end.
     systems  Each t L + theta_i B is solved within a group, by MUMPS as a complex-symmetric L D L' without
              pivoting, which these matrices do not need. Or, with -iterative, by GMRES, preconditioned by
              algebraic multigrid (GAMG) on the real positive definite matrix t L + |theta_i| B. All
              eigenvalues of the product lie on the segment from 1 to theta_i/|theta_i|, away from zero
              whatever the mesh and t are, so that the number of steps does not grow with the mesh. PETSc's
              own options choose others: -ksp_type, -pc_type, -help. (KSPCG of the type symmetric would be
              COCG, but it gives up when the real part of p'Ap changes its sign, as it may here.)

   Options:
     -mesh FILE           OBJ, OFF, PLY or STL; vertices in no face are left out
     -size N              else a torus of 2N x N vertices (40)
     -t C                 the time in h^2 (100)
     -sources K           columns of K_t (2)
     -degree R            of the kernel set (14). Large sets have large weights a_i, which multiply what the
                          iterations leave as an error. Where 1e-8 is enough, take 9
     -kind NAME           fem or voronoi-cot (the default)
     -iterative           see above
     -check 0             do not compare with hd_heat_columns, which needs the whole mesh on one rank, and
                          with SLEPc's exp
     -predict             only say how large the factors are by the library's own analysis, on one rank
   The exit status is 1 if a difference is above 1e-10 of the largest value (iterative: 1e-8) and
   four times the error of the poles.

   SLEPc's exp needs one symmetric matrix, so it is asked for diagonal masses (voronoi-cot) only:
   K_t = B^-1/2 exp(-t B^-1/2 L B^-1/2) B^1/2. */

#include <petscksp.h>
#ifdef USE_SLEPC
#include <slepcmfn.h>
#endif

#if !defined(PETSC_USE_COMPLEX)
#error "this PETSc has real scalars: see the build command in the opening comment"
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-function"     /* meshio.h writes files too */
#endif
#include "../tools/meshio.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HD_CALL(call)                                                                              \
    do {                                                                                           \
        const hd_status st_ = (call);                                                              \
        PetscCheck(st_ >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "heatdiff: %s", hd_status_text(st_)); \
    } while (0)

/* Allowed differences relative to the largest value, beside the error of the poles: a few hundred times what
   was seen with factors, and ten times what the iterations leave. */
static const double DIRECT_TOLERANCE = 1e-10, ITERATIVE_TOLERANCE = 1e-8;
static const double POLES = 4;          /* times max_weighted_error; at most 1.5 times were seen */

typedef struct settings {
    PetscInt nu, nv, n;                 /* vertices around the torus, around its tube, and of both */
    PetscInt sources, degree, pole_groups, source_groups;
    PetscReal c;                        /* t = c h^2 */
    PetscBool iterative, check, predict;
    hd_laplacian_kind kind;
    double *xyz;                        /* [3 n] of a mesh from a file; NULL: the torus */
    PetscInt *tri, n_tri;               /* [3 n_tri] */
} settings;

/* Ranks that hold the rows of one copy of the matrices, and ranks that hold the same rows in all groups. */
typedef struct group {
    MPI_Comm comm, across;
    PetscInt lo, hi;                    /* rows of this rank */
    int pole_part, source_part;
} group;

typedef struct pair { Mat L, B; double h; } pair;

/* Summed over the systems of this rank's group. */
typedef struct costs { double bytes, largest, flops, iterations, seconds; PetscInt systems; } costs;

/* ---- the mesh: a file, or a torus with bumps by a formula ---- */

/* Numbers of the vertices that occur in tri, along the longest side of their box; -1: in no face. */
static PetscErrorCode number_vertices(const mio_mesh *m, const int32_t *tri, PetscInt n_tri, PetscInt *number,
                                      PetscInt *n) {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    PetscReal *along;
    PetscInt *order, k;
    int axis, longest = 0;
    PetscFunctionBeginUser;
    for (k = 0; k < m->n; k++) number[k] = -1;
    for (k = 0; k < 3 * n_tri; k++) number[tri[k]] = 0;
    PetscCall(PetscMalloc2(m->n, &along, m->n, &order));
    for (*n = 0, k = 0; k < m->n; k++) {
        if (number[k] < 0) continue;
        order[(*n)++] = k;
        for (axis = 0; axis < 3; axis++) {
            low[axis] = PetscMin(low[axis], m->xyz[3 * k + axis]);
            high[axis] = PetscMax(high[axis], m->xyz[3 * k + axis]);
        }
    }
    for (axis = 1; axis < 3; axis++)
        if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    for (k = 0; k < m->n; k++) along[k] = m->xyz[3 * k + longest];
    PetscCall(PetscSortRealWithPermutation(*n, along, order));
    for (k = 0; k < *n; k++) number[order[k]] = k;
    PetscCall(PetscFree2(along, order));
    PetscFunctionReturn(0);
}

static PetscErrorCode read_mesh(settings *s, const char *path) {
    mio_mesh m;
    mio_error e;
    int32_t *tri, n_tri;
    PetscInt *number, k;
    PetscFunctionBeginUser;
    PetscCheck(mio_load(&m, path, NULL, &e) == MIO_OK && mio_triangulate(&m, &tri, &n_tri, NULL, &e) == MIO_OK,
               PETSC_COMM_SELF, PETSC_ERR_FILE_READ, "%s", e.text);
    PetscCheck(n_tri > 0, PETSC_COMM_SELF, PETSC_ERR_FILE_READ, "%s has no faces", path);
    PetscCall(PetscMalloc1(m.n, &number));
    PetscCall(number_vertices(&m, tri, n_tri, number, &s->n));
    PetscCall(PetscMalloc2(3 * s->n, &s->xyz, 3 * n_tri, &s->tri));
    for (k = 0; k < m.n; k++)
        if (number[k] >= 0) PetscCall(PetscArraycpy(s->xyz + 3 * number[k], m.xyz + 3 * k, 3));
    for (k = 0; k < 3 * n_tri; k++) s->tri[k] = number[tri[k]];
    s->n_tri = n_tri;
    PetscCall(PetscFree(number));
    free(tri);
    mio_free(&m);
    PetscFunctionReturn(0);
}

static void position(const settings *s, PetscInt id, double *xyz) {
    const double pi = 3.14159265358979323846;
    const double u = 2 * pi * (double)(id / s->nv) / (double)s->nu;
    const double v = 2 * pi * (double)(id % s->nv) / (double)s->nv;
    const double r = 1 + 0.2 * sin(3 * u) * cos(2 * v);
    if (s->xyz) {
        memcpy(xyz, s->xyz + 3 * id, 3 * sizeof *xyz);
        return;
    }
    xyz[0] = (3 + r * cos(v)) * cos(u);
    xyz[1] = (3 + r * cos(v)) * sin(u);
    xyz[2] = r * sin(v);
}

/* Appends those of n triangles that touch a vertex in [lo, hi). */
static PetscInt touching(const PetscInt *corner, PetscInt n, const PetscInt range[2], PetscInt *faces,
                         PetscInt n_faces) {
    PetscInt f, k;
    for (f = 0; f < n; f++) {
        int touches = 0;
        for (k = 0; k < 3; k++) touches |= corner[3 * f + k] >= range[0] && corner[3 * f + k] < range[1];
        if (!touches) continue;
        memcpy(faces + 3 * n_faces, corner + 3 * f, 3 * sizeof *faces);
        n_faces++;
    }
    return n_faces;
}

/* The same of the two triangles of one square. */
static PetscInt square(const settings *s, PetscInt i, PetscInt j, const PetscInt range[2], PetscInt *faces,
                       PetscInt n_faces) {
    const PetscInt i1 = (i + 1) % s->nu, j1 = (j + 1) % s->nv;
    const PetscInt a = i * s->nv + j, b = i1 * s->nv + j, c = i1 * s->nv + j1, d = i * s->nv + j1;
    const PetscInt corner[6] = {a, b, c, a, c, d};
    return touching(corner, 2, range, faces, n_faces);
}

/* All triangles that touch a vertex in [lo, hi), in numbers of the whole mesh. */
static PetscErrorCode faces_of(const settings *s, PetscInt lo, PetscInt hi, PetscInt **faces,
                               PetscInt *count) {
    const PetscInt range[2] = {lo, hi};
    const PetscInt first = lo / s->nv, last = (hi - 1) / s->nv;
    const PetscInt strips = s->tri ? 0 : PetscMin(s->nu, hi > lo ? last - first + 2 : 0);
    PetscInt i, j;
    PetscFunctionBeginUser;
    PetscCall(PetscMalloc1(s->tri ? 3 * s->n_tri : 6 * strips * s->nv, faces));
    *count = s->tri ? touching(s->tri, s->n_tri, range, *faces, 0) : 0;
    for (i = 0; i < strips; i++)
        for (j = 0; j < s->nv; j++)
            *count = square(s, (first - 1 + i + s->nu) % s->nu, j, range, *faces, *count);
    PetscFunctionReturn(0);
}

/* ---- rows: L and B of the own vertices, from the patch of faces around them ---- */

typedef struct patch {
    PetscInt n, n_faces;
    PetscInt *id;                       /* [n] vertex of the patch -> of the mesh, ascending */
    PetscInt *faces;                    /* [3 n_faces] in numbers of the mesh */
    double *xyz;                        /* [3 n] */
    int32_t *tri;                       /* [3 n_faces] in numbers of the patch */
    hd_context ctx;
    hd_laplacian *lap;
} patch;

static PetscErrorCode patch_vertices(patch *p, const settings *s, PetscInt lo, PetscInt hi) {
    PetscInt i, at;
    PetscFunctionBeginUser;
    PetscCall(faces_of(s, lo, hi, &p->faces, &p->n_faces));
    p->n = 3 * p->n_faces;
    PetscCall(PetscMalloc1(p->n, &p->id));
    PetscCall(PetscMalloc1(p->n, &p->tri));
    PetscCall(PetscArraycpy(p->id, p->faces, p->n));
    PetscCall(PetscSortRemoveDupsInt(&p->n, p->id));
    PetscCall(PetscMalloc1(3 * p->n, &p->xyz));
    for (i = 0; i < p->n; i++) position(s, p->id[i], p->xyz + 3 * i);
    for (i = 0; i < 3 * p->n_faces; i++) {
        PetscCall(PetscFindInt(p->faces[i], p->n, p->id, &at));
        p->tri[i] = (int32_t)at;
    }
    PetscFunctionReturn(0);
}

static PetscErrorCode patch_make(patch *p, const settings *s, PetscInt lo, PetscInt hi) {
    hd_laplacian_opts opts;
    hd_mesh mesh;
    PetscFunctionBeginUser;
    memset(p, 0, sizeof *p);
    memset(&opts, 0, sizeof opts);
    PetscCall(patch_vertices(p, s, lo, hi));
    opts.kind = s->kind;
    opts.context = &p->ctx;
    p->ctx.n_threads = 1;               /* the processors belong to the ranks */
    mesh = hd_triangles(p->xyz, (int32_t)p->n, p->tri, (int32_t)p->n_faces);
    HD_CALL(hd_laplacian_create(&p->lap, &mesh, &opts, NULL));
    PetscFunctionReturn(0);
}

static PetscErrorCode patch_free(patch *p) {
    PetscFunctionBeginUser;
    hd_laplacian_free(p->lap);
    PetscCall(PetscFree(p->id));
    PetscCall(PetscFree(p->faces));
    PetscCall(PetscFree(p->xyz));
    PetscCall(PetscFree(p->tri));
    PetscFunctionReturn(0);
}

/* Mean edge length of the whole mesh. The owner of a face's first corner measures its edges. */
static PetscErrorCode mean_edge(const patch *p, const group *g, double *h) {
    double sum[2] = {0, 0};
    PetscInt f;
    int k;
    PetscFunctionBeginUser;
    for (f = 0; f < p->n_faces; f++) {
        if (p->faces[3 * f] < g->lo || p->faces[3 * f] >= g->hi) continue;
        for (k = 0; k < 3; k++) {
            const double *x = p->xyz + 3 * p->tri[3 * f + k], *y = p->xyz + 3 * p->tri[3 * f + (k + 1) % 3];
            sum[0] += sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                           (x[2] - y[2]) * (x[2] - y[2]));
            sum[1] += 1;
        }
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, g->comm));
    *h = sum[0] / sum[1];
    PetscFunctionReturn(0);
}

/* Row of the mesh -> row of the patch's L, or an error for a vertex in no face: K_t leaves its value as it
   is, and it has no place in the systems. */
static PetscErrorCode patch_row(const patch *p, PetscInt id, int32_t *row) {
    PetscInt at;
    PetscFunctionBeginUser;
    PetscCall(PetscFindInt(id, p->n, p->id, &at));
    *row = at < 0 ? -1 : p->lap->row[at];
    PetscCheck(*row >= 0, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "vertex %" PetscInt_FMT " has no mass", id);
    PetscFunctionReturn(0);
}

/* A matrix with the own rows of the patch's values, which stand on the pattern of its L. */
static PetscErrorCode own_rows(const patch *p, const group *g, PetscInt n, const double *values, Mat *A) {
    const hd_csr *a = &p->lap->L;
    const PetscInt rows = g->hi - g->lo;
    PetscInt i, *near_, *far_, *cols, longest = 0;
    PetscScalar *vals;
    int64_t k;
    int32_t r;
    PetscFunctionBeginUser;
    PetscCall(PetscCalloc2(rows, &near_, rows, &far_));
    for (i = 0; i < rows; i++) {
        PetscCall(patch_row(p, g->lo + i, &r));
        for (k = a->row_ptr[r]; k < a->row_ptr[r + 1]; k++) {
            const PetscInt j = p->id[p->lap->vertex[a->col[k]]];
            if (j >= g->lo && j < g->hi) near_[i]++; else far_[i]++;
        }
        longest = PetscMax(longest, near_[i] + far_[i]);
    }
    PetscCall(MatCreateAIJ(g->comm, rows, rows, n, n, 0, near_, 0, far_, A));
    PetscCall(PetscMalloc2(longest, &cols, longest, &vals));
    for (i = g->lo; i < g->hi; i++) {
        PetscInt count = 0;
        PetscCall(patch_row(p, i, &r));
        for (k = a->row_ptr[r]; k < a->row_ptr[r + 1]; k++, count++) {
            cols[count] = p->id[p->lap->vertex[a->col[k]]];
            vals[count] = values[k];
        }
        PetscCall(MatSetValues(*A, 1, &i, count, cols, vals, INSERT_VALUES));
    }
    PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
    PetscCall(MatSetOption(*A, MAT_SYMMETRIC, PETSC_TRUE));
    PetscCall(PetscFree2(near_, far_));
    PetscCall(PetscFree2(cols, vals));
    PetscFunctionReturn(0);
}

/* The pair (L, B) distributed over the ranks of the group. A diagonal B is given zeros on the pattern of L,
   a few bytes for a vertex, so that one way suits all kinds. */
static PetscErrorCode pair_make(pair *m, const settings *s, const group *g) {
    patch p;
    double *diagonal = NULL;
    int32_t r;
    int64_t k;
    PetscFunctionBeginUser;
    PetscCall(patch_make(&p, s, g->lo, g->hi));
    if (!p.lap->B) {
        PetscCall(PetscCalloc1(p.lap->L.nnz, &diagonal));
        for (r = 0; r < p.lap->n_active; r++)
            for (k = p.lap->L.row_ptr[r]; k < p.lap->L.row_ptr[r + 1]; k++)
                if (p.lap->L.col[k] == r) diagonal[k] = p.lap->mass[r];
    }
    PetscCall(own_rows(&p, g, s->n, p.lap->L.val, &m->L));
    PetscCall(own_rows(&p, g, s->n, diagonal ? diagonal : p.lap->B, &m->B));
    PetscCall(mean_edge(&p, g, &m->h));
    PetscCall(PetscFree(diagonal));
    PetscCall(patch_free(&p));
    PetscFunctionReturn(0);
}

/* ---- groups ---- */

static PetscErrorCode group_make(group *g, const settings *s) {
    int rank, size;
    PetscInt rows = PETSC_DECIDE, n = s->n;
    const int parts = (int)(s->pole_groups * s->source_groups);
    PetscFunctionBeginUser;
    PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
    PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
    PetscCheck(parts > 0 && size % parts == 0, PETSC_COMM_WORLD, PETSC_ERR_ARG_WRONG,
               "%d ranks do not divide into %d groups", size, parts);
    PetscCallMPI(MPI_Comm_split(PETSC_COMM_WORLD, rank / (size / parts), rank, &g->comm));
    PetscCallMPI(MPI_Comm_split(PETSC_COMM_WORLD, rank % (size / parts), rank, &g->across));
    g->pole_part = rank / (size / parts) % (int)s->pole_groups;
    g->source_part = rank / (size / parts) / (int)s->pole_groups;
    PetscCall(PetscSplitOwnership(g->comm, &rows, &n));
    PetscCallMPI(MPI_Scan(&rows, &g->hi, 1, MPIU_INT, MPI_SUM, g->comm));
    g->lo = g->hi - rows;
    PetscFunctionReturn(0);
}

/* ---- systems ---- */

static PetscErrorCode solver_make(KSP *ksp, const settings *s, const group *g, Mat A, Mat P) {
    PC pc;
    Mat F;
    PetscFunctionBeginUser;
    PetscCall(KSPCreate(g->comm, ksp));
    PetscCall(KSPSetOperators(*ksp, A, P));
    PetscCall(KSPGetPC(*ksp, &pc));
    if (s->iterative) {
        PetscCall(KSPSetType(*ksp, KSPGMRES));
        PetscCall(KSPGMRESSetRestart(*ksp, 60));
        PetscCall(KSPSetTolerances(*ksp, 1e-11, PETSC_DEFAULT, PETSC_DEFAULT, 2000));
        PetscCall(PCSetType(pc, PCGAMG));
    } else {
        PetscCall(KSPSetType(*ksp, KSPPREONLY));
        PetscCall(PCSetType(pc, PCCHOLESKY));
        PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
        PetscCall(PCFactorSetUpMatSolverType(pc));
        PetscCall(PCFactorGetMatrix(pc, &F));
        PetscCall(MatMumpsSetCntl(F, 1, 0)); /* no pivoting: the matrix, rotated, has a definite real part */
    }
    PetscCall(KSPSetFromOptions(*ksp));
    PetscFunctionReturn(0);
}

/* What MUMPS says of its factor: INFOG(29) counts entries, in millions if it is negative, RINFOG(3) complex
   operations. A complex multiplication and addition are eight real ones instead of two. */
static PetscErrorCode solver_costs(KSP ksp, costs *c) {
    PC pc;
    Mat F;
    MatSolverType type;
    PetscBool direct, mumps = PETSC_FALSE;
    PetscInt entries;
    PetscReal flops;
    double bytes;
    PetscFunctionBeginUser;
    PetscCall(KSPGetPC(ksp, &pc));
    PetscCall(PetscObjectTypeCompareAny((PetscObject)pc, &direct, PCCHOLESKY, PCLU, ""));
    if (direct) {
        PetscCall(PCFactorGetMatSolverType(pc, &type));
        PetscCall(PetscStrcmp(type, MATSOLVERMUMPS, &mumps));
    }
    if (mumps) {
        PetscCall(PCFactorGetMatrix(pc, &F));
        PetscCall(MatMumpsGetInfog(F, 29, &entries));
        PetscCall(MatMumpsGetRinfog(F, 3, &flops));
        bytes = sizeof(PetscScalar) * (entries < 0 ? -1e6 * (double)entries : (double)entries);
        c->largest = PetscMax(c->largest, bytes);
        c->bytes += bytes;
        c->flops += 4 * flops;
    }
    PetscFunctionReturn(0);
}

static PetscInt source(const settings *s, PetscInt q) {
    return (PetscInt)(((double)q + 0.3) * (double)s->n / (double)s->sources);
}

static PetscErrorCode source_field(const settings *s, PetscInt q, Vec e) {
    PetscInt lo, hi, i = source(s, q);
    PetscFunctionBeginUser;
    PetscCall(VecSet(e, 0));
    PetscCall(VecGetOwnershipRange(e, &lo, &hi));
    if (i >= lo && i < hi) PetscCall(VecSetValue(e, i, 1, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(e));
    PetscCall(VecAssemblyEnd(e));
    PetscFunctionReturn(0);
}

/* u[q] += weight Re(a x), x = (t L + theta B)^-1 B e_q, for the group's sources. */
static PetscErrorCode pole_sources(KSP ksp, const settings *s, const group *g, const pair *m, PetscScalar a,
                                   double weight, double *u, costs *c) {
    const PetscInt rows = g->hi - g->lo;
    const PetscScalar *x;
    Vec e, b, y;
    PetscInt q, i, steps;
    KSPConvergedReason reason;
    PetscFunctionBeginUser;
    PetscCall(MatCreateVecs(m->L, &e, &b));
    PetscCall(VecDuplicate(e, &y));
    for (q = g->source_part; q < s->sources; q += s->source_groups) {
        PetscCall(source_field(s, q, e));
        PetscCall(MatMult(m->B, e, b));
        PetscCall(KSPSolve(ksp, b, y));
        PetscCall(KSPGetConvergedReason(ksp, &reason));
        PetscCheck(reason > 0, g->comm, PETSC_ERR_CONV_FAILED, "%s", KSPConvergedReasons[reason]);
        PetscCall(KSPGetIterationNumber(ksp, &steps));
        c->iterations += (double)steps;
        PetscCall(VecGetArrayRead(y, &x));
        for (i = 0; i < rows; i++) u[q * rows + i] += weight * PetscRealPart(a * x[i]);
        PetscCall(VecRestoreArrayRead(y, &x));
    }
    PetscCall(VecDestroy(&e));
    PetscCall(VecDestroy(&b));
    PetscCall(VecDestroy(&y));
    PetscFunctionReturn(0);
}

/* One pole for all sources of the group. The factor is freed again, so that a group holds one at a time. */
static PetscErrorCode pole(const settings *s, const group *g, const pair *m, const hd_rational *set,
                           int32_t p, double t, double *u, costs *c) {
    const PetscScalar theta = PetscCMPLX(set->theta[p].re, set->theta[p].im);
    const PetscScalar a = PetscCMPLX(set->a[p].re, set->a[p].im);
    Mat A, P;
    KSP ksp;
    PetscFunctionBeginUser;
    PetscCall(MatDuplicate(m->L, MAT_COPY_VALUES, &A));
    PetscCall(MatScale(A, t));
    PetscCall(MatDuplicate(A, MAT_COPY_VALUES, &P));
    PetscCall(MatAXPY(A, theta, m->B, SAME_NONZERO_PATTERN));
    PetscCall(MatAXPY(P, PetscAbsScalar(theta), m->B, SAME_NONZERO_PATTERN));
    PetscCall(MatSetOption(A, MAT_SYMMETRIC, PETSC_TRUE));
    PetscCall(MatSetOption(P, MAT_SPD, PETSC_TRUE));
    PetscCall(solver_make(&ksp, s, g, A, s->iterative ? P : A));
    PetscCall(MatDestroy(&P));
    PetscCall(pole_sources(ksp, s, g, m, a, set->theta[p].im == 0 ? -1 : -2, u, c));
    PetscCall(solver_costs(ksp, c));
    c->systems++;
    PetscCall(KSPDestroy(&ksp));
    PetscCall(MatDestroy(&A));
    PetscFunctionReturn(0);
}

/* The own rows of K_t e_i for all sources, on every group. */
static PetscErrorCode heat(const settings *s, const group *g, const pair *m, const hd_rational *set, double t,
                           double *u, costs *c) {
    const PetscInt rows = g->hi - g->lo;
    PetscInt q, i;
    int32_t p;
    PetscFunctionBeginUser;
    PetscCall(PetscArrayzero(u, rows * s->sources));
    for (p = g->pole_part; p < set->n_poles; p += (int32_t)s->pole_groups)
        PetscCall(pole(s, g, m, set, p, t, u, c));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, u, (int)(rows * s->sources), MPI_DOUBLE, MPI_SUM, g->across));
    for (q = 0; q < s->sources; q++) {
        i = source(s, q);
        if (i >= g->lo && i < g->hi) u[q * rows + i - g->lo] += set->a0;
    }
    PetscFunctionReturn(0);
}

/* ---- what the answer is compared with ---- */

/* Largest difference and largest value over the rows and columns of all ranks. */
static PetscErrorCode difference(const group *g, const double *u, const double *want, PetscInt count,
                                 double *worst) {
    double most[2] = {0, 0};
    PetscInt i;
    PetscFunctionBeginUser;
    for (i = 0; i < count; i++) {
        most[0] = PetscMax(most[0], fabs(u[i] - want[i]));
        most[1] = PetscMax(most[1], fabs(want[i]));
        if (u[i] != u[i]) most[0] = HUGE_VAL;
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, g->comm));
    *worst = most[0] / most[1];
    PetscFunctionReturn(0);
}

/* The columns of hd_heat_columns on one rank. */
static PetscErrorCode whole(const settings *s, double t, double *U, double *bound) {
    patch p;
    hd_heat *plan = NULL;
    hd_heat_opts opts;
    hd_report report;
    int32_t *sources;
    hd_sources from;
    PetscInt q;
    PetscFunctionBeginUser;
    PetscCall(patch_make(&p, s, 0, s->n));
    PetscCall(PetscMalloc1(s->sources, &sources));
    for (q = 0; q < s->sources; q++) sources[q] = (int32_t)source(s, q);
    memset(&opts, 0, sizeof opts);
    opts.method = HD_METHOD_KRYLOV;     /* no poles: an error in the poles would show */
    opts.tol = 1e-12;
    from = hd_vertices((int32_t)s->sources, sources);
    HD_CALL(hd_heat_create(&plan, p.lap, &opts, NULL));
    HD_CALL(hd_heat_columns(plan, HD_KERNEL_OPERATOR, 1, &t, &from, U, 0, &report, NULL));
    *bound = report.error_bound;
    hd_heat_free(plan);
    PetscCall(PetscFree(sources));
    PetscCall(patch_free(&p));
    PetscFunctionReturn(0);
}

/* Difference from our own plan on rank 0 of the group, which then sends each rank its rows. */
static PetscErrorCode compare_own(const settings *s, const group *g, double t, const double *u,
                                  double *worst) {
    const PetscInt rows = g->hi - g->lo;
    double *U = NULL, *want, bound = 0;
    int rank, size, r, *counts, *starts, mine = (int)rows, lo = (int)g->lo;
    PetscInt q;
    PetscFunctionBeginUser;
    PetscCallMPI(MPI_Comm_rank(g->comm, &rank));
    PetscCallMPI(MPI_Comm_size(g->comm, &size));
    PetscCall(PetscMalloc3(rows * s->sources, &want, size, &counts, size, &starts));
    PetscCallMPI(MPI_Gather(&mine, 1, MPI_INT, counts, 1, MPI_INT, 0, g->comm));
    PetscCallMPI(MPI_Gather(&lo, 1, MPI_INT, starts, 1, MPI_INT, 0, g->comm));
    r = rank == 0;
    PetscCall(PetscMalloc1(r ? s->n * s->sources : 0, &U));
    if (r) PetscCall(whole(s, t, U, &bound));
    for (q = 0; q < s->sources; q++)
        PetscCallMPI(MPI_Scatterv(r ? U + q * s->n : NULL, counts, starts, MPI_DOUBLE, want + q * rows, mine,
                                  MPI_DOUBLE, 0, g->comm));
    PetscCall(difference(g, u, want, rows * s->sources, worst));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "difference from hd_heat_columns on one rank: %.1e of the largest"
                          " value (its own bound: %.1e)\n", *worst, bound));
    PetscCall(PetscFree(U));
    PetscCall(PetscFree3(want, counts, starts));
    PetscFunctionReturn(0);
}

#ifdef USE_SLEPC
/* Difference from B^-1/2 exp(-t S) B^1/2 e, S = B^-1/2 L B^-1/2, by SLEPc's Krylov method without poles. */
static PetscErrorCode compare_slepc(const settings *s, const group *g, const pair *m, double t,
                                    const double *u, double *worst) {
    const PetscInt rows = g->hi - g->lo;
    Mat S;
    Vec root, inverse, e, y;
    MFN mfn;
    FN f;
    PetscInt q, i;
    const PetscScalar *x;
    double *want;
    PetscFunctionBeginUser;
    PetscCall(MatDuplicate(m->L, MAT_COPY_VALUES, &S));
    PetscCall(MatCreateVecs(m->L, &e, &y));
    PetscCall(VecDuplicate(e, &root));
    PetscCall(VecDuplicate(e, &inverse));
    PetscCall(MatGetDiagonal(m->B, root));
    PetscCall(VecSqrtAbs(root));
    PetscCall(VecCopy(root, inverse));
    PetscCall(VecReciprocal(inverse));
    PetscCall(MatDiagonalScale(S, inverse, inverse));
    PetscCall(MatSetOption(S, MAT_HERMITIAN, PETSC_TRUE));
    PetscCall(MFNCreate(g->comm, &mfn));
    PetscCall(MFNSetOperator(mfn, S));
    PetscCall(MFNGetFN(mfn, &f));
    PetscCall(FNSetType(f, FNEXP));
    PetscCall(FNSetScale(f, -t, 1));
    PetscCall(MFNSetTolerances(mfn, 1e-12, 5000));
    PetscCall(MFNSetFromOptions(mfn));
    PetscCall(PetscMalloc1(rows * s->sources, &want));
    for (q = 0; q < s->sources; q++) {
        PetscCall(source_field(s, q, e));
        PetscCall(VecPointwiseMult(e, e, root));
        PetscCall(MFNSolve(mfn, e, y));
        PetscCall(VecPointwiseMult(y, y, inverse));
        PetscCall(VecGetArrayRead(y, &x));
        for (i = 0; i < rows; i++) want[q * rows + i] = PetscRealPart(x[i]);
        PetscCall(VecRestoreArrayRead(y, &x));
    }
    PetscCall(difference(g, u, want, rows * s->sources, worst));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "difference from SLEPc's exp: %.1e of the largest value\n",
                          *worst));
    PetscCall(PetscFree(want));
    PetscCall(MFNDestroy(&mfn));
    PetscCall(MatDestroy(&S));
    PetscCall(VecDestroy(&root));
    PetscCall(VecDestroy(&inverse));
    PetscCall(VecDestroy(&e));
    PetscCall(VecDestroy(&y));
    PetscFunctionReturn(0);
}
#endif

/* ---- the whole ---- */

/* The size of one complex factor by the library's own analysis on one rank: nothing is factorised. */
static PetscErrorCode predict(const settings *s) {
    patch p;
    hd_ldl *f = NULL;
    hd_ldl_opts opts;
    hd_ldl_report r;
    PetscFunctionBeginUser;
    PetscCall(patch_make(&p, s, 0, s->n));
    memset(&opts, 0, sizeof opts);
    opts.xyz = p.lap->xyz;
    opts.context = &p.ctx;
    HD_CALL(hd_ldl_analyse(&f, &p.lap->L, &opts, &r, NULL));
    PetscCall(PetscPrintf(PETSC_COMM_SELF, "%" PetscInt_FMT " vertices: %.4g entries in a factor, %.1f for a"
                          " vertex; %.4g GB and %.4g GF for a complex pole\n", s->n, (double)r.factor_nnz,
                          (double)r.factor_nnz / (double)s->n, 16e-9 * (double)r.factor_nnz,
                          4e-9 * r.factor_flops));
    hd_ldl_free(f);
    PetscCall(patch_free(&p));
    PetscFunctionReturn(0);
}

static PetscErrorCode options(settings *s) {
    PetscInt size = 40;
    char kind[32] = "voronoi-cot", path[PETSC_MAX_PATH_LEN];
    PetscBool fem, from_file;
    PetscFunctionBeginUser;
    memset(s, 0, sizeof *s);
    s->sources = 2;
    s->degree = 14;
    s->c = 100;
    s->pole_groups = s->source_groups = 1;
    s->check = PETSC_TRUE;
    PetscCall(PetscOptionsGetInt(NULL, NULL, "-size", &size, NULL));
    PetscCall(PetscOptionsGetInt(NULL, NULL, "-sources", &s->sources, NULL));
    PetscCall(PetscOptionsGetInt(NULL, NULL, "-degree", &s->degree, NULL));
    PetscCall(PetscOptionsGetInt(NULL, NULL, "-pole_groups", &s->pole_groups, NULL));
    PetscCall(PetscOptionsGetInt(NULL, NULL, "-source_groups", &s->source_groups, NULL));
    PetscCall(PetscOptionsGetReal(NULL, NULL, "-t", &s->c, NULL));
    PetscCall(PetscOptionsGetBool(NULL, NULL, "-iterative", &s->iterative, NULL));
    PetscCall(PetscOptionsGetBool(NULL, NULL, "-check", &s->check, NULL));
    PetscCall(PetscOptionsGetBool(NULL, NULL, "-predict", &s->predict, NULL));
    PetscCall(PetscOptionsGetString(NULL, NULL, "-kind", kind, sizeof kind, NULL));
    PetscCall(PetscStrcmp(kind, "fem", &fem));
    s->kind = fem ? HD_LAPLACIAN_FEM : HD_LAPLACIAN_VORONOI_COT;
    s->nu = 2 * size;
    s->nv = size;
    s->n = s->nu * s->nv;
    PetscCall(PetscOptionsGetString(NULL, NULL, "-mesh", path, sizeof path, &from_file));
    if (from_file) PetscCall(read_mesh(s, path));
    PetscCheck(size >= 4 && s->sources >= 1 && s->c > 0, PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE,
               "-size from 4, -sources from 1, -t above 0");
    PetscFunctionReturn(0);
}

static PetscErrorCode say(const settings *s, const group *g, const hd_rational *set, double rows, costs c) {
    int ranks, size;
    double sums[3] = {c.bytes, c.flops, c.iterations};
    double most[4] = {c.largest, c.seconds, rows, (double)c.systems};
    PetscFunctionBeginUser;
    PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
    PetscCallMPI(MPI_Comm_size(g->comm, &size));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, g->across));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 4, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%" PetscInt_FMT " vertices, %d ranks in groups of %d: %"
                          PetscInt_FMT " for poles, %" PetscInt_FMT " for sources; t = %g h^2, degree %d, %d"
                          " systems, at most %d in a group\n", s->n, ranks, size, s->pole_groups,
                          s->source_groups, (double)s->c, (int)set->degree, (int)set->n_poles, (int)most[3]));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "rows in %.2f s, systems in %.2f s", most[2], most[1]));
    if (sums[0] > 0)
        PetscCall(PetscPrintf(PETSC_COMM_WORLD, "; factors %.4g MB each, all together %.4g MB and %.4g GF",
                              1e-6 * most[0], 1e-6 * sums[0], 1e-9 * sums[1]));
    else
        PetscCall(PetscPrintf(PETSC_COMM_WORLD, "; %.1f steps for a system and a source",
                              sums[2] / (double)(set->n_poles * s->sources)));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n"));
    PetscFunctionReturn(0);
}

static PetscErrorCode run(const settings *s, double *worst, double *allowed) {
    group g;
    pair m;
    hd_rational set;
    costs c;
    double *u, t, start, rows;
    PetscFunctionBeginUser;
    memset(&c, 0, sizeof c);
    HD_CALL(hd_rational_exp(&set, HD_POLES_KERNEL, (int32_t)s->degree, NULL));
    PetscCall(group_make(&g, s));
    start = MPI_Wtime();
    PetscCall(pair_make(&m, s, &g));
    rows = MPI_Wtime() - start;
    t = s->c * m.h * m.h;
    PetscCall(PetscMalloc1((g.hi - g.lo) * s->sources, &u));
    start = MPI_Wtime();
    PetscCall(heat(s, &g, &m, &set, t, u, &c));
    c.seconds = MPI_Wtime() - start;
    PetscCall(say(s, &g, &set, rows, c));
    *worst = *allowed = 0;
    if (s->check) {
        *allowed = POLES * set.max_weighted_error + (s->iterative ? ITERATIVE_TOLERANCE : DIRECT_TOLERANCE);
        PetscCall(compare_own(s, &g, t, u, worst));
#ifdef USE_SLEPC
        if (s->kind == HD_LAPLACIAN_VORONOI_COT) {
            double other;
            PetscCall(compare_slepc(s, &g, &m, t, u, &other));
            *worst = PetscMax(*worst, other);
        }
#endif
    }
    PetscCall(PetscFree(u));
    PetscCall(MatDestroy(&m.L));
    PetscCall(MatDestroy(&m.B));
    PetscCallMPI(MPI_Comm_free(&g.comm));
    PetscCallMPI(MPI_Comm_free(&g.across));
    PetscFunctionReturn(0);
}

int main(int argc, char **argv) {
    settings s;
    double worst = 0, allowed = 0;
#ifdef USE_SLEPC
    PetscCall(SlepcInitialize(&argc, &argv, NULL, NULL));
#else
    PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
#endif
    PetscCall(options(&s));
    if (s.predict) PetscCall(predict(&s));
    else PetscCall(run(&s, &worst, &allowed));
    PetscCall(PetscFree2(s.xyz, s.tri));
#ifdef USE_SLEPC
    PetscCall(SlepcFinalize());
#else
    PetscCall(PetscFinalize());
#endif
    return worst <= allowed ? 0 : 1;
}
