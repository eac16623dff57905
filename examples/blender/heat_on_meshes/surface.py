"""What the add-on computes, on arrays of NumPy. Nothing here knows Blender.

V: (n, 3) vertices in the unit of the scene. F: (m, 3) triangles, of faces with more corners too. progress: a function of
(stage, done) that returns False to cancel, which raises hd.CancelledError.

Everything works on the tufted cover (Sharp, Crane 2020), which takes any triangles: borders, islands, edges with three faces,
faces without area. It has no negative weights, so that heat and weights stay between the smallest and the largest."""
import ctypes

import numpy as np

from . import heatdiff as hd
from .heatdiff import _bindings
from .heatdiff._library import call

TRIES = 6               # bones that a vertex looks for, the nearest first
UNSEEN = 1e-3           # heat of a vertex that sees no bone, against one that does


def _edges(F):
    """Three edges of each triangle, smaller id first."""
    return np.sort(F[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)


def defects(V, F, face, edges):
    """Sentences on what is wrong with a mesh, each with its first place. Nothing of this stops anything.
    face: (m,) the face that each triangle is from. edges: (e, 2), those without faces too."""
    found = []

    def say(bad, one, many, place):
        if len(bad):
            found.append("%d %s (first: %s)" % (len(bad), one if len(bad) == 1 else many, place % tuple(np.atleast_1d(bad[0]))))

    edges = edges[edges[:, 0] != edges[:, 1]]
    say(edges[(V[edges[:, 0]] == V[edges[:, 1]]).all(axis=1)], "edge without length", "edges without length", "vertices %d and %d")
    cross = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    area = np.zeros(face.max() + 1 if len(face) else 0)
    np.add.at(area, face, np.linalg.norm(cross, axis=1))
    say(np.intersect1d(np.flatnonzero(area == 0), face), "face without area", "faces without area", "face %d")
    edge, count = np.unique(_edges(F), axis=0, return_counts=True)
    say(edge[count > 2], "edge with three or more faces", "edges with three or more faces", "vertices %d and %d")
    say(np.setdiff1d(np.arange(len(V)), F), "vertex in no face", "vertices in no face", "vertex %d")
    return found


def laplacian(V, F, progress=None):
    return hd.Laplacian.from_mesh(V, F, kind="voronoi-cot", triangulation="tufted", progress=progress)


# ---- distances ----

def distance(V, F, sources, kind="GEODESIC", t=10.0, progress=None):
    """(n,) distances to the nearest of the sources; infinite on islands without one. t: in squares of the mean edge."""
    if kind == "GEODESIC":
        return np.array(hd.Geodesic(V, F, triangulation="tufted", progress=progress).distance(sources))
    lap = laplacian(V, F, progress)
    heat, nearest = hd.Heat(lap), np.full(len(V), np.inf)
    for k in range(0, len(sources), 64):                        # 64 columns at a time
        one = heat.distance(sources[k:k + 64], None if kind == "BIHARMONIC" else "%.17gh2" % t, kind=kind_name(kind))
        nearest = np.minimum(nearest, one.min(axis=1))
    reached = np.isin(lap.component, np.unique(lap.component[sources])) & (lap.component >= 0)
    reached[sources], nearest[sources] = True, 0
    return np.where(reached, nearest, np.inf)


def kind_name(kind):
    return {"DIFFUSION": "classical", "BIHARMONIC": "biharmonic"}[kind]


# ---- weights ----

def smooth(V, F, W, t, progress=None):
    """(n, k) weights W after the time t, in squares of the mean edge. Rows keep the sums of their neighbourhood: where all
    rows sum to one, so do the answer's."""
    return np.clip(hd.Heat(laplacian(V, F, progress)).apply(W, "%.17gh2" % t), 0, None)


class Bones:
    """Segments of straight lines."""

    def __init__(self, heads, tails):
        self.heads, self.along = heads, tails - heads
        self.length2 = np.maximum((self.along ** 2).sum(axis=1), 1e-300)

    def __len__(self):
        return len(self.heads)

    def closest(self, V, bone):
        """(n, 3) the point of its bone that is closest to each vertex; bone: one for each, or one for all."""
        s = ((V - self.heads[bone]) * self.along[bone]).sum(axis=1) / self.length2[bone]
        return self.heads[bone] + np.clip(s, 0, 1)[:, None] * self.along[bone]

    def distances(self, V):
        """(n, bones)"""
        return np.stack([np.linalg.norm(V - self.closest(V, k), axis=1) for k in range(len(self))], axis=1)


def _nearest(d):
    """Who is the nearest, up to the rounding of coordinates in single precision: at joints two are."""
    return d <= d.min(axis=1, keepdims=True) * (1 + 1e-4)


def _seen(d, island, sees):
    """The bones that each vertex takes part in: the nearest that it sees; those that see one; those of islands on which fewer
    than half of the vertices do, where the nearest count unseen."""
    order = np.argsort(d, axis=1, kind="stable")[:, :TRIES]
    reach, seen = np.full(len(d), np.inf), np.zeros(len(d), bool)
    for bone in order.T:
        todo = np.flatnonzero(~seen)
        good = todo[sees(todo, bone[todo])]
        seen[good], reach[good] = True, d[good, bone[good]]
    of = np.unique(island, return_inverse=True)[1].reshape(-1)
    blind = (2 * np.bincount(of, weights=seen) < np.bincount(of))[of] | (island < 0)
    share = _nearest(d)
    there = np.flatnonzero(seen & ~blind)
    far = reach[there][:, None]
    share[there] = abs(d[there] - far) <= 1e-4 * far
    v, bone = np.nonzero(share[there])
    several = share[there].sum(axis=1)[v] > 1
    share[there[v[several]], bone[several]] = sees(there[v[several]], bone[several])
    return share, seen, blind


def bone_weights(V, F, heads, tails, c=1.0, sight=None, progress=None):
    """(n, bones) weights that sum to one, and what there is to tell.

    Solves (L + H B) w = H B p for all bones at once: p is 1 at the vertices that a bone is the nearest to, H = c / d^2 with the
    distance d to it (Baran, Popovic 2007, "Automatic rigging and animation of 3D characters", section 4; they take c = 1).
    Heat after a time t would blur all limbs by the same length sqrt(t). Here the length is d / sqrt(c): fingers blend within a
    finger's width, thighs within a thigh's, and no unit of length is to be chosen.

    sight  a function of (points, vertices): whether nothing lies between. As in the paper, bones count that are seen. Vertices
           that see none follow their neighbours. Where most of an island sees none, nothing need be seen there. So every
           island has a source, and the system is never singular.
    Vertices in no face take the nearest bone's."""
    lap, bones = laplacian(V, F, progress), Bones(heads, tails)
    d, island, said = bones.distances(V), lap.component, []
    share, strength = _nearest(d), np.ones(len(V))
    if sight:
        share, seen, blind = _seen(d, island, lambda v, bone: sight(bones.closest(V[v], bone), v))
        strength[~seen & ~blind] = UNSEEN
        some = np.unique(island[blind & (island >= 0)])
        if len(some):
            said.append("%d of %d islands see no bone from inside and follow the nearest (first: vertex %d)" %
                        (len(some), lap.n_components, (island == some[0]).argmax()))
    p = share / share.sum(axis=1, keepdims=True)
    least = 1e-6 * max(np.ptp(V, axis=0).max(), 1e-300)
    H = lap.mass * strength * c / np.maximum((p * d).sum(axis=1), least) ** 2
    w = p.copy()
    w[island >= 0] = _resolvent(lap, H, p, progress)[island >= 0]
    w = np.clip(w, 0, None)
    return w / w.sum(axis=1, keepdims=True), said


def _resolvent(lap, H, p, progress):
    """(L + diag(H))^-1 diag(H) p: a filter with one real pole, 1/(1 + lambda), of the pair (L, H). lambda <= 1e300"""
    with hd.Heat(hd.Laplacian.from_matrices(lap.L, H, progress=progress), method="direct") as heat:
        one = _bindings.hd_rational(degree=1, n_poles=1)
        one.theta[0].re, one.a[0].re = 1, -1
        call(heat._handle.context, "hd_heat_set_rational", heat._handle.pointer, 1, ctypes.pointer(one))
        return np.array(heat.apply(p, 1.0))


def clean(W, least, most):
    """W without what is below `least`, and with the `most` largest of each row (0: all), at the sums that it had."""
    total = W.sum(axis=1, keepdims=True)
    kept = np.where(W >= least, W, 0)
    if 0 < most < W.shape[1]:
        kept[kept < -np.sort(-kept, axis=1)[:, most - 1:most]] = 0
    lost = (kept.sum(axis=1) == 0) & (total[:, 0] > 0)
    kept[lost, W[lost].argmax(axis=1)] = 1
    return kept * (total / np.maximum(kept.sum(axis=1, keepdims=True), 1e-300))


# ---- segments ----

def segments(V, F, corners, first, count, seeds=None, progress=None):
    """(faces,) ids from 1: each face goes to the nearest of the vertices `seeds`, in biharmonic distance; None: of `count`
    samples, which lie as far from each other as can be. An island without a seed is a segment of its own.
    corners: the vertices of all faces, one face after the other; first: where each begins."""
    lap = laplacian(V, F, progress)
    heat, island = hd.Heat(lap), lap.component
    if seeds is None:
        seeds = np.array(heat.sample(min(count, len(lap.vertex)), kind="biharmonic")[0])
    far = np.array(heat.distance(seeds, kind="biharmonic"))
    far[island[:, None] != island[seeds]] = np.inf
    per_face = np.add.reduceat(far[corners], first, axis=0)
    label = per_face.argmin(axis=1)
    alone = ~np.isfinite(per_face.min(axis=1))
    label[alone] = len(seeds) + 1 + np.maximum.reduceat(island[corners], first)[alone]
    return np.unique(label, return_inverse=True)[1].reshape(-1) + 1
