"""Values that only a scenario has: names of files and columns, initial position."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from ...base.errors import shown
from ..kinds import Choice, Position, PositionKind, Text, ValueFault, choice_of
from .components import ENDS, FRICTIONS, LAWS, SUPPLIES
from .shapes import SHAPES


class Label(Text):
    """A text with its own example."""

    def __init__(self, help: str, example: str, longest: int = 200) -> None:
        super().__init__(help, longest)
        self.example = example


class FileName(Label):
    """Name of a file, relative to the scenario's folder."""

    def __init__(self, help: str, example: str) -> None:
        super().__init__(help, example, 300)

    def validate(self, value: Any) -> str:
        """The name of the file."""
        text = super().validate(value)
        if text.strip() == "-":
            raise ValueFault(f'"{shown(text)}" is not a file', f"write e.g. {self.example}")
        return text


class StartPosition(PositionKind):
    """A length from the cap end, or a fraction of the stroke (``50 %``)."""

    help = "piston position from the cap end: a length, or a share of the stroke (50 %)"

    def validate(self, value: Any) -> Position:
        """A length in m, or a `Fraction`."""
        remedy = 'write "50 %" or "55 mm"'
        try:
            found = super().validate(value)
        except ValueFault as fault:
            if "worst" in fault.remedy:
                raise ValueFault(fault.message, remedy) from None
            raise
        if found == "worst":
            raise ValueFault('"worst": not an initial position', remedy)
        return found


Shape: TypeAlias = Annotated[str, choice_of("shape of this part of the signal", SHAPES)]
Law: TypeAlias = Annotated[str, choice_of("law of the controller", LAWS)]
Tuning: TypeAlias = Annotated[
    Literal["margins", "ziegler_nichols", "stated"],
    Choice(
        "tuning of gain and times; margins: from the ultimate point "
        "of the linear model with a gain margin, direction and place of least gain; "
        "ziegler_nichols: by their table from the same point; stated: all values are stated"
    ),
]
Friction: TypeAlias = Annotated[str, choice_of("friction model of the seals", FRICTIONS)]
Supply: TypeAlias = Annotated[str, choice_of("type of supply", SUPPLIES)]
Ends: TypeAlias = Annotated[
    str | None,
    choice_of(
        "connection of the ports (default: the valve of the design, else its ports.end)", ENDS
    ),
]
CushionEnd: TypeAlias = Annotated[
    Literal["both", "cap", "rod"],
    Choice(
        "which ends have a cushion; both: both ends; cap: end of retraction; rod: end of extension"
    ),
]
