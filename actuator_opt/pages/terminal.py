"""Results as text for the terminal. Pure functions: they return text and print nothing.

Every function takes `colour`, `unicode` and `width`; without `unicode` the text is plain ASCII.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

from ..evaluation.result import Evaluation, Requirement, StrokeCurve
from ..optimisation.result import Optimisation
from ..rendering import terminal_curve as plot, text
from ..rendering.blocks import Column
from ..rendering.console import Console, Style
from ..rendering.text import DASH, brief
from . import (
    choices_table,
    infeasibility_card,
    optimum,
    page,
    prices,
    stiffness_page,
    tables,
    trust,
    whole_plies,
)

_STATE_STYLE = {
    "met": "green",
    "no_reserve": "yellow",
    "missed": "red bold",
    "checks": "yellow bold",
    "not_checked": "dim",
    "infeasible": "red bold",
}
_MARKS = {
    "met": "✔",
    "no_reserve": "!",
    "checks": "!",
    "missed": "✘",
    "not_checked": "○",
    "infeasible": "✘",
}
_PLAIN_MARKS = {
    "met": "ok",
    "no_reserve": "!",
    "checks": "!",
    "missed": "MISSED",
    "not_checked": "-",
    "infeasible": "INFEASIBLE",
}


def _mark(console: Console, state: str) -> str:
    return (_MARKS if console.unicode else _PLAIN_MARKS)[state]


def verdict(
    subject: Evaluation | Optimisation,
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """Name and verdict, how many requirements and checks stand behind it, what to doubt."""
    console = Console(colour, unicode, width)
    evaluation, optimisation = page.parts_of(subject)
    found = page.verdict(subject)
    state = found.state
    mark = f"{_mark(console, state)} " if unicode else ""
    lines = [
        console.paint(console.say(evaluation.name), "bold")
        + "  "
        + console.paint(mark + found.text.lower(), *_STATE_STYLE[state].split())
    ]
    lines.append(console.wrap("; ".join(found.lines), "dim"))
    if found.cautions:
        names = ", ".join(evaluation.extrapolated)
        lines.append(
            console.wrap("; ".join(found.cautions) + (f" ({names})" if names else ""), "yellow")
        )
    missed = [row.name for row in evaluation.requirements if not row.met]
    if missed:
        lines.append(console.wrap("missed: " + ", ".join(missed), "red"))
    if optimisation is not None:
        lines += [console.wrap(part) for part in page.sentences(optimisation)]
    paint = "yellow" if state == "checks" else ""
    lines += [console.wrap(part, paint) for part in page.reserve_sentences(subject)]
    return "\n".join(lines)


def evaluation_table(
    evaluation: Evaluation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Every computed quantity: value, unit, limit, margin bar, governing case.

    Beside a limit stands the value that the margin is of.
    """
    console = Console(colour, unicode, width)
    columns = [
        Column("quantity"),
        Column("value", "right"),
        Column("unit"),
        Column("limit", "right"),
        Column("margin", "right"),
        Column("", drop=2),
        Column("case", width=1.0, drop=1),
        Column("what", width=1.0, drop=3, least=45),
    ]
    limits: dict[str, list[Requirement]] = {}
    for required in evaluation.requirements:
        limits.setdefault(required.metric, []).append(required)
    rows, styles, half = [], [], 5 if width >= 110 else 3
    missing: dict[str, list[str]] = {}
    for metric in evaluation.metrics.values():
        quantity = metric.quantity
        if metric.value is None:
            missing.setdefault(metric.why or "not computed", []).append(metric.name)
            continue
        entries: Sequence[Requirement | None] = limits.get(metric.name) or [None]
        for index, row in enumerate(entries):
            case = brief(metric.case, metric.place)
            flag = "" if metric.in_range else tables.FLAG
            limit = "" if row is None else text.limit_text(quantity, row.sense, row.limit)
            margin = None if row is None else row.margin
            met = row is None or row.met
            value = metric.value if row is None else row.value
            rows.append(
                [
                    metric.name + flag if index == 0 else "",
                    DASH if value is None else text.number(quantity.to_display(value)),
                    text.unit_text(quantity.unit),
                    limit,
                    text.margin_of(quantity, row.limit, margin, met=met) if row else "",
                    console.margin_bar(margin, half),
                    case if row is None else brief(row.case, row.place) or case,
                    quantity.label if index == 0 else "",
                ]
            )
            paint = "" if row is None else _STATE_STYLE[row.state]
            styles.append(["", "bold", "dim", "", paint, paint, "dim", "dim"])
    lines = console.table(columns, rows, styles)
    if any(not metric.in_range for metric in evaluation.metrics.values()):
        lines.append(console.paint(tables.FLAGGED, "yellow"))
    if missing:
        lines += ["", console.paint("not computed", "dim")]
        for why, names in missing.items():
            wrapped = Console(colour, unicode, width - 4).wrap(f"{', '.join(names)}: {why}")
            lines.append("  " + wrapped.replace("\n", "\n    "))
    return "\n".join(lines)


