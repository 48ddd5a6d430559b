"""Governing case and place in few letters, for columns of a terminal."""

from __future__ import annotations

import re

_PLACES = (
    (re.compile(r"\b(extend|retract)ing, "), r"\1, "),
    (re.compile(r"(\d+ %) of the stroke\b"), r"\1"),
    (re.compile(r"\bweakest position\b"), "weakest"),
)


def brief(case: str | None, place: str | None) -> str:
    """Case and place; places on the stroke are shortened.

    >>> brief("stance", "retracting, 25 % of the stroke"), brief(None, "weakest position")
    ('stance, retract, 25 %', 'weakest')
    """
    for pattern, written in _PLACES:
        place = pattern.sub(written, place or "")
    return ", ".join(part for part in (case, place) if part)
