"""Film tables of a design: one per place with a film, load case and stroke.

Each table is a surrogate of solved films. Its axes are the inputs that the design variables change
most; other inputs enter to first order, by the exact slopes of the films. The tables are made once
per design and bounds of its variables, so a single evaluation and the optimiser use the same film.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import log, pi
from typing import Literal

import numpy as np

from ..base.errors import Diagnostic, Unsolvable
from ..base.numeric import Array
from ..base.surrogate import Axis, Interpolation, Surrogate, surrogate
from ..design.model import Design
from .film import FilmRow, Solved, ring_films, slopes as film_slopes, solve
from .rings import Place, Ring
from .values import Values, of_case

SAMPLES = 64
"""Samples within the bounds of the variables that define the box of the tables."""

POINTS = 6
"""Nodes of a surrogate along each axis."""

MOST_AXES = 2
"""Most axes of a surrogate: a further axis would need `POINTS` times as many films."""

SPEEDS, SPEED_ROOM = 3, 1.25
"""Nodes and relative range of the speed axis, which every surrogate has so that the slope by speed
depends on all other inputs. The middle node is the speed of the case."""

CHECKS = 4
"""Points of the box at which a surrogate is compared with solved films."""

MISSED = 0.005
"""Largest first-order error, over the load, at the ends of an input that is not an axis."""

Stroke = Literal["drive", "return"]
Key = tuple[Place, int, Stroke]
"""Place, load case and stroke of a table."""


@dataclass(frozen=True, slots=True)
class Running:
    """Film of a ring in motion per case, over the whole circumference.

    Parameters
    ----------
    viscous : viscous drag, positive against the motion [N]
    load : normal force between the asperities [N]
    thickness : mean film [m]
    viscous_slope, load_slope : derivatives of the first two by the speed [N s/m]
    flow : flow towards the outer side [m^3/s]
    between : absolute pressure between two rings [Pa]; NaN for a single ring
    """

    viscous: Array
    load: Array
    thickness: Array
    viscous_slope: Array
    load_slope: Array
    flow: Array
    between: Array


@dataclass(frozen=True, slots=True)
class Table:
    """Surrogate of a row's films in a case, and its error."""

    surrogate: Surrogate
    row: FilmRow
    errors: Mapping[str, float]
    """Largest relative differences of friction, flow and film thickness from films solved at the
    design and in the box (flow: over its largest value)."""

    flow: float = 0.0
    """Flow of the film at the design itself, per circumference [m^2/s]."""

    def running(self, rings: Sequence[Ring]) -> tuple[Running, ...]:
        """Films for the numbers of the rings, as arrays (designs,) or floats."""
        inputs = FilmRow(tuple(rings), self.row.outward).inputs()
        values = self.surrogate(inputs)
        slopes = self.surrogate(inputs, slope="speed") / inputs["speed"]
        films, by_speed = ring_films(values), ring_films(slopes)
        flow, between = values[-2], values[-1]
        found = []
        for i, ring in enumerate(rings):
            around = pi * ring["diameter"]
            found.append(
                Running(
                    viscous=around * films[i].drag,
                    load=around * films[i].load,
                    thickness=films[i].thickness,
                    viscous_slope=around * by_speed[i].drag,
                    load_slope=around * by_speed[i].load,
                    flow=around * flow,
                    between=between,
                )
            )
        return tuple(found)


class _Walker:
    """Films at a sequence of nearby points, each starting from the previous film."""

    def __init__(self, row: FilmRow) -> None:
        self.row = row
        self.last: Solved | None = None
        self.names: list[str] = []
        """Inputs with any effect on the films, known after the first point."""

    def solve(self, point: Mapping[str, Array]) -> Solved:
        found = solve(self.row.at(point), self.last)
        self.last = self.last if found.why else found
        return found

    def __call__(self, point: dict[str, float]) -> Interpolation:
        """Values of the films with their slopes."""
        found = self.solve(point)
        if found.why:
            return Interpolation(np.zeros(1), {}, why=found.why)
        by_input = film_slopes(found, self.names or list(point))
        self.names = [name for name, row in by_input.items() if np.nan_to_num(row).any()]
        return Interpolation(found.values, by_input)


def table(row: FilmRow, samples: Sequence[FilmRow]) -> Table:
    """Surrogate of a row over the box that other rows span.

    Raises
    ------
    Unsolvable
        no film solution at the row itself, or at too many points of the box
    """
    walker = _Walker(row)
    base = {name: float(value) for name, value in row.inputs().items() if value > 0}
    here = walker(base)
    if here.why:
        raise _unsolved(row, here.why)
    others = [sample.inputs() for sample in samples]
    axes = _axes(walker, base, others, here)
    found = surrogate(walker, base=base, axes=axes)
    if found is None:
        raise _unsolved(row, "too many points within the variable bounds have no solution")
    points = [base, *(point for point in others[:CHECKS] if base.keys() <= point.keys())]
    return Table(found, row, _errors(walker, found, points), float(here.values[-2]))


