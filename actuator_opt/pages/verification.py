"""Blocks on requirements checked by time simulation, and on a scenario's sensitive parameters."""

from __future__ import annotations

from typing import NamedTuple

from ..base.quantities import RESULTS, Quantity
from ..metrics import METRICS
from ..rendering import text
from ..rendering.blocks import Block, Column, Notes, Row, State, Status, Table, text_table
from ..rendering.text import DASH, number, pretty, sentence
from ..simulation.sensitivity import Effect, Sensitivities
from ..simulation.verification import Verification, VerifiedRequirement
from .simulation import label, tied

HEADS = ("requirement", "limit", "evaluation", "linear", "simulated", "difference", "holds")
BESIDE = 0.02
"""A requirement is marked "beside" if the worst linear result, and the linear result at the
position and spool direction of the time simulation, differ by more than this share of the
former."""
MEANING = (
    "Evaluation: worst result of the linear models. Linear: result of the same models at the "
    "position of the experiment and with the valve spool open in the same direction; the "
    'difference refers to this value. "Beside": the worst linear result is for the opposite spool '
    "direction. The spool is open in that direction only while the load drifts; experiments start "
    "at rest, so none can check it."
)
UNSURE = "?"
"""Mark behind an effect that a run with half the parameter step does not confirm."""
MOST_RESULTS = 6
"""Largest number of results in a table of sensitivities; the most affected results are shown."""
BRIEF = {
    "rise_time": "rise",
    "settling_time": "settling",
    "steady_state_ratio": "steady error",
    "following_error": "following",
    "hold_drift": "creep",
    "peak_pressure": "peak p",
    "lowest_pressure": "lowest p",
    "cavitation_margin": "cavitation",
    "stop_speed": "stop speed",
    "supply_energy": "energy",
    "dynamic_stiffness": "stiffness",
    "dynamic_phase": "phase",
}
"""Short names of results for the heads of columns."""
_HOLDS = {"met": "yes", "missed": "no", "not_checked": "not known"}


# ---- requirements checked by time simulation ----


class RequirementLine(NamedTuple):
    """A requirement as printed, with its state and the experiment that checked it."""

    cells: tuple[str, ...]
    """Cells of the columns `HEADS`."""
    state: State
    experiment: str
    """Simulated experiment, or reason of a missing value; empty if there is nothing to report."""


def blocks(verification: Verification) -> list[Block]:
    """Blocks for the terminal: requirements by linear model and by simulation, then experiments."""
    lines = [_line(row) for row in verification.rows]
    columns = [Column(HEADS[0], width=1.0, least=20)]
    columns += [
        Column(head, "right", drop=drop, style=style)
        for head, drop, style in zip(
            HEADS[1:-1], (2, 3, 0, 0, 1), ("dim", "dim", "", "bold", ""), strict=True
        )
    ]
    columns.append(Column(HEADS[-1]))
    rows = [
        Row([*line.cells[:-1], Status(line.state, line.cells[-1])], line.state) for line in lines
    ]
    title = "Dynamic requirements in the time simulation"
    made: list[Block] = [Table(title, columns, rows)] if rows else []
    made.append(Notes(title, [verdict(verification)], headless=bool(rows)))
    experiments = [
        tied(f"{sentence(line.cells[0])[:-1]}: {line.experiment}")
        for line in lines
        if line.experiment
    ]
    if experiments:
        made.append(Notes("Experiments", experiments, headless=True, style="dim"))
    notes = [MEANING, *(sentence(pretty(words)) for words in verification.notes)]
    notes.append(f"{verification.runs} runs.")
    return [*made, Notes("Meaning", [" ".join(notes)], headless=True, style="dim")]


def tables(verification: Verification) -> tuple[Table, ...]:
    """Requirements and experiments as plain tables, for the report and for the run record."""
    if not verification.rows:
        return ()
    lines = [_line(row) for row in verification.rows]
    notes = [verdict(verification), MEANING, *map(sentence, verification.notes)]
    note = " ".join([*notes, f"{verification.runs} runs."])
    both = text_table(
        "Requirements in the time simulation", HEADS, [line.cells for line in lines], note
    )
    experiments = [
        (line.cells[0], *(pretty(words) or DASH for words in (row.where, row.how, row.why)))
        for line, row in zip(lines, verification.rows, strict=True)
        if line.experiment
    ]
    if not experiments:
        return (both,)
    heads = ("requirement", "case and place", "experiment", "cause of the difference")
    note = (
        "To find each cause's share of the difference, the experiment is repeated without sticking "
        "friction, then with a fiftieth of the amplitude. The rest is due to the operating point."
    )
    widths = (1, 1.2, 1.5, 3.5)
    return both, text_table("Experiments for these values", heads, experiments, note, widths=widths)


