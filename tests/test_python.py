"""examples/python against dense matrices of SciPy: with the library's own L and B, and with L and B assembled here.
Builds the shared library itself. Without NumPy, SciPy or a compiler it says so and exits 77, which ctest shows as skipped,
or 1 with HEATDIFF_NO_SKIP in the environment. Usage: test_python.py [unittest arguments]"""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

try:
    import numpy as np
    import scipy.linalg
    import scipy.sparse
    import scipy.spatial
except ImportError:
    np = None

CC = shutil.which("cc") or shutil.which("gcc")
hd = folder = None


def setUpModule():
    global hd, folder
    folder = tempfile.TemporaryDirectory()
    library = os.path.join(folder.name, "libheatdiff.so")
    subprocess.run([CC, "-O1", "-shared", "-fPIC", "-fvisibility=hidden", os.path.join(TOP, "tools", "heatdiff_shared.c"),
                    "-o", library, "-lm"], check=True)
    os.environ["HEATDIFF_LIBRARY"] = library
    sys.path.insert(0, os.path.join(TOP, "examples", "python"))
    import heatdiff
    hd = heatdiff


def tearDownModule():
    if folder:
        folder.cleanup()


def bumpy(n=14):
    """A sheet of n x n vertices, and its faces as triangles and as squares."""
    x, y = np.meshgrid(np.arange(n) / n, np.arange(n) / n, indexing="ij")
    xyz = np.stack([x, y, 0.2 * np.sin(7 * x) * np.cos(5 * y)], axis=-1).reshape(-1, 3)
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
    a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
    return xyz, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]), np.stack([a, b, c, d], 1)


def kernel(lap, t):
    """k_t by vertices from all eigenpairs of (L, B)."""
    values, vectors = scipy.linalg.eigh(lap.L.toarray(), lap.B.toarray())
    return vectors * np.exp(-t * np.maximum(values, 0)) @ vectors.T


# A second opinion of L and B, that shares no line with the library: from gradients of hat functions, in loops.

def cotangents(xyz, tri):
    """L and the finite-element masses of a mesh, dense: L_ij is the integral of grad i . grad j, B_ij that of i j."""
    L, B = np.zeros((2, len(xyz), len(xyz)))
    for face in tri:
        p = xyz[face]
        edges = np.stack([p[2] - p[1], p[0] - p[2], p[1] - p[0]])       # edge i is opposite to corner i
        area = np.linalg.norm(np.cross(edges[0], edges[1])) / 2
        L[np.ix_(face, face)] += edges @ edges.T / (4 * area)           # gradients are edges turned, over 2 area
        B[np.ix_(face, face)] += area / 12 * (1 + np.eye(3))
    return L, B


def voronoi(xyz, tri):
    """Mixed Voronoi areas (Meyer et al. 2003): of circumcentres, but half and quarters of obtuse triangles."""
    mass = np.zeros(len(xyz))
    for face in tri:
        p = xyz[face]
        for i in range(3):
            a, b, c = p[i], p[(i + 1) % 3], p[(i + 2) % 3]
            angles = [np.arccos(np.dot(y - x, z - x) / np.linalg.norm(y - x) / np.linalg.norm(z - x))
                      for x, y, z in ((a, b, c), (b, c, a), (c, a, b))]
            area = np.linalg.norm(np.cross(b - a, c - a)) / 2
            if max(angles) > np.pi / 2:
                mass[face[i]] += area / (2 if angles[0] > np.pi / 2 else 4)
            else:
                mass[face[i]] += (np.dot(c - a, c - a) / np.tan(angles[1]) + np.dot(b - a, b - a) / np.tan(angles[2])) / 8
    return np.diag(mass)


