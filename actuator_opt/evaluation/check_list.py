"""The check list: what a professional checks on every actuator, each line with its source.

A line's limit stands unless the design requires or waives the metric; `advice` lines are shown and
warned about, but bind no optimiser.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..joints.joint import judged_on
from ..joints.kinds import JOINTS
from ..quantities import Sense


@dataclass(frozen=True, slots=True)
class CheckLine:
    """A line of the check list; `limit` None means only the design's author can set one."""

    name: str
    metric: str | None
    sense: Sense = "min"
    limit: float | None = None
    source: str = ""
    why_not: str = ""
    advice: bool = False
    """Shown and warned about, but no constraint of the optimiser."""


CHECK_LIST: tuple[CheckLine, ...] = (
    CheckLine("push force net of friction and back-pressure", "push_force"),
    CheckLine("pull force net of friction and back-pressure", "pull_force"),
    CheckLine(
        "wall stress at working pressure",
        "yield_factor",
        "min",
        1.5,
        "choice: 1.5 on yield of every metal part",
    ),
    CheckLine(
        "proof pressure (yield or first ply)",
        "proof_factor",
        "min",
        1.0,
        "ISO 10100 practice: proof 1.5 x working pressure",
    ),
    CheckLine(
        "barrel burst pressure",
        "burst_factor",
        "min",
        4.0,
        "4:1 industrial practice (2.5:1 aerospace option)",
    ),
    CheckLine(
        "first-ply (leak) pressure",
        "first_ply_factor",
        "min",
        1.5,
        "choice: no matrix crack up to proof pressure",
    ),
    CheckLine("bore growth", "bore_growth", "max"),
    CheckLine("extrusion gap at the piston seal", "seal_gap", "max"),
    CheckLine(
        "extrusion of the seals (gap against pressure and hardness)",
        "extrusion_factor",
        "min",
        1.0,
        "compound data: largest gap at pressure",
    ),
    CheckLine(
        "column buckling at full extension",
        "buckling_factor",
        "min",
        3.5,
        "ISO/TS 13725 idealisation, safety factor 3.5",
    ),
    CheckLine("rod plies", "rod_factor", "min", 1.5, "choice: 1.5 on first ply or yield"),
    CheckLine(
        "local buckling of the rod's wall",
        "local_buckling_factor",
        "min",
        2.0,
        "choice: 2, on top of the knock-down for imperfections",
    ),
    CheckLine("rod thread root", "thread_factor", "min", 1.5, "choice: 1.5 on yield"),
    CheckLine(
        "bonded rod fittings",
        "fitting_factor",
        "min",
        1.5,
        "choice: 1.5 on the elastic peak shear, as cap retention",
    ),
    CheckLine(
        "bonds over the temperature range",
        "bond_thermal_factor",
        "min",
        1.0,
        "choice: elastic edge shear without load within the strength",
    ),
    CheckLine(
        "cap retention",
        "retention_factor",
        "min",
        1.5,
        f"choice: 1.5 on {judged_on(JOINTS.values(), 0)}",
    ),
    CheckLine(
        "cap retention at burst pressure",
        "retention_burst_factor",
        "min",
        4.0,
        f"as barrel burst: 4:1 on {judged_on(JOINTS.values(), 1)}",
    ),
    CheckLine("end plate bending", "cap_factor", "min", 1.5, "choice: 1.5 on yield"),
    CheckLine("clevis pins", "pin_factor", "min", 2.0, "choice: 2 on shear yield"),
    CheckLine(
        "smallest seal squeeze",
        "seal_squeeze",
        "min",
        0.08,
        "choice: 8 % after growth and tolerance (gland tables: 8 % at 5.33 mm to 15 % at 1.78 mm)",
    ),
    CheckLine(
        "largest seal squeeze",
        "seal_squeeze_max",
        "max",
        0.25,
        "choice: 25 %, the most that gland tables give (at 1.78 mm)",
    ),
    CheckLine("groove fill", "seal_fill", "max", 0.85, "common limit 85 %"),
    CheckLine("seal stretch", "seal_stretch", "max", 0.05, "ISO 3601-2 practice: 5 %"),
    CheckLine(
        "cross-section of moving O-rings",
        "seal_section",
        "min",
        3.53e-3,
        "advice against spiral failure: 3.53 mm or more",
        advice=True,
    ),
    CheckLine("breakaway friction", "friction_breakaway", "max"),
    CheckLine("running friction", "friction_running", "max"),
    CheckLine("force efficiency", "efficiency", "min", 0.85, "choice: 85 %"),
    CheckLine("stiffness at the weakest position", "stiffness_min", "min"),
    CheckLine("natural frequency at the load mass", "natural_frequency", "min"),
    CheckLine("seal damping", "damping_seal", "max"),
    CheckLine("damping ratio", "damping_ratio", "min", 0.0, "negative damping is stick-slip"),
    CheckLine(
        "gain margin of the position loop", "gain_margin", "min", 10 ** (6 / 20), "choice: 6 dB"
    ),
    CheckLine("port velocity", "port_velocity", "max", 8.0, "common practice, pressure ports"),
    CheckLine("line velocity", "line_velocity", "max", 6.0, "common practice, pressure lines"),
    CheckLine(
        "line pressure drop", "line_drop_ratio", "max", 0.05, "choice: 5 % of the supply pressure"
    ),
    CheckLine("flow", "flow", "max"),
    CheckLine(
        "cavitation in the chambers",
        "cavitation_margin",
        "min",
        0.0,
        "the oil boils below its vapour pressure; dissolved air leaves it earlier",
    ),
    CheckLine("piston speed", "piston_speed", "max", 0.5, "standard seals and cylinders: 0.5 m/s"),
    CheckLine(
        "end-stop peak pressure, the case's load still acting",
        "end_stop_factor",
        "min",
        1.0,
        "choice: peak within proof pressure",
    ),
    CheckLine("end-stop energy", "end_stop_energy", "max"),
    CheckLine(
        "rod-side pressure with its port blocked",
        "blocked_port_factor",
        "min",
        1.0,
        "advice: supply on the cap side alone makes p A_A/A_B; a relief valve bounds it",
        advice=True,
    ),
    CheckLine(
        "clearance over the temperature range",
        "clearance_min",
        "min",
        5e-6,
        "choice: 5 um of oil film left where piston and barrel expand unequally",
    ),
    CheckLine(
        "bearing overlap", "bearing_overlap", "min", 1.0, "span of at least one rod diameter"
    ),
    CheckLine(
        "guide pressure under side load",
        "bearing_factor",
        "min",
        1.0,
        "allowable bearing pressure of the guide material",
    ),
    CheckLine(
        "pressure-cycle life of metal parts",
        "cycle_life",
        "min",
        20000.0,
        "MIL-PRF-5503: 20 000 cycles at rated pressure",
    ),
    CheckLine("fatigue strength", "fatigue_factor", "min"),
    CheckLine(
        "fibre fatigue of the wall",
        "ply_fatigue_factor",
        "min",
        1.0,
        "the material's own fatigue strength at its cycles, after knock-downs (rule of thumb)",
    ),
    CheckLine(
        "temperature range",
        "temperature_margin",
        "min",
        0.0,
        "service limits of every material used",
    ),
    CheckLine(
        "trapped-fluid pressure",
        "trapped_factor",
        "min",
        1.0,
        "choice: trapped oil stays within proof pressure",
    ),
    CheckLine(
        "liner/laminate mismatch",
        "liner_mismatch_factor",
        "min",
        1.0,
        "liner yield under cool-down",
    ),
    CheckLine(
        "liner bond after cool-down",
        "liner_bond_factor",
        "min",
        1.0,
        "transverse strength of the ply at the liner",
    ),
    CheckLine(
        "liner strain range",
        "liner_range_factor",
        "min",
        1.0,
        "shakedown: stress range between zero and supply pressure within twice yield",
    ),
    CheckLine(
        "no reverse yield after autofrettage",
        "reverse_yield_factor",
        "min",
        1.0,
        "the liner's residual compression stays within yield",
    ),
    CheckLine(
        "tie-rod joint stays closed",
        "joint_factor",
        "min",
        1.0,
        "preload over what proof pressure takes from it",
    ),
    CheckLine(
        "winding angles", "winding_margin", "min", 0.0, "manufacture: least angle of the ply"
    ),
    CheckLine(
        "layer thicknesses", "ply_thickness_margin", "min", 0.0, "manufacture: least of the ply"
    ),
    CheckLine("mass", "mass", "max"),
    CheckLine("leakage across the piston", "leakage", "max"),
    CheckLine("standard sizes", "standard_sizes", "max", None, "ISO 3320"),
    CheckLine("standard glands", "standard_glands", "max", None, "ISO 3601-2 sections (AS568)"),
)
