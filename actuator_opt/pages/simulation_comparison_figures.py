"""Several simulations in one figure: their steps, their stiffness, or their signals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from ..base.quantities import SCENARIOS
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
from ..rendering.ink import GREY, Ink, text_width
from ..rendering.strips import ASKED, MEASURED, Curve, Strip, stack
from ..rendering.text import value_text
from ..simulation.linear import BAND
from ..simulation.loops import LOOPS
from ..simulation.result import Simulation
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


# ---- steps ----


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


# ---- stiffness ----


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


# ---- signals ----


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
            Curve("", run.time, scaled(signal.quantity, run.signals[name]), style)
            for (_, run), style in zip(runs, styles, strict=True)
        ]
        title = titled(signal.label[:1].upper() + signal.label[1:], signal.quantity)
        shown.append(Strip(title, tuple(curves), rank=rank))
    end = max(float(run.time[-1]) for _, run in runs)
    stack(ink, (left + 11.0, top, width - 13.0, height), shown, (0.0, end))
