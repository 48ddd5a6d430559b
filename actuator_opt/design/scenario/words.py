"""The words a scenario may choose from: one type each, with what every word means."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from ..kinds import Choice, choice_of
from .components import ENDS, FRICTIONS, LAWS, SUPPLIES
from .shapes import SHAPES

Shape: TypeAlias = Annotated[str, choice_of("course of this part of the signal", SHAPES)]
Law: TypeAlias = Annotated[str, choice_of("what the controller does with the error", LAWS)]
Tuning: TypeAlias = Annotated[
    Literal["margins", "ziegler_nichols", "stated"],
    Choice(
        "where gain and times come from if they are not stated; margins: from the ultimate point "
        "of the linear model with a gain margin, direction and place of least gain; "
        "ziegler_nichols: by their table from the same point; stated: all are stated"
    ),
]
Friction: TypeAlias = Annotated[str, choice_of("how the seals resist", FRICTIONS)]
Supply: TypeAlias = Annotated[str, choice_of("what feeds the valve", SUPPLIES)]
Ends: TypeAlias = Annotated[
    str | None,
    choice_of(
        "what the ports lead to (default: the valve of the design, else its ports.end)", ENDS
    ),
]
CushionEnd: TypeAlias = Annotated[
    Literal["both", "cap", "rod"],
    Choice("which ends have it; both: both; cap: where the rod is in; rod: where it is out"),
]
