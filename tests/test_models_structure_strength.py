"""Ply failure criteria: published check values, limits, residual stress, laws of a multiplier."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actuator_opt.models import strength, strength_modes
from actuator_opt.models.strength_modes import PlyStrength, load_multiplier

PLY = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
STRAIN = {"poissons_ratio_12": 0.28, "modulus_ratio": 9 / 138}

CRITERIA = {
    "max_stress": strength_modes.inverse_max_stress,
    "max_strain": lambda **k: strength_modes.inverse_max_strain(**k, **STRAIN),
    "tsai_hill": strength.inverse_tsai_hill,
    "tsai_wu": strength.inverse_tsai_wu,
    "hashin": strength_modes.inverse_hashin,
    "puck": strength.inverse_puck,
}


def _stress(first, second, shear):
    return {"stress_1": first, "stress_2": second, "shear_12": shear, "strength": PLY}


def _used(name, stress, **options):
    return CRITERIA[name](**_stress(*stress), **options)


def _ratio(name, stress, **options):
    return load_multiplier(_used(name, stress, **options))


@pytest.mark.parametrize(
    ("name", "stress", "ratio"),
    [
        ("max_stress", (400.0, 30.0, 40.0), 1.83333),
        ("max_strain", (400.0, 30.0, 40.0), 2.125),
        ("tsai_hill", (400.0, 30.0, 40.0), 1.33634),
        ("tsai_wu", (400.0, 30.0, 40.0), 1.408903),
        ("hashin", (400.0, 30.0, 40.0), 1.388121),
        ("puck", (400.0, 30.0, 40.0), 1.323506),
        ("max_stress", (-300.0, -90.0, 60.0), 1.416667),
        ("max_strain", (-300.0, -90.0, 60.0), 1.416667),
        ("tsai_wu", (-300.0, -90.0, 60.0), 1.527765),
        ("hashin", (-300.0, -90.0, 60.0), 1.211654),
        ("puck", (-300.0, -90.0, 60.0), 1.567375),
        ("puck", (0.0, -20.0, 60.0), 1.565399),
    ],
)
def test_check_values(name, stress, ratio):
    """Strength ratios of ply P at the stated stresses (independent check)."""
    assert _ratio(name, stress) == pytest.approx(ratio, rel=2.5e-6)


def test_tsai_wu_variants():
    """F12* = 0 gives 1.294595; a radial stress of -25 MPa gives 1.459933 (independent check)."""
    plain = (400.0, 30.0, 40.0)
    assert _ratio("tsai_wu", plain, interaction=0.0) == pytest.approx(1.294595, rel=1e-6)
    assert _ratio("tsai_wu", plain, stress_3=-25.0) == pytest.approx(1.459933, rel=1e-6)


def test_tsai_wu_is_isotropic_across_the_fibre():
    """Turning the 2-3 stresses leaves Tsai-Wu unchanged when S23 is the default.

    sigma_2 = s, sigma_3 = -s is pure shear s in the 2-3 plane: with F23 = -F22/2 the form must
    give F44 s^2 = 2 (F22 - F23) s^2 = 3 F22 s^2.
    """
    value = _used("tsai_wu", (0.0, 40.0, 0.0), stress_3=-40.0)
    f22 = 1 / (55.0 * 190.0)
    assert value == pytest.approx(np.sqrt(3 * f22) * 40.0, rel=1e-12)
    known = {**_stress(0.0, 40.0, 0.0), "strength": replace(PLY, shear_23=62.0)}
    limit = strength.inverse_tsai_wu(**known, stress_3=-40.0)
    assert limit == pytest.approx(40.0 / 62.0, rel=1e-12)


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize(
    ("stress", "ratio"),
    [((190.0, 0.0, 0.0), 10.0), ((0.0, 5.5, 0.0), 10.0), ((0.0, 0.0, 8.5), 10.0)],
)
def test_uniaxial_stress_fails_at_its_strength(name, stress, ratio):
    """Every criterion meets the measured strength in fibre and transverse tension and in shear."""
    assert _ratio(name, stress) == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize("name", ["max_stress", "tsai_wu", "hashin", "puck"])
@pytest.mark.parametrize("stress", [(-1300.0, 0.0, 0.0), (0.0, -190.0, 0.0)])
def test_uniaxial_compression_fails_at_its_strength(name, stress):
    """The criteria with compression strengths meet them (Tsai-Hill uses tension always)."""
    assert _used(name, stress) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("name", CRITERIA)
def test_zero_stress_is_finite(name):
    """The inverse is 0 and the ratio infinite at zero stress, without a warning, for arrays too."""
    none = (np.zeros(3), np.zeros(3), np.zeros(3))
    assert np.all(_used(name, none) == 0)
    assert np.all(_ratio(name, none) == inf)
    assert _ratio(name, (0.0, 0.0, 0.0)) == inf


stresses = st.tuples(st.floats(-1500, 2000), st.floats(-250, 80), st.floats(-100, 100))


@given(st.sampled_from(sorted(CRITERIA)), stresses, st.floats(0.01, 50.0))
@settings(max_examples=150, deadline=None)
def test_utilisation_is_linear_in_the_load(name, stress, load):
    """1/SR of a multiple of a stress is that multiple of 1/SR; the sign of shear is nothing."""
    single = _used(name, stress)
    multiple = _used(name, [load * value for value in stress])
    mirrored = _used(name, (stress[0], stress[1], -stress[2]))
    assert multiple == pytest.approx(load * single, rel=1e-9, abs=1e-9)
    assert mirrored == pytest.approx(single, rel=1e-12, abs=1e-15)


@given(st.sampled_from(sorted(CRITERIA)), stresses)
@settings(max_examples=100, deadline=None)
def test_ratio_puts_the_ply_on_its_limit(name, stress):
    """At SR times the stress the utilisation is one."""
    ratio = _ratio(name, stress)
    if ratio < 1e6:
        limit = _used(name, [ratio * value for value in stress])
        assert limit == pytest.approx(1.0, rel=1e-9)


@given(stresses)
@settings(max_examples=60, deadline=None)
def test_residual_stress_is_not_multiplied(stress):
    """sigma_T + SR sigma_M lies on Tsai-Wu's surface and on max stress: the definition of SR."""
    residual = (-40.0, 18.0, 5.0)
    for name in ("tsai_wu", "max_stress"):
        ratio = _ratio(name, stress, residual=residual)
        if ratio < 1e5:
            total = [held + ratio * value for held, value in zip(residual, stress, strict=True)]
            assert _used(name, total) == pytest.approx(1.0, rel=1e-7)


def test_residual_that_fails_alone_is_nan():
    """A ply already broken by its residual stress has no load multiplier."""
    assert np.isnan(_ratio("tsai_wu", (1.0, 1.0, 1.0), residual=(0.0, 80.0, 0.0)))


def test_modes_are_named():
    """Max stress and Hashin tell which mode governs."""
    modes = strength_modes.max_stress_modes(**_stress(400.0, 30.0, 40.0))
    assert max(modes, key=modes.get) == "matrix tension"
    modes = strength_modes.hashin_modes(**_stress(-300.0, -90.0, 60.0))
    assert max(modes, key=modes.get) == "matrix compression"
    modes = strength_modes.max_stress_modes(**_stress(1.0, 1.0, 1.0), stress_3=-190.0)
    assert max(modes, key=modes.get) == "radial compression"
