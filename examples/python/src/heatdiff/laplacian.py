"""Surfaces as pairs of matrices (L, B)."""
from __future__ import annotations

import collections
import ctypes
import re
from types import SimpleNamespace
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _bindings as c
from . import arrays
from ._library import NAMES, Context, Handle, Object, Progress, attach, call, plain

Times = Union[float, str, Sequence[Union[float, str]], np.ndarray]
CSR = collections.namedtuple("CSR", "data indices indptr")
CSR.__doc__ = "A matrix by rows, where SciPy is missing."
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(h2|/l1)?$")


def mesh_struct(shape: str, vertices: Optional[np.ndarray], n: int, faces: Any = None, ptr: Any = None, lengths: Any = None) -> Any:
    """The struct of a mesh, which keeps the arrays."""
    mesh = c.hd_mesh(shape=c.CHOICES["hd_shape"][shape], n=n)
    found = {"xyz": vertices, "corner": faces, "face_ptr": ptr, "lengths": lengths}
    attach(mesh, **{name: a for name, a in found.items() if a is not None})
    if faces is not None:
        mesh.n_faces = len(faces) if ptr is None else len(ptr) - 1
    return mesh


def triangles(faces: Any, name: str = "faces") -> np.ndarray:
    """(m, 3), with a word for those who have other faces, or none."""
    if none(faces):
        raise ValueError(f"{name} is empty: from_points takes points without faces")
    try:
        shape = np.shape(faces)
    except ValueError:                                          # lists of several lengths
        shape = ()
    if len(shape) == 2 and shape[1] > 3:
        raise ValueError(f"{name} has shape {shape}, wanted is (m, 3): from_polygons takes faces with more corners")
    return arrays.ints(name, faces, ("m", 3))


def none(faces: Any) -> bool:
    """None or empty: points without faces."""
    try:
        return faces is None or len(faces) == 0
    except TypeError:                                           # a number, which others refuse
        return False


def surface(vertices: Any, faces: Any) -> Tuple[Any, str, int]:
    """A mesh struct of triangles, polygons or points, as faces are; the shape, and the number of vertices."""
    xyz = arrays.positions("vertices", vertices)
    if none(faces):
        return mesh_struct("points", xyz, len(xyz)), "points", len(xyz)
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
        return mesh_struct("triangles", xyz, len(xyz), arrays.ints("faces", faces, ("m", 3))), "triangles", len(xyz)
    ptr, corner = arrays.faces("faces", faces)
    if len(ptr) > 1 and (np.diff(ptr) == 3).all():
        return mesh_struct("triangles", xyz, len(xyz), corner.reshape(-1, 3)), "triangles", len(xyz)
    return mesh_struct("polygons", xyz, len(xyz), corner, ptr), "polygons", len(xyz)


