"""Claims every hydraulic model keeps: array = scalar, complex step, namespaces, documentation.

`SAMPLES` holds one regular point of every public function; seal laws come from their registry.
"""

from __future__ import annotations

import doctest
import importlib
import inspect
import re

import array_api_strict as strict
import numpy as np
import pytest

from actuator_opt.models import seals

MODULES = (
    "damping", "density", "dynamics", "elements", "fluid", "forces", "friction", "gland",
    "lines", "lugre", "mass", "seals", "stiffness", "stiffness_published",
)  # fmt: skip

RING = {"squeeze": 0.16, "section": 2e-3, "growth": 3e-5, "tolerance": 2e-5}
CHAMBERS = {"area_a": 8e-4, "area_b": 5.5e-4, "compliance_a": 5e-14, "compliance_b": 4e-14}
STRIBECK = {
    "speed": 0.015, "coulomb": 500.0, "static": 900.0, "stribeck_speed": 0.02, "exponent": 1.4,
}  # fmt: skip
TAIT = {"temperature": 320.0, "pressure": 9e6}
STATE = {
    "pressure_a": 9e6, "pressure_b": 4e5, "area_a": 8e-4, "area_b": 5e-4, "friction": 90.0,
}  # fmt: skip
TUBE = {
    "inner_diameter": 9.5e-3, "outer_diameter": 12e-3, "length": 0.6, "youngs_modulus": 17.8e9,
    "poissons_ratio": 0.3,
}  # fmt: skip

