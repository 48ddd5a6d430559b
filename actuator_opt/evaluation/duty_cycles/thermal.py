"""Steady temperatures of oil, wall and rod while duty cycles repeat without end.

A cycle is much shorter than the time in which the actuator warms up, so heat enters as the mean of
a cycle. Cap and head are left out, and so is conduction along the wall: both are on the hot side.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi
from typing import NamedTuple

from ...base.numeric import Array, minimum
from ...design.model import Design
from ...models import heat_transfer, thermal_network
from ...models.thermal_network import (
    OilNode,
    SteadyTemperatures,
    Surroundings,
    ThermalLayer,
    ThermalPart,
)
from ..geometry import Geometry
from ..limits import MaterialValues, MetricArrays
from ..values import Values
from .results import Place

METRICS = (
    "duty_oil_temperature",
    "duty_wall_temperature",
    "duty_seal_temperature",
    "duty_temperature_margin",
)
MEAN = "mean of all cycles"


class _Heats(NamedTuple):
    """Means over time of one cycle, or of all cycles of a life."""

    piston: Array
    """Friction power of the piston's seals [W]."""
    rod: Array
    """Friction power of the rods' seals [W]."""
    speed: Array
    """Way of the piston by time [m/s]."""
    position: Array
    exchange: Array
    """Flow of fresh oil into both chambers [m^3/s]."""
    inlet_drop: Array
    """Pressure drop of the oil on its way in, weighted with the flow [Pa]."""


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    results: Mapping[Place, Array],
    supplied: Array | None,
    out: MetricArrays,
) -> None:
    """Compute steady temperatures; `supplied` is that of the tank, None: as stated."""
    missing = _missing(design, stock)
    if missing:
        for name in METRICS:
            out.skip(name, f"not known: {', '.join(missing)}")
        return
    assert design.duty is not None
    if supplied is None:
        supplied = v.get("duty.oil_supply", None)
        supplied = v["fluid.temperature"] if supplied is None else supplied
    oil: dict[str, Array] = {}
    wall: dict[str, Array] = {}
    seal: dict[str, Array] = {}
    spare: dict[str, Array] = {}
    for name, heats in _each(v, design, results):
        state = _steady(v, design, stock, g, heats, supplied)
        oil[name] = state.oil
        seal[f"{name}, piston seal"] = state.layers[0]
        seal[f"{name}, rod seal"] = state.parts[0]
        for k, (ply, face) in enumerate(zip(design.barrel.layup, state.faces, strict=True)):
            place = f"{name}, layer {k + 1} ({ply.material})"
            wall[place] = face
            spare |= _spare(stock, ply.material, place, face)
        spare |= _spare(stock, design.fluid.material, f"{name}, oil", state.oil)
        for block, place in (("piston", state.layers[0]), ("rod", state.parts[0])):
            for element in getattr(design.seals, block).elements().values():
                label = f"{name}, {block} seal ({element.compound})"
                spare |= _spare(stock, element.compound, label, place)
    for metric, values in zip(METRICS, (oil, wall, seal, spare), strict=True):
        if values:
            out.put(metric, values)
        else:
            out.skip(metric, "no material states a highest temperature")


def _spare(
    stock: MaterialValues, material: str, place: str, temperature: Array
) -> dict[str, Array]:
    """Highest temperature of a material minus its temperature, if the library states it."""
    most = stock.get(material, "temperature_max")
    return {} if most is None else {place: most - temperature}


def _missing(design: Design, stock: MaterialValues) -> list[str]:
    """Properties that the model needs and the library does not state."""
    needed: list[tuple[str, tuple[str, ...]]] = [
        (design.fluid.material, ("thermal_conductivity", "specific_heat"))
    ]
    for ply in design.barrel.layup:
        keys = stock.material(ply.material).through_wall
        if stock.get(ply.material, *keys) is None:
            needed.append((ply.material, keys[:1]))
        needed.append((ply.material, ("specific_heat",)))
    rod = design.rod.layup[0].material if design.rod.layup else design.rod.material
    needed.append((rod, ("specific_heat",)))
    return [
        f"materials.{material}.{key}"
        for material, keys in dict.fromkeys(needed)
        for key in keys
        if stock.get(material, key) is None
    ]


