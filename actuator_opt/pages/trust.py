"""Evidence for an optimum: proven bound, results of all starts, next best designs, convergence."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from ..base.quantities import Quantity
from ..metrics import of_metric
from ..optimisation.result import Optimisation
from ..optimisation.solution import MET
from ..rendering import text
from ..rendering.axes import Axes, ticks
from ..rendering.blocks import Block, Chart, Drawing, Notes
from ..rendering.chart import Axis, Curve, Panel, Points
from ..rendering.chart_ink import titled
from ..rendering.ink import BLACK, BLUE, GREY, PALE, Ink, spread_within, text_width
from ..rendering.text import number, sentence, unit_text

LEAST_ABOVE = 1e-4
"""Smallest excess of the objective over the optimum that is drawn [%]; less counts as zero."""

NEAR = 1e-3
"""Largest relative difference of objectives at which two starts count as the same optimum."""

WIDTH = 180.0
"""Width of the scale (mm)."""


def trust_blocks(optimisation: Optimisation) -> list[Block]:
    """Blocks: statement of the proof, scale with bound and optimum, and course of the search."""
    sentences = [*proof(optimisation), *convergence(optimisation)]
    blocks: list[Block] = [Notes("How good is this?", sentences, on="paper")]
    if optimisation.infeasibility is None:
        blocks += _scale_block(optimisation)
        blocks += _course_block(optimisation)
    return blocks


def brief(optimisation: Optimisation) -> Iterator[Block]:
    """The statement for the terminal, without the list of limits that the proof covers."""
    for sentences, style in (
        (proof(optimisation, shortened=True), ""),
        (convergence(optimisation), "dim"),
    ):
        if sentences:
            yield Notes("Trust", sentences, headless=True, style=style, on="terminal")


def proof(optimisation: Optimisation, *, shortened: bool = False) -> list[str]:
    """Sentences on what the certificate proves; without a certificate, on how to get one.

    `shortened`: the covered limits are counted, not named.
    """
    certificate = optimisation.certificate
    if certificate is None:
        if optimisation.infeasibility is not None or not optimisation.variables:
            return []
        return [
            "Not proven: `optimise --certify` computes how far this design can be from the "
            "best possible."
        ]
    lines = [sentence(certificate.sentence), *_of_sizes(optimisation)]
    if certificate.covers and not shortened:
        names = ", ".join(certificate.covers)
        lines.append(
            f"The proof covers these limits, each by its model or by a bound on its model: {names}."
        )
    if certificate.dropped:
        shown = [
            name if shortened else f"{name} ({why})" for name, why in certificate.dropped.items()
        ]
        covered = f"It covers {len(certificate.covers)} limits and does" if shortened else "It does"
        lines.append(
            f"{covered} not include these limits, and leaving them out can only lower the bound: "
            f"{'; '.join(shown)}."
        )
    if certificate.evidence:
        lines.append(sentence(certificate.evidence))
    return lines


def _of_sizes(optimisation: Optimisation) -> list[str]:
    """Sentence on how far the design with listed (such as standard) sizes is from the bound."""
    bound, made = _bound(optimisation), optimisation.made
    if made is None or bound is None or not made.objective_after:
        return []
    share = math.ceil(1e4 * (1 - bound / made.objective_after)) / 100  # rounded up
    return [
        f"This gap is that of the continuous optimum; the design with {made.name} is within "
        f"{text.trimmed(share)} % of the bound."
    ]


def _quantity(optimisation: Optimisation) -> Quantity:
    return text.metric(optimisation.objective_metric)


def _marks(optimisation: Optimisation) -> list[tuple[float, str]]:
    """Objectives shown beside the optimum: designs with listed sizes, the start, other optima."""
    best, marks = optimisation.objective_value, []
    rounding = optimisation.rounding
    if rounding is not None and rounding.objective_after is not None:
        marks.append((rounding.objective_after, "with requested sizes"))
        for row in rounding.runners_up[:2]:
            marks.append((row.objective, "runner-up"))
    if optimisation.choices is not None:
        for combination in optimisation.choices.combinations[1:4]:
            if combination.feasible and combination.objective is not None:
                marks.append((combination.objective, "other choices"))
    known = [best]
    reached = (value for value in optimisation.starts if value is not None)
    for value in sorted(reached, key=lambda value: abs(value - best)):
        if all(abs(value - other) > NEAR * abs(other) for other in known):
            known.append(value)
    marks += [(value, "other local optimum") for value in known[1:3]]
    start = optimisation.start.metrics.get(optimisation.objective_metric)
    if start is not None and start.value is not None and optimisation.start.met:
        marks.append((start.value, "design as given"))
    return marks


def _scale_block(optimisation: Optimisation) -> list[Block]:
    """The scale of bound, optimum and other designs, with its title and note."""
    bound = _bound(optimisation)
    if bound is None and not _marks(optimisation):
        return []
    note = (
        "To the left of the bound, no design meets the limits covered by the proof. Between the "
        "bound and the optimum, a better design may exist."
    )
    title = "Optimum and other designs" if bound is None else "Proven bound, optimum, other designs"
    return [Drawing(title, scale(optimisation), "" if bound is None else note)]


def _bound(optimisation: Optimisation) -> float | None:
    certificate = optimisation.certificate
    return None if certificate is None else certificate.lower_bound


def scale(optimisation: Optimisation) -> Ink:
    """The bound, the optimum and other designs on a common scale.

    Drawn directly, without `Chart`, because every value has its name above the scale.
    """
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
    """Tick marks at values, with names above that are spread apart so as not to overlap."""
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
    """Chart of the excess over the optimum: best design so far, and result of every start."""
    best = optimisation.objective_value
    steps = [step for step in optimisation.trace if step[0] > 0 and step[2] <= MET]
    if len(steps) < 2 or not best:
        return []
    counts = [float(count) for count, _, _ in steps]
    last = max(float(optimisation.evaluations), counts[-1])
    heights = [_above(value, best) for _, value, _ in steps]
    title = f"Best design so far: excess over {text.value_text(_quantity(optimisation), best)}"
    x = Axis("evaluations", range=(0.0, last))
    panels = [Panel(title, x, _decades(heights), [Curve("", *_stairs(counts, heights, last))])]
    ends = [(k, start) for k, start in enumerate(optimisation.starts, 1) if start is not None]
    if ends:
        heights = [_above(start, best) for _, start in ends]
        numbers = [float(k) for k, _ in ends]
        count = len(optimisation.starts)
        marks = [(k, text.trimmed(k)) for k in ticks(0.5, count + 0.5, 6) if k == int(k)]
        x = Axis("start", range=(0.5, count + 0.5), ticks=marks)
        points = [Points("", numbers, heights, style=3)]
        panels.append(Panel("End of each start", x, _decades(heights), points=points))
    note = (
        "Left: evaluations of all starts together. Only designs that meet every limit are drawn. "
        '"none": excess below 0.0001 %.'
    )
    return [Chart("How the search went", panels, note, height=52.0, widths=(98.0, 64.0))]


def _above(value: float, best: float) -> float:
    """Excess of an objective over the best [%]."""
    return max(100 * abs(value - best) / abs(best), LEAST_ABOVE)


def _decades(values: Sequence[float]) -> Axis:
    """A logarithmic axis in per cent that ends at powers of ten."""
    low, high = math.log10(LEAST_ABOVE), max(math.ceil(math.log10(max(values))), 1)
    marks = [
        (10.0**k, f"{text.trimmed(10.0**k)} %" if k > low else "none")
        for k in range(round(low), high + 1, 2)
    ]
    return Axis(log=True, range=(10.0 ** (low - 0.3), 10.0 ** (high + 0.3)), ticks=marks)


def _stairs(
    counts: Sequence[float], values: Sequence[float], last: float
) -> tuple[list[float], list[float]]:
    """A staircase: each value remains until the next improvement."""
    xs = [x for pair in zip(counts, [*counts[1:], last], strict=True) for x in pair]
    return xs, [value for value in values for _ in range(2)]


def convergence(optimisation: Optimisation) -> list[str]:
    """Sentences on algorithm, effort, starts and improvements during the search.

    Wall time is left out, so that a repeated run gives the same bytes.
    """
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
        values = ", ".join(
            "none" if v is None else text.value_text(objective, v) for v in optimisation.starts[:8]
        )
        more = ", …" if len(optimisation.starts) > 8 else ""
        lines.append(
            f"{same} of {len(optimisation.starts)} starts reached the same optimum within 0.1 %:"
            f" {values}{more}."
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
        lines.append(f"Improvements (limits met or missed, at evaluation number): {path}.")
    if optimisation.kkt is not None and optimisation.kkt.active:
        lines.append(f"Limits active at the optimum: {', '.join(optimisation.kkt.active)}.")
    return lines


def _missed(violation: float) -> str:
    """Violation of the limits in words."""
    return "all met" if violation <= 1e-6 else f"missed by {text.number(100 * violation, 2)} %"


LOWEST = 1e-6
"""Relative violation below which a limit counts as met; lower end of the axis of violations."""


def convergence_figure(
    trace: Sequence[Sequence[float]], metric: str, evaluations: int, title: str
) -> Ink:
    """Figure of the improvements during a search: objective and worst violation."""
    if not trace:
        return titled(Chart(title, [], height=0.0), ["No search: no variable was free to change."])
    quantity = of_metric(metric)
    counts = [max(float(row[0]), 1.0) for row in trace]
    values = [quantity.to_display(float(row[1])) for row in trace]
    missed = [float(row[2]) for row in trace]
    violations = [100 * max(value, LOWEST) for value in missed]
    last = max(float(evaluations), counts[-1], 2.0)
    unit = unit_text(quantity.unit)
    name = f"{quantity.label}, {unit}" if unit else quantity.label
    top = max(math.ceil(math.log10(max(violations) / 100)), -1)
    low = round(math.log10(LOWEST))
    marks = [
        (100 * 10.0**k, "met" if k == low else f"{100 * 10.0**k:g} %")
        for k in range(low, top + 1, 1 if top <= 0 else 2)
    ]
    violation = Axis(log=True, range=(100 * LOWEST, 100 * 10.0**top), ticks=marks)
    x = Axis("evaluations", log=True, range=(1.0, last))
    shown = [
        (sentence(name).rstrip("."), values, Axis()),
        ("Worst limit missed by", violations, violation),
    ]
    panels = []
    for words, ys, y in shown:
        curve = Curve("", *_stairs(counts, ys, last), end=number(ys[-1], 5) if ys is values else "")
        panels.append(Panel(words, x, y, [curve], _improvements(counts, ys, missed)))
    return titled(Chart(title, panels, height=64.0))


def _improvements(
    counts: Sequence[float], values: Sequence[float], missed: Sequence[float]
) -> list[Points]:
    """Points of improvements that miss a limit, and of improvements that meet all limits."""
    groups = []
    for words, style, met in (("a limit is missed", 2, False), ("all limits are met", 3, True)):
        own = [k for k, miss in enumerate(missed) if (miss <= MET) == met]
        if own:
            xs, ys = ([column[k] for k in own] for column in (counts, values))
            groups.append(Points(words, xs, ys, style=style))
    return groups
