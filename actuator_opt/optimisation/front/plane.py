"""Designs of three or more objectives over the front, and an even spread of the final designs.

The front may bulge beyond its anchors. So the neighbours of every level with a design are tried,
until the front ends. There the level leads to its edge: the objectives that can still improve are
improved. Wide holes where the front is steep are filled; gaps that remain are explained.

Levels lie on the plane of the anchors. Two objectives use the line u -> (u, 1 - u). Along it a
front is never steeper than 45 degrees, so its length between two places is at most twice their
difference in u. More objectives use a lattice of the plane sum = 1, where its lines meet the box of
ideal and nadir.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
import numpy.typing as npt

from ...base.progress import tell
from ..problem import Vector
from ..resolve.parallel_descents import RESIDUAL
from . import plane, tracer
from .tracer import BETTER, HELD, JUMP, FrontDesign, FrontSearch, FrontStart, Indices, distances

STEEPEST = 2.0
"""Maximum length of a two-objective front per unit of u."""


def on_line(places: Vector) -> Vector:
    """Levels (2, k) at places u (k,) between the anchors of the first and the second objective."""
    return np.stack([places, 1.0 - places])


def lengths(places: Vector, units: Vector) -> Vector:
    """Length of the front between neighbours (k - 1,), jumps excluded.

    Parameters
    ----------
    places : u (k,), ascending
    units : normalised objectives (2, k) there
    """
    way = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    return np.asarray(np.minimum(way, STEEPEST * np.diff(places)))


def between(places: Vector, units: Vector, count: int) -> Vector:
    """The requested number of new places u, where the front is longest between neighbours."""
    way = lengths(places, units)
    pieces = np.ones(len(way), dtype=int)
    for _ in range(count):
        longest = int(np.argmax(way / pieces))
        if not way[longest] > 0:
            break
        pieces[longest] += 1
    parts = [
        places[k] + (places[k + 1] - places[k]) * np.arange(1, n) / n for k, n in enumerate(pieces)
    ]
    return np.concatenate(parts) if parts else np.empty(0)


def places(objectives: int, steps: int) -> list[tuple[int, ...]]:
    """Places of a lattice, in steps from the middle, whose lines meet the unit box.

    >>> len(places(3, 1)), len(places(3, 2))
    (1, 7)
    """
    axis = range(-steps, steps + 1)
    return [
        (*most, last)
        for most in product(axis, repeat=objectives - 1)
        if (last := -sum(most)) in axis and max(*most, last) - min(*most, last) <= steps
    ]


def around(place: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The neighbours of a place.

    >>> around((0, 0))
    [(-1, 1), (1, -1)]
    """
    found = []
    for up, down in permutations(range(len(place)), 2):
        near = list(place)
        near[up] += 1
        near[down] -= 1
        found.append(tuple(near))
    return sorted(found)


def level(place: Sequence[int], steps: int) -> Vector:
    """Levels (objectives,) at a place."""
    return 1.0 / len(place) + np.array(place, dtype=float) / steps


Place = tuple[int, ...]
"""Lattice steps from the middle, one number per objective, of sum 0."""

SURPLUS = 2.0
"""Designs computed per design requested, so that the farthest apart can be selected."""

COARSE = 4
"""Steps of the first lattice from the middle to the level of an anchor."""

RESERVE = 12
"""Maximum levels of a lattice per design requested."""

GROWN = 0.05
"""Relative change of an objective's range that triggers a new normalisation."""

RESCALES = 3
"""Maximum number of new normalisations."""

PRICED = 1e-6
"""Price of an objective, of 1 in total, above which its level is active."""

HOLD = 1e-9
"""Normalised slack of a bounded objective while others improve."""

ROUNDS = 12
"""Maximum rounds of filling holes."""

ELSEWHERE = 1e-3
"""Difference of a variable above which two designs at one level are different."""

CLOSE = 2.0
"""Largest shortfall of a design worth trying, relative to the distance of neighbours."""

