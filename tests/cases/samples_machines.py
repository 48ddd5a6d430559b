"""Samples of the law tests for pumps, motors and the pressure supply; see `model_samples`."""

from __future__ import annotations

SHAFT = {
    "speed": 62.0, "pressure_difference": 1.4e7, "displacement": 13.3e-6, "setting": 0.8,
}  # fmt: skip
SLIP = {**SHAFT, "dynamic_viscosity": 0.04, "slip_coefficient": 150e-9}
FRICTION = {
    **SHAFT, "dynamic_viscosity": 0.04, "coulomb_coefficient": 0.16, "viscous_coefficient": 1e5,
    "constant_torque": 0.1, "sign_speed": 0.5,
}  # fmt: skip
BRAKING = {**FRICTION, "speed": -0.3, "pressure_difference": -9e6, "setting": -0.4}
RELIEF = {"cracking_pressure": 1.4e7, "override": 1e6, "rated_flow": 6e-4}

SAMPLES = {
    "wilson.motor_flow": SLIP,
    "wilson.motor_torque": [FRICTION, BRAKING],
    "wilson.pump_flow": SLIP,
    "wilson.pump_torque": [FRICTION, BRAKING],
    "supply.relief_flow": [
        {**RELIEF, "pressure_difference": p} for p in (-1e6, 1e7, 1.45e7, 1.7e7)
    ],
    "supply.controlled_pump_rate": {
        "flow": 3e-4, "pressure": 1.3e7, "set_pressure": 1.4e7, "gain": 3e-9,
        "time_constant": 0.02,
    },
    "supply.controlled_pump_delivery": [
        {"flow": flow, "largest_flow": 5e-4} for flow in (-1e-4, 3e-4, 9e-4)
    ],
}  # fmt: skip
