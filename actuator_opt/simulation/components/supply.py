"""Supply of the valve: constant pressure, or a pump with its supply line."""

from __future__ import annotations

from ...base.dataclass import dataclass
from ...base.kinds import per_kind
from ...base.numeric import clip, where
from ...base.quantities import INPUTS, SCENARIOS
from ...base.symbolic import Expression, Symbol
from ...design.scenario.kinds import SUPPLIES
from ...models import accumulator, elements, lines, supply, wilson
from .chambers import node
from .circuit import Circuit

RATE_BAND = 1e-3
"""Distance from the ends of the swash plate's range, as a share of the largest flow, over which the
plate is slowed to a stop (our choice)."""
AWAKE = 0.1
"""Pump flow at which the search for an equilibrium starts, as a share of the largest flow (our
choice). At an end of its range, the swash plate does not respond to pressure, so a search cannot
start there."""


@dataclass(slots=True)
class SupplyBuilder:
    """Supply under construction: `of` creates its pressures, `feed` connects the valve to it."""

    circuit: Circuit
    pressure: Expression
    """Pressure at the valve."""
    unit: Expression
    """Pressure at the pump or accumulator."""

    @classmethod
    def of(cls, circuit: Circuit) -> SupplyBuilder:
        """Create the pressures at pump and valve.

        They differ if a line lies between pump and valve.
        """
        stated, system = circuit.scenario.supply, circuit.system
        unit: Expression = circuit.plant.supply_pressure
        initial = unit
        if SUPPLIES[stated.type].pumps:
            unit = system.pressure("supply", unit)
        else:
            initial = unit = circuit.value("supply.pressure", unit)
        port = unit
        if stated.line is not None:
            port = system.pressure("valve port", initial)
        return cls(circuit, port, unit)

    def feed(self, demand: Expression, tank: Expression) -> None:
        """Add the equations of the supply.

        `demand` is the flow to the valve, `tank` the return flow.
        """
        circuit = self.circuit
        circuit.energy_port("return line", circuit.return_pressure * tank, state="return work")
        circuit.system.signal(
            "pressure_supply", "supply pressure", INPUTS["pressure"], self.pressure
        )
        taken = self._through_line(demand)
        if SUPPLIES[circuit.scenario.supply.type].pumps:
            self._pumped(taken)
        else:
            circuit.energy_port("supply", self.unit * taken, state="supply work", into=True)

    def _through_line(self, demand: Expression) -> Expression:
        """Flow from the pump into the supply line.

        The oil volume of the line is lumped at its valve end.
        """
        circuit, line = self.circuit, self.circuit.scenario.supply.line
        if line is None:
            return demand
        system, oil = circuit.system, circuit.plant.oil
        size = {"inner_diameter": line.inner_diameter, "length": line.length}
        inertance = elements.inertance(**size, density=oil.density)
        flow = system.state("supply pipe", 0.0, tolerance=1e-12)
        stream = {"density": oil.density, "dynamic_viscosity": oil.dynamic_viscosity}
        drop = lines.line_pressure_drop(flow=flow, **size, **stream)
        system.rate(flow, (self.unit - self.pressure - drop) / inertance)
        circuit.energy_port("supply pipe", drop * flow, state="supply pipe loss")
        motion = 0.5 * inertance * flow * flow
        circuit.audit.stored.append(("oil in motion in the supply pipe", motion))
        system.signal("pressure_unit", "pressure at the pump", INPUTS["pressure"], self.unit)
        system.signal("flow_unit", "flow into the supply pipe", _FLOW, flow)
        volume = float(lines.line_volume(**size))
        assert isinstance(self.pressure, Symbol)
        node(circuit, "supply pipe", self.pressure, inflow=flow - demand, volume=volume)
        return flow

    def _pumped(self, demand: Expression) -> None:
        circuit, unit = self.circuit, self.circuit.scenario.supply
        assert unit.volume is not None
        delivered = DELIVERIES[unit.type](self)
        pressure = self.unit
        circuit.energy_port("supply", pressure * delivered, state="supply work", into=True)
        relieved: Expression = 0.0
        if unit.relief is not None:
            relieved = supply.relief_flow(
                pressure_difference=pressure - circuit.return_pressure,
                cracking_pressure=unit.relief.pressure,
                override=unit.relief.override,
                rated_flow=unit.relief.rated_flow,
            )
            circuit.energy_port("relief valve", pressure * relieved, state="relief loss")
            circuit.system.signal("flow_relief", "flow of the relief valve", _FLOW, relieved)
        stored = self._accumulator()
        circuit.system.signal("flow_pump", "flow of the pump", _FLOW, delivered)
        assert isinstance(pressure, Symbol)
        inflow = delivered - relieved - demand - stored
        node(circuit, "supply line", pressure, inflow=inflow, volume=unit.volume)

    def _accumulator(self) -> Expression:
        """Flow into the accumulator on the supply line."""
        circuit, stated = self.circuit, self.circuit.scenario.supply.accumulator
        if stated is None:
            return 0.0
        system, plant = circuit.system, circuit.plant
        filled = accumulator.gas_volume_at(  # slow at first, then fast about the equilibrium
            pressure=plant.supply_pressure,
            precharge_pressure=stated.precharge,
            gas_volume=stated.gas_volume,
        )
        begin = max(plant.supply_pressure, stated.precharge)
        gas = system.state("gas volume", float(filled), tolerance=1e-9 * stated.gas_volume)
        gas_pressure = accumulator.gas_pressure(
            volume=gas,
            precharge_pressure=begin,
            gas_volume=float(filled),
            polytropic_index=plant.oil.polytropic_index,
        )
        neck = elements.resistance(
            inner_diameter=NECK, length=NECK, dynamic_viscosity=plant.oil.dynamic_viscosity
        )
        flow = (self.unit - gas_pressure) / neck
        full = clip((stated.gas_volume - gas) / (1e-4 * stated.gas_volume), 0.0, 1.0)
        flow = where(flow < 0, flow * full, flow)
        system.rate(gas, -flow)
        circuit.energy_port(
            "accumulator neck", (self.unit - gas_pressure) * flow, state="neck loss"
        )
        circuit.energy_port("accumulator", gas_pressure * flow)
        system.signal(
            "pressure_accumulator",
            "gas pressure of the accumulator",
            INPUTS["pressure"],
            gas_pressure,
        )
        return flow


