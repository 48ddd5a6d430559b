"""Entries of ``uncertainty``: quantities of their keys, and ranges of the distributions.

A distribution is centred on the value in the design and moves with it, so an optimiser can vary the
value. Only a distribution that is stated by absolute bounds does not move.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from math import exp, log, log1p, sqrt
from typing import Any

from ..base.quantities import INPUTS, Quantity
from .kinds import ValueFault
from .standard_sizes import citation, metres, tables

_CLASS = re.compile(r"(JS|js|[A-Za-z])(\d{1,2})")
_MICRON = 1e-6


def _table() -> dict[str, Any]:
    table: dict[str, Any] = tables()["iso_286"]
    return table


def source() -> str:
    """Source of the table of ISO 286-1 tolerances, with its confidence."""
    return f"{citation(_table()['source'])} ({_table()['confidence']})"


def class_limits(name: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation (m) of an ISO 286-1 tolerance class, for a nominal size (m).

    Holes have capital letters, shafts small letters. The fundamental deviation of a hole is the
    negative of that of the shaft with the same letter (d to h); js and JS are symmetric.

    Raises
    ------
    ValueFault : no such class, or a size beyond the table

    Examples
    --------
    >>> [round(1e6 * x, 3) for x in class_limits("H8", 25e-3)]
    [0.0, 33.0]
    >>> [round(1e6 * x, 3) for x in class_limits("f7", 25e-3)]
    [-41.0, -20.0]
    """
    table = _table()
    match = _CLASS.fullmatch(name.strip())
    letter = "" if match is None else match[1]
    grades, letters = [int(g) for g in table["grades"]], table["shafts"]
    is_letter = letter.lower() in (*letters, "h", "js")
    if match is None or int(match[2]) not in grades or not is_letter:
        message = f'"{name}" is not a supported tolerance class'
        ends = f"{', '.join(sorted(letters))}, h or js, and grades {grades[0]} to {grades[-1]}"
        raise ValueFault(message, f"write e.g. H8 (hole) or f7 (shaft); letters are {ends}")
    row = next((r for r in table["rows"] if size <= metres(r["to"]) * (1 + 1e-12)), None)
    if row is None or size <= 0:
        message = f"{name}: the ISO 286 table ends at {table['rows'][-1]['to']} mm"
        raise ValueFault(message, "write half_width instead")
    width = float(row["widths"][grades.index(int(match[2]))]) * _MICRON
    if letter.lower() == "js":
        return -width / 2, width / 2
    shift = 0.0 if letter.lower() == "h" else float(letters[letter.lower()][_place(row)]) * _MICRON
    return (shift, shift + width) if letter.isupper() else (-shift - width, -shift)


def _place(row: dict[str, Any]) -> int:
    """Index of a row of the table; each row is for a range of nominal sizes."""
    return [step["to"] for step in _table()["rows"]].index(row["to"])


Stated = Mapping[str, Any]
"""Keys of an entry with their values; numbers are in SI."""

KEYS: dict[str, tuple[tuple[str, ...], ...]] = {
    "normal": (("deviation",), ("cv",)),
    "lognormal": (("cv",), ("factor",)),
    "uniform": (("half_width",), ("tolerance",), ("lower", "upper")),
    "loguniform": (("factor",), ("lower", "upper")),
    "triangular": (("half_width",), ("tolerance",), ("lower", "upper")),
    "fixed": ((),),
}
"""For each distribution, the alternative groups of keys; an entry states exactly one group."""

VARIATION = replace(
    INPUTS["coefficient"], name="variation", symbol="CV", unit="%", upper=1.0,
    label="standard deviation over mean",
)  # fmt: skip
FACTOR = replace(
    INPUTS["coefficient"], name="factor", symbol="f", lower=1.0, upper=1e3, label="factor"
)
NUMBERS = ("lower", "upper", "deviation", "half_width", "cv", "factor")
"""Keys with numeric values."""

REACH = 5.0
"""Number of standard deviations at which normal and lognormal distributions are truncated. A share
of 6e-7 of the distribution lies beyond."""


def quantity_of_entry(key: str, quantity: Quantity) -> Quantity | None:
    """Quantity of a key (such as `lower`) of a distribution of `quantity`; None for a text."""
    if key in ("lower", "upper"):
        return quantity
    if key == "cv":
        return VARIATION
    if key == "factor":
        return FACTOR
    if key not in NUMBERS:
        return None
    reach = min(quantity.upper - quantity.lower, 1e20)
    changed = replace(quantity, name=f"{quantity.name}_{key}", lower=0.0, upper=reach)
    if quantity.dimension == "temperature":
        changed = replace(changed, dimension="temperature_difference", unit="K")
    return replace(changed, label=f"{key.replace('_', ' ')} of {quantity.label}")


def limits(shape: str, entry: Stated, value: float) -> tuple[float, float]:
    """Smallest and largest sample (SI); raises `ValueFault` for an invalid tolerance class.

    Parameters
    ----------
    shape : name of the distribution
    entry : keys of the entry, SI
    value : value in the design
    """
    if shape == "fixed":
        return value, value
    if entry.get("lower") is not None:
        return float(entry["lower"]), float(entry["upper"])
    if entry.get("tolerance") is not None:
        below, above = class_limits(entry["tolerance"], value)
        return value + below, value + above
    if shape == "normal":
        deviation = entry.get("deviation")
        reach = REACH * (abs(value) * entry["cv"] if deviation is None else deviation)
        return value - reach, value + reach
    if shape in ("lognormal", "loguniform"):
        widest = ratio(shape, entry)
        return value / widest, value * widest
    return value - float(entry["half_width"]), value + float(entry["half_width"])


def ratio(shape: str, entry: Stated) -> float:
    """Ratio of largest sample to value in the design, of a lognormal or loguniform distribution."""
    if shape == "loguniform":
        return float(entry["factor"])
    return exp(REACH * log_deviation(entry))


def log_deviation(entry: Stated) -> float:
    """Standard deviation of the logarithm: sqrt(ln(1 + cv^2)), or ln(factor)/1.96.

    The entry states `cv`, the coefficient of variation, or `factor`, by which 95 % of the samples
    differ at most from the median.
    """
    cv = entry.get("cv")
    return sqrt(log1p(cv * cv)) if cv is not None else log(entry["factor"]) / 1.959964


def misfit(shape: str, entry: Stated, value: float, quantity: Quantity) -> tuple[str, str]:
    """Message and remedy if a distribution is invalid for a value; empty texts if it is valid."""
    try:
        low, high = limits(shape, entry, value)
    except ValueFault as fault:
        return fault.message, fault.remedy
    text = quantity.text
    if low > high:
        return f"bounds reversed: upper {text(high)} is below lower {text(low)}", "swap them"
    if entry.get("lower") is not None and not low <= value <= high:
        return (
            f"the value in the design, {text(value)}, is outside {text(low)} to {text(high)}",
            "widen the bounds, or change the value",
        )
    if low <= 0 and shape in ("lognormal", "loguniform"):
        return f"a {shape} distribution needs values above 0", "use another distribution"
    if low < quantity.lower or high > quantity.upper:
        remedy = (
            "reduce the scatter"
            if shape == "lognormal"
            else "reduce the scatter, or use a lognormal distribution"
        )
        return (
            f"samples from {text(low)} to {text(high)} exceed the valid range ({quantity.label})",
            f"stay within {quantity.range_text()}: {remedy}",
        )
    return "", ""
