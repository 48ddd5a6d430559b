"""Samples of the law tests for duty cycles: counting, damage, wear, supply; see `model_samples`."""

from __future__ import annotations

from counted_cycles import cycle_stress

from actuator_opt.models import rainflow

COUNTS = {"wear.strokes": "counts the strokes of one history, laws of its own"}
"""Functions whose results are counts."""

STRESS = (0.0, 210e6, 80e6, 150e6, 20e6, 120e6, -10e6)
TIME = (0.1, 0.3, 0.6, 0.8, 1.1)
POSITION = (0.02, 0.06, 0.09, 0.05, 0.021)
FLOW = (1e-5, 6e-5, 3e-5, 0.5e-5, 1.1e-5)


def _stress_of_cycles(history):
    return cycle_stress(history, rainflow.repeating_cycles(history=history))


HISTORY = {"history": STRESS}
LIFE = {"ultimate_strength": 570e6, "fatigue_limit": 159e6, "limit_cycles": 5e8}
GAS = {
    "oil_volume": 7e-6, "high_pressure": 210e5, "precharge_pressure": 171e5,
    "polytropic_index": 1.4, "filling_index": 1.02, "atmospheric_pressure": 1e5,
}  # fmt: skip
SUPPLY = {
    "gas_volume": 0.12e-3, "pump_power": 1000.0, "cooler_conductance": 30.0, "energy": 9e6,
    "accumulator_density": 1500.0, "pump_specific_mass": 1e-3, "specific_energy": 0.6e6,
}  # fmt: skip

_CHAMBERS = {"driven_area": 4.15476e-4, "other_area": 2.82743e-4}
_LOAD = {"load": 1000.0, "return_pressure": 5e5, "ratio": 0.46312, **_CHAMBERS}
_EDGE = {"feed_coefficient": 8.90871e-8}

SAMPLES = {
    "quasi_static.edge_ratio": {"drain_coefficient": 6e-8, **_EDGE, **_CHAMBERS},
    "quasi_static.driven_pressures": {"supply_pressure": 210e5, **_LOAD},
    "quasi_static.speed_limit": {"edge_drop": 13.8787e6, "driven_area": 4.15476e-4, **_EDGE},
    "quasi_static.needed_supply": {"speed": 0.38, "opening": 0.9, **_LOAD, **_EDGE},
    "rainflow.repeating_cycles": (_stress_of_cycles, HISTORY),
    "endurance.reversed_amplitude": [
        {"amplitude": 90e6, "mean": mean, "ultimate_strength": 570e6} for mean in (80e6, -80e6)
    ],
    "endurance.basquin_cycles": {"amplitude": 120e6, **LIFE},
    "endurance.miner_damage": {
        "cycles": (1e6, 4e5, 3e9), "counts": (1.0, 2.0, 1.0), "repeats": 1e5,
    },
    "wear.sliding_distance": {"position": POSITION},
    "wear.cycle_severity": {
        "contact_pressure": (12e6, 18e6, 14e6, 9e6, 12e6), "position": POSITION,
    },
    "wear.worn_depth": {"severity": 1.855e6, "wear_rate": 2e-17, "repeats": 1e6},
    "wear.wear_share": {"depth": 37e-6, "allowed_depth": 50e-6},
    "wear.pressure_velocity": [{"contact_pressure": 18e6, "speed": v} for v in (0.2, -0.2)],
    "accumulator.gas_volume_needed": [{**GAS, "low_pressure": low} for low in (190e5, 60e5)],
    "supply_sizing.ripple_volume": {"time": TIME, "flow": FLOW},
    "supply_sizing.electric_power": {
        "hydraulic_power": 1043.0, "pump_efficiency": 0.85, "motor_efficiency": 0.9,
    },
    "supply_sizing.oil_heat": {
        "hydraulic_power": 1043.0, "pump_efficiency": 0.85, "net_work_rate": -8.3,
    },
    "supply_sizing.tank_temperature": {
        "heat": 1235.0, "cooler_conductance": 30.0, "ambient_temperature": 293.0,
    },
    "supply_sizing.cooler_conductance_needed": {
        "heat": 1235.0, "temperature": 334.0, "ambient_temperature": 293.0,
    },
    "supply_sizing.supply_masses": [
        {**SUPPLY, "cooler_specific_mass": 0.03}, {**SUPPLY, "cooler_specific_mass": None},
    ],
    "supply_sizing.system_mass": {"parts": {"actuators": 1.25, "pump": 1.0, "source": 15.0}},
}  # fmt: skip
