"""A Simulation, or several, as text for the terminal."""

from __future__ import annotations

import numpy as np

from ..rendering import terminal_curve as plot
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..rendering.text import number, unit_text
from ..simulation.loops import LOOPS
from ..simulation.result import Simulation
from . import simulation_rows as rows
from .simulation_energy import table_rows
from .simulation_step import window
from .simulation_words import what

_PAINTS = {"met": "green", "checks": "yellow bold", "missed": "red bold"}
_MARKS = {"met": ("✔", "ok"), "no_reserve": ("!", "!"), "missed": ("✘", "MISSED")}
POINTS = 240
"""Points of the curve of a step."""


def simulation_text(
    simulation: Simulation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `simulate` shows: verdict, controller, results, the step, energies, trust."""
    console = Console(colour, unicode, width)
    parts = [
        _head(simulation, console),
        _controller(simulation, console),
        _results(simulation, console),
        _step(simulation, console),
        _energies(simulation, console),
        _trust(simulation, console),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _head(found: Simulation, console: Console) -> str:
    seen = rows.verdict(found)
    name = console.paint(console.say(found.scenario.name), "bold")
    state = console.paint(console.say(seen.text.lower()), *_PAINTS[seen.state].split())
    lines = [f"{name}  {state}", console.wrap(seen.lines[0], "dim")]
    missed = [rows.label(row.metric) for row in found.requirements if not row.met]
    if missed:
        lines.append(console.wrap("missed: " + ", ".join(dict.fromkeys(missed)), "red"))
    return "\n".join([*lines, console.wrap(what(found))])


def _controller(found: Simulation, console: Console) -> str:
    """Law, gains, origin and margins in one paragraph."""
    shown = rows.controller(found)
    if not shown:
        return ""
    said = "; ".join(f"{words} {value}" for words, value in shown[1:])
    return console.wrap(f"controller {shown[0][1]}: {said}")


def _results(found: Simulation, console: Console) -> str:
    """Every result with its limit and margin, then what has no value."""
    shown = rows.results(found)
    columns = [
        Column("result", width=1.0),
        Column("value", "right"),
        Column("unit"),
        Column("limit", "right", drop=2),
        Column("margin", "right", drop=1),
        Column("", drop=3),
        Column(""),
        Column("what", width=1.0, drop=4, least=30),
    ]
    half = 5 if console.width >= 110 else 3
    body, styles, before = [], [], ""
    for one in shown:
        first = one.name != before
        before = one.name
        margin = None if one.row is None else one.row.margin
        quantity = one.quantity
        value = None if one.value is None else quantity.to_display(one.value)
        mark = _MARKS[one.state][0 if console.unicode else 1] if one.state else ""
        body.append(
            [
                one.name if first else "",
                number(value) if first else "",
                unit_text(quantity.unit) if first else "",
                one.limit,
                one.margin,
                console.margin_bar(margin, half),
                mark,
                quantity.label if first else "",
            ]
        )
        paint = {"met": "green", "no_reserve": "yellow", "missed": "red"}.get(one.state, "")
        styles.append(["", "bold", "dim", "", paint, paint, paint, "dim"])
    lines = console.table(columns, body, styles) if body else []
    for key in rows.bench(found):
        words = f"{key.label} {key.value} {key.unit}, {key.note}"
        lines.append(console.wrap(words))
    for why, names in rows.reasons(found).items():
        lines.append(console.wrap(f"no {', no '.join(names)}: {why}", "dim"))
    return "\n".join(lines)


def _step(found: Simulation, console: Console) -> str:
    """The step in per cent of itself, with a line at 100 %."""
    servo = found.servo
    if servo is None:
        return ""
    begin, end = servo.time, window(found, servo)[1]
    time, at = np.unique(found.time[::-1], return_index=True)
    values = found.signals[servo.loop][::-1][at]
    over = np.linspace(begin, end, POINTS)
    done = 100 * (np.interp(over, time, values) - servo.start) / (servo.target - servo.start)
    points = [(float(t), max(float(y), 0.0)) for t, y in zip(over, done, strict=True)]
    ends = ("0", rows.duration(end - begin))
    lines = plot.curve(points, 100.0, console, min(console.width, 76), 11, ends=ends)
    if not lines:
        return ""
    words = LOOPS[servo.loop].words
    head = f"step of the {words} at {number(servo.time, 3)} s, % of the step over time after it"
    return "\n".join([console.heading(head), *lines])


def _energies(found: Simulation, console: Console) -> str:
    """What gave and took energy."""
    shown = table_rows(found)
    if not shown:
        return ""
    columns = [
        Column("energy of the run", width=1.0),
        Column("in (+), out (-)" if not console.unicode else "in (+), out (−)", "right"),
        Column("share", "right"),
    ]
    return "\n".join(console.table(columns, shown, [["", "bold", "dim"]] * len(shown)))


def _trust(found: Simulation, console: Console) -> str:
    """Balances, the second integrator, events, and notes."""
    lines = [console.wrap(rows.balance_words(found), "" if rows.sound(found) else "yellow")]
    lines.append(console.wrap(rows.second_words(found)))
    said = f"{rows.event_words(found)} {rows.run_words(found)}"
    if found.seconds:
        said += f" {number(found.seconds, 2)} s of computing."
    lines.append(console.wrap(said, "dim"))
    return "\n".join([*lines, *(console.wrap(note, "yellow") for note in rows.remarks(found))])
