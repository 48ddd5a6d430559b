"""Ply failure criteria: published and independent check values, limits, names of the modes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial, reduce
from math import cos, inf, pi, sin, sqrt

import numpy as np
import pytest

from actuator_opt.models.strength import CRITERIA, tsai_wu_modes
from actuator_opt.models.strength_modes import (
    PlyRatios,
    PlyStrength,
    hashin_modes,
    load_multiplier,
    max_strain_modes,
    max_stress_modes,
    one_stress_modes,
    puck_modes,
)

PLY = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
RATIOS = PlyRatios(
    poissons_ratio_12=0.28, poissons_ratio_13=0.28, poissons_ratio_23=0.42, modulus_ratio=9 / 138
)
KAW = PlyStrength(1500.0, 1500.0, 40.0, 246.0, 68.0)
KAW_RATIOS = replace(RATIOS, modulus_ratio=10.3 / 181)
NAMES = {
    "max_stress": max_stress_modes,
    "max_strain": max_strain_modes,
    "tsai_wu": tsai_wu_modes,
    "hashin": hashin_modes,
    "puck": puck_modes,
}


def _used(criterion, first, second, shear, *, radial=0.0, strength=PLY, elastic=RATIOS):
    modes = criterion(stress=(first, second, radial, shear), strength=strength, elastic=elastic)
    return reduce(np.maximum, modes.values())


def _ratio(criterion, *stress, **options):
    return load_multiplier(_used(criterion, *stress, **options))


def test_registry_names_the_criteria():
    """A design may name these five."""
    assert {name: one.modes for name, one in CRITERIA.items()} == NAMES


@pytest.mark.parametrize(
    ("name", "stress", "ratio"),
    [
        ("max_stress", (400.0, 30.0, 40.0), 1.83333),
        ("max_strain", (400.0, 30.0, 40.0), 2.125),
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
    assert _ratio(CRITERIA[name].modes, *stress) == pytest.approx(ratio, rel=2.5e-6)


def test_check_values_of_the_variants():
    """Tsai-Wu 1.294595 with F12* = 0, 1.459933 at -25 MPa radial stress."""
    plain = (400.0, 30.0, 40.0)
    uncoupled = partial(tsai_wu_modes, interaction=0.0)
    assert _ratio(uncoupled, *plain) == pytest.approx(1.294595, rel=1e-6)
    assert _ratio(tsai_wu_modes, *plain, radial=-25.0) == pytest.approx(1.459933, rel=1e-6)


def test_lamina_example_of_kaw():
    """Kaw, Mechanics of Composite Materials, 2nd edition, section 2.8: graphite/epoxy at 60 deg.

    sigma_x = 2 S, sigma_y = -3 S, tau_xy = 4 S fails at S = 16.33 MPa by maximum stress and by
    maximum strain (shear), at 22.39 by Tsai-Wu with the Mises-Hencky F12.
    """
    c, s = cos(pi / 3), sin(pi / 3)
    first = 2 * c * c - 3 * s * s + 2 * 4 * s * c
    second = 2 * s * s - 3 * c * c - 2 * 4 * s * c
    shear = (-3 - 2) * s * c + 4 * (c * c - s * s)
    assert (first, second, shear) == pytest.approx((1.714, -2.714, -4.165), abs=5e-4)
    kaw = partial(_ratio, strength=KAW, elastic=KAW_RATIOS)
    for name, limit in (("max_stress", 16.33), ("max_strain", 16.33), ("tsai_wu", 22.39)):
        assert kaw(CRITERIA[name].modes, first, second, shear) == pytest.approx(limit, abs=5e-3)
        modes = CRITERIA[name].modes(
            stress=(first, second, 0.0, shear), strength=KAW, elastic=KAW_RATIOS
        )
        assert max(modes, key=modes.get) in ("shear", "interaction")


def test_tsai_wu_is_isotropic_across_the_fibre():
    """Turning the 2-3 stresses leaves Tsai-Wu unchanged, whether S23 is the default or known.

    sigma_2 = s, sigma_3 = -s is pure shear s in the 2-3 plane: with F23 = -F22/2 the form must
    give F44 s^2 = 2 (F22 - F23) s^2 = 3 F22 s^2, with S23 known (s/S23)^2.
    """
    f22 = 1 / (55.0 * 190.0)
    value = _used(tsai_wu_modes, 0.0, 40.0, 0.0, radial=-40.0)
    assert value == pytest.approx(sqrt(3 * f22) * 40.0, rel=1e-12)
    known = replace(PLY, shear_23=62.0)
    limit = _used(tsai_wu_modes, 0.0, 40.0, 0.0, radial=-40.0, strength=known)
    assert limit == pytest.approx(40.0 / 62.0, rel=1e-12)


def test_tsai_wu_of_equal_strengths_is_von_mises():
    """F12* = -1/2 with X = Y and S = X/sqrt(3) is von Mises over the strength, in 3-D too."""
    metal = PlyStrength(300.0, 300.0, 300.0, 300.0, 300.0 / sqrt(3))
    first, second, radial, shear = 120.0, -70.0, 35.0, 60.0
    squares = (first - second) ** 2 + (second - radial) ** 2 + (radial - first) ** 2
    mises = sqrt(squares / 2 + 3 * shear**2)
    value = _used(tsai_wu_modes, first, second, shear, radial=radial, strength=metal)
    assert value == pytest.approx(mises / 300.0, rel=1e-12)


def test_tsai_wu_has_no_limit_where_its_form_opens():
    """Pressure cannot fail von Mises, nor sigma_2 = sigma_3 < 0 a ply of small known S23."""
    metal = PlyStrength(300.0, 300.0, 300.0, 300.0, 300.0 / sqrt(3))
    assert _ratio(tsai_wu_modes, -50.0, -50.0, 0.0, radial=-50.0, strength=metal) > 1e6
    weak = replace(PLY, shear_23=45.0)
    assert _ratio(tsai_wu_modes, 0.0, -50.0, 0.0, radial=-50.0, strength=weak) == inf


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize(
    "stress", [(1900.0, 0.0, 0.0), (0.0, 55.0, 0.0), (0.0, 0.0, 85.0), (0.0, 0.0, -85.0)]
)
def test_uniaxial_stress_fails_at_its_strength(name, stress):
    """Every criterion meets the measured strength in fibre and transverse tension and in shear."""
    assert _used(CRITERIA[name].modes, *stress) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("stress", [(-1300.0, 0.0, 0.0), (0.0, -190.0, 0.0)])
def test_uniaxial_compression_fails_at_its_strength(name, stress):
    """The criteria with compression strengths meet them (Tsai-Hill uses tension always)."""
    assert _used(CRITERIA[name].modes, *stress) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("name", ["max_stress", "tsai_wu"])
@pytest.mark.parametrize("radial", [55.0, -190.0])
def test_radial_stress_fails_at_the_transverse_strength(name, radial):
    """Maximum stress and Tsai-Wu limit sigma_3 by the strengths across the fibre."""
    assert _used(CRITERIA[name].modes, 0.0, 0.0, 0.0, radial=radial) == pytest.approx(
        1.0, rel=1e-12
    )


def test_radial_stress_strains_the_ply():
    """Under sigma_3 alone E2 eps2 = -nu23 sigma_3, against Yt: SR = 55/(0.42 * 50)."""
    ratio = _ratio(max_strain_modes, 0.0, 0.0, 0.0, radial=-50.0)
    assert ratio == pytest.approx(55.0 / (0.42 * 50.0), rel=1e-12)


def test_maximum_strain_asks_for_the_elastic_ratios():
    """Without them it cannot be evaluated, and says so."""
    with pytest.raises(ValueError, match="ratios of the ply"):
        max_strain_modes(stress=(1.0, 0.0, 0.0, 0.0), strength=PLY)


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("residual", [None, (-40.0, 20.0, 3.0, 5.0), (40.0, -80.0, -3.0, 5.0)])
@pytest.mark.parametrize("kind", [float, complex])
def test_zero_load_is_finite(name, residual, kind):
    """No load uses nothing and may grow for ever, without a warning, for arrays too."""
    for none in (kind(0), np.zeros(3, dtype=kind)):
        modes = CRITERIA[name].modes(
            stress=(none, none, none, none), strength=PLY, residual=residual, elastic=RATIOS
        )
        for used in modes.values():
            assert np.all(used == 0)
            assert np.all(np.real(load_multiplier(used)) == inf)


def test_limits_of_the_load_multiplier():
    """SR is infinite without load and zero where the residual stress alone fails, complex too."""
    used = np.array([0.5, 0.0, inf], dtype=complex)
    assert load_multiplier(used).tolist() == [2.0, inf, 0.0]
    assert [load_multiplier(value) for value in (0.5, 0.0, inf)] == [2.0, inf, 0.0]
    assert load_multiplier(0.5 + 1e-30j).imag == pytest.approx(-4e-30)


def test_one_stress_leaves_what_the_residual_has_not_used():
    """(Xt - 20)/30 in tension, (Xc + 20)/30 in compression; a residual beyond Xt fails alone."""
    limits = {"tension": 55.0, "compression": 190.0, "residual": 20.0}
    assert one_stress_modes(stress=30.0, **limits) == pytest.approx((30 / 35, 0))
    assert one_stress_modes(stress=-30.0, **limits) == pytest.approx((0, 30 / 210))
    assert one_stress_modes(stress=-30.0, **{**limits, "residual": 60.0})[0] == inf


@pytest.mark.parametrize(
    ("name", "stress", "mode"),
    [
        ("max_stress", (400.0, 30.0, 0.0, 40.0), "matrix tension"),
        ("max_stress", (-1000.0, -30.0, 0.0, 40.0), "fibre compression"),
        ("max_stress", (1.0, 1.0, -190.0, 1.0), "radial compression"),
        ("max_stress", (1.0, 1.0, 40.0, 1.0), "radial tension"),
        ("max_strain", (400.0, 30.0, 0.0, 40.0), "shear"),
        ("tsai_wu", (400.0, 30.0, 0.0, 40.0), "interaction"),
        ("hashin", (400.0, 30.0, 0.0, 40.0), "matrix tension"),
        ("hashin", (-300.0, -90.0, 0.0, 60.0), "matrix compression"),
        ("hashin", (1800.0, 1.0, 0.0, 40.0), "fibre tension"),
        ("puck", (400.0, 30.0, 0.0, 40.0), "inter-fibre A"),
        ("puck", (0.0, -20.0, 0.0, 60.0), "inter-fibre B"),
        ("puck", (-300.0, -90.0, 0.0, 60.0), "inter-fibre C"),
        ("puck", (-1000.0, -20.0, 0.0, 40.0), "fibre compression"),
    ],
)
def test_the_governing_mode_is_named(name, stress, mode):
    """The largest utilisation carries the name of what happens."""
    modes = CRITERIA[name].modes(stress=stress, strength=PLY, elastic=RATIOS)
    assert max(modes, key=modes.get) == mode


def test_sides_of_the_ply_are_exclusive():
    """Hashin and Puck load one matrix mode at a time, by the sign of sigma_2 at failure."""
    for stress, matrix, wedge in (
        ((400.0, 30.0, 0.0, 40.0), "matrix tension", "inter-fibre A"),
        ((0.0, -20.0, 0.0, 60.0), "matrix compression", "inter-fibre B"),
        ((0.0, -90.0, 0.0, 60.0), "matrix compression", "inter-fibre C"),
    ):
        hashin, puck = (
            criterion(stress=stress, strength=PLY) for criterion in (hashin_modes, puck_modes)
        )
        assert [m for m, used in hashin.items() if used and "matrix" in m] == [matrix]
        assert [m for m, used in puck.items() if used and "inter" in m] == [wedge]
