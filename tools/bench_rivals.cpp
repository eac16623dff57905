/* bench_rivals.cpp - see bench_rivals.h.

   What makes the rivals quick, as measured on two AVX-512 cores with Debian's SuiteSparse 5.12 and OpenBLAS 0.3.21, 50000 to 1000000 vertices:
   - CHOLMOD's supernodal factorisation opens OpenMP regions of 4 threads (CHOLMOD_OMP_NUM_THREADS when it was built), whatever
     omp_set_num_threads says. Kept from that (max_active_levels 0) it is 1.4 to 2 times quicker, with BLAS on one thread and on two.
   - UMFPACK without iterative refinement: solves 4 times quicker, and the error is that of the poles anyhow.
   - Many columns: a threaded BLAS hardly helps a block of 32 solves, so blocks run side by side with single-threaded BLAS. B is renumbered like
     the factor, so that nothing is permuted from step to step: a tenth off the solves.
   - Eigenpairs: bases of 1.25, 1.5, 2 and 3 times as many vectors as are wanted (300 of 50000 rows) take 643, 680, 753 and 902 solves and 0.86, 0.86, 1 and
     1.3 of the processor's time: 1.5 it is. A tolerance of 1e-6 instead of 1e-10 takes as many solves. Rows stay renumbered like the factor.
   - Larger relaxed supernodes: factor a sixth quicker, single solves a tenth slower, twenty steps together the same within 3 %. Left alone. */

#include "bench_rivals.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <climits>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#if defined(_OPENMP)
#include <omp.h>
#endif
#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define RIVAL_X86 1
#endif

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#if defined(__has_include) && !__has_include(<suitesparse/cholmod.h>)
#include <cholmod.h>
#include <umfpack.h>
#else
#include <suitesparse/cholmod.h>
#include <suitesparse/umfpack.h>
#endif

#if defined(HEATDIFF_BENCH_CGAL)
#define CGAL_EIGEN3_ENABLED 1
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Heat_method_3/Surface_mesh_geodesic_distances_3.h>
#endif

#if defined(HEATDIFF_BENCH_ARPACK)
/* Fortran: lengths of the texts come last. */
extern "C" void dsaupd_(int *ido, const char *bmat, const int *n, const char *which, const int *nev, const double *tol, double *resid, const int *ncv, double *v,
                        const int *ldv, int *iparam, int *ipntr, double *workd, double *workl, const int *lworkl, int *info, size_t, size_t);
extern "C" void dseupd_(const int *rvec, const char *howmny, int *select, double *d, double *z, const int *ldz, const double *sigma, const char *bmat, const int *n,
                        const char *which, const int *nev, const double *tol, double *resid, const int *ncv, double *v, const int *ldv, int *iparam, int *ipntr,
                        double *workd, double *workl, const int *lworkl, int *info, size_t, size_t, size_t);
#endif

/* Weak: with another BLAS they are simply not there. */
#if defined(__GNUC__)
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
extern "C" int openblas_get_num_threads(void) __attribute__((weak));
extern "C" char *openblas_get_corename(void) __attribute__((weak));
#else
static void (*const openblas_set_num_threads)(int) = nullptr;
static int (*const openblas_get_num_threads)() = nullptr;
static char *(*const openblas_get_corename)() = nullptr;
#endif

namespace {

typedef std::complex<double> complex;
typedef Eigen::Map<const Eigen::MatrixXd> ConstMatrix;
typedef Eigen::Map<Eigen::MatrixXd> Matrix;
typedef Eigen::Map<const Eigen::VectorXd> ConstVector;

/* ==== clock, threads, arrays ==== */

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/* An array without first values: pages that are not used cost nothing. */
struct Array {
    std::unique_ptr<double[]> p;
    Array() {}
    explicit Array(size_t n) : p(new double[n]) {}
    operator double *() const { return p.get(); }
};

/* While it lives: loops of ours may run on `loops` threads, BLAS on `blas`, and libraries cannot open OpenMP regions of their own. */
class Threads {
public:
    Threads(int loops, int blas) {
#if defined(_OPENMP)
        levels = omp_get_max_active_levels();
        omp_set_max_active_levels(loops > 1 ? 1 : 0);
#else
        (void)loops;
#endif
        if (openblas_get_num_threads) old_blas = openblas_get_num_threads();
        if (openblas_set_num_threads) openblas_set_num_threads(blas);
    }
    ~Threads() {
#if defined(_OPENMP)
        omp_set_max_active_levels(levels);
#endif
        if (openblas_set_num_threads) openblas_set_num_threads(old_blas);
    }
    Threads(const Threads &) = delete;
    Threads &operator=(const Threads &) = delete;

private:
#if defined(_OPENMP)
    int levels = 1;
#endif
    int old_blas = 1;
};

/* work(k) for k = 0, 1, ... on the threads; nothing is begun after `seconds`. Returns how many were done, always the first ones. An exception in
 * work stops the loop and is thrown again on the calling thread. */
template <class Work> int share(int n, int threads, double seconds, Work work) {
    (void)threads;  /* without OpenMP */
    std::atomic<int> next(0), done(0);
    std::exception_ptr failure;
    const double start = now();
#pragma omp parallel num_threads(threads)
    try {
        for (;;) {
            if (seconds > 0 && next > 0 && now() - start > seconds) break;
            const int k = next++;
            if (k >= n) break;
            work(k);
            done++;
        }
    } catch (...) {
#pragma omp critical(rival_failure)
        failure = std::current_exception();
        next = n;
    }
    if (failure) std::rethrow_exception(failure);
    return done;
}

int thread_id() {
#if defined(_OPENMP)
    return omp_get_thread_num();
#else
    return 0;
#endif
}

/* ==== the job with its defaults ==== */

struct Job : rival_job {
    explicit Job(const rival_job &j) : rival_job(j) {
        if (!(target > 0)) target = 1e-7;
        if (!(gamma > 0)) gamma = 0.1;
        if (width <= 0) width = pair->n > 400000 ? 8 : 32;
        if (threads <= 0) threads = 1;
        if (runs <= 0) runs = 1;
#if !defined(_OPENMP)
        threads = 1;
#endif
    }
    double time() const { return times[0]; }
    size_t rows() const { return (size_t)pair->n; }
};

/* Where answers go: the columns the caller keeps, or that are compared with the reference. */
class Answers {
public:
    Answers(const Job &job, double *U, int n_columns) : n(job.rows()), reference(job.reference), target(U) {
        n_kept = !U ? 0 : job.n_keep > 0 ? std::min(job.n_keep, n_columns) : n_columns;
        n_reference = reference ? std::min(job.n_reference, n_columns) : 0;
        if (n_kept < n_reference) {
            own = Array(n * (size_t)n_reference);
            target = own;
            copy_to = U;
            n_copy = n_kept;
            n_kept = n_reference;
        }
    }
    ~Answers() {
        if (copy_to) std::copy(target, target + n * (size_t)n_copy, copy_to);
    }
    /* Column c, or `scratch` when nobody looks at it. */
    double *column(int c, double *scratch) const { return c < n_kept ? target + n * (size_t)c : scratch; }
    double error(int columns_run) const;

private:
    size_t n;
    const double *reference;
    double *target, *copy_to = nullptr;
    Array own;
    int n_kept, n_reference, n_copy = 0;
};

/* max |u - r| / max |r| */
double relative_error(const double *u, const double *r, size_t n) {
    double e = 0, m = 0;
    for (size_t i = 0; i < n; i++) {
        const double d = std::fabs(u[i] - r[i]);
        if (!(d <= e)) e = d;
        m = std::max(m, std::fabs(r[i]));
    }
    return e / m;
}

double Answers::error(int columns_run) const {
    double e = -1;
    for (int c = 0; c < std::min(n_reference, columns_run); c++) {
        const size_t at = n * (size_t)c;
        e = std::max(e, relative_error(target + at, reference + at, n));
    }
    return e;
}

/* The quickest of the timed runs. run(result) fills in one. */
template <class Run> void best_run(const Job &job, rival_result *out, Run run) {
    for (int k = 0; k < job.warm_runs + job.runs; k++) {
        rival_result r = *out;
        run(&r);
        r.total = r.analyse + r.factor + r.first;
        r.total_columns = r.analyse + r.factor + r.columns;
        if (r.columns > r.first) r.columns_run = std::max(r.columns_run, 1);
        if (k == job.warm_runs || (k > job.warm_runs && r.total_columns < out->total_columns)) *out = r;
    }
}

/* ==== CHOLMOD ==== */

int cholmod_ordering(rival_ordering o) { return o == RIVAL_METIS ? CHOLMOD_METIS : CHOLMOD_AMD; }

/* Factor of B + g L = P' M M' P. */
class Factor {
public:
    cholmod_factor *F = nullptr;

    Factor() {
        cholmod_start(&common);
        common.print = 0;
        common.nmethods = 1;
        common.postorder = 1;
        common.supernodal = CHOLMOD_SUPERNODAL;
    }
    ~Factor() {
        cholmod_free_sparse(&A, &common);
        cholmod_free_factor(&F, &common);
        cholmod_finish(&common);
    }
    Factor(const Factor &) = delete;
    Factor &operator=(const Factor &) = delete;

