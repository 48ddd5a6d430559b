"""Study of a seal: contact, oil film, friction, leakage and gland, at one point or over a map.

Works for every sealing element, whether the design uses its film or a friction coefficient.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import nan, pi
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..evaluation import contact_elements, gland_check
from ..evaluation.barrel import SEAL_STEP
from ..evaluation.film import FilmRow, Solved, solve
from ..evaluation.film_tables import floats, of_place
from ..evaluation.kernel import Base, PreparedDesign, base
from ..evaluation.rings import Place, Ring
from ..evaluation.seal_contact import seal_contact
from ..evaluation.values import of_case
from ..models import elastomer
from ..models.fluid import ATMOSPHERIC_PRESSURE
from .film_walk import FilmMap, Stroke, dry_friction, film_map, sealing
from .seal_result import RingPoint, SealPoint, SealStudy, SqueezeRow

if TYPE_CHECKING:
    from ..finite_elements.result import Contact

__all__ = [
    "FilmMap",
    "RingPoint",
    "SealPoint",
    "SealStudy",
    "SqueezeRow",
    "study",
    "with_elements",
]

HARDNESS_SCATTER = 5.0
"""Hardness scatter of a compound between batches, Shore A (usual delivery tolerance)."""

SLOWEST = 1e-6
"""Lowest speed of a seal study, m/s: 0.1 mm in 100 s."""

HARDEST = 98.0
"""Upper limit of the scattered hardness, Shore A."""

CURVE_SPEEDS = tuple(float(v) for v in np.geomspace(1e-4, 1.0, 17))
CURVE_SHARES = (0.02, 0.5, 1.0)
"""Speeds [m/s] of the friction curves, and their shares of the supply pressure."""

MAP_SPEEDS = tuple(float(v) for v in np.geomspace(5e-4, 0.5, 13))
MAP_SHARES = (0.02, 0.1, 0.25, 0.5, 0.75, 1.0)
"""Speeds [m/s] and shares of the supply pressure of a map."""


def study(
    subject: PreparedDesign,
    place: Place,
    *,
    speed: float | None = None,
    pressure: float | None = None,
    curves: bool = False,
    mapped: bool = False,
    elements: tuple[Contact, ...] = (),
) -> SealStudy:
    """Study the seals of piston or rod at one point, and around it.

    Parameters
    ----------
    subject : a design whose elements at the place all use a film
    speed, pressure : of the counterface [m/s], sealed pressure over the outer side [Pa]; default:
        those of the moving load case with the highest pressure, which also sets outer side and oil
    curves : compute friction over speed at three pressures
    mapped : compute a map over speed and pressure
    elements : contacts from `with_elements`, to be stored

    Raises
    ------
    InputError
        no speed, or a pressure or squeeze for which the contact has no solution
    """
    v = subject.values()
    found = base(subject, v)
    own = of_place(found.rings, place)
    case = _case(own[0], speed)
    held = float(of_case(own[0]["pressure"], case)) if pressure is None else pressure
    run = float(of_case(own[0]["speed"], case)) if speed is None else speed
    if not held >= 0:
        raise InputError(
            Diagnostic(
                f"pressure {held / 100000.0:g} bar is below the pressure on the outer side",
                "state the sealed pressure relative to the outer side, 0 bar or more",
                path=f"seals.{place}",
            )
        )
    if not run >= SLOWEST:
        raise InputError(
            Diagnostic(
                f"speed {run:g} m/s: film and secant damping need a moving seal",
                f'state {SLOWEST:g} m/s or more, e.g. --speed "0.1 m/s"',
                path=f"seals.{place}",
            )
        )
    _within(own, place, held)
    supply = float(v["supply.pressure"])
    driven = sealing(found, place, case)
    temperature = float(of_case(found.state.temperature, case))
    points: dict[Stroke, SealPoint] = {
        stroke: _point(replace(driven, outward=stroke == "out").row(held, run), temperature)
        for stroke in ("out", "in")
    }
    largest = float(np.max(np.real(SEAL_STEP * found.wall.growth)))
    return SealStudy(
        design=subject.design,
        place=place,
        out=points["out"],
        back=points["in"],
        outer_pressure=driven.rings[-1]["outer_pressure"],
        stroke=float(np.squeeze(found.geometry.stroke)),
        clearance=float(np.squeeze(gland_check.clearances(found.geometry, found.state, own[0])[0])),
        growth=driven.grown(held),
        squeezes=tuple(_squeezes(subject, found, own, largest if place == "piston" else 0.0)),
        curves=film_map(driven, [x * supply for x in CURVE_SHARES], CURVE_SPEEDS)
        if curves
        else None,
        map=film_map(driven, [x * supply for x in MAP_SHARES], MAP_SPEEDS) if mapped else None,
        elements=elements,
    )


def with_elements(
    subject: PreparedDesign, place: Place
) -> tuple[PreparedDesign, tuple[Contact, ...]]:
    """Return the design with finite-element contact profiles for a seal, and these contacts.

    Of two rings only the first gets a profile; the second keeps its closed form.
    """
    v = subject.values()
    ring = floats(of_place(base(subject, v).rings, place)[0], 0)
    found = contact_elements.contacts(ring, float(v["supply.pressure"]))
    design, stated = subject.design, contact_elements.profiles(found)
    seal = getattr(design.seals, place).model_copy(update={"contact": stated})
    seals = design.seals.model_copy(update={place: seal})
    return replace(subject, design=design.model_copy(update={"seals": seals}), films={}), found


def _within(own: Sequence[Ring], place: Place, pressure: float) -> None:
    """Check that stated profiles cover the pressure."""
    for ring in own:
        tables = ring.element.contact
        if tables and pressure > tables[-1].pressure * (1 + 1e-9):
            message = (
                f"pressure {pressure / 1e5:g} bar: the stated profiles of the {ring.label} end at "
                f"{tables[-1].pressure / 1e5:g} bar"
            )
            raise InputError(
                Diagnostic(
                    message,
                    "add a profile, or choose a lower pressure",
                    path=f"seals.{place}.contact",
                )
            )


def _case(ring: Ring, speed: float | None) -> int:
    """Return the load case for the point: the moving one with the highest pressure."""
    pressures, speeds = (
        np.atleast_2d(np.asarray(ring[name], dtype=float))[:, 0] for name in ("pressure", "speed")
    )
    count = max(pressures.size, speeds.size)
    held, run = np.broadcast_to(pressures, count), np.broadcast_to(speeds, count)
    if speed is None and np.any(run > 0):
        held = np.where(run > 0, held, -1.0)
    return int(np.argmax(held))


def _point(row: FilmRow, temperature: float) -> SealPoint:
    solved = solve(row)
    between, first = solved.between, row.rings[0]
    shared = solved.row.between(between) if solved.films else row.rings
    points = tuple(_ring_point(ring, solved, i) for i, ring in enumerate(shared))
    lowest, highest = _bounds(solved)
    return SealPoint(
        stroke="out" if row.outward else "in",
        speed=first["speed"],
        pressure=first["pressure"],
        temperature=temperature,
        rings=points,
        why=solved.why,
        between=between - ATMOSPHERIC_PRESSURE,
        flow=pi * first["diameter"] * solved.films[0].flow if solved.films else nan,
        lower=lowest,
        upper=highest,
    )


def modulus_range(ring: Ring) -> tuple[float, float, float]:
    """Return the lowest, assumed and highest Young's modulus of the squeezed part [Pa]."""
    value = ring["youngs_modulus"]
    hardness = ring.numbers.get("hardness")
    if hardness is None:
        return value / STATED_FACTOR, value, value * STATED_FACTOR
    scatter = min(HARDNESS_SCATTER, HARDEST - hardness)  # no law gives a modulus at 100 Shore A
    low, high = elastomer.modulus_bounds(hardness=hardness, hardness_scatter=max(scatter, 0.0))
    law = elastomer.MODULUS_LAWS[ring.element.hardness_model].modulus(hardness=hardness)
    return value * float(low / law), value, value * float(high / law)


