"""Retention of the ends, end plates, guides, end of the stroke, fatigue."""

from __future__ import annotations

from itertools import product
from math import cos, cosh, inf, log, pi, sinh, sqrt, tanh
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import actuator_opt as ao
from actuator_opt.models import end_plate, endurance, lap_joint, retention


def peak_ratio(first, second, *, length, **bond):
    """Peak over mean shear of a bond: the larger of both edges."""
    edges = (
        lap_joint.bond_edge_shear(
            force=pi * length,
            diameter=1.0,
            length=length,
            membrane_stiffness_loaded=loaded,
            membrane_stiffness_free=free,
            **bond,
        )
        for loaded, free in ((first, second), (second, first))
    )
    return max(edges)


@given(st.floats(2e-3, 60e-3), st.floats(1e7, 1e9), st.floats(1e7, 1e9))
@settings(max_examples=40, deadline=None)
def test_bond_peak_solves_volkersens_equation(length, first, second):
    """The peak is that of tau'' = (w/L)^2 tau with the walls' force gradients at both ends.

    tau' = (G/t_a)(e_2 - e_1): at x = 0 wall 1 carries all, at x = L wall 2. With
    tau = A cosh(wx/L) + B sinh(wx/L) [derived], the ends are the only candidates for the peak.
    """
    g, ta, force = 1e9, 0.2e-3, 1.0
    w = sqrt(g / ta * length**2 * (1 / first + 1 / second))
    slope_0, slope_l = -g / ta * force / first, g / ta * force / second
    k = w / length
    b = slope_0 / k
    near = slope_l / (k * sinh(w)) - b / tanh(w)
    far = slope_l / (k * tanh(w)) - b / sinh(w)
    mean = force / length
    peak = max(abs(near), abs(far)) / mean
    value = peak_ratio(first, second, length=length, shear_modulus=g, bond_thickness=ta)
    assert value == pytest.approx(peak, rel=1e-6)
    assert value >= 1


@given(st.floats(1e6, 1e9), st.floats(1e6, 1e9), st.floats(1e-3, 80e-3))
def test_one_wall_bounds_the_peak_from_below(first, second, length):
    """Neither wall alone promises more than the peak; equal walls promise the peak itself."""
    size = {"length": length, "shear_modulus": 1e9, "bond_thickness": 0.2e-3}
    peak = peak_ratio(first, second, **size)
    for wall in (first, second):
        assert lap_joint.least_bond_peak_ratio(**size, membrane_stiffness=wall) <= peak * (
            1 + 1e-12
        )
    same = peak_ratio(first, first, **size)
    least = lap_joint.least_bond_peak_ratio(**size, membrane_stiffness=first)
    assert least == pytest.approx(same, rel=1e-12)


EDGE = {"length": 20e-3, "shear_modulus": 1e9, "bond_thickness": 0.2e-3}


@pytest.mark.parametrize(("first", "second"), [(100e6, 50e6), (30e6, 300e6)])
def test_bond_edges_carry_the_force(first, second):
    """Shear that starts and ends at the two edge values and obeys tau'' = k^2 tau carries F.

    [derived] k^2 = (G/t_a)(1/K_1 + 1/K_2); the solution through both edges integrates in closed
    form to (tau_0 + tau_L) tanh(k L/2)/k per circumference. The walls' equation
    tau' = (G/t_a)(e_2 - e_1) then holds at the edge where wall 1 still carries everything.
    """
    length, g, ta = (EDGE[key] for key in ("length", "shear_modulus", "bond_thickness"))
    force, around = 1e4, pi * 30e-3
    size = {**EDGE, "force": force, "diameter": 30e-3}
    near = lap_joint.bond_edge_shear(
        **size, membrane_stiffness_loaded=first, membrane_stiffness_free=second
    )
    far = lap_joint.bond_edge_shear(
        **size, membrane_stiffness_loaded=second, membrane_stiffness_free=first
    )
    k = sqrt(g / ta * (1 / first + 1 / second))
    assert around * (near + far) * tanh(k * length / 2) / k == pytest.approx(force, rel=1e-12)
    slope = k * (far - near * cosh(k * length)) / sinh(k * length)
    assert slope == pytest.approx(-g / ta * force / around / first, rel=1e-9)


@pytest.mark.parametrize(("clamped", "factor"), [(False, 1.2375), (True, 0.75)])
def test_solid_plate(clamped, factor):
    """Supported 3 (3 + nu)/8 = 1.2375 p (a/t)^2 at nu 0.3; clamped 0.75 (Timoshenko, Roark)."""
    stress = end_plate.end_plate_stress(
        pressure=1.0, radius=3.0, thickness=1.0, poissons_ratio=0.3, clamped=clamped
    )
    assert stress == pytest.approx(9 * factor)


