#!/usr/bin/env python3
"""Tests of examples/web and examples/npm: test_web.py [--keep FOLDER] [--large] [unittest options].

Module: the page's WASM module in node against the same C code built natively. Package: the npm package is packed,
installed elsewhere and used in node, against native code as well. Page: the page in headless Chromium: picks shapes,
clicks, moves the slider, drops files. Three: the page with three.js in Chromium, and the package's types by TypeScript;
both come from the npm registry.

Needs nothing but Python 3. Parts whose programs are missing (clang with wasi-libc, node, npm, chromium, a native
compiler, the npm registry) are skipped. --keep FOLDER leaves the page and the screenshots there; --large measures a mesh
of 36K vertices.
"""
import base64
import ctypes
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

sys.dont_write_bytecode = True
TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
WEB = os.path.join(TOP, "examples", "web")
NPM = os.path.join(TOP, "examples", "npm")
sys.path.insert(0, WEB)
import build  # noqa: E402

FOLDER, LARGE, BUILT = None, False, {}
DIRECT, KRYLOV = 2, 3
PAGE_LIMIT, MODULE_LIMIT, COLUMN_LIMIT, PACKAGE_LIMIT = 1500000, 336000, 146000, 330000


def program(*names):
    return next((shutil.which(n) for n in names if shutil.which(n)), None)