    /* A = lower triangle of B + g L: row i of the upper triangle is column i of the lower. */
    void assemble(const rival_pair &p, double g) {
        const int64_t entries = p.ptr[p.n];
        int64_t k = 0;
        if (entries > INT_MAX) throw std::runtime_error("too many entries for CHOLMOD's int");
        cholmod_free_sparse(&A, &common);
        A = cholmod_allocate_sparse((size_t)p.n, (size_t)p.n, (size_t)((entries + p.n) / 2), 1, 1, -1, CHOLMOD_REAL, &common);
        if (!A) throw std::bad_alloc();
        int *Ap = (int *)A->p, *Ai = (int *)A->i;
        double *Ax = (double *)A->x;
        for (int32_t i = 0; i < p.n; i++) {
            Ap[i] = (int)k;
            for (int64_t q = p.ptr[i]; q < p.ptr[i + 1]; q++) {
                if (p.col[q] < i) continue;
                Ai[k] = p.col[q];
                Ax[k++] = p.B[q] + g * p.L[q];
            }
        }
        Ap[p.n] = (int)k;
    }
    void analyse(rival_ordering ordering) {
        common.method[0].ordering = cholmod_ordering(ordering);
        cholmod_free_factor(&F, &common);
        F = cholmod_analyze(A, &common);
        if (!F || common.status < 0) throw std::runtime_error("CHOLMOD: analysis failed");
        nnz = common.lnz;
        flops = common.fl;
    }
    /* The analysis of another shift of the same pair. */
    void analysed_as(const Factor &other) {
        F = cholmod_copy_factor(other.F, &common);
        if (!F) throw std::bad_alloc();
        nnz = other.nnz;
        flops = other.flops;
    }
    void factorise() {
        cholmod_factorize(A, F, &common);
        if (common.status < 0) throw std::runtime_error("CHOLMOD: factorisation failed");
        if (common.status > 0) throw std::runtime_error("CHOLMOD: matrix not positive definite");
    }
    const int *perm() const { return (const int *)F->Perm; }
    double bytes() const { return (double)common.memory_usage; }

    double nnz = 0, flops = 0;

private:
    cholmod_common common;
    cholmod_sparse *A = nullptr;
};

/* Solves with a factor, which it only reads: one per thread. The arrays are kept from solve to solve. */
class Solver {
public:
    explicit Solver(const Factor &f) : F(f.F) {
        cholmod_start(&common);
        common.print = 0;
    }
    ~Solver() {
        cholmod_free_dense(&X, &common);
        cholmod_free_dense(&Y, &common);
        cholmod_free_dense(&E, &common);
        cholmod_finish(&common);
    }
    Solver(const Solver &) = delete;
    Solver &operator=(const Solver &) = delete;

    /* x = inv(B + g L) b for k right-hand sides; with renumbered = true, b and x are in the factor's order. */
    const double *solve(double *b, int k, bool renumbered) {
        cholmod_dense d;
        memset(&d, 0, sizeof d);
        d.nrow = d.d = F->n;
        d.ncol = (size_t)k;
        d.nzmax = d.nrow * d.ncol;
        d.x = b;
        d.xtype = CHOLMOD_REAL;
        d.dtype = CHOLMOD_DOUBLE;
        if (!cholmod_solve2(renumbered ? CHOLMOD_LDLt : CHOLMOD_A, F, &d, nullptr, &X, nullptr, &Y, &E, &common)) throw std::bad_alloc();
        return (const double *)X->x;
    }
    double bytes() const { return (double)common.memory_usage; }

private:
    cholmod_factor *F;
    cholmod_common common;
    cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;
};

/* ==== vectors ==== */

double dot(const double *x, const double *y, size_t n) {
    double s = 0;
#pragma omp simd reduction(+ : s)
    for (size_t i = 0; i < n; i++) s += x[i] * y[i];
    return s;
}

/* B by rows, as given or renumbered. */
struct Mass {
    const int64_t *ptr;
    const int32_t *col;
    const double *val;
    size_t n;
    std::vector<int64_t> own_ptr;
    std::vector<int32_t> own_col;
    Array own_val;

    explicit Mass(const rival_pair &p) : ptr(p.ptr), col(p.col), val(p.B), n((size_t)p.n) {}

    /* Row k is row perm[k] of B, columns likewise. */
    Mass(const rival_pair &p, const int *perm) : n((size_t)p.n), own_ptr(n + 1), own_col((size_t)p.ptr[p.n]), own_val((size_t)p.ptr[p.n]) {
        std::vector<int32_t> place(n);
        size_t k = 0;
        for (size_t i = 0; i < n; i++) place[(size_t)perm[i]] = (int32_t)i;
        for (size_t i = 0; i < n; i++) {
            own_ptr[i] = (int64_t)k;
            for (int64_t q = p.ptr[perm[i]]; q < p.ptr[perm[i] + 1]; q++, k++) {
                own_col[k] = place[(size_t)p.col[q]];
                own_val[k] = p.B[q];
            }
        }
        own_ptr[n] = (int64_t)k;
        ptr = own_ptr.data();
        col = own_col.data();
        val = own_val;
    }

    /* Y = B X for K columns, square[c] = x_c' B x_c. */
    template <int K> void apply(const double *X, double *Y, double *square) const {
        double total[K] = {0};
        for (size_t i = 0; i < n; i++) {
            double s[K] = {0};
            for (int64_t q = ptr[i]; q < ptr[i + 1]; q++) {
                const double b = val[q];
                const double *x = X + col[q];
                for (int c = 0; c < K; c++) s[c] += b * x[(size_t)c * n];
            }
            for (int c = 0; c < K; c++) {
                Y[i + (size_t)c * n] = s[c];
                total[c] += s[c] * X[i + (size_t)c * n];
            }
        }
        for (int c = 0; c < K; c++) square[c] = total[c];
    }
    void apply(int k, const double *X, double *Y, double *square) const {
        int c = 0;
        for (; c + 4 <= k; c += 4) apply<4>(X + (size_t)c * n, Y + (size_t)c * n, square + c);
        for (; c < k; c++) apply<1>(X + (size_t)c * n, Y + (size_t)c * n, square + c);
    }
};

/* ==== shift-invert Lanczos ====
 * S = inv(B + g L) B is self-adjoint in the inner product of B, with eigenvalues 1/(1 + g lambda): its Lanczos basis holds what matters of
 * exp(-t inv(B) L), a function of S too (van den Eshof, Hochbruck 2006; Moret, Novati 2004). */

/* The eigenvalues and vectors of T = tridiag(beta, alpha, beta), m x m; stride: from step to step in alpha and beta. */
class Tridiagonal {
public:
    Tridiagonal(const double *alpha, const double *beta, int stride, int m_) : m(m_), scale(m_) {
        Eigen::VectorXd diagonal(m), off(std::max(m - 1, 0));
        for (int j = 0; j < m; j++) diagonal[j] = alpha[j * stride];
        for (int j = 1; j < m; j++) off[j - 1] = beta[j * stride];
        for (int j = 0; j < m; j++) scale[j] = beta[0] / beta[j * stride];
        eigen.computeFromTridiagonal(diagonal, off, Eigen::ComputeEigenvectors);
    }
    /* y with exp(-t inv(B) L) w_0 = sum y_j w_j for w_j = beta_j v_j; ratio = t / g. */
    Eigen::VectorXd exponential(double ratio) const {
        Eigen::VectorXd f(m);
        for (int j = 0; j < m; j++) {
            const double d = eigen.eigenvalues()[j];
            f[j] = d > 1e-14 ? std::exp(-ratio * (1 / d - 1)) * eigen.eigenvectors()(0, j) : 0.0;
        }
        return (eigen.eigenvectors() * f).cwiseProduct(scale);
    }

private:
    int m;
    Eigen::VectorXd scale;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
};

/* k bases in lock-step. Vectors stay unscaled, w_j = beta_j v_j, which saves a pass a step. */
class Lanczos {
public:
    std::vector<double> alpha, beta;  /* [capacity x k], step by step */
    Array W;                          /* [capacity] blocks of n x k */
    int m = 0;                        /* steps done */

    Lanczos(const Mass &mass, Solver &s, int columns, int capacity, bool renumbered_)
        : alpha((size_t)(capacity * columns)), beta((size_t)((capacity + 1) * columns)), W(mass.n * (size_t)columns * (size_t)capacity), B(mass),
          solver(s), n(mass.n), k(columns), renumbered(renumbered_), BW(mass.n * (size_t)columns) {}

    /* w_0 = e_source for `columns` sources, as many as reserved or fewer; sources in B's numbering. */
    void start(const int32_t *sources, int columns) {
        m = 0;
        k = columns;
        std::fill(W.p.get(), W.p.get() + n * (size_t)k, 0.0);
        std::fill(BW.p.get(), BW.p.get() + n * (size_t)k, 0.0);
        for (int c = 0; c < k; c++) {
            const int32_t s = sources[c];
            W[(size_t)c * n + (size_t)s] = 1;
            for (int64_t q = B.ptr[s]; q < B.ptr[s + 1]; q++) {
                BW[(size_t)c * n + (size_t)B.col[q]] = B.val[q];
                if (B.col[q] == s) beta[(size_t)c] = std::sqrt(B.val[q]);
            }
        }
    }

    /* w_0 = x with B x = b, for one column. */
    void start(const double *x, const double *b) {
        m = 0;
        k = 1;
        std::copy(x, x + n, W.p.get());
        std::copy(b, b + n, BW.p.get());
        beta[0] = std::sqrt(dot(x, b, n));
    }

    /* One step. The last needs no next vector. */
    void step(bool last) {
        const double *X = solver.solve(BW, k, renumbered);
        double *a = &alpha[(size_t)(m * k)], *b = &beta[(size_t)(m * k)];
        for (int c = 0; c < k; c++) a[c] = dot(X + (size_t)c * n, BW + (size_t)c * n, n) / (b[c] * b[c]);
        m++;
        if (last) return;
        for (int c = 0; c < k; c++) next_vector(c, X + (size_t)c * n, a[c], b[c], m > 1 ? b[c - k] : 1);
        B.apply(k, vector(m), BW, b + k);
        for (int c = 0; c < k; c++) b[k + c] = std::sqrt(b[k + c]);
    }

    /* The same with the new vector made orthogonal to all before it. One column only. */
    void step_reorthogonalised() {
        step(false);
        ConstMatrix V(vector(0), (Eigen::Index)n, m);
        Eigen::Map<Eigen::VectorXd> w(vector(m), (Eigen::Index)n);
        for (int pass = 0; pass < 2; pass++) {
            Eigen::VectorXd c = V.transpose() * ConstVector(BW, (Eigen::Index)n);
            for (int j = 0; j < m; j++) c[j] /= beta[(size_t)j] * beta[(size_t)j];
            w.noalias() -= V * c;
            B.apply(1, vector(m), BW, &beta[(size_t)m]);
        }
        beta[(size_t)m] = std::sqrt(beta[(size_t)m]);
    }

