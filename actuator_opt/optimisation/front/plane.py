"""Chooses levels along the front, and selects designs that are evenly spread.

A level is a set of upper limits for the normalised objectives. Levels lie on the plane through the
anchors (the best design of each objective). With two objectives they lie on the line
u -> (u, 1 - u). Along a front one objective falls as the other rises, so the front's length between
two positions is at most twice their difference in u. With three or more objectives, levels are
lattice points on the plane sum = 1. Along a line through each lattice point, all
objectives improve by equal amounts. Only those points are used whose line meets the box between
ideal and nadir (best and worst values of the anchors).

A front may extend beyond its anchors. So the search tries the neighbours of every level that has a
design, until it reaches the edge of the front. There it improves the objectives that can still
improve. Then it fills wide holes and explains the gaps that remain.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import permutations, product

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from ...base.progress import tell
from ..problem import Vector
from ..resolve.steps import RESIDUAL
from .tracer import (
    BETTER,
    HELD,
    JUMP,
    FrontDesign,
    FrontSearch,
    FrontStart,
    Indices,
    distances,
    nearest,
    thinned,
)

STEEPEST = 2.0
"""With two objectives, the greatest length of a continuous front per unit of u."""


def on_line(places: Vector) -> Vector:
    """Levels (upper limits of both objectives) at positions u (k,) between the anchors: (2, k)."""
    return np.stack([places, 1.0 - places])


def lengths(places: Vector, units: Vector) -> Vector:
    """Upper limit (k - 1,) on the length of the front between neighbouring designs.

    Across a jump, only the length that a continuous front may have there counts.

    Parameters
    ----------
    places : positions u (k,), ascending
    units : normalised objectives (2, k) at these positions
    """
    chords = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    return np.asarray(np.minimum(chords, STEEPEST * np.diff(places)))


def between(places: Vector, units: Vector, count: int) -> Vector:
    """`count` new positions u, each in the longest remaining piece of the front."""
    sections = lengths(places, units)
    parts_of = np.ones(len(sections), dtype=int)
    for _ in range(count):
        longest = int(np.argmax(sections / parts_of))
        if not sections[longest] > 0:
            break
        parts_of[longest] += 1
    new_places = [
        places[k] + (places[k + 1] - places[k]) * np.arange(1, n) / n
        for k, n in enumerate(parts_of)
    ]
    return np.concatenate(new_places) if new_places else np.empty(0)


def places(objectives: int, steps: int) -> list[tuple[int, ...]]:
    """Lattice points (as steps from the middle) whose lines of equal improvement meet the unit box.

    >>> len(places(3, 1)), len(places(3, 2))
    (1, 7)
    """
    axis = range(-steps, steps + 1)
    return [
        (*head, last)
        for head in product(axis, repeat=objectives - 1)
        if (last := -sum(head)) in axis and max(*head, last) - min(*head, last) <= steps
    ]


def around(place: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The lattice points next to a lattice point.

    >>> around((0, 0))
    [(-1, 1), (1, -1)]
    """
    neighbours = []
    for up, down in permutations(range(len(place)), 2):
        neighbour = list(place)
        neighbour[up] += 1
        neighbour[down] -= 1
        neighbours.append(tuple(neighbour))
    return sorted(neighbours)


def level(place: Sequence[int], steps: int) -> Vector:
    """Levels, that is upper limits of the objectives (objectives,), at a lattice point."""
    return 1.0 / len(place) + np.array(place, dtype=float) / steps


Place = tuple[int, ...]
"""A lattice point: steps from the middle, one whole number per objective, with sum 0."""

SURPLUS = 2.0
"""Number of designs computed per requested design; those farthest apart are selected."""

COARSE = 4
"""In the first lattice, the number of steps from the middle to the best design of an objective."""

RESERVE = 12
"""Maximum number of levels tried on a lattice, per requested design."""

GROWN = 0.05
"""If an objective's range changes by this relative amount, the objectives are normalised again."""

RESCALES = 3
"""Maximum number of times that the objectives are normalised again."""

PRICED = 1e-6
"""The level (upper limit) of an objective counts as active if its price (multiplier; all prices sum
to 1) exceeds this."""

HOLD = 1e-9
"""Normalised amount by which a bounded objective may worsen while others improve."""

ROUNDS = 12
"""Maximum number of rounds that fill holes."""

ELSEWHERE = 1e-3
"""Two designs for the same limits on the objectives differ if a variable differs by more than this.
"""

CLOSE = 2.0
"""A design from another valley (another local optimum) is retried if it is worse by at most this
multiple of the distance between neighbours."""