def _unsolved(row: FilmRow, why: str) -> Unsolvable:
    first = row.rings[0]
    message = f"the oil film of the {first.label} has no solution: {why}"
    remedy = 'write "friction: coefficient", or use a more usual squeeze, pressure or speed'
    path = f"{first.groove.path}friction"
    return Unsolvable(Diagnostic(message, remedy, path=path))


def _axes(
    walker: _Walker,
    base: Mapping[str, float],
    others: Sequence[Mapping[str, Array]],
    here: Interpolation,
) -> tuple[Axis, ...]:
    """The speed, and the inputs with the largest first-order errors."""
    spans = {
        name: (min(values), max(values))
        for name, value in base.items()
        if (values := [value, *(float(other[name]) for other in others if name in other)])
    }
    found = []
    for name, (lower, upper) in spans.items():
        if name == "speed" or lower <= 0 or upper <= lower * (1 + 1e-9):
            continue
        missed = max(_missed(walker, base, here, name, end) for end in (lower, upper))
        if missed > MISSED:
            found.append((missed, Axis(name, lower, upper, POINTS)))
    found.sort(key=lambda pair: -pair[0])
    lower, upper = spans["speed"]
    nodes = SPEEDS if upper <= lower * (1 + 1e-9) else POINTS
    speed = Axis("speed", lower / SPEED_ROOM, upper * SPEED_ROOM, nodes, hermite=True)
    return (speed, *(axis for _, axis in found[:MOST_AXES]))


def _missed(
    walker: _Walker, base: Mapping[str, float], here: Interpolation, name: str, end: float
) -> float:
    """First-order error of drag and load at the end of an input's range, over the load."""
    solved = walker.solve({**base, name: end})
    if solved.why:
        return 1.0
    told = here.values + here.slopes[name] * log(end / base[name])
    wrong, films = ring_films(np.abs(solved.values - told)), ring_films(solved.values)
    return max(
        float(max(miss.drag, miss.load) / film.load)
        for miss, film in zip(wrong, films, strict=True)
    )


def _errors(
    walker: _Walker, found: Surrogate, points: Sequence[Mapping[str, Array]]
) -> dict[str, float]:
    """Largest relative differences between surrogate and solved films."""
    rows = []
    for point in points:
        solved = walker.solve({name: float(point[name]) for name in found.base})
        if not solved.why:
            rows.append((solved, np.array(found({name: point[name] for name in found.base}))))
    flows = max((abs(solved.values[-2]) for solved, _ in rows), default=0.0) or 1.0
    errors = {"friction": 0.0, "flow": 0.0, "thickness": 0.0}
    for solved, estimate in rows:
        exact = solved.values
        ours, theirs = (sum(solved.row.frictions(values)) for values in (estimate, exact))
        films = np.abs(estimate[2:-2:3] / exact[2:-2:3] - 1)
        for name, error in (
            ("friction", abs(ours / theirs - 1)),
            ("flow", abs(estimate[-2] - exact[-2]) / flows),
            ("thickness", films.max()),
        ):
            errors[name] = max(errors[name], float(error))
    return errors


def films_asked(design: Design) -> bool:
    """Whether any element uses a film."""
    seals = design.seals
    return bool(seals.piston.friction_law.film or seals.rod.friction_law.film)


def _outward(place: Place, push: bool) -> dict[Stroke, bool]:
    """Strokes that need a film, and whether the counterface then moves outwards.

    The piston moves away from the driven chamber, which it seals: the bore moves inwards past its
    seal in both directions. The rod seal also needs the return stroke, which draws oil back.
    """
    return {"drive": False} if place == "piston" else {"drive": push, "return": not push}


def on_stroke(rings: Sequence[Ring], stroke: Stroke) -> tuple[Ring, ...]:
    """The rings on a stroke: the return stroke has its own pressure."""
    if stroke == "drive":
        return tuple(rings)
    return tuple(ring.at(pressure=ring["return_pressure"]) for ring in rings)


def of_place(rings: Sequence[Ring], place: Place) -> tuple[Ring, ...]:
    """Rings of a place with a film, from the sealed side outwards."""
    return tuple(r for r in rings if r.name == place and r.element.friction_law.film)


def floats(ring: Ring, case: int, sample: int = 0) -> Ring:
    """Numbers of a ring for one case and one design."""

    def one(value: Array) -> float:
        array = np.atleast_2d(np.asarray(value, dtype=float))
        row = array[min(case, array.shape[0] - 1)]
        return float(row[min(sample, row.size - 1)])

    return ring.at(**{name: one(value) for name, value in ring.numbers.items()})


