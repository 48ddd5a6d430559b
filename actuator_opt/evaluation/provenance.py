"""Which model stands behind a metric, read from the model's own docstring."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import cast

from ..joints.kinds import JOINTS
from ..models import (
    autofrettage,
    barrel,
    barrel_ends,
    beam_column,
    damping,
    dynamics,
    elastomer,
    elements,
    end_plate,
    endurance,
    extrusion,
    flow_factors,
    fluid,
    forces,
    friction,
    gland,
    gland_range,
    laminate,
    lap_joint,
    layered_tube,
    linear,
    liner,
    lines,
    linkage,
    loop,
    lugre,
    mass,
    ply_discount,
    retention,
    rod,
    shell_buckling,
    stepped,
    stiffness,
    strength_modes,
    tube_burst,
    water_hammer,
    wear,
    yielding,
)
from ..models import density as oil_density
from ..models.criteria import CRITERIA


@dataclass(frozen=True, slots=True)
class Model:
    """A model function as its docstring describes it."""

    name: str
    summary: str
    reference: str
    valid: str


_VALID = re.compile(r"^\s*Valid: (.*?)(?:\n\s*\n|\Z)", re.DOTALL | re.MULTILINE)
_REFERENCES = re.compile(r"References\n\s*-+\n(.*?)(?:\n\s*\n|\Z)", re.DOTALL)


@cache
def describe(function: Callable[..., object]) -> Model:
    """Name, first sentence, source and valid range of a model function."""
    doc = function.__doc__ or ""
    valid = _VALID.search(doc)
    reference = _REFERENCES.search(doc)

    def flat(match: re.Match[str] | None) -> str:
        return " ".join(match[1].split()) if match else ""

    module = function.__module__.rpartition(".")[2]
    return Model(
        name=f"{module}.{function.__name__}",
        summary=doc.strip().partition("\n")[0].rstrip("."),
        reference=flat(reference),
        valid=flat(valid),
    )


METRIC_MODELS: MappingProxyType[str, Callable[..., object]] = MappingProxyType(
    {
        "mass": mass.tube_mass,
        "mass_oil": mass.oil_mass,
        "push_force": forces.push_force,
        "pull_force": forces.pull_force,
        "efficiency": forces.efficiency,
        "power": forces.power,
        "stiffness_min": stiffness.hydraulic_stiffness,
        "stiffness_oil": stiffness.chamber_stiffness,
        "stiffness_barrel": barrel.chamber_compliance,
        "stiffness_rod": rod.axial_stiffness,
        "natural_frequency": dynamics.natural_frequency,
        "damping_ratio": loop.load_mode,
        "dynamic_stiffness": linear.dynamic_stiffness,
        "dynamic_phase": linear.dynamic_stiffness,
        "ultimate_gain": loop.ultimate_gain,
        "gain_margin": loop.ultimate_gain,
        "position_gain": loop.ultimate_gain,
        "phase_margin": loop.margins,
        "bandwidth": loop.margins,
        "leakage": damping.gap_conductance,
        "stiffness_seals": lugre.lugre_bristle_stiffness,
        "bore_growth": barrel.bore_growth,
        "growth_at_seal": barrel_ends.pressure_step_factor,
        "seal_gap": gland.extrusion_gap,
        "extrusion_factor": extrusion.extrusion_gap_limit,
        "seal_squeeze": gland_range.squeeze_extremes,
        "seal_squeeze_max": gland_range.squeeze_extremes,
        "seal_fill": gland.gland_fill,
        "seal_stretch": gland.stretched_section,
        "contact_width": gland.limited_width,
        "contact_pressure": elastomer.modulus_gent,
        "seal_wear": wear.sliding_severity,
        "film_thickness": flow_factors.pressure_flow_factor,
        "rod_leakage": flow_factors.pressure_flow_factor,
        "inter_seal_pressure": flow_factors.pressure_flow_factor,
        "friction_running": friction.stribeck_level,
        "friction_breakaway": friction.breakaway,
        "damping_seal": damping.secant,
        "damping_pipe": damping.pipe_flow,
        "damping_annular": damping.annular_couette,
        "proof_factor": barrel.von_mises,
        "yield_factor": barrel.von_mises,
        "liner_yield_factor": barrel.von_mises,
        "burst_factor": barrel.burst_pressure_thick,
        "first_ply_factor": strength_modes.max_stress_modes,
        "buckling_factor": stepped.stepped_column_load,
        "local_buckling_factor": shell_buckling.local_shell_force,
        "thread_factor": rod.thread_stress_area,
        "fitting_factor": lap_joint.bond_edge_shear,
        "bond_thermal_factor": lap_joint.bond_thermal_shear,
        "cap_factor": end_plate.hub_plate_stress,
        "pin_factor": retention.pin_shear_stress,
        "bearing_overlap": retention.guide_forces,
        "bearing_pressure": retention.guide_forces,
        "bearing_factor": retention.guide_forces,
        "fatigue_factor": endurance.fatigue_factor,
        "cycle_life": endurance.cycles_to_failure,
        "ply_fatigue_factor": layered_tube.ply_stresses_at_faces,
        "end_stop_energy": endurance.end_stop_energy,
        "end_stop_pressure": endurance.end_stop_peak_pressure,
        "end_stop_factor": endurance.end_stop_peak_pressure,
        "trapped_pressure": oil_density.thermal_pressure_slope,
        "trapped_factor": oil_density.thermal_pressure_slope,
        "liner_mismatch_factor": laminate.thermal_line_forces,
        "reverse_yield_factor": autofrettage.autofrettage,
        "flow": forces.chamber_flow,
        "port_velocity": lines.port_velocity,
        "line_velocity": lines.line_velocity,
        "line_pressure_drop": lines.line_pressure_drop,
        "line_drop_ratio": lines.line_pressure_drop,
        "line_hammer": water_hammer.joukowsky_pressure,
        "line_resonance": elements.quarter_wave_frequency,
        "oil_viscosity": fluid.viscosity_astm_d341,
        "cavitation_margin": fluid.vapour_pressure,
        "joint_torque_min": linkage.joint_torque,
        "joint_range": linkage.linkage_angle,
    }
)
"""The leading model of every metric that has one; the rest is plain geometry."""

WALL_MODELS: MappingProxyType[str, MappingProxyType[str, Callable[..., object]]] = MappingProxyType(
    {
        "layered": MappingProxyType(
            {
                "bore_growth": layered_tube.tube_state,
                "growth_at_seal": barrel_ends.pressure_step_factor,
                "yield_factor": yielding.yield_utilisation,
                "liner_yield_factor": yielding.yield_utilisation,
                "liner_range_factor": liner.liner_cycle,
                "liner_strain_range": liner.liner_cycle,
                "liner_mismatch_factor": layered_tube.tube_state,
                "liner_bond_factor": layered_tube.tube_state,
                "burst_factor": tube_burst.burst_of_tube,
            }
        ),
        "thin_laminate": MappingProxyType(
            {
                "bore_growth": laminate.bore_growth_thin,
                "yield_factor": yielding.yield_utilisation,
                "liner_yield_factor": yielding.yield_utilisation,
                "liner_range_factor": liner.liner_cycle,
                "liner_strain_range": liner.liner_cycle,
                "burst_factor": ply_discount.burst_by_ply_discount,
            }
        ),
    }
)
"""What replaces it where the barrel is a laminate, by wall model."""

_OF_JOINTS: dict[tuple[str, str], Callable[..., object]] = {
    place: model for joint in JOINTS.values() for place, model in joint.models.items()
}

AT_PLACE: MappingProxyType[tuple[str, str], Callable[..., object]] = MappingProxyType(
    {
        **_OF_JOINTS,
        ("cap_factor", "cap, hung on its skirt"): end_plate.hung_plate_stress,
        ("cap_factor", "head"): end_plate.end_plate_stress,
        ("yield_factor", "rod"): beam_column.amplified_moment,
        ("stiffness_rod", "layered tube"): layered_tube.tube_state,
    }
)
"""What replaces both where another part of the actuator governs, and what is of a joint alone."""


def model_of(
    metric: str, *, wall: str, criterion: str = "max_stress", place: str | None = None
) -> Model | None:
    """The model behind a metric at its governing place; None for plain geometry and inputs.

    `wall` is the barrel's model, `criterion` that of its plies.
    """
    if metric == "rod_factor" and " yield, " in (place or ""):
        return describe(yielding.yield_utilisation)
    laminated = metric in ("first_ply_factor", "proof_factor") and wall in WALL_MODELS
    if laminated or metric == "rod_factor":
        return describe(cast(Callable[..., object], CRITERIA[criterion]))
    own = WALL_MODELS[wall].get(metric) if wall in WALL_MODELS else None
    function = AT_PLACE.get((metric, place or "")) or own or METRIC_MODELS.get(metric)
    return None if function is None else describe(function)