SAMPLES = {
    "damping.pipe_flow": {"dynamic_viscosity": 0.04, "length": 0.2},
    "damping.annular_couette": {
        "dynamic_viscosity": 0.04, "length": 0.2, "inner_radius": 9e-3, "outer_radius": 0.02,
    },
    "damping.flat_gap": {
        "dynamic_viscosity": 0.04, "diameter": 0.02, "length": 0.02, "gap": 3e-5,
    },
    "damping.piston_gap_damper": {
        "dynamic_viscosity": 0.04, "length": 0.02, "radius": 0.02, "gap": 3e-5,
    },
    "damping.gap_leakage": {
        "diameter": 0.04, "gap": 3e-5, "dynamic_viscosity": 0.04, "length": 0.02,
        "pressure_difference": 5e6, "eccentricity": 0.4,
    },
    "damping.secant": {"friction": 500.0, "speed": 0.05},
    "damping.power_law": {"speed": 0.01, "coefficient": 1e3, "exponent": -0.8},
    "damping.double_exponential": {
        "speed": 0.01, "coefficient_1": 2e5, "rate_1": -400.0, "coefficient_2": 5e4,
        "rate_2": -20.0,
    },
    "density.density_dowson_higginson": {"reference_density": 870.0, "pressure": 2e7},
    "density.density_thermal": {
        "reference_density": 870.0, "volume_expansion": 7e-4, "temperature": 320.0,
    },
    "density.density_tait": TAIT,
    "density.thermal_pressure_slope": {
        "volume_expansion": 7e-4, "wall_expansion_axial": 1e-5, "wall_expansion_hoop": 2e-5,
        "bulk_modulus": 1.4e9, "wall_compliance_per_volume": 1.3e-10,
    },
    "dynamics.natural_frequency": {"stiffness": 2e7, "mass": 30.0},
    "dynamics.friction_damping_ratio": {
        "incremental_damping": 400.0, "stiffness": 2e7, "mass": 30.0,
    },
    "dynamics.conductance_damping_ratio": {
        "stiffness": 2e7, "mass": 30.0, "conductance_a": 1e-12, "conductance_b": 2e-12, **CHAMBERS,
    },
    "dynamics.damping_ratio": {
        "incremental_damping": 400.0, "stiffness": 2e7, "mass": 30.0, "conductance_a": 1e-12,
        "conductance_b": 2e-12, **CHAMBERS,
    },
    "dynamics.dynamic_stiffness": {
        "frequency": 15.0, "mass": 30.0, "damping": 400.0, "admittance_a": 1e-11,
        "admittance_b": 3e-12, **CHAMBERS,
    },
    "elements.resistance": {"inner_diameter": 8e-3, "length": 1.2, "dynamic_viscosity": 0.04},
    "elements.inertance": {"inner_diameter": 8e-3, "length": 1.2, "density": 865.0},
    "elements.capacitance": {"volume": 6e-5, "bulk_modulus": 1.4e9},
    "elements.sound_speed": {"bulk_modulus": 1.4e9, "density": 865.0},
    "elements.quarter_wave_frequency": {"length": 1.2, "sound_speed": 1272.0},
    "elements.resonance_frequency": {"inertance": 2e7, "capacitance": 4.3e-14},
    "elements.orifice_flow": {
        "area": 3e-5, "pressure_difference": -5e5, "density": 870.0, "smoothing_pressure": 1e4,
    },
    "fluid.viscosity_astm_d341": {
        "temperature": 330.0, "points_temperature": (233.0, 313.0, 373.0),
        "points_viscosity": (6e-4, 1.32e-5, 4.9e-6),
    },
    "fluid.dynamic_viscosity": {"kinematic_viscosity": 4.6e-5, "density": 870.0},
    "fluid.barus": {"viscosity": 0.04, "pressure": 2e7, "coefficient": 1.8e-8},
    "fluid.roelands": {"viscosity": 0.04, "pressure": 2e7, "coefficient": 1.8e-8},
    "fluid.bulk_modulus_linear": {"bulk_modulus": 1.4e9, "slope": 6.0, "pressure": 2e7},
    "fluid.bulk_modulus_warm": {
        "bulk_modulus": 1.4e9, "decay": 0.0058, "temperature": 330.0,
        "reference_temperature": 313.0,
    },
    "fluid.bulk_modulus_tait": TAIT,
    "fluid.secant_bulk_modulus_tait": TAIT,
    "fluid.effective_bulk_modulus": {
        "bulk_modulus": 1.6e9, "pressure": 3e6, "air_content": 0.01, "polytropic_index": 1.3,
    },
    "fluid.trapped_bubble_volume_change": {
        "volume": 1e-4, "air_volume": 2e-7, "bulk_modulus": 1.5e9, "pressure": 4e6,
        "initial_pressure": 2e6,
    },
    "forces.piston_area": {"bore": 0.025},
    "forces.annulus_area": {"bore": 0.025, "rod_diameter": 0.012},
    "forces.push_force": STATE,
    "forces.pull_force": STATE,
    "forces.efficiency": {"force": 4e3, "pressure": 1e7, "area": 5e-4},
    "forces.pressure_loss": {"friction": 166.0, "area": 4.9e-4},
    "forces.chamber_flow": {"area": 5e-4, "speed": 0.1},
    "forces.piston_speed": {"flow": 5e-5, "area": 5e-4},
    "forces.power": {"force": 3e3, "speed": 0.1},
    "forces.joint_force": {"torque": 120.0, "lever_arm": 0.04},
    "forces.crank": {"base_radius": 0.3, "crank_radius": 0.04, "joint_angle": 1.1},
    "friction.seal_friction": {
        "line_load": 2e3, "diameter": 0.025, "friction_coefficient": 0.1, "count": 2.0,
    },
    "friction.cylinder_friction": {
        "piston_line_load": 2e3, "bore": 0.025, "piston_friction_coefficient": 0.1,
        "rod_line_load": 1e3, "rod_diameter": 0.012, "rod_friction_coefficient": 0.2,
    },
    "friction.coulomb_as_published": {
        "pressure": 1e6, "friction_coefficient": 0.61, "piston_contact_width": 1e-3,
        "bore": 0.025, "rod_contact_width": 1.1e-3, "rod_diameter": 0.012,
    },
    "friction.breakaway": {"running": 100.0, "ratio": 2.0},
    "friction.stribeck_level": STRIBECK,
    "friction.stribeck": {**STRIBECK, "viscous": 1e3, "smoothing_speed": 0.01},
    "friction.stribeck_slope": {**STRIBECK, "viscous": 1e3},
    "gland.squeeze_after": RING,
    "gland.stretched_section": {"section": 2e-3, "stretch": 0.03},
    "gland.gland_depth": {"squeeze": 0.16, "section": 2e-3},
    "gland.squeeze_in_place": {**RING, "stretch": 0.03},
    "gland.gland_fill": {"section": 2e-3, "groove_width": 2.4e-3, "gland_depth": 1.7e-3},
    "gland.extrusion_gap": {"clearance": 3e-5, "growth": 2e-5},
    "gland.limited_width": {"contact_width": 3e-3, "groove_width": 2.6e-3},
    "lines.line_compliance": TUBE,
    "lines.line_volume": {"inner_diameter": 8e-3, "length": 1.2},
    "lines.line_velocity": {"flow": 1e-4, "inner_diameter": 8e-3},
    "lines.port_velocity": {"flow": 1e-4, "port_diameter": 8e-3},
    "lines.reynolds": {"velocity": 4.0, "diameter": 8e-3, "kinematic_viscosity": 3.2e-5},
    "lines.line_pressure_drop": {
        "flow": 2.5e-4, "inner_diameter": 8e-3, "length": 1.2, "density": 865.0,
        "dynamic_viscosity": 0.011,
    },
    "lugre.lugre_step": {
        "deflection": 1e-5, "speed": -0.02, "time_step": 1e-3, "level": 600.0,
        "bristle_stiffness": 1e7, "bristle_damping": 3e4, "viscous": 1e3,
    },
    "lugre.lugre_steady_deflection": {"speed": -0.1, "level": 500.0, "bristle_stiffness": 1e7},
    "lugre.lugre_passive_speed": {"level": 500.0, "bristle_damping": 4e4, "viscous": 1e3},
    "lugre.lugre_tapered_damping": {"bristle_damping": 3e4, "speed": 0.02, "taper_speed": 0.03},
    "lugre.lugre_bristle_stiffness": {"static": 1e3, "largest_deflection": 1e-4},
    "lugre.lugre_bristle_damping": {"bristle_stiffness": 1e7, "mass": 234.0},
    "mass.tube_mass": {
        "density": 7850.0, "inner_diameter": 6e-3, "outer_diameter": 0.012, "length": 0.15,
    },
    "mass.disc_mass": {"density": 2700.0, "diameter": 0.03, "thickness": 8e-3},
    "mass.piston_groove_volume": {"diameter": 0.025, "depth": 1.7e-3, "width": 2.4e-3},
    "mass.rod_groove_volume": {"diameter": 0.012, "depth": 1.7e-3, "width": 2.4e-3},
    "mass.pitch_diameter": {"diameter": 0.01, "pitch": 1.5e-3},
    "mass.stud_mass": {"density": 7850.0, "diameter": 0.01, "pitch": 1.5e-3, "length": 0.02},
    "mass.tie_rod_mass": {"density": 7850.0, "diameter": 6e-3, "length": 0.2, "count": 4.0},
    "mass.eye_volume": {"pin_diameter": 8e-3},
    "mass.eye_length": {"pin_diameter": 8e-3},
    "mass.ring_mass": {"density": 1300.0, "section": 2e-3, "centre_diameter": 0.023},
    "mass.oil_mass": {"density": 870.0, "volume": 6e-5},
    "seals.width_as_published": {"section": 2e-3, "gland_height": 1.7e-3},
    "seals.modulus_gent": {"hardness": 75.0},
    "seals.modulus_ruess": {"hardness": 75.0},
    "stiffness.chamber_compliance": {
        "volume": 7e-5, "bulk_modulus": 1.4e9, "wall_compliance": 2e-14,
    },
    "stiffness.chamber_stiffness": {
        "area": 5e-4, "volume": 7e-5, "bulk_modulus": 1.4e9, "wall_compliance": 2e-14,
    },
    "stiffness.hydraulic_stiffness": CHAMBERS,
    "stiffness.weakest_position": {
        "area_a": 8e-4, "area_b": 5e-4, "compliance_a0": 6e-15, "compliance_a_per_length": 6e-13,
        "compliance_b0": 6e-15, "compliance_b_per_length": 4e-13, "stroke": 0.16,
    },
    "stiffness.holding_pressures": {
        "force": 3e3, "supply_pressure": 1.4e7, "return_pressure": 2e5, "area_a": 8e-4,
        "area_b": 5e-4,
    },
    "stiffness.trapped_air_load_step": {
        "force": -2e3, "area_a": 8e-4, "area_b": 5.5e-4, "volume_a": 7e-5, "volume_b": 5e-5,
        "air_volume_a": 2e-7, "air_volume_b": 1e-7, "initial_pressure_a": 2e6,
        "initial_pressure_b": 3e6, "bulk_modulus": 1.5e9,
    },
    "stiffness_published.series_of_totals_as_published": {
        "oil": 2e7, "barrel": 4e8, "rod": 3e8, "lines": 9e7, "other": 1e8,
    },
    "stiffness_published.oil_stiffness_as_published": {
        "bulk_modulus_a": 8e8, "bulk_modulus_b": 9e8, "area_a": 5e-4, "area_b": 4e-4,
        "volume_a": 5e-5, "volume_b": 4e-5,
    },
    "stiffness_published.barrel_stiffness_as_published": {
        "bore": 0.04, "outer_diameter": 0.05, "area": 1.2e-3, "chamber_length": 0.11,
        "youngs_modulus": 2.1e11, "poissons_ratio": 0.3,
    },
    "stiffness_published.line_stiffness_as_published": {"area": 1.2e-3, **TUBE},
    "stiffness_published.cylinder_expansion_as_published": {
        "pressure": 1e6, "area": 4.9e-4, "stroke": 0.11,
    },
}  # fmt: skip