def tables(
    design: Design, values: Callable[..., Values], rings_of: Callable[[Values], tuple[Ring, ...]]
) -> dict[Key, Table]:
    """All film tables of a design.

    Parameters
    ----------
    design : the design
    values : its numbers, some replaced by arrays (`PreparedDesign.values`)
    rings_of : function that returns its sealing rings for such numbers
    """
    here = rings_of(values())
    others: tuple[Ring, ...] = ()
    count = 0
    if design.variables:
        spread = _spread(design)
        spread = _with_corners(design, spread, rings_of(values(spread)))
        others = rings_of(values(spread))
        count = next(iter(spread.values())).size
    found: dict[Key, Table] = {}
    for key, row in _rows(design, here):
        place, case, stroke = key
        sampled = of_place(others, place)
        rows = [
            FilmRow(on_stroke([floats(r, case, k) for r in sampled], stroke), row.outward)
            for k in range(count)
        ]
        found[key] = _table(pickle.dumps((row, [r for r in rows if _finite(r)])))
    return found


@lru_cache(maxsize=64)
def _table(inputs: bytes) -> Table:
    """`table` of pickled inputs, cached: equal films of a report or comparison are solved once."""
    return table(*pickle.loads(inputs))


def unsolved(design: Design, rings: tuple[Ring, ...]) -> dict[Key, Table]:
    """Tables of all films of a design without solutions: they return NaN."""
    found = {}
    for key, row in _rows(design, rings):
        inputs = {name: float(value) for name, value in row.inputs().items()}
        nothing = np.full((3 * len(row.rings) + 2, 1 + len(inputs)), np.nan)
        found[key] = Table(Surrogate((), inputs, nothing, tuple(inputs)), row, {})
    return found


def _rows(design: Design, rings: tuple[Ring, ...]) -> Iterator[tuple[Key, FilmRow]]:
    """Rows of rings for all films of a design, by table."""
    places: tuple[Place, ...] = ("piston", "rod")
    for place in places:
        own = of_place(rings, place)
        for case, one in enumerate(design.load_cases):
            if not own or of_case(own[0]["speed"], case) == 0:
                continue
            for stroke, outward in _outward(place, one.direction == "push").items():
                row = FilmRow(on_stroke([floats(r, case) for r in own], stroke), outward)
                yield (place, case, stroke), row


def _finite(row: FilmRow) -> bool:
    return all(np.isfinite(list(ring.numbers.values())).all() for ring in row.rings)


def _spread(design: Design) -> dict[str, np.ndarray]:
    """Samples within the bounds of the variables: even in each, mixed with a fixed seed."""
    mixed = np.random.default_rng(0)
    return {
        path: np.linspace(bounds.lower, bounds.upper, SAMPLES)[mixed.permutation(SAMPLES)]
        for path, bounds in design.variables.items()
    }


def _with_corners(
    design: Design, spread: dict[str, np.ndarray], rings: Sequence[Ring]
) -> dict[str, np.ndarray]:
    """The samples, and the corners at which a number of a ring should be extreme.

    The corner follows from the signs of its correlation with every variable.
    """
    paths = list(spread)
    varied = np.array([spread[path] - np.mean(spread[path]) for path in paths])
    signs = set()
    for ring in rings:
        for value in ring.numbers.values():
            rows = np.atleast_2d(np.asarray(value, dtype=float))
            for row in rows[:, : SAMPLES if rows.shape[1] == SAMPLES else 0]:
                if row.size and np.isfinite(row).all() and np.ptp(row) > 0:
                    signs.add(tuple(np.where(varied @ (row - row.mean()) >= 0, 1, -1)))
    corners = sorted(signs | {tuple(-x for x in sign) for sign in signs})
    bounds = design.variables
    return {
        path: np.append(
            spread[path],
            [bounds[path].upper if sign[i] > 0 else bounds[path].lower for sign in corners],
        )
        for i, path in enumerate(paths)
    }


def running(
    tables: Mapping[Key, Table], rings: Sequence[Ring], stroke: Stroke, cases: int
) -> tuple[Running, ...]:
    """Films of a place's rings in every case, (cases, designs); 0 for a case at rest.

    Empty if no case has a film on this stroke.
    """
    own = rings and of_place(rings, rings[0].name)
    known = [tables.get((ring.name, case, stroke)) for ring in own[:1] for case in range(cases)]
    if not any(known):
        return ()
    by_case = [
        None if one is None else one.running(on_stroke([_row(r, case) for r in own], stroke))
        for case, one in enumerate(known)
    ]
    return tuple(
        _stacked([None if films is None else films[i] for films in by_case])
        for i in range(len(own))
    )


def _stacked(films: Sequence[Running | None]) -> Running:
    columns = [
        [np.zeros(1) if film is None else np.atleast_1d(getattr(film, name)) for film in films]
        for name in Running.__slots__
    ]
    return Running(*(np.stack(np.broadcast_arrays(*column)) for column in columns))


def _row(ring: Ring, case: int) -> Ring:
    """Numbers of a ring in one case, floats or (designs,)."""

    def row(value: Array) -> Array:
        array = np.asarray(value)
        return array[min(case, array.shape[0] - 1)] if array.ndim == 2 else array

    return ring.at(**{name: row(value) for name, value in ring.numbers.items()})
