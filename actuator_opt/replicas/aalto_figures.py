"""Figures 5, 29, 32 and 42 of [AaltoThesis] and its dynamic tests as ink.

Curves differ in dash as well as in colour; their labels are beside the frame.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..rendering import text
from ..rendering.axes import Axes
from ..rendering.ink import BLACK, BLUE, GREEN, GREY, OCHRE, PALE, Ink, Point, spread_within
from ..rendering.text import DASH, trimmed
from .aalto_models import (
    FREQUENCIES,
    PAPER,
    DynamicTest,
    End,
    StaticTest,
    StiffnessResponse,
    Theory,
)

Style: TypeAlias = dict[str, Any]

FULL: Style = {"stroke": BLUE, "pen": 0.45}

DASHED: Style = {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)}

CHAIN: Style = {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)}

DOTTED: Style = {"stroke": GREY, "pen": 0.4, "dash": (0.5, 0.6)}

THIN: Style = {"stroke": BLACK, "pen": 0.2, "dash": (3.2, 0.9)}

_BAND = "#e9eef2"

_POSITION = "piston position from the cap end, mm"

_COLUMNS, _PANEL, _HEIGHT, _ROW, _TOP = (10.0, 101.0), 50.0, 36.0, 56.0, 9.0

_LABEL = 3.2
"""Height (mm) of a line of a label."""


@dataclass(frozen=True, slots=True)
class LabelledCurve:
    """A curve with the lines of its label; NaN interrupts it."""

    xs: Sequence[float]
    ys: Sequence[float]
    style: Style
    label: tuple[str, ...]


def curve(xs: Array, ys: Array, style: Style, *label: str) -> LabelledCurve:
    """A curve over arrays."""
    return LabelledCurve([float(x) for x in xs], [float(y) for y in ys], style, label)


def _unbroken(curve: LabelledCurve) -> list[tuple[list[float], list[float]]]:
    """Parts of a curve between its gaps."""
    pairs = [
        list(group)
        for finite, group in itertools.groupby(
            zip(curve.xs, curve.ys, strict=True), key=lambda pair: math.isfinite(pair[1])
        )
        if finite
    ]
    return [([x for x, _ in group], [y for _, y in group]) for group in pairs]


CurveEnd: TypeAlias = tuple[Point, Style, tuple[str, ...]]
"""End of a curve on the paper, with its style and the lines of its label."""


def draw_curves(
    ink: Ink,
    axes: Axes,
    curves: Sequence[LabelledCurve],
    frame: tuple[float, float, float],
    others: Sequence[CurveEnd] = (),
) -> None:
    """Draw curves with labels to the right of a frame, together with labels of `others`."""
    right, top, bottom = frame
    ends = list(others)
    for drawn in curves:
        lines = [line for xs, ys in _unbroken(drawn) for line in axes.clipped(xs, ys)]
        ink.path(lines, **drawn.style)
        if lines:
            ends.append((lines[-1][-1], drawn.style, drawn.label))
    ends.sort(key=lambda end: end[0][1])
    heights = [_LABEL * len(label) for *_, label in ends]
    gaps = [(a + b) / 2 + 0.6 for a, b in itertools.pairwise(heights)]
    levels = spread_within([end[1] for end, *_ in ends], gaps, top, bottom + 3.0)
    for (end, style, label), height, y in zip(ends, heights, levels, strict=True):
        ink.line(end, (right + 1.0, end[1]), (right + 3.0, y), pen=0.13, stroke=GREY)
        for k, words in enumerate(label):
            level = y - height / 2 + _LABEL * (k + 0.5)
            ink.text(right + 3.6, level, words, size=6.5, color=style["stroke"])


def _panel(
    ink: Ink,
    place: tuple[int, int],
    title: str,
    x_label: str,
    curves: Sequence[LabelledCurve],
    *,
    span: tuple[float, float],
    top: float,
    band: tuple[float, float] | None = None,
    mark: float | None = None,
) -> None:
    """Draw curves in a frame at a (row, column), each labelled at its last visible point."""
    row, column = place
    box = (_COLUMNS[column], _TOP + row * _ROW, _PANEL, _HEIGHT)
    axes = Axes(ink, box, span, (0.0, top))
    right, bottom = box[0] + box[2], box[1] + box[3]
    if band is not None:
        high = axes.y(min(band[1], top))
        ink.box(box[0], high, box[2], axes.y(band[0]) - high, fill=_BAND, stroke=None)
    if mark is not None:
        ink.line((axes.x(mark), box[1]), (axes.x(mark), bottom), stroke=PALE, pen=0.25)
    axes.frame(title, x_label)
    measured: list[CurveEnd] = []
    if band is not None:
        middle = (right, axes.y(sum(band) / 2))
        measured = [(middle, {"stroke": GREY}, ("measured", _between(band)))]
    draw_curves(ink, axes, curves, (right, box[1], bottom), measured)


def _between(band: tuple[float, float]) -> str:
    """A measured range in mm, as the thesis prints it."""
    return f"{band[0]:.2f}{DASH}{band[1]:.2f} mm"


def _weakest(theory: Theory, per_chamber: bool) -> str:
    values = theory.per_chamber if per_chamber else theory.published
    return f"min. {trimmed(float(np.min(values)) / 1e6)} kN/mm"


def theory_figure(
    stroke: float,
    oil: Sequence[tuple[str, Theory]],
    figure_29: Theory,
    figure_32: Theory,
    *,
    width: float = 180.0,
) -> Ink:
    """Figures 5, 29 and 32 along the stroke, and the excess of the printed series totals."""
    ink = Ink(width, 2 * _ROW)

    span = (0.0, 1e3 * stroke)

    def millimetres(theory: Theory) -> Array:
        return 1e3 * theory.position

    curves = [
        curve(millimetres(theory), theory.published / 1e6, style, words, _weakest(theory, False))
        for (words, theory), style in zip(oil, (DASHED, FULL, CHAIN), strict=False)
    ]
    title = "Figure 5: oil alone, kN/mm"
    _panel(ink, (0, 0), title, _POSITION, curves, span=span, top=100.0)
    for place, title, theory, equation in (
        ((0, 1), "Figure 29: pipes, K 1600 MPa, kN/mm", figure_29, "eq. 37"),
        ((1, 0), "Figure 32: hoses, K 1300 MPa, kN/mm", figure_32, "eq. 38"),
    ):
        most = float(max(theory.published.max(), theory.per_chamber.max())) / 1e6
        _panel(
            ink,
            place,
            title,
            _POSITION,
            [
                curve(
                    millimetres(theory),
                    theory.published / 1e6,
                    DASHED,
                    equation,
                    _weakest(theory, False),
                ),
                curve(
                    millimetres(theory),
                    theory.per_chamber / 1e6,
                    FULL,
                    "per chamber",
                    _weakest(theory, True),
                ),
            ],
            span=span,
            top=1.08 * most,
        )
    excess = [
        curve(millimetres(theory), 100 * (theory.published / theory.per_chamber - 1), style, words)
        for theory, style, words in ((figure_29, DASHED, "eq. 37"), (figure_32, CHAIN, "eq. 38"))
    ]
    highest = max(max(curve.ys) for curve in excess)
    title = "Excess of printed form over per chamber, %"
    _panel(ink, (1, 1), title, _POSITION, excess, span=span, top=1.08 * highest)
    return ink


def static_figure(stroke: float, test: StaticTest, *, width: float = 180.0) -> Ink:
    """Displacement over position for every assumption, with the measured range."""
    ink = Ink(width, _ROW)
    styles = (FULL, DASHED, THIN, CHAIN, DOTTED)
    for column, words, load, band in (
        (0, "up", sum(PAPER.load_up) / 2, PAPER.moved_up),
        (1, "down", sum(PAPER.load_down) / 2, PAPER.moved_down),
    ):
        curves = []
        for assumption, style in zip(test.assumptions[1:], styles, strict=True):
            moved = (assumption.up if words == "up" else assumption.down).displacement
            label = assumption.name.split(", ")
            tail = [label[0] + ",", *label[1:]] if len(label) > 1 else label
            curves.append(curve(1e3 * test.position, 1e3 * moved, style, *tail))
        _panel(
            ink,
            (0, column),
            f"Displacement, {trimmed(load / 1e3)} kN {words}, mm",
            _POSITION,
            curves,
            span=(0.0, 1e3 * stroke),
            top=0.55,
            band=(1e3 * band[0], 1e3 * band[1]),
        )
    return ink


def _throttle(opening: float) -> str:
    return f"throttle {100 * (1 - opening):.0f} %"


def dynamic_figure(test: DynamicTest, *, width: float = 180.0) -> Ink:
    """Dynamic stiffness over frequency for every throttle, with and without the valve."""
    ink = Ink(width, 2 * _ROW)
    columns: tuple[tuple[End, str], ...] = (
        ("constant_pressure", "constant line pressure"),
        ("reducing_valve", "reducing valve, ours"),
    )
    needles: tuple[tuple[str, dict[End, tuple[StiffnessResponse, ...]]], ...] = (
        (area_text(test.area), test.stated),
        (area_text(test.needle.area), test.read_back),
    )
    for row, (needle, by_end) in enumerate(needles):
        for column, (end, words) in enumerate(columns):
            curves = [
                curve(FREQUENCIES, np.abs(response.over) / 1e6, style, _throttle(response.opening))
                for response, style in zip(by_end[end], (FULL, DASHED, CHAIN), strict=True)
            ]
            shut = np.abs(test.closed.over) / 1e6
            curves.append(curve(FREQUENCIES, shut, THIN, "throttle 100 %"))
            static = np.full(FREQUENCIES.shape, test.static / 1e6)
            curves.append(curve(FREQUENCIES, static, DOTTED, "static, with hoses"))
            most = max(max(curve.ys) for curve in curves)
            _panel(
                ink,
                (row, column),
                f"kN/mm, {words}, needle {needle}",
                "loading frequency, Hz",
                curves,
                span=(0.0, float(FREQUENCIES[-1])),
                top=1.08 * most,
                mark=PAPER.peak,
            )
    return ink


def area_text(area: float) -> str:
    """Area of a needle."""
    return f"{text.trimmed(1e4 * area, 2)} cm²"
