"""One call each: from arrays to an answer. faces: (m, 3) triangles; lists of ids or (m, k): polygons; None: points without
faces, which are triangulated ('tufted'). More options, and more questions to one surface: Laplacian and Heat."""
from __future__ import annotations

import dataclasses
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import arrays
from ._library import Context, call
from .answers import Answer
from .geodesic import Geodesic
from .heat import Heat, Spectrum
from .laplacian import Laplacian, Times, none, surface


def laplacian(vertices: Any, faces: Any = None, **options: Any) -> Laplacian:
    """The Laplacian of triangles, polygons or points, as faces are."""
    shape = surface(vertices, faces)[1]
    if shape == "points":
        options.setdefault("triangulation", "tufted")
        return Laplacian.from_points(vertices, **options)
    if shape == "triangles":
        return Laplacian.from_mesh(vertices, faces, **options)
    return Laplacian.from_polygons(vertices, faces, **options)


@arrays.options
def hks(vertices: Any, faces: Any = None, t: Times = "auto:16", normalise: bool = False) -> Answer:
    """Heat kernel signatures k_t(x, x): (n,) for one time, (n, times) for several; 1/area."""
    return Heat(laplacian(vertices, faces)).hks(t, normalise)


@arrays.options
def wks(vertices: Any, faces: Any = None, energies: Union[int, Sequence[float]] = 16, sigma: float = 0.4) -> Answer:
    """Wave kernel signatures (n, energies), see Heat.wks."""
    return Heat(laplacian(vertices, faces)).wks(energies, sigma)


@arrays.options
def heat_kernel(vertices: Any, faces: Any, source: Any, t: Times) -> Answer:
    """The heat kernel k_t(source, x) of every vertex, 1/area: one unit of heat, after the time t."""
    return Heat(laplacian(vertices, faces)).columns(source, t, symmetric=True)


@arrays.options
def diffusion_distance(vertices: Any, faces: Any, source: Any, t: Optional[Times] = None, kind: str = "classical") -> Answer:
    """Diffusion distances from a vertex, or from each of several, to all, see Heat.distance."""
    return Heat(laplacian(vertices, faces)).distance(source, t, kind)


@arrays.options
def geodesic_distance(vertices: Any, faces: Any, sources: Any, t: Union[None, float, str] = None) -> Answer:
    """(n,) distances along the surface to the nearest of the sources, see Geodesic."""
    return Geodesic(vertices, faces, t=t).distance(sources)


@arrays.options
def smooth(vertices: Any, faces: Any, t: Times, values: Any = None) -> Answer:
    """values, (n,) or (n, k), after the time t: by default the coordinates, so that the shape is smoothed."""
    return Heat(laplacian(vertices, faces)).apply(vertices if values is None else values, t)


@dataclasses.dataclass(frozen=True)
class DiffusionNetOperators:
    """What DiffusionNet (Sharp, Attaiki, Crane, Ovsjanikov 2022) takes. frames: (n, 3, 3), two tangents and the normal of
    each vertex. mass: (n,) areas. L: n x n, positive semi-definite. evals: (k,). evecs: (n, k), orthonormal with mass.
    gradX, gradY: n x n, the components of the gradient along the two tangents. Matrices are of scipy.sparse."""
    frames: np.ndarray
    mass: np.ndarray
    L: Any
    evals: np.ndarray
    evecs: np.ndarray
    gradX: Any
    gradY: Any