    /* u = column c of exp(-ratio g inv(B) L), place[i]: row of B's numbering -> row of u, NULL when they are the same. */
    void column(int c, double ratio, const int *place, double *u) const {
        enum { CHUNK = 1024 };  /* rows at a time: the sum stays in the first cache */
        const Eigen::VectorXd y = Tridiagonal(&alpha[(size_t)c], &beta[(size_t)c], k, m).exponential(ratio);
        for (size_t begin = 0; begin < n; begin += CHUNK) {
            const size_t rows = std::min((size_t)CHUNK, n - begin);
            double sum[CHUNK] = {0};
            for (int j = 0; j < m; j++) {
                const double *w = vector(j) + (size_t)c * n + begin, f = y[j];
                for (size_t i = 0; i < rows; i++) sum[i] += f * w[i];
            }
            if (place) {
                for (size_t i = 0; i < rows; i++) u[place[begin + i]] = sum[i];
            } else {
                std::copy(sum, sum + rows, u + begin);
            }
        }
    }

    double *vector(int j) const { return W + (size_t)j * n * (size_t)k; }
    double bytes() const { return 8.0 * (double)n * k * (m + 1); }

private:
    /* w = x / beta_j - alpha_j v_j - beta_j v_{j-1}, x = S w_j */
    void next_vector(int c, const double *x, double a, double b, double b_old) {
        double *w = vector(m) + (size_t)c * n;
        const double *w1 = vector(m - 1) + (size_t)c * n, *w0 = m > 1 ? vector(m - 2) + (size_t)c * n : nullptr;
        const double fx = 1 / b, f1 = a / b, f0 = b / b_old;
        if (w0) {
#pragma omp simd
            for (size_t i = 0; i < n; i++) w[i] = fx * x[i] - f1 * w1[i] - f0 * w0[i];
        } else {
#pragma omp simd
            for (size_t i = 0; i < n; i++) w[i] = fx * x[i] - f1 * w1[i];
        }
    }

