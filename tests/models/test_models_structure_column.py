"""Rod and column: stiffness, threads, Euler, shear, shell, stepped columns."""

from __future__ import annotations

from math import cos, pi, sqrt, tan

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from transfer_matrices import column_load

from actuator_opt.models import column, rod, stepped

SEGMENTS = {
    "bending_stiffness_1": 5000.0,
    "length_1": 0.20,
    "bending_stiffness_2": 1200.0,
    "length_2": 0.18,
}
ENDS = {
    ("pinned", "pinned"): 1.0,
    ("fixed", "pinned"): 2.045748,
    ("pinned", "fixed"): 2.045748,
    ("fixed", "fixed"): 4.0,
    ("fixed", "free"): 0.25,
    ("free", "fixed"): 0.25,
    ("fixed", "guided"): 1.0,
    ("guided", "fixed"): 1.0,
    ("pinned", "guided"): 0.25,
    ("guided", "pinned"): 0.25,
}


def test_rod_stiffness_of_the_knee():
    """The published 13 430 N/mm means E/L = 118.75 N/mm^3 for a solid 12 mm rod."""
    k = rod.axial_stiffness_as_published(
        youngs_modulus=118.75e9 * 0.15, outer_diameter=12e-3, length=0.15
    )
    assert k == pytest.approx(13430e3, rel=1e-4)
    moduli = [118.75e9 * length for length in (0.15, 0.11)]
    assert moduli == pytest.approx([17.8e9, 13.1e9], rel=4e-3)


def test_hollow_rod_is_the_difference_of_two_solid_ones():
    """Area, stiffness and second moment of a tube are those of the bars' difference."""
    size = {"outer_diameter": 12e-3, "inner_diameter": 6e-3}
    hollow = rod.axial_stiffness(youngs_modulus=2e11, length=0.2, **size)
    outer = rod.axial_stiffness(youngs_modulus=2e11, length=0.2, outer_diameter=12e-3)
    inner = rod.axial_stiffness(youngs_modulus=2e11, length=0.2, outer_diameter=6e-3)
    assert hollow == pytest.approx(outer - inner, rel=1e-14)
    assert rod.second_moment(**size) == pytest.approx(pi / 64 * (12e-3**4 - 6e-3**4), rel=1e-14)
    assert rod.rod_stress(force=-1e4, **size) == pytest.approx(-1e4 / (pi / 4 * 108e-6))


def test_thread_check_value():
    """M10 x 1.5: stress area 57.99 mm^2 (ISO 898-1)."""
    area = rod.thread_stress_area(diameter=10e-3, pitch=1.5e-3)
    assert area == pytest.approx(57.99e-6, rel=1e-4)
    stress = rod.thread_stress(force=1e4, diameter=10e-3, pitch=1.5e-3)
    assert stress == pytest.approx(1e4 / area)


def test_shear_and_shell_check_values():
    """Cowper 0.546147 at nu 0.28, m 0.75; shell 3389.3 and 2783.8 MPa at t 1.2, R 15."""
    assert column.cowper_tube(poissons_ratio=0.28, radius_ratio=0.75) == pytest.approx(
        0.546147, rel=1e-6
    )
    shell = {"youngs_modulus": 70e9, "thickness": 1.2e-3, "radius": 15e-3, "poissons_ratio": 0.3}
    classical = column.local_shell_stress(knockdown=1.0, **shell)
    assert classical == pytest.approx(3389.3e6, rel=2e-5)
    assert column.local_shell_stress(**shell) == pytest.approx(2783.8e6, rel=3e-5)


def test_engesser_limits():
    """Shear changes nothing when stiff, and is itself the limit of a stubby column."""
    assert column.engesser_load(critical_load=1e4, shear_stiffness=1e12) == pytest.approx(1e4)
    assert column.engesser_load(critical_load=1e12, shear_stiffness=1e4) == pytest.approx(1e4)


