"""Heat on a surface: kernels, signatures, distances; and eigenpairs."""
from __future__ import annotations

import ctypes
from typing import Any, Dict, Optional, Sequence, Tuple, Union

import numpy as np

from . import _bindings as c
from . import arrays
from ._library import NAMES, Context, Handle, Object, Progress, attach, call, doubt, lib, plain
from .answers import Answer, Estimate, Report, report
from .laplacian import CSR, Laplacian, Times, _copy, _sparse

TIMELESS = (c.CHOICES["hd_distance_kind"]["commute"], c.CHOICES["hd_distance_kind"]["biharmonic"])


class Sources:
    """Where heat comes from: points at vertices, on edges and inside faces, sets of them, and curves.

    vertices  (p,) vertex ids; or (p, corners), the vertices that each point lies between: 2 for an edge, 3 for a triangle
    bary      (p, corners) barycentric coordinates of sum 1; None: the mean of the corners
    weights   (p,) how much each counts; None: 1
    groups    how many of the points each source has; None: one each
    curve     True: each source is a curve of straight pieces through its points
    """

    @arrays.options
    def __init__(self, vertices: Any, bary: Any = None, weights: Any = None, groups: Optional[Sequence[int]] = None,
                 curve: bool = False):
        ids = arrays.ints("vertices", vertices, ("p",), ("p", "corners"))
        p, corners = len(ids), 1 if ids.ndim == 1 else ids.shape[1]
        first = np.arange(p + 1) if groups is None else np.cumsum([0, *arrays.ints("groups", groups, ("count",))])
        if first[-1] != p or (np.diff(first) < 1).any():
            raise ValueError(f"groups are {groups}, wanted are positive numbers of sum {p}")
        self.count = len(first) - 1
        self.struct = c.hd_sources(count=self.count, corners=corners, curve=arrays.integer("curve", curve, 0, 1))
        attach(self.struct, vertex=ids, **({} if groups is None else {"first": first.astype(np.int64)}))
        if bary is not None:
            attach(self.struct, bary=arrays.doubles("bary", bary, (p, corners)))
        if weights is not None:
            attach(self.struct, weight=arrays.doubles("weights", weights, (p,)))


def places(name: str, x: Any, together: bool = False) -> Tuple[Sources, bool]:
    """Sources, and whether it is a single one. together: all are one source."""
    if isinstance(x, Sources):
        return x, False
    ids = arrays.ints(name, x, (), ("any",))
    one = together or ids.ndim == 0
    if together and not ids.size:
        raise ValueError(f"{name} are none, wanted is at least one vertex")
    return Sources(ids.reshape(-1), groups=[ids.size] if together else None), one


def shaped(out: np.ndarray, one_field: bool, one_time: bool) -> np.ndarray:
    """From the library's order, (fields, times, n), to (n, fields, times); single ones have no axis."""
    out = np.moveaxis(out, -1, 0)
    if one_time:
        out = out[:, :, 0]
    return out[:, 0] if one_field else out