def requirements_table(
    evaluation: Evaluation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Requirements: limit, result, margin with its bar, governing case and place."""
    console = Console(colour, unicode, width)
    if not evaluation.requirements:
        return console.paint("no requirements", "dim")
    columns = [
        Column(""),
        Column("requirement", width=1.0),
        Column("limit", "right"),
        Column("result", "right"),
        Column("margin", "right"),
        Column("", drop=1),
        Column("governing case", width=1.0, drop=2),
    ]
    rows, styles, half = [], [], 5 if width >= 110 else 3
    for row in evaluation.requirements:
        quantity = text.metric(row.metric)
        metric = evaluation.metrics.get(row.metric)
        why = metric.why if metric is not None and row.value is None else None
        rows.append(
            [
                _mark(console, row.state),
                row.name + tables.flag(evaluation, row.metric),
                text.limit_text(quantity, row.sense, row.limit),
                why or text.value_text(quantity, row.value),
                text.margin_of(quantity, row.limit, row.margin, met=row.met),
                console.margin_bar(row.margin, half),
                brief(row.case, row.place),
            ]
        )
        paint = _STATE_STYLE[row.state]
        styles.append([paint, "" if row.met else "bold", "", "bold", paint, paint, "dim"])
    lines = console.table(columns, rows, styles)
    lines += [console.paint(line, "yellow") for line in tables.row_notes(evaluation)]
    return "\n".join(lines)


def checks_table(
    evaluation: Evaluation,
    *,
    all_rows: bool = False,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """The check list: lines missed, without reserve and unchecked, or all; how many are met."""
    console = Console(colour, unicode, width)
    order = {"missed": 0, "no_reserve": 1, "not_checked": 2, "met": 3}
    shown = [row for row in evaluation.checks if all_rows or row.state != "met"]
    shown.sort(key=lambda row: order[row.state])
    met = sum(row.status == "met" for row in evaluation.checks)
    title = f"checks: {met} of {len(evaluation.checks)} met"
    columns = [
        Column(""),
        Column("check", width=1.0),
        Column("limit", "right"),
        Column("result", "right"),
        Column("why", width=1.0),
    ]
    rows, styles = [], []
    for row in shown:
        quantity = text.metric(row.metric or "")
        why = row.reason or row.source
        if row.state == "no_reserve":
            why = f"met without reserve: {why}"
        rows.append(
            [
                _mark(console, row.state),
                row.name + tables.flag(evaluation, row.metric),
                text.limit_text(quantity, row.sense, row.limit),
                DASH if row.value is None else text.value_text(quantity, row.value),
                why,
            ]
        )
        paint = _STATE_STYLE[row.state]
        styles.append([paint, "", "", "bold" if row.status == "missed" else "", "dim"])
    lines = [console.paint(title, "bold")]
    return "\n".join(lines + (console.table(columns, rows, styles) if rows else []))


def variables_table(
    optimisation: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Free dimensions: bounds, start, best value, and where between its bounds each one is."""
    console = Console(colour, unicode, width)
    columns = [
        Column("variable", width=1.0),
        Column("lower", "right"),
        Column("start", "right", drop=2),
        Column(optimum.heading(optimisation), "right"),
        Column("upper", "right"),
        Column("unit"),
        Column("", drop=1),
        Column(""),
    ]
    rows, styles = [], []
    for row in optimisation.best_variables:
        quantity = text.input_quantity(row.quantity)
        rows.append(
            [
                row.path,
                text.trimmed(quantity.to_display(row.lower)),
                text.number(text.display(quantity, row.start)),
                text.number(quantity.to_display(row.value)),
                text.trimmed(quantity.to_display(row.upper)),
                text.unit_text(quantity.unit),
                _slot(console, row.value, row.lower, row.upper),
                "" if row.at_bound is None else f"at {row.at_bound} bound",
            ]
        )
        styles.append(["", "dim", "dim", "bold", "dim", "dim", "cyan", "yellow"])
    return "\n".join(console.table(columns, rows, styles))


def _slot(console: Console, value: float, lower: float, upper: float, size: int = 13) -> str:
    share = (value - lower) / (upper - lower) if upper > lower else 0.0
    place = round(min(max(share, 0.0), 1.0) * (size - 1))
    line, dot = ("─", "●") if console.unicode else ("-", "o")
    return line * place + dot + line * (size - 1 - place)


def stiffness_curve(
    curve: StrokeCurve,
    requirement: Requirement | None = None,
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
    height: int = 7,
) -> str:
    """A small curve of stiffness over the stroke with the required value."""
    console = Console(colour, unicode, width)
    points = [
        (1000.0 * float(x), float(k) / 1e6)
        for x, k in zip(curve.position, curve.stiffness, strict=True)
    ]
    limit = None if requirement is None else requirement.limit / 1e6
    title = f"stiffness over the stroke, kN/mm (case {curve.case})"
    lines = plot.curve(points, limit, console, min(width, 76), height)
    if not lines:
        return ""
    place, weakest = min(points, key=lambda point: point[1])
    ending = f"minimum {text.number(weakest)} at {text.trimmed(place, 3)} mm"
    if limit is not None:
        ending += f", required {text.trimmed(limit)}"
    return "\n".join([console.heading(title), *lines, console.paint(console.say(ending), "dim")])


def notes(subject: Evaluation | Optimisation, **style: Unpack[Style]) -> str:
    """Warnings in full, unverified data counted; empty when there is nothing to say."""
    console = Console(**style)
    evaluation = page.parts_of(subject)[0]
    lines = [console.wrap(f"warning: {w}", "yellow") for w in page.warnings(subject)]
    if evaluation.unverified:
        counts: dict[str, int] = {}
        for value in evaluation.unverified:
            counts[value.material] = counts.get(value.material, 0) + 1
        listed = ", ".join(f"{material} {count}" for material, count in counts.items())
        total = len(evaluation.unverified)
        lines.append(console.wrap(f"unverified library values used: {total} ({listed})", "yellow"))
    return "\n".join(lines)


def evaluation_text(
    evaluation: Evaluation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `evaluate` shows."""
    required = next(
        (r for r in evaluation.requirements if (r.metric, r.sense) == ("stiffness_min", "min")),
        None,
    )
    style: Style = {"colour": colour, "unicode": unicode, "width": width}
    curve = stiffness_curve(evaluation.curve, required, **style)
    shares = stiffness_page.summary(evaluation.curve)
    if curve and shares:
        curve += "\n" + Console(**style).wrap(f"compliance there: {shares}", "dim")
    parts = [
        verdict(evaluation, **style),
        evaluation_table(evaluation, **style),
        curve,
        checks_table(evaluation, **style),
        notes(evaluation, **style),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def optimisation_text(
    optimisation: Optimisation, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `optimise` shows."""
    style: Style = {"colour": colour, "unicode": unicode, "width": width}
    console = Console(**style)
    parts: Sequence[str] = [
        verdict(optimisation, **style),
        infeasibility_card.terminal(optimisation, **style),
        requirements_table(optimisation.best_evaluation, **style),
        variables_table(optimisation, **style) if optimisation.variables else "",
        prices.terminal(optimisation, **style),
        checks_table(optimisation.best_evaluation, **style),
        notes(optimisation, **style),
        choices_table.terminal(optimisation, **style),
        whole_plies.terminal(optimisation, **style),
        "\n".join(console.wrap(line) for line in trust.proof(optimisation, brief=True)),
        "\n".join(console.wrap(s, "dim") for s in optimum.convergence(optimisation)),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"
