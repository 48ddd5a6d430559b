"""Yield with residual stress, bolt endurance, and chambers coupled by the barrel's stretch."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import barrel, endurance, stiffness, strength

stresses = st.tuples(*[st.integers(-300, 300).map(lambda mpa: mpa * 1e6)] * 4)


def _mises(s):
    """Von Mises stress of stresses 1, 2, 3, 12 from the deviator's norm."""
    tensor = np.array([[s[0], s[3], 0], [s[3], s[1], 0], [0, 0, s[2]]])
    deviator = tensor - np.trace(tensor) / 3 * np.eye(3)
    return sqrt(1.5 * np.sum(deviator * deviator))


@given(stresses, stresses)
def test_mises_product_is_the_deviator_s_inner_product(a, b):
    """Its diagonal is the von Mises stress squared; off it, polarisation holds."""
    square = strength.mises_product(first=a, second=a)
    assert square == pytest.approx(_mises(a) ** 2, rel=1e-9, abs=1e-3)
    total = tuple(x + y for x, y in zip(a, b, strict=True))
    cross = (_mises(total) ** 2 - _mises(a) ** 2 - _mises(b) ** 2) / 2
    scale = _mises(a) * _mises(b) + 1.0
    assert strength.mises_product(first=a, second=b) == pytest.approx(cross, abs=1e-8 * scale)


def test_mises_product_without_shear_is_the_barrel_s():
    """Three principal stresses give `barrel.von_mises`."""
    stress = (128e6, -28e6, 50e6, 0.0)
    product = strength.mises_product(first=stress, second=stress)
    assert sqrt(product) == pytest.approx(barrel.von_mises(hoop=128e6, radial=-28e6, axial=50e6))


@given(stresses, stresses)
def test_yield_ends_where_the_total_stress_yields(load, held):
    """Residual + SR load lies on the von Mises surface; without residual SR = yield/mises."""
    yield_strength = 400e6
    if _mises(held) > 0.9 * yield_strength or _mises(load) < 1e6:
        return
    used = strength.yield_utilisation(stress=load, yield_strength=yield_strength, residual=held)
    total = [h + s / used for h, s in zip(held, load, strict=True)]
    assert _mises(total) == pytest.approx(yield_strength, rel=1e-6)
    alone = strength.yield_utilisation(stress=load, yield_strength=yield_strength)
    assert alone == pytest.approx(_mises(load) / yield_strength, rel=1e-9)


def test_bolt_endurance_amplitude_by_hand():
    """M10: 0.85 (150/10 + 45) = 51 MPa; M5: 63.75 MPa; a larger bolt stands less."""
    assert endurance.bolt_endurance_amplitude(diameter=10e-3) == pytest.approx(51e6)
    assert endurance.bolt_endurance_amplitude(diameter=5e-3) == pytest.approx(63.75e6)


def test_bolt_cycles_by_hand():
    """Twice the endurance amplitude stands 2e6/8 cycles; the endurance amplitude itself 2e6."""
    assert endurance.bolt_cycles(amplitude=102e6, diameter=10e-3) == pytest.approx(250e3)
    assert endurance.bolt_cycles(amplitude=51e6, diameter=10e-3) == pytest.approx(2e6)


SIZES = {"area_a": 8e-4, "area_b": 5e-4}
COUPLED = {
    "compliance_a0": 6e-15, "compliance_a_per_length": 6e-13, "compliance_b0": 7e-15,
    "compliance_b_per_length": 4e-13, "compliance_ab0": -1e-15, "compliance_ab_per_length": -3e-14,
}  # fmt: skip


def test_coupled_stiffness_from_the_energy():
    """The work of a small piston step on both coupled chambers, by solving for the pressures."""
    c_a, c_b, c_ab = 5e-14, 4e-14, -6e-15
    step = 1e-6
    matrix = np.array([[c_a, c_ab], [c_ab, c_b]])
    pressures = np.linalg.solve(matrix, [-SIZES["area_a"] * step, SIZES["area_b"] * step])
    force = -(pressures[0] * SIZES["area_a"] - pressures[1] * SIZES["area_b"])
    k = stiffness.hydraulic_stiffness(
        **SIZES, compliance_a=c_a, compliance_b=c_b, compliance_ab=c_ab
    )
    assert k == pytest.approx(force / step, rel=1e-12)
    assert k == pytest.approx(pressures @ matrix @ pressures / step**2, rel=1e-12)


@given(st.floats(-6e-14, 6e-14), st.floats(-2e-15, 2e-15), st.floats(0.05, 0.4))
def test_weakest_position_by_brute_force(slope, start, stroke):
    """The closed form is the minimum over a fine grid of positions, coupled or not."""
    give = COUPLED | {"compliance_ab0": start, "compliance_ab_per_length": slope}
    x = np.linspace(0, stroke, 20001)
    k = stiffness.hydraulic_stiffness(
        **SIZES,
        compliance_a=give["compliance_a0"] + give["compliance_a_per_length"] * x,
        compliance_b=give["compliance_b0"] + give["compliance_b_per_length"] * (stroke - x),
        compliance_ab=start + slope * x,
    )
    found = stiffness.weakest_position(**SIZES, **give, stroke=stroke)
    assert found == pytest.approx(x[int(np.argmin(k))], abs=stroke / 9000)


def test_coupling_by_stretch_equals_a_spring_in_series():
    """A rigid-walled barrel that only stretches acts like a spring: the load path's own stretch.

    Cap-mounted with oil only on the rod side, 1/k = 1/(A_B^2/C_B) + L/(E A).
    """
    axial = 0.14 / (206e9 * pi * (14.5e-3**2 - 12.5e-3**2))
    area = SIZES["area_b"]
    oil = 4e-14
    k = stiffness.hydraulic_stiffness(
        area_a=1e-9,
        compliance_a=1.0,
        area_b=area,
        compliance_b=oil + area * area * axial,
        compliance_ab=0.0,
    )
    assert 1 / k == pytest.approx(oil / area**2 + axial, rel=1e-9)
