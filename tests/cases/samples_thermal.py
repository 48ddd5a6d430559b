"""Samples of the law tests for heat transfer and thermal networks; see `model_samples`."""

from __future__ import annotations

from actuator_opt.models import thermal_network as network
from actuator_opt.models.thermal_network import OilNode, Surroundings, ThermalLayer, ThermalPart

OIL_DATA = {"density": 870.0, "specific_heat": 1900.0}
WALL = {
    "bore": 23e-3, "length": 0.138, "wetted_length": 0.11,
    "layers": (
        ThermalLayer(0.6e-3, 130.0, 2.688e6, 6.0), ThermalLayer(1.2e-3, 0.6, 1.4915e6, 0.1),
        ThermalLayer(0.8e-3, 0.5, 1.4915e6, 0.2),
    ),
    "parts": (ThermalPart(0.4, 2.4e-3, 13e-3, 60.0, 1.0), ThermalPart(0.9, 3e-3, 28e-3, 90.0, 0.5)),
}  # fmt: skip
OIL = OilNode(250.0, 66.0, 2.0, 9.0, 313.0)


def steady_state(*, air, **wall):
    """Steady temperatures of a network that is made here."""
    made = network.thermal_network(**wall)
    return network.steady_temperatures(network=made, surroundings=air)


def faces(*, warm, middles, **wall):
    """Inner faces of the wall of a network that is made here, between temperatures of its nodes."""
    made = network.thermal_network(**wall)
    return network.inner_faces(network=made, oil=warm, layers=middles)


SAMPLES = {
    "heat_transfer.air_properties": {"temperature": 310.0, "absolute_pressure": 9e4},
    "heat_transfer.laminar_nusselt": [{"graetz_number": g} for g in (2.0, 1.5e4)],
    "heat_transfer.oil_film_coefficient": {
        "speed": 0.13, "diameter": 23e-3, "length": 55e-3, "conductivity": 0.13, **OIL_DATA,
    },
    "heat_transfer.free_convection_nusselt": {"rayleigh_number": 8e4, "prandtl_number": 0.71},
    "heat_transfer.cross_flow_nusselt": {"reynolds_number": 5e3, "prandtl_number": 0.71},
    "heat_transfer.convection_coefficient": [
        {
            "surface_temperature": surface, "ambient_temperature": 293.0, "diameter": 28e-3,
            "air_speed": wind, "absolute_pressure": 1e5,
        }
        for surface in (250.0, 333.0)
        for wind in (0.01, 3.0, -3.0)
    ],
    "heat_transfer.radiation_coefficient": {
        "emissivity": 0.9, "surface_temperature": 333.0, "ambient_temperature": 293.0,
    },
    "heat_transfer.layer_resistance": {
        "inner_radius": 12e-3, "outer_radius": 13e-3, "length": 0.14, "conductivity": 0.6,
    },
    "heat_transfer.film_resistance": {"film_coefficient": 13.0, "area": 0.012},
    "heat_transfer.throttle_temperature_rise": {
        "pressure_drop": 175e5, "volume_expansion": 7e-4, "temperature": 313.0, **OIL_DATA,
    },
    "heat_transfer.exchanged_volume": [
        {"piston_area": 4e-4, "travel": 0.06, "line_volume": v} for v in (1e-5, 3e-5)
    ],
    "heat_transfer.oil_exchange_conductance": {"exchange_flow": 2e-5, **OIL_DATA},
    "heat_transfer.friction_heat": [
        {"piston_seal": 6.0, "rod_seal": 2.0, "in_oil": flag} for flag in (False, True)
    ],
    "thermal_network.thermal_network": {"oil": OIL, **WALL},
    "thermal_network.steady_temperatures": [
        (steady_state, {"oil": OIL, "air": air, **WALL})
        for air in (
            Surroundings(293.0),
            Surroundings(293.0, 2.0, 0.1, 9e4),
            Surroundings(293.0, film_coefficient=40.0),
        )
    ],
    "thermal_network.inner_faces": (
        faces, {"oil": OIL, "warm": 330.0, "middles": (320.0, 310.0, 305.0), **WALL},
    ),
    "thermal_network.ripple_bound": {
        "time": (0.1, 1.0, 2.0, 3.0), "power": (0.5, 8.0, 2.0, 1.0), "heat_capacity": 10.0,
    },
}  # fmt: skip
REPORTS = dict.fromkeys(
    ("thermal_network.temperatures_after", "thermal_network.slowest_time_constant"),
    "modes and eigenvalues of a single design, for reports",
)
