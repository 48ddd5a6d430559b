"""Tables of limits: requirements, checks, every place of a limit, and the reasons of limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..base.quantities import Quantity
from ..evaluation import result
from ..evaluation.limits import margin
from ..evaluation.result import NO_ROOM, Check, Evaluation, Requirement
from ..metrics.table import ROWS
from ..rendering import text
from ..rendering.blocks import (
    Bar,
    Block,
    Cell,
    Column,
    Medium,
    Notes,
    Row,
    Status,
    Table,
    clean,
    soft,
)
from ..rendering.text import DASH

REQUIREMENTS = "Requirements"
"""Title of the table of requirements, which summaries show."""
NO_RESERVE = f"No reserve: met, with a margin below {100 * result.NO_RESERVE:g} %"
FAR = 1.0
"""Margin from which a place is not listed. Our choice: twice the limit."""
MOST_PLACES = 4
"""Places that are listed of one limit, the worst first; one more is listed instead of counted."""
FLAG = " (!)"
"""Mark of a quantity whose model is used outside its valid range."""
FLAGGED = "(!) EXTRAPOLATED: a model was used outside its valid range"

_BAR = Column("", "left", "22mm", drop=2)
_MARK = Column("", on="terminal")
"""Column that shows a state only by its mark, without words."""


def counts_of(evaluation: Evaluation) -> dict[str, int]:
    """Number of checks by status."""
    return {
        name: sum(check.status == name for check in evaluation.checks)
        for name in ("met", "missed", "not_checked")
    }


def short_label(name: str, quantity: Quantity) -> str:
    """A short label of a metric."""
    row = ROWS.get(name)
    return (row.short if row else "") or quantity.label


def flag(evaluation: Evaluation, name: str | None) -> str:
    """`FLAG` if the metric's model is used outside its valid range; otherwise empty."""
    known = evaluation.metrics.get(name or "")
    return "" if known is None or known.in_range else FLAG


def requirements(evaluation: Evaluation, *, shown: bool = True, labelled: bool = True) -> Block:
    """Limit, result, margin and status of every requirement.

    `shown`: the terminal shows the table, too (an evaluation lists limits with all quantities
    instead). `labelled`: on paper, every quantity also has a label in words.
    """
    on: Medium = "both" if shown else "paper"
    rows: list[Row] = []
    for row in evaluation.requirements:
        quantity = text.metric(row.metric)
        cells: list[Cell] = [
            Status(row.state, " "),
            row.name + flag(evaluation, row.metric),
            clean(short_label(row.metric, quantity)),
            text.limit_text(quantity, row.sense, row.limit),
            _result(evaluation, row),
            text.margin_of(quantity, row.limit, row.margin, met=row.met),
            Bar(row.margin, met=row.met),
            Status(row.state),
            text.brief(row.case, row.place) or DASH,
        ]
        rows.append(Row(cells, row.state))
    if not rows:
        return Notes(REQUIREMENTS, ["The design states no requirement."], on=on)
    columns = [
        _MARK,
        Column("requirement", "left", 1.0 if labelled else 1.2, breaks=21, mono=True, least=16),
        Column("quantity", "left", 1.3, on="paper"),
        Column("limit", "right"),
        Column("result", "right", style="bold"),
        Column("margin", "right", style="state"),
        replace(_BAR, drop=1),
        Column("status", on="paper"),
        Column("governing case", "left", 1.2 if labelled else 2.0, breaks=18, drop=2, style="dim"),
    ]
    note = (
        "Margin: distance from the limit as a share of the limit; a full bar means 100 % or more."
    )
    note = " ".join([note, *(f"{line}." for line in _row_notes(evaluation))])
    shown_columns = [k for k, column in enumerate(columns) if labelled or column.head != "quantity"]
    return Table(
        REQUIREMENTS,
        [columns[k] for k in shown_columns],
        [Row([row.cells[k] for k in shown_columns], row.state) for row in rows],
        note=note,
        on=on,
    )


