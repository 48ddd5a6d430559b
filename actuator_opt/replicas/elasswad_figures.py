"""Figure 10 of [ElAsswad2018] as ink: stiffness and radial expansion along a pressure record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..rendering.axes import Axes
from ..rendering.ink import BLUE, GREEN, GREY, OCHRE, PALE, Ink, spread_within
from ..rendering.text import number
from .elasswad_models import Along, StrokeRecord

DESIGNED: dict[str, Any] = {"stroke": BLUE, "pen": 0.45}

CORRECTED: dict[str, Any] = {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)}

PUBLISHED: dict[str, Any] = {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)}

_LABEL = 6.8
"""Height (mm) of a label of two lines."""


@dataclass(frozen=True, slots=True)
class _Line:
    """A curve over time with its two-line label, placed at the value `at`."""

    values: Sequence[float]
    style: dict[str, Any]
    label: tuple[str, str]
    at: float


def _at_peak(values: Array, scale: float, style: dict[str, Any], words: str, unit: str) -> _Line:
    """A curve named at its largest value."""
    scaled = [float(value) * scale for value in values]
    peak = max(scaled)
    return _Line(scaled, style, (words, f"{number(peak)} {unit}"), peak)


def _at_end(values: Array, scale: float, style: dict[str, Any], words: str, unit: str) -> _Line:
    """A curve named where it ends, with its range."""
    scaled = [float(value) * scale for value in values]
    ends = f"{number(min(scaled), 3)} to {number(max(scaled), 3)} {unit}"
    return _Line(scaled, style, (words, ends), scaled[-1])


def _panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    title: str,
    time: Sequence[float],
    lines: Sequence[_Line],
) -> Axes:
    """Draw curves over time with labels at the right; the piston's reversal is marked."""
    lines = [line for line in lines if all(math.isfinite(v) for v in line.values)]
    top = max([v for line in lines for v in line.values], default=1.0) or 1.0
    axes = Axes(ink, box, (time[0], time[-1]), (0.0, 1.08 * top))
    right, bottom = box[0] + box[2], box[1] + box[3]
    turn = axes.x((time[0] + time[-1]) / 2)
    ink.line((turn, box[1]), (turn, bottom), stroke=PALE, pen=0.25)
    axes.frame(title, "time, s")
    for line in lines:
        ink.path(axes.clipped(time, line.values), **line.style)
    order = sorted(lines, key=lambda line: -line.at)
    places = spread_within(
        [axes.y(line.at) for line in order], [_LABEL] * (len(order) - 1), box[1], bottom - 1.0
    )
    for line, y in zip(order, places, strict=True):
        level, color = axes.y(line.at), line.style["stroke"]
        start = next(k for k in reversed(range(len(time))) if line.values[k] >= 0.999 * line.at)
        ink.line(
            (axes.x(time[start]), level), (right, level), (right + 2.5, y), pen=0.13, stroke=GREY
        )
        ink.text(right + 3.2, y - 1.5, line.label[0], size=6.5, color=color)
        ink.text(right + 3.2, y + 1.5, line.label[1], size=6.5, color=color)
    return axes


def record_figure(record: StrokeRecord, along: Along, *, width: float = 180.0) -> Ink:
    """Pressure and radial expansion (above), and k_eq as published and as derived (below)."""
    panel, height, row = 48.0, 33.0, 53.0
    ink = Ink(width, 2 * row)
    time = [float(t) for t in record.time]
    left, right = 10.0, width / 2 + 11.0
    average = float(record.pressure[:-1].mean()) * 1e-6
    axes = _panel(
        ink,
        (left, 9.0, panel, height),
        "Pressure difference of the record, MPa",
        time,
        [
            _at_peak(record.pressure, 1e-6, DESIGNED, "largest", "MPa"),
            _Line(
                [average] * len(time),
                {"stroke": GREY, "pen": 0.25, "dash": (0.6, 0.6)},
                ("average", f"{number(average)} MPa"),
                average,
            ),
        ],
    )
    for share, words in ((0.25, "out"), (0.75, "back")):
        x = axes.x(share * time[-1])
        ink.text(x, axes.y(0.0) - 2.5, words, anchor="center", color=GREY, halo=True)
    _panel(
        ink,
        (right, 9.0, panel, height),
        "Radial expansion of the bore, µm",
        time,
        [
            _at_peak(along.growth_published, 1e6, PUBLISHED, "eq. 12", "µm"),
            _at_peak(along.growth_inner, 1e6, CORRECTED, "with the inner radius", "µm"),
            _at_peak(along.growth_designed, 1e6, DESIGNED, "as designed", "µm"),
        ],
    )
    _panel(
        ink,
        (left, 9.0 + row, panel, height),
        "k_eq as published, N/mm",
        time,
        [_at_peak(along.stiffness_published, 1e-3, PUBLISHED, "eq. 7, 10–12", "N/mm")],
    )
    _panel(
        ink,
        (right, 9.0 + row, panel, height),
        "k_eq per chamber, kN/mm",
        time,
        [
            _at_end(along.stiffness_designed, 1e-6, DESIGNED, "as designed", "kN/mm"),
            _at_end(along.stiffness_chambers, 1e-6, CORRECTED, "the paper's numbers", "kN/mm"),
            _at_end(along.stiffness_published, 1e-6, PUBLISHED, "eq. 7, 10–12", "kN/mm"),
        ],
    )
    return ink