@pytest.mark.parametrize(
    ("ends", "load"),
    [
        (("pinned", "pinned"), 128.933e3),
        (("fixed", "pinned"), 266.962e3),
        (("pinned", "fixed"), 325.063e3),
        (("fixed", "fixed"), 542.675e3),
        (("fixed", "free"), 54.1212e3),
    ],
)
def test_stepped_column_check_values(ends, load):
    """EI 5000/1200 N m^2, L 0.20/0.18 m, five fixities (independent check), by both methods."""
    assert stepped.stepped_column_load(ends=ends, **SEGMENTS) == pytest.approx(load, rel=2.5e-6)
    segments = column_load(bending_stiffness=[5000.0, 1200.0], length=[0.20, 0.18], ends=ends)
    assert segments == pytest.approx(load, rel=2.5e-6)


def test_the_two_shortcuts_miss_both_ways():
    """Rod alone 365.54 kN, rod stiffness over the full length 82.02 kN (independent check)."""
    alone = column.euler_load(bending_stiffness=1200.0, effective_length=0.18)
    full = column.euler_load(bending_stiffness=1200.0, effective_length=0.38)
    assert alone == pytest.approx(365.54e3, rel=2e-5)
    assert full == pytest.approx(82.02e3, rel=2e-5)
    assert full < stepped.stepped_column_load(**SEGMENTS) < alone


@pytest.mark.parametrize("ends", ENDS)
@given(st.floats(0.0, 1.0), st.floats(10.0, 1e5), st.floats(0.05, 3.0))
@settings(max_examples=15, deadline=None)
def test_equal_segments_are_the_uniform_column(ends, share, stiffness, length):
    """With one stiffness, wherever the joint lies, the load is Euler's for the fixity."""
    value = stepped.stepped_column_load(
        bending_stiffness_1=stiffness,
        length_1=share * length,
        bending_stiffness_2=stiffness,
        length_2=(1 - share) * length,
        ends=ends,
    )
    assert value == pytest.approx(ENDS[ends] * pi**2 * stiffness / length**2, rel=1e-6)


TIMOSHENKO_GERE = {
    0.01: (0.15, 0.27, 0.60, 2.26),
    0.1: (1.47, 2.40, 4.50, 8.59),
    0.2: (2.80, 4.22, 6.69, 9.33),
    0.4: (5.09, 6.68, 8.51, 9.67),
    0.6: (6.98, 8.19, 9.24, 9.78),
    0.8: (8.55, 9.18, 9.63, 9.84),
}


@pytest.mark.parametrize("ratio", TIMOSHENKO_GERE)
def test_table_of_timoshenko_and_gere(ratio):
    """Symmetric bar, stiffer I2 over the middle a, I1 = ratio I2 outside: P = m EI2/l^2.

    Timoshenko and Gere, Theory of Elastic Stability, table 2-10 (recalled, and each value checked
    here against its own condition tan(k1 (l-a)/2) tan(k2 a/2) = k1/k2). By symmetry the half bar
    is fixed at the middle and free at the pin.
    """
    for a, m in zip((0.2, 0.4, 0.6, 0.8), TIMOSHENKO_GERE[ratio], strict=True):
        value = stepped.stepped_column_load(
            bending_stiffness_1=1.0,
            length_1=a / 2,
            bending_stiffness_2=ratio,
            length_2=(1 - a) / 2,
            ends=("fixed", "free"),
        )
        assert value == pytest.approx(m, abs=0.0051)
        k1, k2 = sqrt(value / ratio), sqrt(value)
        product = tan(k1 * (1 - a) / 2) * tan(k2 * a / 2)
        assert product == pytest.approx(k1 / k2, rel=1e-9)


@pytest.mark.parametrize("ends", ENDS)
@given(st.floats(-3.0, 3.0), st.floats(0.02, 0.98))
@settings(max_examples=12, deadline=None)
def test_two_segments_agree_with_transfer_matrices(ends, decades, share):
    """Fixed steps reach the first zero for stiffness ratios from 1/1000 to 1000 in every fixity."""
    ratio = 10.0**decades
    value = stepped.stepped_column_load(
        bending_stiffness_1=1.0,
        length_1=share,
        bending_stiffness_2=ratio,
        length_2=1 - share,
        ends=ends,
    )
    segments = column_load(bending_stiffness=[1.0, ratio], length=[share, 1 - share], ends=ends)
    assert value == pytest.approx(segments, rel=1e-9)