def _row_notes(evaluation: Evaluation) -> list[str]:
    """Explanations of the states and marks that occur in the table."""
    rows = evaluation.requirements
    notes = [NO_RESERVE] if any(row.state == "no_reserve" for row in rows) else []
    return notes + ([FLAGGED] if any(flag(evaluation, row.metric) for row in rows) else [])


def _result(evaluation: Evaluation, row: Requirement) -> Cell:
    if row.value is not None:
        return text.value_text(text.metric(row.metric), row.value)
    metric = evaluation.metrics.get(row.metric)
    return soft(metric.why if metric is not None and metric.why else DASH)


def quantities(evaluation: Evaluation) -> Iterator[Block]:
    """Every computed quantity with its limits, and the quantities not computed, for the terminal.

    Beside each limit is the value from which its margin is computed.
    """
    limits: dict[str, list[Requirement]] = {}
    for required in evaluation.requirements:
        limits.setdefault(required.metric, []).append(required)
    rows: list[Row] = []
    missing: dict[str, list[str]] = {}
    for metric in evaluation.metrics.values():
        quantity = metric.quantity
        if metric.value is None:
            missing.setdefault(metric.why or "not computed", []).append(metric.name)
            continue
        case = text.brief(metric.case, metric.place)
        mark = "" if metric.in_range else FLAG
        unit = text.unit_text(quantity.unit)
        value = text.number(quantity.to_display(metric.value))
        cells: list[Cell] = [metric.name + mark, value, unit, "", "", "", case, quantity.label]
        for index, row in enumerate(limits.get(metric.name, ())):
            value = DASH if row.value is None else text.number(quantity.to_display(row.value))
            cells = [
                metric.name + mark if index == 0 else "",
                value,
                unit,
                text.limit_text(quantity, row.sense, row.limit),
                text.margin_of(quantity, row.limit, row.margin, met=row.met),
                Bar(row.margin, met=row.met),
                text.brief(row.case, row.place) or case,
                quantity.label if index == 0 else "",
            ]
            rows.append(Row(cells, row.state))
        if metric.name not in limits:
            rows.append(Row(cells))
    columns = [
        Column("quantity"),
        Column("value", "right", style="bold"),
        Column("unit", style="dim"),
        Column("limit", "right"),
        Column("margin", "right", style="state"),
        _BAR,
        Column("case", width=1.0, drop=1, style="dim"),
        Column("what", width=1.0, drop=3, least=45, style="dim"),
    ]
    note = FLAGGED if any(not metric.in_range for metric in evaluation.metrics.values()) else ""
    yield Table("Quantities", columns, rows, note=note, headless=True, on="terminal")
    if missing:
        lines = [f"{', '.join(names)}: {why}" for why, names in missing.items()]
        yield Notes("Not computed", lines, on="terminal")


def checks(evaluation: Evaluation) -> Iterator[Block]:
    """The check list: on paper all lines; on the terminal only lines that are not clearly met."""
    if not evaluation.checks:
        yield Notes("Check list", ["No check list."], on="paper")
        return
    counts = counts_of(evaluation)
    note = (
        f"{counts['met']} met, {counts['missed']} missed, {counts['not_checked']} not "
        "checked. If a line is not checked, its limit may be missed."
    )
    columns = [
        Column("check", "left", 1.25),
        Column("limit", "right"),
        Column("result", "right"),
        Column("margin", "right"),
        Column("status"),
        Column("governing case", "left", 1.0),
        Column("reason; source of the limit", "left", 1.45),
    ]
    rows = [_check(evaluation, check) for check in evaluation.checks]
    yield Table("Check list", columns, rows, note=note, on="paper")
    yield _open_checks(evaluation, f"checks: {counts['met']} of {len(evaluation.checks)} met")


def _check(evaluation: Evaluation, check: Check) -> list[Cell]:
    quantity = text.metric(check.metric or "")
    remark = "; ".join(part for part in (check.reason, check.source) if part)
    return [
        *_check_values(evaluation, check),
        text.margin_of(quantity, check.limit, check.margin, met=check.status != "missed"),
        Status(check.state),
        soft(", ".join(part for part in (check.case, check.place) if part) or DASH),
        soft(remark or DASH),
    ]


