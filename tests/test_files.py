#!/usr/bin/env python3
"""The tool's files, read by the programs that people open them with: test_files.py TOOL [unittest options].

Writes .ply, .obj and .vtu with 1, 4 and 16 columns, for triangles, polygons and points, and reads them with VTK (which ParaView
reads with) and meshio. Counts, coordinates, names and values must be those of the .npy of the same run. Shapes alone are also
written as .off and .stl. Programs that are not installed are skipped (Debian: python3-vtk9, python3-meshio)."""
import math
import os
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
try:
    import numpy
except ImportError:
    numpy = None
try:
    import meshio
except ImportError:
    meshio = None
try:
    import vtkmodules.all as vtk
    from vtkmodules.util.numpy_support import vtk_to_numpy
except ImportError:
    vtk = None

TOOL = None
COLUMNS = (1, 4, 16)


def place(i, j):
    return (i / 7, j / 6, 0.2 * math.sin(i + 2 * j))


def grid(columns, rows):
    return [place(i, j) for j in range(rows) for i in range(columns)]


def meshes():
    """Name -> (points, faces): triangles, polygons with 3 to 6 corners, quadrilaterals, points alone.

    The numbers of points are those with which meshio 5.0 stumbles over four equal arrays in the order of their tags.
    """
    n, m = 10, 8                                                # 80, as 200 below: one less than a multiple of three
    quads = [[j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i] for j in range(m - 1) for i in range(n - 1)]
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    mixed = []
    for j in range(m - 1):
        row = quads[j * (n - 1):(j + 1) * (n - 1)]
        a, b = row[0], row[1]                                   # two quads make a hexagon
        mixed.append([a[0], a[1], b[1], b[2], b[3], a[3]])
        c = row[2]
        mixed += [[c[0], c[1], c[2]], [c[0], c[2], c[3]]]
        mixed += row[3:]
    return {"triangles": (grid(n, m), triangles), "polygons": (grid(n, m), mixed), "quads": (grid(n, m), quads), "points": (grid(20, 10), [])}


def obj_text(points, faces):
    return "".join("v %.17g %.17g %.17g\n" % p for p in points) + "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces)


