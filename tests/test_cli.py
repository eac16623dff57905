"""Tests of the command-line tool, through its command line only.

    python3 tests/test_cli.py PATH_TO_HEATDIFF [unittest options]

Needs nothing but Python 3. All runs are in one temporary folder. Meshes and fields come to be there when a command line
names them: torus-40-24.obj, or waves-960-2.npy (MAKERS, FIELDS). Numbers are checked against eigenpairs computed here,
in plain Python on small meshes or in closed form, and against what must hold on any mesh.
"""
import cmath
import functools
import itertools
import json
import math
import os
import random
import re
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

TOOL = None
FOLDER = None
HERE = os.path.dirname(os.path.abspath(__file__))
POSIX = os.name == "posix"
COMMANDS = ("info", "kernel", "diffuse", "smooth", "distance", "pairs", "hks", "trace", "sample", "geodesic", "spectrum", "levels",
            "render", "demo")
METHODS = ("direct", "krylov", "auto", "iterative")
KINDS = ("fem", "voronoi-cot")
DEFINITIONS = ("classical", "weighted", "commute", "biharmonic")


# ---- meshes: lists of places and faces ----

def icosahedron():
    g = (1 + 5 ** 0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1),
         (-g, 0, -1), (-g, 0, 1)]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
         (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return [tuple(map(float, p)) for p in v], f


def quads(nx, ny, size=1.0):
    """Squares in the plane: nx by ny of them."""
    v = [(size * x, size * y, 0.0) for y in range(ny + 1) for x in range(nx + 1)]
    low = [y * (nx + 1) + x for y in range(ny) for x in range(nx)]
    return v, [(a, a + 1, a + nx + 2, a + nx + 1) for a in low]


def triangles(mesh):
    """Polygons split as fans."""
    return mesh[0], [(f[0], f[k], f[k + 1]) for f in mesh[1] for k in range(1, len(f) - 1)]


@functools.lru_cache(None)
def patch(k):
    """A (k+1) x (k+1) grid with a border, not flat and not regular."""
    rnd = random.Random(4)
    v = [(x + 0.2 * rnd.random(), y + 0.2 * rnd.random(), 0.7 * math.sin(0.9 * x) * math.cos(0.7 * y))
         for y in range(k + 1) for x in range(k + 1)]
    return v, triangles(quads(k, k))[1]


def torus(n, m):
    places = [(i, j) for i in range(n) for j in range(m)]
    angles = [(2 * math.pi * i / n, 2 * math.pi * j / m) for i, j in places]
    v = [((3 + math.cos(b)) * math.cos(a), (3 + math.cos(b)) * math.sin(a), math.sin(b)) for a, b in angles]
    return triangles((v, [(i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m) for i,
                          j in places]))


def askew():
    """A torus whose vertices are joined askew, so that its triangles are slivers."""
    v, f = torus(16, 8)
    turn = [i * 8 + (j + 2 * i) % 8 for i in range(16) for j in range(8)]
    return v, [tuple(turn[i] for i in t) for t in f]


def unit(p):
    return tuple(x / math.sqrt(dot(p, p)) for x in p)


@functools.lru_cache(None)
def sphere(levels):
    """The icosahedron on the unit sphere, its triangles split in four so many times."""
    v, f = icosahedron()
    v = [unit(p) for p in v]
    for _ in range(levels):
        middle, finer = {}, []
        for c in f:
            m = []
            for a, b in ((c[0], c[1]), (c[1], c[2]), (c[2], c[0])):
                if frozenset((a, b)) not in middle:
                    middle[frozenset((a, b))] = len(v)
                    v.append(unit([x + y for x, y in zip(v[a], v[b])]))
                m.append(middle[frozenset((a, b))])
            finer += [(c[0], m[0], m[2]), (c[1], m[1], m[0]), (c[2], m[2], m[1]), tuple(m)]
        f = finer
    return v, f


@functools.lru_cache(None)
def cloud(n):
    """Points on the unit sphere."""
    heights = [(i, (2 * i + 1) / n - 1) for i in range(n)]
    return [(math.sqrt(1 - z * z) * math.cos(2.4 * i), math.sqrt(1 - z * z) * math.sin(2.4 * i), z) for i, z in heights], []


def apart(*meshes):
    """Meshes side by side in one, ten apart."""
    v, f = [], []
    for k, (p, t) in enumerate(meshes):
        f += [tuple(i + len(v) for i in c) for c in t]
        v += [(x + 10 * k, y, z) for x, y, z in p]
    return v, f


def with_holes(mesh, *vertices):
    """Without the faces at these vertices, which stay and carry no mass then."""
    return mesh[0], [t for t in mesh[1] if not set(t) & set(vertices)]



def parts():
    """A torus with two holes, a patch with one, an icosahedron, a vertex in no face and one in a face of zero area."""
    v, f = apart(with_holes(torus(24, 16), 5, 200), with_holes(patch(9), 44), icosahedron())
    return v + [(1.0, 2.0, 3.0), v[7]], f + [(7, 8, len(v) + 1)]


def pieces():
    """A tetrahedron (0 to 3), an icosahedron (4 to 15), a vertex in no face, a triangle (17 to 19)."""
    v, f = icosahedron()
    tetrahedron = [(20.0, 0.0, 0.0), (21.0, 0.0, 0.0), (20.0, 1.0, 0.0), (20.0, 0.0, 1.5)], [(0, 2, 1), (0, 1, 3), (1, 2, 3),
        (0, 3, 2)]
    return apart(tetrahedron, (v + [(0.0, 0.0, 50.0)], f), ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)], [(0, 1, 2)]))


def of_corners(*places):
    """One face."""
    return list(places), [tuple(range(len(places)))]


def also(mesh, v, f):
    """With more places and faces."""
    return mesh[0] + v, mesh[1] + f


def sides(v, f):
    """The lengths of the edges of each triangle."""
    return [[math.dist(v[t[q]], v[t[(q + 1) % 3]]) for q in range(3)] for t in f]


