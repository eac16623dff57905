"""Calls of the shared library: loading, errors, warnings, lifetimes, locks, Ctrl-C and progress."""
from __future__ import annotations

import contextlib
import ctypes
import glob
import os
import signal
import sys
import threading
import warnings
from typing import Any, Callable, Dict, Iterator, Optional, Tuple, Union

import numpy as np

from . import _bindings as c
from . import arrays

Progress = Union[None, bool, Callable[[str, float], Optional[bool]]]
CONTINUE, CANCEL = c.CHOICES["hd_progress"]["continue"], c.CHOICES["hd_progress"]["cancel"]
NAMES = {kind: {number: name for name, number in names.items()} for kind, names in c.CHOICES.items()}
TYPES: Dict[Any, Any] = {np.dtype(t): p for t, p in ((np.float64, ctypes.c_double), (np.int32, ctypes.c_int32), (np.int64, ctypes.c_int64))}


def _load() -> ctypes.CDLL:
    """The library beside this file, or the one that HEATDIFF_LIBRARY names."""
    here = os.path.dirname(os.path.abspath(__file__))
    beside = [f for f in glob.glob(os.path.join(here, "libheatdiff.*")) if f.endswith((".so", ".dylib", ".dll", ".pyd"))]
    path = os.environ.get("HEATDIFF_LIBRARY") or (beside[0] if beside else "")
    if not path:
        raise ImportError("heatdiff has no compiled library: install it with pip, or name a shared library in HEATDIFF_LIBRARY")
    lib = ctypes.CDLL(os.path.abspath(path))
    for name, (result, *arguments) in c.FUNCTIONS.items():
        try:
            function = getattr(lib, name)
        except AttributeError:
            raise ImportError(f"{path} is another version than heatdiff {c.VERSION}: it has no {name}") from None
        function.restype, function.argtypes = result, arguments
    return lib


class Error(Exception):
    """What the library refused or could not do.

    status: name of the status, such as 'HD_ERR_NOT_FINITE'. text: one line for people. face, vertex, row, column, pole:
    where in the input, or None. value: the offending value, 0 if there is none. hd_status and hd_error in heatdiff.h say
    more."""

    def __init__(self, status: str, text: str, value: float = 0.0, **where: int):
        self.status, self.text, self.value = status, text, value
        self.face, self.vertex, self.row, self.column, self.pole = (
            where[k] if where.get(k, -1) >= 0 else None for k in ("face", "vertex", "row", "column", "pole"))
        places = ", ".join(f"{k} {where[k]}" for k in where if where[k] >= 0)
        super().__init__(text + (f" ({places})" if places else ""))

    def __reduce__(self) -> Any:                                # so that it arrives from other processes
        return _same_error, (type(self), self.args, self.__dict__)


def _same_error(kind: type, args: tuple, fields: dict) -> Error:
    made = kind.__new__(kind, *args)
    made.args, made.__dict__ = args, fields
    return made



class InputError(Error, ValueError):
    """An argument that the library refused: an index out of range, a number that is not finite, a time below zero."""


class OutOfMemoryError(Error, MemoryError):
    """There is no more memory, or memory_limit is reached; value is the limit that would do, if it is known."""


class CancelledError(Error):
    """The progress function returned False."""


class AccuracyWarning(UserWarning):
    """The bound on the error of an answer says little; the answer's report has the numbers."""


_KINDS = {"HD_ERR_MEMORY": OutOfMemoryError, "HD_ERR_MEMORY_LIMIT": OutOfMemoryError, "HD_ERR_CANCELLED": CancelledError,
          "HD_ERR_NOT_CONVERGED": Error, "HD_ERR_BREAKDOWN": Error, "HD_ERR_NOT_BUILT": Error}


def _raise(status: int, error: c.hd_error) -> None:
    name, text = c.STATUS.get(status, (str(status), "unknown status"))
    raise _KINDS.get(name, InputError)(
        name, error.text.decode("utf-8", "replace") or text, error.value, face=error.face, vertex=error.vertex,
        row=error.row, column=error.column, pole=error.pole)


