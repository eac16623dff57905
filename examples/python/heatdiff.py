"""heatdiff.py - heatdiff.h from Python, with ctypes and NumPy: nothing to compile but the library itself

    cmake -S . -B build -DHEATDIFF_BUILD_SHARED=ON && cmake --build build --target heatdiff_shared
    HEATDIFF_LIBRARY=build/libheatdiff.so python3 examples/python/tour.py

Structs and constants are read from heatdiff.h, so that they are those of the library. Arrays go in and come out as
NumPy arrays of doubles; columns of results are columns of Fortran-ordered arrays. Errors are exceptions that say where.
Arguments are copied and checked: a wrong shape is a ValueError, wrong numbers (complex ones, or floats as indices) are a
TypeError, and so are unknown options. What the library itself refuses is an InputError, which is a ValueError.

    import heatdiff as hd
    lap = hd.triangles(xyz, tri)                        # or polygons, points, matrices(L, B) of scipy.sparse
    heat = hd.Heat(lap)
    u = heat.columns(t, [0])                            # K_t e_0; heat.report['error_bound'] bounds its error
    signature = heat.diagonal([t1, t2])                 # k_t(v,v)
    d = heat.distance(t, [0])                           # diffusion distance from vertex 0
    d = heat.pairs(t, [0, 1], [5, 7])                   # of pairs; entries and sample: single entries, farthest points
    by_t, by_f = heat.vjp(t, f, g)                      # gradients for training; see learn_time.py
    far = hd.Geodesic(xyz, tri).distance([0])           # along the surface

close() or a with block frees at once what these objects hold, and a Laplacian's plans with it.
"""
import ctypes
import difflib
import operator
import os
import re
import threading

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


def _header():
    with open(os.environ.get("HEATDIFF_HEADER", os.path.join(HERE, "..", "..", "heatdiff.h")), encoding="utf-8") as f:
        text = f.read().split("/* ==== [D] functions")[0]
    return re.sub(r"/\*.*?\*/", "", text, flags=re.S)


def _constants(text):
    """All constants, and those of each enumeration. Those of the statuses stand in a list of their own."""
    values = {name: int(number) for name, number in re.findall(r"X\((HD_\w+), (-?\d+),", text)}
    kinds = {"hd_status": dict(values)}
    for body, kind in re.findall(r"enum(?:\s+\w+)?\s*\{([^}]*)\}\s*(\w*);", text):
        at, of = 0, kinds.setdefault(kind, {})
        for item in body.split(","):
            m = re.match(r"\s*(HD_\w+)\s*(?:=\s*(-?\w+))?\s*$", item)
            if m:
                at = int(m.group(2), 0) if m.group(2) else at
                values[m.group(1)] = of[m.group(1)] = at
                at += 1
    return values, kinds


def _structs(text, constants, kinds):
    """Classes for the header's structs: pointers are addresses, enumerations integers, listed in enums by their fields."""
    plain = {"int32_t": ctypes.c_int32, "int64_t": ctypes.c_int64, "uint64_t": ctypes.c_uint64, "double": ctypes.c_double,
             "char": ctypes.c_char, "size_t": ctypes.c_size_t}
    made = {}
    for name, body in re.findall(r"typedef struct (\w+)\s*\{(.*?)\}\s*\1;", text, re.S):
        fields, enums = [], {}
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
                if kind in kinds:
                    enums[m.group(1)] = kind
        made[name] = type(name, (ctypes.Structure,), {"_fields_": fields, "enums": enums})
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


class InputError(Error, ValueError):
    """An argument that the library refused: an index out of range, a number that is not finite, a time below zero."""


_INPUT = {C["HD_ERR_" + x] for x in ("ARGUMENT", "TOO_LARGE", "INDEX", "NOT_FINITE", "NOT_SYMMETRIC", "NOT_POSITIVE",
                                      "STRUCTURE", "EMPTY")}


def _call(name, *args):
    """Calls a function whose last argument is the error. Arrays go as addresses, and live as long as args; integers are
    counts of 32 bits."""
    error = S["hd_error"]()
    status = getattr(_lib, name)(*(_argument(x) for x in args), ctypes.byref(error))
    if status < 0:
        raise (InputError if status in _INPUT else Error)(error)