def _fixed_pump(source: SupplyBuilder) -> Expression:
    """Flow of a pump of constant speed into the line."""
    circuit = source.circuit
    unit, system, plant = circuit.scenario.supply, circuit.system, circuit.plant
    if unit.pump is None:
        assert unit.flow is not None
        return unit.flow
    machine = unit.pump
    difference = source.unit - circuit.return_pressure
    common = {
        "speed": machine.shaft_speed,
        "pressure_difference": difference,
        "displacement": machine.displacement,
        "dynamic_viscosity": plant.oil.dynamic_viscosity,
        "setting": machine.setting,
    }
    torque = wilson.pump_torque(
        **common,
        coulomb_coefficient=machine.coulomb,
        viscous_coefficient=machine.viscous,
        constant_torque=machine.constant_torque,
    )
    system.signal("pump_torque", "torque of the pump", SCENARIOS["torque_value"], torque)
    return wilson.pump_flow(**common, slip_coefficient=machine.slip)


def _controlled_pump(source: SupplyBuilder) -> Expression:
    """Flow of a pressure-controlled pump into the line."""
    circuit = source.circuit
    unit, system, plant = circuit.scenario.supply, circuit.system, circuit.plant
    assert unit.flow is not None
    assert unit.gain is not None
    assert unit.time_constant is not None
    initial = AWAKE * unit.flow if circuit.linear else 0.0
    state = system.state("pump", initial, tolerance=1e-6 * unit.flow)
    rate = supply.controlled_pump_rate(
        flow=state,
        pressure=source.unit,
        set_pressure=plant.supply_pressure,
        gain=unit.gain,
        time_constant=unit.time_constant,
    )
    band = RATE_BAND * unit.flow
    closing = clip(state / band, 0.0, 1.0)
    opening = clip((unit.flow - state) / band, 0.0, 1.0)
    system.rate(state, where(rate < 0, rate * closing, rate * opening))
    return supply.controlled_pump_delivery(flow=state, largest_flow=unit.flow)


DELIVERIES = per_kind(
    {name: kind for name, kind in SUPPLIES.items() if kind.pumps},
    {"fixed_pump": _fixed_pump, "controlled_pump": _controlled_pump},
)
"""Function that returns the pump flow, for every kind of pump."""

NECK = 5e-3
"""Bore and length of the neck of an accumulator on the supply line, both 5 mm (our choice)."""
_FLOW = SCENARIOS["flow_value"]