STATED_FACTOR = 1.5
"""Scatter of a stated modulus, as for the polyurethane of the rod-seal studies."""


def _bounds(solved: Solved) -> tuple[float, float]:
    """Return least and largest friction over the scatter of all moduli; NaN without a film."""
    if not solved.films:
        return nan, nan
    found = [solved.friction()]
    for end in (0, 2):
        scaled = tuple(
            ring.at(
                youngs_modulus=modulus_range(ring)[end],
                face_modulus=ring["face_modulus"] * _face_factor(ring)[end],
            )
            for ring in solved.row.rings
        )
        other = solve(FilmRow(scaled, solved.row.outward), solved)
        if other.why:
            return nan, nan
        found.append(other.friction())
    return min(found), max(found)


def _face_factor(ring: Ring) -> tuple[float, float, float]:
    """Return the lowest, assumed and highest modulus of the sliding face, over the assumed one."""
    if (
        ring.element.seal_type.modulus_by == "hardness"
    ):  # the face is plastic, with a stated modulus
        return 1 / STATED_FACTOR, 1.0, STATED_FACTOR
    low, value, high = modulus_range(ring)
    return low / value, 1.0, high / value


def _ring_point(ring: Ring, solved: Solved, index: int) -> RingPoint:
    contact = seal_contact(ring.at(pressure=abs(ring["pressure"])))
    diameter = ring["diameter"]
    none = np.zeros(0)
    film = solved.films[index] if solved.films else None
    sign = 1.0 if solved.row.outward else -1.0
    return RingPoint(
        ring=ring,
        contact=contact,
        modulus=modulus_range(ring),
        x=none if film is None else film.x,
        static=none if film is None else film.contact.static_pressure,
        oil=none if film is None else film.pressure,
        asperity=none if film is None else film.contact_pressure,
        film=none if film is None else film.film,
        viscous=nan if film is None else pi * diameter * sign * film.viscous_drag,
        asperity_friction=nan
        if film is None
        else pi * diameter * ring["asperity_friction"] * film.contact_load,
        coefficient_friction=dry_friction(ring, contact, "friction_coefficient"),
        breakaway=dry_friction(ring, contact, "asperity_friction"),
        load_residual=nan if film is None else film.load_residual,
        mass_residual=nan if film is None else film.mass_residual,
    )


def _squeezes(
    subject: PreparedDesign, found: Base, own: Sequence[Ring], growth: float
) -> Sequence[SqueezeRow]:
    """Return squeeze over tolerance at coldest, case and hottest, without and with pressure."""
    design, v = subject.design, subject.values()
    temperatures = [float(np.max(found.state.temperature))]
    if design.environment is not None:
        temperatures += [design.environment.temperature_min, design.environment.temperature_max]
    rows = []
    for ring in own:
        one = floats(ring, 0)
        for temperature in sorted(set(temperatures)):
            ratio = gland_check.volume_ratio(v, design, found.stock, ring, temperature)
            for pressure, grown in ((0.0, 0.0), (float(v["supply.pressure"]), growth)):
                spread = {"growth": grown, "ratio": ratio}
                loosest, tightest = gland_check.squeezes(one, aside=0.0, **spread)
                exact = one.at(tolerance=0.0, section_tolerance=0.0)
                nominal, _ = gland_check.squeezes(exact, aside=0.0, **spread)
                rows.append(
                    SqueezeRow(
                        ring.label,
                        temperature,
                        pressure,
                        float(loosest),
                        float(nominal),
                        float(tightest - grown / one["section"]),
                    )
                )
    return rows
