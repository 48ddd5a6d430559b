"""Designs side by side as ink: bars of mass, compliance and friction, part by part."""

from __future__ import annotations

from ..evaluation.comparison import Comparison, Question
from .compare_text import PART_TITLES, PART_UNITS
from .figures import AREAS, fills, fitted
from .ink import BLACK, GREY, Ink, text_width
from .text import number

_WIDTH, _RIGHT = 180.0, 20.0
_BAR, _STEP, _LINE = 5.6, 7.6, 4.2
_GAP = 5.0


def comparison_figure(found: Comparison) -> Ink:
    """A bar for every design and question; equal parts have equal fills; lengths are to scale."""
    questions = [q for q in found.questions if any(map(sum, q.parts.values()))]
    heights = [_height(found, question) for question in questions]
    names = 6.0 + _LINE * len(found.labels)
    ink = Ink(_WIDTH, names + sum(heights) + 2.0)
    top = 4.0
    for label, origin, one in zip(found.labels, found.origins, found.evaluations, strict=True):
        told = one.name if origin == one.name else f"{one.name} ({origin})"
        ink.text(4.0, top, label, size=7.5, bold=True)
        ink.text(9.0, top, fitted(told, _WIDTH - 12.0, 7.0), size=7.0)
        top += _LINE
    top += 2.0
    for question, height in zip(questions, heights, strict=True):
        _bars(ink, found, question, top)
        top += height
    return ink


def _height(found: Comparison, question: Question) -> float:
    lines = len(_legend(list(question.parts)))
    return 7.0 + _STEP * len(found.labels) + _LINE * lines + _GAP


def _legend(parts: list[str]) -> list[list[str]]:
    """Names of parts in lines that fit."""
    lines: list[list[str]] = [[]]
    used = 0.0
    for part in parts:
        wide = text_width(_name(part), 6.5) + 8.0
        if lines[-1] and used + wide > _WIDTH - 8.0:
            lines.append([])
            used = 0.0
        lines[-1].append(part)
        used += wide
    return lines


def _name(part: str) -> str:
    return part.replace("_", " ")


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
    for line in _legend(parts):
        x = 9.0
        for part in line:
            ink.box(x, y + 0.2, 2.4, 2.4, fill=paints[part], stroke=GREY, pen=0.1)
            ink.text(x + 3.6, y + 1.4, _name(part), size=6.5)
            x += text_width(_name(part), 6.5) + 8.0
        y += _LINE
