"""Re-solve many slightly changed problems at once: one model evaluation serves all of them.

Each problem takes full quadratic steps with the Hessian of the unchanged optimum, which learns on
the way. Those it does not serve descend from a feasible point within a trusted radius; what is left
is for the search of `resolving.resolved`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..numeric import STEP
from . import kkt, newton
from .evaluator import Evaluator, Point
from .problem import ParametricProblem, Vector

ITERATIONS = 10
"""Most full steps; 10 % changes mostly take three to five."""

LONGEST = 60
"""Most evaluations of a descent within a trusted radius."""

MEMORY = 3
"""Merits, the worst of which a trial must beat."""

RADIUS = 0.1
"""First radius trusted, in solver coordinates: 10 % in a logarithmic variable."""

LEAST_RADIUS = 1e-4
"""Radius at which a descent gives up."""

RESTORATIONS = 24
"""Most steps towards a feasible point."""

PATIENCE = 4
"""Steps within which the violation must fall by 2 %, or the problem counts as infeasible."""

SETTLED = 1e-6
"""Length of the last step below which the optimality conditions are worth checking."""

FEASIBLE = 1e-11
"""Violation left: the objective is first order in it."""

MET = 1e-6
"""Violation of a design that still counts as feasible."""

RESIDUAL = 1e-6
"""Residual of the optimality conditions left: the objective is second order in it."""


def applicable(parametric: ParametricProblem, evaluator: Evaluator) -> bool:
    """Whether exact gradients of every row come from one complex evaluation."""
    exact = evaluator.complex_works and not evaluator.difference_rows.any()
    return exact and not parametric.problem.equality_names


def resolve_together(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    starts: Vector,
    parameters: Vector,
) -> list[Point | None]:
    """Optima of the changed problems by full steps; None where one needs a sturdier path.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator, point : of the unchanged optimum
    starts : coordinates to start from (nf, K)
    parameters : parameter values of each problem (q, K)
    """
    if starts.shape[1] == 0:
        return []
    state = newton.state_at(evaluator, point)
    hessians = [newton.convex_hessian(evaluator, state)] * starts.shape[1]
    found, _ = follow(parametric, evaluator, hessians, state.scale, starts, parameters)
    rows = standing(parametric, [point], parameters)[:, 0]
    unmoved = np.where(evaluator.violations(rows, "worst") <= FEASIBLE, rows[0], np.inf)
    for k, one in enumerate(found):
        if one is not None and unmoved[k] < one.objective - 1e-9 * abs(one.objective):
            found[k] = None  # the old optimum itself is better: another valley
    return found


def follow(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    hessians: list[Vector],
    scale: float,
    starts: Vector,
    parameters: Vector,
) -> tuple[list[Point | None], list[Descent]]:
    """Optima of many problems by full steps, each with a Hessian of its own; and the ways there.

    Parameters
    ----------
    parametric, evaluator : the problem with its parameters
    hessians : of the Lagrangian over `scale`, positive definite (nf, nf), one for each problem
    scale : size of the objective's gradient
    starts, parameters : as of `resolve_together`
    """
    count, space = starts.shape[1], evaluator.space
    found: list[Point | None] = [None] * count
    z = np.clip(starts, space.lower[:, None], space.upper[:, None])
    last, least = np.full(count, np.inf), np.full(count, np.inf)
    size = evaluator.constraint_count
    descents = [Descent(one, scale, size, 1.0, radius=newton.RADIUS) for one in hessians]
    alive = list(range(count))
    for iteration in range(ITERATIONS):
        if not alive:
            break
        points = points_at(parametric, evaluator, z[:, alive], parameters[:, alive])
        going = []
        for k, trial in zip(alive, points, strict=True):
            if not trial.valid:
                continue
            if last[k] <= SETTLED and _optimal(evaluator, trial):
                found[k] = trial
                continue
            if iteration > PATIENCE and trial.violation > max(0.98 * least[k], MET):
                continue
            if iteration % PATIENCE == 0:
                least[k] = trial.violation
            way = descents[k]
            way.go_on(evaluator, trial)
            if not np.isfinite(way.length) or way.length > 4 * max(last[k], 1e-3):
                continue
            last[k] = way.length
            z[:, k] = np.clip(z[:, k] + way.step, space.lower, space.upper)
            going.append(k)
        alive = going
    return found, descents


LEAST_CURVATURE = 1e-10
"""Smallest over largest curvature of a learnt Hessian: well above rounding."""


@dataclass
class Descent:
    """One problem on its way down: the last accepted point and the step tried from it.

    The merit is the objective plus the violations at more than their price; a trial need only
    beat the worst of the last `MEMORY` merits, so that curved constraints do not shorten good
    steps [NocedalWright2006] ch. 15. Steps stay within a radius that follows their success.
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
    """Whether the step tried is one corrected for the constraints' curvature."""
    past: list[tuple[float, float]] = field(default_factory=list)

    @property
    def known(self) -> Point:
        """The last accepted point, which there must be."""
        assert self.point is not None
        return self.point

    @property
    def length(self) -> float:
        """Length of the step now tried, infinite before the first."""
        return np.inf if self.point is None else float(np.abs(self.step).max(initial=0.0))

    def accepts(self, trial: Point) -> bool:
        """Whether the trial is good enough to go on from."""
        if self.point is None or self.length <= SETTLED:
            return True
        value, missed = self._measures(trial)
        merits = [v + self.price * m for v, m in self.past[-MEMORY:]]
        return value + self.price * missed < max(merits)

    def go_on(self, evaluator: Evaluator, trial: Point) -> None:
        """Learn from an accepted trial and choose the next step."""
        jacobian = evaluator.jacobian(trial)
        if self.point is not None:
            change = jacobian - evaluator.jacobian(self.point)
            slopes = change[0] / self.scale - self.multipliers @ change[1 : 1 + self.rows]
            self._learn(trial.z - self.point.z, slopes)
        if self.point is not None and self.length > 0.9 * self.radius:
            self.radius = min(2 * self.radius, newton.RADIUS)
        self.point = trial
        self.past.append(self._measures(trial))
        self.choose(evaluator)

    def choose(self, evaluator: Evaluator, trial: Point | None = None) -> None:
        """Choose the step from the accepted point, within the radius.

        With a trial that curved constraints spoilt, their curvature on the way to it is taken off
        [NocedalWright2006] section 18.3.
        """
        space, point, unit = evaluator.space, self.known, np.eye(len(self.hessian))
        jacobian = evaluator.jacobian(point)
        down = np.minimum(point.z - space.lower, self.radius)
        up = np.minimum(space.upper - point.z, self.radius)
        constraints = slice(1, 1 + self.rows)
        margins, self.corrected = point.rows[constraints], trial is not None
        if trial is not None:
            margins = trial.rows[constraints] - jacobian[constraints] @ self.step
        self.step, self.prices = newton.quadratic_programme(
            self.hessian,
            jacobian[0] / self.scale,
            np.concatenate([jacobian[constraints], unit, -unit]),
            np.concatenate([margins, down, up]),
            self.prices,
        )
        self.multipliers = self.prices[: self.rows]
        self.price = max(self.price, _price(self.multipliers))
        self.step = self.step * min(1.0, self.radius / max(self.length, 1e-300))

    def _measures(self, trial: Point) -> tuple[float, float]:
        missed = np.maximum(-trial.rows[1 : 1 + self.rows], 0.0).sum()
        return trial.objective / self.scale, float(missed)

    def _learn(self, step: Vector, change: Vector) -> None:
        """Damped update that keeps the Hessian positive [NocedalWright2006] procedure 18.2."""
        turned = self.hessian @ step
        bent, straight = float(step @ turned), float(step @ change)
        if bent <= 1e-20:
            return
        if straight < 0.2 * bent:
            share = 0.8 * bent / (bent - straight)
            change = share * change + (1 - share) * turned
        learnt = (
            self.hessian
            - np.outer(turned, turned) / bent
            + np.outer(change, change) / float(step @ change)
        )
        curvatures = np.linalg.eigvalsh(learnt)
        if curvatures[0] > LEAST_CURVATURE * curvatures[-1]:  # else rounding has eaten it
            self.hessian = learnt