class Laplacian(Object):
    """The pair of matrices (L, B) of a surface: L has no unit and is positive semi-definite (minus libigl's cotangent
    matrix), B is an area. Make one with from_mesh, from_polygons, from_points, from_lengths or from_matrices.

    Ids begin at 0. Faces that cannot be used are left out and counted in .mesh, vertices without mass keep their values,
    several components and non-manifold edges are allowed.

    Common options
      held          vertices whose value is held at zero, so that heat flows out there
      updatable     True: update() may be called, at the price of memory
      threads       that work at the same time; None or 0: as many as there are processors
      memory_limit  bytes at most for this object, and for each plan made from it; None or 0: no limit
      progress      True: a bar by tqdm. Or a function of (stage, done), with done from 0 to 1, that returns False to cancel
    """

    _n: int
    _first: Tuple[int, float]                                   # version, and what _longest found

    def __init__(self, *_: Any, **__: Any) -> None:
        raise TypeError("a Laplacian comes from from_mesh, from_polygons, from_points, from_lengths or from_matrices")

    @classmethod
    def _make(cls, function: str, args: Sequence[Any], n: int, kind: int, held: Any, updatable: bool, context: Context,
              **more: Any) -> "Laplacian":
        lap = cls.__new__(cls)
        opts = c.hd_laplacian_opts(kind=kind, updatable=arrays.integer("updatable", updatable, 0, 1),
                                   context=ctypes.pointer(context.struct), **more)
        if held is not None:
            held = arrays.vertices("held", held)
            attach(opts, held=held)
            opts.n_held = len(held)
        lap._handle = Handle(c.hd_laplacian, "hd_laplacian_free", context)
        lap._handle.make(function, *args, ctypes.byref(opts))
        lap._n, lap._first = n, (-1, 0.0)
        return lap

    @classmethod
    @arrays.options
    def from_mesh(cls, vertices: Any, faces: Any, *, kind: str = "fem", triangulation: str = "given", mollify: float = 0.0,
                  border: str = "natural", held: Any = None, updatable: bool = False, threads: Optional[int] = None,
                  memory_limit: Optional[int] = None, progress: Progress = None) -> "Laplacian":
        """Of triangles.

        vertices       (n, 3) coordinates
        faces          (m, 3) vertex ids
        kind           'fem': cotangents, B of linear finite elements. 'voronoi-cot': B diagonal. 'cot': B = 1, t is a number
        triangulation  'given'. 'delaunay': edges are flipped, no negative weight but at borders. 'tufted': none at all
        mollify        of the latter two: how much edges are lengthened, in parts of their mean; 0: 1e-5, negative: not
        border         'natural': no heat leaves. 'dirichlet': it is held at zero
        """
        xyz, faces = arrays.positions("vertices", vertices), triangles(faces)
        mesh = mesh_struct("triangles", xyz, len(xyz), faces)
        return cls._make("hd_laplacian_create", [ctypes.byref(mesh)], len(xyz),
                         arrays.choice("kind", kind, "hd_laplacian_kind", ("default", "polygon", "voronoi-exp", "exp", "matrices")),
                         held, updatable, Context(threads, memory_limit, progress), mollify=arrays.number("mollify", mollify),
                         triangulation=arrays.choice("triangulation", triangulation, "hd_triangulation"),
                         border=arrays.choice("border", border, "hd_border"))

    @classmethod
    @arrays.options
    def from_polygons(cls, vertices: Any, faces: Any, *, kind: str = "polygon", stiffening: float = 0.0,
                      triangulation: str = "given", mollify: float = 0.0, border: str = "natural", held: Any = None,
                      updatable: bool = False, threads: Optional[int] = None, memory_limit: Optional[int] = None,
                      progress: Progress = None) -> "Laplacian":
        """Of faces with any number of corners, planar or not (Alexa, Wardetzky 2011).

        vertices     (n, 3) coordinates
        faces        lists of vertex ids, or (m, k)
        kind         'polygon': B is diagonal. 'fem', 'voronoi-cot', 'cot': every face is split into triangles
        stiffening   weight of the stabilising term of 'polygon'; 0: 1. Triangles do not feel it
        The others: as in from_mesh."""
        xyz, (ptr, corner) = arrays.positions("vertices", vertices), arrays.faces("faces", faces)
        mesh = mesh_struct("polygons", xyz, len(xyz), corner, ptr)
        return cls._make("hd_laplacian_create", [ctypes.byref(mesh)], len(xyz),
                         arrays.choice("kind", kind, "hd_laplacian_kind", ("default", "voronoi-exp", "exp", "matrices")),
                         held, updatable, Context(threads, memory_limit, progress), mollify=arrays.number("mollify", mollify),
                         stiffening=arrays.number("stiffening", stiffening),
                         triangulation=arrays.choice("triangulation", triangulation, "hd_triangulation"),
                         border=arrays.choice("border", border, "hd_border"))

    @classmethod
    @arrays.options
    def from_points(cls, points: Any, *, kind: Optional[str] = None, triangulation: str = "given", neighbours: int = 0,
                    bandwidth2: float = 0.0, weight_cut: float = 0.0, mollify: float = 0.0, held: Any = None,
                    threads: Optional[int] = None, memory_limit: Optional[int] = None, progress: Progress = None) -> "Laplacian":
        """Of points without faces.

        points         (n, 3) coordinates
        triangulation  'given': exponential weights of all near points. 'tufted': triangles from neighbours (Sharp, Crane
                       2020), which is faster, and on smooth surfaces more accurate
        kind           'voronoi-exp' or 'exp' (B = 1); tufted: 'fem', 'voronoi-cot' or 'cot'. None: the first
        neighbours     6 to 128 nearest ones that determine tangent planes; 0: 30
        bandwidth2     of exponential weights, length^2; 0: from the sampling
        weight_cut     exponentials below this are left out; 0: 1e-8
        The others: as in from_mesh."""
        xyz = arrays.positions("points", points)
        mesh = mesh_struct("points", xyz, len(xyz))
        return cls._make("hd_laplacian_create", [ctypes.byref(mesh)], len(xyz),
                         0 if kind is None else arrays.choice("kind", kind, "hd_laplacian_kind", ("default", "polygon", "matrices")),
                         held, False, Context(threads, memory_limit, progress), mollify=arrays.number("mollify", mollify),
                         neighbours=arrays.integer("neighbours", neighbours), bandwidth2=arrays.number("bandwidth2", bandwidth2),
                         weight_cut=arrays.number("weight_cut", weight_cut),
                         triangulation=arrays.choice("triangulation", triangulation, "hd_triangulation", ("delaunay",)))

    @classmethod
    @arrays.options
    def from_lengths(cls, faces: Any, lengths: Any, n: Optional[int] = None, *, kind: str = "fem", triangulation: str = "given",
                     mollify: float = 0.0, border: str = "natural", held: Any = None, threads: Optional[int] = None,
                     memory_limit: Optional[int] = None, progress: Progress = None) -> "Laplacian":
        """Of triangles that are known by their sides alone, such as a flat torus.

        faces    (m, 3) vertex ids
        lengths  (m, 3): lengths[f, q] is the side from corner q of face f to its next corner
        n        number of vertices; None: one more than the largest id
        The others: as in from_mesh."""
        faces = triangles(faces)
        lengths = arrays.doubles("lengths", lengths, (len(faces), 3))
        n = max(int(faces.max()) + 1, 1) if n is None else arrays.integer("n", n, 0)
        mesh = mesh_struct("triangles", None, n, faces, lengths=lengths)
        return cls._make("hd_laplacian_create", [ctypes.byref(mesh)], n,
                         arrays.choice("kind", kind, "hd_laplacian_kind", ("default", "polygon", "voronoi-exp", "exp", "matrices")),
                         held, False, Context(threads, memory_limit, progress), mollify=arrays.number("mollify", mollify),
                         triangulation=arrays.choice("triangulation", triangulation, "hd_triangulation"),
                         border=arrays.choice("border", border, "hd_border"))

    @classmethod
    @arrays.options
    def from_matrices(cls, L: Any, B: Any, h: float = 0.0, *, held: Any = None, updatable: bool = False,
                      threads: Optional[int] = None, memory_limit: Optional[int] = None, progress: Progress = None) -> "Laplacian":
        """Of your own matrices, on any graph: of scipy.sparse, or tuples (data, indices, indptr).

        L   n x n, symmetric, positive semi-definite: minus libigl's cotangent matrix
        B   n x n, symmetric, positive definite; or (n,), its diagonal. Empty rows are vertices without mass
        h   unit length for times such as '10h2'; 0: there is none
        """
        structs, n, _keep = _matrices(L, B)
        return cls._make("hd_laplacian_matrices", [*structs, arrays.number("h", h)], n, 0, held, updatable,
                         Context(threads, memory_limit, progress))

    def update(self, vertices: Any) -> None:
        """New coordinates (n, 3) for the same faces, of a mesh made with updatable=True. Plans notice."""
        xyz = arrays.doubles("vertices", vertices, (self._n, 3))
        mesh = mesh_struct("points", xyz, self._n)
        with self._handle.use(exclusive=True) as lap:
            call(self._handle.context, "hd_laplacian_update", lap, ctypes.byref(mesh))

    def update_matrices(self, L: Any, B: Any, h: float = 0.0) -> None:
        """New values of your own matrices, on the pattern that they had, if made with updatable=True. Plans notice."""
        structs, n, _keep = _matrices(L, B)
        if n != self._n:
            raise ValueError(f"L has {n} rows, wanted are {self._n}")
        with self._handle.use(exclusive=True) as lap:
            call(self._handle.context, "hd_laplacian_update_matrices", lap, *structs, arrays.number("h", h))

    def _read(self, *names: str) -> Any:
        with self._handle.use() as lap:
            found = [getattr(lap.contents, name) for name in names]
            return found if len(found) > 1 else found[0]

    n = property(lambda self: self._n, doc="Number of vertices.")
    h = property(lambda self: self._read("h"), doc="Mean edge length; of points the mean distance of nearest neighbours.")
    area = property(lambda self: self._read("area"), doc="Area of the surface; of matrices 1'B1.")
    kind = property(lambda self: NAMES["hd_laplacian_kind"][self._read("kind")], doc="Such as 'fem'.")
    lambda_max = property(lambda self: self._read("lambda_max"), doc="A bound on the largest eigenvalue, 1/area.")
    n_components = property(lambda self: self._read("n_components"), doc="Components of the vertices that have rows.")
    n_held = property(lambda self: self._read("n_held"), doc="Vertices held at zero.")
    conserves = property(lambda self: self._read("conserves") == 1, doc="Whether no heat is lost.")

    @property
    def mesh(self) -> SimpleNamespace:
        """What was found in the mesh, such as n_nonmanifold_edges or n_inert: hd_mesh_report in heatdiff.h."""
        with self._handle.use() as lap:
            return SimpleNamespace(**plain(lap.contents.mesh))

    @property
    def points(self) -> SimpleNamespace:
        """What was found in the points, and chosen for them: hd_point_report in heatdiff.h."""
        with self._handle.use() as lap:
            return SimpleNamespace(**plain(lap.contents.points))

    @property
    def vertex(self) -> np.ndarray:
        """Ids of the vertices that have rows: mass, and no held value."""
        with self._handle.use() as lap:
            return _copy(lap.contents.vertex, lap.contents.n_active)

    @property
    def mass(self) -> np.ndarray:
        """(n,) areas of the vertices, B 1; 0 where there is no row."""
        return self._spread("mass", 0.0)

    @property
    def component(self) -> np.ndarray:
        """(n,) the component of each vertex; -1 where there is no row."""
        return self._spread("component", -1)

    def _spread(self, name: str, rest: Any) -> np.ndarray:
        with self._handle.use() as lap:
            rows = _copy(getattr(lap.contents, name), lap.contents.n_active)
            out = np.full(self._n, rest, dtype=rows.dtype)
            out[_copy(lap.contents.vertex, len(rows))] = rows
            return out

    @property
    def L(self) -> Any:
        """The stiffness matrix, n x n, of scipy.sparse by rows; without SciPy a tuple (data, indices, indptr). Rows of
        vertices without mass, and of held ones, are empty: v = lap.vertex and lap.L[v][:, v] leave them out."""
        return self._matrix(False)

    @property
    def B(self) -> Any:
        """The mass matrix, in the same form."""
        return self._matrix(True)

    def _matrix(self, mass: bool) -> Any:
        with self._handle.use() as lap:
            a = lap.contents
            rows = _copy(a.vertex, a.n_active)
            if mass and not a.B:
                data, col, ptr = _copy(a.mass, a.n_active), np.arange(a.n_active), np.arange(a.n_active + 1)
            else:
                data = _copy(a.B if mass else a.L.val, a.L.nnz)
                col, ptr = _copy(a.L.col, a.L.nnz), _copy(a.L.row_ptr, a.n_active + 1)
        counts = np.zeros(self._n + 1, np.int64)
        counts[rows + 1] = np.diff(ptr)
        return _sparse(CSR(data, rows[col], np.cumsum(counts)), (self._n, self._n))

    def times(self, t: Times, name: str = "t") -> np.ndarray:
        """Times as numbers, in the unit of t (length^2, a pure number if B = 1).

        t   a number; '10h2', that many squares of the mean edge; '0.1/l1', in units of 1/(first eigenvalue that does not
            belong to constants); 'auto:16', that many which suit the area; or a list of numbers and such texts
        One time gives an array without dimensions, several a vector."""
        if isinstance(t, str) and t.startswith("auto:") and t[5:].isdigit():
            out = np.zeros(arrays.integer(name, int(t[5:]), 1))
            with self._handle.use() as lap:
                call(self._handle.context, "hd_times_auto", lap, len(out), out)
            return out
        if isinstance(t, str):
            t = self._time(name, t)
        if isinstance(t, (list, tuple)) and any(isinstance(x, str) for x in t):
            t = [self._time(f"{name}[{k}]", x) if isinstance(x, str) else x for k, x in enumerate(t)]
        out = arrays.doubles(name, t, (), ("n_times",))
        if out.size == 0:
            raise ValueError(f"{name} has shape {out.shape}, wanted is at least one time")
        bad = np.flatnonzero(~((out >= 0) & (out < np.inf)))
        if len(bad):
            raise ValueError(f"{name} is negative or not finite: {out.flat[bad[0]]}" + (f" at {bad[0]}" if out.ndim else ""))
        return out

    def _time(self, name: str, text: str) -> float:
        m = _NUMBER.match(text.strip())
        if not m:
            raise ValueError(f"{name} is {text!r}, wanted is a number, or a text such as '10h2', '0.1/l1' or 'auto:16'")
        unit, h, kind = m.group(2), self.h, self.kind
        if unit == "h2" and kind in ("cot", "exp"):
            raise ValueError(f"{name} is {text!r}: with kind {kind!r} t is not a squared length")
        if unit == "h2" and h == 0:
            raise ValueError(f"{name} is {text!r}: this Laplacian has no h, which from_matrices takes")
        return float(m.group(1)) * {None: 1.0, "h2": h * h, "/l1": 0.0 if unit != "/l1" else self._longest()}[unit]

    def _longest(self) -> float:
        """1/(the first eigenvalue that does not belong to constants), computed once for each update."""
        version, count = self._read("version"), min(self.n_components + 1, len(self.vertex))
        if self._first[0] != version:
            from .heat import Spectrum
            with Spectrum(self, count) as s:
                values = s.values[s.n_constant:]
            if not len(values):
                raise ValueError("the only eigenvalues are those of constants")
            self._first = version, 1 / values[0]
        return self._first[1]


def _copy(address: Any, n: int) -> np.ndarray:
    return np.ctypeslib.as_array(address, (n,)).copy() if n else np.zeros(0, np.dtype(address._type_))


def _sparse(made: CSR, shape: Tuple[int, int]) -> Any:
    """A matrix of scipy.sparse, or without SciPy the tuple itself."""
    try:
        import scipy.sparse
    except ImportError:
        return made
    return scipy.sparse.csr_matrix(made, shape)


def _matrices(L: Any, B: Any) -> Tuple[list, int, list]:
    """References to two structs, the size, and what must live as long as they are used."""
    made: List[Any] = []
    for name, a in (("L", L), ("B", B)):
        n, ptr, col, val = arrays.csr(name, a)
        if made and n != made[0].n_rows:
            raise ValueError(f"B has {n} rows, wanted are {made[0].n_rows} as of L")
        made.append(c.hd_csr(n, n, len(val)))
        attach(made[-1], row_ptr=ptr, col=col, val=val)
    return [ctypes.byref(a) for a in made], made[0].n_rows, made
