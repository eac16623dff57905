"""heatdiff.py - heatdiff.h from Python, with ctypes and NumPy: nothing to compile but the library itself

    cmake -S . -B build -DHEATDIFF_BUILD_SHARED=ON && cmake --build build --target heatdiff_shared
    HEATDIFF_LIBRARY=build/libheatdiff.so python3 examples/python/tour.py

Structs and constants are read from heatdiff.h, so that they are those of the library. Arrays go in and come out as
NumPy arrays of doubles; columns of results are columns of Fortran-ordered arrays. Errors are exceptions that say where.

    import heatdiff as hd
    lap = hd.triangles(xyz, tri)                        # or polygons, points, matrices(L, B) of scipy.sparse
    heat = hd.Heat(lap)
    u = heat.columns(t, [0])                            # K_t e_0; heat.report['error_bound'] bounds its error
    signature = heat.diagonal([t1, t2])                 # k_t(v,v)
    d = heat.distance(t, [0])                           # diffusion distance from vertex 0
    d = heat.pairs(t, [0, 1], [5, 7])                   # of pairs; entries and sample: single entries, farthest points
    by_t, by_f = heat.vjp(t, f, g)                      # gradients for training; see learn_time.py
    far = hd.Geodesic(xyz, tri).distance([0])           # along the surface
"""
import ctypes
import os
import re

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


def _header():
    with open(os.environ.get("HEATDIFF_HEADER", os.path.join(HERE, "..", "..", "heatdiff.h")), encoding="utf-8") as f:
        text = f.read().split("/* ==== [D] functions")[0]
    return re.sub(r"/\*.*?\*/", "", text, flags=re.S)


def _constants(text):
    """Names of enumerations, of their constants, and of those in the list of statuses."""
    values, kinds = {}, set()
    values.update((name, int(number)) for name, number in re.findall(r"X\((HD_\w+), (-?\d+),", text))
    for body, kind in re.findall(r"enum(?:\s+\w+)?\s*\{([^}]*)\}\s*(\w*);", text):
        kinds.add(kind)
        at = 0
        for item in body.split(","):
            m = re.match(r"\s*(HD_\w+)\s*(?:=\s*(-?\w+))?\s*$", item)
            if m:
                at = int(m.group(2), 0) if m.group(2) else at
                values[m.group(1)] = at
                at += 1
    kinds.add("hd_status")
    return values, kinds


