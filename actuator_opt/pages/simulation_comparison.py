"""The page that compares several simulations: a table of results, and a common figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, remedy
from ..base.numeric import Array
from ..base.quantities import RESULTS, SCENARIOS
from ..rendering.axes import AREAS, SIZE, fitted, names, steady_range
from ..rendering.blocks import (
    Block,
    Cell,
    Chart,
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
from ..rendering.chart import Axis, Curve, Level, Panel
from ..rendering.chart_ink import drawn
from ..rendering.chart_layout import LINES, ROW as KEY_ROW
from ..rendering.ink import Ink, text_width
from ..rendering.text import DASH, number, pretty, sentence, unit_text, value_text, with_unit
from ..simulation.components.circuit import LOOPS
from ..simulation.linear import BAND, Tuned
from ..simulation.result import Servo, Simulation
from .simulation import description, known, label, remarks, share_words, sound, tied
from .simulation_energy import ENERGY
from .simulation_figures import (
    CONSTANT,
    REFERENCE,
    Measured,
    Static,
    Strip,
    along,
    curve,
    overlay,
    scaled,
    stiffness_panels,
    strips_with_room,
    timed,
    titled,
    travelled,
    window,
)

Runs: TypeAlias = Sequence[tuple[str, Simulation]]
"""Runs with their names."""
LEAST, MOST = 70.0, 150.0
"""Least and greatest height of the whole figure [mm]."""
ROW = 3.6
"""Height of a bar of energy [mm]."""
TALLEST = 92.0
"""Greatest height of a curve over the stroke [mm] (our choice: taller curves show no more)."""
WIDTHS = (93.6, 80.4)
"""Widths of the two columns of the figure of step responses [mm]."""
ERROR = 0.1
"""Range of the plot of errors, as a share of the step (our choice: five times the 2 % band)."""
SINKS = ("valve edges", "relief valve", "return line", "load", "friction of the seals",
         "losses of the motor", "leakage across the piston")  # fmt: skip
"""Sinks of energy that have their own colour; all others are shown as "other"."""
SIGNALS = (
    "position", "speed", "shaft_speed", "shaft_angle", "signal", "pressure_a", "pressure_b",
    "flow_a", "flow_b", "friction",
)  # fmt: skip
"""Signals drawn when the runs have neither a step nor a stiffness in common."""
Pen: TypeAlias = tuple[int, int]
"""Numbers of the colour and of the dash pattern of a run's curves."""


def comparison_figure(
    runs: Runs,
    height: float = MOST,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
) -> Ink:
    """One figure with the curves of all runs; its first rows list the names of the runs.

    Parameters
    ----------
    runs : name and simulation of each run, as for `simulation_comparison.comparison`
    height : height of the figure [mm]
    measured, static : see `simulation_comparison.page`
    """
    height = min(max(height, LEAST), MOST)
    pens = styles([name for name, _ in runs])
    kind = kind_of([run for _, run in runs])
    known_signals = measured or {}
    panels: Sequence[Panel | Sequence[Panel | Ink]]
    if kind == "step":
        panels = _steps(runs, pens, known_signals)
    elif kind == "stiffness":
        panels = _stiffness(runs, pens, static)
        height = min(height, TALLEST + KEY_ROW * len(runs))
    else:
        panels = [_signals(runs, pens, known_signals, height)]
    key = [
        Curve(name, (), (), style=style, dash=dash)
        for (name, _), (style, dash) in zip(runs, pens, strict=True)
    ]
    widths = WIDTHS if kind == "step" else ()
    return drawn(Chart("Simulations", panels, widths=widths, key=key), height=height)


def kind_of(simulations: Sequence[Simulation]) -> str:
    """The kind of common figure: "step", "stiffness" (excited rod), or only "signals"."""
    if all(run.shaken is not None and run.shaken.windows for run in simulations):
        return "stiffness"
    loops = {None if run.servo is None else run.servo.loop for run in simulations}
    return "step" if len(loops) == 1 and None not in loops else "signals"


