"""Tests of the command-line tool, through its command line only.

    python3 tests/test_cli.py PATH_TO_HEATDIFF [unittest options]

Needs nothing but Python 3. Makes its meshes itself, in a temporary folder. Numbers are checked against a dense matrix
exponential in plain Python on tiny meshes, and against what must hold on any mesh (conservation, symmetry, column order).
"""
import atexit
import base64
import json
import math
import os
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as ElementTree
import zlib

TOOL = None
POSIX = os.name == "posix"
COMMANDS = ("info", "kernel", "diffuse", "distance", "pairs", "hks", "trace", "sample", "geodesic", "spectrum", "levels",
            "render", "demo")


# ---- meshes ----

def icosahedron():
    g = (1 + 5 ** 0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1),
         (-g, 0, -1), (-g, 0, 1)]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4),
         (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return [tuple(map(float, p)) for p in v], f


def bumpy_patch(k):
    """A (k+1) x (k+1) grid with a border, not flat and not regular."""
    rnd = random.Random(4)
    v = [(x + 0.2 * rnd.random(), y + 0.2 * rnd.random(), 0.7 * math.sin(0.9 * x) * math.cos(0.7 * y))
         for y in range(k + 1) for x in range(k + 1)]
    f = []
    for y in range(k):
        for x in range(k):
            a = y * (k + 1) + x
            f += [(a, a + 1, a + k + 2), (a, a + k + 2, a + k + 1)]
    return v, f


def torus(n, m):
    v, f = [], []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
            v.append(((3 + math.cos(b)) * math.cos(a), (3 + math.cos(b)) * math.sin(a), math.sin(b)))
            p, q = i * m + j, ((i + 1) % n) * m + j
            r, s = i * m + (j + 1) % m, ((i + 1) % n) * m + (j + 1) % m
            f += [(p, q, s), (p, s, r)]
    return v, f


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


def obj_text(v, f):
    return "".join("v %.17g %.17g %.17g\n" % p for p in v) + "".join("f " + " ".join(str(i + 1) for i in t) + "\n" for t in f)


def off_text(v, f):
    return "OFF\n%d %d 0\n" % (len(v), len(f)) + "".join("%.17g %.17g %.17g\n" % p for p in v) + \
        "".join("%d " % len(t) + " ".join(map(str, t)) + "\n" for t in f)


# ---- dense reference, for tiny meshes ----

def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def norm_cross(a, b):
    return math.sqrt(max(0.0, dot(a, a) * dot(b, b) - dot(a, b) ** 2))


def cotan_and_fem(v, f):
    n = len(v)
    L = [[0.0] * n for _ in range(n)]
    B = [[0.0] * n for _ in range(n)]
    for t in f:
        area = norm_cross(sub(v[t[1]], v[t[0]]), sub(v[t[2]], v[t[0]])) / 2
        for c in range(3):
            i, j, k = t[c], t[(c + 1) % 3], t[(c + 2) % 3]
            a, b = sub(v[i], v[k]), sub(v[j], v[k])
            w = dot(a, b) / norm_cross(a, b) / 2
            for p, q, s in ((i, j, -w), (j, i, -w), (i, i, w), (j, j, w)):
                L[p][q] += s
            B[i][i] += area / 6
            for p, q in ((i, j), (j, i)):
                B[p][q] += area / 12
    return L, B


def matmul(a, b):
    bt = list(zip(*b))
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


def heat_matrix(L, B, t):
    """exp(-t B^-1 L): Taylor series and repeated squaring."""
    n = len(L)
    a = [[-t * x for x in row] for row in solve(B, L)]
    k = max(0, int(math.ceil(math.log2(max(1e-9, max(sum(map(abs, r)) for r in a))))) + 4)
    a = [[x / 2 ** k for x in row] for row in a]
    eye = [[float(i == j) for j in range(n)] for i in range(n)]
    term = total = eye
    for i in range(1, 15):
        term = [[x / i for x in row] for row in matmul(term, a)]
        total = [[x + y for x, y in zip(r, s)] for r, s in zip(total, term)]
    for _ in range(k):
        total = matmul(total, total)
    return total


# ---- readers of the outputs ----

def numbers(text, separator=None):
    return [[float(x) for x in line.split(separator)] for line in text.splitlines() if line.strip() and not line.startswith("#")]


def csv(text):
    """The names and the rows of a .csv."""
    names, rows = text.split("\n", 1)
    rows = numbers(rows, ",")
    names = names.split(",")
    assert all(len(r) == len(names) for r in rows) and len(set(names)) == len(names), names
    return names, rows


def read_npy(data):
    assert data[:6] == b"\x93NUMPY", data[:6]
    size = struct.unpack("<H", data[8:10])[0] if data[6] == 1 else struct.unpack("<I", data[8:12])[0]
    start = 10 if data[6] == 1 else 12
    header = eval(data[start:start + size].decode("latin-1"), {"__builtins__": {}}, {"False": False, "True": True})
    assert header["descr"] == "<f8", header
    shape = header["shape"]
    rows, columns = shape[0], shape[1] if len(shape) > 1 else 1
    v = struct.unpack("<%dd" % (rows * columns), data[start + size:])
    if header["fortran_order"]:
        return [[v[c * rows + r] for c in range(columns)] for r in range(rows)]
    return [list(v[r * columns:(r + 1) * columns]) for r in range(rows)]


def npy_bytes(rows, fortran=False, flat=False):
    n, k = len(rows), len(rows[0])
    values = [rows[r][c] for c in range(k) for r in range(n)] if fortran else [x for r in rows for x in r]
    header = "{'descr': '<f8', 'fortran_order': %s, 'shape': (%s), }" % (fortran, "%d," % n if flat else "%d, %d" % (n, k))
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + struct.pack("<%dd" % len(values), *values)


PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H", "int": "i",
             "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}


def read_ply(data):
    """Returns the vertices as dicts and the faces as lists."""
    head, _, body = data.partition(b"end_header\n")
    lines = head.decode().splitlines()
    assert lines[0] == "ply"
    style = lines[1].split()[1]
    elements = []
    for line in lines[2:]:
        w = line.split()
        if w[0] == "element":
            elements.append((w[1], int(w[2]), []))
        elif w[0] == "property":
            elements[-1][2].append(w[1:])
    order = ">" if style == "binary_big_endian" else "<"
    tokens, at, result = iter(body.split()) if style == "ascii" else None, 0, {}

    def take(kind):
        nonlocal at
        if tokens:
            return float(next(tokens))
        x = struct.unpack_from(order + PLY_TYPES[kind], body, at)[0]
        at += struct.calcsize(PLY_TYPES[kind])
        return x
    for name, count, properties in elements:
        rows = []
        for _ in range(count):
            row = {}
            for p in properties:
                row[p[-1]] = [int(take(p[2])) for _ in range(int(take(p[1])))] if p[0] == "list" else take(p[0])
            rows.append(row)
        result[name] = rows
    assert tokens or at == len(body), "bytes behind the end"
    return result["vertex"], [next(iter(f.values())) for f in result.get("face", [])]


def read_png(data):
    """Checks every chunk, returns width, height and the set of distinct pixel byte groups (not unfiltered)."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, image, size, names = 8, b"", None, []
    while at < len(data):
        n, name = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + n]
        assert struct.unpack(">I", data[at + 8 + n:at + 12 + n])[0] == zlib.crc32(name + chunk) & 0xffffffff
        names.append(name)
        if name == b"IHDR":
            size = struct.unpack(">IIBBBBB", chunk)
        if name == b"IDAT":
            image += chunk
        at += 12 + n
    assert names[-1] == b"IEND"
    channels = {0: 1, 2: 3, 3: 1, 6: 4}[size[3]]
    pixels = zlib.decompress(image)
    assert len(pixels) == size[1] * (1 + size[0] * channels * size[2] // 8)
    return size[0], size[1], len(set(pixels))


def read_vtu(data):
    """Returns the point-data arrays by name, and the number of points and cells. Knows ascii, base64 and raw appended."""
    raw = None
    cut = re.search(rb"<AppendedData[^>]*encoding=\"raw\"[^>]*>\s*_", data)
    if cut:
        raw = data[cut.end():]
        data = data[:cut.start()] + b"</VTKFile>"
    root = ElementTree.fromstring(data)
    piece = root.find(".//Piece")
    header = {"UInt32": "I", "UInt64": "Q"}[root.get("header_type", "UInt32")]
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    kinds = {"Float64": "d", "Float32": "f", "Int32": "i", "Int64": "q", "UInt8": "B", "UInt32": "I"}

    def values(array):
        kind = kinds[array.get("type")]
        if array.get("format") == "ascii":
            return [float(x) for x in (array.text or "").split()]
        block = raw[int(array.get("offset")):] if array.get("format") == "appended" else base64.b64decode(array.text.strip())
        n = struct.unpack_from(order + header, block)[0]
        skip = struct.calcsize(header)
        return list(struct.unpack(order + "%d%s" % (n // struct.calcsize(kind), kind), block[skip:skip + n]))
    points = values(piece.find("Points/DataArray"))
    assert len(points) == 3 * int(piece.get("NumberOfPoints"))
    connectivity = [values(a) for a in piece.findall("Cells/DataArray") if a.get("Name") == "connectivity"][0]
    assert all(0 <= i < int(piece.get("NumberOfPoints")) for i in connectivity)
    return ({a.get("Name"): values(a) for a in piece.findall("PointData/DataArray")}, int(piece.get("NumberOfPoints")),
            int(piece.get("NumberOfCells")))


# ---- running ----

def absent(what):
    """Ends a test for want of a program; where nothing may be skipped it fails."""
    raise (AssertionError if os.environ.get("HEATDIFF_NO_SKIP") else unittest.SkipTest)(what)


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="heatdiff-test-")
        cls.small = cls.file("small.obj", obj_text(*icosahedron()))
        cls.patch = cls.file("patch.off", off_text(*bumpy_patch(9)))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def file(cls, name, content):
        path = os.path.join(cls.folder, name)
        with open(path, "wb") as f:
            f.write(content if isinstance(content, bytes) else content.encode())
        return path

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @staticmethod
    def run_tool(*args, stdin=b"", cwd=None, timeout=300):
        return subprocess.run([TOOL] + [str(a) for a in args], input=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=cwd,
                              timeout=timeout)

    def good(self, *args, **more):
        p = self.run_tool(*args, **more)
        self.assertEqual(p.returncode, 0, (args, p.stderr))
        return p

    def bad(self, code, *args, **more):
        """Runs what must fail with this code, and returns its one error line."""
        p = self.run_tool(*args, **more)
        text = p.stderr.decode(errors="replace")
        self.assertEqual(p.returncode, code, (args, text))
        self.assertTrue(text.startswith("heatdiff: error: ") and text.endswith("\n"), (args, text))
        self.assertEqual(text.count("\n"), 1, (args, text))
        return text

    def field(self, *args, **more):
        return numbers(self.good(*args, "--quiet", **more).stdout.decode())

    def close(self, a, b, tol):
        scale = max(max(map(abs, r)) for r in b)
        self.assertEqual((len(a), len(a[0])), (len(b), len(b[0])))
        worst = max(abs(x - y) for r, s in zip(a, b) for x, y in zip(r, s))
        self.assertLessEqual(worst, tol * scale)


def columns(rows, *which):
    return [[r[c] for c in which] for r in rows]


class Usage(Case):
    def kernel(self, *more):
        return self.bad(2, "kernel", self.small, *more)

    def test_commands(self):
        for args in ([], ["nosuch"], ["nosuch", self.small], ["Kernel", self.small], [""]):
            text = self.bad(2, *args)
            for name in COMMANDS:
                self.assertIn(name, text)

    def test_times(self):
        for t in ("-1", "nan", "inf", "-inf", "abc", "", ",", "1,", ",1", "1,,2", "h2", "1h", "1h3", "1 h2", "0x10", "1e999", "1e999h2", "auto",
                  "auto:", "auto:0", "auto:-3", "auto:1.5", "auto:1000000000000", " 1", "1 ", "1;2", "-0.5h2", "1h2h2", "1.2.3", "--1", "+-1"):
            for form in (["--t=" + t], ["--t", t]):
                self.assertIn("--t takes", self.kernel("--source", 0, *form))

    def test_sources(self):
        for s in ("-3", "1.5", "a", "", "1,,2", "1,", "0x1", "1e3", " 1", "1-2", "1+", "+,1", "2:", "2:0.5", "2:0.5,", "2:0.7,0.4", "2:-0.1,0.4", "2:a,b", "*3", "0.5*", "nan*3",
                  "1:0.2,0.3,0.5:1,1"):
            for form in (["--source=" + s], ["--source", s]):
                self.assertIn("--source takes", self.kernel("--t", 1, *form))

    def test_values(self):
        for option, value in (("laplacian", "nosuch"), ("laplacian", ""), ("degree", "0"), ("degree", "15"), ("degree", "7.5"), ("degree", "x"),
                              ("poles", "best"), ("tol", "0"), ("tol", "-1"), ("tol", "1"), ("tol", "nan"), ("method", "magic"),
                              ("method", ""), ("ordering", "metis"), ("ordering", "own"), ("simd", "sse"), ("simd", "avx"),
                              ("solver", "cg2"), ("precond", "amg2"), ("kernel", "own"), ("threads", "0"), ("threads", "-1"), ("threads", "x"),
                              ("max-iterations", "0"), ("memory-limit", "0"), ("memory-limit", "5X"), ("memory-limit", "-5"),
                              ("isolines", "-1"), ("range", "1"), ("range", "2,1"), ("range", "1,nan"), ("view", "1"), ("view", "0,91"),
                              ("size", "100"), ("size", "0x0"), ("size", "1000000x1000000"), ("size", "-100x100"), ("colormap", "nosuch"),
                              ("column", "-1")):
            text = self.kernel("--t", 1, "--source", 0, "--%s=%s" % (option, value))
            self.assertIn("--%s takes" % option, text)
            self.kernel("--t", 1, "--source", 0, "--" + option, value)

    def test_values_that_begin_well(self):
        for option, value in (("range", "x,1"), ("range", "1;2"), ("range", "1,2,"), ("range", "0,0X1"), ("range", ".,1"), ("view", "3601,0"), ("view", "0,1,2"), ("size", "x"), ("size", "64x"),
                              ("size", "64x64x"), ("size", "9000x64"), ("size", "64x9000"), ("size", "64x63"), ("memory-limit", "x"), ("memory-limit", "0.5"),
                              ("memory-limit", "1e19"), ("memory-limit", "5KK"), ("threads", "1025"), ("filter", "a-name-of-no-filter:1"), ("filter", "none:1"), ("filter", "wave:x,1"),
                              ("filter", "wave:1,x"), ("filter", "wave:1,0"), ("filter", "band:2"), ("filter", "heat:1/l1x"), ("source", "2:0.1,-0.4"), ("source", "2:0.1,x"),
                              ("source", "2:0.1;0.2"), ("title", "")):
            self.assertIn("--%s takes" % option, self.bad(2, "kernel", self.small, "--%s=%s" % (option, value)))
        for command, option, value in (("spectrum", "below", "x"), ("spectrum", "below", "0"), ("spectrum", "tol", "x"), ("render", "input", ""), ("levels", "levels", "auto:x"), ("levels", "levels", "auto:3x"),
                                       ("levels", "levels", "auto:0"), ("levels", "levels", "auto:1001"), ("levels", "levels", "1,x"), ("levels", "levels", "1;")):
            self.assertIn("--%s takes" % option, self.bad(2, command, self.small, "--%s=%s" % (option, value)))
        self.assertEqual(self.field("kernel", self.small, "--source=0", "--t=.5"), self.field("kernel", self.small, "--source=0:1,0", "--t=0.5"))

    def test_what_excludes_each_other(self):
        def refused(text, *args):
            self.assertIn(text, self.bad(2, *args, self.small))
        kernel, pairs, hks, matrix = ("kernel", "--source", 0, "--t", 1), ("pairs", "--input", "p.txt"), ("hks",), ("distance", "--source", 0, "--t", 1, "--matrix")
        refused("--filter takes no --poles", "kernel", "--source", 0, "--filter", "heat:1", "--poles", "kernel")
        for more in (("--solver", "cocg"), ("--precond", "ildl"), ("--method", "iterative")):
            refused("read off the factors", *pairs, "--filter", "heat:1", *more)
        refused("--ordering takes no --precond", *kernel, "--ordering", "amd", "--precond", "ildl")
        refused("single time", "sample", "--count", 3, "--t", "auto:3")
        refused("--method takes auto or direct", *pairs, "--definition", "commute", "--method", "krylov")
        refused("--method takes auto or direct", *pairs, "--definition", "commute", "--method", "iterative")
        refused("--solver takes --definition", *pairs, "--definition", "commute", "--solver", "cocg")
        refused("--precond takes --definition", *pairs, "--definition", "biharmonic", "--precond", "ildl")
        refused("at most --count", "sample", "--count", 1, "--t", 1, "--source", "0,1")
        refused("--normalise takes no --filter", *hks, "--normalise", "--filter", "heat:1")
        for t in ("auto:2,1", "1,auto:2"):
            refused("the first and the last time", *hks, "--scale-invariant", 2, "--t", t)
        refused("exp has no gradient", "geodesic", "--source", 0, "--laplacian", "exp")
        refused("one time above 0", "geodesic", "--source", 0, "--t", "auto:3")
        refused("exp needs coordinates", *kernel, "--lengths", "l.txt", "--laplacian", "exp")
        refused("--weight-cut for exponential", *kernel, "--lengths", "l.txt", "--weight-cut", "1e-4")
        for more in (("--source", "0+1"), ("--curve",), ("--source-file", "s.txt")):
            refused("--matrix takes vertices", *[a for a in matrix if more[0] != "--source" or a not in ("--source", 0)], *more)
        refused("needs --levels", "levels", "--input", "f.txt")
        for name in ("--lengths", "--source-file"):
            self.assertIn(name + " takes a file name here", self.bad(2, "kernel", "-", "--t", 1, "--source", 0, name, "-"))
        self.assertIn("read only once", self.bad(2, "kernel", self.small, "--t", 1, "--source-file", "-", "--lengths", "-"))
        self.assertIn("read only once", self.bad(2, "render", "-", "--input", "-", "-o", "x.png"))
        self.assertIn("for 2 meshes", self.bad(2, "render", self.small, self.small, "--input", "f.txt", "-o", "x.png"))
        self.assertIn("not ''", self.bad(2, "info", ""))
        self.assertIn("at most 12 meshes", self.bad(2, "render", *["a.obj"] * 13, "--input", "f.txt", "-o", "x.png"))
        self.assertIn("up to twelve times", self.bad(2, "render", "a.obj", *["--input=f.txt"] * 13, "-o", "x.png"))
        self.assertIn(".png here", self.bad(2, "render", "a.obj", "--input=f.txt", "-o", "x.txt"))
        for more in (("--source", "0:0.2,0.3,1,2"), ("--source", "0+1,2+3,4+5", "--curve"), ("--source", "0,1,2", "--source-file", self.file("one.txt", "3\n"))):
            self.assertEqual(len(self.field("sample", self.small, "--count", 2, "--t", 1, *more)), 2)     # places to stay away from are not counted
        field = self.file("ones.txt", "1\n" * 12)
        self.good("diffuse", self.small, "--t", 1, "--input", field, "--degree", 1, "--method", "direct")
        for t in ("1", "auto:1"):
            self.good("sample", self.small, "--count", 2, "--t", t)
            self.good("geodesic", self.small, "--source", 0, "--t", t)

    def test_names_options(self):
        self.assertIn("--nosuch", self.kernel("--t", 1, "--source", 0, "--nosuch"))
        self.assertIn("-x", self.kernel("--t", 1, "--source", 0, "-x"))
        self.assertIn("--input", self.kernel("--t", 1, "--source", 0, "--input", "f.txt"))
        self.assertIn("--quiet", self.kernel("--t", 1, "--source", 0, "--quiet=yes"))
        for option in ("--t", "--source", "-o", "--laplacian"):
            self.assertIn(option, self.bad(2, "kernel", self.small, option))

    def test_missing(self):
        self.assertIn("--source", self.kernel("--t", 1))
        self.assertIn("--t", self.kernel("--source", 0))
        self.assertIn("mesh", self.bad(2, "kernel", "--t", 1, "--source", 0))
        self.assertIn("--input", self.bad(2, "diffuse", "--t", 1, self.small))
        self.assertIn("--input", self.bad(2, "render", self.small, "-o", "x.png"))
        self.assertIn("-o", self.bad(2, "render", self.small, "--input", "f.txt"))
        self.bad(2, "info")

    def test_too_many(self):
        self.bad(2, "info", self.small, self.small)
        self.bad(2, "demo", self.small)
        self.assertIn("twice", self.kernel("--t", 1, "--t", 2, "--source", 0))
        self.assertIn("twice", self.kernel("--t", 1, "--source", 2, "--source", 0))
        self.bad(2, "diffuse", "-", "--input", "-", "--t", 1)

    def test_degree_one_belongs_to_uniform(self):
        self.assertIn("--degree", self.kernel("--t", 1, "--source", 0, "--degree", 1))
        self.good("kernel", self.small, "--t", 1, "--source", 0, "--degree", 1, "--poles", "uniform")

    def test_what_belongs_to_which_method(self):
        def refused(name, *args):
            text = self.kernel("--t", 1, "--source", 0, *args)
            self.assertIn(name + " takes", text)
            self.bad(2, "diffuse", self.small, "--input", "f.txt", "--t", 1, *args)
        refused("--degree", "--method", "krylov", "--degree", 7)
        refused("--poles", "--method", "krylov", "--poles", "kernel")
        for method in ("krylov", "direct"):
            refused("--solver", "--method", method, "--solver", "cocg")
            refused("--solver", "--solver", "lanczos", "--method", method)
            refused("--precond", "--method", method, "--precond", "ildl")
        refused("--ordering", "--method", "iterative", "--ordering", "amd")
        refused("--ordering", "--solver", "cocr", "--ordering", "dissection")
        for args in (["--method", "direct", "--degree", 9, "--poles", "kernel"], ["--method", "direct", "--ordering", "amd"],
                     ["--method", "krylov", "--ordering", "dissection"], ["--method", "krylov", "--tol", "1e-6"], ["--ordering", "amd"],
                     ["--method", "auto", "--solver", "cocr"], ["--method", "iterative", "--ordering", "auto"], ["--simd", "none"]):
            self.good("kernel", self.small, "--t", 1, "--source", 0, *args)
        self.assertIn("--method", self.bad(2, "info", self.small, "--method", "direct"))

    def test_help_names_what_options_take(self):
        text = self.good("kernel", "--help").stdout.decode()
        for option, values in (("method", "direct krylov iterative auto"), ("ordering", "amd dissection auto"), ("simd", "none avx2 avx512 auto")):
            part = text[text.index("--" + option):].split("\n      --")[0]
            for value in values.split():
                self.assertIn(value, part)

    def test_unknown_extension_lists_formats(self):
        for name in ("x", "x.foo", "x.npy.gz", "png", ".npyx", "x."):
            text = self.kernel("--t", 1, "--source", 0, "-o", self.path(name))
            for e in (".txt", ".csv", ".npy", ".ply", ".obj", ".vtu", ".png"):
                self.assertIn(e, text)
        self.bad(2, "render", self.small, "--input", "f.txt", "-o", self.path("x.txt"))

    def test_usage_comes_before_files(self):
        self.bad(2, "kernel", self.path("not-there.obj"), "--t", "abc", "--source", 0)

    def test_help_and_version(self):
        for args in (["--help"], ["-h"]):
            p = self.good(*args)
            self.assertIn(b"kernel", p.stdout)
            self.assertEqual(p.stderr, b"")
        for c in COMMANDS:
            for h in ("--help", "-h"):
                self.assertIn(c.encode(), self.good(c, h).stdout)
        with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "heatdiff.h"), encoding="utf-8") as f:
            header = dict(re.findall(r"^#define HD_VERSION_(MAJOR|MINOR|PATCH) (\d+)$", f.read(), re.M))
        self.assertEqual(self.good("--version").stdout.decode(), "heatdiff %(MAJOR)s.%(MINOR)s.%(PATCH)s\n" % header)

    def test_both_forms_and_any_order(self):
        a = self.field("kernel", self.small, "--source", 1, "--t", "2h2")
        self.assertEqual(a, self.field("kernel", "--t=2h2", "--source=1", self.small))
        self.assertEqual(a, numbers(self.good("kernel", "--t=2h2", "--source=1", "--quiet", "--", self.small).stdout.decode()))
        self.assertEqual(a, self.field("kernel", "--t=+2h2", "--source", "+1", self.small))

    def test_fuzz(self):
        rnd = random.Random(7)
        words = ["kernel", "info", "diffuse", "render", "hks", "--definition", "--definition=commute", "--count=3", "--poles=diagonal", "--t", "--t=", "--t=1h2", "--t=auto:2", "--source", "--source=0", "--source=0,0", "--degree",
                 "5", "-1", "nan", "--json", "--quiet", "-o", "-", "--", "---", "--=", "-=", "=", "--t==1", "fem", "--laplacian=cot", "--poles=kernel",
                 "1,2", "%s%n", "%n", "\u00e9", "\n", "x" * 3000, "--" + "y" * 3000, "--source=" + "9" * 50, "--source=" + "1," * 200, "--size=64x64",
                 "--range=0,1", "--isolines=3", "--tol=1e-3", "--threads=2", "--input", "--max-iterations=1", "--memory-limit=1", self.small,
                 self.small, self.small]
        for _ in range(250):
            args = [rnd.choice(COMMANDS[:-1])] + [rnd.choice(words) for _ in range(rnd.randrange(7))]
            with self.subTest(args=args):
                p = self.run_tool(*args, cwd=self.folder, stdin=b"0 1\n", timeout=60)
                self.assertIn(p.returncode, (0, 1, 2), (args, p.stderr))
                if p.returncode:
                    self.assertEqual(p.stderr.count(b"heatdiff: error: "), 1, (args, p.stderr))
                    self.assertEqual(p.stderr.count(b"\n"), 1, (args, p.stderr))


def file_limit(size):
    """What sets a limit of the size of files before the tool runs. The hard limit stays."""
    def limit():
        import resource
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    return limit


class Failures(Case):
    def kernel(self, content, name="bad.obj"):
        out = self.path("out.txt")
        path = content if os.path.sep in str(content) else self.file(name, content)
        text = self.bad(1, "kernel", path, "--source", 0, "--t", "1h2", "-o", out)
        self.assertFalse(os.path.exists(out))
        return text

    def test_meshes(self):
        good = obj_text(*icosahedron())
        self.assertIn("bad.obj:33", self.kernel(good + "f 1 2 999\n"))
        self.assertIn("bad.obj:1", self.kernel(good.replace("v ", "v nan ", 1)))
        self.assertIn("bad.obj:3", self.kernel("v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n"))
        self.assertIn("bad.obj", self.kernel("# nothing here\n"))
        self.assertIn("bad.obj", self.kernel(""))
        self.assertIn("bad.obj", self.kernel(bytes(random.Random(1).randrange(256) for _ in range(4000))))
        self.assertIn("bad.obj", self.kernel("v 0 0 0\nv 1 0 0\nv 2 0 0\n"))        # points on a line: no area

    def test_every_cut_of_a_mesh_is_handled(self):
        good = off_text(*icosahedron()).encode()
        for k in range(0, len(good), 37):
            p = self.run_tool("info", self.file("cut.off", good[:k]), "--quiet")
            self.assertIn(p.returncode, (0, 1), (k, p.stderr))

    def test_files(self):
        self.assertIn("not-there.obj", self.kernel(self.path("not-there.obj")))
        self.kernel(self.folder)
        self.bad(1, "kernel", self.small, "--source", 0, "--t", 1, "-o", self.path("no/such/folder/x.txt"))

    def test_meshes_of_every_command(self):
        """A mesh that is not there, and one that no heat can be on."""
        line = self.file("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        field, pairs = self.file("three.txt", "1\n2\n3\n"), self.file("two.txt", "0 1\n")
        for command, *more in (("kernel", "--source", 0, "--t", 1), ("diffuse", "--input", field, "--t", 1), ("distance", "--source", 0, "--t", 1), ("hks", "--t", 1),
                               ("pairs", "--input", pairs, "--t", 1), ("trace", "--t", 1), ("sample", "--count", 1, "--t", 1), ("geodesic", "--source", 0),
                               ("spectrum", "-k", 1), ("levels", "--input", field, "--levels", 1), ("render", "--input", field, "-o", self.path("r.png")), ("info",)):
            self.assertIn("not-there.obj: cannot open", self.bad(1, command, self.path("not-there.obj"), *more))
            if command not in ("levels", "render", "info"):
                self.bad(1, command, line, *more)

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs /dev/full")
    def test_full_disk(self):
        with open("/dev/full", "wb") as full:
            p = subprocess.run([TOOL, "kernel", self.small, "--source", "0", "--t", "1", "--quiet"], stdout=full, stderr=subprocess.PIPE)
        self.assertEqual(p.returncode, 1)
        self.assertEqual(p.stderr.count(b"heatdiff: error: "), 1)

    @unittest.skipUnless(POSIX, "needs limits")
    def test_file_size_limit(self):
        """A limit of the file's size is told as a full disk is, and leaves nothing."""
        mesh = self.file("torus.obj", obj_text(*torus(60, 40)))             # files larger than the buffer
        before = sorted(os.listdir(self.folder))
        for out in ("limit.txt", "limit.csv", "limit.npy", "limit.ply", "limit.obj", "limit.vtu", "limit.png"):
            run = [TOOL, "kernel", mesh, "--source", "0", "--t", "1h2,2h2", "--quiet", "-o", self.path(out)]
            p = subprocess.run(run, stderr=subprocess.PIPE, preexec_fn=file_limit(1000))
            self.assertEqual(p.returncode, 1, p.stderr)
            self.assertRegex(p.stderr.decode(), r"^heatdiff: error: .*limit\....: cannot write: .*\n$")
            self.assertEqual(sorted(os.listdir(self.folder)), before)

    @unittest.skipUnless(POSIX, "needs limits")
    def test_file_size_limit_of_every_command(self):
        """The same for each command and each kind of file that it writes."""
        values, pairs = self.file("values.txt", "\n".join(map(str, range(12)))), self.file("pairs.txt", "0 1\n2 3\n")
        fields = ("txt", "csv", "npy", "ply", "obj", "vtu", "png")
        for name, kinds, *more in (("diffuse", fields, "--input", values, "--t", "1"), ("distance", fields, "--source", "0", "--t", "1"),
                                   ("pairs", fields[:3], "--input", pairs, "--t", "1"), ("hks", fields, "--t", "1"),
                                   ("trace", fields[:3], "--t", "1"), ("sample", fields[:3], "--t", "1", "--count", "3"),
                                   ("geodesic", fields, "--source", "0"), ("spectrum", fields, "--count", "3"),
                                   ("levels", ("txt", "csv", "npy", "obj"), "--input", values, "--levels", "auto:3"),
                                   ("render", ("png",), "--input", values)):
            for kind in kinds:
                with self.subTest((name, kind)):
                    run = (name, self.small, *more, "--quiet", "-o", self.path("over." + kind))
                    text = self.hostile(*run, limit=file_limit(10))
                    self.assertIn("over.%s: cannot write: " % kind, text)

    @unittest.skipUnless(POSIX, "needs limits")
    def test_outputs_that_cannot_be(self):
        """A folder nobody may write to, a folder in place of the file, a link to itself, a file in place of the folder."""
        locked, loop, folder = self.path("locked"), self.path("loop.txt"), self.path("folder.txt")
        os.mkdir(locked, 0o555)
        os.mkdir(folder)
        os.symlink(loop, loop)
        os.chmod(self.folder, 0o755)

        def nobody():
            if os.getuid() == 0:
                os.setuid(65534)
        try:
            runnable = subprocess.run([TOOL, "--version"], preexec_fn=nobody, stdout=subprocess.DEVNULL).returncode == 0
        except (OSError, subprocess.SubprocessError):
            runnable = False                     # the tool is where only root may look
        if runnable:
            self.assertIn("cannot write", self.hostile("kernel", self.small, "--source", "0", "--t", "1", "-o", locked + "/x.txt", limit=nobody))
        for out in (loop, folder, os.path.join(self.small, "x.txt"), self.path("no/folder/x.txt")):
            self.assertIn("cannot write", self.hostile("kernel", self.small, "--source", "0", "--t", "1", "-o", out))
        self.assertEqual(os.listdir(locked) + os.listdir(folder), [])
        self.assertIn("cannot open", self.hostile("info", loop))
        os.remove(loop)
        os.rmdir(locked)
        os.rmdir(folder)

    def hostile(self, *args, stdin=subprocess.DEVNULL, most=1 << 30, memory=False, limit=None):
        """Runs what must fail in one line, in little memory and time, leaving the folder as it is. memory: lack of it is told."""
        import resource
        before = sorted(os.listdir(self.folder))

        def limits():
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
            if limit:
                limit()
        p = subprocess.run([TOOL, *args], stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60, preexec_fn=limits)
        text = p.stderr.decode(errors="replace")
        self.assertEqual(p.returncode, 1, text)
        self.assertRegex(text, r"^heatdiff: error: [^\n]*\n$")
        self.assertLess(len(text), 600)
        self.assertEqual("memory" in text, memory, text)
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        return text

    @unittest.skipUnless(POSIX, "needs limits")
    def test_endless_lines(self):
        """Lines of 100 and of 20 MB: none is gone through again for each of its bytes."""
        size, long = 20 << 20, 100 << 20
        for name, content in (("word.ply", b"ply\nformat ascii 1.0\nelement " + b"x" * size), ("comment.ply", b"ply\ncomment " + b"x" * size),
                              ("name.stl", b"solid " + b"x" * size), ("blank.obj", b" " * size), ("digits.off", b"OFF\n1 1 0 " + b"1" * size),
                              ("digits.xyz", b"0 0 " + b"1" * long), ("zero.obj", b"v 0 0 0\0" * (size // 8))):
            with self.subTest(name):
                path = self.file(name, content)
                self.assertIn(name, self.hostile("info", path))
                os.remove(path)
        for name, content in (("names.csv", b"a," * (size // 2)), ("commas.csv", b"," * size), ("quotes.csv", b'"' * long),
                              ("open.csv", b'"' + b"x" * size), ("quoted.csv", b'"a",' * (size // 4))):
            with self.subTest(name):
                path = self.file(name, content)
                self.assertIn(name, self.hostile("diffuse", self.small, "--input", path, "--t", "1"))
                os.remove(path)

    @unittest.skipUnless(POSIX, "needs limits")
    def test_endless_input(self):
        """What never ends is read up to the memory that there is."""
        with open("/dev/zero", "rb") as zeros:
            self.hostile("info", "-", stdin=zeros, most=1 << 28, memory=True)
            zeros.seek(0)
            self.hostile("diffuse", self.small, "--input", "-", "--t", "1", stdin=zeros, most=1 << 28, memory=True)

    @unittest.skipUnless(POSIX, "needs limits")
    def test_hostile_meshes(self):
        """Counts of 2^60, headers that promise more than is there, lines without an end, zero bytes, devices."""
        huge = 1 << 60
        ply = "ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n" \
              "element face %d\nproperty list %s int vertex_indices\nend_header\n"
        for name, content in (("n.off", "OFF\n%d 1 0\n0 0 0\n" % huge), ("f.off", "OFF\n1 %d 0\n0 0 0\n" % huge),
                              ("k.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n%d 0 1 2\n" % huge), ("m.off", "OFF\n2147483647 2147483647 0\n0 0 0\n"),
                              ("a.ply", ply % ("ascii", huge, huge, "uchar")), ("b.ply", ply % ("binary_little_endian", huge, huge, "uchar") + "\0" * 40),
                              ("c.ply", ply % ("binary_big_endian", 2 ** 31 - 1, 1, "uchar") + "\0" * 40),
                              ("d.ply", (ply % ("binary_little_endian", 1, 1, "uint")).encode() + b"\0" * 12 + b"\xff" * 8),
                              ("a.stl", b"x" * 80 + b"\xff" * 4 + b"y" * 50), ("points.xyz", "%d\n0 0 0\n" % huge),
                              ("zero.obj", b"v 0 0 0\n\0v 1 0 0\nv 0 1 0\nf 1 2 3\n"), ("zeros.obj", b"\0" * 100000),
                              ("digits.obj", b"v " + b"1" * 20000000), ("corners.obj", b"f " + b"1 " * 5000000), ("word.obj", b"v " + b"x" * 20000000),
                              ("minus.obj", "v 0 0 0\nf -9223372036854775808 -9223372036854775808 99999999999999999999\n")):
            with self.subTest(name):
                self.assertIn(name, self.hostile("info", self.file(name, content)))
        for device in ("/dev/zero", "/dev/urandom", "/dev/full", "/dev/null"):
            if os.path.exists(device):
                self.assertIn(device, self.hostile("info", device))

    @unittest.skipUnless(POSIX, "needs limits")
    def test_hostile_fields(self):
        def npy(head):
            data = b"\x93NUMPY\x01\0" + struct.pack("<H", len(head)) + head + b"\0" * 96
            return self.hostile("diffuse", self.small, "--input", self.file("h.npy", data), "--t", "1")
        start = b"{'descr': '<f8', 'fortran_order': False, 'shape': "
        for shape, text in (("(%d, 16)" % (1 << 60), "1152921504606846976 x 16 numbers"), ("(12, %d)" % (1 << 60), "1152921504606846976 columns"),
                            ("(%d, %d)" % (1 << 32, 1 << 32), "4294967296 columns"), ("(4294967296,)", "4294967296 x 1 numbers"),
                            ("(%d, 16)" % 10 ** 16, "10000000000000000 x 16 numbers"), ("(%d,)" % 10 ** 30, "announces 1" + "0" * 30),
                            ("(12, 1" + "0" * 60000 + ")", "announces 1000"), ("(-1, 12)", "shape"), ("(" * 60000, "shape"),
                            ("(12" + ", 1" * 20000 + ")", "20001 dimensions"), ("(12\0, 1)", "shape")):
            with self.subTest(shape[:60]):
                self.assertRegex(npy(start + shape.encode() + b", }\n"), r"h\.npy: .*" + text)
        for head in (b"(" * 60000, b"{'descr': " * 6000, b"[[" * 30000, b"{" * 60000):
            with self.subTest(head[:20]):
                self.assertIn("h.npy: the type of its numbers", npy(head))
        for content in (b"\x93NUMPY\x02\0\xff\xff\xff\xff{", b"1 " * 5000000, b"1" * 20000000, b"0\0" * 12):
            self.assertIn("h.txt", self.hostile("diffuse", self.small, "--input", self.file("h.txt", content), "--t", "1"))

    @unittest.skipUnless(POSIX, "needs links")
    def test_links(self):
        """A link is replaced by the file, and what it pointed at stays."""
        keep = self.file("pointed-at.txt", "precious")
        for name, to in (("link.txt", keep), ("dangling.txt", self.path("no/folder/x.txt"))):
            link = self.path(name)
            os.symlink(to, link)
            self.good("kernel", self.small, "--source", 0, "--t", 1, "-o", link)
            self.assertFalse(os.path.islink(link))
            with open(link) as f:
                self.assertEqual(len(numbers(f.read())), 12)
            os.remove(link)
        with open(keep) as f:
            self.assertEqual(f.read(), "precious")
        os.remove(keep)

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs /dev/full")
    def test_full_device(self):
        for extra in ((), ("--kernel", "symmetric")):
            self.assertIn("/dev/full", self.hostile("kernel", self.small, "--source", "0", "--t", "1", "-o", "/dev/full", *extra))

    @unittest.skipUnless(POSIX, "needs limits")
    def test_hostile_places(self):
        """--source-file: lines without an end, long comments, zero bytes, devices, folders."""
        def refused(content):
            return self.hostile("kernel", self.small, "--t", "1", "--source-file", self.file("places.txt", content))
        for content in (b"1" * (100 << 20), b"# " + b"x" * (20 << 20), b"\0" * (20 << 20), b"0.5*" * (5 << 20), b"0:0." + b"1" * (20 << 20)):
            with self.subTest(content[:8]):
                self.assertIn("places.txt", refused(content))
        self.assertIn("places.txt:2: 12 is beyond", refused(b"# " + b"3 " * 200 + b"\n12\n"))
        self.assertIn("places.txt:2: '?' is no point", refused(b"1\n2\0\n"))
        self.assertIn("places.txt:1: '4' is no point", refused(b"3" + b" " * 300 + b"4\n"))
        for name, text in (("/dev/zero", "a device that has no end"), (self.folder, "cannot read"), ("/dev/null", "no point")):
            self.assertIn(text, self.hostile("kernel", self.small, "--t", "1", "--source-file", name))
        many = self.file("places.txt", "".join("0:0.25,0.25  # %d\r\n" % i for i in range(5000)))
        one = self.field("kernel", self.small, "--t", 1, "--source", "0:0.25,0.25")
        self.close(self.field("kernel", self.small, "--t", 1, "--source-file", many), [[5000 * x for x in row] for row in one], 1e-7)
        os.remove(many)

    def test_input_is_the_output(self):
        """The input is read whole before the output takes its place."""
        rows = [[math.sin(i)] for i in range(12)]
        for name, content in (("same.txt", "\n".join("%.17g" % r[0] for r in rows)), ("same.npy", npy_bytes(rows))):
            path = self.file(name, content)
            want = self.field("diffuse", self.small, "--input", path, "--t", "1h2")
            self.good("diffuse", self.small, "--input", path, "--t", "1h2", "-o", path)
            with open(path, "rb") as f:
                data = f.read()
            self.assertEqual(read_npy(data) if name.endswith("npy") else numbers(data.decode()), want)
            os.remove(path)
        mesh = self.file("same.obj", obj_text(*icosahedron()))
        want = self.field("kernel", mesh, "--source", 0, "--t", "1h2")
        self.good("kernel", mesh, "--source", 0, "--t", "1h2", "-o", mesh)
        self.assertEqual(self.field("kernel", mesh, "--source", 0, "--t", "1h2"), want)
        os.remove(mesh)

    def test_two_at_once(self):
        """Runs that write the same output at the same time: it is one of theirs, whole."""
        before = sorted(os.listdir(self.folder))
        for name in ("once.ply", "once.npy"):
            out, wants = self.path(name), []
            for source in (0, 55):
                self.good("kernel", self.patch, "--source", source, "--t", "1h2", "-o", out)
                with open(out, "rb") as f:
                    wants.append(f.read())
            runs = [subprocess.Popen([TOOL, "kernel", self.patch, "--source", str(55 * (i % 2)), "--t", "1h2", "--quiet", "-o", out], stderr=subprocess.PIPE)
                    for i in range(12)]
            for p in runs:
                self.assertEqual((p.communicate(timeout=60)[1], p.returncode), (b"", 0))
            with open(out, "rb") as f:
                self.assertIn(f.read(), wants)
            os.remove(out)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    @unittest.skipUnless(POSIX, "names are of bytes")
    def test_odd_names(self):
        """Names of files with line ends, quotes and bytes that are no text: read, written, told in one line and in JSON."""
        folder = os.fsencode(self.folder) + b"/"
        for name in (b"a\nb", b"'\"$(x)`%s%n", b"-o", "\u00e9\u20ac\U0001d11e".encode(), b"\xff\xc3(\xe0\x80\x80\xf0\x80\x80\x80\xed\xa0\x80\xf4\x90\x80\x80\xc0\xf8",
                     b"\xff\xe0\xa0\x80\xed\x9f\xbf\xf4\x8f\xbf\xbf\xe1\x80\x80", b"\x01\x1b[2J\x7f"):
            mesh, out = folder + name + b".obj", folder + name + b".vtu"
            try:
                shutil.copy(os.fsencode(self.small), mesh)
            except OSError:
                continue                         # some file systems take text alone
            p = self.run_bytes(b"kernel", mesh, b"--source", b"0", b"--t", b"1", b"--json", b"-o", out)
            self.assertEqual(p.returncode, 0, p.stderr)
            self.assertEqual(json.loads(p.stderr)["mesh"], mesh.decode(errors="replace") if b"\xff" not in name else json.loads(p.stderr)["mesh"])
            with open(out, "rb") as f:
                self.assertEqual(read_vtu(f.read())[1:], (12, 20))
            for args in ((b"kernel", mesh, b"--source", b"99", b"--t", b"1"), (b"info", mesh + b".off"), (b"kernel", mesh, b"--source", b"0", b"--t", b"1", b"-o", out + b"/x.txt"),
                         (b"info", mesh, b"--" + name), (name, mesh), (b"info", b"--", name)):
                p = self.run_bytes(*args)
                self.assertIn(p.returncode, (1, 2), args)
                self.assertRegex(p.stderr, b"^heatdiff: error: [^\n\x01\x1b\x7f]*\n$")
            os.remove(mesh)
            os.remove(out)

    @staticmethod
    def run_bytes(*args):
        return subprocess.run([os.fsencode(TOOL), *args], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)

    @unittest.skipUnless(POSIX, "needs signals")
    def test_nobody_reads_standard_output(self):
        """A pipe that is closed ends the run without a word, or with one where SIGPIPE is ignored; a closed descriptor is told."""
        for args in (["kernel", self.patch, "--source", "0", "--t", "1", "--quiet"], ["info", self.patch], ["--help"]):
            for restore, code in ((True, -signal.SIGPIPE), (False, 1)):
                read, write = os.pipe()
                os.close(read)
                p = subprocess.run([TOOL, *args], stdout=write, stderr=subprocess.PIPE, restore_signals=restore)
                os.close(write)
                self.assertEqual(p.returncode, code)
                self.assertRegex(p.stderr, b"^$" if restore else b"^heatdiff: error: [^\n]*cannot write: [^\n]*\n$")
            p = subprocess.run([TOOL, *args], stderr=subprocess.PIPE, preexec_fn=lambda: os.close(1))
            self.assertEqual(p.returncode, 1)
            self.assertRegex(p.stderr, b"^heatdiff: error: [^\n]*cannot write: [^\n]*\n$")

    @unittest.skipUnless(os.path.exists("/dev/stdout"), "needs /dev/stdout")
    def test_standard_streams_by_name(self):
        want = self.good("kernel", self.small, "--source", 0, "--t", 1, "--quiet").stdout
        with open(self.small, "rb") as mesh:
            self.assertEqual(self.good("kernel", "-", "--source", 0, "--t", 1, "--quiet", "-o", "/dev/stdout", stdin=mesh.read()).stdout, want)
        with open(self.path("stdout.txt"), "wb") as out:
            for mesh in ("/dev/stdin", "-"):
                with open(self.small, "rb") as f:
                    subprocess.run([TOOL, "kernel", mesh, "--source", "0", "--t", "1", "--quiet", "-o", "-"], stdin=f, stdout=out, check=True)
        with open(self.path("stdout.txt"), "rb") as f:
            self.assertEqual(f.read(), 2 * want)
        field = self.file("field.txt", "\n".join(map(str, range(12))))
        self.assertEqual(read_png(self.good("render", self.small, "--input", field, "--size", "80x64", "-o", "-").stdout)[:2], (80, 64))

    @unittest.skipUnless(POSIX, "names end elsewhere")
    def test_long_names(self):
        for e in ("txt", "csv", "npy", "ply", "obj", "vtu", "png"):
            for size in (250, 255):
                name = self.path("x" * (size - len(e) - 1) + "." + e)
                self.good("kernel", self.patch, "--source", 0, "--t", "1h2", "-o", name)
                os.remove(name)

    def test_sources_anywhere(self):
        mesh = self.file("roof.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3\nf 1 3 4\nf 2 5 6 3\n")
        for command, more in (("kernel", ("--t", "0.1")), ("kernel", ("--t", "0.1,0.2", "--kernel", "symmetric", "--method", "krylov")), ("distance", ("--t", "0.1")),
                              ("geodesic", ("--laplacian", "fem"))):
            want = self.field(command, mesh, "--source", "0,3", *more)
            self.assertEqual(want, self.field(command, mesh, "--source", "0:1,0,1:0,0", *more))   # corners of faces
        one, two, three = (columns(self.field("kernel", mesh, "--source", s, "--t", 0.1), 0) for s in (0, 1, 2))
        got = self.field("kernel", mesh, "--source", "0:0.2,0.3", "--t", 0.1)
        self.close(got, [[0.2 * a[0] + 0.3 * b[0] + 0.5 * c[0]] for a, b, c in zip(one, two, three)], 1e-7)
        got = self.field("kernel", mesh, "--source", "2*0+0.5*2,1", "--t", 0.1)
        self.close(got, [[2 * a[0] + 0.5 * c[0], b[0]] for a, b, c in zip(one, two, three)], 1e-7)
        points = self.file("points.txt", "# a line\n0:0.5,0.5   # its beginning\n\n0:0,0.5\n")
        got = self.field("kernel", mesh, "--source-file", points, "--curve", "--t", 0.1)
        self.close(got, [[math.sqrt(0.5) * (0.25 * a[0] + 0.5 * b[0] + 0.25 * c[0])] for a, b, c in zip(one, two, three)], 1e-7)
        got = self.field("geodesic", mesh, "--source-file", points, "--curve")
        self.close(got[:3], [[0.5], [math.sqrt(0.125)], [0.5]], 1e-12)
        text = self.good("kernel", mesh, "--source", "0:0.2,0.3,5", "--t", 0.1, "-o", self.path("s.csv"), "--json").stderr
        self.assertEqual(json.loads(text)["source"], "0:0.2,0.3,5")
        with open(self.path("s.csv")) as f:
            self.assertEqual(f.readline().strip(), "s0_0.1,s1_0.1")
        self.good("kernel", mesh, "--source", "0:0.2,0.3,5", "--t", 0.1, "-o", self.path("s.png"))

        pictures = []
        for source in ("1", "0:0,1", "2", "0:0,0"):              # the mark stands at the nearest corner
            self.good("kernel", mesh, "--source", source, "--t", 0.1, "--title", "x", "--size", "64x64", "-o", self.path("s.png"))
            with open(self.path("s.png"), "rb") as f:
                pictures.append(f.read())
        self.assertEqual(pictures[::2], pictures[1::2])
        self.assertNotEqual(pictures[0], pictures[2])
        both = [json.loads(self.good("geodesic", mesh, "--laplacian", "fem", "--source", s, "--json", "-o", self.path("s.txt")).stderr)
                for s in ("0:0.1,0.2,1:0.5,0.2,0+4", "0+4,1:0.5,0.2,0:0.1,0.2")]
        for key in ("residual", "residual_heat", "residual_distance", "stages", "status"):
            self.assertEqual(both[0][key], both[1][key])         # those of the worst source, in any order

        def bad(*args):
            return self.bad(1, "kernel", mesh, "--t", 0.1, *args)
        self.assertRegex(bad("--source", "3:0.1,0.2"), "3 is beyond.* 3 faces")
        self.assertRegex(bad("--source", "1+6"), "6 is beyond.* 6 vertices")
        self.assertRegex(bad("--source", "2:0.1,0.2"), "2 is no triangle")
        self.assertRegex(bad("--source", "0*1"), "source 0: .*weight")
        self.assertIn("one point", bad("--source", "1", "--curve"))
        self.assertRegex(bad("--source-file", self.file("bad.txt", "1\n0:0.5\n")), r"bad\.txt:2.*0:0\.5")
        self.assertRegex(bad("--source-file", self.file("bad.txt", "1\n\n12\n")), r"bad\.txt:3.*12")
        self.assertIn("no point", bad("--source-file", self.file("bad.txt", "# nothing\n")))
        self.assertIn("not-there", bad("--source-file", self.path("not-there.txt")))
        self.assertRegex(self.bad(1, "geodesic", mesh, "--curve", "--source", "0,0+5"), "source (0|1)")
        self.assertRegex(self.bad(1, "geodesic", mesh, "--curve", "--source", "0+5,0+1"), "source 0, point [01].*no face")
        self.assertIn("source 0 has one point", self.bad(1, "sample", mesh, "--t", 1, "--count", 1, "--curve", "--source", "1,2"))
        self.assertRegex(self.bad(1, "geodesic", mesh, "--curve", "--source", "0+1,0+2+4"), "source 1, point 1.*no face")
        # farthest from places: the first row is farthest from the source, with its distance
        for source in (("--source", "1:0.2,0.3"), ("--source", "3,0.5*4+1"), ("--source-file", self.file("from.txt", "1:0.2,0.3\n")),
                       ("--source", "1:1,0+1:0,1", "--curve")):
            far = self.field("distance", mesh, "--t", "0.1", *source)
            far = [min(row) for row in far]
            got = self.field("sample", mesh, "--t", "0.1", "--count", 3, *source)
            self.assertEqual(len(got), 3)
            self.assertEqual(got[0][0], far.index(max(far)))
            self.assertAlmostEqual(got[0][1], max(far), 6)
            again = self.field("distance", mesh, "--t", "0.1", "--source", int(got[0][0]))
            self.assertAlmostEqual(got[1][1], max(min(a, b[0]) for a, b in zip(far, again)), 6)
        self.assertIn("3 points", self.good("sample", mesh, "--t", "0.1", "--count", 3, "--source", "1:0.2,0.3", "-o", self.path("s.txt")).stderr.decode())
        self.good("sample", mesh, "--t", "0.1", "--count", 3, "--source", "1:0.2,0.3", "--dry-run")

    def test_source_beyond_the_mesh(self):
        for s in (12, 10 ** 7, 10 ** 18, 10 ** 30, "0,12"):
            text = self.bad(1, "kernel", self.small, "--source", s, "--t", 1)
            self.assertIn("12", text)
            self.assertIn("vertices", text)

    def test_fields(self):
        def diffuse(content, name="f.txt"):
            return self.bad(1, "diffuse", self.small, "--input", self.file(name, content), "--t", 1)
        rows = ["%d 1" % i for i in range(12)]
        self.assertRegex(diffuse("\n".join(rows[:11])), r"f\.txt.*11.*12")
        self.assertRegex(diffuse("\n".join(rows + ["3 3"])), r"f\.txt.*13.*12")
        self.assertIn("f.txt:3", diffuse("\n".join(rows[:2] + ["1 zwei"] + rows[3:])))
        self.assertIn("f.txt:5", diffuse("\n".join(rows[:4] + ["1"] + rows[5:])))
        self.assertIn("f.txt", diffuse("\n".join(rows[:4] + ["1 nan"] + rows[5:])))
        self.assertIn("f.txt", diffuse(""))
        self.assertIn("f.npy", diffuse(npy_bytes([[1.0]] * 11), "f.npy"))
        self.assertIn("f.npy", diffuse(npy_bytes([[1.0]] * 12)[:-3], "f.npy"))
        self.assertIn("f.npy", diffuse(npy_bytes([[1.0]] * 12).replace(b"<f8", b"<c8"), "f.npy"))
        self.assertIn("f.npy", diffuse(npy_bytes([[1.0]] * 12)[:9], "f.npy"))
        self.assertIn("no-field", self.bad(1, "diffuse", self.small, "--input", self.path("no-field"), "--t", 1))

    def test_render_column(self):
        f = self.file("c.txt", "1 2\n" * 12)
        self.assertIn("2", self.bad(1, "render", self.small, "--input", f, "--column", 2, "-o", self.path("c.png")))
        self.assertFalse(os.path.exists(self.path("c.png")))

    def test_out_of_range(self):
        """Numbers that no double holds, and where they are told."""
        self.assertIn("the time 1e+308h2 is too large for h", self.bad(1, "kernel", self.small, "--source", 0, "--t", "1e308h2"))
        line = self.file("line.obj", "v 0 0 0\nv 9 0 0\nv 9 9 0\nf 1 2 3\n")
        self.assertIn("the time 1e+308/l1 is too large", self.bad(1, "kernel", line, "--source", 0, "--t", "1e308/l1"))
        self.assertIn("is too far above the first", self.bad(1, "hks", self.small, "--scale-invariant", 2, "--t", "1e-300,1e300"))
        self.assertIn("is not above the first", self.bad(1, "hks", self.small, "--scale-invariant", 2, "--t", "2,1"))
        self.assertEqual(len(self.field("hks", self.small, "--scale-invariant", 40, "--t", "1,2")[0]), 40)
        huge = self.file("huge.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3 4\nf 1 5 6\n")
        for kind in ("fem", "polygon"):             # the faces of the file are counted, not its triangles
            self.assertIn("face 1: ", self.bad(1, "kernel", huge, "--source", 0, "--t", 1, "--laplacian", kind))
        big = self.file("big.txt", "1\n" * 4 + "1.7e308\n-1.7e308\n" * 4)
        text = self.run_tool("diffuse", self.small, "--input", big, "--t", "1e-9", "--method", "direct").stderr.decode()
        self.assertNotIn("nan", text)
        signs = self.file("signs.txt", "".join("1 %g\n" % (1.7e308 * s) for s in (1, -1, 1, 1, 1, -1, 1, -1, 1, 1, -1, -1)))
        for method in ("direct", "krylov"):
            self.assertIn("leaves the range of doubles", self.bad(1, "diffuse", self.small, "--input", signs, "--t", "0.2,0.3", "--method", method))
        self.assertIn("1089000000 columns are too many", self.bad(1, "kernel", self.small, "--source", ",".join(["0"] * 33000), "--t",
                                                                  ",".join(["auto:1000"] * 33)))
        self.assertIn("1000000000000 is beyond", self.bad(1, "sample", self.small, "--t", 1, "--count", 3, "--source", 10 ** 12))
        self.assertIn("2000000000 is beyond", self.bad(1, "spectrum", self.small, "-k", 2000000000))
        self.assertIn("2000000000 is beyond", self.bad(1, "sample", self.small, "--t", 1, "--count", 2000000000))

    def test_limits(self):
        error = self.bad(1, "kernel", self.patch, "--source", 0, "--t", "10h2", "--memory-limit", 2000)
        self.assertIn("--memory-limit", error)
        self.bad(1, "kernel", self.patch, "--source", 0, "--t", "1000h2", "--solver", "cocg", "--precond", "none", "--max-iterations", 2)
        self.bad(1, "pairs", self.patch, "--input", self.file("two.txt", "0 1\n"), "--t", "1000h2,2000h2", "--solver", "cocg", "--precond", "none",
                 "--max-iterations", 2)

    def test_existing_output_survives(self):
        for name in ("keep.txt", "keep.png", "keep.vtu"):
            keep = self.file(name, "precious")
            before = sorted(os.listdir(self.folder))
            self.bad(1, "kernel", self.patch, "--source", 0, "--t", "10h2", "--memory-limit", 2000, "-o", keep)
            self.bad(1, "kernel", self.path("not-there.obj"), "--source", 0, "--t", "10h2", "-o", keep)
            with open(keep) as f:
                self.assertEqual(f.read(), "precious")
            self.assertEqual(sorted(os.listdir(self.folder)), before)


class Memory(Case):
    """Each place of the tool that allocates memory finds none, once: one line says so, and nothing is left behind."""

    RUNS = ("info small.obj", "kernel small.obj --source 0 --t 1h2,auto:2 -o x.png --size 64x64", "kernel s.off --source 0,1:0.2,0.3 --t 1h2 -o x.vtu",
            "diffuse s.ply --input v.npy --t 1h2,3h2 -o x.ply", "kernel s.stl --source 0,3 --t 4,1,3 --method krylov -o x.csv",
            "distance s.stl --source 0,3 --t 1 --matrix -o x.csv", "distance small.obj --source-file spots.txt --t 1 --nearest -o x.obj",
            "pairs small.obj --input pairs.txt --t 1 -o x.npy", "pairs small.obj --input pairs.txt --t 1 --dry-run",
            "hks small.obj --filter wave:1,1 -o x.txt", "hks small.obj --filter fractional:1,0.5 -o x.txt",
            "hks s.xyz --bandwidth 1h2 --t 1,2 --scale-invariant 2 -o x.txt", "trace small.obj --t 1/l1", "sample small.obj --t 1 --count 3 -o x.csv",
            "geodesic small.obj --source 0 -o x.txt --json", "geodesic small.obj --lengths lengths.txt --source 0:0.3,0.3 --dry-run",
            "spectrum small.obj -k 3 -o x.csv", "levels small.obj --input v.npy --levels auto:12 -o x.obj",
            "levels small.obj --input v.npy --levels 1,2 -o x.csv", "render small.obj --input v.npy --input pairs.csv -o x.png --size 128x64")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        v, f = icosahedron()
        cls.file("s.off", off_text(v, f))
        cls.file("s.xyz", "".join("%g %g %g\n" % p for p in v))
        cls.file("s.ply", "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\nelement face 20\n"
                 "property list uchar int vertex_indices\nend_header\n" + "".join("%g %g %g\n" % p for p in v) + "".join("3 %d %d %d\n" % t for t in f))
        cls.file("s.stl", "solid s\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % v[i] for i in t) + "endloop\nendfacet\n"
                                               for t in f) + "endsolid\n")
        cls.file("v.npy", npy_bytes([[float(i)] for i in range(12)]))
        cls.file("pairs.csv", "i,j\n" + "0,1\n2,3\n" * 6)
        cls.file("pairs.txt", "0 1\n2 3\n")
        cls.file("spots.txt", "0:0.2,0.3\n" * 17)
        cls.file("lengths.txt", "2 2 2\n" * 20)
        cls.list = cls.path("list.txt")

    @classmethod
    def preload(cls):
        """The library that lets one allocation fail; None where there is no compiler, or no way to preload it."""
        library = os.path.join(cls.folder, "starve.so")
        source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "starve.c")
        try:
            built = subprocess.run([os.environ.get("CC", "cc"), "-O1", "-w", "-shared", "-fPIC", source, "-o", library, "-ldl"], stderr=subprocess.DEVNULL)
            run = subprocess.run([TOOL, "--version"], env=dict(os.environ, LD_PRELOAD=library, STARVE_LIST=cls.list), stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)
        except OSError:
            return None
        return library if built.returncode == 0 and run.returncode == 0 and os.path.exists(cls.list) else None

    def run_with(self, args, **environment):
        p = subprocess.run([TOOL] + args, env=dict(os.environ, LD_PRELOAD=self.library, **environment), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, cwd=self.folder, timeout=60)
        output, out = p.stdout, self.path(args[args.index("-o") + 1]) if "-o" in args else ""
        if os.path.exists(out):
            with open(out, "rb") as f:
                output += f.read()
            os.remove(out)
        return p.returncode, p.stderr.decode(), output

    def test_every_allocation(self):
        self.library = self.preload()
        if not self.library:
            absent("nothing can be preloaded here")
        seen, refused = set(), 0
        for line in self.RUNS:
            args = line.split() + ([] if line.startswith(("levels", "render")) else ["--threads", "1"])
            code, text, want = self.run_with(args, STARVE_LIST=self.list)
            self.assertEqual(code, 0, (line, text))
            with open(self.list) as f:
                places = f.read().splitlines()
            before = sorted(os.listdir(self.folder))
            for k, place in enumerate(places):
                if place in seen:
                    continue
                seen.add(place)
                code, text, output = self.run_with(args, STARVE_AT=str(k + 1))
                told = (line, k + 1, text)
                self.assertIn(code, (0, 1), told)
                if code:
                    self.assertRegex(text, r"^heatdiff: error: [^\n]*[Mm]emory[^\n]*\n$", told)
                    refused += 1
                elif "--dry-run" not in line:
                    self.assertEqual(output, want, told)         # what did without
                self.assertEqual(sorted(os.listdir(self.folder)), before, told)
        self.assertGreater(refused, 300)


class Numbers(Case):
    def test_dense_exponential(self):
        for mesh in (icosahedron(), bumpy_patch(3)):
            path = self.file("dense.obj", obj_text(*mesh))
            L, B = cotan_and_fem(*mesh)
            eye = [[float(i == j) for j in range(len(L))] for i in range(len(L))]
            for t in (0.05, 1.0, 30.0):
                for kind, M in (("fem", B), ("cot", eye)):
                    K = heat_matrix(L, M, t)
                    self.close(self.field("kernel", path, "--laplacian", kind, "--source", "0,7", "--t", t), columns(K, 0, 7), 1e-7)
                    f = [[float(i % 3), math.sin(i)] for i in range(len(L))]
                    given = self.file("f.txt", "".join("%.17g %.17g\n" % tuple(r) for r in f))
                    self.close(self.field("diffuse", path, "--laplacian", kind, "--input", given, "--t", t), matmul(K, f), 1e-7)

    def test_symmetric_kernel(self):
        s = self.field("kernel", self.patch, "--source", "3,40,77", "--t", "5h2", "--kernel", "symmetric")
        for a, i in enumerate((3, 40, 77)):
            for b, j in enumerate((3, 40, 77)):
                self.assertAlmostEqual(s[i][b], s[j][a], delta=1e-7 * max(map(abs, s[i])))

    def test_every_solver(self):
        want = self.field("kernel", self.patch, "--source", 11, "--t", "8h2", "--tol", 1e-12)
        for solver in ("cocg", "cocr", "minres", "lanczos"):
            for precond in ("none", "jacobi", "ssor", "ildl", "mildl"):
                self.close(self.field("kernel", self.patch, "--source", 11, "--t", "8h2", "--solver", solver, "--precond", precond), want, 1e-7)
        for poles in ("uniform", "kernel"):
            self.close(self.field("kernel", self.patch, "--source", 11, "--t", "8h2", "--poles", poles, "--method", "iterative"), want, 1e-7)

    def test_time_zero(self):
        for v in (0, 5):
            self.assertEqual(self.field("kernel", self.small, "--source", v, "--t", 0), [[float(i == v)] for i in range(12)])
        f = self.file("zero.txt", "".join("%.17g\n" % math.exp(i) for i in range(12)))
        self.assertEqual(self.field("diffuse", self.small, "--input", f, "--t", "-0"), [[math.exp(i)] for i in range(12)])

    def test_constant_stays(self):
        f = self.file("one.txt", "1\n" * 100)
        self.close(self.field("diffuse", self.patch, "--input", f, "--t", "1h2,100h2"), [[1.0, 1.0]] * 100, 1e-7)

    def test_h2_is_the_mean_edge(self):
        h = json.loads(self.good("info", self.small, "--json").stdout)["h"]
        self.assertAlmostEqual(h, 2.0, places=12)
        self.close(self.field("kernel", self.small, "--source", 0, "--t", "3h2"), self.field("kernel", self.small, "--source", 0, "--t", "12"), 1e-9)

    def test_kernel_column_order(self):
        got = self.field("kernel", self.patch, "--source", "8,90", "--t", "1h2,20h2,3h2")
        k = 0
        for s in (8, 90):
            for t in ("1h2", "20h2", "3h2"):
                self.close(columns(got, k), self.field("kernel", self.patch, "--source", s, "--t", t), 1e-7)
                k += 1
        self.assertEqual(len(got[0]), k)

    def test_diffuse_column_order(self):
        f = self.file("two.txt", "".join("%g %g\n" % (math.sin(i), i % 7) for i in range(100)))
        parts = [self.file("one%d.txt" % q, "".join("%g\n" % (math.sin(i), i % 7)[q] for i in range(100))) for q in range(2)]
        got, k = self.field("diffuse", self.patch, "--input", f, "--t", "2h2,9h2"), 0
        for q in range(2):
            for t in ("2h2", "9h2"):
                self.close(columns(got, k), self.field("diffuse", self.patch, "--input", parts[q], "--t", t), 1e-7)
                k += 1
        self.assertEqual(len(got[0]), k)

    def test_duplicate_sources(self):
        got = self.field("kernel", self.patch, "--source", "8,8", "--t", "2h2")
        self.assertEqual(columns(got, 0), columns(got, 1))

    def test_auto_times(self):
        p = self.good("kernel", self.patch, "--source", 0, "--t", "auto:5", "--json")
        times = json.loads(p.stderr)["times"]
        self.assertEqual(len(times), 5)
        ratios = [b / a for a, b in zip(times, times[1:])]
        self.assertGreater(ratios[0], 1.5)
        self.assertLess(max(ratios) / min(ratios), 1 + 1e-9)
        self.assertEqual(len(numbers(p.stdout.decode())[0]), 5)
        self.good("kernel", self.patch, "--source", 0, "--t", "auto:1,2h2")

    def test_unused_vertices_stay(self):
        v, f = icosahedron()
        path = self.file("dead.obj", obj_text([(9.0, 9.0, 9.0)] + v, [tuple(i + 1 for i in t) for t in f]))
        got = self.field("kernel", path, "--source", "0,3", "--t", "4h2")
        self.assertEqual([r[0] for r in got], [1.0] + [0.0] * 12)
        self.assertEqual(got[0][1], 0.0)
        self.assertEqual(json.loads(self.good("info", path, "--json").stdout)["inert"], 1)

    def test_polygons_are_fans(self):
        v = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.1), (2.5, 1.5, 0.0), (1.0, 2.5, 0.3), (-0.5, 1.5, 0.0)]
        fan = self.file("fan.obj", obj_text(v, [(0, 1, 2), (0, 2, 3), (0, 3, 4)]))
        polygon = self.file("polygon.obj", obj_text(v, [(0, 1, 2, 3, 4)]))
        for kind in ("fem", "voronoi-cot", "cot"):
            args = ("--source", 1, "--t", "0.3", "--laplacian", kind)
            self.assertEqual(self.field("kernel", fan, *args), self.field("kernel", polygon, *args))


class Polygons(Case):
    """Faces that are no triangles."""
    SQUARE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)]

    def square(self):
        return self.file("square.obj", obj_text(self.SQUARE, [(0, 1, 2, 3)]))

    def test_square_in_closed_form(self):
        """B^-1 L of the unit square has the eigenvalues 0, 4, 4 and 16 lambda."""
        for args, weight in (([], 1), (["--laplacian", "polygon", "--lambda", "0.5"], 0.5), (["--lambda=2"], 2)):
            t, got = 0.07, self.field("kernel", self.square(), "--source", 0, "--t", 0.07, *args)
            a, b = math.exp(-4 * t) / 2, math.exp(-16 * weight * t) / 4
            self.close(got, [[0.25 + a + b], [0.25 - b], [0.25 - a + b], [0.25 - b]], 1e-7)

    def test_default_is_by_the_faces(self):
        v, f = icosahedron()
        mixed = self.file("mixed.obj", obj_text(v + [(0, 0, 3), (1, 0, 3), (1, 1, 3), (0, 1, 3)], f + [(12, 13, 14, 15)]))
        for path, kind in ((self.square(), "polygon"), (mixed, "polygon"), (self.file("ball.obj", obj_text(v, f)), "fem")):
            self.assertEqual(json.loads(self.good("info", path, "--json").stdout)["laplacian"], kind)
            self.assertEqual(json.loads(self.good("kernel", path, "--source", 0, "--t", 1, "--json").stderr)["laplacian"], kind)

    def test_polygon_on_triangles_is_cotangent(self):
        """L is that of the triangles whatever lambda, B the thirds of their areas: on an icosahedron the mixed areas."""
        path = self.file("ico.obj", obj_text(*icosahedron()))
        want = self.field("kernel", path, "--source", 3, "--t", "2h2", "--laplacian", "voronoi-cot")
        for weight in (0.1, 1, 10):
            self.close(self.field("kernel", path, "--source", 3, "--t", "2h2", "--laplacian", "polygon", "--lambda", weight), want, 1e-7)

    def test_h_and_counts(self):
        r = json.loads(self.good("info", self.square(), "--json").stdout)
        self.assertEqual((r["h"], r["area"], r["edges"], r["faces"], r["faces_used"], r["triangles"], r["boundary_loops"]), (1, 1, 4, 1, 1, 2, 1))
        r = json.loads(self.good("info", self.square(), "--json", "--laplacian", "fem").stdout)
        self.assertEqual((r["edges"], r["triangles_used"], r["laplacian"]), (5, 2, "fem"))
        self.assertIn("polygon", self.good("info", self.square()).stdout.decode())

    def test_defects(self):
        v = self.SQUARE + [(3.0, 0.0, 0.0), (4.0, 0.0, 0.0), (5.0, 0.0, 0.0), (6.0, 0.0, 0.0)]
        path = self.file("defects.obj", obj_text(v, [(0, 1, 2, 3), (2, 1, 0, 3), (4, 5, 6, 7), (0, 1, 1, 4)]))
        r = json.loads(self.good("info", path, "--json").stdout)
        self.assertEqual((r["repeated_faces"], r["repeated_corner_faces"], r["zero_area_faces"], r["inert"], r["faces_used"]), (1, 1, 1, 4, 1))
        self.assertEqual(self.field("kernel", path, "--source", 5, "--t", 1), [[1.0 if i == 5 else 0.0] for i in range(8)])

    def test_every_output(self):
        for name in ("k.npy", "k.csv", "k.ply", "k.obj", "k.vtu", "k.png"):
            self.good("kernel", self.square(), "--source", 0, "--t", "1h2", "-o", self.path(name))
        f = self.file("f.txt", "1\n2\n3\n4\n")
        self.close(self.field("diffuse", self.square(), "--input", f, "--t", 100), [[2.5]] * 4, 1e-7)

    def test_triangulations_split_polygons(self):
        for option, word in (("--tufted", "tufted"), ("--intrinsic-delaunay", "delaunay")):
            r = json.loads(self.good("info", self.square(), option, "--json").stdout)
            self.assertEqual((r["laplacian"], r["intrinsic"], r["triangles_used"]), ("fem", word, 2))
            self.assertIn(option, self.bad(2, "info", self.square(), option, "--laplacian", "polygon"))

    def test_lambda_is_checked(self):
        for value in ("0", "-1", "x", "nan", "1e200", ""):
            self.assertIn("--lambda", self.bad(2, "info", self.square(), "--lambda", value))
        self.assertIn("--lambda", self.bad(2, "info", self.square(), "--lambda", "1", "--laplacian", "fem"))

    def test_lambda_is_of_polygons(self):
        """Triangles have fem unless polygon is asked for: lambda would be ignored."""
        path = self.file("three.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n")
        text = self.bad(1, "info", path, "--lambda", "2")
        self.assertIn("--lambda", text)
        self.assertIn("polygon", text)
        self.bad(1, "kernel", path, "--source", 0, "--t", "1h2", "--lambda", "2")
        self.good("info", path, "--lambda", "2", "--laplacian", "polygon")
        self.good("info", self.square(), "--lambda", "2")


METHODS = ("direct", "krylov", "auto", "iterative")
KINDS = ("fem", "voronoi-cot")


class Intrinsic(Case):
    """A torus whose vertices are joined askew, so that its triangles are slivers; and three leaves on one spine."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        v, f = torus(16, 8)
        turn = {i * 8 + j: i * 8 + (j + 2 * i) % 8 for i in range(16) for j in range(8)}
        cls.good_torus = cls.file("torus.obj", obj_text(v, f))
        cls.askew = cls.file("askew.obj", obj_text(v, [tuple(turn[i] for i in t) for t in f]))
        cls.book = cls.file("book.obj", obj_text([(0, 0, 0), (0, 0, 1), (3, 0, .5), (-1, 2, .5), (-1, -2, .4)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)]))

    def test_heat_is_not_negative(self):
        def least(*more):
            rows = self.field("kernel", self.askew, "--laplacian", "voronoi-cot", "--source", "0,37", "--t", "0.3h2,2h2", *more)
            return min(min(r) for r in rows)
        self.assertLess(least(), -1e-4)
        self.assertGreater(least("--intrinsic-delaunay"), -1e-6)
        self.assertGreater(least("--tufted"), -1e-6)

    def test_report(self):
        plain = json.loads(self.good("info", self.askew, "--json").stdout)
        r = json.loads(self.good("info", self.askew, "--json", "--intrinsic-delaunay").stdout)
        self.assertNotIn("intrinsic", plain)
        self.assertEqual((r["intrinsic"], r["sheets"], r["negative_weights"], r["not_delaunay_edges"]), ("delaunay", 1, 0, 0))
        self.assertGreater(r["flips"], 50)
        self.assertGreater(plain["negative_weights"], 50)
        self.assertAlmostEqual(r["h"], plain["h"], 12)
        self.assertAlmostEqual(r["area"], plain["area"], 9)
        self.assertEqual(r["smallest_angle"], plain["smallest_angle"])
        self.assertGreater(r["smallest_intrinsic_angle"], r["smallest_angle"])
        r = json.loads(self.good("kernel", self.book, "--tufted", "--source", 0, "--t", "0.1", "--json", "-o", self.path("b.txt")).stderr)
        self.assertEqual((r["intrinsic"], r["sheets"]), ("tufted", 2))
        self.assertLess(r["mass_drift"], 1e-9)

    def test_text(self):
        text = self.good("info", self.book, "--tufted").stdout.decode()
        self.assertRegex(text, "sheets +2")
        self.assertRegex(text, "edges flipped")
        self.assertNotIn("edges flipped", self.good("info", self.book).stdout.decode())
        text = self.good("kernel", self.askew, "--intrinsic-delaunay", "--source", 0, "--t", 1, "-o", self.path("a.txt")).stderr.decode()
        self.assertIn("intrinsic Delaunay", text)

    def test_no_value(self):
        self.bad(2, "info", "--tufted=1", self.book)
        self.bad(2, "render", "--tufted", self.book)


def on_both_axes(width, i, j, one):
    """A product over both directions between two vertices of a grid, numbered row by row: one(a, b) is that of a line."""
    return one(i % width, j % width) * one(i // width, j // width)


class Borders(Case):
    """A square of n x n cells: with voronoi-cot its Laplacian is the five-point one, whose eigenvectors are products of sines."""
    N = 12

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        n = cls.N
        v = [(i / n, j / n, 0) for j in range(n + 1) for i in range(n + 1)]
        low = [j * (n + 1) + i for j in range(n) for i in range(n)]
        cls.square = cls.file("square.obj", obj_text(v, [t for a in low for t in ((a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1))]))
        cls.points = cls.file("square.xyz", "".join("%.9g %.9g %.9g\n" % p for p in v))

    def kernel(self, i, j, t):
        """K_t between two vertices."""
        n = self.N
        return on_both_axes(n + 1, i, j, lambda a, b: sum(2 / n * math.sin(m * math.pi * a / n) * math.sin(m * math.pi * b / n) *
                                                          math.exp(-t * 4 * n * n * math.sin(m * math.pi / 2 / n) ** 2) for m in range(1, n)))

    def test_kernel(self):
        n, t, source = self.N, 0.02, 5 * (self.N + 1) + 4
        for method in ("direct", "krylov", "iterative"):
            u = self.field("kernel", self.square, "--border", "dirichlet", "--laplacian", "voronoi-cot", "--source", source, "--t", t, "--method", method)
            want = [self.kernel(i, source, t) for i in range((n + 1) ** 2)]
            self.assertLess(max(abs(a[0] - b) for a, b in zip(u, want)), 1e-7 * max(want))
            self.assertTrue(all(u[i][0] == 0 for i in range((n + 1) ** 2) if i % (n + 1) in (0, n) or i // (n + 1) in (0, n)))
        u = self.field("hks", self.square, "--border", "dirichlet", "--laplacian", "voronoi-cot", "--t", t)
        self.assertLess(max(abs(a[0] / n ** 2 - self.kernel(i, i, t)) for i, a in enumerate(u)), 1e-7 * max(want))
        natural = self.field("hks", self.square, "--border", "natural", "--laplacian", "voronoi-cot", "--t", t)
        self.assertTrue(all(a[0] < b[0] for a, b in zip(u, natural)))

    def filtered(self, i, j, f):
        """The same for a filter f of the eigenvalues, and the eigenvalues themselves."""
        n, total, values = self.N, 0.0, []
        for p in range(1, n):
            for q in range(1, n):
                lam = 4 * n * n * (math.sin(p * math.pi / 2 / n) ** 2 + math.sin(q * math.pi / 2 / n) ** 2)
                values.append(lam)
                total += f(lam) * 4 / n ** 2 * (math.sin(p * math.pi * (i % (n + 1)) / n) * math.sin(p * math.pi * (j % (n + 1)) / n) *
                                                math.sin(q * math.pi * (i // (n + 1)) / n) * math.sin(q * math.pi * (j // (n + 1)) / n))
        return total, values

    def test_filters(self):
        n, source = self.N, 5 * (self.N + 1) + 4
        common = [self.square, "--border", "dirichlet", "--laplacian", "voronoi-cot"]
        filters = {"heat:0.02": lambda x: math.exp(-0.02 * x), "wave:5,0.4": lambda x: math.exp(-(5 - math.log(x)) ** 2 / 0.32),
                   "mexican-hat:0.02": lambda x: x * math.exp(-0.02 * x), "resolvent:0.02": lambda x: 1 / (1 + 0.02 * x),
                   "fractional:0.3,0.5": lambda x: math.exp(-0.3 * math.sqrt(x)), "band:50,200": lambda x: 1 / (1 + ((x - 10000 / x) / 150) ** 4),
                   "biharmonic:30": lambda x: 1 / (x * x + 900)}
        for name, f in filters.items():
            want = [self.filtered(i, source, f)[0] for i in range((n + 1) ** 2)]
            top = max(map(abs, want))
            for method in ("direct", "iterative"):
                u = self.field("kernel", *common, "--source", source, "--filter", name, "--method", method)
                self.assertLess(max(abs(a[0] - b) for a, b in zip(u, want)), 1e-7 * top, name)
            trace = sum(map(f, self.filtered(0, 0, f)[1]))
            scale = n ** 2 / (trace if name.startswith("wave") else 1)
            diagonal = [self.filtered(i, i, f)[0] for i in range((n + 1) ** 2)]
            u = self.field("hks", *common, "--filter", name)
            self.assertLess(max(abs(a[0] - scale * b) for a, b in zip(u, diagonal)), 1e-7 * scale * max(diagonal), name)
            d = self.field("distance", *common, "--source", source, "--filter", name)
            squares = [n ** 2 * (diagonal[i] + diagonal[source] - 2 * want[i]) for i in range((n + 1) ** 2)]
            self.assertLess(max(abs(a[0] - math.sqrt(max(0, b))) for a, b in zip(d, squares)), 1e-5 * max(squares) ** 0.5, name)
            d = self.field("pairs", *common, "--input", self.file("pairs.txt", "%d 40\n%d %d\n" % (source, source, source)), "--filter", name)
            self.assertLess(abs(d[0][2] - want[40]) + abs(d[0][3] - squares[40] ** 0.5), 1e-6 * (top + max(squares) ** 0.5), name)
            self.assertEqual(d[1][3], 0)

    def test_filter_report(self):
        out = self.path("f.csv")
        r = json.loads(self.good("hks", self.square, "--filter", "wave:5,0.4", "--json", "-o", out).stderr)
        self.assertEqual((r["filter"], r["poles"], r["times"], r["evidence"]["rational"], r["per_time"][0]["t"]), ("wave:5,0.4", "filter", [], "measured", None))
        self.assertLess(r["filter_error"], 1.1e-10)
        self.assertLess(0, r["error_rational"])
        with open(out) as f:
            self.assertEqual(f.readline().strip(), "hks_wave")
        text = self.good("kernel", self.square, "--filter", "resolvent:10h2", "--source", 3, "-o", out).stderr.decode()
        self.assertIn("filter resolvent:10h2 to ", text)
        self.assertNotIn("conserved", text)
        self.good("sample", self.square, "--filter", "heat:10h2", "--count", 3, "-o", out)
        self.good("diffuse", self.square, "--filter", "band:20,80", "--input", self.file("ones.txt", "1\n" * (self.N + 1) ** 2), "-o", out)
        self.assertIn("method direct", self.good("hks", self.square, "--filter", "heat:10h2", "--dry-run").stderr.decode())

    def test_filter_refused(self):
        for name in ("heat:1e-300", "heat:1e308", "band:1,1.0000001"):  # no better than an answer of zeros
            self.assertRegex(self.bad(1, "kernel", self.small, "--source", 0, "--filter", name), r"--filter %s: the best poles found miss it by \d" % name)
        for bad in ("heat", "heat:", "heat:0", "heat:-1", "heat:1,2", "heat:auto:3", "wave:3", "wave:3,0", "wave:3h2,1", "band:3,2", "band:1h2,2", "sine:3", "fractional:1", "biharmonic:0"):
            self.assertIn("--filter takes heat:T, wave:E,SIGMA", self.bad(2, "hks", self.square, "--filter", bad))
        self.assertIn("no --t", self.bad(2, "hks", self.square, "--filter", "heat:1", "--t", 1))
        self.assertIn("no --degree", self.bad(2, "hks", self.square, "--filter", "heat:1", "--degree", 4))
        self.assertIn("no --method krylov", self.bad(2, "kernel", self.square, "--source", 1, "--filter", "heat:1", "--method", "krylov"))
        self.assertIn("no --solver lanczos", self.bad(2, "kernel", self.square, "--source", 1, "--filter", "heat:1", "--solver", "lanczos"))
        self.assertIn("no --definition", self.bad(2, "distance", self.square, "--source", 1, "--filter", "heat:1", "--definition", "commute"))
        self.assertIn("read off the factors", self.bad(2, "pairs", self.square, "--input", self.file("p.txt", "0 1\n"), "--filter", "heat:1", "--method", "iterative"))
        self.bad(2, "geodesic", self.square, "--source", 0, "--filter", "heat:1")

    def test_report(self):
        text = self.good("info", self.square, "--border", "dirichlet").stdout.decode()
        self.assertRegex(text, "vertices held at zero +%d" % (4 * self.N))
        r = json.loads(self.good("kernel", self.square, "--border", "dirichlet", "--source", 30, "--t", "0.02", "--json", "-o", self.path("b.txt")).stderr)
        self.assertEqual((r["held"], r["inert"], r["mass_drift"]), (4 * self.N, 0, 0))
        text = self.good("kernel", self.square, "--border", "dirichlet", "--source", 30, "--t", "0.02", "-o", self.path("b.txt")).stderr.decode()
        self.assertIn("heat leaves at the border", text)

    def test_refused(self):
        self.assertIn("natural or dirichlet", self.bad(2, "info", self.square, "--border", "neumann"))
        self.assertIn("--border dirichlet needs faces", self.bad(1, "info", self.points, "--border", "dirichlet"))
        self.assertIn("mean border", self.bad(1, "geodesic", self.square, "--border", "dirichlet", "--source", 0))


class Lengths(Case):
    """A flat torus of n x n cells, which has no shape in space: with voronoi-cot its Laplacian is the five-point one."""
    N = 10

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        n = cls.N
        faces, rows = [], []
        for j in range(n):
            for i in range(n):
                a, b, c, d = j * n + i, j * n + (i + 1) % n, (j + 1) % n * n + (i + 1) % n, (j + 1) % n * n + i
                faces += [(a, b, c), (a, c, d)]
                rows += [(1 / n, 1 / n, math.sqrt(2) / n), (math.sqrt(2) / n, 1 / n, 1 / n)]
        cls.rows = rows
        # places that say nothing about the surface
        cls.torus = cls.file("flat.obj", obj_text([(i, i * i % 7, i % 3) for i in range(n * n)], faces))
        cls.text = cls.file("flat.txt", cls.table(rows))
        cls.npy = cls.file("flat.npy", npy_bytes(rows))

    @staticmethod
    def table(rows):
        return "# lengths\n" + "".join("%.17g %.17g %.17g\n" % r for r in rows)

    def kernel(self, i, j, t):
        """K_t between two vertices."""
        n = self.N
        return on_both_axes(n, i, j, lambda a, b: sum(math.cos(2 * math.pi * m * (a - b) / n) *
                                                      math.exp(-t * 4 * n * n * math.sin(m * math.pi / n) ** 2) for m in range(n)) / n)

    def test_flat_torus(self):
        n, source = self.N, 23
        for lengths in (self.text, self.npy):
            common = [self.torus, "--lengths", lengths, "--laplacian", "voronoi-cot"]
            u = self.field("kernel", *common, "--source", source, "--t", "0.01,0.05")
            for k, t in enumerate((0.01, 0.05)):
                want = [self.kernel(i, source, t) for i in range(n * n)]
                self.assertLess(max(abs(a[k] - b) for a, b in zip(u, want)), 1e-7 * max(want))
            u = self.field("hks", *common, "--t", 0.02)
            self.assertLess(max(abs(a[0] / n ** 2 - self.kernel(0, 0, 0.02)) for a in u), 1e-7 * self.kernel(0, 0, 0.02))
        u = self.field("kernel", self.torus, "--lengths", "-", "--laplacian", "voronoi-cot", "--source", source, "--t", 0.05,
                       stdin=self.table(self.rows).encode())
        self.assertLess(max(abs(a[0] - b) for a, b in zip(u, want)), 1e-7 * max(want))
        d = self.field("geodesic", self.torus, "--lengths", self.text, "--source", source)
        far = [math.hypot(*(min(abs(x), n - abs(x)) / n for x in (i % n - source % n, i // n - source // n))) for i in range(n * n)]
        self.assertLess(max(abs(a[0] - b) for a, b in zip(d, far)), 0.12)     # the heat method on ten cells

    def test_same_as_in_space(self):
        """The lengths of a mesh in space give its answers, also where MESH holds other places."""
        v, f = bumpy_patch(7)
        space = self.file("space.obj", obj_text(v, f))
        squashed = self.file("squashed.obj", obj_text([(0, 0, 0)] * len(v), f))
        lengths = self.file("space.txt", self.table([tuple(math.dist(v[t[q]], v[t[(q + 1) % 3]]) for q in range(3)) for t in f]))
        pairs = self.file("pairs.txt", "0 9\n5 60\n")
        for command in (("kernel", "--source", "3,40", "--t", "1h2,0.7"), ("hks", "--t", "5h2"), ("trace", "--t", "2"),
                        ("distance", "--source", "5:0.2,0.3", "--t", "2"), ("distance", "--source", "5", "--definition", "biharmonic"),
                        ("pairs", "--input", pairs, "--t", "2"), ("sample", "--count", "5", "--t", "2"), ("geodesic", "--source", "0:0.2,0.2+20"),
                        ("geodesic", "--source", "0:0.2,0.2+0:0.3,0.3", "--curve"), ("kernel", "--source", "3", "--t", "1", "--border", "dirichlet"),
                        ("kernel", "--source", "3", "--t", "1", "--intrinsic-delaunay"), ("hks", "--t", "1", "--tufted")):
            self.close(self.field(*command, squashed, "--lengths", lengths), self.field(*command, space), 1e-7)
        a, b = (json.loads(self.good("info", *m, "--json").stdout) for m in ((squashed, "--lengths", lengths), (space,)))
        self.assertEqual(a["lengths"], lengths)
        self.assertNotIn("box_low", a)
        for name in ("h", "area", "smallest_angle"):
            self.assertAlmostEqual(a[name], b[name], 12)
        text = self.good("info", squashed, "--lengths", lengths).stdout.decode()
        self.assertRegex(text, "lengths of edges +" + re.escape(lengths))
        self.assertNotIn("box", text)
        out = self.path("length.png")
        text = self.good("kernel", space, "--lengths", lengths, "--source", 0, "--t", 1, "-o", out).stderr.decode()
        self.assertIn("fem Laplacian, from lengths of edges", text)
        self.assertIn("method", self.good("hks", squashed, "--lengths", lengths, "--t", 1, "--dry-run").stderr.decode())
        self.assertIn("real factors", self.good("geodesic", squashed, "--lengths", lengths, "--source", 1, "--dry-run").stderr.decode())

    def test_refused(self):
        def table(change):
            rows = list(self.rows)
            rows[7] = change
            return self.file("bad.txt", self.table(rows))

        def refused(lengths, mesh=self.torus, code=1):
            return self.bad(code, "info", mesh, "--lengths", lengths)
        a, b, c = self.rows[7]
        for row, what in (((a, b, 2 * a), "face 7: a side of a face is longer than the two others together: "), ((a, b, -c), "face 7: a length is negative: -"),
                          ((a, b, c * 1.01), "give their edge different lengths")):
            text = refused(table(row))
            self.assertIn(what, text)
            # the comment is line 1; an edge has two faces, and the later one is told
            self.assertRegex(text, re.escape(self.path("bad.txt")) + (r":\d+: face \d+: " if "different" in what else ":9: "))
        self.assertIn("bad.txt:9: ", refused(table((a, b, float("nan")))))
        text = refused(self.file("bad.npy", npy_bytes([(a, b, 3 * a)] + self.rows[1:])))
        self.assertIn("bad.npy: face 0: a side of a face is longer", text)
        self.assertIn("bad.npy: row 0, column 2: nan is not a finite number", refused(self.file("bad.npy", npy_bytes([(a, b, float("nan"))] + self.rows[1:]))))
        self.assertIn("199 rows, but %s has 200 faces" % self.torus, refused(self.file("bad.txt", self.table(self.rows[1:]))))
        self.assertIn("2 columns; a face has three edges", refused(self.file("bad.txt", "1 1\n" * 200)))
        self.assertIn("face 0: --lengths takes triangles, and it has 4 corners",
                      refused(self.text, self.file("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")))
        self.assertIn("--lengths needs faces", refused(self.text, self.file("points.xyz", "0 0 0\n1 0 0\n0 1 0\n")))
        self.assertIn("No such file", refused(self.path("none.txt")))
        self.assertIn("standard input can be read only once", refused("-", "-", 2))
        kernel = ("kernel", "--source", "0", "--t", "1", self.torus, "--lengths", self.text)
        self.assertIn("takes --laplacian fem, voronoi-cot or cot", self.bad(2, *kernel, "--laplacian", "voronoi-exp"))
        self.assertIn("takes --laplacian fem, voronoi-cot or cot", self.bad(2, *kernel, "--laplacian", "polygon"))
        self.assertIn("--bandwidth for exponential weights", self.bad(2, *kernel, "--bandwidth", "1"))
        self.assertIn("--lambda for polygons", self.bad(2, *kernel, "--lambda", "2"))
        self.assertIn("dissection cuts in space", self.bad(2, *kernel, "--ordering", "dissection"))
        self.assertIn("--curve takes no --lengths", self.bad(2, *kernel, "--curve"))
        self.bad(2, "render", self.torus, "--input", self.text, "--lengths", self.text, "-o", "a.png")


class Methods(Case):
    """Every method computes the same, on whatever mesh."""
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.torus = cls.file("torus.obj", obj_text(*torus(40, 24)))
        cls.large = cls.file("large.obj", obj_text(*torus(150, 80)))
        # a torus with two holes, a patch with a hole of its own, a tetrahedron, a vertex in no face, one in a face of zero area
        v, f = apart(with_holes(torus(24, 16), 5, 200), with_holes(bumpy_patch(9), 44), icosahedron())
        n = len(v)
        cls.dead = (5, 200, 24 * 16 + 44, n, n + 1)
        cls.starts = (0, 24 * 16, 24 * 16 + 100)                    # a vertex of each component, which ascend
        cls.parts = cls.file("parts.obj", obj_text(v + [(1.0, 2.0, 3.0), v[7]], f + [(7, 8, n + 1)]))
        cls.demo = os.path.join(Demo.run_once()[0], "heat-trunk.ply")

    def npy(self, *args):
        out = self.path("methods.npy")
        self.good(*args, "-o", out, "--quiet")
        with open(out, "rb") as f:
            data = f.read()
        os.remove(out)
        return data

    def same(self, got, want, tol=1e-7):
        """Column by column, relative to the largest value of each."""
        self.assertEqual((len(got), len(got[0])), (len(want), len(want[0])))
        for c, (a, b) in enumerate(zip(zip(*got), zip(*want))):
            worst = max(abs(x - y) for x, y in zip(a, b))
            self.assertLessEqual(worst, tol * max(map(abs, b)), "column %d" % c)

    def report(self, *args):
        return json.loads(self.good(*args, "--json", "-o", self.path("report.npy")).stderr)

    def test_dense_exponential(self):
        for mesh in (icosahedron(), bumpy_patch(3)):
            path = self.file("dense.obj", obj_text(*mesh))
            L, B = cotan_and_fem(*mesh)
            for t in (0.05, 1.0, 30.0):
                K = heat_matrix(L, B, t)
                for method in METHODS:
                    self.same(self.field("kernel", path, "--source", "0,7", "--t", t, "--method", method), columns(K, 0, 7))

    def test_same_columns(self):
        for mesh, sources in ((self.patch, "3,55"), (self.torus, "0,500"), (self.parts, "0,390,490"), (self.demo, "17,6000,11000")):
            for kind in KINDS:
                for kernel in ("operator", "symmetric") if mesh != self.demo else ("operator",):
                    run = ["kernel", mesh, "--laplacian", kind, "--kernel", kernel, "--source", sources, "--t", "2h2,60h2,900h2"]
                    want = read_npy(self.npy(*run, "--method", "iterative", "--poles", "kernel", "--degree", 14, "--tol", "1e-12"))
                    for method in METHODS:
                        with self.subTest(mesh=mesh, kind=kind, kernel=kernel, method=method):
                            self.same(read_npy(self.npy(*run, "--method", method)), want)

    def test_same_fields(self):
        n = 40 * 24
        f = self.file("fields.npy", npy_bytes([[math.sin(i / 9), float(i % 11), 1.0] for i in range(n)]))
        for kind in KINDS:
            run = ["diffuse", self.torus, "--laplacian", kind, "--input", f, "--t", "1h2,40h2,2000h2"]
            want = self.field(*run, "--method", "iterative", "--poles", "uniform", "--degree", 14, "--tol", "1e-12")
            for method in METHODS:
                got = self.field(*run, "--method", method)
                self.same(got, want)
                self.same(columns(got, 6, 7, 8), [[1.0] * 3] * n, 1e-9)

    def test_poles_and_degrees_of_direct(self):
        want = self.field("kernel", self.torus, "--source", 9, "--t", "30h2", "--method", "krylov", "--tol", "1e-12")
        for poles, degree in (("kernel", 10), ("kernel", 13), ("kernel", 14), ("uniform", 12), ("uniform", 14)):
            run = ["kernel", self.torus, "--source", 9, "--t", "30h2", "--method", "direct", "--poles", poles, "--degree", degree]
            self.same(self.field(*run), want)
            r = self.report(*run)
            self.assertEqual((r["poles"], r["degree"]), (poles, degree))
        for more in (["--degree", 9], ["--poles", "kernel"]):        # left to choose: anything but krylov
            self.assertIn(self.report("kernel", self.torus, "--source", 9, "--t", "30h2", *more)["method"], ("direct", "iterative"))

    def test_orderings(self):
        for method in ("direct", "krylov"):
            run = ["kernel", self.large, "--source", "7,8000", "--t", "50h2", "--method", method]
            want, seen = read_npy(self.npy(*run)), []
            for ordering in ("amd", "dissection", "auto"):
                self.same(read_npy(self.npy(*run, "--ordering", ordering)), want, 1e-9)
                r = self.report(*run, "--ordering", ordering)
                seen.append(r["ordering"])
                self.assertGreater(r["factor_nnz"], r["n"])
            self.assertEqual(seen[:2], ["amd", "dissection"])
            self.assertIn(seen[2], ("amd", "dissection"))

    def test_instruction_sets(self):
        for method in METHODS:
            run = ["kernel", self.torus, "--source", "7,800", "--t", "2h2,50h2", "--method", method]
            want = self.field(*run, "--simd", "none")
            for simd in ("avx2", "avx512", "auto"):
                self.same(self.field(*run, "--simd", simd), want, 1e-8)

    def test_threads_change_nothing(self):
        for mesh, sources in ((self.large, "1,400,9000"), (self.demo, ",".join(str(31 * i) for i in range(19)))):
            for method in ("direct", "krylov", "auto"):
                for t in ("100h2", "1h2,40h2"):
                    run = ["kernel", mesh, "--source", sources, "--t", t, "--method", method]
                    want = self.npy(*run, "--threads", 1)
                    for threads in (2, 5):
                        self.assertEqual(self.npy(*run, "--threads", threads), want, (mesh, method, t, threads))

    # ---- many times ----

    def many(self, run, sources, times, method, tol):
        """Several sources at several times at once, against one of each; the order of the columns too."""
        got = self.field(*run, "--source", ",".join(map(str, sources)), "--t", ",".join(times), "--method", method)
        self.assertEqual(len(got[0]), len(sources) * len(times))
        k = 0
        for s in sources:
            for t in times:
                one = self.field(*run, "--source", s, "--t", t, "--method", method)
                self.same(columns(got, k), one, tol)
                k += 1

    def test_many_times_equal_single_times(self):
        run = ["kernel", self.torus, "--laplacian", "fem"]
        for method in METHODS:
            self.many(run, (3, 700), ("2h2", "5h2", "40h2"), method, 1e-7)
            self.many(run, (3,), ("500h2", "0", "2h2", "40h2", "2h2"), method, 1e-7)
        for kind in KINDS:                       # the far ends need factors of their own; what belongs together is not side by side
            self.many(["kernel", self.parts, "--laplacian", kind], (self.starts[0], self.dead[0], self.starts[2]),
                      ("100000h2", "1h2", "0", "30000h2", "3h2", "0", "0.01h2", "1h2"), "krylov", 1e-7)
        self.many(["kernel", self.torus, "--kernel", "symmetric"], (1, 2), ("1h2", "90h2"), "krylov", 1e-7)

    def test_few_times_and_many_sources(self):
        sources = [37 * i for i in range(9)]
        for method in ("auto", "krylov", "direct"):
            self.many(["kernel", self.torus], sources, ("50h2", "3h2"), method, 1e-7)

    def test_many_times_of_fields(self):
        n, times = 40 * 24, ("300h2", "0", "2h2", "9h2")
        rows = [[math.sin(i / 9), float(i % 11)] for i in range(n)]
        f = self.file("both.npy", npy_bytes(rows))
        parts = [self.file("part%d.npy" % q, npy_bytes(columns(rows, q))) for q in range(2)]
        for method in METHODS:
            got = self.field("diffuse", self.torus, "--input", f, "--t", ",".join(times), "--method", method)
            for q in range(2):
                for k, t in enumerate(times):
                    self.same(columns(got, 4 * q + k), self.field("diffuse", self.torus, "--input", parts[q], "--t", t, "--method", method))
                self.assertEqual(columns(got, 4 * q + 1), columns(rows, q))

    def test_nothing_is_factorised_twice(self):
        def flops(*args):
            return self.report("kernel", self.large, *args)["factor_flops"]
        one = flops("--source", 5, "--t", "50h2", "--method", "krylov")
        self.assertEqual(flops("--source", "5,6,7", "--t", "20h2,50h2,100h2,300h2", "--method", "krylov"), one)
        one = flops("--source", 5, "--t", "50h2", "--method", "direct")
        self.assertEqual(flops("--source", "5,6,7", "--t", "50h2", "--method", "direct"), one)
        self.assertEqual(flops("--source", "5,6,7", "--t", "20h2,50h2,100h2", "--method", "direct"), 3 * one)

    # ---- components, holes, vertices without mass ----

    def test_components_holes_and_inert_vertices(self):
        n = 24 * 16 + 100 + 12 + 2
        ends = self.starts[1:] + (n - 2,)
        sources = self.starts + (self.dead[0], self.dead[3])
        for kind in KINDS:
            info = json.loads(self.good("info", self.parts, "--laplacian", kind, "--json").stdout)
            self.assertEqual((info["components"], info["inert"]), (3, len(self.dead)))
            for method in METHODS:
                for t in ("4h2", "4h2,5000h2"):
                    got = self.field("kernel", self.parts, "--laplacian", kind, "--source", ",".join(map(str, sources)), "--t", t,
                                     "--method", method)
                    each = t.count(",") + 1
                    for q in range(3):
                        for r, row in enumerate(got):
                            value = row[q * each]
                            if not self.starts[q] <= r < ends[q] or r in self.dead:
                                self.assertEqual(value, 0.0, (kind, method, q, r))
                        self.assertGreater(got[sources[q]][q * each], 0)
                    for q in (3, 4):
                        self.assertEqual([r[q * each] for r in got], [float(v == sources[q]) for v in range(n)])

    # ---- reports ----

    def test_reports(self):
        stages = ("load", "assemble", "order", "analyse", "factor", "precondition", "invert", "solve", "write")
        for method in METHODS:
            for t in ("30h2", "3h2,30h2"):
                r = self.report("kernel", self.large, "--source", "1,2", "--t", t, "--method", method)
                for k in Reports.KEYS:
                    self.assertIn(k, r)
                self.assertTrue(all(r["seconds"][k] >= 0 for k in stages))
                self.assertLessEqual(sum(r["seconds"][k] for k in stages), r["seconds"]["total"] * (1 + 1e-9))
                self.assertGreaterEqual(sum(r["seconds"][k] for k in stages), 0.9 * r["seconds"]["total"] - 0.05)
                self.assertEqual(len(r["per_time"]), t.count(",") + 1)
                self.assertEqual([p["t"] for p in r["per_time"]], r["times"])
                self.assertLess(r["mass_drift"], 1e-9)
                if method == "auto":
                    self.assertIn(r["method"], METHODS)
                    self.assertNotEqual(r["method"], "auto")
                    self.assertNotIn(r["reason"], ("", "asked for"))
                else:
                    self.assertEqual((r["method"], r["reason"]), (method, "asked for"))
                if r["method"] == "iterative":
                    self.assertEqual((r["factor_nnz"], r["factor_flops"], r["growth"], r["ordering"]), (0, 0, 0, "none"))
                    self.assertEqual(r["seconds"]["factor"], 0)
                else:
                    self.assertGreater(r["factor_nnz"], 5 * r["n"])
                    self.assertGreater(r["factor_flops"], r["factor_nnz"])
                    self.assertTrue(0.1 < r["growth"] < 5)
                    self.assertIn(r["ordering"], ("amd", "dissection"))
                    for k in ("order", "analyse", "factor", "solve"):
                        self.assertGreater(r["seconds"][k], 0)
                if r["method"] == "direct":
                    self.assertEqual((r["solver"], r["precond"], r["poles"]), ("none", "none", "kernel"))
                if r["method"] == "krylov":
                    self.assertEqual((r["solver"], r["precond"], r["poles"], r["degree"]), ("lanczos", "none", "none", 0))
                    self.assertGreater(r["iterations"], 5)

    def test_text_report(self):
        def text(*args):
            return self.good("kernel", self.large, "--source", 0, "--t", "9h2", "-o", self.path("text.npy"), *args).stderr.decode()
        for method in ("direct", "krylov"):
            t = text("--method", method)
            self.assertRegex(t, r"(?m)^method %s \(asked for\)$" % method)
            self.assertRegex(t, r"(?m)^factors: .*non-zeros.*flops")
            self.assertLessEqual(t.count("\n"), 8)
        self.assertNotIn("factors:", text("--method", "iterative"))
        self.assertRegex(text(), r"(?m)^method (direct|krylov|iterative) \(.+\)$")
        self.assertIn("t = 0", self.good("kernel", self.small, "--source", 0, "--t", 0, "-o", self.path("text.npy")).stderr.decode())

    def test_memory_limit(self):
        """Auto takes what fits, and says why; what is asked for and does not fit is an error."""
        run = ["kernel", self.large, "--source", ",".join(str(9 * i) for i in range(12)), "--t", "60h2"]
        def written():                           # by the last report
            with open(self.path("report.npy"), "rb") as f:
                return read_npy(f.read())
        peak = {m: self.report(*run, "--method", m)["peak_bytes"] for m in METHODS}
        want = written()
        self.assertGreater(peak["direct"], 1.3 * peak["krylov"])
        self.assertGreater(peak["krylov"], 1.3 * peak["iterative"])
        reasons = {}
        for limit in (1.1 * peak["direct"], 0.9 * peak["direct"], 1.05 * peak["krylov"], 0.9 * peak["krylov"], 1.1 * peak["iterative"]):
            with self.subTest(limit=limit, peak=peak):
                r = self.report(*run, "--memory-limit", int(limit))
                self.assertLessEqual(r["peak_bytes"], limit)
                reasons[limit] = (r["method"], r["reason"])
                self.same(written(), want)
                if limit < peak["krylov"]:
                    self.assertEqual(r["method"], "iterative")
                    self.assertIn("limit", r["reason"])
                elif limit < peak["direct"]:
                    self.assertNotEqual(r["method"], "direct")
        for method in ("direct", "krylov"):
            text = self.bad(1, *run, "--method", method, "--memory-limit", int(0.9 * peak[method]), "-o", self.path("never.npy"))
            self.assertIn("limit", text)
            self.assertFalse(os.path.exists(self.path("never.npy")))

    def dry(self, *args):
        return json.loads(self.good(*args, "--dry-run", "--json", "-o", self.path("never.npy")).stderr)

    def test_dry_run(self):
        """What a run takes is told without a result, and is what it takes then."""
        fields, pairs = self.file("dry.txt", "1 2\n" * 12000), self.file("pairs.txt", "1 2\n5 9\n")
        runs = {"kernel": ["--source", "0,5", "--t", "10h2"], "diffuse": ["--input", fields, "--t", "1h2,10h2"], "hks": ["--t", "auto:16"],
                "distance": ["--source", "0", "--t", "3h2"], "pairs": ["--input", pairs, "--t", "10h2"], "sample": ["--count", "4", "--t", "3h2"]}
        for command, args in runs.items():
            for more in ([], ["--method", "direct"]):
                with self.subTest(command=command, more=more):
                    d = self.dry(command, self.large, *args, *more)
                    r = self.report(command, self.large, *args, *more)
                    self.assertIs(d["dry_run"], True)
                    self.assertEqual(d["method"], r["method"])
                    e = d["estimate"]
                    self.assertTrue(e["fits"] and e["flops"] > 0 and e["seconds"] > 0 and d["methods"] and d["ways_out"] == {})
                    self.assertEqual(e, d["methods"][d["method"]])
                    if d["method"] == "direct":
                        self.assertTrue(d["analysed"])
                        self.assertGreaterEqual(e["bytes_most"], r["peak_bytes"])
                        if r["degree"] == 9:
                            self.assertTrue(0.999 * r["peak_bytes"] <= e["bytes"] <= 1.3 * r["peak_bytes"], (e, r["peak_bytes"]))
                    text = self.good(command, self.large, *args, *more, "--dry-run")
                    self.assertEqual(text.stdout, b"")
                    self.assertRegex(text.stderr.decode(), r"dry run: method \w+ \(.+\)\n(.|\n)*flops(.|\n)*MB")
        for run in (["trace", "--t", "auto:16"], ["hks", "--normalise", "--t", "5h2"], ["hks", "--scale-invariant", "3", "--t", "1h2,100h2"]):
            d, r = self.dry(run[0], self.large, *run[1:]), self.report(run[0], self.large, *run[1:])
            e = d["estimate"]
            self.assertTrue(e["fits"] and e["flops"] > 0 and d["analysed"] and d["method"] == r["method"] == "direct")
            self.assertTrue(0.999 * r["peak_bytes"] <= e["bytes"] <= 1.3 * r["peak_bytes"], (run, e, r["peak_bytes"]))
        g = self.dry("geodesic", self.large, "--source", "0")
        self.assertTrue(g["analysed"] and g["estimate"]["flops"] > 0 and g["estimate"]["fits"])
        for more in (["-k", "20"], ["-k", "20", "--below", "30"], ["--below", "30"]):
            s, r = self.dry("spectrum", self.large, *more), self.report("spectrum", self.large, *more)
            self.assertTrue(s["analysed"] and s["estimate"]["flops"] > 0 and s["estimate"]["fits"] and list(s["methods"]) == ["direct"])
            self.assertTrue(0.9 * r["peak_bytes"] <= s["estimate"]["bytes"] <= 1.6 * r["peak_bytes"], (more, s["estimate"], r["peak_bytes"]))
        self.assertIn("--dry-run", self.bad(2, "info", self.large, "--dry-run"))
        self.assertFalse(os.path.exists(self.path("never.npy")))

    def test_what_would_fit(self):
        """A run that does not fit says what it needs, what is allowed, and what else would do."""
        out = self.path("never.npy")
        run = ["kernel", self.large, "--source", 0, "--t", "10h2", "-o", out]
        need = self.dry("kernel", self.large, "--source", 0, "--t", "10h2", "--method", "direct")["estimate"]["bytes"]
        text = self.bad(1, *run, "--method", "direct", "--memory-limit", int(0.7 * need))
        self.assertIn("%.1f MB are needed, and %.1f MB are allowed" % (1e-6 * need, 1e-6 * int(0.7 * need)), text)
        for way in ("iterative", "krylov"):
            self.assertRegex(text, r"--method %s needs [0-9.]+ MB[,\n]" % way)
            self.good(*run, "--method", way, "--memory-limit", int(0.7 * need))
        os.remove(out)
        points = self.file("points.xyz", "".join("%.17g %.17g %.17g\n" % tuple(p) for p in self.points_of(self.large)))
        run = ["distance", points, "--source", 0, "--t", "3h2"]
        need = self.dry(*run)["estimate"]["bytes"]
        self.assertEqual(list(self.dry(*run)["ways_out"]), ["--tufted"])   # told in any case: it is a small part
        limit = int(0.5 * need)
        text = self.bad(1, *run, "--memory-limit", limit, "-o", out)
        self.assertRegex(text, r"--tufted needs [0-9.]+ MB, --weight-cut 1e-4 needs [0-9.]+ MB")
        d = self.dry(*run, "--memory-limit", limit)
        self.assertFalse(d["estimate"]["fits"])
        self.assertEqual(sorted(d["ways_out"]), ["--tufted", "--weight-cut 1e-4"])
        self.assertLess(d["ways_out"]["--tufted"], limit)
        for option, way in d["ways_out"].items():  # what they need is what they are said to need
            other = self.dry(*run, *option.split())["estimate"]["bytes"]
            self.assertTrue(abs(way - other) <= 0.02 * other, (option, way, other))
        self.assertFalse(os.path.exists(out))
        self.good(*run, "--tufted", "--memory-limit", limit, "-o", out)
        # other methods, and eigenpairs: failing and --dry-run name the same ways
        for run, ways in ((["kernel", points, "--source", 0, "--t", "10h2", "--method", "krylov"], ["--method iterative", "--tufted", "--weight-cut 1e-4"]),
                          (["kernel", points, "--source", 0, "--t", "10h2", "--method", "iterative", "--solver", "cocg"],
                           ["--solver lanczos", "--tufted", "--weight-cut 1e-4"]),
                          (["spectrum", points, "-k", "40"], ["--tufted", "--weight-cut 1e-4", "-k 10"])):
            with self.subTest(run=run[0], method=run[-1]):
                d = self.dry(*run)
                limit = d["bytes_in_use"] + 0.3 * (d["estimate"]["bytes"] - d["bytes_in_use"])
                d = self.dry(*run, "--memory-limit", int(limit))
                self.assertFalse(d["estimate"]["fits"])
                self.assertEqual(sorted(d["ways_out"]), ways)
                text = self.bad(1, *run, "--memory-limit", int(limit), "-o", self.path("no.npy"))
                for way in ways:
                    self.assertIn(way + " needs ", text)
        # and do not name what excludes what was asked for, or what is there already
        few = self.file("few.xyz", "".join("%.17g %.17g %.17g\n" % p for p in torus(24, 12)[0]))
        run = ["kernel", few, "--source", 0, "--t", "10h2", "--method"]
        for more, ways in ((run + ["direct", "--degree", "8"], ["--method iterative", "--tufted", "--weight-cut 1e-4"]),
                           (run + ["direct", "--poles", "uniform", "--weight-cut", "1e-3"], ["--method iterative", "--tufted"]),
                           (run + ["iterative", "--degree", "8"], ["--precond jacobi", "--tufted"]),
                           (run + ["iterative", "--poles", "uniform"], ["--precond jacobi", "--tufted"]),
                           (["spectrum", few, "-k", "4"], ["--tufted", "--weight-cut 1e-4"])):
            d = self.dry(*more)
            d = self.dry(*more, "--memory-limit", int(d["bytes_in_use"] + 0.3 * (d["estimate"]["bytes"] - d["bytes_in_use"])))
            self.assertFalse(d["estimate"]["fits"])
            self.assertLessEqual(set(d["ways_out"]), set(ways + ["--weight-cut 1e-4"] * ("--weight-cut" not in more)), more)
            self.assertIn("--tufted", d["ways_out"])
        # not even the matrices
        text = self.bad(1, "spectrum", points, "-k", "4", "--memory-limit", "2M", "-o", self.path("no.npy"))
        self.assertRegex(text, r"matrices alone need at least [0-9.]+ MB, and 2.1 MB are allowed .*; --tufted and --weight-cut 1e-4 need less")

    def points_of(self, path):
        with open(path) as f:
            return [[float(x) for x in line.split()[1:4]] for line in f if line.startswith("v ")]


def identity(n):
    return [[float(i == j) for j in range(n)] for i in range(n)]


def kernel_matrix(L, B, t):
    """k_t = K_t B^-1."""
    return matmul(heat_matrix(L, B, t), solve(B, identity(len(B))))


def distances(definition, L, B, t):
    """All distances of a connected mesh, from their definitions, by dense matrices."""
    n = len(L)
    if definition == "commute":         # e'L^+ e for e with sum 0: L^-1 after 1 1' is added, which such vectors do not see
        f = solve([[x + 1 for x in row] for row in L], identity(n))
    elif definition == "biharmonic":    # |L^+ e|_B, L^+ e without its constant part
        f = solve([[x + 1 for x in row] for row in L], identity(n))
        b = [sum(row) for row in B]
        means = [dot(b, column) / sum(b) for column in zip(*f)]
        f = [[x - m for x, m in zip(row, means)] for row in f]
        f = matmul([list(c) for c in zip(*f)], matmul(B, f))
    elif definition == "weighted":
        f = matmul(B, heat_matrix(L, B, 2 * t))
    else:
        f = kernel_matrix(L, B, 2 * t)
    return [[math.sqrt(max(0, f[i][i] - f[i][j] - f[j][i] + f[j][j])) for j in range(n)] for i in range(n)]


class Distances(Case):
    """Signatures, distances, pairs and samples."""
    DEFINITIONS = ("classical", "weighted", "commute", "biharmonic")
    INERT = 4 + 12                                                  # of parts, which has four vertices more behind it

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = bumpy_patch(4)
        cls.dense = cls.file("dense.obj", obj_text(*cls.mesh))
        cls.L, cls.B = cotan_and_fem(*cls.mesh)
        cls.torus = cls.file("torus.obj", obj_text(*torus(40, 24)))
        v, f = icosahedron()                                        # a tetrahedron, an icosahedron, a vertex in no face, a triangle
        tetrahedron = ([(20.0, 0.0, 0.0), (21.0, 0.0, 0.0), (20.0, 1.0, 0.0), (20.0, 0.0, 1.5)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
        v, f = apart(tetrahedron, (v + [(0.0, 0.0, 50.0)], f), ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)], [(0, 1, 2)]))
        cls.parts = cls.file("parts.obj", obj_text(v, f))

    def mass(self, kind):
        return self.B if kind == "fem" else identity(len(self.L))

    def pairs_file(self, pairs, name="pairs.txt"):
        return self.file(name, "".join("%d %d\n" % p for p in pairs))

    def report(self, *args):
        return json.loads(self.good(*args, "--json", "-o", self.path("report.npy")).stderr)

    # ---- numbers ----

    def test_signature_is_the_dense_diagonal(self):
        times = (0.05, 1.0, 30.0)
        for kind in ("fem", "cot"):
            for more, matrix in (([], kernel_matrix), (["--kernel", "symmetric"], kernel_matrix), (["--kernel", "operator"], heat_matrix)):
                got = self.field("hks", self.dense, "--laplacian", kind, "--t", ",".join(map(str, times)), *more)
                self.assertEqual((len(got), len(got[0])), (25, 3))
                for k, t in enumerate(times):
                    want = matrix(self.L, self.mass(kind), t)
                    for i in range(25):
                        self.assertAlmostEqual(got[i][k] / want[i][i], 1, delta=2e-7)

    def test_trace_and_normalised_signature(self):
        times = (0.05, 1.0, 30.0)
        given = ",".join(map(str, times))
        for kind in ("fem", "cot"):
            rows = self.field("trace", self.dense, "--laplacian", kind, "--t", given)
            got = self.field("hks", self.dense, "--laplacian", kind, "--t", given, "--normalise")
            self.assertEqual((len(rows), len(rows[0])), (3, 3))
            for k, t in enumerate(times):
                K, k_t = heat_matrix(self.L, self.mass(kind), t), kernel_matrix(self.L, self.mass(kind), t)
                trace = sum(K[i][i] for i in range(25))
                self.assertEqual(rows[k][0], t)
                self.assertLessEqual(abs(rows[k][1] - trace), rows[k][2] + 1e-12 * trace)
                self.assertLess(rows[k][2], 1e-6 * trace)
                for i in range(25):
                    self.assertAlmostEqual(got[i][k] * trace / k_t[i][i], 1, delta=4e-7)
        self.assertEqual(self.good("trace", self.dense, "--t", "1,2h2,1/l1", "-o", self.path("trace.csv")).stdout, b"")
        with open(self.path("trace.csv"), encoding="utf-8") as f:
            self.assertEqual(f.readline().strip(), "t,trace,bound")
            self.assertEqual(len(f.readlines()), 3)

    def test_times_by_the_first_eigenvalue(self):
        """1/l1 is one over the second eigenvalue; times of auto:K lie between 0.0024 and 0.37 of the area."""
        r = self.report("spectrum", self.torus, "-k", 2)
        t = self.report("hks", self.torus, "--t", "1/l1,0.1/l1,auto:3")["times"]
        self.assertAlmostEqual(t[0] * r["eigenvalues"][1], 1, delta=1e-9)
        self.assertAlmostEqual(t[1] / t[0], 0.1, delta=1e-12)
        for k, part in enumerate((0.0024, math.sqrt(0.0024 * 0.37), 0.37)):
            self.assertAlmostEqual(t[2 + k] / r["area"] / part, 1, delta=1e-9)
        for path, name in ((self.path("l1.csv"), "v3_0.5/l1"),):
            self.good("kernel", self.torus, "--source", 3, "--t", "0.5/l1", "-o", path)
            with open(path, encoding="utf-8") as f:
                self.assertEqual(f.readline().strip(), name)

    def test_scale_invariant_signature(self):
        """By its definition from signatures at the times told, and nearly the same on a mesh of another size."""
        args = ("--scale-invariant", 4, "--t", "1e-6,1e4")
        got, r = self.field("hks", self.dense, *args), self.report("hks", self.dense, *args)
        times = r["times"]
        m = len(times) - 1
        self.assertEqual((len(got[0]), m), (4, round(16 * math.log2(1e10))))
        logs = [[math.log(x) for x in row] for row in self.field("hks", self.dense, "--t", ",".join(map(repr, times)))]
        want = [[abs(sum((row[j + 1] - row[j]) * complex(math.cos(2 * math.pi * j * k / m), -math.sin(2 * math.pi * j * k / m)) for j in range(m)))
                 for k in range(4)] for row in logs]
        largest = max(map(max, want))
        self.assertLess(max(abs(a - b) for x, y in zip(got, want) for a, b in zip(x, y)), 1e-5 * largest)
        self.assertLess(r["error_bound"], 1e-4)
        scaled = self.file("scaled.obj", obj_text([tuple(3 * c for c in p) for p in self.mesh[0]], self.mesh[1]))
        moved = self.field("hks", scaled, *args)
        self.assertLess(max(abs(a - b) for x, y in zip(got, moved) for a, b in zip(x, y)), 1e-2 * largest)
        self.good("hks", self.dense, *args, "-o", self.path("si.csv"))
        with open(self.path("si.csv"), encoding="utf-8") as f:
            self.assertEqual(f.readline().strip(), "si_0,si_1,si_2,si_3")

    def test_forms_of_signatures_refuse(self):
        def refused(text, *args):
            self.assertIn(text, self.bad(2, *args))
        refused("--kernel symmetric", "hks", self.dense, "--t", 1, "--normalise", "--kernel", "operator")
        refused("beside it", "hks", self.dense, "--t", "1,2", "--normalise", "--scale-invariant", 3)
        refused("first and the last", "hks", self.dense, "--t", "1", "--scale-invariant", 3)
        refused("first and the last", "hks", self.dense, "--t", "1,auto:4", "--scale-invariant", 3)
        refused("--scale-invariant takes", "hks", self.dense, "--t", "1,2", "--scale-invariant", 0)
        refused("--normalise is not an option", "kernel", self.dense, "--t", 1, "--source", 0, "--normalise")
        refused("times > 0", "trace", self.dense, "--t", "0")
        refused("needs --t", "trace", self.dense)
        refused("--t takes", "hks", self.dense, "--t", "1/l2")
        refused("--t takes", "hks", self.dense, "--t", "auto:3/l1")
        refused("--bandwidth takes", "info", self.dense, "--bandwidth", "1/l1")
        self.assertIn("not above the first", self.bad(1, "hks", self.dense, "--t", "2,1", "--scale-invariant", 3))

    def test_distances_are_dense_ones(self):
        for kind in ("fem", "cot"):
            for definition in self.DEFINITIONS:
                timeless = definition in ("commute", "biharmonic")
                times = (None,) if timeless else (0.05, 1.0)
                got = self.field("distance", self.dense, "--laplacian", kind, "--source", "7,0", "--definition", definition,
                                 *([] if timeless else ["--t", "0.05,1"]))
                self.assertEqual(len(got[0]), 2 * len(times))
                for k, t in enumerate(times):
                    want = distances(definition, self.L, self.mass(kind), t)
                    self.close(columns(got, k), [[x] for x in want[7]], 1e-6)
                    self.close(columns(got, len(times) + k), [[x] for x in want[0]], 1e-6)

    def test_pairs_are_dense_ones(self):
        pairs = [(7, 0), (0, 7), (3, 3), (24, 1), (7, 0)]
        given = self.pairs_file(pairs)
        for kind in ("fem", "cot"):
            for definition in self.DEFINITIONS:
                timeless = definition in ("commute", "biharmonic")
                got = self.field("pairs", self.dense, "--laplacian", kind, "--input", given, "--definition", definition,
                                 *([] if timeless else ["--t", "0.05,1"]))
                self.assertEqual([tuple(r[:2]) for r in got], pairs)
                self.assertEqual(len(got[0]), 3 if timeless else 6)
                for k, t in enumerate((None,) if timeless else (0.05, 1.0)):
                    d = distances(definition, self.L, self.mass(kind), t)
                    self.close(columns(got, 2 if timeless else 3 + 2 * k), [[d[i][j]] for i, j in pairs], 1e-6)
                    if not timeless:
                        K = heat_matrix(self.L, self.mass(kind), t)
                        self.close(columns(got, 2 + 2 * k), [[K[i][j]] for i, j in pairs], 1e-7)
        k = kernel_matrix(self.L, self.B, 1.0)
        got = self.field("pairs", self.dense, "--input", given, "--t", 1, "--kernel", "symmetric")
        self.close(columns(got, 2), [[k[i][j]] for i, j in pairs], 1e-7)
        d = distances("classical", self.L, self.B, 1.0)
        self.close(columns(got, 3), [[d[i][j]] for i, j in pairs], 1e-6)

    def test_sample_is_greedy(self):
        for definition in self.DEFINITIONS:
            timeless = definition in ("commute", "biharmonic")
            d = distances(definition, self.L, self.B, 0.5)
            for given in ([], [13], [13, 2]):
                args = ["--definition", definition] + ([] if timeless else ["--t", 0.5]) + (["--source", ",".join(map(str, given))] if given else [])
                got = self.field("sample", self.dense, "--count", 5, *args)
                chosen, steps = (given or [0])[:1], [0.0]
                while len(chosen) < 5:
                    nearest = [min(d[i][c] for c in chosen) for i in range(25)]
                    chosen.append(given[len(chosen)] if len(chosen) < len(given) else max(range(25), key=lambda i: nearest[i]))
                    steps.append(nearest[chosen[-1]])
                self.assertEqual([r[0] for r in got], chosen)
                self.close(columns(got, 1), [[x] for x in steps], 1e-6)

    def test_sample_takes_no_vertex_twice(self):
        got = self.field("sample", self.dense, "--count", 25, "--t", "100000h2")        # all distances are zero but for rounding
        self.assertEqual(sorted(r[0] for r in got), list(range(25)))
        got = self.field("sample", self.parts, "--count", 19, "--definition", "commute")
        self.assertEqual(sorted(r[0] for r in got), [i for i in range(20) if i != self.INERT])

    def test_components_and_inert_vertices(self):
        inert, n = self.INERT, 20
        parts = (range(0, 4), range(4, 16), range(17, 20))
        got = self.field("hks", self.parts, "--t", "1h2,5h2")
        self.assertEqual(got[inert], [0, 0])
        self.assertEqual(self.field("hks", self.parts, "--t", 1, "--kernel", "operator")[inert], [1])
        self.assertTrue(all(x > 0 for i in range(n) if i != inert for x in got[i]))
        for definition in ("commute", "biharmonic"):
            got = self.field("distance", self.parts, "--source", "1,5,16", "--definition", definition)
            for q, s in enumerate((1, 5, inert)):
                for i in range(n):
                    together = i == s or any(i in p and s in p for p in parts)
                    self.assertEqual(math.isinf(got[i][q]), not together, (definition, s, i))
                    self.assertEqual(got[i][q] == 0, i == s)
            rows = self.field("pairs", self.parts, "--input", self.pairs_file([(0, 3), (0, 4), (16, 16), (3, 16)]), "--definition", definition)
            self.assertEqual([math.isinf(r[2]) for r in rows], [False, True, False, True])
            self.assertEqual(rows[2][2], 0)
        got = self.field("distance", self.parts, "--source", "1,16", "--t", 1)
        k = self.field("hks", self.parts, "--t", 2)
        for i in range(n):
            if i not in parts[0]:                                   # no heat in common: d^2 = k_2t(s,s) + k_2t(i,i)
                self.assertAlmostEqual(got[i][0], math.sqrt(k[1][0] + k[i][0]), delta=1e-6 * got[i][0])
        for e in ("npy", "vtu", "ply", "png", "csv"):               # infinities are written as such, and are no colours
            self.good("distance", self.parts, "--source", 1, "--definition", "commute", "-o", self.path("inf." + e))

    def test_many_times_and_sources_in_order(self):
        times, sources = ("30h2", "2h2", "9h2"), (3, 700)
        one = {(s, t): self.field("distance", self.torus, "--source", s, "--t", t) for s in sources for t in times}
        got = self.field("distance", self.torus, "--source", "3,700", "--t", ",".join(times))
        self.assertEqual(len(got[0]), 6)
        for c, (s, t) in enumerate((s, t) for s in sources for t in times):
            self.close(columns(got, c), one[s, t], 1e-7)
        self.assertEqual([r[0] for r in got][3], 0)
        times = ("9h2", "1h2", "3h2", "20h2", "2h2", "14h2", "1.5h2", "5h2", "7h2", "4h2", "12h2", "17h2")       # so many share their poles
        for definition in ("classical", "weighted"):
            run = ("distance", self.torus, "--source", "3,700,3", "--definition", definition, "--laplacian", "voronoi-cot")
            got, r = self.field(*run, "--t", ",".join(times)), self.report(*run, "--t", ",".join(times))
            self.assertEqual((len(got[0]), len(r["per_time"])), (36, 12))
            self.assertGreater(r["degree"], 14)                     # no set for a single time has more
            for k in (0, 3, 10):
                one = self.field(*run, "--t", times[k])
                for q in range(3):
                    self.close(columns(got, 12 * q + k), columns(one, q), 1e-6)
        times = ("30h2", "2h2", "9h2")
        got = self.field("hks", self.torus, "--t", ",".join(times))
        for c, t in enumerate(times):
            self.close(columns(got, c), self.field("hks", self.torus, "--t", t), 2e-7)         # together they may share other poles
        r = self.report("hks", self.torus, "--t", "auto:3,2h2")
        self.assertEqual((len(r["times"]), len(r["per_time"])), (4, 4))
        self.close(self.field("hks", self.torus, "--t", "%.17g" % r["times"][1]), columns(self.field("hks", self.torus, "--t", "auto:3"), 1), 2e-7)

    def test_poles_degrees_and_laplacians(self):
        for command, more in (("hks", []), ("distance", ["--source", 5])):
            for kind in KINDS:
                run = [command, self.torus, "--t", "10h2", "--laplacian", kind] + more
                want = self.field(*run)
                self.assertEqual(self.report(*run)["poles"], "diagonal")
                for poles, degree in (("diagonal", 12), ("kernel", 12), ("uniform", 14)):
                    chosen = ["--poles", poles, "--degree", degree, "--method", "direct"]
                    self.close(self.field(*run, *chosen), want, 1e-7 if command == "hks" else 1e-6)
                    r = self.report(*run, *chosen)
                    self.assertEqual((r["poles"], r["degree"], r["method"]), (poles, degree, "direct"))

    def test_threads_change_nothing(self):
        given = self.pairs_file([(i, 7 * i) for i in range(40)])
        for run in (["hks", "--t", "2h2,50h2"], ["distance", "--source", "1,500", "--t", "20h2"], ["distance", "--source", 1, "--definition", "biharmonic"],
                    ["pairs", "--input", given, "--t", "20h2"], ["sample", "--count", 6, "--t", "20h2"]):
            want = self.good(*run, self.torus, "--threads", 1).stdout
            for threads in (2, 3):
                self.assertEqual(self.good(*run, self.torus, "--threads", threads).stdout, want, run)

    # ---- files ----

    def test_formats(self):
        for run, n in ((["hks", "--t", "1h2,5h2"], 2), (["distance", "--source", "8,90", "--t", "5h2"], 2),
                       (["distance", "--source", "8", "--definition", "commute"], 1)):
            want = self.field(*run, self.patch)
            for e in ("txt", "csv", "npy", "ply", "vtu", "obj", "png"):
                out = self.path("f." + e)
                self.assertEqual(self.good(*run, self.patch, "-o", out, *(["--size", "200x200"] if e == "png" else [])).stdout, b"")
                with open(out, "rb") as f:
                    data = f.read()
                if e in ("txt", "csv"):
                    self.assertEqual(csv(data.decode())[1] if e == "csv" else numbers(data.decode()), want)
                elif e == "npy":
                    self.assertEqual(read_npy(data), want)
                elif e == "vtu":
                    arrays, points, _ = read_vtu(data)
                    self.assertEqual((points, len(arrays)), (100, n))
                    self.close([list(r) for r in zip(*arrays.values())], want, 1e-6)
                elif e == "ply":
                    self.assertEqual(len(read_ply(data)[0]), 100)
                elif e == "png":
                    self.assertGreater(read_png(data)[2], 30)
        for run in (["pairs", "--input", self.pairs_file([(1, 2), (4, 4)]), "--t", "1h2,3h2"], ["sample", "--count", 4, "--t", "9h2"]):
            want = self.field(*run, self.patch)
            self.assertRegex(self.good(*run, self.patch).stdout.decode(), r"(?m)^\d+ ")             # ids are written as integers
            for e in ("txt", "csv", "npy"):
                out = self.path("f." + e)
                self.good(*run, self.patch, "-o", out)
                with open(out, "rb") as f:
                    data = f.read()
                got = read_npy(data) if e == "npy" else csv(data.decode())[1] if e == "csv" else numbers(data.decode())
                self.assertEqual(got, want)
        binary = self.file("pairs.npy", npy_bytes([[1.0, 2.0], [4.0, 4.0]]))
        self.assertEqual(self.field("pairs", self.patch, "--input", binary, "--t", "1h2"),
                         self.field("pairs", self.patch, "--input", "-", "--t", "1h2", stdin=b"# two\n1, 2\n\n4 4\n"))

    # ---- reports ----

    def test_reports(self):
        given = self.pairs_file([(1, 2), (4, 4)])
        for run in (["hks", "--t", "3h2,9h2"], ["distance", "--source", "1,2", "--t", "3h2"], ["distance", "--source", 3, "--definition", "biharmonic"],
                    ["pairs", "--input", given, "--t", "3h2"], ["pairs", "--input", given, "--definition", "commute"],
                    ["sample", "--count", 3, "--t", "3h2"], ["sample", "--count", 3, "--definition", "commute"]):
            r = self.report(*run, self.patch)
            for k in Reports.KEYS + ("error_relative", "smallest", "lost", "per_time"):
                self.assertIn(k, r, run)
            self.assertEqual((r["command"], r["n"], r["ordering"] in ("amd", "dissection")), (run[0], 100, True))
            self.assertGreater(r["factor_nnz"], 100)
            self.assertEqual(len(r["times"]), 0 if "--definition" in run else run[-1].count(",") + 1)
            self.assertGreater(r["seconds"]["factor"], 0)
            if run[0] != "pairs":
                self.assertEqual(r["method"], "direct")
                self.assertGreater(r["seconds"]["invert"], 0)
                self.assertTrue(0 < r["error_relative"] < 1e-3, r["error_relative"])
                self.assertTrue(0 < r["error_bound"] <= r["error_relative"])
                self.assertGreater(r["smallest"], 0)
                self.assertEqual(r["lost"], 0)
            if run[0] == "pairs":
                self.assertEqual((r["pairs"], r["input"]), (2, given))
            elif run[0] != "hks":
                self.assertEqual(r["sources"], {"distance": [int(s) for s in str(run[2]).split(",")], "sample": []}[run[0]])
            if run[0] != "hks":
                self.assertEqual(r["definition"], run[-1] if "--definition" in run else "classical")
            text = self.good(*run, self.patch).stderr.decode()
            self.assertRegex(text, r"(?m)^%s: .*Laplacian$" % run[0])
            self.assertTrue(5 <= text.count("\n") <= 8, text)
        self.assertEqual(self.report("hks", self.patch, "--t", 1)["kernel"], "symmetric")

    def test_what_is_lost_is_told(self):
        run = ["distance", self.patch, "--source", 1, "--t", "100000h2"]
        self.assertGreater(self.report(*run)["lost"], 50)
        self.assertIn("pairs", self.good(*run).stderr.decode())

    # ---- errors ----

    def test_usage(self):
        given = self.pairs_file([(1, 2)])

        def refused(text, *args):
            self.assertIn(text, self.bad(2, *args, self.small))
        runs = {"hks": [], "distance": ["--source", 0], "pairs": ["--input", given], "sample": ["--count", 2]}
        for name, run in runs.items():
            refused("--t", name, *run)
            for t in ("0", "1,0h2", "-1"):
                refused("--t takes", name, *run, "--t=" + t)
            for method in ("krylov", "iterative"):
                if name != "pairs":
                    refused("--method takes auto or direct", name, *run, "--t", 1, "--method", method)
                    self.assertIn("--solver", self.bad(2, name, *run, "--t", 1, "--solver", "cocg", self.small))
            for poles in ("kernel", "diagonal"):
                refused("--degree takes", name, *run, "--t", 1, "--poles", poles, "--degree", 1)
            refused("--degree takes", name, *run, "--t", 1, "--degree", 1)
            self.good(name, *run, "--t", 1, "--poles", "uniform", "--degree", 1, self.small)
            if name == "hks":
                refused("--definition is not an option of hks", name, "--t", 1, "--definition", "commute")
                continue
            refused("--definition takes", name, *run, "--t", 1, "--definition", "paper")
            for definition in ("commute", "biharmonic"):
                refused("--t takes --definition", name, *run, "--t", 1, "--definition", definition)
                for option, value in (("poles", "kernel"), ("degree", 8)):
                    refused("--%s takes" % option, name, *run, "--definition", definition, "--" + option, value)
                refused("--method takes", name, *run, "--definition", definition, "--method", "krylov")
        refused("--source", "distance", "--t", 1)
        refused("--input", "pairs", "--t", 1)
        refused("--count", "sample", "--t", 1)
        refused("--count takes", "sample", "--t", 1, "--count", 0)
        refused("--source takes", "sample", "--t", 1, "--count", 2, "--source", "0,1,2")
        refused("--source takes", "sample", "--t", 1, "--count", 2, "--source", "0:2,1")
        for t in ("1,2", "auto:2"):
            refused("--t takes", "sample", "--count", 2, "--t", t)
        refused("--kernel", "distance", "--t", 1, "--source", 0, "--kernel", "symmetric")
        for name in ("pairs", "sample"):
            for e in ("ply", "obj", "vtu", "png", "foo"):
                text = self.bad(2, name, *runs[name], "--t", 1, "-o", self.path("x." + e), self.small)
                self.assertIn(".npy", text)
                self.assertNotIn(".vtu or", text)
        self.bad(2, "pairs", "--input", "-", "--t", 1, "-")
        self.good("pairs", *runs["pairs"], "--t", 1, "--method", "krylov", self.small)

    def test_bad_pairs(self):
        def pairs(content, name="p.txt"):
            out = self.path("out.txt")
            text = self.bad(1, "pairs", self.small, "--input", self.file(name, content), "--t", 1, "-o", out)
            self.assertFalse(os.path.exists(out))
            return text
        self.assertRegex(pairs("0 1\n2 12\n"), r"p\.txt:2: 12 .*12")
        self.assertIn("p.txt:3", pairs("# ids\n0 1\n-1 2\n"))
        self.assertIn("p.txt:1", pairs("0.5 1\n"))
        self.assertIn("p.txt:1", pairs("1e30 1\n"))
        self.assertIn("p.txt:2", pairs("0 1\n3 four\n"))
        self.assertIn("p.txt:2", pairs("0 1\n3\n"))
        for content in ("0\n1\n", "0 1 2\n", ""):
            self.assertIn("p.txt", pairs(content))
        self.assertIn("p.npy", pairs(npy_bytes([[0.0, 12.0]]), "p.npy"))
        self.assertIn("not-there", self.bad(1, "pairs", self.small, "--input", self.path("not-there"), "--t", 1))

    def test_beyond_the_mesh(self):
        self.assertIn("12 vertices", self.bad(1, "distance", self.small, "--source", "0,12", "--t", 1))
        self.assertIn("12 vertices", self.bad(1, "sample", self.small, "--count", 3, "--source", 12, "--t", 1))
        self.assertIn("--count", self.bad(1, "sample", self.small, "--count", 13, "--t", 1))
        self.assertIn("19 vertices", self.bad(1, "sample", self.parts, "--count", 20, "--t", 1))
        for run in (["hks", "--t", 1], ["distance", "--source", 0, "--t", 1], ["sample", "--count", 2, "--t", 1]):
            out = self.path("never.npy")
            self.bad(1, *run, self.patch, "--memory-limit", 3000, "-o", out)
            self.assertFalse(os.path.exists(out))


class Formats(Case):
    def write(self, name, *more):
        out = self.path(name)
        p = self.good("kernel", self.patch, "--source", "8,90", "--t", "1h2,5h2", "-o", out, *more)
        self.assertEqual(p.stdout, b"")
        with open(out, "rb") as f:
            data = f.read()
        os.remove(out)
        return data

    def setUp(self):
        self.want = self.field("kernel", self.patch, "--source", "8,90", "--t", "1h2,5h2")

    def test_text(self):
        self.assertEqual(numbers(self.write("k.txt").decode()), self.want)
        names = ["v8_1h2", "v8_5h2", "v90_1h2", "v90_5h2"]
        self.assertEqual(csv(self.write("k.csv").decode()), (names, self.want))
        self.assertEqual(numbers(self.write("k.csv", "--no-header").decode(), ","), self.want)
        self.assertEqual(numbers(self.write("K.TXT").decode()), self.want)

    def test_names_of_columns(self):
        """The first line of .csv says what the command's help says, and leaves the text alone."""
        two = self.file("two.txt", "1 2\n" * 100)
        pairs = self.file("p.txt", "3 8\n8 3\n")
        for run, names in (
                (["kernel", "--source", "3,8", "--t", "1,2"], "v3_1,v3_2,v8_1,v8_2"),
                (["kernel", "--source", "3,3", "--t", "1"], "v3_1_c0,v3_1_c1"),
                (["distance", "--source", "3,8", "--t", "1,2"], "v3_1,v3_2,v8_1,v8_2"),
                (["distance", "--source", "3", "--definition", "commute"], "v3_commute"),
                (["diffuse", "--input", two, "--t", "1,2"], "f0_1,f0_2,f1_1,f1_2"),
                (["geodesic", "--source", "3,8"], "v3_1h2,v8_1h2"),
                (["hks", "--t", "1,2"], "hks_1,hks_2"),
                (["pairs", "--input", pairs, "--t", "1,2"], "i,j,K_1,d_1,K_2,d_2"),
                (["pairs", "--input", pairs, "--definition", "commute"], "i,j,d_commute"),
                (["sample", "--count", 3, "--t", "1"], "vertex,distance")):
            out = self.path("names.csv")
            self.assertEqual(self.good(*run, self.patch, "-o", out).stdout, b"")
            with open(out) as f:
                text = f.read()
            self.assertEqual(csv(text), (names.split(","), self.field(*run, self.patch)))
            self.good(*run, self.patch, "--no-header", "-o", out)
            with open(out) as f:
                self.assertEqual(f.read(), text.split("\n", 1)[1])
            if "3,3" in run or "commute" in run:
                continue
            words = self.good(run[0], "--help").stdout.decode().replace(",", " ").replace(".", " ").split()
            for name in names.split(","):
                self.assertIn(name, words, run)

    def test_help_lists_inputs(self):
        for command in ([], ["kernel"], ["info"], ["render"]):
            text = self.good(*command, "--help").stdout.decode()
            for name in ("OBJ", "OFF", "PLY", "STL", "XYZ"):
                self.assertIn(name, text)
        for command in COMMANDS:
            self.assertIn("\nOutput\n", self.good(command, "--help").stdout.decode())
            if command not in ("info", "render", "demo"):
                self.assertIn("--no-header", self.good(command, "--help").stdout.decode())

    def test_npy(self):
        self.assertEqual(read_npy(self.write("k.npy")), self.want)

    def test_ply(self):
        vertices, faces = read_ply(self.write("k.ply"))
        v, f = bumpy_patch(9)
        self.assertEqual(faces, [list(t) for t in f])
        for p, q in zip(vertices, v):
            for x, y in zip((p["x"], p["y"], p["z"]), q):
                self.assertAlmostEqual(x, y, places=5)
            self.assertTrue(all(0 <= p[c] <= 255 for c in ("red", "green", "blue")))
        extra = [k for k in vertices[0] if k not in ("x", "y", "z", "red", "green", "blue", "alpha", "nx", "ny", "nz")]
        self.assertEqual(len(extra), 4)
        self.close([[p[k] for k in extra] for p in vertices], self.want, 1e-6)

    def test_obj(self):
        lines = self.write("k.obj").decode().splitlines()
        v = [[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")]
        self.assertEqual(len(v), 100)
        self.assertTrue(all(len(p) == 6 and all(0 <= c <= 1 for c in p[3:]) for p in v))
        self.assertEqual(sum(line.startswith("f ") for line in lines), 162)

    def test_vtu(self):
        arrays, n, cells = read_vtu(self.write("k.vtu"))
        self.assertEqual((n, cells, len(arrays)), (100, 162, 4))
        self.close([list(r) for r in zip(*arrays.values())], self.want, 1e-6)

    def test_png(self):
        for more in ([], ["--log"], ["--isolines", 8], ["--range", "0,0.5"], ["--view", "100,-40"], ["--column", 3], ["--title", "a <title> \u00e9"]):
            w, h, distinct = read_png(self.write("k.png", "--size", "320x240", *more))
            self.assertEqual((w, h), (320, 240))
            self.assertGreater(distinct, 30)

    def test_render(self):
        f = self.file("r.txt", "".join("%g %g\n" % (math.sin(i), i) for i in range(100)))
        out = self.path("r.png")
        for more in ([], ["--column", 1, "--isolines", 10]):
            p = self.good("render", self.patch, "--input", f, "-o", out, "--size", "200x200", *more)
            self.assertEqual(p.stdout, b"")
            with open(out, "rb") as g:
                self.assertEqual(read_png(g.read())[:2], (200, 200))
        constant = self.file("r1.npy", npy_bytes([[3.0]] * 100, flat=True))
        self.assertEqual(self.good("render", self.patch, "--input", constant, "--quiet", "-o", out).stderr, b"")

    def test_render_side_by_side(self):
        """Several fields, or several meshes with a field each, in one picture with one range of colours."""
        low, high = self.file("low.txt", "".join("%d\n" % (i % 5) for i in range(100))), self.file("high.txt", "".join("%d\n" % i for i in range(100)))
        other = self.path("other.ply")
        self.good("kernel", self.patch, "--source", 8, "--t", "5h2", "-o", other)
        out = self.path("pair.png")

        def draw(*args):
            self.good("render", *args, "-o", out, "--size", "400x200", "--isolines", 0, "--view", "0,0", "--title", "x")
            with open(out, "rb") as g:
                data = g.read()
            self.assertEqual(read_png(data)[:2], (400, 200))
            return data

        pair = draw(self.patch, "--input", low, "--input", high)
        self.assertNotEqual(pair, draw(self.patch, "--input", high, "--input", high))
        self.assertNotEqual(pair, draw(self.patch, "--input", low, "--input", low))
        # the range is that of both: giving it changes nothing, and the same mesh under two names is as good as one (captions apart)
        self.assertEqual(pair, draw(self.patch, "--input", low, "--input", high, "--range", "0,99"))
        draw(self.patch, other, "--input", low, "--input", high)
        report = json.loads(self.good("render", self.patch, other, "--input", low, "--input", high, "-o", out, "--json").stderr)
        self.assertEqual(report["panels"], 2)
        self.assertIn("each mesh", self.bad(2, "render", self.patch, other, "--input", low, "-o", out))
        self.assertIn("each mesh", self.bad(2, "render", self.patch, self.patch, "--input", low, "--input", low, "--input", low, "-o", out))
        self.assertIn("only once", self.bad(2, "render", self.patch, "--input", "-", "--input", "-", "-o", out))
        self.assertIn("one mesh", self.bad(2, "info", self.patch, other))
        self.assertIn("twelve", self.bad(2, "render", self.patch, *(["--input", low] * 13), "-o", out))
        self.assertIn("rows", self.bad(1, "render", self.patch, self.small, "--input", low, "--input", high, "-o", out))
        self.assertIn("not-there", self.bad(1, "render", self.patch, self.path("not-there.obj"), "--input", low, "--input", high, "-o", out))
        self.assertEqual(self.good("render", self.patch, "--input", low, "--input", high, "--quiet", "--size", "64x64", "-o", out).stderr, b"")
        self.assertIn("high.txt", self.bad(1, "render", self.patch, "--input", self.file("two.txt", "1 2\n" * 100), "--input", high, "--column", 1, "-o", out))

    def test_outputs_can_be_read_again(self):
        want = self.field("kernel", self.patch, "--source", 8, "--t", "5h2")
        for e in ("ply", "obj", "npy", "txt", "csv"):
            out = self.path("again." + e)
            self.good("kernel", self.patch, "--source", 8, "--t", "5h2", "-o", out)
            if e in ("ply", "obj"):
                report = json.loads(self.good("info", out, "--json").stdout)
                self.assertEqual((report["n"], report["faces"]), (100, 162))
            else:
                self.close(self.field("diffuse", self.patch, "--input", out, "--t", 0), want, 1e-14)

    def test_field_forms(self):
        rows = [[math.sin(i), float(i)] for i in range(12)]
        want = self.field("diffuse", self.small, "--t", 1, "--input", self.file("a.txt", "".join("%.17g %.17g\n" % tuple(r) for r in rows)))
        for name, content in (
                ("b.txt", "# two columns\n\n" + "".join("\t%.17g ,  %.17g # row\r\n" % tuple(r) for r in rows)),
                ("c.csv", "".join("%.17g,%.17g\n" % tuple(r) for r in rows).rstrip("\n")),
                ("d.npy", npy_bytes(rows)), ("e.npy", npy_bytes(rows, fortran=True))):
            self.assertEqual(self.field("diffuse", self.small, "--t", 1, "--input", self.file(name, content)), want, name)
        flat = self.file("g.npy", npy_bytes(columns(rows, 0), flat=True))
        self.close(self.field("diffuse", self.small, "--t", 1, "--input", flat), columns(want, 0), 1e-7)

    def test_standard_input(self):
        for path in (self.small, self.patch):
            with open(path, "rb") as f:
                data = f.read()
            self.assertEqual(self.field("kernel", "-", "--source", 4, "--t", "3h2", stdin=data),
                             self.field("kernel", path, "--source", 4, "--t", "3h2"))
        self.assertIn("stdin", self.bad(1, "info", "-", stdin=b"v 1 2\n").replace("standard input", "stdin"))


class Reports(Case):
    KEYS = ("n", "faces", "components", "h", "area", "inert", "laplacian", "method", "solver", "precond", "poles", "degree", "times", "iterations",
            "residual", "error_bound", "mass_drift", "threads", "peak_bytes", "seconds", "reason", "ordering", "factor_nnz", "factor_flops",
            "growth", "evidence", "error_rational", "error_solver", "error_rounding")

    def test_kernel_json(self):
        p = self.good("kernel", self.patch, "--source", "1,2", "--t", "2,40h2", "--json")
        r = json.loads(p.stderr)
        for k in self.KEYS:
            self.assertIn(k, r)
        for k in ("load", "assemble", "order", "analyse", "factor", "solve", "total"):
            self.assertGreaterEqual(r["seconds"][k], 0)
        self.assertEqual((r["n"], r["faces"], r["components"], r["inert"], r["sources"]), (100, 162, 1, 0, [1, 2]))
        self.assertEqual((r["laplacian"], r["command"]), ("fem", "kernel"))
        self.assertIn(r["method"], ("direct", "krylov", "iterative"))
        self.assertEqual(r["times"][0], 2)
        self.assertAlmostEqual(r["times"][1], 40 * r["h"] ** 2)
        self.assertLess(r["error_bound_b"], 2e-7)
        self.assertEqual(set(r["evidence"]), {"rational", "solver", "rounding"})
        self.assertLessEqual(set(r["evidence"].values()), {"none", "proven", "measured", "estimated"})
        self.assertIn(r["evidence"]["rounding"], ("proven", "measured", "estimated"))
        self.assertLess(r["error_bound"], 1e-5)
        self.assertLess(r["mass_drift"], 1e-6)
        self.assertGreater(r["peak_bytes"], 1000)
        self.assertEqual(len(numbers(p.stdout.decode())), 100)

    def test_diffuse_json(self):
        f = self.file("j.txt", "1\n" * 100)
        r = json.loads(self.good("diffuse", self.patch, "--input", f, "--t", "2", "--json", "--poles", "uniform", "--degree", 7, "--solver",
                                 "cocr", "--precond", "ssor").stderr)
        self.assertEqual((r["poles"], r["degree"], r["solver"], r["precond"]), ("uniform", 7, "cocr", "ssor"))

    def test_info(self):
        r = json.loads(self.good("info", self.patch, "--json").stdout)
        for k in ("n", "faces", "components", "h", "area", "inert", "boundary_loops"):
            self.assertIn(k, r)
        self.assertEqual((r["n"], r["faces"], r["boundary_loops"]), (100, 162, 1))
        text = self.good("info", self.patch).stdout.decode()
        self.assertIn("100", text)
        self.assertIn("162", text)
        closed = json.loads(self.good("info", self.small, "--json").stdout)
        self.assertEqual(closed["boundary_loops"], 0)
        self.assertAlmostEqual(closed["area"], 20 * math.sqrt(3))

    def test_info_counts_defects(self):
        v, f = icosahedron()
        path = self.file("defects.obj", obj_text(v + [v[0]], f + [f[0], (1, 1, 2), (0, 12, 3)]))
        r = json.loads(self.good("info", path, "--json").stdout)
        self.assertEqual((r["faces"], r["inert"]), (23, 1))
        self.assertEqual((r["repeated_faces"], r["repeated_corner_faces"], r["zero_area_faces"]), (1, 1, 1))

    def test_info_of_nothing_with_area(self):
        r = json.loads(self.good("info", self.file("points.xyz", "0 0 0\n1 0 0\n2 0 0\n"), "--json").stdout)
        self.assertEqual((r["n"], r["faces"], r["inert"]), (3, 0, 3))

    def test_strings_are_escaped(self):
        odd = self.path("a \"b\" \\ \u00e9 \t.obj") if POSIX else self.path("a b.obj")
        shutil.copy(self.small, odd)
        r = json.loads(self.good("info", odd, "--json").stdout)
        self.assertEqual(r["mesh"], odd)

    def test_every_remark(self):
        """What reports and messages say of rare inputs."""
        v, f = icosahedron()
        loose = self.file("loose.obj", obj_text(v + [(9.0, 9.0, 9.0)], f))
        self.assertRegex(self.good("geodesic", loose, "--source", 0, "-o", self.path("g.txt")).stderr.decode(), "1 distance (is )?infinite")
        two = self.file("two.obj", obj_text(*apart((v, f), (v, f))))
        r = self.field("geodesic", two, "--source", "0,12", "--matrix")
        self.assertEqual(r, [[0.0, math.inf], [math.inf, 0.0]])
        r = json.loads(self.good("geodesic", self.small, "--source", "0:0.1,0.1,1:0.5,0.2,2", "--laplacian", "voronoi-cot", "--json", "-o", self.path("g.txt")).stderr)
        self.assertLess(r["residual_heat"], 1e-9)
        places = self.file("places.txt", "0:0.1,0.1\n5\n")
        r = json.loads(self.good("kernel", self.small, "--source-file", places, "--t", 1, "--json", "-o", self.path("g.txt")).stderr)
        self.assertEqual((r["source_file"], r.get("source")), (places, None))
        far = self.file("far.txt", "0\n3\n")           # a curve between vertices with no face between
        self.assertIn("far.txt:", self.bad(1, "geodesic", self.small, "--source-file", far, "--curve"))
        least = json.loads(self.good("spectrum", self.patch, "--border", "dirichlet", "-k", 1, "--json").stderr)["eigenvalues"][0]
        text = self.bad(1, "spectrum", self.patch, "--border", "dirichlet", "--below", 0.5 * least)
        self.assertIn("no eigenvalue is below", text)
        self.assertTrue(0.5 * least <= float(text.split()[-1]) <= least * (1 + 1e-5), (text, least))
        quad = self.file("quad.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
        self.assertIn("polygons are split as fans" if "fans" in self.good("info", quad, "--laplacian", "fem").stdout.decode() else "polygon",
                      self.good("info", quad, "--laplacian", "fem").stdout.decode())
        self.assertIn("intrinsic Delaunay", self.good("info", self.small, "--intrinsic-delaunay").stdout.decode())
        xyz = self.file("p.xyz", "".join("%g %g %g\n" % p for p in v) + "5 5 5\n" * 20)
        text = self.good("info", xyz, "--laplacian", "exp", "--bandwidth", "1h2").stdout.decode()
        self.assertNotIn("from the sampling", text)
        self.assertRegex(text, "coincident")
        flat = self.file("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        self.assertNotIn("meaningful times", self.good("info", flat).stdout.decode())
        self.assertEqual(self.good("info", self.small, "--quiet").stdout, b"")
        values = self.file("values.txt", "\n".join(map(str, range(12))))
        self.assertEqual(self.good("levels", self.small, "--input", values, "--levels", "auto:2", "--quiet", "-o", self.path("l.txt")).stderr, b"")
        nearly = self.file("nearly.txt", "-1e-9\n" + "\n".join(map(str, range(1, 12))))
        self.good("render", self.small, "--input", nearly, "--size", "64x64", "-o", self.path("r.png"))
        self.assertIn("2 columns", self.bad(1, "kernel", self.small, "--source", "0,1", "--t", 1, "--column", 2, "-o", self.path("r.png")))
        for n in (2, 3):                             # the height suits the number of pictures
            self.good("render", self.small, *["--input=" + values] * n, "-o", self.path("r.png"))
            with open(self.path("r.png"), "rb") as f:
                self.assertLess(read_png(f.read())[1], 900)
        r = [self.field("kernel", self.small, "--source", "0,1", "--t", "1,2,3", *more) for more in ((), ("--degree", 13), ("--poles", "uniform"), ("--precond", "ildl"))]
        for other in r[1:]:
            self.close(other, r[0], 1e-6)

    def test_every_estimate(self):
        """--dry-run of each question, and of runs that do not fit: in words and as JSON."""
        pairs = self.file("pairs.txt", "0 1\n2 3\n1 0\n")
        torus_file = self.file("torus.obj", obj_text(*torus(60, 40)))
        for run in (("hks", "--t", 1, "--kernel", "operator"), ("pairs", "--input", pairs, "--definition", "commute"), ("pairs", "--input", pairs, "--t", "1,2"),
                    ("geodesic", "--source", "0", "--ordering", "amd"), ("trace", "--t", "1"), ("sample", "--count", 3, "--source", "0+1", "--t", 1)):
            self.assertIn("method", self.good(*run, torus_file, "--dry-run").stderr.decode())
        self.assertIn("real factors", self.good("geodesic", self.patch, "--source", 0, "--border", "mean", "--dry-run").stderr.decode())
        run = ("kernel", torus_file, "--source", "0,1,2", "--t", "1h2,2h2,4h2", "--method", "direct", "--degree", "12")
        need = json.loads(self.good(*run, "--dry-run", "--json").stderr)
        limit = int(need["bytes_in_use"] + 0.3 * (need["estimate"]["bytes"] - need["bytes_in_use"]))
        text = self.good(*run, "--memory-limit", limit, "--dry-run").stderr.decode()
        self.assertIn(": too much", text)
        for way in ("--method iterative", "--degree 8"):
            self.assertRegex(text, way + r" needs [0-9.]+ MB and about")
        self.assertIn("--degree 8 needs ", self.bad(1, *run, "--memory-limit", limit))
        xyz = self.file("cloud.xyz", "".join("%.9g %.9g %.9g\n" % p for p in torus(60, 40)[0]))
        for more, text in ((("--weight-cut", "1e-3"), "--tufted needs less"), (("--laplacian", "exp"), "more than the memory limit")):
            self.assertIn(text, self.bad(1, "kernel", xyz, "--source", 0, "--t", 1, *more, "--memory-limit", "100K"))

    def test_quiet_and_default(self):
        p = self.good("kernel", self.small, "--source", 0, "--t", 1, "--quiet")
        self.assertEqual(p.stderr, b"")
        p = self.good("kernel", self.small, "--source", 0, "--t", 1)
        self.assertTrue(1 <= p.stderr.count(b"\n") <= 8, p.stderr)
        self.assertNotIn(b"\r", p.stderr)

    @unittest.skipUnless(POSIX, "needs a terminal")
    def test_progress_only_on_a_terminal(self):
        mesh = self.file("bar.obj", obj_text(*torus(150, 80)))
        run = ["kernel", mesh, "--source", "0,1,2,3", "--t", "2000h2", "--solver", "cocg", "-o", self.path("bar.npy")]
        text = self.on_a_terminal(*run)
        self.assertIn(b"%", text)
        self.assertIn(b"\r", text)
        self.assertEqual(self.on_a_terminal(*run, "--quiet"), b"")

    @unittest.skipUnless(POSIX, "needs a terminal")
    def test_progress_of_factorisations(self):
        mesh = self.file("stages.obj", obj_text(*torus(500, 300)))
        run = ["kernel", mesh, "--source", "0,1,2", "--t", "200h2,300h2,400h2", "-o", self.path("bar.npy")]
        text = self.on_a_terminal(*run, "--method", "direct")
        for word in (b"] ", b"% factor, time ", b"time 2 of 3", b"time 3 of 3"):
            self.assertIn(word, text)
        self.assertTrue(b"% order" in text or b"% analyse" in text)
        text = self.on_a_terminal(*run, "--method", "krylov")
        for word in (b"% solve, source ", b"source 2 of 3", b"source 3 of 3"):
            self.assertIn(word, text)
        for line in text.split(b"\r"):
            self.assertLessEqual(len(line.split(b"\n")[0]), 79 if b"%" in line else 1000)

    @unittest.skipUnless(POSIX, "needs a terminal")
    def test_no_picture_on_a_terminal(self):
        field = self.file("twelve.txt", "\n".join(map(str, range(12))))
        text = self.on_a_terminal("render", self.small, "--input", field, "-o", "-", code=2, output=None)
        self.assertIn(b"nothing for a terminal", text)

    def on_a_terminal(self, *args, code=0, output=subprocess.DEVNULL):
        """What the tool writes to standard error when that is a terminal. output None: standard output is one, too."""
        import pty
        master, slave = pty.openpty()
        p = subprocess.Popen([TOOL] + [str(a) for a in args], stdout=slave if output is None else output, stderr=slave)
        os.close(slave)
        text = b""
        while True:
            try:
                block = os.read(master, 4096)
            except OSError:
                break
            if not block:
                break
            text += block
        os.close(master)
        self.assertEqual(p.wait(), code)
        return text


@unittest.skipUnless(POSIX, "needs signals")
class Interrupts(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.big = cls.file("big.obj", obj_text(*torus(500, 300)))

    def interrupt(self, seconds, *args, twice=False):
        before = sorted(os.listdir(self.folder))
        p = subprocess.Popen([TOOL] + [str(a) for a in args], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        time.sleep(seconds)
        self.assertIsNone(p.poll(), "ended before it could be interrupted: %s" % p.stderr)
        start = time.time()
        for _ in range(2 if twice else 1):       # the second does not wait for the computation
            p.send_signal(signal.SIGINT)
            time.sleep(0.001)
        text = p.communicate(timeout=60)[1]
        early = (-signal.SIGINT,) if seconds < 0.1 else ()      # a busy machine: main had not begun
        self.assertIn(p.returncode, (130, *early), text)
        self.assertNotIn(b"error", text)
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        return time.time() - start

    def test_long_work(self):
        keep = self.file("keep.npy", "precious")
        slow = ["--t", "100000h2,200000h2,300000h2", "--solver", "cocg", "--precond", "jacobi", "--tol", "1e-12"]
        for seconds in (0.05, 0.3, 1.5):
            for out in ("new.npy", "keep.npy"):
                waited = self.interrupt(seconds, "kernel", self.big, "--source", ",".join(map(str, range(40))), *slow, "-o", self.path(out),
                                        twice=seconds == 1.5)
                self.assertLess(waited, 10)
        with open(keep) as f:
            self.assertEqual(f.read(), "precious")

    def test_while_factorising(self):
        sources = ",".join(map(str, range(40)))
        for method, t in (("direct", "auto:20"), ("krylov", "1h2,10000h2,100000000h2"), ("auto", "auto:20")):
            run = ["kernel", self.big, "--source", sources, "--t", t, "--method", method]
            for seconds in (0.25, 0.5, 0.9):
                self.assertLess(self.interrupt(seconds, *run, "-o", self.path("new.npy")), 10)

    def test_while_inverting(self):
        for run in (["hks", "--t", "auto:20"], ["sample", "--count", 1000, "--definition", "commute"]):
            for seconds in (0.5, 1.2):
                self.assertLess(self.interrupt(seconds, *run, self.big, "-o", self.path("new.npy")), 10)

    def test_while_writing(self):
        """A picture of text is long to write: 150 000 rows of 60 columns."""
        f = self.file("wide.npy", npy_bytes([[float(i)] * 60 for i in range(150000)]))
        out = self.path("wide.txt")
        before = sorted(os.listdir(self.folder))
        for seconds in (0.6, 1.0, 1.5, 2.2):
            p = subprocess.Popen([TOOL, "diffuse", self.big, "--input", f, "--t", "0", "-o", out], stderr=subprocess.PIPE,
                                 preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
            time.sleep(seconds)
            p.send_signal(signal.SIGINT)
            text = p.communicate(timeout=120)[1]
            self.assertIn(p.returncode, (0, 130), text)
            if p.returncode == 0 or os.path.exists(out):    # a fast machine: the file was in its place already, and whole
                with open(out) as text:
                    self.assertEqual(sum(1 for line in text if len(line.split()) == 60), 150000)
                os.remove(out)
            self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_when_the_bar_says_what_runs(self):
        """The signal comes while it computes, however busy the machine is; a second one does not wait for the end."""
        import pty
        many = ",".join(map(str, range(40)))
        for word, run in ((b"% solve", ["kernel", "--source", many, "--t", "100000h2,200000h2", "--solver", "cocg", "--precond", "jacobi", "--tol", "1e-12"]),
                          (b"% factor", ["kernel", "--source", many, "--t", "auto:20", "--method", "direct"]), (b"% ", ["geodesic", "--source", many]),
                          (b"% ", ["spectrum", "-k", "300"]), (b"% ", ["hks", "--t", "auto:20", "--dry-run"])):
            before = sorted(os.listdir(self.folder))
            for signals in (1, 2):
                master, slave = pty.openpty()
                p = subprocess.Popen([TOOL, *run, self.big, "-o", self.path("new.npy")], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=slave,
                                     preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
                os.close(slave)
                text = b""
                try:
                    while word not in text:
                        text += os.read(master, 4096)
                    for _ in range(signals):
                        p.send_signal(signal.SIGINT)
                        time.sleep(0.002)
                    while True:
                        text += os.read(master, 4096)
                except OSError:                  # it has ended
                    pass
                os.close(master)
                self.assertNotIn(b"error", text)
                self.assertIn(p.wait(timeout=60), (130,) if run[-1] != "--dry-run" else (0, 130), (run, text))
                self.assertTrue(signals == 2 or p.returncode == 0 or b"heatdiff: interrupted" in text, text)
                self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_waiting_for_standard_input(self):
        p = subprocess.Popen([TOOL, "info", "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        time.sleep(0.3)
        p.send_signal(signal.SIGINT)
        self.assertEqual(p.wait(timeout=20), 130)
        for stream in (p.stdin, p.stdout, p.stderr):
            stream.close()


def geodesic_dense(mesh, source, t):
    """The heat method with lumped masses, on a mesh in one piece: directions by cross products, the last vertex held at zero."""
    v, f = mesh
    n = len(v)
    L, B = cotan_and_fem(v, f)
    u = solve([[t * L[i][j] + (sum(B[i]) if i == j else 0.0) for j in range(n)] for i in range(n)], [[float(i == source)] for i in range(n)])
    b = [[0.0] for _ in range(n)]

    def cross(p, q):
        return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]

    for c in f:
        edge = [sub(v[c[(k + 2) % 3]], v[c[(k + 1) % 3]]) for k in range(3)]
        normal = cross(edge[0], edge[1])
        turned = [cross(normal, e) for e in edge]
        x = [-sum(abs(u[c[k]][0]) * turned[k][i] for k in range(3)) for i in range(3)]
        size = math.sqrt(dot(x, x))
        twice = math.sqrt(dot(normal, normal))
        for k in range(3):                      # the hat function of corner k rises along turned[k]
            b[c[k]][0] += dot(x, turned[k]) / size / twice / 2 if size > 0 else 0
    for i in range(n):
        L[i][n - 1] = L[n - 1][i] = float(i == n - 1)
    b[n - 1][0] = 0.0
    phi = [row[0] for row in solve(L, b)]
    return [[abs(p - phi[source])] for p in phi]


class Geodesic(Case):
    def test_dense(self):
        for mesh in (icosahedron(), bumpy_patch(4)):
            path = self.file("geo.obj", obj_text(*mesh))
            h = json.loads(self.good("info", path, "--json").stdout)["h"]
            for t, tau in ((None, 1), ("1h2", 1), ("5h2", 5), ("%.17g" % (0.3 * h * h), 0.3)):
                for source in (0, 7):
                    args = [] if t is None else ["--t", t]
                    self.close(self.field("geodesic", path, "--source", source, *args), geodesic_dense(mesh, source, tau * h * h), 1e-9)

    def test_columns(self):
        sources = [3, 40, 77, 3, 99, 0, 12, 13, 14, 15, 50]
        got = self.field("geodesic", self.patch, "--source", ",".join(map(str, sources)))
        for k, v in enumerate(sources):
            self.assertEqual(got[v][k], 0)
            self.close(columns(got, k), self.field("geodesic", self.patch, "--source", v), 1e-12)
            self.assertTrue(all(r[k] >= 0 for r in got))

    def test_out_of_reach(self):
        mesh = apart(bumpy_patch(4), with_holes(bumpy_patch(4), 0))
        path = self.file("apart.obj", obj_text(*mesh))
        got = self.field("geodesic", path, "--source", "3,25,40")
        for i, r in enumerate(got):
            self.assertEqual([math.isinf(x) for x in r], [i >= 25, i != 25, i <= 25], i)
        self.assertEqual(got[25][1], 0)
        r = json.loads(self.good("geodesic", path, "--source", "3,25,40", "--json", "-o", self.path("apart.png")).stderr)
        self.assertEqual(r["unreached"], 25 + 49 + 26)
        for name in ("apart.ply", "apart.vtu", "apart.npy", "apart.csv", "apart.obj"):
            self.good("geodesic", path, "--source", "3,40", "-o", self.path("out-" + name))
        with open(self.path("apart.png"), "rb") as f:
            self.assertGreater(read_png(f.read())[2], 50)

    def test_long(self):
        """Farther than any double can tell heat from none."""
        n = 1500
        path = self.file("strip.off", off_text([(x, y, 0.0) for y in (0.0, 1.0) for x in map(float, range(n))],
                                               [t for x in range(n - 1) for t in ((x, x + 1, n + x), (x + 1, n + x + 1, n + x))]))
        p = self.good("geodesic", path, "--source", 0, "--json")
        got = numbers(p.stdout.decode())
        self.assertGreater(json.loads(p.stderr)["stages"], 1)
        self.assertLess(abs(got[n - 1][0] - n), 0.02 * n)
        self.assertTrue(all(0.9 < got[x + 1][0] - got[x][0] < 1.1 for x in range(5, n - 5)))

    def test_report(self):
        r = json.loads(self.good("geodesic", self.patch, "--source", "1,2", "--json").stderr)
        for k in ("n", "faces", "components", "h", "area", "inert", "laplacian", "method", "times", "ordering", "factor_nnz", "factor_flops", "residual", "threads",
                  "peak_bytes", "seconds", "status"):
            self.assertIn(k, r)
        self.assertEqual((r["command"], r["n"], r["sources"], r["stages"], r["unreached"], r["status"]), ("geodesic", 100, [1, 2], 1, 0, "HD_OK"))
        self.assertAlmostEqual(r["times"][0], r["h"] ** 2)
        self.assertLess(r["residual"], 1e-12)
        for k in ("load", "assemble", "order", "analyse", "factor", "solve", "total"):
            self.assertGreaterEqual(r["seconds"][k], 0)
        text = self.good("geodesic", self.patch, "--source", 1, "--ordering", "dissection").stderr.decode()
        self.assertIn("dissection", text)
        self.assertIn("residuals", text)

    def test_usage(self):
        self.assertIn("--source", self.bad(2, "geodesic", self.small))
        for t in ("0", "1,2", "auto:2", "-1", "0h2"):
            self.assertIn("--t takes", self.bad(2, "geodesic", self.small, "--source", 0, "--t", t))
        for option in ("--degree=3", "--method=direct", "--kernel=symmetric", "--input=x"):
            self.assertIn(option.split("=")[0], self.bad(2, "geodesic", self.small, "--source", 0, option))
        self.assertIn("--source 12", self.bad(1, "geodesic", self.small, "--source", "0,12"))
        self.assertIn("limit", self.bad(1, "geodesic", self.patch, "--source", 0, "--memory-limit", "20K"))
        self.assertEqual(self.field("geodesic", self.patch, "--source", 5, "--threads", 1), self.field("geodesic", self.patch, "--source", 5, "--threads", 2))


def sphere(levels):
    """The icosahedron on the unit sphere, its triangles split in four so many times."""
    v, f = icosahedron()
    v = [tuple(x / math.sqrt(dot(p, p)) for x in p) for p in v]
    for _ in range(levels):
        middle, finer = {}, []
        for c in f:
            m = []
            for a, b in ((c[0], c[1]), (c[1], c[2]), (c[2], c[0])):
                key = (min(a, b), max(a, b))
                if key not in middle:
                    p = [v[a][k] + v[b][k] for k in range(3)]
                    middle[key] = len(v)
                    v.append(tuple(x / math.sqrt(dot(p, p)) for x in p))
                m.append(middle[key])
            finer += [(c[0], m[0], m[2]), (c[1], m[1], m[0]), (c[2], m[2], m[1]), tuple(m)]
        f = finer
    return v, f


def quad_grid(nx, ny, size=1.0):
    """Squares in the plane: nx by ny of them."""
    v = [(size * x, size * y, 0.0) for y in range(ny + 1) for x in range(nx + 1)]
    f = [(y * (nx + 1) + x, y * (nx + 1) + x + 1, (y + 1) * (nx + 1) + x + 1, (y + 1) * (nx + 1) + x) for y in range(ny) for x in range(nx)]
    return v, f


class GeodesicEverywhere(Case):
    """Polygons, slivers, borders, regions and matrices. The method itself is checked by tests/test_geodesic_all.h."""

    def test_polygons(self):
        v, f = quad_grid(16, 12)
        path = self.file("quads.obj", obj_text(v, f))
        inner = 6 * 17 + 7
        want = [math.hypot(p[0] - v[inner][0], p[1] - v[inner][1]) for p in v]

        def error(*args):
            got = self.field("geodesic", path, "--source", inner, *args)
            return sum(abs(g[0] - w) for g, w in zip(got, want)) / len(want)

        self.assertLess(error(), 0.3)
        self.assertLess(error("--border", "mean", "--t", "4h2"), 0.5 * error("--t", "4h2"))
        self.assertNotEqual(error(), error("--laplacian", "fem"))
        self.assertNotEqual(error(), error("--lambda", 1))
        self.assertLess(error("--tufted"), 0.3)
        r = json.loads(self.good("geodesic", path, "--source", inner, "--border", "mean", "--json", "-o", self.path("q.png")).stderr)
        self.assertEqual((r["laplacian"], r["border"], r["edge"]), ("polygon", "mean", 1))
        self.assertIn("three factors", self.good("geodesic", path, "--source", inner, "--border", "mean", "-o", self.path("q.txt")).stderr.decode())
        self.assertIn("mean", self.bad(2, "geodesic", path, "--source", 0, "--border", "neumann"))
        self.assertIn("squared length", self.bad(2, "geodesic", path, "--source", 0, "--laplacian", "cot"))

    def test_slivers(self):
        """A grid sheared far: flipped along the surface it is as good as any."""
        v, f = quad_grid(20, 20)
        v = [(p[0] + 4 * p[1], p[1], 0.0) for p in v]
        path = self.file("slivers.obj", obj_text(v, [(a, b, c) for a, b, c, _ in f] + [(a, c, d) for a, _, c, d in f]))
        want = [math.hypot(p[0] - v[220][0], p[1] - v[220][1]) for p in v]
        plain, flipped = (sum(abs(g[0] - w) for g, w in zip(self.field("geodesic", path, "--source", 220, *args), want)) / len(v)
                          for args in ((), ("--intrinsic-delaunay",)))
        self.assertLess(flipped, 1)
        self.assertGreater(plain, 4 * flipped)

    def test_nearest(self):
        """Regions are what the columns say, with any distance."""
        v, f = quad_grid(9, 5)
        path = self.file("quads.obj", obj_text(v, f))
        for args in (("geodesic", path, "--source", "0,9,59,31"), ("distance", path, "--source", "3,50,7", "--t", "1h2,20h2"),
                     ("distance", path, "--source", "3,50", "--definition", "biharmonic")):
            all_columns, got = self.field(*args), self.field(*args, "--nearest")
            times = len(got[0]) // 2
            sources = len(all_columns[0]) // times
            for a, g in zip(all_columns, got):
                for k in range(times):
                    d = [a[q * times + k] for q in range(sources)]
                    self.assertEqual(g[2 * k:2 * k + 2], [float(d.index(min(d))), min(d)])
        self.good("geodesic", path, "--source", "0,9", "--nearest", "-o", self.path("n.csv"))
        with open(self.path("n.csv")) as file:
            self.assertEqual(file.readline(), "nearest_1h2,d_1h2\n")
        self.good("geodesic", path, "--source", "0,9", "--nearest", "--column", 1, "-o", self.path("n.png"))
        self.assertIn("--column 2", self.bad(1, "geodesic", path, "--source", "0,9,5", "--nearest", "--column", 2))
        mesh = self.file("apart.obj", obj_text(*apart(bumpy_patch(4), bumpy_patch(3))))
        got = self.field("geodesic", mesh, "--source", "2", "--nearest")
        self.assertEqual([g[0] for g in got], [0.0] * 25 + [-1.0] * 16)

    def test_matrix(self):
        """Symmetric to the bit, zero on the diagonal, and the means of both directions."""
        sources = [3, 40, 77, 99, 3]
        for args in (("geodesic", self.patch), ("distance", self.patch, "--t", "2h2,30h2"), ("distance", self.patch, "--definition", "commute")):
            args = args + ("--source", ",".join(map(str, sources)))
            all_columns, got = self.field(*args), self.field(*args, "--matrix")
            times = len(got[0]) // len(sources)
            self.assertEqual((len(got), len(got[0])), (5, 5 * times))
            for k in range(times):
                for i, v in enumerate(sources):
                    for j, w in enumerate(sources):
                        self.assertEqual(got[i][j * times + k], got[j][i * times + k])
                        a, b = all_columns[v][j * times + k], all_columns[w][i * times + k]
                        self.assertAlmostEqual(got[i][j * times + k], 0 if i == j else (a + b) / 2, delta=1e-14 * max(a, b, 1))
        r = json.loads(self.good("geodesic", self.patch, "--source", "3,40", "--matrix", "--json", "-o", self.path("m.csv")).stderr)
        one = self.field("geodesic", self.patch, "--source", "3,40")
        self.assertAlmostEqual(r["asymmetry"], abs(one[3][1] - one[40][0]))
        self.assertEqual(r["unreached"], 0)
        self.assertIn(".csv", self.bad(2, "geodesic", self.patch, "--source", "3,40", "--matrix", "-o", self.path("m.png")))
        self.assertIn("--nearest", self.bad(2, "geodesic", self.patch, "--source", "3,40", "--matrix", "--nearest"))
        self.assertIn("--matrix", self.bad(2, "kernel", self.patch, "--source", "3,40", "--t", 1, "--matrix"))


class Levels(Case):
    """Level sets of fields, against lines that are known."""

    def lines(self, *args):
        """Lists of points, by line, with closed and level."""
        out = []
        for row in numbers(self.good("levels", *args).stdout.decode()):
            if int(row[0]) == len(out):
                out.append((row[1] == 1, row[2], []))
            out[int(row[0])][2].append(tuple(row[3:]))
        return out

    def length(self, line):
        points = line[2] + line[2][:1] if line[0] else line[2]
        return sum(math.dist(p, q) for p, q in zip(points, points[1:]))

    def field_file(self, name, values):
        return self.file(name, "".join("%.17g\n" % x for x in values))

    def test_grid(self):
        """x on a grid has straight lines, through vertices too, of quadrangles and of triangles."""
        v, f = quad_grid(7, 4, 0.5)
        field = self.field_file("x.txt", [p[0] for p in v])
        for faces in (f, [(a, b, c) for a, b, c, _ in f] + [(a, c, d) for a, _, c, d in f]):
            path = self.file("grid.obj", obj_text(v, faces))
            got = self.lines("--input", field, "--levels", "0.2,1.5,3.3", path)
            self.assertEqual([(c, x) for c, x, _ in got], [(False, 0.2), (False, 1.5), (False, 3.3)])
            for line in got:
                self.assertTrue(all(abs(p[0] - line[1]) < 1e-15 and p[2] == 0 for p in line[2]))
                self.assertEqual(sorted(p[1] for p in line[2]), sorted(set(p[1] for p in line[2])))
                self.assertAlmostEqual(self.length(line), 2, delta=1e-14)
            self.assertEqual(self.lines("--input", field, "--levels", "-1,9", path), [])
            self.assertEqual([x for _, x, _ in self.lines("--input", field, "--levels", "auto:6", path)], [0.5, 1, 1.5, 2, 2.5, 3])

    def test_far_apart(self):
        """Points of a line lie between the ends of its edges, also where the difference of these overflows."""
        path = self.file("far.obj", "v -1.7e308 0 0\nv 1.7e308 0 0\nv 0 1 0\nf 1 2 3\n")
        line, = self.lines("--input", self.field_file("far.txt", [0, 1, 1]), "--levels", "0.25", path)
        for got, want in zip(sorted(p[0] for p in line[2]), (-1.275, -0.85)):
            self.assertAlmostEqual(got / 1e308, want, delta=1e-14)

    def test_sphere(self):
        """Circles of latitude of a fine sphere, closed: 2 pi sqrt(1 - z^2) up to the error of a polygon."""
        v, f = sphere(3)
        path = self.file("sphere.obj", obj_text(v, f))
        field = self.field_file("z.txt", [p[2] for p in v])
        got = self.lines("--input", field, "--levels", "-0.6,0.01,0.8", path)
        self.assertEqual([c for c, _, _ in got], [True] * 3)
        for line in got:
            self.assertTrue(all(abs(p[2] - line[1]) < 1e-14 for p in line[2]))
            self.assertAlmostEqual(self.length(line) / (2 * math.pi * math.sqrt(1 - line[1] ** 2)), 1, delta=0.01)
        r = json.loads(self.good("levels", "--input", field, "--levels", "-0.6,0.8,2", path, "--json", "-o", self.path("l.obj")).stderr)
        self.assertEqual((r["lines"], r["closed"], r["levels"], r["lengths"][2]), (2, 2, [-0.6, 0.8, 2], 0))
        self.assertAlmostEqual(r["lengths"][1], self.length(got[2]), delta=1e-12)
        with open(self.path("l.obj")) as file:
            rows = [row.split() for row in file]
        self.assertEqual(sum(row[0] == "v" for row in rows), r["points"])
        loops = [row[1:] for row in rows if row[0] == "l"]
        self.assertEqual([float(row[1][6:]) for row in rows if row[0] == "g"], [-0.6, 0.8])
        self.assertTrue(len(loops) == 2 and all(row[0] == row[-1] and len(set(row)) == len(row) - 1 for row in loops))

    def test_saddle(self):
        """A quadrangle with two corners above and two below, crosswise: the mean of the corners tells which hang together."""
        path = self.file("one.obj", obj_text([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)], [(0, 1, 2, 3)]))
        for high, corners in ((3.0, {(1.0, 0.0), (0.0, 1.0)}), (0.5, {(0.0, 0.0), (1.0, 1.0)})):
            got = self.lines("--input", self.field_file("s.txt", [high, -1.0, high, -1.0]), "--levels", "0", path)
            self.assertEqual(len(got), 2)
            near = {min([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)], key=lambda c: sum(math.dist(c, p[:2]) for p in line[2])) for line in got}
            self.assertEqual(near, corners)

    def test_at_vertices(self):
        """What touches the level only in a vertex or an edge has no line; a level that is asked for twice has its lines once."""
        level = self.field_file("top.txt", [1.0] + [0.0] * 11)
        self.assertEqual(self.lines("--input", level, "--levels", "1", self.small), [])
        ridge = self.field_file("ridge.txt", [1.0, 1.0] + [0.0] * 10)
        self.assertEqual(self.lines("--input", ridge, "--levels", "1", self.small), [])
        once = self.good("levels", "--input", level, "--levels", "0.5", self.small, "--json")
        twice = self.good("levels", "--input", level, "--levels", "0.5,1,0.5", self.small, "--json")
        self.assertEqual(once.stdout, twice.stdout)
        a, b = json.loads(once.stderr), json.loads(twice.stderr)
        self.assertEqual((b["lines"], b["lengths"]), (1, [a["lengths"][0], 0, a["lengths"][0]]))
        self.assertAlmostEqual(a["lengths"][0], 5, 12)           # a pentagon around a vertex of edges of length 2
        # upright; by faces with a corner twice, which have no lines of their own
        wall = self.file("wall.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\nf 1 1 2\nf 3 3 4\nf 1 1 3\n")
        got = self.lines("--input", self.field_file("wall.txt", [0, 1, 1, 0]), "--levels", "0.5", wall)
        self.assertEqual([(c, sorted(p)) for c, _, p in got], [(False, [(0.5, 0, 0), (0.5, 0, 1)])])

    def test_rounding(self):
        """Points lie between the ends of their edges, where rounding would lead outside and where values are far apart."""
        x, y = 1 + 2.0 ** -52, -0.75 * 2.0 ** -52
        path = self.file("close.obj", obj_text([(x, -x, 0.0), (y, -y, 0.0), (y, -y, 1.0)], [(0, 1, 2)]))
        (_, _, points), = self.lines("--input", self.field_file("f.txt", [0, 1, 1]), "--levels", "0.99999999999999989", path)
        self.assertTrue(all(y <= p[0] <= x and -x <= p[1] <= -y for p in points), points)
        path = self.file("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        (_, _, points), = self.lines("--input", self.field_file("f.txt", [-1.7e308, 1.7e308, 1.7e308]), "--levels", "0", path)
        self.assertEqual(sorted(points), [(0, 0.5, 0), (0.5, 0, 0)])

    def test_out_of_reach(self):
        """Distances that are infinite have no lines, as text and as .npy, and pictures; heat needs finite fields."""
        v, f = icosahedron()
        two = self.file("two.obj", obj_text(*apart((v, f), (v, f))))
        distance = [row[0] for row in self.field("geodesic", "--source", 0, self.small)]
        want = self.lines("--input", self.field_file("d.txt", distance), "--levels", "1,2", self.small)
        self.assertEqual(len(want), 2)
        for name in ("d.txt", "d.npy"):
            self.good("geodesic", "--source", 0, two, "--quiet", "-o", self.path(name))
            got = self.lines("--input", self.path(name), "--levels", "1,2", two)
            self.assertEqual([c for c, _, _ in got], [c for c, _, _ in want])
            for a, b in zip(got, want):
                for p, q in zip(a[2], b[2]):
                    self.assertLess(math.dist(p, q), 1e-9)
            self.assertRegex(self.bad(1, "diffuse", "--input", self.path(name), "--t", 1, two), r"inf.* not a finite number")
        p = self.good("levels", "--input", self.path("d.npy"), "--levels", "auto:1", two, "--json")
        self.assertAlmostEqual(json.loads(p.stderr)["levels"][0], max(distance) / 2, 9)
        pictures = []
        for last in ("inf", "-inf", "nan"):
            field = self.file("p.txt", "-1e-9\n" + "1\n" * 10 + last + "\n")
            self.good("render", "--input", field, self.small, "--size", "64x64", "--quiet", "-o", self.path("p.png"))
            with open(self.path("p.png"), "rb") as file:
                pictures.append(file.read())
        self.assertEqual(pictures[0], pictures[2])               # the range of colours is that of the finite values
        self.assertEqual(self.bad(1, "render", "--input", self.file("p.txt", "1\n" * 11 + "info\n"), self.small, "-o", self.path("p.png")).count("p.txt:12"), 1)

    def test_of_distances(self):
        """Any result of the tool is a field: circles around a vertex."""
        v, f = quad_grid(20, 20)
        path = self.file("grid.obj", obj_text(v, f))
        self.good("geodesic", path, "--source", "220,0", "--border", "mean", "--t", "4h2", "-o", self.path("d.npy"))
        got = self.lines("--input", self.path("d.npy"), "--levels", "6", path)
        self.assertEqual([c for c, _, _ in got], [True])
        self.assertAlmostEqual(self.length(got[0]) / (12 * math.pi), 1, delta=0.05)
        self.assertEqual([c for c, _, _ in self.lines("--input", self.path("d.npy"), "--column", 1, "--levels", "6", path)], [False])

    def test_refused(self):
        v, f = quad_grid(2, 2)
        path = self.file("grid.obj", obj_text(v, f))
        field = self.field_file("x.txt", [p[0] for p in v])
        self.assertIn("--levels", self.bad(2, "levels", "--input", field, path))
        self.assertIn("--input", self.bad(2, "levels", "--levels", 1, path))
        for levels in ("", "1,", "x", "auto:0", "auto:2,1", "inf", "nan", "1;2"):
            self.assertIn("--levels takes", self.bad(2, "levels", "--input", field, "--levels", levels, path))
        self.assertIn(".obj", self.bad(2, "levels", "--input", field, "--levels", 1, path, "-o", self.path("l.png")))
        self.assertIn("--column 1", self.bad(1, "levels", "--input", field, "--levels", 1, "--column", 1, path))
        self.assertIn("one value", self.bad(1, "levels", "--input", self.field_file("c.txt", [1.0] * 9), "--levels", "auto:2", path))
        self.bad(1, "levels", "--input", self.field_file("s.txt", [1.0] * 8), "--levels", 1, path)
        self.assertIn("faces", self.bad(1, "levels", "--input", field, "--levels", 1, self.file("p.xyz", "".join("%g %g %g\n" % p for p in v))))


class Spectrum(Case):
    """Eigenpairs: files, report and usage. Numbers are checked by tests/test_spectrum.h."""

    def test_text(self):
        lines = self.good("spectrum", self.patch, "-k", 5).stdout.decode().splitlines()
        values = [float(v) for v in lines[0].lstrip("# ").split()]
        rows = [[float(v) for v in line.split()] for line in lines[1:]]
        self.assertTrue(lines[0].startswith("# ") and len(values) == 5 and values[0] == 0 and values == sorted(values))
        self.assertTrue(len(rows) == 100 and all(len(r) == 5 and r[0] == rows[0][0] > 0 for r in rows))

    def test_files(self):
        for name in ("s.csv", "s.npy", "s.ply", "s.vtu", "s.png"):
            r = json.loads(self.good("spectrum", self.patch, "-k", 4, "--json", "-o", self.path(name)).stderr)
            self.assertEqual((r["command"], r["count"], len(r["eigenvalues"]), r["proven"], r["status"]), ("spectrum", 4, 4, 1, "HD_OK"))
            self.assertGreaterEqual(r["next"], r["eigenvalues"][3] * (1 - 1e-9))
            self.assertLess(r["residual"], 1e-9)
        with open(self.path("s.csv")) as f:
            self.assertEqual(f.readline().strip(), "x_0,x_1,x_2,x_3")

    def test_below(self):
        r = json.loads(self.good("spectrum", self.patch, "-k", 12, "--json").stderr)
        half = (r["eigenvalues"][6] + r["eigenvalues"][7]) / 2
        below = json.loads(self.good("spectrum", self.patch, "--below", half, "--json").stderr)
        self.assertEqual(below["count"], 7)
        self.assertIn("proven", self.good("spectrum", self.patch, "--below", half, "-k", 3).stderr.decode())

    def test_usage(self):
        self.assertIn("-k", self.bad(2, "spectrum", self.patch))
        self.assertIn("--below takes", self.bad(2, "spectrum", self.patch, "--below", "-1"))
        self.assertIn("--t", self.bad(2, "spectrum", self.patch, "-k", 3, "--t", 1))
        self.assertIn("beyond", self.bad(1, "spectrum", self.patch, "-k", 101))
        self.assertIn("--column 9", self.bad(1, "spectrum", self.patch, "-k", 3, "--column", 9, "-o", self.path("s.png")))


class Demo(Case):
    once = None

    @classmethod
    def run_once(cls):
        """The demo's folder and what it printed. Drawing its pictures takes a while, so all tests look at the same."""
        if Demo.once is None:
            folder = tempfile.mkdtemp(prefix="heatdiff-test-demo-")
            atexit.register(shutil.rmtree, folder)
            out = os.path.join(folder, "demo")
            Demo.once = out, subprocess.run([TOOL, "demo", "--json", "-o", out], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        return Demo.once

    def test_demo(self):
        out, p = self.run_once()
        self.assertEqual(p.returncode, 0, p.stderr)
        names = sorted(os.listdir(out))
        for word in ("heat-trunk.png", "heat-trunk.ply", "isolines.png", "distance.png", "signature.png"):
            self.assertIn(word, names)
        for n in names:
            with open(os.path.join(out, n), "rb") as f:
                data = f.read()
            if n.endswith(".png"):
                self.assertGreater(read_png(data)[2], 50, n)
            elif n.endswith(".ply"):
                vertices, faces = read_ply(data)
                self.assertTrue(len(vertices) > 100 and len(faces) > 100)
                self.good("info", os.path.join(out, n))
            else:
                self.fail("what is %s?" % n)
            self.assertIn(n, p.stdout.decode())

    def test_default_folder_is_there_already(self):
        here = self.path("here")
        os.makedirs(os.path.join(here, "heatdiff-demo"))
        self.good("demo", "--quiet", cwd=here)
        self.assertEqual(os.listdir(here), ["heatdiff-demo"])
        self.assertEqual(sorted(os.listdir(os.path.join(here, "heatdiff-demo"))), sorted(os.listdir(self.run_once()[0])))

    def test_json(self):
        r = json.loads(self.run_once()[1].stderr)
        self.assertEqual((len(r["sources"]), len(r["times"])), (2, 4))
        self.assertLess(r["mass_drift"], 1e-9)

    def test_folder_that_cannot_be(self):
        """Told before anything is computed."""
        folders = [self.small, self.path("no/such/folder"), self.path("x" * 300), self.path("." + "/." * 1100)]
        if POSIX:
            folders.append(self.path("dangling"))
            os.symlink(self.path("nowhere"), folders[-1])
        for folder in folders:
            self.assertIn("cannot make this folder", self.bad(1, "demo", "-o", folder))
        empty = self.path("empty")                               # and a run that ends early writes nothing there
        self.assertIn("memory limit", self.bad(1, "demo", "-o", empty, "--memory-limit", 1000))
        self.assertEqual(os.listdir(empty), [])


class Points(Case):
    """Files without faces."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        n = 300
        cls.v = [(math.sqrt(1 - z * z) * math.cos(2.4 * i), math.sqrt(1 - z * z) * math.sin(2.4 * i), z)
                 for i, z in ((i, (2 * i + 1) / n - 1) for i in range(n))]
        cls.xyz = cls.file("cloud.xyz", "".join("%.17g %.17g %.17g 7 8 9\n" % p for p in cls.v))

    def report(self, *args):
        return json.loads(self.good("info", *args, "--json").stdout)

    def test_formats_agree(self):
        rows = "".join("%.17g %.17g %.17g\n" % p for p in self.v)
        ply = "ply\nformat ascii 1.0\nelement vertex 300\nproperty double x\nproperty double y\nproperty double z\nend_header\n" + rows
        want = self.field("kernel", self.xyz, "--source", 5, "--t", "0.1,20h2")
        for path in (self.file("c.ply", ply), self.file("c.obj", "".join("v " + r + "\n" for r in rows.splitlines())),
                     self.file("c.off", "OFF\n300 0 0\n" + rows)):
            self.assertEqual(self.field("kernel", path, "--source", 5, "--t", "0.1,20h2"), want)
        self.assertTrue(all(x > 0 for x in columns(want, 0)[5]))

    def test_info(self):
        r = self.report(self.xyz)
        self.assertEqual((r["n"], r["faces"], r["components"], r["inert"], r["laplacian"]), (300, 0, 1, 0, "voronoi-exp"))
        self.assertEqual((r["coincident"], r["isolated"], r["without_area"], r["neighbours"], r["weight_cut"]), (0, 0, 0, 30, 1e-8))
        self.assertAlmostEqual(r["area"] / (4 * math.pi), 1, delta=0.05)
        h = sum(min(math.dist(p, q) for q in self.v if q is not p) for p in self.v) / 300
        self.assertAlmostEqual(r["h"] / h, 1, delta=1e-13)
        self.assertAlmostEqual(r["cut_radius"], math.sqrt(4 * r["bandwidth"] * math.log(1e8)), delta=1e-12)
        text = self.good("info", self.xyz).stdout.decode()
        for word in ("points", "bandwidth", "area of the cells", "from the sampling"):
            self.assertIn(word, text)

    def test_bandwidth(self):
        h = self.report(self.xyz)["h"]
        r = self.report(self.xyz, "--bandwidth", "0.4h2", "--laplacian", "exp")
        self.assertAlmostEqual(r["bandwidth"] / (0.4 * h * h), 1, delta=1e-13)
        self.assertEqual(self.report(self.xyz, "--bandwidth", "0.004")["bandwidth"], 0.004)
        twice = self.file("twice.xyz", "".join("%.17g %.17g %.17g\n" % p for p in self.v + self.v[:20]))
        r = self.report(twice, "--bandwidth", "2h2")
        self.assertAlmostEqual(r["bandwidth"] / (2 * h * h), 1, delta=1e-13)
        self.assertEqual((r["coincident"], r["n"]), (20, 320))
        for text in ("0", "-1", "abc", "auto:3", "1,2", "", "1h", "nan"):
            self.assertIn("--bandwidth takes", self.bad(2, "info", self.xyz, "--bandwidth=" + text))
        self.assertIn("bandwidth", self.bad(1, "info", self.small, "--bandwidth", "1"))

    def test_weight_cut(self):
        r = self.report(self.xyz, "--weight-cut", "1e-4")
        self.assertEqual(r["weight_cut"], 1e-4)
        self.assertAlmostEqual(r["cut_radius"], math.sqrt(4 * r["bandwidth"] * math.log(1e4)), delta=1e-12)
        self.assertLess(r["most_in_row"], self.report(self.xyz)["most_in_row"])
        for text in ("0", "1", "-1e-4", "2", "x", ""):
            self.assertIn("--weight-cut takes", self.bad(2, "info", self.xyz, "--weight-cut=" + text))
        self.assertIn("--weight-cut", self.bad(1, "info", self.small, "--weight-cut", "1e-4"))
        self.assertIn("--weight-cut", self.bad(2, "info", self.xyz, "--tufted", "--weight-cut", "1e-4"))

    def test_laplacians(self):
        for kind in ("fem", "cot", "voronoi-cot"):
            self.assertIn(kind, self.bad(1, "kernel", self.xyz, "--source", 0, "--t", 1, "--laplacian", kind))
        u = self.field("kernel", self.xyz, "--source", "0,9", "--t", 1, "--laplacian", "exp")
        for c in range(2):                      # B = I: columns sum to one, and K_t is symmetric
            self.assertAlmostEqual(sum(r[c] for r in u), 1, delta=1e-9)
        self.assertAlmostEqual(u[9][0], u[0][1], delta=1e-9)
        r = self.report(self.patch, "--laplacian", "voronoi-exp")       # a mesh's vertices as points
        self.assertEqual((r["n"], r["laplacian"], r["triangles_used"]), (100, "voronoi-exp", 0))
        text = self.good("kernel", self.xyz, "--source", 0, "--t", "auto:2", "-o", self.path("x.txt")).stderr.decode()
        self.assertIn("bandwidth", text)
        self.good("kernel", self.xyz, "--source", 0, "--t", "auto:2", "--laplacian", "exp", "-o", self.path("x.txt"))

    def test_outputs(self):
        for name in ("p.ply", "p.vtu", "p.obj", "p.npy", "p.csv", "p.png"):
            self.good("kernel", self.xyz, "--source", 3, "--t", 0.1, "-o", self.path(name), "--quiet")
            self.assertGreater(os.path.getsize(self.path(name)), 300)
        again = self.report(self.path("p.ply"))
        self.assertEqual((again["n"], again["faces"]), (300, 0))
        data = self.file("f.txt", "".join("%g\n" % p[2] for p in self.v))
        self.good("render", self.xyz, "--input", data, "-o", self.path("r.png"))
        out = self.field("diffuse", self.xyz, "--input", data, "--t", "0.1")
        ratio = [a[0] / p[2] for a, p in zip(out, self.v) if abs(p[2]) > 0.3]
        self.assertTrue(all(abs(q / math.exp(-0.2) - 1) < 0.05 for q in ratio), (min(ratio), max(ratio)))     # z has eigenvalue 2

    def test_tufted(self):
        """Triangles made of the points' neighbours; those in the place of an earlier one are left out."""
        twice = self.file("twice.xyz", "".join("%.17g %.17g %.17g\n" % p for p in self.v + self.v[:3]))
        data = self.file("g.txt", "".join("%g\n" % p[2] for p in self.v))
        for kind in ((), ("--laplacian", "voronoi-cot"), ("--laplacian", "cot")):
            r = self.report(twice, "--tufted", *kind)
            self.assertEqual((r["laplacian"], r["intrinsic"], r["coincident"], r["inert"], r["sheets"], r["negative_weights"]),
                             (kind[-1] if kind else "fem", "tufted", 3, 3, 2, 0))
            self.assertAlmostEqual(r["area"] / (4 * math.pi), 1, delta=0.05)
            self.assertNotIn("bandwidth", r)
        for kind in ("fem", "voronoi-cot"):
            out = self.field("diffuse", self.xyz, "--tufted", "--laplacian", kind, "--input", data, "--t", "0.1")
            ratio = [a[0] / p[2] for a, p in zip(out, self.v) if abs(p[2]) > 0.3]
            self.assertTrue(all(abs(q / math.exp(-0.2) - 1) < 0.05 for q in ratio), (kind, min(ratio), max(ratio)))
        self.assertRegex(self.good("info", self.xyz, "--tufted").stdout.decode(), "edges flipped")
        self.assertIn("--tufted", self.bad(1, "info", self.xyz, "--intrinsic-delaunay"))
        for more in (("--laplacian", "exp"), ("--laplacian", "voronoi-exp"), ("--laplacian", "polygon"), ("--bandwidth", 1), ("--lambda", 1)):
            self.assertIn("--tufted", self.bad(2, "info", self.xyz, "--tufted", *more))
        self.assertIn("--lambda", self.bad(1, "info", self.xyz, "--lambda", 1))
        got = self.field("geodesic", self.xyz, "--source", 0)
        want = [math.acos(max(-1.0, min(1.0, dot(self.v[0], p)))) for p in self.v]
        self.assertLess(sum(abs(g[0] - w) for g, w in zip(got, want)) / len(want), 0.06)
        self.assertIn("faces", self.bad(1, "geodesic", self.xyz, "--source", 0, "--border", "mean"))
        self.assertIn("no gradient", self.bad(2, "geodesic", self.xyz, "--source", 0, "--laplacian", "voronoi-exp"))
        r = json.loads(self.good("geodesic", self.xyz, "--source", 0, "--t", "4h2", "--json", "-o", self.path("g.txt")).stderr)
        self.assertAlmostEqual(r["times"][0] / (4 * r["edge"] ** 2), 1)

    def test_not_flat(self):
        """Two sheets one spacing apart are told of, a sphere is not."""
        lines = ("%d %d %d\n" % (i % 12, i // 12 % 12, i // 144) for i in range(288))
        sheets = self.file("sheets.xyz", "".join(lines))
        for more in ((), ("--tufted",)):
            self.assertGreater(self.report(sheets, *more)["not_flat"], 250)
            self.assertRegex(self.good("info", sheets, *more).stdout.decode(), "places not flat")
            self.assertEqual(self.report(self.xyz, *more)["not_flat"], 0)
            self.assertNotIn("not flat", self.good("info", self.xyz, *more).stdout.decode())

    def test_every_question(self):
        """Signature, distances, pairs and samples agree with the kernel on every kind of point Laplacian, and on polygons."""
        square = [(float(i % 5), i // 5 + 0.1 * (i % 2), 0.0) for i in range(25)]
        quads = self.file("quads.obj", obj_text(square, [(i, i + 1, i + 6, i + 5) for i in range(19) if i % 5 < 4]))
        xyz = self.file("few.xyz", "".join("%.17g %.17g %.17g\n" % p for p in self.v[::6]))
        for path, args in ((quads, ()), (quads, ("--tufted",)), (xyz, ()), (xyz, ("--laplacian", "exp")), (xyz, ("--tufted", "--laplacian", "voronoi-cot"))):
            n, t, twice = (25, "0.4", "0.8") if path == quads else (50, "2", "4") if "exp" in args else (50, "0.1", "0.2")
            every = ",".join(map(str, range(n)))
            k = self.field("kernel", path, *args, "--kernel", "symmetric", "--source", every, "--t", twice)
            want = [math.sqrt(k[0][0] - 2 * k[i][0] + k[i][i]) if i else 0 for i in range(n)]
            self.close(self.field("hks", path, *args, "--t", twice), [[k[i][i]] for i in range(n)], 1e-6)
            self.close(self.field("distance", path, *args, "--source", 0, "--t", t), [[x] for x in want], 1e-6)
            pairs = self.file("p.txt", "".join("0 %d\n" % i for i in range(n)))
            self.close(columns(self.field("pairs", path, *args, "--input", pairs, "--t", t), 3), [[x] for x in want], 1e-6)
            found = self.field("sample", path, *args, "--source", 0, "--count", 2, "--t", t)
            self.assertAlmostEqual(found[1][1] / max(want), 1, delta=1e-6)
            self.assertAlmostEqual(want[int(found[1][0])] / max(want), 1, delta=1e-6)
            for kind in ("commute", "biharmonic", "weighted"):
                d = self.field("distance", path, *args, "--source", 0, "--definition", kind, *(("--t", t) if kind == "weighted" else ()))
                self.assertTrue(d[0] == [0] and all(x[0] > 0 for x in d[1:]) if kind != "weighted" else d[0] == [0])

    def test_nothing_to_compute_on(self):
        line = self.file("line.xyz", "0 0 0\n1 0 0\n2 0 0\n")
        self.assertEqual(self.report(line)["inert"], 3)
        self.bad(1, "kernel", line, "--source", 0, "--t", 1)
        self.bad(1, "kernel", self.file("one.xyz", "0 0 0\n0 0 0\n"), "--source", 0, "--t", 1)


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
