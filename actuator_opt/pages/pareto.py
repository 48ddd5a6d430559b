"""The page of a Pareto front: its designs, the knee, the checks, and its chart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from ..base.quantities import Quantity
from ..design import quantity_of
from ..evaluation.result import Requirement, count_words
from ..optimisation.front.plane import FrontGap
from ..optimisation.pareto import ParetoFront, Wish
from ..rendering import text
from ..rendering.blocks import (
    Block,
    Chart,
    Column,
    Notes,
    Page,
    State,
    Table,
    Tile,
    Verdict,
    short,
    tile,
)
from ..rendering.chart import Axis, Curve, Level, Panel, Points
from ..rendering.chart_ink import drawn, titled
from ..rendering.ink import Ink
from ..rendering.series import Series, heading
from ..rendering.text import trimmed, unit_text, value_text
from .report import doubts

SHOWN, FEWER = 21, 17
"""Number of designs in the table for two objectives, and for more than two, whose headings need
more lines.
"""
MOVING = 5
"""Largest number of variables in the table."""

WIDTH, HEIGHT = 180.0, 82.0
"""Size of the chart [mm]."""
ROOM = 0.06
"""Free space around the designs in the chart, as a share of their range."""


def page(front: ParetoFront) -> Page:
    """The page of a Pareto front; if the front is empty, the page gives the reason."""
    if not front.points:
        state: State = "infeasible" if front.status == "infeasible" else "missed"
        return Page(
            name=front.subject.name,
            kind="Pareto front",
            verdict=Verdict(state, "NO FRONT"),
            sentence=text.pretty(front.sentence),
            tiles=[],
            hero=lambda room: Ink(WIDTH, 1.0),
        )
    return Page(
        name=front.subject.name,
        kind="Pareto front",
        verdict=verdict(front),
        sentence=text.pretty(front.sentence),
        tiles=list(_tiles(front)),
        hero=lambda room: drawn(front_chart(front)),
        blocks=list(_blocks(front)),
    )


def series(front: ParetoFront) -> list[Series]:
    """Every design of a front as columns in display units."""
    knee = None if front.knee is None else front.knee.index
    count = len(front.points)
    return [
        Series("design", list(range(1, count + 1))),
        Series("knee", [int(k == knee) for k in range(count)]),
        *(
            Series(
                heading(row.name, row.quantity.unit),
                [row.quantity.to_display(value) for value in row.values],
                12,
            )
            for row in _values(front)
        ),
        Series("kkt_residual", [point.kkt_residual for point in front.points], 3),
    ]


def front_outcome(front: ParetoFront) -> dict[str, Any]:
    """The values that a repeated run must reproduce: the objectives of every design (SI)."""
    values = {
        f"{objective.metric} of design {k}": point.metrics[objective.metric]
        for k, point in enumerate(front.points, 1)
        for objective in front.objectives
    }
    return {"status": front.status, "metrics": values}


def verdict(front: ParetoFront) -> Verdict:
    """Badge at the top, with doubts about the design evaluated in full (the knee or the first)."""
    tight = len(front.evaluation.tight)
    plain, cautions = doubts(front.evaluation)
    if tight:
        cautions.insert(0, f"{_evaluated(front)}: {count_words(tight)}")
    lines = ["every requirement met", *plain]
    return Verdict("checks" if tight else "met", "PARETO FRONT", lines, cautions)


# ---- designs ----


class _Values(NamedTuple):
    """A metric or a variable of every design (SI)."""

    name: str
    quantity: Quantity
    values: tuple[float, ...]


def _values(front: ParetoFront) -> list[_Values]:
    """Objectives, the other metrics, then variables of every design."""
    wished = {wish.metric: wish.quantity for wish in front.objectives}
    metrics, first = front.evaluation.metrics, front.points[0]
    return [
        *(
            _Values(
                name,
                wished.get(name) or metrics[name].quantity,
                tuple(point.metrics[name] for point in front.points),
            )
            for name in first.metrics
        ),
        *(
            _Values(
                path,
                quantity_of(path, front.subject),
                tuple(point.variables[path] for point in front.points),
            )
            for path in first.variables
        ),
    ]


def _shown(front: ParetoFront) -> list[int]:
    """Indices of designs in the table: designs with a role, and others evenly spaced."""
    most = SHOWN if len(front.objectives) == 2 else FEWER
    last = len(front.points) - 1
    if last < most:
        return list(range(last + 1))
    named = {k for k in range(last + 1) if _role(front, k)}
    even = {round(k * last / (most - 1)) for k in range(most)} - named
    close = sorted(even, key=lambda k: min(abs(k - other) for other in named))
    return sorted(named | set(close[len(named | even) - most :]))


def _role(front: ParetoFront, k: int) -> str:
    """Role of design `k`: best in an objective, or knee; otherwise empty."""
    if front.knee is not None and front.knee.index == k:
        return "knee"
    for objective in front.objectives:
        values = [point.metrics[objective.metric] for point in front.points]
        if values[k] == (min(values) if objective.sense == "min" else max(values)):
            return f"{'least' if objective.sense == 'min' else 'most'} {objective.metric}"
    return ""


def _moving(front: ParetoFront) -> list[str]:
    """The variables that change most along the front, relative to their mean value."""

    def span(path: str) -> float:
        values = [point.variables[path] for point in front.points]
        middle = sum(map(abs, values)) / len(values)
        return (max(values) - min(values)) / middle if middle else 0.0

    paths = sorted(front.points[0].variables, key=span, reverse=True)
    return [path for path in paths if span(path) > 1e-3][:MOVING]


def _evaluated(front: ParetoFront) -> str:
    """Name of the design that was fully evaluated."""
    return "first design" if front.knee is None else "knee"


# ---- key figures and blocks ----


def _tiles(front: ParetoFront) -> Iterator[Tile]:
    """The range of every objective, and its value at the knee."""
    for objective in front.objectives:
        values = [point.metrics[objective.metric] for point in front.points]
        best, worst = (min, max) if objective.sense == "min" else (max, min)
        note = f"to {value_text(objective.quantity, worst(values))}"
        if front.knee is not None:
            at = front.points[front.knee.index].metrics[objective.metric]
            note += f", knee {value_text(objective.quantity, at)}"
        label = short(f"best {objective.metric.replace('_', ' ')}", 28)
        yield tile(label, value_text(objective.quantity, best(values)), note)


def _blocks(front: ParetoFront) -> Iterator[Block]:
    kept, moving = _shown(front), _moving(front)
    known = {row.name: row for row in _values(front)}
    rows = [known[name] for name in (*(wish.metric for wish in front.objectives), *moving)]
    columns = [Column("design", "right")]
    for number, row in enumerate(rows, 1):
        head = f"{row.name}, {unit_text(row.quantity.unit)}".rstrip(", ")
        moves = number > len(front.objectives)
        columns.append(
            Column(head, "right", 1.0, breaks=9, least=40, drop=1 + number if moves else 0)
        )
    columns.append(Column("", "left", 1.2, least=20, drop=1))
    numbers = [[text.number(row.quantity.to_display(row.values[k])) for row in rows] for k in kept]
    body = [[str(k + 1), *cells, _role(front, k)] for k, cells in zip(kept, numbers, strict=True)]
    more = len(front.points) - len(kept)
    note = f"{more} more designs lie between the designs shown." if more else ""
    yield Table("Designs of the front", columns, body, note=note)
    yield Notes("How far to trust it", [text.pretty(line) for line in remarks(front)])


def remarks(front: ParetoFront) -> list[str]:
    """Evenness of the front, its knee, and doubts."""
    lines = []
    if front.evenness is not None and len(front.points) > 2:
        lines.append(
            f"the largest gap between neighbours is {text.number(front.evenness, 3)} times "
            "the median gap (each objective is divided by its range)"
            + (", jumps excluded" if front.jumps else "")
        )
    lines += _wide(front)
    if front.knee is not None:
        lines.append(f"knee: design {front.knee.index + 1}, where the front bends most")
    elif len(front.points) > 1:
        lines.append("no knee: the front does not bulge towards the ideal point")
    worst = max(point.kkt_residual for point in front.points)
    lines.append(
        f"the residual of the optimality conditions is at most {text.number(worst, 2)} at "
        "every design"
    )
    if tight := len(front.evaluation.tight):
        lines.append(
            f"{_evaluated(front)}: {count_words(tight)}; `actuator-opt uncertainty` computes the "
            "yield of a design"
        )
    return [*lines, *front.warnings]


def _wide(front: ParetoFront) -> Iterator[str]:
    """Sentences on wide gaps between neighbouring designs of the front, with the reasons."""

    def between(gaps: Sequence[FrontGap]) -> str:
        return ", ".join(f"{gap.after + 1} and {gap.after + 2}" for gap in gaps)

    if jumps := front.jumps:
        most = text.number(100 * max(gap.reach / gap.size for gap in jumps), 2)
        yield (
            f"the front jumps between designs {between(jumps)}: according to searches from both "
            f"sides, further designs can exist in at most {most} % of such a gap"
        )
    if gaps := [gap for gap in front.wide if not gap.jump]:
        yield f"wide gap between designs {between(gaps)}: the search reached no design there"


# ---- figure ----


def front_chart(front: ParetoFront) -> Chart:
    """Chart with panels side by side: one for each further objective, over the first objective."""
    first, *others = front.objectives
    panels = [_panel(front, (first, 0), (other, k)) for k, other in enumerate(others, 1)]
    return Chart("Pareto front", panels, height=HEIGHT)


def front_figure(front: ParetoFront) -> Ink:
    """The chart of a front as a separate picture."""
    return titled(front_chart(front))


def _panel(front: ParetoFront, across: tuple[Wish, int], up: tuple[Wish, int]) -> Panel:
    """Panel with the designs of the front, the designs that these dominate, the knee and limits."""
    (x_wish, i), (y_wish, j) = across, up
    xs, ys = _along(front, x_wish), _along(front, y_wish)
    x_range, y_range = _range(xs, x_wish, front), _range(ys, y_wish, front)
    passed = [
        (x_wish.quantity.to_display(values[i]), y_wish.quantity.to_display(values[j]))
        for values in front.passed
    ]
    inside = [
        (x, y) for x, y in passed if x_range[0] <= x <= x_range[1] and y_range[0] <= y <= y_range[1]
    ]
    points = [Points("front", xs, ys, small=True, style=0)]
    if inside:
        words = "dominated designs from the search"
        pale = Points(words, [x for x, _ in inside], [y for _, y in inside], weight="guide")
        points.insert(0, pale)
    if front.knee is not None:
        k = front.knee.index
        metrics = front.points[k].metrics
        values = (value_text(wish.quantity, metrics[wish.metric]) for wish in (x_wish, y_wish))
        words = f"knee: {', '.join(values)}"
        points.append(Points(words, xs[k : k + 1], ys[k : k + 1], weight="strong"))
    line = [Curve("", xs, ys, weight="thin")] if len(front.objectives) == 2 else []
    return Panel(
        f"{_label(y_wish)}, {unit_text(y_wish.quantity.unit)}".rstrip(", "),
        Axis(f"{_label(x_wish)}, {unit_text(x_wish.quantity.unit)}".rstrip(", "), range=x_range),
        Axis(range=y_range),
        line,
        points,
        [*_limits(front, y_wish, y_range), *_limits(front, x_wish, x_range, upright=True)],
    )


def _along(front: ParetoFront, wish: Wish) -> list[float]:
    return [wish.quantity.to_display(point.metrics[wish.metric]) for point in front.points]


def _label(wish: Wish) -> str:
    better = "less" if wish.sense == "min" else "more"
    return f"{wish.metric.replace('_', ' ')} ({better} is better)"


def _range(values: list[float], wish: Wish, front: ParetoFront) -> tuple[float, float]:
    """Range of the axis: covers the designs, free space around them, and limits that lie near."""
    low, high = min(values), max(values)
    span = (high - low) or abs(high) or 1.0
    for row in _required(front, wish):
        level = wish.quantity.to_display(row.limit)
        if low - 0.5 * span <= level <= high + 0.5 * span:
            low, high = min(low, level), max(high, level)
    return low - ROOM * span, high + ROOM * span


def _required(front: ParetoFront, wish: Wish) -> list[Requirement]:
    """Requirements on an objective."""
    return [row for row in front.evaluation.requirements if row.metric == wish.metric]


def _limits(
    front: ParetoFront, wish: Wish, ends: tuple[float, float], *, upright: bool = False
) -> list[Level]:
    """Limits on an objective within its axis."""
    limits = {(wish.quantity.to_display(row.limit), row.sense) for row in _required(front, wish)}
    return [
        Level(level, f"required {trimmed(level)}", sense, upright=upright)
        for level, sense in sorted(limits)
        if ends[0] <= level <= ends[1]
    ]
