"""Values that only a scenario has: names of files and columns, initial position."""

from __future__ import annotations

from typing import Any

from ...base.suggest import shown
from ..kinds import Position, PositionKind, Text, ValueFault


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
