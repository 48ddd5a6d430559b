"""One regular point, or several, of every public model function: the registry of the law tests.

Numbers inside tuples, lists and dataclasses are arguments like any other; booleans, strings and
None stay as they are. A new model function needs an entry here, or the tests fail.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
from dataclasses import replace
from math import pi

import samples_contact
import samples_criteria
import samples_duty
import samples_dynamics
import samples_film
import samples_fluid
import samples_gland
import samples_joints
import samples_liner
import samples_lines
import samples_machines
import samples_motion
import samples_rods
import samples_servo
import samples_thermal
import samples_tube
import samples_valve

import actuator_opt.models
from actuator_opt.models import elastomer, end_bending, seals
from actuator_opt.models.burst_ladder import BurstLadder, WallLayer
from actuator_opt.models.strength_modes import PlyStrength

SCALAR_ONLY = {
    **dict.fromkeys(samples_lines.FREQUENCY_RESPONSES, "complex-valued, laws of their own"),
    **samples_dynamics.COMPLEX,
    **samples_duty.COUNTS,
    **samples_thermal.REPORTS,
}
"""Public functions outside the array laws, with the reason."""


def public_functions():
    """Every public function by its ``module.name``, in the module that defines it."""
    found = {}
    for info in pkgutil.iter_modules(actuator_opt.models.__path__):
        module = importlib.import_module(f"actuator_opt.models.{info.name}")
        for name, value in vars(module).items():
            own = inspect.isfunction(value) and value.__module__ == module.__name__
            if own and not name.startswith("_") and name in getattr(module, "__all__", [name]):
                found[f"{info.name}.{name}"] = value
    return found


def leaves(value):
    """Numbers of a sample, depth first."""
    if isinstance(value, bool | str) or value is None:
        return []
    if isinstance(value, dict):
        return [leaf for entry in value.values() for leaf in leaves(entry)]
    if isinstance(value, tuple | list):
        return [leaf for entry in value for leaf in leaves(entry)]
    if dataclasses.is_dataclass(value):
        return leaves([getattr(value, field.name) for field in dataclasses.fields(value)])
    return [value]


def rebuilt(value, numbers):
    """Return the sample with its numbers taken from an iterator, in the order of `leaves`."""
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, dict):
        return {key: rebuilt(entry, numbers) for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return type(value)(rebuilt(entry, numbers) for entry in value)
    if dataclasses.is_dataclass(value):
        fields = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
        return replace(value, **rebuilt(fields, numbers))
    return next(numbers)


RING = {"squeeze": 0.16, "section": 2e-3, "growth": 3e-5, "tolerance": 2e-5}
CHAMBERS = {"area_a": 8e-4, "area_b": 5.5e-4, "compliance_a": 5e-14, "compliance_b": 4e-14}
STRIBECK = {
    "speed": 0.015, "coulomb": 500.0, "static": 900.0, "stribeck_speed": 0.02, "exponent": 1.4,
}  # fmt: skip
TAIT = {"temperature": 320.0, "pressure": 9e6}
STATE = {
    "pressure_a": 9e6, "pressure_b": 4e5, "area_a": 8e-4, "area_b": 5e-4, "friction": 90.0,
}  # fmt: skip
PIPE = {
    "inner_diameter": 9.5e-3, "outer_diameter": 12e-3, "length": 0.6, "youngs_modulus": 17.8e9,
    "poissons_ratio": 0.3,
}  # fmt: skip
TUBE = {"inner_radius": 16e-3, "outer_radius": 20e-3}
METAL = {"youngs_modulus": 71.7e9, "poissons_ratio": 0.33}
ROD = {"outer_diameter": 12e-3, "inner_diameter": 6e-3}
SHELL_LAYER = end_bending.ShellLayer(2e-3, 8e10, 8e10, 2.6e10, 2.7e10)
SHELL = end_bending.Shell(55.0, 7e11, 4e7, 1e-3, 11e-3, 1.6e8, 5e7)
EYE = {"pin_diameter": 8e-3, "outer_diameter": 16e-3, "width": 8e-3}
GROOVE = {"bore_diameter": 21e-3, "groove_depth": 0.8e-3}
DISHED = {
    "force": 7e3,
    "lever_length": 0.6e-3,
    "inner_radius": 9e-3,
    "outer_radius": 11.3e-3,
    "ring_thickness": 1.5e-3,
}
THREAD = {"diameter": 10e-3, "pitch": 1.5e-3}
STOP = {"driving_force": 6000.0, "mass": 40.0, "velocity": 0.3}
FATIGUE = {"ultimate_strength": 700e6, "fatigue_limit": 300e6, "limit_cycles": 2e6}
COLUMN = {
    "bending_stiffness_1": 5000.0, "length_1": 0.2, "bending_stiffness_2": 1200.0,
    "length_2": 0.18,
}  # fmt: skip
TAPERED = {
    "line_force": 8e4, "strain_difference": -3e-4, "length": 16e-3, "tip": 0.2,
    "shear_modulus": 1.2e9, "bond_thickness": 0.15e-3, "skirt_stiffness": 1.4e8,
    "tube_stiffness": 1.2e8,
}  # fmt: skip
BOND = {"length": 20e-3, "shear_modulus": 1e9, "bond_thickness": 0.2e-3}
WALLS = {"membrane_stiffness_1": 100e6, "membrane_stiffness_2": 50e6}
LAMINA = {
    "youngs_modulus_1": 138e9, "youngs_modulus_2": 9e9, "poissons_ratio_12": 0.28,
    "shear_modulus_12": 5e9,
}  # fmt: skip
REDUCED = (139e9, 2.5e9, 9.1e9, 5e9)
SHEET = {"membrane": (1.1e8, 2e7, 1.5e8)}
STRENGTH = PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6)
PULLED = {"stress_1": 400e6, "stress_2": 30e6, "shear_12": 40e6, "strength": STRENGTH}
LINER = WallLayer(
    youngs_modulus_1=71.7e9, youngs_modulus_2=71.7e9, poissons_ratio_12=0.33,
    shear_modulus_12=71.7e9 / 2.66, thickness=0.6e-3, yield_strength=240e6,
)  # fmt: skip
HOOP = WallLayer(**LAMINA, strength=STRENGTH, thickness=1.2e-3, angle=pi / 2)
HELICAL = WallLayer(**LAMINA, strength=STRENGTH, thickness=0.8e-3, angle=pi / 6)

SAMPLES = {
    "damping.pipe_flow": {"dynamic_viscosity": 0.04, "length": 0.2},
    "damping.annular_couette": {
        "dynamic_viscosity": 0.04, "length": 0.2, "inner_radius": 9e-3, "outer_radius": 0.02,
    },
    "damping.flat_gap": {
        "dynamic_viscosity": 0.04, "diameter": 0.02, "length": 0.02, "gap": 3e-5,
    },
    "damping.secant": {"friction": 500.0, "speed": 0.05},
    "damping.power_law": {"speed": 0.01, "coefficient": 1e3, "exponent": -0.8},
    "damping.double_exponential": {
        "speed": 0.01, "coefficient_1": 2e5, "rate_1": -400.0, "coefficient_2": 5e4,
        "rate_2": -20.0,
    },
    "oil_laws.density_thermal": {
        "reference_density": 870.0, "volume_expansion": 7e-4, "temperature": 320.0,
    },
    "oil_laws.thermal_pressure_slope": {
        "volume_expansion": 7e-4, "wall_expansion_axial": 1e-5, "wall_expansion_hoop": 2e-5,
        "bulk_modulus": 1.4e9, "wall_compliance_per_volume": 1.3e-10,
    },
    "dynamics.natural_frequency": {"stiffness": 2e7, "mass": 30.0},
    "elements.resistance": {"inner_diameter": 8e-3, "length": 1.2, "dynamic_viscosity": 0.04},
    "elements.inertance": {"inner_diameter": 8e-3, "length": 1.2, "density": 865.0},
    "elements.capacitance": {"volume": 6e-5, "bulk_modulus": 1.4e9},
    "elements.sound_speed": {"bulk_modulus": 1.4e9, "density": 865.0},
    "elements.quarter_wave_frequency": {"length": 1.2, "sound_speed": 1272.0},
    "elements.resonance_frequency": {"inertance": 2e7, "capacitance": 4.3e-14},
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
    "fluid.effective_bulk_modulus": {
        "bulk_modulus": 1.6e9, "pressure": 3e6, "air_content": 0.01, "polytropic_index": 1.3,
    },
    "forces.piston_area": {"bore": 0.025},
    "forces.annulus_area": {"bore": 0.025, "rod_diameter": 0.012},
    "forces.push_force": STATE,
    "forces.pull_force": STATE,
    "forces.efficiency": {"force": 4e3, "pressure": 1e7, "area": 5e-4},
    "forces.pressure_loss": {"friction": 166.0, "area": 4.9e-4},
    "forces.chamber_flow": {"area": 5e-4, "speed": 0.1},
    "forces.power": {"force": 3e3, "speed": 0.1},
    "forces.joint_force": {"torque": 120.0, "lever_arm": 0.04},
    "forces.crank": {"base_radius": 0.3, "crank_radius": 0.04, "joint_angle": 1.1},
    "friction.seal_friction": {
        "line_load": 2e3, "diameter": 0.025, "friction_coefficient": 0.1, "count": 2.0,
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
    "gland.gland_fill": {"section": 2e-3, "groove_width": 2.4e-3, "gland_depth": 1.7e-3},
    "gland.extrusion_gap": {"clearance": 3e-5, "growth": 2e-5},
    "gland.limited_width": {"contact_width": 3e-3, "groove_width": 2.6e-3},
    "lines.line_compliance": PIPE,
    "lines.line_volume": {"inner_diameter": 8e-3, "length": 1.2},
    "lines.line_velocity": {"flow": 1e-4, "inner_diameter": 8e-3},
    "lines.port_velocity": {"flow": 1e-4, "port_diameter": 8e-3},
    "lines.reynolds": {"velocity": 4.0, "diameter": 8e-3, "kinematic_viscosity": 3.2e-5},
    "lines.line_pressure_drop": {
        "flow": 2.5e-4, "inner_diameter": 8e-3, "length": 1.2, "density": 865.0,
        "dynamic_viscosity": 0.011,
    },
    "lines.fitting_pressure_drop": {
        "flow": 2e-4, "inner_diameter": 8e-3, "loss_coefficient": 1.5, "density": 865.0,
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
    "mass.tapered_ring_volume": {
        "inner_radius": 10e-3, "tip_radius": 11e-3, "outer_radius": 13e-3, "length": 0.03,
        "taper_length": 8e-3,
    },
    "mass.disc_mass": {"density": 2700.0, "diameter": 0.03, "thickness": 8e-3},
    "mass.piston_groove_volume": {"diameter": 0.025, "depth": 1.7e-3, "width": 2.4e-3},
    "mass.rod_groove_volume": {"diameter": 0.012, "depth": 1.7e-3, "width": 2.4e-3},
    "mass.pitch_diameter": {"diameter": 0.01, "pitch": 1.5e-3},
    "mass.stud_mass": {"density": 7850.0, "diameter": 0.01, "pitch": 1.5e-3, "length": 0.02},
    "mass.tie_rod_mass": {"density": 7850.0, "diameter": 6e-3, "length": 0.2, "count": 4.0},
    "mass.eye_volume": {"pin_diameter": 8e-3},
    "mass.eye_length": {"pin_diameter": 8e-3},
    "wear.sliding_severity": {"line_load": 8e3, "contact_width": 1e-3, "distance": 0.22},
    "mass.ring_mass": {"density": 1300.0, "area": 3e-6, "centre_diameter": 0.023},
    "mass.oil_mass": {"density": 870.0, "volume": 6e-5},
    "gland.groove_width": {"section": 2e-3},
    "seals.width_as_published": {"section": 2e-3, "gland_height": 1.7e-3},
    "stiffness.chamber_compliance": {
        "volume": 7e-5, "bulk_modulus": 1.4e9, "wall_compliance": 2e-14,
    },
    "stiffness.chamber_stiffness": {
        "area": 5e-4, "volume": 7e-5, "bulk_modulus": 1.4e9, "wall_compliance": 2e-14,
    },
    "stiffness.hydraulic_stiffness": [CHAMBERS, {**CHAMBERS, "compliance_ab": -2e-15}],
    "stiffness.weakest_position": {
        "area_a": 8e-4, "area_b": 5e-4, "compliance_a0": 6e-15, "compliance_a_per_length": 6e-13,
        "compliance_b0": 6e-15, "compliance_b_per_length": 4e-13, "stroke": 0.16,
        "compliance_ab0": -1e-15, "compliance_ab_per_length": -2e-14,
    },
    "stiffness.series": {"*": (2e7, 9e7, 4e8)},
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
    "stiffness_published.line_stiffness_as_published": {"area": 1.2e-3, **PIPE},
    "stiffness_published.cylinder_expansion_as_published": {
        "pressure": 1e6, "area": 4.9e-4, "stroke": 0.11,
    },
    "oil_laws.density_tait": TAIT,
    "oil_laws.bulk_modulus_tait": TAIT,
    "barrel.bore_growth": {"pressure": 28e6, "axial_force": 9e3, **TUBE, **METAL},
    "barrel.bore_growth_as_published": {"pressure": 28e6, **TUBE, **METAL},
    "barrel.bore_stresses": {"pressure": 28e6, "axial_force": 9e3, **TUBE},
    "barrel.von_mises": {"hoop": 128e6, "radial": -28e6, "axial": 50e6},
    "barrel.burst_pressure_thick": {
        "yield_strength": 355e6, "ultimate_strength": 490e6, "axial_force_ratio": 0.7, **TUBE,
    },
    "barrel.chamber_compliance": {
        "inner_radius": 16e-3, "growth_per_pressure": 1e-12, "length": 0.18,
    },
    "barrel.barrel_stiffness": {"area": 8e-4, "compliance": 2e-14},
    "barrel.wall_ratio_for_strain": [
        {"strain": 1.5e-3, "pressure": 25e6, "closed": closed, **METAL} for closed in (False, True)
    ],
    "barrel_ends.pressure_shortening": {"pressure": 28e6, "length": 0.18, **TUBE, **METAL},
    "barrel_ends.shell_decay_length": {
        "radius": 16.75e-3, "hoop_stiffness": 1.1e8, "bending_stiffness": 22.0,
    },
    "barrel_ends.pressure_step_factor": [
        {"distance": 3e-3, "decay_length": 4e-3}, {"distance": -3e-3, "decay_length": 4e-3},
    ],
    "barrel_ends.axial_force_cap_mounted": {
        "rod_side_pressure": 1e7, "rod_side_area": 3e-4, "stop_force": 100.0,
    },
    "barrel_ends.axial_force_head_mounted": {"cap_side_pressure": 1e7, "cap_side_area": 5e-4},
    "barrel_ends.tie_rod_forces": {
        "axial_force": 12e3, "preload": 9e3, "barrel_stiffness": 3e8, "tie_rod_stiffness": 9e7,
        "free_shortening": 3e-6,
    },
    "ply.ply_stiffness": LAMINA,
    "ply.rotated": {"stiffness": REDUCED, "angle": 0.6},
    "ply.ply_stresses": {
        "stiffness": REDUCED, "angle": 0.6, "axial_strain": 1e-3, "hoop_strain": 3e-3,
        "free_strain_1": -1e-4, "free_strain_2": -2e-3,
    },
    "ply.thermal_ply_load": {
        "stiffness": REDUCED, "angle": 0.6, "expansion_1": 1e-6, "expansion_2": 28e-6,
    },
    "laminate.membrane": {
        "plies": [(1e11, 3e10, 9e10), (2e10, 5e9, 1.3e11)], "thicknesses": [1e-3, 2e-3],
    },
    "laminate.strains": {**SHEET, "axial_line_force": 2e5, "hoop_line_force": 5e5},
    "laminate.thermal_line_forces": {
        "loads": [(2e6, 1e6), (1e6, 3e6)], "thicknesses": [1e-3, 2e-3],
        "temperature_change": -80.0,
    },
    "laminate.bore_growth_thin": {
        **SHEET, "pressure": 25e6, "inner_radius": 16e-3, "axial_force": 9e3,
    },
    "laminate.effective_moduli": {**SHEET, "thickness": 2e-3},
    "laminate.bending_stiffness": {"plies": [(1e11,), (2e10,)], "thicknesses": [1e-3, 2e-3]},
    "burst_ladder.burst_by_ply_discount": [
        {"layers": [HOOP, HELICAL], "radius": 17e-3, "axial_force_per_pressure": 9e-4},
        {"layers": [LINER, HOOP, HELICAL], "radius": 17e-3, "axial_force_per_pressure": 9e-4},
    ],
    "strength_modes.load_multiplier": {"inverse": 0.4},
    "rod.section_area": ROD,
    "rod.second_moment": ROD,
    "rod.axial_stiffness": {"youngs_modulus": 2e11, "length": 0.2, **ROD},
    "rod.axial_stiffness_as_published": {
        "youngs_modulus": 1.3e10, "outer_diameter": 12e-3, "length": 0.11,
    },
    "rod.rod_stress": {"force": 1e4, **ROD},
    "rod.bending_stress": {"bending_moment": 20.0, **ROD},
    "rod.thread_stress_area": THREAD,
    "rod.thread_stress": {"force": 1e4, **THREAD},
    "thread.minor_diameter": THREAD,
    "thread.root_diameter": THREAD,
    "thread.engaged_length": {"length": 8e-3, "pitch": 1.5e-3},
    "thread.male_strip_area": {"engagement": 8e-3, **THREAD},
    "thread.female_strip_area": {"engagement": 8e-3, "crest_diameter": 10e-3, **THREAD},
    "thread.crest_overlap": {"crest_diameter": 9.9e-3, **THREAD},
    "thread.flank_area": {"engagement": 8e-3, "crest_diameter": 10e-3, **THREAD},
    "thread.stripping_reductions": [{"strength_ratio": ratio} for ratio in (0.7, 1.3)],
    "thread.internal_wall_stresses": {
        "force": 7e3, "diameter": 22e-3, "pitch": 1e-3, "engagement": 6e-3, "bore_diameter": 21e-3,
        "outer_diameter": 25e-3, "poissons_ratio": 0.33,
    },
    "thread.spread_stress": {"force": 1e4, "thickness": 2e-3, "engagement": 8e-3},
    "piston_nut.stud_share": {
        "diameter": 8e-3, "shoulder_diameter": 11.5e-3, "stud_modulus": 206e9,
        "piston_modulus": 71.7e9,
    },
    "barrel_ends.preload_change": {
        "temperature_change": 40.0,
        "barrel_expansion": 20e-6,
        "barrel_length": 126e-3,
        "plate_expansion": 23.6e-6,
        "plate_thickness": 7e-3,
        "tie_rod_expansion": 11.5e-6,
        "tie_rod_length": 140e-3,
        "barrel_stiffness": 39.6825e6,
        "tie_rod_stiffness": 115.566e6,
    },
    "retaining_ring.springing": {
        "groove_depth": 0.4e-3,
        "inner_radius": 8.7e-3,
        "outer_radius": 11.1e-3,
        "youngs_modulus": 206e9,
    },
    "piston_nut.least_stud_share": {
        "diameter": 8e-3,
        "piston_diameter": 21e-3,
        "length": 6e-3,
        "stud_modulus": 206e9,
        "piston_modulus": 71.7e9,
    },
    "end_bending.thickened_end_peak": {"length": 9e-3, "radius": 11e-3, "thickness": 6e-3},
    "thread.skirt_stresses": {
        "force": 7982.0, "root_diameter": 22e-3, "thickness": 1.1e-3, "engagement": 6.4e-3,
        "poissons_ratio": 0.33,
    },
    "piston_nut.clamp_compliance": {
        "diameter": 8e-3,
        "shoulder_diameter": 11.5e-3,
        "length": 6e-3,
        "stud_modulus": 206e9,
        "piston_modulus": 71.7e9,
    },
    "piston_nut.preload_range": {"preload": 13e3, "tightening_factor": 1.6},
    "piston_nut.settling_loss": {"threads": 1, "seats": 2, "joints": 0, "compliance": 2e-9},
    "piston_nut.torsion_factor": {"diameter": 8e-3, "pitch": 1e-3, "share": 0.5},
    "piston_nut.preload_change": {
        "diameter": 8e-3,
        "piston_diameter": 21e-3,
        "length": 6e-3,
        "stud_modulus": 206e9,
        "piston_modulus": 71.7e9,
        "strain_difference": 6e-4,
    },
    "piston_nut.shoulder_area": {"diameter": 8e-3, "shoulder_diameter": 12e-3},
    "piston_nut.nut_volume": {"diameter": 8e-3},
    "piston_nut.web_stress": {
        "force": 5e3, "radius": 5.5e-3, "reach_length": 1.4e-3, "thickness": 2e-3,
    },
    "piston_nut.corner_radius": {"diameter": 8e-3},
    "port.saddle_depth": {"boss_diameter": 14e-3, "tube_radius": 15e-3},
    "port.boss_volume": {"boss_diameter": 14e-3, "height": 11.5e-3, "tube_radius": 15e-3},
    "spherical_bearing.lug_radius": EYE,
    "spherical_bearing.bearing_eye_volume": EYE,
    "retaining_ring.groove_area": GROOVE,
    "retaining_ring.lip_shear": {"force": 7e3, "lip_length": 3e-3, **GROOVE},
    "retaining_ring.lip_bending": {"force": 7e3, "lip_length": 3e-3, **GROOVE},
    "retaining_ring.ring_shear": {"force": 7e3, "bore_diameter": 21e-3, "ring_thickness": 1.5e-3},
    "retaining_ring.ring_dishing": DISHED,
    "retaining_ring.plastic_dishing": DISHED,
    "retaining_ring.wall_stresses": {
        "force": 7e3, "lip_length": 3e-3, "thickness": 2e-3, "poissons_ratio": 0.33, **GROOVE,
    },
    "retaining_ring.collapse_factor": {"axial": 50e6, "bending": 90e6, "strength": 500e6},
    "liner_transfer.interface_stiffness": {
        "liner_thickness": 1.5e-3, "liner_shear_modulus": 27e9,
        "winding_thickness": 2.5e-3, "winding_shear_modulus": 4.3e9,
    },
    "liner_transfer.edge_shear": {
        "line_force": 1e5, "strain_difference": 2e-4, "interface_stiffness": 4e12,
        "liner_stiffness": 1.1e8, "winding_stiffness": 2.2e7,
    },
    "liner_transfer.fading_length": {
        "interface_stiffness": 4e12, "liner_stiffness": 1.1e8, "winding_stiffness": 2.2e7,
    },
    "end_bending.shell": {"layers": [SHELL_LAYER], "inner_radius": 10e-3},
    "end_bending.free_growth": {
        "wall": SHELL, "pressure": 2e7, "bore_radius": 1e-2, "line_force": 1e5,
    },
    "end_bending.clamped": {"wall": SHELL, "growth": 8e-6},
    "end_bending.stepped": {
        "left": SHELL, "right": replace(SHELL, bending=30.0), "left_growth": 4e-6,
        "right_growth": 9e-6, "offset_moment": 60.0,
    },
    "end_bending.edge_stresses": {
        "layer": SHELL_LAYER, "start": 0.0, "wall": SHELL, "line_force": 1e5,
        "edge": end_bending.Edge(5e-6, 80.0, 4e4),
    },
    "end_bending.groove_shear": {"wall": SHELL, "growth": 5e-6, "groove_moment": 60.0},
    "end_bending.strain_changes": {
        "place": 2e-4, "wall": SHELL, "edge": end_bending.Edge(5e-6, 80.0, 4e4), "growth": 9e-6,
    },
    "end_bending.interlaminar_shear": {"layers": [SHELL_LAYER], "wall": SHELL, "force": 4e4},
    "winding_path.turn_length": {"radius": 14e-3, "angle": 0.4},
    "tube_burst.axial_rupture_pressure": {
        "areas": [1e-4, 2e-4], "strengths": [5e8, 2e9], "angles": [0.0, 1.2],
        "axial_force_per_pressure": 4e-4,
    },
    "column.euler_load": {"bending_stiffness": 680.0, "effective_length": 0.6},
    "column.cowper_tube": {"poissons_ratio": 0.28, "radius_ratio": 0.75},
    "column.engesser_load": {"critical_load": 1e5, "shear_stiffness": 9e5},
    "column.local_shell_knockdown": {"radius": 15e-3, "thickness": 1.2e-3},
    "column.local_shell_stress": [
        {**METAL, "thickness": 1.2e-3, "radius": 15e-3},
        {**METAL, "thickness": 1.2e-3, "radius": 15e-3, "knockdown": 0.8},
    ],
    "stepped.stepped_column_load": [
        {**COLUMN, "ends": ends}
        for ends in (
            ("pinned", "pinned"), ("fixed", "pinned"), ("pinned", "fixed"), ("fixed", "fixed"),
            ("fixed", "free"), ("guided", "fixed"), ("pinned", "guided"),
        )
    ],
    "lap_joint.least_bond_peak_ratio": {**BOND, "membrane_stiffness": 50e6},
    "lap_joint.ultimate_line_force": {
        "strain_difference": 6e-4, "length": 16e-3, "strength": 28e6, "shear_modulus": 1.2e9,
        "plastic_shear_strain": 0.1, "bond_thickness": 0.15e-3,
        "membrane_stiffness_loaded": 120e6, "membrane_stiffness_free": 140e6,
    },
    "lap_joint.edge_peel": {
        "shear": 28e6, "adhesive_modulus": 3e9, "bond_thickness": 0.15e-3, "skirt_modulus": 71.7e9,
        "skirt_poissons_ratio": 0.33, "skirt_thickness": 2e-3,
    },
    "lap_joint.double_lap": {
        "force": 7e3, "strain_difference": 3e-4, "length": 12e-3, "outer_bond_diameter": 28e-3,
        "inner_bond_diameter": 21e-3, "shear_modulus": 1.2e9, "bond_thickness": 0.15e-3,
        "tube_stiffness": 1e7, "outer_stiffness": 8e6, "inner_stiffness": 5e6,
    },
    "lap_joint.tapered_lap": [
        {**TAPERED, "taper_length": length} for length in (8e-3, 16e-3)
    ],
    "lap_joint.bond_edge_shear": {
        "force": 1e4, "diameter": 30e-3, **BOND, "membrane_stiffness_loaded": 100e6,
        "membrane_stiffness_free": 50e6,
    },
    "retention.tie_rod_stress": {"force": 2e4, "count": 4.0, "diameter": 6e-3, "pitch": 1e-3},
    "endurance.bolt_endurance_amplitude": {"diameter": 8e-3},
    "endurance.bolt_cycles": {"amplitude": 9e7, "diameter": 8e-3},
    "retention.pin_shear_stress": {"force": 1e4, "diameter": 1e-2},
    "retention.guide_friction": {"force": -2e3, "friction_coefficient": 0.1},
    "retention.guide_forces": {"side_force": 100.0, "overhang": 0.2, "span": 0.1},
    "retention.through_rod_guide_forces": {
        "side_force": 100.0, "overhang": 0.2, "span": 0.1, "second_span": 0.15,
        "bending_stiffness": 1600.0, "second_bending_stiffness": 900.0, "clearance": 3e-6,
        "piston_clearance": 5e-6, "second_clearance": 2e-5,
    },
    "retention.bearing_pressure": {"force": 300.0, "diameter": 12e-3, "length": 1e-2},
    "end_plate.end_plate_stress": {
        "pressure": 1e7, "radius": 12e-3, "thickness": 5e-3, "poissons_ratio": 0.3,
    },
    "end_plate.hung_plate_stress": {
        "pressure": 1e7, "loaded_radius": 12e-3, "support_radius": 14e-3, "thickness": 5e-3,
        "poissons_ratio": 0.3,
    },
    "end_plate.rim_tear_factor": {
        "force": 7824.0, "groove_radius": 9.476e-3, "skirt_radius": 10.1e-3,
        "lip_thickness": 1.135e-3,
        "strength": 572e6,
    },
    "end_plate.hub_plate_stress": {
        "pressure": 1e7, "edge_force": 5e3, "hub_radius": 6e-3, "edge_radius": 15e-3,
        "thickness": 5e-3, "poissons_ratio": 0.3,
    },
    "endurance.cycles_to_failure": {"peak_stress": 420e6, "stress_ratio": 0.1, **FATIGUE},
    "endurance.fatigue_factor": {
        "peak_stress": 4e8, "ultimate_strength": 7e8, "amplitude_strength": 3e8,
        "stress_ratio": 0.1,
    },
    "endurance.end_stop_compression": {**STOP, "stiffness": 3e7},
    "endurance.end_stop_energy": {**STOP, "compression": 6e-4},
    "endurance.end_stop_peak_force": {"stiffness": 3e7, "compression": 6e-4},
    "endurance.end_stop_peak_pressure": {"pressure": 1e6, "peak_force": 18e3, "area": 9e-4},
}  # fmt: skip
for _group in (
    samples_contact,
    samples_criteria,
    samples_duty,
    samples_dynamics,
    samples_film,
    samples_fluid,
    samples_gland,
    samples_joints,
    samples_liner,
    samples_lines,
    samples_machines,
    samples_motion,
    samples_rods,
    samples_servo,
    samples_valve,
    samples_thermal,
    samples_tube,
):
    SAMPLES |= _group.SAMPLES
"""Arguments by ``module.function``, ``*`` for positional ones: one sample, or a list of them."""


def cases():
    """Label, function and sample of every array model; the seal laws come from their registry."""
    functions = public_functions()
    for name, samples in SAMPLES.items():
        several = samples if isinstance(samples, list) else [samples]
        for i, sample in enumerate(several):
            function = functions.get(name)  # a stale name fails in its own test
            if isinstance(sample, tuple):  # a function of what another one prepares
                function, sample = sample
            yield f"{name}-{i}" if len(several) > 1 else name, function, sample
    ring = {"squeeze": 0.17, "section": 2e-3, "youngs_modulus": 6e6, "pressure": 3e6}
    for law in seals.LAWS.values():
        for quantity in ("line_load", "contact_width", "peak_pressure"):
            yield f"seals.LAWS.{law.name}.{quantity}", getattr(law, quantity), ring
    for law in elastomer.MODULUS_LAWS.values():
        yield f"elastomer.MODULUS_LAWS.{law.name}", law.modulus, {"hardness": 72.0}


def outputs(result, dims):
    """List the numbers of a result of `dims` batch axes: its parts, leading axes taken apart."""
    if result is None or isinstance(result, bool | str):
        return []
    if isinstance(result, BurstLadder):
        pressures = [result.first_ply_pressure, result.burst_pressure]
        return [*pressures, result.liner_yield_pressure]
    if dataclasses.is_dataclass(result):
        result = [getattr(result, field.name) for field in dataclasses.fields(result)]
    if isinstance(result, dict):
        result = list(result.values())
    if isinstance(result, tuple | list):
        return [number for part in result for number in outputs(part, dims)]
    if getattr(result, "ndim", 0) <= dims:
        return [result]
    return [number for i in range(result.shape[0]) for number in outputs(result[i, ...], dims)]


def called(function, sample, numbers, dims):
    """Outputs of a model at a sample with its numbers replaced."""
    arguments = rebuilt(sample, iter(numbers))
    return outputs(function(*arguments.pop("*", ()), **arguments), dims)
