"""Tables and figures that set [AaltoThesis] beside this project's models.

The text of the thesis gives ranges and forces; its stiffness curves stand in figures without
numbers. So the columns are its own formula and ours, and measured ranges where it prints them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.numeric import Array
from ..evaluation import Evaluation
from ..rendering import text
from ..rendering.blocks import Drawing, ExtraTable
from . import (
    aalto,
    aalto_dynamic,
    aalto_dynamic_notes,
    aalto_equations,
    aalto_figures,
    aalto_static,
    aalto_static_notes,
    aalto_trends,
)
from .aalto import PAPER, Theory
from .aalto_static import Answer, Bypass
from .aalto_text import air_text, area_text
from .paper_text import SLASH, percent, scaled


def _kn_per_mm(values: Array) -> str:
    return SLASH.join(text.number(float(v) * 1e-6) for v in values)


def _row(name: str, one: Theory) -> tuple[str, ...]:
    place, weakest = one.weakest
    minimum = f"{text.number(weakest * 1e-6)} at {text.trimmed(1e3 * place)} mm"
    return (
        name,
        _kn_per_mm(one.published_at),
        minimum,
        _kn_per_mm(one.per_chamber_at),
        _kn_per_mm(one.stretched_at),
    )


def stiffness_table(evaluation: Evaluation) -> ExtraTable:
    """Figures 5, 29 and 32: eq. 6, 37 and 38 as printed and per chamber."""
    design = evaluation.design
    pipes = aalto.pipes(design)
    oil = [
        ("no lines", aalto.oil_alone(design, ())),
        ("with pipes", aalto.oil_alone(design, pipes)),
        ("pipes, hoses", aalto.oil_alone(design, design.lines)),
    ]
    with_air = PAPER.bulk_modulus_with_air
    figure_29 = aalto.total(design, pipes, PAPER.bulk_modulus)
    figure_32 = aalto.total(design, design.lines, with_air)
    rows = [_row(f"figure 5, oil alone, {name}", one) for name, one in oil]
    rows += [
        _row("figure 29, eq. 37", figure_29),
        _row(
            "eq. 37 without load cell",
            aalto.total(design, pipes, PAPER.bulk_modulus, load_cell=False),
        ),
        _row("figure 32, eq. 38", figure_32),
        _row(
            "eq. 38 without load cell",
            aalto.total(design, design.lines, with_air, load_cell=False),
        ),
    ]
    drawn = Drawing(
        "Aalto thesis: stiffness along the stroke, as its figures 5, 29 and 32",
        aalto_figures.theory_figure(design.cylinder.stroke, oil, figure_29, figure_32),
        "Both forms with the same numbers, load cell included in figures 29 and 32; per chamber "
        "without the barrel's stretch.",
    )
    note = aalto_static_notes.stiffness_note(design, (figure_29, figure_32))
    columns = (
        "curve, kN/mm",
        f"its own formula, {scaled(aalto.places(design), 1e3)} mm",
        "minimum",
        "per chamber",
        "with stretch",
    )
    return ExtraTable("Aalto thesis: stiffness along the stroke", columns, rows, note, drawn)


def _moved(one: Answer) -> str:
    if not np.isfinite(one.range[0]):
        return "none: cavitates"
    words = text.DASH.join(f"{1e3 * value:.2f}" for value in one.range)
    return words + (f" ({one.cavitating} of 22 cavitate)" if one.cavitating else "")


def _held(one: Answer) -> str:
    if not np.isfinite(one.pressure_a):
        return "none: cavitates"
    return SLASH.join(text.trimmed(p * 1e-5, 3) for p in (one.pressure_a, one.pressure_b))


def _measured(moved: tuple[float, float]) -> str:
    return text.DASH.join(f"{1e3 * value:.2f}" for value in moved)


def _carried(found: Bypass, load: float) -> str:
    beside = f", {percent(found.share)} by-pass" if found.share >= 0 else ": more than all"
    return f"{text.trimmed(found.force / 1e3, 3)} of {text.trimmed(load / 1e3)} kN{beside}"


def static_table(evaluation: Evaluation) -> ExtraTable:
    """Force step to displacement, in both directions, against the measured ranges."""
    design = evaluation.design
    test = aalto_static.static_test(design)
    rows = [
        (
            "measured",
            _measured(PAPER.moved_up),
            _measured(PAPER.moved_down),
            "12 / 62",
            "40.5 / 17–19",
        )
    ]
    rows += [
        (one.name, _moved(one.up), _moved(one.down), _held(one.up), _held(one.down))
        for one in test.assumptions
    ]
    rows += [
        (
            "force on the chambers, by the measured pressures",
            _carried(test.up, aalto_static.UP),
            _carried(test.down, aalto_static.DOWN),
            text.DASH,
            text.DASH,
        ),
        ("entrained air behind the largest, no by-pass", air_text(test.air_up[0]),
         air_text(test.air_down[0]), text.DASH, text.DASH),
        ("the same, with by-pass", air_text(test.air_up[1]),
         air_text(test.air_down[1]), text.DASH, text.DASH),
    ]  # fmt: skip
    drawn = Drawing(
        "Aalto thesis: displacement under a force step, as its figure 42",
        aalto_figures.static_figure(design.cylinder.stroke, test),
        "Grey: measured, all positions and both piston directions. Load 3.45 and 4.85 kN, the "
        "means of both runs, read as steps (the text leaves open whether they are levels); "
        "behind the load cell; K 1600 MPa, polytropic index 1.4.",
    )
    columns = (
        "assumption",
        "load up, mm",
        "load down, mm",
        f"up: p_A / p_B at {text.trimmed(1e3 * test.place)} mm, bar",
        "down: p_A / p_B, bar",
    )
    note = aalto_static_notes.static_note(design, test)
    return ExtraTable("Aalto thesis: static test", columns, rows, note, drawn)


_ENDS = {"constant_pressure": "constant", "reducing_valve": "valve"}


def dynamic_table(evaluation: Evaluation) -> ExtraTable:
    """Dynamic stiffness at the tested frequencies for every throttle and line end."""
    test = aalto_dynamic.dynamic_test(evaluation.design)
    rows: list[tuple[str, ...]] = [("closed", text.DASH, "100 %", *_five(test.closed.tested))]
    for needle, found in (
        (area_text(test.area), test.stated),
        (area_text(test.needle.area), test.read_back),
    ):
        for end, responses in found.items():
            rows += [
                (_ENDS[end], needle, f"{100 * (1 - one.opening):.0f} %", *_five(one.tested))
                for one in responses
            ]
    drawn = Drawing(
        "Aalto thesis: dynamic stiffness over frequency",
        aalto_figures.dynamic_figure(test),
        aalto_dynamic_notes.needles_caption(test),
    )
    columns = ("line end", "needle", "throttle", *(f"{f:.0f} Hz" for f in aalto_dynamic.TESTED))
    note = aalto_dynamic_notes.dynamic_note(evaluation.design, test)
    return ExtraTable("Aalto thesis: dynamic tests", columns, rows, note, drawn)


def _five(values: Array) -> list[str]:
    return [text.number(float(abs(value)) * 1e-6, 3) for value in values]


def peak_table(evaluation: Evaluation) -> ExtraTable:
    """What the thesis says about the orifice and the 20 Hz peak, read back."""
    test = aalto_dynamic.dynamic_test(evaluation.design)
    needle, degrees = test.needle, evaluation.design.fluid.temperature - 273.15
    frequencies = [
        f"{text.trimmed(f, 3)} Hz ({chamber})"
        for chamber, f in zip("AB", test.peak.antiresonance_frequency, strict=True)
        if np.isfinite(f)
    ]
    rows = (
        ("T-pipe for 20 Hz", "16.25 m", f"{text.trimmed(test.t_pipe)} m (eq. 18)"),
        (
            "pipe resonance of the longer hose",
            "ruled out",
            f"{text.trimmed(test.quarter_wave, 3)} Hz (quarter wave)",
        ),
        (
            "Reynolds number of the needle",
            "100.8",
            f"{text.trimmed(needle.reynolds)} at {text.trimmed(degrees)} °C",
        ),
        (
            "viscosity behind it",
            text.DASH,
            f"{text.trimmed(1e6 * needle.viscosity, 3)} mm²/s at 20 mm/s",
        ),
        (
            "flow coefficient",
            "around 0.611",
            f"{text.trimmed(needle.flow_coefficient, 3)} at 20 mm/s; "
            f"{text.trimmed(needle.flow_coefficient_slow, 3)} at the base velocity",
        ),
        (
            "pressure drop, needle open, 20 mm/s",
            "0.4 bar (check valve opens)",
            f"{text.trimmed(needle.drop * 1e-5, 2)} bar",
        ),
        (
            "needle area",
            "0.22 cm²",
            f"{area_text(needle.area)} behind the measured drop",
        ),
        (
            "no reactive flow left, mid-stroke",
            "peak at 20 Hz",
            "; ".join(frequencies) or "nowhere: the valve is too weak",
        ),
    )  # fmt: skip
    return ExtraTable(
        "Aalto thesis: orifice and 20 Hz peak",
        ("quantity", "published", "ours"),
        rows,
        aalto_dynamic_notes.peak_note(evaluation.design, test),
    )


def equations_table(_: Evaluation) -> ExtraTable:
    """Every equation of the thesis with its function."""
    return aalto_equations.table()


TABLES: tuple[Callable[[Evaluation], ExtraTable], ...] = (
    stiffness_table,
    static_table,
    dynamic_table,
    peak_table,
    aalto_trends.trends_table,
    equations_table,
)
"""Every table, in the order of the thesis; the equations last."""
