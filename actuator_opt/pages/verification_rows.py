"""What a page says of requirements checked in time, and of sensitive parameters."""

from __future__ import annotations

from typing import NamedTuple

from ..base.quantities import RESULTS, Quantity
from ..metrics import METRICS
from ..rendering import text
from ..rendering.blocks import Table, text_table
from ..rendering.text import DASH, number, pretty, sentence
from ..simulation.sensitivity import Effect, Parameter, Sensitivities
from ..simulation.verification import Verification, VerifiedRequirement

HEADS = ("requirement", "limit", "evaluation", "linear", "in time", "difference", "holds")
BESIDE = 0.02
"""Difference of the linear tier at its worst and where the experiment stands that is told."""
MEANING = (
    "Evaluation: the linear tier at its worst; linear: the same where the experiment stands, on "
    "the side on which its spool rests; the difference is from that. Beside: the linear tier is "
    "worse on the side that the spool only passes as the load drifts; experiments stand at rest."
)
UNSURE = "?"
"""Behind an effect that half the step does not confirm."""
COLUMNS = 6
"""Results of a table of sensitivities, the most affected ones."""
SHORT = {
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
"""Results in the head of a column."""


class Line(NamedTuple):
    """A requirement as printed."""

    cells: tuple[str, ...]
    """Under `HEADS`."""
    state: str
    """met, missed or not_checked"""
    said: str
    """Experiment and reason; empty where there is nothing to say."""


def quantity(row: VerifiedRequirement) -> Quantity:
    """What a requirement limits."""
    return (RESULTS if row.origin == "scenario" else METRICS)[row.metric]


def label(row: VerifiedRequirement) -> str:
    """A requirement in few words."""
    return row.metric.replace("_", " ")


def line(row: VerifiedRequirement) -> Line:
    """A requirement with both tiers."""
    known = quantity(row)
    state = "met" if row.met else "missed" if row.value is not None else "not_checked"
    cells = (
        label(row),
        text.limit_text(known, row.sense, row.limit),
        text.value_text(known, row.stated),
        text.value_text(known, row.linear),
        text.value_text(known, row.value),
        DASH if row.difference is None else _percent(100 * row.difference),
        "yes, beside" if row.met and _beside(row) else _HOLDS[state],
    )
    return Line(cells, state, _said(row))


_HOLDS = {"met": "yes", "missed": "no", "not_checked": "not known"}


def _beside(row: VerifiedRequirement) -> bool:
    """Whether the linear tier is clearly worse where no experiment can stand."""
    if row.stated is None or row.linear is None:
        return False
    return abs(row.stated - row.linear) > BESIDE * abs(row.stated)


def _said(row: VerifiedRequirement) -> str:
    parts = [row.why]
    if row.origin == "design":
        parts = [row.where, row.how, row.why]
    return pretty("; ".join(part for part in parts if part))


def _percent(value: float) -> str:
    """A change in per cent, with a sign."""
    if abs(value) < 0.05:
        return "0.0 %"
    if value >= 1000:
        return f"× {number(1 + value / 100, 3)}"
    return f"{number(value, 2 if abs(value) < 100 else 3, signed=True)} %"


def verdict(found: Verification) -> str:
    """What came of it, in a sentence."""
    rows = found.rows
    if not rows:
        return "No dynamic requirement is stated."
    met = sum(row.met for row in rows)
    missed = [label(row) for row in rows if not row.met and row.value is not None]
    unknown = [label(row) for row in rows if not row.met and row.value is None]
    words = f"{met} of {len(rows)} requirements hold in time"
    words += f"; missed: {', '.join(missed)}" if missed else ""
    return sentence(words + (f"; not known: {', '.join(unknown)}" if unknown else ""))


def effort(found: Verification) -> str:
    """How much was run."""
    return f"{found.runs} runs."


def verification_rows(found: Verification) -> tuple[Table, ...]:
    """Tables of a report: requirements in both tiers, and what each experiment showed."""
    if not found.rows:
        return ()
    lines = [line(row) for row in found.rows]
    notes = [verdict(found), MEANING, *(sentence(one) for one in found.notes), effort(found)]
    tables = [
        text_table("Requirements in time", HEADS, [one.cells for one in lines], " ".join(notes))
    ]
    said = [(one.cells[0], _where(row), _how(row), _why(row))
            for one, row in zip(lines, found.rows, strict=True) if one.said]  # fmt: skip
    if said:
        heads = ("requirement", "case and place", "experiment", "difference, as seen")
        note = (
            "Each share is measured: the experiment without sticking friction, then with a "
            "fiftieth of the swing; what is left is the operating point."
        )
        tables.append(
            text_table("Experiments behind them", heads, said, note, widths=(1, 1.2, 1.5, 3.5))
        )
    return tuple(tables)


def _where(row: VerifiedRequirement) -> str:
    return pretty(row.where) or DASH


def _how(row: VerifiedRequirement) -> str:
    return pretty(row.how) or DASH


def _why(row: VerifiedRequirement) -> str:
    return pretty(row.why) or DASH


def shown_results(found: Sensitivities) -> list[str]:
    """Results of the table: those that parameters move most, in the order of the scenario."""

    def most(name: str) -> float:
        known = [one.effects[name] for one in found.parameters if name in one.effects]
        return max((abs(one.percent or 0.0) for one in known if one.reliable), default=0.0)

    names = [name for name in found.results if most(name) > 0]
    kept = sorted(names, key=most, reverse=True)[:COLUMNS]
    return [name for name in names if name in kept]


def effect(one: Effect | None) -> str:
    """An effect in per cent, with a mark where it is not sure."""
    if one is None or one.percent is None:
        return DASH
    words = "0" if abs(one.percent) < 5e-3 else f"{one.percent:+.2f}".replace("-", text.MINUS)
    return words if one.reliable else f"{words} {UNSURE}"


def head(name: str) -> str:
    """A result in the head of a column."""
    return SHORT.get(name, name.replace("_", " "))


def cells(one: Parameter, results: list[str]) -> tuple[str, ...]:
    """A parameter's line."""
    value = text.value_text(one.quantity, one.value)
    return (one.path, value, one.unit, *(effect(one.effects.get(name)) for name in results))


def sensitivity_notes(found: Sensitivities) -> list[str]:
    """What the numbers mean, and what was left out."""
    notes = [
        "Change of each result in per cent for 1 % more of the parameter, or for the change stated "
        "beside it, largest first; "
        f"central differences of {number(100 * found.step, 2)} %. "
        f"A {UNSURE} marks what half the step does not confirm within 10 %."
    ]
    if found.skipped:
        left = [f"{path} ({why})" for path, why in found.skipped.items()]
        notes.append(f"Left out: {'; '.join(left)}.")
    notes.append(f"{found.runs} runs.")
    return notes


def sensitivity_rows(found: Sensitivities) -> tuple[Table, ...]:
    """The table of a report: parameters ranked by their largest effect."""
    results = shown_results(found)
    if not results:
        return ()
    heads = ("parameter", "value", "for", *(f"{head(name)}, %" for name in results))
    rows = [cells(one, results) for one in found.parameters]
    note = " ".join(sensitivity_notes(found))
    return (text_table("Sensitive parameters", heads, rows, note),)