def doubt(text: str) -> None:
    """A warning that names the line of the user's own code."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back and os.path.dirname(frame.f_code.co_filename) == os.path.dirname(__file__):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, AccuracyWarning, stacklevel=level)


def _bytes(x: Any) -> int:
    """2e9 is a number of bytes too."""
    return arrays.integer("memory_limit", int(x) if isinstance(x, float) and x.is_integer() else x, 0, 2 ** 62)


class Context:
    """Threads, memory limit and progress of one object. It lives as long as the object."""

    def __init__(self, threads: Optional[int], memory_limit: Optional[int], progress: Progress, other: Optional["Context"] = None):
        given: Tuple[int, int, Progress] = other.given if other else (0, 0, None)
        self.given: Tuple[int, int, Progress] = (given[0] if threads is None else arrays.integer("threads", threads, 0, 1024),
                      given[1] if memory_limit is None else _bytes(memory_limit),
                      given[2] if progress is None else progress)
        self.struct = c.hd_context(n_threads=self.given[0], byte_limit=self.given[1])
        self.progress: Any = self.given[2]
        self.bar: Any = None
        self.stage = ""
        if self.progress is True:
            self.progress = self._tqdm
            try:
                import tqdm  # noqa: F401
            except ImportError:
                raise ModuleNotFoundError("progress=True needs tqdm; a function of a stage and a number from 0 to 1 "
                                          "does as well") from None
        elif self.progress not in (None, False) and not callable(self.progress):
            raise TypeError(f"progress is {self.progress!r}, wanted is True, False or a function")
        self.failed: Optional[BaseException] = None
        self.interrupted = False
        kind = type(self.struct.progress)
        self._callback, self._nothing = kind(self._step), kind()

    def _tqdm(self, stage: str, done: float) -> None:
        import tqdm.auto
        if self.bar is None or self.stage != stage:
            self._end_bar()
            self.stage, self.bar = stage, tqdm.auto.tqdm(total=1, desc=stage, leave=False, bar_format="{desc}: {percentage:3.0f}%|{bar}|")
        self.bar.update(max(0.0, done - self.bar.n))

    def _end_bar(self) -> None:
        if self.bar is not None:
            self.bar.close()
            self.bar = None

    def _step(self, _user: Any, stage: bytes, done: float) -> int:
        """Called by the library. Nothing may be raised through C: what the user's function raises is kept."""
        if self.progress and not self.interrupted:
            try:
                if self.progress(stage.decode(), done) is False:
                    return CANCEL
            except BaseException as error:
                self.failed = error
                return CANCEL
        return CANCEL if self.interrupted else CONTINUE

    def _interrupt(self, *_: Any) -> None:
        self.interrupted = True

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        """Around a call. Ctrl-C, which Python would only look at when the call is over, cancels it. Only the main thread
        can be interrupted; other threads need no callback, and then never wait for the GIL."""
        before: Any = signal.getsignal(signal.SIGINT) if threading.current_thread() is threading.main_thread() else None
        self.failed, self.interrupted = None, False
        self.struct.progress = self._callback if self.progress or callable(before) else self._nothing
        if callable(before):
            signal.signal(signal.SIGINT, self._interrupt)
        try:
            yield
        finally:
            if callable(before):
                signal.signal(signal.SIGINT, before)
            self._end_bar()
        if self.interrupted:
            before(signal.SIGINT, sys._getframe())              # raises KeyboardInterrupt, if it is Python's
        if self.failed:
            failed, self.failed = self.failed, None
            raise failed


def call(context: Context, name: str, *args: Any, warn: bool = True) -> int:
    """Calls a function whose last argument is the error. Arrays go as pointers of their own type."""
    function, error = getattr(lib, name), c.hd_error()
    with context.running():
        status = function(*map(pointer, args), ctypes.byref(error))
    if status < 0:
        _raise(status, error)
    if status > 0 and warn:
        doubt(error.text.decode() or c.STATUS.get(status, ("", "see the report"))[1])
    return status