def _argument(x):
    if isinstance(x, np.ndarray):
        return ctypes.c_void_p(x.ctypes.data)
    if isinstance(x, float):
        return ctypes.c_double(x)
    return ctypes.c_int32(_int("a size", x)) if isinstance(x, int) else x


# Every argument goes through one of these. They take its name for their errors.

def _array(name, x, shapes, kinds, dtype, order):
    """A copy of x, which no other thread can change. Its shape must be one of shapes, in which a name stands for any
    number, and its dtype of one of the kinds."""
    try:
        a = np.asarray(x)
    except Exception as error:
        raise ValueError(f"{name} is no array: {error}") from None
    wanted = "numbers" if "f" in kinds else "integers"
    if isinstance(x, np.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array, wanted are {wanted} without a mask")
    if a.dtype.kind not in kinds and not (a.size == 0 and a.dtype == np.float64):       # as an empty list is
        raise TypeError(f"{name} has dtype {a.dtype} and shape {a.shape}, wanted are {wanted}")
    if not any(len(s) == a.ndim and all(isinstance(m, str) or m == n for m, n in zip(s, a.shape)) for s in shapes):
        text = " or ".join("(" + ", ".join(map(str, s)) + ("," if len(s) == 1 else "") + ")" for s in shapes)
        raise ValueError(f"{name} has shape {a.shape}, wanted is {text}")
    if dtype == np.int32 and a.size:
        for extreme in a.min(), a.max():
            _int(name, extreme)
    return np.array(a, dtype=dtype, order=order)


def _doubles(name, x, *shapes, kinds="iuf", order="C"):
    return _array(name, x, shapes, kinds, np.float64, order)


def _ints(name, x, *shapes):
    return _array(name, x, shapes, "iu", np.int32, "C")


def _double(name, x):
    return float(_doubles(name, x, ()))


def _list(name, x):
    """One index or several."""
    return _ints(name, x, (), ("any",)).reshape(-1)


def _int(name, x, least=-2 ** 31, most=2 ** 31 - 1):
    """x as an integer in this range. True and False are 1 and 0."""
    try:
        n = operator.index(bool(x) if isinstance(x, np.bool_) else x)
    except TypeError:
        raise TypeError(f"{name} is {x!r}, wanted is an integer") from None
    if not least <= n <= most:
        raise ValueError(f"{name} is {n}, wanted is an integer from {least} to {most}")
    return n


def _near(word, words):
    """The word most like this one, and all the others."""
    near = difflib.get_close_matches(str(word), words, 1, 0.4)
    return (f"did you mean {near[0]}? " if near else "") + f"There are {', '.join(words)}"


def _enum(name, x, kind):
    """The number of a constant of this enumeration, given by name or number."""
    names = _kinds[kind]
    if isinstance(x, str):
        if x not in names:
            raise ValueError(f"{name} is {x!r}: {_near(x, names)}")
        return names[x]
    number = _int(name, x)
    if number not in names.values():
        raise ValueError(f"{name} is {number}, wanted is one of {', '.join(names)}")
    return number


def _options(name, options, n):
    """The struct of options for n vertices. Its lists of vertices live as long as it does."""
    o, lists = S[name](), {}
    kinds, numbers = dict(o._fields_), (ctypes.c_int, ctypes.c_int32, ctypes.c_double)
    known = [key for key in kinds if key in ("held", "perm") or
             kinds[key] in numbers and key not in ("begin_zero", "end_zero", "n_held")]
    for key, value in options.items():
        if key not in known:
            raise TypeError(f"unknown option {key}: {_near(key, known)}")
        if key in ("held", "perm"):
            lists[key] = _list(key, value) if key == "held" else _ints(key, value, (n,))
            value = lists[key].ctypes.data
        elif key in o.enums:
            value = _enum(key, value, o.enums[key])
        else:
            value = (_double if kinds[key] is ctypes.c_double else _int)(key, value)
        setattr(o, key, value)
    if "held" in lists:
        o.n_held = len(lists["held"])
    o.lists = lists
    return o


def _faces(faces):
    """Where each polygon begins among the corners of all, and the corners."""
    try:
        faces = list(faces)
        lists = [np.asarray(f) for f in faces]
    except Exception as error:
        raise TypeError(f"faces are no lists of vertices: {error}") from None
    for k, (given, f) in enumerate(zip(faces, lists)):
        if f.ndim != 1 or f.size and f.dtype.kind not in "iu" or isinstance(given, np.ma.MaskedArray):
            _ints(f"faces[{k}]", given, ("corners",))
    ptr = np.cumsum([0] + [len(f) for f in lists], dtype=np.int64)
    return ptr, _ints("faces", np.concatenate([f for f in lists if len(f)] or [[]]), ("corners",)), len(lists)


def _mesh(shape, xyz, faces=None):
    """The struct of a mesh, whose arrays live as long as it does."""
    mesh = S["hd_mesh"](shape=C[shape], n=len(xyz), xyz=xyz.ctypes.data)
    mesh.lists = [xyz]
    if shape == "HD_POLYGONS":
        ptr, faces, mesh.n_faces = _faces(faces)
        mesh.face_ptr = ptr.ctypes.data
        mesh.lists.append(ptr)
    elif faces is not None:
        mesh.n_faces = len(faces)
    if faces is not None:
        mesh.corner = faces.ctypes.data
        mesh.lists.append(faces)
    return mesh


def _sources(name, sources, together=False):
    """Vertices as sources, or as one: their number, a reference to the struct, and what it needs to live."""
    ids = _list(name, sources)
    first = np.array([0, len(ids)], dtype=np.int64)
    made = S["hd_sources"](count=1 if together else len(ids), vertex=ids.ctypes.data, first=first.ctypes.data if together else None)
    return made.count, ctypes.byref(made), (ids, first, made)


class _Pointer:
    """A pointer to what the library made. Plans are freed before their Laplacian, in whatever order they are dropped. A with
    block borrows the address. A Laplacian and its plans share a lock, because one thread at a time may use them."""

    def __init__(self, free, owner=None):
        self.address, self.free, self.owner, self.plans = ctypes.c_void_p(), getattr(_lib, free), owner, set()
        self.lock, self.dropped = (owner.lock, owner.dropped) if owner else (threading.RLock(), [])

    def __enter__(self):
        self.lock.acquire()
        if not self.address:
            self.lock.release()
            raise ValueError("this object is closed, or the Laplacian under it")
        return self.address

    def __exit__(self, *_):
        self.lock.release()
        self.sweep()

    def close(self):
        with self.lock:
            while self.plans:
                self.plans.pop().close()
            if self.owner:
                self.owner.plans.discard(self)
            address, self.address = self.address, None
            if address:
                self.free(address)

    def drop(self):
        """Closes as soon as no thread is at work. The garbage collector calls this from any thread, and must not wait."""
        self.dropped.append(self)
        self.sweep()

    def sweep(self):
        while self.dropped and self.lock.acquire(blocking=False):
            try:
                if self.dropped:                                # else another thread was faster
                    self.dropped.pop().close()
            finally:
                self.lock.release()


class _Object:
    """Something that the library made. It can be closed, by close() or a with block; afterwards its methods raise."""
    _pointer = None

    def _make(self, pointer, function, *args):
        _call(function, ctypes.byref(pointer.address), *args)
        self._pointer = pointer

    def close(self):
        if self._pointer:
            self._pointer.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if self._pointer:
            self._pointer.drop()

    def __reduce__(self):
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled")


class Laplacian(_Object):
    """The pair (L, B) of a surface, from triangles, polygons, points or matrices. L and B are scipy.sparse matrices by rows;
    vertex gives the vertex of each row. Options held: vertices that are held at zero; border="HD_BORDER_DIRICHLET" holds
    those of the border."""

    def __init__(self):
        raise TypeError("a Laplacian comes from triangles, polygons, points or matrices")

    @classmethod
    def _of(cls, function, n, options, *args):
        lap, options = cls.__new__(cls), _options("hd_laplacian_opts", options, n)
        lap._make(_Pointer("hd_laplacian_free"), function, *args, ctypes.byref(options))
        return lap

    @property
    def info(self):
        """A copy of the struct hd_laplacian."""
        with self._pointer as address:
            return S["hd_laplacian"].from_buffer_copy(ctypes.string_at(address, ctypes.sizeof(S["hd_laplacian"])))

    n = property(lambda self: self.info.n)
    h = property(lambda self: self.info.h)
    area = property(lambda self: self.info.area)

    def _array(self, address, kind, n):
        return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(kind)), (n,)).copy()

    @property
    def vertex(self):
        with self._pointer:
            return self._array(self.info.vertex, ctypes.c_int32, self.info.n_active)

    @property
    def mass(self):
        with self._pointer:
            return self._array(self.info.mass, ctypes.c_double, self.info.n_active)

    def _matrix(self, values):
        import scipy.sparse
        a, n = self.info.L, self.info.n_active
        return scipy.sparse.csr_matrix((self._array(values, ctypes.c_double, a.nnz), self._array(a.col, ctypes.c_int32, a.nnz),
                                        self._array(a.row_ptr, ctypes.c_int64, n + 1)), (n, n))

    @property
    def L(self):
        with self._pointer:
            return self._matrix(self.info.L.val)

    @property
    def B(self):
        import scipy.sparse
        with self._pointer:
            return self._matrix(self.info.B) if self.info.B else scipy.sparse.diags(self.mass).tocsr()

    def times(self, n):
        """n times that suit the area, from small details to the whole."""
        t = np.zeros(_int("n", n, 1))
        with self._pointer as lap:
            _call("hd_times_auto", lap, len(t), t)
        return t

    def spectral_times(self, c):
        """c divided by the first eigenvalue that does not belong to constants."""
        c, info, made = _doubles("c", c, (), ("n_times",)).reshape(-1), self.info, ctypes.c_void_p()
        if not len(c):
            raise ValueError("c has shape (0,), wanted is at least one time")
        if not (np.isfinite(c) & (c > 0)).all():
            raise ValueError("c is not positive and finite")
        options = S["hd_spectrum_opts"](count=min(info.n_components + 1, info.n_active))
        with self._pointer as lap:
            _call("hd_spectrum_create", ctypes.byref(made), lap, ctypes.byref(options))
        pairs = S["hd_spectrum"].from_address(made.value)
        value = ctypes.cast(pairs.value, ctypes.POINTER(ctypes.c_double))[:pairs.count][pairs.n_constant:]
        _lib.hd_spectrum_free(made)
        if not value:
            raise ValueError("the only eigenvalues are those of constants")
        return c / value[0]

    def update(self, xyz):
        """New coordinates for the same faces; made with updatable=1."""
        xyz = _doubles("xyz", xyz, (self.n, 3))
        with self._pointer as lap:
            _call("hd_laplacian_update", lap, ctypes.byref(_mesh("HD_POINTS", xyz)))


