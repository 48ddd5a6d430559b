"""Values on which a simulation is based, each with its origin: a PATH or a model with its source.

They are read from the assembled circuit, so they are those of the equations. The terminal
(``simulate --explain``), the report and JSON all show this one list.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from ..base.dataclass import dataclass
from ..base.quantities import BASIS, Quantity
from ..base.tables import Displayed
from ..evaluation.spool import EDGES
from ..metrics.documentation import describe, function_of
from ..models import chamber
from ..models.lapped_spool import LappedSpool
from ..models.metering_curve import CurveSpool
from .components import motion
from .components.circuit import Circuit

_KEY = re.compile(r"\[\w+\]")
BAR = 1e5**0.5
"""Square root of 1 bar [sqrt(Pa)], at which the flow of a valve edge is shown."""


@dataclass(frozen=True, slots=True)
class BasisValue:
    """A value of the equations, SI."""

    name: str
    value: float
    paths: str = ""
    """PATHs of design or scenario that state the value, or the inputs of its model."""
    model: str = ""
    """Name of the model function that computes it, such as ``lugre.lugre_bristle_damping``."""

    @property
    def quantity(self) -> Quantity:
        """Unit and meaning of the value."""
        return BASIS[self.name]

    @property
    def origin(self) -> str:
        """Where the value comes from: PATHs, or the model with its source."""
        if not self.model:
            return self.paths
        keys = dict.fromkeys(_KEY.findall(describe(function_of(self.model)).reference))
        model = " ".join((self.model, *keys))
        return f"{model} of {self.paths}" if self.paths else model


@dataclass(frozen=True, slots=True)
class Basis(Displayed):
    """All values on which a simulation is based."""

    values: tuple[BasisValue, ...]

    @property
    def in_short(self) -> tuple[str, str]:
        """The number of values."""
        return "basis of the simulation", f"{len(self.values)} values"

    def to_dict(self) -> dict[str, Any]:
        """Value, SI unit, label and origin of each value by name, as plain data for JSON."""
        return {
            x.name: {
                "value": x.value,
                "unit": x.quantity.si_unit,
                "label": x.quantity.label,
                "origin": x.origin,
            }
            for x in self.values
        }


def basis(circuit: Circuit) -> Basis:
    """Collect the values of an assembled circuit."""
    parts = [*_supply(circuit), *_oil(circuit)]
    if circuit.scenario.motor is not None:
        parts = [*_motor(circuit), *parts]
    elif circuit.scenario.held_ports is None:
        parts = [*_masses(circuit), *_chambers(circuit), *parts, *_pressures(circuit)]
        parts += [*_losses(circuit), *_stops(circuit)]
    return Basis((*parts, *_valve(circuit)))


def _stated(value: object, path: str, default: str) -> str:
    """The PATH, if the scenario states the value there; else the words for its default."""
    return default if value is None else path


def _of(circuit: Circuit, key: str, usual: str) -> str:
    """The PATH of a number in the block `ideal` of the design; without this block, other words."""
    return usual if circuit.plant.design.ideal is None else f"ideal.{key}"


def _masses(circuit: Circuit) -> Iterator[BasisValue]:
    plant, start = circuit.plant, circuit.start
    load = plant.design.load.mass
    yield BasisValue("load_mass", load, "load.mass")
    own = _of(circuit, "mass", "dimensions and materials of these parts")
    yield BasisValue("part_mass", plant.mass - load, own)
    moving, sum_of = plant.moving_mass(start.position), "load_mass + part_mass"
    if plant.design.linkage is not None:
        inertia, model = moving - plant.mass, "linkage.reflected_inertia"
        yield BasisValue("joint_mass", inertia, "load.inertia, linkage", model)
        sum_of += " + joint_mass"
    yield BasisValue("moving_mass", moving, sum_of)


def _chambers(circuit: Circuit) -> Iterator[BasisValue]:
    plant, start = circuit.plant, circuit.start
    volumes = circuit.volumes
    initial, mid = circuit.scenario.initial, "mid-stroke (initial.position)"
    yield BasisValue("stroke", plant.stroke, _of(circuit, "stroke", "cylinder.stroke"))
    place = _stated(initial.position, "initial.position", mid)
    yield BasisValue("start_position", start.position, place)
    second = ", second_rod.outer_diameter" if plant.design.double_rod else ""
    whole = _of(circuit, "area_a", f"cylinder.bore{second}")
    yield BasisValue("area_a", plant.area_a, whole)
    annulus = _of(circuit, "area_b", "cylinder.bore, rod.outer_diameter")
    yield BasisValue("area_b", plant.area_b, annulus)
    if volumes is None:
        return
    walls, ends = volumes.walls, (start.position, plant.stroke - start.position)
    for name, dead, area, column in (
        ("a", volumes.dead_a, plant.area_a, ends[0]),
        ("b", volumes.dead_b, plant.area_b, ends[1]),
    ):
        own = _of(circuit, f"dead_volume_{name}", f"cylinder.dead_volume_{name}")
        yield BasisValue(f"dead_volume_{name}", dead, f"{own}, lines")
        swept = f"dead_volume_{name} + area x travel to the end"
        yield BasisValue(f"volume_{name}", dead + area * column, swept)
    rigid = plant.design.ideal is not None
    at = "lumped lines; walls are rigid (ideal)" if rigid else "barrel, caps, lines; stiffness"
    yield BasisValue("wall_compliance_a", walls.a0 + walls.a1 * ends[0], at)
    yield BasisValue("wall_compliance_b", walls.b0 + walls.b1 * ends[1], at)
    if walls.c0 or walls.c1:
        yield BasisValue("wall_coupling", walls.c0 + walls.c1 * ends[0], at)
    if plant.flexibility > 0:
        rod = _of(circuit, "stiffness", "rod, mount; stiffness")
        yield BasisValue("rod_stiffness", 1 / plant.flexibility, rod)


def _supply(circuit: Circuit) -> Iterator[BasisValue]:
    yield BasisValue("supply_pressure", circuit.plant.supply_pressure, "supply.pressure")
    yield BasisValue("return_pressure", circuit.plant.return_pressure, "supply.return_pressure")


def _oil(circuit: Circuit) -> Iterator[BasisValue]:
    oil = circuit.plant.oil
    material = f"materials.{circuit.plant.design.fluid.material}"
    yield BasisValue("oil_temperature", oil.temperature, "first load case; fluid.temperature")
    yield BasisValue("oil_modulus", oil.bulk_modulus, f"{material}; fluid")
    yield BasisValue("air_content", oil.air_content, "fluid.air_content")
    yield BasisValue("oil_density", oil.density, material)
    yield BasisValue("oil_viscosity", oil.kinematic_viscosity, material)


def _pressures(circuit: Circuit) -> Iterator[BasisValue]:
    """Pressures at the start, with modulus and air of the oil there."""
    oil, start, initial = circuit.plant.oil, circuit.start, circuit.scenario.initial
    for name in ("a", "b"):
        pressure, stated = getattr(start, f"pressure_{name}"), getattr(initial, f"pressure_{name}")
        model = "stiffness.holding_pressures" if stated is None else ""
        path = _stated(stated, f"initial.pressure_{name}", "load.force, supply.pressure")
        yield BasisValue(f"start_pressure_{name}", pressure, path, model)
        modulus = float(chamber.mixture_bulk_modulus(pressure=pressure, **oil.law))
        yield BasisValue(f"modulus_{name}", modulus, "fluid", "chamber.mixture_bulk_modulus")
        ratio = float(chamber.density_ratio(pressure=pressure, **oil.law))
        pure = float(chamber.density_ratio(pressure=pressure, **(oil.law | {"air_content": 0.0})))
        share = 1 - ratio / ((1 + oil.air_content) * pure)  # air/(oil + air) of `density_ratio`
        yield BasisValue(f"air_share_{name}", share, "fluid.air_content", "chamber.density_ratio")


def _losses(circuit: Circuit) -> Iterator[BasisValue]:
    """Leakage across the piston, shear of the oil, and friction of the seals."""
    plant, stated, curve = circuit.plant, circuit.scenario.friction, circuit.friction
    ideal = plant.design.ideal is not None
    leak = "piston.leakage_conductance, or gap and film of the piston seal"
    yield BasisValue("piston_leakage", plant.leakage, _of(circuit, "leakage", leak))
    shear = "none (ideal)" if ideal else "metrics damping_pipe + damping_annular"
    yield BasisValue("oil_damping", plant.oil_damping, shear)
    if curve is None:
        return
    if stated.model != "none":
        own = "no seals (ideal)" if ideal else "friction of seals and wipers in the design"
        levels = motion.levels_at(curve, circuit.start)
        given = _stated(stated.coulomb, "friction.coulomb", own)
        yield BasisValue("coulomb_friction", levels[0], given)
        path = given if stated.static is None else "friction.static"
        yield BasisValue("static_friction", levels[1], path)
        speed = "1 mm/s, as friction.stribeck_speed is not stated"
        speed = own if stated.coulomb is None else speed
        path = _stated(stated.stribeck_speed, "friction.stribeck_speed", speed)
        yield BasisValue("stribeck_speed", curve.stribeck_speed, path)
    viscous = "seals.piston.viscous_friction, seals.rod.viscous_friction"
    viscous = "no seals (ideal)" if ideal else viscous
    viscous = viscous if stated.coulomb is None else "0, as friction.viscous is not stated"
    path = _stated(stated.viscous, "friction.viscous", viscous)
    yield BasisValue("viscous_friction", curve.viscous, path)
    if stated.model == "lugre":
        travel = _stated(
            stated.bristle_travel, "friction.bristle_travel", "stiffness.seal_deflection"
        )
        model = "lugre.lugre_bristle_stiffness"
        yield BasisValue("bristle_stiffness", curve.bristle_stiffness, travel, model)
        model = "" if stated.bristle_damping is not None else "lugre.lugre_bristle_damping"
        path = _stated(stated.bristle_damping, "friction.bristle_damping", "moving_mass")
        yield BasisValue("bristle_damping", curve.bristle_damping, path, model)
        if curve.taper_speed is not None:
            share = f"friction and its damping, times {motion.TAPER:g} (our choice)"
            yield BasisValue("taper_speed", curve.taper_speed, share, "lugre.lugre_passive_speed")


def _stops(circuit: Circuit) -> Iterator[BasisValue]:
    stiffness, damping = motion.stop_law(circuit)
    inputs = "cylinder.stop_travel, supply.pressure"
    yield BasisValue("stop_stiffness", stiffness, inputs, "end_stop.stop_stiffness")
    yield BasisValue("stop_damping", damping, "stops.damping", "end_stop.stop_damping")


def _motor(circuit: Circuit) -> Iterator[BasisValue]:
    motor = circuit.scenario.motor
    assert motor is not None
    yield BasisValue("displacement", motor.machine.displacement, "motor.machine.displacement")
    yield BasisValue("motor_inertia", motor.inertia, "motor.inertia")
    yield BasisValue("pipe_volume", motor.pipe_volume, "motor.pipe_volume")


def _valve(circuit: Circuit) -> Iterator[BasisValue]:
    data, model = circuit.plant.valve, "valve.edge_coefficient"
    if data is None or not circuit.driven:
        return
    if data.rated > 0:  # the edges' flow coefficients of the course's law
        rated, leak = "valve.rated_flow, valve.rated_drop", "valve.leakage_flow, valve.leakage_drop"
        yield BasisValue("edge_flow", data.rated * BAR, rated, model)
        yield BasisValue("supply_leakage", data.leakage_supply * BAR, leak, model)
        yield BasisValue("tank_leakage", data.leakage_tank * BAR, leak, model)
    if isinstance(data.metering, LappedSpool):
        yield from _lapped(data.metering)
    if isinstance(data.metering, CurveSpool):
        stated = "valve.flow_curve, valve.edge_coefficients"
        for name, edge in EDGES.items():
            full = float(getattr(data.metering, name).coefficient(1.0)) * BAR
            yield BasisValue(f"edge_flow_{edge}", full, stated, "metering_curve.curve_value")
    for name, volts in zip(("threshold", "hysteresis"), data.bands, strict=False):
        yield BasisValue(f"valve_{name}", volts, f"valve.{name}", "play.play_half_widths")
    if data.slew_rate is not None:
        yield BasisValue("spool_slew_rate", data.slew_rate, "valve.slew_rate")
    yield BasisValue("full_signal", data.signal, "valve.signal")
    yield BasisValue("spool_offset", data.offset, "valve.offset")
    yield BasisValue("spool_frequency", data.natural_frequency, "valve.natural_frequency")
    yield BasisValue("spool_damping", data.damping_ratio, "valve.damping_ratio")


def _lapped(spool: LappedSpool) -> Iterator[BasisValue]:
    """Stroke of a lapped spool, and its edge from the supply to port A."""
    edge, stated = spool.supply_a, "valve.rated_flow, valve.spool.area_gradient"
    width = float(edge.area_gradient)
    yield BasisValue("edge_width", width, stated, "lapped_edge.lapped_edge_flow")
    yield BasisValue("edge_overlap", float(edge.overlap), "valve.spool.overlap")
    if edge.clearance is not None:
        yield BasisValue("edge_clearance", float(edge.clearance), "valve.spool.clearance")
    yield BasisValue("edge_stroke", float(spool.stroke), "valve.spool.stroke")
