"""Steady temperatures of oil, wall and rod while duty cycles repeat without end.

A cycle is much shorter than the time in which the actuator warms up, so heat enters as the mean of
a cycle. Cap and head are left out, and so is conduction along the wall: both are on the hot side.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import pi
from typing import NamedTuple

from ...base.numeric import Array, minimum, real, where
from ...design.model import Design
from ...models import heat_transfer, thermal_network
from ...models.thermal_network import (
    OilNode,
    SteadyTemperatures,
    Surroundings,
    ThermalLayer,
    ThermalNetwork,
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


class ThermalState(NamedTuple):
    """Network of the actuator under a cycle, or the mean of all, and its steady state."""

    network: ThermalNetwork
    steady: SteadyTemperatures
    oil: Mapping[str, Array]
    """Density and specific heat of the oil, SI."""
    supplied: Array
    """Temperature of the oil from the supply [K]."""


class ThermalPlace(NamedTuple):
    """A place whose temperature is known, and the materials that it must not damage."""

    name: str
    materials: tuple[str, ...]


def thermal_places(design: Design) -> list[ThermalPlace]:
    """Inside of every layer, oil, and the seals of piston and rod."""
    layers = enumerate(design.barrel.layup, 1)
    places = [ThermalPlace(f"layer {k} ({ply.material})", (ply.material,)) for k, ply in layers]
    places.append(ThermalPlace("oil", (design.fluid.material,)))
    for block in ("piston", "rod"):
        elements = getattr(design.seals, block).elements().values()
        compounds = dict.fromkeys(element.compound for element in elements)
        places.append(ThermalPlace(f"{block} seal", tuple(compounds)))
    return places


def temperatures_of(network: ThermalNetwork, nodes: Sequence[Array]) -> list[Array]:
    """Temperatures of the `thermal_places` from those of the nodes [K].

    A piston seal is as warm as the innermost layer, a rod seal as the rod.
    """
    count = len(network.layers)
    oil, layers, rod = nodes[0], nodes[1 : count + 1], nodes[count + 1]
    faces = thermal_network.inner_faces(network=network, oil=oil, layers=layers)
    return [*faces, oil, layers[0], rod]


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    results: Mapping[Place, Array],
    tank: Array | None,
    out: MetricArrays,
) -> None:
    """Compute steady temperatures; `tank` is that of the oil in the tank, None: as stated."""
    missing = _missing(design, stock)
    if missing:
        for name in METRICS:
            out.skip(name, f"not known: {', '.join(missing)}")
        return
    oil: dict[str, Array] = {}
    wall: dict[str, Array] = {}
    seal: dict[str, Array] = {}
    spare: dict[str, Array] = {}
    for name, state in states(v, design, stock, g, results, tank):
        temperatures = temperatures_of(state.network, state.steady.nodes)
        for place, temperature in zip(thermal_places(design), temperatures, strict=True):
            label = f"{name}, {place.name}"
            if place.name == "oil":
                oil[name] = temperature
            elif place.name.endswith(" seal"):
                seal[label] = temperature
            else:
                wall[label] = temperature
            for material in place.materials:
                words = f"{label} ({material})" if place.name.endswith(" seal") else label
                spare |= _spare(stock, material, words, temperature)
    for metric, values in zip(METRICS, (oil, wall, seal, spare), strict=True):
        if values:
            out.put(metric, values)
        else:
            out.skip(metric, "no material states a highest temperature")


def states(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    results: Mapping[Place, Array],
    tank: Array | None,
) -> Iterator[tuple[str, ThermalState]]:
    """Yield the steady state of every cycle, or of their mean; none if properties are missing."""
    if _missing(design, stock):
        return
    supplied = tank
    if supplied is None:
        supplied = v.get("duty.oil_supply", None)
        supplied = v["fluid.temperature"] if supplied is None else supplied
    for name, heats in _each(v, design, results):
        yield name, _steady(v, design, stock, g, heats, supplied)


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
    fills = real(total["inlet_volume"]) > 0  # at rest no oil flows in
    volume = where(fills, total["inlet_volume"], 1.0)
    return _Heats(
        piston=total["piston"] / time,
        rod=total["rod"] / time,
        speed=total["way"] / time,
        position=mean["position_mean"],
        exchange=mean["exchange_a"] + mean["exchange_b"],
        inlet_drop=where(fills, total["inlet_heat"], 0.0) / volume,
    )


def _steady(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    heats: _Heats,
    supplied: Array,
) -> ThermalState:
    """Steady state under the mean heat of a cycle."""
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
    network = thermal_network.thermal_network(
        bore=g.bore,
        length=g.wall_length,
        wetted_length=minimum(g.stroke, g.wall_length),
        oil=node,
        layers=layers,
        parts=[_rod(design, stock, g, heats, film, friction.rod)],
    )
    steady = thermal_network.steady_temperatures(
        network=network,
        surroundings=Surroundings(
            temperature=v["duty.ambient"],
            air_speed=v["duty.air_speed"],
            emissivity=v["duty.emissivity"],
        ),
    )
    return ThermalState(network, steady, oil, supplied)


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