def verdict(verification: Verification) -> str:
    """Sentence on requirements that are met in the time simulation, missed, or unknown."""
    rows = verification.rows
    if not rows:
        return "No dynamic requirement is stated."
    met = sum(row.met for row in rows)
    missed = [_name(row) for row in rows if not row.met and row.value is not None]
    unknown = [_name(row) for row in rows if not row.met and row.value is None]
    words = f"{met} of {len(rows)} requirements are met in the time simulation"
    words += f"; missed: {', '.join(missed)}" if missed else ""
    return sentence(words + (f"; not known: {', '.join(unknown)}" if unknown else ""))


def _line(row: VerifiedRequirement) -> RequirementLine:
    quantity: Quantity = (RESULTS if row.origin == "scenario" else METRICS)[row.metric]
    state: State = "met" if row.met else "missed" if row.value is not None else "not_checked"
    cells = (
        _name(row),
        text.limit_text(quantity, row.sense, row.limit),
        text.value_text(quantity, row.stated),
        text.value_text(quantity, row.linear),
        text.value_text(quantity, row.value),
        DASH if row.difference is None else _percent(100 * row.difference),
        "yes, beside" if row.met and _beside(row) else _HOLDS[state],
    )
    parts = [row.where, row.how, row.why] if row.origin == "design" else [row.why]
    return RequirementLine(cells, state, pretty("; ".join(part for part in parts if part)))


def _name(row: VerifiedRequirement) -> str:
    return row.metric.replace("_", " ")


def _beside(row: VerifiedRequirement) -> bool:
    """Whether the linear result is clearly worse at a point that the experiment cannot check."""
    if row.stated is None or row.linear is None:
        return False
    return abs(row.stated - row.linear) > BESIDE * abs(row.stated)


def _percent(value: float) -> str:
    """A change in per cent, with a sign."""
    if abs(value) < 0.05:
        return "0.0 %"
    if value >= 1000:
        return f"× {number(1 + value / 100, 3)}"
    return f"{number(value, 2 if abs(value) < 100 else 3, signed=True)} %"


# ---- sensitive parameters ----


def sensitivity_blocks(sensitivities: Sensitivities) -> list[Block]:
    """Parameters ranked by largest effect, and parameters left out with the reason."""
    results = _affected(sensitivities)
    title = f"Sensitive parameters: {sensitivities.name}"
    note = (
        "Change of each result in per cent if the parameter rises by 1 %, or by the amount in "
        "the column 'for'. The parameter with the largest effect is first. Changes are computed "
        f"by central differences with steps of {number(100 * sensitivities.step, 2)} %. A "
        f"{UNSURE} marks changes that half the step does not confirm within 10 %. "
        f"{sensitivities.runs} runs."
    )
    columns = [
        Column("parameter", width=1.0, breaks=30, least=24),
        Column("value", "right", style="dim", drop=len(results) + 1),
        Column("for", "right", style="dim", drop=len(results) + 2),
    ]
    columns += [
        Column(f"{BRIEF.get(name, label(name))}, %", "right", drop=k)
        for k, name in enumerate(results)
    ]
    rows = []
    for parameter in sensitivities.parameters:
        value = text.value_text(parameter.quantity, parameter.value)
        effects = (_effect(parameter.effects.get(name)) for name in results)
        rows.append((parameter.path, value, parameter.unit, *effects))
    made: list[Block] = [Table(title, columns, rows, note=note)]
    if not results:
        made = [Notes(title, ["No parameter changes a result."], note=note)]
    if sensitivities.skipped:
        reasons = [f"{path}: {pretty(why)}" for path, why in sensitivities.skipped.items()]
        made.append(Notes("Parameters left out", reasons))
    return made


def _affected(sensitivities: Sensitivities) -> list[str]:
    """The results that parameters change most, in the order of the scenario."""

    def most(name: str) -> float:
        effects = [x.effects[name] for x in sensitivities.parameters if name in x.effects]
        return max((abs(x.percent or 0.0) for x in effects if x.reliable), default=0.0)

    names = [name for name in sensitivities.results if most(name) > 0]
    kept = sorted(names, key=most, reverse=True)[:MOST_RESULTS]
    return [name for name in names if name in kept]


def _effect(effect: Effect | None) -> str:
    """An effect in per cent, with a mark if a run with half the step does not confirm it."""
    if effect is None or effect.percent is None:
        return DASH
    small = abs(effect.percent) < 5e-3
    words = "0" if small else f"{effect.percent:+.2f}".replace("-", text.MINUS)
    return words if effect.reliable else f"{words} {UNSURE}"