def arguments(columns):
    """Columns of the kernel: sources times times."""
    sources = {1: 1, 4: 4, 16: 4}[columns]
    return ["--source", ",".join(str(5 * s) for s in range(sources)), "--t", ",".join("%dh2" % (2 + t) for t in range(columns // sources))]


def absent(what):
    """Ends a test for want of a program; where nothing may be skipped it fails."""
    raise (AssertionError if os.environ.get("HEATDIFF_NO_SKIP") else unittest.SkipTest)(what)


FOLDER = tempfile.TemporaryDirectory()
MESHES = meshes()


def setUpModule():
    for name, (points, faces) in MESHES.items():
        with open(os.path.join(FOLDER.name, name + ".obj"), "w") as f:
            f.write(obj_text(points, faces))


class Files(unittest.TestCase):
    def write(self, name, columns, extension):
        """Each file once, for both readers."""
        out = os.path.join(FOLDER.name, "%s-%d%s" % (name, columns, extension))
        mesh = os.path.join(FOLDER.name, name + ".obj")
        if not os.path.exists(out):
            subprocess.run([TOOL, "kernel"] + arguments(columns) + [mesh, "-o", out, "--quiet"], check=True)
        return out

    def cases(self, extension, names=None):
        """Each file, with what it must hold: points, faces, values [n, columns], names of the columns."""
        for name, (points, faces) in MESHES.items():
            for columns in COLUMNS:
                if names and name not in names:
                    continue
                values = numpy.load(self.write(name, columns, ".npy"))
                self.assertEqual(values.shape, (len(points), columns))
                with open(self.write(name, columns, ".csv")) as f:
                    header = f.readline().strip().split(",")
                self.assertEqual(len(set(header)), columns)
                yield self.write(name, columns, extension), numpy.array(points), faces, values, header

    def same(self, got, want, tolerance=0.0):
        got, want = numpy.asarray(got), numpy.asarray(want)
        self.assertEqual(got.shape, want.shape)
        self.assertLessEqual(abs(got - want).max(), tolerance)
        self.assertLessEqual(abs(numpy.array([got.min() - want.min(), got.max() - want.max()])).max(), tolerance)


class Meshio(Files):
    def setUp(self):
        if not numpy or not meshio:
            absent("no NumPy or no meshio")

    def faces(self, mesh):
        """Faces by their corners, sorted; vertex cells are no faces."""
        return sorted(list(map(int, f)) for block in mesh.cells if block.type != "vertex" for f in block.data)

    def test_vtu(self):
        for path, points, faces, values, names in self.cases(".vtu"):
            with self.subTest(os.path.basename(path)):
                mesh = meshio.read(path)
                self.same(mesh.points, points)
                self.assertEqual(self.faces(mesh), sorted(faces))
                self.assertEqual([k for k in mesh.point_data if k != "RGB"], names)
                for c, name in enumerate(names):
                    self.same(mesh.point_data[name], values[:, c])
                if not faces:
                    self.assertEqual(sum(len(b.data) for b in mesh.cells if b.type == "vertex"), len(points))

    def test_ply(self):
        for path, points, faces, values, names in self.cases(".ply"):
            with self.subTest(os.path.basename(path)):
                mesh = meshio.read(path)
                self.same(mesh.points, points)
                self.assertEqual(self.faces(mesh), sorted(faces))
                for c in range(values.shape[1]):
                    self.same(mesh.point_data["quality" + ("_%d" % c if c else "")], values[:, c])
                for colour in ("red", "green", "blue"):
                    self.assertEqual(mesh.point_data[colour].shape, (len(points),))

    def test_obj(self):
        for path, points, faces, values, names in self.cases(".obj", ("triangles",)):   # meshio knows no other faces in OBJ
            with self.subTest(os.path.basename(path)):
                mesh = meshio.read(path)
                self.same(mesh.points[:, :3], points, 1e-15)
                self.assertEqual(self.faces(mesh), sorted(faces))


    def test_shapes(self):
        """.off and .stl, of which meshio knows triangles alone; .stl has 32 bits, and the same order of faces."""
        points, faces = MESHES["triangles"]
        for extension, most in (".off", 0), (".stl", 1e-7):
            out = os.path.join(FOLDER.name, "shape" + extension)
            subprocess.run([TOOL, "smooth", "--t", "0", os.path.join(FOLDER.name, "triangles.obj"), "-o", out, "--quiet"], check=True)
            mesh = meshio.read(out)
            self.same(mesh.points[mesh.cells[0].data], numpy.array(points)[faces], most)


class Vtk(Files):
    def setUp(self):
        if not numpy or not vtk:
            absent("no NumPy or no VTK")

    def read(self, reader, path):
        reader.SetFileName(path)
        reader.Update()
        self.assertEqual(reader.GetErrorCode(), 0)
        return reader.GetOutput()

    def faces(self, data):
        found = []
        for i in range(data.GetNumberOfCells()):
            cell = data.GetCell(i)
            if cell.GetCellDimension() == 2:
                found.append([cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())])
        return found

    def test_vtu(self):
        for path, points, faces, values, names in self.cases(".vtu"):
            with self.subTest(os.path.basename(path)):
                data = self.read(vtk.vtkXMLUnstructuredGridReader(), path)
                self.same(vtk_to_numpy(data.GetPoints().GetData()), points)
                self.assertEqual(self.faces(data), faces)
                self.assertEqual(data.GetNumberOfCells(), len(faces) or len(points))
                arrays = data.GetPointData()
                self.assertEqual(arrays.GetScalars().GetName(), names[0])
                for c, name in enumerate(names):
                    self.same(vtk_to_numpy(arrays.GetArray(name)), values[:, c])
                    self.assertEqual(arrays.GetArray(name).GetRange(), (values[:, c].min(), values[:, c].max()))

    def test_ply(self):
        for path, points, faces, values, names in self.cases(".ply"):
            with self.subTest(os.path.basename(path)):
                data = self.read(vtk.vtkPLYReader(), path)
                self.same(vtk_to_numpy(data.GetPoints().GetData()), points.astype("f"))   # it keeps floats
                self.assertEqual(self.faces(data), faces)
                self.same(vtk_to_numpy(data.GetPointData().GetArray("RGB")).shape, (len(points), 3))

    def test_obj(self):
        for path, points, faces, values, names in self.cases(".obj"):
            with self.subTest(os.path.basename(path)):
                data = self.read(vtk.vtkOBJReader(), path)
                self.same(vtk_to_numpy(data.GetPoints().GetData()), points.astype("f"))
                self.assertEqual(self.faces(data), faces)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("test_files.py TOOL [unittest options]")
    TOOL = os.path.abspath(sys.argv.pop(1))
    unittest.main(testRunner=unittest.TextTestRunner(stream=sys.stdout))
