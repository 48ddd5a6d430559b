"""How good is this: the proven bound, what the starts say, runners-up, how the search went."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from ..base.quantities import Quantity
from ..metrics import of_metric
from ..optimisation.actuator import MET
from ..optimisation.result import Optimisation
from ..rendering import text
from ..rendering.axes import Axes, Ticks, fitted, ticks
from ..rendering.blocks import Block, Drawing, Notes
from ..rendering.ink import BLACK, BLUE, GREY, PALE, RED, Ink, spread_within, text_width
from ..rendering.text import number, sentence, trimmed, unit_text

LEAST_ABOVE = 1e-4
"""Per cent above the optimum that count as none."""

NEAR = 1e-3
"""Relative difference of objectives up to which two starts found one optimum."""

WIDTH = 180.0
"""Of the figures (mm)."""


def trust_blocks(optimisation: Optimisation) -> list[Block]:
    """The statement, the scale of what is proven and found, and the course of the search."""
    said = [*proof(optimisation), *convergence(optimisation)]
    blocks: list[Block] = [Notes("How good is this?", said, on="paper")]
    if optimisation.infeasibility is None:
        blocks += _scale_block(optimisation)
        blocks += _course_block(optimisation)
    return blocks


def brief(optimisation: Optimisation) -> Iterator[Block]:
    """The same for the terminal, without the limits that the proof covers."""
    for said, style in (
        (proof(optimisation, shortened=True), ""),
        (convergence(optimisation), "dim"),
    ):
        if said:
            yield Notes("Trust", said, headless=True, style=style, on="terminal")


def proof(optimisation: Optimisation, *, shortened: bool = False) -> list[str]:
    """What the certificate says; without a certificate, how to get it.

    `shortened`: the limits that it covers are counted, not named.
    """
    certificate = optimisation.certificate
    if certificate is None:
        if optimisation.infeasibility is not None or not optimisation.variables:
            return []
        return ["Not proven: `optimise --certify` computes how far this is from the best possible."]
    said = [sentence(certificate.sentence), *_of_sizes(optimisation)]
    if certificate.covers and not shortened:
        names = ", ".join(certificate.covers)
        said.append(f"The proof covers, by the models or by what none of them can beat: {names}.")
    if certificate.dropped:
        shown = [
            name if shortened else f"{name} ({why})" for name, why in certificate.dropped.items()
        ]
        covered = f"It covers {len(certificate.covers)} limits and does" if shortened else "It does"
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
    ends = [(k, start) for k, start in enumerate(optimisation.starts, start=1) if start is not None]
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
    return math.log10(max(100 * abs(value - best) / abs(best), LEAST_ABOVE))


def _decades(
    ink: Ink,
    box: tuple[float, float, float, float],
    x_range: tuple[float, float],
    values: Sequence[float],
    title: str,
    x_label: str,
) -> Axes:
    """A frame whose upright axis is per cent in decades."""
    low, high = math.log10(LEAST_ABOVE), max(math.ceil(max(values)), 1)
    axes = Axes(ink, box, x_range, (low - 0.3, high + 0.3))
    marks = range(round(low), high + 1, 2)
    whole = [(x, text.trimmed(x)) for x in ticks(*x_range, 6) if x == int(x)]
    names = [(float(k), f"{text.trimmed(10.0**k)} %" if k > low else "none") for k in marks]
    axes.frame_at(title, x_label, whole, names)
    return axes


def convergence(optimisation: Optimisation) -> list[str]:
    """Algorithm, effort, starts and trace, in sentences. Wall time is left out: same bytes."""
    objective = text.metric(optimisation.objective_metric)
    lines = [
        f"{optimisation.algorithm}, seed {optimisation.seed},"
        f" {optimisation.evaluations} evaluations."
    ]
    if optimisation.infeasibility is not None:
        count = len(optimisation.starts)
        lines.append(f"None of {count} starts led to a design that meets every requirement.")
    elif optimisation.starts:
        best = optimisation.objective_value
        same = sum(v is not None and abs(v - best) <= 1e-3 * abs(best) for v in optimisation.starts)
        found = ", ".join(
            "none" if v is None else text.value_text(objective, v) for v in optimisation.starts[:8]
        )
        more = ", …" if len(optimisation.starts) > 8 else ""
        lines.append(
            f"{same} of {len(optimisation.starts)} starts reached the same optimum within 0.1 %:"
            f" {found}{more}."
        )
    if optimisation.trace:
        steps = optimisation.trace
        picked = [
            steps[k] for k in sorted({0, len(steps) // 3, 2 * len(steps) // 3, -1 % len(steps)})
        ]
        path = " → ".join(
            f"{text.value_text(objective, value)} ({_missed(violation)} at {count})"
            for count, value, violation in picked
        )
        lines.append(f"Improvements (limits at evaluation): {path}.")
    if optimisation.kkt is not None and optimisation.kkt.active:
        lines.append(f"Active at the optimum: {', '.join(optimisation.kkt.active)}.")
    return lines


def _missed(violation: float) -> str:
    """How far a design misses its limits, in words."""
    return "all met" if violation <= 1e-6 else f"missed by {text.number(100 * violation, 2)} %"


_WIDTH, _HEIGHT, _PANEL, _TALL = 180.0, 70.0, 66.0, 44.0
_LOWEST = -6.0
"""Decade at which a limit counts as met, the bottom of the right panel."""


def convergence_figure(
    trace: Sequence[Sequence[float]], metric: str, evaluations: int, title: str
) -> Ink:
    """Improvements (evaluation, objective in SI, worst violation) over the evaluations made.

    Open circles miss a limit, filled ones meet all; the line goes on to the last evaluation.
    """
    ink = Ink(_WIDTH, _HEIGHT)
    ink.text(4.0, 3.0, fitted(title, 116.0, 8.0), size=8.0, bold=True)
    if not trace:
        ink.text(4.0, 12.0, "No search: nothing could move.", size=7.0, color=GREY)
        return ink
    ink.text(_WIDTH - 4.0, 3.0, "open: a limit is missed, filled: all are met", anchor="right",
             color=GREY)  # fmt: skip
    quantity = of_metric(metric)
    counts = [max(float(row[0]), 1.0) for row in trace]
    values = [quantity.to_display(float(row[1])) for row in trace]
    missed = [float(row[2]) for row in trace]
    last = max(float(evaluations), counts[-1], 2.0)
    across = (0.0, math.log10(last))
    low, high = min(values), max(values)
    room = 0.08 * (high - low) or 0.08 * abs(high) or 1.0
    unit = unit_text(quantity.unit)
    name = f"{quantity.label}, {unit}" if unit else quantity.label
    box = (20.0, 15.0, _PANEL, _TALL)
    axes = Axes(ink, box, across, (low - room, high + room))
    axes.frame_at(
        fitted(name[:1].upper() + name[1:], _PANEL, 7.0), "evaluations", _counts(last),
        [(y, trimmed(y)) for y in ticks(low - room, high + room, 5)], upright=True,
    )  # fmt: skip
    _steps(axes, counts, values, missed, last)
    _end(axes, values[-1], number(values[-1], 5), BLUE)
    heights = [max(math.log10(m), _LOWEST) if m > 0 else _LOWEST for m in missed]
    top = max(math.ceil(max(heights)), -1)
    right = Axes(ink, (112.0, 15.0, 62.0, _TALL), across, (_LOWEST, float(top)))
    decades = range(int(_LOWEST), top + 1, 1 if top <= 0 else 2)
    words = [(float(k), "met" if k == _LOWEST else f"{100 * 10.0**k:g} %") for k in decades]
    right.frame_at("Worst limit missed by", "evaluations", _counts(last), words, upright=True)
    _steps(right, counts, heights, missed, last)
    return ink


def _counts(last: float) -> Ticks:
    """Ticks of a logarithmic axis from 1 to `last` evaluations: 1, 2, 5 of few decades."""
    decades = math.ceil(math.log10(last)) + 1
    steps = (1, 2, 5) if decades <= 4 else (1,)
    found = [m * 10**k for k in range(decades) for m in steps if m * 10**k <= last]
    return [(math.log10(n), f"{n:g}") for n in found]


def _steps(
    axes: Axes, counts: Sequence[float], ys: Sequence[float], missed: Sequence[float], last: float
) -> None:
    """A staircase: each value holds until the next improvement."""
    points = []
    for k, (count, y) in enumerate(zip(counts, ys, strict=True)):
        after = counts[k + 1] if k + 1 < len(counts) else last
        points += [(axes.x(math.log10(count)), axes.y(y)), (axes.x(math.log10(after)), axes.y(y))]
    axes.ink.line(*points, stroke=BLUE, pen=0.35)
    for count, y, miss in zip(counts, ys, missed, strict=True):
        met = miss <= MET
        place = (axes.x(math.log10(count)), axes.y(y))
        axes.ink.circle(*place, 0.8, fill=BLUE if met else "#ffffff", stroke=BLUE if met else RED,
                        pen=0.25)  # fmt: skip


def _end(axes: Axes, value: float, words: str, color: str) -> None:
    """The last value in words over the end of its line, clear of the frame's top."""
    x, y = axes.left + axes.width, axes.y(value)
    above = y - 3.0 if y - 3.0 > axes.top + 1.5 else y + 3.0
    left = x - text_width(words, 6.5)
    axes.ink.text(max(left, axes.left + 1.0), above, words, color=color, halo=True)
