"""Samples of the law tests for servo circuits in the time domain; see `model_samples`."""

from __future__ import annotations

EDGE = {"rated_coefficient": 3.5e-7, "leakage_coefficient": 3.4e-9, "full_signal": 10.0}
VALVE = {
    "rated_coefficient": 3.5e-7, "leakage_supply": 2.9e-9, "leakage_tank": 3.6e-9,
    "full_signal": 10.0, "supply_pressure": 14e6, "return_pressure": 4e5, "pressure_a": 8e6,
    "pressure_b": 5e6,
}  # fmt: skip
SPOOL = {"overlap": 5e-5, "area_gradient": 0.0126, "density": 865.0}
LINE = {"pressure": 5.8e6, "set_pressure": 6e6}
ULTIMATE = {"ultimate_gain": 400.0, "ultimate_period": 0.008}

BRISTLE = {"deflection": 3e-5, "speed": 0.02, "bristle_stiffness": 1e7}
OIL = {"bulk_modulus": 1.4e9, "air_content": 0.01}
GAS = {"precharge_pressure": 6e6, "gas_volume": 1e-3}

SAMPLES = {
    "lugre.lugre_rate": [{**BRISTLE, "level": 700.0}, {**BRISTLE, "speed": -0.02, "level": 700.0}],
    "lugre.lugre_force": {**BRISTLE, "rate": 0.01, "bristle_damping": 3e4, "viscous": 1e3},
    "end_stop.contact_force": [
        {"compression": x, "closing_speed": v, "stiffness": 5e7, "damping": 2e4}
        for x, v in ((1e-4, 0.1), (1e-4, -0.4))
    ],
    "chamber.oil_energy_density": [
        {**OIL, "pressure": 1.4e7, "slope": 10.0, "polytropic_index": 1.4},
        {**OIL, "pressure": -5e4, "slope": 0.0, "polytropic_index": 1.0},
    ],
    "accumulator.gas_pressure": {**GAS, "volume": 6e-4, "polytropic_index": 1.4},
    "valve.edge_opening": [{**EDGE, "signal": signal} for signal in (-3.0, 4.0, 13.0)],
    "valve.valve_flows": [{**VALVE, "signal": signal} for signal in (-3.0, 6.0, 13.0)],
    "valve.viscosity_corrected": {
        "coefficient": 3.5e-7, "rated_viscosity": 32e-6, "viscosity": 46e-6,
    },
    "valve.spool_acceleration": {
        "command": 3.0, "opening": 2.0, "rate": 900.0, "natural_frequency": 250.0,
        "damping_ratio": 0.7,
    },
    "valve.spool_edge_coefficient": [
        {**SPOOL, "spool_position": position} for position in (-2e-4, 6e-4)
    ],
    "supply.reducing_valve_acceleration": {
        **LINE, "flow": 1e-5, "rate": 3e-4, "conductance": 1e-10, "natural_frequency": 20.0,
        "damping_ratio": 0.4,
    },
    "supply.reducing_valve_flow": [
        {**LINE, "flow": flow, "largest_flow": 1e-3, "passive_conductance": 2e-12}
        for flow in (-2e-3, 3e-4, 2e-3)
    ],
    "loop.ziegler_nichols": [{**ULTIMATE, "law": law} for law in ("p", "pi", "pid")],
    "loop.margin_rules": [
        {"law": law, "ultimate_gain": 400.0, "velocity_gain": 0.13, "gain_margin": 2.5}
        for law in ("p", "pi")
    ],
}  # fmt: skip
