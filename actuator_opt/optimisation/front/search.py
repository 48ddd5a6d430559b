"""The designs of a front found so far: taken in, compared with each other, chosen from."""

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
"""Normalised objective that counts as equal: what is held while others are bettered varies so."""

JUMP = 5.0
"""Step of the variables between neighbours, over the median one, that may be another valley."""


@dataclass
class FrontSearch:
    """The designs so far, and what else is known."""

    tracer: Tracer
    designs: list[Design]
    others: Vector
    """Variables (n, k) of more designs that meet every requirement."""
    passed: list[Vector] = field(default_factory=list)
    """Objectives of designs that were replaced."""
    lost: list[Vector] = field(default_factory=list)
    """Levels at which no design was found."""
    _rest: tuple[Vector, Vector] | None = None
    _residuals: dict[int, tuple[Design, float]] = field(default_factory=dict)

    def solve(self, starts: Sequence[Start], *, firmly: bool = True) -> int:
        """Add the designs at the levels of some starts; how many were found.

        `firmly` : whether those that common steps lose are looked for within trusted radii
        """
        good = [one for one in self.found(starts, firmly=firmly) if one is not None]
        self.take(good)
        return len(good)

    def found(self, starts: Sequence[Start], *, firmly: bool = True) -> list[Design | None]:
        """The designs at the levels of some starts, not taken in yet; see `solve`."""
        found = self.tracer.solve(starts, self.designs if firmly else ())
        self.lost += [s.level for s, one in zip(starts, found, strict=True) if one is None]
        return found

    def compared(self, starts: Sequence[Start]) -> list[Design | None]:
        """As `found`, but for levels at which a design known is better, which are gone on from."""
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
        """Add designs, and exchange what they found."""
        before = [*self.designs, *good]
        self.designs = self.tracer.exchange(list(before), self.others, self.rest)
        news = [new for old, new in zip(before, self.designs, strict=True) if old is not new]
        self.designs = self.tracer.spread(self.designs, news)
        self._pass([o for o, new in zip(before, self.designs, strict=True) if o is not new])

    def _pass(self, designs: Sequence[Design]) -> None:
        """Keep what designs that are replaced had come to."""
        self.passed += [self.tracer.values(one.unit[:, None])[:, 0] for one in designs]

    def rescale(self, low: Vector, wide: Vector) -> None:
        """Normalise by another range (objectives,), in the units of now."""
        tracer = self.tracer
        tracer.rescale(tracer.ideal + low * tracer.width, wide * tracer.width)
        self.designs = tracer.placed(self.designs)
        self.lost.clear()

    @property
    def plane(self) -> Vector:
        """The designs (objectives, k) along the plane of equal sums."""
        units = self.units
        return np.asarray(units - units.mean(axis=0))

    def sort(self) -> None:
        """Bring the designs in the order of their levels of the first objective."""
        self.designs.sort(key=lambda one: one.level[0])

    @cached_property
    def _conditions(self) -> Conditions:
        return Conditions(self.tracer.objectives)

    def residual(self, k: int) -> float:
        """Of the optimality conditions of a design, which exact Newton steps mend if need be."""
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
        """Exchange what is known with more designs (n, k) that meet every requirement."""
        self.others = np.concatenate([self.others, x], axis=1)
        self.take([])

    def cross(self) -> None:
        """Try each side of a jump of the variables from the other: it may be the better valley."""
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
        """Normalised objectives of the other designs (objectives, k)."""
        if self._rest is None or self._rest[0] is not self.others:
            self._rest = self.others, self.tracer.objectives.values(self.others)
        return self.tracer.normal(self._rest[1])

    @property
    def units(self) -> Vector:
        """Normalised objectives of all designs (objectives, k)."""
        return np.stack([one.unit for one in self.designs], axis=1)

    def chosen(self) -> dominance.Indices:
        """The designs that nothing known dominates, each once, those at all levels first."""
        order = np.array(sorted(range(len(self.designs)), key=lambda k: not self.designs[k].held))
        units = self.units
        own = dominance.distinct(units, order.astype(np.intp))
        every = np.concatenate([units[:, own], self.rest + BETTER], axis=1)
        equal = EQUAL if len(units) > 2 else 0.0
        best = dominance.nondominated(every, equal)[: len(own)]
        return np.sort(own[best])
