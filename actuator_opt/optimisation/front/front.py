"""The front of several objectives, from its anchors: spread evenly, nothing merely local.

The best design of each objective alone is searched for like any optimum. Between these anchors
designs at levels in between are found from their neighbours, in common steps; each is compared with
every other at its own levels, so that a merely local one is seen and replaced. Full searches at
some levels, which know nothing of the front, then tell whether a better one was overlooked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...progress import tell
from ..descents import FEASIBLE, RESIDUAL
from ..outcome import Solution
from ..problem import Vector
from ..solver import solve
from . import dominance, references
from .objectives import Conditions, Objectives
from .tracer import BETTER, Design, Start, Tracer

HOLD = 1e-10
"""Share of its range by which an anchor's objective may rise while the others fall."""

GAINED = 1e-3
"""Normalised gain of the others from which that is worth it."""

CONFLICT = 1e-6
"""Share of an objective's magnitude below which its range is none: nothing to trade."""

GROWTH = 5
"""Most designs of a round per design known."""

MOST_ROUNDS = 12
"""Most rounds: a front in one piece takes three or four."""

JUMP = 5.0
"""Step of the variables between neighbours, over the median one, that may be another valley."""

SURPLUS = 1.25
"""Designs wanted of a lattice over those asked for, to choose the farthest apart of."""

RESERVE = 20
"""Most lattice levels per design asked for."""


@dataclass(frozen=True)
class Settings:
    """How hard to search.

    Parameters
    ----------
    count : designs asked for
    starts, samples : of the search for each anchor
    checks : full searches at levels in between
    seed : of the searches
    """

    count: int
    starts: int = 3
    samples: int = 1024
    checks: int = 3
    seed: int = 0


@dataclass(frozen=True)
class Front:
    """A front: its designs along the first objective, and how it was found.

    Parameters
    ----------
    x : variables (n, k)
    values : objectives (objectives, k), to be minimised
    units : the same between 0 (ideal) and 1 (worst of the anchors)
    residuals : of the optimality conditions (k,)
    knee : index and depth of the design where the front bends most, or None
    passed : values (objectives, p) of designs met on the way that others dominate
    anchors : the searches for each objective alone
    checked, improved : full searches at levels in between, and how many found something better
    failed : levels at which no design was found
    solves : designs solved for in common steps
    """

    x: Vector
    values: Vector
    units: Vector
    residuals: Vector
    knee: tuple[int, float] | None
    passed: Vector
    anchors: tuple[Solution, ...]
    checked: int = 0
    improved: int = 0
    failed: int = 0
    solves: int = 0
    warnings: tuple[str, ...] = ()

    @property
    def gaps(self) -> Vector:
        """Normalised distance to the next design: along two objectives, else to the nearest."""
        if self.units.shape[1] < 2:
            return np.empty(0)
        if len(self.units) > 2:
            return dominance.nearest(self.units)
        return np.asarray(np.sqrt((np.diff(self.units, axis=1) ** 2).sum(axis=0)))


@dataclass
class _Search:
    """The designs so far, and what else is known."""

    tracer: Tracer
    designs: list[Design]
    others: Vector
    """Variables (n, k) of more designs that meet every requirement."""
    passed: list[Vector] = field(default_factory=list)
    failed: int = 0

    def take(self, found: Sequence[Design | None]) -> None:
        """Add designs, and exchange what they found."""
        good = [one for one in found if one is not None]
        self.failed += len(found) - len(good)
        if len(self.tracer.ideal) > 2:  # a line that meets the front nowhere tells nothing of it
            good = [one for one in good if one.held]
        before = [*self.designs, *good]
        self.designs = self.tracer.exchange(list(before), self.others)
        news = [new for old, new in zip(before, self.designs, strict=True) if old is not new]
        self.designs = self.tracer.spread(self.designs, news)
        self.passed += [
            old.unit for old, new in zip(before, self.designs, strict=True) if old is not new
        ]

    def cross(self) -> None:
        """Try each side of a jump of the variables from the other: it may be the better valley."""
        self.designs.sort(key=lambda one: one.level[0])
        z = np.stack([one.point.z[:-1] for one in self.designs], axis=1)
        steps = np.abs(np.diff(z, axis=1)).max(axis=0)
        starts, chosen = [], []
        for k in np.flatnonzero(steps > JUMP * np.median(steps)).tolist():
            for to, way in ((k, k + 1), (k + 1, k)):
                one, other = self.designs[to], self.designs[way]
                at = self.tracer.to_t(other.point.z, float((other.unit - one.level).max()))
                starts.append(Start(one.level, one.way, at, other.hessian))
                chosen.append(to)
        for to, new in zip(chosen, self.tracer.solve(starts), strict=True):
            if new is not None and new.point.objective < self.designs[to].point.objective - BETTER:
                self.passed.append(self.designs[to].unit)
                self.designs[to] = new
                self.designs = self.tracer.spread(self.designs, [new])

    @property
    def units(self) -> Vector:
        """Normalised objectives of all designs (objectives, k)."""
        return np.stack([one.unit for one in self.designs], axis=1)

    def chosen(self) -> dominance.Indices:
        """The designs that nothing known dominates, each once, those at all levels first."""
        order = np.array(sorted(range(len(self.designs)), key=lambda k: not self.designs[k].held))
        units = self.units
        own = dominance.distinct(units, order.astype(np.intp))
        rest = self.tracer.unit(self.others)
        best = dominance.nondominated(np.concatenate([units[:, own], rest], axis=1))[: len(own)]
        kept = own[best]
        if len(units) > 2:  # off the levels only the anchors are sure to be best in all objectives
            kept = kept[[self.designs[k].held or k < len(units) for k in kept]]
        return np.sort(kept)


