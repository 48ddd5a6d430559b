"""What is said of values beside the value: bounds to move in, bounds of a test, scatter."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from .kinds import Choice, Sizes, Text
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


Shape: TypeAlias = Literal["normal", "lognormal", "uniform", "loguniform", "triangular", "fixed"]


class Uncertain(Section):
    """How a value scatters; SI, in the file units by PATH."""

    distribution: Annotated[
        Shape,
        Choice(
            "how the value scatters; normal: about the value, by deviation or cv; "
            "lognormal: the value is its median, by cv or by the factor that holds 95 %; "
            "uniform: between bounds, half_width about the value, or an ISO 286 tolerance; "
            "loguniform: uniform in its logarithm, between bounds or value/factor to value*factor; "
            "triangular: as uniform, most likely at the value; "
            "fixed: not at all, whatever libraries and practice say"
        ),
    ]
    lower: float | None = None
    upper: float | None = None
    deviation: float | None = None
    half_width: float | None = None
    cv: float | None = None
    factor: float | None = None
    tolerance: Annotated[str | None, Text("ISO 286 class of a diameter or length, e.g. H8", 10)] = (
        None
    )
    source: Annotated[str | None, Text("where it comes from, as a report names it", 200)] = None
