"""Recorded runs as text for the terminal. Pure functions on heads and bodies of records."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..base.quantities import INPUTS
from ..metrics import of_metric
from ..rendering.blocks import Column, short
from ..rendering.console import Console
from ..rendering.text import DASH, number, pretty
from . import runs_asked

MET = 1e-6
"""Largest miss of a limit that counts as met (contract)."""
_MOST_STEPS = 8
_COMMAND = 600
"""Letters of a command that are told."""
_SHOWN = (("value", 5), ("lower", 4), ("upper", 4))
"""Columns of the variables, with the digits of each."""


def runs_table(
    rows: Iterable[tuple[str, Mapping[str, Any]]],
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """Ids and heads, one run a line."""
    console = Console(colour, unicode, width)
    columns = [
        Column("run"),
        Column("command", drop=2),
        Column("design", width=1.0),
        Column("outcome", width=1.0),
        Column("objective", width=1.0, drop=1),
        Column("seed", "right", drop=4),
        Column("version", drop=3),
    ]
    cells, styles = [], []
    for name, head in rows:
        found = outcome(head)
        cells.append(
            [
                name,
                str(head.get("kind", "")),
                str(head.get("name", "")),
                found,
                objective(head),
                str(head.get("seed", "")),
                str(head.get("version", "")),
            ]
        )
        paint = "green" if head.get("met") and not head.get("without_reserve") else "yellow"
        styles.append(["bold", "dim", "", paint, "", "dim", "dim"])
    return "\n".join(console.table(columns, cells, styles)) + "\n"


def outcome(head: Mapping[str, Any]) -> str:
    """How a run ended, in a word or two."""
    status = str(head.get("status", DASH))
    if head.get("kind") == "sweep" and "requested" in head:
        count = head["feasible"]
        return status if count is None else f"{count} feasible"
    if status == "front":
        return f"{head['points']} designs"
    if status == "optimal":
        if not head.get("met"):
            return "requirement missed"
        count = head.get("without_reserve", 0)
        return f"met, {count} without reserve" if count else "met"
    return status.replace("_", " ")


def objective(head: Mapping[str, Any]) -> str:
    """What was minimised or maximised, in its display unit; of a front the objectives."""
    if "objectives" in head:
        return ", ".join(f"{one['metric']} {one['sense']}" for one in head["objectives"])
    found = head.get("objective") or {}
    value = found.get("value")
    if value is None:
        return DASH
    metric = str(found.get("metric", ""))
    return f"{metric} {value_text(metric, value)}"


def value_text(metric: str, value: float) -> str:
    """An objective in its display unit; a weighted sum and a user's own metric have none."""
    return of_metric(metric).text(value, 5)


def run_text(
    name: str,
    head: Mapping[str, Any],
    body: Mapping[str, Any],
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """Everything of a run that a person asks for: what was asked, with what, what came out."""
    console = Console(colour, unicode, width)
    given = body["input"]
    versions = ", ".join(f"{key} {value}" for key, value in body["versions"].items())
    facts = [
        ("design", f"{head['name']} ({given['name']}, hash {head['spec_hash']})"),
        ("command", short(head["command"], _COMMAND) or "from a script"),
        ("started", head["started"]),
        ("seed", str(head["seed"])),
        ("versions", versions),
        *(("set", f"{path} = {value}") for path, value in given["set"]),
        *(("plugin", one["file"] or "a function of a script") for one in given["plugins"]),
        *_asked(head, body),
        ("outcome", pretty(str(head.get("outcome") or outcome(head)))),
        *([] if "objectives" in head else [("objective", objective(head))]),
    ]
    lines = [console.heading(f"run {name}")]
    inner = Console(colour, unicode, max(width - 11, 24))
    for label, text in facts:
        told = inner.wrap(text).split("\n")
        lines.append(f"{console.paint(f'{label:<9}', 'dim')}  {told[0]}")
        lines += [f"{'':11}{line}" for line in told[1:]]
    variables = body.get("state", {}).get("result", {}).get("variables", [])
    if variables:
        lines += ["", *_variables(variables, console)]
    if head["kind"] == "sweep" and "plan" in body:
        lines += runs_asked.sweep_lines(head, body, console)
    if "objectives" in head:
        lines += runs_asked.front_lines(head, body, console)
    lines += trace_lines(head, body.get("trace", ()), console)
    return "\n".join(lines) + "\n"


def _asked(head: Mapping[str, Any], body: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What a sweep varied, what a front traded."""
    if head["kind"] == "sweep" and "plan" in body:
        return runs_asked.sweep_facts(body)
    return runs_asked.front_facts(head) if "objectives" in head else []


def _variables(rows: Sequence[Mapping[str, Any]], console: Console) -> list[str]:
    columns = [
        Column("variable", width=1.0),
        Column("value", "right"),
        Column("lower", "right", drop=2),
        Column("upper", "right", drop=2),
        Column("", drop=1),
    ]
    cells = []
    for row in rows:
        quantity = INPUTS[row["quantity"]]
        numbers = [quantity.text(row[key], digits) for key, digits in _SHOWN]
        bound = f"at {row['at_bound']} bound" if row["at_bound"] else ""
        cells.append([row["path"], *numbers, bound])
    return console.table(columns, cells)


def trace_lines(
    head: Mapping[str, Any], trace: Sequence[Sequence[float]], console: Console
) -> list[str]:
    """The improvements of the search, at most `_MOST_STEPS` of them, first and last among them."""
    if not trace:
        return []
    metric = str((head.get("objective") or {}).get("metric", ""))
    last = len(trace) - 1
    size = min(len(trace), _MOST_STEPS) - 1
    picked = sorted({round(k * last / size) for k in range(size + 1)} if size else {0})
    cells = []
    for count, value, missed in (trace[k] for k in picked):
        left = "all met" if missed <= MET else f"{number(100 * missed, 2)} %"
        cells.append([f"{count:.0f}", value_text(metric, value), left])
    columns = [
        Column("evaluation", "right"),
        Column("objective of the best so far", "right"),
        Column("worst limit missed by", "right"),
    ]
    return ["", *console.table(columns, cells)]