def descend_together(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    point: Point,
    starts: Vector,
    parameters: Vector,
) -> tuple[list[Point | None], list[Point | None]]:
    """Optima of the changed problems within trusted radii, and designs on the way to the others.

    Parameters as of `resolve_together`. None where no optimum is reached; the designs on the way
    are feasible, None where there is none or an optimum is reached.
    """
    if starts.shape[1] == 0:
        return [], []
    state = newton.state_at(evaluator, point)
    hessian, rows = newton.convex_hessian(evaluator, state), evaluator.constraint_count
    price = _price(state.multipliers[: len(state.near.constraint)] / state.scale)
    ways = [Descent(hessian, state.scale, rows, price) for _ in range(starts.shape[1])]
    found = descend(parametric, evaluator, ways, starts, parameters)
    last = [one.point for one in ways]
    stopped = [
        at if found[k] is None and at is not None and at.violation <= MET else None
        for k, at in enumerate(last)
    ]
    return found, stopped


def descend(
    parametric: ParametricProblem,
    evaluator: Evaluator,
    ways: list[Descent],
    starts: Vector,
    parameters: Vector,
    longest: int = LONGEST,
) -> list[Point | None]:
    """Optima of many problems within trusted radii, None where none is reached.

    `ways` are new descents, one for each problem, of at most `longest` evaluations; the rest as
    of `resolve_together`.
    """
    found: list[Point | None] = [None] * len(ways)
    space = evaluator.space
    z = np.clip(starts, space.lower[:, None], space.upper[:, None])
    alive = list(range(len(ways)))
    for _ in range(longest):
        if not alive:
            break
        points = points_at(parametric, evaluator, z[:, alive], parameters[:, alive])
        going = []
        for k, trial in zip(alive, points, strict=True):
            one = ways[k]
            if trial.valid and one.accepts(trial):
                if one.length <= SETTLED and _optimal(evaluator, trial):
                    found[k] = trial
                    continue
                one.go_on(evaluator, trial)
            elif one.point is None or one.length <= LEAST_RADIUS:
                continue
            elif trial.valid and not one.corrected:
                one.choose(evaluator, trial)
            else:
                one.radius = one.length / 2
                one.choose(evaluator)
            z[:, k] = np.clip(one.known.z + one.step, space.lower, space.upper)
            going.append(k)
        alive = going
    return found


