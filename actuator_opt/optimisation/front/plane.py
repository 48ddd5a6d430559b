"""Designs of three or more objectives: a lattice as far as the front goes, then its holes.

The range of a front is not that of its anchors: it may bulge beyond them. So levels are tried next
to every level that has a design at it, until the front ends. Where it does, the level leads to its
edge, of which the objectives that still can be bettered are. What the lattice leaves wide apart,
where the front is steep, is then filled.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from ...base.progress import tell
from ..problem import Vector
from . import dominance, references
from .dominance import Indices, distances
from .search import JUMP, FrontSearch
from .tracer import BETTER, HELD, Design, Start

Place = tuple[int, ...]
"""Steps of a lattice from the middle, one number for each objective, of sum 0."""

SURPLUS = 2.0
"""Designs wanted over those asked for, to choose the farthest apart of."""

COARSE = 4
"""Steps of the first lattice from the middle to the level of an anchor."""

RESERVE = 12
"""Most levels of a lattice per design asked for."""

GROWN = 0.05
"""Share by which the range of an objective must change for everything to be normalised anew."""

RESCALES = 3
"""Most times that it is."""

PRICED = 1e-6
"""Price of an objective, of all together 1, above which its level holds it back."""

HOLD = 1e-9
"""Normalised room of an objective that is held while others are bettered."""

ROUNDS = 12
"""Most rounds of filling holes."""

ELSEWHERE = 1e-3
"""Difference of a variable above which two designs at one level are not the same."""

CLOSE = 2.0
"""Distance by which a design may be behind to be tried, over that of neighbours."""

CROSSINGS = 4
"""Most times that designs are tried from their neighbours."""

NEIGHBOURS = 14
"""Designs next to one that a hole may lie between."""


def fill_plane(search: FrontSearch, count: int) -> None:
    """Designs all over the front, more than asked for, evenly spread."""
    objectives, most = search.tracer.objectives.count, RESERVE * count + 60
    if len(search.designs) == objectives:
        steps = COARSE if objectives == 3 else COARSE // 2
        lattice = references.places(objectives, steps)
        for _ in range(1 + RESCALES):
            _flooded(search, lattice, steps, most)
            if not _renormalised(search):
                break
            lattice = _nearest(search, steps)
        while len(references.places(objectives, steps + 1)) <= SURPLUS * count:
            steps += 1
        held = _flooded(search, references.places(objectives, steps), steps, most)
        missing = SURPLUS * count / max(held, 1)
        if len(search.chosen()) < count:
            finer = round(steps * missing ** (1 / (objectives - 1)))
            _flooded(search, _nearest(search, finer), finer, most)
    _fill_holes(search, count)
    for _ in range(CROSSINGS):
        if not _crossed(search):
            break


def _nearest(search: FrontSearch, steps: int) -> list[Place]:
    """The places of a lattice next to the designs known."""
    found: set[Place] = set()
    for one in search.designs:
        exact = (one.unit - one.unit.mean()) * steps
        whole = np.rint(exact).astype(int)
        whole[int(np.argmax(np.abs(exact - whole)))] -= whole.sum()
        found.add(tuple(whole.tolist()))
    return sorted(found)


def _flooded(search: FrontSearch, begun: Iterable[Place], steps: int, most: int) -> int:
    """Try these places, and those next to every one that has a design; how many have."""
    tried: set[Place] = set()
    waiting, held = list(begun), 0
    while waiting and len(tried) < most:
        tell("covering the front", min(len(tried) / most, 1.0))
        tried |= set(waiting)
        starts = [_beside(search, references.level(place, steps)) for place in waiting]
        found = search.compared(starts)
        there = [p for p, one in zip(waiting, found, strict=True) if one is not None and one.held]
        held += len(there)
        search.take(_all_bettered(search, found))
        following = {near for place in there for near in references.around(place)}
        waiting = sorted(following - tried)
    return held


def _beside(search: FrontSearch, level: Vector) -> Start:
    """A start from the designs next to a level, the nearer the more."""
    away = distances(search.plane, level - level.mean())
    near = np.argsort(away, kind="stable")[: len(level)]
    shares = 1 / np.maximum(away[near], 1e-9) ** 2
    some = [search.designs[k] for k in near]
    z = np.stack([one.point.z for one in some], axis=1) @ (shares / shares.sum())
    t = max(float((one.unit - level).max()) for one in some)
    return Start(level, np.ones(len(level)), search.tracer.to_t(z, t), some[0].hessian)


def _all_bettered(search: FrontSearch, found: Sequence[Design | None]) -> list[Design]:
    """Each design, with those objectives bettered that cost the others nothing, at its own level.

    An objective that its level does not hold back has no price; with the others held where they
    are it is bettered until every objective has had one [Marler2004].
    """
    done: list[Design] = []
    left = [(one, search.tracer.prices(one) > PRICED) for one in found if one is not None]
    for again in range(search.tracer.objectives.count):
        done += [one for one, firm in left if firm.all()]
        left = [(one, firm) for one, firm in left if not firm.all()]
        if not left:
            break
        starts = [_freed(search, one, firm) for one, firm in left]
        bettered = search.tracer.solve(starts, [one for one, _ in left])
        both = list(zip(bettered, left, strict=True))
        if again:  # where what is held leaves no room at all, the last stage is the end
            done += [one for new, (one, _) in both if new is None]
        left = [
            (new, firm | (search.tracer.prices(new) > PRICED))
            for new, (_, firm) in both
            if new is not None
        ]
    return search.tracer.placed(done)


def _freed(search: FrontSearch, one: Design, firm: npt.NDArray[np.bool_]) -> Start:
    """A start to better the other objectives, the firm ones held where they are."""
    level, way = np.where(firm, one.unit + HOLD, one.level), (~firm).astype(float)
    t = float((one.unit - one.level)[~firm].max())
    return Start(level, way, search.tracer.to_t(one.point.z, t), one.hessian)


def _renormalised(search: FrontSearch) -> bool:
    """Whether the range of the front is another than thought, and all is normalised by it now."""
    units = search.units[:, search.chosen()]
    low, wide = units.min(axis=1), np.ptp(units, axis=1)
    if (np.abs(low) < GROWN).all() and (np.abs(wide - 1) < GROWN).all():
        return False
    search.rescale(low, np.where(wide > HELD, wide, 1.0))
    return True


def _fill_holes(search: FrontSearch, count: int) -> None:
    """Levels between neighbours that lie farthest apart, until there are enough designs."""
    tried: set[tuple[int, int]] = set()
    seen: list[Design] = []  # kept, for an id is that of another design once its own is gone
    for number in range(ROUNDS):
        chosen = search.chosen()
        missing = int(np.ceil(SURPLUS * count)) - len(chosen)
        if missing <= 0:
            return
        tell("filling holes of the front", number / ROUNDS)
        designs = [search.designs[k] for k in chosen]
        seen += designs
        pairs = [pair for pair in _apart(search, chosen) if _key(designs, pair) not in tried]
        pairs = pairs[: max(min(missing, len(chosen) // 3), 1)]
        if not pairs:
            return
        tried |= {_key(designs, pair) for pair in pairs}
        starts = [_middle(search, designs[i], designs[j]) for i, j in pairs]
        search.take(_all_bettered(search, search.compared(starts)))


def _key(designs: Sequence[Design], pair: tuple[int, int]) -> tuple[int, int]:
    return id(designs[pair[0]]), id(designs[pair[1]])


def _apart(search: FrontSearch, chosen: Indices) -> list[tuple[int, int]]:
    """Neighbours with no other design between them, those farthest apart first."""
    units, plane = search.units[:, chosen], search.plane[:, chosen]
    found: dict[tuple[int, int], float] = {}
    for i in range(len(chosen)):
        near = np.argsort(distances(plane, plane[:, i]), kind="stable")[1 : 1 + NEIGHBOURS]
        for j in near.tolist():
            middle = (plane[:, i] + plane[:, j]) / 2
            radius = distances(plane[:, [i]], middle)[0] * (1 - 1e-9)
            others = near[near != j]
            if not (distances(plane[:, others], middle) < radius).any():
                found[min(i, j), max(i, j)] = float(distances(units[:, [i]], units[:, j])[0])
    return sorted(found, key=lambda pair: -found[pair])


def _middle(search: FrontSearch, one: Design, other: Design) -> Start:
    """A start at the level midway between two designs."""
    level = (one.unit + other.unit) / 2
    level = level - level.mean() + 1 / len(level)
    z = (one.point.z + other.point.z) / 2
    t = float((one.unit + other.unit).mean() / 2 - 1 / len(level))
    return Start(level, np.ones(len(level)), search.tracer.to_t(z, t), one.hessian)


def _crossed(search: FrontSearch) -> bool:
    """Try designs from others that are nearly as good in every objective with other variables.

    Whether any was merely local.
    """
    chosen = search.chosen()
    both = [(int(chosen[i]), int(chosen[j])) for i, j in _doubtful(search, chosen)]
    starts = []
    for to, way in both:
        one, other = search.designs[to], search.designs[way]
        t = float((other.unit - one.unit).max())
        at = search.tracer.to_t(other.point.z, t)
        starts.append(Start(one.level, one.way, at, other.hessian))
    others = [
        new
        for (to, _), new in zip(both, search.tracer.solve(starts), strict=True)
        if new is not None and _elsewhere(search.designs[to], new)
    ]
    before = {id(search.designs[k]) for k in chosen}
    search.take(_all_bettered(search, others))
    return bool(others) and not before <= {id(search.designs[k]) for k in search.chosen()}


def _elsewhere(one: Design, new: Design) -> bool:
    """Whether a design that is as good at the same level is another one."""
    far = np.abs(new.point.z[:-1] - one.point.z[:-1]).max() > ELSEWHERE
    return bool(far and new.point.objective < one.point.objective + BETTER)


def _doubtful(search: FrontSearch, chosen: Indices) -> list[tuple[int, int]]:
    """Pairs of a design and the one that comes nearest to bettering it from another valley."""
    units = search.units[:, chosen]
    z = np.stack([search.designs[k].point.z[:-1] for k in chosen], axis=1)
    neighbours = np.array(_apart(search, chosen), dtype=np.intp).reshape(-1, 2)
    if not len(neighbours):
        return []
    far = JUMP * np.median(np.abs(z[:, neighbours[:, 0]] - z[:, neighbours[:, 1]]).max(axis=0))
    near = CLOSE * np.median(dominance.nearest(units))
    pairs = []
    for i in range(len(chosen)):
        behind = (units - units[:, [i]]).max(axis=0)
        behind[np.abs(z - z[:, [i]]).max(axis=0) <= far] = np.inf
        if behind.min() <= near:
            pairs.append((i, int(np.argmin(behind))))
    return pairs
