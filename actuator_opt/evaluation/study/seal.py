"""A seal looked at closely: contact, oil film, friction, leakage, gland; at one point or a map.

Works for every sealing element, whether the design asks for its film or for a coefficient.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import nan, pi
from typing import TYPE_CHECKING

import numpy as np

from ...errors import Diagnostic, InputError
from ...models import elastomer, friction
from ...models.fluid import ATMOSPHERIC_PRESSURE
from .. import contact_elements, gland_check
from ..barrel import SEAL_STEP
from ..film import Row, Solved, solve
from ..film_tables import floats, of_place
from ..kernel import Base, Subject, base
from ..rings import Place, Ring
from ..touch import touch
from ..values import of_case
from .seal_record import RingPoint, SealMap, SealPoint, SealStudy, SqueezeRow, Stroke

if TYPE_CHECKING:
    from ...finite_elements.result import Contact

__all__ = [
    "RingPoint",
    "SealMap",
    "SealPoint",
    "SealStudy",
    "SqueezeRow",
    "seal_map",
    "study",
    "with_elements",
]

HARDNESS_SCATTER = 5.0
"""Scatter of a compound's hardness between batches, Shore A (usual delivery tolerance)."""

HARDEST = 98.0
"""Hardness up to which the scatter is followed, Shore A."""

CURVE_SPEEDS = tuple(float(v) for v in np.geomspace(1e-4, 1.0, 17))
"""Speeds of the friction curves, m/s."""

MAP_SPEEDS = tuple(float(v) for v in np.geomspace(5e-4, 0.5, 13))
MAP_SHARES = (0.02, 0.1, 0.25, 0.5, 0.75, 1.0)
"""Speeds [m/s] and shares of the supply pressure of a map."""


