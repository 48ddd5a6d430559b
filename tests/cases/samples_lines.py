"""Samples of the law tests for orifices, valves, accumulators and lines; see `model_samples`."""

from __future__ import annotations

from math import inf

from actuator_opt.models.line_ends import LineEnd, end_admittance
from actuator_opt.models.transmission_line import LineMatrix, input_admittance, input_impedance

OIL = {"density": 870.0, "dynamic_viscosity": 0.04}
SLIT = {"hydraulic_diameter": 1e-3, "turbulent_coefficient": 0.65, "laminar_coefficient": 0.157}
THROTTLE = {**OIL, "opening": 0.6, "needle_area": 2e-5, "check_area": 6e-5}
GAS = {"precharge_pressure": 6e6, "gas_volume": 1e-3, "polytropic_index": 1.3}
SECTION = {"frequency": 80.0, "inner_diameter": 8e-3, "density": 865.0, "dynamic_viscosity": 0.04}
WAVES = {**SECTION, "sound_speed": 1250.0}
PIPE = {**WAVES, "length": 2.2}

SAMPLES: dict = {
    "damping.gap_conductance": {
        "diameter": 0.04, "gap": 3e-5, "dynamic_viscosity": 0.04, "length": 0.02,
        "eccentricity": 0.4,
    },
    "orifice.discharge_coefficient": [
        {"reynolds": 5.0}, {"reynolds": -400.0, "turbulent_coefficient": 0.65},
    ],
    "orifice.round_diameter": {"area": 3e-5},
    "orifice.orifice_flow": [
        {"area": 3e-5, "pressure_difference": -5e5, **OIL},
        {"area": 3e-6, "pressure_difference": 50.0, **OIL, **SLIT},
    ],
    "orifice.orifice_conductance": [
        {"area": 3e-5, "pressure_difference": -5e5, **OIL},
        {"area": 3e-6, "pressure_difference": 50.0, **OIL, **SLIT},
        {"area": 0.0, "pressure_difference": 1e5, **OIL},
    ],
    "orifice.orifice_pressure_drop": [
        {"area": 3e-5, "flow": -5e-4, **OIL}, {"area": 3e-6, "flow": 1e-8, **OIL, **SLIT},
    ],
    "orifice.orifice_resistance": [
        {"area": 3e-5, "flow": -5e-4, **OIL}, {"area": 3e-6, "flow": 1e-8, **OIL, **SLIT},
    ],
    # throttled, needle alone, opening, open; closed needle
    "one_way_valve.one_way_flow": [
        {**THROTTLE, "pressure_difference": dp} for dp in (1e5, -2e4, -4.4e4, -1e5)
    ],
    "one_way_valve.one_way_conductance": [
        {**THROTTLE, "pressure_difference": dp} for dp in (1e5, -2e4, -4.4e4, -1e5)
    ],
    "one_way_valve.one_way_pressure_drop": [
        *({**THROTTLE, "flow": q} for q in (1e-4, -1e-5, -1.2e-4, -8e-4)),
        {**THROTTLE, "opening": 0.0, "flow": -8e-4},
    ],
    "accumulator.gas_volume_at": [{**GAS, "pressure": 1e7}, {**GAS, "pressure": 3e6}],
    "accumulator.gas_capacitance": [
        {**GAS, "pressure": 1e7, "filling_index": 1.1}, {**GAS, "pressure": 3e6},
    ],
    "accumulator.usable_volume": [
        {**GAS, "low_pressure": low, "high_pressure": 1.4e7, "filling_index": 1.1}
        for low in (7e6, 4e6)
    ],
    "transmission_line.wave_speed": {
        "bulk_modulus": 1.4e9, "density": 865.0, "volume": 4e-5, "wall_compliance": 2e-14,
    },
    "transmission_line.joukowsky_pressure": {
        "density": 865.0, "sound_speed": 1250.0, "velocity_change": 3.0,
    },
    "transmission_line.quarter_wave_length": {
        "frequency": 20.0, "sound_speed": 1300.0, "quarter_waves": 3.0,
    },
    "line_ends.antiresonance_frequency": {
        "conductance": 2e-10, "natural_frequency": 10.0, "damping_ratio": 0.5,
        "compliance": 1e-12,
    },
}  # fmt: skip

MATRIX = {"A": 0.4 + 0.1j, "B": 2e9 + 1e10j, "C": 1e-13 + 4e-11j, "D": 0.4 + 0.1j}


def _impedance(A, B, C, D, **end):
    """Near-end impedance, by the entries of the matrix."""
    return input_impedance(matrix=LineMatrix(A, B, C, D), **end)


def _admittance(A, B, C, D, **end):
    """Near-end admittance, by the entries of the matrix."""
    return input_admittance(matrix=LineMatrix(A, B, C, D), **end)


def _end(numerator, damping, inertia, frequency):
    """Admittance of a second-order end, by its coefficients."""
    return end_admittance(end=LineEnd((numerator,), (1.0, damping, inertia)), frequency=frequency)


FREQUENCY_RESPONSES: dict = {
    "lines.series_impedance": [
        SECTION, {**SECTION, "frequency": 4e4}, {**SECTION, "friction": "steady"},
        {**SECTION, "friction": "lossless"},
    ],
    "transmission_line.line_matrix": [PIPE, {**PIPE, "frequency": 1e-4}],
    "transmission_line.input_impedance": [
        (_impedance, {**MATRIX, "end_impedance": z}) for z in (0.0, 3e9 - 1e9j, inf)
    ],
    "transmission_line.input_admittance": [
        (_admittance, {**MATRIX, "end_admittance": y}) for y in (0.0, 3e-10 - 1e-10j, inf)
    ],
    "transmission_line.plugged_branch_impedance": [PIPE],
    "line_ends.end_admittance": [
        (_end, {"numerator": 2e-10, "damping": 0.016, "inertia": 2.5e-4, "frequency": 12.0}),
    ],
}  # fmt: skip
"""Complex-valued functions: a complex step would mix with their result, so they have laws of
their own in `test_models_line_dynamics`. Samples as in SAMPLES, always a list."""
