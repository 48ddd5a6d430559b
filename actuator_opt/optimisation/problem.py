"""The problem given to the optimiser: a vector function in a box, without physical meaning.

Constraints are relative margins, at least zero if met. An evaluation is a pure function of a batch
of points (one column per point), real or complex. Solver coordinates are logarithms for variables
with a positive lower bound, and multiples of half the box width otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.errors import InputError
from ..base.numeric import Array

Vector: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PointValues:
    """Result of evaluating k points.

    Parameters
    ----------
    objective : (k,), to be minimised
    constraints : (m, k), margins, at least 0 where met; None without constraints
    equalities : (e, k), residuals, 0 where met; None without equalities
    """

    objective: Array
    constraints: Array = None
    equalities: Array = None


@dataclass(frozen=True)
class BoxProblem:
    """Minimise an objective over a box, subject to margins >= 0 and equalities = 0.

    Parameters
    ----------
    names : label of each variable
    lower, upper : finite bounds (n,); equal bounds fix a variable
    evaluate : maps points (n, k), real or complex, to `PointValues`
    constraint_names, equality_names : label of each row of the values
    start : a first guess inside the box, or None
    relaxable : for each constraint, whether it is a requirement (True) or a law such as geometry
        (False)
    groups : for each constraint, a number shared by the rows of one limit, which are relaxed
        together; None gives each its own
    has_complex_step : False if `evaluate` cannot take complex points; finite differences then
    linear : labels of variables to keep linear although their lower bound is positive
    """

    names: Sequence[str]
    lower: Vector
    upper: Vector
    evaluate: Callable[[Array], PointValues]
    constraint_names: Sequence[str] = ()
    equality_names: Sequence[str] = ()
    start: Vector | None = None
    relaxable: Sequence[bool] | None = None
    groups: Sequence[int] | None = None
    has_complex_step: bool = True
    linear: Sequence[str] = ()

    def __post_init__(self) -> None:
        n = len(self.names)
        lower, upper = (np.array(b, dtype=float) for b in (self.lower, self.upper))
        if n == 0:
            raise InputError("an optimisation needs at least one variable")
        if lower.shape != (n,) or upper.shape != (n,):
            raise InputError(f"{n} variables need {n} lower and {n} upper bounds")
        for name, low, high in zip(self.names, lower, upper, strict=True):
            if not (np.isfinite(low) and np.isfinite(high)):
                raise InputError(f"{name}: a bound is missing or not finite; give both bounds")
            if low > high:
                raise InputError(f"{name}: the bounds {low:g} and {high:g} are reversed")
        object.__setattr__(self, "lower", lower)
        object.__setattr__(self, "upper", upper)
        if self.relaxable is not None and len(self.relaxable) != len(self.constraint_names):
            raise InputError("`relaxable` needs one entry per constraint")
        if self.start is not None:
            self._check_start(np.array(self.start, dtype=float))

    def _check_start(self, start: Vector) -> None:
        if start.shape != self.lower.shape:
            raise InputError(f"the start needs {len(self.names)} values")
        room = 1e-9 * (np.abs(self.lower) + np.abs(self.upper))
        for j in map(
            int, np.flatnonzero(~((start >= self.lower - room) & (start <= self.upper + room)))
        ):
            raise InputError(
                f"{self.names[j]}: the start {start[j]:g} is outside its bounds "
                f"{self.lower[j]:g} to {self.upper[j]:g}"
            )
        object.__setattr__(self, "start", np.clip(start, self.lower, self.upper))

    def inside(self, x: Vector) -> Vector:
        """The point of the box nearest to another (n,)."""
        return np.clip(x, self.lower, self.upper)

    @property
    def row_count(self) -> int:
        """Number of rows of an evaluation: objective, constraints, equalities."""
        return 1 + len(self.constraint_names) + len(self.equality_names)

    def rows(self, points: Array) -> npt.NDArray[np.generic]:
        """Objective, constraints and equalities of points (n, k), stacked to (rows, k)."""
        count = points.shape[1]
        with np.errstate(all="ignore"):
            values = self.evaluate(points)
        parts = []
        wanted = (1, len(self.constraint_names), len(self.equality_names))
        given = (values.objective, values.constraints, values.equalities)
        for what, size, part in zip(
            ("objective", "constraints", "equalities"), wanted, given, strict=True
        ):
            if size == 0 and part is None:
                continue
            array = np.asarray(part)
            try:
                array = np.broadcast_to(array.reshape(size, -1) if size else array, (size, count))
            except ValueError:
                message = f"the {what} have shape {array.shape}, expected ({size}, {count})"
                raise InputError(message) from None
            parts.append(array)
        return np.concatenate(parts)


@dataclass(frozen=True)
class ParametricProblem:
    """A problem with parameters that can be priced.

    Parameters
    ----------
    problem : the problem at the present parameter values (its own `evaluate` may be faster)
    parameter_names : label of each parameter (q,)
    parameters : present values (q,)
    evaluate : maps points (n, k) and parameters (q, k) or (q, 1), real or complex, to `PointValues`
    """

    problem: BoxProblem
    parameter_names: Sequence[str]
    parameters: Vector
    evaluate: Callable[[Array, Array], PointValues]

    def __post_init__(self) -> None:
        values = np.array(self.parameters, dtype=float)
        if values.shape != (len(self.parameter_names),):
            raise InputError(f"{len(self.parameter_names)} parameters need as many values")
        object.__setattr__(self, "parameters", values)

    def at(self, parameters: Array) -> BoxProblem:
        """Return the problem at other parameter values (q,)."""
        return self.with_columns(np.asarray(parameters)[:, None])

    def with_columns(self, parameters: Array) -> BoxProblem:
        """The problem with parameter values (q, k) of their own for each of k points."""
        return replace(self.problem, evaluate=lambda x: self.evaluate(x, parameters))


ON_BOUND = 1e-12
"""Share of a range within which a coordinate snaps to its bound: zero is 0, not 1e-23."""


@dataclass(frozen=True)
class Space:
    """The solver's coordinates of a problem: its free variables, logarithmic where positive."""

    problem: BoxProblem
    free: npt.NDArray[np.intp] = field(init=False)
    logarithmic: npt.NDArray[np.bool_] = field(init=False)
    scale: Vector = field(init=False)
    lower: Vector = field(init=False)
    upper: Vector = field(init=False)

    def __post_init__(self) -> None:
        low, high = self.problem.lower, self.problem.upper
        free = np.flatnonzero(high > low)
        kept = np.array([name in self.problem.linear for name in self.problem.names], dtype=bool)
        logarithmic = ((low > 0) & ~kept)[free]
        low, high = low[free], high[free]
        scale = np.where(logarithmic, 1.0, (high - low) / 2)
        for name, value in (
            ("free", free),
            ("logarithmic", logarithmic),
            ("scale", scale),
            ("lower", np.where(logarithmic, np.log(np.where(logarithmic, low, 1.0)), low / scale)),
            (
                "upper",
                np.where(logarithmic, np.log(np.where(logarithmic, high, 1.0)), high / scale),
            ),
        ):
            object.__setattr__(self, name, value)

    @property
    def size(self) -> int:
        """Number of free variables."""
        return len(self.free)

    def to_z(self, x: Vector) -> Vector:
        """Solver coordinates (nf,) of a point (n,) inside the box."""
        inner = x[self.free]
        log = self.logarithmic
        z = np.where(log, np.log(np.where(log, inner, 1.0)), inner / self.scale)
        return np.asarray(np.clip(z, self.lower, self.upper))

    def to_x(self, z: Vector, *, inside: bool = True) -> Vector:
        """Points (n, k) of coordinates (nf, k); exactly on a bound where z is, within rounding.

        `inside=False` lets a finite-difference step leave the box by its own width.
        """
        log, low, high = (
            a[:, None]
            for a in (
                self.logarithmic,
                self.problem.lower[self.free],
                self.problem.upper[self.free],
            )
        )
        inner = np.where(log, np.exp(np.where(log, z, 0.0)), z * self.scale[:, None])
        if inside:
            room = ON_BOUND * (self.upper - self.lower)
            inner = np.where(z <= (self.lower + room)[:, None], low, np.maximum(inner, low))
            inner = np.where(z >= (self.upper - room)[:, None], high, np.minimum(inner, high))
        x = np.repeat(self.problem.lower[:, None], z.shape[1], axis=1)
        x[self.free] = inner
        return x

    def slope(self, x: Vector) -> Vector:
        """dx/dz of the free variables (nf, k) at points (n, k)."""
        return np.where(self.logarithmic[:, None], x[self.free], self.scale[:, None])


