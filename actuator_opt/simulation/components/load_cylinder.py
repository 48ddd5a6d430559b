"""A load cylinder with its own valve, which loads the rod on a test bench."""

from __future__ import annotations

from ...base.quantities import INPUTS, SCENARIOS
from ...base.symbolic import Expression, Symbol
from ...design.scenario.model import LoadCylinder
from ...evaluation.springs import Give
from ...models import forces
from ...models.valve import edge_coefficient, viscosity_corrected
from ...studies.plant import ValveData
from . import chambers, valve
from .circuit import Circuit

WHOSE = "load_"


def push(circuit: Circuit, stated: LoadCylinder, *, position: Symbol, speed: Symbol) -> Expression:
    """Force of the load cylinder on the rod, outwards [N]; both rods move together."""
    system = circuit.system
    area = float(forces.annulus_area(bore=stated.bore, rod_diameter=stated.rod_diameter))
    middle = 0.5 * (stated.supply_pressure + stated.return_pressure)
    half = 0.5 * stated.force / area
    a = system.pressure(f"{WHOSE}pressure a", middle + half)
    b = system.pressure(f"{WHOSE}pressure b", middle - half)
    data = _data(stated, circuit.plant.oil.kinematic_viscosity)
    opening = valve.spool(circuit, data, circuit.course(stated.signal), WHOSE)
    flows = valve.edges(
        circuit,
        data,
        opening=opening,
        supply_pressure=stated.supply_pressure,
        return_pressure=stated.return_pressure,
        pressure_a=a,
        pressure_b=b,
        whose=WHOSE,
    )
    given = stated.supply_pressure * flows.supply - stated.return_pressure * flows.tank
    circuit.door("supply of the load cylinder", given, state=f"{WHOSE}supply work", into=True)
    dead = chambers.dead_volume(circuit, stated.dead_volume, area, "load cylinder")
    pushed = chambers.cylinder(
        circuit,
        pressure_a=a,
        pressure_b=b,
        inflow_a=flows.into_a,
        inflow_b=flows.into_b,
        position=position + (0.5 * stated.stroke - circuit.start.position),
        speed=speed,
        area_a=area,
        area_b=area,
        stroke=stated.stroke,
        dead_a=dead,
        dead_b=dead,
        walls=Give(),
        flexibility=0.0,
        of=" of the load cylinder",
    )
    pressures = INPUTS["pressure"]
    system.signal(f"{WHOSE}pressure_a", "pressure of the load cylinder, side A", pressures, a)
    system.signal(f"{WHOSE}pressure_b", "pressure of the load cylinder, side B", pressures, b)
    force = SCENARIOS["force_value"]
    system.signal("load_cylinder_force", "force of the load cylinder", force, pushed)
    return pushed


def _data(stated: LoadCylinder, viscosity: float) -> ValveData:
    """Edges of its valve, with the oil of the design."""
    own = stated.valve
    after = own.leakage_drop if own.tank_leakage_drop is None else own.tank_leakage_drop

    def coefficient(flow: float, drop: float) -> float:
        return float(edge_coefficient(flow=flow, pressure_drop=drop))

    rated = coefficient(own.rated_flow, own.rated_drop)
    if own.rated_viscosity is not None:
        corrected = viscosity_corrected(
            coefficient=rated, rated_viscosity=own.rated_viscosity, viscosity=viscosity
        )
        rated = float(corrected)
    return ValveData(
        rated=rated,
        leakage_supply=coefficient(own.leakage_flow, own.leakage_drop),
        leakage_tank=coefficient(own.leakage_flow, after),
        signal=own.signal,
        natural_frequency=own.natural_frequency,
        damping_ratio=own.damping_ratio,
        offset=own.offset,
    )