def _each(
    v: Values, design: Design, results: Mapping[Place, Array]
) -> Iterator[tuple[str, _Heats]]:
    """Means of every cycle, or of all cycles weighted with their time in a life."""
    duty = design.duty
    assert duty is not None
    at: dict[str, dict[str, Array]] = {}
    for place, value in results.items():
        if place.name == "seal_friction_energy":
            key = "piston" if place.place.startswith("piston") else "rod"
            own = at.setdefault(place.cycle, {})
            own[key] = own.get(key, 0.0) + value
        elif not place.place:
            at.setdefault(place.cycle, {})[place.name] = value
    counts = {c.name: c.repeats for c in duty.cycles if c.repeats is not None}
    cycles = [cycle.name for cycle in duty.cycles]
    if duty.thermal == "worst" or not counts:
        for name in cycles:
            yield name, _heats({key: at[name].get(key, 0.0) for key in _SUMMED}, at[name])
        return
    times = {n: v[f"duty.cycles[{n}].repeats"] * at[n]["duration"] for n in counts}
    time = v["duty.standby"] + sum(times.values())
    total = {
        key: sum(v[f"duty.cycles[{n}].repeats"] * at[n].get(key, 0.0) for n in counts)
        for key in _SUMMED
    }
    mean = {key: sum(times[n] * at[n][key] for n in counts) / sum(times.values()) for key in _MEANS}
    moving = sum(times.values()) / time
    mean |= {key: moving * mean[key] for key in ("exchange_a", "exchange_b")}
    yield MEAN, _heats(total, mean | {"duration": time})


_SUMMED = ("piston", "rod", "way", "inlet_heat", "inlet_volume")
_MEANS = ("position_mean", "exchange_a", "exchange_b")


def _heats(total: Mapping[str, Array], mean: Mapping[str, Array]) -> _Heats:
    time = mean["duration"]
    return _Heats(
        piston=total["piston"] / time,
        rod=total["rod"] / time,
        speed=total["way"] / time,
        position=mean["position_mean"],
        exchange=mean["exchange_a"] + mean["exchange_b"],
        inlet_drop=total["inlet_heat"] / total["inlet_volume"],
    )


def _steady(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    heats: _Heats,
    supplied: Array,
) -> SteadyTemperatures:
    """Steady temperatures under the mean heat of a cycle."""
    name = design.fluid.material
    oil = {
        "density": stock.get(name, "density"),
        "specific_heat": stock.get(name, "specific_heat"),
    }
    film = heat_transfer.oil_film_coefficient(
        speed=heats.speed,
        diameter=g.bore,
        length=g.stroke / 2,
        conductivity=stock.get(name, "thermal_conductivity"),
        **oil,
    )
    friction = heat_transfer.friction_heat(piston_seal=heats.piston, rod_seal=heats.rod)
    rise = heat_transfer.throttle_temperature_rise(pressure_drop=heats.inlet_drop, **oil)
    volume = (g.area_a + g.area_b) * g.stroke / 2 + v["cylinder.dead_volume_a"]
    node = OilNode(
        film_coefficient=film,
        heat_capacity=oil["density"] * oil["specific_heat"] * volume,
        heat=friction.oil,
        exchange_conductance=heat_transfer.oil_exchange_conductance(
            exchange_flow=heats.exchange, **oil
        ),
        inlet_temperature=supplied + rise,
    )
    layers = []
    for k, (ply, thickness) in enumerate(zip(design.barrel.layup, g.thicknesses, strict=True)):
        layers.append(
            ThermalLayer(
                thickness=thickness,
                conductivity=stock.get(ply.material, *stock.material(ply.material).through_wall),
                volumetric_heat=stock.get(ply.material, "density")
                * stock.get(ply.material, "specific_heat"),
                heat=friction.layer + friction.head if k == 0 else 0.0,
            )
        )
    return thermal_network.steady_temperatures(
        network=thermal_network.thermal_network(
            bore=g.bore,
            length=g.wall_length,
            wetted_length=minimum(g.stroke, g.wall_length),
            oil=node,
            layers=layers,
            parts=[_rod(design, stock, g, heats, film, friction.rod)],
        ),
        surroundings=Surroundings(
            temperature=v["duty.ambient"],
            air_speed=v["duty.air_speed"],
            emissivity=v["duty.emissivity"],
        ),
    )


def _rod(
    design: Design, stock: MaterialValues, g: Geometry, heats: _Heats, film: Array, heat: Array
) -> ThermalPart:
    """The rod: in oil over its mean length in the chamber, in air over its mean free length."""
    name = design.rod.layup[0].material if design.rod.layup else design.rod.material
    around = pi * g.rod_diameter
    section = pi / 4 * (g.rod_diameter**2 - g.rod_inner_diameter**2)
    capacity = stock.get(name, "density") * stock.get(name, "specific_heat")
    return ThermalPart(
        oil_conductance=film * around * (g.stroke - heats.position),
        area=around * (heats.position + g.rod_extension),
        diameter=g.rod_diameter,
        heat_capacity=capacity * section * g.rod_length,
        heat=heat,
    )
