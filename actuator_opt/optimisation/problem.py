"""The optimisation problem: a vector function within bounds, without physical meaning.

Constraints are relative margins, at least zero if met. An evaluation is a pure function of several
real or complex points, one per column. In solver coordinates, variables with a positive lower bound
are logarithms. Other variables are divided by half the distance between their bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, field, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.numeric import STEP, Array

Vector: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PointValues:
    """Objective, constraints and equalities at k points.

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
    """Minimise an objective within bounds, subject to margins >= 0 and equalities = 0.

    Parameters
    ----------
    names : label of each variable
    lower, upper : finite bounds (n,); equal bounds fix a variable
    evaluate : maps points (n, k), real or complex, to `PointValues`
    constraint_names, equality_names : label of each row of the values
    start : a first guess within the bounds, or None
    relaxable : for each constraint, True for a requirement, False for a law such as geometry
    groups : for each constraint, the number of the limit to which it belongs. Constraints of one
        limit are relaxed together. None: each constraint is a limit of its own
    has_complex_step : False if `evaluate` only takes real points; then gradients are finite
        differences
    linear : labels of variables that are not scaled logarithmically although their lower bound is
        positive
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

    def same_rows_and_box(self, other: BoxProblem) -> bool:
        """Whether another problem has the same constraints and bounds."""
        return (
            tuple(self.constraint_names) == tuple(other.constraint_names)
            and np.array_equal(self.lower, other.lower)
            and np.array_equal(self.upper, other.upper)
        )

    def inside(self, x: Vector) -> Vector:
        """The point within the bounds that is nearest to another point (n,)."""
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
        arrays = []
        sizes = (1, len(self.constraint_names), len(self.equality_names))
        evaluated = (values.objective, values.constraints, values.equalities)
        for kind, size, part in zip(
            ("objective", "constraints", "equalities"), sizes, evaluated, strict=True
        ):
            if size == 0 and part is None:
                continue
            array = np.asarray(part)
            try:
                array = np.broadcast_to(array.reshape(size, -1) if size else array, (size, count))
            except ValueError:
                message = f"the {kind} have the shape {array.shape}, not ({size}, {count})"
                raise InputError(message) from None
            arrays.append(array)
        return np.concatenate(arrays)


@dataclass(frozen=True)
class ParametricProblem:
    """A problem with parameters whose prices can be computed.

    Parameters
    ----------
    problem : the problem at the present parameter values; its own `evaluate` may be faster than the
        `evaluate` below
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

    @classmethod
    def of(cls, problem: BoxProblem) -> ParametricProblem:
        """A problem without parameters."""
        return cls(problem, (), np.zeros(0), lambda x, _: problem.evaluate(x))

    def at(self, parameters: Array) -> BoxProblem:
        """The problem at other parameter values (q,)."""
        return self.with_columns(np.asarray(parameters)[:, None])

    def with_columns(self, parameters: Array) -> BoxProblem:
        """The problem with separate parameter values (q, k) for each of k points."""
        return replace(self.problem, evaluate=lambda x: self.evaluate(x, parameters))


ON_BOUND = 1e-12
"""A coordinate this close to a bound, as a share of the range, is set to the bound (for
example, 1e-23 to 0)."""


@dataclass(frozen=True)
class Space:
    """The solver's coordinates: free variables, as logarithms if the lower bound is positive."""

    problem: BoxProblem
    free: npt.NDArray[np.intp] = field(init=False)
    logarithmic: npt.NDArray[np.bool_] = field(init=False)
    scale: Vector = field(init=False)
    lower: Vector = field(init=False)
    upper: Vector = field(init=False)

    def __post_init__(self) -> None:
        low, high = self.problem.lower, self.problem.upper
        free = np.flatnonzero(high > low)
        linear = np.array([name in self.problem.linear for name in self.problem.names], dtype=bool)
        logarithmic = ((low > 0) & ~linear)[free]
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
        """Solver coordinates (nf,) of a point (n,) within the bounds."""
        inner = x[self.free]
        log = self.logarithmic
        z = np.where(log, np.log(np.where(log, inner, 1.0)), inner / self.scale)
        return np.asarray(np.clip(z, self.lower, self.upper))

    def to_x(self, z: Vector, *, inside: bool = True) -> Vector:
        """Points (n, k) at coordinates z (nf, k); a coordinate on a bound gives exactly the bound.

        `inside=False` permits points beyond the bounds, for finite-difference steps.
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
        """Derivatives dx/dz (nf, k) of free variables x at points (n, k); z: solver coordinates."""
        return np.where(self.logarithmic[:, None], x[self.free], self.scale[:, None])

    def complex_steps(self, x: Vector) -> npt.NDArray[np.complex128]:
        """Copies of the points x with a complex step in each coordinate in turn (n, k nf)."""
        count = x.shape[1]
        batch = np.repeat(x.astype(complex), self.size, axis=1)
        columns = np.arange(count * self.size).reshape(count, self.size)
        batch[self.free[None, :], columns] += 1j * STEP * self.slope(x).T
        return batch

    @property
    def reference(self) -> Vector:
        """Coordinates of the start, or else of the middle between the bounds."""
        start = self.problem.start
        return (self.lower + self.upper) / 2 if start is None else self.to_z(start)


@dataclass(frozen=True, slots=True)
class Round:
    """One optimum of the robust search: objective (SI), share of draws that meet all limits."""

    objective: float
    rate: float


@dataclass(frozen=True, slots=True)
class Robust:
    """Robustness of an optimum against uncertain inputs.

    Parameters
    ----------
    target : requested probability
    rate, lower, upper : probability of meeting all covered limits, with its 95 % confidence
        interval
    samples : number of independent draws from which the rate was counted
    converged : whether the reserves (added margins) converged
    nominal_objective, nominal_rate : objective and rate of the optimum without reserves
    reserves : margin added for scatter, by limit
    rounds : the optima in sequence; the first is without reserves
    left_out : limits that are not covered, because the optimum misses these checks anyway
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
        """Whether the rate in independent draws reaches the requested probability."""
        return self.rate >= self.target

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON data (SI)."""
        result = asdict(self)
        for key in ("rate", "lower", "upper"):
            del result[key]
        bounds = {"value": self.rate, "lower": self.lower, "upper": self.upper}
        return result | {"yield": bounds, "left_out": list(self.left_out)}
