"""Envelopes of models without a closed form: never less able than the exact model."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, strategies as st
from samples_tube import PLY

from actuator_opt.models import rod
from actuator_opt.models.layered_tube import (
    TubeLayer,
    layered_tube,
    ply_stresses_at_faces,
    tube_state,
)
from actuator_opt.models.solid_ply import solid_rotated, solid_stiffness
from actuator_opt.models.stepped import stepped_column_load
from actuator_opt.models.stiffness import hydraulic_stiffness
from actuator_opt.models.strength import yield_utilisation
from actuator_opt.models.strength_modes import PlyStrength, max_stress_modes
from actuator_opt.models.trial_motion import (
    TrialMotion,
    buckled_mode,
    least_energy_motion,
    trial_mode_load,
    trial_motion_stiffness,
)
from actuator_opt.models.tube_bounds import (
    axial_stiffness,
    greatest_pressure,
    least_growth,
    ply_hoop_strength,
)

RADIUS = 16e-3
ROUNDING = 1e-9
CARBON = solid_stiffness(**PLY)
METAL = solid_stiffness(
    youngs_modulus_1=70e9, youngs_modulus_2=70e9, youngs_modulus_3=70e9, poissons_ratio_12=0.33,
    poissons_ratio_13=0.33, poissons_ratio_23=0.33, shear_modulus_12=70e9 / 2.66,
)  # fmt: skip
LAYER = st.tuples(
    st.sampled_from([CARBON, METAL]),
    st.floats(0.0, pi / 2),
    st.floats(0.1e-3, 5e-3),
    st.lists(st.floats(-4, 4).filter(lambda b: abs(b) > 1e-3), min_size=1, max_size=3),
)
LOADS = ({"inner_pressure": 1.0}, {"axial_force": 1.0})
COLUMN = st.tuples(*[st.floats(1e2, 1e5)] * 2, *[st.floats(0.05, 1.0)] * 2)


def segments(bending_1, bending_2, length_1, length_2):
    """A stepped column between two pins."""
    return {
        "bending_stiffness_1": bending_1,
        "length_1": length_1,
        "bending_stiffness_2": bending_2,
        "length_2": length_2,
    }


@given(st.lists(LAYER, min_size=1, max_size=4), st.floats(0.0, 0.5))
def test_tube_bounds_hold(layers, contraction):
    """No lay-up grows less or is stiffer than its bounds, whatever the trial displacement."""
    stiffness, angles, thicknesses, decays = zip(*layers, strict=True)
    walls = [
        solid_rotated(stiffness=one, angle=angle)
        for one, angle in zip(stiffness, angles, strict=True)
    ]
    tube = layered_tube(
        layers=[
            TubeLayer(stiffness=one, angle=angle, thickness=thickness)
            for one, angle, thickness in zip(stiffness, angles, thicknesses, strict=True)
        ],
        inner_radius=RADIUS,
    )
    pressed, pulled = (tube_state(tube=tube, **load) for load in LOADS)
    growth, stretch = float(pressed.bore_displacement), float(pulled.axial_strain)
    free_of_strain = -float(pressed.axial_strain) / stretch
    held_growth = growth + float(pulled.bore_displacement) * free_of_strain
    # a pressure that keeps the bore where it is under axial force
    back = -float(pulled.bore_displacement) / growth
    held_stretch = stretch + float(pressed.axial_strain) * back
    size = {"thicknesses": thicknesses, "inner_radius": RADIUS}
    least = least_growth(
        hoop=[wall[3] for wall in walls],
        cross=[wall[4] for wall in walls],
        radial=[wall[5] for wall in walls],
        decays=decays,
        **size,
    )
    alike = [
        w[0] - 2 * contraction * (w[1] + w[2]) + contraction**2 * (w[3] + 2 * w[4] + w[5])
        for w in walls
    ]
    low = axial_stiffness(moduli=[rod.free_modulus(wall=wall) for wall in walls], **size)
    high = axial_stiffness(moduli=alike, **size)
    rigid = axial_stiffness(moduli=[wall[0] for wall in walls], **size)
    assert least <= held_growth * (1 + ROUNDING)
    assert held_growth <= growth * (1 + ROUNDING)
    assert low * (1 - ROUNDING) <= 1 / stretch <= high * (1 + ROUNDING)
    assert 1 / held_stretch <= rigid * (1 + ROUNDING)


def test_growth_is_exact_for_the_true_displacement():
    """A thick metal tube held axially in plane strain moves as a/r + b r: one power is close."""
    thin = 1e-6
    wall = solid_rotated(stiffness=METAL, angle=0.0)
    least = least_growth(
        hoop=[wall[3]], cross=[wall[4]], radial=[wall[5]], decays=[[wall[4] / wall[5]]],
        thicknesses=[thin], inner_radius=RADIUS,
    )  # fmt: skip
    plane_strain = 70e9 / (1 - 0.33**2)
    assert least == pytest.approx(RADIUS**2 / (plane_strain * thin), rel=1e-3)


STRENGTH = PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6)
YIELD = 240e6
WARM = {"expansion_1": 1e-6, "expansion_2": 28e-6, "expansion_3": 28e-6}
WARM_METAL = dict.fromkeys(WARM, 23e-6)
WALL = st.lists(
    st.tuples(st.booleans(), st.floats(0.0, pi / 2), st.floats(0.2e-3, 4e-3)),
    min_size=1,
    max_size=4,
)


@given(WALL, st.floats(0.0, 1.0), st.floats(-120.0, 0.0))
def test_no_wall_bears_more_before_its_first_damage(layers, capped, change):
    """The first ply failure or yield of any lay-up, cured or not, is below the balance's."""
    tube = layered_tube(
        layers=[
            TubeLayer(stiffness=METAL, thickness=t, **WARM_METAL)
            if metal
            else TubeLayer(stiffness=CARBON, angle=angle, thickness=t, **WARM)
            for metal, angle, t in layers
        ],
        inner_radius=RADIUS,
    )
    force = capped * pi * RADIUS**2
    load = ply_stresses_at_faces(
        tube=tube, state=tube_state(tube=tube, inner_pressure=1.0, axial_force=force)
    )
    held = ply_stresses_at_faces(tube=tube, state=tube_state(tube=tube, temperature_change=change))
    used = []
    for k, (metal, _, _) in enumerate(layers):
        own, cured = (tuple(part[:, k] for part in whole) for whole in (load, held))
        if metal:
            used.append(yield_utilisation(stress=own, yield_strength=YIELD, residual=cured))
        else:
            used += max_stress_modes(stress=own, strength=STRENGTH, residual=cured).values()
    first = 1 / max(float(np.max(one)) for one in used)
    most = greatest_pressure(
        yields=[YIELD if metal else None for metal, _, _ in layers],
        hoops=[
            None
            if metal
            else ply_hoop_strength(
                tension_1=STRENGTH.tension_1,
                tension_2=STRENGTH.tension_2,
                shear_12=STRENGTH.shear_12,
                angle=angle,
            )
            for metal, angle, _ in layers
        ],
        thicknesses=[t for _, _, t in layers],
        inner_radius=RADIUS,
    )
    assert first <= most * (1 + ROUNDING)