    const Mass &B;
    Solver &solver;
    size_t n;
    int k;
    bool renumbered;
    Array BW;                         /* B W of the newest block */
};

enum { MAX_STEPS = 150 };

/* The fewest steps after which the column is within target of its reference. The error can rise again later: the first time counts. */
int fewest_steps(const Job &job, const Factor &f, int column) {
    const Mass B(*job.pair);
    Solver solver(f);
    Lanczos basis(B, solver, 1, MAX_STEPS + 1, false);
    Array u(job.rows());
    basis.start(job.sources + column, 1);
    while (basis.m < MAX_STEPS) {
        basis.step(false);
        if (basis.m < 3) continue;
        basis.column(0, 1 / job.gamma, nullptr, u);
        if (relative_error(u, job.reference + job.rows() * (size_t)column, job.rows()) <= job.target) return basis.m;
    }
    throw std::runtime_error("Lanczos did not reach the target error");
}

/* The shortest of up to three runs of work(), of fewer when one takes long. */
template <class Work> double shortest(Work work) {
    double best = 1e30, spent = 0;
    for (int k = 0; k < 3 && spent < 1; k++) {
        const double t0 = now();
        work();
        best = std::min(best, now() - t0);
        spent += now() - t0;
    }
    return best;
}

/* The ordering with the smaller total in a trial: analysis, n_factors factorisations, n_solves solves of `width` columns. */
rival_ordering best_ordering(const Job &job, int n_factors, int n_solves, int width) {
    if (job.ordering != RIVAL_ORDERING_BEST) return job.ordering;
    double total[2] = {0, 0};
    Array b(job.rows() * (size_t)width);
    std::fill(b.p.get(), b.p.get() + job.rows() * (size_t)width, 1.0);
    for (int k = 0; k < 2; k++) {
        Factor f;
        f.assemble(*job.pair, job.gamma * job.time());
        total[k] += shortest([&] { f.analyse(k ? RIVAL_METIS : RIVAL_AMD); });
        total[k] += n_factors * shortest([&] { f.factorise(); });
        Solver solver(f);
        total[k] += n_solves * shortest([&] { solver.solve(b, width, false); });
    }
    return total[1] < total[0] ? RIVAL_METIS : RIVAL_AMD;
}

int steps_for(const Job &job, rival_ordering ordering, int n_columns) {
    if (job.steps > 0) return job.steps;
    if (!job.reference) throw std::runtime_error("neither steps nor a reference given");
    Factor f;
    int steps = 0;
    f.assemble(*job.pair, job.gamma * job.time());
    f.analyse(ordering);
    f.factorise();
    for (int c = 0; c < std::min(n_columns, job.n_reference); c++) steps = std::max(steps, fewest_steps(job, f, c));
    return steps;
}

void silan(const Job &job, double *U, rival_result *out) {
    const Threads scope(1, job.threads);
    Answers answers(job, U, 1);
    Array scratch(job.rows());
    out->ordering = best_ordering(job, 1, 22, 1);
    out->steps = steps_for(job, out->ordering, 1);
    out->width = 1;
    best_run(job, out, [&](rival_result *r) {
        const double t0 = now();
        Factor f;
        f.assemble(*job.pair, job.gamma * job.time());
        f.analyse(r->ordering);
        const double t1 = now();
        f.factorise();
        const double t2 = now();
        const Mass B(*job.pair);
        Solver solver(f);
        Lanczos basis(B, solver, 1, r->steps + 1, false);
        basis.start(job.sources, 1);
        for (int j = 0; j < r->steps; j++) basis.step(j + 1 == r->steps);
        basis.column(0, 1 / job.gamma, nullptr, answers.column(0, scratch));
        const double t3 = now();
        r->analyse = t1 - t0;
        r->factor = t2 - t1;
        r->first = r->columns = t3 - t2;
        r->columns_run = 1;
        r->nnz = f.nnz;
        r->flops = f.flops;
        r->bytes = f.bytes() + solver.bytes() + basis.bytes();
    });
    out->error = answers.error(1);
}

/* Blocks of columns: as few as the width allows, then up to a multiple of the threads so that all have the same to do. */
int count_blocks(const Job &job) {
    int blocks = (job.n_sources + job.width - 1) / job.width;
    blocks = (blocks + job.threads - 1) / job.threads * job.threads;
    return std::min(blocks, job.n_sources);
}

void silan_block(const Job &job, double *U, rival_result *out) {
    const int blocks = count_blocks(job), width = (job.n_sources + blocks - 1) / blocks;
    const auto begin = [&](int b) { return (int)((int64_t)job.n_sources * b / blocks); };
    Answers answers(job, U, job.n_sources);
    {
        const Threads scope(1, job.threads);
        out->ordering = best_ordering(job, 1, 22 * ((blocks + job.threads - 1) / job.threads), width);
        out->steps = steps_for(job, out->ordering, job.n_sources);
    }
    out->width = width;
    best_run(job, out, [&](rival_result *r) {
        const double t0 = now();
        Factor f;
        double t1, t2;
        {
            const Threads scope(1, job.threads);
            f.assemble(*job.pair, job.gamma * job.time());
            f.analyse(r->ordering);
            t1 = now();
            f.factorise();
            t2 = now();
        }
        const Threads scope(job.threads, 1);
        const Mass B(*job.pair, f.perm());
        std::vector<int32_t> place(job.rows());
        for (size_t i = 0; i < job.rows(); i++) place[(size_t)f.perm()[i]] = (int32_t)i;
        struct Desk { std::unique_ptr<Solver> solver; std::unique_ptr<Lanczos> basis; Array scratch; };
        std::vector<Desk> desks((size_t)job.threads);
        const int done = share(blocks, job.threads, job.seconds, [&](int b) {
            Desk &d = desks[(size_t)thread_id()];
            const int c0 = begin(b), k = begin(b + 1) - c0;
            std::vector<int32_t> sources;
            for (int c = 0; c < k; c++) sources.push_back(place[(size_t)job.sources[c0 + c]]);
            if (!d.solver) {
                d.solver.reset(new Solver(f));
                d.basis.reset(new Lanczos(B, *d.solver, width, r->steps, true));
                d.scratch = Array(job.rows());
            }
            d.basis->start(sources.data(), k);
            for (int j = 0; j < r->steps; j++) d.basis->step(j + 1 == r->steps);
            for (int c = 0; c < k; c++) d.basis->column(c, 1 / job.gamma, f.perm(), answers.column(c0 + c, d.scratch));
        });
        const double t3 = now();
        r->columns_run = begin(done);
        r->analyse = t1 - t0;
        r->factor = t2 - t1;
        r->columns = (t3 - t2) * job.n_sources / r->columns_run;
        r->nnz = f.nnz;
        r->flops = f.flops;
        r->bytes = f.bytes() + 20.0 * (double)job.pair->ptr[job.pair->n];
        for (const Desk &d : desks) {
            if (d.basis) r->bytes += d.basis->bytes() + d.solver->bytes();
        }
    });
    out->total = out->total_columns;
    out->error = answers.error(out->columns_run);
}

/* ==== many times ==== */

/* Times [first, last) from one basis. */
struct Window {
    int first, last;
    double g;
    int steps;
    double cost;
};

/* need[c][k]: steps until time k is within the target with shift g[c], INT_MAX when it is not within MAX_STEPS. */
struct StepTable {
    std::vector<double> g;
    std::vector<std::vector<int>> need;
    double factor = 1e30, step = 1e30;  /* seconds */
};

/* A tenth of the rows and those around the source stand for all: the table is for choosing, what is chosen is checked on all rows. */
std::vector<size_t> sample_rows(const Job &job) {
    const rival_pair &p = *job.pair;
    const size_t stride = std::max<size_t>(1, std::min<size_t>(job.rows() / 5000, 10));
    std::vector<size_t> rows;
    for (size_t i = 0; i < job.rows(); i += stride) rows.push_back(i);
    for (int64_t q = p.ptr[job.sources[0]]; q < p.ptr[job.sources[0] + 1]; q++) rows.push_back((size_t)p.col[q]);
    return rows;
}

std::vector<int> steps_per_time(const Job &job, const Factor &f, double g, const std::vector<size_t> &rows, StepTable *table) {
    const Mass B(*job.pair);
    Solver solver(f);
    Lanczos basis(B, solver, 1, MAX_STEPS + 1, false);
    const size_t n = job.rows(), n_rows = rows.size(), n_times = (size_t)job.n_times;
    Eigen::MatrixXd V((Eigen::Index)n_rows, MAX_STEPS), R((Eigen::Index)n_rows, job.n_times);
    std::vector<int> need(n_times, INT_MAX);
    std::vector<double> largest(n_times);
    for (size_t k = 0; k < n_times; k++) {
        for (size_t i = 0; i < n; i++) largest[k] = std::max(largest[k], std::fabs(job.reference[k * n + i]));
        for (size_t i = 0; i < n_rows; i++) R((Eigen::Index)i, (Eigen::Index)k) = job.reference[k * n + rows[i]];
    }
    basis.start(job.sources, 1);
    for (size_t open = n_times; open > 0 && basis.m < MAX_STEPS;) {
        const double t0 = now();
        basis.step(false);
        table->step = std::min(table->step, now() - t0);
        for (size_t i = 0; i < n_rows; i++) V((Eigen::Index)i, basis.m - 1) = basis.vector(basis.m - 1)[rows[i]];
        if (basis.m < 3) continue;
        const Tridiagonal T(basis.alpha.data(), basis.beta.data(), 1, basis.m);
        for (size_t k = 0; k < n_times; k++) {
            if (need[k] < INT_MAX) continue;
            const Eigen::VectorXd u = V.leftCols(basis.m) * T.exponential(job.times[k] / g);
            if ((u - R.col((Eigen::Index)k)).cwiseAbs().maxCoeff() > job.target * largest[k]) continue;
            need[k] = basis.m;
            open--;
        }
    }
    return need;
}

StepTable tabulate_steps(const Job &job, rival_ordering ordering) {
    const Threads scope(1, job.threads);
    const std::vector<size_t> rows = sample_rows(job);
    const double t0 = job.times[0], t1 = job.times[job.n_times - 1];
    const int n_shifts = 1 + (int)std::ceil(4 * std::log10(20 * t1 / t0));
    StepTable table;
    Factor f;
    f.assemble(*job.pair, t0);
    f.analyse(ordering);
    for (int c = 0; c < n_shifts; c++) {
        const double g = 0.03 * t0 * std::pow(10, 0.25 * c);  /* from 0.03 of the smallest time to 0.6 of the largest */
        f.assemble(*job.pair, g);
        const double start = now();
        f.factorise();
        table.factor = std::min(table.factor, now() - start);
        table.g.push_back(g);
        table.need.push_back(steps_per_time(job, f, g, rows, &table));
    }
    return table;
}

/* The cheapest shift for times [first, last); cost 1e30 when none does. */
Window cheapest_window(const StepTable &table, int first, int last) {
    Window best = {first, last, 0, 0, 1e30};
    for (size_t c = 0; c < table.g.size(); c++) {
        const int steps = *std::max_element(table.need[c].begin() + first, table.need[c].begin() + last);
        const double cost = table.factor + steps * table.step;
        if (steps == INT_MAX || cost >= best.cost) continue;
        best.g = table.g[c];
        best.steps = steps;
        best.cost = cost;
    }
    return best;
}

/* The cheapest split of times [first, n) into n_windows. Side by side on the threads the dearest window counts, else their sum. */
std::vector<Window> cheapest_split(const StepTable &table, int first, int n, int n_windows, bool parallel, double *cost) {
    std::vector<Window> best;
    *cost = 1e30;
    if (n_windows == 1) {
        best.push_back(cheapest_window(table, first, n));
        *cost = best[0].cost;
        return best;
    }
    for (int middle = first + 1; middle + n_windows - 1 <= n; middle++) {
        double rest_cost;
        const Window w = cheapest_window(table, first, middle);
        std::vector<Window> rest = cheapest_split(table, middle, n, n_windows - 1, parallel, &rest_cost);
        const double c = parallel ? std::max(w.cost, rest_cost) : w.cost + rest_cost;
        if (c >= *cost) continue;
        *cost = c;
        best.assign(1, w);
        best.insert(best.end(), rest.begin(), rest.end());
    }
    return best;
}

/* U(:, times of the window) = W Y, in chunks of rows shared among the threads. */
void window_columns(const Job &job, const Lanczos &basis, const Window &w, double *U) {
    const Eigen::Index n = job.pair->n, chunk = 4096, n_chunks = (n + chunk - 1) / chunk;
    const Tridiagonal T(basis.alpha.data(), basis.beta.data(), 1, basis.m);
    Eigen::MatrixXd Y(basis.m, w.last - w.first);
    for (int k = w.first; k < w.last; k++) Y.col(k - w.first) = T.exponential(job.times[k] / w.g);
    const ConstMatrix V(basis.vector(0), n, basis.m);
    Matrix target(U + (size_t)n * (size_t)w.first, n, w.last - w.first);
    share((int)n_chunks, job.threads, 0, [&](int c) {
        const Eigen::Index begin = c * chunk, rows = std::min(chunk, n - begin);
        target.middleRows(begin, rows).noalias() = V.middleRows(begin, rows) * Y;
    });
}

/* Everything for all times, once. */
void run_windows(const Job &job, const std::vector<Window> &windows, double *U, rival_result *r) {
    const int n_windows = (int)windows.size();
    const bool parallel = n_windows > 1 && job.threads > 1;
    std::vector<std::unique_ptr<Factor>> f;
    std::vector<double> factor_seconds((size_t)n_windows);
    std::vector<double> bytes((size_t)n_windows);
    const double t0 = now();
    double t1;
    {
        const Threads scope(1, job.threads);
        for (int w = 0; w < n_windows; w++) {
            f.emplace_back(new Factor);
            f[(size_t)w]->assemble(*job.pair, windows[(size_t)w].g);
            if (w == 0) {
                f[0]->analyse(r->ordering);
            } else {
                f[(size_t)w]->analysed_as(*f[0]);
            }
        }
        t1 = now();
    }
    const double nnz = f[0]->nnz, flops = f[0]->flops;
    const Mass B(*job.pair);
    const Threads scope(parallel ? job.threads : 1, parallel ? 1 : job.threads);
    share(n_windows, parallel ? job.threads : 1, 0, [&](int k) {
        const Window &w = windows[(size_t)k];
        const double start = now();
        f[(size_t)k]->factorise();
        factor_seconds[(size_t)k] = now() - start;
        Solver solver(*f[(size_t)k]);
        Lanczos basis(B, solver, 1, w.steps, false);
        basis.start(job.sources, 1);
        for (int j = 0; j < w.steps; j++) basis.step(j + 1 == w.steps);
        const Threads combine(job.threads, 1);
        window_columns(job, basis, w, U);
        bytes[(size_t)k] = f[(size_t)k]->bytes() + solver.bytes() + basis.bytes();
        if (!parallel) f[(size_t)k].reset();
    });
    const double t2 = now();
    r->analyse = t1 - t0;
    r->factor = r->bytes = 0;
    for (int k = 0; k < n_windows; k++) {
        r->factor = parallel ? std::max(r->factor, factor_seconds[(size_t)k]) : r->factor + factor_seconds[(size_t)k];
        r->bytes = parallel ? r->bytes + bytes[(size_t)k] : std::max(r->bytes, bytes[(size_t)k]);
    }
    r->first = r->columns = t2 - t1 - r->factor;
    r->total = r->total_columns = t2 - t0;
    r->nnz = nnz;
    r->flops = flops;
}

/* Adds steps to the windows until every time is within the target on all rows. Returns 0 when they cannot. */
bool check_windows(const Job &job, std::vector<Window> &windows, double *U, rival_result *r) {
    for (int round = 0; round < 10; round++) {
        bool fine = true;
        run_windows(job, windows, U, r);
        for (Window &w : windows) {
            double e = 0;
            for (int k = w.first; k < w.last; k++) {
                e = std::max(e, relative_error(U + (size_t)k * job.rows(), job.reference + (size_t)k * job.rows(), job.rows()));
            }
            if (e <= job.target) continue;
            w.steps++;
            fine = false;
        }
        if (fine) return true;
    }
    return false;
}

/* The quickest of the splits into one, two and three windows. */
std::vector<Window> best_windows(const Job &job, double *U, const rival_result &blank) {
    const StepTable table = tabulate_steps(job, blank.ordering);
    std::vector<Window> best;
    double best_total = 1e30;
    for (int n_windows = 1; n_windows <= std::min((int)RIVAL_MAX_WINDOWS, job.n_times); n_windows++) {
        double cost;
        rival_result r = blank;
        std::vector<Window> windows = cheapest_split(table, 0, job.n_times, n_windows, job.threads >= n_windows, &cost);
        if (cost >= 1e30 || !check_windows(job, windows, U, &r)) continue;
        double total = r.total;
        for (int k = 0; k < 2; k++) {
            run_windows(job, windows, U, &r);
            total = std::min(total, r.total);
        }
        if (total >= best_total) continue;
        best_total = total;
        best = windows;
    }
    if (best.empty()) throw std::runtime_error("Lanczos did not reach the target error");
    return best;
}

void silan_times(const Job &job, double *U, rival_result *out) {
    if (!job.reference || job.n_reference < job.n_times) throw std::runtime_error("a reference for every time is needed");
    Answers answers(job, U, job.n_times);
    double *u = answers.column(0, nullptr);
    std::vector<Window> windows;
    {
        const Threads scope(1, job.threads);
        out->ordering = best_ordering(job, 2, 60, 1);
    }
    for (int k = 0; k < job.n_windows; k++) windows.push_back({job.window[k].first, job.window[k].last, job.window[k].g, job.window[k].steps, 0});
    if (windows.empty()) windows = best_windows(job, u, *out);
    best_run(job, out, [&](rival_result *r) { run_windows(job, windows, u, r); });
    out->windows = (int32_t)windows.size();
    out->width = 1;
    out->columns_run = job.n_times;
    out->steps = 0;
    size_t used = 0;
    for (size_t k = 0; k < windows.size(); k++) {
        const Window &w = windows[k];
        if (k < RIVAL_MAX_WINDOWS) out->window[k] = {w.first, w.last, w.steps, w.g};
        out->steps += w.steps;
        used += (size_t)snprintf(out->note + used, sizeof out->note - used, "%s%d times %.3g..%.3g: g = %.3g, %d steps", used ? "; " : "",
                                 w.last - w.first, job.times[w.first], job.times[w.last - 1], w.g, w.steps);
        used = std::min(used, sizeof out->note - 1);
    }
    out->error = answers.error(job.n_times);
}

/* ==== reference ==== */

/* The basis begins with inv(B) e_source. */
void start_symmetric(const Job &job, int32_t source, Lanczos *basis) {
    Factor mass;
    mass.assemble(*job.pair, 0);
    mass.analyse(RIVAL_METIS);
    mass.factorise();
    Solver solver(mass);
    Array e(job.rows());
    std::fill(e.p.get(), e.p.get() + job.rows(), 0.0);
    e[(size_t)source] = 1;
    basis->start(solver.solve(e, 1, false), e);
}

/* Columns of source for times [first, last) from a basis grown until they stand still. Returns the last change. */
double settled_columns(const Job &job, const Factor &f, int32_t source, int first, int last, double g, double *U) {
    const Mass B(*job.pair);
    Solver solver(f);
    Lanczos basis(B, solver, 1, MAX_STEPS + 1, false);
    const size_t n = job.rows();
    Array u(n);
    double change = 1e30, before;
    int calm = 0;
    std::fill(U, U + n * (size_t)(last - first), 0.0);
    if (job.symmetric) start_symmetric(job, source, &basis);
    else basis.start(&source, 1);
    while (basis.m < MAX_STEPS && calm < 2) {
        basis.step_reorthogonalised();
        if (basis.m < 16 || basis.m % 4) continue;
        before = change;
        change = 0;
        for (int k = first; k < last; k++) {
            double *old = U + n * (size_t)(k - first);
            basis.column(0, job.times[k] / g, nullptr, u);
            change = std::max(change, relative_error(old, u, n));
            std::copy(u.p.get(), u.p.get() + n, old);
        }
        if (change < 1e-13 || (change < 1e-10 && change > 0.5 * before)) calm++;
    }
    return change;
}

void reference(const Job &job, double *U, rival_result *out) {
    const Threads scope(1, job.threads);
    const double start = now();
    out->ordering = job.ordering == RIVAL_ORDERING_BEST ? RIVAL_METIS : job.ordering;
    out->error = 0;
    for (int first = 0, last; first < job.n_times; first = last) {
        Factor f;
        for (last = first + 1; last < job.n_times && job.times[last] <= 8 * job.times[first]; last++) {}
        const double g = 0.1 * std::sqrt(job.times[first] * job.times[last - 1]);
        f.assemble(*job.pair, g);
        f.analyse(out->ordering);
        f.factorise();
        for (int s = 0; s < job.n_sources; s++) {
            double *u = U + job.rows() * (size_t)(first + s);
            out->error = std::max(out->error, settled_columns(job, f, job.sources[s], first, last, g, u));
        }
    }
    out->first = out->columns = out->total = out->total_columns = now() - start;
    out->columns_run = std::max(job.n_sources, job.n_times);
}

/* ==== eigenpairs ==== */

#if defined(HEATDIFF_BENCH_ARPACK)
/* The k smallest eigenvalues of L x = lambda B x and vectors with x' B x = 1, as those of the largest magnitude of inv(L - sigma B) B. Rows in the factor's order
 * throughout. */
class Eigenpairs {
public:
    Array value, X;                   /* [k], [n x k] */
    int k, solves = 0;
    double bytes = 0;

