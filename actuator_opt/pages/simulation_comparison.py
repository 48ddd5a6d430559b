"""The page of several simulations side by side: their numbers in a table, their common figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..base.errors import Diagnostic, InputError, remedy
from ..base.quantities import RESULTS
from ..rendering.blocks import (
    Block,
    Cell,
    Column,
    Notes,
    Page,
    State,
    Status,
    Table,
    Tile,
    Verdict,
    short,
    tile,
)
from ..rendering.text import DASH, number, pretty, sentence, unit_text, with_unit
from ..simulation.linear import Tuned
from ..simulation.result import Simulation
from .simulation import known, label, remarks, share_words, sound, tied, what
from .simulation_comparison_figures import LEAST, MOST, comparison_figure, kind_of
from .simulation_figures import Measured, Static

MOST_COLUMNS = 9
"""Columns that have room beside the names."""
MOST_TILES = 5


@dataclass(frozen=True, slots=True)
class Comparison:
    """Runs by their names, with the columns of their table."""

    runs: tuple[tuple[str, Simulation], ...]
    title: str
    notes: tuple[str, ...]
    columns: tuple[str, ...]


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
    notes : for the reader
    columns : results and gains of the table, by the names of `COLUMNS`; default: those of this
        kind of run

    Raises
    ------
    InputError
        no run, a name that stands twice, an unknown column
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
    chosen = tuple(columns or _usual([simulation for _, simulation in runs]))
    return Comparison(tuple(runs), title, tuple(notes), chosen[:MOST_COLUMNS])


def page(
    comparison: Comparison,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> Page:
    """The page of several simulations.

    Parameters
    ----------
    comparison : the runs, by `simulation_comparison.comparison`
    measured : time [s] and values (SI) by the name of a signal, drawn under the runs
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic ones
    extra : blocks below all others
    """
    notes = Notes("What this rests on", [tied(words) for words in _trust(comparison)])
    designs = dict.fromkeys(run.plant.design.name for _, run in comparison.runs)
    return Page(
        name=comparison.title,
        kind="Simulations compared",
        design=", ".join(designs),
        verdict=_verdict(comparison),
        sentence=tied(_sentence(comparison, list(designs))),
        tiles=tiles(comparison),
        hero=lambda room: comparison_figure(
            comparison.runs, min(room, MOST), measured=measured, static=static
        ),
        least=LEAST,
        blocks=[run_table(comparison), notes, *extra],
    )


# ---- columns ----


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a run with its unit; None where the run has no such number."""

    head: str
    unit: str
    value: Callable[[Simulation], float | None]

    def text(self, simulation: Simulation) -> str:
        """The number as printed, without its unit."""
        value = self.value(simulation)
        return DASH if value is None else number(value)


def _result(name: str) -> Number:
    quantity = RESULTS[name]

    def value(simulation: Simulation) -> float | None:
        own = known(name, simulation.values.get(name))
        return None if own is None else quantity.to_display(own)

    return Number(label(name), unit_text(quantity.unit), value)


def _of_gains(head: str, unit: str, read: Callable[[Tuned, Simulation], float | None]) -> Number:
    def value(simulation: Simulation) -> float | None:
        own = None if simulation.tuned is None else read(simulation.tuned, simulation)
        return None if own is None or not math.isfinite(own) or own == 0 else own

    return Number(head, unit, value)


def _gain(tuned: Tuned, simulation: Simulation) -> float:
    control = simulation.scenario.control
    return (1.0 if control is None else control.gain_factor) * float(tuned.gains.proportional_gain)


def _phase(tuned: Tuned, _: Simulation) -> float | None:
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
"""Columns that the table may have."""
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


def _usual(simulations: Sequence[Simulation]) -> list[str]:
    """Columns of this kind of run that have a value in any."""
    return [
        name
        for name in _USUAL[kind_of(simulations)]
        if any(COLUMNS[name].value(simulation) is not None for simulation in simulations)
    ]


def _unit(comparison: Comparison, name: str) -> str:
    """Unit of a column; of gains the common unit of all runs, if there is one."""
    if name not in ("gain", "ultimate_gain"):
        return COLUMNS[name].unit
    units = {run.tuned.unit for _, run in comparison.runs if run.tuned is not None}
    return unit_text(units.pop()) if len(units) == 1 else ""


