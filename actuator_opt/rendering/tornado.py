"""Tornado diagram: changes of a result at both ends of each input's range, largest first."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.dataclass import dataclass
from . import text
from .axes import Axes, fitted, ticks
from .ink import BLACK, BLUE, GREY, RED, Ink

MOST = 16
"""Maximum number of inputs shown; those with the smallest changes are left out."""
ROW = 5.0
"""Height of a row (mm): two bars of 1.8 mm."""
LABELS, FIGURES = 64.0, 34.0
"""Widths of the columns with the names, at the left, and with the changes in figures, at the right
(mm)."""
LIGHT = "#9ec3da"
"""Fill of the bars for the lower end of an input's range. Bars for the upper end are dark, so that
a grey print also shows the difference."""
BEYOND = 1.4
"""To show predicted changes, the axis may be up to this factor longer than the range of the changes
that the bars show."""


@dataclass(frozen=True, slots=True)
class TornadoBar:
    """An input, with the changes of the result (display units) at the two ends of its range.

    The upper end comes first. A predicted change is drawn as a short line. `words` are printed at
    the right, in red if no design exists at that end.
    """

    name: str
    changes: tuple[float | None, float | None]
    words: tuple[str, str]
    predicted: tuple[float | None, float | None] = (None, None)


def bars(
    rows: Sequence[TornadoBar],
    *,
    axis: str,
    centre: str,
    ends: tuple[str, str],
    columns: tuple[str, str] = ("", ""),
    predicted: bool = False,
    width: float = 180.0,
) -> Ink:
    """Draw a bar for each change, dark for the upper and light for the lower end of an input.

    The bars start at a common centre line. The figure is an `Ink` drawing instead of a chart, so
    that the name of each input and the numbers of both changes can be printed beside its bars.

    Parameters
    ----------
    rows : inputs from top to bottom
    axis, centre : words under the axis and above the centre
    ends : names of the upper and the lower end, for the legend
    columns : heads of the words at the right; default: the names of the ends
    predicted : whether the legend explains the short lines of predicted changes
    """
    solved = [change for row in rows for change in row.changes if change is not None]
    predictions = [change for row in rows for change in row.predicted if change is not None]
    low, high = _frame(solved, predictions)
    top = 11.0
    ink = Ink(width, top + ROW * len(rows) + 10.0)
    box = (LABELS, top, width - LABELS - FIGURES, ROW * len(rows))
    axes = Axes(ink, box, (low, high), (0.0, 1.0))
    places = [(value, text.number(value, 3, signed=True)) for value in ticks(low, high, 8)]
    places = [(value, words.removesuffix(".0")) for value, words in places]
    axes.frame_at("", axis, places, [], upright=True)
    _heads(ink, axes, width, ends, columns if any(columns) else ends, predicted)
    for index, row in enumerate(rows):
        _row(ink, axes, top + ROW * (index + 0.5), row, width)
    middle = axes.x(0.0)
    ink.line((middle, top - 0.8), (middle, top + ROW * len(rows)), pen=0.25)
    ink.text(middle, top - 2.4, centre, size=6.5, anchor="center", bold=True)
    return ink


def _frame(solved: list[float], predicted: list[float]) -> tuple[float, float]:
    """Range of the axis: all changes shown as bars, and predicted changes not far beyond them."""
    low, high = min([0.0, *solved]), max([0.0, *solved])
    span = (high - low) or max(map(abs, predicted), default=0.0) or 1.0
    room = (BEYOND - 1.0) * span / 2
    low = max(min([low, *predicted]), low - room)
    high = min(max([high, *predicted]), high + room)
    return low - 0.03 * (high - low), high + 0.03 * (high - low)


def _heads(
    ink: Ink,
    axes: Axes,
    width: float,
    ends: tuple[str, str],
    columns: tuple[str, str],
    predicted: bool,
) -> None:
    """The legend of the bars, above the names, and the heads of the columns at the right."""
    y = axes.top - 6.5
    for x, fill, words in ((0.0, BLUE, ends[0]), (17.0, LIGHT, ends[1])):
        ink.box(x, y - 0.9, 4.0, 1.8, fill=fill, pen=0.1)
        ink.text(x + 5.2, y, words)
    if predicted:
        ink.line((35.0, y - 1.2), (35.0, y + 1.2), pen=0.3, stroke=RED)
        ink.text(36.2, y, "predicted")
    for place, words in zip((width - FIGURES / 2 - 1.0, width), columns, strict=True):
        ink.text(place, axes.top - 2.4, words, anchor="right", color=GREY)


def _row(ink: Ink, axes: Axes, y: float, row: TornadoBar, width: float) -> None:
    name = fitted(row.name, LABELS - 3.0, 6.5)
    ink.text(LABELS - 2.0, y, name, anchor="right", bold=False)
    left, right = axes.left, axes.left + axes.width
    for end, x in enumerate((width - FIGURES / 2 - 1.0, width)):
        change, predicted, words = row.changes[end], row.predicted[end], row.words[end]
        middle = y - (1.0 if end == 0 else -1.0)
        if change is not None:
            a, b = sorted((axes.x(0.0), axes.x(change)))
            ink.box(a, middle - 0.9, b - a, 1.8, fill=LIGHT if end else BLUE, pen=0.08)
        if predicted is not None:
            at = axes.x(predicted)
            if left <= at <= right:
                ink.line((at, middle - 1.2), (at, middle + 1.2), pen=0.3, stroke=RED)
            else:
                edge, inner = (right, right - 2.0) if at > right else (left, left + 2.0)
                ink.arrow((edge, middle), (inner, middle), length=1.5, color=RED)
        if change is None and words:
            ink.text(x, y, words, anchor="right", color=RED, bold=True, size=6.0)
        elif change is not None:
            ink.text(x, y, words, anchor="right", color=BLACK)
