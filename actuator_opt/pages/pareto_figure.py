"""A Pareto front as ink: designs, the knee, dominated ones lighter, requirement limits."""

from __future__ import annotations

from ..optimisation.pareto_result import ParetoFront, Wish
from ..rendering.axes import Axes, even_ticks
from ..rendering.ink import BLUE, GREY, PALE, RED, WHITE, Ink, text_width
from ..rendering.text import trimmed, unit_text, value_text

WIDTH, HEIGHT = 180.0, 82.0
ROOM = 0.06
"""Share of the range left free around the designs."""


def front_figure(found: ParetoFront) -> Ink:
    """The first objective over every other one, side by side."""
    ink = Ink(WIDTH, HEIGHT)
    first, *others = found.objectives
    wide = (WIDTH - 4.0) / len(others)
    for k, other in enumerate(others):
        box = (16.0 + k * wide, 12.0, wide - 18.0, HEIGHT - 24.0)
        _panel(ink, box, found, (first, 0), (other, k + 1))
    if any(mark.get("fill") == PALE for mark in ink.marks):
        words = "grey: designs passed on the way, which others better"
        ink.text(WIDTH - 2.0, HEIGHT - 1.6, words, size=6.0, anchor="right", color=GREY)
    return ink


def _panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    found: ParetoFront,
    across: tuple[Wish, int],
    up: tuple[Wish, int],
) -> None:
    (x_wish, i), (y_wish, j) = across, up
    xs, ys = _values(found, x_wish), _values(found, y_wish)
    axes = Axes(ink, box, _range(xs, x_wish, found), _range(ys, y_wish, found))
    axes.frame_at(
        "",
        f"{_label(x_wish)}, {unit_text(x_wish.quantity.unit)}".rstrip(", "),
        even_ticks(*axes.x_range, max(3, int(box[2] / 18.0))),
        even_ticks(*axes.y_range, 5),
        upright=True,
    )
    title = f"{_label(y_wish)}, {unit_text(y_wish.quantity.unit)}".rstrip(", ")
    ink.text(box[0] - 12.0, box[1] - 6.0, title, size=7.0, bold=True)
    for values in found.passed:
        x, y = x_wish.quantity.to_display(values[i]), y_wish.quantity.to_display(values[j])
        if _inside(axes, x, y):
            ink.circle(axes.x(x), axes.y(y), 0.7, fill=PALE, stroke=None)
    _limits(axes, found, x_wish, y_wish)
    if len(found.objectives) == 2:
        line = [(axes.x(x), axes.y(y)) for x, y in zip(xs, ys, strict=True)]
        ink.path([line], stroke=BLUE, pen=0.2)
    for x, y in zip(xs, ys, strict=True):
        ink.circle(axes.x(x), axes.y(y), 0.65, fill=BLUE, stroke=WHITE, pen=0.08)
    if found.knee is not None:
        _knee(axes, found, xs, ys, (x_wish, y_wish))


def _values(found: ParetoFront, wish: Wish) -> list[float]:
    return [wish.quantity.to_display(point.metrics[wish.metric]) for point in found.points]


def _label(wish: Wish) -> str:
    better = "less" if wish.sense == "min" else "more"
    return f"{wish.metric.replace('_', ' ')} ({better} is better)"


def _range(values: list[float], wish: Wish, found: ParetoFront) -> tuple[float, float]:
    """The designs' own range with room, and a limit of the objective that is near it."""
    low, high = min(values), max(values)
    span = (high - low) or abs(high) or 1.0
    for row in _rows(found, wish):
        level = wish.quantity.to_display(row)
        if low - 0.5 * span <= level <= high + 0.5 * span:
            low, high = min(low, level), max(high, level)
    return low - ROOM * span, high + ROOM * span


def _rows(found: ParetoFront, wish: Wish) -> list[float]:
    return [row.limit for row in found.evaluation.requirements if row.metric == wish.metric]


def _inside(axes: Axes, x: float, y: float) -> bool:
    (left, right), (low, high) = axes.x_range, axes.y_range
    return left <= x <= right and low <= y <= high


def _limits(axes: Axes, found: ParetoFront, x_wish: Wish, y_wish: Wish) -> None:
    """Limits of the requirements on both objectives, dashed, their words inside the frame."""
    right, bottom = axes.left + axes.width, axes.top + axes.height
    for row in sorted(set(_rows(found, y_wish))):
        level = y_wish.quantity.to_display(row)
        if axes.y_range[0] <= level <= axes.y_range[1]:
            y = axes.y(level)
            axes.ink.line((axes.left, y), (right, y), stroke=RED, pen=0.25, dash=(1.8, 1.0))
            words = f"required {trimmed(level)}"
            above = y - 2.0 if y - axes.top > 5.0 else y + 2.4
            axes.ink.text(right - 1.0, above, words, color=RED, anchor="right", halo=True)
    for row in sorted(set(_rows(found, x_wish))):
        level = x_wish.quantity.to_display(row)
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
    axes: Axes, found: ParetoFront, xs: list[float], ys: list[float], wished: tuple[Wish, Wish]
) -> None:
    """The knee, larger, with its numbers on the side of the front that is empty."""
    assert found.knee is not None
    k = found.knee.index
    x, y = axes.x(xs[k]), axes.y(ys[k])
    axes.ink.circle(x, y, 1.5, fill=WHITE, stroke=RED, pen=0.4)
    axes.ink.circle(x, y, 0.65, fill=RED, stroke=None)
    metrics = found.points[k].metrics
    words = ", ".join(value_text(one.quantity, metrics[one.metric]) for one in wished)
    words = f"knee: {words}"
    right = axes.left + axes.width
    if len(found.objectives) > 2:  # designs all around: above the frame
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
