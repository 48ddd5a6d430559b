"""An Identification as text for the terminal."""

from __future__ import annotations

import numpy as np

from ..identification.result import Identification
from ..identification.stribeck_fit import StribeckFit
from ..rendering import terminal_curve as plot
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..rendering.text import DASH, number
from . import identification_rows as rows

_PAINTS = {"met": "green", "checks": "yellow bold", "missed": "red bold"}
_SIGNS = {"yes": ("✔", "+", "green"), "weakly": ("○", "o", "yellow"), "no": ("✘", "x", "red")}


def identification_text(
    identification: Identification, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `identify` shows: friction, parameters with their verdicts, curve, doubts, notes."""
    console = Console(colour, unicode, width)
    parts = [
        _head(identification, console),
        _friction(identification, console),
        _parameters(identification, console),
        _curve(identification, console),
        _channels(identification, console),
        _said(identification, console),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _head(found: Identification, console: Console) -> str:
    seen = rows.verdict(found)
    name = console.paint(console.say(found.bench.design.name), "bold")
    state = console.paint(console.say(seen.text.lower()), *_PAINTS[seen.state].split())
    lines = [f"{name}  {state}", console.wrap(", ".join(seen.lines), "dim")]
    return "\n".join([*lines, console.wrap(rows.what(found))])


def _friction(found: Identification, console: Console) -> str:
    """Mean, maximum, equivalent pressure and coefficient of friction."""
    columns = [Column("friction", width=1.0), Column("value", "right")]
    columns += [Column("lower", "right", drop=1), Column("upper", "right", drop=1)]
    mean, area, mu = found.mean, found.area, found.coefficient
    low, high = number(mean.lower), number(mean.upper)
    loss = [number(rows.PRESSURE.to_display(x / area), 3) for x in (mean.lower, mean.upper)]
    body = [
        [rows.mean_label(found), rows.force(mean.value), low, high],
        ["maximum", rows.force(found.largest), "", ""],
        ["equivalent pressure loss", rows.pressure(mean.value / area), *loss],
        ["pressure loss at maximum", rows.pressure(found.largest / area), "", ""],
    ]
    if isinstance(mu, str):
        body.append(["friction coefficient", DASH, "", ""])
    else:
        bounds = [number(x, 3) for x in (mu.lower, mu.upper)]
        body.append(["friction coefficient", number(mu.value, 3), *bounds])
    styles = [["", "bold", "dim", "dim"]] * len(body)
    return "\n".join(console.table(columns, body, styles))


def _parameters(found: Identification, console: Console) -> str:
    """Parameters of every model with bounds and verdict."""
    columns = [
        Column("model"),
        Column("parameter", width=1.0),
        Column("symbol", drop=4),
        Column("value", "right"),
        Column("lower", "right", drop=1),
        Column("upper", "right", drop=2),
        Column(""),
        Column("identifiable", drop=3),
    ]
    groups = []
    for label, model in (("Stribeck", found.stribeck), ("LuGre", found.lugre)):
        if not isinstance(model, str):
            groups.append((label, rows.parameter_rows(model.parameters)))
    groups.append(("damping", rows.fit_rows(found.fits)))
    body, styles = [], []
    for label, shown in groups:
        for k, one in enumerate(shown):
            sign, plain, paint = _SIGNS[one.verdict]
            mark = sign if console.unicode else plain
            body.append(
                [label if k == 0 else "", one.label, one.symbol, one.value, one.lower, one.upper,
                 mark, one.verdict]
            )  # fmt: skip
            styles.append(["", "", "dim", "bold", "dim", "dim", paint, paint])
    if not body:
        return ""
    lines = [console.heading("parameters with their 95 % bounds")]
    lines += console.table(columns, body, styles)
    if said := rows.fit_note(found.fits):
        lines.append(console.wrap(said, "dim"))
    return "\n".join(lines)


def _curve(found: Identification, console: Console) -> str:
    """The Stribeck curve the way the rod moved first, over the logarithm of the speed."""
    fit = found.stribeck
    if not isinstance(fit, StribeckFit):
        return ""
    way = 1.0 if any(one.velocity > 0 for one in found.points) else -1.0
    speeds = [one.speed for one in found.points]
    if max(speeds) <= min(speeds):
        return ""
    over = np.geomspace(min(speeds), max(speeds), 120)
    force = way * np.asarray(fit.predict(way * over, np.full(over.shape, fit.reference_pressure)))
    points = [(float(np.log10(v)), float(f)) for v, f in zip(over, force, strict=True)]
    ends = (f"{number(1e3 * over[0], 3)} mm/s", f"{number(1e3 * over[-1], 3)} mm/s")
    lines = plot.curve(points, None, console, min(console.width, 76), 7, ends=ends)
    if not lines:
        return ""
    side = "outwards" if way > 0 else "inwards"
    head = f"Stribeck curve {side}, N over the logarithm of speed"
    return "\n".join([console.heading(head), *lines])


def _channels(found: Identification, console: Console) -> str:
    columns = [
        Column(head, "left" if k == 0 else "right", drop=max(0, k - 3))
        for k, head in enumerate(rows.CHANNEL_HEADS)
    ]
    return "\n".join(console.table(columns, rows.channel_rows(found)))


def _said(found: Identification, console: Console) -> str:
    """What it rests on, doubts first."""
    lines = [console.wrap(words, "yellow") for words in rows.doubts(found)]
    said = [rows.coefficient_words(found.coefficient), rows.conditioning(found)]
    said += [*rows.remarks(found), rows.record_words(found)]
    return "\n".join([*lines, *(console.wrap(words, "dim") for words in said)])
