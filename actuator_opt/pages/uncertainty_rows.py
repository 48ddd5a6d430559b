"""What scatter does to a design, in numbers and sentences, for paper and terminal alike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..rendering import text
from ..uncertainties.estimate import Rate
from ..uncertainties.inputs import Input
from ..uncertainties.result import LimitYield, Uncertainty
from .optimum import sentence

LIMIT_HEADS = ("limit", "", "as it stands", "5 % of draws", "median", "holds", "95 % bounds")
INPUT_HEADS = ("input", "value", "5 %", "95 %", "distribution", "from")
INDEX_HEADS = ("input", "alone", "with others", "at 5 %", "at 95 %")
SHOWN = 8
"""Most inputs shown for one output."""
LEAST_SHARE = 0.005
"""Share of the variance below which an input is not worth a row."""


class Line(NamedTuple):
    """A row of cells; `state` is met, missed or empty."""

    cells: tuple[str, ...]
    state: str = ""


def percent(share: float, digits: int = 2) -> str:
    """A probability in per cent; 0 and 100 only where they are exact.

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
    """The bounds of a probability."""
    return f"{percent(rate.lower)} to {percent(rate.upper)}"


def what(found: Uncertainty) -> str:
    """Yield, how it was found, which requirement fails most."""
    count = text.trimmed(float(found.count), 8)
    return (
        f"{percent(found.rate.value)} of the actuators meet every requirement (95 % bounds "
        f"{between(found.rate)}; {count} {found.method}, {len(found.inputs)} inputs). "
        f"{weakest(found)}"
    )


def weakest(found: Uncertainty) -> str:
    """Which requirement fails most."""
    if not found.required:
        return "The design states no requirement."
    worst = found.required[0]
    failing = [one for one in found.required if one.rate.value < 1]
    if not failing:
        low = "" if worst.margins[0] is None else f", {_margin(worst, worst.margins[0])} at 1 %"
        return f"None failed; {worst.name} comes nearest{low}."
    words = f"{worst.name} fails most: {percent(1 - worst.rate.value)} of the draws"
    if len(failing) > 1:
        others = ", ".join(f"{x.name} {percent(1 - x.rate.value)}" for x in failing[1:4])
        words += f"; then {others}"
    return f"{words}."


def checks(found: Uncertainty) -> str:
    """The yield with the check list, in one sentence; empty where nothing of it can fail."""
    failing = [one for one in found.checks if one.rate.value < 1]
    if not failing:
        return ""
    named = ", ".join(f"{x.name} {percent(1 - x.rate.value)}" for x in failing[:4])
    rest = f" and {len(failing) - 4} more" if len(failing) > 4 else ""
    return (
        f"With the check list {percent(found.rate_checks.value)} meet everything "
        f"({between(found.rate_checks)}); what fails: {named}{rest}."
    )


def _margin(one: LimitYield, margin: float | None) -> str:
    return text.margin_of(text.metric(one.metric), one.limit, margin)


def limits(found: Uncertainty, *, checks: bool = False) -> list[Line]:
    """Requirements, the one that fails most first, or the checks that fail at all."""
    rows = [x for x in found.checks if x.rate.value < 1] if checks else list(found.required)
    lines = []
    for one in rows:
        words = text.limit_text(text.metric(one.metric), one.sense, one.limit)
        spots = (one.margin, one.margins[1], one.margins[2])
        cells = (one.name, words, *(_margin(one, x) for x in spots))
        state = "met" if one.rate.value == 1 else "missed" if one.rate.value < 0.5 else ""
        lines.append(Line((*cells, percent(one.rate.value), between(one.rate)), state))
    return lines


def inputs(found: Uncertainty) -> list[Line]:
    """Everything that scatters."""
    return [Line(_input(one)) for one in found.inputs]


def _input(one: Input) -> tuple[str, ...]:
    ends = one.distribution.at(np.array([0.05, 0.95])).tolist()
    numbers = [text.value_text(one.quantity, x) for x in (one.value, *ends)]
    doubt = " (unverified)" if one.confidence == "unverified" else ""
    return (
        one.path,
        *numbers,
        one.distribution.shape,
        text.pretty(one.why.replace("+-", "±")) + doubt,
    )


def followed(found: Uncertainty) -> list[str]:
    """Outputs worth a table: up to three requirements that fail, else the nearest; goals."""
    failing = [x.name for x in found.required if x.rate.value < 1][:3]
    nearest = [x.name for x in found.required[:1]]
    return [*(failing or nearest), *found.units]


def heading(found: Uncertainty, output: str) -> str:
    """What a table of indices is of."""
    if output in found.units:
        return f"What makes {text.metric(output).label} scatter"
    return f"What makes the margin of {output} scatter"


def value(found: Uncertainty, output: str, number: float | None) -> str:
    """An output as people read it: a metric in its unit, a margin in per cent."""
    if output in found.units:
        return text.value_text(text.metric(output), number)
    one = next((x for x in found.limits if x.name == output), None)
    return text.margin_text(number) if one is None else _margin(one, number)


def indices(found: Uncertainty, output: str) -> list[Line]:
    """Indices and swings of one output, the inputs that matter."""
    ranked, swings = found.of_output(output)
    ends = {one.path: one for one in swings}
    lines = []
    for one in ranked[:SHOWN]:
        if one.total is None or one.total < LEAST_SHARE:
            continue
        swing = ends[one.path]
        shares = (_share(one.first, one.first_half), _share(one.total, one.total_half))
        spots = (value(found, output, swing.at_5), value(found, output, swing.at_95))
        lines.append(Line((one.path, *shares, *spots)))
    return lines


def _share(index: float | None, half: float | None) -> str:
    """An index with half its interval, in per cent."""
    if index is None or half is None:
        return text.DASH
    return f"{100 * index:.0f} ± {max(100 * half, 0.5):.0f} %".replace("-", text.MINUS)


def remarks(found: Uncertainty) -> list[str]:
    """What the yield means, what it leaves out."""
    said = [checks(found), *found.notes]
    if found.dropped > 0:
        said.append(
            f"{percent(found.dropped)} of the rows behind the indices have no number somewhere and "
            "are left out there"
        )
    return [sentence(text.pretty(words)) for words in said if words]