def study(
    subject: Subject,
    place: Place,
    *,
    speed: float | None = None,
    pressure: float | None = None,
    curves: bool = False,
    mapped: bool = False,
    elements: tuple[Contact, ...] = (),
) -> SealStudy:
    """The seals of piston or rod at one point, and around it.

    Parameters
    ----------
    subject : a design whose elements of the place all ask for a film
    speed, pressure : of the counterface [m/s], sealed gauge [Pa]; default: those of the moving
        load case of the highest pressure
    curves : whether to follow friction over speed at three pressures
    mapped : whether to fill a map over speed and pressure
    elements : what `with_elements` found, to be kept

    Raises
    ------
    InputError
        no speed, or a pressure or squeeze where the contact has none
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
                f"pressure {held / 1e5:g} bar: below that of the outer side",
                "state the sealed pressure over the outer one, 0 bar or more",
                path=f"seals.{place}",
            )
        )
    if not run > 0:
        raise InputError(
            Diagnostic(
                f"speed {run:g} m/s: a film and a secant damping need a moving seal",
                'state a speed above zero, e.g. --speed "0.1 m/s"',
                path=f"seals.{place}",
            )
        )
    _within(own, place, held)
    supply = float(v["supply.pressure"])
    growth = float(np.max(np.real(SEAL_STEP * found.wall.growth)))
    rate = growth / supply if place == "piston" else 0.0
    rings = _rings(own, case, pressure=held, speed=run, growth_per_pressure=rate)
    temperature = float(of_case(found.state.temperature, case))
    out, back = (_point(rings, temperature, stroke) for stroke in ("out", "in"))
    pressures = [x * supply for x in (MAP_SHARES[0], 0.5, 1.0)]
    outward = place == "rod"  # a driven piston runs away from the pressure it seals
    return SealStudy(
        design=subject.design,
        place=place,
        out=out,
        back=back,
        stroke=float(np.squeeze(found.geometry.stroke)),
        clearance=float(np.squeeze(gland_check.clearances(found.geometry, found.state, own[0])[0])),
        growth=rate * held,
        squeezes=tuple(_squeezes(subject, found, own, growth if place == "piston" else 0.0)),
        curves=seal_map(rings, CURVE_SPEEDS, pressures, outward=outward) if curves else None,
        map=seal_map(rings, MAP_SPEEDS, [x * supply for x in MAP_SHARES], outward=outward)
        if mapped
        else None,
        elements=elements,
    )


def with_elements(subject: Subject, place: Place) -> tuple[Subject, tuple[Contact, ...]]:
    """The same design with contact profiles by finite elements for the seal of a place, and these.

    Of two rings the first; a second keeps its closed form.
    """
    v = subject.values()
    ring = floats(of_place(base(subject, v).rings, place)[0], 0)
    found = contact_elements.contacts(ring, float(v["supply.pressure"]))
    design, stated = subject.design, contact_elements.profiles(found)
    seal = getattr(design.seals, place).model_copy(update={"contact": stated})
    seals = design.seals.model_copy(update={place: seal})
    return replace(subject, design=design.model_copy(update={"seals": seals}), films={}), found


def _within(own: Sequence[Ring], place: Place, pressure: float) -> None:
    """Stated profiles reach the pressure."""
    for ring in own:
        tables = ring.element.contact
        if tables and pressure > tables[-1].pressure * (1 + 1e-9):
            message = (
                f"pressure {pressure / 1e5:g} bar: the stated profiles of the {ring.label} end at "
                f"{tables[-1].pressure / 1e5:g} bar"
            )
            raise InputError(
                Diagnostic(message, "add a profile, or ask less", path=f"seals.{place}.contact")
            )


def _case(ring: Ring, speed: float | None) -> int:
    """The load case that stands for the point: of the highest pressure among those that move."""
    pressures, speeds = (
        np.atleast_2d(np.asarray(ring[name], dtype=float))[:, 0] for name in ("pressure", "speed")
    )
    count = max(pressures.size, speeds.size)
    held, run = np.broadcast_to(pressures, count), np.broadcast_to(speeds, count)
    if speed is None and np.any(run > 0):
        held = np.where(run > 0, held, -1.0)
    return int(np.argmax(held))


def _rings(
    own: Sequence[Ring], case: int, *, pressure: float, speed: float, growth_per_pressure: float
) -> tuple[Ring, ...]:
    """Rings of floats at a pressure and speed; the outer side is that of the atmosphere."""
    more = {"outer_pressure": 0.0, "speed": speed, "growth_per_pressure": growth_per_pressure}
    return tuple(_under(floats(ring, case).at(**more), pressure) for ring in own)


def _under(ring: Ring, pressure: float) -> Ring:
    """A ring at a pressure, with the squeeze that the bore's growth then leaves."""
    growth = ring["growth_per_pressure"] * pressure
    return ring.at(pressure=pressure, squeeze_left=ring["squeeze"] - growth / ring["section"])


def _point(rings: tuple[Ring, ...], temperature: float, stroke: Stroke) -> SealPoint:
    outward = stroke == "out"
    solved = solve(Row(rings, outward))
    between = solved.between
    shared = solved.row.between(between) if solved.films else rings
    points = tuple(_ring_point(ring, solved, i, outward=outward) for i, ring in enumerate(shared))
    lowest, highest = sorted(_bounds(rings, outward, solved))
    return SealPoint(
        stroke=stroke,
        speed=rings[0]["speed"],
        pressure=rings[0]["pressure"],
        temperature=temperature,
        rings=points,
        why=solved.why,
        between=between - ATMOSPHERIC_PRESSURE,
        flow=pi * rings[0]["diameter"] * solved.films[0].flow if solved.films else nan,
        lower=lowest,
        upper=highest,
    )


