#!/usr/bin/env python3
"""The smaller tables of tools/README.md, measured again: measure.py [borders] [geodesic] [grounded] [derivatives]

    cc -O2 -fPIC -shared -fvisibility=hidden tools/heatdiff_shared.c -o libheatdiff.so -lm
    HEATDIFF_LIBRARY=./libheatdiff.so python3 tools/measure.py

Prints Markdown. Needs NumPy and SciPy. --quick takes the smaller sizes only.

    borders      heat and smallest eigenvalues with the border held at zero, against sine series, the disk, the hemisphere
    geodesic     mean errors of the heat method on the unit sphere: triangles, quadrangles, hexagons, random points
    grounded     bounds of distances without a time, on two grids that one edge of weight w joins
    derivatives  the derivative in t by two methods that share no step"""
import os
import sys
import warnings

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
import scipy.spatial

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "examples", "python", "src"))
import heatdiff as hd  # noqa: E402

MASSES = ("fem", "voronoi-cot")
QUICK = "--quick" in sys.argv
warnings.simplefilter("ignore", hd.AccuracyWarning)     # the tables show it


def row(*cells):
    print("| " + " | ".join(c if isinstance(c, str) else "%.3g" % c for c in cells) + " |")


def head(*cells):
    row(*cells)
    print("|" + "---|" * len(cells))


