// eigen.cpp - heatdiff.hpp with matrices of Eigen: a mesh and its L and B, fields, your own matrices, what is refused
//
//     c++ -std=c++20 -O2 -I. -I/usr/include/eigen3 examples/cpp/eigen.cpp -o eigen && ./eigen
//
// Prints errors against Eigen's own eigenvectors. Returns 1 if one is larger than its bound.
#include <Eigen/Dense>
#include <Eigen/Sparse>
#define HEATDIFF_IMPLEMENTATION
#include "heatdiff.hpp"

#include <cstdio>

int main() try {
    // a wavy sheet
    const int m = 20, n = m * m;
    Eigen::MatrixXd V(n, 3);
    Eigen::MatrixXi F(2 * (m - 1) * (m - 1), 3);
    for (int v = 0, f = 0; v < n; v++) {
        const double x = v / m / double(m - 1), y = v % m / double(m - 1);
        V.row(v) << x, y, 0.1 * std::sin(9 * x) * std::cos(6 * y);
        if (v / m == m - 1 || v % m == m - 1) continue;
        F.row(f++) << v, v + m, v + m + 1;
        F.row(f++) << v, v + m + 1, v + 1;
    }
    const hd::laplacian lap(V, F);
    const double t = 10 * lap->h * lap->h;
    hd::heat heat(lap);

    // the shape itself, smoothed; and the truth, from all eigenvectors
    const Eigen::MatrixXd W = heat.apply(t, V);
    const hd::sparse L = hd::matrix(lap), B = hd::matrix(lap, true);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> all{ Eigen::MatrixXd(L), Eigen::MatrixXd(B) };
    const Eigen::MatrixXd X = all.eigenvectors();
    const Eigen::VectorXd fade = (-t * all.eigenvalues().array()).exp();
    const Eigen::MatrixXd K = X * fade.asDiagonal() * X.transpose();      // k_t
    const double error = (W - K * (B * V)).cwiseAbs().maxCoeff(), bound = heat.report().error_bound * W.cwiseAbs().maxCoeff();
    std::printf("%d vertices smoothed: error %.0e, at most %.0e\n", n, error, bound);

    // the same from matrices of one's own
    const hd::laplacian own = hd::from_matrices(L, B, lap->h);
    hd::heat plan(own);
    const std::vector<double> signature = plan.signature({ &t, 1 });
    const Eigen::Map<const Eigen::VectorXd> s(signature.data(), n);
    const double error2 = ((s - K.diagonal()).array() / s.array()).abs().maxCoeff(), bound2 = plan.report().error_relative;
    std::printf("signatures from L and B: relative error %.0e, at most %.0e\n", error2, bound2);

    // distance along the border of the same sheet, made flat
    Eigen::MatrixXd flat = V;
    flat.col(2).setZero();
    const std::vector<double> d = hd::geodesic(flat, F).distance({ std::vector<int32_t>{ 0, 1 } });
    const double off = std::abs(d[static_cast<size_t>(m) - 1] - (V.row(m - 1) - V.row(1)).head<2>().norm());
    std::printf("distance along the border: off by %.1f edges; the heat method's error is about one\n", off * (m - 1));

    // what is wrong is said
    int refused = 0;
    try { hd::laplacian(V, (F.array() + 1).matrix()); }
    catch (const hd::error &e) { std::printf("%s: %s\n", hd_status_name(e.where.status), e.what()); refused += e.where.face >= 0; }
    try { heat.apply(t, V.topRows(3)); }
    catch (const std::invalid_argument &e) { std::printf("%s\n", e.what()); refused++; }
    return error <= bound && error2 <= bound2 && off * (m - 1) < 1 && refused == 2 ? 0 : 1;
} catch (const std::exception &e) {
    std::printf("%s\n", e.what());
    return 1;
}
