"""Stiffness over the stroke of the best designs of a sweep, and their differences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...base.errors import Diagnostic, InputError
from ...base.numeric import Array
from ...evaluation import evaluate
from ...evaluation.result import StrokeCurve
from ...rendering.blocks import Chart
from ...rendering.chart import Axis, Curve, Level, Panel
from ...rendering.chart_ink import titled
from ...rendering.ink import Ink
from ...rendering.text import margin_text, trimmed
from .shared import SweepFigure, SweepFigureData, fits, value_words

MOST = 6
"""Largest number of curves (our choice: more are hard to distinguish)."""
SHARE = 0.3
"""Height of the panel of differences, as a share of the chart."""


class Required(NamedTuple):
    """A required stiffness [N/m], and its label in the figure."""

    stiffness: float
    words: str


def stiffness_panels(
    curves: Sequence[StrokeCurve],
    labels: Sequence[str],
    required: Sequence[Required],
    first: str,
) -> list[Panel]:
    """At most `MOST` curves with their labels (``name: remark``), above their differences.

    `first` is the name of the first curve, to which the differences refer. Curves of similar
    designs nearly coincide, so the differences are drawn to separate them. At least one curve must
    have a finite point.
    """
    points = [_points(curve) for curve in curves[:MOST]]
    label = "piston position from the cap end, mm"
    drawn = [
        Curve(words.partition(":")[0], xs, ys, style=k, end=words)
        for k, ((xs, ys), words) in enumerate(zip(points, labels, strict=False))
    ]
    levels = [Level(limit.stiffness / 1e6, limit.words, "min") for limit in required]
    y = Axis(range=_range(points, [level.value for level in levels]))
    if len(points) < 2:
        return [Panel("Axial stiffness, kN/mm", Axis(label), y, drawn, levels=levels)]
    return [
        Panel("Axial stiffness, kN/mm", y=y, curves=drawn, levels=levels, share=1 - SHARE),
        Panel(f"Difference from {first}, %", Axis(label), curves=differences(points), share=SHARE),
    ]


def has_points(curve: StrokeCurve) -> bool:
    """Whether a curve has any finite point."""
    return bool(np.isfinite(curve.stiffness).any())


def differences(curves: Sequence[tuple[Array, Array]]) -> list[Curve]:
    """Difference of each curve from the first [%], at positions that both have."""
    places, stiffness = curves[0]
    compared = []
    for k, (xs, ys) in enumerate(curves):
        both = np.zeros(len(xs), dtype=bool)
        if len(places):
            both = (xs >= places.min()) & (xs <= places.max())
        beside = np.interp(xs[both], places, stiffness) if both.any() else ys[both]
        compared.append(Curve("", xs[both], 100.0 * (ys[both] / beside - 1.0), style=k))
    return compared


def _points(curve: StrokeCurve) -> tuple[Array, Array]:
    """Positions [mm] and stiffness [kN/mm] of the points with a finite stiffness."""
    known = np.isfinite(curve.stiffness)
    return 1e3 * np.asarray(curve.position)[known], np.asarray(curve.stiffness)[known] / 1e6


def _range(curves: Sequence[tuple[Array, Array]], limits: Sequence[float]) -> tuple[float, float]:
    """Range of an axis that shows the minimum of every curve, and the limits."""
    lows = [float(ys.min()) for _, ys in curves if len(ys)] + [*limits]
    high = min(max(float(ys.max()) for _, ys in curves if len(ys)), 3.0 * max(lows)) * 1.06
    return max(0.0, min(lows) - 0.12 * (high - min(lows))), high


NBSP = "\N{NO-BREAK SPACE}"


def ucurves_figure(drawn: SweepFigureData) -> Ink:
    """Stiffness curves of the best designs with the required stiffness, and a key of designs.

    Raises
    ------
    InputError
        no feasible design, or none with a stiffness curve
    """
    curves, labels = [], []
    for k, best in enumerate(drawn.bests()[:MOST]):
        design = drawn.study.designs.made(drawn.study.values(best.number))
        curves.append(evaluate(design).curve)
        objective = value_words(drawn.goal, float(drawn.goals(drawn.best(k))[0]))
        labels.append(f"{k + 1}: {objective}")
    if not any(map(has_points, curves)):
        message = "no stiffness curve: the stroke of these designs was not evaluated"
        raise InputError(Diagnostic(message, "draw another figure"))
    count = len(curves)
    words = "stiffness over the stroke of the best design" + (
        f"s (1 to {count})" if count > 1 else ""
    )
    quantity = drawn.study.quantity("stiffness_min")
    required = [
        Required(value, f"≥ {trimmed(quantity.to_display(value))}")
        for sense, value in drawn.limits_on("stiffness_min")
        if sense == "min"
    ]
    panels = stiffness_panels(curves, labels, required, "design 1")
    title = f"{drawn.study.design.name}: {words}"
    key = "\n".join(_key(drawn, k) for k in range(count))
    return titled(Chart(title, [panels], key, height=140.0), [drawn.counts()])


def _key(drawn: SweepFigureData, k: int) -> str:
    """Number of a design, its varied inputs, and its smallest margin."""
    tracks = [drawn.axis(axis.path) for axis in drawn.study.plan.axes]
    rows = drawn.best(k)
    values = [value_words(track, float(drawn.values(track.words, rows)[0])) for track in tracks]
    parts = [f"{track.words} {value}" for track, value in zip(tracks, values, strict=True)]
    parts.append(f"least margin {margin_text(drawn.bests()[k].margin)}")
    return f"{k + 1}: {'; '.join(part.replace(' ', NBSP) for part in parts)}"


FIGURE = SweepFigure(
    every=False,
    lines=False,
    check=fits,
    draw=lambda drawn, metrics, chosen: {"ucurves": ucurves_figure(drawn)},
)