def _check_values(evaluation: Evaluation, check: Check) -> list[str]:
    """Name, limit and result of a line of the check list."""
    quantity = text.metric(check.metric or "")
    known = check.metric is not None and check.value is not None
    return [
        clean(check.name + flag(evaluation, check.metric)),
        text.limit_text(quantity, check.sense, check.limit),
        text.value_text(quantity, check.value) if known else DASH,
    ]


def _open_checks(evaluation: Evaluation, title: str) -> Block:
    """Checks that are missed, without reserve or not checked, worst first."""
    order = ("missed", "no_reserve", "not_checked")
    lines = [check for check in evaluation.checks if check.state in order]
    if not lines:
        return Notes(title, [], on="terminal")
    columns = [
        _MARK,
        Column("check", width=1.0),
        Column("limit", "right"),
        Column("result", "right"),
        Column("why", width=1.0, style="dim"),
    ]
    rows = []
    for check in sorted(lines, key=lambda check: order.index(check.state)):
        why = check.reason or check.source
        why = f"met without reserve: {why}" if check.state == "no_reserve" else why
        cells: list[Cell] = [Status(check.state, " "), *_check_values(evaluation, check), why]
        rows.append(Row(cells, check.state))
    return Table(title, columns, rows, on="terminal")


def places(evaluation: Evaluation) -> Iterator[Block]:
    """The worst places of every limit that several places have to meet; the others are counted.

    Limits of load cases are left out: each applies to one case, and its row names the place.
    """
    required = [row for row in evaluation.requirements if not row.path.startswith("load_cases[")]
    stated: Sequence[Requirement | Check] = (*required, *evaluation.checks)
    limits = {
        row.metric: (row.name if isinstance(row, Check) else "", row.sense, row.limit)
        for row in stated
        if row.metric is not None and row.limit and row.sense is not None
    }
    rows, left_out = list[Row](), 0
    for name, (check, sense, bound) in limits.items():
        metric = evaluation.metrics.get(name)
        if metric is None or len(metric.by_place) < 2:
            continue
        quantity = text.metric(name)
        label = check or quantity.label
        margins = {
            place: float(margin(value, bound, sense)) for place, value in metric.by_place.items()
        }
        near = sorted((m, place) for place, m in margins.items() if m < FAR)
        left_out += len(margins) - len(near)
        listed = len(near) if len(near) <= MOST_PLACES + 1 else MOST_PLACES
        for count, (distance, place) in enumerate(near[:listed]):
            cells: list[Cell] = [
                clean(label) if count == 0 else "",
                clean(place) or DASH,
                text.limit_text(quantity, sense, bound) if count == 0 else "",
                text.value_text(quantity, metric.by_place[place]),
                text.margin_of(quantity, bound, distance, met=distance >= -NO_ROOM),
            ]
            rows.append(Row(cells))
        if more := near[listed:]:
            next_margin = text.margin_of(quantity, bound, more[0][0], met=more[0][0] >= -NO_ROOM)
            rows.append(Row(["", f"{len(more)} more", "", "", f"from {next_margin}"]))
    if not rows:
        return
    columns = [
        Column("limit of", "left", 1.3),
        Column("place", "left", 2.0),
        Column("limit", "right"),
        Column("result", "right"),
        Column("margin", "right"),
    ]
    note = f"{left_out} places with a margin of {100 * FAR:.0f} % or more are not listed."
    yield Table("Limits, place by place", columns, rows, note=note if left_out else "", on="paper")


def reasons(evaluation: Evaluation) -> Iterator[Block]:
    """Why each requirement is what it is, in the words of the author."""
    stated = evaluation.design.requirements
    rows: list[list[Cell]] = []
    for row in evaluation.requirements:
        limit = stated.get(row.metric)
        if limit is not None and limit.reason:
            quantity = text.metric(row.metric)
            shown = text.limit_text(quantity, row.sense, row.limit)
            rows.append([row.name, shown, soft(text.pretty(limit.reason))])
    if rows:
        columns = [
            Column("requirement", "left", 1.0, breaks=22, mono=True, least=16),
            Column("limit", "right"),
            Column("reason", "left", 3.0),
        ]
        yield Table("Why these limits", columns, rows, on="paper")
