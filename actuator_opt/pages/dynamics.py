"""Dynamics in a report: modes, dynamic stiffness and position loop, if the design has them.

A design with neither a valve nor a vibrating load case gets a single figure.
"""

from __future__ import annotations

import math

import numpy as np

from ..evaluation.dynamics_study import DynamicsStudy, LoopStudy
from ..evaluation.result import Evaluation, Requirement
from ..rendering import text
from ..rendering.blocks import Block, Cell, Chart, Column, Table, clean, short, soft
from ..rendering.text import DASH
from .dynamics_figures import (
    LoopLimits,
    Shaken,
    closed_panel,
    compact_panels,
    modes_panels,
    open_panels,
    response_panels,
)

FASTEST = 1e4
"""Poles above this frequency (Hz) are counted, not listed: the model is not valid there."""
COMPACT, MODES, RESPONSE, OPEN, CLOSED = 56.0, 54.0, 105.0, 97.0, 58.0
"""Heights of the figures [mm]."""
_END = {
    "closed": "ports closed",
    "valve": "hydraulic lines end at the centred valve",
    "constant_pressure": "hydraulic lines end at constant pressure",
    "reducing_valve": "each hydraulic line ends at a pressure reducing valve",
}


def dynamics_blocks(evaluation: Evaluation) -> list[Block]:
    """All blocks on dynamics; empty if the evaluation contains no study of the dynamics."""
    study = evaluation.dynamics
    if study is None or len(study.position) < 2 or not study.position[-1] > study.position[0]:
        return []
    if study.position_loop is None and not study.shaken:
        return [_compact(evaluation, study)]
    blocks = [_modes(evaluation, study), _poles(study), _response(evaluation, study)]
    if study.position_loop is not None:
        blocks += _loop(evaluation, study, (study.position_loop, *study.other_loops))
    return blocks


def required(evaluation: Evaluation, metric: str) -> list[Requirement]:
    """Requirements on one metric."""
    return [row for row in evaluation.requirements if row.metric == metric]


def _ratio(value: float) -> str:
    return text.number(value, 3)


def damping_sentence(study: DynamicsStudy) -> str:
    """Sentence on the damping ratio at the weakest position, and on the contributions to it."""
    friction, ends = study.friction_share, study.conductance_share
    whole = friction + ends
    small = 1e-4 * abs(whole)
    circle = " (open circle)" if abs(ends) >= small else ""
    shares = {f"friction and oil shear{circle}": friction, "leakage and hydraulic lines": ends}
    causes = ", ".join(
        f"{name} give {_ratio(share) if abs(share) >= small else 'next to nothing'}"
        for name, share in shares.items()
    )
    words = f"At the weakest position the damping ratio is {_ratio(whole)}: {causes}."
    if whole >= 1:
        words += " At 1 or above, the load does not oscillate."
    if whole < 0:
        words += " It is negative, so the oscillation grows: friction falls with rising speed."
    return words


def _line_end(study: DynamicsStudy) -> str:
    return _END.get(study.end, study.end.replace("_", " "))


def _compact(evaluation: Evaluation, study: DynamicsStudy) -> Block:
    panels = compact_panels(
        study, required(evaluation, "natural_frequency"), required(evaluation, "damping_ratio")
    )
    note = (
        f'Load case "{study.case}", {_line_end(study)}, {text.number(1.0 * study.mass)} kg at the '
        f"rod. {damping_sentence(study)} Dynamic stiffness includes the inertia of the load, "
        "which dominates above the resonance."
    )
    return Chart("Dynamics", panels, note, height=COMPACT, widths=(52.0, 48.0, 62.0))


def _modes(evaluation: Evaluation, study: DynamicsStudy) -> Block:
    panels = modes_panels(
        study, required(evaluation, "natural_frequency"), required(evaluation, "damping_ratio")
    )
    note = (
        f'Load case "{study.case}", {text.number(study.mass)} kg at the rod; with an oscillating '
        f"load, {_line_end(study)}. {damping_sentence(study)}"
    )
    return Chart("Dynamics along the stroke", panels, note, height=MODES)


def shaken_cases(study: DynamicsStudy) -> list[Shaken]:
    """Load cases with excitation, each at its stroke position of least dynamic stiffness."""
    return [
        Shaken(clean(case.name), case.frequency, case.stiffness, case.phase)
        for case in study.shaken
    ]


def _response(evaluation: Evaluation, study: DynamicsStudy) -> Block:
    cases = shaken_cases(study)
    panels = response_panels(
        study,
        cases,
        required(evaluation, "dynamic_stiffness"),
        required(evaluation, "dynamic_phase"),
    )
    note = f'Curves: load case "{study.response_case}", {_line_end(study)}.'
    if cases:
        note += (
            " Circles: load cases with an oscillating load, each at its frequency and its "
            "worst position. Red: requirements at these frequencies; the forbidden side is hatched."
        )
    note += " The position is not controlled (open loop)"
    note += ", so leakage lets the piston creep slowly." if study.end != "closed" else "."
    note += lumped_sentence(study)
    return Chart("Dynamic stiffness", [panels], note, height=RESPONSE)


def lumped_sentence(study: DynamicsStudy) -> str:
    """Sentence on the frequency up to which two models of the lines agree: lumped, distributed.

    Empty if the design has no lines.
    """
    if study.distributed is None:
        return ""
    lumped = next(response for response in study.responses if response.place == "weakest position")
    apart = np.abs(np.asarray(study.distributed) / np.asarray(lumped.magnitude) - 1)
    reach = {}
    for share in (0.01, 0.1):
        beyond = study.frequencies[apart > share]
        reach[share] = float(beyond[0]) if len(beyond) else None

    def upto(share: float) -> str:
        frequency = reach[share]
        return "1 kHz" if frequency is None else f"{text.number(frequency, 2)} Hz"

    words = (
        " With hydraulic lines modelled as transmission lines instead of lumped masses, the "
        f"magnitude differs by less than 1 % up to {upto(0.01)}"
    )
    return words + (
        f", and by less than 10 % up to {upto(0.1)}." if reach[0.01] is not None else "."
    )


