"""How good is this: the proven bound, what the starts say, runners-up, how the search went."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from ..base.quantities import Quantity
from ..optimisation.outcome import MET
from ..optimisation.result import Optimisation
from ..rendering import text
from ..rendering.axes import Axes, ticks
from ..rendering.blocks import Block, Drawing, Notes
from ..rendering.ink import BLACK, BLUE, GREY, PALE, Ink, spread_within, text_width
from .optimum import convergence, sentence

LEAST = 1e-4
"""Per cent above the optimum that count as none."""

NEAR = 1e-3
"""Relative difference of objectives up to which two starts found one optimum."""

WIDTH = 180.0
"""Of the figures (mm)."""


def blocks(optimisation: Optimisation) -> list[Block]:
    """The statement, the scale of what is proven and found, and the course of the search."""
    found: list[Block] = [Notes("How good is this?", lines(optimisation))]
    if optimisation.infeasibility is None:
        found += _scale_block(optimisation)
        found += _course_block(optimisation)
    return found


def lines(optimisation: Optimisation) -> list[str]:
    """What is proven, what is only likely, and how it was found."""
    return [*proof(optimisation), *convergence(optimisation)]


def proof(optimisation: Optimisation, *, brief: bool = False) -> list[str]:
    """What the certificate says; without one, how to get it. `brief` leaves the covered limits."""
    certificate = optimisation.certificate
    if certificate is None:
        if optimisation.infeasibility is not None or not optimisation.variables:
            return []
        return ["Not proven: optimise --certify tells how far this is from the best possible."]
    said = [sentence(certificate.sentence), *_of_sizes(optimisation)]
    if certificate.covers and not brief:
        names = ", ".join(certificate.covers)
        said.append(f"The proof covers, by the models or by what none of them can beat: {names}.")
    if certificate.dropped:
        shown = [name if brief else f"{name} ({why})" for name, why in certificate.dropped.items()]
        covered = f"It covers {len(certificate.covers)} limits and does" if brief else "It does"
        said.append(f"{covered} without these, which can only lower the bound: {'; '.join(shown)}.")
    if certificate.evidence:
        said.append(sentence(certificate.evidence))
    return said


def _of_sizes(optimisation: Optimisation) -> list[str]:
    """How far the design of sizes is from the bound, which holds for it too."""
    bound, made = _bound(optimisation), optimisation.made
    if made is None or bound is None or not made.objective_after:
        return []
    share = math.ceil(1e4 * (1 - bound / made.objective_after)) / 100  # never smaller than it is
    return [
        "The design found is the continuous optimum here; that of"
        f" {made.name} is within {text.trimmed(share)} % of the bound."
    ]


def _quantity(optimisation: Optimisation) -> Quantity:
    return text.metric(optimisation.objective_metric)


def _marks(optimisation: Optimisation) -> list[tuple[float, str]]:
    """Objectives beside the optimum worth showing: designs of sizes, the start, other optima."""
    best, found = optimisation.objective_value, []
    rounding = optimisation.rounding
    if rounding is not None and rounding.objective_after is not None:
        found.append((rounding.objective_after, "of the sizes asked for"))
        for row in rounding.runners_up[:2]:
            found.append((row.objective, "runner-up"))
    if optimisation.choices is not None:
        for one in optimisation.choices.combinations[1:4]:
            if one.feasible and one.objective is not None:
                found.append((one.objective, "other choices"))
    known = [best]
    reached = (value for value in optimisation.starts if value is not None)
    for value in sorted(reached, key=lambda one: abs(one - best)):
        if all(abs(value - other) > NEAR * abs(other) for other in known):
            known.append(value)
    found += [(value, "other local optimum") for value in known[1:3]]
    start = optimisation.start.metrics.get(optimisation.objective_metric)
    if start is not None and start.value is not None and optimisation.start.met:
        found.append((start.value, "design as given"))
    return found


def _scale_block(optimisation: Optimisation) -> list[Block]:
    """What is proven, the optimum and what comes near, with a title."""
    bound = _bound(optimisation)
    if bound is None and not _marks(optimisation):
        return []
    note = "Left of the bound no design meets the covered limits; right of it a better one may."
    title = "Proven, found, and what comes near"
    return [Drawing(title, scale(optimisation), "" if bound is None else note)]


def _bound(optimisation: Optimisation) -> float | None:
    certificate = optimisation.certificate
    return None if certificate is None else certificate.lower_bound


def scale(optimisation: Optimisation) -> Ink:
    """What is proven, the optimum and what comes near, on one scale."""
    quantity, bound = _quantity(optimisation), _bound(optimisation)
    names = [(quantity.to_display(optimisation.objective_value), "optimum found", True)]
    names += [(quantity.to_display(value), words, False) for value, words in _marks(optimisation)]
    if bound is not None:
        names.append((quantity.to_display(bound), "proven bound", False))
    low, high = min(name[0] for name in names), max(name[0] for name in names)
    room = 0.04 * ((high - low) or abs(high) or 1.0)
    ink = Ink(WIDTH, 34.0)
    axes = Axes(ink, (4.0, 14.0, WIDTH - 8.0, 8.0), (low - room, high + room), (0.0, 1.0))
    places = [(value, text.trimmed(value)) for value in ticks(*axes.x_range, 8)]
    unit = text.unit_text(quantity.unit)
    axes.frame_at("", quantity.label + (f", {unit}" if unit else ""), places, [], upright=True)
    if bound is not None:
        edge = axes.x(quantity.to_display(bound))
        ink.box(axes.left, axes.top, edge - axes.left, axes.height, fill=PALE, pen=0.1)
    _labelled(ink, axes, sorted(names))
    return ink


def _labelled(ink: Ink, axes: Axes, names: Sequence[tuple[float, str, bool]]) -> None:
    """Strokes at values, with their names above, spread so that they stay apart."""
    widths = [text_width(words, 6.5, bold=strong) for _, words, strong in names]
    wanted = [axes.x(value) for value, _, _ in names]
    gaps = [(a + b) / 2 + 2.0 for a, b in pairwise(widths)]
    middle = spread_within(wanted, gaps, widths[0] / 2, WIDTH - widths[-1] / 2)
    for (value, words, strong), place in zip(names, middle, strict=True):
        x = axes.x(value)
        color = BLUE if strong else BLACK
        ink.line(
            (x, axes.top), (x, axes.top + axes.height), pen=0.5 if strong else 0.25, stroke=color
        )
        ink.line((place, 5.2), (x, axes.top), pen=0.1, stroke=GREY)
        ink.text(place, 3.0, words, size=6.5, anchor="center", bold=strong, color=color)


def _course_block(optimisation: Optimisation) -> list[Block]:
    """How far above the optimum the best design was over the evaluations, and where starts led."""
    best = optimisation.objective_value
    steps = [step for step in optimisation.trace if step[0] > 0 and step[2] <= MET]
    if len(steps) < 2 or not best:
        return []
    counts = [float(count) for count, _, _ in steps]
    last = max(float(optimisation.evaluations), counts[-1])
    ink = Ink(WIDTH, 52.0)
    heads = f"best design so far, above {text.value_text(_quantity(optimisation), best)}"
    values = [_above(value, best) for _, value, _ in steps]
    axes = _decades(ink, (14.0, 8.0, 88.0, 32.0), (0.0, last), values, heads, "evaluations")
    xs = [x for pair in zip(counts, [*counts[1:], last], strict=True) for x in pair]
    ys = [y for value in values for y in (value, value)]
    for line in axes.clipped(xs, ys):
        ink.line(*line, pen=0.35, stroke=BLUE)
    ends = [(k, one) for k, one in enumerate(optimisation.starts, start=1) if one is not None]
    if ends:
        span = (0.5, len(optimisation.starts) + 0.5)
        heights = [_above(one, best) for _, one in ends]
        box = (122.0, 8.0, 54.0, 32.0)
        axes = _decades(ink, box, span, heights, "where each start led", "start")
        for (number, _), height in zip(ends, heights, strict=True):
            ink.circle(axes.x(number), axes.y(height), 0.9, fill=BLUE)
    note = (
        "Designs that meet every limit, over the evaluations of all starts; none: below 0.0001 %."
    )
    return [Drawing("How the search went", ink, note)]


def _above(value: float, best: float) -> float:
    """Decimal logarithm of the per cent that an objective lies above the best."""
    return math.log10(max(100 * abs(value - best) / abs(best), LEAST))


def _decades(
    ink: Ink,
    box: tuple[float, float, float, float],
    x_range: tuple[float, float],
    values: Sequence[float],
    title: str,
    x_label: str,
) -> Axes:
    """A frame whose upright axis is per cent in decades."""
    low, high = math.log10(LEAST), max(math.ceil(max(values)), 1)
    axes = Axes(ink, box, x_range, (low - 0.3, high + 0.3))
    marks = range(round(low), high + 1, 2)
    whole = [(x, text.trimmed(x)) for x in ticks(*x_range, 6) if x == int(x)]
    names = [(float(k), f"{text.trimmed(10.0**k)} %" if k > low else "none") for k in marks]
    axes.frame_at(title, x_label, whole, names)
    return axes
