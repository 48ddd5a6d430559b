"""The page of several simulations side by side: their numbers in a table, their common figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ..base.errors import Diagnostic, InputError, remedy
from ..base.quantities import RESULTS, SCENARIOS
from ..rendering.axes import (
    AREAS,
    COLOURS,
    DASHES,
    SIZE,
    ZERO,
    Axes,
    Box,
    even_ticks,
    fitted,
    lines,
    names,
    steady_range,
    time_axis,
)
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
from ..rendering.ink import GREY, Ink, text_width
from ..rendering.strips import ASKED, MEASURED, Strip, StripCurve, stack
from ..rendering.text import DASH, number, pretty, sentence, unit_text, value_text, with_unit
from ..simulation.components.circuit import LOOPS
from ..simulation.linear import BAND, Tuned
from ..simulation.result import Simulation
from .simulation import known, label, remarks, share_words, sound, tied, what
from .simulation_energy import ENERGY
from .simulation_figures import (
    Measured,
    Static,
    along,
    overlay,
    scaled,
    stiffness_panels,
    titled,
    travelled,
    window,
)

Runs: TypeAlias = Sequence[tuple[str, Simulation]]
"""Runs with their names."""


WIDTH = 180.0


LEAST, MOST = 70.0, 150.0
"""Heights of the whole figure [mm]."""


ROW = 3.6
"""Height of a row of names, and of a bar of energy [mm]."""


TALLEST = 92.0
"""Height beyond which a curve over the stroke shows no more [mm] (a choice)."""


ERROR = 0.1
"""Errors that are shown enlarged, share of the step (a choice: five bands)."""


DOORS = ("valve edges", "relief valve", "return line", "load", "friction of the seals",
         "losses of the motor", "leakage across the piston")  # fmt: skip
"""Sinks of energy with a colour of their own; all others are "other"."""


SIGNALS = (
    "position", "speed", "shaft_speed", "shaft_angle", "signal", "pressure_a", "pressure_b",
    "flow_a", "flow_b", "friction",
)  # fmt: skip
"""Signals of the figure of runs without a common step or stiffness."""


def comparison_figure(
    runs: Runs,
    height: float = MOST,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
) -> Ink:
    """All runs in the same figure, their names in its first rows.

    Parameters
    ----------
    runs : with their names, as `simulation_comparison.comparison`
    height : of the figure [mm]
    measured, static : as `simulation_comparison.page`
    """
    height = min(max(height, LEAST), MOST)
    pens = styles([name for name, _ in runs])
    ink = Ink(WIDTH, height)
    top = _names(ink, runs, pens) + 2.0
    kind = kind_of([run for _, run in runs])
    if kind == "stiffness":
        height = min(height, top + TALLEST)
        ink.height = height
    box = (0.0, top, WIDTH, height - top)
    if kind == "step":
        _steps(ink, box, runs, pens, measured or {})
    elif kind == "stiffness":
        _stiffness(ink, box, runs, pens, static)
    else:
        _signals(ink, box, runs, pens, measured or {})
    return ink


def kind_of(simulations: Sequence[Simulation]) -> str:
    """The common figure of runs: "step", "stiffness" of a shaken rod, or "signals" alone."""
    if all(run.shaken is not None and run.shaken.windows for run in simulations):
        return "stiffness"
    loops = {None if run.servo is None else run.servo.loop for run in simulations}
    return "step" if len(loops) == 1 and None not in loops else "signals"


def styles(names: Sequence[str]) -> list[dict[str, Any]]:
    """Ink of every run: the words before the last comma choose the colour, those after it the dash.

    Where the names form no such groups, every run has its own colour and dash.

    >>> [pen["dash"] for pen in styles(["0 %, out", "0 %, in", "50 %, out", "50 %, in"])]
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


