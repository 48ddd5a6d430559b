"""Laws every elementwise structural model obeys: broadcasting, derivatives, other namespaces."""

from __future__ import annotations

import doctest
import importlib
from math import pi

import array_api_strict as strict
import numpy as np
import pytest

from actuator_opt.models import barrel, column, laminate, retention, rod, strength
from actuator_opt.models.strength import PlyStrength

STEP = 1e-30
PLY = {
    "tension_1": 1900e6,
    "compression_1": 1300e6,
    "tension_2": 55e6,
    "compression_2": 190e6,
    "shear_12": 85e6,
}
STRESS = {"stress_1": 400e6, "stress_2": 30e6, "shear_12": 40e6}
PRESSED = {"stress_1": -300e6, "stress_2": -90e6, "shear_12": 60e6}
TUBE = {"inner_radius": 16e-3, "outer_radius": 20e-3}
METAL = {"youngs_modulus": 71.7e9, "poissons_ratio": 0.33}
LAMINA = {
    "youngs_modulus_1": 138e9,
    "youngs_modulus_2": 9e9,
    "poissons_ratio_12": 0.28,
    "shear_modulus_12": 5e9,
}
SHEET = {"a11": 1.1e8, "a12": 2e7, "a22": 1.5e8}
STEPPED = {
    "bending_stiffness_1": 5000.0,
    "length_1": 0.2,
    "bending_stiffness_2": 1200.0,
    "length_2": 0.18,
}
BOND = {
    "length": 20e-3,
    "shear_modulus": 1e9,
    "bond_thickness": 0.2e-3,
    "membrane_stiffness_1": 100e6,
    "membrane_stiffness_2": 50e6,
}
FATIGUE = {"ultimate_strength": 700e6, "fatigue_limit": 300e6, "limit_cycles": 2e6}
STOP = {"driving_force": 6000.0, "stiffness": 3e7, "mass": 40.0, "velocity": 0.3}


def _ply(function, **fixed):
    """Turn a criterion into a function of stresses and of every strength."""

    def call(**values):
        limits = {key: values.pop(key) for key in list(values) if key in PLY and key != "shear_12"}
        limits["shear_12"] = values.pop("shear_strength")
        return function(strength=PlyStrength(**limits), **values, **fixed)

    return call


def _strengths(stress):
    return {**PLY, "shear_strength": PLY["shear_12"], **stress}


def _rotated(*, angle, **lamina):
    return laminate.rotated(stiffness=laminate.ply_stiffness(**lamina), angle=angle)


def _ply_stresses(*, angle, axial_strain, hoop_strain, **lamina):
    return laminate.ply_stresses(
        stiffness=laminate.ply_stiffness(**lamina),
        angle=angle,
        axial_strain=axial_strain,
        hoop_strain=hoop_strain,
    )


def _thermal(*, angle, expansion_1, expansion_2, **lamina):
    return laminate.thermal_ply_load(
        stiffness=laminate.ply_stiffness(**lamina),
        angle=angle,
        expansion_1=expansion_1,
        expansion_2=expansion_2,
    )


def _sheet(function):
    def call(*, a11, a12, a22, **values):
        return function(membrane=(a11, a12, a22), **values)

    return call


def _bending(*, q1, q2, t1, t2):
    return laminate.bending_stiffness(plies=[(q1,), (q2,)], thicknesses=[t1, t2])


def _burst(*, inner, hoop, helical, angle, axial, youngs_modulus_2, tension_1, liner=True):
    """First ply, burst and liner yield of a wall with a metal liner."""
    lamina = {**LAMINA, "youngs_modulus_2": youngs_modulus_2}
    limits = PlyStrength(**{**PLY, "tension_1": tension_1})
    metal = laminate.WallLayer(
        youngs_modulus_1=71.7e9,
        youngs_modulus_2=71.7e9,
        poissons_ratio_12=0.33,
        shear_modulus_12=71.7e9 / 2.66,
        yield_strength=240e6,
        thickness=inner,
    )
    wound = [
        laminate.WallLayer(**lamina, strength=limits, thickness=hoop, angle=pi / 2),
        laminate.WallLayer(**lamina, strength=limits, thickness=helical, angle=angle),
    ]
    result = laminate.burst_by_ply_discount(
        layers=[metal, *wound] if liner else wound,
        radius=16e-3 + (inner + hoop + helical) / 2,
        axial_force_per_pressure=axial,
    )
    pressures = (result.first_ply_pressure, result.burst_pressure)
    return (*pressures, result.liner_yield_pressure) if liner else pressures


WALL = {
    "inner": 0.6e-3,
    "hoop": 1.2e-3,
    "helical": 0.8e-3,
    "angle": pi / 6,
    "axial": 9e-4,
    "youngs_modulus_2": 9e9,
    "tension_1": 1900e6,
}