    Eigenpairs(const Job &job, const Factor &f, double g, int k_)
        : value((size_t)k_), k(k_), B(*job.pair, f.perm()), solver(f), n((int)job.rows()), m(k_ + k_ / 2), sigma(-1 / g) {
        const int room = m * (m + 8), want_vectors = 1;
        const double tol = 1e-10;
        int ido = 0, info = 0, iparam[11] = {1, 0, 300, 1, 0, 0, 3}, ipntr[11] = {0};
        Array residual((size_t)n), work(3 * (size_t)n), work2((size_t)room), V((size_t)n * (size_t)m);
        std::vector<int> select((size_t)m);
        for (;;) {
            dsaupd_(&ido, "G", &n, "LM", &k, &tol, residual, &m, V, &n, iparam, ipntr, work, work2, &room, &info, 1, 2);
            if (ido != -1 && ido != 1 && ido != 2) break;
            step(ido, work + (ipntr[0] - 1), work + (ipntr[1] - 1), work + (ipntr[2] - 1));
        }
        if (info != 0) throw std::runtime_error("ARPACK: dsaupd says " + std::to_string(info));
        bytes = 8.0 * ((double)n * (m + 4) + room) + f.bytes() + solver.bytes();
        dseupd_(&want_vectors, "A", select.data(), value, V, &n, &sigma, "G", &n, "LM", &k, &tol, residual, &m, V, &n, iparam, ipntr, work, work2, &room, &info, 1,
                1, 2);
        if (info != 0) throw std::runtime_error("ARPACK: dseupd says " + std::to_string(info));
        X.p.swap(V.p);                /* vectors take the place of the basis */
    }

    /* place[i]: row of D for row i. Blocks of rows, so that the sum stays in the first cache. */
    void diagonal(double t, int threads, const int *place, double *D) const {
        enum { CHUNK = 1024 };
        share((n + CHUNK - 1) / CHUNK, threads, 0, [&](int block) {
            const size_t begin = (size_t)block * CHUNK, rows = std::min((size_t)CHUNK, (size_t)n - begin);
            double sum[CHUNK] = {0};
            for (int j = 0; j < k; j++) {
                const double *x = X + (size_t)j * (size_t)n + begin, w = std::exp(-t * value[j]);
                for (size_t i = 0; i < rows; i++) sum[i] += w * x[i] * x[i];
            }
            for (size_t i = 0; i < rows; i++) D[place[begin + i]] = sum[i];
        });
    }

private:
    /* y = B x for ido 2, else y = inv(L - sigma B) B x; for ido 1, B x is there already. */
    void step(int ido, const double *x, double *y, double *Bx) {
        double square;
        if (ido == 2) {
            B.apply(1, x, y, &square);
            return;
        }
        if (ido == -1) B.apply(1, x, Bx = y, &square);
        const double *u = solver.solve(Bx, 1, true);
        for (int i = 0; i < n; i++) y[i] = -u[i] / sigma;    /* L - sigma B = (B + g L) / g */
        solves++;
    }

