"""The page of an uncertainty study: yield, scatter of the margins, causes, and inputs.

The yield is the share of the random draws (actuators with scatter) that meet all requirements.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from ..evaluation.result import count_words, without_reserve
from ..rendering import text
from ..rendering.axes import Axes, fitted, ticks
from ..rendering.blocks import (
    Block,
    Column,
    Drawing,
    Notes,
    Page,
    Row,
    State,
    Table,
    Tile,
    Verdict,
    short,
    tile,
)
from ..rendering.ink import BLACK, BLUE, GREY, RED, Ink
from ..rendering.series import Series
from ..rendering.text import sentence
from ..rendering.tornado import LIGHT, MOST, TornadoBar, bars
from ..uncertainties.estimate import Rate
from ..uncertainties.inputs import TOLERANCE, Input
from ..uncertainties.result import LimitYield, Swing, Uncertainty

SHOWN = 8
"""Largest number of inputs shown for an output."""
LEAST_SHARE = 0.005
"""Inputs that cause less than this share of the variance get no row."""

ROW, NAMES, HOLDS = 5.4, 46.0, 22.0
"""Height of a row, and widths of the names (left) and of the probabilities (right) (mm)."""
LOWEST, HIGHEST = -0.6, 1.0
"""Limits for the ends of the axis of margins; a strip that extends further ends with an arrow."""


def page(study: Uncertainty) -> Page:
    """The page of an uncertainty study."""
    return Page(
        name=study.name,
        kind="Yield from uncertain inputs",
        verdict=verdict(study),
        sentence=text.pretty(_sentence(study)),
        tiles=_tiles(study),
        hero=lambda room: margins_figure(study),
        blocks=list(_blocks(study)),
    )


def series(study: Uncertainty) -> list[Series]:
    """The random draws as columns: inputs, margins, and whether all requirements are met."""
    inputs = [
        Series(
            f"{x.path} [{x.quantity.unit}]" if x.quantity.unit else x.path,
            [x.quantity.to_display(v) for v in values.tolist()],
        )
        for x, values in zip(study.inputs, study.kept.values, strict=True)
    ]
    margins = [
        Series(f"margin of {limit.name}", np.where(np.isfinite(values), values, np.nan).tolist(), 5)
        for limit, values in zip(study.limits, study.kept.margins, strict=True)
    ]
    required = np.array([limit.required for limit in study.limits], dtype=bool)
    met = (study.kept.margins[required] >= -TOLERANCE).all(axis=0)
    return [*inputs, *margins, Series("requirements met", [int(x) for x in met])]


def verdict(study: Uncertainty) -> Verdict:
    """Badge at the top: whether the nominal design meets its requirements, and the yield."""
    known = [limit for limit in study.required if limit.margin is not None]
    met = sum(limit.margin >= -TOLERANCE for limit in known if limit.margin is not None)
    tight = sum(without_reserve(limit.margin, limit.limit) for limit in known)
    lines = [
        f"nominal design: {met} of {len(study.required)} requirements met",
        f"yield {percent(study.rate.value)}",
    ]
    if not study.met:
        return Verdict("missed", "NOMINAL DESIGN MISSES REQUIREMENTS", lines)
    if tight:
        return Verdict("checks", f"NOMINAL DESIGN MEETS ALL, {count_words(tight).upper()}", lines)
    return Verdict("met", "NOMINAL DESIGN MEETS ALL", lines)


# ---- words ----


def percent(share: float, digits: int = 2) -> str:
    """A probability in per cent; 0 and 100 are only printed if exact.

    >>> percent(0.9953), percent(1.0), percent(0.99999999)
    ('99.53 %', '100 %', '> 99.99 %')
    """
    if share in (0.0, 1.0):
        return f"{100 * share:.0f} %"
    step = 10.0**-digits
    if 100 * share > 100 - step:
        return f"> {100 - step:.{digits}f} %"
    if 100 * share < step:
        return f"< {step:.{digits}f} %"
    return f"{100 * share:.{digits}f} %"


def between(rate: Rate) -> str:
    """The 95 % confidence interval of a probability, in words."""
    return f"{percent(rate.lower)} to {percent(rate.upper)}"


def _sentence(study: Uncertainty) -> str:
    count = text.trimmed(float(study.count), 8)
    return (
        f"{percent(study.rate.value)} of the actuators meet every requirement (95 % bounds "
        f"{between(study.rate)}; {count} {study.method}, {len(study.inputs)} inputs). "
        f"{weakest(study)}"
    )


def weakest(study: Uncertainty) -> str:
    """Sentence on the requirement that the fewest draws meet."""
    if not study.required:
        return "The design states no requirement."
    worst = study.required[0]
    failing = [limit for limit in study.required if limit.rate.value < 1]
    if not failing:
        low = worst.margins[0]
        margin = (
            ""
            if low is None
            else f": {_margin(worst, low)} at the 1 % point (99 % of the draws have a larger "
            "margin)"
        )
        return f"No draw missed a requirement; {worst.name} has the smallest margin{margin}."
    words = f"{worst.name} is missed most often, in {percent(1 - worst.rate.value)} of the draws"
    if len(failing) > 1:
        others = ", ".join(f"{x.name} {percent(1 - x.rate.value)}" for x in failing[1:4])
        words += f"; then {others}"
    return f"{words}."


def _with_checks(study: Uncertainty) -> str:
    """Words on the yield including the check list; empty if no draw misses a check."""
    failing = [limit for limit in study.checks if limit.rate.value < 1]
    if not failing:
        return ""
    named = ", ".join(f"{x.name} {percent(1 - x.rate.value)}" for x in failing[:4])
    more = f" and {len(failing) - 4} more" if len(failing) > 4 else ""
    return (
        f"{percent(study.rate_checks.value)} of the actuators meet the requirements and the check "
        f"list (95 % bounds {between(study.rate_checks)}). Missed checks: {named}{more}."
    )


def _margin(limit: LimitYield, margin: float | None) -> str:
    return text.margin_of(text.metric(limit.metric), limit.limit, margin)


def value_words(study: Uncertainty, output: str, number: float | None) -> str:
    """An output in words: a metric in its unit, a margin in per cent."""
    if output in study.units:
        return text.value_text(text.metric(output), number)
    limit = next((x for x in study.limits if x.name == output), None)
    return text.margin_text(number) if limit is None else _margin(limit, number)


def followed(study: Uncertainty) -> list[str]:
    """Outputs shown in detail: up to three requirements that draws miss, then requested metrics.

    If all draws meet the requirements, the requirement with the smallest margin is shown.
    """
    failing = [limit.name for limit in study.required if limit.rate.value < 1][:3]
    nearest = [limit.name for limit in study.required[:1]]
    return [*(failing or nearest), *study.units]


# ---- key figures and blocks ----


def _tiles(study: Uncertainty) -> list[Tile]:
    """Yield, yield with the check list, inputs, the weakest requirement and its main cause."""
    checked = study.rate_checks
    tiles = [
        tile("yield", percent(study.rate.value), f"95 %: {between(study.rate)}"),
        tile("yield with the check list", percent(checked.value), f"95 %: {between(checked)}"),
        tile("uncertain inputs", str(len(study.inputs)), "listed below"),
    ]
    if study.required:
        worst = study.required[0]
        margin = _margin(worst, worst.margin)
        label = short(worst.name.replace("_", " "), 28)
        tiles.append(tile(label, margin, f"met by {percent(worst.rate.value)}"))
        ranked = study.of_output(worst.name)[0]
        if ranked and ranked[0].total is not None:
            share = f"{100 * ranked[0].total:.0f} % of its variance"
            name = short(ranked[0].path.rpartition(".")[2].replace("_", " "), 28)
            tiles.append(tile("its main cause", share, name))
    return tiles


def _blocks(study: Uncertainty) -> Iterator[Block]:
    checks = [limit for limit in study.checks if limit.rate.value < 1]
    if study.required:
        yield _limits("Requirements over the draws", study.required)
    if checks:
        yield _limits("Checks missed by some draws", checks)
    for output in followed(study):
        yield from _causes(study, output)
    yield _inputs(study)
    notes = [_with_checks(study), *study.notes]
    if study.dropped > 0:
        share = percent(study.dropped)
        notes.append(
            f"{share} of the samples for the sensitivity indices are not computable and "
            "are left out"
        )
    remarks = [sentence(text.pretty(words)) for words in notes if words]
    yield Notes("What the yield means", remarks, style="dim", headless=True)


def _limits(title: str, limits: Iterable[LimitYield]) -> Table:
    columns = [
        Column("limit", "left", 1.0, breaks=60, mono=True, least=16),
        Column("", "right"),
        Column("nominal margin", "right", drop=3),
        Column("5 % of draws", "right"),
        Column("median", "right", drop=1),
        Column("met by", "right", strong=True, drop=0, style="state"),
        Column("95 % bounds", "right", drop=2),
    ]
    rows = []
    for limit in limits:
        words = text.limit_text(text.metric(limit.metric), limit.sense, limit.limit)
        spots = (limit.margin, limit.margins[1], limit.margins[2])
        rate = limit.rate.value
        cells = (limit.name, words, *(_margin(limit, x) for x in spots))
        state: State = "met" if rate == 1 else "missed" if rate < 0.5 else "no_reserve"
        rows.append(Row((*cells, percent(rate), between(limit.rate)), state))
    return Table(title, columns, rows)


def _causes(study: Uncertainty, output: str) -> Iterator[Block]:
    """Inputs that cause the variance of an output: bars on paper, a table on the terminal."""
    if output in study.units:
        title = f"Causes of the variation of {text.metric(output).label}"
    else:
        title = f"Causes of the variation of the margin of {output}"
    rows = _indices(study, output)
    columns = [
        Column("input", "left", 1.0, least=34),
        Column("alone", "right"),
        Column("with others", "right"),
        Column("at 5 %", "right", drop=1),
        Column("at 95 %", "right", drop=1),
    ]
    note = (
        "Bars: change of the result if only this input is moved to its 5 % or 95 % point. Alone: "
        "share of the variance due to this input by itself. With others: share that includes its "
        "interactions with other inputs."
    )
    table = Table(title, columns, rows, on="terminal") if rows else None
    ink = tornado(study, output)
    if ink is not None:
        yield Drawing(title, ink, note, instead=table)
    elif table is not None:
        yield table


def _indices(study: Uncertainty, output: str) -> list[tuple[str, ...]]:
    """Table rows: sensitivity indices of the main inputs, and the output at 5 and 95 % of each."""
    ranked, swings = study.of_output(output)
    ends = {swing.path: swing for swing in swings}
    rows = []
    for index in ranked[:SHOWN]:
        if index.total is None or index.total < LEAST_SHARE:
            continue
        swing = ends[index.path]
        shares = (_share(index.first, index.first_half), _share(index.total, index.total_half))
        spots = (value_words(study, output, x) for x in (swing.at_5, swing.at_95))
        rows.append((index.path, *shares, *spots))
    return rows


def _share(index: float | None, half: float | None) -> str:
    """An index with half its confidence interval, in per cent."""
    if index is None or half is None:
        return text.DASH
    return f"{100 * index:.0f} ± {max(100 * half, 0.5):.0f} %".replace("-", text.MINUS)


def _inputs(study: Uncertainty) -> Table:
    """Table of all uncertain inputs with their distributions."""
    columns = [
        Column("input", "left", 1.3, breaks=30, mono=True, least=14, wraps=True),
        *(Column(head, "right") for head in ("value", "5 %", "95 %")),
        Column("distribution", drop=2),
        Column("from", "left", 1.2, breaks=30, drop=1, least=16, wraps=True),
    ]
    return Table("Uncertain inputs", columns, [_input(x) for x in study.inputs])


def _input(given: Input) -> tuple[str, ...]:
    ends = given.distribution.at(np.array([0.05, 0.95])).tolist()
    numbers = [text.value_text(given.quantity, x) for x in (given.value, *ends)]
    doubt = " (unverified)" if given.confidence == "unverified" else ""
    origin = text.pretty(given.why.replace("+-", "±")) + doubt
    return given.path, *numbers, given.distribution.shape, origin


# ---- figures ----


def shown(uncertainty: Uncertainty) -> list[LimitYield]:
    """Requirements, and checks that some draws miss; the least likely to be met first."""
    failing = [check for check in uncertainty.checks if check.rate.value < 1]
    return [*uncertainty.required, *failing][:MOST]


def margins_figure(uncertainty: Uncertainty, *, width: float = 180.0) -> Ink:
    """Margins of every requirement as a strip.

    The line extends from the 1 % to the 99 % point of the draws, the box from 5 to 95 %. Marks show
    the median and the nominal design. Drawn directly, without `Chart`, because the
    probability is beside each strip.
    """
    lines = shown(uncertainty)
    top = 9.0
    ink = Ink(width, top + ROW * max(len(lines), 1) + 10.0)
    known = [x for line in lines for x in (*line.margins, line.margin) if x is not None]
    low = max(min([*known, 0.0]), LOWEST)
    high = min(max([*known, 0.02]), HIGHEST)
    room = 0.04 * (high - low)
    box = (NAMES, top, width - NAMES - HOLDS, ROW * max(len(lines), 1))
    axes = Axes(ink, box, (100 * (low - room), 100 * (high + room)), (0.0, 1.0))
    places = [(x, text.trimmed(x)) for x in ticks(*axes.x_range, 8)]
    axes.frame_at("", "margin, % of the limit", places, [], upright=True)
    zero = axes.x(0.0)
    ink.line((zero, top - 1.0), (zero, top + box[3]), pen=0.35, stroke=RED)
    ink.text(zero, top - 2.6, "limit", size=6.5, anchor="center", color=RED, bold=True)
    _key(ink, top)
    ink.text(width, top - 2.6, "met by", size=6.5, anchor="right", color=GREY)
    for index, line in enumerate(lines):
        _strip(ink, axes, top + ROW * (index + 0.5), line, width)
    return ink


def _key(ink: Ink, top: float) -> None:
    """Draw the key of box, line and circle."""
    y = top - 6.4
    ink.line((0.0, y), (8.0, y), pen=0.3)
    ink.box(2.0, y - 1.1, 4.0, 2.2, fill=LIGHT, pen=0.15)
    ink.line((4.0, y - 1.1), (4.0, y + 1.1), pen=0.5, stroke=BLUE)
    ink.text(9.5, y, "1, 5, 50, 95 and 99 % of the draws", size=6.5)
    ink.circle(62.0, y, 0.8, fill=BLACK, pen=0.1)
    ink.text(64.0, y, "nominal", size=6.5)


def _strip(ink: Ink, axes: Axes, y: float, limit_yield: LimitYield, width: float) -> None:
    name = fitted(limit_yield.name, NAMES - 2.0, 6.5)
    ink.text(NAMES - 1.6, y, name, size=6.5, anchor="right", bold=limit_yield.required)
    left, right = axes.left, axes.left + axes.width

    def place(margin: float | None) -> float:
        if margin is None:
            return left
        return min(max(axes.x(100 * max(min(margin, 1e3), -1e3)), left), right)

    p1, p5, p50, p95, p99 = (place(x) for x in limit_yield.margins)
    ink.line((p1, y), (p99, y), pen=0.3)
    ink.box(p5, y - 1.4, max(p95 - p5, 0.1), 2.8, fill=LIGHT, pen=0.15)
    ink.line((p50, y - 1.4), (p50, y + 1.4), pen=0.5, stroke=BLUE)
    for edge, inner, beyond in (
        (left, left + 2.0, _below(limit_yield.margins[0], axes)),
        (right, right - 2.0, _above(limit_yield.margins[-1], axes)),
    ):
        if beyond:
            ink.arrow((edge, y), (inner, y), length=1.6, color=GREY)
    if (
        limit_yield.margin is not None
        and axes.x_range[0] <= 100 * limit_yield.margin <= axes.x_range[1]
    ):
        ink.circle(place(limit_yield.margin), y, 0.8, fill=BLACK, pen=0.1)
    colour = BLACK if limit_yield.rate.value > 0.5 else RED
    ink.text(width, y, percent(limit_yield.rate.value), size=6.5, anchor="right", color=colour)


def _below(margin: float | None, axes: Axes) -> bool:
    return margin is None or 100 * margin < axes.x_range[0]


def _above(margin: float | None, axes: Axes) -> bool:
    return margin is not None and 100 * margin > axes.x_range[1]


def tornado(uncertainty: Uncertainty, output: str, *, width: float = 180.0) -> Ink | None:
    """Tornado chart: change of an output at the 95 % (dark) and 5 % point of each input."""
    ranked, swings = uncertainty.of_output(output)
    ends = {swing.path: swing for swing in swings}
    centre = uncertainty.nominal[output]
    if centre is None:
        return None
    metric = output in uncertainty.units
    quantity = text.metric(output) if metric else None
    factor = 100.0 if quantity is None else quantity.to_display(1.0) - quantity.to_display(0.0)
    rows = []
    for index in [index for index in ranked if (index.total or 0.0) >= LEAST_SHARE][:SHOWN]:
        shares = (_percent(index.first), _percent(index.total))
        changes = _changes(ends[index.path], centre, factor)
        rows.append(TornadoBar(index.path, changes, shares))
    if not rows or all(change is None for row in rows for change in row.changes):
        return None
    unit = "% of the limit" if quantity is None else text.unit_text(quantity.unit)
    label = f"change of the margin of {output}" if quantity is None else quantity.label
    return bars(
        rows,
        axis=f"{label}, {unit}" if quantity is None else f"change of {label}, {unit}",
        centre=f"nominal {value_words(uncertainty, output, centre)}",
        ends=("95 %", "5 %"),
        columns=("alone", "with others"),
        width=width,
    )


def _changes(swing: Swing, centre: float, factor: float) -> tuple[float | None, float | None]:
    """Changes of the output if an input is at its 95 % and its 5 % quantile, in display units."""

    def change(value: float | None) -> float | None:
        if value is None or not math.isfinite(value):
            return None
        return factor * (value - centre)

    return change(swing.at_95), change(swing.at_5)


def _percent(index: float | None) -> str:
    if index is None:
        return text.DASH
    return f"{max(100 * index, 0.0):.0f} %"