@given(st.floats(-2.0, 2.0), st.floats(0.05, 0.95))
@settings(max_examples=25, deadline=None)
def test_load_grows_with_stiffness_and_falls_with_length(decades, share):
    """More stiffness in either segment never lowers the load, more length never raises it."""
    ratio = 10.0**decades
    base = (1.0, share, ratio, 1 - share)

    def load(values):
        names = ("bending_stiffness_1", "length_1", "bending_stiffness_2", "length_2")
        return stepped.stepped_column_load(**dict(zip(names, values, strict=True)))

    for i in range(4):
        changed = [value * (1.05 if i == j else 1.0) for j, value in enumerate(base)]
        if i % 2:
            assert load(changed) <= load(base) * (1 + 1e-12)
        else:
            assert load(changed) >= load(base) * (1 - 1e-12)


def test_mirrored_column():
    """Reading the column from the other end changes nothing."""
    forward = stepped.stepped_column_load(ends=("fixed", "pinned"), **SEGMENTS)
    backward = stepped.stepped_column_load(
        bending_stiffness_1=1200.0,
        length_1=0.18,
        bending_stiffness_2=5000.0,
        length_2=0.20,
        ends=("pinned", "fixed"),
    )
    assert forward == pytest.approx(backward, rel=1e-14)


def test_mechanisms_raise_and_bad_designs_are_nan():
    """Ends that leave a mechanism are refused; a stiffness of zero in an array is NaN."""
    with pytest.raises(ValueError, match="mechanism"):
        stepped.stepped_column_load(ends=("pinned", "free"), **SEGMENTS)
    values = {**SEGMENTS, "bending_stiffness_2": np.array([1200.0, 0.0, -1.0])}
    assert np.isnan(stepped.stepped_column_load(**values)).tolist() == [False, True, True]


def test_segments_of_one_section_change_nothing():
    """A segment cut into three, or a third of equal stiffness added, keeps the load."""
    whole = stepped.stepped_column_load(**SEGMENTS)
    cut = column_load(
        bending_stiffness=[5000.0, 5000.0, 1200.0, 1200.0], length=[0.05, 0.15, 0.1, 0.08]
    )
    assert cut == pytest.approx(whole, rel=1e-10)


def test_pin_pin_form_is_the_tangent_condition():
    """The load solves tan(k1 L1)/k1 + tan(k2 L2)/k2 = 0 (independent check)."""
    load = stepped.stepped_column_load(**SEGMENTS)
    k1, k2 = sqrt(load / 5000), sqrt(load / 1200)
    residual = tan(k1 * 0.20) / k1 + tan(k2 * 0.18) / k2
    assert residual == pytest.approx(0, abs=1e-12)
    assert cos(k1 * 0.20) > 0 > cos(k2 * 0.18)


def test_section_of_a_tube():
    """12/6 mm: 84.823 mm^2 = 27 pi, 954.26 mm^4; bending by the section modulus I/(d_o/2)."""
    tube = {"outer_diameter": 12e-3, "inner_diameter": 6e-3}
    assert rod.section_area(**tube) == pytest.approx(27e-6 * pi, rel=1e-12)
    second_moment = pi / 64 * (12**4 - 6**4) * 1e-12
    stress = rod.bending_stress(bending_moment=20.0, **tube)
    assert stress == pytest.approx(20.0 * 6e-3 / second_moment, rel=1e-12)


@pytest.mark.parametrize(("slenderness", "gamma"), [(100.0, 0.581), (500.0, 0.322)])
def test_knockdown_of_a_thin_shell(slenderness, gamma):
    """1 - 0.901 (1 - e^(-sqrt(R/t)/16)): phi = 0.625 and 1.398, by hand; 1 for a thick wall."""
    value = column.local_shell_knockdown(radius=slenderness, thickness=1.0)
    assert value == pytest.approx(gamma, abs=0.001)
    assert column.local_shell_knockdown(radius=1e-6, thickness=1.0) == pytest.approx(1, abs=1e-4)
