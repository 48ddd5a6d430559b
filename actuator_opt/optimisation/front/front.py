"""The Pareto front from its anchors, evenly spread and checked for merely local designs.

The best design of each objective alone is searched for like any optimum. Designs at levels between
these anchors are found from their neighbours, in shared steps. Each is compared with all others at
its own levels, which reveals and replaces merely local designs. Independent full searches at some
levels then check whether a better one was overlooked.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...base.progress import tell
from ..problem import Vector
from . import dominance, even
from .ends import Effort, NoEnd, ends, normalised
from .line import fill_line
from .objectives import Conditions, Objectives
from .overlooked import OVERLOOKED, better
from .plane import fill_plane
from .search import FrontSearch
from .tracer import Tracer


@dataclass(frozen=True)
class Settings:
    """Search effort for a front.

    Parameters
    ----------
    count : designs requested
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
    """A front: its designs along the first objective, and the search statistics.

    Parameters
    ----------
    x : variables (n, k)
    values : objectives (objectives, k), to be minimised
    units : the same between 0 (ideal) and 1 (worst of the anchors)
    residuals : of the optimality conditions (k,)
    knee : index and depth of the design where the front bends most, or None
    passed : values (objectives, p) of dominated designs met during the search
    checked, improved : full searches at levels in between, and how many found something better
    failed : number of levels without a design at or near them
    wide : gaps of two objectives wider than `even.WIDEST`, and the reason
    """

    x: Vector
    values: Vector
    units: Vector
    residuals: Vector
    knee: tuple[int, float] | None
    passed: Vector
    checked: int = 0
    improved: int = 0
    failed: int = 0
    wide: tuple[even.Gap, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def gaps(self) -> Vector:
        """Normalised distance to the next design: along two objectives, else to the nearest."""
        if self.units.shape[1] < 2:
            return np.empty(0)
        if len(self.units) > 2:
            return dominance.nearest(self.units)
        return np.asarray(np.sqrt((np.diff(self.units, axis=1) ** 2).sum(axis=0)))


def front(objectives: Objectives, settings: Settings) -> Front | NoEnd:
    """Trace the front of some objectives; returns the failed search if an anchor has no optimum."""
    effort = Effort(settings.starts, settings.samples, settings.seed)
    tell("searching for the ends of the front")
    checked, warnings = objectives.checked()
    found = ends(objectives, checked, effort)
    if isinstance(found, NoEnd):
        return found
    tracer, x = normalised(objectives, checked, found)
    if x.shape[1] == 1:
        return _single(tracer, x, warnings)
    search = FrontSearch(tracer, tracer.begun(x), found.others)
    _fill(search, settings.count)
    searched = improved = 0
    for again in range(2 if settings.checks else 0):
        places = _places(search, settings)
        before = [search.designs[k] for k in places]
        tell("searching for overlooked designs")
        more = better(tracer, before, replace(effort, seed=settings.seed + 1 + again))
        searched += len(places)
        if not more:
            break
        search.consider(np.stack(more, axis=1))
        gained = sum(
            search.designs[k].point.objective < one.point.objective - OVERLOOKED
            for k, one in zip(places, before, strict=True)
        )
        improved += gained
        if not gained:
            break
        _fill(search, settings.count)
    return _finished(search, settings.count, warnings, searched, improved)


def _fill(search: FrontSearch, count: int) -> None:
    """Find the requested number of designs, evenly spread."""
    if len(search.tracer.ideal) == 2:
        fill_line(search, count)
        even.close(search, count)
    else:
        fill_plane(search, count)


def _places(search: FrontSearch, settings: Settings) -> list[int]:
    """Indices of designs for independent searches: evenly spaced, and one in each wide gap."""
    inner = [k for k in search.chosen() if search.designs[k].held][1:-1]
    picked = np.linspace(0, len(inner) - 1, settings.checks + 2)[1:-1].round().astype(int)
    places = {inner[k] for k in picked.tolist()} if inner else set()
    if len(search.tracer.ideal) == 2:
        places |= set(even.middles(search, settings.count)[: settings.checks])
    return sorted(places)


def _finished(
    search: FrontSearch, count: int, warnings: tuple[str, ...], checked: int, improved: int
) -> Front:
    """The final designs, with the designs they dominate and their spacing."""
    tracer, kept = search.tracer, even.chosen(search, count)
    units = search.units[:, kept]
    replaced = np.stack(search.passed, axis=1) if search.passed else np.empty((len(units), 0))
    everything = np.concatenate([search.units, search.rest, tracer.normal(replaced)], axis=1)
    lost = ~dominance.nondominated(np.concatenate([units, everything], axis=1))[len(kept) :]
    return Front(
        x=np.stack([search.designs[k].point.x[:-1] for k in kept], axis=1),
        values=tracer.values(units),
        units=units,
        residuals=np.array([search.residual(k) for k in kept]),
        knee=dominance.knee(units),
        passed=tracer.values(everything[:, lost]),
        checked=checked,
        improved=improved,
        failed=even.lost(search, kept),
        wide=tuple(even.wide(search, kept)) if len(units) == 2 else (),
        warnings=warnings,
    )


def _single(tracer: Tracer, x: Vector, warnings: tuple[str, ...]) -> Front:
    """A front of one design, which is best in every objective."""
    one = tracer.begun(x)[0]
    unit = one.unit[:, None]
    residual = Conditions(tracer.objectives).residual(one.point)
    return Front(
        x, tracer.objectives.values(x), unit, np.array([residual]), None,
        np.empty((len(unit), 0)), warnings=warnings,
    )  # fmt: skip
