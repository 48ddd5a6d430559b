"""The oil film under a moving seal, or under two seals in series: solution at an operating point.

Two seals in series pass the same flow. This condition determines the pressure between them
([Huang2017] eq. 17).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import nan
from typing import Literal, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import STEP, Array, maximum
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
from .rings import Ring, RingPlace, seal_contact, static_profile

NODES = 121
"""Number of nodes along the contact. Results on a finer mesh differ by less than 0.3 %."""

HIGHEST, AT_LEAST = 1.5, 10e6
"""Upper bound in the search for the pressure between two seals: `HIGHEST` times sealed pressure,
but no less than `AT_LEAST` [Pa, absolute]. At low sealed pressure, the pressure between the seals
can reach many times the sealed pressure."""

LEAST_SQUEEZE = 0.02
"""Smallest squeeze for which a film is solved; smaller values are raised to it. In such a design
the ring loses contact, so the design fails its squeeze check anyway."""

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
"""Properties of a ring that do not affect its film, or that both rings of a pair share."""

SHARED = ("speed", "viscosity", "viscosity_coefficient")
"""Inputs that both rings of a pair share, in addition to the pressures."""


Stroke = Literal["drive", "return"]


def films_asked(design: Design) -> bool:
    """Whether any seal of the design uses an oil film for its friction."""
    seals = design.seals
    return bool(seals.piston.friction_law.film or seals.rod.friction_law.film)


def on_stroke(rings: Sequence[Ring], stroke: Stroke) -> tuple[Ring, ...]:
    """Copies of the rings with the pressure that they seal on the given stroke, drive or return."""
    if stroke == "drive":
        return tuple(rings)
    return tuple(ring.at(pressure=ring["return_pressure"]) for ring in rings)


def of_place(rings: Sequence[Ring], place: RingPlace) -> tuple[Ring, ...]:
    """Rings with an oil film on the piston or rod, from the sealed side outwards."""
    return tuple(r for r in rings if r.name == place and r.element.friction_law.film)


def floats(ring: Ring, case: int, sample: int = 0) -> Ring:
    """Copy of a ring whose arrays are replaced by the numbers of one load case and one design."""

    def number(value: Array) -> float:
        array = np.atleast_2d(np.asarray(value, dtype=float))
        row = array[min(case, array.shape[0] - 1)]
        return float(row[min(sample, row.size - 1)])

    return ring.at(**{name: number(value) for name, value in ring.numbers.items()})


@dataclass(frozen=True, slots=True)
class FilmRow:
    """One ring, or two in series from the sealed side outwards, for one load case of one design.

    `outward` states whether the surface on which the rings slide moves towards the outer side.
    """

    rings: tuple[Ring, ...]
    outward: bool

    def inputs(self) -> dict[str, Array]:
        """Inputs of the film solver; pressures are absolute, squeeze at least `LEAST_SQUEEZE`."""
        first, last = self.rings[0], self.rings[-1]
        outer = last["outer_pressure"] + ATMOSPHERIC_PRESSURE
        inputs = {
            "speed": first["speed"],
            "viscosity": first["viscosity"],
            "viscosity_coefficient": first["viscosity_coefficient"],
            "sealed": outer + first["pressure"],
            "outer": outer,
        }
        for i, ring in enumerate(self.rings):
            inputs |= {f"{i}.{n}": x for n, x in ring.numbers.items() if n not in _NOT_OF_FILM}
            inputs[f"{i}.squeeze_left"] = maximum(ring["squeeze_left"], LEAST_SQUEEZE)
        return inputs

    def at(self, point: Mapping[str, Array]) -> FilmRow:
        """Copy with other values of `inputs`; each ring gets the whole pressure difference.

        `between` then divides this difference between two rings.
        """
        shared = {name: point[name] for name in SHARED if name in point}
        shared["outer_pressure"] = point["outer"] - ATMOSPHERIC_PRESSURE
        shared["pressure"] = point["sealed"] - point["outer"]
        by_ring = [
            {name.partition(".")[2]: x for name, x in point.items() if name.startswith(f"{i}.")}
            for i in range(len(self.rings))
        ]
        return FilmRow(
            tuple(ring.at(**shared, **x) for ring, x in zip(self.rings, by_ring, strict=True)),
            self.outward,
        )

    def between(self, pressure: Array) -> tuple[Ring, ...]:
        """The rings, each with its part of the pressure difference.

        `pressure` is the absolute pressure between two rings.
        """
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
        """Friction of every ring [N], from the drag and asperity load of its film."""
        return tuple(
            np.pi * ring["diameter"] * (film.drag + ring["asperity_friction"] * film.load)
            for ring, film in zip(self.rings, ring_films(values), strict=True)
        )

    def contacts(self, between: Array) -> tuple[Contact, ...]:
        """Film-solver input of every ring; `between` is the absolute pressure between two rings."""
        return tuple(contact(ring, outward=self.outward) for ring in self.between(between))


def contact(ring: Ring, *, outward: bool, nodes: int = NODES) -> Contact:
    """Film-solver input of a ring; its numbers may have a complex step, to obtain derivatives."""
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
    """Film results of a ring, per unit circumference; arrays if the inputs are arrays."""

    drag: Array
    """Viscous drag, positive against the motion [N/m]."""
    load: Array
    """Normal force that the asperities carry [N/m]."""
    thickness: Array
    """Mean film thickness [m]."""


def ring_films(values: Array) -> tuple[RingFilm, ...]:
    """Split `Solved.values` by ring, without its last two values (flow, interseal pressure)."""
    return tuple(RingFilm(*values[i : i + 3]) for i in range(0, len(values) - 2, 3))


@dataclass(frozen=True, slots=True)
class Solved:
    """Solved films of one ring or of two in series, or the reason for a failure.

    Parameters
    ----------
    row : the rings as solved
    films : one film per ring; empty after a failure
    why : reason for a failure
    pair : solution for two rings, with the pressure between them and the mismatch of their flows
    """

    row: FilmRow
    films: tuple[Film, ...]
    why: str = ""
    pair: Tandem | None = None

    @property
    def between(self) -> float:
        """Absolute pressure between two rings [Pa]; NaN for a single ring."""
        return nan if self.pair is None else self.pair.pressure

    @property
    def values(self) -> np.ndarray:
        """Drag and load [N/m] and mean film [m] of every ring, then flow and interseal pressure."""
        sign = 1.0 if self.row.outward else -1.0
        parts = [[sign * f.viscous_drag, f.contact_load, f.mean_film] for f in self.films]
        return np.array([*np.ravel(parts), self.films[0].flow, self.between])

    def friction(self) -> float:
        """Total friction of the rings [N]."""
        return float(sum(self.row.frictions(self.values)))


def solve(row: FilmRow, last: Solved | None = None) -> Solved:
    """Solve the films of one or two rings; the films of a nearby point are the initial guess."""
    if len(row.rings) == 1:
        if opened := _opened(row.rings[0]):
            return Solved(row, (), opened)
        (film_input,) = row.contacts(nan)
        film = solve_film(film_input, last.films[0] if last is not None else None)
        return Solved(row, (film,) if film.converged else (), film.reason)
    tandem = _tandem(row, last.pair if last is not None else None)
    if not tandem.converged or tandem.inner is None or tandem.outer is None:
        return Solved(row, (), tandem.reason)
    opened = next(filter(None, map(_opened, row.between(tandem.pressure))), "")
    films = () if opened else (tandem.inner, tandem.outer)
    return Solved(row, films, opened, tandem)


def _opened(ring: Ring) -> str:
    """Message if the sealed pressure lifts a ring off its counterface, else empty."""
    pressure = ring["pressure"]
    if seal_contact(ring.at(pressure=abs(pressure))).excess > 0:
        return ""
    return (
        f"a sealed pressure of {pressure / 1e6:.4g} MPa lifts the {ring.label} off its counterface"
    )


def _tandem(row: FilmRow, start: Tandem | None) -> Tandem:
    first, second = row.rings

    def element(ring: Ring) -> TandemSeal:
        def static(sealed: float, outer: float) -> tuple[float, np.ndarray]:
            pressed = ring.at(pressure=sealed - outer, outer_pressure=outer - ATMOSPHERIC_PRESSURE)
            width, pressure = static_profile(pressed, NODES)
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
    """Exact derivatives of `Solved.values` with respect to the logarithm of each named input."""
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
    interseal = np.zeros(len(names))
    if solved.pair is not None and solved.pair.cavitation == 0:
        # equal flows: d(interseal pressure) = -d(surplus)/(d(surplus)/d(interseal pressure))
        surplus = by_film[0][:, 2] - by_film[1][:, 2]
        interseal = -surplus[:-1] / surplus[-1]
        by_film = [rows[:-1] + np.outer(interseal, rows[-1]) for rows in by_film]
    # a starved space stays at the cavitation pressure, so its derivative is zero
    sign = 1.0 if row.outward else -1.0
    derivatives = {}
    for k, name in enumerate(names):
        parts = [[sign * rows[k, 0], rows[k, 1], rows[k, 3]] for rows in by_film]
        derivatives[name] = np.array(
            [*np.ravel(parts), by_film[0][k, 2], interseal[k] * solved.between]
        )
    return derivatives


def _as_starved(contact: Contact, solved: Contact) -> Contact:
    """A copy of a contact, with its ends starved of oil to the same degree as in `solved`."""
    return replace(
        contact,
        sealed_cavitation=solved.sealed_cavitation,
        outer_cavitation=solved.outer_cavitation,
    )