def pointer(x: Any) -> Any:
    return x.ctypes.data_as(ctypes.POINTER(TYPES[x.dtype])) if isinstance(x, np.ndarray) else x


def attach(struct: Any, **given: np.ndarray) -> None:
    """Sets pointers of a struct, and keeps their arrays alive with it, as ctypes does not."""
    for name, array in given.items():
        setattr(struct, name, pointer(array))
    struct.kept = {**getattr(struct, "kept", {}), **given}


def plain(struct: ctypes.Structure) -> dict:
    """The numbers and texts of a struct: enumerations by their names, no pointers."""
    found: Dict[str, Any] = {}
    for key, *_ in struct._fields_:
        value = getattr(struct, key)
        kind = struct.choices.get(key)                          # type: ignore[attr-defined]
        if kind in NAMES:
            found[key] = NAMES[kind].get(value, value)
        elif isinstance(value, bytes):
            found[key] = value.decode()
        elif isinstance(value, (int, float)):
            found[key] = value
    return found


class Turn:
    """A lock that says so where a thread would wait for itself."""

    def __init__(self) -> None:
        self.lock, self.worker = threading.Lock(), 0

    def __enter__(self) -> None:
        if self.worker == threading.get_ident():
            raise RuntimeError("this object is at work: its progress function cannot use it")
        self.lock.acquire()
        self.worker = threading.get_ident()

    def __exit__(self, *_: Any) -> None:
        self.worker = 0
        self.lock.release()


class Handle:
    """The address of what the library made. What was made from it is freed before it, in whatever order Python drops them:
    a Laplacian lists its plans. One thread at a time works on it, and nobody while close() runs."""

    def __init__(self, kind: Any, free: str, context: Context, owner: Optional["Handle"] = None):
        self.pointer, self.freed_by, self.context, self.owner = ctypes.POINTER(kind)(), getattr(lib, free), context, owner
        self.turn = Turn()
        self.plans: Dict[int, tuple] = {}

    def make(self, name: str, *args: Any) -> None:
        if self.owner:                                          # before the call, which Ctrl-C may end although it succeeds
            self.owner.plans[id(self)] = (self.pointer, self.freed_by, self.context, self.turn)
        call(self.context, name, ctypes.byref(self.pointer), *args)

    @property
    def open(self) -> bool:
        return bool(self.pointer) and (self.owner is None or id(self) in self.owner.plans)

    @contextlib.contextmanager
    def use(self, exclusive: bool = False) -> Iterator[Any]:
        """The address, while no other thread uses it; exclusive: nor any of its plans."""
        with contextlib.ExitStack() as turns:
            turns.enter_context(self.turn)
            for _, _, _, turn in list(self.plans.values()) if exclusive else ():
                turns.enter_context(turn)
            if not self.open:
                raise ValueError("this object is closed, or the Laplacian under it")
            yield self.pointer

    def free(self) -> None:
        """Frees it once. The lists are dictionaries, from which only one thread can take an entry."""
        mine = self.pointer if self.owner is None else (self.owner.plans.pop(id(self), None) or (None,))[0]
        if mine:
            while self.plans:
                made, freed_by, _context, _turn = self.plans.popitem()[1]
                freed_by(made)
            self.freed_by(mine)
        self.pointer = type(self.pointer)()

    def close(self) -> None:
        if self.open:
            with self.use(exclusive=True):
                self.free()

    def __del__(self) -> None:
        self.free()


class Object:
    """Something that the library made. close() or a with block frees it at once; afterwards its methods raise."""
    _handle: Handle

    def close(self) -> None:
        """Frees the memory now, and that of what was made from it. Later calls raise ValueError."""
        self._handle.close()

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled")


lib = _load()
