"""The page of a Pareto front: its designs, the knee, what was checked, and its figure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from ..base.quantities import Quantity
from ..design import quantity_of
from ..evaluation.result import count_words
from ..optimisation.front.plane import FrontGap
from ..optimisation.pareto import ParetoFront, Wish
from ..rendering import text
from ..rendering.axes import Axes, even_ticks
from ..rendering.blocks import Block, Column, Notes, Page, State, Table, Tile, Verdict, short, tile
from ..rendering.ink import BLUE, GREY, PALE, RED, WHITE, Ink, text_width
from ..rendering.series import Series, heading
from ..rendering.text import trimmed, unit_text, value_text
from .report import doubts

SHOWN, FEWER = 21, 17
"""Designs in the table of two objectives, and of more, whose heads take more lines."""
MOVING = 5
"""Most variables in the table."""

WIDTH, HEIGHT = 180.0, 82.0
"""Size of the figure [mm]."""
ROOM = 0.06
"""Share of the range left free around the designs."""


def page(front: ParetoFront) -> Page:
    """The page of a Pareto front; without designs it says why there is none."""
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
        hero=lambda room: front_figure(front),
        blocks=list(_blocks(front)),
    )


def series(front: ParetoFront) -> list[Series]:
    """Every design of a front as columns in the units people read."""
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
    """The numbers that say whether a front repeats (SI): the objectives of every design."""
    values = {
        f"{objective.metric} of design {k}": point.metrics[objective.metric]
        for k, point in enumerate(front.points, 1)
        for objective in front.objectives
    }
    return {"status": front.status, "metrics": values}


def verdict(front: ParetoFront) -> Verdict:
    """That requirements are met, and what to doubt of the design that was evaluated in full."""
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
    """Designs of the table: those with a role, and others evenly between."""
    most = SHOWN if len(front.objectives) == 2 else FEWER
    last = len(front.points) - 1
    if last < most:
        return list(range(last + 1))
    named = {k for k in range(last + 1) if _role(front, k)}
    even = {round(k * last / (most - 1)) for k in range(most)} - named
    close = sorted(even, key=lambda k: min(abs(k - other) for other in named))
    return sorted(named | set(close[len(named | even) - most :]))


def _role(front: ParetoFront, k: int) -> str:
    """The best design of an objective or the knee; empty for others."""
    if front.knee is not None and front.knee.index == k:
        return "knee"
    for objective in front.objectives:
        values = [point.metrics[objective.metric] for point in front.points]
        if values[k] == (min(values) if objective.sense == "min" else max(values)):
            return f"{'least' if objective.sense == 'min' else 'most'} {objective.metric}"
    return ""


def _moving(front: ParetoFront) -> list[str]:
    """Variables that move most along the front, relative to their mean."""

    def span(path: str) -> float:
        values = [point.variables[path] for point in front.points]
        middle = sum(map(abs, values)) / len(values)
        return (max(values) - min(values)) / middle if middle else 0.0

    paths = sorted(front.points[0].variables, key=span, reverse=True)
    return [path for path in paths if span(path) > 1e-3][:MOVING]


def _evaluated(front: ParetoFront) -> str:
    """The design that was evaluated in full."""
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
    note = f"{more} more designs between these." if more else ""
    yield Table("Designs of the front", columns, body, note=note)
    yield Notes("How far to trust it", [text.pretty(line) for line in remarks(front)])


def remarks(front: ParetoFront) -> list[str]:
    """How even the front is, its knee, and what to doubt."""
    said = []
    if front.evenness is not None and len(front.points) > 2:
        said.append(
            f"largest gap between neighbours {text.number(front.evenness, 3)} times the median, "
            f"in objectives over their range" + (", jumps left out" if front.jumps else "")
        )
    said += _wide(front)
    if front.knee is not None:
        said.append(f"knee: design {front.knee.index + 1}, where the front bends most")
    elif len(front.points) > 1:
        said.append("no knee: the front nowhere bends towards the ideal")
    worst = max(point.kkt_residual for point in front.points)
    said.append(f"optimality conditions hold to {text.number(worst, 2)} at every design")
    if tight := len(front.evaluation.tight):
        said.append(
            f"{_evaluated(front)}: {count_words(tight)}; `actuator-opt uncertainty` gives the "
            "yield of a design"
        )
    return [*said, *front.warnings]


def _wide(front: ParetoFront) -> Iterator[str]:
    """Which gaps are wide, and why."""

    def between(gaps: Sequence[FrontGap]) -> str:
        return ", ".join(f"{gap.after + 1} and {gap.after + 2}" for gap in gaps)

    if jumps := front.jumps:
        most = text.number(100 * max(gap.reach / gap.size for gap in jumps), 2)
        yield (
            f"the front jumps between designs {between(jumps)}: by the designs at levels on both "
            f"sides at most {most} % of such a gap can hold more of it"
        )
    if rest := [gap for gap in front.wide if not gap.jump]:
        yield f"wide gap between designs {between(rest)}: no design found there"


# ---- figure ----


def front_figure(front: ParetoFront) -> Ink:
    """The first objective over every other one, side by side."""
    ink = Ink(WIDTH, HEIGHT)
    first, *others = front.objectives
    wide = (WIDTH - 4.0) / len(others)
    for k, other in enumerate(others):
        box = (16.0 + k * wide, 12.0, wide - 18.0, HEIGHT - 24.0)
        _panel(ink, box, front, (first, 0), (other, k + 1))
    if any(mark.get("fill") == PALE for mark in ink.marks):
        words = "grey: dominated designs that the search visited"
        ink.text(WIDTH - 2.0, HEIGHT - 1.6, words, size=6.0, anchor="right", color=GREY)
    return ink


def _panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    front: ParetoFront,
    across: tuple[Wish, int],
    up: tuple[Wish, int],
) -> None:
    (x_wish, i), (y_wish, j) = across, up
    xs, ys = _along(front, x_wish), _along(front, y_wish)
    axes = Axes(ink, box, _range(xs, x_wish, front), _range(ys, y_wish, front))
    axes.frame_at(
        "",
        f"{_label(x_wish)}, {unit_text(x_wish.quantity.unit)}".rstrip(", "),
        even_ticks(*axes.x_range, max(3, int(box[2] / 18.0))),
        even_ticks(*axes.y_range, 5),
        upright=True,
    )
    title = f"{_label(y_wish)}, {unit_text(y_wish.quantity.unit)}".rstrip(", ")
    ink.text(box[0] - 12.0, box[1] - 6.0, title, size=7.0, bold=True)
    for values in front.passed:
        x, y = x_wish.quantity.to_display(values[i]), y_wish.quantity.to_display(values[j])
        if _inside(axes, x, y):
            ink.circle(axes.x(x), axes.y(y), 0.7, fill=PALE, stroke=None)
    _limits(axes, front, x_wish, y_wish)
    if len(front.objectives) == 2:
        line = [(axes.x(x), axes.y(y)) for x, y in zip(xs, ys, strict=True)]
        ink.path([line], stroke=BLUE, pen=0.2)
    for x, y in zip(xs, ys, strict=True):
        ink.circle(axes.x(x), axes.y(y), 0.65, fill=BLUE, stroke=WHITE, pen=0.08)
    if front.knee is not None:
        _knee(axes, front, xs, ys, (x_wish, y_wish))


def _along(front: ParetoFront, wish: Wish) -> list[float]:
    return [wish.quantity.to_display(point.metrics[wish.metric]) for point in front.points]


def _label(wish: Wish) -> str:
    better = "less" if wish.sense == "min" else "more"
    return f"{wish.metric.replace('_', ' ')} ({better} is better)"


def _range(values: list[float], wish: Wish, front: ParetoFront) -> tuple[float, float]:
    """The designs' own range with room, and a limit of the objective that is near it."""
    low, high = min(values), max(values)
    span = (high - low) or abs(high) or 1.0
    for limit in _required(front, wish):
        level = wish.quantity.to_display(limit)
        if low - 0.5 * span <= level <= high + 0.5 * span:
            low, high = min(low, level), max(high, level)
    return low - ROOM * span, high + ROOM * span