@arrays.options
def diffusion_net(vertices: Any, faces: Any = None, k: int = 128, normals: Any = None, regularise: float = 1e-5,
                  neighbours: int = 30) -> DiffusionNetOperators:
    """DiffusionNet's operators of triangles, or of points if faces are None. Needs SciPy.

    k           eigenpairs
    normals     (n, 3) of length 1; None: of meshes the mean of the faces', of points from their neighbours
    regularise  what the least squares of the gradients add to their 2 x 2 matrices, in units of h^2 with h the mean edge.
                DiffusionNet's own number, 1e-5, has no unit: divide it by lap.h ** 2 for the same matrices
    neighbours  of points: for normals and gradients
    L has cotangent weights, mass a third of each face (points: tufted). Vertices without mass get 1e-8 of the mean mass
    and eigenvectors of 0."""
    xyz, k = arrays.positions("vertices", vertices), arrays.integer("k", k, 0)
    regularise = arrays.number("regularise", regularise)
    cloud = none(faces)
    if cloud:
        lap = Laplacian.from_points(xyz, triangulation="tufted", kind="voronoi-cot", neighbours=neighbours)
        near = neighbourhoods(xyz, arrays.integer("neighbours", neighbours, 3, len(xyz) - 1))
        edges = np.stack([np.repeat(np.arange(len(xyz)), near.shape[1]), near.ravel()])
    else:
        lap = Laplacian.from_polygons(xyz, faces)               # of triangles: cotangents, and a third of each face
        faces = arrays.ints("faces", faces, ("m", 3))
        edges = np.stack(lap.L.nonzero())
        edges = edges[:, edges[0] != edges[1]]
    if normals is not None:
        normals = arrays.doubles("normals", normals, xyz.shape)
    else:
        normals = _normals(np.linalg.svd(xyz[near] - xyz[:, None], full_matrices=False)[2][:, 2] if cloud else _of_faces(xyz, faces))
    frames = _frames(normals)
    if k:
        with Spectrum(lap, k) as s:
            evals, evecs = np.maximum(s.values, 0), s.vectors
    else:
        evals, evecs = np.zeros(0), np.zeros((len(xyz), 0))
    mass = lap.mass
    gradients = _gradients(xyz, frames, edges, regularise * lap.h ** 2)
    return DiffusionNetOperators(frames, np.where(mass > 0, mass, 1e-8 * mass.mean()), lap.L, evals, evecs, *gradients)


def neighbourhoods(points: Any, k: int) -> np.ndarray:
    """(n, k) the nearest other points of each, nearest first."""
    xyz, k = arrays.positions("points", points), arrays.integer("k", k, 1)
    index = np.zeros((len(xyz), k + 1), np.int32)
    call(Context(None, None, None), "hd_neighbours_nearest", xyz, len(xyz), None, len(xyz), k + 1, index, None, None)
    own = index == np.arange(len(xyz))[:, None]
    own[~own.any(axis=1), -1] = True                            # more than k points at its place
    return index[~own].reshape(len(xyz), k)


def _of_faces(xyz: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """At each vertex the sum of the unit normals of its faces."""
    a, b, c_ = (xyz[faces[:, q]] for q in range(3))
    normal = _normals(np.cross(b - a, c_ - a), 0.0)
    out = np.zeros_like(xyz)
    for q in range(3):
        np.add.at(out, faces[:, q], normal)
    return out


def _normals(x: np.ndarray, rest: float = 1.0) -> np.ndarray:
    """Of length 1; where there is none (0, 0, rest)."""
    size = np.linalg.norm(x, axis=1, keepdims=True)
    return np.where(size > 0, x / np.where(size > 0, size, 1), [0.0, 0.0, rest])


def _frames(normals: np.ndarray) -> np.ndarray:
    """Two tangents and the normal of each vertex: the first tangent is that of the x axis, or of the y axis where the normal
    is too close to x."""
    axis = np.where(abs(normals[:, :1]) < 0.9, [1.0, 0, 0], [0, 1.0, 0])
    x = _normals(axis - normals * (axis * normals).sum(axis=1, keepdims=True))
    return np.stack([x, np.cross(normals, x), normals], axis=1)


def _gradients(xyz: np.ndarray, frames: np.ndarray, edges: np.ndarray, epsilon: float) -> Any:
    """The gradient g at each vertex that fits the differences of its neighbours best: the sum over edges e from i to j of
    (f_j - f_i - g.e)^2, plus epsilon |g|^2, is least for g = (E'E + epsilon)^-1 E' (f_j - f_i)."""
    import scipy.sparse
    tail, tip = edges
    n, e = len(xyz), np.einsum("eab,eb->ea", frames[tail, :2], xyz[tip] - xyz[tail])
    A = np.zeros((n, 2, 2))
    np.add.at(A, tail, e[:, :, None] * e[:, None, :])
    A += epsilon * np.eye(2)
    weight = np.einsum("eab,eb->ea", np.linalg.inv(A)[tail], e)
    made = []
    for q in range(2):
        off = scipy.sparse.csr_matrix((weight[:, q], (tail, tip)), (n, n))
        made.append((off - scipy.sparse.diags(np.asarray(off.sum(axis=1)).ravel())).tocsr())
    return made
