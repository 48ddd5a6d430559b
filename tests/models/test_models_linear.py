"""Claims about the linear model of the held actuator.

Expected values come from `circuit_oracle`, which writes the differential equations element by
element and knows nothing of the package, from closed forms, and from published check values.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from circuit_oracle import descriptor, random_circuit, state_space
from hypothesis import given, strategies as st
from samples_dynamics import model_of
from test_models_hydraulics_dynamics import CHAMBERS, CONDUCTANCE

from actuator_opt.base.polynomial import at_frequency
from actuator_opt.models import stiffness
from actuator_opt.models.line_ends import (
    LineEnd,
    accumulator_end,
    parallel_ends,
    reducing_valve_end,
)
from actuator_opt.models.linear import Side, dynamic_stiffness, linear_actuator
from actuator_opt.models.loop import poles

FREQUENCIES = np.geomspace(0.1, 1000.0, 60)
SIDE_A = Side(CHAMBERS["area_a"], CHAMBERS["compliance_a"])
SIDE_B = Side(CHAMBERS["area_b"], CHAMBERS["compliance_b"])
HELD = LineEnd((1.0,), ())
SEEDS = st.integers(0, 2**32 - 1)


def stiff(model, frequency=FREQUENCIES):
    """Dynamic stiffness as a complex number."""
    parts = dynamic_stiffness(model=model, frequency=frequency)
    return parts.real + 1j * parts.imaginary


def closed(side_a=SIDE_A, side_b=SIDE_B, **body):
    """The check cylinder, 30 kg and 400 N s/m unless stated."""
    return linear_actuator(side_a=side_a, side_b=side_b, **{"mass": 30.0, "damping": 400.0, **body})


# --- the differential equations ------------------------------------------------------------------


@given(SEEDS)
def test_dynamic_stiffness_is_that_of_the_differential_equations(seed):
    """0.1 to 1000 Hz, every element there or not: 1/G(i w) of the equations at each point."""
    circuit = random_circuit(seed)
    e, a, b, out = descriptor(circuit)
    response = [np.linalg.solve(2j * np.pi * f * e - a, b[:, 0])[out] for f in FREQUENCIES]
    np.testing.assert_allclose(stiff(model_of(circuit)) * response, 1, rtol=1e-8)


def exact_response(circuit, omega):
    """x/F at i omega by elimination in rational numbers: no rounding at all."""
    e, a, b, out = descriptor(circuit)
    omega, size = Fraction(omega), len(a)
    rows = [
        [(-Fraction(a[i, j]), omega * Fraction(e[i, j])) for j in range(size)]
        + [(Fraction(b[i, 0]), Fraction(0))]
        for i in range(size)
    ]

    def times(p, q):
        return p[0] * q[0] - p[1] * q[1], p[0] * q[1] + p[1] * q[0]

    def over(p, q):
        square = q[0] ** 2 + q[1] ** 2
        return (p[0] * q[0] + p[1] * q[1]) / square, (p[1] * q[0] - p[0] * q[1]) / square

    for i in range(size):
        pivot = next(r for r in range(i, size) if rows[r][i] != (0, 0))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(size):
            if r != i and rows[r][i] != (0, 0):
                factor = over(rows[r][i], rows[i][i])
                lost = [times(factor, entry) for entry in rows[i]]
                rows[r] = [(p[0] - q[0], p[1] - q[1]) for p, q in zip(rows[r], lost, strict=True)]
    return complex(*map(float, over(rows[out][size], rows[out][out])))


@pytest.mark.parametrize("seed", range(12))
def test_dynamic_stiffness_to_the_last_digits(seed):
    """Against rational arithmetic the polynomials lose nothing, not at 0.01 Hz either."""
    circuit = random_circuit(seed)
    for frequency in (0.01, 20.0, 300.0):
        response = exact_response(circuit, 2 * math.pi * frequency)
        assert abs(stiff(model_of(circuit), frequency) * response - 1) < 1e-13


@given(SEEDS)
def test_poles_are_those_of_the_state_space(seed):
    """Every pole of python-control's state space beside zero is a root of the characteristic."""
    circuit = random_circuit(seed)
    found = poles(model=model_of(circuit))
    for pole in state_space(circuit).poles():
        if abs(pole) > 1e-2:
            assert np.min(np.abs(found - pole)) <= 1e-6 * abs(pole)


