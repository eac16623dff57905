#!/usr/bin/env python3
"""Tests of examples/blender: test_blender.py [unittest options]

What the add-on computes is tested without Blender, by NumPy and a compiled library (HEATDIFF_LIBRARY, else cc makes one): against
closed forms on planes, cylinders and spheres. Then the zip is installed into a Blender without window (BLENDER, else the one in
PATH), which runs the other half of this file: modes, scale, modifiers, locked groups, mirrors, undo, messages.

Without NumPy or a compiler all is skipped. Without Blender its half is, and says so, also with HEATDIFF_NO_SKIP: Blender is
150 MB of packages, which take a minute of processor time to install."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import types
import unittest

sys.dont_write_bytecode = True
TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
try:
    import bpy
except ImportError:
    bpy = None
    sys.path.insert(0, os.path.join(TOP, "examples", "blender"))
try:
    import numpy as np
except ImportError:
    if os.environ.get("HEATDIFF_NO_SKIP"):
        raise
    print("skipped: no NumPy")
    sys.exit(77)


# ---- meshes ----

def grid(nx, ny, width, height):
    """A flat sheet of squares: vertices, and quads."""
    x, y = np.meshgrid(np.linspace(0, width, nx), np.linspace(0, height, ny), indexing="ij")
    V = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    a = (np.arange(nx - 1)[:, None] * ny + np.arange(ny - 1)).ravel()
    return V, np.stack([a, a + ny, a + ny + 1, a + 1], axis=1)


def tube(n, m, radius, length):
    """A cylinder around z without lids: m rings of n vertices; quads."""
    angle = 2 * np.pi * np.arange(n) / n
    V = np.stack([np.tile(radius * np.cos(angle), m), np.tile(radius * np.sin(angle), m),
                  np.repeat(np.linspace(-length / 2, length / 2, m), n)], axis=1)
    k, i = np.meshgrid(np.arange(m - 1) * n, np.arange(n), indexing="ij")
    j = (i + 1) % n
    return V, np.stack([k + i, k + j, k + j + n, k + i + n], axis=-1).reshape(-1, 4)


def triangles(Q):
    return np.concatenate([Q[:, [0, 1, 2]], Q[:, [0, 2, 3]]])


def sphere(steps):
    """An icosahedron whose faces are divided, on the unit sphere."""
    g = (1 + 5 ** 0.5) / 2
    V = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1),
         (-g, 0, -1), (-g, 0, 1)]
    F = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
         (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(steps):
        middle, made = {}, []

        def half(a, b):
            if (min(a, b), max(a, b)) not in middle:
                middle[min(a, b), max(a, b)] = len(V)
                V.append(tuple((x + y) / 2 for x, y in zip(V[a], V[b])))
            return middle[min(a, b), max(a, b)]
        for a, b, c in F:
            d, e, f = half(a, b), half(b, c), half(c, a)
            made += [(a, d, f), (b, e, d), (c, f, e), (d, e, f)]
        F = made
    V = np.array(V, float)
    return V / np.linalg.norm(V, axis=1, keepdims=True), np.array(F)


def legendre(x, most):
    """P_0 ... P_most at x."""
    P = [np.ones_like(x), x]
    for n in range(1, most):
        P.append(((2 * n + 1) * x * P[n] - n * P[n - 1]) / (n + 1))
    return P


def step_weight(x, radius, c, half):
    """Of the bone along x > 0 on a cylinder around both with free ends at x = -half and half: -w'' + c/r^2 w = c/r^2 [x > 0]."""
    k = np.sqrt(c) / radius
    w = np.cosh(k * (half - abs(x))) / (2 * np.cosh(k * half))
    return np.where(x > 0, 1 - w, w)


BONES = np.array([[0, 0, -9.0], [0, 0, 0]]), np.array([[0, 0, 0], [0, 0, 9.0]])      # heads, tails


# ---- what is computed, without Blender ----

class Numbers(unittest.TestCase):
    def close(self, a, b, tol):
        self.assertEqual(np.shape(a), np.shape(b))
        self.assertLess(np.max(abs(np.asarray(a) - b)), tol)

    def test_geodesic(self):
        V, Q = grid(41, 21, 2, 1)
        F = triangles(Q)
        edge = np.flatnonzero(V[:, 0] == 0)
        self.close(surface.distance(V, F, edge), V[:, 0], 0.02)
        self.close(surface.distance(V, F, [0]), np.linalg.norm(V, axis=1), 0.07)          # an edge is 0.05 to 0.07
        V, F = sphere(4)
        d = surface.distance(V, F, [0])
        self.close(d, np.arccos(np.clip(V @ V[0], -1, 1)), 0.08)
        self.assertLess(abs(d - np.arccos(np.clip(V @ V[0], -1, 1))).mean(), 0.02)
        V, Q = tube(40, 41, 0.5, 3)                             # unrolled: a flat strip
        source = 20 * 40
        angle = np.arctan2(V[:, 1], V[:, 0])
        self.close(surface.distance(V, triangles(Q), [source]), np.hypot(0.5 * angle, V[:, 2] - V[source, 2]), 0.08)

    def test_diffusion(self):
        V, F = sphere(4)
        lap = surface.laplacian(V, F)
        for kind, t in (("DIFFUSION", 20.0), ("DIFFUSION", 100.0), ("BIHARMONIC", 0)):
            d = surface.distance(V, F, [5], kind, t)
            want = 0
            for n, P in enumerate(legendre(V @ V[5], 60)):
                by = n * (n + 1)
                part = np.exp(-2 * t * lap.h ** 2 * by) if t else 1 / by ** 2 if n else 0
                want = want + (2 * n + 1) / (2 * np.pi) * part * (1 - P)
            self.close(d, np.sqrt(np.maximum(want, 0)), 0.01 * np.sqrt(want.max()))

    def test_nearest_of_many(self):
        V, Q = grid(15, 15, 1, 1)
        F, some = triangles(Q), np.arange(0, 225, 3)            # two blocks of columns
        all_of_them = np.min([surface.distance(V, F, [s], "DIFFUSION", 5) for s in some], axis=0)
        self.close(surface.distance(V, F, some, "DIFFUSION", 5), all_of_them, 1e-5 * all_of_them.max())

    def test_islands(self):
        V, Q = grid(11, 11, 1, 1)
        V, Q = np.concatenate([V, V + [3, 0, 0]]), np.concatenate([Q, Q + 121])
        for kind in ("GEODESIC", "DIFFUSION", "BIHARMONIC"):
            d = surface.distance(V, triangles(Q), [3], kind)
            self.assertTrue(np.isfinite(d[:121]).all() and np.isinf(d[121:]).all())
            self.assertEqual(d[3], 0)

    def test_bones_closed_form(self):
        V, Q = tube(32, 161, 0.5, 10)
        for c in (1.0, 0.25, 4.0):
            w, said = surface.bone_weights(V, triangles(Q), *BONES, c=c)
            want = step_weight(V[:, 2], 0.5, c, 5)
            self.close(w, np.stack([1 - want, want], axis=1), 1e-3 * max(c, 1))
            self.assertEqual(said, [])
        for scale in (1e-3, 1e3):                               # no unit of length is in it
            again, _ = surface.bone_weights(scale * V, triangles(Q), *(scale * b for b in BONES), c=4.0)
            self.close(again, w, 1e-9)

    def test_bones_of_bad_meshes(self):
        """An island out of sight, a fin, a doubled face, a face without area, a needle's eye, a loose vertex: weights all the same."""
        V, Q = tube(16, 41, 0.5, 4)
        F, n = triangles(Q), len(V)
        V2, Q2 = tube(8, 5, 0.1, 1)
        V = np.concatenate([V, V2 + [3, 0, 1], [[0.8, 0, 0]], V[:1], [[9, 9, -9]]])
        F = np.concatenate([F, triangles(Q2) + n, [[5 * 16, 6 * 16, n + 40]], F[:1], [[1, 0, n + 41], [17, 17, 18]]]).astype(np.int32)
        edges = np.unique(np.concatenate([surface._edges(F), [[0, n + 41]]]), axis=0)
        w, said = surface.bone_weights(V, F, *BONES, sight=lambda points, v: v < n)
        self.close(w.sum(axis=1), np.ones(len(V)), 1e-12)
        self.assertGreaterEqual(w.min(), 0)
        self.assertEqual(said, ["1 of 2 islands see no bone from inside and follow the nearest (first: vertex %d)" % n])
        self.close(w[-1], [1, 0], 1e-12)                        # the loose vertex takes the nearest
        self.assertGreater(w[n:n + 40, 1].min(), 0.5)
        found = surface.defects(V, F, np.arange(len(F)), edges)
        self.assertIn("1 edge without length (first: vertices 0 and %d)" % (n + 41), found[0])
        self.assertIn("2 faces without area (first: face %d)" % (len(F) - 2), found[1])
        self.assertIn("with three or more faces (first: vertices", found[2])
        self.assertEqual("1 vertex in no face (first: vertex %d)" % (n + 42), found[3])

    def test_bones_at_random(self):
        """Whatever the mesh: weights in [0, 1], sum one, no failure."""
        chance = np.random.default_rng(5)
        for trial in range(60):
            n, m = chance.integers(4, 60), chance.integers(1, 9)
            V = chance.integers(-3, 4, (n, 3)) * 1.0 if trial % 2 else chance.normal(size=(n, 3))
            F = chance.integers(0, n, (chance.integers(1, 100), 3)).astype(np.int32)
            heads = chance.integers(-3, 4, (m, 3)) * 1.0
            tails = heads if trial % 7 == 0 else heads + chance.normal(size=(m, 3))
            blocked = chance.random(n) < chance.random()
            try:
                w, _ = surface.bone_weights(V, F, heads, tails, sight=lambda points, v: ~blocked[v])
            except surface.hd.InputError as error:              # nothing of the surface is left
                self.assertIn("no", str(error))
                continue
            self.close(w.sum(axis=1), np.ones(n), 1e-9)
            self.assertTrue(w.min() >= 0 and w.max() <= 1 + 1e-9)

    def test_hidden_bone(self):
        """A bone nearer than one's own, behind another sheet, has no part in it."""
        V, Q = tube(16, 41, 0.5, 4)
        heads, tails = np.array([[0, 0, -3.0], [0.8, 0, -3]]), np.array([[0, 0, 3.0], [0.8, 0, 3]])
        w, _ = surface.bone_weights(V, triangles(Q), heads, tails, sight=lambda points, v: points[:, 0] < 0.4)
        self.close(w[:, 0], np.ones(len(V)), 1e-9)
        w, _ = surface.bone_weights(V, triangles(Q), heads, tails)
        self.assertGreater(w[:, 1].max(), 0.3)

    def test_smooth(self):
        V, Q = tube(48, 61, 1.0, 6)
        F, h = triangles(Q), surface.laplacian(V, triangles(Q)).h
        W = 0.5 + 0.5 * np.stack([V[:, 0], -V[:, 0]], axis=1)    # a wave around, which the borders do not touch
        for t in (5.0, 50.0):
            fade = np.exp(-t * h ** 2)                          # of cos(angle): exp(-t / radius^2)
            self.close(surface.smooth(V, F, W, t), 0.5 + fade * (W - 0.5), 2e-3)
        self.close(surface.smooth(V, F, W, 5).sum(axis=1), np.ones(len(V)), 1e-7)

    def test_clean(self):
        W = np.array([[0.5, 0.3, 0.15, 0.05], [0.2, 0.2, 0, 0], [0.25, 0.25, 0.25, 0.25], [0, 0, 0, 0]])
        got = surface.clean(W, 0.1, 2)
        self.close(got[0], [0.625, 0.375, 0, 0], 1e-12)
        self.close(got[1], [0.2, 0.2, 0, 0], 1e-12)
        self.close(got.sum(axis=1), W.sum(axis=1), 1e-12)
        self.close(surface.clean(W, 0.6, 0)[0], [1, 0, 0, 0], 1e-12)     # the largest stays

    def test_segments(self):
        V, Q = grid(31, 4, 10, 1)
        corners, first = Q.ravel(), 4 * np.arange(len(Q))
        label = surface.segments(V, triangles(Q), corners, first, 2)
        middle = V[Q].mean(axis=1)[:, 0]
        clear = abs(middle - 5) > 0.2                           # two samples at the ends: the border is in the middle
        self.assertEqual(len(np.unique(label[clear & (middle < 5)])), 1)
        self.assertEqual(sorted(np.unique(label)), [1, 2])
        both = np.concatenate([V, V + [0, 5, 0], V + [0, 9, 0]]), np.concatenate([Q, Q + len(V), Q + 2 * len(V)])
        label = surface.segments(both[0], triangles(both[1]), both[1].ravel(), 4 * np.arange(3 * len(Q)), 1)
        self.assertEqual(sorted(np.bincount(label)[1:]), 3 * [len(Q)])

    def test_cancel(self):
        V, F = sphere(3)
        for call in (lambda p: surface.distance(V, F, [0], progress=p), lambda p: surface.smooth(V, F, V[:, :1], 5, p),
                     lambda p: surface.bone_weights(V, F, *BONES, progress=p)):
            with self.assertRaises(surface.hd.CancelledError):
                call(lambda stage, done: False)

    def test_without_scipy(self):
        """Blender brings NumPy alone."""
        code = """if True:
            import sys
            sys.modules["scipy"] = None
            import numpy as np
            from heat_on_meshes import surface
            V, F = np.eye(3), np.array([[0, 1, 2]])
            w, _ = surface.bone_weights(V, F, np.zeros((1, 3)), np.ones((1, 3)))
            assert type(surface.laplacian(V, F).L).__name__ == "CSR" and (w == 1).all()"""
        subprocess.run([sys.executable, "-c", code], check=True, env=dict(os.environ, PYTHONPATH=WORK, PYTHONDONTWRITEBYTECODE="1"))


