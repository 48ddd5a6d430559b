"""Laws of every failure criterion, and residual stress against root finding along the load.

The criteria are written here a second time, as plain exposures of a stress: 1 is failure.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import reduce
from math import inf

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from actuator_opt.base.numeric import maximum
from actuator_opt.models.strength import CRITERIA
from actuator_opt.models.strength_modes import PlyRatios, PlyStrength, load_multiplier

PLY = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
PLIES = {
    "carbon": PLY,
    "measured S23": replace(PLY, shear_23=62.0),
    "weak across": replace(PLY, shear_23=40.0),
    "strong in compression": PlyStrength(1000.0, 2500.0, 80.0, 120.0, 60.0),
    "Kaw": PlyStrength(1500.0, 1500.0, 40.0, 246.0, 68.0),
}
E1, E2, NU12, NU13, NU23 = 138e3, 9e3, 0.28, 0.31, 0.42
RATIOS = PlyRatios(
    poissons_ratio_12=NU12, poissons_ratio_13=NU13, poissons_ratio_23=NU23, modulus_ratio=E2 / E1
)


def _max_stress(stress, ply):
    first, second, radial, shear = stress
    across = [
        value / limit for value in (second, radial) for limit in (ply.tension_2, -ply.compression_2)
    ]
    along = [first / ply.tension_1, -first / ply.compression_1]
    return np.max([*along, *across, np.abs(shear) / ply.shear_12], axis=0)


def _max_strain(stress, ply):
    first, second, radial, shear = stress
    strain_1 = first / E1 - NU12 / E1 * second - NU13 / E1 * radial
    strain_2 = second / E2 - NU12 / E1 * first - NU23 / E2 * radial
    shares = [
        strain_1 / (ply.tension_1 / E1), -strain_1 / (ply.compression_1 / E1),
        strain_2 / (ply.tension_2 / E2), -strain_2 / (ply.compression_2 / E2),
    ]  # fmt: skip
    return np.max([*shares, np.abs(shear) / ply.shear_12], axis=0)


def _tsai_wu(stress, ply):
    f11, f22 = 1 / (ply.tension_1 * ply.compression_1), 1 / (ply.tension_2 * ply.compression_2)
    f1, f2 = 1 / ply.tension_1 - 1 / ply.compression_1, 1 / ply.tension_2 - 1 / ply.compression_2
    f12 = -0.5 * np.sqrt(f11 * f22)
    f23 = -f22 / 2 if ply.shear_23 is None else f22 - 0.5 / ply.shear_23**2
    form = np.diag([f11, f22, f22, 1 / ply.shear_12**2])
    form[0, 1] = form[1, 0] = form[0, 2] = form[2, 0] = f12
    form[1, 2] = form[2, 1] = f23
    vector = np.array(np.broadcast_arrays(*stress))
    linear = np.tensordot([f1, f2, f2, 0.0], vector, 1)
    return linear + np.einsum("i...,ij,j...->...", vector, form, vector)


def _hashin(stress, ply):
    first, second, _, shear = stress
    slip = (shear / ply.shear_12) ** 2
    across = ply.shear_12 if ply.shear_23 is None else ply.shear_23
    fibre = np.where(first >= 0, (first / ply.tension_1) ** 2 + slip, -first / ply.compression_1)
    pressed = (second / (2 * across)) ** 2 + slip
    pressed = pressed + ((ply.compression_2 / (2 * across)) ** 2 - 1) * second / ply.compression_2
    return np.maximum(fibre, np.where(second >= 0, (second / ply.tension_2) ** 2 + slip, pressed))


def _puck(stress, ply):
    first, second, _, shear = stress
    p, q, s, up, down = 0.35, 0.30, ply.shear_12, ply.tension_2, ply.compression_2
    plane = s / (2 * q) * (np.sqrt(1 + 2 * q * down / s) - 1)
    steep = q * plane / s
    limit = s * np.sqrt(1 + 2 * steep)
    mode_a = np.sqrt((shear / s) ** 2 + ((1 - p * up / s) * second / up) ** 2) + p * second / s
    mode_b = (np.sqrt(shear**2 + (q * second) ** 2) + q * second) / s
    pressed = np.where(second < 0, -second, 1.0)
    mode_c = ((shear / (2 * (1 + steep) * s)) ** 2 + (second / down) ** 2) * down / pressed
    sheared = pressed * limit <= plane * np.abs(shear)
    between = np.where(second >= 0, mode_a, np.where(sheared, mode_b, mode_c))
    return np.max([first / ply.tension_1, -first / ply.compression_1, between], axis=0)


PLAIN = {
    "max_stress": _max_stress, "max_strain": _max_strain, "tsai_wu": _tsai_wu,
    "hashin": _hashin, "puck": _puck,
}  # fmt: skip


def _used(name, stress, ply=PLY, residual=None):
    """Largest utilisation of the modes."""
    modes = CRITERIA[name].modes(stress=stress, strength=ply, residual=residual, elastic=RATIOS)
    return reduce(np.maximum, modes.values())


def _first_failure(plain, ply, residual, load):
    """SR by marching along the load in steps of 1 % and bisecting the first that fails.

    Arrays (4, n) of stresses give n ratios: 0 where the residual stress fails, infinite beyond
    a ratio of 1000.
    """
    march = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 1400)])
    failed = plain(residual[:, :, None] + march * load[:, :, None], ply) >= 1
    step = failed.argmax(axis=1)
    low, high = march[np.maximum(step, 1) - 1], march[np.maximum(step, 1)]
    for _ in range(60):
        middle = (low + high) / 2
        beyond = plain(residual + middle * load, ply) >= 1
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return np.where(failed.any(axis=1), np.where(step > 0, high, 0.0), inf)


@pytest.mark.parametrize("ply", PLIES.values(), ids=PLIES)
@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("held", [0.0, 0.4, 0.9])
def test_ratio_is_the_first_failure_along_the_load(name, ply, held):
    """SR in closed form equals root finding on the plain criterion, residual stress or none.

    Residual stresses reach up to 0.9 of every strength at once, so that some fail alone, and the
    loads cross sigma_1 = 0 and sigma_2 = 0 both ways.
    """
    draw = np.random.default_rng(20)
    count = 400
    size = np.array([ply.tension_1, ply.compression_2, ply.compression_2 / 2, ply.shear_12])
    residual = held * size[:, None] * draw.uniform(-1, 1, (4, count))
    load = size[:, None] * draw.normal(size=(4, count)) * 10 ** draw.uniform(-1, 0.5, count)
    load = load * (draw.random((4, count)) < 0.8)
    ratio = load_multiplier(_used(name, tuple(load), ply, tuple(residual)))
    expected = _first_failure(PLAIN[name], ply, residual, load)
    tested = ratio < 1e3
    assert np.count_nonzero(tested) > count / 2
    np.testing.assert_allclose(ratio[tested], expected[tested], rtol=1e-8)
    assert np.all(expected[ratio >= 1e3] >= 999)


@pytest.mark.parametrize(
    ("name", "residual", "load", "ratio"),
    [
        # (Yt - residual)/load; the shear that is left under sigma_2 = 20
        ("hashin", (-40.0, 20.0, 0.0, 0.0), (0.0, 5.0, 0.0, 0.0), 7.0),
        ("hashin", (-40.0, 20.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 85 * np.sqrt(1 - (20 / 55) ** 2)),
        # out of compression beyond Yt into tension
        ("hashin", (0.0, -100.0, 0.0, 0.0), (0.0, 10.0, 0.0, 0.0), 15.5),
        ("puck", (0.0, -100.0, 0.0, 0.0), (0.0, 10.0, 0.0, 0.0), 15.5),
        ("puck", (0.0, 50.0, 0.0, 0.0), (0.0, -10.0, 0.0, 0.0), 24.0),
        # mode B is a parabola: tau^2 = S^2 + 2 q S |sigma_2|
        ("puck", (0.0, -20.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), np.sqrt(85**2 + 0.6 * 85 * 20)),
        ("max_stress", (0.0, 0.0, -90.0, 10.0), (0.0, 0.0, -50.0, 50.0), 1.5),
        ("max_strain", (0.0, 0.0, -50.0, 0.0), (0.0, 2.0, 0.0, 0.0), (55 - 0.42 * 50) / 2),
    ],
)
def test_residual_stress_by_hand(name, residual, load, ratio):
    """Cases solved on paper: one stress at a time, or where two surfaces meet."""
    assert load_multiplier(_used(name, load, residual=residual)) == pytest.approx(ratio, rel=1e-12)


def test_hashin_fibre_fails_as_it_is_pulled():
    """Out of residual compression with tau above S, which sigma_2 < 0 alone has borne: SR = 1.

    With S23 = 40 the matrix reaches only 0.12 of its limit at sigma_2 = -61, tau = 86.
    """
    stress, residual = (100.0, -1.0, 0.0, 86.0), (-100.0, -60.0, 0.0, 0.0)
    modes = CRITERIA["hashin"].modes(
        stress=stress, strength=PLIES["weak across"], residual=residual, elastic=None
    )
    assert modes["fibre tension"] == pytest.approx(1.0, rel=1e-12)
    assert max(modes, key=modes.get) == "fibre tension"


def test_tsai_wu_with_residual_stress_by_hand():
    """Transverse only: F22 s^2 + F2 s = 1 has the roots Yt and -Yc, less the residual stress."""
    for load, ratio in ((5.0, 7.0), (-5.0, 42.0)):
        used = _used("tsai_wu", (0.0, load, 0.0, 0.0), residual=(0.0, 20.0, 0.0, 0.0))
        assert load_multiplier(used) == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("kind", [float, complex])
@pytest.mark.parametrize(
    "residual",
    [
        (0.0, 60.0, 0.0, 0.0),
        (2000.0, 0.0, 0.0, 0.0),
        (0.0, -200.0, 0.0, 0.0),
        (0.0, 0.0, 0.0, 90.0),
    ],
)
def test_residual_that_fails_alone_is_infinite(name, kind, residual):
    """A ply broken by its residual stress has SR = 0, whatever the load; nothing is NaN."""
    for load in ((0.0, 0.0, 0.0, 0.0), (-90.0, 20.0, -5.0, 10.0), (90.0, -20.0, 5.0, -10.0)):
        arrays = tuple(np.array([value, value], dtype=kind) for value in load)
        used = CRITERIA[name].modes(stress=arrays, strength=PLY, residual=residual, elastic=RATIOS)
        assert not any(np.any(np.isnan(value)) for value in used.values())
        largest = reduce(maximum, used.values())
        assert np.all(np.real(largest) == inf)
        assert np.all(load_multiplier(largest) == 0)


def _values(low, high):
    """Stresses in steps of 1/1000 of a unit: no subnormal numbers."""
    return st.integers(low * 1000, high * 1000).map(lambda number: number / 1000)


names = st.sampled_from(sorted(CRITERIA))
plies = st.sampled_from(list(PLIES.values()))
loads = st.tuples(_values(-1500, 2000), _values(-250, 80), _values(-80, 20), _values(-100, 100))
residuals = st.tuples(_values(-300, 300), _values(-60, 30), _values(-15, 15), _values(-30, 30))


@given(names, plies, loads, st.floats(0.01, 50.0))
def test_utilisation_is_linear_in_the_load(name, ply, load, factor):
    """Without residual stress 1/SR of a multiple of a stress is that multiple of 1/SR."""
    multiple = _used(name, tuple(factor * value for value in load), ply)
    assert multiple == pytest.approx(factor * _used(name, load, ply), rel=1e-9, abs=1e-9)
    assert multiple >= 0


@given(names, plies, loads, residuals)
def test_sign_of_shear_does_not_matter(name, ply, load, residual):
    """Turning all shear around changes nothing."""
    mirrored, turned = ((*stress[:3], -stress[3]) for stress in (load, residual))
    expected = _used(name, load, ply, residual)
    assert _used(name, mirrored, ply, turned) == pytest.approx(expected, rel=1e-12, abs=1e-15)


@given(names, plies, loads, residuals, st.floats(0.0, 0.95))
def test_a_share_of_the_load_held_back_counts_once(name, ply, load, residual, share):
    """Holding a times the load as residual stress lowers SR by a: the failure point stays."""
    ratio = load_multiplier(_used(name, load, ply, residual))
    assume(0 < ratio < 1e3)
    held = tuple(a + share * ratio * b for a, b in zip(residual, load, strict=True))
    rest = load_multiplier(_used(name, load, ply, held))
    assert rest == pytest.approx((1 - share) * ratio, rel=1e-6)


@given(names, plies, loads, residuals)
def test_small_residual_stress_is_none(name, ply, load, residual):
    """The residual stress fades out continuously, but for Hashin's own jump at sigma_1 = 0."""
    assume(name != "hashin" or load[0] != 0)
    tiny = tuple(1e-9 * value for value in residual)
    expected = _used(name, load, ply)
    assert _used(name, load, ply, tiny) == pytest.approx(expected, rel=1e-6, abs=1e-7)
    none = (0.0, 0.0, 0.0, 0.0)
    assert _used(name, load, ply, none) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@given(names, plies, loads, residuals, st.floats(1.0, 3.0))
