"""What feeds the valve: constant pressure, or a pump with its line."""

from __future__ import annotations

from dataclasses import dataclass

from ...design.scenario.model import Scenario
from ...evaluation.study.plant import Plant
from ...models import accumulator, elements, lines, supply, wilson
from ...numeric import clip, where
from ...quantities import INPUTS, SCENARIOS
from ...symbolic import Expression, Symbol
from ..system import System
from .chambers import Audit, node

RATE_BAND = 1e-3
"""Share of the largest flow within which the swash plate comes to rest at its ends (a choice)."""


@dataclass(slots=True)
class Source:
    """The supply under construction: its pressures first, its demand when it is known."""

    system: System
    audit: Audit
    plant: Plant
    scenario: Scenario
    pressure: Expression
    """At the valve."""
    unit: Expression
    """At the pump or accumulator."""

    @classmethod
    def of(cls, system: System, audit: Audit, plant: Plant, scenario: Scenario) -> Source:
        """The pressures; a pipe between pump and valve parts them."""
        stated = scenario.supply
        unit: Expression = plant.supply_pressure
        if stated.type != "constant":
            unit = system.pressure("supply", plant.supply_pressure)
        port = unit
        if stated.line is not None:
            port = system.pressure("valve port", plant.supply_pressure)
        return cls(system, audit, plant, scenario, port, unit)

    def feed(self, demand: Expression, tank: Expression, power: float) -> None:
        """Close the supply with the flow that the valve takes; `tank` is what it returns."""
        plant, system = self.plant, self.system
        low = plant.return_pressure
        returned = system.integral("return work", low * tank, scale=power)
        self.audit.flows.append(("return line", returned, False))
        system.signal("pressure_supply", "supply pressure", INPUTS["pressure"], self.pressure)
        taken = self._through_line(demand, power)
        if self.scenario.supply.type == "constant":
            work = system.integral("supply work", self.unit * taken, scale=power)
            self.audit.flows.append(("supply", work, True))
            return
        self._pumped(taken, power)

    def _through_line(self, demand: Expression, power: float) -> Expression:
        """Flow out of the pump's side of the supply pipe; its oil springs at the valve."""
        line = self.scenario.supply.line
        if line is None:
            return demand
        system, oil = self.system, self.plant.oil
        size = {"inner_diameter": line.inner_diameter, "length": line.length}
        resistance = elements.resistance(**size, dynamic_viscosity=oil.dynamic_viscosity)
        inertance = elements.inertance(**size, density=oil.density)
        flow = system.state("supply pipe", 0.0, tolerance=1e-12)
        system.rate(flow, (self.unit - self.pressure - resistance * flow) / inertance)
        lost = system.integral("supply pipe loss", resistance * flow * flow, scale=power)
        self.audit.flows.append(("supply pipe", lost, False))
        self.audit.stored.append(
            ("oil in motion in the supply pipe", 0.5 * inertance * flow * flow)
        )
        volume = float(lines.line_volume(**size))
        assert isinstance(self.pressure, Symbol)
        node(
            system, self.audit, "supply pipe", oil, self.pressure,
            inflow=flow - demand, volume=volume,
        )  # fmt: skip
        return flow

    def _pumped(self, demand: Expression, power: float) -> None:
        unit, system, plant = self.scenario.supply, self.system, self.plant
        assert unit.volume is not None
        delivered = self._delivery()
        pressure = self.unit
        work = system.integral("supply work", pressure * delivered, scale=power)
        self.audit.flows.append(("supply", work, True))
        relieved: Expression = 0.0
        if unit.relief is not None:
            relieved = supply.relief_flow(
                pressure_difference=pressure - plant.return_pressure,
                cracking_pressure=unit.relief.pressure,
                override=unit.relief.override,
                rated_flow=unit.relief.rated_flow,
            )
            lost = system.integral("relief loss", pressure * relieved, scale=power)
            self.audit.flows.append(("relief valve", lost, False))
            system.signal("flow_relief", "flow of the relief valve", _FLOW, relieved)
        stored = self._accumulator()
        system.signal("flow_pump", "flow of the pump", _FLOW, delivered)
        assert isinstance(pressure, Symbol)
        node(
            system,
            self.audit,
            "supply line",
            plant.oil,
            pressure,
            inflow=delivered - relieved - demand - stored,
            volume=unit.volume,
        )

    def _delivery(self) -> Expression:
        """Flow of the pump into the line."""
        unit, system, plant = self.scenario.supply, self.system, self.plant
        if unit.type == "fixed_pump":
            if unit.pump is None:
                assert unit.flow is not None
                return unit.flow
            machine = unit.pump
            across = self.unit - plant.return_pressure
            common = {
                "speed": machine.shaft_speed,
                "pressure_difference": across,
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
        assert unit.flow is not None
        assert unit.gain is not None
        assert unit.time_constant is not None
        state = system.state("pump", 0.0, tolerance=1e-6 * unit.flow)
        rate = supply.controlled_pump_rate(
            flow=state,
            pressure=self.unit,
            set_pressure=plant.supply_pressure,
            gain=unit.gain,
            time_constant=unit.time_constant,
        )
        band = RATE_BAND * unit.flow
        closing = clip(state / band, 0.0, 1.0)
        opening = clip((unit.flow - state) / band, 0.0, 1.0)
        system.rate(state, where(rate < 0, rate * closing, rate * opening))
        return supply.controlled_pump_delivery(flow=state, largest_flow=unit.flow)

    def _accumulator(self) -> Expression:
        """Flow into the accumulator on the line."""
        one = self.scenario.supply.accumulator
        if one is None:
            return 0.0
        system, plant = self.system, self.plant
        law = {
            "precharge_pressure": one.precharge,
            "gas_volume": one.gas_volume,
            "polytropic_index": plant.oil.polytropic_index,
        }
        start = accumulator.gas_volume_at(pressure=plant.supply_pressure, **law)
        gas = system.state("gas volume", float(start), tolerance=1e-9 * one.gas_volume)
        held = accumulator.gas_pressure(volume=gas, **law)
        neck = elements.resistance(
            inner_diameter=NECK, length=NECK, dynamic_viscosity=plant.oil.dynamic_viscosity
        )
        flow = (self.unit - held) / neck
        full = clip((one.gas_volume - gas) / (1e-4 * one.gas_volume), 0.0, 1.0)
        flow = where(flow < 0, flow * full, flow)
        system.rate(gas, -flow)
        lost = system.integral("neck loss", (self.unit - held) * flow, scale=1.0)
        self.audit.flows.append(("accumulator neck", lost, False))
        energy = system.integral("accumulator", held * flow, scale=1.0)
        self.audit.flows.append(("accumulator", energy, False))
        system.signal(
            "pressure_accumulator", "gas pressure of the accumulator", INPUTS["pressure"], held
        )
        return flow


NECK = 5e-3
"""Bore and length of the neck of an accumulator on the supply line (a choice): 5 mm both."""
_FLOW = SCENARIOS["flow_value"]