def triangles(xyz, tri, **options):
    xyz, tri = _doubles("xyz", xyz, ("n", 3)), _ints("tri", tri, ("n_tri", 3))
    return Laplacian._of("hd_laplacian_create", len(xyz), options, ctypes.byref(_mesh("HD_TRIANGLES", xyz, tri)))


def polygons(xyz, faces, **options):
    """faces: lists of vertices."""
    xyz = _doubles("xyz", xyz, ("n", 3))
    return Laplacian._of("hd_laplacian_create", len(xyz), options, ctypes.byref(_mesh("HD_POLYGONS", xyz, faces)))


def points(xyz, **options):
    """triangulation="HD_TRIANGULATION_TUFTED": triangles from neighbours, in place of exponential weights."""
    xyz = _doubles("xyz", xyz, ("n", 3))
    return Laplacian._of("hd_laplacian_create", len(xyz), options, ctypes.byref(_mesh("HD_POINTS", xyz)))


def matrices(L, B, h=0, **options):
    """L and B of scipy.sparse, square and symmetric; L positive semi-definite, B positive definite."""
    keep, csr = [], []
    for name, a in (("L", L), ("B", B)):
        if not hasattr(a, "tocsr"):
            raise TypeError(f"{name} is a {type(a).__name__}, wanted is a matrix of scipy.sparse")
        if len(a.shape) != 2 or a.shape != (L.shape[0],) * 2:
            raise ValueError(f"{name} has shape {a.shape}, wanted is {(L.shape[0],) * 2}, for both matrices")
        if hasattr(a, "check_format"):                          # its indices may have been changed by hand
            a.check_format()
        a = a.tocsr(copy=True)
        a.sum_duplicates()
        keep.append((a.indptr.astype(np.int64), _ints(name, a.indices, (a.nnz,)), _doubles(name, a.data, (a.nnz,))))
        if not np.isfinite(a.data).all():
            raise ValueError(f"{name} has an entry that is not finite")
        csr.append(S["hd_csr"](*(_int(name, m) for m in a.shape), a.nnz, *(x.ctypes.data for x in keep[-1])))
    return Laplacian._of("hd_laplacian_matrices", L.shape[0], options, *map(ctypes.byref, csr), _double("h", h))


