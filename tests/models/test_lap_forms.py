"""Bonds of a tube between two skirts, and of a tapered skirt, against independent solutions."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import expm, solve_banded

from actuator_opt.base.numeric import STEP
from actuator_opt.models import lap_joint

FORCE, RADIUS = 7273.57, 14e-3
AROUND = 2 * pi * RADIUS
ADHESIVE = {"length": 16e-3, "shear_modulus": 1.2e9, "bond_thickness": 0.15e-3}
LAG = 1.2e9 / 0.15e-3
TUBE, SKIRT = 120e6, 140e6
EQUAL = {
    **ADHESIVE,
    "outer_bond_diameter": 2 * RADIUS,
    "inner_bond_diameter": 2 * RADIUS,
    "tube_stiffness": TUBE * AROUND,
    "outer_stiffness": SKIRT * AROUND,
    "inner_stiffness": SKIRT * AROUND,
}
TAPERED = {**ADHESIVE, "skirt_stiffness": SKIRT, "tube_stiffness": TUBE}


def test_a_double_lap_by_the_worked_numbers():
    """Equal skirts: 12.6408 MPa at their edge, 5.43661 MPa at that of the tube."""
    edges = lap_joint.double_lap(force=FORCE, strain_difference=0.0, **EQUAL)
    assert edges.outer_at_skirts == pytest.approx(12.6408e6, rel=1e-5)
    assert edges.inner_at_skirts == pytest.approx(12.6408e6, rel=1e-5)
    assert edges.outer_at_tube == pytest.approx(5.43661e6, rel=1e-5)
    assert edges.inner_at_tube == pytest.approx(5.43661e6, rel=1e-5)
    assert edges.outer_force == pytest.approx(FORCE / 2, rel=1e-12)


def test_equal_skirts_are_single_laps_of_half_the_tube():
    """Each face is a single lap of half the force and half the tube, under force and heat."""
    edges = lap_joint.double_lap(force=0.0, strain_difference=6e-4, **EQUAL)
    single = lap_joint.bond_thermal_shear(
        strain_difference=6e-4,
        membrane_stiffness_1=TUBE / 2,
        membrane_stiffness_2=SKIRT,
        **ADHESIVE,
    )
    assert edges.inner_at_skirts == pytest.approx(single, rel=1e-12)
    assert edges.inner_at_tube == pytest.approx(-single, rel=1e-12)


def three_bars(force, strain, length, outer, inner, tube, skirt, core):
    """Edge shears and skirt forces by the matrix exponential of the four first-order equations."""
    system = np.zeros((5, 5))  # forces of both skirts, displacements relative to the tube, 1
    system[0, 2], system[1, 3] = pi * outer * LAG, pi * inner * LAG
    system[2] = [1 / skirt + 1 / tube, 1 / tube, 0, 0, -force / tube - strain]
    system[3] = [1 / tube, 1 / core + 1 / tube, 0, 0, -force / tube - strain]
    across = expm(system * length)
    conditions = np.array([across[0, 2:4] + across[1, 2:4], across[2, 2:4] - across[3, 2:4]])
    wanted = np.array([force - across[0, 4] - across[1, 4], across[3, 4] - across[2, 4]])
    start = np.array([0.0, 0.0, *np.linalg.solve(conditions, wanted), 1.0])
    end = across @ start
    return LAG * start[2], LAG * start[3], LAG * end[2], LAG * end[3], end[0], end[1]


@settings(max_examples=40, deadline=None)
@given(
    strain=st.floats(-1e-3, 1e-3),
    length=st.floats(4e-3, 20e-3),
    inner=st.floats(12e-3, 27e-3),
    tube=st.floats(3e6, 3e7),
    skirt=st.floats(2e6, 3e7),
    core=st.floats(2e6, 3e7),
)
def test_unequal_skirts_agree_with_three_bars(strain, length, inner, tube, skirt, core):
    """Both bonds at both edges, and the shares of the skirts."""
    size = (length, 28e-3, inner, tube, skirt, core)
    expected = np.array(three_bars(FORCE, strain, *size))
    edges = lap_joint.double_lap(
        force=FORCE,
        strain_difference=strain,
        length=length,
        shear_modulus=1.2e9,
        bond_thickness=0.15e-3,
        outer_bond_diameter=28e-3,
        inner_bond_diameter=inner,
        tube_stiffness=tube,
        outer_stiffness=skirt,
        inner_stiffness=core,
    )
    assert np.allclose(edges[:4], expected[:4], rtol=0, atol=1e-6 * abs(expected[:4]).max())
    assert np.allclose(edges[4:], expected[4:], rtol=0, atol=1e-6 * FORCE)


def fine(line, strain, length, taper, tip, skirt, tube, cells):
    """Shear along a tapered lap, by second-order differences on a fine grid."""
    x, step = np.linspace(0, length, cells + 1), length / cells
    wall = skirt * np.where(x < taper, tip + (1 - tip) * x / taper, 1.0)
    bands = np.zeros((3, cells + 1))
    bands[0, 2:] = bands[2, :-2] = 1 / step**2
    bands[1] = -2 / step**2 - LAG * (1 / wall + 1 / tube)
    bands[1, 0] = bands[1, -1] = 1.0
    load = np.full(cells + 1, -LAG * (line / tube + strain))
    load[0], load[-1] = 0.0, line
    force = solve_banded((1, 1), bands, load)
    second = LAG * (force * (1 / wall + 1 / tube) - line / tube - strain)
    shear = np.gradient(force, step)
    shear[0] = (force[1] - force[0]) / step - step * (2 * second[0] + second[1]) / 6
    shear[-1] = (force[-1] - force[-2]) / step + step * (2 * second[-1] + second[-2]) / 6
    return shear


def test_a_tapered_lap_by_the_worked_numbers():
    """Tapered to 0.2 over its length: 11.3609 MPa at the tip, 14.9072 MPa at the tube's edge."""
    edges = lap_joint.tapered_lap(
        line_force=FORCE / AROUND, strain_difference=0.0, taper_length=16e-3, tip=0.2, **TAPERED
    )
    assert edges.at_tip == pytest.approx(11.3609e6, rel=1e-5)
    assert edges.at_tube == pytest.approx(14.9072e6, rel=1e-5)