CROSSINGS = 4
"""Maximum rounds of trying designs from their neighbours."""

NEIGHBOURS = 14
"""Neighbours of a design that are checked for a hole between."""


def fill_plane(search: FrontSearch, count: int) -> None:
    """Cover the front with more designs than requested, evenly spread."""
    objectives, most = search.tracer.objectives.count, RESERVE * count + 60
    if len(search.designs) == objectives:
        steps = COARSE if objectives == 3 else COARSE // 2
        lattice = places(objectives, steps)
        for _ in range(1 + RESCALES):
            _flooded(search, lattice, steps, most)
            if not _renormalised(search):
                break
            lattice = _nearest(search, steps)
        while len(places(objectives, steps + 1)) <= SURPLUS * count:
            steps += 1
        held = _flooded(search, places(objectives, steps), steps, most)
        missing = SURPLUS * count / max(held, 1)
        if len(search.chosen()) < count:
            finer = round(steps * missing ** (1 / (objectives - 1)))
            _flooded(search, _nearest(search, finer), finer, most)
    _fill_holes(search, count)
    for _ in range(CROSSINGS):
        if not _crossed(search):
            break


def _nearest(search: FrontSearch, steps: int) -> list[Place]:
    """The lattice places nearest to the known designs."""
    found: set[Place] = set()
    for design in search.designs:
        exact = (design.unit - design.unit.mean()) * steps
        whole = np.rint(exact).astype(int)
        whole[int(np.argmax(np.abs(exact - whole)))] -= whole.sum()
        found.add(tuple(whole.tolist()))
    return sorted(found)


def _flooded(search: FrontSearch, begun: Iterable[Place], steps: int, most: int) -> int:
    """Try lattice places and the neighbours of every success; returns the number of successes."""
    tried: set[Place] = set()
    waiting, held = list(begun), 0
    while waiting and len(tried) < most:
        tell("covering the front", min(len(tried) / most, 1.0))
        tried |= set(waiting)
        starts = [_beside(search, level(place, steps)) for place in waiting]
        found = search.compared(starts)
        there = [p for p, one in zip(waiting, found, strict=True) if one is not None and one.held]
        held += len(there)
        search.take(_all_bettered(search, found))
        following = {near for place in there for near in around(place)}
        waiting = sorted(following - tried)
    return held


def _beside(search: FrontSearch, level: Vector) -> FrontStart:
    """A start from the designs next to a level, weighted by proximity."""
    away = distances(search.plane, level - level.mean())
    near = np.argsort(away, kind="stable")[: len(level)]
    shares = 1 / np.maximum(away[near], 1e-9) ** 2
    some = [search.designs[k] for k in near]
    z = np.stack([one.point.z for one in some], axis=1) @ (shares / shares.sum())
    t = max(float((one.unit - level).max()) for one in some)
    return FrontStart(level, np.ones(len(level)), search.tracer.to_t(z, t), some[0].hessian)


def _all_bettered(search: FrontSearch, found: Sequence[FrontDesign | None]) -> list[FrontDesign]:
    """Improve the objectives of each design that cost the others nothing, at its own level.

    An objective whose level is not active has no price. With the others bounded at their values it
    is improved, until every objective has a price [Marler2004].
    """
    done: list[FrontDesign] = []
    left = [(one, search.tracer.prices(one) > PRICED) for one in found if one is not None]
    for again in range(search.tracer.objectives.count):
        done += [one for one, firm in left if firm.all()]
        left = [(one, firm) for one, firm in left if not firm.all()]
        if not left:
            break
        starts = [_freed(search, one, firm) for one, firm in left]
        bettered = search.tracer.solve(starts, [one for one, _ in left])
        both = list(zip(bettered, left, strict=True))
        if again:  # without any slack, the last stage is the end
            done += [one for new, (one, _) in both if new is None]
        left = [
            (new, firm | (search.tracer.prices(new) > PRICED))
            for new, (_, firm) in both
            if new is not None
        ]
    return search.tracer.placed(done)