# Two triangles and a square.
ROOF = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)], [(0, 1, 2), (0, 2, 3), (1, 4, 5, 2)]
# Three leaves on one spine.
BOOK = [(0, 0, 0), (0, 0, 1), (3, 0, .5), (-1, 2, .5), (-1, -2, .4)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)]
FIVE = of_corners((0.0, 0.0, 0.0), (2.0, 0.0, 0.1), (2.5, 1.5, 0.0), (1.0, 2.5, 0.3), (-0.5, 1.5, 0.0))
MAKERS = {
    "ico": icosahedron, "quads": quads, "grid": lambda *n: triangles(quads(*n)), "patch": patch, "torus": torus, "askew": askew,
    "sphere": sphere, "cloud": cloud, "parts": parts, "pieces": pieces, "roof": lambda: ROOF, "book": lambda: BOOK,
    "five": lambda: FIVE, "fan": lambda: triangles(FIVE), "quad": lambda: quads(1, 1),
    "square": lambda n: triangles(quads(n, n, 1 / n)),
    # the closer to two of its sides, the smaller are its triangles
    "graded": lambda n: ([(x * x, y * y, 0.1 * x * y) for x, y, _ in quads(n, n, 1 / n)[0]], triangles(quads(n, n))[1]),
    "line": lambda: of_corners((0, 0, 0), (1, 0, 0), (2, 0, 0)), "two": lambda: apart(icosahedron(), icosahedron()),
    "twins": lambda: apart(patch(4), with_holes(patch(4), 0)), "unlike": lambda: apart(patch(4), patch(3)),
    "loose": lambda: also(icosahedron(), [(9.0, 9.0, 9.0)], []), "strip": lambda n: triangles(quads(n - 1, 1)),
    # with a face twice, a face with a corner twice, a face of no area
    "defects": lambda: also(icosahedron(), icosahedron()[0][:1], [(0, 11, 5), (1, 1, 2), (0, 12, 3)]),
    "strange": lambda: also(quads(1, 1), [(x, 0, 0) for x in (3, 4, 5, 6)], [(3, 1, 0, 2), (4, 5, 6, 7), (0, 1, 1, 4)]),
    "mixed": lambda: also(icosahedron(), [(x, y, 3) for x, y, _ in quads(1, 1)[0]], [(12, 13, 15, 14)]),
    "dense": lambda: also(icosahedron(), [(5, 5, 5)] * 20, []), "twice": lambda: (cloud(300)[0] + cloud(300)[0][:20], []),
    "few": lambda: (cloud(300)[0][::6], []), "sheets": lambda: ([(i % 12, i // 12 % 12, i // 144) for i in range(288)], []),
    "uneven": lambda: ([(float(i % 5), i // 5 + 0.1 * (i % 2), 0.0) for i in range(25)], quads(4, 4)[1]),
    # places that say nothing about the surface, for lengths of edges
    "squashed": lambda: ([(0, 0, 0)] * 64, patch(7)[1]),
}
# Rows of fields: name-rows.txt, or name-rows-columns.npy
FIELDS = {"ones": lambda i: [1.0], "count": lambda i: [float(i)], "waves": lambda i: [math.sin(i / 9), float(i % 11), 1.0],
          "heights": lambda i: [cloud(300)[0][i][2]], "latitude": lambda i: [sphere(3)[0][i][2]],
          "sides": lambda i: sides(*patch(7))[i]}


def lines_of(rows, before="", between=" "):
    return "".join(before + between.join("%.17g" % x if isinstance(x, float) else str(x) for x in r) + "\n" for r in rows)


def obj_text(v, f):
    return lines_of(v, "v ") + lines_of([[i + 1 for i in t] for t in f], "f ")


def off_text(v, f):
    return "OFF\n%d %d 0\n" % (len(v), len(f)) + lines_of(v) + lines_of([(len(t), *t) for t in f])


def ply_text(v, f):
    return ("ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\nelement face %d\n"
            "property list uchar int vertex_indices\nend_header\n" % (len(v), len(f))) + lines_of(v) + lines_of([(len(t), *t)
                for t in f])


def stl_text(v, f):
    facets = ("facet normal 0 0 0\nouter loop\n" + lines_of([v[i] for i in t], "vertex ") + "endloop\nendfacet\n" for t in f)
    return "solid s\n" + "".join(facets) + "endsolid\n"


def npy_bytes(rows, fortran=False, flat=False):
    n, k = len(rows), len(rows[0])
    values = [rows[r][c] for c in range(k) for r in range(n)] if fortran else [x for r in rows for x in r]
    header = "{'descr': '<f8', 'fortran_order': %s, 'shape': (%s), }" % (fortran, "%d," % n if flat else "%d, %d" % (n, k))
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + struct.pack("<%dd" % len(values), *values)


WRITERS = {"obj": obj_text, "off": off_text, "ply": ply_text, "stl": stl_text, "xyz": lambda v, f: lines_of(v), "txt": lines_of,
           "npy": npy_bytes}


def spec(word):
    """The mesh or rows that a name stands for, or None."""
    name = re.fullmatch(r"(?:--\w+=)?(([a-z]+)((?:-\d+)*)\.(\w+))", word)
    if not name or name[2] not in MAKERS and name[2] not in FIELDS or name[4] not in WRITERS:
        return None
    n = [int(x) for x in name[3].split("-")[1:]]
    if name[2] in MAKERS:
        return name[1], WRITERS[name[4]], MAKERS[name[2]](*n)
    return name[1], WRITERS[name[4]], ([FIELDS[name[2]](i)[:(n + [9])[1]] for i in range(n[0])],)


# ---- eigenpairs: what every command computes is a sum over them ----

def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(p, q):
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def length(a):
    return math.sqrt(dot(a, a))


def identity(n):
    return [[float(i == j) for j in range(n)] for i in range(n)]


def transposed(a):
    return [list(c) for c in zip(*a)]


def matmul(a, b):
    bt = transposed(b)
    return [[dot(r, c) for c in bt] for r in a]


def solve(a, b):
    """a^-1 b for matrices, by Gauss-Jordan with pivots."""
    n = len(a)
    m = [list(a[i]) + list(b[i]) for i in range(n)]
    for c in range(n):
        p = max(range(c, n), key=lambda r: abs(m[r][c]))
        m[c], m[p] = m[p], m[c]
        m[c] = [x / m[c][c] for x in m[c]]
        for r in range(n):
            if r != c and m[r][c]:
                s = m[r][c]
                m[r] = [x - s * y for x, y in zip(m[r], m[c])]
    return [row[n:] for row in m]


def cotan_and_fem(v, f):
    L, B = ([[0.0] * len(v) for _ in v] for _ in range(2))
    for t in f:
        area = length(cross(sub(v[t[1]], v[t[0]]), sub(v[t[2]], v[t[0]]))) / 2
        for c in range(3):
            i, j, k = t[c], t[(c + 1) % 3], t[(c + 2) % 3]
            a, b = sub(v[i], v[k]), sub(v[j], v[k])
            w = dot(a, b) / length(cross(a, b)) / 2
            for p, q, s in ((i, j, -w), (j, i, -w), (i, i, w), (j, j, w)):
                L[p][q] += s
            B[i][i] += area / 6
            for p, q in ((i, j), (j, i)):
                B[p][q] += area / 12
    return L, B


def cholesky(B):
    C = [[0.0] * len(B) for _ in B]
    for j in range(len(B)):
        for i in range(j, len(B)):
            s = B[i][j] - dot(C[i][:j], C[j][:j])
            C[i][j] = math.sqrt(s) if i == j else s / C[j][j]
    return C


def jacobi(A):
    """Eigenvalues of a symmetric matrix, and its eigenvectors as rows, by rotations of two rows and columns."""
    n, Q = len(A), identity(len(A))
    while sum(A[p][q] ** 2 for p in range(n) for q in range(p)) > 1e-30 * sum(A[p][p] ** 2 for p in range(n)):
        for p in range(n):
            for q in range(p):
                if A[p][q]:
                    angle = 0.5 * math.atan2(2 * A[p][q], A[q][q] - A[p][p])
                    c, s = math.cos(angle), math.sin(angle)
                    for M in (A, Q):
                        M[p], M[q] = [c * x - s * y for x, y in zip(M[p], M[q])], [s * x + c * y for x, y in zip(M[p], M[q])]
                    for row in A:
                        row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
    return [A[p][p] for p in range(n)], Q


class Modes:
    """Eigenvalues, and the rows x(i) and y(i) = (B x)(i) of the eigenvectors for each vertex, with x'Bx = 1.

    A function f of the operator is the sum of f(value) x y': K_t for exp(-t value). With x x' it is symmetric.
    """
    def __init__(self, values, x, y):
        self.values, self.x, self.y = [max(0.0, v) for v in values], x, y

    def entry(self, f, i, j, left="x", right="y"):
        return sum(f(v) * a * b for v, a, b in zip(self.values, getattr(self, left)[i], getattr(self, right)[j]))

    def column(self, f, j, left="x", right="y"):
        weights = [f(v) * b for v, b in zip(self.values, getattr(self, right)[j])]
        return [dot(weights, a) for a in getattr(self, left)]

    def applied(self, f, field):
        weights = [f(v) * dot(field, y) for v, y in zip(self.values, zip(*self.y))]
        return [dot(weights, a) for a in self.x]

    def diagonal(self, f, left="x", right="x"):
        weights = list(map(f, self.values))
        return [sum(w * a * b for w, a, b in zip(weights, p, q)) for p, q in zip(getattr(self, left), getattr(self, right))]

    def trace(self, f):
        return sum(map(f, self.values))

    def distance(self, definition, t, j):
        """To vertex j from all; t is a time, or a filter."""
        f = {"commute": inverse(1), "biharmonic": inverse(2)}.get(definition) or (t if callable(t) else heat(2 * t))
        side = "y" if definition == "weighted" else "x"
        d, c = self.diagonal(f, side, side), self.column(f, j, side, side)
        return [math.sqrt(max(0, d[i] + d[j] - 2 * c[i])) for i in range(len(c))]


def heat(t):
    return lambda v: math.exp(-t * v)


def inverse(power):
    return lambda v: v ** -power if v > 1e-9 else 0.0


@functools.lru_cache(None)
def dense_modes(name, kind):
    """Of a small mesh, with the FEM's or with no masses."""
    L, B = cotan_and_fem(*spec(name)[2])
    C = cholesky(B if kind == "fem" else identity(len(B)))
    values, q = jacobi(solve(C, transposed(solve(C, L))))
    return Modes(values, solve(transposed(C), transposed(q)), matmul(C, transposed(q)))


def on_both_axes(values, rows, n):
    """Eigenpairs of the five-point Laplacian, from those of a line of places 1/n apart."""
    pairs = [(p, q) for p in range(len(values)) for q in range(len(values))]
    x = [[n * a[p] * b[q] for p, q in pairs] for b in rows for a in rows]
    return Modes([values[p] + values[q] for p, q in pairs], x, [[z / n ** 2 for z in row] for row in x])


@functools.lru_cache(None)
def square_modes(n):
    """The unit square of n x n cells with voronoi-cot, held at zero at its border."""
    return on_both_axes([(2 * n * math.sin(m * math.pi / 2 / n)) ** 2 for m in range(1, n)],
                        [[math.sqrt(2 / n) * math.sin(m * math.pi * a / n) * (0 < a < n) for m in range(1, n)]
                         for a in range(n + 1)], n)




# ---- readers of the outputs ----

def numbers(text, separator=None):
    text = text if isinstance(text, str) else text.decode()
    return [[float(x) for x in line.split(separator)] for line in text.splitlines() if line.strip() and not line.startswith("#")]


def read_csv(data):
    """The names and the rows of a .csv."""
    names, rows = data.decode().split("\n", 1)
    names, rows = names.split(","), numbers(rows, ",")
    assert all(len(r) == len(names) for r in rows) and len(set(names)) == len(names), names
    return names, rows


def read_npy(data):
    assert data[:8] == b"\x93NUMPY\x01\x00", data[:8]
    start = 10 + struct.unpack("<H", data[8:10])[0]
    header = eval(data[10:start].decode("latin-1"), {"__builtins__": {}}, {"False": False, "True": True})
    assert header["descr"] == "<f8" and start % 64 == 0, header
    rows, columns = header["shape"]
    v = struct.unpack("<%dd" % (rows * columns), data[start:])
    if header["fortran_order"]:
        return [list(v[r::rows]) for r in range(rows)]
    return [list(v[r * columns:(r + 1) * columns]) for r in range(rows)]


def counted(data):
    """Points and faces, as the head of a .ply or .vtu tells. test_files.py and the runner's meshio read the rest."""
    return tuple(map(int, re.findall(rb'(?:element (?:vertex|face) |NumberOf(?:Points|Cells)=")(\d+)', data)))


def read_obj(data):
    """The numbers of the v lines, and the number of faces."""
    lines = data.decode().splitlines()
    return [[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")], sum(line.startswith("f ")
        for line in lines)


def read_png(data):
    """Checks every chunk; width, height and the number of unlike bytes in the picture, which is still filtered."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, []
    while at < len(data):
        n, name = struct.unpack_from(">I4s", data, at)
        chunks.append((name, data[at + 8:at + 8 + n]))
        assert struct.unpack_from(">I", data, at + 8 + n)[0] == zlib.crc32(data[at + 4:at + 8 + n])
        at += 12 + n
    assert (chunks[0][0], chunks[-1][0]) == (b"IHDR", b"IEND")
    width, height, bits, colour = struct.unpack_from(">IIBB", chunks[0][1])
    pixels = zlib.decompress(b"".join(data for name, data in chunks if name == b"IDAT"))
    assert len(pixels) == height * (1 + width * {0: 1, 2: 3, 3: 1, 6: 4}[colour] * bits // 8)
    return width, height, len(set(pixels))


def columns(rows, *which):
    return [[r[c] for c in which] for r in rows]


# ---- running ----

def setUpModule():
    global FOLDER
    FOLDER = tempfile.mkdtemp(prefix="heatdiff-test-")


def tearDownModule():
    shutil.rmtree(FOLDER)


def absent(what):
    """Ends a test for want of a program; where nothing may be skipped it fails."""
    raise (AssertionError if os.environ.get("HEATDIFF_NO_SKIP") else unittest.SkipTest)(what)


def path(name):
    return os.path.join(FOLDER, name)


def file(name, content):
    """Writes a file: text, bytes, or rows of numbers."""
    content = content if isinstance(content, (str, bytes)) else lines_of(content)
    with open(path(name), "wb") as f:
        f.write(content if isinstance(content, bytes) else content.encode())
    return name


def taken(name):
    """What a file holds, which is gone then."""
    with open(path(name), "rb") as f:
        data = f.read()
    os.remove(path(name))
    return data


def words(line, *more):
    """The arguments of a command line, whose files are there now."""
    args = shlex.split(line) + [str(a) for a in more]
    for word in args:
        if word[-4:-3] == "." and not os.path.exists(path(word.split("=")[-1])) and spec(word):
            name, writer, content = spec(word)
            file(name, writer(*content))
    return args


def everything():
    return sorted(os.listdir(FOLDER))


KEYS = set("n faces components h area inert laplacian method times threads peak_bytes seconds ordering factor_nnz factor_flops "
           "residual".split())
HEAT_KEYS = KEYS | set("solver precond poles degree iterations error_bound mass_drift reason growth evidence error_rational "
                       "error_solver error_rounding error_local touched patches".split())
STAGES = ("load", "assemble", "order", "analyse", "factor", "precondition", "invert", "solve", "write")


class Case(unittest.TestCase):
    """Command lines are written as for a shell, in the folder of all tests."""

    def run_tool(self, line, *more, timeout=300, **options):
        if "stdin" not in options and "input" not in options:
            options["stdin"] = subprocess.DEVNULL
        return subprocess.run([TOOL] + words(line, *more), stdout=options.pop("stdout", subprocess.PIPE), stderr=subprocess.PIPE,
                              cwd=options.pop("cwd", FOLDER), timeout=timeout, **options)

    def good(self, line, *more, **options):
        p = self.run_tool(line, *more, **options)
        self.assertEqual(p.returncode, 0, (line, more, p.stderr))
        return p

    def bad(self, code, want, line, *more, files=None, **options):
        """Runs what must fail with this code and one line that has this text, leaving every file as it is. The line."""
        for name, content in (files or {}).items():
            file(name, content)
        words(line, *more)
        before = everything()
        p = self.run_tool(line, *more, **options)
        text = p.stderr.decode(errors="replace")
        told = (line, more, text[:1000])
        self.assertEqual(p.returncode, code, told)
        self.assertRegex(text, r"\Aheatdiff: error: [^\n]*\n\Z", told)
        (self.assertIn(want, text, told) if isinstance(want, str) else self.assertRegex(text, want, told))
        self.assertEqual(everything(), before, told)
        return text

    def rows(self, line, *more, **options):
        return numbers(self.good(line, *more, "--quiet", **options).stdout)

    def data(self, name, line, *more):
        """The bytes of the file that a run writes; nothing goes to standard output then."""
        self.assertEqual(self.good(line, *more, "--quiet", "-o", name).stdout, b"")
        return taken(name)

    def report(self, line, *more):
        """The report as JSON. The output, if it is in no file of its own, is in report.npy."""
        if line.startswith("info"):
            return json.loads(self.good(line, *more, "--json").stdout)
        r = json.loads(self.good(line, *more, "--json", *(() if " -o " in line else ("-o", "report.npy"))).stderr)
        with self.subTest(line, more=more):
            self.sound(words(line, *more), r)
        return r

    def sound(self, args, r):
        """What holds for the report of every run."""
        heat = r["command"] in ("kernel", "diffuse", "distance", "pairs", "hks", "sample")
        if not heat and r["command"] != "geodesic":
            return
        self.assertLessEqual(HEAT_KEYS if heat else KEYS, set(r))
        seconds, spent = r["seconds"], [r["seconds"].get(k, 0) for k in STAGES]
        self.assertTrue(min(spent) >= 0 and sum(spent) <= seconds["total"] * (1 + 1e-9), seconds)
        self.assertGreater(r["peak_bytes"], 1000)
        if r["method"] == "iterative" and r["reason"] == "asked for":      # else there may be an analysis
            self.assertEqual((r["factor_nnz"], r["factor_flops"], r["growth"], r["ordering"], seconds["factor"]),
                             (0, 0, 0, "none", 0))
        elif r["method"] != "iterative":
            self.assertTrue(0 < (r.get("touched") or r["n"] - r["inert"]) <= r["factor_nnz"] <= r["factor_flops"], r)
            self.assertIn(r["ordering"], ("amd", "dissection"))
            self.assertGreater(min(seconds["order"] + seconds["analyse"], seconds["solve"]), 0, seconds)
        if r["command"] in ("kernel", "diffuse"):
            asked = args[args.index("--method") + 1] if "--method" in args else "auto"
            if asked == "auto":
                self.assertNotIn(r["reason"], ("", "asked for"))
            else:
                self.assertEqual((r["method"], r["reason"]), (asked, "asked for"))
        if heat:
            self.assertEqual(set(r["evidence"]), {"rational", "solver", "rounding", "local"})
            self.assertLessEqual(set(r["evidence"].values()), {"none", "proven", "measured", "estimated"})
            self.assertTrue(not r["times"] or [p["t"] for p in r["per_time"]] == r["times"])
        if r["method"] == "krylov" or r["method"] == "local" and r["command"] in ("kernel", "diffuse", "pairs"):
            self.assertEqual((r["solver"], r["precond"], r["poles"], r["degree"]), ("lanczos", "none", "none", 0))
        if r["command"] in ("distance", "hks", "sample"):
            self.assertTrue(r["method"] in ("direct", "local") and (r["poles"] == "none" or seconds["invert"] > 0)
                            and (r["method"] == "local") == (r["patches"] > 0) and 0 < (r["error_bound"] or math.inf) <= (r["error_relative"] or math.inf), r)

    def text(self, line, *more):
        """What a run tells people, in full: info and --dry-run by their output, all others on standard error."""
        brief = line.startswith(("info", "render")) or "--dry-run" in (line.split() + list(more)) or "--quiet" in line
        p = self.good(line, *more, *(() if brief else ("--verbose",)))
        return (p.stdout if line.startswith("info") or "--dry-run" in (line.split() + list(more)) else p.stderr).decode()

    def close(self, got, want, tol, each=False):
        """Column by column, relative to the largest value of each, or to each value."""
        self.assertEqual((len(got), len(got[0])), (len(want), len(want[0])))
        for c, (a, b) in enumerate(zip(zip(*got), zip(*want))):
            scale = max(map(abs, b))
            self.assertLess(scale, math.inf)
            wrong = [(r, x, y) for r, (x, y) in enumerate(zip(a, b)) if not abs(x - y) <= tol * (abs(y) if each else scale)]
            self.assertEqual(wrong, [], "column %d" % c)


def each(row):
    """A row of a table for each choice of {a|b}; {1} is the first choice again, and so on."""
    choices = re.findall(r"\{([^{}]*\|[^{}]*)\}", row)
    for chosen in itertools.product(*(c.split("|") for c in choices)):
        words = iter(chosen)
        line = re.sub(r"\{[^{}]*\|[^{}]*\}", lambda _: next(words), row)
        yield re.sub(r"\{(\d)\}", lambda m: chosen[int(m[1]) - 1], line)


def table(text):
    """The rows of a text, whose columns are apart by ::"""
    rows = text.replace("\\\n", "").strip().splitlines()
    return [tuple(c.strip() for c in line.split("::")) for row in rows for line in each(row)]


# ---- command lines that are wrong ----

KERNEL = "kernel ico.obj --source 0 --t 1 "
PAIRS = "pairs ico.obj --input p.txt "

# What an option does not take: the line says "OPTION takes".
VALUES = (
    ("kernel ico.obj --source 0", "--t",
     "-1 nan inf -inf abc '' , 1, ,1 1,,2 h2 1h 1h3 '1 h2' 0x10 1e999 1e999h2 auto auto: auto:0 auto:-3 "
     "auto:1.5 auto:1000000000000 ' 1' '1 ' '1;2' -0.5h2 1h2h2 1.2.3 --1 +-1 1/l2 auto:3/l1"),
    ("kernel ico.obj --t 1", "--source",
     "-3 1.5 a '' 1,,2 1, 0x1 1e3 ' 1' 1-2 1+ +,1 2: 2:0.5 2:0.5, 2:0.7,0.4 2:-0.1,0.4 2:a,b *3 0.5* "
     "nan*3 1:0.2,0.3,0.5:1,1 2:0.1,-0.4 2:0.1,x '2:0.1;0.2'"),
    (KERNEL, "--laplacian", "nosuch ''"), (KERNEL, "--degree", "0 15 7.5 x"), (KERNEL, "--poles", "best"),
    (KERNEL, "--tol", "0 -1 1 nan"), (KERNEL, "--method", "magic ''"), (KERNEL, "--ordering", "metis own"),
    (KERNEL, "--simd", "sse avx"),
    (KERNEL, "--solver", "cg2"), (KERNEL, "--precond", "amg2"), (KERNEL, "--kernel", "own"), (KERNEL, "--threads", "0 -1 x 1025"),
    (KERNEL, "--max-iterations", "0"), (KERNEL, "--memory-limit", "0 5X -5 x 0.5 1e19 5KK"), (KERNEL, "--isolines", "-1"),
    (KERNEL, "--range", "1 2,1 1,nan x,1 '1;2' 1,2, 0,0X1 .,1"), (KERNEL, "--view", "1 0,91 3601,0 0,1,2"),
    (KERNEL, "--size", "100 0x0 1000000x1000000 -100x100 x 64x 64x64x 9000x64 64x9000 64x63"), (KERNEL, "--colormap", "nosuch"),
    (KERNEL, "--column", "-1"), (KERNEL, "--title", "''"), (KERNEL, "--lambda", "0 -1 x nan 1e200 ''"),
    ("kernel ico.obj", "--filter", "a-name-of-no-filter:1 none:1 wave:x,1 wave:1,x wave:1,0 band:2 heat:1/l1x"),
    ("spectrum patch-9.off", "--below", "x 0 -1"), ("spectrum patch-9.off", "--tol", "x"), ("render ico.obj", "--input", "''"),
    ("levels ico.obj --input count-12.txt", "--levels",
     "'' 1, x auto:0 auto:2,1 inf nan '1;2' auto:x auto:3x auto:1001 1,x '1;'"),
    ("hks ico.obj --t 1,2", "--scale-invariant", "0"), ("sample ico.obj --t 1", "--count", "0"),
    ("hks ico.obj", "--t", "0 1,0h2 -1"), ("distance ico.obj --source 0", "--t", "0 1,0h2 -1"),
    ("pairs ico.obj --input p.txt", "--t", "0 1,0h2 -1"),
    ("sample ico.obj --count 2", "--t", "0 1,0h2 -1 1,2 auto:2"), ("geodesic ico.obj --source 0", "--t", "0 1,2 auto:2 -1 0h2"),
    ("sample ico.obj --t 1 --count 2", "--source", "0,1,2 0:2,1"), ("info ico.obj", "--bandwidth", "1/l1"),
    ("info cloud-300.xyz", "--bandwidth", "0 -1 abc auto:3 1,2 '' 1h nan"),
    ("info cloud-300.xyz", "--weight-cut", "0 1 -1e-4 2 x ''"),
    ("hks square-12.obj", "--filter",
     "heat heat: heat:0 heat:-1 heat:1,2 heat:auto:3 wave:3 wave:3,0 wave:3h2,1 band:3,2 band:1h2,2 "
     "sine:3 fractional:1 biharmonic:0"),
)
# What is wrong otherwise: what is told, and the line.
USAGE = table(r"""
needs --t :: trace ico.obj
times > 0 :: trace ico.obj --t 0
--filter takes no --poles :: kernel ico.obj --source 0 --filter heat:1 --poles kernel
--filter takes heat:T, wave:E,SIGMA :: hks ico.obj --filter sine:3
read off the factors :: pairs ico.obj --input p.txt --filter heat:1 {--solver cocg|--precond ildl|--method iterative}
no {--t|--degree} :: hks ico.obj --filter heat:1 {1} 4
no {--method krylov|--solver lanczos} :: kernel ico.obj --source 1 --filter heat:1 {1}
no --definition :: distance ico.obj --source 1 --filter heat:1 --definition commute
--filter :: geodesic ico.obj --source 0 --filter heat:1
--ordering takes no --precond :: kernel ico.obj --source 0 --t 1 --ordering amd --precond ildl
single time :: sample ico.obj --count 3 --t auto:3
--method takes auto or direct :: pairs ico.obj --input p.txt --definition commute --method {krylov|iterative|local}
--solver takes --definition :: pairs ico.obj --input p.txt --definition {commute|biharmonic} --solver cocg
--precond takes --definition :: pairs ico.obj --input p.txt --definition {commute|biharmonic} --precond ildl
at most --count :: sample ico.obj --count 1 --t 1 --source 0,1
--normalise takes no --filter :: hks ico.obj --normalise --filter heat:1
--kernel symmetric :: hks ico.obj --t 1 --normalise --kernel operator
beside it :: hks ico.obj --t 1,2 --normalise --scale-invariant 3
the first and the last time :: hks ico.obj --scale-invariant 2 --t {auto:2,1|1,auto:2|1}
--normalise is not an option :: kernel ico.obj --source 0 --t 1 --normalise
exp has no gradient :: geodesic {ico.obj|cloud-300.xyz} --source 0 --laplacian {exp|voronoi-exp}
squared length :: geodesic quads-16-12.obj --source 0 --laplacian cot
mean :: geodesic ico.obj --source 0 --border neumann
one time above 0 :: geodesic ico.obj --source 0 --t auto:3
--source :: {geodesic ico.obj|kernel ico.obj --t 1|distance ico.obj --t 1}
{--degree|--method|--kernel|--input} :: geodesic ico.obj --source 0 {1}={3|direct|symmetric}
exp needs coordinates :: kernel ico.obj --source 0 --t 1 --lengths l.txt --laplacian exp
--weight-cut for exponential :: kernel ico.obj --source 0 --t 1 --lengths l.txt --weight-cut 1e-4
takes --laplacian fem, voronoi-cot or cot :: kernel ico.obj --source 0 --t 1 --lengths l.txt --laplacian {voronoi-exp|polygon}
--bandwidth for exponential weights :: kernel ico.obj --source 0 --t 1 --lengths l.txt --bandwidth 1
--lambda for polygons :: kernel ico.obj --source 0 --t 1 --lengths l.txt --lambda 2
dissection cuts in space :: kernel ico.obj --source 0 --t 1 --lengths l.txt --ordering dissection
--curve takes no --lengths :: kernel ico.obj --source 0 --t 1 --lengths l.txt --curve
--lengths :: render ico.obj --input l.txt --lengths l.txt -o a.png
standard input can be read only once :: info - --lengths -
--matrix takes vertices :: distance ico.obj --t 1 --matrix {--source 0+1|--source 0 --curve|--source 0 --source-file s.txt}
--nearest :: geodesic ico.obj --source 3,4 --matrix --nearest
--matrix :: kernel ico.obj --source 0 --t 1 --matrix
.csv :: geodesic ico.obj --source 3,4 --matrix -o m.png
needs --levels :: levels ico.obj --input f.txt
.obj :: levels ico.obj --input f.txt --levels 1 -o l.png
{--lengths|--source-file} takes a file name here :: kernel - --t 1 --source 0 {1} -
read only once :: {kernel ico.obj --t 1 --source-file - --lengths -|diffuse - --input - --t 1|pairs - --input - --t 1}
only once :: {render - --input - -o x.png|render ico.obj --input - --input - -o x.png}
for 2 meshes :: render ico.obj ico.obj --input f.txt -o x.png
each mesh :: {render a.obj b.ply --input f.txt -o x.png|render a.obj a.obj --input f.txt --input f.txt --input f.txt -o x.png}
at most 12 meshes :: render a b c d e f g h i j k l m --input f.txt -o x.png
up to twelve times :: render a.obj --input=1 --input=2 --input=3 --input=4 --input=5 --input=6 --input=7 --input=8 --input=9 \
    --input=10 --input=11 --input=12 --input=13 -o x.png
.png here :: render a.obj --input=f.txt -o x.txt
not '' :: info ''
one mesh :: info {a.obj b.obj|ico.obj ico.obj}
mesh :: {demo ico.obj|info|kernel --t 1 --source 0}
one time :: smooth ico.obj --t {1,2|auto:2}
--t takes one time >= 0 :: smooth ico.obj --t -1
.xyz here :: smooth ico.obj -o {x.txt|x.npy|x.png|x}
{--filter|--column|--no-header} is not an option of smooth :: smooth ico.obj {1}
natural or dirichlet :: smooth ico.obj --border mean
--log takes no --labels :: render ico.obj --input f.txt -o x.png --labels --log
takes no --labels :: render ico.obj --input f.txt -o x.png --labels {--range=0,1|--colormap=grey|--isolines=4}
--log takes --column 1 beside --nearest :: geodesic ico.obj --source 0,3 --nearest --log
--colormap takes --column 3 beside --nearest :: distance ico.obj --source 0,3 --t 1,2 --nearest --column 2 --colormap grey
--up takes x, y or z :: {kernel ico.obj --source 0 --t 1|render ico.obj} --up w
--labels is not an option of kernel :: kernel ico.obj --source 0 --t 1 --labels
takes no --quiet :: kernel ico.obj --source 0 --t 1 --quiet --verbose
--verbose is not an option :: info ico.obj --verbose
{--nosuch|-x|--input|--quiet} :: kernel ico.obj --source 0 --t 1 {1}=yes
{--t|--source|-o|--laplacian} :: kernel ico.obj {1}
--t :: {kernel ico.obj --source 0|spectrum ico.obj -k 3 --t 1}
--input :: {diffuse ico.obj --t 1|render ico.obj -o x.png|pairs ico.obj --t 1|levels ico.obj --levels 1}
-o :: render ico.obj --input f.txt
--count :: sample ico.obj --t 1
-k :: spectrum ico.obj
twice :: kernel ico.obj {--t 1 --t 2 --source 0|--t 1 --source 2 --source 0}
--degree :: kernel ico.obj --source 0 --t 1 --degree 1
{--method|--dry-run} is not an option :: info ico.obj {1}
--kernel :: distance ico.obj --t 1 --source 0 --kernel symmetric
--definition is not an option of hks :: hks ico.obj --t 1 --definition commute
natural or dirichlet :: info ico.obj --border neumann
--tufted :: {info --tufted=1 ico.obj|render --tufted ico.obj}
{--tufted|--intrinsic-delaunay} :: info quad.obj {1} --laplacian polygon
--tufted :: info cloud-300.xyz --tufted {--laplacian exp|--laplacian voronoi-exp|--laplacian polygon|--bandwidth 1|--lambda 1}
--weight-cut :: info cloud-300.xyz --tufted --weight-cut 1e-4
--lambda :: info quad.obj --lambda 1 --laplacian fem
--t takes :: kernel not-there.obj --t abc --source 0
{--degree|--poles} takes :: {kernel ico.obj --source 0|diffuse ico.obj --input f.txt} --t 1 --method {krylov|local} {1} {7|kernel}
--solver takes :: {kernel ico.obj --source 0|diffuse ico.obj --input f.txt} --t 1 --method {krylov|direct|local} --solver {cocg|lanczos}
--precond takes :: {kernel ico.obj --source 0|diffuse ico.obj --input f.txt} --t 1 --method {krylov|direct|local} --precond ildl
--ordering takes :: {kernel ico.obj --source 0|diffuse ico.obj --input f.txt} --t 1 --method iterative --ordering amd
--ordering takes :: {kernel ico.obj --source 0|diffuse ico.obj --input f.txt} --t 1 --solver minres --ordering dissection
--t :: {hks ico.obj|distance ico.obj --source 0|pairs ico.obj --input p.txt|sample ico.obj --count 2}
--method takes auto or direct :: {distance ico.obj --source 0|sample ico.obj --count 2} --definition {commute|biharmonic} \
    --method {krylov|iterative|local}
--method takes auto, direct or local :: {hks|trace|distance --source 0|sample --count 2} ico.obj --t 1 --method {krylov|iterative}
{--degree|--poles} takes :: {hks|trace|distance --source 0|sample --count 2} ico.obj --t 1 --method local {1} {7|kernel}
--solver :: {hks ico.obj|distance ico.obj --source 0|sample ico.obj --count 2} --t 1 --solver cocg
--degree takes :: {hks ico.obj|distance ico.obj --source 0|pairs ico.obj --input p.txt|sample ico.obj --count 2} --t 1 --degree 1 \
    {--poles kernel|}
--definition takes :: {distance ico.obj --source 0|pairs ico.obj --input p.txt|sample ico.obj --count 2} --t 1 --definition paper
--t takes --definition :: {distance ico.obj --source 0|pairs ico.obj --input p.txt|sample ico.obj --count 2} --t 1 \
    --definition {commute|biharmonic}
{--poles|--degree|--method} takes :: {distance ico.obj --source 0|pairs ico.obj --input p.txt|sample ico.obj --count 2} \
    --definition {commute|biharmonic} {1} {kernel|8|krylov}
""")
# Names that are misspelled, and what is meant; ?: nothing.
MEANT = """--sorce source --tt t --thraeds threads --laplace laplacian --iso isolines --outptu output --precnod precond -source source
-t t --Source=0 source --xyzzy ? -y ? --input-file-of-mine ? --no ? kernle kernel difuse diffuse dist distance geodesics geodesic
Spectrum spectrum smoth smooth rendr render nosuch ? x ? """.split()
# What is right, although it looks much like the above.
TAKEN = table("""
kernel ico.obj --source 0 --t 1 --degree 1 --poles uniform
kernel ico.obj --source 0 --t 1 --method direct {--degree 9 --poles kernel|--ordering amd}
kernel ico.obj --source 0 --t 1 --method {krylov|local} {--ordering dissection|--tol 1e-6}
kernel ico.obj --source 0 --t 1 {--ordering amd|--method auto --solver minres|--method iterative --ordering auto|--simd none}
kernel {patch-9.off|ico.obj} --source 0 --t {auto:1,2h2|auto:17}
diffuse ico.obj --t 1 --input ones-12.txt --degree 1 --method direct
pairs ico.obj --input p.txt --t 1 --method {krylov|local}
{hks|hks --kernel operator|hks --normalise|trace|distance --source 0,1} ico.obj --t 1,2 --method local {|--ordering amd}
sample ico.obj --count 2 --t 1 --method local {|--definition weighted --source 0,1}
{sample ico.obj --count 2|geodesic ico.obj --source 0|smooth ico.obj} --t {1|auto:1}
smooth ico.obj {|--degree 1|-o -|--t 0.1/l1 --method krylov|--method local|--t 0|--tufted --laplacian voronoi-cot|--dry-run}
{hks ico.obj|distance ico.obj --source 0|pairs ico.obj --input p.txt|sample ico.obj --count 2} --t 1 --poles uniform --degree 1
info {book.obj --lambda 2 --laplacian polygon|quad.obj --lambda 2}
sample ico.obj --count 2 --t 1 --source {0:0.2,0.3,1,2|0+1,2+3,4+5 --curve|0,1,2 --source-file one.txt}
""")         # the sources of sample may be more than its count where they are no vertices


class Usage(Case):
    def test_values(self):
        for line, option, values in VALUES:
            for value in shlex.split(values):
                for form in ((option + "=" + value,), (option, value)):
                    self.bad(2, option + " takes", line, *form)

    def test_lines(self):
        for text, line in USAGE:
            with self.subTest(line):
                self.bad(2, text, line)

    def test_lines_that_are_right(self):
        file("p.txt", "0 1\n2 3\n")
        file("one.txt", "3\n")
        for line, in TAKEN:
            self.good(line)

    def test_extensions(self):
        """Of files that no command writes, or not this one."""
        for name in ("x", "x.foo", "x.npy.gz", "png", ".npyx", "x."):
            text = self.bad(2, ".txt", KERNEL, "-o", name)
            for e in (".csv", ".npy", ".ply", ".obj", ".vtu", ".png"):
                self.assertIn(e, text)
        for run in (PAIRS + "--t 1", "sample ico.obj --count 2 --t 1"):
            for e in ("ply", "obj", "vtu", "png", "foo"):
                self.assertNotIn(".vtu or", self.bad(2, ".npy", run, "-o", "x." + e))

    def test_commands(self):
        for line in ("", "nosuch", "nosuch ico.obj", "Kernel ico.obj", "''"):
            text = self.bad(2, "", line)
            for name in COMMANDS:
                self.assertIn(name, text)

    def test_what_is_meant(self):
        for word, meant in zip(MEANT[::2], MEANT[1::2]):
            text = self.bad(2, "is not a", *((KERNEL + word + " 0",) if word[0] == "-" else (word + " ico.obj",)))
            self.assertEqual(re.findall(r"did you mean -?-?(\w+)\?", text), [meant] * (meant != "?"), word)

    def test_help_and_version(self):
        for line in ("--help", "-h"):
            p = self.good(line)
            self.assertIn(b"kernel", p.stdout)
            self.assertEqual(p.stderr, b"")
        for command in ("",) + COMMANDS:
            text = self.good(command + " --help").stdout.decode()
            self.assertIn("\nOutput\n" if command else "OBJ", text)
            for name in (command,) + (("OBJ", "OFF", "PLY", "STL", "XYZ") if command in ("", "kernel", "info", "render")
                                      else ()) + \
                    (("--no-header",) if command not in ("", "info", "render", "demo", "smooth") else ()):
                self.assertIn(name, text)
            if command:
                self.assertEqual(self.good(command + " -h").stdout.decode(), text)
        text = self.good("kernel --help").stdout.decode()
        for option, values in (("method", "direct krylov iterative local auto"), ("ordering", "amd dissection auto"),
                               ("simd", "none avx2 avx512 auto")):
            part = text[text.index("--" + option):].split("\n      --")[0]
            for value in values.split():
                self.assertIn(value, part)
        with open(os.path.join(HERE, "..", "heatdiff.h"), encoding="utf-8") as f:
            header = dict(re.findall(r"^#define HD_VERSION_(MAJOR|MINOR|PATCH) (\d+)$", f.read(), re.M))
        self.assertEqual(self.good("--version").stdout.decode(), "heatdiff %(MAJOR)s.%(MINOR)s.%(PATCH)s\n" % header)

    def test_both_forms_and_any_order(self):
        for want, *same in (("kernel ico.obj --source 1 --t 2h2", "kernel --t=2h2 --source=1 ico.obj",
                             "kernel --quiet --t=2h2 --source=1 -- ico.obj",
                             "kernel --t=+2h2 --source +1 ico.obj"),
                             ("kernel ico.obj --source=0 --t=.5", "kernel ico.obj --source=0:1,0 --t=0.5")):
            for line in same:
                self.assertEqual(numbers(self.good(line).stdout), self.rows(want))

    def test_fuzz(self):
        rnd = random.Random(7)
        pool = ["kernel", "info", "diffuse", "render", "hks", "--definition", "--definition=commute", "--count=3",
                "--poles=kernel", "--t",
                "--t=", "--t=1h2", "--t=auto:2", "--source", "--source=0", "--source=0,0", "--degree", "5", "-1", "nan",
                "--json", "--quiet", "-o",
                "-", "--", "---", "--=", "-=", "=", "--t==1", "fem", "--laplacian=cot", "--poles=kernel", "1,2", "%s%n", "%n",
                "\u00e9", "\n",
                "x" * 3000, "--" + "y" * 3000, "--source=" + "9" * 50, "--source=" + "1," * 200, "--size=64x64", "--range=0,1",
                "--isolines=3",
                "--tol=1e-3", "--threads=2", "--input", "--max-iterations=1", "--memory-limit=1", "fuzz.obj", "fuzz.obj",
                "fuzz.obj"]
        file("fuzz.obj", ICO)
        for _ in range(250):
            args = [rnd.choice(COMMANDS[:-1])] + [rnd.choice(pool) for _ in range(rnd.randrange(7))]
            p = self.run_tool("", *args, input=b"0 1\n", timeout=60)
            self.assertIn(p.returncode, (0, 1, 2), (args, p.stderr))
            if p.returncode:
                self.assertEqual((p.stderr.count(b"heatdiff: error: "), p.stderr.count(b"\n")), (1, 1), (args, p.stderr))


# ---- input that is wrong ----

like = re.compile
ICO = obj_text(*icosahedron())
NPY = npy_bytes([[1.0]] * 12)
TWELVE = ["%d 1\n" % i for i in range(12)]
NOISE = bytes(random.Random(1).randrange(256) for _ in range(4000))
SIDES = sides(*patch(7))


def with_row_7(x):
    """Lengths of edges, one of them changed."""
    return "# lengths\n" + lines_of(SIDES[:7] + [[SIDES[7][0], x, SIDES[7][2]]] + SIDES[8:])


# Runs that fail: what is told, with .* for anything between, and the line.
FAILED = table(r"""
12 vertices :: kernel ico.obj --t 1 --source {12|10000000|1000000000000000000|1000000000000000000000000000000|0,12}
12 vertices :: {distance ico.obj --source 0,12 --t 1|sample ico.obj --count 3 --source 12 --t 1}
--source 12 :: geodesic ico.obj --source 0,12
--count :: sample ico.obj --count 13 --t 1
19 vertices :: sample pieces.obj --count 20 --t 1
beyond :: spectrum ico.obj -k 13
2000000000 is beyond :: {spectrum ico.obj -k|sample ico.obj --t 1 --count} 2000000000
1000000000000 is beyond :: sample ico.obj --t 1 --count 3 --source 1000000000000
3 is beyond.* 3 faces :: kernel roof.obj --t 0.1 --source 3:0.1,0.2
6 is beyond.* 6 vertices :: kernel roof.obj --t 0.1 --source 1+6
2 is no triangle :: kernel roof.obj --t 0.1 --source 2:0.1,0.2
source 0: .*weight :: kernel roof.obj --t 0.1 --source 0*1
one point :: kernel roof.obj --t 0.1 --source 1 --curve
source 0 has one point :: sample roof.obj --t 1 --count 1 --curve --source 1,2
source 0 :: geodesic roof.obj --curve --source 0,0+5
source 0, point .*no face :: geodesic roof.obj --curve --source 0+5,0+1
source 1, point 1.*no face :: geodesic roof.obj --curve --source 0+1,0+2+4
not-there :: {kernel ico.obj --t 1 --source-file|diffuse ico.obj --t 1 --input|pairs ico.obj --t 1 --input} not-there
not-there :: render ico.obj not-there.obj --input count-12.txt --input count-12.txt -o x.png
No such file :: info squashed.obj --lengths none.txt
--column 2 :: {render ico.obj --input waves-12-2.txt -o c.png|geodesic ico.obj --source 0,9,5 --nearest} --column 2
--column 9 :: spectrum ico.obj -k 3 --column 9 -o s.png
2 columns :: kernel ico.obj --source 0,1 --t 1 --column 2 -o r.png
--column 1 :: levels ico.obj --input count-12.txt --levels 1 --column 1
rows :: render patch-9.off ico.obj --input count-100.txt --input count-100.txt -o x.png
count-12.txt :: render ico.obj --input waves-12-2.txt --input count-12.txt --column 1 -o x.png
count-12.txt :: levels quads-2-2.obj --input count-12.txt --levels 1
one value :: levels ico.obj --input ones-12.txt --levels auto:2
.stl needs faces :: smooth cloud-300.xyz -o x.stl
.xyz is for points :: smooth ico.obj -o x.xyz
--border dirichlet needs faces :: smooth cloud-300.xyz --border dirichlet
faces :: levels ico.xyz --input count-12.txt --levels 1
the time 1e+308h2 is too large for h :: kernel ico.obj --source 0 --t 1e308h2
is too far above the first :: hks ico.obj --scale-invariant 2 --t 1e-300,1e300
is not above the first :: hks ico.obj --scale-invariant 2 --t 2,1
--filter {heat:1e-300|heat:1e308|band:1,1.0000001}: the best poles found miss it by :: kernel ico.obj --source 0 --filter {1}
--memory-limit :: kernel patch-9.off --source 0 --t 10h2 --memory-limit 2000
limit :: geodesic patch-9.off --source 0 --memory-limit 20K
limit :: {hks patch-9.off|distance patch-9.off --source 0|sample patch-9.off --count 2} --t 1 --memory-limit 3000 -o x.npy
iterations :: kernel patch-9.off --source 0 --t {1000h2|9h2,1000h2} --solver cocg --precond none --max-iterations 2
iterations :: pairs patch-9.off --input p.txt --t 1000h2,2000h2 --solver cocg --precond none --max-iterations 2
more than the memory limit :: kernel torus-60-40.xyz --source 0 --t 1 --laplacian exp --memory-limit 100K
--tufted needs less :: kernel torus-60-40.xyz --source 0 --t 1 --weight-cut 1e-3 --memory-limit 100K
--border dirichlet needs faces :: info ico.xyz --border dirichlet
faces :: geodesic cloud-300.xyz --source 0 --border mean
mean border :: geodesic patch-9.off --border dirichlet --source 0
--lengths needs faces :: info ico.xyz --lengths ones-12.txt
face 0: --lengths takes triangles, and it has 4 corners :: info quad.obj --lengths ones-1-3.txt
--tufted :: info cloud-300.xyz --intrinsic-delaunay
{fem|cot|voronoi-cot} :: kernel cloud-300.xyz --source 0 --t 1 --laplacian {1}
--lambda :: info cloud-300.xyz --lambda 1
--lambda.*polygon :: {info book.obj|kernel book.obj --source 0 --t 1h2} --lambda 2
bandwidth :: info ico.obj --bandwidth 1
--weight-cut :: info ico.obj --weight-cut 1e-4
no vertex :: kernel line.xyz --source 0 --t 1
. :: kernel . --source 0 --t 1
cannot write :: kernel ico.obj --source 0 --t 1 -o no/such/folder/x.txt
""")

# Files that are wrong: a command line, the name behind it, and what the file holds with what is told behind its name.
FILES = (
    ("kernel --source 0 --t 1h2 -o out.txt", "bad.obj", (
        (ICO + "f 1 2 999\n", ":33"), (ICO.replace("v ", "v nan ", 1), ":1"), ("v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", ":3"), ("", ""),
        ("# nothing here\n", ""), (NOISE, ""), ("v 0 0 0\nv 1 0 0\nv 2 0 0\n", ""), ("v 0 0 0\nv 0 0 0\n", ""))),
    ("kernel --source 0 --t 1e308/l1", "long.obj", (("v 0 0 0\nv 9 0 0\nv 9 9 0\nf 1 2 3\n", like("the time 1e.308/l1 is too large")),)),
    *(("kernel --source 0 --t 1 --laplacian " + kind, "huge.obj", (   # the faces of the file are counted, not its triangles
        ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1e90 0 0\nv 0 1e90 0\nf 1 2 3 4\nf 1 5 6\n", like("face 1: ")),))
      for kind in ("fem", "polygon")),
    ("diffuse ico.obj --t 1 -o out.txt --input", "f.txt", (
        ("".join(TWELVE[:11]), like(r"f\.txt.*11.*12")), ("".join(TWELVE) + "3 3\n", like(r"f\.txt.*13.*12")), ("", ""),
        ("".join(TWELVE[:2] + ["1 zwei\n"] + TWELVE[3:]), ":3"), ("".join(TWELVE[:4] + ["1\n"] + TWELVE[5:]), ":5"),
        ("".join(TWELVE[:4] + ["1 nan\n"] + TWELVE[5:]), ""), *(("1\n" * 11 + x, like("inf.* not a finite number")) for x in ("inf", "-inf")))),
    ("diffuse ico.obj --t 1 --input", "f.npy", (
        (npy_bytes([[1.0]] * 11), ""), (NPY[:-3], ""), (NPY.replace(b"<f8", b"<c8"), ""), (NPY[:9], ""))),
    *(("diffuse ico.obj --t 0.2,0.3 --method %s --input" % method, "signs.txt", (
        ([[1.7e308 * s] for s in (1, -1, 1, 1, 1, -1, 1, -1, 1, 1, -1, -1)], like("leaves the range of doubles")),))
      for method in ("direct", "krylov")),
    ("render ico.obj -o p.png --input", "p.txt", (("1\n" * 11 + "info\n", ":12"),)),
    ("pairs ico.obj --t 1 -o out.txt --input", "p.txt", (
        ("0 1\n2 12\n", like(r"p\.txt:2: 12 .*12")), ("# ids\n0 1\n-1 2\n", ":3"), ("0.5 1\n", ":1"), ("1e30 1\n", ":1"),
        ("0 1\n3 four\n", ":2"), ("0 1\n3\n", ":2"), ("0\n1\n", ""), ("0 1 2\n", ""), ("", ""))),
    ("pairs ico.obj --t 1 --input", "p.npy", ((npy_bytes([[0.0, 12.0]]), ""),)),
    ("kernel roof.obj --t 0.1 --source-file", "s.txt", (
        ("1\n0:0.5\n", like(r"s\.txt:2.*0:0\.5")), ("1\n\n12\n", like(r"s\.txt:3.*12")), ("# nothing\n", like("no point")))),
    ("geodesic ico.obj --curve --source-file", "far.txt", (("0\n3\n", ":"),)),
    ("info squashed.obj --lengths", "l.txt", (
        ("1 1\n" * 98, like("2 columns; a face has three edges")), (SIDES[1:], like("97 rows, but squashed.obj has 98 faces")),
        # the comment is line 1; an edge has two faces, and the later one is told
        (with_row_7(5.0), ":9: face 7: a side of a face is longer than the two others together: "), (with_row_7(math.nan), ":9: "),
        (with_row_7(-0.1), ":9: face 7: a length is negative: -"),
        (with_row_7(1.01 * SIDES[7][1]), like(r"l\.txt:\d+: face \d+: .*give their edge different lengths")))),
    ("info squashed.obj --lengths", "l.npy", (
        (npy_bytes([(1.0, 1.0, 3.0)] + SIDES[1:]), ": face 0: a side of a face is longer"),
        (npy_bytes([(1.0, 1.0, math.nan)] + SIDES[1:]), ": row 0, column 2: nan is not a finite number"))),
)

# Files that promise much, or never end a line; told in few words, in little memory and time.
HUGE = 1 << 60
MANY = 8 << 20
PLY = ("ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\nelement face %d\n"
       "property list %s int vertex_indices\nend_header\n")
HOSTILE_MESHES = (
    ("n.off", "OFF\n%d 1 0\n0 0 0\n" % HUGE), ("f.off", "OFF\n1 %d 0\n0 0 0\n" % HUGE),
    ("k.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n%d 0 1 2\n" % HUGE),
    ("m.off", "OFF\n2147483647 2147483647 0\n0 0 0\n"), ("a.ply", PLY % ("ascii", HUGE, HUGE, "uchar")),
    ("b.ply", PLY % ("binary_little_endian", HUGE, HUGE, "uchar") + "\0" * 40),
    ("c.ply", PLY % ("binary_big_endian", 2 ** 31 - 1, 1, "uchar") + "\0" * 40),
    ("d.ply", (PLY % ("binary_little_endian", 1, 1, "uint")).encode() + b"\0" * 12 + b"\xff" * 8),
    ("a.stl", b"x" * 80 + b"\xff" * 4 + b"y" * 50),
    ("points.xyz", "%d\n0 0 0\n" % HUGE), ("zero.obj", b"v 0 0 0\n\0v 1 0 0\nv 0 1 0\nf 1 2 3\n"), ("zeros.obj", b"\0" * 100000),
    ("minus.obj", "v 0 0 0\nf -9223372036854775808 -9223372036854775808 99999999999999999999\n"),
)
HOSTILE_FIELDS = (("h.txt", b"\x93NUMPY\x02\0\xff\xff\xff\xff{"), ("h.txt", b"0\0" * 12))
# How a file begins, and what follows without an end: none is gone through again for each of its bytes.
ENDLESS_MESHES = (
    ("digits.obj", b"v ", b"1"), ("corners.obj", b"f ", b"1 "), ("word.obj", b"v ", b"x"), ("blank.obj", b"", b" "),
    ("zero.obj", b"", b"v 0 0 0\0"),
    ("word.ply", b"ply\nformat ascii 1.0\nelement ", b"x"), ("comment.ply", b"ply\ncomment ", b"x"),
    ("name.stl", b"solid ", b"x"), ("digits.off", b"OFF\n1 1 0 ", b"1"), ("digits.xyz", b"0 0 ", b"1"))
ENDLESS_FIELDS = (
    ("names.csv", b"", b"a,"), ("commas.csv", b"", b","), ("quotes.csv", b"", b'"'), ("open.csv", b'"', b"x"),
    ("quoted.csv", b"", b'"a",'), ("h.txt", b"", b"1 "), ("h.txt", b"", b"1"))
ENDLESS_PLACES = (
    ("places.txt", b"", b"1"), ("places.txt", b"# ", b"x"), ("places.txt", b"", b"\0"), ("places.txt", b"", b"0.5*"),
    ("places.txt", b"0:0.", b"1"))
HOSTILE_SHAPES = (
    ("(%d, 16)" % HUGE, "1152921504606846976 x 16 numbers"), ("(12, %d)" % HUGE, "1152921504606846976 columns"),
    ("(%d, %d)" % (1 << 32, 1 << 32), "4294967296 columns"),
    ("(4294967296,)", "4294967296 x 1 numbers"), ("(%d, 16)" % 10 ** 16, "10000000000000000 x 16 numbers"),
    ("(%d,)" % 10 ** 30, "announces 1" + "0" * 30),
    ("(12, 1" + "0" * 60000 + ")", "announces 1000"), ("(-1, 12)", "shape"), ("(" * 60000, "shape"),
    ("(12" + ", 1" * 20000 + ")", "20001 dimensions"), ("(12\0, 1)", "shape"),
)
HOSTILE_PLACES = (
    (b"# " + b"3 " * 200 + b"\n12\n", "places.txt:2: 12 is beyond"), (b"1\n2\0\n", "places.txt:2: '?' is no point"),
    (b"3" + b" " * 300 + b"4\n", "places.txt:1: '4' is no point"),
)


def small(extension):
    """Pictures that are soon drawn."""
    return ("--size", "64x64") if extension == "png" else ()


def limits(memory=None, file_size=None):
    """What sets limits before the tool runs. The hard limit of files stays."""
    def limit():
        import resource
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        if file_size:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    return limit


class Failures(Case):
    def test_lines(self):
        file("p.txt", "0 1\n")
        for text, line in FAILED:
            with self.subTest(line):
                self.bad(1, like(re.escape(text).replace(r"\.\*", ".*")), line)
        self.bad(1, "1089000000 columns are too many", "kernel ico.obj --source %s --t %s" % (",".join(["0"] * 33000),
            ",".join(["auto:1000"] * 33)))

    def test_files(self):
        for line, name, rows in FILES:
            for content, told in rows:
                with self.subTest(line, told=told):
                    self.bad(1, name + told if isinstance(told, str) else told, line, file(name, content))

    def test_meshes_of_every_command(self):
        """A mesh that is not there, and one that no heat can be on."""
        file("p.txt", "0 1\n")
        for line in ("kernel --source 0 --t 1", "diffuse --input count-3.txt --t 1", "smooth -o x.obj", "distance --source 0 --t 1", "hks --t 1",
                     "pairs --input p.txt --t 1",
                     "trace --t 1", "sample --count 1 --t 1", "geodesic --source 0", "spectrum -k 1",
                     "levels --input count-3.txt --levels 1",
                     "render --input count-3.txt -o r.png", "info"):
            self.bad(1, "not-there.obj: cannot open", line, "not-there.obj")
            if not line.startswith(("levels", "render", "info")):
                self.bad(1, "", line, "line.obj")

    def test_every_cut_of_a_mesh(self):
        whole = off_text(*icosahedron())
        for k in range(0, len(whole), 37):
            self.assertIn(self.run_tool("info --quiet", file("cut.off", whole[:k])).returncode, (0, 1), k)

    def test_overflow_is_no_nan(self):
        file("big.txt", "1\n" * 4 + "1.7e308\n-1.7e308\n" * 4)
        self.assertNotIn(b"nan", self.run_tool("diffuse ico.obj --input big.txt --t 1e-9 --method direct").stderr)
        self.assertEqual(len(self.rows("hks ico.obj --scale-invariant 40 --t 1,2")[0]), 40)

    def test_existing_output_survives(self):
        for name in ("keep.txt", "keep.png", "keep.vtu"):
            self.bad(1, "", "kernel patch-9.off --source 0 --t 10h2 --memory-limit 2000 -o", name, files={name: "precious"})
            self.bad(1, "", "kernel not-there.obj --source 0 --t 10h2 -o", name)
            self.assertEqual(taken(name), b"precious")

    def test_input_is_the_output(self):
        """The input is read whole before the output takes its place."""
        for name, line, read in (("same.txt", "diffuse ico.obj --t 1h2 --input same.txt", numbers),
                                 ("same.npy", "diffuse ico.obj --t 1h2 --input same.npy", read_npy),
                                 ("same.obj", "kernel same.obj --source 0 --t 1h2", None)):
            rows = [[math.sin(i)] for i in range(12)]
            file(name, npy_bytes(rows) if name.endswith("npy") else ICO if name.endswith("obj") else rows)
            want = self.rows(line)
            self.good(line, "-o", name)
            self.assertEqual(self.rows(line) if read is None else read(taken(name)), want)

    def test_two_at_once(self):
        """Runs that write the same output at the same time: it is one of theirs, whole."""
        for name in ("once.ply", "once.npy"):
            line = "kernel patch-9.off --t 1h2 --quiet --source"
            wants = [self.data(name, line, source) for source in (0, 55)]
            before = everything()
            runs = [subprocess.Popen([TOOL] + words(line, 55 * (i % 2), "-o", name), cwd=FOLDER, stderr=subprocess.PIPE)
                    for i in range(12)]
            for p in runs:
                self.assertEqual((p.communicate(timeout=60)[1], p.returncode), (b"", 0))
            self.assertIn(taken(name), wants)
            self.assertEqual(everything(), before)

    @unittest.skipUnless(os.path.exists("/dev/stdout"), "needs /dev/stdout")
    def test_standard_streams(self):
        line = "kernel %s --source 0 --t 1 --quiet"
        want = self.good(line % "ico.obj").stdout
        self.assertEqual(self.good(line % "-", "-o", "/dev/stdout", input=ICO.encode()).stdout, want)
        with open(path("stdout.txt"), "wb") as out:
            for mesh in ("/dev/stdin", "-"):
                with open(path("ico.obj"), "rb") as f:
                    self.good(line % mesh, "-o", "-", stdin=f, stdout=out)
        self.assertEqual(taken("stdout.txt"), 2 * want)
        self.assertEqual(read_png(self.good("render ico.obj --input count-12.txt --size 80x64 -o -").stdout)[:2], (80, 64))
        self.assertEqual(self.good(line % "-", input=off_text(*icosahedron()).encode()).stdout, want)
        self.bad(1, "<stdin>:1: a vertex needs 3 coordinates", "info -", input=b"v 1 2\n")

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs /dev/full")
    def test_full_device(self):
        with open("/dev/full", "wb") as full:
            self.bad(1, "cannot write", KERNEL, "--quiet", stdout=full)
        for more in ("", "--kernel symmetric"):
            self.bad(1, "/dev/full", KERNEL + more + " -o /dev/full")


@unittest.skipUnless(POSIX, "needs limits, links and names of bytes")
class Hostile(Case):
    def hostile(self, want, line, *more, memory=False, limit=limits(1 << 30), **options):
        """Runs what must fail in few words, in little memory and time. memory: lack of it is told."""
        text = self.bad(1, want, line, *more, preexec_fn=limit, timeout=60, **options)
        self.assertLess(len(text), 600)
        self.assertEqual("memory" in text, memory, text)

    def test_contents(self):
        for line, whole, endless in (("info", HOSTILE_MESHES, ENDLESS_MESHES),
                                     ("diffuse ico.obj --t 1 --input", HOSTILE_FIELDS, ENDLESS_FIELDS),
                                     ("kernel ico.obj --t 1 --source-file", (), ENDLESS_PLACES)):
            for name, start, *unit in whole + endless:
                self.hostile(name, line, file(name, start + unit[0] * (MANY // len(unit[0])) if unit else start))
                os.remove(path(name))
        for content, text in HOSTILE_PLACES:
            self.hostile(text, "kernel ico.obj --t 1 --source-file", file("places.txt", content))

    def test_devices(self):
        for device in ("/dev/zero", "/dev/urandom", "/dev/full", "/dev/null"):
            if os.path.exists(device):
                self.hostile(device, "info", device)
        for name, text in (("/dev/zero", "a device that has no end"), (FOLDER, "cannot read"), ("/dev/null", "no point")):
            self.hostile(text, "kernel ico.obj --t 1 --source-file", name)
        with open("/dev/zero", "rb") as zeros:                   # what never ends is read up to the memory that there is
            for line in ("info -", "diffuse ico.obj --input - --t 1"):
                self.hostile("", line, stdin=zeros, memory=True, limit=limits(1 << 28))

    def test_heads_of_npy(self):
        start = b"{'descr': '<f8', 'fortran_order': False, 'shape': "
        heads = [(start + shape.encode() + b", }\n", like(r"h\.npy: .*" + text)) for shape, text in HOSTILE_SHAPES]
        heads += [(head, "h.npy: the type of its numbers") for head in (b"(" * 60000, b"{'descr': " * 6000, b"[[" * 30000,
            b"{" * 60000)]
        for head, text in heads:
            file("h.npy", b"\x93NUMPY\x01\0" + struct.pack("<H", len(head)) + head + b"\0" * 96)
            self.hostile(text, "diffuse ico.obj --input h.npy --t 1")

    def test_file_size_limit(self):
        """A limit of the file's size is told as a full disk is, for each command and each kind of file that it writes."""
        file("p.txt", "0 1\n2 3\n")
        fields = "txt csv npy ply obj vtu png"
        for line, kinds in (("diffuse ico.obj --input count-12.txt --t 1", fields),
                            ("distance ico.obj --source 0 --t 1", fields), (PAIRS + "--t 1", "txt csv npy"),
                            ("hks ico.obj --t 1", fields), ("trace ico.obj --t 1", "txt csv npy"),
                            ("sample ico.obj --t 1 --count 3", "txt csv npy"),
                            ("geodesic ico.obj --source 0", fields), ("spectrum ico.obj --count 3", fields),
                            ("render ico.obj --input count-12.txt", "png"), ("smooth ico.obj", "obj off ply stl vtu"),
                            ("levels ico.obj --input count-12.txt --levels auto:3", "txt csv npy obj")):
            for kind in kinds.split():
                self.hostile("over.%s: cannot write: " % kind, line, "--quiet", *small(kind), "-o", "over." + kind,
                             limit=limits(1 << 30, 10))
        for kind in fields.split():                              # files that are larger than the buffer
            self.hostile("over.%s: cannot write: " % kind, "kernel torus-60-40.obj --source 0 --t 1h2,2h2 --quiet", *small(kind),
                         "-o", "over." + kind, limit=limits(None, 1000))

    def test_outputs_that_cannot_be(self):
        """A folder nobody may write to, a folder in place of the file, a link to itself, a file in place of the folder."""
        os.mkdir(path("locked"), 0o555)
        os.mkdir(path("folder.txt"))
        os.symlink(path("loop.txt"), path("loop.txt"))
        os.chmod(FOLDER, 0o755)

        def nobody():
            if os.getuid() == 0:
                os.setuid(65534)
        try:
            runnable = subprocess.run([TOOL, "--version"], preexec_fn=nobody, stdout=subprocess.DEVNULL).returncode == 0
        except (OSError, subprocess.SubprocessError):
            runnable = False                     # the tool is where only root may look
        if runnable:
            self.hostile("cannot write", KERNEL, "-o", "locked/x.txt", limit=nobody)
        for out in ("loop.txt", "folder.txt", "ico.obj/x.txt", "no/such/folder/x.txt"):
            self.hostile("cannot write", KERNEL, "-o", out)
        self.assertEqual(os.listdir(path("locked")) + os.listdir(path("folder.txt")), [])
        self.hostile("cannot open", "info loop.txt")
        os.remove(path("loop.txt"))
        os.rmdir(path("locked"))
        os.rmdir(path("folder.txt"))

    def test_links(self):
        """A link is replaced by the file, and what it pointed at stays."""
        file("pointed-at.txt", "precious")
        for to in ("pointed-at.txt", "no/folder/x.txt"):
            os.symlink(path(to), path("link.txt"))
            self.good(KERNEL, "-o", "link.txt")
            self.assertFalse(os.path.islink(path("link.txt")))
            self.assertEqual(len(numbers(taken("link.txt"))), 12)
        self.assertEqual(taken("pointed-at.txt"), b"precious")

    def test_odd_names(self):
        """Names of files with line ends, quotes and bytes that are no text: read, written, told in one line and in JSON."""
        def run(*args):
            return subprocess.run([os.fsencode(TOOL), *args], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, timeout=60)
        kernel, folder = (b"--source", b"0", b"--t", b"1"), os.fsencode(FOLDER) + b"/"
        for name in (b"a \"b\" \\ \xc3\xa9 \t", b"a\nb", b"'\"$(x)`%s%n", b"-o", "\u00e9\u20ac\U0001d11e".encode(),
                     b"\x01\x1b[2J\x7f",
                     b"\xff\xc3(\xe0\x80\x80\xf0\x80\x80\x80\xed\xa0\x80\xf4\x90\x80\x80\xc0\xf8",
                     b"\xff\xe0\xa0\x80\xed\x9f\xbf\xf4\x8f\xbf\xbf\xe1\x80\x80"):
            mesh, out = folder + name + b".obj", folder + name + b".vtu"
            try:
                with open(mesh, "w") as f:
                    f.write(ICO)
            except OSError:
                continue                         # some file systems take text alone
            p = run(b"kernel", mesh, *kernel, b"--json", b"-o", out)
            self.assertEqual(p.returncode, 0, p.stderr)
            told = json.loads(p.stderr)["mesh"]
            self.assertTrue(b"\xff" in name or told == mesh.decode(), told)
            with open(out, "rb") as f:
                self.assertEqual(counted(f.read()), (12, 20))
            for args in ((b"kernel", mesh, b"--source", b"99", b"--t", b"1"), (b"info", mesh + b".off"),
                         (b"kernel", mesh, *kernel, b"-o", out + b"/x.txt"),
                         (b"info", mesh, b"--" + name), (name, mesh), (b"info", b"--", name)):
                p = run(*args)
                self.assertIn(p.returncode, (1, 2), args)
                self.assertRegex(p.stderr, b"^heatdiff: error: [^\n\x01\x1b\x7f]*\n$")
            os.remove(mesh)
            os.remove(out)

    def test_long_names(self):
        for e in FIELD_FILES:
            for size in (250, 255):
                self.data("x" * (size - len(e) - 1) + "." + e, KERNEL, *small(e))

    def test_nobody_reads_standard_output(self):
        """A closed pipe ends the run without a word, or with one where SIGPIPE is ignored; a closed descriptor is told."""
        error = like(rb"^heatdiff: error: [^\n]*cannot write: [^\n]*\n$")
        for line in ("kernel patch-9.off --source 0 --t 1 --quiet", "info patch-9.off", "--help"):
            for restore, code, text in ((True, -signal.SIGPIPE, like(b"^$")), (False, 1, error)):
                read, write = os.pipe()
                os.close(read)
                p = self.run_tool(line, stdout=write, restore_signals=restore)
                os.close(write)
                self.assertEqual(p.returncode, code)
                self.assertRegex(p.stderr, text)
            p = self.run_tool(line, stdout=None, preexec_fn=lambda: os.close(1))
            self.assertEqual(p.returncode, 1)
            self.assertRegex(p.stderr, error)


class Memory(Case):
    """Each place of the tool that allocates memory finds none, once: one line says so, and nothing is left behind."""

    RUNS = (
        "info ico.obj", "kernel ico.obj --source 0 --t 1h2,auto:2 -o x.png --size 64x64",
        "kernel ico.off --source 0,1:0.2,0.3 --t 1h2 -o x.vtu",
        "diffuse ico.ply --input count-12.npy --t 1h2,3h2 -o x.ply", "smooth patch-4.off --border dirichlet -o x.off",
        "smooth cloud-300.xyz -o x.xyz",
        "kernel ico.stl --source 0,3 --t 4,1,3 --method krylov -o x.csv",
        "distance ico.stl --source 0,3 --t 1 --matrix -o x.csv",
        "distance ico.obj --source-file spots.txt --t 1 --nearest -o x.obj",
        "pairs ico.obj --input p.txt --t 1 -o x.npy", "pairs ico.obj --input p.txt --t 1 --dry-run",
        "hks ico.obj --filter wave:1,1 -o x.txt",
        "hks ico.obj --filter fractional:1,0.5 -o x.txt", "hks ico.xyz --bandwidth 1h2 --t 1,2 --scale-invariant 2 -o x.txt",
        "trace ico.obj --t 1/l1",
        "sample ico.obj --t 1 --count 3 -o x.csv", "geodesic ico.obj --source 0 -o x.txt --json",
        "geodesic ico.obj --lengths lengths.txt --source 0:0.3,0.3 --dry-run", "spectrum ico.obj -k 3 -o x.csv",
        "levels ico.obj --input count-12.npy --levels auto:12 -o x.obj",
        "levels ico.obj --input count-12.npy --levels 1,2 -o x.csv",
        "render ico.obj --input count-12.npy --input pairs.csv -o x.png --size 128x64")

    def preload(self):
        """Builds the library that lets one allocation fail. Without a compiler, or a way to preload it, there is no test."""
        self.library = path("starve.so")
        command = [os.environ.get("CC", "cc"), "-O1", "-w", "-shared", "-fPIC", os.path.join(HERE, "starve.c"), "-o",
                   self.library, "-ldl"]
        try:
            built = subprocess.run(command, stderr=subprocess.DEVNULL).returncode == 0
        except OSError:
            built = False
        if not built or self.starved("--version", STARVE_LIST=path("list.txt"))[0] or not os.path.exists(path("list.txt")):
            absent("nothing can be preloaded here")

    def starved(self, line, **environment):
        """The exit status, what was told, and what was written."""
        p = self.run_tool(line, env=dict(os.environ, LD_PRELOAD=self.library, **environment), timeout=60)
        out = re.search(" -o (x[.][a-z]+)", line)
        return p.returncode, p.stderr.decode(), p.stdout + (taken(out[1]) if out and os.path.exists(path(out[1])) else b"")

    def test_every_allocation(self):
        self.preload()
        for name, content in (("pairs.csv", "i,j\n" + "0,1\n2,3\n" * 6), ("p.txt", "0 1\n2 3\n"),
                              ("spots.txt", "0:0.2,0.3\n" * 17), ("lengths.txt", "2 2 2\n" * 20)):
            file(name, content)
        seen, refused = set(), 0
        for line in self.RUNS:
            line += "" if line.startswith(("levels", "render")) else " --threads 1"
            code, text, want = self.starved(line, STARVE_LIST=path("list.txt"))
            self.assertEqual(code, 0, (line, text))
            with open(path("list.txt")) as f:
                places = f.read().splitlines()
            before = everything()
            for k, place in enumerate(places):
                if place in seen:
                    continue
                seen.add(place)
                code, text, output = self.starved(line, STARVE_AT=str(k + 1))
                told = (line, k + 1, text)
                self.assertIn(code, (0, 1), told)
                if code:
                    self.assertRegex(text, r"^heatdiff: error: [^\n]*[Mm]emory[^\n]*\n$", told)
                    refused += 1
                elif "--dry-run" not in line:
                    self.assertEqual(output, want, told)         # what did without
                self.assertEqual(everything(), before, told)
        self.assertGreater(refused, 300)


# ---- numbers ----

FILTERS = {"heat:0.02": heat(0.02), "wave:5,0.4": lambda x: math.exp(-(5 - math.log(x)) ** 2 / 0.32),
           "mexican-hat:0.02": lambda x: x * math.exp(-0.02 * x),
           "resolvent:0.02": lambda x: 1 / (1 + 0.02 * x), "fractional:0.3,0.5": lambda x: math.exp(-0.3 * math.sqrt(x)),
           "band:50,200": lambda x: 1 / (1 + ((x - 10000 / x) / 150) ** 4), "biharmonic:30": lambda x: 1 / (x * x + 900)}


def greedy(m, definition, t, given):
    """The five vertices that sample takes, and their distances to those before."""
    chosen, steps, nearest = [(given or [0])[0]], [0.0], [math.inf] * len(m.x)
    while len(chosen) < 5:
        nearest = list(map(min, nearest, m.distance(definition, t, chosen[-1])))
        chosen.append(given[len(chosen)] if len(chosen) < len(given) else max(range(len(nearest)), key=lambda i: nearest[i]))
        steps.append(nearest[chosen[-1]])
    return [chosen, steps]


def answers(mesh, m, sources, times, pairs):
    """For each command its options, the columns that it must print, and how closely."""
    at, t = ",".join(map(str, sources)), ",".join(map(str, times))
    both = [(v, x) for v in sources for x in times]
    fields = transposed([FIELDS["waves"](i) for i in range(len(m.x))])
    ends, early = transposed(pairs), times[:2]                # later, distances are small and lose digits

    def of_pairs(definition, side="y", shown=early):
        """The columns of pairs, for each time K and d; without times d alone."""
        d = [[m.distance(definition, x, j)[i] for i, j in pairs] for x in shown]
        if not any(shown):
            return ends + d
        return ends + [c for x, row in zip(shown, d) for c in ([m.entry(heat(x), i, j, "x", side) for i, j in pairs], row)]

    for method in METHODS + ("local",):
        by = " --method " + method
        yield "kernel --source %s --t %s" % (at, t) + by, [m.column(heat(x), v) for v, x in both], 1e-7
        want = [m.applied(heat(x), f) for f in fields for x in times]
        yield "diffuse --input waves-%d.txt --t %s" % (len(m.x), t) + by, want, 1e-7
        yield "pairs --input p.txt --t %s,%s" % early + by, of_pairs("classical"), 1e-6
    yield "kernel --kernel symmetric --source %s --t %s" % (at, t), [m.column(heat(x), v, "x", "x") for v, x in both], 1e-7
    yield "pairs --kernel symmetric --input p.txt --t %s,%s" % early, of_pairs("classical", "x"), 1e-6
    for option, side in (("", "x"), (" --kernel symmetric", "x"), (" --kernel operator", "y")):
        yield "hks --t " + t + option, [m.diagonal(heat(x), "x", side) for x in times], 2e-7
    yield "hks --normalise --t " + t, [[k / m.trace(heat(x)) for k in m.diagonal(heat(x))] for x in times], 4e-7
    for definition in DEFINITIONS[:2 if "dirichlet" in mesh else 4]:          # where heat is lost the others may be infinite
        timed = definition in ("classical", "weighted")
        option = " --definition " + definition + (" --t %s,%s" % early if timed else "")
        shown = early if timed else (0,)
        yield "distance --source " + at + option, [m.distance(definition, x, v) for v in sources for x in shown], 1e-6
        yield "pairs --input p.txt" + option, of_pairs(definition, shown=shown), 1e-6
        for given in ([], [13], [13, 2]) if mesh.startswith("patch") else ():     # on others many vertices are as far
            option = (" --t %s" % times[1] if timed else "") + (" --source " + ",".join(map(str, given)) if given else "")
            yield "sample --count 5 --definition " + definition + option, greedy(m, definition, times[1], given), 1e-6
    for name, f in FILTERS.items() if "dirichlet" in mesh else ():
        option = " --filter " + name
        for method in ("direct", "iterative"):
            yield "kernel --source %s --method %s" % (at, method) + option, [m.column(f, v) for v in sources], 1e-7
        scale = m.trace(f) if name.startswith("wave") else 1
        yield "hks" + option, [[x / scale for x in m.diagonal(f)]], 1e-7
        yield "distance --source " + at + option, [m.distance("classical", f, v) for v in sources], 1e-5
        d = [m.distance("classical", f, j)[i] for i, j in pairs]
        yield "pairs --input p.txt" + option, ends + [[m.entry(f, i, j) for i, j in pairs], d], 1e-6


# Lines that print the same numbers, and how closely; 0: to the last digit.
SAME = table(r"""
kernel ico.obj --source 0 --t 3h2 :: kernel ico.obj --source 0 --t 12 :: 1e-9
geodesic patch-9.off --source 5 --threads 1 :: geodesic patch-9.off --source 5 --threads 2 :: 0
kernel five.obj --source 1 --t 0.3 --laplacian {fem|voronoi-cot|cot} :: kernel fan.obj --source 1 --t 0.3 --laplacian {1} :: 0
kernel ico.obj --source 3 --t 2h2 --laplacian polygon --lambda {0.1|1|10} :: \
    kernel ico.obj --source 3 --t 2h2 --laplacian voronoi-cot :: 1e-7
kernel ico.obj --source 0,1 --t 1,2 {--degree 13|--poles uniform|--precond ildl} :: kernel ico.obj --source 0,1 --t 1,2 :: 1e-6
kernel patch-9.off --source 11 --t 8h2 --solver {cocg|minres|lanczos} --precond {none|jacobi|ssor|ildl|mildl} :: \
    kernel patch-9.off --source 11 --t 8h2 --tol 1e-12 :: 1e-7
kernel patch-9.off --source 11 --t 8h2 --method iterative --poles {uniform|kernel} :: \
    kernel patch-9.off --source 11 --t 8h2 --tol 1e-12 :: 1e-7
{kernel|distance} roof.obj --t 0.1 --source 0:1,0,1:0,0 :: {1} roof.obj --t 0.1 --source 0,3 :: 0
geodesic roof.obj --laplacian fem --source 0:1,0,1:0,0 :: geodesic roof.obj --laplacian fem --source 0,3 :: 0
kernel roof.obj --t 0.1,0.2 --kernel symmetric --method krylov --source 0:1,0,1:0,0 :: \
    kernel roof.obj --t 0.1,0.2 --kernel symmetric --method krylov --source 0,3 :: 0
diffuse ico.obj --t 1 --input {tabs.txt|plain.csv|waves-12-2.npy|fortran.npy} :: diffuse ico.obj --t 1 --input waves-12-2.txt :: 0
diffuse ico.obj --t 1 --input flat.npy :: diffuse ico.obj --t 1 --input waves-12-1.txt :: 0
pairs ico.obj --t 1h2 --input p.npy :: pairs ico.obj --t 1h2 --input p.csv :: 0
kernel cloud-300.{ply|obj|off|xyz} --source 5 --t 0.1,20h2 :: kernel more.xyz --source 5 --t 0.1,20h2 :: 0
{kernel --source 3,40 --t 1h2,0.7|hks --t 5h2|trace --t 2|distance --source 5:0.2,0.3 --t 2|distance --source 5 --definition biharmonic\
|pairs --input p.csv --t 2|sample --count 5 --t 2|geodesic --source 0:0.2,0.2+20|geodesic --source 0:0.2,0.2+0:0.3,0.3 --curve\
|kernel --source 3 --t 1 --border dirichlet|kernel --source 3 --t 1 --intrinsic-delaunay|hks --t 1 --tufted} \
    squashed.obj --lengths sides-98.txt :: {1} patch-7.obj :: 1e-7
kernel torus-80-50.obj --source 7,3000 --t 50h2 --method {direct|krylov} --ordering {amd|dissection|auto} :: \
    kernel torus-80-50.obj --source 7,3000 --t 50h2 --method {1} :: 1e-9
{kernel --source 7,3000|kernel --kernel symmetric --source 7:0.2,0.3|pairs --input p.csv} torus-80-50.obj --t 1h2 --method local :: \
    {1} torus-80-50.obj --t 1h2 --method direct :: 2e-7
kernel torus-80-50.obj --source 7,3000 --t {0,2h2,1h2|2h2} --method local --tol 1e-12 {--threads 2|--laplacian voronoi-cot} :: \
    kernel torus-80-50.obj --source 7,3000 --t {1} --method krylov --tol 1e-12 {2} :: 1e-9
kernel parts.obj --source 0,390,490 --t 2h2,900h2 --laplacian {fem|voronoi-cot} --method {direct|krylov|auto|iterative} :: \
    kernel parts.obj --source 0,390,490 --t 2h2,900h2 --laplacian {1} --method iterative --degree 14 --tol 1e-12 :: 1e-7
{hks --kernel operator|hks --normalise|trace} torus-80-50.obj --t 1h2,2h2 --threads 1 --memory-limit 40M --method local :: \
    {1} torus-80-50.obj --t 1h2,2h2 --method direct :: 1e-6
hks torus-80-50.obj --filter wave:6,0.5 --laplacian {fem|voronoi-cot} --threads 1 --memory-limit 40M --method local :: \
    hks torus-80-50.obj --filter wave:6,0.5 --laplacian {1} --method direct :: 1e-6
{distance --source 7,3000:0.2,0.3 --definition weighted|distance --source 7|pairs --input p.csv} torus-80-50.obj --filter wave:6,0.5 \
    --method local :: {1} torus-80-50.obj --filter wave:6,0.5 --method direct :: 1e-8
distance torus-80-50.obj --source 7,3000:0.2,0.3 --t 1h2,2h2 --definition {classical|weighted} --laplacian {fem|voronoi-cot} \
    --method local :: distance torus-80-50.obj --source 7,3000:0.2,0.3 --t 1h2,2h2 --definition {1} --laplacian {2} --degree 14 :: 2e-9
distance torus-150-100.obj --source 7,3000:0.2,0.3 --t 1h2 --definition weighted --threads 1 --memory-limit 120M \
    :: distance torus-150-100.obj --source 7,3000:0.2,0.3 --t 1h2 --definition weighted --degree 14 :: 2e-9
sample --count 6 torus-80-50.obj --t 1h2 --source {7|7,3000|9:0.2,0.3} --definition {classical|weighted} --method local :: \
    sample --count 6 torus-80-50.obj --t 1h2 --source {1} --definition {2} --degree 14 :: 1e-9
hks torus-40-24.obj --t 10h2 --laplacian {fem|voronoi-cot} --method direct {--poles kernel --degree 12\
|--poles uniform --degree 14} :: hks torus-40-24.obj --t 10h2 --laplacian {1} :: 1e-7
distance torus-40-24.obj --source 5 --t 10h2 --laplacian {fem|voronoi-cot} --method direct {--poles kernel --degree 12\
|--poles uniform --degree 14} :: distance torus-40-24.obj --source 5 --t 10h2 --laplacian {1} :: 1e-6
kernel torus-40-24.obj --source 9 --t 30h2 --method direct --poles {kernel --degree 10|kernel --degree 13|kernel --degree 14\
|uniform --degree 12|uniform --degree 14} :: kernel torus-40-24.obj --source 9 --t 30h2 --method krylov --tol 1e-12 :: 1e-7
kernel torus-40-24.obj --source 7,800 --t 2h2,50h2 --method {direct|krylov|auto|iterative} --simd {avx2|avx512|auto} :: \
    kernel torus-40-24.obj --source 7,800 --t 2h2,50h2 --method {1} --simd none :: 1e-8
{hks --t 2h2,50h2|distance --source 1,500 --t 20h2|distance --source 1 --definition biharmonic|pairs --input p.csv --t 20h2\
|sample --count 6 --t 20h2} torus-40-24.obj --threads {2|3} :: {1} torus-40-24.obj --threads 1 :: 0
kernel torus-80-50.obj --source 1,400,3000 --t {100h2|1h2,40h2} --method {direct|krylov|auto} --threads {2|3} :: \
    kernel torus-80-50.obj --source 1,400,3000 --t {1} --method {2} --threads 1 :: 0
""")
# Sources and times together, against one of each: line, sources, times, closeness.
TOGETHER = table(r"""
kernel patch-9.off :: 8,90,8 :: 1h2,20h2,3h2 :: 1e-7
geodesic patch-9.off :: 3,40,77,3,99,0,12,13,14,15,50 :: :: 1e-12
distance torus-40-24.obj :: 3,700 :: 30h2,2h2,9h2 :: 1e-7
distance torus-40-24.obj --laplacian voronoi-cot --definition {classical|weighted} :: 3 :: \
    9h2,1h2,3h2,20h2,2h2,14h2,1.5h2,5h2,7h2,4h2,12h2,17h2 :: 1e-6
hks torus-40-24.obj :: :: 30h2,2h2,9h2 :: 2e-7
kernel torus-40-24.obj --method {direct|krylov|auto|iterative|local} :: {3,700 :: 2h2,5h2,40h2|3 :: 500h2,0,2h2,40h2,2h2} :: 1e-7
kernel parts.obj --method krylov --laplacian {fem|voronoi-cot} :: 0,5,484 :: 100000h2,1h2,0,30000h2,3h2,0,0.01h2,1h2 :: 1e-7
kernel torus-40-24.obj --kernel symmetric --method krylov :: 1,2 :: 1h2,90h2 :: 1e-7
kernel torus-40-24.obj --method {auto|krylov|direct} :: 0,37,74,111,148,185,222,259,296 :: 50h2,3h2 :: 1e-7
""")


def options(sources, times):
    return ("--source", sources) * bool(sources) + ("--t", times) * bool(times)


class Numbers(Case):
    def columns_of(self, line, want, tol, each=False):
        self.close(self.rows(line), transposed(want), tol, each)

    def test_every_command(self):
        """Kernels, fields, signatures, distances, pairs and samples of dense matrices."""
        cases = [("%s --laplacian %s" % case, dense_modes(*case), (7, 0), (0.05, 1.0, 30.0))
                 for case in (("ico.obj", "fem"), ("ico.obj", "cot"), ("patch-4.obj", "fem"), ("patch-4.obj", "cot"))]
        cases.append(("square-12.obj --border dirichlet --laplacian voronoi-cot", square_modes(12), (69, 84), (0.005, 0.02)))
        for mesh, m, sources, times in cases:
            pairs = [sources, sources[::-1], (3, 3), (len(m.x) - 1, 1), sources]
            file("p.txt", pairs)
            for line, want, tol in answers(mesh, m, sources, times, pairs):
                with self.subTest(mesh=mesh, line=line):
                    self.columns_of(line + " " + mesh, want, tol, each=line.startswith("hks --") and "filter" not in line)
            with self.subTest(mesh=mesh, line="trace, spectrum"):
                for (t, trace, bound), want in zip(self.rows("trace --t", ",".join(map(str, times)), *mesh.split()), times):
                    self.assertEqual(t, want)
                    self.assertLessEqual(abs(trace - m.trace(heat(t))), bound + 1e-12 * trace)
                    self.assertLess(bound, 1e-6 * trace)
                values = self.report("spectrum -k 6 " + mesh)["eigenvalues"]
                for a, b in zip(values, sorted(m.values)):
                    self.assertAlmostEqual(a, b, delta=1e-8 * values[-1])

    def test_lines_that_say_the_same(self):
        rows = spec("waves-12-2.txt")[2][0]
        for name, content in (
                ("fortran.npy", npy_bytes(rows, fortran=True)),
                ("tabs.txt", "# two columns\n\n" + "".join("\t%.17g ,  %.17g # row\r\n" % tuple(r) for r in rows)),
                ("flat.npy", npy_bytes(columns(rows, 0), flat=True)),
                ("plain.csv", "".join("%.17g,%.17g\n" % tuple(r) for r in rows).rstrip("\n")),
                ("p.npy", npy_bytes([[1.0, 2.0], [4.0, 4.0], [0.0, 9.0]])),
                ("p.csv", "# three\n1, 2\n\n4 4\n0 9\n"), ("more.xyz", lines_of([p + (7, 8, 9) for p in cloud(300)[0]]))):
            file(name, content)
        known = {}
        for line, reference, tol in SAME:
            with self.subTest(line):
                tol = float(tol)
                if reference not in known:
                    known[reference] = self.rows(reference)
                got, want = self.rows(line), known[reference]
                if not tol:
                    self.assertEqual(got, want)
                elif line.startswith("trace"):   # the last column bounds the error
                    self.close(columns(got, 0, 1), columns(want, 0, 1), tol)
                else:
                    self.close(got, want, tol)

    def test_columns_together(self):
        known = {}
        for line, sources, times, tol in TOGETHER:
            with self.subTest(line=line, times=times):
                got = self.rows(line, *options(sources, times))
                single = [(s, t) for s in sources.split(",") for t in times.split(",")]
                self.assertEqual(len(got[0]), len(single))
                for k, one in enumerate(single):
                    if (line, *one) not in known:
                        known[(line, *one)] = self.rows(line, *options(*one))
                    self.close(columns(got, k), known[(line, *one)], float(tol))

    def test_fields_together(self):
        for line, n, times in [("diffuse patch-9.off", 100, ("2h2", "9h2"))] + \
                [("diffuse torus-40-24.obj --method " + m, 960, ("300h2", "0", "2h2", "9h2")) for m in METHODS]:
            rows = spec("waves-%d-2.npy" % n)[2][0]
            got = self.rows(line + " --input waves-%d-2.npy --t" % n, ",".join(times))
            for q in range(2):
                file("one.npy", npy_bytes(columns(rows, q)))
                for k, t in enumerate(times):
                    self.close(columns(got, len(times) * q + k), self.rows(line + " --input one.npy --t", t), 1e-7)
                    self.assertTrue(t != "0" or columns(got, len(times) * q + k) == columns(rows, q))

    def test_what_is_exact(self):
        file("f.txt", [[math.exp(i)] for i in range(12)])
        for source in (0, 5):
            self.assertEqual(self.rows("kernel ico.obj --t 0 --source", source), [[float(i == source)] for i in range(12)])
        self.assertEqual(self.rows("diffuse ico.obj --input f.txt --t -0"), [[math.exp(i)] for i in range(12)])
        file("f.txt", "9876543210987654321e3\n" * 12)
        self.assertEqual(self.rows("diffuse ico.obj --input f.txt --t 0"), [[9876543210987654321e3]] * 12)
        self.close(self.rows("diffuse patch-9.off --input ones-100.txt --t 1h2,100h2"), [[1.0, 1.0]] * 100, 1e-7)
        self.assertTrue(all(a == b for a, b in self.rows("kernel patch-9.off --source 8,8 --t 2h2")))
        got = self.rows("kernel loose.obj --source 12,3 --t 4h2")     # a vertex of no face
        self.assertEqual(columns(got, 0) + [got[12]], [[0.0]] * 12 + [[1.0], [1.0, 0.0]])
        self.close(self.rows("diffuse quad.obj --t 100 --input", file("f.txt", "1\n2\n3\n4\n")), [[2.5]] * 4, 1e-7)

    def test_polygon_in_closed_form(self):
        """B^-1 L of the unit square has the eigenvalues 0, 4, 4 and 16 lambda."""
        for more, weight in (("", 1), ("--laplacian polygon --lambda 0.5", 0.5), ("--lambda=2", 2)):
            a, b = math.exp(-4 * 0.07) / 2, math.exp(-16 * weight * 0.07) / 4
            self.close(self.rows("kernel quad.obj --source 0 --t 0.07 " + more),
                       [[0.25 + a + b], [0.25 - b], [0.25 - b], [0.25 - a + b]], 1e-7)

    def test_times(self):
        """auto:K: between 0.0024 and 0.37 of the area; 1/l1 is one over the second eigenvalue."""
        r = self.report("spectrum torus-40-24.obj -k 2")
        t = self.report("hks torus-40-24.obj --t 1/l1,0.1/l1,auto:3")["times"]
        for got, want in zip(t, (1 / r["eigenvalues"][1], 0.1 * t[0],
                                 *(r["area"] * part for part in (0.0024, math.sqrt(0.0024 * 0.37), 0.37)))):
            self.assertAlmostEqual(got / want, 1, delta=1e-9)
        together = self.rows("hks torus-40-24.obj --t auto:3,2h2")
        self.close(columns(together, 1, 3), self.rows("hks torus-40-24.obj --t %.17g,2h2" % t[3]), 2e-7)
        times = self.report("kernel patch-9.off --source 0 --t auto:5")["times"]
        self.assertEqual((len(times), len(read_npy(taken("report.npy"))[0])), (5, 5))
        ratios = [b / a for a, b in zip(times, times[1:])]
        self.assertGreater(ratios[0], 1.5)
        self.assertLess(max(ratios) / min(ratios), 1 + 1e-9)

    def test_sample_takes_no_vertex_twice(self):
        for line, want in (("patch-4.obj --count 25 --t 100000h2", range(25)),     # all distances are zero but for rounding
                           ("pieces.obj --count 19 --definition commute", [i for i in range(20) if i != 16])):
            self.assertEqual(sorted(r[0] for r in self.rows("sample " + line)), list(want))

    def test_nothing_is_factorised_twice(self):
        def flops(method, *args):
            return self.report("kernel torus-80-50.obj --method %s --source %s --t %s" % (method, *args))["factor_flops"]
        one = flops("krylov", 5, "50h2")
        self.assertEqual(flops("krylov", "5,6,7", "20h2,50h2,100h2,300h2"), one)
        one = flops("direct", 5, "50h2")
        self.assertEqual((flops("direct", "5,6,7", "50h2"), flops("direct", "5,6,7", "20h2,50h2,100h2")), (one, 3 * one))

    def test_signatures_and_distances_of_pieces(self):
        inert, n, pieces_of = 16, 20, (range(0, 4), range(4, 16), range(17, 20))
        got = self.rows("hks pieces.obj --t 1h2,5h2")
        self.assertEqual([i for i in range(n) if not min(got[i]) > 0], [inert])
        self.assertEqual((got[inert], self.rows("hks pieces.obj --t 1 --kernel operator")[inert]), ([0, 0], [1]))
        file("p.txt", [(0, 3), (0, 4), (16, 16), (3, 16)])
        for definition in ("commute", "biharmonic"):
            got = self.rows("distance pieces.obj --source 1,5,16 --definition " + definition)
            for q, s in enumerate((1, 5, inert)):
                for i in range(n):
                    together = i == s or any(i in p and s in p for p in pieces_of)
                    self.assertEqual((math.isinf(got[i][q]), got[i][q] == 0), (not together, i == s), (definition, s, i))
            rows = self.rows("pairs pieces.obj --input p.txt --definition " + definition)
            self.assertEqual([math.isinf(r[2]) for r in rows] + [rows[2][2]], [False, True, False, True, 0])
        got, k = self.rows("distance pieces.obj --source 1,16 --t 1"), self.rows("hks pieces.obj --t 2")
        for i in range(4, n):                                       # no heat in common: d^2 = k_2t(s,s) + k_2t(i,i)
            self.assertAlmostEqual(got[i][0], math.sqrt(k[1][0] + k[i][0]), delta=1e-6 * got[i][0])
        for e in ("npy", "vtu", "ply", "png", "csv"):               # infinities are written as such, and are no colours
            self.data("inf." + e, "distance pieces.obj --source 1 --definition commute", *small(e))

    def test_every_question_of_points_and_polygons(self):
        """Signature, distances, pairs and samples agree with the kernel on every kind of point Laplacian, and on polygons."""
        for mesh, n, t in (("uneven.obj", 25, 0.4), ("uneven.obj --tufted", 25, 0.4), ("few.xyz", 50, 0.1),
                           ("few.xyz --laplacian exp", 50, 2),
                           ("few.xyz --tufted --laplacian voronoi-cot", 50, 0.1)):
            k = self.rows("kernel %s --kernel symmetric --t %s --source" % (mesh, 2 * t), ",".join(map(str, range(n))))
            want = [math.sqrt(k[0][0] - 2 * k[i][0] + k[i][i]) if i else 0 for i in range(n)]
            self.close(self.rows("hks %s --t %s" % (mesh, 2 * t)), [[k[i][i]] for i in range(n)], 1e-6)
            self.close(self.rows("distance %s --source 0 --t %s" % (mesh, t)), [[x] for x in want], 1e-6)
            file("p.txt", [(0, i) for i in range(n)])
            self.close(columns(self.rows("pairs %s --input p.txt --t %s" % (mesh, t)), 3), [[x] for x in want], 1e-6)
            found = self.rows("sample %s --source 0 --count 2 --t %s" % (mesh, t))[1]
            self.assertAlmostEqual(found[1] / max(want), 1, delta=1e-6)
            self.assertAlmostEqual(want[int(found[0])] / max(want), 1, delta=1e-6)
            for definition in DEFINITIONS[1:]:
                d = self.rows("distance %s --source 0 --definition %s" % (mesh, definition),
                              *(("--t", t) if definition == "weighted" else ()))
                self.assertTrue(d[0] == [0] and (definition == "weighted" or min(d[1:]) > [0]))

    def test_signatures_of_signatures(self):
        """Normalised and scale-invariant signatures from plain ones and traces, computed here."""
        plain = list(zip(*self.rows("hks patch-4.obj --t 0.01,1")))
        traces = [row[1] for row in self.rows("trace patch-4.obj --t 0.01,1")]
        self.close(self.rows("hks patch-4.obj --t 0.01,1 --normalise"),
                   [[x / z for x, z in zip(row, traces)] for row in zip(*plain)], 1e-6)
        n = 1 + 16 * 6                                               # 16 times an octave
        times = ",".join(repr(0.01 * 64 ** (k / (n - 1))) for k in range(n))
        want = []
        for row in self.rows("hks patch-4.obj --t " + times):
            steps = [math.log(b / a) for a, b in zip(row, row[1:])]
            want.append([abs(sum(x * cmath.exp(-2j * math.pi * q * j / len(steps)) for j, x in enumerate(steps))) for q in range(4)])
        self.close(self.rows("hks patch-4.obj --t 0.01,0.64 --scale-invariant 4"), want, 1e-5)

    def test_sources_anywhere(self):
        """Places on faces, sums of places with weights, curves."""
        one, two, three = zip(*self.rows("kernel roof.obj --source 0,1,2 --t 0.1"))
        file("places.txt", "# a line\n0:0.5,0.5   # its beginning\n\n0:0,0.5\n")
        for more, parts_of in (("--source 0:0.2,0.3", [(0.2, 0.3, 0.5)]), ("--source 2*0+0.5*2,1", [(2, 0, 0.5), (0, 1, 0)]),
                               ("--source-file places.txt --curve", [[math.sqrt(0.5) * x for x in (0.25, 0.5, 0.25)]])):
            self.close(self.rows("kernel roof.obj --t 0.1 " + more),
                       [[x * a + y * b + z * c for x, y, z in parts_of] for a, b, c in zip(one, two, three)], 1e-7)
        self.close(self.rows("geodesic roof.obj --source-file places.txt --curve")[:3], [[0.5], [math.sqrt(0.125)], [0.5]], 1e-12)
        r = self.report("kernel roof.obj --source 0:0.2,0.3,5 --t 0.1 -o s.csv")
        self.assertEqual((r["source"], read_csv(taken("s.csv"))[0]), ("0:0.2,0.3,5", ["s0_0.1", "s1_0.1"]))
        r = self.report("kernel roof.obj --source-file places.txt --t 1")
        self.assertEqual((r["source_file"], r.get("source")), ("places.txt", None))
        marks = [self.data("s.png", "kernel roof.obj --t 0.1 --title x --size 64x64 --source", s)
                 for s in ("1", "0:0,1", "2", "0:0,0")]
        self.assertEqual(marks[::2], marks[1::2])                    # the mark stands at the nearest corner
        self.assertNotEqual(marks[0], marks[2])
        both = [self.report("geodesic roof.obj --laplacian fem --source", s)
                for s in ("0:0.1,0.2,1:0.5,0.2,0+4", "0+4,1:0.5,0.2,0:0.1,0.2")]
        for key in ("residual", "residual_heat", "residual_distance", "stages", "status"):
            self.assertEqual(both[0][key], both[1][key])             # those of the worst source, in any order
        many = self.rows("kernel ico.obj --t 1 --source-file",
                         file("many.txt", "".join("0:0.25,0.25  # %d\r\n" % i for i in range(5000))))
        self.close(many, [[5000 * x for x in row] for row in self.rows("kernel ico.obj --t 1 --source 0:0.25,0.25")], 1e-7)
        for source in (("--source", "1:0.2,0.3"), ("--source", "3,0.5*4+1"), ("--source-file", file("from.txt", "1:0.2,0.3\n")),
                       ("--source", "1:1,0+1:0,1", "--curve")):
            far = [min(row) for row in self.rows("distance roof.obj --t 0.1", *source)]    # samples are farthest from places
            got = self.rows("sample roof.obj --t 0.1 --count 3", *source)
            self.assertEqual((len(got), got[0][0]), (3, far.index(max(far))))
            self.assertAlmostEqual(got[0][1], max(far), 6)
            again = self.rows("distance roof.obj --t 0.1 --source", int(got[0][0]))
            self.assertAlmostEqual(got[1][1], max(min(a, b[0]) for a, b in zip(far, again)), 6)
        self.assertIn("3 points", self.text("sample roof.obj --t 0.1 --count 3 --source 1:0.2,0.3 -o s.txt"))
        self.good("sample roof.obj --t 0.1 --count 3 --source 1:0.2,0.3 --dry-run")

    def test_points_of_a_sphere(self):
        """Laplacians of points: z has eigenvalue 2."""
        for kind in ("", "--tufted", "--tufted --laplacian voronoi-cot"):
            out = self.rows("diffuse cloud-300.xyz --input heights-300.txt --t 0.1 " + kind)
            self.assertTrue(all(abs(a[0] / p[2] / math.exp(-0.2) - 1) < 0.05 for a, p in zip(out, cloud(300)[0]) if abs(p[2]) > 0.3), kind)


# ---- files ----

READERS = {"txt": numbers, "csv": lambda data: read_csv(data)[1], "npy": read_npy, "obj": read_obj, "png": read_png}
FIELD_FILES, ROW_FILES = ("txt", "csv", "npy", "ply", "obj", "vtu", "png"), ("txt", "csv", "npy")
# A command, the names of the columns that it prints, and the formats of its files. *: names that the help does not show.
NAMES = (
    ("kernel patch-9.off --source 8,90 --t 1h2,5h2", "v8_1h2,v8_5h2,v90_1h2,v90_5h2", FIELD_FILES),
    ("kernel patch-9.off --source 3,8 --t 1,2", "v3_1,v3_2,v8_1,v8_2", ("csv",)),
    ("kernel patch-9.off --source 3,3 --t 1", "*v3_1_c0,v3_1_c1", ("csv",)),
    ("kernel patch-9.off --source 3 --t 0.5/l1", "*v3_0.5/l1", ("csv",)),
    ("diffuse patch-9.off --input waves-100-2.txt --t 1,2", "f0_1,f0_2,f1_1,f1_2", FIELD_FILES),
    ("distance patch-9.off --source 3,8 --t 1,2", "v3_1,v3_2,v8_1,v8_2", FIELD_FILES),
    ("distance patch-9.off --source 3 --definition commute", "*v3_commute", FIELD_FILES),
    ("geodesic patch-9.off --source 3,8", "v3_1h2,v8_1h2", FIELD_FILES),
    ("geodesic patch-9.off --source 3,8 --nearest", "*nearest_1h2,d_1h2", ("csv",)),
    ("hks patch-9.off --t 1,2", "hks_1,hks_2", FIELD_FILES), ("hks patch-9.off --filter wave:5,0.4", "*hks_wave", ("csv",)),
    ("hks patch-4.off --t 1e-5,1e3 --scale-invariant 4", "*si_0,si_1,si_2,si_3", FIELD_FILES),
    ("trace patch-9.off --t 1,2h2,1/l1", "t,trace,bound", ROW_FILES),
    ("pairs patch-9.off --input p.txt --t 1,2", "i,j,K_1,d_1,K_2,d_2", ROW_FILES),
    ("pairs patch-9.off --input p.txt --definition commute", "*i,j,d_commute", ROW_FILES),
    ("sample patch-9.off --count 4 --t 1", "vertex,distance", ROW_FILES),
    ("spectrum patch-9.off -k 4", "*x_0,x_1,x_2,x_3", FIELD_FILES),
    ("kernel quad.obj --source 0 --t 1h2", "*v0_1h2", FIELD_FILES),
    ("kernel cloud-300.xyz --source 3 --t 0.1", "*v3_0.1", FIELD_FILES),
)


class Formats(Case):
    def test_files(self):
        """Each format has the numbers that are printed; .csv begins with the names that the help tells."""
        file("p.txt", "3 8\n8 3\n4 4\n")
        for line, names, formats in NAMES:
            printed = self.good(line, "--quiet").stdout.decode()
            want = numbers(printed)
            if formats == ROW_FILES and not line.startswith("trace"):
                self.assertRegex(printed, r"(?m)^\d+ ")               # ids are written as integers
            for e in formats:
                with self.subTest(line=line, format=e):
                    data = self.data("f." + e, line, *(("--size", "200x200") if e == "png" else ()))
                    if e in ROW_FILES:
                        self.assertEqual(READERS[e](data), want)
                    else:
                        self.field_file(e, data, names.lstrip("*").split(","), spec(line.split()[1])[2])
            data = self.data("f.csv", line)
            self.assertEqual(read_csv(data)[0], names.lstrip("*").split(","))
            self.assertEqual(self.data("f.csv", line, "--no-header"), data.split(b"\n", 1)[1])
            if names[0] != "*" and "h2" not in names:
                told = self.good(line.split()[0] + " --help").stdout.decode().replace(",", " ").replace(".", " ").split()
                self.assertLessEqual(set(names.split(",")), set(told))
        self.assertEqual(numbers(self.data("K.TXT", NAMES[0][0])), self.rows(NAMES[0][0]))

    def field_file(self, kind, data, names, mesh):
        """Meshes with colours and fields, and pictures."""
        v, f = mesh
        if kind == "png":
            width, height, distinct = read_png(data)
            self.assertTrue((width, height) == (200, 200) and distinct > (20 if len(v) < 10 else 30), distinct)
        elif kind == "vtu":
            self.assertEqual(counted(data), (len(v), len(f) or len(v)))
            self.assertEqual(re.findall(rb'"Float64" Name="([^"]+)" format', data), [name.encode() for name in names])
        elif kind == "obj":
            places, faces = read_obj(data)
            self.assertEqual((len(places), faces), (len(v), len(f)))
            self.assertTrue(all(len(p) == 6 and all(0 <= c <= 1 for c in p[3:]) for p in places))
            self.close([p[:3] for p in places], v, 1e-14)
        else:
            self.assertEqual(counted(data), (len(v), len(f)) if f else (len(v),))
            self.assertEqual(data.count(b"property double quality"), len(names))

    def test_pictures(self):
        for more in ("", "--log", "--isolines 8", "--range 0,0.5", "--view 100,-40", "--column 3", "--title 'a <title> \u00e9'",
                     "--colormap grey"):
            w, h, distinct = read_png(self.data("k.png", "kernel patch-9.off --source 8,90 --t 1h2,5h2 --size 320x240 " + more))
            self.assertEqual((w, h), (320, 240))
            self.assertGreater(distinct, 30)
        for more in ("--input waves-100-2.txt", "--input waves-100-2.txt --column 1 --isolines 10", "--input flat.npy"):
            file("flat.npy", npy_bytes([[3.0]] * 100, flat=True))
            self.assertEqual(read_png(self.data("r.png", "render patch-9.off --size 200x200 " + more))[:2], (200, 200))
        self.data("r.png", "render cloud-300.xyz --input heights-300.txt --size 64x64")
        self.data("n.png", "geodesic ./patch-9.off --source 0,9 --nearest --column 1 --size 64x64")
        for n in (2, 3):                         # the height suits the number of pictures
            self.assertLess(read_png(self.data("r.png", "render ico.obj" + n * " --input=count-12.txt"))[1], 900)
        drawn = [self.data("p.png", "render ico.obj --size 64x64 --input", file("p.txt", "-1e-9\n" + "1\n" * 10 + last))
                 for last in ("inf\n", "-inf\n", "nan\n")]
        self.assertEqual(drawn[0], drawn[2])     # the range of colours is that of the finite values

    def test_side_by_side(self):
        """Several fields, or several meshes with a field each, in one picture with one range of colours."""
        file("low.txt", [[i % 5] for i in range(100)])
        self.good("kernel patch-9.off --source 8 --t 5h2 -o other.ply")

        def draw(line):
            data = self.data("pair.png", "render --size 400x200 --isolines 0 --view 0,0 --title x " + line)
            self.assertEqual(read_png(data)[:2], (400, 200))
            return data
        pair = draw("patch-9.off --input low.txt --input count-100.txt")
        for line, same in (("--input count-100.txt --input count-100.txt", False), ("--input low.txt --input low.txt", False),
                           ("--input low.txt --input count-100.txt --range 0,99", True)):    # the range is that of both
            self.assertEqual(draw("patch-9.off " + line) == pair, same, line)
        draw("patch-9.off other.ply --input low.txt --input count-100.txt")
        r = self.report("render patch-9.off other.ply --input low.txt --input count-100.txt --size 64x64 -o pair.png")
        self.assertEqual(r["panels"], 2)

    def test_up(self):
        """Another axis up is the shape turned."""
        v, f = patch(9)
        file("k.txt", [[x] for x in range(100)])

        def draw(places, *more):
            return self.data("up.png", "render --input k.txt --size 120x90 --title x", file("up.off", off_text(places, f)), *more)
        for up, turned in (("z", [(x, z, -y) for x, y, z in v]), ("x", [(-y, x, z) for x, y, z in v]), ("y", v)):
            self.assertEqual(draw(v, "--up", up), draw(turned))
        self.assertNotEqual(draw(v), draw(v, "--up", "z"))
        self.data("up.png", "kernel patch-9.off --source 8 --t 5h2 --size 64x64 --up z")

    def test_labels(self):
        """Regions have a colour each."""
        line = "distance patch-9.off --source 0,44,99 --t 20h2 --nearest --size 120x90 --title x"
        labels = [int(row[0]) for row in self.rows(line)]
        places, _ = read_obj(self.data("n.obj", line))
        colours = {(label, tuple(p[3:])) for label, p in zip(labels, places)}
        self.assertEqual([len(set(part)) for part in zip(*colours)], [3, 3])
        file("n.txt", [[x] for x in labels])
        drawn = self.data("n.png", line)
        self.assertNotEqual(drawn, self.data("n.png", "render --input n.txt patch-9.off --size 120x90 --title x"))
        a, b = (self.data("n.png", "render --labels --size 120x90 --title x patch-9.off " + more)
                for more in ("--input n.txt", "--input n.txt --isolines 0"))
        self.assertEqual(a, b)
        self.good("render --labels --input n.txt --input n.txt patch-9.off --size 120x90 -o n.png")
        self.bad(1, like("n.txt: row 3, column 0: --labels takes whole numbers from 0, or -1 for none, not 0.5"),
                 "render --labels patch-9.off -o n2.png --input", file("n.txt", [[-1]] * 3 + [[0.5]] + [[2]] * 96))
        self.data("n.png", "geodesic twins.obj --source 3 --nearest --size 64x64")          # -1 is grey

    def test_outputs_are_inputs(self):
        want = self.rows("kernel patch-9.off --source 8 --t 5h2")
        for e in ("ply", "obj", "npy", "txt", "csv"):
            self.good("kernel patch-9.off --source 8 --t 5h2 -o again." + e)
            if e in ("ply", "obj"):
                report = self.report("info again." + e)
                self.assertEqual((report["n"], report["faces"]), (100, 162))
            else:
                self.close(self.rows("diffuse patch-9.off --t 0 --input again." + e), want, 1e-14)
        self.good("kernel cloud-300.xyz --source 8 --t 0.1 -o again.ply")
        report = self.report("info again.ply")
        self.assertEqual((report["n"], report["faces"]), (300, 0))

    def test_spectrum(self):
        lines = self.good("spectrum patch-9.off -k 5").stdout.decode().splitlines()
        values, rows = [float(x) for x in lines[0][2:].split()], numbers("\n".join(lines[1:]))
        self.assertTrue(lines[0].startswith("# ") and len(values) == 5 and values[0] == 0 and values == sorted(values))
        self.assertTrue(len(rows) == 100 and all(len(r) == 5 and r[0] == rows[0][0] > 0 for r in rows))
        r = self.report("spectrum patch-9.off -k 4")
        self.assertEqual((r["command"], r["count"], len(r["eigenvalues"]), r["proven"], r["status"]),
                         ("spectrum", 4, 4, 1, "HD_OK"))
        self.assertGreaterEqual(r["next"], r["eigenvalues"][3] * (1 - 1e-9))
        self.assertLess(r["residual"], 1e-9)
        values = self.report("spectrum patch-9.off -k 12")["eigenvalues"]
        half = (values[6] + values[7]) / 2
        self.assertEqual(self.report("spectrum patch-9.off --below %r" % half)["count"], 7)
        self.assertIn("proven", self.text("spectrum patch-9.off -k 3 --below %r" % half))
        least = self.report("spectrum patch-9.off --border dirichlet -k 1")["eigenvalues"][0]
        text = self.bad(1, "no eigenvalue is below", "spectrum patch-9.off --border dirichlet --below", 0.5 * least)
        self.assertTrue(0.5 * least <= float(text.split()[-1]) <= least * (1 + 1e-5), (text, least))


# ---- reports ----

# Lines, and what their report has: = exactly, numbers with a point to 1e-9, a/b one of them; < and not negative; >; ~ to 5 %;
# # so many; ! nothing of the name.
REPORTS = table(r"""
info patch-9.off :: n=100 faces=162 boundary_loops=1 components=1 inert=0
info parts.obj --laplacian {fem|voronoi-cot} :: components=3 inert=5
info ico.obj :: boundary_loops=0 area=34.64101615137755 h=2.0 laplacian=fem
info {defects|strange}.obj :: repeated_faces=1 repeated_corner_faces=1 zero_area_faces=1
info {defects.obj :: faces=23 inert=1|strange.obj :: inert=4 faces_used=1|line.xyz :: n=3 faces=0 inert=3|loose.obj :: inert=1}
{info mixed.obj|kernel mixed.obj --source 0 --t 1|kernel quad.obj --source 0 --t 1} :: laplacian=polygon
kernel patch-9.off --source 1,2 --t 2,40h2 :: n=100 faces=162 components=1 inert=0 sources=[1,2] laplacian=fem command=kernel
kernel patch-9.off --source 1,2 --t 2,40h2 :: error_bound_b<2e-7 error_bound<1e-5 mass_drift<1e-6
kernel torus-80-50.obj --source 1,2 --t {30h2 :: times#1|3h2,30h2 :: times#2} mass_drift<1e-9 method=direct/krylov/iterative
kernel torus-80-50.obj --source 1,2 --method direct --t {30h2 :: times#1|3h2,30h2 :: times#2} factor_nnz>20000 mass_drift<1e-9 \
    growth>0.1 growth<5 solver=none precond=none poles=kernel
kernel torus-80-50.obj --source 1,2 --method krylov --t {30h2 :: times#1|3h2,30h2 :: times#2} factor_nnz>20000 mass_drift<1e-9 \
    growth>0.1 growth<5 iterations>5 touched=0 error_local=0
kernel torus-80-50.obj --source 1,2 --method local --t {1h2 :: times#1|2h2,0,1h2 :: times#3} touched>500 touched<2000 \
    error_rational=0 error_local>0 error_bound<2e-7
kernel torus-150-100.obj --source 7 --t 1h2 :: method=local touched<1875 error_local>0 error_bound<2e-7
{hks|hks --kernel operator --method local|trace} torus-150-100.obj --t 1h2 --threads 1 --memory-limit 80M :: method=local \
    touched>500 touched<14000 patches>1 error_local>0 error_relative<1e-6
{distance --source 7|sample --count 3 --method local} torus-150-100.obj --t 1h2 --threads 1 --memory-limit 120M :: method=local touched>500 touched<15000 patches>1 error_local>0 error_relative<1e-7
{distance --source 7,3000|sample --count 3} torus-80-50.obj --t 1h2 --method local :: touched=4000 patches=1 degree=14
kernel torus-80-50.obj --source 1,2 --method iterative --t {30h2 :: times#1|3h2,30h2 :: times#2} mass_drift<1e-9
{hks|distance --source 1,2|sample --count 3} patch-9.off --t 3h2 :: times#1 n=100 lost=0 error_relative<1e-3 smallest>0
hks patch-9.off --t 3h2,9h2 :: command=hks times#2 lost=0 error_relative<1e-3 smallest>0
{distance --source 3|sample --count 3} patch-9.off --definition biharmonic :: times#0 n=100 lost=0 error_relative<1e-3 smallest>0
pairs patch-9.off --input p.txt --definition commute :: command=pairs times#0 lost>-1
info quad.obj :: h=1.0 area=1.0 edges=4 faces=1 faces_used=1 triangles=2 boundary_loops=1 laplacian=polygon
info quad.obj --laplacian fem :: edges=5 triangles_used=2 laplacian=fem
info quad.obj {--tufted :: intrinsic=tufted|--intrinsic-delaunay :: intrinsic=delaunay} laplacian=fem triangles_used=2
info askew.obj :: intrinsic! negative_weights>50
info askew.obj --intrinsic-delaunay :: intrinsic=delaunay sheets=1 negative_weights=0 not_delaunay_edges=0 flips>50
info sheets.xyz {--tufted|} :: not_flat>250
info cloud-300.xyz {--tufted|} :: not_flat=0
distance patch-9.off --source 1 --t 100000h2 :: lost>50
kernel book.obj --tufted --source 0 --t 0.1 :: intrinsic=tufted sheets=2 mass_drift<1e-9
kernel square-12.obj --border dirichlet --source 30 --t 0.02 :: held=48 inert=0 mass_drift=0
hks square-12.obj --filter wave:5,0.4 :: filter=wave:5,0.4 poles=filter times#0 filter_error<1.1e-10 error_rational>0
info squashed.obj --lengths sides-98.txt :: lengths=sides-98.txt box_low!
diffuse patch-9.off --input ones-100.txt --t 2 --poles uniform --degree 7 --solver cocg --precond ssor :: \
    poles=uniform degree=7 solver=cocg precond=ssor
kernel torus-40-24.obj --source 9 --t 30h2 --method direct --poles kernel --degree 13 :: poles=kernel degree=13
kernel torus-40-24.obj --source 9 --t 30h2 {--degree 9|--poles kernel} :: method=direct/iterative
hks torus-40-24.obj --t 10h2 --method direct --poles uniform --degree 14 :: poles=uniform degree=14
distance torus-40-24.obj --source 5 --t 10h2 :: poles=kernel
distance torus-40-24.obj --source 3,700,3 --t 9h2,1h2,3h2,20h2,2h2,14h2,1.5h2,5h2,7h2,4h2,12h2,17h2 :: degree>14
hks patch-9.off --t 1 :: kernel=symmetric method=direct
hks patch-4.obj --t 1e-5,1e3 --scale-invariant 4 :: times#426 error_bound<1e-4
pairs patch-9.off --input p.txt --t 3h2 :: pairs=2 input=p.txt
distance patch-9.off --source 1,2 --t 3h2 :: sources=[1,2] definition=classical
sample patch-9.off --count 3 --definition commute :: sources=[] definition=commute
geodesic patch-9.off --source 1,2 :: command=geodesic n=100 sources=[1,2] stages=1 unreached=0 status=HD_OK residual<1e-12
geodesic ico.obj --source 0:0.1,0.1,1:0.5,0.2,2 --laplacian voronoi-cot :: residual_heat<1e-9
geodesic twins.obj --source 3,25,40 :: unreached=100
geodesic strip-1500.off --source 0 :: stages>1
geodesic quads-16-12.obj --source 109 --border mean :: laplacian=polygon border=mean edge=1.0
info cloud-300.xyz :: n=300 faces=0 components=1 inert=0 laplacian=voronoi-exp coincident=0 isolated=0 without_area=0 \
    neighbours=30 weight_cut=1e-8 area~12.566
info cloud-300.xyz {--bandwidth 0.004 :: bandwidth=0.004|--weight-cut 1e-4 :: weight_cut=1e-4}
info twice.xyz --bandwidth 2h2 :: coincident=20 n=320
info twice.xyz --tufted {:: laplacian=fem|--laplacian voronoi-cot :: laplacian=voronoi-cot|--laplacian cot :: laplacian=cot} \
    intrinsic=tufted coincident=20 inert=20 sheets=2 negative_weights=0 bandwidth! area~12.566
info patch-9.off --laplacian voronoi-exp :: n=100 laplacian=voronoi-exp triangles_used=0
kernel torus-80-50.obj --source 7 --t 50h2 --ordering {amd :: ordering=amd|dissection :: ordering=dissection} factor_nnz>4000
levels sphere-3.obj --input latitude-642.txt --levels -0.6,0.8,2 :: lines=2 closed=2 levels=[-0.6,0.8,2] range=[-1.0,1.0]
""")
# Lines, and what they tell people. What begins with ! is not there.
TEXTS = table(r"""
info patch-9.off :: 100 :: 162
info quad.{obj|obj --laplacian fem|off --laplacian fem} :: polygon
info book.obj {--tufted :: sheets +2 :: edges flipped|:: !edges flipped}
{info ico.obj|kernel askew.obj --source 0 --t 1 -o x.npy} --intrinsic-delaunay :: intrinsic Delaunay
info square-12.obj --border dirichlet :: vertices held at zero +48
kernel square-12.obj --border dirichlet --source 30 --t 0.02 -o x.npy :: heat leaves at the border
kernel square-12.obj --filter resolvent:10h2 --source 3 -o x.npy :: filter resolvent:10h2 to  :: !conserved
sample square-12.obj --filter heat:10h2 --count 3 -o x.npy :: filter heat:10h2
diffuse square-12.obj --filter band:20,80 --input ones-169.txt -o x.npy :: filter band:20,80
hks square-12.obj --filter heat:10h2 --dry-run :: method direct
{hks|trace|distance --source 0|sample --count 2} torus-80-50.obj --t 1h2 --method local --dry-run :: method local \(asked for\) :: (?m)^local +\d+ :: !too much
{hks|trace|distance --source 0|sample --count 2} torus-80-50.obj --t 1h2 --memory-limit 20M --dry-run :: too much\n--method local needs less
distance torus-80-50.obj --source 0 --definition commute --memory-limit 5M --dry-run :: too much\n :: !method local
info squashed.obj --lengths sides-98.txt :: lengths of edges +sides-98.txt :: !box
kernel patch-7.obj --lengths sides-98.txt --source 0 --t 1 --size 64x64 -o x.png :: fem Laplacian, from lengths of edges
hks squashed.obj --lengths sides-98.txt --t 1 --dry-run :: method
geodesic {squashed.obj --lengths sides-98.txt|patch-9.off --border mean} --source 0 --dry-run :: real factors
geodesic quads-16-12.obj --source 109 --border mean -o x.npy :: three factors
geodesic loose.obj --source 0 -o x.npy :: 1 distance (is )?infinite
geodesic patch-9.off --source 1 --ordering dissection -o x.npy :: dissection :: residuals
info dense.xyz --laplacian exp --bandwidth 1h2 :: coincident :: !from the sampling
info line.obj :: !meaningful times
distance patch-9.off --source 1 --t 100000h2 -o x.npy :: pairs
kernel cloud-300.xyz --source 0 --t auto:2 {--laplacian exp|} -o x.npy :: bandwidth
info cloud-300.xyz :: points :: bandwidth :: area of the cells :: from the sampling :: !not flat
info cloud-300.xyz --tufted :: edges flipped :: !not flat
info sheets.xyz {--tufted|} :: places not flat
{info ico.obj|levels ico.obj --input count-12.txt --levels auto:2 -o x.npy|kernel ico.obj --source 0 --t 1\
|render ico.obj --input count-12.txt --size 64x64 -o x.png} --quiet :: !\w
kernel ico.obj --source 0 --t 1 :: \A(.+\n){1,8}\Z :: !\r
kernel ico.obj --source 0 --t 0 -o x.npy :: t = 0
kernel torus-80-50.obj --source 0 --t 9h2 -o x.npy --method {direct|krylov} :: (?m)^method {1} \(asked for\)$ :: \
    (?m)^factors: .*non-zeros.*flops :: \A(.+\n){1,8}\Z
kernel --source 0 torus-80-50.obj --t 1h2 -o x.npy --method local :: (?m)^parts of at most \d+ of 4000 vertices$ :: factors: :: !conserved
{hks torus-80-50.obj --memory-limit 40M --threads 1|distance torus-150-100.obj --source 0 --memory-limit 120M --threads 1} --t 1h2 \
    -o x.npy --method local :: (?m)^\d+ patches, parts of at most \d+ of \d+ vertices$ :: factors: :: !conserved
sample --count 2 torus-80-50.obj --t 1h2 -o x.npy --method local :: (?m)^1 patch, parts of at most 4000 of 4000 vertices$ :: factors:
{kernel --source 0|diffuse --input ones-4000.txt|smooth} torus-80-50.obj --t 1h2 --method local --dry-run :: method local \(asked for\) \
    :: (?m)^local +\d+ :: !too much
kernel torus-80-50.obj --source 0 --t 9h2 -o x.npy {--method iterative :: !factors:|:: (?m)^method \w+ \(.+\)$}
{hks --t 3h2,9h2|distance --source 1,2 --t 3h2|distance --source 3 --definition biharmonic|pairs --input p.txt --t 3h2\
|pairs --input p.txt --definition commute|sample --count 3 --t 3h2|sample --count 3 --definition commute} patch-9.off -o x.npy :: \
    (?m)^(hks|distance|pairs|sample): .*Laplacian$ :: \A(.+\n){5,8}\Z
{hks --t 1 --kernel operator|pairs --input p.txt --definition commute|pairs --input p.txt --t 1,2|geodesic --source 0 --ordering amd\
|trace --t 1|sample --count 3 --source 0+1 --t 1} torus-60-40.obj --dry-run :: method
""")


class Reports(Case):
    def setUp(self):
        file("p.txt", "1 2\n4 4\n")

    def holds(self, r, condition):
        key, sign, value = re.fullmatch(r"(\w+)([=<>~#!])(.*)", condition).groups()
        try:
            want = json.loads(value)
        except ValueError:
            want = value
        x = r.get(key)
        self.assertTrue({"=": lambda: abs(x / want - 1) < 1e-9 if isinstance(want, float) else x == want or x in value.split("/"),
                         "<": lambda: 0 <= x < want, ">": lambda: x > want, "~": lambda: abs(x / want - 1) < 0.05,
                         "#": lambda: len(x) == want, "!": lambda: x is None}[sign](), "%s is %s" % (condition, x))

    def test_json(self):
        for line, conditions in REPORTS:
            r = self.report(line)
            for condition in conditions.split():
                with self.subTest(line):
                    self.holds(r, condition)
        self.assertEqual(self.rows("kernel strange.obj --source 5 --t 1"), [[float(i == 5)] for i in range(8)])

    def test_text(self):
        for line, *patterns in TEXTS:
            text = self.text(line)
            for pattern in patterns:
                with self.subTest(line=line, pattern=pattern):
                    (self.assertNotRegex if pattern[:1] == "!" else self.assertRegex)(text, pattern.lstrip("!"))

    def test_two_lines(self):
        """What a run tells without --verbose, and what it warns of besides."""
        for line, patterns in (
                ("kernel ico.obj --source 0 --t 1", (r"kernel of ico\.obj: 1 source, 1 time, fem Laplacian, method \w+$",
                                                     r"error at most \S+ of the largest value; \S+ s, \S+ MB$")),
                ("pairs patch-9.off --input p.txt --t 3h2", (r"pairs of .*: 2 pairs, 1 time, classical, fem Laplacian, method \w+$",
                 r"error of K at most \S+ of its largest value, of d at most \S+ of its largest; \S+ s, \S+ MB$")),
                ("geodesic twins.obj --source 3", (r"geodesic of .*: 1 source, t = .* h\^2\)$", r"residuals .* and .*; \S+ s, \S+ MB$",
                                                   r"note: 25 distances are infinite: nothing leads there$")),
                ("spectrum patch-9.off -k 3", (r"spectrum of .*: 3 eigenvalues from 0 to .*, largest residual \S+$",
                                               r"proven complete: all others are at least \S+; \S+ s, \S+ MB$")),
                ("levels ico.obj --input count-12.txt --levels 2.5,11,12", (r"levels of count-12.txt: 2 lines at 3 values, \d+ points, \S+ s$",
                 r"note: 1 of 3 levels is outside the range of column 0 of count-12.txt, from 0 to 11$")),
                ("levels ico.obj --input inf.txt --levels 2", (r"levels of inf.txt: 0 lines at 1 value, 0 points, .*$",
                                                               "note: column 0 of inf.txt has no finite value$")),
                ("distance patch-9.off --source 1 --t 100000h2", ("distance of ", "error at most ", "note: .*pairs finds them$"))):
            file("inf.txt", "inf\n" * 12)
            got = self.good(line, "-o", "x.npy").stderr.decode().splitlines()
            self.assertLessEqual(len(patterns), len(got), got)
            for pattern, row in zip(patterns, got):
                self.assertRegex(row, r"\A" + pattern)
            self.assertFalse(any(not row.startswith("note: ") for row in got[2:]), got)
            self.assertGreater(len(self.text(line, "-o", "x.npy").splitlines()), len(got))

    def test_bounds_of_pairs(self):
        """Kernel and distance each have their own."""
        for method in ("direct", "iterative"):
            r = self.report("pairs patch-9.off --input p.txt --t 3h2,30h2 --method " + method)
            bounds = r["kernel_bound"], r["distance_bound"]
            self.assertTrue(bounds[0] != bounds[1] and min(bounds) > 0 and max(bounds) == r["error_bound"], r)
        r = self.report("pairs patch-9.off --input p.txt --definition commute")
        self.assertEqual((r["distance_bound"], "kernel_bound" in r), (r["error_bound"], False))

    def test_numbers_of_info(self):
        plain, r = self.report("info askew.obj"), self.report("info askew.obj --intrinsic-delaunay")
        self.assertAlmostEqual(r["h"], plain["h"], 12)
        self.assertAlmostEqual(r["area"], plain["area"], 9)
        self.assertTrue(r["smallest_angle"] == plain["smallest_angle"] < r["smallest_intrinsic_angle"])
        a, b = self.report("info squashed.obj --lengths sides-98.txt"), self.report("info patch-7.obj")
        for name in ("h", "area", "smallest_angle"):
            self.assertAlmostEqual(a[name], b[name], 12)
        v = cloud(300)[0]
        h = sum(min(math.dist(p, q) for q in v if q is not p) for p in v) / 300
        self.assertAlmostEqual(self.report("info cloud-300.xyz")["h"] / h, 1, delta=1e-13)
        for line, cut in (("info cloud-300.xyz", 1e8), ("info cloud-300.xyz --weight-cut 1e-4", 1e4)):
            r = self.report(line)
            self.assertAlmostEqual(r["cut_radius"], math.sqrt(4 * r["bandwidth"] * math.log(cut)), delta=1e-12)
        self.assertLess(r["most_in_row"], self.report("info cloud-300.xyz")["most_in_row"])
        for line, factor in (("info cloud-300.xyz --laplacian exp --bandwidth 0.4h2", 0.4),
                             ("info twice.xyz --bandwidth 2h2", 2)):
            self.assertAlmostEqual(self.report(line)["bandwidth"] / (factor * r["h"] ** 2), 1, delta=1e-13)

    def test_times_and_errors(self):
        r = self.report("kernel patch-9.off --source 1,2 --t 2,40h2")
        self.assertAlmostEqual(r["times"][1], 40 * r["h"] ** 2)
        self.assertEqual((r["times"][0], r["evidence"]["rounding"] != "none"), (2, True))
        for method in ("direct", "krylov"):
            seconds = self.report("kernel torus-80-50.obj --source 1,2 --t 3h2,30h2 --method " + method)["seconds"]
            self.assertTrue(seconds["factor"] > 0 and sum(seconds[k] for k in STAGES) >= 0.9 * seconds["total"] - 0.05, seconds)
        r = self.report("hks square-12.obj --filter wave:5,0.4")
        self.assertEqual((r["evidence"]["rational"], r["per_time"][0]["t"]), ("measured", None))
        r = self.report("geodesic patch-9.off --source 1,2")
        self.assertAlmostEqual(r["times"][0], r["h"] ** 2)
        r = self.report("geodesic cloud-300.xyz --source 0 --t 4h2")
        self.assertAlmostEqual(r["times"][0] / (4 * r["edge"] ** 2), 1)


class Limits(Case):
    """What runs take, told before and after."""

    def dry(self, line, *more):
        words(line)
        before = everything()
        r = json.loads(self.good(line, *more, "--dry-run", "--json", "-o", "never.npy").stdout)
        self.assertEqual((everything(), r["dry_run"]), (before, True))
        return r

    def narrow(self, line, part):
        """A limit between the bytes in use and those needed, and the report of a run that it refuses."""
        d = self.dry(line)
        limit = int(d["bytes_in_use"] + part * (d["estimate"]["bytes"] - d["bytes_in_use"]))
        d = self.dry(line, "--memory-limit", limit)
        self.assertFalse(d["estimate"]["fits"])
        return limit, sorted(d["ways_out"])

    def test_memory_limit(self):
        """Auto takes what fits, and says why; what is asked for and does not fit is an error."""
        run = "kernel torus-80-50.obj --t 60h2 --source " + ",".join(str(9 * i) for i in range(12))
        peak = {m: self.report(run + " --method " + m)["peak_bytes"] for m in METHODS}
        want = read_npy(taken("report.npy"))
        self.assertTrue(peak["direct"] > 1.3 * peak["krylov"] > 1.69 * peak["iterative"], peak)
        for limit, methods in ((1.1 * peak["direct"], METHODS), (0.9 * peak["direct"], METHODS[1:]),
                               (1.05 * peak["krylov"], METHODS[1:]),
                               (0.9 * peak["krylov"], METHODS[3:]), (1.1 * peak["iterative"], METHODS[3:])):
            r = self.report(run, "--memory-limit", int(limit))
            self.assertLessEqual(r["peak_bytes"], limit)
            self.assertIn(r["method"], methods)
            self.assertIn("limit" if methods == METHODS[3:] else "", r["reason"])
            self.close(read_npy(taken("report.npy")), want, 1e-7)
        for method in ("direct", "krylov"):
            self.bad(1, "limit", run, "--method", method, "--memory-limit", int(0.9 * peak[method]), "-o", "never.npy")

    def test_dry_run(self):
        """What a run takes is told without a result, and is what it takes then."""
        file("p.txt", "1 2\n5 9\n")
        for line in ("kernel --source 0,5 --t 10h2", "diffuse --input waves-4000-2.npy --t 1h2,10h2", "hks --t auto:16",
                     "distance --source 0 --t 3h2",
                     "pairs --input p.txt --t 10h2", "sample --count 4 --t 3h2"):
            for run in (line + " torus-80-50.obj", line + " --method direct torus-80-50.obj"):
                d, r = self.dry(run), self.report(run)
                e = d["estimate"]
                self.assertEqual((d["method"], e, d["ways_out"]), (r["method"], d["methods"][r["method"]], {}))
                self.assertTrue(e["fits"] and e["flops"] > 0 and e["seconds"] > 0)
                if d["method"] == "direct":
                    self.assertTrue(d["analysed"] and e["bytes_most"] >= r["peak_bytes"])
                    if r["degree"] == 9:
                        self.assertTrue(0.999 * r["peak_bytes"] <= e["bytes"] <= 1.3 * r["peak_bytes"], (run, e, r["peak_bytes"]))
                text = self.good(run, "--dry-run")
                self.assertEqual(text.stderr, b"")
                self.assertRegex(text.stdout.decode(), r"dry run: method \w+ \(.+\)\n(.|\n)*flops(.|\n)*MB")
        for run, least, most in (("trace --t auto:16", 0.999, 1.3), ("hks --normalise --t 5h2", 0.999, 1.3),
                                 ("hks --scale-invariant 3 --t 1h2,100h2", 0.999, 1.3),
                                 ("geodesic --source 0", 0, 9), ("spectrum -k 20", 0.9, 1.6),
                                 ("spectrum -k 20 --below 30", 0.9, 1.6), ("spectrum --below 30", 0.9, 1.6)):
            d, r = self.dry(run + " torus-80-50.obj"), self.report(run + " torus-80-50.obj")
            e = d["estimate"]
            self.assertTrue(e["fits"] and e["flops"] > 0 and d["analysed"], (run, d))
            self.assertTrue(run[0] == "g" or list(d["methods"]) == ["direct"] == [d["method"]]
                            and r["method"] in ("direct", "lanczos"), (run, d["methods"]))
            self.assertTrue(least * r["peak_bytes"] <= e["bytes"] <= most * r["peak_bytes"], (run, e, r["peak_bytes"]))

    def test_samples(self):
        """Of many samples at a late time eigenpairs answer, and poles are not tried before them. At others each waits for those before."""
        run = " graded-40.obj --t 0.02"
        self.assertEqual([r["reason"] for r in (self.dry("sample --count 10" + run), self.dry("distance --source 0" + run))],
                         ["at such a t few eigenpairs are left: answers are sums over them",
                          "diagonals and distances to all need the direct method, or at a time local"])
        r = self.report("sample --count 10" + run)
        self.assertEqual((r["poles"], r["seconds"]["invert"]), ("none", 0))
        self.assertLess(r["error_bound"], 1e-6)
        one, many = (self.dry(line + " torus-80-50.obj --t 3h2")["estimate"]["seconds"]
                     for line in ("distance --source " + ",".join(map(str, range(100))), "sample --count 100"))
        self.assertGreater(many, 1.5 * one)

    def test_what_would_fit(self):
        """A run that does not fit says what it needs, what is allowed, and what else would do."""
        run = "kernel torus-80-50.obj --source 0 --t 10h2 -o never.npy"
        need = self.dry(run.split(" -o")[0] + " --method direct")["estimate"]["bytes"]
        limit = int(0.7 * need)
        text = self.bad(1, "%.1f MB are needed, and %.1f MB are allowed" % (1e-6 * need, 1e-6 * limit), run, "--method",
                        "direct", "--memory-limit", limit)
        for way in ("iterative", "krylov"):
            self.assertRegex(text, r"--method %s needs [0-9.]+ MB[,\n]" % way)
            self.good(run, "--method", way, "--memory-limit", limit)
        os.remove(path("never.npy"))
        for run in ("hks", "distance --source 0", "sample --count 2"):
            run += " torus-80-50.obj --t 1h2 -o never.npy --memory-limit 10M"
            for method, end in (("direct", "--method local needs less\n"), ("auto", "--method local needs less\n"), ("local", "needed, ")):
                self.bad(1, end, run, "--method", method)
        run, ways = "distance torus-80-50.xyz --source 0 --t 3h2", ["--tufted", "--weight-cut 1e-4"]
        d = self.dry(run)
        self.assertEqual(list(d["ways_out"]), ["--tufted"])          # told in any case: it is a small part
        limit = int(0.5 * d["estimate"]["bytes"])
        self.bad(1, like(r"--tufted needs [0-9.]+ MB, --weight-cut 1e-4 needs [0-9.]+ MB"), run, "--memory-limit", limit, "-o",
                 "never.npy")
        d = self.dry(run, "--memory-limit", limit)
        self.assertEqual((d["estimate"]["fits"], sorted(d["ways_out"])), (False, ways))
        self.assertLess(d["ways_out"]["--tufted"], limit)
        for option, way in d["ways_out"].items():                    # what they need is what they are said to need
            self.assertAlmostEqual(way / self.dry(run, *option.split())["estimate"]["bytes"], 1, delta=0.02)
        self.good(run, "--tufted", "--memory-limit", limit, "-o", "x.npy")
        # other methods, and eigenpairs: failing and --dry-run name the same ways
        for run, more in (("kernel torus-80-50.xyz --source 0 --t 10h2 --method krylov", ["--method iterative"]),
                          ("kernel torus-80-50.xyz --source 0 --t 10h2 --method iterative --solver cocg", ["--solver lanczos"]),
                          ("spectrum torus-80-50.xyz -k 40", ["-k 10"])):
            limit, told = self.narrow(run, 0.3)
            self.assertEqual(told, sorted(ways + more))
            text = self.bad(1, "", run, "--memory-limit", limit, "-o", "no.npy")
            for way in told:
                self.assertIn(way + " needs ", text)
        self.assertIn("--method local", self.narrow("kernel torus-150-100.obj --source 0 --t 1h2 --method direct", 0.3)[1])
        # and do not name what excludes what was asked for, or what is there already
        run = "kernel torus-24-12.xyz --source 0 --t 10h2 --method "
        for line, more in ((run + "direct --degree 8", ["--method iterative"]),
                           (run + "direct --poles uniform --weight-cut 1e-3", ["--method iterative"]),
                           (run + "iterative --degree 8", ["--precond jacobi"]),
                           (run + "iterative --poles uniform", ["--precond jacobi"]), ("spectrum torus-24-12.xyz -k 4", [])):
            told = self.narrow(line, 0.3)[1]
            self.assertLessEqual(set(told), set((ways[:1] if "--weight-cut" in line else ways) + more), line)
            self.assertIn("--tufted", told)
        self.bad(1, like(r"matrices alone need at least [0-9.]+ MB, and 1.0 MB are allowed .*; --tufted and --weight-cut 1e-4 need less"),
                 "spectrum torus-80-50.xyz -k 4 --memory-limit 1M -o no.npy")
        run = "kernel torus-60-40.obj --source 0,1,2 --t 1h2,2h2,4h2 --method direct --degree 12"
        limit = self.narrow(run, 0.3)[0]
        text = self.text(run, "--memory-limit", limit, "--dry-run")
        self.assertIn(": too much", text)
        for way in ("--method iterative", "--degree 8"):
            self.assertRegex(text, way + r" needs [0-9.]+ MB and about")
        self.bad(1, "--degree 8 needs ", run, "--memory-limit", limit)


# ---- terminals and signals ----

def default_interrupts():
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@unittest.skipUnless(POSIX, "needs terminals and signals")
class Terminals(Case):
    """The progress bar, and Ctrl-C."""
    MANY = ",".join(map(str, range(40)))
    SLOW = "kernel torus-300-200.obj --source %s --solver cocg --precond jacobi --tol 1e-12 --t 100000h2,200000h2" % MANY

    def on_a_terminal(self, line, word=None, signals=0, output=subprocess.DEVNULL):
        """The exit status, and what goes to standard error when that is a terminal. When word is seen, interrupts are sent."""
        import pty
        master, slave = pty.openpty()
        p = subprocess.Popen([TOOL] + words(line), cwd=FOLDER, stdin=subprocess.DEVNULL, stdout=output or slave, stderr=slave,
                             preexec_fn=default_interrupts)
        os.close(slave)
        text = b""
        try:
            while True:
                block = os.read(master, 4096)
                if not block:
                    break
                text += block
                if word and word in text:
                    word = None
                    for _ in range(signals):
                        p.send_signal(signal.SIGINT)
                        time.sleep(0.002)
        except OSError:                          # it has ended
            pass
        os.close(master)
        return p.wait(timeout=60), text

    def test_bar(self):
        run = "kernel torus-40-24.obj --source 0,1,2,3 --t 2000h2 --solver cocg -o bar.npy"
        code, text = self.on_a_terminal(run)
        self.assertTrue(code == 0 and b"%" in text and b"\r" in text, text)
        self.assertEqual(self.on_a_terminal(run + " --quiet"), (0, b""))
        code, text = self.on_a_terminal("render ico.obj --input count-12.txt -o -", output=None)
        self.assertEqual((code, b"nothing for a terminal" in text), (2, True))
        code, text = self.on_a_terminal("smooth ico.ply", output=None)
        self.assertEqual((code, b"nothing for a terminal" in text), (2, True))

    def test_bar_of_factorisations(self):
        for mesh, method, parts_of in (("torus-400-300.obj", "direct",
                                        (b"] ", b"% factor, time ", b"time 2 of 3", b"time 3 of 3")),
                                        ("torus-300-200.obj", "krylov",
                                         (b"% solve, source ", b"source 2 of 3", b"source 3 of 3"))):
            code, text = self.on_a_terminal("kernel --threads 1 --source 0,1,2 --t 200h2,300h2,400h2 -o bar.npy --method %s %s" %
                                            (method, mesh))
            self.assertEqual(code, 0)
            for word in parts_of:
                self.assertIn(word, text)
            self.assertTrue(method == "krylov" or b"% order" in text or b"% analyse" in text)
            for line in text.split(b"\r"):
                self.assertLessEqual(len(line.split(b"\n")[0]), 79 if b"%" in line else 1000)

    def test_when_the_bar_says_what_runs(self):
        """The signal comes while it computes, however busy the machine is; a second one does not wait for the end."""
        mesh = " torus-300-200.obj -o new.npy"
        file("keep.npy", "precious")
        for word, line in ((b"% solve", self.SLOW + " -o new.npy"), (b"% ", self.SLOW + " -o keep.npy"),
                           (b"% solve", "kernel --source %s --t 1h2,10000h2 --method krylov" % self.MANY + mesh),
                           (b"% ", "kernel --source %s --t auto:20" % self.MANY + mesh),
                           (b"% ", "sample --count 1000 --definition commute" + mesh),
                           (b"% factor", "kernel --source %s --t auto:20 --method direct" % self.MANY + mesh),
                           (b"% ", "geodesic -o new.npy torus-500-300.obj --source " + self.MANY), (b"% ", "spectrum -k 300" + mesh),
                           (b"% ", "hks --t auto:20 --dry-run" + mesh)):
            for signals in (1, 2):
                words(line)
                before = everything()
                code, text = self.on_a_terminal(line, word, signals)
                self.assertNotIn(b"error", text)
                self.assertIn(code, (0, 130) if "--dry-run" in line else (130,), (line, text))
                self.assertTrue(signals == 2 or code == 0 or b"heatdiff: interrupted" in text, text)
                self.assertEqual(everything(), before)
        self.assertEqual(taken("keep.npy"), b"precious")

    def test_while_writing(self):
        """Text of 150 000 rows of 60 columns is long to write."""
        head = npy_bytes([[0.0]]).replace(b"1, 1", b"150000, 60")[:-8]
        size = head.index(b"\n") + 1 - 10
        file("wide.npy", head[:8] + struct.pack("<H", size) + head[10:] + struct.pack("<60d", *range(60)) * 150000)
        args, before = words("diffuse torus-500-300.obj --input wide.npy --t 0 -o wide.txt"), everything()
        for seconds in (0.6, 1.0, 1.5, 2.2):
            p = subprocess.Popen([TOOL] + args, cwd=FOLDER, stderr=subprocess.PIPE, preexec_fn=default_interrupts)
            time.sleep(seconds)
            p.send_signal(signal.SIGINT)
            text = p.communicate(timeout=120)[1]
            self.assertIn(p.returncode, (0, 130), text)
            if p.returncode == 0 or os.path.exists(path("wide.txt")):    # a fast machine: the file was in its place, and whole
                self.assertEqual(sum(len(line.split()) == 60 for line in taken("wide.txt").splitlines()), 150000)
            self.assertEqual(everything(), before)

    def test_waiting_for_standard_input(self):
        p = subprocess.Popen([TOOL, "info", "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             preexec_fn=default_interrupts)
        time.sleep(0.3)
        p.send_signal(signal.SIGINT)
        self.assertEqual(p.wait(timeout=20), 130)
        for stream in (p.stdin, p.stdout, p.stderr):
            stream.close()


# ---- geodesics ----

def geodesic_dense(mesh, source, t):
    """The heat method with lumped masses, on a mesh in one piece: directions by cross products, the last vertex held at zero."""
    v, f = mesh
    n = len(v)
    L, B = cotan_and_fem(v, f)
    u = solve([[t * L[i][j] + (sum(B[i]) if i == j else 0.0) for j in range(n)] for i in range(n)],
              [[float(i == source)] for i in range(n)])
    b = [[0.0] for _ in range(n)]
    for c in f:
        edge = [sub(v[c[(k + 2) % 3]], v[c[(k + 1) % 3]]) for k in range(3)]
        normal = cross(edge[0], edge[1])
        turned = [cross(normal, e) for e in edge]
        x = [-sum(abs(u[c[k]][0]) * turned[k][i] for k in range(3)) for i in range(3)]
        for k in range(3):                      # the hat function of corner k rises along turned[k]
            b[c[k]][0] += dot(x, turned[k]) / length(x) / length(normal) / 2 if length(x) > 0 else 0
    for i in range(n):
        L[i][n - 1] = L[n - 1][i] = float(i == n - 1)
    b[n - 1][0] = 0.0
    phi = [row[0] for row in solve(L, b)]
    return [[abs(p - phi[source])] for p in phi]


class Geodesic(Case):
    """The method itself is checked by tests/test_geodesic_all.h."""

    def test_dense(self):
        for name in ("ico.obj", "patch-4.obj"):
            h = self.report("info " + name)["h"]
            for more, tau in (("", 1), (" --t 1h2", 1), (" --t 5h2", 5), (" --t %.17g" % (0.3 * h * h), 0.3)):
                for source in (0, 7):
                    self.close(self.rows("geodesic %s --source %d%s" % (name, source, more)),
                               geodesic_dense(spec(name)[2], source, tau * h * h), 1e-9)

    def test_options(self):
        """Each changes the distances; which are right is checked by the runner's geodesic_all."""
        for mesh, *options in (("quads-16-12.obj", "", "--tufted", "--laplacian fem", "--lambda 1", "--t 4h2",
                                "--t 4h2 --border mean"),
                               ("askew.obj", "", "--intrinsic-delaunay")):
            got = [self.rows("geodesic --source 109", mesh, *o.split()) for o in options]
            for q, a in enumerate(got):
                self.assertTrue(all(a != b for b in got[:q]), options[q])
        v = quads(16, 12)[0]
        self.assertLess(sum(abs(g[0] - math.dist(p, v[109])) for g,
                            p in zip(self.rows("geodesic quads-16-12.obj --source 109"), v)) / len(v), 0.3)
        v = cloud(300)[0]
        want = [math.acos(max(-1.0, min(1.0, dot(v[0], p)))) for p in v]
        self.assertLess(sum(abs(g[0] - w) for g, w in zip(self.rows("geodesic cloud-300.xyz --source 0"), want)) / len(v), 0.06)
        self.assertEqual(self.rows("geodesic squashed.obj --lengths - --source 23", input=lines_of(SIDES).encode()),
                         self.rows("geodesic squashed.obj --lengths sides-98.txt --source 23"))

    def test_out_of_reach(self):
        got = self.rows("geodesic twins.obj --source 3,25,40")
        for i, r in enumerate(got):
            self.assertEqual([math.isinf(x) for x in r], [i >= 25, i != 25, i <= 25], i)
        self.assertEqual(got[25][1], 0)
        for name in ("apart.ply", "apart.vtu", "apart.npy", "apart.csv", "apart.obj"):
            self.data(name, "geodesic twins.obj --source 3,40")
        self.assertGreater(read_png(self.data("apart.png", "geodesic twins.obj --source 3,25,40 --size 300x200"))[2], 50)
        self.assertEqual(self.rows("geodesic two.obj --source 0,12 --matrix"), [[0.0, math.inf], [math.inf, 0.0]])
        self.assertEqual([g[0] for g in self.rows("geodesic unlike.obj --source 2 --nearest")], [0.0] * 25 + [-1.0] * 16)

    def test_nearest(self):
        """Regions are what the columns say, with any distance."""
        for line, times in (("geodesic quads-9-5.obj --source 0,9,59,31", 1),
                            ("distance quads-9-5.obj --source 3,50,7 --t 1h2,20h2", 2),
                            ("distance quads-9-5.obj --source 3,50 --definition biharmonic", 1)):
            for a, g in zip(self.rows(line), self.rows(line + " --nearest")):
                for k in range(times):
                    d = a[k::times]
                    self.assertEqual(g[2 * k:2 * k + 2], [float(d.index(min(d))), min(d)])

    def test_matrix(self):
        """Symmetric to the bit, zero on the diagonal, and the means of both directions."""
        sources = (3, 40, 77, 99, 3)
        for line, times in (("geodesic patch-9.off", 1), ("distance patch-9.off --t 2h2,30h2", 2),
                            ("distance patch-9.off --definition commute", 1)):
            every = self.rows(line + " --source 3,40,77,99,3")
            got = self.rows(line + " --source 3,40,77,99,3 --matrix")
            self.assertEqual((len(got), len(got[0])), (5, 5 * times))
            for k in range(times):
                for i, v in enumerate(sources):
                    for j, w in enumerate(sources):
                        a, b = every[v][j * times + k], every[w][i * times + k]
                        self.assertEqual(got[i][j * times + k], got[j][i * times + k])
                        self.assertAlmostEqual(got[i][j * times + k], 0 if i == j else (a + b) / 2, delta=1e-14 * max(a, b, 1))
        r = self.report("geodesic patch-9.off --source 3,40 --matrix -o m.csv")
        one = self.rows("geodesic patch-9.off --source 3,40")
        self.assertAlmostEqual(r["asymmetry"], abs(one[3][1] - one[40][0]))
        self.assertEqual(r["unreached"], 0)


def read_off(data):
    """Places and faces."""
    rows = [row.split() for row in data.decode().splitlines()]
    n, m = int(rows[1][0]), int(rows[1][1])
    assert rows[0] == ["OFF"] and len(rows) == n + m + 2 and all(int(row[0]) == len(row) - 1 for row in rows[n + 2:])
    return [[float(x) for x in row] for row in rows[2:n + 2]], [tuple(map(int, row[1:])) for row in rows[n + 2:]]


class Smooth(Case):
    """Vertices move as their coordinates diffuse."""

    def smooth(self, line, *more):
        """Places and faces, and the report, which tells how far they went."""
        r = self.report("smooth -o s.off " + line, *more)
        return *read_off(taken("s.off")), r

    def test_coordinates_diffuse(self):
        for mesh, more in (("patch-9.off", "--t 2h2"), ("ico.obj", ""), ("mixed.obj", "--t 0.3"), ("parts.obj", "--t 1h2 --laplacian cot"),
                           ("cloud-300.xyz", "--tufted --t 3h2"), ("patch-9.off", "--t 2/l1 --method krylov")):
            v, f = spec(mesh)[2]
            got, faces, r = self.smooth(mesh + " " + more)
            t = more if "--t " in more else more + " --t 1h2"
            want = self.rows("diffuse %s --input" % mesh, file("v.txt", [[float(x) for x in p] for p in v]), *t.split())
            self.close(got, want, 1e-6)
            self.assertEqual(faces, [tuple(c) for c in f if len(c) > 2])
            away = [math.dist(p, q) for p, q in zip(v, got)]
            self.assertAlmostEqual(r["moved_most"], max(away), 12)
            self.assertAlmostEqual(r["moved_mean"], sum(away) / len(away), 12)
            self.assertTrue(0 < r["coordinate_error"] < 1e-6 and max(away) > 1e-3, r)
        v = spec("loose.obj")[2][0]
        self.assertEqual(self.smooth("loose.obj --t 3h2")[0][12], list(v[12]))           # in no face
        self.assertEqual(self.smooth("ico.obj --t 0")[0], [list(p) for p in icosahedron()[0]])

    def test_bound(self):
        """Against the truth, also far from the origin, where coordinates are large and moves small."""
        v, f = spec("patch-4.obj")[2]
        m = dense_modes("patch-4.obj", "fem")
        for away in (0.0, 2.0 ** 20):
            file("away.obj", obj_text([(x + away, y, z) for x, y, z in v], f))
            got, _, r = self.smooth("away.obj --t 0.5")
            want = transposed([m.applied(heat(0.5), [p[c] for p in v]) for c in range(3)])
            off = max(abs(a - b - away * (c == 0)) for p, q in zip(got, want) for c, (a, b) in enumerate(zip(p, q)))
            self.assertTrue(off <= r["coordinate_error"] + 1e-12 and r["coordinate_error"] < 1e-6, (off, r["coordinate_error"]))

    def test_borders(self):
        """Held, they stay where they are, and what is inside tends to a shape with L x = 0. Without a border nothing is held."""
        v, f = spec("patch-4.obj")[2]
        L, B = cotan_and_fem(v, f)
        inside = [6, 7, 8, 11, 12, 13, 16, 17, 18]
        A, M = ([[X[i][j] for j in inside] for i in inside] for X in (L, B))
        C = cholesky(M)
        values, q = jacobi(solve(C, transposed(solve(C, A))))
        m = Modes(values, solve(transposed(C), transposed(q)), matmul(C, transposed(q)))
        y = solve(A, [[sum(L[i][j] * v[j][c] for j in range(25)) for c in range(3)] for i in inside])
        for t in (0.3, 3.0, 1000.0):
            got, _, r = self.smooth("patch-4.obj --border dirichlet --t %r" % t)
            want = [list(p) for p in v]
            for c in range(3):
                for i, a, b in zip(inside, m.applied(heat(t), [row[c] for row in y]), y):
                    want[i][c] += a - b[c]
            self.assertEqual([p for i, p in enumerate(got) if i not in inside], [list(p) for i, p in enumerate(v) if i not in inside])
            self.close(got, want, 1e-8)
            self.assertLess(max(abs(a - b) for p, q in zip(got, want) for a, b in zip(p, q)), (r["coordinate_error"] or 1) + 1e-12)
            self.assertTrue(t > 100 or r["coordinate_error"] < 1e-6)     # what has faded has no relative bound
        self.close(self.smooth("ico.obj --border dirichlet --t 2h2")[0], self.smooth("ico.obj --t 2h2")[0], 1e-9)
        mixed = file("mixed.off", off_text(*apart(patch(4), icosahedron())))     # one piece with a border, one without
        h2 = self.report("info " + mixed)["h"] ** 2
        got = self.smooth(mixed + " --border dirichlet --t 1h2")[0]
        ball = self.smooth("ico.obj --t", repr(h2))[0]
        self.close(got[25:], [[x + 10, y, z] for x, y, z in ball], 1e-9)
        self.close(got[:25], self.smooth("patch-4.obj --border dirichlet --t", repr(h2))[0], 1e-9)

    def test_formats(self):
        """The same shape in each, and without -o in the one that was read."""
        want, faces, _ = self.smooth("roof.obj --t 0.2")
        for e in ("obj", "off", "ply", "stl", "OBJ"):
            self.good("smooth roof.obj --t 0.2 -o r." + e)
            got, same, _ = self.smooth("r.%s --t 0" % e)
            if e == "stl":                       # corners of triangles, in 32 bits
                self.assertEqual((len(got), len(same)), (6, 4))
                got, same = sorted(got), faces
                self.close(got, sorted(want), 1e-6)
            else:
                self.close(got, want, 1e-15)
            self.assertEqual(same, faces)
        self.assertEqual(counted(self.data("r.vtu", "smooth roof.obj --t 0.2")), (6, 3))
        for name, head in (("ico.obj", b"v "), ("ico.off", b"OFF\n12 20 0\n"), ("ico.ply", b"ply\n"), ("ico.stl", b"binary STL"),
                           ("cloud-300.xyz", b"")):
            for more in ((), ("-o", "-")):
                out = self.good("smooth", name, *more).stdout
                self.assertTrue(out.startswith(head) and len(out) > 300)
                self.assertEqual(self.report("info " + file("out." + name[-3:], out))["n"], 300 if name[-3:] == "xyz" else 12)
        self.bad(1, "too large for the 32 bits of STL", "smooth --t 0 -o x.stl", file("big.obj", obj_text(*of_corners((0, 0, 0), (1e39, 0, 0), (0, 1e39, 0)))))
        self.assertRegex(self.good("smooth patch-9.off -o x.obj").stderr.decode(),
                         r"\Asmooth of patch-9.off: vertices moved by \S+ on average, \S+ at most, t = 1h2, fem Laplacian, method \w+\n"
                         r"each coordinate is off by at most \S+; \S+ s, \S+ MB\n\Z")


class Levels(Case):
    """Level sets of fields, against lines that are known."""

    def lines(self, mesh, values, levels):
        """Whether each line is closed, its level and its points. values: a file, or numbers."""
        field = values if isinstance(values, str) else file("field.txt", [[x] for x in values])
        out = []
        for row in numbers(self.good("levels", mesh, "--input", field, *levels.split()).stdout):
            if int(row[0]) == len(out):
                out.append((row[1] == 1, row[2], []))
            out[int(row[0])][2].append(tuple(row[3:]))
        return out

    def length(self, line):
        points = line[2] + line[2][:1] if line[0] else line[2]
        return sum(math.dist(p, q) for p, q in zip(points, points[1:]))

    def test_grid(self):
        """x on a grid has straight lines, through vertices too, of quadrangles and of triangles."""
        mesh = quads(7, 4, 0.5)
        x = [p[0] for p in mesh[0]]
        for name, content in (("quads.obj", mesh), ("triangles.obj", triangles(mesh))):
            got = self.lines(file(name, obj_text(*content)), x, "--levels 0.2,1.5,3.3")
            self.assertEqual([(c, level) for c, level, _ in got], [(False, 0.2), (False, 1.5), (False, 3.3)])
            for line in got:
                self.assertTrue(all(abs(p[0] - line[1]) < 1e-15 and p[2] == 0 for p in line[2]))
                self.assertEqual(sorted(p[1] for p in line[2]), sorted(set(p[1] for p in line[2])))
                self.assertAlmostEqual(self.length(line), 2, delta=1e-14)
            self.assertEqual(self.lines(name, x, "--levels -1,9"), [])
            self.assertEqual([level for _, level, _ in self.lines(name, x, "--levels auto:6")], [0.5, 1, 1.5, 2, 2.5, 3])

    def test_sphere(self):
        """Circles of latitude of a fine sphere, closed: 2 pi sqrt(1 - z^2) up to the error of a polygon."""
        z = [p[2] for p in sphere(3)[0]]
        got = self.lines("sphere-3.obj", z, "--levels -0.6,0.01,0.8")
        self.assertEqual([c for c, _, _ in got], [True] * 3)
        for line in got:
            self.assertTrue(all(abs(p[2] - line[1]) < 1e-14 for p in line[2]))
            self.assertAlmostEqual(self.length(line) / (2 * math.pi * math.sqrt(1 - line[1] ** 2)), 1, delta=0.01)
        r = self.report("levels --input field.txt --levels -0.6,0.8,2 sphere-3.obj -o l.obj")
        self.assertEqual(r["lengths"][2], 0)
        self.assertAlmostEqual(r["lengths"][1], self.length(got[2]), delta=1e-12)
        rows = [row.split() for row in taken("l.obj").decode().splitlines()]
        self.assertEqual(sum(row[0] == "v" for row in rows), r["points"])
        loops = [row[1:] for row in rows if row[0] == "l"]
        self.assertEqual([float(row[1][6:]) for row in rows if row[0] == "g"], [-0.6, 0.8])
        self.assertTrue(len(loops) == 2 and all(row[0] == row[-1] and len(set(row)) == len(row) - 1 for row in loops))

    def test_saddle(self):
        """A quadrangle with two corners above and two below, crosswise: the mean of the corners tells which hang together."""
        for high, corners in ((3.0, {(1.0, 0.0), (0.0, 1.0)}), (0.5, {(0.0, 0.0), (1.0, 1.0)})):
            # corners 0 and 3 of the file are at opposite ends
            got = self.lines("quad.obj", [high, -1.0, -1.0, high], "--levels 0")
            self.assertEqual(len(got), 2)
            near = {min([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)],
                        key=lambda c: sum(math.dist(c, p[:2]) for p in line[2])) for line in got}
            self.assertEqual(near, corners)

    def test_at_vertices(self):
        """What touches the level only in a vertex or an edge has no line; a level that is asked for twice has its lines once."""
        for top in ([1.0] + [0.0] * 11, [1.0, 1.0] + [0.0] * 10):
            self.assertEqual(self.lines("ico.obj", top, "--levels 1"), [])
        file("top.txt", [[1.0]] + [[0.0]] * 11)
        once, twice = (self.good("levels ico.obj --json --input top.txt --levels " + x) for x in ("0.5", "0.5,1,0.5"))
        self.assertEqual(once.stdout, twice.stdout)
        a, b = json.loads(once.stderr), json.loads(twice.stderr)
        self.assertEqual((b["lines"], b["lengths"]), (1, [a["lengths"][0], 0, a["lengths"][0]]))
        self.assertAlmostEqual(a["lengths"][0], 5, 12)           # a pentagon around a vertex of edges of length 2
        # upright; by faces with a corner twice, which have no lines of their own
        file("wall.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\nf 1 1 2\nf 3 3 4\nf 1 1 3\n")
        self.assertEqual([(c, sorted(p)) for c, _, p in self.lines("wall.obj", [0, 1, 1, 0], "--levels 0.5")],
                         [(False, [(0.5, 0, 0), (0.5, 0, 1)])])

    def test_rounding(self):
        """Points lie between the ends of their edges, where rounding would lead outside and where differences overflow."""
        x, y = 1 + 2.0 ** -52, -0.75 * 2.0 ** -52
        file("close.obj", obj_text(*of_corners((x, -x, 0.0), (y, -y, 0.0), (y, -y, 1.0))))
        (_, _, points), = self.lines("close.obj", [0, 1, 1], "--levels 0.99999999999999989")
        self.assertTrue(all(y <= p[0] <= x and -x <= p[1] <= -y for p in points), points)
        file("one.obj", obj_text(*of_corners((0, 0, 0), (1, 0, 0), (0, 1, 0))))
        (_, _, points), = self.lines("one.obj", [-1.7e308, 1.7e308, 1.7e308], "--levels 0")
        self.assertEqual(sorted(points), [(0, 0.5, 0), (0.5, 0, 0)])
        file("far.obj", "v -1.7e308 0 0\nv 1.7e308 0 0\nv 0 1 0\nf 1 2 3\n")
        (_, _, points), = self.lines("far.obj", [0, 1, 1], "--levels 0.25")
        for got, want in zip(sorted(p[0] for p in points), (-1.275, -0.85)):
            self.assertAlmostEqual(got / 1e308, want, delta=1e-14)

    def test_of_distances(self):
        """Any result of the tool is a field: circles around a vertex. Distances that are infinite have no lines."""
        self.good("geodesic grid-20-20.obj --source 220,0 --border mean --t 4h2 -o d.npy")
        got = self.lines("grid-20-20.obj", "d.npy", "--levels 6")
        self.assertEqual([c for c, _, _ in got], [True])
        self.assertAlmostEqual(self.length(got[0]) / (12 * math.pi), 1, delta=0.05)
        self.assertEqual([c for c, _, _ in self.lines("grid-20-20.obj", "d.npy", "--column 1 --levels 6")], [False])
        distance = [row[0] for row in self.rows("geodesic ico.obj --source 0")]
        want = self.lines("ico.obj", distance, "--levels 1,2")
        self.assertEqual(len(want), 2)
        for name in ("d.txt", "d.npy"):
            self.good("geodesic two.obj --source 0 -o " + name)
            got = self.lines("two.obj", name, "--levels 1,2")
            self.assertEqual([c for c, _, _ in got], [c for c, _, _ in want])
            for a, b in zip(got, want):
                self.assertLess(max(map(math.dist, a[2], b[2])), 1e-9)
        self.assertAlmostEqual(self.report("levels two.obj --input d.npy --levels auto:1")["levels"][0], max(distance) / 2, 9)


class Demo(Case):
    def test_demo(self):
        """In the folder that it takes by default, which is there already. Drawing the pictures takes a while: once for all."""
        os.makedirs(path("here/heatdiff-demo"))
        p = self.good("demo --json", cwd=path("here"))
        self.assertEqual(os.listdir(path("here")), ["heatdiff-demo"])
        names = os.listdir(path("here/heatdiff-demo"))
        shapes = []
        for name in ("elephant", "bent", "noisy"):
            with open(path("here/heatdiff-demo/%s.obj" % name), "rb") as f:
                shapes.append(read_obj(f.read()))
        for (v, faces), most in zip(shapes[1:], (1.5, 0.03)):
            self.assertEqual((len(v), faces), (len(shapes[0][0]), shapes[0][1]))
            away = [math.dist(p, q) for p, q in zip(shapes[0][0], v)]
            self.assertTrue(0.4 * most < max(away) < most, max(away))
        bent = [[(2 + z) * math.sin(x / 2), y, (2 + z) * math.cos(x / 2) - 2] for x, y, z in shapes[0][0]]
        self.close(shapes[1][0], bent, 1e-12)
        self.assertLessEqual({"heat-trunk.png", "heat-trunk.ply", "isolines.png", "distance.png", "signature.png"}, set(names))
        for name in names:
            data = taken("here/heatdiff-demo/" + name)
            if name.endswith(".png"):
                self.assertGreater(read_png(data)[2], 50, name)
            else:
                mesh = self.report("info " + file("demo.ply", data))
                self.assertGreater(min(mesh["n"], mesh["faces"]), 100)
            self.assertIn(name, p.stdout.decode())
        r = json.loads(p.stderr)
        self.assertEqual((len(r["sources"]), len(r["times"])), (2, 4))
        self.assertLess(r["mass_drift"], 1e-9)

    def test_folder_that_cannot_be(self):
        """Told before anything is computed."""
        words("info ico.obj")
        folders = ["ico.obj", "no/such/folder", "x" * 300, "." + "/." * 1100]
        if POSIX:
            folders.append("dangling")
            os.symlink(path("nowhere"), path("dangling"))
        for folder in folders:
            self.bad(1, "cannot make this folder", "demo -o", folder)
        p = self.run_tool("demo -o empty --memory-limit 1000")  # and a run that ends early makes it and writes nothing there
        self.assertEqual((p.returncode, b"memory limit" in p.stderr), (1, True))
        self.assertEqual(os.listdir(path("empty")), [])


def main():
    global TOOL
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit("usage: python3 test_cli.py PATH_TO_HEATDIFF [unittest options]")
    TOOL = os.path.abspath(sys.argv.pop(1))
    if not os.path.exists(TOOL):
        sys.exit("%s is not there; build it with: cc -O2 tools/heatdiff.c -o heatdiff -lm" % TOOL)
    unittest.main()


if __name__ == "__main__":
    main()
