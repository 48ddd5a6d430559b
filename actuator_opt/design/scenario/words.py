"""Choices of a scenario: one type each, with the meaning of every word."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from ..kinds import Choice, choice_of
from .components import ENDS, FRICTIONS, LAWS, SUPPLIES
from .shapes import SHAPES

Shape: TypeAlias = Annotated[str, choice_of("shape of this part of the signal", SHAPES)]
Law: TypeAlias = Annotated[str, choice_of("control law", LAWS)]
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
    Choice("cushioned ends; both: both ends; cap: end of retraction; rod: end of extension"),
]