CROSSINGS = 4
"""Maximum number of rounds that retry designs from another valley (another local optimum)."""

NEIGHBOURS = 14
"""The search for holes looks between each design and this many of its neighbours."""


def fill_plane(search: FrontSearch, count: int) -> None:
    """Cover a front of three or more objectives with more designs than are requested."""
    objectives, max_levels = search.tracer.objectives.count, RESERVE * count + 60
    if len(search.designs) == objectives:
        steps = COARSE if objectives == 3 else COARSE // 2
        lattice = places(objectives, steps)
        for _ in range(1 + RESCALES):
            _flood(search, lattice, steps, max_levels)
            if not _renormalised(search):
                break
            lattice = _nearest_places(search, steps)
        while len(places(objectives, steps + 1)) <= SURPLUS * count:
            steps += 1
        successes = _flood(search, places(objectives, steps), steps, max_levels)
        missing = SURPLUS * count / max(successes, 1)
        if len(search.front_indices()) < count:
            finer = round(steps * missing ** (1 / (objectives - 1)))
            _flood(search, _nearest_places(search, finer), finer, max_levels)
    _fill_holes(search, count)
    for _ in range(CROSSINGS):
        if not _retry_crosswise(search):
            break


def _nearest_places(search: FrontSearch, steps: int) -> list[Place]:
    """Lattice points that are nearest to the known designs."""
    nearest: set[Place] = set()
    for design in search.designs:
        exact = (design.unit - design.unit.mean()) * steps
        place = np.rint(exact).astype(int)
        place[int(np.argmax(np.abs(exact - place)))] -= place.sum()
        nearest.add(tuple(place.tolist()))
    return sorted(nearest)


def _flood(search: FrontSearch, first_places: Iterable[Place], steps: int, max_levels: int) -> int:
    """Try lattice points, then the neighbours of every point whose level a design reaches.

    Returns the number of lattice points whose level was reached.
    """
    visited: set[Place] = set()
    queue, successes = list(first_places), 0
    while queue and len(visited) < max_levels:
        tell("covering the front", min(len(visited) / max_levels, 1.0))
        visited |= set(queue)
        starts = [_start_beside(search, level(place, steps)) for place in queue]
        designs = search.improved_designs(starts)
        pairs = zip(queue, designs, strict=True)
        reached_places = [p for p, design in pairs if design is not None and design.at_level]
        successes += len(reached_places)
        search.add(_fully_improved(search, designs))
        neighbours = {neighbour for place in reached_places for neighbour in around(place)}
        queue = sorted(neighbours - visited)
    return successes


def _start_beside(search: FrontSearch, level: Vector) -> FrontStart:
    """A start interpolated from the designs nearest to a level; nearer designs weigh more."""
    distance = distances(search.plane, level - level.mean())
    nearest = np.argsort(distance, kind="stable")[: len(level)]
    shares = 1 / np.maximum(distance[nearest], 1e-9) ** 2
    designs = [search.designs[k] for k in nearest]
    z = np.stack([design.point.z for design in designs], axis=1) @ (shares / shares.sum())
    t = max(float((design.unit - level).max()) for design in designs)
    return FrontStart(level, np.ones(len(level)), search.tracer.to_t(z, t), designs[0].hessian)


def _fully_improved(
    search: FrontSearch, designs: Sequence[FrontDesign | None]
) -> list[FrontDesign]:
    """Improve those objectives of each design that can improve without a loss in the others.

    An objective whose level is not active has no price (multiplier). It is improved while the
    others may not worsen, until every objective has a price [Marler2004].
    """
    finished: list[FrontDesign] = []
    prices = search.tracer.prices
    pending = [(design, prices(design) > PRICED) for design in designs if design is not None]
    for stage in range(search.tracer.objectives.count):
        finished += [design for design, active in pending if active.all()]
        pending = [(design, active) for design, active in pending if not active.all()]
        if not pending:
            break
        starts = [_improving_start(search, design, active) for design, active in pending]
        improved = search.tracer.solve(starts, [design for design, _ in pending])
        outcomes = list(zip(improved, pending, strict=True))
        if stage:  # cannot improve further: keep the design of the last stage
            finished += [design for new, (design, _) in outcomes if new is None]
        pending = [
            (new, active | (prices(new) > PRICED))
            for new, (_, active) in outcomes
            if new is not None
        ]
    return search.tracer.at_own_levels(finished)


