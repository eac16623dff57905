"""Distances along a surface."""
from __future__ import annotations

import ctypes
from typing import Any, Optional, Union

import numpy as np

from . import _bindings as c
from . import arrays
from ._library import Context, Handle, Object, Progress, attach, call
from .answers import Answer, GeodesicReport, report
from .heat import places
from .laplacian import mesh_struct, surface


class Geodesic(Object):
    """A plan for distances along a surface by the heat method (Crane et al. 2013). Their error is about one edge length.

    vertices       (n, 3) coordinates
    faces          (m, 3) triangles; lists of ids or (m, k): polygons; None: points without faces
    t              how long heat flows, length^2, or '2h2'; None: h^2. Longer is smoother and less accurate
    mass           'barycentric' or 'voronoi'
    border         'natural', 'mean' or 'dirichlet': how heat meets the border
    triangulation  'given'; 'delaunay' if there are slivers; 'tufted', which points always take. None: the first that applies
    mollify, stiffening, neighbours: as in Laplacian; ordering, perm: as in Heat
    updatable      True: update() may be called; triangles only
    threads, memory_limit, progress: as in Laplacian
    """

    @arrays.options
    def __init__(self, vertices: Any, faces: Any = None, *, t: Union[None, float, str] = None, mass: str = "barycentric",
                 border: str = "natural", triangulation: Optional[str] = None, mollify: float = 0.0, stiffening: float = 0.0,
                 neighbours: int = 0, ordering: str = "auto", perm: Any = None, updatable: bool = False,
                 threads: Optional[int] = None, memory_limit: Optional[int] = None, progress: Progress = None):
        mesh, shape, n = surface(vertices, faces)
        context = Context(threads, memory_limit, progress)
        given = triangulation or ("tufted" if shape == "points" else "given")
        opts = c.hd_geodesic_opts(
            mass=arrays.choice("mass", mass, "hd_geodesic_mass"), border=arrays.choice("border", border, "hd_geodesic_border"),
            triangulation=arrays.choice("triangulation", given, "hd_triangulation"), mollify=arrays.number("mollify", mollify),
            stiffening=arrays.number("stiffening", stiffening), neighbours=arrays.integer("neighbours", neighbours),
            ordering=arrays.choice("ordering", ordering, "hd_ordering"), updatable=arrays.integer("updatable", updatable, 0, 1),
            context=ctypes.pointer(context.struct))
        if isinstance(t, str):
            try:
                opts.t_in_h2 = float(t[:-2]) if t.endswith("h2") else float("nan")
            except ValueError:
                opts.t_in_h2 = float("nan")
            if not opts.t_in_h2 > 0:
                raise ValueError(f"t is {t!r}, wanted is a number above 0, or a text such as '2h2'")
        elif t is not None:
            opts.t = arrays.number("t", t)
            if not opts.t > 0:
                raise ValueError(f"t is {opts.t}, wanted is a number above 0, or a text such as '2h2'")
        if perm is not None:
            attach(opts, perm=arrays.ints("perm", perm, (n,)))
        self._handle = Handle(c.hd_geodesic, "hd_geodesic_free", context)
        self._handle.make("hd_geodesic_create", ctypes.byref(mesh), ctypes.byref(opts))
        self._n = n
        self.report: Optional[GeodesicReport] = None            # of the last answer

    n = property(lambda self: self._n, doc="Number of vertices.")

    def distance(self, sources: Any, each: bool = False) -> Answer:
        """(n,) distances to the nearest of the sources, in the unit of the coordinates; infinite in components without one.

        sources  a vertex id, ids, or Sources, of which each has a column
        each     True: a column for each id, (n, k)
        """
        s, one = places("sources", sources, together=not arrays.integer("each", each, 0, 1))
        out, struct = np.zeros((s.count, self._n)), c.hd_geodesic_report()
        with self._handle.use() as plan:
            status = call(self._handle.context, "hd_geodesic_distance", plan, ctypes.byref(s.struct), out, 0, ctypes.byref(struct))
        self.report = report(GeodesicReport, struct, c.STATUS[status][0])
        return Answer(out[0] if one else out.T, self.report)

    def update(self, vertices: Any) -> None:
        """New coordinates (n, 3) for the same triangles, of a plan made with updatable=True."""
        xyz = arrays.doubles("vertices", vertices, (self._n, 3))
        mesh = mesh_struct("points", xyz, self._n)
        with self._handle.use() as plan:
            call(self._handle.context, "hd_geodesic_update", plan, ctypes.byref(mesh))