def _freed(
    search: FrontSearch, front_design: FrontDesign, firm: npt.NDArray[np.bool_]
) -> FrontStart:
    """A start that improves the other objectives, with the firm ones bounded."""
    level, way = np.where(firm, front_design.unit + HOLD, front_design.level), (~firm).astype(float)
    t = float((front_design.unit - front_design.level)[~firm].max())
    return FrontStart(level, way, search.tracer.to_t(front_design.point.z, t), front_design.hessian)


def _renormalised(search: FrontSearch) -> bool:
    """Normalise again if the range of the front has changed; whether it has."""
    units = search.units[:, search.chosen()]
    low, wide = units.min(axis=1), np.ptp(units, axis=1)
    if (np.abs(low) < GROWN).all() and (np.abs(wide - 1) < GROWN).all():
        return False
    search.rescale(low, np.where(wide > HELD, wide, 1.0))
    return True


def _fill_holes(search: FrontSearch, count: int) -> None:
    """Add levels between the neighbours farthest apart, until there are enough designs."""
    tried: set[tuple[int, int]] = set()
    seen: list[FrontDesign] = []  # kept alive, as an id may be reused
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


def _key(designs: Sequence[FrontDesign], pair: tuple[int, int]) -> tuple[int, int]:
    return id(designs[pair[0]]), id(designs[pair[1]])


def _apart(search: FrontSearch, chosen: Indices) -> list[tuple[int, int]]:
    """Neighbours without another design between them, farthest apart first."""
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


def _middle(search: FrontSearch, front_design: FrontDesign, other: FrontDesign) -> FrontStart:
    """A start at the level midway between two designs."""
    level = (front_design.unit + other.unit) / 2
    level = level - level.mean() + 1 / len(level)
    z = (front_design.point.z + other.point.z) / 2
    t = float((front_design.unit + other.unit).mean() / 2 - 1 / len(level))
    return FrontStart(level, np.ones(len(level)), search.tracer.to_t(z, t), front_design.hessian)


def _crossed(search: FrontSearch) -> bool:
    """Retry designs from nearly equal ones with different variables.

    Whether any was merely local.
    """
    chosen = search.chosen()
    both = [(int(chosen[i]), int(chosen[j])) for i, j in _doubtful(search, chosen)]
    starts = []
    for to, way in both:
        one, other = search.designs[to], search.designs[way]
        t = float((other.unit - one.unit).max())
        at = search.tracer.to_t(other.point.z, t)
        starts.append(FrontStart(one.level, one.way, at, other.hessian))
    others = [
        new
        for (to, _), new in zip(both, search.tracer.solve(starts), strict=True)
        if new is not None and _elsewhere(search.designs[to], new)
    ]
    before = {id(search.designs[k]) for k in chosen}
    search.take(_all_bettered(search, others))
    return bool(others) and not before <= {id(search.designs[k]) for k in search.chosen()}


def _elsewhere(front_design: FrontDesign, new: FrontDesign) -> bool:
    """Whether an equally good design at the same level differs."""
    far = np.abs(new.point.z[:-1] - front_design.point.z[:-1]).max() > ELSEWHERE
    return bool(far and new.point.objective < front_design.point.objective + BETTER)


def _doubtful(search: FrontSearch, chosen: Indices) -> list[tuple[int, int]]:
    """Pairs of a design and its closest competitor from another valley."""
    units = search.units[:, chosen]
    z = np.stack([search.designs[k].point.z[:-1] for k in chosen], axis=1)
    neighbours = np.array(_apart(search, chosen), dtype=np.intp).reshape(-1, 2)
    if not len(neighbours):
        return []
    far = JUMP * np.median(np.abs(z[:, neighbours[:, 0]] - z[:, neighbours[:, 1]]).max(axis=0))
    near = CLOSE * np.median(tracer.nearest(units))
    pairs = []
    for i in range(len(chosen)):
        behind = (units - units[:, [i]]).max(axis=0)
        behind[np.abs(z - z[:, [i]]).max(axis=0) <= far] = np.inf
        if behind.min() <= near:
            pairs.append((i, int(np.argmin(behind))))
    return pairs