def _stepped(*ends):
    return lambda **values: column.stepped_column_load(**values, ends=ends)


CASES = {
    "bore_growth": (barrel.bore_growth, {"pressure": 28e6, "axial_force": 9e3, **TUBE, **METAL}),
    "bore_growth_as_published": (
        barrel.bore_growth_as_published,
        {"pressure": 28e6, **TUBE, **METAL},
    ),
    "bore_stresses": (barrel.bore_stresses, {"pressure": 28e6, "axial_force": 9e3, **TUBE}),
    "von_mises": (barrel.von_mises, {"hoop": 128e6, "radial": -28e6, "axial": 50e6}),
    "burst_pressure_thick": (
        barrel.burst_pressure_thick,
        {
            "yield_strength": 355e6,
            "ultimate_strength": 490e6,
            "axial_force_ratio": 0.7,
            **TUBE,
        },
    ),
    "pressure_shortening": (
        barrel.pressure_shortening,
        {"pressure": 28e6, "length": 0.18, **TUBE, **METAL},
    ),
    "chamber_compliance": (
        barrel.chamber_compliance,
        {"inner_radius": 16e-3, "growth_per_pressure": 1e-12, "length": 0.18},
    ),
    "barrel_stiffness": (barrel.barrel_stiffness, {"area": 8e-4, "compliance": 2e-14}),
    "barrel_stiffness_as_published": (
        barrel.barrel_stiffness_as_published,
        {"pressure": 1e6, "bore": 25e-3, "growth": 3e-5, "stroke": 0.11},
    ),
    "decay_length": (
        barrel.decay_length,
        {
            "radius": 16.75e-3,
            "thickness": 1.5e-3,
            "hoop_modulus": 120e9,
            "axial_modulus": 9e9,
            "poissons_product": 0.05,
        },
    ),
    "step_ahead": (barrel.pressure_step_factor, {"distance": 3e-3, "decay_length": 4e-3}),
    "step_behind": (barrel.pressure_step_factor, {"distance": -3e-3, "decay_length": 4e-3}),
    "cap_mounted": (
        barrel.axial_force_cap_mounted,
        {"rod_side_pressure": 1e7, "rod_side_area": 3e-4, "stop_force": 100.0},
    ),
    "head_mounted": (
        barrel.axial_force_head_mounted,
        {"cap_side_pressure": 1e7, "cap_side_area": 5e-4},
    ),
    "tie_rod_forces": (
        barrel.tie_rod_forces,
        {
            "axial_force": 12e3,
            "preload": 9e3,
            "barrel_stiffness": 3e8,
            "tie_rod_stiffness": 9e7,
            "free_shortening": 3e-6,
        },
    ),
    "ply_stiffness": (laminate.ply_stiffness, LAMINA),
    "rotated": (_rotated, {**LAMINA, "angle": 0.6}),
    "ply_stresses": (
        _ply_stresses,
        {**LAMINA, "angle": 0.6, "axial_strain": 1e-3, "hoop_strain": 3e-3},
    ),
    "thermal_ply_load": (
        _thermal,
        {**LAMINA, "angle": 0.6, "expansion_1": 1e-6, "expansion_2": 28e-6},
    ),
    "strains": (
        _sheet(laminate.strains),
        {**SHEET, "axial_line_force": 2e5, "hoop_line_force": 5e5},
    ),
    "bore_growth_thin": (
        _sheet(laminate.bore_growth_thin),
        {**SHEET, "pressure": 25e6, "inner_radius": 16e-3, "axial_force": 9e3},
    ),
    "effective_moduli": (_sheet(laminate.effective_moduli), {**SHEET, "thickness": 2e-3}),
    "bending_stiffness": (_bending, {"q1": 1e11, "q2": 2e10, "t1": 1e-3, "t2": 2e-3}),
    "netting": (
        laminate.netting,
        {
            "pressure": 28e6,
            "radius": 16e-3,
            "angle": 0.6,
            "helical_stress": 1.4e9,
            "hoop_stress": 1.2e9,
        },
    ),
    "netting_angle": (laminate.netting_angle, {"line_force_ratio": 1.8}),
    "burst_liner": (_burst, WALL),
    "burst": (lambda **v: _burst(liner=False, **v), WALL),
    "max_stress": (_ply(strength.max_stress), _strengths(STRESS)),
    "max_stress_pressed": (_ply(strength.max_stress), _strengths(PRESSED)),
    "max_stress_residual": (
        _ply(strength.max_stress, residual=(-10e6, 20e6, 3e6)),
        _strengths(STRESS),
    ),
    "max_stress_radial": (
        _ply(strength.max_stress),
        _strengths({**STRESS, "stress_3": -150e6}),
    ),
    "max_strain": (
        _ply(strength.max_strain),
        _strengths({**STRESS, "poissons_ratio_12": 0.28, "modulus_ratio": 0.07}),
    ),
    "tsai_hill": (_ply(strength.tsai_hill), _strengths(STRESS)),
    "tsai_wu": (_ply(strength.tsai_wu), _strengths(STRESS)),
    "tsai_wu_radial": (_ply(strength.tsai_wu), _strengths({**STRESS, "stress_3": -25e6})),
    "tsai_wu_residual": (
        _ply(strength.tsai_wu, residual=(-10e6, 20e6, 3e6)),
        _strengths({**PRESSED, "stress_3": -25e6}),
    ),
    "hashin": (_ply(strength.hashin), _strengths(STRESS)),
    "hashin_pressed": (_ply(strength.hashin), _strengths(PRESSED)),
    "puck_a": (_ply(strength.puck), _strengths(STRESS)),
    "puck_b": (
        _ply(strength.puck),
        _strengths({"stress_1": 1e6, "stress_2": -20e6, "shear_12": 60e6}),
    ),
    "puck_c": (_ply(strength.puck), _strengths(PRESSED)),
    "axial_stiffness": (
        rod.axial_stiffness,
        {"youngs_modulus": 2e11, "outer_diameter": 12e-3, "inner_diameter": 6e-3, "length": 0.2},
    ),
    "axial_stiffness_as_published": (
        rod.axial_stiffness_as_published,
        {"youngs_modulus": 1.3e10, "outer_diameter": 12e-3, "length": 0.11},
    ),
    "rod_stress": (
        rod.rod_stress,
        {"force": 1e4, "outer_diameter": 12e-3, "inner_diameter": 6e-3},
    ),
    "bending_stress": (
        rod.bending_stress,
        {"bending_moment": 20.0, "outer_diameter": 12e-3, "inner_diameter": 6e-3},
    ),
    "thread_stress": (rod.thread_stress, {"force": 1e4, "diameter": 10e-3, "pitch": 1.5e-3}),
    "thread_shear_stress": (
        rod.thread_shear_stress,
        {"force": 1e4, "diameter": 10e-3, "pitch": 1.5e-3, "engagement": 8e-3},
    ),
    "johnson_short": (
        column.johnson_load,
        {
            "area": 2e-4,
            "second_moment": 3.2e-9,
            "youngs_modulus": 2.1e11,
            "yield_strength": 6e8,
            "effective_length": 0.2,
        },
    ),
    "johnson_long": (
        column.johnson_load,
        {
            "area": 2e-4,
            "second_moment": 3.2e-9,
            "youngs_modulus": 2.1e11,
            "yield_strength": 6e8,
            "effective_length": 0.6,
        },
    ),
    "cowper_tube": (column.cowper_tube, {"poissons_ratio": 0.28, "radius_ratio": 0.75}),
    "engesser_load": (column.engesser_load, {"critical_load": 1e5, "shear_stiffness": 9e5}),
    "local_shell_stress": (
        column.local_shell_stress,
        {"youngs_modulus": 7e10, "thickness": 1.2e-3, "radius": 15e-3, "poissons_ratio": 0.3},
    ),
    "stepped_pp": (_stepped("pinned", "pinned"), STEPPED),
    "stepped_fp": (_stepped("fixed", "pinned"), STEPPED),
    "stepped_pf": (_stepped("pinned", "fixed"), STEPPED),
    "stepped_ff": (_stepped("fixed", "fixed"), STEPPED),
    "stepped_free": (_stepped("fixed", "free"), STEPPED),
    "stepped_guided": (_stepped("guided", "fixed"), STEPPED),
    "stepped_rolling": (_stepped("pinned", "guided"), STEPPED),
    "bond_shear_peak": (
        retention.bond_shear_peak,
        {"force": 1e4, "diameter": 30e-3, **BOND},
    ),
    "tie_rod_stress": (
        retention.tie_rod_stress,
        {"force": 2e4, "count": 4.0, "diameter": 6e-3, "pitch": 1e-3},
    ),
    "pin_shear_stress": (retention.pin_shear_stress, {"force": 1e4, "diameter": 1e-2}),
    "guide_forces": (
        retention.guide_forces,
        {"side_force": 100.0, "overhang": 0.2, "span": 0.1},
    ),
    "bearing_pressure": (
        retention.bearing_pressure,
        {"force": 300.0, "diameter": 12e-3, "length": 1e-2},
    ),
    "end_plate_stress": (
        retention.end_plate_stress,
        {"pressure": 1e7, "radius": 12e-3, "thickness": 5e-3, "poissons_ratio": 0.3},
    ),
    "annular_plate_stress": (
        retention.annular_plate_stress,
        {
            "pressure": 1e7,
            "radius": 12e-3,
            "hole_radius": 6e-3,
            "thickness": 5e-3,
            "poissons_ratio": 0.3,
            "edge_force": 500.0,
        },
    ),
    "fatigue_strength": (retention.fatigue_strength, {"cycles": 1e5, **FATIGUE}),
    "cycles_to_failure": (
        retention.cycles_to_failure,
        {"peak_stress": 420e6, "stress_ratio": 0.1, **FATIGUE},
    ),
    "fatigue_factor": (
        retention.fatigue_factor,
        {"peak_stress": 4e8, "ultimate_strength": 7e8, "amplitude_strength": 3e8},
    ),
    "end_stop_compression": (retention.end_stop_compression, STOP),
    "end_stop_energy": (
        retention.end_stop_energy,
        {"driving_force": 6e3, "compression": 6e-4, "mass": 40.0, "velocity": 0.3},
    ),
    "trapped_pressure_rate": (
        retention.trapped_pressure_rate,
        {
            "liquid_expansion": 7e-4,
            "wall_axial_expansion": 12e-6,
            "wall_hoop_expansion": 11e-6,
            "bulk_modulus": 1.4e9,
            "wall_compliance_per_volume": 1.4e-10,
        },
    ),
}


