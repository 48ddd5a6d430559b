"""Where every numbered equation of [AaltoThesis] lives in this project, or why it does not."""

from __future__ import annotations

from ..rendering.blocks import ExtraTable
from .paper_text import TRACE_COLUMNS, Trace, trace_rows

_RECORD = "out of scope: evaluates measured records, not a design"

TRACES: tuple[Trace, ...] = (
    Trace(1, 1, "static stiffness", ("stiffness.trapped_air_load_step",), "its secant stiffness"),
    Trace(2, 2, "dynamic stiffness", ("linear.dynamic_stiffness",)),
    Trace(
        3,
        3,
        "sum of all parts",
        ("stiffness_published.series_of_totals_as_published", "stiffness.hydraulic_stiffness"),
        "the second per chamber, our default",
    ),
    Trace(4, 4, "bulk modulus", ("elements.capacitance",), "the definition, as C = V/K"),
    Trace(5, 5, "oil with air", ("fluid.effective_bulk_modulus",)),
    Trace(
        6,
        8,
        "oil of both chambers",
        ("stiffness_published.oil_stiffness_as_published", "stiffness.chamber_stiffness"),
        "volumes V = A l + lines from the design",
    ),
    Trace(
        9, 9, "orifice flow", ("orifice.orifice_flow", "one_way_valve.one_way_flow"), "laminar too"
    ),
    Trace(10, 10, "Reynolds number", ("orifice.discharge_coefficient",), "C_q follows it"),
    Trace(11, 12, "line resistance", ("elements.resistance", "lines.line_pressure_drop")),
    Trace(13, 14, "line inductance", ("elements.inertance",)),
    Trace(15, 16, "line capacitance", ("elements.capacitance", "linear.linear_actuator")),
    Trace(
        17,
        18,
        "plugged T-pipe",
        ("resonators.quarter_wave_length", "resonators.plugged_branch_impedance"),
    ),
    Trace(19, 19, "lumped resonance", ("elements.resonance_frequency",)),
    Trace(20, 20, "speed of sound", ("elements.sound_speed", "water_hammer.wave_speed")),
    Trace(21, 21, "rod", ("rod.axial_stiffness",)),
    Trace(
        22,
        24,
        "barrel",
        ("stiffness_published.barrel_stiffness_as_published", "barrel.barrel_stiffness"),
        "eq. 23 as printed, and corrected",
    ),
    Trace(
        25,
        26,
        "pipes and hoses",
        ("stiffness_published.line_stiffness_as_published", "lines.line_compliance"),
    ),
    Trace(
        27,
        29,
        "LuGre bristles",
        ("lugre.lugre_step", "lugre.lugre_steady_deflection"),
        "not in the linear model",
    ),
    Trace(30, 30, "Stribeck level", ("friction.stribeck_level",)),
    Trace(31, 31, "steady friction", ("friction.stribeck",)),
    Trace(32, 32, "LuGre force", ("lugre.lugre_step",), "its second result"),
    Trace(33, 36, "load-cell force, friction read back", (), _RECORD),
    Trace(
        37,
        38,
        "static model, dynamic baseline",
        ("stiffness_published.series_of_totals_as_published",),
        "figures 29 and 32 above; stiffness.topology: aalto_as_published",
    ),
    Trace(
        39,
        39,
        "dynamic response of orifices",
        (),
        "out of scope: in time, and eq. 9 under an inertia term; for small signals "
        "orifice_resistance and inertance in series",
    ),
    Trace(
        40,
        45,
        "pressure and flow under a sine",
        ("linear.linear_actuator",),
        "solved together with the load, not for a given force",
    ),
    Trace(
        46,
        46,
        "mean orifice velocity",
        ("orifice.discharge_coefficient",),
        "its Reynolds number, 100.8, is read back above",
    ),
)


def table() -> ExtraTable:
    """Every equation of the thesis with its function."""
    note = (
        "Functions stand in actuator_opt.models with formula, range and source. The thesis prints "
        "46 equations; dq/dt of eq. 43–45 and the force balance of eq. 40–42 are rows of one "
        "system here."
    )
    return ExtraTable(
        "Aalto thesis: where its equations are", TRACE_COLUMNS, trace_rows(TRACES), note
    )
