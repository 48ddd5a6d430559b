"""Table of all metrics: quantity, worst value, model, sources of warnings, check, labels.

Evaluation, check list, limits of the optimiser, warnings, tables, reports, JSON Schema and help all
use this table. To add a metric, write a row here and a line that computes it (`MetricArrays.put`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from math import pi
from types import MappingProxyType

from ..base.quantities import Quantity
from ..joints.cone import LEAST_CREST, LEAST_GRIP
from ..joints.joint import LEAST_METAL, judged_on, models_at
from ..joints.kinds import JOINTS, SLEEVED
from ..models.thread import LEAST_OVERLAP
from .duty_rows import DUTY_ROWS
from .metric_row import AT_ENDS, CRITERION, CheckLine, Feed, Least, MetricRow


def table(rows: Iterable[MetricRow]) -> Mapping[str, MetricRow]:
    """The rows by name, in their order.

    Raises
    ------
    ValueError : duplicate name of a metric or number of a check
    """
    by_name: dict[str, MetricRow] = {}
    numbers: dict[str, str] = {}
    for row in rows:
        if row.name in by_name:
            raise ValueError(f"metric {row.name}: duplicate name")
        if row.check is not None:
            other = numbers.setdefault(row.check.number, row.name)
            if other != row.name:
                raise ValueError(f"check {row.check.number}: used by {other} and {row.name}")
        by_name[row.name] = row
    return MappingProxyType(by_name)


def fed_by(feed: Feed, rows: Mapping[str, MetricRow]) -> Iterator[str]:
    """Names of the metrics whose validity warnings come from the source `feed`."""
    return (name for name, row in rows.items() if feed in row.feeds)


_LEAST_WALL = Least(LEAST_METAL, "our choice: at least 1 mm")

_ALL_JOINTS = (*JOINTS.values(), *SLEEVED)

# fmt: off
ROWS = table((
    MetricRow("mass", "m", "mass", "g", "mass of the dry actuator",
              worst="max", model="mass.tube_mass", feeds=(), check=CheckLine("13.1", "mass"),
              short="mass, dry"),
    MetricRow("mass_oil", "m_oil", "mass", "g",
              "mass of the oil inside, with the piston at the cap end",
              term="oil inside", worst="max", model="mass.oil_mass", feeds=(), check=None),
    MetricRow("push_force", "F_+", "force", "kN", "push force, net of friction and back-pressure",
              worst="min", model="forces.push_force", feeds=(),
              check=CheckLine("1.1", "push force net of friction and back-pressure"),
              short="push force, net"),
    MetricRow("pull_force", "F_-", "force", "kN", "pull force, net of friction and back-pressure",
              worst="min", model="forces.pull_force", feeds=(),
              check=CheckLine("1.2", "pull force net of friction and back-pressure"),
              short="pull force, net"),
    MetricRow("stiffness_min", "k_min", "stiffness", "kN/mm",
              "axial stiffness at the weakest stroke position", worst="min",
              model="stiffness.hydraulic_stiffness", feeds=("wall", "oil"), at_stops=True,
              check=CheckLine("6.4", "stiffness at the weakest position"),
              short="stiffness, weakest position"),
    MetricRow("stiffness_oil", "k_oil", "stiffness", "kN/mm",
              "stiffness of the oil alone at the weakest position",
              term="oil stiffness", worst="min",
              model="stiffness.chamber_stiffness", feeds=("oil",), at_stops=True, check=None),
    MetricRow("stiffness_rod", "k_rod", "stiffness", "kN/mm", "axial stiffness of the rod",
              term="rod stiffness", worst="min", model="rod.axial_stiffness", feeds=(), check=None,
              at={"layered tube": "layered_tube.tube_state"}),
    MetricRow("stiffness_barrel", "k_bar", "stiffness", "kN/mm",
              "stiffness with barrel swelling as the only compliance, at the weakest position",
              term="barrel stiffness",
              worst="min", model="barrel.chamber_compliance", feeds=("wall",), at_stops=True,
              check=None),
    MetricRow("stiffness_seals", "k_s", "stiffness", "kN/mm",
              "stiffness of the sticking seals, in parallel with the oil",
              term="seal stiffness", worst="min",
              model="lugre.lugre_bristle_stiffness", feeds=(), check=None),
    MetricRow("bore_growth", "u_i", "length", "um", "radial bore growth at supply pressure",
              worst="max", model="barrel.bore_growth", feeds=("wall", "own"),
              check=CheckLine("2.5", "bore growth"),
              by_wall={"layered": "layered_tube.tube_state",
                       "thin_laminate": "laminate.bore_growth_thin"}),
    MetricRow("seal_gap", "g", "length", "um", "radial extrusion gap at the piston seal",
              worst="max", model="gland.extrusion_gap", feeds=("wall",),
              check=CheckLine("2.6", "extrusion gap at the piston seal")),
    MetricRow("seal_squeeze", "C_min", "ratio", "%",
              "smallest seal squeeze after bore growth and tolerance", term="seal squeeze", worst="min",
              model="gland.squeeze_extremes", feeds=("wall",),
              check=CheckLine("5.1", "smallest seal squeeze", 0.08,
                          "our choice: 8 % after bore growth and tolerances (gland tables: 8 % "
                          "for 5.33 mm sections, 15 % for 1.78 mm)")),
    MetricRow("seal_squeeze_max", "C_max", "ratio", "%", "largest seal squeeze at assembly",
              worst="max", model="gland.squeeze_extremes", feeds=(),
              check=CheckLine("5.2", "largest seal squeeze", 0.25,
                          "our choice: 25 %, the largest in gland tables (1.78 mm sections)")),
    MetricRow("seal_fill", "phi", "ratio", "%", "largest groove fill",
              worst="max", model="gland.gland_fill", feeds=(),
              check=CheckLine("5.3", "groove fill", 0.85, "common limit 85 %")),
    MetricRow("seal_stretch", "e", "ratio", "%", "seal stretch",
              worst="max", model="gland.stretched_section", feeds=(),
              check=CheckLine("5.4", "seal stretch", 0.05, "ISO 3601-2 practice: 5 %")),
    MetricRow("seal_section", "W", "length", "mm", "seal cross-section",
              worst="min", model=None, feeds=(),
              check=CheckLine("5.5", "cross-section of moving O-rings", 3.53e-3,
                          "advice against spiral failure: 3.53 mm or more", advice=True)),
    MetricRow("contact_width", "b", "length", "mm", "seal contact width",
              worst="max", model="gland.limited_width", feeds=(), check=None),
    MetricRow("contact_pressure", "p_0", "pressure", "MPa", "peak seal contact pressure",
              worst="max", model="elastomer.modulus_gent", feeds=(), check=None),
    MetricRow("film_thickness", "h", "length", "um", "mean oil film under the running seal",
              term="oil film",
              worst="min", model="rough_surface.pressure_flow_factor", feeds=(), check=None),
    MetricRow("seal_wear", "pL", "line_load", "N/mm",
              "contact pressure times sliding distance, per double stroke", worst="max",
              model="wear.sliding_severity", feeds=(), check=None),
    MetricRow("rod_leakage", "V_l", "volume", "mm^3", "rod leakage, per double stroke",
              worst="max", model="rough_surface.pressure_flow_factor", feeds=(), check=None),
    MetricRow("inter_seal_pressure", "p_i", "pressure", "bar",
              "pressure between the seals of a pair",
              term="inter-seal pressure",
              worst="max", model="rough_surface.pressure_flow_factor", feeds=(), check=None),
    MetricRow("friction_running", "F_C", "force", "N",
              "running friction of seals, wipers and guides",
              worst="max", model="friction.stribeck_level", feeds=("wall",),
              check=CheckLine("6.2", "running friction"), short="running friction"),
    MetricRow("friction_breakaway", "F_S", "force", "N",
              "breakaway friction of seals, wipers and guides", worst="max",
              model="friction.breakaway", feeds=("wall",),
              check=CheckLine("6.1", "breakaway friction")),
    MetricRow("damping_pipe", "c", "damping", "N*s/m",
              "viscous damping by oil flow along the barrel",
              term="pipe damping", worst="max", model="damping.pipe_flow", feeds=(), check=None),
    MetricRow("damping_annular", "c_a", "damping", "N*s/m",
              "viscous damping by shear of the oil in the annular gaps",
              term="gap damping",
              worst="max", model="damping.annular_couette", feeds=(), check=None),
    MetricRow("damping_seal", "B", "damping", "kN*s/m",
              "secant damping of the seals at the stated speed",
              worst="max", model="damping.secant",
              feeds=(), check=CheckLine("6.6", "seal damping")),
    MetricRow("damping_ratio", "zeta", "ratio", "",
              "damping ratio of the load mass on the actuator",
              worst="min", model="loop.load_mode", feeds=("oil",),
              check=CheckLine("6.7", "damping ratio", 0.0, "negative damping means stick-slip")),
    MetricRow("natural_frequency", "f_0", "frequency", "Hz",
              "lowest natural frequency over the stroke, with load mass", worst="min",
              model="dynamics.natural_frequency", feeds=("wall", "oil"), at_stops=True,
              check=CheckLine("6.5", "natural frequency with load mass"),
              short="natural frequency, loaded"),
    MetricRow("dynamic_stiffness", "k_dyn", "stiffness", "kN/mm",
              "dynamic stiffness at the frequency of the load case", worst="min",
              model="linear.dynamic_stiffness", feeds=("oil",), check=None),
    MetricRow("dynamic_phase", "phi", "angle", "deg",
              "phase by which the force leads the motion at the frequency of the load case",
              worst="max", lower=-pi, upper=pi,
              model="linear.dynamic_stiffness", feeds=("oil",), check=None),
    MetricRow("ultimate_gain", "K_u", "signal_gain", "V/m",
              "gain at the stability limit of the position loop", worst="min",
              model="loop.ultimate_gain", feeds=("oil",), check=None),
    MetricRow("position_gain", "K_p", "signal_gain", "V/m", "gain of the position loop",
              worst="min", model="loop.ultimate_gain", feeds=(), check=None),
    MetricRow("gain_margin", "K_u/K_p", "ratio", "",
              "ultimate gain divided by actual gain of the position loop",
              worst="min", model="loop.ultimate_gain", feeds=("oil",),
              check=CheckLine("6.8", "gain margin of the position loop", 10 ** (6 / 20),
                          "our choice: 6 dB")),
    MetricRow("phase_margin", "phi_m", "angle", "deg", "phase margin of the position loop",
              worst="min", lower=-pi, upper=pi, model="loop.margins", feeds=("oil",), check=None),
    MetricRow("bandwidth", "f_b", "frequency", "Hz", "-3 dB bandwidth of the position loop",
              worst="min", model="loop.margins", feeds=("oil",), check=None),
    MetricRow("efficiency", "eta", "ratio", "%", "force efficiency",
              worst="min", model="forces.efficiency", feeds=(),
              check=CheckLine("6.3", "force efficiency", 0.85, "our choice: 85 %")),
    MetricRow("proof_factor", "S_p", "ratio", "",
              "yield or first-ply pressure divided by proof pressure",
              term="proof pressure", worst="min", model="barrel.von_mises", feeds=("wall",),
              check=CheckLine("2.2", "proof pressure (yield or first ply)", 1.0,
                          "ISO 10100 practice: proof 1.5 x working pressure"),
              by_wall={"layered": CRITERION, "thin_laminate": CRITERION},
              at=AT_ENDS),
    MetricRow("burst_factor", "S_b", "ratio", "",
              "barrel burst pressure divided by working pressure",
              term="burst pressure",
              worst="min", model="barrel.burst_pressure_thick", feeds=("wall", "own"),
              check=CheckLine("2.3", "barrel burst pressure", 4.0,
                          "4:1 industrial practice (2.5:1 aerospace option)"),
              by_wall={"layered": "tube_burst.burst_of_tube",
                       "thin_laminate": "burst_ladder.burst_by_ply_discount"},
              at={"axial rupture*": "tube_burst.axial_rupture_pressure"},
              short="burst / working pressure"),
    MetricRow("first_ply_factor", "S_fpf", "ratio", "",
              "first-ply pressure divided by working pressure",
              worst="min", model="strength_modes.max_stress_modes", feeds=("wall", "own"),
              check=CheckLine("2.4", "first-ply (leak) pressure", 1.5,
                          "our choice: no matrix cracks up to proof pressure"),
              by_wall={"layered": CRITERION, "thin_laminate": CRITERION},
              at=AT_ENDS),
    MetricRow("yield_factor", "S_y", "ratio", "",
              "yield strength divided by working stress, metal parts",
              term="working stress", worst="min", model="barrel.von_mises", feeds=("wall",),
              check=CheckLine("2.1", "wall stress at working pressure", 1.5,
                          "our choice: factor 1.5 against yield of every metal part"),
              by_wall={"layered": "strength.yield_utilisation",
                       "thin_laminate": "strength.yield_utilisation"},
              at={"rod": "column.amplified_moment", "second rod": "column.amplified_moment",
                  **models_at(_ALL_JOINTS, "yield_factor")}),
    MetricRow("fatigue_factor", "S_f", "ratio", "", "fatigue strength divided by stress amplitude",
              worst="min", model="endurance.fatigue_factor", feeds=(),
              check=CheckLine("10.2", "fatigue strength")),
    MetricRow("ply_fatigue_factor", "S_pf", "ratio", "",
              "fatigue strength divided by stress amplitude, fibres of the wall",
              term="fibre fatigue", worst="min",
              model="layered_tube.ply_stresses_at_faces", feeds=(),
              check=CheckLine("10.3", "fibre fatigue of the wall", 1.0,
                          "fatigue strength at the number of cycles that the material states, "
                          "after knock-downs (rule of thumb)")),
    MetricRow("cycle_life", "N", "ratio", "", "pressure cycles to failure",
              term="pressure cycles",
              worst="min", model="endurance.cycles_to_failure", feeds=("own",),
              check=CheckLine("10.1", "pressure-cycle life of metal parts", 20000.0,
                          "MIL-PRF-5503: 20 000 cycles at rated pressure")),
    MetricRow("buckling_factor", "S_k", "ratio", "", "buckling load divided by largest push load",
              worst="min", model="stepped.stepped_column_load", feeds=(),
              check=CheckLine("3.1", "column buckling at full extension", 3.5,
                          "ISO/TS 13725 idealisation, safety factor 3.5"),
              short="buckling / push load"),
    MetricRow("thread_factor", "S_t", "ratio", "",
              "yield strength divided by stress at the rod thread root",
              worst="min", model="rod.thread_stress_area", feeds=(),
              check=CheckLine("3.4", "rod thread root", 1.5,
                              "our choice: factor 1.5 against yield")),
    MetricRow("piston_nut_factor", "S_n", "ratio", "",
              "least preload of the piston's nut over its loss at proof pressure; permitted preload "
              "over the greatest",
              term="piston nut preload", worst="min", model="piston_nut.least_stud_share", feeds=(),
              at={"while tightened": "piston_nut.torsion_factor"},
              check=CheckLine("3.7", "piston stays clamped on the rod", 1.0,
                              "some preload remains at proof pressure, however it scatters")),
    MetricRow("retention_factor", "S_r", "ratio", "",
              "strength of cap retention divided by its load",
              worst="min", model="lap_joint.bond_edge_shear", feeds=(),
              check=CheckLine("4.1", "cap retention", 1.5,
                          f"our choice: 1.5 on {judged_on(JOINTS.values(), 0)}"),
              at=models_at(_ALL_JOINTS, "retention_factor")),
    MetricRow("retention_burst_factor", "S_rb", "ratio", "",
              "ultimate strength of cap retention divided by its load",
              term="cap retention, burst", worst="min", model=None, feeds=(),
              check=CheckLine("4.2", "cap retention at burst pressure", 4.0,
                          f"as for barrel burst: 4:1 on {judged_on(JOINTS.values(), 1)}"),
              at=models_at(_ALL_JOINTS, "retention_burst_factor")),
    MetricRow("cap_factor", "S_c", "ratio", "",
              "yield strength divided by bending stress of the end caps",
              worst="min", model="end_plate.hub_plate_stress", feeds=(),
              check=CheckLine("4.3", "end plate bending", 1.5,
                          "our choice: factor 1.5 against yield"),
              at={"cap, supported at its edge": "end_plate.hung_plate_stress",
                  "head": "end_plate.end_plate_stress",
                  "second gland": "end_plate.end_plate_stress"}),
    MetricRow("pin_factor", "S_pin", "ratio", "",
              "shear yield strength divided by shear stress of the clevis pins",
              worst="min", model="retention.pin_shear_stress", feeds=(),
              check=CheckLine("4.4", "clevis pins", 2.0,
                              "our choice: factor 2 against shear yield")),
    MetricRow("eye_bearing_factor", "S_b", "ratio", "",
              "static load rating of the spherical bearings divided by the largest push",
              term="spherical bearings", worst="min", model=None, feeds=(),
              check=CheckLine("4.6", "spherical bearings of the eyes", 1.5,
                              "our choice: factor 1.5 against the static load rating")),
    MetricRow("bearing_overlap", "L/d", "ratio", "",
              "bearing span divided by rod diameter, at full extension", worst="min",
              model="retention.guide_forces", feeds=(),
              check=CheckLine("9.2", "bearing overlap", 1.0, "span of at least one rod diameter")),
    MetricRow("bearing_pressure", "p_g", "pressure", "MPa",
              "largest guide pressure under side load",
              worst="max", model="retention.guide_forces", feeds=(), check=None),
    MetricRow("bearing_factor", "S_g", "ratio", "",
              "allowable guide pressure divided by the largest that occurs",
              term="guide pressure", worst="min", model="retention.guide_forces", feeds=(),
              check=CheckLine("9.3", "guide pressure under side load", 1.0,
                          "allowable bearing pressure of the guide material")),
    MetricRow("port_velocity", "v_p", "speed", "m/s", "oil speed in the port",
              worst="max", model="lines.port_velocity", feeds=(),
              check=CheckLine("7.1", "port velocity", 8.0, "common practice, pressure ports")),
    MetricRow("line_velocity", "v_l", "speed", "m/s", "oil speed in the line",
              worst="max", model="lines.line_velocity", feeds=(),
              check=CheckLine("7.2", "line velocity", 6.0, "common practice, pressure lines")),
    MetricRow("line_pressure_drop", "dp", "pressure", "bar", "pressure drop of the lines",
              worst="max", model="lines.line_pressure_drop", feeds=(), check=None),
    MetricRow("line_hammer", "dp_J", "pressure", "bar",
              "pressure rise when the line flow stops suddenly", worst="max",
              model="transmission_line.joukowsky_pressure", feeds=("oil",), check=None),
    MetricRow("line_resonance", "f_l", "frequency", "Hz", "quarter-wave resonance of the line",
              worst="min", model="elements.quarter_wave_frequency", feeds=("oil",), check=None),
    MetricRow("flow", "q", "flow", "l/min", "largest flow",
              worst="max", model="forces.chamber_flow", feeds=(), check=CheckLine("7.4", "flow")),
    MetricRow("piston_speed", "v", "speed", "m/s", "piston speed",
              worst="max", model=None, feeds=(),
              check=CheckLine("8.1", "piston speed", 0.5,
                          "standard seals and cylinders: 0.5 m/s")),
    MetricRow("power", "P", "power", "W", "mechanical output power",
              term="output power", worst="min", model="forces.power", feeds=(), check=None),
    MetricRow("end_stop_energy", "E_end", "energy", "J", "energy absorbed at the end of stroke",
              worst="max", model="endurance.end_stop_energy", feeds=(),
              check=CheckLine("8.3", "end-stop energy")),
    MetricRow("end_stop_pressure", "p_end", "pressure", "bar", "peak pressure at the end stop",
              term="end-stop pressure",
              worst="max", model="endurance.end_stop_peak_pressure", feeds=(), check=None),
    MetricRow("trapped_pressure", "p_tr", "pressure", "bar",
              "pressure rise of trapped oil over the temperature range", worst="max",
              model="oil_laws.thermal_pressure_slope", feeds=(), check=None),
    MetricRow("liner_mismatch_factor", "S_th", "ratio", "",
              "liner yield strength divided by its thermal mismatch stress",
              term="liner mismatch", worst="min", model="laminate.thermal_line_forces", feeds=(),
              check=CheckLine("11.3", "liner/laminate mismatch", 1.0,
                          "the liner must not yield as it cools down"),
              by_wall={"layered": "layered_tube.tube_state"}),
    MetricRow("liner_bond_factor", "S_bd", "ratio", "",
              "transverse ply strength divided by radial tension from the liner after cool-down",
              worst="min", model=None, feeds=(), check=CheckLine("11.4",
              "liner bond after cool-down", 1.0,
                          "transverse strength of the ply at the liner"),
              by_wall={"layered": "layered_tube.tube_state"}),
    MetricRow("liner_range_factor", "S_dl", "ratio", "",
              "twice the liner's yield strength divided by its stress range",
              term="liner plastic range",
              worst="min", model=None, feeds=(),
              check=CheckLine("11.5", "liner strain range", 1.0,
                          "shakedown: from zero to supply pressure, the stress changes by less "
                          "than twice the yield strength"),
              by_wall={"layered": "liner.liner_cycle", "thin_laminate": "liner.liner_cycle"}),
    MetricRow("reverse_yield_factor", "S_rev", "ratio", "",
              "liner yield strength divided by its residual stress after autofrettage", worst="min",
              model="autofrettage.autofrettage", feeds=(),
              check=CheckLine("11.6", "no reverse yield after autofrettage", 1.0,
                          "the liner's residual compression stays within yield")),
    MetricRow("liner_strain_range", "d_eps", "ratio", "%",
              "equivalent elastic strain range of the liner under a pressure pulse", worst="max",
              model=None, feeds=(), check=None,
              by_wall={"layered": "liner.liner_cycle", "thin_laminate": "liner.liner_cycle"}),
    MetricRow("joint_factor", "S_j", "ratio", "",
              "least tie-rod preload over its loss at proof pressure; permitted preload over the "
              "greatest",
              term="tie-rod preload", worst="min", model="barrel_ends.tie_rod_forces", feeds=(),
              at={"while tightened": "piston_nut.torsion_factor"},
              check=CheckLine("11.7", "tie-rod joint stays closed", 1.0,
                          "some preload remains at proof pressure, however it scatters")),
    MetricRow("ring_assembly_factor", "S_o", "ratio", "",
              "yield strength of the retaining ring divided by its stress as it passes the bore",
              worst="min", model="retaining_ring.springing", feeds=(),
              check=CheckLine("4.5", "retaining ring springs into its groove", 1.0,
                              "no permanent set at assembly")),
    MetricRow("shrink_contact", "p_c", "pressure", "MPa",
              "contact pressure of a shrunk ring on the barrel", worst="min",
              model="shrink_fit.contact_pressure", feeds=(), check=None),
    MetricRow("local_buckling_factor", "S_w", "ratio", "",
              "local buckling load of the rod's wall divided by the largest push load",
              term="local buckling", worst="min",
              model="shell_buckling.local_shell_force", feeds=(),
              check=CheckLine("3.3", "local buckling of the rod's wall", 2.0,
                          "our choice: 2, in addition to the knock-down for imperfections")),
    MetricRow("rod_factor", "S_ro", "ratio", "",
              "strength of the rod's plies divided by their stress",
              worst="min", model=CRITERION, feeds=(),
              check=CheckLine("3.2", "rod plies", 1.5,
                          "our choice: 1.5 on first-ply failure or yield"),
              at={"* yield, *": "strength.yield_utilisation"}),
    MetricRow("fitting_factor", "S_ft", "ratio", "",
              "strength of the bonded rod fittings divided by their load", worst="min",
              model="lap_joint.bond_edge_shear", feeds=(),
              check=CheckLine("3.5", "bonded rod fittings", 1.5,
                          "our choice: 1.5 on the elastic peak shear, as for cap retention")),
    MetricRow("bond_thermal_factor", "S_bt", "ratio", "",
              "bond strength divided by the thermal shear stress at the bond's edge, without load",
              term="thermal bond stress", worst="min",
              model="lap_joint.bond_thermal_shear", feeds=(),
              check=CheckLine("3.6", "bonds over the temperature range", 1.0,
                          "our choice: without load, the elastic shear at the bond's edge stays "
                          "below its strength")),
    MetricRow("winding_margin", "-", "angle", "deg",
              "winding angle minus the smallest feasible angle", worst="min", model=None, feeds=(),
              check=CheckLine("12.1", "winding angles", 0.0,
                          "smallest winding angle that can be made with the ply")),
    MetricRow("turn_length", "L_t", "length", "mm",
              "length that a winding without pins or domes needs at each end to turn",
              worst="max", model="winding_path.turn_length", feeds=(), check=None),
    MetricRow("ply_thickness_margin", "-", "ratio", "%",
              "layer thickness minus the smallest feasible thickness, divided by the latter",
              worst="min", model=None,
              feeds=(),
              check=CheckLine("12.2", "layer thicknesses", 0.0,
                          "smallest thickness that can be made with the ply")),
    MetricRow("growth_at_seal", "u_s", "length", "um", "radial bore growth at the piston seal",
              term="bore growth at seal",
              worst="max", model="barrel_ends.pressure_step_factor", feeds=(), check=None,
              by_wall={"layered": "barrel_ends.pressure_step_factor"}),
    MetricRow("clearance_min", "c_min", "length", "um",
              "smallest radial clearance of piston and head over the temperature range",
              term="smallest clearance", worst="min",
              model=None, feeds=(),
              check=CheckLine("9.1", "clearance over the temperature range", 5e-6,
                          "our choice: 5 um remain for an oil film after unequal thermal "
                          "expansion")),
    MetricRow("blocked_port_factor", "S_bl", "ratio", "",
              "proof pressure divided by the rod-side pressure with the rod-side port blocked",
              term="blocked port", worst="min", model=None,
              feeds=(),
              check=CheckLine("8.4", "rod-side pressure with blocked port", 1.0,
                          "advice: the rod-side pressure rises to the cap-side pressure times the "
                          "ratio of the piston areas; fit a relief valve", advice=True)),
    MetricRow("temperature_margin", "dT", "temperature_difference", "K",
              "margin to the nearest service temperature limit of any material",
              term="temperature range", worst="min", model=None, feeds=(),
              check=CheckLine("11.1", "temperature range", 0.0,
                          "service temperature limits of all materials used")),
    MetricRow("oil_viscosity", "nu", "kinematic_viscosity", "mm^2/s",
              "oil viscosity at the temperature of the load case", worst="max",
              model="fluid.viscosity_astm_d341", feeds=(), check=None),
    MetricRow("cavitation_margin", "p-p_v", "pressure", "bar",
              "lowest absolute chamber pressure minus the vapour pressure of the oil", worst="min",
              model="fluid.vapour_pressure", feeds=(),
              check=CheckLine("7.5", "cavitation in the chambers", 0.0,
                          "the oil boils below its vapour pressure; dissolved air comes out "
                          "even above it")),
    MetricRow("extrusion_factor", "g_max/g", "ratio", "",
              "allowable extrusion gap divided by the actual gap",
              term="seal extrusion",
              worst="min", model="gland.extrusion_gap_limit", feeds=("wall",),
              check=CheckLine("2.7",
                          "extrusion of the seals (gap against pressure and hardness)", 1.0,
                          "largest gap that the compound's data allow at this pressure")),
    MetricRow("end_stop_factor", "S_end", "ratio", "",
              "proof pressure divided by peak end-stop pressure",
              term="end-stop strength",
              worst="min", model="endurance.end_stop_peak_pressure", feeds=(),
              check=CheckLine("8.2",
                          "end-stop peak pressure, including the load of the load case", 1.0,
                          "our choice: the peak stays within proof pressure")),
    MetricRow("trapped_factor", "S_tr", "ratio", "",
              "proof pressure divided by trapped-oil pressure",
              term="trapped-oil strength",
              worst="min", model="oil_laws.thermal_pressure_slope", feeds=(),
              check=CheckLine("11.2", "trapped-fluid pressure", 1.0,
                          "our choice: trapped oil stays within proof pressure")),
    MetricRow("line_drop_ratio", "dp/p", "ratio", "%",
              "line pressure drop as a share of supply pressure",
              term="line drop, share",
              worst="max", model="lines.line_pressure_drop", feeds=(),
              check=CheckLine("7.3", "line pressure drop", 0.05,
                          "our choice: 5 % of the supply pressure")),
    MetricRow("liner_yield_factor", "S_l", "ratio", "",
              "liner yield pressure divided by working pressure",
              term="liner yield pressure",
              worst="min", model="barrel.von_mises", feeds=("wall",), check=None,
              by_wall={"layered": "strength.yield_utilisation",
                       "thin_laminate": "strength.yield_utilisation"}),
    MetricRow("leakage", "q_l", "flow", "ml/min", "leakage across the piston",
              term="piston leakage", worst="max", model="damping.gap_conductance", feeds=(),
              check=CheckLine("13.2", "leakage across the piston")),
    MetricRow("barrel_length", "L_b", "length", "mm", "barrel length",
              worst="max", model=None, feeds=(), check=None),
    MetricRow("closed_length", "L_0", "length", "mm", "length pin to pin, retracted",
              worst="max", model=None, feeds=(), check=None, short="closed length, pin to pin"),
    MetricRow("joint_torque_min", "M_min", "torque", "N*m",
              "smallest torque of the actuator on the joint over the stroke",
              term="joint torque", worst="min",
              model="linkage.joint_torque", feeds=(), check=None),
    MetricRow("joint_range", "d_theta", "angle", "deg", "joint angle range over the stroke",
              term="joint range", worst="min", model="linkage.linkage_angle", feeds=(), check=None),
    MetricRow("geometry_rod_in_bore", "-", "length", "mm", "radial clearance between rod and bore",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_rod_wall", "-", "length", "mm", "rod wall thickness",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_rod_bore", "-", "length", "mm",
              "remaining inner diameter of the layered rod",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_piston_groove", "-", "length", "mm",
              "remaining axial wall beside the piston grooves", worst="min", model=None, feeds=(),
              check=None, least=_LEAST_WALL),
    MetricRow("geometry_piston_core", "-", "length", "mm",
              "remaining wall under the piston groove",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_head_groove", "-", "length", "mm",
              "remaining axial wall beside the head grooves",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_head_wall", "-", "length", "mm",
              "remaining wall around the rod seal groove",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_skirts", "-", "length", "mm",
              "barrel length that remains between the skirts of the caps",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_inner_skirt", "-", "length", "mm",
              "length of the head's plug inside its inner skirt, less that of the skirt",
              worst="min", model=None, feeds=(), check=None,
              least=Least(0.0, "the piston must not meet the skirt")),
    MetricRow("geometry_taper", "-", "length", "mm",
              "length of the skirts that does not taper",
              worst="min", model=None, feeds=(), check=None,
              least=Least(0.0, "a taper is at most as long as its skirt")),
    MetricRow("geometry_barrel_thread", "-", "length", "mm",
              "metal that remains under the barrel thread in the threaded layer", worst="min",
              model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_skirt_thread", "-", "length", "mm",
              "metal that remains around the thread of the caps' skirts",
              worst="min", model=None, feeds=(),
              check=None, least=_LEAST_WALL),
    MetricRow("geometry_bore_thread", "-", "length", "mm",
              "metal that remains under the plug's thread in the innermost layer",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_plug_opening", "-", "length", "mm",
              "minor diameter of the plug's thread, less that of the bore",
              worst="min", model=None, feeds=(), check=None,
              least=Least(0.0, "the piston must pass the thread")),
    MetricRow("geometry_ring_groove", "-", "length", "mm",
              "metal that remains under the groove of the retaining ring",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_pins", "-", "ratio", "%",
              "pattern of the pins, as a share of the least for which they can be calculated",
              worst="min", model=None, feeds=(), check=None,
              least=Least(1.0, "the formulas hold for laminates and patterns in this range")),
    MetricRow("geometry_pin_skirt", "-", "length", "mm",
              "metal and clearance inside the skirt of a plug that pins hold", worst="min",
              model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_shrink", "-", "length", "mm",
              "length of a shrunk ring that grips, without its ends", worst="min",
              model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_plug", "-", "length", "mm",
              "wall of the plug that remains beside its static seal",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_static_seal", "-", "length", "mm",
              "wall of the head that remains beside the groove of its static seal",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_piston_web", "-", "length", "mm",
              "metal of the piston under the recess of its nut",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_port", "-", "length", "mm",
              "metal beside the ports, and clearance around their bosses",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_sensor", "-", "length", "mm",
              "clearance of the position sensor in the rod, beside it and before its tip",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_cushion", "-", "length", "mm",
              "walls of the bushes and of the collar of the cushions",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_ring_opening", "-", "length", "mm",
              "radial clearance between the retaining ring and the rod",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_trap", "-", "length", "mm",
              "length or wall that remains at the trap of a cone",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_trap_crest", "-", "ratio", "",
              "crest radius of a cone divided by the thickness of its band",
              worst="min", model=None, feeds=(), check=None,
              least=Least(LEAST_CREST, "our choice: least radius over which a winder lays tows, "
                          "in band thicknesses")),
    MetricRow("geometry_trap_grip", "-", "ratio", "",
              "depth of the valley of a cone divided by the radial give of its hoop plies",
              worst="min", model="fibre_trap.radial_give", feeds=(), check=None,
              least=Least(LEAST_GRIP, "our choice: with a give above 2 % of the depth, the band "
                          "climbs over the crest")),
    MetricRow("geometry_sleeve", "-", "length", "mm",
              "lift of the winding by a sleeve, its cover beyond the tip, and barrel between sleeves",
              worst="min", model=None, feeds=(), check=None,
              least=Least(0.0, "a sleeve is at least as thick as the liner; its tip, and the other "
                               "sleeve, must fit")),
    MetricRow("geometry_lip", "-", "length", "mm",
              "clearance between the barrel's end, which encloses the plug, and the eyes",
              worst="min", model=None, feeds=(), check=None, least=_LEAST_WALL),
    MetricRow("geometry_dead_point", "-", "length", "mm",
              "actuator travel that remains before the linkage reaches a dead point",
              worst="min", model=None,
              feeds=(), check=None,
              least=Least(LEAST_METAL,
                          "our choice: 1 mm before the dead point, where force gives no torque")),
    MetricRow("geometry_joint_angle", "-", "ratio", "%",
              "share of the stroke that remains beyond the joint angle of a load case",
              worst="min", model=None, feeds=(),
              check=None, least=Least(0.0, "the joint must reach the angle of the load case")),
    MetricRow("geometry_thread_crest", "-", "ratio", "%",
              "engagement depth of the cap thread, as a share of the depth with full crests",
              worst="min", model=None,
              feeds=(), check=None,
              least=Least(LEAST_OVERLAP,
                          "our choice: the depth that tolerance 6g leaves at a pitch of 1 mm")),
    *DUTY_ROWS,
))
# fmt: on
"""Declaration of every metric, by name."""

_OF_CASE = re.compile(r"(\w+)\[([^\[\]]+)\]")


def split_case(name: str) -> tuple[str, str | None]:
    """Metric, and the load case or duty cycle whose value is meant; None: the worst of all.

    >>> split_case("friction_running[swing]"), split_case("mass")
    (('friction_running', 'swing'), ('mass', None))
    """
    found = _OF_CASE.fullmatch(name)
    return (found[1], found[2]) if found else (name, None)


class Quantities(dict[str, Quantity]):
    """Quantities of metrics by name; ``METRIC[CASE]`` has that of its metric, and its own label."""

    def __missing__(self, name: str) -> Quantity:
        """The quantity of a metric in a single case."""
        metric, case = split_case(name)
        if case is None or metric not in self:
            raise KeyError(name)
        return replace(self[metric], name=name, label=f"{self[metric].label}, {case}")


METRICS: Mapping[str, Quantity] = MappingProxyType(
    Quantities({name: row.quantity for name, row in ROWS.items()})
)
"""The quantity of every metric."""

OF_LIFE = frozenset((
    "duty_fatigue", "duty_sliding", "duty_wear", "duty_wear_share", "duty_gas_volume",
    "duty_tank_temperature", "system_mass",
))  # fmt: skip
"""Metrics of all duty cycles together, which have no value for a single cycle."""

CHECKS: tuple[tuple[MetricRow, CheckLine], ...] = tuple(
    sorted(
        ((row, row.check) for row in ROWS.values() if row.check is not None),
        key=lambda line: line[1].order,
    )
)
"""The check list: every metric that has a limit, with its line of the list, in the order of the
line numbers. A limit applies to the worst value of its metric."""

WALL_FED = tuple(fed_by("wall", ROWS))
"""Metrics that inherit the validity warnings of the barrel's wall model."""

