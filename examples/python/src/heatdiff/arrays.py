"""Checks of arguments. Each takes the argument's name for its errors: a wrong shape or range is a ValueError, a wrong
type a TypeError."""
from __future__ import annotations

import difflib
import functools
import inspect
import operator
from typing import Any, Callable, Iterable, List, Sequence, Tuple, TypeVar

import numpy as np

from . import _bindings as c

F = TypeVar("F", bound=Callable[..., Any])
INT_MIN, INT_MAX = -2 ** 31, 2 ** 31 - 1


def near(word: Any, words: Iterable[str]) -> str:
    """The word most like this one, and all of them."""
    words = list(words)
    like = difflib.get_close_matches(str(word), words, 1, 0.6)
    return (f"did you mean {like[0]}? " if like else "") + f"There are {', '.join(words)}"


def options(function: F) -> F:
    """Refuses names that the function does not have, and values beyond those that go by place; says which there are."""
    parameters = [p for p in inspect.signature(function).parameters.values()]
    known = [p.name for p in parameters if p.name not in ("self", "cls")]
    placed = [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
    what = function.__qualname__.replace(".__init__", "")

    @functools.wraps(function)
    def checked(*args: Any, **given: Any) -> Any:
        if len(args) > len(placed):
            extra = len(placed) - len([x for x in placed if x in known])
            raise TypeError(f"{what} takes {', '.join(placed[extra:])} by place and all else by name, given are {len(args) - extra} values")
        for key in given:
            if key not in known:
                raise TypeError(f"{what} has no option {key}: {near(key, known)}")
        return function(*args, **given)

    return checked                                              # type: ignore[return-value]


def choice(name: str, x: Any, kind: str, without: Sequence[str] = ()) -> int:
    """The number of a choice, which is given by its word."""
    words = {k: v for k, v in c.CHOICES[kind].items() if k not in without}
    if not isinstance(x, str):
        raise TypeError(f"{name} is {x!r}, wanted is one of {', '.join(words)}")
    word = x.lower().replace("_", "-")
    if word not in words:
        raise ValueError(f"{name} is {x!r}: {near(word, words)}")
    return words[word]


def integer(name: str, x: Any, least: int = INT_MIN, most: int = INT_MAX) -> int:
    """x as an integer in this range. True and False are 1 and 0."""
    try:
        n = operator.index(bool(x) if isinstance(x, np.bool_) else x)
    except TypeError:
        raise TypeError(f"{name} is {x!r}, wanted is an integer") from None
    if not least <= n <= most:
        raise ValueError(f"{name} is {n}, wanted is an integer from {least} to {most}")
    return n


def _array(name: str, x: Any, shapes: Sequence[tuple], kinds: str, dtype: Any) -> np.ndarray:
    """A contiguous copy of x, which no other thread can change. Its shape must be one of shapes, in which a name stands
    for any number, and its dtype of one of the kinds."""
    try:
        a = np.asarray(x)
    except Exception as error:
        raise ValueError(f"{name} is no array: {error}") from None
    wanted = "numbers" if "f" in kinds else "integers"
    if isinstance(x, np.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array, wanted are {wanted} without a mask")
    if a.dtype.kind not in kinds and not (a.size == 0 and a.dtype == np.float64):        # as an empty list is
        raise TypeError(f"{name} has dtype {a.dtype} and shape {a.shape}, wanted are {wanted}")
    if not any(len(s) == a.ndim and all(isinstance(m, str) or m == n for m, n in zip(s, a.shape)) for s in shapes):
        text = " or ".join("(" + ", ".join(map(str, s)) + ("," if len(s) == 1 else "") + ")" for s in shapes)
        raise ValueError(f"{name} has shape {a.shape}, wanted is {text}")
    if dtype == np.int32 and a.size:
        for extreme in a.min(), a.max():
            integer(name, extreme)
    with np.errstate(over="ignore"):
        return np.array(a, dtype=dtype, order="C", subok=False)


def doubles(name: str, x: Any, *shapes: tuple, kinds: str = "iuf") -> np.ndarray:
    return _array(name, x, shapes, kinds, np.float64)


def ints(name: str, x: Any, *shapes: tuple) -> np.ndarray:
    return _array(name, x, shapes, "iu", np.int32)


def number(name: str, x: Any) -> float:
    return float(doubles(name, x, ()))


def vertices(name: str, x: Any) -> np.ndarray:
    """One index or several."""
    return ints(name, x, (), ("any",)).reshape(-1)


def positions(name: str, x: Any) -> np.ndarray:
    return doubles(name, x, ("n", 3))


def faces(name: str, x: Any) -> Tuple[np.ndarray, np.ndarray]:
    """Where each polygon begins among the corners of all, and the corners. x: lists of vertices, or an (m, k) array."""
    try:
        x = list(x)
        lists = [np.asarray(f) for f in x]
    except Exception as error:
        raise TypeError(f"{name} are no lists of vertices: {error}") from None
    for k, (given, f) in enumerate(zip(x, lists)):
        if f.ndim != 1 or f.size and f.dtype.kind not in "iu" or isinstance(given, np.ma.MaskedArray):
            ints(f"{name}[{k}]", given, ("corners",))
    ptr = np.cumsum([0] + [len(f) for f in lists], dtype=np.int64)
    corners: List[Any] = [f for f in lists if len(f)] or [[]]
    return ptr, ints(name, np.concatenate(corners), ("corners",))


def csr(name: str, a: Any) -> Tuple[int, np.ndarray, np.ndarray, np.ndarray]:
    """n, row_ptr, col and val of a square matrix: of scipy.sparse; a tuple (data, indices, indptr) or an object with these
    three; or a vector, the diagonal."""
    if isinstance(a, np.ndarray) and a.ndim == 1:
        val = doubles(name, a, ("n",))
        ptr, col = np.arange(len(val) + 1), np.arange(len(val))
    elif hasattr(a, "tocsr"):
        if len(a.shape) != 2 or a.shape[0] != a.shape[1]:
            raise ValueError(f"{name} has shape {a.shape}, wanted is a square matrix")
        if hasattr(a, "check_format"):                          # its indices may have been changed by hand
            a.check_format()
        a = a.tocsr(copy=True)
        a.sum_duplicates()
        ptr, col, val = a.indptr, a.indices, a.data
    elif isinstance(a, tuple) and len(a) == 3 or all(hasattr(a, k) for k in ("data", "indices", "indptr")):
        val, col, ptr = a if isinstance(a, tuple) else (a.data, a.indices, a.indptr)
    else:
        what = f"{type(a).__name__} of shape {a.shape}" if isinstance(a, np.ndarray) else type(a).__name__
        raise TypeError(f"{name} is a {what}, wanted is a matrix of scipy.sparse or a tuple (data, indices, indptr)")
    ptr = _array(f"{name}.indptr", ptr, [("n + 1",)], "iu", np.int64)
    val = doubles(f"{name}.data", val, ("nnz",))
    col = ints(f"{name}.indices", col, (len(val),))
    n = integer(f"the size of {name}", len(ptr) - 1, 0)
    if n < 0 or ptr[0] != 0 or ptr[-1] != len(val) or (np.diff(ptr) < 0).any():
        raise ValueError(f"{name}.indptr does not ascend from 0 to the number of entries, {len(val)}")
    if not np.isfinite(val).all():
        raise ValueError(f"{name} has an entry that is not finite")
    return n, ptr, col, val