def test_a_thin_liner_and_a_thin_hoop_ply_bear_their_strengths():
    """Barlow: thin layers bear strength times thickness over radius, the liner at 2/sqrt(3)."""
    thin = 1e-6
    most = greatest_pressure(
        yields=[YIELD, None], hoops=[None, 1900e6], thicknesses=[thin, thin], inner_radius=RADIUS
    )
    assert most == pytest.approx((2 / 3**0.5 * YIELD + 1900e6) * thin / RADIUS, rel=1e-3)


@given(COLUMN, COLUMN)
def test_a_trial_mode_never_buckles_earlier(real, other):
    """The buckled shape of another column gives a load no less than the critical one."""
    shape = segments(*other)
    mode = buckled_mode(critical_load=stepped_column_load(**shape), **shape)
    trial, exact = (
        trial_mode_load(mode=mode, **segments(*real)),
        stepped_column_load(**segments(*real)),
    )
    assert trial >= exact * (1 - 1e-7)


@given(COLUMN)
def test_a_column_buckles_in_its_own_mode(real):
    """The shape in which a column buckles gives its critical load itself."""
    column = segments(*real)
    load = stepped_column_load(**column)
    own = trial_mode_load(mode=buckled_mode(critical_load=load, **column), **column)
    assert own == pytest.approx(load, rel=1e-6)


PART = st.floats(0.01, 1.0)


@given(
    st.tuples(*[PART] * 5), st.floats(-0.95, 0.95), st.tuples(*[st.floats(0.0, 0.5)] * 2),
    st.booleans(),
)  # fmt: skip
def test_a_trial_motion_is_never_softer(sizes, coupling, other, at_cap):
    """Two chambers in a wall whose growth and stretch go together, against the exact balance."""
    oil_a, oil_b, growth, stretch, extra = sizes
    cross = coupling * (growth * stretch) ** 0.5  # of a positive definite wall
    area_a, area_b, x, y = 1.0, 0.7, 0.6, 0.4
    length = x + y + extra
    # the wall's energy: p_A over x, p_B over the rest, the pull of one chamber over all of it
    pull = area_b if at_cap else area_a
    wetted = y + extra if at_cap else x
    own = stretch * pull**2 * length + 2 * cross * pull * wetted
    a = oil_a + growth * x + (0.0 if at_cap else own)
    b = oil_b + growth * (y + extra) + (own if at_cap else 0.0)
    ab = cross * pull * (x if at_cap else y + extra)
    exact = hydraulic_stiffness(
        area_a=area_a, compliance_a=a, area_b=area_b, compliance_b=b, compliance_ab=ab
    )
    held = growth - cross**2 / stretch
    pulled = (stretch - cross**2 / growth) * pull**2 * length
    parts = {
        "area_a": area_a, "area_b": area_b, "oil_a": oil_a, "oil_b": oil_b, "wall_a": held * x,
        "wall_b": held * (y + extra), "stretch": pulled, "pulling": "b" if at_cap else "a",
    }  # fmt: skip
    motions = least_energy_motion(**parts), TrialMotion(*other)
    found = [trial_motion_stiffness(motion=motion, **parts) for motion in motions]
    assert found[0] <= found[1] * (1 + ROUNDING)
    assert min(found) >= exact * (1 - ROUNDING)


def test_a_trial_motion_is_exact_of_alike_chambers():
    """Equal areas and oil: what one wall grows by the other shrinks by, so that nothing is lost."""
    parts = {
        "area_a": 1.0, "area_b": 1.0, "oil_a": 1.0, "oil_b": 1.0, "wall_a": 0.1, "wall_b": 0.1,
        "stretch": 1e-12, "pulling": "b",
    }  # fmt: skip
    motion = least_energy_motion(**parts)
    exact = hydraulic_stiffness(area_a=1.0, compliance_a=1.1, area_b=1.0, compliance_b=1.1)
    assert trial_motion_stiffness(motion=motion, **parts) == pytest.approx(exact, rel=1e-9)