def front(objectives: Objectives, settings: Settings) -> Front | Solution:
    """The front of some objectives; the search for an anchor where that ends on no optimum."""
    anchors: list[Solution] = []
    for index in range(objectives.count):
        tell("searching for the ends of the front", index / objectives.count)
        found = solve(
            objectives.alone(index),
            starts=settings.starts,
            samples=settings.samples,
            seed=settings.seed,
            more_starts=[one.x for one in anchors],
        )
        if found.violation > FEASIBLE or found.kkt is None or found.kkt.residual > RESIDUAL:
            return found
        anchors.append(found)
    others = _feasible(anchors)
    tracer, ends = _ends(objectives, np.stack([one.x for one in anchors], axis=1), others)
    if ends.shape[1] == 1:
        return _single(tracer, ends, anchors)
    units = tracer.unit(ends)
    way = np.ones(objectives.count)
    begun = [tracer.begin(x, u, way) for x, u in zip(ends.T, units.T, strict=True)]
    search = _Search(tracer, begun, others)
    fill = _fill_line if objectives.count == 2 else _fill_plane
    fill(search, settings.count)
    checked = improved = 0
    for _ in range(2 if settings.checks else 0):
        gained = _checked(search, settings)
        checked, improved = checked + settings.checks, improved + gained
        if not gained:
            break
        fill(search, settings.count)
    return _finished(search, settings, anchors, checked, improved)


def _feasible(anchors: Sequence[Solution]) -> Vector:
    """Variables (n, k) of all local optima that meet every requirement."""
    return np.stack([o.x for one in anchors for o in one.optima if o.violation <= FEASIBLE], axis=1)


def _ends(objectives: Objectives, x: Vector, others: Vector) -> tuple[Tracer, Vector]:
    """The anchors (n, k), normalised by them; one anchor alone where there is nothing to trade."""
    magnitude = np.abs(objectives.values(np.concatenate([others, x], axis=1))).max(axis=1)
    magnitude = np.where(magnitude > 0, magnitude, 1.0)
    tracer: Tracer | None = None
    while True:
        values = objectives.values(x)
        ideal, width = values.min(axis=1), np.ptp(values, axis=1)
        best = (values - ideal[:, None] <= (CONFLICT * magnitude)[:, None]).all(axis=0)
        if best.any():
            x, width = x[:, [int(np.argmax(best))]], magnitude
        width = np.where(width <= CONFLICT * magnitude, magnitude, width)
        if tracer is not None or best.any():
            break
        tracer = Tracer(objectives, ideal, width, x[:, 0])
        x = _sharpened(tracer, x)
    if tracer is None:
        tracer = Tracer(objectives, ideal, width, x[:, 0])
    else:
        tracer.rescale(ideal, width)
    return tracer, x


def _sharpened(tracer: Tracer, x: Vector) -> Vector:
    """The anchors (n, k), each moved where the others gain and its own objective does not lose."""
    units, count = tracer.unit(x), len(x.T)
    starts = []
    for k in range(count):
        level, way = np.zeros(count), np.ones(count)
        level[k], way[k] = units[k, k] + HOLD, 0.0
        z = tracer.from_x(x[:, k], float(np.delete(units[:, k], k).max()))
        starts.append(Start(level, way, z, np.eye(len(z))))
    moved = x.copy()
    for k, (one, start) in enumerate(zip(tracer.solve(starts), starts, strict=True)):
        before = start.z[-1] * tracer.scale
        if one is not None and one.point.objective < before - GAINED:
            moved[:, k] = one.point.x[:-1]
    return moved


def _fill_line(search: _Search, count: int) -> None:
    """Designs between two anchors until there are enough, wherever the front is longest."""
    tracer, way = search.tracer, np.ones(2)
    for _ in range(MOST_ROUNDS):
        missing = count - len(search.chosen())
        if missing <= 0:
            search.cross()
            return
        tell("following the front", 1 - missing / count)
        search.designs.sort(key=lambda one: one.level[0])
        places = np.array([one.level[0] for one in search.designs])
        more = references.between(
            places, search.units, min(missing, GROWTH * (len(places) - 1) - 1)
        )
        if not len(more):
            search.cross()
            return
        starts = []
        for u in more:
            k = int(np.searchsorted(places, u))
            starts.append(_between(search.designs[k - 1], search.designs[k], float(u), way))
        search.take(tracer.solve(starts, search.designs))