def run_table(comparison: Comparison) -> Table:
    """A row for every run."""
    columns = [Column("run", width=1.0, breaks=14)]
    for k, key in enumerate(comparison.columns):
        unit = _unit(comparison, key)
        first, _, rest = COLUMNS[key].head.rpartition(" ")
        words = f"{first}\n{rest}" if first else rest
        columns.append(Column(f"{words}, {unit}" if unit else words, "right", drop=k))
    body: list[list[Cell]] = []
    for name, run in comparison.runs:
        missed = {requirement.metric for requirement in run.requirements if not requirement.met}
        texts = {key: COLUMNS[key].text(run) for key in comparison.columns}
        body.append(
            [name, *(Status("missed", x) if key in missed else x for key, x in texts.items())]
        )
    limited = any(run.requirements for _, run in comparison.runs)
    note = "A cross marks a result that misses the limit of its own run." if limited else ""
    return Table("Runs", columns, body, note=note)


# ---- words and key figures ----


def _sentence(comparison: Comparison, designs: Sequence[str]) -> str:
    """The number of runs and their designs; the scenario where all have the same."""
    named = " and ".join(designs) if len(designs) < 3 else f"{len(designs)} designs"
    count = "1 run" if len(comparison.runs) == 1 else f"{len(comparison.runs)} runs"
    first = f"{count} of {named}."
    scenarios = {what(run).partition(": ")[2] for _, run in comparison.runs}
    return f"{first} {sentence(scenarios.pop())}" if len(scenarios) == 1 else first


def _verdict(comparison: Comparison) -> Verdict:
    """Numbers of runs that meet their limits, and of runs in doubt."""
    simulations = [run for _, run in comparison.runs]
    limited = [run for run in simulations if run.requirements]
    met = sum(run.met for run in limited)
    lines = [f"{met} of {len(limited)} runs meet their limits" if limited else "no limit stated"]
    doubtful = sum(not sound(run) for run in simulations)
    lines.append(f"{doubtful} runs in doubt" if doubtful else "all balances closed")
    state: State = "checks" if doubtful or met < len(limited) else "met"
    return Verdict(state, "COMPARED", lines)


def tiles(comparison: Comparison) -> list[Tile]:
    """Least and greatest value of the first columns, results before gains."""
    order = sorted(comparison.columns, key=lambda name: name not in RESULTS)
    made: list[Tile] = []
    for name in order:
        values = [(COLUMNS[name].value(run), words) for words, run in comparison.runs]
        finite = [(value, words) for value, words in values if value is not None]
        if len(finite) < 2 or len(made) == MOST_TILES:
            continue
        (low, first), (high, _) = min(finite), max(finite)
        ends = dict.fromkeys((number(low, 3), number(high, 3)))
        span = with_unit("\N{EN DASH}".join(ends), _unit(comparison, name))
        note = f"least: {first}" if len(ends) > 1 else "every run"
        made.append(tile(COLUMNS[name].head, span, short(note, 29)))
    return made


def _trust(comparison: Comparison) -> list[str]:
    """Balances and second integrators of all runs, then every note with its runs."""
    simulations = [run for _, run in comparison.runs]
    mass, energy = (
        share_words(max(getattr(run.balance, name) for run in simulations))
        for name in ("mass", "energy")
    )
    first = f"Balances of all runs: mass within {mass}, energy within {energy}."
    checked = [run.second for run in simulations if run.second is not None]
    if checked:
        most = share_words(max(second.max_difference for second in checked))
        first += (
            f" {len(checked)} of {len(simulations)} runs were integrated again by another"
            f" method: signals differ by {most} of their span at most."
        )
    else:
        first += " No run was compared with a second integrator."
    runs_of: dict[str, list[str]] = {}
    for name, run in comparison.runs:
        for note in remarks(run):
            runs_of.setdefault(note, []).append(name)
    shown = [first, *(sentence(pretty(note)) for note in comparison.notes)]
    for note, names in runs_of.items():
        shown.append(note if len(names) == len(simulations) else f"{'; '.join(names)}: {note}")
    return shown
