"""Stiffness over the stroke of the best designs of a sweep."""

from __future__ import annotations

from ...base.errors import Diagnostic, InputError
from ...evaluation import evaluate
from ...rendering.heights import wrap
from ...rendering.ink import Ink
from ...rendering.text import limit_text, margin_text
from ..ucurves import MOST, SIZE, STYLES, Required, curves_drawn, has_points
from .shared import SweepFigure, SweepFigureData, fits, heading, value_words

NBSP = "\N{NO-BREAK SPACE}"


def ucurves_figure(drawn: SweepFigureData) -> Ink:
    """The U-curves of the best designs with the stiffness required, and what each of them is.

    Raises
    ------
    InputError
        no feasible design, or none with a stiffness curve
    """
    curves, labels = [], []
    for k, best in enumerate(drawn.bests()[:MOST]):
        design = drawn.study.designs.made(drawn.study.values(best.number))
        curves.append(evaluate(design).curve)
        said = value_words(drawn.goal, float(drawn.goals(drawn.best(k))[0]))
        labels.append(f"{k + 1}: {said}")
    if not any(map(has_points, curves)):
        message = "no stiffness curve: the stroke of these designs was not evaluated"
        raise InputError(Diagnostic(message, "draw another figure"))
    ink = Ink(180.0, 400.0)
    count = len(curves)
    words = "stiffness over the stroke of the best design" + (
        f"s (1 to {count})" if count > 1 else ""
    )
    top = heading(ink, drawn, words, drawn.counts()) + 8.0
    quantity = drawn.study.quantity("stiffness_min")
    required = [
        Required(value, f"required {limit_text(quantity, 'min', value)}")
        for sense, value in drawn.limits_on("stiffness_min")
        if sense == "min"
    ]
    below = curves_drawn(ink, top, curves, labels, required, "design 1")
    ink.height = _key(drawn, ink, below, count)
    return ink


def _key(drawn: SweepFigureData, ink: Ink, y: float, count: int) -> float:
    """What varies in each of the designs."""
    tracks = [drawn.axis(axis.path) for axis in drawn.study.plan.axes]
    for k in range(count):
        rows = drawn.best(k)
        values = [value_words(track, float(drawn.values(track.words, rows)[0])) for track in tracks]
        said = [
            f"{track.words} {value}".replace(" ", NBSP)
            for track, value in zip(tracks, values, strict=True)
        ]
        ink.line((2.0, y), (8.0, y), **STYLES[k])
        ink.text(9.4, y, f"{k + 1}", size=SIZE, bold=True)
        margin = f"least margin {margin_text(drawn.bests()[k].margin)}".replace(" ", NBSP)
        for line in wrap("; ".join([*said, margin]), 166.0, SIZE):
            ink.text(13.0, y, line, size=SIZE)
            y += 3.5
    return y + 1.0


FIGURE = SweepFigure(
    every=False,
    lines=False,
    check=fits,
    draw=lambda drawn, metrics, chosen: {"ucurves": ucurves_figure(drawn)},
)