@given(SEEDS)
def test_valve_response_is_that_of_the_differential_equations(seed):
    """x/o of a driven circuit, 0.1 to 1000 Hz."""
    circuit = random_circuit(seed, driven=True)
    e, a, b, out = descriptor(circuit)
    model = model_of(circuit)
    omega = 2 * np.pi * FREQUENCIES
    top, low = at_frequency(model.drive, omega), at_frequency(model.characteristic, omega)
    ours = (top.real + 1j * top.imaginary) / (low.real + 1j * low.imaginary)
    response = [np.linalg.solve(1j * w * e - a, b[:, 1])[out] for w in omega]
    np.testing.assert_allclose(ours / response, 1, rtol=1e-8)


# --- check values --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("frequency", "admittance", "magnitude", "phase"),
    [(10.0, 0.0, 20.5399, 0.070), (40.0, 0.0, 18.7636, 0.307),
     (10.0, 2e-11, 2.95833, 83.94), (40.0, 2e-11, 9.51768, 69.89)],
)  # fmt: skip
def test_dynamic_stiffness_check_values(frequency, admittance, magnitude, phase):
    """32/18-160 at mid-stroke: magnitude (MN/m) and phase (deg), closed and leaking line ends."""
    end = LineEnd((admittance,))
    k = stiff(closed(replace(SIDE_A, end=end), replace(SIDE_B, end=end)), frequency)
    assert abs(k) / 1e6 == pytest.approx(magnitude, rel=3e-6)
    assert math.degrees(math.atan2(k.imag, k.real)) == pytest.approx(phase, abs=0.006)


def test_dynamic_stiffness_is_the_published_formula():
    """-m w^2 + i w B + sum A^2/(C + Y/(i w)) in complex numbers, the rod in series with it."""
    y_a, y_b, flexibility = 3e-11, CONDUCTANCE, 1 / 4e7
    s = 2j * math.pi * FREQUENCIES
    inner = 400.0 * s
    for side, y in ((SIDE_A, y_a), (SIDE_B, y_b)):
        inner = inner + side.area**2 / (side.compliance + y / s)
    expected = 30.0 * s**2 + 1 / (1 / inner + flexibility)
    ends = replace(SIDE_A, end=LineEnd((y_a,))), replace(SIDE_B, end=LineEnd((y_b,)))
    np.testing.assert_allclose(stiff(closed(*ends, flexibility=flexibility)), expected, rtol=1e-12)


# --- laws ----------------------------------------------------------------------------------------


@given(st.floats(-0.3, 0.3), st.floats(1e6, 1e9), st.floats(0, 1e7), st.floats(1e-14, 1e-12))
def test_slowly_it_is_the_static_stiffness(share, rod, seals, far):
    """Ports closed, f -> 0: coupled oil with lines beside the seals, in series with the rod."""
    coupling = share * SIDE_B.compliance
    line = {"resistance": 1e9, "inertance": 1e7, "far_compliance": far}
    model = closed(
        replace(SIDE_A, **line), replace(SIDE_B, **line), mass=30.0, damping=400.0,
        coupling=coupling, seal_stiffness=seals, flexibility=1 / rod,
    )  # fmt: skip
    oil = stiffness.hydraulic_stiffness(
        area_a=SIDE_A.area, compliance_a=SIDE_A.compliance + far,
        area_b=SIDE_B.area, compliance_b=SIDE_B.compliance + far, compliance_ab=coupling,
    )  # fmt: skip
    expected = 1 / (1 / (oil + seals) + 1 / rod)
    assert stiff(model, 1e-5) == pytest.approx(expected, rel=1e-6)


