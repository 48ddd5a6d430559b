"""The designs of a front so far: collected, compared and selected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..descents import RESIDUAL
from ..problem import Vector
from . import dominance
from .objectives import Conditions
from .tracer import BETTER, Design, Start, Tracer

EQUAL = 1e-8
"""Normalised difference that counts as equal, as bounded objectives vary by this much."""

JUMP = 5.0
"""Step of the variables between neighbours, over the median, that suggests another valley."""


@dataclass
class FrontSearch:
    """The designs so far, with other known feasible points."""

    tracer: Tracer
    designs: list[Design]
    others: Vector
    """Variables (n, k) of further feasible designs."""
    passed: list[Vector] = field(default_factory=list)
    """Objectives of designs that were replaced."""
    lost: list[Vector] = field(default_factory=list)
    """Levels without a design."""
    _rest: tuple[Vector, Vector] | None = None
    _residuals: dict[int, tuple[Design, float]] = field(default_factory=dict)

    def solve(self, starts: Sequence[Start], *, firmly: bool = True) -> int:
        """Add the designs at the levels of some starts; returns their number.

        `firmly` : retry those that shared steps lose within trust regions
        """
        good = [one for one in self.found(starts, firmly=firmly) if one is not None]
        self.take(good)
        return len(good)

    def found(self, starts: Sequence[Start], *, firmly: bool = True) -> list[Design | None]:
        """The designs at the levels of some starts, not added yet; see `solve`."""
        found = self.tracer.solve(starts, self.designs if firmly else ())
        self.lost += [s.level for s, one in zip(starts, found, strict=True) if one is None]
        return found

    def compared(self, starts: Sequence[Start]) -> list[Design | None]:
        """As `found`, but continue from a known design where it is better at the level."""
        found = self.found(starts)
        good = [k for k, one in enumerate(found) if one is not None]
        known = np.stack([one.point.x[:-1] for one in self.designs], axis=1)
        more = np.concatenate([self.others, known], axis=1)
        rest = np.concatenate([self.rest, self.units], axis=1)
        exchanged = self.tracer.exchange([one for one in found if one is not None], more, rest)
        for k, one in zip(good, exchanged, strict=True):
            found[k] = one
        return found

    def take(self, good: Sequence[Design]) -> None:
        """Add designs, and exchange results between them."""
        before = [*self.designs, *good]
        self.designs = self.tracer.exchange(list(before), self.others, self.rest)
        news = [new for old, new in zip(before, self.designs, strict=True) if old is not new]
        self.designs = self.tracer.spread(self.designs, news)
        self._pass([o for o, new in zip(before, self.designs, strict=True) if o is not new])

    def _pass(self, designs: Sequence[Design]) -> None:
        """Record the objectives of designs that are replaced."""
        self.passed += [self.tracer.values(one.unit[:, None])[:, 0] for one in designs]

    def rescale(self, low: Vector, wide: Vector) -> None:
        """Normalise to another range (objectives,), in current units."""
        tracer = self.tracer
        tracer.rescale(tracer.ideal + low * tracer.width, wide * tracer.width)
        self.designs = tracer.placed(self.designs)
        self.lost.clear()

    @property
    def plane(self) -> Vector:
        """The designs (objectives, k) projected on the plane of equal sums."""
        units = self.units
        return np.asarray(units - units.mean(axis=0))

    def sort(self) -> None:
        """Sort the designs by their level of the first objective."""
        self.designs.sort(key=lambda one: one.level[0])

    @cached_property
    def _conditions(self) -> Conditions:
        return Conditions(self.tracer.objectives)

    def residual(self, k: int) -> float:
        """Residual of a design's optimality conditions, improved by Newton steps if necessary."""
        one = self.designs[k]
        known = self._residuals.get(id(one))
        if known is not None and known[0] is one:
            return known[1]
        found = self._conditions.residual(one.point)
        if found > RESIDUAL:
            self.designs[k] = one = self.tracer.polished(one)
            found = self._conditions.residual(one.point)
        self._residuals[id(one)] = (one, found)
        return found

    def consider(self, x: Vector) -> None:
        """Compare the designs with further feasible ones (n, k)."""
        self.others = np.concatenate([self.others, x], axis=1)
        self.take([])

    def cross(self) -> None:
        """Retry each side of a jump in the variables from the other side."""
        self.sort()
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
                self._pass([self.designs[to]])
                self.designs[to] = new
                self.designs = self.tracer.spread(self.designs, [new])

    @property
    def rest(self) -> Vector:
        """Normalised objectives of the further designs (objectives, k)."""
        if self._rest is None or self._rest[0] is not self.others:
            self._rest = self.others, self.tracer.objectives.values(self.others)
        return self.tracer.normal(self._rest[1])

    @property
    def units(self) -> Vector:
        """Normalised objectives of all designs (objectives, k)."""
        return np.stack([one.unit for one in self.designs], axis=1)

    def chosen(self) -> dominance.Indices:
        """The distinct non-dominated designs, those at all levels first."""
        order = np.array(sorted(range(len(self.designs)), key=lambda k: not self.designs[k].held))
        units = self.units
        own = dominance.distinct(units, order.astype(np.intp))
        every = np.concatenate([units[:, own], self.rest + BETTER], axis=1)
        equal = EQUAL if len(units) > 2 else 0.0
        best = dominance.nondominated(every, equal)[: len(own)]
        return np.sort(own[best])
