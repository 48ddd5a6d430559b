"""A Pareto front as columns: for the terminal, the report and CSV alike."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ..base.files import write_text
from ..base.quantities import Quantity
from ..design import quantity_of
from ..evaluation.reserve import count_words
from ..optimisation.front.even import Gap
from ..optimisation.pareto_result import ParetoFront
from ..rendering import text
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..rendering.paper import ReportFile

SHOWN = 21
"""Designs that terminal and report show: the anchors, the knee and others evenly between."""


class Series(NamedTuple):
    """A column: its name, quantity and SI values, one for each design."""

    name: str
    quantity: Quantity
    values: tuple[float, ...]

    def cells(self, digits: int = 4) -> list[str]:
        """As printed, without the unit."""
        return [text.number(self.quantity.to_display(value), digits) for value in self.values]

    @property
    def unit(self) -> str:
        """As printed."""
        return text.unit_text(self.quantity.unit)


def series(found: ParetoFront, *, variables: bool = True) -> list[Series]:
    """Objectives, the other metrics, then variables of every design."""
    quantities = found.evaluation.metrics
    wished = {one.metric: one.quantity for one in found.objectives}
    names = found.points[0].metrics
    result = [
        Series(name, wished.get(name) or quantities[name].quantity,
               tuple(point.metrics[name] for point in found.points))
        for name in names
    ]  # fmt: skip
    if variables:
        result += [
            Series(path, quantity_of(path, found.subject),
                   tuple(point.variables[path] for point in found.points))
            for path in found.points[0].variables
        ]  # fmt: skip
    return result


def write_csv(found: ParetoFront, path: Path) -> ReportFile:
    """Write every design of a front, one a line, units in the header, full precision."""
    columns = series(found)
    stream = io.StringIO()
    rows = csv.writer(stream, lineterminator="\n")
    units = [f" [{one.quantity.unit}]" if one.quantity.unit else "" for one in columns]
    heads = [one.name + unit for one, unit in zip(columns, units, strict=True)]
    rows.writerow(["design", "knee", *heads, "kkt_residual"])
    knee = None if found.knee is None else found.knee.index
    for k, point in enumerate(found.points):
        numbers = [f"{one.quantity.to_display(one.values[k]):.12g}" for one in columns]
        rows.writerow([k + 1, int(k == knee), *numbers, f"{point.kkt_residual:.3g}"])
    written = stream.getvalue()
    write_text(path, written)
    return ReportFile(path, hashlib.sha256(written.encode()).hexdigest(), 1)


def front_outcome(found: ParetoFront) -> dict[str, Any]:
    """The numbers that say whether a front repeats (SI): the objectives of every design."""
    values = {
        f"{one.metric} of design {k}": point.metrics[one.metric]
        for k, point in enumerate(found.points, 1)
        for one in found.objectives
    }
    return {"status": found.status, "metrics": values}


def shown(found: ParetoFront, most: int = SHOWN) -> list[int]:
    """Designs to print: those with a role, and others evenly between."""
    last = len(found.points) - 1
    if last < most:
        return list(range(last + 1))
    named = {k for k in range(last + 1) if role(found, k)}
    even = {round(k * last / (most - 1)) for k in range(most)} - named
    close = sorted(even, key=lambda k: min(abs(k - one) for one in named))
    return sorted(named | set(close[len(named | even) - most :]))


def role(found: ParetoFront, k: int) -> str:
    """What a design is: the best in an objective, the knee, or nothing to name."""
    if found.knee is not None and found.knee.index == k:
        return "knee"
    for one in found.objectives:
        values = [point.metrics[one.metric] for point in found.points]
        if values[k] == (min(values) if one.sense == "min" else max(values)):
            words = "least" if one.sense == "min" else "most"
            return f"{words} {one.metric}"
    return ""


def moving(found: ParetoFront, most: int) -> list[str]:
    """Variables that move most along the front, relative to their mean."""

    def span(path: str) -> float:
        values = [point.variables[path] for point in found.points]
        middle = sum(map(abs, values)) / len(values)
        return (max(values) - min(values)) / middle if middle else 0.0

    paths = sorted(found.points[0].variables, key=span, reverse=True)
    return [path for path in paths if span(path) > 1e-3][:most]


def evaluated(found: ParetoFront) -> str:
    """The design that the front's evaluation is of."""
    return "first design" if found.knee is None else "knee"


def remarks(found: ParetoFront) -> list[str]:
    """What was checked, how even it is, the knee, and what to doubt."""
    said = [found.sentence]
    if found.evenness is not None and len(found.points) > 2:
        said.append(
            f"largest gap between neighbours {text.number(found.evenness, 3)} times the median, "
            f"in objectives over their range" + (", jumps left out" if found.jumps else "")
        )
    said += _wide(found)
    if found.knee is not None:
        said.append(f"knee: design {found.knee.index + 1}, where the front bends most")
    elif len(found.points) > 1:
        said.append("no knee: the front nowhere bends towards the ideal")
    if found.points:
        worst = max(point.kkt_residual for point in found.points)
        said.append(f"optimality conditions hold to {text.number(worst, 2)} at every design")
        if tight := len(found.evaluation.tight):
            said.append(
                f"{evaluated(found)}: {count_words(tight)}; `actuator-opt uncertainty` gives the "
                "yield of a design"
            )
    return [*said, *found.warnings]


def _wide(found: ParetoFront) -> list[str]:
    """Which gaps are wide, and why."""

    def between(gaps: Sequence[Gap]) -> str:
        return ", ".join(f"{gap.after + 1} and {gap.after + 2}" for gap in gaps)

    said, jumps = [], found.jumps
    if jumps:
        most = text.number(100 * max(gap.reach / gap.size for gap in jumps), 2)
        said.append(
            f"the front jumps between designs {between(jumps)}: by the designs at levels on both "
            f"sides at most {most} % of such a gap can hold more of it"
        )
    rest = [gap for gap in found.wide if not gap.jump]
    if rest:
        said.append(f"wide gap between designs {between(rest)}: no design found there")
    return said


def front_text(
    found: ParetoFront, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `pareto` shows: the front as a table, and how far to trust it."""
    console = Console(colour, unicode, width)
    parts = [console.paint(console.say(found.subject.name), "bold")]
    if found.points:
        parts.append("\n".join(_table(console, found)))
    words = remarks(found) if found.points else [found.sentence]
    parts.append("\n".join(console.wrap(text.pretty(line)) for line in words))
    return "\n\n".join(parts) + "\n"


def _table(console: Console, found: ParetoFront) -> list[str]:
    """The designs shown: objectives, and the variables that move most."""
    objectives = [one.metric for one in found.objectives]
    wanted = [*objectives, *moving(found, 4)]
    by_name = {one.name: one for one in series(found)}
    columns = [Column("design", "right")]
    for number, name in enumerate(wanted):
        unit = by_name[name].unit
        head = f"{name}, {unit}" if unit else name
        columns.append(Column(head, "right", drop=max(0, number - len(objectives) + 1)))
    columns.append(Column("", "left"))
    cells = [by_name[name].cells() for name in wanted]
    rows = [[str(k + 1), *(one[k] for one in cells), role(found, k)] for k in shown(found)]
    return console.table(columns, rows, [["" for _ in row] for row in rows])