def _flat(result):
    return list(result) if isinstance(result, tuple) else [result]


def _array(value):
    """Convert a value of any namespace to a NumPy array."""
    return np.asarray(value.tolist() if hasattr(value, "tolist") else value)


@pytest.mark.parametrize("name", CASES)
def test_complex_step_is_the_derivative(name):
    """The imaginary part under a tiny imaginary step is the central difference, per argument."""
    function, sample = CASES[name]
    names = list(sample)
    values = np.array([sample[key] for key in names])
    step = 1e-5 * np.abs(values)
    batch = np.repeat(values.astype(complex)[:, None], len(names), axis=1)
    batch[np.arange(len(names)), np.arange(len(names))] += 1j * STEP
    exact = _flat(function(**{key: batch[i][None, :] for i, key in enumerate(names)}))
    up, down = values[:, None] + np.diag(step), values[:, None] - np.diag(step)
    above = _flat(function(**{key: up[i][None, :] for i, key in enumerate(names)}))
    below = _flat(function(**{key: down[i][None, :] for i, key in enumerate(names)}))
    for derivative, high, low in zip(exact, above, below, strict=True):
        shape = np.broadcast_shapes(np.shape(high), (1, len(names)))
        slope = np.broadcast_to(np.imag(derivative) / STEP, shape) * np.abs(values)
        difference = np.broadcast_to(np.real(high) - np.real(low), shape)
        scale = np.max(np.abs(np.real(high)))
        np.testing.assert_allclose(slope, difference / (2e-5), rtol=2e-6, atol=2e-7 * scale)


