"""Samples of the law tests for the rods models; merged into `model_samples`."""

from __future__ import annotations

from actuator_opt.models.trial_motion import TrialMode, TrialMotion

COLUMN = {
    "critical_load": 1.3e5, "bending_stiffness_1": 5000.0, "length_1": 0.2,
    "shear_stiffness_1": 4e6, "bending_stiffness_2": 1200.0, "length_2": 0.18,
    "shear_stiffness_2": 1e6,
}  # fmt: skip
SHELL = {"youngs_modulus": 7e10, "thickness": 1.2e-3, "radius": 15e-3, "poissons_ratio": 0.3}
THIN = {**SHELL, "radius": 0.6}
PLY = (140e9, 4e9, 4.2e9, 11e9, 5e9, 11e9, 1e9, 2e9, 3e9, 5e9)
WEIGHTS = {"weight_1": 40.0, "length_1": 0.8, "weight_2": 25.0, "length_2": 0.6}
FLEXURE = {
    "span": 0.3, "second_moment": 7e-9, "shear_compliance": 5e-6, "local_compliance": 4e-7,
}  # fmt: skip

BENT = {
    "bending_stiffness_1": 5000.0, "length_1": 0.2, "bending_stiffness_2": 1200.0,
    "length_2": 0.18,
}  # fmt: skip
CHAMBERS = {
    "area_a": 4e-4, "area_b": 3e-4, "oil_a": 2e-14, "oil_b": 1.5e-14, "wall_a": 2e-15,
    "wall_b": 1.5e-15, "stretch": 5e-16,
}  # fmt: skip

FLANK = {"crest_radius": 16.5e-3, "valley_radius": 14e-3, "angle": 0.6}
HOOPS = {"radius": 18e-3, "modulus": 135e9, "section": 20e-6}
GEODESIC = {"angle": 0.4, "start_radius": 16e-3, "radius": 14e-3}