class Heat(_Object):
    """A plan. After each query report is a dictionary: method, reason, error_bound and all the others."""

    def __init__(self, lap, **options):
        if not isinstance(lap, Laplacian):
            raise TypeError(f"lap is a {type(lap).__name__}, wanted is a Laplacian")
        options = _options("hd_heat_opts", options, lap.n)
        with lap._pointer as address:
            pointer = _Pointer("hd_heat_free", lap._pointer)
            self._make(pointer, "hd_heat_create", address, ctypes.byref(options))
            lap._pointer.plans.add(pointer)
        self._lap, self.report = lap, {}

    lap = property(lambda self: self._lap)

    def _query(self, name, *args):
        report = S["hd_report"]()
        with self._pointer as heat:
            _call(name, heat, *args, ctypes.byref(report))
        self.report = {key: getattr(report, key) for key, _ in report._fields_ if key not in ("error", "pole_iterations")}
        self.report["reason"] = (report.reason or b"").decode()

    @staticmethod
    def _times(t):
        t = _doubles("t", t, (), ("n_times",)).reshape(-1)
        if not len(t):
            raise ValueError("t has shape (0,), wanted is at least one time")
        return len(t), t

    def _distance(self, t, kind):
        """The kind, and its times: None for those that have none."""
        kind = _enum("kind", kind, "hd_distance_kind")
        timeless = t is None and kind in (C["HD_DISTANCE_COMMUTE"], C["HD_DISTANCE_BIHARMONIC"])
        return (kind, *self._times(0 if timeless else t))

    @staticmethod
    def _kernel(symmetric):
        return C["HD_KERNEL_SYMMETRIC" if _int("symmetric", symmetric, 0, 1) else "HD_KERNEL_OPERATOR"]

    def _field(self, name, f, k="k"):
        """k columns of values at the vertices; one column may be flat. True and False are 1 and 0."""
        shapes = [(self.lap.n, k)] + [(self.lap.n,)] * (k in (1, "k"))
        return _doubles(name, f, *shapes, kinds="biuf", order="F").reshape(self.lap.n, -1, order="F")

    def _room(self, columns):
        out = np.zeros((self.lap.n, columns), order="F")
        return out, (out, ctypes.c_size_t(0))

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
        (n_times, t), f = self._times(t), self._field("f", f)
        g = self._field("g", g, f.shape[1] * n_times)
        by_t, by_f = np.zeros(n_times), np.zeros(f.shape)
        for m in range(n_times):
            part = g[:, m::n_times]
            by_t[m] = np.sum(part * self.derivative(t[m], f))
            by_f += self.adjoint(t[m], part)                    # by the factors of the derivative
        return by_t, by_f

    def _fields(self, name, t, f):
        times, f = self._times(t), self._field("f" if name != "hd_heat_adjoint" else "g", f)
        out, to = self._room(f.shape[1] * times[0])
        self._query(name, *times, f.shape[1], f, ctypes.c_size_t(0), *to)
        return out

    def columns(self, t, sources, symmetric=False):
        """Columns of K_t, or of k_t = K_t B^-1."""
        (k, sources, _keep), times = _sources("sources", sources), self._times(t)
        out, to = self._room(k * times[0])
        self._query("hd_heat_columns", self._kernel(symmetric), *times, sources, *to)
        return out

    def diagonal(self, t, symmetric=True):
        """k_t(v,v), the heat kernel signature: a column for each time."""
        times = self._times(t)
        out, to = self._room(times[0])
        self._query("hd_heat_diagonal", self._kernel(symmetric), *times, *to, None, None)
        return out

    def trace(self, t):
        """The sum of exp(-t lambda) over all eigenvalues for each time, and bounds on its error."""
        times = self._times(t)
        trace, bound = np.zeros((2, times[0]))
        self._query("hd_heat_diagonal", self._kernel(False), *times, None, ctypes.c_size_t(0), trace, bound)
        return trace, bound

    def normalised(self, t):
        """k_t(v,v)/trace: a column for each time."""
        times = self._times(t)
        (out, to), trace = self._room(times[0]), np.zeros(times[0])
        self._query("hd_heat_diagonal", self._kernel(True), *times, *to, trace, None)
        return out / trace

    def scale_invariant(self, t0, t1, n_times=257, n_freq=6):
        """Moduli of Fourier coefficients of the steps of log k_t(v,v) over log t: a column for each frequency."""
        n_times = _int("n_times", n_times, 3)
        n_freq = _int("n_freq", n_freq, 1, (n_times + 1) // 2)
        t0, t1 = _double("t0", t0), _double("t1", t1)
        if not 0 < t0 < t1 < np.inf:
            raise ValueError(f"times need 0 < t0 < t1, and are {t0} and {t1}")
        k = self.diagonal(t0 * (t1 / t0) ** np.linspace(0, 1, n_times))
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = np.diff(np.log(k))
        steps[~np.isfinite(steps).all(axis=1)] = 0          # vertices without mass, or whose value is lost
        return np.abs(np.fft.fft(steps))[:, :n_freq]

    def distance(self, t, sources, kind="HD_DISTANCE_CLASSICAL"):
        """Diffusion distances from each source to every vertex. Commute and biharmonic distances have no time: t is None."""
        (k, sources, _keep), (kind, *times) = _sources("sources", sources), self._distance(t, kind)
        out, to = self._room(k * times[0])
        self._query("hd_heat_distance", kind, *times, sources, *to)
        return out

    def entries(self, t, i, j, symmetric=False):
        """Entries (i, j) of K_t or k_t: a row for each pair, a column for each time."""
        times, (n, i, j) = self._times(t), self._pairs(i, j)
        out = np.zeros((len(i), times[0]), order="F")
        self._query("hd_heat_entries", self._kernel(symmetric), *times, n, i, j, out)
        return out

    def pairs(self, t, i, j, kind="HD_DISTANCE_CLASSICAL"):
        """Diffusion distances of listed pairs, without cancellation: a row for each pair, a column for each time."""
        (kind, *times), (n, i, j) = self._distance(t, kind), self._pairs(i, j)
        out = np.zeros((len(i), times[0]), order="F")
        self._query("hd_heat_distance_pairs", kind, *times, n, i, j, out)
        return out

    @staticmethod
    def _pairs(i, j):
        """As many i as j; one serves many."""
        i, j = _list("i", i), _list("j", j)
        if len(i) != len(j) and 1 not in (len(i), len(j)):
            raise ValueError(f"j has shape {j.shape}, wanted is {i.shape} as that of i, or ()")
        i, j = (np.array(x) for x in np.broadcast_arrays(i, j))
        return ctypes.c_int64(len(i)), i, j

    def sample(self, t, count, given=(), kind="HD_DISTANCE_CLASSICAL"):
        """Farthest points: count vertices beside those given, and the distance of each to all before it."""
        (k, given, _keep), (kind, n_times, t) = _sources("given", given), self._distance(t, kind)
        if n_times != 1:
            raise ValueError(f"t has shape {t.shape}, wanted is ()")
        count = _int("count", count, 1, self.lap.n)
        vertex, distance = np.zeros(count, dtype=np.int32), np.zeros(count)
        self._query("hd_heat_sample", kind, t[0].item(), given if k else None, count, vertex, distance)
        return vertex, distance


class Geodesic(_Object):
    """Distances along a surface by the heat method: of triangles (an array of three columns), of polygons (a list of
    lists), or of points without faces."""

    def __init__(self, xyz, faces=None, **options):
        xyz = _doubles("xyz", xyz, ("n", 3))
        n, options, pointer = len(xyz), _options("hd_geodesic_opts", options, len(xyz)), _Pointer("hd_geodesic_free")
        if faces is None:
            mesh, options.triangulation = _mesh("HD_POINTS", xyz), C["HD_TRIANGULATION_TUFTED"]
        elif isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
            mesh = _mesh("HD_TRIANGLES", xyz, _ints("faces", faces, ("n_tri", 3)))
        else:
            mesh = _mesh("HD_POLYGONS", xyz, faces)
        self._make(pointer, "hd_geodesic_create", ctypes.byref(mesh), ctypes.byref(options))
        self._n = n

    n = property(lambda self: self._n)

    def distance(self, sources):
        """To the nearest of the sources."""
        (_, sources, _keep), d = _sources("sources", sources, together=True), np.zeros(self.n)
        with self._pointer as geodesic:
            _call("hd_geodesic_distance", geodesic, sources, d, ctypes.c_size_t(0), None)
        return d