def _required(front: ParetoFront, wish: Wish) -> list[float]:
    """Limits on an objective (SI)."""
    return [row.limit for row in front.evaluation.requirements if row.metric == wish.metric]


def _inside(axes: Axes, x: float, y: float) -> bool:
    (left, right), (low, high) = axes.x_range, axes.y_range
    return left <= x <= right and low <= y <= high


def _limits(axes: Axes, front: ParetoFront, x_wish: Wish, y_wish: Wish) -> None:
    """Limits of the requirements on both objectives, dashed, their words inside the frame."""
    right, bottom = axes.left + axes.width, axes.top + axes.height
    for limit in sorted(set(_required(front, y_wish))):
        level = y_wish.quantity.to_display(limit)
        if axes.y_range[0] <= level <= axes.y_range[1]:
            y = axes.y(level)
            axes.ink.line((axes.left, y), (right, y), stroke=RED, pen=0.25, dash=(1.8, 1.0))
            words = f"required {trimmed(level)}"
            above = y - 2.0 if y - axes.top > 5.0 else y + 2.4
            axes.ink.text(right - 1.0, above, words, color=RED, anchor="right", halo=True)
    for limit in sorted(set(_required(front, x_wish))):
        level = x_wish.quantity.to_display(limit)
        if axes.x_range[0] <= level <= axes.x_range[1]:
            x = axes.x(level)
            axes.ink.line((x, axes.top), (x, bottom), stroke=RED, pen=0.25, dash=(1.8, 1.0))
            words = f"required {trimmed(level)}"
            left = x - axes.left < axes.width / 2
            axes.ink.text(
                x + (1.0 if left else -1.0), axes.top + 2.4, words, color=RED,
                anchor="left" if left else "right", halo=True,
            )  # fmt: skip


def _knee(
    axes: Axes, front: ParetoFront, xs: list[float], ys: list[float], wished: tuple[Wish, Wish]
) -> None:
    """The knee, larger, with its numbers on the side of the front that is empty."""
    assert front.knee is not None
    k = front.knee.index
    x, y = axes.x(xs[k]), axes.y(ys[k])
    axes.ink.circle(x, y, 1.5, fill=WHITE, stroke=RED, pen=0.4)
    axes.ink.circle(x, y, 0.65, fill=RED, stroke=None)
    metrics = front.points[k].metrics
    words = ", ".join(value_text(wish.quantity, metrics[wish.metric]) for wish in wished)
    words = f"knee: {words}"
    right = axes.left + axes.width
    if len(front.objectives) > 2:  # designs all around: above the frame
        axes.ink.text(right, axes.top - 2.0, words, anchor="right", color=GREY)
        return
    inside = wished[0].sense == "min"  # the ideal lies left: the right is free
    room = text_width(words, 6.5) + 4.0
    leftward = not inside if right - x > room else True
    down = 3.4 if wished[1].sense == "max" else -3.4
    place = x - 3.0 if leftward else x + 3.0
    axes.ink.text(
        place, y + down, words, anchor="right" if leftward else "left", halo=True, color=GREY
    )