    Mass B;
    Solver solver;
    const int n, m;
    const double sigma;
};

void eigenpairs(const Job &job, double *U, rival_result *out) {
    const int k = job.n_eigen > 0 ? job.n_eigen : 300;
    const rival_pair &p = *job.pair;
    const Threads scope(1, job.threads);
    Array scratch(job.rows());
    double area = 0;
    if (p.n < 3 * k) throw std::runtime_error("too few rows");
    for (int64_t q = 0; q < p.ptr[p.n]; q++) area += p.B[q];
    const double g = area / (4 * 3.14159265358979323846);    /* sigma: what lies between two eigenvalues (Weyl), below zero */
    out->ordering = best_ordering(job, 1, 5 * k / 2, 1);
    out->width = k;
    best_run(job, out, [&](rival_result *r) {
        const double t0 = now();
        Factor f;
        f.assemble(p, g);
        f.analyse(r->ordering);
        const double t1 = now();
        f.factorise();
        const double t2 = now();
        const Eigenpairs pairs(job, f, g, k);
        const Threads loops(job.threads, 1);
        const double t3 = now();
        r->further = 1e30;
        for (int c = 0; c < job.n_times; c++) {
            const double start = now();
            pairs.diagonal(job.times[c], job.threads, f.perm(), U ? U + job.rows() * (size_t)c : scratch.p.get());
            r->further = std::min(r->further, now() - start);
        }
        if (job.n_times == 0) r->further = 0;
        for (size_t j = 0; U && job.n_times == 0 && j < (size_t)k; j++)
            for (size_t i = 0; i < job.rows(); i++) U[job.rows() * j + (size_t)f.perm()[i]] = pairs.X[job.rows() * j + i];
        r->analyse = t1 - t0;
        r->factor = t2 - t1;
        r->first = t3 - t2 + r->further;
        r->columns = t3 - t2 + job.n_times * r->further;
        r->columns_run = job.n_times;
        r->steps = pairs.solves;
        r->nnz = f.nnz;
        r->flops = f.flops;
        r->bytes = pairs.bytes;
    });
    out->error = -1;
}
#else
void eigenpairs(const Job &, double *, rival_result *) { throw std::runtime_error("not built in"); }
#endif

/* ==== UMFPACK ==== */

/* The complex functions for int and for 64-bit indices: int is a little quicker, and full at some hundred thousand vertices. */
#define RIVAL_UMFPACK(Name, Int, prefix)                                                                                                  \
    struct Name {                                                                                                                         \
        typedef Int Index;                                                                                                                \
        static void defaults(double *control) { prefix##_defaults(control); }                                                             \
        static int symbolic(Index n, const Index *p, const Index *i, const double *x, void **s, double *control, double *info) {          \
            return (int)prefix##_symbolic(n, n, p, i, x, nullptr, s, control, info);                                                      \
        }                                                                                                                                 \
        static int numeric(const Index *p, const Index *i, const double *x, void *s, void **f, double *control, double *info) {           \
            return (int)prefix##_numeric(p, i, x, nullptr, s, f, control, info);                                                          \
        }                                                                                                                                 \
        static int solve(const Index *p, const Index *i, const double *a, double *x, const double *b, void *f, double *control,           \
                         double *info, Index *Wi, double *W) {                                                                            \
            return (int)prefix##_wsolve(UMFPACK_A, p, i, a, nullptr, x, nullptr, b, nullptr, f, control, info, Wi, W);                    \
        }                                                                                                                                 \
        static void free_symbolic(void **s) { prefix##_free_symbolic(s); }                                                                \
        static void free_numeric(void **f) { prefix##_free_numeric(f); }                                                                  \
    };
RIVAL_UMFPACK(UmfpackInt, int, umfpack_zi)
RIVAL_UMFPACK(UmfpackLong, SuiteSparse_long, umfpack_zl)
#undef RIVAL_UMFPACK

struct OutOfRoom : std::runtime_error { OutOfRoom() : std::runtime_error("UMFPACK: out of memory") {} };

void umfpack_check(int status, const char *what) {
    if (status == UMFPACK_ERROR_out_of_memory) throw OutOfRoom();
    if (status < 0) throw std::runtime_error(std::string("UMFPACK: ") + what + " failed, status " + std::to_string(status));
    if (status > 0) throw std::runtime_error(std::string("UMFPACK: ") + what + ": matrix singular");
}

/* The matrices t L + theta B of all poles and their LU. The pattern's rows serve as columns, as it is symmetric. */
template <class K> class PoleFamily {
public:
    typedef typename K::Index Index;
    double nnz = 0, flops = 0, bytes = 0;

    /* Scratch of one thread. */
    struct Desk {
        std::vector<double> b, x, W;
        std::vector<Index> Wi;
        explicit Desk(size_t n) : b(2 * n), x(2 * n), W(4 * n), Wi(n) {}
    };

    PoleFamily(const Job &j, const rival_poles &set, int n_poles_) : job(j), poles(set), n_poles(n_poles_), numeric((size_t)n_poles_, nullptr) {
        K::defaults(control);
        control[UMFPACK_IRSTEP] = 0;
    }
    ~PoleFamily() {
        if (symbolic) K::free_symbolic(&symbolic);
        for (void *&f : numeric) {
            if (f) K::free_numeric(&f);
        }
    }
    PoleFamily(const PoleFamily &) = delete;
    PoleFamily &operator=(const PoleFamily &) = delete;

    void analyse(rival_ordering ordering) {
        const rival_pair &A = *job.pair;
        double info[UMFPACK_INFO];
        control[UMFPACK_ORDERING] = ordering == RIVAL_METIS ? UMFPACK_ORDERING_METIS : UMFPACK_ORDERING_AMD;
        p.assign(A.ptr, A.ptr + A.n + 1);
        i.assign(A.col, A.col + A.ptr[A.n]);
        for (int k = 0; k < n_poles; k++) x.emplace_back(values(k));
        umfpack_check(K::symbolic((Index)A.n, p.data(), i.data(), x[0], &symbolic, control, info), "analysis");
    }
    void factorise() {
        std::vector<double> held((size_t)n_poles), peak((size_t)n_poles);
        share(n_poles, std::min(job.threads, n_poles), 0, [&](int k) {
            double info[UMFPACK_INFO], own_control[UMFPACK_CONTROL];
            std::copy(control, control + UMFPACK_CONTROL, own_control);
            umfpack_check(K::numeric(p.data(), i.data(), x[(size_t)k], symbolic, &numeric[(size_t)k], own_control, info), "factorisation");
            held[(size_t)k] = info[UMFPACK_NUMERIC_SIZE] * info[UMFPACK_SIZE_OF_UNIT];
            peak[(size_t)k] = info[UMFPACK_PEAK_MEMORY] * info[UMFPACK_SIZE_OF_UNIT];
            if (k == 0) {
                nnz = info[UMFPACK_LNZ] + info[UMFPACK_UNZ];
                flops = info[UMFPACK_FLOPS];
            }
        });
        bytes = (16.0 * n_poles + sizeof(Index)) * (double)i.size() + peak[0] - held[0];
        for (double h : held) bytes += h;
    }
    /* sum += Re of pole k's part of c(-t B^-1 L) e_source */
    void add_pole(int k, int32_t source, Desk &d, double *sum) {
        const rival_pair &A = *job.pair;
        double info[UMFPACK_INFO];
        std::fill(d.b.begin(), d.b.end(), 0.0);
        for (int64_t q = A.ptr[source]; q < A.ptr[source + 1]; q++) d.b[2 * (size_t)A.col[q]] = A.B[q];
        umfpack_check(K::solve(p.data(), i.data(), x[(size_t)k], d.x.data(), d.b.data(), numeric[(size_t)k], control, info, d.Wi.data(), d.W.data()),
                      "solve");
        const double w = poles.theta[2 * k + 1] != 0 ? -2 : -1, re = w * poles.a[2 * k], im = w * poles.a[2 * k + 1];
        for (size_t v = 0; v < job.rows(); v++) sum[v] += re * d.x[2 * v] - im * d.x[2 * v + 1];
    }
    /* One column, its poles shared among the threads. */
    void first_column(int32_t source, std::vector<std::unique_ptr<Desk>> &desks, double *u) {
        std::vector<Array> part;
        for (size_t k = 1; k < desks.size(); k++) part.emplace_back(job.rows());
        begin_column(source, u);
        for (Array &a : part) std::fill(a.p.get(), a.p.get() + job.rows(), 0.0);
        share(n_poles, (int)desks.size(), 0, [&](int k) {
            const size_t id = (size_t)thread_id();
            add_pole(k, source, *desks[id], id ? (double *)part[id - 1] : u);
        });
        for (Array &a : part) {
            for (size_t v = 0; v < job.rows(); v++) u[v] += a[v];
        }
    }
    void whole_column(int32_t source, Desk &d, double *u) {
        begin_column(source, u);
        for (int k = 0; k < n_poles; k++) add_pole(k, source, d, u);
    }

private:
    /* u = a0 e_source */
    void begin_column(int32_t source, double *u) const {
        std::fill(u, u + job.rows(), 0.0);
        u[source] = poles.a0;
    }
    Array values(int k) const {
        const rival_pair &A = *job.pair;
        const size_t nnz_A = (size_t)A.ptr[A.n];
        const double t = job.time(), re = poles.theta[2 * k], im = poles.theta[2 * k + 1];
        Array v(2 * nnz_A);
        for (size_t q = 0; q < nnz_A; q++) {
            v[2 * q] = t * A.L[q] + re * A.B[q];
            v[2 * q + 1] = im * A.B[q];
        }
        return v;
    }

    const Job &job;
    const rival_poles &poles;
    int n_poles;
    double control[UMFPACK_CONTROL];
    std::vector<Index> p, i;
    std::vector<Array> x;
    void *symbolic = nullptr;
    std::vector<void *> numeric;
};

/* The ordering with the smaller total in a trial with one pole. */
template <class K> rival_ordering umfpack_ordering(const Job &job, const rival_poles &poles) {
    const double solve_share = 0.06;  /* a solve beside a factorisation, as measured at 50000 rows; less above */
    double total[2];
    if (job.ordering != RIVAL_ORDERING_BEST) return job.ordering;
    for (int k = 0; k < 2; k++) {
        double analyse = 1e30, factor = 1e30, spent = 0;
        for (int run = 0; run < 3 && spent < 1; run++) {
            PoleFamily<K> one(job, poles, 1);
            const double t0 = now();
            one.analyse(k ? RIVAL_METIS : RIVAL_AMD);
            const double t1 = now();
            one.factorise();
            const double t2 = now();
            analyse = std::min(analyse, t1 - t0);
            factor = std::min(factor, t2 - t1);
            spent += t2 - t0;
        }
        total[k] = analyse + std::ceil((double)poles.n / job.threads) * factor * (1 + solve_share * job.n_sources);
    }
    return total[1] < total[0] ? RIVAL_METIS : RIVAL_AMD;
}

template <class K> void umfpack(const Job &job, const rival_poles &poles, double *U, rival_result *out) {
    typedef PoleFamily<K> Family;
    typedef typename Family::Desk Desk;
    const Threads scope(job.threads, 1);
    Answers answers(job, U, job.n_sources);
    out->ordering = umfpack_ordering<K>(job, poles);
    out->width = 1;
    best_run(job, out, [&](rival_result *r) {
        const double t0 = now();
        Family family(job, poles, poles.n);
        family.analyse(r->ordering);
        const double t1 = now();
        family.factorise();
        const double t2 = now();
        std::vector<std::unique_ptr<Desk>> desks;
        std::vector<Array> scratch;
        for (int k = 0; k < job.threads; k++) {
            desks.emplace_back(new Desk(job.rows()));
            scratch.emplace_back(job.rows());
        }
        family.first_column(job.sources[0], desks, answers.column(0, scratch[0]));
        const double t3 = now();
        int done = 0;
        r->further = job.one_by_one && job.n_sources > 1 ? 1e30 : 0;
        if (job.one_by_one) {
            for (; done < job.n_sources - 1 && (done == 0 || job.seconds <= 0 || now() - t3 <= job.seconds); done++) {
                const double start = now();
                family.first_column(job.sources[done + 1], desks, answers.column(done + 1, scratch[0]));
                r->further = std::min(r->further, now() - start);
            }
        } else {
            done = share(job.n_sources - 1, job.threads, job.seconds, [&](int c) {
                const size_t id = (size_t)thread_id();
                family.whole_column(job.sources[c + 1], *desks[id], answers.column(c + 1, scratch[id]));
            });
        }
        const double t4 = now();
        r->analyse = t1 - t0;
        r->factor = t2 - t1;
        r->first = t3 - t2;
        r->columns = r->first + (done > 0 ? (t4 - t3) * (job.n_sources - 1) / done : 0);
        r->columns_run = done + 1;
        r->nnz = family.nnz;
        r->flops = family.flops;
        r->bytes = family.bytes + job.threads * 76.0 * (double)job.rows();
    });
    out->error = answers.error(out->columns_run);
}

void umfpack_any(const Job &job, const rival_poles &poles, double *U, rival_result *out) {
    try {
        umfpack<UmfpackInt>(job, poles, U, out);
    } catch (const OutOfRoom &) {
        umfpack<UmfpackLong>(job, poles, U, out);
        snprintf(out->note, sizeof out->note, "64-bit indices, as int ran out of room");
    }
}

/* ==== Eigen ==== */

typedef Eigen::SparseMatrix<complex> ComplexSparse;

ComplexSparse pole_matrix(const Job &job, complex theta) {
    const rival_pair &p = *job.pair;
    const int64_t nnz = p.ptr[p.n];
    ComplexSparse A(p.n, p.n);
    A.resizeNonZeros((Eigen::Index)nnz);
    for (int32_t i = 0; i <= p.n; i++) A.outerIndexPtr()[i] = (int)p.ptr[i];
    for (int64_t q = 0; q < nnz; q++) {
        A.innerIndexPtr()[q] = p.col[q];
        A.valuePtr()[q] = job.time() * p.L[q] + theta * p.B[q];
    }
    return A;
}

/* Seconds of one thread. */
struct EigenDesk {
    Eigen::SparseLU<ComplexSparse, Eigen::COLAMDOrdering<int>> lu;
    bool analysed = false;
    double analyse = 0, factor = 0, first = 0, columns = 0;
};

/* Columns [begin, end): their part of pole k, added to sum [n x (end - begin)]. */
void eigen_solve(const Job &job, const EigenDesk &d, complex weight, int begin, int end, double *sum) {
    const rival_pair &p = *job.pair;
    Eigen::MatrixXcd b = Eigen::MatrixXcd::Zero(p.n, end - begin);
    for (int c = begin; c < end; c++) {
        const int32_t s = job.sources[c];
        for (int64_t q = p.ptr[s]; q < p.ptr[s + 1]; q++) b(p.col[q], c - begin) = p.B[q];
    }
    const Eigen::MatrixXcd x = d.lu.solve(b);
    Matrix target(sum, p.n, end - begin);
    const auto part = (weight * x).real();
#pragma omp critical(rival_eigen)
    target += part;
}

/* Pole by pole, each factor used for all columns and then dropped: one analysis a thread, and the memory of one factor a thread. */
void eigen_pole(const Job &job, const rival_poles &poles, int k, EigenDesk &d, double *sum, rival_result *r) {
    const complex theta(poles.theta[2 * k], poles.theta[2 * k + 1]), a(poles.a[2 * k], poles.a[2 * k + 1]);
    const complex weight = theta.imag() != 0 ? -2.0 * a : -a;
    const double t0 = now();
    const ComplexSparse A = pole_matrix(job, theta);
    if (!d.analysed) {
        d.lu.isSymmetric(true);
        d.lu.analyzePattern(A);
        d.analysed = true;
    }
    const double t1 = now();
    d.lu.factorize(A);
    if (d.lu.info() != Eigen::Success) throw std::runtime_error("SparseLU: " + d.lu.lastErrorMessage());
    const double t2 = now();
    eigen_solve(job, d, weight, 0, 1, sum);
    const double t3 = now();
    for (int c = 1; c < job.n_sources; c += job.width) {
        eigen_solve(job, d, weight, c, std::min(c + job.width, job.n_sources), sum + job.rows() * (size_t)c);
    }
    d.analyse += t1 - t0;
    d.factor += t2 - t1;
    d.first += t3 - t2;
    d.columns += now() - t2;
    if (k == 0) r->nnz = (double)(d.lu.nnzL() + d.lu.nnzU());
}

void eigen_lu(const Job &job, const rival_poles &poles, double *U, rival_result *out) {
    const Threads scope(job.threads, 1);
    const int threads = std::min(job.threads, poles.n);
    const size_t n = job.rows(), n_columns = (size_t)job.n_sources;
    Answers answers(job, U, job.n_sources);
    Array sum(n * n_columns);
    out->width = job.width;
    best_run(job, out, [&](rival_result *r) {
        std::vector<std::unique_ptr<EigenDesk>> desks;
        const EigenDesk *busiest;
        for (int k = 0; k < threads; k++) desks.emplace_back(new EigenDesk);
        std::fill(sum.p.get(), sum.p.get() + n * n_columns, 0.0);
        for (size_t c = 0; c < n_columns; c++) sum[c * n + (size_t)job.sources[c]] = poles.a0;
        share(poles.n, threads, 0, [&](int k) { eigen_pole(job, poles, k, *desks[(size_t)thread_id()], sum, r); });
        busiest = desks[0].get();
        for (const auto &d : desks) {
            if (d->analyse + d->factor + d->columns > busiest->analyse + busiest->factor + busiest->columns) busiest = d.get();
        }
        r->analyse = busiest->analyse;
        r->factor = busiest->factor;
        r->first = busiest->first;
        r->columns = busiest->columns;
        r->columns_run = job.n_sources;
        r->bytes = threads * (20.0 * r->nnz + 20.0 * (double)job.pair->ptr[job.pair->n] + 32.0 * (double)n * std::min(job.width, job.n_sources));
    });
    for (size_t c = 0; c < n_columns; c++) {
        double *u = answers.column((int)c, nullptr);
        if (u) std::copy(sum + c * n, sum + (c + 1) * n, u);
    }
    out->error = answers.error(job.n_sources);
}

void eigen_ldlt(const Job &job, double *U, rival_result *out) {
    typedef Eigen::SparseMatrix<double> RealSparse;
    const Threads scope(1, 1);
    const rival_pair &p = *job.pair;
    const double g = job.gamma * job.time();
    out->ordering = RIVAL_AMD;
    best_run(job, out, [&](rival_result *r) {
        const double t0 = now();
        RealSparse A(p.n, p.n);
        std::vector<double> x((size_t)p.ptr[p.n]);
        std::vector<int> ptr(p.ptr, p.ptr + p.n + 1);
        for (size_t q = 0; q < x.size(); q++) x[q] = p.B[q] + g * p.L[q];
        A = Eigen::Map<const RealSparse>(p.n, p.n, p.ptr[p.n], ptr.data(), p.col, x.data());
        Eigen::SimplicialLDLT<RealSparse, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt;
        ldlt.analyzePattern(A);
        const double t1 = now();
        ldlt.factorize(A);
        if (ldlt.info() != Eigen::Success) throw std::runtime_error("SimplicialLDLT failed");
        const double t2 = now();
        Eigen::VectorXd b = Eigen::VectorXd::Zero(p.n);
        for (int64_t q = p.ptr[job.sources[0]]; q < p.ptr[job.sources[0] + 1]; q++) b[p.col[q]] = p.B[q];
        const Eigen::VectorXd u = ldlt.solve(b);
        const double t3 = now();
        r->analyse = t1 - t0;
        r->factor = t2 - t1;
        r->first = r->columns = t3 - t2;
        r->columns_run = 1;
        r->nnz = (double)(ldlt.matrixL().nestedExpression().nonZeros() + p.n);
        r->bytes = 12 * r->nnz + 24.0 * (double)x.size();
        if (U) std::copy(u.data(), u.data() + p.n, U);
    });
    out->error = -1;
}

/* ==== the machine ==== */

#if defined(RIVAL_X86)
/* 16 and 12 independent sums: enough for the latency of the multiply-add, few enough for the registers. Returns flops. */
__attribute__((target("avx512f"), noinline)) double multiply_add_512(int64_t rounds, volatile double *sink) {
    __m512d s[16];
    const __m512d m = _mm512_set1_pd(0.999999999), a = _mm512_set1_pd(1e-9);
    for (int i = 0; i < 16; i++) s[i] = _mm512_set1_pd(1 + 1e-9 * i);
    for (int64_t k = 0; k < rounds; k++) {
#pragma GCC unroll 16
        for (int i = 0; i < 16; i++) s[i] = _mm512_fmadd_pd(s[i], m, a);
    }
    for (int i = 1; i < 16; i++) s[0] = _mm512_add_pd(s[0], s[i]);
    *sink = _mm512_cvtsd_f64(s[0]);
    return 256.0 * (double)rounds;
}

__attribute__((target("avx2,fma"), noinline)) double multiply_add_256(int64_t rounds, volatile double *sink) {
    __m256d s[12];
    const __m256d m = _mm256_set1_pd(0.999999999), a = _mm256_set1_pd(1e-9);
    for (int i = 0; i < 12; i++) s[i] = _mm256_set1_pd(1 + 1e-9 * i);
    for (int64_t k = 0; k < rounds; k++) {
#pragma GCC unroll 12
        for (int i = 0; i < 12; i++) s[i] = _mm256_fmadd_pd(s[i], m, a);
    }
    for (int i = 1; i < 12; i++) s[0] = _mm256_add_pd(s[0], s[i]);
    *sink = _mm256_cvtsd_f64(s[0]);
    return 96.0 * (double)rounds;
}

double peak(int threads, double (*kernel)(int64_t, volatile double *)) {
    double best = 0;
    (void)threads;
    for (int r = 0; r < 4; r++) {
        double flops = 0;
        const double t0 = now();
#pragma omp parallel num_threads(threads) reduction(+ : flops)
        {
            volatile double sink;
            flops += kernel(10000000, &sink);
        }
        best = std::max(best, flops / (now() - t0));
    }
    return 1e-9 * best;
}
#endif

double read_speed(int threads, const double *x, size_t n) {
    double best = 0;
    volatile double sink = 0;
    (void)threads;
    for (int r = 0; r < 5; r++) {
        double s = 0;
        const double t0 = now();
#pragma omp parallel for simd schedule(static) num_threads(threads) reduction(+ : s)
        for (size_t i = 0; i < n; i++) s += x[i];
        best = std::max(best, 8.0 * (double)n / (now() - t0));
        sink = sink + s;
    }
    return 1e-9 * best;
}

/* ==== the C side ==== */

void check_job(const rival_job *job, bool one_source, bool one_time) {
    if (!job || !job->pair || job->pair->n < 2 || job->n_sources < 1 || job->n_times < 1) throw std::runtime_error("the job is not complete");
    if (one_source && job->n_sources != 1) throw std::runtime_error("one source is wanted");
    if (one_time && job->n_times != 1) throw std::runtime_error("one time is wanted");
    for (int k = 0; k < job->n_times; k++) {
        if (!(job->times[k] > (k ? job->times[k - 1] : 0))) throw std::runtime_error("times are not positive and ascending");
    }
}

/* No exception leaves this file. */
/* ==== geodesic distance ==== */

#if defined(HEATDIFF_BENCH_CGAL)
typedef CGAL::Simple_cartesian<double> Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> SurfaceMesh;
typedef SurfaceMesh::Vertex_index VertexIndex;
typedef CGAL::Eigen_sparse_matrix<double> CgalMatrix;
typedef CGAL::Eigen_solver_traits<Eigen::SimplicialLDLT<CgalMatrix::EigenType>> CgalSolver;

/* CGAL makes L definite by adding 1e-8 to its diagonal for every corner of a face, which tilts the distances on large meshes. This matrix adds something else,
 * so that the methods can be compared without. */
double cgal_shift = 1e-8;
struct ShiftedMatrix : CgalMatrix {
    using CgalMatrix::CgalMatrix;
    ShiftedMatrix(const CgalMatrix &m) : CgalMatrix(m) {}
    void add_coef(std::size_t i, std::size_t j, double v) { CgalMatrix::add_coef(i, j, v == 1e-8 ? cgal_shift : v); }
};
struct ShiftedSolver : CgalSolver { typedef ShiftedMatrix Matrix; };

typedef CGAL::Heat_method_3::Surface_mesh_geodesic_distances_3<SurfaceMesh, CGAL::Heat_method_3::Direct> CgalHeat;
typedef CGAL::Heat_method_3::Surface_mesh_geodesic_distances_3<SurfaceMesh, CGAL::Heat_method_3::Direct, CGAL::Default, ShiftedSolver> CgalShifted;

template <class Heat> void geodesic(const SurfaceMesh &mesh, SurfaceMesh::Property_map<VertexIndex, double> d, int32_t k, const int32_t *sources, double *D, rival_result *r) {
    const double start = now();
    Heat heat(mesh);
    r->analyse = now() - start;
    for (int32_t q = 0; q < k; q++) {
        const double t0 = now();
        heat.clear_sources();
        heat.add_source(VertexIndex((std::uint32_t)sources[q]));
        heat.estimate_geodesic_distances(d);
        const double seconds = now() - t0;
        if (q == 0) r->first = seconds;
        else if (q == 1 || seconds < r->further) r->further = seconds;
        for (size_t i = 0; D && i < mesh.number_of_vertices(); i++) D[(size_t)q * mesh.number_of_vertices() + i] = d[VertexIndex((std::uint32_t)i)];
    }
    r->total = r->analyse + r->first;
}
#endif

template <class Work> int guarded(rival_result *result, Work work) {
    rival_result r;
    int fine = 0;
    memset(&r, 0, sizeof r);
    r.error = -1;
    try {
        work(&r);
        fine = 1;
    } catch (const std::bad_alloc &) {
        snprintf(r.note, sizeof r.note, "out of memory");
    } catch (const std::exception &e) {
        snprintf(r.note, sizeof r.note, "%s", e.what());
    }
    *result = r;
    return fine;
}

}  // namespace

extern "C" {

int rival_silan(const rival_job *job, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, true, true);
        silan(Job(*job), U, r);
    });
}

int rival_silan_block(const rival_job *job, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, false, true);
        silan_block(Job(*job), U, r);
    });
}