def gaussian(xyz, s):
    """L of points with weights exp(-d^2/4s) of near pairs, sparse, and masses 1/(weights of the row)."""
    near = scipy.spatial.cKDTree(xyz).sparse_distance_matrix(scipy.spatial.cKDTree(xyz), 6 * s ** 0.5, output_type="coo_matrix")
    off = near.row != near.col
    W = scipy.sparse.coo_matrix((np.exp(-near.data[off] ** 2 / (4 * s)), (near.row[off], near.col[off])), near.shape).tocsr()
    degree = np.asarray(W.sum(axis=1)).ravel()
    return scipy.sparse.diags(degree) - W, scipy.sparse.diags(1 / (1 + degree)).tocsr()


class Dense(unittest.TestCase):
    """Columns, signatures and distances at several times against SciPy's expm of -t B^-1 L."""

    def check(self, lap, L, B, times):
        heat, sources = hd.Heat(lap), [3, len(L) // 2]
        self.assertLess(abs(lap.L - L).max(), 1e-12 * abs(L).max())
        self.assertLess(abs(lap.B - B).max(), 1e-13 * abs(B).max())
        i, j = np.array([0, 5, 9, 9]), np.array([1, len(L) - 1, 9, 2])
        for t in times:
            K = scipy.linalg.expm(-t * np.linalg.solve(B, L))
            k = np.linalg.solve(B, K.T)                                 # K B^-1, as B is symmetric
            columns, symmetric = heat.columns(t, sources), heat.columns(t, sources, symmetric=True)
            for q, s in enumerate(sources):
                self.assertLess(abs(columns[:, q] - K[:, s]).max(), 1e-7 * abs(K[:, s]).max())
                self.assertLess(abs(symmetric[:, q] - k[:, s]).max(), 1e-7 * abs(k[:, s]).max())
            self.assertLess(abs(heat.diagonal(t)[:, 0] / np.diag(k) - 1).max(), 1e-6)
            f = np.sin(np.arange(len(L)))
            self.assertLess(abs(heat.apply(t, f)[:, 0] - K @ f).max(), 1e-7)
            self.assertLess(abs(heat.entries(t, i, j)[:, 0] - K[i, j]).max(), 1e-7 * abs(K[i, j]).max())
            self.check_distance(heat, t, "CLASSICAL", K @ k, (i, j))
            self.check_distance(heat, t, "WEIGHTED", B @ K @ K, (i, j))
        self.check_without_time(heat, L, B)

    def check_distance(self, heat, t, kind, G, pairs):
        """From a dense Gram matrix. Where that says that all vertices are alike to three digits, it has lost too many
        to compare, and the library has eigenpairs instead."""
        kind = "HD_DISTANCE_" + kind
        want = np.sqrt(np.maximum(np.diag(G)[:, None] - 2 * G + np.diag(G), 0))
        d = heat.distance(t, [3, 17], kind=kind)
        if want.max() < 1e-3 * G.max() ** 0.5:
            self.assertLess(heat.report["error_bound"], 1e-5)
            return
        self.assertLess(abs(d - want[:, [3, 17]]).max(), 1e-5 * want.max(), (t, kind))
        self.assertLess(abs(heat.pairs(t, *pairs, kind=kind)[:, 0] - want[pairs]).max(), 1e-6 * want.max(), (t, kind))

    def check_without_time(self, heat, L, B):
        """Commute and biharmonic distances from the pseudo-inverse of B^-1/2 L B^-1/2."""
        root = scipy.linalg.inv(scipy.linalg.sqrtm(B).real)
        G = scipy.linalg.pinvh(root @ L @ root)
        for kind, power in (("COMMUTE", G), ("BIHARMONIC", G @ G)):
            g = root @ power @ root
            want = np.sqrt(np.maximum(g[3, 3] - 2 * g[3] + np.diag(g), 0))
            d = heat.distance(None, 3, kind="HD_DISTANCE_" + kind)[:, 0]
            self.assertLess(abs(d - want).max(), 1e-6 * want.max(), kind)

    def test_derivatives_and_adjoints(self):
        """By dense matrices, and the gradients of a loss by differences."""
        xyz, tri, _ = bumpy(9)
        L, B = cotangents(xyz, tri)
        rng = np.random.default_rng(3)
        for kind, mass in (("FEM", B), ("VORONOI_COT", voronoi(xyz, tri))):
            lap = hd.triangles(xyz, tri, kind="HD_LAPLACIAN_" + kind)
            A, t, f = np.linalg.solve(mass, L), np.array([2, 20]) * lap.h ** 2, rng.standard_normal((81, 3))
            want = [scipy.linalg.expm(-s * A) for s in t]
            for method in ("DIRECT", "KRYLOV", "ITERATIVE"):
                heat = hd.Heat(lap, method="HD_METHOD_" + method)
                rate, dual = heat.derivative(t, f), heat.adjoint(t, f)
                for m, K in enumerate(want):
                    self.assertLess(abs(rate[:, m::2] + A @ K @ f).max(), 1e-7 * abs(A @ K @ f).max())
                    self.assertLess(abs(dual[:, m::2] - K.T @ f).max(), 1e-7 * abs(K.T @ f).max())
            heat = hd.Heat(lap, method="HD_METHOD_DIRECT", poles="HD_POLES_KERNEL", degree=14)
            g, d = rng.standard_normal((81, 6)), rng.standard_normal((81, 3))
            by_t, by_f = heat.vjp(t, f, g)
            loss = lambda t, f: np.sum(g * heat.apply(t, f))
            for m in range(2):
                step = 1e-4 * t[m] * np.eye(2)[m]
                self.assertAlmostEqual((loss(t + step, f) - loss(t - step, f)) / (2e-4 * t[m]) / by_t[m], 1, delta=1e-6)
            self.assertAlmostEqual(loss(t, d) / np.sum(by_f * d), 1, delta=1e-10)

    def test_traces_and_signatures(self):
        xyz, tri, _ = bumpy(9)
        L, B = cotangents(xyz, tri)
        lap = hd.triangles(xyz, tri)
        heat, values = hd.Heat(lap), np.maximum(scipy.linalg.eigh(L, B)[0], 0)
        t = lap.times(5)
        self.assertLess(abs(t / lap.area - np.geomspace(0.0024, 0.37, 5)).max(), 1e-12)
        self.assertLess(abs(lap.spectral_times([1, 0.3]) * values[1] - [1, 0.3]).max(), 1e-8)
        trace, bound = heat.trace(t)
        want = np.exp(-np.outer(t, values)).sum(axis=1)
        self.assertTrue((abs(trace - want) <= bound + 1e-12 * want).all() and (bound < 1e-6 * want).all())
        k = np.stack([np.diag(kernel(lap, s)) for s in t], axis=1)
        self.assertLess(abs(heat.normalised(t) * want / k - 1).max(), 4e-7)
        times = np.geomspace(1e-5, 1e3, 65)
        steps = np.diff(np.log(np.stack([np.diag(kernel(lap, s)) for s in times], axis=1)), axis=1)
        want = abs(np.fft.fft(steps, axis=1))[:, :5]
        self.assertLess(abs(heat.scale_invariant(1e-5, 1e3, 65, 5) - want).max(), 1e-5 * want.max())

    def test_learning_a_time(self):
        """The example finds the time that made its target, and says so."""
        out = subprocess.run([sys.executable, os.path.join(TOP, "examples", "python", "learn_time.py"), "--numpy"], check=True,
                             stdout=subprocess.PIPE, universal_newlines=True).stdout
        self.assertRegex(out, "found by NumPy")
        self.assertLess(float(out.split("off by ")[1].split()[0]), 1e-5)

    def test_meshes(self):
        xyz, tri, _ = bumpy(11)
        xyz = xyz + 0.02 * np.random.default_rng(1).standard_normal(xyz.shape)
        L, B = cotangents(xyz, tri)
        times = np.array([0.3, 3, 30, 1000]) * hd.triangles(xyz, tri).h ** 2
        self.check(hd.triangles(xyz, tri, kind="HD_LAPLACIAN_FEM"), L, B, times)
        self.check(hd.triangles(xyz, tri, kind="HD_LAPLACIAN_VORONOI_COT"), L, voronoi(xyz, tri), times)
        self.check(hd.triangles(xyz, tri, kind="HD_LAPLACIAN_COT"), L, np.eye(len(xyz)), [0.1, 10])

    def near(self, heat, got, want):
        """Within the bound that the plan reports, which is a small one."""
        self.assertLess(heat.report["error_bound"], 1e-4)
        self.assertLess(abs(got - want).max(), (heat.report["error_bound"] + 1e-12) * abs(want).max())

    def test_held(self):
        """The border and one more vertex held at zero: the exponential of what is left of L and B, zero elsewhere."""
        xyz, tri, _ = bumpy(11)
        xyz = xyz + 0.02 * np.random.default_rng(1).standard_normal(xyz.shape)
        L, B = cotangents(xyz, tri)
        free = np.array([v for v in range(121) if 0 < v % 11 < 10 and 0 < v // 11 < 10 and v != 60])
        part, sources = np.ix_(free, free), [17, 3]
        for kind, M in (("FEM", B), ("VORONOI_COT", voronoi(xyz, tri)), ("COT", np.eye(121))):
            lap = hd.triangles(xyz, tri, kind="HD_LAPLACIAN_" + kind, border="HD_BORDER_DIRICHLET", held=[60, 3])
            self.assertTrue(np.array_equal(lap.vertex, free) and lap.info.n_held == 41 and not lap.info.conserves)
            self.assertLess(abs(lap.L - L[part]).max(), 1e-12 * abs(L).max())
            self.assertLess(abs(lap.B - M[part]).max(), 1e-13 * abs(M).max())
            heat = hd.Heat(lap)
            for t in np.array([0.3, 3, 10]) * (1 if kind == "COT" else lap.h ** 2):
                K, k, W = np.zeros((3, 121, 121))
                K[part] = scipy.linalg.expm(-t * np.linalg.solve(M[part], L[part]))
                k[part] = np.linalg.solve(M[part], K[part].T)
                W[part] = M[part] @ K[part] @ K[part]
                f = np.sin(np.arange(121))
                # as heat fades, the bound relative to what is left grows
                self.near(heat, heat.columns(t, sources), K[:, sources])
                self.near(heat, heat.columns(t, sources, symmetric=True), k[:, sources])
                self.near(heat, heat.diagonal(t)[:, 0], np.diag(k))
                self.assertLess(abs(heat.apply(t, f)[:, 0] - K @ f).max(), 1e-7)
                i, j = np.array([17, 3, 17, 3]), np.array([29, 17, 3, 3])
                self.near(heat, heat.entries(t, i, j)[:, 0], K[i, j])
                for name, G in (("CLASSICAL", K @ k), ("WEIGHTED", W)):
                    want = np.sqrt(np.maximum(np.diag(G)[:, None] - 2 * G + np.diag(G), 0))
                    d = heat.distance(t, sources, kind="HD_DISTANCE_" + name)
                    self.assertLess(abs(d - want[:, sources]).max(), 1e-5 * want.max(), (t, kind, name))
                    pairs = heat.pairs(t, i, j, kind="HD_DISTANCE_" + name)[:, 0]
                    self.assertLess(abs(pairs - want[i, j]).max(), 1e-6 * want.max(), (t, kind, name))
            G = np.linalg.inv(L[part])
            for name, g in (("COMMUTE", G), ("BIHARMONIC", G @ M[part] @ G)):
                r = list(free).index(17)
                want = np.sqrt(g[r, r] - 2 * g[r] + np.diag(g))
                d = heat.distance(None, 17, kind="HD_DISTANCE_" + name)[:, 0]
                self.assertLess(abs(d[free] - want).max(), 1e-9 * want.max())
                self.assertEqual(np.isinf(d).sum(), 41)

    def test_points(self):
        """Points with matrices of one's own."""
        p = np.random.default_rng(2).standard_normal((150, 3))
        L, B = gaussian(p / np.linalg.norm(p, axis=1, keepdims=True), 0.02)
        self.check(hd.matrices(L, B), L.toarray(), B.toarray(), [1e-3, 0.05, 2])

    def test_sample(self):
        """Each point is a farthest one from those before it."""
        xyz, tri, _ = bumpy(9)
        lap = hd.triangles(xyz, tri)
        t = 20 * lap.h ** 2
        k2 = kernel(lap, 2 * t)
        d = np.sqrt(np.maximum(np.diag(k2)[:, None] - 2 * k2 + np.diag(k2), 0))
        vertex, distance = hd.Heat(lap).sample(t, 6, [40])
        self.assertEqual(vertex[0], 40)
        for q in range(1, 6):
            far = d[vertex[:q]].min(axis=0)
            self.assertAlmostEqual(far[vertex[q]], far.max(), delta=1e-6 * d.max())
            self.assertAlmostEqual(distance[q], far.max(), delta=1e-6 * d.max())


class Python(unittest.TestCase):
    def check(self, lap):
        t, k = 20 * lap.h ** 2, kernel(lap, 20 * lap.h ** 2)
        heat = hd.Heat(lap, method="HD_METHOD_DIRECT")
        u = heat.columns([t, 3 * t], [3, 17], symmetric=True)
        self.assertEqual(u.shape, (lap.n, 4))
        for q, (s, time) in enumerate(((3, t), (3, 3 * t), (17, t), (17, 3 * t))):
            want = kernel(lap, time)[:, s]
            self.assertLess(abs(u[:, q] - want).max(), 1e-6 * want.max())
        self.assertLess(heat.report["error_bound"], 1e-4)
        self.assertEqual(heat.report["method"], hd.C["HD_METHOD_DIRECT"])
        self.assertLess(abs(heat.diagonal(t)[:, 0] - np.diag(k)).max(), 1e-6 * k.max())
        f = np.cos(9 * np.arange(lap.n))
        self.assertLess(abs(heat.apply(t, f)[:, 0] - k @ (lap.B @ f)).max(), 1e-6)
        k2 = kernel(lap, 2 * t)
        want = np.sqrt(np.maximum(k2[5, 5] - 2 * k2[:, 5] + np.diag(k2), 0))
        self.assertLess(abs(heat.distance(t, 5)[:, 0] - want).max(), 1e-5 * want.max())

    def test_triangles(self):
        xyz, tri, _ = bumpy()
        for kind in ("HD_LAPLACIAN_FEM", "HD_LAPLACIAN_VORONOI_COT", "HD_LAPLACIAN_COT"):
            lap = hd.triangles(xyz, tri, kind=kind)
            if kind == "HD_LAPLACIAN_COT":
                self.assertLess(abs(hd.Heat(lap).columns(3, 8)[:, 0] - kernel(lap, 3)[:, 8]).max(), 1e-6)
            else:
                self.check(lap)

    def test_polygons_and_points(self):
        xyz, _, squares = bumpy()
        self.check(hd.polygons(xyz, list(squares)))
        self.check(hd.points(xyz))

    def test_matrices(self):
        n = 50
        d = np.full(n, 2.0)
        d[0] = d[-1] = 1
        L = scipy.sparse.diags([d, -np.ones(n - 1), -np.ones(n - 1)], [0, 1, -1])
        B = scipy.sparse.diags([np.full(n, 4.0) + np.arange(n), np.ones(n - 1), np.ones(n - 1)], [0, 1, -1])
        lap = hd.matrices(L, B)
        self.assertLess(abs(lap.L - L).max(), 1e-15)
        self.assertLess(abs(lap.B - B).max(), 1e-15)
        self.assertLess(abs(hd.Heat(lap).columns(30, 7, symmetric=True)[:, 0] - kernel(lap, 30)[:, 7]).max(), 1e-7)

    def test_moving(self):
        xyz, tri, _ = bumpy()
        lap = hd.triangles(xyz, tri, updatable=1)
        heat = hd.Heat(lap)
        heat.columns(1e-2, 0)
        lap.update(xyz * [1, 2, 1])
        fresh = hd.triangles(xyz * [1, 2, 1], tri)
        self.assertLess(abs(heat.columns(1e-2, 0) - hd.Heat(fresh).columns(1e-2, 0)).max(), 1e-7)

    def test_geodesic(self):
        x, y = np.meshgrid(np.arange(20.0), np.arange(20.0), indexing="ij")
        _, tri, _ = bumpy(20)
        d = hd.Geodesic(np.stack([x, y, 0 * x], -1).reshape(-1, 3), tri).distance([0])
        self.assertEqual(d[0], 0)
        self.assertLess(abs(d - np.hypot(x, y).ravel()).max(), 1.5)
        at = np.arange(400).reshape(20, 20)
        quads = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(-1, 4)
        for faces, options in ((quads.tolist(), {}), (quads, {"border": "HD_GEODESIC_BORDER_MEAN", "t_in_h2": 4}), (None, {})):
            d = hd.Geodesic(np.stack([x, y, 0 * x], -1).reshape(-1, 3), faces, **options).distance([0])
            self.assertEqual(d[0], 0)
            self.assertLess(abs(d - np.hypot(x, y).ravel()).mean(), 1)

    def test_errors(self):
        xyz, tri, _ = bumpy()
        bad = xyz.copy()
        bad[5, 1] = np.nan
        with self.assertRaises(hd.Error) as e:
            hd.triangles(bad, tri)
        self.assertEqual((e.exception.status, e.exception.vertex), (hd.C["HD_ERR_NOT_FINITE"], 5))
        self.assertIn("vertex 5", str(e.exception))
        heat = hd.Heat(hd.triangles(xyz, tri))
        with self.assertRaises(hd.Error) as e:
            heat.columns(1, 10 ** 6)
        self.assertEqual(e.exception.status, hd.C["HD_ERR_INDEX"])
        with self.assertRaises(hd.Error):
            heat.diagonal(-1)

    def test_layout(self):
        """Sizes and places of the structs as the compiler has them."""
        lines = "".join(f'printf("{name} %zu\\n", sizeof({name}));' for name in hd.S)
        lines += "".join(f'printf("{name}.{key} %zu\\n", offsetof({name}, {key}));' for name in ("hd_report", "hd_laplacian")
                         for key, _ in hd.S[name]._fields_)
        source = os.path.join(folder.name, "layout.c")
        with open(source, "w", encoding="utf-8") as f:
            f.write('#include "heatdiff.h"\n#include <stdio.h>\nint main(void) {' + lines + "return 0;}\n")
        program = os.path.join(folder.name, "layout")
        subprocess.run([CC, "-I", TOP, source, "-o", program], check=True)
        for line in subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines():
            what, size = line.split()
            name, _, key = what.partition(".")
            mine = getattr(hd.S[name], key).offset if key else hd.ctypes.sizeof(hd.S[name])
            self.assertEqual(mine, int(size), what)


    def test_tour(self):
        """Every cell of tour.py runs, and writes a picture that is not blank."""
        try:
            import matplotlib.image
        except ImportError:
            if os.environ.get("HEATDIFF_NO_SKIP"):
                raise
            self.skipTest("matplotlib is missing")
        pictures = os.path.join(folder.name, "tour")
        subprocess.run([sys.executable, os.path.join(TOP, "examples", "python", "tour.py"), pictures], check=True,
                       stdout=subprocess.DEVNULL, env={**os.environ, "MPLCONFIGDIR": folder.name})
        self.assertEqual(sorted(os.listdir(pictures)), ["accuracy.png", "distance.png", "kernel.png", "signature.png"])
        for name in os.listdir(pictures):
            image = matplotlib.image.imread(os.path.join(pictures, name))
            self.assertGreater(np.unique(image.reshape(-1, image.shape[-1]), axis=0).shape[0], 30, name)


if __name__ == "__main__":
    if np is None or CC is None or os.name == "nt":
        print("not here: NumPy, SciPy or a C compiler")
        sys.exit(1 if os.environ.get("HEATDIFF_NO_SKIP") else 77)
    unittest.main()
