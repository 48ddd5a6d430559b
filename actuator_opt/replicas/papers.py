"""Common parts for all papers: reader of their data in ``notes/PAPER.yaml``, words of tables.

The data of a paper are its published numbers with their locations in the paper, its claims, its
numbered equations with the functions that compute them, and reasons in words. The reader is strict:
each number needs a unit and its location in the paper, and the code must know each name.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cache
from importlib.resources import files
from typing import Any, NamedTuple, TypeVar

from ..base import units
from ..base.numeric import Array
from ..design.model import Design
from ..design.yaml_source import parse
from ..rendering import text

Numbers = TypeVar("Numbers")

SLASH = " / "


def scaled(values: Sequence[float] | Array, scale: float, digits: int = 3) -> str:
    """Values of a row as text for a single cell."""
    return SLASH.join(text.trimmed(float(v) * scale, digits) for v in values)


def percent(share: float, digits: int = 2) -> str:
    """A share in percent."""
    return text.with_unit(text.trimmed(100 * share, digits), "%")


def listed(words: Sequence[str]) -> str:
    """Words as a list: ``one, two and three``."""
    *rest, last = words
    return f"{', '.join(rest)} and {last}" if rest else last


@cache
def _data(paper: str) -> Mapping[str, Any]:
    """The data file of a paper; its scalars are kept as strings."""
    name = f"notes/{paper}.yaml"
    data = parse((files(__package__) / name).read_text("utf-8"), name).data
    if not isinstance(data, dict):
        raise ValueError(f"{name}: no mapping")
    _known(f"{name}:", data, ("published",), ("claims", "reasons", "equations"))
    return data


def _known(
    where: str, entry: Mapping[str, Any], required: Sequence[str], optional: Sequence[str] = ()
) -> None:
    """Raise an error if a name in an entry is missing or unknown."""
    missing = [name for name in required if name not in entry]
    strange = [name for name in entry if name not in (*required, *optional)]
    if missing or strange:
        raise ValueError(f"{where} missing {missing}, unknown {strange}")


def published_numbers(numbers: type[Numbers], paper: str) -> Numbers:
    """The published numbers of a paper in SI, as a dataclass with a field for each number."""
    entries = _data(paper)["published"]
    _known(f"{paper}: published:", entries, [field.name for field in fields(numbers)])  # type: ignore[arg-type]
    values: dict[str, float | tuple[float, ...]] = {}
    for name, entry in entries.items():
        _known(f"{paper}: {name}:", entry, ("value", "quantity", "place"))
        value, quantity = entry["value"], entry["quantity"]
        several = isinstance(value, list)
        parsed = tuple(units.parse(number, quantity) for number in (value if several else [value]))
        values[name] = parsed if several else parsed[0]
    return numbers(**values)


Reasons = Mapping[str, Mapping[str, str]]
"""Reasons in words, by factor and verdict."""


def reasons(paper: str, model: str) -> Reasons:
    """The reasons that the notes of a paper state for a model."""
    known: Reasons = _data(paper)["reasons"][model]
    return known


def claim(paper: str, name: str, **values: str) -> tuple[str, str]:
    """A claim of a paper and where it is printed; `values` fill the placeholders of the latter."""
    entry = _data(paper)["claims"][name]
    _known(f"{paper}: {name}:", entry, ("claim", "place"))
    return entry["claim"], entry["place"].format(**values)


class Trace(NamedTuple):
    """Equations `first` to `last`, their subject, and the functions that compute them."""

    first: int
    last: int
    subject: str
    functions: tuple[str, ...] = ()
    remark: str = ""
    """Remark on the functions, or the reason why an equation is out of scope."""


def equations(paper: str) -> tuple[Trace, ...]:
    """All numbered equations of a paper, in order and without repetition.

    Raises
    ------
    ValueError : a number is missing, repeated or out of order
    """
    traces, following = [], 1
    for entry in _data(paper)["equations"]:
        _known(f"{paper}: {entry}:", entry, ("equations", "subject"), ("functions", "remark"))
        first, _, last = entry["equations"].partition(" to ")
        trace = Trace(
            int(first),
            int(last or first),
            entry["subject"],
            tuple(entry.get("functions", ())),
            entry.get("remark", ""),
        )
        if trace.first != following or trace.last < trace.first:
            raise ValueError(f"{paper}: equation {following} expected, not {entry['equations']}")
        following = trace.last + 1
        traces.append(trace)
    return tuple(traces)


TRACE_COLUMNS = ("equation", "subject", "function", "remark")


def trace_rows(traces: Iterable[Trace]) -> tuple[tuple[str, ...], ...]:
    """A table row for each trace, with the columns `TRACE_COLUMNS`."""
    return tuple(
        (
            f"{trace.first}" if trace.first == trace.last else f"{trace.first}–{trace.last}",
            trace.subject,
            "; ".join(trace.functions) or "–",
            trace.remark or "–",
        )
        for trace in traces
    )


def close(a: float, b: float) -> bool:
    """Whether two lengths or areas are equal except for rounding."""
    return math.isclose(a, b, rel_tol=1e-6)


def of_another_cylinder(design: Design, source: str, theirs: tuple[float, float, float]) -> str:
    """Note on another cylinder (bore, rod, stroke) in the source; empty if it is the same."""
    ours = design.cylinder.bore, design.rod.outer_diameter, design.cylinder.stroke
    if all(map(close, ours, theirs)):
        return ""
    names = (
        "{}/{}-{}".format(*(text.trimmed(1e3 * size) for size in sizes)) for sizes in (theirs, ours)
    )
    words = "The {} has a {} cylinder (bore/rod-stroke), this design a {}, so results may differ. "
    return words.format(source, *names)


def rounded(value: float) -> str:
    """A number rounded to three digits.

    >>> rounded(252879.0)
    '253\u202f000'
    """
    return text.number(float(f"{value:.3g}"), 3)


def newtons(value: float) -> str:
    """A force in N."""
    return text.with_unit(rounded(value), "N")


def speed_text(speed: float) -> str:
    """A speed in mm/s."""
    return f"{text.trimmed(1e3 * speed, 3)} mm/s"


def pressure_text(pressure: float) -> str:
    """A pressure in MPa."""
    return f"{text.trimmed(pressure / 1e6, 3)} MPa"


def times(ratio: float) -> str:
    """A ratio as ``3 times``."""
    return f"{text.trimmed(ratio, 3)} times"