def _names(ink: Ink, runs: Runs, styles: Sequence[dict[str, Any]]) -> float:
    """Names of the runs in columns; the height they take."""
    longest = max(text_width(name, 6.5) for name, _ in runs) + 11.0
    columns = max(1, min(len(runs), int(WIDTH / min(longest, WIDTH / 2))))
    wide = WIDTH / columns
    for k, ((name, _), style) in enumerate(zip(runs, styles, strict=True)):
        x, y = wide * (k % columns), ROW * (k // columns) + 1.8
        ink.line((x, y), (x + 7.0, y), **style | {"pen": 0.45})
        ink.text(x + 8.2, y, fitted(name, wide - 10.0, 6.5), size=6.5)
    return ROW * -(-len(runs) // columns)


def _steps(
    ink: Ink,
    box: Box,
    runs: Runs,
    styles: Sequence[dict[str, Any]],
    measured: Measured,
) -> None:
    """Response and its error at the left, signal and energies at the right."""
    left, top, width, height = box
    across = _window(runs)
    half = 0.52 * width
    energies = all(run.balance.flows for _, run in runs)
    used = 12.5 + ROW * len(runs) if energies else 0.0
    upper = 0.6 * height
    _response(ink, (left, top, half, upper), runs, styles, across, measured)
    _error(ink, (left, top + upper, half, height - upper), runs, styles, across)
    right = (left + half + 6.0, top, width - half - 6.0, height - used - 3.0 * energies)
    _signal(ink, right, runs, styles, across)
    if energies:
        _energies(ink, (right[0], top + height - used, right[2], used), runs)


def _window(runs: Runs) -> tuple[float, float]:
    """Times after the step that show how all runs settle [s]."""
    begin, end, shortest = 0.0, 0.0, np.inf
    for _, run in runs:
        assert run.servo is not None
        own = window(run, run.servo)
        begin = min(begin, own[0] - run.servo.time)
        end = max(end, own[1] - run.servo.time)
        shortest = min(shortest, float(run.time[-1]) - run.servo.time)
    return max(begin, -0.06 * end), min(end, shortest)


def _frame(
    ink: Ink, box: Box, title: str, across: tuple[float, float], ends: Sequence[float]
) -> Axes:
    left, top, width, height = box
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.5)
    axes = Axes(ink, frame, across, steady_range(ends))
    axes.frame_at("", "", [], even_ticks(*axes.y_range, 5 if height > 40 else 3))
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    low, high = axes.y_range
    if low < 0 < high:
        ink.line((frame[0], axes.y(0.0)), (frame[0] + frame[2], axes.y(0.0)), **ZERO)
    return axes


def _ends(across: tuple[float, float], curves: Sequence[tuple[Any, Any]]) -> list[float]:
    ends: list[float] = []
    for time, values in curves:
        inside = values[(time >= across[0]) & (time <= across[1])]
        if inside.size:
            ends += [float(np.min(inside)), float(np.max(inside))]
    return ends


def _response(
    ink: Ink,
    box: Box,
    runs: Runs,
    styles: Sequence[dict[str, Any]],
    across: tuple[float, float],
    measured: Measured,
) -> None:
    first = runs[0][1]
    assert first.servo is not None
    words, quantity, *_ = LOOPS[first.servo.loop]
    curves = []
    for _, run in runs:
        assert run.servo is not None
        own = scaled(quantity, run.signals[first.servo.loop])
        curves.append((run.time - run.servo.time, own))
    target = quantity.to_display(first.servo.target)
    title = titled(words.capitalize(), quantity)
    axes = _frame(ink, box, title, across, [*_ends(across, curves), target])
    entries: list[tuple[str, dict[str, Any]]] = []
    for under in overlay(first, first.servo.loop, measured):
        ink.path(lines(axes, under.time - first.servo.time, under.values), **MEASURED)
        entries.append(("measured", MEASURED))
    asked = scaled(quantity, first.signals["reference"])
    ink.path(lines(axes, first.time - first.servo.time, asked), **ASKED)
    entries.append(("asked", ASKED))
    for (time, values), style in zip(curves, styles, strict=True):
        ink.path(lines(axes, time, values), **style)
    room = box[2] - text_width(title, 7.0, bold=True) - 2.0
    names(ink, box[0] + box[2] - 1.0, box[1] + 2.0, entries, room)
    time_axis(axes, "time after the step")


def _error(
    ink: Ink,
    box: Box,
    runs: Runs,
    styles: Sequence[dict[str, Any]],
    across: tuple[float, float],
) -> None:
    """The error over the step, enlarged about zero, with the band."""
    curves = []
    for _, run in runs:
        servo = run.servo
        assert servo is not None
        done = (servo.target - run.signals[servo.loop]) / (servo.target - servo.start)
        curves.append((run.time - servo.time, 100 * done))
    ends = _ends(across, curves)
    largest = 100 * ERROR
    low = max(min([*ends, -100 * BAND]), -4 * largest)
    axes = _frame(ink, box, "Error, % of the step", across, [low, largest])
    for way in (-1, 1):
        y = axes.y(way * 100 * BAND)
        right = axes.left + axes.width
        ink.line((axes.left, y), (right, y), stroke=GREY, pen=0.15, dash=(0.9, 0.6))
    for (time, values), style in zip(curves, styles, strict=True):
        ink.path(lines(axes, time, values), **style)
    band = [("±2 %", {"stroke": GREY, "pen": 0.15, "dash": (0.9, 0.6)})]
    names(ink, box[0] + box[2] - 1.0, box[1] + 2.0, band, box[2] / 2)
    time_axis(axes, "time after the step")


def _signal(
    ink: Ink,
    box: Box,
    runs: Runs,
    styles: Sequence[dict[str, Any]],
    across: tuple[float, float],
) -> None:
    volts = SCENARIOS["signal_value"]
    curves = []
    for _, run in runs:
        assert run.servo is not None
        own = scaled(volts, run.signals["signal"])
        curves.append((run.time - run.servo.time, own))
    axes = _frame(ink, box, titled("Valve signal", volts), across, _ends(across, curves))
    for (time, values), style in zip(curves, styles, strict=True):
        ink.path(lines(axes, time, values), **style)
    time_axis(axes, "time after the step")


def _taken(run: Simulation) -> dict[str, float]:
    """Energy that each of `DOORS` took [J]; all others summed."""
    taken: dict[str, float] = {}
    for flow in run.balance.flows:
        if flow.energy < 0:
            name = flow.name if flow.name in DOORS else "other"
            taken[name] = taken.get(name, 0.0) - flow.energy
    kept = sum(store.energy for store in run.balance.stored)
    if kept > 0:
        taken["other"] = taken.get("other", 0.0) + kept
    return taken


def _energies(ink: Ink, box: Box, runs: Runs) -> None:
    """Bars of the sinks of energy, a row for every run."""
    left, top, width, _ = box
    taken = [_taken(run) for _, run in runs]
    totals = [sum(each.values()) for each in taken]
    most = max(totals) or 1.0
    shown = [name for name in (*DOORS, "other")
             if any(each.get(name, 0.0) > 0.004 * most for each in taken)]  # fmt: skip
    ink.text(left, top + 2.0, "Where the energy went", size=7.0, bold=True)
    said = [value_text(ENERGY, total, 3) for total in totals]
    wide = max(text_width(words, SIZE) for words in said) + 1.5
    room = min(max(text_width(name, SIZE) for name, _ in runs), 0.36 * width)
    begin, end = left + room + 1.5, left + width - wide
    for k, ((name, _), each, words) in enumerate(zip(runs, taken, said, strict=True)):
        y = top + 9.0 + ROW * (k + 0.5)
        ink.text(left + room, y, fitted(name, room, SIZE), size=SIZE, anchor="right")
        x = begin
        for j, part in enumerate(shown):
            size = (end - begin) * each.get(part, 0.0) / most
            if size > 0.02:
                ink.box(x, y - 1.15, size, 2.3, fill=AREAS[j], stroke=None)
            x += size
        ink.text(left + width, y, words, size=SIZE, anchor="right")
    entries = [
        (part.split(" ")[0] if part != "return line" else "return",
         {"stroke": AREAS[j], "pen": 1.6})
        for j, part in enumerate(shown)
    ]  # fmt: skip
    names(ink, left + width, top + 6.2, entries, width)


def _stiffness(
    ink: Ink,
    box: Box,
    runs: Runs,
    styles: Sequence[dict[str, Any]],
    static: Static | None,
) -> None:
    """Size and phase of all runs side by side."""
    left, top, width, height = box
    moved = [travelled(run.shaken.windows, run.plant.stroke)
             for _, run in runs if run.shaken is not None]  # fmt: skip
    over = "stroke" if any(moved) else "time"
    drawn = [
        along("", run.shaken, over, style)
        for (_, run), style in zip(runs, styles, strict=True)
        if run.shaken is not None
    ]
    half = (width - 6.0) / 2
    boxes = ((left, top, half, height), (left + half + 6.0, top, half, height))
    stiffness_panels(ink, boxes, drawn, over, static=static)


def _signals(
    ink: Ink,
    box: Box,
    runs: Runs,
    styles: Sequence[dict[str, Any]],
    measured: Measured,
) -> None:
    """A strip for every signal that all runs have."""
    left, top, width, height = box
    first = runs[0][1]
    shared = [name for name in SIGNALS if all(name in run.signals for _, run in runs)]
    shown = []
    for rank, name in enumerate(shared):
        signal = first.told[name]
        curves = overlay(first, name, measured)
        curves += [
            StripCurve("", run.time, scaled(signal.quantity, run.signals[name]), style)
            for (_, run), style in zip(runs, styles, strict=True)
        ]
        title = titled(signal.label[:1].upper() + signal.label[1:], signal.quantity)
        shown.append(Strip(title, tuple(curves), rank=rank))
    end = max(float(run.time[-1]) for _, run in runs)
    stack(ink, (left + 11.0, top, width - 13.0, height), shown, (0.0, end))


MOST_COLUMNS = 9
"""Columns that have room beside the names."""
MOST_TILES = 5


@dataclass(frozen=True, slots=True)
class RunComparison:
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
) -> RunComparison:
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


