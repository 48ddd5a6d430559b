"""Optima on a kink of objective or limits: there the gradient of one side alone proves nothing.

A limit is often the least of several smooth margins, for example the larger thread that two rings
need. A kink is the surface on which two of these margins are equal. It divides the neighbourhood of
a point into pieces. On each piece all rows are smooth, and the kink is a further limit: the
distance to it may not become negative. A point on the kink is a local minimum exactly if it is one
on every piece, whichever rows the kink bends and whichever way. So the optimality conditions are
checked on every piece [Scholtes2012].

The rows of a piece are extrapolated from points within it. For a row g and a short step s into the
piece, this is 3 g(z + s) - 3 g(z + 2 s) + g(z + 3 s), which is exact for quadratic rows. The
distance to the kink is the difference of a bent row between both sides, divided by the difference
of its gradients. Each piece is thus a smooth problem with one more limit per kink, to which Newton
steps, multipliers, Hessians and prices apply as usual.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import field, replace

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.numeric import Array
from . import kkt
from .evaluator import Evaluator, Point
from .problem import BoxProblem, ParametricProblem, PointValues, Vector
from .resolve.steps import RESIDUAL, is_met

BESIDE = 1e-5
"""Largest distance of a kink from a point on it, in solver coordinates (our choice)."""

NEAR = 1e-4
"""Largest distance of a kink near a point, from which Newton steps lead to it (our choice)."""

INSIDE = 5e-5
"""Step into a piece, in solver coordinates (our choice). It is larger than the steps that Hessians
and derivatives with respect to parameters take, so these stay on their piece."""

JUMP = 1e-2
"""Least change of a gradient, as a share of its length, across a kink (our choice)."""

PARALLEL = 0.99
"""Least cosine between the normals that belong to one kink (our choice)."""

MOST = 3
"""Maximum number of kinks at a point (our choice): they divide its neighbourhood into 8 pieces."""

EXACT = 1e-9
"""Measure of optimality at which Newton steps on a piece end (our choice)."""

SAMPLED = 32
"""Directions into a piece in which its gradients are compared (our choice)."""

WEIGHTS = (3.0, -3.0, 1.0)
"""Factors of the values after one, two and three steps, which extrapolate to no step."""


@dataclass(frozen=True)
class Piece:
    """A piece of a problem beside its kinks: a smooth problem, with a limit for each kink.

    Without kinks, this is the problem itself.

    Parameters
    ----------
    parametric : the smooth problem with its parameters; the limits of kinks follow the constraints
    evaluator, point : its evaluator, and the point in question
    quality : optimality conditions at the point
    """

    parametric: ParametricProblem
    evaluator: Evaluator
    point: Point
    quality: kkt.KktResidual


@dataclass(frozen=True)
class _Kinks:
    """The k kinks near a point, with nf free variables.

    Parameters
    ----------
    evaluator, z : the problem with kinks, and the coordinates of the point (nf,)
    normals : unit normals of the kinks (k, nf), within a few per cent
    rows : for each kink, the row that it bends most (k,)
    step : step into a piece
    """

    evaluator: Evaluator
    z: Vector
    normals: Vector
    rows: npt.NDArray[np.intp]
    step: float
    inward: Vector = field(init=False)
    """Directions (nf, k) that lead away from one kink each, and along the others."""

    def __post_init__(self) -> None:
        space = self.evaluator.space
        room = 10 * self.step
        movable = (self.z - space.lower > room) & (space.upper - self.z > room)
        inverse = np.linalg.pinv(self.normals * movable, rcond=0.1)
        if not np.allclose(self.normals @ inverse, np.eye(len(self.rows)), atol=1e-6):
            inverse = np.linalg.pinv(self.normals)
        object.__setattr__(self, "inward", inverse)

    def sides(self) -> Iterator[Vector]:
        """The sides (k,) of every piece."""
        for signs in itertools.product((1.0, -1.0), repeat=len(self.rows)):
            yield np.array(signs)

    def piece(self, parametric: ParametricProblem, signs: Vector) -> ParametricProblem:
        """The smooth problem on one piece; `signs` (k,), 1 or -1, are its sides of the kinks."""
        problem, m = parametric.problem, len(parametric.problem.constraint_names)
        labels = ("the objective", *problem.constraint_names, *problem.equality_names)
        steps = [self.step * (self.inward @ sides) for sides in (signs, *_flipped(signs))]
        slopes = self.evaluator.jacobians(self.z[:, None] + np.stack(steps, axis=1), inside=False)
        jumps = [slopes[i, 0] - slopes[i, 1 + k] for k, i in enumerate(self.rows)]
        lengths = [float(np.linalg.norm(jump) * np.sign(jump @ steps[0])) for jump in jumps]

        def values(problem: BoxProblem, x: Array) -> PointValues:
            here, *beyond = self._extrapolated(problem, x, steps)
            distances = [
                (here[i] - other[i]) / (length or np.inf)
                for i, other, length in zip(self.rows, beyond, lengths, strict=True)
            ]
            margins = np.concatenate([here[1 : 1 + m], np.stack(distances)])
            return PointValues(here[0], margins, here[1 + m :])

        smooth = replace(
            problem,
            evaluate=lambda x: values(problem, x),
            constraint_names=(
                *problem.constraint_names, *(f"kink of {labels[i]}" for i in self.rows)
            ),
            start=None, relaxable=None, groups=None,
        )  # fmt: skip
        return replace(
            parametric,
            problem=smooth,
            evaluate=lambda x, parameters: values(
                parametric.with_columns(np.tile(parameters, len(steps) * len(WEIGHTS))), x
            ),
        )

    def differs(self, piece: Piece, signs: Vector) -> bool:
        """Whether gradients within a piece differ from its own: it has a further kink.

        They are extrapolated from one and two steps in random directions into the piece.
        """
        space, count = self.evaluator.space, len(self.evaluator.problem.constraint_names)
        directions = np.random.default_rng(0).normal(size=(len(self.z), SAMPLED))
        directions /= np.linalg.norm(directions, axis=0)
        across = self.normals @ directions
        directions += self.inward @ (signs[:, None] * np.abs(across) - across)
        low, high = self.z - space.lower <= 0, space.upper - self.z <= 0
        directions[low], directions[high] = np.abs(directions[low]), -np.abs(directions[high])
        moves = self.step * np.concatenate([directions, 2 * directions], axis=1)
        slopes = self.evaluator.jacobians(self.z[:, None] + moves, inside=False)
        found = 2 * slopes[:, :SAMPLED] - slopes[:, SAMPLED:]
        own = piece.evaluator.jacobian(piece.point)
        rows = np.flatnonzero(np.abs(piece.point.rows[: 1 + count]) <= kkt.ACTIVE)
        rows = np.union1d(rows, np.append(0, np.arange(1 + count, len(found))))
        kept = np.delete(own, 1 + count + np.arange(len(signs)), axis=0)  # without the kinks
        jumps = np.linalg.norm(np.nan_to_num(found[rows] - kept[rows][:, None]), axis=2)
        lengths = np.linalg.norm(kept[rows], axis=1)
        lengths[0] = max(lengths[0], 1e-3 * abs(piece.point.objective))
        return bool((jumps > JUMP * np.maximum(lengths, 1e-300)[:, None]).any())

    def rough(self, signs: Vector) -> BoxProblem:
        """The problem inside a piece, one step from the kinks, whose distances count as straight.

        Its second derivatives lead Newton steps on the piece, at a small part of the effort.
        """
        problem = self.evaluator.problem
        m, step = len(problem.constraint_names), self.step * (self.inward @ signs)

        def evaluate(x: Array) -> PointValues:
            rows = problem.rows(self._moved(x, step))
            straight = np.zeros((len(self.rows), x.shape[1]))
            return PointValues(rows[0], np.concatenate([rows[1 : 1 + m], straight]), rows[1 + m :])

        names = (*problem.constraint_names, *("kink" for _ in self.rows))
        return replace(
            problem, evaluate=evaluate, constraint_names=names, start=None, relaxable=None,
            groups=None,
        )  # fmt: skip

    def _moved(self, x: Array, move: Vector) -> Array:
        """Points (n, K), moved by coordinates (nf,) of the solver."""
        space, moved = self.evaluator.space, np.array(x)
        log, change = space.logarithmic[:, None], move[:, None]
        moved[space.free] *= np.exp(np.where(log, change, 0.0))
        moved[space.free] += np.where(log, 0.0, change * space.scale[:, None])
        return moved

    def _extrapolated(self, problem: BoxProblem, x: Array, steps: list[Vector]) -> list[Array]:
        """Rows (rows, K) at points (n, K), extrapolated along each step (nf,) into a piece."""
        counts = range(1, 1 + len(WEIGHTS))
        moved = [self._moved(x, count * step) for step in steps for count in counts]
        rows = problem.rows(np.concatenate(moved, axis=1))
        results = []
        for part in np.split(rows, len(steps), axis=1):
            each = np.stack(np.split(part, len(counts), axis=1))
            total = np.tensordot(WEIGHTS, each, axes=1)
            results.append(np.where(np.isfinite(each[0]), total, each[0]))  # unloaded: infinite
        return results


def _flipped(signs: Vector) -> list[Vector]:
    """The sides of all pieces that only one kink separates from a piece."""
    return [np.where(np.arange(len(signs)) == k, -signs, signs) for k in range(len(signs))]


def _kinks_near(evaluator: Evaluator, point: Point, distance: float) -> _Kinks | None:
    """The kinks of objective and nearly active limits within a distance; None if none or many.

    The evaluator keeps them, as several searches begin at the same point.
    """
    key = point.z.tobytes(), distance
    if key not in evaluator.bends:
        evaluator.bends[key] = _bends_near(evaluator, point, distance)
    bends = evaluator.bends[key]
    return None if bends is None else _Kinks(evaluator, point.z, *bends)


def _bends_near(
    evaluator: Evaluator, point: Point, distance: float
) -> tuple[Array, Array, float] | None:
    """Normals and rows of the kinks of `_kinks_near`, and the step beside them."""
    space, m, unit = evaluator.space, evaluator.constraint_count, np.eye(evaluator.space.size)
    z = point.z[:, None] + distance * np.concatenate([unit, -unit], axis=1)
    used = np.abs(point.rows) <= 10 * distance
    used[0], used[1 + m :] = True, True
    slopes = evaluator.jacobians(z, inside=False)[used].reshape(used.sum(), 2, space.size, -1)
    here = evaluator.jacobian(point)[used][:, None]
    jumps = np.nan_to_num(slopes[:, 0] + slopes[:, 1] - 2 * here)  # one side; both cancel if smooth
    lengths = np.linalg.norm(slopes, axis=3).max(axis=1)
    lengths[0] = np.maximum(lengths[0], 1e-3 * abs(point.objective))
    shares = np.linalg.norm(jumps, axis=2) / np.maximum(lengths, 1e-300)
    bent, at = np.nonzero(shares > JUMP)
    shares, normals = shares[bent, at], jumps[bent, at]
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    left, chosen, rows = np.ones(len(bent), dtype=bool), np.empty((0, space.size)), []
    while left.any():
        if len(chosen) == MOST:
            return None
        parallel = np.abs(normals @ normals.T) >= PARALLEL
        best = np.argmax(np.where(left, parallel.sum(axis=0), 0))
        chosen = np.concatenate([chosen, normals[best][None]])
        rows.append(bent[np.argmax(np.where(parallel[best], shares, 0.0))])
        basis = np.linalg.qr(chosen.T)[0]
        left &= np.linalg.norm(normals @ basis, axis=1) < PARALLEL
    if not rows:
        return None
    return chosen, np.flatnonzero(used)[rows], distance * INSIDE / BESIDE


def pieces(
    parametric: ParametricProblem, evaluator: Evaluator, point: Point, objective_scale: float = 0.0
) -> list[Piece]:
    """The pieces beside the kinks at a point if they prove it an optimum, else the problem itself.

    A point that is an optimum without regard to kinks needs no pieces.

    Parameters
    ----------
    parametric : the problem with its parameters
    evaluator, point : its evaluator, and the point
    objective_scale : see `kkt.slope_scale`
    """
    whole = kkt.check(evaluator, point, objective_scale=objective_scale)
    result = [Piece(parametric, evaluator, point, whole)]
    if whole.residual <= RESIDUAL or not evaluator.exact or not is_met(point):
        return result
    kinks = _kinks_near(evaluator, point, BESIDE)
    if kinks is None:
        return result
    proven = []
    for signs in kinks.sides():
        piece = _piece(kinks.piece(parametric, signs), point, objective_scale)
        if not is_met(piece.point) or piece.quality.residual > RESIDUAL:
            return result
        if kinks.differs(piece, signs):
            return result
        proven.append(piece)
    return proven


def _piece(parametric: ParametricProblem, point: Point, objective_scale: float) -> Piece:
    evaluator = Evaluator(parametric.problem)
    evaluator.eager = True
    here = evaluator.point(point.z)
    quality = kkt.check(evaluator, here, objective_scale=objective_scale)
    return Piece(parametric, evaluator, here, quality)


def check(
    evaluator: Evaluator, point: Point, *, curvature: bool = False, objective_scale: float = 0.0
) -> kkt.KktResidual:
    """Optimality conditions at a point as in `kkt.check`, on a kink those of all pieces together.

    The residual is then the largest, and the curvature the least, of all pieces. The evaluator
    keeps the result, as a search asks for it several times.
    """
    key = point.z.tobytes(), curvature, objective_scale, evaluator.exact
    if key not in evaluator.judged:
        evaluator.judged[key] = _checked(evaluator, point, curvature, objective_scale)
    quality: kkt.KktResidual = evaluator.judged[key]
    return quality


def _checked(
    evaluator: Evaluator, point: Point, curvature: bool, objective_scale: float
) -> kkt.KktResidual:
    """The result of `check`."""
    found = pieces(ParametricProblem.of(evaluator.problem), evaluator, point, objective_scale)
    qualities = [piece.quality for piece in found]
    if curvature:
        qualities = [
            kkt.check(p.evaluator, p.point, curvature=True, objective_scale=objective_scale)
            for p in found
        ]
    order = list(kkt.Curvature)
    worst = max((q.curvature for q in qualities if q.curvature), key=order.index, default=None)
    return replace(
        qualities[0],
        residual=max(quality.residual for quality in qualities),
        multipliers=qualities[0].multipliers[: evaluator.constraint_count],
        curvature=worst,
    )


def optimum_beside(evaluator: Evaluator, point: Point, *, near: bool = True) -> Point | None:
    """An optimum on or beside a kink near a feasible point; None if there is none.

    Newton steps on each piece end on the kink if the optimum is there. A point that is an optimum
    without regard to kinks needs none. Without `near`, only kinks through the point count.
    """
    if not evaluator.exact or not is_met(point):
        return None
    if kkt.check(evaluator, point).residual <= RESIDUAL:
        return None
    starts = itertools.chain([point], _ends(evaluator, point, NEAR) if near else ())
    ends = (end for start in starts for end in _ends(evaluator, start, BESIDE))
    return next((end for end in ends if check(evaluator, end).residual <= RESIDUAL), None)


def _ends(evaluator: Evaluator, point: Point, distance: float) -> Iterator[Point]:
    """The feasible points at which Newton steps end on each piece beside the kinks near a point."""
    parametric = ParametricProblem.of(evaluator.problem)
    kinks = _kinks_near(evaluator, point, distance)
    if kinks is None:
        return
    for signs in kinks.sides():
        beside = Evaluator(kinks.piece(parametric, signs).problem)
        beside.eager = True
        curved = Evaluator(kinks.rough(signs))
        start = beside.point(point.z)
        polished = kkt.polish(beside, start, tolerance=EXACT, curved=curved)
        end = evaluator.point(polished.z)
        if is_met(end):
            yield end