def square(n):
    """n x n cells, each cut along the same diagonal."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij"))
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    b, c, d = a + n + 1, a + n + 2, a + 1
    return np.stack([x, y, 0 * x], 1), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def disk(rings):
    """6 k vertices on ring k, and the triangles between the rings."""
    xyz, tri, first = [(0, 0, 0)], [], 0
    for k in range(1, rings + 1):
        now = len(xyz)
        angles = 2 * np.pi * np.arange(6 * k) / (6 * k)
        xyz += [(k / rings * np.cos(a), k / rings * np.sin(a), 0) for a in angles]
        for side in range(6):
            for j in range(k):
                out, inner = now + side * k + j, first + (side * (k - 1) + j) % max(6 * (k - 1), 1)
                tri.append((inner, out, now + (side * k + j + 1) % (6 * k)))
                if j < k - 1:
                    tri.append((inner, now + side * k + j + 1, first + (side * (k - 1) + j + 1) % (6 * (k - 1))))
        first = now
    return np.array(xyz, dtype=float), np.array(tri)


def smallest(xyz, tri, kind):
    lap = hd.Laplacian.from_mesh(xyz, tri, kind=kind, border="dirichlet")
    L, B = (a[lap.vertex][:, lap.vertex].tocsc() for a in (lap.L, lap.B))
    return scipy.sparse.linalg.eigsh(L, 1, B, sigma=0)[0][0]


def borders():
    head("n", "square, fem", "voronoi-cot", "disk, fem", "voronoi-cot", "hemisphere, fem", "voronoi-cot")
    t, m = 0.02, np.arange(1, 60)
    for n in (16, 32) if QUICK else (16, 32, 64, 128):
        xyz, tri = square(n)
        wave = np.exp(-t * np.pi ** 2 * m ** 2) * np.sin(np.pi * m / 2)
        at = [2 * np.sin(np.pi * np.outer(xyz[:, k], m)) @ wave for k in (0, 1)]
        truth, found = at[0] * at[1], []
        for kind in MASSES:
            heat = hd.Heat(hd.Laplacian.from_mesh(xyz, tri, kind=kind, border="dirichlet"))
            u = heat.column(n // 2 * (n + 1) + n // 2, t, symmetric=True)
            found.append(np.abs(u - truth).max() / truth.max())
        flat, tri = disk(n // 2)
        radius = np.hypot(flat[:, 0], flat[:, 1])
        angle = np.pi / 2 * radius
        stretch = np.divide(np.sin(angle), radius, out=np.zeros_like(radius), where=radius > 0)
        round_ = np.stack([flat[:, 0] * stretch, flat[:, 1] * stretch, np.cos(angle)], 1)
        found += [abs(smallest(flat, tri, kind) / 5.783185962946785 - 1) for kind in MASSES]
        found += [abs(smallest(round_, tri, kind) / 2 - 1) for kind in MASSES]
        row(str(n), *found)


def normed(x):
    return x / np.linalg.norm(x, axis=1)[:, None]


def icosphere(steps):
    g = (1 + 5 ** 0.5) / 2
    xyz = normed(np.array([p for a in (-1, 1) for b in (-g, g) for p in ((0, a, b), (a, b, 0), (b, 0, a))]))
    tri = outward(xyz, scipy.spatial.ConvexHull(xyz).simplices)
    for _ in range(steps):
        edges = np.sort(np.concatenate([tri[:, [0, 1]], tri[:, [1, 2]], tri[:, [2, 0]]]), axis=1)
        edges, where = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = where.ravel().reshape(3, -1) + len(xyz)
        xyz = np.concatenate([xyz, normed(xyz[edges[:, 0]] + xyz[edges[:, 1]])])
        a, b, c = tri.T
        tri = np.concatenate([np.stack(f, 1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return xyz, tri


def outward(xyz, tri):
    a, b, c = (xyz[tri[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    tri = np.array(tri)
    tri[inwards] = tri[inwards][:, [0, 2, 1]]
    return tri


def cube(n):
    """The faces of a cube of n x n squares each, blown up to the sphere."""
    index, xyz, quads = {}, [], []

    def vertex(p):
        if p not in index:
            index[p] = len(xyz)
            xyz.append(np.tan(np.pi / 4 * (2 * np.array(p) / n - 1)))
        return index[p]

    for axis in range(3):
        for end in (0, n):
            for i in range(n):
                for j in range(n):
                    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                    f = [vertex(tuple(np.roll((end,) + c, axis).tolist())) for c in corners]
                    quads.append(f if end else f[::-1])
    return normed(np.array(xyz)), np.array(quads)


def dual(xyz, tri):
    """A face for each vertex: the centres of the triangles around it, in turn."""
    follow = {}
    for f, (a, b, c) in enumerate(tri.tolist()):
        for v, w in ((a, b), (b, c), (c, a)):
            follow[v, w] = f
    after = {v: {} for v in range(len(xyz))}
    for a, b, c in tri.tolist():
        for v, w, x in ((a, b, c), (b, c, a), (c, a, b)):
            after[v][w] = x
    faces = []
    for v in range(len(xyz)):
        start = w = next(iter(after[v]))
        face = []
        while True:
            face.append(follow[v, w])
            w = after[v][w]
            if w == start:
                break
        faces.append(face)
    return normed(xyz[tri].mean(axis=1)), faces


def mean_error(xyz, faces, **options):
    plan, errors = hd.Geodesic(xyz, faces, **options), []
    for s in np.linspace(0, len(xyz) - 1, 8).astype(int):
        truth = np.arccos(np.clip(xyz @ xyz[s], -1, 1))
        errors.append(np.abs(plan.distance(s) - truth).mean())
    return np.mean(errors)


def edge(xyz, faces):
    if isinstance(faces, np.ndarray):
        return np.linalg.norm(xyz[faces] - xyz[np.roll(faces, 1, axis=1)], axis=2).mean()
    return np.mean([np.linalg.norm(xyz[f] - xyz[np.roll(f, 1)], axis=1).mean() for f in faces])


def geodesic():
    head("faces", "h", "mean error", "h", "mean error", "h", "mean error")
    rows = {}

    def add(what, xyz, faces, h=None, **options):
        rows.setdefault(what, []).extend([h or edge(xyz, faces), mean_error(xyz, faces, **options)])

    for k in range(1 if QUICK else 3):
        xyz, tri = icosphere(3 + k)
        add("triangles of an icosphere", xyz, tri)
        v, quads = cube(10 << k)
        add("quadrangles of a cube", v, quads, stiffening=1 / 6)
        add("the same split into triangles", v, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]))
        v, faces = dual(xyz, tri)
        add("hexagons and pentagons", v, faces, stiffening=1 / 6)
        v = normed(np.random.default_rng(1).normal(size=(500 << 2 * k, 3)))
        hull = outward(v, scipy.spatial.ConvexHull(v).simplices)
        add("random points, triangles of their hull", v, hull)
        add("the same without faces (tufted)", v, None, h=edge(v, hull))
        w, faces = dual(v, hull)
        add("polygons dual to these triangles", w, faces, stiffening=1 / 6)
    for what, cells in rows.items():
        row(what, *cells)


def grounded():
    head("w", "commute", "biharmonic")
    n, m = 40, 1600
    k = np.arange(m).reshape(n, n)
    grid = list(zip(k[:, :-1].ravel(), k[:, 1:].ravel())) + list(zip(k[:-1].ravel(), k[1:].ravel()))
    edges = np.array(grid + [(a + m, b + m) for a, b in grid] + [(m - 1, m)])
    for w in (1, 1e-3, 1e-6, 1e-9):
        weight = np.ones(len(edges))
        weight[-1] = w
        A = scipy.sparse.coo_matrix((weight, edges.T), (2 * m, 2 * m))
        A = (A + A.T).tocsr()
        L = scipy.sparse.diags(np.asarray(A.sum(axis=1)).ravel()) - A
        heat, bounds = hd.Heat(hd.Laplacian.from_matrices(L, np.ones(2 * m))), []
        for kind in ("commute", "biharmonic"):
            bounds.append(max(heat.distance(s, kind=kind).report.error_bound for s in (0, 2 * m - 1)))
        row("%g" % w, *bounds)


def derivatives():
    nu, nv = (70, 20) if QUICK else (350, 100)
    u, v = (a.ravel() for a in np.meshgrid(np.arange(nu), np.arange(nv), indexing="ij"))
    a, b = 2 * np.pi * u / nu, 2 * np.pi * v / nv
    xyz = np.stack([(2 + 0.7 * np.cos(b)) * np.cos(a), (2 + 0.7 * np.cos(b)) * np.sin(a), 0.7 * np.sin(b)], 1)
    p, q, r, s = u * nv + v, (u + 1) % nu * nv + v, (u + 1) % nu * nv + (v + 1) % nv, u * nv + (v + 1) % nv
    lap = hd.Laplacian.from_mesh(xyz, np.concatenate([np.stack([p, q, r], 1), np.stack([p, r, s], 1)]))
    one = np.zeros(lap.n)
    one[0] = 1
    fields = {"smooth": xyz[:, 0] + np.sin(3 * xyz[:, 1]), "single vertex": one,
              "noise": np.random.default_rng(1).normal(size=lap.n)}
    times = (3, 100, 1000, 10000)
    head("field", *("%g h²" % t for t in times))
    for name, f in fields.items():
        cells = []
        for t in times:
            best = hd.Heat(lap, method="direct", poles="kernel", degree=14).derivative(f, f"{t}h2")
            nine = hd.Heat(lap, method="direct", poles="kernel", degree=9).derivative(f, f"{t}h2")
            krylov = hd.Heat(lap, method="krylov", tol=1e-12).derivative(f, f"{t}h2")
            size = np.abs(krylov).max()
            cells.append("%.0e, %.0e" % (np.abs(best - krylov).max() / size, np.abs(best - nine).max() / size))
        row(name, *cells)


if __name__ == "__main__":
    asked = [a for a in sys.argv[1:] if not a.startswith("-")]
    for job in (borders, geodesic, grounded, derivatives):
        if not asked or job.__name__ in asked:
            print("\n%s\n" % job.__name__)
            job()
