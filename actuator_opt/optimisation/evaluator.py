"""Evaluates a problem for the solvers: values and exact gradients, computed once per point.

Values come from real arithmetic, so that a domain error (such as the root of a negative number)
becomes NaN. Gradients come from one batched complex step [Squire1998]. They are compared with
finite differences once. Rows (objective or margins) that disagree use central differences.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.numeric import STEP
from .problem import BoxProblem, Space, Vector

CHUNK = 4096
"""Maximum number of points in one model call."""

DIFFERENCE_STEP = 6e-6
"""Step for central differences of values, in solver coordinates: near the cube root of the machine
precision."""

HESSIAN_STEP = 1e-5
"""Step for central differences of exact gradients, which give the Hessian."""

CEILING = 1e9
"""Number that replaces the infinite margin of an unloaded part; its slope is zero."""


class LimitReached(Exception):
    """Raised when the limit of evaluations or time of a run is reached."""


@dataclass(slots=True)
class Point:
    """One evaluated point in solver coordinates."""

    z: Vector
    x: Vector
    rows: Vector
    valid: bool
    violation: float
    jacobian: Vector | None = None

    @property
    def objective(self) -> float:
        """Value of the objective, to be minimised."""
        return float(self.rows[0])


class Evaluator:
    """Values, gradients and Hessians of a problem, in solver coordinates.

    The rows of an array are the objective, the constraints and the equalities; nf is the number of
    free variables.

    Parameters
    ----------
    problem : the problem
    max_evaluations, max_seconds : limits after which `point` raises `LimitReached`
    stop : called before every evaluation; `point` raises `LimitReached` once it returns True
    """

    def __init__(
        self,
        problem: BoxProblem,
        *,
        max_evaluations: int | None = None,
        max_seconds: float | None = None,
        stop: Callable[[], bool] | None = None,
    ) -> None:
        self.problem = problem
        self.stop = stop
        self.space = Space(problem)
        self.constraint_count = len(problem.constraint_names)
        self.max_evaluations = max_evaluations
        self.max_seconds = max_seconds
        self.began = time.perf_counter()
        self.limited = True
        self.exhausted = False
        self.evaluations = 0
        self.gradients = 0
        self.invalid = 0
        self.bad_slopes = 0
        self.complex_works = problem.has_complex_step
        self.eager = False
        """Whether every evaluation also computes the gradient, for solvers that need both."""
        self.difference_rows = np.zeros(problem.row_count, dtype=bool)
        self.influence = np.zeros((2, self.space.size))
        self.trace: list[tuple[int, float, float]] = []
        self.best: Point | None = None
        self.precomputed: dict[bytes, npt.NDArray[np.generic]] = {}
        """By a point's coordinates: results computed in advance at the complex points `columns`."""
        self.judged: dict[tuple[bytes, bool, float, bool], Any] = {}
        """Optimality conditions of points, see `kinks.check`."""
        self.bends: dict[tuple[bytes, float], Any] = {}
        """Kinks near points, see `kinks`."""
        self._cache: dict[bytes, Point] = {}

    @property
    def late(self) -> bool:
        """Whether the time limit is reached or the caller wants the run to stop."""
        elapsed = time.perf_counter() - self.began
        timed_out = self.max_seconds is not None and elapsed >= self.max_seconds
        return timed_out or (self.stop is not None and self.stop())

    def check_limits(self) -> None:
        """Raise `LimitReached` if the limit of evaluations or time is reached."""
        if not self.limited:
            return
        counted_out = self.max_evaluations is not None and self.evaluations >= self.max_evaluations
        if counted_out or self.late:
            self.exhausted = True
            raise LimitReached

    def point(self, z: Vector) -> Point:
        """The evaluated point at z (nf,), from the cache if already known."""
        point = self._cache.get(z.tobytes())
        if point is not None:
            return point
        precomputed = self.precomputed.pop(z.tobytes(), None)
        if precomputed is not None:
            return self.enter(z, precomputed)
        self.check_limits()
        slopes = None
        if self.eager and self.exact:
            rows, slopes = self.values_and_slopes(self.problem.rows(self.columns(z[:, None])))
        else:
            rows = self.screen(self.problem.rows(self.space.to_x(z[:, None])))
        return self._store(z, rows, slopes)

    def adopt_check(self, checked: Evaluator) -> None:
        """Reuse the gradient check of another evaluator; its problem has the same constraints."""
        self.complex_works = checked.complex_works
        self.difference_rows = checked.difference_rows

    @property
    def exact(self) -> bool:
        """Whether every gradient comes from the complex step, none from differences."""
        return self.complex_works and not self.difference_rows.any() and self.space.size > 0

    def _store(self, z: Vector, rows: Vector, slopes: Vector | None) -> Point:
        """Count a point, and store it with its values in the cache."""
        valid = bool(np.isfinite(rows).all())
        self.evaluations += 1
        self.invalid += not valid
        x = self.space.to_x(z[:, None])[:, 0]
        point = Point(z.copy(), x, rows[:, 0], valid, float(self.violations(rows, "worst")[0]))
        if slopes is not None and valid:
            self.gradients += 1
            self._store_jacobian(point, slopes)
        if len(self._cache) >= 256:
            self._cache.clear()
        self._cache[z.tobytes()] = point
        if valid:
            self._record(point)
        return point

    def enter(self, z: Vector, rows: npt.NDArray[np.generic]) -> Point:
        """The point at z (nf,), from results computed before at the complex points `columns`."""
        return self._store(z, *self.values_and_slopes(rows))

    def enter_precomputed(self) -> None:
        """Enter all points computed in advance, as if they had been evaluated."""
        for z, rows in self.precomputed.items():
            self.enter(np.frombuffer(z), rows)
        self.precomputed.clear()

    def _record(self, point: Point) -> None:
        """Add a point to the trace if it is better than the last point of the trace."""
        excess = point.violation if point.violation > 1e-6 else 0.0
        if self.trace:
            _, objective, violation = self.trace[-1]
            if (excess, point.objective) >= (violation if violation > 1e-6 else 0.0, objective):
                return
        self.best = point
        self.trace.append((self.evaluations, point.objective, point.violation))

    def batch(self, z: Vector) -> Vector:
        """Values (rows, k) at coordinates (nf, k), in one call; NaN where the model has none."""
        return self.screen(self.problem.rows(self.space.to_x(z)))

    @staticmethod
    def screen(rows: npt.NDArray[np.generic]) -> Vector:
        """Replace infinite margins by `CEILING`, and other infinite values by NaN."""
        values = np.array(rows.real, dtype=float)
        margins = values[1:]
        margins[margins == np.inf] = CEILING
        values[np.isinf(values)] = np.nan
        return values

    def violations(self, rows: Vector, kind: str) -> Vector:
        """Infeasibility (k,) of k points: the "worst" violation, or a "sum" of bounded violations.

        The sum adds v/(1 + v) for every violation v, so that no row dominates. NaN counts as
        infinitely infeasible.
        """
        margins = rows[1 : 1 + self.constraint_count]
        missed = np.concatenate([np.maximum(-margins, 0.0), np.abs(rows[1 + len(margins) :])])
        if kind == "worst":
            result = missed.max(axis=0, initial=0.0)
        else:
            result = (missed / (1.0 + missed)).sum(axis=0)
        return np.where(np.isfinite(rows).all(axis=0), result, np.inf)

    def jacobian(self, point: Point) -> Vector:
        """Gradients (rows, nf) at a point, in solver coordinates; an undefined slope becomes 0."""
        if point.jacobian is None:
            return self._store_jacobian(point, self.jacobians(point.z[:, None])[:, 0])
        return point.jacobian

    def take_slopes(self, points: Sequence[Point]) -> None:
        """Compute the gradients at several points in one model call."""
        slopes = self.jacobians(np.stack([point.z for point in points], axis=1))
        for k, point in enumerate(points):
            self._store_jacobian(point, slopes[:, k])

    def _store_jacobian(self, point: Point, slopes: Vector) -> Vector:
        broken = ~np.isfinite(slopes)
        if broken.any():
            self.bad_slopes += 1
            slopes = np.where(broken, 0.0, slopes)
        point.jacobian = slopes
        row = np.abs(slopes)
        self.influence[0] = np.maximum(self.influence[0], row[0])
        self.influence[1] = np.maximum(self.influence[1], row.max(axis=0))
        return slopes

    def columns(self, z: Vector) -> npt.NDArray[np.complex128]:
        """Complex points (n, nf) whose results give value and gradient at coordinates (nf, 1)."""
        return self.space.complex_steps(self.space.to_x(z))

    def values_and_slopes(self, rows: npt.NDArray[np.generic]) -> tuple[Vector, Vector]:
        """Values (rows, 1) and gradients (rows, nf) of a point, from results at its `columns`.

        Outside its domain, a complex root or logarithm has a large imaginary part instead of NaN.
        Such rows become NaN.
        """
        hidden = (np.abs(rows.imag) > 1e-9 * (1.0 + np.abs(rows.real))).any(axis=1)
        values = self.screen(np.where(hidden, np.nan, rows.real[:, 0])[:, None])
        return values, np.asarray(rows.imag / STEP, dtype=float)

    def jacobians(self, z: Vector, *, inside: bool = True) -> Vector:
        """Gradients (rows, k, nf) at coordinates (nf, k); NaN where a slope does not exist."""
        size = max(1, CHUNK // max(1, self.space.size))
        parts = [
            self._jacobian_chunk(z[:, i : i + size], inside=inside)
            for i in range(0, z.shape[1], size)
        ]
        self.gradients += z.shape[1]
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)

    def _jacobian_chunk(self, z: Vector, *, inside: bool) -> Vector:
        rows, (n, count) = self.problem.row_count, z.shape
        if self.complex_works and not self.difference_rows.all():
            result = self._complex_step(z, inside=inside)
            if self.difference_rows.any():
                result[self.difference_rows] = self._differences(z)[self.difference_rows]
            return result
        return self._differences(z) if n else np.zeros((rows, count, 0))

    def _complex_step(self, z: Vector, *, inside: bool) -> Vector:
        n, count = z.shape
        rows = self.problem.rows(self.space.complex_steps(self.space.to_x(z, inside=inside)))
        return np.asarray(rows.imag / STEP, dtype=float).reshape(len(rows), count, n)

    def _differences(self, z: Vector) -> Vector:
        n, count = z.shape
        step = DIFFERENCE_STEP * np.eye(n)[:, None, :]
        points = [(z[:, :, None] + sign * step).reshape(n, count * n) for sign in (1, -1)]
        above, below = (
            self.screen(self.problem.rows(self.space.to_x(point_set, inside=False)))
            for point_set in points
        )
        slopes = (above - below) / (2 * DIFFERENCE_STEP)
        broken = np.isnan(slopes)
        if broken.any():
            slopes = np.where(broken, self._one_sided(z, above, below), slopes)
        return slopes.reshape(len(slopes), count, n)

    def _one_sided(self, z: Vector, above: Vector, below: Vector) -> Vector:
        middle = np.repeat(self.batch(z), z.shape[0], axis=1)
        forward = (above - middle) / DIFFERENCE_STEP
        return np.where(np.isnan(above), (middle - below) / DIFFERENCE_STEP, forward)

    def hessian(self, point: Point, weights: Vector, columns: npt.NDArray[np.intp]) -> Vector:
        """Hessian (nf, nf) of weights @ rows; only `columns` are computed, the others are zero."""
        n = self.space.size
        result = np.zeros((n, n))
        part = self.hessian_products(point, weights, np.eye(n)[:, columns])[columns]
        result[np.ix_(columns, columns)] = (part + part.T) / 2
        return result

    def hessian_products(self, point: Point, weights: Vector, directions: Vector) -> Vector:
        """Products (nf, d) of the Hessian of weights @ rows with directions (nf, d) of length 1."""
        count = directions.shape[1]
        if not count:
            return np.zeros_like(directions)
        inexact = self.difference_rows.any() or not self.complex_works
        step = 1e-3 if inexact else HESSIAN_STEP
        moves, z = step * directions, point.z[:, None]
        active = np.flatnonzero(weights)
        slopes = self.jacobians(np.concatenate([z + moves, z - moves], axis=1), inside=False)
        slopes = np.tensordot(weights[active], slopes[active], axes=1)
        above, below = slopes[:count], slopes[count:]
        if not np.isfinite(slopes).all():  # undefined on one side: one-sided difference, or 0
            middle = weights @ self.jacobian(point)
            above = np.where(np.isfinite(above), above, 2 * middle - below)
            below = np.where(np.isfinite(below), below, 2 * middle - above)
            above, below = np.nan_to_num(above), np.nan_to_num(below)
        return np.asarray((above - below).T / (2 * step))

    def check_gradients(self, point: Point) -> tuple[str, ...]:
        """Compare the complex step with finite differences; return warnings.

        The objective or constraints that differ use finite differences from then on.
        """
        if not self.problem.has_complex_step:
            return (
                (
                    "gradients are computed by finite differences, as the model does not "
                    "accept complex numbers"
                ),
            )
        try:
            exact = self._complex_step(point.z[:, None], inside=True)[:, 0]
        except (TypeError, ValueError, np.exceptions.ComplexWarning) as error:
            self.complex_works = False
            return (
                "gradients are computed by finite differences, as the model rejects "
                f"complex numbers ({error}); avoid float(), abs and math functions in "
                "custom functions",
            )
        wrong = self._disagreement(point, exact)
        self.difference_rows = wrong
        labels = ("objective", *self.problem.constraint_names, *self.problem.equality_names)
        return tuple(
            f"the gradient of {labels[i]} is computed by finite differences, as the "
            "complex-step gradient differs or is undefined; avoid abs, max, sign, "
            "float() and floor in custom functions"
            for i in np.flatnonzero(wrong)
        )

    def _disagreement(self, point: Point, exact: Vector) -> npt.NDArray[np.bool_]:
        n = self.space.size
        wrong = np.ones(len(exact), dtype=bool)
        for step in (1e-5, 1e-4, 1e-6):  # a kink or rounding does not spoil all three steps
            moves = step * np.eye(n)
            z = point.z[:, None]
            sides = np.concatenate([z + moves, z - moves], axis=1)
            rows = self.screen(self.problem.rows(self.space.to_x(sides, inside=False)))
            slopes = (rows[:, :n] - rows[:, n:]) / (2 * step)
            comparable = np.isfinite(slopes) & np.isfinite(exact)
            size = np.abs(np.where(comparable, slopes, 0.0)).max(axis=1, initial=0.0)
            room = 1e-4 * size + 1e-11 / step * (1.0 + np.abs(point.rows))
            differs = np.where(comparable, np.abs(slopes - exact) > room[:, None], False)
            undefined = np.isnan(exact).all(axis=1) & np.isfinite(slopes).all(axis=1)
            wrong &= differs.any(axis=1) | undefined
            if not wrong.any():
                return wrong
        return wrong & ~self._at_kink(point, exact, rows, step, room)

    @staticmethod
    def _at_kink(
        point: Point, exact: Vector, rows: Vector, step: float, room: Vector
    ) -> npt.NDArray[np.bool_]:
        """Rows whose gradient is between the one-sided slopes in all directions.

        An optimum often lies on a kink, where the greatest of several values changes. The complex
        step then gives the gradient of one of them. `rows` are those at distances `step` above and
        below the point in every direction; `room` is the tolerance of every row.
        """
        n, here = exact.shape[1], point.rows[:, None]
        above, below = (rows[:, :n] - here) / step, (here - rows[:, n:]) / step
        least, most = np.minimum(above, below), np.maximum(above, below)
        between = (exact >= least - room[:, None]) & (exact <= most + room[:, None])
        return np.asarray(between.all(axis=1))


def points_together(requests: Sequence[tuple[Evaluator, Vector]]) -> list[Point]:
    """Evaluate each evaluator's point z (nf,), with gradients, in one model call.

    The evaluators' problems may differ only in their bounds.
    """
    if len(requests) == 1 or not all(evaluator.exact for evaluator, _ in requests):
        return [evaluator.point(z) for evaluator, z in requests]
    parts = [evaluator.columns(z[:, None]) for evaluator, z in requests]
    rows = requests[0][0].problem.rows(np.concatenate(parts, axis=1))
    ends = np.cumsum([part.shape[1] for part in parts])[:-1]
    return [
        evaluator.enter(z, part)
        for (evaluator, z), part in zip(requests, np.split(rows, ends, axis=1), strict=True)
    ]
