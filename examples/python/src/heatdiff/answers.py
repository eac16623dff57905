"""What comes back: arrays that carry a report, and the reports."""
from __future__ import annotations

import dataclasses
from typing import Any, Dict, Optional

import numpy as np

from ._library import plain


@dataclasses.dataclass(frozen=True)
class Report:
    """What a query of Heat did, and how large its errors can be; for several columns or times the worst of them.

    method, reason: the way that was taken, and why. poles, degree, iterations: of that method.
    error_bound: bound on the largest error of any value, relative to the largest value returned. It is the sum of the
    four parts error_rational, error_solver, error_rounding and error_local; each evidence_... says how the part is known: 'proven',
    'measured', 'estimated', or 'none' if it does not apply.
    error_bound_b: bound on |error| / |answer| in the norm of B; infinite if there is none.
    error_relative: bound relative to each value itself (signatures, distances, pairs); infinite if there is none.
    n_lost: distances with at most about one sure digit. smallest: the smallest value that is not zero.
    mass_drift: how much of the heat was lost or gained. residual: of the linear systems.
    n_touched: vertices of the largest part of the mesh that method local worked on. n_patches: into how many pieces it cut
    the mesh for signatures and distances.
    factor_nnz, factor_flops: size of the factors, and operations of the factorisations. status: 'HD_OK' or
    'HD_WARN_ACCURACY'."""
    status: str
    method: str
    reason: str
    poles: str
    degree: int
    iterations: int
    error_bound: float
    error_rational: float
    error_solver: float
    error_rounding: float
    error_local: float
    evidence_rational: str
    evidence_solver: str
    evidence_rounding: str
    evidence_local: str
    error_bound_b: float
    error_relative: float
    n_lost: int
    n_touched: int
    n_patches: int
    smallest: float
    mass_drift: float
    residual: float
    factor_nnz: int
    factor_flops: float


@dataclasses.dataclass(frozen=True)
class GeodesicReport:
    """How a geodesic distance was computed. t: how long heat flowed, length^2. h: mean edge. n_stages: heat solves for a
    column. residual_heat, residual_distance: of the two systems. They say nothing about the error of the heat method
    itself, which is about one edge length."""
    status: str
    t: float
    h: float
    n_components: int
    n_stages: int
    residual_heat: float
    residual_distance: float


@dataclasses.dataclass(frozen=True)
class Estimate:
    """What a query would take: method and reason, seconds of one idle core within a factor of two, and bytes beyond those in
    use. fits: whether memory_limit allows it. costs: by method, each a dictionary with possible, fits, flops, seconds and
    bytes."""
    method: str
    reason: str
    fits: bool
    seconds: float
    bytes: float
    costs: Dict[str, Dict[str, Any]]


def report(kind: type, struct: Any, status: str) -> Any:
    """A dataclass from the struct of the same fields."""
    found = dict(plain(struct), status=status)
    return kind(**{f.name: found[f.name] for f in dataclasses.fields(kind)})


class Answer(np.ndarray):
    """An array with a report. Parts of it have the report too; what is computed from it is a plain array."""
    report: Optional[Any]

    def __new__(cls, values: np.ndarray, report: Any) -> "Answer":
        made = np.asarray(values).view(cls)
        made.report = report
        return made

    def __array_finalize__(self, other: Any) -> None:
        self.report = getattr(other, "report", None)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        def bare(x: Any) -> Any:
            return x.view(np.ndarray) if isinstance(x, Answer) else x
        if "out" in kwargs:
            kwargs["out"] = tuple(map(bare, kwargs["out"]))
        return getattr(ufunc, method)(*map(bare, inputs), **kwargs)