def resolve(name):
    """Look up a ``module.function`` name."""
    module, function = name.split(".")
    return getattr(importlib.import_module(f"actuator_opt.models.{module}"), function)


def laws():
    """Seal laws join the samples by their registry, so that a new entry is covered by itself."""
    ring = {"squeeze": 0.17, "section": 2e-3, "youngs_modulus": 6e6, "pressure": 3e6}
    for law in seals.LAWS.values():
        for quantity in ("line_load", "contact_width", "peak_pressure"):
            yield pytest.param(getattr(law, quantity), ring, id=f"{law.name}.{quantity}")


CASES = [pytest.param(resolve(n), k, id=n) for n, k in SAMPLES.items()] + list(laws())


def flat(result):
    """Return the outputs as a list (named tuples have several)."""
    return list(result) if isinstance(result, tuple) else [result]


def scaled(value, factor):
    """Argument, or tuple of arguments, times a factor."""
    return tuple(v * factor for v in value) if isinstance(value, tuple) else value * factor


@pytest.mark.parametrize(("function", "point"), CASES)
def test_array_equals_scalar(function, point):
    """Arrays of shape (3, 1) and (2,) broadcast; every element equals the scalar call."""
    names = list(point)
    rows, columns = np.array([[0.99], [1.0], [1.01]]), np.array([1.0, 1.005])
    arguments = {n: scaled(v, rows if i % 2 else columns) for i, (n, v) in enumerate(point.items())}
    results = flat(function(**arguments))
    for i in range(3):
        for j in range(2):
            one = {
                n: scaled(point[n], float(rows[i, 0]) if k % 2 else float(columns[j]))
                for k, n in enumerate(names)
            }
            for array, scalar in zip(results, flat(function(**one)), strict=True):
                element = np.broadcast_to(array, (3, 2))[i, j]
                assert element == pytest.approx(scalar, rel=1e-12)