def _price(multipliers: Vector) -> float:
    """A price of what is missed above every multiplier."""
    return 2 * float(multipliers.max(initial=0.0)) + 1.0


def _optimal(evaluator: Evaluator, trial: Point) -> bool:
    return trial.violation <= FEASIBLE and kkt.residual(evaluator, trial) <= RESIDUAL


def restore_together(
    parametric: ParametricProblem, evaluator: Evaluator, start: Vector, parameters: Vector
) -> list[Vector | None]:
    """A feasible point (nf,) near the start for each problem; None where none is.

    Every step is the shortest that meets the linearised rows, or misses them least.
    """
    space = evaluator.space
    count = parameters.shape[1]
    found: list[Vector | None] = [None] * count
    z = np.repeat(start[:, None], count, axis=1)
    least = np.full(count, np.inf)
    alive = list(range(count))
    for iteration in range(RESTORATIONS):
        if not alive:
            break
        points = points_at(parametric, evaluator, z[:, alive], parameters[:, alive])
        going = []
        for k, trial in zip(alive, points, strict=True):
            if trial.valid and trial.violation <= MET:
                found[k] = trial.z
                continue
            stuck = iteration > PATIENCE and trial.violation > 0.98 * least[k]
            if not trial.valid or stuck:
                continue
            if iteration % PATIENCE == 0:
                least[k] = trial.violation
            rows = kkt.active_set(evaluator, trial, width=1.0)
            step, _ = newton.quadratic_programme(
                np.eye(space.size), np.zeros(space.size), rows.gradients, rows.margins - 1e-7
            )
            share = min(1.0, newton.RADIUS / max(float(np.abs(step).max(initial=0.0)), 1e-300))
            z[:, k] = np.clip(z[:, k] + share * step, space.lower, space.upper)
            going.append(k)
        alive = going
    return found


def points_at(
    parametric: ParametricProblem, evaluator: Evaluator, z: Vector, parameters: Vector
) -> list[Point]:
    """Every problem's point with its gradients, from one complex evaluation."""
    space = evaluator.space
    nf, count = z.shape
    x = space.to_x(z)
    batch = np.repeat(x.astype(complex), nf, axis=1)
    columns = np.arange(count * nf).reshape(count, nf)
    batch[space.free[None, :], columns] += 1j * STEP * space.slope(x).T
    problem = parametric.with_columns(np.repeat(parameters, nf, axis=1))
    rows = problem.rows(batch).reshape(-1, count, nf)
    values, slopes = rows.real[:, :, 0], np.asarray(rows.imag / STEP, dtype=float)
    values = Evaluator.screen(values)
    violation = evaluator.violations(values, "worst")
    valid = np.isfinite(values).all(axis=0) & np.isfinite(slopes).all(axis=(0, 2))
    return [
        Point(z[:, k], x[:, k], values[:, k], bool(valid[k]), float(violation[k]), slopes[:, k])
        for k in range(count)
    ]


def standing(parametric: ParametricProblem, points: list[Point], parameters: Vector) -> Vector:
    """Rows (rows, points, K) of points under each changed problem."""
    count, size = parameters.shape[1], len(points)
    x = np.stack([p.x for p in points], axis=1)
    both = parametric.with_columns(np.tile(parameters, size)).rows(np.repeat(x, count, axis=1))
    return Evaluator.screen(both).reshape(-1, size, count)
