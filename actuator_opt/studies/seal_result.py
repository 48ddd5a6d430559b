"""Results of a seal study, filled by `seal`. SI throughout."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..design.model import Design
from ..evaluation.rings import Place, Ring
from ..models import damping, lugre
from ..seals.contact import SealContact
from ..version import VERSION
from .film_walk import FilmMap, Stroke, drives

if TYPE_CHECKING:
    from ..finite_elements.result import Contact


@dataclass(frozen=True, slots=True)
class RingPoint:
    """One ring at an operating point; arrays over its contact, empty without a film.

    Parameters
    ----------
    ring : its properties
    contact : load per length, width and peak pressure
    modulus : lowest, assumed and highest Young's modulus of the squeezed part [Pa]
    x : distance from the sealed side [m]
    static, oil, asperity : pressures, absolute [Pa]
    film : distance of the mean planes [m]
    viscous, asperity_friction : of the whole circumference [N]
    coefficient_friction : from the coefficient of friction instead [N]
    breakaway : dry, all oil squeezed out [N]
    load_residual, mass_residual : of the film's balances
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
    """The seals of a place at one speed, pressure and stroke direction.

    Parameters
    ----------
    stroke : of the counterface past the seal: out of the sealed room, or in
    speed, pressure, temperature : [m/s], sealed pressure over the outer side [Pa], [K]
    rings : from the sealed side outwards
    why : reason for a missing film, else empty
    between : pressure between two rings, gauge [Pa]; NaN for one
    flow : towards the outer side [m^3/s]
    lower, upper : friction over the scatter of the modulus [N]
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
        """Return the oil friction [N]."""
        return sum(ring.viscous for ring in self.rings)

    @property
    def asperity(self) -> float:
        """Return the asperity friction [N]."""
        return sum(ring.asperity_friction for ring in self.rings)

    @property
    def friction(self) -> float:
        """Return the friction of all rings [N]."""
        return self.viscous + self.asperity

    @property
    def breakaway(self) -> float:
        """Return the friction after a standstill [N]."""
        return sum(ring.breakaway for ring in self.rings)

    @property
    def coefficient_friction(self) -> float:
        """Return the friction of all rings from the friction coefficient, without a film [N]."""
        return sum(ring.coefficient_friction for ring in self.rings)

    @property
    def damping(self) -> float:
        """Return the secant damping at the speed [N s/m]."""
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
    """Oil past a rod seal, both strokes at one pressure [m^3]; NaN without a film.

    Oil carried out by the stroke out, oil drawn back by the stroke in (negative: it leaks out too),
    and the net oil left outside.
    """

    carried_out: float
    drawn_back: float
    net: float


class LuGre(NamedTuple):
    """Bristle stiffness [N/m] and damping [N s/m], and the speed up to which the model is passive.

    Above that speed [m/s] the bristle damping must be tapered.
    """

    stiffness: float
    damping: float
    passive_speed: float


@dataclass(frozen=True, slots=True)
class SealStudy:
    """Results of a seal study of piston or rod.

    Parameters
    ----------
    place : piston or rod
    out, back : the operating point on both strokes, at one speed and pressure
    outer_pressure : gauge, on the outer side; for a piston the chamber it moves into [Pa]
    stroke : of the actuator [m]
    clearance : radial, behind the seal [m]
    growth : of the bore over the piston seal at the pressure [m]; 0 at the rod
    squeezes : over tolerance, temperature and pressure
    curves : friction over speed at three pressures
    map : over speed and pressure, if requested
    elements : finite elements of the first ring, as mounted first; empty if not requested
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
    elements: tuple[Contact, ...] = ()

    @property
    def drive(self) -> SealPoint:
        """Return the operating point of a driven actuator."""
        return self.out if drives(self.place) == "out" else self.back

    @property
    def other(self) -> SealPoint:
        """Return the point of the other stroke: rod moving in, or piston overrun by a load."""
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
        """Return the LuGre parameters for a simulation; None without a film or a load mass."""
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
        """Return the JSON form, SI; null without a film."""
        point = self.drive
        both = {"out": self.out, "in": self.back}
        oil = self.double_stroke
        found = {
            "name": self.design.name,
            "version": VERSION,
            "seal": self.place,
            "speed": point.speed,
            "pressure": point.pressure,
            "outer_pressure": self.outer_pressure,
            "drive": point.stroke,
            "temperature": point.temperature,
            "contact": [_contact_dict(ring) for ring in point.rings],
            "friction": {stroke: _friction_dict(one) for stroke, one in both.items()},
            "damping": {stroke: _known(one.damping) for stroke, one in both.items()},
            "leakage": {
                "flow_out": _known(self.out.flow),
                "flow_in": _known(self.back.flow),
                **{
                    name: None if oil is None else _known(getattr(oil, name))
                    for name in DoubleStroke._fields
                },
            },
            "lugre": None if self.lugre is None else self.lugre._asdict(),
            "inter_seal_pressure": {k: _known(one.between) for k, one in both.items()},
            "converged": self.converged,
            "reason": point.why or self.other.why,
            "load_residual": _worst(both.values(), "load_residual"),
            "mass_residual": _worst(both.values(), "mass_residual"),
        }
        if self.elements:
            found["finite_elements"] = [_element_dict(one) for one in self.elements]
        return found if self.map is None else found | {"map": _map_dict(self.map)}


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


def _element_dict(one: Contact) -> dict[str, float]:
    names = ("pressure", "line_load", "width", "peak_pressure")
    return {name: float(getattr(one, name)) for name in names} | {
        "von_mises": float(np.max(one.field.von_mises))
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


def _map_dict(found: FilmMap) -> dict[str, Any]:
    def rows(table: np.ndarray) -> list[list[float | None]]:
        return [[_known(value) for value in row] for row in table]

    return {
        "speeds": found.speeds.tolist(),
        "pressures": found.pressures.tolist(),
        "friction": rows(found.friction),
        "damping": rows(found.damping),
        "breakaway": [_known(value) for value in found.breakaway],
        "failed": [one._asdict() for one in found.why],
    }