def _between(left: Design, right: Design, u: float, way: Vector) -> Start:
    """A start between two designs; from the nearer one where the front jumps between them."""
    low, high = left.level[0], right.level[0]
    share = (u - low) / (high - low)
    near = left if share < 0.5 else right
    jump = np.linalg.norm(right.unit - left.unit) > references.STEEPEST * (high - low)
    z = near.point.z if jump else (1 - share) * left.point.z + share * right.point.z
    return Start(references.on_line(np.array([u]))[:, 0], way, z, near.hessian)


def _fill_plane(search: _Search, count: int) -> None:
    """Designs at the levels of a lattice that is fine enough for those asked for."""
    objectives = search.tracer.objectives.count
    steps, share, tried = 4, 1.0, np.empty((objectives, 0))
    while len(search.chosen()) < SURPLUS * count:
        levels = references.lattice(objectives, steps)
        if levels.shape[1] > RESERVE * count + 60:
            return
        before = len(search.chosen())
        tell("covering the front", min(before / count, 1.0))
        new = [a for a in levels.T if np.abs(tried - a[:, None]).max(axis=0).min(initial=1) > 1e-9]
        tried = np.concatenate([tried, levels], axis=1)
        search.take(search.tracer.solve([_beside(search, a) for a in new], search.designs))
        share = max((len(search.chosen()) - before) / max(len(new), 1), 0.2)
        wanted = (SURPLUS * count - len(search.chosen())) / share
        following = max(steps + 1, int(1.3 * steps))
        while references.lattice(objectives, following).shape[1] < wanted:
            following += 1
        steps = following


def _beside(search: _Search, level: Vector) -> Start:
    """A start from the design of the nearest levels."""
    levels = np.stack([one.level for one in search.designs], axis=1)
    near = search.designs[int(np.argmin(dominance.distances(levels, level)))]
    t = float((near.unit - level).max())
    return Start(level, np.ones(len(level)), search.tracer.to_t(near.point.z, t), near.hessian)


def _checked(search: _Search, settings: Settings) -> int:
    """Search at some levels as if nothing were known; how many of them were merely local."""
    tracer, found = search.tracer, []
    inner = [k for k in search.chosen() if search.designs[k].held][1:-1]
    picked = np.linspace(0, len(inner) - 1, settings.checks + 2)[1:-1].round().astype(int)
    for number, place in enumerate(picked if inner else ()):
        tell("searching for what was overlooked", number / settings.checks)
        one = search.designs[inner[place]]
        best = solve(
            tracer.at(one.level, one.way),
            starts=settings.starts,
            samples=settings.samples,
            seed=settings.seed + 1 + number,
        )
        if best.violation <= FEASIBLE and best.objective < one.point.objective - 1e-6:
            found.append(best.x[:-1])
    if found:
        search.others = np.concatenate([search.others, np.stack(found, axis=1)], axis=1)
        search.take([])
    return len(found)


def _finished(
    search: _Search, settings: Settings, anchors: Sequence[Solution], checked: int, improved: int
) -> Front:
    """The designs that count, evenly spread, with their optimality checked."""
    tracer, chosen = search.tracer, search.chosen()
    conditions = Conditions(tracer.objectives, tracer.width)
    residuals = np.array([conditions.residual(search.designs[k].point) for k in chosen])
    sound = residuals <= RESIDUAL
    failed = search.failed + int((~sound).sum())
    chosen, residuals = chosen[sound], residuals[sound]
    units = search.units[:, chosen]
    if len(chosen) > settings.count:
        ends = np.unique(np.argmin(units, axis=1))
        kept = dominance.thinned(units, ends, settings.count)
        chosen, residuals, units = chosen[kept], residuals[kept], units[:, kept]
    order = np.lexsort(units[::-1])
    chosen, residuals, units = chosen[order], residuals[order], units[:, order]
    x = np.stack([search.designs[k].point.x[:-1] for k in chosen], axis=1)
    everything = np.concatenate(
        [search.units, tracer.unit(search.others), *(u[:, None] for u in search.passed)], axis=1
    )
    lost = ~dominance.nondominated(np.concatenate([units, everything], axis=1))[len(chosen) :]
    passed = everything[:, lost] * tracer.width[:, None] + tracer.ideal[:, None]
    values = units * tracer.width[:, None] + tracer.ideal[:, None]
    return Front(
        x, values, units, residuals, dominance.knee(units), passed, tuple(anchors),
        checked, improved, failed, tracer.solves, tuple(tracer.warnings),
    )  # fmt: skip


def _single(tracer: Tracer, x: Vector, anchors: Sequence[Solution]) -> Front:
    """A front of one design, which is best in every objective."""
    unit = tracer.unit(x)
    one = tracer.begin(x[:, 0], unit[:, 0], np.ones(len(unit)))
    residual = Conditions(tracer.objectives, tracer.width).residual(one.point)
    return Front(
        x, tracer.objectives.values(x), unit, np.array([residual]), None,
        np.empty((len(unit), 0)), tuple(anchors), warnings=tuple(tracer.warnings),
    )  # fmt: skip
