"""The picture of the README: section of the robot knee, sliders, prices.

``python docs/picture.py`` writes ``docs/images/knee.png`` and ``knee.svg``. All numbers are
results: the optimum, its prices with the ranges in which they hold, and optima along each slider.
"""

from __future__ import annotations

import sys
from pathlib import Path

import actuator_opt as ao
from actuator_opt.api.sessions import Session
from actuator_opt.base.quantities import Quantity
from actuator_opt.pages.section import section
from actuator_opt.rendering.ink import BLACK, BLUE, GREY, PALE, WHITE, Ink
from actuator_opt.rendering.paper import write_ink
from actuator_opt.rendering.text import number, pretty

ROOT = Path(__file__).resolve().parents[1]
SLIDERS = {
    "requirements.stiffness_min.min": ("stiffness, at least", 8e6, 13e6),
    "requirements.seal_gap.max": ("gap at the seal, at most", 31e-6, 44e-6),
    "cylinder.stroke": ("stroke", 90e-3, 130e-3),
}
"""Numbers that the picture varies, by PATH: words, and both ends of the slider in SI."""
POINTS = 9
WIDTH, TRACK, TRACK_WIDTH, ROW = 180.0, 52.0, 68.0, 13.0
"""Millimetres: width of the picture, left end and width of the tracks, height of a slider."""


def picture(design: str | Path = ROOT / "designs" / "knee.yaml") -> Ink:
    """Section of the best design, and below it a slider with its price for each number."""
    session = ao.session(design)
    best = session.optimum
    drawing = section(best.evaluation, width=WIDTH, height=40.0).ink
    top = 9.0 + drawing.height + 6.0
    ink = Ink(WIDTH, top + 4.0 + ROW * len(SLIDERS))
    ink.text(0.0, 4.0, f"{best.evaluation.name}: {best['mass'].text}", size=13.0, bold=True)
    ink.text(WIDTH, 4.0, "the lightest design that meets every requirement", size=8.0,
             anchor="right", color=GREY)  # fmt: skip
    ink.paste(drawing, 0.0, 9.0)
    ink.text(TRACK, top, "the best mass along each slider", size=6.5, color=GREY)
    ink.text(TRACK + TRACK_WIDTH + 6.0, top, "price", size=6.5, color=GREY)
    for k, path in enumerate(SLIDERS):
        _slider(ink, top + 10.0 + ROW * k, path, session)
    return ink


def _slider(ink: Ink, y: float, path: str, session: Session) -> None:
    """A number: its value, the optima along its track, where its price holds, and the price."""
    words, low, high = SLIDERS[path]
    price = session.price(path)
    values = [low + (high - low) * k / (POINTS - 1) for k in range(POINTS)]
    curve = session.curve(path, values)
    quantity = curve.quantity

    def x(value: float) -> float:
        return TRACK + TRACK_WIDTH * (min(max(value, low), high) - low) / (high - low)

    ink.text(0.0, y - 1.8, words, size=8.5)
    ink.text(0.0, y + 2.2, pretty(quantity.text(price.value)), size=8.5, bold=True)
    found = [(x(v), m) for v, m in zip(values, curve.objectives, strict=True) if m is not None]
    masses = [mass for _, mass in found]
    least, room = min(masses), max(masses) - min(masses)
    line = [(place, y - 1.6 - 5.0 * (mass - least) / room) for place, mass in found]
    ink.line(*line, stroke=GREY, pen=0.25)
    ink.box(TRACK, y, TRACK_WIDTH, 1.4, stroke=None, fill="#eef1f3")
    ink.box(line[0][0], y, line[-1][0] - line[0][0], 1.4, stroke=None, fill=PALE)
    sides = zip(price.holds, (low, high), strict=True)
    ends = [side if end is None else end for end, side in sides]
    ink.box(x(ends[0]), y, x(ends[1]) - x(ends[0]), 1.4, stroke=None, fill=BLUE)
    ink.circle(x(price.value), y + 0.7, 1.9, stroke=BLACK, pen=0.3, fill=WHITE)
    for side, value in (("left", low), ("right", high)):
        ink.text(x(value), y + 4.2, pretty(quantity.text(value)), size=6.0, anchor=side, color=GREY)
    right = TRACK + TRACK_WIDTH + 6.0
    ink.text(right, y - 0.6, _priced(price.slope_up, quantity), size=8.5, bold=True)
    holds = " to ".join(pretty(quantity.text(end, 3)) for end in ends)
    ink.text(right, y + 3.2, f"holds from {holds}", size=6.0, color=GREY)


def _priced(slope: float | None, quantity: Quantity) -> str:
    """Grams for one display unit of a number whose unit has no offset."""
    if slope is None:
        return "no design beyond"
    unit = quantity.unit
    grams = 1000 * slope / quantity.to_display(1.0)
    return f"{number(grams, 3, signed=True)} g per {pretty(unit)}"


if __name__ == "__main__":
    for file in write_ink(picture(), ROOT / "docs" / "images", "knee"):
        print(file)
    sys.exit(0)
