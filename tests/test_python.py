"""examples/python against dense matrices of SciPy: with the library's own L and B, and with L and B assembled here.
Builds the shared library itself. Without NumPy, SciPy or a compiler it says so and exits 77, which ctest shows as skipped,
or 1 with HEATDIFF_NO_SKIP in the environment.

    test_python.py [unittest arguments]
    test_python.py --throw COUNT [SEED]     throws arguments at every function of the library in HEATDIFF_LIBRARY
"""
import copy
import gc
import inspect
import os
import pickle
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

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
    global folder
    folder = tempfile.TemporaryDirectory()
    if "HEATDIFF_LIBRARY" not in os.environ:
        library = os.path.join(folder.name, "libheatdiff.so")
        subprocess.run([CC, "-O1", "-shared", "-fPIC", "-fvisibility=hidden", os.path.join(TOP, "tools", "heatdiff_shared.c"),
                        "-o", library, "-lm"], check=True)
        os.environ["HEATDIFF_LIBRARY"] = library
    load()


def load():
    global hd
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


def spread(G):
    """Distances between all vertices from a dense Gram matrix."""
    return np.sqrt(np.maximum(np.diag(G)[:, None] - 2 * G + np.diag(G), 0))


class Dense(unittest.TestCase):
    """Columns, signatures and distances at several times against SciPy's expm of -t B^-1 L."""

    def near(self, heat, got, want, tol):
        """Each column within tol; where that is None, within the bound that the plan reports, which is a small one."""
        if tol is None:
            self.assertLess(heat.report["error_bound"], 1e-4)
            tol = heat.report["error_bound"] + 1e-12
        self.assertTrue(np.all(abs(got - want).max(axis=0) <= tol * abs(want).max(axis=0)))

    def check(self, lap, L, B, times, free=None, tol=1e-7):
        """free: the vertices that are not held at zero. As heat fades there, bounds relative to what is left grow: tol is None."""
        n, heat = len(L), hd.Heat(lap)
        free = np.arange(n) if free is None else free
        part, sources = np.ix_(free, free), [17, 3]
        self.assertTrue(np.array_equal(lap.vertex, free))
        self.assertLess(abs(lap.L - L[part]).max(), 1e-12 * abs(L).max())
        self.assertLess(abs(lap.B - B[part]).max(), 1e-13 * abs(B).max())
        i, j = np.array([17, 3, 17, 3, 0, 5, 9, 9]), np.array([29, 17, 3, 3, 1, n - 1, 9, 2])
        for t in times:
            K, k, W = np.zeros((3, n, n))
            K[part] = scipy.linalg.expm(-t * np.linalg.solve(B[part], L[part]))
            k[part] = np.linalg.solve(B[part], K[part].T)               # K B^-1, as B is symmetric
            W[part] = B[part] @ K[part] @ K[part]
            f = np.sin(np.arange(n))
            for symmetric, want in ((False, K), (True, k)):
                self.near(heat, heat.columns(t, sources, symmetric=symmetric), want[:, sources], tol)
            self.near(heat, heat.diagonal(t)[:, 0], np.diag(k), tol)
            self.assertLess(abs(heat.diagonal(t)[free, 0] / np.diag(k)[free] - 1).max(), 1e-6 if tol else 1e-3)
            self.assertLess(abs(heat.apply(t, f)[:, 0] - K @ f).max(), 1e-7)
            self.near(heat, heat.entries(t, i, j)[:, 0], K[i, j], tol)
            for kind, G in (("CLASSICAL", K @ k), ("WEIGHTED", W)):
                want, kind = spread(G), "HD_DISTANCE_" + kind
                d = heat.distance(t, sources, kind=kind)
                if want.max() < 1e-3 * G.max() ** 0.5:      # all alike to three digits: G has lost too many, the library has eigenpairs
                    self.assertLess(heat.report["error_bound"], 1e-5)
                    continue
                self.assertLess(abs(d - want[:, sources]).max(), 1e-5 * want.max(), (t, kind))
                self.assertLess(abs(heat.pairs(t, i, j, kind=kind)[:, 0] - want[i, j]).max(), 1e-6 * want.max(), (t, kind))
        self.check_without_time(heat, L[part], B[part], free)

    def check_without_time(self, heat, L, B, free):
        """Commute and biharmonic distances from the (pseudo-)inverse of B^-1/2 L B^-1/2; infinite where heat is held."""
        held = len(heat.distance(None, 17, kind="HD_DISTANCE_COMMUTE")) - len(free)
        root, r = scipy.linalg.inv(scipy.linalg.sqrtm(B).real), list(free).index(17)
        G = scipy.linalg.pinvh(root @ L @ root) if held == 0 else scipy.linalg.inv(root @ L @ root)
        for kind, power in (("COMMUTE", G), ("BIHARMONIC", G @ G)):
            want = spread(root @ power @ root)[r]
            d = heat.distance(None, 17, kind="HD_DISTANCE_" + kind)[:, 0]
            self.assertLess(abs(d[free] - want).max(), (1e-9 if held else 1e-6) * want.max(), kind)
            self.assertEqual(np.isinf(d).sum(), held)

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

    def test_held(self):
        """The border and one more vertex held at zero: the exponential of what is left of L and B, zero elsewhere."""
        xyz, tri, _ = bumpy(11)
        xyz = xyz + 0.02 * np.random.default_rng(1).standard_normal(xyz.shape)
        L, B = cotangents(xyz, tri)
        free = np.array([v for v in range(121) if 0 < v % 11 < 10 and 0 < v // 11 < 10 and v != 60])
        for kind, M in (("FEM", B), ("VORONOI_COT", voronoi(xyz, tri)), ("COT", np.eye(121))):
            lap = hd.triangles(xyz, tri, kind="HD_LAPLACIAN_" + kind, border="HD_BORDER_DIRICHLET", held=[60, 3])
            self.assertTrue(lap.info.n_held == 41 and not lap.info.conserves)
            self.check(lap, L, M, np.array([0.3, 3, 10]) * (1 if kind == "COT" else lap.h ** 2), free, None)

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
        vertex, distance = hd.Heat(lap).sample(t, 5, [40])
        for q in range(5):
            far = d[[40, *vertex[:q]]].min(axis=0)
            self.assertAlmostEqual(far[vertex[q]], far.max(), delta=1e-6 * d.max())
            self.assertAlmostEqual(distance[q], far.max(), delta=1e-6 * d.max())

    def test_own_matrices(self):
        """Those of polygons and points, as they are; and a path with a B that is not diagonal."""
        xyz, _, squares = bumpy()
        for lap in (hd.polygons(xyz, list(squares)), hd.points(xyz)):
            self.check(lap, lap.L.toarray(), lap.B.toarray(), np.array([20, 60]) * lap.h ** 2)
        d = np.full(50, 2.0)
        d[0] = d[-1] = 1
        L = scipy.sparse.diags([d, -np.ones(49), -np.ones(49)], [0, 1, -1])
        B = scipy.sparse.diags([np.full(50, 4.0) + np.arange(50), np.ones(49), np.ones(49)], [0, 1, -1])
        self.check(hd.matrices(L, B), L.toarray(), B.toarray(), [30])

    def test_many_times(self):
        """Times are the inner index of columns; the report says which method it was."""
        xyz, tri, _ = bumpy()
        lap = hd.triangles(xyz, tri)
        heat, t = hd.Heat(lap, method="HD_METHOD_DIRECT"), 20 * lap.h ** 2
        u = heat.columns([t, 3 * t], [3, 17], symmetric=True)
        self.assertEqual(u.shape, (lap.n, 4))
        for q, (s, time) in enumerate(((3, t), (3, 3 * t), (17, t), (17, 3 * t))):
            want = kernel(lap, time)[:, s]
            self.assertLess(abs(u[:, q] - want).max(), 1e-6 * want.max())
        self.assertLess(heat.report["error_bound"], 1e-4)
        self.assertEqual(heat.report["method"], hd.C["HD_METHOD_DIRECT"])


class Python(unittest.TestCase):
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


# Wrong arguments. On this sheet of 25 vertices all numbers are floats of 32 bits, so that they survive every disguise.

def small():
    xyz, tri, squares = bumpy(5)
    xyz = np.round(xyz * 1024) / 1024
    lap = hd.triangles(xyz, tri)
    return {"np": np, "sparse": scipy.sparse, "hd": hd, "xyz": xyz, "tri": tri, "squares": squares, "n": 25, "lap": lap,
            "L": lap.L, "B": lap.B, "heat": hd.Heat(lap), "f": xyz[:, :2].copy(), "g": np.tile(xyz, 2)[:, :4].copy(),
            "t": np.array([1, 2]) / 32, "moving": hd.triangles(xyz, tri, updatable=1), "geo": hd.Geodesic(xyz, tri)}


# By their error: calls, and parts of its text.
WRONG = {
    ValueError: [
        ("heat.apply(t, f[:3, 0])", "f has shape (3,), wanted is (25, k) or (25,)"),
        ("heat.apply(t, f[:24])", "f has shape (24, 2)"), ("heat.apply(t, f.T)", "f has shape (2, 25)"),
        ("heat.apply(t, f[None])", "f has shape (1, 25, 2)"), ("heat.apply(t, 1.0)", "f has shape ()"),
        ("heat.apply(t, f * np.nan)", "field is not finite (row 0, column 0)"),
        ("heat.apply(t, np.full(n, np.longdouble('1e4000')))", "field is not finite"),
        ("heat.apply([], f)", "t has shape (0,), wanted is at least one time"),
        ("heat.apply([[1, 2]], f)", "t has shape (1, 2), wanted is () or (n_times,)"),
        ("heat.apply(-1, f)", "t is negative or not finite"),
        ("heat.apply([0.1, np.nan], f)", "t is negative or not finite (column 1)"),
        ("heat.derivative(t, f[:3])", "f has shape (3, 2)"), ("heat.adjoint(t, f[:3])", "g has shape (3, 2)"),
        ("heat.vjp(t, f[:3], g)", "f has shape (3, 2)"), ("heat.vjp(t, f, g[:, :1])", "g has shape (25, 1), wanted is (25, 4)"),
        ("heat.vjp(t, f, g[:, 0])", "g has shape (25,), wanted is (25, 4)"), ("heat.vjp(t, f, g[:3])", "g has shape (3, 4)"),
        ("heat.columns(t, 25)", "not in the mesh (vertex 25, row 0, column 0)"),
        ("heat.columns(t, [0, -1])", "not in the mesh (row 0, column 1)"),
        ("heat.columns(t, [2 ** 32])", "sources is 4294967296, wanted is an integer from -2147483648 to 2147483647"),
        ("heat.columns(t, np.uint64(2 ** 63))", "sources is 9223372036854775808"),
        ("heat.columns(t, [[0, 1]])", "sources has shape (1, 2), wanted is () or (any,)"), ("heat.diagonal(0)", "not positive"),
        ("heat.diagonal([])", "at least one time"), ("heat.trace([])", "at least one time"),
        ("heat.normalised(np.inf)", "not positive and finite"),
        ("heat.scale_invariant(1, 2, 2 ** 32 + 9)", "n_times is 4294967305"),
        ("heat.scale_invariant(1, 2, 9, 6)", "n_freq is 6, wanted is an integer from 1 to 5"),
        ("heat.scale_invariant(1, 2, 9, -1)", "n_freq is -1"),
        ("heat.scale_invariant([1, 1], 2)", "t0 has shape (2,), wanted is ()"),
        ("heat.scale_invariant(1, np.nan)", "0 < t0 < t1"),
        ("heat.distance([], 0, 'HD_DISTANCE_COMMUTE')", "at least one time"),
        ("heat.distance([1, 2], 0, 'HD_DISTANCE_COMMUTE')", "time"),
        ("heat.distance(t, 0, 'HD_DISTANCE_COMMUT')", "did you mean HD_DISTANCE_COMMUTE?"),
        ("heat.distance(t, 0, 'HD_METHOD_DIRECT')", "kind is 'HD_METHOD_DIRECT'"), ("heat.distance(t, 0, 17)", "kind is 17"),
        ("heat.distance(t, 25)", "not in the mesh"), ("heat.entries(t, [0, 1], [2, 3, 4])", "j has shape (3,), wanted is (2,)"),
        ("heat.entries(t, [0], [25])", "not in the mesh"), ("heat.entries([], 0, 1)", "at least one time"),
        ("heat.pairs(t, [0], [[1]])", "j has shape (1, 1)"), ("heat.pairs(t, [-1], [0])", "not in the mesh"),
        ("heat.pairs([], 0, 1, 'HD_DISTANCE_COMMUTE')", "at least one time"),
        ("heat.sample(0.1, 0, [0, 1, 2, 3])", "count is 0, wanted is an integer from 1 to 25"),
        ("heat.sample(0.1, 3, [2 ** 32])", "given is 4294967296"), ("heat.sample(0.1, 3, [25])", "not in the mesh"),
        ("heat.sample(0.1, 2 ** 32 + 3)", "count is 4294967299"), ("heat.sample(0.1, -1)", "count is -1"),
        ("heat.sample(t, 3)", "t has shape (2,), wanted is ()"),
        ("hd.triangles(xyz.ravel(), tri)", "xyz has shape (75,), wanted is (n, 3)"),
        ("hd.triangles(xyz[:, :2], tri)", "xyz has shape (25, 2)"),
        ("hd.triangles(xyz, tri[:, :2])", "tri has shape (32, 2), wanted is (n_tri, 3)"),
        ("hd.triangles(xyz, tri.ravel())", "tri has shape (96,)"), ("hd.triangles(xyz, tri + 2 ** 32)", "tri is 4294967296"),
        ("hd.triangles(xyz, tri - 1)", "does not exist"), ("hd.triangles(xyz, tri + 1)", "does not exist"),
        ("hd.triangles(xyz * np.inf, tri)", "coordinate is not finite (vertex 0)"),
        ("hd.triangles(xyz[:0], tri[:0])", "no vertex"), ("hd.triangles(xyz, tri[:0])", "no vertex"),
        ("hd.polygons(xyz, squares.ravel())", "faces[0] has shape ()"),
        ("hd.polygons(xyz, squares[None])", "faces[0] has shape (16, 4)"),
        ("hd.polygons(xyz, squares + 2 ** 32)", "faces is 4294967296"), ("hd.polygons(xyz, squares + 1)", "does not exist"),
        ("hd.polygons(xyz, [])", "no vertex"), ("hd.polygons(xyz[:, 0], squares)", "xyz has shape (25,)"),
        ("hd.points(xyz.T)", "xyz has shape (3, 25)"),
        ("hd.matrices(L[:, :24], B)", "L has shape (25, 24), wanted is (25, 25)"),
        ("hd.matrices(L, B[:24, :24])", "B has shape (24, 24), wanted is (25, 25)"),
        ("hd.matrices(L, B * np.nan)", "B has an entry that is not finite"), ("hd.matrices(torn(L), B)", ""),
        ("hd.matrices(sparse.triu(L), B)", "not symmetric"), ("hd.matrices(-L, B)", ""),
        ("hd.matrices(L, B, -1)", "h is negative"), ("hd.matrices(L, B, np.nan)", "h is negative or not finite"),
        ("hd.Geodesic(xyz[:, :2], tri)", "xyz has shape (25, 2)"), ("hd.Geodesic(xyz, tri[:, 0])", "faces[0] has shape ()"),
        ("hd.Geodesic(xyz, tri + 1)", "does not exist"), ("geo.distance([])", "it has no point"),
        ("geo.distance(25)", "not in the mesh"), ("geo.distance([[1]])", "sources has shape (1, 1)"),
        ("lap.times(0)", "n is 0, wanted is an integer from 1"), ("lap.times(2 ** 32 + 1)", "n is 4294967297"),
        ("lap.spectral_times(-1)", "not positive"), ("lap.spectral_times([])", "at least one time"),
        ("lap.spectral_times([[1]])", "c has shape (1, 1)"),
        ("moving.update(xyz[:24])", "xyz has shape (24, 3), wanted is (25, 3)"), ("moving.update(xyz * np.nan)", "not finite"),
        ("lap.update(xyz)", "updatable"),
        ("hd.Heat(lap, method='HD_METHOD_DIREKT')", "method is 'HD_METHOD_DIREKT': did you mean HD_METHOD_DIRECT?"),
        ("hd.Heat(lap, method='HD_POLES_KERNEL')", "method is 'HD_POLES_KERNEL'"),
        ("hd.Heat(lap, method=99)", "method is 99, wanted is one of HD_METHOD_AUTO, HD_METHOD_ITERATIVE"),
        ("hd.Heat(lap, degree=2 ** 32 + 9)", "degree is 4294967305"), ("hd.Heat(lap, tol=[1e-9, 1e-8])", "tol has shape (2,)"),
        ("hd.Heat(lap, tol=np.nan)", "tol"), ("hd.Heat(lap, ordering='HD_ORDERING_OWN')", "perm"),
        ("hd.Heat(lap, ordering='HD_ORDERING_OWN', perm=np.arange(24))", "perm has shape (24,), wanted is (25,)"),
        ("hd.Heat(lap, ordering='HD_ORDERING_OWN', perm=np.zeros(n, int)).diagonal(t)", "permutation"),
        ("hd.triangles(xyz, tri, held=[25])", "not in the mesh"), ("hd.triangles(xyz, tri, held=[-1])", "not in the mesh"),
        ("hd.triangles(xyz, tri, border='HD_BORDER_NEUMANN')", "border is 'HD_BORDER_NEUMANN'"),
        ("hd.points(xyz, bandwidth2=np.nan)", "bandwidth2"),
        ("hd.points(xyz, neighbours=2 ** 40)", "neighbours is 1099511627776"), ("hd.Geodesic(xyz, tri, t=-1)", "t is negative"),
        ("hd.Geodesic(xyz, tri, mass='HD_BORDER_NATURAL')", "mass is 'HD_BORDER_NATURAL'")],
    TypeError: [
        ("heat.apply(t, f + 0j)", "f has dtype complex128 and shape (25, 2), wanted are numbers"),
        ("heat.apply(t, f.astype(str))", "f has dtype <U"), ("heat.apply(t, f.astype(object))", "f has dtype object"),
        ("heat.apply(t, L)", "f has dtype object"), ("heat.apply(t, np.ma.masked_less(f, 0.1))", "f is a masked array"),
        ("heat.apply(None, f)", "t has dtype object"), ("heat.apply('0.1', f)", "t has dtype <U3"),
        ("heat.apply(True, f)", "t has dtype bool"), ("heat.apply(1j, f)", "t has dtype complex128"),
        ("heat.columns(t, 1.5)", "sources has dtype float64 and shape (), wanted are integers"),
        ("heat.columns(t, [2 ** 70])", "sources has dtype object"),
        ("heat.columns(t, np.arange(n) == 3)", "sources has dtype bool"), ("heat.columns(t, 0, [3, 4])", "symmetric is [3, 4]"),
        ("heat.columns(t, 0, 'yes')", "symmetric is 'yes'"),
        ("heat.scale_invariant(1, 2, 9.5)", "n_times is 9.5, wanted is an integer"),
        ("heat.distance(None, 0)", "t has dtype object"), ("heat.distance(t, 0, None)", "kind is None"),
        ("heat.entries(t, [0.5], [1])", "i has dtype float64"), ("heat.pairs(None, 0, 1)", "t has dtype object"),
        ("heat.sample(0.1, 3, [1.5])", "given has dtype float64"), ("heat.sample(0.1, 2.5)", "count is 2.5"),
        ("hd.triangles(xyz, tri + 0.5)", "tri has dtype float64"), ("hd.triangles(xyz + 1j, tri)", "xyz has dtype complex128"),
        ("hd.polygons(xyz, squares.astype(float))", "faces[0] has dtype float64"),
        ("hd.polygons(xyz, [[0, 1, 6], [0, 1, 6.5]])", "faces[1] has dtype float64"),
        ("hd.polygons(xyz, 5)", "faces are no lists of vertices"),
        ("hd.matrices(L.toarray(), B)", "L is a ndarray, wanted is a matrix of scipy.sparse"),
        ("hd.matrices(L * 1j, B)", "L has dtype complex128"), ("hd.matrices(L, B.astype(bool))", "B has dtype bool"),
        ("hd.matrices(L, B, 'a')", "h has dtype <U1"), ("hd.Geodesic(xyz, tri.astype(float))", "faces has dtype float64"),
        ("geo.distance(1.5)", "sources has dtype float64"), ("lap.times(2.0)", "n is 2.0"),
        ("hd.Heat(5)", "lap is a int, wanted is a Laplacian"), ("hd.Heat(heat)", "lap is a Heat"),
        ("hd.Heat(None)", "lap is a NoneType"), ("hd.Laplacian('hd_laplacian_free', 0)", ""),
        ("hd.Heat(lap, methd='HD_METHOD_DIRECT')", "unknown option methd: did you mean method?"),
        ("hd.Heat(lap, context=5)", "unknown option context"), ("hd.Heat(lap, rational=5)", "unknown option rational"),
        ("hd.Heat(lap, begin_zero=1)", "unknown option begin_zero"), ("hd.Heat(lap, held=[1])", "unknown option held"),
        ("hd.Heat(lap, method=1.0)", "method is 1.0"), ("hd.Heat(lap, degree=9.5)", "degree is 9.5"),
        ("hd.Heat(lap, degree='HD_OK')", "degree is 'HD_OK'"), ("hd.Heat(lap, tol='small')", "tol has dtype <U5"),
        ("hd.Heat(lap, tol=1j)", "tol has dtype complex128"), ("hd.triangles(xyz, tri, held=[1.5])", "held has dtype float64"),
        ("hd.triangles(xyz, tri, held=np.arange(n) == 3)", "held has dtype bool"),
        ("hd.triangles(xyz, tri, n_held=3)", "unknown option n_held"),
        ("hd.polygons(xyz, squares, stiffness=1)", "unknown option stiffness: did you mean stiffening?"),
        ("hd.Geodesic(xyz, tri, time=1)", "unknown option time"), ("copy.copy(lap)", "a Laplacian cannot be copied or pickled"),
        ("copy.deepcopy(heat)", "a Heat cannot be copied or pickled"),
        ("pickle.dumps(geo)", "a Geodesic cannot be copied or pickled")],
    (ValueError, TypeError): [
        ("heat.apply(t, [[1, 2], [3]])", "f "), ("hd.points(xyz.tolist()[:4] + [[1, 2]])", "xyz ")],
}


def torn(a):
    """A matrix whose first row is said to reach far beyond its arrays."""
    a = a.copy()
    a.indptr[1:] += 10 ** 6
    return a


class Arguments(unittest.TestCase):
    def test_wrong(self):
        names = dict(small(), copy=copy, pickle=pickle, torn=torn)
        want = names["heat"].apply(names["t"], names["f"])
        for call, error, text in ((call, error, text) for error in WRONG for call, text in WRONG[error]):
            with self.subTest(call), warnings.catch_warnings():
                warnings.simplefilter("ignore")                 # of NumPy about values that it cannot convert
                with self.assertRaises(error) as e:
                    eval(call, names)
                self.assertIn(text, str(e.exception))
        self.assertTrue(np.array_equal(names["heat"].apply(names["t"], names["f"]), want))

    def test_right(self):
        """What looks unusual and is not wrong."""
        names = small()
        n, xyz, tri, lap, heat, f, t = (names[x] for x in ("n", "xyz", "tri", "lap", "heat", "f", "t"))
        self.assertEqual(heat.apply(t, np.zeros((n, 0))).shape, (n, 0))
        self.assertEqual(heat.columns(t, []).shape, (n, 0))
        self.assertEqual(heat.entries(t, [], []).shape, (0, 2))
        mask = np.arange(n) == 3
        self.assertLess(abs(heat.apply(t[0], mask) - heat.columns(t[0], 3)).max(), 1e-7)
        self.assertTrue(np.array_equal(heat.entries(t, 3, range(n)), heat.entries(t, np.full(n, 3), np.arange(n))))
        self.assertTrue(np.array_equal(heat.columns(t, 3, np.bool_(True)), heat.columns(t, 3, 1)))
        self.assertEqual(heat.sample(None, 2, kind="HD_DISTANCE_COMMUTE")[0].shape, (2,))
        self.assertEqual(hd.polygons(xyz, [[]] + tri.tolist()).info.mesh.n_zero_area, 1)
        self.assertEqual(hd.triangles(xyz, tri, held=3, updatable=np.bool_(True), kind=hd.C["HD_LAPLACIAN_COT"]).info.n_held, 1)
        own = hd.Heat(lap, ordering="HD_ORDERING_OWN", perm=np.arange(n)[::-1], method="HD_METHOD_DIRECT", tol=np.float32(1e-9))
        self.assertLess(abs(own.apply(t, f) - heat.apply(t, f)).max(), 1e-7)
        twice = scipy.sparse.coo_matrix((np.repeat(lap.L.tocoo().data / 2, 2), [np.repeat(x, 2) for x in lap.L.nonzero()]))
        self.assertLess(abs(hd.matrices(twice, lap.B).L - lap.L).max(), 1e-15)

    def test_closed(self):
        """Whatever is closed raises; a Laplacian takes its plans with it; info is a copy that stays."""
        names = small()
        lap, heat, geo = names["lap"], names["heat"], names["geo"]
        info, other = lap.info, hd.Heat(lap)
        info.n = info.n_active = 10 ** 6                        # of a copy
        self.assertEqual((lap.n, len(lap.mass)), (25, 25))
        with self.assertRaises(AttributeError):
            lap.n = 10 ** 6
        other.close()
        other.close()
        with self.assertRaisesRegex(ValueError, "closed"):
            other.columns(1, 0)
        with lap:
            heat.columns(1, 0)
        geo.close()
        for use in ("lap.n", "lap.info", "lap.L", "lap.B", "lap.mass", "lap.vertex", "lap.times(3)", "lap.spectral_times(1)",
                    "lap.update(xyz)", "hd.Heat(lap)", "heat.apply(t, f)", "heat.columns(t, 0)", "heat.diagonal(t)",
                    "heat.trace(t)", "heat.entries(t, 0, 1)", "heat.sample(1, 2)", "geo.distance(0)"):
            with self.subTest(use), self.assertRaisesRegex(ValueError, "closed"):
                eval(use, names)
        lap.close()
        del lap, heat, geo, other, names

    def test_threads(self):
        """Threads that share a plan, its Laplacian and other plans of it get the right numbers."""
        names = small()
        lap, heat, t = names["lap"], names["heat"], names["t"]
        want, right = heat.columns(t, range(25)), []

        def work(k):
            for s in range(k, k + 15):
                plan = heat if s % 3 else hd.Heat(lap)
                right.append(abs(plan.columns(t, s % 25) - want[:, 2 * (s % 25):][:, :2]).max() < 1e-7)

        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(right, [True] * 60)

    def test_throw(self):
        """In a process of its own, which a crash would end, and where freed memory is overwritten."""
        environment = dict(os.environ, GLIBC_TUNABLES="glibc.malloc.tcache_count=0:glibc.malloc.perturb=165")
        for seed in "12":
            done = subprocess.run([sys.executable, os.path.abspath(__file__), "--throw", "1500", seed], env=environment,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
            self.assertEqual(done.returncode, 0, done.stdout[-2000:])


# Throwing arguments: every function gets what looks unusual and is right, or with it one argument that is wrong.

def disguised(kind, x, rng):
    """The same in another array: of another type, order, alignment, or a part of a larger one."""
    if kind == "sparse":
        return x.asformat(rng.choice(["csr", "csc", "coo", "lil", "bsr", "dia"]))
    if kind == "count":
        return rng.choice([int, np.int64, np.uint8, np.array])(x)
    a = x.astype(rng.choice(["f8", "f4", ">f8", np.longdouble] if x.dtype.kind == "f" else ["i8", "i4", "u2", ">i4"]))
    odd = np.zeros(a.nbytes + 1, np.uint8)[1:].view(a.dtype).reshape(a.shape)
    wide = np.zeros([2 * m for m in a.shape], a.dtype)[tuple(slice(None, None, 2) for _ in a.shape)]
    odd[...] = wide[...] = a
    a.setflags(write=False)
    return rng.choice([a, odd, wide, np.asfortranarray(a), np.flip(np.flip(a).copy()), a.tolist()])


def spoilt(kind, x, rng):
    """No right argument of this kind any more."""
    if kind == "sparse":
        return rng.choice([x.toarray(), x[:-1], x[:, :-1], x[:-1, :-1], x * 1j, x.astype(bool), x * np.nan, torn(x), -x, None,
                           "L", scipy.sparse.csr_matrix((0, 0)), x + scipy.sparse.diags([1.0], [1], x.shape)])
    if kind == "count":
        return rng.choice([None, "abc", {}, [x], x + 0.5, float(x), 1j, -1, x + 2 ** 32, x - 2 ** 64])
    a = x.copy()
    a.flat[rng.randrange(a.size)] = rng.choice([np.nan, np.inf, -np.inf] if a.dtype.kind == "f" else [-1, 10 ** 6])
    ways = [a, "abc", {}, object(), 1j * x, x.astype(str), x.astype(object), np.ma.array(x), x[None, None], [[1], [2, 3]]]
    if x.dtype.kind == "i":
        ways += [x.astype(float), x + 0.5, x > 0, x + 2 ** 32, x - 2 ** 32, x + np.uint64(2 ** 63)]
    if x.ndim == 2:
        ways += [x.ravel(), x[..., None]] + [x.T] * (kind != "faces") + [x[:, :-1], x[:, 0]] * (kind not in ("field", "faces"))
    if kind not in ("any", "faces"):
        ways += [x[:0]] + [x[:-1]] * (kind != "some")
    if kind in ("same", "field"):
        ways += [np.concatenate([x, x[:1]]), x.repeat(2, 0)]
    return rng.choice(ways)


def throws(names):
    """Calls with kinds and right values of their arguments. same: of this shape only; field: any columns; faces: any rows
    and columns; all: rows that are missed; some: at least one; any: none or more."""
    xyz, tri, f, g, t = (names[x] for x in ("xyz", "tri", "f", "g", "t"))
    heat, lap, moving, geo = (names[x] for x in ("heat", "lap", "moving", "geo"))
    ids, others, t1 = np.array([3, 17, 3]), np.array([0, 24, 9]), t[0]
    made = lambda lap: (lap.L.data, lap.B.data, lap.mass, lap.vertex)
    heated = lambda **options: hd.Heat(lap, **options).columns(t, 5)
    return [
        (lambda x, y: made(hd.triangles(x, y)), ("all", xyz), ("any", tri)),
        (lambda x: made(hd.triangles(xyz, tri, held=x)), ("any", ids)),
        (lambda x, y: made(hd.polygons(x, y)), ("all", xyz), ("faces", names["squares"])),
        (lambda x: made(hd.points(x, neighbours=8)), ("any", xyz)),
        (lambda x, y: made(hd.matrices(x, y)), ("sparse", names["L"]), ("sparse", names["B"])),
        (lambda x: (moving.update(x), made(moving))[1], ("same", xyz)),
        (lambda n: lap.times(n), ("count", 4)),
        (lambda x: lap.spectral_times(x), ("some", t)),
        (lambda s, x: heat.apply(s, x), ("some", t), ("field", f)),
        (lambda s, x: heat.derivative(s, x), ("some", t), ("field", f)),
        (lambda s, x: heat.adjoint(s, x), ("some", t), ("field", f)),
        (lambda s, x, y: heat.vjp(s, x, y), ("same", t), ("field", f), ("same", g)),
        (lambda s, i: heat.columns(s, i), ("some", t), ("any", ids)),
        (lambda s: heat.diagonal(s), ("some", t)),
        (lambda s: heat.trace(s), ("some", t)),
        (lambda s: heat.normalised(s), ("some", t)),
        (lambda n, k: heat.scale_invariant(0.1, 8, n, k), ("count", 17), ("count", 6)),
        (lambda s, i: heat.distance(s, i), ("some", t), ("any", ids)),
        (lambda i: heat.distance(None, i, "HD_DISTANCE_COMMUTE"), ("any", ids)),
        (lambda s, i, j: heat.entries(s, i, j), ("some", t), ("same", ids), ("same", others)),
        (lambda s, i, j: heat.pairs(s, i, j), ("some", t), ("same", ids), ("same", others)),
        (lambda n, i: heat.sample(t1, n, i), ("count", 5), ("any", ids[:2])),
        (lambda x, y: hd.Geodesic(x, y).distance(4), ("all", xyz), ("any", tri)),
        (lambda x: hd.Geodesic(x, neighbours=8).distance(4), ("any", xyz)),
        (lambda i: geo.distance(i), ("some", ids)),
        (lambda x: heated(degree=x, method="HD_METHOD_DIRECT"), ("count", 9)),
        (lambda x: heated(ordering="HD_ORDERING_OWN", perm=x), ("same", np.arange(25)[::-1])),
    ]


def alike(a, b):
    finite = np.isfinite(b)
    return a.shape == b.shape and np.array_equal(a[~finite], b[~finite]) and np.allclose(a[finite], b[finite], 1e-6, 1e-7)


def lifetimes():
    """update reads a copy of coordinates of any kind before it is freed. Plans and their Laplacian in a circle are freed in
    any order, in any thread, and once."""
    xyz, tri, _ = bumpy(20)
    lap, want = hd.triangles(xyz, tri, updatable=1), hd.triangles(np.float32(xyz), tri).L
    for other in (np.float32, lambda x: np.asfortranarray(np.float32(x)), lambda x: np.float32(x).tolist()):
        lap.update(xyz)
        lap.update(other(xyz))
        assert abs(lap.L - want).max() < 1e-12
    for k in range(20):
        names = small()
        plans = [hd.Heat(names["lap"]) for _ in range(3)]
        names["lap"].circle = plans, names
        plans[k % 3].columns(1, 0)
        del plans, names
        if k % 2:
            gc.collect()
        else:
            threading.Thread(target=gc.collect).start()


def throw(count, seed):
    """Ends with 1 after a wrong number, or an exception of another kind than those promised."""
    load()
    rng, bad, right, refused = random.Random(seed), 0, 0, 0
    names = small()
    for _ in range(count):
        k = rng.randrange(len(throws(names)))
        call, *args = throws(names)[k]
        spoil = rng.randrange(2 * len(args))                    # this one, or none
        given = [(spoilt if q == spoil else disguised)(kind, x, rng) for q, (kind, x) in enumerate(args)]
        what = inspect.getsource(call).strip() + "".join("\n    %.200r" % (x,) for x in given)
        print(what, file=sys.stderr, flush=True)                # is the last line if it crashes
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")                 # of NumPy about values that it cannot convert
                got = call(*given)
        except (ValueError, TypeError) as error:
            refused += 1
            text = "" if spoil < len(args) else "refused by %r, but right" % error
        except Exception as error:
            text = "%r" % error
        else:
            right += 1
            got, want = (np.concatenate([np.ravel(a) for a in (x if type(x) is tuple else (x,))])
                         for x in (got, call(*(x for _, x in args))))
            text = "not refused" if spoil < len(args) else "" if alike(got, want) else "wrong numbers"
        if text:
            bad += 1
            print(what + "\n" + text)
    print("seed %d: %d right, %d refused, %d bad" % (seed, right, refused, bad))
    lifetimes()
    return bad > 0


if __name__ == "__main__":
    if np is None or CC is None or os.name == "nt":
        print("not here: NumPy, SciPy or a C compiler")
        sys.exit(1 if os.environ.get("HEATDIFF_NO_SKIP") else 77)
    if sys.argv[1:2] == ["--throw"]:
        sys.exit(throw(int(sys.argv[2]), int((sys.argv[3:] or [0])[0])))
    unittest.main()
