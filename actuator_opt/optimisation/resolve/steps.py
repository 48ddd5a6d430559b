"""Steps to an optimum near a solved problem, for many problems in parallel.

A solver is a generator. It yields the coordinates of a point, receives that point evaluated with
its gradients, and finally returns its result. One model call evaluates a step of all solvers. Each
solver receives only its own points, so its result does not depend on the other solvers.

Full quadratic steps reach most optima. They start with the Hessian of the unchanged optimum and
update it. Where they fail, a restoration finds a feasible point, and a descent within a trust
region starts there.

The first Hessian is taken from another optimum, or computed along the free directions (those in
which the active limits keep their values). Most designs of a front have nearly as many active
limits as variables, so there are few free directions. In each, the gradients on both sides of the
point give the curvature. In all other directions the Hessian only has to be convex, as the active
limits determine the step [NocedalWright2006] section 16.2.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import field, replace
from typing import Generic, NamedTuple, TypeAlias, TypeVar

import numpy as np

from ...base.dataclass import dataclass
from .. import kkt
from ..evaluator import HESSIAN_STEP, Evaluator, Point
from ..problem import Vector
from ..solution import MET

Result = TypeVar("Result")


Steps: TypeAlias = Generator[Vector, Point, Result]
"""A solver: yields coordinates (nf,), receives the evaluated point, returns its result."""


BatchEvaluator: TypeAlias = Callable[[Mapping[int, Vector]], Sequence[Point]]
"""Function that evaluates the requested points, given as a mapping from solver number to point."""


class Batch(Generic[Result]):
    """Solvers that share their model calls.

    Parameters
    ----------
    solvers : the solvers
    evaluate : evaluates the requested points in one model call

    Attributes
    ----------
    requests : requested coordinates of the running solvers, by number
    results : results of the finished solvers, by number
    """

    def __init__(self, solvers: Sequence[Steps[Result]], evaluate: BatchEvaluator) -> None:
        self.requests: dict[int, Vector] = {}
        self.results: dict[int, Result] = {}
        self._solvers, self._evaluate = solvers, evaluate
        for number in range(len(solvers)):
            self._advance(number, None)

    def step(self) -> None:
        """Evaluate the requested points, and advance every running solver."""
        requests, self.requests = self.requests, {}
        for number, point in zip(requests, self._evaluate(requests), strict=True):
            self._advance(number, point)

    def drop(self, number: int) -> None:
        """End a solver without a result."""
        del self.requests[number]
        self._solvers[number].close()

    def _advance(self, number: int, point: Point | None) -> None:
        solver = self._solvers[number]
        try:
            self.requests[number] = next(solver) if point is None else solver.send(point)
        except StopIteration as end:
            self.results[number] = end.value


def run_batch(solvers: Sequence[Steps[Result]], evaluate: BatchEvaluator) -> list[Result]:
    """Run all solvers, and return their results in order."""
    batch = Batch(solvers, evaluate)
    while batch.requests:
        batch.step()
    return [batch.results[number] for number in range(len(solvers))]


ITERATIONS = 10
"""Maximum number of full steps; after a change of 10 %, three to five are usual."""

LONGEST = 60
"""Maximum number of evaluations in a descent within a trust region."""

MEMORY = 3
"""A trial point must beat the worst of this many most recent merits (see `Descent`)."""

RADIUS = 0.1
"""First trust radius, in solver coordinates: 10 % for a logarithmic variable."""

LEAST_RADIUS = 1e-4
"""Trust radius below which a descent fails."""

RESTORATIONS = 24
"""Maximum number of steps to a feasible point."""

PATIENCE = 4
"""The solver gives up if the violation does not fall by 2 % within this number of steps."""

SETTLED = 1e-6
"""Below this step length, the optimality conditions are checked."""

FEASIBLE = 1e-11
"""Allowed violation; strict, because a violation changes the objective to first order."""

RESIDUAL = 1e-6
"""Allowed residual of the optimality conditions; it changes the objective only to second order."""

LEAST_CURVATURE = 1e-10
"""Least ratio of smallest to largest curvature in an updated Hessian; well above rounding error."""


@dataclass
class Descent:
    """A descent: the last accepted point, and the trial step from it.

    The merit of a point is its objective plus the weighted sum of its violations; the weight is
    larger than every multiplier. The next point (the trial) only has to beat the worst of the last
    `MEMORY` merits, so that curved constraints do not shorten good steps [NocedalWright2006] ch.
    15. The trust radius is adapted to the success of the steps.
    """

    hessian: Vector
    scale: float
    rows: int
    price: float
    point: Point | None = None
    step: Vector = field(default_factory=lambda: np.zeros(0))
    radius: float = RADIUS
    prices: Vector | None = None
    multipliers: Vector = field(default_factory=lambda: np.zeros(0))
    corrected: bool = False
    """Whether the trial step includes a correction for the curvature of constraints."""
    measures: list[tuple[float, float]] = field(default_factory=list)

    @property
    def current(self) -> Point:
        """The last accepted point, which must exist."""
        assert self.point is not None
        return self.point

    @property
    def length(self) -> float:
        """Length of the trial step; infinite before the first step."""
        return np.inf if self.point is None else float(np.abs(self.step).max(initial=0.0))

    def accepts(self, trial: Point) -> bool:
        """Whether the trial point is accepted as the next point."""
        if self.point is None or self.length <= SETTLED:
            return True
        value, missed = self._measures(trial)
        merits = [v + self.price * m for v, m in self.measures[-MEMORY:]]
        return value + self.price * missed < max(merits)

    def advance(self, evaluator: Evaluator, trial: Point) -> None:
        """Update the Hessian after an accepted trial, and choose the next step."""
        jacobian = evaluator.jacobian(trial)
        if self.point is not None:
            change = jacobian - evaluator.jacobian(self.point)
            slopes = change[0] / self.scale - self.multipliers @ change[1 : 1 + self.rows]
            self._learn(trial.z - self.point.z, slopes)
        if self.point is not None and self.length > 0.9 * self.radius:
            self.radius = min(2 * self.radius, kkt.RADIUS)
        self.point = trial
        self.measures.append(self._measures(trial))
        self.choose_step(evaluator)

    def choose_step(self, evaluator: Evaluator, trial: Point | None = None) -> None:
        """Choose the step from the accepted point, within the trust radius.

        After a rejected `trial`, the step is corrected for the curvature of the constraints
        [NocedalWright2006] section 18.3.
        """
        space, point, unit = evaluator.space, self.current, np.eye(len(self.hessian))
        jacobian = evaluator.jacobian(point)
        room_below = np.minimum(point.z - space.lower, self.radius)
        room_above = np.minimum(space.upper - point.z, self.radius)
        constraints = slice(1, 1 + self.rows)
        margins, self.corrected = point.rows[constraints], trial is not None
        if trial is not None:
            margins = trial.rows[constraints] - jacobian[constraints] @ self.step
        self.step, self.prices = kkt.quadratic_programme(
            self.hessian,
            jacobian[0] / self.scale,
            np.concatenate([jacobian[constraints], unit, -unit]),
            np.concatenate([margins, room_below, room_above]),
            self.prices,
        )
        self.multipliers = self.prices[: self.rows]
        self.price = max(self.price, margin_price(self.multipliers))
        self.step = self.step * min(1.0, self.radius / max(self.length, 1e-300))

    def _measures(self, trial: Point) -> tuple[float, float]:
        missed = np.maximum(-trial.rows[1 : 1 + self.rows], 0.0).sum()
        return trial.objective / self.scale, float(missed)

    def _learn(self, step: Vector, change: Vector) -> None:
        """Update the Hessian, damped to stay convex [NocedalWright2006] procedure 18.2."""
        product = self.hessian @ step
        curvature, measured = float(step @ product), float(step @ change)
        if curvature <= 1e-20:
            return
        if measured < 0.2 * curvature:
            share = 0.8 * curvature / (curvature - measured)
            change = share * change + (1 - share) * product
        update = (
            self.hessian
            - np.outer(product, product) / curvature
            + np.outer(change, change) / float(step @ change)
        )
        curvatures = np.linalg.eigvalsh(update)
        if curvatures[0] > LEAST_CURVATURE * curvatures[-1]:  # otherwise within rounding error
            self.hessian = update


def margin_price(multipliers: Vector) -> float:
    """Penalty per unit of violation; larger than every multiplier."""
    return 2 * float(multipliers.max(initial=0.0)) + 1.0


@dataclass(frozen=True)
class Valley:
    """A local optimum, with the data from which new descents start.

    Parameters
    ----------
    point : the local optimum
    hessian : Hessian of the Lagrangian divided by `scale`, made positive definite (nf, nf)
    scale : norm of the objective's gradient
    rows : number of constraints
    price : penalty per unit of violation, larger than every multiplier
    prices : multipliers of constraints, lower and upper bounds (rows + 2 nf,), divided by `scale`;
        None if unknown
    """

    point: Point
    hessian: Vector
    scale: float
    rows: int
    price: float
    prices: Vector | None

    def of(self, rows: int) -> Valley:
        """The same data for a problem with this number of constraints."""
        return self if rows == self.rows else replace(self, rows=rows, prices=None)

    def full(self) -> Descent:
        """A new descent by full steps, with the Hessian and multipliers of this optimum."""
        return Descent(
            self.hessian, self.scale, self.rows, 1.0, radius=kkt.RADIUS, prices=self.prices
        )

    def trusted(self) -> Descent:
        """A new descent within a trust region, with the Hessian and multipliers of this optimum."""
        return Descent(self.hessian, self.scale, self.rows, self.price, prices=self.prices)


def valley_at(evaluator: Evaluator, point: Point) -> Valley:
    """A local optimum with the data from which new descents start."""
    state = kkt.state_at(evaluator, point)
    active, rows, size = state.active, evaluator.constraint_count, evaluator.space.size
    prices = np.zeros(rows + 2 * size)
    places = [active.constraint, rows + active.lower, rows + size + active.upper]
    prices[np.concatenate(places)] = state.multipliers / state.scale
    hessian = kkt.convex_hessian(evaluator, state)
    return Valley(point, hessian, state.scale, rows, margin_price(prices[:rows]), prices)


def is_optimum(evaluator: Evaluator, point: Point) -> bool:
    """Whether the point is feasible to rounding and meets the optimality conditions."""
    return point.violation <= FEASIBLE and kkt.residual(evaluator, point) <= RESIDUAL


def is_met(point: Point) -> bool:
    """Whether the point has finite values and meets every limit."""
    return point.valid and point.violation <= MET


def full_steps(
    evaluator: Evaluator, descent: Descent, start: Vector | Point
) -> Steps[Point | None]:
    """The optimum that full quadratic steps reach; None if they do not converge.

    Parameters
    ----------
    evaluator : evaluator of the problem, or of a problem with the same rows and bounds
    descent : a new descent with its initial Hessian
    start : coordinates (nf,), or the evaluated point
    """
    space = evaluator.space
    z = np.clip(start.z if isinstance(start, Point) else start, space.lower, space.upper)
    previous_length, reference = np.inf, np.inf
    for iteration in range(ITERATIONS):
        trial = start if isinstance(start, Point) and not iteration else (yield z)
        if not trial.valid:
            return None
        if previous_length <= SETTLED and is_optimum(evaluator, trial):
            return trial
        if iteration > PATIENCE and trial.violation > max(0.98 * reference, MET):
            return None
        if iteration % PATIENCE == 0:
            reference = trial.violation
        descent.advance(evaluator, trial)
        if not np.isfinite(descent.length) or descent.length > 4 * max(previous_length, 1e-3):
            return None
        previous_length = descent.length
        z = np.clip(z + descent.step, space.lower, space.upper)
    return None


def trusted_steps(
    evaluator: Evaluator, descent: Descent, start: Vector, max_evaluations: int = LONGEST
) -> Steps[Point | None]:
    """The optimum that a descent within a trust region reaches; None if it fails.

    Parameters
    ----------
    evaluator, descent, start : see `full_steps`
    max_evaluations : maximum number of evaluations
    """
    space = evaluator.space
    z = np.clip(start, space.lower, space.upper)
    for _ in range(max_evaluations):
        trial = yield z
        if trial.valid and descent.accepts(trial):
            if descent.length <= SETTLED and is_optimum(evaluator, trial):
                return trial
            descent.advance(evaluator, trial)
        elif descent.point is None or descent.length <= LEAST_RADIUS:
            return None
        elif trial.valid and not descent.corrected:
            descent.choose_step(evaluator, trial)
        else:
            descent.radius = descent.length / 2
            descent.choose_step(evaluator)
        z = np.clip(descent.current.z + descent.step, space.lower, space.upper)
    return None


class RestorationResult(NamedTuple):
    """`feasible` is the feasible point reached, or None; `least` is the least infeasible point."""

    feasible: Point | None
    least: Point | None


def restoring_steps(
    evaluator: Evaluator, start: Vector | Point, patience: int = PATIENCE
) -> Steps[RestorationResult]:
    """A feasible point near a start, for a problem without equalities.

    Every step is the shortest that satisfies the linearised constraints, or else violates them
    least.

    Parameters
    ----------
    evaluator : evaluator of the problem, or of a problem with the same rows and bounds
    start : coordinates (nf,), or the evaluated point
    patience : number of steps within which the violation must fall by 2 %
    """
    space, reference, best = evaluator.space, np.inf, None
    trial = start if isinstance(start, Point) else (yield start)
    for iteration in range(RESTORATIONS):
        if not trial.valid:
            break
        if trial.violation <= MET:
            return RestorationResult(trial, trial)
        if best is None or trial.violation < best.violation:
            best = trial
        if iteration > patience and trial.violation > 0.98 * reference:
            break
        if iteration % patience == 0:
            reference = trial.violation
        rows = kkt.active_set(evaluator, trial, width=1.0)
        step, _ = kkt.quadratic_programme(
            np.eye(space.size), np.zeros(space.size), rows.gradients, rows.margins - 1e-7
        )
        share = min(1.0, kkt.RADIUS / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        trial = yield np.clip(trial.z + share * step, space.lower, space.upper)
    return RestorationResult(None, best)


FIRM = 1e-6
"""A limit is active if its multiplier, relative to the largest, exceeds this."""


@dataclass(frozen=True)
class ScaledHessian:
    """Hessian (n, n) of the Lagrangian divided by `scale`, at an optimum, in the variables x."""

    hessian: Vector
    scale: float

    def in_coordinates(self, evaluator: Evaluator, x: Vector) -> Vector:
        """The Hessian in the solver coordinates of the free variables, at a point x (n,)."""
        space = evaluator.space
        slope = space.slope(x[:, None])[:, 0]
        return np.asarray(self.hessian[np.ix_(space.free, space.free)] * np.outer(slope, slope))


def hessian_at(evaluator: Evaluator, point: Point) -> ScaledHessian | None:
    """The Hessian at an optimum; None if no variable is free."""
    space = evaluator.space
    if not space.size or not point.valid:
        return None
    state = kkt.state_at(evaluator, point)
    slope = space.slope(point.x[:, None])[:, 0]
    hessian = kkt.convex_hessian(evaluator, state) / np.outer(slope, slope)
    full = np.zeros((len(point.x), len(point.x)))
    full[np.ix_(space.free, space.free)] = hessian
    return ScaledHessian(full, state.scale)


def free_hessians(evaluator: Evaluator, descents: Sequence[Descent]) -> list[Vector]:
    """Convex Hessian of the Lagrangian at the point of each descent, in one model call.

    Parameters
    ----------
    evaluator : evaluator used for all descents; their problems have equal second derivatives
    descents : descents, each with a point and its multipliers
    """
    free = [_free(evaluator, descent) for descent in descents]
    if not any(z.shape[1] for z in free):
        return [np.eye(evaluator.space.size) for _ in descents]
    moves = np.concatenate([HESSIAN_STEP * z for z in free], axis=1)
    points = np.repeat(
        np.stack([descent.current.z for descent in descents], axis=1),
        [z.shape[1] for z in free],
        axis=1,
    )
    slopes = evaluator.jacobians(
        np.concatenate([points + moves, points - moves], axis=1), inside=False
    )
    second_derivatives = np.nan_to_num(
        slopes[:, : points.shape[1]] - slopes[:, points.shape[1] :]
    ) / (2 * HESSIAN_STEP)
    result, offset = [], 0
    for descent, z in zip(descents, free, strict=True):
        part = second_derivatives[:, offset : offset + z.shape[1]]
        offset += z.shape[1]
        weights = -descent.multipliers
        products = np.tensordot(weights, part[1 : 1 + len(weights)], axes=1).T
        products += part[0].T / descent.scale
        result.append(kkt.convex_matrix(z, products, float(np.abs(weights).max(initial=0.0))))
    return result


def _free(evaluator: Evaluator, descent: Descent) -> Vector:
    """Orthonormal directions (nf, d) in which the active limits keep their values."""
    size, prices = evaluator.space.size, descent.prices
    unit = np.eye(size)
    rows = np.concatenate([evaluator.jacobian(descent.current)[1 : 1 + descent.rows], unit, -unit])
    assert prices is not None
    weight = prices * np.sqrt((rows**2).sum(axis=1))
    return kkt.null_space(rows[weight > FIRM * weight.max(initial=0.0)], size)