CHROMIUM = program("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def compiles():
    """Whether there is a compiler for the module, with its C library."""
    if "compiles" not in BUILT:
        clang = os.environ.get("CLANG", "clang")
        probe = os.path.join(FOLDER, "probe.c")
        with open(probe, "w") as f:
            f.write("#include <math.h>\n#include <stdlib.h>\ndouble f(double x) { return sin(x); }\n")
        command = [clang] + build.LINK + ["-Wl,--export=f", probe, "-o", probe + ".wasm"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        BUILT["compiles"] = shutil.which(clang) and subprocess.run(command, **quiet).returncode == 0
    return BUILT["compiles"]


def built():
    """The page, made once; None where the compiler cannot make it."""
    if "page" not in BUILT:
        BUILT["wasm"] = build.module(FOLDER) if compiles() else None
        BUILT["page"] = build.page(FOLDER, BUILT["wasm"]) if compiles() else None
    return BUILT["page"]


def absent(what):
    """Ends a test for want of a program; where nothing may be skipped it fails."""
    raise (AssertionError if os.environ.get("HEATDIFF_NO_SKIP") else unittest.SkipTest)(what)


def needs(*what, page=True):
    if not (built() if page else compiles()):
        absent("no clang for wasm32-wasi")
    for name, there in what:
        if not there:
            absent("no " + name)


# ---- meshes ----

def ring(n, m):
    """A torus of n by m vertices with waves, as OBJ text."""
    lines = []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
            r = 3 + (1 + 0.2 * math.sin(3 * a)) * math.cos(b)
            z = (1 + 0.2 * math.cos(5 * a)) * math.sin(b)
            lines.append("v %.12g %.12g %.12g" % (r * math.cos(a), r * math.sin(a), z))
    for i in range(n):
        for j in range(m):
            p, q = i * m + j + 1, (i + 1) % n * m + j + 1
            r, s = i * m + (j + 1) % m + 1, (i + 1) % n * m + (j + 1) % m + 1
            lines += ["f %d %d %d" % (p, q, s), "f %d %d %d" % (p, s, r)]
    return "\n".join(lines) + "\n"


# ---- the same questions to the module and to native code ----

# A step calls page_... of its first word. A list stands for its length and its numbers, a text for a place with its bytes.

def file_step(name, content):
    return ["file", content, len(content), name]


PER_VERTEX = {"columns": 1, "signature": 1, "smooth": 3, "geodesic": 1}     # numbers of an answer, for each time

STEPS = [["shape", 0, 3000], ["shape", 1, 2500], ["shape", 2, 2000], ["shape", 3, 2000], ["shape", 4, 2000],
         file_step("ring.obj", ring(40, 20))]
QUERIES = [["columns", DIRECT, [30.0], 7], ["columns", DIRECT, [30.0], 500],
           ["columns", KRYLOV, [2.0, 4.0, 8.0, 16.0], 33],
           ["signature", [20.0, 40.0, 80.0]], ["smooth", [1.0, 3.0]], ["geodesic", 11]]

NODE = r"""
const fs = require("fs"), vm = require("vm");
// The page's own worker, with its module put in by hand: what is tested is what runs.
const worker = { performance, TextDecoder, TextEncoder, WebAssembly, postMessage() {},
  module: new WebAssembly.Module(fs.readFileSync(process.argv[2])) };
const start = "\nonmessage({ data: { op: 'start', module } }); this.exported = wasm;";
vm.runInNewContext(fs.readFileSync(process.argv[5], "utf8") + start, worker);
const wasm = worker.exported, steps = JSON.parse(fs.readFileSync(process.argv[3])), out = process.argv[4];
const bytes = () => new Uint8Array(wasm.memory.buffer);
const put = (b) => { const p = wasm.page_alloc(b.length + 1); bytes().set(b, p); bytes()[p + b.length] = 0; return p; };
const text = () => { const p = wasm.page_text(), u = bytes(); return Buffer.from(u.slice(p, u.indexOf(0, p))).toString(); };
// Milliseconds of this thread alone where the system tells them: other programs are running too.
const clock = () => {
  try {
    return Number(fs.readFileSync(`/proc/self/task/${process.pid}/schedstat`, "utf8").split(" ")[0]) / 1e6;
  } catch (e) {
    return performance.now();
  }
};
const perVertex = JSON.parse(process.argv[6]), rows = [];
for (const [op, ...given] of steps) {
  const n = wasm.page_n(), begin = clock(), args = [];
  let times = 1, p = 0;
  for (const x of given) {
    if (Array.isArray(x)) args.push(times = x.length, p = put(new Uint8Array(Float64Array.from(x).buffer)));
    else args.push(typeof x === "string" ? put(Buffer.from(x)) : x);
  }
  const status = wasm["page_" + op](...args), facts = op === "begin", count = facts ? 10 : (perVertex[op] || 0) * n * times;
  const ms = clock() - begin, from = facts ? wasm.page_facts() : wasm.page_out();
  if (p) wasm.page_free(p);
  const values = status < 0 ? [] : new Float64Array(wasm.memory.buffer, from, count);
  fs.writeFileSync(`${out}.${rows.length}`, Buffer.from(Float64Array.from(values).buffer));
  rows.push({ status, ms, n: wasm.page_n(), text: status < 0 ? text() : "", bytes: wasm.memory.buffer.byteLength });
}
console.log(JSON.stringify(rows));
"""


def in_node(steps):
    """What the module answers: for each step its facts and its doubles."""
    script, ask, out = (os.path.join(FOLDER, n) for n in ("node.js", "steps.json", "answer"))
    with open(script, "w") as f:
        f.write(NODE)
    with open(ask, "w") as f:
        json.dump(steps, f)
    command = [program("node", "nodejs"), script, BUILT["wasm"], ask, out, os.path.join(WEB, "worker.js"), json.dumps(PER_VERTEX)]
    run = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    rows = json.loads(run.stdout)
    for i, row in enumerate(rows):
        with open("%s.%d" % (out, i), "rb") as f:
            data = f.read()
        row["values"] = struct.unpack("<%dd" % (len(data) // 8), data)
        os.remove("%s.%d" % (out, i))
    return rows


def native_library(source=os.path.join(WEB, "web.c")):
    if source not in BUILT:
        cc = program(os.environ.get("CC", "cc"), "gcc", "clang")
        lib = os.path.join(FOLDER, os.path.basename(source) + ".so")
        BUILT[source] = None
        if cc:                                   # times are printed with --large only; -Og takes half of what -O1 takes to compile
            subprocess.run([cc, "-std=gnu99", "-O2" if LARGE else "-Og", "-ffp-contract=off", "-DNDEBUG", "-DHEATDIFF_NO_SIMD", "-fPIC",
                            "-shared", "-Wno-unused-function", source, "-o", lib, "-lm"], check=True)
            BUILT[source] = lib
    return BUILT[source]


def natively(steps):
    lib = ctypes.CDLL(native_library())
    lib.page_alloc.restype = ctypes.c_void_p
    lib.page_out.restype = lib.page_facts.restype = ctypes.POINTER(ctypes.c_double)
    lib.page_text.restype = ctypes.c_char_p
    lib.page_begin.argtypes = [ctypes.c_int32, ctypes.c_double]
    lib.page_file.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    lib.page_alloc.argtypes = [ctypes.c_size_t]
    rows = []
    for op, *given in steps:
        n, times, args, begin = lib.page_n(), 1, [], time.thread_time()
        for x in given:
            if isinstance(x, list):
                times = len(x)
                args += [times, (ctypes.c_double * times)(*x)]
            elif isinstance(x, str):
                args.append(lib.page_alloc(len(x) + 1))
                ctypes.memmove(args[-1], x.encode() + b"\0", len(x) + 1)
            else:
                args.append(x)
        status = getattr(lib, "page_" + op)(*args)
        ms = 1000 * (time.thread_time() - begin)
        facts, count = op == "begin", PER_VERTEX.get(op, 0) * n * times
        values = (lib.page_facts()[:10] if facts else lib.page_out()[:count] if count else []) if status >= 0 else []
        rows.append({"status": status, "ms": ms, "n": lib.page_n(), "values": tuple(values),
                     "text": lib.page_text().decode() if status < 0 else ""})
    return rows


def with_times(steps, h):
    """The steps with times in units of h^2."""
    return [[[x * h * h for x in v] if isinstance(v, list) else v for v in s] for s in steps]


# A small module: the column of K_t of an octahedron (L = w (4 I - A) with w = 1/sqrt(3), B = I) and nothing else.
COLUMN = r"""
#define HEATDIFF_IMPLEMENTATION
#include "%s/heatdiff.h"
__attribute__((export_name("column"))) double column(double t, int32_t v) {
    static const double xyz[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const int32_t tri[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    hd_laplacian_opts o = {0};
    const hd_mesh mesh = hd_triangles(xyz, 6, tri, 8);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    double u[6] = {-1};
    o.kind = HD_LAPLACIAN_COT;
    if (hd_laplacian_create(&lap, &mesh, &o, NULL) < 0 || hd_heat_create(&heat, lap, NULL, NULL) < 0) return -1;
    if (hd_heat_column(heat, HD_KERNEL_OPERATOR, t, 0, u, NULL, NULL) < 0) return -2;
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return u[v];
}
""" % TOP.replace("\\", "/")
COLUMN_SWITCHES = ["-DHEATDIFF_NO_POLE_FACTORS", "-DHEATDIFF_NO_INTRINSIC", "-DHEATDIFF_NO_ITERATIVE", "-DHEATDIFF_NO_SPECTRUM",
                   "-DHEATDIFF_NO_POINTS", "-DHEATDIFF_NO_POLYGONS", "-DHEATDIFF_NO_LOCAL"]
COLUMN_NODE = """
const fs = require("fs"), m = new WebAssembly.Module(fs.readFileSync(process.argv[1]));
const wasm = new WebAssembly.Instance(m, {}).exports;
wasm._initialize();
console.log(JSON.stringify([0, 1, 2].map((v) => wasm.column(0.7, v))));
"""


class Module(unittest.TestCase):
    def test_column_alone(self):
        needs(("node", program("node", "nodejs")))
        folder = os.path.join(FOLDER, "column")
        source = os.path.join(folder, "column.c")
        os.makedirs(folder, exist_ok=True)
        with open(source, "w") as f:
            f.write(COLUMN)
        wasm = build.module(folder, source, COLUMN_SWITCHES)
        run = subprocess.run([program("node", "nodejs"), "-e", COLUMN_NODE, wasm], stdout=subprocess.PIPE, check=True)
        slow, fast = math.exp(-2.8 / math.sqrt(3)), math.exp(-4.2 / math.sqrt(3))
        truth = [(1 + 3 * slow + 2 * fast) / 6, (1 - 3 * slow + 2 * fast) / 6, (1 - fast) / 6]
        for have, want in zip(json.loads(run.stdout), truth):
            self.assertAlmostEqual(have, want, delta=1e-8)
        print("module of one column %.0f KB" % (os.path.getsize(wasm) / 1000), file=sys.stderr)
        if shutil.which("wasm-opt"):
            self.assertLess(os.path.getsize(wasm), COLUMN_LIMIT)

    def test_sizes(self):
        needs()
        wasm, page = os.path.getsize(BUILT["wasm"]), os.path.getsize(BUILT["page"])
        print("module %.0f KB, page %.0f KB" % (wasm / 1000, page / 1000), file=sys.stderr)
        if shutil.which("wasm-opt"):
            self.assertLess(wasm, MODULE_LIMIT)
        self.assertLess(page, PAGE_LIMIT)
        with open(BUILT["page"], encoding="utf-8") as f:
            self.assertNotIn("http", f.read().replace("http://www.w3.org", ""), "the page needs no network")

    def test_same_numbers_as_native(self):
        needs(("node", program("node", "nodejs")), ("native compiler", native_library()))
        for surface in STEPS:
            h = natively([surface, ["begin", 0, 0]])[1]["values"][0]
            steps = [surface, ["begin", 0, 0]] + with_times(QUERIES, h)
            if surface[:2] == ["shape", 2]:
                steps += [["begin", 1, 0]] + with_times(QUERIES[:1], h)
            there, here = in_node(steps), natively(steps)
            for step, a, b in zip(steps, there, here):
                with self.subTest(surface=surface[:2], step=step[0]):
                    self.assertEqual((a["status"], a["n"], a["text"]), (b["status"], b["n"], b["text"]))
                    self.assertEqual(len(a["values"]), len(b["values"]))
                    if step[0] == "begin":
                        a["values"], b["values"] = a["values"][:2], b["values"][:2]
                    most = max([abs(x) for x in b["values"] if math.isfinite(x)] or [1])
                    for x, y in zip(a["values"], b["values"]):
                        self.assertTrue(x == y or abs(x - y) <= 1e-12 * most, (x, y, most))

    def test_start_and_limit(self):
        """Heat begins on the largest piece, though another one reaches farther; and a limit of memory is kept."""
        needs(("node", program("node", "nodejs")))
        small = "".join("v %d %d %d\n" % p for p in ((90, 0, 0), (91, 0, 0), (90, 1, 0))) + "f 801 802 803\n"
        first, again, answer = in_node([file_step("two.obj", ring(40, 20) + small), ["begin", 0, 0], ["begin", 0, 1e6],
                                        ["columns", DIRECT, [1.0], 7]])[1:]
        self.assertEqual(first["values"][3], 2)
        self.assertLess(first["values"][9], 800)
        self.assertEqual((again["status"], answer["status"]), (0, -3), answer["text"])

    def test_colours(self):
        """The page draws with the colours of tools/picture.h."""
        needs(("node", program("node", "nodejs")), ("native compiler", native_library()))
        source = os.path.join(FOLDER, "colours.c")
        with open(source, "w") as f:
            f.write('#include "%s/tools/picture.h"\nvoid colour(double s, uint8_t *rgb);\n'
                    "void colour(double s, uint8_t *rgb) { pic_colormap(s, rgb, PIC_MAP_EMBER); }\n" % TOP)
        library = os.path.join(FOLDER, "colours.so")
        cc = program(os.environ.get("CC", "cc"), "gcc", "clang")
        subprocess.run([cc, "-std=gnu99", "-w", "-fPIC", "-shared", source, "-o", library, "-lm"], check=True)
        code = ("const vm = require('vm'), all = {}; vm.runInNewContext(require('fs').readFileSync(process.argv[1], 'utf8'), all);"
                "console.log(JSON.stringify(Array.from({ length: 101 }, (_, i) => all.colourOf(i / 100))))")
        run = subprocess.run([program("node", "nodejs"), "-e", code, os.path.join(WEB, "view.js")], stdout=subprocess.PIPE, check=True)
        for i, have in enumerate(json.loads(run.stdout)):
            want = (ctypes.c_uint8 * 3)()
            ctypes.CDLL(library).colour(ctypes.c_double(i / 100), want)
            self.assertLessEqual(max(abs(a - b) for a, b in zip(have, want)), 1, (i, have, list(want)))

    def test_bad_files(self):
        needs(("node", program("node", "nodejs")))
        files = {"a.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "a.txt": "hello",
                 "a.ply": "ply\nformat ascii 1.0\nelement vertex 2\nend_header\n", "a.off": "OFF\n3 1\n",
                 "a.stl": "", "flat.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"}
        for name, content in files.items():
            rows = in_node([file_step(name, content), ["begin", 0, 0], ["shape", 1, 700], ["begin", 0, 0]])
            said = rows[0]["text"] or rows[1]["text"]
            print("%s: %s" % (name, said), file=sys.stderr)
            self.assertTrue(said)
            self.assertEqual(rows[3]["status"], 0, "a good surface works after a bad file")
        self.assertIn("a.obj:4: ", in_node([file_step("a.obj", files["a.obj"])])[0]["text"])

    def test_measure(self):
        if not LARGE:
            raise unittest.SkipTest("--large")
        needs(("node", program("node", "nodejs")), ("native compiler", native_library()))
        surface = ["shape", 0, 36000]
        h = natively([surface, ["begin", 0, 0]])[1]["values"][0]
        decade = [10 * 2 ** (k / 3) for k in range(10)]
        steps = [surface, ["begin", 0, 0]] + with_times([
            ["columns", DIRECT, [100.0], 7], ["columns", DIRECT, [200.0], 7], ["columns", DIRECT, [200.0], 700],
            ["columns", DIRECT, [200.0], 1700], ["columns", KRYLOV, decade, 7], ["columns", KRYLOV, decade, 99],
            ["smooth", decade], ["geodesic", 5], ["geodesic", 6],
            ["signature", [100.0]], ["signature", decade]], h)
        names = ["make the shape", "Laplacian", "column: order, analyse, factorise, solve", "column at a new time",
                 "further column", "further column", "columns of a decade, first", "columns of a decade",
                 "smoothing over a decade", "geodesic, first", "geodesic", "signature", "signatures of a decade"]
        there, here = in_node(steps), natively(steps)
        for name, a, b in zip(names, there, here):
            print("%-42s wasm %7.1f ms, native %7.1f ms, ratio %.2f"
                  % (name, a["ms"], b["ms"], a["ms"] / b["ms"]), file=sys.stderr)
        print("%d vertices, %.0f MB" % (there[0]["n"], there[-1]["bytes"] / 2 ** 20), file=sys.stderr)


# ---- the package ----

def npm(folder, *arguments, **more):
    """Runs npm with a cache of its own and without a word about itself; returns what it prints."""
    environment = dict(os.environ, npm_config_cache=os.path.join(FOLDER, "npm-cache"), npm_config_update_notifier="false",
                       npm_config_audit="false", npm_config_fund="false")
    run = subprocess.run([program("npm"), *arguments], cwd=folder, env=environment, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, universal_newlines=True, **more)
    if run.returncode:
        raise AssertionError("npm %s: %s" % (" ".join(arguments), run.stderr[-3000:]))
    return run.stdout


def packed():
    """The tarball and the names in it, packed once, from a copy: the source tree stays as it is."""
    if "package" not in BUILT:
        tree = os.path.join(FOLDER, "tree")
        for name in ("examples/web", "examples/npm"):
            shutil.copytree(os.path.join(TOP, name), os.path.join(tree, name), ignore=shutil.ignore_patterns(
                "node_modules", "*.tgz", "heatdiff.wasm", "inline.js", "LICENSE", "__pycache__"))
        for name in ("heatdiff.h", "LICENSE"):
            shutil.copy(os.path.join(TOP, name), tree)
        said = npm(os.path.join(tree, "examples", "npm"), "pack", "--json", "--pack-destination", FOLDER)
        said = json.loads(said[said.index("["):])[0]
        BUILT["package"] = os.path.join(FOLDER, said["filename"]), {f["path"] for f in said["files"]}
    return BUILT["package"]


def installed(*more):
    """A folder with the package, and others of the registry."""
    if more in BUILT:
        return BUILT[more]
    folder = BUILT[more] = tempfile.mkdtemp(dir=FOLDER)
    with open(os.path.join(folder, "package.json"), "w") as f:
        json.dump({"name": "user", "private": True, "type": "module"}, f)
    npm(folder, "install", *([] if more else ["--offline"]), packed()[0], *more, timeout=240)
    return folder


def natively_packed(mesh, queries):
    """What module.c says natively: the mean edge, three times, and the queries' values."""
    lib, real, whole = ctypes.CDLL(native_library(os.path.join(NPM, "module.c"))), ctypes.c_double, ctypes.c_int32
    lib.module_create.restype = lib.module_alloc.restype = ctypes.c_void_p
    lib.module_facts.restype = ctypes.POINTER(real)
    lib.module_alloc.argtypes = [ctypes.c_size_t]

    def block(kind, values):
        p = lib.module_alloc(ctypes.sizeof(kind) * len(values))
        ctypes.memmove(p, (kind * len(values))(*values), ctypes.sizeof(kind) * len(values))
        return ctypes.c_void_p(p)

    n, n_faces = len(mesh["positions"]) // mesh["stride"], len(mesh["indices"]) // 3
    s = ctypes.c_void_p(lib.module_create(n, block(ctypes.c_float, mesh["positions"]), 32, ctypes.c_size_t(4 * mesh["stride"]), n_faces,
                                          block(ctypes.c_uint32, mesh["indices"]), 32, 0, 0, 0, 0, None, real(0)))
    h, three = lib.module_facts()[4], (real * 3)()
    lib.module_times(s, 3, three)
    answers = []
    for op, times, sources, words in queries:
        t, v, many = (real * len(times))(*(x * h * h for x in times)), (whole * len(sources))(*sources), max(1, len(times))
        out, list_ = (real * (3 * n * many * max(1, len(sources))))(), (whole * n)()
        size = n * many * len(sources)
        if op == "columns":
            status = lib.module_columns(s, words["method"][0], words["kernel"][0], len(t), t, len(v), v, out)
        elif op == "signature":
            status, size = lib.module_signature(s, 1, len(t), t, out, (real * many)()), n * many
        elif op == "distance":
            status = lib.module_distance(s, words["kind"][0], len(t), t, len(v), v, out)
        elif op == "geodesic":
            status = lib.module_geodesic(s, 0, len(v), v, out)
        elif op == "sample":
            status, size = lib.module_sample(s, 0, real(t[0]), 0, v, 5, list_, out), 5
        else:
            xyz, size = (real * (3 * n))(), 3 * n
            lib.module_coordinates(s, xyz)
            status = lib.module_apply(s, 0, 1, t, 3, xyz, out)
        assert status == 0, op
        values = list(list_[:5] if op == "sample" else out[:size])
        if op == "smooth":
            values = [values[i % 3 * n + i // 3] for i in range(3 * n)]
        options = {k: w[1] for k, w in words.items()}
        args = {"sample": [5, list(t)], "smooth": [list(t)], "signature": [list(t)], "geodesic": [sources]}.get(
            op, [sources, list(t) or None, options])
        answers.append({"op": op, "args": args, "values": values})
    lib.module_dispose(s)
    return dict(mesh, h=h, times=list(three), answers=answers)


PACKAGE_QUERIES = [
    ("columns", [30.0], [7], {"method": (DIRECT, "direct"), "kernel": (1, "symmetric")}),
    ("columns", [2.0, 4.0, 8.0], [33, 5], {"method": (KRYLOV, "krylov"), "kernel": (0, "operator")}),
    ("columns", [3.0], [2], {"method": (1, "iterative"), "kernel": (0, "operator")}),
    ("signature", [20.0, 40.0], [], {}), ("smooth", [2.0], [], {}), ("geodesic", [], [11, 2], {}), ("sample", [30.0], [], {}),
    ("distance", [9.0, 30.0], [4, 500], {"kind": (0, "classical")}), ("distance", [], [3], {"kind": (3, "biharmonic")})]


class Package(unittest.TestCase):
    def setUp(self):
        needs(("node", program("node", "nodejs")), ("npm", program("npm")), page=False)

    def test_in_node(self):
        needs(("native compiler", native_library(os.path.join(NPM, "module.c"))), page=False)
        lines = ring(40, 20).split("\n")
        single = ctypes.c_float
        mesh = {"stride": 5, "indices": [int(i) - 1 for l in lines if l[:1] == "f" for i in l.split()[1:]],
                "positions": [single(float(x)).value for l in lines if l[:1] == "v" for x in l.split()[1:] + ["7", "nan"]]}
        folder = installed()
        given = natively_packed(mesh, PACKAGE_QUERIES)
        given["positions"] = [x if math.isfinite(x) else 0 for x in given["positions"]]     # nobody reads the two behind z
        with open(os.path.join(folder, "answers.json"), "w") as f:
            f.write(json.dumps(given).replace("Infinity", "1e999"))
        shutil.copy(os.path.join(TOP, "tests", "npm.mjs"), folder)
        run = subprocess.run([program("node", "nodejs"), "--expose-gc", "npm.mjs", "answers.json"], cwd=folder, timeout=200,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        print(run.stdout, file=sys.stderr)
        self.assertEqual(run.returncode, 0, run.stdout[-6000:])
        self.assertGreater(run.stdout.count("ok: "), 14)

    def test_contents(self):
        path, names = packed()
        with open(os.path.join(NPM, "package.json")) as f:
            about = json.load(f)
        wanted = {name[2:] for e in about["exports"].values() for name in (e.values() if isinstance(e, dict) else [e])}
        self.assertEqual(names, wanted | {"core.js", "inline.js", "thread.js", "README.md", "LICENSE", "package.json"})
        with open(os.path.join(TOP, "heatdiff.h")) as f:
            header = f.read()
        version = [re.search(r"#define HD_VERSION_%s (\d+)" % part, header).group(1) for part in ("MAJOR", "MINOR", "PATCH")]
        self.assertEqual(about["version"], ".".join(version))
        wasm = os.path.getsize(os.path.join(FOLDER, "tree", "examples", "npm", "heatdiff.wasm"))
        print("module of the package %.0f KB, package %.0f KB" % (wasm / 1000, os.path.getsize(path) / 1000), file=sys.stderr)
        if shutil.which("wasm-opt"):
            self.assertLess(wasm, PACKAGE_LIMIT)

    def test_words(self):
        """Words stand in the order of the header's enums; types name what there is."""
        with open(os.path.join(TOP, "heatdiff.h")) as f:
            header = re.sub(r"/\*.*?\*/", "", f.read(), flags=re.S)
        with open(os.path.join(NPM, "core.js")) as f:
            core = f.read()
        words = re.search(r"WORDS = \{(.*?)\n\};", core, re.S).group(1)
        for name, body in re.findall(r"(\w+): \[(.*?)\]", words, re.S):
            enum = re.findall(r"\b(HD_[A-Z_0-9]+)", re.search(r"typedef enum %s \{(.*?)\}" % name, header, re.S).group(1))
            here = ["HD_" + w.upper().replace("-", "_") for w in re.findall(r'"(.*?)"', body)]
            prefix = os.path.commonprefix(enum)
            enum = ["HD_" + e[len(prefix):] for e in enum]
            self.assertEqual(here, enum[:len(here)], name)
            self.assertLessEqual(set(enum[len(here):]), {"HD_MATRICES"}, name)
        code = "for (const e of process.argv.slice(1)) console.log(JSON.stringify(Object.keys(await import(e)).sort()))"
        entries = ["heatdiff", "heatdiff/slim", "heatdiff/worker", "heatdiff/three"]
        run = subprocess.run([program("node", "nodejs"), "--input-type=module", "-e", code] + entries, cwd=installed(), check=True,
                             stdout=subprocess.PIPE)
        for entry, line in zip(("index", "slim", "worker", "three"), run.stdout.splitlines()):
            with open(os.path.join(NPM, entry + ".d.ts")) as f:
                typed = f.read()
            names = set(re.findall(r"export (?:const|class|function) (\w+)", typed))
            if entry != "three":
                names |= {"Answer", "HeatError", "supported"}
            if entry == "slim":
                names |= {"Surface", "memory", "ready"}
            self.assertEqual(names, set(json.loads(line)), entry)


# ---- the page in a browser ----

class Browser:
    """Chromium by its debugging pipe: messages of JSON that end on a zero byte."""

    def __init__(self, page, width, height, phone=False):
        self.profile = tempfile.mkdtemp(dir=FOLDER)
        (from_us, self.to), (self.back, from_it) = os.pipe(), os.pipe()

        def wire():
            a, b = os.dup(from_us), os.dup(from_it)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-sync",
             "--disable-background-networking", "--disable-component-update", "--disable-extensions", "--use-gl=angle",
             "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
             "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--remote-debugging-pipe", "--user-data-dir=" + self.profile,
             "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, close_fds=False, preexec_fn=wire)
        os.close(from_us)
        os.close(from_it)
        self.buffer, self.count, self.errors, self.session = b"", 0, [], None
        target = next(t for t in self.ask("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.ask(domain + ".enable")
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2 if phone else 1,
                 mobile=phone)
        if phone:
            self.ask("Emulation.setTouchEmulationEnabled", enabled=True)
        self.ask("Page.navigate", url=page if page.startswith("http:") else "file://" + page)

    def read(self):
        while b"\0" not in self.buffer:
            more = os.read(self.back, 1 << 20)
            if not more:
                raise RuntimeError("chromium ended")
            self.buffer += more
        one, self.buffer = self.buffer.split(b"\0", 1)
        m = json.loads(one)
        if m.get("method") == "Runtime.exceptionThrown":
            d = m["params"]["exceptionDetails"]
            self.errors.append(d.get("exception", {}).get("description", d["text"]))
        if m.get("method") == "Log.entryAdded" and m["params"]["entry"]["level"] == "error":
            self.errors.append(m["params"]["entry"]["text"])
        return m

    def ask(self, method, **params):
        self.count += 1
        m = {"id": self.count, "method": method, "params": params}
        if self.session:
            m["sessionId"] = self.session
        os.write(self.to, json.dumps(m).encode() + b"\0")
        while True:
            got = self.read()
            if got.get("id") == self.count:
                if "error" in got:
                    raise RuntimeError("%s: %s" % (method, got["error"]["message"]))
                return got["result"]

    def js(self, code):
        r = self.ask("Runtime.evaluate", expression=code, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in r:
            raise RuntimeError(r["exceptionDetails"].get("exception", {}).get("description", code))
        return r["result"].get("value")

    def until(self, code, seconds=60):
        end = time.time() + seconds
        while time.time() < end:
            if self.js("Boolean(%s)" % code):
                return
            time.sleep(0.05)
        says = self.js("document.body.innerText")
        raise AssertionError("not within %d s: %s; the page says: %s" % (seconds, code, says))

    def mouse(self, kind, x, y, buttons=0):
        button = "left" if kind != "mouseMoved" or buttons else "none"
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=1)

    def click(self, x, y):
        self.mouse("mousePressed", x, y, 1)
        self.mouse("mouseReleased", x, y)

    def drop(self, name, data):
        """What the page sees when a file is dropped on it."""
        self.js("""(() => { const d = new DataTransfer(), data = Uint8Array.from(atob(%s), (c) => c.charCodeAt(0));
                d.items.add(new File([data], %s));
                for (const t of ["dragenter", "dragover", "drop"]) document.body.dispatchEvent(
                    new DragEvent(t, { dataTransfer: d, bubbles: true, cancelable: true })); })()"""
                % (json.dumps(base64.b64encode(data).decode()), json.dumps(name)))

    def text(self, element):
        return self.js("document.getElementById(%s).textContent" % json.dumps(element))

    def shot(self, name):
        self.js("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))")
        path = os.path.join(FOLDER, name + ".png")
        with open(path, "wb") as f:
            f.write(base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"]))
        return path

    def close(self):
        try:
            self.session = None
            self.ask("Browser.close")
        except (RuntimeError, OSError):
            pass
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.to)
        os.close(self.back)
        shutil.rmtree(self.profile, ignore_errors=True)


SHOWN = "heatdiff.shown && heatdiff.shown.mode === heatdiff.mode && document.body.dataset.idle"
IDLE = SHOWN + " && document.body.dataset.idle === 'yes'"


class Page(unittest.TestCase):
    def open(self, width=1280, height=800, phone=False, hash=""):
        needs(("chromium", CHROMIUM))
        self.browser = Browser(BUILT["page"] + hash, width, height, phone)
        self.addCleanup(self.browser.close)
        self.browser.until("window.heatdiff && heatdiff.times.length && " + SHOWN)
        return self.browser

    def mode(self, name):
        self.browser.js("document.querySelector('[value=%s]').click()" % name)
        self.browser.until(SHOWN)

    def slide(self, at):
        self.browser.js("document.getElementById('time').value = %d; setTime(%d)" % (at, at))
        self.browser.until(SHOWN)

    def choose(self, shape):
        self.browser.js("(() => { const s = document.getElementById('shape'); s.value = '%s';"
                        "s.dispatchEvent(new Event('change')); })()" % shape)

    def test_laptop(self):
        b = self.open()
        b.until(IDLE, 120)
        self.assertEqual(b.text("fact-ready"), "%d of %d times" % (b.js("heatdiff.shownCount"), b.js("heatdiff.shownCount")))
        b.shot("laptop-kernel")
        # a click moves the source to a vertex at that place of the picture
        x, y = b.js("view.where(view.pick(480, 380))")
        was = b.js("heatdiff.source")
        b.click(x, y)
        b.until("heatdiff.source !== %d && %s" % (was, SHOWN))
        u, v = b.js("view.where(heatdiff.source)")
        self.assertLess(math.hypot(u - x, v - y), 12)
        b.until(IDLE, 120)
        b.shot("laptop-clicked")
        # every step of the slider is answered at once
        slow = 0
        for at in range(0, b.js("heatdiff.shownCount"), 3):
            slow = max(slow, b.js(
                "(() => { const s = document.getElementById('time'), begin = performance.now(); s.value = %d;"
                "s.dispatchEvent(new Event('input'));"
                "return heatdiff.shown && heatdiff.shown.at === %d ? performance.now() - begin : 1e9; })()" % (at, at)))
        print("slowest step of the slider: %.1f ms" % slow, file=sys.stderr)
        self.assertLess(slow, 1000)
        # further clicks at one time, by the factors that are there
        self.slide(20)
        b.until(IDLE, 120)
        b.until("heatdiff.factored === heatdiff.at", 30)
        took = b.js("(async () => { const all = []; for (let k = 0; k < 5; k++) { setSource(100 + 777 * k);"
                    "while (!heatdiff.shown) await new Promise((r) => setTimeout(r, 1)); all.push(heatdiff.took); }"
                    "return all; })()")
        print("clicks, to the picture's data: %s ms" % ", ".join("%.1f" % t for t in took), file=sys.stderr)
        # drag turns and does not click
        source, yaw = b.js("heatdiff.source"), b.js("view.yaw")
        b.mouse("mousePressed", 400, 400, 1)
        for k in range(1, 6):
            b.mouse("mouseMoved", 400 + 20 * k, 400, 1)
        b.mouse("mouseReleased", 500, 400)
        self.assertEqual(b.js("heatdiff.source"), source)
        self.assertGreater(b.js("view.yaw"), yaw + 0.3)
        for name in ("geodesic", "smooth", "signature", "distance"):
            self.mode(name)
            b.until(IDLE, 240)
            b.shot("laptop-" + name)
        self.assertIn("(", b.text("fact-bound"))
        b.js("document.getElementById('edges').click()")
        b.mouse("mouseMoved", 480, 380)
        b.until("!document.getElementById('hover').hidden")
        b.shot("laptop-edges")
        self.assertEqual(b.errors, [])

    def test_numbers(self):
        """What the page holds is what native code answers."""
        b = self.open()
        needs(("native compiler", native_library()))
        text = ring(60, 30)
        b.drop("ring.obj", text.encode())
        b.until("heatdiff.name === 'ring.obj' && heatdiff.mesh.n === 1800 && " + IDLE)
        b.js("setSource(17)")
        self.mode("signature")
        b.until(IDLE)
        self.mode("distance")
        b.until(IDLE)
        at = b.js("heatdiff.at")
        t = b.js("heatdiff.times[%d]" % at)
        chunk = at // 10
        times = b.js("chunkTimes(%d)" % chunk)
        far = b.js("chunkTimes(%d)" % ((at + 3) // 10))
        native = natively([file_step("ring.obj", text), ["begin", 0, 0], ["columns", KRYLOV, times, 17],
                           ["columns", KRYLOV, far, 17], ["signature", far], ["geodesic", 17]])
        n, k, j = 1800, at - 10 * chunk, at + 3 - 10 * ((at + 3) // 10)
        self.assertAlmostEqual(times[k] / t, 1, 14)
        diagonal, column = native[4]["values"][n * j:n * j + n], native[3]["values"][n * j:n * j + n]
        want = [math.sqrt(max(0, diagonal[17] - 2 * column[i] + diagonal[i])) if i != 17 else 0 for i in range(n)]
        got = b.js("Array.from(heatdiff.shown.values)")
        self.assertLess(max(abs(x - y) for x, y in zip(got, want)), 1e-9 * max(want))
        self.mode("kernel")
        b.until(IDLE)
        column = native[2]["values"][n * k:n * k + n]
        got = b.js("Array.from(heatdiff.shown.values)")
        self.assertLess(max(abs(x - y) for x, y in zip(got, column)), 1e-12 * max(column))
        self.mode("geodesic")
        b.until(IDLE)
        got = b.js("Array.from(heatdiff.shown.values)")
        self.assertLess(max(abs(x - y) for x, y in zip(got, native[5]["values"])), 1e-12 * max(native[5]["values"]))
        # what is saved can be read again, with the values
        head, count = b.js("ply().arrayBuffer().then((a) => [new TextDecoder().decode(a.slice(0, 600)), a.byteLength])")
        head = head[:head.index("end_header\n") + 11]
        self.assertIn("element vertex 1800", head)
        self.assertEqual(count, len(head) + 35 * 1800 + 13 * 3600)
        self.assertGreater(b.js("picture().toDataURL().length"), 20000)
        b.shot("laptop-file")
        self.assertEqual(b.errors, [])

    def test_bad_file(self):
        b = self.open()
        n = b.js("heatdiff.mesh.n")
        b.drop("broken.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n")
        b.until("!document.getElementById('alert').hidden")
        said = b.text("alert-title") + ": " + b.text("alert-text")
        print("a bad file: " + said, file=sys.stderr)
        self.assertIn("broken.obj:4", said)
        b.until("heatdiff.times.length && " + SHOWN)
        b.shot("laptop-bad-file")
        self.assertEqual(b.js("heatdiff.mesh.n"), n)
        self.assertFalse(b.js("document.getElementById('alert').hidden"), "the message stays until it is read")
        self.assertEqual(b.js("document.getElementById('shape').value"), "0:12000")
        b.drop("noise.ply", bytes(range(256)) * 40)
        b.until("document.getElementById('alert-text').textContent.includes('noise.ply')")
        b.until("heatdiff.times.length && " + SHOWN)
        self.assertEqual(b.errors, [])

    def alert(self):
        return self.browser.js("document.getElementById('alert').hidden ? '' : document.getElementById('alert-title').textContent"
                               " + ': ' + document.getElementById('alert-text').textContent")

    def test_looks(self):
        """A sentence for each mode, dark colours by the system and by the switch, and which way is up."""
        b = self.open()
        b.until(IDLE, 120)
        about = set()
        for name in ("kernel", "distance", "geodesic", "signature", "smooth"):
            b.js("document.querySelector('[value=%s]').click()" % name)
            about.add(b.text("about"))
        self.assertEqual(len(about), 5)
        self.assertGreater(min(map(len, about)), 50)
        pixel = ("(() => { view.drawNow(); const g = view.gl, p = new Uint8Array(4); g.readPixels(5, %s, 1, 1, g.RGBA, g.UNSIGNED_BYTE, p);"
                 "return p[0]; })()")
        paper = "getComputedStyle(document.getElementById('panel')).backgroundColor"
        self.assertGreater(b.js(pixel % 5), 215)
        bright = b.js(paper)
        b.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        b.until("document.documentElement.dataset.theme === 'dark'", 5)
        self.assertLess(b.js(pixel % 5), 40)
        self.assertNotEqual(b.js(paper), bright)
        b.until(IDLE, 120)
        b.shot("laptop-dark")
        b.js("document.getElementById('dark').click()")
        self.assertEqual(b.js(paper), bright)
        # the elephant stands: its shadow is darker than the paper beside it; then it lies
        box = ("(() => { const lo = [9, 9, 9], hi = [-9, -9, -9]; view.at.forEach((x, i) => { lo[i % 3] = Math.min(lo[i % 3], x);"
               "hi[i % 3] = Math.max(hi[i % 3], x); }); return hi.map((x, c) => x - lo[c]); })()")
        self.assertGreater(b.js("Math.max(...new Uint8Array(shadowOf(view.at, view.tri, view.height)))"), 100)
        was = b.js(box)
        for axis, order in (("z", (0, 2, 1)), ("x", (1, 0, 2)), ("y", (0, 1, 2))):
            b.js("(() => { const u = document.getElementById('up'); u.value = '%s'; u.dispatchEvent(new Event('change')); })()" % axis)
            for have, k in zip(b.js(box), order):
                self.assertAlmostEqual(have, was[k], 5)
            self.assertAlmostEqual(b.js("view.height - Math.min(...view.at.filter((_, i) => i % 3 === 1))"), 0, 6)
        self.assertEqual(b.errors, [])

    def test_loading(self):
        """The old shape is not shown under a new name."""
        b = self.open()
        b.until(IDLE, 120)
        n, hidden, text = b.js("(() => { const s = document.getElementById('shape'); s.value = '1:10000'; s.dispatchEvent(new Event('change'));"
                               "return [view.n, document.getElementById('legend').hidden, document.getElementById('mesh').textContent]; })()")
        self.assertEqual((n, hidden, text), (0, True, "reading Bumpy ball …"))
        b.until("heatdiff.times.length && view.n === heatdiff.mesh.n && " + SHOWN)
        self.assertIn("10,", b.text("mesh"))
        b.js("document.getElementById('mend').click()")         # the same shape: it stays
        self.assertEqual(b.js("view.n"), b.js("heatdiff.mesh.n"))
        self.assertEqual(b.errors, [])

    def test_little_memory(self):
        """What fails is said only where nothing else answers: a surface too large for all factors still has its picture."""
        b = self.open(hash="#memory=40")
        b.until(IDLE + " && heatdiff.failed.has('direct')", 120)
        self.assertEqual(self.alert(), "")
        self.assertTrue(b.js("heatdiff.shown.values.length === heatdiff.mesh.n"))
        self.assertIn("each click takes longer", b.text("note"))
        b.js("setSource(1000)")
        b.until(IDLE, 60)
        self.assertEqual(b.js("heatdiff.shown.source"), 1000)
        b.js("setMode('signature')")
        b.until("!document.getElementById('alert').hidden", 60)
        self.assertIn("No signature for this surface: ", self.alert())
        self.assertIn("byte limit", self.alert())
        b.shot("laptop-little-memory")
        b.js("setMode('kernel')")
        self.assertEqual(self.alert(), "")
        self.assertEqual(b.errors, [])

    def test_out_of_memory(self):
        """A trap in a worker costs that answer and no more."""
        b = self.open()
        b.until(IDLE, 120)
        b.js("give(workers[1], { op: 'columns', t: null, done: (m) => fail(m, 'smooth') })")     # null traps
        b.until("heatdiff.failed.has('smooth')")
        self.assertEqual(self.alert(), "")
        b.js("setMode('smooth')")
        self.assertIn("No smoothing for this surface: out of memory", self.alert())
        b.js("setMode('kernel')")
        self.assertEqual(self.alert(), "")
        b.js("setSource(1000)")
        b.until(IDLE + " && heatdiff.known === heatdiff.shownCount", 120)
        self.assertEqual(b.errors, [])

    def test_phone(self):
        b = self.open(390, 844, True)
        b.until(IDLE, 120)
        b.shot("phone-kernel")
        self.assertLessEqual(b.js("document.documentElement.scrollWidth"), 390)
        b.js("scrollTo(0, 400)")
        b.shot("phone-scrolled")
        b.js("scrollTo(0, 0)")
        self.choose("4:12000")
        b.until("heatdiff.mesh && heatdiff.mesh.tri.length === 0 && " + IDLE, 120)
        self.assertTrue(b.js("document.querySelector('[value=geodesic]').disabled"))
        b.shot("phone-points")
        self.assertEqual(b.errors, [])

    def test_shapes(self):
        b = self.open()
        for value in b.js("[...document.querySelectorAll('#shape option')].map((o) => o.value)"):
            if value in ("file", "0:36000"):
                continue
            self.choose(value)
            b.until("heatdiff.times.length && " + SHOWN)
            self.mode("kernel")
            b.until(IDLE, 120)
            b.shot("shape-" + value.replace(":", "-"))
        self.assertEqual(b.errors, [])


# ---- three.js, and types ----

TYPED = """
import { ready, Surface, HeatError, type Answer, type Report } from "heatdiff";
import { init } from "heatdiff/slim";
import { Surface as InWorker } from "heatdiff/worker";
import { GeometrySurface } from "heatdiff/three";
await ready;
await init(new URL("x.wasm", "http://127.0.0.1"));
const s = new Surface(new Uint16Array(3), new Float32Array(9), 3, { kind: "voronoi-cot", triangulation: "delaunay" });
const a: Answer<Report> = s.columns([0, 1], ["10h2", 0.3], { kernel: "symmetric", progress: (stage, done) => done < 1 });
const bound: number = a.report.bound + s.signature("auto:4").trace[0] + s.sample(3, 1).vertices[0];
const none: null = s.geodesic(0, { nearest: true }).report.bound;
const w = await InWorker.create(null, new Float64Array(9), 3, { signal: new AbortController().signal });
const column: Float64Array = (await w.distance(0, "10h2", { kind: "weighted" })).column(0, 0);
declare const geometry: { isBufferGeometry: true; attributes: Record<string, unknown>; index: null };
const attribute = new GeometrySurface(geometry, { say: null }).smooth("2h2").attribute;
try { s.dispose(); } catch (e) { if (e instanceof HeatError) console.log(e.status, e.face, bound, none, column, attribute); }
// @ts-expect-error: no such word
s.columns(0, 1, { kernel: "both" });
// @ts-expect-error: a list of numbers is no typed array
new Surface([0, 1, 2], new Float32Array(9));
// @ts-expect-error: no such option
s.geodesic(0, { far: true });
"""


class Three(unittest.TestCase):
    def folder(self):
        needs(("node", program("node", "nodejs")), ("npm", program("npm")), page=False)
        packed()
        try:
            return installed("three@0.187", "typescript@5")
        except (AssertionError, subprocess.TimeoutExpired) as e:
            absent("npm registry: %s" % e)

    def test_types(self):
        folder = self.folder()
        with open(os.path.join(folder, "typed.mts"), "w") as f:
            f.write(TYPED)
        tsc = os.path.join(folder, "node_modules", "typescript", "bin", "tsc")
        for resolution in (["--module", "nodenext"], ["--module", "esnext", "--moduleResolution", "bundler"]):
            run = subprocess.run([program("node", "nodejs"), tsc, "--noEmit", "--strict", "--target", "es2022", "--lib", "es2022,dom",
                                  *resolution, "typed.mts"], cwd=folder, stdout=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(run.returncode, 0, run.stdout)

    def open(self):
        needs(("chromium", CHROMIUM), page=False)
        folder = self.folder()
        for name in ("index.html", "page.js"):
            shutil.copy(os.path.join(NPM, "page", name), folder)

        class Quiet(SimpleHTTPRequestHandler):
            extensions_map = dict(SimpleHTTPRequestHandler.extensions_map, **{".wasm": "application/wasm", ".js": "text/javascript"})

            def __init__(self, *args):
                super().__init__(*args, directory=folder)

            def log_message(self, *args):
                pass

        server = ThreadingHTTPServer(("127.0.0.1", 0), Quiet)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.browser = Browser("http://127.0.0.1:%d/index.html" % server.server_port, 800, 600)
        self.addCleanup(self.browser.close)
        return self.browser

    def test_page(self):
        b = self.open()
        b.until("window.example && example.geometry.attributes.heat", 120)
        self.assertIn("heatdiff: 14749 vertices stand at 14400 places", b.text("said"))
        self.assertEqual(b.js("example.geometry.attributes.heat.constructor.name"), "Float32BufferAttribute")
        self.assertEqual(b.js("example.surface.info.boundaryEdges"), 0, "the seams are welded")
        self.assertEqual(b.js("example.geometry.attributes.heat.array[example.source]"), 0)
        before = b.shot("three-geodesic")
        colours = "(() => { const c = document.querySelector('canvas'), s = new Set(), g = c.getContext('webgl2'), p = new Uint8Array(4);" \
                  "for (let y = 60; y < 540; y += 9) for (let x = 60; x < 740; x += 9) { g.readPixels(x, y, 1, 1, g.RGBA, g.UNSIGNED_BYTE, p);" \
                  "s.add(String(p)); } return s.size; })()"
        self.assertGreater(b.js(colours), 200, before)
        source = b.js("example.source")
        b.click(*b.js("(() => { for (let x = 520; x > 300; x -= 5) if (example.pick(x, 300) >= 0 && example.pick(x, 300) !== example.source) return [x, 300]; })()"))
        b.until("example.source !== %d" % source)
        for what in ("distance", "columns", "signature", "geodesic"):
            b.js("(() => { const s = document.getElementById('what'); s.value = '%s'; s.dispatchEvent(new Event('change')); })()" % what)
            self.assertIn("about" if what == "geodesic" else "at most", b.text("said"))
            b.shot("three-" + what)
        # the worker, and the module beside the page, in a browser too
        self.assertEqual(b.js("""(async () => {
            const { Surface } = await import('./node_modules/heatdiff/worker.js'), { weld } = await import('heatdiff/three');
            const { positions, indices } = weld(example.geometry), stages = new Set();
            const s = await Surface.create(indices, positions), heat = await s.columns(0, '60h2', { progress: (name) => void stages.add(name) });
            const here = example.surface.surface.columns(0, '60h2'), stop = new AbortController();
            const work = s.signature('auto:16', { signal: stop.signal, progress: () => stop.abort() }).catch((e) => e.status);
            const same = heat.values.every((x, i) => Math.abs(x - here.values[i]) < 1e-7), status = await work;
            const again = await s.columns(0, '60h2');
            s.dispose();
            return [same, status, again.values.length].join(' ');
        })()"""), "true HD_ERR_CANCELLED 14400")
        self.assertEqual(b.js("""(async () => {
            const { init, Surface } = await import('./node_modules/heatdiff/slim.js');
            await init('./node_modules/heatdiff/heatdiff.wasm');
            return new Surface(null, new Float32Array(90).map((x, i) => Math.sin(i * i))).n;
        })()"""), 30)
        self.assertEqual(b.errors, [])


if __name__ == "__main__":
    arguments = sys.argv
    if "--large" in arguments:
        LARGE = True
        arguments.remove("--large")
    keep = None
    if "--keep" in arguments:
        k = arguments.index("--keep")
        keep = arguments[k + 1]
        del arguments[k:k + 2]
        os.makedirs(keep, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = os.path.abspath(keep or scratch)
        unittest.main(argv=arguments)