@pytest.mark.parametrize("name", CASES)
def test_arrays_broadcast_like_scalars(name):
    """An array of designs and load cases gives each element what the scalars give."""
    function, sample = CASES[name]
    factors = np.array([0.97, 1.0, 1.04])
    names = list(sample)
    arrays = {
        key: sample[key] * (factors[:, None] if i % 2 else factors[None, :])
        for i, key in enumerate(names)
    }
    together = _flat(function(**arrays))
    for row in range(3):
        for col in range(3):
            each = {
                key: float(sample[key] * factors[row if i % 2 else col])
                for i, key in enumerate(names)
            }
            for array, value in zip(together, _flat(function(**each)), strict=True):
                place = np.broadcast_to(array, (3, 3))[row, col]
                assert isinstance(value, float)
                assert place == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_runs_in_any_array_namespace(name):
    """Only the array-API standard is used, real and complex: a strict namespace agrees."""
    function, sample = CASES[name]
    for kind in (strict.float64, strict.complex128):
        arrays = {key: strict.asarray([[value]], dtype=kind) for key, value in sample.items()}
        plain = _flat(function(**sample))
        for array, value in zip(_flat(function(**arrays)), plain, strict=True):
            assert np.real(_array(array)).ravel()[0] == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(
    "module",
    [
        "barrel",
        "barrel_ends",
        "column",
        "end_plate",
        "endurance",
        "laminate",
        "netting",
        "ply",
        "ply_discount",
        "retention",
        "rod",
        "stepped",
        "stepped_segments",
        "strength",
        "strength_modes",
    ],
)
def test_examples_in_docstrings(module):
    """Every example in a docstring prints what it says."""
    result = doctest.testmod(importlib.import_module(f"actuator_opt.models.{module}"))
    assert result.attempted > 0
    assert result.failed == 0