class Heat(Object):
    """A plan for heat on a surface. Whatever a method needs is made at its first use and kept, so that more questions at
    the same time t are fast. Threads may share a plan, which answers one after the other; plans of one Laplacian work side
    by side, and Python's other threads run meanwhile.

    lap             the Laplacian
    method          'auto', 'direct' (many columns; signatures, distances), 'krylov' (few columns, many times), 'iterative',
                    'local' (small t: columns and fields on the part of the mesh that heat reaches; signatures, traces and
                    distances by patches, within memory_limit)
    solver          of iterations: 'auto', 'cocg', 'minres', 'lanczos'
    precond         of iterations: 'auto', 'none', 'jacobi', 'ssor', 'ildl', 'mildl'
    poles           'default', 'uniform', 'kernel'; training: 'kernel' and a degree
    degree          of the rational function, 1 to 14; 0: chosen, for errors near 1e-8
    tol             of the solver; 0: 1e-9
    max_iterations  0: 20000
    cut             of columns_sparse: smaller values, relative to the largest of each column, are left out
    ordering        of factors: 'auto', 'minimum-degree', 'nested-dissection', 'own'
    perm            (n,) with 'own': perm[k] is the vertex eliminated k-th
    threads, memory_limit, progress: as of the Laplacian, whose values are the defaults

    Shapes: t is a number, '10h2', 'auto:16' or a list, see Laplacian.times. Answers have the shape (n,), then an axis for
    several fields or sources, then one for several times. They carry a report, which says how large errors can be. Times
    are lengths squared, K_t has no unit, k_t = K_t B^-1 is 1/area.
    """

    @arrays.options
    def __init__(self, lap: Laplacian, *, method: str = "auto", solver: str = "auto", precond: str = "auto",
                 poles: str = "default", degree: int = 0, tol: float = 0.0, max_iterations: int = 0, cut: float = 0.0,
                 ordering: str = "auto", perm: Any = None, threads: Optional[int] = None, memory_limit: Optional[int] = None, progress: Progress = None):
        if not isinstance(lap, Laplacian):
            raise TypeError(f"lap is a {type(lap).__name__}, wanted is a Laplacian")
        context = Context(threads, memory_limit, progress, lap._handle.context)
        opts = c.hd_heat_opts(
            method=arrays.choice("method", method, "hd_method"), solver=arrays.choice("solver", solver, "hd_solver"),
            precond=arrays.choice("precond", precond, "hd_precond"), poles=arrays.choice("poles", poles, "hd_pole_kind", ("own",)),
            degree=arrays.integer("degree", degree), tol=arrays.number("tol", tol),
            max_iterations=arrays.integer("max_iterations", max_iterations), cut=arrays.number("cut", cut),
            ordering=arrays.choice("ordering", ordering, "hd_ordering"), context=ctypes.pointer(context.struct))
        if perm is not None:
            attach(opts, perm=arrays.ints("perm", perm, (lap.n,)))
        handle = Handle(c.hd_heat, "hd_heat_free", context, lap._handle)
        with lap._handle.use() as address:
            handle.make("hd_heat_create", address, ctypes.byref(opts))
        self._handle, self._lap = handle, lap
        self.report: Optional[Report] = None                    # of the last answer

    lap = property(lambda self: self._lap, doc="The Laplacian.")

    def _query(self, name: str, *args: Any) -> Report:
        struct = c.hd_report()
        with self._handle.use() as heat:
            status = call(self._handle.context, name, heat, *args, ctypes.byref(struct), warn=False)
        return self._reported(struct, status)

    def _reported(self, struct: Any, status: int) -> Report:
        made: Report = report(Report, struct, c.STATUS[status][0])
        if status > 0:
            doubt(f"errors may be as large as {made.error_bound:.0e} of the largest value: see the answer's report")
        self.report = made
        return made

    def _times(self, t: Times) -> Tuple[int, np.ndarray, bool]:
        t = self._lap.times(t)
        return t.size, t.reshape(-1), t.ndim == 0

    def _distance(self, t: Any, kind: str) -> Tuple[int, int, np.ndarray, bool]:
        """The kind, and its times: one of zero for kinds that have none."""
        number = arrays.choice("kind", kind, "hd_distance_kind")
        if t is None and number not in TIMELESS:
            raise TypeError(f"t is missing: distances of kind {kind!r} have a time")
        return (number, *self._times(0.0 if t is None else t))

    def _field(self, name: str, f: Any, k: Any = "k") -> Tuple[np.ndarray, bool]:
        """(k, n) contiguous columns of f, (n,) or (n, k); and whether it had one axis. True and False are 1 and 0."""
        n = self._lap.n
        f = arrays.doubles(name, f, *[(n,)] * (k in (1, "k")), (n, k), kinds="biuf")
        return np.ascontiguousarray(f.reshape(n, -1).T), f.ndim == 1

    def _fields(self, function: str, name: str, f: Any, t: Times) -> Answer:
        (n_times, t, one_time), (f, one) = self._times(t), self._field(name, f)
        out = np.zeros((len(f), n_times, self._lap.n))
        rep = self._query(function, n_times, t, len(f), f, 0, out, 0)
        return Answer(shaped(out, one, one_time), rep)

    def apply(self, f: Any, t: Times) -> Answer:
        """K_t f: the fields f, (n,) or (n, k), after the time t >= 0."""
        return self._fields("hd_heat_apply", "f", f, t)

    def derivative(self, f: Any, t: Times) -> Answer:
        """dK_t/dt f, 1/area."""
        return self._fields("hd_heat_derivative", "f", f, t)

    def adjoint(self, g: Any, t: Times) -> Answer:
        """K_t' g, the transpose."""
        return self._fields("hd_heat_adjoint", "g", g, t)

    def vjp(self, f: Any, t: Times, g: Any) -> Tuple[np.ndarray, np.ndarray]:
        """The gradients of sum(g * apply(f, t)): by t, of its shape, and by f, of its shape. With poles='kernel' and a
        degree they are those of the very numbers that apply returns."""
        times, want = self._lap.times(t), np.shape(f) + self._lap.times(t).shape
        g = arrays.doubles("g", g, want)
        by_t, by_f = np.zeros(times.size), np.zeros(np.shape(f))
        for m, time in enumerate(times.reshape(-1)):
            part = g if times.ndim == 0 else g[..., m]
            by_t[m] = np.sum(part * self.derivative(f, time))
            by_f += self.adjoint(part, time)                    # by the factors of the derivative
        return by_t.reshape(times.shape), by_f

    def columns(self, sources: Any, t: Times, symmetric: bool = False) -> Answer:
        """Columns of K_t, or of k_t if symmetric: the field at time t of heat that starts at each source. sources: a vertex
        id, ids, or Sources. A column of K_t starts as 1 at the vertex, one of k_t as one unit of heat there."""
        (s, one), (n_times, t, one_time) = places("sources", sources), self._times(t)
        out = np.zeros((s.count, n_times, self._lap.n))
        rep = self._query("hd_heat_columns", _kernel(symmetric), n_times, t, ctypes.byref(s.struct), out, 0)
        return Answer(shaped(out, one, one_time), rep)

    def columns_sparse(self, sources: Any, t: Times, symmetric: bool = False) -> Any:
        """The columns as rows of a matrix of scipy.sparse, without zeros; without SciPy a tuple (data, indices, indptr). Row
        q n_times + m is of source q and time m. With method 'local' no work after the first call grows with n. The plan's
        report tells of it; its error_bound includes the plan's cut."""
        (s, _), (n_times, t, _) = places("sources", sources), self._times(t)
        out, struct, context, kernel = c.hd_csr(), c.hd_report(), self._handle.context, _kernel(symmetric)
        with self._handle.use() as heat:
            try:
                status = call(context, "hd_heat_columns_sparse", heat, kernel, n_times, t, ctypes.byref(s.struct), ctypes.byref(out),
                              ctypes.byref(struct), warn=False)
                made = CSR(_copy(out.val, out.nnz), _copy(out.col, out.nnz), _copy(out.row_ptr, out.n_rows + 1))
            finally:
                lib.hd_csr_free(ctypes.byref(out), ctypes.byref(context.struct))
        self._reported(struct, status)
        return _sparse(made, (s.count * n_times, self._lap.n))

    def column(self, source: int, t: Times, symmetric: bool = False) -> Answer:
        """The column of one vertex."""
        return self.columns(arrays.integer("source", source), t, symmetric)

    def diagonal(self, t: Times, symmetric: bool = True) -> Answer:
        """The diagonal of k_t, or of K_t if not symmetric; t > 0. That of k_t is the heat kernel signature, 1/area."""
        n_times, t, one_time = self._times(t)
        out = np.zeros((1, n_times, self._lap.n))
        rep = self._query("hd_heat_diagonal", _kernel(symmetric), n_times, t, out, 0, None, None)
        return Answer(shaped(out, True, one_time), rep)

    def hks(self, t: Times = "auto:16", normalise: bool = False) -> Answer:
        """The heat kernel signature k_t(x, x) (Sun et al. 2009), 1/area; normalised: divided by the heat trace, so that no
        time outweighs the others."""
        if not arrays.integer("normalise", normalise, 0, 1):
            return self.diagonal(t)
        n_times, t, one_time = self._times(t)
        out, trace = np.zeros((1, n_times, self._lap.n)), np.zeros(n_times)
        rep = self._query("hd_heat_diagonal", _kernel(True), n_times, t, out, 0, trace, None)
        return Answer(shaped(out / trace[:, None], True, one_time), rep)

    def trace(self, t: Times) -> Tuple[Answer, np.ndarray]:
        """The heat trace, the sum of exp(-t lambda) over all eigenvalues, and bounds on its error."""
        n_times, t, one_time = self._times(t)
        trace, bound = np.zeros(n_times), np.zeros(n_times)
        rep = self._query("hd_heat_diagonal", _kernel(False), n_times, t, None, 0, trace, bound)
        shape = () if one_time else (n_times,)
        return Answer(trace.reshape(shape), rep), bound.reshape(shape)

    def scale_invariant(self, t0: Times, t1: Times, n_times: int = 257, n_freq: int = 6) -> np.ndarray:
        """(n, n_freq) moduli of Fourier coefficients of the steps of log k_t(x, x) over log t (Bronstein, Kokkinos 2010)."""
        n_times = arrays.integer("n_times", n_times, 3)
        n_freq = arrays.integer("n_freq", n_freq, 1, (n_times + 1) // 2)
        t0, t1 = (arrays.number(name, self._lap.times(t, name)) for name, t in (("t0", t0), ("t1", t1)))
        if not 0 < t0 < t1 < np.inf:
            raise ValueError(f"times need 0 < t0 < t1, and are {t0} and {t1}")
        k = self.diagonal(t0 * (t1 / t0) ** np.linspace(0, 1, n_times))
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = np.diff(np.log(k))
        steps[~np.isfinite(steps).all(axis=1)] = 0              # vertices without mass, or whose value is lost
        return np.abs(np.fft.fft(steps))[:, :n_freq]

    def wks(self, energies: Union[int, Sequence[float]] = 16, sigma: float = 0.4, normalise: bool = True) -> Answer:
        """The wave kernel signature (Aubry, Schlickewei, Cremers 2011) of all eigenvalues, not of the first few hundred.

        energies   logarithms of eigenvalues (1/area); or how many, spread over the first 300 by Weyl's law
        sigma      width of each band; the default is seven steps of a hundred over that range
        normalise  divided by the trace, as is usual
        Needs method 'auto' or 'direct'. Shape (n, energies)."""
        if np.ndim(energies) == 0:
            first = np.log(4 * np.pi / self._lap.area)
            energies = first + np.linspace(0, np.log(300), arrays.integer("energies", energies, 1, 1000))
        e = arrays.doubles("energies", energies, ("count",))
        if not len(e) or not np.isfinite(e).all():
            raise ValueError("energies are empty or not finite")
        sigma, wave = arrays.number("sigma", sigma), c.CHOICES["hd_filter_kind"]["wave"]
        arrays.integer("normalise", normalise, 0, 1)
        filters = (c.hd_filter * len(e))(*(c.hd_filter(kind=wave, a=x, b=sigma, tol=1e-7, weight=np.exp(-x)) for x in e))
        sets, limit, context = (c.hd_rational * len(e))(), self._lap.lambda_max, self._handle.context
        out, trace, struct = np.zeros((1, len(e), self._lap.n)), np.zeros(len(e)), c.hd_report()
        with self._handle.use() as heat:
            call(context, "hd_rational_fit", sets, len(e), filters, limit, ctypes.byref(context.struct))
            call(context, "hd_heat_set_rational", heat, len(e), sets)
            try:
                status = call(context, "hd_heat_diagonal", heat, _kernel(True), 0, None, out, 0, trace, None, ctypes.byref(struct),
                              warn=False)
            finally:
                call(context, "hd_heat_set_rational", heat, 0, None)
        return Answer(shaped(out / trace[:, None] if normalise else out, True, False), self._reported(struct, status))

    def distance(self, sources: Any, t: Optional[Times] = None, kind: str = "classical") -> Answer:
        """Diffusion distances from each source to every vertex. Several sources in one call share most of the work.

        sources  a vertex id, ids, or Sources
        t        > 0; 'commute' and 'biharmonic' have no time
        kind     'classical' (1/length), 'weighted' (length), 'commute' (no unit), 'biharmonic' (length)
        """
        (s, one), (number, n_times, t, one_time) = places("sources", sources), self._distance(t, kind)
        out = np.zeros((s.count, n_times, self._lap.n))
        rep = self._query("hd_heat_distance", number, n_times, t, ctypes.byref(s.struct), out, 0)
        return Answer(shaped(out, one, one_time), rep)

    def _listed(self, function: str, number: int, n_times: int, t: np.ndarray, one_time: bool, i: Any, j: Any) -> Answer:
        one = np.ndim(i) == 0 and np.ndim(j) == 0
        i, j = arrays.vertices("i", i), arrays.vertices("j", j)
        if len(i) != len(j) and 1 not in (len(i), len(j)):
            raise ValueError(f"j has shape {j.shape}, wanted is {i.shape} as that of i, or ()")
        i, j = (np.array(x) for x in np.broadcast_arrays(i, j))
        out = np.zeros((n_times, len(i)))
        rep = self._query(function, number, n_times, t, len(i), i, j, out)
        out = out[0] if one_time else out.T
        return Answer(out[0] if one else out, rep)

    def entries(self, i: Any, j: Any, t: Times, symmetric: bool = False) -> Answer:
        """Entries (i, j) of K_t, or of k_t: (pairs,) and an axis for several times. One i serves many j."""
        return self._listed("hd_heat_entries", _kernel(symmetric), *self._times(t), i, j)

    def pairs(self, i: Any, j: Any, t: Optional[Times] = None, kind: str = "classical") -> Answer:
        """Diffusion distances of listed pairs, without cancellation: (pairs,) and an axis for several times."""
        return self._listed("hd_heat_distance_pairs", *self._distance(t, kind), i, j)

    def sample(self, count: int, t: Optional[Times] = None, given: Any = None, kind: str = "classical") -> Tuple[Answer, Answer]:
        """Farthest points: (count,) vertices, each farthest from those before it and from those given; and their distances."""
        number, n_times, t, one_time = self._distance(t, kind)
        if not one_time:
            raise ValueError(f"t has shape {t.shape}, wanted is ()")
        s, _ = places("given", [] if given is None else given)
        count = arrays.integer("count", count, 1, self._lap.n)
        vertex, distance = np.zeros(count, dtype=np.int32), np.zeros(count)
        rep = self._query("hd_heat_sample", number, float(t[0]), ctypes.byref(s.struct) if s.count else None, count, vertex, distance)
        return Answer(vertex, rep), Answer(distance, rep)

    def estimate(self, query: str, t: Optional[Times] = None, k: int = 1) -> Estimate:
        """What a query would take, without running it.

        query  'fields', 'columns', 'pairs', 'diagonal', 'trace', 'distance', 'distance-commute', 'spectrum' ...
        k      how many fields, columns, sources, samples or eigenpairs
        """
        number = arrays.choice("query", query, "hd_query")
        n_times, t, _ = (0, None, True) if t is None else self._times(t)
        struct = c.hd_estimate()
        with self._handle.use() as heat:
            call(self._handle.context, "hd_heat_estimate", heat, number, n_times, t, arrays.integer("k", k, 1), ctypes.byref(struct))
        costs: Dict[str, Dict[str, Any]] = {
            name: {key: bool(x) if key in ("possible", "fits") else x for key, x in plain(struct.cost[at]).items()}
            for at, name in NAMES["hd_method"].items()}
        auto = costs.pop("auto")
        return Estimate(NAMES["hd_method"][struct.method], (struct.reason or b"").decode(), auto["fits"], auto["seconds"],
                        auto["bytes"], costs)


class Spectrum(Object):
    """The smallest eigenpairs of L x = lambda B x: all copies of multiple ones, and those of all components.

    lap        the Laplacian
    count      how many; None: all below `below`
    below      only eigenvalues below this, 1/area; 0: no such bound
    tol        of residuals; 0: 1e-10
    ordering, perm, threads, memory_limit, progress: as in Heat

    values (k,) ascending, 1/area; vectors (n, k), orthonormal in the product of B, 0 at vertices without mass; residuals
    (k,). n_constant: the first pairs are the constants of components. proven: no pair is missing."""

    @arrays.options
    def __init__(self, lap: Laplacian, count: Optional[int] = None, *, below: float = 0.0, tol: float = 0.0,
                 ordering: str = "auto", perm: Any = None, threads: Optional[int] = None, memory_limit: Optional[int] = None,
                 progress: Progress = None):
        if not isinstance(lap, Laplacian):
            raise TypeError(f"lap is a {type(lap).__name__}, wanted is a Laplacian")
        context = Context(threads, memory_limit, progress, lap._handle.context)
        opts = c.hd_spectrum_opts(
            count=0 if count is None else arrays.integer("count", count, 1), below=arrays.number("below", below),
            tol=arrays.number("tol", tol), ordering=arrays.choice("ordering", ordering, "hd_ordering"),
            context=ctypes.pointer(context.struct))
        if perm is not None:
            attach(opts, perm=arrays.ints("perm", perm, (lap.n,)))
        handle = Handle(c.hd_spectrum, "hd_spectrum_free", context, lap._handle)
        self._version = lap._read("version")
        with lap._handle.use() as address:
            handle.make("hd_spectrum_create", address, ctypes.byref(opts))
        self._handle, self._lap, s = handle, lap, handle.pointer.contents
        self.values, self.residuals = _copy(s.value, s.count), _copy(s.residual, s.count)
        self.vectors = _copy(s.vector, s.count * s.n).reshape(s.count, s.n).T
        self.n_constant, self.proven = int(s.n_constant), bool(s.proven)

    lap = property(lambda self: self._lap, doc="The Laplacian.")

    def _query(self, name: str, kind: int, t: Times, s: Optional[Sources], one: bool) -> Tuple[np.ndarray, np.ndarray]:
        t = self._lap.times(t)
        if self._lap._read("version") != self._version:
            raise ValueError("the Laplacian was updated after these eigenpairs were made")
        out, bound = np.zeros((2, s.count if s else 1, t.size, self._lap.n))
        args = [ctypes.byref(s.struct)] if s else []
        with self._handle.use() as spectrum:
            call(self._handle.context, name, spectrum, kind, t.size, t.reshape(-1), *args, out, bound, 0)
        return shaped(out, one, t.ndim == 0), shaped(bound, one, t.ndim == 0)

    def columns(self, sources: Any, t: Times, symmetric: bool = False) -> Tuple[np.ndarray, np.ndarray]:
        """As Heat.columns, from these pairs alone; and a bound on the error of each value, what is left out included."""
        return self._query("hd_spectrum_columns", _kernel(symmetric), t, *places("sources", sources))

    def diagonal(self, t: Times, symmetric: bool = True) -> Tuple[np.ndarray, np.ndarray]:
        """As Heat.diagonal, and bounds."""
        return self._query("hd_spectrum_diagonal", _kernel(symmetric), t, None, True)

    def distance(self, sources: Any, t: Times = 0.0, kind: str = "classical") -> Tuple[np.ndarray, np.ndarray]:
        """As Heat.distance, and bounds."""
        return self._query("hd_spectrum_distance", arrays.choice("kind", kind, "hd_distance_kind"), t, *places("sources", sources))


def _kernel(symmetric: bool) -> int:
    return c.CHOICES["hd_kernel"]["symmetric" if arrays.integer("symmetric", symmetric, 0, 1) else "operator"]
