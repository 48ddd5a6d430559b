"""The oil film under a moving seal, or two in a row: solution at an operating point.

Two elements with a film share the oil: at the pressure between them both have the same flow
([Huang2017] eq. 17).

Film tables of a design: one per place with a film, load case and stroke.

Each table is a surrogate of solved films. Its axes are the inputs that the design variables change
most; other inputs enter to first order, by the exact slopes of the films. The tables are made once
per design and bounds of its variables, so a single evaluation and the optimiser use the same film.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import log, nan, pi
from typing import Literal, NamedTuple

import numpy as np

from ..base.errors import Diagnostic, Unsolvable
from ..base.numeric import STEP, Array, maximum
from ..base.surrogate import Interpolation, Surrogate, SurrogateAxis, surrogate
from ..design.model import Design
from ..lubrication import (
    Contact,
    Elastic,
    Film,
    Lubricant,
    Surface,
    Tandem,
    TandemSeal,
    sensitivities,
    solve_film,
    solve_tandem,
)
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..models.rough_surface import composite_roughness
from .rings import Place, Ring, seal_contact, static_profile
from .values import Values, of_case

NODES = 121
"""Nodes along the contact: within 0.3 % of a finer mesh."""

HIGHEST, AT_LEAST = 1.5, 10e6
"""Largest interseal pressure tried, over the sealed pressure, or absolute [Pa]: at
low pressure the outer seal can hold many times the sealed pressure."""

LEAST_SQUEEZE = 0.02
"""Least squeeze in film solutions: below it the contact is lost, and the squeeze metric fails."""

_NOT_OF_FILM = frozenset(
    {
        "asperity_friction",
        "breakaway_ratio",
        "count",
        "friction_coefficient",
        "hardness",
        "outer_pressure",
        "pressure",
        "return_pressure",
        "section_tolerance",
        "speed",
        "squeeze",
        "stretch",
        "stribeck_speed",
        "tolerance",
        "viscosity",
        "viscosity_coefficient",
        "viscous_friction",
    }
)
"""Numbers of a ring without effect on its film, or stated once per row for both rings."""

SHARED = ("speed", "viscosity", "viscosity_coefficient")
"""Inputs common to both rings of a pair, besides the pressures."""


@dataclass(frozen=True, slots=True)
class FilmRow:
    """One or two rings of floats that share the oil, from the sealed side outwards.

    `outward`: the counterface moves to the outer side.
    """

    rings: tuple[Ring, ...]
    outward: bool

    def inputs(self) -> dict[str, Array]:
        """Inputs of the films, with absolute pressures and limited squeeze."""
        first, last = self.rings[0], self.rings[-1]
        outer = last["outer_pressure"] + ATMOSPHERIC_PRESSURE
        found = {
            "speed": first["speed"],
            "viscosity": first["viscosity"],
            "viscosity_coefficient": first["viscosity_coefficient"],
            "sealed": outer + first["pressure"],
            "outer": outer,
        }
        for i, ring in enumerate(self.rings):
            found |= {f"{i}.{n}": x for n, x in ring.numbers.items() if n not in _NOT_OF_FILM}
            found[f"{i}.squeeze_left"] = maximum(ring["squeeze_left"], LEAST_SQUEEZE)
        return found

    def at(self, point: Mapping[str, Array]) -> FilmRow:
        """The row at a point of `inputs`; both rings then have the full pressure difference."""
        shared = {name: point[name] for name in SHARED if name in point}
        shared["outer_pressure"] = point["outer"] - ATMOSPHERIC_PRESSURE
        shared["pressure"] = point["sealed"] - point["outer"]
        own = [
            {name.partition(".")[2]: x for name, x in point.items() if name.startswith(f"{i}.")}
            for i in range(len(self.rings))
        ]
        return FilmRow(
            tuple(ring.at(**shared, **x) for ring, x in zip(self.rings, own, strict=True)),
            self.outward,
        )

    def between(self, pressure: Array) -> tuple[Ring, ...]:
        """The rings with their shares of the pressure, for an absolute interseal pressure."""
        if len(self.rings) == 1:
            return self.rings
        first, second = self.rings
        inner = pressure - ATMOSPHERIC_PRESSURE
        sealed = first["pressure"] + first["outer_pressure"]
        return (
            first.at(pressure=sealed - inner, outer_pressure=inner),
            second.at(pressure=inner - second["outer_pressure"]),
        )

    def frictions(self, values: Array) -> tuple[Array, ...]:
        """Friction of every ring, N, from the values of their films."""
        return tuple(
            np.pi * ring["diameter"] * (film.drag + ring["asperity_friction"] * film.load)
            for ring, film in zip(self.rings, ring_films(values), strict=True)
        )

    def contacts(self, between: Array) -> tuple[Contact, ...]:
        """Film-solver inputs of every ring, for an absolute interseal pressure."""
        return tuple(contact(ring, outward=self.outward) for ring in self.between(between))


def contact(ring: Ring, *, outward: bool, nodes: int = NODES) -> Contact:
    """Film-solver input of a ring; any number may carry a complex step."""
    outer = ring["outer_pressure"] + ATMOSPHERIC_PRESSURE
    width, static = static_profile(ring, nodes)
    return Contact(
        width=width,
        static_pressure=static + ATMOSPHERIC_PRESSURE,
        elastic=_elastic(ring),
        surface=_surface(ring),
        lubricant=_lubricant(ring),
        speed=ring["speed"] if outward else -ring["speed"],
        sealed_pressure=outer + ring["pressure"],
        outer_pressure=outer,
    )


def _elastic(ring: Ring) -> Elastic:
    return Elastic(ring["face_modulus"], ring["face_poissons_ratio"])


def _surface(ring: Ring) -> Surface:
    own, other = ring["seal_roughness"], ring["counterface_roughness"]
    roughness = composite_roughness(first=own, second=other)
    return Surface(
        roughness=roughness,
        asperity_density=ring["asperity_density"],
        asperity_radius=ring["asperity_radius"],
        rod_share=(other / roughness) ** 2,
    )


def _lubricant(ring: Ring) -> Lubricant:
    return Lubricant(
        dynamic_viscosity=ring["viscosity"],
        pressure_law=ring.viscosity_law,
        pressure_coefficient=ring["viscosity_coefficient"],
    )


class RingFilm(NamedTuple):
    """Film results of a ring, per circumference; arrays if the inputs are arrays."""

    drag: Array
    """Viscous drag, positive against the motion [N/m]."""
    load: Array
    """Normal force between the asperities [N/m]."""
    thickness: Array
    """Mean film thickness [m]."""


def ring_films(values: Array) -> tuple[RingFilm, ...]:
    """Parts of `Solved.values` by ring; flow and interseal pressure follow them."""
    return tuple(RingFilm(*values[i : i + 3]) for i in range(0, len(values) - 2, 3))


@dataclass(frozen=True, slots=True)
class Solved:
    """The films of a row, or the reason for a failure.

    Parameters
    ----------
    row : row as solved
    films : one film per ring; empty after a failure
    why : reason for a failure
    pair : for two rings, the interseal pressure and the flow mismatch
    """

    row: FilmRow
    films: tuple[Film, ...]
    why: str = ""
    pair: Tandem | None = None

    @property
    def between(self) -> float:
        """Absolute interseal pressure [Pa]; NaN for a single ring."""
        return nan if self.pair is None else self.pair.pressure

    @property
    def values(self) -> np.ndarray:
        """Drag, load [N/m] and mean film [m] of every ring; flow, interseal pressure."""
        sign = 1.0 if self.row.outward else -1.0
        parts = [[sign * f.viscous_drag, f.contact_load, f.mean_film] for f in self.films]
        return np.array([*np.ravel(parts), self.films[0].flow, self.between])

    def friction(self) -> float:
        """Friction of all rings, N."""
        return float(sum(self.row.frictions(self.values)))


def solve(row: FilmRow, last: Solved | None = None) -> Solved:
    """Films of a row, starting from the films of a nearby row."""
    if len(row.rings) == 1:
        if opened := _opened(row.rings[0]):
            return Solved(row, (), opened)
        (one,) = row.contacts(nan)
        film = solve_film(one, last.films[0] if last is not None else None)
        return Solved(row, (film,) if film.converged else (), film.reason)
    found = _tandem(row, last.pair if last is not None else None)
    if not found.converged or found.inner is None or found.outer is None:
        return Solved(row, (), found.reason)
    opened = next(filter(None, map(_opened, row.between(found.pressure))), "")
    films = () if opened else (found.inner, found.outer)
    return Solved(row, films, opened, found)


def _opened(ring: Ring) -> str:
    """Why the sealed pressure opens the contact of a ring; empty if it does not."""
    pressure = ring["pressure"]
    if seal_contact(ring.at(pressure=abs(pressure))).excess > 0:
        return ""
    return (
        f"{pressure / 1e6:.4g} MPa opens the contact of the {ring.label}: its contact load "
        "is too small"
    )


def _tandem(row: FilmRow, start: Tandem | None) -> Tandem:
    first, second = row.rings

    def element(ring: Ring) -> TandemSeal:
        def static(sealed: float, outer: float) -> tuple[float, np.ndarray]:
            own = ring.at(pressure=sealed - outer, outer_pressure=outer - ATMOSPHERIC_PRESSURE)
            width, pressure = static_profile(own, NODES)
            return width, pressure + ATMOSPHERIC_PRESSURE

        return TandemSeal(static, _elastic(ring), _surface(ring))

    outer_pressure = second["outer_pressure"] + ATMOSPHERIC_PRESSURE
    return solve_tandem(
        inner=element(first),
        outer=element(second),
        lubricant=_lubricant(first),
        speed=first["speed"] if row.outward else -first["speed"],
        sealed_pressure=outer_pressure + first["pressure"],
        outer_pressure=outer_pressure,
        highest=max(HIGHEST, AT_LEAST / (outer_pressure + first["pressure"])),
        start=start,
    )


def slopes(solved: Solved, names: Sequence[str]) -> dict[str, np.ndarray]:
    """Derivatives of `Solved.values` by the logarithm of inputs, exact."""
    row = solved.row
    point = row.inputs()
    stepped = [
        row.at({**point, name: point[name] * (1 + 1j * STEP)}).contacts(solved.between)
        for name in names
    ]
    if len(row.rings) == 2:
        stepped.append(row.at(point).contacts(solved.between * (1 + 1j * STEP)))
    by_film = [
        sensitivities(film, [_as_starved(step[i], film.contact) for step in stepped])
        for i, film in enumerate(solved.films)
    ]
    moved = np.zeros(len(names))
    if solved.pair is not None and solved.pair.cavitation == 0:
        # flows stay equal: d between = -(d surplus)/(d surplus/d between), per ln between
        surplus = by_film[0][:, 2] - by_film[1][:, 2]
        moved = -surplus[:-1] / surplus[-1]
        by_film = [rows[:-1] + np.outer(moved, rows[-1]) for rows in by_film]
    # a starved space stays at the cavitation pressure, so its derivative is zero
    sign = 1.0 if row.outward else -1.0
    found = {}
    for k, name in enumerate(names):
        parts = [[sign * rows[k, 0], rows[k, 1], rows[k, 3]] for rows in by_film]
        found[name] = np.array([*np.ravel(parts), by_film[0][k, 2], moved[k] * solved.between])
    return found


def _as_starved(contact: Contact, solved: Contact) -> Contact:
    """A contact with the same oil shortage at its ends as in the solution."""
    return replace(
        contact,
        sealed_cavitation=solved.sealed_cavitation,
        outer_cavitation=solved.outer_cavitation,
    )


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
class FilmTable:
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
        by_input = slopes(found, self.names or list(point))
        self.names = [name for name, row in by_input.items() if np.nan_to_num(row).any()]
        return Interpolation(found.values, by_input)


def table(row: FilmRow, samples: Sequence[FilmRow]) -> FilmTable:
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
    return FilmTable(found, row, _errors(walker, found, points), float(here.values[-2]))


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
) -> tuple[SurrogateAxis, ...]:
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
            found.append((missed, SurrogateAxis(name, lower, upper, POINTS)))
    found.sort(key=lambda pair: -pair[0])
    lower, upper = spans["speed"]
    nodes = SPEEDS if upper <= lower * (1 + 1e-9) else POINTS
    speed = SurrogateAxis("speed", lower / SPEED_ROOM, upper * SPEED_ROOM, nodes, hermite=True)
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
) -> dict[Key, FilmTable]:
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
    found: dict[Key, FilmTable] = {}
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
def _table(inputs: bytes) -> FilmTable:
    """`table` of pickled inputs, cached: equal films of a report or comparison are solved once."""
    return table(*pickle.loads(inputs))


def unsolved(design: Design, rings: tuple[Ring, ...]) -> dict[Key, FilmTable]:
    """Tables of all films of a design without solutions: they return NaN."""
    found = {}
    for key, row in _rows(design, rings):
        inputs = {name: float(value) for name, value in row.inputs().items()}
        nothing = np.full((3 * len(row.rings) + 2, 1 + len(inputs)), np.nan)
        found[key] = FilmTable(Surrogate((), inputs, nothing, tuple(inputs)), row, {})
    return found


def _rows(design: Design, rings: tuple[Ring, ...]) -> Iterator[tuple[Key, FilmRow]]:
    """Rows of rings for all films of a design, by table."""
    places: tuple[Place, ...] = ("piston", "rod")
    for place in places:
        own = of_place(rings, place)
        for case, load_case in enumerate(design.load_cases):
            if not own or of_case(own[0]["speed"], case) == 0:
                continue
            for stroke, outward in _outward(place, load_case.direction == "push").items():
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
    tables: Mapping[Key, FilmTable], rings: Sequence[Ring], stroke: Stroke, cases: int
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
