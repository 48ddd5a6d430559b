"""Axes of a sweep: a PATH with a range, or with a list of values or names."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ..base import units
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..base.suggest import shown
from ..design import Design, with_values
from ..design.materials import load_library
from ..design.paths import canonical, get

Metrics: TypeAlias = Mapping[str, Quantity] | None
_RANGE = re.compile(r"(?P<first>.+?)\.\.(?P<last>.+?)(?::(?P<count>[^:]*))?")
FORM = 'write PATH=A..B:N or PATH=a,b,c, e.g. --vary cylinder.bore="18..40 mm:12"'
MOST_LISTED = 10_000
"""Maximum number of values in a list."""

SAID = frozenset({"name", "notes", "reproduces", "waivers", "objective"})
"""Blocks of a design that change none of its metrics or limits."""


@dataclass(frozen=True)
class Axis:
    """One PATH with its values: numbers (SI), or texts, each of which makes another design.

    A range has two `values` and `count` steps; `count` is None where the method chooses the points.
    """

    path: str
    values: Array | None = None
    texts: tuple[str, ...] = ()
    range: bool = False
    count: int | None = None

    @property
    def listed(self) -> bool:
        """Whether the axis lists its values instead of spanning a range."""
        return not self.range

    @property
    def size(self) -> int:
        """Return the number of values in a full factorial."""
        if self.range:
            return self.count or 0
        return len(self.texts) if self.values is None else len(self.values)

    def numbers(self) -> Array:
        """Return the values of a numeric axis in a full factorial."""
        assert self.values is not None
        if not self.range:
            return self.values
        return self.at(np.arange(self.count or 2))

    def at(self, places: Array) -> Array:
        """Return the values at some places of `numbers`, without computing all of them."""
        assert self.values is not None
        if not self.range:
            found: Array = self.values[places]
            return found
        low, high = self.values
        last = (self.count or 2) - 1
        between: Array = low + places * ((high - low) / last)
        return np.where(places == last, high, between)

    @property
    def ends(self) -> tuple[float, float]:
        """Return the least and the greatest number."""
        assert self.values is not None
        return float(self.values.min()), float(self.values.max())


def read_axis(text: str, design: Design, metrics: Metrics = None) -> Axis:
    """Return the axis for a user's text: ``PATH=A..B:N`` or ``PATH=a,b,c``.

    Numbers without a unit take the unit of the last number; without any unit they are SI. `metrics`
    are the names that the design may use; they include the user's own.

    Raises
    ------
    UsageError
        the text does not have this form
    InputError
        no such PATH, or a value that does not fit there
    """
    path, sign, given = text.partition("=")
    if not sign or not path.strip() or not given.strip():
        raise UsageError(Diagnostic(f"--vary {shown(text)}: no values", FORM))
    path = canonical(path.strip(), design)
    if path.partition(".")[0] in SAID:
        message = "is descriptive text that no model reads"
        raise InputError(Diagnostic(message, "vary a dimension, a material or a limit", path=path))
    found = _RANGE.fullmatch(given.strip())
    if found is None:
        parts = [part.strip() for part in given.split(",")]
        return _listed(path, parts, design, metrics)
    first, last, count = found["first"].strip(), found["last"].strip(), found["count"]
    steps = _steps(text, count)
    ends = [_number(path, end, design, metrics) for end in _with_unit([first, last])]
    if ends[0] == ends[1]:
        raise UsageError(Diagnostic(f"--vary {shown(text)}: both ends are equal", FORM))
    return Axis(path, np.array(ends), range=True, count=steps)


def _steps(text: str, count: str | None) -> int | None:
    if count is None:
        return None
    steps = units.whole(count)
    if steps is None or steps < 2:
        raise UsageError(
            Diagnostic(f"--vary {shown(text)}: {shown(count) or 'nothing'} steps", "give 2 or more")
        )
    return steps


def _with_unit(texts: list[str]) -> list[str]:
    """Return the values; bare numbers take the unit of the last value."""
    try:
        unit = units.split(texts[-1])[1]
    except units.UnitError:
        return texts
    return [f"{one} {unit}" if unit and _bare(one) is not None else one for one in texts]


def _number(path: str, text: str, design: Design, metrics: Metrics) -> float:
    """Return one value as the design stores it, checked at its PATH."""
    value = _value(path, text, design, metrics)
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        message = f"{path}: {shown(text)} is not a number, so it cannot have a range"
        raise InputError(Diagnostic(message, "list its values: PATH=a,b,c"))
    if not _plain(path, text, value, design, metrics):
        message = (
            f"{shown(text)} differs in kind from the value of the design, so it cannot have a range"
        )
        remedy = "list the values: PATH=a,b,c, or set one such value with --set first"
        raise InputError(Diagnostic(message, remedy, path=path))
    return float(value)


def _plain(path: str, text: str, value: float, design: Design, metrics: Metrics) -> bool:
    """Whether a number fully describes a value: 50 % of a stroke is not 0.5 m."""
    said = _at(design, path, text, metrics)
    return said == _at(design, path, repr(float(value)), metrics)


def _value(
    path: str, text: str, design: Design, metrics: Metrics
) -> float | int | str | bool | None:
    return get(_at(design, path, text, metrics), path)


def _at(design: Design, path: str, text: str, metrics: Metrics) -> Design:
    number = _bare(text)
    value = text if number is None else number
    return with_values(
        design, {path: value}, materials=load_library(), metrics=metrics, contradictions=False
    )


def _bare(text: str) -> float | None:
    """Return a number without a unit, which is SI; None for any other text."""
    try:
        number, unit = units.split(text)
    except units.UnitError:
        return None
    return None if unit else number


def _listed(path: str, parts: list[str], design: Design, metrics: Metrics) -> Axis:
    if not all(parts):
        raise UsageError(Diagnostic(f"--vary {path}: an empty value", FORM))
    if len(parts) > MOST_LISTED:
        raise UsageError(Diagnostic(f"--vary {path}: {len(parts)} values", "write a range"))
    parts = _with_unit(parts)
    found = [_value(path, part, design, metrics) for part in dict.fromkeys(parts)]
    if len(set(found)) < len(parts):  # catches 20 mm beside 2 cm
        raise UsageError(Diagnostic(f"--vary {path}: a value twice", FORM))
    if all(
        isinstance(one, (int, float))
        and not isinstance(one, bool)
        and _plain(path, part, one, design, metrics)
        for one, part in zip(found, parts, strict=True)
    ):
        return Axis(path, np.array([float(one) for one in found if one is not None]), tuple(parts))
    return Axis(path, None, tuple(parts))