def _unit(comparison: RunComparison, name: str) -> str:
    """Unit of a column; of gains the common unit of all runs, if there is one."""
    if name not in ("gain", "ultimate_gain"):
        return COLUMNS[name].unit
    units = {run.tuned.unit for _, run in comparison.runs if run.tuned is not None}
    return unit_text(units.pop()) if len(units) == 1 else ""


def run_table(comparison: RunComparison) -> Table:
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


def _sentence(comparison: RunComparison, designs: Sequence[str]) -> str:
    """The number of runs and their designs; the scenario where all have the same."""
    named = " and ".join(designs) if len(designs) < 3 else f"{len(designs)} designs"
    count = "1 run" if len(comparison.runs) == 1 else f"{len(comparison.runs)} runs"
    first = f"{count} of {named}."
    scenarios = {what(run).partition(": ")[2] for _, run in comparison.runs}
    return f"{first} {sentence(scenarios.pop())}" if len(scenarios) == 1 else first


def _verdict(comparison: RunComparison) -> Verdict:
    """Numbers of runs that meet their limits, and of runs in doubt."""
    simulations = [run for _, run in comparison.runs]
    limited = [run for run in simulations if run.requirements]
    met = sum(run.met for run in limited)
    lines = [f"{met} of {len(limited)} runs meet their limits" if limited else "no limit stated"]
    doubtful = sum(not sound(run) for run in simulations)
    lines.append(f"{doubtful} runs in doubt" if doubtful else "all balances closed")
    state: State = "checks" if doubtful or met < len(limited) else "met"
    return Verdict(state, "COMPARED", lines)


def tiles(comparison: RunComparison) -> list[Tile]:
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


def _trust(comparison: RunComparison) -> list[str]:
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
    for note, labels in runs_of.items():
        shown.append(note if len(labels) == len(simulations) else f"{'; '.join(labels)}: {note}")
    return shown
