"""Several Simulations side by side: what of each stands in a row, and how each is drawn."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ..base.errors import Diagnostic, InputError
from ..base.quantities import RESULTS
from ..base.suggest import remedy
from ..rendering.blocks import Block, Cell, Column, State, Status, Table, Tile, Verdict, soft, tile
from ..rendering.text import DASH, number, pretty, sentence, unit_text, with_unit
from ..simulation.gains import Tuned
from ..simulation.result import Simulation
from . import simulation_rows as rows
from .simulation_axes import COLOURS, DASHES
from .simulation_words import what as whole

MOST_COLUMNS = 9
"""Columns that have room beside the names."""
MOST_TILES = 5


@dataclass(frozen=True, slots=True)
class Comparison:
    """Runs by their names, with what is told of them."""

    runs: tuple[tuple[str, Simulation], ...]
    title: str
    notes: tuple[str, ...]
    columns: tuple[str, ...]

    @property
    def kind(self) -> str:
        """What all runs have: a "step", a "stiffness" of a shaken rod, or "signals" alone."""
        simulations = [one for _, one in self.runs]
        if all(one.shaken is not None and one.shaken.windows for one in simulations):
            return "stiffness"
        if len({None if one.servo is None else one.servo.loop for one in simulations}) == 1:
            return "signals" if simulations[0].servo is None else "step"
        return "signals"


def comparison(
    runs: Sequence[tuple[str, Simulation]],
    title: str,
    notes: Sequence[str] = (),
    columns: Sequence[str] = (),
) -> Comparison:
    """Runs to compare.

    Parameters
    ----------
    runs : name and simulation of each; "50 %, extending" and "50 %, retracting" share a colour
    title : of the page
    notes : what a reader should know
    columns : results and gains that stand in the table, by the names of `COLUMNS`; default: what
        this kind of run has

    Raises
    ------
    InputError
        no run, a name that stands twice, a column that nobody knows
    """
    if not runs:
        raise InputError(Diagnostic("nothing to compare", "give one simulation or more"))
    names = [name for name, _ in runs]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(Diagnostic(f'two runs are named "{twice}"', "name each once"))
    for name in columns:
        if name not in COLUMNS:
            message = f'no column "{name}"'
            raise InputError(Diagnostic(message, remedy(name, COLUMNS)))
    made = Comparison(tuple(runs), title, tuple(notes), tuple(columns))
    chosen = made.columns or tuple(_usual(made))
    return Comparison(made.runs, title, made.notes, chosen[:MOST_COLUMNS])


# ---- columns ----


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a run with its unit; None where it has none."""

    head: str
    unit: str
    value: Callable[[Simulation], float | None]
    least: float = 0.0
    """Below this it reads 0."""

    def text(self, found: Simulation) -> str:
        """The number as printed, without its unit."""
        value = self.value(found)
        if value is None:
            return DASH
        return number(0.0 if abs(value) < self.least else value)


def _result(name: str) -> Number:
    quantity = RESULTS[name]

    def value(found: Simulation) -> float | None:
        own = rows.known(name, found.values.get(name))
        return None if own is None else quantity.to_display(own)

    return Number(rows.label(name), unit_text(quantity.unit), value)


def _of_gains(head: str, unit: str, read: Callable[[Tuned, Simulation], float | None]) -> Number:
    def value(found: Simulation) -> float | None:
        own = None if found.tuned is None else read(found.tuned, found)
        return None if own is None or not math.isfinite(own) or own == 0 else own

    return Number(head, unit, value)


def _gain(tuned: Tuned, found: Simulation) -> float:
    control = found.scenario.control
    return (1.0 if control is None else control.gain_factor) * float(tuned.gains.proportional_gain)


def _phase(tuned: Tuned, found: Simulation) -> float | None:
    phase = tuned.margins.phase
    return None if phase is None else math.degrees(phase)


COLUMNS: dict[str, Number] = {name: _result(name) for name in RESULTS} | {
    "gain": _of_gains("gain K", "", _gain),
    "integral_time": _of_gains(
        "integral time", "ms", lambda tuned, _: 1e3 * float(tuned.gains.integral_time)
    ),
    "derivative_time": _of_gains(
        "derivative time", "ms", lambda tuned, _: 1e3 * float(tuned.gains.derivative_time)
    ),
    "ultimate_gain": _of_gains("ultimate gain", "", lambda tuned, _: tuned.ultimate.gain),
    "ultimate_period": _of_gains(
        "ultimate period", "ms", lambda tuned, _: 1e3 * tuned.ultimate.period
    ),
    "gain_margin": _of_gains("gain margin", "", lambda tuned, _: tuned.margins.gain),
    "phase_margin": _of_gains("phase margin", "°", _phase),
}
"""Everything that may stand in the table."""
_USUAL = {
    "step": (
        "gain", "integral_time", "derivative_time", "gain_margin", "phase_margin", "rise_time",
        "settling_time", "overshoot", "steady_state_ratio",
    ),
    "stiffness": (
        "dynamic_stiffness", "dynamic_phase", "peak_pressure", "lowest_pressure",
    ),
    "signals": tuple(RESULTS),
}  # fmt: skip


def _usual(one: Comparison) -> list[str]:
    """Columns of this kind of run that have a value in any."""
    return [
        name
        for name in _USUAL[one.kind]
        if any(COLUMNS[name].value(found) is not None for _, found in one.runs)
    ]


