"""Recorded runs: their list, and the details of a single run. Also the findings of `doctor`.

The table of `doctor` is never cut, so that paths can be copied.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..base.quantities import INPUTS, MATERIAL_PROPERTIES, Quantity
from ..metrics import METRICS, of_metric
from ..rendering.blocks import Block, Column, Row, State, Table, short
from ..rendering.text import DASH, number, pretty

MET = 1e-6
"""Largest violation with which a limit counts as met, as stated in the documentation."""
_STEPS = 8
"""Largest number of improvements of the search shown."""
_COMMAND = 600
"""Largest number of characters of a command that are shown."""
_VALUES = 8
"""Largest number of values listed for a varied input."""
_DESIGNS = 5
"""Largest number of designs shown for a sweep."""
_BOUNDS = (("value", 5), ("lower", 4), ("upper", 4))
"""Columns of the variables, with their significant digits."""
Fact = tuple[str, str]


def listing(runs: Iterable[tuple[str, Mapping[str, Any]]]) -> Table:
    """Table of runs, one per line: id and summary."""
    columns = [
        Column("run", strong=True),
        Column("command", style="dim", drop=2),
        Column("design", width=1.0),
        Column("outcome", width=1.0, style="state"),
        Column("objective", width=1.0, drop=1),
        Column("seed", "right", style="dim", drop=4),
        Column("version", style="dim", drop=3),
    ]
    rows = []
    for name, head in runs:
        kind, design, seed, version = (
            str(head.get(key, "")) for key in ("kind", "name", "seed", "version")
        )
        good = head.get("met") and not head.get("without_reserve")
        cells = (name, kind, design, outcome(head), objective(head), seed, version)
        rows.append(Row(cells, "met" if good else "no_reserve"))
    return Table("", columns, rows)


def outcome(head: Mapping[str, Any]) -> str:
    """Outcome of a run in a few words."""
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
    """The objective with its value in the display unit; for a Pareto front, all objectives."""
    if "objectives" in head:
        return ", ".join(f"{goal['metric']} {goal['sense']}" for goal in head["objectives"])
    goal = head.get("objective") or {}
    value = goal.get("value")
    if value is None:
        return DASH
    metric = str(goal.get("metric", ""))
    return f"{metric} {of_metric(metric).text(value, 5)}"


def blocks(name: str, head: Mapping[str, Any], body: Mapping[str, Any]) -> list[Block]:
    """A run: its request, its result, and the convergence of the search."""
    columns = [Column("", style="dim"), Column("", width=1.0, breaks=30, wraps=True, least=24)]
    shown: list[Block] = [Table(f"run {name}", columns, _facts(head, body))]
    variables = body.get("state", {}).get("result", {}).get("variables", [])
    if variables:
        shown.append(_variables(variables))
    if head["kind"] == "sweep" and "plan" in body and body["result"]["best"]:
        shown.append(_best(head, body))
    if "objectives" in head and body["result"]["points"]:
        shown.append(_front(head, body))
    if trace := body.get("trace", ()):
        shown.append(convergence(head, trace))
    return shown


def _facts(head: Mapping[str, Any], body: Mapping[str, Any]) -> list[Fact]:
    """Facts about a run: design, command, settings of the computation, and outcome."""
    given = body["input"]
    request: list[Fact] = []
    if head["kind"] == "sweep" and "plan" in body:
        request = _sweep_facts(body)
    elif "objectives" in head:
        request = _front_facts(head)
    return [
        ("design", f"{head['name']} ({given['name']}, hash {head['spec_hash']})"),
        ("command", short(head["command"], _COMMAND) or "from a script"),
        ("started", str(head["started"])),
        ("seed", str(head["seed"])),
        ("versions", ", ".join(f"{key} {value}" for key, value in body["versions"].items())),
        *(("set", f"{path} = {value}") for path, value in given["set"]),
        *(("unset", path) for path in given.get("unset", ())),
        *(("plugin", x["file"] or "a function of a script") for x in given["plugins"]),
        *request,
        ("outcome", pretty(str(head.get("outcome") or outcome(head)))),
        *([] if "objectives" in head else [("objective", objective(head))]),
    ]


def _sweep_facts(body: Mapping[str, Any]) -> list[Fact]:
    """The varied inputs of a sweep, the method that places its points, and the file of its rows."""
    plan, request = body["plan"], body["asked"]
    store = request["store"]
    if request["reduce"]:
        kept = f"only the best {request['keep']}"
    else:
        kept = "no rows" if store is None else f"every row in {store['path']}"
    return [
        *(("vary", f"{axis['path']}: {_values(axis)}") for axis in plan["axes"]),
        ("points", f"{plan['count']}, {plan['method']}"),
        ("kept", kept),
        *((kind, request[kind]) for kind in ("csv", "parquet") if request[kind]),
        *([("figures", ", ".join(request["figures"]))] if request["figures"] else []),
    ]


def _values(axis: Mapping[str, Any]) -> str:
    """The values of a varied input in display units."""
    if axis["values"] is None:
        values = [*axis["texts"]]
    else:
        values = [_quantity(axis).text(value, 6) for value in axis["values"]]
    if axis["range"]:
        steps = "" if axis["steps"] is None else f", {axis['steps']} steps"
        return f"{values[0]} to {values[1]}{steps}"
    more = f" and {len(values) - _VALUES} more" if len(values) > _VALUES else ""
    return ", ".join(values[:_VALUES]) + more


def _quantity(axis: Mapping[str, Any]) -> Quantity:
    """The quantity of a varied input (an input of the design, a limit or a material value)."""
    tables = {"requirements": METRICS, "materials": MATERIAL_PROPERTIES}
    known = tables.get(axis["path"].partition(".")[0], INPUTS)
    return known.get(axis["quantity"]) or of_metric(axis["quantity"])


def _front_facts(head: Mapping[str, Any]) -> list[Fact]:
    """The objectives of a front and its knee."""
    goals = [("objective", f"{goal['metric']} {goal['sense']}") for goal in head["objectives"]]
    if head["knee"] is None:
        return goals
    values = (f"{metric} {of_metric(metric).text(x, 5)}" for metric, x in head["knee"].items())
    return [*goals, ("knee", ", ".join(values))]


def _variables(variables: Sequence[Mapping[str, Any]]) -> Table:
    columns = [
        Column("variable", width=1.0),
        Column("value", "right"),
        Column("lower", "right", drop=2),
        Column("upper", "right", drop=2),
        Column("", drop=1),
    ]
    rows = []
    for variable in variables:
        quantity = INPUTS[variable["quantity"]]
        numbers = [quantity.text(variable[key], digits) for key, digits in _BOUNDS]
        bound = f"at {variable['at_bound']} bound" if variable["at_bound"] else ""
        rows.append((variable["path"], *numbers, bound))
    return Table("", columns, rows)


def _best(head: Mapping[str, Any], body: Mapping[str, Any]) -> Table:
    """The best designs of a sweep."""
    best: Sequence[Mapping[str, Any]] = body["result"]["best"][:_DESIGNS]
    goals = [metric for metric in [head["objective"]["metric"]] if metric in best[0]["metrics"]]
    axes = {axis["path"]: axis for axis in body["plan"]["axes"]}
    columns = [
        Column("", "right"),
        *(Column(path, "right", width=1.0) for path in axes),
        *(Column(metric, "right") for metric in goals),
    ]
    rows = []
    for place, design in enumerate(best, 1):
        values = [_value(design["variables"][path], axis) for path, axis in axes.items()]
        metrics = [of_metric(metric).text(design["metrics"][metric], 5) for metric in goals]
        rows.append((str(place), *values, *metrics))
    return Table("", columns, rows)


def _value(value: Any, axis: Mapping[str, Any]) -> str:
    return str(value) if axis["values"] is None else _quantity(axis).text(value, 5)


def _front(head: Mapping[str, Any], body: Mapping[str, Any]) -> Table:
    """Range and knee of every objective of a front."""
    points = body["result"]["points"]
    columns = [
        Column("objective", width=1.0, breaks=14, wraps=True),
        Column("least", "right"),
        Column("most", "right"),
        Column("knee", "right", drop=1),
    ]
    rows = []
    for goal in head["objectives"]:
        metric = goal["metric"]
        values = [point["metrics"][metric] for point in points]
        knee = None if head["knee"] is None else head["knee"][metric]
        shown = [
            DASH if value is None else of_metric(metric).text(value, 5)
            for value in (min(values), max(values), knee)
        ]
        rows.append((f"{metric} {goal['sense']}", *shown))
    return Table("", columns, rows)


def convergence(head: Mapping[str, Any], trace: Sequence[Sequence[float]]) -> Table:
    """Improvements of the search, at most `_STEPS` of them, the first and the last included."""
    metric = str((head.get("objective") or {}).get("metric", ""))
    last, size = len(trace) - 1, min(len(trace), _STEPS) - 1
    chosen = sorted({round(k * last / size) for k in range(size + 1)} if size else {0})
    rows = []
    for count, value, missed in (trace[k] for k in chosen):
        miss = "all met" if missed <= MET else f"{number(100 * missed, 2)} %"
        rows.append((f"{count:.0f}", of_metric(metric).text(value, 5), miss))
    columns = [
        Column("evaluation", "right"),
        Column("objective, best so far", "right"),
        Column("worst limit missed by", "right"),
    ]
    return Table("", columns, rows)


_STATUS: dict[str, tuple[str, State]] = {
    "ok": ("ok", "met"),
    "missing": ("not there", "no_reserve"),
    "fault": ("FAULT", "missed"),
}
"""For each status: words, and the state that determines the colour."""


def findings(entries: Iterable[tuple[str, str, str, str, str]]) -> Table:
    """Table of the findings of `doctor`: group, name, status, value and remedy of each."""
    columns = [
        Column("", strong=True, drop=1),
        Column("", style="state"),
        Column(""),
        Column("", width=1.0, wraps=True, least=24),
    ]
    rows, before = [], ""
    for group, name, status, value, remedy in entries:
        words, state = _STATUS[status]
        heading = "" if group == before else group
        rows.append(Row((heading, words, name, f"{value}; {remedy}" if remedy else value), state))
        before = group
    return Table("", columns, rows)