def _improving_start(
    search: FrontSearch, front_design: FrontDesign, active: npt.NDArray[np.bool_]
) -> FrontStart:
    """A start to improve objectives with inactive levels while the others may not worsen."""
    level = np.where(active, front_design.unit + HOLD, front_design.level)
    direction = (~active).astype(float)
    t = float((front_design.unit - front_design.level)[~active].max())
    z = search.tracer.to_t(front_design.point.z, t)
    return FrontStart(level, direction, z, front_design.hessian)


def _renormalised(search: FrontSearch) -> bool:
    """Normalise again if the range of the front has changed; return whether it has."""
    units = search.units[:, search.front_indices()]
    low, width = units.min(axis=1), np.ptp(units, axis=1)
    if (np.abs(low) < GROWN).all() and (np.abs(width - 1) < GROWN).all():
        return False
    search.rescale(low, np.where(width > HELD, width, 1.0))
    return True


def _fill_holes(search: FrontSearch, count: int) -> None:
    """Add levels between the most distant neighbours, until there are enough designs."""
    tried_pairs: set[tuple[int, int]] = set()
    references: list[FrontDesign] = []  # keeps the designs alive, so that ids stay unique
    for number in range(ROUNDS):
        indices = search.front_indices()
        missing = int(np.ceil(SURPLUS * count)) - len(indices)
        if missing <= 0:
            return
        tell("filling gaps in the front", number / ROUNDS)
        designs = [search.designs[k] for k in indices]
        references += designs
        pairs = _neighbour_pairs(search, indices)
        pairs = [pair for pair in pairs if _key(designs, pair) not in tried_pairs]
        pairs = pairs[: max(min(missing, len(indices) // 3), 1)]
        if not pairs:
            return
        tried_pairs |= {_key(designs, pair) for pair in pairs}
        starts = [_middle_start(search, designs[i], designs[j]) for i, j in pairs]
        search.add(_fully_improved(search, search.improved_designs(starts)))


def _key(designs: Sequence[FrontDesign], pair: tuple[int, int]) -> tuple[int, int]:
    return id(designs[pair[0]]), id(designs[pair[1]])


def _neighbour_pairs(search: FrontSearch, indices: Indices) -> list[tuple[int, int]]:
    """Pairs of neighbours that have no design between them, the most distant pair first."""
    units, projected = search.units[:, indices], search.plane[:, indices]
    gaps: dict[tuple[int, int], float] = {}
    for i in range(len(indices)):
        order = np.argsort(distances(projected, projected[:, i]), kind="stable")
        candidates = order[1 : 1 + NEIGHBOURS]
        for j in candidates.tolist():
            middle = (projected[:, i] + projected[:, j]) / 2
            radius = distances(projected[:, [i]], middle)[0] * (1 - 1e-9)
            others = candidates[candidates != j]
            if not (distances(projected[:, others], middle) < radius).any():
                gaps[min(i, j), max(i, j)] = float(distances(units[:, [i]], units[:, j])[0])
    return sorted(gaps, key=lambda pair: -gaps[pair])


def _middle_start(search: FrontSearch, front_design: FrontDesign, other: FrontDesign) -> FrontStart:
    """A start at the level halfway between two designs."""
    level = (front_design.unit + other.unit) / 2
    level = level - level.mean() + 1 / len(level)
    z = (front_design.point.z + other.point.z) / 2
    t = float((front_design.unit + other.unit).mean() / 2 - 1 / len(level))
    return FrontStart(level, np.ones(len(level)), search.tracer.to_t(z, t), front_design.hessian)


def _retry_crosswise(search: FrontSearch) -> bool:
    """Retry designs, starting from nearly equal designs with different variables.

    Returns whether any retried design was only locally best.
    """
    indices = search.front_indices()
    pairs = [(int(indices[i]), int(indices[j])) for i, j in _competitors(search, indices)]
    starts = []
    for target, source in pairs:
        design, other = search.designs[target], search.designs[source]
        t = float((other.unit - design.unit).max())
        z = search.tracer.to_t(other.point.z, t)
        starts.append(FrontStart(design.level, design.direction, z, other.hessian))
    alternatives = [
        alternative
        for (target, _), alternative in zip(pairs, search.tracer.solve(starts), strict=True)
        if alternative is not None and _is_alternative(search.designs[target], alternative)
    ]
    previous = {id(search.designs[k]) for k in indices}
    search.add(_fully_improved(search, alternatives))
    remaining = {id(search.designs[k]) for k in search.front_indices()}
    return bool(alternatives) and not previous <= remaining


def _is_alternative(front_design: FrontDesign, alternative: FrontDesign) -> bool:
    """Whether a design at the same level is as good, but different."""
    differs = np.abs(alternative.point.z[:-1] - front_design.point.z[:-1]).max() > ELSEWHERE
    return bool(differs and alternative.point.objective < front_design.point.objective + BETTER)


def _competitors(search: FrontSearch, indices: Indices) -> list[tuple[int, int]]:
    """Pairs of designs: a design, and the nearest rival from another valley (local optimum)."""
    units = search.units[:, indices]
    z = np.stack([search.designs[k].point.z[:-1] for k in indices], axis=1)
    neighbours = np.array(_neighbour_pairs(search, indices), dtype=np.intp).reshape(-1, 2)
    if not len(neighbours):
        return []
    jump = JUMP * np.median(np.abs(z[:, neighbours[:, 0]] - z[:, neighbours[:, 1]]).max(axis=0))
    tolerance = CLOSE * np.median(nearest(units))
    pairs = []
    for i in range(len(indices)):
        behind = (units - units[:, [i]]).max(axis=0)
        behind[np.abs(z - z[:, [i]]).max(axis=0) <= jump] = np.inf
        if behind.min() <= tolerance:
            pairs.append((i, int(np.argmin(behind))))
    return pairs


GROWTH = 10
"""Maximum number of new designs per round, as a multiple of the number of known designs."""
MOST_ROUNDS = 12
"""Maximum number of rounds; a continuous front takes two or three."""


def fill_line(search: FrontSearch, count: int) -> None:
    """Add designs between the two anchors, always in the longest gap between neighbours."""
    for number in range(MOST_ROUNDS):
        missing = count - len(search.front_indices())
        if missing <= 0:
            break
        tell("following the front", 1 - missing / count)
        search.sort()
        places = np.array([design.level[0] for design in search.designs])
        new_places = between(places, search.units, min(missing, GROWTH * (len(places) - 1) - 1))
        if not len(new_places):
            break
        search.solve(between_on_line(search, new_places), firmly=number > 0)
    search.retry_jumps()


def between_on_line(search: FrontSearch, places: Sequence[float] | Vector) -> list[FrontStart]:
    """Starts at positions u between the known designs, interpolated from their neighbours."""
    search.sort()
    levels = [design.level[0] for design in search.designs]
    return [
        _start_between(search.designs, int(np.searchsorted(levels, u)), float(u), np.ones(2))
        for u in places
    ]


def _start_between(
    designs: Sequence[FrontDesign], k: int, u: float, direction: Vector
) -> FrontStart:
    """A start between designs k - 1 and k: interpolated, or at a jump the nearer design."""
    left, right = designs[k - 1], designs[k]
    low, high = left.level[0], right.level[0]
    nearer = left if u - low < high - u else right
    z = nearer.point.z
    if not _jumps(left, right):
        support = [left, right]
        if k > 1 and not _jumps(designs[k - 2], left):
            support.insert(0, designs[k - 2])
        if k + 1 < len(designs) and not _jumps(right, designs[k + 1]):
            support.append(designs[k + 1])
        places = np.array([design.level[0] for design in support])
        z = np.stack([design.point.z for design in support], axis=1) @ _weights(places, u)
    return FrontStart(on_line(np.array([u]))[:, 0], direction, z, nearer.hessian)


def _jumps(left: FrontDesign, right: FrontDesign) -> bool:
    """Whether two designs are farther apart than they can be on a continuous front."""
    width = right.level[0] - left.level[0]
    return bool(np.linalg.norm(right.unit - left.unit) >= STEEPEST * width)


def _weights(places: Vector, u: float) -> Vector:
    """Weights of the values at positions (k,) for polynomial interpolation at u."""
    differences = places[:, None] - places + np.eye(len(places))
    offsets = u - places + np.zeros((len(places), 1))
    np.fill_diagonal(offsets, 1.0)
    correction = np.eye(len(places)) * (1 / np.diag(differences) - 1)
    return np.asarray((offsets / differences - correction).prod(axis=1))


WIDEST = 3.0
"""A gap is wide if it exceeds this multiple of the median gap between neighbours."""


SPACING_ROUNDS = 6
"""Maximum number of rounds that add designs in wide gaps."""


PIECES = 8
"""Maximum number of pieces into which a gap is split at once."""


@dataclass(frozen=True)
class FrontGap:
    """A wide gap between neighbours on a front, measured in normalised objectives.

    Parameters
    ----------
    after : index of the design before the gap
    size : distance between the two designs
    reach : greatest length that a continuous front could have in the gap, given the designs found
        for the levels tried there
    jump : whether `reach` is at most the median gap, which means that the front jumps here
    """

    after: int
    size: float
    reach: float
    jump: bool


def final_designs(search: FrontSearch, count: int) -> Indices:
    """`count` designs that are as far apart as possible, in order of the first objective."""
    optimal = [k for k in search.front_indices() if search.residual(k) <= RESIDUAL]
    indices = np.array(optimal, dtype=np.intp)
    units = search.units[:, indices]
    order = np.lexsort(units[::-1])
    indices, units = indices[order], units[:, order]
    if len(indices) <= count:
        return indices
    fixed_list = [*np.argmin(units, axis=1).tolist(), *np.argmax(units, axis=1).tolist()]
    if len(units) == 2:
        jumps = [gap.after for gap in wide_gaps(search, indices) if gap.jump]
        fixed_list += [k + side for k in jumps for side in (0, 1)]
    fixed = np.array(list(dict.fromkeys(fixed_list))[:count], dtype=np.intp)
    return indices[thinned(units, fixed, count)]


def wide_gaps(search: FrontSearch, indices: Indices) -> list[FrontGap]:
    """Wide gaps along a front of two objectives, in order."""
    units = search.units[:, indices]
    sizes = np.sqrt((np.diff(units, axis=1) ** 2).sum(axis=0))
    reaches = np.array([float(_section_lengths(search, *pair).sum()) for pair in _pairs(indices)])
    middle = float(np.median(np.minimum(sizes, reaches))) if len(sizes) else 0.0
    return [
        FrontGap(k, float(sizes[k]), float(reaches[k]), bool(reaches[k] <= middle))
        for k in np.flatnonzero(sizes > WIDEST * middle).tolist()
    ]


def close_gaps(search: FrontSearch, count: int) -> None:
    """Add designs in wide gaps (two objectives only), until all remaining wide gaps are jumps."""
    for number in range(SPACING_ROUNDS):
        indices = final_designs(search, count)
        open_gaps = [gap for gap in wide_gaps(search, indices) if not gap.jump]
        if not open_gaps:
            return
        tell("closing gaps of the front", number / SPACING_ROUNDS)
        places = []
        for gap in open_gaps:
            section = _section(search, indices[gap.after], indices[gap.after + 1])
            levels = np.array([search.designs[k].level[0] for k in section])
            new_places = between(levels, search.units[:, section], PIECES - 1)
            places += new_places.tolist()
        if not search.solve(between_on_line(search, places)):
            return


def middle_designs(search: FrontSearch, count: int) -> list[int]:
    """For each wide gap, the index of the design nearest to its middle level; widest gap first."""
    indices, result = final_designs(search, count), []
    for gap in sorted(wide_gaps(search, indices), key=lambda g: -g.size):
        section = _section(search, indices[gap.after], indices[gap.after + 1])
        levels = [search.designs[k].level[0] for k in section]
        middle = (levels[0] + levels[-1]) / 2
        result.append(int(section[int(np.argmin(np.abs(np.subtract(levels, middle))))]))
    return result


def lost_levels(search: FrontSearch, indices: Indices) -> int:
    """Number of levels (upper limits of the objectives) without a design nearby.

    With two objectives, only levels in wide gaps count, and only if the front does not jump there.
    """
    units = search.units[:, indices]
    if len(units) > 2:
        widest = nearest(units).max(initial=0.0)
        projected = search.plane[:, indices]
        levels = [level - level.mean() for level in search.empty_levels]
        return sum(bool(distances(projected, x).min() > widest) for x in levels)
    ranges = [
        sorted(search.designs[indices[gap.after + side]].level[0] for side in (0, 1))
        for gap in wide_gaps(search, indices)
        if not gap.jump
    ]
    return sum(any(low < a[0] < high for low, high in ranges) for a in search.empty_levels)


def _pairs(indices: Indices) -> Iterator[tuple[int, int]]:
    return zip(indices[:-1].tolist(), indices[1:].tolist(), strict=True)


def _section(search: FrontSearch, left: int, right: int) -> Indices:
    """Indices, in order, of the designs whose levels lie between the levels of two designs."""
    levels = np.array([design.level[0] for design in search.designs])
    low, high = sorted((levels[left], levels[right]))
    order = np.argsort(levels, kind="stable")
    inside = (levels[order] >= low) & (levels[order] <= high)
    return np.asarray(order[inside], dtype=np.intp)


def _section_lengths(search: FrontSearch, left: int, right: int) -> Vector:
    """Greatest possible lengths of the front between neighbouring designs of a `_section`."""
    section = _section(search, left, right)
    levels = np.array([search.designs[k].level[0] for k in section])
    return lengths(levels, search.units[:, section])