@pytest.mark.parametrize("strain", [0.0, 6e-4])
def test_a_taper_without_fall_is_a_plain_lap(strain):
    """A tip of full thickness: the shears of a single lap, from force and heat."""
    edges = lap_joint.tapered_lap(
        line_force=FORCE / AROUND, strain_difference=strain, taper_length=9e-3, tip=1.0, **TAPERED
    )
    common = {"force": FORCE, "diameter": 2 * RADIUS, **ADHESIVE}
    at_skirt = lap_joint.bond_edge_shear(
        membrane_stiffness_loaded=TUBE, membrane_stiffness_free=SKIRT, **common
    )
    at_tube = lap_joint.bond_edge_shear(
        membrane_stiffness_loaded=SKIRT, membrane_stiffness_free=TUBE, **common
    )
    heat = lap_joint.bond_thermal_shear(
        strain_difference=strain,
        membrane_stiffness_1=TUBE,
        membrane_stiffness_2=SKIRT,
        **ADHESIVE,
    )
    assert edges.at_tip == pytest.approx(at_skirt + heat, rel=2e-6)
    assert edges.at_tube == pytest.approx(at_tube - heat, rel=2e-6, abs=20.0)


@settings(max_examples=40, deadline=None)
@given(
    tip=st.floats(0.05, 1.0),
    length=st.floats(5e-3, 30e-3),
    share=st.floats(0.2, 1.0),
    skirt=st.floats(4e7, 3e8),
    tube=st.floats(4e7, 3e8),
    strain=st.floats(0.0, 4e-4),
)
def test_tapers_agree_with_a_fine_grid(tip, length, share, skirt, tube, strain):
    """Edge shears within the stated error; no larger shear between the edges."""
    cells = 4000
    taper = round(share * cells) / cells * length
    shear = fine(8e4, strain, length, taper, tip, skirt, tube, cells)
    edges = lap_joint.tapered_lap(
        line_force=8e4,
        strain_difference=strain,
        length=length,
        taper_length=taper,
        tip=tip,
        shear_modulus=1.2e9,
        bond_thickness=0.15e-3,
        skirt_stiffness=skirt,
        tube_stiffness=tube,
    )
    decays = taper * np.sqrt(LAG * (1 / skirt + 1 / tube))
    error = (1e-3 if decays < 14 else 1e-2) * abs(shear).max()
    assert edges.at_tip == pytest.approx(shear[0], abs=error)
    assert edges.at_tube == pytest.approx(shear[-1], abs=error)
    assert abs(shear[1:-1]).max() <= 1.0001 * max(abs(edges.at_tip), abs(edges.at_tube))


def test_slopes_of_both_forms():
    """The complex step agrees with differences for every number."""
    cases = (
        (lap_joint.double_lap, {"force": FORCE, "strain_difference": 2e-4, **EQUAL}, 4),
        (
            lap_joint.tapered_lap,
            {
                "line_force": 8e4,
                "strain_difference": 2e-4,
                "taper_length": 12e-3,
                "tip": 0.2,
                **TAPERED,
            },
            2,
        ),
    )
    for model, numbers, count in cases:
        for name, value in numbers.items():
            exact = np.imag(model(**numbers | {name: value * (1 + STEP * 1j)})[:count]) / STEP
            up, down = (np.array(model(**numbers | {name: value * k})) for k in (1.00001, 0.99999))
            assert np.allclose(exact, (up - down)[:count] / 2e-5, rtol=1e-5, atol=2e2)