@pytest.mark.parametrize(("function", "point"), CASES)
def test_complex_step_equals_central_difference(function, point):
    """d/d(each argument) by an imaginary step agrees with a central difference."""
    for name, value in point.items():
        slots = range(len(value)) if isinstance(value, tuple) else [None]
        for slot in slots:

            def moved(change, name=name, slot=slot, value=value):
                if slot is None:
                    return {**point, name: change(value)}
                return {**point, name: tuple(change(v) if i == slot else v
                                             for i, v in enumerate(value))}  # fmt: skip

            base = value if slot is None else value[slot]
            h = 1e-6 * abs(base)
            step = moved(lambda v: np.array([complex(v, 1e-30)]))
            for exact, high, low in zip(
                flat(function(**step)),
                flat(function(**moved(lambda v, h=h: v + h))),
                flat(function(**moved(lambda v, h=h: v - h))),
                strict=True,
            ):
                difference = (high - low) / (2 * h)
                slope = np.imag(np.asarray(exact, dtype=complex)).ravel()[0] / 1e-30
                scale = abs(high) / abs(base)
                assert slope == pytest.approx(difference, rel=2e-5, abs=2e-8 * scale)


@pytest.mark.parametrize(("function", "point"), CASES)
def test_any_array_namespace(function, point):
    """Strict array-API arrays give the NumPy numbers: no NumPy-only function, no in-place write."""

    def array(value, xp):
        if isinstance(value, tuple):
            return tuple(array(v, xp) for v in value)
        return xp.asarray([value, value * 1.001], dtype=xp.float64)

    ours = flat(function(**{n: array(v, strict) for n, v in point.items()}))
    numpy = flat(function(**{n: array(v, np) for n, v in point.items()}))
    for one, other in zip(ours, numpy, strict=True):
        np.testing.assert_allclose(np.asarray(one), other, rtol=1e-12)