def styles(names: Sequence[str]) -> list[Pen]:
    """Pen (colour, dash) of every run, chosen by its name.

    Words before the last comma of the name determine the colour, words after it the dash.

    If the names form no such groups, every run has a different colour and dash.

    >>> styles(["0 %, out", "0 %, in", "50 %, out", "50 %, in"])
    [(0, 0), (0, 1), (1, 0), (1, 1)]
    """
    split = [name.rpartition(", ") for name in names]
    families = list(dict.fromkeys(head for head, _, _ in split))
    kinds = list(dict.fromkeys(tail for _, _, tail in split))
    grouped = all(head for head, _, _ in split) and 1 < len(families) < len(names)
    count = len(LINES)
    if not grouped or max(len(kinds), len(families)) > count:
        return [(k % count, (k + k // count) % count) for k in range(len(names))]
    return [(families.index(head), kinds.index(tail)) for head, _, tail in split]


def _steps(runs: Runs, pens: Sequence[Pen], measured: Measured) -> list[Sequence[Panel | Ink]]:
    """Step response and its error on the left, valve signal and energies on the right."""
    servos = [run.servo for _, run in runs if run.servo is not None]
    first, servo = runs[0][1], servos[0]
    words, quantity, *_ = LOOPS[servo.loop]
    span = _window(runs)

    def of_runs(values: Callable[[Simulation, Servo], Array]) -> list[Curve]:
        return [
            Curve("", run.time - own.time, values(run, own), style=style, dash=dash)
            for (_, run), own, (style, dash) in zip(runs, servos, pens, strict=True)
        ]

    response = Panel(
        titled(words.capitalize(), quantity),
        curves=[
            *overlay(first, servo.loop, measured, start=servo.time),
            curve(first, "reference", "reference", REFERENCE, start=servo.time),
            *of_runs(lambda run, _: scaled(quantity, run.signals[servo.loop])),
        ],
        share=0.6,
    )
    errors = of_runs(
        lambda run, own: 100 * (own.target - run.signals[own.loop]) / (own.target - own.start)
    )
    least = min([-100 * BAND, *(_least(shown, span) for shown in errors)])
    error = Panel(
        "Error, % of the step",
        y=Axis(range=steady_range([max(least, -400 * ERROR), 100 * ERROR])),
        curves=errors,
        levels=[Level(way * 100 * BAND, "±2 %", style=CONSTANT) for way in (-1, 1)],
        share=0.4,
    )
    volts = SCENARIOS["signal_value"]
    signal = Panel(
        titled("Valve signal", volts),
        curves=of_runs(lambda run, _: scaled(volts, run.signals["signal"])),
    )
    response, error, signal = (
        timed(panel, span, "time after the step") for panel in (response, error, signal)
    )
    right: list[Panel | Ink] = [signal]
    if all(run.balance.flows for _, run in runs):
        right.append(_energies(runs))
    return [[replace(response, x=Axis()), error], right]


def _window(runs: Runs) -> tuple[float, float]:
    """Start and end of the time after the step in which all runs settle [s]."""
    begin, end, shortest = 0.0, 0.0, np.inf
    for _, run in runs:
        assert run.servo is not None
        own = window(run, run.servo)
        begin = min(begin, own[0] - run.servo.time)
        end = max(end, own[1] - run.servo.time)
        shortest = min(shortest, float(run.time[-1]) - run.servo.time)
    return max(begin, -0.06 * end), min(end, shortest)


def _least(shown: Curve, span: tuple[float, float]) -> float:
    """Smallest value of a curve within a time span."""
    time, values = np.asarray(shown.xs), np.asarray(shown.ys)
    inside = values[(time >= span[0]) & (time <= span[1])]
    return float(np.min(inside)) if inside.size else 0.0


def _taken(run: Simulation) -> dict[str, float]:
    """Energy taken by each of `SINKS` [J]; all other sinks and the stored energy are one sum."""
    taken: dict[str, float] = {}
    for flow in run.balance.flows:
        if flow.energy < 0:
            name = flow.name if flow.name in SINKS else "other"
            taken[name] = taken.get(name, 0.0) - flow.energy
    stored = sum(store.energy for store in run.balance.stored)
    if stored > 0:
        taken["other"] = taken.get("other", 0.0) + stored
    return taken


def _energies(runs: Runs) -> Ink:
    """Stacked bars of the dissipated energies, a row for every run.

    The figure is drawn directly, because a `Chart` has no rows with labelled parts and without an
    axis.
    """
    width, top = WIDTHS[1], 11.0
    ink = Ink(width, top + ROW * len(runs) + 1.0)
    taken = [_taken(run) for _, run in runs]
    totals = [sum(energies.values()) for energies in taken]
    most = max(totals) or 1.0
    shown = [name for name in (*SINKS, "other")
             if any(energies.get(name, 0.0) > 0.004 * most for energies in taken)]  # fmt: skip
    ink.text(0.0, 4.0, "Where the energy went", size=6.8, bold=True)
    values = [value_text(ENERGY, total, 3) for total in totals]
    room = min(max(text_width(name, SIZE) for name, _ in runs), 0.36 * width)
    begin = room + 1.5
    end = width - max(text_width(words, SIZE) for words in values) - 1.5
    for k, ((name, _), energies, words) in enumerate(zip(runs, taken, values, strict=True)):
        y = top + ROW * (k + 0.5)
        ink.text(room, y, fitted(name, room, SIZE), size=SIZE, anchor="right")
        x = begin
        for j, part in enumerate(shown):
            size = (end - begin) * energies.get(part, 0.0) / most
            if size > 0.02:
                ink.box(x, y - 1.15, size, 2.3, fill=AREAS[j], stroke=None)
            x += size
        ink.text(width, y, words, size=SIZE, anchor="right")
    entries = [
        (part.split(" ")[0] if part != "return line" else "return",
         {"stroke": AREAS[j], "pen": 1.6})
        for j, part in enumerate(shown)
    ]  # fmt: skip
    names(ink, width, 8.4, entries, width)
    return ink


def _stiffness(runs: Runs, pens: Sequence[Pen], static: Static | None) -> list[Panel]:
    """Magnitude and phase of the dynamic stiffness of all runs, side by side."""
    moved = [travelled(run.shaken.windows, run.plant.stroke)
             for _, run in runs if run.shaken is not None]  # fmt: skip
    over = "stroke" if any(moved) else "time"
    profiles = [
        along(run.shaken, over, *pen)
        for (_, run), pen in zip(runs, pens, strict=True)
        if run.shaken is not None
    ]
    return [*stiffness_panels(profiles, over, static=static)]


def _signals(runs: Runs, pens: Sequence[Pen], measured: Measured, height: float) -> list[Panel]:
    """A panel for every signal that all runs have."""
    first = runs[0][1]
    shared = [name for name in SIGNALS if all(name in run.signals for _, run in runs)]
    span = (0.0, max(float(run.time[-1]) for _, run in runs))
    shown = []
    for rank, name in enumerate(shared):
        signal = first.told[name]
        curves = overlay(first, name, measured)
        curves += [
            replace(curve(run, name, "", style), dash=dash)
            for (_, run), (style, dash) in zip(runs, pens, strict=True)
        ]
        title = titled(signal.label[:1].upper() + signal.label[1:], signal.quantity)
        shown.append(Strip(rank, timed(Panel(title, curves=curves), span)))
    return strips_with_room(shown, height - KEY_ROW * len(runs))


MOST_COLUMNS = 9
"""Largest number of columns of results that fit beside the names of the runs."""
MOST_TILES = 5


@dataclass(frozen=True, slots=True)
class RunComparison:
    """Runs with their names, and the columns of the table that compares them."""

    runs: tuple[tuple[str, Simulation], ...]
    title: str
    notes: tuple[str, ...]
    columns: tuple[str, ...]


def comparison(
    runs: Sequence[tuple[str, Simulation]],
    title: str,
    notes: Sequence[str] = (),
    columns: Sequence[str] = (),
) -> RunComparison:
    """Collect several runs for a page that compares them.

    Parameters
    ----------
    runs : name and simulation of each; "50 %, extending" and "50 %, retracting" share a colour
    title : title of the page
    notes : sentences for the reader
    columns : names from `COLUMNS` of the results and gains in the table; default: the usual columns
        for this kind of run

    Raises
    ------
    InputError
        no run, a repeated name, or an unknown column
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
    return RunComparison(tuple(runs), title, tuple(notes), chosen[:MOST_COLUMNS])


def page(
    comparison: RunComparison,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> Page:
    """The page of several simulations.

    Parameters
    ----------
    comparison : the runs, by `simulation_comparison.comparison`
    measured : time [s] and measured values (SI) by name of the signal, drawn below the runs' curves
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic stiffnesses
    extra : blocks below all others
    """
    notes = Notes("Basis of these results", [tied(words) for words in _trust(comparison)])
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
    """A result or gain of a run with its unit; None if the run lacks it."""

    head: str
    unit: str
    value: Callable[[Simulation], float | None]

    def text(self, simulation: Simulation) -> str:
        """The value as printed, without its unit."""
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
    phase = None if tuned.margins is None else tuned.margins.phase
    return None if phase is None else math.degrees(phase)


COLUMNS: dict[str, Number] = {name: _result(name) for name in RESULTS} | {
    "gain": _of_gains("gain K", "", _gain),
    "integral_time": _of_gains(
        "integral time", "ms", lambda tuned, _: 1e3 * float(tuned.gains.integral_time)
    ),
    "derivative_time": _of_gains(
        "derivative time", "ms", lambda tuned, _: 1e3 * float(tuned.gains.derivative_time)
    ),
    "ultimate_gain": _of_gains(
        "ultimate gain", "", lambda tuned, _: tuned.ultimate.gain if tuned.ultimate else None
    ),
    "ultimate_period": _of_gains(
        "ultimate period",
        "ms",
        lambda tuned, _: 1e3 * tuned.ultimate.period if tuned.ultimate else None,
    ),
    "gain_margin": _of_gains(
        "gain margin", "", lambda tuned, _: tuned.margins.gain if tuned.margins else None
    ),
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
    """The usual columns for this kind of run, without columns that have no value in any run."""
    return [
        name
        for name in _USUAL[kind_of(simulations)]
        if any(COLUMNS[name].value(simulation) is not None for simulation in simulations)
    ]


def _unit(comparison: RunComparison, name: str) -> str:
    """Unit of a column; for gains, the unit that all runs share, if there is one."""
    if name not in ("gain", "ultimate_gain"):
        return COLUMNS[name].unit
    units = {run.tuned.unit for _, run in comparison.runs if run.tuned is not None}
    return unit_text(units.pop()) if len(units) == 1 else ""


def run_table(comparison: RunComparison) -> Table:
    """A row for every run."""
    columns = [Column("run", width=1.0, breaks=14)]
    for k, key in enumerate(comparison.columns):
        unit = _unit(comparison, key)
        first, _, last = COLUMNS[key].head.rpartition(" ")
        words = f"{first}\n{last}" if first else last
        columns.append(Column(f"{words}, {unit}" if unit else words, "right", drop=k))
    body: list[list[Cell]] = []
    for name, run in comparison.runs:
        missed = {requirement.metric for requirement in run.requirements if not requirement.met}
        texts = {key: COLUMNS[key].text(run) for key in comparison.columns}
        body.append(
            [name, *(Status("missed", x) if key in missed else x for key, x in texts.items())]
        )
    limited = any(run.requirements for _, run in comparison.runs)
    note = "A cross marks a result that misses the limit stated for its run." if limited else ""
    return Table("Runs", columns, body, note=note)


# ---- words and key figures ----


def _sentence(comparison: RunComparison, designs: Sequence[str]) -> str:
    """Sentence on the number of runs, their designs, and their scenario if all have the same."""
    named = " and ".join(designs) if len(designs) < 3 else f"{len(designs)} designs"
    count = "1 run" if len(comparison.runs) == 1 else f"{len(comparison.runs)} runs"
    first = f"{count} of {named}."
    scenarios = {description(run).partition(": ")[2] for _, run in comparison.runs}
    return f"{first} {sentence(scenarios.pop())}" if len(scenarios) == 1 else first


def _verdict(comparison: RunComparison) -> Verdict:
    """Badge with the number of runs that meet their limits, and of runs with doubts."""
    simulations = [run for _, run in comparison.runs]
    limited = [run for run in simulations if run.requirements]
    met = sum(run.met for run in limited)
    lines = [f"{met} of {len(limited)} runs meet their limits" if limited else "no limit stated"]
    doubtful = sum(not sound(run) for run in simulations)
    lines.append(f"{doubtful} runs in doubt" if doubtful else "all balances closed")
    state: State = "checks" if doubtful or met < len(limited) else "met"
    return Verdict(state, "COMPARED", lines)


def tiles(comparison: RunComparison) -> list[Tile]:
    """Key figures: least and greatest value of the first columns, results before gains."""
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


def _trust(comparison: RunComparison) -> list[str]:
    """Sentences on balances and second integrators of all runs, then every note with its runs."""
    simulations = [run for _, run in comparison.runs]
    mass, energy = (
        share_words(max(getattr(run.balance, name) for run in simulations))
        for name in ("mass", "energy")
    )
    first = f"Largest errors of the balances of all runs: mass {mass}, energy {energy}."
    checked = [run.second for run in simulations if run.second is not None]
    if checked:
        most = share_words(max(second.max_difference for second in checked))
        first += (
            f" {len(checked)} of {len(simulations)} runs were integrated again by another method; "
            f"signals differ by at most {most} of their range."
        )
    else:
        first += " No run was compared with a second integrator."
    runs_of: dict[str, list[str]] = {}
    for name, run in comparison.runs:
        for note in remarks(run):
            runs_of.setdefault(note, []).append(name)
    shown = [first, *(sentence(pretty(note)) for note in comparison.notes)]
    for note, labels in runs_of.items():
        shown.append(note if len(labels) == len(simulations) else f"{'; '.join(labels)}: {note}")
    return shown
