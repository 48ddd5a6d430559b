"""Parameters that can be fitted to a measured record: meaning, initial value and range."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from ...base.dataclass import dataclass
from ...base.errors import Diagnostic, InputError, remedy, shown
from ...base.quantities import INPUTS, MATERIAL_PROPERTIES, RECORDS, SCENARIOS, Quantity
from ...design.scenario.model import ForceSignal, Scenario
from ...evaluation.spool import EDGES
from ...models.lapped_spool import LappedSpool
from ...studies.plant import LEAST_AIR, Plane, Plant, ValveData
from ..assemble import ends_of, start_of
from ..components.chambers import LEAST_DEAD

Case: TypeAlias = tuple[Scenario, Plant]
Put: TypeAlias = Callable[[Scenario, Plant, float], Case]

SMALL = 0.01
"""Share of a full value that counts as small (our choice). The full value of a force is the supply
pressure times the piston area. A friction force that neither design nor scenario states starts at
this share. A confidence interval of an offset counts as narrow up to this share."""
BLEED = 1e-6 / 60 / 1e5
"""Leakage from which the fit starts if the design states none (our choice): 1 ml/min/bar
[m^3/s/Pa]."""
RISE = 1.5
"""Ratio of static to Coulomb friction from which the fit starts if design and scenario state no
difference between the two (our choice)."""
LATEST = 0.2
"""Largest lag of a record, as a share of the simulated time (our choice: enough for a logger that
is started by hand)."""


@dataclass(frozen=True, slots=True)
class FitParameter:
    """A parameter to fit: its quantity, initial value and search range, SI.

    `put` is the function that sets the parameter in a scenario and plant.
    """

    name: str
    quantity: Quantity
    start: float
    lower: float
    upper: float
    positive: bool
    """Whether the search uses the logarithm of the parameter."""
    near: float
    """Half the width of a confidence interval that counts as narrow, even if the value itself is
    near zero. It applies to parameters that may be negative."""
    put: Put


def entries(names: Sequence[str], scenario: Scenario, plant: Plant) -> tuple[FitParameter, ...]:
    """Parameters by their names, in the given order.

    Raises
    ------
    InputError
        no name, an unknown or repeated name, or a parameter without effect in this scenario
    """
    known = (*PARAMETERS, "lag")
    faults = []
    for k, name in enumerate(names):
        if name not in known:
            message = f'"{shown(name)}" is not a parameter'
            faults.append(Diagnostic(message, remedy(name, known, limit=len(known))))
        elif name in names[:k]:
            faults.append(Diagnostic(f"{name} is named twice", "name it once"))
        elif why := _idle(name, scenario, plant):
            faults.append(Diagnostic(f"{name} has no effect: {why}", "leave it out"))
        elif name == "stribeck_speed" and "static" not in names and _even(scenario, plant):
            message = f"{name} has no effect: static and Coulomb friction are equal"
            faults.append(Diagnostic(message, "also fit static, or state a higher static friction"))
    if not names:
        faults.append(Diagnostic("no parameter to fit", f"name one of {', '.join(known)}"))
    if faults:
        raise InputError(faults)
    return tuple(_entry(name, scenario, plant) for name in names)


def _idle(name: str, scenario: Scenario, plant: Plant) -> str | None:
    """Reason why a parameter has no effect in this scenario, or None."""
    on_bench, motor = scenario.held_ports is not None, scenario.motor is not None
    if name in VALVE:
        if plant.valve is None:
            return "the design has no valve"
        if not on_bench and not motor and ends_of(scenario, plant) != "valve":
            return "the lines do not end at a valve"
        leaks = plant.valve.leakage_supply or plant.valve.leakage_tank
        if name == "valve_leakage" and plant.valve.metering is not None:
            return "the edges of the spool give its leakage; fit valve_capacity"
        if name == "valve_leakage" and not leaks:
            return "it multiplies the leakage of the design's valve, which is zero"
        return None
    if name == "lag":
        return None
    if on_bench:
        return "the ports of the valve are blocked"
    if motor and name not in OIL:
        return "a motor replaces the cylinder"
    if name in FRICTION and scenario.friction.model == "none" and name != "viscous":
        return "friction.model is none"
    if name == "bristle_travel" and scenario.friction.model == "stribeck":
        return "friction.model is stribeck"
    return None


def _even(scenario: Scenario, plant: Plant) -> bool:
    """Whether static friction is no larger than Coulomb friction."""
    friction = scenario.friction
    if friction.coulomb is not None:
        return (friction.static or friction.coulomb) <= friction.coulomb
    return plant.seals.static == plant.seals.coulomb


def _entry(name: str, scenario: Scenario, plant: Plant) -> FitParameter:
    if name == "lag":
        most = LATEST * scenario.duration
        quantity = RECORDS["pressure_lag"]
        lag = replace(quantity, name="lag", label="time lag of the record")
        return FitParameter(name, lag, 0.0, -most, most, False, 0.0, lambda s, p, _: (s, p))
    return PARAMETERS[name](scenario, plant)


def _force(plant: Plant) -> float:
    """Force of the supply pressure on the piston."""
    return plant.supply_pressure * plant.area_a


def _positive(
    name: str, quantity: Quantity, start: float, least: float, most: float, put: Put
) -> FitParameter:
    guess = min(max(start, 1.001 * least), 0.999 * most)
    return FitParameter(name, quantity, guess, least, most, True, 0.0, put)


def _air(scenario: Scenario, plant: Plant) -> FitParameter:
    quantity = INPUTS["air_content"]

    def put(s: Scenario, p: Plant, value: float) -> Case:
        return s, replace(p, oil=replace(p.oil, air_content=value))

    start = plant.oil.air_content
    return _positive("air_content", quantity, start, LEAST_AIR, quantity.upper, put)


def _bulk(scenario: Scenario, plant: Plant) -> FitParameter:
    quantity = MATERIAL_PROPERTIES["bulk_modulus"]
    quantity = replace(quantity, label="bulk modulus of the oil without air, at zero pressure")

    def put(s: Scenario, p: Plant, value: float) -> Case:
        return s, replace(p, oil=replace(p.oil, bulk_modulus=value))

    start = plant.oil.bulk_modulus
    return _positive("bulk_modulus", quantity, start, quantity.lower, quantity.upper, put)


def _capacity(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        assert p.valve is not None
        return s, replace(p, valve=_wider(p.valve, value))

    quantity = replace(SCENARIOS["factor"], label="factor on the rated flow of the valve's edges")
    return _positive("valve_capacity", quantity, 1.0, 0.05, 20.0, put)


def _wider(valve: ValveData, factor: float) -> ValveData:
    """The valve with edges that pass a multiple of their flow."""
    spool: Any = valve.metering
    if spool is None:
        return replace(valve, rated=factor * valve.rated)
    size = "area_gradient" if isinstance(spool, LappedSpool) else "factor"
    edges = {
        name: replace(edge, **{size: factor * getattr(edge, size)})
        for name in EDGES
        for edge in (getattr(spool, name),)
    }
    return replace(valve, metering=replace(spool, **edges))


def _valve_leakage(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        assert p.valve is not None
        leaks = {name: value * getattr(p.valve, name) for name in _LEAKS}
        return s, replace(p, valve=replace(p.valve, **leaks))

    quantity = replace(SCENARIOS["factor"], label="factor on the leakage of the valve's edges")
    return _positive("valve_leakage", quantity, 1.0, 1e-3, 100.0, put)


def _valve_offset(scenario: Scenario, plant: Plant) -> FitParameter:
    assert plant.valve is not None
    full, start = plant.valve.signal, plant.valve.offset

    def put(s: Scenario, p: Plant, value: float) -> Case:
        assert p.valve is not None
        return s, replace(p, valve=replace(p.valve, offset=value))

    quantity = replace(SCENARIOS["signal_value"], label="signal that centres the spool")
    return FitParameter("valve_offset", quantity, start, -full, full, False, SMALL * full, put)


def _leakage(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        return s, replace(p, leakage=value)

    quantity = replace(INPUTS["conductance"], label="leakage past the piston")
    start = plant.leakage or BLEED
    return _positive("piston_leakage", quantity, start, 1e-4 * BLEED, 1e4 * BLEED, put)


def _level(plane: Plane, scenario: Scenario, plant: Plant) -> float:
    """Friction at the initial pressures, for friction given as a function of both pressures."""
    initial = start_of(scenario, plant, {})
    return float(plane.at(initial.pressure_a, initial.pressure_b))


def _scaled(plane: Plane, scenario: Scenario, plant: Plant, value: float) -> Plane:
    """A friction function, scaled so that it has a given value at the initial pressures.

    The relative change with pressure stays the same.
    """
    level = _level(plane, scenario, plant)
    if level <= 0:
        return Plane(value)
    factor = value / level
    return Plane(
        factor * plane.constant,
        factor * plane.difference,
        factor * plane.rod_side,
        factor * plane.higher,
        plane.error,
    )


def _stated(scenario: Scenario, **values: float) -> Scenario:
    """A copy of a scenario with some friction values changed."""
    return scenario.model_copy(update={"friction": scenario.friction.model_copy(update=values)})


def _coulomb(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        if s.friction.coulomb is not None:
            return _stated(s, coulomb=value), p
        rise = _level(p.seals.static, s, p) / max(_level(p.seals.coulomb, s, p), 1e-9)
        seals = replace(
            p.seals,
            coulomb=_scaled(p.seals.coulomb, s, p, value),
            static=_scaled(p.seals.static, s, p, max(rise, 1.0) * value),
        )
        return s, replace(p, seals=seals)

    scenario_level = scenario.friction.coulomb
    level = (
        _level(plant.seals.coulomb, scenario, plant) if scenario_level is None else scenario_level
    )
    most = _force(plant)
    return _positive(
        "coulomb", SCENARIOS["coulomb_force"], level or SMALL * most, 1e-5 * most, most, put
    )


def _static(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        if s.friction.coulomb is not None:
            return _stated(s, static=value), p
        return s, replace(p, seals=replace(p.seals, static=_scaled(p.seals.static, s, p, value)))

    friction = scenario.friction
    if friction.coulomb is None:
        level = _level(plant.seals.coulomb, scenario, plant)
        start = _level(plant.seals.static, scenario, plant)
    else:
        level, start = friction.coulomb, friction.static or friction.coulomb
    most = _force(plant)
    guess = max(start, RISE * level if start <= 1.01 * level else start, SMALL * most)
    return _positive("static", SCENARIOS["static_force"], guess, 1e-5 * most, most, put)


def _stribeck_speed(scenario: Scenario, plant: Plant) -> FitParameter:
    quantity = INPUTS["stribeck_speed"]

    def put(s: Scenario, p: Plant, value: float) -> Case:
        if s.friction.coulomb is not None:
            return _stated(s, stribeck_speed=value), p
        return s, replace(p, seals=replace(p.seals, stribeck_speed=value))

    friction = scenario.friction
    start = (
        plant.seals.stribeck_speed if friction.coulomb is None else friction.stribeck_speed or 5e-3
    )
    return _positive("stribeck_speed", quantity, start, quantity.lower, quantity.upper, put)


def _viscous(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        return _stated(s, viscous=value), p

    friction = scenario.friction
    start = friction.viscous
    if start is None:
        start = 0.0 if friction.coulomb is not None else plant.seals.viscous
    size = _force(plant)  # the friction coefficient that gives this force at 1 m/s
    quantity = INPUTS["viscous_friction"]
    return _positive("viscous", quantity, start or SMALL * size, 1e-6 * size, 10 * size, put)


def _travel(scenario: Scenario, plant: Plant) -> FitParameter:
    quantity = INPUTS["breakaway_travel"]

    def put(s: Scenario, p: Plant, value: float) -> Case:
        return _stated(s, bristle_travel=value), p

    start = scenario.friction.bristle_travel or plant.seals.bristle_travel
    return _positive("bristle_travel", quantity, start, quantity.lower, quantity.upper, put)


def _mass(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        return s, replace(p, mass=value)

    quantity = replace(INPUTS["load_mass"], label="mass of load, rod and piston")
    return _positive("mass", quantity, plant.mass, 0.01 * plant.mass, 100 * plant.mass, put)


def _dead(chamber: str) -> Callable[[Scenario, Plant], FitParameter]:
    field, area = f"dead_{chamber}", f"area_{chamber}"

    def entry(scenario: Scenario, plant: Plant) -> FitParameter:
        def put(s: Scenario, p: Plant, value: float) -> Case:
            return s, replace(p, **{field: value})  # type: ignore[arg-type]

        size = float(getattr(plant, area))
        label = f"dead volume of chamber {chamber.upper()}"
        quantity = replace(INPUTS["volume"], label=label)
        start, most = float(getattr(plant, field)), 10 * size * plant.stroke
        return _positive(f"dead_volume_{chamber}", quantity, start, LEAST_DEAD * size, most, put)

    return entry


def _offset(scenario: Scenario, plant: Plant) -> FitParameter:
    def put(s: Scenario, p: Plant, value: float) -> Case:
        force = (*s.load.force, ForceSignal(shape="constant", value=value))
        return s.model_copy(update={"load": s.load.model_copy(update={"force": force})}), p

    most = _force(plant)
    quantity = replace(SCENARIOS["force_value"], label="load force in addition to the stated one")
    return FitParameter("load_offset", quantity, 0.0, -most, most, False, SMALL * most, put)


_LEAKS = ("leakage_supply", "leakage_tank")
VALVE = ("valve_capacity", "valve_leakage", "valve_offset")
OIL = ("air_content", "bulk_modulus")
FRICTION = ("coulomb", "static", "stribeck_speed", "viscous", "bristle_travel")
PARAMETERS: dict[str, Callable[[Scenario, Plant], FitParameter]] = {
    "air_content": _air,
    "bulk_modulus": _bulk,
    "valve_capacity": _capacity,
    "valve_leakage": _valve_leakage,
    "valve_offset": _valve_offset,
    "piston_leakage": _leakage,
    "coulomb": _coulomb,
    "static": _static,
    "stribeck_speed": _stribeck_speed,
    "viscous": _viscous,
    "bristle_travel": _travel,
    "mass": _mass,
    "dead_volume_a": _dead("a"),
    "dead_volume_b": _dead("b"),
    "load_offset": _offset,
}
"""Parameters by name. The time shift of the record, `lag`, is not among them. The fitted values of
`coulomb` and `static` are the friction at the initial pressures; the relative change with pressure
stays that of the design."""
