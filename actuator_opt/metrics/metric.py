"""What a metric states about itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal, get_args

from ..base.quantities import INFINITY, Quantity, Sense
from ..base.units import BASE, unit

Feed = Literal["wall", "oil", "own"]
"""Whose validity warnings a metric inherits: those of the barrel's wall model (bore growth), those
of the oil's bulk modulus; "own": a warning about the metric is about its own model."""

Wall = Literal["layered", "thin_laminate"]
"""Wall models of a laminated barrel."""

CRITERION = "criterion"
"""Stands for the model of the failure criterion that the design chooses."""


@dataclass(frozen=True, slots=True)
class CheckLine:
    """A line of the check list: its number, its words, its limit (SI) with source.

    Without `limit` only the design's author can set one. `advice` lines are shown and warned
    about, but are no constraint of the optimiser.
    """

    number: str
    name: str
    limit: float | None = None
    source: str = ""
    advice: bool = False

    def __post_init__(self) -> None:
        if (self.limit is None) != (not self.source):
            raise ValueError(f"check {self.name}: state the limit with its source, or neither")

    @property
    def order(self) -> tuple[int, ...]:
        """Chapter and line, for sorting: ``"10.2"`` comes after ``"9.1"``."""
        return tuple(int(part) for part in self.number.split("."))


@dataclass(frozen=True, slots=True)
class Least:
    """The least value (SI) that a part needs to be made, with the source of the number."""

    value: float
    source: str


@dataclass(frozen=True, slots=True)
class MetricRow:
    """A metric with everything about it; all else that knows metrics is a view of these rows.

    Every field without a default must be stated, so that forgetting one fails at import.

    Attributes
    ----------
    name, symbol, dimension, unit, label, lower, upper : its quantity (`quantities.Quantity`)
    worst : which of its values over load cases and places is the worst
    model : ``"module.function"`` of `actuator_opt.models`; None for plain geometry
    feeds : whose warnings it inherits
    check : its line of the check list; None where there is none
    by_wall : the model instead, by wall model of a laminated barrel
    at : the model instead, by place; a place may be a pattern (``"* yield, *"``)
    at_stops : whether it is also computed at both stops where their loads differ
    least : the least value a part needs to be made (`geometry_…` only)
    short : shorter label for a tile of a report
    """

    name: str
    symbol: str
    dimension: str
    unit: str
    label: str
    worst: Sense = field(kw_only=True)
    model: str | None = field(kw_only=True)
    feeds: tuple[Feed, ...] = field(kw_only=True)
    check: CheckLine | None = field(kw_only=True)
    lower: float = field(default=-INFINITY, kw_only=True)
    upper: float = field(default=INFINITY, kw_only=True)
    by_wall: Mapping[Wall, str] = field(default_factory=dict, kw_only=True)
    at: Mapping[str, str] = field(default_factory=dict, kw_only=True)
    at_stops: bool = field(default=False, kw_only=True)
    least: Least | None = field(default=None, kw_only=True)
    short: str = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        if not self.label:
            raise ValueError(f"metric {self.name}: its label is empty")
        if self.dimension not in BASE:
            raise ValueError(f"metric {self.name}: no dimension {self.dimension}")
        if self.unit:
            unit(self.unit, self.dimension)  # raises UnitError
        for model in filter(None, (self.model, *self.by_wall.values(), *self.at.values())):
            if model != CRITERION and model.count(".") != 1:
                raise ValueError(f"metric {self.name}: {model} is no module.function")
        if self.worst not in get_args(Sense):
            raise ValueError(f"metric {self.name}: its worst value is min or max")
        if not {*self.feeds} <= {*get_args(Feed)}:
            raise ValueError(f"metric {self.name}: feeds are {', '.join(get_args(Feed))}")
        if self.name.startswith("geometry_") != (self.least is not None):
            raise ValueError(f"metric {self.name}: state `least`, for geometry_… and no other")

    @property
    def quantity(self) -> Quantity:
        """What tables and texts need of it."""
        return Quantity(
            self.name,
            self.symbol,
            self.dimension,
            self.unit,
            self.label,
            self.lower,
            self.upper,
            self.worst,
        )


def table(rows: Iterable[MetricRow]) -> Mapping[str, MetricRow]:
    """The rows by name, in their order.

    Raises
    ------
    ValueError : two metrics of a name, or two checks of a number
    """
    found: dict[str, MetricRow] = {}
    numbers: dict[str, str] = {}
    for row in rows:
        if row.name in found:
            raise ValueError(f"metric {row.name}: stated twice")
        if row.check is not None:
            other = numbers.setdefault(row.check.number, row.name)
            if other != row.name:
                raise ValueError(f"check {row.check.number}: both {other} and {row.name}")
        found[row.name] = row
    return MappingProxyType(found)


def fed_by(feed: Feed, rows: Mapping[str, MetricRow]) -> Iterator[str]:
    """Names of the metrics that inherit the warnings of `feed`."""
    return (name for name, row in rows.items() if feed in row.feeds)