@dataclass(frozen=True, slots=True)
class Round:
    """One optimum of the sequence: objective (SI) and share of draws that meet all limits."""

    objective: float
    rate: float


@dataclass(frozen=True, slots=True)
class Robust:
    """Robustness of an optimum with uncertain inputs.

    Parameters
    ----------
    target : requested probability
    rate, lower, upper : probability of meeting all covered limits, with 95 % bounds
    samples : number of independent draws behind the rate
    converged : whether the reserves converged
    nominal_objective, nominal_rate : of the optimum without reserves
    reserves : extra margin a robust search requires, by limit
    rounds : the sequence of optima, the one without reserves first
    left_out : limits not covered: checks that the optimum misses anyway
    sentence : the result in words
    """

    target: float
    rate: float
    lower: float
    upper: float
    samples: int
    converged: bool
    nominal_objective: float
    nominal_rate: float
    reserves: Mapping[str, float]
    rounds: tuple[Round, ...]
    left_out: tuple[str, ...]
    sentence: str

    @property
    def reached(self) -> bool:
        """Whether the independent draws reach the requested probability."""
        return self.rate >= self.target

    def to_dict(self) -> dict[str, Any]:
        """The JSON form (SI)."""
        found = asdict(self)
        for key in ("rate", "lower", "upper"):
            del found[key]
        bounds = {"value": self.rate, "lower": self.lower, "upper": self.upper}
        return found | {"yield": bounds, "left_out": list(self.left_out)}