def _structs(text, constants, kinds):
    """Classes for the header's structs: pointers are addresses, enumerations integers."""
    plain = {"int32_t": ctypes.c_int32, "int64_t": ctypes.c_int64, "uint64_t": ctypes.c_uint64, "double": ctypes.c_double,
             "char": ctypes.c_char, "size_t": ctypes.c_size_t}
    made = {}
    for name, body in re.findall(r"typedef struct (\w+)\s*\{(.*?)\}\s*\1;", text, re.S):
        fields = []
        for line in filter(None, (x.strip() for x in body.split(";"))):
            if "(" in line:                                     # a callback
                fields.append((re.search(r"\(\s*\*\s*(\w+)\s*\)", line).group(1), ctypes.c_void_p))
                continue
            kind, names = re.match(r"(?:const\s+)?(?:struct\s+)?(\w+)\s*(.*)$", line, re.S).groups()
            base = ctypes.c_int if kind in kinds else plain.get(kind) or made.get(kind)
            for one in (x.strip() for x in names.split(",")):
                if one.startswith("*"):
                    of = ctypes.c_char_p if kind == "char" else ctypes.c_void_p
                    fields.append((one.lstrip("* "), of))
                    continue
                m = re.match(r"(\w+)(?:\[([\w +]+)\])?$", one)
                count = m.group(2) and sum(int(constants.get(x.strip(), x)) for x in m.group(2).split("+"))
                fields.append((m.group(1), base * count if count else base))
        made[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
    return made


_text = _header()
C, _kinds = _constants(_text)                                   # C["HD_METHOD_DIRECT"] and all the others
S = _structs(_text, C, _kinds)
_lib = ctypes.CDLL(os.environ.get("HEATDIFF_LIBRARY", "libheatdiff.so"))


class Error(Exception):
    """What went wrong, and where: status, text, and the numbers that are known of face, vertex, row, column."""

    def __init__(self, error):
        where = [f"{name} {getattr(error, name)}" for name in ("face", "vertex", "row", "column") if getattr(error, name) >= 0]
        self.status, self.text = error.status, error.text.decode()
        self.face, self.vertex, self.row, self.column = error.face, error.vertex, error.row, error.column
        self.value = error.value
        super().__init__(f"{self.text}" + (f" ({', '.join(where)})" if where else ""))


def _call(name, *args):
    """Calls a function whose last argument is the error."""
    error = S["hd_error"]()
    status = getattr(_lib, name)(*args, ctypes.byref(error))
    if status < 0:
        raise Error(error)
    return status


def _doubles(x):
    return np.ascontiguousarray(x, dtype=np.float64)


def _ints(x):
    return np.ascontiguousarray(x, dtype=np.int32)


def _at(array):
    return ctypes.c_void_p(array.ctypes.data)


def _options(name, values):
    o = S[name]()
    for key, value in values.items():
        value = C.get(value, value) if isinstance(value, str) else value
        setattr(o, key, value)
    return o


class Laplacian:
    """The pair (L, B) of a surface. L and B are scipy.sparse matrices by rows; vertex gives the vertex of each row.
    held: vertices that are held at zero; border="HD_BORDER_DIRICHLET" holds those of the border."""

    def __init__(self, function, *args, held=(), **options):
        held = _ints(held)
        self._free, self._as_parameter_ = _lib.hd_laplacian_free, ctypes.c_void_p()
        self._options = _options("hd_laplacian_opts", dict(options, n_held=len(held), held=_at(held)))
        _call(function, ctypes.byref(self._as_parameter_), *args, ctypes.byref(self._options))
        self.info = S["hd_laplacian"].from_address(self._as_parameter_.value)
        self.n, self.h, self.area = self.info.n, self.info.h, self.info.area

    def __del__(self):
        if getattr(self, "_as_parameter_", None):
            self._free(self._as_parameter_)

    def _array(self, address, kind, n):
        return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(kind)), (n,)).copy()

    @property
    def vertex(self):
        return self._array(self.info.vertex, ctypes.c_int32, self.info.n_active)

    @property
    def mass(self):
        return self._array(self.info.mass, ctypes.c_double, self.info.n_active)

    def _matrix(self, values):
        import scipy.sparse
        a, n = self.info.L, self.info.n_active
        return scipy.sparse.csr_matrix((self._array(values, ctypes.c_double, a.nnz), self._array(a.col, ctypes.c_int32, a.nnz),
                                        self._array(a.row_ptr, ctypes.c_int64, n + 1)), (n, n))

    @property
    def L(self):
        return self._matrix(self.info.L.val)

    @property
    def B(self):
        import scipy.sparse
        return self._matrix(self.info.B) if self.info.B else scipy.sparse.diags(self.mass).tocsr()

    def times(self, n):
        """n times that suit the area, from small details to the whole."""
        t = np.zeros(n)
        _call("hd_times_auto", self, ctypes.c_int32(n), _at(t))
        return t

    def spectral_times(self, c):
        """c divided by the first eigenvalue that does not belong to constants."""
        c = np.atleast_1d(_doubles(c))
        t = np.zeros(len(c))
        _call("hd_times_spectral", self, ctypes.c_int32(len(c)), _at(c), _at(t))
        return t

    def update(self, xyz):
        """New coordinates for the same faces; made with updatable=1."""
        _call("hd_laplacian_update", self, _at(_doubles(xyz)))
        self.h, self.area = self.info.h, self.info.area


def triangles(xyz, tri, **options):
    xyz, tri = _doubles(xyz), _ints(tri)
    return Laplacian("hd_laplacian_triangles", _at(xyz), len(xyz), _at(tri), len(tri), **options)


def polygons(xyz, faces, **options):
    """faces: lists of vertices."""
    xyz, ptr = _doubles(xyz), np.cumsum([0] + [len(f) for f in faces], dtype=np.int64)
    idx = _ints(np.concatenate([np.asarray(f) for f in faces]) if len(faces) else [])
    return Laplacian("hd_laplacian_polygons", _at(xyz), len(xyz), _at(ptr), _at(idx), len(faces), **options)


def points(xyz, **options):
    xyz = _doubles(xyz)
    return Laplacian("hd_laplacian_points", _at(xyz), len(xyz), **options)


