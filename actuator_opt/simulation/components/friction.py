"""Seal friction in time: bristles, a smooth Stribeck curve, or none."""

from __future__ import annotations

from dataclasses import dataclass

from ...base.kinds import per_kind
from ...base.numeric import maximum
from ...base.quantities import SCENARIOS
from ...base.symbolic import Expression
from ...design.scenario.kinds import FRICTIONS
from ...design.scenario.model import Friction as Stated
from ...models import friction, lugre
from ...studies.plant import Plane, Plant
from .circuit import Circuit, Start

LEAST = 1e-3
"""Least friction level [N]: bristles need a positive one."""
SMOOTHING = 0.05
"""Width of the zero crossing, relative to the Stribeck speed (a choice)."""
LONE_SPEED = 1e-3
"""The same where friction does not depend on speed [m/s]."""


@dataclass(frozen=True, slots=True)
class Law:
    """Friction over speed and chamber pressures."""

    coulomb: Plane
    static: Plane
    stribeck_speed: float
    exponent: float
    viscous: float
    bristle_stiffness: float
    bristle_damping: float
    taper_speed: float


def law(plant: Plant, stated: Stated, start: Start) -> Law:
    """The design's friction, or the stated one; bristle stiffness at the initial pressures."""
    seals, pressures = plant.seals, (start.pressure_a, start.pressure_b)
    coulomb, static = seals.coulomb, seals.static
    speed = seals.stribeck_speed
    viscous = seals.viscous
    if stated.coulomb is not None:
        coulomb = Plane(stated.coulomb)
        static = Plane(stated.coulomb if stated.static is None else stated.static)
        speed = stated.stribeck_speed or LONE_SPEED
        viscous = 0.0
    if stated.model == "none":
        viscous = 0.0
    if stated.viscous is not None:
        viscous = stated.viscous
    level = max(float(coulomb.at(*pressures)), LEAST)
    breakaway = max(float(static.at(*pressures)), level)
    travel = stated.bristle_travel or seals.bristle_travel
    stiffness = float(lugre.lugre_bristle_stiffness(static=breakaway, largest_deflection=travel))
    damping = stated.bristle_damping
    if damping is None:
        damping = float(
            lugre.lugre_bristle_damping(
                bristle_stiffness=stiffness, mass=plant.moving_mass(start.position)
            )
        )
    passive = lugre.lugre_passive_speed(
        level=level, bristle_damping=max(damping, 1e-9), viscous=viscous
    )
    return Law(
        coulomb, static, speed, stated.exponent, viscous, stiffness, damping, 0.5 * float(passive)
    )


def resist(
    circuit: Circuit,
    own: Law,
    *,
    speed: Expression,
    pressure_a: Expression,
    pressure_b: Expression,
) -> Expression:
    """Friction force on the piston, with the sign of the speed [N]."""
    if circuit.linear:
        return _viscous(circuit, own, speed, pressure_a, pressure_b)
    return FORCES[circuit.scenario.friction.model](circuit, own, speed, pressure_a, pressure_b)


def _levels(
    own: Law, pressure_a: Expression, pressure_b: Expression
) -> tuple[Expression, Expression]:
    """Coulomb and static friction at the chamber pressures."""
    coulomb = maximum(own.coulomb.at(pressure_a, pressure_b), LEAST)
    if own.static is own.coulomb:
        return coulomb, coulomb
    return coulomb, maximum(own.static.at(pressure_a, pressure_b), coulomb)


def _viscous(
    circuit: Circuit, own: Law, speed: Expression, pressure_a: Expression, pressure_b: Expression
) -> Expression:
    return own.viscous * speed


def _stribeck(
    circuit: Circuit, own: Law, speed: Expression, pressure_a: Expression, pressure_b: Expression
) -> Expression:
    coulomb, static = _levels(own, pressure_a, pressure_b)
    return friction.stribeck(
        speed=speed,
        coulomb=coulomb,
        static=static,
        stribeck_speed=own.stribeck_speed,
        exponent=own.exponent,
        viscous=own.viscous,
        smoothing_speed=SMOOTHING * own.stribeck_speed,
    )


def _lugre(
    circuit: Circuit, own: Law, speed: Expression, pressure_a: Expression, pressure_b: Expression
) -> Expression:
    system = circuit.system
    coulomb, static = _levels(own, pressure_a, pressure_b)
    level = friction.stribeck_level(
        speed=speed,
        coulomb=coulomb,
        static=static,
        stribeck_speed=own.stribeck_speed,
        exponent=own.exponent,
    )
    bristle = system.state("bristles", 0.0, tolerance=1e-10)
    rate = lugre.lugre_rate(
        deflection=bristle, speed=speed, level=level, bristle_stiffness=own.bristle_stiffness
    )
    system.rate(bristle, rate)
    system.signal("bristles", "deflection of the bristles", SCENARIOS["position_value"], bristle)
    damping = lugre.lugre_tapered_damping(
        bristle_damping=own.bristle_damping, speed=speed, taper_speed=own.taper_speed
    )
    return lugre.lugre_force(
        deflection=bristle,
        rate=rate,
        speed=speed,
        bristle_stiffness=own.bristle_stiffness,
        bristle_damping=damping,
        viscous=own.viscous,
    )


FORCES = per_kind(FRICTIONS, {"lugre": _lugre, "stribeck": _stribeck, "none": _viscous})
"""Force for every seal friction law."""
