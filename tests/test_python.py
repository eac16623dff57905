"""examples/python against dense eigensolutions of SciPy. Builds the shared library itself; without NumPy, SciPy or a
compiler it is skipped. Usage: test_python.py [unittest arguments]"""
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
except ImportError:
    np = None

CC = shutil.which("cc") or shutil.which("gcc")
hd = folder = None


def setUpModule():
    global hd, folder
    if np is None or CC is None or os.name == "nt":
        raise unittest.SkipTest("NumPy, SciPy or a C compiler is missing")
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


class Python(unittest.TestCase):
    def check(self, lap):
        t, k = 20 * lap.h ** 2, kernel(lap, 20 * lap.h ** 2)
        heat = hd.Heat(lap, method="HD_METHOD_DIRECT")
        u = heat.columns([t, 3 * t], [3, 17], symmetric=True)
        self.assertEqual(u.shape, (lap.n, 4))
        for q, (s, time) in enumerate(((3, t), (3, 3 * t), (17, t), (17, 3 * t))):
            want = kernel(lap, time)[:, s]
            self.assertLess(abs(u[:, q] - want).max(), 1e-6 * want.max())
        self.assertLess(heat.report["error_bound"], 1e-5)
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


if __name__ == "__main__":
    unittest.main()