def test_fastenings_share_their_force():
    """Tie rods share evenly over the stress area; a pin in double shear carries half per plane."""
    stress = retention.tie_rod_stress(force=4e4, count=4, diameter=10e-3, pitch=1.5e-3)
    assert stress == pytest.approx(1e4 / 57.99e-6, rel=1e-4)
    assert retention.pin_shear_stress(force=1e4, diameter=10e-3) == pytest.approx(
        0.5e4 / (pi / 4 * 1e-4)
    )


@given(st.floats(1.0, 1e4), st.floats(0.0, 2.0), st.floats(0.01, 1.0))
@settings(max_examples=30, deadline=None)
def test_guide_forces_balance(force, overhang, span):
    """Head less piston force is the side force, and the moments about the head vanish."""
    head, piston = retention.guide_forces(side_force=force, overhang=overhang, span=span)
    assert head - piston == pytest.approx(force, rel=1e-9)
    assert piston * span == pytest.approx(force * overhang, rel=1e-9)
    pressure = retention.bearing_pressure(force=head, diameter=12e-3, length=10e-3)
    assert pressure * 120e-6 == pytest.approx(head, rel=1e-12)  # projected area 120 mm^2


def beam_on_bearings(force, overhang, spans, stiffness, plays):
    """Forces on three bearings with play, by beam elements and springs that switch on contact."""
    cuts = [overhang, *spans]
    sizes = [length / 4 for length in cuts for _ in range(4)]
    rigidity = [ei for ei in (stiffness[0], *stiffness) for _ in range(4)]
    nodes = len(sizes) + 1
    matrix = np.zeros((2 * nodes, 2 * nodes))
    for k, (h, ei) in enumerate(zip(sizes, rigidity, strict=True)):
        element = ei / h**3 * np.array([
            [12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
            [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h],
        ])  # fmt: skip
        matrix[2 * k : 2 * k + 4, 2 * k : 2 * k + 4] += element
    places, spring = (8, 16, 24), 1e13
    load = np.zeros(2 * nodes)
    load[0] = force
    for sides in product((-1, 0, 1), repeat=3):  # pressed down, free, or up
        total, right = matrix.copy(), load.copy()
        for place, side, play in zip(places, sides, plays, strict=True):
            total[place, place] += spring if side else 0.0
            right[place] += spring * side * play
        if sum(map(abs, sides)) < 2:
            continue
        shift = np.linalg.solve(total, right)
        at = shift[list(places)]
        forces = [
            -spring * (y - side * play) if side else 0.0
            for y, side, play in zip(at, sides, plays, strict=True)
        ]
        held = all(f * side <= 1e-9 for f, side in zip(forces, sides, strict=True))
        if held and all(abs(y) <= c + 2e-8 for y, c in zip(at, plays, strict=True)):
            return -forces[0], forces[1], forces[2]
    raise AssertionError("no state of the contacts is in balance")


@pytest.mark.parametrize("force", [1.0, 40.0, 300.0, 2000.0, 20000.0])
@pytest.mark.parametrize(
    ("spans", "stiffness", "plays"),
    [
        ((0.1, 0.15), (1600.0, 1600.0), (3e-5, 5e-5, 2e-5)),
        ((0.2, 0.05), (1600.0, 300.0), (3e-5, 5e-5, 2e-5)),
        ((0.06, 0.3), (400.0, 900.0), (1e-5, 1e-5, 8e-5)),
        ((0.1, 0.1), (1600.0, 1600.0), (0.0, 2e-5, 1e-6)),
    ],
)
def test_a_through_rod_on_three_bearings(force, spans, stiffness, plays):
    """Beam elements with contact find the same forces in every state of the contacts."""
    found = retention.through_rod_guide_forces(
        side_force=force, overhang=0.2, span=spans[0], second_span=spans[1],
        bending_stiffness=stiffness[0], second_bending_stiffness=stiffness[1],
        clearance=plays[0], piston_clearance=plays[1], second_clearance=plays[2],
    )  # fmt: skip
    assert found == pytest.approx(
        beam_on_bearings(force, 0.2, spans, stiffness, plays), rel=1e-3, abs=1e-3 * force
    )


def test_limits_of_a_through_rod():
    """No play: three moments, P = F e (1/b1 + 1/(2 b2)); much play at one bearing: a lever."""
    sizes = {
        "side_force": 100.0, "overhang": 0.2, "span": 0.1, "second_span": 0.25,
        "bending_stiffness": 1600.0, "second_bending_stiffness": 1600.0, "clearance": 0.0,
    }  # fmt: skip
    tight = retention.through_rod_guide_forces(**sizes, piston_clearance=0.0, second_clearance=0.0)
    assert tight[1] == pytest.approx(20 * (1 / 0.1 + 1 / 0.5))
    assert tight[2] == pytest.approx(-20 * 0.1 / (2 * 0.25 * 0.35))
    wide = retention.through_rod_guide_forces(**sizes, piston_clearance=1.0, second_clearance=0.0)
    assert wide == pytest.approx((100 + 20 / 0.35, 0.0, 20 / 0.35))
    free = retention.through_rod_guide_forces(**sizes, piston_clearance=0.0, second_clearance=1.0)
    assert free[:2] == pytest.approx(
        retention.guide_forces(side_force=100.0, overhang=0.2, span=0.1)
    )
    assert free[2] == pytest.approx(0.0, abs=1e-9)


def test_guide_friction_is_that_of_a_cosine_pressure():
    """Quadrature: mu times the sum of the pressures whose resultant is the force, either way."""
    resultant, _ = quad(lambda a: cos(a) ** 2, -pi / 2, pi / 2)
    normal, _ = quad(cos, -pi / 2, pi / 2)
    for force in (2e3, -2e3):
        found = retention.guide_friction(force=force, friction_coefficient=0.1)
        assert found == pytest.approx(0.1 * 2e3 * normal / resultant)


def test_end_stop_check_value():
    """Mass 40, v 0.3, F 6000, k 3e7: 1.8 J kinetic, 0.6 mm, 18 kN (independent check)."""
    stop = {"driving_force": 6000.0, "stiffness": 3e7, "mass": 40.0, "velocity": 0.3}
    travel = endurance.end_stop_compression(**stop)
    assert travel == pytest.approx(0.6e-3, rel=1e-12)
    energy = endurance.end_stop_energy(
        driving_force=6000.0, compression=travel, mass=40.0, velocity=0.3
    )
    assert energy == pytest.approx(1.8 + 6000 * 0.6e-3, rel=1e-12)
    peak = endurance.end_stop_peak_force(stiffness=3e7, compression=travel)
    assert peak == pytest.approx(18e3, rel=1e-12)
    assert energy == pytest.approx(3e7 * travel**2 / 2, rel=1e-12)
    pressure = endurance.end_stop_peak_pressure(pressure=1e6, peak_force=peak, area=1e-3)
    assert pressure == pytest.approx(19e6, rel=1e-12)


@given(st.floats(0.01, 0.59))
@settings(max_examples=30, deadline=None)
def test_life_and_strength_are_one_line(share):
    """Cycles at a stress, and the amplitude at those cycles, are inverse through Goodman."""
    metal = {"ultimate_strength": 700e6, "fatigue_limit": 250e6, "limit_cycles": 2e6}
    peak = share * 2 * 700e6
    cycles = endurance.cycles_to_failure(peak_stress=peak, **metal)
    slope = log(250e6 / 630e6) / log(2e6 / 1e3)
    amplitude = 630e6 * (cycles / 1e3) ** slope  # 0.9 R_m at 1e3 cycles (Shigley)
    assert peak / 2 / (1 - peak / 2 / 700e6) == pytest.approx(amplitude, rel=1e-9)
    factor = endurance.fatigue_factor(
        peak_stress=peak, ultimate_strength=700e6, amplitude_strength=amplitude
    )
    assert factor == pytest.approx(1.0, rel=1e-9)


def test_fatigue_at_the_ends_of_its_range():
    """No tension lives for ever, a mean stress at R_m not at all; no warning, no NaN."""
    stress = np.array([-1e6, 0.0, 400e6, 1400e6, 2000e6])
    life = endurance.cycles_to_failure(
        peak_stress=stress, ultimate_strength=700e6, fatigue_limit=250e6
    )
    assert life[0] == life[1] == inf
    assert 1e3 < life[2] < 1e8
    assert life[3] == life[4] == 0
    factor = endurance.fatigue_factor(
        peak_stress=stress, ultimate_strength=700e6, amplitude_strength=250e6
    )
    assert factor[0] == factor[1] == inf


ADHESIVE = {
    "length": 16e-3,
    "strength": 28e6,
    "shear_modulus": 1.2e9,
    "bond_thickness": 0.15e-3,
    "membrane_stiffness_loaded": 120e6,
    "membrane_stiffness_free": 140e6,
}


def test_breaking_force_of_a_ductile_bond_by_the_worked_numbers():
    """Energy 3.12667 N/mm, long: 457.209 N/mm alone, 385.209 with a mismatch of 6e-4; cap 224."""
    ductile = ADHESIVE | {"plastic_shear_strain": 0.1}
    long = ductile | {"length": 1.0}
    alone = lap_joint.ultimate_line_force(strain_difference=0.0, **long)
    assert alone == pytest.approx(457.209e3, rel=1e-5)
    both = lap_joint.ultimate_line_force(strain_difference=6e-4, **long)
    assert both == pytest.approx(385.209e3, rel=1e-5)
    capped = lap_joint.ultimate_line_force(strain_difference=0.0, **ductile | {"length": 8e-3})
    assert capped == pytest.approx(224e3, rel=1e-9)


@pytest.mark.parametrize("mismatch", [0.0, 4e-4, -3e-4])
def test_a_brittle_bond_breaks_at_the_sum_of_both_shears(mismatch):
    """Without plastic strain, the elastic shears of force and mismatch add up to the strength."""
    size = ADHESIVE | {"length": 80e-3}
    line = lap_joint.ultimate_line_force(
        strain_difference=mismatch, plastic_shear_strain=0.0, **size
    )
    elastic = {k: size[k] for k in ("length", "shear_modulus", "bond_thickness")}
    by_force = lap_joint.bond_edge_shear(
        force=line * pi * 30e-3,
        diameter=30e-3,
        membrane_stiffness_loaded=120e6,
        membrane_stiffness_free=140e6,
        **elastic,
    )
    by_heat = lap_joint.bond_thermal_shear(
        strain_difference=mismatch,
        membrane_stiffness_1=120e6,
        membrane_stiffness_2=140e6,
        **elastic,
    )
    assert by_force + by_heat == pytest.approx(28e6, rel=1e-6)


def shot(*, overlap, plastic, mismatch):
    """Breaking force: both walls and the adhesive's curve, integrated along the overlap."""
    lag, strong, thick, loaded, free = 1.2e9, 28e6, 0.15e-3, 120e6, 140e6

    def left(total):
        """Force of the loaded wall at its free end; it is 0 if the guessed total is right."""

        def along(x, state):
            gamma, force = state
            strain = force / loaded + mismatch - (total - force) / free
            return [strain / thick, np.clip(lag * gamma, -strong, strong)]

        start = [strong / lag + plastic, total]
        end = solve_ivp(along, (overlap, 0), start, rtol=1e-10, atol=1e-12)
        return end.y[1, -1] / total

    total = brentq(left, 50e3, 600e3, rtol=1e-10)
    assert abs(left(total)) < 1e-3
    return total


def by_formula(*, overlap, plastic, mismatch):
    """The same by the closed form."""
    bond = ADHESIVE | {"length": overlap, "plastic_shear_strain": plastic}
    return float(lap_joint.ultimate_line_force(strain_difference=mismatch, **bond))


@pytest.mark.parametrize("mismatch", [-3e-4, 0.0, 6e-4])
@pytest.mark.parametrize("plastic", [0.01, 0.1])
def test_breaking_force_of_a_ductile_bond_by_shooting(plastic, mismatch):
    """Short and long bonds break where the integration along their overlap says."""
    case = {"plastic": plastic, "mismatch": mismatch}
    longest = by_formula(overlap=1.0, **case) / 28e6
    for share in (0.5, 1.0, 1.3, 2.0):
        overlap = share * longest
        assert shot(overlap=overlap, **case) == pytest.approx(
            by_formula(overlap=overlap, **case), rel=2e-4
        )


@pytest.mark.parametrize(
    ("overlap", "alone", "cooled"),
    [(16e-3, 439.3, 379.0), (20e-3, 453.5, 383.8), (30e-3, 457.1, 385.2)],
)
def test_breaking_forces_of_the_page(overlap, alone, cooled):
    """The table of the page on bonded joints, in N/mm."""
    for force in (shot, by_formula):
        forces = [force(overlap=overlap, plastic=0.1, mismatch=e) / 1e3 for e in (0.0, 6e-4)]
        assert forces == pytest.approx([alone, cooled], abs=0.06)


def test_peel_by_the_worked_numbers():
    """A skirt of 2 mm, and one of 0.5 mm: 0.71 of it."""
    size = {
        "shear": 28e6, "adhesive_modulus": 3e9, "bond_thickness": 0.15e-3, "skirt_modulus": 71.7e9,
        "skirt_poissons_ratio": 0.33,
    }  # fmt: skip
    thick, thin = (lap_joint.edge_peel(**size, skirt_thickness=t) for t in (2e-3, 0.5e-3))
    assert thick == pytest.approx(30.9425e6, rel=1e-5)
    assert thin == pytest.approx(21.8796e6, rel=1e-5)


def test_force_and_heat_on_the_bond_of_a_knee():
    """With the adhesive's plastic strain stated, each temperature has a row of burst strength."""
    path = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"
    known = {"materials.epoxy_structural.plastic_shear_strain": "10 %"}
    plain, ductile = ao.evaluate(ao.read(path)), ao.evaluate(ao.read(path, set=known))
    assert any("checked apart" in text for text in plain.warnings)
    assert not any("checked apart" in text for text in ductile.warnings)
    row = ductile.metrics["retention_burst_factor"]
    assert row.place.startswith("with temperature, ")
    assert 0 < row.value < plain.metrics["retention_burst_factor"].value