@pytest.mark.parametrize(("function", "point"), CASES)
def test_arguments_are_left_alone(function, point):
    """No function writes into its arguments."""
    arguments = {
        n: v if isinstance(v, tuple) else np.array([v, 1.01 * v]) for n, v in point.items()
    }
    copies = {n: v if isinstance(v, tuple) else v.copy() for n, v in arguments.items()}
    function(**arguments)
    for name, value in arguments.items():
        np.testing.assert_array_equal(value, copies[name])


def public_functions():
    """Public functions defined in the modules."""
    found = []
    for name in MODULES:
        module = importlib.import_module(f"actuator_opt.models.{name}")
        for key, value in vars(module).items():
            own = inspect.isfunction(value) and value.__module__ == module.__name__
            if own and not key.startswith("_"):
                found.append(pytest.param(value, id=f"{name}.{key}"))
    return found


@pytest.mark.parametrize("function", public_functions())
def test_every_function_is_documented_sourced_and_sampled(function):
    """Unit-bearing docstring with range, example and source; keyword-only; in SAMPLES."""
    text = inspect.getdoc(function)
    for part in ("Parameters", "Returns", "Valid:", ">>>", "References"):
        assert part in text
    assert re.search(r"\[[A-Za-z0-9-]+\]", text.split("References")[1])
    kinds = {p.kind for p in inspect.signature(function).parameters.values()}
    if function.__name__ == "series":
        return
    assert kinds == {inspect.Parameter.KEYWORD_ONLY}
    assert f"{function.__module__.rsplit('.', 1)[1]}.{function.__name__}" in SAMPLES


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    """Every docstring example prints what it says."""
    module = importlib.import_module(f"actuator_opt.models.{name}")
    assert doctest.testmod(module).failed == 0
