"""A row of the table of metrics: quantity, worst value, model, sources of warnings, check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal, get_args

from ..base.dataclass import dataclass
from ..base.quantities import INFINITY, Quantity, Sense
from ..base.units import BASE, unit

Feed = Literal["wall", "oil", "own"]
"""Source of a metric's validity warnings: "wall" is the wall model of the barrel, on which the
metric depends through the growth of the bore, "oil" the model of the oil's bulk modulus, and "own"
the metric's own model."""


Wall = Literal["layered", "thin_laminate"]
"""Wall models of a laminated barrel."""


CRITERION = "criterion"
"""Stands for the model's name where the model is the failure criterion that the design selects."""

AT_ENDS = {
    "*, beside *": "end_bending.strain_changes",
    "interlaminar shear*": "end_bending.interlaminar_shear",
}
"""Models of first-ply failure where the barrel bends beside a joint, by location."""


@dataclass(frozen=True, slots=True)
class CheckLine:
    """A line of the check list: its number, title, limit (SI) and source of the limit.

    A line without `limit` is checked only if the design file sets a limit. A line with `advice` is
    shown and gives warnings, but does not constrain the optimiser.
    """

    number: str
    name: str
    limit: float | None = None
    source: str = ""
    advice: bool = False

    def __post_init__(self) -> None:
        if (self.limit is None) != (not self.source):
            raise ValueError(f"check {self.name}: state both limit and source, or neither")

    @property
    def order(self) -> tuple[int, ...]:
        """Chapter and line as numbers, so that ``"10.2"`` sorts after ``"9.1"``."""
        return tuple(int(part) for part in self.number.split("."))


@dataclass(frozen=True, slots=True)
class Least:
    """Smallest value (SI) of a dimension for which the part can be made, and the source of it."""

    value: float
    source: str


@dataclass(frozen=True, slots=True)
class MetricRow:
    """Everything about a metric; all other tables of metrics are derived from these rows.

    Fields without a default must be stated: a missing field fails at import.

    Attributes
    ----------
    name, symbol, dimension, unit, label, lower, upper : fields of its `quantities.Quantity`
    worst : whether the smallest ("min") or the largest ("max") value of all load cases and places
        is the worst; the worst value is reported
    model : ``"module.function"`` of `actuator_opt.models`; None for plain geometry
    feeds : sources of its validity warnings, names of `Feed`
    check : its line of the check list; None if it has no check
    by_wall : models that replace `model` for a laminated barrel, by its wall model
    at : models that replace `model` at some locations; a key may be a pattern (``"* yield, *"``)
    at_stops : whether it is also computed at both ends of the stroke if the loads there differ
    least : smallest value for which a part can be made; only for metrics `geometry_…`
    short : shorter label for a tile of a report
    term : name of at most 24 letters for a line of the terminal (see `term_of`); states only what
        the default of `term_of` lacks
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
    term: str = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        if not self.label:
            raise ValueError(f"metric {self.name}: its label is empty")
        if self.dimension not in BASE:
            raise ValueError(f"metric {self.name}: no dimension {self.dimension}")
        if self.unit:
            unit(self.unit, self.dimension)  # raises UnitError
        for model in filter(None, (self.model, *self.by_wall.values(), *self.at.values())):
            if model != CRITERION and model.count(".") != 1:
                raise ValueError(f"metric {self.name}: {model} is not module.function")
        if self.worst not in get_args(Sense):
            raise ValueError(f"metric {self.name}: its worst value must be min or max")
        if not {*self.feeds} <= {*get_args(Feed)}:
            raise ValueError(
                f"metric {self.name}: feeds must be one of {', '.join(get_args(Feed))}"
            )
        if self.name.startswith("geometry_") != (self.least is not None):
            raise ValueError(f"metric {self.name}: state `least` for geometry_… metrics only")

    @property
    def quantity(self) -> Quantity:
        """The metric's `Quantity`, which formats its values for tables and texts."""
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