SAMPLES: dict = {
    "fibre_trap.flank_pressure": {"force": 7e3, **FLANK, "friction_coefficient": 0.1},
    "fibre_trap.hoop_force": {"force": 7e3, "angle": 0.6, "friction_coefficient": 0.1},
    "fibre_trap.radial_give": {"hoop_force": 1600.0, **HOOPS},
    "fibre_trap.compliance": {**HOOPS, "angle": 0.6, "friction_coefficient": 0.1},
    "fibre_trap.flank_shear": {"pressure": 3e7, "angle": 0.6},
    "fibre_trap.hoop_section": [
        {"thickness": t, "width": 4e-3, "flank_height": 2e-3, "flank_length": 2.5e-3}
        for t in (1e-3, 3e-3)
    ],
    "fibre_trap.hoop_reach": {
        "radius": 15e-3, "thickness": 2e-3, "modulus": 135e9, "axial_modulus": 8.5e9,
    },
    "fibre_trap.band_stress": {"line_force": 1e5, "thickness": 8e-4, "angle": 0.4},
    "fibre_trap.crest_factor": {"thickness": 8e-4, "crest_radius": 3e-3},
    "fibre_trap.crest_pressure": {"line_force": 1e5, "crest_radius": 3e-3, "angle": 0.6},
    "fibre_trap.crest_shear": {"force": 7e3, "valley_radius": 14e-3, "length": 4e-3},
    "fibre_trap.neck_stresses": {
        "force": 7e3, **FLANK, "outer_radius": 11e-3, "wall_thickness": 2e-3,
        "flank_distance": 3e-3,
    },
    "fibre_trap.cooling_play": {
        "expansion_difference": 24e-6, "cooling": 120.0, "radius": 16e-3, "angle": 0.6,
    },
    "winding_path.geodesic_angle": GEODESIC,
    "winding_path.geodesic_thickness_ratio": GEODESIC,
    "mass.turned_volume": [{"profile": [(0.0, 8e-3), (5e-3, 8e-3), (4e-3, 12e-3), (0.0, 12e-3)]}],
    "rod.free_modulus": {"wall": PLY},
    "trial_motion.buckled_mode": {"critical_load": 1.3e5, **BENT},
    "trial_motion.trial_mode_load": {"mode": TrialMode(0.5, 0.6, 1.2, 1.1), **BENT},
    "tube_bounds.least_growth": {
        "hoop": [9e10, 2e11], "cross": [4e10, 5e9], "radial": [9e10, 1.2e10],
        "decays": [[0.4], [0.9, -0.7]], "thicknesses": [1e-3, 2e-3], "inner_radius": 16e-3,
    },
    "tube_bounds.ply_hoop_strength": {
        "tension_1": 1.9e9, "tension_2": 5.5e7, "shear_12": 8.5e7, "angle": 0.9,
    },
    "tube_bounds.greatest_pressure": {
        "yields": [2.4e8, None], "hoops": [None, 1.9e9], "thicknesses": [6e-4, 1.2e-3],
        "inner_radius": 16e-3,
    },
    "tube_bounds.axial_stiffness": {
        "moduli": [7e10, 1e10], "thicknesses": [1e-3, 2e-3], "inner_radius": 16e-3,
    },
    "trial_motion.least_energy_motion": [
        {**CHAMBERS, "pulling": chamber} for chamber in ("a", "b")
    ],
    "trial_motion.trial_motion_stiffness": [
        {"motion": TrialMotion(0.1, 0.03), **CHAMBERS, "pulling": chamber} for chamber in ("a", "b")
    ],
    "mass.layer_area": {"inner_radius": 16e-3, "thickness": 2e-3},
    "stepped.mode_shear_stiffness": [
        {**COLUMN, "ends": ends}
        for ends in (
            ("pinned", "pinned"), ("fixed", "pinned"), ("pinned", "fixed"), ("fixed", "fixed"),
            ("fixed", "free"), ("guided", "fixed"), ("pinned", "guided"),
        )
    ],
    "shell_buckling.shell_modulus": [
        {"axial_modulus": 9e10, "hoop_modulus": 2e10, "shear_modulus": g, "poissons_ratio": 0.2}
        for g in (5e9, 3e10)
    ],
    "shell_buckling.local_shell_force": [SHELL, {**SHELL, "knockdown": 0.8}],
    "shell_buckling.bending_shell_knockdown": {"radius": 15e-3, "thickness": 1.2e-3},
    "shell_buckling.local_shell_moment": [SHELL, THIN, {**THIN, "knockdown": 0.5}],
    "rod.layered_section": {
        "walls": [PLY, (2e10, *PLY[1:])], "thicknesses": [1.5e-3, 0.5e-3], "inner_diameter": 12e-3,
    },
    "column.self_weight_moments": [
        WEIGHTS, {**WEIGHTS, "length_2": 0.9, "weight_2": 60.0}, {**WEIGHTS, "weight_2": 0.0},
    ],
    "column.amplified_moment": {
        "bending_moment": 10.0, "axial_force": 9e3, "critical_load": 3e4, "shape": 0.27,
    },
    "column.bending_axial_force": {
        "bending_moment": 20.0, "radius": 8e-3, "axial_stiffness": 9.3e6,
        "bending_stiffness": 215.0,
    },
    "lap_joint.bond_thermal_shear": {
        "strain_difference": -2e-3, "length": 20e-3, "shear_modulus": 1e9,
        "bond_thickness": 0.2e-3, "membrane_stiffness_1": 1e8, "membrane_stiffness_2": 5e7,
    },
    "bending_test.bending_modulus": {"slope": 1.5e5, **FLEXURE},
    "bending_test.bending_slope": {"youngs_modulus": 6e10, **FLEXURE},
    "bending_test.equivalent_second_moment": {
        "second_moments": [3e-8, 7e-9, 1.2e-8], "steps": [0.03, 0.08], "span": 0.3,
    },
    "bending_test.indentation_compliance": {
        "force": 500.0, "roller_radius": 5e-3, "specimen_radius": 6e-3, "contact_modulus": 9e9,
    },
    "stiffness_published.equivalent_stiffness_as_published": {
        "pressure": 5e6, "bore": 0.025, "outer_diameter": 0.03, "youngs_modulus": 3.48e9,
        "poissons_ratio": 0.3, "stroke": 0.11, "oil": 2.48e6, "rod": 1.343e7,
    },
}  # fmt: skip
