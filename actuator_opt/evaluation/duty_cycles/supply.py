"""Supply of the duty cycles: mean power, accumulator, heat of the oil, and the mass of it all."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce

from ...base.numeric import Array, maximum
from ...design.duty import DutySection
from ...design.model import Design
from ...models import accumulator, fluid, supply_sizing
from ..limits import MetricArrays
from ..values import Values
from .numbers import level_of
from .results import Place

PRECHARGE = 0.9
"""Default precharge, as a share of the lowest pressure, both absolute (common practice)."""
SHORT = 60.0
"""Period below which the gas of an accumulator changes without heat [s] (our choice)."""
ADIABATIC = 1.4
"""Polytropic index of nitrogen without heat."""
AT = "duty.supply."
MASSES = {
    "pump": "pump_mass",
    "accumulator": "accumulator_mass",
    "cooler": "cooler_mass",
    "source": "specific_energy",
}
"""Key of `duty.supply` that gives the mass of each part of the supply."""


def compute(
    v: Values,
    design: Design,
    results: Mapping[Place, Array],
    actuator_mass: Array,
    out: MetricArrays,
) -> None:
    """Compute mean power of all cycles, gas volume, temperature of the tank, and system mass."""
    duty = design.duty
    assert duty is not None
    sizes = _Sizes(v, duty, results)
    out.metrics["duty_power_mean"]["all cycles"] = sizes.mean_power
    if sizes.gas_volume is None:
        out.skip("duty_gas_volume", f"no accumulator stated: add {AT}pressure_drop")
    else:
        out.put("duty_gas_volume", sizes.gas_volume)
    if duty.tank is None:
        out.skip("duty_tank_temperature", "no tank stated: add duty.tank.cooler_conductance")
    elif sizes.heat is None:
        out.skip("duty_tank_temperature", f"no pump stated: add {AT}pump_efficiency")
    else:
        temperature = supply_sizing.tank_temperature(
            heat=sizes.heat,
            cooler_conductance=v["duty.tank.cooler_conductance"],
            ambient_temperature=v["duty.ambient"],
        )
        out.put("duty_tank_temperature", temperature)
    _system_mass(sizes, actuator_mass, out)


class _Sizes:
    """Sizes of the parts of the supply; None for a part that is not stated."""

    def __init__(self, v: Values, duty: DutySection, results: Mapping[Place, Array]) -> None:
        self._v, self._duty, self._results = v, duty, results
        self.count = 1 + max(len(cycle.also) for cycle in duty.cycles)

    def stated(self, key: str) -> Array | None:
        """A number of `duty.supply`; None if it is not stated."""
        return None if self._duty.supply is None else self._v.get(AT + key, None)

    def _each(self, name: str) -> dict[str, Array]:
        return {place.cycle: x for place, x in self._results.items() if place.name == name}

    def _actuators(self, name: str) -> int:
        (cycle,) = (cycle for cycle in self._duty.cycles if cycle.name == name)
        return 1 + len(cycle.also)

    def _over_life(self, each: Mapping[str, Array], resting: Array) -> Array:
        """Mean over the time of a life of amounts per cycle; without a life, the largest mean."""
        duration = self._each("duration")
        repeats = {c.name: c.repeats for c in self._duty.cycles if c.repeats is not None}
        if not repeats:
            return reduce(maximum, (each[name] / duration[name] for name in each))
        standby = self._v["duty.standby"]
        total: Array = standby * resting
        time: Array = standby
        for name in repeats:
            count = self._v[f"duty.cycles[{name}].repeats"]
            total, time = total + count * each[name], time + count * duration[name]
        return total / time

    @property
    def mean_power(self) -> Array:
        """Mean power from the supply for one actuator, standby included [W]."""
        rest = self._v["supply.pressure"] * self._results[Place("", "rest_leakage")]
        return self._over_life(self._each("supply_energy"), rest)

    @property
    def pump_power(self) -> Array:
        """Largest hydraulic power of the pump [W].

        With an accumulator it is the mean of a cycle, otherwise its peak flow times the pressure.
        """
        if self.gas_volume is not None:
            duration = self._each("duration")
            powers = {
                name: self._actuators(name) * energy / duration[name]
                for name, energy in self._each("supply_energy").items()
            }
        else:
            powers = {
                name: flow * self._level(name) for name, flow in self._each("flow_total").items()
            }
        return reduce(maximum, powers.values())

    def _level(self, name: str) -> Array:
        (cycle,) = (cycle for cycle in self._duty.cycles if cycle.name == name)
        return level_of(self._v, self._duty, cycle)

    @property
    def gas_volume(self) -> Array | None:
        """Gas volume of the accumulator [m^3], the largest of all cycles."""
        drop = self.stated("pressure_drop")
        if drop is None:
            return None
        share, index = self.stated("precharge_ratio"), self.stated("polytropic_index")
        volumes = []
        for name, volume in self._each("ripple_volume").items():
            high = self._level(name)
            low, air = high - drop, fluid.ATMOSPHERIC_PRESSURE
            short = next(c for c in self._duty.cycles if c.name == name)
            period = self._duty.record(short).duration * short.time_scale
            volumes.append(
                accumulator.gas_volume_needed(
                    oil_volume=volume,
                    low_pressure=low,
                    high_pressure=high,
                    precharge_pressure=(PRECHARGE if share is None else share) * (low + air) - air,
                    polytropic_index=(ADIABATIC if period < SHORT else 1.0)
                    if index is None
                    else index,
                )
            )
        return reduce(maximum, volumes)

    @property
    def heat(self) -> Array | None:
        """Heat of the oil of all actuators [W], mean over a life."""
        efficiency = self.stated("pump_efficiency")
        if efficiency is None:
            return None
        out, absorbed = self._each("work_out"), self._each("work_in")
        net = self._over_life({name: out[name] - absorbed[name] for name in out}, 0.0)
        return self.count * supply_sizing.oil_heat(
            hydraulic_power=self.mean_power, pump_efficiency=efficiency, net_work_rate=net
        )

    @property
    def energy(self) -> Array | None:
        """Energy from the source in a mission [J]."""
        time, pump, motor = map(
            self.stated, ("mission_time", "pump_efficiency", "motor_efficiency")
        )
        if time is None or pump is None or motor is None:
            return None
        power = supply_sizing.electric_power(
            hydraulic_power=self.mean_power, pump_efficiency=pump, motor_efficiency=motor
        )
        return self.count * power * time

    @property
    def cooler_conductance(self) -> Array | None:
        """Conductance of the cooler: as stated, or what the temperature of the oil needs [W/K]."""
        if self._duty.tank is not None:
            return self._v["duty.tank.cooler_conductance"]
        if self.heat is None:
            return None
        return supply_sizing.cooler_conductance_needed(
            heat=self.heat,
            temperature=self._v.get("duty.oil_supply", self._v["fluid.temperature"]),
            ambient_temperature=self._v["duty.ambient"],
        )


def _system_mass(sizes: _Sizes, actuator_mass: Array, out: MetricArrays) -> None:
    """Mass of all actuators with their oil and of the parts of the supply."""
    given = {
        "pump_power": sizes.pump_power,
        "gas_volume": 0.0 if sizes.gas_volume is None else sizes.gas_volume,
        "cooler_conductance": sizes.cooler_conductance,
        "energy": sizes.energy,
    }
    missing = [f"{AT}{key}" for key in MASSES.values() if sizes.stated(key) is None]
    if sizes.gas_volume is None:
        missing = [key for key in missing if not key.endswith("accumulator_mass")]
    if given["energy"] is None:
        keys = ("mission_time", "pump_efficiency", "motor_efficiency")
        missing += [f"{AT}{key}" for key in keys if sizes.stated(key) is None]
    elif given["cooler_conductance"] is None:
        missing.append(f"{AT}pump_efficiency")
    if missing:
        out.skip("system_mass", f"not stated: {', '.join(missing)}")
        return
    density = sizes.stated("accumulator_mass")
    parts = supply_sizing.supply_masses(
        accumulator_density=0.0 if density is None else density,
        pump_specific_mass=sizes.stated("pump_mass"),
        cooler_specific_mass=sizes.stated("cooler_mass"),
        specific_energy=sizes.stated("specific_energy"),
        **given,
    )
    others = sizes.stated("other_mass")
    parts |= {"actuators": sizes.count * actuator_mass, "others": 0.0 if others is None else others}
    out.put("system_mass", supply_sizing.system_mass(parts=parts).total)
