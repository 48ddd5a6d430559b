"""Designs side by side as ink: bars of mass, compliance and friction, part by part."""

from __future__ import annotations

from ..evaluation.comparison import Comparison, Question
from ..metrics import METRICS
from ..rendering.axes import AREAS
from ..rendering.heights import wrap
from ..rendering.ink import BLACK, GREY, Ink, text_width
from ..rendering.text import limit_text, number, pretty
from .compare_text import PART_TITLES, PART_UNITS, answer, duties, named, optimality, part_name
from .stiffness import fills
from .ucurves import MOST, STYLES, Required, curves_drawn, has_points

_WIDTH, _RIGHT = 180.0, 20.0
_BAR, _STEP, _LINE = 5.6, 7.6, 4.2
_GAP, _TOP, _SMALL = 5.0, 8.4, 3.3
_NOTE = "Parts of a bar in the order of their key; bold: the best."


def comparison_figure(found: Comparison) -> Ink:
    """A bar for every design and question; equal parts have equal fills; lengths are to scale."""
    questions = [q for q in found.questions if any(map(sum, q.parts.values()))]
    heads = [wrap(named(found, k), _WIDTH - 12.0, 7.0) for k in range(len(found.labels))]
    said = (_NOTE, *duties(found), *optimality(found))
    notes = [line for words in said for line in _wrapped(words)]
    above = _TOP + 1.0 + _LINE * sum(map(len, heads)) + _SMALL * len(notes) + 4.0
    heights = [_height(found, question) for question in questions]
    ink = Ink(_WIDTH, above + sum(heights) + 2.0)
    ink.text(4.0, 4.0, "Designs side by side", size=9.0, bold=True)
    top = _TOP
    for line in notes:
        ink.text(4.0, top, line, color=GREY)
        top += _SMALL
    top += 1.0
    for label, lines in zip(found.labels, heads, strict=True):
        ink.text(4.0, top, label, size=7.5, bold=True)
        for line in lines:
            ink.text(9.0, top, line, size=7.0)
            top += _LINE
    top = above
    for question, height in zip(questions, heights, strict=True):
        _bars(ink, found, question, top)
        top += height
    return ink


def comparison_ucurves(found: Comparison) -> Ink | None:
    """Stiffness over the stroke of the first `MOST` designs; None where none has any."""
    some = list(zip(found.labels, found.evaluations, strict=True))[:MOST]
    if not any(has_points(one.curve) for _, one in some):
        return None
    ink = Ink(_WIDTH, 400.0)
    ink.text(4.0, 4.0, "Stiffness over the stroke", size=9.0, bold=True)
    top = _TOP
    for words in optimality(found):
        for line in _wrapped(words):
            ink.text(4.0, top, line, color=GREY)
            top += _SMALL
    top += 1.0
    for k, ((label, _), style) in enumerate(zip(some, STYLES, strict=False)):
        ink.line((4.0, top), (9.0, top), **style)
        ink.text(10.5, top, label, size=7.5, bold=True)
        for line in wrap(named(found, k), _WIDTH - 18.0, 7.0):
            ink.text(15.5, top, line, size=7.0)
            top += _LINE
    labels = []
    for label, one in some:
        metric = one.metrics["stiffness_min"]
        value = "" if metric.value is None else f": least {number(metric.value / 1e6, 4)} kN/mm"
        labels.append(label + value)
    curves = [one.curve for _, one in some]
    ink.height = curves_drawn(ink, top + 7.0, curves, labels, _required(found), "A")
    return ink


def _required(found: Comparison) -> list[Required]:
    """The stiffness asked for, and of which designs where not of all alike."""
    asked: dict[float, list[str]] = {}
    for _, sense, rows in found.limits():
        for label, row in zip(found.labels, rows, strict=True):
            if row is not None and row.metric == "stiffness_min" and sense == "min":
                asked.setdefault(row.limit, []).append(label)
    every = len(found.labels)
    return [
        Required(
            value,
            f"required {limit_text(METRICS['stiffness_min'], 'min', value)}"
            + (f" of {', '.join(who)}" if len(who) < every else ""),
        )
        for value, who in asked.items()
    ]


def _height(found: Comparison, question: Question) -> float:
    lines, said = len(_legend(list(question.parts))), len(_said(found, question))
    return 7.0 + _SMALL * said + _STEP * len(found.labels) + _LINE * lines + _GAP


def _said(found: Comparison, question: Question) -> list[str]:
    """The answer in lines."""
    return _wrapped(answer(found, question))


def _wrapped(said: str) -> list[str]:
    return wrap(pretty(said[:1].upper() + said[1:]), _WIDTH - 8.0, 6.5)


def _legend(parts: list[str]) -> list[list[str]]:
    """Names of parts in lines that fit."""
    lines: list[list[str]] = [[]]
    used = 0.0
    for part in parts:
        wide = text_width(part_name(part), 6.5) + 8.0
        if lines[-1] and used + wide > _WIDTH - 8.0:
            lines.append([])
            used = 0.0
        lines[-1].append(part)
        used += wide
    return lines


def _bars(ink: Ink, found: Comparison, question: Question, top: float) -> None:
    """Title, a stacked bar for each design with its sum, and the names of the fills."""
    scale, unit = PART_UNITS[question.name]
    parts = list(question.parts)
    own = fills(parts) if question.name == "stiffer" else AREAS
    paints = {part: own[k % len(own)] for k, part in enumerate(parts)}
    sums = [sum(column) for column in zip(*question.parts.values(), strict=True)]
    room = _WIDTH - 9.0 - _RIGHT
    ink.text(4.0, top + 2.0, f"{PART_TITLES[question.name]}, {unit}", size=7.5, bold=True)
    y = top + 6.0
    for line in _said(found, question):
        ink.text(4.0, y, line, color=GREY)
        y += _SMALL
    for k, label in enumerate(found.labels):
        ink.text(4.0, y + _BAR / 2, label, size=7.0, bold=k in question.leaders)
        x = 9.0
        for part, values in question.parts.items():
            wide = max(values[k], 0.0) / max(sums) * room
            if wide <= 0:
                continue
            ink.box(x, y, wide, _BAR, fill=paints[part], stroke="#ffffff", pen=0.12)
            x += wide
        ink.line((9.0, y - 0.6), (9.0, y + _BAR + 0.6), stroke=BLACK, pen=0.18)
        ink.text(x + 1.5, y + _BAR / 2, number(scale * sums[k], 4), size=7.0,
                 bold=k in question.leaders)  # fmt: skip
        y += _STEP
    for names in _legend(parts):
        x = 9.0
        for part in names:
            ink.box(x, y + 0.2, 2.4, 2.4, fill=paints[part], stroke=GREY, pen=0.1)
            ink.text(x + 3.6, y + 1.4, part_name(part), size=6.5)
            x += text_width(part_name(part), 6.5) + 8.0
        y += _LINE
