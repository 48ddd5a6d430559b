"""Tables of the oil films under a design's seals, for every load case and stroke.

Each table is a surrogate model that interpolates between solved films. Its axes are the inputs with
the largest effect on the film within the bounds of the design variables. The effect of all other
inputs is linear, from the exact derivatives of the films. The tables are made once for a design and
the bounds of its variables. Therefore a single evaluation and the optimiser use the same film.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from math import log, pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, Unsolvable
from ..base.numeric import Array, array_of
from ..base.surrogate import Interpolation, Surrogate, SurrogateAxis, surrogate
from ..design.model import Design
from .film import FilmRow, Solved, Stroke, floats, of_place, on_stroke, ring_films, slopes, solve
from .rings import BLOCKS, Ring, RingPlace, SlidingPlace
from .values import Values, of_case

SAMPLES = 64
"""Number of samples of the variables, from which the range of the tables follows."""
POINTS = 6
"""Number of nodes of a surrogate along each axis."""
MOST_AXES = 2
"""Largest number of axes of a surrogate; each further axis needs `POINTS` times as many films."""
SPEEDS, SPEED_ROOM = 3, 1.25
"""Number of nodes of the speed axis if the speed is not varied, and factor by which this axis
extends beyond the smallest and largest speed. The middle node is the speed of the load case. Every
surrogate has this axis, so that the derivative by speed varies with all other inputs."""
CHECKS = 4
"""Number of samples at which a surrogate is compared with solved films. It is also compared at the
design itself."""
MISSED = 0.005
"""Error of linear extrapolation to the ends of an input's range, as a share of the normal force on
the asperities. Above this error, the input becomes a candidate for an axis of the table."""
Key = tuple[RingPlace, int, Stroke]
"""Location (piston or rod), load case and stroke of a table."""


@dataclass(frozen=True, slots=True)
class Running:
    """Film of a moving ring in every load case; forces and flow are for the whole circumference.

    Parameters
    ----------
    viscous : viscous drag, positive against the motion [N]
    load : normal force that the asperities carry [N]
    thickness : mean film [m]
    viscous_slope, load_slope : derivatives of `viscous` and `load` with respect to speed [N s/m]
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
class FilmTable:
    """Surrogate for the films of one ring, or two in series, in a load case; with its errors."""

    surrogate: Surrogate
    row: FilmRow
    errors: Mapping[str, float]
    """Largest relative errors of friction, flow and film thickness, by comparison with films solved
    for the design and for some samples. The error of the flow is relative to the largest flow."""

    flow: float = 0.0
    """Flow of the film in the design itself, per unit circumference [m^2/s]."""

    def running(self, rings: Sequence[Ring]) -> tuple[Running, ...]:
        """Interpolate the films for rings whose numbers are arrays (designs,) or floats."""
        inputs = FilmRow(tuple(rings), self.row.outward).inputs()
        values = self.surrogate(inputs)
        slopes = self.surrogate(inputs, slope="speed") / inputs["speed"]
        films, by_speed = ring_films(values), ring_films(slopes)
        flow, between = values[-2], values[-1]
        running_films = []
        for i, ring in enumerate(rings):
            around = pi * ring["diameter"]
            running_films.append(
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
        return tuple(running_films)


class _Walker:
    """Solves films at a sequence of nearby points; each previous film is the initial guess."""

    def __init__(self, row: FilmRow) -> None:
        self.row = row
        self.last: Solved | None = None
        self.names: list[str] = []
        """Inputs that affect the films; empty before the first point is solved."""

    def solve(self, point: Mapping[str, Array]) -> Solved:
        solved = solve(self.row.at(point), self.last)
        self.last = self.last if solved.why else solved
        return solved

    def __call__(self, point: dict[str, float]) -> Interpolation:
        """Values of the films at a point, with their derivatives."""
        solved = self.solve(point)
        if solved.why:
            return Interpolation(np.zeros(1), {}, why=solved.why)
        by_input = slopes(solved, self.names or list(point))
        self.names = [name for name, row in by_input.items() if np.nan_to_num(row).any()]
        return Interpolation(solved.values, by_input)


def table(row: FilmRow, samples: Sequence[FilmRow]) -> FilmTable:
    """Build the surrogate for a row of rings, for the range of inputs that the samples span.

    Raises
    ------
    Unsolvable
        no film solution for the row itself, or at too many points of the range
    """
    walker = _Walker(row)
    base = {name: float(value) for name, value in row.inputs().items() if value > 0}
    at_design = walker(base)
    if at_design.why:
        raise _unsolved(row, at_design.why)
    others = [sample.inputs() for sample in samples]
    axes = _axes(walker, base, others, at_design)
    film_surrogate = surrogate(walker, base=base, axes=axes)
    if film_surrogate is None:
        raise _unsolved(
            row,
            "the oil film has no solution at too many of the points computed "
            "within the variable bounds",
        )
    points = [base, *(point for point in others[:CHECKS] if base.keys() <= point.keys())]
    return FilmTable(
        film_surrogate, row, _errors(walker, film_surrogate, points), float(at_design.values[-2])
    )


def _unsolved(row: FilmRow, why: str) -> Unsolvable:
    first = row.rings[0]
    message = f"the oil film of the {first.label} has no solution: {why}"
    remedy = (
        'write "friction: coefficient", or bring squeeze, pressure or speed closer to common values'
    )
    path = f"{first.groove.path}friction"
    return Unsolvable(Diagnostic(message, remedy, path=path))


def _axes(
    walker: _Walker,
    base: Mapping[str, float],
    others: Sequence[Mapping[str, Array]],
    at_design: Interpolation,
) -> tuple[SurrogateAxis, ...]:
    """Choose a table's axes: speed, and the inputs whose linear extrapolation has most error."""
    spans = {
        name: (min(values), max(values))
        for name, value in base.items()
        if (values := [value, *(float(other[name]) for other in others if name in other)])
    }
    candidates = []
    for name, (lower, upper) in spans.items():
        if name == "speed" or lower <= 0 or upper <= lower * (1 + 1e-9):
            continue
        error = max(_missed(walker, base, at_design, name, end) for end in (lower, upper))
        if error > MISSED:
            candidates.append((error, SurrogateAxis(name, lower, upper, POINTS)))
    candidates.sort(key=lambda pair: -pair[0])
    lower, upper = spans["speed"]
    nodes = SPEEDS if upper <= lower * (1 + 1e-9) else POINTS
    speed = SurrogateAxis("speed", lower / SPEED_ROOM, upper * SPEED_ROOM, nodes, hermite=True)
    return (speed, *(axis for _, axis in candidates[:MOST_AXES]))


def _missed(
    walker: _Walker, base: Mapping[str, float], at_design: Interpolation, name: str, end: float
) -> float:
    """Error of linear extrapolation to one end of an input's range.

    It is the larger of the errors of viscous drag and asperity load, divided by the asperity load.
    """
    solved = walker.solve({**base, name: end})
    if solved.why:
        return 1.0
    predicted = at_design.values + at_design.slopes[name] * log(end / base[name])
    misses, films = ring_films(np.abs(solved.values - predicted)), ring_films(solved.values)
    return max(
        float(max(miss.drag, miss.load) / film.load)
        for miss, film in zip(misses, films, strict=True)
    )


def _errors(
    walker: _Walker, film_surrogate: Surrogate, points: Sequence[Mapping[str, Array]]
) -> dict[str, float]:
    """Largest relative differences between surrogate and solved films at these points."""
    rows = []
    for point in points:
        solved = walker.solve({name: float(point[name]) for name in film_surrogate.base})
        if not solved.why:
            rows.append(
                (
                    solved,
                    np.array(film_surrogate({name: point[name] for name in film_surrogate.base})),
                )
            )
    flows = max((abs(solved.values[-2]) for solved, _ in rows), default=0.0) or 1.0
    errors = {"friction": 0.0, "flow": 0.0, "thickness": 0.0}
    for solved, estimate in rows:
        exact = solved.values
        estimated_friction, exact_friction = (
            sum(solved.row.frictions(values)) for values in (estimate, exact)
        )
        films = np.abs(estimate[2:-2:3] / exact[2:-2:3] - 1)
        for name, error in (
            ("friction", abs(estimated_friction / exact_friction - 1)),
            ("flow", abs(estimate[-2] - exact[-2]) / flows),
            ("thickness", films.max()),
        ):
            errors[name] = max(errors[name], float(error))
    return errors


def _outward(place: SlidingPlace, push: bool) -> dict[Stroke, bool]:
    """For each stroke that needs a film, whether the counterface moves outwards.

    The piston always moves away from the pressurised chamber. Relative to the piston seal, the bore
    therefore always moves inwards, towards the sealed oil. The rod seal also needs a film for the
    return stroke, which draws oil back. A second rod moves outwards where the first moves inwards.
    """
    if place == "piston":
        return {"drive": False}
    outwards = push if place == "rod" else not push
    return {"drive": outwards, "return": not outwards}


def tables(
    design: Design, values: Callable[..., Values], rings_of: Callable[[Values], tuple[Ring, ...]]
) -> dict[Key, FilmTable]:
    """All film tables of a design.

    Parameters
    ----------
    design : the design
    values : function that returns the design's numbers, with some of them replaced by arrays
        (`PreparedDesign.values`)
    rings_of : function that returns the sealing rings for these numbers
    """
    rings = rings_of(values())
    sample_rings: tuple[Ring, ...] = ()
    count = 0
    if design.variables:
        spread = _spread(design)
        spread = _with_corners(design, spread, rings_of(values(spread)))
        sample_rings = rings_of(values(spread))
        count = next(iter(spread.values())).size
    film_tables: dict[Key, FilmTable] = {}
    for key, row in _rows(design, rings):
        place, case, stroke = key
        sampled = of_place(sample_rings, place)
        rows = [
            FilmRow(on_stroke([floats(r, case, k) for r in sampled], stroke), row.outward)
            for k in range(count)
        ]
        film_tables[key] = _table(pickle.dumps((row, [r for r in rows if _finite(r)])))
    return film_tables


@lru_cache(maxsize=64)
def _table(inputs: bytes) -> FilmTable:
    """Call `table` with pickled inputs and cache its result: equal films are solved only once."""
    return table(*pickle.loads(inputs))


def unsolved(design: Design, rings: tuple[Ring, ...]) -> dict[Key, FilmTable]:
    """Placeholders for all film tables of a design: no film is solved, and all results are NaN."""
    film_tables = {}
    for key, row in _rows(design, rings):
        inputs = {name: float(value) for name, value in row.inputs().items()}
        missing = np.full((3 * len(row.rings) + 2, 1 + len(inputs)), np.nan)
        film_tables[key] = FilmTable(Surrogate((), inputs, missing, tuple(inputs)), row, {})
    return film_tables


def _rows(design: Design, rings: tuple[Ring, ...]) -> Iterator[tuple[Key, FilmRow]]:
    """Yield the key of each film table of a design, and the row of rings it describes."""
    for place in BLOCKS:
        place_rings = of_place(rings, place)
        for case, load_case in enumerate(design.load_cases):
            if not place_rings or of_case(place_rings[0]["speed"], case) == 0:
                continue
            for stroke, outward in _outward(place, load_case.direction == "push").items():
                row = FilmRow(on_stroke([floats(r, case) for r in place_rings], stroke), outward)
                yield (place, case, stroke), row


def _finite(row: FilmRow) -> bool:
    return all(np.isfinite(list(ring.numbers.values())).all() for ring in row.rings)


def _spread(design: Design) -> dict[str, np.ndarray]:
    """Sample the variables: evenly spaced within the bounds of each, shuffled with a fixed seed."""
    mixed = np.random.default_rng(0)
    return {
        path: np.linspace(bounds.lower, bounds.upper, SAMPLES)[mixed.permutation(SAMPLES)]
        for path, bounds in design.variables.items()
    }


def _with_corners(
    design: Design, spread: dict[str, np.ndarray], rings: Sequence[Ring]
) -> dict[str, np.ndarray]:
    """Add corners of the design space to the samples.

    At a corner, every variable is at one of its bounds. Two corners are added for each input of a
    ring, at which the input should have its smallest and largest value. They follow from the signs
    of the input's correlations with the variables.
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
    tables: Mapping[Key, FilmTable], rings: Sequence[Ring], stroke: Stroke, cases: int
) -> tuple[Running, ...]:
    """Films of the rings of piston or rod in every load case, (cases, designs); 0 at rest.

    The result is empty if no load case has a film on this stroke.
    """
    film_rings = rings and of_place(rings, rings[0].name)
    case_tables = [
        tables.get((ring.name, case, stroke)) for ring in film_rings[:1] for case in range(cases)
    ]
    if not any(case_tables):
        return ()
    by_case = [
        None
        if film_table is None
        else film_table.running(on_stroke([_row(r, case) for r in film_rings], stroke))
        for case, film_table in enumerate(case_tables)
    ]
    return tuple(
        _stacked([None if films is None else films[i] for films in by_case])
        for i in range(len(film_rings))
    )


def _stacked(films: Sequence[Running | None]) -> Running:
    columns = [
        [np.zeros(1) if film is None else np.atleast_1d(getattr(film, name)) for film in films]
        for name in Running.__slots__
    ]
    return Running(*(np.stack(np.broadcast_arrays(*column)) for column in columns))


def _row(ring: Ring, case: int) -> Ring:
    """A ring with its inputs in one load case, as floats or arrays (designs,)."""

    def row(value: Array) -> Array:
        array = array_of(value)
        return array[min(case, array.shape[0] - 1)] if array.ndim == 2 else array

    return ring.at(**{name: row(value) for name, value in ring.numbers.items()})
