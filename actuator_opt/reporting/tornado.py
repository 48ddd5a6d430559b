"""The tornado of an optimum: what -10 % and +10 % of every requirement and parameter change."""

from __future__ import annotations

from ..optimisation.price_words import PER_CENT, display_of, short_name
from ..optimisation.result import Optimisation
from ..optimisation.sensitivity import Sensitivity
from . import text
from .blocks import Block, figure
from .figures import Axes, fitted, ticks
from .ink import BLACK, BLUE, GREY, RED, Ink

MOST = 16
"""Most rows drawn, the largest first."""

LEAST = 1e-5
"""Share of the objective below which a row changes nothing worth drawing."""

ROW = 5.0
"""Height of a row (mm): two bars of 1.8 mm."""

LABELS, FIGURES = 64.0, 34.0
"""Room for the names at the left and the changes in per cent at the right (mm)."""

LIGHT = "#9ec3da"
"""Fill of a decrease; an increase is dark: apart on a grey print too."""

BEYOND = 1.4
"""Most room that predictions take beyond the re-solved changes."""


def drawn(optimisation: Optimisation) -> list[Sensitivity]:
    """The rows worth drawing: ranked as in the table, those without any effect left out."""
    objective = optimisation.objective_value
    least = LEAST * abs(objective)
    rows = [
        row
        for row in optimisation.sensitivities
        if row.effect(objective) > least or any(solved is None for _, _, solved in row.ends)
    ]
    return rows[:MOST]


def block(optimisation: Optimisation) -> Block | None:
    """The tornado with its title, or None where nothing changes anything."""
    rows = drawn(optimisation)
    if not rows:
        return None
    left = len(optimisation.sensitivities) - len(rows)
    rest = f" {left} more change less or nothing." if left else ""
    note = (
        "Bars are solved again, each an optimum of its own; strokes are what the price predicts."
        f" Ranked by the larger bar.{rest}"
    )
    return figure(f"What ±{PER_CENT} % of each changes", tornado(optimisation), note)


def tornado(optimisation: Optimisation, *, width: float = 180.0) -> Ink:
    """Bars of the re-solved objective at +10 % (dark) and -10 % (light) of every row.

    A row without a design at an end says so at the right; predictions beyond the frame end at
    it with an arrow.
    """
    rows, objective = drawn(optimisation), optimisation.objective_value
    quantity = text.metric(optimisation.objective_metric)
    factor = quantity.to_display(1.0) - quantity.to_display(0.0)
    solved = [factor * (v - objective) for row in rows for _, _, v in row.ends if v is not None]
    predicted = [factor * (p - objective) for row in rows for _, p, _ in row.ends if p is not None]
    low, high = _frame(solved, predicted)
    top = 11.0
    ink = Ink(width, top + ROW * len(rows) + 10.0)
    box = (LABELS, top, width - LABELS - FIGURES, ROW * len(rows))
    axes = Axes(ink, box, (low, high), (0.0, 1.0))
    unit = text.unit_text(quantity.unit)
    label = f"change of {quantity.label}" + (f", {unit}" if unit else "")
    places = [(value, text.number(value, 3, signed=True)) for value in ticks(low, high, 8)]
    places = [(value, words.removesuffix(".0")) for value, words in places]
    axes.frame_at("", label, places, [], upright=True)
    _heads(ink, axes, width)
    for index, row in enumerate(rows):
        _row(ink, axes, top + ROW * (index + 0.5), row, objective, factor, width)
    centre = axes.x(0.0)
    ink.line((centre, top - 0.8), (centre, top + ROW * len(rows)), pen=0.25)
    value = text.value_text(quantity, objective)
    ink.text(centre, top - 2.4, f"optimum {value}", size=6.5, anchor="center", bold=True)
    return ink


def _frame(solved: list[float], predicted: list[float]) -> tuple[float, float]:
    """The range of changes drawn: all that was solved, and predictions as far as they are near."""
    low, high = min([0.0, *solved]), max([0.0, *solved])
    span = (high - low) or max(map(abs, predicted), default=0.0) or 1.0
    room = (BEYOND - 1.0) * span / 2
    low = max(min([low, *predicted]), low - room)
    high = min(max([high, *predicted]), high + room)
    return low - 0.03 * (high - low), high + 0.03 * (high - low)


def _heads(ink: Ink, axes: Axes, width: float) -> None:
    """The key of the bars above the names, the heads of the columns of figures."""
    y = axes.top - 6.5
    for x, fill, words in (
        (0.0, BLUE, f"+{PER_CENT} %"),
        (17.0, LIGHT, f"{text.MINUS}{PER_CENT} %"),
    ):
        ink.box(x, y - 0.9, 4.0, 1.8, fill=fill, pen=0.1)
        ink.text(x + 5.2, y, words)
    ink.line((35.0, y - 1.2), (35.0, y + 1.2), pen=0.3, stroke=RED)
    ink.text(36.2, y, "predicted")
    for place, sign in ((width - FIGURES / 2 - 1.0, "+"), (width, text.MINUS)):
        ink.text(place, axes.top - 2.4, f"{sign}{PER_CENT} %", anchor="right", color=GREY)


def _row(
    ink: Ink,
    axes: Axes,
    y: float,
    row: Sensitivity,
    objective: float,
    factor: float,
    width: float,
) -> None:
    limit = text.with_unit(text.trimmed(display_of(row, row.limit)), text.unit_text(row.unit))
    room = LABELS - 3.0
    name = fitted(f"{short_name(row)}  {limit}", room, 6.5)
    ink.text(LABELS - 2.0, y, name, anchor="right", bold=False)
    left, right = axes.left, axes.left + axes.width
    for sign, predicted, solved in row.ends:
        middle = y - sign * 1.0
        if solved is not None:
            a, b = sorted((axes.x(0.0), axes.x(factor * (solved - objective))))
            ink.box(a, middle - 0.9, b - a, 1.8, fill=BLUE if sign > 0 else LIGHT, pen=0.08)
        if predicted is not None and abs(predicted - objective) > LEAST * abs(objective):
            x = axes.x(factor * (predicted - objective))
            if left <= x <= right:
                ink.line((x, middle - 1.2), (x, middle + 1.2), pen=0.3, stroke=RED)
            else:
                edge, inner = (right, right - 2.0) if x > right else (left, left + 2.0)
                ink.arrow((edge, middle), (inner, middle), length=1.5, color=RED)
        place = width - FIGURES / 2 - 1.0 if sign > 0 else width
        if solved is None:
            ink.text(place, y, "no design", anchor="right", color=RED, bold=True, size=6.0)
        else:
            share = 100 * (solved - objective) / abs(objective) if objective else None
            words = "" if share is None else f"{text.number(share, 2, signed=True)} %"
            words = "0" if share is not None and abs(share) < 100 * LEAST else words
            ink.text(place, y, words, anchor="right", color=BLACK)