GROWTH = 10
"""Maximum new designs per round, relative to the known ones."""
MOST_ROUNDS = 12
"""Maximum rounds: a continuous front takes two or three."""


def fill_line(search: FrontSearch, count: int) -> None:
    """Add designs between two anchors, wherever the front is longest."""
    for number in range(MOST_ROUNDS):
        missing = count - len(search.chosen())
        if missing <= 0:
            break
        tell("following the front", 1 - missing / count)
        search.sort()
        places = np.array([design.level[0] for design in search.designs])
        more = plane.between(places, search.units, min(missing, GROWTH * (len(places) - 1) - 1))
        if not len(more):
            break
        search.solve(between_on_line(search, more), firmly=number > 0)
    search.cross()


def between_on_line(search: FrontSearch, places: Sequence[float] | Vector) -> list[FrontStart]:
    """Starts at places u between the known designs, from their neighbours."""
    search.sort()
    known = [design.level[0] for design in search.designs]
    return [
        _between(search.designs, int(np.searchsorted(known, u)), float(u), np.ones(2))
        for u in places
    ]


def _between(designs: Sequence[FrontDesign], k: int, u: float, way: Vector) -> FrontStart:
    """A start before design k by interpolation; from the nearer neighbour if the front jumps."""
    left, right = designs[k - 1], designs[k]
    low, high = left.level[0], right.level[0]
    near = left if u - low < high - u else right
    z = near.point.z
    if not _jumps(left, right):
        some = [left, right]
        if k > 1 and not _jumps(designs[k - 2], left):
            some.insert(0, designs[k - 2])
        if k + 1 < len(designs) and not _jumps(right, designs[k + 1]):
            some.append(designs[k + 1])
        places = np.array([one.level[0] for one in some])
        z = np.stack([one.point.z for one in some], axis=1) @ _weights(places, u)
    return FrontStart(plane.on_line(np.array([u]))[:, 0], way, z, near.hessian)


def _jumps(left: FrontDesign, right: FrontDesign) -> bool:
    """Whether two designs are farther apart than on a continuous front."""
    wide = right.level[0] - left.level[0]
    return bool(np.linalg.norm(right.unit - left.unit) >= plane.STEEPEST * wide)


def _weights(places: Vector, u: float) -> Vector:
    """Weights for interpolating values at places (k,) at u, by the polynomial through all."""
    apart = places[:, None] - places + np.eye(len(places))
    to = u - places + np.zeros((len(places), 1))
    np.fill_diagonal(to, 1.0)
    return np.asarray((to / apart - np.eye(len(places)) * (1 / np.diag(apart) - 1)).prod(axis=1))


WIDEST = 3.0
"""Largest gap between neighbours, relative to the median gap."""


SPACING_ROUNDS = 6
"""Maximum rounds of adding designs in wide gaps."""


PIECES = 8
"""Maximum number of pieces per split of a gap."""


@dataclass(frozen=True)
class FrontGap:
    """A wide gap between neighbours of a front, in normalised objectives.

    Parameters
    ----------
    after : index of the design before it
    size : distance of its two designs
    reach : upper limit of the front's length between them, from the levels tried
    jump : whether that is at most a median gap, so that the front is discontinuous here
    """

    after: int
    size: float
    reach: float
    jump: bool