def test_constant_pressure_holds_nothing():
    """At a constant pressure without a line the oil gives no stiffness; beside it, half is left."""
    s = 2j * math.pi * FREQUENCIES
    free = closed(replace(SIDE_A, end=HELD), replace(SIDE_B, end=HELD))
    np.testing.assert_allclose(stiff(free), 30 * s**2 + 400 * s, rtol=1e-12)
    half = closed(replace(SIDE_A, end=HELD))
    expected = 30 * s**2 + 400 * s + SIDE_B.area**2 / SIDE_B.compliance
    np.testing.assert_allclose(stiff(half), expected, rtol=1e-12)


@pytest.mark.parametrize("shut", [0.0, np.zeros(1)], ids=["number", "array"])
def test_a_closed_throttle_isolates_the_far_side(shut):
    """Whatever hangs behind a closed throttle, the chamber is a closed one; nothing is NaN."""
    far = {"resistance": 1e9, "inertance": 1e7, "far_compliance": 1e-12}
    for end in (LineEnd(), LineEnd((1e-10,)), HELD):
        model = closed(
            replace(SIDE_A, throttle=shut, end=end, **far), replace(SIDE_B, throttle=shut, end=end)
        )
        np.testing.assert_allclose(stiff(model), stiff(closed()), rtol=1e-12)


def test_an_open_throttle_is_no_throttle():
    """A very large conductance tends to the line without a throttle."""
    line = {"resistance": 1e9, "inertance": 1e7, "far_compliance": 1e-13, "end": LineEnd((1e-11,))}
    wide = closed(replace(SIDE_A, throttle=1e3, **line))
    np.testing.assert_allclose(stiff(wide), stiff(closed(replace(SIDE_A, **line))), rtol=1e-9)


def test_ends_of_one_node_add():
    """Admittances of accumulator, conductance and reducing valve add, each by its own formula."""
    parts = [
        accumulator_end(capacitance=4e-12, inertance=2e7, resistance=3e9),
        LineEnd((1e-12,)),
        reducing_valve_end(
            conductance=2e-10, natural_frequency=20.0, damping_ratio=0.4, passive_conductance=5e-12
        ),
    ]
    s, omega = 2j * math.pi * FREQUENCIES, 2 * math.pi * 20.0
    expected = (
        1 / (3e9 + 2e7 * s + 1 / (4e-12 * s)) + 1e-12 + 5e-12
        + 2e-10 * omega**2 / (s**2 + 2 * 0.4 * omega * s + omega**2)
    )  # fmt: skip
    both = parallel_ends(*parts)
    top, low = (at_frequency(p, s.imag) for p in (both.numerator, both.denominator))
    found = (top.real + 1j * top.imaginary) / (low.real + 1j * low.imaginary)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@given(SEEDS, st.floats(0.1, 1000.0))
def test_a_passive_actuator_never_drives_the_load(seed, frequency):
    """Lines, throttles, accumulators and leakage only take energy: the loss part is positive.

    Without reducing valves, whose spool may feed energy in.
    """
    circuit = random_circuit(seed)
    for name in "ab":
        circuit[name]["ends"] = [e for e in circuit[name]["ends"] if e[0] != "reducing"]
    k = stiff(model_of(circuit), frequency)
    assert k.imag >= -1e-12 * abs(k)


@given(SEEDS)
def test_a_flexible_rod_adds_its_compliance(seed):
    """(k + m w^2)^-1 grows by the rod's flexibility at every frequency."""
    circuit = {**random_circuit(seed), "flexibility": 0.0}
    inertia = circuit["mass"] * (2 * np.pi * FREQUENCIES) ** 2
    rigid = 1 / (stiff(model_of(circuit)) + inertia)
    soft = 1 / (stiff(model_of({**circuit, "flexibility": 1e-8})) + inertia)
    np.testing.assert_allclose(soft - rigid, 1e-8, rtol=1e-3)
