"""Bounds of values: what the optimiser may move a dimension to, what a test says of one."""

from __future__ import annotations

from typing import Annotated

from .kinds import Sizes, Text
from .section import Section


class Variable(Section):
    """Bounds and start (SI) of a dimension the optimiser may move; in the file, units by PATH.

    It moves freely, or takes the `sizes` of a series or a list, or multiples of `step`.
    """

    lower: float
    upper: float
    start: float
    sizes: Annotated[str | tuple[float, ...] | None, Sizes()] = None
    step: float | None = None


class Measured(Section):
    """What a test record says of a value of the design: bounds that hold it with 95 %.

    SI; in the file, units by PATH.
    """

    lower: float
    upper: float
    record: Annotated[str, Text("the record, as a report names it", 200)]