def test_stronger_plies_last_longer(name, ply, load, residual, factor):
    """Scaling all strengths up never lowers SR, and scales it without residual stress.

    Tsai-Wu's surface is closed only if S23 is at least half of sqrt(Yt Yc): below that, the ply
    never fails under some stresses, and whether it does depends on the residual stress.
    """
    across = ply.shear_23
    closed = across is None or 4 * across**2 >= ply.tension_2 * ply.compression_2
    assume(name != "tsai_wu" or closed)
    numbers = {f.name: getattr(ply, f.name) for f in fields(ply)}
    stronger = PlyStrength(**{k: v if v is None else factor * v for k, v in numbers.items()})
    assert _used(name, load, stronger, residual) <= _used(name, load, ply, residual) * (1 + 1e-9)
    scaled = factor * _used(name, load, stronger)
    assert scaled == pytest.approx(_used(name, load, ply), rel=1e-9, abs=1e-9)


@given(names, plies, _values(-1000, 1500), _values(-80, 80))
def test_no_jump_where_sigma_2_changes_sign(name, ply, first, shear):
    """SR is continuous across sigma_2 = 0."""
    below, at, above = (_used(name, (first, s, 0.0, shear), ply) for s in (-1e-7, 0.0, 1e-7))
    assert below == pytest.approx(at, rel=1e-6, abs=1e-8)
    assert above == pytest.approx(at, rel=1e-6, abs=1e-8)


@given(names, plies, _values(-90, 38), st.floats(0.1, 10.0))
def test_no_jump_where_the_load_leads_across_sigma_2(name, ply, held, speed):
    """From a residual sigma_2 to tau = S at sigma_2 = 0, the one point on every surface."""
    assume(_used(name, (0.0, 0.0, 0.0, 0.0), ply, (0.0, held, 0.0, 0.0)) == 0)
    for nudge in (-1e-9, 0.0, 1e-9):
        load = (0.0, -held * speed * (1 + nudge), 0.0, ply.shear_12 * speed)
        used = _used(name, load, ply, (0.0, held, 0.0, 0.0))
        assert used == pytest.approx(speed, rel=1e-6)
