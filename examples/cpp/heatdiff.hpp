// heatdiff.hpp - heatdiff.h for C++20: objects that free themselves, spans whose sizes are checked, exceptions. Where Eigen is
// included before, matrices of Eigen too. It defines nothing of the library: one C or C++ file has HEATDIFF_IMPLEMENTATION.
//
//     hd::laplacian lap(xyz, tri);                              // spans of 3 n doubles and 3 m ids, or Eigen's n x 3 and m x 3
//     hd::heat heat(lap);
//     std::vector<double> u = heat.column(100 * lap->h * lap->h, 0);
//     double error = heat.report().error_bound;                 // of the last answer, relative to its largest value
//
// Whatever else the library does takes lap.get() and heat.get(). An object serves one thread at a time.
#ifndef HEATDIFF_HPP
#define HEATDIFF_HPP

#include "heatdiff.h"

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hd {

// What the library refused or could not do: where.status, .text, .face, .vertex, .row.
struct error : std::runtime_error {
    explicit error(const hd_error &e) : std::runtime_error(say(e)), where(e) {}
    hd_error where;

private:
    static std::string say(const hd_error &e) {
        std::string s = e.text;
        const std::pair<const char *, int64_t> places[] = {
            { "face", e.face }, { "vertex", e.vertex }, { "row", e.row }, { "column", e.column } };
        for (const auto &[name, at] : places)
            if (at >= 0) s += std::string(", ") + name + " " + std::to_string(at);
        return s;
    }
};

using doubles = std::span<const double>;
using ids = std::span<const int32_t>;

// Calls a function of the library, and hands it the error that it throws. Returns HD_OK or HD_WARN_ACCURACY.
template <class F> hd_status call(F function) {
    hd_error e{};
    const hd_status status = function(&e);
    if (status < 0) throw error(e);
    return status;
}

inline void require(bool good, const char *text) {
    if (!good) throw std::invalid_argument(text);
}

inline int32_t count(size_t n) {
    require(n <= INT32_MAX, "more than 2^31 - 1 of something");
    return static_cast<int32_t>(n);
}

template <auto free> struct freed {
    template <class T> void operator()(T *p) const noexcept { free(p); }
};

#ifdef EIGEN_CORE_H
// Triangles of Eigen, n x 3 and m x 3 in any order and type, as the library reads them.
struct by_rows {
    template <class V, class F> by_rows(const Eigen::MatrixBase<V> &xyz, const Eigen::MatrixBase<F> &tri) {
        require(xyz.cols() == 3 && tri.cols() == 3, "wanted are n x 3 coordinates and m x 3 ids");
        v = xyz.template cast<double>();
        f = tri.template cast<int32_t>();
    }

    hd_mesh mesh() const {
        return hd_triangles(v.data(), count(static_cast<size_t>(v.rows())), f.data(), count(static_cast<size_t>(f.rows())));
    }

    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> v;
    Eigen::Matrix<int32_t, Eigen::Dynamic, 3, Eigen::RowMajor> f;
};
#endif

// The pair (L, B) of a surface. lap->h, lap->area and all the others are fields of hd_laplacian.
class laplacian {
public:
    // xyz: x, y and z of each vertex. tri: three ids of each triangle
    laplacian(doubles xyz, ids tri, const hd_laplacian_opts &opts = {}) {
        require(xyz.size() % 3 == 0 && tri.size() % 3 == 0, "three coordinates for each vertex, three ids for each triangle");
        make(hd_triangles(xyz.data(), count(xyz.size() / 3), tri.data(), count(tri.size() / 3)), opts);
    }

    // Polygons, points, lengths: see hd_mesh
    explicit laplacian(const hd_mesh &mesh, const hd_laplacian_opts &opts = {}) { make(mesh, opts); }

    // Your own matrices
    laplacian(const hd_csr &L, const hd_csr &B, double h = 0, const hd_laplacian_opts &opts = {}) {
        hd_laplacian *p = nullptr;
        call([&](hd_error *e) { return hd_laplacian_matrices(&p, &L, &B, h, &opts, e); });
        made.reset(p);
    }

    const hd_laplacian *operator->() const { return made.get(); }
    hd_laplacian *get() const { return made.get(); }
    size_t size() const { return static_cast<size_t>(made->n); }

#ifdef EIGEN_CORE_H
    template <class V, class F>
    laplacian(const Eigen::MatrixBase<V> &xyz, const Eigen::MatrixBase<F> &tri, const hd_laplacian_opts &opts = {}) {
        make(by_rows(xyz, tri).mesh(), opts);
    }

    // b = B 1 of the rows, in the Laplacian's own memory
    Eigen::Map<const Eigen::VectorXd> mass() const { return { made->mass, made->n_active }; }
#endif

private:
    void make(const hd_mesh &mesh, const hd_laplacian_opts &opts) {
        hd_laplacian *p = nullptr;
        call([&](hd_error *e) { return hd_laplacian_create(&p, &mesh, &opts, e); });
        made.reset(p);
    }

    std::unique_ptr<hd_laplacian, freed<hd_laplacian_free>> made;
};

#ifdef EIGEN_SPARSECORE_MODULE_H
using sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// L and B of Eigen as a Laplacian: their row pointers, 32 bits wide, are copied to the library's 64.
inline laplacian from_matrices(const sparse &L, const sparse &B, double h = 0, const hd_laplacian_opts &opts = {}) {
    const sparse packed[2] = { L, B };
    std::vector<int64_t> rows[2];
    hd_csr csr[2];
    for (int q = 0; q < 2; q++) {
        require(packed[q].isCompressed(), "makeCompressed() first");
        rows[q].assign(packed[q].outerIndexPtr(), packed[q].outerIndexPtr() + packed[q].outerSize() + 1);
        csr[q] = { static_cast<int32_t>(packed[q].rows()), static_cast<int32_t>(packed[q].cols()), packed[q].nonZeros(), rows[q].data(),
            const_cast<int32_t *>(packed[q].innerIndexPtr()), const_cast<double *>(packed[q].valuePtr()) };   // both are only read
    }
    return laplacian(csr[0], csr[1], h, opts);
}

// The rows of L, or of B if it is not diagonal, as a matrix of Eigen that owns its numbers.
inline sparse matrix(const laplacian &lap, bool mass = false) {
    const int32_t n = lap->n_active;
    const double *val = mass ? lap->B : lap->L.val;
    if (mass && !val) return sparse(lap.mass().asDiagonal());
    const std::vector<int32_t> rows(lap->L.row_ptr, lap->L.row_ptr + n + 1);
    return Eigen::Map<const sparse>(n, n, lap->L.nnz, rows.data(), lap->L.col, val);
}
#endif

// A plan for heat. The Laplacian must outlive it.
class heat {
public:
    explicit heat(const laplacian &lap, const hd_heat_opts &opts = {}) : n(lap.size()) {
        hd_heat *p = nullptr;
        call([&](hd_error *e) { return hd_heat_create(&p, lap.get(), &opts, e); });
        made.reset(p);
    }

    hd_heat *get() const { return made.get(); }
    const hd_report &report() const { return last; }           // of the last answer

    // U = K_t F at each time: F has n x k values by columns, U n x (k times.size())
    hd_status apply(doubles times, doubles F, std::span<double> U) {
        require(n > 0 && F.size() % n == 0, "a column has a value for each vertex");
        require(U.size() == F.size() * times.size(), "the answer has a column for each field and time");
        return call([&](hd_error *e) {
            return hd_heat_apply(get(), count(times.size()), times.data(), count(F.size() / n), F.data(), 0, U.data(), 0, &last, e);
        });
    }

    // Columns of K_t, or of k_t with HD_KERNEL_SYMMETRIC: column q times.size() + m for source q and time m
    std::vector<double> columns(doubles times, ids sources, hd_kernel kernel = HD_KERNEL_OPERATOR) {
        const hd_sources s = hd_vertices(count(sources.size()), sources.data());
        return made_of(times.size() * sources.size(), [&](double *u, hd_error *e) {
            return hd_heat_columns(get(), kernel, count(times.size()), times.data(), &s, u, 0, &last, e);
        });
    }

    std::vector<double> column(double t, int32_t source, hd_kernel kernel = HD_KERNEL_OPERATOR) {
        return columns({ &t, 1 }, { &source, 1 }, kernel);
    }

    // The heat kernel signature k_t(x,x): a column for each time
    std::vector<double> signature(doubles times) {
        return made_of(times.size(), [&](double *u, hd_error *e) {
            return hd_heat_diagonal(get(), HD_KERNEL_SYMMETRIC, count(times.size()), times.data(), u, 0, nullptr, nullptr, &last, e);
        });
    }

    // Diffusion distances from each source: columns as above. times may be empty for commute and biharmonic distances
    std::vector<double> distance(doubles times, ids sources, hd_distance_kind kind = HD_DISTANCE_CLASSICAL) {
        const hd_sources s = hd_vertices(count(sources.size()), sources.data());
        const size_t most = times.empty() ? 1 : times.size();
        return made_of(most * sources.size(), [&](double *u, hd_error *e) {
            return hd_heat_distance(get(), kind, count(times.size()), times.data(), &s, u, 0, &last, e);
        });
    }

#ifdef EIGEN_CORE_H
    // K_t F of Eigen's matrix, a column for each field
    Eigen::MatrixXd apply(double t, const Eigen::MatrixXd &F) {
        Eigen::MatrixXd U(F.rows(), F.cols());
        require(static_cast<size_t>(F.rows()) == n, "the field has another number of rows than there are vertices");
        apply({ &t, 1 }, { F.data(), static_cast<size_t>(F.size()) }, { U.data(), static_cast<size_t>(U.size()) });
        return U;
    }
#endif

private:
    template <class F> std::vector<double> made_of(size_t columns, F function) {
        std::vector<double> u(n * columns);
        call([&](hd_error *e) { return function(u.data(), e); });
        return u;
    }

    size_t n;
    hd_report last{};
    std::unique_ptr<hd_heat, freed<hd_heat_free>> made;
};

// Distances along a surface.
class geodesic {
public:
    geodesic(doubles xyz, ids tri, const hd_geodesic_opts &opts = {}) {
        require(xyz.size() % 3 == 0 && tri.size() % 3 == 0, "three coordinates for each vertex, three ids for each triangle");
        make(hd_triangles(xyz.data(), count(xyz.size() / 3), tri.data(), count(tri.size() / 3)), opts);
    }

    // Polygons, points, lengths: see hd_mesh
    explicit geodesic(const hd_mesh &mesh, const hd_geodesic_opts &opts = {}) { make(mesh, opts); }

#ifdef EIGEN_CORE_H
    template <class V, class F>
    geodesic(const Eigen::MatrixBase<V> &xyz, const Eigen::MatrixBase<F> &tri, const hd_geodesic_opts &opts = {}) {
        make(by_rows(xyz, tri).mesh(), opts);
    }
#endif

    hd_geodesic *get() const { return made.get(); }

    // To the nearest of the sources
    std::vector<double> distance(ids sources) {
        require(!sources.empty(), "a distance needs a source");
        const int64_t first[2] = { 0, static_cast<int64_t>(sources.size()) };
        hd_sources s = hd_vertices(1, sources.data());
        s.first = first;
        std::vector<double> d(n);
        call([&](hd_error *e) { return hd_geodesic_distance(get(), &s, d.data(), 0, nullptr, e); });
        return d;
    }

private:
    void make(const hd_mesh &mesh, const hd_geodesic_opts &opts) {
        hd_geodesic *p = nullptr;
        call([&](hd_error *e) { return hd_geodesic_create(&p, &mesh, &opts, e); });
        made.reset(p);
        n = static_cast<size_t>(mesh.n);
    }

    size_t n = 0;
    std::unique_ptr<hd_geodesic, freed<hd_geodesic_free>> made;
};

}  // namespace hd

#endif
