"""The tables of an evaluation: requirements, masses, checks, models, data, a caller's own."""

from __future__ import annotations

from ..design.paths import get, quantity_of
from ..evaluation import reserve
from ..evaluation.result import Evaluation, Requirement
from ..metrics import METRICS
from ..rendering import text
from ..rendering.blocks import (
    Bar,
    Block,
    Cell,
    Column,
    Flag,
    Notes,
    Share,
    Status,
    Table,
    clean,
    soft,
)
from ..rendering.text import DASH

_BAR = Column("", "left", "22mm")


def where(case: str | None, place: str | None) -> Cell:
    """The governing case and place of a row."""
    return soft(", ".join(part for part in (case, place) if part) or DASH)


def requirements(evaluation: Evaluation) -> Block:
    """Limit, result, margin and status of every requirement."""
    rows: list[list[Cell]] = []
    for row in evaluation.requirements:
        quantity = text.metric(row.metric)
        rows.append(
            [
                soft(row.name + flag(evaluation, row.metric)),
                clean(quantity.label),
                text.limit_text(quantity, row.sense, row.limit),
                _result(evaluation, row),
                text.margin_of(quantity, row.limit, row.margin, met=row.met),
                Bar(row.margin, met=row.met),
                Status(row.state),
                where(row.case, row.place),
            ]
        )
    columns = [
        Column("requirement", "left", 1.15, mono=True),
        Column("quantity", "left", 1.6),
        Column("limit", "right"),
        Column("result", "right"),
        Column("margin", "right"),
        _BAR,
        Column("status"),
        Column("governing case", "left", 1.15),
    ]
    note = "Margin is the room left, relative to the limit; the bar is full at 100 %."
    note = " ".join([note, *(f"{line}." for line in row_notes(evaluation))])
    if not rows:
        return Notes("Requirements", ["The design states no requirement."])
    return Table("Requirements", columns, rows, note=note)


def _result(evaluation: Evaluation, row: Requirement) -> Cell:
    if row.value is not None:
        return text.value_text(text.metric(row.metric), row.value)
    metric = evaluation.metrics.get(row.metric)
    return soft(metric.why if metric is not None and metric.why else DASH)


def masses(evaluation: Evaluation) -> Block:
    """Mass per part, adding up, with the oil below."""
    quantity = METRICS["mass"]
    parts = evaluation.mass_parts
    total = sum(parts.values())
    largest = max(parts.values(), default=0.0)
    unit = text.unit_text(quantity.unit)
    decimals = text.decimals(quantity.to_display(total), 5)

    def grams(mass: float) -> str:
        return text.fixed(quantity.to_display(mass), decimals)

    rows: list[list[Cell]] = [
        [
            soft(part.replace("_", " ")),
            grams(mass),
            text.share_text(mass / total if total else 0.0),
            Share(mass / largest if largest else 0.0),
        ]
        for part, mass in parts.items()
    ]
    rows.append(["dry mass", grams(total), text.share_text(1.0), ""])
    oil = evaluation.metrics.get("mass_oil")
    rows_below = 1
    if oil is not None and oil.value is not None:
        rows.append(["oil inside", grams(oil.value), "", ""])
        rows.append(["filled", grams(total + oil.value), "", ""])
        rows_below = 3
    columns = [
        Column("part", "left", 1.0),
        Column(f"mass, {unit}", "right"),
        Column("share", "right"),
        Column("", "left", "80mm"),
    ]
    return Table("Mass", columns, rows, total=rows_below)


