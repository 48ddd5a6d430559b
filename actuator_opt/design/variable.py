"""Extra data of a value: bounds of a variable, bounds of a test, scatter."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from .kinds import Choice, Sizes, Text
from .section import Section


class Variable(Section):
    """Bounds and start (SI) of a dimension that the optimiser varies; in the file, units by PATH.

    It varies continuously, or takes the `sizes` of a series or a list, or multiples of `step`.
    """

    lower: float
    upper: float
    start: float
    sizes: Annotated[str | tuple[float, ...] | None, Sizes()] = None
    step: float | None = None


class Measured(Section):
    """Test result for a value of the design: its 95 % bounds.

    SI; in the file, units by PATH.
    """

    lower: float
    upper: float
    record: Annotated[str, Text("name of the record in a report", 200)]


Shape: TypeAlias = Literal["normal", "lognormal", "uniform", "loguniform", "triangular", "fixed"]


class Uncertain(Section):
    """Scatter of a value; SI, in the file units by PATH."""

    distribution: Annotated[
        Shape,
        Choice(
            "distribution of the value; normal: about the value, by deviation or cv; "
            "lognormal: the value is its median, by cv or by the factor that covers 95 %; "
            "uniform: between bounds, half_width about the value, or an ISO 286 tolerance; "
            "loguniform: uniform in its logarithm, between bounds or value/factor to value*factor; "
            "triangular: as uniform, with the mode at the value; "
            "fixed: no scatter, even if libraries or practice give some"
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
    source: Annotated[str | None, Text("source, as named in a report", 200)] = None