def unit_of(one: Comparison, name: str) -> str:
    """Unit of a column: that of the gains where all runs have the same."""
    if name not in ("gain", "ultimate_gain"):
        return COLUMNS[name].unit
    units = {found.tuned.unit for _, found in one.runs if found.tuned is not None}
    return unit_text(units.pop()) if len(units) == 1 else ""


def missed(found: Simulation, name: str) -> bool:
    """Whether a limit of the run on this result is missed."""
    return any(row.metric == name and not row.met for row in found.requirements)


def run_table(one: Comparison) -> Block:
    """One row per run."""
    columns = [Column("run", "left", 1.0)]
    for name in one.columns:
        unit = unit_of(one, name)
        first, _, rest = COLUMNS[name].head.rpartition(" ")
        words = f"{first}\n{rest}" if first else rest
        columns.append(Column(f"{words}, {unit}" if unit else words, "right"))
    body: list[list[Cell]] = []
    for name, found in one.runs:
        cells: list[Cell] = [soft(name)]
        for key in one.columns:
            words = COLUMNS[key].text(found)
            state = Status("missed", words)
            cells.append(state if missed(found, key) else words)
        body.append(cells)
    note = ""
    if any(found.requirements for _, found in one.runs):
        note = "A cross marks what misses the limit of its own run."
    return Table("Runs", columns, body, note=note)


# ---- what a page says of them ----


def what(one: Comparison) -> str:
    """How many runs of what."""
    designs = list(dict.fromkeys(found.plant.design.name for _, found in one.runs))
    named = " and ".join(designs) if len(designs) < 3 else f"{len(designs)} designs"
    count = "1 run" if len(one.runs) == 1 else f"{len(one.runs)} runs"
    said = f"{count} of {named}."
    words = {whole(found).partition(": ")[2] for _, found in one.runs}
    return f"{said} {sentence(words.pop())}" if len(words) == 1 else said


def verdict(one: Comparison) -> Verdict:
    """How many runs keep their limits and their balances."""
    simulations = [found for _, found in one.runs]
    stated = [found for found in simulations if found.requirements]
    met = sum(found.met for found in stated)
    lines = [f"{met} of {len(stated)} runs meet their limits" if stated else "no limit stated"]
    doubtful = sum(not rows.sound(found) for found in simulations)
    lines.append(f"{doubtful} runs in doubt" if doubtful else "all balances closed")
    state: State = "checks" if doubtful or met < len(stated) else "met"
    return Verdict(state, "COMPARED", lines)


def tiles(one: Comparison) -> list[Tile]:
    """From least to most of the first columns, the results before the gains."""
    order = sorted(one.columns, key=lambda name: name not in RESULTS)
    made: list[Tile] = []
    for name in order:
        values = [(COLUMNS[name].value(found), run) for run, found in one.runs]
        known = [(value, run) for value, run in values if value is not None]
        if len(known) < 2 or len(made) == MOST_TILES:
            continue
        (low, first), (high, _) = min(known), max(known)
        ends = dict.fromkeys((number(low, 3), number(high, 3)))
        words = "\N{EN DASH}".join(ends)
        note = f"least: {first}" if len(ends) > 1 else "every run"
        made.append(
            tile(
                COLUMNS[name].head,
                with_unit(words, unit_of(one, name)),
                note if len(note) < 30 else f"{note[:28].rstrip()}…",
            )
        )
    return made


def trust(one: Comparison) -> list[str]:
    """Balances and second integrators of all runs, then every note with its runs."""
    simulations = [found for _, found in one.runs]
    mass, energy = (
        rows.share_words(max(getattr(found.balance, name) for found in simulations))
        for name in ("mass", "energy")
    )
    said = [f"Balances of all runs: mass within {mass}, energy within {energy}."]
    checked = [found.second for found in simulations if found.second is not None]
    if checked:
        most = rows.share_words(max(one.max_difference for one in checked))
        said.append(f"{len(checked)} of {len(simulations)} runs were integrated again by another"
                    f" method: signals differ by {most} of their span at most.")  # fmt: skip
    else:
        said.append("No run was compared with a second integrator.")
    by_note: dict[str, list[str]] = {}
    for name, found in one.runs:
        for note in rows.remarks(found):
            by_note.setdefault(note, []).append(name)
    shown = [" ".join(said), *(sentence(pretty(note)) for note in one.notes)]
    for note, names in by_note.items():
        every = len(names) == len(one.runs)
        shown.append(note if every else f"{'; '.join(names)}: {note}")
    return shown


# ---- how each is drawn ----


def styles(names: Sequence[str]) -> list[dict[str, Any]]:
    """Ink of every run: colour by what stands before the last comma, dash by what stands after.

    Where that tells no groups, each has its own colour and dash.

    >>> [one["dash"] for one in styles(["0 %, out", "0 %, in", "50 %, out", "50 %, in"])]
    [[], [1.6, 0.8], [], [1.6, 0.8]]
    """
    split = [name.rpartition(", ") for name in names]
    families = list(dict.fromkeys(head for head, _, _ in split))
    kinds = list(dict.fromkeys(tail for _, _, tail in split))
    grouped = all(head for head, _, _ in split) and 1 < len(families) < len(names)
    if not grouped or len(kinds) > len(DASHES):
        return [_style(k, k) for k in range(len(names))]
    return [_style(families.index(head), kinds.index(tail)) for head, _, tail in split]


def _style(colour: int, dash: int) -> dict[str, Any]:
    return {
        "stroke": COLOURS[colour % len(COLOURS)],
        "pen": 0.32,
        "dash": list(DASHES[dash % len(DASHES)]),
    }