int rival_silan_times(const rival_job *job, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, true, false);
        silan_times(Job(*job), U, r);
    });
}

int rival_umfpack(const rival_job *job, const rival_poles *poles, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, false, true);
        umfpack_any(Job(*job), *poles, U, r);
    });
}

int rival_eigen_lu(const rival_job *job, const rival_poles *poles, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, false, true);
        eigen_lu(Job(*job), *poles, U, r);
    });
}

int rival_eigen_ldlt(const rival_job *job, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, false, true);
        eigen_ldlt(Job(*job), U, r);
    });
}

int rival_eigenpairs(const rival_job *job, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        rival_job whole = *job;
        whole.n_sources = 1;
        if (whole.n_times > 0) check_job(&whole, false, false);
        eigenpairs(Job(whole), U, r);
    });
}

int rival_reference(const rival_job *job, double *U, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        check_job(job, job->n_times > 1, false);
        reference(Job(*job), U, r);
    });
}

int rival_geodesic(const rival_mesh *mesh, double shift, int32_t n_sources, const int32_t *sources, double *D, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
#if defined(HEATDIFF_BENCH_CGAL)
        SurfaceMesh m;
        for (int32_t i = 0; i < mesh->n; i++) m.add_vertex(Kernel::Point_3(mesh->xyz[3 * (size_t)i], mesh->xyz[3 * (size_t)i + 1], mesh->xyz[3 * (size_t)i + 2]));
        for (size_t f = 0; f < (size_t)mesh->n_tri; f++) {
            const int32_t *v = mesh->tri + 3 * f;
            if (m.add_face(VertexIndex((std::uint32_t)v[0]), VertexIndex((std::uint32_t)v[1]), VertexIndex((std::uint32_t)v[2])) == SurfaceMesh::null_face())
                throw std::runtime_error("not manifold");
        }
        auto d = m.add_property_map<VertexIndex, double>("v:distance", 0).first;
        cgal_shift = shift;
        if (shift > 0) geodesic<CgalShifted>(m, d, n_sources, sources, D, r);
        else geodesic<CgalHeat>(m, d, n_sources, sources, D, r);
#else
        (void)mesh, (void)shift, (void)n_sources, (void)sources, (void)D, (void)r;
        throw std::runtime_error("built without it");
#endif
    });
}

