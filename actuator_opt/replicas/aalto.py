"""Tables that compare [AaltoThesis] with this project's models.

The text of the thesis gives ranges and forces; its stiffness curves are in figures without numbers.
Columns are therefore the printed formula's results, ours, and the measured ranges that are printed.
Verdicts follow from the values of the given design. Shares are relative to the static stiffness
with hoses at mid-stroke.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.numeric import Array
from ..evaluation import Evaluation
from ..rendering import text
from ..rendering.blocks import Block, Drawing, text_table
from . import aalto_models, trends
from .aalto_figures import area_text, dynamic_figure, static_figure, theory_figure
from .aalto_models import (
    DOWN,
    PAPER,
    TESTED,
    UP,
    Answer,
    Bypass,
    Theory,
    dynamic_test,
    oil_alone,
    places,
    static_test,
    total,
)
from .aalto_notes import (
    air_text,
    dynamic_note,
    needles_caption,
    peak_note,
    static_note,
    stiffness_note,
)
from .papers import (
    SLASH,
    TRACE_COLUMNS,
    equations,
    percent,
    scaled,
    trace_rows,
)


def _kn_per_mm(values: Array) -> str:
    return SLASH.join(text.number(float(v) * 1e-6) for v in values)


def _row(name: str, theory: Theory) -> tuple[str, ...]:
    place, weakest = theory.weakest
    minimum = f"{text.number(weakest * 1e-6)} at {text.trimmed(1e3 * place)} mm"
    return (
        name,
        _kn_per_mm(theory.published_at),
        minimum,
        _kn_per_mm(theory.per_chamber_at),
        _kn_per_mm(theory.stretched_at),
    )


def stiffness_table(evaluation: Evaluation) -> list[Block]:
    """Figures 5, 29 and 32: eq. 6, 37 and 38, as printed and with separate chambers."""
    design = evaluation.design
    pipes = aalto_models.pipes(design)
    oil = [
        ("no lines", oil_alone(design, ())),
        ("with pipes", oil_alone(design, pipes)),
        ("pipes, hoses", oil_alone(design, design.lines)),
    ]
    with_air = PAPER.bulk_modulus_with_air
    figure_29 = total(design, pipes, PAPER.bulk_modulus)
    figure_32 = total(design, design.lines, with_air)
    rows = [_row(f"figure 5, oil alone, {name}", theory) for name, theory in oil]
    rows += [
        _row("figure 29, eq. 37", figure_29),
        _row(
            "eq. 37 without load cell",
            total(design, pipes, PAPER.bulk_modulus, load_cell=False),
        ),
        _row("figure 32, eq. 38", figure_32),
        _row(
            "eq. 38 without load cell",
            total(design, design.lines, with_air, load_cell=False),
        ),
    ]
    drawn = Drawing(
        "Aalto thesis: stiffness along the stroke, as in figures 5, 29 and 32",
        theory_figure(design.cylinder.stroke, oil, figure_29, figure_32),
        "The printed equations and the form per chamber use the same numbers; the load cell is "
        "included in figures 29 and 32. Per chamber: without the barrel's axial stretch.",
    )
    note = stiffness_note(design, (figure_29, figure_32))
    columns = (
        "curve, kN/mm",
        f"as printed, at {scaled(places(design), 1e3)} mm",
        "minimum",
        "per chamber",
        "with stretch",
    )
    return [text_table("Aalto thesis: stiffness along the stroke", columns, rows, note), drawn]


def _moved(answer: Answer) -> str:
    if not np.isfinite(answer.range[0]):
        return "none: cavitates"
    words = text.DASH.join(f"{1e3 * value:.2f}" for value in answer.range)
    return words + (f" ({answer.cavitating} of 22 cavitate)" if answer.cavitating else "")


def _chamber_pressures(answer: Answer) -> str:
    if not np.isfinite(answer.pressure_a):
        return "none: cavitates"
    return SLASH.join(text.trimmed(p * 1e-5, 3) for p in (answer.pressure_a, answer.pressure_b))


def _measured(moved: tuple[float, float]) -> str:
    return text.DASH.join(f"{1e3 * value:.2f}" for value in moved)


def _carried(bypass: Bypass, load: float) -> str:
    beside = f", {percent(bypass.share)} by-pass" if bypass.share >= 0 else ": more than the load"
    return f"{text.trimmed(bypass.force / 1e3, 3)} of {text.trimmed(load / 1e3)} kN{beside}"


def static_table(evaluation: Evaluation) -> list[Block]:
    """Displacement by a force step in both directions, against the measured ranges."""
    design = evaluation.design
    test = static_test(design)
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
        (
            assumption.name,
            _moved(assumption.up),
            _moved(assumption.down),
            _chamber_pressures(assumption.up),
            _chamber_pressures(assumption.down),
        )
        for assumption in test.assumptions
    ]
    rows += [
        (
            "force of the measured pressures on the piston",
            _carried(test.up, UP),
            _carried(test.down, DOWN),
            text.DASH,
            text.DASH,
        ),
        ("air for the largest displacement, no by-pass", air_text(test.air_up[0]),
         air_text(test.air_down[0]), text.DASH, text.DASH),
        ("the same, with by-pass", air_text(test.air_up[1]),
         air_text(test.air_down[1]), text.DASH, text.DASH),
    ]  # fmt: skip
    drawn = Drawing(
        "Aalto thesis: displacement under a force step, as in figure 42",
        static_figure(design.cylinder.stroke, test),
        "Grey: measured, all positions and both piston directions. Load 3.45 and 4.85 kN, "
        "the means of both runs, taken as steps (the text does not state whether they are "
        "steps or levels); including the load cell; K 1600 MPa, polytropic index 1.4.",
    )
    columns = (
        "assumption",
        "load up, mm",
        "load down, mm",
        f"up: p_A / p_B at {text.trimmed(1e3 * test.place)} mm, bar",
        "down: p_A / p_B, bar",
    )
    note = static_note(design, test)
    return [text_table("Aalto thesis: static test", columns, rows, note), drawn]


_ENDS = {"constant_pressure": "constant", "reducing_valve": "valve"}


def dynamic_table(evaluation: Evaluation) -> list[Block]:
    """Dynamic stiffness at the tested frequencies for every throttle and line end."""
    test = dynamic_test(evaluation.design)
    rows: list[tuple[str, ...]] = [("closed", text.DASH, "100 %", *_five(test.closed.tested))]
    for needle, by_end in (
        (area_text(test.area), test.stated),
        (area_text(test.needle.area), test.read_back),
    ):
        for end, responses in by_end.items():
            rows += [
                (
                    _ENDS[end],
                    needle,
                    f"{100 * (1 - response.opening):.0f} %",
                    *_five(response.tested),
                )
                for response in responses
            ]
    drawn = Drawing(
        "Aalto thesis: dynamic stiffness over frequency",
        dynamic_figure(test),
        needles_caption(test),
    )
    columns = ("line end", "needle", "throttle", *(f"{f:.0f} Hz" for f in TESTED))
    note = dynamic_note(evaluation.design, test)
    return [text_table("Aalto thesis: dynamic tests", columns, rows, note), drawn]


def _five(values: Array) -> list[str]:
    return [text.number(float(abs(value)) * 1e-6, 3) for value in values]


def peak_table(evaluation: Evaluation) -> list[Block]:
    """Statements of the thesis on the orifice and the 20 Hz peak, recomputed."""
    test = dynamic_test(evaluation.design)
    needle, degrees = test.needle, evaluation.design.fluid.temperature - 273.15
    frequencies = [
        f"{text.trimmed(f, 3)} Hz ({chamber})"
        for chamber, f in zip("AB", test.peak.antiresonance_frequency, strict=True)
        if np.isfinite(f)
    ]
    rows = (
        ("length of a T-pipe for 20 Hz", "16.25 m", f"{text.trimmed(test.t_pipe)} m (eq. 18)"),
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
            "viscosity for this Reynolds number",
            text.DASH,
            f"{text.trimmed(1e6 * needle.viscosity, 3)} mm²/s at 20 mm/s",
        ),
        (
            "flow coefficient",
            "around 0.611",
            f"{text.trimmed(needle.flow_coefficient, 3)} at 20 mm/s; "
            f"{text.trimmed(needle.flow_coefficient_slow, 3)} at the highest load-case speed",
        ),
        (
            "pressure drop, needle open, 20 mm/s",
            "0.4 bar (check valve opens)",
            f"{text.trimmed(needle.drop * 1e-5, 2)} bar",
        ),
        (
            "needle area",
            "0.22 cm²",
            f"{area_text(needle.area)} for the measured drop",
        ),
        (
            "antiresonance of chamber and valve, mid-stroke",
            "peak at 20 Hz",
            "; ".join(frequencies) or "nowhere: the valve is too weak",
        ),
    )  # fmt: skip
    return [
        text_table(
            "Aalto thesis: orifice and 20 Hz peak",
            ("quantity", "published", "ours"),
            rows,
            peak_note(evaluation.design, test),
        )
    ]


def equations_table(_: Evaluation) -> list[Block]:
    """Every equation of the thesis with its function."""
    return table()


TABLES: tuple[Callable[[Evaluation], list[Block]], ...] = (
    stiffness_table,
    static_table,
    dynamic_table,
    peak_table,
    lambda evaluation: [trends.trends_table(evaluation)],
    equations_table,
)
"""Every table in the order of the thesis; the equations are last."""
TRACES = equations("aalto")


def table() -> list[Block]:
    """Every equation of the thesis with its function."""
    note = (
        "The functions are in actuator_opt.models with formula, range and source. The "
        "thesis prints 46 equations; dq/dt of eq. 43–45 and the force balance of eq. 40–42 "
        "are equations of a single linear system here."
    )
    return [
        text_table(
            "Aalto thesis: functions for its equations", TRACE_COLUMNS, trace_rows(TRACES), note
        )
    ]


def blocks(evaluation: Evaluation) -> list[Block]:
    """Every table and drawing."""
    return [block for table in TABLES for block in table(evaluation)]