def matrices(L, B, h=0, **options):
    """L and B of scipy.sparse, square and symmetric; L positive semi-definite, B positive definite."""
    keep, csr = [], []
    for a in (L, B):
        a = a.tocsr().sorted_indices()
        keep += [a.indptr.astype(np.int64), _ints(a.indices), _doubles(a.data)]
        csr.append(S["hd_csr"](a.shape[0], a.shape[1], a.nnz, *(x.ctypes.data for x in keep[-3:])))
    return Laplacian("hd_laplacian_matrices", ctypes.byref(csr[0]), ctypes.byref(csr[1]), ctypes.c_double(h), **options)


class Heat:
    """A plan. After each query report is a dictionary: method, reason, error_bound and all the others."""

    def __init__(self, lap, **options):
        self.lap, self._free, self._as_parameter_ = lap, _lib.hd_heat_free, ctypes.c_void_p()
        self.report, self._options = {}, _options("hd_heat_opts", options)
        _call("hd_heat_create", ctypes.byref(self._as_parameter_), lap, ctypes.byref(self._options))

    def __del__(self):
        if getattr(self, "_as_parameter_", None):
            self._free(self._as_parameter_)

    def _query(self, name, *args):
        report = S["hd_report"]()
        _call(name, self, *args, ctypes.byref(report))
        self.report = {key: getattr(report, key) for key, _ in report._fields_ if key not in ("error", "pole_iterations")}
        self.report["reason"] = (report.reason or b"").decode()

    @staticmethod
    def _times(t):
        t = np.atleast_1d(_doubles(t))
        return t, (ctypes.c_int32(len(t)), _at(t))

    def _room(self, columns):
        out = np.zeros((self.lap.n, columns), order="F")
        return out, (_at(out), ctypes.c_size_t(0))

    def apply(self, t, f):
        """K_t f for each column of f and each time: column q n_times + m for field q and time m."""
        return self._fields("hd_heat_apply", t, f)

    def derivative(self, t, f):
        """dK_t/dt f, in the same order."""
        return self._fields("hd_heat_derivative", t, f)

    def adjoint(self, t, g):
        """K_t' g, in the same order."""
        return self._fields("hd_heat_adjoint", t, g)

    def vjp(self, t, f, g):
        """The gradients by t and by f of sum(g * apply(t, f)): a number for each time, and a column for each field."""
        f, g = (np.atleast_2d(np.asarray(x, dtype=np.float64).T).T for x in (f, g))
        t = np.atleast_1d(_doubles(t))
        by_t, by_f = np.zeros(len(t)), np.zeros(f.shape)
        for m in range(len(t)):
            part = g[:, m::len(t)]
            by_t[m] = np.sum(part * self.derivative(t[m], f))
            by_f += self.adjoint(t[m], part)                    # by the factors of the derivative
        return by_t, by_f

    def _fields(self, name, t, f):
        f = np.asfortranarray(np.atleast_2d(np.asarray(f, dtype=np.float64).T).T)
        t, times = self._times(t)
        out, to = self._room(f.shape[1] * len(t))
        self._query(name, *times, ctypes.c_int32(f.shape[1]), _at(f), ctypes.c_size_t(0), *to)
        return out

    def columns(self, t, sources, symmetric=False):
        """Columns of K_t, or of k_t = K_t B^-1."""
        sources, (t, times) = _ints(np.atleast_1d(sources)), self._times(t)
        out, to = self._room(len(sources) * len(t))
        self._query("hd_heat_columns", C["HD_KERNEL_SYMMETRIC" if symmetric else "HD_KERNEL_OPERATOR"], *times,
                    ctypes.c_int32(len(sources)), _at(sources), *to)
        return out

    def diagonal(self, t, symmetric=True):
        """k_t(v,v), the heat kernel signature: a column for each time."""
        t, times = self._times(t)
        out, to = self._room(len(t))
        self._query("hd_heat_diagonal", C["HD_KERNEL_SYMMETRIC" if symmetric else "HD_KERNEL_OPERATOR"], *times, *to)
        return out

    def trace(self, t):
        """The sum of exp(-t lambda) over all eigenvalues for each time, and bounds on its error."""
        t, times = self._times(t)
        out = np.zeros((2, len(t)))
        self._query("hd_heat_trace", *times, _at(out), _at(out[1]))
        return out[0], out[1]

    def normalised(self, t):
        """k_t(v,v)/trace: a column for each time."""
        t, times = self._times(t)
        out, to = self._room(len(t))
        self._query("hd_heat_normalised", *times, *to)
        return out

    def scale_invariant(self, t0, t1, n_times=257, n_freq=6):
        """Moduli of Fourier coefficients of the steps of log k_t(v,v) over log t: a column for each frequency."""
        out, to = self._room(n_freq)
        self._query("hd_heat_scale_invariant", ctypes.c_double(t0), ctypes.c_double(t1), ctypes.c_int32(n_times),
                    ctypes.c_int32(n_freq), *to)
        return out

    def distance(self, t, sources, kind="HD_DISTANCE_CLASSICAL"):
        """Diffusion distances from each source to every vertex. Commute and biharmonic distances have no time: t is None."""
        sources, (t, times) = _ints(np.atleast_1d(sources)), self._times(0 if t is None else t)
        out, to = self._room(len(sources) * len(t))
        self._query("hd_heat_distance", C[kind], *times, ctypes.c_int32(len(sources)), _at(sources), *to)
        return out

    def entries(self, t, i, j, symmetric=False):
        """Entries (i, j) of K_t or k_t: a row for each pair, a column for each time."""
        i, j, (t, times) = _ints(np.atleast_1d(i)), _ints(np.atleast_1d(j)), self._times(t)
        i, j = (np.ascontiguousarray(x) for x in np.broadcast_arrays(i, j))
        out = np.zeros((len(i), len(t)), order="F")
        self._query("hd_heat_entries", C["HD_KERNEL_SYMMETRIC" if symmetric else "HD_KERNEL_OPERATOR"], *times,
                    ctypes.c_int64(len(i)), _at(i), _at(j), _at(out))
        return out

    def pairs(self, t, i, j, kind="HD_DISTANCE_CLASSICAL"):
        """Diffusion distances of listed pairs, without cancellation: a row for each pair, a column for each time."""
        i, j, (t, times) = _ints(np.atleast_1d(i)), _ints(np.atleast_1d(j)), self._times(0 if t is None else t)
        i, j = (np.ascontiguousarray(x) for x in np.broadcast_arrays(i, j))
        out = np.zeros((len(i), len(t)), order="F")
        self._query("hd_heat_pairs", C[kind], *times, ctypes.c_int64(len(i)), _at(i), _at(j), None, _at(out))
        return out

    def sample(self, t, count, given=(), kind="HD_DISTANCE_CLASSICAL"):
        """Farthest points: count vertices, those given first, and the distance of each to the ones before it."""
        vertex, distance = np.zeros(count, dtype=np.int32), np.zeros(count)
        vertex[:len(given)] = given
        self._query("hd_heat_sample", C[kind], ctypes.c_double(t), ctypes.c_int32(count), ctypes.c_int32(len(given)),
                    _at(vertex), _at(distance))
        return vertex, distance