class Zip(unittest.TestCase):
    def test_manifest(self):
        """What Blender 4.2 asks of an extension."""
        try:
            import tomllib
        except ImportError:
            self.skipTest("no tomllib: Python 3.11 has it")
        with open(os.path.join(WORK, build.NAME, "blender_manifest.toml"), "rb") as f:
            m = tomllib.load(f)
        self.assertEqual(sorted(m), sorted(["schema_version", "id", "version", "name", "tagline", "maintainer", "type", "tags",
                                            "blender_version_min", "license", "platforms"]))
        self.assertEqual((m["schema_version"], m["type"], m["id"]), ("1.0.0", "add-on", build.NAME))
        self.assertRegex(m["version"], r"^\d+\.\d+\.\d+$")
        self.assertEqual(m["version"], ".".join(build.version()))
        self.assertEqual(m["platforms"], [build.this_platform()])
        self.assertTrue(len(m["tagline"]) <= 64 and m["tagline"][-1].isalnum())
        self.assertTrue(all(x.startswith("SPDX:") for x in m["license"]))
        self.assertGreaterEqual(tuple(map(int, m["blender_version_min"].split("."))), (4, 2, 0))
        self.assertLessEqual(set(m["tags"]), {"Mesh", "Rigging", "Sculpt"})           # of Blender's list

    def test_content(self):
        import zipfile
        path = build.packed(WORK, LIBRARY)
        with zipfile.ZipFile(path) as z:
            names = z.namelist()
        self.assertEqual({n.split("/")[0] for n in names}, {build.NAME})
        library = "heatdiff/libheatdiff" + build.SUFFIX[build.this_platform().split("-")[0]]
        for n in ("__init__.py", "blender_manifest.toml", "LICENSE", "heatdiff/__init__.py", library):
            self.assertIn(build.NAME + "/" + n, names)
        self.assertFalse([n for n in names if "pycache" in n])
        self.assertEqual(path, os.path.join(WORK, "heat_on_meshes-%s-%s.zip" % (
            ".".join(build.version()), build.this_platform().replace("-", "_"))))

    def test_usage(self):
        wrong = subprocess.run([sys.executable, build.__file__, "--platform", "amiga"], stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("there is no platform amiga: they are called linux-x64", wrong.stderr)


class InBlender(unittest.TestCase):
    def test_all(self):
        blender = os.environ.get("BLENDER") or shutil.which("blender")
        if not blender:
            print("Blender is not installed: what runs inside it is not tested", file=sys.stderr)
            self.skipTest("no Blender")
        path = build.packed(WORK, LIBRARY)
        env = {k: v for k, v in os.environ.items() if k != "HEATDIFF_LIBRARY"}
        env.update(BLENDER_USER_SCRIPTS=os.path.join(WORK, "scripts"), BLENDER_USER_CONFIG=os.path.join(WORK, "config"),
                   HEAT_ZIP=path, HEAT_VERSION=".".join(build.version()))
        done = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", os.path.abspath(__file__)],
                              env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=600)
        ran = re.search(r"^Ran (\d+) tests", done.stdout, re.M)
        self.assertTrue(done.returncode == 0 and ran and int(ran.group(1)) > 15, done.stdout[-6000:])


