"""The package examples/python against dense matrices of SciPy: with the library's own L and B, and with L and B assembled
here; its ctypes face against a compiler; wrong arguments; Ctrl-C, threads, warnings; the wheel. Builds the shared library
itself. Without NumPy, SciPy or a compiler it says so and exits 77, which ctest shows as skipped, or 1 with
HEATDIFF_NO_SKIP in the environment.

    test_python.py [unittest arguments]
    test_python.py --throw COUNT [SEED]     throws arguments at every function of the library in HEATDIFF_LIBRARY
"""
import copy
import ctypes
import gc
import importlib.util
import inspect
import os
import pickle
import random
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import threading
import time
import types
import unittest
import warnings
import zipfile

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
    sys.path.insert(0, os.path.join(TOP, "examples", "python", "src"))
    os.environ["PYTHONPATH"] = sys.path[0]                      # for the examples
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


def mesh(*arguments, **options):
    return hd.Laplacian.from_mesh(*arguments, **options)


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
            self.assertLess(got.report.error_bound, 1e-4)
            tol = got.report.error_bound + 1e-12
        self.assertTrue(np.all(abs(got - want).max(axis=0) <= tol * abs(want).max(axis=0)))

    def check(self, lap, L, B, times, free=None, tol=1e-7):
        """free: the vertices that are not held at zero. As heat fades there, bounds relative to what is left grow: tol is None."""
        n, heat = len(L), hd.Heat(lap)
        free = np.arange(n) if free is None else free
        part, sources = np.ix_(free, free), [17, 3]
        self.assertTrue(np.array_equal(lap.vertex, free))
        self.assertEqual(lap.L.shape, (n, n))
        self.assertLess(abs(lap.L.toarray()[part] - L[part]).max(), 1e-12 * abs(L).max())
        self.assertLess(abs(lap.B.toarray()[part] - B[part]).max(), 1e-13 * abs(B).max())
        self.assertEqual(lap.L.nnz, lap.L[free][:, free].nnz)
        i, j = np.array([17, 3, 17, 3, 0, 5, 9, 9]), np.array([29, 17, 3, 3, 1, n - 1, 9, 2])
        for t in times:
            K, k, W = np.zeros((3, n, n))
            K[part] = scipy.linalg.expm(-t * np.linalg.solve(B[part], L[part]))
            k[part] = np.linalg.solve(B[part], K[part].T)               # K B^-1, as B is symmetric
            W[part] = B[part] @ K[part] @ K[part]
            f = np.sin(np.arange(n))
            for symmetric, want in ((False, K), (True, k)):
                self.near(heat, heat.columns(sources, t, symmetric=symmetric), want[:, sources], tol)
            self.near(heat, heat.diagonal(t), np.diag(k), tol)
            self.assertLess(abs(heat.hks(t)[free] / np.diag(k)[free] - 1).max(), 1e-6 if tol else 1e-3)
            self.assertLess(abs(heat.apply(f, t) - K @ f).max(), 1e-7)
            self.near(heat, heat.entries(i, j, t), K[i, j], tol)
            for kind, G in (("classical", K @ k), ("weighted", W)):
                want = spread(G)
                d = heat.distance(sources, t, kind=kind)
                if want.max() < 1e-3 * G.max() ** 0.5:      # all alike to three digits: G has lost too many, the library has eigenpairs
                    self.assertLess(d.report.error_bound, 1e-5)
                    continue
                self.assertLess(abs(d - want[:, sources]).max(), 1e-5 * want.max(), (t, kind))
                self.assertLess(abs(heat.pairs(i, j, t, kind=kind) - want[i, j]).max(), 1e-6 * want.max(), (t, kind))
        self.check_without_time(heat, L[part], B[part], free)

    def check_without_time(self, heat, L, B, free):
        """Commute and biharmonic distances from the (pseudo-)inverse of B^-1/2 L B^-1/2; infinite where heat is held."""
        held = len(heat.distance(17, kind="commute")) - len(free)
        root, r = scipy.linalg.inv(scipy.linalg.sqrtm(B).real), list(free).index(17)
        G = scipy.linalg.pinvh(root @ L @ root) if held == 0 else scipy.linalg.inv(root @ L @ root)
        for kind, power in (("commute", G), ("biharmonic", G @ G)):
            want = spread(root @ power @ root)[r]
            d = heat.distance(17, kind=kind)
            self.assertLess(abs(d[free] - want).max(), (1e-9 if held else 1e-6) * want.max(), kind)
            self.assertEqual(np.isinf(d).sum(), held)

    def test_derivatives_and_adjoints(self):
        """By dense matrices, and the gradients of a loss by differences."""
        xyz, tri, _ = bumpy(9)
        L, B = cotangents(xyz, tri)
        rng = np.random.default_rng(3)
        for kind, mass in (("fem", B), ("voronoi-cot", voronoi(xyz, tri))):
            lap = mesh(xyz, tri, kind=kind)
            A, t, f = np.linalg.solve(mass, L), np.array([2, 20]) * lap.h ** 2, rng.standard_normal((81, 3))
            want = [scipy.linalg.expm(-s * A) for s in t]
            for method in ("direct", "krylov", "iterative"):
                heat = hd.Heat(lap, method=method)
                rate, dual = heat.derivative(f, t), heat.adjoint(f, t)
                self.assertEqual(rate.report.method, method)
                for m, K in enumerate(want):
                    self.assertLess(abs(rate[..., m] + A @ K @ f).max(), 1e-7 * abs(A @ K @ f).max())
                    self.assertLess(abs(dual[..., m] - K.T @ f).max(), 1e-7 * abs(K.T @ f).max())
            heat = hd.Heat(lap, method="direct", poles="kernel", degree=14)
            g, d = rng.standard_normal((81, 3, 2)), rng.standard_normal((81, 3))
            by_t, by_f = heat.vjp(f, t, g)
            loss = lambda t, f: np.sum(g * heat.apply(f, t))
            for m in range(2):
                step = 1e-4 * t[m] * np.eye(2)[m]
                self.assertAlmostEqual((loss(t + step, f) - loss(t - step, f)) / (2e-4 * t[m]) / by_t[m], 1, delta=1e-6)
            self.assertAlmostEqual(loss(t, d) / np.sum(by_f * d), 1, delta=1e-10)

    def test_traces_and_signatures(self):
        xyz, tri, _ = bumpy(9)
        L, B = cotangents(xyz, tri)
        lap = mesh(xyz, tri)
        heat, values = hd.Heat(lap), np.maximum(scipy.linalg.eigh(L, B)[0], 0)
        t = lap.times("auto:5")
        self.assertLess(abs(t / lap.area - np.geomspace(0.0024, 0.37, 5)).max(), 1e-12)
        self.assertLess(abs(lap.times(["1/l1", "0.3/l1"]) * values[1] - [1, 0.3]).max(), 1e-8)
        trace, bound = heat.trace(t)
        want = np.exp(-np.outer(t, values)).sum(axis=1)
        self.assertTrue((abs(trace - want) <= bound + 1e-12 * want).all() and (bound < 1e-6 * want).all())
        k = np.stack([np.diag(kernel(lap, s)) for s in t], axis=1)
        self.assertLess(abs(heat.hks(t, normalise=True) * want / k - 1).max(), 4e-7)
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

    def test_torch(self):
        """The layer of learn_time.py, by PyTorch's own differences. Its formulas are those of the two tests above."""
        if not importlib.util.find_spec("torch"):
            self.skipTest("PyTorch is missing")
        import torch
        sys.path.append(os.path.join(TOP, "examples", "python"))
        import learn_time
        xyz, tri = learn_time.surface(8)
        lap = mesh(xyz, tri)
        plans = [hd.Heat(lap, method="direct", poles="kernel", degree=10) for _ in range(2)]
        t = torch.tensor(lap.times(["3h2", "8h2"]), requires_grad=True)
        f = torch.randn(lap.n, 2, dtype=torch.float64, requires_grad=True)
        self.assertTrue(torch.autograd.gradcheck(lambda t, f: learn_time.Diffuse.apply(plans, t, f), (t, f), eps=1e-7, atol=1e-5, rtol=1e-4))

    def test_meshes(self):
        xyz, tri, _ = bumpy(11)
        xyz = xyz + 0.02 * np.random.default_rng(1).standard_normal(xyz.shape)
        L, B = cotangents(xyz, tri)
        times = np.array([0.3, 3, 30, 1000]) * mesh(xyz, tri).h ** 2
        self.check(mesh(xyz, tri, kind="fem"), L, B, times)
        self.check(mesh(xyz, tri, kind="voronoi-cot"), L, voronoi(xyz, tri), times)
        self.check(mesh(xyz, tri, kind="cot"), L, np.eye(len(xyz)), [0.1, 10])

    def test_held(self):
        """The border and one more vertex held at zero: the exponential of what is left of L and B, zero elsewhere."""
        xyz, tri, _ = bumpy(11)
        xyz = xyz + 0.02 * np.random.default_rng(1).standard_normal(xyz.shape)
        L, B = cotangents(xyz, tri)
        free = np.array([v for v in range(121) if 0 < v % 11 < 10 and 0 < v // 11 < 10 and v != 60])
        for kind, M in (("fem", B), ("voronoi-cot", voronoi(xyz, tri)), ("cot", np.eye(121))):
            lap = mesh(xyz, tri, kind=kind, border="dirichlet", held=[60, 3])
            self.assertTrue(lap.n_held == 41 and not lap.conserves)
            self.check(lap, L, M, np.array([0.3, 3, 10]) * (1 if kind == "cot" else lap.h ** 2), free, None)

    def test_points(self):
        """Points with matrices of one's own."""
        p = np.random.default_rng(2).standard_normal((150, 3))
        L, B = gaussian(p / np.linalg.norm(p, axis=1, keepdims=True), 0.02)
        self.check(hd.Laplacian.from_matrices(L, B), L.toarray(), B.toarray(), [1e-3, 0.05, 2])

    def test_sample(self):
        """Each point is a farthest one from those before it."""
        xyz, tri, _ = bumpy(9)
        lap = mesh(xyz, tri)
        t = 20 * lap.h ** 2
        k2 = kernel(lap, 2 * t)
        d = np.sqrt(np.maximum(np.diag(k2)[:, None] - 2 * k2 + np.diag(k2), 0))
        vertex, distance = hd.Heat(lap).sample(5, t, [40])
        for q in range(5):
            far = d[[40, *vertex[:q]]].min(axis=0)
            self.assertAlmostEqual(far[vertex[q]], far.max(), delta=1e-6 * d.max())
            self.assertAlmostEqual(distance[q], far.max(), delta=1e-6 * d.max())

    def test_own_matrices(self):
        """Those of polygons and points, as they are; and a path with a B that is not diagonal."""
        xyz, _, squares = bumpy()
        for lap in (hd.Laplacian.from_polygons(xyz, list(squares)), hd.Laplacian.from_points(xyz)):
            self.check(lap, lap.L.toarray(), lap.B.toarray(), np.array([20, 60]) * lap.h ** 2)
        d = np.full(50, 2.0)
        d[0] = d[-1] = 1
        L = scipy.sparse.diags([d, -np.ones(49), -np.ones(49)], [0, 1, -1])
        B = scipy.sparse.diags([np.full(50, 4.0) + np.arange(50), np.ones(49), np.ones(49)], [0, 1, -1])
        self.check(hd.Laplacian.from_matrices(L, B), L.toarray(), B.toarray(), [30])

    def test_many_times(self):
        """Times are the inner index of columns; the report says which method it was."""
        xyz, tri, _ = bumpy()
        lap = mesh(xyz, tri)
        heat, t = hd.Heat(lap, method="direct"), 20 * lap.h ** 2
        u = heat.columns([3, 17], ["20h2", "60h2"], symmetric=True)
        self.assertEqual(u.shape, (lap.n, 2, 2))
        for s, time in ((0, 0), (0, 1), (1, 0), (1, 1)):
            want = kernel(lap, [t, 3 * t][time])[:, [3, 17][s]]
            self.assertLess(abs(u[:, s, time] - want).max(), 1e-6 * want.max())
        self.assertLess(u.report.error_bound, 1e-4)
        self.assertEqual(u.report.method, "direct")


class Face(unittest.TestCase):
    """What the Python face adds to the library."""

    def test_moving(self):
        xyz, tri, _ = bumpy()
        lap = mesh(xyz, tri, updatable=True)
        heat, pairs, geo = hd.Heat(lap), hd.Spectrum(lap, 3), hd.Geodesic(xyz, tri, updatable=True)
        heat.column(0, 1e-2)
        for moving in (lap, geo):
            moving.update(xyz * [1, 2, 1])
        fresh = mesh(xyz * [1, 2, 1], tri)
        self.assertLess(abs(heat.column(0, 1e-2) - hd.Heat(fresh).column(0, 1e-2)).max(), 1e-7)
        self.assertTrue(np.array_equal(geo.distance(0), hd.Geodesic(xyz * [1, 2, 1], tri).distance(0)))
        with self.assertRaisesRegex(ValueError, "updated after"):
            pairs.diagonal(1)
        self.assertLess(abs(lap.times("1/l1") - fresh.times("1/l1")), 1e-9)
        own = hd.Laplacian.from_matrices(fresh.L, fresh.B, fresh.h, updatable=True)
        own.update_matrices(3 * fresh.L, fresh.B, fresh.h)
        self.assertLess(abs(hd.Heat(own).column(0, 1e-2) - hd.Heat(fresh).column(0, 3e-2)).max(), 1e-7)

    def test_geodesic(self):
        x, y = np.meshgrid(np.arange(20.0), np.arange(20.0), indexing="ij")
        xyz = np.stack([x, y, 0 * x], -1).reshape(-1, 3)
        _, tri, quads = bumpy(20)
        d = hd.geodesic_distance(xyz, tri, 0)
        self.assertEqual(d[0], 0)
        self.assertLess(abs(d - np.hypot(x, y).ravel()).max(), 1.5)
        self.assertEqual(d.report.t, hd.Geodesic(xyz, tri).distance(0).report.h ** 2)
        geo = hd.Geodesic(xyz, tri, t="2h2")
        both, each = geo.distance([0, 399]), geo.distance([0, 399], each=True)
        self.assertEqual((both.shape, each.shape, each[0, 0], each[399, 1]), ((400,), (400, 2), 0, 0))
        self.assertLess(abs(both - each.min(axis=1)).max(), 2)
        inside = geo.distance(hd.Sources([[0, 20, 21]], [[0.5, 0.25, 0.25]]))
        self.assertAlmostEqual(inside[0, 0], np.hypot(0.5, 0.25), delta=1e-12)
        mixed = quads.tolist()[1:] + [[0, 20, 21], [0, 21, 1]]
        for faces, options in ((mixed, {}), (quads.tolist(), {}), (quads, {"border": "mean", "t": "4h2"}), (None, {})):
            d = hd.Geodesic(xyz, faces, **options).distance([0])
            self.assertEqual(d[0], 0)
            self.assertLess(abs(d - np.hypot(x, y).ravel()).mean(), 1)

    def test_waves(self):
        """The wave kernel signature of all eigenvalues."""
        xyz, tri, _ = bumpy(9)
        lap = mesh(xyz, tri)
        values, vectors = scipy.linalg.eigh(lap.L.toarray(), lap.B.toarray())
        e = np.log([20.0, 100.0, 400.0])
        band = np.exp(-(e[:, None] - np.log(values[1:])) ** 2 / (2 * 0.4 ** 2))
        want = vectors[:, 1:] ** 2 @ band.T
        heat = hd.Heat(lap)
        got = heat.wks(e)
        self.assertLess(abs(got - want / band.sum(axis=1)).max(), 1e-6)
        self.assertLess(abs(heat.wks(e, normalise=False) - want).max(), 1e-4)
        self.assertLess(got.report.error_bound, 1e-3)
        self.assertEqual(hd.wks(xyz, tri).shape, (81, 16))
        self.assertLess(abs(heat.diagonal(0.01) - np.diag(kernel(lap, 0.01))).max(), 1e-4)     # heat again

    def test_spectrum(self):
        xyz, tri, _ = bumpy(9)
        lap = mesh(xyz, tri)
        values, vectors = scipy.linalg.eigh(lap.L.toarray(), lap.B.toarray())
        s = hd.Spectrum(lap, 12)
        self.assertTrue(s.proven and s.n_constant == 1 and s.vectors.shape == (81, 12))
        self.assertLess(abs(s.values - values[:12]).max(), 1e-9 * values[11])
        self.assertLess(abs(s.vectors.T @ (lap.B @ s.vectors) - np.eye(12)).max(), 1e-9)
        self.assertEqual(len(hd.Spectrum(lap, below=values[5:7].mean()).values), 6)
        k = kernel(lap, 0.05)
        for (got, bound), want in ((s.columns([3, 4], 0.05, symmetric=True), k[:, [3, 4]]), (s.diagonal(0.05), np.diag(k)),
                                   (s.distance(3, 0.025), spread(k)[:, 3])):
            self.assertTrue((abs(got - want) <= bound).all() and got.shape == want.shape)
        self.assertEqual(s.distance(3, kind="commute")[0].shape, (81,))

    def test_sources(self):
        """Points, sets, and curves are sums of columns."""
        xyz, tri, _ = bumpy(9)
        heat = hd.Heat(mesh(xyz, tri), method="direct")
        all_ = heat.columns(range(81), "20h2")
        face = tri[40]
        got = heat.columns(hd.Sources([face, face[[1, 2, 0]]], [[0.5, 0.3, 0.2]] * 2, [2, 3], groups=[2]), "20h2")
        want = all_[:, face] @ [2 * 0.5 + 3 * 0.2, 2 * 0.3 + 3 * 0.5, 2 * 0.2 + 3 * 0.3]
        self.assertLess(abs(got[:, 0] - want).max(), 1e-6 * want.max())
        edge = heat.columns(hd.Sources([0, 1], groups=[2], curve=True), "20h2")[:, 0]
        want = all_[:, [0, 1]].sum(axis=1) * np.linalg.norm(xyz[0] - xyz[1]) / 2
        self.assertLess(abs(edge - want).max(), 1e-6 * want.max())
        self.assertEqual(heat.distance(hd.Sources([3, 4, 5], groups=[1, 2]), "20h2").shape, (81, 2))

    def test_lengths(self):
        """Sides alone, of a mesh in space: the same matrices."""
        xyz, tri, _ = bumpy(9)
        sides = np.linalg.norm(xyz[tri[:, [1, 2, 0]]] - xyz[tri], axis=2)
        for kind in ("fem", "voronoi-cot"):
            lap, flat = mesh(xyz, tri, kind=kind), hd.Laplacian.from_lengths(tri, sides, kind=kind)
            self.assertLess(abs(lap.L - flat.L).max(), 1e-12)
            self.assertLess(abs(lap.B - flat.B).max(), 1e-12)

    def test_single_calls(self):
        xyz, tri, quads = bumpy(9)
        lap = mesh(xyz, tri)
        heat, t = hd.Heat(lap), 10 * lap.h ** 2
        for got, want in ((hd.hks(xyz, tri, t="10h2"), heat.diagonal(t)), (hd.hks(xyz, tri, "auto:3"), heat.hks(lap.times("auto:3"))),
                          (hd.diffusion_distance(xyz, tri, 3, "10h2"), heat.distance(3, t)),
                          (hd.diffusion_distance(xyz, tri, 3, kind="biharmonic"), heat.distance(3, kind="biharmonic")),
                          (hd.heat_kernel(xyz, tri, [3, 4], ["10h2"]), heat.columns([3, 4], [t], symmetric=True)),
                          (hd.smooth(xyz, tri, "10h2"), heat.apply(xyz, t)), (hd.smooth(xyz, tri, t, xyz[:, 0]), heat.apply(xyz[:, 0], t)),
                          (hd.hks(xyz, tri.tolist(), t), heat.hks(t)), (hd.hks(xyz.astype(np.float32), np.asfortranarray(tri), t), heat.hks(t)),
                          (hd.hks(xyz, quads, t), hd.Heat(hd.Laplacian.from_polygons(xyz, quads)).hks(t)),
                          (hd.hks(xyz, None, t), hd.Heat(hd.Laplacian.from_points(xyz, triangulation="tufted")).hks(t)),
                          (hd.hks(xyz, tri[:0], t), hd.hks(xyz, t=t))):
            self.assertEqual(got.shape, want.shape)
            self.assertLess(abs(got - want).max(), 2e-5 * abs(want).max())

    def test_what_others_stumble_over(self):
        """Vertices in no face, several components, non-manifold edges, faces that cannot be used."""
        xyz, tri, _ = bumpy(9)
        both = np.concatenate([xyz, xyz + [5, 0, 0], [[0, 0, 9], [0.05, 0, 1]]])
        faces = np.concatenate([tri, tri + 81, [[0, 1, 163], tri[0], [7, 7, 9], [0, 9, 10]]])
        lap = mesh(both, faces)
        found = lap.mesh
        self.assertEqual((lap.n, lap.n_components, found.n_inert, found.n_repeated_face, found.n_repeated_corner), (164, 2, 1, 2, 1))
        self.assertEqual((lap.mass[162], lap.component[162], lap.component[100], len(lap.vertex)), (0, -1, 1, 163))
        self.assertLess(abs(lap.mass.sum() - lap.area), 1e-12)
        fan = mesh(np.concatenate([xyz, [[0.1, 0.1, 1]]]), np.concatenate([tri, [[30, 31, 81]]]))
        self.assertEqual(fan.mesh.n_nonmanifold_edges, 1)
        for heat in (hd.Heat(lap), hd.Heat(fan)):
            self.assertTrue(np.isfinite(heat.hks()).all())
        u = hd.smooth(both, faces, "5h2")
        self.assertTrue(np.array_equal(u[162], both[162]) and abs(u[81:162, 0] - 5).max() < 1)
        self.assertEqual(abs(hd.heat_kernel(both, faces, 0, "5h2")[81:163]).max(), 0)
        d = hd.geodesic_distance(both, faces, 0)
        self.assertTrue(np.isinf(d[81:163]).all() and np.isfinite(d[:81]).all())
        for triangulation in ("delaunay", "tufted"):
            self.assertTrue(np.isfinite(hd.hks(both, faces)).all())
            hd.Heat(mesh(both, faces, triangulation=triangulation)).column(0, "5h2")
        with self.assertRaisesRegex(hd.InputError, "does not exist") as e:
            mesh(xyz, tri + 1)
        self.assertIsInstance(e.exception.face, int)

    def test_diffusion_net(self):
        """Each operator against its definition, in loops: gradients by least squares at each vertex."""
        xyz, tri, _ = bumpy(9)
        eps = 1e-5
        for faces in (tri, None):
            made = hd.diffusion_net(xyz, faces, k=6, neighbours=12)
            lap = hd.laplacian(xyz, faces, **({"kind": "voronoi-cot", "neighbours": 12} if faces is None else {}))
            if faces is not None:
                L, _ = cotangents(xyz, tri)
                area = np.linalg.norm(np.cross(xyz[tri[:, 1]] - xyz[tri[:, 0]], xyz[tri[:, 2]] - xyz[tri[:, 0]]), axis=1) / 2
                mass = np.bincount(tri.ravel(), np.repeat(area / 3, 3))
                near = [sorted(set(tri[(tri == i).any(axis=1)].ravel()) - {i}) for i in range(81)]
            else:
                L, mass = lap.L.toarray(), lap.mass
                near = [[j for j in np.argsort(np.linalg.norm(xyz - p, axis=1), kind="stable") if j != i][:12] for i, p in enumerate(xyz)]
            self.assertLess(abs(made.L.toarray() - L).max(), 1e-12)
            self.assertLess(abs(made.mass - mass).max(), 1e-14)
            self.assertLess(abs(made.evals - scipy.linalg.eigh(L, np.diag(mass))[0][:6]).max(), 1e-8 * made.evals[-1])
            self.assertLess(abs(made.evecs.T @ (mass[:, None] * made.evecs) - np.eye(6)).max(), 1e-9)
            self.assertLess(abs(made.frames @ made.frames.transpose(0, 2, 1) - np.eye(3)).max(), 1e-12)
            f = np.sin(3 * xyz[:, 0]) + xyz[:, 1] ** 2
            for i in range(81):
                edges = (xyz[near[i]] - xyz[i]) @ made.frames[i, :2].T
                A = np.concatenate([edges, np.sqrt(eps) * lap.h * np.eye(2)])
                g = np.linalg.lstsq(A, np.concatenate([f[near[i]] - f[i], [0, 0]]), rcond=None)[0]
                self.assertLess(max(abs((made.gradX @ f)[i] - g[0]), abs((made.gradY @ f)[i] - g[1])), 1e-9)
        plane = xyz * [1, 1, 0]
        made = hd.diffusion_net(plane, tri, k=0)
        f = plane @ [2, 3, 0]
        g = np.einsum("nq,nqc->nc", np.stack([made.gradX @ f, made.gradY @ f], 1), made.frames[:, :2])
        self.assertLess(abs(g - [2, 3, 0]).max(), 1e-4)
        self.assertEqual(made.evecs.shape, (81, 0))

    def test_answers(self):
        """Answers and their parts carry the report; what is computed from them does not."""
        xyz, tri, _ = bumpy(9)
        lap = mesh(xyz, tri)
        heat = hd.Heat(lap)
        u = heat.columns([1, 2], ["3h2", "4h2", 0.1])
        self.assertEqual((u.shape, type(u), type(u + 1), type(np.sin(u)), type(u.max())), ((81, 2, 3), hd.Answer, np.ndarray, np.ndarray, np.float64))
        self.assertIs(u[:, 0].report, u.report)
        self.assertIs(heat.report, u.report)
        self.assertIn("error_bound", str(u.report))
        self.assertTrue(np.array_equal(pickle.loads(pickle.dumps(u)), u))
        estimate = heat.estimate("columns", "10h2", 5)
        self.assertTrue(estimate.fits and estimate.bytes > 0 and set(estimate.costs) == {"direct", "krylov", "iterative", "local"})
        self.assertFalse(hd.Heat(lap, memory_limit=10000).estimate("diagonal", "10h2").fits)

    def test_local(self):
        """Columns on a part of the mesh, dense and sparse; what is cut; what heat does not reach has no value."""
        xyz, tri, _ = bumpy(80)
        lap = mesh(xyz, tri)
        t, v = np.array([2, 1]) * lap.h ** 2, [0, 3210]
        whole, local = hd.Heat(lap, method="krylov").columns(v, t), hd.Heat(lap, method="local")
        u = local.columns(v, t)
        self.assertTrue(u.report.method == "local" and 0 < u.report.n_touched < lap.n / 2)
        self.assertTrue(0 < u.report.error_local < u.report.error_bound < 2e-7 and u.report.evidence_local == "measured")
        self.assertLess(abs(u - whole).max(), 4e-7)
        self.assertEqual(hd.Heat(lap).column(7, "0.2h2").report.method, "local")
        rows = local.columns_sparse(v, t)
        self.assertEqual((type(rows), rows.shape, local.report.method), (scipy.sparse.csr_matrix, (4, lap.n), "local"))
        self.assertTrue(np.array_equal(rows.toarray(), u.transpose(1, 2, 0).reshape(4, -1)) and (rows.data != 0).all() and rows.has_sorted_indices)
        few = hd.Heat(lap, method="local", cut=1e-3).columns_sparse(v, t)
        self.assertTrue(few.nnz < rows.nnz / 2 and abs(few - rows).max() <= 1e-3 * u.max())
        far, d = hd.Heat(lap, method="direct").distance(v, t), local.distance(v, t)
        self.assertEqual((d.report.method, d.report.n_touched < lap.n, d.report.n_patches > 1), ("local",) + 2 * (d.report.n_patches > 1,))
        self.assertLess(abs(d - far).max(), 2e-7 * far.max())
        self.assertEqual((local.columns_sparse([], t).shape, local.columns_sparse(5, t[0], symmetric=True).shape), ((0, lap.n), (1, lap.n)))

    def test_errors(self):
        xyz, tri, _ = bumpy()
        bad = xyz.copy()
        bad[5, 1] = np.nan
        with self.assertRaises(hd.InputError) as e:
            mesh(bad, tri)
        self.assertEqual((e.exception.status, e.exception.vertex, e.exception.face), ("HD_ERR_NOT_FINITE", 5, None))
        self.assertIn("vertex 5", str(e.exception))
        heat = hd.Heat(mesh(xyz, tri))
        with self.assertRaises(hd.Error) as e:
            heat.column(10 ** 6, 1)
        self.assertEqual((e.exception.status, e.exception.vertex), ("HD_ERR_INDEX", 10 ** 6))
        with self.assertRaises(hd.InputError) as e:
            hd.Laplacian.from_matrices(scipy.sparse.csr_matrix([[1.0, -1], [0, 1]]), np.ones(2))
        self.assertEqual((e.exception.status, e.exception.row, e.exception.column), ("HD_ERR_NOT_SYMMETRIC", 0, 1))
        same = pickle.loads(pickle.dumps(e.exception))          # as other processes send it
        self.assertEqual((type(same), str(same), same.row), (hd.InputError, str(e.exception), 0))
        with self.assertRaises(MemoryError) as e:
            hd.Heat(heat.lap, method="direct", memory_limit=1e5).diagonal("5h2")
        self.assertEqual(e.exception.status, "HD_ERR_MEMORY_LIMIT")
        self.assertGreater(e.exception.value, 100000)
        with self.assertRaises(hd.OutOfMemoryError):            # the Laplacian's limit holds for its plans
            hd.Heat(mesh(xyz, tri, memory_limit=400000), method="direct").diagonal("5h2")

    def test_warnings(self):
        """They name the caller's line, and can be made errors."""
        xyz, tri, _ = bumpy(9)
        heat = hd.Heat(mesh(xyz, tri), method="direct", poles="uniform", degree=1)
        with warnings.catch_warnings(record=True) as got:
            warnings.simplefilter("always")
            u = heat.column(0, 0.1)
        self.assertEqual([(w.category, w.filename) for w in got], [(hd.AccuracyWarning, __file__)])
        self.assertIn("errors may be as large as", str(got[0].message))
        self.assertEqual(u.report.status, "HD_WARN_ACCURACY")
        with warnings.catch_warnings(), self.assertRaises(hd.AccuracyWarning):
            warnings.simplefilter("error")
            heat.column(0, 0.1)

    def test_without_scipy(self):
        """L and B are tuples then, from which the same Laplacian is made."""
        xyz, tri, _ = bumpy(9)
        lap = mesh(xyz, tri)
        hidden = {name: sys.modules[name] for name in list(sys.modules) if name.split(".")[0] == "scipy"}
        try:
            sys.modules.update({name: None for name in hidden})
            L, B = lap.L, lap.B
        finally:
            sys.modules.update(hidden)
        self.assertEqual((type(L), L.data.shape), (hd.CSR, L.indices.shape))
        self.assertEqual(abs(hd.Laplacian.from_matrices(L, tuple(B)).L - lap.L).max(), 0)

    def test_progress(self):
        """Stages and numbers come, False cancels, what a progress function raises arrives, and it may not use the plan."""
        xyz, tri, _ = bumpy()
        lap, seen = mesh(xyz, tri), []
        hd.Heat(lap, progress=lambda stage, done: seen.append((stage, done))).diagonal("5h2")
        self.assertTrue({"factor", "invert"} <= {s for s, _ in seen} and all(0 <= d <= 1 for _, d in seen))
        with self.assertRaises(hd.CancelledError):
            hd.Heat(lap, progress=lambda stage, done: False).diagonal("5h2")
        with self.assertRaises(ZeroDivisionError):
            hd.Heat(lap, progress=lambda stage, done: 1 / 0).diagonal("5h2")
        for use in (lambda stage, done: made[0].column(0, 1), lambda stage, done: moving.update(xyz), lambda stage, done: moving.close()):
            made, moving = [], mesh(xyz, tri, updatable=True)
            made.append(hd.Heat(moving, progress=use))
            with self.assertRaisesRegex(RuntimeError, "at work"):
                made[0].diagonal("5h2")
        self.assertRaises(TypeError, mesh, xyz, tri, progress=5)

    def test_bar(self):
        """progress=True: a bar of tqdm for each stage, which ends."""
        xyz, tri, _ = bumpy()
        bars = []

        class Bar:
            def __init__(self, total, desc, **_):
                self.desc, self.n, self.closed = desc, 0.0, False
                bars.append(self)

            def update(self, by):
                self.n += by

            def close(self):
                self.closed = True

        fake = types.ModuleType("tqdm")
        fake.auto = types.ModuleType("tqdm.auto")
        fake.auto.tqdm = Bar
        before = {name: sys.modules.get(name) for name in ("tqdm", "tqdm.auto")}
        try:
            sys.modules.update({"tqdm": fake, "tqdm.auto": fake.auto})
            hd.Heat(mesh(xyz, tri), progress=True).diagonal("5h2")
            sys.modules.update({"tqdm": None})
            with self.assertRaisesRegex(ModuleNotFoundError, "needs tqdm"):
                mesh(xyz, tri, progress=True)
        finally:
            for name, module in before.items():
                sys.modules.pop(name)
                if module:
                    sys.modules[name] = module
        self.assertIn("factor", [b.desc for b in bars])
        self.assertTrue(all(b.closed and 0 <= b.n <= 1 for b in bars) and max(b.n for b in bars) > 0)
        self.assertTrue(all(a.desc != b.desc for a, b in zip(bars, bars[1:])))

    def test_interrupt(self):
        """Ctrl-C ends a long call; the same plan then answers."""
        xyz, tri, _ = bumpy(120)
        heat, before = hd.Heat(mesh(xyz, tri)), signal.getsignal(signal.SIGINT)
        timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            hd.Spectrum(heat.lap, 2000)
        timer.join()
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        self.assertEqual(heat.lap._handle.plans.keys(), {id(heat._handle)})

        def stop(stage, done):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            hd.Heat(heat.lap, progress=stop).diagonal("5h2")
        self.assertTrue(np.isfinite(heat.column(0, "5h2")).all())

    def test_other_threads_run(self):
        """While the library works, Python's other threads do as well."""
        xyz, tri, _ = bumpy(50)
        lap, turns, done = mesh(xyz, tri, threads=1), [], []
        thread = threading.Thread(target=lambda: done.append(hd.Spectrum(lap, 120)))
        thread.start()
        while thread.is_alive():
            turns.append(len(done))
            time.sleep(0.001)
        self.assertGreater(len(turns), 20)

    def test_threads_option(self):
        xyz, tri, _ = bumpy(40)
        lap = mesh(xyz, tri)
        want = hd.Heat(lap, threads=1).diagonal("5h2")
        for threads in (2, 5):
            self.assertTrue(np.array_equal(hd.Heat(lap, threads=threads).diagonal("5h2"), want))

    def test_pages(self):
        """The lines of the gallery and of help(heatdiff) run, and the shapes that they promise are those."""
        with open(os.path.join(TOP, "examples", "README.md"), encoding="utf-8") as f:
            lines = re.search(r"```python\n(.*?)```", f.read(), re.S).group(1).splitlines()
        lines += [line.strip() for line in hd.__doc__.splitlines() if line.startswith("    ")]
        V, F, _ = bumpy(15)
        names, promised = dict(V=V, F=F, fields=V[:, :2]), 0
        sizes = {"n": 225, "k": 2}
        for line in lines:
            exec(line, names)
            said = re.search(r"# \((.*?)\)", line)
            if said and "=" in line:
                shape = tuple(sizes.get(x.strip()) or int(x) for x in said.group(1).split(",") if x.strip())
                self.assertEqual(names[line.split("=")[0].strip()].shape, shape, line)
                promised += 1
        self.assertGreater(promised, 8)

    def test_tour(self):
        """Every cell of tour.py runs, and writes a picture that is not blank."""
        try:
            import matplotlib.image
        except ImportError:
            if os.environ.get("HEATDIFF_NO_SKIP"):
                raise
            self.skipTest("matplotlib is missing")
        pictures = os.path.join(folder.name, "tour")
        subprocess.run([sys.executable, os.path.join(TOP, "examples", "python", "tour.py"), pictures, "4"], check=True,
                       stdout=subprocess.DEVNULL, env={**os.environ, "MPLCONFIGDIR": folder.name})
        self.assertEqual(sorted(os.listdir(pictures)), ["accuracy.png", "distance.png", "kernel.png", "signature.png"])
        for name in os.listdir(pictures):
            image = matplotlib.image.imread(os.path.join(pictures, name))
            self.assertGreater(np.unique(image.reshape(-1, image.shape[-1]), axis=0).shape[0], 30, name)


# The ctypes face against the header, as a compiler reads it: types of fields and of functions are spelled out by both.

SPELL = r"""
#include "heatdiff.h"
#include <cstddef>
#include <cstdio>
#include <string>
#include <type_traits>
using std::string;
template <class T> struct spell {
    static string of() {
        return std::is_floating_point<T>::value ? "f" + std::to_string(8 * sizeof(T))
            : (std::is_enum<T>::value || std::is_signed<T>::value ? "i" : "u") + std::to_string(8 * sizeof(T));
    }
};
template <> struct spell<void> { static string of() { return "void"; } };
template <> struct spell<char> { static string of() { return "char"; } };
template <class T> struct spell<T *> { static string of() { return spell<typename std::remove_const<T>::type>::of() + "*"; } };
template <class T, size_t n> struct spell<T[n]> { static string of() { return spell<T>::of() + "[" + std::to_string(n) + "]"; } };
template <class R, class A, class... B> struct spell<R (*)(A, B...)> {
    static string of() {
        string s = spell<R>::of() + "(" + spell<A>::of(), more[] = { "", "," + spell<B>::of()... };
        for (const string &x : more) s += x;
        return s + ")";
    }
};
"""


def spelled(kind):
    """The same for a type of ctypes."""
    if kind is None:
        return "void"
    if kind in (ctypes.c_char_p, ctypes.c_void_p):
        return "char*" if kind is ctypes.c_char_p else "void*"
    if issubclass(kind, ctypes.Array):
        return f"{spelled(kind._type_)}[{kind._length_}]"
    if issubclass(kind, ctypes._Pointer):
        return spelled(kind._type_) + "*"
    if issubclass(kind, ctypes._CFuncPtr):
        return f"{spelled(kind._restype_)}({','.join(map(spelled, kind._argtypes_))})"
    if issubclass(kind, ctypes.Structure):
        return kind.__name__
    code = kind._type_
    return "char" if code == "c" else f"{'f' if code in 'fd' else 'u' if code.isupper() else 'i'}{8 * ctypes.sizeof(kind)}"


class Bindings(unittest.TestCase):
    def test_made_anew(self):
        """bind.py says of the header what the file has."""
        subprocess.run([sys.executable, os.path.join(TOP, "examples", "python", "bind.py"), "--check"], check=True)

    def test_against_the_compiler(self):
        """Every constant, field and function. One that is wrong by a single argument differs."""
        from heatdiff import _bindings as b
        cxx = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
        if not cxx:
            if os.environ.get("HEATDIFF_NO_SKIP"):
                self.fail("no C++ compiler")
            self.skipTest("no C++ compiler")
        structs = {name: x for name, x in vars(b).items() if isinstance(x, type) and issubclass(x, ctypes.Structure) and x is not ctypes.Structure}
        mine, lines = {}, []
        for name, x in structs.items():
            fields = getattr(x, "_fields_", ())
            if fields:
                mine[name] = str(ctypes.sizeof(x))
                lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
            for key, kind in fields:
                mine[f"{name}.{key}"] = f"{getattr(x, key).offset} {spelled(kind)}"
                lines.append(f'printf("{name}.{key} %zu %s\\n", offsetof({name}, {key}), spell<decltype({name}::{key})>::of().c_str());')
        for name, (result, *arguments) in b.FUNCTIONS.items():
            mine[name] = f"{spelled(result)}({','.join(map(spelled, arguments))})"
            lines.append(f'printf("{name} %s\\n", spell<decltype(&{name})>::of().c_str());')
        for kind, words in b.CHOICES.items():
            constants = self.constants(kind)
            self.assertEqual(len(constants), len(words))
            for constant, (word, number) in zip(constants, words.items()):
                self.assertTrue(constant.endswith("_" + word.upper().replace("-", "_")), (constant, word))
                mine[constant] = str(number)
                lines.append(f'printf("{constant} %d\\n", (int){constant});')
        for number, (name, _) in b.STATUS.items():
            mine[name] = str(number)
            lines.append(f'printf("{name} %d\\n", (int){name});')
        source = os.path.join(folder.name, "spell.cpp")
        with open(source, "w", encoding="utf-8") as f:
            f.write(SPELL + "".join(f'template <> struct spell<{n}> {{ static string of() {{ return "{n}"; }} }};\n' for n in structs
                                    if hasattr(structs[n], "_fields_"))
                    + "".join(f'template <> struct spell<struct {n}> {{ static string of() {{ return "{n}"; }} }};\n' for n in structs
                              if not hasattr(structs[n], "_fields_"))
                    + "int main() {\n" + "\n".join(lines) + "\n}\n")
        program = os.path.join(folder.name, "spell")
        subprocess.run([cxx, "-std=c++11", "-w", "-I", TOP, source, "-o", program], check=True)
        out = subprocess.run([program], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
        theirs = dict(line.split(" ", 1) for line in out.splitlines())
        self.assertEqual(mine, theirs)
        with open(os.path.join(TOP, "heatdiff.h"), encoding="utf-8") as f:
            declared = re.findall(r"^HEATDIFF_API.*?\b(hd_\w+)\(", f.read(), re.M)
        self.assertEqual(set(declared), set(b.FUNCTIONS))
        for name, types in b.FUNCTIONS.items():                 # planted: each argument once of another type
            for at in range(1, len(types)):
                for other in (ctypes.c_int32, ctypes.c_double, ctypes.POINTER(ctypes.c_float)):
                    wrong = [*types[:at], other, *types[at + 1:]]
                    text = f"{spelled(wrong[0])}({','.join(map(spelled, wrong[1:]))})"
                    self.assertEqual(text == theirs[name], spelled(other) == spelled(types[at]), (name, at))

    @staticmethod
    def constants(kind):
        """Those of an enumeration of the header."""
        with open(os.path.join(TOP, "heatdiff.h"), encoding="utf-8") as f:
            text = re.sub(r"/\*.*?\*/", "", f.read().split("#ifdef HEATDIFF_IMPLEMENTATION")[0], flags=re.S)
        return re.findall(r"\bHD_\w+", re.search(r"enum %s\s*\{(.*?)\}" % kind, text, re.S).group(1))


class Package(unittest.TestCase):
    def test_wheel(self):
        """A source archive has the header. The wheel made of it is for every Python on this platform, and works from its
        own folder. Here the implementation is left out, and comes from the library that is compiled already."""
        if not all(importlib.util.find_spec(name) for name in ("pip", "setuptools", "wheel")):
            if os.environ.get("HEATDIFF_NO_SKIP"):
                self.fail("pip, setuptools or wheel is missing")
            self.skipTest("pip, setuptools or wheel is missing")
        work, library = os.path.join(folder.name, "package"), os.path.abspath(os.environ["HEATDIFF_LIBRARY"])
        there = os.path.join(work, "examples", "python")
        shutil.copytree(os.path.join(TOP, "examples", "python"), there, ignore=shutil.ignore_patterns("build", "*.egg-info", "*.so"))
        for name in ("heatdiff.h", "LICENSE"):
            shutil.copyfile(os.path.join(TOP, name), os.path.join(work, name))
        run = lambda *command, **more: subprocess.run([sys.executable, *command], check=True, stdout=subprocess.DEVNULL,
                                                      stderr=subprocess.DEVNULL, **more)
        run("setup.py", "-q", "sdist", "-d", work, cwd=there)
        archive = os.path.join(work, f"heatdiff-{hd.__version__}.tar.gz")
        with tarfile.open(archive) as tar:
            names = [n.split("/", 1)[-1] for n in tar.getnames()]
        for name in ("heatdiff.h", "heatdiff.c", "LICENSE", "pyproject.toml", "src/heatdiff/_bindings.py", "src/heatdiff/py.typed"):
            self.assertIn(name, names)
        run("-m", "pip", "wheel", "--no-build-isolation", "--no-deps", "--no-index", "-w", work, archive,
            env={**os.environ, "PYTHONPATH": "", "CFLAGS": "-DHEATDIFF_IMPLEMENTED -DHDI_KERNELS_READ",
                 "LDFLAGS": f"-Wl,--no-as-needed {library} -Wl,-rpath,{os.path.dirname(library)}"})
        (made,) = [n for n in os.listdir(work) if n.endswith(".whl")]
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        self.assertEqual(made, f"heatdiff-{hd.__version__}-py3-none-{platform}.whl")
        target = os.path.join(work, "target")
        with zipfile.ZipFile(os.path.join(work, made)) as z:
            z.extractall(target)
            self.assertTrue({"heatdiff/libheatdiff.so", "heatdiff/_bindings.py", "heatdiff/py.typed"} <= set(z.namelist()))
            tags = z.read(f"heatdiff-{hd.__version__}.dist-info/WHEEL").decode()
        self.assertIn("Root-Is-Purelib: false", tags)
        self.assertIn(f"Tag: py3-none-{platform}", tags)
        environment = {k: v for k, v in os.environ.items() if k != "HEATDIFF_LIBRARY"}
        code = ("import heatdiff as hd, numpy as np; lap = hd.Laplacian.from_mesh(np.eye(3), [[0, 1, 2]])\n"
                "print(hd.__file__, hd.Heat(lap).hks('2h2').report.method)")
        out = subprocess.run([sys.executable, "-c", code], env={**environment, "PYTHONPATH": target}, check=True, cwd=work,
                             stdout=subprocess.PIPE, universal_newlines=True).stdout
        self.assertTrue(out.startswith(target) and out.endswith(" direct\n"), out)
        missing = subprocess.run([sys.executable, "-c", "import heatdiff"], env={**environment, "PYTHONPATH": os.path.join(there, "src")},
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertIn("install it with pip, or name a shared library in HEATDIFF_LIBRARY", missing.stdout)


# Wrong arguments. On this sheet of 25 vertices all numbers are floats of 32 bits, so that they survive every disguise.

def small():
    xyz, tri, squares = bumpy(5)
    xyz = np.round(xyz * 1024) / 1024
    lap = mesh(xyz, tri)
    sides = np.linalg.norm(xyz[tri[:, [1, 2, 0]]] - xyz[tri], axis=2)
    return {"np": np, "sparse": scipy.sparse, "hd": hd, "Lap": hd.Laplacian, "mesh": mesh, "xyz": xyz, "tri": tri, "squares": squares,
            "n": 25, "lap": lap, "L": lap.L, "B": lap.B, "heat": hd.Heat(lap), "f": xyz[:, :2].copy(),
            "g": np.arange(100.0).reshape(25, 2, 2) / 64, "t": np.array([1, 2]) / 32, "moving": mesh(xyz, tri, updatable=True),
            "geo": hd.Geodesic(xyz, tri), "spectrum": hd.Spectrum(lap, 4), "sides": sides}


# By their error: calls, and parts of its text.
WRONG = {
    ValueError: [
        ("heat.apply(f[:3, 0], t)", "f has shape (3,), wanted is (25,) or (25, k)"),
        ("heat.apply(f[:24], t)", "f has shape (24, 2)"), ("heat.apply(f.T, t)", "f has shape (2, 25)"),
        ("heat.apply(f[None], t)", "f has shape (1, 25, 2)"), ("heat.apply(1.0, t)", "f has shape ()"),
        ("heat.apply(f * np.nan, t)", "field is not finite (row 0, column 0)"),
        ("heat.apply(np.full(n, np.longdouble('1e4000')), t)", "field is not finite"),
        ("heat.apply(f, [])", "t has shape (0,), wanted is at least one time"),
        ("heat.apply(f, [[1, 2]])", "t has shape (1, 2), wanted is () or (n_times,)"),
        ("heat.apply(f, -1)", "t is negative or not finite"),
        ("heat.apply(f, [0.1, np.nan])", "t is negative or not finite: nan at 1"),
        ("heat.apply(f, '10h')", "t is '10h', wanted is a number, or a text such as '10h2', '0.1/l1' or 'auto:16'"),
        ("heat.apply(f, 'auto:x')", "t is 'auto:x'"), ("heat.apply(f, 'auto:0')", "t is 0, wanted is an integer from 1"),
        ("heat.apply(f, ['1h2', 'auto:3'])", "t[1] is 'auto:3'"), ("heat.apply(f, '-1h2')", "t is negative"),
        ("hd.Heat(mesh(xyz, tri, kind='cot')).apply(f, '1h2')", "with kind 'cot' t is not a squared length"),
        ("hd.Heat(Lap.from_matrices(L, B)).apply(f, '1h2')", "this Laplacian has no h"),
        ("heat.derivative(f[:3], t)", "f has shape (3, 2)"), ("heat.adjoint(f[:3], t)", "g has shape (3, 2)"),
        ("heat.vjp(f[:3], t, g)", "g has shape (25, 2, 2), wanted is (3, 2, 2)"),
        ("heat.vjp(f[:3], t, g[:3])", "f has shape (3, 2)"), ("heat.vjp(f, t, g[..., 0])", "g has shape (25, 2), wanted is (25, 2, 2)"),
        ("heat.vjp(f, t, g[:, 0])", "g has shape (25, 2)"), ("heat.vjp(f, t, g[:3])", "g has shape (3, 2, 2)"),
        ("heat.columns(25, t)", "not in the mesh (vertex 25, row 0, column 0)"),
        ("heat.columns([0, -1], t)", "not in the mesh (row 0, column 1)"),
        ("heat.columns([2 ** 32], t)", "sources is 4294967296, wanted is an integer from -2147483648 to 2147483647"),
        ("heat.columns(np.uint64(2 ** 63), t)", "sources is 9223372036854775808"), ("heat.column(2 ** 40, t)", "source is 1099511627776"),
        ("heat.columns([[0, 1]], t)", "sources has shape (1, 2), wanted is () or (any,)"), ("heat.diagonal(0)", "not positive"),
        ("heat.columns(hd.Sources([0, 1], groups=[3]), t)", "groups are [3], wanted are positive numbers of sum 2"),
        ("heat.columns(hd.Sources([0, 1], groups=[2, 0]), t)", "wanted are positive numbers of sum 2"),
        ("heat.columns(hd.Sources([[0, 1]], [[0.5, 0.6]]), t)", "sum"), ("hd.Sources([[0, 1]], [[1]])", "bary has shape (1, 1), wanted is (1, 2)"),
        ("hd.Sources([0, 1], weights=[1])", "weights has shape (1,), wanted is (2,)"), ("hd.Sources(3)", "vertices has shape ()"),
        ("heat.diagonal([])", "at least one time"), ("heat.trace([])", "at least one time"),
        ("heat.hks(np.inf, normalise=True)", "t is negative or not finite: inf"), ("heat.hks(1, normalise=2)", "normalise is 2"),
        ("heat.scale_invariant(1, 2, 2 ** 32 + 9)", "n_times is 4294967305"),
        ("heat.scale_invariant(1, 2, 9, 6)", "n_freq is 6, wanted is an integer from 1 to 5"),
        ("heat.scale_invariant(1, 2, 9, -1)", "n_freq is -1"), ("heat.scale_invariant([1, 1], 2)", "t0 has shape (2,), wanted is ()"),
        ("heat.scale_invariant(1, np.nan)", "t1 is negative or not finite"), ("heat.scale_invariant(2, 1)", "0 < t0 < t1"), ("heat.wks(0)", "energies is 0"), ("heat.wks([])", "energies are empty"),
        ("heat.wks([np.inf])", "energies are empty or not finite"), ("heat.wks(3, sigma=-1)", "b is not positive"),
        ("hd.Heat(lap, method='local').distance(0, kind='commute')", "need the direct method"),
        ("hd.Heat(lap, cut=1)", "cut is not in"), ("heat.columns_sparse(25, t)", "not in the mesh"),
        ("hd.Heat(lap, method='krylov').wks(3)", "krylov"), ("hd.Heat(lap, method='iterative').diagonal(1)", "need the direct method"),
        ("heat.distance(0, [], 'commute')", "at least one time"), ("heat.distance(0, [1, 2], 'commute')", "time"),
        ("heat.distance(0, t, 'comute')", "kind is 'comute': did you mean commute? There are classical, weighted, commute, biharmonic"),
        ("heat.distance(0, t, 'direct')", "kind is 'direct'"), ("heat.distance(25, t)", "not in the mesh"),
        ("heat.entries([0, 1], [2, 3, 4], t)", "j has shape (3,), wanted is (2,)"),
        ("heat.entries([0], [25], t)", "not in the mesh"), ("heat.entries(0, 1, [])", "at least one time"),
        ("heat.pairs([0], [[1]], t)", "j has shape (1, 1)"), ("heat.pairs([-1], [0], t)", "not in the mesh"),
        ("heat.pairs(0, 1, [], 'commute')", "at least one time"),
        ("heat.sample(0, 0.1, [0, 1, 2, 3])", "count is 0, wanted is an integer from 1 to 25"),
        ("heat.sample(3, 0.1, [2 ** 32])", "given is 4294967296"), ("heat.sample(3, 0.1, [25])", "not in the mesh"),
        ("heat.sample(2 ** 32 + 3, 0.1)", "count is 4294967299"), ("heat.sample(-1, 0.1)", "count is -1"),
        ("heat.sample(3, t)", "t has shape (2,), wanted is ()"), ("heat.estimate('column', t)", "did you mean columns?"),
        ("heat.estimate('columns', t, 0)", "k is 0"), ("heat.estimate('columns')", ""),
        ("mesh(xyz.ravel(), tri)", "vertices has shape (75,), wanted is (n, 3)"), ("mesh(xyz[:, :2], tri)", "vertices has shape (25, 2)"),
        ("mesh(xyz, tri[:, :2])", "faces has shape (32, 2), wanted is (m, 3)"), ("mesh(xyz, tri.ravel())", "faces has shape (96,)"),
        ("mesh(xyz, squares)", "faces has shape (16, 4), wanted is (m, 3): from_polygons takes faces with more corners"),
        ("mesh(xyz, tri + 2 ** 32)", "faces is 4294967296"), ("mesh(xyz, tri - 1)", "does not exist"),
        ("mesh(xyz, tri + 1)", "does not exist"), ("mesh(xyz * np.inf, tri)", "coordinate is not finite (vertex 0)"),
        ("mesh(xyz[:0], tri)", ""), ("mesh(xyz, tri[:0])", "faces is empty: from_points takes points without faces"),
        ("mesh(xyz, None)", "faces is empty: from_points takes points without faces"), ("mesh(xyz, [])", "faces is empty"),
        ("mesh(xyz, tri, kind='fm')", "kind is 'fm': did you mean fem? There are fem, voronoi-cot, cot"),
        ("mesh(xyz, tri, kind='polygon')", "kind is 'polygon'"), ("mesh(xyz, tri, triangulation='delauney')", "did you mean delaunay?"),
        ("mesh(xyz, tri, threads=-1)", "threads is -1, wanted is an integer from 0 to 1024"),
        ("mesh(xyz, tri, memory_limit=-1)", "memory_limit is -1"), ("mesh(xyz, tri, memory_limit=1e30)", "memory_limit is 1000"), ("mesh(xyz, tri, updatable=2)", "updatable is 2"),
        ("Lap.from_polygons(xyz, squares.ravel())", "faces[0] has shape ()"),
        ("Lap.from_polygons(xyz, squares[None])", "faces[0] has shape (16, 4)"),
        ("Lap.from_polygons(xyz, squares + 2 ** 32)", "faces is 4294967296"), ("Lap.from_polygons(xyz, squares + 1)", "does not exist"),
        ("Lap.from_polygons(xyz, [])", "no vertex"), ("Lap.from_polygons(xyz[:, 0], squares)", "vertices has shape (25,)"),
        ("Lap.from_points(xyz.T)", "points has shape (3, 25)"), ("Lap.from_points(xyz, kind='polygon')", "kind is 'polygon'"),
        ("Lap.from_points(xyz, triangulation='delaunay')", "triangulation is 'delaunay'"),
        ("Lap.from_points(xyz, neighbours=3)", "neighbours"), ("Lap.from_points(xyz, bandwidth2=np.nan)", "bandwidth2"),
        ("Lap.from_points(xyz, neighbours=2 ** 40)", "neighbours is 1099511627776"),
        ("Lap.from_lengths(tri, sides[:3])", "lengths has shape (3, 3), wanted is (32, 3)"),
        ("Lap.from_lengths(tri, sides * 0 - 1)", "length"), ("Lap.from_lengths(tri, sides, 24)", "does not exist"),
        ("Lap.from_lengths(tri, sides * np.arange(1, 33)[:, None])", ""),
        ("Lap.from_matrices(L[:, :24], B)", "L has shape (25, 24), wanted is a square matrix"),
        ("Lap.from_matrices(L, B[:24, :24])", "B has 24 rows, wanted are 25 as of L"),
        ("Lap.from_matrices(L, np.ones(24))", "B has 24 rows"), ("Lap.from_matrices(L, -np.ones(25))", "B"),
        ("Lap.from_matrices(L, B * np.nan)", "B has an entry that is not finite"), ("Lap.from_matrices(torn(L), B)", ""),
        ("Lap.from_matrices((L.data, L.indices, L.indptr[:-1]), B)", "L.indptr does not ascend from 0 to the number of entries"),
        ("Lap.from_matrices((L.data, L.indices[1:], L.indptr), B)", "L.indices has shape"),
        ("Lap.from_matrices(sparse.triu(L), B)", "not symmetric"), ("Lap.from_matrices(-L, B)", "minus the cotangent matrix of libigl"),
        ("Lap.from_matrices(L, B, -1)", "h is negative"), ("Lap.from_matrices(L, B, np.nan)", "h is negative or not finite"),
        ("hd.Geodesic(xyz[:, :2], tri)", "vertices has shape (25, 2)"), ("hd.Geodesic(xyz, tri[:, 0])", "faces[0] has shape ()"),
        ("hd.Geodesic(xyz, tri + 1)", "does not exist"), ("geo.distance([])", "sources are none, wanted is at least one vertex"),
        ("geo.distance(25)", "not in the mesh"), ("geo.distance([[1]])", "sources has shape (1, 1)"), ("geo.distance(1, each=2)", "each is 2"),
        ("hd.Geodesic(xyz, tri, t=-1)", "t is -1.0, wanted is a number above 0"), ("hd.Geodesic(xyz, tri, t='h2')", "t is 'h2', wanted"),
        ("hd.Geodesic(xyz, tri, t='1h')", "t is '1h', wanted"), ("hd.Geodesic(xyz, tri, mass='natural')", "mass is 'natural'"),
        ("hd.Geodesic(xyz, tri, border='neumann')", "There are natural, mean, dirichlet"),
        ("lap.times('auto:4294967297')", "t is 4294967297"), ("lap.times([[1]])", "t has shape (1, 1)"),
        ("moving.update(xyz[:24])", "vertices has shape (24, 3), wanted is (25, 3)"), ("moving.update(xyz * np.nan)", "not finite"),
        ("lap.update(xyz)", "updatable"), ("lap.update_matrices(L, B)", "updatable"),
        ("lap.update_matrices(L[:24, :24], B[:24, :24])", "L has 24 rows, wanted are 25"), ("geo.update(xyz)", "updatable"),
        ("hd.Heat(lap, method='direkt')", "method is 'direkt': did you mean direct? There are auto, iterative, direct, krylov, local"),
        ("hd.Heat(lap, method='kernel')", "method is 'kernel'"), ("hd.Heat(lap, poles='own')", "poles is 'own'"),
        ("hd.Heat(lap, solver='cg')", "solver is 'cg'"), ("hd.Heat(lap, precond='ilu')", "precond is 'ilu'"),
        ("hd.Heat(lap, degree=2 ** 32 + 9)", "degree is 4294967305"), ("hd.Heat(lap, degree=99, method='direct').column(0, 1)", "degree"),
        ("hd.Heat(lap, tol=[1e-9, 1e-8])", "tol has shape (2,)"), ("hd.Heat(lap, tol=np.nan)", "tol"),
        ("hd.Heat(lap, ordering='own')", "perm"), ("hd.Heat(lap, ordering='amd')", "ordering is 'amd'"),
        ("hd.Heat(lap, ordering='own', perm=np.arange(24))", "perm has shape (24,), wanted is (25,)"),
        ("hd.Heat(lap, ordering='own', perm=np.zeros(n, int)).diagonal(t)", "permutation"),
        ("mesh(xyz, tri, held=[25])", "not in the mesh"), ("mesh(xyz, tri, held=[-1])", "not in the mesh"),
        ("mesh(xyz, tri, border='neumann')", "border is 'neumann': There are natural, dirichlet"),
        ("hd.Spectrum(lap, 0)", "count is 0"), ("hd.Spectrum(lap, 26)", "more"), ("hd.Spectrum(lap)", ""),
        ("spectrum.columns(25, t)", "not in the mesh"), ("spectrum.diagonal([])", "at least one time"),
        ("hd.hks(xyz, tri, t='auto')", "t is 'auto'"), ("hd.smooth(xyz, tri, 1, f[:3])", "f has shape (3, 2)"),
        ("hd.hks(xyz.T, tri)", "vertices has shape (3, 25)"), ("hd.hks(xyz, tri[None])", "faces[0] has shape (32, 3)"),
        ("hd.diffusion_net(xyz, squares)", "faces has shape (16, 4), wanted is (m, 3)"), ("hd.diffusion_net(xyz, tri, k=26)", ""),
        ("hd.diffusion_net(xyz, tri, normals=xyz[:3])", "normals has shape (3, 3), wanted is (25, 3)"),
        ("hd.diffusion_net(xyz, neighbours=30)", "neighbours is 30, wanted is an integer from 3 to 24"),
        ("hd.neighbourhoods(xyz, 0)", "k is 0"), ("hd.neighbourhoods(xyz * np.nan, 3)", "not finite")],
    TypeError: [
        ("heat.apply(f + 0j, t)", "f has dtype complex128 and shape (25, 2), wanted are numbers"),
        ("heat.apply(f.astype(str), t)", "f has dtype <U"), ("heat.apply(f.astype(object), t)", "f has dtype object"),
        ("heat.apply(L, t)", "f has dtype object"), ("heat.apply(np.ma.masked_less(f, 0.1), t)", "f is a masked array"),
        ("heat.apply(f, None)", "t has dtype object"), ("heat.apply(f, True)", "t has dtype bool"), ("heat.apply(f, 1j)", "t has dtype complex128"),
        ("heat.apply(f)", "missing 1 required positional argument: 't'"),
        ("heat.columns(1.5, t)", "sources has dtype float64 and shape (), wanted are integers"),
        ("heat.column(1.5, t)", "source is 1.5, wanted is an integer"), ("heat.column([1], t)", "source is [1], wanted is an integer"),
        ("heat.columns([2 ** 70], t)", "sources has dtype object"), ("heat.columns(np.arange(n) == 3, t)", "sources has dtype bool"),
        ("heat.columns(0, t, [3, 4])", "symmetric is [3, 4]"), ("heat.columns(0, t, 'yes')", "symmetric is 'yes'"),
        ("heat.scale_invariant(1, 2, 9.5)", "n_times is 9.5, wanted is an integer"), ("heat.wks(2.5)", "energies is 2.5"),
        ("heat.distance(0)", "t is missing: distances of kind 'classical' have a time"), ("heat.distance(0, t, None)", "kind is None"),
        ("heat.distance(0, t, 2)", "kind is 2, wanted is one of classical, weighted, commute, biharmonic"),
        ("heat.entries([0.5], [1], t)", "i has dtype float64"), ("heat.pairs(0, 1)", "t is missing"),
        ("heat.sample(3, 0.1, [1.5])", "given has dtype float64"), ("heat.sample(2.5, 0.1)", "count is 2.5"),
        ("mesh(xyz, tri + 0.5)", "faces has dtype float64"), ("mesh(xyz + 1j, tri)", "vertices has dtype complex128"),
        ("mesh(xyz, 'abc')", "faces has dtype"), ("mesh('abc', tri)", "vertices has dtype"),
        ("Lap.from_polygons(xyz, squares.astype(float))", "faces[0] has dtype float64"),
        ("Lap.from_polygons(xyz, [[0, 1, 6], [0, 1, 6.5]])", "faces[1] has dtype float64"),
        ("Lap.from_polygons(xyz, 5)", "faces are no lists of vertices"),
        ("Lap.from_matrices(L.toarray(), B)", "L is a ndarray of shape (25, 25), wanted is a matrix of scipy.sparse or a tuple"),
        ("Lap.from_matrices(None, B)", "L is a NoneType"), ("Lap.from_matrices((L.data, L.indices), B)", "L is a tuple"),
        ("Lap.from_matrices((L.data, L.indices + 0.5, L.indptr), B)", "L.indices has dtype float64"),
        ("Lap.from_matrices(L * 1j, B)", "L.data has dtype complex128"), ("Lap.from_matrices(L, B.astype(bool))", "B.data has dtype bool"),
        ("Lap.from_matrices(L, B, 'a')", "h has dtype <U1"), ("hd.Geodesic(xyz, tri.astype(float))", "faces has dtype float64"),
        ("geo.distance(1.5)", "sources has dtype float64"), ("lap.times(None)", "t has dtype object"),
        ("hd.Heat(5)", "lap is a int, wanted is a Laplacian"), ("hd.Heat(heat)", "lap is a Heat"), ("hd.Spectrum(None, 3)", "lap is a NoneType"),
        ("hd.Heat(None)", "lap is a NoneType"), ("hd.Laplacian(xyz, tri)", "a Laplacian comes from from_mesh"), ("hd.Laplacian(vertices=xyz)", "comes from from_mesh"), ("hd.Heat(xyz, tri)", "Heat takes lap by place and all else by name, given are 2 values"), ("mesh(xyz, tri, 'fem')", "from_mesh takes vertices, faces by place and all else by name, given are 3 values"), ("hd.Laplacian()", "comes from from_mesh"),
        ("hd.Heat(lap, metod='direct')", "Heat has no option metod: did you mean method? There are lap, method"),
        ("hd.Heat(lap, context=5)", "Heat has no option context"), ("hd.Heat(lap, begin_zero=1)", "no option begin_zero"),
        ("hd.Heat(lap, held=[1])", "no option held"), ("hd.Heat(lap, 'direct')", "all else by name"),
        ("hd.Heat(lap, method=2)", "method is 2, wanted is one of auto, iterative"), ("hd.Heat(lap, degree=9.5)", "degree is 9.5"),
        ("hd.Heat(lap, degree='9')", "degree is '9'"), ("hd.Heat(lap, tol='small')", "tol has dtype <U5"),
        ("hd.Heat(lap, tol=1j)", "tol has dtype complex128"), ("hd.Heat(lap, progress=5)", "progress is 5, wanted is True, False or a function"),
        ("mesh(xyz, tri, held=[1.5])", "held has dtype float64"), ("mesh(xyz, tri, held=np.arange(n) == 3)", "held has dtype bool"),
        ("mesh(xyz, tri, n_held=3)", "from_mesh has no option n_held: did you mean held?"), ("mesh(xyz, tri, threads=1.5)", "threads is 1.5"),
        ("Lap.from_polygons(xyz, squares, stiffness=1)", "no option stiffness: did you mean stiffening?"),
        ("hd.hks(xyz, tri, times=1)", "hks has no option times"), ("hd.laplacian(xyz, tri, knd='fem')", "from_mesh has no option knd: did you mean kind?"),
        ("hd.Geodesic(xyz, tri, time=1)", "Geodesic has no option time"), ("hd.Sources([1], weight=[1])", "Sources has no option weight: did you mean weights?"),
        ("copy.copy(lap)", "a Laplacian cannot be copied or pickled"), ("copy.deepcopy(heat)", "a Heat cannot be copied or pickled"),
        ("pickle.dumps(geo)", "a Geodesic cannot be copied or pickled")],
    (ValueError, TypeError): [
        ("heat.apply([[1, 2], [3]], t)", "f "), ("Lap.from_points(xyz.tolist()[:4] + [[1, 2]])", "points "),
        ("mesh(xyz, [[0, 1, 2], [3, 4]])", "faces ")],
}


def torn(a):
    """A matrix whose first row is said to reach far beyond its arrays."""
    a = a.copy()
    a.indptr[1:] += 10 ** 6
    return a


def misuses():
    """Calls of WRONG that did not end as they should: each with what it did instead."""
    names = dict(small(), copy=copy, pickle=pickle, torn=torn)
    want = names["heat"].apply(names["f"], names["t"])
    for call, kind, text in ((call, kind, text) for kind in WRONG for call, text in WRONG[kind]):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")                 # of NumPy about values that it cannot convert
                eval(call, names)
        except Exception as error:
            if not isinstance(error, kind) or text not in str(error):
                yield call, repr(error)
        else:
            yield call, "not refused"
    if not np.array_equal(names["heat"].apply(names["f"], names["t"]), want):
        yield "the plan", "answers otherwise now"


class Arguments(unittest.TestCase):
    def test_wrong(self):
        self.assertGreater(sum(map(len, WRONG.values())), 200)
        self.assertEqual(list(misuses()), [])

    def test_right(self):
        """What looks unusual and is not wrong."""
        names = small()
        n, xyz, tri, lap, heat, f, t = (names[x] for x in ("n", "xyz", "tri", "lap", "heat", "f", "t"))
        self.assertEqual(heat.apply(np.zeros((n, 0)), t).shape, (n, 0, 2))
        self.assertEqual(heat.columns([], t).shape, (n, 0, 2))
        self.assertEqual(heat.entries([], [], t).shape, (0, 2))
        self.assertEqual((heat.entries(0, 1, 1).shape, heat.pairs(0, 1, t).shape, heat.pairs([0], 1, 1).shape), ((), (2,), (1,)))
        mask = np.arange(n) == 3
        self.assertLess(abs(heat.apply(mask, t[0]) - heat.column(3, t[0])).max(), 1e-7)
        self.assertTrue(np.array_equal(heat.entries(3, range(n), t), heat.entries(np.full(n, 3), np.arange(n), t)))
        self.assertTrue(np.array_equal(heat.columns(3, t, np.bool_(True)), heat.columns(3, t, 1)))
        self.assertTrue(np.array_equal(heat.column(3, " 0.5 "), heat.column(3, 0.5)))
        self.assertEqual(lap.times("10 h2"), lap.times("10h2"))
        self.assertEqual(heat.sample(2, kind="commute")[0].shape, (2,))
        self.assertEqual(hd.Laplacian.from_polygons(xyz, [[]] + tri.tolist()).mesh.n_zero_area, 1)
        self.assertEqual(mesh(xyz, tri, held=3, updatable=np.bool_(True), kind="Voronoi_Cot").n_held, 1)
        own = hd.Heat(lap, ordering="own", perm=np.arange(n)[::-1], method="direct", tol=np.float32(1e-9))
        self.assertLess(abs(own.apply(f, t) - heat.apply(f, t)).max(), 1e-7)
        twice = scipy.sparse.coo_matrix((np.repeat(lap.L.tocoo().data / 2, 2), [np.repeat(x, 2) for x in lap.L.nonzero()]))
        self.assertLess(abs(hd.Laplacian.from_matrices(twice, lap.B).L - lap.L).max(), 1e-15)
        self.assertIn("method", str(inspect.signature(hd.Heat)))

    def test_closed(self):
        """Whatever is closed raises; a Laplacian takes its plans with it."""
        names = small()
        lap, heat, geo = names["lap"], names["heat"], names["geo"]
        other = hd.Heat(lap)
        with self.assertRaises(AttributeError):
            lap.n = 10 ** 6
        other.close()
        other.close()
        with self.assertRaisesRegex(ValueError, "closed"):
            other.columns(0, 1)
        with lap:
            heat.columns(0, 1)
        geo.close()
        for use in ("lap.h", "lap.mesh", "lap.L", "lap.B", "lap.mass", "lap.vertex", "lap.times('auto:3')", "lap.times('1/l1')",
                    "lap.update(xyz)", "hd.Heat(lap)", "heat.apply(f, t)", "heat.columns(0, t)", "heat.diagonal(t)",
                    "heat.trace(t)", "heat.entries(0, 1, t)", "heat.sample(2, 1)", "geo.distance(0)", "hd.Spectrum(lap, 3)",
                    "spectrum.diagonal(t)", "heat.wks(3)", "heat.estimate('columns', t)"):
            with self.subTest(use), self.assertRaisesRegex(ValueError, "closed"):
                eval(use, names)
        lap.close()
        self.assertEqual(len(names["spectrum"].values), 4)      # a copy that stays
        del lap, heat, geo, other, names

    def test_threads(self):
        """Threads that share a plan, its Laplacian and other plans of it get the right numbers."""
        names = small()
        lap, heat, t = names["lap"], names["heat"], names["t"]
        want, right = heat.columns(range(25), t), []

        def work(k):
            for s in range(k, k + 15):
                plan = heat if s % 3 else hd.Heat(lap)
                right.append(abs(plan.column(s % 25, t) - want[:, s % 25]).max() < 1e-7)

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
            done = subprocess.run([sys.executable, os.path.abspath(__file__), "--throw", "500", seed], env=environment,
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
    heat, lap, moving, geo, pairs, Lap = (names[x] for x in ("heat", "lap", "moving", "geo", "spectrum", "Lap"))
    ids, others, t1 = np.array([3, 17, 3]), np.array([0, 24, 9]), t[0]
    made = lambda lap: (lap.L.data, lap.B.data, lap.mass, lap.vertex)
    heated = lambda **options: hd.Heat(lap, **options).columns(5, t)
    return [
        (lambda x, y: made(mesh(x, y)), ("all", xyz), ("some", tri)),
        (lambda x: made(mesh(xyz, tri, held=x)), ("any", ids)),
        (lambda x, y: made(Lap.from_polygons(x, y)), ("all", xyz), ("faces", names["squares"])),
        (lambda x: made(Lap.from_points(x, neighbours=8)), ("any", xyz)),
        (lambda x: made(Lap.from_lengths(tri, x)), ("same", np.float32(names["sides"] * 0 + 1).astype(float))),
        (lambda x, y: made(Lap.from_matrices(x, y)), ("sparse", names["L"]), ("sparse", names["B"])),
        (lambda x: (moving.update(x), made(moving))[1], ("same", xyz)),
        (lambda x: lap.times(x), ("some", t)),
        (lambda x, s: heat.apply(x, s), ("field", f), ("some", t)),
        (lambda x, s: heat.derivative(x, s), ("field", f), ("some", t)),
        (lambda x, s: heat.adjoint(x, s), ("field", f), ("some", t)),
        (lambda x, s, y: heat.vjp(x, s, y), ("field", f), ("same", t), ("same", g)),
        (lambda i, s: heat.columns(i, s), ("any", ids), ("some", t)),
        (lambda s: heat.diagonal(s), ("some", t)),
        (lambda s: heat.trace(s), ("some", t)),
        (lambda s: heat.hks(s, normalise=True), ("some", t)),
        (lambda x: heat.wks(x), ("some", np.array([3.0, 4.0]))),
        (lambda n, k: heat.scale_invariant(0.1, 8, n, k), ("count", 17), ("count", 6)),
        (lambda i, s: heat.distance(i, s), ("any", ids), ("some", t)),
        (lambda i: heat.distance(i, kind="commute"), ("any", ids)),
        (lambda i, j, s: heat.entries(i, j, s), ("same", ids), ("same", others), ("some", t)),
        (lambda i, j, s: heat.pairs(i, j, s), ("same", ids), ("same", others), ("some", t)),
        (lambda n, i: heat.sample(n, t1, i), ("count", 5), ("any", ids[:2])),
        (lambda i, s: heat.columns_sparse(i, s).toarray(), ("any", ids), ("some", t)),
        (lambda i, w: heat.columns(hd.Sources(i, weights=w), t), ("same", ids), ("same", np.array([1.0, 2, 3]))),
        (lambda x, w: heat.columns(hd.Sources(x, w), t), ("same", tri[:4]), ("same", np.tile([0.5, 0.25, 0.25], (4, 1)))),
        (lambda x, y: hd.Geodesic(x, y).distance(4), ("all", xyz), ("any", tri)),
        (lambda x: hd.Geodesic(x, neighbours=8).distance(4), ("any", xyz)),
        (lambda i: geo.distance(i), ("some", ids)),
        (lambda i, s: pairs.columns(i, s), ("any", ids), ("some", t)),
        (lambda s: pairs.diagonal(s), ("some", t)),
        (lambda x, y: abs(hd.diffusion_net(x, y, k=2).gradX.toarray()), ("all", xyz), ("some", tri)),
        (lambda x: heated(degree=x, method="direct"), ("count", 9)),
        (lambda x: heated(ordering="own", perm=x), ("same", np.arange(25)[::-1])),
    ]


def alike(a, b):
    finite = np.isfinite(b)
    return a.shape == b.shape and np.array_equal(a[~finite], b[~finite]) and np.allclose(a[finite], b[finite], 1e-6, 1e-7)


def lifetimes():
    """update reads a copy of coordinates of any kind before it is freed. Plans and their Laplacian in a circle are freed in
    any order, in any thread, and once."""
    xyz, tri, _ = bumpy(20)
    lap, want = mesh(xyz, tri, updatable=True), mesh(np.float32(xyz), tri).L
    for other in (np.float32, lambda x: np.asfortranarray(np.float32(x)), lambda x: np.float32(x).tolist()):
        lap.update(xyz)
        lap.update(other(xyz))
        assert abs(lap.L - want).max() < 1e-12
    for k in range(20):
        names = small()
        plans = [hd.Heat(names["lap"]) for _ in range(3)]
        names["lap"].circle = plans, names
        plans[k % 3].columns(0, 1)
        del plans, names
        if k % 2:
            gc.collect()
        else:
            threading.Thread(target=gc.collect).start()


def throw(count, seed):
    """Ends with 1 after a wrong number, or an exception of another kind than those promised."""
    load()
    rng, right, refused = random.Random(seed), 0, 0
    names, wrong = small(), list(misuses())
    print("".join("%s\n    %s\n" % x for x in wrong), end="")
    bad = len(wrong)
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