class Geodesic:
    """Distances along a surface by the heat method: of triangles (an array of three columns), of polygons (a list of
    lists), or of points without faces."""

    def __init__(self, xyz, faces=None, **options):
        xyz = _doubles(xyz)
        self.n, self._free, self._as_parameter_ = len(xyz), _lib.hd_geodesic_free, ctypes.c_void_p()
        self._options = _options("hd_geodesic_opts", options)
        head, tail = (ctypes.byref(self._as_parameter_), _at(xyz), len(xyz)), (ctypes.byref(self._options),)
        if faces is None:
            _call("hd_geodesic_create_points", *head, None, None, *tail)
        elif isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
            tri = _ints(faces)
            _call("hd_geodesic_create", *head, _at(tri), len(tri), *tail)
        else:
            ptr = np.concatenate([[0], np.cumsum([len(f) for f in faces])]).astype(np.int64)
            idx = _ints(np.concatenate(faces))
            _call("hd_geodesic_create_polygons", *head, _at(ptr), _at(idx), len(faces), *tail)

    def __del__(self):
        if getattr(self, "_as_parameter_", None):
            self._free(self._as_parameter_)

    def distance(self, sources):
        """To the nearest of the sources."""
        sources, d = _ints(np.atleast_1d(sources)), np.zeros(self.n)
        _call("hd_geodesic_distance", self, ctypes.c_int32(len(sources)), _at(sources), _at(d), None)
        return d