# ---- inside Blender ----

def inside():
    import ctypes
    import bmesh
    from mathutils import Matrix
    bpy.ops.preferences.addon_install(filepath=os.environ["HEAT_ZIP"])
    bpy.ops.preferences.addon_enable(module="heat_on_meshes")
    libc, context = ctypes.CDLL(None), bpy.context

    def select(*objects):
        for ob in bpy.data.objects:
            ob.select_set(ob in objects)
        context.view_layer.objects.active = objects[0] if objects else None

    def add(name, V, faces, edges=()):
        me = bpy.data.meshes.new(name)
        me.from_pydata([tuple(v) for v in V.tolist()], [tuple(e) for e in edges], [tuple(f) for f in np.asarray(faces).tolist()])
        me.update()
        ob = bpy.data.objects.new(name, me)
        context.collection.objects.link(ob)
        select(ob)
        return ob

    def choose(ob, vertices):
        flags = np.zeros(len(ob.data.vertices), bool)
        flags[vertices] = True
        for items, width in ((ob.data.polygons, 1), (ob.data.edges, 1)):
            items.foreach_set("select", np.zeros(len(items), bool))
        ob.data.vertices.foreach_set("select", flags)

    def rig(segments, matrix=None, deform=None):
        data = bpy.data.armatures.new("Rig")
        ob = bpy.data.objects.new("Rig", data)
        context.collection.objects.link(ob)
        select(ob)
        bpy.ops.object.mode_set(mode="EDIT")
        for name, head, tail in segments:
            b = data.edit_bones.new(name)
            b.head, b.tail = head, tail
        bpy.ops.object.mode_set(mode="OBJECT")
        for b in data.bones:
            b.use_deform = deform is None or b.name in deform
        if matrix is not None:
            ob.matrix_world = matrix
            context.view_layer.update()
        return ob

    def weights(ob, name):
        g, out = ob.vertex_groups[name].index, np.zeros(len(ob.data.vertices))
        for v in ob.data.vertices:
            for x in v.groups:
                if x.group == g:
                    out[v.index] = x.weight
        return out

    def attribute(ob, name):
        a = ob.data.attributes[name].data
        out = np.zeros(len(a), np.float32)
        a.foreach_get("value", out)
        return out.astype(float)

    def said(call, *args, **options):
        """What the operator printed; errors become text too."""
        libc.fflush(None)
        sys.stdout.flush()
        keep = os.dup(1)
        with tempfile.TemporaryFile() as f:
            os.dup2(f.fileno(), 1)
            try:
                result = call(*args, **options)
            except RuntimeError as error:
                result = str(error)
            finally:
                libc.fflush(None)
                os.dup2(keep, 1)
                os.close(keep)
            f.seek(0)
            return str(result) + " " + f.read().decode()

    TWO = [("low", (0, 0, -9), (0, 0, 0)), ("high", (0, 0, 0), (0, 0, 9))]

    class Blender(unittest.TestCase):
        def setUp(self):
            if context.active_object and context.mode != "OBJECT":
                bpy.ops.object.mode_set(mode="OBJECT")
            for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.armatures):
                for x in list(kind):
                    kind.remove(x)

        def close(self, a, b, tol):
            self.assertEqual(np.shape(a), np.shape(b))
            self.assertLess(np.max(abs(np.asarray(a) - b)), tol)

        def test_version(self):
            import addon_utils
            import heat_on_meshes
            self.assertEqual(".".join(map(str, heat_on_meshes.bl_info["version"])), os.environ["HEAT_VERSION"])
            self.assertEqual(heat_on_meshes.surface.hd.__version__, os.environ["HEAT_VERSION"])
            self.assertIn("heat_on_meshes", [m.__name__ for m in addon_utils.modules()])

        def test_plane(self):
            V, Q = grid(21, 11, 2, 1)
            ob = add("sheet", V, Q)
            choose(ob, [0])
            self.assertIn("FINISHED", said(bpy.ops.heat.distance, target="ATTRIBUTE", name="d"))
            self.close(attribute(ob, "d"), np.linalg.norm(V, axis=1), 0.08)
            choose(ob, np.flatnonzero(V[:, 0] == 0))
            bpy.ops.heat.distance(target="GROUP", name="near")
            self.close(weights(ob, "near"), 1 - V[:, 0] / 2, 0.03)
            bpy.ops.heat.distance(target="GROUP", name="near", radius=0.5)
            self.close(weights(ob, "near"), np.clip(1 - V[:, 0] / 0.5, 0, 1), 0.1)
            self.assertEqual(len(ob.vertex_groups), 1)

        def test_unapplied_scale(self):
            V, Q = grid(21, 11, 1, 1)
            ob = add("sheet", V, Q)
            ob.matrix_world = Matrix.Translation((3, 4, 5)) @ Matrix.Rotation(1, 4, "X") @ Matrix.Diagonal((6, -2, 1, 1))
            context.view_layer.update()
            choose(ob, [0])
            bpy.ops.heat.distance(target="ATTRIBUTE", name="d")
            self.close(attribute(ob, "d"), np.hypot(6 * V[:, 0], 2 * V[:, 1]), 0.3)
            ob.scale = (1, 0, 1)
            context.view_layer.update()
            self.assertIn("sheet is scaled to nothing: one factor of its scale is zero", said(bpy.ops.heat.distance))

        def test_edit_mode(self):
            V, Q = grid(21, 11, 2, 1)
            ob, other = add("sheet", V, Q), add("other", V, Q)
            choose(other, [])
            select(ob)
            bpy.ops.object.mode_set(mode="EDIT")
            bm = bmesh.from_edit_mesh(ob.data)
            for v in bm.verts:
                v.select_set(v.co.x < 1e-6)
            bm.select_flush_mode()
            bmesh.update_edit_mesh(ob.data)
            bpy.ops.heat.distance(target="ATTRIBUTE", name="d")
            self.assertEqual(context.mode, "EDIT_MESH")
            bpy.ops.object.mode_set(mode="OBJECT")
            self.close(attribute(ob, "d"), V[:, 0], 0.05)

        def test_several_objects(self):
            V, Q = grid(21, 11, 2, 1)
            one, two, none = add("one", V, Q), add("two", 2 * V, Q), add("none", V, Q)
            twin = bpy.data.objects.new("twin", one.data)       # the same mesh: once
            context.collection.objects.link(twin)
            choose(one, [0])
            choose(two, [0])
            choose(none, [])
            select(one, two, none, twin)
            text = said(bpy.ops.heat.distance, target="ATTRIBUTE", name="d")
            self.assertIn("none has no selected vertex", text)
            self.assertIn("FINISHED", text)
            self.close(2 * attribute(one, "d"), attribute(two, "d"), 1e-5)
            self.assertNotIn("d", none.data.attributes)

        def test_faces_of_many_corners(self):
            """A hexagon with a dent, a quad and a triangle: the triangles are Blender's, which stay inside."""
            V = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 1, 0], [0, 2, 0], [0, 1, 0], [3, 0, 0], [3, 2, 0], [4, 1, 0]], float)
            ob = add("plan", V, np.zeros((0, 3)))
            me = ob.data
            me.clear_geometry()
            me.from_pydata(V.tolist(), [], [(0, 1, 2, 3, 4, 5), (1, 6, 7, 2), (6, 8, 7)])
            bpy.ops.object.mode_set(mode="EDIT")
            bpy.ops.mesh.subdivide(number_cuts=1)
            bpy.ops.object.mode_set(mode="OBJECT")
            choose(ob, [0])
            bpy.ops.heat.distance(target="ATTRIBUTE", name="d")
            self.assertLess(abs(attribute(ob, "d")[6] - 3), 0.4)
            self.assertEqual(attribute(ob, "d")[0], 0)

        def test_modifiers(self):
            V, Q = grid(21, 11, 2, 1)
            ob = add("sheet", V, Q)
            g = ob.vertex_groups.new(name="x")
            for k, v in enumerate(V):
                g.add([k], v[0] / 2, "REPLACE")
            m = ob.modifiers.new("tilt", "DISPLACE")            # z = 3 x
            m.direction, m.strength, m.mid_level, m.vertex_group = "Z", 6, 0, "x"
            choose(ob, np.flatnonzero(V[:, 0] == 0))
            bpy.ops.heat.distance(target="ATTRIBUTE", name="d")
            self.close(attribute(ob, "d"), V[:, 0], 0.05)
            bpy.ops.heat.distance(target="ATTRIBUTE", name="d", use_modifiers=True)
            self.close(attribute(ob, "d"), np.sqrt(10) * V[:, 0], 0.15)
            ob.modifiers.new("fine", "SUBSURF").levels = 1
            text = said(bpy.ops.heat.distance, use_modifiers=True)
            self.assertIn("sheet has modifiers that change its 231 vertices to 861; apply them, or switch Modifiers off", text)

        def test_islands(self):
            V, Q = grid(6, 6, 1, 1)
            ob = add("two", np.concatenate([V, V + [2, 0, 0]]), np.concatenate([Q, Q + 36]))
            choose(ob, [3])
            text = said(bpy.ops.heat.distance, kind="DIFFUSION", t=3, target="ATTRIBUTE", name="d")
            self.assertIn("two: 36 vertices are on islands without a selected vertex (first: vertex 36)", text)
            self.assertTrue((attribute(ob, "d")[36:] == -1).all() and (attribute(ob, "d")[:36] >= 0).all())
            bpy.ops.heat.distance(kind="BIHARMONIC", name="g")
            self.assertEqual(weights(ob, "g")[36:].max(), 0)

        def test_refusals(self):
            V, Q = grid(6, 6, 1, 1)
            ob = add("sheet", V, Q)
            choose(ob, [])
            self.assertIn("sheet has no selected vertex", said(bpy.ops.heat.distance))
            choose(ob, [0])
            self.assertIn("needs a name", said(bpy.ops.heat.distance, name=""))
            ob.data.attributes.new("faces", "INT", "FACE")
            self.assertIn("has an attribute faces already, of another kind", said(bpy.ops.heat.distance, target="ATTRIBUTE", name="faces"))
            g = ob.vertex_groups.new(name="kept")
            g.add([2], 0.25, "REPLACE")
            g.lock_weight = True
            ob.vertex_groups.new(name="both")
            self.assertIn("has a vertex group both already: the attribute needs another name",
                          said(bpy.ops.heat.distance, target="ATTRIBUTE", name="both"))
            ob.vertex_groups.remove(ob.vertex_groups["both"])
            bpy.ops.heat.distance(target="ATTRIBUTE", name="field")
            self.assertIn("has an attribute field already: the group needs another name", said(bpy.ops.heat.distance, name="field"))
            self.assertRegex(said(bpy.ops.heat.distance, target="ATTRIBUTE", name="position"), "sheet (has|cannot have) an attribute position")
            self.assertIn("sheet has a locked group kept", said(bpy.ops.heat.distance, name="kept"))
            self.assertEqual(weights(ob, "kept").sum(), 0.25)
            self.assertIn("sheet has no vertex group that is not locked", said(bpy.ops.heat.smooth_weights))
            self.assertIn("poll() failed", said(bpy.ops.heat.bone_weights))
            arm = rig(TWO, deform=[])
            select(arm, ob)
            self.assertIn("has no bones to follow: none of Rig deforms", said(bpy.ops.heat.bone_weights))
            ob.data.vertices[7].co.x = float("nan")
            select(ob)
            self.assertIn("vertex 7", said(bpy.ops.heat.distance))
            points = add("points", V, np.zeros((0, 3)))
            choose(points, [0])
            self.assertIn("points has no faces", said(bpy.ops.heat.distance))
            select()
            self.assertIn("poll() failed", said(bpy.ops.heat.distance))

        def test_bones(self):
            V, Q = tube(24, 121, 0.5, 8)
            ob, want = add("arm", V, Q), step_weight(V[:, 2], 0.5, 1, 4)
            select(rig(TWO), ob)
            self.assertIn("FINISHED", said(bpy.ops.heat.bone_weights, least=0, most=0))
            self.close(weights(ob, "high"), want, 3e-3)
            self.close(weights(ob, "low"), 1 - want, 3e-3)
            self.assertEqual([(m.type, m.object.name) for m in ob.modifiers], [("ARMATURE", "Rig")])
            bpy.ops.heat.bone_weights(least=0, most=0, falloff=4)
            self.close(weights(ob, "high"), step_weight(V[:, 2], 0.5, 4, 4), 3e-3)
            self.assertEqual(len(ob.modifiers), 1)
            bpy.ops.heat.bone_weights(least=0.05)
            self.close(weights(ob, "high") + weights(ob, "low"), np.ones(len(V)), 1e-6)
            self.assertFalse(((weights(ob, "high") > 0) & (weights(ob, "high") < 0.05)).any())
            self.assertTrue(any(len(v.groups) == 1 for v in ob.data.vertices))

        def test_bones_in_scaled_objects(self):
            V, Q = tube(24, 121, 0.5, 8)
            ob = add("arm", V / 3 + [7, 0, 0], Q)
            ob.matrix_world = Matrix.Diagonal((3, 3, 3, 1)) @ Matrix.Translation((-7, 0, 0))
            select(rig([(n, np.array(a) / 5, np.array(b) / 5) for n, a, b in TWO], Matrix.Scale(5, 4)), ob)
            bpy.ops.heat.bone_weights(least=0, most=0)
            self.close(weights(ob, "high"), step_weight(V[:, 2], 0.5, 1, 4), 3e-3)

        def test_locked_groups(self):
            V, Q = tube(12, 41, 0.5, 6)
            ob = add("arm", V, Q)
            kept = np.where(V[:, 0] > 0, 0.3, 0)
            g = ob.vertex_groups.new(name="low")
            for k in range(len(V)):
                g.add([k], kept[k], "REPLACE")
            g.lock_weight = True
            select(rig(TWO + [("third", (0, 0, 3), (0, 0, 9))]), ob)
            bpy.ops.heat.bone_weights()
            self.close(weights(ob, "low"), kept, 1e-7)
            self.close(weights(ob, "low") + weights(ob, "high") + weights(ob, "third"), np.ones(len(V)), 1e-6)
            ob.vertex_groups["high"].lock_weight = True
            before = weights(ob, "high")
            bpy.ops.heat.smooth_weights(t=5)
            self.close(weights(ob, "high"), before, 0 + 1e-12)
            self.close(weights(ob, "low"), kept, 1e-7)

        def test_selected_bones(self):
            V, Q = tube(12, 41, 0.5, 6)
            ob, arm = add("arm", V, Q), rig(TWO + [("third", (0, 0, 2), (0, 0, 9))])
            select(arm, ob)
            bpy.ops.heat.bone_weights()
            kept = weights(ob, "low")
            g = ob.vertex_groups["high"]
            g.remove(list(range(len(V))))
            bpy.ops.object.mode_set(mode="POSE")
            for b in arm.data.bones:
                b.select = b.name == "high"
            bpy.ops.heat.bone_weights(only_selected=True, least=0)
            self.assertEqual(context.mode, "POSE")
            self.close(weights(ob, "low"), kept, 1e-7)
            self.close(sum(weights(ob, name) for name in ("low", "high", "third")), np.ones(len(V)), 1e-6)
            for b in arm.data.bones:
                b.select = False
            self.assertIn("the groups of all selected bones are locked", said(bpy.ops.heat.bone_weights, only_selected=True))
            bpy.ops.object.mode_set(mode="OBJECT")

        def test_weight_paint(self):
            V, Q = tube(12, 41, 0.5, 6)
            ob = add("arm", V, Q)
            select(rig(TWO), ob)
            bpy.ops.heat.bone_weights()
            before = weights(ob, "low")
            select(ob)
            bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
            self.assertIn("FINISHED", said(bpy.ops.heat.smooth_weights, t=10))
            self.assertEqual(context.mode, "PAINT_WEIGHT")
            bpy.ops.object.mode_set(mode="OBJECT")
            self.assertGreater(abs(weights(ob, "low") - before).max(), 0.005)
            self.close(weights(ob, "low") + weights(ob, "high"), np.ones(len(V)), 1e-6)

        def test_bad_mesh(self):
            """What bone heat of Blender fails on: an island that no bone is in, faces through each other, a fin, no area."""
            V, Q = tube(16, 41, 0.5, 6)
            n = len(V)
            V = np.concatenate([V, V[:1], [[0.9, 0, 0], [4, 0, 1], [4, 1, 1], [4, 0, 2], [5, 5, 5]]])
            faces = [*map(tuple, Q), (0, 1, n), (16 * 5, 16 * 6, n + 1), (n + 2, n + 3, n + 4)]
            ob = add("bad", V, np.zeros((0, 3)))
            ob.data.clear_geometry()
            ob.data.from_pydata(V.tolist(), [(0, n)], faces)
            arm = rig(TWO)
            select(arm, ob)
            self.assertIn("failed to find solution", said(bpy.ops.object.parent_set, type="ARMATURE_AUTO"))
            self.assertEqual(weights(ob, "low").max() + weights(ob, "high").max(), 0)
            text = said(bpy.ops.heat.bone_weights)
            self.assertIn("FINISHED", text)
            for line in ("bad: 1 edge without length (first: vertices 0 and %d)" % n, "bad: 1 face without area (first: face %d)" % len(Q),
                         "edge with three or more faces (first: vertices 80 and 96)", "bad: 1 vertex in no face (first: vertex %d)" % (n + 5),
                         "bad: 1 of 2 islands see no bone from inside and follow the nearest (first: vertex %d)" % (n + 2)):
                self.assertIn(line, text)
            self.close(weights(ob, "low") + weights(ob, "high"), np.ones(len(V)), 1e-6)
            self.close(weights(ob, "high")[n + 2:], np.ones(4), 1e-6)

        def test_two_legs(self):
            """The bone of the other leg is nearer to the inner side than one's own, and cannot be seen from there."""
            V, Q = tube(16, 41, 0.5, 6)
            ob = add("legs", np.concatenate([V, V + [1.02, 0, 0]]), np.concatenate([Q, Q + len(V)]))
            bones = [("leg.L", (-0.3, 0, -3), (-0.3, 0, 3)), ("leg.R", (0.62, 0, -3), (0.62, 0, 3))]
            select(rig(bones), ob)
            bpy.ops.heat.bone_weights()
            self.close(weights(ob, "leg.L")[:len(V)], np.ones(len(V)), 1e-5)
            self.close(weights(ob, "leg.R")[len(V):], np.ones(len(V)), 1e-5)
            bpy.ops.heat.bone_weights(visible=False)
            self.assertGreater(weights(ob, "leg.R")[:len(V)].max(), 0.5)

        def test_mirror(self):
            """Half a tube along x behind a Mirror modifier: what the whole tube gets."""
            V, Q = tube(16, 81, 0.5, 8)
            V = V[:, [2, 0, 1]]
            V[abs(V[:, 0]) < 1e-9, 0] = 0
            right = V[:, 0] >= 0
            ids = np.cumsum(right) - 1
            half = add("half", V[right], ids[Q[right[Q].all(axis=1)]])
            half.modifiers.new("Mirror", "MIRROR")
            bones = [("arm.L", (0, 0, 0), (9, 0, 0)), ("arm.R", (-9, 0, 0), (0, 0, 0))]
            select(rig(bones), half)
            bpy.ops.heat.bone_weights(least=0, most=0)
            self.close(weights(half, "arm.L"), step_weight(V[right, 0], 0.5, 1, 4), 3e-3)
            self.assertLess(abs(weights(half, "arm.R")[V[right, 0] == 0] - 0.5).max(), 1e-3)

        def test_smooth(self):
            V, Q = tube(48, 41, 1, 6)
            ob = add("arm", V, Q)
            before = 0.5 + 0.4 * V[:, 0]
            for name, w in (("a", before), ("b", 1 - before)):
                g = ob.vertex_groups.new(name=name)
                for k in range(len(V)):
                    g.add([k], float(w[k]), "REPLACE")
            F = triangles(Q)
            edges = np.unique(np.sort(F[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
            h = np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1).mean()
            bpy.ops.heat.smooth_weights(t=20)
            self.close(weights(ob, "a"), 0.5 + 0.4 * V[:, 0] * np.exp(-20 * h ** 2), 0.01)
            self.close(weights(ob, "a") + weights(ob, "b"), np.ones(len(V)), 1e-6)
            choose(ob, np.flatnonzero(V[:, 0] > 0))
            before = weights(ob, "a")
            bpy.ops.heat.smooth_weights(t=20, only_selected=True)
            self.assertEqual(abs(weights(ob, "a") - before)[V[:, 0] <= 0].max(), 0)
            self.assertGreater(abs(weights(ob, "a") - before)[V[:, 0] > 0.5].min(), 0.01)
            ob.vertex_groups.active_index = 1
            before, other = weights(ob, "a"), weights(ob, "b")
            bpy.ops.heat.smooth_weights(t=20, all_groups=False)
            self.assertEqual(abs(weights(ob, "a") - before).max(), 0)
            self.assertGreater(abs(weights(ob, "b") - other).max(), 0.01)

        def test_face_sets(self):
            V, Q = grid(41, 5, 10, 1)
            ob = add("strip", V, Q)
            bpy.ops.heat.face_sets(count=2, name="part")
            label, middle = attribute(ob, "part"), V[Q].mean(axis=1)[:, 0]
            for side in (middle < 4.8, middle > 5.2):
                self.assertEqual(len(set(label[side])), 1)
            self.assertEqual(set(label), {1, 2})
            self.assertEqual(list(attribute(ob, ".sculpt_face_set")), list(label))
            choose(ob, [0, 2, 204])                             # two in a corner, one at the other end
            bpy.ops.heat.face_sets(from_selected=True, name="part")
            self.assertEqual(len(set(attribute(ob, "part"))), 3)
            self.assertEqual(set(attribute(ob, "part")[middle > 5.3]), {attribute(ob, "part")[-1]})
            choose(ob, [])
            self.assertIn("strip has no selected vertex", said(bpy.ops.heat.face_sets, from_selected=True))
            two = add("two", np.concatenate([V, V + [0, 3, 0]]), np.concatenate([Q, Q + len(V)]))
            self.assertIn("two: 2 face sets", said(bpy.ops.heat.face_sets, count=1))

        def test_undo(self):
            V, Q = grid(6, 6, 1, 1)
            add("sheet", V, Q)
            choose(bpy.data.objects["sheet"], [0])
            bpy.ops.ed.undo_push(message="before")
            bpy.ops.heat.distance("EXEC_DEFAULT", True, name="new")
            self.assertIn("new", bpy.data.objects["sheet"].vertex_groups)
            bpy.ops.ed.undo()
            self.assertEqual(len(bpy.data.objects["sheet"].vertex_groups), 0)
            bpy.ops.ed.redo()
            self.assertIn("new", bpy.data.objects["sheet"].vertex_groups)
            bpy.ops.object.mode_set(mode="EDIT")
            bpy.ops.ed.undo_push(message="edit")
            bpy.ops.heat.distance("EXEC_DEFAULT", True, name="newer")
            bpy.ops.ed.undo()                                   # an empty group stays, as after Blender's own "Assign to New Group"
            bpy.ops.object.mode_set(mode="OBJECT")
            self.assertEqual(weights(bpy.data.objects["sheet"], "newer").max(), 0)
            self.assertEqual(weights(bpy.data.objects["sheet"], "new").max(), 1)

        def test_esc(self):
            """The part of an operator that works behind the window, with the window's events made by hand."""
            from heat_on_meshes import operators
            V, Q = grid(6, 6, 1, 1)
            ob, reports, asked = add("sheet", V, Q), [], []

            class Hand(operators.Work):
                bl_label = "Hand"

                def read(self, context, ob):
                    def task(progress):
                        while progress("waiting", 0.5):
                            asked.append(1)
                        raise operators.hd.CancelledError("HD_ERR_CANCELLED", "cancelled")
                    return task

                def report(self, kind, text):
                    reports.append(text)

            shown, hand = [], Hand()
            place = types.SimpleNamespace(
                mode="OBJECT", active_object=ob, selected_objects=[ob], window=None,
                window_manager=types.SimpleNamespace(event_timer_add=lambda *a, **k: 1, event_timer_remove=shown.append,
                                                     modal_handler_add=shown.append),
                workspace=types.SimpleNamespace(status_text_set=shown.append))
            operators.MODAL_FROM, before = 0, operators.MODAL_FROM
            real, operators.bpy = operators.bpy, types.SimpleNamespace(app=types.SimpleNamespace(background=False))
            try:
                self.assertEqual(hand.invoke(place, None), {"RUNNING_MODAL"})
                while not asked:
                    pass
                self.assertEqual(hand.modal(place, types.SimpleNamespace(type="TIMER")), {"RUNNING_MODAL"})
                self.assertIn("Hand: waiting 50 %. Esc cancels", shown)
                answer = {"RUNNING_MODAL"}
                while answer == {"RUNNING_MODAL"}:
                    answer = hand.modal(place, types.SimpleNamespace(type="ESC"))
            finally:
                operators.MODAL_FROM, operators.bpy = before, real
            self.assertEqual((answer, reports), ({"CANCELLED"}, ["cancelled, nothing has changed"]))
            self.assertFalse(hand.thread.is_alive())

        def test_off_and_on(self):
            bpy.ops.preferences.addon_disable(module="heat_on_meshes")
            self.assertFalse(hasattr(bpy.types, "HEAT_OT_distance"))
            bpy.ops.preferences.addon_enable(module="heat_on_meshes")
            self.assertTrue(hasattr(bpy.types, "HEAT_OT_distance"))

    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromTestCase(Blender))
    sys.exit(not result.wasSuccessful())


if bpy:
    inside()
elif __name__ == "__main__":
    import build
    with tempfile.TemporaryDirectory() as WORK:
        LIBRARY = os.environ.pop("HEATDIFF_LIBRARY", None)
        if not LIBRARY:
            LIBRARY = os.path.join(WORK, "libheatdiff.so")
            if os.name == "nt" or not shutil.which(os.environ.get("CC", "cc")):
                print("skipped: no compiler")
                sys.exit(1 if os.environ.get("HEATDIFF_NO_SKIP") else 77)
            build.compiled(LIBRARY)
        build.folder(WORK, LIBRARY)
        sys.path.insert(0, WORK)
        from heat_on_meshes import surface
        unittest.main()
