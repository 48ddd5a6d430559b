"""What a recorded sweep or front was asked, and what came out, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..base.quantities import INPUTS, MATERIAL_PROPERTIES, Quantity
from ..metrics import METRICS, of_metric
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..rendering.text import DASH

_LISTED = 8
"""Values of a list that are told; of more, the first."""
_DESIGNS = 5
"""Best designs that are told."""
Fact = tuple[str, str]


def sweep_facts(body: Mapping[str, Any]) -> list[Fact]:
    """What varied, how it was visited and where the rows are."""
    plan, asked = body["plan"], body["asked"]
    store = asked["store"]
    if asked["reduce"]:
        kept = f"the best {asked['keep']} alone"
    else:
        kept = "no rows" if store is None else f"every row in {store['path']}"
    return [
        *(("vary", f"{axis['path']}: {_values(axis)}") for axis in plan["axes"]),
        ("points", f"{plan['count']}, {plan['method']}"),
        ("kept", kept),
        *((kind, asked[kind]) for kind in ("csv", "parquet") if asked[kind]),
        *([("figures", ", ".join(asked["figures"]))] if asked["figures"] else []),
    ]


def _values(axis: Mapping[str, Any]) -> str:
    """The values of an axis as a person reads them."""
    if axis["values"] is None:
        told = [*axis["texts"]]
    else:
        told = [_quantity(axis).text(value, 6) for value in axis["values"]]
    if axis["range"]:
        steps = "" if axis["steps"] is None else f", {axis['steps']} steps"
        return f"{told[0]} to {told[1]}{steps}"
    more = f" and {len(told) - _LISTED} more" if len(told) > _LISTED else ""
    return ", ".join(told[:_LISTED]) + more


def front_facts(head: Mapping[str, Any]) -> list[Fact]:
    """The objectives of a front and its knee."""
    wanted = [("objective", f"{one['metric']} {one['sense']}") for one in head["objectives"]]
    knee = head["knee"]
    if knee is None:
        return wanted
    told = ", ".join(f"{name} {of_metric(name).text(value, 5)}" for name, value in knee.items())
    return [*wanted, ("knee", told)]


def sweep_lines(head: Mapping[str, Any], body: Mapping[str, Any], console: Console) -> list[str]:
    """The best designs of a sweep as a table."""
    best: Sequence[Mapping[str, Any]] = body["result"]["best"][:_DESIGNS]
    if not best:
        return []
    goal = [name for name in [head["objective"]["metric"]] if name in best[0]["metrics"]]
    axes = {axis["path"]: axis for axis in body["plan"]["axes"]}
    columns = [
        Column("", "right"),
        *(Column(path, "right", width=1.0) for path in axes),
        *(Column(name, "right") for name in goal),
    ]
    cells = []
    for place, one in enumerate(best, 1):
        values = [_shown(one["variables"][path], axis) for path, axis in axes.items()]
        metrics = [of_metric(name).text(one["metrics"][name], 5) for name in goal]
        cells.append([str(place), *values, *metrics])
    return ["", *console.table(columns, cells)]


def _shown(value: Any, axis: Mapping[str, Any]) -> str:
    return str(value) if axis["values"] is None else _quantity(axis).text(value, 5)


def _quantity(axis: Mapping[str, Any]) -> Quantity:
    """What the numbers of an axis are: of the design, of a limit or of a material."""
    tables = {"requirements": METRICS, "materials": MATERIAL_PROPERTIES}
    known = tables.get(axis["path"].partition(".")[0], INPUTS)
    return known.get(axis["quantity"]) or of_metric(axis["quantity"])


def front_lines(head: Mapping[str, Any], body: Mapping[str, Any], console: Console) -> list[str]:
    """What a front spans, by objective."""
    points = body["result"]["points"]
    if not points:
        return []
    cells = []
    for one in head["objectives"]:
        name = one["metric"]
        values = [point["metrics"][name] for point in points]
        knee = None if head["knee"] is None else head["knee"][name]
        told = [
            DASH if value is None else of_metric(name).text(value, 5)
            for value in (min(values), max(values), knee)
        ]
        cells.append([f"{name} {one['sense']}", *told])
    columns = [
        Column("objective", width=1.0),
        Column("least", "right"),
        Column("most", "right"),
        Column("knee", "right"),
    ]
    return ["", *console.table(columns, cells)]