def _poles(study: DynamicsStudy) -> Block:
    shown = [pole for pole in study.poles if pole.frequency <= FASTEST]
    natural = float(study.frequency[int(np.argmin(study.closed_frequency))])
    rows: list[list[Cell]] = []
    for pole in shown:
        if abs(pole.damping_ratio) < 1 and abs(pole.frequency / natural - 1) < 1e-3:
            meaning = "oscillation of the load on the springs of oil, walls and rod"
        elif abs(pole.damping_ratio) < 1:
            meaning = "oscillation of the oil in the lines between cylinder and valve or supply"
        else:
            constant = text.number(1e3 / (2 * math.pi * pole.frequency), 3)
            meaning = f"no oscillation: decays with a time constant of {constant} ms"
        if pole.damping_ratio < 0:
            meaning += "; grows"
        rows.append([text.number(pole.frequency), _ratio(pole.damping_ratio), meaning])
    columns = [
        Column("frequency, Hz", "right", 0.5),
        Column("damping ratio", "right", 0.5),
        Column("what", "left", 2.0),
    ]
    fast = len(study.poles) - len(shown)
    note = f'At the weakest position, load case "{study.case}", {_line_end(study)}.'
    if fast:
        plural = "poles lie" if fast > 1 else "pole lies"
        note += f" {fast} {plural} above 10 kHz and not listed, as the model is not valid there."
    return Table("Dynamics: poles", columns, rows, note=note, on="paper")


# ---- the loop ----


def _loop(
    evaluation: Evaluation, study: DynamicsStudy, loops: tuple[LoopStudy, ...]
) -> list[Block]:
    limits = LoopLimits(
        required(evaluation, "gain_margin"),
        required(evaluation, "phase_margin"),
        required(evaluation, "bandwidth"),
    )
    note = (
        "One curve for each combination of piston position and spool direction at which a "
        "margin or the bandwidth is least. Circles: least margins. Red: requirements; the "
        "forbidden side is hatched."
    )
    if any(_passes_behind(loop) for loop in loops):
        note += (
            " Above the resonance of the load the phase is below -180 degrees. There, the phase "
            "margin is the angle by which the phase lies below -180 degrees, and the loop is "
            "stable as long as the gain margin is above 1."
        )
    return [
        Chart("Position loop, open", [open_panels(study, loops, limits)], note, height=OPEN),
        Chart("Position loop, closed", [closed_panel(study, loops, limits)], height=CLOSED),
        _loop_table(evaluation, loops),
    ]


def _passes_behind(loop_study: LoopStudy) -> bool:
    """Whether the loop is stable despite a gain above 1 at phases below -180 degrees."""
    if loop_study.crossover is None or loop_study.gain_margin <= 1:
        return False
    above = np.asarray(loop_study.open_magnitude) >= 1
    return bool(np.any(np.asarray(loop_study.open_phase)[above] < -math.pi))


def _loop_table(evaluation: Evaluation, loops: tuple[LoopStudy, ...]) -> Block:
    first = loops[0]
    at = {(loop.case, loop.place): loop for loop in loops}
    tuned = (
        "half the ultimate gain (Ziegler and Nichols' rule for proportional control)"
        if first.tuned
        else "as stated in control.gain"
    )

    def row(name: str) -> list[Cell]:
        metric = evaluation.metrics[name]
        limits = [
            text.limit_text(metric.quantity, r.sense, r.limit) for r in required(evaluation, name)
        ]
        value = text.value_text(metric.quantity, metric.value)
        where = ", ".join(part for part in (metric.case, metric.place) if part)
        if metric.value is None:
            where = metric.why or ""
        loop = at.get((metric.case or "", metric.place or ""), first)
        return [
            name.replace("_", " ").replace("position gain", "gain"),
            value,
            _remark(name, loop, tuned),
            ", ".join(limits) or DASH,
            soft(short(where, 80) or DASH),
        ]

    names = ("position_gain", "ultimate_gain", "gain_margin", "phase_margin", "bandwidth")
    columns = [
        Column("", "left", 0.7),
        Column("value", "right", strong=True),
        Column("", "left", 1.3),
        Column("required", "right"),
        Column("where it is least", "left", 1.3),
    ]
    worst = first.place.partition(", ")[0]
    note = (
        f"The two directions of spool travel differ; {worst} has the smaller gain margin. Each "
        "value is the least of all load cases, positions and spool directions."
    )
    rows = [row(name) for name in names if name in evaluation.metrics]
    return Table("Position loop: gain, margins, bandwidth", columns, rows, note=note, on="paper")


def _remark(name: str, loop_study: LoopStudy, tuned: str) -> str:
    if name == "position_gain":
        return tuned
    if name == "ultimate_gain" and loop_study.ultimate_frequency > 0:
        return f"oscillates at {text.number(loop_study.ultimate_frequency)} Hz"
    if name == "gain_margin" and 0 < loop_study.gain_margin < math.inf:
        return f"{text.number(20 * math.log10(loop_study.gain_margin), 3)} dB"
    if name == "phase_margin" and loop_study.crossover is not None:
        return f"open loop crosses 0 dB at {text.number(loop_study.crossover)} Hz"
    if name == "bandwidth":
        return "closed loop falls to \N{MINUS SIGN}3 dB"
    return ""