def modulus_range(ring: Ring) -> tuple[float, float, float]:
    """Lowest, assumed and highest Young's modulus of what is squeezed [Pa]."""
    value = ring["youngs_modulus"]
    hardness = ring.numbers.get("hardness")
    if hardness is None:
        return value / STATED_FACTOR, value, value * STATED_FACTOR
    scatter = min(HARDNESS_SCATTER, HARDEST - hardness)  # no law tells a modulus at 100 Shore A
    low, high = elastomer.modulus_bounds(hardness=hardness, hardness_scatter=max(scatter, 0.0))
    law = elastomer.MODULUS_LAWS[ring.element.hardness_model].modulus(hardness=hardness)
    return value * float(low / law), value, value * float(high / law)


STATED_FACTOR = 1.5
"""Scatter of a stated modulus, as that of the polyurethane of the rod-seal studies."""


def _bounds(rings: tuple[Ring, ...], outward: bool, solved: Solved) -> tuple[float, float]:
    """Friction with all moduli at their lowest and their highest."""
    if not solved.films:
        return nan, nan
    found = []
    for end in (0, 2):
        scaled = tuple(
            ring.at(
                youngs_modulus=modulus_range(ring)[end],
                face_modulus=ring["face_modulus"] * _face_factor(ring)[end],
            )
            for ring in rings
        )
        other = solve(Row(scaled, outward), solved)
        found.append(nan if other.why else other.friction())
    return found[0], found[1]


def _face_factor(ring: Ring) -> tuple[float, float, float]:
    """Lowest, assumed and highest modulus of the sliding face, over the assumed one."""
    if ring.element.type == "step_ring":
        return 1 / STATED_FACTOR, 1.0, STATED_FACTOR
    low, value, high = modulus_range(ring)
    return low / value, 1.0, high / value


def _ring_point(ring: Ring, solved: Solved, index: int, *, outward: bool) -> RingPoint:
    contact = touch(ring.at(pressure=abs(ring["pressure"])))
    diameter = ring["diameter"]
    around = {"line_load": float(contact.line_load), "diameter": diameter}
    dry = friction.seal_friction(friction_coefficient=ring["asperity_friction"], **around)
    coulomb = friction.seal_friction(friction_coefficient=ring["friction_coefficient"], **around)
    none = np.zeros(0)
    film = solved.films[index] if solved.films else None
    sign = 1.0 if outward else -1.0
    return RingPoint(
        ring=ring,
        touch=contact,
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
        coefficient_friction=float(coulomb),
        breakaway=float(dry),
        load_residual=nan if film is None else film.load_residual,
        mass_residual=nan if film is None else film.mass_residual,
    )


def seal_map(
    rings: tuple[Ring, ...], speeds: Sequence[float], pressures: Sequence[float], *, outward: bool
) -> SealMap:
    """Friction over speed and pressure on one stroke, each point begun from the one before."""
    table = np.full((len(pressures), len(speeds)), nan)
    dry, why = [], []
    last: Solved | None = None
    for i, pressure in enumerate(pressures):
        held = tuple(_under(ring, pressure) for ring in rings)
        dry.append(_dry(held[0]))
        for j in range(len(speeds)):
            k = j if i % 2 == 0 else len(speeds) - 1 - j
            found = solve(Row(tuple(r.at(speed=speeds[k]) for r in held), outward), last)
            if found.why:
                why.append((pressure, speeds[k], found.why))
                continue
            last = found
            table[i, k] = found.friction()
            if k == 0 and found.pair is not None:
                dry[-1] = sum(_dry(ring) for ring in found.row.between(found.between))
    return SealMap(np.array(speeds), np.array(pressures), table, np.array(dry), tuple(why))


def _dry(ring: Ring) -> float:
    """Friction of a ring with all oil squeezed out."""
    return float(
        friction.seal_friction(
            line_load=touch(ring.at(pressure=abs(ring["pressure"]))).line_load,
            diameter=ring["diameter"],
            friction_coefficient=ring["asperity_friction"],
        )
    )


def _squeezes(
    subject: Subject, found: Base, own: Sequence[Ring], growth: float
) -> Sequence[SqueezeRow]:
    """Squeeze over tolerance at coldest, case and hottest, without and with pressure."""
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