def chosen(search: FrontSearch, count: int) -> tracer.Indices:
    """The requested number of designs, farthest apart, along the first objective."""
    kept = np.array([k for k in search.chosen() if search.residual(k) <= RESIDUAL], dtype=np.intp)
    units = search.units[:, kept]
    order = np.lexsort(units[::-1])
    kept, units = kept[order], units[:, order]
    if len(kept) <= count:
        return kept
    firm = [*np.argmin(units, axis=1).tolist(), *np.argmax(units, axis=1).tolist()]
    if len(units) == 2:
        jumps = [gap.after for gap in wide(search, kept) if gap.jump]
        firm += [k + side for k in jumps for side in (0, 1)]
    first = np.array(list(dict.fromkeys(firm))[:count], dtype=np.intp)
    return kept[tracer.thinned(units, first, count)]


def wide(search: FrontSearch, kept: tracer.Indices) -> list[FrontGap]:
    """The wide gaps between designs of two objectives, in order."""
    units = search.units[:, kept]
    sizes = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    reaches = np.array([float(_pieces(search, *two).sum()) for two in _pairs(kept)])
    middle = float(np.median(np.minimum(sizes, reaches))) if len(sizes) else 0.0
    return [
        FrontGap(k, float(sizes[k]), float(reaches[k]), bool(reaches[k] <= middle))
        for k in np.flatnonzero(sizes > WIDEST * middle).tolist()
    ]


def close(search: FrontSearch, count: int) -> None:
    """Add designs of two objectives in wide gaps until only jumps remain."""
    for number in range(SPACING_ROUNDS):
        kept = chosen(search, count)
        open_ = [gap for gap in wide(search, kept) if not gap.jump]
        if not open_:
            return
        tell("closing gaps of the front", number / SPACING_ROUNDS)
        places = []
        for gap in open_:
            among = _among(search, kept[gap.after], kept[gap.after + 1])
            levels = np.array([search.designs[k].level[0] for k in among])
            more = plane.between(levels, search.units[:, among], PIECES - 1)
            places += more.tolist()
        if not search.solve(between_on_line(search, places)):
            return


def middles(search: FrontSearch, count: int) -> list[int]:
    """Add a design at the middle level of each wide gap, widest first."""
    kept, found = chosen(search, count), []
    for gap in sorted(wide(search, kept), key=lambda one: -one.size):
        among = _among(search, kept[gap.after], kept[gap.after + 1])
        levels = [search.designs[k].level[0] for k in among]
        middle = (levels[0] + levels[-1]) / 2
        found.append(int(among[int(np.argmin(np.abs(np.subtract(levels, middle))))]))
    return found


def lost(search: FrontSearch, kept: tracer.Indices) -> int:
    """Number of levels without a design in or near them, in gaps that are not jumps."""
    units = search.units[:, kept]
    if len(units) > 2:
        widest = tracer.nearest(units).max(initial=0.0)
        plane = search.plane[:, kept]
        levels = [level - level.mean() for level in search.lost]
        return sum(bool(tracer.distances(plane, one).min() > widest) for one in levels)
    ranges = [
        sorted(search.designs[kept[gap.after + side]].level[0] for side in (0, 1))
        for gap in wide(search, kept)
        if not gap.jump
    ]
    return sum(any(low < a[0] < high for low, high in ranges) for a in search.lost)


def _pairs(kept: tracer.Indices) -> Iterator[tuple[int, int]]:
    return zip(kept[:-1].tolist(), kept[1:].tolist(), strict=True)


def _among(search: FrontSearch, left: int, right: int) -> tracer.Indices:
    """Designs at levels between two given ones, in order."""
    levels = np.array([design.level[0] for design in search.designs])
    low, high = sorted((levels[left], levels[right]))
    order = np.argsort(levels, kind="stable")
    within = (levels[order] >= low) & (levels[order] <= high)
    return np.asarray(order[within], dtype=np.intp)


def _pieces(search: FrontSearch, left: int, right: int) -> Vector:
    """Upper limits of the front's length between neighbouring levels of a section."""
    among = _among(search, left, right)
    levels = np.array([search.designs[k].level[0] for k in among])
    return plane.lengths(levels, search.units[:, among])
