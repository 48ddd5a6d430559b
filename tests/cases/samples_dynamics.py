"""Samples of the law tests for the valve, the linear actuator and its position loop.

`loop` finds roots with LAPACK on NumPy arrays, so its laws leave the array-API law out.
"""

from __future__ import annotations

from math import pi

from actuator_opt.models import loop
from actuator_opt.models.line_ends import (
    LineEnd,
    accumulator_end,
    parallel_ends,
    reducing_valve_end,
)
from actuator_opt.models.linear import Side, dynamic_stiffness, linear_actuator

FAR_END = LineEnd((2e-12, 3e-16), (1.0, 1e-3, 4e-6))
LINE_A = Side(8e-4, 5e-14, 3e-9, 4e8, 1.5e7, 3e-14, FAR_END, 1.2e-5)
LINE_B = Side(5e-4, 4e-14, 2e-9, 3e8, 1.1e7, 2e-14, LineEnd((1e-12,)), -1e-5)
BODY = {
    "mass": 30.0, "damping": 400.0, "coupling": -4e-15, "leakage": 2e-13, "flexibility": 5e-9,
}  # fmt: skip
MODEL = linear_actuator(side_a=LINE_A, side_b=LINE_B, seal_stiffness=1e6, **BODY)
DRIVEN = {
    **BODY, "area_a": 8e-4, "area_b": 5e-4, "compliance_a": 5e-14, "compliance_b": 4e-14,
    "valve_a": 2e-12, "valve_b": 3e-12, "gain_a": 1.2e-5, "gain_b": 1e-5,
}  # fmt: skip


def bare(area_a, area_b, compliance_a, compliance_b, valve_a, valve_b, gain_a, gain_b, **body):
    """Cylinder on a leaking valve, without lines."""
    return linear_actuator(
        side_a=Side(area_a, compliance_a, end=LineEnd((valve_a,)), flow_gain=gain_a),
        side_b=Side(area_b, compliance_b, end=LineEnd((valve_b,)), flow_gain=-gain_b),
        **body,
    )


def loop_of(natural_frequency=250.0, damping_ratio=0.7, **numbers):
    """Its open position loop."""
    return loop.open_loop(
        model=bare(**numbers), natural_frequency=natural_frequency, damping_ratio=damping_ratio
    )


def _stiffness(frequency, **numbers):
    return dynamic_stiffness(model=bare(**numbers), frequency=frequency)


def _mode(**numbers):
    return loop.load_mode(model=bare(**numbers))


def _ultimate(**numbers):
    return loop.ultimate_gain(loop=loop_of(**numbers))


def _margins(gain, **numbers):
    return loop.margins(loop=loop_of(**numbers), gain=gain)


SPOOL = {"natural_frequency": 250.0, "damping_ratio": 0.7}
CENTRE = {
    "rated_coefficient": 3.5e-7, "leakage_coefficient": 3.4e-9, "signal": 10.0,
    "supply_pressure": 14e6, "return_pressure": 4e5, "pressure_a": 8e6, "pressure_b": 5e6,
}  # fmt: skip

SAMPLES: dict = {
    "valve.edge_coefficient": {"flow": 6e-4, "pressure_drop": 35e5},
    "valve.edge_flow": [
        {"coefficient": 3e-7, "pressure_drop": p} for p in (35e5, -2e4, 50.0)
    ],
    "valve.edge_conductance": [
        {"coefficient": 3e-7, "pressure_drop": p} for p in (35e5, -2e4, 50.0)
    ],
    "holding_valve.feeding_edges": [
        {"rated_coefficient": 3.5e-7, "leakage_supply": 3e-9, "leakage_tank": 4e-9, "into": into,
         "out": 35e6 - into} for into in (8e6, 3e7)
    ],
    "holding_valve.valve_slopes": [{**CENTRE, "extending": one} for one in (True, False)],
    "line_ends.parallel_ends": {"*": (FAR_END, LineEnd((1e-12,)), LineEnd((0.5, 2.0), (1.0, 3.0)))},
    "line_ends.accumulator_end": {"capacitance": 4e-12, "inertance": 2e7, "resistance": 3e9},
    "line_ends.reducing_valve_end": {
        "conductance": 2e-10, "natural_frequency": 20.0, "damping_ratio": 0.4,
        "passive_conductance": 1e-12,
    },
    "linear.linear_actuator": [
        {"side_a": LINE_A, "side_b": LINE_B, "seal_stiffness": 1e6, **BODY}, (bare, DRIVEN),
    ],
    "linear.dynamic_stiffness": [
        (_stiffness, {**DRIVEN, "frequency": frequency}) for frequency in (0.3, 20.0, 400.0)
    ],
    "loop.open_loop": {"model": MODEL, **SPOOL},
    "loop.load_mode": [(_mode, DRIVEN)],
    "loop.ultimate_gain": [(_ultimate, {**DRIVEN, **SPOOL})],
    "loop.margins": [(_margins, {**DRIVEN, **SPOOL, "gain": 120.0})],
}  # fmt: skip

ROOTS = {
    "loop.load_mode": "its poles come from LAPACK on NumPy arrays",
    "loop.ultimate_gain": "its crossings come from LAPACK on NumPy arrays",
    "loop.margins": "its crossings come from LAPACK on NumPy arrays",
}
"""Functions outside the array-API law alone, with the reason."""
COMPLEX = {"loop.poles": "complex-valued on real parts, laws of its own in test_models_loop"}


def _line_end(kind, *numbers):
    """The package's line end for one of `circuit_oracle`."""
    if kind == "conductance":
        return LineEnd(numbers)
    if kind == "accumulator":
        names = ("capacitance", "inertance", "resistance")
        return accumulator_end(**dict(zip(names, numbers, strict=True)))
    if kind == "reducing":
        conductance, omega, ratio, passive = numbers
        return reducing_valve_end(
            conductance=conductance,
            natural_frequency=omega / (2 * pi),
            damping_ratio=ratio,
            passive_conductance=passive,
        )
    return LineEnd((1.0,), ())


def model_of(circuit):
    """The package's linear actuator of a circuit of `circuit_oracle`."""
    sides = {}
    for name in "ab":
        side = dict(circuit[name])
        ends = [_line_end(*end) for end in side.pop("ends")]
        sides[f"side_{name}"] = Side(**side, end=parallel_ends(*ends) if ends else LineEnd())
    body = {key: value for key, value in circuit.items() if key not in ("a", "b")}
    return linear_actuator(**sides, **body)