def checks(evaluation: Evaluation) -> Block:
    """Every line of the professional check list."""
    rows: list[list[Cell]] = []
    for row in evaluation.checks:
        quantity = text.metric(row.metric or "")
        remark = "; ".join(part for part in (row.reason, row.source) if part)
        shown = row.metric is not None and row.value is not None
        rows.append(
            [
                clean(row.name + flag(evaluation, row.metric)),
                text.limit_text(quantity, row.sense, row.limit),
                text.value_text(quantity, row.value) if shown else DASH,
                text.margin_of(quantity, row.limit, row.margin, met=row.status != "missed"),
                Status(row.state),
                where(row.case, row.place),
                soft(remark or DASH),
            ]
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
    counts = {
        name: sum(row.status == name for row in evaluation.checks)
        for name in ("met", "missed", "not_checked")
    }
    note = (
        f"{counts['met']} met, {counts['missed']} missed, {counts['not_checked']} not checked;"
        " a line that was not checked is no statement that it holds."
    )
    if not rows:
        return Notes("Check list", ["No check list."])
    return Table("Check list", columns, rows, note=note)


def models(evaluation: Evaluation) -> Block:
    """Models with source and valid range; extrapolation is flagged."""
    rows: list[list[Cell]] = [
        [
            soft(row.name),
            soft(text.pretty(row.equation)),
            soft(row.reference or "not stated"),
            soft(text.pretty(row.valid_range) or "not stated"),
            soft(text.pretty(row.used_at)),
            Flag("inside" if row.in_range else "EXTRAPOLATED", not row.in_range),
        ]
        for row in evaluation.models
    ]
    columns = [
        Column("model", "left", 1.0, mono=True),
        Column("equation", "left", 1.35),
        Column("source", "left", 1.0),
        Column("valid range", "left", 1.25),
        Column("used at", "left", 1.0),
        Column("range"),
    ]
    outside = sum(not row.in_range for row in evaluation.models)
    note = f"{outside} of {len(rows)} models used outside their valid range." if outside else ""
    if not rows:
        return Notes("Models", ["No models recorded."])
    return Table("Models", columns, rows, note=note)


def assumptions(evaluation: Evaluation) -> Block:
    """Library values that nobody checked, values of test records, checks the author took out."""
    groups: dict[tuple[str, str, str], list[str]] = {}
    for row in evaluation.unverified:
        words = f"{row.property} {text.pretty(row.value)}"
        groups.setdefault((row.material, row.source, row.note), []).append(words)
    rows: list[list[Cell]] = [
        [soft(material), soft("; ".join(values)), soft(source), soft(text.pretty(note) or DASH)]
        for (material, source, note), values in groups.items()
    ]
    for path, known in evaluation.design.measured.items():
        quantity = quantity_of(path, evaluation.design)
        ends = [text.value_text(quantity, end, 3) for end in (known.lower, known.upper)]
        value = get(evaluation.design, path)
        shown = text.value_text(quantity, value if isinstance(value, float) else None, 3)
        words = f"{shown} ({' to '.join(ends)})"
        rows.append([soft(path), soft(words), soft(known.record), "test record, 95 % bounds"])
    rows += [
        ["waived check", soft(metric), "the author", soft(reason)]
        for metric, reason in evaluation.design.waivers.items()
    ]
    if not rows:
        return Notes(
            "Assumptions and unverified data",
            ["Every library value used is marked as checked; no check is waived."],
        )
    columns = [
        Column("material", "left", 1.05),
        Column("values", "left", 2.0),
        Column("source", "left", 1.4),
        Column("note", "left", 1.3),
    ]
    note = (
        f"{len(evaluation.unverified)} library values are used that nobody has compared with their"
        " primary source; see the materials files."
    )
    return Table("Assumptions and unverified data", columns, rows, note=note)


NO_RESERVE = f"No reserve: met, with a margin below {100 * reserve.NO_RESERVE:g} %"


FLAG = " (!)"
"""Behind the name of a quantity whose value rests on a model outside its valid range."""


FLAGGED = "(!) EXTRAPOLATED: a model was used outside its valid range"


def flag(evaluation: Evaluation, name: str | None) -> str:
    """`FLAG`, where a metric rests on a model outside its valid range; else nothing."""
    known = evaluation.metrics.get(name or "")
    return "" if known is None or known.in_range else FLAG


def row_notes(evaluation: Evaluation) -> list[str]:
    """What the states and marks of requirements mean, where some have them."""
    rows = evaluation.requirements
    said = [NO_RESERVE] if any(row.state == "no_reserve" for row in rows) else []
    return said + ([FLAGGED] if any(flag(evaluation, row.metric) for row in rows) else [])