AT_STOPS = tuple(name for name, row in ROWS.items() if row.at_stops)
"""Metrics that are also computed at both end stops if the loads there differ."""

OIL_FED = tuple(fed_by("oil", ROWS))
"""Metrics that inherit the validity warnings of the oil's bulk modulus."""

OWN = frozenset(fed_by("own", ROWS))
"""Metrics whose validity warnings concern the model named in their own row."""


TERM = 24
"""Largest number of letters of a metric's term."""
_SHORT_ENDS = re.compile(r", | / ")


def term_of(name: str) -> str:
    """Name of a metric in a few plain words, for a line of the terminal.

    It is the stated `term`; by default the beginning of `short`, the name of the check, the label,
    or else the words of the key, the first that has at most `TERM` letters.

    >>> term_of("buckling_factor"), term_of("seal_gap"), term_of("yield_factor")
    ('buckling', 'seal gap', 'working stress')
    """
    metric, case = split_case(name)
    if case is not None:
        return f"{term_of(metric)}, {case}"
    row = ROWS.get(name)
    if row is None:
        return of_metric(name).label
    check = "" if row.check is None else row.check.name
    key = name.removeprefix("geometry_").removesuffix("_factor").replace("_", " ")
    names = (row.term, _SHORT_ENDS.split(row.short)[0], check, row.label)
    return next((words for words in names if 0 < len(words) <= TERM), key)


def is_safety(name: str) -> bool:
    """Whether a metric is a safety factor, which no remedy should lower unless asked to."""
    return name.endswith("_factor")


def of_metric(name: str) -> Quantity:
    """Quantity (label, dimension, unit) of a metric; for an undeclared name, a plain ratio."""
    try:
        return METRICS[name]
    except KeyError:
        return Quantity(name, "", "ratio", "", name.replace("_", " "))