int rival_assembly(const rival_mesh *mesh, int voronoi, const rival_pair *check, rival_result *result) {
    return guarded(result, [&](rival_result *r) {
        using Triplet = Eigen::Triplet<double, int>;
        const double start = now();
        std::vector<Triplet> l, b;
        l.reserve(9 * (size_t)mesh->n_tri);
        b.reserve((voronoi ? 3 : 9) * (size_t)mesh->n_tri);
        for (size_t f = 0; f < (size_t)mesh->n_tri; f++) {
            const int32_t *v = mesh->tri + 3 * f;
            Eigen::Vector3d x[3], e[3];
            double cot[3];
            for (int k = 0; k < 3; k++) x[k] = Eigen::Map<const Eigen::Vector3d>(mesh->xyz + 3 * (size_t)v[k]);
            for (int k = 0; k < 3; k++) e[k] = x[(k + 2) % 3] - x[(k + 1) % 3];     /* opposite to corner k */
            const double twice = e[0].cross(e[1]).norm(), area = twice / 2;
            for (int k = 0; k < 3; k++) cot[k] = -e[(k + 1) % 3].dot(e[(k + 2) % 3]) / twice;
            for (int k = 0; k < 3; k++) {
                const int32_t i = v[(k + 1) % 3], j = v[(k + 2) % 3];
                l.emplace_back(i, j, -cot[k] / 2);
                l.emplace_back(j, i, -cot[k] / 2);
                l.emplace_back(v[k], v[k], (cot[(k + 1) % 3] + cot[(k + 2) % 3]) / 2);
            }
            for (int k = 0; k < 3; k++) {
                if (!voronoi) {
                    for (int q = 0; q < 3; q++) b.emplace_back(v[k], v[q], k == q ? area / 6 : area / 12);
                } else if (cot[0] < 0 || cot[1] < 0 || cot[2] < 0) {
                    b.emplace_back(v[k], v[k], cot[k] < 0 ? area / 2 : area / 4);
                } else {
                    const int p = (k + 1) % 3, q = (k + 2) % 3;
                    b.emplace_back(v[k], v[k], (e[p].squaredNorm() * cot[p] + e[q].squaredNorm() * cot[q]) / 8);
                }
            }
        }
        const double listed = now();
        Eigen::SparseMatrix<double> L(mesh->n, mesh->n), B(mesh->n, mesh->n);
        L.setFromTriplets(l.begin(), l.end());
        B.setFromTriplets(b.begin(), b.end());
        r->total = now() - start;
        r->analyse = listed - start;
        r->nnz = (double)(L.nonZeros() + B.nonZeros());
        if (!check || check->n != mesh->n || check->ptr[check->n] != L.nonZeros()) return;
        double worst[2] = {0, 0}, most[2] = {0, 0};
        for (int32_t i = 0; i < check->n; i++) {
            for (int64_t p = check->ptr[i]; p < check->ptr[i + 1]; p++) {
                const double *mine[2] = {check->L, check->B}, theirs[2] = {L.coeff(check->col[p], i), B.coeff(check->col[p], i)};
                for (int k = 0; k < 2; k++) {
                    worst[k] = std::max(worst[k], std::fabs(mine[k][p] - theirs[k]));
                    most[k] = std::max(most[k], std::fabs(theirs[k]));
                }
            }
        }
        r->error = std::max(worst[0] / most[0], worst[1] / most[1]);
    });
}

void rival_machine(int32_t threads, rival_machine_result *result) {
    const size_t n = (size_t)1 << 25;  /* 256 MB: more than the caches hold */
    rival_machine_result r = {0, 0, 0, 0, "", ""};
#if defined(RIVAL_X86)
    double (*kernel)(int64_t, volatile double *) = nullptr;
    if (__builtin_cpu_supports("avx512f")) {
        kernel = multiply_add_512;
        r.simd = "AVX-512";
    } else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        kernel = multiply_add_256;
        r.simd = "AVX2";
    }
    if (kernel) {
        r.peak_1 = peak(1, kernel);
        r.peak_n = peak(threads, kernel);
    }
#endif
    try {
        Array x(n);
        std::fill(x.p.get(), x.p.get() + n, 1.0);
        r.read_1 = read_speed(1, x, n);
        r.read_n = read_speed(threads, x, n);
    } catch (const std::bad_alloc &) {
    }
    if (openblas_get_corename) r.blas = openblas_get_corename();
    *result = r;
}

}  // extern "C"
