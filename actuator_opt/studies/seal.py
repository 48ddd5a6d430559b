"""Study of a seal: contact, oil film, friction, leakage and gland, at one point or over a map.

The study works for every sealing ring, whether the friction in the design follows from an oil film
or from a friction coefficient.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import isfinite, nan, pi
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.tables import Displayed
from ..design.model import Design
from ..evaluation import rings, sealing as contacts_of_seals
from ..evaluation.barrel import SEAL_STEP
from ..evaluation.film import FilmRow, Solved, floats, of_place, solve
from ..evaluation.kernel import Base, PreparedDesign, base
from ..evaluation.rings import Place, Ring, seal_contact
from ..evaluation.values import of_case
from ..models import damping, elastomer, lugre
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..seals.contact import SealContact
from ..version import VERSION
from .film_walk import FilmMap, Stroke, drives, dry_friction, film_map, sealing

if TYPE_CHECKING:
    from ..finite_elements.section import MountedContact


@dataclass(frozen=True, slots=True)
class RingPoint:
    """One ring at an operating point; arrays run along the contact, and are empty without a film.

    Parameters
    ----------
    ring : properties of the ring
    contact : load per length, width and peak pressure
    modulus : lowest, assumed and highest Young's modulus of the squeezed part [Pa]
    x : distance from the sealed side [m]
    static, oil, asperity : static contact pressure, oil pressure and asperity pressure, absolute
        [Pa]
    film : film thickness, the distance between the mean planes [m]
    viscous, asperity_friction : friction due to oil shear and due to asperities, over the whole
        circumference [N]
    coefficient_friction : friction from the friction coefficient, without a film [N]
    breakaway : breakaway friction with all oil squeezed out [N]
    load_residual, mass_residual : relative errors of the film solution in load and oil mass
    """

    ring: Ring
    contact: SealContact
    modulus: tuple[float, float, float]
    x: np.ndarray
    static: np.ndarray
    oil: np.ndarray
    asperity: np.ndarray
    film: np.ndarray
    viscous: float
    asperity_friction: float
    coefficient_friction: float
    breakaway: float
    load_residual: float
    mass_residual: float


@dataclass(frozen=True, slots=True)
class SealPoint:
    """The rings of a piston or rod seal at one speed, pressure and stroke direction.

    Parameters
    ----------
    stroke : direction of the counterface past the seal, out of the sealed chamber or into it
    speed, pressure, temperature : speed [m/s], sealed pressure above the outer pressure [Pa], oil
        temperature [K]
    rings : the rings, from the sealed side outwards
    why : reason for a missing film, else empty
    between : pressure between two rings, gauge [Pa]; NaN for a single ring
    flow : flow towards the outer side [m^3/s]
    lower, upper : least and greatest friction within the scatter of the modulus [N]
    """

    stroke: Stroke
    speed: float
    pressure: float
    temperature: float
    rings: tuple[RingPoint, ...]
    why: str
    between: float
    flow: float
    lower: float
    upper: float

    @property
    def converged(self) -> bool:
        """Whether the film solution exists."""
        return not self.why

    @property
    def viscous(self) -> float:
        """Return the friction of all rings due to oil shear [N]."""
        return sum(ring.viscous for ring in self.rings)

    @property
    def asperity(self) -> float:
        """Return the friction of all rings due to asperities [N]."""
        return sum(ring.asperity_friction for ring in self.rings)

    @property
    def friction(self) -> float:
        """Return the friction of all rings [N]."""
        return self.viscous + self.asperity

    @property
    def breakaway(self) -> float:
        """Return the breakaway friction after a standstill [N]."""
        return sum(ring.breakaway for ring in self.rings)

    @property
    def coefficient_friction(self) -> float:
        """Return the friction of all rings from the friction coefficient, without a film [N]."""
        return sum(ring.coefficient_friction for ring in self.rings)

    @property
    def damping(self) -> float:
        """Return the secant damping, friction divided by speed [N s/m]."""
        return float(damping.secant(friction=self.friction, speed=self.speed))


@dataclass(frozen=True, slots=True)
class SqueezeRow:
    """Least, nominal and greatest squeeze of a ring at a temperature and pressure."""

    label: str
    temperature: float
    pressure: float
    loosest: float
    nominal: float
    tightest: float


class DoubleStroke(NamedTuple):
    """Oil that passes a rod seal in one double stroke at one pressure [m^3]; NaN without a film.

    The values are: oil carried out on the outstroke, oil drawn back on the instroke (negative if
    the instroke leaks too), and the net oil left outside.
    """

    carried_out: float
    drawn_back: float
    net: float


class LuGre(NamedTuple):
    """Bristle stiffness [N/m] and damping [N s/m], and the speed up to which the model is passive.

    Above that speed [m/s] the bristle damping must be reduced, or the model could generate energy.
    """

    stiffness: float
    damping: float
    passive_speed: float


@dataclass(frozen=True, slots=True)
class SealStudy(Displayed):
    """Results of a seal study of piston or rod.

    Parameters
    ----------
    place : piston or rod
    out, back : the seal on outstroke and on instroke, both at the same speed and pressure
    outer_pressure : gauge pressure on the outer side [Pa]; for a piston seal, in the chamber
        towards which the piston moves
    stroke : stroke of the actuator [m]
    clearance : radial clearance behind the seal [m]
    growth : radial growth of the bore at the piston seal under the sealed pressure [m]; 0 for a rod
        seal
    squeezes : range of the squeeze due to tolerances, at several temperatures and pressures
    curves : friction over speed at three pressures, if requested
    map : friction over speed and pressure, if requested
    elements : finite-element contacts of the first ring: as mounted, then under pressure; empty if
        not requested
    """

    design: Design
    place: Place
    out: SealPoint
    back: SealPoint
    outer_pressure: float
    stroke: float
    clearance: float
    growth: float
    squeezes: tuple[SqueezeRow, ...]
    curves: FilmMap | None
    map: FilmMap | None
    elements: tuple[MountedContact, ...] = ()

    @property
    def in_short(self) -> tuple[str, str]:
        """The seal, and whether its oil film was solved on both strokes."""
        return self.design.name, f"{self.place} seal, {'' if self.converged else 'not '}converged"

    @property
    def drive(self) -> SealPoint:
        """Return the seal on the stroke on which the oil drives the actuator."""
        return self.out if drives(self.place) == "out" else self.back

    @property
    def other(self) -> SealPoint:
        """Return the seal on the opposite stroke: rod moving in, or piston overrun by a load."""
        return self.back if drives(self.place) == "out" else self.out

    @property
    def converged(self) -> bool:
        """Whether both strokes have a film."""
        return self.out.converged and self.back.converged

    @property
    def double_stroke(self) -> DoubleStroke | None:
        """Return the oil that a rod leaves outside; None for a piston, which has no such cycle."""
        if self.place == "piston":
            return None
        time = self.stroke / self.out.speed
        carried, drawn = self.out.flow * time, -self.back.flow * time
        return DoubleStroke(carried, drawn, max(carried - drawn, 0.0))

    @property
    def lugre(self) -> LuGre | None:
        """Return the parameters of the LuGre friction model; None without a film or a load mass."""
        static, mass = self.drive.breakaway, self.design.load.mass
        if not self.drive.converged or not (static > 0 and mass > 0):
            return None
        stiffness = lugre.lugre_bristle_stiffness(
            static=static, largest_deflection=self.design.stiffness.seal_deflection
        )
        bristle = lugre.lugre_bristle_damping(bristle_stiffness=stiffness, mass=mass)
        passive = lugre.lugre_passive_speed(
            level=self.drive.friction, bristle_damping=bristle, viscous=0.0
        )
        return LuGre(float(stiffness), float(bristle), float(passive))

    def to_dict(self) -> dict[str, Any]:
        """Return the study for JSON, SI; values that need a film are null without it."""
        drive = self.drive
        both = {"out": self.out, "in": self.back}
        oil = self.double_stroke
        data = {
            "name": self.design.name,
            "version": VERSION,
            "seal": self.place,
            "speed": drive.speed,
            "pressure": drive.pressure,
            "outer_pressure": self.outer_pressure,
            "drive": drive.stroke,
            "temperature": drive.temperature,
            "contact": [_contact_dict(ring) for ring in drive.rings],
            "friction": {stroke: _friction_dict(point) for stroke, point in both.items()},
            "damping": {stroke: _known(point.damping) for stroke, point in both.items()},
            "leakage": {
                "flow_out": _known(self.out.flow),
                "flow_in": _known(self.back.flow),
                **{
                    name: None if oil is None else _known(getattr(oil, name))
                    for name in DoubleStroke._fields
                },
            },
            "lugre": None if self.lugre is None else self.lugre._asdict(),
            "inter_seal_pressure": {name: _known(point.between) for name, point in both.items()},
            "converged": self.converged,
            "reason": drive.why or self.other.why,
            "load_residual": _worst(both.values(), "load_residual"),
            "mass_residual": _worst(both.values(), "mass_residual"),
        }
        if self.elements:
            data["finite_elements"] = [_element_dict(element) for element in self.elements]
        return data if self.map is None else data | {"map": _map_dict(self.map)}


def _known(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def _worst(points: Iterable[SealPoint], name: str) -> float | None:
    return _known(max(abs(getattr(ring, name)) for point in points for ring in point.rings))


def _contact_dict(point: RingPoint) -> dict[str, Any]:
    ring = point.ring
    low, modulus, high = point.modulus
    return {
        "seal": ring.label,
        "type": ring.element.type,
        "compound": ring.element.compound,
        "squeeze": ring["squeeze_left"],
        "line_load": float(point.contact.line_load),
        "width": float(point.contact.width),
        "peak_pressure": float(point.contact.peak),
        "youngs_modulus": {"value": modulus, "lower": low, "upper": high},
    }


def _element_dict(mounted_contact: MountedContact) -> dict[str, float]:
    names = ("pressure", "line_load", "width", "peak_pressure")
    return {name: float(getattr(mounted_contact, name)) for name in names} | {
        "von_mises": float(np.max(mounted_contact.field.von_mises))
    }


def _friction_dict(point: SealPoint) -> dict[str, Any]:
    return {
        "total": _known(point.friction),
        "viscous": _known(point.viscous),
        "asperity": _known(point.asperity),
        "lower": _known(point.lower),
        "upper": _known(point.upper),
        "breakaway": point.breakaway,
        "by_coefficient": point.coefficient_friction,
    }


def _map_dict(film_map: FilmMap) -> dict[str, Any]:
    def rows(table: np.ndarray) -> list[list[float | None]]:
        return [[_known(value) for value in row] for row in table]

    return {
        "speeds": film_map.speeds.tolist(),
        "pressures": film_map.pressures.tolist(),
        "friction": rows(film_map.friction),
        "damping": rows(film_map.damping),
        "breakaway": [_known(value) for value in film_map.breakaway],
        "failed": [missing._asdict() for missing in film_map.why],
    }


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
"""Lowest permitted speed of a seal study, m/s: 0.1 mm in 100 s."""

HARDEST = 98.0
"""Upper limit of hardness plus scatter, Shore A; at a hardness of 100 no law gives a modulus."""

CURVE_SPEEDS = tuple(float(v) for v in np.geomspace(1e-4, 1.0, 17))
CURVE_SHARES = (0.02, 0.5, 1.0)
"""Speeds [m/s] and pressures of the friction curves; the pressures are shares of the supply
pressure."""

MAP_SPEEDS = tuple(float(v) for v in np.geomspace(5e-4, 0.5, 13))
MAP_SHARES = (0.02, 0.1, 0.25, 0.5, 0.75, 1.0)
"""Speeds [m/s] and pressures of a friction map; the pressures are shares of the supply pressure."""


def study(
    subject: PreparedDesign,
    place: Place,
    *,
    speed: float | None = None,
    pressure: float | None = None,
    curves: bool = False,
    mapped: bool = False,
    elements: tuple[MountedContact, ...] = (),
) -> SealStudy:
    """Study the seals of piston or rod at one operating point; if requested, over a range.

    Parameters
    ----------
    subject : a design in which all rings of this piston or rod seal use the oil film
    speed, pressure : speed of the counterface [m/s], sealed pressure above the outer pressure [Pa].
        By default, both are those of the load case with the highest pressure, which also determines
        outer pressure and oil. If no speed is given, only load cases with motion count
    curves : whether to compute friction against speed at three pressures
    mapped : whether to compute a map over speed and pressure
    elements : contacts from `with_elements`, stored in the result

    Raises
    ------
    InputError
        no speed, a negative pressure, or a pressure beyond the stated contact profiles
    """
    v = subject.values()
    evaluation = base(subject, v)
    seal_row = of_place(evaluation.rings, place)
    case, speed, pressure = _operating_point(seal_row, place, speed, pressure)
    supply = float(v["supply.pressure"])
    driven = sealing(evaluation, place, case)
    temperature = float(of_case(evaluation.state.temperature, case))
    points: dict[Stroke, SealPoint] = {
        stroke: _point(replace(driven, outward=stroke == "out").row(pressure, speed), temperature)
        for stroke in ("out", "in")
    }
    largest = float(np.max(np.real(SEAL_STEP * evaluation.wall.growth)))
    return SealStudy(
        design=subject.design,
        place=place,
        out=points["out"],
        back=points["in"],
        outer_pressure=driven.rings[-1]["outer_pressure"],
        stroke=float(np.squeeze(evaluation.geometry.stroke)),
        clearance=float(
            np.squeeze(rings.clearances(evaluation.geometry, evaluation.state, seal_row[0])[0])
        ),
        growth=driven.grown(pressure),
        squeezes=tuple(
            _squeezes(subject, evaluation, seal_row, largest if place == "piston" else 0.0)
        ),
        curves=film_map(driven, [x * supply for x in CURVE_SHARES], CURVE_SPEEDS)
        if curves
        else None,
        map=film_map(driven, [x * supply for x in MAP_SHARES], MAP_SPEEDS) if mapped else None,
        elements=elements,
    )


def _operating_point(
    seal_row: Sequence[Ring], place: Place, speed: float | None, pressure: float | None
) -> tuple[int, float, float]:
    """Load case, speed and pressure of a study: those stated, or else those of the load case."""
    case = _case(seal_row[0], speed)
    if pressure is None:
        pressure = float(of_case(seal_row[0]["pressure"], case))
    if speed is None:
        speed = float(of_case(seal_row[0]["speed"], case))
    if not pressure >= 0:
        raise InputError(
            Diagnostic(
                f"pressure {pressure / 1e5:g} bar is below the pressure on the outer side",
                "state the sealed pressure relative to the outer side, 0 bar or more",
                path=f"seals.{place}",
            )
        )
    if not speed >= SLOWEST:
        raise InputError(
            Diagnostic(
                f"speed {speed:g} m/s: oil film and secant damping need a moving seal",
                f'state {SLOWEST:g} m/s or more, e.g. --speed "0.1 m/s"',
                path=f"seals.{place}",
            )
        )
    _within(seal_row, place, pressure)
    return case, speed, pressure


def with_elements(
    subject: PreparedDesign, place: Place
) -> tuple[PreparedDesign, tuple[MountedContact, ...]]:
    """Return the design with finite-element contact profiles for a seal, and these contacts.

    Of two rings, only the first gets a profile; the contact of the second still follows from the
    formula of its type.
    """
    v = subject.values()
    ring = floats(of_place(base(subject, v).rings, place)[0], 0)
    mounted = contacts_of_seals.contacts(ring, float(v["supply.pressure"]))
    design, stated = subject.design, contacts_of_seals.profiles(mounted)
    seal = getattr(design.seals, place).model_copy(update={"contact": stated})
    seals = design.seals.model_copy(update={place: seal})
    return replace(subject, design=design.model_copy(update={"seals": seals}), films={}), mounted


def _within(seal_row: Sequence[Ring], place: Place, pressure: float) -> None:
    """Raise an error for a pressure that the stated contact profiles do not cover."""
    for ring in seal_row:
        tables = ring.element.contact
        if tables and pressure > tables[-1].pressure * (1 + 1e-9):
            message = (
                f"pressure {pressure / 1e5:g} bar: the contact profiles stated for the "
                f"{ring.label} end at {tables[-1].pressure / 1e5:g} bar"
            )
            raise InputError(
                Diagnostic(
                    message,
                    "add a profile, or choose a lower pressure",
                    path=f"seals.{place}.contact",
                )
            )


def _case(ring: Ring, speed: float | None) -> int:
    """Return the load case with the highest pressure; without a speed, of the cases with motion."""
    pressures, speeds = (
        np.atleast_2d(np.asarray(ring[name], dtype=float))[:, 0] for name in ("pressure", "speed")
    )
    count = max(pressures.size, speeds.size)
    case_pressures, case_speeds = np.broadcast_to(pressures, count), np.broadcast_to(speeds, count)
    if speed is None and np.any(case_speeds > 0):
        case_pressures = np.where(case_speeds > 0, case_pressures, -1.0)
    return int(np.argmax(case_pressures))


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
"""Factor by which a stated modulus scatters up and down, as for the polyurethane of published
rod-seal studies."""


def _bounds(solved: Solved) -> tuple[float, float]:
    """Return least and largest friction within the scatter of all moduli; NaN without a film."""
    if not solved.films:
        return nan, nan
    frictions = [solved.friction()]
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
        frictions.append(other.friction())
    return min(frictions), max(frictions)


def _face_factor(ring: Ring) -> tuple[float, float, float]:
    """Return lowest, assumed and highest relative modulus of the sliding face.

    The assumed modulus is 1.
    """
    if ring.element.seal_type.modulus_by == "hardness":  # the face is plastic, its modulus stated
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
    subject: PreparedDesign, evaluation: Base, seal_row: Sequence[Ring], growth: float
) -> Sequence[SqueezeRow]:
    """Return squeeze ranges at several temperatures, each without and with supply pressure."""
    design, v = subject.design, subject.values()
    temperatures = [float(np.max(evaluation.state.temperature))]
    if design.environment is not None:
        temperatures += [design.environment.temperature_min, design.environment.temperature_max]
    rows = []
    for ring in seal_row:
        plain = floats(ring, 0)
        for temperature in sorted(set(temperatures)):
            ratio = rings.volume_ratio(v, design, evaluation.stock, ring, temperature)
            for pressure, grown in ((0.0, 0.0), (float(v["supply.pressure"]), growth)):
                spread = {"growth": grown, "ratio": ratio}
                loosest, tightest = rings.squeezes(plain, aside=0.0, **spread)
                exact = plain.at(tolerance=0.0, section_tolerance=0.0)
                nominal, _ = rings.squeezes(exact, aside=0.0, **spread)
                rows.append(
                    SqueezeRow(
                        ring.label,
                        temperature,
                        pressure,
                        float(loosest),
                        float(nominal),
                        float(tightest - grown / plain["section"]),
                    )
                )
    return rows
